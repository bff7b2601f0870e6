//! Twin of `shaders/swap/rays_software.wgsl`: tests every triangle against every ray, in f64.

pub mod classify;
pub mod places;
pub mod probe;
pub mod reflect;
pub mod shared_exponent;
pub mod trace;

use glam::{DAffine3, DVec2, DVec3};

/// A ray: the points `origin + t · direction` with t_min < t < t_max.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// The origin of the ray.
    pub origin: DVec3,
    /// The direction, of any length above 0.
    pub direction: DVec3,
    /// The least t of a hit.
    pub t_min: f64,
    /// The greatest t of a hit.
    pub t_max: f64,
}

/// The hit of a ray with a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The distance in lengths of the direction.
    pub t: f64,
    /// The index of the triangle.
    pub triangle: usize,
    /// Whether the vertices appear counterclockwise.
    pub front: bool,
    /// The weights of the second and third vertex.
    pub barycentrics: DVec2,
}

/// The weights of the three vertices where a ray meets the plane of a triangle, t there, and the signed volume that
/// tells its side. `None` if the ray runs along the plane.
fn weights(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<([f64; 3], f64, f64)> {
    let [a, b, c] = [a - ray.origin, b - ray.origin, c - ray.origin];
    let d = ray.direction;
    // Volumes of the tetrahedra between the ray and each edge.
    let volumes = [d.dot(c.cross(b)), d.dot(a.cross(c)), d.dot(b.cross(a))];
    let volume: f64 = volumes.iter().sum();
    if volume == 0.0 {
        return None;
    }
    let normal = (b - a).cross(c - a);
    Some((volumes.map(|v| v / volume), normal.dot(a) / normal.dot(d), volume))
}

/// The nearest triangle that the ray hits; of several at the same t, the first in the list.
pub fn closest(ray: &Ray, triangles: &[[DVec3; 3]]) -> Option<Hit> {
    closest_where(ray, triangles, |_| true)
}

/// The nearest hit of the ray that stops it.
pub fn closest_where(ray: &Ray, triangles: &[[DVec3; 3]], stops: impl Fn(&Hit) -> bool) -> Option<Hit> {
    let mut first: Option<Hit> = None;
    for (triangle, &corners) in triangles.iter().enumerate() {
        let Some((w, t, volume)) = weights(ray, corners) else { continue };
        let inside = w.iter().all(|&w| w >= 0.0) && t > ray.t_min && t < ray.t_max;
        let hit = Hit { t, triangle, front: volume > 0.0, barycentrics: DVec2::new(w[1], w[2]) };
        if inside && first.is_none_or(|f| t < f.t) && stops(&hit) {
            first = Some(hit);
        }
    }
    first
}

/// How near the ray comes to another hit: the lesser of the least |weight| at any triangle that it hits or just misses,
/// as a share of the triangle, and of the least relative distance of a t from an end of the ray.
pub fn margin(ray: &Ray, triangles: &[[DVec3; 3]]) -> f64 {
    let of = |&corners: &[DVec3; 3]| {
        let Some((w, t, _)) = weights(ray, corners) else { return f64::MAX };
        let edge = w.iter().fold(f64::MAX, |least, &w| least.min(w));
        let end = |end: f64| (t - end).abs() / t.abs().max(end.abs()).max(f64::MIN_POSITIVE);
        let ends = end(ray.t_min).min(end(ray.t_max));
        // A triangle that is clearly missed in one way does not matter in the other.
        let outside = (-edge).max(if t < ray.t_min || t > ray.t_max { ends } else { 0.0 });
        if outside > 0.0 { outside } else { edge.min(ends) }
    };
    triangles.iter().map(of).fold(f64::MAX, f64::min)
}

/// The triangles of a mesh, transformed by an instance, relative to the camera.
pub fn place(positions: &[[f32; 3]], indices: &[u32], world: DAffine3, camera: DVec3) -> Vec<[DVec3; 3]> {
    let vertex = |&i: &u32| world.transform_point3(DVec3::from(positions[i as usize].map(f64::from))) - camera;
    indices.as_chunks::<3>().0.iter().map(|t| [vertex(&t[0]), vertex(&t[1]), vertex(&t[2])]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_hit_in_front_behind_and_not_beside() {
        let triangles = [[DVec3::ZERO, DVec3::X, DVec3::Y]];
        let at = |z: f64, dz: f64, x| Ray {
            origin: DVec3::new(x, 0.25, z),
            direction: DVec3::Z * dz,
            t_min: 0.0,
            t_max: 10.0,
        };
        let hit = closest(&at(3.0, -1.0, 0.5), &triangles).unwrap();
        assert_eq!((hit.t, hit.front, hit.barycentrics), (3.0, true, DVec2::new(0.5, 0.25)));
        let behind = closest(&at(-3.0, 2.0, 0.5), &triangles).unwrap();
        assert_eq!((behind.t, behind.front), (1.5, false));
        assert_eq!(closest(&at(3.0, -1.0, 0.8), &triangles), None);
        assert_eq!(closest(&at(3.0, 1.0, 0.5), &triangles), None);
        assert!((margin(&at(3.0, -1.0, 0.8), &triangles) - 0.05).abs() < 1e-12);
    }
}
