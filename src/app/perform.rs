//! What each command does to the window's state.

use std::path::{Path, PathBuf};

use egui::Context;

use crate::app::files::dialog::Purpose;
use crate::app::lab::Lab;
use crate::app::panels::controls::Wish;
use crate::app::panels::errors::Tab;
use crate::app::session::command::Command;
use crate::app::session::view::Stage;
use crate::app::worker::look::Layer;
use crate::app::worker::{Order, Progress, Start};
use crate::simulation::Action;

impl Lab {
    /// Whether a command can be given now.
    pub fn can(&self, command: Command) -> bool {
        match command {
            Command::Undo => self.document.can_undo(),
            Command::Redo => self.document.can_redo(),
            Command::Stop => self.progress.until.is_some() || self.is_playing(),
            Command::Back | Command::First => self.seen() > self.progress.oldest,
            Command::Forward | Command::Last => self.at.is_some(),
            Command::Restart => self.at.is_some_and(|k| k < self.progress.iteration),
            Command::Measure => self.problem.is_some() && !self.pareto.is_underway(),
            Command::KeepRun => self.runs.iter().any(|run| !run.rows.is_empty()),
            _ => true,
        }
    }

    /// Does what a command says.
    pub fn perform(&mut self, command: Command, ctx: &Context) {
        if !self.can(command) {
            return;
        }
        let level = self.level();
        let view = &mut self.settings.view;
        match command {
            Command::Open => self.files.ask(Purpose::Open, self.document.path()),
            Command::Save => self.save(),
            Command::SaveAs => self.files.ask(Purpose::SaveAs, self.document.path()),
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::Undo => self.document.undo(),
            Command::Redo => self.document.redo(),
            Command::Clear => self.load(Start::Dark),
            Command::Inject => self.act(Action::Inject),
            Command::Downsample => self.act(Action::Downsample),
            Command::Propagate => self.act(Action::Propagate),
            Command::Merge => self.act(Action::Merge),
            Command::RunAll => {
                let iteration = self.document.preset.propagation.iterations;
                self.load(Start::To { iteration, merge: true });
            }
            Command::Rerun => {
                let Progress { iteration, merged, .. } = self.progress;
                self.load(Start::To { iteration, merge: merged });
            }
            Command::Play => self.playing = if self.is_playing() { None } else { Some(0.0) },
            Command::Stop => {
                self.playing = None;
                self.send(Order::Stop);
            }
            Command::Back => self.at = Some(self.seen() - 1),
            Command::Forward => self.scrub(self.seen() + 1),
            Command::First => self.at = Some(self.progress.oldest),
            Command::Last => self.at = None,
            Command::Restart => {
                let k = self.seen();
                self.at = None;
                self.send(Order::Restart(k));
            }
            Command::SliceDown => view.index = view.index.saturating_sub(1),
            Command::SliceUp => view.index = (view.index + 1).min(self.progress.side.max(1) - 1),
            Command::NextAxis => view.across = (view.across + 1) % 3,
            Command::Finer => view.layer = Layer::Level(level.saturating_sub(1)),
            Command::Coarser => {
                let coarser = if view.layer == Layer::Merged { 0 } else { level + 1 };
                view.layer = Layer::Level(coarser.min(self.progress.levels.max(1) - 1));
            }
            Command::Merged => {
                view.layer = if view.layer == Layer::Merged { Layer::Level(0) } else { Layer::Merged };
            }
            Command::WholeSlice => self.grids.whole(),
            Command::Grids => view.stage = Stage::Grids,
            Command::Compare => self.compare(ctx),
            Command::Space => view.stage = Stage::Space,
            Command::Errors => self.settings.plots.tab = Tab::Errors,
            Command::Line => self.settings.plots.tab = Tab::Line,
            Command::RunTime => self.settings.plots.tab = Tab::Pareto,
            Command::Measure => {
                self.settings.plots.tab = Tab::Pareto;
                self.measure_pareto(ctx);
            }
            Command::KeepRun => self.keep_run(),
            Command::ExportCsv | Command::ExportSvg | Command::ExportPng | Command::ExportGrids => {
                self.files.ask(Purpose::Export(command), self.document.path());
            }
            Command::CopyCurves | Command::CopyPlots | Command::CopyGrids => self.copy(command, ctx),
            Command::Keys => self.keys_open = !self.keys_open,
        }
    }

    /// Shows propagators side by side; the first time it finds one to compare with.
    fn compare(&mut self, ctx: &Context) {
        self.settings.view.stage = Stage::Compare;
        if self.comparison.others.is_empty() {
            let stale = self.is_stale();
            self.comparison.add(&self.document.preset.propagation);
            // Edits that wait to be run are not run behind the researcher's back.
            if !stale {
                self.perform(Command::Rerun, ctx);
            }
        }
    }

    fn level(&self) -> usize {
        match self.settings.view.layer {
            Layer::Level(level) => level,
            Layer::Merged => 0,
        }
    }

    pub(super) fn act(&mut self, action: Action) {
        self.at = None;
        self.send(Order::Act(action));
    }

    /// Shows iteration `k`; the latest is followed.
    pub fn scrub(&mut self, k: usize) {
        self.at = (k < self.progress.iteration).then_some(k.max(self.progress.oldest));
    }

    fn keep_run(&mut self) {
        self.kept.append(&mut self.runs.clone());
        for run in &mut self.runs {
            run.color += 1;
        }
    }

    fn save(&mut self) {
        if self.document.path().is_none() {
            self.files.ask(Purpose::SaveAs, None);
        } else {
            self.save_as(None);
        }
    }

    /// Saves to the document's file, or to another that becomes its file.
    pub(super) fn save_as(&mut self, path: Option<PathBuf>) {
        match self.document.save(path) {
            Ok(()) => {
                if let Some(path) = self.document.path().map(Path::to_path_buf) {
                    self.settings.remember(&path);
                    self.say(format!("Saved {}", path.display()));
                }
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Changes the memory for past iterations, in MiB.
    pub(super) fn set_past(&mut self, mib: usize) {
        self.settings.past_mib = mib;
        self.worker.order(Order::Budget(self.settings.budget()));
    }

    /// Does what the scene's panel asks for.
    pub(super) fn grant(&mut self, wish: Wish) {
        if let Some(place) = wish.place {
            self.placing = place;
        }
        if let Some(i) = wish.injector_file {
            self.files.ask(Purpose::Injector(i), None);
        }
        if let Some(i) = wish.occluder_file {
            self.files.ask(Purpose::Occluder(i), None);
        }
    }
}
