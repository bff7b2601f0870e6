//! One side of the divider: its settings, what it shows, what it cost.

use super::tone::Tone;
use crate::host::{Sent, Shot};
use crate::measure::quality::Quality;
use crate::measure::stats::{Spread, times};
use crate::view::judge::Verdict;
use crate::view::renderer::{Recipe, Rendered, View};
use deferred_aa::{Preset, Settings};
use egui::{ColorImage, Context, TextureFilter, TextureHandle, TextureOptions};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Changes of one setting within this time are one step of undo.
const ONE_STEP: Duration = Duration::from_millis(700);

/// The most frames whose times are kept.
const MOST_SHOTS: usize = 64;

/// One side of the divider.
#[derive(Default)]
pub struct Side {
    /// Who makes the picture, and the settings on the controls.
    pub recipe: Recipe,
    past: Vec<Recipe>,
    future: Vec<Recipe>,
    last_change: Option<(String, Instant)>,
    /// The last picture.
    pub rendered: Option<Box<Rendered>>,
    /// The rays that each of its samples sent, once they are counted.
    pub sent: Option<Arc<Vec<Sent>>>,
    /// The frames of this picture that were measured.
    pub shots: Vec<Shot>,
    /// The quality against the present reference.
    pub quality: Option<Quality>,
    /// Why the settings on the controls are not those of the picture.
    pub refused: Option<String>,
    /// The picture as a texture.
    pub texture: Option<TextureHandle>,
    /// The tone of that texture.
    pub painted: Tone,
    /// Where the picture is wrong, as a texture.
    pub error: Option<TextureHandle>,
}

impl Side {
    /// A side of this recipe.
    pub fn new(recipe: Recipe) -> Self {
        Self { recipe, ..Self::default() }
    }

    /// Changes the settings. `path` names the control, so that one drag of a slider is one step of undo.
    pub fn set(&mut self, settings: Settings, path: &str) {
        self.take(Recipe { settings, ..self.recipe }, path);
    }

    /// Changes the settings and who makes the picture.
    pub fn take(&mut self, recipe: Recipe, path: &str) {
        if recipe == self.recipe {
            return;
        }
        let now = Instant::now();
        let goes_on = self.last_change.as_ref().is_some_and(|(last, at)| last == path && now - *at < ONE_STEP);
        if !goes_on {
            self.past.push(self.recipe);
        }
        self.future.clear();
        self.last_change = Some((path.to_owned(), now));
        self.recipe = recipe;
        self.refused = None;
    }

    /// Takes back one step; whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.recipe, before));
        (self.last_change, self.refused) = (None, None);
        true
    }

    /// Does again one step that was taken back; whether there was one.
    pub fn redo(&mut self) -> bool {
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.recipe, after));
        (self.last_change, self.refused) = (None, None);
        true
    }

    /// How many steps can be taken back, and done again.
    pub fn steps(&self) -> (usize, usize) {
        (self.past.len(), self.future.len())
    }

    /// The settings that a control is reset to.
    pub fn defaults() -> Settings {
        Preset::default().settings()
    }

    /// Shows a new picture.
    pub fn show(&mut self, ctx: &Context, name: &str, tone: Tone, rendered: Box<Rendered>) {
        self.shots = vec![rendered.shot.clone()];
        (self.quality, self.error, self.refused, self.sent) = (None, None, None, None);
        self.rendered = Some(rendered);
        self.paint(ctx, name, tone);
    }

    /// Makes the texture of the picture, by this tone.
    pub fn paint(&mut self, ctx: &Context, name: &str, tone: Tone) {
        let Some(rendered) = &self.rendered else { return };
        let picture = &rendered.picture;
        let rgb: Vec<u8> = if rendered.recipe.is_image() {
            picture.rgba.iter().flat_map(|&c| tone.shown(c)).collect()
        } else {
            // A debug view is made of displayable values.
            let shown = |c: &[f32; 4]| [c[0], c[1], c[2]].map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
            picture.rgba.iter().flat_map(shown).collect()
        };
        let size = [picture.width as usize, picture.height as usize];
        set_texture(&mut self.texture, ctx, name, ColorImage::from_rgb(size, &rgb));
        self.painted = tone;
    }

    /// Adds one more frame of the picture that is shown.
    pub fn measured(&mut self, view: &Arc<View>, recipe: &Recipe, shot: Shot) {
        if self.is_of(view, recipe) && self.shots.len() < MOST_SHOTS {
            self.shots.push(shot);
        }
    }

    /// Adds the rays of its samples.
    pub fn counted(&mut self, view: &Arc<View>, recipe: &Recipe, sent: Arc<Vec<Sent>>) {
        if self.is_of(view, recipe) {
            self.sent = Some(sent);
        }
    }

    fn is_of(&self, view: &Arc<View>, recipe: &Recipe) -> bool {
        self.rendered.as_deref().is_some_and(|r| Arc::ptr_eq(&r.view, view) && r.recipe == *recipe)
    }

    /// Takes a verdict, if it is of the present picture; whether it is.
    pub fn judged(&mut self, ctx: &Context, name: &str, verdict: &Verdict) -> bool {
        let own = self.rendered.as_deref().is_some_and(|r| Arc::ptr_eq(&r.picture, &verdict.case.picture));
        if !own {
            return false;
        }
        self.quality = verdict.quality.as_ref().ok().copied();
        let size = [verdict.case.picture.width as usize, verdict.case.picture.height as usize];
        let rgb: Vec<u8> = verdict.error.iter().flatten().copied().collect();
        set_texture(&mut self.error, ctx, name, ColorImage::from_rgb(size, &rgb));
        true
    }

    /// Milliseconds by pass, over the measured frames. The first one may have been compiled for, and is left out of
    /// several.
    pub fn times(&self) -> BTreeMap<String, Spread> {
        times(&self.shots[usize::from(self.shots.len() > 2)..])
    }

    /// Median milliseconds of the node's passes together.
    pub fn node_ms(&self) -> Option<f64> {
        self.times().get("node").map(|spread| spread.median)
    }
}

fn set_texture(texture: &mut Option<TextureHandle>, ctx: &Context, name: &str, image: ColorImage) {
    // Pixels are to be seen as they are, and where several share one of the screen, so is their mean.
    let options = TextureOptions { minification: TextureFilter::Linear, ..TextureOptions::NEAREST };
    match texture {
        Some(texture) => texture.set(image, options),
        None => *texture = Some(ctx.load_texture(name, image, options)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::Technique;

    #[test]
    fn changes_can_be_taken_back() {
        let with = |scale: f32| {
            let mut settings = Settings::default();
            settings.windowed.luminance_scale = scale;
            settings
        };
        let mut side = Side::new(Recipe::node(with(1.0)));
        // A slider on its way, then another control.
        side.set(with(2.0), "windowed.luminance_scale");
        side.set(with(3.0), "windowed.luminance_scale");
        let other = Settings { technique: Technique::Full, ..with(3.0) };
        side.set(other, "technique");
        assert_eq!(side.steps(), (2, 0));
        assert!(side.undo());
        assert_eq!(side.recipe.settings, with(3.0));
        assert!(side.undo());
        assert_eq!(side.recipe.settings, with(1.0));
        assert!(!side.undo() && side.redo() && side.redo() && !side.redo());
        assert_eq!(side.recipe.settings, other);
        side.undo();
        side.set(with(5.0), "windowed.luminance_scale");
        assert_eq!(side.steps().1, 0);
    }
}
