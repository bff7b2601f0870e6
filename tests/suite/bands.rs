//! Frames in bands equal whole frames bit for bit, for every technique; and images in a rectangle of a larger target.

use crate::harness::{Rig, SHOW_USER, Sample, cover, covering, fill, noise, rgba8};
use crate::shadows::host;
use crate::visibility::{self, adapter, has_ids};
use deferred_aa::glam::Vec3;
use deferred_aa::rays::RayTier;
use deferred_aa::{
    Band, ColorReference, DebugView, DeferredAa, Descriptor, Effect, Execution, Frame, GBufferTier, Goal, Lattice,
    MultiResolution, Needs, Pattern, RecordError, Rect, Selective, Settings, Shading, SizeError, Statistics, Technique,
    Weight, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use deferred_aa_demo::host::{Host, HostError, Shot, gbuffer_tier};
use deferred_aa_demo::raster::node_camera;
use deferred_aa_demo::scene::builtin::builtin;

/// The shader that copies the targets of a tier, from an origin on.
fn slice(tier: GBufferTier) -> String {
    let (mut declared, mut fields, mut loads) = (String::new(), String::new(), String::new());
    for (i, format) in tier.color_formats().into_iter().enumerate() {
        let (ty, part) = match format {
            wgpu::TextureFormat::R32Uint => ("u32", "x"),
            wgpu::TextureFormat::Rg32Uint => ("vec2u", "xy"),
            _ => ("vec4u", "xyzw"),
        };
        declared += &format!("@group(0) @binding({}) var color_{i}: texture_2d<u32>;\n", i + 2);
        fields += &format!("    @location({i}) color_{i}: {ty},\n");
        loads += &format!(", textureLoad(color_{i}, at, 0).{part}");
    }
    format!(
        "@group(0) @binding(0) var<uniform> origin: vec4u;
@group(0) @binding(1) var depth: texture_2d<f32>;
{declared}
struct Out {{
    @builtin(frag_depth) depth: f32,
{fields}}}
@fragment fn fragment(@builtin(position) p: vec4f) -> Out {{
    let at = vec2u(p.xy) + origin.xy;
    return Out(textureLoad(depth, at, 0).x{loads});
}}"
    )
}

/// Copies the samples of a band out of the G-buffer of the whole image.
struct Slicer {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    origin: wgpu::Buffer,
}

impl Slicer {
    fn new(gpu: &Gpu, whole: &deferred_aa::GBuffer, tier: GBufferTier) -> Self {
        let device = &gpu.device;
        let layout = {
            let texture = |binding, sample_type| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type,
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            };
            let uniform = wgpu::BindGroupLayoutEntry {
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                ..texture(0, wgpu::TextureSampleType::Uint)
            };
            let mut entries = vec![uniform, texture(1, wgpu::TextureSampleType::Float { filterable: false })];
            entries.extend((2..).zip(&whole.color).map(|(binding, _)| texture(binding, wgpu::TextureSampleType::Uint)));
            device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("slice"), entries: &entries })
        };
        let pipeline = covering(device, "slice", Some(&layout), slice(tier), &tier.color_targets());
        let origin = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("slice"),
            size: 16,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: origin.as_entire_binding() }];
        entries.extend((1..).zip(std::iter::once(&whole.depth).chain(&whole.color)).map(|(binding, view)| {
            wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) }
        }));
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("slice"),
            layout: &layout,
            entries: &entries,
        });
        Self { pipeline, group, origin }
    }

    fn fill(&self, host: &Host, encoder: &mut wgpu::CommandEncoder, band: &Band) {
        let m = host.options.m;
        let origin = [band.raster.x * m, band.raster.y * m, 0, 0];
        host.gpu.queue.write_buffer(&self.origin, 0, bytemuck::bytes_of(&origin));
        let gbuffer = host.aa.gbuffer().expect("a size");
        assert_eq!([gbuffer.width, gbuffer.height], [band.raster.width * m, band.raster.height * m]);
        cover(encoder, gbuffer, &self.pipeline, &self.group);
    }
}

/// A scene rendered as a whole, and again in bands over the same samples.
struct Pair {
    whole: Host,
    banded: Host,
    slicer: Slicer,
}

impl Pair {
    fn new(name: &str, m: u32, size: [u32; 2]) -> Self {
        Self::of(host(builtin(name).expect("a scene"), m, size))
    }

    /// Of a host that renders the whole.
    fn of(mut whole: Host) -> Self {
        let options = whole.options;
        let banded = Host::within(whole.gpu.clone(), whole.scene.clone(), options, Some(u64::MAX));
        let camera = whole.scene.default_camera();
        whole
            .frame(&camera, without_rays(Settings { technique: Technique::Single, ..Default::default() }))
            .expect("a frame");
        let slicer = Slicer::new(&whole.gpu, whole.aa.gbuffer().expect("a size"), options.gbuffer);
        Self { whole, banded: banded.expect("a host"), slicer }
    }

    fn bands(&mut self, settings: Settings, limit: u64) -> Result<Vec<Band>, SizeError> {
        self.banded.memory = Some(limit);
        match self.banded.bands(&settings) {
            Ok(bands) => Ok(bands.into_iter().flatten().collect()),
            Err(HostError::Size(e)) => Err(e),
            Err(e) => panic!("{e}"),
        }
    }

    fn least(&mut self, settings: Settings) -> u64 {
        match self.bands(settings, 0) {
            Err(SizeError::Limit { least, limit: 0, .. }) => least,
            other => panic!("{other:?}"),
        }
    }

    /// The least bands, or about as many as wanted.
    fn about(&mut self, settings: Settings, most: usize) -> Vec<Band> {
        let mut limit = self.least(settings);
        loop {
            let bands = self.bands(settings, limit).expect("bands");
            if bands.len() <= most {
                return bands;
            }
            limit += limit / 32;
        }
    }

    fn run(&mut self, settings: Settings, bands: &[Band]) -> Shot {
        let camera = self.banded.scene.default_camera();
        let camera = node_camera(&camera, self.banded.options.width, self.banded.options.height);
        let bands: Vec<_> = bands.iter().copied().map(Some).collect();
        let fill = |host: &Host, encoder: &mut wgpu::CommandEncoder, _: &_, band: Option<&Band>| {
            self.slicer.fill(host, encoder, band.expect("a band"));
        };
        self.banded.frame_of_bands(camera, settings, &bands, fill, |_, _| ()).expect("a frame")
    }

    /// Renders both ways and compares images and what is counted of them.
    fn assert_same(&mut self, settings: Settings, bands: &[Band], what: &str) -> Statistics {
        let camera = self.whole.scene.default_camera();
        let one = self.whole.shade_again(&camera, settings).expect("a frame").statistics;
        let picture = self.whole.picture();
        let many = self.run(settings, bands).statistics;
        let found = self.banded.picture();
        let differ: Vec<usize> = (0..picture.rgba.len())
            .filter(|&i| picture.rgba[i].map(f32::to_bits) != found.rgba[i].map(f32::to_bits))
            .collect();
        let width = picture.width as usize;
        let at = |i: usize| (i % width, i / width, picture.rgba[i], found.rgba[i]);
        assert!(
            differ.is_empty(),
            "{what}, {} bands of {:?}: {} pixels differ, such as {:?} and {:?}",
            bands.len(),
            bands[0].raster,
            differ.len(),
            at(differ[0]),
            differ.last().map(|&i| at(i))
        );
        assert_eq!(many.bands as usize, bands.len());
        assert_eq!(many.decided, one.decided, "{what}");
        assert_eq!(many.quadrants, one.quadrants, "{what}");
        assert_eq!(many.overflowed_tiles, one.overflowed_tiles, "{what}");
        if settings.technique == Technique::MultiResolution {
            assert!(many.shaded >= one.shaded, "{what}");
        } else {
            assert_eq!(many.histogram_k, one.histogram_k, "{what}");
            assert_eq!(many.shaded - many.apron, one.shaded, "{what}");
        }
        assert!(many.shadow_rays >= one.shadow_rays && many.reflection_rays >= one.reflection_rays, "{what}");
        assert!(many.passes.len() == one.passes.len() && many.passes[0].milliseconds > Some(0.0), "{what}");
        many
    }
}

/// What differs in what it reads of neighbours.
fn variants(m: u32) -> Vec<(String, Settings)> {
    let plain = Settings::default();
    let of = |technique| Settings { technique, ..plain };
    let mut all: Vec<(String, Settings)> =
        Technique::ALL.map(|technique| (format!("{technique:?}"), of(technique))).into();
    let mut add = |name: &str, settings| all.push((name.to_owned(), settings));
    for execution in [Execution::Tiled, Execution::Bucketed, Execution::MaxFiltered, Execution::Packed] {
        add(&format!("Windowed {execution:?}"), Settings { execution, ..plain });
    }
    let max = Settings { execution: Execution::MaxFiltered, ..of(Technique::MultiResolution) };
    add("MultiResolution MaxFiltered", max);
    add("Windowed by luminance", Settings { weight: Weight::Luminance, ..plain });
    let gradient = Selective { reference: ColorReference::Gradient, bilinear: true, ..plain.selective };
    add("Selective by gradient", Settings { selective: gradient, ..of(Technique::Selective) });
    for pattern in [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral] {
        if pattern == Pattern::Quad || m > 1 {
            let lattice = Lattice { pattern, coarsest: 3 };
            let deep = MultiResolution { shading: lattice, rays: lattice, ..plain.multi_resolution };
            let lattices = Settings { multi_resolution: deep, ..of(Technique::MultiResolution) };
            add(&format!("MultiResolution {pattern:?}"), lattices);
            let below = MultiResolution { supersampled: false, weighted: true, veto: false, ..deep };
            add(&format!("MultiResolution {pattern:?} below one"), Settings { multi_resolution: below, ..lattices });
        }
    }
    all
}

fn assert_all_same(name: &str, m: u32, size: [u32; 2], most: usize) {
    let mut pair = Pair::new(name, m, size);
    for (variant, settings) in variants(m) {
        for (settings, rays) in [(settings, ""), (without_rays(settings), " without rays")] {
            let what = format!("{name} m = {m} {variant}{rays}");
            let bands = pair.about(settings, most);
            assert!(bands.len() > 1, "{what}");
            pair.assert_same(settings, &bands, &what);
        }
    }
}

fn without_rays(settings: Settings) -> Settings {
    Settings { shadows: Effect::Off, reflections: Effect::Off, refraction: Effect::Off, ..settings }
}

#[test]
fn bands_make_the_image_of_a_whole_frame() {
    assert_all_same("mirrors", 2, [45, 211], 5);
}

#[test]
fn bands_of_odd_windows_make_the_image_of_a_whole_frame() {
    assert_all_same("shadows", 3, [187, 29], 5);
}

/// A visibility buffer, whose samples are read by the rays of the whole image.
#[test]
fn bands_of_triangles_make_the_image_of_a_whole_frame() {
    if !has_ids() {
        return;
    }
    for (name, m, size) in [("mirrors", 2, [45, 131]), ("fence", 3, [77, 43])] {
        let scene = builtin(name).expect("a scene");
        let tier = gbuffer_tier(&scene, &adapter());
        let mut pair = Pair::of(visibility::host(scene, m, size, tier));
        for technique in Technique::ALL {
            let settings = Settings { technique, ..Default::default() };
            let bands = pair.about(settings, 5);
            assert!(bands.len() > 1, "{name} {technique:?}");
            pair.assert_same(settings, &bands, &format!("{name} {technique:?}"));
        }
    }
}

/// One tile of output in each band, where bands cut tiles and windows of neighbours.
#[test]
fn bands_of_one_tile_make_the_image_of_a_whole_frame() {
    let mut pair = Pair::new("mirrors", 2, [45, 43]);
    for technique in Technique::ALL {
        let settings = Settings { technique, ..Default::default() };
        let least = pair.least(settings);
        let bands = pair.bands(settings, least).expect("bands");
        let inner = bands.iter().filter(|b| b.output.x > 0 && b.output.x + b.output.width < 45);
        assert!(technique == Technique::MultiResolution || inner.clone().count() > 0, "{technique:?}");
        assert!(inner.clone().all(|b| b.output.width == 8), "{technique:?}: {bands:?}");
        if bands.len() > 1 {
            pair.assert_same(settings, &bands, &format!("{technique:?}"));
        }
        assert!(matches!(pair.bands(settings, least - 1), Err(SizeError::Limit { least: told, .. }) if told == least));
    }
}

#[test]
fn goals_search_as_over_whole_frames() {
    let mut pair = Pair::new("fence", 2, [43, 120]);
    let settings = Settings { goal: Some(Goal::Error(0.02)), ..Default::default() };
    let bands = pair.about(settings, 6);
    assert!(bands.iter().any(|band| band.raster.y > 0), "tiles are counted from the image's first: {bands:?}");
    let mut efforts = Vec::new();
    for frame in 0..60 {
        let many = pair.assert_same(settings, &bands, &format!("frame {frame}"));
        let one = pair.whole.aa.statistics().expect("statistics").goal;
        assert_eq!(many.goal, one, "frame {frame}");
        let effort = one.expect("a goal").effort;
        if efforts.last() != Some(&effort) {
            efforts.push(effort);
        }
    }
    assert!(efforts.len() > 2, "the effort moves: {efforts:?}");
}

#[test]
fn views_are_those_of_a_whole_frame() {
    let mut pair = Pair::new("mirrors", 2, [35, 99]);
    for technique in [Technique::Full, Technique::Windowed, Technique::Selective, Technique::MultiResolution] {
        for view in DebugView::ALL {
            let settings = Settings { technique, view, ..Default::default() };
            let bands = pair.about(settings, 3);
            pair.assert_same(settings, &bands, &format!("{technique:?} {view:?}"));
        }
    }
}

/// Where a sample is, and from where it is seen.
const PLACES: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(vec2f(s.pixel), s.view.x, f32(s.rank)); }
    fn sky(s: DaaSample) -> vec4f { return vec4f(vec2f(s.pixel), s.view.y + 2.0, f32(s.rank)); }";

fn busy(x: u32, y: u32) -> Sample {
    let object = 1 + x / 23 + y / 31 * 5;
    if object % 7 == 3 {
        return Sample::SKY;
    }
    let normal = Vec3::new(noise(object), noise(object + 1), 1.0).normalize();
    let user = rgba8(noise(x + 977 * y), noise(object + 5), noise(object + 6), 1.0);
    Sample { depth: 0.02 + noise(object) * 0.2, normal, object, user, ..Default::default() }
}

/// Shows each band in turn in a rig's image.
fn run(rig: &mut Rig, bands: &[Band], settings: Settings, sample: impl Fn(u32, u32) -> Sample) -> Vec<[f32; 4]> {
    let m = rig.aa.m();
    for &band in bands {
        let [x0, y0] = [band.raster.x * m, band.raster.y * m];
        rig.fill(|x, y| sample(x0 + x, y0 + y));
        rig.band = Some(band);
        let commands = rig.try_record(settings).expect("a band");
        rig.gpu.queue.submit([commands]);
    }
    rig.gpu.wait();
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
    rig.image()
}

#[test]
fn hosts_see_the_pixels_and_directions_of_the_whole_image() {
    for (m, technique) in [(1, Technique::Full), (3, Technique::Full), (4, Technique::Single)] {
        let settings = Settings { technique, ..Default::default() };
        let mut rig = Rig::new(m, 61, 45, PLACES);
        rig.fill(busy);
        let whole = rig.run(settings).image;
        let device = rig.gpu.device.clone();
        let least = rig.aa.resize_banded(&device, (61, 45), 0, &settings, &Needs::default());
        let Err(SizeError::Limit { least, .. }) = least else { panic!("{least:?}") };
        let bands = rig.aa.resize_banded(&device, (61, 45), least, &settings, &Needs::default()).expect("bands");
        assert!(bands.len() > 20, "{}", bands.len());
        assert_eq!(run(&mut rig, &bands, settings, busy), whole, "m = {m}");
    }
}

/// Colours about the threshold of refinement, so that each point's choice hangs on its neighbours'.
#[test]
fn what_lattices_choose_follows_from_the_apron() {
    let image = (21, 190);
    for (m, threshold) in [(1, 0.02), (2, 0.015), (2, 0.025), (2, 0.035)] {
        let mut rig = Rig::new(m, image.0, image.1, SHOW_USER);
        let grain = |x: u32, y: u32| 0.2 + noise(x + 4096 * y) * 0.6;
        let sample = |x, y| Sample { user: rgba8(grain(x, y), 0.5, 0.5, 1.0), ..Default::default() };
        for pattern in [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral] {
            if pattern != Pattern::Quad && m == 1 {
                continue;
            }
            let lattice = Lattice { pattern, coarsest: 3 };
            let plain = MultiResolution::default();
            let below =
                MultiResolution { shading: lattice, supersampled: false, veto: false, weighted: false, ..plain };
            let multi_resolution = MultiResolution { color_threshold: threshold, ..below };
            let settings = Settings { technique: Technique::MultiResolution, multi_resolution, ..Default::default() };
            let device = rig.gpu.device.clone();
            rig.band = None;
            rig.aa.resize(&device, image.0, image.1).expect("a size");
            rig.fill(sample);
            let whole = rig.run(settings);
            let points = whole.statistics.points;
            // Some points of each lattice are chosen, and some are not.
            let [quarter, half] = [points.quarter, points.half].map(f64::from);
            assert!((100.0..600.0).contains(&quarter) && (300.0..1200.0).contains(&half), "{points:?}");
            let least = rig.aa.resize_banded(&device, image, 0, &settings, &Needs::default());
            let Err(SizeError::Limit { least, .. }) = least else { panic!("{least:?}") };
            let bands = rig.aa.resize_banded(&device, image, least, &settings, &Needs::default()).expect("bands");
            assert!(bands.len() > 8, "{}", bands.len());
            let found = run(&mut rig, &bands, settings, sample);
            let differ = whole.image.iter().zip(&found).filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "m = {m} {pattern:?} {threshold}");
        }
    }
}

/// Slots for the constants of all bands, and times of all of them.
#[test]
fn bands_are_submitted_together() {
    let settings = Settings::default();
    let mut rig = Rig::new(2, 61, 45, PLACES);
    let sample = |_, _| Sample::default();
    rig.fill(sample);
    let whole = rig.run(settings);
    let device = rig.gpu.device.clone();
    let at = |rig: &mut Rig, limit| rig.aa.resize_banded(&device, (61, 45), limit, &settings, &Needs::default());
    let Err(SizeError::Limit { least, .. }) = at(&mut rig, 0) else { panic!("no limit") };
    let bands = at(&mut rig, least).expect("bands");
    assert!((17..=64).contains(&bands.len()), "more than frames have slots: {}", bands.len());
    rig.fill(sample);
    let (target, view) = target(&rig.gpu, [61, 45]);
    for _ in 0..2 {
        let mut encoder = device.create_command_encoder(&Default::default());
        for &band in &bands {
            let frame = Frame { settings, band: Some(band), statistics: true, ..Frame::new(rig.camera, &view) };
            rig.aa.record(&rig.gpu.queue, &mut encoder, &frame).expect("a band");
        }
        rig.gpu.queue.submit([encoder.finish()]);
        rig.gpu.wait();
    }
    let found: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&rig.gpu.read_texture(&target, 16));
    assert_eq!(found, whole.image);
    let many = rig.aa.statistics().expect("statistics");
    assert_eq!((many.frame, many.bands as usize), (whole.statistics.frame + 2, bands.len()));
    assert_eq!(many.histogram_k, whole.statistics.histogram_k);
    assert!(many.passes.iter().all(|pass| pass.milliseconds > Some(0.0)), "{:?}", many.passes);
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}

#[test]
fn the_input_check_sees_a_band() {
    let settings = Settings::default();
    let mut rig = Rig::new(2, 61, 45, PLACES);
    let device = rig.gpu.device.clone();
    let bands = rig.aa.resize_banded(&device, (61, 45), u64::MAX, &settings, &Needs::default()).expect("bands");
    assert_eq!(bands.len(), 1);
    let Err(SizeError::Limit { least, .. }) = rig.aa.resize_banded(&device, (61, 45), 0, &settings, &Needs::default())
    else {
        panic!("no limit")
    };
    let bands = rig.aa.resize_banded(&device, (61, 45), least, &settings, &Needs::default()).expect("bands");
    rig.band = Some(bands[3]);
    rig.fill(|_, _| Sample { object: 3, ..Default::default() });
    let report = rig.check().expect("a check");
    let Rect { width, height, .. } = bands[3].raster;
    assert_eq!(report.counts.covered, width * height * 4);
}

#[test]
fn bands_that_do_not_fit_are_refused() {
    let settings = Settings::default();
    let needs = Needs::default();
    let mut rig = Rig::new(2, 61, 45, PLACES);
    let device = rig.gpu.device.clone();
    let at =
        |rig: &mut Rig, limit, settings: &Settings| rig.aa.resize_banded(&device, (61, 45), limit, settings, &needs);
    assert_eq!(at(&mut rig, u64::MAX, &settings).expect("a band").len(), 1);
    let whole = rig.try_record(settings).map(drop);
    assert_eq!(whole, Ok(()), "a single band need not be named");
    let told = at(&mut rig, 1000, &settings).expect_err("too little");
    let SizeError::Limit { least, .. } = told else { panic!("{told}") };
    assert_eq!(
        told.to_string(),
        format!(
            "61×45 at m = 2 can't be rendered in bands within 1000 bytes; allow at least {least} bytes, or lower m"
        )
    );
    assert_eq!(rig.aa.gbuffer().map(|g| g.width), Some(122), "the former size is kept");
    let bands = at(&mut rig, least, &settings).expect("bands");
    let held = rig.aa.memory();
    assert!(held.gbuffer + held.scratch <= least, "{held:?}, {least}");
    let first = rig.aa.gbuffer().expect("a size").depth.texture().clone();
    assert_eq!(at(&mut rig, least, &settings).expect("bands"), bands);
    assert_eq!(*rig.aa.gbuffer().expect("a size").depth.texture(), first, "nothing is made anew");

    let refused = |rig: &mut Rig, band: Option<Band>, settings: Settings| {
        rig.band = band;
        rig.try_record(settings).map(drop)
    };
    let Rect { width, height, .. } = bands[0].raster;
    assert_eq!(refused(&mut rig, None, settings), Err(RecordError::NoBand { width, height }));
    assert_eq!(refused(&mut rig, Some(bands[1]), settings), Err(RecordError::BandOrder { index: 1, next: 0 }));
    assert_eq!(refused(&mut rig, Some(bands[0]), settings), Ok(()));
    assert_eq!(refused(&mut rig, Some(bands[2]), settings), Err(RecordError::BandOrder { index: 2, next: 1 }));
    let others = Settings { weight: Weight::Luminance, ..settings };
    assert_eq!(refused(&mut rig, Some(bands[1]), others), Err(RecordError::BandDiffers(1)));
    assert_eq!(refused(&mut rig, Some(bands[1]), settings), Ok(()));
    // The first one begins anew.
    assert_eq!(refused(&mut rig, Some(bands[0]), others), Ok(()));
    let (index, count) = (0, bands.len() as u32);
    let single = Settings { technique: Technique::Single, ..settings };
    assert_eq!(refused(&mut rig, Some(bands[0]), single), Err(RecordError::Band { index, count }));
    let wrong = Band { output: Rect { width: 24, ..bands[0].output }, ..bands[0] };
    assert_eq!(refused(&mut rig, Some(wrong), settings), Err(RecordError::Band { index, count }));
    rig.aa.resize(&device, 61, 45).expect("a size");
    assert_eq!(refused(&mut rig, Some(bands[0]), settings), Err(RecordError::Band { index, count }));
    assert_eq!(refused(&mut rig, None, settings), Ok(()));

    let sized = |rig: &mut Rig, size| rig.aa.resize_banded(&device, size, u64::MAX, &settings, &needs);
    assert!(matches!(sized(&mut rig, (0, 45)), Err(SizeError::Empty { .. })));
    assert!(matches!(sized(&mut rig, (40_000, 45)), Err(SizeError::Samples { limit: 65535, .. })));
    assert!(matches!(sized(&mut rig, (u32::MAX, u32::MAX)), Err(SizeError::Samples { .. })));
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}

const RAYS: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(s.normal, 1.0); }
    fn reflection(s: DaaSample) -> DaaReflection { return DaaReflection(s.normal, 1.5, s.view, s.normal); }";

/// On the limits of WebGPU, with rays on, nothing is refused: neither what is larger than a texture nor what is larger
/// than a binding.
#[test]
fn large_images_fit_plain_limits() {
    for (m, size, limit) in
        [(4, (3840, 2160), 512_000_000), (8, (1920, 1080), 512_000_000), (4, (2560, 1440), u64::MAX)]
    {
        let shading = Shading { source: RAYS, file: "test.wgsl" };
        let format = wgpu::TextureFormat::Rgba16Float;
        let descriptor = Descriptor { m, rays: Some(RayTier::Software), ..Descriptor::new(format, shading) };
        let drawing = Gpu::drawing_nothing(&descriptor).expect("a device");
        let limits = DeferredAa::requirements(&drawing.adapter, &descriptor).limits;
        let gpu = Gpu::with(drawing.adapter.clone(), drawing.device.features(), limits.clone()).expect("a device");
        let mut aa = DeferredAa::new(&gpu.device, &descriptor, None).expect("a node");
        let light = deferred_aa::CastingLight::Directional { towards: Vec3::Y };
        for technique in Technique::ALL {
            let settings = Settings { technique, ..Default::default() };
            let needs = Needs { shadows: &[light], reflective: &[1], ..Default::default() };
            let bands = aa.resize_banded(&gpu.device, size, limit, &settings, &needs).expect("bands");
            let gbuffer = aa.gbuffer().expect("a size");
            let most = limits.max_texture_dimension_2d;
            assert!(gbuffer.width <= most && gbuffer.height <= most, "{technique:?}");
            let parts = aa.parts(&settings, &needs);
            let of_buffers = parts.iter().filter(|part| matches!(part.kind, deferred_aa::PartKind::Buffer { .. }));
            let largest = of_buffers.map(|part| part.kind.bytes()).max();
            assert!(largest <= Some(limits.max_storage_buffer_binding_size), "{technique:?}: {largest:?}");
            let pixels = bands.iter().map(|b| u64::from(b.output.width) * u64::from(b.output.height)).sum::<u64>();
            assert_eq!(pixels, u64::from(size.0) * u64::from(size.1));
            let rastered = bands.iter().map(|b| u64::from(b.raster.width) * u64::from(b.raster.height)).sum::<u64>();
            eprintln!(
                "{size:?} m = {m} {technique:?}: {} bands of {}×{}, {:.3} of the pixels",
                bands.len(),
                bands[0].raster.width,
                bands[0].raster.height,
                rastered as f64 / pixels as f64
            );
        }
        assert_eq!(gpu.take_errors(), Vec::<String>::new());
    }
}

/// Samples where the scene is rastered band by band instead: surfaces, depths, and materials and objects that differ.
#[test]
fn bands_are_rastered_almost_as_the_image_is() {
    for (name, viewport) in [("atrium", true), ("fence", true), ("atrium", false), ("fence", false)] {
        let mut pair = Pair::new(name, 2, [120, 90]);
        let settings = without_rays(Settings::default());
        let (surfaces, depths) = (pair.whole.surfaces(), pair.whole.depths());
        let bands = pair.about(settings, 6);
        let camera = node_camera(&pair.banded.scene.default_camera(), 120, 90);
        let bands: Vec<_> = bands.into_iter().map(Some).collect();
        let mut differ = [0; 3];
        let mut apart = 0f32;
        let mut samples = 0;
        let raster = |host: &Host, encoder: &mut wgpu::CommandEncoder, camera: &_, band: Option<&Band>| {
            host.raster_as(encoder, camera, band, viewport);
        };
        let compare = |host: &Host, band: Option<&Band>| {
            let Rect { x, y, width, height } = band.expect("a band").raster;
            let (found, found_depths) = (host.surfaces(), host.depths());
            for i in 0..(4 * width * height) as usize {
                let (column, row) = (i % (2 * width) as usize, i / (2 * width) as usize);
                let of_image = (row + 2 * y as usize) * 240 + column + 2 * x as usize;
                differ[0] += u32::from(found[i] != surfaces[of_image]);
                differ[1] += u32::from(found_depths[i].to_bits() != depths[of_image].to_bits());
                differ[2] += u32::from(found[i][1] != surfaces[of_image][1]);
                if found[i][1] == surfaces[of_image][1] {
                    apart = apart.max((found_depths[i] - depths[of_image]).abs() / depths[of_image].max(1e-30));
                }
                samples += 1;
            }
        };
        pair.banded.frame_of_bands(camera, settings, &bands, raster, compare).expect("a frame");
        let what = format!("{name}, viewport {viewport}: of {samples} samples {differ:?} differ, depths by {apart:e}");
        // In the viewport of the image each triangle covers the same samples, but the rasteriser interpolates from
        // another origin; a crop also moves the corners of triangles a little.
        let grid = if crate::drivers::is_swiftshader(&pair.banded.gpu) { 300 } else { 1000 };
        let most = if viewport { samples / 100_000 } else { samples / grid };
        assert!(differ[2] <= most && apart < 0.05, "{what}");
        eprintln!("{what}");
    }
}

fn target(gpu: &Gpu, [width, height]: [u32; 2]) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("target"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    (texture, view)
}

#[test]
fn the_image_goes_to_a_rectangle_of_a_larger_target() {
    const PAPER: [f32; 4] = [0.25, 0.5, 0.75, 1.0];
    let settings = Settings::default();
    let mut rig = Rig::new(2, 37, 29, PLACES);
    rig.fill(busy);
    let whole = rig.run(settings).image;
    let (texture, view) = target(&rig.gpu, [64, 48]);
    let device = rig.gpu.device.clone();
    let Err(SizeError::Limit { least, .. }) = rig.aa.resize_banded(&device, (37, 29), 0, &settings, &Needs::default())
    else {
        panic!("no limit")
    };
    for (x, y, limit) in [(0, 0, u64::MAX), (27, 19, u64::MAX), (5, 11, least)] {
        let [r, g, b, a] = PAPER.map(f64::from);
        let mut encoder = device.create_command_encoder(&Default::default());
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        }));
        rig.gpu.queue.submit([encoder.finish()]);
        let viewport = Some(Rect { x, y, width: 37, height: 29 });
        for band in rig.aa.resize_banded(&device, (37, 29), limit, &settings, &Needs::default()).expect("bands") {
            let [x0, y0] = [band.raster.x * 2, band.raster.y * 2];
            fill(&rig.gpu, rig.aa.gbuffer().expect("a size"), |x, y| busy(x0 + x, y0 + y));
            let frame = Frame { settings, viewport, band: Some(band), ..Frame::new(rig.camera, &view) };
            let mut encoder = device.create_command_encoder(&Default::default());
            rig.aa.record(&rig.gpu.queue, &mut encoder, &frame).expect("a frame");
            rig.gpu.queue.submit([encoder.finish()]);
        }
        let found: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&rig.gpu.read_texture(&texture, 16));
        for (i, &found) in (0..64 * 48).zip(&found) {
            let (column, row) = (i % 64, i / 64);
            let inside = (x..x + 37).contains(&column) && (y..y + 29).contains(&row);
            let expected = if inside { whole[((row - y) * 37 + column - x) as usize] } else { PAPER };
            assert_eq!(found, expected, "{column}, {row} of the image at {x}, {y}");
        }
    }
    rig.aa.resize(&device, 37, 29).expect("a size");
    let sound = Frame { settings, ..Frame::new(rig.camera, &view) };
    let mut refused = |x, y, width, height| {
        let viewport = Rect { x, y, width, height };
        let mut encoder = device.create_command_encoder(&Default::default());
        let frame = Frame { viewport: Some(viewport), ..sound };
        let e = rig.aa.record(&rig.gpu.queue, &mut encoder, &frame).expect_err("outside");
        let [target_width, target_height] = [64, 48];
        assert_eq!(e, RecordError::Viewport { viewport, width: 37, height: 29, target_width, target_height });
        e.to_string()
    };
    assert_eq!(
        refused(28, 0, 37, 29),
        "Frame::viewport is 37×29 at 28, 0; it has the node's size, 37×29, and lies in the target, 64×48"
    );
    refused(0, 20, 37, 29);
    refused(u32::MAX, 0, 37, 29);
    refused(0, 0, 36, 29);
    assert_eq!(rig.gpu.take_errors(), Vec::<String>::new());
}
