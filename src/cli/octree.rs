//! `octree`: what an octree can do, as a table, `octree.csv` and a figure of error against cell updates.

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;

use super::output::Folder;
use super::{CliError, SceneArgs, console};
use crate::report::colour::Theme;
use crate::report::plot::{Curve, Dash, Figure, Plot, Shape};
use crate::report::table::Table;
use crate::scene::Problem;
use crate::scene::propagation::descent::{FARTHEST, LEAST_SIDE};
use crate::study::octree::{self, Row, Way};
use crate::study::pareto::synthetic;

/// Which scenes, which ways, where to write.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  lpv-lab octree --factor 3,3.8,4\n  lpv-lab octree two-walls mixed --iterations 4,8 --distances 2,3\n  \
                        lpv-lab octree --size 64 --factor 3.8 --rounds 5\n  \
                        lpv-lab octree --size 64 --cascade-side 16\n\n\
                        way is uniform (the finest level alone), same, consistent, exact or ahead (every level by itself), radial-R\n\
                        (ahead, sampled by the distance to injected light), descent-cells,\n\
                        descent-leaves-R or descent-cascades-C (the coarse levels start the fine ones), cascades-C-alone (nested\n\
                        grids, each by itself), or solver. converged is the L1 error of the merged\n\
                        light against all the light there will ever be in the uniform volume, after_k against the uniform volume after\n\
                        as many iterations. cells are touched by an iteration; in a descent by one of every level."
)]
pub struct OctreeArgs {
    /// Presets, files or names of built-in ones [default: one wall, two walls and a lone lobe, made at --size]
    presets: Vec<PathBuf>,
    /// The side of the volumes that are made; presets have their own
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = side, conflicts_with = "presets")]
    size: usize,
    /// Propagation factors [default: the presets' own, or 3.8]
    #[arg(long, value_name = "P,P,...", value_delimiter = ',', value_parser = super::pareto::factor)]
    factor: Vec<f64>,
    /// The propagation scheme [default: the presets' own]
    #[arg(long, value_name = "NAME")]
    scheme: Option<String>,
    /// Iterations, of every level in a descent
    #[arg(long, value_name = "K,K,...", value_delimiter = ',', default_values_t = [1, 2, 4, 8, 16], value_parser = iterations)]
    iterations: Vec<usize>,
    /// Distances of leaves
    #[arg(long, value_name = "R,R,...", value_delimiter = ',', default_values_t = [2.0, 3.0], value_parser = distance)]
    distances: Vec<f64>,
    /// Sides of nested cascades about the volume's middle; each is measured two-way and alone
    #[arg(long, value_name = "C,C,...", value_delimiter = ',', value_parser = cascade)]
    cascade_side: Vec<usize>,
    /// Rounds; the median time is reported
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// The folder for octree.csv, octree.svg and octree.png
    #[arg(long, value_name = "DIR", default_value = "lpv-lab-results/octree")]
    out: PathBuf,
}

fn side(text: &str) -> Result<usize, String> {
    let side = text.parse().ok().filter(|n: &usize| n.is_power_of_two() && (2..=256).contains(n));
    side.ok_or_else(|| "a side is a power of two from 2 to 256".to_owned())
}

fn cascade(text: &str) -> Result<usize, String> {
    let side = text.parse().ok().filter(|c: &usize| c.is_power_of_two() && *c >= LEAST_SIDE);
    side.ok_or_else(|| format!("a side of cascades is a power of two from {LEAST_SIDE} on"))
}

fn iterations(text: &str) -> Result<usize, String> {
    let iterations = text.parse().ok().filter(|k| (1..=1000).contains(k));
    iterations.ok_or_else(|| "iterations are a number from 1 to 1000".to_owned())
}

/// A distance of leaves from the command line.
pub fn distance(text: &str) -> Result<f64, String> {
    let distance = text.parse().ok().filter(|r: &f64| (2.0..=FARTHEST).contains(r));
    distance.ok_or_else(|| format!("a distance of leaves is a number from 2 to {FARTHEST}"))
}

/// Does the command.
pub fn run(args: &OctreeArgs) -> Result<(), CliError> {
    let problems = args.problems()?;
    let folder = Folder::create(args.out.clone())?;
    let ways = Way::all(&args.distances, &args.cascade_side);
    let mut rows = Vec::new();
    for (name, problem) in &problems {
        let bar = if std::io::stderr().is_terminal() { ProgressBar::new(1000) } else { ProgressBar::hidden() };
        let asked = (&ways[..], &args.iterations[..]);
        let measured = octree::measure(name, problem, asked, usize::from(args.rounds), &|share| {
            bar.set_position((1000.0 * share) as u64);
            true
        })?;
        bar.finish_and_clear();
        rows.extend(measured.unwrap_or_default());
    }
    let table = table(&rows);
    console::print(format_args!("{}", table.to_text()));
    folder.write_table("octree.csv", &table)?;
    folder.write_svg_and_png("octree", &figure(&rows).to_svg())?;
    folder.finish();
    Ok(())
}

impl OctreeArgs {
    /// Every scene at every factor, with its name.
    fn problems(&self) -> Result<Vec<(String, Problem)>, CliError> {
        let mut problems = Vec::new();
        if self.presets.is_empty() {
            let factors = if self.factor.is_empty() { vec![3.8] } else { self.factor.clone() };
            for factor in factors {
                for (name, mut problem) in synthetic::scenes(self.size, factor) {
                    if let Some(scheme) = &self.scheme {
                        problem.propagation.scheme.clone_from(scheme);
                    }
                    problems.push((name.to_owned(), problem));
                }
            }
        }
        for preset in &self.presets {
            let factors = self.factor.iter().map(|factor| Some(*factor)).collect::<Vec<_>>();
            for factor in if factors.is_empty() { vec![None] } else { factors } {
                let scheme = self.scheme.clone();
                let args = SceneArgs { preset: preset.clone(), scheme, factor, ..SceneArgs::default() };
                problems.push((args.stem(), args.load()?.1));
            }
        }
        Ok(problems)
    }
}

fn table(rows: &[Row]) -> Table<11> {
    let mut table =
        Table::new(["preset", "scheme", "p", "n", "way", "k", "converged", "after_k", "cells", "updates", "ms"]);
    for row in rows {
        table.push([
            row.preset.as_str().into(),
            row.scheme.as_str().into(),
            row.factor.into(),
            row.size.into(),
            row.way.as_str().into(),
            row.iterations.into(),
            row.converged.into(),
            row.after.into(),
            row.cells.into(),
            row.updates.into(),
            (1e3 * row.seconds).into(),
        ]);
    }
    table
}

/// Error against cell updates, a plot for each scene and factor.
fn figure(rows: &[Row]) -> Figure {
    let mut scenes: Vec<(&str, f64)> = Vec::new();
    for row in rows {
        if !scenes.contains(&(row.preset.as_str(), row.factor)) {
            scenes.push((&row.preset, row.factor));
        }
    }
    let plot = |&(preset, factor): &(&str, f64)| {
        let of_scene: Vec<&Row> = rows.iter().filter(|row| row.preset == preset && row.factor == factor).collect();
        let mut ways: Vec<&str> = Vec::new();
        for row in &of_scene {
            if !ways.contains(&row.way.as_str()) {
                ways.push(&row.way);
            }
        }
        let curves = ways.iter().enumerate().map(|(color, way)| {
            let of_way = of_scene.iter().filter(|row| row.way == *way);
            let points = of_way.map(|row| [row.updates as f64, row.converged]).collect();
            let dash = if *way == "solver" { Dash::Points(Shape::Cross) } else { Dash::Solid };
            Curve { name: (*way).to_owned(), points, color, dash }
        });
        Plot {
            title: format!("{preset}, p = {factor}"),
            x_label: "cell updates".to_owned(),
            y_label: "L1 error against the converged volume".to_owned(),
            log_x: true,
            log_y: true,
            keys: Vec::new(),
            curves: curves.collect(),
            marks: Vec::new(),
        }
    };
    let plots: Vec<Plot> = scenes.iter().map(plot).collect();
    let height = 340 * plots.len().max(1) as u32;
    Figure { title: "What an octree can do".to_owned(), plots, theme: Theme::LIGHT, size: [960, height] }
}
