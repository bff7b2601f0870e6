//! Where the results of a frame's rays lie.

use crate::TILE;
use crate::gpu::uniforms::audited::Audited;
use crate::host::plan::{PlanWord, Slots};
use crate::settings::Settings;
use crate::techniques;

/// Where the results of the last frame's rays lie in [`Intermediates::shadows`](crate::Intermediates::shadows) and
/// [`Intermediates::reflections`](crate::Intermediates::reflections), in words: `daa_result_index` of
/// results_planned.wgsl.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traced {
    pub(crate) slots: Slots,
    pub(crate) settings: Settings,
    pub(crate) m: u32,
    pub(crate) ranks: u32,
    pub(crate) planned: usize,
    pub(crate) words: usize,
    /// The audited tiles, and their number in a row, if the frame audits and is no band.
    pub(crate) audited: Option<(Audited, u32)>,
}

impl Traced {
    /// The place of a sample's results. `None` if the sample has none of its own: it was neither planned nor audited,
    /// or there was no room ([`Settings::ray_samples`]). Audited samples of frames in bands are left out. `plan` is
    /// [`Intermediates::plan`](crate::Intermediates::plan); it is not read for techniques without a plan.
    pub fn place(&self, plan: &[PlanWord], x: u32, y: u32, rank: u32) -> Option<usize> {
        if rank < self.ranks {
            return Some(self.slots.sample(x, y, rank));
        }
        let slot = self.slots.pixel(x, y);
        let word = *plan.get(slot)?;
        let ranks = techniques::of(self.settings.technique).cast(&self.settings, self.m, word)?;
        let Some(in_window) = ranks.into_iter().position(|of| of == rank as usize) else {
            let (audited, in_row) = self.audited?;
            let tile = audited.place([x / TILE, y / TILE])?;
            let n = (self.m * self.m) as usize;
            let of_tile = (tile[1] * in_row + tile[0]) as usize * (TILE * TILE) as usize + slot % 64;
            return Some(self.ranks as usize * self.slots.count() + self.planned + of_tile * n + rank as usize);
        };
        // The numbers of samples before each tile lie behind the words of all slots.
        let before_tile = plan.get(self.slots.count() + slot / 64)?.0;
        let place = (before_tile + word.before()) as usize + in_window.checked_sub(1)?;
        (place < self.planned).then_some(self.ranks as usize * self.slots.count() + place)
    }

    /// The distance from a sample's results to the number of rays that it sent, in the buffer of shadows and in that of
    /// reflections, where they lie behind the six words of a pixel's hits. Only of frames that show
    /// [`DebugView::Rays`](crate::DebugView::Rays).
    pub fn counts(&self) -> [usize; 2] {
        [self.words, self.words + 6 * self.slots.count()]
    }

    /// The distance from a pixel's slot to the first of the six words of its hits, in the buffer of reflections. The
    /// others follow, each as many words further as there are slots. Only of frames of
    /// [`Technique::Selective`](crate::Technique::Selective).
    pub fn hits(&self) -> usize {
        self.words
    }
}
