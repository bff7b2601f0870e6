//! Where two pictures differ most.

use super::error::PictureError;
use super::linear::Picture;
use deferred_aa::Rect;

/// The part of a rectangle that lies inside `width`×`height`, at least one pixel of it.
pub fn clip(rect: Rect, width: u32, height: u32) -> Rect {
    let (x, y) = (rect.x.min(width - 1), rect.y.min(height - 1));
    Rect { x, y, width: rect.width.clamp(1, width - x), height: rect.height.clamp(1, height - y) }
}

/// Whether less than `space` pixels lie between two rectangles.
fn near(one: Rect, other: Rect, space: u32) -> bool {
    let apart = |a: u32, a_len: u32, b: u32, b_len: u32| {
        let (a, b, space) = (u64::from(a), u64::from(b), u64::from(space));
        a + u64::from(a_len) + space <= b || b + u64::from(b_len) + space <= a
    };
    !apart(one.x, one.width, other.x, other.width) && !apart(one.y, one.height, other.y, other.height)
}

/// At most `count` windows of `size`×`size` pixels, clipped to the picture, that show where `a` and `b` differ most.
///
/// Each in turn is the window with the largest sum of |a − b| as shown, among those that keep `size` pixels from the
/// windows before it, or, when none with a difference does, that do not overlap them. The uppermost, then leftmost,
/// wins a tie, and is centred on what differs where that costs nothing. Windows without any difference are not given.
pub fn pick_crops(a: &Picture, b: &Picture, count: usize, size: u32) -> Result<Vec<Rect>, PictureError> {
    a.check()?;
    b.check()?;
    let (width, height) = (a.width, a.height);
    if (b.width, b.height) != (width, height) {
        let found = (b.width, b.height);
        return Err(PictureError::Differ { what: "the second picture".into(), found, first: (width, height) });
    }
    let difference: Vec<u32> = a
        .to_srgb8()
        .iter()
        .zip(&b.to_srgb8())
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum())
        .collect();
    let sums = Sums::new(&difference, width as usize, height as usize);
    let window = Rect { x: 0, y: 0, width: size.clamp(1, width), height: size.clamp(1, height) };

    let mut chosen: Vec<Rect> = Vec::new();
    while chosen.len() < count {
        let free = |r: Rect, space| chosen.iter().all(|c| !near(*c, r, space));
        let best = |space| {
            let mut best: Option<(u64, Rect)> = None;
            for y in 0..=height - window.height {
                for x in 0..=width - window.width {
                    let at = Rect { x, y, ..window };
                    let sum = sums.of(at);
                    if sum > best.map_or(0, |(sum, _)| sum) && free(at, space) {
                        best = Some((sum, at));
                    }
                }
            }
            best
        };
        let Some((sum, at)) = best(size).or_else(|| best(0)) else { break };
        let centred = sums.centred(at);
        chosen.push(if sums.of(centred) >= sum && free(centred, 0) { centred } else { at });
    }
    Ok(chosen)
}

/// Summed areas, so that any window's sum costs four reads.
struct Sums {
    width: usize,
    height: usize,
    /// Entry (x, y) of (width + 1)·(height + 1) is the sum of all values above and to the left of it.
    sums: Vec<u64>,
}

impl Sums {
    fn new(values: &[u32], width: usize, height: usize) -> Self {
        let mut sums = vec![0; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row = 0;
            for x in 0..width {
                row += u64::from(values[y * width + x]);
                sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
            }
        }
        Self { width, height, sums }
    }

    fn of(&self, r: Rect) -> u64 {
        let at = |x: u32, y: u32| self.sums[y as usize * (self.width + 1) + x as usize];
        let (right, bottom) = (r.x + r.width, r.y + r.height);
        at(right, bottom) + at(r.x, r.y) - at(right, r.y) - at(r.x, bottom)
    }

    /// The window moved onto the centre of gravity of the values inside it.
    fn centred(&self, r: Rect) -> Rect {
        let total = self.of(r).max(1);
        let column = |x| u64::from(x) * self.of(Rect { x, width: 1, ..r });
        let row = |y| u64::from(y) * self.of(Rect { y, height: 1, ..r });
        let x = ((r.x..r.x + r.width).map(column).sum::<u64>() / total) as u32;
        let y = ((r.y..r.y + r.height).map(row).sum::<u64>() / total) as u32;
        let (right, bottom) = (self.width as u32 - r.width, self.height as u32 - r.height);
        Rect { x: x.saturating_sub(r.width / 2).min(right), y: y.saturating_sub(r.height / 2).min(bottom), ..r }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::made::picture;

    #[test]
    fn crops_find_the_differences_and_keep_apart() {
        let a = picture(64, 48, |_, _| [0.2; 3]);
        let spots = [(50, 40, 9.0), (10, 10, 5.0), (12, 30, 2.0)];
        let b = picture(64, 48, |x, y| spots.iter().find(|s| (s.0, s.1) == (x, y)).map_or([0.2; 3], |s| [s.2; 3]));
        let crops = pick_crops(&a, &b, 5, 8).unwrap();
        assert_eq!(crops.len(), 3, "{crops:?}");
        for (crop, (x, y, _)) in crops.iter().zip(spots) {
            assert_eq!((crop.x, crop.y), (x - 4, y - 4), "the spot is in the middle");
        }
        assert_eq!(crops, pick_crops(&b, &a, 5, 8).unwrap());
        assert!(pick_crops(&a, &a, 5, 8).unwrap().is_empty());
        assert!(pick_crops(&a, &b, 0, 8).unwrap().is_empty());
    }

    #[test]
    fn crops_never_overlap_nor_leave_the_picture() {
        for (width, height) in [(1, 1), (1, 9), (5, 4), (31, 17)] {
            let a = picture(width, height, |_, _| [0.0; 3]);
            let b = picture(width, height, |x, y| [((x * 7 + y * 13) % 5) as f32 + 0.1; 3]);
            for size in [0, 1, 3, 8, u32::MAX] {
                let crops = pick_crops(&a, &b, 6, size).unwrap();
                assert!(!crops.is_empty());
                for (i, r) in crops.iter().enumerate() {
                    assert_eq!(*r, clip(*r, width, height));
                    assert!(crops[..i].iter().all(|other| !near(*other, *r, 0)), "{crops:?}");
                }
            }
        }
        let (a, b) = (picture(2, 2, |_, _| [0.0; 3]), picture(2, 1, |_, _| [0.0; 3]));
        assert!(matches!(pick_crops(&a, &b, 1, 1), Err(PictureError::Differ { .. })));
    }
}
