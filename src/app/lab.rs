//! The whole window: the session, its workspaces, and the files around it. In every frame panels are shown what is,
//! and what they ask for is granted once all are drawn.

mod grant;
mod keeping;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Context, Panel, Ui, ViewportCommand};

use super::draw::style;
use super::files::dialog::Dialog;
use super::files::film::Film;
use super::files::home::Home;
use super::files::preview::Preview;
use super::files::recovery::Recovery;
use super::panels::button::fold_button;
use super::panels::gallery::Gallery;
use super::panels::palette::{self, Palette};
use super::panels::{field, keys, menu, notice, offer, question, scene, timeline, toolbar};
use super::session::Session;
use super::session::ask::{Asks, Next};
use super::session::command::{self, Command};
use super::session::curves::Curves;
use super::session::line::Course;
use super::session::settings::Settings;
use super::worker::look::{Cloud, Shown};
use super::workspaces::Workspaces;
use crate::scene::Preset;
use crate::study::pareto::Row;

/// The whole window.
pub struct Lab {
    session: Session,
    workspaces: Workspaces,
    dialog: Dialog,
    film: Film,
    preview: Preview,
    /// Where settings are kept, if they are.
    home: Option<Home>,
    /// Where unsaved work is kept, if it is.
    recovery: Option<Recovery>,
    keys_open: bool,
    palette: Option<Palette>,
    gallery: Gallery,
    window_title: String,
    /// Whether it was told that settings cannot be kept.
    told_of_home: bool,
    /// Whether the window may close although edits are not saved.
    discard: bool,
    /// What waits for edits to be saved or given up.
    next: Option<Next>,
}

impl Lab {
    /// A window on a preset, with its file if it has one.
    pub fn new(ctx: &Context, preset: Preset, path: Option<PathBuf>, settings: Settings) -> std::io::Result<Self> {
        style::apply(ctx);
        Ok(Lab {
            session: Session::new(ctx, preset, path, settings)?,
            workspaces: Workspaces::default(),
            dialog: Dialog::new(ctx),
            film: Film::default(),
            preview: Preview::default(),
            home: None,
            recovery: None,
            keys_open: false,
            palette: None,
            gallery: Gallery::default(),
            window_title: String::new(),
            told_of_home: false,
            discard: false,
            next: None,
        })
    }

    /// Everything that happens between frames: news, keys, files, play.
    pub fn logic(&mut self, ctx: &Context) {
        self.session.listen();
        self.session.size = ctx.content_rect().size();
        // While a question stands, keys are for answering it.
        if self.next.is_none() && !self.dialog.asks() && self.palette.is_none() && !self.gallery.open {
            for command in command::pressed(ctx, |command| self.session.can(command)) {
                self.perform(command, ctx);
            }
        }
        if let Some((purpose, path)) = self.dialog.chosen() {
            self.use_file(purpose, &path, ctx);
        }
        self.drop_files(ctx);
        let mut asks = Asks::default();
        self.workspaces.get(self.session.settings.workspace).logic(ctx, &self.session, &mut asks);
        self.grant(asks, ctx);
        let now = ctx.input(|input| input.time);
        self.film.advance(&mut self.session, ctx);
        self.session.advance(ctx, now);
        self.keep_unsaved(ctx, now);
    }

    /// The whole window: bars above and below, the scene to the left, a workspace in the middle.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.name_window(&ctx);
        let (session, mut asks) = (&self.session, Asks::default());
        Panel::top("menu").show(ui, |ui| menu::ui(ui, session, &mut asks));
        if let Some(line) = self.recovery.as_ref().and_then(Recovery::offer) {
            offer::ui(ui, &line, &mut asks);
        }
        Panel::top("actions").show(ui, |ui| toolbar::ui(ui, session, &mut asks));
        Panel::bottom("foot").show(ui, |ui| notice::foot(ui, session, &mut asks));
        Panel::bottom("timeline").show(ui, |ui| timeline::ui(ui, session, &mut asks));
        if session.settings.folds.scene(session.size) {
            Panel::left("scene, folded").exact_size(36.0).resizable(false).show(ui, |ui| {
                ui.add_space(4.0);
                fold_button(ui, "⏵", Command::FoldScene, &mut asks);
            });
        } else {
            Panel::left("scene").default_size(290.0).size_range(230.0..=480.0).show(ui, |ui| {
                scene::ui(ui, session, &mut asks);
            });
        }
        self.workspaces.get(session.settings.workspace).ui(ui, session, &mut asks);
        let mut format = self.session.settings.plots.format;
        self.dialog.ui(ui, &self.session, &mut format, &mut self.preview);
        self.session.settings.plots.format = format;
        keys::ui(&ctx, &mut self.keys_open);
        palette::ui(&ctx, &mut self.palette, &self.session, &mut asks);
        self.gallery.ui(&ctx, &mut asks);
        self.grant(asks, &ctx);
        if let Some(text) = field::take_unreadable(&ctx) {
            self.session.fail(format!("“{text}” is no number; the field keeps what it had"));
        }
        self.closing(&ctx);
    }

    /// The window's title tells the document, and whether it is saved.
    fn name_window(&mut self, ctx: &Context) {
        let document = &self.session.document;
        let mark = if document.is_saved() { "" } else { " (edited)" };
        let title = format!("{}{mark} – lpv-lab", document.name());
        if self.window_title != title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.window_title = title;
        }
    }

    /// Keeps the window open while the question stands, and asks it.
    fn closing(&mut self, ctx: &Context) {
        let asked = ctx.input(|input| input.viewport().close_requested());
        if asked && !self.discard && !self.session.document.is_saved() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.next = Some(Next::Close);
        }
        if self.next.is_some()
            && let Some(answer) = question::ui(ctx, &self.session.document.name())
        {
            self.answer(answer, ctx);
        }
    }

    /// Opens a preset, or tells why it cannot be.
    pub fn open(&mut self, path: &Path) {
        self.session.open(path);
    }

    /// The preset as edited.
    pub fn preset(&self) -> &Preset {
        &self.session.document.preset
    }

    /// The present iteration.
    pub fn iteration(&self) -> usize {
        self.session.run.progress.iteration
    }

    /// The iteration that is seen.
    pub fn seen(&self) -> usize {
        self.session.seen()
    }

    /// The views as they are.
    pub fn shown(&self) -> &[Shown] {
        &self.session.sight.shown
    }

    /// The light in space, while it is shown.
    pub fn cloud(&self) -> Option<&Cloud> {
        self.session.sight.cloud.as_ref().map(Arc::as_ref)
    }

    /// The error curves: the present run's, then those kept.
    pub fn curves(&self) -> Vec<&Curves> {
        self.session.run.all_curves()
    }

    /// The light along the line that is chosen, once it is computed.
    pub fn course(&self) -> Option<Course> {
        self.session.course()
    }

    /// Run time against error, as it was measured last.
    pub fn pareto_rows(&self) -> &[Row] {
        self.session.pareto_rows()
    }

    /// What is remembered.
    pub fn settings(&self) -> &Settings {
        &self.session.settings
    }

    /// Whether nothing is being computed or waited for.
    pub fn is_idle(&self) -> bool {
        let workspace = self.workspaces.is_idle(self.session.settings.workspace);
        self.session.is_idle() && !self.film.is_underway() && workspace
    }

    /// Whether the results were made from another scene than the one as it is now.
    pub fn is_stale(&self) -> bool {
        self.session.is_stale()
    }

    /// Forgets what was drawn, so that the next frame draws it anew.
    pub(super) fn redraw(&mut self) {
        self.workspaces.light.redraw();
    }
}
