//! How much a file may hold, and how messages call what is in it.

/// Meshes drawn, counting every copy.
pub const MAX_INSTANCES: usize = 1 << 20;

/// Larger pictures are refused, as most GPUs would.
pub const MAX_SIDE: u32 = 16384;

/// How messages call a thing of the file: "material 3 'glass'".
pub fn label(kind: &str, number: usize, name: Option<&str>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {number} '{}'", name.escape_debug()),
        _ => format!("{kind} {number}"),
    }
}
