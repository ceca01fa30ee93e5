//! How fast a graphics card steps, against its own memory.

use super::{BYTES_PER_CELL, median};
use crate::field::{IndexVolume, Levels, Octree};
use crate::sh::Sh;
use crate::transport::gpu::device::{Device, DeviceError};
use crate::transport::gpu::text::Constants;
use crate::transport::gpu::volume::{Masks, Mode, Volume};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::schemes::cascaded;
use crate::transport::lattice::stencil::Stencil;

/// One loop on a card, as `kernels.csv` has it.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRow {
    /// The side of the volume.
    pub size: usize,
    /// What was done: `card-linear` and `card-clamped`, steps of one level with the sum; `card-thesis`, four iterations of
    /// three channels on all levels.
    pub kernel: &'static str,
    /// Microseconds of one iteration; for `card-thesis` of all four.
    pub microseconds: f64,
    /// Nanoseconds for each cell and iteration.
    pub ns_per_cell: f64,
    /// [`BYTES_PER_CELL`] over the time, as a part of the card's own copy bandwidth; over 1 in its cache.
    pub copy_fraction: f64,
    /// Whether the time is that of the card's own clock; else it is what passes until the card answers.
    pub by_its_clock: bool,
    /// Bytes that it holds.
    pub bytes: u64,
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

/// Steps `cascaded` at p = 4 on the card in volumes of these sides, medians of so many rounds.
///
/// # Errors
/// Where there is no card, or it has no room.
pub fn card(sizes: &[Levels], rounds: usize) -> Result<CardFindings, DeviceError> {
    let card = Device::shared()?;
    let copy_bandwidth = card.copy_bandwidth(rounds)?;
    let linear = Mode { linear: true, ..Mode::default() };
    let mut cases = Vec::new();
    for one_level in sizes {
        // So many that a launch hardly counts.
        let iterations = ((1 << 27) / one_level.cells()).clamp(16, 512);
        cases.push(("card-linear", *one_level, 1, linear, iterations));
        cases.push(("card-clamped", *one_level, 1, Mode::default(), iterations));
    }
    if let Some(octree) = Levels::new(32, 1) {
        cases.push(("card-thesis", octree, 3, Mode { decide: true, ..linear }, 4));
    }
    let mut rows = Vec::new();
    for (kernel, sizes, channels, mode, iterations) in cases {
        let (seconds, by_its_clock) = time(card, sizes, channels, &vec![mode; iterations], rounds)?;
        let iterations = iterations as f64;
        let ns_per_cell = 1e9 * seconds / iterations / (channels * sizes.cells()) as f64;
        rows.push(CardRow {
            size: sizes.finest(),
            kernel,
            microseconds: 1e6 * if kernel == "card-thesis" { seconds } else { seconds / iterations },
            ns_per_cell,
            copy_fraction: BYTES_PER_CELL / (ns_per_cell * 1e-9) / copy_bandwidth,
            by_its_clock,
            bytes: Volume::bytes(sizes, channels),
        });
    }
    Ok(CardFindings { name: card.name().to_owned(), copy_bandwidth, rows })
}

/// Seconds that these iterations take, in a volume that is lit all over, and whether the card's clock says so.
fn time(
    card: &'static Device,
    sizes: Levels,
    channels: usize,
    modes: &[Mode],
    rounds: usize,
) -> Result<(f64, bool), DeviceError> {
    let stencil = Stencil::<f32>::new(&cascaded::scheme(), 4.0, true);
    let Some(form) = Form::of(&stencil) else { return Ok((f64::NAN, false)) };
    let constants = Constants { levels: vec![(form, stencil); sizes.count()], plain: false, solids: None };
    let mut volume = Volume::new(card, sizes, channels, &constants, &Masks::default())?;
    let (mut lit, dark) = (Octree::new(sizes), Octree::new(sizes));
    for level in lit.levels_mut() {
        let cells = level.layout().cells();
        cells.for_each(|cell| level.set(cell, Sh([1.0, 0.1, 0.0, -0.1])));
    }
    let linear = vec![vec![modes.iter().all(|mode| mode.linear); sizes.count()]; channels];
    volume.load(&vec![[&lit, &dark]; channels], &IndexVolume::new(sizes), &linear);
    // The first round also wakes the card up.
    volume.time(modes)?;
    let (mut seconds, mut by_its_clock) = (Vec::new(), true);
    for _ in 0..rounds {
        let (time, clock) = volume.time(modes)?;
        seconds.push(time);
        by_its_clock &= clock;
    }
    Ok((median(&mut seconds), by_its_clock))
}
