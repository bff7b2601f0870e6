//! The renderer's thread: compares what is wanted with what it has, and does the most urgent thing that is missing.

use super::event::Event;
use super::peers::SidePeers;
use super::recipe::{Maker, Recipe};
use super::shared::Shared;
use super::slices::{Slices, Which};
use super::stage::Stage;
use super::wanted::{Source, View, Wanted, same};
use crate::host::{Host, HostError, Options};
use crate::measure::reference;
use crate::scene::open::open;
use std::sync::{Arc, PoisonError};

/// The state of a side.
pub struct Side {
    pub view: Arc<View>,
    pub recipe: Recipe,
    /// The reference, where that is what it shows.
    pub which: Option<Which>,
    pub measured: u32,
    /// Frames until its history has settled.
    pub unsettled: u32,
    /// Whether its frame casts rays and it has not been said yet which sample sends them.
    pub owes_rays: bool,
}

impl Side {
    /// A side of this recipe, of which nothing is measured.
    pub fn new(view: &Arc<View>, recipe: Recipe) -> Self {
        Self { view: view.clone(), recipe, which: None, measured: 0, unsettled: 0, owes_rays: false }
    }
}

/// The renderer's state.
pub struct Renderer {
    shared: Arc<Shared>,
    pub(super) say: Box<dyn Fn(Event)>,
    pub(super) stage: Stage,
    /// The number of the host's scene, and that of the last one that was tried.
    opening: u64,
    tried: u64,
    /// Options that could not be had, so that they are not tried again and again.
    refused: Option<Options>,
    pub(super) sides: [Option<Side>; 2],
    /// The view whose G-buffer is there.
    pub(super) filled: Option<Arc<View>>,
    pub(super) slices: Slices,
    /// Frames of full supersampling that are still to be measured, beyond those of the reference.
    pub(super) fulls: u32,
    pub(super) peers: SidePeers,
    /// The cuts that are known of.
    pub(super) cuts: u64,
    busy: &'static str,
    pub(super) recoveries: u32,
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
            fulls: 0,
            peers: SidePeers::default(),
            cuts: 0,
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

    pub(super) fn busy(&mut self, with: &'static str) {
        if self.busy != with {
            self.busy = with;
            (self.say)(Event::Busy(with));
        }
    }

    /// Does the most urgent thing; whether there was one. An error is a lost device.
    pub(super) fn step(&mut self, wanted: &Wanted) -> Result<bool, String> {
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
        self.cuts = wanted.cuts;
        let base = wanted.sides[0].or(wanted.sides[1]).map(|recipe| recipe.settings).unwrap_or_default();
        let which = Which { view: view.clone(), settings: reference::truth(base), kind: wanted.reference };
        for side in 0..2 {
            let Some(recipe) = wanted.sides[side] else { continue };
            let own = self.sides[side].as_ref().filter(|s| *s.view == *view && s.recipe == recipe);
            if recipe.maker == Maker::Reference {
                if own.is_none_or(|s| s.which.as_ref() != Some(&which))
                    && let Some(made) = self.slices.made(&which)
                {
                    self.show_reference(side, which, recipe, made);
                    return Ok(true);
                }
            } else if own.is_none() {
                self.render(side, view, recipe)?;
                return Ok(true);
            }
        }
        let unsettled = |side: &usize| match &self.sides[*side] {
            Some(own) if wanted.sides[*side].is_some() => own.unsettled,
            _ => 0,
        };
        // Both sides settle alike.
        if let Some(side) = (0..2).max_by_key(unsettled).filter(|side| unsettled(side) > 0) {
            self.busy("settling");
            self.settle(side)?;
            return Ok(true);
        }
        // The sides in turn, so that they are measured alike.
        let measures = |side: &usize| {
            let rendered = wanted.sides[*side].is_some_and(|recipe| recipe.maker != Maker::Reference);
            rendered && self.measured(*side) < wanted.frames
        };
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
        if wanted.sides == [None, None] {
            return Ok(false);
        }
        self.slice(which)
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
        self.peers = SidePeers::default();
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

/// The message of an error; a lost device is an error of the step.
pub fn lost_or(e: HostError) -> Result<String, String> {
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
            cuts: 0,
            sides: [None, None],
            frames: 0,
            reference: Default::default(),
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
