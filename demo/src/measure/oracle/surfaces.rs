//! The surfaces of each window.
//!
//! A window's samples, in the order of their ranks, join the first surface of the same material and object whose first
//! sample has a normal within 18° and a plane within 1 % of the depth, else begin one, up to four.

use super::check;
use crate::host::{Host, octahedral};
use crate::measure::quality::QualityError;
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

/// The samples of all windows, an entry a pixel of the picture of them.
#[derive(Debug)]
pub struct Geometry(Vec<Sample>);

/// A window's samples.
#[derive(Debug)]
pub struct Window {
    /// The index of each sample's pixel in the picture of samples, by its rank.
    pub pixels: Vec<usize>,
    /// The ranks of each surface's samples, ascending.
    pub surfaces: Vec<Vec<usize>>,
}

impl Geometry {
    /// Of the host's last frame, which was `colors` by `camera`.
    pub fn seen(samples: &Host, colors: &Picture, camera: &deferred_aa::Camera) -> Self {
        Self::new(colors, &samples.surfaces(), &samples.depths(), camera)
    }

    /// All windows, in reading order.
    pub fn windows(&self, colors: &Picture, m: u32) -> Result<impl Iterator<Item = Window>, QualityError> {
        check(colors, m)?;
        let (width, height) = (colors.width, colors.height);
        let order = window::order(m);
        let window = move |(x, y): (u32, u32)| {
            let pixel = |&(i, j): &(u8, u8)| ((y + u32::from(j)) * width + x + u32::from(i)) as usize;
            let pixels: Vec<usize> = order.iter().map(pixel).collect();
            let samples: Vec<Sample> = pixels.iter().map(|&i| self.0[i]).collect();
            Window { pixels, surfaces: surfaces(&samples) }
        };
        let step = m as usize;
        Ok((0..height).step_by(step).flat_map(move |y| (0..width).step_by(step).map(move |x| (x, y))).map(window))
    }

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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const WALL: Sample = Sample { position: DVec3::new(0.0, 0.0, -10.0), normal: DVec3::Z, identity: Some(1) };
    const SKY: Sample = Sample { position: DVec3::ZERO, normal: DVec3::ZERO, identity: None };

    /// Samples of one wall that `object` divides, by the index of their pixel.
    pub fn of_objects(samples: usize, object: impl Fn(usize) -> u32) -> Geometry {
        Geometry((0..samples).map(|i| Sample { identity: Some(object(i)), ..WALL }).collect())
    }

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
}
