//! Ports with mistakes, right ports and unknown ones, all made from formulas by [`ports`], and what `identify` says
//! of them.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod ports;

use lpv_lab::study::identify::identify;
use lpv_lab::study::identify::{Judgement, Verdict};
use lpv_lab::study::pattern::Pattern;
use ports::{PUBLISHED, Port, Random, dumps};

/// Every mistake, by what it changes: two of one list do not go together.
const KINDS: [&[&str]; 9] = [
    &["digit-typo", "swapped-weights", "equal-weights", "no-far-face"],
    &["not-over-4pi", "twice-over-pi"],
    &[
        "componentwise-sides",
        "face-index-sides",
        "zero-sides",
        "sides-30-degrees",
        "sides-45-degrees",
        "sides-minus-d",
        "mirrored-sides",
        "axes-exchanged",
        "side-table-sign",
        "reprojected-along-read",
    ],
    &[
        "reads-minus-d",
        "read-sign",
        "lobe-sign",
        "basis-and-lobe-exchanged",
        "wrong-lobe",
        "near-face",
        "four-digit-constants",
    ],
    &["clamp-none", "clamp-partial"],
    &["edge-border", "wrap-border", "flat-layout"],
    &["in-place", "chessboard", "own-cell", "stale-target", "temporal-mix", "sum-into-source", "wrong-cell-copied"],
    &["no-sum", "first-twice", "half-sums"],
    &[
        "injects-minus-n",
        "injection-axes",
        "injection-shifted",
        "injection-brightest",
        "injection-averaged",
        "injection-lobe",
    ],
];

fn spaced(side: usize) -> Pattern {
    Pattern::find("spaced", side).unwrap()
}

fn look(port: &Port, pattern: &Pattern, written: &ports::Written) -> Verdict {
    identify(&dumps(port, pattern, written, &[1, 2, 4], &[1, 4]), Some(pattern), &[]).unwrap()
}

/// Whether the mistakes of a verdict are the port's, those that cannot be told apart being alike.
fn names(verdict: &Verdict, wanted: &[&str]) -> bool {
    let is = |named: &lpv_lab::study::identify::Named, id: &str| named.id == id || named.or.contains(&id);
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

/// Some mistakes that go together, at random.
fn together(random: &mut Random, count: usize, half: bool) -> Vec<&'static str> {
    loop {
        let mut kinds: Vec<usize> = (0..KINDS.len()).collect();
        let mut chosen = Vec::new();
        for _ in 0..count {
            let kind = kinds.remove(random.below(kinds.len()));
            chosen.push(random.pick(KINDS[kind]));
        }
        if go_together(&chosen)
            && !(half && chosen.iter().any(|id| ["digit-typo", "four-digit-constants", "half-sums"].contains(id)))
        {
            return chosen;
        }
    }
}

/// Mistakes hide each other: what one takes away another cannot change.
// One line a reason reads better than the shortest form.
#[allow(clippy::nonminimal_bool)]
fn go_together(chosen: &[&str]) -> bool {
    let has = |id: &str| chosen.contains(&id);
    let any = |ids: &[&str]| ids.iter().any(|id| has(id));
    let lightless_sides = any(&["zero-sides", "face-index-sides", "componentwise-sides"]);
    let copies = any(&["sum-into-source", "temporal-mix", "wrong-cell-copied", "own-cell"]);
    // The sum of ports that keep light is a sum of sums; S0 twice is then once more.
    !(lightless_sides && has("clamp-partial"))
        && !(has("no-far-face") && any(&["digit-typo", "near-face", "clamp-none", "clamp-partial"]))
        && !(lightless_sides && any(&["digit-typo", "four-digit-constants", "read-sign", "lobe-sign"]))
        // A cell that reads itself meets no border, and what turns light does not show.
        && !(has("own-cell") && any(&["edge-border", "wrap-border", "flat-layout", "in-place", "chessboard", "injects-minus-n", "injection-axes"]))
        && !(has("own-cell") && KINDS[2].iter().chain(KINDS[3]).any(|id| has(id)))
        // Sides that look the other way, read backwards, are all of it read backwards: one mistake.
        && !(has("mirrored-sides") && has("reads-minus-d"))
        && !(copies && any(&["first-twice", "no-sum"]))
        && !(has("first-twice") && has("half-sums"))
        && !(has("four-digit-constants") && any(&["injection-lobe", "digit-typo"]))
}

#[test]
fn right_ports_are_never_accused_and_their_factor_is_right() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut wrong = Vec::new();
    for i in 0..200 {
        let scheme = random.pick(&["cascaded", "blog", "axial", "cone"]);
        let factor = 1.0 + random.below(3001) as f64 / 1000.0;
        let half = random.below(2) == 0;
        let copy_first = random.below(3) == 0;
        let port = Port {
            half,
            stored: random.below(2) == 0,
            copy_first,
            sum_from: if copy_first { 1 } else { random.below(2) },
            ..Port::right(scheme, factor)
        };
        let (name, side) = random.pick(&[("spaced", 8), ("spaced", 16), ("dense", 8)]);
        let pattern = Pattern::find(name, side).unwrap();
        let iterations = random.pick(&[&[1usize][..], &[1, 2], &[1, 4], &[1, 2, 4]]);
        let sums = random.pick(&[&[][..], &[1usize], &[4], &[1, 2, 4]]);
        let written = random.written();
        let verdict = identify(&dumps(&port, &pattern, &written, iterations, sums), Some(&pattern), &[]).unwrap();
        let right = verdict.judgement == Judgement::Correct
            && verdict.scheme == Some(scheme)
            && verdict.factor.is_some_and(|found| found.holds(factor));
        if !right {
            wrong.push(format!(
                "{i} {name}{side} {iterations:?} {sums:?} {port:?}: {} {:?} {:?}",
                told(&verdict),
                verdict.scheme,
                verdict.factor
            ));
        }
    }
    assert!(wrong.is_empty(), "{} wrong\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn random_mistakes_are_named() {
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let mut wrong = Vec::new();
    let count = 600;
    for i in 0..count {
        let half = random.below(4) == 0;
        let mistakes = together(&mut random, 1 + i % 3, half);
        let port = Port {
            mistakes: mistakes.clone(),
            form: random.below(24),
            half,
            ..Port::right("cascaded", random.pick(&[1.0, 2.0, 3.0, 3.8, 4.0]))
        };
        let pattern = spaced(random.pick(&[8, 16]));
        let written = random.written();
        let verdict = look(&port, &pattern, &written);
        if verdict.judgement != Judgement::Mistakes || !names(&verdict, &mistakes) {
            wrong.push(format!(
                "{i} {mistakes:?} form {} p {} half {half} {}: {}",
                port.form,
                port.factor,
                pattern.side(),
                told(&verdict)
            ));
        }
    }
    println!("{} of {count} named\n{}", count - wrong.len(), wrong.join("\n"));
    assert!(wrong.len() * 100 <= count, "{} of {count} not named\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn pairs_of_mistakes_are_named() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (a, first) in KINDS.iter().enumerate() {
        for (b, second) in KINDS.iter().enumerate().skip(a + 1) {
            let pairs = first.iter().flat_map(|x| second.iter().map(move |y| [*x, *y]));
            // Some of every two kinds, so that every mistake meets others.
            for (i, pair) in pairs.filter(|pair| go_together(pair)).enumerate().filter(|(i, _)| i % 5 == (a + b) % 5) {
                count += 1;
                let port = Port { mistakes: pair.to_vec(), form: i % 24, ..Port::right("cascaded", 3.0) };
                let verdict = look(&port, &spaced(8), &PUBLISHED);
                if verdict.judgement != Judgement::Mistakes || !names(&verdict, &pair) {
                    wrong.push(format!("{pair:?} form {}: {}", i % 24, told(&verdict)));
                }
            }
        }
    }
    println!("{} of {count} named\n{}", count - wrong.len(), wrong.join("\n"));
    assert!(wrong.len() * 100 <= count, "{} of {count} not named\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_wrong_digit_shows_in_half_precision_on_the_dense_pattern_alone() {
    for factor in [1.0, 3.0, 3.8] {
        let port = Port { mistakes: vec!["digit-typo"], half: true, ..Port::right("cascaded", factor) };
        let dense = Pattern::find("dense", 8).unwrap();
        let verdict = look(&port, &dense, &PUBLISHED);
        assert!(names(&verdict, &["digit-typo"]), "{} {:?}", told(&verdict), verdict.ratio);
        for side in [8, 16] {
            let verdict = look(&port, &spaced(side), &PUBLISHED);
            assert_eq!(verdict.judgement, Judgement::Correct, "{}", told(&verdict));
        }
    }
}

#[test]
fn unknown_ports_are_called_unknown_with_the_law_they_break() {
    let strange: [(&str, ports::Strange); 4] = [
        ("symmetry", |_, d, flux| if d / 2 == 1 { 1.2 * flux } else { flux }),
        ("homogeneity", |_, _, flux| flux.abs().powf(1.1)),
        ("translation", |[x, y, z], _, flux| {
            flux * (1.0 + 0.3 * (0.7 * x as f64 + 1.9 * y as f64 + 0.4 * z as f64).sin())
        }),
        ("homogeneity", |_, _, flux| flux / (1.0 + 0.3 * flux.abs())),
    ];
    for half in [false, true] {
        for side in [8, 16] {
            let mut ports: Vec<(&str, Port)> = strange
                .iter()
                .map(|(law, rule)| (*law, Port { strange: Some(*rule), half, ..Port::right("cascaded", 3.0) }))
                .collect();
            ports.push(("reach", Port { eighteen: true, half, ..Port::right("cascaded", 3.0) }));
            for (law, port) in ports {
                let verdict = look(&port, &spaced(side), &PUBLISHED);
                assert_eq!(verdict.judgement, Judgement::Unknown, "{law} {side} {half} {}", told(&verdict));
                assert!(verdict.laws.iter().any(|l| l.name == law), "{law} {side} {half} {}", told(&verdict));
            }
        }
    }
}

#[test]
fn right_ports_with_a_scene_of_their_own_are_not_accused() {
    let mut random = Random(0x1234_5678_9abc_def1);
    for _ in 0..40 {
        let scheme = random.pick(&["cascaded", "blog", "axial", "cone"]);
        let half = random.below(2) == 0;
        let port = Port { half, ..Port::right(scheme, 3.0) };
        let pattern = spaced(8);
        let verdict = identify(&dumps(&port, &pattern, &random.written(), &[1, 2, 4], &[4]), None, &[]).unwrap();
        assert_eq!(verdict.judgement, Judgement::Correct, "{port:?} {}", told(&verdict));
        assert!(verdict.factor.is_some_and(|found| found.holds(3.0)));
    }
}
