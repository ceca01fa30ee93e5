//! The dumps of a port, what they are dumps of, and what is told of them.

use egui::{ComboBox, DragValue, RichText, ScrollArea, Slider, Ui};

use super::button::small_button;
use super::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::port::{Answer, Port};
use crate::app::session::purpose::Purpose;
use crate::report::slice::Axis;
use crate::scene::Preset;
use crate::study::identify::files::{LATEST, Role};
use crate::study::identify::verdict::Judgement;

/// The patterns to choose from.
const PATTERNS: [(Option<&str>, &str); 3] =
    [(Some("spaced"), "spaced"), (Some("dense"), "dense"), (None, "a scene of its own")];

/// How it is found out, before there is anything to look at.
pub fn steps(ui: &mut Ui) {
    ui.add_space(24.0);
    ui.heading("Is my port right?");
    ui.add_space(8.0);
    let steps = [
        "Write what to inject: `lpv-lab pattern spaced --size 32 --out pattern.h` (also .csv and .npy).",
        "Have your renderer inject it in place of its lights, without occluders, and dump its grid: once injected \
         (s0.npy) and after one iteration (s1.npy). Later iterations tell more.",
        "Drop the dumps on this window. The order of axes and coefficients, signs and scales are found out.",
        "Read to the left what the port does otherwise, with the line of a shader that would; here its grid stands \
         beside the right one and their difference, at the first cell that is wrong.",
    ];
    for (i, step) in steps.iter().enumerate() {
        ui.horizontal_top(|ui| {
            ui.label(egui::RichText::new(format!("{}.", i + 1)).strong());
            ui.add(egui::Label::new(*step).wrap());
        });
        ui.add_space(6.0);
    }
}

/// The list of dumps.
pub fn files(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut port = session.port.clone();
    ui.horizontal_wrapped(|ui| {
        ui.label("Injected");
        let chosen = PATTERNS.iter().find(|(pattern, _)| *pattern == port.question.pattern).map_or("", |p| p.1);
        let combo = ComboBox::from_id_salt("injected pattern").selected_text(chosen).show_ui(ui, |ui| {
            for (pattern, words) in PATTERNS {
                ui.selectable_value(&mut port.question.pattern, pattern, words);
            }
        });
        name(&combo.response, "Injected pattern");
        if ui.button("Add dump…").clicked() {
            asks.ask(Ask::Choose(Purpose::Dump));
        }
    });
    if port.question.files.is_empty() {
        ui.label(
            "Drop the dumps of a port here: its grid after injection (s0.npy), after iteration 1 (s1.npy), and later \
             ones (s2.npy, a4.npy). `lpv-lab pattern spaced --out pattern.h` writes what to inject.",
        );
    }
    let mut gone = None;
    for (i, (path, role)) in port.question.files.iter_mut().enumerate() {
        ui.push_id(("dump", i), |ui| {
            ui.horizontal(|ui| {
                role_of(ui, role);
                if small_button(ui, "✖", "Remove dump").clicked() {
                    gone = Some(i);
                }
                let file = path.file_name().map_or(String::new(), |file| file.to_string_lossy().into_owned());
                ui.label(file).on_hover_text(path.display().to_string());
            });
        });
    }
    if let Some(i) = gone {
        port.question.files.remove(i);
    }
    asks.changed(&session.port, port, |port| Ask::Port(Box::new(port)));
}

fn role_of(ui: &mut Ui, role: &mut Role) {
    let (mut kind, mut iteration) = match *role {
        Role::Injected => (0, 1),
        Role::Source(k) => (1, k),
        Role::Accumulated(k) => (2, k),
    };
    let kinds = ["injected", "source", "accumulated"];
    let combo = ComboBox::from_id_salt("role").selected_text(kinds[kind]).width(96.0).show_ui(ui, |ui| {
        for (i, words) in kinds.into_iter().enumerate() {
            ui.selectable_value(&mut kind, i, words);
        }
    });
    name(&combo.response, "Kind of dump");
    if kind > 0 {
        let field = ui.add(DragValue::new(&mut iteration).range(1..=LATEST).prefix("k = "));
        name(&field, "Iteration of the dump");
    }
    *role = match kind {
        0 => Role::Injected,
        1 => Role::Source(iteration),
        _ => Role::Accumulated(iteration),
    };
}

/// What is told of the port.
pub fn verdict(ui: &mut Ui, answer: &Answer, asks: &mut Asks) {
    let [first, rest @ ..] = &answer.lines[..] else { return };
    let color = match answer.verdict.judgement {
        Judgement::Correct => ui.visuals().text_color(),
        Judgement::Mistakes | Judgement::Unknown => ui.visuals().warn_fg_color,
    };
    ui.label(RichText::new(first).strong().color(color));
    if let Some(preset) = answer.corrected()
        && ui
            .button("Open the corrected preset")
            .on_hover_text("The pattern under the scheme, without the mistakes")
            .clicked()
    {
        match Preset::parse(&preset, std::path::Path::new("corrected")) {
            Ok(preset) => {
                asks.ask(Ask::Preset(Box::new(preset)));
                asks.command(Command::ToLight);
            }
            Err(error) => asks.ask(Ask::Say(error.to_string())),
        }
    }
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        for line in rest {
            ui.label(line);
        }
    });
}

/// Which grid is seen, and which cut.
pub fn sight(ui: &mut Ui, session: &Session, answer: &Answer, asks: &mut Asks) {
    let mut port: Port = session.port.clone();
    let side = answer.grids.first().map_or(1, |grid| grid.found.side());
    ui.horizontal_wrapped(|ui| {
        for (i, grid) in answer.grids.iter().enumerate() {
            let words = if grid.iteration == 0 { "injected".to_owned() } else { format!("k = {}", grid.iteration) };
            ui.selectable_value(&mut port.sight.dump, i, words);
        }
        ui.separator();
        for axis in Axis::ALL {
            ui.selectable_value(&mut port.sight.axis, axis, format!("across {}", Axis::name(axis.across())));
        }
        let slider = ui.add(Slider::new(&mut port.sight.index, 0..=side - 1));
        name(&slider, "Slice of the port");
    });
    asks.changed(&session.port, port, |port| Ask::Port(Box::new(port)));
}
