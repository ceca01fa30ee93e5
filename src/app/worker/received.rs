//! What a cell received in the iteration that led to a state: from which neighbour, and through which of its faces.
//!
//! The target still holds what was propagated, S_{k−1}, so one state is enough: a tap of the stencil (see
//! [`Tap`](crate::transport::lattice::stencil::Tap)) of the light of a neighbour is what went through one face, before
//! occluders took their share.

use crate::app::worker::cut::{mix, octree};
use crate::app::worker::look::{Light, Pin, PinSample, Sent};
use crate::scene::Problem;
use crate::sh::Sh;
use crate::simulation::Simulation;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::levels::{LevelOperator, operators};
use crate::transport::lattice::schemes;

/// The operators of a problem's levels, where it has a lattice.
#[derive(Debug)]
pub struct Senders(Vec<LevelOperator<f32>>);

impl Senders {
    /// Those of a problem; `None` where light does not go from neighbour to neighbour by a scheme.
    pub fn of(problem: &Problem, levels: usize) -> Option<Self> {
        let propagation = &problem.propagation;
        let scheme = schemes::find(&propagation.scheme)?;
        // Other levels have no stencil where they are exact, and in a descent light is handed down.
        let levels = if propagation.levels.is_exact() { 1 } else { levels };
        let levels = if propagation.descent.goes_down() { 0 } else { levels };
        operators(&scheme, propagation.factor, propagation.clamp, propagation.levels, levels).ok().map(Senders)
    }

    /// What the cell received from each of its neighbours within the volume.
    pub fn received(&self, state: &Simulation<f32>, pin: Pin) -> Vec<Sent> {
        let Some(operator) = self.0.get(pin.level).filter(|_| state.iteration() > 0) else { return Vec::new() };
        let side = state.sizes().side(pin.level);
        let ways = Direction::ALL.iter().enumerate();
        let sent = ways.filter_map(|(d, towards)| {
            let neighbour = towards.opposite().neighbour(pin.cell, side)?;
            let held = |channel: usize| state.lights()[channel].target.level(pin.level).get(neighbour);
            let light = mix(state, |channel| operator.stencil.send(d, held(channel)));
            let mut faces = [0.0; 6];
            for tap in &operator.stencil.taps()[d] {
                let [red, green, blue] = mix(state, |channel| tap.lobe * tap.flux(held(channel)));
                faces[facing(tap.lobe)] += (red + green + blue).0[0] / 3.0;
            }
            Some(Sent { towards: *towards, light, faces })
        });
        sent.collect()
    }
}

/// What a pinned cell holds in a state.
pub fn sample(state: &Simulation<f32>, pin: Pin, senders: Option<&Senders>) -> Option<PinSample> {
    let side = state.sizes().side(pin.level);
    if pin.level >= state.sizes().count() || pin.cell.iter().any(|c| *c >= side) {
        return None;
    }
    let of =
        |which: Light| mix(state, |channel| octree(&state.lights()[channel], which).level(pin.level).get(pin.cell));
    let received = senders.map(|senders| senders.received(state, pin)).unwrap_or_default();
    let (source, accumulated) = (of(Light::Source), of(Light::Accumulated));
    Some(PinSample { iteration: state.iteration(), source, accumulated, received })
}

/// The one of [`Direction::ALL`] that a lobe points to most.
fn facing(lobe: Sh<f32>) -> usize {
    let along = |d: &Direction| lobe.vector().dot(d.vector());
    let best = (0..6).max_by(|a, b| along(&Direction::ALL[*a]).total_cmp(&along(&Direction::ALL[*b])));
    best.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::worker::cut::tests::{ONE, track};

    #[test]
    fn what_the_neighbours_sent_is_what_the_cell_received() {
        for scheme in ["cascaded", "axial", "cone"] {
            let preset = ONE.replace("occlusion:", &format!("propagation: (scheme: \"{scheme}\"), occlusion:"));
            let track = track(&preset);
            let state = track.now();
            let senders = Senders::of(state.problem(), state.sizes().count()).unwrap();
            for (level, cell) in [(0, [2, 2, 2]), (0, [3, 3, 2]), (0, [0, 2, 2]), (1, [1, 1, 1]), (2, [0, 0, 0])] {
                let sent = senders.received(state, Pin { level, cell });
                let all: Sh<f32> = sent.iter().map(|sent| sent.light[0]).sum();
                let held = state.lights()[0].source.level(level).get(cell);
                assert!((all - held).max_norm() < 1e-6, "{scheme}, {level}, {cell:?}: {all:?} {held:?}");
                let faces: f32 = sent.iter().flat_map(|sent| sent.faces).sum();
                assert!((faces - held.0[0]).abs() < 1e-6, "{scheme}, {level}, {cell:?}");
            }
        }
    }

    #[test]
    fn a_lobe_sent_along_x_comes_through_the_far_face_and_the_four_at_the_sides() {
        let track = track(ONE);
        let senders = Senders::of(track.now().problem(), 1).unwrap();
        let tap_faces = senders.0[0].stencil.taps()[0].iter().map(|tap| facing(tap.lobe));
        let mut faces: Vec<usize> = tap_faces.collect();
        faces.sort_unstable();
        // +X and, at the sides, ±Y and ±Z; never back through −X.
        assert_eq!(faces, [0, 2, 3, 4, 5]);
    }
}
