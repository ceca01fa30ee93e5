//! The headless commands, each a few lines over `study` and `report`.

mod bench;
#[cfg(feature = "gpu")]
mod card;
mod cells;
mod compare;
pub mod console;
mod course;
mod descent;
mod identify;
mod load;
mod mesh_scene;
mod motion;
mod numbers;
mod octree;
pub(crate) mod output;
mod pareto;
mod pattern;
mod presets;
mod race;
mod render;
mod run;
mod scene;
mod schemes;
#[cfg(feature = "gpu")]
mod shader;
mod stability;

use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};

use crate::scene::builtin;
use crate::system::text::nearest;
use crate::system::{file, interrupt};
use crate::transport::team;

pub use bench::BenchArgs;
pub use load::{Opened, SceneArgs, open};
pub use run::RunArgs;

/// The exit code of a run that failed.
pub const FAILED: u8 = 1;
/// The exit code of arguments or files that are wrong.
pub const WRONG_INPUT: u8 = 2;

/// An interactive laboratory for light propagation volumes in an octree.
#[derive(Parser, Debug)]
#[command(
    name = "lpv-lab",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Examples:\n  lpv-lab                                open the window on the default preset\n  \
                  lpv-lab presets/mixed.ron              open the window on a preset\n  \
                  lpv-lab run presets/mixed.ron          the same headless: errors, plots and pictures\n\n\
                  Exit codes: 0 done, 1 the run failed, 2 the arguments or a file are wrong, 130 ended by Ctrl-C."
)]
pub struct Cli {
    /// A preset to open in the window: a file, or the name of a built-in one
    pub preset: Option<PathBuf>,
    #[command(subcommand)]
    /// What to do headless, if anything.
    pub command: Option<Command>,
}

/// A headless command.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Run a preset and write its error curves and pictures
    Run(RunArgs),
    /// Print the light of every cell that is not dark, as CSV or .npy
    Cells(cells::CellsArgs),
    /// Run presets under several schemes and compare what each makes of them
    Compare(compare::CompareArgs),
    /// What a camera sees of a preset's light, and what it should see
    Render(render::RenderArgs),
    /// Measure how fast the loops are
    Bench(BenchArgs),
    /// Measure what an octree can do: error against all the light there will ever be, and the cells it takes
    Octree(octree::OctreeArgs),
    /// Run moving light frame by frame: flicker, light at pinned cells, pictures and an animation
    Motion(motion::MotionArgs),
    /// List the propagation schemes with their gains and critical factors
    Schemes(schemes::SchemesArgs),
    /// What a mesh and its lights become in a volume: triangles, light given and injected, occupied cells
    Scene(scene::SceneCommandArgs),
    /// List the built-in presets, or write them to a folder
    Presets(presets::PresetsArgs),
    /// Gains and critical factors of every scheme and size; single precision against double in long runs
    Stability(stability::StabilityArgs),
    /// Write a test pattern to inject into a port of light propagation volumes
    Pattern(pattern::PatternArgs),
    /// Tell from dumps of its grid whether a port of light propagation volumes is right
    Identify(identify::IdentifyArgs),
    /// Write the kernels that a preset needs, in the language of an engine
    #[cfg(feature = "gpu")]
    Shader(shader::ShaderArgs),
    /// Print completions for a shell
    #[command(after_help = "Example:\n  lpv-lab completions bash > ~/.local/share/bash-completion/completions/lpv-lab")]
    Completions {
        /// The shell to complete in
        shell: clap_complete::Shell,
    },
}

/// Why a command ended without doing its work.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The arguments or a file are wrong: exit code 2.
    #[error("{0}")]
    Input(String),
    /// The run failed: exit code 1.
    #[error("{0}")]
    Failed(String),
    /// Ctrl-C ended it before its time; what was computed is written: exit code 130.
    #[error("{0}")]
    Interrupted(String),
}

impl CliError {
    /// A file that could not be written.
    pub fn cannot_write(path: &std::path::Path, why: impl std::fmt::Display) -> Self {
        CliError::Failed(format!("{}: cannot write: {why}", path.display()))
    }

    /// The exit code that goes with it.
    pub fn exit_code(&self) -> u8 {
        match self {
            CliError::Input(_) => WRONG_INPUT,
            CliError::Failed(_) => FAILED,
            CliError::Interrupted(_) => interrupt::EXIT_CODE,
        }
    }
}

/// A file that cannot be read is a wrong argument; whoever writes makes it a failure.
impl From<file::FileError> for CliError {
    fn from(error: file::FileError) -> Self {
        CliError::Input(error.to_string())
    }
}

impl From<crate::scene::SceneError> for CliError {
    fn from(error: crate::scene::SceneError) -> Self {
        CliError::Input(error.to_string())
    }
}

impl From<crate::simulation::Divergence> for CliError {
    fn from(divergence: crate::simulation::Divergence) -> Self {
        CliError::Failed(format!("{divergence}; use a smaller factor, as `lpv-lab stability PRESET` lists them"))
    }
}

impl From<crate::simulation::Refusal> for CliError {
    fn from(error: crate::simulation::Refusal) -> Self {
        CliError::Input(error.to_string())
    }
}

/// What clap says of wrong arguments, in one line: its first paragraph, and what was probably meant. `first` is the
/// command line's first word.
pub fn in_one_line(error: &clap::Error, first: Option<&str>) -> String {
    if let Some(meant) = first.and_then(mistyped) {
        return meant;
    }
    let text = error.to_string();
    let paragraph: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    let said = paragraph.join(" ");
    let said = said.strip_prefix("error: ").unwrap_or(&said);
    let suggested = [ContextKind::SuggestedArg, ContextKind::SuggestedValue, ContextKind::SuggestedSubcommand];
    let meant = suggested.into_iter().find_map(|kind| match error.get(kind)? {
        ContextValue::String(name) => Some(name.as_str()),
        ContextValue::Strings(names) => names.first().map(String::as_str),
        _ => None,
    });
    match meant {
        Some(meant) => format!("{said}; did you mean `{meant}`? See `lpv-lab --help`"),
        None => format!("{said}; see `lpv-lab --help`"),
    }
}

/// Whether a built-in preset has this name.
pub fn is_built_in(name: &str) -> bool {
    builtin::find(name).is_some()
}

/// What is wrong with the command line's first word, if it is nearly the name of a command and names nothing else.
pub fn mistyped(first: &str) -> Option<String> {
    let program = Cli::command();
    let commands: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).chain(["help"]).collect();
    if first.starts_with('-') || commands.contains(&first) || std::path::Path::new(first).exists() {
        return None;
    }
    let presets = builtin::PRESETS.iter().map(|(name, _)| *name);
    let meant = nearest(first, &commands.iter().copied().chain(presets).collect::<Vec<_>>())?;
    let is_command = commands.contains(&meant);
    is_command.then(|| {
        format!("there is no command `{}`; did you mean `{meant}`?", crate::system::text::shortened(first, 60))
    })
}

/// Does a headless command.
pub fn execute(command: Command) -> Result<(), CliError> {
    match command {
        Command::Run(args) => team::inside(|| run::run(&args)),
        Command::Cells(args) => team::inside(|| cells::run(&args)),
        Command::Compare(args) => team::inside(|| compare::run(&args)),
        Command::Render(args) => team::inside(|| render::run(&args)),
        Command::Bench(args) => bench::run(&args),
        Command::Octree(args) => team::inside(|| octree::run(&args)),
        Command::Motion(args) => team::inside(|| motion::run(&args)),
        Command::Schemes(args) => schemes::run(&args),
        Command::Scene(args) => team::inside(|| scene::run(&args)),
        Command::Presets(args) => presets::run(&args),
        Command::Stability(args) => team::inside(|| stability::run(&args)),
        Command::Pattern(args) => pattern::run(&args),
        Command::Identify(args) => team::inside(|| identify::run(&args)),
        #[cfg(feature = "gpu")]
        Command::Shader(args) => shader::run(&args),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "lpv-lab", &mut script);
            console::stream(|out| out.write_all(&script));
            Ok(())
        }
    }
}
