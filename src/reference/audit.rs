//! Twin of `shaders/passes/audit.wgsl`.

/// The displayed colour of the audit: x/(1+x) of exposed radiance, then the transfer function of sRGB.
pub fn display(c: [f64; 4], exposure: f64) -> [f64; 3] {
    [c[0], c[1], c[2]].map(|c| {
        let exposed = (c * exposure).clamp(0.0, 1e30);
        let x = exposed / (1.0 + exposed);
        if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
    })
}

/// The squared displayed error of a pixel against the mean of all its samples, averaged over RGB.
pub fn squared_error(shown: [f64; 4], all: [f64; 4], exposure: f64) -> f64 {
    let (shown, all) = (display(shown, exposure), display(all, exposure));
    shown.iter().zip(all).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        assert_eq!(display([0.0, -1.0, 0.0, 1.0], 1.0), [0.0; 3]);
        // 1/(1+1) = ½ is 0.7354 in sRGB.
        assert!((display([0.5, 0.0, 0.0, 1.0], 2.0)[0] - 0.735_357).abs() < 1e-6);
        assert!((display([1e38, 0.0, 0.0, 1.0], 1.0)[0] - 1.0).abs() < 1e-9);
        let error = squared_error([1.0, 1.0, 1.0, 1.0], [0.0, 1.0, 1.0, 1.0], 1.0);
        assert!((error - 0.735_357_f64.powi(2) / 3.0).abs() < 1e-6);
    }
}
