//! The contract of the API: what is refused and how it is said, what is recorded, and what a frame leaves behind.

use crate::harness::{self, Rig, SHOW_USER, Sample, WHITE, fill, noise, rgba8};
use deferred_aa::glam::{Mat4, Vec2, Vec3, Vec4, camera::rh::proj::directx};
use deferred_aa::{
    BuildError, Camera, DebugView, DeferredAa, Descriptor, Execution, Frame, GBufferTier, InputMistake, LendError,
    Needs, Normal, Part, PipelineError, RecordError, Resource, Settings, SettingsError, Shading, SizeError, TableError,
    Technique, TextureTier, Windowed, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use insta::assert_snapshot;
use wgpu::TextureFormat::{self, *};

const WIDTH: u32 = 21;
const HEIGHT: u32 = 13;

/// Every way to make an image.
const WAYS: [(Technique, Execution); 11] = [
    (Technique::Full, Execution::Loop),
    (Technique::Single, Execution::Loop),
    (Technique::Windowed, Execution::Loop),
    (Technique::Windowed, Execution::Tiled),
    (Technique::Windowed, Execution::Bucketed),
    (Technique::Windowed, Execution::Sorted),
    (Technique::Windowed, Execution::MaxFiltered),
    (Technique::Windowed, Execution::Packed),
    (Technique::Selective, Execution::Loop),
    (Technique::MultiResolution, Execution::Sorted),
    (Technique::Surfaces, Execution::Loop),
];

fn way((technique, execution): (Technique, Execution)) -> Settings {
    Settings { technique, execution, ..Default::default() }
}

fn descriptor(m: u32, target_format: TextureFormat, source: &str) -> Descriptor<'_> {
    let shading = Shading { source, file: "test.wgsl" };
    Descriptor {
        m,
        target_format,
        shading,
        textures: TextureTier::None,
        texture_capacity: 0,
        rays: None,
        gbuffer: GBufferTier::default(),
    }
}

fn node(gpu: &Gpu, m: u32, format: TextureFormat, source: &str) -> DeferredAa {
    let mut aa = DeferredAa::new(&gpu.device, &descriptor(m, format, source), None).expect("a node");
    aa.resize(&gpu.device, WIDTH, HEIGHT).expect("a size");
    fill(gpu, aa.gbuffer().expect("a size"), busy);
    aa
}

fn texture(gpu: &Gpu, format: TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A target and its view.
fn target(gpu: &Gpu, format: TextureFormat) -> (wgpu::Texture, wgpu::TextureView) {
    use wgpu::TextureUsages as Usage;
    let texture = texture(gpu, format, Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC);
    let view = texture.create_view(&Default::default());
    (texture, view)
}

fn frame(target: &wgpu::TextureView, settings: Settings) -> Frame<'_> {
    Frame {
        camera: harness::camera(WIDTH as f32 / HEIGHT as f32),
        settings,
        exposure: 1.0,
        host_bind_group: None,
        second_bind_group: None,
        host_offsets: [&[]; 2],
        textures: None,
        target,
        depth: None,
        viewport: None,
        band: None,
        needs: Needs::default(),
        statistics: true,
    }
}

/// Hosts move nodes between threads, and share them behind locks.
#[test]
fn what_a_host_holds_is_send_and_sync() {
    fn both<T: Send + Sync>() {}
    both::<DeferredAa>();
    both::<deferred_aa::TextureTable>();
    both::<deferred_aa::rays::RayScene>();
    both::<RecordError>();
    both::<BuildError>();
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&Default::default())
}

fn submit(gpu: &Gpu, encoder: wgpu::CommandEncoder) {
    gpu.queue.submit([encoder.finish()]);
    gpu.wait();
}

/// The result of recording into an encoder that is thrown away.
fn refused(gpu: &Gpu, aa: &mut DeferredAa, frame: &Frame<'_>) -> RecordError {
    aa.record(&gpu.queue, &mut encoder(gpu), frame).expect_err("a refusal")
}

fn no_errors(gpu: &Gpu) {
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

/// Objects, edges, bent normals, noise and sky: windows of every k.
fn busy(x: u32, y: u32) -> Sample {
    let object = 1 + x / 11 + y / 7 * 9;
    if object % 6 == 5 {
        return Sample::SKY;
    }
    let bend = noise(object + 100) * 0.1;
    Sample {
        depth: 0.02 + noise(object) * 0.2 + x as f32 * 1e-5,
        normal: Vec3::new((x as f32 * bend).sin(), (y as f32 * bend).cos() * 0.5, 1.0).normalize(),
        uv: Vec2::new(x as f32, y as f32) * 0.01,
        material: object % 3,
        object,
        user: rgba8(noise(object * 3), noise(object * 5), noise(x / 3 + y * 977), 1.0),
        ..Default::default()
    }
}

/// A texture of any float format as the GPU reads it.
fn read(gpu: &Gpu, texture: &wgpu::Texture) -> Vec<[f32; 4]> {
    const READ: &str = "
        @group(0) @binding(0) var image: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read_write> texels: array<vec4f>;
        @compute @workgroup_size(1) fn read(@builtin(global_invocation_id) id: vec3u) {
            texels[id.y * textureDimensions(image).x + id.x] = textureLoad(image, id.xy, 0);
        }";
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(READ.into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let texels = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(WIDTH * HEIGHT * 16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let view = texture.create_view(&Default::default());
    let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
            wgpu::BindGroupEntry { binding: 1, resource: texels.as_entire_binding() },
        ],
    });
    let mut encoder = encoder(gpu);
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bind_group, &[]);
    pass.dispatch_workgroups(WIDTH, HEIGHT, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&gpu.read_buffer(&texels))
}

/// One frame into a target of its own.
fn render(gpu: &Gpu, aa: &mut DeferredAa, format: TextureFormat, settings: Settings) -> Vec<[f32; 4]> {
    let (image, view) = target(gpu, format);
    let mut encoder = encoder(gpu);
    aa.record(&gpu.queue, &mut encoder, &frame(&view, settings)).expect("a frame");
    submit(gpu, encoder);
    read(gpu, &image)
}

fn bits(image: &[[f32; 4]]) -> Vec<[u32; 4]> {
    image.iter().map(|t| t.map(f32::to_bits)).collect()
}

#[test]
fn requirements_name_what_is_missing() {
    let adapter = harness::device(TextureTier::None).adapter;
    let sound = DeferredAa::requirements(&adapter, &descriptor(4, Rgba16Float, WHITE));
    assert_eq!(sound.missing, Vec::<String>::new());
    assert!(!sound.features.intersects(deferred_aa::BINDING_FEATURES), "{:?}", sound.features);
    assert_eq!(sound.limits, wgpu::Limits::default());

    let format = DeferredAa::requirements(&adapter, &descriptor(4, Rgb9e5Ufloat, WHITE));
    assert_eq!(format.missing, ["rendering to Rgb9e5Ufloat"]);

    let endless =
        Descriptor { textures: TextureTier::Bindings, texture_capacity: u32::MAX, ..descriptor(4, Rgba16Float, WHITE) };
    let endless = DeferredAa::requirements(&adapter, &endless);
    let limit = "limit max_binding_array_elements_per_shader_stage = 4294967295 (it has ";
    assert!(endless.missing.iter().any(|m| m.starts_with(limit)), "{:?}", endless.missing);
}

#[test]
fn requirements_foretell_the_memory() {
    for m in [1, 4, 7] {
        let gpu = harness::device(TextureTier::None);
        let requirements = DeferredAa::requirements(&gpu.adapter, &descriptor(m, Rgba8Unorm, WHITE));
        let foretold = requirements.memory(WIDTH, HEIGHT, &Settings::default(), &Needs::default());
        let mut aa = DeferredAa::new(&gpu.device, &descriptor(m, Rgba8Unorm, WHITE), None).expect("a node");
        let memory = aa.memory();
        assert_eq!((memory.gbuffer, memory.scratch), (0, 0));
        aa.resize(&gpu.device, WIDTH, HEIGHT).expect("a size");
        render(&gpu, &mut aa, Rgba8Unorm, Settings::default());
        assert_eq!(aa.memory(), foretold);
        assert_eq!(foretold.gbuffer, u64::from(WIDTH * HEIGHT * m * m) * 36);
        // Sizes that no node takes are no reason to panic.
        let settings = Settings { goal: Some(deferred_aa::Goal::Error(0.01)), ..Settings::default() };
        for [width, height] in [[0, 0], [1, u32::MAX], [u32::MAX, 1], [u32::MAX; 2]] {
            requirements.memory(width, height, &settings, &Needs::default());
        }
    }
}

#[test]
fn new_refuses() {
    let gpu = harness::device(TextureTier::None);
    let new = |d: &Descriptor<'_>| DeferredAa::new(&gpu.device, d, None).expect_err("a refusal");
    for m in [0, 9, u32::MAX] {
        assert_eq!(new(&descriptor(m, Rgba8Unorm, WHITE)), BuildError::WindowSize(m));
    }
    // No colour, an integer, a depth, compressed, a float that only textures have.
    for format in [Rgba8Uint, R32Sint, Depth32Float, Depth24PlusStencil8, Bc1RgbaUnorm, Rgb9e5Ufloat] {
        assert_eq!(new(&descriptor(2, format, WHITE)), BuildError::TargetFormat(format));
    }
    let bindings =
        Descriptor { textures: TextureTier::Bindings, texture_capacity: 64, ..descriptor(2, Rgba8Unorm, WHITE) };
    let BuildError::Missing(missing) = new(&bindings) else { panic!("not missing") };
    let named = ["TEXTURE_BINDING_ARRAY", "NON_UNIFORM_INDEXING", "max_binding_array_elements_per_shader_stage"];
    for name in named {
        assert!(missing.iter().any(|m| m.contains(name)), "{name} in {missing:?}");
    }
    no_errors(&gpu);
}

/// Devices with no more than OpenGL ES 3.1 or WebGL 2 promise, and adapters of the GL backend where there are any.
#[test]
fn lesser_devices_are_refused_by_what_they_lack() {
    let adapter = harness::device(TextureTier::None).adapter;
    for limits in [wgpu::Limits::downlevel_defaults(), wgpu::Limits::downlevel_webgl2_defaults()] {
        let gpu = Gpu::with(adapter.clone(), wgpu::Features::empty(), limits).expect("a device");
        let refused = DeferredAa::new(&gpu.device, &descriptor(2, Rgba8Unorm, WHITE), None).expect_err("a refusal");
        let BuildError::Missing(missing) = refused else { panic!("{refused}") };
        assert!(missing.iter().any(|m| m.contains("max_storage_buffers_per_shader_stage = 8")), "{missing:?}");
        no_errors(&gpu);
    }
    let mut wanted = wgpu::InstanceDescriptor::new_without_display_handle();
    wanted.backends = wgpu::Backends::GL;
    let adapters = pollster::block_on(wgpu::Instance::new(wanted).enumerate_adapters(wgpu::Backends::GL));
    if adapters.is_empty() {
        eprintln!("GL skipped: wgpu finds no adapter");
    }
    for adapter in adapters {
        let missing = DeferredAa::requirements(&adapter, &descriptor(2, Rgba8Unorm, WHITE)).missing;
        assert!(missing.iter().any(|m| m.contains("a backend other than GL")), "{missing:?}");
        let Ok(gpu) = Gpu::with(adapter, wgpu::Features::empty(), wgpu::Limits::downlevel_defaults()) else { continue };
        let refused = DeferredAa::new(&gpu.device, &descriptor(2, Rgba8Unorm, WHITE), None).expect_err("a refusal");
        assert!(refused.to_string().contains("a backend other than GL"), "{refused}");
    }
}

/// Every way in which the host's layout can miss its WGSL comes back as an error, and wgpu's own handler hears nothing.
#[test]
fn a_layout_that_does_not_fit_is_a_pipeline_error() {
    let gpu = harness::device(TextureTier::None);
    let source = "@group(2) @binding(0) var<uniform> tint: vec4f;\nfn shade(s: DaaSample) -> vec4f { return tint; }";
    let layout = |binding, visibility, ty, size| {
        gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding,
                visibility,
                ty: wgpu::BindingType::Buffer {
                    ty,
                    has_dynamic_offset: false,
                    min_binding_size: wgpu::BufferSize::new(size),
                },
                count: None,
            }],
        })
    };
    let (compute, uniform) = (wgpu::ShaderStages::COMPUTE, wgpu::BufferBindingType::Uniform);
    let wrong = [
        layout(1, compute, uniform, 0),
        layout(0, wgpu::ShaderStages::FRAGMENT, uniform, 0),
        layout(0, compute, wgpu::BufferBindingType::Storage { read_only: true }, 0),
        layout(0, compute, uniform, 8),
    ];
    let new = |layout| DeferredAa::new(&gpu.device, &descriptor(2, Rgba8Unorm, source), layout).map(|_| ());
    for layout in wrong.iter().map(Some).chain([None]) {
        let Err(BuildError::Pipeline(e)) = new(layout) else { panic!("{layout:?}") };
        assert_eq!(e.pass, "first");
        let text = e.to_string();
        assert!(
            text.ends_with("; compare the host's bind group layout with its WGSL") && !text.contains('\n'),
            "{text}"
        );
    }
    assert_eq!(new(Some(&layout(0, compute, uniform, 0))), Ok(()));
    no_errors(&gpu);
}

#[test]
fn resize_refuses_and_keeps_the_old_size() {
    let gpu = harness::device(TextureTier::None);
    let mut aa = node(&gpu, 3, Rgba8Unorm, WHITE);
    let limit = gpu.device.limits().max_texture_dimension_2d;
    let before = aa.memory();
    for (width, height) in [(0, 0), (0, HEIGHT), (WIDTH, 0)] {
        assert_eq!(aa.resize(&gpu.device, width, height), Err(SizeError::Empty { width, height }));
    }
    for (width, height) in [(limit / 3 + 1, 1), (1, limit / 3 + 1), (u32::MAX, 1), (1, u32::MAX)] {
        let too_large = SizeError::TooLarge { width, height, m: 3, limit };
        assert_eq!(aa.resize(&gpu.device, width, height), Err(too_large.clone()));
        assert!(!too_large.to_string().is_empty(), "no overflow in the text");
    }
    assert_eq!(aa.memory(), before);
    assert_eq!(aa.gbuffer().map(|g| (g.width, g.height)), Some((WIDTH * 3, HEIGHT * 3)));
    render(&gpu, &mut aa, Rgba8Unorm, Settings::default());

    // A plan of 8192² words is more than a buffer of default limits; nothing of it is allocated.
    let mut aa = DeferredAa::new(&gpu.device, &descriptor(1, Rgba8Unorm, WHITE), None).expect("a node");
    let size = SizeError::Buffer { width: 8192, height: 8192, bytes: 1 << 28, limit: 1 << 27 };
    assert_eq!(aa.resize(&gpu.device, 8192, 8192), Err(size));
    assert!(aa.gbuffer().is_none());
    no_errors(&gpu);
}

#[test]
fn record_refuses_a_wrong_target() {
    let gpu = harness::device(TextureTier::None);
    let mut aa = DeferredAa::new(&gpu.device, &descriptor(2, Rgba8Unorm, WHITE), None).expect("a node");
    let (_, view) = target(&gpu, Rgba8Unorm);
    assert_eq!(refused(&gpu, &mut aa, &frame(&view, Settings::default())), RecordError::NoSize);

    aa.resize(&gpu.device, WIDTH + 1, HEIGHT).expect("a size");
    let (target_width, target_height, width, height) = (WIDTH, HEIGHT, WIDTH + 1, HEIGHT);
    let size = RecordError::TargetSize { target_width, target_height, width, height };
    assert_eq!(refused(&gpu, &mut aa, &frame(&view, Settings::default())), size);

    aa.resize(&gpu.device, WIDTH, HEIGHT).expect("a size");
    let (_, other) = target(&gpu, Rgba16Float);
    let format = RecordError::TargetFormat { target: Rgba16Float, node: Rgba8Unorm };
    assert_eq!(refused(&gpu, &mut aa, &frame(&other, Settings::default())), format);

    let view = texture(&gpu, Rgba8Unorm, wgpu::TextureUsages::TEXTURE_BINDING).create_view(&Default::default());
    assert_eq!(refused(&gpu, &mut aa, &frame(&view, Settings::default())), RecordError::TargetUsage);

    let with = |samples: u32, mips: u32| {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: WIDTH * mips, height: HEIGHT * mips, depth_or_array_layers: 1 },
            mip_level_count: mips,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format: Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        texture.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: mips - 1,
            mip_level_count: Some(1),
            ..Default::default()
        })
    };
    let samples = refused(&gpu, &mut aa, &frame(&with(4, 1), Settings::default()));
    assert_eq!(samples, RecordError::TargetSamples(4));
    // Its second level has the node's size; after a resize none has.
    let mipped = with(1, 2);
    aa.record(&gpu.queue, &mut encoder(&gpu), &frame(&mipped, Settings::default())).expect("a frame");
    aa.resize(&gpu.device, WIDTH + 1, HEIGHT).expect("a size");
    let (target_width, target_height) = (2 * WIDTH, 2 * HEIGHT);
    let stale = RecordError::TargetSize { target_width, target_height, width: WIDTH + 1, height: HEIGHT };
    assert_eq!(refused(&gpu, &mut aa, &frame(&mipped, Settings::default())), stale);
    no_errors(&gpu);
}

#[test]
fn record_refuses_without_what_the_host_binds() {
    let gpu = harness::device(TextureTier::None);
    let (_, view) = target(&gpu, Rgba8Unorm);
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &[] });
    let mut aa = DeferredAa::new(&gpu.device, &descriptor(2, Rgba8Unorm, WHITE), Some(&layout)).expect("a node");
    aa.resize(&gpu.device, WIDTH, HEIGHT).expect("a size");
    assert_eq!(refused(&gpu, &mut aa, &frame(&view, Settings::default())), RecordError::HostBindGroup);

    let with_table = Descriptor { textures: TextureTier::Arrays, ..descriptor(2, Rgba8Unorm, WHITE) };
    let mut aa = DeferredAa::new(&gpu.device, &with_table, None).expect("a node");
    aa.resize(&gpu.device, WIDTH, HEIGHT).expect("a size");
    assert_eq!(refused(&gpu, &mut aa, &frame(&view, Settings::default())), RecordError::Textures);
    no_errors(&gpu);
}

#[test]
fn record_refuses_what_has_no_picture() {
    let gpu = harness::device(TextureTier::None);
    let mut aa = node(&gpu, 2, Rgba8Unorm, WHITE);
    let (_, view) = target(&gpu, Rgba8Unorm);
    let sound = frame(&view, Settings::default());
    let nan = Mat4::from_cols_array(&[f32::NAN; 16]);
    let projections = [
        Mat4::ZERO,
        nan,
        Mat4::from_diagonal(Vec4::new(1.0, 0.0, 1.0, 1.0)),
        directx::perspective_infinite_reverse(0.0, 1.0, 0.1),
        directx::perspective_infinite_reverse(1.0, 0.0, 0.1),
        directx::perspective_infinite_reverse(1.0, 1.0, 0.0),
        directx::orthographic(1.0, 1.0, -1.0, 1.0, 10.0, 0.1),
    ];
    for clip_from_view in projections {
        let camera = Camera { clip_from_view, ..sound.camera };
        let e = refused(&gpu, &mut aa, &Frame { camera, ..sound });
        assert_eq!(e, RecordError::Camera("projection"), "{clip_from_view}");
    }
    let mut lost = Mat4::IDENTITY;
    lost.w_axis.y = f32::INFINITY;
    for world_from_view in [Mat4::ZERO, nan, lost, Mat4::from_scale(Vec3::new(1.0, 1.0, 0.0))] {
        let camera = Camera { world_from_view, ..sound.camera };
        assert_eq!(refused(&gpu, &mut aa, &Frame { camera, ..sound }), RecordError::Camera("view"));
    }
    for exposure in [0.0, -1.0, f32::INFINITY, f32::NAN] {
        let e = refused(&gpu, &mut aa, &Frame { exposure, ..sound });
        assert!(matches!(e, RecordError::Exposure(v) if v.to_bits() == exposure.to_bits()), "{e:?}");
    }
    no_errors(&gpu);
}

#[test]
fn settings_name_the_field() {
    type Set = fn(&mut Windowed, f32);
    let fields: [(&str, f32, Set); 8] = [
        ("windowed.depth_scale", 1e9, |w, v| w.depth_scale = v),
        ("windowed.normal_scale", 1e6, |w, v| w.normal_scale = v),
        ("windowed.luminance_scale", 1e6, |w, v| w.luminance_scale = v),
        ("windowed.luminance_min", 1e6, |w, v| w.luminance_min = v),
        ("windowed.luminance_edge", 1.0, |w, v| w.luminance_edge = v),
        ("windowed.identity_samples", 64.0, |w, v| w.identity_samples = v),
        ("windowed.shadow_samples", 64.0, |w, v| w.shadow_samples = v),
        ("windowed.user_scale", 1e6, |w, v| w.user_scale = v),
    ];
    for (field, most, set) in fields {
        let with = |value| {
            let mut settings = Settings::default();
            set(&mut settings.windowed, value);
            settings.validate()
        };
        for value in [f32::NAN, f32::NEG_INFINITY, -1e-6, most * 1.0001, f32::INFINITY] {
            let e = with(value).expect_err(field);
            assert_eq!((e.field, e.value.to_bits(), e.least, e.most), (field, value.to_bits(), 0.0, most));
        }
        for value in [0.0, -0.0, most] {
            assert_eq!(with(value), Ok(()), "{field} = {value}");
        }
    }
    let tiles = |tile_limit| {
        let windowed = Windowed { tile_limit, ..Default::default() };
        Settings { windowed, ..Default::default() }.validate()
    };
    let e = tiles(Windowed::NO_TILE_LIMIT + 1).expect_err("one too many");
    assert_eq!((e.field, e.value, e.most), ("windowed.tile_limit", 4033.0, 4032.0));
    assert_eq!(tiles(u32::MAX).map_err(|e| e.field), Err("windowed.tile_limit"));
    assert_eq!(tiles(0), Ok(()));

    // And a frame is refused with the same error.
    let gpu = harness::device(TextureTier::None);
    let mut aa = node(&gpu, 2, Rgba8Unorm, WHITE);
    let (_, view) = target(&gpu, Rgba8Unorm);
    let windowed = Windowed { luminance_edge: 2.0, ..Default::default() };
    let settings = Settings { windowed, ..Default::default() };
    let same = RecordError::Settings(settings.validate().expect_err("out of range"));
    assert_eq!(refused(&gpu, &mut aa, &frame(&view, settings)), same);
    assert_eq!(aa.warm_up(&settings, &Needs::default()), Err(same));
}

#[test]
fn every_view_renders_on_every_way() {
    let mut rig = Rig::new(3, WIDTH, HEIGHT, SHOW_USER);
    rig.fill(busy);
    for view in DebugView::ALL {
        let images = WAYS.map(|w| rig.run(Settings { view, ..way(w) }).image);
        for (image, w) in images.iter().zip(WAYS) {
            assert!(image.iter().flatten().all(|c| (0.0..=1.0).contains(c)), "{view:?} {w:?}");
        }
        // What is read from the G-buffer does not depend on how it is sampled.
        let of_one = match view {
            DebugView::Quadrants => Some(Technique::Selective),
            DebugView::Levels => Some(Technique::MultiResolution),
            DebugView::Taps => Some(Technique::Surfaces),
            _ => None,
        };
        if let Some(technique) = of_one {
            let lit = |image: &Vec<[f32; 4]>| image.iter().any(|t| t[..3] != [0.0; 3]);
            assert!(images.iter().zip(WAYS).all(|(image, w)| lit(image) == (w.0 == technique)));
        } else if matches!(view, DebugView::Tiles | DebugView::Shadows | DebugView::Rays) {
            // Nothing is traced here.
            assert!(images.iter().flatten().all(|t| t[..3] == [0.0; 3]), "{view:?}");
        } else if view as u32 > DebugView::First as u32 {
            assert!(images.iter().all(|image| bits(image) == bits(&images[0])), "{view:?}");
            let lit = images[0].iter().filter(|t| t[..3] != [0.0; 3]).count();
            assert!(lit > 0 || matches!(view, DebugView::Gradient), "{view:?} is black");
        }
    }
}

#[test]
fn passes_come_in_order_and_read_what_is_written() {
    let names =
        |settings: &Settings| DeferredAa::passes(settings, &Needs::default()).map(|p| p.info.name).collect::<Vec<_>>();
    let expected: [&[&str]; 6] = [
        &["shade", "resolve"],
        &["first", "resolve"],
        &["first", "metrics", "plan", "shade", "resolve"],
        &["first", "metrics", "plan", "shade", "resolve"],
        &["first", "select", "list", "quadrants", "resolve"],
        &["cover", "light", "resolve"],
    ];
    let ways = WAYS[..4].iter().chain([&WAYS[8], &WAYS[10]]).copied();
    for (w, expected) in ways.zip(expected) {
        assert_eq!(names(&way(w)), expected, "{w:?}");
        for view in DebugView::ALL {
            let settings = Settings { view, ..way(w) };
            let mut written = vec![Resource::GBuffer, Resource::Host];
            for pass in DeferredAa::passes(&settings, &Needs::default()) {
                for read in pass.info.reads.iter() {
                    assert!(
                        written.contains(&read),
                        "{w:?} {view:?}: {} reads {read:?} before it is there",
                        pass.info.name
                    );
                }
                written.extend(pass.info.writes.iter());
            }
            assert_eq!(names(&settings).last(), Some(&if view == DebugView::Image { "resolve" } else { "view" }));
            let targets = DeferredAa::passes(&settings, &Needs::default())
                .filter(|p| p.info.writes.contains(Resource::Target))
                .count();
            assert_eq!(targets, 1);
        }
    }
}

#[test]
fn passes_recorded_one_by_one_are_the_frame() {
    let gpu = harness::device(TextureTier::None);
    for m in [1, 4] {
        let mut aa = node(&gpu, m, Rgba16Float, SHOW_USER);
        for settings in WAYS.map(way) {
            let whole = render(&gpu, &mut aa, Rgba16Float, settings);
            let counted = aa.statistics().expect("statistics").clone();
            let (image, view) = target(&gpu, Rgba16Float);
            let frame = frame(&view, settings);
            let mut encoders: Vec<_> =
                DeferredAa::passes(&settings, &Needs::default()).map(|pass| (pass, encoder(&gpu))).collect();
            let mut before = encoder(&gpu);
            let mut after = encoder(&gpu);
            let recording = aa.begin(&gpu.queue, &mut before, &frame).expect("a frame");
            // Each in an encoder of its own, as a graph may do.
            for (pass, encoder) in &mut encoders {
                recording.record(encoder, *pass).expect("a pass of the frame");
            }
            recording.finish(&gpu.queue, &mut after);
            let all = std::iter::once(before).chain(encoders.into_iter().map(|e| e.1)).chain([after]);
            gpu.queue.submit(all.map(wgpu::CommandEncoder::finish));
            gpu.wait();
            assert_eq!(bits(&read(&gpu, &image)), bits(&whole), "m = {m} {settings:?}");
            let again = aa.statistics().expect("statistics");
            assert_eq!(again.frame, counted.frame + 1);
            assert_eq!((again.shaded, &again.histogram_k), (counted.shaded, &counted.histogram_k));
        }
    }
    no_errors(&gpu);
}

#[test]
fn statistics_arrive_when_asked_for() {
    let gpu = harness::device(TextureTier::None);
    let mut aa = node(&gpu, 2, Rgba8Unorm, SHOW_USER);
    let (_, view) = target(&gpu, Rgba8Unorm);
    assert_eq!(aa.statistics(), None);
    let quiet = Frame { statistics: false, ..frame(&view, Settings::default()) };
    let mut silent = encoder(&gpu);
    aa.record(&gpu.queue, &mut silent, &quiet).expect("a frame");
    submit(&gpu, silent);
    assert_eq!(aa.statistics(), None);

    let mut counted = encoder(&gpu);
    aa.record(&gpu.queue, &mut counted, &frame(&view, Settings::default())).expect("a frame");
    assert_eq!(aa.statistics(), None, "before the submit");
    submit(&gpu, counted);
    let statistics = aa.statistics().expect("statistics").clone();
    assert_eq!((statistics.frame, statistics.technique), (2, Technique::Windowed));
    assert_eq!(statistics.histogram_k.iter().sum::<u32>(), WIDTH * HEIGHT);
    assert_eq!(statistics.decided.sum(), u64::from(WIDTH * HEIGHT));
    assert_eq!(statistics.passes.len(), DeferredAa::passes(&Settings::default(), &Needs::default()).count());
    assert_eq!(aa.statistics(), Some(&statistics), "kept until newer ones arrive");
    no_errors(&gpu);
}

#[test]
fn frames_that_are_never_submitted_hold_no_slot() {
    let gpu = harness::device(TextureTier::None);
    let mut aa = node(&gpu, 2, Rgba8Unorm, SHOW_USER);
    let (_, view) = target(&gpu, Rgba8Unorm);
    let frame = frame(&view, Settings::default());
    for i in 0..20 {
        let mut dropped = encoder(&gpu);
        aa.record(&gpu.queue, &mut dropped, &frame).expect("a frame");
        if i % 2 == 0 {
            drop(dropped.finish());
        }
    }
    // Begun and never finished: no slot either.
    for _ in 0..20 {
        let _ = aa.begin(&gpu.queue, &mut encoder(&gpu), &frame).expect("a frame");
    }
    let mut counted = encoder(&gpu);
    aa.record(&gpu.queue, &mut counted, &frame).expect("a frame");
    submit(&gpu, counted);
    assert_eq!(aa.statistics().map(|s| s.frame), Some(41));

    // Frames in flight that nobody waits for take the slots; those that find none go uncounted, and it goes on.
    for _ in 0..12 {
        let mut encoder = encoder(&gpu);
        aa.record(&gpu.queue, &mut encoder, &frame).expect("a frame");
        gpu.queue.submit([encoder.finish()]);
    }
    gpu.wait();
    assert!(aa.statistics().is_some_and(|s| s.frame > 41));
    let mut last = encoder(&gpu);
    aa.record(&gpu.queue, &mut last, &frame).expect("a frame");
    submit(&gpu, last);
    assert_eq!(aa.statistics().map(|s| s.frame), Some(54));
    no_errors(&gpu);
}

/// Counts what lives while a frame is recorded: its encoder keeps alive whatever recording has made.
#[test]
fn a_steady_frame_allocates_nothing() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let name = harness::device(TextureTier::None).adapter.get_info().name;
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let adapter = adapters.into_iter().find(|a| a.get_info().name == name).expect("the tests' adapter");
    let features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
    let gpu = Gpu::with(adapter, features, wgpu::Limits::default()).expect("a device");
    let objects = || {
        let hub = instance.generate_report().expect("a native backend").hub;
        [
            ("buffers", hub.buffers),
            ("textures", hub.textures),
            ("views", hub.texture_views),
            ("samplers", hub.samplers),
            ("bind groups", hub.bind_groups),
            ("bind group layouts", hub.bind_group_layouts),
            ("pipeline layouts", hub.pipeline_layouts),
            ("render pipelines", hub.render_pipelines),
            ("compute pipelines", hub.compute_pipelines),
            ("shader modules", hub.shader_modules),
            ("query sets", hub.query_sets),
        ]
        .map(|(what, report)| (what, report.num_allocated))
    };
    // Memory by label; wgpu's own staging buffers come and go.
    let memory = || {
        let report = gpu.device.generate_allocator_report()?;
        Some(report.allocations.iter().filter(|a| a.name.starts_with("daa")).count())
    };
    let mut aa = node(&gpu, 4, Rgba8Unorm, SHOW_USER);
    let (_, view) = target(&gpu, Rgba8Unorm);
    let settings = |i: usize| Settings { view: DebugView::ALL[i / 4 % 2], ..way(WAYS[i % 4]) };
    let mut run = |i: usize, look: &mut dyn FnMut()| {
        let mut encoder = encoder(&gpu);
        aa.record(&gpu.queue, &mut encoder, &frame(&view, settings(i))).expect("a frame");
        look();
        submit(&gpu, encoder);
        aa.statistics();
    };
    (0..8).for_each(|i| run(i, &mut || {}));
    let before = (objects(), memory());
    (0..50).for_each(|i| run(i, &mut || assert_eq!((objects(), memory()), before, "frame {i}")));

    // The counts would have shown it.
    let size = wgpu::BufferDescriptor {
        label: Some("daa broken"),
        size: 64,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    };
    let _buffer = gpu.device.create_buffer(&size);
    assert_ne!(objects(), before.0);
    assert!(before.1.is_none() || memory() != before.1, "{before:?}");
    no_errors(&gpu);
}

#[test]
fn two_nodes_share_a_device() {
    let gpu = harness::device(TextureTier::None);
    let mut a = node(&gpu, 2, Rgba16Float, SHOW_USER);
    let mut b = node(&gpu, 5, Rgba8Unorm, "fn shade(s: DaaSample) -> vec4f { return vec4f(abs(s.normal), 1.0); }");
    let alone =
        (render(&gpu, &mut a, Rgba16Float, Settings::default()), render(&gpu, &mut b, Rgba8Unorm, Settings::default()));
    let (image_a, view_a) = target(&gpu, Rgba16Float);
    let (image_b, view_b) = target(&gpu, Rgba8Unorm);
    let mut both = encoder(&gpu);
    a.record(&gpu.queue, &mut both, &frame(&view_a, Settings::default())).expect("a frame");
    b.record(&gpu.queue, &mut both, &frame(&view_b, Settings::default())).expect("a frame");
    submit(&gpu, both);
    assert_eq!(bits(&read(&gpu, &image_a)), bits(&alone.0));
    assert_eq!(bits(&read(&gpu, &image_b)), bits(&alone.1));
    no_errors(&gpu);
}

/// As many frames as the ring of uniforms holds, each with other settings, camera and target, in one submit.
#[test]
fn frames_of_one_submit_keep_their_own_constants() {
    const FRAMES: usize = 16;
    let gpu = harness::device(TextureTier::None);
    let mut aa = node(&gpu, 3, Rgba8Unorm, "fn shade(s: DaaSample) -> vec4f { return vec4f(fract(s.position), 1.0); }");
    let (images, views): (Vec<_>, Vec<_>) = (0..FRAMES).map(|_| target(&gpu, Rgba8Unorm)).unzip();
    let nth = |i: usize| {
        let view = DebugView::ALL[[0, 1, 3][i / 4 % 3]];
        let mut frame = frame(&views[i], Settings { view, ..way(WAYS[i % 4]) });
        frame.camera.world_from_view = Mat4::from_translation(Vec3::splat(0.01 * i as f32));
        frame
    };
    let alone: Vec<_> = (0..FRAMES)
        .map(|i| {
            let mut encoder = encoder(&gpu);
            aa.record(&gpu.queue, &mut encoder, &nth(i)).expect("a frame");
            submit(&gpu, encoder);
            bits(&read(&gpu, &images[i]))
        })
        .collect();
    let mut all = encoder(&gpu);
    // Last first, so that no target keeps what it had.
    for i in (0..FRAMES).rev() {
        aa.record(&gpu.queue, &mut all, &nth(i)).expect("a frame");
    }
    submit(&gpu, all);
    for i in 0..FRAMES {
        assert_eq!(bits(&read(&gpu, &images[i])), alone[i], "frame {i}");
        assert_ne!(alone[i], alone[(i + 4) % FRAMES], "frames differ");
    }
    no_errors(&gpu);
}

#[test]
fn every_target_format_holds_the_image() {
    let adapter = harness::device(TextureTier::None).adapter;
    let rg11b10 = adapter.features() & wgpu::Features::RG11B10UFLOAT_RENDERABLE;
    let gpu = Gpu::with(adapter, rg11b10, wgpu::Limits::default()).expect("a device");
    let exact = render(&gpu, &mut node(&gpu, 3, Rgba32Float, SHOW_USER), Rgba32Float, Settings::default());
    let srgb = |c: f32| if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    let plain = |c: f32| c;
    // How far apart in the format's own curve: a step, since drivers round as they like.
    type Format = (TextureFormat, fn(f32) -> f32, [f32; 4]);
    let mut formats: Vec<Format> = vec![
        (Rgba8Unorm, plain, [1.0 / 255.0; 4]),
        (Rgba8UnormSrgb, srgb, [1.0 / 255.0; 4]),
        (Bgra8UnormSrgb, srgb, [1.0 / 255.0; 4]),
        (Rgb10a2Unorm, plain, [1.0 / 1023.0, 1.0 / 1023.0, 1.0 / 1023.0, 1.0 / 3.0]),
        (Rgba16Float, plain, [1.0 / 2048.0; 4]),
        (Rgba32Float, plain, [0.0; 4]),
    ];
    if !rg11b10.is_empty() {
        formats.push((Rg11b10Ufloat, plain, [1.0 / 64.0, 1.0 / 64.0, 1.0 / 32.0, 1.0]));
    }
    for (format, curve, most) in formats {
        let image = render(&gpu, &mut node(&gpu, 3, format, SHOW_USER), format, Settings::default());
        for (i, (a, b)) in image.iter().zip(&exact).enumerate() {
            for c in 0..4 {
                // Alpha has no curve.
                let curve = if c < 3 { curve } else { plain };
                let apart = (curve(a[c]) - curve(b[c])).abs();
                assert!(apart <= most[c], "{format:?} {i}.{c}: {a:?} for {b:?}");
            }
        }
    }
    no_errors(&gpu);
}

#[test]
fn the_same_frame_twice_is_the_same_bits() {
    let gpu = harness::device(TextureTier::None);
    for m in [2, 4, 7] {
        let mut aa = node(&gpu, m, Rgba32Float, SHOW_USER);
        for settings in WAYS.map(way) {
            let first = bits(&render(&gpu, &mut aa, Rgba32Float, settings));
            for _ in 0..3 {
                assert_eq!(bits(&render(&gpu, &mut aa, Rgba32Float, settings)), first, "m = {m} {settings:?}");
            }
        }
    }
    no_errors(&gpu);
}

/// They add the same samples in another order.
#[test]
fn loop_and_tiled_differ_by_one_unit_in_the_last_place() {
    let half = |c: f32| 2f32.powi((c.abs().max(2f32.powi(-14)).log2().floor() as i32) - 10);
    let unorm = |_: f32| 1.001 / 255.0;
    type Unit = fn(f32) -> f32;
    let formats: [(TextureFormat, Unit); 2] = [(Rgba16Float, half), (Rgba8Unorm, unorm)];
    for m in 2..=8 {
        for (format, unit) in formats {
            let mut rig = Rig::with_format(m, WIDTH, HEIGHT, SHOW_USER, format);
            rig.fill(busy);
            let [looped, tiled] = [Execution::Loop, Execution::Tiled].map(|e| rig.run(way((Technique::Windowed, e))));
            assert!(looped.statistics.mean_k > 1.2, "m = {m}: nothing to compare");
            assert_eq!(looped.plan, tiled.plan);
            for (i, (a, b)) in looped.image.iter().zip(&tiled.image).enumerate() {
                for c in 0..4 {
                    let apart = (a[c] - b[c]).abs();
                    assert!(apart <= unit(a[c].max(b[c])), "m = {m} {format:?} {i}.{c}: {a:?} {b:?}");
                }
            }
        }
    }
}

/// What each error says: what is wrong, where, and what to do, in one line.
#[test]
fn texts() {
    assert_snapshot!(BuildError::WindowSize(9), @"m is 9: a window has 1 to 8 samples a side; set Descriptor::m to one of them");
    assert_snapshot!(BuildError::Missing(vec!["feature A".into(), "limit b = 4 (it has 2)".into()]), @"the device lacks feature A, limit b = 4 (it has 2); request Requirements::features and ::limits with it, or choose another tier");
    assert_snapshot!(BuildError::TargetFormat(Rgba8Uint), @"target format Rgba8Uint can't hold a colour image; choose a renderable float or normalised format, such as Rgba8UnormSrgb or Rgba16Float");
    let pipeline = PipelineError { pass: "first", message: "Binding 0 is missing".into() };
    assert_snapshot!(BuildError::Pipeline(pipeline.clone()), @"pass 'first' could not be compiled: Binding 0 is missing; compare the host's bind group layout with its WGSL");
    let (width, height, m) = (1920, 1080, 8);
    assert_snapshot!(SizeError::Empty { width: 0, height }, @"0×1080 has no pixels; skip the frame while the window is minimised");
    assert_snapshot!(SizeError::TooLarge { width, height, m, limit: 8192 }, @"1920×1080 at m = 8 needs a G-buffer 15360×8640, the device allows 8192 a side; lower m or the size, divide it with resize_banded, or request a greater max_texture_dimension_2d");
    assert_snapshot!(SizeError::Buffer { width: 8192, height: 8192, bytes: 1 << 28, limit: 1 << 27 }, @"8192×8192 needs a buffer of 268435456 bytes, the device binds 134217728; request a greater max_storage_buffer_binding_size");
    let message = "Not enough memory left.".into();
    assert_snapshot!(SizeError::OutOfMemory { width, height, m, bytes: 4_777_574_400, message }, @"the device has no memory for 4777574400 bytes of 1920×1080 at m = 8: Not enough memory left.; lower m or the size");
    assert_snapshot!(RecordError::NoSize, @"the node has no size yet; call resize before record");
    let settings = SettingsError { field: "windowed.depth_scale", value: -1.0, least: 0.0, most: 1e9 };
    assert_snapshot!(RecordError::Settings(settings), @"windowed.depth_scale is -1, it must lie in 0 to 1000000000");
    assert_snapshot!(RecordError::Settings(SettingsError { value: f32::NAN, ..settings }), @"windowed.depth_scale is NaN, it must lie in 0 to 1000000000");
    assert_snapshot!(RecordError::Camera("projection"), @"the camera's projection is singular or not finite; give it a size above 0 and a near plane above 0");
    assert_snapshot!(RecordError::Camera("view"), @"the camera's view is singular or not finite; world_from_view is a rotation and a translation");
    assert_snapshot!(RecordError::Exposure(0.0), @"exposure is 0; it is a finite factor above 0, 1 if the host has none");
    let (target_width, target_height) = (1280, 720);
    assert_snapshot!(RecordError::TargetSize { target_width, target_height, width, height }, @"the target is 1280×720, the node 1920×1080; call resize with the target's size");
    assert_snapshot!(RecordError::TargetFormat { target: Rgba8Unorm, node: Rgba16Float }, @"the target is Rgba8Unorm, the node writes Rgba16Float; build the node with Descriptor::target_format = Rgba8Unorm");
    assert_snapshot!(RecordError::TargetUsage, @"the target can't be rendered to; create it with TextureUsages::RENDER_ATTACHMENT");
    assert_snapshot!(RecordError::TargetSamples(4), @"the target has 4 samples a pixel, the node writes one; render into a texture with sample_count = 1");
    assert_snapshot!(RecordError::Lent { part: Part::Reflections, lent: 1024, needed: 2048 }, @"Reflections was lent 1024 bytes, this frame needs 2048; lend at least that many bytes, or withdraw the loan");
    assert_snapshot!(RecordError::SecondBindGroup, @"the host's WGSL was built with a second bind group layout, the frame has no second_bind_group; set it");
    assert_snapshot!(BuildError::SecondGroup, @"group 1 is the texture table's; the host's second layout needs TextureTier::None, put its bindings into group 2");
    assert_snapshot!(RecordError::HostBindGroup, @"the host's WGSL was built with a bind group layout, the frame has no host_bind_group; set it");
    assert_snapshot!(RecordError::Textures, @"the node was built with a texture tier, the frame has no table; set Frame::textures, an empty table if there are none");
    let why = "the device binds 134217728".into();
    assert_snapshot!(RecordError::List { execution: Some(Execution::Packed), width, height, m, bytes: 522_547_200, why }, @"Packed at 1920×1080, m = 8 lists up to 522547200 bytes: the device binds 134217728; use Execution::Tiled or Loop, which list nothing");
    assert_snapshot!(RecordError::Pipeline(pipeline), @"pass 'first' could not be compiled: Binding 0 is missing; compare the host's bind group layout with its WGSL");
    let (part, other) = (Part::First, Part::Color);
    assert_snapshot!(LendError::NoSize, @"the node has no size yet; call resize before lend");
    assert_snapshot!(LendError::NotLendable(Part::Counters), @"Counters can't be lent: its content lives across frames, or is the host's already; leave it out");
    assert_snapshot!(LendError::Twice(part), @"First is lent twice; lend it once");
    assert_snapshot!(LendError::Together { part, other }, @"First and Color are lent the same memory, but passes bind both at once; lend each its own");
    assert_snapshot!(LendError::Kind { part, needed: "texture" }, @"First is a texture; lend a texture for it");
    assert_snapshot!(LendError::Format { part, lent: Rgba16Float, needed: Rgba32Float }, @"First is lent a texture of Rgba16Float; it needs Rgba32Float");
    assert_snapshot!(LendError::Extent { part, width, height }, @"First needs a 2D texture of 1920×1080 with one layer, mip level and sample; lend such a texture");
    assert_snapshot!(LendError::TextureUsage { part, missing: wgpu::TextureUsages::STORAGE_BINDING }, @"First is lent a texture without TextureUsages(STORAGE_BINDING); create it with that usage");
    assert_snapshot!(LendError::BufferUsage { part: Part::Plan, missing: wgpu::BufferUsages::STORAGE }, @"Plan is lent a buffer without BufferUsages(STORAGE); create it with that usage");
    assert_snapshot!(LendError::Bytes { part: Part::Plan, lent: 1020, needed: 1024, limit: 1 << 27 }, @"Plan is lent 1020 bytes; it needs 1024, and the device binds 134217728 at most");
    assert_snapshot!(LendError::Refused("TextureView is of another device".into()), @"the device refused: TextureView is of another device; lend resources of the node's own device");
    let (which, share) = (Normal::Shading, 0.75);
    assert_snapshot!(InputMistake::ProjectionNotReversed, @"Frame::camera has a projection whose depth grows with the distance; use a reversed one, 1 at the near plane and 0 far away");
    assert_snapshot!(InputMistake::DepthNotReversed { share }, @"75 % of the samples have a depth above 0.9, near the near plane; render with a reversed projection, clear depth to 0 and compare with Greater");
    assert_snapshot!(InputMistake::DepthOutOfRange { samples: 3 }, @"3 samples have a depth that is not in 0 to 1; write the depth of the rasteriser, with its viewport's 0 to 1");
    assert_snapshot!(InputMistake::NormalsUnset { which, share }, @"DaaFragment::normal is 0 in 75 % of the samples; set it before daa_pack, and write all colour targets");
    assert_snapshot!(InputMistake::NormalsInViewSpace { which, share }, @"DaaFragment::normal is in view space in 75 % of the samples; pass daa_pack a normal in world space");
    assert_snapshot!(InputMistake::NormalsFlipped { which: Normal::Geometric, share }, @"DaaFragment::geometric_normal faces away from the viewer in 75 % of the samples; flip it on back faces, and check that the winding order fits the culling");
    assert_snapshot!(InputMistake::NormalsOff { which, share }, @"DaaFragment::normal is more than 45° off the surface in 75 % of the samples; give daa_pack world space, from -1 to 1 and not from 0 to 1, and Frame::camera the G-buffer's camera");
    assert_snapshot!(InputMistake::GradientsMissing { share }, @"ddx and ddy are 0 in 75 % of the samples whose uv differs; set them to dpdx(uv) and dpdy(uv)");
    assert_snapshot!(InputMistake::GradientsPerPixel { m: 4, share }, @"ddx and ddy are 4 times the change of uv in 75 % of the samples, as if they were per pixel; set them per sample, as dpdx and dpdy return them");
    assert_snapshot!(InputMistake::GradientsOff { share }, @"ddx and ddy do not fit uv in 75 % of the samples; set them to dpdx(uv) and dpdy(uv) of the uv that is packed");
    assert_snapshot!(InputMistake::ObjectsUnset, @"DaaFragment::object is 0 everywhere, though surfaces lie one behind another; give objects that touch ids of their own");
    assert_snapshot!(InputMistake::EncodedTwice { target: Rgba8UnormSrgb }, @"the host's WGSL encodes its radiance (an exponent of 1/2.2 or 1/2.4), and the target is Rgba8UnormSrgb, which encodes again; return linear radiance");
    assert_snapshot!(TableError::Classes { classes: 12, most: 7 }, @"the textures fall into 12 classes of size, format, mip count and sampler, the array tier has 7; resize some to a common size, or use the binding tier");
    assert_snapshot!(TableError::Capacity { textures: 2000, most: 1024 }, @"2000 textures, the table holds 1024; raise Descriptor::texture_capacity");
    assert_snapshot!(TableError::Texture { index: 3, problem: "is multisampled; resolve it first".into() }, @"texture 3 is multisampled; resolve it first");
    assert_snapshot!(TableError::NoTier, @"the node was built without a texture tier; set Descriptor::textures");
}
