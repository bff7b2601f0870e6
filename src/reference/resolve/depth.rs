//! Twin of `shaders/passes/depth.wgsl`.

use crate::Depth;

/// The depth of a pixel from those of its window's samples; `first` is the index of the rank-0 sample.
pub fn depth(samples: &[f32], first: usize, choice: Depth) -> f32 {
    let numbers = samples.iter().copied().map(clean);
    match choice {
        Depth::Nearest => numbers.fold(0.0, f32::max),
        Depth::Farthest => numbers.fold(1.0, f32::min),
        Depth::First => clean(samples[first]),
    }
}

/// `daa_depth_bits`: a depth within 0 to 1, and 0 for NaN.
fn clean(depth: f32) -> f32 {
    if depth > 0.0 { depth.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_greater_and_nothing_but_numbers_gets_out() {
        let window = [0.25, f32::NAN, 0.5, 0.75];
        assert_eq!(depth(&window, 2, Depth::Nearest), 0.75);
        assert_eq!(depth(&window, 2, Depth::Farthest), 0.0);
        assert_eq!(depth(&window, 2, Depth::First), 0.5);
        let cleaned = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.5, -0.5, -0.0].map(clean);
        assert_eq!(cleaned.map(f32::to_bits), [0.0f32, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0].map(f32::to_bits));
    }
}
