//! Twin of `shaders/surfaces/cover.wgsl`: the surfaces of a window.

use crate::host::plan::DecidedBy as By;
use crate::settings::Surfaces;
use glam::DVec3;

/// What a sample shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Seen {
    /// The sky.
    Sky,
    /// A surface.
    Surface {
        /// Position relative to the camera.
        position: DVec3,
        /// Unit interpolated normal.
        normal: DVec3,
        /// material | object << 16.
        identity: u32,
        /// The ids in a visibility buffer; `None` in a stored one.
        triangle: Option<[u32; 2]>,
    },
}

/// The surfaces of a window.
#[derive(Debug, Clone, PartialEq)]
pub struct Covered {
    /// The surface of each sample, by rank.
    pub labels: Vec<u8>,
    /// The number of surfaces.
    pub surfaces: u8,
    /// Whether samples were merged into the last surface although they do not belong to it.
    pub merged: bool,
    /// How near the nearest comparison came to its threshold: the difference of cosines, or of distances over the
    /// distance to the camera. GPU and twin may differ if rounding exceeds it.
    pub margin: f64,
}

/// Gathers the samples of a window, by rank, into surfaces. `forward` is the view direction of the camera.
pub fn cover(window: &[Seen], forward: DVec3, settings: &Surfaces) -> Covered {
    let mut labels = vec![u8::MAX; window.len()];
    let (mut surfaces, mut merged, mut margin) = (0, false, f64::INFINITY);
    while let Some(first) = labels.iter().position(|&label| label == u8::MAX) {
        let mut same = of_triangle(window, &labels, first);
        let mut others: Vec<usize> =
            (0..window.len()).filter(|rank| labels[*rank] == u8::MAX && !same.contains(rank)).collect();
        while let Some(&rank) = others.first() {
            let ranks: Vec<usize> =
                of_triangle(window, &labels, rank).into_iter().filter(|rank| others.contains(rank)).collect();
            let (is_same, near) = is_same_surface(&window[first], &window[rank], forward, settings);
            margin = margin.min(near);
            others.retain(|rank| !ranks.contains(rank));
            if is_same {
                same.extend(ranks);
            }
        }
        if u32::from(surfaces) + 1 == settings.surfaces {
            let left = labels.iter().filter(|&&label| label == u8::MAX).count();
            merged = same.len() < left;
            same = (0..window.len()).filter(|&rank| labels[rank] == u8::MAX).collect();
        }
        same.into_iter().for_each(|rank| labels[rank] = surfaces);
        surfaces += 1;
    }
    Covered { labels, surfaces, merged, margin }
}

/// The samples without a label that are known to show the triangle of this one, itself included.
fn of_triangle(window: &[Seen], labels: &[u8], rank: usize) -> Vec<usize> {
    let is_same = |other: usize| match (&window[rank], &window[other]) {
        (Seen::Surface { triangle: Some(a), .. }, Seen::Surface { triangle: Some(b), .. }) => a == b,
        _ => other == rank,
    };
    (0..window.len()).filter(|&other| labels[other] == u8::MAX && is_same(other)).collect()
}

/// Whether `b` lies on the surface of `a`, and the distance to the threshold that decides it.
fn is_same_surface(a: &Seen, b: &Seen, forward: DVec3, settings: &Surfaces) -> (bool, f64) {
    let (
        &Seen::Surface { position: p, normal: n, identity: i, .. },
        &Seen::Surface { position: q, normal: o, identity: j, .. },
    ) = (a, b)
    else {
        return (a == b, f64::INFINITY);
    };
    if i != j {
        return (false, f64::INFINITY);
    }
    let distance = p.dot(forward).abs();
    let off = n.dot(q - p).abs() / distance;
    let (plane, cosine) = (f64::from(settings.plane), f64::from(settings.normal_cosine));
    let margin = (off - plane).abs().min((n.dot(o) - cosine).abs());
    (off <= plane && n.dot(o) >= cosine, margin)
}

/// What the rays around a window have found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    /// Whether `probe` has found an edge of a shadow in the window or in one of its eight neighbours.
    pub shadow_edge: bool,
    /// The greatest difference of a channel between what the window's first sample reflects, exposed and as c/(1+c), and
    /// what those of its eight neighbours do.
    pub contrast: f64,
}

/// The samples of a window that cast rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rays {
    /// How many.
    pub k: usize,
    /// Why: [`By::Identity`] with several surfaces, [`By::Shadow`] near an edge of one, [`By::Luminance`] where only what is
    /// reflected differs, so that the first sample's shadow bits hold for all.
    pub by: By,
    /// How near the contrast came to a threshold.
    pub margin: f64,
}

/// How many samples of a window of several surfaces cast rays: all up to the last that is read. Of a host that shades
/// samples as a whole, any may be read.
pub fn tapped(labels: &[u8], settings: &Surfaces, whole_hook: bool) -> usize {
    let (n, taps) = (labels.len(), settings.taps as usize);
    if whole_hook || taps >= n.min(Surfaces::MOST_TAPS as usize) {
        return n;
    }
    let last = |label: u8| (0..n).filter(|&rank| labels[rank] == label).take(taps).last();
    labels.iter().filter_map(|&label| last(label)).max().map_or(0, |rank| rank + 1)
}

/// How many of a window's samples cast rays. `tapped` do where there are several surfaces.
pub fn rays(n: usize, surfaces: u8, tapped: usize, around: &Around) -> Rays {
    const SEEN: f64 = 0.02;
    if surfaces > 1 {
        return Rays { k: tapped, by: By::Identity, margin: f64::INFINITY };
    }
    if around.shadow_edge {
        return Rays { k: n, by: By::Shadow, margin: f64::INFINITY };
    }
    let margin = (around.contrast - SEEN).abs().min((around.contrast - 0.25 * SEEN).abs());
    match around.contrast {
        contrast if contrast > SEEN => Rays { k: n, by: By::Luminance, margin },
        contrast if contrast > 0.25 * SEEN => Rays { k: n.min(4), by: By::Luminance, margin },
        _ => Rays { k: 1, by: By::Nothing, margin },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(x: f64, depth: f64, normal: DVec3, identity: u32) -> Seen {
        Seen::Surface { position: DVec3::new(x, 0.0, -depth), normal, identity, triangle: None }
    }

    #[test]
    fn known_answers() {
        let (a, b) = (seen(0.0, 10.0, DVec3::Z, 1), seen(0.1, 10.0, DVec3::Z, 1));
        let settings = Surfaces::default();
        let labels = |window: &[Seen]| {
            let covered = cover(window, -DVec3::Z, &settings);
            assert_eq!(covered.surfaces, covered.labels.iter().max().unwrap() + 1);
            covered.labels
        };
        assert_eq!(labels(&[a, b, a, b]), [0, 0, 0, 0]);
        assert_eq!(labels(&[a, Seen::Sky, b, Seen::Sky]), [0, 1, 0, 1]);
        // Another object, a plane behind, and a fold.
        assert_eq!(labels(&[a, seen(0.1, 10.0, DVec3::Z, 2)]), [0, 1]);
        assert_eq!(labels(&[a, seen(0.1, 10.2, DVec3::Z, 1)]), [0, 1]);
        assert_eq!(labels(&[a, seen(0.1, 10.05, DVec3::Z, 1)]), [0, 0]);
        assert_eq!(labels(&[a, seen(0.1, 10.0, DVec3::new(0.4, 0.0, 1.0).normalize(), 1)]), [0, 1]);
        // The seventh and eighth surface join the sixth.
        let many: Vec<_> = (0..8).map(|i| seen(0.0, 10.0, DVec3::Z, i)).collect();
        assert_eq!(labels(&many), [0, 1, 2, 3, 4, 5, 5, 5]);
        assert!(cover(&many, -DVec3::Z, &settings).merged && !cover(&many[..6], -DVec3::Z, &settings).merged);
        // NaN is a surface of its own.
        let nan = seen(f64::NAN, 10.0, DVec3::Z, 1);
        assert_eq!(labels(&[a, nan, b]), [0, 1, 0]);
    }

    #[test]
    fn the_samples_of_a_triangle_stay_together() {
        let on = |triangle, normal| Seen::Surface {
            position: DVec3::new(0.0, 0.0, -10.0),
            normal,
            identity: 1,
            triangle: Some([1, triangle]),
        };
        let bent = DVec3::new(1.0, 0.0, 1.0).normalize();
        let covered =
            cover(&[on(0, DVec3::Z), on(1, DVec3::Z), on(0, bent), on(1, bent)], -DVec3::Z, &Surfaces::default());
        assert_eq!(covered.labels, [0, 0, 0, 0]);
    }
}
