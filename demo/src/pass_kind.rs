//! What the node's passes are for.

use deferred_aa::PassKind;

/// What a frame's passes are for: to cast rays, to decide what is sampled, to shade, and the rest.
pub const PARTS: [&str; 4] = ["rays", "decisions", "shading", "rest"];

/// The part of [`PARTS`] that a pass belongs to, in the papers' tables.
pub fn part(kind: PassKind) -> &'static str {
    match kind {
        PassKind::Trace | PassKind::Reflect | PassKind::Classify | PassKind::Places => "rays",
        PassKind::Refine => "decisions",
        PassKind::Points | PassKind::First | PassKind::Shade | PassKind::Light => "shading",
        _ => "rest",
    }
}
