//! The input of one frame.

use crate::host::band::{Band, Rect};
use crate::host::error::RecordError;
use crate::host::needs::Needs;
use crate::host::table::TextureTable;
use crate::settings::Settings;
use glam::{DMat4, DVec4, Mat4, Vec3};

/// The camera that a frame is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The transform from view space to world space: a rotation and a translation, without scale. View space looks
    /// along −z, with y up.
    pub world_from_view: Mat4,
    /// The projection that the G-buffer was rendered with, with reversed z: depth is 1 at the near plane and 0 at the
    /// far plane or at infinity.
    pub clip_from_view: Mat4,
}

/// A frame to record.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// The camera that the G-buffer was rendered with.
    pub camera: Camera,
    /// The settings, which may change from frame to frame.
    pub settings: Settings,
    /// A finite factor above 0 on radiance, for the metrics and the luminance weight; the image is written unexposed.
    /// Choose it so that radiance × exposure is about 1 in the bright parts of a picture.
    pub exposure: f32,
    /// The host's bind group, set at [`HOST_GROUP`](crate::HOST_GROUP) in the passes that run its WGSL. Required if
    /// [`new`](crate::DeferredAa::new) was given a layout.
    pub host_bind_group: Option<&'a wgpu::BindGroup>,
    /// The host's second bind group, set at [`SECOND_HOST_GROUP`](crate::SECOND_HOST_GROUP). Required if
    /// [`with_groups`](crate::DeferredAa::with_groups) was given a second layout.
    pub second_bind_group: Option<&'a wgpu::BindGroup>,
    /// The dynamic offsets of the host's bind group and of its second one, as many as their layouts have.
    pub host_offsets: [&'a [u32]; 2],
    /// The textures that `daa_texture` reads. Required if the descriptor has a texture tier.
    pub textures: Option<&'a TextureTable>,
    /// The view that the image is written to. It has the size of the node, or holds the [`viewport`](Self::viewport),
    /// the format of the descriptor and the usage `RENDER_ATTACHMENT`. The format of its texture may differ in sRGB,
    /// since a view may have another format than its texture and wgpu does not tell which.
    pub target: &'a wgpu::TextureView,
    /// The view of the host's texture that depth is written to; required if [`Needs::depth`] asks for it, else `None`.
    /// Its format is [`DEPTH_FORMAT`](crate::gbuffer::DEPTH_FORMAT), its usage `RENDER_ATTACHMENT`, and its size that
    /// of the target. The same pixels as of the target are written, and what lies around them is kept, so that a render
    /// pass may then have both as attachments. Depth is reversed: 1 is near, 0 is far and the sky.
    pub depth: Option<&'a wgpu::TextureView>,
    /// The rectangle of the target that the image is written to, of the size of the node; the view shows the texture's
    /// largest mip level. What lies around it is kept. `None`: the target has the size of the node.
    pub viewport: Option<Rect>,
    /// The band of the image that the G-buffer holds, after [`resize_banded`](crate::DeferredAa::resize_banded).
    /// `None`: the G-buffer holds the whole image.
    pub band: Option<Band>,
    /// What the scene needs besides shading; `Needs::default()` for nothing.
    pub needs: Needs<'a>,
    /// Whether to collect [`Statistics`](crate::Statistics) of this frame. Costs a copy of a few hundred bytes, and
    /// timestamps where the device has them.
    pub statistics: bool,
}

impl<'a> Frame<'a> {
    /// A frame with the default settings, exposure 1, and no host bind groups, textures, depth, needs or statistics.
    pub fn new(camera: Camera, target: &'a wgpu::TextureView) -> Self {
        Self {
            camera,
            settings: Settings::default(),
            exposure: 1.0,
            host_bind_group: None,
            second_bind_group: None,
            host_offsets: [&[]; 2],
            textures: None,
            target,
            depth: None,
            viewport: None,
            band: None,
            needs: Needs::default(),
            statistics: false,
        }
    }
}

impl Camera {
    /// The greatest distance to a corner of the near plane. Up to it, the least depth that is no sky still has a
    /// position in f32.
    const FARTHEST_NEAR: f32 = 1e8;

    /// Whether depth falls with distance. The camera must be invertible.
    pub(crate) fn is_reversed(&self) -> bool {
        let depth = |distance: f64| {
            let clip = self.clip_from_view.as_dmat4() * DVec4::new(0.0, 0.0, -distance, 1.0);
            clip.z / clip.w
        };
        depth(1.0) > depth(2.0)
    }

    /// Whether all points have the same w, whatever that is.
    pub(crate) fn is_orthographic(&self) -> bool {
        self.clip_from_view.row(3).truncate() == Vec3::ZERO
    }

    /// The width of a sample at distance 1 of a perspective camera, and anywhere of an orthographic one. `samples` is the
    /// size of the image in samples.
    pub(crate) fn sample_width(&self, samples: [u32; 2]) -> f64 {
        let view_from_clip = self.clip_from_view.as_dmat4().inverse();
        let near = |x: f64, y: f64| {
            let p = view_from_clip * DVec4::new(x, y, 1.0, 1.0);
            p.truncate() / p.w
        };
        let centre = near(0.0, 0.0);
        let [x, y] = samples.map(|side| 2.0 / f64::from(side));
        let width = (near(x, 0.0) - centre).length().max((near(0.0, y) - centre).length());
        if self.is_orthographic() { width } else { width / centre.z.abs() }
    }

    /// The transform from clip space to positions relative to the camera, the camera's position, and its view
    /// direction. The projection is inverted in f64, since an infinite one with a small near plane is close to singular
    /// in f32.
    pub(crate) fn relative(&self) -> Result<(Mat4, Vec3, Vec3), RecordError> {
        let clip_from_view = self.clip_from_view.as_dmat4();
        let view_from_clip = clip_from_view.inverse();
        let sound = |m: &DMat4| m.is_finite() && m.determinant() != 0.0;
        if !sound(&clip_from_view) || !sound(&view_from_clip) {
            return Err(RecordError::Camera("projection"));
        }
        let world_from_view = self.world_from_view.as_dmat4();
        if !sound(&world_from_view) {
            return Err(RecordError::Camera("view"));
        }
        let mut rotation = world_from_view;
        rotation.w_axis = DVec4::W;
        let relative_from_clip = (rotation * view_from_clip).as_mat4();
        let forward = -world_from_view.z_axis.truncate().normalize().as_vec3();
        if !relative_from_clip.is_finite() {
            return Err(RecordError::Camera("projection"));
        }
        let ahead = clip_from_view * DVec4::new(0.0, 0.0, -1.0, if self.is_orthographic() { 1.0 } else { 0.0 });
        if ahead.w <= 0.0 {
            return Err(RecordError::Handedness);
        }
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            let corner = view_from_clip * DVec4::new(x, y, 1.0, 1.0);
            let distance = (corner.truncate() / corner.w).length();
            // NaN is refused with the rest.
            if distance.is_nan() || distance > f64::from(Self::FARTHEST_NEAR) {
                return Err(RecordError::NearPlane(distance as f32));
            }
        }
        Ok((relative_from_clip, self.world_from_view.w_axis.truncate(), forward))
    }
}
