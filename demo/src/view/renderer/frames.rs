//! The frames of the renderer's thread: those of the sides, and those of the reference.

use super::event::{Event, Rendered, casts};
use super::recipe::Recipe;
use super::slices::{Made, Slice, Which};
use super::thread::{Renderer, Side, lost_or};
use super::wanted::View;
use crate::host::{HostError, Shot};
use crate::measure::stats::Stats;
use crate::peers::AnyPeer;
use crate::peers::taa::STILL_FRAMES;
use deferred_aa::{DebugView, PlanWord, Settings, Technique};
use std::sync::Arc;

/// Frames of full supersampling that are measured.
const FULLS: u32 = 3;

impl Renderer {
    /// A frame of a side, and the peer's pass on it. With its G-buffer, or on the one that is there.
    fn shoot(
        &mut self,
        side: usize,
        view: &View,
        recipe: Recipe,
        with_gbuffer: bool,
    ) -> Result<Option<Shot>, HostError> {
        let Some(host) = &mut self.stage.host else { return Ok(None) };
        let (camera, settings) = (&view.camera, recipe.recorded());
        if recipe.has_history() {
            self.filled = None;
            return self.peers.frame_in_history(host, side, camera, recipe, self.cuts).map(Some);
        }
        let forward = match recipe.peer() {
            Some(AnyPeer::Msaa(samples)) => Some(self.peers.forward(host, samples, camera, &recipe)?),
            _ => None,
        };
        let mut shot = if with_gbuffer { host.frame(camera, settings)? } else { host.shade_again(camera, settings)? };
        if let Some(pass) = forward {
            // The node's frame gives the statistics alone.
            shot.statistics.passes = vec![pass];
            shot.gbuffer_ms = Some(0.0);
        }
        if let Some(AnyPeer::Image(peer)) = recipe.peer() {
            shot.statistics.passes.push(self.peers.finish(host, peer)?);
        }
        Ok(Some(shot))
    }

    pub(super) fn render(&mut self, side: usize, view: Arc<View>, recipe: Recipe) -> Result<(), String> {
        let settings = recipe.recorded();
        let ready = self.stage.host.as_ref().is_some_and(|host| host.is_ready(settings));
        self.busy(if ready { "rendering" } else { "compiling" });
        let fresh = self.filled.as_ref().is_none_or(|filled| *filled != view);
        if !recipe.has_history() {
            self.peers.end_history(side);
        }
        let shot = self.shoot(side, &view, recipe, fresh);
        self.sides[side] = Some(Side::new(&view, recipe));
        let shot = match shot.map_err(lost_or) {
            Ok(Some(shot)) => shot,
            Ok(None) => return Ok(()),
            Err(e) => {
                (self.say)(Event::Refused(side, recipe, e?));
                return Ok(());
            }
        };
        self.recoveries = 0;
        let has_history = recipe.has_history();
        if !has_history {
            self.filled = Some(view.clone());
        }
        let unsettled = if has_history { STILL_FRAMES - 1 } else { 0 };
        if let Some(own) = &mut self.sides[side] {
            own.unsettled = unsettled;
            own.owes_rays = settings.goal.is_none() && !has_history && casts(&shot) != [false; 2];
        }
        self.show(side, view, recipe, shot, unsettled);
        Ok(())
    }

    /// Renders one more frame of a history whose camera stands still, and shows it.
    pub(super) fn settle(&mut self, side: usize) -> Result<(), String> {
        let Some(own) = &mut self.sides[side] else { return Ok(()) };
        own.unsettled -= 1;
        let (view, recipe, unsettled) = (own.view.clone(), own.recipe, own.unsettled);
        match self.shoot(side, &view, recipe, true) {
            Ok(Some(shot)) => self.show(side, view, recipe, shot, unsettled),
            Ok(None) => {}
            Err(e) => drop(lost_or(e)?),
        }
        Ok(())
    }

    /// Sends the picture of the last frame, which was of this side.
    fn show(&self, side: usize, view: Arc<View>, recipe: Recipe, shot: Shot, unsettled: u32) {
        let Some(host) = &self.stage.host else { return };
        let settings = recipe.recorded();
        let stats = Stats::new(host, settings, std::slice::from_ref(&shot), None);
        let rendered = Rendered {
            picture: Arc::new(self.peers.picture(host, side, &recipe)),
            unsettled,
            plan: Arc::new(match settings.technique {
                Technique::Full | Technique::Single => Vec::new(),
                // Its plan is of rays alone.
                Technique::Surfaces => host.counts(settings.technique).into_iter().map(PlanWord).collect(),
                _ => host.plan(),
            }),
            stats: stats.map(|stats| Arc::new(self.peers.complete(&recipe, stats))),
            passes: if recipe.is_forward() {
                [Vec::new(), Vec::new()]
            } else {
                [host.passes(&settings), host.passes(&every_effect(settings))]
            },
            view,
            recipe,
            shot,
        };
        (self.say)(Event::Picture(side, Box::new(rendered)));
    }

    /// Sends the reference as the picture of a side.
    pub(super) fn show_reference(&mut self, side: usize, which: Which, recipe: Recipe, made: Made) {
        let view = which.view.clone();
        self.sides[side] = Some(Side { which: Some(which), ..Side::new(&view, recipe) });
        self.peers.end_history(side);
        let Made { picture, shot } = made;
        let rendered = Rendered {
            view,
            recipe,
            picture,
            unsettled: 0,
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
        match self.shoot(side, &view, recipe, true) {
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
