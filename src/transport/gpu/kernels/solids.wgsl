// The few cells that a solid has a part in, by the definition; `propagate` leaves them alone.

// A cell that a solid touches: its place in its slabs, and where its neighbourhood begins in `around`.
struct Touched {
    job: u32,
    i: u32,
    around_at: u32,
    colour: u32,
}

@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> touched: array<Touched>;
@group(0) @binding(9) var<storage, read> around: array<vec4<f32>>;

fn mirrored(a: vec4<f32>, d: u32) -> vec4<f32> {
    let axis = d >> 1u;
    return select(a, -a, vec4<bool>(false, axis == 0u, axis == 1u, axis == 2u));
}

fn colour_of(v: vec4<f32>, colour: u32) -> f32 {
    return select(select(v.w, v.z, colour == 1u), v.y, colour == 0u);
}

// Blockers half a cell off the light. `around` holds for each direction the mean blocker where light enters, that
// where it would leave, and (how much the latter faces the light, albedo of red, green, blue).
fn fuzzy(t: Touched, level: u32, d: u32, light: vec4<f32>) -> vec4<f32> {
    let near = around[t.around_at + 3u * d];
    let far = around[t.around_at + 3u * d + 1u];
    let facing = around[t.around_at + 3u * d + 2u];
    var reflected = 0.0;
    var received = vec4<f32>(0.0);
    for (var f = 0u; f < FACES; f++) {
        let face = tap(level, d, f);
        var flux = flux_through(face, light);
        if (step.mode & MODE_OCCLUDE) != 0u {
            let blocked = larger(mul(AMPLIFIER, dot4(near, face.travel)), 0.0);
            flux = mul(flux, larger(1.0 - blocked, 0.0));
        }
        received += scaled(face.lobe, flux);
        reflected += mul(mul(facing.x, flux), REFLECTION);
    }
    if reflected == 0.0 || BOUNCE == 0.0 {
        return received;
    }
    let back = scaled(far, mul(mul(reflected, colour_of(facing, t.colour)), BOUNCE));
    let bands = reflection(level);
    return received + vec4<f32>(mul(back.x, bands.x), mul(back.y, bands.y), mul(back.z, bands.z), mul(back.w, bands.w));
}

// Solids that pass a part of what enters and send a part of it back. `around` holds for each direction
// (what the cell passes along that axis, what the next cell sends back of red, green, blue).
fn hard(t: Touched, level: u32, d: u32, light: vec4<f32>, own: vec4<f32>) -> vec4<f32> {
    let passes = around[t.around_at + d];
    let reflected = colour_of(passes, t.colour);
    var received = send(level, d, light);
    if reflected > 0.0 {
        received += scaled(mirrored(send(level, d, own), d), reflected);
    }
    return scaled(received, passes.x);
}

// A cell that mirrors light. `around` holds for each direction (what is not occupied, what is sent back of red, green,
// blue).
fn mirror(t: Touched, level: u32, d: u32, light: vec4<f32>) -> vec4<f32> {
    let share = around[t.around_at + d];
    let sent = send(level, d, light);
    return scaled(sent, share.x) + scaled(mirrored(sent, d), colour_of(share, t.colour));
}

@compute @workgroup_size(64)
fn solids(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let which = (id.x + id.y * groups.x) * 64u + lane;
    if which >= arrayLength(&touched) {
        return;
    }
    let t = touched[which];
    let job = jobs.list[t.job];
    let i = t.i;
    let cell = vec3<u32>(i & (job.side - 1u), (i >> job.bits) & (job.side - 1u), job.z_first + (i >> (2u * job.bits)));
    let a = neighbours(job, cell);
    let own = source[job.source_at + i + ((job.z_first - job.z_read) << (2u * job.bits))];
    var senders = array<vec4<f32>, 6>(a.x0, a.x1, a.y0, a.y1, a.z0, a.z1);
    var value = vec4<f32>(0.0);
    for (var d = 0u; d < 6u; d++) {
        value += receive_among_solids(t, job.level, d, senders[d], own);
    }
    value = settle(value);
    if (step.mode & MODE_KEEP) != 0u {
        value += own;
    }
    let at = job.target_at + i;
    light[at] = value;
    if all(value == vec4<f32>(0.0)) {
        return;
    }
    let word = job.words_at + (i >> job.bits) * job.row_words + (cell.x >> 5u);
    let bit = 1u << (cell.x & 31u);
    atomicOr(&marks[word], bit);
    if (step.mode & MODE_MASKED) == 0u || (masks[word].y & bit) != 0u {
        accumulated[at] += value;
    }
}
