//! Rust and WGSL hold the same structs.

#[path = "../../../src/gpu/layouts/compare.rs"]
#[allow(dead_code, reason = "the library's tests use the rest")]
mod compare;

use crate::host::raster::source;
use crate::host::raster::{Instance, View};
use crate::host::upload::{GpuLight, GpuMaterial, Vertex};
use crate::host::{Lighting, SHADING_WGSL};
use compare::{parse, rust_layout, wgsl_layout};
use deferred_aa::{CONTRACT_WGSL, DeferredAa, GBufferTier, TextureTier};
use wgpu::naga;

fn shading(tier: TextureTier) -> naga::Module {
    let (directives, table) = DeferredAa::texture_wgsl(tier);
    parse(&[directives, SHADING_WGSL, CONTRACT_WGSL, table].join("\n"))
}

/// Joined as [`Raster`](crate::host::raster::Raster) joins it.
fn raster(tier: TextureTier) -> naga::Module {
    parse(&source(tier, GBufferTier::default()))
}

/// What blended surfaces are drawn with.
fn blend(tier: TextureTier) -> naga::Module {
    parse(&crate::host::blend::source(tier))
}

const TIERS: [TextureTier; 2] = [TextureTier::Arrays, TextureTier::Bindings];

#[test]
fn materials_are_the_shaders() {
    let material = rust_layout!(GpuMaterial {
        base_color,
        emissive,
        metallic,
        roughness,
        normal_scale,
        occlusion_strength,
        alpha_cutoff,
        textures,
        unlit,
        transmission,
        ior,
        readings,
        transforms,
        texels,
    });
    for tier in TIERS {
        assert_eq!(wgsl_layout(&shading(tier), "Material"), material);
        assert_eq!(wgsl_layout(&raster(tier), "Material"), material);
        assert_eq!(wgsl_layout(&blend(tier), "Material"), material);
    }
}

#[test]
fn lights_are_the_shaders() {
    let light = rust_layout!(GpuLight {
        position,
        inverse_range,
        intensity,
        kind,
        direction,
        spot_scale,
        spot_offset,
        casts,
        padding,
    });
    let lighting =
        rust_layout!(Lighting { to_sun, light_count, sun, stall, zenith, horizon, ground, camera, sun_casts });
    for tier in TIERS {
        assert_eq!(wgsl_layout(&shading(tier), "Light"), light);
        assert_eq!(wgsl_layout(&shading(tier), "Lighting"), lighting);
        assert_eq!(wgsl_layout(&blend(tier), "Lighting"), lighting);
    }
}

#[test]
fn raster_buffers_are_the_shaders() {
    let view = rust_layout!(View { clip_from_relative, orthographic });
    let instance = rust_layout!(Instance { rows, material, object, handedness, padding });
    for tier in TIERS {
        for module in [raster(tier), blend(tier)] {
            assert_eq!(wgsl_layout(&module, "View"), view);
            assert_eq!(wgsl_layout(&module, "Instance"), instance);
        }
    }
}

/// Vertices have no layout of their own in WGSL: each location is the field of the same name.
#[test]
fn vertices_are_the_shaders() {
    let (fields, _) = rust_layout!(Vertex { position, normal, tangent, uv, color });
    let module = raster(TextureTier::Arrays);
    let (members, _) = wgsl_layout(&module, "Vertex");
    let names = |layout: &[(String, u32, u32)]| layout.iter().map(|m| m.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&members), names(&fields));
    for ((_, offset, size), (location, attribute)) in fields.iter().zip((0..).zip(Vertex::ATTRIBUTES)) {
        assert_eq!(attribute.shader_location, location);
        assert_eq!(attribute.offset, u64::from(*offset));
        assert_eq!(attribute.format.size(), u64::from(*size));
    }
}
