//! Image quality against a reference: PSNR, edge PSNR, relative MSE, SSIM and FLIP.
//!
//! PSNR, SSIM and FLIP look at what a viewer sees: the 8-bit sRGB values that [`Picture::to_srgb8`] gives and
//! `image.png` holds, so any program that reads two such files gets the same figures. [`rmse_linear`] alone looks at
//! linear HDR.
//!
//! A pixel that is not finite is an error of the technique and never vanishes. In the image it is measured as what it
//! is shown as, [`NOT_FINITE`] (or its complement where the reference happens to have that colour), and in linear light
//! as [`NOT_FINITE_LINEAR`]. In the reference it makes the comparison void: [`QualityError::ReferenceNotFinite`].

use std::fmt;

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};

use crate::picture::{NOT_FINITE, Picture, PictureError};

/// The PSNR reported for identical 8-bit images, whose PSNR is infinite, which JSON can't hold.
///
/// Nothing else reaches it: images that differ in one step of one channel are below 200 dB up to 5e14 pixels.
pub const IDENTICAL_DB: f64 = 200.0;

/// The linear radiance that stands for a channel that is not finite: minus the largest half float. Radiance is not
/// negative, so this is far from every reference.
pub const NOT_FINITE_LINEAR: f64 = -65504.0;

/// ε of [`rmse_linear`], which keeps black reference pixels from a division by zero.
pub const RELATIVE_EPSILON: f64 = 0.01;

/// How near an image is to a reference. A field is `None` only where the measure does not exist for this input.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Quality {
    /// [`psnr`] in dB; higher is better, [`IDENTICAL_DB`] for identical images.
    pub psnr_db: Option<f64>,
    /// [`edge_psnr`] in dB; `None` without a mask and for a mask without an edge.
    pub edge_psnr_db: Option<f64>,
    /// [`rmse_linear`]; lower is better, 0 for identical images.
    pub rmse_linear: Option<f64>,
    /// [`ssim`], at most 1, which is identical; `None` for images smaller than its window.
    pub ssim: Option<f64>,
    /// Mean of [`flip`], from 0 (no visible difference) to 1.
    pub flip_mean: Option<f64>,
    /// 99th percentile of [`flip`].
    pub flip_p99: Option<f64>,
}

/// FLIP pooled over the image.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Flip {
    /// Mean over all pixels.
    pub mean: f64,
    /// 99th percentile by nearest rank: the smallest error that at least 99 % of the pixels do not exceed.
    pub p99: f64,
}

/// Which of the two pictures of a comparison an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The picture that is judged.
    Image,
    /// The picture that it is held against.
    Reference,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Image { "image" } else { "reference" })
    }
}

/// Why two pictures can't be compared.
#[derive(Debug, thiserror::Error)]
pub enum QualityError {
    /// A picture has no pixel, or not as many as its size says.
    #[error("the {side} can't be measured: {source}")]
    Picture {
        /// Which one.
        side: Side,
        /// What is wrong with it.
        source: PictureError,
    },
    /// The pictures differ in size.
    #[error(
        "the image is {}x{}, the reference {}x{}: render both at one size",
        image.0, image.1, reference.0, reference.1
    )]
    Size {
        /// Width and height of the image.
        image: (u32, u32),
        /// Width and height of the reference.
        reference: (u32, u32),
    },
    /// The edge mask does not have one entry a pixel.
    #[error("the edge mask has {found} entries for {expected} pixels: give one entry a pixel, rows from the top")]
    Mask {
        /// Pixels of the image.
        expected: usize,
        /// Entries of the mask.
        found: usize,
    },
    /// The reference holds a NaN or an infinity.
    #[error("the reference is not finite at pixel ({x}, {y}): render it again, nothing can be measured against it")]
    ReferenceNotFinite {
        /// Column, from the left.
        x: u32,
        /// Row, from the top.
        y: u32,
    },
    /// A frame of another size than those before it.
    #[error("a frame of {found} pixels among frames of {expected}: render all at one size")]
    Frames {
        /// Pixels of the frames before.
        expected: usize,
        /// Pixels of this one.
        found: usize,
    },
    /// Samples that do not make whole windows.
    #[error("{width}x{height} samples are no whole windows of {m}x{m}: render them at m times the picture's size")]
    Windows {
        /// Samples in a row.
        width: u32,
        /// Rows of samples.
        height: u32,
        /// Samples along one side of a window.
        m: u32,
    },
    /// More pixels than FLIP's 32-bit indices reach.
    #[error("FLIP takes at most {} pixels, these images have {pixels}", MAX_FLIP_PIXELS)]
    FlipSize {
        /// Pixels of the image.
        pixels: usize,
    },
}

/// nv-flip indexes bytes by `i32`: 3 floats a pixel.
const MAX_FLIP_PIXELS: usize = i32::MAX as usize / 12;

/// All measures at once. `edge_mask` has one entry a pixel, rows from the top, true where the window holds an edge.
pub fn compare(image: &Picture, reference: &Picture, edge_mask: Option<&[bool]>) -> Result<Quality, QualityError> {
    let pair = Displayed::new(image, reference)?;
    let flip = pair.flip()?;
    Ok(Quality {
        psnr_db: Some(pair.psnr()),
        edge_psnr_db: edge_mask.map(|mask| pair.edge_psnr(mask)).transpose()?.flatten(),
        rmse_linear: Some(relative_mse(image, reference)),
        ssim: pair.ssim(),
        flip_mean: Some(flip.mean),
        flip_p99: Some(flip.p99),
    })
}

/// Peak signal-to-noise ratio in dB: 10·log10(255²/MSE), one MSE over all pixels and RGB of the 8-bit sRGB images.
/// [`IDENTICAL_DB`] where the MSE is 0. The sum is in integers, thus exact.
pub fn psnr(image: &Picture, reference: &Picture) -> Result<f64, QualityError> {
    Ok(Displayed::new(image, reference)?.psnr())
}

/// [`psnr`] over the pixels where `edge_mask` is true; `None` where there is none.
pub fn edge_psnr(image: &Picture, reference: &Picture, edge_mask: &[bool]) -> Result<Option<f64>, QualityError> {
    Displayed::new(image, reference)?.edge_psnr(edge_mask)
}

/// Relative mean squared error on linear HDR: the mean over all pixels and RGB of (a − b)² / (b² + ε), b the reference,
/// ε = [`RELATIVE_EPSILON`]; no root is taken. After Rousselle, Knaus and Zwicker, *Adaptive Sampling and
/// Reconstruction using Greedy Error Minimization*, 2011. Not symmetric: the reference sets the scale.
pub fn rmse_linear(image: &Picture, reference: &Picture) -> Result<f64, QualityError> {
    check(image, reference)?;
    Ok(relative_mse(image, reference))
}

/// Structural similarity of the luma of the 8-bit sRGB images, after Wang, Bovik, Sheikh and Simoncelli, *Image Quality
/// Assessment*, 2004: an 11×11 Gaussian window of σ = 1.5, K1 = 0.01, K2 = 0.03, population covariance, mean over the
/// windows that lie inside the image. Luma is 0.299 R + 0.587 G + 0.114 B, not rounded. `None` where width or height is
/// below 11. Agrees with scikit-image's `structural_similarity(gaussian_weights=True, sigma=1.5,
/// use_sample_covariance=False, data_range=255)`.
///
/// The crate image-compare is not used: its windows are 8×8 blocks that do not overlap, so that the score depends on
/// where an edge falls among them, and its variances are sums, not means, which makes K2 64 times too weak.
pub fn ssim(image: &Picture, reference: &Picture) -> Result<Option<f64>, QualityError> {
    Ok(Displayed::new(image, reference)?.ssim())
}

/// ꟻLIP of the 8-bit sRGB images at 67 pixels per degree, pooled: Andersson et al., *ꟻLIP: A Difference Evaluator for
/// Alternating Images*, 2020, computed by NVIDIA's own code.
pub fn flip(image: &Picture, reference: &Picture) -> Result<Flip, QualityError> {
    Displayed::new(image, reference)?.flip()
}

pub(crate) fn check(image: &Picture, reference: &Picture) -> Result<(), QualityError> {
    for (picture, side) in [(image, Side::Image), (reference, Side::Reference)] {
        picture.check().map_err(|source| QualityError::Picture { side, source })?;
    }
    let (image, size) = ((image.width, image.height), (reference.width, reference.height));
    if image != size {
        return Err(QualityError::Size { image, reference: size });
    }
    match reference.rgba.iter().position(|p| !is_finite(p)) {
        Some(at) => {
            let width = reference.width as usize;
            Err(QualityError::ReferenceNotFinite { x: (at % width) as u32, y: (at / width) as u32 })
        }
        None => Ok(()),
    }
}

fn is_finite(pixel: &[f32; 4]) -> bool {
    pixel[..3].iter().all(|c| c.is_finite())
}

fn relative_mse(image: &Picture, reference: &Picture) -> f64 {
    let mut sum = 0.0;
    for (a, b) in image.rgba.iter().zip(&reference.rgba) {
        for (a, b) in a[..3].iter().zip(&b[..3]) {
            let b = f64::from(*b);
            let a = if a.is_finite() { f64::from(*a) } else { NOT_FINITE_LINEAR };
            sum += (a - b).powi(2) / (b * b + RELATIVE_EPSILON);
        }
    }
    sum / (3 * reference.rgba.len()) as f64
}

/// Both pictures as shown, of one size that is not zero.
struct Displayed {
    width: usize,
    height: usize,
    image: Vec<[u8; 3]>,
    reference: Vec<[u8; 3]>,
}

impl Displayed {
    fn new(image: &Picture, reference: &Picture) -> Result<Self, QualityError> {
        check(image, reference)?;
        let (mut shown, against) = (image.to_srgb8(), reference.to_srgb8());
        for ((a, b), linear) in shown.iter_mut().zip(&against).zip(&image.rgba) {
            if *b == NOT_FINITE && !is_finite(linear) {
                *a = NOT_FINITE.map(|c| 255 - c);
            }
        }
        Ok(Self { width: image.width as usize, height: image.height as usize, image: shown, reference: against })
    }
    fn psnr(&self) -> f64 {
        let pixels = self.image.iter().zip(&self.reference);
        decibels(pixels.map(|(a, b)| squared(*a, *b)).sum(), self.image.len())
    }

    fn edge_psnr(&self, mask: &[bool]) -> Result<Option<f64>, QualityError> {
        if mask.len() != self.image.len() {
            return Err(QualityError::Mask { expected: self.image.len(), found: mask.len() });
        }
        let edges = self.image.iter().zip(&self.reference).zip(mask).filter(|(_, edge)| **edge);
        let (sum, count) = edges.fold((0, 0), |(sum, n), ((a, b), _)| (sum + squared(*a, *b), n + 1));
        Ok((count > 0).then(|| decibels(sum, count)))
    }

    fn ssim(&self) -> Option<f64> {
        const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
        const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);
        let (columns, rows) = (self.width.checked_sub(SIDE - 1)?, self.height.checked_sub(SIDE - 1)?);
        if columns == 0 || rows == 0 {
            return None;
        }
        let weights = gaussian();
        let (image, reference) = (luma(&self.image), luma(&self.reference));
        let mut total = 0.0;
        // The window is a product of one over rows and one over columns: sum a column's moments, then the columns.
        let mut moments = vec![[0.0; 5]; self.width];
        for row in 0..rows {
            for (x, moments) in moments.iter_mut().enumerate() {
                *moments = [0.0; 5];
                for (dy, w) in weights.iter().enumerate() {
                    let at = (row + dy) * self.width + x;
                    let (a, b) = (image[at], reference[at]);
                    add(moments, *w, [a, b, a * a, b * b, a * b]);
                }
            }
            for window in moments.windows(SIDE) {
                let mut m = [0.0; 5];
                window.iter().zip(&weights).for_each(|(column, w)| add(&mut m, *w, *column));
                let [a, b, aa, bb, ab] = m;
                let (var_a, var_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
                let likeness = (2.0 * a * b + C1) * (2.0 * covariance + C2);
                total += likeness / ((a * a + b * b + C1) * (var_a + var_b + C2));
            }
        }
        Some(total / (columns * rows) as f64)
    }

    fn flip(&self) -> Result<Flip, QualityError> {
        let pixels = self.image.len();
        if pixels > MAX_FLIP_PIXELS {
            return Err(QualityError::FlipSize { pixels });
        }
        // Both sides are below 2^32: they come from a `Picture`.
        let load =
            |data: &[[u8; 3]]| FlipImageRgb8::with_data(self.width as u32, self.height as u32, data.as_flattened());
        let mut errors = nv_flip::flip(load(&self.reference), load(&self.image), DEFAULT_PIXELS_PER_DEGREE).to_vec();
        let mean = errors.iter().map(|e| f64::from(*e)).sum::<f64>() / pixels as f64;
        let rank = (pixels * 99).div_ceil(100) - 1;
        let (_, p99, _) = errors.select_nth_unstable_by(rank, f32::total_cmp);
        Ok(Flip { mean, p99: f64::from(*p99) })
    }
}

/// Width and height of SSIM's window.
const SIDE: usize = 11;

/// SSIM's window along one axis, of sum 1.
fn gaussian() -> [f64; SIDE] {
    let weights: [f64; SIDE] = std::array::from_fn(|i| {
        let from_centre = (i as f64 - (SIDE / 2) as f64) / 1.5;
        (-0.5 * from_centre * from_centre).exp()
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

fn add(sums: &mut [f64; 5], weight: f64, values: [f64; 5]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

/// ITU-R BT.601 luma.
fn luma(pixels: &[[u8; 3]]) -> Vec<f64> {
    pixels.iter().map(|p| p.map(f64::from)).map(|[r, g, b]| 0.299 * r + 0.587 * g + 0.114 * b).collect()
}

fn squared(a: [u8; 3], b: [u8; 3]) -> u64 {
    a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(b)).pow(2)).sum()
}

/// PSNR of `pixels` whose squared 8-bit differences sum to `sum` over RGB.
fn decibels(sum: u64, pixels: usize) -> f64 {
    if sum == 0 {
        return IDENTICAL_DB;
    }
    10.0 * (255.0 * 255.0 * 3.0 * pixels as f64 / sum as f64).log10()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The picture that is shown as these 8-bit values, none of which may be 255.
    fn shown(width: u32, height: u32, value: impl Fn(i32, i32, i32) -> i32) -> Picture {
        let linear = |v: i32| {
            let v = f64::from(v) / 255.0;
            let l = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
            (l / (1.0 - l)) as f32
        };
        let pixel = |x, y| [linear(value(x, y, 0)), linear(value(x, y, 1)), linear(value(x, y, 2)), 1.0];
        let rgba = (0..height as i32).flat_map(|y| (0..width as i32).map(move |x| (x, y))).map(|(x, y)| pixel(x, y));
        Picture { width, height, rgba: rgba.collect() }
    }

    fn flat(width: u32, height: u32, value: i32) -> Picture {
        shown(width, height, |_, _, _| value)
    }

    fn white(width: u32, height: u32) -> Picture {
        Picture { width, height, rgba: vec![[1e9, 1e9, 1e9, 1.0]; (width * height) as usize] }
    }

    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    fn disc(x: i32, y: i32, c: i32) -> i32 {
        if (x - 20).pow(2) + (y - 18).pow(2) < 150 { 200 - 20 * c } else { 30 + 3 * x + 10 * c }
    }

    /// A disc on a ramp, 48×40, and the same with noise of ±5 and one bright pixel: (image, reference).
    fn example() -> (Picture, Picture) {
        let noisy = |x, y, c| {
            if (x, y) == (33, 9) { 240 } else { disc(x, y, c) + (x * 13 + y * 7 + c * 3) % 11 - 5 }
        };
        (shown(48, 40, noisy), shown(48, 40, disc))
    }

    #[test]
    fn the_example_is_shown_as_meant() {
        let (_, reference) = example();
        let pixels = reference.to_srgb8();
        for (i, pixel) in pixels.iter().enumerate() {
            let (x, y) = (i as i32 % 48, i as i32 / 48);
            assert_eq!(pixel.map(i32::from), [0, 1, 2].map(|c| disc(x, y, c)));
        }
    }

    /// The constants come from numpy 2.4 in f64, scikit-image 0.26 (`peak_signal_noise_ratio`, and
    /// `structural_similarity` with the arguments named at [`ssim`]) and NVIDIA's flip-evaluator 1.7 (67 pixels per
    /// degree) on the 8-bit values of [`example`]; rMSE from their inverse display transform rounded to f32.
    #[test]
    fn independent_programs_agree() {
        let (image, reference) = example();
        let mask: Vec<bool> = (0..48 * 40).map(|i| (i % 48 + i / 48) % 5 == 0).collect();
        let q = compare(&image, &reference, Some(&mask)).unwrap();
        near(q.psnr_db.unwrap(), 36.27311037540207, 1e-9);
        near(q.edge_psnr_db.unwrap(), 38.12741200771092, 1e-9);
        near(q.ssim.unwrap(), 0.9591093265467696, 1e-9);
        near(q.rmse_linear.unwrap(), 0.17675334449037156, 1e-6);
        near(q.flip_mean.unwrap(), 0.021417079381474954, 1e-6);
        near(q.flip_p99.unwrap(), 0.08039979636669159, 1e-6);
    }

    #[test]
    fn swapped_arguments() {
        let (image, reference) = example();
        let (q, swapped) = (compare(&image, &reference, None).unwrap(), compare(&reference, &image, None).unwrap());
        assert_eq!(q.psnr_db, swapped.psnr_db);
        near(swapped.ssim.unwrap(), q.ssim.unwrap(), 1e-12);
        near(swapped.flip_mean.unwrap(), q.flip_mean.unwrap(), 1e-6);
        // From numpy: the bright pixel is now the scale of its own error.
        near(swapped.rmse_linear.unwrap(), 0.004490729257592235, 1e-7);
    }

    #[test]
    fn single_functions_are_the_fields() {
        let (image, reference) = example();
        let mask = vec![true; 48 * 40];
        let q = compare(&image, &reference, Some(&mask)).unwrap();
        assert_eq!(q.psnr_db, Some(psnr(&image, &reference).unwrap()));
        assert_eq!(q.edge_psnr_db, edge_psnr(&image, &reference, &mask).unwrap());
        assert_eq!(q.rmse_linear, Some(rmse_linear(&image, &reference).unwrap()));
        assert_eq!(q.ssim, ssim(&image, &reference).unwrap());
        let f = flip(&image, &reference).unwrap();
        assert_eq!((q.flip_mean, q.flip_p99), (Some(f.mean), Some(f.p99)));
    }

    #[test]
    fn identical_images() {
        let (image, _) = example();
        let q = compare(&image, &image, Some(&vec![true; 48 * 40])).unwrap();
        let all = [q.psnr_db, q.edge_psnr_db, q.rmse_linear, q.ssim, q.flip_mean, q.flip_p99];
        assert_eq!(all, [IDENTICAL_DB, IDENTICAL_DB, 0.0, 1.0, 0.0, 0.0].map(Some));
    }

    #[test]
    fn constant_offset_in_closed_form() {
        let (image, reference) = (flat(16, 16, 110), flat(16, 16, 100));
        near(psnr(&image, &reference).unwrap(), 20.0 * 25.5_f64.log10(), 1e-12);
        // Without structure SSIM is its luminance term.
        let c1 = 6.5025;
        let luminance = (2.0 * 110.0 * 100.0 + c1) / (110.0 * 110.0 + 100.0 * 100.0 + c1);
        near(ssim(&image, &reference).unwrap().unwrap(), luminance, 1e-9);
    }

    #[test]
    fn relative_error_in_closed_form() {
        let picture = |v: f32| Picture { width: 3, height: 1, rgba: vec![[v, v, v, 1.0]; 3] };
        near(rmse_linear(&picture(3.0), &picture(2.0)).unwrap(), 1.0 / 4.01, 1e-12);
        near(rmse_linear(&picture(1.0), &picture(0.0)).unwrap(), 100.0, 1e-9);
        // Both are shown as white: only the linear measure sees the difference.
        assert_eq!(psnr(&picture(1e6), &picture(2e6)).unwrap(), IDENTICAL_DB);
        near(rmse_linear(&picture(1e6), &picture(2e6)).unwrap(), 0.25, 1e-9);
    }

    #[test]
    fn one_step_in_one_channel_of_one_pixel() {
        let (mut image, reference) = (flat(20, 10, 100), flat(20, 10, 100));
        image.rgba[77][1] = flat(1, 1, 101).rgba[0][1];
        near(psnr(&image, &reference).unwrap(), 10.0 * (65025.0_f64 * 3.0 * 200.0).log10(), 1e-12);
        assert!(ssim(&image, &reference).unwrap().is_none());
    }

    #[test]
    fn black_against_white() {
        let (black, white) = (flat(32, 24, 0), white(32, 24));
        let q = compare(&white, &black, None).unwrap();
        near(q.psnr_db.unwrap(), 0.0, 1e-12);
        let c1 = 6.5025;
        near(q.ssim.unwrap(), c1 / (255.0 * 255.0 + c1), 1e-9);
        // flip-evaluator 1.7: 0.967391848564148 in every pixel.
        near(q.flip_mean.unwrap(), 0.967391848564148, 1e-6);
        near(q.flip_p99.unwrap(), 0.967391848564148, 1e-6);
    }

    #[test]
    fn edges_alone() {
        let (mut image, reference) = (flat(8, 8, 100), flat(8, 8, 100));
        for at in [10, 20, 30] {
            image.rgba[at] = flat(1, 1, 120).rgba[0];
        }
        let mask = |edges: &[usize]| -> Vec<bool> { (0..64).map(|i| edges.contains(&i)).collect() };
        let of = |edges: &[usize]| edge_psnr(&image, &reference, &mask(edges)).unwrap();
        near(of(&[10]).unwrap(), 20.0 * (255.0_f64 / 20.0).log10(), 1e-12);
        near(of(&[10, 11]).unwrap(), 20.0 * (255.0_f64 / 20.0).log10() + 10.0 * 2.0_f64.log10(), 1e-12);
        assert_eq!(of(&[0, 63]), Some(IDENTICAL_DB));
        assert_eq!(of(&[]), None);
        near(of(&(0..64).collect::<Vec<_>>()).unwrap(), psnr(&image, &reference).unwrap(), 1e-12);
        let short = compare(&image, &reference, Some(&[true; 63])).unwrap_err().to_string();
        assert!(short.contains("63 entries for 64 pixels"), "{short}");
    }

    #[test]
    fn a_pixel_that_is_not_finite_is_an_error() {
        let reference = flat(24, 24, 100);
        // The reference of the second round is shown in the very colour that stands for NaN.
        let magenta = Picture { rgba: vec![[1e9, 0.0, 1e9, 1.0]; 24 * 24], ..reference.clone() };
        for reference in [reference, magenta] {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut image = reference.clone();
                image.rgba[200][1] = bad;
                let q = compare(&image, &reference, None).unwrap();
                assert!(q.psnr_db.unwrap() < 36.0, "{bad}: {q:?}");
                assert!(q.rmse_linear.unwrap() > 1e5, "{bad}: {q:?}");
                assert!(q.ssim.unwrap() < 0.999, "{bad}: {q:?}");
                assert!(q.flip_mean.unwrap() > 1e-3, "{bad}: {q:?}");
                let void = compare(&reference, &image, None);
                assert!(matches!(void, Err(QualityError::ReferenceNotFinite { x: 8, y: 8 })), "{void:?}");
            }
        }
    }

    #[test]
    fn alpha_is_not_measured() {
        let (mut image, reference) = (flat(4, 4, 100), flat(4, 4, 100));
        image.rgba.iter_mut().for_each(|p| p[3] = f32::NAN);
        assert_eq!(compare(&image, &reference, None).unwrap().psnr_db, Some(IDENTICAL_DB));
    }

    #[test]
    fn every_size_is_measured_or_refused() {
        for (width, height) in [(1, 1), (1, 40), (40, 1), (2, 3), (10, 11), (11, 11), (11, 12), (13, 17)] {
            let (image, reference) = (white(width, height), flat(width, height, 0));
            let q = compare(&image, &reference, None).unwrap();
            assert_eq!(q.ssim.is_some(), width.min(height) >= 11, "{width}x{height}");
            near(q.psnr_db.unwrap(), 0.0, 1e-12);
            assert!(q.flip_mean.unwrap() > 0.9 && q.flip_p99.unwrap() > 0.9, "{width}x{height}: {q:?}");
        }
        let (one, empty) = (flat(1, 1, 0), flat(0, 1, 0));
        let message = |a: &Picture, b: &Picture| compare(a, b, None).unwrap_err().to_string();
        assert!(message(&empty, &empty).contains("the image can't be measured: a picture of 0x1 has no pixels"));
        assert!(message(&one, &empty).contains("the reference can't be measured"));
        assert!(message(&one, &flat(1, 2, 0)).contains("the image is 1x1, the reference 1x2"));
        assert!(message(&Picture { rgba: vec![], ..one.clone() }, &one).contains("0 pixels do not fill 1x1"));
    }

    #[test]
    fn json_has_every_field_or_null() {
        let q = compare(&white(2, 2), &flat(2, 2, 0), None).unwrap();
        let json = serde_json::to_value(q).unwrap();
        let keys = ["psnr_db", "edge_psnr_db", "rmse_linear", "ssim", "flip_mean", "flip_p99"];
        assert!(keys.iter().all(|k| json.get(k).is_some()), "{json}");
        assert!(json["edge_psnr_db"].is_null() && json["ssim"].is_null() && json["psnr_db"].is_number(), "{json}");
    }
}
