//! Pictures in linear radiance, compared and written.

use std::path::Path;

/// A picture in linear radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub size: [usize; 2],
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// The mean of m × m pixels for each.
    pub fn reduced(&self, m: usize) -> Self {
        let [width, height] = self.size.map(|side| side / m);
        let mean = |x: usize, y: usize| {
            let window = (0..m * m).map(|i| self.pixels[(y * m + i / m) * self.size[0] + x * m + i % m]);
            let sum = window.fold([0.0f64; 3], |sum, p| [0, 1, 2].map(|c| sum[c] + f64::from(p[c])));
            sum.map(|c| (c / (m * m) as f64) as f32)
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
        Self { size: [width, height], pixels }
    }

    /// Peak signal-to-noise ratio in decibels as displayed: c/(1+c), then the sRGB curve.
    pub fn psnr(&self, other: &Self) -> f64 {
        self.psnr_where(other, |_| true)
    }

    /// The ratio over the pixels of these indices.
    pub fn psnr_where(&self, other: &Self, counts: impl Fn(usize) -> bool) -> f64 {
        assert_eq!(self.size, other.size);
        let squares = (0..self.pixels.len()).filter(|i| counts(*i)).map(|i| {
            let difference = |c: usize| displayed(self.pixels[i][c]) - displayed(other.pixels[i][c]);
            (0..3).map(|c| difference(c).powi(2)).sum::<f64>() / 3.0
        });
        let (sum, count) = squares.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
        -10.0 * (sum / f64::from(count)).log10()
    }

    /// The ratio of linear radiance, whose peak is 1.
    pub fn psnr_linear(&self, other: &Self) -> f64 {
        assert_eq!(self.size, other.size);
        let square = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>() / 3.0;
        let sum: f64 = self.pixels.iter().zip(&other.pixels).map(square).sum();
        -10.0 * (sum / self.pixels.len() as f64).log10()
    }

    /// The radiance that a picture was tone-mapped from by c/(1+c).
    pub fn before_reinhard(&self) -> Self {
        let radiance = |c: f32| c.clamp(0.0, 0.9999) / (1.0 - c.clamp(0.0, 0.9999));
        Self { size: self.size, pixels: self.pixels.iter().map(|p| p.map(radiance)).collect() }
    }

    /// Which windows of m × m pixels hold different colours: where the picture of their means has edges.
    pub fn edges(&self, m: usize) -> Vec<bool> {
        let [width, height] = self.size.map(|side| side / m);
        let edge = |x: usize, y: usize| {
            let window = || (0..m * m).map(|i| self.pixels[(y * m + i / m) * self.size[0] + x * m + i % m]);
            (0..3).any(|c| {
                let (least, most) =
                    window().map(|p| displayed(p[c])).fold((1.0f64, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
                most - least > 0.1
            })
        };
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| edge(x, y)).collect()
    }

    /// The same part of several pictures side by side, enlarged: the part's place and size as shares of a picture.
    pub fn strip(pictures: &[&Self], [x, y]: [f32; 2], [width, height]: [f32; 2], zoom: usize) -> Self {
        let [whole_width, whole_height] = pictures[0].size.map(|side| side as f32);
        let (x, y) = ((x * whole_width) as usize, (y * whole_height) as usize);
        let [width, height] = [width * whole_width, height * whole_height].map(|side| (side as usize).max(1));
        let gap = 4;
        let part = width * zoom + gap;
        let texel = |column: usize, row: usize| {
            let (picture, within) = (pictures[column / part], column % part);
            if within >= width * zoom {
                return [f32::MAX; 3];
            }
            picture.pixels[(y + row / zoom) * picture.size[0] + x + within / zoom]
        };
        let size = [part * pictures.len() - gap, height * zoom];
        let places = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| (column, row)));
        Self { size, pixels: places.map(|(column, row)| texel(column, row)).collect() }
    }

    /// Writes a PNG, as displayed.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        let bytes = self.pixels.iter().flat_map(|p| p.map(|c| (displayed(c) * 255.0).round() as u8)).collect();
        let [width, height] = self.size.map(|side| side as u32);
        let image = image::RgbImage::from_raw(width, height, bytes).expect("a picture");
        image.save(path).map_err(|e| format!("{}: {e}", path.display()))
    }
}

fn displayed(c: f32) -> f64 {
    let c = f64::from(c).max(0.0);
    let c = if c > 1e30 { 1.0 } else { c / (1.0 + c) };
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}
