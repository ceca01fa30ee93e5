//! What a camera sees.

use egui::Ui;

use super::Panels;
use crate::app::session::Session;
use crate::app::session::ask::Asks;

/// The workspace's own state.
#[derive(Debug, Default)]
pub struct Picture {}

impl Panels for Picture {
    fn ui(&mut self, _ui: &mut Ui, _session: &Session, _asks: &mut Asks) {}
}
