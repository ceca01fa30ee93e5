//! The window: step the propagation and watch it, put propagators side by side, take the error plots home.
//!
//! | room | what stands there |
//! |---|---|
//! | `lab` | the whole: draws everything, then grants what was asked for |
//! | `workspaces` | what fills the window between the bars; how to add a panel |
//! | `panels` | the parts that are looked at and clicked on; each reads the session and returns asks |
//! | `files` | settings, unsaved work, the question for a path, exports |
//! | `draw` | slices, glyphs, light in space as triangles |
//! | `session` | the state, which knows no panel |
//! | `worker` | the thread that computes, so that the window never waits for a volume |
//!
//! Each uses only rooms below it.

mod draw;
mod files;
pub mod frame_cost;
mod lab;
mod panels;
mod session;
mod worker;
mod workspaces;

use std::path::PathBuf;

pub use files::home::Home;
pub use lab::Lab;
pub use session::command::Command;
pub use session::curves::Curves;
pub use session::settings::Settings;
pub use session::view::{Heat, Scaling, Stage, View};
pub use worker::look::{Cloud, Layer, Light, Shown};

use crate::scene::Preset;

/// The name by which desktops know the window, and the folder where it keeps its settings.
const APP_ID: &str = "lpv-lab";

/// Opens the window on a preset, with its file if it has one, and comes back when it is closed. An error
/// means that there was no window: no display, or no graphics.
pub fn run(preset: Preset, path: Option<PathBuf>) -> Result<(), eframe::Error> {
    let (home, settings) = eframe::storage_dir(APP_ID).map(|folder| Home::open(&folder)).unzip();
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_app_id(APP_ID)
            .with_title("lpv-lab")
            .with_inner_size([1280.0, 720.0])
            .with_min_inner_size([480.0, 320.0]),
        persistence_path: home.as_ref().map(Home::layout),
        ..Default::default()
    };
    eframe::run_native(
        APP_ID,
        options,
        Box::new(move |creation| {
            let mut lab = Lab::new(&creation.egui_ctx, preset, path, settings.unwrap_or_default())?;
            if let Some(home) = home {
                lab.move_in(home);
            }
            Ok(Box::new(Shell(lab)))
        }),
    )
}

/// What eframe drives.
struct Shell(Lab);

impl eframe::App for Shell {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.0.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.ui(ui);
    }

    fn save(&mut self, _storage: &mut dyn eframe::Storage) {
        self.0.keep_settings();
    }
}
