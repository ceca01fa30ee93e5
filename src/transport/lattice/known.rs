//! What the fast loops know about light from one iteration to the next.

use super::kernel::form::Form;
use super::kernel::lies_in_cone;
use super::reach::everywhere;
use crate::field::{IndexVolume, Marks};
use crate::sh::Real;
use crate::transport::options::Options;
use crate::transport::state::Light;

/// What is known of one channel's light on one level.
#[derive(Clone, Debug)]
pub(super) struct Known {
    /// Where the source may be lit.
    pub(super) source: Marks,
    /// Where the target may be lit.
    pub(super) target: Marks,
    /// Whether the source meets no clamp, now and in all iterations to come.
    pub(super) linear: bool,
    /// Whether the source is a sum of what the scheme sends, with all faces clamped.
    pub(super) of_lobes: bool,
    /// Σ c00 of the source and of what was accumulated, if anybody asks.
    pub(super) energy: [f64; 2],
}

impl Known {
    /// Looks at one channel's light on level `i`.
    pub(super) fn of<T: Real>(
        light: &Light<T>,
        index: &IndexVolume,
        i: usize,
        form: Option<&Form<T>>,
        options: &Options,
    ) -> Self {
        let grid = light.source.level(i);
        let lit = if options.skip.reach { index.level(i).clone() } else { everywhere(grid.side()) };
        let cone = form.and_then(|form| form.cone);
        let linear = cone.is_some_and(|r| r.is_infinite() || lies_in_cone(grid, &lit, r));
        let energy = match options.tolerance {
            Some(_) => [grid.energy(), light.accumulated.level(i).energy()],
            None => [0.0; 2],
        };
        Known { source: lit.clone(), target: lit, linear, of_lobes: false, energy }
    }

    /// An upper bound on Σ c00 of all light still to come, over the accumulated Σ c00, as far as the scheme's gain
    /// allows one.
    pub(super) fn still_to_come<T: Real>(&self, form: &Form<T>) -> Option<f64> {
        let in_cone = self.linear && form.cone.is_some_and(f64::is_finite);
        let gain = if in_cone { Some(form.gain.in_cone) } else { form.gain.of_lobes.filter(|_| self.of_lobes) };
        let gain = gain.filter(|gain| *gain < 1.0)?;
        let [now, so_far] = self.energy;
        let coming = now * gain / (1.0 - gain);
        if coming == 0.0 { Some(0.0) } else { Some(coming / so_far) }
    }

    /// Bytes that it takes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.source.words()) + size_of_val(self.target.words())
    }
}
