//! The command palette: all commands, presets and settings by a few letters of their names.

use egui::{Context, Id, Key, Modal, RichText, ScrollArea, TextEdit};

use super::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks, Next};
use crate::app::session::command::Command;
use crate::app::session::view::{Fill, Heat, Scaling, View, hue_name, paint_name};
use crate::app::worker::look::Layer;
use crate::report::colour::Paint;
use crate::report::glyph::Hue;
use crate::scene::builtin;
use crate::transport;

/// The most lines that are shown.
const MOST: usize = 12;

/// The palette while it is open.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    text: String,
    /// The line that Enter takes.
    chosen: usize,
    /// Whether the field has had the keyboard yet.
    focused: bool,
}

/// Something that can be chosen.
struct Entry {
    text: String,
    hint: String,
    ask: Ask,
}

/// Shows the palette while there is one; it goes once something is chosen.
pub fn ui(ctx: &Context, open: &mut Option<Palette>, session: &Session, asks: &mut Asks) {
    let Some(mut palette) = open.take() else { return };
    let found = ranked(entries(ctx, session), &palette.text);
    let (down, up, enter) = ctx.input_mut(|input| {
        let mut pressed = |key| input.consume_key(egui::Modifiers::NONE, key);
        (pressed(Key::ArrowDown), pressed(Key::ArrowUp), pressed(Key::Enter))
    });
    palette.chosen = (palette.chosen + usize::from(down)).saturating_sub(usize::from(up));
    palette.chosen = palette.chosen.min(found.len().saturating_sub(1));
    let mut taken = enter.then_some(palette.chosen);
    let modal = Modal::new(Id::unique("palette")).show(ctx, |ui| {
        ui.set_width(460.0_f32.min(ui.ctx().content_rect().width() - 40.0));
        let edit = TextEdit::singleline(&mut palette.text).hint_text("A command, a preset, a setting");
        let field = ui.add(edit.desired_width(f32::INFINITY));
        name(&field, "Command palette");
        if !palette.focused {
            field.request_focus();
            palette.focused = true;
        }
        if field.changed() {
            palette.chosen = 0;
        }
        ScrollArea::vertical().max_height(340.0).show(ui, |ui| {
            for (i, entry) in found.iter().enumerate() {
                let text = RichText::new(&entry.text);
                let line = egui::Button::selectable(i == palette.chosen, text).shortcut_text(&entry.hint);
                if ui.add_sized([ui.available_width(), 20.0], line).clicked() {
                    taken = Some(i);
                }
            }
            if found.is_empty() {
                ui.weak("Nothing has such a name.");
            }
        });
    });
    match taken.and_then(|i| found.into_iter().nth(i)) {
        Some(entry) => asks.ask(entry.ask),
        None if modal.should_close() => {}
        None => *open = Some(palette),
    }
}

/// Everything that can be chosen now.
fn entries(ctx: &Context, session: &Session) -> Vec<Entry> {
    let commands = Command::ALL.iter().filter(|command| session.can(**command) && **command != Command::Palette);
    let mut entries: Vec<Entry> = commands
        .map(|command| Entry {
            text: command.name().to_owned(),
            hint: command.shortcut().map(|keys| ctx.format_shortcut(&keys)).unwrap_or_default(),
            ask: Ask::Do(*command),
        })
        .collect();
    let mut add = |text: String, hint: &str, ask: Ask| entries.push(Entry { text, hint: hint.to_owned(), ask });
    for (preset, _) in builtin::PRESETS {
        add(format!("Preset {preset}"), "built in", Ask::Leave(Next::BuiltIn((*preset).to_owned())));
    }
    for path in &session.settings.recent {
        add(format!("Preset {}", path.display()), "recent", Ask::Leave(Next::Open(path.clone())));
    }
    for scheme in transport::names() {
        let mut preset = session.document.preset.clone();
        preset.propagation.scheme = scheme.to_owned();
        add(format!("Scheme {scheme}"), "propagation", Ask::Preset(Box::new(preset)));
    }
    let view = &session.settings.view;
    let mut set = |text: String, change: &dyn Fn(&mut View)| {
        let mut view = view.clone();
        change(&mut view);
        add(text, "view", Ask::View(Box::new(view)));
    };
    Paint::ALL.into_iter().for_each(|p| set(format!("Glyph colour: {}", paint_name(p)), &|v| v.paint = p));
    Fill::ALL.into_iter().for_each(|f| set(format!("Brightest glyph: {}", f.name().to_lowercase()), &|v| v.fill = f));
    Scaling::ALL.into_iter().for_each(|s| set(format!("Glyph scale: {}", s.name()), &|v| v.scaling = s));
    Heat::ALL.into_iter().for_each(|h| set(format!("Heat map: {}", h.name()), &|v| v.heat = h));
    Hue::ALL.into_iter().for_each(|h| set(format!("Light shown: {}", hue_name(h)), &|v| v.hue = h));
    for level in 0..session.run.progress.levels {
        set(Layer::Level(level).name(), &|v| v.layer = Layer::Level(level));
    }
    set("Negative lobes on or off".to_owned(), &|v| v.negative = !v.negative);
    set("Index volume on or off".to_owned(), &|v| v.levels = !v.levels);
    set("Cell edges on or off".to_owned(), &|v| v.cells = !v.cells);
    set("Centre and flux on or off".to_owned(), &|v| v.flux = !v.flux);
    set("Occluders on or off".to_owned(), &|v| v.occluders = !v.occluders);
    add("Run again after every edit".to_owned(), "setting", Ask::Rerun(!session.reruns()));
    if cfg!(feature = "gpu") {
        let on_card = !session.settings.on_card;
        let device = if on_card { "graphics card" } else { "processor" };
        add(format!("Compute on the {device}"), "setting", Ask::OnCard(on_card));
    }
    entries
}

/// The entries in which all words of a text are found, those that begin with it first.
fn ranked(entries: Vec<Entry>, text: &str) -> Vec<Entry> {
    let text = text.trim().to_lowercase();
    let mut found: Vec<(usize, Entry)> =
        entries.into_iter().filter_map(|entry| Some((rank(&entry.text.to_lowercase(), &text)?, entry))).collect();
    found.sort_by_key(|(rank, _)| *rank);
    found.into_iter().map(|(_, entry)| entry).take(MOST).collect()
}

/// How well a name fits, 0 the best; `None` where a word is not in it.
fn rank(name: &str, text: &str) -> Option<usize> {
    if !text.split_whitespace().all(|word| name.contains(word)) {
        return None;
    }
    let begins = |word: &str| name.split_whitespace().any(|part| part.starts_with(word));
    Some(match () {
        () if name.starts_with(text) => 0,
        () if text.split_whitespace().all(begins) => 1,
        () => 2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_by_their_words_and_beginnings_come_first() {
        assert_eq!(rank("run all", "run"), Some(0));
        assert_eq!(rank("scheme cascaded", "casc"), Some(1));
        assert_eq!(rank("propagate", "gate"), Some(2));
        assert_eq!(rank("preset two-walls", "two pre"), Some(1));
        assert_eq!(rank("propagate", "merge"), None);
    }
}
