//! Ports with mistakes, right ports and unknown ones, all made from formulas by [`ports`], and what `identify` says
//! of them.

mod ports;

use lpv_lab::study::identify::identify;
use lpv_lab::study::identify::verdict::{Judgement, Verdict};
use lpv_lab::study::pattern::Pattern;
use ports::{PUBLISHED, Port, Random, dumps};

/// Every mistake, by what it changes: two of one list do not go together.
const KINDS: [&[&str]; 9] = [
    &["digit-typo", "swapped-weights", "equal-weights", "no-far-face"],
    &["not-over-4pi", "twice-over-pi"],
    &["componentwise-sides", "face-index-sides", "zero-sides", "sides-30-degrees", "sides-45-degrees", "sides-minus-d",
      "mirrored-sides", "axes-exchanged", "side-table-sign", "reprojected-along-read"],
    &["reads-minus-d", "read-sign", "lobe-sign", "basis-and-lobe-exchanged", "wrong-lobe", "near-face", "four-digit-constants"],
    &["clamp-none", "clamp-partial"],
    &["edge-border", "wrap-border", "flat-layout"],
    &["in-place", "chessboard", "own-cell", "stale-target", "temporal-mix", "sum-into-source", "wrong-cell-copied"],
    &["no-sum", "first-twice", "half-sums"],
    &["injects-minus-n", "injection-axes", "injection-shifted", "injection-brightest", "injection-averaged", "injection-lobe"],
];

fn spaced(side: usize) -> Pattern {
    Pattern::find("spaced", side).unwrap()
}

fn look(port: &Port, pattern: &Pattern, written: &ports::Written) -> Verdict {
    identify(&dumps(port, pattern, written, &[1, 2, 4], &[1, 4]), Some(pattern), &[]).unwrap()
}

/// Whether the mistakes of a verdict are the port's, those that cannot be told apart being alike.
fn names(verdict: &Verdict, wanted: &[&str]) -> bool {
    let is = |named: &lpv_lab::study::identify::verdict::Named, id: &str| named.id == id || named.or.contains(&id);
    verdict.mistakes.len() == wanted.len() && wanted.iter().all(|id| verdict.mistakes.iter().any(|n| is(n, id)))
}

fn told(verdict: &Verdict) -> String {
    let ids: Vec<_> = verdict.mistakes.iter().map(|m| format!("{} ({}) or {:?}", m.id, m.detail, m.or)).collect();
    format!("{:?} {:?} {:?} {:?}", verdict.judgement, ids, verdict.laws, verdict.snapshots)
}

#[test]
fn every_mistake_is_named_alone() {
    let mut wrong = Vec::new();
    for id in KINDS.concat() {
        for (side, form, half) in [(8, 0, false), (8, 1, false), (16, 8, false), (8, 13, true)] {
            // Half precision cannot show digits of constants, nor sums in half.
            if half && ["digit-typo", "four-digit-constants", "half-sums"].contains(&id) {
                continue;
            }
            let port = Port { mistakes: vec![id], form, half, ..Port::right("cascaded", 3.0) };
            let verdict = look(&port, &spaced(side), &PUBLISHED);
            if verdict.judgement != Judgement::Mistakes || !names(&verdict, &[id]) {
                wrong.push(format!("{id} {side} {form} {half}: {}", told(&verdict)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
