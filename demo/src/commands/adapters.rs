//! `adapters`: what there is, and what it can run.

use super::output::say;
use crate::host::{self, gpu};
use deferred_aa::rays::RayTier;
use deferred_aa::{DeferredAa, GBufferTier, TextureTier};

/// Prints a paragraph for each adapter.
pub fn run() {
    let adapters = gpu::adapters();
    if adapters.is_empty() {
        say("no graphics adapter; install a Vulkan driver (on Debian: apt-get install mesa-vulkan-drivers)");
    }
    for adapter in &adapters {
        say(&describe(adapter).join("\n  "));
    }
}

fn describe(adapter: &wgpu::Adapter) -> Vec<String> {
    let info = adapter.get_info();
    let mut lines = vec![format!(
        "{} ({:?}, {:?}; {} {})",
        info.name, info.backend, info.device_type, info.driver, info.driver_info
    )];
    for (tier, name) in [(TextureTier::Arrays, "arrays"), (TextureTier::Bindings, "bindings")] {
        let requirements = DeferredAa::requirements(adapter, &host::descriptor(4, tier, None, GBufferTier::default()));
        lines.push(match requirements.missing.as_slice() {
            [] => format!("texture {name}: yes"),
            missing => format!("texture {name}: no, it lacks {}", missing.join(", ")),
        });
        lines.extend(requirements.lost);
    }
    lines.dedup();
    let features = adapter.features();
    let yes = |feature| if features.contains(feature) { "yes" } else { "no" };
    lines.push(format!("timestamps: {}", yes(wgpu::Features::TIMESTAMP_QUERY)));
    let traced = host::descriptor(4, TextureTier::Arrays, RayTier::Software, GBufferTier::default());
    lines.push(match DeferredAa::requirements(adapter, &traced).missing.as_slice() {
        [] => "rays in software: yes".to_owned(),
        missing => format!("rays in software: no, it lacks {}", missing.join(", ")),
    });
    lines.push(format!("ray query: {}", yes(wgpu::Features::EXPERIMENTAL_RAY_QUERY)));
    let limit = adapter.limits().max_texture_dimension_2d;
    lines.push(format!("largest output at m = 4: {} pixels a side", limit / 4));
    lines
}
