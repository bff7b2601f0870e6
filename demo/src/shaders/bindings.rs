//! The places of bindings in languages that have no groups.

use deferred_aa::MAX_SAMPLERS;
use naga::{AddressSpace, ArraySize, GlobalVariable, ImageClass, Module, ResourceBinding, StorageAccess, TypeInner};
use std::collections::{BTreeMap, BTreeSet};

/// What a binding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Uniform,
    Storage { writes: bool },
    Texture,
    StorageTexture,
    Sampler,
    AccelerationStructure,
}

impl Kind {
    pub fn of(module: &Module, variable: &GlobalVariable) -> Self {
        let inner = match &module.types[variable.ty].inner {
            TypeInner::BindingArray { base, .. } => &module.types[*base].inner,
            inner => inner,
        };
        match (variable.space, inner) {
            (AddressSpace::Uniform, _) => Self::Uniform,
            (AddressSpace::Storage { access }, _) => Self::Storage { writes: access.contains(StorageAccess::STORE) },
            (_, TypeInner::Sampler { .. }) => Self::Sampler,
            (_, TypeInner::AccelerationStructure { .. }) => Self::AccelerationStructure,
            (_, TypeInner::Image { class: ImageClass::Storage { .. }, .. }) => Self::StorageTexture,
            _ => Self::Texture,
        }
    }
}

/// The length that an array of bindings is declared with: those of the texture table have none in WGSL.
pub fn length(module: &Module, variable: &GlobalVariable) -> Option<u32> {
    match module.types[variable.ty].inner {
        TypeInner::BindingArray { size: ArraySize::Constant(count), .. } => Some(count.get()),
        TypeInner::BindingArray { .. } if Kind::of(module, variable) == Kind::Sampler => Some(MAX_SAMPLERS as u32),
        TypeInner::BindingArray { .. } => Some(crate::host::TEXTURE_CAPACITY),
        _ => None,
    }
}

/// What has a row of numbers of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Row {
    /// The buffers of MSL: uniform and storage buffers, arrays of bindings, acceleration structures.
    Buffers,
    /// The textures of MSL.
    Textures,
    /// The samplers of MSL.
    Samplers,
    /// The uniform blocks of GLSL; the four that follow are its own too.
    UniformBlocks,
    StorageBlocks,
    Units,
    Images,
}

/// A place for each binding in each row. Those of groups 0 to 2 have the same place in all shaders, those of group 3
/// lie behind them.
#[derive(Debug)]
pub struct Slots {
    common: BTreeMap<(Row, ResourceBinding), u32>,
    counts: BTreeMap<Row, u32>,
}

/// The group of a pass's own.
const OWN: u32 = 3;

impl Slots {
    pub fn new<'a>(modules: impl Iterator<Item = &'a Module>) -> Self {
        let found: BTreeSet<_> = modules.flat_map(|module| placed(module).filter(|(_, at)| at.group != OWN)).collect();
        let (mut common, mut counts) = (BTreeMap::new(), BTreeMap::new());
        for key in found {
            let next: &mut u32 = counts.entry(key.0).or_default();
            common.insert(key, *next);
            *next += 1;
        }
        Self { common, counts }
    }

    /// The places of what this module binds.
    pub fn of(&self, module: &Module) -> BTreeMap<(Row, ResourceBinding), u32> {
        let mut counts = self.counts.clone();
        let mut own: Vec<_> = placed(module).collect();
        own.sort_unstable();
        let place = |key: (Row, ResourceBinding)| {
            let slot = self.common.get(&key).copied().unwrap_or_else(|| {
                let next = counts.entry(key.0).or_default();
                *next += 1;
                *next - 1
            });
            (key, slot)
        };
        own.into_iter().map(place).collect()
    }
}

/// What a module binds, in the rows of both languages.
fn placed(module: &Module) -> impl Iterator<Item = (Row, ResourceBinding)> {
    let globals = module.global_variables.iter();
    globals.filter_map(|(_, variable)| Some((variable, variable.binding?))).flat_map(|(variable, at)| {
        let kind = Kind::of(module, variable);
        [Some(metal(module, variable, kind)), gl(kind)].into_iter().flatten().map(move |row| (row, at))
    })
}

pub fn metal(module: &Module, variable: &GlobalVariable, kind: Kind) -> Row {
    match kind {
        _ if matches!(module.types[variable.ty].inner, TypeInner::BindingArray { .. }) => Row::Buffers,
        Kind::Uniform | Kind::Storage { .. } | Kind::AccelerationStructure => Row::Buffers,
        Kind::Texture | Kind::StorageTexture => Row::Textures,
        Kind::Sampler => Row::Samplers,
    }
}

/// A sampler is in the unit of each texture that is read through it.
pub fn gl(kind: Kind) -> Option<Row> {
    match kind {
        Kind::Uniform => Some(Row::UniformBlocks),
        Kind::Storage { .. } => Some(Row::StorageBlocks),
        Kind::Texture => Some(Row::Units),
        Kind::StorageTexture => Some(Row::Images),
        Kind::Sampler | Kind::AccelerationStructure => None,
    }
}
