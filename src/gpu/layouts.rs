//! Tests that Rust and WGSL have the same structs and numbers.

mod compare;

use crate::effects::{CastingUniform, LightUniform, Traced};
use crate::frame::{FrameUniform, flag};
use crate::lattice::{LatticeUniform, StepUniform};
use crate::rays::RayTier;
use crate::reference::metrics::By;
use crate::scratch::{List, WORK_BYTES};
use crate::statistics::Counters;
use crate::table::{BINDING_FEATURES, MAX_CLASSES, TextureTier};
use crate::wgsl::{BUILTINS, HostSource, join_plain, join_reading, tokens};
use crate::{DebugView, TILE};
use compare::{constant, parse, rust_layout, wgsl_layout};
use wgpu::naga;

const SELECT: &str = include_str!("../shaders/select.wgsl");
/// A pass over lattices of these values.
macro_rules! refined {
    ($values:literal, $pass:literal) => {
        concat!(
            include_str!("../shaders/lattice.wgsl"),
            "\n",
            include_str!($values),
            "\n",
            include_str!("../shaders/bilateral.wgsl"),
            "\n",
            include_str!("../shaders/residual.wgsl"),
            "\n",
            include_str!($pass)
        )
    };
}
const REFINE: &str = refined!("../shaders/lattice_colors.wgsl", "../shaders/refine.wgsl");
const PLAIN: [(&str, &str); 12] = [
    ("check", include_str!("../shaders/check.wgsl")),
    ("classify", include_str!("../shaders/classify.wgsl")),
    ("list", concat!(include_str!("../shaders/work.wgsl"), "\n", include_str!("../shaders/list.wgsl"))),
    ("max_filter", include_str!("../shaders/max_filter.wgsl")),
    ("metrics", include_str!("../shaders/metrics.wgsl")),
    ("plan", include_str!("../shaders/plan.wgsl")),
    ("resolve", include_str!("../shaders/resolve.wgsl")),
    ("select", SELECT),
    ("refine", REFINE),
    ("refine rays", refined!("../shaders/lattice_rays.wgsl", "../shaders/refine.wgsl")),
    ("map", refined!("../shaders/lattice_colors.wgsl", "../shaders/map.wgsl")),
    ("view", include_str!("../shaders/view.wgsl")),
];
const SHADING: [(&str, &str); 7] = [
    (
        "reconstruct",
        concat!(
            include_str!("../shaders/ranks.wgsl"),
            "\n",
            include_str!("../shaders/bilateral.wgsl"),
            "\n",
            include_str!("../shaders/reconstruct.wgsl")
        ),
    ),
    (
        "points",
        concat!(
            include_str!("../shaders/lattice.wgsl"),
            "\n",
            include_str!("../shaders/lattice_colors.wgsl"),
            "\n",
            include_str!("../shaders/listing.wgsl"),
            "\n",
            include_str!("../shaders/points.wgsl")
        ),
    ),
    (
        "extra",
        concat!(
            include_str!("../shaders/ranks.wgsl"),
            "\n",
            include_str!("../shaders/work.wgsl"),
            "\n",
            include_str!("../shaders/extra.wgsl")
        ),
    ),
    ("first", include_str!("../shaders/first.wgsl")),
    ("shade", include_str!("../shaders/shade.wgsl")),
    ("audit", include_str!("../shaders/audit.wgsl")),
    (
        "listed",
        concat!(
            include_str!("../shaders/work.wgsl"),
            "\n",
            include_str!("../shaders/shade.wgsl"),
            "\n",
            include_str!("../shaders/listed.wgsl")
        ),
    ),
];
const TRACE: &str = include_str!("../shaders/trace.wgsl");
const BOUNCE: &str = include_str!("../shaders/bounce.wgsl");
const TIERS: [TextureTier; 3] = [TextureTier::None, TextureTier::Arrays, TextureTier::Bindings];

fn plain(pass: &str) -> naga::Module {
    let (_, chunk) = PLAIN.iter().find(|(name, _)| *name == pass).expect("a pass");
    parse(&join_plain(chunk))
}

/// Every module that the crate makes: the passes that only read the G-buffer, and those that shade, with each kind of
/// hook on each tier.
fn modules() -> Vec<(String, naga::Module)> {
    let mut all: Vec<_> = PLAIN.iter().map(|&(name, _)| (name.to_owned(), plain(name))).collect();
    for traced in Traced::ALL {
        all.push((format!("select {traced:?}"), parse(&join_reading(SELECT, traced))));
        all.push((format!("refine {traced:?}"), parse(&join_reading(REFINE, traced))));
    }
    let whole = "fn shade(s: DaaSample) -> vec4f { return vec4f(s.normal, 1.0); }";
    let split = "fn material(s: DaaSample) -> DaaMaterial { return DaaMaterial(); }
        fn light(f: DaaSurface, m: DaaMaterial) -> vec4f { return m.base_color * f.coverage; }
        fn sky(s: DaaSample) -> vec4f { return vec4f(s.view, 1.0); }
        fn bounce(s: DaaSample) -> DaaBounce { return DaaBounce(s.normal, 1.5, s.view, s.normal); }
        fn solid(material: u32, uv: vec2f) -> bool { return fract(uv.x) > 0.5; }";
    for tier in TIERS {
        for source in [whole, split] {
            let host = HostSource::check(source, "host", tier, BINDING_FEATURES).expect("a sound hook");
            for traced in Traced::ALL {
                let joined = |(name, pass)| (format!("{name} {tier:?} {traced:?}"), parse(&host.join(pass, traced)));
                all.extend(SHADING.map(joined));
            }
            for rays in [RayTier::Software, RayTier::Query] {
                all.push((format!("trace {tier:?} {rays:?}"), parse(&host.join_traced(TRACE, rays, false))));
                if host.bounces {
                    all.push((
                        format!("trace, bounce {tier:?} {rays:?}"),
                        parse(&host.join_traced(BOUNCE, rays, true)),
                    ));
                }
            }
        }
    }
    all
}

#[test]
fn every_joined_module_is_sound_and_has_the_frame() {
    let uniform = rust_layout!(FrameUniform {
        relative_from_clip,
        camera_position,
        exposure,
        camera_forward,
        orthographic,
        size,
        tiles_x,
        flags,
        depth_scale,
        normal_scale,
        luminance_scale,
        luminance_min,
        luminance_edge,
        identity_samples,
        shadow_samples,
        tile_limit,
        view,
        least_samples,
        audit_period,
        audit_phase,
        audit_step,
        audit_least,
        geometry,
        reconstruct_depth,
        reconstruct_normal,
        reconstruct_contrast,
        reconstruct_contrast_min,
        reconstruct_least,
        lattice_color,
        lattice_position,
        casting,
        selective_primary,
        selective_secondary,
        selective_color,
        selective_floor,
        selective_normal,
        selective_samples,
        footprint,
        order,
        centres,
    });
    for (name, module) in modules() {
        assert_eq!(wgsl_layout(&module, "DaaFrame"), uniform, "{name}");
    }
    let host_pack = format!(
        "{}\n@fragment fn f(@location(0) n: vec3f) -> DaaGBuffer {{
        var f: DaaFragment; f.normal = n; return daa_pack(f); }}",
        crate::gbuffer::PACK_WGSL
    );
    parse(&host_pack);
}

#[test]
fn counters_are_the_shaders() {
    let counters = rust_layout!(Counters {
        histogram,
        not_finite,
        negative,
        overflowed_tiles,
        decided,
        shadow_rays,
        reflection_rays,
        refraction_rays,
        tiles,
        quadrants,
        points
    });
    for (name, module) in modules() {
        assert_eq!(wgsl_layout(&module, "DaaStatistics"), counters, "{name}");
    }
}

#[test]
fn casting_lights_are_the_shaders() {
    let light = rust_layout!(LightUniform { position, punctual, direction, cone, range, padding });
    let casting = rust_layout!(CastingUniform { count, samples, keeps, padding, step, lights });
    let lattice = rust_layout!(LatticeUniform { kind, level, width, height, first, place, padding });
    let step = rust_layout!(StepUniform { points, parents, scale, coarsest, rays, found, padding });
    for (name, module) in modules().into_iter().filter(|(name, _)| name.starts_with("trace")) {
        assert_eq!(wgsl_layout(&module, "DaaCastingLight"), light, "{name}");
        assert_eq!(wgsl_layout(&module, "DaaCasting"), casting, "{name}");
        assert_eq!(wgsl_layout(&module, "DaaLattice").0, lattice.0, "{name}");
        assert_eq!(wgsl_layout(&module, "DaaStep"), step, "{name}");
    }
}

#[test]
fn flags_are_the_shaders() {
    let module = plain("metrics");
    let flags = [
        ("DEPTH_PLANE", flag::DEPTH_PLANE),
        ("TWO_SIDED", flag::TWO_SIDED),
        ("LUMINANCE_PERCEPTUAL", flag::LUMINANCE_PERCEPTUAL),
        ("LUMINANCE_CENTRE", flag::LUMINANCE_CENTRE),
        ("PLANES", flag::PLANES),
        ("CUT_IDENTITY", flag::CUT_IDENTITY),
        ("CUT_SHADOW", flag::CUT_SHADOW),
        ("OWN_FIRST", flag::OWN_FIRST),
        ("TRACE_ALL", flag::TRACE_ALL),
        ("REFLECTIONS", flag::REFLECTIONS),
        ("REFRACTIONS", flag::REFRACTIONS),
        ("SECONDARY_APART", flag::SECONDARY_APART),
        ("WEIGHT_LUMINANCE", flag::WEIGHT_LUMINANCE),
        ("FULL", flag::FULL),
        ("PLANNED", flag::PLANNED),
        ("EDGE_AWARE_FIRST", flag::EDGE_AWARE_FIRST),
        ("SELECTIVE", flag::SELECTIVE),
        ("SHADOW_LIGHTS", flag::SHADOW_LIGHTS),
        ("BILINEAR", flag::BILINEAR),
        ("FOCUSED", flag::FOCUSED),
        ("BY_LUMINANCE", flag::BY_LUMINANCE),
        ("BY_GRADIENT", flag::BY_GRADIENT),
        ("VETO", flag::VETO),
        ("WEIGHTED", flag::WEIGHTED),
        ("SUPERSAMPLED", flag::SUPERSAMPLED),
        ("LATTICE", flag::LATTICE),
        ("BOUNCES", flag::BOUNCES),
    ];
    for (name, value) in flags {
        assert_eq!(constant(&module, &format!("DAA_FLAG_{name}")), value, "{name}");
    }
    let named = module.constants.iter().filter(|(_, c)| c.name.as_deref().is_some_and(|n| n.starts_with("DAA_FLAG_")));
    assert_eq!(named.count(), flags.len(), "a flag that Rust does not have");
    let bits = flags.iter().fold(0, |all, &(_, bit)| all | bit);
    assert_eq!(bits.count_ones(), flags.len() as u32, "a bit of its own for each");
}

#[test]
fn deciding_metrics_are_the_shaders() {
    let module = plain("metrics");
    let all = [
        ("NOTHING", By::Nothing),
        ("DEPTH", By::Depth),
        ("NORMAL", By::Normal),
        ("LUMINANCE", By::Luminance),
        ("IDENTITY", By::Identity),
        ("LEAST", By::Least),
        ("SHADOW", By::Shadow),
    ];
    for (name, by) in all {
        assert_eq!(constant(&module, &format!("DAA_BY_{name}")), by as u32, "{name}");
    }
    let named = module.constants.iter().filter(|(_, c)| c.name.as_deref().is_some_and(|n| n.starts_with("DAA_BY_")));
    assert_eq!(named.count(), all.len());
    assert_eq!(size_of_val(&Counters { decided: [0; 7], ..bytemuck::Zeroable::zeroed() }.decided) / 4, all.len());
}

/// `case 5u: { … } // Normal`: the comment is the variant, so that a case moved alone shows.
#[test]
fn debug_views_are_the_shaders_cases() {
    let text = include_str!("../shaders/view.wgsl");
    let mut named = Vec::new();
    for line in text.lines() {
        if let Some((number, rest)) = line.trim().strip_prefix("case ").and_then(|l| l.split_once("u:")) {
            let comment = rest.rsplit("// ").next().expect("a comment");
            let name = comment.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
            named.push((number.parse::<u32>().expect("a number"), name.to_owned()));
        }
    }
    let views = DebugView::ALL.map(|view| (view as u32, format!("{view:?}")));
    // The image itself is resolve's.
    assert_eq!(named, views[1..]);
    assert!(views.iter().map(|v| v.0).eq(0..views.len() as u32), "ALL is in order");
}

#[test]
fn tiles_are_the_shaders() {
    let tile = [TILE, TILE, 1];
    let flat = [TILE * TILE, 1, 1];
    let expected = [
        ("daa_audit_main", flat),
        ("daa_check_main", tile),
        ("daa_classify_finish", [1, 1, 1]),
        ("daa_classify_main", flat),
        ("daa_first_main", tile),
        ("daa_map_main", flat),
        ("daa_points_main", tile),
        ("daa_refine_judge", tile),
        ("daa_refine_main", tile),
        ("daa_list_count_pixels", flat),
        ("daa_list_count_samples", flat),
        ("daa_list_pixels", flat),
        ("daa_list_samples", flat),
        ("daa_list_scan", [256, 1, 1]),
        ("daa_max_filter_main", tile),
        ("daa_metrics_main", tile),
        ("daa_plan_main", flat),
        ("daa_shade_full", tile),
        ("daa_shade_gather", tile),
        ("daa_shade_packed", flat),
        ("daa_shade_pixels", flat),
        ("daa_shade_loop", tile),
        ("daa_shade_tiled", flat),
        ("daa_reconstruct_main", flat),
        ("daa_select_main", flat),
        ("daa_extra_main", flat),
        ("daa_extra_between", tile),
        ("daa_trace_main", flat),
        ("daa_bounce_main", flat),
    ];
    let mut seen = 0;
    for (name, module) in modules() {
        for entry in module.entry_points.iter().filter(|e| e.stage == naga::ShaderStage::Compute) {
            let found = expected.iter().find(|(entry_point, _)| *entry_point == entry.name);
            assert_eq!(found.map(|f| f.1), Some(entry.workgroup_size), "{name}: {}", entry.name);
            seen |= 1 << expected.iter().position(|e| e.0 == entry.name).expect("found above");
        }
    }
    assert_eq!(seen, (1 << expected.len()) - 1, "an entry point is gone");
    // The literals that follow from TILE = 8: a shift by 3, a mask of 7, 64 windows, and 64 · 63 samples beyond the
    // first.
    assert_eq!(TILE, 1 << 3);
    assert_eq!(crate::Windowed::NO_TILE_LIMIT, TILE * TILE * (crate::window::MAX_M.pow(2) - 1));
}

#[test]
fn works_are_the_shaders() {
    let mut seen = 0;
    for (name, module) in modules().into_iter().filter(|(name, _)| name.starts_with("list")) {
        let (members, size) = wgsl_layout(&module, "DaaWork");
        assert_eq!(u64::from(size), WORK_BYTES, "{name}");
        let groups = members.iter().find(|m| m.0 == "groups_x").map(|m| u64::from(m.1));
        assert_eq!(groups, Some(List::GROUPS_AT), "{name}");
        seen += 1;
    }
    assert!(seen > 1);
}

#[test]
fn table_bindings_are_the_layouts() {
    let host = HostSource::check(
        "fn shade(s: DaaSample) -> vec4f { return daa_texture(s.material, s.uv, s.ddx, s.ddy); }",
        "host",
        TextureTier::Arrays,
        wgpu::Features::empty(),
    );
    let module = parse(&host.expect("a sound hook").join(SHADING[0].1, Traced::default()));
    let mut bound: Vec<_> = module
        .global_variables
        .iter()
        .filter_map(|(_, v)| Some((v.binding?, v.name.clone()?)))
        .filter_map(|(b, name)| (b.group == 1).then_some((b.binding, name)))
        .collect();
    bound.sort();
    let mut expected = vec![(0, "daa_texture_slots".to_owned())];
    expected.extend((0..MAX_CLASSES as u32).map(|i| (1 + i, format!("daa_texture_{i}"))));
    expected.extend((0..MAX_CLASSES as u32).map(|i| (1 + MAX_CLASSES as u32 + i, format!("daa_sampler_{i}"))));
    assert_eq!(bound, expected);
    // A case for each class but the first, which is the default, each with its own texture and sampler.
    let text = include_str!("../shaders/table_arrays.wgsl");
    for i in 1..MAX_CLASSES {
        let case = format!("case {i}u: {{ return textureSampleGrad(daa_texture_{i}, daa_sampler_{i}, ");
        assert!(text.contains(&case), "{case}");
    }
    assert_eq!(text.matches("case ").count(), MAX_CLASSES - 1);
    assert!(text.contains("default: { return textureSampleGrad(daa_texture_0, daa_sampler_0, "));
}

#[test]
fn a_host_has_the_group_that_the_contract_says() {
    for (name, module) in modules() {
        let groups = module.global_variables.iter().filter_map(|(_, v)| Some(v.binding?.group));
        assert!(groups.into_iter().all(|g| g != crate::HOST_GROUP), "{name} binds in the host's group");
    }
}

/// What a host must not declare anew: whatever the shaders call that is not theirs, and the types that they use.
#[test]
fn builtins_are_what_the_shaders_use() {
    let all = [
        include_str!("../shaders/contract.wgsl"),
        include_str!("../shaders/octahedral.wgsl"),
        include_str!("../shaders/sample.wgsl"),
        include_str!("../shaders/mean.wgsl"),
        include_str!("../shaders/statistics.wgsl"),
        include_str!("../shaders/evaluate.wgsl"),
        include_str!("../shaders/table_arrays.wgsl"),
        include_str!("../shaders/table_bindings.wgsl"),
        include_str!("../shaders/shadows.wgsl"),
        include_str!("../shaders/secondary.wgsl"),
        include_str!("../shaders/shared_exponent.wgsl"),
        include_str!("../shaders/casting.wgsl"),
        include_str!("../shaders/lattice.wgsl"),
        include_str!("../shaders/listing.wgsl"),
        include_str!("../shaders/rays.wgsl"),
        include_str!("../shaders/rays_software.wgsl"),
        include_str!("../shaders/rays_query.wgsl"),
        TRACE,
        BOUNCE,
    ];
    const OTHER: [&str; 12] = [
        "align",
        "binding",
        "builtin",
        "for",
        "group",
        "if",
        "location",
        "return",
        "size",
        "switch",
        "while",
        "workgroup_size",
    ];
    // Used without a bracket after them.
    const TYPES: [&str; 9] = ["array", "atomic", "binding_array", "bitcast", "bool", "f32", "i32", "sampler", "u32"];
    let mut used = std::collections::BTreeSet::new();
    for text in all.into_iter().chain(PLAIN.map(|p| p.1)).chain(SHADING.map(|p| p.1)) {
        let tokens = tokens(text);
        for (i, &(_, token)) in tokens.iter().enumerate() {
            let called = tokens.get(i + 1).is_some_and(|next| next.1 == "(");
            let own = token.starts_with("daa_") || token.starts_with("Daa") || token.starts_with("DAA_");
            let word = token.starts_with(|c: char| c.is_alphabetic());
            let shape = ["vec", "mat", "texture_"].iter().any(|p| token.starts_with(p))
                && !called
                && token.contains(char::is_numeric);
            if word && !own && !OTHER.contains(&token) && (called || shape || TYPES.contains(&token)) {
                used.insert(token);
            }
        }
    }
    let listed: std::collections::BTreeSet<_> = BUILTINS.iter().copied().collect();
    assert_eq!(used.difference(&listed).collect::<Vec<_>>(), Vec::<&&str>::new(), "to be added to wgsl::BUILTINS");
    assert_eq!(listed.difference(&used).collect::<Vec<_>>(), Vec::<&&str>::new(), "no longer used");
}
