//! One iteration among occluders, line by line as MATH.md section 9 has it, in either precision.
//!
//! Like [`super::plain`] this is a definition: it gathers, cell by cell, what the six neighbours send.

use super::settle;
use crate::field::{Cell, Grid};
use crate::propagate::barrier::Barrier;
use crate::propagate::face::Direction;
use crate::propagate::geometry::Geometry;
use crate::propagate::stencil::Stencil;
use crate::sh::{Real, Sh};

/// What NVIDIA's sample multiplies its reflected light by.
const REFLECTION: f64 = 4.8;

/// The occluders of a scene, and what they do to light.
#[derive(Clone, Debug, PartialEq)]
pub enum Occluders<T> {
    /// Blockers weaken light, and reflect some of it.
    Fuzzy(Fuzzy<T>),
    /// Occupied cells mirror light.
    Mirrored(Mirrored<T>),
    /// Occupied cells pass nothing.
    Hard(Hard<T>),
}

/// Blockers half a cell off the light weaken the flux through every face and reflect some of it (000, 6.2;
/// NVIDIA's sample).
#[derive(Clone, Debug, PartialEq)]
pub struct Fuzzy<T> {
    /// The blockers.
    pub geometry: Geometry<T>,
    /// What a blocker's value is multiplied by before it is limited to 0..1. Where it is positive, blockers
    /// are evaluated along the light's travel, where negative against it.
    pub amplifier: T,
    /// What reflected light is multiplied by.
    pub bounce: T,
}

/// Light that enters an occupied cell is mirrored on the axis along which it came, times opacity and albedo,
/// and goes on from there (001, 4.2).
#[derive(Clone, Debug, PartialEq)]
pub struct Mirrored<T> {
    /// The occupied cells.
    pub geometry: Geometry<T>,
}

/// An occupied cell passes nothing. What would have entered it is mirrored back to the cell it came from,
/// times albedo and bounce, and otherwise absorbed.
#[derive(Clone, Debug, PartialEq)]
pub struct Hard<T> {
    /// What passes.
    pub barrier: Barrier<T>,
    /// The albedos.
    pub geometry: Geometry<T>,
    /// What reflected light is multiplied by.
    pub bounce: T,
}

/// Which light is propagated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Which {
    /// The level, 0 the finest.
    pub level: usize,
    /// The colour whose albedo counts: 0 red, 1 green, 2 blue.
    pub colour: usize,
}

impl<T: Real> Occluders<T> {
    /// Sets `target` to what all cells of `source` send to their neighbours, as far as occluders let it.
    /// Outside the grid is dark.
    pub fn propagate(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, target: &mut Grid<T>) {
        for cell in source.layout().cells() {
            let receive = |d| match self {
                Occluders::Fuzzy(fuzzy) => fuzzy.receive(stencil, which, source, cell, d),
                Occluders::Mirrored(mirrored) => mirrored.receive(stencil, which, source, cell, d),
                Occluders::Hard(hard) => hard.receive(stencil, which, source, cell, d),
            };
            target.set(cell, settle((0..Direction::ALL.len()).map(receive).sum()));
        }
    }
}

/// The light of the neighbour from which light in direction `d` enters `cell`; none outside the grid.
fn sender<T: Real>(source: &Grid<T>, cell: Cell, d: Direction) -> Sh<T> {
    d.opposite().neighbour(cell, source.side()).map_or(Sh::ZERO, |sender| source.get(sender))
}

impl<T: Real> Fuzzy<T> {
    fn receive(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, cell: Cell, d: usize) -> Sh<T> {
        let direction = Direction::ALL[d];
        let light = sender(source, cell, direction);
        let near = self.mean(cell, direction.opposite(), |at| self.geometry.lobe(which.level, at));
        let far = self.mean(cell, direction, |at| self.geometry.lobe(which.level, at));
        let facing = far.eval(direction.opposite().vector()).max(T::ZERO);
        let mut reflected = T::ZERO;
        let mut received = Sh::ZERO;
        for tap in &stencil.taps()[d] {
            let blocked = (self.amplifier * near.dot(tap.travel)).max(T::ZERO);
            let flux = tap.flux(light) * (T::of(1.0) - blocked).max(T::ZERO);
            received += tap.lobe * flux;
            reflected += facing * flux * T::of(REFLECTION);
        }
        if reflected == T::ZERO || self.bounce == T::ZERO {
            return received;
        }
        let albedo = |at| Sh([self.geometry.albedo(which.level, at, which.colour), T::ZERO, T::ZERO, T::ZERO]);
        let Sh([albedo, ..]) = self.mean(cell, direction, albedo);
        received + stencil.scale(far * (reflected * albedo * self.bounce))
    }

    /// The mean of what the four corners of `cell` on the side of `side` hold. Corner g is shared by the
    /// cells g and g + (1, 1, 1); corners outside the grid count as empty.
    fn mean(&self, [x, y, z]: Cell, side: Direction, value: impl Fn(Cell) -> Sh<T>) -> Sh<T> {
        let corners = (0..8).map(|bits| [bits & 1, bits >> 1 & 1, bits >> 2]);
        let on_side = corners.filter(|low| (low[side.axis()] == 0) == side.is_positive());
        let sum: Sh<T> = on_side
            .filter(|low| x >= low[0] && y >= low[1] && z >= low[2])
            .map(|low| value([x - low[0], y - low[1], z - low[2]]))
            .sum();
        sum * T::of(0.25)
    }
}

impl<T: Real> Mirrored<T> {
    fn receive(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, cell: Cell, d: usize) -> Sh<T> {
        let direction = Direction::ALL[d];
        let sent = stencil.send(d, sender(source, cell, direction));
        let occupied = self.geometry.opacity(which.level, cell);
        let reflected = occupied * self.geometry.albedo(which.level, cell, which.colour);
        sent * (T::of(1.0) - occupied) + sent.mirrored(direction.axis()) * reflected
    }
}

impl<T: Real> Hard<T> {
    /// Besides what `cell` receives in direction `d`, what the neighbour in that direction sends back to it.
    fn receive(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, cell: Cell, d: usize) -> Sh<T> {
        let direction = Direction::ALL[d];
        let passes = |cell| self.barrier.passes(which.level, cell, direction.axis());
        let mut received = stencil.send(d, sender(source, cell, direction));
        if let Some(next) = direction.neighbour(cell, source.side()) {
            let albedo = self.geometry.albedo(which.level, next, which.colour);
            let reflected = (T::of(1.0) - passes(next)) * albedo * self.bounce;
            if reflected > T::ZERO {
                received += stencil.send(d, source.get(cell)).mirrored(direction.axis()) * reflected;
            }
        }
        received * passes(cell)
    }
}
