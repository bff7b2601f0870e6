//! One sample a surface, weighted by the surface's exact share of the window.

use super::grid;
use super::surfaces::Geometry;
use crate::host::Host;
use crate::measure::quality::{self, QualityError};
use crate::picture::Picture;
use deferred_aa::window;
use glam::DVec2;

/// What one sample a surface would give.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Coverage {
    /// Surfaces over n · w · h.
    pub ratio: f64,
    /// Against the mean of all n samples, as [`quality::psnr`].
    pub psnr_db: f64,
}

/// One sample a surface with exact coverage, against all samples.
///
/// `samples` is the host of m = 1 at m times the picture's size whose last frame was `Full` by `camera`. A surface has
/// the colour of its sample nearest to its centroid: with a sample's own texture footprint, where a technique of its
/// kind would take the surface's.
pub fn exact_coverage(samples: &Host, camera: &deferred_aa::Camera, m: u32) -> Result<Coverage, QualityError> {
    let colors = samples.picture();
    let geometry = Geometry::seen(samples, &colors, camera);
    let (shaded, picture) = reconstruct(&colors, &geometry, m)?;
    let psnr_db = quality::psnr(&picture, &grid(&colors, m)?)?;
    Ok(Coverage { ratio: shaded as f64 / colors.rgba.len() as f64, psnr_db })
}

/// How many samples are shaded, and the picture made of them.
fn reconstruct(colors: &Picture, geometry: &Geometry, m: u32) -> Result<(usize, Picture), QualityError> {
    let windows = geometry.windows(colors, m)?;
    let order = window::order(m);
    let mut shaded = 0;
    let mut rgba = Vec::with_capacity(colors.rgba.len() / order.len());
    for window in windows {
        shaded += window.surfaces.len();
        let mut sum = [0.0; 4];
        for ranks in &window.surfaces {
            let weight = ranks.len() as f64 / order.len() as f64;
            let color = colors.rgba[window.pixels[central(ranks, &order)]];
            sum.iter_mut().zip(color).for_each(|(s, c)| *s += weight * f64::from(c));
        }
        rgba.push(sum.map(|s| s as f32));
    }
    Ok((shaded, Picture { width: colors.width / m, height: colors.height / m, rgba }))
}

/// Of a surface's samples, the rank of the one nearest to their centroid; the first of equals.
fn central(ranks: &[usize], order: &[(u8, u8)]) -> usize {
    let place = |rank: usize| DVec2::new(f64::from(order[rank].0), f64::from(order[rank].1));
    let centroid = ranks.iter().map(|&r| place(r)).sum::<DVec2>() / ranks.len() as f64;
    let apart = |rank: usize| place(rank).distance_squared(centroid);
    ranks.iter().copied().min_by(|&a, &b| apart(a).total_cmp(&apart(b))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::super::surfaces::tests::of_objects;
    use super::*;

    #[test]
    fn the_sample_nearest_to_the_centroid_stands_for_its_surface() {
        let order: Vec<_> = (0..9).map(|i| (i % 3, i / 3)).collect();
        assert_eq!(central(&[0, 1, 2, 3, 4, 5, 6, 7, 8], &order), 4);
        assert_eq!(central(&[0, 1, 2], &order), 1);
        assert_eq!(central(&[8], &order), 8);
    }

    #[test]
    fn two_flat_colours_come_out_exact() {
        // A 4 × 4 window, five samples of which are another object: two samples make what sixteen do.
        let colors =
            |i: usize| if i.is_multiple_of(4) || i == 7 { [1.0, 2.0, 3.0, 1.0] } else { [0.0, 0.5, 0.25, 1.0] };
        let colors = Picture::new(4, 4, (0..16).map(colors).collect()).unwrap();
        let objects = of_objects(16, |i| u32::from(i.is_multiple_of(4) || i == 7));
        let (shaded, picture) = reconstruct(&colors, &objects, 4).unwrap();
        assert_eq!(shaded, 2);
        assert_eq!(picture, grid(&colors, 4).unwrap());
        assert_eq!(picture.rgba[0][1], (5.0 * 2.0 + 11.0 * 0.5) / 16.0);
        // Were all one surface, one of the colours would be lost.
        let (shaded, picture) = reconstruct(&colors, &of_objects(16, |_| 0), 4).unwrap();
        assert_eq!((shaded, picture.rgba[0]), (1, [0.0, 0.5, 0.25, 1.0]));
    }

    #[test]
    fn broken_input_is_refused() {
        let colors = Picture::new(4, 4, vec![[0.0; 4]; 16]).unwrap();
        for m in [0, 3, 9] {
            assert!(
                matches!(reconstruct(&colors, &of_objects(16, |_| 0), m), Err(QualityError::Windows { .. })),
                "{m}"
            );
        }
    }
}
