//! `shader`: the kernels that a preset needs, in the language of an engine, with a page that tells how they are called.

use std::path::PathBuf;

use clap::Args;

use super::console::say;
use super::output::Folder;
use super::{CliError, SceneArgs};
use crate::field::Levels;
use crate::transport::gpu::card::constants_of;
use crate::transport::gpu::export::{Language, translate};
use crate::transport::gpu::porting::{needed, page};

/// Which kernels, in which language, and where to.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  lpv-lab shader presets/mixed.ron --language glsl --out kernels\n\n\
                        Written to the folder: a file for each kernel (inject, downsample, propagate, solids, merge, as far as the\n\
                        preset needs them) and kernels.md: bindings, formats, dispatch sizes, constants, what to check first.")]
pub struct ShaderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The language to write them in
    #[arg(long, value_enum, default_value_t = Language::Wgsl)]
    language: Language,
    /// The folder for the kernels [default: lpv-lab-results/PRESET]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Does the command.
pub fn run(args: &ShaderArgs) -> Result<(), CliError> {
    let (preset, problem) = args.scene.load()?;
    let sizes = Levels::new(problem.size, problem.coarsest)
        .ok_or_else(|| CliError::Input("these sizes make no octree".to_owned()))?;
    let constants = constants_of(&problem, sizes)?;
    let folder = Folder::of_preset(args.out.as_deref(), &args.scene.preset)?;
    let extension = args.language.extension();
    let mut names = Vec::new();
    for kernel in needed(&constants) {
        let file = translate(kernel, &constants, args.language).map_err(|e| CliError::Failed(e.to_string()))?;
        let name = format!("{}.{extension}", kernel.name());
        folder.write(&name, file)?;
        names.push(name);
    }
    let title = if preset.title.is_empty() { "a preset" } else { &preset.title };
    let propagation = &problem.propagation;
    folder.write("kernels.md", page(title, &propagation.scheme, propagation.factor, &constants, extension))?;
    say!("{} and kernels.md in {}", names.join(", "), folder.path().display());
    folder.finish();
    Ok(())
}
