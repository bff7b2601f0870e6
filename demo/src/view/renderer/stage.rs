//! The host of the scene that is shown, with what it was built for and how it is lit.

use super::event::{Adapter, Opened};
use super::wanted::{Lights, Source};
use crate::host::gpu::{self, Gpu};
use crate::host::{self, Host, Options};
use crate::scene::{Bounds, Scene, Sun};
use deferred_aa::rays::RayTier;
use deferred_aa::{DeferredAa, GBufferTier, TextureTier};
use glam::Vec3;
use std::collections::BTreeMap;

/// The host, once there is one.
pub struct Stage {
    /// Part of the adapter's name.
    adapter: Option<String>,
    pub host: Option<Host>,
    /// What the host was built for, or is to be built for first.
    pub options: Options,
    /// How the host is lit now.
    pub lights: Option<Lights>,
    own_sun: Option<Sun>,
}

impl Stage {
    /// Without a host.
    pub fn new(adapter: Option<String>, options: Options) -> Self {
        Self { adapter, host: None, options, lights: None, own_sun: None }
    }

    /// Builds a host on the adapter of the present one, which stays. Its G-buffer is the best of the wanted kind for
    /// the scene and the adapter.
    pub fn build(&self, scene: Scene, options: Options) -> Result<Host, String> {
        let adapter = match &self.host {
            Some(host) => host.gpu.adapter.clone(),
            None => gpu::choose(self.adapter.as_deref()).map_err(|e| e.to_string())?,
        };
        // Any frame may come to want rays, where the adapter has them.
        let (stored, textures) = (host::stored(&scene), options.textures);
        let wanted = &host::descriptor(options.m, textures, options.rays, stored);
        let traces = DeferredAa::requirements(&adapter, wanted).missing.is_empty();
        let options = Options { traces, ..options };
        let gbuffer = host::gbuffer_for(options.gbuffer, &scene, &adapter, textures, options.traced());
        let options = Options { gbuffer, ..options };
        let gpu = Gpu::for_peers(adapter, &options.descriptor()).map_err(|e| e.to_string())?;
        Host::new(gpu, scene, options).map_err(|e| e.to_string())
    }

    /// Takes a host of the present scene in place of the present one, which was built for these options.
    pub fn take(&mut self, host: Host, options: Options) {
        self.options = options;
        self.host = Some(host);
        self.lights = None;
    }

    /// Takes the host of another scene, and says what the window must know of it.
    pub fn open(&mut self, host: Host, own_sun: Option<Sun>, source: &Source, opening: u64) -> Opened {
        let notices = host.scene.notices.iter().chain(&host.uploaded.notices).cloned().collect();
        let own = host.scene.default_camera();
        let others = host.scene.cameras.iter().copied().filter(|c| *c != own);
        let opened = Opened {
            opening,
            source: source.clone(),
            cameras: std::iter::once(own).chain(others).collect(),
            bounds: host.scene.bounds(),
            objects: objects(&host.scene),
            lights: host.uploaded.light_count,
            sun: own_sun,
            notices,
            adapter: about(&host.gpu),
            #[cfg(test)]
            device: host.gpu.device.clone(),
        };
        self.own_sun = own_sun;
        self.take(host, self.options);
        opened
    }

    /// Lights the scene as the user has it.
    pub fn light(&mut self, lights: Lights) {
        if let Some(host) = &mut self.host {
            host.set_stall(lights.stall);
            host.set_light_count(lights.count);
            host.set_sun(lights.sun.or(self.own_sun));
            self.lights = Some(lights);
        }
    }
}

/// A box in the world around each object.
fn objects(scene: &Scene) -> Vec<Bounds> {
    let meshes: Vec<_> = scene.meshes.iter().map(|mesh| Bounds::around(mesh.positions.iter().copied())).collect();
    let mut objects: BTreeMap<u32, Vec<Vec3>> = BTreeMap::new();
    for instance in &scene.instances {
        let Some(bounds) = meshes[instance.mesh] else { continue };
        let corners = bounds.corners().map(|corner| instance.world_from_mesh.transform_point3(corner));
        objects.entry(instance.object.into()).or_default().extend(corners.into_iter().filter(|c| c.is_finite()));
    }
    objects.into_values().filter_map(Bounds::around).collect()
}

fn about(gpu: &Gpu) -> Adapter {
    let lacks = |textures, rays| {
        let missing =
            DeferredAa::requirements(&gpu.adapter, &host::descriptor(4, textures, rays, GBufferTier::default()))
                .missing;
        (!missing.is_empty()).then(|| missing.join(", "))
    };
    Adapter {
        name: gpu.adapter.get_info().name,
        no_bindings: lacks(TextureTier::Bindings, None),
        no_ray_query: lacks(TextureTier::Arrays, Some(RayTier::Query)),
        no_triangles: (!gpu.adapter.features().contains(wgpu::Features::PRIMITIVE_INDEX))
            .then(|| "feature PRIMITIVE_INDEX".to_owned()),
        has_timestamps: gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        longest: gpu.device.limits().max_texture_dimension_2d,
    }
}
