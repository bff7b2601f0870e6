//! The node's shaders for hosts that are not on wgpu: in other languages, with a table of what they bind.
//!
//! No adapter is needed: the node is built on wgpu's backend that draws nothing.

mod bindings;
mod error;
mod host;
mod lang;
mod request;
mod resolve;
mod table;
mod translate;

use crate::host::gpu::Gpu;
use bindings::Slots;
use deferred_aa::{BuildError, DeferredAa, Descriptor, GBufferTier, Needs, PassInfo, Shader, TextureTier};
use naga::ShaderStage;
use resolve::{Resolved, language, resolve};

pub use error::ShadersError;
pub use lang::Lang;
pub use request::Request;
pub use table::Table;

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// Name and content of each file.
    pub files: Vec<(String, Vec<u8>)>,
    /// The passes, and what their shaders bind.
    pub table: Table,
}

/// A raster shader that packs: an example for the host's own, which is not the node's.
const PACK_MAIN: &str = "
@fragment
fn daa_pack_main(
    @location(0) normal: vec3f,
    @location(1) geometric_normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec2f,
    @location(4) @interpolate(flat) material: u32,
    @location(5) @interpolate(flat) object: u32,
    @location(6) @interpolate(flat) user: u32,
) -> DaaGBuffer {
    return daa_pack(DaaFragment(normal, material, geometric_normal, object, tangent, uv, dpdx(uv), dpdy(uv), user));
}
";

/// The same for a visibility buffer.
const PACK_IDS_MAIN: &str = "
@fragment
fn daa_pack_main(@location(0) @interpolate(flat) instance: u32, @location(1) @interpolate(flat) triangle: u32) -> DaaGBuffer {
    return daa_pack(instance, triangle);
}
";

/// The shaders of all passes of frames with these settings, translated.
pub fn export(request: &Request<'_>) -> Result<Export, ShadersError> {
    let mut passes = collect(request)?;
    passes.insert(0, (None, vec![pack(request.gbuffer)]));

    let mut resolved: Vec<Resolved<'_>> = Vec::new();
    let mut uses = Vec::new();
    for (pass, shaders) in &passes {
        let mut indices = Vec::new();
        for shader in shaders {
            // Passes may run the same shader, over something else.
            let same = |r: &Resolved<'_>| (&r.shader.entry, &r.shader.constants, &r.shader.source) == key(shader);
            let index = match resolved.iter().position(same) {
                Some(index) => index,
                None => {
                    let variants = resolved.iter().filter(|r| r.shader.entry == shader.entry).count();
                    resolved.push(resolve(request, shader, variants)?);
                    resolved.len() - 1
                }
            };
            indices.push(index);
        }
        uses.push((*pass, indices));
    }

    let slots = Slots::new(resolved.iter().map(|r| &r.module));
    let mut files = Vec::new();
    let mut entries = Vec::new();
    for one in &resolved {
        let (bytes, entry) = translate::translate(request.lang, one, &slots)
            .map_err(|message| language(request, one.shader, message))?;
        files.push((one.file.clone(), bytes));
        entries.push(entry);
    }
    let table = Table::new(request, &uses, &resolved, &entries, &slots);
    Ok(Export { files, table })
}

fn key(shader: &Shader) -> (&String, &Vec<(String, f64)>, &String) {
    (&shader.entry, &shader.constants, &shader.source)
}

/// A pass and its shaders; of the host's own only the shaders.
type Shaders = (Option<PassInfo>, Vec<Shader>);

fn collect(request: &Request<'_>) -> Result<Vec<Shaders>, ShadersError> {
    let descriptor = Descriptor {
        m: request.m,
        textures: request.textures,
        texture_capacity: if request.textures == TextureTier::Bindings { crate::host::TEXTURE_CAPACITY } else { 0 },
        rays: Some(request.rays),
        gbuffer: request.gbuffer,
        ..Descriptor::new(crate::host::TARGET_FORMAT, request.shading)
    };
    let gpu = Gpu::drawing_nothing(&descriptor)?;
    let layout = host::layout(&gpu.device, request.shading, request.textures).map_err(BuildError::from)?;
    let aa = DeferredAa::new(&gpu.device, &descriptor, layout.as_ref())?;
    let passes = aa.shaders(request.settings, &Needs { depth: request.depth, ..Default::default() })?;
    Ok(passes.into_iter().map(|(info, shaders)| (Some(info), shaders)).collect())
}

fn pack(tier: GBufferTier) -> Shader {
    let main = match tier {
        GBufferTier::Stored(_) => PACK_MAIN,
        GBufferTier::Visibility(_) => PACK_IDS_MAIN,
    };
    Shader {
        pass: "pack",
        entry: "daa_pack_main".to_owned(),
        stage: ShaderStage::Fragment,
        source: [&tier.pack_wgsl(), main].join("\n"),
        constants: Vec::new(),
        zero_initialize_workgroup_memory: false,
    }
}

#[cfg(test)]
mod tests;
