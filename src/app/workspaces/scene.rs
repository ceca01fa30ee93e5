//! The scene as a mesh in space, with its lights.

use egui::Ui;

use super::Panels;
use crate::app::session::Session;
use crate::app::session::ask::Asks;

/// The workspace's own state.
#[derive(Debug, Default)]
pub struct Scene {}

impl Panels for Scene {
    fn ui(&mut self, _ui: &mut Ui, _session: &Session, _asks: &mut Asks) {}
}
