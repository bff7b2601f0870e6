//! What the colours of a debug view or of the error mean.

use deferred_aa::{DebugView, Settings, Technique};
use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, pos2, vec2};

/// The scale of `daa_heat` and of the error: from nothing to the most.
const HEAT: [Color32; 4] = [Color32::BLACK, RED, YELLOW, Color32::WHITE];
const RED: Color32 = Color32::from_rgb(255, 0, 0);
const GREEN: Color32 = Color32::from_rgb(0, 255, 0);
const BLUE: Color32 = Color32::from_rgb(0, 0, 255);
const YELLOW: Color32 = Color32::from_rgb(255, 255, 0);
const CYAN: Color32 = Color32::from_rgb(0, 255, 255);

/// What colours mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    title: String,
    /// Places on the scale from black over red and yellow to white, 0 to 1, and what is written there.
    ticks: Vec<(f32, String)>,
    /// Colours that stand for something each.
    keys: Vec<(Color32, &'static str)>,
}

impl Legend {
    /// Of the picture of where a side is wrong.
    pub fn of_error() -> Self {
        let ticks = ["0", "1/64", "1/16", "1/4"].into_iter().enumerate();
        Self {
            title: "error of the displayed value, of 1".to_owned(),
            ticks: ticks.map(|(i, text)| (i as f32 / 3.0, text.to_owned())).collect(),
            keys: Vec::new(),
        }
    }

    /// Of a debug view; none where the picture itself is shown.
    pub fn of_view(settings: &Settings, m: u32) -> Option<Self> {
        let n = m * m;
        let keys = |title: &str, keys: &[(Color32, &'static str)]| Self {
            title: title.to_owned(),
            ticks: Vec::new(),
            keys: keys.to_vec(),
        };
        let scale = |title: &str, ticks: Vec<(f32, String)>| Self { title: title.to_owned(), ticks, keys: Vec::new() };
        let words = |title: &str| keys(title, &[]);
        Some(match settings.view {
            DebugView::Image => return None,
            DebugView::Count if settings.technique == Technique::Surfaces => scale("lights a pixel", logarithmic(n)),
            DebugView::Count => scale("shaded samples a pixel", logarithmic(n)),
            DebugView::Taps => scale("reads of a material a pixel", logarithmic(2 * n)),
            DebugView::Surfaces => scale("surfaces a pixel", logarithmic(n)),
            DebugView::Rays => scale("rays a pixel", vec![(0.0, "none".to_owned()), (1.0, "most".to_owned())]),
            DebugView::Decided if settings.technique == Technique::Selective => keys(
                "what activates the first quadrant",
                &[
                    (Color32::BLACK, "nothing"),
                    (RED, "shadow"),
                    (GREEN, "normal"),
                    (BLUE, "colour or texture"),
                    (YELLOW, "object"),
                ],
            ),
            DebugView::Decided => keys(
                "what decided the number of samples",
                &[
                    (Color32::BLACK, "nothing"),
                    (RED, "depth"),
                    (GREEN, "normal"),
                    (BLUE, "luminance"),
                    (YELLOW, "identity"),
                    (CYAN, "shadow"),
                    (Color32::WHITE, "the host's bytes"),
                ],
            ),
            DebugView::Quadrants => keys(
                "active quadrants",
                &[(Color32::BLACK, "0"), (RED, "1"), (GREEN, "2"), (BLUE, "3"), (Color32::WHITE, "4")],
            ),
            DebugView::Levels => keys(
                "the lattice that was shaded",
                &[
                    (Color32::WHITE, "every pixel"),
                    (CYAN, "shifted pixels"),
                    (GREEN, "every second"),
                    (YELLOW, "every fourth"),
                    (RED, "every eighth"),
                    (Color32::BLACK, "interpolated"),
                ],
            ),
            DebugView::Tiles => keys(
                "rays of a tile",
                &[(Color32::BLACK, "none"), (BLUE, "shadow rays"), (YELLOW, "mirrored and refracted too")],
            ),
            DebugView::Shadows => words("bright: lights reach the surface"),
            DebugView::First => words("the first sample of each pixel"),
            DebugView::Depth => words("fourth root of the depth buffer's value"),
            DebugView::Normal => words("normal: x, y, z as red, green, blue"),
            DebugView::GeometricNormal => words("geometric normal: x, y, z as red, green, blue"),
            DebugView::Tangent => words("tangent: x, y, z as red, green, blue"),
            DebugView::Uv => words("fractions of u and v as red and green"),
            DebugView::Gradient => words("texture footprint: black 1/65536, white the whole texture"),
            DebugView::Material => words("a colour for each material"),
            DebugView::Object => words("a colour for each object"),
            DebugView::User => words("the host's lowest 24 bits as red, green, blue"),
        })
    }

    /// Draws it at a corner, and says where.
    pub fn draw(&self, painter: &Painter, at: Pos2, align: Align2, width: f32) -> Rect {
        let font = FontId::proportional(11.0);
        let layout = |text: &str| painter.layout(text.to_owned(), font.clone(), Color32::WHITE, width - 24.0);
        let title = layout(&self.title);
        let ticks: Vec<_> = self.ticks.iter().map(|(t, text)| (*t, layout(text))).collect();
        let keys: Vec<_> = self.keys.iter().map(|(color, text)| (*color, layout(text))).collect();
        let bar = if ticks.is_empty() { 0.0 } else { 150f32.min(width - 24.0) };
        let line = title.size().y.max(12.0);
        let widest = keys.iter().map(|(_, text)| text.size().x + 18.0).fold(title.size().x.max(bar + 20.0), f32::max);
        let bar_height = if ticks.is_empty() { 0.0 } else { 26.0 };
        let height = title.size().y + bar_height + keys.iter().map(|(_, text)| text.size().y + 1.0).sum::<f32>();
        let rect = align.anchor_size(at, vec2(widest + 10.0, height + 8.0));
        painter.rect_filled(rect, 3.0, Color32::from_black_alpha(210));
        let corner = rect.min + vec2(5.0, 4.0);
        let mut top = corner.y + title.size().y;
        painter.galley(corner, title, Color32::WHITE);
        if bar > 0.0 {
            let own = Rect::from_min_size(pos2(corner.x + 6.0, top + 2.0), vec2(bar, 10.0));
            painter.add(gradient(own));
            for (t, text) in ticks {
                let x = own.left() + t * own.width();
                painter.vline(x, own.bottom()..=own.bottom() + 3.0, (1.0, Color32::WHITE));
                painter.galley(pos2(x - text.size().x / 2.0, own.bottom() + 2.0), text, Color32::WHITE);
            }
            top += bar_height;
        }
        for (color, text) in keys {
            let swatch = Rect::from_min_size(pos2(corner.x, top + line / 2.0 - 5.0), vec2(12.0, 10.0));
            painter.rect(swatch, 0.0, color, (1.0, Color32::GRAY), egui::StrokeKind::Inside);
            let high = text.size().y + 1.0;
            painter.galley(pos2(corner.x + 18.0, top), text, Color32::WHITE);
            top += high;
        }
        rect
    }
}

/// Powers of two from 1 to `most`, and `most`, where they lie on a logarithmic scale.
fn logarithmic(most: u32) -> Vec<(f32, String)> {
    let powers = (0..).map(|e| 1u32 << e).take_while(|&k| k * 3 / 2 < most);
    let scale = (most as f32).log2().max(1.0);
    powers.chain([most]).map(|k| ((k as f32).log2() / scale, k.to_string())).collect()
}

fn gradient(rect: Rect) -> Shape {
    let mut mesh = Mesh::default();
    for (i, color) in HEAT.into_iter().enumerate() {
        let x = rect.left() + rect.width() * i as f32 / 3.0;
        mesh.colored_vertex(pos2(x, rect.top()), color);
        mesh.colored_vertex(pos2(x, rect.bottom()), color);
    }
    for i in 0..3 {
        let first = 2 * i;
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 1, first + 2, first + 3);
    }
    Shape::mesh(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_debug_view_says_what_its_colours_mean() {
        for view in DebugView::ALL {
            for technique in Technique::ALL {
                let settings = Settings { view, technique, ..Settings::default() };
                let legend = Legend::of_view(&settings, 4);
                assert_eq!(legend.is_none(), view == DebugView::Image, "{view:?}");
                assert!(legend.is_none_or(|l| !l.title.is_empty()));
            }
        }
    }

    #[test]
    fn ticks_of_samples_lie_on_the_scale() {
        let ticks = |most| logarithmic(most).into_iter().map(|(t, text)| format!("{text}@{t:.2}")).collect::<Vec<_>>();
        assert_eq!(ticks(16), ["1@0.00", "2@0.25", "4@0.50", "8@0.75", "16@1.00"]);
        assert_eq!(ticks(9), ["1@0.00", "2@0.32", "4@0.63", "9@1.00"]);
        assert_eq!(ticks(1), ["1@0.00"]);
    }
}
