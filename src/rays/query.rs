//! Both levels as acceleration structures of the adapter, for ray queries.

use super::RayError;
use super::mesh::BottomLevel;

/// The features that [`RayTier::Query`](super::RayTier::Query) needs from the device.
pub const QUERY_FEATURES: wgpu::Features = wgpu::Features::EXPERIMENTAL_RAY_QUERY;

/// Raises the limits for acceleration structures to those of the adapter; the others stay as they are.
pub fn query_limits(limits: wgpu::Limits, adapter: &wgpu::Limits) -> wgpu::Limits {
    wgpu::Limits {
        max_blas_primitive_count: adapter.max_blas_primitive_count,
        max_blas_geometry_count: adapter.max_blas_geometry_count,
        max_tlas_instance_count: adapter.max_tlas_instance_count,
        max_acceleration_structures_per_shader_stage: adapter.max_acceleration_structures_per_shader_stage,
        ..limits
    }
}

/// The bit of the masks of instances that cast shadows.
pub(super) const MASK_SHADOW: u8 = 2;

/// An instance of the top level.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedInstance {
    pub mesh: u32,
    /// The rows of the transform from the mesh's own space to camera-relative space.
    pub place: [f32; 12],
    pub casts_shadow: bool,
}

/// The adapter's structures, which change together with the scene's own buffers.
#[derive(Debug)]
pub(super) struct Structures {
    /// One structure for each mesh; none for a mesh without triangles.
    bottom: Vec<Option<wgpu::Blas>>,
    pub top: wgpu::Tlas,
    room: u32,
}

impl Structures {
    pub fn new(device: &wgpu::Device) -> Self {
        let room = 64;
        Self { bottom: Vec::new(), top: make_top(device, room), room }
    }

    /// Records the build of a mesh's structure.
    pub fn add(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        mesh: &BottomLevel,
    ) -> Result<(), RayError> {
        let triangles = mesh.as_they_were();
        let (count, limit) = (triangles.len() as u32, device.limits().max_blas_primitive_count);
        if count > limit {
            let what = "triangles of a mesh";
            return Err(RayError::Structures { what, count: count as usize, limit: limit as usize });
        }
        if mesh.triangles() == 0 {
            self.bottom.push(None);
            return Ok(());
        }
        let upload = |label, bytes: &[u8]| {
            let usage = wgpu::BufferUsages::BLAS_INPUT | wgpu::BufferUsages::COPY_DST;
            let size = bytes.len() as u64;
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            });
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        // In the order of the geometry buffer.
        let indices: Vec<u32> = triangles.iter().flat_map(|t| [t[0], t[1], t[2]]).collect();
        let vertices = upload("daa ray vertices", bytemuck::cast_slice(&mesh.positions));
        let index_buffer = upload("daa ray indices", bytemuck::cast_slice(&indices));
        let size = wgpu::BlasTriangleGeometrySizeDescriptor {
            vertex_format: wgpu::VertexFormat::Float32x3,
            vertex_count: mesh.positions.len() as u32,
            index_format: Some(wgpu::IndexFormat::Uint32),
            index_count: Some(indices.len() as u32),
            flags: if mesh.masked {
                wgpu::AccelerationStructureGeometryFlags::empty()
            } else {
                wgpu::AccelerationStructureGeometryFlags::OPAQUE
            },
        };
        let blas = device.create_blas(
            &wgpu::CreateBlasDescriptor {
                label: Some(&mesh.name),
                flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
                update_mode: wgpu::AccelerationStructureUpdateMode::Build,
            },
            wgpu::BlasGeometrySizeDescriptors::Triangles { descriptors: vec![size.clone()] },
        );
        let geometry = wgpu::BlasTriangleGeometry {
            size: &size,
            vertex_buffer: &vertices,
            first_vertex: 0,
            vertex_stride: 12,
            index_buffer: Some(&index_buffer),
            first_index: Some(0),
            transform_buffer: None,
            transform_buffer_offset: None,
        };
        let entry =
            wgpu::BlasBuildEntry { blas: &blas, geometry: wgpu::BlasGeometries::TriangleGeometries(vec![geometry]) };
        encoder.build_acceleration_structures([&entry], []);
        self.bottom.push(Some(blas));
        Ok(())
    }

    /// Records the build of the top level. Returns whether the structure was replaced.
    pub fn update(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        instances: &[PlacedInstance],
    ) -> Result<bool, RayError> {
        let (count, limit) = (instances.len(), device.limits().max_tlas_instance_count);
        if count > limit as usize {
            return Err(RayError::Structures { what: "instances", count, limit: limit as usize });
        }
        let grown = count as u32 > self.room;
        if grown {
            self.room = (count as u32 + count as u32 / 2).min(limit);
            self.top = make_top(device, self.room);
        }
        let Some(slots) = self.top.get_mut_slice(0..self.room as usize) else { return Ok(grown) };
        slots.fill(None);
        for (index, (slot, instance)) in (0..).zip(slots.iter_mut().zip(instances)) {
            let blas = self.bottom.get(instance.mesh as usize).and_then(Option::as_ref);
            let mask = if instance.casts_shadow { 0xff } else { !MASK_SHADOW };
            *slot = blas.map(|blas| wgpu::TlasInstance::new(blas, instance.place, index, mask));
        }
        encoder.build_acceleration_structures([], [&self.top]);
        Ok(grown)
    }
}

fn make_top(device: &wgpu::Device, max_instances: u32) -> wgpu::Tlas {
    device.create_tlas(&wgpu::CreateTlasDescriptor {
        label: Some("daa ray instances"),
        max_instances,
        flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
        update_mode: wgpu::AccelerationStructureUpdateMode::Build,
    })
}
