//! One sample a surface, weighted by the surface's exact share of the window.

use super::{check, grid};
use crate::host::{Host, octahedral};
use crate::measure::quality::{self, QualityError};
use crate::picture::Picture;
use deferred_aa::window;
use glam::{DMat3, DMat4, DVec2, DVec3};

/// Surfaces of a window; what comes after joins the nearest.
const MOST_SURFACES: usize = 4;
/// Normals of one surface are within 18°: their cosine is above.
const LEAST_COSINE: f64 = 0.95;
/// Samples of one surface are off the plane of its first by less than this share of the depth.
const MOST_STEP: f64 = 0.01;
/// Depths below are the sky.
const SKY_DEPTH: f32 = 1e-30;

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
/// `samples` is the host of m = 1 at m times the picture's size whose last frame was `Full` by `camera`. A window's
/// samples, in the order of their ranks, join the first surface of the same material and object whose first sample has
/// a normal within 18° and a plane within 1 % of the depth, else begin one, up to four. A surface has the colour of its
/// sample nearest to its centroid: with a sample's own texture footprint, where a technique of its kind would take the
/// surface's.
pub fn exact_coverage(samples: &Host, camera: &deferred_aa::Camera, m: u32) -> Result<Coverage, QualityError> {
    let colors = samples.picture();
    let geometry = Geometry::new(&colors, &samples.surfaces(), &samples.depths(), camera);
    let (shaded, picture) = reconstruct(&colors, &geometry, m)?;
    let psnr_db = quality::psnr(&picture, &grid(&colors, m)?)?;
    Ok(Coverage { ratio: shaded as f64 / colors.rgba.len() as f64, psnr_db })
}

/// A sample of the G-buffer, in view space.
#[derive(Debug, Clone, Copy)]
struct Sample {
    position: DVec3,
    normal: DVec3,
    /// Material and object; `None` is the sky.
    identity: Option<u32>,
}

impl Sample {
    /// Whether `other` lies on the surface that this sample began.
    fn same_surface(&self, other: &Self) -> bool {
        if self.identity.is_none() || other.identity.is_none() {
            return self.identity == other.identity;
        }
        let step = (other.position - self.position).dot(self.normal).abs();
        self.identity == other.identity
            && self.normal.dot(other.normal) > LEAST_COSINE
            && step < MOST_STEP * self.position.z.abs()
    }
}

#[derive(Debug)]
struct Geometry(Vec<Sample>);

impl Geometry {
    /// `surfaces` and `depths` have an entry a pixel of `colors`; what is missing is sky.
    fn new(colors: &Picture, surfaces: &[[u32; 2]], depths: &[f32], camera: &deferred_aa::Camera) -> Self {
        let view_from_clip: DMat4 = camera.clip_from_view.as_dmat4().inverse();
        let view_from_world = DMat3::from_mat4(camera.world_from_view.as_dmat4()).transpose();
        let size = DVec2::new(f64::from(colors.width), f64::from(colors.height));
        let sample = |i: usize| {
            let ([normal, identity], depth) = match (surfaces.get(i), depths.get(i)) {
                (Some(&surface), Some(&depth)) if depth > SKY_DEPTH => (surface, depth),
                _ => return Sample { position: DVec3::ZERO, normal: DVec3::ZERO, identity: None },
            };
            let width = colors.width as usize;
            let at = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5) / size;
            let ndc = DVec3::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, f64::from(depth));
            let position = view_from_clip.project_point3(ndc);
            let normal = view_from_world * octahedral(normal).as_dvec3();
            Sample { position, normal, identity: Some(identity) }
        };
        Self((0..colors.rgba.len()).map(sample).collect())
    }
}

/// How many samples are shaded, and the picture made of them.
fn reconstruct(colors: &Picture, geometry: &Geometry, m: u32) -> Result<(usize, Picture), QualityError> {
    check(colors, m)?;
    let (width, height) = (colors.width / m, colors.height / m);
    let order = window::order(m);
    let mut shaded = 0;
    let mut rgba = Vec::with_capacity((width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            let index = |&(i, j): &(u8, u8)| {
                (y * m + u32::from(j)) as usize * colors.width as usize + (x * m + u32::from(i)) as usize
            };
            let samples: Vec<Sample> = order.iter().map(|place| geometry.0[index(place)]).collect();
            let surfaces = surfaces(&samples);
            shaded += surfaces.len();
            let mut sum = [0.0; 4];
            for ranks in &surfaces {
                let weight = ranks.len() as f64 / order.len() as f64;
                let color = colors.rgba[index(&order[central(ranks, &order)])];
                sum.iter_mut().zip(color).for_each(|(s, c)| *s += weight * f64::from(c));
            }
            rgba.push(sum.map(|s| s as f32));
        }
    }
    Ok((shaded, Picture { width, height, rgba }))
}

/// The ranks of each surface's samples, ascending.
fn surfaces(samples: &[Sample]) -> Vec<Vec<usize>> {
    let mut surfaces: Vec<Vec<usize>> = Vec::new();
    for (rank, sample) in samples.iter().enumerate() {
        let found = surfaces.iter().position(|ranks| samples[ranks[0]].same_surface(sample));
        match found {
            Some(i) => surfaces[i].push(rank),
            None if surfaces.len() < MOST_SURFACES => surfaces.push(vec![rank]),
            None => {
                let apart = |ranks: &Vec<usize>| {
                    let first = &samples[ranks[0]];
                    // One of the same object before any other, however near.
                    (first.identity != sample.identity, first.position.distance_squared(sample.position))
                };
                let nearest = surfaces.iter_mut().min_by(|a, b| {
                    let ((other_a, a), (other_b, b)) = (apart(a), apart(b));
                    other_a.cmp(&other_b).then(a.total_cmp(&b))
                });
                nearest.into_iter().for_each(|ranks| ranks.push(rank));
            }
        }
    }
    surfaces
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
    use super::*;

    const WALL: Sample = Sample { position: DVec3::new(0.0, 0.0, -10.0), normal: DVec3::Z, identity: Some(1) };
    const SKY: Sample = Sample { position: DVec3::ZERO, normal: DVec3::ZERO, identity: None };

    #[test]
    fn samples_are_where_the_camera_saw_them() {
        use crate::host::raster::{look_at, node_camera};
        use glam::Vec3;
        // A view along −x, 90° high, whose right is −z. A depth of near/z is z ahead.
        let camera = look_at(Vec3::new(5.0, 1.0, 2.0), Vec3::new(0.0, 1.0, 2.0), std::f32::consts::FRAC_PI_2, 0.5);
        let camera = node_camera(&camera, 4, 2);
        let colors = Picture::new(4, 2, vec![[0.0; 4]; 8]).unwrap();
        // Octahedral code 0 is +z.
        let mut depths = [0.05; 8];
        depths[3] = 0.0;
        let found = Geometry::new(&colors, &[[0, 7]; 8], &depths, &camera).0;
        assert!(found[3].identity.is_none() && found[2].identity == Some(7));
        // Ten ahead the view is 20 high and 40 wide: pixels of 10.
        let top_left = DVec3::new(-15.0, 5.0, -10.0);
        assert!((found[0].position - top_left).length() < 1e-4, "{:?}", found[0]);
        assert!((found[6].position - DVec3::new(5.0, -5.0, -10.0)).length() < 1e-4, "{:?}", found[6]);
        assert!((found[0].normal - DVec3::NEG_X).length() < 1e-4, "{:?}", found[0]);
    }

    #[test]
    fn what_parts_surfaces() {
        let tilted = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let at = |x, z| DVec3::new(x, 0.0, z);
        for (other, same) in [
            (WALL, true),
            (Sample { position: at(50.0, -10.0), ..WALL }, true),
            (Sample { position: at(0.0, -10.09), ..WALL }, true),
            (Sample { position: at(0.0, -10.11), ..WALL }, false),
            (Sample { normal: tilted(17.0), ..WALL }, true),
            (Sample { normal: tilted(19.0), ..WALL }, false),
            (Sample { identity: Some(2), ..WALL }, false),
            (SKY, false),
        ] {
            assert_eq!(WALL.same_surface(&other), same, "{other:?}");
        }
        assert!(SKY.same_surface(&SKY) && !SKY.same_surface(&WALL));
    }

    #[test]
    fn surfaces_in_the_order_of_ranks_and_no_more_than_four() {
        let of = |identity| Sample { identity: Some(identity), ..WALL };
        assert_eq!(surfaces(&[of(1), SKY, of(1), of(2), SKY]), [vec![0, 2], vec![1, 4], vec![3]]);
        // A fifth surface joins the nearest, a second piece of an object its first.
        let near = Sample { position: DVec3::new(0.0, 0.0, -20.0), ..of(3) };
        let fifth = Sample { position: DVec3::new(0.0, 0.0, -19.0), ..of(5) };
        let turned = Sample { normal: DVec3::X, position: near.position, ..of(4) };
        let found = surfaces(&[of(1), of(2), near, of(4), fifth, turned]);
        assert_eq!(found, [vec![0], vec![1], vec![2, 4], vec![3, 5]]);
    }

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
        let object = |i: usize| Sample { identity: Some(u32::from(i.is_multiple_of(4) || i == 7)), ..WALL };
        let (shaded, picture) = reconstruct(&colors, &Geometry((0..16).map(object).collect()), 4).unwrap();
        assert_eq!(shaded, 2);
        assert_eq!(picture, grid(&colors, 4).unwrap());
        assert_eq!(picture.rgba[0][1], (5.0 * 2.0 + 11.0 * 0.5) / 16.0);
        // Were all one surface, one of the colours would be lost.
        let (shaded, picture) = reconstruct(&colors, &Geometry(vec![WALL; 16]), 4).unwrap();
        assert_eq!((shaded, picture.rgba[0]), (1, [0.0, 0.5, 0.25, 1.0]));
    }
}
