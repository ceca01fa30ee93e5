//! How light travels: grids side by side, compared, or in space, with the plots and a cell's numbers below.

use egui::{CentralPanel, Frame, Margin, Panel, Ui};

use super::Panels;
use crate::app::draw::ball::Turn;
use crate::app::draw::grids::{Grids, Pointed};
use crate::app::draw::scales::Scales;
use crate::app::draw::space::{Marks, Space};
use crate::app::draw::style::theme;
use crate::app::panels::button::fold_button;
use crate::app::panels::{guide, inspector, legend, notice, plots, runs, slices, space, view_bar};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::plots::Tab;
use crate::app::session::view::{Stage, View};
use crate::report::colour::Theme;

/// The height from which the plots have a size of their own, in points.
const TALL: f32 = 950.0;
/// The height from which there is room for what to look for, in points.
const SHORT: f32 = 560.0;
/// The width from which a cell's numbers stand beside the views, in points.
const WIDE: f32 = 1250.0;

/// The workspace's own state.
#[derive(Default)]
pub struct Light {
    grids: Grids,
    space: Space,
    /// The scales of what is shown, with what they belong to.
    scales: Option<(View, u64, Scales)>,
    pointed: Option<Pointed>,
    /// How the pinned cell's lobe is seen.
    turn: Turn,
}

impl Panels for Light {
    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        let (width, height) = (ui.available_width(), ui.available_height());
        let theme = theme(ui.ctx());
        // A wide window has room for a cell's numbers from top to bottom, a narrow one beside the plots.
        let beside = width > WIDE;
        if beside {
            Panel::right("inspector, tall").default_size(330.0).size_range(280.0..=480.0).show(ui, |ui| {
                inspector::ui(ui, session, self.pointed, &mut self.turn, &theme, asks);
            });
        }
        if session.settings.folds.plots(session.size) {
            Panel::bottom("plots, folded").exact_size(24.0).resizable(false).show(ui, |ui| {
                ui.horizontal(|ui| {
                    fold_button(ui, "⏶", Command::FoldPlots, asks);
                    ui.weak("Errors, line and run time");
                });
            });
        } else {
            // A taller window has more to give to both, but glyphs need the most. What a window was given while it
            // was small is not what it is to have on a whole screen.
            let room = (height * 0.36).max(200.0);
            let name = if height > TALL { "errors, tall" } else { "errors" };
            Panel::bottom(name).default_size(room).size_range(90.0..=700.0).resizable(true).show(ui, |ui| {
                // The panel keeps its size where there is nothing to plot yet.
                ui.set_min_height(ui.available_height());
                plots::bar(ui, session, asks);
                if !beside {
                    Panel::right("inspector").exact_size(312.0).resizable(false).show(ui, |ui| {
                        inspector::ui(ui, session, self.pointed, &mut self.turn, &theme, asks);
                    });
                }
                plots::ui(ui, session, asks);
            });
        }
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
            if session.size.y > SHORT {
                guide::ui(ui, session, asks);
            }
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
            let line = (session.settings.plots.tab == Tab::Line).then(|| session.line_ends());
            let marks = Marks { pin: session.sight.pin, line };
            let lobes = session.sight.space.lobes;
            if let Some(pin) = self.space.ui(ui, cloud, lobes, &session.settings.view, &marks, theme) {
                asks.ask(Ask::Pin((session.sight.pin != Some(pin)).then_some(pin)));
            }
        }
    }
}
