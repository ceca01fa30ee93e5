//! The first steps, on which clamps act: light on its way into the cone.

use crate::field::{Grid, Marks};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::kernel::{Instructions, Level, Order, lies_in_cone, pass};
use crate::transport::team;

/// The most steps taken.
const MOST_STEPS: usize = 16;

/// Light and where it is lit, with the memory that steps take.
#[derive(Clone, Debug)]
pub struct ClampedSteps {
    order: Order<f32>,
    cone: f64,
    source: Grid<f32>,
    source_lit: Marks,
    target: Grid<f32>,
    target_lit: Marks,
    /// Kept for the loops, which mark where light has been; nobody asks.
    marks: Marks,
}

impl ClampedSteps {
    /// For light of one form in an n³ grid.
    pub fn new(form: &Form<f32>, cone: f64, n: usize) -> Self {
        let order = Order {
            form: *form,
            linear: false,
            drop_dark: true,
            cone: Some(cone),
            energy: false,
            instructions: Instructions::Best,
        };
        let (dark, unlit) = (|| Grid::new(n), || Marks::new(n));
        let [source, target] = [dark(), dark()];
        let [source_lit, target_lit, marks] = [unlit(), unlit(), unlit()];
        ClampedSteps { order, cone, source, source_lit, target, target_lit, marks }
    }

    /// Takes steps until no clamp acts any more, and sets `sum` to all snapshots before that one; whether it
    /// came to that.
    pub fn run(&mut self, injected: &Grid<f32>, sum: &mut Grid<f32>) -> bool {
        let ClampedSteps { order, cone, source, source_lit, target, target_lit, marks } = self;
        let planes = injected.planes().iter().zip(source.planes_mut()).zip(sum.planes_mut());
        team::share(planes.collect(), |((injected, source), sum): ((&Vec<f32>, &mut [f32]), &mut [f32])| {
            source.copy_from_slice(injected);
            sum.copy_from_slice(injected);
        });
        source_lit.clear();
        source_lit.mark_lit(injected);
        if cone.is_infinite() || lies_in_cone(source, source_lit, *cone) {
            sum.clear();
            return true;
        }
        for _ in 0..MOST_STEPS {
            let mut level = Level { source, source_lit, target, target_lit, sum: None, marks };
            let tally = pass::advance(order, &mut level, 1, rayon::current_num_threads(), None);
            if tally.in_cone {
                return true;
            }
            sum.add_grid(source);
        }
        false
    }

    /// The first snapshot that is not clamped any more.
    pub fn light(&self) -> &Grid<f32> {
        &self.source
    }

    /// Where it may be lit.
    pub fn lit(&self) -> &Marks {
        &self.source_lit
    }
}
