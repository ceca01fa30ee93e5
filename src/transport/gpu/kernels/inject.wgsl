// Light from a list into the finest level. A cell stands in the list once; where lights share a cell they are added
// up before.

struct Injected {
    light: vec4<f32>,
    cell: vec3<u32>,
    unused: u32,
}

@group(0) @binding(2) var<storage, read> injected: array<Injected>;
@group(0) @binding(3) var<storage, read_write> light: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> accumulated: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;

@compute @workgroup_size(64)
fn inject(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let which = (id.x + id.y * groups.x) * 64u + lane;
    if which >= arrayLength(&injected) {
        return;
    }
    let job = jobs.list[0];
    let entry = injected[which];
    let row = (entry.cell.z << job.bits) + entry.cell.y;
    let at = job.target_at + (row << job.bits) + entry.cell.x;
    light[at] += entry.light;
    if (step.mode & MODE_MASKED) == 0u {
        accumulated[at] += entry.light;
    }
    if any(entry.light != vec4<f32>(0.0)) {
        atomicOr(&marks[job.words_at + row * job.row_words + (entry.cell.x >> 5u)], 1u << (entry.cell.x & 31u));
    }
}
