//! What runs on the CPU: the check of a host's shading at start-up, the twins of metrics and plan that tests wait for, the two levels
//! of the scene for rays, and frames: to record one, and from nothing to the first.
//! `cargo bench --bench cpu`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use deferred_aa::glam::{self, Affine3A, Mat4, Vec3, vec3};
use deferred_aa::rays::{BottomLevel, Instance, Mesh, RayScene, RayTier};
use deferred_aa::reference::metrics::Input;
use deferred_aa::reference::plan;
use deferred_aa::{
    Camera, DeferredAa, Descriptor, Frame, GBufferTier, Settings, Shading, Technique, TextureTier, Windowed, wgpu,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{self, SHADING_WGSL};
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
    let input = Input {
        m: M,
        width,
        height,
        depth: &depth,
        surface: &surface,
        first: &first,
        user: &[],
        shadow: &[],
        probed: &[],
        exposure: 1.0,
    };
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

/// Both levels: triangles once, instances in each frame.
fn rays(c: &mut Criterion) {
    let side = 224u32;
    let at = |i: u32| [(i % side) as f32, noise(u64::from(i)) as f32 / u32::MAX as f32, (i / side) as f32];
    let positions: Vec<_> = (0..side * side).map(at).collect();
    let quads = (0..(side - 1) * (side - 1)).map(|i| i / (side - 1) * side + i % (side - 1));
    let indices: Vec<u32> = quads.flat_map(|i| [i, i + 1, i + side, i + 1, i + side + 1, i + side]).collect();
    let mesh = Mesh { name: "terrain", positions: &positions, indices: &indices, attributes: &[], masked: false };
    let mut group = c.benchmark_group("rays");
    group.sample_size(20);
    group.throughput(Throughput::Elements(u64::from(indices.len() as u32 / 3)));
    group.bench_function("bottom level", |b| b.iter(|| BottomLevel::build(black_box(&mesh))));

    let built = BottomLevel::build(&mesh).expect("a sound mesh");
    let gpu = Gpu::new(
        gpu::choose(None).expect("an adapter"),
        &host::descriptor(4, TextureTier::Arrays, RayTier::Software, GBufferTier::default()),
    )
    .expect("a device");
    let (device, queue) = (&gpu.device, &gpu.queue);
    let mut scene = RayScene::new(device, RayTier::Software);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mesh = scene.add(device, queue, &mut encoder, &built).expect("room");
    let mut frame = 0u64;
    group.throughput(Throughput::Elements(1000));
    group.bench_function("top level", |b| {
        b.iter(|| {
            frame += 1;
            let place = |i: u64| noise(i * 1000 + frame % 100) as f32 / u32::MAX as f32 * 100.0;
            let at = |i| Affine3A::from_translation(vec3(place(i), place(i + 1), place(i + 2)));
            let instance = |i| Instance { object: 1, ..Instance::new(mesh, at(i)) };
            let instances: Vec<_> = (0..1000).map(instance).collect();
            scene.update(device, queue, &mut encoder, &instances, Vec3::ZERO)
        });
    });
    group.finish();
}

/// What a frame costs the CPU: to record in a steady state, and from nothing to the first frame.
fn frames(c: &mut Criterion) {
    let descriptor = Descriptor {
        rays: None,
        ..Descriptor::new(
            wgpu::TextureFormat::Rgba16Float,
            Shading { source: "fn shade(s: DaaSample) -> vec4f { return vec4f(s.normal, 1.0); }", file: "bench.wgsl" },
        )
    };
    let gpu = Gpu::new(gpu::choose(None).expect("an adapter"), &descriptor).expect("a device");
    let (device, queue) = (&gpu.device, &gpu.queue);
    let target = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 64, height: 64, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = target.create_view(&wgpu::TextureViewDescriptor::default());
    let camera = Camera {
        world_from_view: Mat4::IDENTITY,
        clip_from_view: glam::camera::rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1),
    };
    let frame =
        |technique| Frame { settings: Settings { technique, ..Settings::default() }, ..Frame::new(camera, &view) };
    let node = || {
        let mut aa = DeferredAa::new(device, &descriptor, None).expect("a node");
        aa.resize(device, 64, 64).expect("a size");
        aa
    };
    let record = |aa: &mut DeferredAa, technique| {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        aa.record(queue, &mut encoder, &frame(technique)).expect("a frame");
        encoder.finish()
    };
    let mut group = c.benchmark_group("frame");
    let recorded =
        [Technique::Single, Technique::Windowed, Technique::Selective, Technique::MultiResolution, Technique::Surfaces];
    for technique in recorded {
        let mut aa = node();
        queue.submit([record(&mut aa, technique)]);
        group.bench_function(format!("record/{technique:?}"), |b| {
            b.iter(|| {
                // Not submitted: what the driver does with it is not what is measured.
                drop(record(&mut aa, technique));
                queue.submit([])
            });
        });
        gpu.wait();
    }
    group.sample_size(10);
    for technique in [Technique::Windowed, Technique::MultiResolution, Technique::Surfaces] {
        group.bench_function(format!("cold start/{technique:?}"), |b| {
            b.iter(|| queue.submit([record(&mut node(), technique)]));
        });
        gpu.wait();
    }
    group.finish();
}

criterion_group!(benches, shading, twins, rays, frames);
criterion_main!(benches);
