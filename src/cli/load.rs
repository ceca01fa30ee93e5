//! The preset argument that every command shares, and what the command line changes of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};

use super::CliError;
use super::console::remark;
use super::descent::DescentArgs;
use super::numbers::{decimal, whole};
use crate::scene::doubts::doubts;
use crate::scene::preset::LONGEST;
use crate::scene::propagation::descent::Inside;
use crate::scene::propagation::directions::Rule;
use crate::scene::propagation::{Index, Policy};
use crate::scene::{Preset, Problem, SceneError, builtin, file};
use crate::simulation::Simulation;
use crate::simulation::options::{Device, Options};
use crate::system::text::{nearest, one_line, shortened};
use crate::transport::preset;

/// The most characters of a title that are printed.
const LONGEST_TITLE: usize = 100;

/// A preset and what is to be different from what it says.
#[derive(Args, Debug, Clone, Default)]
pub struct SceneArgs {
    /// The preset: a file, or the name of a built-in one
    pub preset: PathBuf,
    /// Propagation iterations, k
    #[arg(long, value_name = "K", value_parser = whole, allow_negative_numbers = true)]
    pub iterations: Option<usize>,
    /// The propagation scheme: one that `lpv-lab schemes` lists, or `ordinates`
    #[arg(long, value_name = "NAME")]
    pub scheme: Option<String>,
    /// The propagation factor, p
    #[arg(long, value_name = "P", value_parser = decimal, allow_negative_numbers = true)]
    pub factor: Option<f64>,
    /// How the operator follows from the octree level: same, one factor for all; consistent or exact, levels that agree
    #[arg(long, value_name = "POLICY", value_parser = policy)]
    pub levels: Option<Policy>,
    /// Which level is sampled where: thesis, the finest that is lit; radial, the coarser, the farther injected light is
    #[arg(long, value_name = "INDEX")]
    pub index: Option<IndexArg>,
    /// How far from injected light a radial index samples the finest level alone, in cells
    #[arg(long, value_name = "R", value_parser = decimal, allow_negative_numbers = true)]
    pub reach: Option<f64>,
    /// What a descent goes over.
    #[command(flatten)]
    pub descent: DescentArgs,
    /// How a descent shows the light of coarse cells in the finest ones
    #[arg(long, value_name = "SHAPE")]
    pub inside: Option<InsideArg>,
    /// About how many directions the propagator `ordinates` has
    #[arg(long, value_name = "N", value_parser = whole, allow_negative_numbers = true)]
    pub directions: Option<usize>,
    /// How ordinates share light among a cell's far faces: donor, all alike; faces, by the face it came in by
    #[arg(long, value_name = "RULE", value_parser = rule)]
    pub rule: Option<Rule>,
    /// The side of the coarsest octree level
    #[arg(long, value_name = "SIDE", value_parser = whole, allow_negative_numbers = true)]
    pub coarsest: Option<usize>,
    /// Let faces carry negative flux
    #[arg(long)]
    pub no_clamp: bool,
    /// What iterates: the processor, or a graphics card where the program was built with the feature `gpu`; the light
    /// is the same to the last bit
    #[arg(long, value_enum, value_name = "DEVICE", default_value_t)]
    pub device: DeviceArg,
}

/// What iterates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DeviceArg {
    /// The processor
    #[default]
    Cpu,
    /// A graphics card; where it cannot, the processor, and a line says why
    Gpu,
}

impl DeviceArg {
    /// A dark simulation on the device that was asked for, or on the processor where that cannot do it.
    pub fn simulate(self, problem: impl Into<Arc<Problem>>, options: Options) -> Result<Simulation<f32>, CliError> {
        let (simulation, why) = Simulation::with_fallback(problem, Options { device: self.into(), ..options })?;
        told(why);
        Ok(simulation)
    }
}

impl From<DeviceArg> for Device {
    fn from(device: DeviceArg) -> Self {
        match device {
            DeviceArg::Cpu => Device::Cpu,
            DeviceArg::Gpu => Device::Gpu,
        }
    }
}

/// Says why the processor computes, if it was not asked to.
pub fn told(why: Option<String>) {
    if let Some(why) = why {
        remark!("note: the processor computes: {why}");
    }
}

/// Which level is sampled where.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum IndexArg {
    /// The finest level that has received light
    Thesis,
    /// The coarser, the farther injected light is; neighbouring levels are blended
    Radial,
}

/// What coarse cells show inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum InsideArg {
    /// Light that decays as the neighbours say
    Exponential,
    /// The same light everywhere
    Constant,
}

impl SceneArgs {
    /// The preset as changed by the other arguments, and the scene it makes.
    pub fn load(&self) -> Result<(Preset, Problem), CliError> {
        let Opened { mut preset, text, folder, .. } = open(&self.preset)?;
        let propagation = &mut preset.propagation;
        if let Some(iterations) = self.iterations {
            propagation.iterations = iterations;
        }
        if let Some(scheme) = &self.scheme {
            propagation.scheme.clone_from(scheme);
        }
        if let Some(factor) = self.factor {
            propagation.factor = factor;
        }
        if let Some(levels) = self.levels {
            propagation.levels = levels;
        }
        propagation.index = self.index(propagation.index)?;
        propagation.descent = self.descent.of(propagation.descent)?;
        if let Some(inside) = self.inside {
            propagation.inside = match inside {
                InsideArg::Exponential => Inside::Exponential,
                InsideArg::Constant => Inside::Constant,
            };
        }
        if let Some(directions) = self.directions {
            propagation.ordinates.directions = directions;
        }
        if let Some(rule) = self.rule {
            propagation.ordinates.rule = rule;
        }
        if self.no_clamp {
            propagation.clamp = false;
        }
        if let Some(coarsest) = self.coarsest {
            preset.coarsest = coarsest;
        }
        // What the file says was right when it was opened, so a fault here is the command line's.
        preset::check(&preset).map_err(|fault| CliError::Input(format!("the command line: {fault}")))?;
        let problem = Problem::build(&preset, &folder).map_err(|error| error.at_its_place(&text, &self.preset))?;
        for doubt in doubts(&preset, &problem) {
            remark!("warning: {}", SceneError::from(doubt).at_its_place(&text, &self.preset));
        }
        Ok((preset, problem))
    }

    /// The index asked for, where the preset's own is `preset`.
    fn index(&self, preset: Index) -> Result<Index, CliError> {
        let own = if let Index::Radial { reach } = preset { reach } else { Index::REACH };
        let reach = self.reach.unwrap_or(own);
        let index = match (self.index, preset) {
            (Some(IndexArg::Radial), _) | (None, Index::Radial { .. }) => Index::Radial { reach },
            (Some(IndexArg::Thesis), _) | (None, Index::Thesis) => Index::Thesis,
        };
        if self.reach.is_some() && index == Index::Thesis {
            return Err(CliError::Input("--reach is for a radial index: write --index radial, too".to_owned()));
        }
        Ok(index)
    }

    /// What people see of the preset in a line: its title, or its file's name.
    pub fn title(&self, preset: &Preset) -> String {
        let title = if preset.title.is_empty() { self.stem() } else { preset.title.clone() };
        shortened(&one_line(&title), LONGEST_TITLE)
    }

    /// A name for what the preset makes: its file name without the ending, fit to be shown.
    pub fn stem(&self) -> String {
        one_line(&self.preset.file_stem().unwrap_or_default().to_string_lossy())
    }
}

fn policy(name: &str) -> Result<Policy, String> {
    let known = Policy::ALL.into_iter().find(|policy| policy.name() == name);
    known.ok_or_else(|| format!("levels are {}", Policy::ALL.map(Policy::name).join(" or ")))
}

fn rule(name: &str) -> Result<Rule, String> {
    let known = Rule::ALL.into_iter().find(|rule| rule.name() == name);
    known.ok_or_else(|| format!("a rule is {}", Rule::ALL.map(Rule::name).join(" or ")))
}

/// A preset that has been read.
pub struct Opened {
    /// The document.
    pub preset: Preset,
    /// The text it was read from.
    pub text: String,
    /// The file it was read from, unless it is built in.
    pub file: Option<PathBuf>,
    /// The folder that its paths are relative to.
    pub folder: PathBuf,
}

/// Reads a preset from a file, or a built-in one by its name. A folder of that name does not hide it.
///
/// # Errors
/// Where there is neither, or the text is no preset.
pub fn open(path: &Path) -> Result<Opened, CliError> {
    let there = path.exists();
    let built_in = path.to_str().and_then(builtin::find);
    if let Some(text) = built_in.filter(|_| !there || path.is_dir()) {
        let preset = preset::parse(text, path)?;
        let folder =
            builtin::folder_of(text).map_err(|e| CliError::Failed(format!("the built-in preset's files: {e}")))?;
        return Ok(Opened { preset, text: text.to_owned(), file: None, folder });
    }
    if let Some(meant) = path.to_str().filter(|_| !there).and_then(mistyped) {
        return Err(CliError::Input(meant));
    }
    let text = file::read_text(path, LONGEST)?;
    let preset = preset::parse(&text, path)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    Ok(Opened { preset, text, file: Some(path.to_path_buf()), folder })
}

/// What is wrong with a name that is nearly a built-in preset's.
fn mistyped(name: &str) -> Option<String> {
    let known: Vec<&str> = builtin::PRESETS.iter().map(|(name, _)| *name).collect();
    let meant = nearest(name, &known)?;
    Some(format!("{}: no such file, and no built-in preset; did you mean `{meant}`?", shortened(name, 60)))
}
