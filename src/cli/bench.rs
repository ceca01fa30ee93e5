//! `bench`: how fast the loops are, as a table, `kernels.csv` and a plot; then the solver against iterating, by
//! [`super::race`], and time against error, by [`super::pareto`].

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;

use super::console::{self, say};
use super::descent::DescentArgs;
use super::output::Folder;
use super::{CliError, SceneArgs};
use crate::report::colour::Theme;
use crate::report::plot::{Curve, Dash, Figure, Plot};
use crate::report::table::Table;
use crate::scene::Problem;
use crate::scene::propagation::descent::Descent;
use crate::study::benchmark::{self, BenchmarkError, Fading, KernelRow, Pipeline, THESIS_MILLISECONDS};
use crate::study::pareto::synthetic;
use crate::transport::team;

/// What to measure, and where to write.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  lpv-lab bench\n  lpv-lab bench --sizes 64,128,256 --threads 1,2 --rounds 7 --out results\n  lpv-lab bench --only-pareto --pareto 32 --factor 3.8\n  \
                        lpv-lab bench --only-pareto --presets two-walls,mixed,pillar\n  lpv-lab bench --only-converged\n\n\
                        kernel is aos (the usual array of structures), plain (the definition), fast, fast-clamped, blocked\n\
                        (several iterations a pass), or a scene: lobe (eight iterations, all levels) and walls-merged (sixteen,\n\
                        only the merged light wanted), with what was not skipped. On a graphics card (threads: gpu) it is\n\
                        card-linear, card-clamped, or card-thesis (four iterations of three channels on all levels of 32³), and\n\
                        triad_fraction is the part of the card's own copy."
)]
pub struct BenchArgs {
    /// Sides of the volumes, powers of two
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_values_t = [16, 32, 64, 128], value_parser = side)]
    sizes: Vec<usize>,
    /// Numbers of threads [default: one, and all cores]
    #[arg(long, value_name = "T,T,...", value_delimiter = ',', value_parser = threads)]
    threads: Vec<usize>,
    /// Rounds over all loops; medians are reported
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Sides of the volumes for time against error, powers of two; 0 to leave it out
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_values_t = [16, 32], value_parser = side_or_none)]
    pareto: Vec<usize>,
    /// Presets for time against error, files or names of built-in ones, in place of the volumes
    #[arg(long, value_name = "PRESET,...", value_delimiter = ',', conflicts_with = "pareto")]
    presets: Vec<PathBuf>,
    /// The propagation factor for time against error [default: 3, or the presets' own]
    #[arg(long, value_parser = super::pareto::factor, allow_negative_numbers = true)]
    factor: Option<f64>,
    /// What a descent goes over, for time against error: one more way to treat the levels.
    #[command(flatten)]
    descent: DescentArgs,
    /// Sides of the volumes in which the fixed point is iterated to and solved for; 0 to leave it out
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_values_t = [32, 64], value_parser = side_or_none)]
    converged: Vec<usize>,
    /// Measure the loops on this device as well; the processor's are always measured, unless --only-card is given
    #[cfg(feature = "gpu")]
    #[arg(long, value_enum, value_name = "DEVICE", default_value_t)]
    device: super::load::DeviceArg,
    /// Measure how fast a graphics card steps, and nothing else
    #[cfg(feature = "gpu")]
    #[arg(long)]
    only_card: bool,
    /// Only measure time against error
    #[arg(long, conflicts_with_all = ["only_converged", "only_scene"])]
    only_pareto: bool,
    /// Only iterate to the fixed point and solve for it
    #[arg(long, conflicts_with = "only_scene")]
    only_converged: bool,
    /// Only measure what a scene with a mesh takes: solids, shadow maps, a lamp that moves
    #[arg(long)]
    only_scene: bool,
    /// The folder for kernels.csv, scenes.csv, converged.csv, pareto.csv and the plots
    #[arg(long, value_name = "DIR", default_value = "lpv-lab-results/bench")]
    out: PathBuf,
}

fn side(text: &str) -> Result<usize, String> {
    let side = text.parse().ok().filter(|n: &usize| n.is_power_of_two() && (2..=512).contains(n));
    side.ok_or_else(|| "a side is a power of two from 2 to 512".to_owned())
}

fn side_or_none(text: &str) -> Result<usize, String> {
    if text == "0" { Ok(0) } else { side(text) }
}

fn threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|n| (1..=1024).contains(n));
    threads.ok_or_else(|| "threads are a number from 1 to 1024".to_owned())
}

impl From<BenchmarkError> for CliError {
    fn from(error: BenchmarkError) -> Self {
        CliError::Failed(error.to_string())
    }
}

impl BenchArgs {
    /// Whether nothing was asked for by itself.
    pub fn measures_all(&self) -> bool {
        !self.only_pareto && !self.only_converged && !self.only_scene
    }
}

/// Does the command.
pub fn run(args: &BenchArgs) -> Result<(), CliError> {
    let folder = Folder::create(args.out.clone())?;
    let rounds = usize::from(args.rounds);
    #[cfg(feature = "gpu")]
    if args.only_card {
        let mut table = table(&[]);
        super::card::add(&args.sizes, rounds, &[], &mut table)?;
        console::print(format_args!("{}", table.to_text()));
        folder.write_table("kernels.csv", &table)?;
        folder.finish();
        return Ok(());
    }
    if args.measures_all() {
        kernels(args, &folder)?;
    }
    if args.only_scene || args.measures_all() {
        team::inside(|| super::mesh_scene::run(rounds, &folder))?;
    }
    let sizes = without_none(&args.converged);
    if !args.only_pareto && !args.only_scene && !sizes.is_empty() {
        team::inside(|| super::race::run(sizes, rounds, &folder))?;
    }
    let scenes = if args.only_converged || args.only_scene { Vec::new() } else { scenes(args)? };
    if !scenes.is_empty() {
        team::inside(|| super::pareto::run(&scenes, rounds, &folder))?;
    }
    say!("\n{}", folder.path().display());
    folder.finish();
    Ok(())
}

fn without_none(sizes: &[usize]) -> Vec<usize> {
    sizes.iter().copied().filter(|size| *size > 0).collect()
}

/// The scenes for time against error, with their names.
fn scenes(args: &BenchArgs) -> Result<Vec<(String, Problem)>, CliError> {
    if args.presets.is_empty() {
        let sizes = without_none(&args.pareto).into_iter();
        let descent = args.descent.of(Descent::Off)?;
        let made = sizes.flat_map(|size| synthetic::scenes(size, args.factor.unwrap_or(3.0)));
        let descending = |(name, mut problem): (&str, Problem)| {
            problem.propagation.descent = descent;
            (name.to_owned(), problem)
        };
        return Ok(made.map(descending).collect());
    }
    let preset = |path: &PathBuf| {
        let scene_args = SceneArgs {
            preset: path.clone(),
            factor: args.factor,
            descent: args.descent.clone(),
            ..SceneArgs::default()
        };
        Ok((scene_args.stem(), scene_args.load()?.1))
    };
    args.presets.iter().map(preset).collect()
}

/// The loops by themselves.
fn kernels(args: &BenchArgs, folder: &Folder) -> Result<(), CliError> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = match args.threads.as_slice() {
        [] if cores > 1 => vec![1, cores],
        [] => vec![1],
        some => some.to_vec(),
    };
    let pools = threads.into_iter().map(benchmark::pool).collect::<Result<Vec<_>, _>>()?;
    let plan = benchmark::Plan { sizes: args.sizes.clone(), rounds: usize::from(args.rounds) };
    let bar = if std::io::stderr().is_terminal() { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    let rows = benchmark::kernels(&plan, &pools, |now| {
        bar.set_message(now.to_owned());
        bar.tick();
    })?;
    bar.finish_and_clear();

    #[cfg_attr(not(feature = "gpu"), expect(unused_mut))]
    let mut table = table(&rows);
    #[cfg(feature = "gpu")]
    if args.device == super::load::DeviceArg::Gpu {
        super::card::add(&args.sizes, usize::from(args.rounds), &rows, &mut table)?;
    }
    console::print(format_args!("{}", table.to_text()));
    say!("\ntriad_fraction counts {} bytes a cell and iteration", benchmark::BYTES_PER_CELL);
    for pool in &pools {
        print_pipeline(&pool.install(|| Pipeline::measure(101))?);
    }
    print_fading(&benchmark::pool(1)?.install(Fading::measure)?);
    folder.write_table("kernels.csv", &table)?;
    folder.write_svg_and_png("kernels", &figure(&rows).to_svg())
}

/// The rows as `kernels.csv` has them.
fn table(rows: &[KernelRow]) -> Table<9> {
    let mut table = Table::new([
        "scheme",
        "size",
        "threads",
        "kernel",
        "ns_per_cell",
        "over_aos",
        "triad_fraction",
        "visited",
        "peak_bytes",
    ]);
    for row in rows {
        table.push([
            row.scheme.into(),
            row.size.into(),
            row.threads.into(),
            row.kernel.into(),
            row.ns_per_cell.into(),
            row.over_aos.into(),
            row.triad_fraction.into(),
            row.visited.into(),
            row.peak_bytes.into(),
        ]);
    }
    table
}

fn print_pipeline(pipeline: &Pipeline) {
    let Pipeline { threads, channels, stages, bytes } = pipeline;
    let stages: Vec<String> = stages.iter().map(|(name, seconds)| format!("{name} {:.3} ms", 1e3 * seconds)).collect();
    say!(
        "\nThe thesis's setting (n = 32, four iterations, {channels} channels) on {threads} threads: {}",
        stages.join(", ")
    );
    let milliseconds = 1e3 * pipeline.propagation();
    say!(
        "Propagation takes 1/{:.1} of the thesis's {THESIS_MILLISECONDS} ms; light and marks take {:.2} MB",
        THESIS_MILLISECONDS / milliseconds,
        *bytes as f64 / 1e6
    );
}

fn print_fading(Fading { computed, skipped }: &Fading) {
    let line = |hundreds: &[f64]| {
        let slowest = hundreds.iter().copied().fold(0.0, f64::max);
        let (first, last) = (hundreds.first().copied().unwrap_or(0.0), hundreds.last().copied().unwrap_or(0.0));
        format!("{first:.3} ns a cell in the first hundred, {last:.3} in the last, {slowest:.3} in the slowest")
    };
    say!("\nOne wall fading for 2000 iterations (n = 32, p = 3, one thread): {}", line(computed));
    say!("The same with skipping: {}", line(skipped));
}

/// Time over size of every loop that works on a whole level, cascaded scheme, a plot for each number of threads.
fn figure(rows: &[KernelRow]) -> Figure {
    let mut threads: Vec<usize> = rows.iter().map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let plots = threads.into_iter().map(|threads| {
        let ours = |row: &&KernelRow| row.threads == threads && row.scheme == "cascaded" && row.visited == 1.0;
        let mut kernels: Vec<&str> = Vec::new();
        for row in rows.iter().filter(ours) {
            if !kernels.contains(&row.kernel) {
                kernels.push(row.kernel);
            }
        }
        let curves = kernels.into_iter().enumerate().map(|(color, kernel)| {
            let points = rows.iter().filter(ours).filter(|row| row.kernel == kernel);
            let points = points.map(|row| [(row.size as f64).log2(), row.ns_per_cell]).collect();
            Curve { name: kernel.to_owned(), points, color, dash: Dash::Solid }
        });
        Plot {
            title: format!("{threads} {}", if threads == 1 { "thread" } else { "threads" }),
            x_label: "log₂ of the side n".to_owned(),
            y_label: "ns per cell and iteration".to_owned(),
            log_y: true,
            curves: curves.collect(),
            ..Plot::default()
        }
    });
    Figure {
        title: "Time of one cell and iteration".to_owned(),
        plots: plots.collect(),
        theme: Theme::LIGHT,
        size: [900, 900],
    }
}
