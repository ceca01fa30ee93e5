//! A cell's numbers: the pinned one with its lobe, what its neighbours sent it and its course over the iterations; the
//! one under the pointer in a line, or in its place where none is pinned.

mod received;

use egui::{Grid, RichText, ScrollArea, Sense, Ui, vec2};
use egui_plot::{Line, LineStyle, Plot, PlotPoints, VLine};

use super::field::name;
use super::legend::number;
use super::slices::under_pointer;
use crate::app::draw::axis::iterations_apart;
use crate::app::draw::ball::{self, Turn};
use crate::app::draw::grids::Pointed;
use crate::app::draw::ink::color;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::worker::look::{Of, Pane, Pin, PinSample, Shown, State};
use crate::report::colour::Theme;
use crate::sh::Sh;
use crate::study::error::CellError;
use crate::study::expectation::Expectation;

/// The side of the enlarged lobe, in points.
const LOBE: f32 = 132.0;

/// The panel; `pointed` is where the pointer is in the views, `turn` how the lobe is seen.
pub fn ui(ui: &mut Ui, session: &Session, pointed: Option<Pointed>, turn: &mut Turn, theme: &Theme, asks: &mut Asks) {
    let hovered = under_pointer(session, pointed);
    let Some(pin) = session.sight.pin else {
        match hovered {
            Some((shown, i)) => {
                let cell = &shown.slice.cells[i];
                head(ui, &title(shown, i));
                numbers(ui, cell.light, shown.errors.get(i).copied().flatten(), session.against());
            }
            None => {
                head(ui, "Cell");
                let hint = "Point at a cell for its numbers; click it to pin it and see its lobe, what its neighbours \
                            sent it, and its course.";
                ui.label(RichText::new(hint).weak());
            }
        }
        return;
    };
    ui.horizontal(|ui| {
        head(ui, &format!("Pinned {}", place(pin)));
        if ui.small_button("✖").on_hover_text("Let the cell go").accessible_name("Unpin").clicked() {
            asks.ask(Ask::Pin(None));
        }
    });
    // A line that is always there, so that nothing below it moves.
    let line = hovered.map(|(shown, i)| {
        let [red, green, blue] = shown.slice.cells[i].light;
        format!("{}: c00 = {}", title(shown, i), number((red + green + blue).0[0] / 3.0))
    });
    ui.add(egui::Label::new(RichText::new(line.unwrap_or_default()).small()).truncate());
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| pinned(ui, session, turn, theme));
}

/// What is known of the pinned cell.
fn pinned(ui: &mut Ui, session: &Session, turn: &mut Turn, theme: &Theme) {
    let seen = session.seen();
    let pinned = &session.sight.pinned;
    let Some(sample) = pinned.iter().rev().find(|sample| sample.iteration <= seen) else { return };
    lobe(ui, session.settings.view.hue.of(sample.accumulated), turn, theme);
    numbers(ui, sample.accumulated, None, Expectation::Thesis);
    received::ui(ui, session, sample);
    course(ui, pinned, seen, theme);
}

/// The lobe of S_A, to be turned by dragging.
fn lobe(ui: &mut Ui, light: Sh<f32>, turn: &mut Turn, theme: &Theme) {
    let (rect, response) = ui.allocate_exact_size(vec2(LOBE, LOBE), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Lobe of the pinned cell"));
    if response.dragged() {
        *turn = turn.dragged(response.drag_delta());
    }
    if response.double_clicked() {
        *turn = Turn::default();
    }
    response.on_hover_text("S_A in this cell, as large as fits: drag to turn, double-click to turn back");
    ball::draw(&ui.painter_at(rect), rect, light, *turn, theme);
}

/// Which light of which cell.
fn title(shown: &Shown, i: usize) -> String {
    let cell = &shown.slice.cells[i];
    let what = match shown.pane {
        Pane { minus: Some(_), .. } => "Difference",
        Pane { state: State { of: Of::Truth, .. }, .. } => "What truly arrives",
        Pane { light, .. } => light.name(),
    };
    format!("{what} {}", place(Pin { level: cell.level, cell: cell.cell }))
}

fn head(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).strong());
}

fn place(Pin { level, cell: [x, y, z] }: Pin) -> String {
    format!("({x}, {y}, {z}), level {level}")
}

/// The coefficients of each colour, the flux and the error.
fn numbers(ui: &mut Ui, light: [Sh<f32>; 3], error: Option<CellError>, against: Expectation) {
    let [red, green, blue] = light;
    let colours: Vec<(&str, Sh<f32>)> = match red == green && green == blue {
        true => vec![("white", red)],
        false => vec![("red", red), ("green", green), ("blue", blue)],
    };
    ui.spacing_mut().item_spacing.y = 2.0;
    Grid::new("coefficients").num_columns(5).spacing([8.0, 1.0]).show(ui, |ui| {
        ui.label("");
        ["c00", "c1-1", "c10", "c11"].into_iter().for_each(|name| drop(ui.small(name)));
        ui.end_row();
        for (name, light) in colours {
            ui.small(name);
            let small = |text: String| RichText::new(text).monospace().size(11.0);
            light.to_basis().into_iter().for_each(|c| drop(ui.label(small(number(c)))));
            ui.end_row();
        }
    });
    let flux = (red + green + blue).widen().direction();
    // Rounded first: a part that is shown as zero has no sign.
    let part = |c: f64| (c * 100.0).round() / 100.0 + 0.0;
    let towards = flux.map_or("none".to_owned(), |d| format!("({}, {}, {})", part(d.x), part(d.y), part(d.z)));
    ui.label(format!("flux towards {towards}"));
    if let Some(error) = error {
        let relative = error.relative.map_or("undefined".to_owned(), |relative| format!("{:.2} %", relative * 100.0));
        ui.label(format!("error {} ({relative}) against {}", number(error.absolute as f32), against.against()));
    }
}

/// c00 over the iterations.
fn course(ui: &mut Ui, samples: &[PinSample], seen: usize, theme: &Theme) {
    let mean = |light: [Sh<f32>; 3]| f64::from(light.iter().map(|sh| sh.0[0]).sum::<f32>() / 3.0);
    let curve = |of: fn(&PinSample) -> [Sh<f32>; 3]| -> Vec<[f64; 2]> {
        samples.iter().map(|sample| [sample.iteration as f64, mean(of(sample))]).collect()
    };
    let accumulated =
        Line::new("S_A", PlotPoints::new(curve(|sample| sample.accumulated))).color(color(theme.curve(0)));
    let source = Line::new("S_k", PlotPoints::new(curve(|sample| sample.source))).color(color(theme.curve(1)));
    let plot = Plot::new("course of the pinned cell")
        .height(ui.available_height().clamp(90.0, 180.0))
        .include_y(0.0)
        .allow_scroll(false)
        .legend(egui_plot::Legend::default().position(egui_plot::Corner::LeftTop).background_alpha(0.5))
        .x_grid_spacer(iterations_apart)
        .grid_color(color(theme.grid))
        .label_formatter(|position| match position {
            egui_plot::HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}, k = {:.0}: c00 = {:.4e}", position.x, position.y))
            }
            egui_plot::HoverPosition::Elsewhere { .. } => None,
        });
    let response = plot.show(ui, |plot| {
        plot.line(accumulated.width(1.6));
        plot.line(source.width(1.6).style(LineStyle::dashed_loose()));
        plot.vline(VLine::new("", seen as f64).color(color(theme.muted)).width(1.0).allow_hover(false));
    });
    name(&response.response, "c00 of the pinned cell over the iterations");
}
