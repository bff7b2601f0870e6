//! Brings the cameras' components to the render world, and finds those that can't be anti-aliased.

use crate::component::DeferredAa;
use crate::error::DeferredAaError;
use crate::view::ViewNode;
use bevy_camera::{Camera, MainPassResolutionOverride};
use bevy_core_pipeline::prepass::DeferredPrepass;
use bevy_ecs::prelude::*;
use bevy_pbr::deferred::SkipDeferredLighting;
use bevy_render::Extract;
use bevy_render::camera::TemporalJitter;
use bevy_render::occlusion_culling::OcclusionCulling;
use bevy_render::sync_world::RenderEntity;

/// A camera's component in the render world.
#[derive(Component)]
pub struct ExtractedDeferredAa {
    pub settings: DeferredAa,
    /// The camera in the main world.
    pub camera: Entity,
    pub refused: Option<DeferredAaError>,
}

type Cameras<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        RenderEntity,
        &'static Camera,
        Option<&'static DeferredAa>,
        (Has<DeferredPrepass>, Has<TemporalJitter>, Has<MainPassResolutionOverride>, Has<OcclusionCulling>),
    ),
>;

pub fn cameras(mut commands: Commands, cameras: Extract<Cameras<'_, '_>>, had: Query<Has<ExtractedDeferredAa>>) {
    for (camera, entity, settings, aa, (prepass, jitter, resolution, occlusion)) in &cameras {
        let aa = aa.filter(|_| settings.is_active);
        let Ok(mut entity_commands) = commands.get_entity(entity) else { continue };
        if let Some(&settings) = aa {
            let refused = if !prepass {
                Some(DeferredAaError::NoPrepass)
            } else if jitter {
                Some(DeferredAaError::Jitter)
            } else if resolution {
                Some(DeferredAaError::ResolutionOverride)
            } else if occlusion {
                Some(DeferredAaError::OcclusionCulling)
            } else {
                None
            };
            entity_commands.insert(ExtractedDeferredAa { settings, camera, refused });
        } else if had.get(entity).unwrap_or(false) {
            entity_commands.remove::<(ExtractedDeferredAa, ViewNode, SkipDeferredLighting)>();
        }
    }
}
