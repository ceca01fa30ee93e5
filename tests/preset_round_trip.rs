//! Whatever preset the window can make, its file gives it back; and no text makes the reader panic.
#![allow(clippy::expect_used)]

use std::path::{Path, PathBuf};

use lpv_lab::scene::cell_file::Column;
use lpv_lab::scene::injector::{Injector, InjectorKind, Side};
use lpv_lab::scene::occluder::{Accumulate, Axis, BlockingSign, Occluder, OccluderKind, OcclusionMode};
use lpv_lab::scene::path::Keyframe;
use lpv_lab::scene::propagation::Snapshots;
use lpv_lab::scene::propagation::descent::{Descent, Inside};
use lpv_lab::scene::propagation::directions::Lattice;
use lpv_lab::scene::propagation::directions::Rule;
use lpv_lab::scene::propagation::directions::{MOST_DIRECTIONS, Setting};
use lpv_lab::scene::propagation::{Index, Policy};
use lpv_lab::scene::{Occlusion, Preset, Propagation};
use proptest::prelude::*;
use proptest::sample::select;

const SIZE: usize = 16;

fn cell() -> impl Strategy<Value = [usize; 3]> {
    prop::array::uniform3(0..SIZE)
}

/// Two corners in their order.
fn corners() -> impl Strategy<Value = ([usize; 3], [usize; 3])> {
    (cell(), cell())
        .prop_map(|(a, b)| (std::array::from_fn(|i| a[i].min(b[i])), std::array::from_fn(|i| a[i].max(b[i]))))
}

fn path() -> impl Strategy<Value = PathBuf> {
    "[a-zé \"'\\\\]{1,8}(/[a-z]{1,5})?\\.(csv|npy)".prop_map(PathBuf::from)
}

fn vector() -> impl Strategy<Value = Option<[f64; 3]>> {
    let part = prop_oneof![Just(0.0), Just(-0.0), -1e300..1e300, -1.0..1.0];
    prop::option::of(prop::array::uniform3(part).prop_filter("not zero", |v| v.iter().any(|x| *x != 0.0)))
}

/// Keyframes in the order of time.
fn moves() -> impl Strategy<Value = Vec<Keyframe>> {
    let key = (0.001..1e3, prop::array::uniform3(-1e3..1e3));
    prop::collection::vec(key, 0..3).prop_map(|keys| {
        let mut time = -1.0;
        let later = |(step, by)| {
            time += step;
            Keyframe { time, by }
        };
        keys.into_iter().map(later).collect()
    })
}

fn descent() -> impl Strategy<Value = Descent> {
    let leaves = (2.0..100.0).prop_map(|distance| Descent::Leaves { distance });
    let center = prop::option::of(prop::array::uniform3(0.0..=SIZE as f64));
    let cascades = (center, any::<bool>()).prop_map(|(center, alone)| Descent::Cascades { side: SIZE, center, alone });
    prop_oneof![Just(Descent::Off), Just(Descent::Cells), leaves, cascades]
}

fn injector() -> impl Strategy<Value = Injector> {
    let kind = prop_oneof![
        select(&Side::ALL[..]).prop_map(|side| InjectorKind::Wall { side }),
        (corners(), 0..3usize).prop_map(|((from, mut to), axis)| {
            to[axis] = from[axis];
            InjectorKind::Rectangle { from, to }
        }),
        cell().prop_map(|cell| InjectorKind::Single { cell }),
        (path(), select(&[None, Some(Column::Source), Some(Column::Accumulated)][..]))
            .prop_map(|(path, column)| InjectorKind::File { path, column }),
    ];
    let color = prop::array::uniform3(prop_oneof![Just(1.0), 0.0..100.0]);
    (kind, vector(), prop_oneof![Just(1.0), 0.0..1e20], color, any::<bool>(), moves()).prop_map(
        |(kind, direction, multiplier, color, enabled, path)| {
            let direction = direction.filter(|_| !matches!(kind, InjectorKind::File { .. }));
            Injector { kind, direction, multiplier, color, enabled, path }
        },
    )
}

fn occluder() -> impl Strategy<Value = Occluder> {
    let kind = prop_oneof![
        corners().prop_map(|(from, to)| OccluderKind::Box { from, to }),
        (select(&[Axis::X, Axis::Y, Axis::Z][..]), 0..SIZE).prop_map(|(axis, at)| OccluderKind::Plane { axis, at }),
        path().prop_map(|path| OccluderKind::File { path }),
    ];
    let share = || prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0];
    (kind, vector(), share(), prop::array::uniform3(share()), any::<bool>())
        .prop_map(|(kind, normal, opacity, albedo, enabled)| Occluder { kind, normal, opacity, albedo, enabled })
}

fn occlusion() -> impl Strategy<Value = Occlusion> {
    let mode = select(&[OcclusionMode::Off, OcclusionMode::Fuzzy, OcclusionMode::Hard][..]);
    let sign = select(&[BlockingSign::AgainstTravel, BlockingSign::AlongTravel][..]);
    let accumulate = select(&[Accumulate::Everywhere, Accumulate::Occupied][..]);
    (mode, 0.0..1e10, sign, any::<usize>(), 0.0..10.0, accumulate).prop_map(
        |(mode, amplifier, sign, from_iteration, bounce, accumulate)| Occlusion {
            mode,
            amplifier,
            sign,
            from_iteration,
            bounce,
            accumulate,
        },
    )
}

fn propagation() -> impl Strategy<Value = Propagation> {
    let snapshots = select(&[Snapshots::Thesis, Snapshots::CopyFirst, Snapshots::WithoutInjected][..]);
    let scheme = select(lpv_lab::transport::names()).prop_map(str::to_owned);
    let ordinates = (1..=MOST_DIRECTIONS, select(&Rule::ALL[..]), select(&Lattice::ALL[..]))
        .prop_map(|(directions, rule, lattice)| Setting { directions, rule, lattice });
    let descent = (descent(), select(&[Inside::Exponential, Inside::Constant][..]));
    let index = prop_oneof![Just(Index::Thesis), (0.1..100.0).prop_map(|reach| Index::Radial { reach })];
    let levels = (select(&Policy::ALL[..]), index, descent);
    (scheme, 0.0..10.0, 0..1_000_000usize, snapshots, any::<bool>(), levels, ordinates).prop_map(
        |(scheme, factor, iterations, snapshots, clamp, (levels, index, (descent, inside)), ordinates)| Propagation {
            scheme,
            factor,
            iterations,
            snapshots,
            clamp,
            levels,
            index,
            descent,
            inside,
            ordinates,
        },
    )
}

fn preset() -> impl Strategy<Value = Preset> {
    let injectors = prop::collection::vec(injector(), 0..5);
    let occluders = prop::collection::vec(occluder(), 0..5);
    (any::<String>(), select(&[1, 2, 16][..]), injectors, occluders, occlusion(), propagation()).prop_map(
        |(title, coarsest, injectors, occluders, occlusion, propagation)| Preset {
            title,
            size: SIZE,
            coarsest,
            injectors,
            occluders,
            occlusion,
            propagation,
            ..Preset::default()
        },
    )
}

/// Reads a text that may be anything; if it is refused, then in one line.
fn try_parse(text: &str) {
    if let Err(error) = Preset::parse(text, Path::new("p.ron")) {
        let line = error.to_string();
        assert!(line.starts_with("p.ron:") && line.lines().count() == 1, "{line}");
    }
}

proptest! {
    #[test]
    fn a_written_preset_reads_back_equal(preset in preset()) {
        prop_assert_eq!(preset.check(), Ok(()));
        let text = preset.to_ron();
        prop_assert_eq!(Preset::parse(&text, Path::new("p.ron")), Ok(preset.clone()), "{}", text);
        prop_assert_eq!(preset.clone().to_ron(), text);
    }

    #[test]
    fn a_damaged_preset_is_read_or_refused(preset in preset(), at in any::<prop::sample::Index>(), with in "\\PC{0,3}") {
        let text: Vec<char> = preset.to_ron().chars().collect();
        let at = at.index(text.len());
        let (before, after): (String, String) = (text[..at].iter().collect(), text[at + 1..].iter().collect());
        try_parse(&format!("{before}{with}{after}"));
        try_parse(&before);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "[\\(\\)\\[\\]{}:,\"'/*#!r0-9a-z \n\\\\.+-]{0,120}") {
        try_parse(&text);
        try_parse(&format!("(version: 1, size: 3, injectors: [(kind: Wall(side: NegX), {text}"));
        try_parse(&format!("(version: 1, /*{text}*/ title: \"{text}\", coarsest: 3)"));
    }
}

#[test]
fn saving_and_loading_gives_the_same_preset() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("p.ron");
    for title in ["first", "second"] {
        let preset = Preset { title: title.to_owned(), ..Preset::default() };
        preset.save(&path).expect("saved");
        assert_eq!(Preset::load(&path), Ok(preset));
    }
}

#[test]
fn defaults_are_left_out_of_the_file_and_fields_left_out_are_defaults() {
    assert_eq!(Preset::default().to_ron(), "(\n    version: 1,\n    size: 32,\n)\n");
    assert_eq!(Preset::parse("(version: 1)", Path::new("p.ron")), Ok(Preset::default()));
    let text = "(\n    version: 1,\n    size: 8,\n    injectors: [\n        (kind: Wall(side: NegX)),\n    ],\n)\n";
    let preset = Preset::parse(text, Path::new("p.ron")).expect("a preset");
    assert_eq!(preset.to_ron(), text);
}
