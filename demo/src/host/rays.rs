//! The scene as rays see it.

use crate::scene::{self, LightKind, Scene};
use deferred_aa::rays::{self, Attributes, BottomLevel, MeshId, RayError, RayScene, RayTier};
use deferred_aa::{CastingLight, MAX_CASTING_LIGHTS};
use glam::{Affine3A, Vec3};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Meshes on the GPU, and what is placed of them.
#[derive(Debug)]
pub struct Rays {
    /// On the GPU.
    pub scene: RayScene,
    /// How long the bottom levels took to build.
    pub built_in: Duration,
    /// Triangles of all meshes.
    pub triangles: u64,
    /// Bytes of their nodes and indices, without vertices.
    pub bytes: u64,
    /// What rays can't meet, a line each.
    pub notices: Vec<String>,
    instances: Vec<rays::Instance>,
}

impl Rays {
    /// Builds the bottom levels on all cores and uploads them, for rays on a tier, for a visibility buffer, or both. No
    /// ray meets the blended instances, which come last in the scene.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        tier: Option<RayTier>,
        visible: bool,
        scene: &Scene,
    ) -> Result<Self, RayError> {
        let start = Instant::now();
        let built = build(scene, tier == Some(RayTier::Software))?;
        let built_in = start.elapsed();
        let mut on_gpu = match tier {
            Some(tier) if !visible => RayScene::new(device, tier),
            tier => RayScene::for_visibility(device, tier),
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("ray scene") });
        let meshes: Vec<MeshId> =
            built.iter().map(|mesh| on_gpu.add(device, queue, &mut encoder, mesh)).collect::<Result<_, _>>()?;
        let mut notices = Vec::new();
        let seen = scene.instances.iter().filter(|i| !scene.is_blended(i));
        let mut instances: Vec<_> = seen.map(|i| instance(scene, &meshes, i)).collect();
        // What is flattened is drawn, but no ray meets it.
        while let Err(error) = on_gpu.update(device, queue, &mut encoder, &instances, Vec3::ZERO) {
            let RayError::Transform { instance, .. } = error else { return Err(error) };
            notices.push(format!("no ray meets {error}"));
            instances.remove(instance);
        }
        queue.submit([encoder.finish()]);
        let triangles = built.iter().map(|mesh| u64::from(mesh.triangles())).sum();
        let bytes = built.iter().map(BottomLevel::bytes).sum();
        Ok(Self { scene: on_gpu, built_in, triangles, bytes, notices, instances })
    }

    /// What was built, in a line.
    pub fn summary(&self) -> String {
        let per_triangle = self.bytes as f64 / self.triangles.max(1) as f64;
        let (triangles, ms) = (self.triangles, self.built_in.as_secs_f64() * 1e3);
        format!("rays: {triangles} triangles in {ms:.0} ms, {per_triangle:.1} bytes each without vertices")
    }

    /// Places the instances for a frame.
    pub fn update(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        camera: Vec3,
    ) -> Result<(), RayError> {
        self.scene.update(device, queue, encoder, &self.instances, camera)
    }
}

/// The bottom levels of a scene's meshes, on all cores, with trees or without.
pub fn build(scene: &Scene, trees: bool) -> Result<Vec<BottomLevel>, RayError> {
    let next = AtomicUsize::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    // The largest first, so that none is left to one core at the end.
    let mut order: Vec<usize> = (0..scene.meshes.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(scene.meshes[i].indices.len()));
    let work = || {
        let mut built = Vec::new();
        while let Some(&i) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            built.push((i, bottom_level(scene, &scene.meshes[i], trees)));
        }
        built
    };
    let mut all: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap_or_default()).collect()
    });
    all.sort_by_key(|&(i, _)| i);
    all.into_iter().map(|(_, built)| built).collect()
}

fn bottom_level(scene: &Scene, mesh: &scene::Mesh, tree: bool) -> Result<BottomLevel, RayError> {
    let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let attributes: Vec<_> = (0..positions.len())
        .map(|i| Attributes {
            normal: mesh.normals[i].to_array(),
            tangent: mesh.tangents[i].to_array(),
            uv: mesh.uvs[i].to_array(),
            user: u32::from_le_bytes(crate::host::upload::color(mesh.colors[i])),
        })
        .collect();
    let make = if tree { BottomLevel::build } else { BottomLevel::untraced };
    make(&rays::Mesh {
        name: &mesh.name,
        positions: &positions,
        indices: &mesh.indices,
        attributes: &attributes,
        masked: scene.materials[mesh.material].alpha_cutoff.is_some(),
    })
}

fn instance(scene: &Scene, meshes: &[MeshId], i: &scene::Instance) -> rays::Instance {
    let index = scene.meshes[i.mesh].material;
    let material = &scene.materials[index];
    rays::Instance {
        material: index as u32,
        object: u32::from(i.object),
        culled: !material.double_sided,
        casts_shadow: material.transmission < CLEAR,
        ..rays::Instance::new(meshes[i.mesh], Affine3A::from_mat4(i.world_from_mesh))
    }
}

/// The lights that cast shadows: the scene's in their order, then the sun, which is bit [`sun_bit`].
pub fn casting_lights(scene: &Scene, sun: bool) -> Vec<CastingLight> {
    let lights = scene.lights.iter().filter(|l| l.casts).take(MAX_CASTING_LIGHTS - 1).map(|l| match l.kind {
        LightKind::Directional => CastingLight::Directional { towards: -l.direction },
        LightKind::Point => CastingLight::Punctual { position: l.position, range: l.range, cone: None },
        LightKind::Spot { outer, .. } => {
            CastingLight::Punctual { position: l.position, range: l.range, cone: Some((l.direction, outer)) }
        }
    });
    let sun = scene.sun.filter(|_| sun).map(|s| CastingLight::Directional { towards: s.to_sun });
    lights.chain(sun).collect()
}

/// The transmission from which a material lets the light of lamps and the sun through.
const CLEAR: f32 = 0.5;

/// Materials smooth enough to be traced as mirrors, by perceptual roughness.
const MIRROR_ROUGHNESS: f32 = 0.2;

/// The materials that reflect as a mirror or let light through. Those whose metal is painted by a texture are left out:
/// their roughness is not known here.
pub fn reflective(scene: &Scene) -> Vec<u32> {
    let sends = |m: &scene::Material| {
        let mirror = m.metallic >= 0.5 && m.metallic_roughness_texture.is_none();
        !m.unlit && m.roughness <= MIRROR_ROUGHNESS && (mirror || m.transmission > 0.0)
    };
    (0..).zip(&scene.materials).filter(|(_, m)| sends(m)).map(|(i, _)| i).collect()
}

/// The sun's bit among the casting lights.
pub fn sun_bit(scene: &Scene) -> u32 {
    1 << scene.lights.iter().filter(|l| l.casts).count().min(MAX_CASTING_LIGHTS - 1)
}
