//! Twin of the window order: the matrices as Holländer et al. 2013, Figure 3, prints them.

/// The ranks in reading order at m = 2.
pub const PRINTED_2: [[u8; 2]; 2] = [[0, 2], [3, 1]];
/// The ranks in reading order at m = 3.
pub const PRINTED_3: [[u8; 3]; 3] = [[2, 6, 3], [5, 0, 8], [1, 7, 4]];
/// The ranks in reading order at m = 4.
pub const PRINTED_4: [[u8; 4]; 4] = [[1, 8, 2, 10], [12, 4, 14, 6], [3, 11, 0, 9], [15, 7, 13, 5]];

/// The matrix of an order: its ranks in reading order.
pub fn matrix(places: &[(u8, u8)], m: u32) -> Vec<u8> {
    let mut ranks = vec![0; places.len()];
    for (rank, &(x, y)) in places.iter().enumerate() {
        ranks[usize::from(y) * m as usize + usize::from(x)] = rank as u8;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::order;

    #[test]
    fn two_three_and_four_are_as_printed() {
        assert_eq!(matrix(&order(2), 2), PRINTED_2.as_flattened());
        assert_eq!(matrix(&order(3), 3), PRINTED_3.as_flattened());
        assert_eq!(matrix(&order(4), 4), PRINTED_4.as_flattened());
    }

    #[test]
    fn eight_is_the_doubled_four() {
        // Bayer: rank(2m) = 4 · rank(m) + rank(2) of the quadrant.
        let eight = matrix(&order(8), 8);
        for y in 0..8 {
            for x in 0..8 {
                let expected = 4 * PRINTED_4[y % 4][x % 4] + PRINTED_2[y / 4][x / 4];
                assert_eq!(eight[y * 8 + x], expected, "{x}, {y}");
            }
        }
    }
}
