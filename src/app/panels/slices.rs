//! The flat views, with what the pointer does in them.

use egui::{Align2, Ui};

use super::canvas;

use crate::app::draw::grids::{Grids, Manner, Mark, Pointed};
use crate::app::draw::ink::color;
use crate::app::draw::scales::Scales;
use crate::app::session::Session;
use crate::app::session::ask::Asks;
use crate::app::session::plots::Tab;
use crate::app::session::view::Stage;
use crate::app::worker::look::Shown;
use crate::report::colour::Theme;
use crate::report::slice::SliceCell;

/// The steps of an iteration from view to view, each in a sentence.
const STEPS: [(&str, &str); 2] = [
    (
        "➡",
        "Source to target: Propagate sends each cell's light to its six neighbours, and what they get is the new light.",
    ),
    ("+", "Plus accumulated: the new light is added to the sum of all so far, and is the next iteration's source."),
];

/// Draws the views in all the room there is; where the pointer is. `pointed` is where it was before.
pub fn ui(
    ui: &mut Ui,
    session: &Session,
    grids: &mut Grids,
    scales: &Scales,
    theme: &Theme,
    pointed: Option<Pointed>,
    asks: &mut Asks,
) -> Option<Pointed> {
    let marks = marks(session, theme, pointed);
    let paint = scales.paint(&session.settings.view);
    // The algorithm's way: what the source sends comes into the target, which is added to the sum.
    let between: &[(&str, &str)] = if session.settings.view.stage == Stage::Grids { &STEPS } else { &[] };
    let marks_cells = session.tool.marks_cells() && session.placing.is_none();
    let manner = Manner { view: &session.settings.view, theme, scales, paint, marks: &marks, between, marks_cells };
    let room = ui.available_rect_before_wrap();
    let pointed = grids.ui(ui, &session.sight.shown, &session.titles(), &manner);
    if let Some(stage) = session.run.problem.as_ref().and_then(|problem| problem.stage.as_ref())
        && session.settings.view.occluders
    {
        let placings = grids.placings().to_vec();
        for (shown, placing) in session.sight.shown.iter().zip(&placings) {
            grids.mesh.draw(ui.painter(), stage, shown.slice.plane, placing, theme);
        }
    }
    for (shown, placing) in session.sight.shown.iter().zip(grids.placings()) {
        ui.push_id(("canvas", placing.clip.left() as i32, placing.clip.top() as i32), |ui| {
            canvas::ui(ui, session, placing, shown.slice.plane, theme, asks);
        });
    }
    if let Some((span, placing)) = grids.span().and_then(|span| Some((span, grids.placings().get(span.pane)?))) {
        canvas::mark(ui, session, placing, span, theme, asks);
    }
    if let Some(why) = session.why_dark() {
        let font = egui::FontId::proportional(15.0);
        let galley = ui.painter().layout(why.to_owned(), font, color(theme.ink), room.width() - 20.0);
        let rect = Align2::CENTER_CENTER.anchor_size(room.center(), galley.size());
        ui.painter().rect_filled(rect.expand(8.0), 4.0, color(theme.ground).gamma_multiply(0.9));
        ui.painter().galley(rect.min, galley, color(theme.ink));
        ui.interact(rect, ui.scope_id().with("dark"), egui::Sense::hover())
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, why));
    }
    let pointed = pointed?;
    if let Some(shown) = session.sight.shown.get(pointed.pane) {
        if pointed.double_clicked {
            session.pick(shown, pointed.at, asks);
        } else if pointed.clicked {
            canvas::click(session, pointed, asks);
        }
    }
    Some(pointed)
}

/// The view and its cell under the pointer.
pub fn under_pointer(session: &Session, pointed: Option<Pointed>) -> Option<(&Shown, usize)> {
    let pointed = pointed?;
    let shown = session.sight.shown.get(pointed.pane)?;
    Some((shown, index_at(shown, pointed.at)?))
}

/// The cells to frame: the one under the pointer, in every view, the pinned one, and the line whose light is plotted.
fn marks(session: &Session, theme: &Theme, pointed: Option<Pointed>) -> Vec<Mark> {
    let mut marks = Vec::new();
    if session.settings.plots.tab == Tab::Line {
        let (line, axis) = (session.line(), session.settings.view.axis);
        let (side, [column, row]) = (session.run.progress.side, [axis.columns(), axis.rows()]);
        let color = color(theme.curve(1));
        marks.push(match line.along == column {
            true => Mark { pane: None, column: 0, row: line.through[row], size: [side, 1], color },
            false => Mark { pane: None, column: line.through[column], row: 0, size: [1, side], color },
        });
    }
    if let (Some(pin), Some(shown)) = (session.sight.pin, session.sight.shown.first()) {
        let axis = shown.slice.plane.axis;
        let span = 1 << pin.level;
        let crossed = shown.slice.plane.index >> pin.level == pin.cell[axis.across()];
        if crossed {
            let (column, row) = (pin.cell[axis.columns()] * span, pin.cell[axis.rows()] * span);
            marks.push(Mark { pane: None, column, row, size: [span; 2], color: color(theme.negative) });
        }
    }
    if let Some((shown, i)) = under_pointer(session, pointed) {
        let SliceCell { level, cell, .. } = shown.slice.cells[i];
        let (axis, span) = (shown.slice.plane.axis, 1 << level);
        let (column, row) = (cell[axis.columns()] * span, cell[axis.rows()] * span);
        marks.push(Mark { pane: None, column, row, size: [span; 2], color: color(theme.ink) });
    }
    marks
}

/// Which of a slice's cells covers a finest cell.
fn index_at(shown: &Shown, [column, row]: [usize; 2]) -> Option<usize> {
    let covers = |from: usize, span: usize, at: usize| (from..from + span).contains(&at);
    let cells = &shown.slice.cells;
    cells.iter().position(|cell| covers(cell.column, cell.span, column) && covers(cell.row, cell.span, row))
}
