//! `tune`: presets that reach given errors with the fewest samples on several scenes.

use super::args::{CameraArg, RayArg, SceneArgs, TextureArg, ViewArgs, parse_camera, parse_size};
use super::error::CommandError;
use super::output::{say, write_json};
use crate::host::Shot;
use crate::measure::stats::Spread;
use crate::names::did_you_mean;
use crate::tune::subject::{Figures, Subject, SubjectError, full};
use crate::tune::tunable::Tunable;
use crate::tune::{Point, Task, Tuner};
use deferred_aa::{MultiResolution, Selective, Settings, Surfaces, Windowed};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// See `deferred-aa-demo tune --help`.
#[derive(Debug, clap::Args)]
pub struct Tune {
    /// Whose settings are searched: windowed, selective, multiresolution or surfaces.
    #[arg(long, default_value = "windowed", value_parser = parse_tunable)]
    technique: &'static str,
    /// A built-in scene or a .gltf or .glb file, with its camera after an @ if not its own: FILE@x,y,z,tx,ty,tz,fov.
    /// May be repeated; all built-in scenes but flat and empty if not given.
    #[arg(long = "scene", value_name = "NAME|FILE[@CAMERA]")]
    scenes: Vec<String>,
    /// Pixels, WIDTHxHEIGHT, of every scene.
    #[arg(long, default_value = "320x180", value_parser = parse_size)]
    size: (u32, u32),
    /// Samples along one side of a pixel's window, 2 to 8.
    #[arg(long, short, default_value_t = 4)]
    m: u32,
    /// The least PSNR against full supersampling, in dB, on any of the scenes: of Fast, Balanced and Quality.
    #[arg(long, default_value = "41,45.8,50", value_parser = parse_targets)]
    target_db: Targets,
    /// Rounds of each search, at most; one tries every setting up and down.
    #[arg(long, default_value_t = 5)]
    rounds: usize,
    /// Two rounds at most, and no search with a scene left out.
    #[arg(long)]
    quick: bool,
    /// Part of the adapter's name; `adapters` lists them.
    #[arg(long)]
    adapter: Option<String>,
    /// Where tune.json goes; made if it is not there.
    #[arg(long, overrides_with = "out")]
    out: PathBuf,
}

type Targets = [f64; 3];

const NAMES: [&str; 3] = ["fast", "balanced", "quality"];

/// Timed frames of each preset.
const TIMED: usize = 3;

fn parse_targets(text: &str) -> Result<Targets, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let targets = numbers.ok().and_then(|n| Targets::try_from(n).ok());
    let rising = |t: &Targets| t[0] < t[1] && t[1] < t[2] && t.iter().all(|v| (10.0..=80.0).contains(v));
    targets
        .filter(rising)
        .ok_or_else(|| format!("'{text}' is no three targets: write three rising dB in 10 to 80, such as 41,46,50"))
}

fn parse_tunable(text: &str) -> Result<&'static str, String> {
    let known = [Windowed::TECHNIQUE, Selective::TECHNIQUE, MultiResolution::TECHNIQUE, Surfaces::TECHNIQUE];
    let meant = did_you_mean(text, &known);
    known
        .into_iter()
        .find(|k| *k == text)
        .ok_or_else(|| format!("nothing to tune for '{text}':{meant} choose {}", known.join(", ")))
}

/// tune.json.
#[derive(Debug, Serialize)]
struct Record<T> {
    /// That is tuned.
    technique: &'static str,
    width: u32,
    height: u32,
    m: u32,
    adapter: String,
    scenes: Vec<String>,
    /// In the order of [`NAMES`]; those that are finished.
    presets: Vec<Preset<T>>,
    /// One list a scene: everything that was rendered on it.
    evaluated: Vec<Vec<Tried<T>>>,
}

#[derive(Debug, Serialize)]
struct Tried<T> {
    settings: T,
    figures: Figures,
}

#[derive(Debug, Serialize)]
struct Preset<T> {
    name: &'static str,
    task: Task,
    settings: T,
    mean_cost: f64,
    scenes: Vec<OnScene>,
}

#[derive(Debug, Serialize)]
struct OnScene {
    scene: String,
    figures: Figures,
    /// Found by a search that never saw this scene; null where there was none.
    held_out: Option<Figures>,
    /// GPU time of the node over that of Full, interleaved; null without timestamps.
    time_over_full: Option<Spread>,
}

impl<T: Tunable> Record<T> {
    /// Where the next search begins: at the last preset's settings, the first at [`Tunable::START`].
    fn start(&self) -> T {
        self.presets.last().map_or(T::START, |p| p.settings)
    }
}

impl<T: Tunable> Preset<T> {
    fn new(name: &'static str, task: Task, found: &Point<T>, subjects: &[Subject<T>]) -> Self {
        let on = |(subject, figures): (&Subject<T>, &Figures)| OnScene {
            scene: subject.name.clone(),
            figures: *figures,
            held_out: None,
            time_over_full: None,
        };
        let scenes = subjects.iter().zip(&found.figures).map(on).collect();
        Self { name, task, settings: found.settings, mean_cost: found.mean_cost(), scenes }
    }
}

impl From<SubjectError> for CommandError {
    fn from(e: SubjectError) -> Self {
        match e {
            SubjectError::Host(e) => e.into(),
            SubjectError::Quality(e) => e.into(),
        }
    }
}

impl Tune {
    pub fn run(self) -> Result<(), CommandError> {
        match self.technique {
            Selective::TECHNIQUE => self.tune::<Selective>(),
            MultiResolution::TECHNIQUE => self.tune::<MultiResolution>(),
            Surfaces::TECHNIQUE => self.tune::<Surfaces>(),
            _ => self.tune::<Windowed>(),
        }
    }

    fn tune<T: Tunable>(self) -> Result<(), CommandError> {
        let wrong = |problem: &str| CommandError::Argument { argument: "--m".into(), problem: problem.into() };
        if !(2..=deferred_aa::window::MAX_M).contains(&self.m) {
            return Err(wrong(&format!("{} is not in 2 to 8", self.m)));
        }
        let rounds = if self.quick { self.rounds.min(2) } else { self.rounds };
        let mut subjects = self.subjects::<T>()?;
        let holdout = !self.quick && subjects.len() > 1;
        let (width, height) = self.size;
        let mut record = Record {
            technique: T::TECHNIQUE,
            width,
            height,
            m: self.m,
            adapter: subjects.first().map_or(String::new(), Subject::adapter),
            scenes: subjects.iter().map(|s| s.name.clone()).collect(),
            presets: Vec::new(),
            evaluated: Vec::new(),
        };
        let path = self.out.join("tune.json");
        // A folder that can't be written to is found now and not after the work.
        write_json(&path, &record)?;
        let searches = NAMES.len() * if holdout { 1 + subjects.len() } else { 1 };
        let bar = progress(searches * rounds);
        for (name, floor_db) in NAMES.into_iter().zip(self.target_db) {
            let task = Task { floor_db, rounds };
            let found = search(&mut subjects, None, record.start(), task, &bar, name)?;
            record.presets.push(Preset::new(name, task, &found, &subjects));
            record.evaluated = evaluated(&subjects);
            write_json(&path, &record)?;
        }
        if holdout {
            let mut start = T::START;
            for i in 0..record.presets.len() {
                let preset = &mut record.presets[i];
                hold_out(&mut subjects, preset, start, &bar)?;
                start = preset.settings;
                record.evaluated = evaluated(&subjects);
                write_json(&path, &record)?;
            }
        }
        bar.finish_and_clear();
        measure_times(&mut subjects, &mut record.presets)?;
        record.evaluated = evaluated(&subjects);
        write_json(&path, &record)?;
        say(&summary(&record, &path));
        Ok(())
    }

    fn subjects<T: Tunable>(&self) -> Result<Vec<Subject<T>>, CommandError> {
        let builtin = ["atrium", "fence", "checker", "spheres", "cornell"].map(str::to_owned).to_vec();
        let specs = if self.scenes.is_empty() { builtin } else { self.scenes.clone() };
        let views: Vec<_> = specs.iter().map(|s| self.view(s)).collect::<Result<_, _>>()?;
        // All scenes are opened before the first frame is rendered.
        let opened: Vec<_> = views.iter().map(|view| view.open(&Settings::default())).collect::<Result<_, _>>()?;
        let subject = |(spec, (host, camera))| Ok(Subject::new(spec, host, camera)?);
        specs.into_iter().zip(opened).map(subject).collect()
    }

    /// NAME, FILE, NAME@CAMERA or FILE@CAMERA.
    fn view(&self, spec: &str) -> Result<ViewArgs, CommandError> {
        let wrong = |problem| CommandError::Argument { argument: format!("--scene {spec}"), problem };
        let (scene, camera) = match spec.rsplit_once('@').filter(|_| !Path::new(spec).exists()) {
            Some((scene, camera)) => (scene, Some(parse_camera(camera).map_err(wrong)?)),
            None => (spec, None),
        };
        Ok(self.view_of(scene, camera))
    }

    fn view_of(&self, scene: &str, camera: Option<CameraArg>) -> ViewArgs {
        let scene = SceneArgs {
            scene: scene.to_owned(),
            scene_index: None,
            size: self.size,
            camera,
            stall: 1,
            textures: TextureArg::Arrays,
            rays: RayArg::Software,
            gbuffer: None,
            anisotropy: 16,
            adapter: self.adapter.clone(),
            out: self.out.clone(),
        };
        ViewArgs { scene, m: self.m }
    }
}

/// On stderr where that is a terminal; one step a round.
fn progress(rounds: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3}%  {elapsed}  {msg}");
    ProgressBar::new(rounds as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn search<T: Tunable>(
    subjects: &mut [Subject<T>],
    held_out: Option<usize>,
    start: T,
    task: Task,
    bar: &ProgressBar,
    preset: &str,
) -> Result<Point<T>, SubjectError> {
    let without = held_out.map_or(String::new(), |i| format!(" without {}", subjects[i].name));
    bar.set_message(format!("{preset}{without}"));
    Tuner { subjects, held_out }.search(start, task, |_| bar.inc(1))
}

/// Searches again without each scene in turn, and tries on it what was found without it.
fn hold_out<T: Tunable>(
    subjects: &mut [Subject<T>],
    preset: &mut Preset<T>,
    start: T,
    bar: &ProgressBar,
) -> Result<(), SubjectError> {
    for i in 0..subjects.len() {
        let blind = search(subjects, Some(i), start, preset.task, bar, preset.name)?;
        let figures = subjects[i].figures(blind.settings)?;
        if let Some(scene) = preset.scenes.get_mut(i) {
            scene.held_out = Some(figures);
        }
    }
    Ok(())
}

fn evaluated<T: Tunable>(subjects: &[Subject<T>]) -> Vec<Vec<Tried<T>>> {
    let tried = |s: &Subject<T>| s.tried.iter().map(|&(settings, figures)| Tried { settings, figures }).collect();
    subjects.iter().map(tried).collect()
}

/// Of all passes together.
fn node_ms(shot: &Shot) -> Option<f64> {
    shot.statistics.passes.iter().map(|p| p.milliseconds).sum()
}

/// Full and the presets in turn, after one frame that warms up.
fn measure_times<T: Tunable>(subjects: &mut [Subject<T>], presets: &mut [Preset<T>]) -> Result<(), SubjectError> {
    for (i, subject) in subjects.iter_mut().enumerate() {
        let mut ratios = vec![Vec::new(); presets.len()];
        for round in 0..=TIMED {
            let reference = node_ms(&subject.shot(full())?);
            for (preset, ratios) in presets.iter().zip(&mut ratios) {
                let own = node_ms(&subject.shot(preset.settings.settings())?);
                if let (Some(own), Some(reference), true) = (own, reference, round > 0) {
                    ratios.push(own / reference);
                }
            }
        }
        for (preset, ratios) in presets.iter_mut().zip(ratios) {
            if let Some(scene) = preset.scenes.get_mut(i) {
                scene.time_over_full = Spread::of(ratios);
            }
        }
    }
    Ok(())
}

fn summary<T: Tunable>(record: &Record<T>, path: &Path) -> String {
    let Record { technique, width, height, m, adapter, .. } = record;
    let count = |s: &Vec<Tried<T>>| s.len();
    let frames: usize = record.evaluated.iter().map(count).sum();
    let mut text = format!("{technique}, {width}×{height}, m = {m}, {adapter}: {frames} frames tried\n");
    for preset in &record.presets {
        text += &format!(
            "\n{}, at least {} dB\n{:<34}{:>8}{:>10}{:>10}{:>8}{:>22}\n",
            preset.name, preset.task.floor_db, "", "samples", "PSNR", "edges", "time", "without the scene"
        );
        for scene in &preset.scenes {
            let f = &scene.figures;
            let name: String = scene.scene.chars().rev().take(32).collect::<Vec<_>>().into_iter().rev().collect();
            let time = scene.time_over_full.map_or("-".to_owned(), |t| format!("{:.1}%", t.median * 100.0));
            let blind =
                scene.held_out.map_or("-".to_owned(), |f| format!("{:.1}% {:.1} dB", f.ratio * 100.0, f.psnr_db));
            text += &format!("{name:<34}{:>7.1}%{:>7.1} dB{:>7.1} dB", f.ratio * 100.0, f.psnr_db, f.edge_psnr_db);
            text += &format!("{time:>8}{blind:>22}\n");
        }
        text += &format!("{:<34}{:>7.1}%\n", "geometric mean", preset.mean_cost * 100.0);
    }
    text += "\nsamples, time: over those of Full. PSNR, edges: against Full. Geometric mean: of what was kept low\n";
    for preset in &record.presets {
        text += &format!("\n// {}\n{}\n", preset.name, preset.settings.source());
    }
    text + &path.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_rise() {
        assert_eq!(parse_targets("40, 44.5,50"), Ok([40.0, 44.5, 50.0]));
        for bad in
            ["", "40", "40,44", "40,44,50,60", "44,40,50", "40,40,50", "a,b,c", "nan,40,50", "5,40,50", "40,50,inf"]
        {
            assert!(parse_targets(bad).unwrap_err().contains("three rising dB"), "{bad}");
        }
    }
}
