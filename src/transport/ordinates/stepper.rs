//! Ordinates by the iteration: every front moves one cell a step.

use glam::DVec3;
use multiversion::multiversion;
use rayon::prelude::*;

use super::receive::{self, Facing};
use super::surfaces::{ByCell, Surfaces};
use super::sweep::{Got, Sent};
use super::{Came, Group, LANES, Lanes, Octant, Ordinates, Room};
use crate::field::{Cell, Grid, Layout};
use crate::scene::propagation::directions::Rule;
use crate::sh::{K0, K1, Real, Sh};
use crate::transport::transmittance::Transmittance;

/// Pieces that the directions are cut into: always the same, so that the sum is too.
const PIECES: usize = 4;

/// By axis whether a group goes backwards, the group, what came in and what was about to leave.
pub(super) type Arrival<'a, T> = ([bool; 3], &'a Group<T>, Came<T>, Came<T>);

/// Light of one channel under way in all directions. Once it moves it takes three numbers a cell and direction.
#[derive(Clone, Debug)]
pub struct Stepper<T = f32> {
    ordinates: Ordinates<T>,
    n: usize,
    /// For every group and cell, x fastest; cells in the order of the wind. Empty until something moves.
    under_way: Vec<Vec<Came<T>>>,
    /// For every group and cell of a sheet, what was about to leave by the far faces in the last step, before that met
    /// the sheet.
    left: Vec<Vec<Came<T>>>,
    /// What has not been sent yet.
    unsent: Grid<T>,
    surfaces: Surfaces<T>,
}

/// Groups with what is under way in them, and what was about to leave.
type Piece<'a, T> = ((&'a [Wind<'a, T>], &'a mut [Vec<Came<T>>]), &'a mut [Vec<Came<T>>]);

/// A group of directions, and the way it blows.
type Wind<'a, T> = (&'a Octant<T>, &'a Group<T>);

impl<T: Real> Stepper<T> {
    /// A dark volume of n³ cells.
    pub fn new(ordinates: Ordinates<T>, n: usize) -> Self {
        Stepper {
            ordinates,
            n,
            under_way: Vec::new(),
            left: Vec::new(),
            unsent: Grid::new(n),
            surfaces: Surfaces::default(),
        }
    }

    /// Bytes that it takes now.
    pub fn bytes_now(&self) -> usize {
        let cells = self.under_way.iter().chain(&self.left);
        cells.map(|cells| size_of_val(cells.as_slice())).sum::<usize>() + self.unsent.bytes() + self.surfaces.bytes()
    }

    /// Whether anything is under way, or was.
    pub(super) fn has_moved(&self) -> bool {
        !self.under_way.is_empty()
    }

    /// Makes it dark.
    pub fn clear(&mut self) {
        self.under_way.clear();
        self.left.clear();
        self.unsent.clear();
        self.surfaces.clear();
    }

    /// Adds light to a cell, to be sent by the next step.
    pub fn inject(&mut self, cell: Cell, light: Sh<T>) {
        self.unsent.add(cell, light);
    }

    /// Adds light of a surface in a cell, (flux/π)·max(0, n·u) along u, to be sent by the next step. In place of π
    /// stands what the set's directions make of it, so that no light is lost between them.
    pub fn inject_surface(&mut self, [x, y, z]: Cell, normal: DVec3, flux: f64) {
        let normal = normal.to_array().map(T::of);
        let groups = self.ordinates.octants.iter().flat_map(|octant| &octant.groups);
        let whole: f64 = groups.flat_map(|group| group.lambert(normal)).map(T::to_f64).sum();
        if whole > 0.0 {
            self.surfaces.push((z * self.n + y) * self.n + x, normal, T::of(flux / whole));
        }
    }

    /// What was in a cell in the last step: for each group of directions, by axis whether it goes backwards, the fluxes
    /// that came by its near faces, and those that were about to leave by the far ones, if it is the sheet of that number.
    pub(super) fn arrivals(&self, cell: Cell, sheet: Option<usize>) -> impl Iterator<Item = Arrival<'_, T>> {
        let groups = self.ordinates.octants.iter().flat_map(|octant| octant.groups.iter().map(move |g| (octant, g)));
        groups.zip(self.under_way.iter().zip(&self.left)).map(move |((octant, group), (came, left))| {
            let [x, y, z] = turned(octant, self.n, cell);
            let left = sheet.map_or([[T::ZERO; LANES]; 3], |number| left[number]);
            (octant.backwards, group, came[(z * self.n + y) * self.n + x], left)
        })
    }

    /// Adds to each receiver's number what came to it in the last step: its irradiance times a cell's side squared.
    pub fn receive(&self, receivers: &Facing, received: &mut [f64]) {
        let pieces = receivers.all.par_chunks(receive::PIECE).zip(received.par_chunks_mut(receive::PIECE));
        pieces.for_each(|(faces, received)| {
            for (face, received) in faces.iter().zip(received) {
                let gets = |(backwards, group, came, left): Arrival<'_, T>| {
                    receive::total(face.gets(backwards, group, [&came, &left]))
                };
                *received += self.arrivals(face.cell, face.sheet).map(gets).sum::<f64>();
            }
        });
    }

    /// What the next step will send of lobes.
    pub fn unsent(&self) -> &Grid<T> {
        &self.unsent
    }

    /// One iteration: sets `arrived` to Σ_j F_j·Y(u_j) of what then comes into each cell. Whatever leaves a cell is
    /// multiplied with `gain`.
    pub fn step(&mut self, gain: T, occluders: Option<&Transmittance>, arrived: &mut Grid<T>) {
        let groups: Vec<Wind<'_, T>> =
            self.ordinates.octants.iter().flat_map(|octant| octant.groups.iter().map(move |g| (octant, g))).collect();
        let dark = [[T::ZERO; LANES]; 3];
        self.under_way.resize_with(groups.len(), || vec![dark; self.n.pow(3)]);
        let sheets = occluders.map_or(0, Transmittance::sheets);
        self.left.resize_with(groups.len(), || vec![dark; sheets]);
        let piece = groups.len().div_ceil(PIECES).max(1);
        let surfaces = self.surfaces.by_cell(self.n);
        let (unsent, rule) = ((&self.unsent, &surfaces), self.ordinates.rule);
        let pieces =
            groups.par_chunks(piece).zip(self.under_way.par_chunks_mut(piece)).zip(self.left.par_chunks_mut(piece));
        let run = |((groups, under_way), left): Piece<'_, T>| {
            let mut arrived = Grid::new(unsent.0.side());
            for ((wind, came), left) in groups.iter().zip(under_way).zip(left) {
                advance(*wind, rule, gain, unsent, occluders, came, left);
                arrive(*wind, came, &mut arrived);
            }
            arrived
        };
        let parts: Vec<Grid<T>> = pieces.map(run).collect();
        arrived.clear();
        parts.iter().for_each(|part| arrived.add_grid(part));
        self.unsent.clear();
        self.surfaces.clear();
    }
}

impl<T: Real> Stepper<T> {
    /// Takes all that was to be sent by the next step all its way at once: sets `arrived` to what comes into each cell,
    /// and adds to each receiver's number what comes to it. Nothing is kept under way.
    pub(super) fn settle(
        &mut self,
        occluders: Option<&Transmittance>,
        receivers: &Facing,
        received: &mut [f64],
        arrived: &mut Grid<T>,
    ) {
        let surfaces = self.surfaces.by_cell(self.n);
        let sent = Sent::new(&self.unsent, &surfaces);
        self.ordinates.sweep(&mut Room::new(self.n), &sent, occluders, &mut Got { arrived, receivers, received });
        self.unsent.clear();
        self.surfaces.clear();
    }
}

impl<T: Real> Group<T> {
    /// For each direction its solid angle times the cosine to a surface's normal, if it leaves the surface.
    #[inline(always)]
    pub(super) fn lambert(&self, normal: [T; 3]) -> Lanes<T> {
        std::array::from_fn(|l| {
            let cosine = self.way[0][l] * normal[0] + self.way[1][l] * normal[1] + self.way[2][l] * normal[2];
            if cosine > T::ZERO { cosine * self.weight[l] } else { T::ZERO }
        })
    }
}

/// Where cell `at`, counted with the wind, lies.
fn turned<T>(octant: &Octant<T>, n: usize, at: Cell) -> Cell {
    std::array::from_fn(|a| if octant.backwards[a] { n - 1 - at[a] } else { at[a] })
}

/// Moves the light of one group by one cell.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn advance<T: Real>(
    (octant, group): (&Octant<T>, &Group<T>),
    rule: Rule,
    gain: T,
    (unsent, surfaces): (&Grid<T>, &ByCell<'_, T>),
    occluders: Option<&Transmittance>,
    under_way: &mut [Came<T>],
    left: &mut [Came<T>],
) {
    let n = unsent.side();
    let dark = [[T::ZERO; LANES]; 3];
    // Against the wind: when a cell's light moves on, that of the next one has.
    for (i, at) in (0..n.pow(3)).rev().map(|i| (i, [i % n, i / n % n, i / n / n])) {
        let cell = turned(octant, n, at);
        let (came, light) = (under_way[i], unsent.get(cell));
        let of_surfaces = surfaces.of((cell[2] * n + cell[1]) * n + cell[0]);
        let sheet = occluders.and_then(|occluders| occluders.sheet(cell));
        let mut leaves = dark;
        if let Some(number) = sheet {
            left[number] = dark;
        }
        if !light.is_zero() || came != dark || !of_surfaces.is_empty() {
            let sent = if light.is_zero() { dark[0] } else { group.sent(light) };
            let [enters, exits] =
                occluders.map_or([[T::of(1.0); 3]; 2], |occluders| occluders.ends(cell, octant.backwards));
            let mut unseen = [dark[0]; 4];
            leaves = match rule {
                Rule::Donor => group.cross::<true>(came, sent, enters, &mut unseen),
                Rule::Faces => group.cross::<false>(came, sent, enters, &mut unseen),
            };
            let mut free = dark;
            group.leave(of_surfaces, &mut free, &mut leaves);
            if let Some(number) = sheet {
                left[number] = leaves;
            }
            for (axis, lanes) in leaves.iter_mut().enumerate() {
                for (flux, free) in lanes.iter_mut().zip(free[axis]) {
                    *flux = (*flux * exits[axis] + free) * gain;
                }
            }
        }
        under_way[i] = dark;
        for (axis, step) in [1, n, n * n].into_iter().enumerate() {
            if at[axis] + 1 < n {
                let next = &mut under_way[i + step][axis];
                next.iter_mut().zip(leaves[axis]).for_each(|(next, flux)| *next += flux);
            }
        }
    }
}

/// Adds what has come into each cell.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn arrive<T: Real>((octant, group): (&Octant<T>, &Group<T>), under_way: &[Came<T>], arrived: &mut Grid<T>) {
    let n = arrived.side();
    let dark = [[T::ZERO; LANES]; 3];
    for (at, came) in Layout::new(n).cells().zip(under_way) {
        if *came == dark {
            continue;
        }
        let mut sum = [T::ZERO; 4];
        for (l, ((x, y), z)) in came[0].iter().zip(&came[1]).zip(&came[2]).enumerate() {
            let flux = *x + *y + *z;
            sum[0] += T::of(K0) * flux;
            for (sum, way) in sum[1..].iter_mut().zip(&group.way) {
                *sum += T::of(K1) * flux * way[l];
            }
        }
        arrived.add(turned(octant, n, at), Sh(sum));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Solid;
    use crate::scene::propagation::directions::Lattice;
    use glam::DVec3;

    #[test]
    fn stepping_to_the_end_gives_what_one_sweep_gives() {
        let solids = [Solid::new([4, 3, 3], DVec3::X, 1.0, [0.0; 3]), Solid::new([2, 5, 3], DVec3::X, 0.4, [0.0; 3])];
        let occluders = Transmittance::new(8, &solids);
        let mut injected = Grid::new(8);
        injected.set([2, 3, 3], Sh::lobe(DVec3::X));
        injected.set([7, 0, 5], Sh([0.3, -0.1, 0.0, 0.2]));
        for (lattice, rule) in [(Lattice::Octahedral, Rule::Faces), (Lattice::Fibonacci, Rule::Donor)] {
            let ordinates = Ordinates::<f32>::new(lattice, 40, rule);
            let at_once = ordinates.solve(&injected, occluders.as_ref());
            let mut stepper = Stepper::new(ordinates, 8);
            injected.iter().for_each(|(cell, light)| stepper.inject(cell, light));
            let (mut arrived, mut sum) = (Grid::new(8), Grid::new(8));
            for _ in 0..24 {
                stepper.step(1.0, occluders.as_ref(), &mut arrived);
                sum.add_grid(&arrived);
            }
            for (cell, light) in at_once.iter() {
                let stepped = sum.get(cell);
                assert!((light - stepped).max_norm() < 1e-6, "{cell:?}: {light:?}, {stepped:?}");
            }
        }
    }

    #[test]
    fn the_front_moves_one_cell_a_step() {
        let mut stepper = Stepper::<f32>::new(Ordinates::new(Lattice::Octahedral, 32, Rule::Faces), 8);
        stepper.inject([3, 3, 3], Sh::lobe(DVec3::Y));
        let mut arrived = Grid::new(8);
        for k in 1..=4 {
            stepper.step(1.0, None, &mut arrived);
            for (cell, light) in arrived.iter() {
                let distance: usize = (0..3).map(|a| cell[a].abs_diff(3)).sum();
                assert!(distance == k || light.is_zero(), "k = {k}, {cell:?}");
            }
            assert!(!arrived.get([3, 3 + k, 3]).is_zero());
        }
    }
}
