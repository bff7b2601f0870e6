//! Colours that always stand for the same thing, whatever else is shown.

use super::super::renderer::{Maker, Recipe};
use crate::peers::msaa::Samples;
use deferred_aa::{PassKind, Technique};
use egui::Color32;

/// The colour of a recipe's kind in the plot.
pub fn recipe_color(recipe: &Recipe) -> Color32 {
    let [r, g, b] = match (recipe.maker, recipe.settings.technique) {
        (Maker::Node, Technique::Full) => [225, 87, 89],
        (Maker::Node, Technique::Single) => [160, 122, 98],
        (Maker::Node, Technique::Windowed) => [78, 150, 222],
        (Maker::Node, Technique::Reconstructed) => [178, 124, 190],
        (Maker::Node, Technique::Selective) => [72, 172, 92],
        (Maker::Node, Technique::MultiResolution) => [240, 142, 44],
        (Maker::Node, Technique::Surfaces) => [208, 172, 30],
        (Maker::Fxaa, _) => [60, 180, 180],
        (Maker::Smaa, _) => [240, 130, 170],
        (Maker::Taa, _) => [110, 110, 230],
        (Maker::Msaa(Samples::Two), _) => [150, 150, 90],
        (Maker::Msaa(Samples::Four), _) => [130, 110, 60],
        (Maker::Msaa(Samples::Eight), _) => [100, 80, 40],
        (Maker::Reference, _) => [140, 140, 140],
    };
    Color32::from_rgb(r, g, b)
}

/// The colour of a kind of pass; the G-buffer has none of the node's kinds.
pub fn pass_color(kind: Option<PassKind>) -> Color32 {
    let [r, g, b] = match kind {
        None => [130, 140, 150],
        Some(PassKind::First) => [78, 150, 222],
        Some(PassKind::Shade) => [225, 87, 89],
        Some(PassKind::Quadrants) => [240, 120, 130],
        Some(PassKind::Points) => [120, 180, 240],
        Some(PassKind::Light) => [240, 160, 60],
        Some(PassKind::Metrics) => [178, 124, 190],
        Some(PassKind::MaxFilter) => [200, 160, 210],
        Some(PassKind::Select) => [150, 100, 170],
        Some(PassKind::Refine) => [170, 130, 220],
        Some(PassKind::Cover) => [208, 172, 30],
        Some(PassKind::Plan) => [210, 200, 90],
        Some(PassKind::List) => [90, 190, 190],
        Some(PassKind::Reconstruct) => [230, 130, 190],
        Some(PassKind::LatticeToPixels) => [140, 200, 160],
        Some(PassKind::Classify) => [160, 122, 98],
        Some(PassKind::Places) => [190, 150, 120],
        Some(PassKind::Trace) => [110, 110, 230],
        Some(PassKind::Reflect) => [60, 170, 210],
        Some(PassKind::Resolve) => [72, 172, 92],
        Some(PassKind::Host) => [60, 180, 180],
        Some(PassKind::Audit) => [200, 90, 160],
        Some(PassKind::View | PassKind::Depth) => [110, 170, 110],
        Some(_) => [170, 170, 170],
    };
    Color32::from_rgb(r, g, b)
}
