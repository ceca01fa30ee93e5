//! From step to step: what an iteration keeps of the light before it, and what the accumulated grid sums.
//!
//! Each rule is a few numbers, S(k+1) = P(S(k)) + kept·S(k) + stale·S(k−1), and each sum too. All of them are run
//! from the injected light on and held against every later dump.

use std::collections::BTreeMap;

use super::fit::Rounding;
use super::light::{Light, Storage};
use super::port::{KINDS, Kind, Order, Port};

/// What the first iteration and the later ones keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// What it is called in the report.
    pub name: &'static str,
    /// The mistake that it is, if it is one.
    pub mistake: Option<&'static str>,
    /// The cell's own c00 and direction part and the copied neighbour's light that the first iteration adds.
    pub first: [f64; 3],
    /// What the later ones add.
    pub later: [f64; 3],
    /// How much of the grid before the last one is still in the target.
    pub stale: f64,
}

/// What the accumulated grid is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sum {
    /// What it is called in the report.
    pub name: &'static str,
    /// The mistake that it is, if it is one.
    pub mistake: Option<&'static str>,
    /// How often S0 and S1 are counted.
    first: [f64; 2],
    /// Whether the grids between are counted.
    between: bool,
}

const SUMS: [Sum; 6] = [
    Sum { name: "S0..Sk", mistake: None, first: [1.0, 1.0], between: true },
    Sum { name: "S1..Sk", mistake: None, first: [0.0, 1.0], between: true },
    Sum { name: "Sk", mistake: Some("no-sum"), first: [0.0, 0.0], between: false },
    Sum { name: "S0 twice..Sk", mistake: Some("first-twice"), first: [2.0, 1.0], between: true },
    Sum { name: "S1 twice..Sk", mistake: Some("first-twice"), first: [0.0, 2.0], between: true },
    Sum { name: "S0, S1 twice..Sk", mistake: Some("first-twice"), first: [1.0, 2.0], between: true },
];

/// The later dumps of a port, in the lab's axes and coefficients.
#[derive(Clone, Debug, Default)]
pub struct Later {
    /// The source grids by iteration, the injected one as 0.
    pub source: BTreeMap<usize, (Light, Storage)>,
    /// The accumulated grids.
    pub accumulated: BTreeMap<usize, (Light, Storage)>,
}

/// What was found of the iterations.
#[derive(Clone, Debug)]
pub struct Iterations {
    /// The rule.
    pub rule: Rule,
    /// The sum, where an accumulated grid is there and a sum fits.
    pub sum: Option<Sum>,
    /// Whether sums are kept in half precision while the light is not.
    pub half: bool,
    /// Whether all later dumps agree.
    pub agrees: bool,
    /// Names of other rules that fit as well.
    pub or: Vec<&'static str>,
    /// Names of other sums that fit as well.
    pub or_sum: Vec<&'static str>,
    /// The first iteration whose dump does not agree.
    pub differs_at: Option<usize>,
}

/// A port with its weights, as far as one step shows them.
pub struct Stepped<'a> {
    /// The port.
    pub port: &'a Port,
    /// Its weights.
    pub weights: [f64; KINDS],
    /// The uncertainty of the weights, relative.
    pub uncertainty: f64,
    /// How it rounds.
    pub rounding: Rounding,
    /// Cells that are left out.
    pub hidden: &'a [bool],
}

/// A mix of new and old light would need a larger factor than this only if it is none.
const LARGEST_FACTOR: f64 = 6.5;

/// The rules under which the first step looks as it does; those that are right stand first.
fn rules(stepped: &Stepped, later: &Later) -> Vec<Rule> {
    let own = [Kind::Own0, Kind::Own1, Kind::Copied].map(|kind| stepped.weights[kind as usize]);
    let rule = |name, mistake, first, later, stale| Rule { name, mistake, first, later, stale };
    let none = [0.0; 3];
    // Six directions, a far face and four sides each: four times the gain of the mean.
    let gain = 6.0 * (stepped.weights[Kind::Far as usize] + 4.0 * stepped.weights[Kind::Side as usize]);
    let mut rules = Vec::new();
    if own == none {
        rules.push(rule("thesis", None, none, none, 0.0));
    } else if own == [1.0, 1.0, 0.0] {
        rules.push(rule("copy-first", None, own, none, 0.0));
        rules.push(rule("sum-into-source", Some("sum-into-source"), own, own, 0.0));
    } else if own[2] != 0.0 {
        // The search has named the copy already.
        rules.push(rule("wrong-cell-copied", None, own, none, 0.0));
        rules.push(rule("wrong-cell-copied, always", None, own, own, 0.0));
    } else if own[0] == own[1]
        && (0.5..1.0).contains(&own[0])
        && (own[0] >= 0.75 || gain / (1.0 - own[0]) < LARGEST_FACTOR)
    {
        rules.push(rule("temporal-mix", Some("temporal-mix"), own, own, 0.0));
        rules.push(rule("temporal-mix, first iteration", Some("temporal-mix"), own, none, 0.0));
    } else {
        rules.push(rule("own-cell", Some("own-cell"), own, own, 0.0));
        rules.push(rule("own-cell, first iteration", Some("own-cell"), own, none, 0.0));
    }
    let stale = |rules: &[Rule], name, mistake, share: f64| -> Vec<Rule> {
        let right = rules.iter().filter(|rule| rule.mistake.is_none());
        right.map(|rule| Rule { name, mistake: Some(mistake), stale: share, ..*rule }).collect()
    };
    let mut wrong = stale(&rules, "stale-target", "stale-target", 1.0);
    let measured = stale_share(stepped, later);
    for share in measured.into_iter().chain([0.875, 0.75, 0.5, 0.9, 0.95, 0.8]) {
        wrong.extend(stale(&rules, "temporal-mix", "temporal-mix", share));
    }
    rules.extend(wrong);
    rules
}

/// How much of S0 is left in S2, by least squares, where S1 and S2 are there.
fn stale_share(stepped: &Stepped, later: &Later) -> Option<f64> {
    let [(zero, _), (one, _), (two, _)] =
        [0, 1, 2].map(|k| later.source.get(&k)).into_iter().collect::<Option<Vec<_>>>()?[..]
    else {
        return None;
    };
    let mut weights = stepped.weights;
    weights[Kind::Own0 as usize..].fill(0.0);
    let next = stepped.port.step(&weights, one);
    let (mut product, mut square) = (0.0, 0.0);
    for i in 0..zero.cells().len() {
        for c in 0..4 {
            product += (two.cells()[i][c] - next.cells()[i][c]) * zero.cells()[i][c];
            square += zero.cells()[i][c].powi(2);
        }
    }
    let share = product / square;
    (share > 0.02 && share < 0.995).then_some(share)
}

/// A grid with how far off each of its numbers may be.
#[derive(Clone)]
struct Sure {
    light: Light,
    error: Light,
}

/// All grids that a rule makes, up to the last dump. Where a dump agrees, the next one is made from it.
fn run(stepped: &Stepped, rule: &Rule, later: &Later, last: usize) -> (Vec<Sure>, Option<usize>) {
    let Some((injected, storage)) = later.source.get(&0) else { return (Vec::new(), Some(0)) };
    let read = |light: &Light, storage: Storage| {
        let mut error = light.clone();
        for c in error.cells_mut().iter_mut().flatten() {
            *c = if stepped.rounding == Rounding::Dumped { storage.rounding(*c) } else { 0.0 };
        }
        Sure { light: light.clone(), error }
    };
    let mut grids = vec![read(injected, *storage)];
    let errors = stepped.port.of_errors();
    let mut differs = None;
    for k in 0..last {
        let mut weights = stepped.weights;
        let kept = if k == 0 { rule.first } else { rule.later };
        for (kind, kept) in [Kind::Own0, Kind::Own1, Kind::Copied].into_iter().zip(kept) {
            weights[kind as usize] = kept;
        }
        let before = &grids[k];
        let mut light = stepped.port.step(&weights, &before.light);
        // What computing in single precision and not knowing the weights exactly adds.
        let mut carried = before.error.clone();
        let relative = stepped.uncertainty + 2e-6;
        for (e, c) in carried.cells_mut().iter_mut().flatten().zip(before.light.cells().iter().flatten()) {
            *e += relative * c.abs();
        }
        let mut error = errors.step(&weights.map(f64::abs), &carried);
        if rule.stale != 0.0 && k > 0 {
            light.add_scaled(&grids[k - 1].light, rule.stale);
            error.add_scaled(&grids[k - 1].error, rule.stale);
        }
        let stored = later.source.get(&1).map_or(Storage::Single, |(_, storage)| *storage);
        let faint = light.largest() * 1e-9 + 1e-40;
        for (e, c) in error.cells_mut().iter_mut().flatten().zip(light.cells().iter().flatten()) {
            *e += stored.rounding(*c) * 1.1 + faint;
        }
        if stepped.port.order != Order::AtOnce {
            // Cells that are read after they are updated were rounded in between.
            let at_once = Port { order: Order::AtOnce, ..errors.clone() };
            let mut rounded = light.clone();
            rounded.cells_mut().iter_mut().flatten().for_each(|c| *c = stored.rounding(*c) * 1.1);
            for _ in 0..3 {
                rounded = at_once.step(&weights.map(f64::abs), &rounded);
                error.add_scaled(&rounded, 1.0);
            }
        }
        let next = Sure { light, error };
        match later.source.get(&(k + 1)) {
            Some((dump, storage)) if agree(&next, dump, *storage, stepped.hidden) => grids.push(read(dump, *storage)),
            Some(_) => {
                differs = differs.or(Some(k + 1));
                grids.push(next);
            }
            None => grids.push(next),
        }
    }
    (grids, differs)
}

fn agree(expected: &Sure, dump: &Light, storage: Storage, hidden: &[bool]) -> bool {
    (0..dump.cells().len()).filter(|i| !hidden[*i]).all(|i| {
        (0..4).all(|c| {
            let found = dump.cells()[i][c];
            let off = (expected.light.cells()[i][c] - found).abs();
            off <= expected.error.cells()[i][c] + 1.1 * storage.rounding(found)
        })
    })
}

impl Sum {
    /// The sum after k iterations; `half` rounds it after every addition.
    fn of(&self, grids: &[Sure], k: usize, half: bool) -> Sure {
        let dark = Light::dark(grids[0].light.side());
        let (mut light, mut error, mut size) = (dark.clone(), dark.clone(), dark);
        for (j, grid) in grids.iter().enumerate().take(k + 1) {
            let times = match j {
                _ if !self.between => f64::from(u8::from(j == k)),
                0 | 1 => self.first[j],
                _ => 1.0,
            };
            light.add_scaled(&grid.light, times);
            error.add_scaled(&grid.error, times);
            for (s, c) in size.cells_mut().iter_mut().flatten().zip(grid.light.cells().iter().flatten()) {
                *s += times * c.abs();
            }
        }
        let storage = if half { Storage::Half } else { Storage::Single };
        for (e, s) in error.cells_mut().iter_mut().flatten().zip(size.cells().iter().flatten()) {
            *e += (k + 1) as f64 * storage.rounding(*s);
        }
        Sure { light, error }
    }
}

/// Finds the rule and the sum under which all later dumps agree.
pub fn read(stepped: &Stepped, later: &Later) -> Iterations {
    let last = later.source.keys().chain(later.accumulated.keys()).copied().max().unwrap_or(1);
    let half_light = later.source.values().all(|(_, storage)| *storage == Storage::Half);
    let half_sums =
        !later.accumulated.is_empty() && later.accumulated.values().all(|(_, storage)| *storage == Storage::Half);
    let rounds = half_sums || half_light;
    let mut fitting: Vec<(Rule, Option<Sum>)> = Vec::new();
    let mut best: Option<(Rule, Option<usize>)> = None;
    for rule in rules(stepped, later) {
        let (grids, differs) = run(stepped, &rule, later, last);
        if best.as_ref().is_none_or(|(_, at)| at.is_some_and(|at| differs.is_none_or(|d| d > at))) {
            best = Some((rule, differs));
        }
        if differs.is_some() {
            continue;
        }
        if later.accumulated.is_empty() {
            fitting.push((rule, None));
        }
        for sum in SUMS {
            let fits = later
                .accumulated
                .iter()
                .all(|(k, (dump, storage))| agree(&sum.of(&grids, *k, rounds), dump, *storage, stepped.hidden));
            if fits && !later.accumulated.is_empty() {
                // With the source kept in S1, S0 + S1 counts it twice.
                let twice = rule.name == "copy-first" && sum.name == "S0..Sk";
                let mistake = if twice { Some("first-twice") } else { sum.mistake };
                fitting.push((rule, Some(Sum { mistake, ..sum })));
            }
        }
    }
    let cost = |rule: &Rule, sum: &Option<Sum>| {
        usize::from(rule.mistake.is_some()) + usize::from(sum.is_some_and(|sum| sum.mistake.is_some()))
    };
    fitting.sort_by_key(|(rule, sum)| cost(rule, sum));
    let half = half_sums && !half_light;
    let Some((rule, sum)) = fitting.first().copied() else {
        let (rule, differs_at) = best.unwrap_or_else(|| (rules(stepped, later)[0], None));
        return Iterations { rule, sum: None, half, agrees: false, or: Vec::new(), or_sum: Vec::new(), differs_at };
    };
    let mut or: Vec<_> = fitting.iter().map(|(rule, _)| rule.name).filter(|name| *name != rule.name).collect();
    or.dedup();
    let mut or_sum: Vec<_> =
        fitting.iter().filter(|(r, _)| *r == rule).filter_map(|(_, s)| s.map(|s| s.name)).collect();
    or_sum.retain(|name| sum.is_none_or(|sum| sum.name != *name));
    Iterations { rule, sum, half, agrees: true, or, or_sum, differs_at: None }
}
