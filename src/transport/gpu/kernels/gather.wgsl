// What a cell gathers from its neighbours.

@group(0) @binding(2) var<storage, read> source: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> light: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> accumulated: array<vec4<f32>>;
// Two words for every 32 cells: those that solids touch, those that accumulate.
@group(0) @binding(6) var<storage, read> masks: array<vec2<u32>>;
// The neighbours of a cell: one step back and one step on along x, y and z.
struct Neighbours {
    x0: vec4<f32>, x1: vec4<f32>,
    y0: vec4<f32>, y1: vec4<f32>,
    z0: vec4<f32>, z1: vec4<f32>,
}

fn neighbours(job: Job, cell: vec3<u32>) -> Neighbours {
    let n = job.side;
    let row = n;
    let slab = n << job.bits;
    let i = job.source_at + cell.x + (cell.y << job.bits) + ((cell.z - job.z_read) << (2u * job.bits));
    var around: Neighbours;
    if cell.x > 0u { around.x0 = source[i - 1u]; }
    if cell.x + 1u < n { around.x1 = source[i + 1u]; }
    if cell.y > 0u { around.y0 = source[i - row]; }
    if cell.y + 1u < n { around.y1 = source[i + row]; }
    if cell.z > 0u { around.z0 = source[i - slab]; }
    if cell.z + 1u < n { around.z1 = source[i + slab]; }
    return around;
}

// What a neighbour in direction `d` (+x, -x, +y, -y, +z, -z) receives of the light `a`, tap by tap.
fn send(level: u32, d: u32, a: vec4<f32>) -> vec4<f32> {
    var received = vec4<f32>(0.0);
    for (var f = 0u; f < FACES; f++) {
        let t = tap(level, d, f);
        received += scaled(t.lobe, flux_through(t, a));
    }
    return received;
}

fn dot4(a: vec4<f32>, b: vec4<f32>) -> f32 {
    return mul(a.x, b.x) + mul(a.y, b.y) + mul(a.z, b.z) + mul(a.w, b.w);
}

fn scaled(a: vec4<f32>, s: f32) -> vec4<f32> {
    return vec4<f32>(mul(a.x, s), mul(a.y, s), mul(a.z, s), mul(a.w, s));
}

fn flux_through(t: Tap, a: vec4<f32>) -> f32 {
    let flux = dot4(t.sampler, a);
    return select(flux, larger(flux, 0.0), t.clamps != 0u);
}
