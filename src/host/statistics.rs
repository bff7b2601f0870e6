//! What a frame did: counted on the GPU.

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
            /// Names and counts, in the order of the fields.
            pub fn entries(&self) -> [(&'static str, u32); size_of::<Self>() / 4] {
                [$((stringify!($field), self.$field)),*]
            }

            /// The counts, in the order of the fields.
            pub fn values(&self) -> [u32; size_of::<Self>() / 4] {
                [$(self.$field),*]
            }

            /// All of them together.
            pub fn sum(&self) -> u64 {
                self.values().into_iter().map(u64::from).sum()
            }
        }
    };
}

counts! {
    /// Windows by what decided their k: [`DecidedBy`](crate::DecidedBy).
    DecidedCounts {
        /// Nothing asked for more than one sample.
        nothing,
        /// The depth metric.
        depth,
        /// The normal metric.
        normal,
        /// The luminance metric.
        luminance,
        /// The identity metric: two materials or objects.
        identity,
        /// The least k that the settings allow.
        least,
        /// The shadow metric: shadow bits that differ from a neighbour's.
        shadow,
    }
}

counts! {
    /// Quadrants by what their threshold is for: [`Attribute`](crate::Attribute).
    QuadrantCounts {
        /// Colour alone: nothing else disagrees.
        color,
        /// The object that pixels show.
        object,
        /// The normal that they show.
        normal,
        /// The shadow on what they show.
        shadow,
        /// The texture of what they show.
        texture,
        /// The object that they reflect or refract.
        secondary_object,
        /// The normal of what they reflect or refract.
        secondary_normal,
        /// The shadow on what they reflect or refract.
        secondary_shadow,
        /// The texture of what they reflect or refract.
        secondary_texture,
    }
}

counts! {
    /// Points by lattice: [`PlanWord::level`](crate::PlanWord::level).
    PointCounts {
        /// The lattice of the pixels.
        pixels,
        /// That with one point a pixel and shifted rows.
        shifted,
        /// That of every second pixel.
        half,
        /// That of every fourth pixel.
        quarter,
        /// That of every eighth pixel.
        eighth,
    }
}

/// What one frame did.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Statistics {
    /// Counted from 1 by [`record`](crate::DeferredAa::record).
    pub frame: u64,
    /// Technique of the recorded frame.
    pub technique: Technique,
    /// Samples that the host's code shaded, first samples included.
    pub shaded: u64,
    /// `shaded` over n · w · h.
    pub ratio: f64,
    /// `shaded` over w · h.
    pub mean_k: f64,
    /// Windows by k: `histogram_k[0]` had k = 1. As long as n. Those of [`Technique::MultiResolution`] that were interpolated are in
    /// none.
    pub histogram_k: Vec<u32>,
    /// Windows by what decided their k.
    pub decided: DecidedCounts,
    /// Active quadrants of [`Technique::Selective`] by what their threshold is for.
    pub quadrants: QuadrantCounts,
    /// Points of [`Technique::MultiResolution`] that were shaded, by lattice, those beyond the image's border included. Samples of
    /// refined windows come on top.
    pub points: PointCounts,
    /// Samples that came back from the host's code with NaN or infinity, and were shaded black.
    pub not_finite: u32,
    /// Samples that came back with a negative component, and were clamped to 0.
    pub negative: u32,
    /// Tiles that wanted more than [`tile_limit`](crate::Windowed::tile_limit) samples and fell back to k = 1.
    pub overflowed_tiles: u32,
    /// Rays towards lights. Modulo 2³².
    pub shadow_rays: u32,
    /// Mirrored rays.
    pub reflection_rays: u32,
    /// Refracted rays.
    pub refraction_rays: u32,
    /// Tiles of 8 × 8 pixels by what rays were dispatched for.
    pub tiles: TileCounts,
    /// How far the search for [`Settings::goal`](crate::Settings::goal) had come when this frame's counters arrived.
    pub goal: Option<GoalProgress>,
    /// The passes in order, with their GPU time in milliseconds where the device has timestamps.
    pub passes: Vec<PassTime>,
}

/// Tiles of a frame, by class. One may be of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TileCounts {
    /// Of the frame.
    pub all: u32,
    /// Where a sample has a surface: shadow rays are dispatched there. 0 if the frame traces nothing.
    pub surface: u32,
    /// Where a sample's material sends rays: mirrored and refracted ones are dispatched there.
    pub bounce: u32,
}

/// A pass and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PassTime {
    /// As in [`PassInfo::name`](crate::PassInfo::name).
    pub name: &'static str,
    /// What the pass does.
    pub kind: PassKind,
    /// `None` without [`wgpu::Features::TIMESTAMP_QUERY`].
    pub milliseconds: Option<f64>,
}
