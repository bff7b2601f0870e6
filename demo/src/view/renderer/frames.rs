//! The frames of the renderer's thread: those of the sides, and those of the reference.

use super::event::{Event, Rendered, casts};
use super::recipe::Recipe;
use super::slices::{Made, Slice, Which};
use super::thread::{Renderer, Side, lost_or};
use super::wanted::View;
use crate::host::{HostError, Shot};
use crate::measure::stats::Stats;
use crate::peers::Peers;
use deferred_aa::{DebugView, PlanWord, Settings, Technique};
use std::sync::Arc;

/// Frames of full supersampling that are measured.
const FULLS: u32 = 3;

impl Renderer {
    /// A frame, and the peer's pass on it. With its G-buffer, or on the one that is there.
    fn shoot(&mut self, view: &View, recipe: Recipe, with_gbuffer: bool) -> Result<Option<Shot>, HostError> {
        let Some(host) = &mut self.stage.host else { return Ok(None) };
        let (camera, settings) = (&view.camera, recipe.recorded());
        let mut shot = if with_gbuffer { host.frame(camera, settings)? } else { host.shade_again(camera, settings)? };
        if let Some(peer) = recipe.peer() {
            let peers = match &mut self.peers {
                Some(peers) => peers,
                none => none.insert(Peers::new(&host.gpu, host.options.width, host.options.height)?),
            };
            shot.statistics.passes.push(peers.run(peer, host.target())?.pass(peer.name()));
        }
        Ok(Some(shot))
    }

    pub(super) fn render(&mut self, side: usize, view: Arc<View>, recipe: Recipe) -> Result<(), String> {
        let settings = recipe.recorded();
        let ready = self.stage.host.as_ref().is_some_and(|host| host.is_ready(settings));
        self.busy(if ready { "rendering" } else { "compiling" });
        let fresh = self.filled.as_ref().is_none_or(|filled| *filled != view);
        let shot = self.shoot(&view, recipe, fresh);
        self.sides[side] = Some(Side { view: view.clone(), recipe, which: None, measured: 0, owes_rays: false });
        let shot = match shot.map_err(lost_or) {
            Ok(Some(shot)) => shot,
            Ok(None) => return Ok(()),
            Err(e) => {
                (self.say)(Event::Refused(side, recipe, e?));
                return Ok(());
            }
        };
        self.filled = Some(view.clone());
        self.recoveries = 0;
        if let Some(own) = &mut self.sides[side] {
            own.owes_rays = settings.goal.is_none() && casts(&shot) != [false; 2];
        }
        let Some(host) = &self.stage.host else { return Ok(()) };
        let stats = Stats::new(host, settings, std::slice::from_ref(&shot), None);
        let rendered = Rendered {
            picture: Arc::new(match &self.peers {
                Some(peers) if recipe.peer().is_some() => peers.picture(),
                _ => host.picture(),
            }),
            plan: Arc::new(match settings.technique {
                Technique::Full | Technique::Single => Vec::new(),
                // Its plan is of rays alone.
                Technique::Surfaces => host.counts(settings.technique).into_iter().map(PlanWord).collect(),
                _ => host.plan(),
            }),
            stats: stats.map(Arc::new),
            passes: [host.passes(&settings), host.passes(&every_effect(settings))],
            view,
            recipe,
            shot,
        };
        (self.say)(Event::Picture(side, Box::new(rendered)));
        Ok(())
    }

    /// Sends the reference as the picture of a side.
    pub(super) fn show_reference(&mut self, side: usize, which: Which, recipe: Recipe, made: Made) {
        let view = which.view.clone();
        self.sides[side] = Some(Side { view: view.clone(), recipe, which: Some(which), measured: 0, owes_rays: false });
        let Made { picture, shot } = made;
        let rendered = Rendered {
            view,
            recipe,
            picture,
            shot,
            plan: Arc::default(),
            stats: None,
            passes: [Vec::new(), Vec::new()],
        };
        (self.say)(Event::Picture(side, Box::new(rendered)));
    }

    pub(super) fn measure(&mut self, side: usize) -> Result<(), String> {
        let Some(own) = &mut self.sides[side] else { return Ok(()) };
        own.measured += 1;
        let (view, recipe) = (own.view.clone(), own.recipe);
        // With its G-buffer, whose time counts too.
        match self.shoot(&view, recipe, true) {
            Ok(Some(shot)) => (self.say)(Event::Measured(side, view, recipe, shot)),
            Ok(None) => {}
            // What was refused has been said with the picture.
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// Renders the same frame once more with its rays shown, and so written down.
    pub(super) fn count_rays(&mut self, side: usize) -> Result<(), String> {
        let (Some(host), Some(own)) = (&mut self.stage.host, &mut self.sides[side]) else { return Ok(()) };
        own.owes_rays = false;
        let settings = Settings { view: DebugView::Rays, ..own.recipe.recorded() };
        let fresh = self.filled.as_ref() != Some(&own.view);
        let camera = &own.view.camera;
        let shot = if fresh { host.frame(camera, settings) } else { host.shade_again(camera, settings) };
        match shot {
            Ok(shot) => {
                self.filled = Some(own.view.clone());
                let sent = Arc::new(host.sent(casts(&shot)));
                (self.say)(Event::Sent(side, own.view.clone(), own.recipe, sent));
            }
            // Twice the memory may be too much; the picture is there.
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// Renders one more frame of the reference; whether there was one to render.
    pub(super) fn slice(&mut self, which: Which) -> Result<bool, String> {
        if !self.slices.owe(&which) {
            return self.full(which);
        }
        self.busy("computing the reference");
        let Some(host) = &mut self.stage.host else { return Ok(false) };
        self.filled = None;
        let (view, settings) = (which.view.clone(), which.settings);
        match self.slices.render(host, &which).map_err(lost_or) {
            Ok(Slice::Part(done, all, shot)) => {
                (self.say)(Event::Full(view, shot));
                (self.say)(Event::Progress(done, all));
            }
            Ok(Slice::Last(all, made)) => {
                (self.say)(Event::Full(view.clone(), made.shot));
                (self.say)(Event::Progress(all, all));
                (self.say)(Event::Reference(view, settings, made.picture));
                self.fulls = FULLS.saturating_sub(all);
            }
            Err(e) => {
                let e = e?;
                self.slices.finish(which, None);
                (self.say)(Event::Refused(0, Recipe::node(settings), format!("the reference: {e}")));
            }
        }
        Ok(true)
    }

    /// Measures one more frame of full supersampling, where the reference had too few; whether there was one to
    /// measure.
    fn full(&mut self, which: Which) -> Result<bool, String> {
        if self.fulls == 0 || self.slices.made(&which).is_none() {
            return Ok(false);
        }
        self.fulls -= 1;
        self.busy("measuring Full");
        let Some(host) = &mut self.stage.host else { return Ok(false) };
        match host.frame(&which.view.camera, which.settings) {
            Ok(shot) => (self.say)(Event::Full(which.view, shot)),
            Err(e) => drop(lost_or(e)?),
        }
        Ok(true)
    }
}

/// The settings that would be recorded if the scene called for every effect.
fn every_effect(settings: Settings) -> Settings {
    use deferred_aa::Effect::On;
    Settings { shadows: On, reflections: On, refraction: On, ..settings }
}
