//! Why a camera is not anti-aliased.

use thiserror::Error;

/// The reason why a camera's [`DeferredAa`](crate::DeferredAa) has no effect. Each says what to change.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DeferredAaError {
    /// The adapter or the device can't run the node.
    #[error("this adapter lacks {}; the camera is rendered without DeferredAa", .0.join(", "))]
    Adapter(Vec<String>),
    /// Another anti-aliasing moves the camera from frame to frame.
    #[error(
        "the camera has a TemporalJitter, as TAA and DLSS use it; remove that, or DeferredAa: samples would move with it"
    )]
    Jitter,
    /// The camera renders at another resolution than its target's.
    #[error("the camera has a MainPassResolutionOverride, as upscalers use it; remove that, or DeferredAa")]
    ResolutionOverride,
    /// Without the prepass Bevy draws no deferred mesh to the camera.
    #[error(
        "the camera has no DeferredPrepass, without which Bevy draws no deferred mesh; insert it, or remove DeferredAa"
    )]
    NoPrepass,
    /// Two-phase occlusion culling draws a mesh in one of two halves of the prepass.
    #[error("the camera has OcclusionCulling, whose second half can't be drawn again; remove that, or DeferredAa")]
    OcclusionCulling,
    /// Something shades with resources that Bevy keeps to itself.
    #[error("the camera's lighting reads {0}, which Bevy 0.20 keeps to itself; remove it, or DeferredAa")]
    Binding(&'static str),
    /// `m` or a setting is out of range, the size too large, or the device has no memory.
    #[error("{0}")]
    Node(String),
    /// Bevy's shaders do not compose, as when one was edited into an error.
    #[error("Bevy's lighting can't be composed: {0}")]
    Compose(String),
}
