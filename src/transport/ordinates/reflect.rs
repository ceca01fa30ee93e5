//! Light that solids send back, as diffuse surfaces do.
//!
//! Of the flux that enters an occupied cell by its face across axis k the share opacity_k ([`Transmittance`]) ends there. Its albedo's part,
//! times the preset's `bounce`, leaves the cell in the next step, by the cosine about the axis towards where it came
//! from: what cells know of a surface is where it stops light, so a slanted one reflects as stairs do.
//!
//! Nothing else is lost or gained: at factor 4 a closed room of one albedo ρ receives Φ/(1 − ρ) of the flux Φ that is
//! sent into it.

use rayon::prelude::*;

use super::stepper::Stepper;
use crate::field::{Cell, Channels};
use crate::scene::Problem;
use crate::sh::Real;
use crate::transport::transmittance::{Transmittance, Ways};

/// What occupied cells send back.
#[derive(Clone, Debug)]
pub(super) struct Reflectors {
    solids: Vec<Reflector>,
}

#[derive(Clone, Copy, Debug)]
struct Reflector {
    cell: Cell,
    /// For light that travels forwards and backwards along each axis.
    ends: Ways,
    /// The number of its cell among those of sheets.
    sheet: Option<usize>,
    /// By axis, whether a sheet stands nearer to the lower border.
    low: [bool; 3],
    /// By colour, of the light that ends here.
    share: [f64; 3],
}

impl Reflectors {
    /// Those of a problem; `None` where nothing is sent back.
    pub fn of(problem: &Problem, transmittance: Option<&Transmittance>) -> Option<Self> {
        let bounce = problem.occlusion.bounce;
        let transmittance = transmittance.filter(|_| bounce > 0.0)?;
        let reflector = |solid: &crate::scene::Solid| {
            let share = solid.albedo.map(|albedo| albedo * bounce);
            let passes = [false, true].map(|backwards| transmittance.along(solid.cell, [backwards; 3]));
            let (sheet, low) = (transmittance.sheet(solid.cell), transmittance.at_exit(solid.cell, [true; 3]));
            Reflector { cell: solid.cell, ends: passes.map(|way| way.map(|share| 1.0 - share)), sheet, low, share }
        };
        let solids = problem.solids.iter().map(reflector).filter(|solid| solid.share != [0.0; 3]);
        Some(Reflectors { solids: solids.collect() })
    }

    /// The most that becomes of a unit of flux that ends at a solid.
    pub fn most(&self) -> f64 {
        self.solids.iter().flat_map(|solid| solid.share).fold(0.0, f64::max)
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.solids.as_slice())
    }

    /// Bytes that those of a problem will take, with what they are about to send in numbers of so many bytes.
    pub fn bytes_of(problem: &Problem, number: usize) -> u64 {
        if problem.occlusion.bounce == 0.0 || !problem.has_occluders() {
            return 0;
        }
        (problem.solids.len() * (size_of::<Reflector>() + 6 * 6 * number)) as u64
    }
}

impl<T: Real> Stepper<T> {
    /// Has what came to solids in the last step sent back by the next one.
    pub(super) fn reflect(&mut self, reflectors: &Reflectors, channels: &Channels, channel: usize) {
        if !self.has_moved() {
            return;
        }
        let ended = |solid: &Reflector| {
            let share = channels.weight(channel, solid.share);
            self.ended(solid).map(|ways| ways.map(|flux| flux * share))
        };
        let flux: Vec<[[f64; 2]; 3]> = reflectors.solids.par_iter().map(ended).collect();
        for (solid, flux) in reflectors.solids.iter().zip(flux) {
            for (axis, ways) in flux.into_iter().enumerate() {
                // What travelled forwards goes back backwards.
                for (sign, flux) in [-1.0, 1.0].into_iter().zip(ways).filter(|(_, flux)| *flux > 0.0) {
                    self.inject_surface(solid.cell, glam::DVec3::AXES[axis] * sign, flux);
                }
            }
        }
    }

    /// By axis the flux that ended at a solid: of what travelled forwards along it, and of what travelled backwards.
    fn ended(&self, solid: &Reflector) -> [[f64; 2]; 3] {
        let mut ended = [[0.0; 2]; 3];
        for (backwards, _, came, left) in self.arrivals(solid.cell, solid.sheet) {
            for axis in 0..3 {
                let at_exit = solid.sheet.is_some() && solid.low[axis] == backwards[axis];
                let flux: f64 = (if at_exit { left } else { came })[axis].iter().map(|flux| flux.to_f64()).sum();
                let way = usize::from(backwards[axis]);
                ended[axis][way] += flux * f64::from(solid.ends[way][axis]);
            }
        }
        ended
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;
    use crate::scene::occluder::OcclusionMode;
    use crate::scene::propagation::directions::{Lattice, Rule};
    use crate::scene::receiver::Receiver;
    use crate::scene::{Occlusion, Solid};
    use crate::sh::Sh;
    use crate::transport::ordinates::Ordinates;
    use crate::transport::ordinates::receive::Facing;
    use glam::DVec3;

    const N: usize = 8;

    /// Six walls in the outermost cells of a volume, those in edges and corners two or three at once.
    fn room(albedo: f64) -> Vec<Solid> {
        let at_border = |cell: Cell| cell.map(|c| if c == 0 || c == N - 1 { 1.0 } else { 0.0 });
        let cells = crate::field::Layout::new(N).cells().filter(|cell| at_border(*cell) != [0.0; 3]);
        let stands = |cell: Cell| cell.map(|c| if c == 0 { 0.0 } else { 1.0 });
        let filled = |cell| Solid::new(cell, DVec3::ZERO, 1.0, [albedo; 3]);
        let solid = |cell| Solid { opacity: at_border(cell), stands: Some(stands(cell)), ..filled(cell) };
        cells.map(solid).collect()
    }

    /// The walls' inner sides.
    fn sides() -> Vec<Receiver> {
        let side = |axis: usize, far: bool, i: usize| {
            let mut cell = [0; 3];
            (cell[axis], cell[(axis + 1) % 3], cell[(axis + 2) % 3]) = (if far { N - 1 } else { 0 }, i % N, i / N);
            Receiver { cell, normal: DVec3::AXES[axis] * if far { -1.0 } else { 1.0 } }
        };
        let all = (0..3).flat_map(|axis| [false, true].map(|far| (axis, far)));
        all.flat_map(|(axis, far)| (0..N * N).map(move |i| side(axis, far, i))).collect()
    }

    /// All that the walls receive of what the cell (3, 4, 3) sends, over what it sends.
    fn received(albedo: f64, bounce: f64, rule: Rule) -> f64 {
        let solids = room(albedo);
        let walls = Transmittance::of_sheet(N, &solids);
        let occlusion = Occlusion { mode: OcclusionMode::Hard, bounce, ..Occlusion::default() };
        let problem = Problem { size: N, solids, occlusion, ..Problem::default() };
        let reflectors = Reflectors::of(&problem, walls.as_ref());
        assert_eq!(reflectors.is_some(), bounce > 0.0);
        let mut stepper = Stepper::<f32>::new(Ordinates::new(Lattice::Octahedral, 72, rule), N);
        stepper.inject([3, 4, 3], Sh([1.0, 0.0, 0.0, 0.0]));
        let (receivers, channels) = (sides(), Channels::of_colors(&[[1.0; 3]]));
        let facing = Facing::new(N, &receivers, walls.as_ref());
        let (mut arrived, mut sums) = (Grid::new(N), vec![0.0; receivers.len()]);
        for _ in 0..600 {
            if let Some(reflectors) = &reflectors {
                stepper.reflect(reflectors, &channels, 0);
            }
            stepper.step(1.0, walls.as_ref(), &mut arrived);
            stepper.receive(&facing, &mut sums);
        }
        sums.iter().sum::<f64>() / (2.0 * std::f64::consts::PI.sqrt())
    }

    #[test]
    fn a_closed_room_receives_what_was_sent_over_one_less_its_albedo() {
        for rule in Rule::ALL {
            for (albedo, bounce) in [(0.7, 0.0), (0.5, 1.0), (0.8, 1.0), (0.8, 0.5)] {
                let wanted = 1.0 / (1.0 - albedo * bounce);
                let found = received(albedo, bounce, rule);
                assert!((found / wanted - 1.0).abs() < 1e-3, "{rule:?}, {albedo}, {bounce}: {found}, {wanted}");
            }
        }
    }
}
