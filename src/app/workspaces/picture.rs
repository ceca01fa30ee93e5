//! What a camera sees of every run's light, its truth, and how they differ, all under one pointer. The truth is refined
//! while one looks.

mod bar;
mod camera;
mod lens;
mod making;
mod numbers;
mod sheet;
mod tiles;

use std::path::Path;
use std::sync::Arc;

use egui::{CentralPanel, Context, Frame, Margin, Panel, Ui};

use self::making::{Against, Apart, Pictures, Request, Traced, TruthRequest};
use self::tiles::{Made, Marks, Pointed, Tiles};
use super::Panels;
use crate::app::draw::style::theme;
use crate::app::panels::mesh_scene;
use crate::app::session::Session;
use crate::app::session::asides::{Aside, Very, Watch};
use crate::app::session::ask::{Ask, Asks};
use crate::app::worker::look::Pin;
use crate::field::Cell;
use crate::scene::Stage;

/// The workspace's own state.
pub struct Picture {
    pictures: Aside<Request, Arc<Pictures>>,
    truth: Aside<TruthRequest, Arc<Traced>>,
    apart: Aside<Against, Arc<Vec<Apart>>>,
    tiles: Tiles,
    /// Why there is no picture.
    fault: Option<String>,
    pointed: Pointed,
}

impl Default for Picture {
    fn default() -> Self {
        Picture {
            pictures: Aside::new("pictures"),
            truth: Aside::new("truth"),
            apart: Aside::new("differences"),
            tiles: Tiles::default(),
            fault: None,
            pointed: Pointed::default(),
        }
    }
}

impl Panels for Picture {
    fn logic(&mut self, ctx: &Context, session: &Session, _asks: &mut Asks) {
        let heard = [self.pictures.hear(ctx), self.truth.hear(ctx), self.apart.hear(ctx)];
        let wanted = self.want_all(ctx, session);
        for line in heard.into_iter().chain([wanted]).filter_map(Result::err) {
            self.fault = Some(line);
        }
    }

    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        Panel::top("picture").show(ui, |ui| bar::ui(ui, session, self.progress(session), asks));
        if let Some(fault) = &self.fault {
            Panel::top("picture fault").show(ui, |ui| ui.colored_label(ui.visuals().error_fg_color, fault));
        }
        let made = self.made(session);
        let ground = Frame::central_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        let Some((made, stage)) = made.zip(stage(session)) else {
            CentralPanel::default().frame(ground).show(ui, |ui| missing(ui, session, self.fault.is_some(), asks));
            return;
        };
        Panel::bottom("picture numbers").show(ui, |ui| self.numbers(ui, session, &made, stage));
        CentralPanel::default().frame(ground).show(ui, |ui| self.views(ui, session, &made, stage, asks));
    }
}

/// The stage of the problem that runs.
fn stage(session: &Session) -> Option<&Arc<Stage>> {
    session.run.problem.as_ref().and_then(|problem| problem.stage.as_ref())
}

/// What is missing for a picture, and how it is added.
fn missing(ui: &mut Ui, session: &Session, failed: bool, asks: &mut Asks) {
    if session.document.preset.scene.is_some() {
        if !failed {
            ui.centered_and_justified(|ui| ui.label("Making the picture…"));
        }
        return;
    }
    mesh_scene::missing(ui, session, asks);
}

impl Picture {
    /// Whether nothing is being made.
    pub fn is_idle(&self) -> bool {
        !(self.pictures.is_underway() || self.truth.is_underway() || self.apart.is_underway())
    }

    /// Zooms and pans back to the whole picture.
    pub fn whole(&mut self) {
        self.tiles.whole();
    }

    /// Writes what is shown as one sheet.
    ///
    /// # Errors
    /// Where nothing is made yet, or the file cannot be written; in a line.
    pub fn save_sheet(&self, session: &Session, path: &Path, ctx: &Context) -> Result<(), String> {
        let made = self.made(session).ok_or("there is no picture yet: open the Picture workspace first")?;
        sheet::save(session, &made, path, &theme(ctx))
    }

    fn want_all(&mut self, ctx: &Context, session: &Session) -> Result<(), String> {
        let (Some(scene), Some(problem), Some(stage)) =
            (&session.document.preset.scene, &session.run.problem, stage(session))
        else {
            self.fault = None;
            self.pictures.keep_only(|_| false);
            self.truth.keep_only(|_| false);
            return Ok(());
        };
        let (glass, camera) = (&session.picture, camera::of(scene, stage));
        if making::view(&camera, glass.side).is_none() {
            return Err("The camera sees nothing: it stands where it looks, or its up points along the view".into());
        }
        let request = Request {
            problem: Very(Arc::clone(problem)),
            rivals: session.run.others.clone(),
            iteration: session.seen(),
            camera,
            side: glass.side,
            sampling: glass.sampling,
        };
        if self.pictures.known(&request).is_some() {
            self.fault = None;
        }
        self.pictures.want(&request, ctx, |last| {
            let last = last.map(|(of, pictures)| (of.clone(), Arc::clone(pictures)));
            let request = request.clone();
            move |watch: &Watch| making::pictures(&request, last.as_ref(), watch).map(Arc::new)
        })?;
        let wanted =
            TruthRequest { stage: Arc::clone(stage), camera, side: glass.side, bounces: glass.bounces, paths: 0 };
        self.truth.keep_only(|of| of.is_of_the_same(&wanted));
        // All of them want every core. What is dragged or played has its picture first, then its numbers.
        if self.pictures.known(&request).is_none() || !glass.refine {
            self.truth.give_up();
        }
        if self.pictures.known(&request).is_none() {
            return Ok(());
        }
        self.want_apart(ctx, session)?;
        let so_far = self.samples();
        if !glass.refine || so_far >= glass.paths || self.apart.is_underway() {
            return Ok(());
        }
        self.truth.try_again();
        let wanted = TruthRequest { paths: so_far + making::BATCH, ..wanted };
        self.truth.want(&wanted, ctx, |last| {
            let last = last.map(|(of, traced)| (of.clone(), Arc::clone(traced)));
            let wanted = wanted.clone();
            move |watch: &Watch| making::truth(&wanted, last.as_ref(), watch).map(Arc::new)
        })
    }

    /// The truth's paths a pixel so far.
    fn samples(&self) -> u64 {
        self.truth.latest().map_or(0, |(_, traced)| traced.truth.samples())
    }

    /// Measures anew what is new, and against a truth that has twice the paths or has come to rest.
    fn want_apart(&mut self, ctx: &Context, session: &Session) -> Result<(), String> {
        let (Some((_, pictures)), Some((_, truth))) = (self.pictures.latest(), self.truth.latest()) else {
            return Ok(());
        };
        let exposure = exposure(session, pictures);
        let against = Against { pictures: Arc::clone(pictures), truth: Arc::clone(truth), exposure };
        let (glass, so_far) = (&session.picture, self.samples());
        let same = |of: &Against| Arc::ptr_eq(&of.pictures, pictures) && of.exposure == exposure;
        let measured = self.apart.latest().filter(|(of, _)| same(of)).map_or(0, |(of, _)| of.truth.truth.samples());
        let rests = !glass.refine || so_far >= glass.paths;
        if so_far >= 2 * measured || rests {
            self.apart.want(&against, ctx, |_| {
                let against = against.clone();
                move |watch: &Watch| making::apart(&against, watch).map(Arc::new)
            })?;
        }
        Ok(())
    }

    /// What there is to show.
    fn made(&self, session: &Session) -> Option<Made> {
        session.document.preset.scene.as_ref()?;
        let (_, pictures) = self.pictures.latest()?;
        let truth = self.truth.latest();
        // While the truth is refined its last numbers stay in view; those of other pictures do not.
        let apart = self.apart.latest().filter(|(of, _)| Arc::ptr_eq(&of.pictures, pictures));
        Some(Made {
            pictures: Arc::clone(pictures),
            truth: truth.map(|(_, traced)| Arc::clone(traced)),
            apart: apart.map(|(_, apart)| Arc::clone(apart)),
            exposure: exposure(session, pictures),
            false_colour: session.picture.false_colour,
        })
    }

    /// How far the truth is, for the bar.
    fn progress(&self, session: &Session) -> bar::Progress {
        let traced = self.truth.latest().map(|(_, traced)| traced);
        bar::Progress {
            quality: traced.map(|traced| numbers::quality(traced)),
            refining: self.truth.is_underway(),
            paths: traced.map_or(0, |traced| traced.truth.samples()),
            making: self.pictures.share(),
            camera: session.document.preset.scene.as_ref().zip(stage(session)).map(|(s, stage)| camera::of(s, stage)),
            places: self.pictures.latest().map(|(_, pictures)| pictures.places()).unwrap_or_default(),
        }
    }

    /// The finest cell that a pixel shows.
    fn cell(&self, made: &Made, stage: &Stage, [x, y]: [usize; 2]) -> Option<Cell> {
        let view = &made.pictures.view;
        let way = view.way([x as f64 + 0.5, y as f64 + 0.5]);
        let hit = stage.model.bvh.closest(view.from, way, f64::INFINITY)?;
        stage.placement.cell_of(hit.point)
    }

    fn numbers(&self, ui: &mut Ui, session: &Session, made: &Made, stage: &Stage) {
        let line = self.pointed.pixel.map(|pixel| numbers::pixel(made, pixel, self.cell(made, stage, pixel)));
        let hint = "Point at a pixel for its radiance; click it to pin its cell; drag to pan, scroll to zoom, drag with \
                    the right button to go around";
        ui.add(egui::Label::new(line.unwrap_or_else(|| hint.to_owned())).truncate());
        numbers::table(ui, session, made);
    }

    fn views(&mut self, ui: &mut Ui, session: &Session, made: &Made, stage: &Stage, asks: &mut Asks) {
        let glass = &session.picture;
        let tiles = glass.tiles(&made.pictures.places());
        let pin = session.sight.pin;
        let cell = pin.map(|Pin { level, cell }| (cell.map(|c| c << level), 1 << level));
        let marks = Marks { cell, placement: &stage.placement };
        let theme = theme(ui.ctx());
        self.pointed = self.tiles.ui(ui, made, &tiles, glass.split.is_some(), &marks, &theme);
        if let Some(pixel) = self.pointed.pixel.filter(|_| self.pointed.clicked) {
            self.pin(session, made, stage, pixel, asks);
        }
        if self.pointed.orbit != egui::Vec2::ZERO {
            let before = &session.document.preset;
            let mut preset = before.clone();
            if let Some(scene) = &mut preset.scene {
                scene.camera = Some(camera::orbit(&camera::of(scene, stage), self.pointed.orbit));
            }
            asks.changed(before, preset, |preset| Ask::Preset(Box::new(preset)));
        }
    }

    /// Pins the cell that a pixel shows, and cuts the grids through it; a second click lets it go.
    fn pin(&self, session: &Session, made: &Made, stage: &Stage, pixel: [usize; 2], asks: &mut Asks) {
        let Some(cell) = self.cell(made, stage, pixel) else { return };
        let pin = Pin { level: 0, cell };
        let new = session.sight.pin != Some(pin);
        asks.ask(Ask::Pin(new.then_some(pin)));
        if new {
            let mut view = session.settings.view.clone();
            view.index = cell[view.axis.across()];
            asks.changed(&session.settings.view, view, |view| Ask::View(Box::new(view)));
        }
    }
}

/// What radiance is multiplied with on the display.
fn exposure(session: &Session, pictures: &Pictures) -> f32 {
    pictures.exposure * session.picture.stops.exp2()
}
