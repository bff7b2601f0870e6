//! The binary as its user meets it: what it writes, and what it says of bad input.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of this test's own, empty, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("deferred-aa-commands-{}-{name}", std::process::id()));
        // Tests run beside each other: a name that two of them took would be shared.
        std::fs::create_dir(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str, bytes: &[u8]) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).unwrap();
        path.display().to_string()
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn demo(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deferred-aa-demo"));
    command.args(arguments);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Exit code 2 and one line on stderr, which holds all of `words`; nothing on stdout, nothing of a panic.
#[track_caller]
fn assert_refused(output: &Output, words: &[&str]) {
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(2), "{stdout}{stderr}");
    assert_eq!(stdout, "", "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "not one line: {stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "{word:?} is not in {stderr:?}");
    }
}

/// A tiny `render` with these arguments on top.
fn render(folder: &Folder, arguments: &[&str]) -> Output {
    let out = folder.path("out");
    let all = [&["render", "--size", "32x18", "--m", "2", "--out", &out], arguments].concat();
    demo(&all).output().unwrap()
}

#[track_caller]
fn refused(arguments: &[&str], words: &[&str]) {
    let folder = Folder::new(&words.join("").replace(|c: char| !c.is_ascii_alphanumeric(), ""));
    let output = demo(&[&["render", "--out", &folder.path("out")], arguments].concat()).output().unwrap();
    assert_refused(&output, words);
    // Nothing half done is left.
    assert!(!folder.0.join("out/image.png").exists());
}

#[test]
fn scenes_that_are_not_there() {
    refused(&["--scene", "atriun"], &["'atriun'", "did you mean atrium?", "checker", ".gltf"]);
    refused(&["--scene", "void"], &["no built-in scene 'void': choose atrium"]);
    refused(&["--scene", "no such.gltf"], &["no such.gltf", "check the path"]);
    refused(&["--scene", "no/such.glb"], &["no/such.glb", "check the path"]);
}

#[test]
fn files_that_are_no_scenes() {
    let folder = Folder::new("files");
    // The header promises a kilobyte.
    let truncated =
        [&b"glTF"[..], &2u32.to_le_bytes(), &1000u32.to_le_bytes(), &500u32.to_le_bytes(), b"JSON{}"].concat();
    refused(&["--scene", &folder.file("cut.glb", &truncated)], &["cut.glb", "export or download it again"]);
    refused(&["--scene", &folder.file("half.glb", b"glT")], &["half.glb", "export or download it again"]);
    refused(&["--scene", &folder.file("void.glb", b"")], &["void.glb", "export or download it again"]);
    refused(&["--scene", &folder.file("void.gltf", b"{}")], &["void.gltf", "export or download it again"]);
    refused(&["--scene", &folder.file("lines.gltf", b"{\n\n\"a\n")], &["lines.gltf", "export or download it again"]);
    refused(&["--scene", &folder.0.display().to_string()], &["it is a folder, not a file", "check the path"]);
    let png = [&b"\x89PNG\r\n\x1a\n"[..], &[0; 20]].concat();
    refused(&["--scene", &folder.file("shot.gltf", &png)], &["shot.gltf: not glTF but a PNG image; name a .gltf"]);
    refused(
        &["--scene", &folder.file("a.glb", b"PK\x03\x04...")],
        &["a.glb: not glTF but a ZIP archive; name a .gltf"],
    );
    let old = folder.file("old.gltf", br#"{"asset":{"version":"1.0"}}"#);
    refused(&["--scene", &old], &["old.gltf", "1.0", "convert it"]);
    let one = folder.file("one.gltf", br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[]}]}"#);
    refused(&["--scene", &one, "--scene-index", "7"], &["one.gltf", "no scene 7", "has 1", "smaller"]);
}

#[test]
fn sizes() {
    for size in ["0x5", "5x0", "5", "x", "5x5x5", "1e3x5", "99999999999x5", ""] {
        refused(&["--size", size], &["--size", "WIDTHxHEIGHT"]);
    }
    refused(&["--size", "-1x5"], &["-1"]);
    refused(&["--scene", "empty", "--size", "100000x100000"], &["100000×100000 at m = 4", "lower --m or --size"]);
    refused(&["--scene", "empty", "--size", "4294967295x4294967295"], &["4294967295", "lower --m or --size"]);
    refused(&["--scene", "empty", "--memory", "1.5GB"], &["'1.5GB' is not a number of bytes", "512MB"]);
    refused(&["--scene", "empty", "--memory", "2KB"], &["within 2000 bytes", "allow at least"]);
}

#[test]
fn numbers_out_of_range() {
    refused(&["--m", "0"], &["--m", "0 is not in 1 to 8"]);
    refused(&["--m", "9"], &["--m", "9 is not in 1 to 8"]);
    refused(&["--m", "two"], &["'two'", "--m"]);
    refused(&["--m", "-1"], &["-1"]);
    refused(&["--anisotropy", "0"], &["--anisotropy", "1 to 16"]);
    refused(&["--anisotropy", "17"], &["--anisotropy", "1 to 16"]);
    refused(&["--stall", "0"], &["--stall", "1 or more"]);
    refused(&["--frames", "-3"], &["-3"]);
}

#[test]
fn techniques_and_settings() {
    refused(
        &["--technique", "magic"],
        &["no technique 'magic': choose full, single, windowed, reconstructed, selective, multiresolution or surfaces"],
    );
    refused(
        &["--technique", "windwed"],
        &[
            "no technique 'windwed': did you mean windowed? choose full, single, windowed, reconstructed, selective, multiresolution or surfaces",
        ],
    );
    refused(
        &["--preset", "fsat"],
        &["no preset 'fsat': did you mean fast? choose fast, balanced or quality, or once of surfaces"],
    );
    refused(&["--textures", "none"], &["'none'", "arrays"]);
    refused(
        &["--set", "windowed.depht_scale=1"],
        &["--set windowed.depht_scale=1", "'depht_scale'", "did you mean windowed.depth_scale?", "choose"],
    );
    refused(&["--set", "weights=1"], &["'weights'", "did you mean weight?", "choose"]);
    refused(&["--set", "windowed.depth_scale"], &["key=value"]);
    refused(&["--set", "windowed.depth_scale=-1"], &["windowed.depth_scale", "must lie in 0 to"]);
    refused(&["--set", "execution=warp"], &["execution=warp", "loop", "tiled"]);
    refused(&["--set", "windowed=1"], &["group of settings"]);
}

/// Mistakes that people make, and what they are told, word for word.
#[test]
fn answers() {
    let folder = Folder::new("answers");
    let out = folder.path("out");
    for (arguments, answer) in [
        (
            "render --technique selective --preset fast",
            "--preset: selective: the presets are settings of windowed and surfaces: leave it out, or use one of these",
        ),
        (
            "render --preset once",
            "--preset: windowed: 'once' is a setting of surfaces: add --technique surfaces, or choose another",
        ),
        ("render --set windowed.luminance=5", "--set windowed.luminance=5: no choice '5': choose linear, perceptual"),
        (
            "render --set windowed.luminance=perceptul",
            "--set windowed.luminance=perceptul: no choice 'perceptul': did you mean perceptual? choose linear, perceptual",
        ),
        ("render --set windowed.two_sided=2", "--set windowed.two_sided=2: '2' is neither on nor off"),
        ("render --set windowed.depth_scale=far", "--set windowed.depth_scale=far: 'far' is not a number"),
        (
            "render --set windowed.tile_limit=1.5",
            "--set windowed.tile_limit=1.5: '1.5' is not a whole number of 0 or more",
        ),
        (
            "render --set execution=sort",
            "--set execution=sort: no choice 'sort': did you mean sorted? choose loop, tiled, bucketed, sorted, max_filtered, packed",
        ),
        (
            "render --scene atriun",
            "no built-in scene 'atriun': did you mean atrium? choose atrium, fence, checker, spheres, cornell, shadows, mirrors, flat, empty or a .gltf or .glb file",
        ),
        (
            "render --scene cornell --scene-index 1",
            "--scene-index 1: the built-in scene 'cornell' is a single one; leave it out",
        ),
        ("render --goal error=0.01 --technique full", "--goal: 'full' has nothing to scale: use windowed or surfaces"),
        (
            "demo --scene atriun",
            "no built-in scene 'atriun': did you mean atrium? choose atrium, fence, checker, spheres, cornell, shadows, mirrors, flat, empty or a .gltf or .glb file",
        ),
        ("report --m 9", "--m: 9 is not in 1 to 8"),
        (
            "report --techniques windowed,taa2",
            "--techniques: no technique 'taa2': did you mean taa? choose full, single, windowed, reconstructed, selective, multiresolution, surfaces, fxaa, smaa, taa, msaa2x, msaa4x, msaa8x",
        ),
        ("tune --m 1", "--m: 1 is not in 2 to 8"),
        ("bench --minutes 0", "--minutes: 0 is not a time: more than 0"),
        ("bench --minutes nan", "--minutes: NaN is not a time: more than 0"),
    ] {
        let arguments: Vec<_> = arguments.split(' ').chain(["--out", &out]).collect();
        let output = demo(&arguments).output().unwrap();
        assert_refused(&output, &[]);
        assert_eq!(text(&output.stderr), format!("error: {answer}\n"), "{arguments:?}");
    }
    let view = |arguments: &[&str]| text(&demo(&[&["view"], arguments].concat()).output().unwrap().stderr);
    let unknown = "error: no built-in scene 'nosuch': choose atrium, fence, checker, spheres, cornell, shadows, mirrors, flat, \
                   empty or a .gltf or .glb file\n";
    assert_eq!([view(&["nosuch"]), view(&["--scene", "nosuch"])], [unknown; 2]);
    // What clap says ends in a hint to --help.
    for command in ["render", "demo", "report", "bench"] {
        let output = demo(&[command, "--frames", "0", "--out", &out]).output().unwrap();
        assert_refused(&output, &[]);
        let answer = "error: invalid value '0' for '--frames <FRAMES>': 0 is not in 1..=10000; see --help\n";
        assert_eq!(text(&output.stderr), answer, "{command}");
    }
    for (arguments, answer) in [
        (
            &["render", "--size", "320"][..],
            "error: invalid value '320' for '--size <SIZE>': '320' is not a size: write WIDTHxHEIGHT in pixels, such as 1024x768; see --help\n",
        ),
        (
            &["render", "--memory", "much"],
            "error: invalid value 'much' for '--memory <BYTES>': 'much' is not a number of bytes: write one with a unit, such as 512MB or 2GiB; see --help\n",
        ),
        (
            &["render", "--camera", "1,2"],
            "error: invalid value '1,2' for '--camera <CAMERA>': '1,2' is not a camera: write x,y,z,tx,ty,tz or x,y,z,tx,ty,tz,fov; see --help\n",
        ),
        (&["paint"], "error: unrecognized subcommand 'paint'; see --help\n"),
        (&["rendr"], "error: unrecognized subcommand 'rendr'; see --help\n"),
    ] {
        let mut command = demo(arguments);
        if arguments.len() > 1 {
            command.args(["--out", &out]);
        }
        let output = command.output().unwrap();
        assert_refused(&output, &[]);
        assert_eq!(text(&output.stderr), answer, "{arguments:?}");
    }
}

/// Every technique beside the peers, against the truth.
#[test]
fn the_demo_compares_on_one_view() {
    let folder = Folder::new("demo");
    let out = folder.path("out");
    let output = demo(&[
        "demo",
        "--scene",
        "cornell",
        "--set",
        "shadows=off",
        "--size",
        "64x48",
        "--m",
        "3",
        "--frames",
        "1",
        "--out",
        &out,
    ])
    .output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let of = |name: &str| -> Value {
        serde_json::from_slice(&std::fs::read(folder.0.join(format!("out/{name}.json"))).unwrap()).unwrap()
    };
    let db = |name: &str| of(name)["quality"]["truth"]["psnr_db"].as_f64().unwrap();
    assert!(db("full") > db("windowed") && db("windowed") > db("none") + 6.0, "{} {}", db("windowed"), db("none"));
    for name in ["surfaces", "surfaces-once"] {
        assert!(db(name) > db("smaa").max(db("fxaa")), "{name}");
    }
    let samples = of("surfaces-once")["samples"].clone();
    assert_eq!(samples["taps"], samples["shaded"]);
    assert_eq!((&of("none")["m"], &of("smaa")["m"], &of("full")["m"]), (&1.into(), &1.into(), &3.into()));
    let stdout = text(&output.stdout);
    for row in ["\nNo AA ", "\nFXAA ", "\nSMAA 1x ", "\nWindowed ", "\nSurfaces, once ", "\nSurfaces ", "\nFull "] {
        assert!(stdout.contains(row), "{row:?} is not in {stdout}");
    }
    for name in ["strip.png", "crops.png", "samples.png", "truth.png", "none.png", "full.exr"] {
        assert!(folder.0.join("out").join(name).exists(), "{name}");
    }
}

/// The standing figures of a tiny picture, which end with the time.
#[test]
fn a_bench_ends_in_time_and_says_what_it_left_out() {
    let folder = Folder::new("bench");
    let out = folder.path("bench.json");
    let bench = || demo(&["bench", "--size", "16x9", "--minutes", "0.001", "--out", &out]).output().unwrap();
    let output = bench();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stdout = text(&output.stdout);
    for words in ["16×9", "atrium, m = 1, stall 1", "over Full of the same m", "not measured for lack of time: "] {
        assert!(stdout.contains(words), "{words:?} is not in {stdout}");
    }
    let figures: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    let measured = figures["measured"].as_array().unwrap();
    let row = &measured[0]["rows"][0];
    assert_eq!((&row["label"], &row["k"], &row["not_finite"]), (&"Single".into(), &1.0.into(), &0.into()));
    assert!(row["wall_ms"]["median"].as_f64().unwrap() > 0.0);
    let left_out = figures["left_out"].as_array().unwrap();
    assert!(measured.len() + left_out.len() > 30 && !left_out.is_empty());
    // Again, over its own file but over no other.
    assert!(bench().status.success());
    std::fs::write(&out, b"{}").unwrap();
    assert_refused(&bench(), &["--out", "bench.json is there and is no bench.json: name another file"]);
    assert_eq!(std::fs::read(&out).unwrap(), b"{}");
}

#[test]
fn cameras() {
    for camera in ["1,2,3", "1,2,3,4,5", "1,2,3,4,5,6,7,8", "a,b,c,d,e,f", "1,2,3,4,5,nan", "inf,0,0,0,0,0", ""] {
        refused(&["--camera", camera], &["--camera", "x,y,z,tx,ty,tz"]);
    }
    refused(&["--camera", "1,2,3,1,2,3"], &["--camera", "move the target"]);
    for fov in ["0", "-60", "171", "360"] {
        refused(&["--camera", &format!("0,0,5,0,0,0,{fov}")], &["--camera", "1 to 170 degrees"]);
    }
}

#[test]
fn places_to_write_to() {
    let folder = Folder::new("out");
    let taken = folder.file("taken", b"mine");
    for out in [&taken, &folder.path("taken/deeper")] {
        let output = demo(&["render", "--scene", "empty", "--size", "8x8", "--m", "1", "--out", out]).output().unwrap();
        assert_refused(&output, &["taken", "--out"]);
    }
    assert_eq!(std::fs::read(&taken).unwrap(), b"mine");
    let output = demo(&["render", "--scene", "empty"]).output().unwrap();
    assert_refused(&output, &["--out"]);
}

#[test]
fn adapters_that_are_not_there() {
    refused(&["--scene", "empty", "--adapter", "Voodoo 2"], &["no adapter has 'Voodoo 2' in its name; there is "]);
}

#[test]
fn without_a_driver_one_line_says_what_to_install() {
    let folder = Folder::new("no driver");
    let nowhere = |arguments: &[&str]| {
        demo(arguments)
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .env("VK_DRIVER_FILES", "/nonexistent")
            .env_remove("VK_ADD_DRIVER_FILES")
            .output()
            .unwrap()
    };
    let output = nowhere(&["render", "--scene", "empty", "--size", "8x8", "--out", &folder.path("out")]);
    if cfg!(target_os = "linux") {
        assert_refused(&output, &["no graphics adapter", "mesa-vulkan-drivers"]);
        let output = nowhere(&["adapters"]);
        assert!(output.status.success() && text(&output.stdout).contains("no graphics adapter"));
    }
}

#[test]
fn unknown_arguments() {
    let output = demo(&[]).output().unwrap();
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    for command in ["render", "demo", "report", "bench", "tune", "view", "shaders", "adapters"] {
        assert!(stderr.contains(&format!("\n  {command} ")), "{command} is not in {stderr}");
    }
    assert_refused(&demo(&["paint"]).output().unwrap(), &["'paint'", "--help"]);
    assert_refused(&demo(&["render", "--sceen", "empty"]).output().unwrap(), &["--sceen", "--help"]);
}

#[test]
fn help_and_adapters() {
    for arguments in [
        &["--help"][..],
        &["render", "--help"],
        &["demo", "--help"],
        &["tune", "--help"],
        &["--version"],
        &["adapters"],
    ] {
        let output = demo(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
        assert!(!output.stdout.is_empty() && output.stderr.is_empty(), "{arguments:?}");
    }
    let adapters = text(&demo(&["adapters"]).output().unwrap().stdout);
    for word in ["texture arrays: yes", "texture bindings:", "timestamps:", "m = 4"] {
        assert!(adapters.contains(word), "{word:?} is not in {adapters}");
    }
}

/// Every field of measuring.md, present or null.
fn assert_stats(stats: &Value, technique: &str) {
    let place = |path: &str| {
        path.split('.')
            .fold(stats, |at, key| at.get(key).unwrap_or_else(|| panic!("stats.json lacks {path}: {stats:#}")))
    };
    assert_eq!((place("width"), place("height"), place("m")), (&32.into(), &18.into(), &2.into()));
    assert_eq!((place("scene"), place("technique"), place("stall")), (&"cornell".into(), &technique.into(), &1.into()));
    assert_eq!(place("settings.technique"), &Value::from(technique));
    for text in ["adapter.name", "adapter.driver", "adapter.backend"] {
        assert!(place(text).as_str().is_some_and(|t| !t.is_empty()), "{text}");
    }
    let shaded = place("samples.shaded").as_u64().unwrap();
    let ratio = place("samples.ratio").as_f64().unwrap();
    let mean_k = place("samples.mean_k").as_f64().unwrap();
    let histogram: Vec<u64> =
        place("samples.histogram_k").as_array().unwrap().iter().map(|v| v.as_u64().unwrap()).collect();
    assert_eq!(histogram.len(), 4);
    assert_eq!(histogram.iter().sum::<u64>(), 32 * 18);
    assert_eq!((1..).zip(&histogram).map(|(k, windows)| k * windows).sum::<u64>(), shaded);
    assert!((ratio - shaded as f64 / (4.0 * 32.0 * 18.0)).abs() < 1e-9 && (mean_k - 4.0 * ratio).abs() < 1e-9);
    // Its lamp casts shadows, for which `probe` casts at most three rays a window besides; nothing in it mirrors.
    let shadow = place("rays.shadow").as_u64().unwrap();
    let probes = if technique == "windowed" { 3 * 32 * 18 } else { 0 };
    assert!(shadow > 0 && shadow <= shaded + probes, "{shadow}");
    for kind in ["reflection", "refraction", "without_room", "primary"] {
        assert_eq!(place("rays")[kind], 0, "{kind}");
    }
    assert!(place("memory_bytes.rays").as_u64().unwrap() > 0);
    for part in ["gbuffer", "scratch", "rays"] {
        assert!(place("memory_bytes")[part].is_u64(), "{part}");
    }
    place("memory_bytes.peak");
    for measure in ["psnr_db", "edge_psnr_db", "rmse_linear", "ssim", "flip_mean", "flip_p99"] {
        assert!(place("quality.grid").get(measure).is_some(), "{measure}");
    }
    place("quality.truth");
    let passes: Vec<&str> = place("passes").as_array().unwrap().iter().map(|v| v.as_str().unwrap()).collect();
    let expected: &[&str] = match technique {
        "single" => &["classify", "trace first", "first", "resolve"],
        "full" => &["classify", "trace", "shade", "resolve"],
        _ => &[
            "classify",
            "trace first",
            "probe",
            "first",
            "metrics",
            "plan",
            "places",
            "trace",
            "list",
            "shade",
            "resolve",
        ],
    };
    assert_eq!(passes, expected);
    let times = place("time_ms").as_object().unwrap();
    // Empty where the adapter has no timestamps.
    if !times.is_empty() {
        for name in passes.into_iter().chain(["gbuffer", "total"]) {
            let of = |key: &str| times[name][key].as_f64().unwrap_or_else(|| panic!("time_ms.{name}.{key}"));
            assert!(0.0 <= of("min") && of("min") <= of("median") && of("median") <= of("p95"), "{name}");
        }
    }
}

#[test]
fn a_render_writes_all_it_should() {
    for technique in ["windowed", "single", "full"] {
        let folder = Folder::new(technique);
        let output = render(&folder, &["--scene", "cornell", "--technique", technique, "--frames", "3"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let out = folder.0.join("out");
        let mut names: Vec<_> = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["image.exr", "image.png", "samples.png", "stats.json"]);

        let exr = image::open(out.join("image.exr")).unwrap().into_rgb32f();
        assert_eq!(exr.dimensions(), (32, 18));
        assert!(exr.as_raw().iter().all(|c| c.is_finite() && *c >= 0.0) && exr.as_raw().iter().any(|&c| c > 0.5));
        let png = image::open(out.join("image.png")).unwrap().into_rgb8();
        assert_eq!(png.dimensions(), (32, 18));
        // The same picture: what is bright in one is bright in the other.
        let brightest =
            |values: Vec<f32>| values.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
        let sums = brightest(exr.pixels().map(|p| p.0.iter().sum()).collect());
        let shown: Vec<u32> = png.pixels().map(|p| p.0.iter().map(|&c| u32::from(c)).sum()).collect();
        assert_eq!(Some(&shown[sums]), shown.iter().max());
        assert_eq!(image::open(out.join("samples.png")).unwrap().to_rgb8().dimensions(), (32, 18));

        let stats: Value = serde_json::from_slice(&std::fs::read(out.join("stats.json")).unwrap()).unwrap();
        assert_stats(&stats, technique);
        if technique == "full" {
            assert_eq!(stats["samples"]["ratio"], 1.0);
            assert_eq!(stats["quality"]["grid"]["rmse_linear"], 0.0);
        }
    }
}

#[test]
fn without_a_reference_quality_is_null() {
    let folder = Folder::new("no reference");
    let output = render(&folder, &["--scene", "cornell", "--no-reference"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let stats: Value = serde_json::from_slice(&std::fs::read(folder.0.join("out/stats.json")).unwrap()).unwrap();
    assert!(stats["quality"]["grid"].is_null());
}

/// The picture that a view gives.
fn picture(name: &str, arguments: &[&str]) -> Vec<u8> {
    let folder = Folder::new(name);
    let output = render(&folder, &[&["--scene", "cornell", "--no-reference"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    std::fs::read(folder.0.join("out/image.exr")).unwrap()
}

#[test]
fn cameras_may_stand_at_negative_places() {
    let own = picture("own", &[]);
    let front = picture("front", &["--camera", "0,0,3.9,0,0,0,38"]);
    let left = picture("left", &["--camera", "-0.5,-0.25,2.5,0.1,-0,-1"]);
    let left_too = picture("left too", &["--camera=-0.5,-0.25,2.5,0.1,0,-1,60"]);
    assert!(own != left && left == left_too, "a camera that begins with a minus");
    assert!(own == front, "the scene's own camera, spelled out");
}

#[test]
fn settings_reach_the_frame() {
    let image = picture("image", &[]);
    let counts = picture("counts", &["--set", "view=count"]);
    let loops = picture("loops", &["--set", "execution=loop"]);
    let fast = picture("fast", &["--preset", "fast"]);
    assert!(fast != image && picture("balanced", &["--preset", "balanced"]) == image);
    // What is set counts, whatever the preset.
    let all = ["windowed.luminance_scale=1e6", "windowed.luminance_min=0", "windowed.luminance_edge=0"];
    let all: Vec<&str> = all.iter().flat_map(|s| ["--set", s]).collect();
    assert!(picture("fast but", &[&["--preset", "fast"], &all[..]].concat()) != fast);
    let off = ["windowed.depth_scale=0", "windowed.normal_scale=0", "windowed.luminance_scale=0"];
    let off: Vec<&str> = off.iter().flat_map(|s| ["--set", s]).collect();
    let off = picture("off", &off);
    assert!(counts != image && off != image);
    assert_eq!(loops.len(), image.len());
}

#[test]
fn samples_that_share_rays_are_named() {
    let folder = Folder::new("share");
    let said = |room: &str| {
        let set = format!("ray_samples={room}");
        let output = render(&folder, &["--scene", "shadows", "--frames", "1", "--no-reference", "--set", &set]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    assert!(said("0").contains("no room for their own: --set ray_samples=3 keeps all"), "{}", said("0"));
    assert!(!said("3").contains("no room"), "{}", said("3"));
}

#[test]
fn a_file_of_settings_reaches_the_frame_or_is_refused() {
    let folder = Folder::new("settings");
    let file = folder.file("s.json", br#"{"version": 1, "settings": {"technique": "full", "view": "count"}}"#);
    let image = picture("by arguments", &["--technique", "full", "--set", "view=count"]);
    assert!(picture("by a file", &["--settings", &file]) == image);
    // What is given besides counts.
    let single = picture("single by arguments", &["--technique", "single", "--set", "view=count"]);
    assert!(picture("but single", &["--settings", &file, "--technique", "single"]) == single);
    let wrong = folder.file("w.json", br#"{"version": 1, "settings": {"windowed": {"depth": "sideways"}}}"#);
    refused(&["--settings", &wrong], &["w.json: settings.windowed.depth: unknown variant `sideways`"]);
    refused(&["--settings", &file, "--preset", "fast"], &["cannot be used with"]);
    refused(&["--settings", "/nowhere.json"], &["/nowhere.json: No such file"]);
}

#[test]
fn a_viewer_that_has_no_window_says_so() {
    let view = |arguments: &[&str]| {
        let mut command = demo(&[&["view"], arguments].concat());
        for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(name);
        }
        command.env("XDG_CONFIG_HOME", std::env::temp_dir()).output().unwrap()
    };
    if cfg!(target_os = "linux") {
        assert_refused(&view(&["--fresh", "flat"]), &["no window can be opened", "demo and render"]);
    }
    assert_refused(&view(&["--fresh", "--m", "9"]), &["--m: 9 is not in 1 to 8"]);
    assert_refused(&view(&["--fresh", "--adapter", "nosuch"]), &["no adapter has 'nosuch' in its name"]);
    assert_refused(&view(&["--fresh", "--size", "20000x9"]), &["--size: 20000x9"]);
    assert_refused(&view(&["--settings", "/nowhere.json"]), &["/nowhere.json"]);
    assert_refused(&view(&["--fresh", "atriun"]), &["no built-in scene 'atriun': did you mean atrium?"]);
    assert_refused(&view(&["--fresh", "/nowhere.glb"]), &["/nowhere.glb"]);
}

#[test]
fn the_same_command_twice_writes_the_same_bits() {
    assert!(picture("once", &["--technique", "windowed"]) == picture("twice", &["--technique", "windowed"]));
}

#[test]
fn a_glb_given_by_a_path_with_spaces_renders() {
    let folder = Folder::new("glb");
    let corners = [-1.0f32, -1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0];
    let bin: Vec<u8> = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
    let json =
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}"#;
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes()[..], kind, data].concat();
    let body = [chunk(b"JSON", &json), chunk(b"BIN\0", &bin)].concat();
    let file = [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat();
    let scene = folder.file("a triangle ▲.glb", &file);
    let output = render(&folder, &["--scene", &scene]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(Path::new(&folder.path("out/image.png")).exists());
}

// ---- tune ----

/// A tiny `tune` with these arguments on top.
fn tune(folder: &Folder, arguments: &[&str]) -> Output {
    let out = folder.path("out");
    let all = [&["tune", "--size", "32x18", "--m", "2", "--out", &out], arguments].concat();
    demo(&all).output().unwrap()
}

/// What a `tune` that succeeds says on stdout, and tune.json.
fn tuned(folder: &Folder, arguments: &[&str]) -> (String, Value) {
    let output = tune(folder, arguments);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    let record = std::fs::read(folder.0.join("out/tune.json")).unwrap();
    (text(&output.stdout), serde_json::from_slice(&record).unwrap())
}

#[test]
fn a_search_writes_what_it_did_and_what_it_found() {
    let folder = Folder::new("tune");
    let scenes = ["cornell", "fence@0,1.5,4,0,1,-4,50", "spheres"];
    let views = ["--scene", scenes[0], "--scene", scenes[1], "--unseen", scenes[2]];
    let targets = ["--rounds", "1", "--target-db", "20,25,30"];
    let (stdout, record) = tuned(&folder, &[&views[..], &targets].concat());
    for words in
        ["fast, at least 20 dB", "quality, at least 30 dB", "// balanced\nWindowed {", "not seen by", "\nmean "]
    {
        assert!(stdout.contains(words), "{words:?} is not in {stdout}");
    }
    let presets = record["presets"].as_array().unwrap();
    let names: Vec<_> = presets.iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["fast", "balanced", "quality"]);
    for preset in presets {
        let on = preset["scenes"].as_array().unwrap();
        let product: f64 = on[..2].iter().map(|s| s["found"]["figures"]["cost"].as_f64().unwrap()).product();
        assert!((product.sqrt() - preset["mean_cost"].as_f64().unwrap()).abs() < 1e-9, "{preset:#}");
        for (i, on) in on.iter().enumerate() {
            assert_eq!((&on["scene"], &on["unseen"]), (&scenes[i].into(), &(i == 2).into()));
            let figures = &on["found"]["figures"];
            let floor = preset["task"]["floor"]["db"].as_f64().unwrap();
            assert!(figures["psnr_db"].as_f64().unwrap() >= floor || i == 2, "{preset:#}");
            assert!(figures["flicker"].is_f64() && on["own"]["figures"]["psnr_db"].is_f64(), "{preset:#}");
            // What was found, and the crate's own, are among what was tried.
            let tried = record["evaluated"][i].as_array().unwrap();
            for (settings, of) in [("settings", "found"), ("own_settings", "own")] {
                let same = |t: &Value| t["settings"] == preset[settings] && t["figures"] == on[of]["figures"];
                assert!(tried.iter().any(same), "{of}: {preset:#}");
            }
        }
        // A scene that takes no part is tried with what was found and the crate's own alone.
        assert!(record["evaluated"][2].as_array().unwrap().len() <= 6);
    }
    // The same search again finds the same, with or without a look at another scene.
    let (_, again) = tuned(&folder, &[&views[..4], &targets].concat());
    for (one, other) in presets.iter().zip(again["presets"].as_array().unwrap()) {
        assert_eq!(one["settings"], other["settings"]);
        assert_eq!(other["scenes"].as_array().unwrap().len(), 2);
    }
}

/// Without targets the search begins at the crate's own presets, and ends with no more samples and no more error.
#[test]
fn presets_are_held_against_the_crates_own() {
    let folder = Folder::new("tune own");
    let arguments = ["--technique", "surfaces", "--scene", "fence", "--scene", "cornell", "--rounds", "1"];
    let (stdout, record) = tuned(&folder, &arguments);
    assert!(stdout.contains("quality, no worse than the crate's"), "{stdout}");
    for preset in record["presets"].as_array().unwrap() {
        let scenes = preset["scenes"].as_array().unwrap();
        let sum = |of: &str, what: &str, log: fn(f64) -> f64| {
            scenes.iter().map(|s| log(s[of]["figures"][what].as_f64().unwrap())).sum::<f64>()
        };
        assert!(sum("found", "cost", f64::ln) <= sum("own", "cost", f64::ln) + 1e-9, "{preset:#}");
        assert!(sum("found", "psnr_db", |db| db) >= sum("own", "psnr_db", |db| db), "{preset:#}");
        assert!(sum("found", "flip", |flip| flip.max(4e-4).ln()) <= sum("own", "flip", |flip| flip.max(4e-4).ln()));
        assert_eq!(preset["task"]["floor"]["like"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn targets_that_nothing_reaches_are_named() {
    let folder = Folder::new("tune too high");
    let arguments = ["--technique", "multiresolution", "--scene", "fence", "--rounds", "0", "--target-db", "20,79,80"];
    let (stdout, _) = tuned(&folder, &arguments);
    assert!(stdout.contains("fast, at least 20 dB\n"), "{stdout}");
    assert!(stdout.contains("balanced, at least 79 dB: not reached\n"), "{stdout}");
}

#[test]
fn thresholds_are_searched_too() {
    let folder = Folder::new("tune selective");
    let arguments = ["--technique", "selective", "--scene", "cornell", "--rounds", "1", "--target-db", "24,28,32"];
    let (stdout, record) = tuned(&folder, &arguments);
    assert!(stdout.contains("// balanced\nSelective {\n    tau_col: "), "{stdout}");
    assert_eq!(record["technique"], "selective");
    for preset in record["presets"].as_array().unwrap() {
        let floor = preset["task"]["floor"]["db"].as_f64().unwrap();
        assert!(preset["scenes"][0]["found"]["figures"]["psnr_db"].as_f64().unwrap() >= floor, "{preset:#}");
        assert_eq!(preset["settings"]["tau_poid"], preset["settings"]["tau_soid"]);
    }
}

#[test]
fn lattices_are_searched_too() {
    let folder = Folder::new("tune lattices");
    let arguments =
        ["--technique", "multiresolution", "--scene", "cornell", "--rounds", "1", "--target-db", "20,24,28"];
    let (stdout, record) = tuned(&folder, &arguments);
    assert!(
        stdout.contains("// balanced\nMultiResolution {\n    shading: Lattice {\n        pattern: Pattern::"),
        "{stdout}"
    );
    assert_eq!(record["technique"], "multiresolution");
    for preset in record["presets"].as_array().unwrap() {
        let floor = preset["task"]["floor"]["db"].as_f64().unwrap();
        assert!(preset["scenes"][0]["found"]["figures"]["psnr_db"].as_f64().unwrap() >= floor, "{preset:#}");
    }
}

#[test]
fn searches_that_cannot_be() {
    let folder = Folder::new("no tune");
    let taken = folder.file("taken", b"mine");
    for (arguments, words) in [
        (&["--scene", "cornel"][..], &["'cornel'", "did you mean cornell?"][..]),
        (&["--scene", "cornell@1,2,3"], &["--scene cornell@1,2,3", "x,y,z,tx,ty,tz"]),
        (&["--scene", "cornell", "--scene", "none.gltf"], &["none.gltf", "check the path"]),
        (&["--scene", "cornell", "--unseen", "none.gltf"], &["none.gltf", "check the path"]),
        (&["--target-db", "50,40,30"], &["--target-db", "three rising dB"]),
        (&["--m", "1"], &["--m", "1 is not in 2 to 8"]),
        (&["--m", "9"], &["--m", "9 is not in 2 to 8"]),
        (&["--size", "5"], &["--size", "WIDTHxHEIGHT"]),
        (&["--technique", "full"], &["'full'", "choose windowed, selective, multiresolution, surfaces"]),
        (&["--rounds", "many"], &["'many'", "--rounds"]),
        (&["--scene", "cornell", "--out", &taken], &["taken", "--out"]),
    ] {
        let out = folder.path("out");
        assert_refused(&demo(&[&["tune", "--out", &out], arguments].concat()).output().unwrap(), words);
    }
    assert_eq!(std::fs::read(&taken).unwrap(), b"mine");
}
