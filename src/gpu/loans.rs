//! The memory that a host has lent a node in place of the node's own.

use crate::gpu::binding::Slot;
use crate::gpu::sizes::Shape;
use crate::host::error::LendError;
use crate::host::graph::{Part, PartKind};
use crate::passes;

/// Memory of the host for one of the node's parts. See [`DeferredAa::lend`](crate::DeferredAa::lend).
#[derive(Debug, Clone, Copy)]
pub struct Lent<'a> {
    /// The part that the memory is for.
    pub part: Part,
    /// The memory.
    pub memory: Physical<'a>,
}

/// A texture or a buffer of the host.
#[derive(Debug, Clone, Copy)]
pub enum Physical<'a> {
    /// A texture with exactly the format and size of the part.
    Texture(&'a wgpu::Texture),
    /// A buffer at least as large as the part. All of it is used by the part while the part is alive.
    Buffer(&'a wgpu::Buffer),
}

/// The present loans.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loans {
    textures: Vec<(Part, wgpu::Texture)>,
    buffers: Vec<(Part, wgpu::Buffer)>,
}

/// Whether any pass binds both parts, even if it uses only one: wgpu does not allow the same buffer or texture to be
/// bound for reading and for writing in one dispatch.
fn are_bound_together(one: Part, other: Part) -> bool {
    let all_samples = [Part::Shadows, Part::Reflections];
    passes::ALL.iter().any(|pass| {
        let binds = |part: Part| {
            // The host renders to all attachments together, and group 0 binds all of them.
            Part::GBUFFER.contains(&part)
                || pass.reads_found() && all_samples.contains(&part)
                || pass.bindings.iter().any(|binding| binding.slot == Slot::Part(part))
        };
        binds(one) && binds(other)
    })
}

impl Loans {
    /// Accepts the loans if all of them fit their parts.
    pub fn new(lent: &[Lent<'_>], shape: &Shape, limit: u64) -> Result<Self, LendError> {
        let mut loans = Self::default();
        for (index, &Lent { part, memory }) in lent.iter().enumerate() {
            if !part.is_lendable() {
                return Err(LendError::NotLendable(part));
            }
            for other in &lent[..index] {
                if other.part == part {
                    return Err(LendError::Twice(part));
                }
                if same(other.memory, memory) && are_bound_together(part, other.part) {
                    return Err(LendError::Together { part, other: other.part });
                }
            }
            // The number of a lattice's points depends on the frame's settings, so any size is accepted here.
            let any = PartKind::Buffer { bytes: 0, usage: wgpu::BufferUsages::STORAGE };
            loans.take(part, memory, shape.kind(part).unwrap_or(any), limit)?;
        }
        Ok(loans)
    }

    fn take(&mut self, part: Part, memory: Physical<'_>, needed: PartKind, limit: u64) -> Result<(), LendError> {
        match (memory, needed) {
            (Physical::Texture(texture), PartKind::Texture { format, width, height, usage }) => {
                if texture.format() != format {
                    return Err(LendError::Format { part, lent: texture.format(), needed: format });
                }
                let plain = texture.dimension() == wgpu::TextureDimension::D2
                    && [texture.depth_or_array_layers(), texture.mip_level_count(), texture.sample_count()] == [1; 3];
                if !plain || (texture.width(), texture.height()) != (width, height) {
                    return Err(LendError::Extent { part, width, height });
                }
                if !texture.usage().contains(usage) {
                    return Err(LendError::TextureUsage { part, missing: usage - texture.usage() });
                }
                self.textures.push((part, texture.clone()));
            }
            (Physical::Buffer(buffer), PartKind::Buffer { bytes, usage }) => {
                if buffer.size() < bytes.max(4) || buffer.size() > limit {
                    return Err(LendError::Bytes { part, lent: buffer.size(), needed: bytes, limit });
                }
                if !buffer.usage().contains(usage) {
                    return Err(LendError::BufferUsage { part, missing: usage - buffer.usage() });
                }
                self.buffers.push((part, buffer.clone()));
            }
            (_, PartKind::Texture { .. }) => return Err(LendError::Kind { part, needed: "texture" }),
            (_, PartKind::Buffer { .. }) => return Err(LendError::Kind { part, needed: "buffer" }),
        }
        Ok(())
    }

    /// The texture that is lent for a part.
    pub fn texture(&self, part: Part) -> Option<&wgpu::Texture> {
        self.textures.iter().find(|lent| lent.0 == part).map(|lent| &lent.1)
    }

    /// The buffer that is lent for a part.
    pub fn buffer(&self, part: Part) -> Option<&wgpu::Buffer> {
        self.buffers.iter().find(|lent| lent.0 == part).map(|lent| &lent.1)
    }

    pub fn has(&self, part: Part) -> bool {
        self.texture(part).is_some() || self.buffer(part).is_some()
    }

    /// The bytes of a part that the node has allocated itself.
    pub fn own(&self, part: Part, bytes: u64) -> u64 {
        if self.has(part) { 0 } else { bytes }
    }

    /// The first of some parts whose loan is smaller than needed, with its lent and its needed bytes.
    pub fn too_small(&self, parts: impl IntoIterator<Item = (Part, u64)>) -> Option<(Part, u64, u64)> {
        parts.into_iter().find_map(|(part, needed)| {
            let lent = self.buffer(part)?.size();
            (lent < needed).then_some((part, lent, needed))
        })
    }
}

fn same(a: Physical<'_>, b: Physical<'_>) -> bool {
    match (a, b) {
        (Physical::Texture(a), Physical::Texture(b)) => a == b,
        (Physical::Buffer(a), Physical::Buffer(b)) => a == b,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::graph::Lifetime;

    /// The lifetime of a part that can't be lent says why.
    #[test]
    fn only_what_is_kept_or_the_hosts_is_not_lent() {
        for part in Part::ALL.into_iter().filter(|part| !part.is_lendable()) {
            assert!(!matches!(part.lifetime(), Lifetime::Transient { .. }), "{part:?}");
        }
    }
}
