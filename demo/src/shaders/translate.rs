//! A shader in another language, by naga.

use super::bindings::{Kind, Row, Slots, gl, length, metal};
use super::{Resolved, causes};
use naga::back::{glsl, hlsl, msl, spv, wgsl};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::Capabilities;
use naga::{AddressSpace, GlobalVariable, Module, ResourceBinding};
use std::collections::BTreeMap;

/// A shading language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Lang {
    /// Shader model 6.0; 6.5 with ray query.
    Hlsl,
    /// 2.4.
    Msl,
    /// 1.3, for Vulkan 1.1; 1.4, for Vulkan 1.2, with ray query.
    Spirv,
    /// 4.60, core.
    Glsl,
    /// One entry point a file, its constants filled in.
    Wgsl,
}

impl std::fmt::Display for Lang {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Hlsl => "HLSL",
            Self::Msl => "MSL",
            Self::Spirv => "SPIR-V",
            Self::Glsl => "GLSL",
            Self::Wgsl => "WGSL",
        })
    }
}

/// The slot of MSL's list of buffer sizes, the last there is.
const SIZES_SLOT: u8 = 30;

/// The space of HLSL's lists that say which of all samplers is meant, behind which a group's number is added.
const SAMPLER_SPACE: u8 = 16;

/// Reads and writes outside of a buffer or a texture go to its rim, as WebGPU promises.
const CHECKED: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Restrict,
    image_load: BoundsCheckPolicy::Restrict,
    binding_array: BoundsCheckPolicy::Unchecked,
};

impl Lang {
    /// Of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Hlsl => "hlsl",
            Self::Msl => "metal",
            Self::Spirv => "spv",
            Self::Glsl => "glsl",
            Self::Wgsl => "wgsl",
        }
    }

    /// What it can say.
    pub fn capabilities(self) -> Capabilities {
        match self {
            // An external texture is several there, the table has one place for it.
            Self::Hlsl => hlsl::supported_capabilities() - Capabilities::TEXTURE_EXTERNAL,
            Self::Msl => msl::supported_capabilities(),
            Self::Spirv => spv::supported_capabilities(),
            Self::Glsl => glsl::supported_capabilities(),
            // Its writer stops at ray queries.
            Self::Wgsl => wgsl::supported_capabilities() - Capabilities::RAY_QUERY,
        }
    }

    /// What a reader of the table must know beside it.
    pub fn notes(self) -> String {
        match self {
            Self::Hlsl => format!(
                "Registers are WGSL's bindings, spaces its groups. Samplers are looked up: `nagaSamplerHeap` at s0, space0 \
                 holds all there are (comparison samplers: s0, space1), and element i of `nagaGroupGSamplerIndexArray` at t0, \
                 space{SAMPLER_SPACE} + G says which of them is meant. Constants of a buffer lie as the table of structs says."
            ),
            Self::Msl => format!(
                "Bindings of groups 0 to 2 have the same slot in all files. buffer({SIZES_SLOT}), where a shader asks for it, holds a \
                 u32 for each buffer that ends in an array without a length: its bytes, in the order of the table."
            ),
            Self::Spirv => "Descriptor sets are WGSL's groups, bindings its bindings.".to_owned(),
            Self::Glsl => "Uniform blocks, storage blocks, texture units and images are numbered each from 0; those of groups 0 to 2 \
                           have the same number in all files. The unit of a texture holds the sampler with which it is read."
                .to_owned(),
            Self::Wgsl => "Groups and bindings are as the node has them on wgpu.".to_owned(),
        }
    }

    /// Where a binding is found in it.
    pub fn place(self, module: &Module, variable: &GlobalVariable, at: ResourceBinding, slots: &Slots) -> String {
        let kind = Kind::of(module, variable);
        let slot = |row: Row| slots.of(module).get(&(row, at)).copied().unwrap_or_default();
        let ResourceBinding { group, binding } = at;
        match self {
            Self::Wgsl => format!("@group({group}) @binding({binding})"),
            Self::Spirv => format!("set {group}, binding {binding}"),
            Self::Hlsl => {
                let class = match kind {
                    Kind::Uniform => 'b',
                    Kind::Storage { writes: true } | Kind::StorageTexture => 'u',
                    Kind::Storage { .. } | Kind::Texture | Kind::AccelerationStructure => 't',
                    Kind::Sampler => return format!("nagaGroup{group}SamplerIndexArray[{binding}]"),
                };
                format!("{class}{binding}, space{group}")
            }
            Self::Msl => match metal(module, variable, kind) {
                Row::Textures => format!("texture({})", slot(Row::Textures)),
                Row::Samplers => format!("sampler({})", slot(Row::Samplers)),
                row => format!("buffer({})", slot(row)),
            },
            Self::Glsl => match gl(kind) {
                Some(row) => format!("{} {}", GL_ROWS[row as usize - Row::UniformBlocks as usize], slot(row)),
                None => "with its textures".to_owned(),
            },
        }
    }
}

const GL_ROWS: [&str; 4] = ["uniform block", "storage block", "texture unit", "image"];

/// A file's bytes, and what its entry point is called there.
pub fn translate(lang: Lang, one: &Resolved<'_>, slots: &Slots) -> Result<(Vec<u8>, String), String> {
    match lang {
        Lang::Wgsl => wgsl::write_string(&one.module, &one.info, wgsl::WriterFlags::empty())
            .map(|text| (text.into_bytes(), one.shader.entry.clone()))
            .map_err(|e| causes(&e)),
        Lang::Spirv => spirv(one).map_err(|e| causes(&e)),
        Lang::Hlsl => hlsl(one),
        Lang::Msl => msl(one, slots),
        Lang::Glsl => glsl(one, slots),
    }
}

fn bound(module: &Module) -> impl Iterator<Item = (&GlobalVariable, ResourceBinding)> {
    module.global_variables.iter().filter_map(|(_, variable)| Some((variable, variable.binding?)))
}

/// Whether rays are asked of the hardware.
pub fn queries(module: &Module) -> bool {
    bound(module).any(|(variable, _)| Kind::of(module, variable) == Kind::AccelerationStructure)
}

fn spirv(one: &Resolved<'_>) -> Result<(Vec<u8>, String), spv::Error> {
    let place = |(variable, at): (&GlobalVariable, ResourceBinding)| {
        let binding_array_size = length(&one.module, variable);
        (at, spv::BindingInfo { descriptor_set: at.group, binding: at.binding, binding_array_size })
    };
    let mut flags = spv::WriterFlags::empty();
    flags.set(spv::WriterFlags::DEBUG, true);
    let options = spv::Options {
        lang_version: if queries(&one.module) { (1, 4) } else { (1, 3) },
        flags,
        fake_missing_bindings: false,
        binding_map: bound(&one.module).map(place).collect(),
        bounds_check_policies: CHECKED,
        zero_initialize_workgroup_memory: if one.shader.zero_initialize_workgroup_memory {
            spv::ZeroInitializeWorkgroupMemoryMode::Polyfill
        } else {
            spv::ZeroInitializeWorkgroupMemoryMode::None
        },
        ..spv::Options::default()
    };
    let entry = spv::PipelineOptions { shader_stage: one.shader.stage, entry_point: one.shader.entry.clone() };
    let words = spv::write_vec(&one.module, &one.info, &options, Some(&entry))?;
    Ok((words.iter().flat_map(|word| word.to_le_bytes()).collect(), one.shader.entry.clone()))
}

fn hlsl(one: &Resolved<'_>) -> Result<(Vec<u8>, String), String> {
    let target = |space: u32, register: u32| hlsl::BindTarget {
        space: space as u8,
        register,
        restrict_indexing: true,
        ..hlsl::BindTarget::default()
    };
    let groups = bound(&one.module).map(|(_, at)| at.group);
    let options = hlsl::Options {
        shader_model: if queries(&one.module) { hlsl::ShaderModel::V6_5 } else { hlsl::ShaderModel::V6_0 },
        binding_map: bound(&one.module)
            .map(|(variable, at)| {
                let binding_array_size = length(&one.module, variable);
                (at, hlsl::BindTarget { binding_array_size, ..target(at.group, at.binding) })
            })
            .collect(),
        fake_missing_bindings: false,
        sampler_buffer_binding_map: groups
            .map(|group| (hlsl::SamplerIndexBufferKey { group }, target(u32::from(SAMPLER_SPACE) + group, 0)))
            .collect(),
        zero_initialize_workgroup_memory: one.shader.zero_initialize_workgroup_memory,
        ..hlsl::Options::default()
    };
    let entry = hlsl::PipelineOptions { entry_point: Some((one.shader.stage, one.shader.entry.clone())) };
    let mut text = String::new();
    let written = hlsl::Writer::new(&mut text, &options, &entry).write(&one.module, &one.info, None);
    let name = first_name(written.map_err(|e| causes(&e))?.entry_point_names)?;
    Ok((text.into_bytes(), name))
}

fn msl(one: &Resolved<'_>, slots: &Slots) -> Result<(Vec<u8>, String), String> {
    let places = slots.of(&one.module);
    fit(&places, &[(Row::Buffers, u32::from(SIZES_SLOT)), (Row::Textures, 128), (Row::Samplers, 16)])?;
    let target = |(variable, at): (&GlobalVariable, ResourceBinding)| {
        let kind = Kind::of(&one.module, variable);
        let row = metal(&one.module, variable, kind);
        let slot = places.get(&(row, at)).copied().map(|slot| slot as u8);
        let target = msl::BindTarget {
            buffer: slot.filter(|_| row == Row::Buffers),
            texture: slot.filter(|_| row == Row::Textures),
            sampler: slot.filter(|_| row == Row::Samplers).map(msl::BindSamplerTarget::Resource),
            external_texture: None,
            mutable: matches!(kind, Kind::Storage { writes: true } | Kind::StorageTexture),
        };
        (at, target)
    };
    let resources = msl::EntryPointResources {
        resources: bound(&one.module).map(target).collect(),
        immediates_buffer: None,
        sizes_buffer: Some(SIZES_SLOT),
    };
    let options = msl::Options {
        lang_version: (2, 4),
        per_entry_point_map: [(one.shader.entry.clone(), resources)].into(),
        fake_missing_bindings: false,
        bounds_check_policies: CHECKED,
        zero_initialize_workgroup_memory: one.shader.zero_initialize_workgroup_memory,
        ..msl::Options::default()
    };
    let entry = msl::PipelineOptions {
        entry_point: Some((one.shader.stage, one.shader.entry.clone())),
        ..msl::PipelineOptions::default()
    };
    let (text, names) = msl::write_string(&one.module, &one.info, &options, &entry).map_err(|e| causes(&e))?;
    Ok((text.into_bytes(), first_name(names.entry_point_names)?))
}

fn glsl(one: &Resolved<'_>, slots: &Slots) -> Result<(Vec<u8>, String), String> {
    let places = slots.of(&one.module);
    fit(&places, &[Row::UniformBlocks, Row::StorageBlocks, Row::Units, Row::Images].map(|row| (row, 256)))?;
    let options = glsl::Options {
        version: glsl::Version::Desktop(460),
        writer_flags: glsl::WriterFlags::empty(),
        binding_map: bound(&one.module)
            .filter_map(|(variable, at)| Some((at, *places.get(&(gl(Kind::of(&one.module, variable))?, at))? as u8)))
            .collect(),
        zero_initialize_workgroup_memory: one.shader.zero_initialize_workgroup_memory,
    };
    let entry = glsl::PipelineOptions {
        shader_stage: one.shader.stage,
        entry_point: one.shader.entry.clone(),
        multiview: None,
    };
    let mut text = String::new();
    let writer = glsl::Writer::new(&mut text, &one.module, &one.info, &options, &entry, CHECKED);
    writer.and_then(|mut writer| writer.write()).map_err(|e| causes(&e))?;
    Ok((text.into_bytes(), "main".to_owned()))
}

/// Whether no row has more than there is room for.
fn fit(places: &BTreeMap<(Row, ResourceBinding), u32>, rooms: &[(Row, u32)]) -> Result<(), String> {
    for &(row, room) in rooms {
        let needed = places.iter().filter(|((of, _), _)| *of == row).map(|(_, &slot)| slot + 1).max().unwrap_or(0);
        if needed > room {
            return Err(format!("{needed} {row:?} are bound by all shaders together, there is room for {room}"));
        }
    }
    Ok(())
}

/// A module of one entry point has one name.
fn first_name<E: std::error::Error>(names: Vec<Result<String, E>>) -> Result<String, String> {
    names.into_iter().next().unwrap_or_else(|| Ok(String::new())).map_err(|e| causes(&e))
}

/// The address space of what is bound as a buffer.
pub fn is_buffer(variable: &GlobalVariable) -> bool {
    matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. })
}
