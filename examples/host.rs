//! A complete host: renders a fan of blades into the node's G-buffer, shades them with its own WGSL, reads back the image
//! and the statistics, and writes host.png. Run it with `cargo run --example host`.

use deferred_aa::glam::{Mat4, Vec3, camera::rh::proj::directx};
use deferred_aa::wgpu::{self, BindingType, BufferBindingType, util::DeviceExt as _};
use deferred_aa::{Camera, DeferredAa, Descriptor, Frame, GBuffer, Settings, Shading, Statistics};

pub const SIZE: wgpu::Extent3d = wgpu::Extent3d { width: 256, height: 192, depth_or_array_layers: 1 };
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// The host's raster shader, joined with `GBufferTier::pack_wgsl`. `daa_pack` packs each fragment into the G-buffer.
const RASTER: &str = "
@group(0) @binding(0) var<uniform> clip_from_view: mat4x4f;
struct Blade { @builtin(position) clip: vec4f, @location(0) normal: vec3f, @location(1) @interpolate(flat) object: u32 }
@vertex fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) i: u32) -> Blade {
    let along = vec3f(cos(f32(i) * 0.571), sin(f32(i) * 0.571), 0.0);
    let across = normalize(vec3f(-along.y, along.x, 0.6)); // Tilted, so that each blade is lit differently.
    let p = select(along * 1.2 + across * (f32(corner) - 1.5) * 0.4, vec3f(0.0), corner == 0u);
    return Blade(clip_from_view * vec4f(p.xy, p.z - 3.0, 1.0), cross(along, across), i + 1u);
}
@fragment fn fragment(blade: Blade) -> DaaGBuffer {
    var f: DaaFragment;
    f.normal = blade.normal; f.geometric_normal = blade.normal; f.object = blade.object;
    return daa_pack(f);
}";

/// The host's shading. `shaders/contract.wgsl` has everything that it may use.
const SHADING: &str = "
@group(2) @binding(0) var<uniform> to_light: vec4f;
fn shade(s: DaaSample) -> vec4f {
    let hue = 0.5 + 0.5 * cos(f32(s.object) * 1.3 + vec3f(0.0, 2.0, 4.0));
    return vec4f(hue * max(dot(s.normal, to_light.xyz), 0.05), 1.0);
}
fn sky(s: DaaSample) -> vec4f { return vec4f(0.01, 0.015, 0.03, 1.0); }";

pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (image, statistics) = render(Settings::default())?;
    image::save_buffer("host.png", &image, SIZE.width, SIZE.height, image::ColorType::Rgba8)?;
    println!("host.png: {:.2} of 16 samples a pixel; by k: {:?}", statistics.mean_k, statistics.histogram_k);
    Ok(())
}

/// Renders one frame, and returns its RGBA bytes row by row with its statistics.
pub fn render(settings: Settings) -> Result<(Vec<u8>, Statistics), Box<dyn std::error::Error>> {
    // A device with the features and limits that the node needs.
    let node = Descriptor::new(FORMAT, Shading { source: SHADING, file: "SHADING" });
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let needs = DeferredAa::requirements(&adapter, &node);
    assert!(needs.missing.is_empty(), "the adapter lacks {}", needs.missing.join(", "));
    let (required_features, required_limits) = (needs.features, needs.limits);
    let request = wgpu::DeviceDescriptor { required_features, required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&request))?;
    // The node, with the layout of the bind group of SHADING.
    let ty = BindingType::Buffer { ty: BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };
    let entry = wgpu::BindGroupLayoutEntry { binding: 0, visibility: wgpu::ShaderStages::COMPUTE, ty, count: None };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &[entry] });
    let mut aa = DeferredAa::new(&device, &node, Some(&layout))?;
    aa.resize(&device, SIZE.width, SIZE.height)?;
    // The host's own pipeline and uniforms.
    let source = wgpu::ShaderSource::Wgsl([&node.gbuffer.pack_wgsl(), RASTER].join("\n").into());
    let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let options = wgpu::PipelineCompilationOptions::default;
    let targets = &node.gbuffer.color_targets();
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState { module, entry_point: None, compilation_options: options(), buffers: &[] },
        primitive: Default::default(),
        depth_stencil: Some(GBuffer::depth_state()),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState { module, entry_point: None, compilation_options: options(), targets }),
        multiview_mask: None,
        cache: None,
    });
    let bind = |layout: &wgpu::BindGroupLayout, contents: &[u8]| {
        let usage = wgpu::BufferUsages::UNIFORM;
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage });
        let entries = &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }];
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
    };
    let clip_from_view = directx::perspective_infinite_reverse(0.9, SIZE.width as f32 / SIZE.height as f32, 0.1);
    let camera = Camera { world_from_view: Mat4::IDENTITY, clip_from_view };
    let view = bind(&pipeline.get_bind_group_layout(0), bytemuck::bytes_of(&clip_from_view));
    let lighting = bind(&layout, bytemuck::bytes_of(&Vec3::new(0.5, 0.6, 0.7).normalize().extend(0.0)));
    let image = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: SIZE,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    // The frame: the G-buffer, the node's passes, and a copy of the image.
    let mut encoder = device.create_command_encoder(&Default::default());
    let gbuffer = aa.gbuffer().ok_or("resize first")?;
    let color_attachments = &gbuffer.color_attachments();
    let depth_stencil_attachment = Some(gbuffer.depth_attachment());
    let raster = wgpu::RenderPassDescriptor { color_attachments, depth_stencil_attachment, ..Default::default() };
    let mut pass = encoder.begin_render_pass(&raster);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &view, &[]);
    pass.draw(0..3, 0..11);
    drop(pass);
    let (host_bind_group, target) = (Some(&lighting), &image.create_view(&Default::default()));
    let frame = Frame { settings, host_bind_group, statistics: true, ..Frame::new(camera, target) };
    aa.record(&queue, &mut encoder, &frame)?;
    let size = u64::from(SIZE.width * SIZE.height * 4);
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    let copy = device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIZE.width * 4), rows_per_image: None };
    encoder.copy_texture_to_buffer(image.as_image_copy(), wgpu::TexelCopyBufferInfo { buffer: &copy, layout }, SIZE);
    encoder.map_buffer_on_submit(&copy, wgpu::MapMode::Read, .., |_| {});
    queue.submit([encoder.finish()]);
    device.poll(wgpu::PollType::wait_indefinitely())?;
    Ok((copy.get_mapped_range(..)?.to_vec(), aa.statistics().ok_or("no statistics")?.clone()))
}
