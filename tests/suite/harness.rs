//! A node on a synthetic G-buffer: samples given by a function, shaded by a hook of the test's own.

use deferred_aa::rays::RayTier;
use deferred_aa::reference::metrics::{Input, Worth};
use deferred_aa::reference::octahedral;
use deferred_aa::{
    BINDING_FEATURES, Band, Camera, DeferredAa, Descriptor, Frame, GBuffer, GBufferTier, InputReport, Needs,
    RecordError, Settings, Shading, Statistics, Technique, TextureTier,
    glam::{DVec3, Mat4, Vec2, Vec3, Vec4, camera::rh::proj::directx},
    wgpu,
};
use deferred_aa_demo::gpu::{self, Gpu};

/// A sample of the G-buffer before packing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Reversed z; 0 is the sky.
    pub depth: f32,
    pub normal: Vec3,
    pub tangent: Vec4,
    pub uv: Vec2,
    pub ddx: Vec2,
    pub ddy: Vec2,
    pub material: u32,
    pub object: u32,
    pub user: u32,
}

impl Default for Sample {
    fn default() -> Self {
        Self {
            depth: 0.1,
            normal: Vec3::Z,
            tangent: Vec4::new(1.0, 0.0, 0.0, 1.0),
            uv: Vec2::ZERO,
            ddx: Vec2::ZERO,
            ddy: Vec2::ZERO,
            material: 0,
            object: 1,
            user: 0,
        }
    }
}

impl Sample {
    pub const SKY: Self = Self {
        depth: 0.0,
        normal: Vec3::Z,
        tangent: Vec4::new(1.0, 0.0, 0.0, 1.0),
        uv: Vec2::ZERO,
        ddx: Vec2::ZERO,
        ddy: Vec2::ZERO,
        material: 0,
        object: 0,
        user: 0,
    };
}

/// A hook that shows the sample's user word as RGBA8 in linear radiance.
pub const SHOW_USER: &str = "fn shade(s: DaaSample) -> vec4f { return unpack4x8unorm(s.user); }";
/// A hook that is 1 everywhere, and 0 in the sky.
pub const WHITE: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(1.0); }";

/// A device for a tier; fails, and does not skip, where there is none.
pub fn device(tier: TextureTier) -> Gpu {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let features = wgpu::Features::TIMESTAMP_QUERY
        | if tier == TextureTier::Bindings { BINDING_FEATURES } else { wgpu::Features::empty() };
    let mut limits = wgpu::Limits::default();
    if tier == TextureTier::Bindings {
        limits.max_binding_array_elements_per_shader_stage = 1024;
        limits.max_binding_array_sampler_elements_per_shader_stage = 32;
    }
    Gpu::with(adapter.clone(), features & adapter.features(), limits).expect("a device")
}

/// Whether the adapter of the tests has binding arrays; says so if not.
pub fn has_bindings() -> bool {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let has = adapter.features().contains(BINDING_FEATURES);
    if !has {
        eprintln!("skipped: the adapter has no binding arrays");
    }
    has
}

/// A node, its target, and what it last made.
pub struct Rig {
    pub gpu: Gpu,
    pub aa: DeferredAa,
    pub size: [u32; 2],
    pub exposure: f32,
    pub camera: Camera,
    /// Of the image, that the G-buffer holds.
    pub band: Option<Band>,
    target: wgpu::Texture,
    view: wgpu::TextureView,
}

/// A frame read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    pub image: Vec<[f32; 4]>,
    pub statistics: Statistics,
    /// Of the pixels in reading order: k, deciding metric, samples before.
    pub plan: Vec<(u32, u32, u32)>,
}

pub fn camera(aspect: f32) -> Camera {
    let clip_from_view = directx::perspective_infinite_reverse(1.0, aspect, 0.1);
    Camera { world_from_view: Mat4::IDENTITY, clip_from_view }
}

/// A target that can be read back.
pub fn target(gpu: &Gpu, format: wgpu::TextureFormat, [width, height]: [u32; 2]) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

impl Rig {
    pub fn new(m: u32, width: u32, height: u32, shading: &str) -> Self {
        Self::with_format(m, width, height, shading, wgpu::TextureFormat::Rgba32Float)
    }

    pub fn with_format(m: u32, width: u32, height: u32, shading: &str, format: wgpu::TextureFormat) -> Self {
        let descriptor = Descriptor {
            m,
            target_format: format,
            shading: Shading { source: shading, file: "test.wgsl" },
            textures: TextureTier::None,
            texture_capacity: 0,
            rays: None,
            gbuffer: GBufferTier::default(),
        };
        Self::of(device(TextureTier::None), &descriptor, [width, height])
    }

    /// One that traces in software.
    pub fn with_rays(m: u32, width: u32, height: u32, shading: &str) -> Self {
        let shading = Shading { source: shading, file: "test.wgsl" };
        let rays = Some(RayTier::Software);
        let descriptor = Descriptor { m, rays, ..Descriptor::new(wgpu::TextureFormat::Rgba32Float, shading) };
        let gpu = Gpu::new(gpu::choose(None).expect("tests need an adapter"), &descriptor).expect("a device");
        Self::of(gpu, &descriptor, [width, height])
    }

    fn of(gpu: Gpu, descriptor: &Descriptor<'_>, [width, height]: [u32; 2]) -> Self {
        let mut aa = DeferredAa::new(&gpu.device, descriptor, None).expect("a node");
        aa.resize(&gpu.device, width, height).expect("a size");
        let target = target(&gpu, descriptor.target_format, [width, height]);
        let view = target.create_view(&Default::default());
        let camera = camera(width as f32 / height as f32);
        Self { gpu, aa, size: [width, height], exposure: 1.0, camera, band: None, target, view }
    }

    /// Writes the G-buffer, sample by sample, through the crate's own packing.
    pub fn fill(&self, sample: impl Fn(u32, u32) -> Sample) {
        fill(&self.gpu, self.aa.gbuffer().expect("a size"), sample);
    }

    pub fn try_record(&mut self, settings: Settings) -> Result<wgpu::CommandBuffer, RecordError> {
        self.try_record_with(settings, Needs::default())
    }

    pub fn try_record_with(
        &mut self,
        settings: Settings,
        needs: Needs<'_>,
    ) -> Result<wgpu::CommandBuffer, RecordError> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let (settings, exposure, statistics) = (settings, self.exposure, true);
        let band = self.band;
        let frame = Frame { needs, settings, exposure, statistics, band, ..Frame::new(self.camera, &self.view) };
        self.aa.record(&self.gpu.queue, &mut encoder, &frame)?;
        Ok(encoder.finish())
    }

    /// Records a check of the input alone.
    pub fn try_check(&mut self) -> Result<wgpu::CommandBuffer, RecordError> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let frame = Frame { band: self.band, ..Frame::new(self.camera, &self.view) };
        self.aa.check_input(&self.gpu.queue, &mut encoder, &frame)?;
        Ok(encoder.finish())
    }

    /// What a check finds.
    pub fn check(&mut self) -> Result<InputReport, RecordError> {
        let commands = self.try_check()?;
        self.gpu.queue.submit([commands]);
        self.gpu.wait();
        assert_eq!(self.gpu.take_errors(), Vec::<String>::new());
        Ok(self.aa.input_report().expect("a report").clone())
    }

    pub fn run(&mut self, settings: Settings) -> Output {
        self.run_with(settings, Needs::default())
    }

    pub fn run_with(&mut self, settings: Settings, needs: Needs<'_>) -> Output {
        let commands = self.try_record_with(settings, needs).expect("a frame");
        self.gpu.queue.submit([commands]);
        self.gpu.wait();
        let statistics = self.aa.statistics().expect("statistics").clone();
        let output = Output { image: self.image(), statistics, plan: self.plan(settings.technique) };
        assert_eq!(self.gpu.take_errors(), Vec::<String>::new());
        output
    }

    /// The target as floats, whatever its format.
    pub fn image(&self) -> Vec<[f32; 4]> {
        match self.target.format() {
            wgpu::TextureFormat::Rgba32Float => bytemuck::pod_collect_to_vec(&self.gpu.read_texture(&self.target, 16)),
            wgpu::TextureFormat::Rgba16Float => {
                let halves: Vec<[u16; 4]> = bytemuck::pod_collect_to_vec(&self.gpu.read_texture(&self.target, 8));
                halves.into_iter().map(|t| t.map(half)).collect()
            }
            wgpu::TextureFormat::Rgba8Unorm | wgpu::TextureFormat::Rgba8UnormSrgb => self
                .gpu
                .read_texture(&self.target, 4)
                .as_chunks::<4>()
                .0
                .iter()
                .map(|t| t.map(|c| f32::from(c) / 255.0))
                .collect(),
            other => panic!("no reader for {other:?}"),
        }
    }

    /// k, the reason, and the active quadrants or, without any, the number of the tile's samples before the window's.
    fn plan(&self, technique: Technique) -> Vec<(u32, u32, u32)> {
        let passed = self.aa.intermediates().expect("a size");
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.gpu.read_buffer(passed.plan));
        let pixels = (0..self.size[1]).flat_map(|y| (0..self.size[0]).map(move |x| (x, y)));
        let word = |(x, y)| words[passed.slots.pixel(x, y)];
        let rest = |w: u32| if technique == Technique::Selective { w >> 16 & 15 } else { w >> 20 };
        pixels.map(word).map(|w| (w & 0xff, w >> 8 & 0xff, rest(w))).collect()
    }

    /// What the metrics read, as the twin takes it.
    pub fn with_input<T>(&self, use_it: impl FnOnce(&Input<'_>) -> T) -> T {
        let gbuffer = self.aa.gbuffer().expect("a size");
        let depth: Vec<f32> = bytemuck::pod_collect_to_vec(&self.gpu.read_texture(gbuffer.depth.texture(), 4));
        let surface: Vec<[u32; 2]> =
            bytemuck::pod_collect_to_vec(&self.gpu.read_texture(gbuffer.color[0].texture(), 8));
        let frame: Vec<[u32; 2]> = bytemuck::pod_collect_to_vec(&self.gpu.read_texture(gbuffer.color[1].texture(), 8));
        let user: Vec<u32> = frame.iter().map(|words| words[1]).collect();
        let passed = self.aa.intermediates().expect("a size");
        let first: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&self.gpu.read_texture(passed.first, 16));
        use_it(&Input {
            m: self.aa.m() as usize,
            width: self.size[0] as usize,
            height: self.size[1] as usize,
            depth: &depth,
            surface: &surface,
            first: &first,
            user: &user,
            shadow: &[],
            probed: &[],
            exposure: self.exposure,
        })
    }

    /// Holds k and the deciding metric of a windowed frame against the twin; returns the twin's.
    pub fn assert_twin_agrees(&self, settings: &Settings, output: &Output) -> Vec<Worth> {
        self.with_input(|input| {
            let worths: Vec<Worth> = (0..input.width * input.height)
                .map(|i| input.worth(i % input.width, i / input.width, &settings.windowed))
                .collect();
            for (i, (worth, &(k, by, _))) in worths.iter().zip(&output.plan).enumerate() {
                if worth.k != k {
                    assert!(worth.is_near_a_half(), "window {i}: GPU {k}, twin {worth:?}");
                } else if k > 1 && by != worth.by as u32 {
                    // Two metrics may ask for the same.
                    eprintln!("window {i}: decided by {by}, twin {worth:?}");
                }
            }
            worths
        })
    }
}

fn half(bits: u16) -> f32 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let mantissa = f32::from(bits & 0x3ff);
    sign * match bits >> 10 & 0x1f {
        0 => mantissa * 2f32.powi(-24),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        e => (1024.0 + mantissa) * 2f32.powi(i32::from(e) - 25),
    }
}

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Raw {
    normal: [f32; 3],
    depth: f32,
    tangent: [f32; 4],
    uv: [f32; 2],
    ddx: [f32; 2],
    ddy: [f32; 2],
    material: u32,
    object: u32,
    user: u32,
    padding: [u32; 3],
}

/// What `fragment` of a source for [`covering`] returns, on the default G-buffer.
pub const OUT: &str = "
struct Out {
    @builtin(frag_depth) depth: f32,
    @location(0) surface: vec2u,
    @location(1) frame: vec2u,
    @location(2) uv: vec4u,
}
";

const FILL: &str = "
struct Raw {
    normal: vec3f, depth: f32, tangent: vec4f, uv: vec2f, ddx: vec2f, ddy: vec2f,
    material: u32, object: u32, user: u32, a: u32, b: u32, c: u32,
}
@group(0) @binding(0) var<storage, read> samples: array<Raw>;
@group(0) @binding(1) var<uniform> width: vec4u;
@fragment fn fragment(@builtin(position) p: vec4f) -> Out {
    let r = samples[u32(p.y) * width.x + u32(p.x)];
    var f: DaaFragment;
    f.normal = r.normal;
    f.geometric_normal = r.normal;
    f.tangent = r.tangent;
    f.uv = r.uv;
    f.ddx = r.ddx;
    f.ddy = r.ddy;
    f.material = r.material;
    f.object = r.object;
    f.user = r.user;
    let g = daa_pack(f);
    return Out(r.depth, g.surface, g.frame, g.uv);
}";

/// A triangle that covers the target.
const COVERING: &str = "
@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}";

/// A pipeline that writes every sample of a G-buffer, its depth too, by `fragment` of a source. Without a layout for
/// group 0, that follows from the source.
pub fn covering(
    device: &wgpu::Device,
    label: &str,
    layout: Option<&wgpu::BindGroupLayout>,
    source: String,
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl((source + COVERING).into()),
    });
    let layout = layout.map(|layout| {
        device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        })
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: layout.as_ref(),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            depth_compare: Some(wgpu::CompareFunction::Always),
            ..GBuffer::depth_state()
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Records the pass of such a pipeline.
pub fn cover(
    encoder: &mut wgpu::CommandEncoder,
    gbuffer: &GBuffer,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("cover"),
        color_attachments: &gbuffer.color_attachments(),
        depth_stencil_attachment: Some(gbuffer.depth_attachment()),
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..3, 0..1);
}

/// Writes every sample of a G-buffer, as a host's raster pass would.
pub fn fill(gpu: &Gpu, gbuffer: &GBuffer, sample: impl Fn(u32, u32) -> Sample) {
    use wgpu::util::DeviceExt as _;
    let raw: Vec<Raw> = (0..gbuffer.width * gbuffer.height)
        .map(|i| {
            let s = sample(i % gbuffer.width, i / gbuffer.width);
            Raw {
                normal: s.normal.to_array(),
                depth: s.depth,
                tangent: s.tangent.to_array(),
                uv: s.uv.to_array(),
                ddx: s.ddx.to_array(),
                ddy: s.ddy.to_array(),
                material: s.material,
                object: s.object,
                user: s.user,
                padding: [0; 3],
            }
        })
        .collect();
    let buffer = |contents: &[u8], usage| {
        gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let samples = buffer(bytemuck::cast_slice(&raw), wgpu::BufferUsages::STORAGE);
    let width = buffer(bytemuck::bytes_of(&[gbuffer.width, 0, 0, 0]), wgpu::BufferUsages::UNIFORM);
    let source = format!("{}\n{OUT}{FILL}", GBufferTier::default().pack_wgsl());
    let pipeline = covering(&gpu.device, "fill", None, source, &GBufferTier::default().color_targets());
    let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: samples.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: width.as_entire_binding() },
        ],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    cover(&mut encoder, gbuffer, &pipeline, &bind_group);
    gpu.queue.submit([encoder.finish()]);
}

/// Well-spread pseudo-random numbers in [0, 1): tests need no more.
pub fn noise(seed: u32) -> f32 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / 4_294_967_296.0
}

/// RGBA8 of a colour in [0, 1].
pub fn rgba8(r: f32, g: f32, b: f32, a: f32) -> u32 {
    [r, g, b, a].iter().rev().fold(0, |word, &c| word << 8 | (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u32)
}

/// The normal that the G-buffer holds for `v`.
pub fn stored_normal(v: Vec3) -> DVec3 {
    octahedral::decode(octahedral::encode(v.as_dvec3()))
}
