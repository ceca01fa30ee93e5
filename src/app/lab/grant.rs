//! Does what panels and keys ask for.

use std::path::Path;

use egui::{Context, ViewportCommand};

use super::Lab;
use crate::app::files::export;
use crate::app::files::recovery::Recovery;
use crate::app::panels::palette::Palette;
use crate::app::panels::question::Answer;
use crate::app::session::ask::{Ask, Asks, Next};
use crate::app::session::command::Command;
use crate::app::session::purpose::Purpose;
use crate::app::session::view::Workspace;

impl Lab {
    /// Grants all that was asked for, in order.
    pub(super) fn grant(&mut self, asks: Asks, ctx: &Context) {
        if !asks.0.is_empty() {
            // What is drawn is out of date.
            ctx.request_repaint();
        }
        for ask in asks.0 {
            self.grant_one(ask, ctx);
        }
    }

    fn grant_one(&mut self, ask: Ask, ctx: &Context) {
        let session = &mut self.session;
        match ask {
            Ask::Do(command) => self.perform(command, ctx),
            Ask::Preset(preset) => session.document.preset = *preset,
            Ask::View(view) => session.settings.view = *view,
            Ask::Space(space) => session.sight.space = space,
            Ask::Plots(plots) => session.settings.plots = *plots,
            Ask::Comparison(comparison) => session.comparison = session.comparison.changed(comparison),
            Ask::Kept(kept) => session.run.kept = kept,
            Ask::Rerun(rerun) => session.settings.rerun = Some(rerun),
            Ask::OnCard(on_card) => session.compute_on(on_card),
            Ask::Pace(pace) => session.settings.pace = pace,
            Ask::Past(mib) => session.set_past(mib),
            Ask::Moment(time) => session.run.moment = Some(time),
            Ask::Scrub(k) => session.scrub(k),
            Ask::Pin(pin) => session.set_pin(pin),
            Ask::Select(item) => session.selected = item,
            Ask::Place(injector) => session.placing = injector,
            Ask::Choose(purpose) => self.dialog.ask(purpose, None),
            Ask::Leave(next) => self.ask_to_lose(next, ctx),
            Ask::Say(text) => session.say(text),
            Ask::Port(port) => session.port = *port,
            Ask::Picture(glass) => session.picture = glass,
            Ask::Dismiss => session.notice = None,
            Ask::DismissGuide => session.guide = None,
            Ask::SeekTruth(true) => session.asides.truth.try_again(),
            Ask::SeekTruth(false) => session.asides.truth.give_up(),
            Ask::CancelMeasurement => session.asides.cancel_measurement(),
            Ask::DiscardRecovered => self.recovery.iter_mut().for_each(Recovery::discard),
        }
    }

    /// Does what a command says, if it can be done.
    pub fn perform(&mut self, command: Command, ctx: &Context) {
        if !self.session.can(command) || self.session.perform(command) {
            return;
        }
        let path = self.session.document.path();
        match command {
            Command::Open => self.dialog.ask(Purpose::Open, path),
            Command::Save if path.is_some() => self.session.save(None),
            Command::Save | Command::SaveAs => self.dialog.ask(Purpose::SaveAs, path),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Theme => {
                let is_dark = ctx.theme() == egui::Theme::Dark;
                ctx.set_theme(if is_dark { egui::Theme::Light } else { egui::Theme::Dark });
            }
            Command::WholeSlice => {
                self.workspaces.light.whole();
                self.workspaces.picture.whole();
            }
            Command::ExportCsv
            | Command::ExportSvg
            | Command::ExportPng
            | Command::ExportGrids
            | Command::ExportFilm
            | Command::ExportFrames
            | Command::ExportSheet => self.dialog.ask(Purpose::Export(command), path),
            Command::CopyCurves | Command::CopyPlots | Command::CopyGrids => {
                match export::copy(&self.session, command, ctx) {
                    Ok(done) => self.session.say(done.to_owned()),
                    Err(error) => self.session.fail(error.to_string()),
                }
            }
            Command::Keys => self.keys_open = !self.keys_open,
            Command::Palette => self.palette = Some(Palette::default()),
            Command::Gallery => self.gallery.open = true,
            _ => log::warn!("nothing does {command:?}"),
        }
    }

    /// Does with a file what it was chosen for.
    pub(super) fn use_file(&mut self, purpose: Purpose, path: &Path, ctx: &Context) {
        match purpose {
            Purpose::Open => self.ask_to_lose(Next::Open(path.to_path_buf()), ctx),
            Purpose::SaveAs => self.session.save(Some(path.to_path_buf())),
            Purpose::Export(command @ (Command::ExportFilm | Command::ExportFrames)) => {
                self.film.begin(&mut self.session, command, path);
            }
            Purpose::Export(Command::ExportSheet) => {
                match self.workspaces.picture.save_sheet(&self.session, path, ctx) {
                    Ok(()) => self.session.say(format!("Saved {}", path.display())),
                    Err(line) => self.session.fail(line),
                }
            }
            Purpose::Export(command) => match export::save(&self.session, command, path) {
                Ok(()) => self.session.say(format!("Saved {}", path.display())),
                Err(error) => self.session.fail(error.to_string()),
            },
            Purpose::Injector(i) => self.session.injector_file(i, path),
            Purpose::Occluder(i) => self.session.occluder_file(i, path),
            Purpose::Mesh => self.session.mesh_file(path),
            Purpose::Dump => self.session.add_dump(path),
        }
    }

    /// Takes what was dropped onto the window: a preset is opened, a file of cells becomes an injector, a mesh the scene's.
    pub(super) fn drop_files(&mut self, ctx: &Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in dropped {
            let path = file.path();
            match path.extension().and_then(|ending| ending.to_str()) {
                Some("ron") => self.ask_to_lose(Next::Open(path.to_path_buf()), ctx),
                Some("csv" | "npy") if self.session.settings.workspace == Workspace::Study => {
                    self.session.add_dump(path)
                }
                Some("csv" | "npy") => self.session.injector_file(self.session.document.preset.injectors.len(), path),
                Some("obj" | "gltf" | "glb") => self.session.mesh_file(path),
                _ => {
                    let right = "drop a preset (.ron), a file of cells (.csv, .npy) or a mesh (.obj, .gltf, .glb)";
                    self.session.fail(format!("{}: {right}", path.display()));
                }
            }
        }
    }

    /// Does what would lose edits, after asking where there are any.
    fn ask_to_lose(&mut self, next: Next, ctx: &Context) {
        if self.session.document.is_saved() {
            self.go_on(next, ctx);
        } else {
            self.next = Some(next);
        }
    }

    /// Follows the answer to the question about edits.
    pub(super) fn answer(&mut self, answer: Answer, ctx: &Context) {
        let Some(next) = self.next.take() else { return };
        if answer == Answer::Save {
            self.perform(Command::Save, ctx);
        }
        let saved = self.session.document.is_saved();
        if answer == Answer::Discard || (answer == Answer::Save && saved) {
            self.go_on(next, ctx);
        }
    }

    fn go_on(&mut self, next: Next, ctx: &Context) {
        match next {
            Next::Open(path) => self.session.open(&path),
            Next::BuiltIn(name) => self.session.open_built_in(&name),
            Next::Recover => self.recover(),
            Next::Close => {
                self.discard = true;
                self.give_up_unsaved();
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
        }
    }
}
