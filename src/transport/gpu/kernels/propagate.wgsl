// One iteration: each cell gathers what its six neighbours send, adds it to the sum and notes that it was lit.

// A bit a cell: it has received light.
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;
// For each level and channel: whether its light needs no clamp any more, and for the last three iterations whether
// a cell still did.
@group(0) @binding(7) var<storage, read_write> decisions: array<atomic<u32>>;

fn linear_direction(s: Share, fall: f32, along: f32, across: f32) -> f32 {
    return mul(s.gamma, fall) + mul(s.delta, along) + mul(s.epsilon, across);
}

// Without clamps a neighbour's share is a matrix of five numbers.
fn linear(level: u32, a: Neighbours) -> vec4<f32> {
    let s = share(level);
    let mean = (a.x0.x + a.x1.x) + (a.y0.x + a.y1.x) + (a.z0.x + a.z1.x);
    let inward = (a.x0.y - a.x1.y) + (a.y0.z - a.y1.z) + (a.z0.w - a.z1.w);
    return vec4<f32>(
        mul(s.alpha, mean) + mul(s.beta, inward),
        linear_direction(s, a.x0.x - a.x1.x, a.x0.y + a.x1.y, (a.y0.y + a.y1.y) + (a.z0.y + a.z1.y)),
        linear_direction(s, a.y0.x - a.y1.x, a.y0.z + a.y1.z, (a.x0.z + a.x1.z) + (a.z0.z + a.z1.z)),
        linear_direction(s, a.z0.x - a.z1.x, a.z0.w + a.z1.w, (a.x0.w + a.x1.w) + (a.y0.w + a.y1.w)),
    );
}

// Adds to `sum` what one neighbour sends, face by face. Both hold (c00, along the way, and the two across it); `sign`
// is -1 where the way leads to smaller indices.
fn clamped_share(level: u32, sign: f32, a: vec4<f32>, sum: vec4<f32>) -> vec4<f32> {
    var to = sum;
    let ahead = ahead_face(level);
    let flux = larger(mul(ahead.sampler.x, a.x) + mul(sign * ahead.sampler.y, a.y), ahead.least);
    to.x += mul(ahead.lobe.x, flux);
    to.y += mul(sign * ahead.lobe.y, flux);
    if HAS_SIDES {
        let side = side_face(level);
        let both = mul(side.sampler.x, a.x) + mul(sign * side.sampler.y, a.y);
        let p = mul(side.sampler.z, a.z);
        let q = mul(side.sampler.z, a.w);
        let p_up = larger(both + p, side.least);
        let p_down = larger(both - p, side.least);
        let q_up = larger(both + q, side.least);
        let q_down = larger(both - q, side.least);
        let flux = (p_up + p_down) + (q_up + q_down);
        to.x += mul(side.lobe.x, flux);
        to.y += mul(sign * side.lobe.y, flux);
        to.z += mul(side.lobe.z, p_up - p_down);
        to.w += mul(side.lobe.z, q_up - q_down);
    }
    return to;
}

// Every clamped face by itself.
fn clamped(level: u32, a: Neighbours) -> vec4<f32> {
    var c = vec4<f32>(0.0);
    c = clamped_share(level, 1.0, a.x0, c);
    c = clamped_share(level, 1.0, a.y0.xzyw, c.xzyw).xzyw;
    c = clamped_share(level, 1.0, a.z0.xwyz, c.xwyz).xzwy;
    c = clamped_share(level, -1.0, a.x1, c);
    c = clamped_share(level, -1.0, a.y1.xzyw, c.xzyw).xzyw;
    c = clamped_share(level, -1.0, a.z1.xwyz, c.xwyz).xzwy;
    return c;
}

fn plain(level: u32, a: Neighbours) -> vec4<f32> {
    var senders = array<vec4<f32>, 6>(a.x0, a.x1, a.y0, a.y1, a.z0, a.z1);
    var received = vec4<f32>(0.0);
    for (var d = 0u; d < 6u; d++) {
        received += send(level, d, senders[d]);
    }
    return received;
}

// The exact product of two numbers as the sum of two (Dekker, Veltkamp).
fn product(a: f32, b: f32) -> vec2<f32> {
    let p = mul(a, b);
    let ta = mul(4097.0, a);
    let ah = ta - (ta - a);
    let al = a - ah;
    let tb = mul(4097.0, b);
    let bh = tb - (tb - b);
    let bl = b - bh;
    let e = ((mul(ah, bh) - p) + mul(ah, bl) + mul(al, bh)) + mul(al, bl);
    return vec2<f32>(p, e);
}

// The sum of two such pairs (Knuth).
fn sum_of(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = a.x + b.x;
    let v = s - a.x;
    let e = (a.x - (s - v)) + (b.x - v);
    let t = e + (a.y + b.y);
    let high = s + t;
    return vec2<f32>(high, t - (high - s));
}

// Whether the direction part is at most CONE times c00, to some 44 bits: on the rim the processor takes 53.
fn in_cone(light: vec4<f32>) -> bool {
    let most = max(max(abs(light.x), abs(light.y)), max(abs(light.z), abs(light.w)));
    if most == 0.0 {
        return true;
    }
    // A power of two that brings the largest number near 1, so that no square is lost.
    let exponent = (bitcast<u32>(most) >> 23u) & 255u;
    let scale = bitcast<f32>((254u - exponent) << 23u);
    let a = light * scale;
    let across = sum_of(sum_of(product(a.y, a.y), product(a.z, a.z)), product(a.w, a.w));
    let c2 = product(a.x, a.x);
    let rim = sum_of(product(c2.x, CONE2_HIGH), vec2<f32>(mul(c2.x, CONE2_LOW) + mul(c2.y, CONE2_HIGH), 0.0));
    let left = sum_of(rim, -across);
    return light.x >= 0.0 && left.x + left.y >= 0.0;
}

// The cell of an invocation: workgroups are tiles of 32 x 8 cells of a slab, whose rows are read once for all of them.
// In a small grid they take cells as they lie.
fn cell_of(job: Job, group: u32, lane: u32) -> vec3<u32> {
    if job.bits < 5u {
        let i = group * GROUP + lane;
        let last = job.side - 1u;
        return vec3<u32>(i & last, (i >> job.bits) & last, job.z_first + (i >> (2u * job.bits)));
    }
    let across = job.bits - 5u;
    let down = job.bits - 3u;
    let x = ((group & ((1u << across) - 1u)) << 5u) + (lane & 31u);
    let y = (((group >> across) & ((1u << down) - 1u)) << 3u) + (lane >> 5u);
    return vec3<u32>(x, y, job.z_first + (group >> (across + down)));
}

@compute @workgroup_size(256)
fn propagate(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // Every other iteration runs backwards: it finds in the cache what the one before wrote last.
    let order = id.x + id.y * groups.x;
    if order >= jobs.groups {
        return;
    }
    let group = select(order, jobs.groups - 1u - order, step.backwards != 0u);
    let job = jobs.list[job_of(group)];
    let entry = 4u * job.decision;
    let decides = (step.mode & MODE_DECIDE) != 0u;
    let is_linear = (step.mode & MODE_LINEAR) != 0u
        && (atomicLoad(&decisions[entry]) != 0u
            || (decides && atomicLoad(&decisions[entry + 1u + (step.slot + 2u) % 3u]) == 0u));
    if decides && group == job.first_group && lane == 0u {
        if is_linear { atomicStore(&decisions[entry], 1u); }
        // The entry of the next iteration, which nobody reads or writes in this one.
        atomicStore(&decisions[entry + 1u + (step.slot + 1u) % 3u], 0u);
    }

    let cell = cell_of(job, group - job.first_group, lane);
    let z = cell.z - job.z_first;
    if z >= job.z_count {
        return;
    }
    let i = cell.x + (cell.y << job.bits) + (z << (2u * job.bits));
    let word = job.words_at + (i >> job.bits) * job.row_words + (cell.x >> 5u);
    let bit = 1u << (cell.x & 31u);
    var mask = vec2<u32>(0u, 0xffffffffu);
    if (step.mode & (MODE_SOLIDS | MODE_MASKED)) != 0u {
        mask = masks[word];
    }
    if (step.mode & MODE_SOLIDS) != 0u && (mask.x & bit) != 0u {
        return;
    }
    let at = job.target_at + i;
    let sums = (step.mode & MODE_MASKED) == 0u || (mask.y & bit) != 0u;
    let was_lit = (atomicLoad(&marks[word]) & bit) != 0u;
    // Where light has been there is a sum to add to: it is read along with the neighbours, and not after them.
    var sum = vec4<f32>(0.0);
    if was_lit && sums {
        sum = accumulated[at];
    }
    let around = neighbours(job, cell);
    var value: vec4<f32>;
    if MAY_BE_PLAIN && (step.mode & MODE_PLAIN) != 0u {
        value = plain(job.level, around);
    } else if is_linear {
        value = linear(job.level, around);
    } else {
        value = clamped(job.level, around);
    }
    value = settle(value);
    if (step.mode & MODE_KEEP) != 0u {
        value += source[job.source_at + i + ((job.z_first - job.z_read) << (2u * job.bits))];
    }
    light[at] = value;
    if all(value == vec4<f32>(0.0)) {
        return;
    }
    if !was_lit {
        atomicOr(&marks[word], bit);
        if sums {
            sum = accumulated[at];
        }
    }
    if sums {
        accumulated[at] = sum + value;
    }
    let outside = entry + 1u + step.slot;
    if decides && !is_linear && !in_cone(value) && atomicLoad(&decisions[outside]) == 0u {
        atomicStore(&decisions[outside], 1u);
    }
}
