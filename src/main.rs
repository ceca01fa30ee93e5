//! The program: a headless command, or the window on a preset.
#![forbid(unsafe_code)]

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lpv_lab::cli::{self, Cli, CliError, Opened, RunArgs, console};
use lpv_lab::system::memory;
use lpv_lab::transport::team;

/// The built-in preset that is opened when none is named: a single lobe in few cells, so that each is seen.
const DEFAULT_PRESET: &str = "level-jump";

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    // What was said and could not be written is told last: by then every file is.
    let done = obey().and_then(|()| console::finish());
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            console::note(format_args!("{error}"));
            ExitCode::from(error.exit_code())
        }
    }
}

/// Does what the command line says.
fn obey() -> Result<(), CliError> {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            let first = std::env::args_os().nth(1);
            return Err(CliError::Input(cli::in_one_line(&error, first.as_deref().and_then(OsStr::to_str))));
        }
        // Help and the version are no errors, though they come as such.
        Err(help) => {
            console::stream(|_| help.print());
            return Ok(());
        }
    };
    memory::check().map_err(CliError::Failed)?;
    let (got, wanted) = team::gather();
    if got < wanted {
        console::note(format_args!("{got} of {wanted} threads can be started (ulimit -u or -v), so it takes longer"));
    }
    match cli.command {
        Some(cli::Command::Bench(args)) => bench(args),
        Some(command) => cli::execute(command),
        None => open(cli.preset.unwrap_or_else(|| PathBuf::from(DEFAULT_PRESET))),
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
    console::line(format_args!(
        "One frame of the window, three views of {SIDE}×{SIDE} cells with {} glyphs: {:.2} ms where everything changed, \
         {:.2} ms where nothing did",
        cost.glyphs,
        1e3 * cost.changed,
        1e3 * cost.unchanged
    ));
}

#[cfg(not(feature = "app"))]
fn frames() {}

/// Opens the window on a preset; where there is no display, runs the preset headless and says so.
fn open(preset: PathBuf) -> Result<(), CliError> {
    if let Some(meant) = preset.to_str().filter(|name| !cli::is_built_in(name)).and_then(cli::mistyped) {
        return Err(CliError::Input(meant));
    }
    let why_not = match window(cli::open(&preset)?) {
        None => return Ok(()),
        Some(why_not) => why_not,
    };
    let args = RunArgs::of(preset);
    let (preset, out) = (args.preset().display(), args.out());
    console::note(format_args!("{why_not}: running {preset} headless, results in {}", out.display()));
    cli::execute(cli::Command::Run(args))
}

/// Shows the window until it is closed; the reason if there can be none.
#[cfg(feature = "app")]
fn window(Opened { preset, file, .. }: Opened) -> Option<String> {
    if cfg!(target_os = "linux") && ["DISPLAY", "WAYLAND_DISPLAY"].iter().all(|v| std::env::var_os(v).is_none()) {
        return Some("no display".to_owned());
    }
    let error = lpv_lab::app::run(preset, file).err()?;
    // What drivers say is for those who write them.
    log::warn!("{error}");
    Some("no window can be opened on this display (RUST_LOG=warn tells more)".to_owned())
}

#[cfg(not(feature = "app"))]
fn window(_: Opened) -> Option<String> {
    Some("built without the window".to_owned())
}
