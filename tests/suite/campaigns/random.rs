//! Random numbers of a seed, the same on every machine.

use deferred_aa::glam::{Quat, Vec3, vec3};

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u32) -> Self {
        Self(u64::from(seed).wrapping_mul(0xd134_2543_de82_ef95))
    }

    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 32) as u32
    }

    /// From 0 to below 1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    pub fn within(&mut self, least: f32, most: f32) -> f32 {
        (least + (most - least) * self.unit()).clamp(least, most)
    }

    /// Of any magnitude between two numbers above 0.
    pub fn magnitude(&mut self, least: f32, most: f32) -> f32 {
        self.within(least.ln(), most.ln()).exp().clamp(least, most)
    }

    /// From 0 to below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }

    /// True once in `n` times.
    pub fn once_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }

    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len() as u32) as usize]
    }

    /// In a cube from −1 to 1.
    pub fn vector(&mut self) -> Vec3 {
        vec3(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0))
    }

    pub fn rotation(&mut self) -> Quat {
        let axis = self.vector().try_normalize().unwrap_or(Vec3::X);
        Quat::from_axis_angle(axis, self.within(0.0, 6.3))
    }
}
