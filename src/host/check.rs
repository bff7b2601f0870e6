//! Probable mistakes in a host's input, and how to correct them.

use crate::wgsl;
use std::fmt;

/// A probable mistake in a host's input. Shares are 0 to 1, of the samples that could be judged.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InputMistake {
    /// The camera's projection gives nearer points the lesser depth.
    #[error(
        "Frame::camera has a projection whose depth grows with the distance; use a reversed one, 1 at the near plane and 0 far away"
    )]
    ProjectionNotReversed,
    /// Most surfaces lie at the near plane.
    #[error(
        "{:.0} % of the samples have a depth above 0.9, near the near plane; render with a reversed projection, clear depth to 0 and compare with Greater",
        share * 100.0
    )]
    DepthNotReversed {
        /// The share of all samples.
        share: f32,
    },
    /// Depths are NaN or outside 0 to 1.
    #[error(
        "{samples} samples have a depth that is not in 0 to 1; write the depth of the rasteriser, with its viewport's 0 to 1"
    )]
    DepthOutOfRange {
        /// The number of such samples.
        samples: u32,
    },
    /// Most normals have the code 0, to which the targets are cleared.
    #[error("{which} is 0 in {:.0} % of the samples; set it before daa_pack, and write all colour targets", share * 100.0)]
    NormalsUnset {
        /// The normal of `DaaFragment`.
        which: Normal,
        /// The share of the surfaces whose orientation follows from depth.
        share: f32,
    },
    /// Most normals fit the surface after a transform from view space to world space.
    #[error("{which} is in view space in {:.0} % of the samples; pass daa_pack a normal in world space", share * 100.0)]
    NormalsInViewSpace {
        /// The normal of `DaaFragment`.
        which: Normal,
        /// The share of the surfaces whose orientation follows from depth.
        share: f32,
    },
    /// Normals face away from the viewer.
    #[error("{which} faces away from the viewer in {:.0} % of the samples; flip it on back faces, and check that the winding order fits the culling", share * 100.0)]
    NormalsFlipped {
        /// The normal of `DaaFragment`.
        which: Normal,
        /// The share of the surfaces whose orientation follows from depth.
        share: f32,
    },
    /// Normals do not fit the surfaces.
    #[error(
        "{which} is more than 45° off the surface in {:.0} % of the samples; give daa_pack world space, from -1 to 1 and not from 0 to 1, and Frame::camera the G-buffer's camera",
        share * 100.0
    )]
    NormalsOff {
        /// The normal of `DaaFragment`.
        which: Normal,
        /// The share of the surfaces whose orientation follows from depth.
        share: f32,
    },
    /// Gradients are 0 where uv differs.
    #[error("ddx and ddy are 0 in {:.0} % of the samples whose uv differs; set them to dpdx(uv) and dpdy(uv)", share * 100.0)]
    GradientsMissing {
        /// The share of neighbours whose uv differs.
        share: f32,
    },
    /// Gradients are m times too large.
    #[error(
        "ddx and ddy are {m} times the change of uv in {:.0} % of the samples, as if they were per pixel; set them per sample, as dpdx and dpdy return them",
        share * 100.0
    )]
    GradientsPerPixel {
        /// The number of samples along one side of a window.
        m: u32,
        /// The share of neighbours whose uv differs.
        share: f32,
    },
    /// Gradients do not fit the change of uv.
    #[error("ddx and ddy do not fit uv in {:.0} % of the samples; set them to dpdx(uv) and dpdy(uv) of the uv that is packed", share * 100.0)]
    GradientsOff {
        /// The share of neighbours whose uv differs.
        share: f32,
    },
    /// All objects have the id 0, though there is more than one surface.
    #[error(
        "DaaFragment::object is 0 everywhere, though surfaces lie one behind another; give objects that touch ids of their own"
    )]
    ObjectsUnset,
    /// Both the host's WGSL and the target encode for the display.
    #[error(
        "the host's WGSL encodes its radiance (an exponent of 1/2.2 or 1/2.4), and the target is {target:?}, which encodes again; return linear radiance"
    )]
    EncodedTwice {
        /// The target format of the node.
        target: wgpu::TextureFormat,
    },
}

/// A normal of `DaaFragment`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normal {
    /// `DaaFragment::normal`.
    Shading,
    /// `DaaFragment::geometric_normal`.
    Geometric,
}

impl fmt::Display for Normal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Shading => "DaaFragment::normal",
            Self::Geometric => "DaaFragment::geometric_normal",
        })
    }
}

/// The counts of a normal, of [`InputCounts::planes`] samples.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct NormalCounts {
    /// The number of normals within 45° of the surface, on the visible side.
    pub fits: u32,
    /// The number of normals with the code 0.
    pub unset: u32,
    /// The number of normals that fit after a transform from view space to world space.
    pub in_view: u32,
    /// The number of normals within 45° of the surface, on its other side.
    pub flipped: u32,
}

/// The counts of a G-buffer in samples: `daa_input` of check.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct InputCounts {
    /// The number of samples with a surface.
    pub covered: u32,
    /// The number of samples whose depth is NaN or outside 0 to 1.
    pub bad_depth: u32,
    /// The number of samples with a depth above 0.9, under a perspective camera.
    pub near: u32,
    /// The number of samples with an object id other than 0.
    pub objects: u32,
    /// The number of samples whose right neighbour is nearer or farther by a tenth.
    pub steps: u32,
    /// The number of samples whose neighbours on the same surface show its orientation.
    pub planes: u32,
    /// The counts of `DaaFragment::normal`.
    pub normal: NormalCounts,
    /// The counts of `DaaFragment::geometric_normal`.
    pub geometric_normal: NormalCounts,
    /// The number of neighbours on one surface whose uv differs.
    pub slopes: u32,
    /// The number of these whose gradients fit the difference.
    pub gradient_fits: u32,
    /// The number of these with gradients of 0.
    pub gradient_missing: u32,
    /// The number of these whose gradients are m times too large.
    pub gradient_per_pixel: u32,
}

/// The least number of samples to judge from.
const ENOUGH: u32 = 64;

impl InputCounts {
    /// The probable mistakes in a G-buffer with this number of samples, m × m to a window.
    pub fn mistakes(&self, samples: u64, m: u32) -> Vec<InputMistake> {
        let mut found = Vec::new();
        let share = |part: u32, of: u64| part as f32 / of.max(1) as f32;
        if self.bad_depth > 0 {
            found.push(InputMistake::DepthOutOfRange { samples: self.bad_depth });
        }
        let near = share(self.near, samples);
        if near > 0.5 {
            // With such depths, no other check that uses depth means anything.
            found.push(InputMistake::DepthNotReversed { share: near });
            return found;
        }
        if self.planes >= ENOUGH {
            found.extend(self.normal.mistake(Normal::Shading, self.planes));
            found.extend(self.geometric_normal.mistake(Normal::Geometric, self.planes));
        }
        let of_slopes = |part: u32| share(part, self.slopes.into());
        if self.slopes >= ENOUGH && of_slopes(self.gradient_fits) < 0.5 {
            found.push(if of_slopes(self.gradient_missing) > 0.5 {
                InputMistake::GradientsMissing { share: of_slopes(self.gradient_missing) }
            } else if of_slopes(self.gradient_per_pixel) > 0.5 {
                InputMistake::GradientsPerPixel { m, share: of_slopes(self.gradient_per_pixel) }
            } else {
                InputMistake::GradientsOff { share: 1.0 - of_slopes(self.gradient_fits) }
            });
        }
        if self.covered >= ENOUGH && self.objects == 0 && share(self.steps, self.covered.into()) > 0.002 {
            found.push(InputMistake::ObjectsUnset);
        }
        found
    }
}

impl NormalCounts {
    fn mistake(&self, which: Normal, planes: u32) -> Option<InputMistake> {
        let share = |part: u32| part as f32 / planes as f32;
        if share(self.fits) >= 0.5 {
            return None;
        }
        Some(match [self.unset, self.in_view, self.flipped].map(share) {
            [share, ..] if share > 0.5 => InputMistake::NormalsUnset { which, share },
            [_, share, _] if share > 0.5 => InputMistake::NormalsInViewSpace { which, share },
            [.., share] if share > 0.5 => InputMistake::NormalsFlipped { which, share },
            _ => InputMistake::NormalsOff { which, share: 1.0 - share(self.fits) },
        })
    }
}

/// The result of a check.
#[derive(Debug, Clone, PartialEq)]
pub struct InputReport {
    /// The probable mistakes, none if the input is right.
    pub mistakes: Vec<InputMistake>,
    /// The counts of the G-buffer from which mistakes are judged.
    pub counts: InputCounts,
}

/// Whether WGSL encodes for a display: whether it has the exponent 1/2.2 or 1/2.4, however it is written.
pub(crate) fn encodes(source: &str) -> bool {
    let tokens: Vec<&str> = wgsl::tokens(source).into_iter().map(|(_, token)| token.trim_end_matches('f')).collect();
    let quotient = |t: &[&str]| matches!(t, ["1", "/", "2", ".", "2" | "4"]);
    let quotient_of_floats = |t: &[&str]| matches!(t, ["1", ".", "0", "/", "2", ".", "2" | "4"]);
    let number = |t: &[&str]| t[..2] == ["0", "."] && (t[2].starts_with("4545") || t[2].starts_with("41666"));
    tokens.windows(5).any(quotient) || tokens.windows(7).any(quotient_of_floats) || tokens.windows(3).any(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rasteriser clamps depth, so no rendered G-buffer can test this.
    #[test]
    fn depth_out_of_range_is_named() {
        let counts = InputCounts { bad_depth: 3, ..Default::default() };
        assert_eq!(counts.mistakes(100, 2), [InputMistake::DepthOutOfRange { samples: 3 }]);
    }

    /// A mistake needs more than half of the samples, and a least number of them.
    #[test]
    fn some_samples_that_do_not_fit_are_no_mistake() {
        let normal = NormalCounts { fits: 50, flipped: 50, ..Default::default() };
        let sound = InputCounts {
            covered: 1000,
            objects: 1,
            planes: 100,
            normal,
            geometric_normal: normal,
            slopes: 100,
            gradient_fits: 50,
            gradient_missing: 50,
            ..Default::default()
        };
        assert_eq!(sound.mistakes(1000, 2), []);
        let few = InputCounts { planes: ENOUGH - 1, slopes: ENOUGH - 1, gradient_fits: 0, ..sound };
        let few = InputCounts { normal: NormalCounts::default(), geometric_normal: NormalCounts::default(), ..few };
        assert_eq!(few.mistakes(1000, 2), []);
        assert_eq!(InputCounts::default().mistakes(0, 1), []);
    }

    #[test]
    fn only_an_encoding_exponent_encodes() {
        assert!(encodes("pow(c, vec3f(1.0 / 2.2))") && encodes("pow(c, vec3f(0.41666667))") && encodes("1/2.4"));
        assert!(!encodes("pow(c, vec3f(2.2)) // 1.0 / 2.2") && !encodes("11.0 / 2.25 + f32(x)"));
    }
}
