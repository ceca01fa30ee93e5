//! From dumps to a verdict: every reading in turn, and which of several that fit is told.

use std::collections::BTreeMap;

use super::beside::Right;
use super::catalogue::{self, Edit, Group};
use super::fit::{Rounding, Step, Sums};
use super::injection::Injection;
use super::iterations::{self, Iterations, Later, Stepped};
use super::layout::{Coefficients, Dump, Layout};
use super::light::{Light, Storage, is_lit};
use super::port::{Border, Kind, Port};
use super::search::{self, Candidate, Found};
use super::verdict::{Judgement, Law, Named, Verdict, Wrong};
use super::weights::{self, Base, Nominal, Precision, Reading};
use super::{Dumps, laws};
use crate::sh::Sh;
use crate::transport::lattice::schemes;

/// A candidate with all that follows from it.
struct Account {
    candidate: Candidate,
    reading: Reading,
    iterations: Iterations,
    /// Ids of all mistakes of propagation, with what they are here.
    mistakes: Vec<(&'static str, String)>,
    /// How many forms of its mistakes are likelier.
    rank: usize,
}

impl Account {
    /// How well it explains the dumps: lower is better. Of accounts with as many mistakes the likelier one.
    fn cost(&self) -> (bool, bool, usize, usize, usize, usize) {
        let axes = self.mistakes.iter().filter(|m| m.0 == "injection-axes").count();
        (!self.iterations.agrees, !self.reading.known, self.mistakes.len(), self.candidate.base, axes, self.rank)
    }
}

/// The conventions of the direction part that are tried where no pattern tells it: the axes and signs of all 48
/// symmetries, the one that was guessed first.
fn conventions(known: bool) -> Vec<[(usize, f64); 3]> {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signs = (0..8).map(|bits: u32| [0, 1, 2].map(|a| if bits >> a & 1 == 1 { -1.0 } else { 1.0 }));
    let all = signs.flat_map(|signs| orders.map(|order| std::array::from_fn(|a| (order[a], signs[a]))));
    all.take(if known { 1 } else { 48 }).collect()
}

/// The coefficients under another convention.
fn under(coefficients: Coefficients, convention: &[(usize, f64); 3]) -> Coefficients {
    let mut turned = coefficients;
    for j in 0..4 {
        if let Some(component) = coefficients.order[j].checked_sub(1) {
            let (axis, sign) = convention[component];
            turned.order[j] = axis + 1;
            turned.signs[j] *= sign;
        }
    }
    turned
}

/// A port that reads light whose convention was guessed wrongly.
fn turned(port: &Port, convention: &[(usize, f64); 3]) -> Port {
    let mut port = port.clone();
    for tap in port.taps.iter_mut().flatten() {
        let turn = |f: Sh<f64>| {
            let v = f.vector();
            let c = convention.map(|(axis, sign)| sign * v[axis]);
            Sh([f.0[0], c[0], c[1], c[2]])
        };
        (tap.read, tap.lobe) = (turn(tap.read), turn(tap.lobe));
    }
    port
}

/// Whether no cell has light after the first iteration that had none before.
fn light_stays(step: &Step) -> bool {
    step.after.lit().iter().all(|i| is_lit(&step.before.cells()[*i]))
        && step.before.lit().len() * 8 < step.before.cells().len()
}

/// All readings of the dumps.
pub(super) fn judge(dumps: &Dumps, layout: Layout, injection: Option<Injection>, hidden: Vec<bool>) -> Verdict {
    let lights = |dumps: &BTreeMap<usize, Dump>| -> BTreeMap<usize, (Light, Storage)> {
        dumps.iter().map(|(k, dump)| (*k, (layout.light(dump), dump.storage))).collect()
    };
    let mut later = Later { source: lights(&dumps.source), accumulated: lights(&dumps.accumulated) };
    later.source.insert(0, (layout.light(&dumps.injected), dumps.injected.storage));
    let storage = later.source.values().map(|(_, s)| *s).max_by(|a, b| a.rounding(1.0).total_cmp(&b.rounding(1.0)));
    let storage = storage.unwrap_or(Storage::Single);
    let step = |k: usize| -> Option<Step> {
        let ((before, stored_before), (after, storage)) = (later.source.get(&k)?, later.source.get(&(k + 1))?);
        let (before, after) = (before.clone(), after.clone());
        Some(Step { before, after, storage: *storage, stored_before: *stored_before, hidden: hidden.clone() })
    };
    let pattern_known = injection.is_some();
    let conventions = conventions(pattern_known);
    let bases = weights::bases(&schemes::all());
    let first = step(0);
    let stays = first.as_ref().is_some_and(light_stays);
    let start =
        |base: &Base, convention: &[(usize, f64); 3]| Port { reads_itself: stays, ..turned(&base.port, convention) };
    let starts: Vec<Port> = conventions.iter().flat_map(|c| bases.iter().map(|base| start(base, c))).collect();
    let mut edits = catalogue::edits();
    edits.retain(|edit| pattern_known || edit.mistake.group != Group::Injection);
    let most = if pattern_known { search::MOST_MISTAKES } else { 2 };
    let found = first.as_ref().and_then(|step| search::search(step, &starts, &edits, most));
    let base_of = |candidate: &Candidate| &bases[candidate.base % bases.len()];
    let account = |candidate: &Candidate| -> Account {
        let base = base_of(candidate);
        let others: Vec<Nominal> = same_faces(&bases, base);
        let read =
            |candidate: Candidate, mixed: f64| account_of(candidate, base, &others, &edits, &later, &hidden, mixed);
        let mut account = read(candidate.clone(), 1.0);
        if account.iterations.agrees
            && account.iterations.rule.later == [0.0; 3]
            && account.iterations.rule.stale == 0.0
        {
            let mut refined = candidate.clone();
            refine(&mut refined, &account, (1..8).filter_map(step));
            account = read(refined, 1.0);
        }
        let rule = account.iterations.rule;
        let mixed = if rule.mistake == Some("temporal-mix") { 1.0 - rule.later[0].max(rule.stale) } else { 1.0 };
        if mixed < 1.0 { read(account.candidate, mixed) } else { account }
    };
    let mut verdict = Verdict {
        judgement: Judgement::Unknown,
        scheme: None,
        factor: None,
        ratio: None,
        clamp: "unknown".to_owned(),
        border: "unknown".to_owned(),
        snapshots: "unknown".to_owned(),
        sum: "not shown".to_owned(),
        layout,
        storage: storage.name(),
        injection: injection.as_ref().map(|i| (i.scale, i.scale_in_words())),
        mistakes: Vec::new(),
        notes: Vec::new(),
        laws: Vec::new(),
        wrong: None,
        agreeing: (0, 0),
    };
    let (Some(first), Some(Found { full, nearest })) = (first, found) else { return verdict };
    let mut accounts: Vec<Account> = full.iter().map(account).collect();
    accounts.sort_by_key(Account::cost);
    let agrees = injection.as_ref().is_none_or(|injection| injection.agrees);
    match accounts.first() {
        Some(best) => {
            let base = base_of(&best.candidate);
            let convention = &conventions[best.candidate.base / bases.len()];
            verdict.layout.coefficients = under(layout.coefficients, convention);
            tell(&mut verdict, best, &first);
            let alike = |other: &&Account| {
                let (a, b) = (other.cost(), best.cost());
                (a.0, a.1, a.2) == (b.0, b.1, b.2)
            };
            verdict.mistakes = named(best, accounts.iter().filter(alike));
            verdict.wrong = first_wrong(best, base, &later, &turned(&base.port, convention), &hidden);
            verdict.judgement = if !best.reading.known || !best.iterations.agrees || !agrees {
                Judgement::Unknown
            } else if verdict.mistakes.is_empty() {
                Judgement::Correct
            } else {
                Judgement::Mistakes
            };
            if !best.iterations.agrees {
                let at = best.iterations.differs_at;
                let what = at.map_or("the accumulated grid is no known sum".to_owned(), |k| {
                    format!("the grid after iteration {k} does not follow from those before it by any known rule")
                });
                verdict.laws.push(verdict_law("repetition", what));
            }
            if !best.reading.known {
                let ratio = verdict.ratio.map_or(String::new(), |ratio| format!(": side/far is {ratio}"));
                verdict.notes.push(format!("The weights of the faces are those of no known scheme or mistake{ratio}."));
            }
        }
        None => {
            let nearest_account = account(&nearest);
            verdict.scheme = Some(nearest_account.reading.scheme);
            verdict.agreeing = (nearest.agreement.agreeing, nearest.agreement.cells);
            let convention = &conventions[nearest.base / bases.len()];
            verdict.layout.coefficients = under(layout.coefficients, convention);
            let plain = turned(&base_of(&nearest).port, convention);
            let (fit, agreement) = first.precise(&plain, Rounding::Dumped, &first.receivers());
            let reading = weights::read(&fit, base_of(&nearest), &[], 1.0, precision(&later));
            verdict.factor = Some(reading.factor);
            verdict.wrong = agreement.first_wrong.map(|cell| Wrong {
                iteration: 1,
                cell,
                expected: agreement.expected,
                found: agreement.found,
            });
            verdict.laws = laws::broken(&first, &plain);
            let ids: Vec<_> = nearest.edits.iter().map(|e| edits[*e].mistake.id).collect();
            if !ids.is_empty() {
                verdict.notes.push(format!("The nearest known port has {}.", ids.join(" and ")));
            }
        }
    }
    if let Some(injection) = &injection {
        let read = injection.mistakes();
        verdict.mistakes.extend(read.into_iter().map(|(id, detail)| Named { id, detail, or: Vec::new() }));
        if !injection.agrees {
            let what = format!(
                "the injected grid is not the pattern's light ({:.0} % alike)",
                100.0 * injection.alike.clamp(0.0, 1.0)
            );
            verdict.laws.push(verdict_law("injection", what));
            verdict.judgement = Judgement::Unknown;
        }
        if verdict.judgement == Judgement::Correct && !verdict.mistakes.is_empty() {
            verdict.judgement = Judgement::Mistakes;
        }
        let seen_in_injection =
            verdict.mistakes.iter().any(|m| m.id.starts_with("injection") || m.id == "four-digit-constants");
        if let Some((cell, expected, found)) = injection.first_wrong.filter(|_| seen_in_injection || !injection.agrees)
        {
            verdict.wrong = Some(Wrong { iteration: 0, cell, expected, found });
        }
    }
    let mut once: Vec<Named> = Vec::new();
    for mistake in std::mem::take(&mut verdict.mistakes) {
        if !once.iter().any(|m| m.id == mistake.id) {
            once.push(mistake);
        }
    }
    verdict.mistakes = once;
    verdict
}

fn verdict_law(name: &'static str, how: String) -> Law {
    Law { name, how }
}

/// The schemes of other bases that read and put back alike but for clamps.
fn same_faces(bases: &[Base], base: &Base) -> Vec<Nominal> {
    let unclamped = |port: &Port| {
        let mut port = port.clone();
        port.taps.iter_mut().flatten().for_each(|tap| tap.clamp = false);
        port
    };
    let mine = unclamped(&base.port);
    let others = bases.iter().filter(|other| other.port != base.port && unclamped(&other.port) == mine);
    others.flat_map(|other| other.schemes.iter().copied()).collect()
}

/// Rounds what a cell keeps to nothing, all of it or one number for both bands, where the error bars allow.
fn snapped(candidate: &Candidate) -> [f64; super::port::KINDS] {
    let mut weights = candidate.fit.weights;
    let error = |kind: Kind| (5.0 * candidate.fit.deviation(kind)).max(2e-6);
    let (own0, own1) = (candidate.fit.weight(Kind::Own0), candidate.fit.weight(Kind::Own1));
    let both = error(Kind::Own0) + error(Kind::Own1);
    let usual = [0.0, 1.0, 0.875, 0.5, 0.75, 0.9, 0.95];
    let fits = |value: f64| (own0 - value).abs() <= error(Kind::Own0) && (own1 - value).abs() <= error(Kind::Own1);
    let kept = usual.into_iter().find(|value| fits(*value));
    let kept = kept.or_else(|| ((own0 - own1).abs() <= both).then_some((own0 + own1) / 2.0));
    if let Some(kept) = kept {
        weights[Kind::Own0 as usize] = kept;
        weights[Kind::Own1 as usize] = kept;
    }
    if candidate.fit.weight(Kind::Copied).abs() <= error(Kind::Copied) {
        weights[Kind::Copied as usize] = 0.0;
    }
    weights
}

fn account_of(
    candidate: Candidate,
    base: &Base,
    others: &[Nominal],
    edits: &[Edit],
    later: &Later,
    hidden: &[bool],
    mixed: f64,
) -> Account {
    let reading = weights::read(&candidate.fit, base, others, mixed, precision(later));
    let mut all = snapped(&candidate);
    for kind in [Kind::Far, Kind::Side] {
        all[kind as usize] = reading.weights[kind as usize];
    }
    let stepped = Stepped {
        port: &candidate.port,
        weights: all,
        uncertainty: reading.factor.uncertainty / reading.factor.value.abs().max(1e-12),
        rounding: candidate.rounding,
        hidden,
    };
    let iterations = iterations::read(&stepped, later);
    let mut mistakes: Vec<(&'static str, String)> = Vec::new();
    for edit in candidate.edits.iter().map(|e| &edits[*e]) {
        mistakes.push((edit.mistake.id, edit.detail.clone()));
    }
    if candidate.port.reads_itself && !mistakes.iter().any(|m| m.0 == "own-cell") {
        mistakes.push(("own-cell", "light never leaves".to_owned()));
    }
    mistakes.extend(reading.mistakes.iter().cloned());
    // The scheme's own clamps: blog clamps the far face alone, the others clamp every face.
    let blog_like =
        base.port.taps[0].iter().any(|tap| !tap.clamp) && !base.schemes.iter().any(|n| n.scheme == reading.scheme);
    if blog_like && !mistakes.iter().any(|m| m.0.starts_with("clamp")) {
        mistakes.push(("clamp-partial", "sides are not clamped".to_owned()));
    }
    if let Some(id) = iterations.rule.mistake {
        let detail = match id {
            "temporal-mix" => {
                format!("{:.4} of the old light stays", iterations.rule.later[0].max(iterations.rule.stale))
            }
            "own-cell" => format!(
                "{:.5} of its mean, {:.5} of its direction stay",
                iterations.rule.first[0], iterations.rule.first[1]
            ),
            _ => String::new(),
        };
        mistakes.push((id, detail));
    }
    if let Some(id) = iterations.sum.and_then(|sum| sum.mistake) {
        mistakes.push((id, iterations.sum.map_or(String::new(), |sum| format!("the sum is {}", sum.name))));
    }
    if iterations.half {
        mistakes.push(("half-sums", String::new()));
    }
    let rank = candidate.edits.iter().map(|e| edits[*e].rank).sum();
    Account { candidate, reading, iterations, mistakes, rank }
}

/// Lit cells from which half precision tells digits.
const MANY: usize = 100;

/// How finely the dumps tell weights.
fn precision(later: &Later) -> Precision {
    let half = later.source.values().any(|(_, storage)| *storage == Storage::Half);
    let many = later.source.get(&0).is_some_and(|(light, _)| light.lit().len() >= MANY);
    if half && !many { Precision::Coarse } else { Precision::Digits }
}

/// Lets later steps, which the same weights make, narrow the weights down.
fn refine(candidate: &mut Candidate, account: &Account, steps: impl Iterator<Item = Step>) {
    let mut sums = Sums::default();
    let mut known = false;
    for step in steps {
        known = true;
        let mut port = candidate.port.clone();
        port.copied = None;
        // What the first iteration keeps is not kept later: the cell's own light is no unknown.
        let receivers = step.receivers();
        let mut weights = account.reading.weights;
        weights[Kind::Own0 as usize..].fill(0.0);
        let tolerances = step.usual_errors(&port, &weights, candidate.rounding, &receivers);
        step.collect(&port, &receivers, &tolerances, false, &mut sums);
    }
    if known {
        let fit = {
            let mut all = candidate.fit.sums.clone();
            all.join(&sums);
            all.solve(super::fit::DEVIATION)
        };
        candidate.fit = fit;
    }
}

/// Writes what an account says.
fn tell(verdict: &mut Verdict, account: &Account, step: &Step) {
    let port = &account.candidate.port;
    verdict.scheme = Some(account.reading.scheme);
    verdict.factor = Some(account.reading.factor);
    verdict.ratio = account.reading.ratio;
    verdict.agreeing = (account.candidate.agreement.agreeing, account.candidate.agreement.cells);
    verdict.notes.extend(account.reading.notes.iter().cloned());
    let receivers = step.receivers();
    let fits = |port: &Port| step.precise(port, account.candidate.rounding, &receivers).1.is_full();
    let with_clamps = |clamp: bool| {
        let mut port = port.clone();
        port.taps.iter_mut().flatten().for_each(|tap| tap.clamp = clamp);
        port
    };
    let clamps: Vec<bool> = port.taps.iter().flatten().map(|tap| tap.clamp).collect();
    verdict.clamp = if fits(&with_clamps(true)) && fits(&with_clamps(false)) {
        verdict.notes.push("No flux of this light is negative, so clamps do not show; lone lobes aslant of the axes, as in `spaced`, show them.".to_owned());
        "not shown"
    } else if clamps.iter().all(|c| *c) {
        "all"
    } else if clamps.iter().all(|c| !c) {
        "none"
    } else if port.taps.iter().flatten().all(|tap| tap.clamp == (tap.kind == Kind::Far)) {
        "far"
    } else {
        "some"
    }
    .to_owned();
    let beyond = |border: Border| fits(&Port { border, ..port.clone() });
    verdict.border = match port.border {
        _ if beyond(Border::Dark) && beyond(Border::Edge) && beyond(Border::Wrap) => {
            verdict.notes.push(
                "No cell at the border is lit, so the border does not show; the pattern's cells at borders show it."
                    .to_owned(),
            );
            "not shown"
        }
        Border::Dark => "dark",
        Border::Edge => "edge",
        Border::Wrap => "wrap",
        Border::Flat(..) => "flat",
    }
    .to_owned();
    let iterations = &account.iterations;
    verdict.snapshots = iterations.rule.name.to_owned();
    if !iterations.or.is_empty() {
        verdict.notes.push(format!(
            "The dumps fit {} as well; the source after iteration 2 would tell.",
            iterations.or.join(", ")
        ));
    }
    if let Some(sum) = iterations.sum {
        verdict.sum = sum.name.to_owned();
        if !iterations.or_sum.is_empty() {
            verdict.notes.push(format!(
                "The accumulated grid fits {} as well; one of a later iteration would tell.",
                iterations.or_sum.join(", ")
            ));
        }
    }
}

/// The mistakes of an account, each with others that cannot be told from it.
fn named<'a>(best: &Account, alike: impl Iterator<Item = &'a Account>) -> Vec<Named> {
    let mut named: Vec<Named> = Vec::new();
    for (id, detail) in &best.mistakes {
        named.push(Named { id, detail: detail.clone(), or: Vec::new() });
    }
    for other in alike {
        let ids = |account: &Account| account.mistakes.iter().map(|m| m.0).collect::<Vec<_>>();
        let (mine, theirs) = (ids(best), ids(other));
        let only_mine: Vec<_> = mine.iter().filter(|id| !theirs.contains(id)).collect();
        let only_theirs: Vec<_> = theirs.iter().filter(|id| !mine.contains(id)).collect();
        if let ([mine], [theirs]) = (&only_mine[..], &only_theirs[..])
            && let Some(entry) = named.iter_mut().find(|n| n.id == **mine)
            && !entry.or.contains(theirs)
        {
            entry.or.push(theirs);
        }
    }
    named
}

/// The first cell, of the first grid, in which a port with mistakes differs from the scheme at its factor.
fn first_wrong(account: &Account, base: &Base, later: &Later, right: &Port, hidden: &[bool]) -> Option<Wrong> {
    if account.mistakes.is_empty() {
        return None;
    }
    let nominal = base.schemes.iter().find(|n| n.scheme == account.reading.scheme).unwrap_or(&base.schemes[0]);
    let copies_first = account.iterations.rule.name == "copy-first";
    let right = Right::new(right, nominal, account.reading.factor.value, copies_first);
    let mut light = later.source.get(&0)?.0.clone();
    for k in 0..*later.source.keys().max()? {
        light = right.step(k, &light);
        let Some((dump, storage)) = later.source.get(&(k + 1)) else { continue };
        let slack = light.largest() * 1e-6;
        let differs = |i: usize| {
            let (wanted, found) = (light.cells()[i], dump.cells()[i]);
            (0..4).any(|c| (wanted[c] - found[c]).abs() > 4.0 * storage.rounding(wanted[c]) + slack)
        };
        if let Some(i) = (0..dump.cells().len()).filter(|i| !hidden[*i]).find(|i| differs(*i)) {
            let (expected, found) = (light.cells()[i], dump.cells()[i]);
            return Some(Wrong { iteration: k + 1, cell: dump.cell(i), expected, found });
        }
    }
    None
}
