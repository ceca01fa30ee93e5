//! What lies behind the occluders of a problem, as a matter of geometry alone.
//!
//! A cell lies *behind* where no light is in its sight: every straight line from its centre to the centre of a
//! cell that light is injected into meets an occupied cell. How opaque that is, how occluders act and whether
//! they act at all does not matter. So the same cells lie behind a wall that is black, half transparent or
//! switched off, and wherever scene and wall are moved together; behind a closed wall it is everything that the
//! wall separates from the light, behind one with an opening it is what lies in the full shadow. Occupied cells
//! themselves do not count, nor do cells that hold light of their own.
//!
//! What cannot be reached from the light through free cells is out of its sight without a look. All else is
//! looked at, in volumes above 16³ on a lattice; between lattice cells that all are hidden everything is. Of very
//! many lit cells some stand for all. So the edge of a shadow is known to a cell or two, and its inside exactly.

use rayon::prelude::*;

use crate::field::{Cell, Layout, Marks};
use crate::scene::{Problem, Solid};
use crate::transport::ballistic::visibility::Visibility;
use crate::transport::lattice::face::Direction;
use crate::transport::transmittance::Transmittance;

/// The most cells along a side that are looked at one by one.
const LOOKED_AT: usize = 16;
/// The most lit cells that are looked for.
const LOOKED_FOR: usize = 1 << 8;

/// The finest cells behind the occluders of a problem.
#[derive(Clone, Debug)]
pub struct Behind {
    /// Those that are known to lie behind.
    pub cells: Marks,
    /// All others: occupied, lit, in sight of the light, or not known not to be.
    pub others: Marks,
}

impl Behind {
    /// `None` where nothing lies behind any occluder, or there is no light.
    pub fn of(problem: &Problem) -> Option<Self> {
        let n = problem.size;
        // The geometry of the occluders, whatever they let through.
        let close = |solid: &Solid| Solid { opacity: solid.opacity.map(|c| if c > 0.0 { 1.0 } else { 0.0 }), ..*solid };
        let opaque: Vec<Solid> = problem.solids.iter().map(close).collect();
        let opaque = Transmittance::new(n, &opaque)?;
        let lit = lit(problem);
        let lights: Vec<Cell> = Layout::new(n).cells().filter(|cell| lit.get(*cell)).collect();
        let every = lights.len().div_ceil(LOOKED_FOR).max(1);
        let lights: Vec<Cell> = lights.into_iter().step_by(every).collect();
        let reached = reached(&lit, &opaque);
        let sight = Visibility::new(&opaque, n);
        let apart = n.div_ceil(LOOKED_AT);
        let hidden_in_row = |row: usize| {
            let (y, z) = (row % n, row / n);
            // What a cell sees its neighbour most likely sees, too.
            let mut last = 0;
            let mut is_hidden = |cell: Cell| {
                let sees = |light: &Cell| sight.between(*light, cell) > 0.0;
                if lights.get(last).is_some_and(sees) {
                    return false;
                }
                lights.iter().position(sees).is_none_or(|seen| {
                    last = seen;
                    false
                })
            };
            let free = (0..n).map(|x| [x, y, z]).filter(|cell| opaque.least(*cell) > 0.0 && !lit.get(*cell));
            let on_lattice = |cell: &Cell| cell.iter().all(|c| c % apart == apart / 2);
            free.filter(|cell| !reached.get(*cell) || (on_lattice(cell) && is_hidden(*cell))).collect::<Vec<Cell>>()
        };
        let mut cells = Marks::new(n);
        let hidden: Vec<Vec<Cell>> = (0..n * n).into_par_iter().map(hidden_in_row).collect();
        hidden.iter().flatten().for_each(|cell| cells.set(*cell));
        fill(&mut cells, apart, |cell| opaque.least(cell) > 0.0 && !lit.get(cell));
        if lights.is_empty() || cells.count() == 0 {
            return None;
        }
        let mut others = Marks::new(n);
        Layout::new(n).cells().filter(|cell| !cells.get(*cell)).for_each(|cell| others.set(cell));
        Some(Behind { cells, others })
    }
}

/// Marks the cells that can be hidden between cells of a lattice, so many `apart`, that all are.
fn fill(hidden: &mut Marks, apart: usize, can_be: impl Fn(Cell) -> bool) {
    let n = hidden.side();
    let known = hidden.clone();
    // The lattice's cells on both sides of a cell, or the one there is.
    let beside = |c: usize| {
        let below = (c + apart - apart / 2) / apart * apart + apart / 2;
        let below = below.checked_sub(apart).filter(|below| *below <= c);
        let above = below.map_or(apart / 2, |below| if below == c { c } else { below + apart });
        [below, Some(above).filter(|above| *above < n)].into_iter().flatten().collect::<Vec<usize>>()
    };
    for cell in Layout::new(n).cells().filter(|cell| can_be(*cell) && !known.get(*cell)) {
        let [x, y, z] = cell.map(beside);
        let all = z.iter().all(|z| y.iter().all(|y| x.iter().all(|x| known.get([*x, *y, *z]))));
        if all && !x.is_empty() && !y.is_empty() && !z.is_empty() {
            hidden.set(cell);
        }
    }
}

/// The cells that light is injected into.
pub(super) fn lit(problem: &Problem) -> Marks {
    let mut lit = Marks::new(problem.size);
    for source in problem.sources.iter().filter(|source| source.color.iter().any(|part| *part != 0.0)) {
        let cells = source.light.iter().filter(|(_, light)| !light.is_zero());
        cells.for_each(|(cell, _)| lit.set(*cell));
    }
    lit
}

/// What can be reached from the lit cells, step by step through faces of free cells.
fn reached(lit: &Marks, opaque: &Transmittance) -> Marks {
    let n = lit.side();
    let mut reached = lit.clone();
    let mut front: Vec<Cell> = Layout::new(n).cells().filter(|cell| lit.get(*cell)).collect();
    while let Some(cell) = front.pop() {
        for next in Direction::ALL.iter().filter_map(|direction| direction.neighbour(cell, n)) {
            if opaque.least(next) > 0.0 && !reached.get(next) {
                reached.set(next);
                front.push(next);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::{Occlusion, Propagation, Source};
    use crate::sh::Sh;

    /// A light in an 8³ volume among occupied cells of an opacity.
    fn problem(light: Cell, occupied: impl Fn(Cell) -> bool, opacity: f64) -> Problem {
        let solid = |cell| Solid::new(cell, DVec3::ZERO, opacity, [0.0; 3]);
        Problem {
            size: 8,
            coarsest: 1,
            sources: vec![Source { color: [1.0; 3], light: vec![(light, Sh::lobe(DVec3::X))], ..Source::default() }],
            solids: Layout::new(8).cells().filter(|cell| occupied(*cell)).map(solid).collect(),
            occlusion: Occlusion::default(),
            propagation: Propagation::default(),
            ..Problem::default()
        }
    }

    fn behind(problem: &Problem) -> Vec<Cell> {
        let behind = Behind::of(problem).map(|behind| behind.cells);
        Layout::new(8).cells().filter(|cell| behind.as_ref().is_some_and(|marks| marks.get(*cell))).collect()
    }

    #[test]
    fn a_closed_wall_hides_all_beyond_it_however_transparent_it_is() {
        let beyond: Vec<Cell> = Layout::new(8).cells().filter(|cell| cell[0] > 4).collect();
        for opacity in [1.0, 0.5, 1e-9] {
            assert_eq!(behind(&problem([1, 3, 3], |cell| cell[0] == 4, opacity)), beyond);
        }
        assert!(Behind::of(&problem([1, 3, 3], |_| false, 1.0)).is_none());
    }

    #[test]
    fn behind_an_open_wall_lies_the_full_shadow() {
        // One cell on the light's own height: what lies in line behind it is hidden, what stands beside it is not.
        let found = behind(&problem([1, 3, 3], |cell| cell == [4, 3, 3], 1.0));
        assert!(found.contains(&[5, 3, 3]) && found.contains(&[7, 3, 3]));
        assert!(!found.contains(&[3, 3, 3]) && !found.contains(&[5, 7, 3]));
        // A hole shows the light to what lies in line with both.
        let found = behind(&problem([1, 3, 3], |cell| cell[0] == 4 && cell != [4, 3, 3], 1.0));
        assert!(!found.contains(&[7, 3, 3]) && found.contains(&[5, 7, 7]));
    }

    #[test]
    fn the_shadow_moves_with_the_scene() {
        let here = behind(&problem([1, 3, 3], |cell| cell[0] == 3 && cell[1] < 5, 1.0));
        let there = behind(&problem([2, 3, 3], |cell| cell[0] == 4 && cell[1] < 5, 1.0));
        let moved: Vec<Cell> = here.iter().map(|[x, y, z]| [x + 1, *y, *z]).filter(|cell| cell[0] < 8).collect();
        assert_eq!(moved, there);
    }
}
