//! The promises that scenes make to the renderer, checked.

use glam::{Vec3, Vec4};

use super::{Lens, Mesh, Scene, TextureRef};

/// How far unit and orthogonal vectors may be off.
const TOLERANCE: f32 = 1e-3;

impl Scene {
    /// Checks everything that the fields' documentation promises: indices in range, numbers finite, vectors of unit
    /// length. Says what is broken where. For tests; loaded and built scenes always pass.
    pub fn validate(&self) -> Result<(), String> {
        for (i, mesh) in self.meshes.iter().enumerate() {
            let place = |what: &str| format!("mesh {i} '{}': {what}", mesh.name);
            mesh.validate().map_err(|what| place(&what))?;
            ensure(mesh.material < self.materials.len(), || place("material out of range"))?;
        }
        for (i, instance) in self.instances.iter().enumerate() {
            ensure(instance.mesh < self.meshes.len(), || format!("instance {i}: mesh out of range"))?;
            ensure(instance.object != 0, || format!("instance {i}: object 0"))?;
            let matrix = instance.world_from_mesh;
            ensure(matrix.is_finite() && matrix.row(3) == Vec4::W, || format!("instance {i}: matrix not affine"))?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            let place = |what: &str| format!("material {i} '{}': {what}", material.name);
            let in_unit = |x: f32| (0.0..=1.0).contains(&x);
            let factors = [material.metallic, material.roughness, material.occlusion_strength];
            ensure(material.base_color.to_array().into_iter().chain(factors).all(in_unit), || place("factor"))?;
            ensure(is_light(material.emissive) && material.normal_scale.is_finite(), || place("emissive or scale"))?;
            ensure(material.alpha_cutoff.is_none_or(f32::is_finite), || place("alpha cutoff"))?;
            for (reference, srgb) in material.texture_refs() {
                let texture = self.textures.get(reference.texture).ok_or_else(|| place("texture out of range"))?;
                ensure(texture.srgb == srgb, || place("texture in the wrong colour space"))?;
                ensure(reference.u_row.is_finite() && reference.v_row.is_finite(), || place("texture transform"))?;
            }
        }
        for (i, texture) in self.textures.iter().enumerate() {
            ensure(texture.image < self.images.len(), || format!("texture {i}: image out of range"))?;
        }
        for (i, image) in self.images.iter().enumerate() {
            let texels = image.width as usize * image.height as usize;
            ensure(texels > 0 && image.rgba.len() == 4 * texels, || format!("image {i}: size"))?;
        }
        for (i, light) in self.lights.iter().enumerate() {
            let sound = light.position.is_finite() && is_unit(light.direction) && is_light(light.intensity);
            ensure(sound && light.range > 0.0, || format!("light {i}"))?;
        }
        if let Some(sun) = self.sun {
            ensure(is_unit(sun.to_sun) && is_light(sun.irradiance), || "sun".to_owned())?;
        }
        let sky = [self.sky.zenith, self.sky.horizon, self.sky.ground];
        ensure(sky.into_iter().all(is_light), || "sky".to_owned())?;
        for (i, camera) in self.cameras.iter().enumerate() {
            let view = camera.target - camera.eye;
            let lens = match camera.lens {
                Lens::Perspective { fov_y } => fov_y > 0.0 && fov_y < std::f32::consts::PI,
                Lens::Orthographic { half_height, far } => half_height > 0.0 && far > camera.near,
            };
            let sound = view.is_finite() && view.cross(camera.up).length() > 0.0 && camera.near > 0.0;
            ensure(sound && lens, || format!("camera {i}"))?;
        }
        Ok(())
    }
}

impl Mesh {
    fn validate(&self) -> Result<(), String> {
        let count = self.positions.len();
        let lengths = [self.normals.len(), self.tangents.len(), self.uvs.len(), self.colors.len()];
        ensure(lengths == [count; 4], || format!("{count} positions, but other arrays are {lengths:?}"))?;
        ensure(self.indices.len().is_multiple_of(3), || "incomplete triangle".to_owned())?;
        ensure(self.indices.iter().all(|&index| (index as usize) < count), || "index out of range".to_owned())?;
        ensure(self.positions.iter().all(|p| p.is_finite()), || "position not finite".to_owned())?;
        ensure(self.uvs.iter().all(|uv| uv.is_finite()), || "texture coordinate not finite".to_owned())?;
        ensure(self.normals.iter().all(|&normal| is_unit(normal)), || "normal not of unit length".to_owned())?;
        let in_unit = |x: f32| (0.0..=1.0).contains(&x);
        ensure(self.colors.iter().all(|c| c.to_array().into_iter().all(in_unit)), || "colour".to_owned())?;
        let sound = |(tangent, normal): (&Vec4, &Vec3)| {
            let direction = tangent.truncate();
            is_unit(direction) && direction.dot(*normal).abs() < TOLERANCE && tangent.w.abs() == 1.0
        };
        ensure(self.tangents.iter().zip(&self.normals).all(sound), || "tangent".to_owned())
    }
}

impl super::Material {
    /// The textures in use, and whether each is read as sRGB.
    pub fn texture_refs(&self) -> impl Iterator<Item = (&TextureRef, bool)> {
        [
            (&self.base_color_texture, true),
            (&self.metallic_roughness_texture, false),
            (&self.normal_texture, false),
            (&self.occlusion_texture, false),
            (&self.emissive_texture, true),
        ]
        .into_iter()
        .filter_map(|(texture, srgb)| Some((texture.as_ref()?, srgb)))
    }
}

fn is_unit(vector: Vec3) -> bool {
    (vector.length() - 1.0).abs() < TOLERANCE
}

fn is_light(radiance: Vec3) -> bool {
    radiance.is_finite() && radiance.min_element() >= 0.0
}

fn ensure(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}
