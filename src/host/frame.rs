//! What one frame gets from the host.

use crate::host::error::RecordError;
use crate::host::needs::Needs;
use crate::host::table::TextureTable;
use crate::settings::Settings;
use glam::{DMat4, DVec4, Mat4, Vec3};

/// Where the scene is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World from view: rotation and translation, no scale. View space looks along −z, y up.
    pub world_from_view: Mat4,
    /// The projection that the G-buffer was rendered with, reversed z: 1 at the near plane, 0 at the far plane or at
    /// infinity.
    pub clip_from_view: Mat4,
}

/// One frame to record.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// The camera that the G-buffer was rendered with.
    pub camera: Camera,
    /// How to sample. May differ from frame to frame.
    pub settings: Settings,
    /// Radiance × exposure is what the luminance metric and the luminance weight see; what is written to the target stays
    /// unexposed. Above 0; 1 if the host's radiance is about 1 where a picture is bright.
    pub exposure: f32,
    /// The host's bind group, set at [`HOST_GROUP`](crate::HOST_GROUP) wherever its WGSL runs. Needed if
    /// [`new`](crate::DeferredAa::new) was given a layout.
    pub host_bind_group: Option<&'a wgpu::BindGroup>,
    /// The textures that `daa_texture` reads. Needed if the descriptor has a texture tier.
    pub textures: Option<&'a TextureTable>,
    /// The image goes here: the size of the node, the format of the descriptor, usage `RENDER_ATTACHMENT`. A texture that
    /// differs in sRGB alone is let through, since its view may have the right format and wgpu can't be asked.
    pub target: &'a wgpu::TextureView,
    /// What the scene calls for; `Needs::default()` if nothing but shading.
    pub needs: Needs<'a>,
    /// Collect [`Statistics`](crate::Statistics) of this frame: a copy of a few hundred bytes, and timestamps where the
    /// device has them.
    pub statistics: bool,
}

impl<'a> Frame<'a> {
    /// A frame with the default settings, exposure 1, no group of the host's, no textures, no needs and no statistics.
    pub fn new(camera: Camera, target: &'a wgpu::TextureView) -> Self {
        Self {
            camera,
            settings: Settings::default(),
            exposure: 1.0,
            host_bind_group: None,
            textures: None,
            target,
            needs: Needs::default(),
            statistics: false,
        }
    }
}

impl Camera {
    /// Whether depth falls with the distance. Of a sound camera.
    pub(crate) fn is_reversed(&self) -> bool {
        let depth = |distance: f64| {
            let clip = self.clip_from_view.as_dmat4() * DVec4::new(0.0, 0.0, -distance, 1.0);
            clip.z / clip.w
        };
        depth(1.0) > depth(2.0)
    }

    pub(crate) fn is_orthographic(&self) -> bool {
        self.clip_from_view.row(3) == glam::Vec4::W
    }

    /// Camera-relative position from clip space, the eye and the view direction. Inverted in f64: an infinite projection
    /// with a small near plane is close to singular in f32.
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
        Ok((relative_from_clip, self.world_from_view.w_axis.truncate(), forward))
    }
}
