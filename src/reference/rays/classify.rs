//! Twin of `shaders/rays/classify.wgsl`.

use crate::TILE;

/// The indices of the tiles with a surface, and of those with a surface whose material sends rays, each in ascending
/// order. `depth` and `surface` are the depth and the first colour target, rows from the top, of `size` pixels with
/// windows of m × m.
pub fn classify(
    depth: &[f32],
    surface: &[[u32; 2]],
    size: [u32; 2],
    m: u32,
    sends_rays: impl Fn(u32) -> bool,
) -> [Vec<u32>; 2] {
    let [tiles_x, tiles_y] = size.map(|side| side.div_ceil(TILE));
    let [width, height] = size.map(|side| side * m);
    let mut found = vec![[false; 2]; (tiles_x * tiles_y) as usize];
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let at = (y * width + x) as usize;
        if depth[at] > 1e-30 {
            let [with_surface, reflective] = &mut found[(y / m / TILE * tiles_x + x / m / TILE) as usize];
            *with_surface = true;
            *reflective |= sends_rays(surface[at][1] & 0xffff);
        }
    }
    [0, 1].map(|class| (0..).zip(&found).filter(|(_, of)| of[class]).map(|(tile, _)| tile).collect())
}
