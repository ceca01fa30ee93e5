//! The pictures in numbers: how far each run's is from the truth, with what the truth's own error does to that; and
//! what is under the pointer.

use egui::{Grid, RichText, Ui};

use super::making::{Apart, Bars, Traced};
use super::tiles::Made;
use crate::app::session::Session;
use crate::app::session::comparison::letter;
use crate::app::session::picture::bounces_name;
use crate::app::worker::rival::{Rival, describe};
use crate::field::Cell;
use crate::report::number::short;
use crate::study::picture::Difference;

/// A run's own words.
pub fn run_name(session: &Session, place: usize) -> String {
    let propagation = &session.document.preset.propagation;
    let words = place.checked_sub(1).and_then(|i| session.run.others.get(i)).map(Rival::describe);
    format!("{}  {}", letter(place), words.unwrap_or_else(|| describe(propagation)))
}

/// How good a truth is, in words.
pub fn quality(traced: &Traced) -> String {
    let light = bounces_name(traced.truth.bounces());
    let paths = traced.truth.samples();
    // One batch has no error bar.
    match traced.bars.noise {
        noise if noise > 0.0 => format!("{light}, {paths} paths a pixel, ± {} %", short(100.0 * noise, 2)),
        _ => format!("{light}, {paths} paths a pixel"),
    }
}

/// What is told of a difference, each number with one standard deviation of the truth's where that is known.
pub fn told(difference: &Difference, bars: &Bars) -> [String; 4] {
    let with = |number: f64, bar: f64| match bar > 0.0 {
        true => format!("{} ± {}", short(number, 3), short(bar, 1)),
        false => short(number, 3),
    };
    [
        short(difference.flip, 3),
        with(difference.rmse, bars.rmse),
        with(difference.rel_mse, bars.rel_mse),
        with(difference.mean_ratio, bars.mean_ratio * difference.mean_ratio),
    ]
}

/// A run's numbers, as it is and fitted.
fn numbers(apart: &Apart, bars: &Bars) -> [[String; 5]; 2] {
    let compared = &apart.compared;
    [(&compared.raw, 1.0), (&compared.fitted, compared.scale)].map(|(difference, scale)| {
        let [flip, rmse, rel_mse, ratio] = told(difference, bars);
        [flip, rmse, rel_mse, ratio, short(scale, 3)]
    })
}

/// The table of all runs; a run whose numbers are not known yet keeps their room.
pub fn table(ui: &mut Ui, session: &Session, made: &Made) {
    let apart = |place: usize| made.apart.iter().flat_map(|all| all.iter()).find(|apart| apart.place == place);
    Grid::new("pictures in numbers").num_columns(6).spacing([18.0, 3.0]).striped(true).show(ui, |ui| {
        let heads = [
            ("against the truth", "As it is, and with its indirect light times the one number that fits best"),
            ("FLIP", "The difference that an eye sees, mean over all pixels: 0 alike, 1 as far apart as can be"),
            ("RMSE", "Root of the mean squared error, W/(m²·sr); ± is what a perfect picture would have"),
            ("relMSE", "Mean squared error by the truth's brightness; ± is what a perfect picture would have"),
            ("mean ratio", "The picture's mean over the truth's"),
            ("indirect ×", "What the indirect light is multiplied with"),
        ];
        for (head, about) in heads {
            ui.label(RichText::new(head).small().weak()).on_hover_text(about);
        }
        ui.end_row();
        for place in made.pictures.places() {
            let known = apart(place).zip(made.truth.as_ref());
            let known = known.map(|(apart, traced)| numbers(apart, &traced.bars));
            let names = [run_name(session, place), "    fitted".to_owned()];
            for (name, numbers) in names.into_iter().zip(known.unwrap_or_default()) {
                ui.label(name);
                for number in numbers {
                    ui.label(number);
                }
                ui.end_row();
            }
        }
    });
}

/// What is under the pointer, in a line.
pub fn pixel(made: &Made, [x, y]: [usize; 2], cell: Option<Cell>) -> String {
    let rgb = |pixel: [f32; 3]| pixel.map(|part| short(f64::from(part), 3)).join(" ");
    let mut words = vec![format!("pixel ({x}, {y})")];
    if let Some(truth) = &made.truth
        && let (Some(light), Some(deviation)) = (truth.light.get([x, y]), truth.deviation.get([x, y]))
    {
        let bar = if deviation == [0.0; 3] { String::new() } else { format!(" ± {}", rgb(deviation)) };
        words.push(format!("truth {}{bar}", rgb(light)));
    }
    for run in &made.pictures.runs {
        if let Some(light) = run.light.get([x, y]) {
            words.push(format!("{} {}", letter(run.place), rgb(light)));
        }
    }
    if let Some([x, y, z]) = cell {
        words.push(format!("cell ({x}, {y}, {z})"));
    }
    words.join("  ·  ")
}
