//! What the passes do, for those who meet their names in the list of times.

use deferred_aa::PassKind;

/// What a pass does; the G-buffer has none of the node's kinds.
pub fn pass(kind: Option<PassKind>) -> &'static str {
    let Some(kind) = kind else { return "The host's own pass: draws the scene into the G-buffer." };
    match kind {
        PassKind::Classify => "Lists the tiles of 8 × 8 pixels in which rays are needed.",
        PassKind::Places => "Finds the places where the results of rays are kept.",
        PassKind::Trace => "Traces shadow rays.",
        PassKind::Reflect => "Traces mirrored and refracted rays.",
        PassKind::First => "Shades the first sample of every pixel.",
        PassKind::Metrics => "Computes from depth, normals and luminance how many samples of each pixel are shaded.",
        PassKind::MaxFilter => "Gives every pixel of a block the greatest number of samples in it.",
        PassKind::Plan => "Lays out the samples of each tile.",
        PassKind::Select => "Chooses the quadrants of pixels that are shaded.",
        PassKind::List => "Builds the list of the pixels or samples that are shaded.",
        PassKind::Shade => "Shades the samples beyond the first.",
        PassKind::Quadrants => "Shades the samples of the chosen quadrants.",
        PassKind::Reconstruct => "Gives samples that were not shaded the colours of nearby ones.",
        PassKind::Refine => "Chooses the points of a lattice that are shaded; the others are interpolated.",
        PassKind::Points => "Shades the chosen points of a lattice.",
        PassKind::LatticeToPixels => "Computes the pixels from the finest lattice.",
        PassKind::Cover => "Gathers the samples of each pixel into surfaces.",
        PassKind::Light => "Lights the surfaces of each pixel.",
        PassKind::Resolve => "Averages the samples and writes the image.",
        PassKind::View => "Writes a debug view in place of the image.",
        PassKind::Depth => "Writes depth at the image's size.",
        PassKind::Audit => "Shades all samples of some tiles, to measure the error that a goal holds.",
        PassKind::Host => "Anti-aliases the finished image; MSAA's draws and lights the scene, too.",
        _ => "A pass of the node.",
    }
}
