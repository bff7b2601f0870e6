//! Mip chains of 8-bit pictures, averaged in linear light.

/// One level: 4 bytes a texel, rows packed.
#[derive(Debug, Clone)]
pub struct Level {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// RGBA.
    pub rgba: Vec<u8>,
}

/// Levels from the picture itself to 1 × 1, each a box filter of the one before. `srgb`: colour is decoded first; alpha
/// and data textures are averaged as they are.
pub fn chain(width: u32, height: u32, rgba: &[u8], srgb: bool) -> Vec<Level> {
    let mut levels = vec![Level { width, height, rgba: rgba.to_vec() }];
    let mut texels: Vec<[f32; 4]> = rgba.as_chunks::<4>().0.iter().map(|&t| decode(t, srgb)).collect();
    let (mut w, mut h) = (width, height);
    while w > 1 || h > 1 {
        texels = halve(&texels, w, h);
        (w, h) = ((w / 2).max(1), (h / 2).max(1));
        let rgba = texels.iter().flat_map(|&t| encode(t, srgb)).collect();
        levels.push(Level { width: w, height: h, rgba });
    }
    levels
}

/// Resamples to another size by the area that each texel covers; enlarging is linear.
pub fn resize(width: u32, height: u32, rgba: &[u8], srgb: bool, to: (u32, u32)) -> Vec<u8> {
    let texels: Vec<[f32; 4]> = rgba.as_chunks::<4>().0.iter().map(|&t| decode(t, srgb)).collect();
    let picture = image::Rgba32FImage::from_raw(width, height, texels.into_flattened()).unwrap_or_default();
    let resized = image::imageops::resize(&picture, to.0, to.1, image::imageops::FilterType::Triangle);
    resized.pixels().flat_map(|p| encode(p.0, srgb)).collect()
}

/// Enlarges by repeating texels.
pub fn enlarge(width: u32, height: u32, rgba: &[u8], to: (u32, u32)) -> Vec<u8> {
    let texels = rgba.as_chunks::<4>().0;
    // The texel over which the centre of the new one lies.
    let under = |i: u32, from: u32, to: u32| ((u64::from(i) * 2 + 1) * u64::from(from) / (u64::from(to) * 2)) as usize;
    let row = |y| {
        let row = under(y, height, to.1) * width as usize;
        (0..to.0).flat_map(move |x| texels[row + under(x, width, to.0)])
    };
    (0..to.1).flat_map(row).collect()
}

/// What may stand on the right of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Beside {
    /// The picture once more.
    Copy,
    /// Its left and right exchanged.
    MirrorImage,
}

/// The picture with another on its right.
pub fn twice(width: u32, rgba: &[u8], beside: Beside) -> Vec<u8> {
    let rows = rgba.as_chunks::<4>().0.chunks(width.max(1) as usize);
    let row = |row: &[[u8; 4]]| {
        let mut both = [row, row].concat();
        if beside == Beside::MirrorImage {
            both[row.len()..].reverse();
        }
        both
    };
    rows.flat_map(row).flatten().collect()
}

/// A box over the two texels of an even side, the three of an odd one (weighted by their share), so that nothing
/// drifts.
fn halve(texels: &[[f32; 4]], w: u32, h: u32) -> Vec<[f32; 4]> {
    let taps = |i: u32, side: u32| -> Vec<(usize, f32)> {
        let half = (side / 2).max(1);
        let (from, to) = (i as f32 * side as f32 / half as f32, (i + 1) as f32 * side as f32 / half as f32);
        let covered = |t: u32| (to.min(t as f32 + 1.0) - from.max(t as f32)) / (to - from);
        (from as u32..(to.ceil() as u32).min(side)).map(|t| (t as usize, covered(t))).collect()
    };
    let columns: Vec<_> = (0..(w / 2).max(1)).map(|x| taps(x, w)).collect();
    let mut out = Vec::with_capacity(columns.len() * (h / 2).max(1) as usize);
    for y in 0..(h / 2).max(1) {
        let rows = taps(y, h);
        for column in &columns {
            let mut sum = [0.0; 4];
            for &(ty, wy) in &rows {
                for &(tx, wx) in column {
                    let t = texels[ty * w as usize + tx];
                    for c in 0..4 {
                        sum[c] += t[c] * wx * wy;
                    }
                }
            }
            out.push(sum);
        }
    }
    out
}

fn decode(texel: [u8; 4], srgb: bool) -> [f32; 4] {
    static LINEAR: std::sync::LazyLock<[f32; 256]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|i| {
            let c = i as f32 / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    });
    let [r, g, b, a] = texel.map(|c| f32::from(c) / 255.0);
    if srgb {
        let l = |c: u8| LINEAR[usize::from(c)];
        [l(texel[0]), l(texel[1]), l(texel[2]), a]
    } else {
        [r, g, b, a]
    }
}

fn encode(texel: [f32; 4], srgb: bool) -> [u8; 4] {
    // 4096 steps of a curve are within half a unit of 8 bits everywhere but in the darkest three codes.
    static CURVE: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| {
        (0..=4096)
            .map(|i| {
                let c = i as f32 / 4096.0;
                let e = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
                (e * 255.0 + 0.5) as u8
            })
            .collect()
    });
    let plain = |c: f32| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let curved = |c: f32| if srgb { CURVE[(c.clamp(0.0, 1.0) * 4096.0 + 0.5) as usize] } else { plain(c) };
    [curved(texel[0]), curved(texel[1]), curved(texel[2]), plain(texel[3])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_ends_at_one_texel_and_keeps_the_mean() {
        let rgba: Vec<u8> = (0..5 * 3).flat_map(|i| [i as u8 * 10, 0, 255, 255]).collect();
        let levels = chain(5, 3, &rgba, false);
        assert_eq!(levels.iter().map(|l| (l.width, l.height)).collect::<Vec<_>>(), [(5, 3), (2, 1), (1, 1)]);
        assert_eq!(levels[2].rgba, [70, 0, 255, 255]);
    }

    #[test]
    fn pictures_are_repeated_texel_by_texel_and_whole() {
        let rgba: Vec<u8> = [1, 2, 3].into_iter().flat_map(|i| [i; 4]).collect();
        let reds = |rgba: Vec<u8>| rgba.into_iter().step_by(4).collect::<Vec<_>>();
        assert_eq!(reds(enlarge(3, 1, &rgba, (7, 1))), [1, 1, 2, 2, 2, 3, 3]);
        assert_eq!(reds(enlarge(1, 3, &rgba, (2, 4))), [1, 1, 2, 2, 2, 2, 3, 3]);
        assert_eq!(reds(twice(3, &rgba, Beside::Copy)), [1, 2, 3, 1, 2, 3]);
        assert_eq!(reds(twice(3, &rgba, Beside::MirrorImage)), [1, 2, 3, 3, 2, 1]);
    }

    #[test]
    fn black_and_white_average_in_linear_light() {
        let levels = chain(2, 1, &[0, 0, 0, 255, 255, 255, 255, 255], true);
        assert_eq!(levels[1].rgba, [188, 188, 188, 255]);
    }
}
