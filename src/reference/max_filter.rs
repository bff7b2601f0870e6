//! Twin of `shaders/passes/max_filter.wgsl`.

/// The number of pixels along a side of a block.
pub const BLOCK: u32 = 6;

/// The counts of an image, rows from the top, with each replaced by the greatest of its block.
pub fn max_filter(counts: &[u32], width: u32, height: u32) -> Vec<u32> {
    let greatest = |x: u32, y: u32| {
        let (x0, y0) = (x / BLOCK * BLOCK, y / BLOCK * BLOCK);
        let rows = y0..height.min(y0 + BLOCK);
        let block = rows.flat_map(|y| (x0..width.min(x0 + BLOCK)).map(move |x| (y * width + x) as usize));
        block.map(|i| counts[i]).max().unwrap_or(0)
    };
    (0..height).flat_map(|y| (0..width).map(move |x| greatest(x, y))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_do_not_leak() {
        let mut counts = vec![1; 13 * 7];
        counts[5] = 9;
        counts[6 * 13 + 12] = 4;
        let filtered = max_filter(&counts, 13, 7);
        assert_eq!(filtered.iter().filter(|&&k| k == 9).count(), 36);
        assert_eq!((filtered[5 * 13 + 5], filtered[6], filtered[6 * 13]), (9, 1, 1));
        assert_eq!(filtered.iter().filter(|&&k| k == 4).count(), 1);
    }
}
