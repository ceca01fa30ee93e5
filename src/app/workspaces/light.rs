//! How light travels: grids side by side, compared, or in space, with the plots and a cell's numbers below.

use egui::{CentralPanel, Frame, Margin, Panel, Ui};

use super::Panels;
use crate::app::draw::glyphs::Scales;
use crate::app::draw::grids::{Grids, Pointed};
use crate::app::draw::space::Space;
use crate::app::draw::style::theme;
use crate::app::panels::{inspector, legend, notice, plots, runs, slices, space, view_bar};
use crate::app::session::Session;
use crate::app::session::ask::Asks;
use crate::app::session::view::{Stage, View};
use crate::report::colour::Theme;

/// The height from which the plots have a size of their own, in points.
const TALL: f32 = 950.0;

/// The workspace's own state.
#[derive(Default)]
pub struct Light {
    grids: Grids,
    space: Space,
    /// The scales of what is shown, with what they belong to.
    scales: Option<(View, u64, Scales)>,
    pointed: Option<Pointed>,
}

impl Panels for Light {
    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        // A taller window has more to give to both, but glyphs need the most. What a window was given while it was
        // small is not what it is to have on a whole screen.
        let height = ui.available_height();
        let room = (height * 0.36).max(200.0);
        let name = if height > TALL { "errors, tall" } else { "errors" };
        Panel::bottom(name).default_size(room).size_range(90.0..=700.0).resizable(true).show(ui, |ui| {
            plots::bar(ui, session, asks);
            let theme = theme(ui.ctx());
            Panel::right("inspector").exact_size(292.0).resizable(false).show(ui, |ui| {
                inspector::ui(ui, session, self.pointed, &theme, asks);
            });
            plots::ui(ui, session);
        });
        Panel::top("view").show(ui, |ui| view_bar::ui(ui, session, asks));
        let ground = Frame::central_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        CentralPanel::default().frame(ground).show(ui, |ui| self.stage(ui, session, asks));
    }
}

impl Light {
    /// Shows every slice whole again.
    pub fn whole(&mut self) {
        self.grids.whole();
    }

    /// Forgets what was drawn.
    pub fn redraw(&mut self) {
        self.grids.redraw();
        self.scales = None;
    }

    fn stage(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        notice::fault(ui, session, asks);
        let theme = theme(ui.ctx());
        let scales = self.scales(session);
        Panel::bottom("legend").show_separator_line(false).frame(Frame::NONE).show(ui, |ui| {
            legend::ui(ui, &session.settings.view, &scales, &session.sight.shown, &theme);
        });
        match session.settings.view.stage {
            Stage::Grids => self.flat(ui, session, &theme, &scales, asks),
            Stage::Compare => {
                runs::bar(ui, session, asks);
                self.flat(ui, session, &theme, &scales, asks);
            }
            Stage::Space => self.space(ui, session, &theme, &scales, asks),
        }
    }

    /// The views' scales, found anew when the light or the way of looking changes.
    fn scales(&mut self, session: &Session) -> Scales {
        let (view, edition) = (&session.settings.view, session.sight.edition);
        match &self.scales {
            Some((known, of, scales)) if known == view && *of == edition => *scales,
            _ => {
                let scales = Scales::of(view, &session.sight.shown);
                self.scales = Some((view.clone(), edition, scales));
                scales
            }
        }
    }

    fn flat(&mut self, ui: &mut Ui, session: &Session, theme: &Theme, scales: &Scales, asks: &mut Asks) {
        self.pointed = slices::ui(ui, session, &mut self.grids, scales, theme, self.pointed, asks);
    }

    /// The light in space, with the slice beside it.
    fn space(&mut self, ui: &mut Ui, session: &Session, theme: &Theme, scales: &Scales, asks: &mut Asks) {
        space::bar(ui, session, asks);
        let side = ui.available_height().min(ui.available_width() * 0.4);
        Panel::right("slice beside").show_separator_line(false).exact_size(side).frame(Frame::NONE).show(ui, |ui| {
            self.flat(ui, session, theme, scales, asks);
        });
        if let Some(cloud) = &session.sight.cloud {
            self.space.ui(ui, cloud, session.sight.space.lobes, &session.settings.view, theme);
        }
    }
}
