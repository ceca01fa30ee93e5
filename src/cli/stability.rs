//! `stability`: where every scheme keeps its light bounded, how far single precision drifts in long runs, and whether
//! what must hold of every scene holds of random ones.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::ProgressBar;

use super::console::say;
use super::numbers::decimal;
use super::output::Folder;
use super::{CliError, SceneArgs};
use crate::report::colour::Theme;
use crate::report::plot::{Curve, Dash, Figure, Plot};
use crate::report::table::{Table, Value};
use crate::scene::Problem;
use crate::scene::propagation::Policy;
use crate::study::stability::drift::{DriftRow, LongRun};
use crate::study::stability::level::critical_of_octree;
use crate::study::stability::outlook;
use crate::study::stability::{self, critical_without_borders, critical_without_clamps};
use crate::study::stress::{self, Outcome};
use crate::transport;
use crate::transport::lattice::schemes;

/// What to examine, where to write.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  lpv-lab stability\n  lpv-lab stability mixed --factor 5\n  \
                        lpv-lab stability --sizes 2,4,8,16,32 --iterations 10000 --out results\n\n\
                        With --out the folder gets critical.csv, drift.csv, drift.svg, drift.png and rules.csv. A random scene that\n\
                        breaks a rule is made small and saved there, or in the current folder, as broken-SEED-SCENE.ron.")]
pub struct StabilityArgs {
    /// A preset, or the name of a built-in one: what becomes of its levels at its own factor
    preset: Option<PathBuf>,
    /// Look at the preset with this factor instead
    #[arg(long, value_name = "P", requires = "preset", value_parser = decimal, allow_negative_numbers = true)]
    factor: Option<f64>,
    /// The sides of the volumes, powers of two up to 64
    #[arg(long, value_name = "N,N", value_delimiter = ',', default_values_t = [2, 4, 8, 16])]
    sizes: Vec<usize>,
    /// Iterations of the long runs
    #[arg(long, value_name = "K", default_value_t = 1000)]
    iterations: usize,
    /// The side of the long runs' volume
    #[arg(long, value_name = "N", default_value_t = 8)]
    side: usize,
    /// Random scenes to hold against the rules that no scene may break
    #[arg(long, value_name = "COUNT", default_value_t = 100)]
    scenes: usize,
    /// The seed that the random scenes are made from
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
    /// The folder for the results; without it tables go to the terminal only
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The largest side whose critical factors are computed; larger ones take minutes.
const LARGEST: usize = 64;
/// Shares of the critical factor at which long runs go.
const SHARES: [f64; 2] = [0.999, 1.0];
/// Points of a drift curve.
const POINTS: usize = 50;

/// Does the command.
pub fn run(args: &StabilityArgs) -> Result<(), CliError> {
    for &side in args.sizes.iter().chain([&args.side]) {
        if !side.is_power_of_two() || !(2..=LARGEST).contains(&side) {
            return Err(CliError::Input(format!("a side of {side} cells: give a power of two from 2 to {LARGEST}")));
        }
    }
    let folder = args.out.clone().map(Folder::create).transpose()?;
    if let Some(preset) = &args.preset {
        let scene = SceneArgs { preset: preset.clone(), factor: args.factor, ..SceneArgs::default() };
        print_outlook(&scene.load()?.1);
    }
    let critical = critical_factors(&args.sizes);
    say!("Critical factors: above them light grows without bound\n\n{}", critical.to_text());
    let drifts = long_runs(args)?;
    let drift = drift_table(&drifts);
    say!("Single precision against double, relative\n\n{}", last_rows(&drifts).to_text());
    let outcome = random_scenes(args);
    let rules = rules_table(&outcome);
    say!(
        "Random scenes of seed {}: {} scenes, {} iterations, {} stopped before they overflowed\n\n{}",
        args.seed,
        outcome.scenes,
        outcome.iterations,
        outcome.stopped,
        rules.to_text()
    );
    if let Some(folder) = &folder {
        folder.write_table("critical.csv", &critical)?;
        folder.write_table("drift.csv", &drift)?;
        folder.write_table("rules.csv", &rules)?;
        folder.write_svg_and_png("drift", &drift_figure(args, &drifts).to_svg())?;
        say!("Results in {}", folder.path().display());
    }
    save_findings(args.seed, &outcome, folder.as_ref())?;
    folder.into_iter().for_each(Folder::finish);
    Ok(())
}

/// Tries the random scenes, with a bar where somebody watches.
fn random_scenes(args: &StabilityArgs) -> Outcome {
    let bar = match std::io::stderr().is_terminal() {
        true => ProgressBar::new(args.scenes as u64),
        false => ProgressBar::hidden(),
    };
    let outcome = stress::run(args.seed, args.scenes, |scene| bar.set_position(scene as u64));
    bar.finish_and_clear();
    outcome
}

/// How many scenes each rule was held against, and how many broke it.
fn rules_table(outcome: &Outcome) -> Table<3> {
    let mut table = Table::new(["rule", "scenes", "broken"]);
    for (rule, scenes) in &outcome.checked {
        let broken = outcome.findings.iter().filter(|finding| finding.broken.invariant == *rule).count();
        table.push([rule.name().into(), (*scenes).into(), broken.into()]);
    }
    table
}

/// Saves what broke a rule; the command failed if anything did.
fn save_findings(seed: u64, outcome: &Outcome, folder: Option<&Folder>) -> Result<(), CliError> {
    for finding in &outcome.findings {
        let name = format!("broken-{seed}-{}.ron", finding.scene);
        let path = match folder {
            Some(folder) => {
                folder.write(&name, finding.preset.to_ron())?;
                folder.path().join(name)
            }
            None => {
                finding.preset.save(Path::new(&name)).map_err(|e| CliError::Failed(e.to_string()))?;
                PathBuf::from(name)
            }
        };
        say!("{}: {}", path.display(), finding.broken);
    }
    match outcome.findings.len() {
        0 => Ok(()),
        count => Err(CliError::Failed(format!("{count} of {} random scenes broke a rule; see above", outcome.scenes))),
    }
}

/// What becomes of every level of a scene.
fn print_outlook(problem: &Problem) {
    if let Some(kind) = transport::find(&problem.propagation.scheme).filter(|kind| !kind.can.grows) {
        let longest = 3 * problem.size - 2;
        say!("{} have no critical factor: light leaves the volume within {longest} iterations", kind.name);
        return;
    }
    let mut table = Table::new(["level", "side", "critical factor", "growth an iteration", "overflow about iteration"]);
    for level in outlook::levels(problem) {
        let overflow = level.overflow.map_or("never".to_owned(), |k| k.to_string());
        let overflow = Value::Text(overflow);
        table.push([level.level.into(), level.side.into(), level.critical.into(), level.growth.into(), overflow]);
    }
    let propagation = &problem.propagation;
    say!("{} at factor {}\n\n{}", propagation.scheme, propagation.factor, table.to_text());
}

/// Every scheme at every size, with the gains it has and the factors it bears.
fn critical_factors(sizes: &[usize]) -> Table<8> {
    let mut table = Table::new([
        "scheme",
        "size",
        "mean_gain",
        "direction_gain",
        "critical",
        "consistent_levels",
        "without_clamps",
        "without_borders",
    ]);
    for scheme in schemes::all() {
        let found = stability::of_scheme(&scheme, sizes);
        let unbounded = critical_without_borders(&scheme, true);
        for (size, critical) in found.critical {
            let linear = critical_without_clamps(&scheme, size);
            let gains = [found.mean_gain, found.direction_gain].map(Value::from);
            let [mean, direction] = gains;
            let consistent = critical_of_octree(&scheme, Policy::Consistent, size);
            let [critical, consistent, linear, unbounded] = [critical, consistent, linear, unbounded].map(Value::from);
            table.push([scheme.name.into(), size.into(), mean, direction, critical, consistent, linear, unbounded]);
        }
    }
    table
}

/// A long run and what it is called.
struct Drift {
    scheme: &'static str,
    share: f64,
    factor: f64,
    rows: Vec<DriftRow>,
}

fn long_runs(args: &StabilityArgs) -> Result<Vec<Drift>, CliError> {
    let mut drifts = Vec::new();
    for scheme in schemes::all() {
        let critical = stability::of_scheme(&scheme, &[args.side]).critical;
        for (share, (size, critical)) in SHARES.into_iter().flat_map(|share| critical.iter().map(move |c| (share, *c)))
        {
            let factor = share * critical;
            let run = LongRun { scheme: &scheme, size, factor, iterations: args.iterations, rows: POINTS };
            drifts.push(Drift { scheme: scheme.name, share, factor, rows: run.run()? });
        }
    }
    Ok(drifts)
}

fn drift_row(drift: &Drift, row: &DriftRow) -> [Value; 9] {
    [
        drift.scheme.into(),
        drift.share.into(),
        drift.factor.into(),
        row.iteration.into(),
        row.energy.into(),
        row.source.into(),
        row.accumulated.into(),
        row.summing.into(),
        row.bound.into(),
    ]
}

const DRIFT: [&str; 9] =
    ["scheme", "share", "factor", "iteration", "energy", "source", "accumulated", "summing", "bound"];

/// All rows of all runs.
fn drift_table(drifts: &[Drift]) -> Table<9> {
    let mut table = Table::new(DRIFT);
    for drift in drifts {
        drift.rows.iter().for_each(|row| table.push(drift_row(drift, row)));
    }
    table
}

/// How each run ended.
fn last_rows(drifts: &[Drift]) -> Table<9> {
    let mut table = Table::new(DRIFT);
    for drift in drifts {
        drift.rows.last().iter().for_each(|row| table.push(drift_row(drift, row)));
    }
    table
}

/// The drift of the source at the critical factor, and what it may be.
fn drift_figure(args: &StabilityArgs, drifts: &[Drift]) -> Figure {
    let at_critical = drifts.iter().filter(|drift| drift.share == 1.0);
    let points = |drift: &Drift, of: fn(&DriftRow) -> f64| {
        drift.rows.iter().map(|row| [row.iteration as f64, of(row)]).collect::<Vec<_>>()
    };
    let curves = at_critical.enumerate().flat_map(|(color, drift)| {
        let bound = (color == 0).then(|| Curve {
            name: format!("{}, bound", drift.scheme),
            points: points(drift, |row| row.bound),
            color,
            dash: Dash::Dashed,
        });
        let name = drift.scheme.to_owned();
        [Curve { name, points: points(drift, |row| row.source), color, dash: Dash::Solid }].into_iter().chain(bound)
    });
    let plot = Plot {
        title: format!("Energy of the source, {}³, at the critical factor", args.side),
        x_label: "iteration k".to_owned(),
        y_label: "relative difference".to_owned(),
        log_y: true,
        curves: curves.collect(),
        ..Plot::default()
    };
    Figure {
        title: "Single precision against double".to_owned(),
        plots: vec![plot],
        theme: Theme::LIGHT,
        size: [960, 560],
    }
}
