//! The composition of shaders from the crate's chunks of WGSL, the host's source, and a pass. Pipelines, the exporter
//! and the tests all use [`source`].

use crate::host::gbuffer::{GBufferTier, Ids};
use crate::host::needs::RayInputs;
use crate::rays::RayTier;
use crate::wgsl::{HostSource, chunk};

/// The shader of one or several passes.
#[derive(Debug)]
pub(crate) struct Module {
    pub name: &'static str,
    pub base: Base,
    /// Its own chunks, in order, after those of its base.
    pub chunks: &'static [&'static str],
}

/// The base of a module: the chunks that it shares with others. Each variant includes those before it, except
/// [`Casting`](Self::Casting).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Base {
    /// The frame's constants and the G-buffer.
    GBuffer,
    /// Also the ray results.
    Found,
    /// Also the host's source, which shades samples.
    Shading,
    /// Also the host's functions for materials and light, called apart.
    Lighting,
    /// A scene for rays. `shades`: with the host's source; else with it only if that says where materials are solid.
    Casting { shades: bool },
}

impl Base {
    /// Whether the module may read the host's group and the texture table.
    pub fn has_host(self) -> bool {
        matches!(self, Self::Shading | Self::Lighting | Self::Casting { .. })
    }
}

/// What the same modules are composed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Tiers {
    pub gbuffer: GBufferTier,
    pub rays: RayTier,
}

/// The whole text of a module, for samples with these ray results.
pub(crate) fn source(module: &Module, host: &HostSource, inputs: RayInputs, tiers: Tiers) -> String {
    let text = match module.base {
        Base::GBuffer => frame(tiers.gbuffer, RayInputs::default()),
        Base::Found => frame(tiers.gbuffer, inputs),
        Base::Shading => shading(host, tiers.gbuffer, inputs),
        Base::Lighting => {
            let mut chunks = shading(host, tiers.gbuffer, inputs);
            chunks.extend(host.split_calls());
            chunks
        }
        Base::Casting { shades } => casting(host, tiers, shades),
    };
    text.into_iter().chain(module.chunks.iter().copied()).flat_map(|chunk| [chunk, "\n"]).collect()
}

/// Whether a module has the host's source, so that its group and the texture table must be bound.
pub(crate) fn binds_host(base: Base, host: &HostSource) -> bool {
    match base {
        Base::GBuffer | Base::Found => false,
        Base::Shading | Base::Lighting => true,
        Base::Casting { shades } => shades || host.solid,
    }
}

fn frame(gbuffer: GBufferTier, inputs: RayInputs) -> Vec<&'static str> {
    let mut chunks = vec![chunk::CONTRACT];
    chunks.extend(samples(gbuffer, inputs));
    chunks.push(chunk::STATISTICS);
    chunks
}

/// The chunks that read samples.
fn samples(gbuffer: GBufferTier, inputs: RayInputs) -> Vec<&'static str> {
    let mut chunks =
        vec![chunk::OCTAHEDRAL, chunk::USER, chunk::TRIANGLE, chunk::FRAME, chunk::PLAN_WORD, chunk::SAMPLE];
    match gbuffer {
        GBufferTier::Stored(channels) => chunks.extend([
            match channels.frame() {
                [true, true] => chunk::STORED_FRAME,
                [true, false] => chunk::STORED_FRAME_NORMALS,
                [false, true] => chunk::STORED_FRAME_USER,
                [false, false] => chunk::STORED_FRAME_NONE,
            },
            if channels.uv { chunk::STORED_UV } else { chunk::STORED_UV_NONE },
            chunk::STORED,
        ]),
        GBufferTier::Visibility(Ids::Wide) => chunks.extend([chunk::IDS_WIDE, chunk::VISIBILITY]),
        GBufferTier::Visibility(Ids::Narrow { .. }) => chunks.extend([chunk::IDS_NARROW, chunk::VISIBILITY]),
    }
    chunks.extend([
        chunk::SHARED_EXPONENT,
        if inputs.shadows { chunk::SHADOWS } else { chunk::SHADOWS_NONE },
        if inputs.reflections { chunk::REFLECTIONS } else { chunk::REFLECTIONS_NONE },
    ]);
    chunks
}

/// The host's source, the contract, and the chunks that read, shade and average samples.
fn shading(host: &HostSource, gbuffer: GBufferTier, inputs: RayInputs) -> Vec<&str> {
    let mut chunks = vec![host.directives(), &host.source, chunk::CONTRACT, host.table_chunk()];
    chunks.extend(samples(gbuffer, inputs));
    chunks.extend([chunk::MEAN, chunk::STATISTICS]);
    chunks.extend(host.calls());
    chunks.push(chunk::EVALUATE);
    chunks
}

fn casting(host: &HostSource, tiers: Tiers, shades: bool) -> Vec<&str> {
    let (directive, structure, traversal) = match tiers.rays {
        RayTier::Software => ("", "", chunk::RAYS_SOFTWARE),
        RayTier::Query => (
            "enable wgpu_ray_query;",
            "@group(3) @binding(0) var daa_ray_tlas: acceleration_structure;",
            chunk::RAYS_QUERY,
        ),
    };
    let mut chunks = vec![directive];
    if binds_host(Base::Casting { shades }, host) {
        chunks.extend([host.directives(), &host.source, chunk::CONTRACT, host.table_chunk()]);
    } else {
        chunks.push(chunk::CONTRACT);
    }
    chunks.extend(samples(tiers.gbuffer, RayInputs::default()));
    chunks.extend([chunk::MEAN, chunk::STATISTICS]);
    if shades {
        chunks.extend(host.calls());
        chunks.push("fn daa_call_reflection(s: DaaSample) -> DaaReflection { return reflection(s); }");
    }
    chunks.extend([
        structure,
        host.solid_call(),
        chunk::RAYS,
        traversal,
        chunk::LATTICE,
        chunk::LISTING,
        chunk::CASTING,
    ]);
    chunks
}
