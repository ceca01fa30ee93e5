//! The program: a headless command, or the window on a preset.
#![forbid(unsafe_code)]

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lpv_lab::cli::{self, Cli, CliError, RunArgs};

/// The built-in preset that is opened when none is named.
const DEFAULT_PRESET: &str = "two-walls";

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            eprintln!("lpv-lab: {}", cli::in_one_line(&error));
            return ExitCode::from(cli::WRONG_INPUT);
        }
        // Help and the version are no errors, though they come as such.
        Err(help) => help.exit(),
    };
    let done = match cli.command {
        Some(cli::Command::Bench(args)) => bench(args),
        Some(command) => cli::execute(command),
        None => open(cli.preset.unwrap_or_else(|| PathBuf::from(DEFAULT_PRESET))),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lpv-lab: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// Measures, the window too where there is one: headless commands know nothing of it.
fn bench(args: cli::BenchArgs) -> Result<(), CliError> {
    let all = args.measures_all();
    cli::execute(cli::Command::Bench(args))?;
    if all {
        frames();
    }
    Ok(())
}

/// Tells what a frame of the window costs to build, which needs no display.
#[cfg(feature = "app")]
fn frames() {
    const SIDE: usize = 64;
    let Some(cost) = lpv_lab::app::frame_cost::measure(SIDE) else { return };
    println!(
        "One frame of the window, three views of {SIDE}×{SIDE} cells with {} glyphs: {:.2} ms where everything changed, \
         {:.2} ms where nothing did",
        cost.glyphs,
        1e3 * cost.changed,
        1e3 * cost.unchanged
    );
}

#[cfg(not(feature = "app"))]
fn frames() {}

/// Opens the window on a preset; where there is no display, runs the preset headless and says so.
fn open(preset: PathBuf) -> Result<(), CliError> {
    let why_not = match window(&preset)? {
        None => return Ok(()),
        Some(why_not) => why_not,
    };
    let args = RunArgs::of(preset);
    eprintln!("{why_not}: running {} headless, results in {}", args.preset().display(), args.out().display());
    cli::execute(cli::Command::Run(args))
}

/// Shows the window until it is closed; the reason if there can be none.
#[cfg(feature = "app")]
fn window(path: &Path) -> Result<Option<String>, CliError> {
    let preset = cli::open(path)?.preset;
    if cfg!(target_os = "linux") && ["DISPLAY", "WAYLAND_DISPLAY"].iter().all(|v| std::env::var_os(v).is_none()) {
        return Ok(Some("no display".to_owned()));
    }
    let file = path.exists().then(|| path.to_path_buf());
    Ok(lpv_lab::app::run(preset, file).err().map(|error| format!("no window ({error})")))
}

#[cfg(not(feature = "app"))]
fn window(_: &Path) -> Result<Option<String>, CliError> {
    Ok(Some("built without the window".to_owned()))
}
