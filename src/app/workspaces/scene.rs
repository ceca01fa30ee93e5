//! The scene as a mesh in space, with its lights: moved by numbers or by their handles, their shadow maps below. The
//! light of the run lies over the mesh, and follows a light while it is dragged.

mod handles;

use std::path::PathBuf;
use std::sync::Arc;

use egui::{
    CentralPanel, Color32, ColorImage, Context, DragValue, Frame, Image, Panel, Rect, Sense, TextureHandle,
    TextureOptions, Ui, vec2,
};

use super::Panels;
use crate::app::draw::space::{Eye, Projection};
use crate::app::draw::stage::{Light, Shown, picture};
use crate::app::draw::style::theme;
use crate::app::panels::field::{self, name};
use crate::app::panels::mesh_scene;
use crate::app::session::Session;
use crate::app::session::asides::{Aside, Watch};
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::view::View;
use crate::app::worker::look::Cloud;
use crate::report::colour::Theme;
use crate::report::shadow_map::{self, Aspect};
use crate::scene::Stage;
use crate::scene::mesh_scene::MeshScene;
use crate::scene::shadow_map::ShadowMap;
use crate::scene::stage::Cache;

/// What a scene is made from.
type Wanted = (MeshScene, usize, PathBuf);

/// The workspace's own state.
pub struct Scene {
    stage: Aside<Wanted, Arc<Stage>>,
    cache: Arc<Cache>,
    /// Why there is no scene.
    fault: Option<String>,
    eye: Eye,
    shown: Shown,
    /// The picture in view with what it shows.
    drawn: Option<(Drawn, TextureHandle)>,
    aspect: Aspect,
    maps: Vec<(Arc<ShadowMap>, Aspect, TextureHandle)>,
}

/// Everything that the picture depends on.
#[derive(Clone)]
struct Drawn {
    stage: Arc<Stage>,
    /// The light over the mesh, where it is shown.
    cloud: Option<Arc<Cloud>>,
    lobes: bool,
    view: View,
    eye: Eye,
    shown: Shown,
    size: [usize; 2],
    dark: bool,
}

impl PartialEq for Drawn {
    fn eq(&self, other: &Self) -> bool {
        let same_light = match (&self.cloud, &other.cloud) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) && self.view == other.view && self.lobes == other.lobes,
            (a, b) => a.is_none() && b.is_none(),
        };
        Arc::ptr_eq(&self.stage, &other.stage)
            && same_light
            && (self.eye, self.shown, self.size, self.dark) == (other.eye, other.shown, other.size, other.dark)
    }
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            stage: Aside::new("scene"),
            cache: Arc::default(),
            fault: None,
            eye: Eye::default(),
            shown: Shown::default(),
            drawn: None,
            aspect: Aspect::Flux,
            maps: Vec::new(),
        }
    }
}

impl Panels for Scene {
    fn logic(&mut self, ctx: &Context, session: &Session, _asks: &mut Asks) {
        if let Err(line) = self.stage.hear(ctx) {
            self.fault = Some(line);
        }
        let preset = &session.document.preset;
        let Some(scene) = &preset.scene else { return };
        let wanted = (scene.clone(), preset.size, session.document.folder());
        if self.stage.known(&wanted).is_some() {
            self.fault = None;
            return;
        }
        let (key, cache) = (wanted.clone(), Arc::clone(&self.cache));
        let work = |_: Option<(&Wanted, &Arc<Stage>)>| {
            move |watch: &Watch| {
                let (scene, size, folder) = wanted;
                let mut progress = |share: f64| {
                    watch.go_on(share);
                };
                let stage = Stage::new(&scene, size, &folder, &cache, &mut progress);
                stage.map(Arc::new).map_err(|error| error.to_string())
            }
        };
        if let Err(line) = self.stage.want(&key, ctx, work) {
            self.fault = Some(line);
        }
    }

    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        let has_mesh = session.document.preset.scene.is_some();
        let stage = self.stage.latest().filter(|_| has_mesh).map(|(_, stage)| Arc::clone(stage));
        Panel::right("mesh scene").exact_size(300.0).resizable(false).show(ui, |ui| {
            mesh_scene::ui(ui, session, stage.as_deref(), asks);
        });
        if let Some(stage) = stage.as_ref().filter(|stage| !stage.maps.is_empty()) {
            Panel::bottom("shadow maps").default_size(190.0).size_range(90.0..=500.0).resizable(true).show(ui, |ui| {
                self.maps(ui, stage);
            });
        }
        Panel::top("scene view").show(ui, |ui| self.bar(ui, session, asks));
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| match &stage {
            Some(stage) => self.space(ui, session, stage, asks),
            None if self.fault.is_none() && has_mesh => {
                ui.centered_and_justified(|ui| ui.label("Reading the mesh…"));
            }
            None if has_mesh => {}
            None => mesh_scene::missing(ui, session, asks),
        });
    }
}

impl Scene {
    /// Whether the scene is as it was asked for.
    pub fn is_idle(&self) -> bool {
        !self.stage.is_underway()
    }

    fn bar(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        let mut look = session.sight.space;
        ui.horizontal_wrapped(|ui| {
            let Shown { mesh, backs, emitters, cells } = &mut self.shown;
            ui.checkbox(mesh, "Mesh");
            ui.checkbox(backs, "Backs").on_hover_text("Triangles that face away too: they may hide what is inside");
            ui.checkbox(emitters, "Virtual point lights");
            ui.checkbox(cells, "Occupied cells");
            ui.separator();
            ui.checkbox(&mut look.over_mesh, "Light").on_hover_text("The light of the run in its cells, over the mesh");
            if look.over_mesh {
                ui.selectable_value(&mut look.lobes, false, "Cubes");
                ui.selectable_value(&mut look.lobes, true, "Lobes");
                let threshold = DragValue::new(&mut look.threshold).range(0.0..=1.0).speed(0.001).max_decimals(4);
                let about = "The share of the strongest light below which cells are left out";
                name(&field::add(ui, threshold.prefix("from ")).on_hover_text(about), "Threshold");
            }
            if let Some(stage) = self.stage.latest().map(|(_, stage)| Arc::clone(stage))
                && session.document.preset.scene.is_some()
            {
                let about = "The picture's camera stands where this view is seen from";
                if ui.button("Camera here").on_hover_text(about).clicked() {
                    handles::camera_here(session, &stage, &self.eye, asks);
                }
            }
            if let Some(share) = self.stage.share() {
                ui.spinner();
                ui.label(format!("{:.0} %", 100.0 * share));
            }
            if let Some(fault) = &self.fault {
                ui.colored_label(ui.visuals().error_fg_color, fault);
            }
        });
        asks.changed(&session.sight.space, look, Ask::Space);
    }

    /// The mesh in space, with the light of its cells and what can be taken by the hand.
    fn space(&mut self, ui: &mut Ui, session: &Session, stage: &Arc<Stage>, asks: &mut Asks) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "View: the mesh in space"));
        self.eye.steer(ui, rect, &response);
        let theme = theme(ui.ctx());
        let look = session.sight.space;
        let cloud = session.sight.cloud.as_ref().filter(|_| look.over_mesh).map(Arc::clone);
        let drawn = Drawn {
            stage: Arc::clone(stage),
            cloud,
            lobes: look.lobes,
            view: session.settings.view.clone(),
            eye: self.eye,
            shown: self.shown,
            size: [rect.width().max(1.0) as usize, rect.height().max(1.0) as usize],
            dark: theme.dark,
        };
        let painter = ui.painter_at(rect);
        let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        painter.image(self.texture(ui, drawn, &theme), rect, whole, Color32::WHITE);
        let projection = Projection::new(&self.eye, rect, stage.placement.size);
        handles::frame(&painter, &projection, stage.placement.size as f32, &theme);
        let (painter, projection) = (&painter, &projection);
        let handles = handles::Handles { ui, painter, session, stage, eye: &self.eye, projection, theme: &theme };
        handles.camera(asks);
        handles.lights(asks);
    }

    /// The picture of what is drawn, made anew where that has changed.
    fn texture(&mut self, ui: &Ui, drawn: Drawn, theme: &Theme) -> egui::TextureId {
        if let Some((known, texture)) = &self.drawn
            && *known == drawn
        {
            return texture.id();
        }
        let light = drawn.cloud.as_ref().map(|cloud| Light { cloud, view: &drawn.view, lobes: drawn.lobes });
        let image = picture(&drawn.stage, light, &drawn.eye, drawn.size, drawn.shown, theme);
        let texture = ui.ctx().load_texture("scene", image, TextureOptions::LINEAR);
        let id = texture.id();
        self.drawn = Some((drawn, texture));
        id
    }

    /// The shadow map of every light.
    fn maps(&mut self, ui: &mut Ui, stage: &Stage) {
        ui.horizontal(|ui| {
            ui.label("Shadow maps");
            for aspect in Aspect::ALL {
                ui.selectable_value(&mut self.aspect, aspect, aspect.name());
            }
        });
        self.maps.retain(|(map, aspect, _)| *aspect == self.aspect && stage.maps.iter().any(|m| Arc::ptr_eq(m, map)));
        ui.set_min_height(ui.available_height());
        let height = (ui.available_height() - 22.0).max(40.0);
        egui::ScrollArea::horizontal().show(ui, |ui| {
            ui.horizontal(|ui| {
                for (i, map) in stage.maps.iter().enumerate() {
                    let known = self.maps.iter().position(|(known, _, _)| Arc::ptr_eq(known, map));
                    let known = known.unwrap_or_else(|| {
                        let picture = shadow_map::picture(map, self.aspect);
                        let size = [picture.width() as usize, picture.height() as usize];
                        let image = ColorImage::from_rgb(size, picture.as_raw());
                        let texture = ui.ctx().load_texture(format!("map {i}"), image, TextureOptions::NEAREST);
                        self.maps.push((Arc::clone(map), self.aspect, texture));
                        self.maps.len() - 1
                    });
                    let texture = &self.maps[known].2;
                    let size = texture.size_vec2();
                    let size = vec2(height * size.x / size.y.max(1.0), height);
                    let alt = format!("Shadow map of light {}: {}", i + 1, self.aspect.name());
                    ui.add(Image::new((texture.id(), size)).alt_text(&alt)).on_hover_text(alt);
                }
            });
        });
    }
}
