//! All tests that need a GPU or real files, as one binary. Every test that renders checks at its end that wgpu had
//! nothing to complain of.

mod api;
mod bands;
mod bits;
mod blend;
mod campaigns;
mod checker;
mod debug_views;
mod depth;
mod drivers;
mod example;
mod goals;
mod graph;
mod harness;
mod host_groups;
mod multi_resolution;
mod needs;
mod numerics;
mod rays;
mod reflections;
mod reflections_twin;
mod scenes;
mod selective;
mod shading_errors;
mod shadows;
mod surfaces;
mod textures;
mod twin;
mod views;
mod visibility;

/// docs/numerics.md names the tests that hold what it says.
#[test]
fn the_page_of_hard_cases_names_tests() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("docs/numerics.md")).expect("the page");
    let mut sources = String::new();
    let mut folders = vec![root.join("tests/suite")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("sources").flatten() {
            match entry.path() {
                path if path.is_dir() => folders.push(path),
                path => sources += &std::fs::read_to_string(path).expect("a source"),
            }
        }
    }
    let rows = page.lines().filter(|line| line.starts_with("| ") && line.ends_with("` |"));
    let names: Vec<&str> =
        rows.flat_map(|row| row.rsplit(" | ").next().unwrap_or(row).split('`').skip(1).step_by(2)).collect();
    assert!(names.len() > 50, "{}", names.len());
    for name in names {
        assert!(sources.contains(&format!("fn {name}()")), "no test is named {name}");
    }
}
