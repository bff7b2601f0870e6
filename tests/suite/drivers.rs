//! What drivers differ in, each with the least shader that shows it, and images that they must agree on.
//!
//! Mesa's and SwiftShader's are known. A bound of SwiftShader's own stands beside the test that needs it; what is
//! asserted here says why it is needed.

use crate::harness::{Rig, SHOW_USER, Sample, device, noise, rgba8};
use crate::shadows::{host_with, scene, square, sun};
use crate::textures::{level, mip_ruler};
use deferred_aa::glam::{Mat4, Vec3, vec3, vec4};
use deferred_aa::{GBufferTier, Settings, Technique, TextureTier, wgpu};
use deferred_aa_demo::gpu::Gpu;
use deferred_aa_demo::host::Options;
use deferred_aa_demo::scene::{Camera, Lens, Material, Scene};
use std::env;
use std::process::Command;

/// Whether tests run on SwiftShader.
pub fn is_swiftshader(gpu: &Gpu) -> bool {
    gpu.adapter.get_info().name.contains("SwiftShader")
}

/// The side of what `depths` draws.
const SIDE: u32 = 64;

/// The depth that a triangle leaves, 0 where it is not.
fn depths(gpu: &Gpu, vertex: &str) -> Vec<f32> {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(vertex.into()),
    });
    let format = wgpu::TextureFormat::Depth32Float;
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    });
    let target = crate::harness::target(gpu, format, [SIDE; 2]);
    let view = target.create_view(&Default::default());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.draw(0..3, 0..1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&gpu.read_texture(&target, 4))
}

/// Rasterisers may move corners to a grid, of 2⁻⁴ of a pixel or finer (Vulkan, `subPixelPrecisionBits`).
#[test]
fn corners_of_triangles_lie_on_a_grid() {
    // Depth grows along x. The corners lie on no sub-pixel grid.
    const SOURCE: &str = "
@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    let x = f32(i & 1u) * 4.0 - 1.0 - 0.00051;
    return vec4f(x, f32(i >> 1u) * 4.0 - 1.0 - 0.00137, x * 0.5 + 0.5, 1.0);
}";
    let gpu = device(TextureTier::None);
    // Of a sample's width.
    let error = |(i, depth): (u32, f32)| (depth * SIDE as f32 - ((i % SIDE) as f32 + 0.5)).abs();
    let greatest = (0..).zip(depths(&gpu, SOURCE)).map(error).fold(0.0, f32::max);
    let bounds = if is_swiftshader(&gpu) { 1.0 / 256.0..1.0 / 16.0 } else { 0.0..1.0 / 256.0 };
    assert!(bounds.contains(&greatest), "{greatest}");
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

/// A ground under the eye, up to the horizon. SwiftShader wrongly draws nothing of it from some size on: Vulkan bounds
/// no coordinate before clipping.
#[test]
fn a_ground_of_kilometres_is_drawn() {
    let gpu = device(TextureTier::None);
    for (side, wrong) in [(100.0, false), (2e4, true), (1e6, true)] {
        let source = format!(
            "
@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {{
    let at = array(vec2f(-1.0, 1.0), vec2f(1.0, 1.0), vec2f(0.0, -1.0))[i] * {side:?};
    return vec4f(at.x, -1.7, 0.1, -at.y);
}}"
        );
        let drawn = depths(&gpu, &source).iter().filter(|&&d| d > 0.0).count() as u32;
        let expected = if wrong && is_swiftshader(&gpu) { 0..1 } else { SIDE * SIDE / 3..SIDE * SIDE };
        eprintln!("{side}: {drawn}");
        assert!(expected.contains(&drawn), "{side}: {drawn}");
    }
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

/// The mips of ten that an anisotropic sampler reads for gradients, of a texture that shows its mip.
fn mips_of(gpu: &Gpu, gradients: &[[f32; 4]]) -> Vec<f32> {
    use wgpu::util::DeviceExt as _;
    const SOURCE: &str = "
@group(0) @binding(0) var ruler: texture_2d<f32>;
@group(0) @binding(1) var anisotropic: sampler;
@group(0) @binding(2) var<storage, read> gradients: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> found: array<f32>;
@compute @workgroup_size(1) fn sample(@builtin(global_invocation_id) id: vec3u) {
    let g = gradients[id.x];
    found[id.x] = textureSampleGrad(ruler, anisotropic, vec2f(0.3), g.xy, g.zw).r;
}";
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SOURCE.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("sample"),
        compilation_options: Default::default(),
        cache: None,
    });
    let ruler = mip_ruler(gpu).create_view(&Default::default());
    let linear = wgpu::FilterMode::Linear;
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: linear,
        min_filter: linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: 16,
        ..Default::default()
    });
    let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(gradients),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let found = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: gradients.len() as u64 * 4,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&ruler) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
            wgpu::BindGroupEntry { binding: 2, resource: input.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 3, resource: found.as_entire_binding() },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(gradients.len() as u32, 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let found: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&found));
    found.into_iter().map(|red| level([red, 0.0, 0.0, 0.0])).collect()
}

/// Gradients along one line are an anisotropy without end, which is cut at the sampler's (Vulkan, "Scale Factor
/// Operation"): a tenth of 512 texels is mip 1.7 by 16 probes. Mesa reads it by one probe, blurred, and SwiftShader
/// the finest mip, which aliases.
#[test]
fn parallel_gradients_have_a_mip() {
    let gpu = device(TextureTier::None);
    let gradients = [[1e3, 0.0, 0.0, 1e3], [1e3, 1e3, -1e3, -1e3], [1e3, 0.0, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0]];
    let (coarsest, narrow) = if is_swiftshader(&gpu) { (0.0, 0.0..0.1) } else { (9.0, 1.6..5.8) };
    let found = mips_of(&gpu, &gradients);
    for (found, expected) in found.iter().zip([9.0, coarsest, coarsest]) {
        assert!((found - expected).abs() < 0.1, "{found}, not {expected}");
    }
    assert!(narrow.contains(&found[3]), "{found:?}");
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

/// Squares that face the camera, whose edges lie between samples: every rasteriser covers the same. They cast shadows
/// on each other.
fn theatre() -> (Scene, Camera) {
    let card = |x: f32, y: f32, z: f32, half: f32| {
        let up = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
        Mat4::from_translation(vec3(x, y, z)) * up * Mat4::from_scale(Vec3::splat(half))
    };
    let cards =
        [card(0.0, 0.0, 0.0, 40.0), card(-9.5, 4.0, 3.0, 6.0), card(7.0, -3.5, 5.0, 8.5), card(2.5, 6.5, 8.0, 3.0)];
    let meshes: Vec<_> = (0..4).map(|i| deferred_aa_demo::scene::Mesh { material: i, ..square() }).collect();
    let placed: Vec<_> = cards.into_iter().enumerate().collect();
    let mut made = scene(meshes, &placed);
    let plain = made.materials[0].clone();
    made.materials = [[0.8, 0.8, 0.8], [0.7, 0.2, 0.1], [0.1, 0.5, 0.2], [0.2, 0.3, 0.9]]
        .map(|[r, g, b]| Material { base_color: vec4(r, g, b, 1.0), ..plain.clone() })
        .to_vec();
    made.sun = sun(vec3(0.31, 0.47, 1.0));
    // A unit is a pixel of 48 rows.
    let camera = Camera {
        eye: vec3(0.0, 0.0, 20.0),
        target: Vec3::ZERO,
        lens: Lens::Orthographic { half_height: 24.0, far: 40.0 },
        ..crate::shadows::looking(vec3(0.0, 0.0, 20.0), Vec3::ZERO, 1.0)
    };
    (made, camera)
}

/// Images of every technique in which rasterisers and filters have no say, each by its name.
fn images() -> Vec<(String, Vec<[f32; 4]>)> {
    let mut all = Vec::new();
    for m in [2, 4] {
        let mut rig = Rig::new(m, 64, 48, SHOW_USER);
        rig.fill(|x, y| {
            let object = 1 + x / 21 + y / 17 * 16;
            Sample {
                depth: 0.05 + noise(object) * 0.5 + x as f32 * 1e-5,
                normal: vec3(noise(object + 70) - 0.5, (y as f32 * 0.02).sin() * 0.3, 1.0),
                object,
                user: rgba8(noise(object * 3), noise(object * 5), noise(x / 3 + y * 977), 1.0),
                ..Default::default()
            }
        });
        for technique in Technique::ALL {
            let output = rig.run(Settings { technique, ..Default::default() });
            all.push((format!("samples, m = {m}, {technique:?}"), output.image));
        }
    }
    let (made, camera) = theatre();
    // SwiftShader has no visibility buffer.
    let mut host = host_with(made, Options { gbuffer: GBufferTier::default(), ..Options::new(64, 48, 4) });
    for technique in Technique::ALL {
        // The demo's host asks for as much on SwiftShader.
        let settings = Settings { technique, ray_bias: 0.5, ..Default::default() };
        let statistics = host.frame(&camera, settings).unwrap().statistics;
        assert!(statistics.shadow_rays > 0);
        all.push((format!("theatre, {technique:?}"), host.picture().rgba));
    }
    all
}

/// The file that `images_for_another_process` writes.
const IMAGES: &str = "DEFERRED_AA_IMAGES";
/// Set where the suite runs on another driver than the machine's own: the `VK_DRIVER_FILES` of that, or nothing.
const BESIDE: &str = "DEFERRED_AA_BESIDE";

#[test]
#[ignore = "a part of `drivers_make_the_same_images`"]
fn images_for_another_process() {
    let path = env::var_os(IMAGES).expect("the file to write");
    println!("\nadapter: {}", device(TextureTier::None).adapter.get_info().name);
    let floats: Vec<[f32; 4]> = images().into_iter().flat_map(|(_, image)| image).collect();
    std::fs::write(path, bytemuck::cast_slice(&floats)).expect("a file");
}

/// Peak signal-to-noise ratio in dB of colours from 0 to 1.
fn psnr(a: &[[f32; 4]], b: &[[f32; 4]]) -> f64 {
    let squares = a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |c| f64::from(a[c] - b[c]).powi(2)));
    -10.0 * (squares.sum::<f64>() / (a.len() * 3) as f64).log10()
}

/// On the driver of this run and on the machine's own.
#[test]
fn drivers_make_the_same_images() {
    let Some(beside) = env::var_os(BESIDE) else {
        eprintln!("skipped: `./x test --driver swiftshader` compares two drivers");
        return;
    };
    let path = env::temp_dir().join(format!("deferred-aa-images-{}", std::process::id()));
    let mut other = Command::new(env::current_exe().expect("this test"));
    other.args(["drivers::images_for_another_process", "--exact", "--ignored", "--nocapture"]);
    other.env(IMAGES, &path).env_remove(BESIDE).env_remove("VK_DRIVER_FILES");
    if !beside.is_empty() {
        other.env("VK_DRIVER_FILES", beside);
    }
    let output = other.output().expect("a process");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}");
    let here = device(TextureTier::None).adapter.get_info().name;
    let there = said.lines().find_map(|line| line.strip_prefix("adapter: ")).expect("its adapter");
    assert_ne!(here, there, "the loader has chosen one driver for both");
    let bytes = std::fs::read(&path).expect("what it wrote");
    std::fs::remove_file(&path).expect("its file");
    let theirs: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
    let mut from = 0;
    for (name, image) in images() {
        let db = psnr(&image, &theirs[from..from + image.len()]);
        from += image.len();
        eprintln!("{name}: {db:.1} dB");
        assert!(db >= if name.starts_with("samples") { 140.0 } else { 60.0 }, "{name}: {db}");
    }
    assert_eq!(from, theirs.len());
}
