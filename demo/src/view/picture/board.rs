//! The samples of the pixel under the pointer, as a board.

use super::super::renderer::{Maker, Rendered, casts};
use super::super::state::Side;
use crate::host::Sent;
use deferred_aa::{PlanWord, Settings, Technique};
use egui::{Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2, pos2, vec2};

/// Which samples of a window were shaded.
#[derive(Debug, Clone, PartialEq)]
pub enum Shaded {
    /// These places of the window, row by row.
    Places(Vec<bool>),
    /// So many, and it is not written down which.
    Count(u32),
}

/// The samples of a pixel whose word of the plan this is.
pub fn shaded(settings: &Settings, m: u32, word: PlanWord) -> Shaded {
    let Some(shaded) = deferred_aa::shaded_places(settings, m, word) else { return Shaded::Count(word.k().max(1)) };
    let mut places = vec![false; (m * m) as usize];
    shaded.into_iter().for_each(|(x, y)| places[(u32::from(y) * m + u32::from(x)) as usize] = true);
    Shaded::Places(places)
}

/// Of shadow rays alone, and of others too.
const SENDS: [Color32; 2] = [Color32::from_rgb(40, 90, 220), Color32::from_rgb(220, 40, 160)];

/// The rays of the pixel's samples, in words; none if its frame traces nothing.
fn rays(rendered: &Rendered, own: Option<&[Sent]>) -> Option<String> {
    // Nobody counts those of the reference.
    if casts(&rendered.shot) == [false; 2] || rendered.recipe.maker == Maker::Reference {
        return None;
    }
    let Some(own) = own else {
        let moves = |what: &str| format!("rays: not known, as the {what} moves them from frame to frame");
        let why = match rendered.recipe {
            recipe if recipe.has_history() => moves("jitter"),
            recipe if recipe.recorded().goal.is_some() => moves("goal"),
            _ => "rays: being counted".to_owned(),
        };
        return Some(why);
    };
    let sum = |of: fn(&Sent) -> u8| own.iter().map(|s| u32::from(of(s))).sum::<u32>();
    let kinds = [(sum(|s| s.shadow), "shadow"), (sum(|s| s.mirrored), "mirrored"), (sum(|s| s.refracted), "refracted")];
    let some: Vec<_> = kinds.iter().filter(|k| k.0 > 0).map(|(rays, kind)| format!("{rays} {kind}")).collect();
    Some(if some.is_empty() { "no rays".to_owned() } else { format!("rays: {}", some.join(", ")) })
}

/// The pixel's window as a board, its samples that were shaded bright, a dot in those that send rays, and its values.
pub fn samples(painter: &Painter, clip: Rect, side: &Side, rendered: &Rendered, pixel: [u32; 2], pointer: Pos2) {
    let m = rendered.view.options.m;
    let at = (pixel[1] * rendered.picture.width + pixel[0]) as usize;
    let [r, g, b, _] = rendered.picture.rgba.get(at).copied().unwrap_or_default();
    let text = |lines: &[String]| painter.layout_no_wrap(lines.join("\n"), FontId::proportional(12.0), Color32::WHITE);
    if rendered.recipe.is_forward() {
        // No samples of a G-buffer are shaded.
        let galley =
            text(&[format!("{}, {}   lit once a triangle", pixel[0], pixel[1]), format!("{r:.3} {g:.3} {b:.3}")]);
        let rect = ground(painter, clip, pointer, galley.size() + vec2(12.0, 12.0));
        painter.galley(rect.min + vec2(6.0, 6.0), galley, Color32::WHITE);
        return;
    }
    let word = rendered.plan.get(at).copied().unwrap_or(PlanWord(1));
    let shaded = shaded(&rendered.recipe.recorded(), m, word);
    let n = (m * m) as usize;
    let sent = side.sent.as_ref().and_then(|all| all.get(at * n..(at + 1) * n));
    let count = match &shaded {
        Shaded::Places(places) => places.iter().filter(|&&p| p).count() as u32,
        Shaded::Count(k) => *k,
    };
    let lit = rendered.recipe.recorded().technique == Technique::Surfaces;
    let of = if lit { "lights".to_owned() } else { format!("of {} samples", m * m) };
    let mut lines = vec![format!("{}, {}   {count} {of}", pixel[0], pixel[1]), format!("{r:.3} {g:.3} {b:.3}")];
    lines.extend(rays(rendered, sent));
    let others = |s: &Sent| s.mirrored + s.refracted > 0;
    let casting = |s: &Sent| s.shadow > 0 || others(s);
    if let Some(sent) = sent.filter(|sent| sent.iter().any(casting)) {
        let pink = if sent.iter().any(others) { "; pink: mirrored or refracted" } else { "" };
        lines.push(format!("a dot: the sample sends rays{pink}"));
    }
    if matches!(shaded, Shaded::Count(_)) && !lit {
        lines.push("the others are reconstructed".to_owned());
    }
    let galley = text(&lines);
    let cell = (72.0 / m as f32).floor().max(6.0);
    let board = cell * m as f32;
    let full = vec2(board + galley.size().x + 18.0, board.max(galley.size().y) + 12.0);
    let rect = ground(painter, clip, pointer, full);
    let corner = rect.min + vec2(6.0, 6.0);
    for i in 0..m * m {
        let min = corner + vec2((i % m) as f32, (i / m) as f32) * cell;
        let on = matches!(&shaded, Shaded::Places(places) if places[i as usize]);
        let color = if on { Color32::from_rgb(255, 190, 60) } else { Color32::from_gray(60) };
        painter.rect_filled(Rect::from_min_size(min, vec2(cell - 1.0, cell - 1.0)), 0.0, color);
    }
    for (sent, (x, y)) in sent
        .into_iter()
        .flatten()
        .zip(deferred_aa::sample_order(&rendered.recipe.recorded(), m))
        .filter(|(s, _)| casting(s))
    {
        let centre = corner + vec2(f32::from(x) + 0.5, f32::from(y) + 0.5) * cell - vec2(0.5, 0.5);
        painter.circle(
            centre,
            (cell * 0.24).max(2.0),
            SENDS[usize::from(others(sent))],
            Stroke::new(1.0, Color32::WHITE),
        );
    }
    painter.galley(corner + vec2(board + 6.0, 0.0), galley, Color32::WHITE);
}

/// A dark ground of this size beside the pointer, and its place.
fn ground(painter: &Painter, clip: Rect, pointer: Pos2, size: Vec2) -> Rect {
    let beside = pointer + vec2(24.0, 24.0);
    let min = pos2(beside.x.min(clip.right() - size.x), beside.y.min(clip.bottom() - size.y));
    let rect = Rect::from_min_size(min, size);
    painter.rect_filled(rect, 4.0, Color32::from_black_alpha(210));
    rect
}

#[cfg(test)]
mod tests {
    use super::*;
    use deferred_aa::Technique;

    #[test]
    fn the_board_shows_what_was_shaded() {
        let of = |technique, m, word| match shaded(&Settings { technique, ..Default::default() }, m, PlanWord(word)) {
            Shaded::Places(places) => places.iter().map(|&p| if p { '#' } else { '.' }).collect::<String>(),
            Shaded::Count(k) => k.to_string(),
        };
        assert_eq!(of(Technique::Full, 2, 0), "####");
        assert_eq!(of(Technique::Single, 2, 0), "#...");
        assert_eq!(of(Technique::Windowed, 2, 2), "#..#");
        assert_eq!(of(Technique::MultiResolution, 2, 0), "....");
        assert_eq!(of(Technique::Reconstructed, 4, 5), "5");
        // The upper left quadrant, and the first sample, which is nearest to the centre.
        assert_eq!(of(Technique::Selective, 4, 5 | 1 << 16), "##..##....#.....");
    }
}
