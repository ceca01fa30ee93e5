//! What stands in the way of linear steps: a problem's occluders, as exact levels and descents take them.

use super::exact::blockers::Blockers;
use super::exact::touched;
use super::exact::walls::{Open, Solid, Walls};
use super::kernel::occluded::{OcclusionLaw, Touched, Which};
use super::kernel::with_solids::WithSolids;
use super::occlusion::{self, Acting, Acts};
use super::scheme::{Scheme, Surface};
use super::schemes;
use super::stencil::{Stencil, matrices};
use crate::field::{Grid, Levels, Marks};
use crate::scene::Problem;
use crate::sh::Real;

/// The iteration that a linear step is at the earliest, counted from 1: the first is the injected light's own.
const LINEAR_FROM: usize = 2;

/// The occluders of a problem under its scheme.
#[derive(Clone, Debug)]
pub struct Obstacles<T> {
    law: OcclusionLaw<T>,
    /// The scheme, clamps and all.
    stencil: Stencil<T>,
    /// The finest cells whose light depends on them.
    touched: Touched<T>,
    /// Cells that hold one, or light that one acts on.
    near: Marks,
    from_iteration: usize,
    /// What acts otherwise than hard occluders do, by colour if it turns colours differently.
    blockers: Vec<Blockers>,
    /// The same before it stops light, if it turns light before that and linear steps may come as early.
    earlier: Vec<Blockers>,
}

impl<T: Real> Obstacles<T> {
    /// `None` where there are none. `colours` is how many channels of light there are.
    pub fn new(problem: &Problem, sizes: Levels, colours: usize) -> Option<Self> {
        let scheme = schemes::find(&problem.propagation.scheme)?;
        let Acting { law, from_iteration } = Acting::<T>::new(problem, sizes, &scheme)?;
        let touched = law.touched(0, sizes.finest());
        let mut near = Marks::new(sizes.finest());
        let (mut blockers, mut earlier) = (Vec::new(), Vec::new());
        if let OcclusionLaw::Hard(_) = law {
            problem.solids.iter().for_each(|solid| near.set(solid.cell));
        } else {
            touched.cells.iter().for_each(|cell| near.set(*cell));
            let turns = turns(problem, &scheme);
            let of = |blocks| by_colour(problem, sizes, &scheme, if turns { colours } else { 1 }, blocks);
            blockers = of(true)?;
            if turns && from_iteration > LINEAR_FROM {
                earlier = of(false)?;
            }
        }
        let stencil = Stencil::new(&scheme, problem.propagation.factor, problem.propagation.clamp);
        Some(Obstacles { law, stencil, touched, near, from_iteration, blockers, earlier })
    }

    /// Where light is not smooth because of them: cells that hold one, or light that one acts on.
    pub fn near(&self) -> &Marks {
        &self.near
    }

    /// Steps that light takes before they stop it.
    pub fn passing(&self) -> usize {
        self.from_iteration.saturating_sub(1)
    }

    /// Whether linear steps may come before they stop light.
    pub fn come_late(&self) -> bool {
        self.from_iteration > LINEAR_FROM
    }

    /// How many sorts of light they tell apart, of so many colours.
    pub fn sorts(&self, colours: usize) -> usize {
        if self.blockers.is_empty() { colours } else { self.blockers.len() }
    }

    /// What stands between leaves, for light of a colour; before they stop light, or from then on if they `block`.
    pub fn walls(&self, colour: usize, block: bool) -> Box<dyn Walls + '_> {
        match &self.law {
            OcclusionLaw::Hard(hard) => Box::new(Solid { hard, colour }),
            _ => {
                let blockers = if block { &self.blockers } else { &self.earlier };
                Box::new(Open(blockers.get(colour).or(blockers.first())))
            }
        }
    }

    /// Makes the cells of a level dark that no light can enter.
    pub fn darken(&self, level: usize, light: &mut Grid<T>) {
        if let OcclusionLaw::Hard(hard) = &self.law {
            Solid { hard, colour: 0 }.darken(level, light);
        }
    }

    /// As the fast loops take them in a step of the finest level, its number counted from 1.
    pub fn at_finest(&self, colour: usize, step: usize) -> WithSolids<'_, T> {
        let which = Which { level: 0, colour, blocks: step >= self.from_iteration };
        WithSolids { occluders: &self.law, which, touched: &self.touched, stencil: &self.stencil }
    }

    /// The largest that a step among them multiplies a coefficient by, where they are not hard; else 0.
    pub fn norm(&self) -> f64 {
        self.blockers.iter().chain(&self.earlier).map(Blockers::norm).fold(0.0, f64::max)
    }

    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        self.law.bytes()
            + self.touched.bytes()
            + self.blockers.iter().chain(&self.earlier).map(Blockers::bytes).sum::<usize>()
    }
}

/// Bytes that the occluders of a problem will take, and the leaves that they touch, on levels of these sizes, for so many
/// colours in numbers of so many bytes.
pub fn bytes(problem: &Problem, sizes: Levels, colours: usize, number: usize) -> u64 {
    let Some(scheme) = schemes::find(&problem.propagation.scheme).filter(|_| problem.has_occluders()) else { return 0 };
    let law = occlusion::bytes(problem, &scheme, sizes, number);
    let acts = Acts::of(problem, &scheme);
    if acts == Acts::Hard {
        return law;
    }
    let turns = turns(problem, &scheme);
    let late = turns && problem.occlusion.from_iteration > LINEAR_FROM;
    let of_level = |level: usize| {
        let touched = acts.touched(problem, sizes, level) as usize;
        let blockers = Blockers::bytes_of(level, touched) * if late { 2 } else { 1 };
        blockers + touched * size_of::<touched::Touched<f32>>() * number / size_of::<f32>()
    };
    let all: usize = (0..sizes.count()).map(of_level).sum();
    law + (all * if turns { colours } else { 1 }) as u64
}

/// Whether what is not hard turns light, each colour as its albedo has it.
fn turns(problem: &Problem, scheme: &Scheme) -> bool {
    scheme.surface == Surface::Mirrored || problem.occlusion.bounce != 0.0
}

/// What acts otherwise than hard occluders do, by colour.
fn by_colour(problem: &Problem, sizes: Levels, scheme: &Scheme, colours: usize, blocks: bool) -> Option<Vec<Blockers>> {
    let n = sizes.finest();
    let Acting { law, .. } = Acting::<f64>::new(problem, Levels::new(n, n)?, scheme)?;
    let stencil = Stencil::<f64>::new(scheme, problem.propagation.factor, false);
    let free = matrices(|d, light| stencil.send(d.index(), light));
    let touched = law.touched(0, n).cells;
    let of_colour = |colour| {
        let which = Which { level: 0, colour, blocks };
        let matrices = touched.iter().filter_map(|cell| Some((*cell, law.matrices(&stencil, which, *cell)?)));
        Blockers::new(sizes, free, matrices)
    };
    Some((0..colours).map(of_colour).collect())
}
