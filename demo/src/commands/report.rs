//! `report`: techniques over their settings, measured against the truth.

use super::args::{Opened, SceneArgs, check_m, frames};
use super::error::{CommandError, wrong};
use super::output::say;
use super::set;
use crate::names::did_you_mean;
use crate::peers::msaa::{self, Refusal, Samples};
use crate::report::folder::Folder;
use crate::report::plan::{PEERS, TECHNIQUES};
use crate::report::session::{Request, Session, stop_on_interrupt};
use crate::report::{run, table};
use crate::scene::{Instance, Scene};
use deferred_aa::{GBufferTier, Settings};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// See `deferred-aa-demo report --help`.
#[derive(Debug, clap::Args)]
pub struct Report {
    #[command(flatten)]
    view: SceneArgs,
    /// Samples along one side of a pixel's window, each 1 to 8, separated by commas. The truth, Single and the peers
    /// are the same for all.
    #[arg(long, short, value_delimiter = ',', default_value = "2,3,4")]
    m: Vec<u32>,
    /// What is measured, separated by commas; everything if not given: full, single, windowed, reconstructed,
    /// selective, multiresolution, surfaces, fxaa, smaa, taa, msaa2x, msaa4x, msaa8x. Cost curves need the first
    /// three, the papers' tables full and selective, or single and multiresolution.
    #[arg(long, value_delimiter = ',')]
    techniques: Vec<String>,
    /// Any field of the settings by its path, for all entries; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// The object that the papers' focused rows are about, by its number or the name of its mesh; may be repeated. One
    /// in the picture's middle if not given.
    #[arg(long, value_name = "OBJECT")]
    focus: Vec<String>,
    /// Fewer settings, frames and points of curves, and a truth of 256 samples a pixel, not 1024.
    #[arg(long)]
    quick: bool,
    /// Measured frames of each entry, interleaved, after one that warms up; 5, or 3 with --quick, if not given.
    #[arg(long, value_parser = frames())]
    frames: Option<u32>,
    /// Takes up what an earlier run of the same report has finished in --out, and measures the rest.
    #[arg(long)]
    resume: bool,
    /// Replaces the finished report of another command in --out.
    #[arg(long)]
    force: bool,
    /// Where truths are kept from one report to the next: $XDG_CACHE_HOME/deferred-aa or ~/.cache/deferred-aa if not
    /// given.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

impl Report {
    pub fn run(self) -> Result<(), CommandError> {
        let ms = self.m.iter().map(|&m| check_m(m)).collect::<Result<Vec<_>, _>>()?;
        let largest = ms.iter().copied().max().unwrap_or(1);
        let (width, height) = self.view.size;
        let mut request = Request {
            command: command(),
            width,
            height,
            ms: unique(ms),
            techniques: techniques(&self.techniques)?,
            stall: self.view.stall,
            quick: self.quick,
            frames: self.frames.unwrap_or(if self.quick { 3 } else { 5 }),
            textures: self.view.textures.tier(),
            rays: self.view.rays.tier(),
            gbuffer: GBufferTier::default(),
            anisotropy: self.view.anisotropy,
            focus: Vec::new(),
            base: set::apply(Settings::default(), &self.settings)?,
            resume: self.resume,
            cache: self.cache,
        };
        let mut plan = run::plan_of(&request);
        if plan.is_empty() {
            let problem = "nothing to measure: at m = 1 there is single alone; name other techniques or a larger m";
            return Err(wrong("--m", problem.to_owned()));
        }
        let Opened { scene, gpu, camera, gbuffer, .. } = self.view.open(largest, None)?;
        request.gbuffer = gbuffer;
        let refusal = |samples| msaa::refusal(samples, &gpu, &scene, &request.base);
        let mut notes = Vec::new();
        for (why, names) in refused(&request.techniques, refusal) {
            request.techniques.retain(|name| !names.contains(name));
            plan = run::plan_of(&request);
            let are = if names.len() == 1 { "is" } else { "are" };
            let names = names.join(", ");
            if plan.is_empty() {
                let problem = format!("nothing to measure without {names}: {why}; name other techniques");
                return Err(wrong("--techniques", problem));
            }
            notes.push(format!("note: {names} {are} left out: {why}"));
        }
        request.focus = focus(&self.focus, &scene)?;
        let folder = Folder::open(
            &self.view.out,
            run::bytes(&request, &plan),
            request.resume,
            &request.subject(&scene),
            self.force,
        )?;
        notes.iter().for_each(|note| eprintln!("{note}"));
        stop_on_interrupt();
        let parts = run::parts(&request, &plan);
        let mut session = Session::new(request, gpu, scene, camera, folder, parts);
        let report = run::run(&mut session)?;
        say(&format!("{}{}", table::table(&report), self.view.out.join("report.html").display()));
        Ok(())
    }
}

fn unique(mut ms: Vec<u32>) -> Vec<u32> {
    ms.sort_unstable();
    ms.dedup();
    ms
}

/// The names, all of them if none is given.
fn techniques(names: &[String]) -> Result<Vec<&'static str>, CommandError> {
    let known: Vec<_> = TECHNIQUES.into_iter().chain(PEERS.map(|(peer, _)| peer.name())).collect();
    if names.is_empty() {
        return Ok(known);
    }
    let find = |name: &String| {
        let found = known.iter().copied().find(|k| k == name);
        let meant = did_you_mean(name, &known);
        found.ok_or_else(|| wrong("--techniques", format!("no technique '{name}':{meant} choose {}", known.join(", "))))
    };
    names.iter().map(find).collect()
}

/// Forward shading that does not stand beside the techniques, by the reason.
fn refused(
    techniques: &[&'static str],
    refusal: impl Fn(Samples) -> Option<Refusal>,
) -> BTreeMap<Refusal, Vec<&'static str>> {
    let mut refused: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for samples in Samples::ALL.into_iter().filter(|samples| techniques.contains(&samples.name())) {
        if let Some(why) = refusal(samples) {
            refused.entry(why).or_default().push(samples.name());
        }
    }
    refused
}

/// The objects of these numbers and names, each once.
fn focus(wanted: &[String], scene: &Scene) -> Result<Vec<u16>, CommandError> {
    let mut objects = BTreeSet::new();
    for name in wanted {
        let is_meant = |i: &&Instance| name.parse() == Ok(i.object) || scene.meshes[i.mesh].name == *name;
        let before = objects.len();
        objects.extend(scene.instances.iter().filter(is_meant).map(|i| i.object));
        if objects.len() == before {
            let names: Vec<_> = scene.instances.iter().map(|i| scene.meshes[i.mesh].name.as_str()).collect();
            let last = scene.instances.iter().map(|i| i.object).max().unwrap_or(0);
            let meant = did_you_mean(name, &names);
            let problem = format!("no object '{name}':{meant} give a number, at most {last}, or the name of a mesh");
            return Err(wrong("--focus", problem));
        }
    }
    Ok(objects.into_iter().collect())
}

/// As typed, or so that a shell takes it for the same.
fn command() -> String {
    let quoted = |a: String| {
        let plain = |c: char| c.is_alphanumeric() || "-_=./,:+%@".contains(c);
        if !a.is_empty() && a.chars().all(plain) { a } else { format!("'{}'", a.replace('\'', "'\\''")) }
    };
    let arguments = std::env::args_os().skip(1).map(|a| quoted(a.to_string_lossy().into_owned()));
    std::iter::once("deferred-aa-demo".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}
