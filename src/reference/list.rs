//! Twin of `shaders/passes/list.wgsl`.

use super::plan::Planned;

/// The padding entry of a list of pixels.
pub const NO_ENTRY: u32 = u32::MAX;

/// The list of pixels: the indices into the plan with k > 1, from k = n down to 2, each k padded to whole workgroups of
/// 64.
pub fn pixels(plan: &[Planned], n: u32) -> Vec<u32> {
    let mut list = Vec::new();
    for k in (2..=n).rev() {
        let slots = plan.iter().zip(0..).filter(|(p, _)| p.k == k).map(|(_, slot)| slot);
        list.extend(slots);
        list.resize(list.len().next_multiple_of(64), NO_ENTRY);
    }
    list
}

/// The list of samples: slot · n + rank of every sample beyond the first, in the order of slots and ranks.
pub fn samples(plan: &[Planned], n: u32) -> Vec<u32> {
    plan.iter().zip(0..).flat_map(|(p, slot)| (1..p.k).map(move |rank| slot * n + rank)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_windows_come_first() {
        let plan: Vec<_> = [1, 2, 4, 0, 2].into_iter().map(|k| Planned { k, before: 0 }).collect();
        let list = pixels(&plan, 4);
        assert_eq!((list[0], list[1], list.len()), (2, NO_ENTRY, 128));
        assert_eq!(list[64..67], [1, 4, NO_ENTRY]);
        assert_eq!(samples(&plan, 4), [5, 9, 10, 11, 17]);
    }
}
