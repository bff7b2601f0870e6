//! The buttons over the picture: what is seen of it, and how.

use super::super::app::App;
use super::super::state::{Channel, Tone};
use deferred_aa::DebugView;
use egui::containers::menu::{MenuButton, MenuConfig, SubMenuButton, is_in_menu};
use egui::{
    Align2, ComboBox, DragValue, Frame, Id, Margin, Order, PopupCloseBehavior, Rect, Response, Slider, Ui, vec2,
};

/// The buttons are in a menu where the picture has less room than this, in points.
const NARROW: f32 = 420.0;

/// What the list of sizes says.
const ZOOM: &str = "Screen pixels for one of the picture, by whole multiples. A picture that is larger than its place \
                    is moved by the arrow keys, or dragged with the right button.";

impl App {
    /// The buttons, at the bottom of `area`. Returns where they begin.
    pub(super) fn toolbar(&mut self, ui: &Ui, area: Rect) -> f32 {
        if !self.look.buttons {
            return area.bottom();
        }
        let place = egui::Area::new(Id::unique("buttons")).order(Order::Middle).pivot(Align2::LEFT_BOTTOM);
        let shown = place.fixed_pos(area.left_bottom()).show(ui.ctx(), |ui| {
            let fill = ui.visuals().panel_fill.gamma_multiply(0.86);
            Frame::NONE.fill(fill).inner_margin(Margin::symmetric(6, 3)).show(ui, |ui| {
                ui.set_width(area.width() - 12.0);
                if area.width() < NARROW {
                    menu(ui, "Buttons", |ui| self.buttons(ui));
                } else {
                    ui.horizontal_wrapped(|ui| self.buttons(ui));
                }
            });
        });
        shown.response.rect.top()
    }

    fn buttons(&mut self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
        let split = self.shows(0) && self.shows(1);
        if ui.selectable_label(split, "Split").on_hover_text("Both sides with a divider, or one: B").clicked() {
            self.toggle_split();
        }
        if ui.button("Flip").on_hover_text("Shows the other side alone: Space").clicked() {
            self.flip();
        }
        let switches = [
            (&mut self.look.magnify, "Magnifier", "Magnifies what is around the pointer, on both sides: Z"),
            (&mut self.look.show_error, "Error", "Shows where the picture differs from the reference: X"),
        ];
        for (on, name, hint) in switches {
            if ui.selectable_label(*on, name).on_hover_text(hint).clicked() {
                *on = !*on;
            }
        }
        for (view, name, hint) in [
            (DebugView::Count, "Samples", "Shows how many samples of each pixel are shaded: 2"),
            (DebugView::Decided, "Decided by", "Shows which metric decided how many: 3"),
        ] {
            let on = self.view() == view;
            if ui.selectable_label(on, name).on_hover_text(hint).clicked() {
                self.show_view(if on { DebugView::Image } else { view });
            }
        }
        let view = self.view();
        let list = ComboBox::from_id_salt("debug view").width(84.0).selected_text(view_name(view)).show_ui(ui, |ui| {
            for other in DebugView::ALL {
                if ui.selectable_label(other == view, view_name(other)).clicked() {
                    self.show_view(other);
                }
            }
        });
        list.response.on_hover_text("The image, or a debug view of both sides: 1 is the image");
        let zooms = [(None, "Fit"), (Some(1.0), "1:1"), (Some(2.0), "2:1"), (Some(4.0), "4:1"), (Some(8.0), "8:1")];
        let chosen = zooms.iter().find(|(scale, _)| *scale == self.look.scale).map_or("Fit", |(_, name)| name);
        let list = ComboBox::from_id_salt("zoom").width(44.0).selected_text(chosen).show_ui(ui, |ui| {
            for (scale, name) in zooms {
                ui.selectable_value(&mut self.look.scale, scale, name);
            }
        });
        list.response.on_hover_text(ZOOM);
        let plain = self.look.tone == Tone::default();
        let title = if plain { "Display" } else { "Display *" };
        let hint = "Exposure, channel and range of what is shown; nothing else changes";
        menu(ui, title, |ui| self.display(ui)).on_hover_text(hint);
        let orbit = ui.selectable_label(self.look.orbit, "Orbit");
        if orbit.on_hover_text("Drags turn around what is looked at: O, or Alt and a drag").clicked() {
            self.look.orbit = !self.look.orbit;
        }
        let frame = ui.button("Frame");
        if frame.on_hover_text("Shows the whole scene; F frames the object under the pointer").clicked() {
            self.frame_object(None);
        }
    }
}

impl App {
    fn display(&mut self, ui: &mut Ui) {
        let tone = &mut self.look.tone;
        ui.label("exposure, stops");
        ui.add(Slider::new(&mut tone.exposure, -8.0..=8.0).max_decimals(2))
            .on_hover_text("-8 to 8. Higher: brighter. The node and the measured error stay as they are.");
        ui.label("channel");
        ui.horizontal_wrapped(|ui| {
            for channel in Channel::ALL {
                ui.selectable_value(&mut tone.channel, channel, channel.name());
            }
        });
        ui.label("range");
        ui.horizontal(|ui| {
            let [black, white] = &mut tone.range;
            for (value, name) in [(black, "black"), (white, "white")] {
                ui.add(DragValue::new(value).range(0.0..=1.0).speed(0.005).max_decimals(3))
                    .on_hover_text(format!("The displayed value that is shown {name}, 0 to 1"));
            }
        });
        if ui.button("Reset").clicked() {
            *tone = Tone::default();
        }
    }
}

/// A menu of controls, which stays open while they are used.
fn menu(ui: &mut Ui, title: &str, add: impl FnOnce(&mut Ui)) -> Response {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    if is_in_menu(ui) {
        SubMenuButton::new(title).config(config).ui(ui, add).0
    } else {
        MenuButton::new(title).config(config).ui(ui, add).0
    }
}

fn view_name(view: DebugView) -> String {
    serde_json::to_value(view).ok().and_then(|v| v.as_str().map(|name| name.replace('_', " "))).unwrap_or_default()
}
