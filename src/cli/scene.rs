//! `scene`: what a mesh and its lights become in a volume, before anything is propagated.

use std::path::PathBuf;

use clap::Args;

use super::console::{remark, say};
use super::output::Folder;
use super::{CliError, SceneArgs};
use crate::report::shadow_map::{Aspect, png};
use crate::scene::Stage;
use crate::scene::mesh_scene::LightKind;

/// Which scene, and where its shadow maps go.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  lpv-lab scene cornell --out cornell-maps\n\n\
                        Pictures of light I's shadow map: light-I-depth.png (near is white), light-I-normal.png and light-I-flux.png, \
                        the faces of a point light in the order +x -x +y above -y +z -z.")]
pub struct SceneCommandArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The folder for pictures of the shadow maps
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Does the command.
pub fn run(args: &SceneCommandArgs) -> Result<(), CliError> {
    let (preset, problem) = args.scene.load()?;
    let Some(stage) = &problem.stage else {
        let what = "the preset has no mesh; write scene: (mesh: \"scenes/room.obj\"), or take cornell";
        return Err(CliError::Input(format!("{}: {what}", args.scene.preset.display())));
    };
    let folder = args.out.as_ref().map(Folder::create).transpose()?;
    stage.model.notes.iter().for_each(|note| remark!("{note}"));
    tell_mesh(&preset.title, stage);
    let solids = problem.solids.len();
    let share = 100.0 * solids as f64 / (stage.placement.size as f64).powi(3);
    say!("occupied cells    {solids} of {}³, {share:.1} %", stage.placement.size);
    tell_lights(stage);
    if let Some(folder) = folder {
        for (i, map) in stage.maps.iter().enumerate() {
            for aspect in Aspect::ALL {
                let name = format!("light-{}-{}.png", i + 1, aspect.name());
                let bytes = png(map, aspect).map_err(|e| CliError::Failed(format!("{name}: {e}")))?;
                folder.write(&name, bytes)?;
            }
        }
        say!("shadow maps       {}", folder.path().display());
        folder.finish();
    }
    Ok(())
}

/// The mesh and its volume.
fn tell_mesh(title: &str, stage: &Stage) {
    let (mesh, placement) = (&stage.model.mesh, &stage.placement);
    let [low, high] = mesh.bounds();
    let size = high - low;
    say!("{title}");
    say!("triangles         {}", mesh.len());
    say!("area              {:.5} m², in cells {:.5} m²", mesh.total_area(), stage.voxels.areas.iter().sum::<f64>());
    say!("size              {:.4} × {:.4} × {:.4} m", size.x, size.y, size.z);
    let side = placement.cell_side * placement.size as f64;
    let glam::DVec3 { x, y, z } = placement.origin;
    say!("volume            {side:.4} m from ({x:.4}, {y:.4}, {z:.4}), a cell {:.5} m", placement.cell_side);
}

/// The lights and the energy account: what they give, what meets a surface, what is injected.
fn tell_lights(stage: &Stage) {
    let in_watts = |flux: [f64; 3]| flux.map(|f| format!("{f:>12.6}")).join(" ");
    for (i, (light, map)) in stage.lights.iter().zip(&stage.maps).enumerate() {
        let kind = match light.kind {
            LightKind::Point { .. } => "point",
            LightKind::Spot { .. } => "spot",
            LightKind::Sun { .. } => "sun",
        };
        let side = map.faces.first().map_or(0, |face| face.side);
        let texels = map.faces.len() * side * side;
        let lit = map.texels().count();
        let faces = if map.faces.len() == 1 { "one face".to_owned() } else { format!("{} faces", map.faces.len()) };
        say!("light {:<2} {kind:<8} {faces} of {side}² texels, {lit} of {texels} meet a surface", i + 1);
        say!("  gives         {} W", in_watts(map.given));
        say!("  meets         {} W", in_watts(map.met));
        say!("  sends back    {} W", in_watts(map.flux()));
    }
    if !stage.glowing.is_empty() {
        let flux = stage.glowing.iter().fold([0.0; 3], |sum, e| [0, 1, 2].map(|c| sum[c] + e.flux[c]));
        say!("surfaces that glow, in {} pieces", stage.glowing.len());
        say!("  send          {} W", in_watts(flux));
    }
    let all = stage.emitters().count();
    let cells: std::collections::HashSet<_> =
        stage.injected.sources.iter().flat_map(|source| source.light.iter().map(|(cell, _)| *cell)).collect();
    say!("virtual point lights  {all}, in the volume {}, in {} cells", stage.injected.inside, cells.len());
    say!("  injected      {} W", in_watts(stage.injected.flux));
}
