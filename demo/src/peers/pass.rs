//! What the passes over a whole image share.

use crate::host::gpu::Gpu;
use deferred_aa::{PassKind, PassTime};

/// A pipeline that draws one triangle over a target, and its bind group's layout.
#[derive(Debug)]
pub struct Fullscreen {
    name: &'static str,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// A texture that a fragment shader reads, by a sampler too if `filtered`.
pub fn texture_entry(binding: u32, filtered: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: filtered },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

impl Fullscreen {
    /// The entry points are `name`_vertex and `name`_fragment.
    pub fn new(
        device: &wgpu::Device,
        name: &'static str,
        source: &'static str,
        entries: &[wgpu::BindGroupLayoutEntry],
        format: wgpu::TextureFormat,
    ) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(name), entries });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(&format!("{name}_vertex")),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(&format!("{name}_fragment")),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { name, layout, pipeline }
    }

    pub fn bind(&self, device: &wgpu::Device, entries: &[wgpu::BindGroupEntry<'_>]) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(self.name), layout: &self.layout, entries })
    }

    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bind_group: &wgpu::BindGroup,
        to: &wgpu::TextureView,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = begin(encoder, self.name, to, wgpu::LoadOp::Clear(wgpu::Color::BLACK), timestamps);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A render pass on one target.
pub fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    name: &str,
    to: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: to,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: None,
        timestamp_writes,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

/// What a peer took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeerShot {
    /// On top of what made the image, `display` included: by GPU timestamps, from the begin of the peer's first pass to
    /// the end of its last. SMAA's holds the time between its three submits too. `None` on a device without timestamps.
    pub milliseconds: Option<f64>,
}

impl PeerShot {
    /// Its time, to stand beside those of the node's passes.
    pub fn pass(self, name: &'static str) -> PassTime {
        PassTime { name, kind: PassKind::Host, milliseconds: self.milliseconds }
    }
}

/// Two timestamps, from the begin of one pass to the end of another, which may be in different submits.
#[derive(Debug)]
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
}

impl Timer {
    /// `None` on a device without timestamps.
    pub fn new(device: &wgpu::Device) -> Option<Self> {
        device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("peers"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("peers timestamps"),
                size: 16,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        })
    }

    /// Of the pass that begins.
    pub fn begin(&self) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: None,
        }
    }

    /// Of the pass that ends.
    pub fn end(&self) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: None,
            end_of_pass_write_index: Some(1),
        }
    }

    /// After the pass that ends.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
    }

    /// Waits for the GPU.
    pub fn milliseconds(&self, gpu: &Gpu) -> Option<f64> {
        let bytes = gpu.read_buffer(&self.resolved);
        let [begin, end]: [u64; 2] = bytemuck::pod_collect_to_vec(&bytes).try_into().ok()?;
        Some(end.saturating_sub(begin) as f64 * f64::from(gpu.queue.get_timestamp_period()) * 1e-6)
    }
}
