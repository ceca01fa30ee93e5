//! What light is held against: the one list of it.
//!
//! An expectation says what the light of a cell ought to be. Errors ([`error`]) are what is found minus
//! that. Whoever shows, lists or writes an error asks here for its name, for what has to be computed first, for
//! whether levels are told apart, for the value of a cell and for the rows of a state:
//!
//! | name | what is found | what is expected | levels |
//! |---|---|---|---|
//! | thesis | the accumulated light of a level | the mean of its children, in the same octree (000, 6.2) | from 1 on |
//! | corrected | the accumulated light of a level | a uniform volume of the finest size, downsampled (000, 7) | from 1 on |
//! | merged | the merged light | that uniform volume (000, 6.2) | no |
//! | ballistic | the merged light that has moved, S_A − S_0 | what truly arrives along straight lines | no |
//! | surface | the light on a mesh's surfaces | what truly reaches them after one bounce, path traced | no |
//! | picture | what the scene's camera sees | the path-traced picture of one bounce | no |
//! | run | the merged light | that of another run of the same scene, after the same iterations | no |
//!
//! The thesis's says how much levels disagree, not which of them is right; corrected and merged what the octree
//! costs; ballistic what the scheme costs; surface and picture what of all that somebody sees, and whose truth has an
//! error bar of its own ([`error::Traced`]). A uniform volume is one level of the finest size, propagated on its
//! own. Every level of an octree is propagated by itself, so the octree's own finest level is that volume, and
//! it costs nothing more. What truly arrives has to be computed before, and another run is named ([`References`]).
//!
//! A new expectation is a variant here, its light in [`held`], and, where it needs more than the run itself, a
//! field of [`References`].

pub mod error;
pub(crate) mod held;
pub mod truths;

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::field::Grid;
use crate::render::stage::Set;
use crate::scene::Problem;
use crate::sh::Real;
use crate::simulation::Simulation;
use crate::transport::ballistic::Ballistic;
use error::ErrorRow;
pub use held::Held;
use truths::{PictureTruth, SurfaceTruth};

/// What light is held against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Expectation {
    /// Every level with the mean of its children in the next finer level of the same octree (000, 6.2).
    #[default]
    Thesis,
    /// Every level from 1 on with the uniform volume, downsampled (000, 7).
    Corrected,
    /// The merged light, S(x, y, z) for every finest cell, with the uniform volume (000, 6.2).
    #[serde(alias = "Uniform")]
    Merged,
    /// The merged light that has moved, S_A − S_0, with the flux that truly enters each cell along straight lines.
    Ballistic,
    /// The irradiance of a mesh's surfaces with what truly reaches them after one bounce.
    Surface,
    /// What the scene's camera sees with its path-traced picture.
    Picture,
    /// The merged light with that of another run of the same scene.
    Run,
}

impl Expectation {
    /// All there are, in the order in which they are listed.
    ///
    /// ```
    /// use lpv_lab::study::expectation::Expectation;
    ///
    /// let with_levels: Vec<&str> =
    ///     Expectation::ALL.into_iter().filter(|one| one.has_levels()).map(Expectation::name).collect();
    /// assert_eq!(with_levels, ["thesis", "corrected"]);
    /// ```
    pub const ALL: [Expectation; 7] = [
        Expectation::Thesis,
        Expectation::Corrected,
        Expectation::Merged,
        Expectation::Ballistic,
        Expectation::Surface,
        Expectation::Picture,
        Expectation::Run,
    ];

    /// Its name in files and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Expectation::Thesis => "thesis",
            Expectation::Corrected => "corrected",
            Expectation::Merged => "merged",
            Expectation::Ballistic => "ballistic",
            Expectation::Surface => "surface",
            Expectation::Picture => "picture",
            Expectation::Run => "run",
        }
    }

    /// The name of what is expected, as `--reference` takes it and as the column `reference` of files has it.
    pub fn reference(self) -> &'static str {
        match self {
            Expectation::Thesis => "children",
            Expectation::Corrected | Expectation::Merged => "uniform",
            Expectation::Ballistic => "ballistic",
            Expectation::Surface => "surface",
            Expectation::Picture => "picture",
            Expectation::Run => "run",
        }
    }

    /// The same in the words that follow "error against".
    pub fn against(self) -> &'static str {
        match self {
            Expectation::Thesis => "its children",
            Expectation::Corrected | Expectation::Merged => "a uniform volume",
            Expectation::Ballistic => "what truly arrives",
            Expectation::Surface => "what truly reaches surfaces",
            Expectation::Picture => "the path-traced picture",
            Expectation::Run => "another run",
        }
    }

    /// What is compared with what, in a line.
    pub fn summary(self) -> &'static str {
        match self {
            Expectation::Thesis => "Every level against the mean of its children",
            Expectation::Corrected => "Every level against a uniform volume, downsampled",
            Expectation::Merged => "The merged light against a uniform volume",
            Expectation::Ballistic => "The merged light that has moved against what truly arrives along straight lines",
            Expectation::Surface => "The light on surfaces against what truly reaches them after one bounce",
            Expectation::Picture => "What the scene's camera sees against the path-traced picture of one bounce",
            Expectation::Run => "The merged light against that of another run, after the same iterations",
        }
    }

    /// Whether it tells the levels of an octree apart.
    pub fn has_levels(self) -> bool {
        matches!(self, Expectation::Thesis | Expectation::Corrected)
    }

    /// Those that hold what is made of the merged light against what the scene alone says: what schemes are compared by.
    pub fn of_merged_light() -> impl Iterator<Item = Expectation> {
        Self::ALL.into_iter().filter(|one| !one.has_levels() && *one != Expectation::Run)
    }

    /// Whether errors are also told after the one scalar that fits best: where the expectation has a scale of its
    /// own, for renderers scale by taste.
    pub fn is_scaled_by_taste(self) -> bool {
        matches!(self, Expectation::Ballistic | Expectation::Run) || self.needs_mesh()
    }

    /// Whether it is about the surfaces of a scene's mesh, and so is never ready for a scene without one.
    pub fn needs_mesh(self) -> bool {
        matches!(self, Expectation::Surface | Expectation::Picture)
    }

    /// The problem with what it takes from a run's transport: what surfaces are asked for their light.
    pub fn prepared(self, problem: Problem) -> Problem {
        match &problem.stage {
            Some(stage) if self.needs_mesh() => Set::new(&Arc::clone(stage)).prepared(problem),
            _ => problem,
        }
    }

    /// Whether all that it needs is there.
    pub fn is_ready(self, references: &References) -> bool {
        match self {
            Expectation::Thesis | Expectation::Corrected | Expectation::Merged => true,
            Expectation::Ballistic => references.ballistic.is_some(),
            Expectation::Surface => references.surface.is_some(),
            Expectation::Picture => references.picture.is_some(),
            Expectation::Run => references.run.is_some(),
        }
    }

    /// Computes what it needs of a problem and is not there yet; another run is whoever's it is to name. `progress` hears of the share done, 0 to 1, from
    /// any thread, and returns whether to go on.
    pub fn prepare(self, problem: &Problem, references: &mut References, progress: &(dyn Fn(f64) -> bool + Sync)) {
        if self.is_ready(references) {
            return;
        }
        match self {
            Expectation::Thesis | Expectation::Corrected | Expectation::Merged | Expectation::Run => (),
            Expectation::Ballistic => references.ballistic = Ballistic::new(problem, progress).map(Arc::new),
            Expectation::Surface => references.surface = SurfaceTruth::of(problem, progress),
            Expectation::Picture => references.picture = PictureTruth::of(problem, progress),
        }
    }

    /// The light of a state beside what it ought to be; `None` while the references lack what that needs.
    pub fn of<'a, T: Real>(self, state: &'a Simulation<T>, references: &'a References) -> Option<Held<'a, T>> {
        Held::new(self, state, references)
    }

    /// The errors of a state, as [`Held::rows`] has them; none while the references lack what that needs.
    ///
    /// ```
    /// use lpv_lab::scene::Problem;
    /// use lpv_lab::simulation::Simulation;
    /// use lpv_lab::study::expectation::{Expectation, References};
    /// use lpv_lab::transport::preset;
    ///
    /// let text = "(version: 1, size: 8, injectors: [(kind: Single(cell: (4, 4, 4)))])";
    /// let problem = Problem::build(&preset::parse(text, "lobe.ron".as_ref())?, "".as_ref())?;
    /// let mut simulation = Simulation::<f32>::new(problem)?;
    /// simulation.run(|_| true);
    ///
    /// let mut references = References::default();
    /// assert!(Expectation::Ballistic.rows(&simulation, &references).is_empty());
    /// Expectation::Ballistic.prepare(simulation.problem(), &mut references, &|_| true);
    /// // No scheme of the lattice comes near to light that goes straight.
    /// assert!(Expectation::Ballistic.rows(&simulation, &references)[0].l1_best_fit > Some(0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn rows<T: Real>(self, state: &Simulation<T>, references: &References) -> Vec<ErrorRow> {
        self.of(state, references).map(|held| held.rows()).unwrap_or_default()
    }
}

impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What was computed of a problem for those expectations that need more than a run itself.
#[derive(Clone, Debug, Default)]
pub struct References {
    /// What truly arrives along straight lines.
    pub ballistic: Option<Arc<Ballistic>>,
    /// What truly reaches the surfaces of its mesh.
    pub surface: Option<Arc<SurfaceTruth>>,
    /// What its camera truly sees.
    pub picture: Option<Arc<PictureTruth>>,
    /// The merged light of another run after the same iterations, a grid for each channel.
    pub run: Option<Arc<[Grid<f32>]>>,
}

impl References {
    /// Drops what is not of `problem`, and the other run, of which that is not known.
    pub fn turn_to(&mut self, problem: &Problem) {
        self.run = None;
        self.ballistic.take_if(|ballistic| !ballistic.is_of(problem));
        self.surface.take_if(|surface| !surface.is_of(problem));
        self.picture.take_if(|picture| !picture.is_of(problem));
    }
}
