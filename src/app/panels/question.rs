//! Edits that are not saved are not lost without a question.

use egui::{Context, Id, Modal};

/// What is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Save, then go on.
    Save,
    /// Go on; the edits are given up.
    Discard,
    /// Leave everything as it is.
    Cancel,
}

/// The question about the document called `name`; `None` while it is not answered.
pub fn ui(ctx: &Context, name: &str) -> Option<Answer> {
    let mut answer = None;
    let modal = Modal::new(Id::unique("unsaved edits")).show(ctx, |ui| {
        ui.set_width(380.0);
        ui.heading("Unsaved changes");
        ui.label(format!("{name} was edited and not saved."));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (text, one) in
                [("Save", Answer::Save), ("Discard changes", Answer::Discard), ("Cancel", Answer::Cancel)]
            {
                if ui.button(text).clicked() {
                    answer = Some(one);
                }
            }
        });
    });
    answer.or(modal.should_close().then_some(Answer::Cancel))
}
