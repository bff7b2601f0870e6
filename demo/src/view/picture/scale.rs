//! How large a picture is shown: whole multiples, so that every pixel of it covers as many of the screen as the others.

use egui::{Rect, Vec2, pos2};

/// Screen pixels along a pixel of a picture of this size that fits its place, both in pixels: a whole number, or where
/// the picture is larger than its place, one over a whole number.
pub fn fitting(place: Vec2, size: Vec2) -> f32 {
    let fit = (place.x / size.x).min(place.y / size.y);
    // What differs by rounding alone fits.
    let fit = fit * (1.0 + 1e-4);
    if fit >= 1.0 { fit.floor() } else { 1.0 / (1.0 / fit.max(1e-3)).ceil() }
}

/// Moved so that its corner lies on a pixel of the screen.
pub fn snapped(rect: Rect, pixels_per_point: f32) -> Rect {
    let snap = |v: f32| (v * pixels_per_point).round() / pixels_per_point;
    Rect::from_min_size(pos2(snap(rect.left()), snap(rect.top())), rect.size())
}

/// Screen pixels along a picture's pixel with which a place of this size, in pixels, has at most so many of them.
pub fn coarse_enough(place: [u32; 2], most: u32) -> u32 {
    let [width, height] = place.map(u64::from);
    (1..=8).find(|n| (width / n) * (height / n) <= u64::from(most)).unwrap_or(8) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    #[test]
    fn pixels_are_shown_by_whole_multiples() {
        let size = vec2(480.0, 270.0);
        for (place, expected) in [
            (vec2(480.0, 270.0), 1.0),
            (vec2(959.0, 900.0), 1.0),
            (vec2(960.0, 541.0), 2.0),
            (vec2(1500.0, 820.0), 3.0),
            (vec2(479.0, 270.0), 0.5),
            (vec2(239.0, 270.0), 1.0 / 3.0),
        ] {
            assert_eq!(fitting(place, size), expected, "{place}");
        }
        let moved = snapped(Rect::from_min_size(pos2(10.3, 7.9), vec2(4.0, 4.0)), 2.0);
        assert_eq!((moved.min, moved.size()), (pos2(10.5, 8.0), vec2(4.0, 4.0)));
    }

    #[test]
    fn a_slow_device_gets_fewer_pixels() {
        assert_eq!(coarse_enough([1120, 840], 130_000), 3);
        assert_eq!(coarse_enough([704, 640], 130_000), 2);
        assert_eq!(coarse_enough([300, 200], 130_000), 1);
        assert_eq!(coarse_enough([100_000, 100_000], 1), 8);
    }
}
