//! The kernels that `shader` writes, called as an engine would call them: by what their page says, and nothing else.
//! Each language that a Vulkan driver takes, directly or by way of glslang, gives what an independent program computed in
//! float64, and the bits of `cells`. Where there is no driver the suite says so, and does not run.
#![cfg(feature = "gpu")]
#![allow(clippy::unwrap_used, clippy::expect_used)]
// Files in SPIR-V go to the driver as they are, like an engine's: the way that wgpu does not vouch for.
#![allow(unsafe_code)]

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use assert_cmd::Command;
use lpv_lab::transport::gpu::Device;
use wgpu::BufferUsages;

/// The side of the finest level, and the levels: 16, 8, 4, 2, 1.
const N: usize = 16;
const LEVELS: usize = 5;

/// A lobe of amplitude 1 towards +X in the middle, in an octree down to one cell.
const PRESET: &str = "(version: 1, size: 16, injectors: [(kind: Single(cell: (8, 8, 8)), direction: (1, 0, 0))],
    propagation: (factor: 4.0))";

fn lab(arguments: &[&str]) {
    Command::cargo_bin("lpv-lab").unwrap().args(arguments).assert().success();
}

/// `Job` of the page: 48 bytes.
#[derive(Clone, Copy, Default)]
struct Job {
    side: u32,
    level: u32,
    first_group: u32,
    source_at: u32,
    target_at: u32,
    words_at: u32,
}

impl Job {
    fn words(self) -> [u32; 12] {
        let Job { side, level, first_group, source_at, target_at, words_at } = self;
        let row_words = 2 * side.div_ceil(64);
        [first_group, side, side.ilog2(), level, source_at, target_at, 0, 0, side, level, words_at, row_words]
    }
}

fn side(level: usize) -> usize {
    N >> level
}

/// Where a level begins among cells, and among words of marks.
fn start(level: usize) -> u32 {
    (0..level).map(|i| side(i).pow(3) as u32).sum()
}

fn words(level: usize) -> u32 {
    (0..level).map(|i| 2 * side(i).pow(2) as u32).sum()
}

/// A program with a device of its own that knows the kernels' files and their page.
struct Engine {
    device: wgpu::Device,
    queue: wgpu::Queue,
    kernels: HashMap<&'static str, wgpu::ComputePipeline>,
}

impl Engine {
    fn new(folder: &Path, language: &str) -> Option<Self> {
        let mut description = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        description.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL;
        let instance = wgpu::Instance::new(description);
        let adapter = pollster::block_on(instance.request_adapter(&Default::default())).ok()?;
        let features = wgpu::Features::PASSTHROUGH_SHADERS & adapter.features();
        let wanted = wgpu::DeviceDescriptor { required_features: features, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&wanted)).unwrap();
        let mut engine = Engine { device, queue, kernels: HashMap::new() };
        for (name, bindings) in [
            ("inject", &[(2, false), (3, true), (4, true), (5, true)][..]),
            ("downsample", &[(2, false), (3, true), (5, true)]),
            ("propagate", &[(2, false), (3, true), (4, true), (5, true), (6, false), (7, true)]),
            ("merge", &[(2, false), (3, true), (5, false)]),
        ] {
            let file = File::of(folder, name, language, bindings);
            let kernel = engine.pipeline(name, file, bindings);
            engine.kernels.insert(name, kernel);
        }
        Some(engine)
    }

    /// A kernel whose bindings 0 and 1 are uniform and the others storage, to be written or not.
    fn pipeline(&self, name: &'static str, file: File, storage: &[(u32, bool)]) -> wgpu::ComputePipeline {
        let device = &self.device;
        let (module, entry) = match file {
            File::Wgsl(text) => {
                let source = wgpu::ShaderSource::Wgsl(Cow::Owned(text));
                (device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source }), name)
            }
            File::Spirv(words, entry) => {
                let group = if name == "propagate" { 256 } else { 64 };
                let point =
                    wgpu::PassthroughShaderEntryPoint { name: Cow::Borrowed(entry), workgroup_size: (group, 1, 1) };
                let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
                    label: Some(name),
                    entry_points: Cow::Owned(vec![point]),
                    spirv: Some(Cow::Owned(words)),
                    ..Default::default()
                };
                // SAFETY: naga or glslang wrote it for this layout, and this program's jobs stay inside its buffers.
                (unsafe { device.create_shader_module_passthrough(descriptor) }, entry)
            }
        };
        let uniform = [0, 1].map(|binding| (binding, wgpu::BufferBindingType::Uniform));
        let storage = storage.iter().map(|&(i, write)| (i, wgpu::BufferBindingType::Storage { read_only: !write }));
        let entries: Vec<wgpu::BindGroupLayoutEntry> = uniform
            .into_iter()
            .chain(storage)
            .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            })
            .collect();
        let group =
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&group)],
            immediate_size: 0,
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        })
    }

    fn buffer(&self, words: &[u32], usage: BufferUsages) -> wgpu::Buffer {
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let usage = usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let size = bytes.len() as u64;
        let buffer =
            self.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        self.queue.write_buffer(&buffer, 0, &bytes);
        buffer
    }

    fn storage(&self, words: &[u32]) -> wgpu::Buffer {
        self.buffer(words, BufferUsages::STORAGE)
    }

    /// Calls a kernel for these jobs in a mode.
    fn call(&self, name: &str, jobs: &[Job], step: [u32; 4], storage: &[(u32, &wgpu::Buffer)], groups: u32) {
        let mut list = vec![jobs.len() as u32, groups, 0, 0];
        list.extend(jobs.iter().flat_map(|job| job.words()));
        list.resize(4 + 12 * 64, 0);
        let uniform = [self.buffer(&list, BufferUsages::UNIFORM), self.buffer(&step, BufferUsages::UNIFORM)];
        let uniform = uniform.iter().enumerate().map(|(i, buffer)| (i as u32, buffer));
        let entries: Vec<wgpu::BindGroupEntry<'_>> = uniform
            .chain(storage.iter().copied())
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let pipeline = &self.kernels[name];
        let layout = &pipeline.get_bind_group_layout(0);
        let group =
            self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        self.queue.submit([encoder.finish()]);
    }

    fn read(&self, buffer: &wgpu::Buffer) -> Vec<[f32; 4]> {
        let size = buffer.size();
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let staging =
            self.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
        self.queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let view = staging.slice(..).get_mapped_range().unwrap();
        let (numbers, _) = view.as_chunks::<4>();
        let numbers: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        numbers.as_chunks().0.to_vec()
    }

    /// A whole run: inject, downsample, propagate so many times, merge. Gives source, accumulated and merged.
    fn run(&self, iterations: u32) -> [Vec<[f32; 4]>; 3] {
        let cells = start(LEVELS) as usize;
        let dark = vec![0; 4 * cells];
        let mut light = [self.storage(&dark), self.storage(&dark)];
        let accumulated = self.storage(&dark);
        let marks = self.storage(&vec![0; words(LEVELS) as usize]);
        let masks = self.storage(&[0, u32::MAX]);

        // A clamped cosine lobe towards +X: (sqrt(pi)/2, sqrt(pi/3), 0, 0) of (c00, X, Y, Z).
        let pi = std::f64::consts::PI;
        let lobe = [pi.sqrt() / 2.0, (pi / 3.0).sqrt(), 0.0, 0.0].map(|number| (number as f32).to_bits());
        let [a, b, c, d] = lobe;
        let list = self.storage(&[a, b, c, d, 8, 8, 8, 0]);
        let finest = Job { side: N as u32, ..Job::default() };
        let bound = [(2, &list), (3, &light[0]), (4, &accumulated), (5, &marks)];
        self.call("inject", &[finest], [0; 4], &bound, 1);

        for grids in [&light[0], &accumulated] {
            for level in 1..LEVELS {
                // No driver of this kind may read and write one buffer through two bindings.
                let finer = self.storage(&dark);
                let mut encoder = self.device.create_command_encoder(&Default::default());
                encoder.copy_buffer_to_buffer(grids, 0, &finer, 0, grids.size());
                self.queue.submit([encoder.finish()]);
                let job = Job {
                    side: side(level) as u32,
                    level: level as u32,
                    source_at: start(level - 1),
                    target_at: start(level),
                    words_at: words(level),
                    ..Job::default()
                };
                let groups = side(level).pow(3).div_ceil(64) as u32;
                self.call("downsample", &[job], [0; 4], &[(2, &finer), (3, grids), (5, &marks)], groups);
            }
        }

        let mut groups = 0;
        let jobs: Vec<Job> = (0..LEVELS)
            .map(|level| {
                let at = start(level);
                let side = side(level) as u32;
                let job = Job {
                    side,
                    level: level as u32,
                    first_group: groups,
                    source_at: at,
                    target_at: at,
                    words_at: words(level),
                };
                groups += side.pow(3).div_ceil(256);
                job
            })
            .collect();
        let decisions = self.storage(&[0, 0, 0, 1].repeat(LEVELS));
        for k in 0..iterations {
            let step = [0, 3, k % 3, k % 2];
            let [source, target] = &light;
            let bound = [(2, source), (3, target), (4, &accumulated), (5, &marks), (6, &masks), (7, &decisions)];
            self.call("propagate", &jobs, step, &bound, groups);
            light.reverse();
        }
        let merged = self.storage(&vec![0; 4 * N.pow(3)]);
        let bound = [(2, &accumulated), (3, &merged), (5, &marks)];
        self.call("merge", &jobs, [0; 4], &bound, (N.pow(3) / 64) as u32);
        [self.read(&light[0]), self.read(&accumulated), self.read(&merged)]
    }
}

/// A kernel's file, as it goes to the driver.
enum File {
    Wgsl(String),
    /// Words, and the name of the entry point.
    Spirv(Vec<u32>, &'static str),
}

impl File {
    fn of(folder: &Path, name: &'static str, language: &str, storage: &[(u32, bool)]) -> Self {
        let spirv = |file: String| {
            let bytes = std::fs::read(folder.join(file)).unwrap();
            let mut words: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
            renumber(&mut words, storage);
            words
        };
        match language {
            "wgsl" => File::Wgsl(std::fs::read_to_string(folder.join(format!("{name}.wgsl"))).unwrap()),
            "spirv" => File::Spirv(spirv(format!("{name}.spv")), name),
            _ => {
                let [from, to] = ["comp", "out"].map(|ending| folder.join(format!("{name}.{ending}")));
                let arguments = ["-V", "--target-env", "vulkan1.1", "-o"];
                let done = std::process::Command::new("glslangValidator").args(arguments).args([to, from]).output();
                let done = done.unwrap();
                assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stdout));
                File::Spirv(spirv(format!("{name}.out")), "main")
            }
        }
    }
}

/// wgpu numbers the bindings of a group one after the other; a file that it does not look into must follow.
fn renumber(words: &mut [u32], storage: &[(u32, bool)]) {
    const HEADER: usize = 5;
    const DECORATE: u32 = 71;
    const BINDING: u32 = 33;
    let bindings: Vec<u32> = [0, 1].into_iter().chain(storage.iter().map(|(binding, _)| *binding)).collect();
    let mut at = HEADER;
    while at < words.len() {
        let (length, operation) = ((words[at] >> 16) as usize, words[at] & 0xffff);
        if operation == DECORATE && words[at + 2] == BINDING {
            words[at + 3] = bindings.iter().position(|binding| *binding == words[at + 3]).unwrap() as u32;
        }
        at += length;
    }
}

/// The grid that `cells` writes of a level (or `merged`), as (c00, X, Y, Z), x fastest.
fn cells(preset: &Path, folder: &Path, iterations: u32, grid: &str, level: &str) -> Vec<[f32; 4]> {
    let file = folder.join("cells.npy");
    let k = iterations.to_string();
    let [preset, out] = [preset, &file].map(|path| path.to_str().unwrap());
    lab(&["cells", preset, "--iterations", &k, "--grid", grid, "--level", level, "--out", out]);
    let numbers: Vec<f32> = npyz::NpyFile::new(std::fs::File::open(&file).unwrap()).unwrap().into_vec().unwrap();
    let cells = numbers.as_chunks::<4>().0;
    cells.iter().map(|[c00, c1m, c10, c11]| [*c00, -c11, -c1m, *c10]).collect()
}

/// Equal, all of it, −0 and 0 taken for one another.
fn assert_same(what: &str, found: &[[f32; 4]], wanted: &[[f32; 4]]) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    for (i, (found, wanted)) in found.iter().zip(wanted).enumerate() {
        assert_eq!(found, wanted, "{what}: cell {i}");
    }
}

/// Source and accumulated light of the finest level against the vectors of an independent program.
fn assert_golden(what: &str, iterations: u32, [source, accumulated]: [&[[f32; 4]]; 2]) {
    let file = format!("tests/golden/oracle_ref64_exact_pi_16c_k{iterations}.csv");
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let mut lit = 0;
    for line in text.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let at = (row[2] as usize * N + row[1] as usize) * N + row[0] as usize;
        for (grid, wanted) in [(source, &row[3..7]), (accumulated, &row[7..11])] {
            let [c00, x, y, z] = grid[at].map(f64::from);
            for (found, wanted) in [c00, -y, z, -x].iter().zip(wanted) {
                assert!((found - wanted).abs() <= 2e-6, "{what}, k = {iterations}: {line}: {found}");
            }
        }
        lit += usize::from(row[3..].iter().any(|number| *number != 0.0));
    }
    let found = accumulated.iter().filter(|cell| **cell != [0.0; 4]).count();
    assert_eq!(found, lit, "{what}, k = {iterations}: lit cells");
}

fn check(language: &str) {
    if let Err(error) = Device::shared() {
        eprintln!("the kernels in {language} did not run: {error}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let preset = folder.path().join("lobe.ron");
    std::fs::write(&preset, PRESET).unwrap();
    let out = folder.path().join("kernels");
    lab(&["shader", preset.to_str().unwrap(), "--language", language, "--out", out.to_str().unwrap()]);
    let engine = Engine::new(&out, language).expect("the card that was there a moment ago");
    for k in [1, 2, 4] {
        let [source, accumulated, merged] = engine.run(k);
        let finest = N.pow(3);
        assert_golden(language, k, [&source[..finest], &accumulated[..finest]]);
        for (grid, light) in [("source", &source), ("accumulated", &accumulated)] {
            for level in 0..LEVELS {
                let wanted = cells(&preset, folder.path(), k, grid, &level.to_string());
                let first = start(level) as usize;
                let what = format!("{language}, k = {k}, {grid}, level {level}");
                assert_same(&what, &light[first..first + wanted.len()], &wanted);
            }
        }
        let wanted = cells(&preset, folder.path(), k, "accumulated", "merged");
        assert_same(&format!("{language}, k = {k}, merged"), &merged, &wanted);
    }
}

#[test]
fn in_wgsl_they_give_the_bits_of_cells() {
    check("wgsl");
}

#[test]
fn in_spirv_they_give_the_bits_of_cells() {
    check("spirv");
}

#[test]
fn in_glsl_they_give_the_bits_of_cells() {
    if std::process::Command::new("glslangValidator").arg("--version").output().is_err() {
        eprintln!("the kernels in glsl did not run: glslangValidator is not installed");
        return;
    }
    check("glsl");
}
