//! The shaders of a pass, for a host that does not use wgpu and compiles them itself.

/// A shader of a pass as WGSL, joined with the host's WGSL where the pass runs it.
///
/// Group 0 has the frame's constants, the G-buffer and the ray results, group 1 the texture table,
/// [`HOST_GROUP`](crate::HOST_GROUP) the host's bindings, and group 3 the pass's own. The source declares the name and
/// type of each binding.
#[derive(Debug, Clone, PartialEq)]
pub struct Shader {
    /// The [`PassInfo::name`](crate::PassInfo::name) of the pass.
    pub pass: &'static str,
    /// The name of the entry point.
    pub entry: String,
    /// The shader stage: compute, or vertex and fragment for a pass that draws a triangle over the target or the
    /// depth texture.
    pub stage: naga::ShaderStage,
    /// The whole WGSL module. It may also contain what other entry points need.
    pub source: String,
    /// The values of its `override` constants.
    pub constants: Vec<(String, f64)>,
    /// Whether the shader relies on workgroup memory that is initialised to 0.
    pub zero_initialize_workgroup_memory: bool,
}
