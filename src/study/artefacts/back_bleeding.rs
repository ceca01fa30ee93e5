//! Light behind its own source over light before it (000, 6.1, figure 16).
//!
//! A source with a direction stands for a lit surface: nothing of its light belongs behind it. Cells are told
//! apart by the plane through the lit cell that is nearest to them, across the direction of the light in it:
//! *before* where the light goes, *behind* where it comes from, neither on the plane itself. The number is the
//! accumulated light of all cells behind over that of all before: 0 for light that goes straight, 1 where it goes
//! both ways alike. On a coarse level count the cells that hold finest cells of one kind alone and no source.

use glam::DVec3;

use super::nearest::Nearest;
use super::{Region, Shares, share};
use crate::field::{Cell, Layout, Marks};
use crate::scene::Problem;
use crate::sh::{Real, Sh};
use crate::simulation::Simulation;
use crate::study::light::Brightness;

/// How far from a source's plane a cell has to be, in cells, to be on one side of it.
const BESIDE: f64 = 1e-6;

/// The back-bleeding of a state; `None` where no source has a direction, or there is no room behind or before.
pub fn of<T: Real>(state: &Simulation<T>) -> Option<Shares> {
    let levels = state.sizes().count();
    let sides = Sides::of(state.problem())?;
    let spoils = |other: &Marks| {
        let mut spoils = sides.lit.clone();
        Layout::new(other.side()).cells().filter(|cell| other.get(*cell)).for_each(|cell| spoils.set(cell));
        spoils
    };
    let behind = Region::new(sides.behind.clone(), &spoils(&sides.before), levels);
    let before = Region::new(sides.before.clone(), &spoils(&sides.behind), levels);
    let brightness = Brightness::new(state.channels());
    let level = |level| share(behind.level(state, &brightness, level)?, before.level(state, &brightness, level)?);
    Some(Shares {
        merged: share(behind.merged(state, &brightness), before.merged(state, &brightness)),
        levels: (0..levels).map(level).collect(),
    })
}

/// Which finest cells lie behind their nearest source, and which before it.
struct Sides {
    lit: Marks,
    behind: Marks,
    before: Marks,
}

impl Sides {
    fn of(problem: &Problem) -> Option<Self> {
        let n = problem.size;
        let lights = lights(problem);
        let cells: Vec<Cell> = lights.iter().map(|(cell, _)| *cell).collect();
        let nearest = Nearest::new(n, &cells);
        let mut sides = Sides { lit: Marks::new(n), behind: Marks::new(n), before: Marks::new(n) };
        cells.iter().for_each(|cell| sides.lit.set(*cell));
        for cell in Layout::new(n).cells() {
            let Some((light, Some(direction))) = nearest.of(cell).map(|number| lights[number]) else { continue };
            let offset = DVec3::from_array(std::array::from_fn(|axis| cell[axis] as f64 - light[axis] as f64));
            match offset.dot(direction) {
                along if along > BESIDE => sides.before.set(cell),
                along if along < -BESIDE => sides.behind.set(cell),
                _ => {}
            }
        }
        (sides.behind.count() > 0 && sides.before.count() > 0).then_some(sides)
    }
}

/// The lit cells, each once, with the direction that all light injected there has together.
fn lights(problem: &Problem) -> Vec<(Cell, Option<DVec3>)> {
    let mut all: Vec<(Cell, Sh<f64>)> = Vec::new();
    for source in &problem.sources {
        let weight: f64 = source.color.iter().sum();
        all.extend(source.light.iter().map(|(cell, light)| (*cell, *light * weight)));
    }
    all.retain(|(_, light)| !light.is_zero());
    all.sort_by_key(|(cell, _)| *cell);
    all.dedup_by(|(later, light), (kept, sum)| {
        let same = later == kept;
        if same {
            *sum += *light;
        }
        same
    });
    all.into_iter().map(|(cell, light)| (cell, light.direction())).collect()
}
