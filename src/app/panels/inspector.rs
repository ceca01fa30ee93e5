//! A cell's numbers: the one under the pointer, else the pinned one with its curve over the iterations.

use egui::{Grid, RichText, Ui};
use egui_plot::{Line, LineStyle, Plot, PlotPoints, VLine};

use super::field::name;
use super::legend::number;
use super::slices::under_pointer;
use crate::app::draw::axis::iterations_apart;
use crate::app::draw::grids::Pointed;
use crate::app::draw::ink::color;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::worker::look::{Of, Pane, Pin, PinSample, State};
use crate::report::colour::Theme;
use crate::sh::Sh;
use crate::study::error::CellError;
use crate::study::expectation::Expectation;

/// The panel; `pointed` is where the pointer is in the views.
pub fn ui(ui: &mut Ui, session: &Session, pointed: Option<Pointed>, theme: &Theme, asks: &mut Asks) {
    if let Some((shown, i)) = under_pointer(session, pointed) {
        let cell = &shown.slice.cells[i];
        let what = match shown.pane {
            Pane { minus: Some(_), .. } => "Difference",
            Pane { state: State { of: Of::Truth, .. }, .. } => "What truly arrives",
            Pane { light, .. } => light.name(),
        };
        head(ui, &format!("{what} {}", place(Pin { level: cell.level, cell: cell.cell })));
        numbers(ui, cell.light, shown.errors.get(i).copied().flatten(), session.against());
        return;
    }
    let Some(pin) = session.sight.pin else {
        head(ui, "Cell");
        ui.label(RichText::new("Point at a cell for its numbers; click it to pin it and see its course.").weak());
        return;
    };
    ui.horizontal(|ui| {
        head(ui, &format!("Pinned {}", place(pin)));
        if ui.small_button("✖").on_hover_text("Let the cell go").accessible_name("Unpin").clicked() {
            asks.ask(Ask::Pin(None));
        }
    });
    let seen = session.seen();
    let pinned = &session.sight.pinned;
    let Some(sample) = pinned.iter().rev().find(|sample| sample.iteration <= seen) else { return };
    numbers(ui, sample.accumulated, None, Expectation::Thesis);
    course(ui, pinned, seen, theme);
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
        .height(ui.available_height().max(48.0))
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
