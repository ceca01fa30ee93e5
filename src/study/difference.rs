//! Two runs put against each other: how far the light of the second is from that of the first, and how far it has
//! moved. So it is seen what one cell's move of a light does, or another factor, or another file.

use super::error::{ErrorRow, Tally};
use super::expectation::Expectation;
use super::light::{Brightness, centroid, in_colours, sampled};
use crate::field::{Cell, Layout};
use crate::sh::Sh;
use crate::simulation::Simulation;

/// How the second of two runs differs from the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The errors of the second's light, the first's being what is expected: of the merged light first, with no
    /// level, then of the accumulated light of each level that both have.
    pub rows: Vec<ErrorRow>,
    /// Where the merged light has its centroid, in cells (x, y, z): in the first run, in the second.
    pub centroids: [[f64; 3]; 2],
    /// Where the injected light has it.
    pub injected: [[f64; 3]; 2],
}

impl Difference {
    /// Between two runs of the same size; `None` if the sizes differ.
    ///
    /// ```
    /// use lpv_lab::scene::Problem;
    /// use lpv_lab::simulation::Simulation;
    /// use lpv_lab::study::difference::Difference;
    /// use lpv_lab::transport::preset;
    ///
    /// let run = |x: usize| -> Result<Simulation<f32>, Box<dyn std::error::Error>> {
    ///     let text = format!("(version: 1, size: 16, injectors: [(kind: Single(cell: ({x}, 8, 8)))])");
    ///     let problem = Problem::build(&preset::parse(&text, "lobe.ron".as_ref())?, "".as_ref())?;
    ///     let mut simulation = Simulation::new(problem)?;
    ///     simulation.run(|_| true);
    ///     Ok(simulation)
    /// };
    /// let difference = Difference::between(&run(7)?, &run(8)?).expect("both are of one size");
    /// assert_eq!(difference.moved(), [1.0, 0.0, 0.0]);
    /// assert!(difference.rows[0].l1_ratio > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn between(first: &Simulation<f32>, second: &Simulation<f32>) -> Option<Self> {
        let n = first.sizes().finest();
        if n != second.sizes().finest() {
            return None;
        }
        let k = second.iteration();
        let runs = [first, second];
        let merged = runs.map(sampled);
        let of_merged =
            |run: usize, cell: Cell| in_colours(runs[run].channels(), |channel| merged[run][channel].get(cell));
        let mut rows = vec![tally(n, of_merged).row(k, Expectation::Merged, None)];
        for level in 0..first.sizes().count().min(second.sizes().count()) {
            let of_level = |run: usize, cell: Cell| {
                in_colours(runs[run].channels(), |channel| {
                    runs[run].lights()[channel].accumulated.level(level).get(cell)
                })
            };
            rows.push(tally(n >> level, of_level).row(k, Expectation::Merged, Some(level)));
        }
        let place = |run: usize| centroid(n, &Brightness::new(runs[run].channels()).of_grids(&merged[run]));
        let injected = |run: &Simulation<f32>| {
            centroid(n, &Brightness::new(run.channels()).of_grids(&run.problem().injected::<f64>(run.channels())))
        };
        Some(Difference { rows, centroids: [place(0), place(1)], injected: runs.map(injected) })
    }

    /// From the first's centroid of the merged light to the second's, in cells.
    pub fn shift(&self) -> [f64; 3] {
        step(self.centroids)
    }

    /// The same of the injected light: how far the light itself was moved.
    pub fn moved(&self) -> [f64; 3] {
        step(self.injected)
    }
}

fn step([from, to]: [[f64; 3]; 2]) -> [f64; 3] {
    // Adding 0 turns −0 into 0.
    std::array::from_fn(|axis| to[axis] - from[axis] + 0.0)
}

/// Compares every cell of an n³ grid; `light` gives a run's, by its number, in red, green and blue.
fn tally(n: usize, light: impl Fn(usize, Cell) -> [Sh<f64>; 3]) -> Tally {
    let norm = |light: [Sh<f64>; 3]| light.iter().map(|sh| sh.max_norm()).fold(0.0, f64::max);
    let mut tally = Tally::default();
    for cell in Layout::new(n).cells() {
        let (expected, found) = (light(0, cell), light(1, cell));
        let difference = std::array::from_fn(|colour| found[colour] - expected[colour]);
        tally.add(norm(difference), norm(found), norm(expected));
    }
    tally
}
