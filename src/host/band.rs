//! Rectangles of pixels, and the bands of a frame that is rendered part by part.

use glam::{Mat4, Vec4};

/// A rectangle of pixels. Rows are counted from the top.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Rect {
    /// The column of its first pixel.
    pub x: u32,
    /// The row of its first pixel.
    pub y: u32,
    /// The number of columns.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
}

impl Rect {
    /// The rectangle of this size that begins at the first pixel.
    pub(crate) fn of([width, height]: [u32; 2]) -> Self {
        Self { x: 0, y: 0, width, height }
    }

    /// Whether it lies in an area of this size.
    pub(crate) fn fits(self, [width, height]: [u32; 2]) -> bool {
        let ends_in = |at: u32, size: u32, end: u32| at.checked_add(size).is_some_and(|last| last <= end);
        ends_in(self.x, self.width, width) && ends_in(self.y, self.height, height)
    }
}

/// A part of the image that is rastered and recorded by itself, so that the G-buffer need not hold the whole image.
/// [`resize_banded`](crate::DeferredAa::resize_banded) returns the bands of an image; all of them together give each
/// pixel once, bit for bit as a single frame would, as long as there is room for the results of all rays
/// ([`Settings::ray_samples`](crate::Settings::ray_samples)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Band {
    /// The number of the band, from 0. Bands are recorded in this order.
    pub index: u32,
    /// The number of bands of the image.
    pub count: u32,
    /// The size of the image in pixels.
    pub image: [u32; 2],
    /// The pixels of the image that recording the band writes.
    pub output: Rect,
    /// The pixels of the image that the host rasters, with m × m samples each: `output` and an apron for its
    /// neighbours. All bands of an image have the same size here, which is that of the G-buffer.
    pub raster: Rect,
}

impl Band {
    /// The transform from the clip space of the image to that of the band: `band.crop() * clip_from_view` is the
    /// projection to raster the band with. [`Frame::camera`](crate::Frame::camera) keeps the projection of the image.
    ///
    /// A rasteriser rounds the corners of triangles to a fraction of a sample after this transform, so a few samples at
    /// edges may differ from those of an uncropped raster. [`viewport`](Self::viewport) avoids that where it can be
    /// used.
    pub fn crop(&self) -> Mat4 {
        let Rect { x, y, width, height } = self.raster;
        let [full_width, full_height] = self.image.map(f64::from);
        let [width, height] = [width, height].map(f64::from);
        let scale = [full_width / width, full_height / height];
        let shift =
            [(full_width - 2.0 * f64::from(x)) / width - 1.0, 1.0 - (full_height - 2.0 * f64::from(y)) / height];
        Mat4::from_cols(
            Vec4::new(scale[0] as f32, 0.0, 0.0, 0.0),
            Vec4::new(0.0, scale[1] as f32, 0.0, 0.0),
            Vec4::Z,
            Vec4::new(shift[0] as f32, shift[1] as f32, 0.0, 1.0),
        )
    }

    /// The viewport of the whole image over the band's G-buffer, in samples: x, y, width and height for
    /// [`RenderPass::set_viewport`](wgpu::RenderPass::set_viewport). With it the host rasters with the projection of
    /// the image and needs no [`crop`](Self::crop). `None` if the device's `max_texture_dimension_2d` does not allow
    /// it, because the image is larger.
    pub fn viewport(&self, m: u32, limits: &wgpu::Limits) -> Option<[f32; 4]> {
        let most = limits.max_texture_dimension_2d;
        let [width, height] = self.image.map(|side| side.saturating_mul(m));
        let at = [self.raster.x, self.raster.y].map(|place| place.saturating_mul(m));
        let allowed = width <= most && height <= most;
        allowed.then(|| [-(at[0] as f32), -(at[1] as f32), width as f32, height as f32])
    }
}
