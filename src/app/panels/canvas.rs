//! Objects on the views: outlines of what crosses the cut, handles of the chosen one, and tools that add others. What has
//! not been run yet is drawn hollow.

use egui::{Color32, CursorIcon, Painter, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, vec2};

use crate::app::draw::grids::{Pointed, Span};
use crate::app::draw::ink::color;
use crate::app::draw::placing::Placing;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::cell_files::opaque;
use crate::app::session::items::{Item, Tool};
use crate::field::Cell;
use crate::report::colour::Theme;
use crate::report::slice::Plane;
use crate::scene::Preset;
use crate::scene::injector::{Injector, InjectorKind};
use crate::scene::occluder::OccluderKind;

/// The side of a handle, in points.
const HANDLE: f32 = 11.0;
/// How long the arrow of a direction is, in points.
const ARROW: f32 = 34.0;

/// Draws the objects over one view, and has the chosen one changed by its handles.
pub fn ui(ui: &mut Ui, session: &Session, placing: &Placing, plane: Plane, theme: &Theme, asks: &mut Asks) {
    let preset = &session.document.preset;
    let painter = ui.painter_at(placing.clip);
    for item in Item::all(preset) {
        let Some(rect) = on_screen(item, preset, placing, plane) else { continue };
        let chosen = session.selected == Some(item);
        outline(&painter, rect, item, chosen, session.run.has_run(item, preset), theme);
        if chosen {
            handles(ui, &painter, session, item, rect, placing, plane, theme, asks);
        }
    }
}

/// Where an object's cells are on screen.
fn on_screen(item: Item, preset: &Preset, placing: &Placing, plane: Plane) -> Option<Rect> {
    let [low, high] = item.footprint(preset, plane)?;
    let (a, b) = (placing.square(low[0], low[1], 1), placing.square(high[0], high[1], 1));
    Some(a.union(b))
}

fn outline(painter: &Painter, rect: Rect, item: Item, chosen: bool, has_run: bool, theme: &Theme) {
    let ink = match item {
        Item::Injector(_) => color(theme.heat),
        Item::Occluder(_) => color(theme.muted),
    };
    let width = if chosen { 2.0 } else { 1.0 };
    if has_run {
        painter.rect_stroke(rect, 0.0, (width, ink.gamma_multiply(if chosen { 1.0 } else { 0.6 })), StrokeKind::Middle);
        return;
    }
    let corners = [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
    painter.extend(egui::Shape::dashed_line(&corners, Stroke::new(width + 0.5, ink), 5.0, 4.0));
}

#[expect(clippy::too_many_arguments, reason = "a handle needs the view that it lies on and the session it changes")]
fn handles(
    ui: &mut Ui,
    painter: &Painter,
    session: &Session,
    item: Item,
    rect: Rect,
    placing: &Placing,
    plane: Plane,
    theme: &Theme,
    asks: &mut Asks,
) {
    let preset = &session.document.preset;
    let ink = color(theme.negative);
    let side = preset.size;
    let change = |asks: &mut Asks, change: &dyn Fn(&mut Preset)| {
        let mut edited = preset.clone();
        change(&mut edited);
        asks.changed(preset, edited, |preset| Ask::Preset(Box::new(preset)));
    };
    let name = |what: &str| format!("{what} of {}", item.name());
    if let Some(to) = handle(ui, painter, rect.center(), &name("Position"), ink)
        && let Some([low, high]) = item.footprint(preset, plane)
    {
        let middle = [0, 1].map(|i| (low[i] + high[i]) / 2);
        let cell = placing.nearest(to, side);
        let by = [0, 1].map(|i| cell[i] as isize - middle[i] as isize);
        change(asks, &|preset| item.shift(preset, plane.axis, by));
    }
    if item.can_be_sized(preset)
        && let Some(to) = handle(ui, painter, rect.right_top(), &name("Size"), ink)
    {
        let cell = placing.nearest(to, side);
        change(asks, &|preset| item.stretch(preset, plane.axis, cell));
    }
    if let Some(direction) = item.direction(preset) {
        let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        let part = |i: usize| (direction[i] / length) as f32;
        let along = vec2(part(plane.axis.columns()), -part(plane.axis.rows())) * ARROW;
        // Light that leaves the cut has its handle a little beside the middle.
        let tip = rect.center() + if along.length() < HANDLE { Vec2::splat(HANDLE) } else { along };
        painter.arrow(rect.center(), tip - rect.center(), Stroke::new(1.6, ink));
        if let Some(to) = handle(ui, painter, tip, &name("Direction"), ink) {
            let out = to - rect.center();
            change(asks, &|preset| item.turn(preset, plane.axis, [f64::from(out.x), f64::from(-out.y)]));
        }
    }
}

/// A handle to drag; where the pointer drags it to.
fn handle(ui: &mut Ui, painter: &Painter, at: Pos2, name: &str, ink: Color32) -> Option<Pos2> {
    let rect = Rect::from_center_size(at, Vec2::splat(HANDLE));
    let response = ui.interact(rect, ui.scope_id().with(("handle", name)), Sense::drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    let fill = if response.hovered() || response.dragged() { ink } else { Color32::TRANSPARENT };
    painter.rect(rect.shrink(2.0), 1.0, fill, Stroke::new(1.4, ink), StrokeKind::Middle);
    let response = response.on_hover_cursor(CursorIcon::Grab);
    response.interact_pointer_pos().filter(|_| response.dragged())
}

/// Draws the cells that are being marked with the tool in hand, and adds what they become once they are.
pub fn mark(ui: &Ui, session: &Session, placing: &Placing, span: Span, theme: &Theme, asks: &mut Asks) {
    let Some(shown) = session.sight.shown.get(span.pane) else { return };
    let [low, high] = span.corners();
    if !span.done {
        let rect = placing.square(low[0], low[1], 1).union(placing.square(high[0], high[1], 1));
        let ink = color(if session.tool == Tool::Light { theme.heat } else { theme.muted });
        ui.painter_at(placing.clip).rect(rect, 0.0, ink.gamma_multiply(0.25), (2.0, ink), StrokeKind::Middle);
        return;
    }
    let plane = shown.slice.plane;
    let [from, to] = [low, high].map(|[column, row]| plane.axis.cell(plane.index, column, row));
    add(session, from, to, asks);
}

/// Adds what the tool in hand makes of the cells between two.
fn add(session: &Session, from: Cell, to: Cell, asks: &mut Asks) {
    let mut preset = session.document.preset.clone();
    let item = match session.tool {
        Tool::Light => {
            let kind =
                if from == to { InjectorKind::Single { cell: from } } else { InjectorKind::Rectangle { from, to } };
            preset.injectors.push(Injector::new(kind));
            Item::Injector(preset.injectors.len() - 1)
        }
        Tool::Occluder => {
            preset.occluders.push(opaque(OccluderKind::Box { from, to }));
            Item::Occluder(preset.occluders.len() - 1)
        }
        Tool::Select | Tool::Probe => return,
    };
    asks.ask(Ask::Select(Some(item)));
    asks.ask(Ask::Preset(Box::new(preset)));
}

/// What a click with the tool in hand does.
pub fn click(session: &Session, pointed: Pointed, asks: &mut Asks) {
    let Some(shown) = session.sight.shown.get(pointed.pane) else { return };
    let plane = shown.slice.plane;
    let cell = plane.axis.cell(plane.index, pointed.at[0], pointed.at[1]);
    let preset = &session.document.preset;
    match session.tool {
        _ if session.placing.is_some() => session.click(shown, pointed.at, asks),
        Tool::Select => {
            let [column, row] = pointed.at;
            let here = |item: &Item| {
                item.footprint(preset, plane).is_some_and(|[low, high]| {
                    (low[0]..=high[0]).contains(&column) && (low[1]..=high[1]).contains(&row)
                })
            };
            asks.ask(Ask::Select(Item::all(preset).into_iter().find(here)));
            session.click(shown, pointed.at, asks);
        }
        Tool::Light | Tool::Occluder => add(session, cell, cell, asks),
        Tool::Probe => {
            let mut plots = session.settings.plots.clone();
            plots.line.at = Some(if plots.line.upwards { pointed.at[0] } else { pointed.at[1] });
            plots.tab = crate::app::session::plots::Tab::Line;
            asks.ask(Ask::Plots(Box::new(plots)));
        }
    }
}
