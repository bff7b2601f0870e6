//! Twin of `shaders/rays/probe.wgsl`: the windows that an edge of a shadow crosses, near those whose first samples show
//! one.

/// What `trace` has found, or would find.
#[derive(Debug, Clone)]
pub struct Input<'a> {
    /// The size of the image in pixels.
    pub size: [usize; 2],
    /// The shadow bits of the samples of each window by rank, rows from the top; `None` for the sky. Of a window, four
    /// samples are read.
    pub windows: &'a [Vec<Option<u32>>],
    /// The setting `shadow_reach`, in pixels.
    pub reach: usize,
}

/// The number of samples of a window whose bits are compared, the first included.
const PROBED: usize = 4;

impl Input<'_> {
    /// Whether an edge was found in the window of a pixel.
    pub fn differs(&self, x: usize, y: usize) -> bool {
        let mut found = self.windows[y * self.size[0] + x].iter().take(PROBED);
        let Some(Some(first)) = found.next() else { return false };
        self.is_near_change(x, y) && found.flatten().any(|bits| bits != first)
    }

    /// Whether first samples within the reach have other bits. The sky has none.
    fn is_near_change(&self, x: usize, y: usize) -> bool {
        let bits = |x: usize, y: usize| self.windows[y * self.size[0] + x].first().copied().flatten().unwrap_or(0);
        let near = |at: usize, side: usize| at.saturating_sub(self.reach)..=(at + self.reach).min(side - 1);
        near(y, self.size[1]).any(|j| near(x, self.size[0]).any(|i| bits(i, j) != bits(x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_first_samples_miss_is_found_within_reach() {
        // First samples see a shadow in the first window alone; the fifth has one between them, the last but one a sky.
        let mut windows = vec![vec![Some(0); 16]; 6];
        windows[0] = vec![Some(1); 16];
        windows[2][3] = Some(1);
        windows[3][5] = Some(1);
        windows[4] = vec![Some(0), None, Some(2), None];
        windows[5] = vec![None, Some(1)];
        let found = |reach| (0..6).map(|x| Input { size: [6, 1], windows: &windows, reach }.differs(x, 0)).collect();
        let none: Vec<bool> = found(1);
        assert_eq!(none, [false; 6]);
        // The fourth is within reach, but its edge lies beyond the four that are probed.
        let found: Vec<bool> = found(4);
        assert_eq!(found, [false, false, true, false, true, false]);
    }
}
