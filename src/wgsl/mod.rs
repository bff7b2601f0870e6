//! The host's WGSL, which is checked before wgpu sees it, and the crate's chunks that are joined to it unchanged.

pub(crate) mod chunk;
mod tokens;

pub(crate) use tokens::tokens;

use crate::host::error::{ShadingError, ShadingErrorKind};
use crate::host::gbuffer::Channels;
use crate::host::table::TextureTier;
use crate::{HOST_GROUP, SECOND_HOST_GROUP};
use naga::common::wgsl::TypeContext as _;
use std::ops::Range;
use tokens::{declarations, unclosed};

/// The WGSL of `daa_texture` on a tier, without the directive that the binding tier needs.
pub(crate) fn table_chunk(tier: TextureTier) -> &'static str {
    match tier {
        TextureTier::None => chunk::TABLE_NONE,
        TextureTier::Arrays => chunk::TABLE_ARRAYS,
        TextureTier::Bindings => chunk::TABLE_BINDINGS,
    }
}

/// The directives of a tier. They must come first in a module, so they go in front of the host's source.
pub(crate) fn directives(tier: TextureTier) -> &'static str {
    match tier {
        TextureTier::Bindings => "enable wgpu_binding_array;\n",
        _ => "",
    }
}

/// The groups in which the host may bind: where no texture table is, its group is free.
fn host_groups(tier: TextureTier) -> &'static [u32] {
    match tier {
        TextureTier::None => &[HOST_GROUP, SECOND_HOST_GROUP],
        TextureTier::Arrays | TextureTier::Bindings => &[HOST_GROUP],
    }
}

/// The host's WGSL after a successful check.
#[derive(Debug, Clone)]
pub(crate) struct HostSource {
    pub source: String,
    tier: TextureTier,
    hook: Hook,
    sky: bool,
    /// Whether it has `solid`, for masked materials.
    pub solid: bool,
    /// Whether it has `spread`, for `Surfaces`.
    spread: bool,
    /// Whether it has `reflection`, for reflections and refractions.
    pub reflects: bool,
    /// The attributes of a sample that it reads and a G-buffer may leave out: the field, and its first line and column.
    reads: Vec<(&'static str, [u32; 2])>,
}

/// The host's functions that shade a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hook {
    /// `shade`.
    Whole,
    /// `material`, and `light` that returns radiance.
    Split,
    /// `material`, and `light` that returns `DaaLight`.
    Parts,
}

/// The fields of `DaaSample` and `DaaSurface` that a G-buffer may leave out.
const CHANNELS: [&str; 6] = ["uv", "ddx", "ddy", "tangent", "geometric_normal", "user"];

const SHADE: (&str, &str) = ("shade", "fn shade(s: DaaSample) -> vec4f");
const MATERIAL: (&str, &str) = ("material", "fn material(s: DaaSample) -> DaaMaterial");
const LIGHT: (&str, &str) = ("light", "fn light(f: DaaSurface, m: DaaMaterial) -> vec4f");
const LIGHT_IN_PARTS: (&str, &str) = ("light", "fn light(f: DaaSurface, m: DaaMaterial) -> DaaLight");
const SKY: (&str, &str) = ("sky", "fn sky(s: DaaSample) -> vec4f");
const REFLECTION: (&str, &str) = ("reflection", "fn reflection(s: DaaSample) -> DaaReflection");
const SPREAD: (&str, &str) = ("spread", "fn spread(s: DaaSample, m: DaaMaterial) -> DaaSpread");
const SOLID: (&str, &str) = ("solid", "fn solid(material: u32, uv: vec2f, user: u32) -> bool");

/// A type of a hook's signature.
#[derive(Debug, Clone, Copy)]
enum Type {
    Struct(&'static str),
    Plain(naga::Scalar, Option<naga::VectorSize>),
}

impl Type {
    const VEC4F: Self = Self::Plain(naga::Scalar::F32, Some(naga::VectorSize::Quad));
    const VEC2F: Self = Self::Plain(naga::Scalar::F32, Some(naga::VectorSize::Bi));
    const U32: Self = Self::Plain(naga::Scalar::U32, None);
    const BOOL: Self = Self::Plain(naga::Scalar::BOOL, None);

    fn is(self, found: &naga::Type) -> bool {
        match self {
            Self::Struct(name) => found.name.as_deref() == Some(name),
            Self::Plain(scalar, None) => found.inner == naga::TypeInner::Scalar(scalar),
            Self::Plain(scalar, Some(size)) => found.inner == naga::TypeInner::Vector { size, scalar },
        }
    }
}

impl HostSource {
    /// Parses and validates the host's source joined with the contract, on the capabilities of the device.
    pub fn check(source: &str, file: &str, tier: TextureTier, features: wgpu::Features) -> Result<Self, ShadingError> {
        let contract = [chunk::CONTRACT, chunk::OCTAHEDRAL, table_chunk(tier)];
        let joined = Joined::new(directives(tier), source, &contract);
        let at = |range: Option<Range<usize>>, kind| joined.error(file, range, kind);

        // Checked before the parser runs, which would accept a name that the crate reserves or relies on, or report an
        // error in the crate's own text.
        for (name, range) in joined.declared() {
            if ["daa_", "Daa", "DAA_"].iter().any(|prefix| name.starts_with(prefix)) {
                return Err(at(Some(range), ShadingErrorKind::ReservedName(name.to_owned())));
            }
            if BUILTINS.contains(&name) {
                return Err(at(Some(range), ShadingErrorKind::Clash(name.to_owned())));
            }
        }
        let module = naga::front::wgsl::parse_str(&joined.text).map_err(|e| joined.parse_error(file, tier, &e))?;
        if let (Some(range), false) = (joined.enables("f16"), features.contains(wgpu::Features::SHADER_F16)) {
            let what = "`f16` needs a device with Features::SHADER_F16; request it, or use f32".to_owned();
            return Err(at(Some(range), ShadingErrorKind::Wgsl(what)));
        }
        for (_, variable) in module.global_variables.iter() {
            let name = variable.name.clone().unwrap_or_default();
            if let (Some(range), Some(binding)) = (joined.declaration(&name), &variable.binding)
                && !host_groups(tier).contains(&binding.group)
            {
                return Err(at(Some(range), ShadingErrorKind::Group { name, group: binding.group }));
            }
        }
        let hook = joined.hook(file, &module)?;
        let sky = joined.signature(file, &module, SKY, &[Type::Struct("DaaSample")], Type::VEC4F)?;
        let reflects =
            joined.signature(file, &module, REFLECTION, &[Type::Struct("DaaSample")], Type::Struct("DaaReflection"))?;
        let spread = joined.signature(
            file,
            &module,
            SPREAD,
            &[Type::Struct("DaaSample"), Type::Struct("DaaMaterial")],
            Type::Struct("DaaSpread"),
        )?;
        let solid = joined.signature(file, &module, SOLID, &[Type::U32, Type::VEC2F, Type::U32], Type::BOOL)?;

        let capabilities = wgpu_naga_bridge::features_to_naga_capabilities(features, wgpu::DownlevelFlags::all());
        let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities);
        let info = validator.validate(&module).map_err(|e| joined.validation_error(file, &module, &e))?;
        for (handle, function) in module.functions.iter() {
            let name = function.name.as_deref().unwrap_or_default();
            let range = joined.declaration(name);
            if range.is_some() && !info[handle].available_stages.contains(naga::valid::ShaderStages::COMPUTE) {
                let what = format!("`{name}` takes a derivative or samples with an implicit one");
                return Err(at(range, ShadingErrorKind::Derivative(what)));
            }
        }
        let reads = joined.channels(&module, &info);
        Ok(Self { source: source.to_owned(), tier, hook, sky, solid, spread, reflects, reads })
    }

    /// Checks that the source reads nothing that a stored G-buffer leaves out. `file` is named in the error.
    pub fn check_channels(&self, file: &str, channels: Channels) -> Result<(), ShadingError> {
        let missing = channels.missing().find_map(|name| self.reads.iter().find(|read| read.0 == name));
        let Some(&(name, [line, column])) = missing else { return Ok(()) };
        Err(ShadingError { file: file.to_owned(), line, column, kind: ShadingErrorKind::Channel(name) })
    }

    /// The functions through which the crate calls the host's functions.
    pub fn calls(&self) -> [&'static str; 2] {
        let hook = match self.hook {
            Hook::Whole => "fn daa_call_hook(s: DaaSample, coverage: f32) -> vec4f { return shade(s); }",
            Hook::Split => {
                "fn daa_call_hook(s: DaaSample, coverage: f32) -> vec4f { return light(daa_surface(s, coverage), material(s)); }"
            }
            Hook::Parts => {
                "fn daa_call_hook(s: DaaSample, coverage: f32) -> vec4f {
    let m = material(s);
    return daa_radiance(light(daa_surface(s, coverage), m), m);
}"
            }
        };
        let sky = if self.sky {
            "fn daa_call_sky(s: DaaSample) -> vec4f { return sky(s); }"
        } else {
            "fn daa_call_sky(s: DaaSample) -> vec4f { return vec4f(0.0); }"
        };
        [hook, sky]
    }

    /// Whether the host has `shade`, in place of `material` and `light`.
    pub fn shades_whole(&self) -> bool {
        self.hook == Hook::Whole
    }

    /// The functions through which `light` of `Surfaces` calls the host's functions apart.
    pub fn split_calls(&self) -> [&'static str; 2] {
        let split = match self.hook {
            Hook::Whole => {
                "const DAA_SPLIT_HOOK: bool = false;
const DAA_LIGHT_IN_PARTS: bool = false;
fn daa_call_material(s: DaaSample) -> DaaMaterial { return DaaMaterial(); }
fn daa_call_light(f: DaaSurface, m: DaaMaterial) -> DaaLight { return DaaLight(); }
fn daa_of_light(l: DaaLight, m: DaaMaterial) -> vec4f { return l.rest; }"
            }
            Hook::Split => {
                "const DAA_SPLIT_HOOK: bool = true;
const DAA_LIGHT_IN_PARTS: bool = false;
fn daa_call_material(s: DaaSample) -> DaaMaterial { return material(s); }
fn daa_call_light(f: DaaSurface, m: DaaMaterial) -> DaaLight { return DaaLight(vec3f(0.0), light(f, m)); }
fn daa_of_light(l: DaaLight, m: DaaMaterial) -> vec4f { return l.rest; }"
            }
            Hook::Parts => {
                "const DAA_SPLIT_HOOK: bool = true;
const DAA_LIGHT_IN_PARTS: bool = true;
fn daa_call_material(s: DaaSample) -> DaaMaterial { return material(s); }
fn daa_call_light(f: DaaSurface, m: DaaMaterial) -> DaaLight { return light(f, m); }
fn daa_of_light(l: DaaLight, m: DaaMaterial) -> vec4f { return daa_radiance(l, m); }"
            }
        };
        let spread = if self.spread {
            "fn daa_call_spread(s: DaaSample, m: DaaMaterial) -> DaaSpread { return spread(s, m); }"
        } else {
            "fn daa_call_spread(s: DaaSample, m: DaaMaterial) -> DaaSpread { return daa_default_spread(s, m); }"
        };
        [split, spread]
    }

    /// The body of the function that rays call for masked meshes.
    pub fn solid_call(&self) -> &'static str {
        if self.solid {
            "fn daa_ray_solid(material: u32, uv: vec2f, user: u32) -> bool { return solid(material, uv, user); }"
        } else {
            "fn daa_ray_solid(material: u32, uv: vec2f, user: u32) -> bool { return true; }"
        }
    }

    /// The directives that go in front of the source.
    pub fn directives(&self) -> &'static str {
        directives(self.tier)
    }

    /// `daa_texture` on the tier that the source was checked for.
    pub fn table_chunk(&self) -> &'static str {
        table_chunk(self.tier)
    }
}

/// The name of a field of `DaaSample` or `DaaSurface`, by its index in an expression of this type.
fn field<'m>(module: &'m naga::Module, ty: &naga::proc::TypeResolution, index: u32) -> Option<&'m str> {
    let mut handle = ty.handle();
    if let naga::TypeInner::Pointer { base, .. } = *ty.inner_with(&module.types) {
        handle = Some(base);
    }
    let ty = &module.types[handle?];
    let naga::TypeInner::Struct { members, .. } = &ty.inner else { return None };
    let of_sample = ["DaaSample", "DaaSurface"].contains(&ty.name.as_deref()?);
    members.get(index as usize)?.name.as_deref().filter(|_| of_sample)
}

/// The host's source joined with chunks, and its range in the joined text.
struct Joined {
    text: String,
    host: Range<usize>,
}

impl Joined {
    fn new(before: &str, host: &str, after: &[&str]) -> Self {
        let start = before.len();
        let mut text = format!("{before}{host}\n");
        for chunk in after {
            text.push_str(chunk);
            text.push('\n');
        }
        Self { text, host: start..start + host.len() }
    }

    fn in_host(&self, range: Option<&Range<usize>>) -> bool {
        range.is_some_and(|r| self.host.contains(&r.start))
    }

    /// An error at a range of the joined text, with the line and column in the host's file.
    fn error(&self, file: &str, range: Option<Range<usize>>, kind: ShadingErrorKind) -> ShadingError {
        let [line, column] = self.position(range);
        ShadingError { file: file.to_owned(), line, column, kind }
    }

    /// The line and the column of a range in the host's file, 0 if it is not the host's.
    fn position(&self, range: Option<Range<usize>>) -> [u32; 2] {
        let Some(range) = range.filter(|r| (self.host.start..=self.host.end).contains(&r.start)) else { return [0; 2] };
        let before = &self.text[self.host.start..range.start];
        let line = before.matches('\n').count() as u32 + 1;
        [line, before.chars().rev().take_while(|&c| c != '\n').count() as u32 + 1]
    }

    /// The [`CHANNELS`] that the host's own functions read, with the first place of each.
    fn channels(&self, module: &naga::Module, info: &naga::valid::ModuleInfo) -> Vec<(&'static str, [u32; 2])> {
        let mut reads: Vec<(&'static str, [u32; 2])> = Vec::new();
        let mut note = |name, place| {
            if !reads.iter().any(|read| read.0 == name) {
                reads.push((name, place));
            }
        };
        for (handle, function) in module.functions.iter() {
            let of_host = self.declaration(function.name.as_deref().unwrap_or_default()).is_some();
            for (at, expression) in function.expressions.iter().filter(|_| of_host) {
                let naga::Expression::AccessIndex { base, index } = *expression else { continue };
                let place = self.position(function.expressions.get_span(at).to_range());
                let field = field(module, &info[handle][base].ty, index);
                if let Some(name) = CHANNELS.into_iter().find(|name| field == Some(*name)) {
                    note(name, place);
                }
            }
        }
        // It reads the tangent for the host.
        const NORMAL_MAP: &str = "daa_apply_normal_map";
        let host = tokens(&self.text[self.host.clone()]);
        if let Some((at, _)) = host.into_iter().find(|&(_, token)| token == NORMAL_MAP) {
            let start = self.host.start + at;
            note("tangent", self.position(Some(start..start + NORMAL_MAP.len())));
        }
        reads
    }

    fn parse_error(&self, file: &str, tier: TextureTier, e: &naga::front::wgsl::ParseError) -> ShadingError {
        let mut message = one_line(e.message());
        if tier == TextureTier::None && message.ends_with("`daa_texture`") {
            message += ", which TextureTier::None does not have; set Descriptor::textures to another tier";
        }
        let host = e.labels().filter_map(|(span, _)| span.to_range()).find(|r| self.in_host(Some(r)));
        if let Some(range) = host {
            let notes = one_line(&e.notes().collect::<Vec<_>>().join(" "));
            let told = if notes.is_empty() { message } else { format!("{message}; {notes}") };
            return self.error(file, Some(range), ShadingErrorKind::Wgsl(told));
        }
        // The parser continued into the crate's text, so something is not closed in the host's.
        let host = &self.text[self.host.clone()];
        match unclosed(host) {
            Some(at) => {
                let what = format!("this `{}` is not closed before the end of the source", &host[at..=at]);
                self.error(file, Some(self.host.start + at..self.host.end), ShadingErrorKind::Wgsl(what))
            }
            None => {
                let end = self.host.start + host.trim_end().len();
                let what = "the source ends inside a declaration; is a semicolon missing?".to_owned();
                self.error(file, Some(end..self.host.end), ShadingErrorKind::Wgsl(what))
            }
        }
    }

    fn validation_error(
        &self,
        file: &str,
        module: &naga::Module,
        e: &naga::WithSpan<naga::valid::ValidationError>,
    ) -> ShadingError {
        let message = explain(module, e.as_inner());
        // The narrowest span is the most precise. Without a span, a name that the message quotes is located.
        let narrowest = e
            .spans()
            .filter_map(|(span, _)| span.to_range())
            .filter(|r| self.in_host(Some(r)))
            .min_by_key(ExactSizeIterator::len);
        let quoted = message.split('`').nth(1).unwrap_or_default();
        let host = tokens(&self.text[self.host.clone()]);
        let range = narrowest.or_else(|| {
            let (at, word) = host.into_iter().find(|&(_, token)| token == quoted)?;
            Some(self.host.start + at..self.host.start + at + word.len())
        });
        self.error(file, range, ShadingErrorKind::Wgsl(message))
    }

    /// The names that the host declares at module scope, with their ranges.
    fn declared(&self) -> Vec<(&str, Range<usize>)> {
        let place = |(at, name): (usize, _)| (name, self.host.start + at..self.host.start + at + str::len(name));
        declarations(&self.text[self.host.clone()]).into_iter().map(place).collect()
    }

    /// The range in which the host enables an extension.
    fn enables(&self, extension: &str) -> Option<Range<usize>> {
        let tokens = tokens(&self.text[self.host.clone()]);
        let enabled = tokens.iter().zip(tokens.iter().skip(1)).find(|(a, b)| a.1 == "enable" && b.1 == extension);
        let at = self.host.start + enabled?.1.0;
        Some(at..at + extension.len())
    }

    /// The range in which the host declares a name.
    fn declaration(&self, name: &str) -> Option<Range<usize>> {
        self.declared().into_iter().find(|(declared, _)| *declared == name).map(|(_, range)| range)
    }

    /// The host's functions that shade a sample.
    fn hook(&self, file: &str, module: &naga::Module) -> Result<Hook, ShadingError> {
        let [sample, surface, material] = ["DaaSample", "DaaSurface", "DaaMaterial"].map(Type::Struct);
        let shade = self.signature(file, module, SHADE, &[sample], Type::VEC4F)?;
        let in_parts = self.signature(file, module, LIGHT_IN_PARTS, &[surface, material], Type::Struct("DaaLight"));
        let parts = matches!(in_parts, Ok(true));
        let light = parts || self.signature(file, module, LIGHT, &[surface, material], Type::VEC4F)?;
        let material = self.signature(file, module, MATERIAL, &[sample], material)?;
        let wrong = |name: &str, kind| self.error(file, self.declaration(name), kind);
        match (shade, material, light) {
            (true, false, false) => Ok(Hook::Whole),
            (false, true, true) => Ok(if parts { Hook::Parts } else { Hook::Split }),
            (false, true, false) => {
                Err(wrong("material", ShadingErrorKind::HalfHook { have: "material", missing: LIGHT.1 }))
            }
            (false, false, true) => {
                Err(wrong("light", ShadingErrorKind::HalfHook { have: "light", missing: MATERIAL.1 }))
            }
            (false, false, false) => Err(self.error(file, None, ShadingErrorKind::NoHook)),
            (true, ..) => Err(wrong("shade", ShadingErrorKind::TwoHooks)),
        }
    }

    /// Whether the host has a function. It is an error if the function has another signature.
    fn signature(
        &self,
        file: &str,
        module: &naga::Module,
        (name, expected): (&'static str, &'static str),
        arguments: &[Type],
        result: Type,
    ) -> Result<bool, ShadingError> {
        let Some((_, function)) = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name)) else {
            return Ok(false);
        };
        let right_arguments = function.arguments.len() == arguments.len()
            && function.arguments.iter().zip(arguments).all(|(a, wanted)| wanted.is(&module.types[a.ty]));
        let right_result = function.result.as_ref().is_some_and(|r| result.is(&module.types[r.ty]));
        if right_arguments && right_result {
            return Ok(true);
        }
        Err(self.error(file, self.declaration(name), ShadingErrorKind::Signature { name, expected }))
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The built-in names of WGSL that the crate's code calls or uses as types. WGSL allows a host to redeclare them, which
/// would change the meaning of the crate's code. A test compares the list with the shaders.
#[rustfmt::skip]
pub(crate) const BUILTINS: &[&str] = &[
    "RayDesc", "abs", "all", "any", "array", "arrayLength", "atan2", "atomic", "atomicAdd", "atomicLoad", "atomicMax", "atomicOr", "atomicStore", "binding_array",
    "bitcast", "bool", "clamp", "cos", "countOneBits", "cross", "dot", "exp2", "f32", "firstLeadingBit", "firstTrailingBit", "floor", "fract", "i32", "inverseSqrt", "length", "log2",
    "mat3x3f", "mat4x2f", "mat4x4f", "max", "min", "mix", "normalize", "pack2x16float", "pack2x16snorm", "pack4x8unorm", "pow", "rayQueryConfirmIntersection", "rayQueryGetCandidateIntersection", "rayQueryGetCommittedIntersection",
    "rayQueryInitialize", "rayQueryProceed", "reflect", "refract", "round", "sampler", "select", "sign", "sin", "sqrt", "textureLoad",
    "textureSampleGrad", "textureStore", "texture_2d", "texture_2d_array", "texture_storage_2d",
    "u32", "unpack2x16float", "unpack2x16snorm", "unpack4x8snorm", "unpack4x8unorm", "vec2f", "vec2i", "vec2u",
    "vec3f", "vec3u", "vec4f", "vec4i", "vec4u", "workgroupBarrier", "workgroupUniformLoad",
];

/// The error of naga's validator, without the handles that mean nothing to a host.
fn explain(module: &naga::Module, e: &naga::valid::ValidationError) -> String {
    use naga::valid::{CallError, ExpressionError, FunctionError, GlobalVariableError, ValidationError};
    let within = match e {
        ValidationError::Function { name, .. } => format!("in `{name}`: "),
        ValidationError::Type { name, .. }
        | ValidationError::Constant { name, .. }
        | ValidationError::Override { name, .. }
        | ValidationError::GlobalVariable { name, .. }
            if !name.is_empty() =>
        {
            format!("`{name}`: ")
        }
        _ => String::new(),
    };
    let what = match e {
        ValidationError::Function {
            source:
                FunctionError::Expression {
                    source: ExpressionError::InvalidBinaryOperandTypes { op, lhs_type, rhs_type, .. },
                    ..
                },
            ..
        } => {
            let [left, right] = [lhs_type, rhs_type]
                .map(|t| module.types.type_resolution_to_string(&naga::proc::TypeResolution::Value(t.clone())));
            format!("{op:?} can't work with {left} and {right}; convert one of them")
        }
        ValidationError::Function { source: FunctionError::InvalidReturnType { expression, expected_ty }, .. } => {
            let declared = expected_ty.map_or("nothing".to_owned(), |ty| module.types.type_to_string(ty));
            let found = if expression.is_some() { "this is something else" } else { "it ends without a return" };
            format!("the function returns {declared}, {found}")
        }
        ValidationError::GlobalVariable { source: GlobalVariableError::MissingTypeFlags { .. }, .. } => {
            "no buffer holds a value of its type; use u32 in place of bool".to_owned()
        }
        ValidationError::Function {
            source: FunctionError::InvalidCall { error: CallError::ArgumentType { index, required, .. }, .. },
            ..
        } => format!("argument {} must be {}", index + 1, module.types.type_to_string(*required)),
        _ => {
            let mut deepest: &dyn std::error::Error = e;
            while let Some(inner) = deepest.source() {
                deepest = inner;
            }
            without_handles(&one_line(&deepest.to_string()))
        }
    };
    // Named as wgpu names them.
    within
        + &what.replace("the `naga::valid::Capabilities::FLOAT64` flag", "a device with Features::SHADER_F64; use f32")
}

/// Removes the numbers of expressions and types, which naga writes as [7].
fn without_handles(text: &str) -> String {
    let is_handle = |word: &&str| !(word.starts_with('[') && word.ends_with(']'));
    text.split(' ').filter(is_handle).collect::<Vec<_>>().join(" ")
}
