//! Putting a scene together.

use glam::{Mat4, Vec3, Vec4};

use super::paint::Painting;
use super::shape::Shape;
use crate::scene::{
    Camera, Image, Instance, Lens, Light, LightKind, Material, Mesh, Nearest, Scene, Sky, Sun, Texture, TextureRef,
    Wrap, tangents,
};

/// A scene under construction.
#[derive(Default)]
pub(super) struct Stage {
    scene: Scene,
    objects: u16,
}

impl Stage {
    pub fn finish(mut self, name: &str) -> Scene {
        name.clone_into(&mut self.scene.name);
        self.scene
    }

    pub fn sun(&mut self, sun: Sun) {
        self.scene.sun = Some(sun);
    }

    pub fn sky(&mut self, sky: Sky) {
        self.scene.sky = sky;
    }

    pub fn camera(&mut self, camera: Camera) {
        self.scene.cameras.push(camera);
    }

    pub fn light(&mut self, light: Light) {
        self.scene.lights.push(light);
    }

    /// A light of `intensity` candela, gone at `range`, that casts no shadow.
    pub fn point_light(&mut self, position: Vec3, intensity: Vec3, range: f32) {
        let direction = Vec3::NEG_Y;
        self.scene.lights.push(Light { kind: LightKind::Point, position, direction, intensity, range, casts: false });
    }

    pub fn image(&mut self, name: &str, painting: Painting) -> usize {
        let Painting { width, height, rgba } = painting;
        self.scene.images.push(Image { name: name.to_owned(), width, height, rgba: rgba.into() });
        self.scene.images.len() - 1
    }

    /// Tiles `image`, which holds colours.
    pub fn color_texture(&mut self, image: usize) -> Option<TextureRef> {
        Some(self.texture(Texture { srgb: true, ..plain(image) }))
    }

    /// Tiles `image`, which holds data.
    pub fn data_texture(&mut self, image: usize) -> Option<TextureRef> {
        Some(self.texture(plain(image)))
    }

    pub fn texture(&mut self, texture: Texture) -> TextureRef {
        self.scene.textures.push(texture);
        TextureRef { texture: self.scene.textures.len() - 1, u_row: Vec3::X, v_row: Vec3::Y }
    }

    pub fn material(&mut self, material: Material) -> usize {
        self.scene.materials.push(material);
        self.scene.materials.len() - 1
    }

    /// Adds a mesh without showing it.
    pub fn mesh(&mut self, name: &str, shape: Shape, material: usize) -> usize {
        let count = shape.positions.len();
        let mut mesh = Mesh {
            name: name.to_owned(),
            positions: shape.positions,
            normals: shape.normals,
            uvs: shape.uvs,
            colors: vec![Vec4::ONE; count],
            indices: shape.indices,
            material,
            ..Mesh::default()
        };
        match &self.scene.materials[material].normal_texture {
            Some(map) => tangents::generate(&mut mesh, map),
            None => tangents::arbitrary(&mut mesh),
        }
        self.scene.meshes.push(mesh);
        self.scene.meshes.len() - 1
    }

    /// Shows a mesh.
    pub fn place(&mut self, mesh: usize, world_from_mesh: Mat4) {
        self.objects += 1;
        self.scene.instances.push(Instance { mesh, world_from_mesh, object: self.objects });
    }

    /// Adds and shows a mesh that is already in place.
    pub fn draw(&mut self, name: &str, shape: Shape, material: usize) {
        let mesh = self.mesh(name, shape, material);
        self.place(mesh, Mat4::IDENTITY);
    }
}

fn plain(image: usize) -> Texture {
    Texture { image, srgb: false, wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, nearest: Nearest::default() }
}

/// A white material without any highlight to speak of.
pub(super) fn matt(name: &str) -> Material {
    Material {
        name: name.to_owned(),
        base_color: Vec4::ONE,
        metallic: 0.0,
        roughness: 1.0,
        emissive: Vec3::ZERO,
        normal_scale: 1.0,
        occlusion_strength: 1.0,
        alpha_cutoff: None,
        blended: false,
        double_sided: false,
        unlit: false,
        transmission: 0.0,
        ior: 1.5,
        volume: false,
        base_color_texture: None,
        metallic_roughness_texture: None,
        normal_texture: None,
        occlusion_texture: None,
        emissive_texture: None,
    }
}

/// The linear colour that 0xrrggbb stands for on the web.
pub(super) fn srgb(hex: u32) -> Vec4 {
    let channel = |shift: u32| {
        let encoded = (hex >> shift & 0xff) as f32 / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    Vec4::new(channel(16), channel(8), channel(0), 1.0)
}

/// An upright camera with this vertical angle of view, in degrees.
pub(super) fn perspective(eye: Vec3, target: Vec3, fov_y: f32, near: f32) -> Camera {
    Camera { eye, target, up: Vec3::Y, lens: Lens::Perspective { fov_y: fov_y.to_radians() }, near }
}
