//! The requirements of a node, known before anything is created.

use crate::gpu::bands::{Layout, MOST_SAMPLES};
use crate::gpu::buffers::{MARKS_BYTES, NodeBuffers};
use crate::gpu::shape::{Kind, shape};
use crate::gpu::step::used_parts;
use crate::host::descriptor::Descriptor;
use crate::host::gbuffer::GBufferTier;
use crate::host::graph::{Part, Resource};
use crate::host::needs::{Needs, RayInputs};
use crate::host::table::{BINDING_FEATURES, MAX_SAMPLERS, TextureTier};
use crate::rays::{QUERY_FEATURES, RayTier, query_limits};
use crate::settings::Settings;
use crate::techniques;
use crate::window::MAX_M;

/// What [`DeferredAa::new`](crate::DeferredAa::new) requires of a device, and what this adapter lacks.
#[derive(Debug, Clone)]
pub struct Requirements {
    /// The texture tier of the descriptor.
    pub tier: TextureTier,
    /// The features to request of the adapter. Those that it lacks are left out.
    pub features: wgpu::Features,
    /// The limits to request, or higher ones.
    pub limits: wgpu::Limits,
    /// Required features, limits and capabilities that the adapter lacks. Empty: the node can be built.
    pub missing: Vec<String>,
    /// Optional capabilities that the adapter lacks, with their consequences, a line each.
    pub lost: Vec<String>,
    kind: Kind,
}

/// The GPU memory of a node in bytes, without what the driver adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// The attachments that the host renders into.
    pub gbuffer: u64,
    /// The remaining memory of the node, without rays: two images, the counts and the plan, and what some frames need
    /// besides, which the first of them creates:
    /// - the list of [`Sorted`](crate::Execution::Sorted) and [`Bucketed`](crate::Execution::Bucketed), about 4 bytes a
    ///   pixel;
    /// - the list of [`Packed`](crate::Execution::Packed), 20 bytes for each sample that could be shaded;
    /// - 72 KiB for [`Selective`](crate::Technique::Selective);
    /// - the lattices of [`MultiResolution`](crate::Technique::MultiResolution), about 43 bytes a pixel, 85 with rays,
    ///   and with shifted rows 75 and 150;
    /// - the surfaces of [`Surfaces`](crate::Technique::Surfaces), 24 bytes a pixel, 36 if m is above 5.
    pub scratch: u64,
    /// The results of rays, created by the first frame that traces: 4 bytes a sample for shadows and 4 for reflections
    /// and refractions, for all samples that the technique traces or, where a plan chooses them, for as many as
    /// [`Settings::ray_samples`] says; and 24 more a pixel for [`Selective`](crate::Technique::Selective). The scene
    /// that is traced belongs to the host, see [`RayScene::bytes`](crate::rays::RayScene::bytes).
    pub rays: u64,
}

impl Memory {
    /// Adds up the bytes of parts.
    pub(crate) fn of(parts: impl Iterator<Item = (Part, u64)>) -> Self {
        let mut memory = Self { gbuffer: 0, scratch: 0, rays: 0 };
        for (part, bytes) in parts {
            match part.resource() {
                Resource::GBuffer => memory.gbuffer += bytes,
                Resource::Tiles | Resource::Traced => memory.rays += bytes,
                // These are the host's.
                Resource::Target | Resource::Depth => {}
                _ => memory.scratch += bytes,
            }
        }
        memory
    }
}

impl Requirements {
    pub(crate) fn of(adapter: &wgpu::Adapter, descriptor: &Descriptor<'_>) -> Self {
        let (needed, wanted) = features(descriptor);
        let has = adapter.features();
        let mut limits = limits(descriptor);
        if descriptor.rays == Some(RayTier::Query) {
            limits = query_limits(limits, &adapter.limits());
        }
        let mut missing: Vec<String> = (needed - has).iter_names().map(|(name, _)| format!("feature {name}")).collect();
        missing.extend(missing_limits(&limits, &adapter.limits()));
        missing.extend(missing_backend(adapter.get_info().backend));
        let flags = adapter.get_downlevel_capabilities().flags;
        let compute = wgpu::DownlevelFlags::COMPUTE_SHADERS | wgpu::DownlevelFlags::INDIRECT_EXECUTION;
        missing.extend((compute - flags).iter_names().map(|(name, _)| format!("downlevel flag {name}")));
        let usages = adapter.get_texture_format_features(descriptor.target_format).allowed_usages;
        if !usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
            missing.push(format!("rendering to {:?}", descriptor.target_format));
        }
        let mut lost = Vec::new();
        if !has.contains(wgpu::Features::TIMESTAMP_QUERY) {
            lost.push("no timestamps: statistics have no times".to_owned());
        }
        if !flags.contains(wgpu::DownlevelFlags::ANISOTROPIC_FILTERING) {
            lost.push("no anisotropic filtering: textures blur at grazing angles".to_owned());
        }
        if descriptor.gbuffer.ids().is_some() && !has.contains(wgpu::Features::PRIMITIVE_INDEX) {
            lost.push(
                "no primitive index: a visibility buffer needs another way to tell triangles apart, such as vertex pulling"
                    .to_owned(),
            );
        }
        if descriptor.textures == TextureTier::Arrays && has.contains(BINDING_FEATURES) {
            lost.push("textures are copied into arrays: TextureTier::Bindings would read them in place".to_owned());
        }
        Self {
            tier: descriptor.textures,
            features: (needed | wanted) & has,
            limits,
            missing,
            lost,
            // `new` refuses other m.
            kind: Kind {
                m: descriptor.m.clamp(1, MAX_M),
                target_format: descriptor.target_format,
                gbuffer: descriptor.gbuffer,
            },
        }
    }

    /// The memory that the node will hold at this size once it has recorded a frame with these settings and needs:
    /// [`DeferredAa::memory`](crate::DeferredAa::memory) then. Frames with other settings or needs may add to it. Sides
    /// of more than 65535 samples, which no node takes, count as that many.
    pub fn memory(&self, width: u32, height: u32, settings: &Settings, needs: &Needs<'_>) -> Memory {
        let inputs = RayInputs::of(settings, needs);
        let size = [width, height].map(|side| side.min(MOST_SAMPLES / self.kind.m));
        let layout = Layout { image: size, size };
        let shape = shape(self.kind, layout, settings, inputs);
        let used = used_parts(&techniques::steps(settings, inputs));
        let memory = Memory::of(shape.held(&used));
        let marks = if techniques::of(settings.technique).reads_marks() { MARKS_BYTES } else { 0 };
        let rays = if inputs.any() { NodeBuffers::rays_bytes() } else { 0 };
        Memory { scratch: memory.scratch + marks, rays: memory.rays + rays, ..memory }
    }
}

/// The required features, and those that are used where the adapter has them.
fn features(descriptor: &Descriptor<'_>) -> (wgpu::Features, wgpu::Features) {
    let mut needed = match descriptor.textures {
        TextureTier::Bindings => BINDING_FEATURES,
        _ => wgpu::Features::empty(),
    };
    if descriptor.rays == Some(RayTier::Query) {
        needed |= QUERY_FEATURES;
    }
    let wanted = match descriptor.gbuffer {
        GBufferTier::Visibility(_) => wgpu::Features::PRIMITIVE_INDEX,
        GBufferTier::Stored(_) => wgpu::Features::empty(),
    };
    (needed, wgpu::Features::TIMESTAMP_QUERY | wanted)
}

fn limits(descriptor: &Descriptor<'_>) -> wgpu::Limits {
    let mut limits = wgpu::Limits::default();
    if descriptor.textures == TextureTier::Bindings {
        // wgpu counts samplers among all elements, too.
        limits.max_binding_array_elements_per_shader_stage =
            descriptor.texture_capacity.saturating_add(MAX_SAMPLERS as u32);
        limits.max_binding_array_sampler_elements_per_shader_stage = MAX_SAMPLERS as u32;
    }
    // `reflect` binds this many: its own, the table's and two of the host's. A visibility buffer has the meshes and the
    // instances besides, with which the passes without rays exceed the default of 8, too.
    limits.max_storage_buffers_per_shader_stage = match (descriptor.rays, descriptor.gbuffer) {
        (Some(_), GBufferTier::Visibility(_)) => 12,
        (None, GBufferTier::Visibility(_)) => 10,
        (Some(_), GBufferTier::Stored(_)) => 10,
        (None, GBufferTier::Stored(_)) => limits.max_storage_buffers_per_shader_stage,
    };
    if descriptor.rays == Some(RayTier::Query) {
        limits.max_acceleration_structures_per_shader_stage = 1;
    }
    limits
}

fn missing_limits(needed: &wgpu::Limits, has: &wgpu::Limits) -> Vec<String> {
    let mut missing = Vec::new();
    needed.check_limits_with_fail_fn(has, false, |name, wanted, allowed| {
        missing.push(format!("limit {name} = {wanted} (it has {allowed})"));
    });
    missing
}

/// wgpu's GL backend meets the limits on some machines, but takes an array texture of one layer for a plain one, which
/// the texture table then reads as black (wgpu-hal, `gles`: "view dimension heuristics").
fn missing_backend(backend: wgpu::Backend) -> Option<String> {
    (backend == wgpu::Backend::Gl)
        .then(|| "a backend other than GL, which reads array textures of one layer wrongly".into())
}

/// The backend, features and limits of the descriptor that the device lacks.
pub(crate) fn missing(device: &wgpu::Device, descriptor: &Descriptor<'_>) -> Vec<String> {
    let (needed, _) = features(descriptor);
    let mut missing: Vec<String> =
        (needed - device.features()).iter_names().map(|(name, _)| format!("feature {name}")).collect();
    missing.extend(missing_limits(&limits(descriptor), &device.limits()));
    missing.extend(missing_backend(device.adapter_info().backend));
    missing
}
