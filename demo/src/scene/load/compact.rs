//! The vertices that triangles use.

/// Renumbers `corners` to the vertices they use, and returns those.
pub(super) fn compact(corners: &mut [u32], count: usize) -> Vec<u32> {
    // New number plus one; zeroed pages that nothing touches cost nothing.
    let mut renumbered = vec![0; count];
    let mut used = Vec::new();
    for corner in corners {
        let number = &mut renumbered[*corner as usize];
        if *number == 0 {
            used.push(*corner);
            *number = used.len() as u32;
        }
        *corner = *number - 1;
    }
    used
}
