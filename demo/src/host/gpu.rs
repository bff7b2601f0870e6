//! Adapters and devices.

use deferred_aa::{DeferredAa, Descriptor};
use std::sync::{Arc, Mutex};

/// A device, its queue, and what went wrong on it.
#[derive(Debug, Clone)]
pub struct Gpu {
    /// Where it came from.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    errors: Arc<Mutex<Vec<String>>>,
    lost: Arc<Mutex<Option<String>>>,
}

/// No device could be had.
#[derive(Debug, Clone, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all.
    #[error("no graphics adapter: install a Vulkan driver (on Debian: apt-get install mesa-vulkan-drivers)")]
    NoAdapter,
    /// None of that name.
    #[error("--adapter: no adapter has '{name}' in its name; there is {}", .adapters.join(", "))]
    NoSuchAdapter {
        /// What was asked for.
        name: String,
        /// The names of those that are there.
        adapters: Vec<String>,
    },
    /// The adapter can't run the node.
    #[error("adapter '{adapter}' can't run the node, it lacks: {}; choose another with --adapter", .missing.join(", "))]
    Missing {
        /// Its name.
        adapter: String,
        /// What it lacks.
        missing: Vec<String>,
    },
    /// The adapter can run the node, but not with the rays that are wanted of it.
    #[error("the scene wants rays for its shadows, reflections or refractions, and adapter '{adapter}' lacks: {}; \
        leave them out (--set shadows=off --set reflections=off --set refraction=off) or choose another with --adapter",
        .missing.join(", "))]
    NoRays {
        /// Its name.
        adapter: String,
        /// What it lacks.
        missing: Vec<String>,
    },
    /// The driver refused.
    #[error("adapter '{adapter}' gave no device: {message}; choose another with --adapter")]
    Device {
        /// Its name.
        adapter: String,
        /// What it said.
        message: String,
    },
}

/// The backends whose adapters meet the requirements; dependencies of ours compile others in.
const BACKENDS: wgpu::Backends = wgpu::Backends::PRIMARY;

fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends &= BACKENDS;
    wgpu::Instance::new(descriptor)
}

/// All adapters that wgpu finds.
pub fn adapters() -> Vec<wgpu::Adapter> {
    pollster::block_on(instance().enumerate_adapters(BACKENDS))
}

/// The adapter whose name holds `name`, else the one that wgpu prefers, software at last.
pub fn choose(name: Option<&str>) -> Result<wgpu::Adapter, GpuError> {
    let lower = name.map(str::to_lowercase);
    let mut all = adapters();
    let adapters: Vec<_> = all.iter().map(|a| a.get_info().name).collect();
    all.retain(|a| lower.as_ref().is_none_or(|n| a.get_info().name.to_lowercase().contains(n)));
    all.sort_by_key(|a| match a.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    all.into_iter().next().ok_or(match name {
        Some(name) if !adapters.is_empty() => GpuError::NoSuchAdapter { name: name.to_owned(), adapters },
        _ => GpuError::NoAdapter,
    })
}

impl Gpu {
    /// A device that can run nodes of this descriptor, with the adapter's own limits so that large frames fit.
    pub fn new(adapter: wgpu::Adapter, descriptor: &Descriptor<'_>) -> Result<Self, GpuError> {
        let features = Self::needed(&adapter, descriptor)?;
        Self::with(adapter.clone(), features, adapter.limits())
    }

    /// [`new`](Self::new) with the numbers of samples a pixel that only some adapters have, for the peers.
    pub fn for_peers(adapter: wgpu::Adapter, descriptor: &Descriptor<'_>) -> Result<Self, GpuError> {
        let features = Self::needed(&adapter, descriptor)?;
        let besides = adapter.features() & wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
        Self::with(adapter.clone(), features | besides, adapter.limits())
    }

    /// The features of a device that can run nodes of this descriptor.
    fn needed(adapter: &wgpu::Adapter, descriptor: &Descriptor<'_>) -> Result<wgpu::Features, GpuError> {
        let requirements = DeferredAa::requirements(adapter, descriptor);
        if requirements.missing.is_empty() {
            return Ok(requirements.features);
        }
        let (name, missing) = (adapter.get_info().name, requirements.missing);
        let without = DeferredAa::requirements(adapter, &Descriptor { rays: None, ..*descriptor });
        Err(if descriptor.rays.is_some() && without.missing.is_empty() {
            GpuError::NoRays { adapter: name, missing }
        } else {
            GpuError::Missing { adapter: name, missing }
        })
    }

    /// A device of wgpu's backend that draws nothing, on any machine, for nodes of this descriptor: it checks and
    /// counts.
    pub fn drawing_nothing(descriptor: &Descriptor<'_>) -> Result<Self, GpuError> {
        let mut wanted = wgpu::InstanceDescriptor::new_without_display_handle();
        wanted.backends = wgpu::Backends::NOOP;
        wanted.backend_options.noop.enable = true;
        let adapters = pollster::block_on(wgpu::Instance::new(wanted).enumerate_adapters(wgpu::Backends::NOOP));
        let adapter = adapters.into_iter().next().ok_or(GpuError::NoAdapter)?;
        // Whatever the host's WGSL asks for, some machine has it. The adapter says of no format that it can be stored
        // to, so what it says of formats is not asked for.
        let needed = DeferredAa::requirements(&adapter, descriptor).features;
        let besides =
            wgpu::Features::all_experimental_mask() | wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
        let features = needed | (adapter.features() - besides);
        Self::with(adapter.clone(), features, adapter.limits())
    }

    /// A device with exactly these features and limits.
    pub fn with(adapter: wgpu::Adapter, features: wgpu::Features, limits: wgpu::Limits) -> Result<Self, GpuError> {
        // SAFETY: asked for only with a feature that is behind it. Its structures are built by this crate from checked
        // meshes, before any ray is traced.
        #[expect(unsafe_code)]
        let experimental_features = if features.intersects(wgpu::Features::all_experimental_mask()) {
            unsafe { wgpu::ExperimentalFeatures::enabled() }
        } else {
            wgpu::ExperimentalFeatures::disabled()
        };
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("deferred-aa-demo"),
            required_features: features,
            required_limits: limits,
            experimental_features,
            ..Default::default()
        });
        let (device, queue) = pollster::block_on(request).map_err(|e| GpuError::Device {
            adapter: adapter.get_info().name,
            message: e.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
        })?;
        let errors = Arc::new(Mutex::new(Vec::new()));
        let log = errors.clone();
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            log.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(e.to_string());
        }));
        let lost = Arc::new(Mutex::new(None));
        let log = lost.clone();
        device.set_device_lost_callback(move |reason, message| {
            let text = format!("{reason:?} {message}").split_whitespace().collect::<Vec<_>>().join(" ");
            log.lock().unwrap_or_else(std::sync::PoisonError::into_inner).get_or_insert(text);
        });
        Ok(Self { adapter, device, queue, errors, lost })
    }

    /// The least [`Settings::ray_bias`](deferred_aa::Settings::ray_bias) for the adapter's rasteriser. SwiftShader has 4
    /// bits below a sample in place of 8, and loses more in the depth of large triangles: up to a third of a sample.
    pub fn least_ray_bias(&self) -> f32 {
        if self.adapter.get_info().name.contains("SwiftShader") { 0.5 } else { 0.0 }
    }

    /// Everything that wgpu complained of since the last call. Empty in a sound program.
    pub fn take_errors(&self) -> Vec<String> {
        std::mem::take(&mut *self.errors.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }

    /// Why the device is gone, once it is: nothing that it is asked for arrives any more.
    pub fn lost(&self) -> Option<String> {
        // The callback runs when the device is polled.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.lost.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone()
    }

    /// The first of [`take_errors`](Self::take_errors), in one line.
    pub fn complaint(&self) -> Option<String> {
        self.take_errors().first().map(|e| e.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// Waits until the GPU has done what was submitted, so that callbacks have run.
    pub fn wait(&self) {
        // The only failure is a time-out, and this has none.
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// The bytes of all textures and buffers of the device, as wgpu counts them.
    pub fn bytes(&self) -> u64 {
        let counters = self.device.get_internal_counters().hal;
        let bytes = counters.buffer_memory.read() + counters.texture_memory.read();
        bytes.try_into().unwrap_or(0)
    }

    /// Bytes of a buffer that was made with `COPY_SRC`.
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Vec<u8> {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: buffer.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        self.mapped(&copy)
    }

    /// Texels of a texture's first mip, rows packed, of a format with `texel` bytes.
    pub fn read_texture(&self, texture: &wgpu::Texture, texel: u32) -> Vec<u8> {
        let (width, height) = (texture.width(), texture.height());
        let row = (width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        let padded = self.mapped(&copy);
        padded.chunks_exact(row as usize).flat_map(|r| &r[..(width * texel) as usize]).copied().collect()
    }

    fn mapped(&self, buffer: &wgpu::Buffer) -> Vec<u8> {
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        self.wait();
        // A lost device maps nothing; what is missing shows as black, and the device's error is in `take_errors`.
        match buffer.get_mapped_range(..) {
            Ok(bytes) => bytes.to_vec(),
            Err(_) => vec![0; buffer.size() as usize],
        }
    }
}
