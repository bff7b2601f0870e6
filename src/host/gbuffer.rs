//! The enlarged G-buffer that the host renders into.
//!
//! | target | format | holds |
//! |---|---|---|
//! | 0 surface | `Rg32Uint` | normal, octahedral 16+16 bits; material index 16 bits, object id 16 bits |
//! | 1 frame | `Rg32Uint` | geometric normal, octahedral 8+8 bits; tangent angle 15 bits and sign; the host's 32 bits |
//! | 2 uv | `Rgba32Uint` | uv as two f32; ∂uv/∂x and ∂uv/∂y as four f16, per sample |
//! | depth | `Depth32Float` | reversed z: 1 near, 0 at the far plane, where there is only sky |
//!
//! A sample has 32 bytes of colour, WebGPU's default limit, and 4 bytes of depth. Gradients are stored, not derived
//! from neighbouring samples: the rasteriser takes them inside one triangle, so no material or UV seam can smear. Clear
//! colour and depth to 0, and write depth where it is greater.

/// The formats of the colour targets, in the order of the locations in `DaaGBuffer`.
pub const COLOR_FORMATS: [wgpu::TextureFormat; 3] =
    [wgpu::TextureFormat::Rg32Uint, wgpu::TextureFormat::Rg32Uint, wgpu::TextureFormat::Rgba32Uint];

/// The format of the depth target.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The size of one sample in bytes, depth included.
pub const BYTES_PER_SAMPLE: u64 = 36;

/// WGSL for the host's raster shader: `DaaFragment`, `DaaGBuffer` and `fn daa_pack(f: DaaFragment) -> DaaGBuffer`. Join
/// it with the host's own source and return `daa_pack(..)` from the fragment entry point.
pub const PACK_WGSL: &str =
    concat!(include_str!("../../shaders/shared/octahedral.wgsl"), "\n", include_str!("../../shaders/pack.wgsl"));

/// The attachments to render into, m·width × m·height samples of the output, or of a [band](crate::Band) with its
/// apron. The node owns them; [`resize`](crate::DeferredAa::resize) replaces them.
#[derive(Debug, Clone)]
pub struct GBuffer {
    /// The number of samples along x: m · width.
    pub width: u32,
    /// The number of samples along y: m · height.
    pub height: u32,
    /// The colour targets, in the order of [`COLOR_FORMATS`].
    pub color: [wgpu::TextureView; 3],
    /// The depth target, in [`DEPTH_FORMAT`].
    pub depth: wgpu::TextureView,
}

impl GBuffer {
    /// The colour attachments for a render pass, which clears them.
    pub fn color_attachments(&self) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 3] {
        self.color.each_ref().map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        })
    }

    /// The depth attachment for a render pass, which clears it.
    pub fn depth_attachment(&self) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }
    }

    /// The colour targets for the host's pipelines.
    pub fn color_targets() -> [Option<wgpu::ColorTargetState>; 3] {
        COLOR_FORMATS.map(|format| Some(format.into()))
    }

    /// The depth state for the host's pipelines: reversed z.
    pub fn depth_state() -> wgpu::DepthStencilState {
        wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }
    }
}
