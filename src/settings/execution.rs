//! How the GPU runs the samples that a technique chose.

/// How the GPU runs the samples that a technique chose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Execution {
    /// Each pixel shades its own samples in a loop (Holländer et al. 2013, section 4.2). Lanes wait for the pixel with
    /// the most samples.
    Loop,
    /// A workgroup shades the samples of an 8 × 8 tile end to end, with every lane busy. Builds no list, so it needs no
    /// memory for one. Lanes sum up parts of a window, so that its colour may be rounded otherwise than by the others.
    Tiled,
    /// One dispatch for each k, over the pixels that have it, like the stencil variant of Holländer et al., which draws
    /// one quad for each k.
    Bucketed,
    /// One dispatch over the pixels sorted by k, so that the lanes of a workgroup take equally long (section 4.2, after
    /// Hoberock et al. 2009). The default: in our measurements no other execution was faster by more than noise,
    /// whatever the cost of shading.
    #[default]
    Sorted,
    /// Like [`Loop`](Self::Loop), after every pixel took the greatest k of its block of 6 × 6 pixels (section 4.2). It
    /// shades more samples, never fewer, so the image differs from the others'.
    MaxFiltered,
    /// One packed list of the frame's samples, one sample per lane (Jin et al. 2009). Needs 20 bytes for each sample
    /// that could be shaded; where that is too much, recording fails with
    /// [`RecordError::List`](crate::RecordError::List).
    Packed,
}

impl Execution {
    /// All executions, in order.
    pub const ALL: [Self; 6] = [Self::Loop, Self::Tiled, Self::Bucketed, Self::Sorted, Self::MaxFiltered, Self::Packed];
}
