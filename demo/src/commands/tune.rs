//! `tune`: presets that reach given errors with the fewest samples on several scenes.

use super::args::{CameraArg, RayArg, SceneArgs, TextureArg, ViewArgs, parse_camera, parse_size};
use super::error::CommandError;
use super::output::{say, write_json};
use crate::host::Shot;
use crate::measure::stats::Spread;
use crate::names::did_you_mean;
use crate::tune::subject::{Figures, PHASES, Subject, SubjectError, full};
use crate::tune::tunable::Tunable;
use crate::tune::{Floor, Point, Task, Tuner};
use deferred_aa::{MultiResolution, Preset, Selective, Settings, Surfaces, Windowed};
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
    /// One that takes no part in the search: what was found is measured on it, to see whether it holds elsewhere. May be
    /// repeated.
    #[arg(long = "unseen", value_name = "NAME|FILE[@CAMERA]")]
    unseen: Vec<String>,
    /// Pixels, WIDTHxHEIGHT, of every scene.
    #[arg(long, default_value = "320x180", value_parser = parse_size)]
    size: (u32, u32),
    /// Samples along one side of a pixel's window, 2 to 8.
    #[arg(long, short, default_value_t = 4)]
    m: u32,
    /// The least PSNR against full supersampling, in dB, on any of the scenes: of Fast, Balanced and Quality. If not
    /// given, what the crate's own presets reach: in the mean over the scenes no worse in PSNR, at edges, in FLIP and in
    /// flicker, and on none by more than 1.5 dB. Where the crate has no presets, 41,45.8,50.
    #[arg(long, value_parser = parse_targets)]
    target_db: Option<Targets>,
    /// Rounds of each search, at most; one tries every setting up and down.
    #[arg(long, default_value_t = 5)]
    rounds: usize,
    /// Part of the adapter's name; `adapters` lists them.
    #[arg(long)]
    adapter: Option<String>,
    /// Where tune.json goes; made if it is not there.
    #[arg(long, overrides_with = "out")]
    out: PathBuf,
}

type Targets = [f64; 3];

/// Where the crate has no presets of a technique, and none are given.
const FLOORS_DB: Targets = [41.0, 45.8, 50.0];

const PRESETS: [(&str, Preset); 3] =
    [("fast", Preset::Fast), ("balanced", Preset::Balanced), ("quality", Preset::Quality)];

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
    /// That took no part in the search.
    unseen: Vec<String>,
    /// In the order of [`PRESETS`]; those that are finished.
    presets: Vec<Found<T>>,
    /// One list a scene, the unseen ones last: everything that was rendered on it.
    evaluated: Vec<Vec<Tried<T>>>,
}

#[derive(Debug, Serialize)]
struct Tried<T> {
    settings: T,
    figures: Figures,
}

#[derive(Debug, Serialize)]
struct Found<T> {
    name: &'static str,
    task: Task,
    settings: T,
    /// Those of the crate; null where it has none.
    own_settings: Option<T>,
    /// Whether they reach the floor.
    reached: bool,
    /// Over the scenes of the search.
    mean_cost: f64,
    scenes: Vec<OnScene>,
}

#[derive(Debug, Serialize)]
struct OnScene {
    scene: String,
    /// Whether it took no part in the search.
    unseen: bool,
    /// What was found.
    found: Measured,
    /// The crate's own preset; null where it has none.
    own: Option<Measured>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Measured {
    figures: Figures,
    /// GPU time of the node over that of Full, interleaved; null without timestamps.
    time_over_full: Option<Spread>,
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
        let mut subjects = self.subjects::<T>()?;
        // Those that the search sees come first.
        let seen = subjects.len() - self.unseen.len();
        let (width, height) = self.size;
        let mut record = Record {
            technique: T::TECHNIQUE,
            width,
            height,
            m: self.m,
            adapter: subjects.first().map_or(String::new(), Subject::adapter),
            scenes: subjects[..seen].iter().map(|s| s.name.clone()).collect(),
            unseen: self.unseen.clone(),
            presets: Vec::new(),
            evaluated: Vec::new(),
        };
        let path = self.out.join("tune.json");
        // A folder that can't be written to is found now and not after the work.
        write_json(&path, &record)?;
        let bar = progress(PRESETS.len() * self.rounds);
        for (i, (name, preset)) in PRESETS.into_iter().enumerate() {
            bar.set_message(name);
            let mut tuner = Tuner { subjects: &mut subjects[..seen] };
            // A technique without a preset for each target has a default, which is none of them.
            let own = T::own(preset).filter(|_| self.target_db.is_none() && T::own(Preset::Fast).is_some());
            let (start, floor) = match own {
                Some(own) => (own, Floor::Like(tuner.point(own)?.figures)),
                // The next search begins where the last one ended.
                None => {
                    let last = record.presets.last().map(|p| p.settings);
                    (last.unwrap_or(T::START), Floor::Db(self.target_db.unwrap_or(FLOORS_DB)[i]))
                }
            };
            let task = Task { floor, rounds: self.rounds };
            let point = tuner.search(start, &task, |_| bar.inc(1))?;
            record.presets.push(Found::new(name, task, &point, T::own(preset), (&mut subjects, seen))?);
            record.evaluated = evaluated(&subjects);
            write_json(&path, &record)?;
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
        let mut specs = if self.scenes.is_empty() { builtin } else { self.scenes.clone() };
        specs.extend(self.unseen.iter().cloned());
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

impl<T: Tunable> Found<T> {
    /// Tries what was found, and the crate's own, on all scenes.
    fn new(
        name: &'static str,
        task: Task,
        point: &Point<T>,
        own_settings: Option<T>,
        (subjects, seen): (&mut [Subject<T>], usize),
    ) -> Result<Self, SubjectError> {
        let settings = point.settings;
        let on = |(i, subject): (usize, &mut Subject<T>)| {
            let mut measured = |settings| {
                Ok::<_, SubjectError>(Measured { figures: subject.figures(settings)?, time_over_full: None })
            };
            let (found, own) = (measured(settings)?, own_settings.map(measured).transpose()?);
            Ok::<_, SubjectError>(OnScene { scene: subject.name.clone(), unseen: i >= seen, found, own })
        };
        let scenes = subjects.iter_mut().enumerate().map(on).collect::<Result<_, _>>()?;
        let (reached, mean_cost) = (point.reaches(&task), point.mean_cost());
        Ok(Self { name, task, settings, own_settings, reached, mean_cost, scenes })
    }
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
fn measure_times<T: Tunable>(subjects: &mut [Subject<T>], presets: &mut [Found<T>]) -> Result<(), SubjectError> {
    for (i, subject) in subjects.iter_mut().enumerate() {
        for preset in &mut *presets {
            let (mut found, mut own) = (Vec::new(), Vec::new());
            for round in 0..=TIMED {
                let full = node_ms(&subject.shot(full())?);
                let mut time = |settings: T, ratios: &mut Vec<f64>| {
                    let node = node_ms(&subject.shot(settings.settings())?);
                    if let (Some(node), Some(full), true) = (node, full, round > 0) {
                        ratios.push(node / full);
                    }
                    Ok::<_, SubjectError>(())
                };
                time(preset.settings, &mut found)?;
                preset.own_settings.map(|settings| time(settings, &mut own)).transpose()?;
            }
            if let Some(scene) = preset.scenes.get_mut(i) {
                scene.found.time_over_full = Spread::of(found);
                if let Some(measured) = &mut scene.own {
                    measured.time_over_full = Spread::of(own);
                }
            }
        }
    }
    Ok(())
}

fn summary<T: Tunable>(record: &Record<T>, path: &Path) -> String {
    let Record { technique, width, height, m, adapter, .. } = record;
    let frames = record.evaluated.iter().map(Vec::len).sum::<usize>() * PHASES as usize;
    let mut text = format!("{technique}, {width}×{height}, m = {m}, {adapter}: {frames} frames tried\n");
    for preset in &record.presets {
        let floor = match preset.task.floor {
            Floor::Db(db) => format!("at least {db} dB"),
            Floor::Like(_) => "no worse than the crate's".to_owned(),
        };
        let reached = if preset.reached { "" } else { ": not reached" };
        text += &format!("\n{}, {floor}{reached}", preset.name);
        let head = format!("{:>8}{:>7}{:>7}{:>8}{:>9}{:>7}", "cost", "dB", "edges", "FLIP", "flicker", "time");
        let own = preset.own_settings.is_some();
        let (of_own, own_head) = if own { ("the crate's", head.as_str()) } else { ("", "") };
        for line in [format!("{:>46}   {of_own:>46}", "found"), format!("{head}   {own_head}")] {
            text += &format!("\n{:<26}{}", "", line.trim_end());
        }
        text += "\n";
        for unseen in [false, true] {
            let scenes: Vec<_> = preset.scenes.iter().filter(|s| s.unseen == unseen).collect();
            if unseen && !scenes.is_empty() {
                text += "not seen by the search\n";
            }
            for scene in &scenes {
                let own = scene.own.map_or(String::new(), |own| own.row());
                let row = format!("{:<26}{}   {own}", end_of(&scene.scene, 25), scene.found.row());
                text += &format!("{}\n", row.trim_end());
            }
            if !scenes.is_empty() {
                let mean = |of: &dyn Fn(&OnScene) -> Option<Measured>| {
                    let figures: Option<Vec<_>> = scenes.iter().map(|s| of(s).map(|m| m.figures)).collect();
                    figures.map(|f| Measured { figures: Figures::mean(&f), time_over_full: None }.row())
                };
                let [found, own] = [mean(&|s| Some(s.found)), mean(&|s| s.own)].map(Option::unwrap_or_default);
                text += &format!("{}\n", format!("{:<26}{found}   {own}", "mean").trim_end());
            }
        }
    }
    text += "\ncost: samples over those of Full, or lights and reads of materials; dB, edges, FLIP: against Full; flicker: \
             deviation of that error over a pixel's way; time: of the node over Full's; \
             mean: of dB, up to 80 each; of all else the geometric one\n";
    for preset in &record.presets {
        text += &format!("\n// {}\n{}\n", preset.name, preset.settings.source());
    }
    text + &path.display().to_string()
}

/// The last characters, which tell paths apart.
fn end_of(name: &str, most: usize) -> String {
    name.chars().skip(name.chars().count().saturating_sub(most)).collect()
}

impl Measured {
    fn row(&self) -> String {
        let Figures { cost, psnr_db, edge_psnr_db, flip, flicker, .. } = self.figures;
        let time = self.time_over_full.map_or("-".to_owned(), |t| format!("{:.0}%", t.median * 100.0));
        format!("{:>7.2}%{psnr_db:>7.1}{edge_psnr_db:>7.1}{flip:>8.4}{flicker:>9.5}{time:>7}", cost * 100.0)
    }
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
