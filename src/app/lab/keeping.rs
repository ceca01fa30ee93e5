//! What outlasts the window: settings, and work that was not saved.

use egui::Context;

use super::Lab;
use crate::app::files::home::Home;
use crate::app::files::recovery::Recovery;

impl Lab {
    /// Keeps settings and unsaved work in `home` from now on; tells what was wrong there, and offers the work that
    /// other windows left there.
    pub fn move_in(&mut self, home: Home) {
        let (recovery, complaints) = Recovery::look(home.folder());
        let lines: Vec<&str> = home.complaints().iter().chain(&complaints).map(String::as_str).collect();
        if !lines.is_empty() {
            self.session.fail(lines.join(". "));
        }
        self.recovery = Some(recovery);
        self.home = Some(home);
    }

    /// Writes the settings to where they are kept, if they are kept.
    pub fn keep_settings(&mut self) {
        let Some(home) = &mut self.home else { return };
        if let Err(error) = home.save(&self.session.settings)
            && !std::mem::replace(&mut self.told_of_home, true)
        {
            self.session.fail(format!("settings are not kept: {error}"));
        }
    }

    /// Keeps unsaved work, unless it was just given up.
    pub(super) fn keep_unsaved(&mut self, ctx: &Context, now: f64) {
        let Some(recovery) = self.recovery.as_mut().filter(|_| !self.discard) else { return };
        if let Some(wait) = recovery.keep(&self.session.document, now) {
            ctx.request_repaint_after_secs(wait as f32);
        }
        if let Some(line) = recovery.complaint() {
            self.session.fail(line);
        }
    }

    /// Gives up what was kept of this window's work.
    pub(super) fn give_up_unsaved(&mut self) {
        if let Some(recovery) = &mut self.recovery {
            recovery.forget();
        }
    }

    /// Opens the latest work that was found.
    pub(super) fn recover(&mut self) {
        if let Some(document) = self.recovery.as_mut().and_then(Recovery::recover) {
            self.session.take(document);
        }
    }
}
