//! What the passes are, and what their shaders bind: for readers, and for programs.

use super::bindings::{Kind, Slots, length};
use super::request::Request;
use super::resolve::Resolved;
use super::translate::is_buffer;
use deferred_aa::{Grid, PassInfo, Resource, ResourceSet, Rounds};
use naga::common::wgsl::TypeContext as _;
use naga::{Handle, Module, Type, TypeInner};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The passes of a frame in order, their shaders, and the structs that these read.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Table {
    /// The language of all files.
    pub language: String,
    /// What must be known beside it.
    pub notes: String,
    /// Samples along one side of a window.
    pub m: u32,
    /// The settings of the frames.
    pub settings: deferred_aa::Settings,
    /// The passes in the order in which they run. The first is not the node's: it is what the host's raster shader
    /// needs.
    pub passes: Vec<Pass>,
    /// The structs of all buffers, by name.
    pub structs: BTreeMap<String, Struct>,
}

/// A pass.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Pass {
    /// The name of the pass, as in timings.
    pub name: &'static str,
    /// What must be finished before.
    pub reads: Vec<String>,
    /// What it changes.
    pub writes: Vec<String>,
    /// How often the shaders run, one after the other.
    pub rounds: String,
    /// The shaders, in the order in which they run.
    pub shaders: Vec<Entry>,
}

/// A shader.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Entry {
    /// Its file.
    pub file: String,
    /// Its entry point there.
    pub entry: String,
    /// compute, vertex or fragment.
    pub stage: String,
    /// Lanes of a workgroup along x, y and z; 0 if it is no compute shader.
    pub workgroup_size: [u32; 3],
    /// How many workgroups it gets, for an output of w × h pixels; empty if it is no compute shader.
    pub workgroups: String,
    /// What it reads and writes, by group and binding.
    pub bindings: Vec<Binding>,
}

/// A resource of a shader.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Binding {
    /// The group in WGSL.
    pub group: u32,
    /// The binding in WGSL.
    pub binding: u32,
    /// The place in the language of the file.
    pub place: String,
    /// What it is.
    pub kind: Kind,
    /// The name in WGSL.
    pub name: String,
    /// The type in WGSL.
    #[serde(rename = "type")]
    pub ty: String,
    /// The number of elements of an array of bindings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<u32>,
    /// The least of a buffer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u32>,
}

/// A struct of a buffer.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Struct {
    /// One of them, a last array without a length counted as one element.
    pub bytes: u32,
    /// The members, in order.
    pub members: Vec<Member>,
}

/// A member of a struct.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Member {
    /// The offset from the beginning of the struct, in bytes.
    pub offset: u32,
    /// The name in WGSL.
    pub name: String,
    /// The type in WGSL.
    #[serde(rename = "type")]
    pub ty: String,
}

impl Table {
    pub(super) fn new(
        request: &Request<'_>,
        uses: &[(Option<PassInfo>, Vec<usize>)],
        resolved: &[Resolved<'_>],
        entries: &[String],
        slots: &Slots,
    ) -> Self {
        let names = |resources: ResourceSet| resources.iter().map(|r| format!("{r:?}")).collect();
        let mut structs = BTreeMap::new();
        for one in resolved {
            for (_, variable) in one.module.global_variables.iter().filter(|(_, v)| is_buffer(v)) {
                describe(&one.module, variable.ty, &mut structs);
            }
        }
        let pass = |(info, indices): &(Option<PassInfo>, Vec<usize>)| {
            let shader = |&index: &usize| {
                let workgroups = info.and_then(|info| workgroups(&info, &resolved[index].shader.entry, request.m));
                entry(request, &resolved[index], entries[index].clone(), slots, workgroups)
            };
            Pass {
                name: info.map_or("pack", |info| info.name),
                reads: info.map_or_else(Vec::new, |info| names(info.reads)),
                // What packs is the host's, and writes what the host renders.
                writes: info.map_or_else(|| vec![format!("{:?}", Resource::GBuffer)], |info| names(info.writes)),
                rounds: info.map_or(Rounds::Once, |info| info.rounds).to_string(),
                shaders: indices.iter().map(shader).collect(),
            }
        };
        Self {
            language: request.lang.to_string(),
            notes: request.lang.notes(),
            m: request.m,
            settings: *request.settings,
            passes: uses.iter().map(pass).collect(),
            structs,
        }
    }

    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        // Writing to a string can't fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let technique = format!("{:?}", self.settings.technique);
        writeln!(out, "# {technique}, m = {}, in {}\n", self.m, self.language)?;
        writeln!(out, "{}\n", self.notes)?;
        writeln!(
            out,
            "Passes in the order in which they run; what each reads must be finished before. `pack` is not the node's: it is an \
             example of what a host's raster shader returns. An output has w × h pixels, m × m samples each; where a pass runs more than \
             once, its dynamic offset goes 256 bytes further each time. What the frame's constants hold is in the node's \
             `src/gpu/uniforms/frame.rs` and `src/techniques/`."
        )?;
        for pass in &self.passes {
            let list = |names: &[String]| if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
            let rounds =
                if pass.rounds == Rounds::Once.to_string() { String::new() } else { format!(" Runs {}.", pass.rounds) };
            writeln!(out, "\n## {}\n\nReads {}; writes {}.{rounds}", pass.name, list(&pass.reads), list(&pass.writes))?;
            for shader in &pass.shaders {
                let [x, y, z] = shader.workgroup_size;
                let lanes = if x == 0 {
                    String::new()
                } else {
                    format!(", workgroups of {x} × {y} × {z}: {}", shader.workgroups)
                };
                writeln!(out, "\n`{}`: `{}`, {}{lanes}.", shader.file, shader.entry, shader.stage)?;
                if shader.bindings.is_empty() {
                    continue;
                }
                writeln!(
                    out,
                    "\n| group | binding | place | kind | name | type | bytes |\n|---|---|---|---|---|---|---|"
                )?;
                for b in &shader.bindings {
                    let bytes = b.bytes.map(|bytes| bytes.to_string()).unwrap_or_default();
                    let kind = match b.kind {
                        Kind::Uniform => "uniform",
                        Kind::Storage { writes: true } => "storage, written",
                        Kind::Storage { .. } => "storage",
                        Kind::Texture => "texture",
                        Kind::StorageTexture => "storage texture",
                        Kind::Sampler => "sampler",
                        Kind::AccelerationStructure => "acceleration structure",
                    };
                    let count = b.length.map(|length| format!(", {length}")).unwrap_or_default();
                    let (group, binding, place, name, ty) = (b.group, b.binding, &b.place, &b.name, &b.ty);
                    writeln!(out, "| {group} | {binding} | {place} | {kind} | `{name}` | `{ty}`{count} | {bytes} |")?;
                }
            }
        }
        for (name, one) in &self.structs {
            writeln!(out, "\n## {name}, {} bytes\n\n| offset | member | type |\n|---|---|---|", one.bytes)?;
            for member in &one.members {
                writeln!(out, "| {} | `{}` | `{}` |", member.offset, member.name, member.ty)?;
            }
        }
        Ok(())
    }
}

fn entry(request: &Request<'_>, one: &Resolved<'_>, entry: String, slots: &Slots, workgroups: Option<String>) -> Entry {
    let module = &one.module;
    let binding = |(_, variable): (_, &naga::GlobalVariable)| {
        let at = variable.binding?;
        let size = || module.types[variable.ty].inner.size(module.to_ctx());
        Some(Binding {
            group: at.group,
            binding: at.binding,
            place: request.lang.place(module, variable, at, slots),
            kind: Kind::of(module, variable),
            name: variable.name.clone().unwrap_or_default(),
            ty: written(module, variable.ty),
            length: length(module, variable),
            bytes: is_buffer(variable).then(size),
        })
    };
    let mut bindings: Vec<_> = module.global_variables.iter().filter_map(binding).collect();
    bindings.sort_by_key(|b| (b.group, b.binding));
    Entry {
        file: one.file.clone(),
        entry,
        stage: format!("{:?}", one.shader.stage).to_lowercase(),
        workgroup_size: module.entry_points.first().map_or([0; 3], |e| e.workgroup_size),
        workgroups: workgroups.unwrap_or_default(),
        bindings,
    }
}

/// How many workgroups an entry point of a pass gets: for any output, and for one of 1920 × 1080 pixels. `None` if it
/// draws.
fn workgroups(info: &PassInfo, entry: &str, m: u32) -> Option<String> {
    let grid = info.stages.iter().find(|stage| stage.entry == entry)?.grid;
    let at_1080p = info.workgroups(grid, [1920, 1080], m).map(|[x, y, _]| format!(" ({x} × {y} at 1920 × 1080)"));
    (!matches!(grid, Grid::Target | Grid::Depth)).then(|| format!("{grid}{}", at_1080p.unwrap_or_default()))
}

/// A type as WGSL has it.
fn written(module: &Module, ty: Handle<Type>) -> String {
    let mut text = String::new();
    // Writing to a string can't fail.
    let _ = module.to_ctx().write_type(ty, &mut text);
    text
}

/// The structs in a type.
fn describe(module: &Module, ty: Handle<Type>, structs: &mut BTreeMap<String, Struct>) {
    match &module.types[ty].inner {
        TypeInner::Array { base, .. } | TypeInner::BindingArray { base, .. } => describe(module, *base, structs),
        TypeInner::Struct { members, span } => {
            let member = |m: &naga::StructMember| Member {
                offset: m.offset,
                name: m.name.clone().unwrap_or_default(),
                ty: written(module, m.ty),
            };
            let one = Struct { bytes: *span, members: members.iter().map(member).collect() };
            structs.insert(module.types[ty].name.clone().unwrap_or_default(), one);
            members.iter().for_each(|m| describe(module, m.ty, structs));
        }
        _ => {}
    }
}
