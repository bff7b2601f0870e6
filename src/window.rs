//! The order in which a window's samples are shaded.

/// The most samples along one side of a window.
pub const MAX_M: u32 = 8;

/// The places of a window's samples in the order in which they are shaded: `order(m)[rank] = (x, y)`, y down.
///
/// For m = 2, 3 and 4 these are the index matrices of Holländer et al. 2013, Figure 3, as printed. Those for m = 6 and
/// 8 follow from 3 and 4 by Bayer's recursion (1973) with the printed 2 × 2 matrix. No recursion reaches m = 5 and 7:
/// their order starts in the centre and continues with the place that is furthest from all places before, where the
/// window is repeated in all directions. Of several such places it takes the one furthest from the previous place, then
/// the first in reading order.
///
/// # Panics
/// Panics if m is not in 1..=8.
pub fn order(m: u32) -> Vec<(u8, u8)> {
    let ranks: Vec<u8> = match m {
        1 => vec![0],
        2 => vec![0, 2, 3, 1],
        3 => vec![2, 6, 3, 5, 0, 8, 1, 7, 4],
        4 => vec![1, 8, 2, 10, 12, 4, 14, 6, 3, 11, 0, 9, 15, 7, 13, 5],
        6 | 8 => return doubled(&order(m / 2), m / 2),
        5 | 7 => return furthest_first(m),
        _ => panic!("m is {m}, a window has 1 to {MAX_M} samples a side"),
    };
    let mut places = vec![(0, 0); ranks.len()];
    for (place, &rank) in ranks.iter().enumerate() {
        places[usize::from(rank)] = ((place as u32 % m) as u8, (place as u32 / m) as u8);
    }
    places
}

/// Like [`order`], but starts with a rotated grid: one sample in each row and each column. For odd m and m = 2 it
/// equals `order`.
pub fn rotated(m: u32) -> Vec<(u8, u8)> {
    let mut places = order(m);
    if rotated_samples(m) == m {
        // The grid moves to the front; a stable sort keeps the order otherwise.
        let first = |&(x, y): &(u8, u8)| u32::from(x) == (2 * u32::from(y) + 1) % (m + 1);
        places.sort_by_key(|place| !first(place));
    }
    places
}

/// The number of samples in the rotated grid of [`rotated`]: m, or all m² where there is no grid.
pub fn rotated_samples(m: u32) -> u32 {
    if m >= 4 && m.is_multiple_of(2) { m } else { m * m }
}

/// Like [`order`], but starts with the sample nearest to the pixel's centre; of several, the one that `order` has
/// first. [`Technique::Selective`](crate::Technique::Selective) compares pixels by this sample.
pub fn centred(m: u32) -> Vec<(u8, u8)> {
    let mut places = order(m);
    let off = |v: u8| (2 * i32::from(v) + 1 - m as i32).abs();
    let nearest = places.iter().map(|&(x, y)| off(x) + off(y)).min();
    let first = places.iter().position(|&(x, y)| Some(off(x) + off(y)) == nearest && !dropped(m, x, y));
    places[..=first.unwrap_or(0)].rotate_right(1);
    places
}

/// The quadrants of the window that use a sample, one bit each: from the lowest, upper left, upper right, lower left,
/// lower right. A sample that lies in several quadrants is shared equally between them.
///
/// A quadrant uses four samples: at m = 4 its own, at m = 3 those that reach into it, at larger m one from each of its
/// quarters, so that some samples belong to no quadrant. At m = 2 it uses one.
pub fn quadrants(m: u32, x: u8, y: u8) -> u32 {
    if dropped(m, x, y) {
        return 0;
    }
    // Along one axis: 1 the first half, 2 the second, 3 both.
    let halves = |v: u8| u32::from(2 * u32::from(v) < m) | u32::from(2 * u32::from(v) + 2 > m) << 1;
    let row = halves(x);
    [row, row << 2, row | row << 2][halves(y) as usize - 1]
}

/// The number of samples that the four quadrants use together.
pub fn quadrant_samples(m: u32) -> u32 {
    (m * m).min(16)
}

/// Whether no quadrant uses a sample, for m above 4. Each sixteenth of the window keeps the sample nearest to its
/// centre; of four equally near samples it keeps a different one from row to row and from column to column.
fn dropped(m: u32, x: u8, y: u8) -> bool {
    let (x, y) = (u32::from(x), u32::from(y));
    match m {
        5..=7 => {
            let taken: &[u32] = [&[0, 1, 3, 4][..], &[0, 2, 3, 5], &[0, 2, 4, 6]][m as usize - 5];
            !taken.contains(&x) || !taken.contains(&y)
        }
        8 => x % 2 != y / 2 % 2 || y % 2 != x / 2 % 2,
        _ => false,
    }
}

/// Bayer's recursion: takes the places of the small matrix in their order, each in all four quadrants in the order of
/// the 2 × 2 matrix.
fn doubled(small: &[(u8, u8)], m: u32) -> Vec<(u8, u8)> {
    let m = m as u8;
    small.iter().flat_map(|&(x, y)| order(2).into_iter().map(move |(i, j)| (x + m * i, y + m * j))).collect()
}

fn furthest_first(m: u32) -> Vec<(u8, u8)> {
    let side = m as i32;
    let apart = |a: (u8, u8), b: (u8, u8)| {
        let along = |a: u8, b: u8| {
            let d = (i32::from(a) - i32::from(b)).abs();
            d.min(side - d)
        };
        along(a.0, b.0).pow(2) + along(a.1, b.1).pow(2)
    };
    let mut left: Vec<(u8, u8)> = (0..m * m).map(|i| ((i % m) as u8, (i / m) as u8)).collect();
    let centre = (m / 2 * m + m / 2) as usize;
    let mut places = vec![left.remove(centre)];
    while !left.is_empty() {
        let score = |&p: &(u8, u8)| {
            let nearest = places.iter().map(|&q| apart(p, q)).min().unwrap_or(0);
            (nearest, apart(p, places[places.len() - 1]))
        };
        // `max_by_key` keeps the last of equals: reversed, that is the first in reading order.
        let best = (0..left.len()).rev().max_by_key(|&i| score(&left[i])).unwrap_or(0);
        places.push(left.remove(best));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_visits_each_place_once() {
        for m in 1..=MAX_M {
            let mut places = order(m);
            places.sort_unstable_by_key(|&(x, y)| (y, x));
            let all: Vec<_> = (0..m * m).map(|i| ((i % m) as u8, (i / m) as u8)).collect();
            assert_eq!(places, all, "m = {m}");
        }
    }

    #[test]
    fn a_rotated_grid_has_one_sample_in_each_row_and_column() {
        for m in 1..=MAX_M {
            let mut places = rotated(m);
            if rotated_samples(m) < m * m {
                let (xs, ys): (Vec<_>, Vec<_>) = places[..m as usize].iter().copied().unzip();
                for mut axis in [xs, ys] {
                    axis.sort_unstable();
                    assert!(axis.iter().copied().eq(0..m as u8), "m = {m}");
                }
            }
            let mut all = order(m);
            places.sort_unstable();
            all.sort_unstable();
            assert_eq!(places, all, "m = {m}");
        }
        // The paper's Figure 2, by rows.
        assert_eq!(rotated_samples(4), 4);
        let mut grid = rotated(4)[..4].to_vec();
        grid.sort_unstable_by_key(|p| p.1);
        assert_eq!(grid, [(1, 0), (3, 1), (0, 2), (2, 3)]);
    }

    #[test]
    fn quadrants_have_four_samples_each_that_cover_them_evenly() {
        for m in 1..=MAX_M {
            let places = centred(m);
            let mut sorted = places.clone();
            sorted.sort_unstable();
            let mut all = order(m);
            all.sort_unstable();
            assert_eq!(sorted, all, "m = {m}");
            // The shares of each quadrant add up to a quarter of the samples, and their mean is near its middle.
            let mut cover = [[0.0f64; 3]; 4];
            let mut taken = 0;
            for &(x, y) in &places {
                let of = quadrants(m, x, y);
                taken += u32::from(of != 0);
                for (i, sums) in cover.iter_mut().enumerate().filter(|(i, _)| of >> i & 1 == 1) {
                    let share = 1.0 / f64::from(of.count_ones());
                    let apart = |v: u8, half: usize| {
                        // A sample that is cut counts at the middle of its part.
                        let (low, high) = (f64::from(v), f64::from(v) + 1.0);
                        let middle = f64::from(m) / 2.0;
                        let (low, high) = if half == 0 { (low, high.min(middle)) } else { (low.max(middle), high) };
                        (low + high) / 2.0 / f64::from(m)
                    };
                    let [dx, dy] = [apart(x, i & 1), apart(y, i >> 1)];
                    *sums = [sums[0] + share, sums[1] + share * dx, sums[2] + share * dy];
                }
            }
            assert_eq!(taken, quadrant_samples(m), "m = {m}");
            for (i, [sum, x, y]) in cover.into_iter().enumerate() {
                assert!((sum - f64::from(taken) / 4.0).abs() < 1e-12, "m = {m}");
                let middle = [0.25, 0.75];
                let off = (x / sum - middle[i & 1]).abs().max((y / sum - middle[i >> 1]).abs());
                assert!(off < 0.051, "m = {m}, quadrant {i}: {off} off its middle");
            }
            let (x, y) = places[0];
            let near = |v: u8| (2 * i32::from(v) + 1 - m as i32).abs() <= 1;
            assert!(near(x) && near(y), "m = {m}");
        }
        // At m = 3 and 4 the printed order already starts nearest to the centre.
        assert_eq!((centred(3), centred(4)), (order(3), order(4)));
        let rows: Vec<Vec<u32>> = (0..3).map(|y| (0..3).map(|x| quadrants(3, x, y)).collect()).collect();
        assert_eq!(rows, [[1, 3, 2], [5, 15, 10], [4, 12, 8]]);
    }

    #[test]
    fn first_ranks_stay_near_the_centre_and_spread() {
        for m in 2..=MAX_M {
            let places = order(m);
            // The first four samples lie in at least three different quadrants or middle lines.
            let side = |v: u8| (2 * i32::from(v) + 1 - m as i32).signum();
            let mut quadrants: Vec<_> = places[..4].iter().map(|&(x, y)| (side(x), side(y))).collect();
            quadrants.sort_unstable();
            quadrants.dedup();
            assert!(quadrants.len() >= 3, "m = {m}: {:?}", &places[..4]);
        }
    }
}
