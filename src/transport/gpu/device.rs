//! The graphics card: finding one, its limits, buffers and readings of its clock.

use std::fmt;
use std::sync::OnceLock;

use wgpu::{Backends, BufferUsages, Features, Limits};

/// A card that is ready to compute.
#[derive(Debug)]
pub struct Device {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    name: String,
    /// Nanoseconds a tick of its clock; `None` where it has none.
    tick: Option<f32>,
}

/// Two readings of the card's clock: before what is measured, and after it.
#[derive(Debug)]
pub(super) struct Clock {
    pub(super) set: wgpu::QuerySet,
    pub(super) readings: wgpu::Buffer,
    /// Seconds a tick.
    tick: f64,
}

impl Clock {
    /// Readings at the beginning of a pass, at its end, or both.
    pub(super) fn of_pass(&self, begin: bool, end: bool) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: begin.then_some(0),
            end_of_pass_write_index: end.then_some(1),
        }
    }
}

/// Why no card computes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    /// No driver answered.
    #[error("no graphics card can be used here ({0}); install a Vulkan or Metal driver, or compute with --device cpu")]
    None(String),
    /// The card has too little room, or its driver gave up.
    #[error("the graphics card {name} cannot do this: {what}; compute with --device cpu")]
    Failed {
        /// The card.
        name: String,
        /// What went wrong.
        what: String,
    },
}

impl Device {
    /// The card that this program uses, opened at the first call: the fastest one that a driver offers.
    pub fn shared() -> Result<&'static Device, DeviceError> {
        static DEVICE: OnceLock<Result<Device, DeviceError>> = OnceLock::new();
        DEVICE.get_or_init(Device::open).as_ref().map_err(DeviceError::clone)
    }

    /// Opens the fastest card that a driver offers; a software driver is one too.
    pub fn open() -> Result<Self, DeviceError> {
        pollster::block_on(Self::open_now())
    }

    async fn open_now() -> Result<Self, DeviceError> {
        let mut description = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        description.backends = Backends::VULKAN | Backends::METAL;
        let instance = wgpu::Instance::new(description);
        let wanted = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&wanted).await.map_err(|error| DeviceError::None(one_line(&error)))?;
        let info = adapter.get_info();
        let clock = Features::TIMESTAMP_QUERY;
        let has_clock = adapter.features().contains(clock);
        let description = wgpu::DeviceDescriptor {
            label: Some("lpv-lab"),
            required_features: if has_clock { clock } else { Features::empty() },
            required_limits: adapter.limits(),
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&description)
            .await
            .map_err(|error| DeviceError::Failed { name: info.name.clone(), what: one_line(&error) })?;
        let tick = has_clock.then(|| queue.get_timestamp_period());
        Ok(Device { device, queue, name: info.name, tick })
    }

    /// What its driver calls it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its limits.
    pub fn limits(&self) -> Limits {
        self.device.limits()
    }

    /// A reading of its own clock to be taken; `None` where it has none.
    pub(super) fn clock(&self) -> Option<Clock> {
        let tick = f64::from(self.tick?) * 1e-9;
        let set = self.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("clock"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let readings = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("clock"),
            size: 16,
            usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Some(Clock { set, readings, tick })
    }

    /// Waits for the card; seconds between the two readings of a clock.
    pub(super) fn elapsed(&self, clock: &Clock) -> Result<f64, DeviceError> {
        let mut ticks = [0u64; 2];
        self.read(&clock.readings, 0, 16, |_, bytes| bytemuck::bytes_of_mut(&mut ticks).copy_from_slice(bytes))?;
        Ok(ticks[1].saturating_sub(ticks[0]) as f64 * clock.tick)
    }

    /// Runs `make`, and turns what the driver holds against it (a binding that is too large, memory that has run
    /// out) into an error.
    pub(super) fn tried<T>(&self, make: impl FnOnce(&Self) -> T) -> Result<T, DeviceError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let rules = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make(self);
        let (rules, memory) = (pollster::block_on(rules.pop()), pollster::block_on(memory.pop()));
        match rules.or(memory) {
            None => Ok(made),
            Some(error) => Err(DeviceError::Failed { name: self.name.clone(), what: one_line(&error) }),
        }
    }

    /// A buffer that kernels read and write.
    pub(super) fn storage(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(16),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    }

    /// A buffer of constants.
    pub(super) fn uniform(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.next_multiple_of(16),
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Writes to a buffer, in pieces that drivers take.
    pub(super) fn write(&self, buffer: &wgpu::Buffer, at: u64, bytes: &[u8]) {
        const PIECE: usize = 32 << 20;
        for (i, piece) in bytes.chunks(PIECE).enumerate() {
            self.queue.write_buffer(buffer, at + (i * PIECE) as u64, piece);
            if bytes.len() > PIECE {
                self.queue.submit([]);
            }
        }
    }

    /// Bytes that a plain copy by a kernel reads and writes in a second, the median of so many rounds.
    ///
    /// # Errors
    /// Where the card has no room for two buffers.
    pub fn copy_bandwidth(&self, rounds: usize) -> Result<f64, DeviceError> {
        const TIMES: u32 = 16;
        // Far more than a cache holds.
        let bytes = self.limits().max_storage_buffer_binding_size.min(512 << 20) & !4095;
        let [from, to] = self.tried(|card| ["copy from", "copy to"].map(|label| card.storage(label, bytes)))?;
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("copy"),
            source: wgpu::ShaderSource::Wgsl(include_str!("kernels/copy.wgsl").into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("copy"),
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            cache: None,
        });
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[(0, &from), (1, &to)]
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }),
        });
        let groups = (bytes / 16).div_ceil(256) as u32;
        let clock = self.clock();
        let mut rates = Vec::new();
        for _ in 0..=rounds {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            {
                let timestamp_writes = clock.as_ref().map(|clock| clock.of_pass(true, true));
                let mut pass =
                    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &group, &[]);
                (0..TIMES).for_each(|_| pass.dispatch_workgroups(groups.min(4096), groups.div_ceil(4096), 1));
            }
            if let Some(clock) = &clock {
                encoder.resolve_query_set(&clock.set, 0..2, &clock.readings, 0);
            }
            let started = std::time::Instant::now();
            self.queue.submit([encoder.finish()]);
            self.wait()?;
            let seconds = match &clock {
                Some(clock) => self.elapsed(clock)?,
                None => started.elapsed().as_secs_f64(),
            };
            rates.push(2.0 * f64::from(TIMES) * bytes as f64 / seconds);
        }
        // The first copy also makes the memory.
        rates.remove(0);
        rates.sort_by(f64::total_cmp);
        Ok(rates.get(rates.len() / 2).copied().unwrap_or(f64::NAN))
    }

    /// Waits until all that was submitted is done.
    pub fn wait(&self) -> Result<(), DeviceError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map(|_| ()).map_err(|error| DeviceError::Failed { name: self.name.clone(), what: one_line(&error) })
    }

    /// Reads a part of a buffer, in pieces, each given to `take` with the place of its first byte.
    pub(super) fn read(
        &self,
        buffer: &wgpu::Buffer,
        at: u64,
        bytes: u64,
        mut take: impl FnMut(u64, &[u8]),
    ) -> Result<(), DeviceError> {
        const PIECE: u64 = 64 << 20;
        if bytes == 0 {
            return Ok(());
        }
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size: bytes.min(PIECE),
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut done = 0;
        while done < bytes {
            let length = (bytes - done).min(PIECE);
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(buffer, at + done, &staging, 0, length);
            self.queue.submit([encoder.finish()]);
            let slice = staging.slice(0..length);
            let (sent, came) = std::sync::mpsc::channel();
            slice.map_async(wgpu::MapMode::Read, move |result| {
                // Nobody listens any more only where this call has failed already.
                let _ = sent.send(result);
            });
            self.wait()?;
            let failed = |what: String| DeviceError::Failed { name: self.name.clone(), what };
            came.recv().map_err(|e| failed(one_line(&e)))?.map_err(|e| failed(one_line(&e)))?;
            let view = slice.get_mapped_range().map_err(|e| failed(one_line(&e)))?;
            take(done, &view);
            drop(view);
            staging.unmap();
            done += length;
        }
        Ok(())
    }
}

/// What an error says, in one line.
fn one_line(error: &dyn fmt::Display) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
