//! The errors of the public interface. Each says what is wrong, where, and what to do about it.

use crate::host::band::Rect;
use crate::host::gbuffer::Ids;
use crate::host::graph::Part;
use crate::rays::RayTier;
use crate::settings::{Execution, Pattern, SettingsError};
use crate::{HOST_GROUP, SECOND_HOST_GROUP};
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
    /// The target's format can't be rendered to as floating-point colour.
    #[error(
        "target format {0:?} can't hold a colour image; choose a renderable float or normalised format, such as Rgba8UnormSrgb or Rgba16Float"
    )]
    TargetFormat(wgpu::TextureFormat),
    /// `Ids::Narrow` leaves no bits for the triangle or for the instance.
    #[error(
        "ids with {0} bits for the triangle leave none for the other half; Ids::Narrow takes 1 to 31, see Ids::for_scene"
    )]
    TriangleBits(u32),
    /// Rays need the geometric normal, and the G-buffer does not keep it.
    #[error(
        "rays start along the geometric normal; set Channels::geometric_normal in Descriptor::gbuffer, or Descriptor::rays to None"
    )]
    RayChannel,
    /// The host has a second bind group layout where the texture table has its group.
    #[error(
        "group {SECOND_HOST_GROUP} is the texture table's; the host's second layout needs TextureTier::None, put its bindings into group {HOST_GROUP}"
    )]
    SecondGroup,
    /// The host's WGSL is wrong.
    #[error(transparent)]
    Shading(#[from] ShadingError),
    /// The driver or wgpu refused a pipeline.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
}

/// The driver or wgpu refused a pipeline, usually because the host's bind group layout does not fit its WGSL.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("pass '{pass}' could not be compiled: {message}; compare the host's bind group layout with its WGSL")]
pub struct PipelineError {
    /// The name of the pass.
    pub pass: &'static str,
    /// The message of wgpu, in one line.
    pub message: String,
}

/// [`DeferredAa::resize`](crate::DeferredAa::resize) can't provide the size.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SizeError {
    /// The width or the height is 0.
    #[error("{width}×{height} has no pixels; skip the frame while the window is minimised")]
    Empty {
        /// The width of the output in pixels.
        width: u32,
        /// The height of the output in pixels.
        height: u32,
    },
    /// The G-buffer does not fit the device's limits.
    #[error(
        "{width}×{height} at m = {m} needs a G-buffer {}×{}, the device allows {limit} a side; lower m or the size, \
         divide it with resize_banded, or request a greater max_texture_dimension_2d",
        u64::from(*.width) * u64::from(*.m), u64::from(*.height) * u64::from(*.m)
    )]
    TooLarge {
        /// The width of the output in pixels.
        width: u32,
        /// The height of the output in pixels.
        height: u32,
        /// The number of samples along one side of a window.
        m: u32,
        /// The device's `max_texture_dimension_2d`.
        limit: u32,
    },
    /// The image has more samples along a side than bands may have together.
    #[error(
        "{width}×{height} at m = {m} is more than {limit} samples a side, the most of an image in bands; lower m or the size"
    )]
    Samples {
        /// The width of the output in pixels.
        width: u32,
        /// The height of the output in pixels.
        height: u32,
        /// The number of samples along one side of a window.
        m: u32,
        /// The most samples along one side.
        limit: u32,
    },
    /// No bands of the image fit the limit.
    #[error(
        "{width}×{height} at m = {m} can't be rendered in bands within {limit} bytes; allow at least {least} bytes, or lower m"
    )]
    Limit {
        /// The width of the output in pixels.
        width: u32,
        /// The height of the output in pixels.
        height: u32,
        /// The number of samples along one side of a window.
        m: u32,
        /// The limit in bytes.
        limit: u64,
        /// The least bytes that would do.
        least: u64,
    },
    /// A buffer of one word per pixel exceeds the device's limits.
    #[error(
        "{width}×{height} needs a buffer of {bytes} bytes, the device binds {limit}; request a greater max_storage_buffer_binding_size"
    )]
    Buffer {
        /// The width of the output in pixels.
        width: u32,
        /// The height of the output in pixels.
        height: u32,
        /// The bytes of the plan at this size.
        bytes: u64,
        /// The most bytes that the device binds.
        limit: u64,
    },
    /// The device is out of memory.
    #[error(
        "the device has no memory for {bytes} bytes of {width}×{height} at m = {m}: {message}; lower m or the size"
    )]
    OutOfMemory {
        /// The width of the output in pixels.
        width: u32,
        /// The height of the output in pixels.
        height: u32,
        /// The number of samples along one side of a window.
        m: u32,
        /// The bytes requested in all.
        bytes: u64,
        /// The message of wgpu.
        message: String,
    },
}

/// [`DeferredAa::lend`](crate::DeferredAa::lend) refused the memory. Earlier loans stay in place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LendError {
    /// No [`resize`](crate::DeferredAa::resize) has succeeded yet.
    #[error("the node has no size yet; call resize before lend")]
    NoSize,
    /// The content of the part is kept across frames or belongs to the host.
    #[error("{0:?} can't be lent: its content lives across frames, or is the host's already; leave it out")]
    NotLendable(Part),
    /// A part is lent memory twice.
    #[error("{0:?} is lent twice; lend it once")]
    Twice(Part),
    /// Two parts that a pass binds together are lent the same buffer or texture.
    #[error("{part:?} and {other:?} are lent the same memory, but passes bind both at once; lend each its own")]
    Together {
        /// The later of the two parts in the list.
        part: Part,
        /// The earlier of the two parts in the list.
        other: Part,
    },
    /// A texture is lent for a buffer, or a buffer for a texture.
    #[error("{part:?} is a {needed}; lend a {needed} for it")]
    Kind {
        /// The part.
        part: Part,
        /// What the part is: `texture` or `buffer`.
        needed: &'static str,
    },
    /// The texture has another format than the part.
    #[error("{part:?} is lent a texture of {lent:?}; it needs {needed:?}")]
    Format {
        /// The part.
        part: Part,
        /// The format of the texture.
        lent: wgpu::TextureFormat,
        /// The format of the part.
        needed: wgpu::TextureFormat,
    },
    /// The texture has another size or shape than the part.
    #[error(
        "{part:?} needs a 2D texture of {width}×{height} with one layer, mip level and sample; lend such a texture"
    )]
    Extent {
        /// The part.
        part: Part,
        /// The width that the part needs, in texels.
        width: u32,
        /// The height that the part needs, in texels.
        height: u32,
    },
    /// The texture lacks usages.
    #[error("{part:?} is lent a texture without {missing:?}; create it with that usage")]
    TextureUsage {
        /// The part.
        part: Part,
        /// The usages that the texture lacks.
        missing: wgpu::TextureUsages,
    },
    /// The buffer lacks usages.
    #[error("{part:?} is lent a buffer without {missing:?}; create it with that usage")]
    BufferUsage {
        /// The part.
        part: Part,
        /// The usages that the buffer lacks.
        missing: wgpu::BufferUsages,
    },
    /// The buffer is smaller than the part, or larger than the device binds.
    #[error("{part:?} is lent {lent} bytes; it needs {needed}, and the device binds {limit} at most")]
    Bytes {
        /// The part.
        part: Part,
        /// The bytes of the buffer.
        lent: u64,
        /// The least bytes that the part needs.
        needed: u64,
        /// The most bytes that the device binds.
        limit: u64,
    },
    /// wgpu refused to bind the memory, or had no memory for parts that are no longer lent.
    #[error("the device refused: {0}; lend resources of the node's own device")]
    Refused(String),
}

/// [`DeferredAa::record`](crate::DeferredAa::record) refused the frame and recorded nothing.
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
    /// The projection shows what lies behind the camera.
    #[error(
        "the projection looks along +z of the view, and the node along -z; where the host's view is left-handed, negate the third columns of clip_from_view and of world_from_view"
    )]
    Handedness,
    /// The near plane, or what an orthographic camera shows of it, is too far away.
    #[error("a corner of the near plane is {0:e} units from the camera; positions are f32, so give at most 1e8")]
    NearPlane(f32),
    /// Exposure is not a positive number.
    #[error("exposure is {0}; it is a finite factor above 0, 1 if the host has none")]
    Exposure(f32),
    /// The target has another size than the node.
    #[error(
        "the target is {target_width}×{target_height}, the node {width}×{height}; call resize with the target's size"
    )]
    TargetSize {
        /// The width of the target.
        target_width: u32,
        /// The height of the target.
        target_height: u32,
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
    },
    /// The viewport has another size than the node, or does not lie in the target.
    #[error(
        "Frame::viewport is {}×{} at {}, {}; it has the node's size, {width}×{height}, and lies in the target, {target_width}×{target_height}",
        viewport.width, viewport.height, viewport.x, viewport.y
    )]
    Viewport {
        /// The viewport of the frame.
        viewport: Rect,
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
        /// The width of the target.
        target_width: u32,
        /// The height of the target.
        target_height: u32,
    },
    /// The node keeps bands of the image, but the frame has none.
    #[error(
        "the node keeps bands of {width}×{height} pixels; record each band that resize_banded returns, as Frame::band"
    )]
    NoBand {
        /// The width of a band with its apron.
        width: u32,
        /// The height of a band with its apron.
        height: u32,
    },
    /// The band is not one of the node's present size, or its apron is not the one that the frame needs.
    #[error(
        "band {index} of {count} is none of the node's present size for these settings and needs; call resize_banded with them, and record the bands that it returns"
    )]
    Band {
        /// The index of the frame's band.
        index: u32,
        /// The number of bands that it is one of.
        count: u32,
    },
    /// The band is not the next one of the frame.
    #[error("band {index} is recorded where band {next} comes next; record the bands of a frame in order, from 0")]
    BandOrder {
        /// The index of the frame's band.
        index: u32,
        /// The index of the band that comes next.
        next: u32,
    },
    /// A band differs from the first band of its frame in what applies to the whole frame.
    #[error(
        "band {0} has another camera, exposure or settings than band 0; they stay the same in all bands of a frame"
    )]
    BandDiffers(u32),
    /// The target has another format than the descriptor.
    #[error(
        "the target is {target:?}, the node writes {node:?}; build the node with Descriptor::target_format = {target:?}"
    )]
    TargetFormat {
        /// The format of the target.
        target: wgpu::TextureFormat,
        /// The format of the descriptor.
        node: wgpu::TextureFormat,
    },
    /// The target lacks `RENDER_ATTACHMENT`.
    #[error("the target can't be rendered to; create it with TextureUsages::RENDER_ATTACHMENT")]
    TargetUsage,
    /// The target is multisampled.
    #[error("the target has {0} samples a pixel, the node writes one; render into a texture with sample_count = 1")]
    TargetSamples(u32),
    /// Only one of [`Needs::depth`](crate::Needs::depth) and [`Frame::depth`](crate::Frame::depth) is set.
    #[error(
        "{}",
        if *needed {
            "Needs::depth asks for depth, but the frame has no view for it; set Frame::depth"
        } else {
            "Frame::depth has a view, but nothing is written to it; set Needs::depth to say which depth"
        }
    )]
    Depth {
        /// Whether `Needs::depth` is set, and the frame's view is missing.
        needed: bool,
    },
    /// The depth texture has another size than the target, or than the node if the frame has no viewport.
    #[error(
        "the depth texture is {depth_width}×{depth_height}, the target {width}×{height}; \
         create it with the target's size"
    )]
    DepthSize {
        /// The width of the depth texture.
        depth_width: u32,
        /// The height of the depth texture.
        depth_height: u32,
        /// The width that it needs.
        width: u32,
        /// The height that it needs.
        height: u32,
    },
    /// The depth texture has another format than [`DEPTH_FORMAT`](crate::gbuffer::DEPTH_FORMAT).
    #[error(
        "the depth texture is {0:?}, the node writes {format:?}; create it with gbuffer::DEPTH_FORMAT",
        format = crate::gbuffer::DEPTH_FORMAT
    )]
    DepthFormat(wgpu::TextureFormat),
    /// The depth texture is multisampled.
    #[error(
        "the depth texture has {0} samples a pixel, the node writes one; render into a texture with sample_count = 1"
    )]
    DepthSamples(u32),
    /// The depth texture lacks `RENDER_ATTACHMENT`.
    #[error("the depth texture can't be rendered to; create it with TextureUsages::RENDER_ATTACHMENT")]
    DepthUsage,
    /// The node was built with a bind group layout, but the frame has no bind group.
    #[error("the host's WGSL was built with a bind group layout, the frame has no host_bind_group; set it")]
    HostBindGroup,
    /// The node was built with a second bind group layout, but the frame has no second bind group.
    #[error("the host's WGSL was built with a second bind group layout, the frame has no second_bind_group; set it")]
    SecondBindGroup,
    /// The descriptor has a texture tier, but the frame has no texture table.
    #[error(
        "the node was built with a texture tier, the frame has no table; set Frame::textures, an empty table if there are none"
    )]
    Textures,
    /// A list exceeds the device's limits or memory.
    #[error(
        "{} at {width}×{height}, m = {m} lists up to {bytes} bytes: {why}; {}",
        execution.map_or("Selective".into(), |e| format!("{e:?}")),
        if execution.is_some() { "use Execution::Tiled or Loop, which list nothing" } else { "use a smaller size or m" }
    )]
    List {
        /// The execution that builds the list; `None` for the list of
        /// [`Technique::Selective`](crate::Technique::Selective).
        execution: Option<Execution>,
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
        /// The number of samples along one side of a window.
        m: u32,
        /// The bytes of the largest buffer, or of all buffers if memory ran out.
        bytes: u64,
        /// The limit that is exceeded, or the message of the driver.
        why: String,
    },
    /// The frame needs rays, but the node was built without them.
    #[error("the frame asks for rays, the node was built without them; set Descriptor::rays")]
    NoRays,
    /// The frame needs rays, but has no scene to trace them in.
    #[error("the frame asks for rays, but has no scene for them; set Needs::rays")]
    NoRayScene,
    /// The G-buffer is a visibility buffer, but the frame has no scene whose meshes and instances it names.
    #[error(
        "the G-buffer holds triangles, but the frame has no scene for them; set Needs::rays to a RayScene::for_visibility"
    )]
    NoVisibleScene,
    /// The ids of the visibility buffer are too narrow for the scene.
    #[error(
        "{ids:?} can't name {triangles} triangles of a mesh and {instances} instances; use Ids::for_scene with the most that any frame has, or Ids::Wide"
    )]
    Ids {
        /// The ids of the descriptor.
        ids: Ids,
        /// The triangles of the scene's largest mesh.
        triangles: u32,
        /// The instances of the frame.
        instances: u32,
    },
    /// The frame has materials that send rays, but the host's WGSL has no `reflection`.
    #[error(
        "the frame has materials that reflect or refract, but the host's WGSL has no `fn reflection(s: DaaSample) -> DaaReflection`; write it, or leave Needs::reflective empty"
    )]
    NoReflection,
    /// The ray scene was made for another tier than the node.
    #[error(
        "the scene for rays was made for {}, the node for RayTier::{node:?}; make it with the node's tier",
        .scene.map_or("a visibility buffer alone".to_owned(), |tier| format!("RayTier::{tier:?}"))
    )]
    RayTier {
        /// The tier of the scene; `None` if it traces no rays.
        scene: Option<RayTier>,
        /// The tier of the descriptor.
        node: RayTier,
    },
    /// The ray scene was updated for another camera position.
    #[error(
        "the scene for rays was updated for a camera at {scene}, the frame's is at {camera}; call RayScene::update with it"
    )]
    RayCamera {
        /// The camera position that the scene was updated for.
        scene: glam::Vec3,
        /// The camera position of the frame.
        camera: glam::Vec3,
    },
    /// More lights cast shadows than a word has bits.
    #[error("{lights} lights cast shadows; {limit} can, so leave some out of Needs::shadows")]
    CastingLights {
        /// The number of lights in [`Needs::shadows`](crate::Needs::shadows).
        lights: usize,
        /// The most lights that can cast shadows.
        limit: usize,
    },
    /// A light's position or direction is not finite, the direction is 0, or the position is more than 1e12 from the camera.
    #[error("light {0} of Needs::shadows is not finite, has no direction, or is more than 1e12 from the camera")]
    CastingLight(usize),
    /// A material index is beyond the range of the G-buffer.
    #[error("Needs::textured[{index}] is {material}; the G-buffer holds materials below 65536")]
    TexturedMaterial {
        /// The index into the list.
        index: usize,
        /// The material.
        material: u32,
    },
    /// An object id is beyond the range of the G-buffer.
    #[error("Needs::importance[{index}].object is {object}; the table ends at 65535, as the G-buffer's objects do")]
    ImportantObject {
        /// The index into the list.
        index: usize,
        /// The object id.
        object: u32,
    },
    /// An importance is out of range.
    #[error("Needs::importance[{index}].importance is {importance}, it must lie in 0 to 1")]
    Importance {
        /// The index into the list.
        index: usize,
        /// The importance.
        importance: f32,
    },
    /// The ray results exceed the device's limits or memory.
    #[error("rays at {width}×{height}, m = {m} keep {bytes} bytes: {why}; use a smaller size or m, or resize_banded")]
    Traces {
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
        /// The number of samples along one side of a window.
        m: u32,
        /// The bytes of the buffer.
        bytes: u64,
        /// The limit that is exceeded, or the message of the driver.
        why: String,
    },
    /// The cells of the coarsest lattice are larger than the image.
    #[error(
        "multi_resolution.{lattice}.coarsest is {coarsest}: cells of {} pixels don't fit {width}×{height}; {most} does",
        1 << coarsest
    )]
    Coarsest {
        /// The setting: `shading` or `rays`.
        lattice: &'static str,
        /// The value of the setting.
        coarsest: u32,
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
        /// The greatest value that fits.
        most: u32,
    },
    /// A lattice with shifted rows is requested at m = 1.
    #[error(
        "multi_resolution.shading.pattern is {0:?}: its rows are shifted by half a pixel, where a node with m = 1 has no sample; \
         use Pattern::Quad, or a node with a larger m"
    )]
    Shifted(Pattern),
    /// The lattices exceed the device's limits or memory.
    #[error("lattices at {width}×{height} keep {bytes} bytes: {why}; use a smaller size, or resize_banded")]
    Lattices {
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
        /// The bytes of all their buffers.
        bytes: u64,
        /// The limit that one of them exceeds, or the message of the driver.
        why: String,
    },
    /// The surfaces of [`Technique::Surfaces`](crate::Technique::Surfaces) exceed the device's limits or memory.
    #[error(
        "surfaces at {width}×{height}, m = {m} keep {bytes} bytes: {why}; use a smaller size or m, or resize_banded"
    )]
    Surfaces {
        /// The width of the node's output.
        width: u32,
        /// The height of the node's output.
        height: u32,
        /// The node's m.
        m: u32,
        /// The bytes that one or all of their buffers have.
        bytes: u64,
        /// The limit that one of them exceeds, or the message of the driver.
        why: String,
    },
    /// The memory lent for a part is too small for this frame.
    #[error(
        "{part:?} was lent {lent} bytes, this frame needs {needed}; lend at least that many bytes, or withdraw the loan"
    )]
    Lent {
        /// The part.
        part: Part,
        /// The bytes of the lent buffer.
        lent: u64,
        /// The least bytes that the part needs in this frame.
        needed: u64,
    },
    /// A pass lacks what the node should have made for it.
    #[error("the node has not made what the pass '{0}' runs on; this is a defect of deferred-aa, please report it")]
    Unmade(&'static str),
    /// The pass is not part of this frame.
    #[error(
        "the pass '{0}' is not part of this frame; record DeferredAa::passes of the frame's own settings and needs"
    )]
    ForeignPass(&'static str),
    /// The driver or wgpu refused a pipeline.
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
    /// The textures fall into more classes than the array tier has arrays, or have more samplers than the binding tier
    /// has.
    #[error(
        "the textures fall into {classes} classes of size, format, mip count and sampler, the array tier has {most}; \
         resize some to a common size, or use the binding tier"
    )]
    Classes {
        /// The number of classes, or of samplers.
        classes: usize,
        /// The most that the tier has.
        most: usize,
    },
    /// There are more textures than the table holds.
    #[error("{textures} textures, the table holds {most}; raise Descriptor::texture_capacity")]
    Capacity {
        /// The number of textures.
        textures: usize,
        /// The most textures that the table holds.
        most: usize,
    },
    /// A texture can't be used in the table.
    #[error("texture {index} {problem}")]
    Texture {
        /// The index into the list.
        index: usize,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The node has no texture tier.
    #[error("the node was built without a texture tier; set Descriptor::textures")]
    NoTier,
}

/// An error in the host's WGSL, at a position in its own file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadingError {
    /// The file name, as given in [`Shading::file`](crate::Shading::file).
    pub file: String,
    /// The line, from 1; 0 if the error concerns the whole file.
    pub line: u32,
    /// The column in characters, from 1; 0 if the error concerns the whole file.
    pub column: u32,
    /// What is wrong.
    pub kind: ShadingErrorKind,
}

/// What is wrong with the host's WGSL.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShadingErrorKind {
    /// The source does not parse, or has a wrong name or type.
    #[error("{0}")]
    Wgsl(String),
    /// The source has no shading function.
    #[error(
        "no shading function; write `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` \
         and `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`"
    )]
    NoHook,
    /// The source has only one of `material` and `light`.
    #[error("`{have}` without `{missing}`; write both, or one `fn shade(s: DaaSample) -> vec4f`")]
    HalfHook {
        /// The function that is there.
        have: &'static str,
        /// The function that is missing.
        missing: &'static str,
    },
    /// The source has `shade` as well as `material` or `light`.
    #[error("both `shade` and `material` or `light`; keep one way of shading, rename the other")]
    TwoHooks,
    /// A function that the crate calls has the wrong signature.
    #[error("`{name}` must be `{expected}`")]
    Signature {
        /// The name of the function.
        name: &'static str,
        /// The signature that it must have.
        expected: &'static str,
    },
    /// The source declares a name that is reserved for the crate.
    #[error("`{0}` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it")]
    ReservedName(String),
    /// The source redeclares a built-in of WGSL that the crate's own code uses.
    #[error("`{0}` is a built-in of WGSL that deferred-aa's own code uses; rename this one")]
    Clash(String),
    /// The source binds a variable outside the host's groups.
    #[error(
        "`{name}` is bound to @group({group}); the host has @group({HOST_GROUP}), and with TextureTier::None also @group({SECOND_HOST_GROUP}): bind it there"
    )]
    Group {
        /// The name of the variable.
        name: String,
        /// The group of the variable.
        group: u32,
    },
    /// The source reads an attribute that the G-buffer does not keep.
    #[error("`{0}` is not kept in the G-buffer; set it in the Channels of Descriptor::gbuffer, or don't read it")]
    Channel(&'static str),
    /// The source takes a derivative or samples with implicit gradients, which compute shaders can't.
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
