//! Questions put to the light: whether a port is right. Its dumps and the verdict to the left, its grids beside the
//! right ones and the difference in the middle.

use std::sync::Arc;

use egui::{CentralPanel, Context, Frame, Margin, Panel, Ui};

use super::Panels;
use crate::app::draw::grids::{Grids, Manner};
use crate::app::draw::scales::Scales;
use crate::app::draw::style::theme;
use crate::app::panels::port;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::port::{Answer, Sight};
use crate::app::session::view::View;
use crate::app::worker::look::{Light, Of, Pane, Shown, State};
use crate::report::colour::Paint;

/// The workspace's own state.
#[derive(Default)]
pub struct Study {
    grids: Grids,
    /// What is shown, of which answer and where.
    shown: Option<(Arc<Answer>, Sight, Vec<Shown>)>,
    /// The answer whose first wrong cell was shown.
    seen: Option<Arc<Answer>>,
}

impl Panels for Study {
    fn logic(&mut self, _ctx: &Context, session: &Session, asks: &mut Asks) {
        let Some(answer) = session.answer() else { return };
        // A new verdict shows its first wrong cell.
        if !self.seen.as_ref().is_some_and(|seen| Arc::ptr_eq(seen, answer)) {
            self.seen = Some(Arc::clone(answer));
            let port = crate::app::session::port::Port { sight: answer.start(), ..session.port.clone() };
            asks.ask(Ask::Port(Box::new(port)));
        }
    }

    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        let answer = session.answer();
        Panel::left("port").default_size(360.0).size_range(240.0..=640.0).show(ui, |ui| {
            port::files(ui, session, asks);
            ui.separator();
            match answer {
                Some(answer) => port::verdict(ui, answer, asks),
                None => {
                    ui.label(session.port_is_waiting_for());
                }
            }
        });
        let ground = Frame::central_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        CentralPanel::default().frame(ground).show(ui, |ui| {
            let Some(answer) = answer else { return port::steps(ui) };
            port::sight(ui, session, answer, asks);
            self.side_by_side(ui, session, answer);
        });
    }
}

impl Study {
    fn side_by_side(&mut self, ui: &mut Ui, session: &Session, answer: &Arc<Answer>) {
        let sight = session.port.sight;
        let known = self.shown.as_ref().is_some_and(|(of, at, _)| Arc::ptr_eq(of, answer) && *at == sight);
        if !known {
            let Some(slices) = answer.slices(sight) else { return };
            let state = State { of: Of::Track(0), iteration: None };
            let shown = slices.into_iter().enumerate().map(|(i, slice)| Shown {
                pane: Pane { light: Light::Source, state, minus: (i == 2).then_some(state) },
                iteration: answer.grids.get(sight.dump).map_or(0, |grid| grid.iteration),
                forgotten: false,
                slice: Arc::new(slice),
                of_run: None,
                errors: Vec::new(),
                index: Vec::new(),
                occupied: Vec::new(),
            });
            self.shown = Some((Arc::clone(answer), sight, shown.collect()));
        }
        let Some((_, _, shown)) = &self.shown else { return };
        let view = View { paint: Paint::Direction, levels: false, occluders: false, ..session.settings.view.clone() };
        let (theme, scales) = (theme(ui.ctx()), Scales::of(&view, shown));
        let manner = Manner {
            view: &view,
            theme: &theme,
            scales: &scales,
            paint: view.paint,
            marks: &[],
            between: &[],
            marks_cells: false,
        };
        let titles = ["As it should be", "The port's", "The difference"].map(str::to_owned);
        self.grids.ui(ui, shown, &titles, &manner);
    }
}
