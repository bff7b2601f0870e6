//! Brings what became of the cameras back to the main world.

use crate::component::{DeferredAaState, DeferredAaStatus};
use bevy_app::prelude::*;
use bevy_diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy_ecs::prelude::*;
use bevy_log::{error, warn};
use bevy_platform::collections::HashMap;
use deferred_aa::Statistics;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The samples that were shaded over all samples, of the camera with the most.
pub const SAMPLE_RATIO: DiagnosticPath = DiagnosticPath::const_new("deferred_aa/sample_ratio");

/// The GPU memory of all cameras' G-buffers and what lies beside them, in bytes.
pub const BYTES: DiagnosticPath = DiagnosticPath::const_new("deferred_aa/bytes");

/// What a frame left.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub statistics: Option<Statistics>,
    pub bytes: u64,
}

#[derive(Debug, Default)]
struct OfCamera {
    state: DeferredAaState,
    report: Report,
    /// Whether it was said that its meshes are not deferred.
    is_forward: bool,
}

/// Shared by both worlds, by the cameras of the main world.
#[derive(Resource, Clone, Debug, Default)]
pub struct Reports(Arc<Mutex<HashMap<Entity, OfCamera>>>);

impl Reports {
    fn lock(&self) -> MutexGuard<'_, HashMap<Entity, OfCamera>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the camera is anti-aliased in this frame. An error is logged when it is new.
    pub fn state(&self, camera: Entity, state: DeferredAaState) {
        let mut cameras = self.lock();
        let of = cameras.entry(camera).or_default();
        if let DeferredAaState::Refused(e) = &state
            && of.state != state
        {
            error!("DeferredAa of camera {camera}: {e}");
        }
        of.state = state;
    }

    /// The camera sees opaque meshes, none of which is deferred. That is said once.
    pub fn forward(&self, camera: Entity) {
        if !std::mem::replace(&mut self.lock().entry(camera).or_default().is_forward, true) {
            warn!(
                "DeferredAa of camera {camera}: none of the meshes that it sees is deferred, so none is anti-aliased; \
                 set opaque_render_method of their materials to OpaqueRendererMethod::Deferred, or leave it at Auto and \
                 insert DefaultOpaqueRendererMethod::deferred()"
            );
        }
    }

    pub fn frame(&self, camera: Entity, report: Report) {
        self.lock().entry(camera).or_default().report = report;
    }
}

pub fn plugin(app: &mut App) {
    app.register_diagnostic(Diagnostic::new(SAMPLE_RATIO))
        .register_diagnostic(Diagnostic::new(BYTES).with_suffix(" bytes"))
        .add_systems(Last, publish);
}

fn publish(reports: Res<Reports>, mut cameras: Query<(Entity, &mut DeferredAaStatus)>, mut diagnostics: Diagnostics) {
    let mut reports = reports.lock();
    reports.retain(|camera, _| cameras.contains(*camera));
    let (mut ratio, mut bytes) = (None, 0);
    for (camera, mut status) in &mut cameras {
        let Some(of) = reports.get(&camera) else { continue };
        if status.state != of.state {
            status.state = of.state.clone();
        }
        if of.state == DeferredAaState::Active {
            bytes += of.report.bytes;
            let this = of.report.statistics.as_ref().map(|statistics| statistics.ratio);
            ratio = ratio.into_iter().chain(this).reduce(f64::max);
        }
        status.bypass_change_detection().statistics.clone_from(&of.report.statistics);
        status.bypass_change_detection().bytes = of.report.bytes;
    }
    if let Some(ratio) = ratio {
        diagnostics.add_measurement(&SAMPLE_RATIO, || ratio);
    }
    diagnostics.add_measurement(&BYTES, || bytes as f64);
}
