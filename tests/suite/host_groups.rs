//! What the host binds itself: two groups, their dynamic offsets, and textures beside the G-buffer.

use crate::harness::{self, Sample, fill};
use deferred_aa::{
    BuildError, DeferredAa, Descriptor, Frame, RecordError, Settings, Shading, Technique, TextureTier, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use wgpu::TextureFormat::Rgba32Float;

const WIDTH: u32 = 13;
const HEIGHT: u32 = 7;

/// Each sample's `user` is the place of its texel, so that the hook can tell whether `texel` is right. The factors come
/// from two groups. Passes of the host's own stand beside it.
const SHADING: &str = "
@group(2) @binding(0) var<uniform> factor: vec4f;
@group(1) @binding(3) var<storage, read> second: array<f32>;
fn shade(s: DaaSample) -> vec4f {
    let right = s.user == (s.texel.x | (s.texel.y << 16u));
    return vec4f(select(0.0, 1.0, right)) * factor * second[0];
}
@compute @workgroup_size(8) fn main(@builtin(global_invocation_id) id: vec3u) { if id.x > 0u { return; } }
struct Varyings { @builtin(position) clip: vec4f, @location(0) uv: vec2f }
@vertex fn vertex(@builtin(vertex_index) i: u32) -> Varyings { return Varyings(vec4f(f32(i)), vec2f(0.0)); }
@fragment fn fragment(v: Varyings) -> @location(0) vec4f { return dpdx(vec4f(v.uv, 0.0, 1.0)) * factor; }";

fn layout(gpu: &Gpu, binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: true, min_binding_size: wgpu::BufferSize::new(16) },
            count: None,
        }],
    })
}

/// A buffer with one value at 0 and another at 256, bound 16 bytes at a time.
fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    binding: u32,
    usage: wgpu::BufferUsages,
    values: [f32; 2],
) -> wgpu::BindGroup {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 512,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    for (value, at) in values.into_iter().zip([0, 256]) {
        gpu.queue.write_buffer(&buffer, at, bytemuck::bytes_of(&[value; 4]));
    }
    let resource = wgpu::BufferBinding { buffer: &buffer, offset: 0, size: wgpu::BufferSize::new(16) };
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::Buffer(resource) }],
    })
}

fn descriptor(m: u32, textures: TextureTier) -> Descriptor<'static> {
    let shading = Shading { source: SHADING, file: "test.wgsl" };
    Descriptor { m, textures, ..Descriptor::new(Rgba32Float, shading) }
}

#[test]
fn every_technique_knows_its_texel_and_both_groups_with_their_offsets() {
    let gpu = harness::device(TextureTier::None);
    let layouts = [
        layout(&gpu, 0, wgpu::BufferBindingType::Uniform),
        layout(&gpu, 3, wgpu::BufferBindingType::Storage { read_only: true }),
    ];
    let first = group(&gpu, &layouts[0], 0, wgpu::BufferUsages::UNIFORM, [0.5, 3.0]);
    let second = group(&gpu, &layouts[1], 3, wgpu::BufferUsages::STORAGE, [0.25, 7.0]);
    let target = harness::target(&gpu, Rgba32Float, [WIDTH, HEIGHT]);
    let view = target.create_view(&Default::default());
    let [layout, other] = layouts.each_ref().map(Some);
    for m in [1, 2, 3] {
        let mut aa =
            DeferredAa::with_groups(&gpu.device, &descriptor(m, TextureTier::None), [layout, other]).expect("a node");
        aa.resize(&gpu.device, WIDTH, HEIGHT).expect("a size");
        // Busy, so that windows shade more than their first sample.
        let object = |x: u32, y: u32| 1 + (x / 2 + y / 3) % 5;
        let sample = |x, y| Sample { user: x | y << 16, object: object(x, y), ..Sample::default() };
        fill(&gpu, aa.gbuffer().expect("a size"), sample);
        for (technique, offsets, expected) in Technique::ALL
            .into_iter()
            .flat_map(|technique| [([0, 0], 0.125), ([256, 0], 0.75), ([0, 256], 3.5)].map(|(o, e)| (technique, o, e)))
        {
            let [a, b] = offsets.map(|offset| [offset]);
            let frame = Frame {
                settings: Settings { technique, ..Settings::default() },
                host_bind_group: Some(&first),
                second_bind_group: Some(&second),
                host_offsets: [&a, &b],
                ..Frame::new(harness::camera(WIDTH as f32 / HEIGHT as f32), &view)
            };
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            aa.record(&gpu.queue, &mut encoder, &frame).expect("a frame");
            gpu.queue.submit([encoder.finish()]);
            gpu.wait();
            let image: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&gpu.read_texture(&target, 16));
            for (i, pixel) in image.iter().enumerate() {
                let near = pixel[..3].iter().all(|c| (c - expected).abs() <= 1e-6 * expected);
                assert!(near, "{technique:?}, m = {m}, offsets {offsets:?}: pixel {i} is {pixel:?}, not {expected}");
            }
        }
        assert_eq!(gpu.take_errors(), Vec::<String>::new());

        let frame =
            Frame { host_bind_group: Some(&first), ..Frame::new(harness::camera(WIDTH as f32 / HEIGHT as f32), &view) };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        assert_eq!(aa.record(&gpu.queue, &mut encoder, &frame), Err(RecordError::SecondBindGroup));
    }
}

#[test]
fn a_texture_table_leaves_the_host_one_group() {
    let gpu = harness::device(TextureTier::None);
    let [first, second] = [0, 3].map(|binding| layout(&gpu, binding, wgpu::BufferBindingType::Uniform));
    let source =
        "@group(2) @binding(0) var<uniform> factor: vec4f;\nfn shade(s: DaaSample) -> vec4f { return factor; }";
    let shading = Shading { source, file: "test.wgsl" };
    let with_table = Descriptor { shading, ..descriptor(2, TextureTier::Arrays) };
    let built = DeferredAa::with_groups(&gpu.device, &with_table, [Some(&first), Some(&second)]).map(drop);
    assert_eq!(built, Err(BuildError::SecondGroup));
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}
