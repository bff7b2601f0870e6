//! The renderer's thread: compares what is wanted with what it has, and does the most urgent thing that is missing.

use super::event::{Event, Rendered, casts};
use super::shared::Shared;
use super::slices::{Slice, Slices, Which};
use super::stage::Stage;
use super::wanted::{Reference, Source, View, Wanted, same};
use crate::host::{Host, HostError, Options};
use crate::measure::reference;
use crate::measure::stats::Stats;
use crate::scene::open::open;
use deferred_aa::{DebugView, PlanWord, Settings, Technique};
use std::sync::{Arc, PoisonError};

/// The state of a side.
struct Side {
    view: Arc<View>,
    settings: Settings,
    measured: u32,
    /// Whether its frame casts rays and it has not been said yet which sample sends them.
    owes_rays: bool,
}

/// The renderer's state.
pub struct Renderer {
    shared: Arc<Shared>,
    say: Box<dyn Fn(Event)>,
    stage: Stage,
    /// The number of the host's scene, and that of the last one that was tried.
    opening: u64,
    tried: u64,
    /// Options that could not be had, so that they are not tried again and again.
    refused: Option<Options>,
    sides: [Option<Side>; 2],
    /// The view whose G-buffer is there.
    filled: Option<Arc<View>>,
    slices: Slices,
    busy: &'static str,
    recoveries: u32,
}

/// How often a device may be lost once more without a frame between.
const MOST_RECOVERIES: u32 = 3;

impl Renderer {
    /// The renderer before anything is opened.
    pub fn new(shared: Arc<Shared>, options: Options, adapter: Option<String>, say: Box<dyn Fn(Event)>) -> Self {
        Self {
            shared,
            say,
            stage: Stage::new(adapter, options),
            opening: 0,
            tried: 0,
            refused: None,
            sides: [None, None],
            filled: None,
            slices: Slices::default(),
            busy: "",
            recoveries: 0,
        }
    }

    /// Works until the window wants the thread to end, or nothing can be rendered any more.
    pub fn run(&mut self) {
        loop {
            let wanted = self.shared.lock().clone();
            if wanted.quit {
                return;
            }
            match self.step(&wanted) {
                Ok(true) => {}
                Ok(false) => {
                    self.busy("");
                    let mut guard = self.shared.lock();
                    while same(&guard, &wanted) && !guard.quit {
                        guard = self.shared.changed.wait(guard).unwrap_or_else(PoisonError::into_inner);
                    }
                }
                Err(lost) => match self.recover(&lost) {
                    Ok(()) => (self.say)(Event::Recovered(lost)),
                    Err(e) => {
                        (self.say)(Event::Failed(format!("{lost}; and it could not be had again: {e}")));
                        return;
                    }
                },
            }
        }
    }

    fn busy(&mut self, with: &'static str) {
        if self.busy != with {
            self.busy = with;
            (self.say)(Event::Busy(with));
        }
    }

    /// Does the most urgent thing; whether there was one. An error is a lost device.
    fn step(&mut self, wanted: &Wanted) -> Result<bool, String> {
        if wanted.scene.1 != self.tried {
            self.tried = wanted.scene.1;
            self.busy("opening");
            self.open(&wanted.scene.0, wanted.scene.1)?;
            return Ok(true);
        }
        let Some(view) = wanted.view.as_ref().filter(|view| view.opening == self.opening && !wanted.paused) else {
            return Ok(false);
        };
        if self.stage.host.is_none() {
            return Ok(false);
        }
        if view.options != self.stage.options && self.refused != Some(view.options) {
            self.busy("building");
            self.rebuild(view.options)?;
            return Ok(true);
        }
        let view = View { options: self.stage.options, ..view.clone() };
        if self.stage.lights != Some(view.lights) {
            self.stage.light(view.lights);
        }
        let view = match &self.filled {
            Some(filled) if **filled == view => filled.clone(),
            _ => Arc::new(view),
        };
        for side in 0..2 {
            let Some(settings) = wanted.sides[side] else { continue };
            let has = self.sides[side].as_ref().is_some_and(|s| *s.view == *view && s.settings == settings);
            if !has {
                self.render(side, view, settings)?;
                return Ok(true);
            }
        }
        // The sides in turn, so that they are measured alike.
        let measures = |side: &usize| wanted.sides[*side].is_some() && self.measured(*side) < wanted.frames;
        if let Some(side) = (0..2).filter(measures).min_by_key(|&side| self.measured(side)) {
            self.busy("measuring");
            self.measure(side)?;
            return Ok(true);
        }
        let owes =
            |side: &usize| wanted.sides[*side].is_some() && self.sides[*side].as_ref().is_some_and(|s| s.owes_rays);
        if let Some(side) = (0..2).find(owes) {
            self.busy("counting rays");
            self.count_rays(side)?;
            return Ok(true);
        }
        let Some(base) = wanted.sides[0].or(wanted.sides[1]) else { return Ok(false) };
        self.slice(view, reference::truth(base), wanted.reference)
    }

    fn measured(&self, side: usize) -> u32 {
        self.sides[side].as_ref().map_or(0, |s| s.measured)
    }

    fn open(&mut self, source: &Source, opening: u64) -> Result<(), String> {
        let no = |renderer: &Self, e: String| {
            (renderer.say)(Event::NotOpened(opening, e));
            Ok(())
        };
        let scene = match open(&source.name, source.index) {
            Ok(scene) => scene,
            Err(e) => return no(self, e.to_string()),
        };
        let own_sun = scene.sun;
        let host = match self.stage.build(scene, self.stage.options) {
            Ok(host) => host,
            Err(e) => return no(self, e),
        };
        let opened = self.stage.open(host, own_sun, source, opening);
        self.opening = opening;
        self.refused = None;
        self.forget();
        (self.say)(Event::Opened(Box::new(opened)));
        Ok(())
    }

    /// Takes a host of the same scene, built for these options.
    fn take(&mut self, host: Host, options: Options) {
        self.stage.take(host, options);
        self.refused = None;
        self.forget();
    }

    /// Forgets what was rendered before.
    fn forget(&mut self) {
        self.sides = [None, None];
        self.filled = None;
        self.slices = Slices::default();
    }

    fn rebuild(&mut self, options: Options) -> Result<(), String> {
        let Some(host) = &mut self.stage.host else { return Ok(()) };
        let built = if (Options { width: options.width, height: options.height, ..self.stage.options }) == options {
            // The node stays.
            let resized = host.resize(options.width, options.height).map_err(lost_or);
            match resized {
                Ok(()) => {
                    self.stage.options = options;
                    self.forget();
                    return Ok(());
                }
                Err(e) => Err(e?),
            }
        } else {
            let scene = host.scene.clone();
            self.stage.build(scene, options)
        };
        match built {
            Ok(host) => self.take(host, options),
            Err(e) => {
                self.refused = Some(options);
                (self.say)(Event::NotBuilt(options, e));
            }
        }
        Ok(())
    }

    fn render(&mut self, side: usize, view: Arc<View>, settings: Settings) -> Result<(), String> {
        let ready = self.stage.host.as_ref().is_some_and(|host| host.is_ready(settings));
        self.busy(if ready { "rendering" } else { "compiling" });
        let fresh = self.filled.as_ref().is_none_or(|filled| *filled != view);
        let Some(host) = &mut self.stage.host else { return Ok(()) };
        let shot = if fresh { host.frame(&view.camera, settings) } else { host.shade_again(&view.camera, settings) };
        self.sides[side] = Some(Side { view: view.clone(), settings, measured: 0, owes_rays: false });
        let shot = match shot.map_err(lost_or) {
            Ok(shot) => shot,
            Err(e) => {
                (self.say)(Event::Refused(side, settings, e?));
                return Ok(());
            }
        };
        self.filled = Some(view.clone());
        self.recoveries = 0;
        if let Some(own) = &mut self.sides[side] {
            own.owes_rays = settings.goal.is_none() && casts(&shot) != [false; 2];
        }
        let rendered = Rendered {
            picture: Arc::new(host.picture()),
            plan: Arc::new(match settings.technique {
                Technique::Full | Technique::Single => Vec::new(),
                // Its plan is of rays alone.
                Technique::Surfaces => host.counts(settings.technique).into_iter().map(PlanWord).collect(),
                _ => host.plan(),
            }),
            stats: Stats::new(host, settings, std::slice::from_ref(&shot), None).map(Arc::new),
            passes: [host.passes(&settings), host.passes(&every_effect(settings))],
            view,
            settings,
            shot,
        };
        (self.say)(Event::Picture(side, Box::new(rendered)));
        Ok(())
    }

    fn measure(&mut self, side: usize) -> Result<(), String> {
        let (Some(host), Some(own)) = (&mut self.stage.host, &mut self.sides[side]) else { return Ok(()) };
        own.measured += 1;
        // With its G-buffer, whose time counts too.
        match host.frame(&own.view.camera, own.settings) {
            Ok(shot) => (self.say)(Event::Measured(side, own.view.clone(), own.settings, shot)),
            // What was refused has been said with the picture.
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// Renders the same frame once more with its rays shown, and so written down.
    fn count_rays(&mut self, side: usize) -> Result<(), String> {
        let (Some(host), Some(own)) = (&mut self.stage.host, &mut self.sides[side]) else { return Ok(()) };
        own.owes_rays = false;
        let settings = Settings { view: DebugView::Rays, ..own.settings };
        let fresh = self.filled.as_ref() != Some(&own.view);
        let camera = &own.view.camera;
        let shot = if fresh { host.frame(camera, settings) } else { host.shade_again(camera, settings) };
        match shot {
            Ok(shot) => {
                self.filled = Some(own.view.clone());
                let sent = Arc::new(host.sent(casts(&shot)));
                (self.say)(Event::Sent(side, own.view.clone(), own.settings, sent));
            }
            // Twice the memory may be too much; the picture is there.
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// Renders one more frame of the reference; whether there was one to render.
    fn slice(&mut self, view: Arc<View>, settings: Settings, kind: Reference) -> Result<bool, String> {
        let which = Which { view, settings, kind };
        if !self.slices.owe(&which) {
            return Ok(false);
        }
        self.busy("computing the reference");
        let Some(host) = &mut self.stage.host else { return Ok(false) };
        self.filled = None;
        match self.slices.render(host, &which).map_err(lost_or) {
            Ok(Slice::Part(done, all)) => (self.say)(Event::Progress(done, all)),
            Ok(Slice::Last(all, picture)) => {
                (self.say)(Event::Progress(all, all));
                (self.say)(Event::Reference(which.view, settings, Arc::new(picture)));
            }
            Err(e) => {
                let e = e?;
                self.slices.finish(which);
                (self.say)(Event::Refused(0, settings, format!("the reference: {e}")));
            }
        }
        Ok(true)
    }

    /// Builds a device in place of one that is lost.
    fn recover(&mut self, lost: &str) -> Result<(), String> {
        self.recoveries += 1;
        if self.recoveries > MOST_RECOVERIES {
            return Err(format!("{lost}, {MOST_RECOVERIES} times in a row"));
        }
        let Some(host) = self.stage.host.take() else { return Err("there is no scene".to_owned()) };
        let scene = host.scene.clone();
        drop(host);
        let host = self.stage.build(scene, self.stage.options)?;
        self.take(host, self.stage.options);
        Ok(())
    }
}

/// The settings that would be recorded if the scene called for every effect.
fn every_effect(settings: Settings) -> Settings {
    use deferred_aa::Effect::On;
    Settings { shadows: On, reflections: On, refraction: On, ..settings }
}

/// The message of an error; a lost device is an error of the step.
fn lost_or(e: HostError) -> Result<String, String> {
    if e.is_loss() { Err(e.to_string()) } else { Ok(e.to_string()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::sync::{Condvar, Mutex};

    /// A device that is lost as soon as it is there is not asked for for ever.
    #[test]
    fn recoveries_end() {
        let wanted = Wanted {
            scene: (Source::default(), 0),
            view: None,
            sides: [None, None],
            frames: 0,
            reference: Reference::Off,
            paused: false,
            quit: false,
        };
        let shared = Arc::new(Shared { wanted: Mutex::new(wanted), changed: Condvar::new() });
        let (say, _events) = channel();
        let options = Options { anisotropy: 1, ..Options::new(8, 8, 1) };
        let mut renderer = Renderer::new(shared, options, None, Box::new(move |event| drop(say.send(event))));
        renderer.open(&Source { name: "empty".to_owned(), index: None }, 1).unwrap();
        for _ in 0..MOST_RECOVERIES {
            assert_eq!(renderer.recover("gone"), Ok(()));
        }
        assert!(renderer.recover("gone").unwrap_err().contains("3 times in a row"));
    }
}
