use super::bindings::Kind;
use super::table::Binding;
use super::*;
use crate::host::SHADING_WGSL;
use deferred_aa::rays::RayTier;
use deferred_aa::{Depth, Effect, Execution, GBufferTier, Settings, Shading, Technique};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::process::Command;

const LANGS: [Lang; 5] = [Lang::Hlsl, Lang::Msl, Lang::Spirv, Lang::Glsl, Lang::Wgsl];

fn demo<'a>(lang: Lang, settings: &'a Settings, textures: TextureTier, rays: RayTier) -> Request<'a> {
    let shading = Shading { source: SHADING_WGSL, file: "demo/src/host/shading.wgsl" };
    Request {
        lang,
        m: 3,
        settings,
        textures,
        rays,
        gbuffer: GBufferTier::default(),
        depth: Some(Depth::Farthest),
        shading,
    }
}

/// Frames of all techniques and executions, with rays and without.
fn frames() -> Vec<Settings> {
    let mut frames = Vec::new();
    for effect in [Effect::Off, Effect::On] {
        let with = Settings { shadows: effect, reflections: effect, ..Settings::default() };
        frames.extend(Technique::ALL.map(|technique| Settings { technique, ..with }));
    }
    frames.extend(Execution::ALL.map(|execution| Settings { execution, ..Settings::default() }));
    frames
}

/// Runs a program on each file; says what it said, or that it isn't there.
fn checked_by(program: &str, arguments: &[&str], files: &[(String, Vec<u8>)]) -> Result<(), String> {
    let folder = std::env::temp_dir().join(format!("deferred-aa-{program}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let check = |(name, bytes): &(String, Vec<u8>)| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        let output = Command::new(program).args(arguments).arg(&path).output().map_err(|e| e.to_string())?;
        let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).join("");
        if output.status.success() { Ok(()) } else { Err(format!("{name}: {said}")) }
    };
    let outcome = files.iter().try_for_each(check);
    std::fs::remove_dir_all(&folder).unwrap();
    outcome
}

fn is_there(program: &str, package: &str) -> bool {
    let there = Command::new(program).arg("--version").output().is_ok();
    if !there {
        eprintln!("skipped: no {program} (package {package}), which would check what naga wrote");
    }
    there
}

#[test]
fn spirv_is_valid() {
    if !is_there("spirv-val", "spirv-tools") {
        return;
    }
    for settings in frames() {
        let tiers = [(TextureTier::Arrays, RayTier::Software), (TextureTier::Bindings, RayTier::Query)];
        for (textures, rays) in tiers {
            let environment = if rays == RayTier::Query { "vulkan1.2" } else { "vulkan1.1" };
            let files = export(&demo(Lang::Spirv, &settings, textures, rays)).unwrap().files;
            checked_by("spirv-val", &["--target-env", environment], &files).unwrap();
        }
    }
    let broken = [("broken.spv".to_owned(), vec![0; 20])];
    assert!(checked_by("spirv-val", &[], &broken).is_err());
}

#[test]
fn glsl_compiles() {
    if !is_there("glslangValidator", "glslang-tools") {
        return;
    }
    for settings in frames() {
        let Export { files, table } =
            export(&demo(Lang::Glsl, &settings, TextureTier::Arrays, RayTier::Software)).unwrap();
        let shaders = table.passes.iter().flat_map(|pass| &pass.shaders);
        let stages: HashMap<_, _> = shaders.map(|s| (&s.file, s.stage.as_str())).collect();
        for file in &files {
            let stage = stages[&file.0].get(..4).unwrap();
            checked_by("glslangValidator", &["-S", stage], std::slice::from_ref(file)).unwrap();
        }
    }
}

#[test]
fn wgsl_is_what_it_was_made_from() {
    for settings in frames() {
        let Export { files, table } =
            export(&demo(Lang::Wgsl, &settings, TextureTier::Bindings, RayTier::Software)).unwrap();
        let shaders = table.passes.iter().flat_map(|pass| &pass.shaders);
        let bindings: HashMap<_, _> = shaders.map(|s| (&s.file, &s.bindings)).collect();
        for (name, bytes) in &files {
            let text = std::str::from_utf8(bytes).unwrap();
            let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{name}: {e}"));
            Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).unwrap();
            assert_eq!(module.entry_points.len(), 1);
            assert!(module.overrides.is_empty());
            // naga's WGSL has no @size and no @align.
            for (_, ty) in module.types.iter() {
                if let (Some(struct_name), naga::TypeInner::Struct { members, span }) = (&ty.name, &ty.inner)
                    && let Some(wanted) = table.structs.get(struct_name)
                {
                    assert_eq!(*span, wanted.bytes, "{name}: {struct_name}");
                    assert!(members.iter().map(|m| m.offset).eq(wanted.members.iter().map(|m| m.offset)));
                }
            }
            let found = module.global_variables.iter().filter_map(|(_, variable)| variable.binding);
            let mut found: Vec<_> = found.map(|at| (at.group, at.binding)).collect();
            found.sort_unstable();
            assert_eq!(found, bindings[name].iter().map(|b| (b.group, b.binding)).collect::<Vec<_>>(), "{name}");
        }
    }
}

/// Whether a file has this binding where the table says.
fn has(text: &str, lang: Lang, b: &Binding) -> bool {
    let on_a_line = |place: &str| text.lines().any(|line| line.contains(place) && line.contains(&b.name));
    match (lang, b.kind) {
        (Lang::Hlsl, Kind::Sampler) => text.contains(b.place.split('[').next().unwrap()),
        // The first space goes without saying.
        (Lang::Hlsl, _) => on_a_line(&format!("register({})", b.place.trim_end_matches(", space0"))),
        (Lang::Msl, _) => on_a_line(&format!("[[{}]]", b.place)),
        (Lang::Wgsl, _) => text.contains(&b.place),
        (Lang::Glsl, Kind::Sampler) => true,
        (Lang::Glsl, _) => {
            let name = format!("_group_{}_binding_{}_", b.group, b.binding);
            // A block's members lie between.
            let named = |rest: &str| rest.find("_group_").is_some_and(|at| rest[at..].starts_with(&name));
            let numbered = |place: &str| text.split(place).skip(1).any(named);
            let number = b.place.rsplit(' ').next().unwrap();
            numbered(&format!("binding = {number})")) || numbered(&format!("binding = {number},"))
        }
        (Lang::Spirv, _) => unreachable!("no text"),
    }
}

#[test]
fn the_table_is_true_of_the_files() {
    for lang in LANGS.into_iter().filter(|&lang| lang != Lang::Spirv) {
        for settings in frames() {
            let Export { files, table } =
                export(&demo(lang, &settings, TextureTier::Arrays, RayTier::Software)).unwrap();
            let files: HashMap<_, _> = files.iter().map(|(n, b)| (n, std::str::from_utf8(b).unwrap())).collect();
            let mut common = BTreeMap::new();
            for shader in table.passes.iter().flat_map(|pass| &pass.shaders) {
                let text = files[&shader.file];
                assert!(text.contains(&format!("{}(", shader.entry)), "{}: {}", shader.file, shader.entry);
                let mut places = Vec::new();
                for b in &shader.bindings {
                    assert!(has(text, lang, b), "{}: {} is not at {}", shader.file, b.name, b.place);
                    places.push(&b.place);
                    if b.group < 3 {
                        let first = common.entry((b.group, b.binding)).or_insert(&b.place);
                        assert_eq!(*first, &b.place, "{}: {}", shader.file, b.name);
                    }
                    if let Some(name) = b.ty.strip_prefix("array<").map_or(Some(b.ty.as_str()), |t| t.strip_suffix('>'))
                        && name.starts_with("Daa")
                        && b.bytes.is_some()
                    {
                        assert!(table.structs.contains_key(name), "{name}");
                    }
                }
                let count = places.len();
                places.sort_unstable();
                places.dedup();
                assert!(lang == Lang::Glsl || places.len() == count, "{}: {places:?}", shader.file);
            }
            let needs = Needs { depth: Some(Depth::Farthest), ..Default::default() };
            let names: Vec<_> = DeferredAa::passes(&settings, &needs).map(|pass| pass.info.name).collect();
            assert_eq!(table.passes[1..].iter().map(|pass| pass.name).collect::<Vec<_>>(), names);
            assert!(table.passes.iter().all(|pass| !pass.shaders.is_empty()));
            let text = table.markdown();
            assert!(files.keys().all(|name| text.contains(&format!("`{name}`"))));
        }
    }
}

#[test]
fn m_is_a_constant_in_them() {
    let written = |m| {
        let settings = Settings::default();
        let request = Request { m, ..demo(Lang::Msl, &settings, TextureTier::Arrays, RayTier::Software) };
        export(&request).unwrap().files.into_iter().find(|(name, _)| name == "daa_metrics_main.metal").unwrap().1
    };
    assert_ne!(written(2), written(4));
    assert!(String::from_utf8(written(4)).unwrap().contains("DAA_M = 4u"));
}

/// What only the pipelines of wgpu say otherwise.
#[test]
fn the_variants_are_those_of_the_frame() {
    let exported = |settings: &Settings, name: &str| {
        let files = export(&demo(Lang::Msl, settings, TextureTier::Arrays, RayTier::Software)).unwrap().files;
        String::from_utf8(files.into_iter().find(|(file, _)| file == name).unwrap().1).unwrap()
    };
    let reflective = Settings { shadows: Effect::On, reflections: Effect::On, ..Settings::default() };
    assert!(exported(&Settings::default(), "daa_resolve_by_plan.metal").contains("DAA_TARGET_MAX = 65504.0"));
    // A workgroup's memory is cleared but in what shades, which writes all that it reads of it.
    let tiled = Settings { execution: Execution::Tiled, ..Settings::default() };
    let shades = exported(&tiled, "daa_shade_tiled.metal");
    assert!(shades.contains("daa_sums") && !shades.contains("daa_sums = {}"));
    assert!(exported(&reflective, "daa_list_scan.metal").contains("daa_parts = {}"));
}

#[test]
fn what_a_language_lacks_is_named() {
    let settings = Settings { shadows: Effect::On, ..Settings::default() };
    let e = export(&demo(Lang::Glsl, &settings, TextureTier::Arrays, RayTier::Query)).unwrap_err().to_string();
    assert!(e.starts_with("daa_trace_main: GLSL can't say this: ") && e.contains("RAY_QUERY"), "{e}");
    assert!(e.ends_with("; use --rays software"), "{e}");
    let e = export(&demo(Lang::Glsl, &Settings::default(), TextureTier::Bindings, RayTier::Software)).unwrap_err();
    assert!(e.to_string().ends_with("; use --textures arrays"), "{e}");
    let shading =
        Shading { source: "override K: f32;\nfn shade(s: DaaSample) -> vec4f { return vec4f(K); }", file: "k" };
    let request = Request { shading, ..demo(Lang::Hlsl, &settings, TextureTier::None, RayTier::Software) };
    let e = export(&request).unwrap_err().to_string();
    assert!(e.starts_with("daa_first_main: ") && e.contains("'K'") && !e.contains("HLSL"), "{e}");
    for lang in [Lang::Hlsl, Lang::Msl, Lang::Spirv] {
        export(&demo(lang, &settings, TextureTier::Bindings, RayTier::Query)).unwrap();
    }
}

/// A shading with every kind of binding.
const BINDS_ALL: &str = "
struct Sun { towards: vec3f, color: vec3f }
@group(2) @binding(0) var<uniform> sun: Sun;
@group(2) @binding(1) var<storage, read> lamps: array<vec4f>;
@group(2) @binding(2) var<storage, read_write> seen: array<u32>;
@group(2) @binding(3) var albedo: texture_2d_array<f32>;
@group(2) @binding(4) var ids: texture_2d<u32>;
@group(2) @binding(5) var sky_map: texture_cube<f32>;
@group(2) @binding(6) var map: texture_depth_2d;
@group(2) @binding(7) var linear: sampler;
@group(2) @binding(8) var compare: sampler_comparison;
@group(2) @binding(9) var volume: texture_3d<f32>;
@group(2) @binding(12) var log: texture_storage_2d<rgba16float, write>;
fn shade(s: DaaSample) -> vec4f {
    seen[0] = textureLoad(ids, vec2u(0), 0).x;
    textureStore(log, vec2u(0), vec4f(1.0));
    let lit = textureSampleCompareLevel(map, compare, s.uv, 0.5);
    let tint = textureSampleLevel(sky_map, linear, s.normal, 0.0) + textureLoad(volume, vec3u(0), 0);
    return textureSampleLevel(albedo, linear, s.uv, s.material, 0.0) * lit + tint + lamps[0] + vec4f(sun.color, 1.0);
}
";

#[test]
fn a_hosts_own_shading_is_joined() {
    let settings = Settings::default();
    for lang in LANGS {
        let shading = Shading { source: BINDS_ALL, file: "own.wgsl" };
        let request = Request { shading, ..demo(lang, &settings, TextureTier::None, RayTier::Software) };
        let table = export(&request).unwrap().table;
        let first = table.passes.iter().find(|pass| pass.name == "first").unwrap();
        let own: Vec<_> = first.shaders[0].bindings.iter().filter(|b| b.group == 2).map(|b| b.name.as_str()).collect();
        let all = ["sun", "lamps", "seen", "albedo", "ids", "sky_map", "map", "linear", "compare", "volume", "log"];
        assert_eq!(own, all, "{lang}");
        assert_eq!(table.structs["Sun"].members[1].offset, 16);
    }
    // Metal has a slot for the sizes of buffers behind thirty.
    let declared = |i| format!("@group(2) @binding({i}) var<storage, read> b{i}: array<f32>;\n");
    let read: Vec<_> = (0..28).map(|i| format!("b{i}[0]")).collect();
    let source = (0..28).map(declared).collect::<String>()
        + &format!("fn shade(s: DaaSample) -> vec4f {{ return vec4f({}); }}", read.join(" + "));
    let many = |lang| {
        let shading = Shading { source: &source, file: "many.wgsl" };
        export(&Request { shading, ..demo(lang, &settings, TextureTier::None, RayTier::Software) })
    };
    many(Lang::Hlsl).unwrap();
    let e = many(Lang::Msl).unwrap_err().to_string();
    assert!(e.contains("Buffers are bound by all shaders together, there is room for 30"), "{e}");
    let shading = Shading { source: "fn shade(s: DaaSample) -> vec4f {\n    return nothing;\n}", file: "own.wgsl" };
    let request = Request { shading, ..demo(Lang::Hlsl, &settings, TextureTier::None, RayTier::Software) };
    let e = export(&request).unwrap_err().to_string();
    assert!(e.starts_with("own.wgsl:2:12: "), "{e}");
}

#[test]
fn the_command_writes_all_of_it() {
    let folder = std::env::temp_dir().join(format!("deferred-aa-shaders-{}", std::process::id()));
    let run = |arguments: &[&str]| {
        let all = ["deferred-aa-demo", "shaders", "--out"].map(std::ffi::OsStr::new).into_iter();
        let all = all.chain([folder.as_os_str()]).chain(arguments.iter().map(std::ffi::OsStr::new));
        <crate::commands::Cli as clap::Parser>::try_parse_from(all)
            .map_err(|e| e.to_string())?
            .run()
            .map_err(|e| e.to_string())
    };
    run(&["--lang", "hlsl", "--technique", "selective", "-m", "2"]).unwrap();
    let read = |name: &str| std::fs::read_to_string(Path::new(&folder).join(name)).unwrap();
    let table: serde_json::Value = serde_json::from_str(&read("bindings.json")).unwrap();
    assert_eq!((&table["m"], &table["settings"]["technique"]), (&2.into(), &"selective".into()));
    for shader in table["passes"].as_array().unwrap().iter().flat_map(|pass| pass["shaders"].as_array().unwrap()) {
        assert!(read(shader["file"].as_str().unwrap()).contains(shader["entry"].as_str().unwrap()));
    }
    assert!(read("bindings.md").starts_with("# Selective, m = 2, in HLSL\n"));
    let e = run(&["--lang", "hlsl", "--shading", "nowhere.wgsl"]).unwrap_err();
    assert!(e.starts_with("--shading: nowhere.wgsl: "), "{e}");
    assert!(run(&["--lang", "cg"]).unwrap_err().contains("possible values: hlsl, msl, spirv, glsl, wgsl"));
    assert!(run(&["--lang", "msl", "-m", "9"]).unwrap_err().starts_with("--m: "));
    std::fs::remove_dir_all(&folder).unwrap();
}
