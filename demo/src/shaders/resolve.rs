//! A shader with its constants filled in and validated for the language that it is to be written in.

use super::error::{ShadersError, causes};
use super::request::Request;
use deferred_aa::rays::RayTier;
use deferred_aa::{Shader, TextureTier};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// A shader whose constants are filled in, with nothing in it but what its entry point reaches.
pub struct Resolved<'a> {
    pub shader: &'a Shader,
    pub module: naga::Module,
    pub info: ModuleInfo,
    pub file: String,
}

pub fn resolve<'a>(request: &Request<'_>, shader: &'a Shader, variants: usize) -> Result<Resolved<'a>, ShadersError> {
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
pub fn language(request: &Request<'_>, shader: &Shader, said: String) -> ShadersError {
    let cure = match said.as_str() {
        m if m.contains("RAY_QUERY") && request.rays == RayTier::Query => "; use --rays software",
        m if m.contains("BINDING_ARRAY") && request.textures == TextureTier::Bindings => "; use --textures arrays",
        _ => "",
    };
    ShadersError::Language { shader: shader.entry.clone(), lang: request.lang, message: said + cure }
}
