//! How fast a graphics card steps, against its own memory.

use std::time::Instant;

use super::{BYTES_PER_CELL, median};
use crate::field::{IndexVolume, Levels, Octree};
use crate::sh::Sh;
use crate::transport::gpu::device::{Device, DeviceError};
use crate::transport::gpu::text::Constants;
use crate::transport::gpu::volume::{Masks, Mode, Volume};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::schemes::cascaded;
use crate::transport::lattice::stencil::Stencil;

/// One loop on a card, as `card.csv` has it.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRow {
    /// The side of the volume.
    pub size: usize,
    /// What was done: `linear` and `clamped` steps of one level with the sum, `thesis` (three channels, all levels, four
    /// iterations).
    pub what: &'static str,
    /// Microseconds of one iteration; for `thesis` of all four.
    pub microseconds: f64,
    /// Nanoseconds for each cell and iteration.
    pub ns_per_cell: f64,
    /// 64 bytes a cell over the time, as a part of the card's own copy bandwidth; over 1 in its cache.
    pub copy_fraction: f64,
}

/// What a card does, and how fast it copies.
#[derive(Clone, Debug, PartialEq)]
pub struct CardFindings {
    /// What its driver calls it.
    pub name: String,
    /// Bytes read and written in a second by a copy on the card.
    pub copy_bandwidth: f64,
    /// What was measured.
    pub rows: Vec<CardRow>,
}

/// Steps `cascaded` at p = 4 on the card in volumes of these sides, medians of so many rounds. Times are those of the
/// wall clock, over as many iterations as take some tens of milliseconds.
///
/// # Errors
/// Where there is no card, or it has no room.
pub fn card(sizes: &[Levels], rounds: usize) -> Result<CardFindings, DeviceError> {
    let card = Device::shared()?;
    let copy_bandwidth = card.copy_bandwidth(rounds)?;
    let mut rows = Vec::new();
    let mut measure = |what, sizes: Levels, channels: usize, mode: Mode, times: f64| -> Result<(), DeviceError> {
        let seconds = time(card, sizes, channels, mode, rounds)?;
        let ns_per_cell = 1e9 * seconds / (channels * sizes.cells()) as f64;
        let copy_fraction = BYTES_PER_CELL / (ns_per_cell * 1e-9) / copy_bandwidth;
        rows.push(CardRow {
            size: sizes.finest(),
            what,
            microseconds: times * 1e6 * seconds,
            ns_per_cell,
            copy_fraction,
        });
        Ok(())
    };
    for one_level in sizes {
        measure("linear", *one_level, 1, Mode { linear: true, ..Mode::default() }, 1.0)?;
        measure("clamped", *one_level, 1, Mode::default(), 1.0)?;
    }
    if let Some(octree) = Levels::new(32, 1) {
        measure("thesis", octree, 3, Mode { linear: true, decide: true, ..Mode::default() }, 4.0)?;
    }
    Ok(CardFindings { name: card.name().to_owned(), copy_bandwidth, rows })
}

/// Seconds of an iteration.
fn time(card: &'static Device, sizes: Levels, channels: usize, mode: Mode, rounds: usize) -> Result<f64, DeviceError> {
    let stencil = Stencil::<f32>::new(&cascaded::scheme(), 4.0, true);
    let Some(form) = Form::of(&stencil) else { return Ok(f64::NAN) };
    let constants = Constants { levels: vec![(form, stencil); sizes.count()], plain: false, solids: None };
    let mut volume = Volume::new(card, sizes, channels, &constants, &Masks::default())?;
    let (mut lit, dark) = (Octree::new(sizes), Octree::new(sizes));
    for level in lit.levels_mut() {
        let cells = level.layout().cells();
        cells.for_each(|cell| level.set(cell, Sh([1.0, 0.1, 0.0, -0.1])));
    }
    let linear = vec![vec![mode.linear; sizes.count()]; channels];
    volume.load(&vec![[&lit, &dark]; channels], &IndexVolume::new(sizes), &linear);
    // So many that a launch hardly counts.
    let iterations = ((1 << 27) / sizes.cells()).clamp(16, 512);
    let modes = vec![mode; iterations];
    volume.iterate(&modes);
    card.wait()?;
    let mut seconds = Vec::new();
    for _ in 0..rounds {
        let started = Instant::now();
        volume.iterate(&modes);
        card.wait()?;
        seconds.push(started.elapsed().as_secs_f64() / iterations as f64);
    }
    Ok(median(&mut seconds))
}
