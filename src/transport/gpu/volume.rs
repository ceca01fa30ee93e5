//! Octrees of light in the card's memory, and what is done to them there.

use bytemuck::{Pod, Zeroable};

use super::device::{Clock, Device, DeviceError};
use super::layout::{CELL, Job, Layout, MOST_JOBS, Pass, Span, row_words};
use super::pipeline::{bind_group, pipeline};
use super::text::{Constants, Kernel};
use crate::field::{Grid, IndexVolume, Levels, Octree};

/// Iterations that are sent to the card at a time.
const TOGETHER: usize = 64;
/// Bytes from one step's constants to the next one's.
const STEP_STRIDE: u64 = 256;

/// How an iteration is done (`MODE_*` in `kernels/light.wgsl`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mode {
    /// The linear form, where a level's light needs no clamp.
    pub linear: bool,
    /// Look whether the new light needs a clamp.
    pub decide: bool,
    /// Keep the source in the target.
    pub keep: bool,
    /// Tap by tap, by the definition.
    pub plain: bool,
    /// Leave the cells that solids touch to their own kernel.
    pub solids: bool,
    /// Only the cells of a mask accumulate.
    pub masked: bool,
    /// Blockers weaken light.
    pub occlude: bool,
}

impl Mode {
    fn bits(self) -> u32 {
        let Mode { linear, decide, keep, plain, solids, masked, occlude } = self;
        [linear, decide, keep, plain, solids, masked, occlude]
            .into_iter()
            .enumerate()
            .map(|(i, on)| u32::from(on) << i)
            .sum()
    }
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Step {
    zero: u32,
    mode: u32,
    slot: u32,
    backwards: u32,
}

/// A cell that a solid touches (`Touched` in `kernels/solids.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TouchedCell {
    /// The channel.
    pub channel: usize,
    /// The colour whose albedo counts, 0 to 2.
    pub colour: usize,
    /// The level.
    pub level: usize,
    /// The cell, x fastest.
    pub cell: usize,
    /// Where its neighbourhood begins in [`Masks::around`].
    pub around_at: usize,
}

/// Which cells are not like others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Masks {
    /// The cells that solids touch.
    pub touched: Vec<TouchedCell>,
    /// What is around them.
    pub around: Vec<[f32; 4]>,
    /// By level, a bit for each cell that accumulates, in rows as `Marks` keeps them; empty where all do.
    pub accumulating: Vec<Vec<u64>>,
}

/// What a dispatch is bound to, for each way round of source and target.
#[derive(Debug)]
struct Bound {
    groups: u32,
    propagate: [wgpu::BindGroup; 2],
    /// The cells that solids touch, and the workgroups that they take.
    solids: Option<([wgpu::BindGroup; 2], u32)>,
}

/// All channels of light on all levels, in the card's memory.
#[derive(Debug)]
pub struct Volume {
    card: &'static Device,
    sizes: Levels,
    layout: Layout,
    /// Source and target in turn, then the sum; by bank.
    light: [Vec<wgpu::Buffer>; 3],
    marks: wgpu::Buffer,
    decisions: wgpu::Buffer,
    steps: wgpu::Buffer,
    propagate: wgpu::ComputePipeline,
    solids: Option<wgpu::ComputePipeline>,
    bound: Vec<Bound>,
    /// Whether source and target have changed places.
    turned: bool,
    /// Iterations done, modulo 3.
    slot: u32,
}

impl Volume {
    /// Bytes of the card's memory that a volume takes, about.
    pub fn bytes(sizes: Levels, channels: usize) -> u64 {
        let marks = sizes.cells() as u64 / 8;
        3 * CELL * (sizes.cells() * channels) as u64 + 3 * marks
    }

    /// A dark volume.
    pub fn new(
        card: &'static Device,
        sizes: Levels,
        channels: usize,
        constants: &Constants,
        masks: &Masks,
    ) -> Result<Self, DeviceError> {
        let limits = card.limits();
        let binding = limits.max_storage_buffer_binding_size & !255;
        let layout = Layout::new(sizes, channels, binding);
        let failed = |what: String| DeviceError::Failed { name: card.name().to_owned(), what };
        let bank = layout.bank_cells() * CELL;
        if bank > limits.max_buffer_size {
            return Err(failed(format!("a buffer of {bank} bytes is more than its {}", limits.max_buffer_size)));
        }
        let passes = layout.passes(binding).ok_or_else(|| failed(format!("it binds {binding} bytes at most")))?;
        card.tried(|_| Self::build(card, sizes, layout, &passes, constants, masks))
    }

    fn build(
        card: &'static Device,
        sizes: Levels,
        layout: Layout,
        passes: &[Pass],
        constants: &Constants,
        masks: &Masks,
    ) -> Self {
        let light = ["light a", "light b", "accumulated"]
            .map(|label| (0..layout.banks()).map(|_| card.storage(label, layout.bank_cells() * CELL)).collect());
        let words = layout.words(sizes.count());
        let marks = card.storage("marks", 4 * words);
        let decisions = card.storage("decisions", 16 * layout.decisions() as u64);
        let steps = card.uniform("steps", TOGETHER as u64 * STEP_STRIDE);
        let mask_words = mask_words(&layout, sizes, masks);
        let masked = card.storage("masks", 4 * mask_words.len() as u64);
        card.write(&masked, 0, bytemuck::cast_slice(&mask_words));
        let around = card.storage("around", 16 * masks.around.len() as u64);
        card.write(&around, 0, bytemuck::cast_slice(&masks.around));
        let has_solids = !masks.touched.is_empty();
        let propagate = pipeline(card, Kernel::Propagate, constants);
        let solids = has_solids.then(|| pipeline(card, Kernel::Solids, constants));
        let mut volume = Volume {
            card,
            sizes,
            layout,
            light,
            marks,
            decisions,
            steps,
            propagate,
            solids,
            bound: Vec::new(),
            turned: false,
            slot: 0,
        };
        volume.bound = passes.iter().map(|pass| volume.bind(pass, &masked, &around, masks)).collect();
        volume
    }

    fn bind(&self, pass: &Pass, masked: &wgpu::Buffer, around: &wgpu::Buffer, masks: &Masks) -> Bound {
        let jobs = jobs_buffer(self.card, pass);
        let [a, b, sum] = self.light.each_ref().map(|banks| &banks[pass.bank]);
        let common = |source, target| {
            vec![
                (0, jobs.as_entire_binding()),
                (1, step_binding(&self.steps)),
                (2, span_binding(source, pass.source)),
                (3, span_binding(target, pass.target)),
                (4, span_binding(sum, pass.target)),
                (5, self.marks.as_entire_binding()),
                (6, masked.as_entire_binding()),
            ]
        };
        let propagate = [[a, b], [b, a]].map(|[source, target]| {
            let mut entries = common(source, target);
            entries.push((7, self.decisions.as_entire_binding()));
            bind_group(self.card, &self.propagate, entries)
        });
        let touched = touched_of(&self.layout, pass, masks);
        let solids = self.solids.as_ref().filter(|_| !touched.is_empty()).map(|pipeline| {
            let list = self.card.storage("touched", 16 * touched.len() as u64);
            self.card.write(&list, 0, bytemuck::cast_slice(&touched));
            let groups = [[a, b], [b, a]].map(|[source, target]| {
                let mut entries = common(source, target);
                entries.extend([(8, list.as_entire_binding()), (9, around.as_entire_binding())]);
                bind_group(self.card, pipeline, entries)
            });
            (groups, touched.len().div_ceil(64) as u32)
        });
        Bound { groups: pass.groups, propagate, solids }
    }

    /// Takes over light, marks and, for each channel and level, whether the source needs no clamp.
    pub fn load(&mut self, light: &[[&Octree<f32>; 2]], index: &IndexVolume, linear: &[Vec<bool>]) {
        (self.turned, self.slot) = (false, 0);
        for (channel, [source, accumulated]) in light.iter().enumerate() {
            for level in 0..self.sizes.count() {
                let (bank, at) = self.layout.place(channel, level);
                for (buffer, octree) in [(&self.light[0], source), (&self.light[2], accumulated)] {
                    let cells = cells_of(octree.level(level));
                    self.card.write(&buffer[bank], at * CELL, bytemuck::cast_slice(&cells));
                }
            }
        }
        for level in 0..self.sizes.count() {
            let words = index.level(level).words();
            self.card.write(&self.marks, 4 * self.layout.words(level), bytemuck::cast_slice(words));
        }
        // For the first iteration, of slot 0: the one before it still needed a clamp.
        let decisions: Vec<[u32; 4]> = linear.iter().flatten().map(|linear| [u32::from(*linear), 0, 0, 1]).collect();
        self.card.write(&self.decisions, 0, bytemuck::cast_slice(&decisions));
    }

    /// Does an iteration for each of the modes. It does not wait for them.
    pub fn iterate(&mut self, modes: &[Mode]) {
        self.submit(modes, None);
    }

    /// The same, and waits. Seconds that it took: by the card's clock, from the first dispatch's start to the last one's
    /// end, and whether it was that; else by the clock on the wall, from before the orders are written.
    pub fn time(&mut self, modes: &[Mode]) -> Result<(f64, bool), DeviceError> {
        let clock = self.card.clock();
        let started = std::time::Instant::now();
        self.submit(modes, clock.as_ref());
        self.card.wait()?;
        match clock {
            Some(clock) => Ok((self.card.elapsed(&clock)?, true)),
            None => Ok((started.elapsed().as_secs_f64(), false)),
        }
    }

    fn submit(&mut self, modes: &[Mode], clock: Option<&Clock>) {
        let submissions = modes.len().div_ceil(TOGETHER);
        for (number, modes) in modes.chunks(TOGETHER).enumerate() {
            let mut steps = vec![0u8; modes.len() * STEP_STRIDE as usize];
            for (i, mode) in modes.iter().enumerate() {
                let slot = (self.slot + i as u32) % 3;
                let backwards = u32::from(self.turned) ^ (i as u32 & 1);
                let step = Step { zero: 0, mode: mode.bits(), slot, backwards };
                steps[i * STEP_STRIDE as usize..][..size_of::<Step>()].copy_from_slice(bytemuck::bytes_of(&step));
            }
            self.card.queue.write_buffer(&self.steps, 0, &steps);
            let mut encoder = self.card.device.create_command_encoder(&Default::default());
            {
                let (first, last) = (number == 0, number + 1 == submissions);
                let timestamp_writes = clock.filter(|_| first || last).map(|clock| clock.of_pass(first, last));
                let descriptor = wgpu::ComputePassDescriptor { label: None, timestamp_writes };
                let mut pass = encoder.begin_compute_pass(&descriptor);
                for (i, mode) in modes.iter().enumerate() {
                    self.encode(&mut pass, *mode, i);
                }
            }
            if let Some(clock) = clock.filter(|_| number + 1 == submissions) {
                encoder.resolve_query_set(&clock.set, 0..2, &clock.readings, 0);
            }
            self.card.queue.submit([encoder.finish()]);
            self.turned ^= modes.len() % 2 == 1;
            self.slot = (self.slot + modes.len() as u32) % 3;
        }
    }

    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, mode: Mode, i: usize) {
        let offset = [(i as u64 * STEP_STRIDE) as u32];
        let way = usize::from(self.turned) ^ (i & 1);
        pass.set_pipeline(&self.propagate);
        for bound in &self.bound {
            pass.set_bind_group(0, &bound.propagate[way], &offset);
            dispatch(pass, bound.groups);
        }
        let Some(solids) = self.solids.as_ref().filter(|_| mode.solids) else { return };
        pass.set_pipeline(solids);
        for (groups, count) in self.bound.iter().filter_map(|bound| bound.solids.as_ref()) {
            pass.set_bind_group(0, &groups[way], &offset);
            dispatch(pass, *count);
        }
    }

    /// Waits for the card and gives the light back: source, target and accumulated of each channel, and the marks.
    pub fn store(&self, light: &mut [[&mut Octree<f32>; 3]], index: &mut IndexVolume) -> Result<(), DeviceError> {
        let order = if self.turned { [1, 0, 2] } else { [0, 1, 2] };
        for (channel, octrees) in light.iter_mut().enumerate() {
            for (octree, which) in octrees.iter_mut().zip(order) {
                for level in 0..self.sizes.count() {
                    let (bank, at) = self.layout.place(channel, level);
                    let grid = octree.level_mut(level);
                    self.read_grid(&self.light[which][bank], at, grid)?;
                }
            }
        }
        for level in 0..self.sizes.count() {
            let (at, words) = (4 * self.layout.words(level), index.level_mut(level).words_mut());
            self.card.read(&self.marks, at, size_of_val(words) as u64, |from, bytes| {
                let to: &mut [u8] = bytemuck::cast_slice_mut(words);
                to[from as usize..][..bytes.len()].copy_from_slice(bytes);
            })?;
        }
        Ok(())
    }

    fn read_grid(&self, buffer: &wgpu::Buffer, at: u64, grid: &mut Grid<f32>) -> Result<(), DeviceError> {
        let n = grid.side();
        let bytes = (n as u64).pow(3) * CELL;
        // Pieces are whole rows: both are powers of two, and a row is the smaller one.
        self.card.read(buffer, at * CELL, bytes, |from, bytes| {
            let cells: &[[f32; 4]] = bytemuck::cast_slice(bytes);
            let first = (from / CELL) as usize / n;
            for (i, cells) in cells.chunks_exact(n).enumerate() {
                let [c, x, y, z] = grid.row_mut((first + i) % n, (first + i) / n);
                for (i, cell) in cells.iter().enumerate() {
                    [c[i], x[i], y[i], z[i]] = *cell;
                }
            }
        })
    }
}

fn span_binding(buffer: &wgpu::Buffer, span: Span) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: span.first * CELL,
        size: std::num::NonZeroU64::new(span.cells * CELL),
    })
}

fn step_binding(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: 0,
        size: std::num::NonZeroU64::new(size_of::<Step>() as u64),
    })
}

fn jobs_buffer(card: &Device, Pass { jobs, groups, .. }: &Pass) -> wgpu::Buffer {
    let head = [jobs.len() as u32, *groups, 0, 0];
    let buffer = card.uniform("jobs", (size_of_val(&head) + MOST_JOBS * size_of::<Job>()) as u64);
    card.write(&buffer, 0, bytemuck::cast_slice(&head));
    card.write(&buffer, size_of_val(&head) as u64, bytemuck::cast_slice(jobs));
    buffer
}

/// Workgroups in rows: a dimension holds 65535 at most.
fn dispatch(pass: &mut wgpu::ComputePass<'_>, groups: u32) {
    const ROW: u32 = 32_768;
    if groups <= ROW {
        pass.dispatch_workgroups(groups, 1, 1);
    } else {
        pass.dispatch_workgroups(ROW, groups.div_ceil(ROW), 1);
    }
}

/// The cells of a grid, x fastest.
fn cells_of(grid: &Grid<f32>) -> Vec<[f32; 4]> {
    let n = grid.side();
    let mut cells = Vec::with_capacity(n.pow(3));
    for (z, y) in (0..n).flat_map(|z| (0..n).map(move |y| (z, y))) {
        let [c, x, y, z] = grid.row(y, z);
        cells.extend((0..n).map(|i| [c[i], x[i], y[i], z[i]]));
    }
    cells
}

/// For every 32 cells the two words of the masks; two words in all where no cell is unlike others.
fn mask_words(layout: &Layout, sizes: Levels, masks: &Masks) -> Vec<u32> {
    if masks.touched.is_empty() && masks.accumulating.is_empty() {
        return vec![0, u32::MAX];
    }
    let mut words: Vec<u32> = [0, u32::MAX].repeat(layout.words(sizes.count()) as usize);
    for touched in &masks.touched {
        let n = sizes.side(touched.level);
        let (x, row) = (touched.cell % n, touched.cell / n);
        let word = layout.words(touched.level) as usize + row * row_words(n) + x / 32;
        words[2 * word] |= 1 << (x % 32);
    }
    for (level, accumulating) in masks.accumulating.iter().enumerate() {
        let first = layout.words(level) as usize;
        for (i, word) in bytemuck::cast_slice::<u64, u32>(accumulating).iter().enumerate() {
            words[2 * (first + i) + 1] = *word;
        }
    }
    words
}

/// The touched cells of a pass, as its kernel takes them.
fn touched_of(layout: &Layout, pass: &Pass, masks: &Masks) -> Vec<[u32; 4]> {
    let in_pass = |touched: &TouchedCell| {
        let decision = layout.decision(touched.channel, touched.level) as u32;
        let number = pass.jobs.iter().position(|job| {
            let first = job.z_first * job.side * job.side;
            let cells = job.z_count * job.side * job.side;
            job.decision == decision && (first..first + cells).contains(&(touched.cell as u32))
        })?;
        let job = pass.jobs[number];
        let i = touched.cell as u32 - job.z_first * job.side * job.side;
        Some([number as u32, i, touched.around_at as u32, touched.colour as u32])
    };
    masks.touched.iter().filter_map(in_pass).collect()
}
