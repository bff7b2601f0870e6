//! What a visibility buffer shows, on the CPU: for measures that look at the surfaces of all samples.

use crate::scene::{Instance, Mesh, Scene};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// The first target that a stored G-buffer would have: the code of the normal (octahedral 16+16), and material and
/// object. `width` is that of the ids in samples.
pub fn surfaces(
    scene: &Scene,
    camera: &deferred_aa::Camera,
    ids: &[[u32; 2]],
    depths: &[f32],
    width: usize,
) -> Vec<[u32; 2]> {
    let mut view = camera.world_from_view.as_dmat4();
    let eye = view.w_axis.truncate();
    view.w_axis = DVec4::W;
    let relative_from_clip = (camera.clip_from_view.as_dmat4() * view.transpose()).inverse();
    let forward = -view.z_axis.truncate();
    let parallel = camera.clip_from_view.row(3).w == 1.0;
    let size = DVec2::new(width as f64, (ids.len() / width.max(1)) as f64);
    let mut placed: Vec<Option<(DMat4, f64)>> = vec![None; scene.instances.len()];
    let sample = |(at, (&[instance, triangle], &depth)): (usize, (&[u32; 2], &f32))| {
        let index = instance.checked_sub(1)? as usize;
        let instance = scene.instances.get(index)?;
        let (place, handedness) = *placed[index].get_or_insert_with(|| {
            let place = DMat4::from_translation(-eye) * instance.world_from_mesh.as_dmat4();
            (place, if place.determinant() < 0.0 { -1.0 } else { 1.0 })
        });
        let at = DVec2::new((at % width) as f64, (at / width) as f64) + 0.5;
        let ndc = at / size * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
        let point = relative_from_clip * DVec4::new(ndc.x, ndc.y, depth.into(), 1.0);
        let point = point.truncate() / point.w;
        let towards = if parallel { -forward } else { -point };
        Some([
            octahedral(normal(scene, instance, triangle, place, point, towards, handedness)),
            identity(scene, instance),
        ])
    };
    ids.iter().zip(depths).enumerate().map(sample).map(Option::unwrap_or_default).collect()
}

fn identity(scene: &Scene, instance: &Instance) -> u32 {
    scene.meshes[instance.mesh].material as u32 | u32::from(instance.object) << 16
}

/// The interpolated normal on the visible side.
fn normal(
    scene: &Scene,
    instance: &Instance,
    triangle: u32,
    place: DMat4,
    point: DVec3,
    towards: DVec3,
    handedness: f64,
) -> DVec3 {
    let mesh: &Mesh = &scene.meshes[instance.mesh];
    let Some(corners) = mesh.indices.as_chunks::<3>().0.get(triangle as usize) else { return DVec3::Y };
    let [a, b, c] = corners.map(|i| place.transform_point3(mesh.positions[i as usize].as_dvec3()));
    let plane = (b - a).cross(c - a);
    let share = |p: DVec3, q: DVec3| ((p - point).cross(q - point).dot(plane) / plane.length_squared()).max(0.0);
    let weights = [share(b, c), share(c, a), share(a, b)];
    let own: DVec3 = corners.iter().zip(weights).map(|(&i, w)| mesh.normals[i as usize].as_dvec3() * w).sum();
    let linear = DMat3::from_mat4(place);
    let cofactors = DMat3::from_cols(
        linear.y_axis.cross(linear.z_axis),
        linear.z_axis.cross(linear.x_axis),
        linear.x_axis.cross(linear.y_axis),
    );
    let side = if plane.dot(towards) * handedness < 0.0 { -1.0 } else { 1.0 };
    let normal = cofactors * own * (handedness * side);
    normal.try_normalize().unwrap_or(DVec3::Y)
}

/// The 16+16-bit code of a unit vector.
fn octahedral(v: DVec3) -> u32 {
    let p = v.truncate() / (v.x.abs() + v.y.abs() + v.z.abs());
    let sign = |c: f64| if c >= 0.0 { 1.0 } else { -1.0 };
    let e = if v.z >= 0.0 { p } else { DVec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y)) };
    let snorm = |c: f64| u32::from((c.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    snorm(e.x) | snorm(e.y) << 16
}
