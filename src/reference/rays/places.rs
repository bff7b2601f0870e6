//! Twin of `shaders/rays/places.wgsl`.

use crate::TILE;
use crate::host::plan::PlanWord;

/// The number of planned samples before each tile, and the number of those for which a room of `room` samples has no
/// place. `plan` has the words of all slots, tile by tile; first samples are not counted.
pub fn places(plan: &[PlanWord], room: usize) -> (Vec<usize>, usize) {
    let mut before = 0;
    let mut begins = Vec::new();
    for tile in plan.chunks((TILE * TILE) as usize) {
        begins.push(before);
        before += tile.iter().map(|word| word.k().saturating_sub(1) as usize).sum::<usize>();
    }
    (begins, before.saturating_sub(room))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_lie_end_to_end_and_the_last_find_no_room() {
        // The second tile has 64 · 2 samples beyond the first ones, the others have none.
        let plan: Vec<_> = (0..192).map(|slot| PlanWord(if slot / 64 == 1 { 3 } else { slot % 2 })).collect();
        assert_eq!(places(&plan, 128), (vec![0, 0, 128], 0));
        assert_eq!(places(&plan, 100), (vec![0, 0, 128], 28));
    }
}
