//! Twin of `shaders/shared/triangle.wgsl`: the attributes of a point of a triangle.

/// The host's 32 bits where the vertices have these weights. Where the vertices differ, each of the four bytes is
/// interpolated.
pub fn user(of: [u32; 3], weights: [f64; 3]) -> u32 {
    if of[0] == of[1] && of[0] == of[2] {
        return of[0];
    }
    let bytes = of.map(u32::to_le_bytes);
    let byte = |i: usize| (0..3).map(|v| f64::from(bytes[v][i]) * weights[v]).sum::<f64>();
    u32::from_le_bytes([0, 1, 2, 3].map(|i| (byte(i).clamp(0.0, 255.0) + 0.5).floor() as u8))
}
