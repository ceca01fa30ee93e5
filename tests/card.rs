//! The card against the processor, to the last bit. Where no driver answers the suite says so, and does not run.
#![cfg(feature = "gpu")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::propagation::descent::Descent;
use lpv_lab::scene::propagation::{Policy, Snapshots};
use lpv_lab::scene::{Preset, Problem, builtin};
use lpv_lab::simulation::options::{Device, Options, Wanted};
use lpv_lab::simulation::{Action, Simulation};
use lpv_lab::transport::gpu::Device as Card;
use lpv_lab::transport::{self, preset};

/// Whether there is a card to test.
fn is_there() -> bool {
    let card = Card::shared();
    match &card {
        Ok(card) => eprintln!("the card's suite runs on {}", card.name()),
        Err(error) => eprintln!("the card's suite did not run: {error}"),
    }
    card.is_ok()
}

fn builtin_preset(name: &str) -> Preset {
    preset::parse(builtin::find(name).unwrap(), Path::new(name)).unwrap()
}

fn both(preset: &Preset) -> [Simulation<f32>; 2] {
    let folder = builtin::folder().unwrap();
    let problem = std::sync::Arc::new(Problem::build(preset, &folder).unwrap());
    [Device::Cpu, Device::Gpu].map(|device| {
        let options = Options { device, ..Options::default() };
        Simulation::with_options(std::sync::Arc::clone(&problem), options).unwrap()
    })
}

/// All light and all marks, bit by bit.
fn assert_same(what: &str, [cpu, card]: &[Simulation<f32>; 2]) {
    assert_eq!(cpu.iteration(), card.iteration(), "{what}");
    for (channel, (wanted, found)) in cpu.lights().iter().zip(card.lights()).enumerate() {
        let octrees = [
            ("source", &wanted.source, &found.source),
            ("target", &wanted.target, &found.target),
            ("accumulated", &wanted.accumulated, &found.accumulated),
        ];
        for (name, wanted, found) in octrees {
            for i in 0..cpu.sizes().count() {
                for (cell, wanted) in wanted.level(i).iter() {
                    let found = found.level(i).get(cell);
                    let same = found.0.map(f32::to_bits) == wanted.0.map(f32::to_bits);
                    assert!(same, "{what}: {name}, channel {channel}, level {i}, {cell:?}: {found:?}, {wanted:?}");
                }
            }
        }
        assert_eq!(wanted.merged, found.merged, "{what}: merged");
    }
    for i in 0..cpu.sizes().count() {
        assert_eq!(cpu.index().level(i), card.index().level(i), "{what}: marks of level {i}");
    }
    assert_eq!(cpu.arrivals(None), card.arrivals(None), "{what}: what arrived at solids");
}

/// Step by step, then many at once, up to sixteen iterations.
fn compare(what: &str, preset: &Preset) {
    let mut pair = both(preset);
    for simulation in &mut pair {
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            simulation.act(action);
        }
    }
    for more in [1, 1, 1, 1, 5, 7] {
        for simulation in &mut pair {
            if more == 1 {
                simulation.act(Action::Propagate);
            } else {
                simulation.advance(more, Wanted::Everything);
            }
            simulation.act(Action::Merge);
        }
        assert_same(&format!("{what}, k = {}", pair[0].iteration()), &pair);
    }
    assert!(pair[0].iteration() == 16 || pair[0].divergence().is_some(), "{what}");
}

#[test]
fn every_preset_has_the_processors_bits() {
    if !is_there() {
        return;
    }
    for name in builtin::PRESETS.iter().map(|(name, _)| *name) {
        let preset = builtin_preset(name);
        let has_kernels = transport::find(&preset.propagation.scheme).is_some_and(|kind| kind.card.is_some());
        let has_levels = matches!(preset.propagation.levels, Policy::Same | Policy::Consistent);
        if has_kernels && has_levels && preset.propagation.descent == Descent::Off {
            compare(name, &preset);
        } else {
            let problem = Problem::build(&preset, &builtin::folder().unwrap()).unwrap();
            let options = Options { device: Device::Gpu, ..Options::default() };
            let (_, why) = Simulation::<f32>::with_fallback(problem, options).unwrap();
            assert!(why.is_some_and(|why| why.contains("--device cpu")), "{name}");
        }
    }
}

#[test]
fn every_scheme_level_policy_and_snapshot_has_the_processors_bits() {
    if !is_there() {
        return;
    }
    for kind in transport::kinds().iter().filter(|kind| kind.card.is_some()) {
        for levels in [Policy::Same, Policy::Consistent] {
            let mut preset = builtin_preset("level-jump");
            preset.propagation.scheme = kind.name.to_owned();
            preset.propagation.levels = levels;
            compare(&format!("{} {levels}", kind.name), &preset);
        }
    }
    let mut preset = builtin_preset("opposite-lobes");
    for snapshots in [Snapshots::CopyFirst, Snapshots::WithoutInjected] {
        preset.propagation.snapshots = snapshots;
        compare(&format!("{snapshots:?}"), &preset);
    }
    preset.propagation.clamp = false;
    compare("without clamps", &preset);
}

#[test]
fn occluders_of_every_kind_have_the_processors_bits() {
    if !is_there() {
        return;
    }
    for scheme in ["cascaded", "reflective"] {
        for (mode, bounce, from) in
            [(OcclusionMode::Fuzzy, 0.0, 3), (OcclusionMode::Fuzzy, 1.0, 2), (OcclusionMode::Hard, 0.5, 2)]
        {
            let mut preset = builtin_preset("pillar");
            preset.propagation.scheme = scheme.to_owned();
            preset.propagation.levels = if bounce == 1.0 { Policy::Consistent } else { Policy::Same };
            preset.occlusion.mode = mode;
            preset.occlusion.bounce = bounce;
            preset.occluders[0].albedo = [0.5, 0.4, 0.3];
            preset.occlusion.from_iteration = from;
            compare(&format!("{scheme} {mode:?} {bounce}"), &preset);
        }
    }
}

#[test]
fn what_the_card_does_not_do_is_refused_with_the_reason() {
    let mut preset = builtin_preset("one-lobe");
    preset.propagation.scheme = "ordinates".to_owned();
    let problem = Problem::build(&preset, Path::new("")).unwrap();
    let options = Options { device: Device::Gpu, ..Options::default() };
    let error = Simulation::<f32>::with_options(problem, options).unwrap_err().to_string();
    assert!(error.contains("ordinates") && error.contains("--device cpu"), "{error}");
    let problem = Problem::build(&builtin_preset("one-lobe"), Path::new("")).unwrap();
    let error = Simulation::<f64>::with_options(problem, options).unwrap_err().to_string();
    assert!(error.contains("double precision"), "{error}");
}
