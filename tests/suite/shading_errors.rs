//! What a host reads when its WGSL is wrong: every kind of error, every way to get it, the whole text. `§` in a source
//! marks the place that the error must name and is taken out before the check; without a mark it must name none.

use crate::harness;
use deferred_aa::{
    BINDING_FEATURES, BuildError, DeferredAa, Descriptor, GBufferTier, Shading, ShadingError, TextureTier, wgpu,
};
use insta::assert_snapshot;

const SHADE: &str = "fn shade(s: DaaSample) -> vec4f { return vec4f(s.normal, 1.0); }";
const LIGHT_IN_PARTS: &str =
    "fn light(f: DaaSurface, m: DaaMaterial) -> DaaLight { return DaaLight(vec3f(1.0), m.base_color); }";
const LIGHT: &str = "fn light(f: DaaSurface, m: DaaMaterial) -> vec4f { return m.base_color; }";
const MARKED_SHADE: &str = "fn §shade(s: DaaSample) -> vec4f { return vec4f(s.normal, 1.0); }";
const MARKED_LIGHT: &str = "fn §light(f: DaaSurface, m: DaaMaterial) -> vec4f { return m.base_color; }";
const MARKED_MATERIAL: &str = "fn §material(s: DaaSample) -> DaaMaterial { return DaaMaterial(); }";
const MATERIAL: &str = "fn material(s: DaaSample) -> DaaMaterial { return DaaMaterial(); }";

fn check(tier: TextureTier, source: &str) -> Result<(), ShadingError> {
    let features = if tier == TextureTier::Bindings { BINDING_FEATURES } else { wgpu::Features::empty() };
    DeferredAa::check_shading(Shading { source, file: "game/toon.wgsl" }, tier, features)
}

/// The text of the error, once its place has been found to be the mark's.
fn on(tier: TextureTier, marked: &str) -> String {
    let (mut line, mut column) = (0, 0);
    if let Some((before, _)) = marked.split_once('§') {
        line = before.lines().count().max(1) as u32 + u32::from(before.ends_with('\n'));
        column = before.rsplit('\n').next().map_or(0, |rest| rest.chars().count()) as u32 + 1;
    }
    let e = check(tier, &marked.replace('§', "")).expect_err(marked);
    let text = e.to_string();
    assert_eq!((e.line, e.column), (line, column), "{text}\nin:\n{marked}");
    assert!(!text.contains('\n'), "one line: {text}");
    text
}

/// On the tier without a table; the place and the text must be the same on the tier that puts a directive in front.
fn error(marked: &str) -> String {
    let text = on(TextureTier::None, marked);
    assert_eq!(on(TextureTier::Bindings, marked), text);
    text
}

/// With a sound hook after it.
fn beside_a_hook(marked: &str) -> String {
    error(&format!("{marked}\n{SHADE}"))
}

/// The body of a sound hook.
fn in_body(marked: &str) -> String {
    error(&format!("fn shade(s: DaaSample) -> vec4f {{\n    {marked}\n}}"))
}

#[test]
fn sound_sources_pass() {
    for tier in [TextureTier::None, TextureTier::Arrays, TextureTier::Bindings] {
        for source in [
            SHADE.to_owned(),
            format!("{LIGHT}\n{MATERIAL}"),
            format!("{LIGHT_IN_PARTS}\n{MATERIAL}"),
            format!("{SHADE}\nfn sky(s: DaaSample) -> vec4f {{ return vec4f(-s.view, 1.0); }}"),
            format!("@group(2) @binding(9) var<uniform> tint: vec4f;\n{SHADE}"),
            "alias Radiance = vec4<f32>;\nfn shade(s: DaaSample) -> Radiance { return vec4f(daa_luminance(s.normal)); }".to_owned(),
        ] {
            assert_eq!(check(tier, &source), Ok(()), "{tier:?}: {source}");
        }
    }
    let textured = "fn shade(s: DaaSample) -> vec4f { return daa_texture(s.material, s.uv, s.ddx, s.ddy); }";
    assert_eq!(check(TextureTier::Arrays, textured), Ok(()));
    assert_eq!(check(TextureTier::Bindings, textured), Ok(()));
}

#[test]
fn syntax() {
    assert_snapshot!(in_body("let a = 1.0 +§;"), @r#"game/toon.wgsl:2:18: expected expression, found ";""#);
    assert_snapshot!(in_body("return vec4f(1.0)\n§}\nfn other() {"), @r#"game/toon.wgsl:3:1: expected `;`, found "}""#);
    assert_snapshot!(in_body("let a = 1.0 §$ 2.0;"), @r#"game/toon.wgsl:2:17: expected `;`, found "$""#);
    assert_snapshot!(beside_a_hook("§vec4f shade2(vec3f n) { }"), @r#"game/toon.wgsl:1:1: expected global item (`struct`, `const`, `var`, `alias`, `fn`, `diagnostic`, `enable`, `requires`, `;`) or the end of the file, found "vec4f""#);
    assert_snapshot!(beside_a_hook("const §self = 1;"), @"game/toon.wgsl:1:7: name `self` is a reserved keyword");
}

#[test]
fn names() {
    assert_snapshot!(in_body("return vec4f(§albedo, 1.0);"), @"game/toon.wgsl:2:18: no definition in scope for identifier: `albedo`");
    assert_snapshot!(in_body("return §toon_ramp(s.normal);"), @"game/toon.wgsl:2:12: no definition in scope for identifier: `toon_ramp`");
    assert_snapshot!(in_body("return vec4f(s.§colour, 1.0);"), @"game/toon.wgsl:2:20: invalid field accessor `colour`");
    assert_snapshot!(beside_a_hook("fn helper(x: §DaaLamp) {}"), @"game/toon.wgsl:1:14: no definition in scope for identifier: `DaaLamp`");
    assert_snapshot!(beside_a_hook("fn twice() {}\nfn §twice() {}"), @"game/toon.wgsl:2:4: redefinition of `twice`");
}

#[test]
fn types() {
    assert_snapshot!(in_body("return §vec4f(1.0) + 1u;"), @"game/toon.wgsl:2:12: in `shade`: Add can't work with vec4<f32> and vec4<u32>; convert one of them");
    assert_snapshot!(in_body("return §s.normal;"), @"game/toon.wgsl:2:12: in `shade`: the function returns vec4<f32>, this is something else");
    assert_snapshot!(in_body("let §n: vec3f = s.tangent;\n    return vec4f(n, 1.0);"), @"game/toon.wgsl:2:9: the type of `n` is expected to be `vec3<f32>`, but got `vec4<f32>`");
    assert_snapshot!(in_body("return vec4f(§s.normal);"), @"game/toon.wgsl:2:18: cannot cast a vec3<f32> to a vec4<f32>");
    assert_snapshot!(in_body("return vec4f(§dot(s.normal, s.uv));"), @"game/toon.wgsl:2:18: inconsistent type passed as argument #2 to `dot`; Because argument #1 has type vec3<f32>, only the following types (or types that automatically convert to them) are accepted for argument #2: allowed type: vec3<f32>");
    assert_snapshot!(in_body("return vec4f(daa_luminance(§s.uv));"), @"game/toon.wgsl:2:32: in `shade`: argument 1 must be vec3<f32>");
    assert_snapshot!(in_body("§s.depth = 1.0;\n    return vec4f(1.0);"), @"game/toon.wgsl:2:5: invalid left-hand side of assignment; consider declaring `s` with `var` instead of `let`");
    assert_snapshot!(error("§fn shade(s: DaaSample) -> vec4f {\n}"), @"game/toon.wgsl:1:1: in `shade`: the function returns vec4<f32>, it ends without a return");
    assert_snapshot!(beside_a_hook("@group(2) @binding(0) §var<uniform> on: bool;"), @"game/toon.wgsl:1:23: `on`: no buffer holds a value of its type; use u32 in place of bool");
}

#[test]
fn hooks() {
    assert_snapshot!(error(""), @"game/toon.wgsl: no shading function; write `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` and `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
    assert_snapshot!(error("// The toon model.\n/* to be written */\n"), @"game/toon.wgsl: no shading function; write `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` and `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
    assert_snapshot!(error("fn shading(s: DaaSample) -> vec4f { return vec4f(1.0); }"), @"game/toon.wgsl: no shading function; write `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` and `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
    assert_snapshot!(error(&format!("// Splits.\n{MARKED_MATERIAL}")), @"game/toon.wgsl:2:4: `material` without `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`; write both, or one `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error(&format!("  {MARKED_LIGHT}")), @"game/toon.wgsl:1:6: `light` without `fn material(s: DaaSample) -> DaaMaterial`; write both, or one `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error(&format!("{MATERIAL}\n{LIGHT}\n{MARKED_SHADE}")), @"game/toon.wgsl:3:4: both `shade` and `material` or `light`; keep one way of shading, rename the other");
    assert_snapshot!(error(&format!("{MATERIAL}\n{MARKED_SHADE}")), @"game/toon.wgsl:2:4: both `shade` and `material` or `light`; keep one way of shading, rename the other");
    assert_snapshot!(error(&format!("{LIGHT}\n{MARKED_SHADE}")), @"game/toon.wgsl:2:4: both `shade` and `material` or `light`; keep one way of shading, rename the other");
    // Found as a function, not as text.
    assert_snapshot!(error(&format!("// fn light(f) is elsewhere\nfn lighten() {{}}\n{MARKED_LIGHT}")), @"game/toon.wgsl:3:4: `light` without `fn material(s: DaaSample) -> DaaMaterial`; write both, or one `fn shade(s: DaaSample) -> vec4f`");
}

#[test]
fn signatures() {
    assert_snapshot!(error("fn §shade(s: DaaSurface) -> vec4f { return vec4f(1.0); }"), @"game/toon.wgsl:1:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error("fn §shade(s: DaaSample, t: f32) -> vec4f { return vec4f(1.0); }"), @"game/toon.wgsl:1:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error("fn §shade() -> vec4f { return vec4f(1.0); }"), @"game/toon.wgsl:1:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error("fn §shade(s: DaaSample) -> vec3f { return vec3f(1.0); }"), @"game/toon.wgsl:1:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error("fn §shade(s: DaaSample) -> vec4i { return vec4i(1); }"), @"game/toon.wgsl:1:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error("fn §shade(s: DaaSample) { }"), @"game/toon.wgsl:1:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
    assert_snapshot!(error(&format!("fn §material(s: DaaSurface) -> DaaMaterial {{ return DaaMaterial(); }}\n{LIGHT}")), @"game/toon.wgsl:1:4: `material` must be `fn material(s: DaaSample) -> DaaMaterial`");
    assert_snapshot!(error(&format!("fn §material(s: DaaSample) -> vec4f {{ return vec4f(1.0); }}\n{LIGHT}")), @"game/toon.wgsl:1:4: `material` must be `fn material(s: DaaSample) -> DaaMaterial`");
    assert_snapshot!(error(&format!("{MATERIAL}\nfn §light(m: DaaMaterial, f: DaaSurface) -> vec4f {{ return vec4f(1.0); }}")), @"game/toon.wgsl:2:4: `light` must be `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
    assert_snapshot!(error(&format!("{MATERIAL}\nfn §light(f: DaaSurface) -> vec4f {{ return vec4f(1.0); }}")), @"game/toon.wgsl:2:4: `light` must be `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
    assert_snapshot!(error(&format!("{MATERIAL}\nfn §light(f: DaaSurface, m: DaaMaterial) -> vec3f {{ return vec3f(1.0); }}")), @"game/toon.wgsl:2:4: `light` must be `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
    assert_snapshot!(beside_a_hook("fn §sky(direction: vec3f) -> vec4f { return vec4f(direction, 1.0); }"), @"game/toon.wgsl:1:4: `sky` must be `fn sky(s: DaaSample) -> vec4f`");
    assert_snapshot!(beside_a_hook("fn §sky(s: DaaSample) -> vec3f { return s.view; }"), @"game/toon.wgsl:1:4: `sky` must be `fn sky(s: DaaSample) -> vec4f`");
    // A type of the host's own with the same members is another type.
    assert_snapshot!(error("struct S { normal: vec3f }\nfn §shade(s: S) -> vec4f { return vec4f(1.0); }"), @"game/toon.wgsl:2:4: `shade` must be `fn shade(s: DaaSample) -> vec4f`");
}

#[test]
fn reserved_names() {
    assert_snapshot!(beside_a_hook("fn §daa_toon() {}"), @"game/toon.wgsl:1:4: `daa_toon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("struct §DaaToon { x: f32 }"), @"game/toon.wgsl:1:8: `DaaToon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("const §DAA_TOON = 1;"), @"game/toon.wgsl:1:7: `DAA_TOON` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("const §daa_toon: f32 = 1.0;"), @"game/toon.wgsl:1:7: `daa_toon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("override §daa_toon: f32 = 1.0;"), @"game/toon.wgsl:1:10: `daa_toon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("var<private> §daa_toon: f32;"), @"game/toon.wgsl:1:14: `daa_toon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("@group(2) @binding(0) var<uniform> §daa_toon: vec4f;"), @"game/toon.wgsl:1:36: `daa_toon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("alias §DaaToon = vec4f;"), @"game/toon.wgsl:1:7: `DaaToon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("alias §DaaToon = array<vec4f, 3>;\nvar<private> toon: DaaToon;"), @"game/toon.wgsl:1:7: `DaaToon` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    // Names that the crate has: of the contract, and of passes only.
    assert_snapshot!(beside_a_hook("struct §DaaSample { x: f32 }"), @"game/toon.wgsl:1:8: `DaaSample` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("fn §daa_luminance(c: vec3f) -> f32 { return c.x; }"), @"game/toon.wgsl:1:4: `daa_luminance` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("const §DAA_FLAG_FULL = 1;"), @"game/toon.wgsl:1:7: `DAA_FLAG_FULL` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("fn §daa_first_main() {}"), @"game/toon.wgsl:1:4: `daa_first_main` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    assert_snapshot!(beside_a_hook("fn §daa_call_hook() {}"), @"game/toon.wgsl:1:4: `daa_call_hook` is a name of deferred-aa's; names that begin with daa_, Daa or DAA_ are reserved, rename it");
    // Inside a function or a struct nothing can clash.
    assert_eq!(check(TextureTier::None, &format!("struct Toon {{ daa_x: f32 }}\n{SHADE}")), Ok(()));
    assert_eq!(
        check(TextureTier::None, "fn shade(daa_s: DaaSample) -> vec4f { let daa_x = 1.0; return vec4f(daa_x); }"),
        Ok(())
    );
}

/// The crate's code means WGSL's own names as WGSL does; a host's would take their place in it without a word.
#[test]
fn clashes() {
    assert_snapshot!(beside_a_hook("fn §clamp(x: f32) -> f32 { return min(max(x, 0.0), 1.0); }"), @"game/toon.wgsl:1:4: `clamp` is a built-in of WGSL that deferred-aa's own code uses; rename this one");
    assert_snapshot!(beside_a_hook("fn §dot(a: vec3f, b: vec3f) -> f32 { return 0.0; }"), @"game/toon.wgsl:1:4: `dot` is a built-in of WGSL that deferred-aa's own code uses; rename this one");
    assert_snapshot!(beside_a_hook("alias §f32 = u32;"), @"game/toon.wgsl:1:7: `f32` is a built-in of WGSL that deferred-aa's own code uses; rename this one");
    assert_snapshot!(beside_a_hook("struct §vec4f { x: f32 }"), @"game/toon.wgsl:1:8: `vec4f` is a built-in of WGSL that deferred-aa's own code uses; rename this one");
    // One that the crate does not use is the host's to take.
    assert_eq!(check(TextureTier::None, &format!("fn saturate(x: f32) -> f32 {{ return x; }}\n{SHADE}")), Ok(()));
}

#[test]
fn groups() {
    for group in [0, 3] {
        let text = beside_a_hook(&format!("@group({group}) @binding(0) var<uniform> §tint: vec4f;"));
        assert!(text.contains(&format!("@group({group})")), "{text}");
    }
    // A texture table has group 1, where the host's second group would be.
    let second = format!("@group(1) @binding(40) var paper: texture_2d<f32>;\n{SHADE}");
    assert_eq!(check(TextureTier::None, &second), Ok(()));
    let refused = [TextureTier::Arrays, TextureTier::Bindings].map(|tier| check(tier, &second).expect_err("a refusal"));
    assert_eq!(refused[0], refused[1]);
    assert_snapshot!(refused[0], @"game/toon.wgsl:1:28: `paper` is bound to @group(1); the host has @group(2), and with TextureTier::None also @group(1): bind it there");
    assert_snapshot!(beside_a_hook("@group(3) @binding(40) var<storage> §lights: array<vec4f>;"), @"game/toon.wgsl:1:37: `lights` is bound to @group(3); the host has @group(2), and with TextureTier::None also @group(1): bind it there");
    assert_snapshot!(beside_a_hook("§@group(2) var<uniform> tint: vec4f;"), @"game/toon.wgsl:1:1: variable `@group(2)` needs a 'binding' attribute");
    assert_snapshot!(beside_a_hook("§var<uniform> tint: vec4f;"), @"game/toon.wgsl:1:1: `tint`: Binding decoration is missing or not applicable");
}

/// A file may hold the host's own passes, which are no part of shading.
#[test]
fn entry_points_are_the_hosts_own_business() {
    let passes =
        "@compute @workgroup_size(8, 8)\nfn cull(@builtin(global_invocation_id) id: vec3u) { if id.x > 0u { return; } }
struct Varyings { @builtin(position) clip: vec4f, @location(0) compute: vec2f }
@vertex fn vertex(@builtin(vertex_index) i: u32) -> Varyings { return Varyings(vec4f(f32(i)), vec2f(0.0)); }
/* } */ @fragment
fn fragment(v: Varyings) -> @location(0) vec4f { return dpdx(vec4f(v.compute, 0.0, 1.0)); } // ü
const fragments = 3;
@must_use fn helper() -> f32 { return f32(fragments); }";
    assert_eq!(check(TextureTier::None, &format!("{passes}\n{SHADE}")), Ok(()));
    assert_snapshot!(beside_a_hook(&format!("{passes}\n@fragment fn f() {{}} fn b() -> f32 {{ return §oops; }}")), @"game/toon.wgsl:9:44: no definition in scope for identifier: `oops`");
    // A hook is none.
    assert_snapshot!(error("@fragment fn shade() -> @location(0) vec4f { return vec4f(1.0); }"), @"game/toon.wgsl: no shading function; write `fn shade(s: DaaSample) -> vec4f`, or both `fn material(s: DaaSample) -> DaaMaterial` and `fn light(f: DaaSurface, m: DaaMaterial) -> vec4f`");
}

#[test]
fn derivatives() {
    let textures = "@group(2) @binding(0) var paper: texture_2d<f32>;\n@group(2) @binding(1) var linear: sampler;";
    assert_snapshot!(error("fn §shade(s: DaaSample) -> vec4f { return dpdx(s.tangent); }"), @"game/toon.wgsl:1:4: `shade` takes a derivative or samples with an implicit one; shading runs in compute: sample with textureSampleGrad or daa_texture and the sample's ddx, ddy");
    assert_snapshot!(error("fn shade(s: DaaSample) -> vec4f { return helper(s.uv); }\nfn §helper(uv: vec2f) -> vec4f { return vec4f(fwidth(uv), 0.0, 1.0); }"), @"game/toon.wgsl:2:4: `helper` takes a derivative or samples with an implicit one; shading runs in compute: sample with textureSampleGrad or daa_texture and the sample's ddx, ddy");
    assert_snapshot!(error(&format!("{textures}\nfn §shade(s: DaaSample) -> vec4f {{ return textureSample(paper, linear, s.uv); }}")), @"game/toon.wgsl:3:4: `shade` takes a derivative or samples with an implicit one; shading runs in compute: sample with textureSampleGrad or daa_texture and the sample's ddx, ddy");
    assert_snapshot!(error(&format!("{textures}\nfn §shade(s: DaaSample) -> vec4f {{ return textureSampleBias(paper, linear, s.uv, 1.0); }}")), @"game/toon.wgsl:3:4: `shade` takes a derivative or samples with an implicit one; shading runs in compute: sample with textureSampleGrad or daa_texture and the sample's ddx, ddy");
    // In other control flow than uniform as well.
    assert_snapshot!(error(&format!("{textures}\nfn §shade(s: DaaSample) -> vec4f {{ if s.material == 1u {{ return textureSample(paper, linear, s.uv); }} return vec4f(1.0); }}")), @"game/toon.wgsl:3:4: `shade` takes a derivative or samples with an implicit one; shading runs in compute: sample with textureSampleGrad or daa_texture and the sample's ddx, ddy");
}

#[test]
fn the_end_of_the_file() {
    assert_snapshot!(error("fn shade(s: DaaSample) -> vec4f §{\n    return vec4f(1.0);\n"), @"game/toon.wgsl:1:33: this `{` is not closed before the end of the source");
    assert_snapshot!(error("fn shade(s: DaaSample) -> vec4f §{\n    if s.depth > 1.0 {\n        return vec4f(1.0);\n    return vec4f(0.0);\n}"), @"game/toon.wgsl:1:33: this `{` is not closed before the end of the source");
    assert_snapshot!(error(&format!("{SHADE}\nconst ramp = 1.0§")), @"game/toon.wgsl:2:17: the source ends inside a declaration; is a semicolon missing?");
    assert_snapshot!(error(&format!("{SHADE}\n§/* never closed\n")), @"game/toon.wgsl:2:1: unterminated block comment");
    assert_snapshot!(error(&format!("{SHADE}\n§@group(2)")), @"game/toon.wgsl:2:1: variable `@group(2)` needs a 'binding' attribute");
}

#[test]
fn places_are_characters_of_lines() {
    // Each in line 1, where the binding tier puts a directive in front.
    assert_snapshot!(error("fn shade(s: DaaSample) -> vec4f { return §oops; }"), @"game/toon.wgsl:1:42: no definition in scope for identifier: `oops`");
    assert_snapshot!(error("§oops"), @r#"game/toon.wgsl:1:1: expected global item (`struct`, `const`, `var`, `alias`, `fn`, `diagnostic`, `enable`, `requires`, `;`) or the end of the file, found "oops""#);
    // CRLF counts as one line end and no column.
    assert_snapshot!(error("// one\r\n// two\r\nfn shade(s: DaaSample) -> vec4f {\r\n\treturn §oops;\r\n}\r\n"), @"game/toon.wgsl:4:9: no definition in scope for identifier: `oops`");
    // Characters of two, three and four bytes count as one.
    assert_snapshot!(error("/* größer ≥ 𝛼 */ fn shade(s: DaaSample) -> vec4f { /* ☀ */ return §oops; }"), @"game/toon.wgsl:1:67: no definition in scope for identifier: `oops`");
    assert_snapshot!(error("// ☀☀☀ 𝛼\nfn shade(s: DaaSample) -> vec4f { return §größe; }"), @"game/toon.wgsl:2:42: no definition in scope for identifier: `größe`");
    // A byte order mark, as some editors write.
    assert_snapshot!(error("§\u{feff}fn shade(s: DaaSample) -> vec4f { return oops; }"), @r#"game/toon.wgsl:1:1: expected global item (`struct`, `const`, `var`, `alias`, `fn`, `diagnostic`, `enable`, `requires`, `;`) or the end of the file, found "\u{feff}""#);
}

#[test]
fn directives() {
    assert_snapshot!(beside_a_hook("enable §toon_shading;"), @"game/toon.wgsl:1:8: unknown enable-extension `toon_shading`; See available extensions at <https://www.w3.org/TR/WGSL/#enable-extension>.");
    assert_snapshot!(error(&format!("{SHADE}\n§enable f16;")), @"game/toon.wgsl:2:1: expected global declaration, but found a global directive; global directives are only allowed before global declarations; maybe hoist this closer to the top of the shader module?");
    let half = "enable §f16;\nfn shade(s: DaaSample) -> vec4f { return vec4f(f32(f16(s.depth))); }";
    assert_snapshot!(error(half), @"game/toon.wgsl:1:8: `f16` needs a device with Features::SHADER_F16; request it, or use f32");
    assert_snapshot!(error("fn shade(s: DaaSample) -> vec4f { return vec4f(f32(§f16(s.depth))); }"), @"game/toon.wgsl:1:52: the `f16` enable extension is not enabled; You can enable this extension by adding `enable f16;` at the top of the shader, before any other items.");
    // With the capability a directive is the host's to give, whatever stands in front of it.
    for tier in [TextureTier::None, TextureTier::Arrays, TextureTier::Bindings] {
        let shading = Shading { source: &half.replace('§', ""), file: "game/toon.wgsl" };
        let features = wgpu::Features::SHADER_F16 | BINDING_FEATURES;
        assert_eq!(DeferredAa::check_shading(shading, tier, features), Ok(()), "{tier:?}");
    }
}

#[test]
fn tiers() {
    let textured = "fn shade(s: DaaSample) -> vec4f { return §daa_texture(s.material, s.uv, s.ddx, s.ddy); }";
    assert_snapshot!(on(TextureTier::None, textured), @"game/toon.wgsl:1:42: no definition in scope for identifier: `daa_texture`, which TextureTier::None does not have; set Descriptor::textures to another tier");
    let array = format!("@group(2) @binding(0) var papers: §binding_array<texture_2d<f32>, 4>;\n{SHADE}");
    assert_snapshot!(on(TextureTier::Arrays, &array), @"game/toon.wgsl:1:35: the `wgpu_binding_array` enable extension is not enabled; You can enable this extension by adding `enable wgpu_binding_array;` at the top of the shader, before any other items.");
    // A binding array of the host's own is sound where the tier enables the extension.
    assert_eq!(check(TextureTier::Bindings, &array.replace('§', "")), Ok(()));
    // A capability that the device does not have.
    let wide = format!("var<private> wide: §f64;\n{SHADE}");
    assert_snapshot!(on(TextureTier::None, &wide), @"game/toon.wgsl:1:20: Using `f64` values requires a device with Features::SHADER_F64; use f32");
}

/// A node's errors carry the same text.
#[test]
fn new_gives_the_same_error() {
    let gpu = harness::device(TextureTier::None);
    let shading = Shading { source: "fn shade(s: DaaSample) -> vec4f { return oops; }", file: "game/toon.wgsl" };
    let descriptor = Descriptor {
        m: 2,
        target_format: wgpu::TextureFormat::Rgba8Unorm,
        shading,
        textures: TextureTier::None,
        texture_capacity: 0,
        rays: None,
        gbuffer: GBufferTier::default(),
    };
    let built = DeferredAa::new(&gpu.device, &descriptor, None).map(|_| ());
    let checked = DeferredAa::check_shading(shading, TextureTier::None, wgpu::Features::empty());
    assert_eq!(built, checked.map_err(BuildError::Shading));
    assert_eq!(gpu.take_errors(), Vec::<String>::new());
}
