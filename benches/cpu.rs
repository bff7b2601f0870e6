//! What runs on the CPU: the check of a host's shading at start-up, and the twins of metrics and plan that tests wait for.
//! `cargo bench --bench cpu`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use deferred_aa::reference::metrics::Input;
use deferred_aa::reference::plan;
use deferred_aa::{DeferredAa, Shading, TextureTier, Windowed, wgpu};
use deferred_aa_demo::host::SHADING_WGSL;
use std::hint::black_box;

/// SplitMix64, its upper half.
fn noise(i: u64) -> u32 {
    let mut z = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 32) as u32
}

fn shading(c: &mut Criterion) {
    let shading = Shading { source: SHADING_WGSL, file: "shading.wgsl" };
    for (name, tier) in [("arrays", TextureTier::Arrays), ("none", TextureTier::None)] {
        // Without a table the demo's textures have no names: the error, with its place found, is what is timed.
        c.bench_function(&format!("check_shading/{name}"), |b| {
            b.iter(|| DeferredAa::check_shading(black_box(shading), tier, wgpu::Features::empty()));
        });
    }
}

fn twins(c: &mut Criterion) {
    const M: usize = 4;
    let (width, height) = (64, 64);
    let samples = (width * height * M * M) as u64;
    let depth: Vec<f32> = (0..samples).map(|i| 0.1 + noise(i / 64) as f32 / u32::MAX as f32).collect();
    let surface: Vec<[u32; 2]> = (0..samples).map(|i| [noise(i / 16), noise(i / 256) % 4]).collect();
    let grey = |i| [noise(i / 8) as f32 / u32::MAX as f32; 4];
    let first: Vec<[f32; 4]> = (0..(width * height) as u64).map(grey).collect();
    let input = Input { m: M, width, height, depth: &depth, surface: &surface, first: &first, exposure: 1.0 };
    let windowed = Windowed::default();
    let mut group = c.benchmark_group("reference");
    group.throughput(Throughput::Elements((width * height) as u64));
    group.bench_function("metrics", |b| {
        b.iter(|| (0..width * height).map(|i| input.worth(i % width, i / width, &windowed).k).sum::<u32>());
    });
    let (width, height) = (1920, 1080);
    let counts: Vec<u32> = (0..width * height).map(|i| 1 + noise(u64::from(i)) % 16).collect();
    group.throughput(Throughput::Elements(counts.len() as u64));
    group.bench_function("plan", |b| {
        b.iter(|| plan::plan(black_box(&counts), width, height, Windowed::NO_TILE_LIMIT));
    });
    group.finish();
}

criterion_group!(benches, shading, twins);
criterion_main!(benches);
