//! The order in which a window's samples are shaded.

/// Most samples along one side of a window.
pub const MAX_M: u32 = 8;

/// The places of a window's samples in the order in which they are shaded: `order(m)[rank] = (x, y)`, y down.
///
/// m = 2, 3, 4 are the index matrices of Holländer et al. 2013, Figure 3, as printed. 6 and 8 come from 3 and 4 by Bayer's
/// recursion (1973), with the printed 2 × 2 matrix. 5 and 7, which no recursion reaches, start in the centre and go on to
/// the place that is furthest from all before, the window being repeated in all directions; of several such, the one
/// furthest from the place before, then the first in reading order.
///
/// # Panics
/// If m is not in 1..=8.
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

/// [`order`], but first a rotated grid: one sample in each row and each column. For odd m, and 2, `order` itself.
pub fn rotated(m: u32) -> Vec<(u8, u8)> {
    let mut places = order(m);
    if rotated_samples(m) == m {
        // Before all others, in their own order.
        let first = |&(x, y): &(u8, u8)| u32::from(x) == (2 * u32::from(y) + 1) % (m + 1);
        places.sort_by_key(|place| !first(place));
    }
    places
}

/// Samples of [`rotated`]'s grid: m, or all where there is none.
pub fn rotated_samples(m: u32) -> u32 {
    if m >= 4 && m.is_multiple_of(2) { m } else { m * m }
}

/// Bayer's recursion: each place of the small matrix, in its order, in all four quadrants in the order of the 2 × 2 matrix.
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
        // The paper's Figure 2, in its own turn.
        assert_eq!(rotated_samples(4), 4);
        let mut grid = rotated(4)[..4].to_vec();
        grid.sort_unstable_by_key(|p| p.1);
        assert_eq!(grid, [(1, 0), (3, 1), (0, 2), (2, 3)]);
    }

    #[test]
    fn first_ranks_stay_near_the_centre_and_spread() {
        for m in 2..=MAX_M {
            let places = order(m);
            // The first four samples fall into four different quadrants, or the middle lines of an odd window.
            let side = |v: u8| (2 * i32::from(v) + 1 - m as i32).signum();
            let mut quadrants: Vec<_> = places[..4].iter().map(|&(x, y)| (side(x), side(y))).collect();
            quadrants.sort_unstable();
            quadrants.dedup();
            assert!(quadrants.len() >= 3, "m = {m}: {:?}", &places[..4]);
        }
    }
}
