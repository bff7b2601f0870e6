//! The lights of the scene.

use super::super::app::App;
use super::super::renderer::to_sun;
use super::row::{labelled, slider};
use crate::scene::Sun;
use egui::{Slider, Ui};
use std::f32::consts::PI;

impl App {
    pub(super) fn lamps(&mut self, ui: &mut Ui) {
        let most = self.opened.as_ref().map_or(0, |o| o.lights);
        let mut count = self.lights.count.min(most);
        ui.add_enabled_ui(most > 0, |ui| {
            labelled(ui, "lamps", |ui| {
                let slider = slider(ui, Slider::new(&mut count, 0..=most), 0.0);
                if slider
                    .on_hover_text("How many of the scene's lamps shine, the first ones")
                    .on_disabled_hover_text("The scene has no lamps")
                    .changed()
                {
                    self.lights.count = count;
                }
            });
        });
        labelled(ui, "cost of light", |ui| {
            slider(ui, Slider::new(&mut self.lights.stall, 1..=64).logarithmic(true), 0.0)
                .on_hover_text("How often the light loop runs, 1 to 64, to stand for costly shading");
        });
        let sun = self.sun();
        let mut shines = sun.is_some_and(|s| s.irradiance.max_element() > 0.0);
        if ui.checkbox(&mut shines, "sun").changed() {
            let own = self.opened.as_ref().and_then(|o| o.sun).unwrap_or_default();
            let irradiance = if shines { own.irradiance.max(glam::Vec3::splat(1e-3)) } else { glam::Vec3::ZERO };
            self.lights.sun = Some(Sun { irradiance, ..sun.unwrap_or(own) });
        }
        let Some(sun) = sun.filter(|_| shines) else { return };
        let mut azimuth = sun.to_sun.z.atan2(sun.to_sun.x).to_degrees();
        let mut elevation = sun.to_sun.y.clamp(-1.0, 1.0).asin().to_degrees();
        let mut strength = sun.irradiance.max_element() / PI;
        let mut casts = sun.casts;
        let mut row = |name, widget: Slider<'_>, hint| {
            labelled(ui, name, |ui| slider(ui, widget, 0.0).on_hover_text(hint).changed())
        };
        let mut changed = row(
            "azimuth",
            Slider::new(&mut azimuth, -180.0..=180.0).custom_formatter(degrees),
            "Direction towards the sun, -180 to 180 degrees",
        );
        changed |= row(
            "elevation",
            Slider::new(&mut elevation, -90.0..=90.0).custom_formatter(degrees),
            "Height of the sun above the horizon, -90 to 90 degrees",
        );
        changed |= row(
            "strength",
            Slider::new(&mut strength, 0.01..=100.0).logarithmic(true),
            "Radiance of white paper that faces the sun, 0.01 to 100",
        );
        changed |= ui.checkbox(&mut casts, "casts shadows").changed();
        if changed {
            let irradiance = sun.irradiance / sun.irradiance.max_element() * (strength * PI);
            self.lights.sun = Some(Sun { to_sun: to_sun(azimuth, elevation), irradiance, casts });
        }
        if ui.button("The scene's own sun").clicked() {
            self.lights.sun = None;
        }
    }
}

/// Written short, but not rounded: that would move the sun.
fn degrees(value: f64, _: std::ops::RangeInclusive<usize>) -> String {
    format!("{value:.1}°")
}
