//! The tiles that a frame audits.

use crate::TILE;
use crate::gpu::bands::MOST_SAMPLES;

/// The most audited tiles of a frame. Each row of tiles has one, and the tallest image has so many rows.
pub(crate) const MAX_TILES: u32 = (MOST_SAMPLES + 1) / TILE;
/// The number of audited tiles of a frame from which an error can be judged, if the image has so many. Fewer might all
/// miss the places with the greatest error.
const ENOUGH: u32 = 64;
pub(crate) const BYTES: u64 = MAX_TILES as u64 * 8;

/// The tiles that a frame audits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Audited {
    /// The number of tiles of which one is audited.
    pub period: u32,
    /// The index of the audited tile within a period.
    pub phase: u32,
    /// The step below the frame's effort at which the error is also measured.
    pub step: f32,
}

impl Audited {
    /// The audited tiles of a frame. After `period` frames each tile has been audited once.
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

    /// The number of audited tiles along x and y.
    pub fn groups(self, size: [u32; 2]) -> [u32; 2] {
        Self::of_period(self.period, size)
    }

    /// The column and row of a tile among the audited ones, `None` if it is not audited.
    pub fn place(self, [x, y]: [u32; 2]) -> Option<[u32; 2]> {
        (x % self.period == self.phase_of(y)).then_some([x / self.period, y])
    }

    /// The index of the audited tile within the periods of a row.
    fn phase_of(self, row: u32) -> u32 {
        (self.phase + 11 * (self.period - row % self.period)) % self.period
    }

    /// The index of the tile, row by row, for each entry of the audit's result.
    pub fn tiles(self, size: [u32; 2]) -> impl Iterator<Item = Option<usize>> {
        let tiles_x = size[0].div_ceil(TILE);
        let [groups_x, rows] = self.groups(size);
        (0..rows).flat_map(move |row| {
            let phase = self.phase_of(row);
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
        for size in [[1, 1], [96, 54], [960, 540], [1027, 771], [7680, 4320], [9, MOST_SAMPLES], [MOST_SAMPLES, 9]] {
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
