//! Built-in scenes, made in code and always the same. Each is a hard case for anti-aliasing, seen from where it is
//! hardest.

mod atrium;
mod checker;
mod cornell;
mod fence;
mod mirrored;
mod mirrors;
mod paint;
mod shadows;
mod shape;
mod spheres;
mod stage;

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use self::shape::Shape;
use self::stage::{Stage, perspective};
use super::{Material, Scene, Sun};

/// The names that [`builtin`] knows; the first is the default scene.
pub const NAMES: [&str; 9] =
    ["atrium", "fence", "checker", "spheres", "cornell", "shadows", "mirrors", "flat", "empty"];

/// Builds the scene of that name.
pub fn builtin(name: &str) -> Option<Scene> {
    let stage = match name {
        "atrium" => atrium::build(),
        "fence" => fence::build(),
        "checker" => checker::build(),
        "spheres" => spheres::build(),
        "cornell" => cornell::build(),
        "shadows" => shadows::build(),
        "mirrors" => mirrors::build(),
        "flat" => flat(),
        "empty" => empty(),
        _ => return None,
    };
    Some(stage.finish(name))
}

pub use mirrored::SQUARES;

/// A wall of [`SQUARES`] that fills a square picture, the first `mirrors` of them mirrors: for what mirrors cost.
pub fn mirrored(mirrors: u32) -> Scene {
    mirrored::build(mirrors).finish("mirrored")
}

/// One plane without texture or highlight that fills the view: nothing here needs more than one sample.
fn flat() -> Stage {
    let mut stage = Stage::default();
    let paint = stage.material(Material { base_color: stage::srgb(0xb4b8bc), ..stage::matt("plane") });
    let mut plane = Shape::default();
    let (u, v) = (Vec3::new(2e3, 0.0, 0.0), Vec3::new(0.0, 2e3, 0.0));
    plane.quad(Vec3::new(-1e3, -1e3, 0.0), u, v, Vec2::ZERO, Vec2::ONE);
    stage.draw("plane", plane, paint);
    stage.sun(Sun { to_sun: Vec3::new(0.3, 0.5, 0.8).normalize(), irradiance: Vec3::splat(PI), casts: false });
    stage.camera(perspective(Vec3::new(3.0, 2.0, 8.0), Vec3::ZERO, 50.0, 0.1));
    stage
}

/// Nothing but the sky.
fn empty() -> Stage {
    let mut stage = Stage::default();
    stage.camera(perspective(Vec3::new(0.0, 1.7, 0.0), Vec3::new(0.0, 2.0, -5.0), 55.0, 0.1));
    stage
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_sound_and_have_a_camera() {
        for name in NAMES {
            let scene = builtin(name).unwrap();
            scene.validate().unwrap_or_else(|broken| panic!("{name}: {broken}"));
            assert_eq!(scene.name, name);
            assert_eq!(scene.cameras.len(), 1, "{name}");
            assert_eq!(scene.instances.is_empty(), name == "empty", "{name}");
            assert_eq!(scene.notices, [""; 0], "{name}");
        }
        assert!(builtin("nothing").is_none());
    }

    #[test]
    fn they_are_always_the_same() {
        let [a, b] = [0, 1].map(|_| builtin("atrium").unwrap());
        assert!(a.meshes.iter().zip(&b.meshes).all(|(a, b)| a.positions == b.positions && a.indices == b.indices));
        assert!(a.images.iter().zip(&b.images).all(|(a, b)| a.rgba == b.rgba));
    }

    #[test]
    fn triangles_face_as_their_normals_say() {
        for name in NAMES {
            for mesh in builtin(name).unwrap().meshes {
                for triangle in mesh.indices.chunks_exact(3) {
                    let [a, b, c] = [0, 1, 2].map(|k| triangle[k] as usize);
                    let face = (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
                    let normal = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
                    assert!(face.dot(normal) >= -1e-6, "{name}, {}: {triangle:?}", mesh.name);
                }
            }
        }
    }
}
