//! A shader in another language, by naga.

use super::bindings::{Kind, Row, Slots, gl, length, metal};
use super::error::causes;
use super::lang::{Lang, SAMPLER_SPACE, SIZES_SLOT};
use super::resolve::Resolved;
use naga::back::{glsl, hlsl, msl, spv, wgsl};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::{AddressSpace, GlobalVariable, Module, ResourceBinding};
use std::collections::BTreeMap;

/// Reads and writes outside of a buffer or a texture go to its rim, as WebGPU promises.
const CHECKED: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Restrict,
    image_load: BoundsCheckPolicy::Restrict,
    binding_array: BoundsCheckPolicy::Unchecked,
};

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
