//! What the passes hand to each other, for tools and tests.

use crate::host::plan::Slots;

/// What the passes hand to each other. All can be copied from.
#[derive(Debug, Clone, Copy)]
pub struct Intermediates<'a> {
    /// S, `Rgba32Float`, w×h.
    pub first: &'a wgpu::Texture,
    /// The means of windows with k > 1, `Rgba32Float`, w×h; other pixels are undefined.
    pub color: &'a wgpu::Texture,
    /// The plan: a [`PlanWord`](crate::PlanWord) for each pixel of each tile, in its [slot](Self::slots).
    pub plan: &'a wgpu::Buffer,
    /// Where in the plan, and in the buffers of what rays found, a pixel and its samples lie.
    pub slots: Slots,
    /// Slots of the plan by k, once [`Execution::Sorted`](crate::Execution::Sorted) or
    /// [`Execution::Bucketed`](crate::Execution::Bucketed) ran; see `reference::list`.
    pub pixel_list: Option<&'a wgpu::Buffer>,
    /// The samples beyond the first, once [`Execution::Packed`](crate::Execution::Packed) ran; see `reference::list`.
    pub sample_list: Option<&'a wgpu::Buffer>,
    /// The shadow bits of all samples, rank by rank in the order of the plan, once a frame traced; of those that were not
    /// traced what was there before. Behind them, once a frame showed [`DebugView::Rays`](crate::DebugView::Rays), how many rays
    /// each sample sent, likewise.
    pub shadows: Option<&'a wgpu::Buffer>,
    /// The tiles in which rays were wanted, once a frame traced: `DaaTileLists` of classify.wgsl, two classes of four words, of
    /// which the first counts, then the tiles of either, then a word for each tile, bit 0 with a surface, bit 1 with one that sends
    /// rays.
    pub tile_lists: Option<&'a wgpu::Buffer>,
    /// What they reflect and refract, likewise: codes of shared_exponent.wgsl, 0 where nothing was traced. Behind them, once
    /// [`Technique::Selective`](crate::Technique::Selective) ran, what the rays of first samples met: `daa_secondary_hit` of secondary.wgsl, word by word.
    /// From word 6 behind the codes, counted in ranks, once a frame showed [`DebugView::Rays`](crate::DebugView::Rays), the rays that each
    /// sample sent: mirrored ones, and refracted ones · 2¹⁶.
    pub secondary: Option<&'a wgpu::Buffer>,
    /// The words of the points of all lattices, once [`Technique::MultiResolution`](crate::Technique::MultiResolution) ran: `daa_point_word` of lattice.wgsl; see
    /// `reference::multi_resolution`. And the colours of those that are shaded.
    pub lattices: Option<[&'a wgpu::Buffer; 2]>,
}
