//! Joins the host's WGSL with the crate's, verbatim, and checks the host's part before wgpu sees it.

use crate::error::{ShadingError, ShadingErrorKind};
use crate::table::TextureTier;
use std::error::Error as _;
use std::fmt::Write as _;
use std::ops::Range;

/// The crate's chunks of WGSL.
pub(crate) mod chunk {
    pub const CONTRACT: &str = include_str!("../shaders/contract.wgsl");
    pub const OCTAHEDRAL: &str = include_str!("../shaders/octahedral.wgsl");
    pub const SAMPLE: &str = include_str!("../shaders/sample.wgsl");
    pub const MEAN: &str = include_str!("../shaders/mean.wgsl");
    pub const STATISTICS: &str = include_str!("../shaders/statistics.wgsl");
    pub const EVALUATE: &str = include_str!("../shaders/evaluate.wgsl");
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
    source: String,
    tier: TextureTier,
    split: bool,
    sky: bool,
}

const SHADE: (&str, &str) = ("shade", "fn shade(s: DaaSample) -> vec4f");
const MATERIAL: (&str, &str) = ("material", "fn material(s: DaaSample) -> DaaMaterial");
const LIGHT: (&str, &str) = ("light", "fn light(f: DaaSurface, m: DaaMaterial) -> vec4f");
const SKY: (&str, &str) = ("sky", "fn sky(s: DaaSample) -> vec4f");

impl HostSource {
    /// Parses and validates the host's source joined with the contract, on the capabilities of the device.
    pub fn check(
        source: &str,
        file: &str,
        tier: TextureTier,
        features: wgpu::Features,
    ) -> Result<Self, ShadingError> {
        let contract = [chunk::CONTRACT, chunk::OCTAHEDRAL, table_chunk(tier)];
        let joined = Joined::new(directives(tier), source, &contract);
        let at = |range: Option<Range<usize>>, kind| joined.error(file, range, kind);

        let module = naga::front::wgsl::parse_str(&joined.text).map_err(|e| joined.parse_error(file, &e))?;
        for (name, range) in joined.declared(&module) {
            if ["daa_", "Daa", "DAA_"].iter().any(|prefix| name.starts_with(prefix)) {
                return Err(at(Some(range), ShadingErrorKind::ReservedName(name)));
            }
        }
        for (handle, variable) in module.global_variables.iter() {
            let range = module.global_variables.get_span(handle).to_range();
            if let (Some(binding), true) = (&variable.binding, joined.in_host(range.as_ref()))
                && binding.group != crate::HOST_GROUP
            {
                let name = variable.name.clone().unwrap_or_default();
                return Err(at(range, ShadingErrorKind::Group { name, group: binding.group }));
            }
        }
        if let Some(entry) = module.entry_points.first() {
            let range = joined.find(&format!("fn {}", entry.name));
            return Err(at(range, ShadingErrorKind::EntryPoint(entry.name.clone())));
        }
        let split = joined.hook(file, &module)?;
        let sky = joined.signature(file, &module, SKY, &["DaaSample"], None)?;

        let capabilities =
            wgpu_naga_bridge::features_to_naga_capabilities(features, wgpu::DownlevelFlags::all());
        let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities);
        let info = validator.validate(&module).map_err(|e| joined.validation_error(file, &e))?;
        for (handle, function) in module.functions.iter() {
            let range = module.functions.get_span(handle).to_range();
            if joined.in_host(range.as_ref()) && !info[handle].available_stages.contains(naga::valid::ShaderStages::COMPUTE)
            {
                let name = function.name.as_deref().unwrap_or("a function");
                let what = format!("`{name}` takes a derivative or samples with an implicit one");
                return Err(at(range, ShadingErrorKind::Derivative(what)));
            }
        }
        Ok(Self { source: source.to_owned(), tier, split, sky })
    }

    /// A module that shades: the host's source, the contract, what reads and averages samples, and a pass.
    pub fn join(&self, pass: &str) -> String {
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
        join(&[
            directives(self.tier),
            &self.source,
            chunk::CONTRACT,
            chunk::OCTAHEDRAL,
            table_chunk(self.tier),
            chunk::SAMPLE,
            chunk::MEAN,
            chunk::STATISTICS,
            hook,
            sky,
            chunk::EVALUATE,
            pass,
        ])
    }
}

/// A module of the crate's own that only reads the G-buffer.
pub(crate) fn join_plain(pass: &str) -> String {
    join(&[chunk::CONTRACT, chunk::OCTAHEDRAL, chunk::SAMPLE, chunk::STATISTICS, pass])
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

    fn find(&self, what: &str) -> Option<Range<usize>> {
        let at = self.host.start + self.text[self.host.clone()].find(what)?;
        Some(at..at + what.len())
    }

    /// An error at a place of the joined text, told in lines and columns of the host's file.
    fn error(&self, file: &str, range: Option<Range<usize>>, kind: ShadingErrorKind) -> ShadingError {
        let (mut line, mut column) = (0, 0);
        if let Some(range) = range.filter(|r| self.host.contains(&r.start)) {
            let before = &self.text[self.host.start..range.start];
            line = before.matches('\n').count() as u32 + 1;
            column = before.chars().rev().take_while(|&c| c != '\n').count() as u32 + 1;
        }
        ShadingError { file: file.to_owned(), line, column, kind }
    }

    fn parse_error(&self, file: &str, e: &naga::front::wgsl::ParseError) -> ShadingError {
        let ranges: Vec<_> = e.labels().filter_map(|(span, label)| Some((span.to_range()?, label))).collect();
        let message = one_line(e.message());
        let host = ranges.iter().find(|(r, _)| self.in_host(Some(r)));
        if let Some(name) = message.strip_prefix("redefinition of `").and_then(|m| m.strip_suffix('`'))
            && ranges.iter().any(|(r, _)| !self.in_host(Some(r)))
        {
            return self.error(file, host.map(|(r, _)| r.clone()), ShadingErrorKind::Clash(name.to_owned()));
        }
        match host {
            Some((range, _)) => {
                let notes: String = e.notes().map(|n| format!("; {}", one_line(n))).collect();
                self.error(file, Some(range.clone()), ShadingErrorKind::Wgsl(message + &notes))
            }
            // The parser ran on into the crate's text: something is left open at the end of the host's.
            None => {
                let end = self.host.end.saturating_sub(1)..self.host.end;
                let what = format!("the source ends inside a declaration, is a brace or a semicolon missing? ({message})");
                self.error(file, Some(end), ShadingErrorKind::Wgsl(what))
            }
        }
    }

    fn validation_error(&self, file: &str, e: &naga::WithSpan<naga::valid::ValidationError>) -> ShadingError {
        let mut message = one_line(&e.as_inner().to_string());
        let mut source = e.as_inner().source();
        while let Some(inner) = source {
            let _ = write!(message, ": {}", one_line(&inner.to_string()));
            source = inner.source();
        }
        // The narrowest span says most.
        let range = e
            .spans()
            .filter_map(|(span, _)| span.to_range())
            .filter(|r| self.in_host(Some(r)))
            .min_by_key(ExactSizeIterator::len);
        self.error(file, range, ShadingErrorKind::Wgsl(message))
    }

    /// All names that the host declares at module scope.
    fn declared(&self, module: &naga::Module) -> Vec<(String, Range<usize>)> {
        let functions = module.functions.iter().map(|(h, f)| (f.name.clone(), module.functions.get_span(h)));
        let types = module.types.iter().map(|(h, t)| (t.name.clone(), module.types.get_span(h)));
        let constants = module.constants.iter().map(|(h, c)| (c.name.clone(), module.constants.get_span(h)));
        let overrides = module.overrides.iter().map(|(h, o)| (o.name.clone(), module.overrides.get_span(h)));
        let variables =
            module.global_variables.iter().map(|(h, v)| (v.name.clone(), module.global_variables.get_span(h)));
        functions
            .chain(types)
            .chain(constants)
            .chain(overrides)
            .chain(variables)
            .filter_map(|(name, span)| Some((name?, span.to_range()?)))
            .filter(|(_, range)| self.in_host(Some(range)))
            .collect()
    }

    /// Which hook the host wrote: true for `material` and `light`, false for `shade`.
    fn hook(&self, file: &str, module: &naga::Module) -> Result<bool, ShadingError> {
        let shade = self.signature(file, module, SHADE, &["DaaSample"], None)?;
        let material = self.signature(file, module, MATERIAL, &["DaaSample"], Some("DaaMaterial"))?;
        let light = self.signature(file, module, LIGHT, &["DaaSurface", "DaaMaterial"], None)?;
        let wrong = |name: &str, kind| self.error(file, self.find(&format!("fn {name}")), kind);
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

    /// Whether a function is there; an error if it is, with another signature. `result` None: vec4f.
    fn signature(
        &self,
        file: &str,
        module: &naga::Module,
        (name, expected): (&'static str, &'static str),
        arguments: &[&str],
        result: Option<&str>,
    ) -> Result<bool, ShadingError> {
        let Some((handle, function)) = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name)) else {
            return Ok(false);
        };
        let type_name = |ty| module.types[ty].name.as_deref();
        let right_arguments = function.arguments.len() == arguments.len()
            && function.arguments.iter().zip(arguments).all(|(a, &name)| type_name(a.ty) == Some(name));
        let right_result = function.result.as_ref().is_some_and(|r| match result {
            Some(name) => type_name(r.ty) == Some(name),
            None => {
                module.types[r.ty].inner
                    == naga::TypeInner::Vector { size: naga::VectorSize::Quad, scalar: naga::Scalar::F32 }
            }
        });
        if right_arguments && right_result {
            return Ok(true);
        }
        let range = module.functions.get_span(handle).to_range();
        Err(self.error(file, range, ShadingErrorKind::Signature { name, expected }))
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
