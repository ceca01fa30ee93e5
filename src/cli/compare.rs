//! `compare`: several schemes on one or many presets, as a table and a CSV.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::console::{self, say};
use super::numbers::{decimal, whole};
use super::output::Folder;
use super::{CliError, SceneArgs, course};
use crate::report::table::{Table, Value};
use crate::scene::Problem;
use crate::study::compare::{self, Finding, PATIENCE};
use crate::study::expectation::Expectation;
use crate::transport;
use crate::transport::lattice::schemes;

/// What to compare.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  lpv-lab compare presets/two-walls.ron presets/pillar.ron --out results\n  \
                        lpv-lab compare one-lobe --schemes cascaded,axial --factor 4\n\n\
                        Errors compare the merged light with the reference: uniform is the same scheme on the finest level alone\n\
                        (what the octree costs), ballistic what truly arrives along straight lines (what the scheme costs);\n\
                        l1 fitted is after the scalar that fits best. Shift and reach are in cells, leak is the mean light behind\n\
                        closed occluders over that before them, converged the iteration from which on a snapshot adds less than\n\
                        1 %. The CSV has every digit and the columns that the table leaves out.")]
pub struct CompareArgs {
    /// The presets: files, or names of built-in ones
    #[arg(required = true, value_name = "PRESET")]
    presets: Vec<PathBuf>,
    /// The schemes, separated by commas; `ordinates` may be one [default: all that `lpv-lab schemes` lists]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    schemes: Vec<String>,
    /// What errors are measured against
    #[arg(long, default_value = Expectation::Merged.reference(), value_parser = reference())]
    reference: Expectation,
    /// Propagation iterations, k
    #[arg(long, value_name = "K", value_parser = whole, allow_negative_numbers = true)]
    iterations: Option<usize>,
    /// The propagation factor, p
    #[arg(long, value_name = "P", value_parser = decimal, allow_negative_numbers = true)]
    factor: Option<f64>,
    /// The folder to write compare.csv to
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What merged light can be held against, by the name of what is expected.
fn reference() -> impl TypedValueParser<Value = Expectation> {
    let known = |name: &str| Expectation::of_merged_light().find(|one| one.reference() == name);
    PossibleValuesParser::new(Expectation::of_merged_light().map(Expectation::reference))
        .map(move |name| known(&name).unwrap_or(Expectation::Merged))
}

/// Does the command.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    let names: Vec<&str> = match args.schemes.is_empty() {
        true => schemes::names(),
        false => args.schemes.iter().map(String::as_str).collect(),
    };
    for name in &names {
        transport::known(name)?;
    }
    let expectation = args.reference;
    let folder = args.out.clone().map(Folder::create).transpose()?;
    let mut csv = Table::new(CSV_COLUMNS);
    for (i, preset) in args.presets.iter().enumerate() {
        let scene_args = SceneArgs {
            preset: preset.clone(),
            iterations: args.iterations,
            factor: args.factor,
            ..SceneArgs::default()
        };
        let (document, problem) = scene_args.load()?;
        let gap = if i == 0 { "" } else { "\n" };
        say!(
            "{gap}{}: {}³, p = {}, k = {}, against {}",
            scene_args.title(&document),
            problem.size,
            problem.propagation.factor,
            problem.propagation.iterations,
            expectation.reference()
        );
        let references = course::references(&problem, &[expectation])?;
        let mut table = Table::new(TEXT_COLUMNS);
        for name in &names {
            let Some(finding) = compare::run(&problem, name, expectation, &references)? else { continue };
            table.push(text_row(&finding));
            csv.push(csv_row(&scene_args.stem(), &problem, expectation, &finding));
        }
        console::print(format_args!("{}", table.to_text()));
    }
    if let Some(folder) = folder {
        folder.write_table("compare.csv", &csv)?;
        folder.finish();
    }
    Ok(())
}

const TEXT_COLUMNS: [&str; 12] = [
    "scheme",
    "abs mean",
    "rel mean",
    "l1 ratio",
    "l1 fitted",
    "energy left",
    "shift",
    "reach",
    "axis/diag",
    "leak",
    "converged",
    "ms/iteration",
];

fn text_row(finding: &Finding) -> [Value; 12] {
    let converged = finding.converged.map_or_else(|| format!(">{PATIENCE}"), |k| k.to_string());
    [
        finding.scheme.as_str().into(),
        finding.error.absolute_mean.into(),
        finding.error.relative_mean.into(),
        finding.error.l1_ratio.into(),
        finding.l1_fitted.into(),
        finding.energy_left.into(),
        finding.shift.into(),
        finding.reach.into(),
        finding.anisotropy.into(),
        finding.leak.map_or("-".into(), Value::Number),
        Value::Text(converged),
        milliseconds(finding).into(),
    ]
}

const CSV_COLUMNS: [&str; 23] = [
    "preset",
    "scheme",
    "size",
    "factor",
    "iterations",
    "reference",
    "absolute_mean",
    "absolute_max",
    "relative_mean",
    "relative_max",
    "l1_ratio",
    "l1_best_fit",
    "energy_left",
    "centroid_x",
    "centroid_y",
    "centroid_z",
    "shift",
    "reach",
    "anisotropy",
    "leak",
    "converged",
    "undefined",
    "ms_per_iteration",
];

fn csv_row(preset: &str, problem: &Problem, expectation: Expectation, finding: &Finding) -> [Value; 23] {
    let [x, y, z] = finding.centroid;
    let error = finding.error;
    let empty = || Value::Text(String::new());
    [
        preset.into(),
        finding.scheme.as_str().into(),
        problem.size.into(),
        problem.propagation.factor.into(),
        problem.propagation.iterations.into(),
        expectation.reference().into(),
        error.absolute_mean.into(),
        error.absolute_max.into(),
        error.relative_mean.into(),
        error.relative_max.into(),
        error.l1_ratio.into(),
        finding.l1_fitted.into(),
        finding.energy_left.into(),
        x.into(),
        y.into(),
        z.into(),
        finding.shift.into(),
        finding.reach.into(),
        finding.anisotropy.into(),
        finding.leak.map_or_else(empty, Value::Number),
        finding.converged.map_or_else(empty, Value::Count),
        error.undefined.into(),
        milliseconds(finding).into(),
    ]
}

fn milliseconds(finding: &Finding) -> f64 {
    finding.iteration_time.as_secs_f64() * 1e3
}
