//! Sorts boxes into a binary tree, from the top down by the surface area heuristic in 16 bins an axis (Wald, On fast
//! construction of SAH-based bounding volume hierarchies, 2007), its depth bounded for any input.
//!
//! The tree is what obvhs packs eight to a node. Its own builder merges neighbours from the bottom up, in steps
//! that grow with the square of their number, and to any depth, where boxes are alike: twenty thousand equal
//! triangles take fifteen seconds and overflow the stack that rays keep. Here a part is halved by number
//! wherever a cleverer split could lead deeper than that stack.

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

/// The depth that no leaf lies beyond: obvhs keeps 32 nodes on a ray's stack.
const DEEPEST: u32 = 30;
/// The bins along an axis.
const BINS: usize = 16;

/// The tree over boxes, at least one and at most 2³⁰ of them, one box a leaf.
pub(super) fn tree(boxes: &[Aabb]) -> Bvh2 {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = Vec::with_capacity(2 * boxes.len());
    nodes.push(Bvh2Node::default());
    let mut ahead = vec![(0usize, 0..order.len(), 0u32)];
    while let Some((node, part, depth)) = ahead.pop() {
        let around = surrounding(part.clone().map(|i| boxes[order[i] as usize]));
        if part.len() == 1 {
            nodes[node] = Bvh2Node::new(around, 1, part.start as u32);
            continue;
        }
        let middle = part.start + split(&mut order[part.clone()], boxes, DEEPEST - depth);
        let first = nodes.len();
        nodes[node] = Bvh2Node::new(around, 0, first as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        ahead.push((first, part.start..middle, depth + 1));
        ahead.push((first + 1, middle..part.end, depth + 1));
    }
    Bvh2 { nodes, primitive_indices: order, ..Bvh2::default() }
}

/// Splits a part in two, each at least one box; gives how many come first. `left` is how much deeper leaves may lie.
fn split(part: &mut [u32], boxes: &[Aabb], left: u32) -> usize {
    let n = part.len();
    let middle = |i: u32| boxes[i as usize].min + boxes[i as usize].max;
    let centres = surrounding(part.iter().map(|i| Aabb { min: middle(*i), max: middle(*i) }));
    let extent = centres.max - centres.min;
    let bin = |i: u32, axis: usize| {
        let along = (middle(i)[axis] - centres.min[axis]) / extent[axis];
        ((along * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|axis| extent[*axis] > 0.0) {
        let mut counts = [0usize; BINS];
        let mut hulls = [Aabb::INVALID; BINS];
        for i in part.iter() {
            let b = bin(*i, axis);
            counts[b] += 1;
            hulls[b] = union(hulls[b], boxes[*i as usize]);
        }
        // What lies behind each border between bins, from the far end.
        let mut behind = [(0usize, 0.0f32); BINS];
        let (mut count, mut hull) = (0, Aabb::INVALID);
        for b in (1..BINS).rev() {
            (count, hull) = (count + counts[b], union(hull, hulls[b]));
            behind[b] = (count, if count > 0 { half_area(hull) } else { 0.0 });
        }
        let (mut count, mut hull) = (0, Aabb::INVALID);
        for b in 1..BINS {
            (count, hull) = (count + counts[b - 1], union(hull, hulls[b - 1]));
            if count > 0 && behind[b].0 > 0 {
                let cost = count as f32 * half_area(hull) + behind[b].0 as f32 * behind[b].1;
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, b));
                }
            }
        }
    }
    if let Some((_, axis, border)) = best {
        let mut first = 0;
        for i in 0..n {
            if bin(part[i], axis) < border {
                part.swap(i, first);
                first += 1;
            }
        }
        // Halved from here on, the larger part ends just above the bottom.
        if halvings(first.max(n - first)) < left {
            return first;
        }
    }
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    part.select_nth_unstable_by(n / 2, |a, b| middle(*a)[axis].total_cmp(&middle(*b)[axis]).then(a.cmp(b)));
    n / 2
}

/// How often `n` must be halved, rounding up, to come to 1.
fn halvings(n: usize) -> u32 {
    n.next_power_of_two().trailing_zeros()
}

fn surrounding(boxes: impl Iterator<Item = Aabb>) -> Aabb {
    boxes.fold(Aabb::INVALID, union)
}

fn union(a: Aabb, b: Aabb) -> Aabb {
    Aabb { min: a.min.min(b.min), max: a.max.max(b.max) }
}

fn half_area(of: Aabb) -> f32 {
    let d = of.max - of.min;
    d.x * d.y + d.y * d.z + d.z * d.x
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;

    /// The depth of the deepest leaf, after a look that every box is in one leaf and inside all boxes above.
    fn depth(tree: &Bvh2, boxes: &[Aabb]) -> u32 {
        let mut found = vec![0; boxes.len()];
        let mut deepest = 0;
        let mut ahead = vec![(0u32, Aabb::LARGEST, 0)];
        while let Some((node, above, depth)) = ahead.pop() {
            let node = tree.nodes[node as usize];
            assert!(node.aabb.min.cmpge(above.min).all() && node.aabb.max.cmple(above.max).all());
            if node.prim_count == 1 {
                let i = tree.primitive_indices[node.first_index as usize] as usize;
                assert_eq!(node.aabb, boxes[i]);
                found[i] += 1;
                deepest = deepest.max(depth);
            } else {
                ahead.extend([0, 1].map(|child| (node.first_index + child, node.aabb, depth + 1)));
            }
        }
        assert!(found.iter().all(|times| *times == 1));
        deepest
    }

    #[test]
    fn the_tree_holds_every_box_once_and_is_never_deeper_than_a_rays_stack() {
        let cube = |at: f32, side: f32| Aabb { min: Vec3A::splat(at), max: Vec3A::splat(at + side) };
        let equal = vec![cube(0.0, 1.0); 3000];
        let nested: Vec<Aabb> = (0..3000).map(|i| cube(-(i as f32), 2.0 * i as f32)).collect();
        // Each half as far as the one before: the heuristic would split them off one by one.
        let shrinking: Vec<Aabb> = (0..120).map(|i| cube(2f32.powi(-i), 1e-3 * 2f32.powi(-i))).collect();
        let row: Vec<Aabb> = (0..1000).map(|i| cube(i as f32, 0.5)).collect();
        for boxes in [equal, nested, shrinking, row, vec![cube(1.0, 1.0)]] {
            assert!(depth(&tree(&boxes), &boxes) <= DEEPEST);
        }
    }
}
