// The merged light: for every finest cell the sample of the finest level that has received light there, else of
// the coarsest. `jobs` holds a job for each level of one channel, the finest first.

@group(0) @binding(2) var<storage, read> accumulated: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> merged: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> marks: array<u32>;

@compute @workgroup_size(64)
fn merge(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (id.x + id.y * groups.x) * 64u + lane;
    let finest = jobs.list[0];
    if i >= (1u << (3u * finest.bits)) {
        return;
    }
    let cell = vec3<u32>(i & (finest.side - 1u), (i >> finest.bits) & (finest.side - 1u), i >> (2u * finest.bits));
    for (var level = 0u; level < jobs.count; level++) {
        let job = jobs.list[level];
        let at = cell >> vec3<u32>(level);
        let row = (at.z << job.bits) + at.y;
        let is_lit = (marks[job.words_at + row * job.row_words + (at.x >> 5u)] >> (at.x & 31u) & 1u) != 0u;
        if is_lit || level + 1u == jobs.count {
            merged[i] = accumulated[job.target_at + (row << job.bits) + at.x];
            return;
        }
    }
}
