//! `report` as its user meets it, on pictures of a few thousand pixels.

use deferred_aa_demo::picture::heat;
use deferred_aa_demo::report::schema::Report;
use image::RgbImage;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::time::SystemTime;

/// A folder of this test's own, empty, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("report-{name}"));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn out(&self) -> PathBuf {
        self.0.join("out")
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&std::fs::read(self.out().join("report.json")).unwrap()).unwrap()
    }

    fn image(&self, name: &str) -> RgbImage {
        image::open(self.out().join(name)).unwrap_or_else(|e| panic!("{name}: {e}")).into_rgb8()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A tiny report with its truths in the folder itself.
fn report(folder: &Folder, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deferred-aa-demo"));
    command.args(["report", "--quick", "--frames", "1"]);
    for (name, value) in [("--scene", "fence"), ("--size", "64x36"), ("--m", "2")] {
        if !arguments.contains(&name) {
            command.args([name, value]);
        }
    }
    command.arg("--out").arg(folder.out()).arg("--cache").arg(folder.0.join("cache")).args(arguments);
    command.output().unwrap()
}

#[track_caller]
fn succeed(folder: &Folder, arguments: &[&str]) -> Value {
    let output = report(folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    folder.json()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[track_caller]
fn assert_refused(output: &Output, words: &[&str]) {
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(2), "{stdout}{stderr}");
    assert_eq!((stdout.as_str(), stderr.lines().count()), ("", 1), "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "{word:?} is not in {stderr:?}");
    }
}

fn entries(report: &Value) -> &Vec<Value> {
    report["entries"].as_array().unwrap()
}

fn find<'a>(report: &'a Value, id: &str) -> &'a Value {
    entries(report).iter().find(|e| e["id"] == id).unwrap_or_else(|| panic!("no entry {id}"))
}

/// One whole report, for the tests that only read it.
fn whole() -> &'static (Folder, Value) {
    static WHOLE: OnceLock<(Folder, Value)> = OnceLock::new();
    WHOLE.get_or_init(|| {
        let folder = Folder::new("whole");
        let report = succeed(&folder, &["--m", "1,2"]);
        (folder, report)
    })
}

#[test]
fn every_field_and_file_is_there() {
    let (folder, report) = whole();
    for key in [
        "version",
        "command",
        "scene",
        "width",
        "height",
        "stall",
        "quick",
        "lights",
        "triangles",
        "adapter",
        "truth",
        "entries",
        "oracles",
        "frontier",
        "executions",
        "cost",
        "effects",
        "papers",
        "goals",
        "crops",
        "unfinished",
        "seconds",
    ] {
        assert!(report.get(key).is_some(), "report.json lacks {key}");
    }
    assert_eq!((&report["version"], &report["scene"], &report["quick"]), (&1.into(), &"fence".into(), &true.into()));
    assert!(
        report["command"].as_str().unwrap().starts_with("deferred-aa-demo report --quick --frames 1 --scene fence")
    );
    assert_eq!(report["truth"]["samples_per_pixel"], 256);
    assert_eq!(report["unfinished"], Value::Array(Vec::new()));
    let adaptive = [
        "windowed-m2",
        "windowed-m2-x1-4",
        "windowed-m2-paper",
        "selective-m2",
        "selective-m2-paper",
        "multiresolution-m2",
        "multiresolution-m2-sparse",
        "multiresolution-m2-paper",
        "surfaces-m2",
        "surfaces-m2-once",
        "surfaces-m2-fast",
        "surfaces-m2-quality",
    ];
    for id in ["full-m2", "single-m2", "single-m1"].into_iter().chain(adaptive) {
        let entry = find(report, id);
        for key in [
            "label",
            "role",
            "preset",
            "scene",
            "width",
            "height",
            "m",
            "technique",
            "settings",
            "stall",
            "adapter",
            "samples",
            "rays",
            "tiles",
            "time_ms",
            "memory_bytes",
            "quality",
            "passes",
            "files",
            "oracle",
            "temporal",
        ] {
            assert!(entry.get(key).is_some(), "{id} lacks {key}");
        }
        for (kind, name) in entry["files"].as_object().unwrap() {
            let maps = ["full-m2", "single-m2", "single-m1"].contains(&id) && kind == "samples";
            assert_eq!(name.is_null(), maps, "{id}: {kind}");
            if let Some(name) = name.as_str() {
                let image = image::open(folder.out().join(name)).unwrap();
                assert_eq!((image.width(), image.height()), (64, 36), "{name}");
            }
        }
        assert_eq!(entry["quality"]["grid"].is_null(), id == "single-m1", "{id}");
    }
    let groups = |id: &str| find(report, id)["oracle"]["groups"]["achieved_over_oracle"].as_f64();
    assert!((0.5..2.0).contains(&groups("surfaces-m2").unwrap_or(0.0)), "{:?}", groups("surfaces-m2"));
    assert_eq!(groups("windowed-m2"), None);
    let curve = report["oracles"][0]["groups"].as_array().map_or(0, Vec::len);
    assert!(curve > 2, "{curve} points");
    assert_eq!(find(report, "windowed-m2-paper")["preset"], "paper");
    assert_eq!(find(report, "full-m2")["quality"]["grid"]["psnr_db"], 200.0);
    for name in ["truth.png", "truth.exr", "edges.png"] {
        assert!(folder.out().join(name).is_file(), "{name}");
    }
}

#[test]
fn what_the_scene_does_not_pay_for_is_there() {
    let (_, report) = whole();
    let effects = &report["effects"];
    let rows = effects["rows"].as_array().unwrap();
    assert_eq!(
        rows.iter().map(|r| r["effect"].as_str().unwrap()).collect::<Vec<_>>(),
        ["shadows", "reflections", "refraction"]
    );
    for row in rows {
        assert_eq!(
            (&row["needed"], &row["off"]["ray_bytes"], &row["off"]["rays"]),
            (&false.into(), &0.into(), &0.into())
        );
        assert!(row["on"]["ray_bytes"].as_u64().unwrap() > 0);
        let (on, off) = (row["on"]["passes"].as_array().unwrap(), row["off"]["passes"].as_array().unwrap());
        assert!(on.len() > off.len() && on.contains(&"classify".into()) && !off.contains(&"classify".into()));
    }
    assert!(rows[0]["on"]["rays"].as_u64().unwrap() > 0);
    let tiers = effects["tiers"].as_array().unwrap();
    assert!(tiers[0]["tier"] == "software" && tiers[0]["bytes_per_triangle"].as_f64().unwrap() < 40.0);
    let reflect = |r: &Value| r["frames"]["tiles"]["reflect"].as_u64().unwrap();
    let mirrors: Vec<_> = effects["mirrors"].as_array().unwrap().iter().map(reflect).collect();
    assert!(mirrors[0] == 0 && mirrors[1] > 0 && mirrors[2] == 64 * mirrors[1], "{mirrors:?}");
}

/// The tables of the papers in a report, by id.
fn tables(report: &Value) -> BTreeMap<&str, &Value> {
    let tables = report["papers"]["tables"].as_array().unwrap();
    tables.iter().map(|t| (t["id"].as_str().unwrap(), t)).collect()
}

#[test]
fn the_papers_tables_are_there_with_ours_beside_them() {
    let (_, report) = whole();
    let tables = tables(report);
    assert_eq!(
        tables.keys().copied().collect::<Vec<_>>(),
        ["jin-2009-figure-7", "jin-2009-figure-7-ours", "jin-2009-table-2", "tri-adaptive-table-5-1"]
    );
    let row = |table: &str, id: &str| {
        let rows = tables[table]["rows"].as_array().unwrap();
        rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("no row {id}")).clone()
    };
    let of = |id: &str| row("jin-2009-table-2", id);
    let timed = !find(report, "full-m2")["time_ms"].as_object().unwrap().is_empty();
    for (id, n) in [("fixed-16", 16.0), ("fixed-9", 9.0), ("fixed-4", 4.0), ("fixed-1", 1.0)] {
        let row = of(id);
        assert_eq!((row["mean_k"].as_f64(), row["samples"].as_f64()), (Some(n), Some(n / 9.0)), "{id}");
        assert!(row["truth_db"].as_f64() <= of("fixed-16")["truth_db"].as_f64(), "{id}");
        assert_eq!(row["grid_db"].as_f64(), (n > 1.0).then_some(200.0), "{id}");
        assert!(row["speed"].is_f64() == timed && row["time_ms"]["gbuffer"].is_object() == timed, "{id}");
        assert_eq!(row["printed"].as_array().unwrap().len(), 5);
    }
    if timed {
        assert_eq!(of("fixed-9")["speed"], 1.0);
    }
    let samples =
        ["0-1", "0-3", "0-6", "1", "focused"].map(|id| of(&format!("selective-{id}"))["samples"].as_f64().unwrap());
    assert!(samples.is_sorted_by(|a, b| a >= b) && samples[0] > samples[4], "{samples:?}");
    assert!(of("selective-focused")["label"].as_str().unwrap().contains("focused on "));
    assert!(of("selective-ours")["settings"] == find(report, "selective-m2")["settings"]);
    let fixed = row("jin-2009-figure-7", "fixed-16");
    assert_eq!(
        (&fixed["samples"], &fixed["time_ms"], &fixed["speed"]),
        (&1.0.into(), &serde_json::json!({}), &Value::Null)
    );
    let alone = row("jin-2009-figure-7", "colour-alone-0-1");
    assert_eq!(
        (&alone["settings"]["selective"]["enabled"]["poid"], &alone["same_psnr"]),
        (&false.into(), &Value::Null)
    );
}

#[test]
fn lattices_are_held_against_every_pixel_shaded_once() {
    let (_, report) = whole();
    let rows = tables(report)["tri-adaptive-table-5-1"]["rows"].as_array().unwrap();
    let timed = !find(report, "full-m2")["time_ms"].as_object().unwrap().is_empty();
    assert_eq!((&rows[0]["over_db"], &rows[0]["mean_k"]), (&200.0.into(), &1.0.into()));
    for row in &rows[1..] {
        let (samples, db) = (row["samples"].as_f64().unwrap(), row["over_db"].as_f64().unwrap());
        // Triangles shade in the shifted rows too, and a fence has little that is smooth.
        let squares = row["id"].as_str().unwrap().ends_with("quad");
        assert!(db > 20.0 && samples < if squares { 1.0 } else { 2.0 }, "{row:#}");
    }
    for row in rows.iter().filter(|_| timed) {
        let median = |time: &Value| time["median"].as_f64().unwrap();
        let parts = row["parts_ms"].as_object().unwrap();
        assert_eq!(parts.keys().collect::<Vec<_>>(), ["decisions", "rays", "rest", "shading"]);
        assert_eq!(median(&parts["decisions"]) > 0.0, row["id"] != "every-pixel", "{row:#}");
        // One frame: the medians are its times.
        let sum: f64 = parts.values().map(median).sum();
        assert!((sum - median(&row["time_ms"]["node"])).abs() < 1e-6, "{row:#}");
    }
    let others = tables(report)["jin-2009-table-2"]["rows"][0].clone();
    assert_eq!((&others["over_db"], &others["parts_ms"]), (&Value::Null, &serde_json::json!({})));
    let sparse = find(report, "multiresolution-m2-sparse");
    assert_eq!(sparse["settings"]["multi_resolution"]["supersampled"], false);
    assert!(sparse["samples"]["mean_k"].as_f64().unwrap() < 1.0);
}

#[test]
fn sample_maps_hold_what_was_shaded_below_one_sample_a_pixel() {
    let (folder, report) = whole();
    let map = folder.image("multiresolution-m2-sparse-samples.png");
    let one = image::Rgb(heat(1, 4));
    let shaded = map.pixels().filter(|p| **p == one).count() as f64 / f64::from(map.width() * map.height());
    let mean_k = find(report, "multiresolution-m2-sparse")["samples"]["mean_k"].as_f64().unwrap();
    // Points beyond the border count as samples, and no pixel shows them.
    assert!(shaded > 0.0 && shaded < 1.0 && shaded <= mean_k && shaded > mean_k * 0.8, "{shaded}, {mean_k}");
}

#[test]
fn a_focus_is_by_number_or_name() {
    let folder = Folder::new("focus");
    let few = ["--scene", "cornell", "--size", "32x18", "--techniques", "full,selective"];
    let focused = |focus: &'static str| {
        let report = succeed(&folder, &[&few[..], &["--resume", "--focus", focus]].concat());
        let table = tables(&report)["jin-2009-table-2"].clone();
        let rows = table["rows"].as_array().unwrap();
        rows.iter().find(|r| r["id"] == "selective-focused").unwrap()["label"].as_str().unwrap().to_owned()
    };
    let by_number = focused("1");
    let written = |folder: &Folder| finished(folder)[&folder.out().join("parts/papers.json")];
    let (first, again) = (written(&folder), focused("1"));
    assert_eq!((written(&folder), &again), (first, &by_number), "measured again");
    assert!(focused("2") != by_number && written(&folder) != first);
    let (_, name) = by_number.split_once("focused on ").unwrap();
    assert!(!name.contains("object"), "the mesh of object 1 has a name: {name}");
    assert_refused(
        &report(&folder, &[&few[..], &["--focus", "the door"]].concat()),
        &["--focus", "'the door'", "number"],
    );
}

#[test]
fn reports_of_before_can_be_read() {
    let mut old = whole().1.clone();
    for table in old["papers"]["tables"].as_array_mut().unwrap() {
        table.as_object_mut().unwrap().remove("sparse");
        for row in table["rows"].as_array_mut().unwrap() {
            row.as_object_mut().unwrap().retain(|key, _| key != "over_db" && key != "parts_ms");
        }
    }
    let read = |report: &Value| serde_json::from_value::<Report>(report.clone()).unwrap();
    assert!(read(&old).papers.unwrap().tables.iter().all(|t| !t.sparse && t.rows[0].over_db.is_none()));
    for entry in old["entries"].as_array_mut().unwrap() {
        entry["temporal"].as_object_mut().map(|temporal| temporal.remove("errors"));
    }
    old.as_object_mut().unwrap().remove("papers");
    assert!(read(&old).papers.is_none() && read(&old).effects.is_some());
}

#[test]
fn moving_frames_have_errors_of_their_own() {
    let (_, report) = whole();
    let errors = |id: &str| &find(report, id)["temporal"]["errors"];
    let db = |id: &str, path: &str| errors(id).pointer(path).and_then(Value::as_f64).unwrap();
    for id in ["single-m1", "fxaa-m1", "smaa-m1", "taa-m1", "msaa4x-m1", "windowed-m2", "full-m2"] {
        for motion in ["/pan", "/turn"] {
            let [mean, worst] = ["psnr_db", "worst_db"].map(|key| db(id, &format!("{motion}/{key}")));
            assert!(worst <= mean + 1e-9 && mean < 60.0, "{id}: {mean} {worst}");
        }
        println!("{id}: still {}, {}", find(report, id)["quality"]["truth"]["psnr_db"], errors(id));
        // Where there is no history both are one view.
        assert_eq!(db(id, "/cut_db") == db(id, "/uncovering_db"), id != "taa-m1", "{id}");
    }
    let still = |id: &str| find(report, id)["quality"]["truth"]["psnr_db"].as_f64().unwrap();
    assert!(still("taa-m1") > still("single-m1") + 3.0, "{} {}", still("taa-m1"), still("single-m1"));
    assert!(db("taa-m1", "/turn/psnr_db") > db("single-m1", "/turn/psnr_db"));
    // A first frame is one of a sample a pixel.
    assert!(db("taa-m1", "/cut_db") < db("taa-m1", "/turn/worst_db"));
    let taa = find(report, "taa-m1");
    assert_eq!((&taa["role"], &taa["technique"]), (&"peer".into(), &"taa".into()));
    let times = |name: &str| taa["passes"].as_array().unwrap().iter().filter(|pass| *pass == name).count();
    assert_eq!((times("taa"), times("first")), (1, 1));

    let msaa = find(report, "msaa4x-m1");
    assert_eq!((&msaa["role"], &msaa["passes"]), (&"peer".into(), &serde_json::json!(["msaa4x"])));
    // Four samples of color and depth, and the resolved color.
    assert_eq!(msaa["memory_bytes"]["gbuffer"], 64 * 36 * (4 * 12 + 8));
    assert!(still("msaa4x-m1") > still("single-m1") + 3.0, "{} {}", still("msaa4x-m1"), still("single-m1"));
}

#[test]
fn curves_and_executions_are_there() {
    let (_, report) = whole();
    let cost = &report["cost"];
    let x = |curve: &str| -> Vec<f64> {
        let points = cost[curve].as_array().unwrap();
        points.iter().map(|p| p["x"].as_f64().unwrap()).collect()
    };
    assert_eq!(x("stall"), [1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
    assert_eq!(x("m"), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(x("lights"), [0.0, 1.0, 4.0, 16.0, 64.0]);
    let (resolution, triangles) = (x("resolution"), x("triangles"));
    assert!(resolution.is_sorted() && resolution.len() == 4 && resolution[3] == 64.0 * 36.0, "{resolution:?}");
    let first = report["triangles"].as_f64().unwrap();
    assert_eq!(triangles, [first, 4.0 * first, 16.0 * first]);
    let executions = report["executions"].as_array().unwrap();
    assert_eq!(executions[0]["execution"], "loop");
    assert!(executions.len() == 6 && executions.iter().all(|e| e["m"] == 2));
    assert_eq!(executions[1]["max_difference"], 0.0);
    // Without timestamps there are no times to look at.
    if find(report, "full-m2")["time_ms"].as_object().unwrap().is_empty() {
        return;
    }
    assert_eq!(executions[0]["relative_to_loop"], 1.0);
    for curve in ["stall", "resolution", "m", "lights", "triangles"] {
        for point in cost[curve].as_array().unwrap() {
            for time in ["full_ms", "single_ms", "windowed_ms", "full_total_ms", "windowed_total_ms"] {
                assert!(point[time].as_f64().unwrap() > 0.0, "{curve}: {point}");
            }
        }
        assert!(cost["fits"][curve]["full_ms"]["exponent"].is_f64(), "{curve}");
    }
    assert!(!report["frontier"]["time"].as_array().unwrap().is_empty());
}

/// From the 8-bit files alone.
fn psnr(a: &RgbImage, b: &RgbImage) -> f64 {
    let squares = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
    let mse = squares.sum::<f64>() / a.as_raw().len() as f64;
    if mse == 0.0 { 200.0 } else { 10.0 * (255.0 * 255.0 / mse).log10() }
}

#[test]
fn psnr_is_that_of_the_written_files() {
    let (folder, report) = whole();
    let (truth, grid) = (folder.image("truth.png"), folder.image("full-m2.png"));
    for entry in entries(report) {
        let image = folder.image(entry["files"]["png"].as_str().unwrap());
        let against = |name: &str| entry["quality"][name]["psnr_db"].as_f64();
        assert!((psnr(&image, &truth) - against("truth").unwrap()).abs() < 1e-9, "{entry}");
        if let Some(db) = against("grid") {
            assert!((psnr(&image, &grid) - db).abs() < 1e-9, "{entry}");
        }
    }
}

#[test]
fn no_entry_of_the_frontier_is_beaten() {
    let (_, report) = whole();
    let point =
        |e: &Value| (e["samples"]["mean_k"].as_f64().unwrap(), -e["quality"]["truth"]["psnr_db"].as_f64().unwrap());
    let frontier: Vec<_> =
        report["frontier"]["samples"].as_array().unwrap().iter().map(|id| id.as_str().unwrap()).collect();
    for entry in entries(report) {
        let (k, error) = point(entry);
        let beaten = entries(report).iter().map(point).any(|(a, b)| a <= k && b <= error && (a, b) != (k, error));
        assert_eq!(frontier.contains(&entry["id"].as_str().unwrap()), !beaten, "{}", entry["id"]);
    }
}

#[test]
fn the_page_holds_the_report_and_its_pictures() {
    let (folder, report) = whole();
    let page = std::fs::read_to_string(folder.out().join("report.html")).unwrap();
    let script = |id: &str| -> Value {
        let (_, rest) = page.split_once(&format!("<script type=\"application/json\" id=\"{id}\">")).unwrap();
        serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
    };
    assert!(&script("report") == report);
    let images = script("images");
    assert!(images["truth"].as_str().unwrap().starts_with("data:image/jpeg;base64,"));
    let shown = images["entries"].as_object().unwrap();
    for id in ["full-m2", "windowed-m2", "windowed-m2-paper", "multiresolution-m2", "single-m1"] {
        assert!(shown[id]["image"].as_str().unwrap().starts_with("data:image/jpeg;base64,"), "{id}");
        assert_eq!(shown[id]["samples"].is_null(), ["full-m2", "single-m1"].contains(&id), "{id}");
    }
    let crops = images["crops"].as_array().unwrap();
    assert_eq!(crops.len(), report["crops"].as_array().unwrap().len());
    for crop in crops {
        assert_eq!(crop["entries"].as_object().unwrap().len(), shown.len());
        assert!(crop["truth"].as_str().unwrap().starts_with("data:image/png;base64,"));
    }
    for marker in ["__CSS__", "__JS__", "__REPORT_JSON__", "__IMAGES_JSON__"] {
        assert!(!page.contains(marker), "{marker}");
    }
}

/// When each file of what is finished was written.
fn finished(folder: &Folder) -> BTreeMap<PathBuf, SystemTime> {
    let files = ["entries", "parts"].iter().flat_map(|kind| std::fs::read_dir(folder.out().join(kind)).unwrap());
    files.map(|f| f.unwrap()).map(|f| (f.path(), f.metadata().unwrap().modified().unwrap())).collect()
}

#[test]
fn resuming_measures_what_is_missing_and_nothing_else() {
    let folder = Folder::new("resume");
    let few = ["--scene", "cornell", "--techniques", "single,windowed"];
    let with = |more: &[&'static str]| succeed(&folder, &[&few[..], more].concat());
    let first = with(&[]);
    assert_eq!(first["truth"]["cached"], false);
    let all = finished(&folder);
    let second = with(&["--resume"]);
    assert_eq!(finished(&folder), all, "nothing was missing");
    assert_eq!(second["truth"]["cached"], true);
    for part in ["entries", "oracles", "executions", "temporal", "frontier", "crops"] {
        assert!(second[part] == first[part], "{part} has changed");
    }

    // As after an interruption.
    let out = folder.out();
    for name in ["entries/windowed-m2.json", "parts/executions.json", "report.json", "report.html", "single-m2.png"] {
        std::fs::remove_file(out.join(name)).unwrap();
    }
    let third = with(&["--resume"]);
    let again = finished(&folder);
    let changed: Vec<_> = again
        .iter()
        .filter(|(path, time)| all.get(*path) != Some(*time))
        .map(|(path, _)| path.file_stem().unwrap().to_str().unwrap())
        .collect();
    assert_eq!(changed, ["single-m2", "windowed-m2", "executions"]);
    let ids = |report: &Value| entries(report).iter().map(|e| e["id"].clone()).collect::<Vec<_>>();
    assert_eq!(ids(&third), ids(&first), "in the order of the plan");
    assert_eq!(find(&third, "windowed-m2")["quality"], find(&first, "windowed-m2")["quality"]);

    // Other options: other results, but the same truth.
    let other = with(&["--resume", "--force", "--stall", "2"]);
    assert_eq!(other["truth"]["cached"], true);
    assert!(
        finished(&folder)
            .iter()
            .filter(|(path, _)| path.starts_with(out.join("entries")))
            .all(|(path, time)| again[path] != *time)
    );
    let unlike = with(&["--resume", "--force", "--stall", "2", "--camera", "0,0,3,0.1,0,-1"]);
    assert_eq!(unlike["truth"]["cached"], false);
}

#[test]
fn without_resume_everything_is_measured_again() {
    let folder = Folder::new("again");
    let few = ["--scene", "cornell", "--techniques", "single"];
    succeed(&folder, &few);
    let first = finished(&folder);
    succeed(&folder, &few);
    assert!(finished(&folder).iter().all(|(path, time)| first[path] != *time));
}

/// What took hours is not lost to a slip in --out.
#[test]
fn a_finished_report_of_something_else_stays() {
    let folder = Folder::new("taken");
    let few = ["--scene", "cornell", "--techniques", "single", "--m", "1"];
    succeed(&folder, &few);
    let before = finished(&folder);
    let other_size = ["--scene", "cornell", "--techniques", "single", "--m", "1", "--size", "32x18"];
    let other_scene = ["--scene", "spheres", "--techniques", "single", "--m", "1"];
    let more = ["--scene", "cornell", "--techniques", "single,full", "--m", "1"];
    for arguments in [&other_size[..], &other_scene, &[&other_size[..], &["--resume"]].concat(), &more] {
        let output = report(&folder, arguments);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains("holds a finished report of `deferred-aa-demo report "), "{stderr}");
        assert!(stderr.contains("name another folder, or replace it with --force"), "{stderr}");
        assert!(finished(&folder) == before, "{arguments:?} has touched it");
    }
    succeed(&folder, &[&other_size[..], &["--force"]].concat());
}

/// Where no bar can be drawn, a line a part says how far it has come.
#[test]
fn progress_is_told_where_there_is_no_terminal() {
    let folder = Folder::new("progress");
    let output = report(&folder, &["--scene", "cornell", "--techniques", "single", "--m", "1"]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    let parts: Vec<_> = stderr.lines().collect();
    assert_eq!((parts.first(), parts.len()), (Some(&"1/5 truth"), 5), "{stderr}");
    assert!(parts[1].starts_with("2/5 m = 1, about ") && parts[1].ends_with(" s to go"), "{stderr}");
    assert!(parts[4].starts_with("5/5 page, about "), "{stderr}");
}

#[test]
fn a_truth_that_has_changed_on_disk_is_rendered_anew() {
    let folder = Folder::new("cache");
    let few = ["--scene", "cornell", "--techniques", "single", "--m", "1"];
    succeed(&folder, &few);
    let truth = folder.image("truth.png");
    let cached = std::fs::read_dir(folder.0.join("cache")).unwrap().map(|f| f.unwrap().path());
    let exr = cached.filter(|p| p.extension().is_some_and(|e| e == "exr")).collect::<Vec<_>>();
    assert_eq!(exr.len(), 1);
    let mut bytes = std::fs::read(&exr[0]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x40;
    std::fs::write(&exr[0], &bytes).unwrap();
    let output = report(&folder, &few);
    assert!(output.status.success());
    assert!(text(&output.stderr).contains("rendered anew"), "{}", text(&output.stderr));
    assert_eq!(folder.json()["truth"]["cached"], false);
    assert_eq!(folder.image("truth.png"), truth);
    assert_eq!(succeed(&folder, &few)["truth"]["cached"], true, "and it is whole again");
}

#[test]
fn places_that_can_not_be_written_are_refused_before_the_work() {
    let folder = Folder::new("places");
    std::fs::write(folder.out(), b"mine").unwrap();
    assert_refused(&report(&folder, &[]), &["--out", "out"]);
    assert_eq!(std::fs::read(folder.out()).unwrap(), b"mine");
    assert!(!folder.0.join("cache").exists(), "no truth was rendered");
    std::fs::remove_file(folder.out()).unwrap();
    std::fs::create_dir(folder.out()).unwrap();
    std::fs::write(folder.out().join("entries"), b"mine").unwrap();
    assert_refused(&report(&folder, &[]), &["entries", "--out"]);
    assert!(!folder.0.join("cache").exists(), "no truth was rendered");
}

#[test]
fn numbers_of_samples_that_the_adapter_lacks_are_named_and_left_out() {
    let folder = Folder::new("samples");
    let output = report(&folder, &["--techniques", "msaa2x,msaa4x,msaa8x"]);
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    let found = folder.json();
    let ids: Vec<_> = entries(&found).iter().map(|entry| entry["id"].as_str().unwrap()).collect();
    assert!(ids.contains(&"msaa4x-m1"), "{ids:?}");
    let lacking = ["msaa2x", "msaa8x"].into_iter().filter(|name| !ids.contains(&format!("{name}-m1").as_str()));
    let lacking: Vec<_> = lacking.collect();
    let why = "left out: this adapter lacks that number of samples a pixel in Rgba16Float or Depth32Float\n";
    let note = match lacking.as_slice() {
        [] => return assert!(!said.contains("left out"), "{said}"),
        [name] => format!("note: {name} is {why}"),
        names => format!("note: {} are {why}", names.join(", ")),
    };
    assert!(said.contains(&note), "{said}");
    for name in lacking {
        let without = format!("nothing to measure without {name}: this adapter lacks");
        assert_refused(&report(&folder, &["--techniques", name]), &["--techniques", &without, "name other techniques"]);
    }
}

#[test]
fn bad_input_is_refused() {
    let folder = Folder::new("bad");
    assert_refused(&report(&folder, &["--techniques", "full,magic"]), &["--techniques", "'magic'", "windowed"]);
    assert_refused(&report(&folder, &["--scene", "fense"]), &["'fense'", "fence"]);
    assert_refused(&report(&folder, &["--set", "windowed.depth=5x"]), &["--set windowed.depth=5x"]);
    assert_refused(&report(&folder, &["--m", "2,9"]), &["--m", "9 is not in 1 to 8"]);
    assert_refused(&report(&folder, &["--m", "1", "--techniques", "full"]), &["--m", "nothing to measure"]);
    assert_refused(&report(&folder, &["--size", "100000x100000"]), &["--out", "MB"]);
    assert_refused(&report(&folder, &["--scene", "mirrors", "--techniques", "msaa4x"]), &["--techniques", "rays"]);
    assert_refused(
        &report(&folder, &["--scene", "mirrors", "--techniques", "msaa8x,msaa2x"]),
        &["msaa2x, msaa8x", "rays"],
    );
    assert!(!Path::new(&folder.out().join("report.json")).exists());
}
