//! How radiance becomes what the screen shows. It changes what is seen, not what is rendered or measured.

use crate::picture::{NOT_FINITE, display};

/// What is shown of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channel {
    /// All of it.
    #[default]
    Rgb,
    /// Red, as grey.
    Red,
    /// Green, as grey.
    Green,
    /// Blue, as grey.
    Blue,
    /// The luminance, as grey.
    Luminance,
}

impl Channel {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Rgb, Self::Red, Self::Green, Self::Blue, Self::Luminance];

    /// The name on the screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rgb => "RGB",
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
            Self::Luminance => "luminance",
        }
    }
}

/// How radiance becomes what the screen shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Stops by which radiance is brighter.
    pub exposure: f32,
    /// What is shown of a colour.
    pub channel: Channel,
    /// The displayed values, 0 to 1, that are shown black and white.
    pub range: [f32; 2],
}

impl Default for Tone {
    fn default() -> Self {
        Self { exposure: 0.0, channel: Channel::Rgb, range: [0.0, 1.0] }
    }
}

impl Tone {
    /// What the screen shows of radiance.
    pub fn shown(&self, [r, g, b, _]: [f32; 4]) -> [u8; 3] {
        if ![r, g, b].iter().all(|v| v.is_finite()) {
            return NOT_FINITE;
        }
        let scale = self.exposure.exp2();
        let rgb = [r, g, b].map(|v| v * scale);
        let rgb = match self.channel {
            Channel::Rgb => rgb,
            Channel::Red => [rgb[0]; 3],
            Channel::Green => [rgb[1]; 3],
            Channel::Blue => [rgb[2]; 3],
            // Rec. 709.
            Channel::Luminance => [0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; 3],
        };
        let [black, white] = self.range;
        let span = (white - black).max(1e-6);
        display(rgb).map(|v| (((v - black) / span).clamp(0.0, 1.0) * 255.0).round() as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;

    #[test]
    fn by_default_it_is_the_display_transform() {
        let rgba: Vec<_> = (0..64).map(|i| [i as f32 * 0.1, i as f32 * i as f32, 1.0 / (i + 1) as f32, 1.0]).collect();
        let shown: Vec<_> = rgba.iter().map(|&c| Tone::default().shown(c)).collect();
        assert_eq!(shown, Picture::new(64, 1, rgba).unwrap().to_srgb8());
        assert_eq!(Tone::default().shown([f32::NAN, 0.0, 0.0, 1.0]), NOT_FINITE);
    }

    #[test]
    fn exposure_channel_and_range() {
        let tone = Tone { exposure: 1.0, ..Tone::default() };
        assert_eq!(tone.shown([0.5; 4]), Tone::default().shown([1.0; 4]));
        let red = Tone { channel: Channel::Red, ..Tone::default() };
        assert_eq!(red.shown([0.3, 0.9, 0.1, 1.0]), Tone::default().shown([0.3; 4]));
        let narrow = Tone { range: [0.2, 0.4], ..Tone::default() };
        assert_eq!((narrow.shown([0.0; 4]), narrow.shown([9.0; 4])), ([0; 3], [255; 3]));
    }
}
