//! The kinds of the node's passes, told by their names. Nothing else in the demo knows what a pass is by its name.

/// The pass that shades the samples of the plan, as times are listed by name.
pub const SHADE: &str = "shade";

/// What a frame's passes are for: to cast rays, to decide what is sampled, to shade, and the rest.
pub const PARTS: [&str; 4] = ["rays", "decisions", "shading", "rest"];

/// The part of [`PARTS`] that a pass belongs to.
pub fn part(pass: &str) -> &'static str {
    match pass.split(' ').next() {
        Some("trace" | "bounce" | "classify") => "rays",
        Some("refine") => "decisions",
        Some("points" | "first" | "shade") => "shading",
        _ => "rest",
    }
}

/// Whether a pass casts rays towards lights.
pub fn traces_shadows(pass: &str) -> bool {
    pass.starts_with("trace")
}

/// Whether a pass casts rays that are reflected or refracted.
pub fn bounces(pass: &str) -> bool {
    pass.starts_with("bounce")
}

/// Whether a pass casts rays towards lights from the first sample of every pixel.
pub fn traces_first_samples(pass: &str) -> bool {
    pass == "trace first"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_apart_by_what_they_are_for() {
        for (pass, expected) in [
            ("classify", "rays"),
            ("trace 1/4", "rays"),
            ("bounce shifted", "rays"),
            ("refine rays 1/2", "decisions"),
            ("refine", "decisions"),
            ("points 1/8", "shading"),
            ("first", "shading"),
            ("resolve", "rest"),
        ] {
            assert_eq!(part(pass), expected, "{pass}");
        }
    }
}
