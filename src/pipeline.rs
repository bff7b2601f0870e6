//! What the passes share when they build: layouts, joining, compiling once and on demand.

use crate::effects::Traced;
use crate::error::PipelineError;
use crate::shader::{Shader, Shaders};
use crate::wgsl::HostSource;
use std::sync::OnceLock;

/// Resources of the frame, by the names that [`Pass`](crate::Pass) lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Resource {
    /// The attachments of [`GBuffer`](crate::GBuffer), rendered by the host.
    GBuffer,
    /// The host's bind group and the texture table.
    Host,
    /// S: the shaded first samples, w×h.
    First,
    /// The scene for rays.
    Rays,
    /// The tiles in which rays are wanted.
    Tiles,
    /// The shadow bits of samples, and what they reflect and refract.
    Traced,
    /// k of each window, from the metrics.
    Counts,
    /// k and the place in the tile's list of each window.
    Plan,
    /// The frame's pixels by count, or its samples, as one list.
    List,
    /// Points of lattices, and what they were shaded.
    Lattice,
    /// The means of windows with k > 1, w×h.
    Color,
    /// The counters.
    Statistics,
    /// The host's target.
    Target,
}

impl Resource {
    /// Passes only add to it, in any order to the same sums: two that write it may be swapped, or overlap.
    pub fn is_unordered(self) -> bool {
        self == Self::Statistics
    }
}

/// What a pass is called, reads and writes.
///
/// A graph may record passes in another order than [`passes`](crate::DeferredAa::passes) has, as long as for each resource that
/// is not [unordered](Resource::is_unordered) each write stays behind the reads and writes before it, and each read behind the
/// writes before it. It may leave out a pass if nobody reads what that writes: behind [`Frame::statistics`] and
/// [`Settings::goal`](crate::Settings::goal) somebody reads [`Resource::Statistics`].
///
/// [`Frame::statistics`]: crate::Frame::statistics
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PassInfo {
    /// As in `stats.json` and in timings.
    pub name: &'static str,
    /// What must be finished before.
    pub reads: &'static [Resource],
    /// What it changes. The rest of a resource stays as earlier passes have written it.
    pub writes: &'static [Resource],
}

/// What every pass builds on.
#[derive(Debug)]
pub(crate) struct Build {
    pub device: wgpu::Device,
    pub m: u32,
    pub host: HostSource,
    pub target_format: wgpu::TextureFormat,
    /// `@group(0)`: the frame's constants, the G-buffer, and what was traced, by [`Traced::index`].
    pub frame_layouts: [wgpu::BindGroupLayout; Traced::COUNT],
    /// `@group(1)`: the texture table.
    pub table_layout: Option<wgpu::BindGroupLayout>,
    /// `@group(2)`: the host's.
    pub host_layout: Option<wgpu::BindGroupLayout>,
    /// Nothing is kept but for [`keeping`](Self::keeping).
    pub shaders: Shaders,
}

/// A pipeline that is compiled when it is first needed, and kept.
#[derive(Debug)]
pub(crate) struct Lazy<T>(OnceLock<T>);

impl<T> Default for Lazy<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> Lazy<T> {
    pub fn get(&self, make: impl FnOnce() -> Result<T, PipelineError>) -> Result<&T, PipelineError> {
        if self.0.get().is_none() {
            // Two threads may both make it: the second one's is dropped.
            let _ = self.0.set(make()?);
        }
        self.0.get().ok_or_else(|| unreachable!("set above"))
    }
}

impl Build {
    /// Another that keeps the shaders of what it compiles.
    pub fn keeping(&self) -> Self {
        Self {
            device: self.device.clone(),
            m: self.m,
            host: self.host.clone(),
            target_format: self.target_format,
            frame_layouts: self.frame_layouts.clone(),
            table_layout: self.table_layout.clone(),
            host_layout: self.host_layout.clone(),
            shaders: Shaders::kept(),
        }
    }

    fn layout(&self, own: &wgpu::BindGroupLayout, traced: Traced, hosts: bool) -> wgpu::PipelineLayout {
        let frame = &self.frame_layouts[traced.index()];
        let host = |layout: &'_ Option<wgpu::BindGroupLayout>| layout.clone().filter(|_| hosts);
        let (table, host) = (host(&self.table_layout), host(&self.host_layout));
        self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("daa"),
            bind_group_layouts: &[Some(frame), table.as_ref(), host.as_ref(), Some(own)],
            immediate_size: 0,
        })
    }

    fn module(&self, pass: &'static str, source: String) -> wgpu::ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(pass),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        })
    }

    /// A compute pipeline; `own` is its `@group(3)`. `host`: the host's source runs in it, on samples that bring this along.
    pub fn compute(
        &self,
        pass: &'static str,
        source: String,
        entry: &str,
        own: &wgpu::BindGroupLayout,
        host: Option<Traced>,
    ) -> Result<wgpu::ComputePipeline, PipelineError> {
        self.compute_with(pass, source, entry, own, host, &[])
    }

    /// Without the host's source, on samples that bring this along.
    pub fn compute_plain(
        &self,
        pass: &'static str,
        source: String,
        entry: &str,
        own: &wgpu::BindGroupLayout,
        traced: Traced,
    ) -> Result<wgpu::ComputePipeline, PipelineError> {
        self.compute_on(pass, source, entry, &self.layout(own, traced, false), true, &[])
    }

    /// [`compute`](Self::compute) with values for the pass's own `override` constants.
    pub fn compute_with(
        &self,
        pass: &'static str,
        source: String,
        entry: &str,
        own: &wgpu::BindGroupLayout,
        host: Option<Traced>,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline, PipelineError> {
        let layout = self.layout(own, host.unwrap_or_default(), host.is_some());
        // Only `plan` counts up from 0; what `shade` reads it has written.
        self.compute_on(pass, source, entry, &layout, host.is_none(), constants)
    }

    fn compute_on(
        &self,
        pass: &'static str,
        source: String,
        entry: &str,
        layout: &wgpu::PipelineLayout,
        zeroed: bool,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline, PipelineError> {
        let m = [("DAA_M", f64::from(self.m))];
        let constants = [&m[..], constants].concat();
        self.shaders.keep(|| Shader {
            pass,
            entry: entry.to_owned(),
            stage: naga::ShaderStage::Compute,
            source: source.clone(),
            constants: owned(&constants),
            zero_initialize_workgroup_memory: zeroed,
        });
        self.checked(pass, || {
            let module = self.module(pass, source);
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(pass),
                layout: Some(layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    zero_initialize_workgroup_memory: zeroed,
                },
                cache: None,
            })
        })
    }

    /// A render pipeline that covers the target with one triangle.
    pub fn fullscreen(
        &self,
        pass: &'static str,
        source: String,
        entries: [&str; 2],
        own: &wgpu::BindGroupLayout,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::RenderPipeline, PipelineError> {
        for (entry, stage) in entries.into_iter().zip([naga::ShaderStage::Vertex, naga::ShaderStage::Fragment]) {
            self.shaders.keep(|| Shader {
                pass,
                entry: entry.to_owned(),
                stage,
                source: source.clone(),
                constants: owned(constants),
                zero_initialize_workgroup_memory: true,
            });
        }
        self.checked(pass, || {
            let module = self.module(pass, source);
            let compilation_options = wgpu::PipelineCompilationOptions { constants, ..Default::default() };
            self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(pass),
                layout: Some(&self.layout(own, Traced::default(), false)),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(entries[0]),
                    compilation_options: compilation_options.clone(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entries[1]),
                    compilation_options,
                    targets: &[Some(self.target_format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        })
    }

    /// Catches what wgpu says, so that a host's mistake comes back as an error.
    fn checked<T>(&self, pass: &'static str, make: impl FnOnce() -> T) -> Result<T, PipelineError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        match ready(scope.pop()) {
            None => Ok(made),
            Some(e) => Err(PipelineError { pass, message: one_line(&e) }),
        }
    }
}

fn owned(constants: &[(&str, f64)]) -> Vec<(String, f64)> {
    constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect()
}

/// What wgpu said.
pub(crate) fn one_line(error: &wgpu::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The outcome of an error scope. On native backends it is there at once; in a browser it comes later, and the error goes
/// to the console instead.
pub(crate) fn ready(pop: impl Future<Output = Option<wgpu::Error>>) -> Option<wgpu::Error> {
    let mut pop = std::pin::pin!(pop);
    match pop.as_mut().poll(&mut std::task::Context::from_waker(std::task::Waker::noop())) {
        std::task::Poll::Ready(error) => error,
        std::task::Poll::Pending => None,
    }
}

/// Entries of `@group(3)`.
pub(crate) mod entry {
    use wgpu::{BindGroupLayoutEntry, BindingType, BufferBindingType, ShaderStages};

    pub fn texture(binding: u32, visibility: ShaderStages) -> BindGroupLayoutEntry {
        let ty = BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        BindGroupLayoutEntry { binding, visibility, ty, count: None }
    }

    pub fn store(binding: u32) -> BindGroupLayoutEntry {
        let ty = BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: crate::scratch::IMAGE_FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        BindGroupLayoutEntry { binding, visibility: ShaderStages::COMPUTE, ty, count: None }
    }

    /// One of several equal parts of a read-only buffer, chosen by a dynamic offset.
    pub fn part(binding: u32, visibility: ShaderStages, bytes: u64) -> BindGroupLayoutEntry {
        let ty = BindingType::Buffer {
            ty: BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: true,
            min_binding_size: wgpu::BufferSize::new(bytes),
        };
        BindGroupLayoutEntry { binding, visibility, ty, count: None }
    }

    pub fn buffer(binding: u32, visibility: ShaderStages, read_only: bool) -> BindGroupLayoutEntry {
        let ty = BindingType::Buffer {
            ty: BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        BindGroupLayoutEntry { binding, visibility, ty, count: None }
    }
}
