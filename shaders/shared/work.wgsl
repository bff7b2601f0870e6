// The dispatches of a list: `list` writes them, and the passes that run the list read them. Declares no bindings.

/// The entry that pads a row to whole workgroups.
const DAA_NO_ENTRY: u32 = 0xffffffffu;

/// The number of strides in which the workgroups of a list of pixels are drawn.
const DAA_STRIDES: u32 = 16u;

/// The part of a list that one dispatch runs. Work 0 is the whole list, work r + 1 is row r or batch r. It has 256
/// bytes, so that a dynamic offset can select it.
struct DaaWork {
    begin: u32,
    end: u32,
    /// Number of entries of the row, without padding.
    count: u32,
    padding: u32,
    /// Workgroups of 64 lanes, for an indirect dispatch.
    groups_x: u32,
    groups_y: u32,
    groups_z: u32,
    padding_too: array<u32, 57>,
}

/// The first entry of a workgroup, and whether it has any. A list of pixels is drawn in strides, each of which goes
/// from the greatest k to the least. A driver that cuts a dispatch into fixed parts then gets equal parts, and the last
/// workgroups to start are short.
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
