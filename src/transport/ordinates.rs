//! Light that keeps its direction: discrete ordinates (MATH.md section 8).
//!
//! Every scheme of [the lattice](super::lattice) keeps two bands a cell, and blurs light like diffusion. Here light
//! travels in N directions u_j, each with its own flux F_j in every cell. What comes into a cell leaves to the
//! three neighbours downwind, in shares that are constants of the direction ([`shares`]); a cell that
//! holds injected light c adds max(0, c·Y(u_j))·w_j, w_j being the solid angle that u_j stands for; an
//! occupied cell passes the share of what enters that its opacity leaves. What arrives in a cell is
//!
//! ```text
//! Σ_j F_j·Y(u_j)
//! ```
//!
//! which approaches R of MATH.md section 6; S_A is that plus S_0. An iteration moves
//! every front by one cell ([`stepper`]); one sweep through the cells in the order of the wind gives the
//! sum over all iterations at once, and visits each cell once a direction ([`Ordinates::solve`]).
//!
//! What it gets wrong: with few directions light arrives in rays, and beams widen as they cross cell
//! borders, the donor rule's more than the face rule's.

mod beams;
pub(crate) mod directions;
mod receive;
mod reflect;
pub(crate) mod shares;
pub(crate) mod stepper;
mod surfaces;
mod sweep;

use glam::DVec3;

use super::kind::{Capabilities, Kind, Law};
use super::solve::{Found, NoFixedPoint, Solve};
use super::team;
use super::transmittance::Transmittance;
use crate::field::Grid;
use crate::scene::propagation::directions::{Lattice, Rule, Setting};
use crate::scene::{Problem, Propagation};
use crate::sh::Real;
use beams::Beams;
use directions::Direction;
use receive::Facing;
use shares::Shares;
use surfaces::ByCell;
use sweep::{Got, Sent};

/// The name of the one kind of transport that this is.
pub const NAME: &str = "ordinates";

/// Light that is propagated so, as the one kind of transport that it is.
pub fn kinds() -> Vec<Kind> {
    vec![Kind {
        name: NAME,
        summary: "light that keeps its direction, on the finest level",
        source: "discrete ordinates, by the donor cell rule or by where a beam leaves a cell",
        flaws: "with few directions light arrives in rays; beams widen as they cross cell borders",
        can: Capabilities { levels: false, occluders: true, clamp: false, grows: false },
        conserving: CONSERVING,
        laws,
        check: |_| Ok(()),
        label,
        bytes: beams::bytes,
        solver: |problem| Ok(Box::new(OneSweep::new(problem)?)),
        tolerances: &[0.0],
        variants,
        single: Beams::build,
        double: Some(Beams::build),
        card: None,
    }]
}

/// The factor at which a snapshot is what was under way.
const CONSERVING: f64 = 4.0;

/// Both lattices of directions under both rules, with some 24 to 192 directions, and no light lost under way.
fn variants(propagation: &Propagation) -> Vec<Propagation> {
    let sets = Lattice::ALL.into_iter().flat_map(|lattice| Rule::ALL.map(|rule| (lattice, rule)));
    let settings =
        sets.flat_map(|(lattice, rule)| [24, 48, 72, 128, 192].map(|directions| Setting { directions, rule, lattice }));
    settings.map(|ordinates| Propagation { ordinates, factor: CONSERVING, ..propagation.clone() }).collect()
}

/// A spiral of directions has no symmetry of the cube.
fn laws(propagation: &Propagation) -> Vec<Law> {
    let mut laws = vec![Law::Superposition, Law::Reach, Law::Conservation, Law::Shutters, Law::Precision];
    if propagation.factor == CONSERVING {
        laws.push(Law::FixedPoint);
    }
    if propagation.ordinates.lattice == Lattice::Octahedral {
        laws.push(Law::Symmetry);
    }
    laws
}

fn label(Propagation { scheme, ordinates: Setting { directions, rule, lattice }, .. }: &Propagation) -> String {
    let count = directions::directions(*lattice, *directions).len();
    format!("{scheme}-{}-{}-{count}", lattice.name(), rule.name())
}

/// Directions computed side by side.
const LANES: usize = 8;
/// A number for each of them.
type Lanes<T> = [T; LANES];
/// What comes into a cell by its near faces, or leaves it by the far ones, as the wind of a group blows.
type Came<T> = [Lanes<T>; 3];
/// Pieces that a sweep is cut into, of two octants each: always the same, so that the sum is too.
const PIECES: usize = 4;

/// A set of directions made ready to run.
#[derive(Clone, Debug)]
pub struct Ordinates<T = f32> {
    rule: Rule,
    count: usize,
    octants: Vec<Octant<T>>,
}

/// The directions that share their signs, and so the order in which they meet cells.
#[derive(Clone, Debug)]
struct Octant<T> {
    /// For x, y and z, whether light travels towards smaller indices.
    backwards: [bool; 3],
    groups: Vec<Group<T>>,
}

/// Eight directions of an octant; where there are fewer, the last lanes carry nothing.
#[derive(Clone, Debug, Default)]
struct Group<T> {
    way: [Lanes<T>; 3],
    weight: Lanes<T>,
    through: [[Lanes<T>; 3]; 3],
    start: [Lanes<T>; 3],
}

impl<T: Real> Ordinates<T> {
    /// About `count` directions of a lattice, as [`directions::directions`] has it, with a rule for their shares.
    pub fn new(lattice: Lattice, count: usize, rule: Rule) -> Self {
        let set = directions::directions(lattice, count);
        let octants = (0..8)
            .map(|o| {
                let backwards = [o & 1 != 0, o & 2 != 0, o & 4 != 0];
                let here: Vec<&Direction> =
                    set.iter().filter(|d| d.way.to_array().map(|c| c < 0.0) == backwards).collect();
                Octant { backwards, groups: here.chunks(LANES).map(|chunk| Group::new(chunk, rule)).collect() }
            })
            .collect();
        Ordinates { rule, count: set.len(), octants }
    }

    /// The directions of a setting.
    pub fn of(setting: &Setting) -> Self {
        Ordinates::new(setting.lattice, setting.directions, setting.rule)
    }

    /// How many directions there are, N.
    pub fn count(&self) -> usize {
        self.count
    }

    /// How many numbers are kept for each face: directions, and lanes that carry none.
    fn lanes(&self) -> usize {
        self.octants.iter().map(|octant| LANES * octant.groups.len()).sum()
    }

    /// The rule by which light is shared.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// What arrives in each cell, Σ_j F_j·Y(u_j), once all injected light has gone all its way. A cell's own
    /// light is not in it.
    pub fn solve(&self, injected: &Grid<T>, occluders: Option<&Transmittance>) -> Grid<T> {
        let mut arrived = Grid::new(injected.side());
        self.solve_in(&mut Room::new(injected.side()), injected, occluders, &mut arrived);
        arrived
    }

    /// [`Self::solve`] with memory that is there already; all grids are of one size.
    pub fn solve_in(
        &self,
        room: &mut Room<T>,
        injected: &Grid<T>,
        occluders: Option<&Transmittance>,
        arrived: &mut Grid<T>,
    ) {
        let (surfaces, receivers) = (ByCell::none(), Facing::default());
        let got = &mut Got { arrived, receivers: &receivers, received: &mut [] };
        self.sweep(room, &Sent::new(injected, &surfaces), occluders, got);
    }

    /// Takes all that is sent all its way: sets what arrives in the cells, adds what receivers get.
    fn sweep(&self, room: &mut Room<T>, sent: &Sent<'_, T>, occluders: Option<&Transmittance>, got: &mut Got<'_, T>) {
        let octants = self.octants.chunks(self.octants.len() / PIECES);
        let receivers = got.receivers;
        team::share(octants.zip(&mut room.pieces).collect(), |(octants, piece): (&[_], &mut Piece<T>)| {
            let Piece { under_way, arrived, received } = piece;
            arrived.clear();
            received.clear();
            received.resize(receivers.len(), 0.0);
            let mut got = Got { arrived, receivers, received };
            for octant in octants {
                sweep::sweep(octant, self.rule, sent, occluders, under_way, &mut got);
            }
        });
        let planes = got.arrived.planes_mut().into_iter().enumerate();
        team::share(planes.collect(), |(p, plane): (usize, &mut [T])| {
            plane.fill(T::ZERO);
            for piece in &room.pieces {
                plane.iter_mut().zip(&piece.arrived.planes()[p]).for_each(|(sum, c)| *sum += *c);
            }
        });
        for piece in &room.pieces {
            got.received.iter_mut().zip(&piece.received).for_each(|(sum, received)| *sum += received);
        }
    }
}

/// All light in one sweep in the order of the wind.
#[derive(Debug)]
struct OneSweep {
    ordinates: Ordinates,
    room: Room,
    occluders: Option<Transmittance>,
}

impl OneSweep {
    fn new(problem: &Problem) -> Result<Self, NoFixedPoint> {
        let Propagation { factor, ordinates, .. } = &problem.propagation;
        if *factor != CONSERVING {
            return Err(NoFixedPoint::Thinned { factor: *factor, conserving: CONSERVING });
        }
        let (room, occluders) = (Room::new(problem.size), Transmittance::of(problem));
        Ok(OneSweep { ordinates: Ordinates::of(ordinates), room, occluders })
    }
}

impl Solve for OneSweep {
    fn solve(
        &mut self,
        injected: &Grid<f32>,
        _: f64,
        light: &mut Grid<f32>,
        _: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<Found>, NoFixedPoint> {
        self.ordinates.solve_in(&mut self.room, injected, self.occluders.as_ref(), light);
        light.add_grid(injected);
        Ok(Some(Found { residual: 0.0, sweeps: 1 }))
    }
}

/// The memory of a sweep, to be used again.
#[derive(Clone, Debug)]
pub struct Room<T = f32> {
    pieces: [Piece<T>; PIECES],
}

/// The memory of one piece of it.
#[derive(Clone, Debug)]
struct Piece<T> {
    under_way: Vec<Lanes<T>>,
    arrived: Grid<T>,
    received: Vec<f64>,
}

impl<T: Real> Room<T> {
    /// Room for an n³ grid.
    pub fn new(n: usize) -> Self {
        let piece = |_| Piece { under_way: Vec::new(), arrived: Grid::new(n), received: Vec::new() };
        Room { pieces: std::array::from_fn(piece) }
    }
}

impl<T: Real> Group<T> {
    fn new(directions: &[&Direction], rule: Rule) -> Self {
        let mut group = Group::default();
        for (lane, &&Direction { way, weight }) in directions.iter().enumerate() {
            let Shares { through, start } = Shares::new(rule, way);
            group.weight[lane] = T::of(weight);
            for j in 0..3 {
                group.way[j][lane] = T::of(DVec3::to_array(&way)[j]);
                group.start[j][lane] = T::of(start[j]);
                for (to, from) in group.through.iter_mut().zip(&through) {
                    to[j][lane] = T::of(from[j]);
                }
            }
        }
        group
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Solid;
    use crate::sh::{K0, SPHERE, Sh};

    const KINDS: [(Lattice, usize, Rule); 4] = [
        (Lattice::Fibonacci, 24, Rule::Donor),
        (Lattice::Fibonacci, 50, Rule::Faces),
        (Lattice::Octahedral, 8, Rule::Faces),
        (Lattice::Octahedral, 72, Rule::Donor),
    ];

    fn lobe_in(n: usize, cell: [usize; 3], way: DVec3) -> Grid<f32> {
        let mut grid = Grid::new(n);
        grid.set(cell, Sh::lobe(way));
        grid
    }

    #[test]
    fn all_light_that_is_sent_crosses_every_shell() {
        // The flux that enters the six neighbours of a source is all there is, Σ_j w_j·max(0, c·Y(u_j)).
        for (lattice, count, rule) in KINDS {
            let light = Sh([0.9, 0.2, -0.3, 0.1]);
            let mut injected = Grid::new(8);
            injected.set([3, 4, 3], light.cast());
            let arrived = Ordinates::<f32>::new(lattice, count, rule).solve(&injected, None);
            let sent = K0 * light.0[0] * SPHERE; // positive in every direction
            let near = [[2, 4, 3], [4, 4, 3], [3, 3, 3], [3, 5, 3], [3, 4, 2], [3, 4, 4]];
            let entered: f64 = near.iter().map(|cell| f64::from(arrived.get(*cell).0[0]) / K0).sum();
            assert!((entered / sent - 1.0).abs() < 0.01, "{lattice:?} {count} {rule:?}: {entered}, {sent}");
            assert!(arrived.get([3, 4, 3]).is_zero());
        }
    }

    #[test]
    fn an_octahedral_set_treats_all_sides_alike() {
        let ordinates = Ordinates::<f32>::new(Lattice::Octahedral, 72, Rule::Faces);
        let along_x = ordinates.solve(&lobe_in(8, [2, 4, 3], DVec3::X), None);
        let against_z = ordinates.solve(&lobe_in(8, [3, 4, 5], DVec3::NEG_Z), None);
        for (cell @ [x, y, z], light) in along_x.iter() {
            // (x, y, z) → (z, y, 7 − x)
            let [c00, vx, vy, vz] = against_z.get([z, y, 7 - x]).0;
            let turned = Sh([c00, -vz, vy, vx]);
            assert!((light - turned).max_norm() < 1e-6, "{cell:?}: {light:?}, {turned:?}");
        }
    }

    #[test]
    fn light_does_not_turn_back_nor_pass_a_closed_wall() {
        let wall: Vec<Solid> = (0..64).map(|i| Solid::new([5, i % 8, i / 8], DVec3::X, 1.0, [0.0; 3])).collect();
        let occluders = Transmittance::new(8, &wall);
        for (lattice, count, rule) in KINDS {
            let arrived =
                Ordinates::<f32>::new(lattice, count, rule).solve(&lobe_in(8, [1, 4, 3], DVec3::X), occluders.as_ref());
            for (cell, light) in arrived.iter() {
                assert!(cell[0] <= 5 || light.is_zero(), "{cell:?}: {light:?}");
                assert!(light.0[0] >= 0.0);
            }
            assert!(wall.iter().any(|blocker| !arrived.get(blocker.cell).is_zero()), "the wall itself is lit");
        }
    }
}
