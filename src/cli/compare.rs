//! `compare`: several schemes on one or many presets, as a table and a CSV; or one preset against another.

mod difference;

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::console::{self, say};
use super::descent::DescentArgs;
use super::load::{DeviceArg, told};
use super::numbers::{decimal, whole};
use super::output::Folder;
use super::{CliError, SceneArgs, course};
use crate::report::number::plain;
use crate::report::table::{Table, Value};
use crate::scene::Problem;
use crate::study::artefacts::{Artefacts, Shares};
use crate::study::compare::{self, Finding, PATIENCE};
use crate::study::expectation::Expectation;
use crate::transport;
use crate::transport::lattice::schemes;

/// What to compare.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  lpv-lab compare presets/two-walls.ron presets/pillar.ron --out results\n  \
                        lpv-lab compare one-lobe --schemes cascaded,axial --factor 4\n\n\
                        Errors compare the merged light with the reference: uniform is the same scheme on the finest level alone\n\
                        (what the octree costs), ballistic what truly arrives along straight lines (what the scheme costs), surface and\n\
                        picture what truly reaches a mesh's surfaces and its camera after one bounce, path traced (what is seen);\n\
                        l1 fitted is after the scalar that fits best. Energy left is the newest snapshot over the injected light, shift\n\
                        and reach are in cells, leak is the light behind occluders over that there without them (1: they hold nothing\n\
                        back), bleeding the light behind its own source over that before it, jump the mean |ln| by which neighbours on\n\
                        different levels differ too much, converged the iteration from which on a snapshot adds less than 1 %.\n\
                        The CSV has every digit and the columns that the table has no room for.\n\n\
                        With --difference the second of two presets is held against the first: errors of the merged light and of\n\
                        each level, how far the centroid of the light moved, and pictures of both and their difference.")]
pub struct CompareArgs {
    /// The presets: files, or names of built-in ones
    #[arg(required = true, value_name = "PRESET")]
    presets: Vec<PathBuf>,
    /// The transports, separated by commas [default: all schemes that `lpv-lab schemes` lists]
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
    /// What a descent goes over.
    #[command(flatten)]
    descent: DescentArgs,
    /// Hold the second of two presets of one size against the first, each under its own scheme if none is given
    #[arg(long)]
    difference: bool,
    /// What iterates: the processor, or a graphics card where the program was built with the feature `gpu`
    #[arg(long, value_enum, value_name = "DEVICE", default_value_t)]
    device: DeviceArg,
    /// The folder to write compare.csv to, or with --difference difference.csv and pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What merged light can be held against, by the name of what is expected.
fn reference() -> impl TypedValueParser<Value = Expectation> {
    let known = |name: &str| Expectation::of_merged_light().find(|one| one.reference() == name);
    PossibleValuesParser::new(Expectation::of_merged_light().map(Expectation::reference))
        .map(move |name| known(&name).unwrap_or(Expectation::Merged))
}

impl CompareArgs {
    /// One of the presets, with what is to be different in all of them.
    fn scene(&self, preset: &Path) -> SceneArgs {
        SceneArgs {
            preset: preset.to_path_buf(),
            iterations: self.iterations,
            factor: self.factor,
            descent: self.descent.clone(),
            ..SceneArgs::default()
        }
    }
}

fn check_schemes(names: &[&str]) -> Result<(), CliError> {
    for name in names {
        transport::known(name)?;
    }
    Ok(())
}

/// Does the command.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    if args.difference {
        return difference::run(args);
    }
    let names: Vec<&str> = match args.schemes.is_empty() {
        true => schemes::names(),
        false => args.schemes.iter().map(String::as_str).collect(),
    };
    check_schemes(&names)?;
    let expectation = args.reference;
    let folder = args.out.clone().map(Folder::create).transpose()?;
    let mut csv = Table::new(CSV_COLUMNS);
    for (i, preset) in args.presets.iter().enumerate() {
        let scene_args = args.scene(preset);
        let (document, problem) = scene_args.load()?;
        let gap = if i == 0 { "" } else { "\n" };
        say!(
            "{gap}{}\n{}³, p = {}, k = {}, against {}",
            scene_args.title(&document),
            problem.size,
            problem.propagation.factor,
            problem.propagation.iterations,
            expectation.reference()
        );
        let references = course::references(&problem, &[expectation])?;
        let mut table = Table::new(TEXT_COLUMNS);
        let mut noise = None;
        for name in &names {
            let Some(finding) = compare::run(&problem, name, expectation, &references, args.device.into())? else {
                continue;
            };
            told(finding.not_there.clone());
            noise = finding.error.traced.map(|traced| traced.noise).or(noise);
            table.push(text_row(&finding));
            csv.push(csv_row(&scene_args.stem(), &problem, expectation, &finding));
        }
        console::print(format_args!("{}", table.to_text()));
        if let Some(noise) = noise {
            say!("the truth's own error is {} of that ratio", plain(noise, 3));
        }
    }
    if let Some(folder) = folder {
        folder.write_table("compare.csv", &csv)?;
        folder.finish();
    }
    Ok(())
}

/// What a terminal shows of a finding, the columns that matter most first.
const TEXT_COLUMNS: [&str; 14] = [
    "scheme",
    "l1 ratio",
    "l1 fitted",
    "energy left",
    "shift",
    "leak",
    "bleeding",
    "jump",
    "reach",
    "axis/diag",
    "converged",
    "abs mean",
    "rel mean",
    "ms/iteration",
];

fn text_row(finding: &Finding) -> [Value; 14] {
    let converged = finding.converged.map_or_else(|| format!(">{PATIENCE}"), |k| k.to_string());
    let Artefacts { leak, back_bleeding, jump, .. } = &finding.artefacts;
    let number = |value: Option<f64>| value.map_or("-".into(), Value::Number);
    [
        finding.scheme.as_str().into(),
        finding.error.l1_ratio.into(),
        finding.l1_fitted.into(),
        finding.energy_left.into(),
        finding.shift.into(),
        number(leak.as_ref().and_then(Shares::finest)),
        number(back_bleeding.as_ref().and_then(|shares| shares.merged)),
        number(jump.map(|jump| jump.mean)),
        finding.reach.into(),
        finding.anisotropy.into(),
        Value::Text(converged),
        finding.error.absolute_mean.into(),
        finding.error.relative_mean.into(),
        milliseconds(finding).into(),
    ]
}

const CSV_COLUMNS: [&str; 32] = [
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
    "leak_merged",
    "back_bleeding",
    "back_bleeding_merged",
    "jump",
    "negative_cells",
    "mean_ratio",
    "correlation",
    "flip",
    "truth_noise",
];

fn csv_row(preset: &str, problem: &Problem, expectation: Expectation, finding: &Finding) -> [Value; 32] {
    let [x, y, z] = finding.centroid;
    let error = finding.error;
    let empty = || Value::Text(String::new());
    let number = |value: Option<f64>| value.map_or_else(empty, Value::Number);
    let Artefacts { leak, back_bleeding, jump, negative } = &finding.artefacts;
    let finest = |shares: &Option<Shares>| number(shares.as_ref().and_then(Shares::finest));
    let merged = |shares: &Option<Shares>| number(shares.as_ref().and_then(|shares| shares.merged));
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
        finest(leak),
        finding.converged.map_or_else(empty, Value::Count),
        error.undefined.into(),
        milliseconds(finding).into(),
        merged(leak),
        finest(back_bleeding),
        merged(back_bleeding),
        number(jump.map(|jump| jump.mean)),
        (*negative).into(),
        number(error.traced.map(|traced| traced.mean_ratio)),
        number(error.traced.and_then(|traced| traced.correlation)),
        number(error.traced.and_then(|traced| traced.picture).map(|[_, _, flip]| flip)),
        number(error.traced.map(|traced| traced.noise)),
    ]
}

fn milliseconds(finding: &Finding) -> f64 {
    finding.iteration_time.as_secs_f64() * 1e3
}
