//! The resources that the passes use between them, for tools and tests.

use crate::host::plan::Slots;
use crate::host::traced::Traced;

/// The resources that the passes use between them, of the last frame or, with bands, of its last band. All of them can
/// be copied from.
#[derive(Debug, Clone, Copy)]
pub struct Intermediates<'a> {
    /// S, the image of first samples: `Rgba32Float`, w×h.
    pub first: &'a wgpu::Texture,
    /// The means of windows with k > 1: `Rgba32Float`, w×h; other pixels are undefined.
    pub color: &'a wgpu::Texture,
    /// The plan: a [`PlanWord`](crate::PlanWord) for each pixel of each tile, in its [slot](Self::slots), then, in
    /// frames that trace rays of planned samples, for each tile the number of planned samples before its own.
    pub plan: &'a wgpu::Buffer,
    /// The places of pixels and samples in the plan, and in the buffers of what rays found.
    pub slots: Slots,
    /// The indices into the plan, sorted by k, once [`Execution::Sorted`](crate::Execution::Sorted) or
    /// [`Execution::Bucketed`](crate::Execution::Bucketed) has run; see `reference::list`.
    pub pixel_list: Option<&'a wgpu::Buffer>,
    /// The samples beyond the first, once [`Execution::Packed`](crate::Execution::Packed) has run; see
    /// `reference::list`.
    pub sample_list: Option<&'a wgpu::Buffer>,
    /// The places of the results of rays in the buffers below.
    pub traced: Traced,
    /// The shadow bits of samples, once a frame has traced. Samples that were not traced are undefined. The counts of
    /// rays that each sample sent follow in the same layout, in frames that show
    /// [`DebugView::Rays`](crate::DebugView::Rays).
    pub shadows: Option<&'a wgpu::Buffer>,
    /// The tiles in which rays are needed, once a frame has traced: `DaaTileLists` of classify.wgsl. It begins with two
    /// classes of four words each, of which the first is the number of tiles. The tiles of each class follow, then a
    /// word for each tile: bit 0 is set if the tile has a surface, bit 1 if it has a surface that sends rays.
    pub tile_lists: Option<&'a wgpu::Buffer>,
    /// The radiance that samples reflect and refract, in the same layout and under the same conditions as
    /// [`shadows`](Self::shadows): codes of shared_exponent.wgsl, 0 where nothing was traced. The hits of the rays of
    /// first samples follow, in frames of [`Technique::Selective`](crate::Technique::Selective): `daa_reflection_hit`
    /// of reflections.wgsl, word by word, 6 words a pixel. The rays that each sample sent follow those, or their room,
    /// in frames that show [`DebugView::Rays`](crate::DebugView::Rays): mirrored ones + refracted ones · 2¹⁶.
    pub reflections: Option<&'a wgpu::Buffer>,
    /// The words of the points of all lattices, and the colours of those that are shaded, once
    /// [`Technique::MultiResolution`](crate::Technique::MultiResolution) has run: `daa_point_word` of lattice.wgsl; see
    /// `reference::multi_resolution`.
    pub lattices: Option<[&'a wgpu::Buffer; 2]>,
    /// The surfaces of the windows, once [`Technique::Surfaces`](crate::Technique::Surfaces) has run: a
    /// [`SurfaceWord`](crate::SurfaceWord) for each [slot](Self::slots), then the labels of samples as three bits, each
    /// of which is a set of ranks: a word for each slot, or two words if m is above 5. Those of windows of one surface
    /// are undefined.
    pub surfaces: Option<&'a wgpu::Buffer>,
}
