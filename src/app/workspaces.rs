//! What fills the window between the bars. The actions, the timeline and the status stay in view whatever is chosen,
//! and all workspaces share one [`Session`]: document, run, cursor, iteration.
//!
//! To fill a workspace, write its struct in its file here (its own state: cameras, caches), implement [`Panels`] for
//! it with panels from [`super::panels`], and add it to [`Workspace::FILLED`]. To add a panel to one, write
//! `pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks)` in a file of its own in `panels`, show it from the
//! workspace's [`Panels::ui`], and have it return what it wants as [`Ask`](super::session::ask::Ask)s: a panel never
//! changes the session. What takes long goes into [`asides`](super::session::asides), asked for in every frame that
//! shows it.

pub(crate) mod light;
pub(crate) mod picture;
pub(crate) mod scene;
pub(crate) mod study;

use egui::{Context, Ui};

use super::session::Session;
use super::session::ask::Asks;
use super::session::view::Workspace;

/// The panels of a workspace.
pub trait Panels {
    /// What is to be done between frames while the workspace is in view.
    fn logic(&mut self, _ctx: &Context, _session: &Session, _asks: &mut Asks) {}

    /// Fills the room between the bars.
    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks);
}

/// All workspaces, each with its own state.
#[derive(Default)]
pub struct Workspaces {
    /// The grids, light in space, comparison and plots.
    pub light: light::Light,
    scene: scene::Scene,
    /// What a camera sees, and its truth.
    pub picture: picture::Picture,
    study: study::Study,
}

impl Workspaces {
    /// One of them.
    pub fn get(&mut self, workspace: Workspace) -> &mut dyn Panels {
        match workspace {
            Workspace::Light => &mut self.light,
            Workspace::Scene => &mut self.scene,
            Workspace::Picture => &mut self.picture,
            Workspace::Study => &mut self.study,
        }
    }

    /// Whether one of them waits for nothing of its own.
    pub fn is_idle(&self, workspace: Workspace) -> bool {
        match workspace {
            Workspace::Scene => self.scene.is_idle(),
            Workspace::Picture => self.picture.is_idle(),
            Workspace::Light | Workspace::Study => true,
        }
    }
}
