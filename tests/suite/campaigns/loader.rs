//! Damaged glTF files: the loader refuses each, or makes a sound scene of it; it never panics, hangs or takes more
//! memory than the file is worth.

use super::models::{self, Model};
use super::random::Random;
use super::{Campaign, is_soak, resident};
use crate::scenes;
use deferred_aa_demo::scene::load::load_bytes;
use serde_json::{Value, json};
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::time::Duration;

pub const CAMPAIGN: Campaign = Campaign {
    name: "loader",
    share: 0.2,
    few: 40,
    limit: Duration::from_secs(5),
    start: || {
        let sources = Sources::new();
        Box::new(move |seed| sources.check(seed))
    },
};

/// The number of files of a seed.
const FILES: u32 = 50;
/// The most memory that loading may take.
const MOST_MEMORY: u64 = 1 << 30;

/// What is damaged.
struct Sources {
    models: Vec<(Model, Vec<String>)>,
    /// Real files with their contents.
    files: Vec<(PathBuf, Vec<u8>)>,
}

impl Sources {
    fn new() -> Self {
        let models = models::all().into_iter().map(|model| {
            let sound = load_bytes(&model.glb(), Path::new("model.glb"), None).expect("an undamaged model");
            assert_eq!(sound.validate(), Ok(()));
            let mut places = Vec::new();
            list(&model.json, String::new(), &mut places);
            (model, places)
        });
        Self { models: models.collect(), files: real_files() }
    }

    /// Loads damaged files; returns how many.
    fn check(&self, seed: u32) -> u64 {
        let before = is_soak().then(forget_peak).flatten();
        for i in 0..FILES {
            let mut random = Random::new(seed.wrapping_mul(FILES).wrapping_add(i));
            let (path, file) = self.damaged(&mut random);
            let loaded = catch_unwind(|| load_bytes(&file, path, None));
            let loaded = loaded.unwrap_or_else(|_| panic!("file {i}: the loader panicked at {}", shown(&file)));
            if let Ok(scene) = loaded {
                assert_eq!(scene.validate(), Ok(()), "file {i}: {}", shown(&file));
            }
        }
        if let (Some(before), Some(peak)) = (before, peak()) {
            assert!(peak <= before + MOST_MEMORY, "one of {FILES} files took {} bytes", peak - before);
        }
        u64::from(FILES)
    }

    fn damaged(&self, random: &mut Random) -> (&Path, Vec<u8>) {
        if !self.files.is_empty() && random.once_in(20) {
            let (path, file) = &self.files[random.below(self.files.len() as u32) as usize];
            let mut file = file.clone();
            damage_bytes(random, &mut file);
            return (path, file);
        }
        let (model, places) = &self.models[random.below(self.models.len() as u32) as usize];
        let mut model = model.clone();
        let way = random.below(8);
        if way < 6 {
            (0..1 + random.below(3)).for_each(|_| damage_json(random, &mut model.json, places));
        }
        if way == 5 || way == 6 {
            damage_bytes(random, &mut model.bin);
        }
        let mut file = model.glb();
        if way == 7 {
            damage_bytes(random, &mut file);
        }
        (Path::new("model.glb"), file)
    }
}

/// Small files of the folder of real scenes.
fn real_files() -> Vec<(PathBuf, Vec<u8>)> {
    let Some(folder) = scenes::folder() else { return Vec::new() };
    let is_small = |path: &PathBuf| std::fs::metadata(path).is_ok_and(|meta| meta.len() < 20_000);
    let is_model = |path: &PathBuf| path.extension().is_some_and(|e| e == "gltf" || e == "glb");
    let models = scenes::files(&folder).into_iter().filter(|path| is_model(path) && is_small(path));
    models.map(|path| (path.clone(), std::fs::read(path).expect("a file"))).collect()
}

/// The JSON of a file, for messages.
fn shown(file: &[u8]) -> String {
    String::from_utf8_lossy(&file[..file.len().min(6000)]).into_owned()
}

/// The pointers to all values of a tree.
fn list(value: &Value, place: String, places: &mut Vec<String>) {
    match value {
        Value::Object(members) => members.iter().for_each(|(key, v)| list(v, format!("{place}/{key}"), places)),
        Value::Array(elements) => {
            elements.iter().enumerate().for_each(|(i, v)| list(v, format!("{place}/{i}"), places));
        }
        _ => {}
    }
    places.push(place);
}

fn damage_json(random: &mut Random, json: &mut Value, places: &[String]) {
    let place = &places[random.below(places.len() as u32) as usize];
    let other = json.pointer(&places[random.below(places.len() as u32) as usize]).cloned();
    if random.once_in(8)
        && let Some((parent, key)) = place.rsplit_once('/')
    {
        match json.pointer_mut(parent) {
            Some(Value::Object(members)) => drop(members.remove(key)),
            Some(Value::Array(elements)) => {
                let copy = elements.first().cloned().unwrap_or_default();
                elements.resize(elements.len() * 2 + 1, copy);
            }
            _ => {}
        }
        return;
    }
    let Some(value) = json.pointer_mut(place) else { return };
    *value = match (random.below(4), &*value, other) {
        (0, ..) => anything(random),
        (1, _, Some(other)) => other,
        (_, Value::Number(number), _) => near(random, number.as_f64().unwrap_or(0.0)),
        (_, Value::String(text), _) => spoilt(random, text).into(),
        (_, Value::Array(elements), _) if !elements.is_empty() => {
            let mut elements = elements.clone();
            elements.rotate_left(1);
            elements.truncate(random.below(elements.len() as u32 + 1) as usize);
            elements.into()
        }
        _ => anything(random),
    };
}

/// A number that a check could be off by, or that overflows what is computed from it.
fn near(random: &mut Random, number: f64) -> Value {
    const EXTREMES: [u64; 12] =
        [0, 1, 2, 255, 65_535, 65_536, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x1_0000_0000, 1 << 62, u64::MAX];
    match random.below(6) {
        0 => json!(number + 1.0),
        1 => json!((number as i64).saturating_add(i64::from(random.below(9)) - 4)),
        2 => json!(random.pick(&EXTREMES)),
        3 => json!(random.pick(&[-1.0, 0.0, 1e-45, 1e38, 3.5e38, 1e300, -1e300, 5e-324, 0.5])),
        4 => json!(random.pick(&[i64::MIN, -1, i64::MAX])),
        _ => json!(random.pick(&[5120, 5121, 5122, 5123, 5124, 5125, 5126, 4, 5, 6])),
    }
}

fn anything(random: &mut Random) -> Value {
    match random.below(9) {
        0 => Value::Null,
        1 => json!([]),
        2 => json!({}),
        3 => json!(random.once_in(2)),
        4 => json!("line\nbreak"),
        5 => json!([0, 0, 0, 0]),
        6 => (0..random.pick(&[10, 100, 200])).fold(Value::Null, |inner, _| json!([inner])),
        7 => json!([[1e38, -1e38], { "index": 0 }]),
        _ => near(random, 0.0),
    }
}

fn spoilt(random: &mut Random, text: &str) -> String {
    const TEXTS: [&str; 12] = [
        "",
        "SCALAR",
        "VEC2",
        "VEC3",
        "VEC4",
        "MAT4",
        "BLEND",
        "OPAQUE",
        "../../../../dev/zero",
        "data:,",
        "data:;base64,A",
        "%ff%00",
    ];
    let mut text = if random.once_in(3) { text.to_owned() } else { random.pick(&TEXTS).to_owned() };
    text.truncate(text.floor_char_boundary(random.below(text.len() as u32 + 1) as usize));
    text
}

fn damage_bytes(random: &mut Random, bytes: &mut Vec<u8>) {
    for _ in 0..1 + random.below(6) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len() as u32) as usize;
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.bits() as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.splice(at..at, bytes[..at.min(9)].to_vec()).collect::<Vec<_>>()),
            _ => {
                let word = random.pick(&[f32::NAN, f32::INFINITY, 1e38, -0.0, 1e-45, f32::from_bits(u32::MAX)]);
                let at = at / 4 * 4;
                if let Some(place) = bytes.get_mut(at..at + 4) {
                    place.copy_from_slice(&word.to_le_bytes());
                }
            }
        }
    }
}

/// Has the system forget the greatest memory of the process so far; returns what it takes now.
fn forget_peak() -> Option<u64> {
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    resident()
}

/// The greatest memory of the process in bytes.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(kilobytes.trim().trim_end_matches(" kB").parse::<u64>().ok()? * 1024)
}
