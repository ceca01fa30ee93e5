//! What `identify` found out about a port: ten lines to read, rows for programs, and the first wrong cell as glyphs.

use super::colour::{Paint, Theme};
use super::glyph::Hue;
use super::picture::{Panel, Picture};
use super::slice::{Axis, Plane, Slice};
use crate::field::{Channels, Grid};
use crate::sh::Sh;
use crate::study::identify::catalogue;
use crate::study::identify::verdict::{Judgement, Named, Verdict, Wrong};

/// One row of `identify.csv`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Row {
    /// What was found out.
    pub item: String,
    /// What it is.
    pub value: String,
    /// How far off a number may be; empty where it is none.
    pub uncertainty: String,
}

fn row(item: &str, value: impl Into<String>) -> Row {
    Row { item: item.to_owned(), value: value.into(), uncertainty: String::new() }
}

/// The rows of `identify.csv`.
pub fn rows(verdict: &Verdict) -> Vec<Row> {
    let measured = |item: &str, estimate: Option<crate::study::identify::verdict::Estimate>| match estimate {
        Some(e) => Row {
            item: item.to_owned(),
            value: format!("{:.9}", e.value),
            uncertainty: format!("{:.2e}", e.uncertainty),
        },
        None => row(item, "unknown"),
    };
    let mut rows = vec![
        row("verdict", verdict.judgement.name()),
        row("scheme", verdict.scheme.unwrap_or("unknown")),
        measured("factor", verdict.factor),
    ];
    if verdict.ratio.is_some() {
        rows.push(measured("side_over_far", verdict.ratio));
    }
    rows.extend([
        row("clamp", &*verdict.clamp),
        row("border", &*verdict.border),
        row("snapshots", &*verdict.snapshots),
        row("sum", &*verdict.sum),
        row("coefficients", verdict.layout.coefficients.to_string()),
        row("axes", verdict.layout.axes.to_string()),
        row("storage", verdict.storage),
    ]);
    if let Some((scale, _)) = &verdict.injection {
        rows.push(measured("injection_scale", Some(*scale)));
    }
    rows.extend(verdict.mistakes.iter().map(|mistake| row("mistake", mistake.id)));
    rows.extend(verdict.laws.iter().map(|law| row("law", law.name)));
    rows.push(row("agreeing_cells", format!("{} of {}", verdict.agreeing.0, verdict.agreeing.1)));
    if let Some(Wrong { iteration, cell: [x, y, z], .. }) = verdict.wrong {
        rows.push(row("first_wrong_cell", format!("{x} {y} {z} after iteration {iteration}")));
    }
    rows
}

/// The rows as CSV.
pub fn csv(verdict: &Verdict) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows(verdict) {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}

/// The verdict in words, one thing a line; the first says whether the port is right.
pub fn lines(verdict: &Verdict) -> Vec<String> {
    let scheme = verdict.scheme.unwrap_or("no known scheme");
    let factor = verdict.factor.map_or(String::new(), |factor| format!(", factor {factor}"));
    let mut lines = vec![match verdict.judgement {
        Judgement::Correct => format!("RIGHT: this port does what {scheme} says{factor}."),
        Judgement::Mistakes => {
            let count = verdict.mistakes.len();
            let mistakes = if count == 1 { "one known mistake" } else { "known mistakes" };
            format!("NOT RIGHT: {scheme} with {mistakes}: {}.", ids(&verdict.mistakes))
        }
        Judgement::Unknown => {
            let (agreeing, cells) = verdict.agreeing;
            format!(
                "UNKNOWN: no known scheme and no known mistake explain these dumps; the nearest, {scheme}, explains {agreeing} of {cells} cells."
            )
        }
    }];
    for mistake in &verdict.mistakes {
        lines.extend(told(mistake));
    }
    for law in &verdict.laws {
        lines.push(format!("Breaks {}: {}.", law.name, law.how));
    }
    if verdict.judgement != Judgement::Correct {
        lines.push(format!("Propagation: {scheme}{factor}."));
    }
    lines.push(format!(
        "Clamped faces: {}. Border: {}. Snapshots: {}. Sum: {}.",
        verdict.clamp, verdict.border, verdict.snapshots, verdict.sum
    ));
    lines.push(format!(
        "Dump: [{}], each ({}), {}.",
        verdict.layout.axes.to_string().replace(' ', ", "),
        verdict.layout.coefficients.to_string().replace(' ', ", "),
        verdict.storage
    ));
    if let Some((_, words)) = &verdict.injection {
        lines.push(format!("Lights are injected {words}."));
    }
    if let Some(Wrong { iteration, cell: [x, y, z], expected, found }) = verdict.wrong {
        let grid = if iteration == 0 {
            "the injected grid".to_owned()
        } else {
            format!("the grid after iteration {iteration}")
        };
        let numbers = |c: [f64; 4]| format!("({:.6}, {:.6}, {:.6}, {:.6})", c[0], c[1], c[2], c[3]);
        lines.push(format!(
            "First cell that differs: ({x}, {y}, {z}) of {grid} is (c00, X, Y, Z) = {}, right is {}.",
            numbers(found),
            numbers(expected)
        ));
    }
    lines.extend(verdict.notes.iter().map(|note| format!("Note: {note}")));
    lines
}

fn ids(mistakes: &[Named]) -> String {
    mistakes.iter().map(|mistake| mistake.id).collect::<Vec<_>>().join(", ")
}

fn told(mistake: &Named) -> Vec<String> {
    let Some(entry) = catalogue::find(mistake.id) else { return Vec::new() };
    let detail = if mistake.detail.is_empty() { String::new() } else { format!(" ({})", mistake.detail) };
    let mut lines = vec![format!("{}{detail}: {} {}", mistake.id, entry.sentence, entry.remedy)];
    if !mistake.or.is_empty() {
        lines.push(format!("Note: these dumps cannot tell {} from {}.", mistake.id, mistake.or.join(" or ")));
    }
    lines
}

/// The first wrong cell, as it should be and as it is, seen along each axis, as SVG; `None` where no cell is wrong.
pub fn picture(verdict: &Verdict) -> Option<String> {
    let Wrong { iteration, cell: [x, y, z], expected, found } = verdict.wrong?;
    let slice = |light: [f64; 4], axis: Axis| {
        let mut grid = Grid::<f32>::new(1);
        grid.set([0; 3], Sh(light).cast());
        Slice::level(&[&grid], &Channels::of_colors(&[[1.0; 3]]), 0, Plane { axis, index: 0 })
    };
    let slices: Vec<(String, Slice, Slice)> = Axis::ALL
        .into_iter()
        .map(|axis| (format!("seen along {}", Axis::name(axis.across())), slice(expected, axis), slice(found, axis)))
        .collect();
    let titles: Vec<[String; 2]> =
        slices.iter().map(|(seen, ..)| [format!("as it should be, {seen}"), format!("as it is, {seen}")]).collect();
    let mut panels = Vec::new();
    for ((_, right, wrong), [right_title, wrong_title]) in slices.iter().zip(&titles) {
        // One scale for both, so that they can be compared.
        let scale = [right, wrong].map(|slice| super::glyph::fit([slice], Hue::Mean, 1.0).unwrap_or(0.0));
        let full = scale[0].max(scale[1]).max(f32::MIN_POSITIVE);
        let scale = super::glyph::GlyphScale::Linear { full };
        panels.push(Panel { title: right_title, slice: right, scale });
        panels.push(Panel { title: wrong_title, slice: wrong, scale });
    }
    let title = format!("The first wrong cell, ({x}, {y}, {z})");
    let subtitle = match iteration {
        0 => "in the injected grid".to_owned(),
        k => format!("in the grid after iteration {k}"),
    };
    let picture = Picture {
        title: &title,
        subtitle: &subtitle,
        panels,
        hue: Hue::Mean,
        paint: Paint::Direction,
        heat: false,
        theme: Theme::LIGHT,
        width: 900,
    };
    Some(picture.to_svg())
}
