//! What clicks in a view do: a cell is kept in sight, an injector is placed, picked up or added.

use super::Session;
use super::ask::{Ask, Asks};
use crate::app::worker::look::{Pin, Shown};
use crate::scene::injector::{Injector, InjectorKind};

impl Session {
    /// A click on a view's finest cell, (column, row): it places the injector that waits for it, or pins the cell.
    pub fn click(&self, shown: &Shown, at: [usize; 2], asks: &mut Asks) {
        let plane = shown.slice.plane;
        if let Some(i) = self.placing {
            let mut preset = self.document.preset.clone();
            if let Some(injector) = preset.injectors.get_mut(i) {
                injector.kind = InjectorKind::Single { cell: plane.axis.cell(plane.index, at[0], at[1]) };
                asks.ask(Ask::Preset(Box::new(preset)));
            }
            asks.ask(Ask::Place(None));
            return;
        }
        let Some(cell) = shown.slice.at(at) else { return };
        let pin = Pin { level: cell.level, cell: cell.cell };
        asks.ask(Ask::Pin((self.sight.pin != Some(pin)).then_some(pin)));
    }

    /// A double click: it picks up the single injector that is there, or adds one.
    pub fn pick(&self, shown: &Shown, at: [usize; 2], asks: &mut Asks) {
        let plane = shown.slice.plane;
        let kind = InjectorKind::Single { cell: plane.axis.cell(plane.index, at[0], at[1]) };
        let mut preset = self.document.preset.clone();
        match preset.injectors.iter().position(|injector| injector.kind == kind) {
            Some(i) => {
                asks.ask(Ask::Place(Some(i)));
                asks.ask(Ask::Say(format!("Injector {} is picked up: click the cell where it is to go", i + 1)));
            }
            None => {
                preset.injectors.push(Injector::new(kind));
                asks.ask(Ask::Preset(Box::new(preset)));
            }
        }
    }
}
