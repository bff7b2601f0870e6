//! The last step of every frame: it writes the image, or a debug view in its place.

use crate::gpu::binding::PassData;
use crate::host::needs::RayInputs;
use crate::passes::view;
use crate::settings::{DebugView, Settings};

/// The resources of a frame that can be shown.
pub(super) struct Shown {
    /// The pass of resolve for the resource that holds the image.
    pub image: &'static PassData,
    /// Whether the plan has a word for each pixel.
    pub planned: bool,
    /// Whether tiles were classified.
    pub classified: bool,
    pub inputs: RayInputs,
}

pub(super) fn image_or_view(settings: &Settings, shown: &Shown) -> &'static PassData {
    match settings.view {
        DebugView::Image => shown.image,
        DebugView::First => &view::FIRST,
        DebugView::Count | DebugView::Decided | DebugView::Quadrants | DebugView::Levels => {
            if shown.planned {
                &view::PLAN
            } else {
                &view::UNPLANNED
            }
        }
        DebugView::Surfaces => &view::SURFACES,
        DebugView::Tiles if shown.classified => &view::TILES,
        DebugView::Shadows if shown.inputs.shadows => &view::SHADOWS,
        DebugView::Rays if shown.inputs.any() => &view::RAYS,
        DebugView::Tiles | DebugView::Shadows | DebugView::Rays => &view::NOTHING,
        DebugView::Depth
        | DebugView::Normal
        | DebugView::GeometricNormal
        | DebugView::Tangent
        | DebugView::Uv
        | DebugView::Gradient
        | DebugView::Material
        | DebugView::Object
        | DebugView::User => &view::GBUFFER,
    }
}
