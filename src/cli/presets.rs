//! `presets`: what the program brings along.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::console::say;
use crate::scene::builtin;
use crate::system::file::write_whole;
use crate::transport::preset;

/// Where to write them, if anywhere.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  lpv-lab presets\n  lpv-lab presets --out my-presets")]
pub struct PresetsArgs {
    /// Write all presets, with their cell files, to this folder; files that are there are kept
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Does the command.
pub fn run(args: &PresetsArgs) -> Result<(), CliError> {
    let Some(folder) = &args.out else {
        let width = builtin::PRESETS.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        for (name, text) in builtin::PRESETS {
            let preset = preset::parse(text, Path::new(name))?;
            say!("{name:width$}  {:>3}³  {}", preset.size, preset.title);
        }
        return Ok(());
    };
    for (path, text) in builtin::files() {
        let path = folder.join(path);
        if path.exists() {
            say!("{}: kept", path.display());
            continue;
        }
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent).map_err(|e| CliError::cannot_write(parent, e))?;
        // Whole or not at all: a part of a file would be kept the next time.
        write_whole(&path, text.as_bytes()).map_err(|e| CliError::Failed(e.to_string()))?;
        say!("{}", path.display());
    }
    Ok(())
}
