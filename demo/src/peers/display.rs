//! The pass `display`: linear HDR as a screen shows it, which is what the peers look at.

use super::pass::{self, Fullscreen};

/// Of displayed values: sRGB-encoded, in a format that does not decode them.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

#[derive(Debug)]
pub struct Display(Fullscreen);

impl Display {
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = pass::texture_entry(0, false);
        Self(Fullscreen::new(device, "display", include_str!("display.wgsl"), &[texture], FORMAT))
    }

    pub fn record(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        image: &wgpu::TextureView,
        to: &wgpu::TextureView,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let image = wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(image) };
        let bind_group = self.0.bind(device, &[image]);
        self.0.record(encoder, &bind_group, to, timestamps);
    }
}

/// The linear radiance that is displayed as this 8-bit value: in the middle of what rounds to it, but for 255, which
/// begins where 254 ends and goes on to infinity.
pub fn radiance(shown: u8) -> f32 {
    let shown = if shown == 255 { 254.75 } else { f64::from(shown) } / 255.0;
    let linear = if shown <= 0.040_45 { shown / 12.92 } else { ((shown + 0.055) / 1.055).powf(2.4) };
    (linear / (1.0 - linear)) as f32
}

#[cfg(test)]
mod tests {
    use super::radiance;
    use crate::picture::Picture;

    #[test]
    fn every_displayed_value_comes_back() {
        let rgba = (0..=255).map(|v| [radiance(v), radiance(255 - v), radiance(v), 1.0]).collect();
        let picture = Picture::new(256, 1, rgba).unwrap();
        assert_eq!(picture.not_finite(), 0);
        let shown: Vec<_> = (0..=255).map(|v| [v, 255 - v, v]).collect();
        assert_eq!(picture.to_srgb8(), shown);
        assert_eq!(radiance(0), 0.0);
    }
}
