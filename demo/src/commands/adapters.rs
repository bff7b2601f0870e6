//! `adapters`: what there is, and what it can run.

use crate::{gpu, host};
use deferred_aa::{DeferredAa, TextureTier};

/// Prints a paragraph for each adapter.
pub fn run() {
    let adapters = gpu::adapters();
    if adapters.is_empty() {
        println!("no graphics adapter; install a Vulkan driver (on Debian: apt-get install mesa-vulkan-drivers)");
    }
    for adapter in adapters {
        let info = adapter.get_info();
        println!("{} ({:?}, {:?}; {} {})", info.name, info.backend, info.device_type, info.driver, info.driver_info);
        for tier in [TextureTier::Arrays, TextureTier::Bindings] {
            let requirements = DeferredAa::requirements(&adapter, &host::descriptor(4, tier));
            match requirements.missing.as_slice() {
                [] => println!("  texture {}: yes", tier_name(tier)),
                missing => println!("  texture {}: no, it lacks {}", tier_name(tier), missing.join(", ")),
            }
            if tier == TextureTier::Arrays {
                for lost in requirements.lost {
                    println!("  {lost}");
                }
            }
        }
        let features = adapter.features();
        let yes = |feature| if features.contains(feature) { "yes" } else { "no" };
        println!("  timestamps: {}", yes(wgpu::Features::TIMESTAMP_QUERY));
        println!("  ray query: {}", yes(wgpu::Features::EXPERIMENTAL_RAY_QUERY));
        let limit = adapter.limits().max_texture_dimension_2d;
        println!("  largest output at m = 4: {} pixels a side", limit / 4);
    }
}

/// As on the command line.
fn tier_name(tier: TextureTier) -> &'static str {
    match tier {
        TextureTier::None => "none",
        TextureTier::Arrays => "arrays",
        TextureTier::Bindings => "bindings",
    }
}
