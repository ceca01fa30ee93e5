// Light in cells, as all kernels of this file see it.
//
// A cell is a vec4<f32>: (c00, X, Y, Z), with (X, Y, Z) the direction in which light flows. In the published real
// basis (c00, c1-1, c10, c11) that is X = -c11, Y = -c1-1, Z = +c10.
// A grid of n x n x n cells lies x fastest, z slowest, without padding; outside of it all is dark.

// What one invocation of a kernel works on: some slabs of one level of one channel.
struct Job {
    first_group: u32,   // the first workgroup that works on it
    side: u32,          // n
    bits: u32,          // log2 n
    level: u32,         // 0 the finest
    source_at: u32,     // where slab `z_read` begins in `source`, in cells
    target_at: u32,     // where slab `z_first` begins in `target` and `accumulated`, in cells
    z_read: u32,        // the first slab that `source` holds
    z_first: u32,       // the first slab to compute
    z_count: u32,       // how many
    decision: u32,      // which entry of `decisions` is this level's and channel's
    words_at: u32,      // where slab `z_first` begins in `marks` and `masks`, in words
    row_words: u32,     // words of 32 cells that a row takes there
}

// What holds for one dispatch.
struct Step {
    zero: u32,          // 0; it keeps a compiler from fusing products with sums
    mode: u32,          // MODE_* below
    slot: u32,          // the iteration modulo 3
    backwards: u32,     // 1: the last workgroup first
}

// What one dispatch works on.
struct Jobs {
    count: u32,
    @size(12) groups: u32,  // the workgroups of all jobs
    list: array<Job, 64>,
}

const GROUP: u32 = 256u;
// The linear form may be used where `decisions` says so.
const MODE_LINEAR: u32 = 1u;
// This iteration looks whether its light needs no clamp any more.
const MODE_DECIDE: u32 = 2u;
// The target keeps its source, too: the first iteration of NVIDIA's sample.
const MODE_KEEP: u32 = 4u;
// By the definition, tap by tap, in place of the five numbers.
const MODE_PLAIN: u32 = 8u;
// Cells that solids touch are left to the kernel `solids`.
const MODE_SOLIDS: u32 = 16u;
// Only the cells of a mask accumulate.
const MODE_MASKED: u32 = 32u;
// Blockers weaken light.
const MODE_OCCLUDE: u32 = 64u;

@group(0) @binding(0) var<uniform> jobs: Jobs;
@group(0) @binding(1) var<uniform> step: Step;

// A product that is rounded by itself, so that every device gives the same bits: no compiler knows that `step.zero` is 0.
// Not an exclusive or: where a product is multiplied by 1 two of those cancel, and the product is fused after all.
fn mul(a: f32, b: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(a * b) | step.zero);
}

fn larger(a: f32, b: f32) -> f32 {
    return select(b, a, a > b);
}

// Light fades exponentially; what is fainter than this counts as none.
const FLOOR: f32 = 1e-30;

fn settle_number(c: f32) -> f32 {
    return select(c, 0.0, abs(c) < FLOOR);
}

fn settle(c: vec4<f32>) -> vec4<f32> {
    return vec4<f32>(settle_number(c.x), settle_number(c.y), settle_number(c.z), settle_number(c.w));
}

// The job that a workgroup works on.
fn job_of(group: u32) -> u32 {
    var found = 0u;
    for (var i = 1u; i < jobs.count; i++) {
        if jobs.list[i].first_group <= group {
            found = i;
        }
    }
    return found;
}
