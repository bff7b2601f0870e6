//! What is fixed for the node: the picture's size, textures, rays and the G-buffer.

use super::super::app::App;
use super::row;
use crate::host::Options;
use deferred_aa::rays::RayTier;
use deferred_aa::{GBufferTier, Ids, TextureTier};
use egui::{DragValue, Slider, Ui};

/// The most screen pixels along a side of a picture's pixel, where the picture matches the window.
pub const COARSEST: u32 = 8;

impl App {
    pub(super) fn node(&mut self, ui: &mut Ui) {
        self.size_rows(ui);
        let adapter = self.opened.as_ref().map(|o| o.adapter.clone()).unwrap_or_default();
        let Options { mut anisotropy, mut textures, mut rays, mut gbuffer, .. } = self.options;
        row::labelled(ui, "anisotropy", |ui| {
            row::slider(ui, Slider::new(&mut anisotropy, 1..=16), 0.0).on_hover_text(
                "Of texture reads, 1 to 16. Higher: sharper at grazing angles, slower. The scene is uploaded anew.",
            );
        });
        for (label, missing, is, set) in [
            ("textures in arrays", &None, textures == TextureTier::Arrays, TextureTier::Arrays),
            ("textures in bindings", &adapter.no_bindings, textures == TextureTier::Bindings, TextureTier::Bindings),
        ] {
            if choice(ui, label, is, missing.as_deref()) {
                textures = set;
            }
        }
        for (label, missing, is, set) in [
            ("rays in software", &None, rays == RayTier::Software, RayTier::Software),
            ("rays by the adapter's ray query", &adapter.no_ray_query, rays == RayTier::Query, RayTier::Query),
        ] {
            if choice(ui, label, is, missing.as_deref()) {
                rays = set;
            }
        }
        let visible = matches!(gbuffer, GBufferTier::Visibility(_));
        for (label, missing, is, set) in [
            ("G-buffer of triangles", &adapter.no_triangles, visible, GBufferTier::Visibility(Ids::Wide)),
            ("G-buffer of attributes", &None, !visible, GBufferTier::default()),
        ] {
            if choice(ui, label, is, missing.as_deref()) {
                gbuffer = set;
            }
        }
        self.options = Options { textures, anisotropy, rays, gbuffer, ..self.options };
    }

    fn size_rows(&mut self, ui: &mut Ui) {
        let mut matches = self.fill.is_some();
        let switch = ui.checkbox(&mut matches, "Match window size");
        if switch.on_hover_text("The picture is as large as its place in the window").changed() {
            self.fill = matches.then_some(1);
        }
        if let Some(coarse) = &mut self.fill {
            row::labelled(ui, "screen pixels", |ui| {
                let slider = row::slider(ui, Slider::new(coarse, 1..=COARSEST), 0.0);
                slider.on_hover_text(
                    "Screen pixels along a side of a picture's pixel, 1 to 8. Higher: fewer pixels to render, and \
                     larger to look at.",
                );
            });
            return;
        }
        let longest = self.opened.as_ref().map_or(0, |o| o.adapter.longest);
        // Not known before the first scene is there.
        let most = if longest == 0 { 16_384 } else { (longest / self.options.m).max(1) };
        row::labelled(ui, "size", |ui| {
            ui.horizontal_wrapped(|ui| {
                let mut side = |side: &mut u32, hint: &str| {
                    ui.add(DragValue::new(side).range(1..=most).suffix(" px")).on_hover_text(hint);
                };
                side(&mut self.options.width, "Width of the picture");
                side(&mut self.options.height, "Height of the picture");
            });
        });
    }
}

/// A choice that is disabled if something is missing for it. Returns whether it was clicked.
fn choice(ui: &mut Ui, label: &str, is: bool, missing: Option<&str>) -> bool {
    let radio = ui.add_enabled(missing.is_none(), egui::RadioButton::new(is, label));
    radio.on_disabled_hover_text(format!("this adapter lacks {}", missing.unwrap_or_default())).clicked()
}
