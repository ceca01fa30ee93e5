//! Edits that are not saved are not lost without a question.

use std::path::PathBuf;

use egui::{Context, Id, Modal, ViewportCommand};

use crate::app::lab::Lab;
use crate::app::session::command::Command;

/// What is to happen once edits are saved or given up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Next {
    /// Open a preset file.
    Open(PathBuf),
    /// Open a built-in preset.
    BuiltIn(String),
    /// Open the unsaved work that another window left.
    Recover,
    /// Close the window.
    Close,
}

impl Lab {
    /// Does what would lose edits, after asking where there are any.
    pub(in crate::app) fn ask_to_lose(&mut self, next: Next, ctx: &Context) {
        if self.document.is_saved() {
            self.go_on(next, ctx);
        } else {
            self.next = Some(next);
        }
    }

    fn go_on(&mut self, next: Next, ctx: &Context) {
        match next {
            Next::Open(path) => self.open(&path),
            Next::BuiltIn(name) => self.open_built_in(&name),
            Next::Recover => self.recover(),
            Next::Close => {
                self.discard = true;
                self.give_up_unsaved();
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }

    /// Keeps the window open while the question stands, and asks it.
    pub(in crate::app) fn closing(&mut self, ctx: &Context) {
        let asked = ctx.input(|input| input.viewport().close_requested());
        if asked && !self.discard && !self.document.is_saved() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.next = Some(Next::Close);
        }
        let Some(next) = self.next.clone() else { return };
        let modal = Modal::new(Id::unique("unsaved edits")).show(ctx, |ui| {
            ui.set_width(380.0);
            ui.heading("Unsaved changes");
            ui.label(format!("{} was edited and not saved.", self.document.name()));
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if ui.button("Save").clicked() {
                    self.next = None;
                    self.perform(Command::Save, ctx);
                    if self.document.is_saved() {
                        self.go_on(next.clone(), ctx);
                    }
                }
                if ui.button("Discard changes").clicked() {
                    self.next = None;
                    self.go_on(next.clone(), ctx);
                }
                if ui.button("Cancel").clicked() {
                    self.next = None;
                }
            });
        });
        if modal.should_close() {
            self.next = None;
        }
    }
}
