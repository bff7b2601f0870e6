//! What can go wrong, where, and what to do about it.

use crate::host::graph::Part;
use crate::rays::RayTier;
use crate::settings::{Execution, Pattern, SettingsError};
use std::fmt;

/// [`DeferredAa::new`](crate::DeferredAa::new) could not build the node.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// `Descriptor::m` is out of range.
    #[error("m is {0}: a window has 1 to 8 samples a side; set Descriptor::m to one of them")]
    WindowSize(u32),
    /// The device lacks what the descriptor asks for.
    #[error("the device lacks {}; request Requirements::features and ::limits with it, or choose another tier", .0.join(", "))]
    Missing(Vec<String>),
    /// The target's format can't be rendered to as floating point colour.
    #[error(
        "target format {0:?} can't hold a colour image; choose a renderable float or normalised format, such as Rgba8UnormSrgb or Rgba16Float"
    )]
    TargetFormat(wgpu::TextureFormat),
    /// The host's WGSL is wrong.
    #[error(transparent)]
    Shading(#[from] ShadingError),
    /// A pass that this frame does not have.
    #[error("the pass '{0}' is not of this frame; take DeferredAa::passes of the frame's own settings and needs")]
    ForeignPass(&'static str),
    /// A pipeline was refused.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
}

/// The driver or wgpu refused a pipeline, mostly because the host's bind group layout does not fit its WGSL.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("pass '{pass}' could not be compiled: {message}; hold the host's bind group layout against its WGSL")]
pub struct PipelineError {
    /// The pass.
    pub pass: &'static str,
    /// What wgpu said, in one line.
    pub message: String,
}

/// [`DeferredAa::resize`](crate::DeferredAa::resize) was asked for a size that can't be had.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SizeError {
    /// A side is 0.
    #[error("{width}×{height} has no pixels; skip the frame while the window is minimised")]
    Empty {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// The G-buffer does not fit the device's limits.
    #[error(
        "{width}×{height} at m = {m} needs a G-buffer {}×{}, the device allows {limit} a side; lower m or the size, \
         or request a greater max_texture_dimension_2d",
        u64::from(*.width) * u64::from(*.m), u64::from(*.height) * u64::from(*.m)
    )]
    TooLarge {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Samples a side of a window.
        m: u32,
        /// `max_texture_dimension_2d` of the device.
        limit: u32,
    },
    /// A buffer of one word a pixel does not fit the device's limits.
    #[error(
        "{width}×{height} needs a buffer of {bytes} bytes, the device binds {limit}; request a greater max_storage_buffer_binding_size"
    )]
    Buffer {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// What the plan of this size takes.
        bytes: u64,
        /// What the device binds.
        limit: u64,
    },
    /// The device is out of memory.
    #[error(
        "the device has no memory for {bytes} bytes of {width}×{height} at m = {m}: {message}; lower m or the size"
    )]
    OutOfMemory {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Samples a side of a window.
        m: u32,
        /// What was asked for in all.
        bytes: u64,
        /// What wgpu said.
        message: String,
    },
}

/// [`DeferredAa::lend`](crate::DeferredAa::lend) took nothing: all is as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LendError {
    /// No [`resize`](crate::DeferredAa::resize) has succeeded yet.
    #[error("the node has no size yet; call resize before lend")]
    NoSize,
    /// Its content is not the frame's alone.
    #[error("{0:?} can't be lent: its content lives across frames, or is the host's already; leave it out")]
    NotLendable(Part),
    /// Two loans for one part.
    #[error("{0:?} is lent twice; lend it once")]
    Twice(Part),
    /// One buffer or texture for two parts that a pass binds together.
    #[error("{part:?} and {other:?} are lent the same memory, but passes bind both at once; lend each its own")]
    Together {
        /// The later one.
        part: Part,
        /// The one before.
        other: Part,
    },
    /// A buffer for a texture, or the other way.
    #[error("{part:?} is a {needed}; lend it one")]
    Kind {
        /// What it is lent for.
        part: Part,
        /// `texture` or `buffer`.
        needed: &'static str,
    },
    /// A texture of another format.
    #[error("{part:?} is lent a texture of {lent:?}; it needs {needed:?}")]
    Format {
        /// What it is lent for.
        part: Part,
        /// Of the texture.
        lent: wgpu::TextureFormat,
        /// Of the part.
        needed: wgpu::TextureFormat,
    },
    /// A texture of another shape.
    #[error("{part:?} needs a 2D texture of {width}×{height} with one layer, mip level and sample; lend it such a one")]
    Extent {
        /// What it is lent for.
        part: Part,
        /// Texels.
        width: u32,
        /// Texels.
        height: u32,
    },
    /// A texture that lacks usages.
    #[error("{part:?} is lent a texture without {missing:?}; create it with that usage")]
    TextureUsage {
        /// What it is lent for.
        part: Part,
        /// What it lacks.
        missing: wgpu::TextureUsages,
    },
    /// A buffer that lacks usages.
    #[error("{part:?} is lent a buffer without {missing:?}; create it with that usage")]
    BufferUsage {
        /// What it is lent for.
        part: Part,
        /// What it lacks.
        missing: wgpu::BufferUsages,
    },
    /// A buffer that is too small, or more than the device binds.
    #[error("{part:?} is lent {lent} bytes; it needs {needed}, and the device binds {limit} at most")]
    Bytes {
        /// What it is lent for.
        part: Part,
        /// Of the buffer.
        lent: u64,
        /// At least.
        needed: u64,
        /// At most.
        limit: u64,
    },
    /// wgpu refused to bind it, or had no memory for what is not lent any more.
    #[error("the device refused: {0}; lend what was made by the node's own device")]
    Refused(String),
}

/// [`DeferredAa::record`](crate::DeferredAa::record) recorded nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// No [`resize`](crate::DeferredAa::resize) has succeeded yet.
    #[error("the node has no size yet; call resize before record")]
    NoSize,
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The camera can't be inverted.
    #[error("the camera's {0} is singular or not finite; {mend}", mend = camera_mend(.0))]
    Camera(&'static str),
    /// Exposure is not a positive number.
    #[error("exposure is {0}; it is a finite factor above 0, 1 if the host has none")]
    Exposure(f32),
    /// The target is of another size than the node.
    #[error(
        "the target is {target_width}×{target_height}, the node {width}×{height}; call resize with the target's size"
    )]
    TargetSize {
        /// Of the target.
        target_width: u32,
        /// Of the target.
        target_height: u32,
        /// Of the node.
        width: u32,
        /// Of the node.
        height: u32,
    },
    /// The target is of another format than the descriptor's.
    #[error(
        "the target is {target:?}, the node writes {node:?}; build the node with Descriptor::target_format = {target:?}"
    )]
    TargetFormat {
        /// Of the target.
        target: wgpu::TextureFormat,
        /// Of the descriptor.
        node: wgpu::TextureFormat,
    },
    /// The target lacks `RENDER_ATTACHMENT`.
    #[error("the target can't be rendered to; create it with TextureUsages::RENDER_ATTACHMENT")]
    TargetUsage,
    /// The target is multisampled.
    #[error("the target has {0} samples a pixel, the node writes one; render into a texture with sample_count = 1")]
    TargetSamples(u32),
    /// The host's WGSL has a group, the frame has none.
    #[error("the host's WGSL was built with a bind group layout, the frame has no host_bind_group; set it")]
    HostBindGroup,
    /// The descriptor has a texture tier, the frame has no table.
    #[error(
        "the node was built with a texture tier, the frame has no table; set Frame::textures, an empty table if there are none"
    )]
    Textures,
    /// A list is too large.
    #[error(
        "{} at {width}×{height}, m = {m} lists up to {bytes} bytes: {why}; {}",
        execution.map_or("Selective".into(), |e| format!("{e:?}")),
        if execution.is_some() { "use Execution::Tiled or Loop, which list nothing" } else { "use a smaller size or m" }
    )]
    List {
        /// Whose list; `None`: that of [`Technique::Selective`](crate::Technique::Selective).
        execution: Option<Execution>,
        /// Of the node.
        width: u32,
        /// Of the node.
        height: u32,
        /// Of the node.
        m: u32,
        /// Of its largest buffer, or of all if memory ran out.
        bytes: u64,
        /// The limit that it exceeds, or what the driver said.
        why: String,
    },
    /// The frame needs rays, the node was built without.
    #[error("the frame asks for rays, the node was built without them; set Descriptor::rays")]
    NoRays,
    /// The frame needs rays and brings no scene for them.
    #[error("the frame asks for rays, but has no scene for them; set Needs::rays")]
    NoRayScene,
    /// The frame has materials that send rays, the host's WGSL does not say which.
    #[error(
        "the frame has materials that reflect or refract, but the host's WGSL has no `fn bounce(s: DaaSample) -> DaaBounce`; write it, or leave Needs::bounces empty"
    )]
    NoBounce,
    /// The scene for rays is for another tier.
    #[error(
        "the scene for rays was made for RayTier::{scene:?}, the node for RayTier::{node:?}; make it with the node's tier"
    )]
    RayTier {
        /// Of the scene.
        scene: RayTier,
        /// Of the descriptor.
        node: RayTier,
    },
    /// The scene for rays was updated for another camera.
    #[error(
        "the scene for rays was updated for a camera at {scene}, the frame's is at {camera}; call RayScene::update with it"
    )]
    RayCamera {
        /// Where the scene has it.
        scene: glam::Vec3,
        /// Where the frame has it.
        camera: glam::Vec3,
    },
    /// More lights than bits.
    #[error("{lights} lights cast shadows; {limit} can, so leave some out of Needs::shadows")]
    CastingLights {
        /// How many.
        lights: usize,
        /// Most.
        limit: usize,
    },
    /// A light is nowhere.
    #[error("light {0} of Needs::shadows is not finite, or has no direction")]
    CastingLight(usize),
    /// A material is beyond what a G-buffer holds.
    #[error("Needs::textured[{index}] is {material}; the G-buffer holds materials below 65536")]
    TexturedMaterial {
        /// Its place in the list.
        index: usize,
        /// Its index.
        material: u32,
    },
    /// An object is beyond the table of importances.
    #[error("Needs::importance[{index}].object is {object}; the table ends at 65535, as the G-buffer's objects do")]
    ImportantObject {
        /// Its place in the list.
        index: usize,
        /// Its id.
        object: u32,
    },
    /// An importance is out of its range.
    #[error("Needs::importance[{index}].importance is {importance}, it must lie in 0 to 1")]
    Importance {
        /// Its place in the list.
        index: usize,
        /// What it was set to.
        importance: f32,
    },
    /// What rays find is too large.
    #[error("rays at {width}×{height}, m = {m} keep {bytes} bytes: {why}; use a smaller size or m")]
    Traces {
        /// Of the node.
        width: u32,
        /// Of the node.
        height: u32,
        /// Of the node.
        m: u32,
        /// Of its buffer.
        bytes: u64,
        /// The limit that it exceeds, or what the driver said.
        why: String,
    },
    /// A lattice begins with cells that the image is smaller than.
    #[error(
        "multi_resolution.{lattice}.coarsest is {coarsest}: cells of {} pixels don't fit {width}×{height}; {most} does",
        1 << coarsest
    )]
    Coarsest {
        /// `shading` or `rays`.
        lattice: &'static str,
        /// What it was set to.
        coarsest: u32,
        /// Of the node.
        width: u32,
        /// Of the node.
        height: u32,
        /// The greatest that fits.
        most: u32,
    },
    /// A shifted lattice at m = 1.
    #[error(
        "multi_resolution.shading.pattern is {0:?}: its rows are shifted by half a pixel, where a node with m = 1 has no sample; \
         use Pattern::Quad, or a node with a larger m"
    )]
    Shifted(Pattern),
    /// The lattices are too large.
    #[error("lattices at {width}×{height} keep {bytes} bytes: {why}; use a smaller size")]
    Lattices {
        /// Of the node.
        width: u32,
        /// Of the node.
        height: u32,
        /// Of all buffers.
        bytes: u64,
        /// The limit that one exceeds, or what the driver said.
        why: String,
    },
    /// What was lent is too small for this frame.
    #[error("{part:?} was lent {lent} bytes, this frame needs {needed}; lend as much, or none")]
    Lent {
        /// What it was lent for.
        part: Part,
        /// Of the buffer.
        lent: u64,
        /// At least.
        needed: u64,
    },
    /// A pass that this frame does not have.
    #[error("the pass '{0}' is not of this frame; take DeferredAa::passes of the frame's own settings and needs")]
    ForeignPass(&'static str),
    /// A pipeline was refused.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
}

fn camera_mend(part: &str) -> &'static str {
    match part {
        "view" => "world_from_view is a rotation and a translation",
        _ => "give it a size above 0 and a near plane above 0",
    }
}

/// A [`TextureTable`](crate::TextureTable) could not be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// More classes of size, format, mips and sampler than the tier has array textures.
    #[error(
        "the textures fall into {classes} classes of size, format, mip count and sampler, the array tier has {most}; \
         resize some to a common size, or use the binding tier"
    )]
    Classes {
        /// How many there are.
        classes: usize,
        /// How many there may be.
        most: usize,
    },
    /// More textures than the table holds.
    #[error("{textures} textures, the table holds {most}; raise Descriptor::texture_capacity")]
    Capacity {
        /// How many there are.
        textures: usize,
        /// How many there may be.
        most: usize,
    },
    /// A texture of the wrong kind.
    #[error("texture {index} {problem}")]
    Texture {
        /// Its place in the list.
        index: usize,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The node has no texture tier.
    #[error("the node was built without a texture tier; set Descriptor::textures")]
    NoTier,
}

/// The host's WGSL is wrong, at a place in its own file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadingError {
    /// As given in [`Shading::file`](crate::Shading::file).
    pub file: String,
    /// From 1; 0 if the error is about the file as a whole.
    pub line: u32,
    /// From 1, in characters; 0 if the error is about the file as a whole.
    pub column: u32,
    /// What is wrong.
    pub kind: ShadingErrorKind,
}

/// What is wrong with the host's WGSL.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadingErrorKind {
    /// It does not parse, or a name or a type is wrong.
    #[error("{0}")]
    Wgsl(String),
    /// No hook was found.
    #[error(
        "no shading function; write `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` \
         and `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`"
    )]
    NoHook,
    /// One half of the split hook.
    #[error("`{have}` without `{missing}`; write both, or one `fn shade(s: DaaSample) -> vec4f`")]
    HalfHook {
        /// What is there.
        have: &'static str,
        /// What is not.
        missing: &'static str,
    },
    /// Both kinds of hook.
    #[error("both `shade` and `material` or `light`; keep one way of shading, rename the other")]
    TwoHooks,
    /// A hook has the wrong signature.
    #[error("`{name}` must be `{expected}`")]
    Signature {
        /// The function.
        name: &'static str,
        /// How it must read.
        expected: &'static str,
    },
    /// A name of the crate's.
    #[error("`{0}` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it")]
    ReservedName(String),
    /// A built-in name of WGSL that the crate's own chunks use, declared anew.
    #[error("`{0}` is a built-in of WGSL that deferred-aa's own code uses; rename this one")]
    Clash(String),
    /// A binding outside of the host's group.
    #[error("`{name}` is bound to @group({group}); the host has @group({}) alone, bind it there", crate::HOST_GROUP)]
    Group {
        /// The variable.
        name: String,
        /// Its group.
        group: u32,
    },
    /// An entry point.
    #[error("`{0}` is an entry point; the crate brings its own, remove @compute, @vertex or @fragment")]
    EntryPoint(String),
    /// A derivative or an implicit-gradient sample, which no compute shader has.
    #[error("{0}; shading runs in compute: sample with textureSampleGrad or daa_texture and the sample's ddx, ddy")]
    Derivative(String),
}

impl std::error::Error for ShadingError {}

impl fmt::Display for ShadingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.kind),
            line => write!(f, "{}:{line}:{}: {}", self.file, self.column, self.kind),
        }
    }
}
