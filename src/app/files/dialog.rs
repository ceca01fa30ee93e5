//! Asking for files: a path to type, or the system's own dialog on a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use egui::{Context, Id, Label, Modal, RichText, TextEdit, Ui};

use super::preview::Preview;
use crate::app::panels::format;
use crate::app::session::Session;
use crate::app::session::format::Format;
use crate::app::session::purpose::Purpose;

/// A question for a path that is on screen.
#[derive(Clone, Debug)]
struct Question {
    purpose: Purpose,
    text: String,
    /// Whether the field has had the keyboard yet.
    focused: bool,
    /// A file that is there and would be written over.
    over: Option<PathBuf>,
    /// Whether the system has no dialog to show.
    no_dialog: bool,
}

/// Questions for files, and their answers.
pub struct Dialog {
    ctx: Context,
    question: Option<Question>,
    answer: Sender<Answer>,
    answers: Receiver<Answer>,
}

/// What comes of a question.
enum Answer {
    /// A file was chosen.
    File(Purpose, PathBuf),
    /// The system's dialog never came up.
    NoDialog,
}

/// A dialog that is gone sooner than anybody can call it off never was there.
const TOO_SOON: Duration = Duration::from_millis(250);

impl Dialog {
    /// No question.
    pub fn new(ctx: &Context) -> Self {
        let (answer, answers) = channel();
        Dialog { ctx: ctx.clone(), question: None, answer, answers }
    }

    /// Asks for a file; `beside` is one whose folder and name are likely.
    pub fn ask(&mut self, purpose: Purpose, beside: Option<&Path>) {
        let ending = purpose.endings()[0];
        let likely = match (purpose.writes(), beside) {
            (true, Some(path)) => path.with_extension(ending).display().to_string(),
            (true, None) => format!("untitled.{ending}"),
            (false, _) => String::new(),
        };
        self.question = Some(Question { purpose, text: likely, focused: false, over: None, no_dialog: false });
    }

    /// Whether a question is on screen.
    pub fn asks(&self) -> bool {
        self.question.is_some()
    }

    /// The next file that was chosen.
    pub fn chosen(&mut self) -> Option<(Purpose, PathBuf)> {
        match self.answers.try_recv().ok()? {
            Answer::File(purpose, path) => {
                self.question = None;
                Some((purpose, path))
            }
            Answer::NoDialog => {
                if let Some(question) = &mut self.question {
                    question.no_dialog = true;
                }
                None
            }
        }
    }

    /// Shows the question, if there is one. `format` is how pictures are exported, `preview` what they will be.
    pub fn ui(&mut self, ui: &Ui, session: &Session, format: &mut Format, preview: &mut Preview) {
        let Some(mut question) = self.question.take() else { return preview.close() };
        let mut open = true;
        let modal = Modal::new(Id::unique("file question")).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            ui.heading(question.purpose.title());
            ui.add_space(4.0);
            let label = ui.label("File");
            let edit = TextEdit::singleline(&mut question.text).desired_width(f32::INFINITY);
            let field = ui.add(edit).labelled_by(label.id);
            if !question.focused {
                field.request_focus();
                question.focused = true;
            }
            if field.changed() {
                question.over = None;
            }
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if question.purpose == Purpose::Open {
                for path in &session.settings.recent {
                    if ui.link(path.display().to_string()).clicked() {
                        self.answer(question.purpose, path.clone());
                    }
                }
            }
            // Where a path leads that is typed in part.
            let whole = std::path::absolute(typed_path(&question.text)).unwrap_or_default();
            if !question.text.trim().is_empty() {
                ui.add(Label::new(RichText::new(whole.display().to_string()).small().weak()).truncate());
            } else if let Ok(folder) = std::env::current_dir() {
                ui.weak(format!("in {}", folder.display()));
            }
            if question.no_dialog {
                let text = "The system shows no file dialog here: type the path.";
                ui.colored_label(ui.visuals().warn_fg_color, text);
            }
            if let Some(over) = &question.over {
                let text = format!("{} is there already. Save again to replace it.", over.display());
                ui.colored_label(ui.visuals().warn_fg_color, text);
            }
            ui.add_space(6.0);
            if question.purpose.is_picture() {
                format::ui(ui, format);
                ui.add_space(6.0);
            }
            ui.horizontal(|ui| {
                let typed = !question.text.trim().is_empty();
                let pressed = ui.add_enabled(typed, egui::Button::new(question.purpose.verb())).clicked();
                if typed && (pressed || entered) {
                    self.typed(&mut question);
                }
                if ui.button("Browse…").on_hover_text("Choose with the system's file dialog").clicked() {
                    self.browse(question.purpose, &question.text);
                }
                open &= !ui.button("Cancel").clicked();
            });
            // Under the buttons: in a low window they must not be what is cut.
            if let (true, Purpose::Export(command)) = (question.purpose.is_picture(), question.purpose) {
                ui.add_space(6.0);
                preview.ui(ui, session, command, format);
            }
        });
        if open && !modal.should_close() {
            self.question = Some(question);
        }
    }

    /// Takes the path that was typed; a file that would be written over is asked about once.
    fn typed(&self, question: &mut Question) {
        let mut path = typed_path(&question.text);
        if question.purpose.writes() {
            if path.extension().is_none() {
                path.set_extension(question.purpose.endings()[0]);
            }
            if path.exists() && question.over.as_ref() != Some(&path) {
                question.over = Some(path);
                return;
            }
        }
        self.answer(question.purpose, path);
    }

    fn answer(&self, purpose: Purpose, path: PathBuf) {
        // Both ends live in this struct.
        let _ = self.answer.send(Answer::File(purpose, path));
        self.ctx.request_repaint();
    }

    /// Opens the system's dialog, which may take as long as it likes.
    fn browse(&self, purpose: Purpose, text: &str) {
        let (answer, ctx) = (self.answer.clone(), self.ctx.clone());
        let likely = typed_path(text);
        let dialog = move || {
            let mut dialog = rfd::FileDialog::new().set_title(purpose.title());
            dialog = dialog.add_filter(purpose.endings().join(", "), purpose.endings());
            if let Some(folder) = likely.parent().filter(|folder| folder.is_dir()) {
                dialog = dialog.set_directory(folder);
            }
            if let Some(name) = likely.file_name() {
                dialog = dialog.set_file_name(name.to_string_lossy());
            }
            let asked = Instant::now();
            let chosen = if purpose.writes() { dialog.save_file() } else { dialog.pick_file() };
            let answered = match chosen {
                Some(path) => Answer::File(purpose, path),
                None if asked.elapsed() < TOO_SOON => Answer::NoDialog,
                None => return,
            };
            // The window may be gone by now.
            let _ = answer.send(answered);
            ctx.request_repaint();
        };
        if let Err(error) = std::thread::Builder::new().name("file dialog".to_owned()).spawn(dialog) {
            log::warn!("no thread for the file dialog: {error}");
        }
    }
}

/// A path as it was typed; `~/` is the home folder.
fn typed_path(text: &str) -> PathBuf {
    let text = text.trim();
    let home = std::env::home_dir().filter(|home| !home.as_os_str().is_empty());
    match (text.strip_prefix("~/"), home) {
        (Some(rest), Some(home)) => home.join(rest),
        _ => PathBuf::from(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilde_is_the_home_folder_and_nothing_elsewhere() {
        let home = std::env::home_dir().unwrap();
        assert_eq!(typed_path(" ~/a/b.ron "), home.join("a/b.ron"));
        assert_eq!(typed_path("a/~/b.ron"), Path::new("a/~/b.ron"));
    }
}
