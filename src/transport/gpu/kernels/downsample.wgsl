// A level from the next finer one: the mean of each cell's eight children.

@group(0) @binding(2) var<storage, read> finer: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> coarser: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;

@compute @workgroup_size(64)
fn downsample(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (id.x + id.y * groups.x) * 64u + lane;
    let job = jobs.list[0];
    if i >= (1u << (3u * job.bits)) {
        return;
    }
    let x = i & (job.side - 1u);
    let y = (i >> job.bits) & (job.side - 1u);
    let z = i >> (2u * job.bits);
    let row = 2u << job.bits;
    let slab = row << (job.bits + 1u);
    let j = job.source_at + 2u * x + row * 2u * y + slab * 2u * z;
    // Pairs first: the mean of a constant is then that constant, to the last bit.
    let low = (finer[j] + finer[j + 1u]) + (finer[j + row] + finer[j + row + 1u]);
    let high = (finer[j + slab] + finer[j + slab + 1u]) + (finer[j + slab + row] + finer[j + slab + row + 1u]);
    let mean = (low + high) * 0.125;
    coarser[job.target_at + i] = mean;
    if any(mean != vec4<f32>(0.0)) {
        atomicOr(&marks[job.words_at + (i >> job.bits) * job.row_words + (x >> 5u)], 1u << (x & 31u));
    }
}
