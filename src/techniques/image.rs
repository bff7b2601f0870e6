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
    /// Whether each pixel has a word of its surfaces.
    pub surfaces: bool,
    /// Whether tiles were classified.
    pub classified: bool,
    pub inputs: RayInputs,
}

pub(super) fn image_or_view(settings: &Settings, shown: &Shown) -> &'static PassData {
    match settings.view {
        DebugView::Image => shown.image,
        DebugView::First => &view::FIRST,
        DebugView::Count if shown.surfaces => &view::LIT,
        DebugView::Taps if shown.surfaces => &view::TAPS,
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
        DebugView::Tiles | DebugView::Shadows | DebugView::Rays | DebugView::Taps => &view::NOTHING,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::passes::resolve;

    /// Each view's number stands in one place of the shader that its pass runs: a case whose comment begins with the
    /// view's name, or an entry point of its own.
    #[test]
    fn each_view_is_shown_by_the_entry_point_that_has_its_number() {
        let mut cases = Vec::new();
        let mut function = "";
        for line in include_str!("../../shaders/passes/view.wgsl").lines() {
            if let Some(rest) = line.strip_prefix("fn ") {
                function = rest.split('(').next().unwrap_or_default();
            }
            if let Some((number, rest)) = line.trim().strip_prefix("case ").and_then(|l| l.split_once("u: {"))
                && let Some((_, comment)) = rest.split_once("// ")
            {
                let name = comment.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
                cases.push((number.parse::<u32>().expect("a number"), name.to_owned(), function));
            }
        }
        let views = DebugView::ALL.map(|view| (view as u32, format!("{view:?}")));
        assert!(views.iter().map(|v| v.0).eq(0..views.len() as u32), "ALL is in order");
        let inputs = RayInputs { shadows: true, reflections: true };
        let shown = Shown { image: &resolve::COLOR, planned: true, surfaces: true, classified: true, inputs };
        // The image itself is resolve's.
        for (view, (number, name)) in DebugView::ALL.into_iter().zip(views).skip(1) {
            let entry = image_or_view(&Settings { view, ..Settings::default() }, &shown).stages[0].entry;
            let own = format!("daa_view_{}", name.to_lowercase());
            let holder = if ["daa_view_plan", "daa_view_lit"].contains(&entry) { "daa_view_of_plan" } else { entry };
            let case = cases.iter().position(|case| *case == (number, name.clone(), holder));
            assert!(case.is_some() != (entry == own), "{name} is {number} in {entry}, or has its own");
            if let Some(case) = case {
                cases.swap_remove(case);
            }
        }
        assert_eq!(cases, [], "cases of no view");
    }
}
