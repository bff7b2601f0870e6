//! Rust and WGSL hold the same structs, numbers and bindings: in the modules that run, put together as they run.

mod compare;

use crate::gpu::binding::{Access, Binding, OWN_GROUP, PassData, Slot};
use crate::gpu::modules::{Base, Tiers, source};
use crate::gpu::sizes::{BATCH, POINTS_BLOCK, TILE_CLASSES_BYTES, WORK_BYTES, WORK_GROUPS_AT};
use crate::gpu::uniforms::casting::{CastSamples, CastingUniform, LightUniform};
use crate::gpu::uniforms::frame::{
    AuditUniform, FrameUniform, MultiResolutionUniform, ReconstructUniform, ResultsUniform, SelectiveUniform,
    SurfacesUniform, WindowedUniform, flag,
};
use crate::gpu::uniforms::lattice::{LatticeUniform, Level, StepUniform};
use crate::host::gbuffer::{Channels, GBufferTier, Ids};
use crate::host::graph::{Grid, Part};
use crate::host::needs::RayInputs;
use crate::host::statistics::Counters;
use crate::host::table::{BINDING_FEATURES, MAX_CLASSES, TextureTier};
use crate::passes;
use crate::rays::RayTier;
use crate::wgsl::{BUILTINS, HostSource, chunk, tokens};
use crate::{DecidedBy, TILE};
use compare::{constant, parse, rust_layout, wgsl_layout};
use naga::valid::GlobalUse;
use std::collections::{BTreeMap, BTreeSet};
use wgpu::naga;

const TIERS: [TextureTier; 3] = [TextureTier::None, TextureTier::Arrays, TextureTier::Bindings];
const RAYS: [RayTier; 2] = [RayTier::Software, RayTier::Query];
/// With each set of targets.
const GBUFFERS: [GBufferTier; 7] = [
    GBufferTier::Stored(Channels::ALL),
    GBufferTier::Stored(Channels { uv: false, ..Channels::ALL }),
    GBufferTier::Stored(Channels { geometric_normal: true, ..Channels::NONE }),
    GBufferTier::Stored(Channels { user: true, ..Channels::NONE }),
    GBufferTier::Stored(Channels::NONE),
    GBufferTier::Visibility(Ids::Wide),
    GBufferTier::Visibility(Ids::Narrow { triangle_bits: 20 }),
];

/// With every hook.
const SPLIT: &str = "fn material(s: DaaSample) -> DaaMaterial { return DaaMaterial(); }
    fn light(f: DaaSurface, m: DaaMaterial) -> vec4f { return m.base_color * f.coverage; }
    fn sky(s: DaaSample) -> vec4f { return vec4f(s.view, 1.0); }
    fn reflection(s: DaaSample) -> DaaReflection { return DaaReflection(s.normal, 1.5, s.view, s.normal); }
    fn solid(material: u32, uv: vec2f, user: u32) -> bool { return fract(uv.x) > 0.5; }";
const WHOLE: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(s.normal, 1.0); }";

fn host(source: &str, tier: TextureTier) -> HostSource {
    HostSource::check(source, "host", tier, BINDING_FEATURES).expect("a sound hook")
}

/// A pass's module as a node with every hook runs it.
fn module(pass: &PassData, inputs: RayInputs, tier: RayTier) -> naga::Module {
    module_on(pass, inputs, Tiers { rays: tier, ..Default::default() })
}

fn module_on(pass: &PassData, inputs: RayInputs, tiers: Tiers) -> naga::Module {
    parse(&source(pass.module, &host(SPLIT, TextureTier::None), inputs, tiers))
}

/// Every module that the crate makes, with each kind of hook on each tier, by name.
fn modules() -> Vec<(String, naga::Module)> {
    let mut texts = BTreeMap::new();
    for tier in TIERS {
        for hook in [WHOLE, SPLIT] {
            let host = host(hook, tier);
            for pass in passes::ALL {
                if pass.module.base == (Base::Casting { shades: true }) && !host.reflects {
                    continue;
                }
                for (inputs, rays) in RayInputs::ALL.into_iter().flat_map(|inputs| RAYS.map(|rays| (inputs, rays))) {
                    for gbuffer in GBUFFERS {
                        // Those beside the whole one are the same for every table.
                        if gbuffer != GBufferTier::default() && tier != TextureTier::None {
                            continue;
                        }
                        let text = source(pass.module, &host, inputs, Tiers { gbuffer, rays });
                        let name = || format!("{} {tier:?} {inputs:?} {rays:?} {gbuffer:?}", pass.module.name);
                        texts.entry(text).or_insert_with(name);
                    }
                }
            }
        }
    }
    texts.into_iter().map(|(text, name)| (name, parse(&text))).collect()
}

/// What an entry point does with each variable of a group, by binding.
fn used(module: &naga::Module, entry: &str, group: u32) -> BTreeMap<u32, GlobalUse> {
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
    let info = validator.validate(module).expect("a sound module");
    let index = module.entry_points.iter().position(|e| e.name == entry);
    let of_entry = info.get_entry_point(index.unwrap_or_else(|| panic!("{entry} is gone")));
    let bound =
        module.global_variables.iter().filter_map(|(handle, variable)| Some((variable.binding?, of_entry[handle])));
    bound.filter(|(at, use_)| at.group == group && !use_.is_empty()).map(|(at, use_)| (at.binding, use_)).collect()
}

/// Whether WGSL declares what a layout says.
fn is_of_type(module: &naga::Module, variable: &naga::GlobalVariable, ty: wgpu::BindingType) -> bool {
    let inner = &module.types[variable.ty].inner;
    match ty {
        wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, .. } => {
            variable.space == naga::AddressSpace::Uniform
        }
        wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { read_only }, .. } => {
            let access = if read_only {
                naga::StorageAccess::LOAD
            } else {
                naga::StorageAccess::LOAD | naga::StorageAccess::STORE
            };
            variable.space == naga::AddressSpace::Storage { access }
        }
        wgpu::BindingType::Texture { .. } => {
            matches!(inner, naga::TypeInner::Image { class: naga::ImageClass::Sampled { .. }, .. })
        }
        wgpu::BindingType::StorageTexture { .. } => matches!(
            inner,
            naga::TypeInner::Image { class: naga::ImageClass::Storage { access, .. }, .. } if *access == naga::StorageAccess::STORE
        ),
        wgpu::BindingType::AccelerationStructure { .. } => {
            matches!(inner, naga::TypeInner::AccelerationStructure { .. })
        }
        _ => false,
    }
}

/// What is wrong with the list of bindings of a pass, held against its module.
fn faults(pass: &PassData, module: &naga::Module, tier: RayTier) -> Vec<String> {
    let mut faults = Vec::new();
    let variable = |index: u32| {
        let at = |v: &naga::GlobalVariable| v.binding.is_some_and(|b| b.group == OWN_GROUP && b.binding == index);
        module.global_variables.iter().map(|(_, v)| v).find(|v| at(v))
    };
    for pair in pass.bindings.windows(2).filter(|pair| pair[0].index >= pair[1].index) {
        faults.push(format!("{} is not in order", pair[1].name));
    }
    let bindings = || pass.bindings.iter().filter(|binding| binding.is_on(tier));
    for binding in bindings() {
        let what = binding.name;
        match variable(binding.index) {
            None => faults.push(format!("{what} is not in WGSL")),
            Some(v) if v.name.as_deref() != Some(what) => faults.push(format!("{what} is {:?} in WGSL", v.name)),
            Some(v) if !is_of_type(module, v, binding.ty()) => faults.push(format!("{what} is of another type")),
            Some(_) => {}
        }
    }
    let (mut used_by_any, mut written_by_any) = (BTreeSet::new(), BTreeSet::new());
    for stage in pass.stages {
        let uses = used(module, stage.entry, OWN_GROUP);
        let bound: Vec<_> = pass.bound(stage).collect();
        for (&index, use_) in &uses {
            match bound.iter().find(|binding| binding.index == index) {
                None => faults.push(format!("{}: binding {index} is missing", stage.entry)),
                Some(binding) if use_.contains(GlobalUse::WRITE) => drop(written_by_any.insert(binding.index)),
                Some(_) => {}
            }
        }
        used_by_any.extend(uses.into_keys());
    }
    for binding in bindings() {
        if !used_by_any.contains(&binding.index) {
            faults.push(format!("{} is not used", binding.name));
        }
        let writes = written_by_any.contains(&binding.index);
        // A pass over some samples may leave what those over others write.
        match binding.used {
            Some(Access::Read) if writes => faults.push(format!("{} is written", binding.name)),
            Some(Access::Write | Access::Update) if !writes => faults.push(format!("{} is only read", binding.name)),
            _ => {}
        }
    }
    let frame = pass.stages.iter().flat_map(|stage| used(module, stage.entry, 0).into_keys());
    let reads_gbuffer = frame.into_iter().any(|binding| (1..=4).contains(&binding));
    if reads_gbuffer != pass.gbuffer {
        faults.push(format!("it reads the G-buffer: {reads_gbuffer}"));
    }
    if pass.draws() != pass.stages.iter().all(|stage| stage.grid.drawn().is_some()) {
        faults.push("it draws and computes".to_owned());
    }
    // `Recording` has room for two dynamic offsets.
    for stage in pass.stages.iter().filter(|s| pass.bound(s).filter(|b| b.dynamic().is_some()).count() > 2) {
        faults.push(format!("{}: more dynamic offsets than there is room for", stage.entry));
    }
    faults
}

/// Names, order, access and type: what a pass declares is what its shader has, in each entry point.
#[test]
fn bindings_are_the_shaders() {
    for pass in passes::ALL {
        for tier in RAYS {
            let module = module(pass, RayInputs::ALL[3], tier);
            assert_eq!(faults(pass, &module, tier), Vec::<String>::new(), "{:?} {tier:?}", pass.names);
        }
    }
}

/// The comparison sees a swapped access, a missing and an extra binding, and what a pass does not say of itself.
#[test]
fn wrong_bindings_are_seen() {
    let pass = &passes::plan::PLAN;
    let [counts, plan, statistics] = [pass.bindings[0], pass.bindings[1], pass.bindings[2]];
    let found = |bindings: Vec<Binding>, gbuffer: bool| {
        let wrong = PassData { bindings: bindings.leak(), gbuffer, ..*pass };
        faults(&wrong, &module(pass, RayInputs::default(), RayTier::Software), RayTier::Software)
    };
    assert_eq!(found(vec![counts, plan, statistics], false), Vec::<String>::new());
    let swapped = Binding { access: Access::Update, ..counts };
    assert_eq!(found(vec![swapped, plan, statistics], false), ["daa_counts is of another type"]);
    let written = Binding { used: Some(Access::Update), ..counts };
    assert_eq!(found(vec![written, plan, statistics], false), ["daa_counts is only read"]);
    let kept = Binding { used: Some(Access::Read), ..plan };
    assert_eq!(found(vec![counts, kept, statistics], false), ["daa_plan is written"]);
    assert_eq!(found(vec![counts, plan], false), ["daa_plan_main: binding 2 is missing"]);
    let extra = Binding::read(3, "daa_first", Slot::Part(Part::First));
    assert_eq!(
        found(vec![counts, plan, statistics, extra], false),
        ["daa_first is not in WGSL", "daa_first is not used"]
    );
    let named = Binding { name: "daa_window_counts", ..counts };
    assert_eq!(found(vec![named, plan, statistics], false), ["daa_window_counts is Some(\"daa_counts\") in WGSL"]);
    assert_eq!(found(vec![plan, counts, statistics], false)[0], "daa_counts is not in order");
    assert_eq!(found(vec![counts, plan, statistics], true), ["it reads the G-buffer: false"]);
}

/// Passes that share a pipeline bind the same under it.
#[test]
fn shared_pipelines_have_one_layout() {
    let mut layouts: BTreeMap<(&str, &str), Vec<(u32, wgpu::BindingType)>> = BTreeMap::new();
    for pass in passes::ALL {
        for stage in pass.stages {
            let layout: Vec<_> = pass.bound(stage).map(|b| (b.index, b.ty())).collect();
            let first = layouts.entry((pass.module.name, stage.entry)).or_insert_with(|| layout.clone());
            assert_eq!(*first, layout, "{:?} {}", pass.names, stage.entry);
        }
    }
    let mut names: BTreeMap<&str, *const [&str]> = BTreeMap::new();
    for pass in passes::ALL {
        let chunks = *names.entry(pass.module.name).or_insert(pass.module.chunks);
        assert!(std::ptr::eq(chunks, pass.module.chunks), "two modules are called {}", pass.module.name);
    }
}

#[test]
fn every_module_is_sound_and_has_the_frame() {
    let uniform = rust_layout!(FrameUniform {
        relative_from_clip,
        camera_position,
        exposure,
        camera_forward,
        orthographic,
        size,
        tiles_x,
        flags,
        footprint,
        least_samples,
        tile_limit,
        casting,
        view,
        around,
        origin,
        image,
        target_origin,
        shown,
        results,
        windowed,
        audit,
        reconstruct,
        selective,
        multi_resolution,
        surfaces,
        order,
        centres,
    });
    let parts = [
        (
            "DaaWindowed",
            rust_layout!(WindowedUniform {
                depth_scale,
                normal_scale,
                luminance_scale,
                luminance_min,
                luminance_edge,
                identity_samples,
                shadow_samples,
                user_scale,
            }),
        ),
        ("DaaResults", rust_layout!(ResultsUniform { ranks, planned, audited, words })),
        ("DaaAudit", rust_layout!(AuditUniform { period, phase, step, least_samples })),
        (
            "DaaReconstruct",
            rust_layout!(ReconstructUniform {
                samples,
                depth_scale,
                normal_scale,
                contrast_scale,
                contrast_min,
                least_weight,
                padding,
            }),
        ),
        (
            "DaaSelective",
            rust_layout!(SelectiveUniform { primary, reflected, color, contrast_min, normal_cosine, samples, ranks }),
        ),
        (
            "DaaSurfaces",
            rust_layout!(SurfacesUniform {
                normal_cosine,
                plane,
                most,
                taps,
                first_taps,
                most_groups,
                tap_spread,
                spread,
                widening,
                block_spread,
                block_contrast,
                shadow_reach,
            }),
        ),
        ("DaaMultiResolution", rust_layout!(MultiResolutionUniform { color, position, padding })),
    ];
    for (name, module) in modules() {
        assert_eq!(wgsl_layout(&module, "DaaFrame"), uniform, "{name}");
        for (part, layout) in &parts {
            assert_eq!(wgsl_layout(&module, part), *layout, "{name}");
        }
    }
}

/// What a host joins with its raster shader is whole by itself, and has a location for each target.
#[test]
fn packing_is_that_of_the_tier() {
    for tier in GBUFFERS {
        let call = match tier {
            GBufferTier::Stored(_) => "var f: DaaFragment; f.normal = n; return daa_pack(f);",
            GBufferTier::Visibility(_) => "return daa_pack(u32(n.x), u32(n.y));",
        };
        let entry = format!("@fragment fn f(@location(0) n: vec3f) -> DaaGBuffer {{ {call} }}");
        let module = parse(&[tier.pack_wgsl(), entry].join("\n"));
        let (members, _) = wgsl_layout(&module, "DaaGBuffer");
        let bytes: u32 = members.iter().map(|(_, _, size)| size).sum();
        assert_eq!(members.len(), tier.color_formats().len(), "{tier:?}");
        assert_eq!(u64::from(bytes) + 4, tier.bytes_per_sample(), "{tier:?}");
    }
}

/// Group 0 has what the modules of a tier read of the G-buffer.
#[test]
fn the_group_of_the_frame_has_the_gbuffer() {
    for gbuffer in GBUFFERS {
        let all = [Some(1), Some(2), gbuffer.frame_format().map(|_| 3), gbuffer.uv_format().map(|_| 4)];
        let mut has: BTreeSet<u32> = all.into_iter().flatten().collect();
        if gbuffer.ids().is_some() {
            has.extend([3, 4]);
        }
        for pass in passes::ALL {
            let module = module_on(pass, RayInputs::ALL[3], Tiers { gbuffer, ..Default::default() });
            for stage in pass.stages {
                let read = used(&module, stage.entry, 0).into_keys().filter(|binding| (1..=4).contains(binding));
                for binding in read {
                    assert!(has.contains(&binding), "{} on {gbuffer:?}: binding {binding}", stage.entry);
                }
            }
        }
    }
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
        points,
        without_rays,
        surfaces,
    });
    for (name, module) in modules() {
        assert_eq!(wgsl_layout(&module, "DaaStatistics"), counters, "{name}");
    }
    let counts = Counters { histogram: [0; 64], ..bytemuck::Zeroable::zeroed() };
    assert_eq!(counts.decided.values().len(), DecidedBy::ALL.len());
    assert_eq!(counts.quadrants.values().len(), crate::Attribute::ALL.len());
    assert_eq!(counts.points.values().len(), Level::COUNT);
}

#[test]
fn casting_is_the_shaders() {
    let light = rust_layout!(LightUniform { position, punctual, direction, cone, range, padding });
    let casting = rust_layout!(CastingUniform { count, samples, keeps, bias, step, lights });
    let lattice = rust_layout!(LatticeUniform { kind, level, width, height, first, place, origin });
    let step = rust_layout!(StepUniform { points, parents, scale, coarsest, rays, found, padding });
    let codes = [
        ("FIRST", CastSamples::First),
        ("FULL", CastSamples::Full),
        ("PLANNED", CastSamples::Planned),
        ("AUDITED", CastSamples::Audited),
        ("GEOMETRIC", CastSamples::Geometric),
        ("POINTS", CastSamples::Points(Level::Half)),
    ];
    for pass in passes::ALL.iter().filter(|pass| matches!(pass.module.base, Base::Casting { .. })) {
        for tier in RAYS {
            let module = module(pass, RayInputs::default(), tier);
            assert_eq!(wgsl_layout(&module, "DaaCastingLight"), light);
            assert_eq!(wgsl_layout(&module, "DaaCasting"), casting);
            assert_eq!(wgsl_layout(&module, "DaaLattice").0, lattice.0);
            assert_eq!(wgsl_layout(&module, "DaaStep"), step);
            for (name, samples) in codes {
                assert_eq!(constant(&module, &format!("DAA_SAMPLES_{name}")), samples.code(), "{name}");
            }
        }
    }
}

fn metrics() -> naga::Module {
    module(&passes::metrics::METRICS, RayInputs::default(), RayTier::Software)
}

#[test]
fn flags_are_the_shaders() {
    let module = metrics();
    let flags = [
        ("DEPTH_PLANE", flag::DEPTH_PLANE),
        ("TWO_SIDED", flag::TWO_SIDED),
        ("LUMINANCE_PERCEPTUAL", flag::LUMINANCE_PERCEPTUAL),
        ("LUMINANCE_CENTRE", flag::LUMINANCE_CENTRE),
        ("LUMINANCE_CHANNELS", flag::LUMINANCE_CHANNELS),
        ("WHOLE_HOOK", flag::WHOLE_HOOK),
        ("PLANES", flag::PLANES),
        ("CUT_IDENTITY", flag::CUT_IDENTITY),
        ("CUT_SHADOW", flag::CUT_SHADOW),
        ("OWN_FIRST", flag::OWN_FIRST),
        ("TRACE_ALL", flag::TRACE_ALL),
        ("REFLECTIONS", flag::REFLECTIONS),
        ("REFRACTIONS", flag::REFRACTIONS),
        ("REFLECTIONS_APART", flag::REFLECTIONS_APART),
        ("WEIGHT_LUMINANCE", flag::WEIGHT_LUMINANCE),
        ("FULL", flag::FULL),
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
        ("REFLECTS", flag::REFLECTS),
        ("SURFACES", flag::SURFACES),
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
fn limits_of_surfaces_are_the_shaders() {
    let light = module(&passes::surfaces::light::LIGHT, RayInputs::default(), RayTier::Software);
    assert_eq!(constant(&light, "DAA_MOST_TAPS"), crate::Surfaces::MOST_TAPS);
    assert_eq!(u64::from(constant(&light, "DAA_CORNER_WORDS")), crate::gpu::sizes::CORNER_WORDS);
    let (members, _) = wgsl_layout(&light, "DaaWindowList");
    let slots = members.iter().find(|(name, ..)| name == "slots").expect("slots");
    assert_eq!(u64::from(slots.1), crate::gpu::sizes::SURFACE_LIST_HEAD_BYTES);
    assert_eq!(constant(&light, "DAA_LIST_SLOTS") * 4, slots.1);
    let head = |name| members.iter().find(|m| m.0 == name).map(|m| u64::from(m.1));
    assert_eq!([head("one"), head("several")], [Some(0), Some(passes::surfaces::light::SEVERAL_AT)]);
    let (members, _) = wgsl_layout(&light, "DaaListHead");
    let count = members.iter().find(|m| m.0 == "count").map(|m| u64::from(m.1)).expect("a count");
    assert_eq!(u64::from(constant(&light, "DAA_LIST_ONE_COUNT")) * 4, count);
    assert_eq!(u64::from(constant(&light, "DAA_LIST_SEVERAL_COUNT")) * 4, passes::surfaces::light::SEVERAL_AT + count);
}

#[test]
fn deciding_metrics_are_the_shaders() {
    let module = metrics();
    for by in DecidedBy::ALL {
        let name = format!("{by:?}").to_uppercase();
        assert_eq!(constant(&module, &format!("DAA_BY_{name}")), by as u32, "{name}");
    }
    let named = module.constants.iter().filter(|(_, c)| c.name.as_deref().is_some_and(|n| n.starts_with("DAA_BY_")));
    assert_eq!(named.count(), DecidedBy::ALL.len());
}

/// The lanes of each entry point, which no change makes by accident.
#[test]
fn workgroups_are_the_shaders() {
    let tile = [TILE, TILE, 1];
    let flat = [TILE * TILE, 1, 1];
    let expected = BTreeMap::from([
        ("daa_audit_main", flat),
        ("daa_audit_surfaces", flat),
        ("daa_check_main", tile),
        ("daa_classify_finish", [1, 1, 1]),
        ("daa_classify_main", flat),
        ("daa_first_main", tile),
        ("daa_lattice_to_pixels_main", flat),
        ("daa_points_main", tile),
        ("daa_refine_judge", tile),
        ("daa_refine_main", tile),
        ("daa_cover_main", tile),
        ("daa_light_between", [192, 1, 1]),
        ("daa_light_corners", tile),
        ("daa_light_count", flat),
        ("daa_light_cut", [32, 1, 1]),
        ("daa_light_group", [32, 1, 1]),
        ("daa_light_list", flat),
        ("daa_light_one", [32, 1, 1]),
        ("daa_light_several", [32, 1, 1]),
        ("daa_list_count_pixels", flat),
        ("daa_list_count_samples", flat),
        ("daa_list_pixels", flat),
        ("daa_list_samples", flat),
        ("daa_list_scan", [256, 1, 1]),
        ("daa_max_filter_main", tile),
        ("daa_metrics_main", tile),
        ("daa_places_main", [256, 1, 1]),
        ("daa_probe_main", flat),
        ("daa_plan_main", flat),
        ("daa_shade_full", tile),
        ("daa_shade_gather", tile),
        ("daa_shade_packed", flat),
        ("daa_shade_pixels", flat),
        ("daa_shade_loop", tile),
        ("daa_shade_tiled", flat),
        ("daa_reconstruct_main", flat),
        ("daa_select_main", flat),
        ("daa_quadrants_active", flat),
        ("daa_quadrants_between", tile),
        ("daa_trace_main", flat),
        ("daa_reflect_main", flat),
    ]);
    let mut seen = BTreeSet::new();
    for (name, module) in modules() {
        for entry in module.entry_points.iter().filter(|e| e.stage == naga::ShaderStage::Compute) {
            assert_eq!(expected.get(entry.name.as_str()), Some(&entry.workgroup_size), "{name}: {}", entry.name);
            seen.insert(entry.name.clone());
        }
    }
    assert!(seen.iter().map(String::as_str).eq(expected.keys().copied().collect::<BTreeSet<_>>()), "one is gone");
    // What follows from TILE = 8: a shift by 3, a mask of 7, 64 windows, and 64 · 63 samples beyond the first.
    assert_eq!(TILE, 1 << 3);
    assert_eq!(crate::Windowed::NO_TILE_LIMIT, TILE * TILE * (crate::window::MAX_M.pow(2) - 1));
}

/// Grids count on these workgroups.
#[test]
fn workgroups_are_the_grids() {
    let tile = [TILE, TILE, 1];
    let flat = [TILE * TILE, 1, 1];
    let mut checked = BTreeSet::new();
    for pass in passes::ALL.iter().filter(|pass| !pass.draws()) {
        let module = module(pass, RayInputs::default(), RayTier::Software);
        for stage in pass.stages {
            let entry = module.entry_points.iter().find(|e| e.name == stage.entry).expect(stage.entry);
            let expected: &[[u32; 3]] = match stage.grid {
                Grid::One => &[[1, 1, 1], [256, 1, 1]],
                Grid::Counts => &[[256, 1, 1]],
                Grid::Indirect { part: Part::SurfaceList | Part::SurfaceCutList, .. } => &[[32, 1, 1]],
                Grid::TileRuns | Grid::Indirect { .. } | Grid::AuditedTiles => &[flat],
                Grid::Tiles => &[flat, tile],
                // Lanes of a block of points may be counted along one side, or both.
                Grid::Points(_) => &[flat, tile],
                // A lane for each of four corners of a block of 4 × 4, or for each of the twelve between.
                Grid::Pixels(16) => &[tile, [192, 1, 1]],
                Grid::Pixels(_) | Grid::Samples | Grid::Parents | Grid::Cells => &[tile],
                Grid::Target | Grid::Depth => unreachable!("drawn"),
            };
            assert!(expected.contains(&entry.workgroup_size), "{}: {:?}", stage.entry, entry.workgroup_size);
            checked.insert(stage.entry);
        }
    }
    assert!(checked.len() > 25, "{checked:?}");
    let lattice = module(&passes::lattice::points::POINTS, RayInputs::default(), RayTier::Software);
    assert_eq!(constant(&lattice, "DAA_LANE_SIDE") * TILE, POINTS_BLOCK);
}

/// What a pass reads an indirect dispatch from is where its shader writes it.
#[test]
fn dispatches_are_where_the_shaders_write_them() {
    for pass in [&passes::list::PIXELS, &passes::list::SAMPLES] {
        let module = module(pass, RayInputs::default(), RayTier::Software);
        let (members, size) = wgsl_layout(&module, "DaaWork");
        assert_eq!(u64::from(size), WORK_BYTES);
        let groups = members.iter().find(|m| m.0 == "groups_x").map(|m| u64::from(m.1));
        assert_eq!(groups, Some(WORK_GROUPS_AT));
        assert_eq!(u64::from(constant(&module, "DAA_BATCH")), BATCH);
    }
    let classify = module(&passes::rays::classify::CLASSIFY, RayInputs::default(), RayTier::Software);
    let (members, size) = wgsl_layout(&classify, "DaaTileClass");
    assert_eq!(u64::from(size) * 2, TILE_CLASSES_BYTES);
    let at = members.iter().find(|m| m.0 == "groups_x").map(|m| u64::from(m.1)).expect("groups");
    for (pass, class) in [(&passes::rays::trace::FIRST, 0), (&passes::rays::reflect::FIRST, 1)] {
        let expected = Grid::Indirect { part: Part::Tiles, offset: class * u64::from(size) + at };
        assert_eq!(pass.stages[0].grid, expected);
    }
}

#[test]
fn table_bindings_are_the_layouts() {
    let host = HostSource::check(
        "fn shade(s: DaaSample) -> vec4f { return daa_texture(s.material, s.uv, s.ddx, s.ddy); }",
        "host",
        TextureTier::Arrays,
        wgpu::Features::empty(),
    );
    let first = passes::first::FIRST.module;
    let module = parse(&source(first, &host.expect("a sound hook"), RayInputs::default(), Tiers::default()));
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
    let text = chunk::TABLE_ARRAYS;
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
    let mut used = BTreeSet::new();
    // What packs is in the host's own module.
    for text in passes::shader_texts().into_iter().filter(|text| !text.contains("fn daa_pack")) {
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
    let listed: BTreeSet<_> = BUILTINS.iter().copied().collect();
    assert_eq!(used.difference(&listed).collect::<Vec<_>>(), Vec::<&&str>::new(), "to be added to wgsl::BUILTINS");
    assert_eq!(listed.difference(&used).collect::<Vec<_>>(), Vec::<&&str>::new(), "no longer used");
}
