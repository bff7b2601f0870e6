//! Twin of `shaders/shared/triangle.wgsl`: the attributes of a point of a triangle.

/// The host's 32 bits where the vertices have these weights. Where the vertices differ, each of the four bytes is
/// interpolated.
pub fn user(of: [u32; 3], weights: [f64; 3]) -> u32 {
    if of[0] == of[1] && of[0] == of[2] {
        return of[0];
    }
    u32::from_le_bytes(bytes(of, weights).map(|byte| (byte.clamp(0.0, 255.0) + 0.5).floor() as u8))
}

/// Whether rounding in f32 could not have changed a byte of [`user`].
pub fn is_user_sure(of: [u32; 3], weights: [f64; 3]) -> bool {
    let clear = |byte: f64| ((byte - byte.floor()) - 0.5).abs() > 2e-3;
    of[0] == of[1] && of[0] == of[2] || bytes(of, weights).into_iter().all(clear)
}

/// The bytes before they are rounded.
fn bytes(of: [u32; 3], weights: [f64; 3]) -> [f64; 4] {
    let of = of.map(u32::to_le_bytes);
    [0, 1, 2, 3].map(|i| (0..3).map(|v| f64::from(of[v][i]) * weights[v]).sum())
}
