//! report.html as a browser shows it. Needs Chromium; without one the tests say so and pass.
//!
//! The page is the program's own, of a tiny report, or the one that `DEFERRED_AA_REPORT_HTML` names. Some tests put
//! other figures into it first, as a report from elsewhere could hold them.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
const DATA: &str = r#"<script type="application/json" id="report">"#;
/// What a page prints when a value is broken.
const BROKEN: [&str; 5] = ["NaN", "undefined", "Infinity", "null", "[object"];

fn browser() -> Option<&'static Path> {
    static FOUND: OnceLock<Option<PathBuf>> = OnceLock::new();
    let path = FOUND.get_or_init(|| {
        let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
        BROWSERS.iter().flat_map(|name| folders.iter().map(move |f| f.join(name))).find(|p| p.is_file())
    });
    if path.is_none() {
        eprintln!("skipped: none of {} is on PATH", BROWSERS.join(", "));
    }
    path.as_deref()
}

/// The text of a report.html that the program wrote.
fn page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| {
        std::env::var_os("DEFERRED_AA_REPORT_HTML")
            .map_or_else(made_report, |path| std::fs::read_to_string(path).unwrap())
    })
}

fn made_report() -> String {
    let out = folder("report");
    let output = Command::new(env!("CARGO_BIN_EXE_deferred-aa-demo"))
        .args(["report", "--scene", "checker", "--size", "48x27", "--m", "2", "--quick", "--out"])
        .arg(&out)
        .arg("--cache")
        .arg(out.join("cache"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let html = std::fs::read_to_string(out.join("report.html")).unwrap();
    let _ = std::fs::remove_dir_all(&out);
    html
}

/// A folder of this process.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("deferred-aa-page-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// Where the JSON of the report lies in the page.
fn data_range(html: &str) -> std::ops::Range<usize> {
    let from = html.find(DATA).expect("no report in the page") + DATA.len();
    from..from + html[from..].find("</script>").unwrap()
}

fn report(html: &str) -> Value {
    serde_json::from_str(&html[data_range(html)]).unwrap()
}

/// The page with another report in it.
fn with_report(report: &Value) -> String {
    let range = data_range(page());
    let data = report.to_string().replace('<', "\\u003c");
    [&page()[..range.start], &data, &page()[range.end..]].concat()
}

/// The document after its script ran, without scripts, styles and embedded images. `None` without a browser.
fn drawn(name: &str, html: &str, size: &str) -> Option<String> {
    let browser = browser()?;
    let folder = folder(name);
    let file = folder.join("report.html");
    std::fs::write(&file, html).unwrap();
    let output = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-extensions"])
        .args(["--virtual-time-budget=10000", "--dump-dom", &format!("--window-size={size}")])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", file.display()))
        .output()
        .unwrap();
    let _ = std::fs::remove_dir_all(&folder);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let dom = String::from_utf8(output.stdout).unwrap();
    let dom = ["<script", "<style"].iter().zip(["</script>", "</style>"]).fold(dom, |dom, (a, b)| without(&dom, a, b));
    Some(without(&dom, "\"data:", "\""))
}

/// `text` without anything from `open` to the next `close`.
fn without(text: &str, open: &str, close: &str) -> String {
    let mut parts = text.split(open);
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out += part.split_once(close).map_or("", |(_, rest)| rest);
    }
    out
}

/// The opening tags that hold all of `words`.
fn tags<'a>(dom: &'a str, words: &[&str]) -> Vec<&'a str> {
    let tags = dom.split('<').map(|t| t.split('>').next().unwrap_or_default());
    tags.filter(|t| words.iter().all(|w| t.contains(w))).collect()
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    tag.split_once(&format!("{name}=\"")).and_then(|(_, rest)| rest.split('"').next()).unwrap_or_default()
}

/// Whether `word` stands in `text` on its own.
fn has_word(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let after = text[at + word.len()..].chars().next();
        ![before, after].into_iter().flatten().any(|c| c.is_alphanumeric() || c == '_')
    })
}

/// All is drawn, nothing failed, no broken value shows, and the table has a row for each entry.
#[track_caller]
fn assert_sound(dom: &str, report: &Value) {
    assert_eq!(attribute(tags(dom, &["html ", "data-ready"]).first().copied().unwrap_or_default(), "data-ready"), "ok");
    for word in BROKEN {
        let at = dom.find(word).unwrap_or_default();
        let around = dom.get(at.saturating_sub(200)..dom.len().min(at + 100)).unwrap_or(word);
        assert!(!has_word(dom, word), "{word} in …{around}…");
    }
    let entries = report["entries"].as_array().map_or(0, Vec::len);
    assert_eq!(tags(dom, &["tr ", "data-id"]).len(), entries);
    assert_eq!(tags(dom, &["data-plot=\"time\""]).len(), plotted(report));
}

fn median(entry: &Value) -> Option<f64> {
    entry["time_ms"]["total"]["median"].as_f64().filter(|&ms| ms > 0.0)
}

/// Entries with a time and an error against the truth, or against the grid where nothing has one against the truth.
fn plotted(report: &Value) -> usize {
    let Some(entries) = report["entries"].as_array() else { return 0 };
    let has = |e: &Value, against: &str| e["quality"][against]["psnr_db"].is_number();
    let against = if entries.iter().any(|e| has(e, "truth")) { "truth" } else { "grid" };
    entries.iter().filter(|e| median(e).is_some() && has(e, against)).count()
}

/// An entry made of the report's first, so that it has every field that the program writes.
fn entry(id: &str, technique: &str, role: &str, psnr_db: f64, total: f64) -> Value {
    let mut entry = report(page())["entries"][0].clone();
    let quality = json!({"psnr_db": psnr_db, "edge_psnr_db": psnr_db - 6.0, "rmse_linear": 0.01, "ssim": 0.9,
        "flip_mean": 0.02, "flip_p99": 0.2});
    let spread = json!({"min": total, "median": total, "p95": total});
    let changes = json!({"id": id, "label": id, "technique": technique, "role": role, "preset": null, "m": 4,
        "time_ms": {"gbuffer": spread, "node": spread, "total": spread}, "quality": {"truth": quality, "grid": quality}});
    entry.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
    entry
}

/// Full and Windowed at 10 and 6 ms, nearly alike; Single at 1 ms; a peer of `peer_db` at 1.2 ms.
fn small_report(peer_db: f64) -> Value {
    let mut report = report(page());
    report["entries"] = json!([
        entry("Full", "full", "technique", 40.0, 10.0),
        entry("Windowed", "windowed", "technique", 39.5, 6.0),
        entry("Single", "single", "technique", 26.0, 1.0),
        entry("SMAA", "smaa", "peer", peer_db, 1.2),
    ]);
    report["frontier"] = json!({"time": [], "samples": []});
    report["unfinished"] = json!([]);
    report
}

fn sentences(dom: &str) -> String {
    let list = dom.split("id=\"sentences\"").nth(1).unwrap().split("</ol>").next().unwrap();
    without(&format!("<ol{list}"), "<", ">").replace('\u{a0}', " ").replace("&nbsp;", " ")
}

#[test]
fn the_page_shows_every_entry() {
    for (name, size) in [("desktop", "1280,900"), ("phone", "500,900")] {
        let Some(dom) = drawn(name, page(), size) else { return };
        let report = report(page());
        assert!(!report["entries"].as_array().unwrap().is_empty());
        assert_sound(&dom, &report);
        if report["truth"].is_object() {
            assert_eq!(bright(&dom), frontier(&report));
        }
        let motion = dom.split("id=\"motion\"").nth(1).unwrap().split("</section>").next().unwrap();
        for words in ["TAA is the only one with a history", "What shimmers", "First after a cut", "Uncovering"] {
            assert!(motion.contains(words), "{words:?} is not in {motion}");
        }
    }
}

/// Ids of the points in the first plot that are not faint, goals left out, in order.
fn bright(dom: &str) -> Vec<&str> {
    let points = tags(dom, &["data-plot=\"time\""]).into_iter();
    let mut ids: Vec<_> =
        points.filter(|t| !t.contains("dominated") && !t.contains("k-goal")).map(|t| attribute(t, "data-id")).collect();
    ids.sort_unstable();
    ids
}

/// The same from the report.
fn frontier(report: &Value) -> Vec<&str> {
    let entries = report["entries"].as_array().unwrap();
    let is_goal = |id: &str| entries.iter().any(|e| e["id"] == id && e["role"] == "goal");
    let ids = report["frontier"]["time"].as_array().unwrap();
    let mut ids: Vec<_> = ids.iter().filter_map(Value::as_str).filter(|id| !is_goal(id)).collect();
    ids.sort_unstable();
    ids
}

#[test]
fn the_page_says_what_is_missing() {
    let mut bare = report(page());
    for entry in bare["entries"].as_array_mut().unwrap() {
        entry["time_ms"] = json!({});
        for field in ["grid", "truth"] {
            entry["quality"][field] = Value::Null;
        }
        for field in ["oracle", "temporal", "samples", "memory_bytes", "settings", "preset", "m"] {
            entry[field] = Value::Null;
        }
    }
    for field in [
        "truth",
        "cost",
        "executions",
        "goals",
        "oracles",
        "papers",
        "crops",
        "triangles",
        "lights",
        "adapter",
        "frontier",
    ] {
        bare[field] = Value::Null;
    }
    bare["unfinished"] = json!(["full-m4"]);
    let Some(dom) = drawn("bare", &with_report(&bare), "1280,900") else { return };
    assert_sound(&dom, &bare);
    assert!(sentences(&dom).contains("Nothing yet"), "{}", sentences(&dom));
    assert!(dom.contains("Unfinished: 1 planned entry was not measured"));
}

#[test]
fn the_page_shows_the_papers_tables() {
    let Some(dom) = drawn("papers", page(), "1280,900") else { return };
    let tables = report(page())["papers"]["tables"].as_array().unwrap().clone();
    let section = dom.split("id=\"papers\"").nth(1).unwrap().split("</section>").next().unwrap();
    for table in &tables {
        assert!(section.contains(table["title"].as_str().unwrap()));
        for row in table["rows"].as_array().unwrap() {
            assert!(section.contains(row["label"].as_str().unwrap()), "{}", row["label"]);
        }
    }
    assert!(section.contains("Fairy Forest, printed") && section.contains("46.7&nbsp;dB"), "{section}");
    assert!(!tags(section, &["class=\"line dashed\""]).is_empty(), "the paper's curves");
    assert!(section.contains("PSNR to Every pixel once") && section.contains("144.1&nbsp;fps"), "{section}");
    assert!(section.contains("Decisions, ms"), "{section}");
}

#[test]
fn the_page_recommends_what_is_as_good_and_cheaper() {
    let report = small_report(30.0);
    let Some(dom) = drawn("cheaper", &with_report(&report), "1280,900") else { return };
    assert_sound(&dom, &report);
    // 10^(-39.5/20) = 0.01059 is 6 % above 10^(-40/20).
    let words = "Windowed (m = 4): an error of 0.0106 against the truth, 6 % above Full (m = 4), for 0.60× its time";
    assert!(sentences(&dom).contains(words), "{words:?} is not in {:?}", sentences(&dom));
}

#[test]
fn the_page_says_plainly_where_a_peer_is_better() {
    // 30 dB in 1.2 ms: nothing adaptive is as fast. 20 dB: worse than Single's 26.
    for (db, words) in [(30.0, "SMAA is better in its time"), (20.0, "SMAA buys nothing here")] {
        let report = small_report(db);
        let Some(dom) = drawn("peer", &with_report(&report), "1280,900") else { return };
        assert_sound(&dom, &report);
        assert!(sentences(&dom).contains(words), "{words:?} is not in {:?}", sentences(&dom));
    }
}

/// Advice that rests on times which waver is none, and the page says what to do.
#[test]
fn unsteady_times_bear_no_verdict() {
    let mut report = small_report(20.0);
    report["entries"][1]["time_ms"]["total"] = json!({"min": 4.0, "median": 6.0, "p95": 12.4});
    let Some(dom) = drawn("unsteady", &with_report(&report), "1280,900") else { return };
    assert_sound(&dom, &report);
    let list = dom.split("id=\"sentences\"").nth(1).unwrap().split("</ol>").next().unwrap();
    assert!(!list.contains("<strong>"), "{list}");
    let words = "The slowest frames of Windowed (m = 4) took 3.1× as long as its fastest. What follows is no advice";
    assert!(sentences(&dom).contains(words), "{words:?} is not in {:?}", sentences(&dom));
    assert_eq!(tags(&dom, &["line ", "spread loose"]).len(), 2, "one in the plot and one in its legend");

    // A fit that explains little says nothing of where a curve crosses.
    let mut report = small_report(20.0);
    let row = |x: f64, windowed: f64| {
        json!({"x": x, "full_ms": 10.0, "single_ms": 1.0, "windowed_ms": windowed, "full_total_ms": 10.0 * x,
            "single_total_ms": 2.0, "windowed_total_ms": windowed})
    };
    let fit = |r2: f64| json!({"stall": {"windowed_total_ms": {"exponent": 0.5, "r2": r2}, "full_total_ms": {"exponent": 1.0, "r2": 1.0}}});
    for (r2, words) in [(0.3, "scatter too much to say"), (0.95, "From 2 light loops a sample on")] {
        let mut cost = report["cost"].clone();
        cost["stall"] = json!([row(1.0, 12.0), row(4.0, 14.0), row(8.0, 11.0)]);
        cost["crossover_stall"] = json!(2.0);
        cost["fits"] = fit(r2);
        report["cost"] = cost;
        let Some(dom) = drawn("scatter", &with_report(&report), "1280,900") else { return };
        assert_sound(&dom, &report);
        assert!(sentences(&dom).contains(words), "{words:?} is not in {:?}", sentences(&dom));
    }
}

/// What is to be had in the time of supersampling with fewer samples.
#[test]
fn the_page_compares_at_equal_time_too() {
    for (fast_db, words) in [
        (38.0, "In the time of Full 2 (m = 2) Fast (m = 4) has the lower error: 0.0126 against 0.0200"),
        (
            30.0,
            "In the time of Full 2 (m = 2) it is the best: the nearest adaptive entry, Fast (m = 4), has an error of 0.0316 against 0.0200",
        ),
    ] {
        let mut report = small_report(30.0);
        report["adapter"]["software"] = json!(true);
        let mut full = entry("Full 2", "full", "technique", 33.98, 4.0);
        full["m"] = json!(2);
        let entries = report["entries"].as_array_mut().unwrap();
        entries.extend([full, entry("Fast", "windowed", "technique", fast_db, 3.9)]);
        let Some(dom) = drawn("equal-time", &with_report(&report), "1280,900") else { return };
        assert_sound(&dom, &report);
        assert!(sentences(&dom).contains(words), "{words:?} is not in {:?}", sentences(&dom));
    }
}

#[test]
fn names_never_become_markup() {
    let mut report = small_report(30.0);
    let evil = "</script><img src=x onerror=\"document.documentElement.dataset.ready='run'\">";
    report["scene"] = json!(evil);
    report["command"] = json!(evil);
    report["entries"][1]["label"] = json!(evil);
    let Some(dom) = drawn("evil", &with_report(&report), "1280,900") else { return };
    assert_sound(&dom, &report);
    assert!(tags(&dom, &["img src=\"x\""]).is_empty());
}
