//! Laws of light, each stated once: the suite over all kinds of transport and the random scenes of `stability` hold light
//! against the same statements. Each answers with where and by how much it does not hold.

use crate::field::{Cell, Grid};
use crate::scene::propagation::Snapshots;
use crate::scene::{Problem, Source};
use crate::sh::{Real, Sh};
use crate::simulation::options::Wanted;
use crate::simulation::{Action, Simulation};
use crate::transport;
use crate::transport::kind::Precision;
use crate::transport::lattice::face::Direction;
use crate::transport::solve::NoFixedPoint;

/// Differences below this are what loops leave out that set to zero what is fainter than 1e-30.
const FAINT: f64 = 1e-26;

/// One of the 48 symmetries of the cube: coordinate a of the image is coordinate `order[a]`, flipped or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symmetry {
    order: [usize; 3],
    flip: [bool; 3],
}

impl Symmetry {
    /// All 48; the first leaves everything where it is.
    ///
    /// ```
    /// use lpv_lab::study::laws::Symmetry;
    ///
    /// assert_eq!(Symmetry::all().next().unwrap().cell([1, 2, 3], 7), [1, 2, 3]);
    /// assert_eq!(Symmetry::all().count(), 48);
    /// ```
    pub fn all() -> impl Iterator<Item = Symmetry> {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        orders.into_iter().flat_map(|order| {
            (0..8).map(move |bits| Symmetry { order, flip: std::array::from_fn(|a| bits >> a & 1 == 1) })
        })
    }

    /// Where it takes a cell whose coordinates go from 0 to `last`.
    pub fn cell(self, cell: Cell, last: usize) -> Cell {
        std::array::from_fn(|a| {
            let c = cell[self.order[a]];
            if self.flip[a] { last - c } else { c }
        })
    }

    /// What it makes of a vector.
    pub fn vector(self, v: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let c = v[self.order[a]];
            if self.flip[a] { -c } else { c }
        })
    }

    /// What it makes of a function on the sphere.
    pub fn light(self, light: Sh<f64>) -> Sh<f64> {
        let [x, y, z] = self.vector(light.vector().to_array());
        Sh([light.0[0], x, y, z])
    }

    /// A problem without occluders, its light turned.
    pub fn problem(self, problem: &Problem) -> Problem {
        let mut turned = problem.clone();
        for (cell, light) in turned.sources.iter_mut().flat_map(|source| &mut source.light) {
            (*cell, *light) = (self.cell(*cell, problem.size - 1), self.light(*light));
        }
        turned
    }
}

/// [`Law::Symmetry`](crate::transport::kind::Law): light that is turned before its run is what came of it, turned, on
/// every level, to `slack` times the brightest. `straight` has run as far as its problem asks for.
pub fn symmetry(straight: &Simulation<f64>, by: Symmetry, slack: f64) -> Result<(), String> {
    let turned = run(by.problem(straight.problem()))?;
    for (channel, (a, b)) in straight.lights().iter().zip(turned.lights()).enumerate() {
        for (level, (a, b)) in a.accumulated.levels().iter().zip(b.accumulated.levels()).enumerate() {
            let image = |cell| b.get(by.cell(cell, a.side() - 1));
            near(a, |cell, light| image(cell) - by.light(light), slack)
                .map_err(|how| format!("level {level}, channel {channel}, {by:?}: {how}"))?;
        }
    }
    Ok(())
}

/// [`Law::Superposition`](crate::transport::kind::Law): the light of all injected cells is the sum of that of the even
/// ones and of the odd ones, on the finest level, to `slack` times the brightest.
pub fn superposition(all: &Simulation<f64>, slack: f64) -> Result<(), String> {
    let half = |odd: usize| {
        let mut problem = all.problem().as_ref().clone();
        let take = |source: &Source| {
            let light = source.light.iter().filter(|(cell, _)| cell.iter().sum::<usize>() % 2 == odd);
            Source { light: light.copied().collect(), ..source.clone() }
        };
        problem.sources = problem.sources.iter().map(take).collect();
        run(problem)
    };
    let halves = [half(0)?, half(1)?];
    for (channel, light) in all.lights().iter().enumerate() {
        let [a, b] = halves.each_ref().map(|half| half.lights()[channel].accumulated.level(0));
        near(light.accumulated.level(0), |cell, light| a.get(cell) + b.get(cell) - light, slack)
            .map_err(|how| format!("channel {channel}: {how}"))?;
    }
    Ok(())
}

/// A run in one go, with nobody looking, gives the bits that single steps gave.
pub fn again(stepped: &Simulation<f32>) -> Result<(), String> {
    let mut whole = Simulation::<f32>::new(stepped.problem().clone()).map_err(told)?;
    whole.run_all(Wanted::Everything);
    if whole.iteration() != stepped.iteration() {
        return Err(format!("{} iterations, then {}", stepped.iteration(), whole.iteration()));
    }
    for (channel, (a, b)) in stepped.lights().iter().zip(whole.lights()).enumerate() {
        if a.source != b.source || a.accumulated != b.accumulated {
            return Err(format!("channel {channel} differs"));
        }
    }
    if stepped.index() == whole.index() { Ok(()) } else { Err("the index volumes differ".to_owned()) }
}

/// [`Law::FixedPoint`](crate::transport::kind::Law): what is solved for is what iterating comes to once nothing more
/// moves, on the finest level, to `slack` times the brightest. Nothing is said where light has not died out after
/// `patience` iterations.
pub fn fixed_point(problem: &Problem, slack: f64, patience: usize) -> Result<(), String> {
    let mut problem = Problem { coarsest: problem.size, ..problem.clone() };
    problem.propagation.snapshots = Snapshots::Thesis;
    let mut iterated = Simulation::<f32>::new(problem.clone()).map_err(told)?;
    iterated.act(Action::Inject);
    iterated.act(Action::Downsample);
    let died_out = |now: &Simulation<f32>| {
        let energy = |grid: &Grid<f32>| grid.energy().abs();
        now.lights().iter().all(|l| energy(l.source.level(0)) <= 1e-9 * energy(l.accumulated.level(0)))
    };
    while !died_out(&iterated) {
        if iterated.iteration() >= patience || iterated.divergence().is_some() {
            return Ok(());
        }
        iterated.act(Action::Propagate);
    }
    let solved = match transport::solve(&problem, 1e-6, |_| true) {
        Ok(Some(solved)) => solved,
        // Some light never comes to where no clamp acts; that is refused by name.
        Ok(None) | Err(NoFixedPoint::Clamped { .. }) => return Ok(()),
        Err(error) => return Err(told(error)),
    };
    for (channel, (light, solved)) in iterated.lights().iter().zip(&solved.light).enumerate() {
        near(light.accumulated.level(0), |cell, light| solved.get(cell).widen() - light.widen(), slack)
            .map_err(|how| format!("channel {channel}: {how}"))?;
    }
    Ok(())
}

/// [`Law::Reach`](crate::transport::kind::Law): where light can be, level by level, followed step by step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reach {
    possible: Vec<Vec<bool>>,
}

impl Reach {
    /// Light is where it is. Where coarser levels only hold the mean of the finest, the law is about the finest.
    pub fn new<T: Real>(simulation: &Simulation<T>) -> Self {
        let has_levels = transport::find(&simulation.problem().propagation.scheme).is_some_and(|kind| kind.can.levels);
        let levels = if has_levels { simulation.sizes().count() } else { 1 };
        let lights = simulation.lights();
        let lit = |i: usize| {
            let layout = lights[0].source.level(i).layout();
            layout.cells().map(|cell| lights.iter().any(|l| !l.source.level(i).get(cell).is_zero())).collect()
        };
        Reach { possible: (0..levels).map(lit).collect() }
    }

    /// One iteration on: a step to a neighbour from every cell; with `stays`, light may also stay.
    pub fn step(&mut self, stays: bool) {
        for possible in &mut self.possible {
            *possible = one_step_further(possible, stays);
        }
    }

    /// Whether no snapshot holds light where none can be.
    pub fn check<T: Real>(&self, simulation: &Simulation<T>) -> Result<(), String> {
        for (channel, light) in simulation.lights().iter().enumerate() {
            for (level, (source, possible)) in light.source.levels().iter().zip(&self.possible).enumerate() {
                let dark = source.iter().zip(possible).filter(|(_, possible)| !**possible);
                if let Some(((cell, light), _)) = dark.into_iter().find(|((_, light), _)| !light.is_zero()) {
                    let k = simulation.iteration();
                    return Err(format!(
                        "iteration {k}, level {level}, channel {channel}: {cell:?} holds {light:?} and must be dark"
                    ));
                }
            }
        }
        Ok(())
    }
}

/// The cells one step away from those given, and those themselves if light `stays`.
fn one_step_further(lit: &[bool], stays: bool) -> Vec<bool> {
    let n = (lit.len() as f64).cbrt().round() as usize;
    let index = |[x, y, z]: Cell| (z * n + y) * n + x;
    let mut further = if stays { lit.to_vec() } else { vec![false; lit.len()] };
    for (i, _) in lit.iter().enumerate().filter(|(_, lit)| **lit) {
        let cell = [i % n, i / n % n, i / (n * n)];
        for d in Direction::ALL {
            let mut to = cell;
            let moved = if d.is_positive() { cell[d.axis()].checked_add(1) } else { cell[d.axis()].checked_sub(1) };
            let Some(moved) = moved.filter(|c| *c < n) else { continue };
            to[d.axis()] = moved;
            further[index(to)] = true;
        }
    }
    further
}

fn run<T: Precision>(problem: Problem) -> Result<Simulation<T>, String> {
    let mut simulation = Simulation::new(problem).map_err(told)?;
    simulation.run(|_| true);
    Ok(simulation)
}

fn told(error: impl Into<transport::solve::NoFixedPoint>) -> String {
    error.into().to_string()
}

/// Whether what is `off` of every cell is at most `slack` times the brightest.
fn near<T: Real>(grid: &Grid<T>, off: impl Fn(Cell, Sh<T>) -> Sh<f64>, slack: f64) -> Result<(), String>
where
    Sh<T>: Copy,
{
    let brightest = grid.iter().map(|(_, light)| light.widen().max_norm()).fold(0.0, f64::max);
    let far = |(cell, light): &(Cell, Sh<T>)| off(*cell, *light).max_norm() > FAINT + slack * brightest;
    match grid.iter().find(far) {
        None => Ok(()),
        Some((cell, light)) => Err(format!("{cell:?} holds {light:?}, off by {:?}", off(cell, light))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use crate::transport::preset;

    fn problem(text: &str) -> Problem {
        let text = format!("(version: 1, size: 4, {text})");
        Problem::build(&preset::parse(&text, Path::new("p.ron")).unwrap(), Path::new("")).unwrap()
    }

    const LAMPS: &str = "injectors: [(kind: Single(cell: (0, 1, 2)), direction: (1, 2, 3)),
                                     (kind: Single(cell: (3, 2, 2)), direction: (-1, 0, 3))]";

    /// Each law holds for its own light, and finds out light of another scene.
    #[test]
    fn each_law_can_be_broken() {
        let here: Simulation<f64> =
            run(problem(&format!("{LAMPS}, propagation: (iterations: 6, clamp: false)"))).unwrap();
        let symmetry_of = |s: &Simulation<f64>| Symmetry::all().try_for_each(|by| symmetry(s, by, 1e-12));
        assert_eq!((symmetry_of(&here), superposition(&here, 1e-12)), (Ok(()), Ok(())));
        let mut longer = here.clone();
        longer.act(Action::Propagate);
        assert!(symmetry_of(&longer).is_err() && superposition(&longer, 1e-12).is_err());

        let mut stepped: Simulation<f32> = run(problem(&format!("{LAMPS}, propagation: (iterations: 6)"))).unwrap();
        assert_eq!(again(&stepped), Ok(()));
        stepped.act(Action::Propagate);
        assert!(again(&stepped).is_err());

        let free = problem(&format!("{LAMPS}, propagation: (factor: 3)"));
        assert_eq!(fixed_point(&free, 2e-5, 400), Ok(()));
        assert!(fixed_point(&free, 1e-12, 400).is_err(), "single precision is not that good");
        assert_eq!(fixed_point(&free, 1e-12, 3), Ok(()), "nothing is said of light that still moves");
    }

    #[test]
    fn light_out_of_reach_is_found() {
        let mut now = Simulation::<f64>::new(problem(LAMPS)).unwrap();
        now.act(Action::Inject);
        now.act(Action::Downsample);
        let mut reach = Reach::new(&now);
        for _ in 0..3 {
            now.act(Action::Propagate);
            assert!(reach.check(&now).is_err(), "the front has moved on");
            reach.step(false);
            assert_eq!(reach.check(&now), Ok(()));
        }
    }

    #[test]
    fn a_step_leads_to_the_neighbours_inside() {
        let n = 3;
        let at = |x: usize, y: usize, z: usize| (z * n + y) * n + x;
        let mut lit = vec![false; 27];
        lit[at(0, 1, 2)] = true;
        let found = one_step_further(&lit, false);
        let expected = [at(1, 1, 2), at(0, 0, 2), at(0, 2, 2), at(0, 1, 1)];
        assert_eq!((0..27).filter(|i| found[*i]).collect::<Vec<_>>().len(), expected.len());
        assert!(expected.iter().all(|i| found[*i]));
        assert!(one_step_further(&lit, true)[at(0, 1, 2)]);
    }
}
