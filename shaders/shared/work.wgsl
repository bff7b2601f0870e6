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
    groups_z: u32,
    padding_too: array<u32, 57>,
}

/// The first entry that a workgroup draws, and whether there is one. A list of pixels is drawn in strides, each of which goes from
/// its greatest k to its least: a driver that cuts a dispatch into fixed parts gets equal ones, and the last workgroups to start
/// are short.
struct DaaDraw {
    begin: u32,
    any: bool,
}

fn daa_draw(begin: u32, end: u32, index: u32) -> DaaDraw {
    let groups = (end - begin) / 64u;
    let stride = max((groups + DAA_STRIDES - 1u) / DAA_STRIDES, 1u);
    let drawn = index % stride * DAA_STRIDES + index / stride;
    return DaaDraw(begin + drawn * 64u, index < stride * DAA_STRIDES && drawn < groups);
}
