//! The built-in presets, each with a picture and what to look for.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use egui::{
    Align, Context, Id, Label, Layout, Modal, Rect, RichText, ScrollArea, Sense, Shape, TextureHandle, Ui, pos2, vec2,
};

use crate::app::draw::glyphs::meshes;
use crate::app::draw::ink::color;
use crate::app::draw::placing::{Placing, Style};
use crate::app::draw::scales::Scales;
use crate::app::draw::sprites;
use crate::app::draw::style::theme;
use crate::app::session::asides::{Aside, Watch};
use crate::app::session::ask::{Ask, Asks, Next};
use crate::app::session::guide;
use crate::app::session::view::{Fill, View};
use crate::app::worker::cut;
use crate::app::worker::look::{Layer, Light, Look, Of, Pane, Shown, State};
use crate::app::worker::track::Track;
use crate::report::slice::Plane;
use crate::scene::{Problem, builtin};
use crate::simulation::Action;
use crate::study::expectation::{Expectation, References};
use crate::transport::preset;

/// The side of a picture and the width of a card, in points.
const PICTURE: f32 = 120.0;
const CARD: f32 = 380.0;
/// The iterations that a picture shows, and the largest volume that one is made of.
const ITERATIONS: usize = 6;
const LARGEST: usize = 64;

/// The gallery's own state.
pub struct Gallery {
    /// Whether it is seen.
    pub open: bool,
    /// The picture that is being made.
    making: Aside<&'static str, Arc<Shown>>,
    /// Those that are made; `None` where there can be none.
    pictures: HashMap<&'static str, Option<Arc<Shown>>>,
    sprites: Option<TextureHandle>,
}

impl Default for Gallery {
    fn default() -> Self {
        Gallery { open: false, making: Aside::new("pictures of presets"), pictures: HashMap::new(), sprites: None }
    }
}

impl Gallery {
    /// Shows the gallery while it is open.
    pub fn ui(&mut self, ctx: &Context, asks: &mut Asks) {
        if !self.open {
            return;
        }
        self.make(ctx);
        let modal = Modal::new(Id::unique("gallery")).show(ctx, |ui| {
            let room = ui.ctx().content_rect().size();
            ui.set_width((room.x - 80.0).clamp(240.0, 3.0 * (CARD + 16.0)));
            ui.horizontal(|ui| {
                ui.heading("Gallery of presets");
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    if ui.button("Close").clicked() {
                        self.open = false;
                    }
                });
            });
            ScrollArea::vertical().max_height(room.y - 140.0).auto_shrink([false, true]).show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    for (name, text) in builtin::PRESETS {
                        if self.card(ui, name, &guide::of_text(text)) {
                            asks.ask(Ask::Leave(Next::BuiltIn((*name).to_owned())));
                            self.open = false;
                        }
                    }
                });
            });
        });
        self.open &= !modal.should_close();
    }

    /// Makes the pictures one after the other.
    fn make(&mut self, ctx: &Context) {
        // What fails has no picture; opening the preset tells why.
        let failed = self.making.hear(ctx).is_err();
        if let Some((name, shown)) = self.making.latest() {
            self.pictures.insert(name, Some(Arc::clone(shown)));
        }
        let open = |name: &&'static str| !self.pictures.contains_key(*name);
        let Some(next) = builtin::PRESETS.iter().map(|(name, _)| *name).find(open) else { return };
        if failed || self.making.is_given_up(&next) {
            self.pictures.insert(next, None);
            return;
        }
        let begun = self.making.want(&next, ctx, |_| move |_: &Watch| picture(next).map(Arc::new));
        if begun.is_err() {
            self.pictures.insert(next, None);
        }
    }

    /// A preset's picture, name and guide; whether it was chosen.
    fn card(&mut self, ui: &mut Ui, name: &str, guide: &str) -> bool {
        let (rect, response) = ui.allocate_exact_size(vec2(CARD, PICTURE + 12.0), Sense::click());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Open {name}")));
        let visuals = ui.style().interact(&response);
        ui.painter().rect(rect, 4.0, visuals.weak_bg_fill, visuals.bg_stroke, egui::StrokeKind::Inside);
        let frame = Rect::from_min_size(rect.min + vec2(6.0, 6.0), vec2(PICTURE, PICTURE));
        self.picture(ui, name, frame);
        let beside = Rect::from_min_max(pos2(frame.right() + 8.0, rect.top() + 6.0), rect.max - vec2(6.0, 6.0));
        let mut beside = ui.new_child(egui::UiBuilder::new().max_rect(beside).layout(Layout::top_down(Align::LEFT)));
        beside.set_clip_rect(rect.intersect(ui.clip_rect()));
        beside.label(RichText::new(name).strong());
        beside.add(Label::new(RichText::new(guide).small()).wrap().selectable(false));
        response.on_hover_text(guide).clicked()
    }

    fn picture(&mut self, ui: &Ui, name: &str, frame: Rect) {
        let theme = theme(ui.ctx());
        let painter = ui.painter_at(frame);
        painter.rect_filled(frame, 2.0, color(theme.ground));
        let Some(Some(shown)) = self.pictures.get(name).cloned() else { return };
        let view = View { cells: false, flux: false, fill: Fill::Frame, ..View::default() };
        let scales = Scales::of(&view, std::slice::from_ref(shown.as_ref()));
        let sprites = self.sprites.get_or_insert_with(|| sprites::texture(ui.ctx())).id();
        let style =
            Style { view: &view, paint: scales.paint(&view), scale: scales.scale(&shown), theme: &theme, sprites };
        let cell = frame.width() / shown.slice.side.max(1) as f32;
        let placing = Placing { clip: frame, origin: frame.left_bottom(), cell, density: ui.pixels_per_point() };
        painter.extend(meshes(&shown, &style, &placing).map(Shape::mesh));
    }
}

/// The merged light of a preset after a few iterations, cut where most is injected.
fn picture(name: &str) -> Result<Shown, String> {
    let text = builtin::find(name).unwrap_or_default();
    let preset = preset::parse(text, Path::new(name)).map_err(|error| error.to_string())?;
    if preset.size > LARGEST {
        return Err(format!("{name} is too large for a picture in passing"));
    }
    let folder = builtin::folder().map_err(|error| error.to_string())?;
    let problem = Problem::build(&preset, &folder).map_err(|error| error.to_string())?;
    let axis = View::default().axis;
    let plane = Plane { axis, index: problem.brightest_slab(axis.across()) };
    let mut track = Track::new(problem, 0).map_err(|error| error.to_string())?;
    let steps = std::iter::repeat_n(Action::Propagate, ITERATIONS.min(preset.propagation.iterations));
    for action in [Action::Inject, Action::Downsample].into_iter().chain(steps) {
        track.act(action);
    }
    let state = State { of: Of::Track(0), iteration: None };
    let pane = Pane { light: Light::Accumulated, state, minus: None };
    let look = Look {
        panes: vec![pane],
        layer: Layer::Merged,
        plane,
        against: Expectation::default(),
        brightest: Default::default(),
        cloud: None,
    };
    let shown = cut::panes(&mut [track], &References::default(), 0, &look).pop();
    shown.ok_or_else(|| format!("{name} shows nothing"))
}
