//! Twin of the blocks in `shaders/surfaces/light.wgsl`: light that surfaces take from the corners of 4 × 4 windows.

use super::light::{Decided, HALF, Light, Material, Spread, TINT_WEIGHT};
use crate::settings::Surfaces;
use glam::DVec3;

/// What is known of a window at a corner of a block, or of a surface that may take its light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Of a corner; black for others.
    pub light: Light,
    /// The means of the features of its taps.
    pub spread: Spread,
    /// Position relative to the camera: of a corner that of its first sample, of others that of their last tap.
    pub position: DVec3,
    /// Unit interpolated normal of the last tap.
    pub normal: DVec3,
    /// material | object << 16.
    pub identity: u32,
    /// The shadow bits.
    pub shadow: u32,
}

/// The corners of a window's block: `None` where the window there lends no light.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// The place of the window, 0 to 3 along x and y.
    pub place: [u32; 2],
    /// In the order (0, 0), (3, 0), (0, 3), (3, 3).
    pub corners: &'a [Option<Corner>; 4],
    /// View direction of the camera.
    pub forward: DVec3,
}

impl Block<'_> {
    /// Whether the window is a corner itself.
    pub fn is_corner(&self) -> bool {
        self.place.iter().all(|p| *p == 0 || *p == 3)
    }

    /// The light of a surface of those colours, if it need not be lit.
    pub(super) fn between(
        &self,
        here: &Corner,
        colors: &Material,
        exposure: f64,
        settings: &Surfaces,
        decided: &mut Decided,
    ) -> Option<Light> {
        let along = self.place.map(|p| f64::from(p) / 3.0);
        let (mut share, mut least, mut most) = (0.0, f64::INFINITY, 0.0_f64);
        let mut light = Light::default();
        let mut spread = Spread { shape: [0.0; 4], tint: [0.0; 4] };
        for (i, corner) in self.corners.iter().enumerate() {
            let weight: f64 =
                (0..2).map(|axis| if i >> axis & 1 == 1 { along[axis] } else { 1.0 - along[axis] }).product();
            let Some(corner) = corner.filter(|_| weight > 0.0) else { continue };
            if corner.identity != here.identity || corner.shadow != here.shadow {
                continue;
            }
            let distance = here.position.dot(self.forward).abs();
            let off = here.normal.dot(corner.position - here.position).abs() / distance;
            // Normals of corners are kept in 16 bits a component.
            let far = decided.above_within(off, f64::from(settings.plane), 1e-5);
            let bent = !decided.above_within(here.normal.dot(corner.normal), settings.normal_cosine.into(), 1e-4);
            if far || bent {
                continue;
            }
            share += weight;
            light.add(&corner.light, weight);
            spread.add(&corner.spread, weight);
            let luminance = corner.light.luminance(colors, exposure);
            least = least.min(luminance / (1.0 + luminance));
            most = most.max(luminance / (1.0 + luminance));
        }
        if share == 0.0 || decided.above_within(most - least, settings.block_contrast.into(), 1e-5) {
            return None;
        }
        let (mut apart, mut rounding) = (0.0, 0.0);
        let weights = [1.0, TINT_WEIGHT];
        let pairs = [(spread.shape, here.spread.shape), (spread.tint, here.spread.tint)];
        for ((of_corners, own), weight) in pairs.into_iter().zip(weights) {
            for (a, b) in of_corners.into_iter().zip(own) {
                let difference = a / share - b;
                apart += weight * difference * difference;
                rounding += weight * 2.0 * difference.abs() * HALF * (a / share).abs() + 1e-9;
            }
        }
        if decided.above_within(apart, settings.block_spread.into(), rounding) {
            return None;
        }
        light.scale(1.0 / share);
        Some(light)
    }
}
