//! A scene with every kind of light, masks, normal maps, a skybox and a skinned mesh, built in code.

use bevy_asset::{Assets, Handle, RenderAssetUsages};
use bevy_camera::visibility::NoFrustumCulling;
use bevy_color::{Color, LinearRgba};
use bevy_ecs::prelude::*;
use bevy_gizmos::prelude::*;
use bevy_image::prelude::*;
use bevy_image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy_light::prelude::*;
use bevy_light::{CascadeShadowConfigBuilder, EnvironmentMapLight, Skybox};
use bevy_material::AlphaMode;
use bevy_math::prelude::*;
use bevy_mesh::prelude::*;
use bevy_mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy_mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy_pbr::{DistanceFog, FogFalloff, MeshMaterial3d, StandardMaterial};
use bevy_render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy_shape::prelude::*;
use bevy_transform::prelude::*;

/// Where the camera stands.
pub fn eye() -> Transform {
    Transform::from_xyz(0.0, 2.6, 7.0).looking_at(Vec3::new(0.0, 0.9, 0.0), Vec3::Y)
}

/// What a camera sees besides the meshes.
pub fn surroundings(world: &mut World) -> impl Bundle + Clone + use<> {
    let sky = cube_map(world, 64, |d| {
        let up = d.y.max(0.0);
        let sun = d.dot(Vec3::new(0.4, 0.5, 0.75).normalize()).max(0.0).powf(60.0);
        Vec3::new(0.25, 0.35, 0.6) * (0.4 + 0.6 * up) + Vec3::new(1.0, 0.8, 0.5) * sun
    });
    (
        Skybox { image: Some(sky.clone()), brightness: 1500.0, ..Default::default() },
        EnvironmentMapLight { diffuse_map: sky.clone(), specular_map: sky, intensity: 700.0, ..Default::default() },
        DistanceFog {
            color: Color::srgb(0.5, 0.55, 0.65),
            falloff: FogFalloff::Linear { start: 8.0, end: 60.0 },
            ..Default::default()
        },
    )
}

/// Fills the world.
pub fn spawn(world: &mut World) {
    let tiles = texture(world, 128, TextureFormat::Rgba8UnormSrgb, |u, v| {
        let dark = ((u * 8.0) as u32 + (v * 8.0) as u32).is_multiple_of(2);
        if dark { [60, 60, 66, 255] } else { [190, 180, 160, 255] }
    });
    let bumps = texture(world, 128, TextureFormat::Rgba8Unorm, |u, v| {
        let wave = |x: f32| (x * 12.0 * std::f32::consts::TAU).cos() * 0.5;
        let n = Vec3::new(wave(u), wave(v), 1.0).normalize() * 0.5 + 0.5;
        [(n.x * 255.0) as u8, (n.y * 255.0) as u8, (n.z * 255.0) as u8, 255]
    });
    let leaves = texture(world, 128, TextureFormat::Rgba8UnormSrgb, |u, v| {
        let p = Vec2::new((u * 5.0).fract() - 0.5, (v * 5.0).fract() - 0.5);
        let inside = p.x.abs() + 2.0 * p.y.abs() < 0.45;
        [70, 140, 50, if inside { 255 } else { 0 }]
    });
    let ground = Mesh::from(Plane3d::default().mesh().size(40.0, 40.0)).with_uvs_times(20.0).with_tangents();
    let cube = Mesh::from(Cuboid::new(1.0, 1.0, 1.0)).with_tangents();
    let sphere = Sphere::new(0.6).mesh().uv(48, 24).with_tangents();
    let torus = Mesh::from(Torus::new(0.25, 0.65)).with_tangents();
    let leaf = Mesh::from(Rectangle::new(1.6, 1.6)).with_tangents();
    let [ground, cube, sphere, torus, leaf] =
        [ground, cube, sphere, torus, leaf].map(|mesh| world.resource_mut::<Assets<Mesh>>().add(mesh));

    let textured = |texture: &Handle<Image>| StandardMaterial {
        base_color_texture: Some(texture.clone()),
        perceptual_roughness: 0.8,
        ..Default::default()
    };
    let metal = StandardMaterial {
        base_color: Color::srgb(0.9, 0.7, 0.4),
        metallic: 1.0,
        perceptual_roughness: 0.25,
        normal_map_texture: Some(bumps.clone()),
        ..Default::default()
    };
    let coated = StandardMaterial {
        base_color: Color::srgb(0.6, 0.1, 0.1),
        perceptual_roughness: 0.6,
        clearcoat: 1.0,
        clearcoat_perceptual_roughness: 0.1,
        ..Default::default()
    };
    let glowing = StandardMaterial { emissive: LinearRgba::rgb(4.0, 2.0, 0.5), ..Default::default() };
    let unlit = StandardMaterial { base_color: Color::srgb(0.1, 0.5, 0.9), unlit: true, ..Default::default() };
    let masked =
        StandardMaterial { alpha_mode: AlphaMode::Mask(0.5), double_sided: true, cull_mode: None, ..textured(&leaves) };
    let at = Transform::from_xyz;
    let turned = |t: Transform, angle: f32| t.with_rotation(Quat::from_euler(EulerRot::YXZ, angle, angle * 0.5, 0.0));
    let meshes = [
        (ground, textured(&tiles), Transform::IDENTITY),
        (cube.clone(), textured(&tiles), turned(at(-2.2, 0.75, 0.0), 0.6)),
        (sphere.clone(), metal, at(0.0, 0.7, 0.8)),
        (torus.clone(), coated, turned(at(2.1, 0.9, 0.2), 0.9)),
        (sphere, glowing, at(-0.9, 0.35, 2.2).with_scale(Vec3::splat(0.4))),
        (cube.clone(), unlit, turned(at(1.1, 0.3, 2.4), 0.4).with_scale(Vec3::splat(0.4))),
        (leaf.clone(), masked.clone(), turned(at(-3.2, 1.0, -1.5), 0.3)),
        (leaf, masked, turned(at(3.4, 1.0, -1.2), -0.5)),
        (
            cube,
            StandardMaterial::from(Color::srgb(0.7, 0.7, 0.7)),
            at(0.0, 1.5, -4.0).with_scale(Vec3::new(9.0, 3.0, 0.2)),
        ),
    ];
    for (mesh, material, transform) in meshes {
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), transform));
    }
    spawn_skinned(world);

    world.spawn((
        DirectionalLight { illuminance: 4000.0, shadow_maps_enabled: true, ..Default::default() },
        CascadeShadowConfigBuilder { num_cascades: 2, maximum_distance: 20.0, ..Default::default() }.build(),
        at(3.0, 6.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    world.spawn((
        PointLight {
            intensity: 200_000.0,
            color: Color::srgb(1.0, 0.7, 0.4),
            shadow_maps_enabled: true,
            ..Default::default()
        },
        at(-2.5, 2.5, 2.5),
    ));
    world.spawn((
        SpotLight {
            intensity: 600_000.0,
            color: Color::srgb(0.4, 0.6, 1.0),
            shadow_maps_enabled: true,
            inner_angle: 0.3,
            outer_angle: 0.5,
            ..Default::default()
        },
        at(3.5, 4.0, 3.0).looking_at(Vec3::new(1.5, 0.0, 0.0), Vec3::Y),
    ));
}

/// Adds a sun, for files without lights.
pub fn spawn_sun(world: &mut World) {
    world.spawn((
        DirectionalLight { illuminance: 8000.0, shadow_maps_enabled: true, ..Default::default() },
        Transform::from_xyz(3.0, 6.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// Adds a glass pane, which is blended over the image.
pub fn spawn_over(world: &mut World) {
    let pane = world.resource_mut::<Assets<Mesh>>().add(Mesh::from(Cuboid::new(2.4, 1.6, 0.02)));
    let glass = StandardMaterial {
        base_color: Color::srgba(0.2, 0.7, 0.9, 0.4),
        alpha_mode: AlphaMode::Blend,
        ..Default::default()
    };
    let glass = world.resource_mut::<Assets<StandardMaterial>>().add(glass);
    world.spawn((Mesh3d(pane), MeshMaterial3d(glass), Transform::from_xyz(1.0, 1.0, 1.4)));
}

/// Draws a grid that the meshes hide in part.
pub fn draw_gizmos(mut gizmos: Gizmos) {
    let upright = Isometry3d::new(Vec3::new(0.0, 1.0, 0.5), Quat::IDENTITY);
    gizmos.grid(upright, UVec2::splat(6), Vec2::splat(0.8), Color::srgb(1.0, 0.9, 0.1));
}

/// A blade that bends at two joints.
fn spawn_skinned(world: &mut World) {
    const ROWS: u32 = 24;
    let rows = || (0..=ROWS).map(|i| i as f32 / ROWS as f32);
    let corners = || rows().flat_map(|t| [(-0.15, t), (0.15, t)]);
    let positions: Vec<_> = corners().map(|(x, t)| [x, t * 2.0, 0.0]).collect();
    let joints: Vec<[u16; 4]> = corners().map(|_| [0, 1, 0, 0]).collect();
    let weights: Vec<_> = corners().map(|(_, t)| [1.0 - t, t, 0.0, 0.0]).collect();
    let indices = (0..ROWS).flat_map(|i| [0, 1, 2, 2, 1, 3].map(|k| 2 * i + k)).collect();
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, corners().map(|_| [0.0, 0.0, 1.0]).collect::<Vec<_>>())
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, corners().map(|(x, t)| [x, t]).collect::<Vec<_>>())
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
        .with_inserted_indices(Indices::U32(indices));
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let material = StandardMaterial {
        base_color: Color::srgb(0.3, 0.7, 0.3),
        double_sided: true,
        cull_mode: None,
        ..Default::default()
    };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let root = Transform::from_xyz(0.9, 0.0, -0.8);
    let bent = Transform::from_xyz(1.3, 0.0, -0.6).with_rotation(Quat::from_rotation_z(-0.9));
    let joints = vec![world.spawn(root).id(), world.spawn(bent).id()];
    world.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(material),
        SkinnedMesh { inverse_bindposes, joints },
        NoFrustumCulling,
        Transform::IDENTITY,
    ));
}

trait Prepared {
    fn with_uvs_times(self, factor: f32) -> Self;
    fn with_tangents(self) -> Self;
}

impl Prepared for Mesh {
    fn with_uvs_times(mut self, factor: f32) -> Self {
        if let Some(VertexAttributeValues::Float32x2(uvs)) = self.attribute_mut(Self::ATTRIBUTE_UV_0) {
            uvs.iter_mut().for_each(|uv| *uv = uv.map(|c| c * factor));
        }
        self
    }

    fn with_tangents(self) -> Self {
        self.with_generated_tangents().expect("tangents")
    }
}

/// A texture by a function of its coordinates, with all its mips.
fn texture(world: &mut World, side: u32, format: TextureFormat, texel: impl Fn(f32, f32) -> [u8; 4]) -> Handle<Image> {
    let mut level: Vec<[u8; 4]> = (0..side * side)
        .map(|i| texel(((i % side) as f32 + 0.5) / side as f32, ((i / side) as f32 + 0.5) / side as f32))
        .collect();
    let (mut data, mut width, mut mips) = (Vec::new(), side as usize, 0);
    loop {
        data.extend(level.iter().flatten());
        mips += 1;
        if width == 1 {
            break;
        }
        let half = width / 2;
        let mean = |i: usize| {
            let (x, y) = (i % half * 2, i / half * 2);
            let four = [0, 1, width, width + 1].map(|k| level[y * width + x + k]);
            std::array::from_fn(|c| (four.iter().map(|t| u32::from(t[c])).sum::<u32>() / 4) as u8)
        };
        level = (0..half * half).map(mean).collect();
        width = half;
    }
    let size = Extent3d { width: side, height: side, depth_or_array_layers: 1 };
    let mut image = Image::new_uninit(size, TextureDimension::D2, format, RenderAssetUsages::RENDER_WORLD);
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = mips;
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        ..Default::default()
    });
    world.resource_mut::<Assets<Image>>().add(image)
}

/// A cube map by a function of the direction.
fn cube_map(world: &mut World, side: u32, radiance: impl Fn(Vec3) -> Vec3) -> Handle<Image> {
    let faces: [fn(f32, f32) -> Vec3; 6] = [
        |x, y| Vec3::new(1.0, -y, -x),
        |x, y| Vec3::new(-1.0, -y, x),
        |x, y| Vec3::new(x, 1.0, y),
        |x, y| Vec3::new(x, -1.0, -y),
        |x, y| Vec3::new(x, -y, 1.0),
        |x, y| Vec3::new(-x, -y, -1.0),
    ];
    let mut data = Vec::new();
    for face in faces {
        for i in 0..side * side {
            let place = |k: u32| (k as f32 + 0.5) / side as f32 * 2.0 - 1.0;
            let c = radiance(face(place(i % side), place(i / side)).normalize());
            data.extend([c.x, c.y, c.z, 1.0].into_iter().flat_map(f32::to_le_bytes));
        }
    }
    let size = Extent3d { width: side, height: side, depth_or_array_layers: 6 };
    let mut image =
        Image::new(size, TextureDimension::D2, data, TextureFormat::Rgba32Float, RenderAssetUsages::RENDER_WORLD);
    image.texture_view_descriptor =
        Some(TextureViewDescriptor { dimension: Some(TextureViewDimension::Cube), ..Default::default() });
    world.resource_mut::<Assets<Image>>().add(image)
}
