//! Cells under the pointer, and the pinned one.

use crate::app::draw::grids::{Mark, Pointed};
use crate::app::draw::ink::color;
use crate::app::lab::Lab;
use crate::app::panels::errors::Tab;
use crate::app::worker::Order;
use crate::app::worker::look::{Pin, Shown};
use crate::report::colour::Theme;
use crate::report::slice::SliceCell;
use crate::scene::injector::{Injector, InjectorKind};

impl Lab {
    /// The view and its cell under the pointer.
    pub(in crate::app) fn under_pointer(&self) -> Option<(&Shown, usize)> {
        let pointed = self.pointed?;
        let shown = self.shown.get(pointed.pane)?;
        Some((shown, index_at(shown, pointed.at)?))
    }

    /// What a click in a view does: it places the injector that waits for it, or pins the cell.
    pub(in crate::app) fn click(&mut self, pointed: Pointed) {
        let Some(shown) = self.shown.get(pointed.pane) else { return };
        let plane = shown.slice.plane;
        let finest = plane.axis.cell(plane.index, pointed.at[0], pointed.at[1]);
        if let Some(i) = self.placing.take() {
            if let Some(injector) = self.document.preset.injectors.get_mut(i) {
                injector.kind = InjectorKind::Single { cell: finest };
            }
            return;
        }
        let Some(cell) = shown.slice.at(pointed.at) else { return };
        let pin = Pin { level: cell.level, cell: cell.cell };
        let pin = (self.pin != Some(pin)).then_some(pin);
        self.set_pin(pin);
    }

    /// What a double click in a view does: it picks up the single injector that is there, or adds one.
    pub(in crate::app) fn pick(&mut self, pointed: Pointed) {
        let Some(shown) = self.shown.get(pointed.pane) else { return };
        let plane = shown.slice.plane;
        let cell = plane.axis.cell(plane.index, pointed.at[0], pointed.at[1]);
        let kind = InjectorKind::Single { cell };
        let injectors = &mut self.document.preset.injectors;
        match injectors.iter().position(|injector| injector.kind == kind) {
            Some(i) => {
                self.placing = Some(i);
                self.say(format!("Injector {} is picked up: click the cell where it is to go", i + 1));
            }
            None => injectors.push(Injector::new(kind)),
        }
    }

    /// Keeps a cell in sight, or none.
    pub(in crate::app) fn set_pin(&mut self, pin: Option<Pin>) {
        self.pin = pin;
        self.pinned.clear();
        self.worker.order(Order::Pin(pin));
    }

    /// The cells to frame: the one under the pointer, in every view, the pinned one, and the line whose light is
    /// plotted.
    pub(in crate::app) fn marks(&self, theme: &Theme) -> Vec<Mark> {
        let mut marks = Vec::new();
        if self.settings.plots.tab == Tab::Line {
            let (line, axis) = (self.line(), self.settings.view.axis());
            let (side, [column, row]) = (self.progress.side, [axis.columns(), axis.rows()]);
            let color = color(theme.curve(1));
            marks.push(match line.along == column {
                true => Mark { pane: None, column: 0, row: line.through[row], size: [side, 1], color },
                false => Mark { pane: None, column: line.through[column], row: 0, size: [1, side], color },
            });
        }
        if let (Some(pin), Some(shown)) = (self.pin, self.shown.first()) {
            let axis = shown.slice.plane.axis;
            let span = 1 << pin.level;
            let crossed = shown.slice.plane.index >> pin.level == pin.cell[axis.across()];
            if crossed {
                let (column, row) = (pin.cell[axis.columns()] * span, pin.cell[axis.rows()] * span);
                marks.push(Mark { pane: None, column, row, size: [span; 2], color: color(theme.negative) });
            }
        }
        if let Some((shown, i)) = self.under_pointer() {
            let SliceCell { column, row, span, .. } = shown.slice.cells[i];
            marks.push(Mark { pane: None, column, row, size: [span; 2], color: color(theme.ink) });
        }
        marks
    }
}

/// Which of a slice's cells covers a finest cell.
fn index_at(shown: &Shown, [column, row]: [usize; 2]) -> Option<usize> {
    let covers = |from: usize, span: usize, at: usize| (from..from + span).contains(&at);
    let cells = &shown.slice.cells;
    cells.iter().position(|cell| covers(cell.column, cell.span, column) && covers(cell.row, cell.span, row))
}
