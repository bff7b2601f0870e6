//! Joins the host's WGSL with the crate's, verbatim, and checks the host's part before wgpu sees it.

use crate::effects::Traced;
use crate::error::{ShadingError, ShadingErrorKind};
use crate::rays::RayTier;
use crate::table::TextureTier;
use naga::common::wgsl::TypeContext as _;
use std::fmt::Write as _;
use std::ops::Range;

/// The crate's chunks of WGSL.
pub(crate) mod chunk {
    pub const CONTRACT: &str = crate::CONTRACT_WGSL;
    pub const OCTAHEDRAL: &str = include_str!("../shaders/octahedral.wgsl");
    pub const SAMPLE: &str = include_str!("../shaders/sample.wgsl");
    pub const MEAN: &str = include_str!("../shaders/mean.wgsl");
    pub const STATISTICS: &str = include_str!("../shaders/statistics.wgsl");
    pub const EVALUATE: &str = include_str!("../shaders/evaluate.wgsl");
    pub const SHADOWS: &str = include_str!("../shaders/shadows.wgsl");
    pub const SHADOWS_NONE: &str = include_str!("../shaders/shadows_none.wgsl");
    pub const SECONDARY: &str = include_str!("../shaders/secondary.wgsl");
    pub const SECONDARY_NONE: &str = include_str!("../shaders/secondary_none.wgsl");
    pub const SHARED_EXPONENT: &str = include_str!("../shaders/shared_exponent.wgsl");
    pub const LATTICE: &str = include_str!("../shaders/lattice.wgsl");
    pub const LISTING: &str = include_str!("../shaders/listing.wgsl");
    pub const CASTING: &str = include_str!("../shaders/casting.wgsl");
    pub const RAYS: &str = include_str!("../shaders/rays.wgsl");
    pub const RAYS_SOFTWARE: &str = include_str!("../shaders/rays_software.wgsl");
    pub const RAYS_QUERY: &str = include_str!("../shaders/rays_query.wgsl");
    pub const TABLE_NONE: &str = include_str!("../shaders/table_none.wgsl");
    pub const TABLE_ARRAYS: &str = include_str!("../shaders/table_arrays.wgsl");
    pub const TABLE_BINDINGS: &str = include_str!("../shaders/table_bindings.wgsl");
}

/// The WGSL of `daa_texture` on a tier, without the directive that the binding tier needs.
pub(crate) fn table_chunk(tier: TextureTier) -> &'static str {
    match tier {
        TextureTier::None => chunk::TABLE_NONE,
        TextureTier::Arrays => chunk::TABLE_ARRAYS,
        TextureTier::Bindings => chunk::TABLE_BINDINGS,
    }
}

/// Directives come before all else, so this goes in front of the host's source.
pub(crate) fn directives(tier: TextureTier) -> &'static str {
    match tier {
        TextureTier::Bindings => "enable wgpu_binding_array;\n",
        _ => "",
    }
}

/// The host's WGSL, found sound.
#[derive(Debug, Clone)]
pub(crate) struct HostSource {
    pub source: String,
    tier: TextureTier,
    split: bool,
    sky: bool,
    /// It says where masked materials are solid.
    pub solid: bool,
    /// It says what surfaces reflect and refract.
    pub bounces: bool,
}

const SHADE: (&str, &str) = ("shade", "fn shade(s: DaaSample) -> vec4f");
const MATERIAL: (&str, &str) = ("material", "fn material(s: DaaSample) -> DaaMaterial");
const LIGHT: (&str, &str) = ("light", "fn light(f: DaaSurface, m: DaaMaterial) -> vec4f");
const SKY: (&str, &str) = ("sky", "fn sky(s: DaaSample) -> vec4f");
const BOUNCE: (&str, &str) = ("bounce", "fn bounce(s: DaaSample) -> DaaBounce");
const SOLID: (&str, &str) = ("solid", "fn solid(material: u32, uv: vec2f) -> bool");

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

        // Before the parser, which would take a name of the crate's, or one that its code relies on, without a word or
        // complain about the crate's own text.
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
                && binding.group != crate::HOST_GROUP
            {
                return Err(at(Some(range), ShadingErrorKind::Group { name, group: binding.group }));
            }
        }
        if let Some(entry) = module.entry_points.first() {
            let range = joined.declaration(&entry.name);
            return Err(at(range, ShadingErrorKind::EntryPoint(entry.name.clone())));
        }
        let split = joined.hook(file, &module)?;
        let sky = joined.signature(file, &module, SKY, &[Type::Struct("DaaSample")], Type::VEC4F)?;
        let bounces =
            joined.signature(file, &module, BOUNCE, &[Type::Struct("DaaSample")], Type::Struct("DaaBounce"))?;
        let solid = joined.signature(file, &module, SOLID, &[Type::U32, Type::VEC2F], Type::BOOL)?;

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
        Ok(Self { source: source.to_owned(), tier, split, sky, solid, bounces })
    }

    /// A module that shades: the host's source, the contract, what reads and averages samples, and a pass.
    pub fn join(&self, pass: &str, traced: Traced) -> String {
        let [hook, sky] = self.calls();
        let [shadows, secondary] = found(traced);
        join(&[
            directives(self.tier),
            &self.source,
            chunk::CONTRACT,
            chunk::OCTAHEDRAL,
            table_chunk(self.tier),
            chunk::SAMPLE,
            chunk::SHARED_EXPONENT,
            shadows,
            secondary,
            chunk::MEAN,
            chunk::STATISTICS,
            hook,
            sky,
            chunk::EVALUATE,
            pass,
        ])
    }

    /// How the crate calls the host's functions.
    fn calls(&self) -> [&'static str; 2] {
        let hook = if self.split {
            "fn daa_call_hook(s: DaaSample, coverage: f32) -> vec4f { return light(daa_surface(s, coverage), material(s)); }"
        } else {
            "fn daa_call_hook(s: DaaSample, coverage: f32) -> vec4f { return shade(s); }"
        };
        let sky = if self.sky {
            "fn daa_call_sky(s: DaaSample) -> vec4f { return sky(s); }"
        } else {
            "fn daa_call_sky(s: DaaSample) -> vec4f { return vec4f(0.0); }"
        };
        [hook, sky]
    }

    /// A module that traces. Without `shades`, with the host's source only if that says where materials are solid.
    pub fn join_traced(&self, pass: &str, tier: RayTier, shades: bool) -> String {
        let (directive, nodes, traversal) = match tier {
            RayTier::Software => {
                ("", "@group(3) @binding(0) var<storage, read> daa_ray_nodes: array<vec4u>;", chunk::RAYS_SOFTWARE)
            }
            RayTier::Query => (
                "enable wgpu_ray_query;",
                "@group(3) @binding(0) var daa_ray_tlas: acceleration_structure;",
                chunk::RAYS_QUERY,
            ),
        };
        let (tables, source, table) = if self.solid || shades {
            (directives(self.tier), &self.source[..], table_chunk(self.tier))
        } else {
            ("", "", "")
        };
        let solid = if self.solid { "return solid(material, uv);" } else { "return true;" };
        let [hook, sky] = if shades { self.calls() } else { ["", ""] };
        let bounce = if shades { "fn daa_call_bounce(s: DaaSample) -> DaaBounce { return bounce(s); }" } else { "" };
        join(&[
            directive,
            tables,
            source,
            chunk::CONTRACT,
            chunk::OCTAHEDRAL,
            table,
            chunk::SAMPLE,
            chunk::SHARED_EXPONENT,
            chunk::SHADOWS_NONE,
            chunk::SECONDARY_NONE,
            chunk::MEAN,
            chunk::STATISTICS,
            hook,
            sky,
            bounce,
            nodes,
            "fn daa_ray_solid(material: u32, uv: vec2f) -> bool {",
            solid,
            "}",
            chunk::RAYS,
            traversal,
            chunk::LATTICE,
            chunk::LISTING,
            chunk::CASTING,
            pass,
        ])
    }
}

/// A module of the crate's own that only reads the G-buffer.
pub(crate) fn join_plain(pass: &str) -> String {
    join_reading(pass, Traced::default())
}

/// The same, which reads what was traced, too.
pub(crate) fn join_reading(pass: &str, traced: Traced) -> String {
    let [shadows, secondary] = found(traced);
    join(&[
        chunk::CONTRACT,
        chunk::OCTAHEDRAL,
        chunk::SAMPLE,
        chunk::SHARED_EXPONENT,
        shadows,
        secondary,
        chunk::STATISTICS,
        pass,
    ])
}

/// What reads what was traced.
fn found(traced: Traced) -> [&'static str; 2] {
    [
        if traced.shadows { chunk::SHADOWS } else { chunk::SHADOWS_NONE },
        if traced.secondary { chunk::SECONDARY } else { chunk::SECONDARY_NONE },
    ]
}

fn join(chunks: &[&str]) -> String {
    let mut text = String::with_capacity(chunks.iter().map(|c| c.len() + 1).sum());
    for chunk in chunks {
        // Infallible for a String.
        let _ = writeln!(text, "{chunk}");
    }
    text
}

/// The host's source with chunks around it, and where it lies in there.
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

    /// An error at a place of the joined text, told in lines and columns of the host's file.
    fn error(&self, file: &str, range: Option<Range<usize>>, kind: ShadingErrorKind) -> ShadingError {
        let (mut line, mut column) = (0, 0);
        if let Some(range) = range.filter(|r| (self.host.start..=self.host.end).contains(&r.start)) {
            let before = &self.text[self.host.start..range.start];
            line = before.matches('\n').count() as u32 + 1;
            column = before.chars().rev().take_while(|&c| c != '\n').count() as u32 + 1;
        }
        ShadingError { file: file.to_owned(), line, column, kind }
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
        // The parser ran on into the crate's text: something is left open in the host's.
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
        // The narrowest span says most; without one, a name that the message quotes.
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

    /// The names that the host declares at module scope, and where.
    fn declared(&self) -> Vec<(&str, Range<usize>)> {
        let place = |(at, name): (usize, _)| (name, self.host.start + at..self.host.start + at + str::len(name));
        declarations(&self.text[self.host.clone()]).into_iter().map(place).collect()
    }

    /// Where the host enables an extension.
    fn enables(&self, extension: &str) -> Option<Range<usize>> {
        let tokens = tokens(&self.text[self.host.clone()]);
        let enabled = tokens.iter().zip(tokens.iter().skip(1)).find(|(a, b)| a.1 == "enable" && b.1 == extension);
        let at = self.host.start + enabled?.1.0;
        Some(at..at + extension.len())
    }

    /// Where the host declares a name.
    fn declaration(&self, name: &str) -> Option<Range<usize>> {
        self.declared().into_iter().find(|(declared, _)| *declared == name).map(|(_, range)| range)
    }

    /// Which hook the host wrote: true for `material` and `light`, false for `shade`.
    fn hook(&self, file: &str, module: &naga::Module) -> Result<bool, ShadingError> {
        let [sample, surface, material] = ["DaaSample", "DaaSurface", "DaaMaterial"].map(Type::Struct);
        let shade = self.signature(file, module, SHADE, &[sample], Type::VEC4F)?;
        let light = self.signature(file, module, LIGHT, &[surface, material], Type::VEC4F)?;
        let material = self.signature(file, module, MATERIAL, &[sample], material)?;
        let wrong = |name: &str, kind| self.error(file, self.declaration(name), kind);
        match (shade, material, light) {
            (true, false, false) => Ok(false),
            (false, true, true) => Ok(true),
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

    /// Whether a function is there; an error if it is, with another signature.
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

/// WGSL's own names that the crate's code calls or uses as types. A host may declare them anew by the rules of WGSL, and
/// would change what the crate's code means. A test holds the list against the shaders.
#[rustfmt::skip]
pub(crate) const BUILTINS: &[&str] = &[
    "RayDesc", "abs", "all", "any", "array", "arrayLength", "atan2", "atomic", "atomicAdd", "atomicLoad", "atomicOr", "atomicStore", "binding_array",
    "bitcast", "bool", "clamp", "cos", "countOneBits", "cross", "dot", "exp2", "f32", "firstLeadingBit", "firstTrailingBit", "floor", "fract", "i32", "inverseSqrt", "length", "log2",
    "mat3x3f", "mat4x2f", "mat4x4f", "max", "min", "normalize", "pack2x16snorm", "pow", "rayQueryConfirmIntersection", "rayQueryGetCandidateIntersection", "rayQueryGetCommittedIntersection",
    "rayQueryInitialize", "rayQueryProceed", "reflect", "refract", "round", "sampler", "select", "sign", "sin", "sqrt", "textureLoad",
    "textureSampleGrad", "textureStore", "texture_2d", "texture_2d_array", "texture_storage_2d",
    "u32", "unpack2x16float", "unpack2x16snorm", "unpack4x8snorm", "unpack4x8unorm", "vec2f", "vec2i", "vec2u",
    "vec3f", "vec3u", "vec4f", "vec4i", "vec4u", "workgroupBarrier", "workgroupUniformLoad",
];

/// Identifiers, numbers and single characters of WGSL with their places, comments left out.
pub(crate) fn tokens(source: &str) -> Vec<(usize, &str)> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = source[at..].chars().next() {
        let rest = &source[at..];
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            comment(rest)
        } else if is_word(c) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        if !c.is_whitespace() && !rest.starts_with("//") && !rest.starts_with("/*") {
            tokens.push((at, &rest[..length]));
        }
        at += length;
    }
    tokens
}

/// The length of a block comment; block comments nest.
fn comment(text: &str) -> usize {
    let (mut at, mut depth) = (0, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            (at, depth) = (at + 2, depth + 1);
        } else if rest.starts_with("*/") {
            (at, depth) = (at + 2, depth - 1);
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
        if depth == 0 {
            break;
        }
    }
    at
}

/// The names that are declared at module scope, and where.
fn declarations(source: &str) -> Vec<(usize, &str)> {
    let mut names = Vec::new();
    let mut depth = 0;
    let mut tokens = tokens(source).into_iter();
    while let Some((_, token)) = tokens.next() {
        match token {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            "fn" | "struct" | "alias" | "const" | "override" if depth == 0 => names.extend(tokens.next()),
            // var<storage, read> name
            "var" if depth == 0 => match tokens.next() {
                Some((_, "<")) => {
                    tokens.by_ref().find(|t| t.1 == ">");
                    names.extend(tokens.next());
                }
                name => names.extend(name),
            },
            _ => {}
        }
    }
    names
}

/// The first bracket that nothing closes.
fn unclosed(source: &str) -> Option<usize> {
    let mut open = Vec::new();
    for (at, token) in tokens(source) {
        match token {
            "{" | "(" | "[" => open.push(at),
            "}" | ")" | "]" => drop(open.pop()),
            _ => {}
        }
    }
    open.first().copied()
}

/// What naga's validator found, without the handles that mean nothing to a host.
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

/// naga numbers expressions and types as [7].
fn without_handles(text: &str) -> String {
    let is_handle = |word: &&str| !(word.starts_with('[') && word.ends_with(']'));
    text.split(' ').filter(is_handle).collect::<Vec<_>>().join(" ")
}
