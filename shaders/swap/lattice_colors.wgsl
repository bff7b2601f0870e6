// The values of a lattice whose points are shaded: their colours.

@group(3) @binding(0) var<uniform> daa_step: DaaStep;
@group(3) @binding(1) var<storage, read_write> daa_points: array<vec4u>;
@group(3) @binding(2) var<storage, read_write> daa_lattice_colors: array<vec4f>;

fn daa_value(index: u32, point: DaaPoint) -> vec4f {
    return daa_lattice_colors[index];
}

/// The shadow bits were traced before. They can veto interpolation, but are not compared as values.
fn daa_bits(index: u32) -> u32 {
    return 0u;
}

fn daa_shadow_at(index: u32, point: DaaPoint) -> u32 {
    return daa_shadow_bits(point.pixel, point.rank);
}

fn daa_put(index: u32, point: DaaPoint, value: vec4f, bits: u32) {
    daa_lattice_colors[index] = value;
}

/// Copies the value of a coarser point to the same point of the finer lattice.
fn daa_keep(index: u32, coarser: u32) {
    daa_lattice_colors[index] = daa_lattice_colors[coarser];
}

/// `points` writes the colour later.
fn daa_leave(index: u32) {}
