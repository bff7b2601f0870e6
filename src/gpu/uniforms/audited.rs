//! Which tiles a frame audits.

use crate::TILE;

/// Most tiles of one frame.
pub(crate) const MAX_TILES: u32 = 4096;
/// Tiles of one frame that an error can be judged by, where the image has so many: fewer may all miss where it errs most.
const ENOUGH: u32 = 64;
pub(crate) const BYTES: u64 = MAX_TILES as u64 * 8;

/// Which tiles a frame audits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Audited {
    /// One in so many.
    pub period: u32,
    /// Below the period.
    pub phase: u32,
    /// How far below the frame's effort it looks ahead.
    pub step: f32,
}

impl Audited {
    /// The tiles of a frame: after `period` frames each tile has had its turn.
    pub fn of(frame: u64, size: [u32; 2]) -> Self {
        let tiles = size.map(|side| side.div_ceil(TILE)).iter().product::<u32>();
        let mut period = (tiles / ENOUGH).clamp(1, 32);
        while Self::of_period(period, size).iter().product::<u32>() > MAX_TILES {
            period *= 2;
        }
        Self { period, phase: (frame % u64::from(period)) as u32, step: 0.0 }
    }

    fn of_period(period: u32, size: [u32; 2]) -> [u32; 2] {
        let [x, y] = size.map(|side| side.div_ceil(TILE));
        [x.div_ceil(period), y]
    }

    /// Places for audited tiles along x and y.
    pub fn groups(self, size: [u32; 2]) -> [u32; 2] {
        Self::of_period(self.period, size)
    }

    /// Index of the audited tile, row by row, of each place of the audit's result.
    pub fn tiles(self, size: [u32; 2]) -> impl Iterator<Item = Option<usize>> {
        let tiles_x = size[0].div_ceil(TILE);
        let [groups_x, rows] = self.groups(size);
        (0..rows).flat_map(move |row| {
            let phase = (self.phase + 11 * (self.period - row % self.period)) % self.period;
            let columns = (0..groups_x).map(move |group| group * self.period + phase);
            columns.map(move |x| (x < tiles_x).then_some((row * tiles_x + x) as usize))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_has_its_turn_once() {
        for size in [[1, 1], [96, 54], [960, 540], [1027, 771], [7680, 4320]] {
            let period = u64::from(Audited::of(0, size).period);
            let mut turns = vec![0; size.map(|side| side.div_ceil(TILE)).iter().product::<u32>() as usize];
            for frame in 7..7 + period {
                let audited = Audited::of(frame, size);
                let tiles = audited.tiles(size).flatten().count();
                assert!(tiles >= turns.len().min(ENOUGH as usize / 2), "{size:?}: {tiles}");
                assert!(audited.tiles(size).count() <= MAX_TILES as usize);
                audited.tiles(size).flatten().for_each(|tile| turns[tile] += 1);
            }
            assert!(turns.iter().all(|&t| t == 1), "{size:?}");
        }
    }
}
