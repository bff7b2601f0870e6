//! What keys do.

use super::dialog::{self, Dialog};
use super::fly;
use crate::view::app::App;
use deferred_aa::DebugView;
use egui::{Context, Key, Modifiers, Ui};
use glam::Vec3;

/// How far an arrow key moves the picture, in points.
const PAN: f32 = 40.0;

impl App {
    /// Does what keys and dropped files ask for.
    pub fn keys(&mut self, ui: &Ui) {
        let ctx = ui.ctx();
        for file in ctx.input(|i| i.raw.dropped_files.clone()) {
            self.open(&file.path().to_string_lossy());
        }
        let pressed = |modifiers, key| ctx.input_mut(|i| i.consume_key(modifiers, key));
        if pressed(Modifiers::COMMAND, Key::O) {
            self.dialog = Some(dialog::open(self.scene_name()));
        }
        if pressed(Modifiers::COMMAND, Key::S) {
            self.dialog = Some(dialog::save_settings());
        }
        if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z) || pressed(Modifiers::COMMAND, Key::Y) {
            self.sides[self.edited].redo();
        }
        if pressed(Modifiers::COMMAND, Key::Z) {
            self.sides[self.edited].undo();
        }
        if pressed(Modifiers::NONE, Key::F1) {
            self.dialog = Some(Dialog::Keys);
        }
        // Without a dialog it closes a list.
        if self.dialog.is_some() && pressed(Modifiers::NONE, Key::Escape) {
            self.dialog = None;
        }
        if self.dialog.is_some() || ctx.egui_wants_keyboard_input() || ctx.memory(|m| m.focused().is_some()) {
            return;
        }
        if pressed(Modifiers::NONE, Key::Space) {
            self.flip();
        }
        if pressed(Modifiers::NONE, Key::B) {
            self.toggle_split();
        }
        for (key, by) in [(Key::OpenBracket, -0.02), (Key::CloseBracket, 0.02)] {
            if pressed(Modifiers::NONE, key) {
                self.kept.divider = (self.kept.divider + by).clamp(0.0, 1.0);
            }
        }
        for (key, by) in [
            (Key::ArrowLeft, egui::vec2(PAN, 0.0)),
            (Key::ArrowRight, egui::vec2(-PAN, 0.0)),
            (Key::ArrowUp, egui::vec2(0.0, PAN)),
            (Key::ArrowDown, egui::vec2(0.0, -PAN)),
        ] {
            if pressed(Modifiers::NONE, key) {
                self.look.pan += by;
            }
        }
        let switches = [
            (Key::L, &mut self.look.frozen),
            (Key::T, &mut self.look.buttons),
            (Key::O, &mut self.look.orbit),
            (Key::Z, &mut self.look.magnify),
            (Key::X, &mut self.look.show_error),
            (Key::P, &mut self.look.panels),
        ];
        for (key, value) in switches {
            if pressed(Modifiers::NONE, key) {
                *value = !*value;
            }
        }
        for (key, view) in
            [(Key::Num1, DebugView::Image), (Key::Num2, DebugView::Count), (Key::Num3, DebugView::Decided)]
        {
            if pressed(Modifiers::NONE, key) {
                self.show_view(view);
            }
        }
        if pressed(Modifiers::NONE, Key::F) {
            self.frame_object(ctx.pointer_hover_pos());
        }
        let home = self.opened.as_ref().and_then(|opened| opened.cameras.first().copied());
        if let Some(home) = home.filter(|_| pressed(Modifiers::NONE, Key::Home)) {
            self.cut_to(home);
        }
        self.fly(ctx);
    }

    fn fly(&mut self, ctx: &Context) {
        let (Some(camera), Some(opened), false) = (self.camera, &self.opened, self.look.frozen) else { return };
        let way = ctx.input(|i| {
            let axis = |plus, minus| f32::from(i8::from(i.key_down(plus))) - f32::from(i8::from(i.key_down(minus)));
            let plain = !i.modifiers.command && !i.modifiers.alt;
            let way = Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
            // A window that slept must not jump.
            let seconds = i.stable_dt.min(0.1);
            if plain { way * seconds * if i.modifiers.shift { 4.0 } else { 1.0 } } else { Vec3::ZERO }
        });
        if way != Vec3::ZERO {
            self.camera = Some(fly::moved(camera, way * opened.radius() * 0.25));
            ctx.request_repaint();
        }
    }
}
