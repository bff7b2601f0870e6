//! Where the results of a frame's rays lie.

use crate::host::plan::{PlanWord, Slots};
use crate::settings::Settings;
use crate::techniques;

/// Where the results of the last frame's rays lie in [`Intermediates::shadows`](crate::Intermediates::shadows) and
/// [`Intermediates::reflections`](crate::Intermediates::reflections), in words: `daa_result_index` of
/// results_planned.wgsl. Those of audited tiles are left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traced {
    pub(crate) slots: Slots,
    pub(crate) settings: Settings,
    pub(crate) m: u32,
    pub(crate) ranks: u32,
    pub(crate) planned: usize,
    pub(crate) words: usize,
}

impl Traced {
    /// The place of a sample's results. `None` if the sample has none of its own: it was not planned, or there was no
    /// room ([`Settings::ray_samples`]). `plan` is [`Intermediates::plan`](crate::Intermediates::plan); it is not read
    /// for techniques without a plan.
    pub fn place(&self, plan: &[PlanWord], x: u32, y: u32, rank: u32) -> Option<usize> {
        if rank < self.ranks {
            return Some(self.slots.sample(x, y, rank));
        }
        let slot = self.slots.pixel(x, y);
        let word = *plan.get(slot)?;
        let ranks = techniques::of(self.settings.technique).shaded(&self.settings, self.m, word)?;
        let in_window = ranks.into_iter().position(|of| of == rank as usize)?.checked_sub(1)?;
        // The numbers of samples before each tile lie behind the words of all slots.
        let before_tile = plan.get(self.slots.count() + slot / 64)?.0;
        let place = (before_tile + word.before()) as usize + in_window;
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
