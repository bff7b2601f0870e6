//! What a host has lent a node: memory for what the node would else allocate itself.

use crate::gpu::binding::Slot;
use crate::gpu::sizes::Shape;
use crate::host::error::LendError;
use crate::host::graph::{Part, PartKind};
use crate::passes;

/// Memory of a host's graph for a part of a node's resources. See [`DeferredAa::lend`](crate::DeferredAa::lend).
#[derive(Debug, Clone, Copy)]
pub struct Lent<'a> {
    /// What it is for.
    pub part: Part,
    /// The memory.
    pub memory: Physical<'a>,
}

/// A texture or a buffer of a host's.
#[derive(Debug, Clone, Copy)]
pub enum Physical<'a> {
    /// Of exactly the part's format and size.
    Texture(&'a wgpu::Texture),
    /// At least as large as the part. All of it is the part's while the part lives.
    Buffer(&'a wgpu::Buffer),
}

/// What is lent at present.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loans {
    textures: Vec<(Part, wgpu::Texture)>,
    buffers: Vec<(Part, wgpu::Buffer)>,
}

/// Whether some pass may bind both parts at once, whether it looks at both or not. wgpu lets no buffer or texture be bound to be read
/// and to be written at once.
fn are_bound_together(one: Part, other: Part) -> bool {
    let all_samples = [Part::Shadows, Part::Secondary];
    passes::ALL.iter().any(|pass| {
        let binds = |part: Part| {
            // The host renders to all attachments at once, and group 0 has them all.
            Part::GBUFFER.contains(&part)
                || pass.reads_found() && all_samples.contains(&part)
                || pass.bindings.iter().any(|binding| binding.slot == Slot::Part(part))
        };
        binds(one) && binds(other)
    })
}

impl Loans {
    /// Takes them if each can serve.
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
            // Only a frame's settings say how many points its lattices have.
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

    /// What is lent for a part.
    pub fn texture(&self, part: Part) -> Option<&wgpu::Texture> {
        self.textures.iter().find(|lent| lent.0 == part).map(|lent| &lent.1)
    }

    /// What is lent for a part.
    pub fn buffer(&self, part: Part) -> Option<&wgpu::Buffer> {
        self.buffers.iter().find(|lent| lent.0 == part).map(|lent| &lent.1)
    }

    pub fn has(&self, part: Part) -> bool {
        self.texture(part).is_some() || self.buffer(part).is_some()
    }

    /// Of a part's bytes, those that the node has allocated itself.
    pub fn own(&self, part: Part, bytes: u64) -> u64 {
        if self.has(part) { 0 } else { bytes }
    }

    /// The first of some parts whose loan is less than they need.
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

    /// What is not lendable has a lifetime that says why.
    #[test]
    fn only_what_is_kept_or_the_hosts_is_not_lent() {
        for part in Part::ALL.into_iter().filter(|part| !part.is_lendable()) {
            assert!(!matches!(part.lifetime(), Lifetime::Transient { .. }), "{part:?}");
        }
    }
}
