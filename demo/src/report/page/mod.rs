//! report.html: one file with everything in it.

pub mod images;

use super::ReportError;
use super::folder::{Folder, write_whole};
use super::schema::Report;
use images::Images;
use serde::Serialize;

const PAGE: &str = include_str!("page.html");
const CSS: &str = include_str!("page.css");
/// In the order in which they use each other.
const JS: &str = concat!(
    include_str!("js/data.js"),
    include_str!("js/paper.js"),
    include_str!("js/draw.js"),
    include_str!("js/scatter.js"),
    include_str!("js/charts.js"),
    include_str!("js/papers.js"),
    include_str!("js/sections.js"),
);

/// Writes the page.
pub fn write(folder: &Folder, report: &Report, images: &Images) -> Result<(), ReportError> {
    let path = folder.file(images::PAGE_FILE);
    let json = |value: Result<String, serde_json::Error>| {
        value.map(|v| escaped(&v)).map_err(|e| ReportError::file(&path, "this is a bug")(e.into()))
    };
    let (report, images) = (json(text(report))?, json(text(images))?);
    let parts = [("/*__CSS__*/", CSS), ("/*__JS__*/", JS), ("__REPORT_JSON__", &report), ("__IMAGES_JSON__", &images)];
    write_whole(&path, filled(PAGE, &parts).as_bytes())
}

fn text(value: &impl Serialize) -> Result<String, serde_json::Error> {
    serde_json::to_string(value)
}

/// JSON that no browser takes for the end of the script, or for a comment: `<` can only stand inside of strings.
fn escaped(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The template with each marker's first place filled. What is filled in is not looked at again.
fn filled(template: &str, parts: &[(&str, &str)]) -> String {
    let mut places: Vec<_> =
        parts.iter().filter_map(|(marker, part)| Some((template.find(marker)?, marker.len(), part))).collect();
    places.sort_unstable();
    let (mut page, mut at) = (String::new(), 0);
    for (place, length, part) in places {
        page += &template[at..place];
        page += part;
        at = place + length;
    }
    page + &template[at..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_has_each_marker_once() {
        for marker in ["/*__CSS__*/", "/*__JS__*/", "__REPORT_JSON__", "__IMAGES_JSON__"] {
            assert_eq!(PAGE.matches(marker).count(), 1, "{marker}");
        }
    }

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        assert_eq!(filled("<a> A <b> B </b>", &[("B", "A"), ("A", "B B")]), "<a> B B <b> A </b>");
    }

    #[test]
    fn no_text_ends_the_script() {
        let json = escaped(&serde_json::to_string("</script><!-- 1 < 2").unwrap());
        assert!(!json.contains('<'));
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), "</script><!-- 1 < 2");
    }
}
