//! What each neighbour sent the pinned cell, and through which face.

use egui::{Grid, RichText, Ui};

use crate::app::session::Session;
use crate::app::worker::look::PinSample;
use crate::transport::lattice::face::Direction;

/// The table; nothing where light does not go from neighbour to neighbour, or nothing has gone yet.
pub fn ui(ui: &mut Ui, session: &Session, sample: &PinSample) {
    if sample.received.is_empty() {
        return;
    }
    let k = sample.iteration;
    let heading = ui.label(RichText::new(format!("Received in iteration {k}: c00 from each neighbour")).strong());
    heading.on_hover_text(
        "What the neighbours sent before anything blocked it, and through which of the cell's faces, by where its lobe \
         points",
    );
    Grid::new("received").num_columns(8).spacing([6.0, 1.0]).striped(true).show(ui, |ui| {
        ui.small("from");
        ui.small("all");
        Direction::ALL.iter().for_each(|face| drop(ui.small(format!("{} face", letters(*face)))));
        ui.end_row();
        for sent in &sample.received {
            let [red, green, blue] = sent.light;
            ui.small(letters(sent.towards.opposite()));
            ui.small(short((red + green + blue).0[0] / 3.0));
            sent.faces.iter().for_each(|share| drop(ui.small(short(*share))));
            ui.end_row();
        }
    });
    if session.run.problem.as_ref().is_some_and(|problem| !problem.solids.is_empty()) {
        ui.small("Occluders are not taken off.");
    }
}

/// A direction, such as −x.
fn letters(direction: Direction) -> String {
    let sign = if direction.is_positive() { '+' } else { '−' };
    format!("{sign}{}", ["x", "y", "z"][direction.axis()])
}

/// A number in five letters; a dot for nothing.
fn short(value: f32) -> String {
    match value {
        0.0 => "·".to_owned(),
        v if (0.001..10.0).contains(&v.abs()) => format!("{v:.3}"),
        v => format!("{v:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_short() {
        assert_eq!([0.0, 0.25, -0.5, 3e-7].map(short), ["·", "0.250", "-0.500", "3e-7"]);
    }
}
