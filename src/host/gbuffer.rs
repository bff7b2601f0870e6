//! The enlarged G-buffer that the host renders into, m·width × m·height samples.
//!
//! [`GBufferTier::Stored`] keeps the attributes of each sample, those that the host's shading reads:
//!
//! | target | format | holds |
//! |---|---|---|
//! | surface | `Rg32Uint` | normal, octahedral 16+16 bits; material index 16 bits, object id 16 bits |
//! | frame | `Rg32Uint` | geometric normal, octahedral 8+8 bits; tangent angle 15 bits and sign; the host's 32 bits |
//! | uv | `Rgba32Uint` | uv as two f32; ∂uv/∂x and ∂uv/∂y as four f16, per sample |
//! | depth | `Depth32Float` | reversed z: 1 near, 0 at the far plane, where there is only sky |
//!
//! The target frame is `R32Uint` if the host reads neither of the normal and the tangent, or not its own 32 bits, and
//! is left out if it reads none of them; uv is left out if it reads no texture coordinates. A sample has 12 to 36 bytes
//! with depth. Gradients are stored, not derived from neighbouring samples: the rasteriser takes them inside one
//! triangle, so no material or UV seam can smear.
//!
//! [`GBufferTier::Visibility`] keeps which triangle a sample shows, 8 or 12 bytes with depth:
//!
//! | target | format | holds |
//! |---|---|---|
//! | ids | `Rg32Uint` or `R32Uint` | index of the instance + 1, 0 where nothing is drawn; index of the triangle in its mesh |
//! | depth | `Depth32Float` | as above |
//!
//! Clear colour and depth to 0, and write depth where it is greater.

/// The format of the depth target.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How the G-buffer keeps its samples. Both tiers give the same image, but for the rounding of stored normals and
/// gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum GBufferTier {
    /// The attributes of each sample, 12 to 36 bytes by the channels. The host needs nothing but its rasteriser.
    Stored(Channels),
    /// The triangle of each sample, 8 or 12 bytes. The node reads the attributes from the meshes and instances of a
    /// [`RayScene`](crate::rays::RayScene) when it needs them, so rasterising costs a fraction and nothing is rounded.
    Visibility(Ids),
}

/// How a visibility buffer names a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Ids {
    /// By 32 bits for the instance and 32 for the triangle: 8 bytes a sample. Every scene fits.
    Wide,
    /// By 32 bits for both: 4 bytes a sample. A scene fits if none of its meshes has more than 2^`triangle_bits`
    /// triangles, and a frame has fewer than 2^(32 − `triangle_bits`) instances;
    /// [`DeferredAa::record`](crate::DeferredAa::record) refuses others.
    Narrow {
        /// The bits for the triangle, 1 to 31.
        triangle_bits: u32,
    },
}

impl Ids {
    /// The narrowest ids for meshes of up to so many triangles and so many instances, now and in frames to come.
    pub fn for_scene(most_triangles: u32, most_instances: u32) -> Self {
        let triangle_bits = most_triangles.saturating_sub(1).checked_ilog2().map_or(1, |log2| log2 + 1);
        let narrow = Self::Narrow { triangle_bits };
        if narrow.fits(most_triangles, most_instances) { narrow } else { Self::Wide }
    }

    pub(crate) fn fits(self, most_triangles: u32, instances: u32) -> bool {
        match self {
            Self::Wide => true,
            Self::Narrow { triangle_bits: bits @ 1..=31 } => {
                u64::from(most_triangles) <= 1 << bits && u64::from(instances) < 1 << (32 - bits)
            }
            Self::Narrow { .. } => false,
        }
    }
}

impl Default for GBufferTier {
    fn default() -> Self {
        Self::Stored(Channels::ALL)
    }
}

/// The attributes that a stored G-buffer keeps besides the normal, the material and the object. Each that the host's
/// WGSL does not read saves its bytes in every sample; [`DeferredAa::new`](crate::DeferredAa::new) refuses WGSL that
/// reads one which is not kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Channels {
    /// `uv`, `ddx` and `ddy`: 16 bytes.
    pub uv: bool,
    /// `tangent`: 4 bytes together with the geometric normal.
    pub tangent: bool,
    /// `geometric_normal`: 4 bytes together with the tangent. Rays need it, since they start along it.
    pub geometric_normal: bool,
    /// `user`: 4 bytes.
    pub user: bool,
}

impl Channels {
    /// Everything, 36 bytes a sample with depth.
    pub const ALL: Self = Self { uv: true, tangent: true, geometric_normal: true, user: true };
    /// Only the normal, the material and the object, 12 bytes a sample with depth.
    pub const NONE: Self = Self { uv: false, tangent: false, geometric_normal: false, user: false };

    /// The names in `DaaSample` of what is not kept.
    pub(crate) fn missing(self) -> impl Iterator<Item = &'static str> {
        let all = [
            ("uv", self.uv),
            ("ddx", self.uv),
            ("ddy", self.uv),
            ("tangent", self.tangent),
            ("geometric_normal", self.geometric_normal),
            ("user", self.user),
        ];
        all.into_iter().filter(|(_, kept)| !kept).map(|(name, _)| name)
    }

    /// Which words of the target frame are kept: that of the normal and the tangent, and the host's own.
    pub(crate) fn frame(self) -> [bool; 2] {
        [self.geometric_normal || self.tangent, self.user]
    }
}

impl GBufferTier {
    /// The format of the first target: the surface, or the ids.
    pub(crate) fn first_format(self) -> wgpu::TextureFormat {
        match self {
            Self::Stored(_) | Self::Visibility(Ids::Wide) => wgpu::TextureFormat::Rg32Uint,
            Self::Visibility(Ids::Narrow { .. }) => wgpu::TextureFormat::R32Uint,
        }
    }

    /// How triangles are named, `None` if attributes are stored.
    pub(crate) fn ids(self) -> Option<Ids> {
        match self {
            Self::Stored(_) => None,
            Self::Visibility(ids) => Some(ids),
        }
    }

    /// The format of the target frame, if there is one.
    pub(crate) fn frame_format(self) -> Option<wgpu::TextureFormat> {
        let Self::Stored(channels) = self else { return None };
        match channels.frame() {
            [false, false] => None,
            [true, true] => Some(wgpu::TextureFormat::Rg32Uint),
            _ => Some(wgpu::TextureFormat::R32Uint),
        }
    }

    /// The format of the target uv, if there is one.
    pub(crate) fn uv_format(self) -> Option<wgpu::TextureFormat> {
        matches!(self, Self::Stored(Channels { uv: true, .. })).then_some(wgpu::TextureFormat::Rgba32Uint)
    }

    /// The formats of the colour targets, in the order of the locations in `DaaGBuffer`.
    pub fn color_formats(self) -> Vec<wgpu::TextureFormat> {
        [Some(self.first_format()), self.frame_format(), self.uv_format()].into_iter().flatten().collect()
    }

    /// The size of one sample in bytes, depth included.
    pub fn bytes_per_sample(self) -> u64 {
        let color = self.color_formats().into_iter().map(|format| format.block_copy_size(None).unwrap_or(0));
        u64::from(color.sum::<u32>()) + 4
    }

    /// The colour targets for the host's pipelines.
    pub fn color_targets(self) -> Vec<Option<wgpu::ColorTargetState>> {
        self.color_formats().into_iter().map(|format| Some(format.into())).collect()
    }

    /// WGSL for the host's raster shader; join it with the host's own source. It declares `DaaGBuffer`, the result of
    /// the fragment entry point, and
    /// - for [`Stored`](Self::Stored) `DaaFragment` and `fn daa_pack(f: DaaFragment) -> DaaGBuffer`. A channel that is not
    ///   kept need not be set;
    /// - for [`Visibility`](Self::Visibility) `fn daa_pack(instance: u32, triangle: u32) -> DaaGBuffer`: the index of the
    ///   instance in [`RayScene::update`](crate::rays::RayScene::update), and that of the triangle in its mesh, such as
    ///   `@builtin(primitive_index)`.
    pub fn pack_wgsl(self) -> String {
        const OCTAHEDRAL: &str = include_str!("../../shaders/shared/octahedral.wgsl");
        let channels = match self {
            Self::Stored(channels) => channels,
            Self::Visibility(ids) => return pack_ids(ids),
        };
        let (ty, word) = match channels.frame() {
            [true, true] => ("vec2u", "frame"),
            [_, false] => ("u32", "frame.x"),
            [false, _] => ("u32", "frame.y"),
        };
        let targets = [
            Some(("surface", "vec2u", "surface")),
            self.frame_format().map(|_| ("frame", ty, word)),
            self.uv_format().map(|_| ("uv", "vec4u", "daa_pack_uv(f)")),
        ];
        let targets = || targets.into_iter().flatten();
        let declared = targets().enumerate().map(|(i, (name, ty, _))| format!("    @location({i}) {name}: {ty},\n"));
        let packed: Vec<_> = targets().map(|(_, _, packed)| packed).collect();
        format!(
            "{OCTAHEDRAL}\n{PACK}\n/// The colour targets of the G-buffer.\nstruct DaaGBuffer {{\n{}}}\n\n\
             fn daa_pack(f: DaaFragment) -> DaaGBuffer {{\n    let surface = daa_pack_surface(f);\n    \
             let frame = daa_pack_frame(f, surface.x);\n    return DaaGBuffer({});\n}}\n",
            declared.collect::<String>(),
            packed.join(", "),
        )
    }
}

pub(crate) const PACK: &str = include_str!("../../shaders/gbuffer/pack.wgsl");

fn pack_ids(ids: Ids) -> String {
    let (ty, packed) = match ids {
        Ids::Wide => ("vec2u", "vec2u(instance + 1u, triangle)".to_owned()),
        Ids::Narrow { triangle_bits } => ("u32", format!("((instance + 1u) << {triangle_bits}u) | triangle")),
    };
    format!(
        "/// The colour target of the G-buffer.\nstruct DaaGBuffer {{\n    @location(0) ids: {ty},\n}}\n\n\
         fn daa_pack(instance: u32, triangle: u32) -> DaaGBuffer {{\n    return DaaGBuffer({packed});\n}}\n"
    )
}

/// The attachments to render into, m·width × m·height samples of the output, or of a [band](crate::Band) with its
/// apron. The node owns them; [`resize`](crate::DeferredAa::resize) replaces them.
#[derive(Debug, Clone)]
pub struct GBuffer {
    /// The number of samples along x: m · width.
    pub width: u32,
    /// The number of samples along y: m · height.
    pub height: u32,
    /// The colour targets, in the order of [`GBufferTier::color_formats`].
    pub color: Vec<wgpu::TextureView>,
    /// The depth target, in [`DEPTH_FORMAT`].
    pub depth: wgpu::TextureView,
}

impl GBuffer {
    /// The colour attachments for a render pass, which clears them.
    pub fn color_attachments(&self) -> Vec<Option<wgpu::RenderPassColorAttachment<'_>>> {
        let attachment = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        self.color.iter().map(attachment).collect()
    }

    /// The depth attachment for a render pass, which clears it.
    pub fn depth_attachment(&self) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What nobody reads has no target and no bytes.
    #[test]
    fn a_sample_has_the_bytes_of_its_channels() {
        let bytes = |channels| GBufferTier::Stored(channels).bytes_per_sample();
        assert_eq!((bytes(Channels::NONE), bytes(Channels::ALL)), (12, 36));
        assert_eq!(bytes(Channels { user: true, ..Channels::NONE }), 16);
        assert_eq!(bytes(Channels { tangent: true, ..Channels::NONE }), 16);
        assert_eq!(bytes(Channels { uv: false, ..Channels::ALL }), 20);
        assert_eq!(bytes(Channels { uv: true, ..Channels::NONE }), 28);
        let ids = |ids| GBufferTier::Visibility(ids).bytes_per_sample();
        assert_eq!((ids(Ids::Wide), ids(Ids::Narrow { triangle_bits: 20 })), (12, 8));
    }

    #[test]
    fn narrow_ids_are_for_scenes_that_fit() {
        assert_eq!(Ids::for_scene(0, 0), Ids::Narrow { triangle_bits: 1 });
        assert_eq!(Ids::for_scene(1 << 20, 4095), Ids::Narrow { triangle_bits: 20 });
        assert_eq!(Ids::for_scene(1 << 20, 4096), Ids::Wide);
        assert_eq!(Ids::for_scene((1 << 20) + 1, 2047), Ids::Narrow { triangle_bits: 21 });
        assert_eq!(Ids::for_scene(u32::MAX, 1), Ids::Wide);
        assert!(!Ids::Narrow { triangle_bits: 32 }.fits(1, 0) && !Ids::Narrow { triangle_bits: 0 }.fits(1, 0));
    }
}
