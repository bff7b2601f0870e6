//! The texture table through the library's API, on both tiers: what it refuses, what a sample reads, which mip.

use crate::harness::{Sample, camera, device, fill, has_bindings, noise};
use deferred_aa::glam::{Vec2, Vec3};
use deferred_aa::wgpu::{AddressMode, TextureFormat, TextureUsages};
use deferred_aa::{
    DeferredAa, Descriptor, Execution, Frame, GBufferTier, MAX_CLASSES, MAX_SAMPLERS, Settings, Shading, Statistics,
    TableError, TableSampler, TableTexture, Technique, TextureTable, TextureTier, Windowed, classes, wgpu,
};
use deferred_aa_demo::gpu::Gpu;

/// The texture of the sample's material, with the footprint that the sample stands for.
pub const SHOW_TEXTURE: &str =
    "fn shade(s: DaaSample) -> vec4f { return daa_texture(s.material, s.uv, s.ddx, s.ddy); }";

pub const USAGES: TextureUsages =
    TextureUsages::TEXTURE_BINDING.union(TextureUsages::COPY_SRC).union(TextureUsages::COPY_DST);

/// Bytes of a texel of one of the formats that these tests use.
fn texel(format: TextureFormat, c: [u8; 4]) -> Vec<u8> {
    match format {
        TextureFormat::Rgba8Unorm | TextureFormat::Rgba8UnormSrgb => c.to_vec(),
        TextureFormat::R8Unorm => vec![c[0]],
        // 0, ½ or 1.
        TextureFormat::Rgba16Float => c.iter().flat_map(|&v| [0, [0, 0x38, 0x3c][usize::from(v) / 127]]).collect(),
        other => panic!("no texels for {other:?}"),
    }
}

/// A texture with these many mips, texel by texel: `paint(mip, x, y)`.
pub fn texture(
    gpu: &Gpu,
    size: [u32; 2],
    mips: u32,
    format: TextureFormat,
    paint: impl Fn(u32, u32, u32) -> [u8; 4],
) -> wgpu::Texture {
    let made = plain(gpu, size, mips, format, USAGES);
    for mip in 0..mips {
        let [w, h] = size.map(|side| (side >> mip).max(1));
        let texels = (0..w * h).flat_map(|i| texel(format, paint(mip, i % w, i / w)));
        let bytes: Vec<u8> = texels.collect();
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: mip, ..made.as_image_copy() },
            &bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(bytes.len() as u32 / h),
                rows_per_image: None,
            },
            wgpu::Extent3d { width: w, height: h, depth_or_array_layers: 1 },
        );
    }
    made
}

fn plain(gpu: &Gpu, size: [u32; 2], mips: u32, format: TextureFormat, usage: TextureUsages) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test texture"),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: mips,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// One colour all over.
pub fn flat(gpu: &Gpu, color: [u8; 4]) -> wgpu::Texture {
    texture(gpu, [1, 1], 1, TextureFormat::Rgba8Unorm, |_, _, _| color)
}

pub fn node(gpu: &Gpu, tier: TextureTier, m: u32, shading: &str, texture_capacity: u32) -> DeferredAa {
    let target_format = TextureFormat::Rgba32Float;
    let shading = Shading { source: shading, file: "test.wgsl" };
    let descriptor = Descriptor {
        m,
        target_format,
        shading,
        textures: tier,
        texture_capacity,
        rays: None,
        gbuffer: GBufferTier::default(),
    };
    DeferredAa::new(&gpu.device, &descriptor, None).expect("a node")
}

pub fn table(gpu: &Gpu, aa: &DeferredAa, textures: &[TableTexture<'_>]) -> Result<TextureTable, TableError> {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let table = aa.texture_table(&gpu.queue, &mut encoder, textures)?;
    gpu.queue.submit([encoder.finish()]);
    Ok(table)
}

/// A node with a texture table on a synthetic G-buffer.
pub struct Textured {
    pub gpu: Gpu,
    pub aa: DeferredAa,
    table: TextureTable,
    size: [u32; 2],
    target: wgpu::Texture,
}

impl Textured {
    pub fn new(
        tier: TextureTier,
        m: u32,
        size: [u32; 2],
        shading: &str,
        textures: impl FnOnce(&Gpu) -> Vec<(wgpu::Texture, TableSampler)>,
    ) -> Self {
        let gpu = device(tier);
        let mut aa = node(&gpu, tier, m, shading, 512);
        aa.resize(&gpu.device, size[0], size[1]).expect("a size");
        let made = textures(&gpu);
        let all: Vec<_> = made.iter().map(|(texture, sampler)| TableTexture { texture, sampler: *sampler }).collect();
        let table = table(&gpu, &aa, &all).expect("a table");
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let target = plain(&gpu, size, 1, TextureFormat::Rgba32Float, usage);
        Self { gpu, aa, table, size, target }
    }

    pub fn fill(&self, sample: impl Fn(u32, u32) -> Sample) {
        fill(&self.gpu, self.aa.gbuffer().expect("a size"), sample);
    }

    pub fn run(&mut self, settings: Settings) -> (Vec<[f32; 4]>, Statistics) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let frame = Frame {
            needs: deferred_aa::Needs::default(),
            camera: camera(self.size[0] as f32 / self.size[1] as f32),
            settings,
            exposure: 1.0,
            host_bind_group: None,
            second_bind_group: None,
            host_offsets: [&[]; 2],
            textures: Some(&self.table),
            target: &self.target.create_view(&Default::default()),
            depth: None,
            viewport: None,
            band: None,
            statistics: true,
        };
        self.aa.record(&self.gpu.queue, &mut encoder, &frame).expect("a frame");
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait();
        let image = bytemuck::pod_collect_to_vec(&self.gpu.read_texture(&self.target, 16));
        assert_eq!(self.gpu.take_errors(), Vec::<String>::new());
        (image, self.aa.statistics().expect("statistics").clone())
    }
}

/// The tiers that the adapter of the tests can run.
pub fn tiers() -> Vec<TextureTier> {
    let mut tiers = vec![TextureTier::Arrays];
    tiers.extend(has_bindings().then_some(TextureTier::Bindings));
    tiers
}

/// k = `k` in every window, through two objects in each: nothing but the identity metric is on. Footprints are plain.
pub fn fixed_k(k: u32) -> Settings {
    let windowed = Windowed {
        depth_scale: 0.0,
        normal_scale: 0.0,
        luminance_scale: 0.0,
        identity_samples: k as f32,
        footprint: 1.0,
        edge_aware_first: false,
        ..Default::default()
    };
    Settings { windowed, ..Default::default() }
}

pub fn single() -> Settings {
    Settings { technique: Technique::Single, ..Default::default() }
}

pub fn full() -> Settings {
    Settings { technique: Technique::Full, ..Default::default() }
}

/// Sizes, formats, mips, samplers and wraps all mixed: seven classes, the most that the array tier has.
fn mixed(gpu: &Gpu) -> Vec<(wgpu::Texture, TableSampler)> {
    let color = |seed: u32| {
        move |mip: u32, x: u32, y: u32| {
            let c = |i: u32| (noise(seed + i * 7919 + mip * 101 + x * 31 + y * 1009) * 2.99) as u8 * 127;
            [c(0), c(1), c(2), 255]
        }
    };
    let wrap = |address_u, address_v| TableSampler { address_u, address_v, ..Default::default() };
    let (clamp, mirror) = (AddressMode::ClampToEdge, AddressMode::MirrorRepeat);
    let (plain, srgb) = (TextureFormat::Rgba8Unorm, TextureFormat::Rgba8UnormSrgb);
    let nearest = TableSampler { nearest: true, ..Default::default() };
    let blunt = TableSampler { anisotropy: 1, ..Default::default() };
    let all = [
        ([64, 64], 7, plain, TableSampler::default()),
        ([64, 64], 7, srgb, TableSampler::default()),
        ([32, 8], 6, plain, wrap(clamp, mirror)),
        ([16, 16], 1, TextureFormat::Rgba16Float, wrap(mirror, clamp)),
        ([17, 13], 5, plain, blunt),
        ([64, 64], 7, plain, nearest),
        ([8, 8], 4, TextureFormat::R8Unorm, TableSampler::default()),
        // Second layers of classes that are there already.
        ([64, 64], 7, plain, TableSampler::default()),
        ([17, 13], 5, plain, blunt),
    ];
    (0..)
        .zip(all)
        .map(|(i, (size, mips, format, s))| (texture(gpu, size, mips, format, color(i * 65_537)), s))
        .collect()
}

/// Every texture at every kind of footprint, mirrored and rotated, far outside of [0, 1] too.
fn all_over(x: u32, y: u32) -> Sample {
    let cell = x / 6 + y / 6 * 11;
    let length = 2f32.powf(noise(cell + 1) * 10.0 - 9.0);
    let angle = noise(cell + 2) * 6.3;
    let ddx = Vec2::from_angle(angle) * length;
    let ddy = Vec2::from_angle(angle + 1.0 + noise(cell + 3)) * length * noise(cell + 4);
    Sample {
        uv: Vec2::new(noise(cell + 5), noise(cell + 6)) * 6.0 - 3.0 + ddx * x as f32 + ddy * y as f32,
        ddx,
        ddy,
        material: cell % 9,
        object: 1 + cell % 7,
        ..Default::default()
    }
}

#[test]
fn both_tiers_give_the_same_image() {
    if !has_bindings() {
        return;
    }
    let settings = [
        full(),
        single(),
        Settings::default(),
        Settings { execution: Execution::Loop, ..Default::default() },
        fixed_k(5),
    ];
    let images = tiers().into_iter().map(|tier| {
        let mut rig = Textured::new(tier, 3, [34, 21], SHOW_TEXTURE, mixed);
        rig.fill(all_over);
        settings.map(|s| rig.run(s).0)
    });
    let images: Vec<_> = images.collect();
    for (i, (a, b)) in images[0].iter().zip(&images[1]).enumerate() {
        let apart = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart <= 1.0 / 255.0, "settings {i}: {apart}");
        // It is a picture at all: far from one colour.
        assert!(a.iter().any(|p| p[0] < 0.2) && a.iter().any(|p| p[0] > 0.8));
    }
}

#[test]
fn wrap_modes_and_filters_are_as_asked() {
    // Four columns: black, ⅓, ⅔, white. Texel centres, so that filtering shows the texel itself.
    let paint = |_, x: u32, _| [x as u8 * 85, 0, 0, 255];
    let [repeat, mirror, clamp] = [AddressMode::Repeat, AddressMode::MirrorRepeat, AddressMode::ClampToEdge];
    let samplers = [
        TableSampler { address_u: repeat, ..Default::default() },
        TableSampler { address_u: mirror, ..Default::default() },
        TableSampler { address_u: clamp, ..Default::default() },
        TableSampler { nearest: true, ..Default::default() },
    ];
    for tier in tiers() {
        let mut rig = Textured::new(tier, 1, [6, 4], SHOW_TEXTURE, |gpu| {
            samplers.iter().map(|&s| (texture(gpu, [4, 1], 1, TextureFormat::Rgba8Unorm, paint), s)).collect()
        });
        // u of each column, in texels.
        let columns = [0.5, 3.5, 4.5, 7.5, -0.5, 1.9];
        rig.fill(|x, y| Sample { uv: Vec2::new(columns[x as usize] / 4.0, 0.5), material: y, ..Default::default() });
        let image = rig.run(single()).0;
        let expected: [[f32; 6]; 4] = [
            [0.0, 3.0, 0.0, 3.0, 3.0, 1.4],
            [0.0, 3.0, 3.0, 0.0, 0.0, 1.4],
            [0.0, 3.0, 3.0, 3.0, 0.0, 1.4],
            [0.0, 3.0, 0.0, 3.0, 3.0, 1.0],
        ];
        for (i, (pixel, expected)) in image.iter().zip(expected.as_flattened()).enumerate() {
            assert!((pixel[0] * 3.0 - expected).abs() < 0.02, "{tier:?}, {i}: {pixel:?} for {expected}");
        }
    }
}

#[test]
fn srgb_textures_are_decoded() {
    for tier in tiers() {
        let mut rig = Textured::new(tier, 1, [2, 1], SHOW_TEXTURE, |gpu| {
            let formats = [TextureFormat::Rgba8Unorm, TextureFormat::Rgba8UnormSrgb];
            formats
                .map(|f| (texture(gpu, [1, 1], 1, f, |_, _, _| [188, 188, 188, 255]), TableSampler::default()))
                .into()
        });
        rig.fill(|x, _| Sample { material: x, ..Default::default() });
        let image = rig.run(single()).0;
        assert!(
            (image[0][0] - 188.0 / 255.0).abs() < 1e-4 && (image[1][0] - 0.503).abs() < 2e-3,
            "{tier:?}: {image:?}"
        );
    }
}

#[test]
fn an_empty_table_answers_white_and_indices_past_the_end_read_the_last() {
    for tier in tiers() {
        for textures in [0, 2] {
            let mut rig = Textured::new(tier, 1, [4, 1], SHOW_TEXTURE, |gpu| {
                (0..textures).map(|i| (flat(gpu, [0, 100 * i, 0, 255]), TableSampler::default())).collect()
            });
            rig.fill(|x, _| Sample { material: [0, 1, 2, 65_535][x as usize], ..Default::default() });
            let greens: Vec<_> = rig.run(single()).0.iter().map(|p| (p[1] * 255.0).round() as u32).collect();
            let expected = if textures == 0 { [255; 4] } else { [0, 100, 100, 100] };
            assert_eq!(greens, expected, "{tier:?}, {textures} textures");
        }
    }
}

#[test]
fn a_class_of_more_than_256_goes_on_in_a_second_array() {
    let mut rig = Textured::new(TextureTier::Arrays, 1, [300, 1], SHOW_TEXTURE, |gpu| {
        (0..300).map(|i: u32| (flat(gpu, [i as u8, (i >> 8) as u8, 77, 255]), TableSampler::default())).collect()
    });
    rig.fill(|x, _| Sample { material: x, ..Default::default() });
    let image = rig.run(single()).0;
    for (i, pixel) in (0..).zip(image) {
        let [low, high, mark] = [0, 1, 2].map(|c| (pixel[c] * 255.0).round() as u32);
        assert_eq!((high << 8 | low, mark), (i, 77));
    }
}

#[test]
fn too_many_classes_are_refused_by_number() {
    let gpu = device(TextureTier::Arrays);
    let aa = node(&gpu, TextureTier::Arrays, 1, SHOW_TEXTURE, 0);
    let made: Vec<_> = (1..=8).map(|w| texture(&gpu, [w, 1], 1, TextureFormat::Rgba8Unorm, |_, _, _| [0; 4])).collect();
    let all: Vec<_> = made.iter().map(|texture| TableTexture { texture, sampler: TableSampler::default() }).collect();
    assert_eq!(classes(&all), 8);
    assert_eq!(table(&gpu, &aa, &all).unwrap_err(), TableError::Classes { classes: 8, most: MAX_CLASSES });
    assert!(table(&gpu, &aa, &all[..7]).is_ok());
    // Seven classes, but one of them does not fit one array.
    let mut crowded = all[..7].to_vec();
    crowded.extend([all[0]; 256]);
    assert_eq!(classes(&crowded), 7);
    assert_eq!(table(&gpu, &aa, &crowded).unwrap_err(), TableError::Classes { classes: 8, most: MAX_CLASSES });
    // More than all arrays together hold.
    let most = MAX_CLASSES * gpu.device.limits().max_texture_array_layers as usize;
    let many = vec![all[0]; most + 1];
    assert_eq!(table(&gpu, &aa, &many).unwrap_err(), TableError::Capacity { textures: most + 1, most });
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

#[test]
fn the_binding_tier_has_its_own_limits() {
    if !has_bindings() {
        return;
    }
    let gpu = device(TextureTier::Bindings);
    let aa = node(&gpu, TextureTier::Bindings, 1, SHOW_TEXTURE, 40);
    let white = flat(&gpu, [255; 4]);
    let modes = [AddressMode::Repeat, AddressMode::MirrorRepeat, AddressMode::ClampToEdge];
    let samplers = (0..33).map(|i| TableSampler {
        address_u: modes[i % 3],
        address_v: modes[i / 3 % 3],
        anisotropy: 1 + (i / 9) as u16,
        nearest: false,
    });
    let all: Vec<_> = samplers.map(|sampler| TableTexture { texture: &white, sampler }).collect();
    assert_eq!(table(&gpu, &aa, &all).unwrap_err(), TableError::Classes { classes: 33, most: MAX_SAMPLERS });
    assert!(table(&gpu, &aa, &all[..32]).is_ok());
    assert!(table(&gpu, &aa, &[all[0]; 40]).is_ok());
    assert_eq!(table(&gpu, &aa, &[all[0]; 41]).unwrap_err(), TableError::Capacity { textures: 41, most: 40 });
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}

#[test]
fn unfit_textures_are_refused_by_their_index() {
    for tier in tiers() {
        let gpu = device(tier);
        let aa = node(&gpu, tier, 1, SHOW_TEXTURE, 16);
        let good = flat(&gpu, [255; 4]);
        let needed = if tier == TextureTier::Arrays { TextureUsages::COPY_SRC } else { TextureUsages::TEXTURE_BINDING };
        let other = |dimension, layers, samples, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: 4, height: 4, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: samples,
                dimension,
                format: TextureFormat::Rgba8Unorm,
                usage,
                view_formats: &[],
            })
        };
        let (two, three) = (wgpu::TextureDimension::D2, wgpu::TextureDimension::D3);
        let rendered = USAGES | TextureUsages::RENDER_ATTACHMENT;
        let unfit = [
            (plain(&gpu, [4, 4], 1, TextureFormat::Rgba8Unorm, USAGES - needed), "lacks"),
            (plain(&gpu, [4, 4], 1, TextureFormat::Rgba32Float, USAGES), "can't be filtered"),
            (plain(&gpu, [4, 4], 1, TextureFormat::R32Uint, USAGES), "can't be filtered"),
            (plain(&gpu, [4, 4], 1, TextureFormat::Depth32Float, USAGES), "can't be filtered"),
            (other(two, 1, 4, rendered), "multisampled"),
            (other(two, 2, 1, USAGES), "single 2D image"),
            (other(three, 2, 1, USAGES), "single 2D image"),
        ];
        let well = TableTexture { texture: &good, sampler: TableSampler::default() };
        let refused = |bad: TableTexture<'_>, part: &str| match table(&gpu, &aa, &[well, well, bad, well]) {
            Err(TableError::Texture { index: 2, problem }) => assert!(problem.contains(part), "{tier:?}: {problem}"),
            other => panic!("{tier:?}, {part}: {other:?}"),
        };
        for (texture, part) in &unfit {
            refused(TableTexture { texture, ..well }, part);
        }
        for anisotropy in [0, 17] {
            refused(TableTexture { sampler: TableSampler { anisotropy, ..well.sampler }, ..well }, "anisotropy");
        }
        assert_eq!(gpu.take_errors(), Vec::<String>::new(), "{tier:?}");
    }
    let gpu = device(TextureTier::None);
    let aa = node(&gpu, TextureTier::None, 1, "fn shade(s: DaaSample) -> vec4f { return s.normal.xyzz; }", 0);
    assert_eq!(table(&gpu, &aa, &[]).unwrap_err(), TableError::NoTier);
}

#[test]
fn nothing_bleeds_over_a_seam_of_materials() {
    // Strong colours, minified 40 times, the seam in the middle of the windows of column 5 at m = 4.
    let (red, blue) = ([255, 0, 0, 255], [0, 0, 255, 255]);
    for tier in tiers() {
        let mut rig = Textured::new(tier, 4, [11, 5], SHOW_TEXTURE, |gpu| {
            let even = |c| texture(gpu, [64, 64], 7, TextureFormat::Rgba8Unorm, move |_, _, _| c);
            vec![(even(red), TableSampler::default()), (even(blue), TableSampler::default())]
        });
        rig.fill(|x, y| Sample {
            uv: Vec2::new(x as f32, y as f32) * 0.6,
            ddx: Vec2::new(0.6, 0.0),
            ddy: Vec2::new(0.0, 0.6),
            material: u32::from(x >= 22),
            object: 1 + u32::from(x >= 22),
            depth: if x >= 22 { 0.1 } else { 0.2 },
            ..Default::default()
        });
        for settings in [full(), single(), Settings::default(), fixed_k(16), fixed_k(3)] {
            for (i, pixel) in rig.run(settings).0.into_iter().enumerate() {
                match i % 11 {
                    0..=4 => assert_eq!(pixel, [1.0, 0.0, 0.0, 1.0], "{tier:?}, {settings:?}"),
                    6.. => assert_eq!(pixel, [0.0, 0.0, 1.0, 1.0], "{tier:?}, {settings:?}"),
                    _ => assert!((pixel[0] + pixel[2] - 1.0).abs() < 1e-6 && pixel[1] == 0.0, "{tier:?}: {pixel:?}"),
                }
            }
        }
    }
}

/// A texture that shows its mip: level l is l/10 all over, so that the trilinear mean shows the fraction too.
pub fn mip_ruler(gpu: &Gpu) -> wgpu::Texture {
    texture(gpu, [512, 512], 10, TextureFormat::R8Unorm, |mip, _, _| [mip as u8 * 25, 0, 0, 0])
}

/// The mip that a pixel of the ruler shows.
pub fn level(pixel: [f32; 4]) -> f32 {
    pixel[0] * 255.0 / 25.0
}

const TEXEL: f32 = 1.0 / 512.0;

/// Two texels a sample, so that `Full` reads mip 1, and k of n samples mip 1 + log2 √(n/k).
fn two_texels(x: u32, y: u32, object: u32) -> Sample {
    let step = 2.0 * TEXEL;
    Sample {
        uv: Vec2::new(x as f32, y as f32) * step,
        ddx: Vec2::new(step, 0.0),
        ddy: Vec2::new(0.0, step),
        object,
        ..Default::default()
    }
}

fn blunt_ruler(tier: TextureTier, m: u32) -> Textured {
    let blunt = TableSampler { anisotropy: 1, ..Default::default() };
    Textured::new(tier, m, [4, 3], SHOW_TEXTURE, |gpu| vec![(mip_ruler(gpu), blunt)])
}

#[track_caller]
fn assert_level(image: &[[f32; 4]], expected: f32, what: &str) {
    for &pixel in image {
        let shown = level(pixel);
        assert!((shown - expected).abs() < 0.06, "{what}: {shown}, not {expected}");
    }
}

#[test]
fn the_footprint_is_the_root_of_n_over_k() {
    for tier in tiers() {
        for m in [2, 3, 4, 8] {
            let mut rig = blunt_ruler(tier, m);
            rig.fill(|x, y| two_texels(x, y, 1 + x % m));
            let n = (m * m) as f32;
            assert_level(&rig.run(full()).0, 1.0, "Full");
            assert_level(&rig.run(single()).0, 1.0 + (m as f32).log2(), "Single");
            for k in [2, 3, m * m / 2, m * m] {
                for execution in [Execution::Loop, Execution::Tiled] {
                    let image = rig.run(Settings { execution, ..fixed_k(k) }).0;
                    // The first sample was shaded before k was known, for the whole window.
                    let others = 1.0 + 0.5 * (n / k as f32).log2();
                    let expected = (1.0 + (m as f32).log2() + (k - 1) as f32 * others) / k as f32;
                    assert_level(&image, expected, &format!("{tier:?}, m = {m}, k = {k}"));
                }
            }
        }
    }
}

#[test]
fn the_footprint_can_be_scaled_down_to_the_sample_s_own() {
    let m = 4;
    let mut rig = blunt_ruler(TextureTier::Arrays, m);
    rig.fill(|x, y| two_texels(x, y, 1 + x % m));
    let with = |k, footprint| {
        let settings = fixed_k(k);
        Settings { windowed: Windowed { footprint, ..settings.windowed }, ..settings }
    };
    for footprint in [0.0, 0.25, 0.5, 0.7, 2.0, 4.0] {
        for k in [2, 4, 16] {
            let of = |k: u32| 1.0 + ((16.0 / k as f32).sqrt() * footprint).max(1.0).log2();
            let expected = (of(1) + (k - 1) as f32 * of(k)) / k as f32;
            assert_level(&rig.run(with(k, footprint)).0, expected, &format!("k = {k}, footprint {footprint}"));
        }
    }
    // The reference and plain deferred shading have theirs.
    for (technique, expected) in [(Technique::Full, 1.0), (Technique::Single, 3.0)] {
        assert_level(&rig.run(Settings { technique, ..with(4, 0.25) }).0, expected, "not Windowed");
    }
}

#[test]
fn the_first_sample_of_an_edge_is_one_of_many() {
    let m = 4;
    let mut rig = blunt_ruler(TextureTier::Arrays, m);
    let aware = |k| {
        let settings = fixed_k(k);
        Settings { windowed: Windowed { edge_aware_first: true, ..settings.windowed }, ..settings }
    };
    // Two objects: the first sample reads as one of n.
    rig.fill(|x, y| two_texels(x, y, 1 + x % m));
    for k in [2, 4] {
        let others = 1.0 + 0.5 * (16.0 / k as f32).log2();
        assert_level(&rig.run(aware(k)).0, (1.0 + (k - 1) as f32 * others) / k as f32, "an edge");
    }
    // One object on a plane: it stands for the window.
    rig.fill(|x, y| two_texels(x, y, 1));
    assert_level(&rig.run(aware(4)).0, 3.0, "no edge");
    rig.fill(|x, y| Sample { depth: 0.1 + 0.003 * x as f32 + 0.002 * y as f32, ..two_texels(x, y, 1) });
    assert_level(&rig.run(aware(4)).0, 3.0, "a slanted plane");
    // A corner of it lies elsewhere, or bends.
    let last = |x: u32, y: u32| x % m == 3 && y % m == 3;
    rig.fill(|x, y| Sample { depth: if last(x, y) { 0.11 } else { 0.1 }, ..two_texels(x, y, 1) });
    assert_level(&rig.run(aware(4)).0, 1.0, "a step");
    rig.fill(|x, y| Sample { normal: if last(x, y) { Vec3::X } else { Vec3::Z }, ..two_texels(x, y, 1) });
    assert_level(&rig.run(aware(4)).0, 1.0, "a crease");
}

#[test]
fn a_device_of_just_what_is_required_runs_every_tier() {
    for tier in tiers() {
        for texture_capacity in [1, 300] {
            let target_format = TextureFormat::Rgba32Float;
            let shading = Shading { source: SHOW_TEXTURE, file: "test.wgsl" };
            let descriptor = Descriptor {
                m: 2,
                target_format,
                shading,
                textures: tier,
                texture_capacity,
                rays: None,
                gbuffer: GBufferTier::default(),
            };
            let adapter = device(tier).adapter;
            let needs = DeferredAa::requirements(&adapter, &descriptor);
            assert_eq!(needs.missing, Vec::<String>::new());
            let gpu = Gpu::with(adapter, needs.features, needs.limits).expect("a device");
            let aa = DeferredAa::new(&gpu.device, &descriptor, None).expect("a node");
            let white = flat(&gpu, [255; 4]);
            table(&gpu, &aa, &[TableTexture { texture: &white, sampler: TableSampler::default() }]).expect("a table");
            assert_eq!(gpu.take_errors(), Vec::<String>::new(), "{tier:?}");
        }
    }
}

#[test]
fn anisotropy_keeps_the_short_side_sharp() {
    for tier in tiers() {
        let mut rig = Textured::new(tier, 1, [2, 2], SHOW_TEXTURE, |gpu| {
            let with = |anisotropy| TableSampler { anisotropy, ..Default::default() };
            vec![(mip_ruler(gpu), with(1)), (mip_ruler(gpu), with(16))]
        });
        // 16 texels along one axis and 2 along the other.
        rig.fill(|x, y| {
            let (long, short) = (Vec2::new(16.0 * TEXEL, 0.0), Vec2::new(0.0, 2.0 * TEXEL));
            let (ddx, ddy) = if y == 0 { (long, short) } else { (short, long) };
            Sample { uv: Vec2::splat(0.5), ddx, ddy, material: x, ..Default::default() }
        });
        let image = rig.run(single()).0;
        for row in image.chunks(2) {
            assert!((level(row[0]) - 4.0).abs() < 0.1, "{tier:?}: {row:?}");
            // Mesa's software driver has no anisotropy for explicit gradients.
            let software = rig.gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
            let sharp = (level(row[1]) - 1.0).abs() < 0.6;
            assert!(sharp || (software && row[1] == row[0]), "{tier:?}: {row:?}");
        }
    }
}
