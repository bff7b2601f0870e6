//! Every technique, execution, view and need over the built-in scenes: the same bits as were written down for this
//! driver. Where another driver runs, techniques are held against each other instead.
//!
//! A run takes each scene at one m and on one tier; with `DEFERRED_AA_BITS=all` at two and on both. With
//! `DEFERRED_AA_BITS=bless` it writes tests/bits.txt anew, for a change that is meant.

use crate::shadows::tiers;
use deferred_aa::rays::RayTier;
use deferred_aa::{
    BINDING_FEATURES, ColorReference, DebugView, Effect, Execution, Goal, Lattice, MultiResolution, Pattern,
    Reconstructed, Selective, Settings, Statistics, Technique, TextureTier, Weight, Windowed, wgpu,
};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options};
use deferred_aa_demo::scene::builtin::{self, builtin};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

const SIZE: [u32; 2] = [37, 21];

/// What the bits depend on: the driver, and whether it may fuse a product with a sum.
fn driver(adapter: &wgpu::Adapter) -> String {
    let info = adapter.get_info();
    #[cfg(target_arch = "x86_64")]
    let fused = std::arch::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    let fused = std::env::consts::ARCH;
    format!("# {}, {} {}, fma {fused}", info.name, info.driver, info.driver_info)
}

/// FNV-1a, which stays the same from one Rust to the next.
struct Hash(u64);

impl Hash {
    fn of(bytes: impl IntoIterator<Item = u8>) -> u32 {
        let mut hash = Self(0xcbf2_9ce4_8422_2325);
        for byte in bytes {
            hash.0 = (hash.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        (hash.0 ^ hash.0 >> 32) as u32
    }

    fn words(words: impl IntoIterator<Item = u64>) -> u32 {
        Self::of(words.into_iter().flat_map(u64::to_le_bytes))
    }
}

/// All that is counted.
fn counters(s: &Statistics) -> Vec<u64> {
    let mut all = vec![s.shaded];
    let words = s.histogram_k.iter().copied().chain(s.decided.values()).chain(s.quadrants.values());
    all.extend(words.chain(s.points.values()).map(u64::from));
    let rays = [s.shadow_rays, s.reflection_rays, s.refraction_rays];
    let samples = [s.not_finite, s.negative, s.overflowed_tiles];
    let tiles = [s.tiles.all, s.tiles.surface, s.tiles.reflect];
    all.extend([rays, samples, tiles].as_flattened().iter().map(|&word| u64::from(word)));
    all.push(s.goal.map_or(0, |goal| goal.effort.to_bits().into()));
    all
}

/// Hashes of the image, the counters and the plan.
fn hashes(host: &mut Host, settings: Settings) -> [u32; 3] {
    let camera = host.scene.default_camera();
    let statistics = host.frame(&camera, settings).expect("a frame").statistics;
    let picture = host.picture().rgba;
    assert!(picture.as_flattened().iter().all(|c| c.is_finite()), "{settings:?}: not finite");
    let planned = !matches!(settings.technique, Technique::Full | Technique::Single);
    let planned =
        planned && (settings.technique != Technique::MultiResolution || settings.multi_resolution.supersampled);
    let plan = if planned { host.plan() } else { Vec::new() };
    [
        Hash::of(picture.as_flattened().iter().flat_map(|c| c.to_le_bytes())),
        Hash::words(counters(&statistics)),
        Hash::words(plan.into_iter().map(|word| {
            // As words were when the hashes were written down: `Selective` had no numbers of samples.
            let selective = settings.technique == Technique::Selective;
            let rest = if selective { word.quadrants() } else { word.before() };
            u64::from(word.0 & 0xffff | rest << 16)
        })),
    ]
}

/// What is rendered of each scene.
fn variants(m: u32) -> Vec<(String, Settings)> {
    let plain = Settings::default();
    let of = |technique| Settings { technique, ..plain };
    let [selective, lattices] = [of(Technique::Selective), of(Technique::MultiResolution)];
    let mut all: Vec<(String, Settings)> =
        Technique::ALL.map(|technique| (format!("{technique:?}"), of(technique))).into();
    let mut add = |name: &str, settings| all.push((name.to_owned(), settings));
    for execution in Execution::ALL {
        add(&format!("Windowed {execution:?}"), Settings { execution, ..plain });
        add(&format!("MultiResolution {execution:?}"), Settings { execution, ..lattices });
    }
    add("Full by luminance", Settings { weight: Weight::Luminance, ..of(Technique::Full) });
    add("Windowed by luminance", Settings { weight: Weight::Luminance, ..plain });
    add("Windowed PAPER", Settings { windowed: Windowed::PAPER, ..plain });
    add("Windowed with a limit", Settings { windowed: Windowed { tile_limit: 40, ..plain.windowed }, ..plain });
    add("Windowed to an error", Settings { goal: Some(Goal::Error(0.01)), ..plain });
    add("Reconstructed PAPER", Settings { reconstructed: Reconstructed::PAPER, ..of(Technique::Reconstructed) });
    add("Selective PAPER", Settings { selective: Selective::PAPER, ..selective });
    add("Selective bilinear", Settings { selective: Selective { bilinear: true, ..plain.selective }, ..selective });
    let gradient = Selective { reference: ColorReference::Gradient, shadow_lights: true, ..plain.selective };
    add("Selective by gradient", Settings { selective: gradient, ..selective });
    for pattern in [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral] {
        if pattern == Pattern::Quad || m > 1 {
            let lattice = Lattice { pattern, coarsest: 3 };
            let of_pattern = MultiResolution { shading: lattice, rays: lattice, ..plain.multi_resolution };
            add(&format!("MultiResolution {pattern:?}"), Settings { multi_resolution: of_pattern, ..lattices });
            let below = MultiResolution { supersampled: false, weighted: true, veto: false, ..of_pattern };
            add(&format!("MultiResolution {pattern:?} below one"), Settings { multi_resolution: below, ..lattices });
        }
    }
    all
}

/// A line for each variant of a scene, and one for the debug views of each technique.
fn lines(name: &str, m: u32, tier: RayTier) -> String {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let textures = match tier {
        RayTier::Query if adapter.features().contains(BINDING_FEATURES) => TextureTier::Bindings,
        _ => TextureTier::Arrays,
    };
    let [width, height] = SIZE;
    let options = Options { textures, anisotropy: 4, rays: tier, ..Options::new(width, height, m) };
    let gpu = Gpu::new(adapter, &options.descriptor()).expect("a device");
    let mut host = Host::new(gpu, builtin(name).expect("a scene"), options).expect("a host");
    let mut text = String::new();
    let mut line = |what: &str, [image, counters, plan]: [u32; 3]| {
        writeln!(text, "{name} m={m} {tier:?} {what}: {image:08x} {counters:08x} {plan:08x}").expect("room");
    };
    for (variant, settings) in variants(m) {
        line(&variant, hashes(&mut host, settings));
        if host.passes(&settings).iter().any(|pass| pass.info.reads.contains(deferred_aa::Resource::Rays)) {
            let none = Settings { shadows: Effect::Off, reflections: Effect::Off, refraction: Effect::Off, ..settings };
            line(&format!("{variant} without rays"), hashes(&mut host, none));
            line(&format!("{variant}, shadows alone"), hashes(&mut host, Settings { shadows: Effect::Auto, ..none }));
        }
        if settings.execution == Execution::Tiled {
            let none = Settings { shadows: Effect::Off, reflections: Effect::Off, refraction: Effect::Off, ..settings };
            for settings in [settings, none, Settings { shadows: Effect::Auto, ..none }] {
                hold_sums(&mut host, &format!("{name} m={m} {tier:?} {variant}"), settings);
            }
        }
    }
    for technique in Technique::ALL {
        let views = DebugView::ALL.map(|view| hashes(&mut host, Settings { technique, view, ..Default::default() }));
        line(&format!("{technique:?}, views"), [0, 1, 2].map(|i| Hash::words(views.map(|v| u64::from(v[i])))));
    }
    text
}

/// `Tiled` adds up the parts of a window, others its samples in turn. The target has halves: sums that are rounded to
/// either side of the middle between two come a step apart.
fn hold_sums(host: &mut Host, what: &str, settings: Settings) {
    let camera = host.scene.default_camera();
    let mut image = |execution| {
        host.frame(&camera, Settings { execution, ..settings }).expect("a frame");
        host.picture().rgba
    };
    let [tiled, in_turn] = [Execution::Tiled, Execution::Sorted].map(&mut image);
    let pairs = tiled.as_flattened().iter().zip(in_turn.as_flattened());
    for (a, b) in pairs.clone() {
        assert!((a - b).abs() <= a.max(*b) / 1024.0, "{what}: {a}, not {b}");
    }
    let differ = pairs.filter(|(a, b)| a != b).count();
    assert!(differ * 100 <= tiled.len(), "{what}: {differ} values of {} pixels are rounded otherwise", tiled.len());
}

/// What does not depend on the driver: all executions but one make the same image and plan, but for the rounding of
/// `Tiled`.
fn hold_against_each_other(text: &str) {
    let lines = by_name(text);
    for (name, found) in &lines {
        for execution in Execution::ALL.into_iter().filter(|&e| e != Execution::MaxFiltered) {
            let as_default = name.replace(&format!(" {execution:?}"), "");
            if as_default != *name {
                let Some(default) = lines.get(as_default.as_str()) else { panic!("{name} alone") };
                let counted = |line: &str| line.split_once(' ').map(|(_, counted)| counted.to_owned());
                // Its image is held by `hold_sums`.
                let is_tiled = execution == Execution::Tiled;
                assert_eq!(counted(default), counted(found), "{name}");
                assert!(is_tiled || default == found, "{name}: {found}, not {default}");
            }
        }
    }
}

#[test]
fn bits_are_as_written_down() {
    let adapter = gpu::choose(std::env::var("WGPU_ADAPTER_NAME").ok().as_deref()).expect("tests need an adapter");
    let driver = driver(&adapter);
    let asked = std::env::var("DEFERRED_AA_BITS").unwrap_or_default();
    let all = !asked.is_empty();
    let tiers = tiers();
    let jobs: Vec<(&str, u32, RayTier)> = builtin::NAMES
        .into_iter()
        .enumerate()
        .flat_map(|(i, name)| (0..4).filter(move |&j| j == i % 4 || all).map(move |j| (name, j)))
        .filter_map(|(name, j)| Some((name, [2, 3][j / 2], *tiers.get(j % 2)?)))
        .collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut made = Vec::new();
        while let Some((job, &(name, m, tier))) = {
            let job = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(job).map(|at| (job, at))
        } {
            made.push((job, lines(name, m, tier)));
        }
        made
    };
    let mut made: Vec<(usize, String)> = std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let all: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        all.into_iter().flat_map(|thread| thread.join().expect("a thread")).collect()
    });
    made.sort();
    let text: String = std::iter::once(driver.clone() + "\n").chain(made.into_iter().map(|(_, text)| text)).collect();
    hold_against_each_other(&text);

    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/bits.txt");
    if asked == "bless" {
        return std::fs::write(file, text).expect("to write tests/bits.txt");
    }
    let written = std::fs::read_to_string(file).expect("tests/bits.txt");
    if written.lines().next() != Some(&driver) {
        return eprintln!("written down for another driver ({written:.80}), not for {driver}: held against each other");
    }
    let written: HashMap<&str, &str> = by_name(&written);
    let made = by_name(&text);
    let mut differ: Vec<String> = made
        .iter()
        .filter(|&(name, found)| written.get(name) != Some(found))
        .map(|(name, found)| format!("{name}: {found}, was {:?}", written.get(name)))
        .collect();
    differ.sort();
    assert!(differ.is_empty(), "{} of {} lines differ:\n{}", differ.len(), made.len(), differ.join("\n"));
    assert!(!all || made.len() == written.len(), "{} lines, {} written down", made.len(), written.len());
}

fn by_name(text: &str) -> HashMap<&str, &str> {
    text.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(": ")).collect()
}
