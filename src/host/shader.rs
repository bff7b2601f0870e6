//! What a pass's shaders are made of: for a host that is not on wgpu, and compiles them by itself.

/// A shader of a pass: WGSL, joined with the host's where that runs in it.
///
/// Group 0 is the frame's (constants, G-buffer, what was traced), 1 the texture table's, [`HOST_GROUP`](crate::HOST_GROUP) the
/// host's, 3 the pass's own. Each binding's name and type stand in the source.
#[derive(Debug, Clone, PartialEq)]
pub struct Shader {
    /// [`PassInfo::name`](crate::PassInfo::name) of the pass.
    pub pass: &'static str,
    /// The entry point.
    pub entry: String,
    /// Its stage: compute, or vertex and fragment of a triangle that covers the target.
    pub stage: naga::ShaderStage,
    /// WGSL, whole: what other entry points need may be in it too.
    pub source: String,
    /// Values of its `override` constants.
    pub constants: Vec<(String, f64)>,
    /// Whether it counts on workgroup memory that begins as 0.
    pub zero_initialize_workgroup_memory: bool,
}
