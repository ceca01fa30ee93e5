//! The bar that offers unsaved work of a window that crashed.

use std::time::{Duration, SystemTime};

use egui::{Context, Panel, RichText, Ui};

use crate::app::files::recovery::Recovery;
use crate::app::lab::Lab;
use crate::app::panels::closing::Next;

impl Recovery {
    /// What is offered, in a line.
    fn offer(&self, now: SystemTime) -> Option<String> {
        let latest = self.found.first()?;
        let more = match self.found.len() - 1 {
            0 => String::new(),
            more => format!(" ({more} more after this)"),
        };
        // A clock that was set back tells nothing.
        let age = now.duration_since(latest.written).unwrap_or_default();
        let name = &latest.unsaved.name;
        Some(format!("Unsaved changes of {name} from {} were left by a window that ended early{more}.", ago(age)))
    }
}

/// A time that has passed, as people say it.
fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    let (count, unit) = match minutes {
        0 => return "less than a minute ago".to_owned(),
        1..60 => (minutes, "minute"),
        60..2880 => (minutes / 60, "hour"),
        _ => (minutes / 1440, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}

impl Lab {
    /// Keeps unsaved work, unless it was just given up.
    pub(in crate::app) fn keep_unsaved(&mut self, ctx: &Context, now: f64) {
        let Some(recovery) = self.recovery.as_mut().filter(|_| !self.discard) else { return };
        if let Some(wait) = recovery.keep(&self.document, now) {
            ctx.request_repaint_after_secs(wait as f32);
        }
    }

    /// Gives up what was kept of this window's work.
    pub(in crate::app) fn give_up_unsaved(&mut self) {
        if let Some(recovery) = &mut self.recovery {
            recovery.forget();
        }
    }

    /// Opens the latest work that was found.
    pub(in crate::app) fn recover(&mut self) {
        if let Some(document) = self.recovery.as_mut().and_then(Recovery::recover) {
            self.take(document);
        }
    }

    /// The bar, while there is something to offer.
    pub(in crate::app) fn offer(&mut self, ui: &mut Ui) {
        let Some(offer) = self.recovery.as_ref().and_then(|recovery| recovery.offer(SystemTime::now())) else { return };
        Panel::top("recovery").show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                if ui.button("Recover").on_hover_text("Open it, to be looked at and saved").clicked() {
                    self.ask_to_lose(Next::Recover, ui.ctx());
                }
                if ui.button("Discard").on_hover_text("Delete it for good").clicked()
                    && let Some(recovery) = &mut self.recovery
                {
                    recovery.discard();
                }
                // Behind the buttons, so that these stay where they are while the work grows older.
                ui.label(RichText::new(offer).color(ui.visuals().warn_fg_color));
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_as_people_do() {
        let told = |seconds| ago(Duration::from_secs(seconds));
        assert_eq!(told(59), "less than a minute ago");
        assert_eq!([told(60), told(3599)], ["1 minute ago", "59 minutes ago"]);
        assert_eq!([told(3600), told(172_799)], ["1 hour ago", "47 hours ago"]);
        assert_eq!(told(172_800), "2 days ago");
    }
}
