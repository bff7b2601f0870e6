//! What a node will need, before anything is created.

use crate::gpu::sizes::{gbuffer_bytes, sample_bytes, scratch_bytes};
use crate::host::descriptor::Descriptor;
use crate::host::table::{BINDING_FEATURES, MAX_SAMPLERS, TextureTier};
use crate::rays::{QUERY_FEATURES, RayTier, query_limits};

/// What [`DeferredAa::new`](crate::DeferredAa::new) will ask of a device, and what this adapter can't give.
#[derive(Debug, Clone)]
pub struct Requirements {
    /// The tier of the descriptor.
    pub tier: TextureTier,
    /// Request these from the adapter; those it lacks are left out.
    pub features: wgpu::Features,
    /// Request at least these.
    pub limits: wgpu::Limits,
    /// What the node can't do without and the adapter lacks. Empty: the node can be built.
    pub missing: Vec<String>,
    /// What works less well here, a line each.
    pub lost: Vec<String>,
    m: u32,
    rays: bool,
}

/// Bytes of GPU memory at one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// The attachments that the host renders into.
    pub gbuffer: u64,
    /// All else that the node holds, but for the list of an execution that makes one: on its first frame it adds about 4
    /// bytes a pixel for [`Sorted`](crate::Execution::Sorted) and [`Bucketed`](crate::Execution::Bucketed), and but for 72 KiB of
    /// [`Selective`](crate::Technique::Selective), and for [`MultiResolution`](crate::Technique::MultiResolution) about 43 bytes a pixel,
    /// 85 with rays; 75 and 150 with shifted rows.
    pub scratch: u64,
    /// What rays find, once a frame traced: 4 bytes a sample for shadows, and 4 for what it reflects and refracts, with 24 more a
    /// pixel for [`Selective`](crate::Technique::Selective). The scene for rays is the host's: [`RayScene::bytes`](crate::rays::RayScene::bytes).
    pub rays: u64,
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
        if descriptor.textures == TextureTier::Arrays && has.contains(BINDING_FEATURES) {
            lost.push("textures are copied into arrays: TextureTier::Bindings would read them in place".to_owned());
        }
        Self {
            tier: descriptor.textures,
            features: (needed | wanted) & has,
            limits,
            missing,
            lost,
            m: descriptor.m,
            rays: descriptor.rays.is_some(),
        }
    }

    /// Bytes that [`resize`](crate::DeferredAa::resize) to this size will allocate, without padding.
    pub fn memory(&self, width: u32, height: u32) -> Memory {
        Memory {
            gbuffer: gbuffer_bytes([width, height], self.m),
            scratch: scratch_bytes([width, height]),
            rays: if self.rays { 2 * sample_bytes([width, height], self.m) } else { 0 },
        }
    }
}

/// Needed, and used where it is there.
fn features(descriptor: &Descriptor<'_>) -> (wgpu::Features, wgpu::Features) {
    let mut needed = match descriptor.textures {
        TextureTier::Bindings => BINDING_FEATURES,
        _ => wgpu::Features::empty(),
    };
    if descriptor.rays == Some(RayTier::Query) {
        needed |= QUERY_FEATURES;
    }
    (needed, wgpu::Features::TIMESTAMP_QUERY)
}

fn limits(descriptor: &Descriptor<'_>) -> wgpu::Limits {
    let mut limits = wgpu::Limits::default();
    if descriptor.textures == TextureTier::Bindings {
        // wgpu counts the samplers' places among all elements too.
        limits.max_binding_array_elements_per_shader_stage =
            descriptor.texture_capacity.saturating_add(MAX_SAMPLERS as u32);
        limits.max_binding_array_sampler_elements_per_shader_stage = MAX_SAMPLERS as u32;
    }
    if descriptor.rays.is_some() {
        // Of `trace`: its own, the table's and the host's.
        limits.max_storage_buffers_per_shader_stage = 12;
    }
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

/// What the device lacks for the descriptor.
pub(crate) fn missing(device: &wgpu::Device, descriptor: &Descriptor<'_>) -> Vec<String> {
    let (needed, _) = features(descriptor);
    let mut missing: Vec<String> =
        (needed - device.features()).iter_names().map(|(name, _)| format!("feature {name}")).collect();
    missing.extend(missing_limits(&limits(descriptor), &device.limits()));
    missing
}
