//! Twin of `shaders/passes/plan.wgsl`.

use crate::TILE;

/// The plan of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Planned {
    /// The number of samples, 1 to n; 0 outside the image.
    pub k: u32,
    /// The number of the tile's samples before this window's.
    pub before: u32,
}

/// The plan of an image, tile by tile with the pixels of a tile in reading order, and the number of tiles that fell
/// back to k = 1.
pub fn plan(counts: &[u32], width: u32, height: u32, tile_limit: u32) -> (Vec<Planned>, u32) {
    let mut planned = Vec::new();
    let mut overflowed = 0;
    for tile_y in 0..height.div_ceil(TILE) {
        for tile_x in 0..width.div_ceil(TILE) {
            let mut tile = Vec::with_capacity((TILE * TILE) as usize);
            let mut before = 0;
            for i in 0..TILE * TILE {
                let (x, y) = (tile_x * TILE + i % TILE, tile_y * TILE + i / TILE);
                let k = if x < width && y < height { counts[(y * width + x) as usize] } else { 0 };
                tile.push(Planned { k, before });
                before += k.saturating_sub(1);
            }
            if before > tile_limit {
                overflowed += 1;
                for p in &mut tile {
                    *p = Planned { k: p.k.min(1), before: 0 };
                }
            }
            planned.append(&mut tile);
        }
    }
    (planned, overflowed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_end_to_end_and_overflow_falls_back() {
        let counts: Vec<u32> = (0..9 * 3).map(|i| 1 + i % 4).collect();
        let (plan, overflowed) = plan(&counts, 9, 3, 36);
        assert_eq!(plan.len(), 2 * 64);
        // The first tile wants 8 · 3 pixels of 0, 1, 2, 3 more: 36, no more than the limit.
        assert_eq!(plan[23], Planned { k: counts[2 * 9 + 7], before: 36 + 1 - counts[2 * 9 + 7] });
        assert_eq!(overflowed, 0);
        let (plan, overflowed) = super::plan(&counts, 9, 3, 35);
        assert_eq!(overflowed, 1);
        assert!(plan[..24].iter().all(|p| *p == Planned { k: 1, before: 0 }));
        assert_eq!(plan[64].k, counts[8]);
    }
}
