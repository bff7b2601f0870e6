//! The node's shaders for hosts that are not on wgpu: in other languages, with a table of what they bind.
//!
//! No adapter is needed: the node is built on wgpu's backend that draws nothing.

mod bindings;
mod host;
mod table;
mod translate;

use crate::host::gpu::{Gpu, GpuError};
use bindings::Slots;
use deferred_aa::rays::RayTier;
use deferred_aa::{
    BuildError, DeferredAa, Descriptor, Needs, PassInfo, RecordError, Settings, Shader, Shading, TextureTier, gbuffer,
};
use naga::ShaderStage;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

pub use table::Table;
pub use translate::Lang;

/// What to write.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// In which language.
    pub lang: Lang,
    /// Samples along one side of a window, 1 to 8: a constant in all that is written.
    pub m: u32,
    /// Of the frames.
    pub settings: &'a Settings,
    /// How `daa_texture` reaches textures.
    pub textures: TextureTier,
    /// Who traces rays, where the settings have effects on.
    pub rays: RayTier,
    /// The host's WGSL.
    pub shading: Shading<'a>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// Name and content of each file.
    pub files: Vec<(String, Vec<u8>)>,
    /// The passes, and what their shaders bind.
    pub table: Table,
}

/// Shaders could not be had.
#[derive(Debug, thiserror::Error)]
pub enum ShadersError {
    /// No device of the backend that draws nothing.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The node could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Such a frame can't be.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A constant of the host's has no value, or the like.
    #[error("{shader}: {message}")]
    Shader {
        /// The entry point.
        shader: String,
        /// What naga said.
        message: String,
    },
    /// A language has no words for something.
    #[error("{shader}: {lang} can't say this: {message}")]
    Language {
        /// The entry point.
        shader: String,
        /// Which.
        lang: Lang,
        /// What naga said, and what helps.
        message: String,
    },
}

/// A shader whose constants are filled in, with nothing in it but what its entry point reaches.
struct Resolved<'a> {
    shader: &'a Shader,
    module: naga::Module,
    info: ModuleInfo,
    file: String,
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

/// The shaders of all passes of frames with these settings, translated.
pub fn export(request: &Request<'_>) -> Result<Export, ShadersError> {
    let mut passes = collect(request)?;
    passes.insert(0, (PassInfo { name: "pack", reads: &[], writes: &[deferred_aa::Resource::GBuffer] }, vec![pack()]));

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

fn collect(request: &Request<'_>) -> Result<Vec<(PassInfo, Vec<Shader>)>, ShadersError> {
    let descriptor = Descriptor {
        m: request.m,
        textures: request.textures,
        texture_capacity: if request.textures == TextureTier::Bindings { crate::host::TEXTURE_CAPACITY } else { 0 },
        rays: Some(request.rays),
        ..Descriptor::new(crate::host::TARGET_FORMAT, request.shading)
    };
    let gpu = Gpu::drawing_nothing(&descriptor)?;
    let layout = host::layout(&gpu.device, request.shading, request.textures).map_err(BuildError::from)?;
    let aa = DeferredAa::new(&gpu.device, &descriptor, layout.as_ref())?;
    Ok(aa.shaders(request.settings, &Needs::default())?)
}

fn pack() -> Shader {
    Shader {
        pass: "pack",
        entry: "daa_pack_main".to_owned(),
        stage: ShaderStage::Fragment,
        source: [gbuffer::PACK_WGSL, PACK_MAIN].join("\n"),
        constants: Vec::new(),
        zero_initialize_workgroup_memory: false,
    }
}

fn resolve<'a>(request: &Request<'_>, shader: &'a Shader, variants: usize) -> Result<Resolved<'a>, ShadersError> {
    let failed = |e: &dyn std::error::Error| ShadersError::Shader { shader: shader.entry.clone(), message: causes(e) };
    let module = naga::front::wgsl::parse_str(&shader.source).map_err(|e| failed(&e))?;
    let validator = |capabilities| Validator::new(ValidationFlags::all(), capabilities);
    let info = validator(Capabilities::all()).validate(&module).map_err(|e| failed(e.as_inner()))?;
    let constants = shader.constants.iter().map(|(name, value)| (name.clone(), *value)).collect();
    let entry = Some((shader.stage, shader.entry.as_str()));
    let resolved = naga::back::pipeline_constants::process_overrides(&module, &info, entry, &constants);
    let mut module = resolved.map_err(|e| failed(&e))?.0.into_owned();
    // It leaves the overrides behind, though nothing asks for them any more.
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = validator(request.lang.capabilities())
        .validate(&module)
        .map_err(|e| language(request, shader, causes(e.as_inner())))?;
    let variant = if variants == 0 { String::new() } else { format!("_{}", variants + 1) };
    let file = format!("{}{variant}.{}", shader.entry, request.lang.extension());
    Ok(Resolved { shader, module, info, file })
}

/// What a language lacks, and what helps if it is a tier that asks for it.
fn language(request: &Request<'_>, shader: &Shader, said: String) -> ShadersError {
    let cure = match said.as_str() {
        m if m.contains("RAY_QUERY") && request.rays == RayTier::Query => "; use --rays software",
        m if m.contains("BINDING_ARRAY") && request.textures == TextureTier::Bindings => "; use --textures arrays",
        _ => "",
    };
    ShadersError::Language { shader: shader.entry.clone(), lang: request.lang, message: said + cure }
}

/// An error and what is behind it, in one line.
fn causes(error: &dyn std::error::Error) -> String {
    let chain = std::iter::successors(Some(error), |e| e.source());
    chain.map(|e| e.to_string().split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>().join(": ")
}

#[cfg(test)]
mod tests;
