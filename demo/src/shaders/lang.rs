//! The languages that shaders are written in, and where their bindings are found.

use super::bindings::{Kind, Row, Slots, gl, metal};
use naga::back::{glsl, hlsl, msl, spv, wgsl};
use naga::valid::Capabilities;
use naga::{GlobalVariable, Module, ResourceBinding};

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
pub const SIZES_SLOT: u8 = 30;

/// The space of HLSL's lists that say which of all samplers is meant, behind which a group's number is added.
pub const SAMPLER_SPACE: u8 = 16;

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
