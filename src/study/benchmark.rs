//! How fast the loops are: against the usual way of writing them, against the machine's memory, and with
//! each kind of skipping off.
//!
//! All loops of one size are timed in turn, several rounds of it, and medians are reported: what else the
//! machine does then meets all of them alike, and ratios from one run can be trusted where times cannot.

pub(crate) mod aos;
#[cfg(feature = "gpu")]
pub(crate) mod card;
mod dense;
mod fading;
pub(crate) mod mesh_scene;
mod pipeline;
mod skipping;
mod triad;

use std::time::Instant;

use rayon::ThreadPool;

use crate::scene::SceneError;
use crate::simulation::Refusal;
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::schemes;

use dense::{Dense, Loop};
pub use fading::Fading;
pub use pipeline::{Pipeline, THESIS_MILLISECONDS};
use triad::Triad;

/// Bytes that one cell of a stepping iteration has to move: source read, target written, sum read and
/// written, each of four f32. That a write reads its cache line first is not counted, as in the triad.
pub const BYTES_PER_CELL: f64 = 64.0;

/// Why nothing could be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchmarkError {
    /// A size that makes no volume.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A setting that cannot be run.
    #[error(transparent)]
    Simulation(#[from] Refusal),
    /// What belongs to built-in presets has no place.
    #[error("{0}")]
    Folder(String),
    /// No threads to run on.
    #[error("cannot start {threads} threads: {why}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system says.
        why: String,
    },
}

/// What to measure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Sides of the volumes, powers of two.
    pub sizes: Vec<usize>,
    /// Rounds over all loops; the median of them is reported.
    pub rounds: usize,
}

/// One loop, as `kernels.csv` has it.
#[derive(Clone, Debug, PartialEq)]
pub struct KernelRow {
    /// The scheme.
    pub scheme: &'static str,
    /// The side of the volume.
    pub size: usize,
    /// Threads that it ran on.
    pub threads: usize,
    /// The loop: `aos`, `plain`, `fast`, `fast-clamped`, `blocked`, or a scene and what was not skipped.
    pub kernel: &'static str,
    /// Nanoseconds for each cell of the volume (of all levels, for a scene) and iteration.
    pub ns_per_cell: f64,
    /// How many times as fast as `aos` of the cascaded scheme at that size, on one thread.
    pub over_aos: f64,
    /// [`BYTES_PER_CELL`] over the time, as a part of the triad's bandwidth on as many threads.
    pub triad_fraction: f64,
    /// Cells computed over cells in the volume.
    pub visited: f64,
    /// Bytes that it holds.
    pub peak_bytes: usize,
}

/// One timing.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    seconds: f64,
    /// Cells of the volume, times iterations.
    cells: usize,
    visited: usize,
}

impl Sample {
    /// What was done since `started`.
    fn new(started: Instant, cells: usize, visited: usize) -> Self {
        Sample { seconds: started.elapsed().as_secs_f64(), cells, visited }
    }
}

/// What a row is made of.
struct Series {
    scheme: &'static str,
    threads: usize,
    kernel: &'static str,
    samples: Vec<Sample>,
    bytes: usize,
}

/// Measures everything in the plan, each number of threads in the one of the `pools` that has it; `tell` hears
/// what comes next.
pub fn kernels(
    plan: &Plan,
    pools: &[ThreadPool],
    mut tell: impl FnMut(&str),
) -> Result<Vec<KernelRow>, BenchmarkError> {
    let mut rows = Vec::new();
    let threads: Vec<usize> = pools.iter().map(ThreadPool::current_num_threads).collect();
    for &size in &plan.sizes {
        let mut series: Vec<Series> = Vec::new();
        let mut bandwidth = vec![Vec::new(); pools.len()];
        let (mut dense, mut triad) = (Dense::new(size), Triad::new());
        for round in 1..=plan.rounds {
            for (pool, bandwidth) in pools.iter().zip(&mut bandwidth) {
                tell(&format!("n = {size}, {} threads, round {round} of {}", pool.current_num_threads(), plan.rounds));
                pool.install(|| {
                    bandwidth.push(triad.bandwidth());
                    once(size, &mut dense, &mut series)
                })?;
            }
        }
        let bandwidth: Vec<f64> = bandwidth.iter_mut().map(|passes| median(passes)).collect();
        rows.extend(table(size, series, &threads, &bandwidth));
    }
    Ok(rows)
}

/// Times everything once on the current threads.
fn once(size: usize, dense: &mut Dense, series: &mut Vec<Series>) -> Result<(), BenchmarkError> {
    let threads = rayon::current_num_threads();
    for scheme in schemes::all() {
        for which in loops(&scheme, threads) {
            if let Some(sample) = dense.sample(which, &scheme) {
                keep(series, (scheme.name, threads, which.name()), sample, dense.bytes(which));
            }
        }
    }
    for case in skipping::CASES {
        let (sample, bytes) = case.sample(size)?;
        keep(series, ("cascaded", threads, case.name), sample, bytes);
    }
    Ok(())
}

/// The loops that are worth timing for a scheme: the baseline is written for one scheme and one thread.
fn loops(scheme: &Scheme, threads: usize) -> impl Iterator<Item = Loop> + use<> {
    let first = scheme.name == schemes::all()[0].name;
    Loop::ALL.into_iter().filter(move |which| match which {
        Loop::Aos => first && threads == 1,
        other => threads == 1 || other.is_threaded(),
    })
}

fn keep(series: &mut Vec<Series>, key: (&'static str, usize, &'static str), sample: Sample, bytes: usize) {
    let known = series.iter_mut().find(|s| (s.scheme, s.threads, s.kernel) == key);
    match known {
        Some(known) => known.samples.push(sample),
        None => {
            let (scheme, threads, kernel) = key;
            series.push(Series { scheme, threads, kernel, samples: vec![sample], bytes });
        }
    }
}

fn table(size: usize, series: Vec<Series>, threads: &[usize], bandwidth: &[f64]) -> Vec<KernelRow> {
    let nanoseconds = |series: &Series| -> f64 {
        let mut each: Vec<f64> = series.samples.iter().map(|s| 1e9 * s.seconds / s.cells as f64).collect();
        median(&mut each)
    };
    let aos = series.iter().find(|s| s.kernel == Loop::Aos.name()).map_or(f64::NAN, nanoseconds);
    let row = |series: &Series| {
        let ns_per_cell = nanoseconds(series);
        let triad = threads.iter().zip(bandwidth).find(|(t, _)| **t == series.threads).map_or(f64::NAN, |(_, b)| *b);
        let (cells, visited) = series.samples.iter().fold((0, 0), |(c, v), s| (c + s.cells, v + s.visited));
        KernelRow {
            scheme: series.scheme,
            size,
            threads: series.threads,
            kernel: series.kernel,
            ns_per_cell,
            over_aos: aos / ns_per_cell,
            triad_fraction: BYTES_PER_CELL / (ns_per_cell * 1e-9) / triad,
            visited: visited as f64 / cells as f64,
            peak_bytes: series.bytes,
        }
    };
    series.iter().map(row).collect()
}

/// So many threads. A pool takes a while to spread over the cores, so it is best kept for all measurements.
pub fn pool(threads: usize) -> Result<ThreadPool, BenchmarkError> {
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    built.map_err(|why| BenchmarkError::Threads { threads, why: why.to_string() })
}

/// The median, the mean of the middle two of an even number; 0 of nothing.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_medians() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median(&mut []), 0.0);
    }

    #[test]
    fn a_plan_measures_every_loop_and_says_what_was_skipped() {
        let pools = [1, 2].map(|threads| pool(threads).unwrap());
        let rows = kernels(&Plan { sizes: vec![32], rounds: 1 }, &pools, |_| ()).unwrap();
        let find = |kernel: &str, threads: usize| {
            let row = rows.iter().find(|r| (r.scheme, r.kernel, r.threads) == ("cascaded", kernel, threads));
            row.unwrap_or_else(|| panic!("{kernel} on {threads}"))
        };
        for which in Loop::ALL {
            let row = find(which.name(), 1);
            assert!(row.ns_per_cell > 0.0 && row.visited == 1.0, "{row:?}");
        }
        assert_eq!(find("aos", 1).over_aos, 1.0);
        assert_eq!(find("lobe-no-skip", 2).visited, 1.0);
        assert!(find("lobe", 2).visited < find("lobe-no-reach", 2).visited);
        assert!(find("walls-merged", 1).visited < find("walls-merged-no-unmerged", 1).visited);
        assert!(rows.iter().all(|row| row.triad_fraction > 0.0 && row.peak_bytes > 0));
    }
}
