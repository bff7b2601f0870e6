//! The statistics of a frame, counted on the GPU.

use crate::goal::GoalProgress;
use crate::host::graph::PassKind;
use crate::settings::Technique;
use bytemuck::{Pod, Zeroable};

/// `DaaStatistics` of statistics.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Counters {
    pub histogram: [u32; 64],
    pub not_finite: u32,
    pub negative: u32,
    pub overflowed_tiles: u32,
    pub decided: DecidedCounts,
    pub shadow_rays: u32,
    pub reflection_rays: u32,
    pub refraction_rays: u32,
    pub tiles: [u32; 2],
    pub quadrants: QuadrantCounts,
    pub points: PointCounts,
    pub without_rays: u32,
    pub surfaces: SurfaceCounts,
}

pub(crate) const COUNTER_BYTES: u64 = size_of::<Counters>() as u64;

macro_rules! counts {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident),* $(,)? }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $name {
            $($(#[$field_doc])* pub $field: u32),*
        }

        impl $name {
            /// The names and counts, in the order of the fields.
            pub fn entries(&self) -> [(&'static str, u32); size_of::<Self>() / 4] {
                [$((stringify!($field), self.$field)),*]
            }

            /// The counts, in the order of the fields.
            pub fn values(&self) -> [u32; size_of::<Self>() / 4] {
                [$(self.$field),*]
            }

            /// The sum of all counts.
            pub fn sum(&self) -> u64 {
                self.values().into_iter().map(u64::from).sum()
            }
        }
    };
}

counts! {
    /// The number of windows for each reason for their k, [`DecidedBy`](crate::DecidedBy).
    DecidedCounts {
        /// No metric asked for more than one sample.
        nothing,
        /// The depth metric.
        depth,
        /// The normal metric.
        normal,
        /// The luminance metric.
        luminance,
        /// The identity metric: the window has more than one material or object.
        identity,
        /// The setting for the least k.
        least,
        /// The shadow metric: the shadow bits differ from those of a neighbour.
        shadow,
        /// The metric of the host's own bytes, `user`.
        user,
    }
}

counts! {
    /// The number of quadrants for each attribute whose threshold applies to them, [`Attribute`](crate::Attribute).
    QuadrantCounts {
        /// Colour: no other attribute disagrees.
        color,
        /// The object that the pixels show.
        object,
        /// The normal of the surface that the pixels show.
        normal,
        /// The shadows on the surface that the pixels show.
        shadow,
        /// The texture existence of the surface that the pixel shows.
        texture,
        /// The object that the pixels reflect or refract.
        reflected_object,
        /// The normal of the surface that the pixels reflect or refract.
        reflected_normal,
        /// The shadows on the surface that the pixels reflect or refract.
        reflected_shadow,
        /// The texture existence of the surface that the pixel reflects or refracts.
        reflected_texture,
    }
}

counts! {
    /// The number of points of each lattice, [`PlanWord::level`](crate::PlanWord::level).
    PointCounts {
        /// The lattice of the pixels.
        pixels,
        /// The lattice with one point a pixel and shifted rows.
        shifted,
        /// The lattice of every second pixel.
        half,
        /// The lattice of every fourth pixel.
        quarter,
        /// The lattice of every eighth pixel.
        eighth,
    }
}

counts! {
    /// What [`Technique::Surfaces`] has found in the windows, and read. What it lit is [`Statistics::shaded`].
    SurfaceCounts {
        /// The number of surfaces of all windows.
        surfaces,
        /// The number of taps: calls of the host's `material`, or of its whole hook.
        taps,
        /// The number of windows with more surfaces than are told apart
        /// ([`Surfaces::surfaces`](crate::Surfaces::surfaces)).
        merged,
        /// The number of surfaces that were not lit but took their light from the corners of a block
        /// ([`Surfaces::block_spread`](crate::Surfaces::block_spread)).
        interpolated,
    }
}

/// The statistics of one frame.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Statistics {
    /// The number of the frame; [`record`](crate::DeferredAa::record) counts from 1.
    pub frame: u64,
    /// The technique of the frame.
    pub technique: Technique,
    /// The number of bands of the frame. What follows is summed over them. The histograms of windows and quadrants are
    /// of the image, each window once; samples, points, rays, tiles and times are of all work, aprons included.
    pub bands: u32,
    /// The number of samples that the host's code shaded, first samples included. With [`Technique::Surfaces`]: the
    /// number of lights, each of which is for one or several taps.
    pub shaded: u64,
    /// The number of first samples among them that were shaded in the aprons of bands, for their neighbours. 0 without
    /// bands, and for techniques without first samples.
    pub apron: u64,
    /// The number of shaded samples over n · w · h.
    pub ratio: f64,
    /// The number of shaded samples over w · h.
    pub mean_k: f64,
    /// The number of windows for each k: `histogram_k[0]` for k = 1, up to k = n. Interpolated windows of
    /// [`Technique::MultiResolution`], and windows without a light of their own, are not counted.
    pub histogram_k: Vec<u32>,
    /// The number of windows for each reason for their k.
    pub decided: DecidedCounts,
    /// The number of active quadrants of [`Technique::Selective`] for each attribute whose threshold applies to them.
    pub quadrants: QuadrantCounts,
    /// The number of shaded points of [`Technique::MultiResolution`] on each lattice, including points outside the
    /// image's border. The samples of refined windows are not included.
    pub points: PointCounts,
    /// The surfaces and taps of [`Technique::Surfaces`].
    pub surfaces: SurfaceCounts,
    /// The number of samples for which the host's code returned NaN or infinity. They are shaded black.
    pub not_finite: u32,
    /// The number of samples for which the host's code returned a negative component. It is clamped to 0.
    pub negative: u32,
    /// The number of tiles that asked for more than [`tile_limit`](crate::Windowed::tile_limit) samples and fell back
    /// to k = 1.
    pub overflowed_tiles: u32,
    /// The number of planned samples for whose ray results there was no room
    /// ([`Settings::ray_samples`](crate::Settings::ray_samples)). They took those of their window's first sample.
    pub without_rays: u32,
    /// The number of shadow rays, modulo 2³².
    pub shadow_rays: u32,
    /// The number of reflected rays.
    pub reflection_rays: u32,
    /// The number of refracted rays.
    pub refraction_rays: u32,
    /// The number of tiles of 8 × 8 pixels by the kinds of rays that were dispatched for them.
    pub tiles: TileCounts,
    /// The progress of the search for [`Settings::goal`](crate::Settings::goal) when this frame's counters arrived.
    pub goal: Option<GoalProgress>,
    /// The passes in order, with their GPU times where the device has timestamps.
    pub passes: Vec<PassTime>,
}

/// The tiles of a frame. A tile may be counted as both `surface` and `reflect`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TileCounts {
    /// The number of all tiles of the frame, in each of its bands.
    pub all: u32,
    /// The number of tiles with a surface, for which shadow rays are dispatched. 0 if the frame traces nothing.
    pub surface: u32,
    /// The number of tiles with a material that sends rays, for which mirrored and refracted rays are dispatched.
    pub reflect: u32,
}

/// The GPU time of a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PassTime {
    /// The name of the pass, as in [`PassInfo::name`](crate::PassInfo::name).
    pub name: &'static str,
    /// The kind of the pass.
    pub kind: PassKind,
    /// The time in milliseconds, in all bands of the frame; `None` without [`wgpu::Features::TIMESTAMP_QUERY`], and for
    /// a frame of more than 64 bands.
    pub milliseconds: Option<f64>,
}
