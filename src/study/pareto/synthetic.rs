//! Scenes that are made at any size.

use glam::DVec3;

use crate::field::Layout;
use crate::scene::{Occlusion, Problem, Propagation, Source};
use crate::sh::Sh;

/// A wall, two walls that face each other and a lone lobe, each with its name, in white; an octree down to 1³,
/// the scheme `cascaded` at `factor`.
pub fn scenes(n: usize, factor: f64) -> [(&'static str, Problem); 3] {
    let wall = |x: usize, way: DVec3| {
        let cells = Layout::new(n).cells().filter(move |cell| cell[0] == x);
        Source { color: [1.0; 3], light: cells.map(|cell| (cell, Sh::lobe(way))).collect(), ..Source::default() }
    };
    let lobe = Source { color: [1.0; 3], light: vec![([n / 2; 3], Sh::lobe(DVec3::X))], ..Source::default() };
    let problem = |sources: Vec<Source>| Problem {
        size: n,
        coarsest: 1,
        sources,
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation { factor, ..Propagation::default() },
        ..Problem::default()
    };
    [
        ("one-wall", problem(vec![wall(0, DVec3::X)])),
        ("two-walls", problem(vec![wall(0, DVec3::X), wall(n - 1, DVec3::NEG_X)])),
        ("one-lobe", problem(vec![lobe])),
    ]
}
