//! Whole scenes through the demo's host: the built-in ones, models made here for one feature each, and real files where
//! they are at hand.

use crate::harness::{device, has_bindings};
use crate::shadows::probed;
use deferred_aa::glam::{Vec2, Vec3};
use deferred_aa::rays::RayTier;
use deferred_aa::reference::metrics::{Input, Worth};
use deferred_aa::{
    DeferredAa, Effect, Execution, GBufferTier, Preset, Reconstructed, Settings, Technique, TextureTier, wgpu,
};
use deferred_aa_demo::gpu::Gpu;
use deferred_aa_demo::host::{Host, HostError, Options, descriptor};
use deferred_aa_demo::picture::Picture;
use deferred_aa_demo::scene::{Camera, Lens, LightKind, Scene, builtin, load};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

// ---- The host ----

/// A device with no more than the demo's node asks for.
fn gpu(m: u32, tier: TextureTier) -> Gpu {
    let adapter = device(tier).adapter;
    let needs = DeferredAa::requirements(&adapter, &descriptor(m, tier, RayTier::Software, GBufferTier::default()));
    Gpu::with(adapter, needs.features, needs.limits).expect("a device")
}

fn host(scene: Scene, tier: TextureTier, m: u32, [width, height]: [u32; 2]) -> Host {
    let options = Options { textures: tier, anisotropy: 8, ..Options::new(width, height, m) };
    let name = scene.name.clone();
    Host::new(gpu(m, tier), scene, options).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Renders and checks what holds of every frame: no complaint of wgpu's, every number finite.
fn shot(host: &mut Host, camera: &Camera, settings: Settings) -> (Picture, deferred_aa::Statistics) {
    let name = host.scene.name.clone();
    let shot = host.frame(camera, settings).unwrap_or_else(|e| panic!("{name}, {settings:?}: {e}"));
    let picture = host.picture();
    assert!(picture.rgba.iter().flatten().all(|c| c.is_finite()), "{name}, {settings:?}: not finite");
    assert_eq!((shot.statistics.not_finite, shot.statistics.negative), (0, 0), "{name}, {settings:?}");
    assert_eq!(host.gpu.take_errors(), Vec::<String>::new(), "{name}");
    (picture, shot.statistics)
}

/// What the metrics of the host's last frame read, as the twin takes it.
fn with_input<T>(host: &Host, probed: &[bool], use_it: impl FnOnce(&Input<'_>) -> T) -> T {
    let gbuffer = host.aa.gbuffer().expect("a size");
    let depth: Vec<f32> = bytemuck::pod_collect_to_vec(&host.gpu.read_texture(gbuffer.depth.texture(), 4));
    let surface: Vec<[u32; 2]> = bytemuck::pod_collect_to_vec(&host.gpu.read_texture(gbuffer.color[0].texture(), 8));
    let passed = host.aa.intermediates().expect("a size");
    let first: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&host.gpu.read_texture(passed.first, 16));
    let bits: Vec<u32> =
        passed.shadows.map_or(Vec::new(), |buffer| bytemuck::pod_collect_to_vec(&host.gpu.read_buffer(buffer)));
    let pixels = (0..host.options.height).flat_map(|y| (0..host.options.width).map(move |x| (x, y)));
    let shadow: Vec<u32> = pixels.filter_map(|(x, y)| bits.get(passed.slots.pixel(x, y)).copied()).collect();
    use_it(&Input {
        m: host.aa.m() as usize,
        width: host.options.width as usize,
        height: host.options.height as usize,
        depth: &depth,
        surface: &surface,
        first: &first,
        user: &[],
        shadow: &shadow,
        probed,
        exposure: 1.0,
    })
}

/// Holds k of a windowed frame against the twin: equal, but where the metric is next to a half, which is rare.
fn assert_twin_agrees(host: &mut Host, camera: &Camera, settings: &Settings) {
    let probed = probed(host, camera, settings, settings.windowed.shadow_reach);
    shot(host, camera, *settings);
    let counts = host.counts(Technique::Windowed);
    let worths: Vec<Worth> = with_input(host, &probed, |input| {
        (0..counts.len()).map(|i| input.worth(i % input.width, i / input.width, &settings.windowed)).collect()
    });
    let apart: Vec<_> = (0..counts.len()).filter(|&i| worths[i].k != counts[i]).collect();
    for &i in &apart {
        assert!(worths[i].is_near_a_half(), "{}, window {i}: GPU {}, twin {:?}", host.scene.name, counts[i], worths[i]);
    }
    assert!(apart.len() <= (counts.len() / 10_000).max(1), "{}: {} windows differ", host.scene.name, apart.len());
}

/// Steps of f16 between two values of one sign.
fn half_steps(a: f32, b: f32) -> f32 {
    let ulp = (2f32.powi((a.abs().max(b.abs()).max(2f32.powi(-14))).log2().floor() as i32)) / 1024.0;
    (a - b).abs() / ulp
}

// ---- Built-in scenes ----

fn builtin_scene(name: &str) {
    let scene = builtin::builtin(name).unwrap();
    let camera = scene.default_camera();
    let mut arrays = host(scene, TextureTier::Arrays, 4, [96, 54]);
    let tiled = Settings::default();
    let (picture, statistics) = shot(&mut arrays, &camera, tiled);
    assert_twin_agrees(&mut arrays, &camera, &tiled);
    let again = shot(&mut arrays, &camera, tiled);
    assert!(
        (&again.0.rgba, &again.1.histogram_k) == (&picture.rgba, &statistics.histogram_k),
        "{name}: not the same twice"
    );

    let paper = Settings { windowed: deferred_aa::Windowed::PAPER, ..tiled };
    assert_twin_agrees(&mut arrays, &camera, &paper);

    for reconstructed in [Reconstructed::default(), Reconstructed::PAPER] {
        let settings = Settings { technique: Technique::Reconstructed, reconstructed, ..tiled };
        let once = shot(&mut arrays, &camera, settings);
        assert!(shot(&mut arrays, &camera, settings).0.rgba == once.0.rgba, "{name}: not the same twice");
        assert!(once.1.mean_k < 16.0);
    }

    for execution in Execution::ALL {
        let (other, counted) = shot(&mut arrays, &camera, Settings { execution, ..tiled });
        if execution == Execution::MaxFiltered {
            assert!(counted.shaded >= statistics.shaded, "{name}: fewer samples");
            continue;
        }
        assert_eq!(counted.histogram_k, statistics.histogram_k, "{name}: {execution:?}");
        let worst = picture.rgba.iter().flatten().zip(other.rgba.iter().flatten()).map(|(&a, &b)| half_steps(a, b));
        assert!(worst.fold(0.0, f32::max) <= 1.0, "{name}: {execution:?} is further off than a step of f16");
    }

    let (full, of_full) = shot(&mut arrays, &camera, Settings { technique: Technique::Full, ..tiled });
    assert_eq!(of_full.mean_k, 16.0);
    let (single, of_single) = shot(&mut arrays, &camera, Settings { technique: Technique::Single, ..tiled });
    assert_eq!(of_single.mean_k, 1.0);
    if ["flat", "empty"].contains(&name) {
        assert_eq!(statistics.mean_k, 1.0, "{name}: nothing to resolve");
        for (m, size) in [(2, [160, 270]), (3, [17, 13]), (8, [64, 36])] {
            let mut other = host(builtin::builtin(name).unwrap(), TextureTier::Arrays, m, size);
            let (picture, statistics) = shot(&mut other, &camera, tiled);
            assert_eq!(statistics.mean_k, 1.0, "{name} at {size:?}: nothing to resolve");
            let (single, _) = shot(&mut other, &camera, Settings { technique: Technique::Single, ..tiled });
            assert_eq!(picture.rgba, single.rgba);
        }
    } else {
        assert!((1.05..14.0).contains(&statistics.mean_k), "{name}: mean k {}", statistics.mean_k);
        let error = |picture: &Picture| deferred_aa_demo::quality::psnr(picture, &full).unwrap();
        assert!(error(&picture) > error(&single) + 1.0, "{name}: {} dB, Single {}", error(&picture), error(&single));
        // At so few pixels nearly each is an edge: all samples keep the results of their own rays.
        let of_presets = Preset::ALL.map(|preset| {
            let settings = Settings { ray_samples: 15.0, ..preset.settings() };
            let (picture, counted) = shot(&mut arrays, &camera, settings);
            assert_twin_agrees(&mut arrays, &camera, &settings);
            assert_eq!(counted.without_rays, 0, "{name}");
            (counted.shaded, error(&picture))
        });
        // On SwiftShader thin wires cover other samples, and fall in and out of fewer.
        let slack = if crate::drivers::is_swiftshader(&arrays.gpu) { 1.5 } else { 0.0 };
        let rising = |a: &(u64, f64), b: &(u64, f64)| a.0 < b.0 && a.1 < b.1 + slack;
        assert!(of_presets.is_sorted_by(rising), "{name}: samples and dB of the presets: {of_presets:?}");
        assert!(of_presets[2].0 < of_full.shaded, "{name}: {of_presets:?}");
    }

    if has_bindings() {
        let mut bindings = host(builtin::builtin(name).unwrap(), TextureTier::Bindings, 4, [96, 54]);
        for (settings, expected) in [(tiled, &picture), (Settings { technique: Technique::Full, ..tiled }, &full)] {
            let (other, _) = shot(&mut bindings, &camera, settings);
            let apart =
                expected.rgba.iter().flatten().zip(other.rgba.iter().flatten()).map(|(&a, &b)| half_steps(a, b));
            assert!(apart.fold(0.0, f32::max) <= 1.0, "{name}: the tiers differ");
        }
    }
}

#[test]
fn atrium() {
    builtin_scene("atrium");
}

#[test]
fn fence() {
    builtin_scene("fence");
}

#[test]
fn checker() {
    builtin_scene("checker");
}

#[test]
fn spheres() {
    builtin_scene("spheres");
}

#[test]
fn cornell() {
    builtin_scene("cornell");
}

#[test]
fn mirrors() {
    builtin_scene("mirrors");
}

#[test]
fn shadows() {
    builtin_scene("shadows");
}

#[test]
fn flat() {
    builtin_scene("flat");
}

#[test]
fn empty() {
    builtin_scene("empty");
}

#[test]
fn no_builtin_scene_goes_untested() {
    assert_eq!(
        builtin::NAMES,
        ["atrium", "fence", "checker", "spheres", "cornell", "shadows", "mirrors", "flat", "empty"]
    );
}

/// With no more storage buffers a stage than WebGPU promises, which rays exceed.
#[test]
fn scenes_without_rays_are_drawn_within_plain_limits() {
    let adapter = device(TextureTier::Arrays).adapter;
    let limits = wgpu::Limits { max_storage_buffers_per_shader_stage: 8, ..adapter.limits() };
    for name in ["checker", "flat"] {
        let scene = builtin::builtin(name).unwrap();
        assert!(!deferred_aa_demo::host::traces(&scene, &Settings::default()), "{name}");
        let gbuffer = deferred_aa_demo::host::stored(&scene);
        let options = Options { traces: false, gbuffer, ..Options::new(48, 32, 2) };
        let gpu = Gpu::with(adapter.clone(), wgpu::Features::empty(), limits.clone()).expect("a device");
        let camera = scene.default_camera();
        let mut host = Host::new(gpu, scene, options).unwrap_or_else(|e| panic!("{name}: {e}"));
        for technique in Technique::ALL {
            shot(&mut host, &camera, Settings { technique, ..Default::default() });
        }
        let shadows = Settings { shadows: Effect::On, ..Default::default() };
        assert!(deferred_aa_demo::host::traces(&host.scene, &shadows));
        assert!(matches!(host.frame(&camera, shadows), Err(HostError::NoRays)), "{name}");
    }
}

// ---- Models made here ----

/// Bytes as a data uri; percent encoding needs no encoder.
pub fn uri(mime: &str, bytes: &[u8]) -> String {
    bytes.iter().fold(format!("data:{mime},"), |mut text, byte| {
        let _ = write!(text, "%{byte:02x}");
        text
    })
}

/// A PNG without compression.
pub fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        !bytes.iter().fold(!0u32, |crc, &b| {
            (0..8).fold(crc ^ u32::from(b), |c, _| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 })
        })
    };
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        let body = [kind, data].concat();
        file.extend([&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat());
    };
    chunk(b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, 6, 0, 0, 0]].concat());
    let rows: Vec<u8> = rgba.chunks(4 * width as usize).flat_map(|row| [&[0], row].concat()).collect();
    let (a, b) = rows.iter().fold((1, 0), |(a, b), &v| ((a + u32::from(v)) % 65_521, (a + u32::from(v) + b) % 65_521));
    let length = rows.len() as u16;
    let stored =
        [&[0x78, 1, 1][..], &length.to_le_bytes(), &(!length).to_le_bytes(), &rows, &(b << 16 | a).to_be_bytes()];
    chunk(b"IDAT", &stored.concat());
    chunk(b"IEND", &[]);
    file
}

/// A glTF file under construction: squares of 2 × 2 side by side around (2 i, 0, 0), so that one picture shows many
/// materials.
#[derive(Default)]
struct Model {
    buffers: Vec<String>,
    accessors: Vec<String>,
    meshes: Vec<String>,
    nodes: Vec<String>,
    materials: Vec<String>,
    textures: Vec<String>,
    images: Vec<String>,
    /// After sampler 0, which all textures have that do not say otherwise.
    samplers: Vec<String>,
    /// More top-level members, each with a comma in front.
    rest: String,
}

/// A primitive.
fn triangles(attributes: &str, indices: usize, material: usize) -> String {
    format!(r#""attributes":{{{attributes}}},"indices":{indices},"material":{material}"#)
}

const POSITIONS: [f32; 12] = [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0];
/// The picture is upright on the square.
const UVS: [f32; 8] = [0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

impl Model {
    fn bytes(&mut self, bytes: &[u8]) -> usize {
        self.buffers.push(format!(
            r#"{{"byteLength":{},"uri":"{}"}}"#,
            bytes.len(),
            uri("application/octet-stream", bytes)
        ));
        self.buffers.len() - 1
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8], rest: &str) -> usize {
        let view = self.bytes(bytes);
        let kind = format!(r#""type":"{kind}","componentType":{component},"count":{count}"#);
        self.accessors.push(format!(r#"{{"bufferView":{view},{kind}{rest}}}"#));
        self.accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let size = if kind == "SCALAR" { 1 } else { usize::from(kind.as_bytes()[3] - b'0') };
        self.accessor(kind, 5126, values.len() / size, bytemuck::cast_slice(values), "")
    }

    fn indices(&mut self, indices: &[u16]) -> usize {
        self.accessor("SCALAR", 5123, indices.len(), bytemuck::cast_slice(indices), "")
    }

    fn material(&mut self, json: &str) -> usize {
        self.materials.push(format!("{{{json}}}"));
        self.materials.len() - 1
    }

    /// A texture of one row.
    fn texture(&mut self, texels: &[[u8; 4]]) -> usize {
        let file = png(texels.len() as u32, 1, texels.as_flattened());
        self.images.push(format!(r#"{{"uri":"{}"}}"#, uri("image/png", &file)));
        self.textures.push(format!(r#"{{"source":{},"sampler":0}}"#, self.images.len() - 1));
        self.textures.len() - 1
    }

    /// The attributes of the usual square.
    fn square(&mut self) -> String {
        let positions = self.floats("VEC3", &POSITIONS);
        let normals = self.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
        let uvs = self.floats("VEC2", &UVS);
        format!(r#""POSITION":{positions},"NORMAL":{normals},"TEXCOORD_0":{uvs}"#)
    }

    /// A primitive in the next place to the right; `node` has more members of the node, with a comma in front.
    fn place(&mut self, primitive: &str, node: &str) {
        self.meshes.push(format!(r#"{{"primitives":[{{{primitive}}}]}}"#));
        let at = 2 * self.nodes.len();
        self.nodes.push(format!(r#"{{"mesh":{},"translation":[{at},0,0]{node}}}"#, self.meshes.len() - 1));
    }

    fn draw(&mut self, material: usize) {
        let attributes = self.square();
        let indices = self.indices(&[0, 1, 2, 0, 2, 3]);
        self.place(&triangles(&attributes, indices, material), "");
    }

    /// Loads it from a file, as a user would.
    #[track_caller]
    fn load(&self, name: &str, scene: Option<usize>) -> Scene {
        let views: Vec<_> = (0..self.buffers.len())
            .map(|i| {
                let length = self.buffers[i].split([':', ',']).nth(1).unwrap_or_default();
                format!(r#"{{"buffer":{i},"byteLength":{length}}}"#)
            })
            .collect();
        let mut file = r#"{"asset":{"version":"2.0"}"#.to_owned();
        let near = r#"{"magFilter":9728,"minFilter":9728}"#.to_owned();
        let samplers: Vec<_> = [near].into_iter().chain(self.samplers.iter().cloned()).collect();
        let arrays = [
            ("buffers", &self.buffers),
            ("bufferViews", &views),
            ("accessors", &self.accessors),
            ("meshes", &self.meshes),
            ("nodes", &self.nodes),
            ("materials", &self.materials),
            ("textures", &self.textures),
            ("images", &self.images),
            ("samplers", &samplers),
        ];
        for (key, values) in arrays.into_iter().filter(|(_, values)| !values.is_empty()) {
            let _ = write!(file, r#","{key}":[{}]"#, values.join(","));
        }
        let _ = write!(file, "{}}}", self.rest);
        let folder = std::env::temp_dir().join(format!("deferred-aa-scenes-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(format!("{name}.gltf"));
        std::fs::write(&path, file).unwrap();
        let scene = load::load(&path, scene).unwrap_or_else(|e| panic!("{e}"));
        scene.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
        let _ = std::fs::remove_file(&path);
        scene
    }
}

/// 16 pixels for each of `count` places, seen straight on.
struct Row {
    picture: Picture,
}

impl Row {
    fn of(scene: Scene, count: u32) -> Self {
        Self::kept(scene, count, GBufferTier::default())
    }

    fn kept(scene: Scene, count: u32, gbuffer: GBufferTier) -> Self {
        let x = count as f32 - 1.0;
        let lens = Lens::Orthographic { half_height: 1.0, far: 20.0 };
        let camera =
            Camera { eye: Vec3::new(x, 0.0, 10.0), target: Vec3::new(x, 0.0, 0.0), up: Vec3::Y, lens, near: 0.1 };
        let name = scene.name.clone();
        let options = Options { gbuffer, anisotropy: 8, ..Options::new(16 * count, 16, 2) };
        let gpu = Gpu::new(device(TextureTier::Arrays).adapter, &options.descriptor()).expect("a device");
        let mut host = Host::new(gpu, scene, options).unwrap_or_else(|e| panic!("{name}: {e}"));
        Self { picture: shot(&mut host, &camera, Settings { technique: Technique::Full, ..Default::default() }).0 }
    }

    fn pixel(&self, x: u32, y: u32) -> Vec3 {
        let [r, g, b, _] = self.picture.rgba[(y * self.picture.width + x) as usize];
        Vec3::new(r, g, b)
    }

    /// At (u, v) of a place, from its upper left corner.
    fn at(&self, place: u32, u: f32, v: f32) -> Vec3 {
        self.pixel(place * 16 + (u * 16.0) as u32, (v * 16.0) as u32)
    }

    /// Near its middle.
    fn middle(&self, place: u32) -> Vec3 {
        self.at(place, 0.5, 0.5)
    }
}

#[track_caller]
fn assert_near(a: Vec3, b: Vec3, what: &str) {
    assert!((a - b).abs().max_element() <= 0.004 + 0.004 * b.abs().max_element(), "{what}: {a}, not {b}");
}

const UNLIT: &str = r#","extensions":{"KHR_materials_unlit":{}}"#;

fn unlit(color: [f32; 4]) -> String {
    format!(r#""pbrMetallicRoughness":{{"baseColorFactor":{color:?}}}{UNLIT}"#)
}

const RED: Vec3 = Vec3::X;
const GREEN: Vec3 = Vec3::Y;
const BLUE: Vec3 = Vec3::Z;

#[test]
fn all_five_textures_have_their_effect() {
    let mut model = Model::default();
    let two = model.texture(&[[255, 0, 0, 255], [0, 255, 0, 255]]);
    let glossy = model.texture(&[[0, 128, 255, 255]]);
    let matt = model.texture(&[[255, 255, 0, 255]]);
    let [straight, up, down] =
        [[128, 128, 255, 255], [128, 230, 204, 255], [128, 26, 204, 255]].map(|t| model.texture(&[t]));
    let half = model.texture(&[[128, 255, 255, 255]]);
    let pbr = |rest: &str| format!(r#""pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":1{rest}}}"#);
    let plain = pbr("");
    let strong = r#""KHR_materials_emissive_strength":{"emissiveStrength":5}"#;
    let materials = [
        // 0: the base colour, alone.
        format!(r#""pbrMetallicRoughness":{{"baseColorTexture":{{"index":{two}}}}}{UNLIT}"#),
        // 1, 2: a map of metal and roughness, and factors that say the same. 3, 4: the other ends.
        format!(r#""pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":{glossy}}}}}"#),
        r#""pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0.50196}"#.to_owned(),
        format!(r#""pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":{matt}}}}}"#),
        plain.clone(),
        // 5 to 7: normals straight, up, down. 8: up, with a scale of 0.
        format!(r#"{plain},"normalTexture":{{"index":{straight}}}"#),
        format!(r#"{plain},"normalTexture":{{"index":{up}}}"#),
        format!(r#"{plain},"normalTexture":{{"index":{down}}}"#),
        format!(r#"{plain},"normalTexture":{{"index":{up},"scale":0}}"#),
        // 9, 10: occlusion by half, and ignored.
        format!(r#"{plain},"occlusionTexture":{{"index":{half}}}"#),
        format!(r#"{plain},"occlusionTexture":{{"index":{half},"strength":0}}"#),
        // 11 to 13: emission by factor, by factor and map, and stronger.
        format!(r#"{plain},"emissiveFactor":[0,0,1]"#),
        format!(r#"{plain},"emissiveFactor":[1,0,1],"emissiveTexture":{{"index":{two}}}"#),
        format!(r#"{plain},"emissiveFactor":[0,0,1],"extensions":{{{strong}}}"#),
    ];
    for material in &materials {
        let material = model.material(material);
        model.draw(material);
    }
    let row = Row::of(model.load("textures", None), materials.len() as u32);
    assert_near(row.at(0, 0.25, 0.5), RED, "base colour");
    assert_near(row.at(0, 0.75, 0.5), GREEN, "base colour");
    assert_near(row.middle(1), row.middle(2), "metallic and roughness");
    assert_near(row.middle(3), row.middle(4), "metallic and roughness");
    assert!(row.middle(2).distance(row.middle(4)) > 0.1, "metal looks like plastic");
    assert_near(row.middle(5), row.middle(4), "straight normals");
    // The sun stands high, and green is up.
    assert!(row.middle(6).y > 1.15 * row.middle(4).y, "normals: {} {}", row.middle(6), row.middle(4));
    assert!(row.middle(7).y < 0.85 * row.middle(4).y, "normals: {} {}", row.middle(7), row.middle(4));
    assert_near(row.middle(8), row.middle(4), "normals scaled to nothing");
    assert!(row.middle(9).y < row.middle(4).y - 0.05, "occlusion");
    assert!(row.middle(9).y > 0.4 * row.middle(4).y, "occlusion darkens the sun too");
    assert_near(row.middle(10), row.middle(4), "occlusion of strength 0");
    let glow = |place, u| row.at(place, u, 0.5) - row.middle(4);
    assert_near(glow(11, 0.5), BLUE, "emission");
    assert_near(glow(12, 0.25), RED, "emission by a map");
    assert_near(glow(12, 0.75), Vec3::ZERO, "emission by a map");
    assert_near(glow(13, 0.5), BLUE * 5.0, "emission of strength 5");
}

#[test]
fn masks_have_holes_and_sides_are_as_said() {
    let mut model = Model::default();
    let half = model.texture(&[[255, 255, 255, 255], [255, 255, 255, 0]]);
    let faint = model.texture(&[[255, 255, 255, 100]]);
    let masked = |texture, rest: &str| {
        let base = format!(r#""baseColorTexture":{{"index":{texture}}},"baseColorFactor":[1,0,0,1]"#);
        format!(r#""alphaMode":"MASK","pbrMetallicRoughness":{{{base}}}{UNLIT}{rest}"#)
    };
    let red = unlit([1.0, 0.0, 0.0, 1.0]);
    // 0: half of it is hole. 1, 2: an alpha of 100 under the default cutoff and over a lower one. 3: opaque anyway.
    let materials = [
        masked(half, ""),
        masked(faint, ""),
        masked(faint, r#","alphaCutoff":0.3"#),
        masked(half, "").replace("MASK", "OPAQUE"),
    ];
    for material in &materials {
        let material = model.material(material);
        model.draw(material);
    }
    // 4: seen from behind. 5: from behind, both sides drawn. 6: behind a hole there is another wall.
    let [one, both] = [red.clone(), format!(r#"{red},"doubleSided":true"#)].map(|m| model.material(&m));
    for material in [one, both] {
        let attributes = model.square();
        let indices = model.indices(&[0, 2, 1, 0, 3, 2]);
        model.place(&triangles(&attributes, indices, material), "");
    }
    model.draw(0);
    let blue = model.material(&unlit([0.0, 0.0, 1.0, 1.0]));
    let attributes = model.square();
    let indices = model.indices(&[0, 1, 2, 0, 2, 3]);
    model
        .meshes
        .push(format!(r#"{{"primitives":[{{"attributes":{{{attributes}}},"indices":{indices},"material":{blue}}}]}}"#));
    model.nodes.push(format!(r#"{{"mesh":{},"translation":[12,0,-1]}}"#, model.meshes.len() - 1));

    let scene = model.load("sides", None);
    let sky = scene.sky;
    let row = Row::of(scene, 7);
    // Straight on in an orthographic view the sky is that of the horizon.
    let expected = [
        (0, 0.25, RED),
        (0, 0.75, sky.horizon),
        (1, 0.5, sky.horizon),
        (2, 0.5, RED),
        (3, 0.75, RED),
        (4, 0.5, sky.horizon),
        (5, 0.5, RED),
        (6, 0.25, RED),
        (6, 0.75, BLUE),
    ];
    for (place, u, color) in expected {
        assert_near(row.at(place, u, 0.5), color, &format!("place {place} at {u}"));
    }
}

#[test]
fn back_sides_and_mirrored_nodes_are_lit_like_fronts() {
    let mut model = Model::default();
    let two = model.texture(&[[255, 128, 128, 255], [128, 255, 128, 255]]);
    let up = model.texture(&[[128, 230, 204, 255]]);
    let pbr = format!(r#"{{"metallicFactor":0,"baseColorTexture":{{"index":{two}}}}}"#);
    let lit = format!(r#""pbrMetallicRoughness":{pbr},"normalTexture":{{"index":{up}}}"#);
    let material = model.material(&format!(r#"{lit},"doubleSided":true"#));
    let single = model.material(&lit);
    let primitive = |model: &mut Model, material: usize, normal: f32, indices: [u16; 6]| {
        let positions = model.floats("VEC3", &POSITIONS);
        let normals = model.floats("VEC3", &[0.0, 0.0, normal].repeat(4));
        let uvs = model.floats("VEC2", &UVS);
        let indices = model.indices(&indices);
        let attributes = format!(r#""POSITION":{positions},"NORMAL":{normals},"TEXCOORD_0":{uvs}"#);
        triangles(&attributes, indices, material)
    };
    let (front, back) = ([0, 1, 2, 0, 2, 3], [0, 2, 1, 0, 3, 2]);
    // 0: the front. 1: from behind, with the normal away from the eye. 2, 3: mirrored in x, one-sided and two-sided.
    // 4: mirrored in x and y, a half turn. 5: mirrored in z, which turns its back on us, so that nothing is seen.
    for (material, normal, indices, node) in [
        (single, 1.0, front, ""),
        (material, -1.0, back, ""),
        (single, 1.0, front, r#","scale":[-1,1,1]"#),
        (material, 1.0, front, r#","scale":[-1,1,1]"#),
        (single, 1.0, front, r#","scale":[-1,-1,1]"#),
        (single, 1.0, front, r#","scale":[1,1,-1]"#),
    ] {
        let primitive = primitive(&mut model, material, normal, indices);
        model.place(&primitive, node);
    }
    let scene = model.load("mirrored", None);
    let sky = scene.sky.horizon;
    let row = Row::of(scene, 6);
    let (left, right) = (row.at(0, 0.25, 0.5), row.at(0, 0.75, 0.5));
    assert!(left.x > left.y && right.y > right.x, "{left} {right}");
    for place in [2, 3] {
        assert_near(row.at(place, 0.75, 0.5), left, "mirrored in x: the picture turns over, the light does not");
        assert_near(row.at(place, 0.25, 0.5), right, "mirrored in x");
    }
    // A back's tangent frame is the front's turned over, so that the map's up stays up.
    assert_near(row.at(1, 0.25, 0.5), left, "the back of a two-sided square");
    // The map's up is down now, away from the sun.
    assert!(row.at(4, 0.75, 0.5).x < 0.7 * left.x, "a half turn: {} {left}", row.at(4, 0.75, 0.5));
    assert_near(row.middle(5), sky, "a back");
}

#[test]
fn vertex_colors_texture_transforms_and_unlit() {
    let mut model = Model::default();
    let two = model.texture(&[[255, 0, 0, 255], [0, 255, 0, 255]]);
    let four = model.texture(&[[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]]);
    let transformed = |texture, transform: &str| {
        let info = format!(r#"{{"index":{texture},"extensions":{{"KHR_texture_transform":{{{transform}}}}}}}"#);
        format!(r#""pbrMetallicRoughness":{{"baseColorTexture":{info}}}{UNLIT}"#)
    };
    // 0: shifted by half. 1: twice as often. 2: a quarter turn. 3: a quarter of it, enlarged. 4: plain colour.
    let materials = [
        transformed(two, r#""offset":[0.5,0]"#),
        transformed(two, r#""scale":[2,1]"#),
        transformed(two, r#""rotation":1.5707964"#),
        transformed(four, r#""offset":[0.5,0],"scale":[0.25,1]"#),
        unlit([0.25, 0.5, 0.75, 1.0]),
    ];
    for material in &materials {
        let material = model.material(material);
        model.draw(material);
    }
    // 5: black to red from left to right, green from below to above.
    let white = model.material(&unlit([1.0; 4]));
    let colors = model.floats("VEC4", &[0., 0., 0., 1., 1., 0., 0., 1., 1., 1., 0., 1., 0., 1., 0., 1.]);
    let attributes = model.square();
    let indices = model.indices(&[0, 1, 2, 0, 2, 3]);
    model.place(&triangles(&format!(r#"{attributes},"COLOR_0":{colors}"#), indices, white), "");
    let row = Row::of(model.load("transforms", None), 6);
    assert_near(row.at(0, 0.25, 0.5), GREEN, "offset");
    assert_near(row.at(0, 0.75, 0.5), RED, "offset");
    for (u, color) in [(0.1, RED), (0.4, GREEN), (0.6, RED), (0.9, GREEN)] {
        assert_near(row.at(1, u, 0.5), color, "scale");
    }
    // u' = cos·u + sin·v = v.
    assert_near(row.at(2, 0.5, 0.25), RED, "rotation");
    assert_near(row.at(2, 0.5, 0.75), GREEN, "rotation");
    assert_near(row.at(3, 0.2, 0.5), BLUE, "offset and scale");
    assert_near(row.at(3, 0.8, 0.5), BLUE, "offset and scale");
    assert_near(row.middle(4), Vec3::new(0.25, 0.5, 0.75), "unlit");
    for (x, y) in [(2, 3), (13, 5), (8, 14)] {
        let expected = Vec3::new((x as f32 + 0.5) / 16.0, 1.0 - (y as f32 + 0.5) / 16.0, 0.0);
        assert_near(row.pixel(80 + x, y), expected, "vertex colours");
    }
}

#[test]
fn odd_geometry_fills_its_square() {
    let mut model = Model::default();
    let red = model.material(&unlit([1.0, 0.0, 0.0, 1.0]));
    // 0: bytes. 1: sparse, its third corner moved from the first one's place. 2: a strip. 3: a fan. 4: no indices.
    let bytes = POSITIONS.map(|p| (p * 127.0) as i8 as u8);
    let quantized = model.accessor("VEC3", 5120, 4, &bytes, r#","normalized":true"#);
    let mut collapsed = POSITIONS;
    collapsed[6..9].copy_from_slice(&POSITIONS[..3]);
    let place = model.bytes(&[2, 0]);
    let value = model.bytes(bytemuck::cast_slice(&POSITIONS[6..9]));
    let moved = format!(r#""indices":{{"bufferView":{place},"componentType":5123}},"values":{{"bufferView":{value}}}"#);
    let sparse = format!(r#","sparse":{{"count":1,{moved}}}"#);
    let sparse = model.accessor("VEC3", 5126, 4, bytemuck::cast_slice(&collapsed), &sparse);
    let positions = model.floats("VEC3", &POSITIONS);
    let list: Vec<f32> = [0, 1, 2, 0, 2, 3].iter().flat_map(|&i| POSITIONS[3 * i..3 * i + 3].to_vec()).collect();
    let list = model.floats("VEC3", &list);
    let [list_of_two, strip, fan] =
        [vec![0, 1, 2, 0, 2, 3], vec![0, 1, 3, 2], vec![0, 1, 2, 3]].map(|i| model.indices(&i));
    for (positions, rest) in [
        (quantized, format!(r#","indices":{list_of_two}"#)),
        (sparse, format!(r#","indices":{list_of_two}"#)),
        (positions, format!(r#","indices":{strip},"mode":5"#)),
        (positions, format!(r#","indices":{fan},"mode":6"#)),
        (list, String::new()),
    ] {
        model.place(&format!(r#""attributes":{{"POSITION":{positions}}},"material":{red}{rest}"#), "");
    }
    model.rest =
        r#","extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"]"#.to_owned();
    let row = Row::of(model.load("geometry", None), 5);
    for place in 0..5 {
        for y in 0..16 {
            for x in 0..16 {
                assert_near(row.pixel(place * 16 + x, y), RED, &format!("place {place}, pixel {x}, {y}"));
            }
        }
    }
}

#[test]
fn punctual_lights_shine_where_they_should() {
    for (i, kind) in ["point", "spot", "directional"].into_iter().enumerate() {
        let mut model = Model::default();
        let white = model.material(r#""pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":1}"#);
        model.draw(white);
        let light = match kind {
            "spot" => r#"{"type":"spot","intensity":6,"spot":{"innerConeAngle":0.3,"outerConeAngle":0.4}}"#,
            "point" => r#"{"type":"point","intensity":6,"color":[1,0.5,0.25]}"#,
            _ => r#"{"type":"directional","intensity":3}"#,
        };
        model.rest = format!(r#","extensions":{{"KHR_lights_punctual":{{"lights":[{light}]}}}}"#);
        // At (0.5, 0, 1), looking at the square.
        model.nodes.push(r#"{"translation":[0.5,0,1],"extensions":{"KHR_lights_punctual":{"light":0}}}"#.to_owned());
        let scene = model.load(&format!("light {i}"), None);
        assert_eq!(scene.sun.is_some(), kind == "directional");
        let intensity = scene.lights.first().map_or(Vec3::ZERO, |l| l.intensity);
        assert!(scene.lights.first().is_none_or(|l| matches!(l.kind, LightKind::Point) == (kind == "point")));
        let row = Row::of(scene, 1);
        let (under, far) = (row.at(0, 0.76, 0.49), row.at(0, 0.03, 0.03));
        match kind {
            "directional" => assert_near(under, far, "a directional light is even"),
            _ => assert!(under.y > 2.0 * far.y, "{kind}: {under} {far}"),
        }
        if kind == "spot" {
            // Outside of the cone there is the sky's light alone, as in the other corner.
            assert_near(far, row.at(0, 0.03, 0.95), "outside of the cone");
            assert_near(row.at(0, 0.3, 0.49), far, "outside of the cone");
        }
        if kind == "point" {
            // Over the sky's light: white paper at 1 m under I candela has I/π, but for its highlight.
            let direct = under - row.at(0, 0.03, 0.03);
            let ratio = direct.x / (intensity.x / std::f32::consts::PI);
            assert!((0.8..1.1).contains(&ratio), "{ratio}");
            assert!((direct.z / direct.x - 0.25).abs() < 0.02, "its colour: {direct}");
        }
    }
}

#[test]
fn scenes_and_cameras_of_a_file() {
    let mut model = Model::default();
    let [red, green] = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]].map(|c| model.material(&unlit(c)));
    model.draw(red);
    model.draw(green);
    // Nodes 2 and 3: cameras before the green square, wide and orthographic.
    model.nodes.push(r#"{"camera":0,"translation":[2,0,3]}"#.to_owned());
    model.nodes.push(r#"{"camera":1,"translation":[2,0,3]}"#.to_owned());
    model.rest = r#","cameras":[{"type":"perspective","perspective":{"yfov":1.2,"znear":0.1}},
        {"type":"orthographic","orthographic":{"xmag":0.5,"ymag":0.5,"znear":0.1,"zfar":10}}],
        "scene":1,"scenes":[{"nodes":[0]},{"nodes":[1,2,3]}]"#
        .to_owned();
    let view = |scene: Scene, camera: Option<usize>| {
        let camera = camera.map_or_else(|| scene.default_camera(), |i| scene.cameras[i]);
        let mut host = host(scene, TextureTier::Arrays, 2, [24, 16]);
        Row { picture: shot(&mut host, &camera, Settings::default()).0 }
    };
    let scene = model.load("scenes", None);
    assert_eq!((scene.cameras.len(), scene.instances.len()), (2, 1));
    // 3 m from a square of 2 m: it fills 2/(2 · 3 tan 0.6) = 0.49 of the height.
    let wide = view(scene.clone(), None);
    assert_near(wide.pixel(12, 8), GREEN, "the file's own scene and camera");
    assert_near(wide.pixel(12, 5), GREEN, "inside");
    assert!(wide.pixel(12, 2).distance(GREEN) > 0.3 && wide.pixel(6, 8).distance(GREEN) > 0.3, "outside");
    // The orthographic one sees the middle of it alone.
    let close = view(scene, Some(1));
    for (x, y) in [(5, 0), (12, 15), (18, 8)] {
        assert_near(close.pixel(x, y), GREEN, "orthographic");
    }
    let other = model.load("scenes", Some(0));
    assert!(other.cameras.is_empty());
    assert_near(view(other, None).pixel(12, 8), RED, "the scene asked for, and a camera that frames it");
}

#[test]
fn wrap_modes_of_a_file() {
    // Texture coordinates from −1 to 2, so that each wrap mode shows: along u clamped, mirrored, repeated.
    let mut model = Model::default();
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255]];
    let uvs =
        UVS.chunks(2).map(|uv| Vec2::new(uv[0] * 3.0 - 1.0, uv[1])).flat_map(|v| v.to_array()).collect::<Vec<_>>();
    for wrap in [33_071, 33_648, 10_497] {
        let texture = model.texture(&texels);
        let sampler = texture + 1;
        model.textures[texture] = format!(r#"{{"source":{texture},"sampler":{sampler}}}"#);
        model.samplers.push(format!(r#"{{"magFilter":9728,"minFilter":9728,"wrapS":{wrap}}}"#));
        let material =
            model.material(&format!(r#""pbrMetallicRoughness":{{"baseColorTexture":{{"index":{texture}}}}}{UNLIT}"#));
        let positions = model.floats("VEC3", &POSITIONS);
        let uvs = model.floats("VEC2", &uvs);
        let indices = model.indices(&[0, 1, 2, 0, 2, 3]);
        let attributes = format!(r#""POSITION":{positions},"TEXCOORD_0":{uvs}"#);
        model.place(&triangles(&attributes, indices, material), "");
    }
    let row = Row::of(model.load("wraps", None), 3);
    let expected = [
        [RED, RED, RED, GREEN, GREEN, GREEN],
        [GREEN, RED, RED, GREEN, GREEN, RED],
        [RED, GREEN, RED, GREEN, RED, GREEN],
    ];
    for (place, expected) in (0..).zip(expected) {
        for (i, color) in (0..).zip(expected) {
            assert_near(row.at(place, (i as f32 + 0.5) / 6.0, 0.5), color, &format!("mode {place}, sixth {i}"));
        }
    }
}

/// A material that shows a texture as it is.
fn shows(texture: usize) -> String {
    format!(r#""pbrMetallicRoughness":{{"baseColorTexture":{{"index":{texture}}}}}{UNLIT}"#)
}

/// More kinds of sampler than the array tier has classes, for colours and for data: all 18, and those alone that clamp or
/// mirror, which fewer suffice for.
#[test]
fn every_mix_of_wrap_modes_is_drawn() {
    const WRAPS: [u32; 3] = [10_497, 33_648, 33_071];
    // The texel that is seen in each half of −1 to 2, by wrap mode.
    let seen = |mode: usize, half: usize| match mode {
        0 => half % 2,
        1 => [1, 0, 0, 1, 1, 0][half],
        _ => [0, 0, 0, 1, 1, 1][half],
    };
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let uvs: Vec<f32> = UVS.iter().map(|c| c * 3.0 - 1.0).collect();
    for modes in [&[0, 1, 2][..], &[1, 2]] {
        let mut model = Model::default();
        let pairs: Vec<_> = modes.iter().flat_map(|&u| modes.iter().map(move |&v| (u, v))).collect();
        for &(u, v) in &pairs {
            let colors = model.texture(&[[0; 4]]);
            model.images[colors] = format!(r#"{{"uri":"{}"}}"#, uri("image/png", &png(2, 2, texels.as_flattened())));
            let data = model.texture(&[[0; 4]; 2]);
            let sampler = 1 + model.samplers.len();
            let filter = if (u + v) % 2 == 0 { r#""magFilter":9728,"minFilter":9728"# } else { r#""magFilter":9728"# };
            model.samplers.push(format!(r#"{{{filter},"wrapS":{},"wrapT":{}}}"#, WRAPS[u], WRAPS[v]));
            for texture in [colors, data] {
                model.textures[texture] = format!(r#"{{"source":{texture},"sampler":{sampler}}}"#);
            }
            let material = model.material(&format!(r#"{},"occlusionTexture":{{"index":{data}}}"#, shows(colors)));
            let positions = model.floats("VEC3", &POSITIONS);
            let uvs = model.floats("VEC2", &uvs);
            let indices = model.indices(&[0, 1, 2, 0, 2, 3]);
            let attributes = format!(r#""POSITION":{positions},"TEXCOORD_0":{uvs}"#);
            model.place(&triangles(&attributes, indices, material), "");
        }
        let row = Row::of(model.load("mixes", None), pairs.len() as u32);
        for (place, &(u, v)) in (0..).zip(&pairs) {
            for (x, y) in (0..6).flat_map(|x| (0..6).map(move |y| (x, y))) {
                let [r, g, b, _] = texels[seen(u, x) + 2 * seen(v, y)].map(|c| f32::from(c) / 255.0);
                let at = row.at(place, (x as f32 + 0.5) / 6.0, (y as f32 + 0.5) / 6.0);
                assert_near(at, Vec3::new(r, g, b), &format!("modes {u}, {v} of {modes:?}, {x}, {y}"));
            }
        }
    }
}

#[test]
fn textures_magnified_by_nearest_are_sharp_at_any_size_and_number_of_sizes() {
    let sizes = [[2, 1], [3, 1], [4, 1], [5, 1], [6, 1], [7, 1], [8, 1], [3, 2], [5, 2], [7, 3]];
    for filter in
        [r#""magFilter":9728,"minFilter":9728"#, r#""magFilter":9728"#, r#""magFilter":9728,"minFilter":9987"#]
    {
        let mut model = Model::default();
        model.samplers.push(format!("{{{filter}}}"));
        for [width, height] in sizes {
            let texture = model.texture(&[[0; 4]]);
            let texel =
                |i: u32| if (i % width + i / width).is_multiple_of(2) { [255, 0, 0, 255] } else { [0, 255, 0, 255] };
            let file = png(width, height, (0..width * height).map(texel).collect::<Vec<_>>().as_flattened());
            model.images[texture] = format!(r#"{{"uri":"{}"}}"#, uri("image/png", &file));
            model.textures[texture] = format!(r#"{{"source":{texture},"sampler":1}}"#);
            let material = model.material(&shows(texture));
            model.draw(material);
        }
        let row = Row::of(model.load("pixels", None), sizes.len() as u32);
        for (place, [width, height]) in (0..).zip(sizes) {
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
                let at = row.at(place, (x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
                let right = if (x + y).is_multiple_of(2) { RED } else { GREEN };
                assert_near(at, right, &format!("{filter}, {width}x{height}, texel {x}, {y}"));
            }
        }
    }
}

#[test]
fn textures_far_away_are_read_from_their_mips_whatever_the_filter() {
    // 128 texels on 16 pixels.
    let mut model = Model::default();
    let texels: Vec<[u8; 4]> = (0..128).map(|i| if i % 2 == 0 { [255, 0, 0, 255] } else { [0, 255, 0, 255] }).collect();
    for min in [9728, 9987] {
        model.samplers.push(format!(r#"{{"magFilter":9728,"minFilter":{min}}}"#));
        let texture = model.texture(&texels);
        model.textures[texture] = format!(r#"{{"source":{texture},"sampler":{}}}"#, model.samplers.len());
        let material = model.material(&shows(texture));
        model.draw(material);
    }
    let row = Row::of(model.load("minified", None), 2);
    for place in 0..2 {
        assert!((row.middle(place) - Vec3::new(0.5, 0.5, 0.0)).length() < 0.02, "{}", row.middle(place));
    }
}

/// Slanted squares under nodes of these scales, or of their signs alone: as large in the world either way. Along an axis
/// of scale 0 nothing slants.
fn scaled(scales: &[[f32; 3]], by_node: bool) -> Scene {
    let mut model = Model::default();
    let material = model.material(r#""pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.8}"#);
    for &scale in scales {
        let bulge = if scale[2] == 0.0 { 0.0 } else { 0.5 };
        let own = scale.map(|s: f32| if by_node && s != 0.0 { 1.0 / s.abs() } else { 1.0 });
        let corner = |p: &[f32; 3]| [p[0] * own[0], p[1] * own[1], bulge * p[0] * own[2]];
        let positions: Vec<_> = POSITIONS.as_chunks::<3>().0.iter().flat_map(corner).collect();
        let positions = model.floats("VEC3", &positions);
        let indices = model.indices(&[0, 1, 2, 0, 2, 3]);
        let attributes = format!(r#""POSITION":{positions}"#);
        let scale = if by_node { scale } else { scale.map(|s| if s < 0.0 { -1.0 } else { 1.0 }) };
        model.place(&triangles(&attributes, indices, material), &format!(r#","scale":{scale:?}"#));
    }
    model.load("scales", None)
}

#[test]
fn nodes_of_any_scale_are_lit_alike() {
    let scales = [
        [1e10; 3],
        [1e-12; 3],
        [1e15; 3],
        [1e15, 1.0, 1e-12],
        [1e-18, 1e18, 1.0],
        [-1e10, 1e10, 1e10],
        [-1e-14, -1e-14, 1e14],
        [3.0, 0.5, 0.0],
    ];
    let places = scales.len() as u32;
    let scene = scaled(&scales, true);
    let visible = deferred_aa_demo::host::gbuffer_tier(&scene, &device(TextureTier::Arrays).adapter);
    for gbuffer in [GBufferTier::default(), visible] {
        let [found, right] = [scene.clone(), scaled(&scales, false)].map(|scene| Row::kept(scene, places, gbuffer));
        for (place, scale) in (0..).zip(scales) {
            let what = format!("{scale:?}, {gbuffer:?}");
            assert!(right.middle(place).min_element() > 0.1, "{what}: {}", right.middle(place));
            let flat = scale[2] == 0.0;
            let at = |row: &Row| if flat { row.at(place, 0.5, 0.5) } else { row.at(place, 0.25, 0.75) };
            assert_near(at(&found), at(&right), &what);
        }
    }
}

// ---- Real files ----

/// The folder of scenes, if it is at hand.
pub fn folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    let found = std::env::var_os("DEFERRED_AA_SCENES").map(PathBuf::from).or_else(|| beside.is_dir().then_some(beside));
    if found.is_none() {
        eprintln!("skipped: set DEFERRED_AA_SCENES to the folder of test scenes");
    }
    found
}

/// All files below a folder, in order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        if entry.is_dir() {
            all.extend(files(&entry));
        } else {
            all.push(entry);
        }
    }
    all.sort();
    all
}

fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "gltf" || e == "glb")
}

/// The most memory that this process has held, in bytes.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches(" kB").parse::<u64>().ok()? * 1024)
}

#[test]
fn damaged_files_end_in_an_error_or_a_sane_scene() {
    let Some(folder) = folder() else { return };
    let before = peak();
    let (mut loaded, mut refused) = (0, 0);
    // Whatever is there is tried, pictures and buffers too.
    let all = files(&folder.join("invalid"));
    for path in &all {
        let start = Instant::now();
        match load::load(path, None) {
            Ok(scene) => {
                scene.validate().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                loaded += 1;
            }
            Err(e) => {
                let message = e.to_string();
                assert!(message.starts_with(&path.display().to_string()), "{message}");
                assert!(!message.contains('\n') && message.contains("; "), "no cure: {message}");
                refused += 1;
            }
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{}: {:?}", path.display(), start.elapsed());
    }
    assert!(loaded >= 5 && refused >= 20, "{loaded} loaded, {refused} refused of {}", all.len());
    if let (Some(before), Some(after)) = (before, peak()) {
        assert!(after - before < 1 << 30, "{} MiB more", (after - before) >> 20);
    }
}

#[test]
fn conformance_models_load_or_are_refused_by_name() {
    let Some(folder) = folder() else { return };
    let models: Vec<_> = files(&folder.join("conformance")).into_iter().filter(|p| is_model(p)).collect();
    assert!(models.len() >= 35, "{} models", models.len());
    for path in models {
        let start = Instant::now();
        match load::load(&path, None) {
            Ok(scene) => {
                scene.validate().unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                assert!(!scene.instances.is_empty() || !scene.notices.is_empty(), "{}: nothing", path.display());
            }
            Err(e) => {
                let message = e.to_string();
                assert!(path.ends_with("Box-Draco/Box.gltf"), "{message}");
                assert!(message.contains("KHR_draco_mesh_compression"), "{message}");
            }
        }
        assert!(start.elapsed() < Duration::from_secs(10), "{}: {:?}", path.display(), start.elapsed());
    }
}

fn real(name: &str) {
    let Some(folder) = folder() else { return };
    let model = files(&folder.join(name)).into_iter().find(|p| is_model(p)).expect("a model");
    let scene = load::load(&model, None).unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, TextureTier::Arrays, 2, [48, 27]);
    let (picture, statistics) = shot(&mut host, &camera, Settings::default());
    assert_twin_agrees(&mut host, &camera, &Settings::default());
    // Something is to be seen, and it has edges.
    let first = picture.rgba[0];
    assert!(picture.rgba.iter().filter(|p| **p != first).count() > 100, "{name}: an empty picture");
    assert!(statistics.mean_k > 1.0 && statistics.mean_k < 4.0, "{name}: {}", statistics.mean_k);
    shot(&mut host, &camera, Settings { technique: Technique::Full, ..Default::default() });
}

#[test]
fn texture_coordinate_test() {
    real("conformance/TextureCoordinateTest");
}

#[test]
fn negative_scale_test() {
    real("conformance/NegativeScaleTest");
}

#[test]
fn box_vertex_colors() {
    real("conformance/BoxVertexColors");
}

#[test]
fn damaged_helmet() {
    real("damaged_helmet");
}

#[test]
fn tree_cards() {
    real("tree_cards");
}

/// More samples than a batch of `Packed` holds, so that windows of several batches meet in one image.
#[test]
fn batches_meet() {
    let scene = builtin::builtin("checker").unwrap();
    let camera = scene.default_camera();
    let mut host = host(scene, TextureTier::Arrays, 4, [900, 640]);
    let windowed = deferred_aa::Windowed { least_samples: 16.0, ..Default::default() };
    let settings = Settings { windowed, execution: Execution::Loop, ..Default::default() };
    let (looped, counted) = shot(&mut host, &camera, settings);
    assert!(counted.shaded > (1 << 22) + 900 * 640, "{} samples", counted.shaded);
    let (packed, _) = shot(&mut host, &camera, Settings { execution: Execution::Packed, ..settings });
    assert!(packed.rgba == looped.rgba);
}
