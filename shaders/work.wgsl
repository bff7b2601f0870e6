// What `list` writes and `listed` reads: a list's parts. Knows no bindings.

/// Fills a row up to whole workgroups.
const DAA_NO_ENTRY: u32 = 0xffffffffu;

/// Strides in which a list of pixels is drawn.
const DAA_STRIDES: u32 = 16u;

/// One dispatch's part of the list. Work 0 is all of it, work r + 1 is row r or batch r. 256 bytes, so that a dynamic offset
/// selects one.
struct DaaWork {
    begin: u32,
    end: u32,
    /// Entries of the row, without padding.
    count: u32,
    padding: u32,
    /// Workgroups of 64, for an indirect dispatch.
    groups_x: u32,
    groups_y: u32,
    @size(232) groups_z: u32,
}
