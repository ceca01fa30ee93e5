//! `compare A B --difference`: one run against another of the same size, in numbers and pictures.

use super::{CompareArgs, check_schemes};
use crate::cli::CliError;
use crate::cli::console::{self, say};
use crate::cli::output::Folder;
use crate::report::colour::{Paint, Theme};
use crate::report::glyph::Hue;
use crate::report::number::plain;
use crate::report::picture::{Panel, Picture};
use crate::report::slice::{Axis, Plane, Slice};
use crate::report::table::{Table, Value};
use crate::simulation::Simulation;
use crate::simulation::options::{Options, Wanted};
use crate::study::difference::Difference;

/// How many powers of ten a glyph spans.
const GLYPH_DECADES: f32 = 4.0;

const COLUMNS: [&str; 10] = [
    "scheme",
    "level",
    "absolute_mean",
    "absolute_max",
    "relative_mean",
    "relative_max",
    "l1_ratio",
    "undefined",
    "shift",
    "moved",
];

/// Does the command.
pub(super) fn run(args: &CompareArgs) -> Result<(), CliError> {
    let [first, second] = args.presets.as_slice() else {
        let count = args.presets.len();
        return Err(CliError::Input(format!("--difference takes two presets, and there are {count}")));
    };
    let scenes = [args.scene(first), args.scene(second)];
    let loaded = [scenes[0].load()?, scenes[1].load()?];
    let sizes = [&loaded[0], &loaded[1]].map(|(_, problem)| problem.size);
    if sizes[0] != sizes[1] {
        let what = format!("{}³ and {}³ cannot be subtracted", sizes[0], sizes[1]);
        return Err(CliError::Input(format!("--difference: {what}; give two presets of one size")));
    }
    let names: Vec<&str> = args.schemes.iter().map(String::as_str).collect();
    check_schemes(&names)?;
    // Without a name each preset keeps its own scheme.
    let schemes: Vec<Option<&str>> = if names.is_empty() { vec![None] } else { names.into_iter().map(Some).collect() };
    let folder = args.out.clone().map(Folder::create).transpose()?;
    let titles = [0, 1].map(|i| scenes[i].title(&loaded[i].0));
    say!("{} against {}, {}³", titles[1], titles[0], sizes[0]);
    let mut csv = Table::new(COLUMNS);
    for scheme in schemes {
        let mut runs = Vec::new();
        for (_, problem) in &loaded {
            let mut problem = problem.clone();
            if let Some(scheme) = scheme {
                problem.propagation.scheme = scheme.to_owned();
            }
            let mut run = args.device.simulate(problem, Options::default())?;
            run.run_all(Wanted::Everything);
            runs.push(run);
        }
        let [first, second] = runs.as_slice() else { continue };
        let Some(difference) = Difference::between(first, second) else { continue };
        let name = name(first, second);
        say!("\n{name}: {}", moves(&difference));
        let mut table = Table::new(["level", "abs mean", "abs max", "rel mean", "rel max", "l1 ratio", "undefined"]);
        for row in &difference.rows {
            let level = Value::Text(row.level.map_or("merged".to_owned(), |level| level.to_string()));
            let numbers = [row.absolute_mean, row.absolute_max, row.relative_mean, row.relative_max, row.l1_ratio];
            let [mean, max, relative_mean, relative_max, l1] = numbers.map(Value::from);
            let [a, b, c, d, e] = numbers.map(Value::from);
            table.push([level.clone(), mean, max, relative_mean, relative_max, l1, row.undefined.into()]);
            let [shift, moved] = [difference.shift(), difference.moved()].map(|step| Value::from(length(step)));
            csv.push([name.as_str().into(), level, a, b, c, d, e, row.undefined.into(), shift, moved]);
        }
        console::print(format_args!("{}", table.to_text()));
        if let Some(folder) = &folder {
            let names = [titles[0].as_str(), titles[1].as_str()];
            folder.write_svg_and_png(&format!("difference-{name}"), &picture(names, [first, second], &name))?;
        }
    }
    if let Some(folder) = folder {
        folder.write_table("difference.csv", &csv)?;
        folder.finish();
    }
    Ok(())
}

/// The scheme of both runs, or both.
fn name(first: &Simulation<f32>, second: &Simulation<f32>) -> String {
    let [a, b] = [first, second].map(|run| run.problem().propagation.scheme.as_str());
    if a == b { a.to_owned() } else { format!("{a}-{b}") }
}

fn length(step: [f64; 3]) -> f64 {
    step.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// How far the centroids moved, in a line.
fn moves(difference: &Difference) -> String {
    let told = |step: [f64; 3]| {
        let [x, y, z] = step.map(|c| plain(c, 3));
        format!("{} cells, ({x}, {y}, {z})", plain(length(step), 3))
    };
    let (shift, moved) = (told(difference.shift()), told(difference.moved()));
    format!("the merged light's centroid moves by {shift}, the injected light's by {moved}")
}

/// Both runs' merged light and the second's minus the first's, in the slice where most light is injected.
fn picture(titles: [&str; 2], runs: [&Simulation<f32>; 2], name: &str) -> String {
    let axis = Axis::Z;
    let plane = Plane { axis, index: runs[0].problem().brightest_slab(axis.across()) };
    let [first, second] = runs.map(|run| Slice::of_merged(run, plane));
    // Squares as small as either run's, so that nothing of the first is lost in a coarse square of the second.
    let [fine, mut difference] = runs.map(|run| {
        let merged: Vec<_> = crate::study::light::sampled(run);
        Slice::level(&merged.iter().collect::<Vec<_>>(), run.channels(), 0, plane)
    });
    difference.subtract(&fine);
    let panels = [(titles[0], &first), (titles[1], &second), ("Second minus first", &difference)];
    let panels = panels.map(|(title, slice)| Panel::fitted(title, slice, Hue::Mean, Some(GLYPH_DECADES)));
    let subtitle = format!("merged light, {name}, {} = {}", Axis::name(axis.across()), plane.index);
    let picture = Picture {
        title: &format!("{} against {}", titles[1], titles[0]),
        subtitle: &subtitle,
        panels: panels.to_vec(),
        hue: Hue::Mean,
        paint: Paint::Single,
        heat: false,
        theme: Theme::LIGHT,
        width: 1800,
    };
    picture.to_svg()
}
