//! The division of an image into bands of one size.

use crate::TILE;
use crate::host::band::{Band, Rect};

/// The most samples along one side of an image that is divided into bands: the coordinates of lattices fit 32 bits.
pub(crate) const MOST_SAMPLES: u32 = 65535;

/// An image and the size of its bands, aprons included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub image: [u32; 2],
    pub size: [u32; 2],
}

/// The bands along one side of an image. All bands are equally long and begin at a tile. The last one ends at the
/// image's edge, so that a band's length leaves the same remainder of a tile as the image's.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// The number of pixels of the image.
    length: u32,
    /// The number of pixels of a band, aprons included.
    size: u32,
    /// The pixel at which the output of the first band ends.
    first: u32,
    /// The distance from one band to the next.
    step: u32,
    count: u32,
}

impl Side {
    /// `None` if a band has no room beside its aprons.
    fn new(length: u32, size: u32, apron: u32) -> Option<Self> {
        if size >= length {
            return Some(Self { length, size, first: length, step: 0, count: 1 });
        }
        let first = size.checked_sub(apron)? / TILE * TILE;
        let step = first.checked_sub(apron.next_multiple_of(TILE)).filter(|&step| step > 0)?;
        Some(Self { length, size, first, step, count: 1 + (length - size).div_ceil(step) })
    }

    /// The lengths that bands may have, from the least; the last is the image's.
    fn sizes(length: u32, apron: u32) -> impl Fn(u32) -> u32 {
        let room = apron + apron.next_multiple_of(TILE) + TILE;
        let least = room + length.wrapping_sub(room) % TILE;
        move |i| least.saturating_add(i.saturating_mul(TILE)).min(length)
    }

    /// The number of such lengths.
    fn options(length: u32, apron: u32) -> u32 {
        let least = Self::sizes(length, apron)(0);
        (length - least).div_ceil(TILE) + 1
    }

    /// The begin of a band, and the begin and end of its output.
    fn band(self, index: u32) -> [u32; 3] {
        let begin = if index == 0 { 0 } else { self.first + (index - 1) * self.step };
        let end = if index + 1 == self.count { self.length } else { self.first + index * self.step };
        [(index * self.step).min(self.length - self.size), begin, end]
    }
}

impl Layout {
    fn sides(self, apron: u32) -> Option<[Side; 2]> {
        let side = |axis: usize| Side::new(self.image[axis], self.size[axis], apron);
        Some([side(0)?, side(1)?])
    }

    /// The number of bands for frames whose passes need this apron in pixels. `None` if the bands are too small for it.
    pub fn count(self, apron: u32) -> Option<u32> {
        let [x, y] = self.sides(apron)?;
        Some(x.count * y.count)
    }

    /// A band by its number, row by row. `None` if there is no such band.
    pub fn band(self, apron: u32, index: u32) -> Option<Band> {
        let [x, y] = self.sides(apron)?;
        let count = x.count * y.count;
        if index >= count {
            return None;
        }
        let ([left, x0, x1], [top, y0, y1]) = (x.band(index % x.count), y.band(index / x.count));
        let [width, height] = self.size;
        Some(Band {
            index,
            count,
            image: self.image,
            output: Rect { x: x0, y: y0, width: x1 - x0, height: y1 - y0 },
            raster: Rect { x: left, y: top, width, height },
        })
    }

    /// All bands, in the order in which they are recorded.
    pub fn bands(self, apron: u32) -> Vec<Band> {
        (0..).map_while(|index| self.band(apron, index)).collect()
    }

    /// The least bands that an image can have: their output has a tile along each side that is divided.
    pub fn least(image: [u32; 2], apron: u32) -> Self {
        Self { image, size: image.map(|length| Side::sizes(length, apron)(0)) }
    }

    /// The layout with the fewest bands whose size `fits`, and of these the one that rasters the fewest pixels. A
    /// smaller size than one that fits must also fit. `None` if not even the least bands fit.
    pub fn fit(image: [u32; 2], apron: u32, fits: impl Fn([u32; 2]) -> bool) -> Option<Self> {
        let [wide, high] = image.map(|length| Side::sizes(length, apron));
        let [columns, rows] = image.map(|length| Side::options(length, apron));
        let mut best: Option<(u32, u64, Self)> = None;
        let mut across = 1;
        while best.is_none_or(|(count, ..)| across <= count) {
            // The narrowest bands of which so many make a row.
            let is_enough = |i| Side::new(image[0], wide(i), apron).is_some_and(|side| side.count <= across);
            let width = wide(first_that(columns, is_enough));
            // The highest that fit beside it, and then the least of which as few make a column.
            let too_high = first_that(rows, |i| !fits([width, high(i)]));
            if too_high > 0 {
                let down = |i| Side::new(image[1], high(i), apron).map_or(u32::MAX, |side| side.count);
                let fewest = down(too_high - 1);
                let height = high(first_that(rows, |i| down(i) <= fewest));
                let layout = Self { image, size: [width, height] };
                if let Some(count) = layout.count(apron) {
                    let pixels = u64::from(count) * u64::from(width) * u64::from(height);
                    if best.is_none_or(|(least, of_least, _)| (count, pixels) < (least, of_least)) {
                        best = Some((count, pixels, layout));
                    }
                }
            }
            if width == wide(0) {
                break;
            }
            across += 1;
        }
        best.map(|(.., layout)| layout)
    }
}

/// The first index below `end` from which on a condition holds; `end` if it holds for none.
fn first_that(end: u32, holds: impl Fn(u32) -> bool) -> u32 {
    let (mut below, mut above) = (0, end);
    while below < above {
        let middle = below + (above - below) / 2;
        if holds(middle) {
            above = middle;
        } else {
            below = middle + 1;
        }
    }
    below
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pixel belongs to the output of one band; what lies around it within the apron is rastered; bands begin at
    /// tiles and have one size.
    fn assert_sound(layout: Layout, apron: u32) {
        let bands = layout.bands(apron);
        let [width, height] = layout.image;
        let mut times = vec![0; (width * height) as usize];
        for band in &bands {
            let Rect { x, y, .. } = band.raster;
            assert_eq!([band.raster.width, band.raster.height], layout.size);
            assert!(band.raster.fits(layout.image) && x % TILE == 0 && y % TILE == 0, "{band:?}");
            assert!(band.output.x % TILE == 0 && band.output.y % TILE == 0, "{band:?}");
            let sides = [
                (x, band.raster.width, band.output.x, band.output.width, width),
                (y, band.raster.height, band.output.y, band.output.height, height),
            ];
            for (from, size, shown, shown_size, length) in sides {
                assert!(shown_size > 0 && from <= shown.saturating_sub(apron), "{band:?}");
                assert!(from + size >= (shown + shown_size + apron).min(length), "{band:?}");
            }
            for row in band.output.y..band.output.y + band.output.height {
                for column in band.output.x..band.output.x + band.output.width {
                    times[(row * width + column) as usize] += 1;
                }
            }
        }
        assert!(times.iter().all(|&t| t == 1), "{layout:?}");
        assert_eq!(bands.len() as u32, layout.count(apron).unwrap_or(0));
    }

    #[test]
    fn bands_give_each_pixel_once() {
        for image in [[1, 1], [37, 21], [64, 64], [200, 7], [131, 97]] {
            for apron in [0, 1, 6, 8, 31] {
                assert_sound(Layout::least(image, apron), apron);
                for pixels in [600, 2000, 5000, 1 << 20] {
                    if let Some(layout) = Layout::fit(image, apron, |[w, h]| w * h <= pixels) {
                        assert!(layout.size[0] * layout.size[1] <= pixels);
                        assert_sound(layout, apron);
                    }
                }
            }
        }
    }

    #[test]
    fn there_are_as_few_as_fit() {
        let rows = |most: u32| Layout::fit([64, 256], 1, move |[_, h]| h <= most).map(|layout| layout.size);
        assert_eq!(rows(256), Some([64, 256]));
        // Two bands overlap by both aprons, rounded up to tiles.
        assert_eq!(rows(255), Some([64, 136]));
        assert_eq!(rows(135), Some([64, 96]));
        assert_eq!(rows(23), None);
        let least = Layout::least([64, 256], 1);
        assert_eq!(least.size, [24, 24]);
        assert_eq!(Layout::fit([64, 256], 1, |size| size == least.size), Some(least));
        // Narrow enough for a limit of the device, and no narrower.
        let fit = Layout::fit([3840, 2160], 1, |size| size.iter().all(|&side| side * 4 <= 8192));
        assert_eq!(fit.map(|layout| layout.count(1)), Some(Some(4)));
    }
}
