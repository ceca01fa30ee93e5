//! Ports with mistakes, made for these tests from the formulas alone: a plain simulation in double precision that
//! knows nothing of the catalogue it tests.

use lpv_lab::study::identify::Dump;
use lpv_lab::study::identify::Dumps;
use lpv_lab::study::identify::{Storage, half};
use lpv_lab::study::pattern::Pattern;

pub const K0: f64 = 0.282_094_791_773_878_14;
pub const K1: f64 = 0.488_602_511_902_919_9;
pub const L0: f64 = 0.886_226_925_452_758;
pub const L1: f64 = 1.023_326_707_946_488_5;
const PI: f64 = std::f64::consts::PI;

type V = [f64; 3];
type Grid = Vec<[f64; 4]>;

/// A rule that is no known mistake: cell, direction and flux to flux.
pub type Strange = fn([usize; 3], usize, f64) -> f64;

/// A port: right but for its mistakes.
#[derive(Clone, Debug)]
pub struct Port {
    pub scheme: &'static str,
    pub factor: f64,
    pub mistakes: Vec<&'static str>,
    /// Chooses axes, directions and entries of mistakes that have several forms.
    pub form: usize,
    pub copy_first: bool,
    pub sum_from: usize,
    pub half: bool,
    /// Whether light is kept in the precision of the dump between iterations.
    pub stored: bool,
    /// A rule that is no known mistake, applied to what a face sends: (port, cell, direction, flux) to flux.
    pub strange: Option<Strange>,
    /// Light also goes across edges.
    pub eighteen: bool,
}

impl Port {
    pub fn right(scheme: &'static str, factor: f64) -> Self {
        Port {
            scheme,
            factor,
            mistakes: Vec::new(),
            form: 0,
            copy_first: false,
            sum_from: 0,
            half: false,
            stored: true,
            strange: None,
            eighteen: false,
        }
    }

    fn has(&self, id: &str) -> bool {
        self.mistakes.contains(&id)
    }

    fn kept(&self, x: f64) -> f64 {
        match (self.stored, self.half) {
            (true, true) => half(x),
            _ => f64::from(x as f32),
        }
    }
}

const DIRECTIONS: [V; 6] =
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];

fn plus(a: V, b: V) -> V {
    std::array::from_fn(|i| a[i] + b[i])
}

fn times(a: V, s: f64) -> V {
    a.map(|x| x * s)
}

fn dot(a: V, b: V) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross_components(a: V, b: V) -> V {
    std::array::from_fn(|i| a[i] * b[i])
}

fn unit(a: V) -> V {
    times(a, 1.0 / dot(a, a).sqrt())
}

struct Tap {
    weight: f64,
    read: [f64; 4],
    lobe: [f64; 4],
    clamp: bool,
}

fn banded(k0: f64, k1: f64, v: V) -> [f64; 4] {
    [k0, k1 * v[0], k1 * v[1], k1 * v[2]]
}

/// The ways by which light that travels in direction `d` reaches the neighbour.
fn taps(port: &Port, d: usize) -> Vec<Tap> {
    let travel = DIRECTIONS[d];
    let axis = d / 2;
    let far_angle = 4.0 * 0.1f64.asin();
    let side_angle = (2.0 * PI / 3.0 - far_angle) / 4.0;
    let (mut far, mut side) = (far_angle / (4.0 * PI), side_angle / (4.0 * PI));
    let mut clamp_side = true;
    match port.scheme {
        "blog" => (far, side, clamp_side) = (0.400_669_684_6 / (2.0 * PI), 0.423_441_354_4 / (3.0 * PI), false),
        "axial" | "cone" => (far, side) = (1.0 / 6.0, 0.0),
        _ => {}
    }
    if port.has("digit-typo") {
        side = 0.423_441_354_4 / (4.0 * PI);
    }
    if port.has("swapped-weights") {
        (far, side) = (side, far);
    }
    if port.has("equal-weights") {
        (far, side) = (1.0 / 30.0, 1.0 / 30.0);
    }
    if port.has("not-over-4pi") {
        (far, side) = (far * 4.0 * PI, side * 4.0 * PI);
    }
    if port.has("twice-over-pi") {
        (far, side) = (far / PI, side / PI);
    }
    if port.has("no-far-face") {
        far = 0.0;
    }
    let (mut k0, mut k1, mut l0, mut l1) = (K0, K1, L0, L1);
    if port.has("four-digit-constants") {
        (k0, k1, l0, l1) = (0.2821, 0.4886, 0.8862, 1.0233);
    }
    if port.has("basis-and-lobe-exchanged") {
        (k0, k1, l0, l1) = (l0, l1, k0, k1);
    }
    if port.has("wrong-lobe") {
        (l0, l1) = (PI.sqrt() / 4.0, PI.sqrt() / 2.0);
    }
    let mut clamp_far = true;
    if port.has("clamp-none") {
        (clamp_far, clamp_side) = (false, false);
    }
    if port.has("clamp-partial") {
        if port.form.is_multiple_of(2) { clamp_side = false } else { clamp_far = false }
    }
    let table: [V; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    let faces: Vec<V> = DIRECTIONS.into_iter().filter(|f| dot(*f, travel) == 0.0).collect();
    // (read, put back about, weight, clamp)
    let mut ways: Vec<(V, V, f64, bool)> = vec![(travel, travel, far, clamp_far)];
    for (i, &f) in faces.iter().enumerate() {
        let mut read = unit(plus(times(travel, 2.0), f));
        let mut back = f;
        let only = port.form % 6;
        if port.has("componentwise-sides") {
            read = cross_components(travel, plus(times(table[i], 1.0 / 5f64.sqrt()), [0.0, 0.0, 2.0 / 5f64.sqrt()]));
            back = cross_components(travel, table[i]);
        }
        if port.has("face-index-sides") {
            let orientation = [DIRECTIONS[4], DIRECTIONS[0], DIRECTIONS[5], DIRECTIONS[1]][i];
            read =
                cross_components(orientation, plus(times(table[i], 1.0 / 5f64.sqrt()), [0.0, 0.0, 2.0 / 5f64.sqrt()]));
            back = cross_components(orientation, [table[i][0], table[i][1], 0.0]);
        }
        if port.has("zero-sides") {
            (read, back) = ([0.0; 3], [0.0; 3]);
        }
        for (id, degrees) in [("sides-30-degrees", 30.0f64), ("sides-45-degrees", 45.0)] {
            if port.has(id) {
                let (s, c) = degrees.to_radians().sin_cos();
                read = plus(times(travel, c), times(f, s));
            }
        }
        // As seen: the matrices are applied from the wrong side, which does not matter for z.
        if port.has("sides-minus-d") && (port.form.is_multiple_of(2) || axis != 2) {
            read = plus(read, times(travel, -2.0 * dot(read, travel)));
        }
        if port.has("mirrored-sides") && (port.form.is_multiple_of(2) || d % 2 == 1) {
            back = times(back, -1.0);
        }
        if port.has("axes-exchanged") && d == only {
            let [u, v] = match axis {
                0 => [1, 2],
                1 => [0, 2],
                _ => [0, 1],
            };
            back.swap(u, v);
        }
        if port.has("side-table-sign") && d == only && i == port.form / 6 % 4 {
            let mut turned = plus(read, times(f, -2.0 * dot(read, f)));
            if port.form % 5 < 2 {
                std::mem::swap(&mut turned, &mut read)
            } else {
                std::mem::swap(&mut read, &mut turned);
                back = times(back, -1.0)
            }
        }
        if port.has("reprojected-along-read") {
            back = unit(read);
        }
        ways.push((read, back, side, clamp_side));
    }
    if port.has("near-face") {
        ways.push((travel, times(travel, -1.0), side, clamp_side));
    }
    let sign_axis = port.form % 3;
    ways.into_iter()
        .map(|(mut read, mut back, weight, clamp)| {
            if port.has("reads-minus-d") {
                read = plus(read, times(travel, -2.0 * dot(read, travel)));
            }
            if port.has("read-sign") {
                read[sign_axis] = -read[sign_axis];
            }
            if port.has("lobe-sign") {
                back[sign_axis] = -back[sign_axis];
            }
            let read = if port.scheme == "cone" {
                // ⟨a, cone⟩ over the cone's solid angle, as far as the mean goes.
                let omega = 2.0 * PI * (1.0 - 0.5f64.sqrt());
                banded(PI.sqrt() * (1.0 - 0.5f64.sqrt()) / omega, (3.0 * PI).sqrt() / 4.0 / omega, read)
            } else {
                banded(k0, k1, read)
            };
            Tap { weight: weight * port.factor, read, lobe: banded(l0, l1, back), clamp }
        })
        .collect()
}

fn index([x, y, z]: [usize; 3], n: usize) -> usize {
    x + n * (y + n * z)
}

/// The cell whose light a receiver reads for direction `d`.
fn sender(port: &Port, cell: [usize; 3], d: usize, n: usize) -> Option<[usize; 3]> {
    if port.has("own-cell") {
        return Some(cell);
    }
    let mut from = cell.map(|c| c as isize);
    from[d / 2] -= if d.is_multiple_of(2) { 1 } else { -1 };
    let n = n as isize;
    if port.has("edge-border") {
        from = from.map(|c| c.clamp(0, n - 1));
    }
    if port.has("wrap-border") {
        from = from.map(|c| c.rem_euclid(n));
    }
    if port.has("flat-layout") {
        from[2] += from[0].div_euclid(n);
        from[0] = from[0].rem_euclid(n);
    }
    from.iter().all(|c| (0..n).contains(c)).then(|| from.map(|c| c as usize))
}

fn gather(port: &Port, all: &[Vec<Tap>], grid: &Grid, cell: [usize; 3], n: usize) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for (d, taps) in all.iter().enumerate() {
        let Some(from) = sender(port, cell, d, n) else { continue };
        let a = grid[index(from, n)];
        for tap in taps {
            let mut flux: f64 = (0..4).map(|c| a[c] * tap.read[c]).sum();
            if tap.clamp {
                flux = flux.max(0.0);
            }
            if let Some(strange) = port.strange {
                flux = strange(from, d, flux);
            }
            for (sum, lobe) in sum.iter_mut().zip(&tap.lobe) {
                *sum += flux * tap.weight * lobe;
            }
        }
    }
    if port.eighteen {
        for (a, b) in (0..6).flat_map(|a| (a + 1..6).map(move |b| (a, b))).filter(|(a, b)| a / 2 != b / 2) {
            let Some(from) = sender(port, cell, a, n).and_then(|c| sender(port, c, b, n)) else { continue };
            let light = grid[index(from, n)];
            sum[0] += 0.01 * light[0];
        }
    }
    sum
}

fn cells(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n).flat_map(move |z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])))
}

/// What one iteration makes of a grid.
fn step(port: &Port, before: &Grid, n: usize) -> Grid {
    let all: Vec<Vec<Tap>> = (0..6).map(|d| taps(port, d)).collect();
    let keep = |light: [f64; 4]| light.map(|c| port.kept(c));
    if port.has("in-place") {
        let mut grid = before.clone();
        for cell in cells(n) {
            let swept: [usize; 3] =
                std::array::from_fn(|a| if port.form >> a & 1 == 1 { n - 1 - cell[a] } else { cell[a] });
            let light = gather(port, &all, &grid, swept, n);
            grid[index(swept, n)] = keep(light);
        }
        return grid;
    }
    if port.has("chessboard") {
        let mut grid = before.clone();
        for parity in [port.form % 2, 1 - port.form % 2] {
            let old = grid.clone();
            for cell in cells(n).filter(|c| (c[0] + c[1] + c[2]) % 2 == parity) {
                grid[index(cell, n)] = keep(gather(port, &all, &old, cell, n));
            }
        }
        return grid;
    }
    cells(n).map(|cell| keep(gather(port, &all, before, cell, n))).collect()
}

fn add(to: &mut Grid, from: &Grid, scale: f64) {
    for (a, b) in to.iter_mut().flatten().zip(from.iter().flatten()) {
        *a += scale * b;
    }
}

/// All source grids and sums after 0 to 4 iterations.
pub fn run(port: &Port, injected: &Grid, n: usize) -> (Vec<Grid>, Vec<Grid>) {
    let dark = vec![[0.0; 4]; n * n * n];
    let mut source = vec![injected.clone()];
    let mut sums = vec![dark.clone()];
    if port.sum_from == 0 {
        add(&mut sums[0], injected, 1.0);
    }
    if port.has("first-twice") {
        add(&mut sums[0], injected, 1.0 + f64::from(u8::from(port.sum_from > 0)));
    }
    for k in 0..4 {
        let mut next = step(port, &source[k], n);
        if (k == 0 && port.copy_first) || port.has("sum-into-source") {
            add(&mut next, &source[k], 1.0);
        }
        if k == 0 && port.has("wrong-cell-copied") {
            let shifted: Grid =
                cells(n).map(|[x, y, z]| if y == 0 { [0.0; 4] } else { injected[index([x, y - 1, z], n)] }).collect();
            add(&mut next, &shifted, port.factor);
        }
        if k > 0 && port.has("stale-target") {
            add(&mut next, &source[k - 1], 1.0);
        }
        if port.has("temporal-mix") {
            next.iter_mut().flatten().for_each(|c| *c *= 0.125);
            add(&mut next, &source[k], 0.875);
        }
        next.iter_mut().flatten().for_each(|c| *c = port.kept(*c));
        let mut sum = sums[k].clone();
        add(&mut sum, &next, 1.0);
        if port.has("no-sum") {
            sum = next.clone();
        }
        let rounds = port.has("half-sums") || (port.half && port.stored);
        sum.iter_mut().flatten().for_each(|c| *c = if rounds { half(*c) } else { f64::from(*c as f32) });
        source.push(next);
        sums.push(sum);
    }
    (source, sums)
}

/// What a port injects of a pattern.
pub fn inject(port: &Port, pattern: &Pattern) -> Grid {
    let n = pattern.side();
    let mut grid = vec![[0.0; 4]; n * n * n];
    let mut cells: Vec<_> = pattern.lobes().iter().map(|l| l.cell).collect();
    cells.sort_unstable();
    cells.dedup();
    for cell in cells {
        let mut lobes: Vec<_> = pattern.lobes().iter().filter(|l| l.cell == cell).collect();
        lobes.sort_by(|a, b| b.multiplier.total_cmp(&a.multiplier));
        let count = lobes.len() as f64;
        if port.has("injection-brightest") {
            lobes.truncate(1);
        }
        let mut to = cell;
        if port.has("injection-shifted") {
            let axis = port.form % 3;
            to[axis] += 1;
            if to[axis] == n {
                continue;
            }
        }
        for lobe in lobes {
            let mut v = unit(lobe.direction.to_array());
            if port.has("injects-minus-n") {
                v = times(v, -1.0);
            }
            if port.has("injection-axes") {
                v.swap(port.form % 3, (port.form + 1) % 3);
            }
            let (l0, l1) = if port.has("injection-lobe") { (PI.sqrt() / 4.0, PI.sqrt() / 2.0) } else { (L0, L1) };
            let mut m = lobe.multiplier;
            if port.has("injection-averaged") {
                m /= count;
            }
            for (sum, c) in grid[index(to, n)].iter_mut().zip(banded(l0, l1, v)) {
                *sum += m * c;
            }
        }
    }
    grid.iter_mut().flatten().for_each(|c| *c = port.kept(*c));
    grid
}

/// How dumps are written.
#[derive(Clone, Copy, Debug)]
pub struct Written {
    /// The axis of each index of the array.
    pub order: [usize; 3],
    pub reversed: [bool; 3],
    /// The coefficient of each number, and its sign.
    pub coefficients: [usize; 4],
    pub signs: [f64; 4],
}

pub const PUBLISHED: Written =
    Written { order: [2, 1, 0], reversed: [false; 3], coefficients: [0, 2, 3, 1], signs: [1.0, -1.0, 1.0, -1.0] };

pub fn dump(grid: &Grid, n: usize, written: &Written, as_half: bool) -> Dump {
    let mut numbers = vec![[0.0; 4]; n * n * n];
    for cell in cells(n) {
        let place = (0..3).fold(0, |place, i| {
            let c = cell[written.order[i]];
            place * n + if written.reversed[i] { n - 1 - c } else { c }
        });
        let light = grid[index(cell, n)];
        numbers[place] = std::array::from_fn(|j| {
            let c = written.signs[j] * light[written.coefficients[j]];
            if as_half { half(c) } else { f64::from(c as f32) }
        });
    }
    let storage = Storage::of(numbers.iter().flatten(), 1.0);
    Dump { side: n, numbers, storage }
}

/// All dumps of a port that was given a pattern.
pub fn dumps(port: &Port, pattern: &Pattern, written: &Written, iterations: &[usize], sums: &[usize]) -> Dumps {
    let n = pattern.side();
    let injected = inject(port, pattern);
    let (source, accumulated) = run(port, &injected, n);
    Dumps {
        injected: dump(&injected, n, written, port.half),
        source: iterations.iter().map(|k| (*k, dump(&source[*k], n, written, port.half))).collect(),
        accumulated: sums
            .iter()
            .map(|k| (*k, dump(&accumulated[*k], n, written, port.half || port.has("half-sums"))))
            .collect(),
    }
}

/// A small generator of random numbers.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % n
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    pub fn written(&mut self) -> Written {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let mut coefficients = [0, 1, 2, 3];
        for i in (1..4).rev() {
            coefficients.swap(i, self.below(i + 1));
        }
        let mut written = Written { order: self.pick(&orders), reversed: [false; 3], coefficients, signs: [1.0; 4] };
        for a in 0..3 {
            written.reversed[a] = self.below(2) == 0;
        }
        for j in 0..4 {
            if written.coefficients[j] > 0 && self.below(2) == 0 {
                written.signs[j] = -1.0;
            }
        }
        written
    }
}
