//! Where light lies in the card's memory, and how an iteration is cut into dispatches.
//!
//! All levels of a channel lie one behind the other in a *bank*, cell by cell; all channels share a bank where a
//! binding holds them all. Then an iteration is one dispatch. Where a binding is smaller than a bank (128 MiB on a
//! software driver), every dispatch takes some slabs of one level, bound with the slab before and the slab behind, and
//! the coarser levels follow in one.

use bytemuck::{Pod, Zeroable};

use crate::field::Levels;

/// Bytes of a cell.
pub const CELL: u64 = 16;
/// Cells that a workgroup computes.
pub const GROUP: usize = 256;
/// The most jobs of a dispatch.
pub const MOST_JOBS: usize = 64;
/// Levels begin at multiples of so many cells: bindings begin at multiples of 256 bytes.
const ALIGN: u64 = 16;

/// Some slabs of one level of one channel, as the kernels know them (`Job` in `kernels/light.wgsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Job {
    /// The first workgroup that works on it.
    pub first_group: u32,
    /// Cells along a side of the level.
    pub side: u32,
    /// Their logarithm to base 2.
    pub bits: u32,
    /// The level, 0 the finest.
    pub level: u32,
    /// Where slab `z_read` begins in the source's binding, in cells.
    pub source_at: u32,
    /// Where slab `z_first` begins in the target's binding, in cells.
    pub target_at: u32,
    /// The first slab that the source's binding holds.
    pub z_read: u32,
    /// The first slab to compute.
    pub z_first: u32,
    /// How many.
    pub z_count: u32,
    /// Which entry of the decisions is this level's and channel's.
    pub decision: u32,
    /// Where slab `z_first` begins among the marks, in words.
    pub words_at: u32,
    /// Words of 32 cells that a row takes there.
    pub row_words: u32,
}

/// A run of cells of a bank, to be bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Its first cell.
    pub first: u64,
    /// How many cells.
    pub cells: u64,
}

/// One dispatch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The bank that it works in.
    pub bank: usize,
    /// What of the source it reads.
    pub source: Span,
    /// What of the target and the sum it writes.
    pub target: Span,
    /// What it computes.
    pub jobs: Vec<Job>,
    /// Its workgroups.
    pub groups: u32,
}

/// Where everything lies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    sizes: Levels,
    channels: usize,
    shared: bool,
    starts: Vec<u64>,
    octree: u64,
    words: Vec<u64>,
}

impl Layout {
    /// The layout of `channels` octrees, `binding` bytes being the most that a dispatch may bind of a buffer.
    pub fn new(sizes: Levels, channels: usize, binding: u64) -> Self {
        let mut starts = Vec::new();
        let (mut octree, mut words, mut word) = (0, Vec::new(), 0);
        for side in sizes.sides() {
            starts.push(octree);
            octree += ((side as u64).pow(3)).next_multiple_of(ALIGN);
            words.push(word);
            word += (side * side * row_words(side)) as u64;
        }
        words.push(word);
        let shared = octree * channels as u64 * CELL <= binding;
        Layout { sizes, channels, shared, starts, octree, words }
    }

    /// How many banks there are.
    pub fn banks(&self) -> usize {
        if self.shared { 1 } else { self.channels }
    }

    /// Cells of each.
    pub fn bank_cells(&self) -> u64 {
        if self.shared { self.octree * self.channels as u64 } else { self.octree }
    }

    /// The bank of a level of a channel, and its first cell in there.
    pub fn place(&self, channel: usize, level: usize) -> (usize, u64) {
        let start = self.starts[level];
        if self.shared { (0, channel as u64 * self.octree + start) } else { (channel, start) }
    }

    /// The first word of a level's marks; one past the last level, how many words there are.
    pub fn words(&self, level: usize) -> u64 {
        self.words[level]
    }

    /// The entry of a level of a channel among the decisions.
    pub fn decision(&self, channel: usize, level: usize) -> usize {
        channel * self.sizes.count() + level
    }

    /// How many decisions there are.
    pub fn decisions(&self) -> usize {
        self.channels * self.sizes.count()
    }

    /// The dispatches of one iteration, `binding` bytes being the most that one may bind of a buffer. `None` where
    /// even one slab with its neighbours is more than that.
    pub fn passes(&self, binding: u64) -> Option<Vec<Pass>> {
        let most = binding / CELL;
        let whole = Span { first: 0, cells: self.bank_cells() };
        if whole.cells <= most {
            let passes = (0..self.banks()).map(|bank| {
                let channels = if self.shared { 0..self.channels } else { bank..bank + 1 };
                let each = channels.flat_map(|c| (0..self.sizes.count()).map(move |i| (c, i)));
                self.together(bank, whole, each)
            });
            return Some(passes.collect());
        }
        let mut passes = Vec::new();
        for channel in 0..self.channels {
            let mut level = 0;
            // The finest levels by slabs, until all that is left can be bound at once.
            while level < self.sizes.count() && self.octree - self.starts[level] > most {
                passes.extend(self.slabs(channel, level, most)?);
                level += 1;
            }
            if level < self.sizes.count() {
                let (bank, first) = self.place(channel, level);
                let rest = Span { first, cells: self.octree - self.starts[level] };
                passes.push(self.together(bank, rest, (level..self.sizes.count()).map(|i| (channel, i))));
            }
        }
        Some(passes)
    }

    /// Whole levels in one dispatch.
    fn together(&self, bank: usize, span: Span, levels: impl Iterator<Item = (usize, usize)>) -> Pass {
        let mut pass = Pass { bank, source: span, target: span, jobs: Vec::new(), groups: 0 };
        for (channel, level) in levels {
            let at = (self.place(channel, level).1 - span.first) as u32;
            let job = self.job(channel, level, 0..self.sizes.side(level));
            pass.push(Job { source_at: at, target_at: at, ..job });
        }
        pass
    }

    /// A level by slabs.
    fn slabs(&self, channel: usize, level: usize, most: u64) -> Option<Vec<Pass>> {
        let n = self.sizes.side(level);
        let slab = (n * n) as u64;
        let together = (most / slab).checked_sub(2).filter(|slabs| *slabs > 0)? as usize;
        let (bank, start) = self.place(channel, level);
        let pass = |first: usize| {
            let z = first..n.min(first + together);
            let read = first.saturating_sub(1)..n.min(z.end + 1);
            let span = |z: &std::ops::Range<usize>| Span {
                first: start + z.start as u64 * slab,
                cells: z.len() as u64 * slab,
            };
            let mut pass = Pass { bank, source: span(&read), target: span(&z), jobs: Vec::new(), groups: 0 };
            pass.push(Job { z_read: read.start as u32, ..self.job(channel, level, z) });
            pass
        };
        Some((0..n).step_by(together).map(pass).collect())
    }

    fn job(&self, channel: usize, level: usize, z: std::ops::Range<usize>) -> Job {
        let n = self.sizes.side(level);
        let words = self.words[level] + (z.start * n * row_words(n)) as u64;
        Job {
            first_group: 0,
            side: n as u32,
            bits: n.ilog2(),
            level: level as u32,
            source_at: 0,
            target_at: 0,
            z_read: 0,
            z_first: z.start as u32,
            z_count: z.len() as u32,
            decision: self.decision(channel, level) as u32,
            words_at: words as u32,
            row_words: row_words(n) as u32,
        }
    }
}

impl Pass {
    fn push(&mut self, job: Job) {
        let cells = job.z_count as usize * (job.side as usize).pow(2);
        self.jobs.push(Job { first_group: self.groups, ..job });
        self.groups += cells.div_ceil(GROUP) as u32;
    }
}

/// Words of 32 cells that a row of marks takes: it is kept in whole words of 64.
pub fn row_words(side: usize) -> usize {
    2 * side.div_ceil(64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every cell of every level and channel is computed once, and all its neighbours are bound.
    #[test]
    fn passes_cover_every_cell_once_with_its_neighbours() {
        let sizes = Levels::new(32, 1).unwrap();
        for (binding, channels) in [(1 << 30, 3), (600 << 10, 2), (200 << 10, 1), (50 << 10, 3)] {
            let layout = Layout::new(sizes, channels, binding);
            let mut computed = vec![vec![0u8; layout.bank_cells() as usize]; layout.banks()];
            for pass in layout.passes(binding).unwrap() {
                assert!(pass.source.cells.max(pass.target.cells) * CELL <= binding);
                assert!(pass.source.first % ALIGN == 0 && pass.target.first % ALIGN == 0);
                for job in &pass.jobs {
                    let slab = u64::from(job.side).pow(2);
                    let first = pass.target.first + u64::from(job.target_at);
                    for cell in first..first + u64::from(job.z_count) * slab {
                        computed[pass.bank][cell as usize] += 1;
                    }
                    let read = pass.source.first + u64::from(job.source_at);
                    assert_eq!(read + u64::from(job.z_first - job.z_read) * slab, first);
                    assert!(job.z_first == 0 || job.z_read < job.z_first || pass.jobs.len() > 1);
                    let behind = u64::from((job.z_first + job.z_count + 1).min(job.side) - job.z_read) * slab;
                    assert!(read + behind <= pass.source.first + pass.source.cells);
                }
            }
            for (channel, level) in (0..channels).flat_map(|c| (0..sizes.count()).map(move |i| (c, i))) {
                let (bank, at) = layout.place(channel, level);
                let cells = sizes.side(level).pow(3);
                assert!(computed[bank][at as usize..at as usize + cells].iter().all(|times| *times == 1));
            }
            let total: usize = computed.iter().flatten().map(|times| usize::from(*times)).sum();
            assert_eq!(total, channels * sizes.cells());
        }
        assert_eq!(Layout::new(sizes, 1, 1 << 10).passes(1 << 10), None);
    }
}
