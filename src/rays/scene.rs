//! The top level, and the buffers of both levels on the GPU.

use super::attributes::{self, Attributes};
use super::mesh::{self, BottomLevel, MAX_COORDINATE, Quality};
use super::query::{PlacedInstance, Structures};
use super::{RayError, RayTier};
use glam::{Affine3A, DMat3, DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::node::CwBvhNode;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};

/// The id of a mesh in a [`RayScene`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MeshId(pub(crate) u32);

/// An instance of a mesh in the world.
#[derive(Debug, Clone, Copy)]
pub struct Instance {
    /// The mesh.
    pub mesh: MeshId,
    /// The transform from the mesh's own space to world space: any invertible affine transform.
    pub world: Affine3A,
    /// The material: `DaaSample::material`, below 65536.
    pub material: u32,
    /// The object: `DaaSample::object`, below 65536.
    pub object: u32,
    /// The host's own 32 bits.
    pub user: u32,
    /// Whether the host's rasteriser culls its back faces. Reflected and refracted rays then pass them, too; shadow rays
    /// do not, so that rooms whose walls face inwards stay dark.
    pub culled: bool,
    /// Whether it casts shadows. Off, for clear glass, light passes through it and keeps its colour.
    pub casts_shadow: bool,
}

impl Instance {
    /// An instance of material and object 0 that is seen from both sides and casts shadows.
    pub fn new(mesh: MeshId, world: Affine3A) -> Self {
        Self { mesh, world, material: 0, object: 0, user: 0, culled: false, casts_shadow: true }
    }
}

/// Flags of an instance's record: whether the material has holes,
pub(super) const MASKED: u32 = 1;
/// whether its back faces are culled,
pub(super) const CULLED: u32 = 2;
/// and whether it casts no shadow.
pub(super) const CLEAR: u32 = 4;

/// The record of an instance in shaders: [`RECORD`] vec4s of `daa_ray_top`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct InstanceRecord {
    /// The rows of the transform from camera-relative space to the mesh's own.
    pub own_from_relative: [[f32; 4]; 3],
    /// The root node of the mesh.
    pub root: u32,
    /// The index of the instance in the frame.
    pub index: u32,
    /// The index of the mesh's first triangle among the vec4s of the geometry.
    pub first_triangle: u32,
    /// The offset from a vertex to its attributes, 0 if the mesh has none.
    pub attributes: u32,
    pub material: u32,
    pub object: u32,
    pub user: u32,
    /// [`MASKED`], [`CULLED`] and [`CLEAR`].
    pub flags: u32,
}

/// An instance as a visibility buffer reads it: [`DRAWN`] vec4s of `daa_instances`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct DrawnRecord {
    /// The rows of the transform from the mesh's own space to camera-relative space.
    pub relative_from_own: [[f32; 4]; 3],
    /// The index of the mesh's first triangle among the vec4s of the geometry.
    pub first_triangle: u32,
    /// The offset from a vertex to its attributes.
    pub attributes: u32,
    /// material | object << 16.
    pub identity: u32,
    /// The index of the table of the triangles' places, 0 if they are in the order of the mesh.
    pub places: u32,
}

/// The host's meshes and instances, prepared for tracing, for reading a visibility buffer
/// ([`GBufferTier::Visibility`](crate::GBufferTier::Visibility)), or for both.
///
/// [`add`](Self::add) each mesh once, and [`update`](Self::update) the instances in each frame. Buffers grow when they
/// must and are kept, so that a steady frame allocates no GPU memory.
#[derive(Debug)]
pub struct RayScene {
    /// Mesh by mesh: nodes, triangles, vertices and attributes.
    data: Growing,
    top: Growing,
    /// The instances as a visibility buffer reads them, if the scene is for one.
    drawn: Option<Growing>,
    /// The acceleration structures of [`RayTier::Query`].
    structures: Option<Structures>,
    /// The host's own top level, if it is in use.
    hosts: Option<wgpu::Tlas>,
    meshes: Vec<Placed>,
    /// The number of vec4s in use of `data`.
    used: u64,
    instances: u32,
    tier: Option<RayTier>,
    camera: Vec3,
    /// The least offset of each object up to the last that has one.
    least_offsets: Vec<f32>,
    generation: u64,
    /// The data that `update` uploads, kept to avoid an allocation in each frame.
    upload: Vec<[u32; 4]>,
    /// The same for a visibility buffer.
    records: Vec<DrawnRecord>,
    /// The triangles of the largest mesh.
    most_triangles: u32,
}

/// The position of a bottom level in the buffers.
#[derive(Debug)]
struct Placed {
    name: String,
    root: u32,
    first_triangle: u32,
    first_vertex: u32,
    vertices: u32,
    attributes: u32,
    places: u32,
    masked: bool,
    bounds: Option<[Vec3; 2]>,
    /// The diagonal of the largest triangle's box.
    extent: f32,
}

/// A storage buffer that keeps its content as it grows.
#[derive(Debug)]
struct Growing {
    buffer: wgpu::Buffer,
    what: &'static str,
}

impl Growing {
    fn new(device: &wgpu::Device, what: &'static str) -> Self {
        Self { buffer: Self::make(device, what, 256), what }
    }

    fn make(device: &wgpu::Device, what: &'static str, size: u64) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false })
    }

    /// Makes room for a number of bytes, of which the first `keep` are preserved. Returns whether the buffer was
    /// replaced.
    fn reserve(
        &mut self,
        device: &wgpu::Device,
        encoder: Option<&mut wgpu::CommandEncoder>,
        bytes: u64,
        keep: u64,
    ) -> Result<bool, RayError> {
        if bytes <= self.buffer.size() {
            return Ok(false);
        }
        let limit = device.limits().max_storage_buffer_binding_size.min(device.limits().max_buffer_size) & !255;
        if bytes > limit {
            return Err(RayError::TooLarge { what: self.what, bytes, limit });
        }
        let grown = Self::make(device, self.what, (bytes + bytes / 2).next_multiple_of(256).min(limit));
        if let (true, Some(encoder)) = (keep > 0, encoder) {
            encoder.copy_buffer_to_buffer(&self.buffer, 0, &grown, 0, keep);
        }
        self.buffer = grown;
        Ok(true)
    }
}

/// The most instances of a frame: a ray query counts them with 24 bits.
pub const MAX_INSTANCES: usize = (1 << 24) - 1;

/// The bytes of a vec4u, the element of all three buffers.
const VEC4: u64 = 16;
/// The number of vec4s of a node, and of an [`InstanceRecord`].
pub(super) const RECORD: usize = 5;
const _: () = assert!(size_of::<InstanceRecord>() == RECORD * VEC4 as usize);
const _: () = assert!(size_of::<CwBvhNode>() == RECORD * VEC4 as usize);
/// The number of vec4s of a [`DrawnRecord`].
const DRAWN: usize = 4;
const _: () = assert!(size_of::<DrawnRecord>() == DRAWN * VEC4 as usize);

impl RayScene {
    /// An empty scene for rays. After an [`update`](Self::update) every ray misses.
    pub fn new(device: &wgpu::Device, tier: RayTier) -> Self {
        Self::empty(device, Some(tier), None)
    }

    /// An empty scene for a visibility buffer, and for rays if there is a tier. Its meshes need attributes. Without
    /// rays they need no tree: see [`BottomLevel::untraced`].
    pub fn for_visibility(device: &wgpu::Device, rays: Option<RayTier>) -> Self {
        Self::empty(device, rays, Some(Growing::new(device, "drawn instances")))
    }

    fn empty(device: &wgpu::Device, tier: Option<RayTier>, drawn: Option<Growing>) -> Self {
        Self {
            data: Growing::new(device, "meshes"),
            top: Growing::new(device, "instances"),
            drawn,
            structures: (tier == Some(RayTier::Query)).then(|| Structures::new(device)),
            hosts: None,
            meshes: Vec::new(),
            used: 0,
            instances: 0,
            tier,
            camera: Vec3::ZERO,
            least_offsets: Vec::new(),
            generation: next_generation(),
            upload: Vec::new(),
            records: Vec::new(),
            most_triangles: 0,
        }
    }

    /// Uploads a mesh. `encoder` receives the copies of buffers that had to grow and the builds of acceleration
    /// structures: submit it before rays are traced.
    pub fn add(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        mesh: &BottomLevel,
    ) -> Result<MeshId, RayError> {
        if self.tier == Some(RayTier::Software) && !mesh.has_tree() {
            return Err(RayError::NoTree { mesh: mesh.name.clone() });
        }
        if self.drawn.is_some() && mesh.attributes.is_empty() && !mesh.positions.is_empty() {
            return Err(RayError::NoAttributes { mesh: mesh.name.clone() });
        }
        // Nodes are found by their number, so they lie at multiples of their size.
        let first_node = self.used.next_multiple_of(RECORD as u64);
        let root = first_node / RECORD as u64;
        // The adapter's structures replace the nodes.
        let own_nodes = if self.structures.is_some() { &[][..] } else { &mesh.nodes };
        let first_triangle = first_node + (own_nodes.len() * RECORD) as u64;
        let order = self.order(mesh);
        let first_vertex = first_triangle + order.len() as u64;
        let vertices = mesh.positions.len();
        let places = self.places(&order);
        let first_place = first_vertex + (vertices + mesh.attributes.len()) as u64;
        let end = first_place + places.len() as u64;

        let mut relocated = own_nodes.to_vec();
        for node in &mut relocated {
            node.child_base_idx += root as u32;
            node.primitive_base_idx += first_triangle as u32;
        }
        let triangles = order.iter().map(|&[a, b, c, id]| {
            let [a, b, c] = [a, b, c].map(|v| v + first_vertex as u32);
            [a, b, c, id]
        });
        let user = |i: usize| mesh.attributes.get(i).map_or(0, |(_, user)| *user);
        let positions = mesh.positions.iter().enumerate().map(|(i, p)| {
            let [x, y, z] = p.map(f32::to_bits);
            [x, y, z, user(i)]
        });
        let attributes = mesh.attributes.iter().map(|&(packed, _)| packed);
        let first_place = if places.is_empty() { 0 } else { first_place as u32 };
        let records: Vec<[u32; 4]> = triangles.chain(positions).chain(attributes).chain(places).collect();

        let grown = self.data.reserve(device, Some(&mut *encoder), end * VEC4, self.used * VEC4)?;
        self.changed(grown);
        if let Some(structures) = &mut self.structures {
            structures.add(device, queue, encoder, mesh)?;
        }
        queue.write_buffer(&self.data.buffer, first_node * VEC4, bytemuck::cast_slice(&relocated));
        queue.write_buffer(&self.data.buffer, first_triangle * VEC4, bytemuck::cast_slice(&records));
        self.used = end;
        self.most_triangles = self.most_triangles.max(order.len() as u32);
        self.meshes.push(Placed {
            name: mesh.name.clone(),
            root: root as u32,
            first_triangle: first_triangle as u32,
            first_vertex: first_vertex as u32,
            vertices: vertices as u32,
            places: first_place,
            attributes: if mesh.attributes.is_empty() { 0 } else { vertices as u32 },
            masked: mesh.masked,
            bounds: mesh.bounds,
            extent: mesh.extent(),
        });
        Ok(MeshId(self.meshes.len() as u32 - 1))
    }

    /// Moves the vertices of a mesh, for a visibility buffer that shows it deformed: skinned or morphed. There is a
    /// position and a set of attributes for each vertex that [`add`](Self::add) got. No tree is rebuilt, so rays may
    /// miss what has moved: [`add`](Self::add) the deformed mesh anew if frames trace it.
    pub fn deform(
        &self,
        queue: &wgpu::Queue,
        mesh: MeshId,
        positions: &[[f32; 3]],
        attributes: &[Attributes],
    ) -> Result<(), RayError> {
        let meshes = self.meshes.len();
        let none = RayError::NoMesh { instance: 0, mesh: mesh.0, meshes };
        let placed = self.meshes.get(mesh.0 as usize).ok_or(none)?;
        let name = || placed.name.clone();
        if placed.attributes == 0 && placed.vertices > 0 {
            return Err(RayError::NoAttributes { mesh: name() });
        }
        let vertices = placed.vertices as usize;
        if [positions.len(), attributes.len()] != [vertices; 2] {
            return Err(RayError::Attributes { mesh: name(), attributes: attributes.len(), vertices });
        }
        if let Some(vertex) = positions.iter().position(|p| !mesh::is_in_range(p)) {
            return Err(RayError::Vertex { mesh: name(), vertex, position: positions[vertex] });
        }
        if let Some(vertex) = attributes.iter().position(|a| !a.is_finite()) {
            return Err(RayError::Attribute { mesh: name(), vertex });
        }
        let moved =
            positions.iter().zip(attributes).map(|([x, y, z], a)| [x.to_bits(), y.to_bits(), z.to_bits(), a.user]);
        let records: Vec<[u32; 4]> = moved.chain(attributes.iter().map(attributes::packed)).collect();
        let at = u64::from(placed.first_vertex) * VEC4;
        queue.write_buffer(&self.data.buffer, at, bytemuck::cast_slice(&records));
        Ok(())
    }

    /// Sets the instances of the frame. `camera` is the camera's position in world space: rays are traced relative to
    /// it, so that worlds may be large. `encoder` receives the build of the adapter's top level. If it fails, the scene
    /// keeps its former instances.
    ///
    /// A visibility buffer names instances by their index in `instances`; it shows those of the last update before the
    /// submit. There, an instance that is too flat to be traced is only drawn.
    pub fn update(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        instances: &[Instance],
        camera: Vec3,
    ) -> Result<(), RayError> {
        self.place(device, queue, Ok(encoder), instances, camera)
    }

    /// Like [`update`](Self::update), but over a top level of the host's own, on [`RayTier::Query`]. That top level is
    /// in world space. The custom data of each of its instances is the index into `instances`, which have the same
    /// transforms. Its bottom levels have the triangles of the meshes in the order in which [`add`](Self::add) got
    /// them. Far from the origin rays are only as precise as world coordinates are.
    pub fn update_with(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        top: &wgpu::Tlas,
        instances: &[Instance],
        camera: Vec3,
    ) -> Result<(), RayError> {
        if self.tier != Some(RayTier::Query) {
            return Err(RayError::HostTopLevel);
        }
        self.place(device, queue, Err(top), instances, camera)
    }

    /// Sets the instances, with an encoder that builds our own top level, or with the host's top level.
    fn place(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        builder: Result<&mut wgpu::CommandEncoder, &wgpu::Tlas>,
        instances: &[Instance],
        camera: Vec3,
    ) -> Result<(), RayError> {
        if instances.len() > MAX_INSTANCES {
            return Err(RayError::Instances { instances: instances.len(), limit: MAX_INSTANCES });
        }
        let (mut boxes, mut records, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let mut culls = false;
        let mut least_offsets: Vec<f32> = Vec::new();
        self.records.clear();
        for (index, instance) in instances.iter().enumerate() {
            let (mesh, meshes) = (instance.mesh.0, self.meshes.len());
            let placed = self.meshes.get(mesh as usize).ok_or(RayError::NoMesh { instance: index, mesh, meshes })?;
            for (what, id) in [("material", instance.material), ("object", instance.object)] {
                if id > 0xffff {
                    return Err(RayError::Id { instance: index, what, id });
                }
            }
            let transform = |why| RayError::Transform { instance: index, mesh: placed.name.clone(), why };
            if self.drawn.is_some() {
                let relative_from_own = relative_from_own(instance.world, camera).map_err(transform)?;
                self.records.push(DrawnRecord {
                    relative_from_own,
                    first_triangle: placed.first_triangle,
                    attributes: placed.attributes,
                    identity: instance.material | instance.object << 16,
                    places: placed.places,
                });
            }
            if self.tier.is_none() {
                continue;
            }
            let place = match Place::of(instance.world, camera).map_err(transform) {
                Ok(place) => place,
                Err(_) if self.drawn.is_some() && builder.is_ok() => continue,
                Err(error) => return Err(error),
            };
            // The host's own top level also counts instances without triangles.
            let Some(bounds) = placed.bounds.or(builder.is_err().then_some([Vec3::ZERO; 2])) else { continue };
            if let Some(offset) = place.least_offset(bounds, placed.extent) {
                let object = instance.object as usize;
                if least_offsets.len() <= object {
                    least_offsets.resize(object + 1, 0.0);
                }
                least_offsets[object] = offset.max(least_offsets[object]);
            }
            culls |= instance.culled;
            match self.structures {
                Some(_) => places.push(PlacedInstance {
                    mesh,
                    place: place.relative_from_own(),
                    casts_shadow: instance.casts_shadow,
                }),
                None => boxes.push(place.bounds(bounds)),
            }
            records.push(InstanceRecord {
                own_from_relative: place.own_from_relative,
                root: placed.root,
                index: index as u32,
                first_triangle: placed.first_triangle,
                attributes: placed.attributes,
                material: instance.material,
                object: instance.object,
                user: instance.user,
                flags: [(placed.masked, MASKED), (instance.culled, CULLED), (!instance.casts_shadow, CLEAR)]
                    .into_iter()
                    .fold(0, |flags, (is, flag)| if is { flags | flag } else { flags }),
            });
        }
        if let Some(drawn) = &mut self.drawn {
            let grown = drawn.reserve(device, None, size_of_val(&self.records[..]) as u64, 0)?;
            queue.write_buffer(&drawn.buffer, 0, bytemuck::cast_slice(&self.records));
            self.changed(grown);
        }
        let (nodes, order) = match self.structures {
            Some(_) => (Vec::new(), (0..records.len() as u32).collect()),
            None => mesh::wide(&boxes, Quality::Dynamic),
        };
        // The records follow the header; for a ray query the header has a second vec4, with the origin of its rays.
        let first = 1 + usize::from(self.structures.is_some()) + nodes.len() * RECORD;
        let offsets_at = first + records.len() * RECORD;
        let bytes = (offsets_at + least_offsets.len().div_ceil(4)) as u64 * VEC4;
        let grown = self.top.reserve(device, None, bytes, 0)?;
        self.changed(grown);
        let shift = if builder.is_err() { camera } else { Vec3::ZERO };
        match (builder, &mut self.structures) {
            (Ok(encoder), Some(structures)) => {
                let grown = structures.update(device, encoder, &places)?;
                let other = self.hosts.take().is_some();
                self.changed(grown || other);
            }
            (Err(top), _) if self.hosts.as_ref() != Some(top) => {
                self.hosts = Some(top.clone());
                self.changed(true);
            }
            _ => {}
        }
        self.upload.clear();
        self.upload.push([first, records.len(), least_offsets.len(), offsets_at].map(|word| word as u32));
        if self.structures.is_some() {
            let [x, y, z] = shift.to_array().map(f32::to_bits);
            self.upload.push([x, y, z, u32::from(culls)]);
        }
        self.upload.extend_from_slice(bytemuck::cast_slice(&nodes));
        for &i in &order {
            self.upload.extend_from_slice(bytemuck::cast_slice(&[records[i as usize]]));
        }
        self.upload.extend(least_offsets.chunks(4).map(|offsets| {
            let bits = |i: usize| offsets.get(i).map_or(0, |offset| offset.to_bits());
            [bits(0), bits(1), bits(2), bits(3)]
        }));
        self.least_offsets = least_offsets;
        queue.write_buffer(&self.top.buffer, 0, bytemuck::cast_slice(&self.upload));
        self.instances = records.len() as u32;
        self.camera = camera;
        Ok(())
    }

    /// The number of instances that rays may hit.
    pub fn instances(&self) -> u32 {
        self.instances
    }

    /// The GPU memory of its buffers in bytes.
    pub fn bytes(&self) -> u64 {
        let all = [Some(&self.data), Some(&self.top), self.drawn.as_ref()];
        all.into_iter().flatten().map(|b| b.buffer.size()).sum()
    }

    /// The triangles of a mesh: for rays in software in the order of the leaves, otherwise in that of the mesh,
    /// including those without an area.
    fn order<'a>(&self, mesh: &'a BottomLevel) -> Cow<'a, [[u32; 4]]> {
        match (self.tier, &self.drawn) {
            (Some(RayTier::Software), None) => mesh.triangles[..].into(),
            (Some(RayTier::Software), Some(_)) => mesh.leaves_first().into(),
            _ => mesh.as_they_were().into(),
        }
    }

    /// The place of each triangle of a mesh in `order`, four to a vec4; empty where nothing looks for it or each is in
    /// its own place.
    fn places(&self, order: &[[u32; 4]]) -> Vec<[u32; 4]> {
        let sorted = (0..).zip(order).all(|(place, triangle): (u32, _)| triangle[3] == place);
        if self.drawn.is_none() || sorted {
            return Vec::new();
        }
        let mut places = vec![[0; 4]; order.len().div_ceil(4)];
        for (place, triangle) in (0..).zip(order) {
            let id = triangle[3] as usize;
            places[id / 4][id % 4] = place;
        }
        places
    }

    /// The triangles of the largest mesh and the instances of the frame, which a visibility buffer names.
    pub(crate) fn most_ids(&self) -> [u32; 2] {
        [self.most_triangles, self.records.len() as u32]
    }

    /// The buffers that a visibility buffer is read with: the meshes, and the instances of the frame. `None` if the
    /// scene is for rays alone.
    pub fn visibility_buffers(&self) -> Option<[&wgpu::Buffer; 2]> {
        Some([&self.data.buffer, &self.drawn.as_ref()?.buffer])
    }

    /// The top level of [`RayTier::Query`]: the adapter's, or the host's own.
    pub fn top_level(&self) -> Option<&wgpu::Tlas> {
        self.hosts.as_ref().or(self.structures.as_ref().map(|s| &s.top))
    }

    /// The buffers of the meshes and of the top level: `daa_ray_meshes` and `daa_ray_top` of
    /// [`SOFTWARE_WGSL`](super::SOFTWARE_WGSL).
    pub fn buffers(&self) -> [&wgpu::Buffer; 2] {
        [&self.data.buffer, &self.top.buffer]
    }

    /// A number that changes when a buffer is replaced, so that bind groups must be recreated. No two scenes have the
    /// same number.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// The least distance from a surface at which its rays start, in world units, by object; 0 for those beyond the end.
    /// It is above 0 if an object has triangles that are large for their distance to the camera, or vertices that lie
    /// much farther from their own origin, where f32 rounds coarsely. Moving an instance by its transform does not need
    /// it.
    pub fn least_offsets(&self) -> &[f32] {
        &self.least_offsets
    }

    fn changed(&mut self, grown: bool) {
        if grown {
            self.generation = next_generation();
        }
    }

    /// How rays are traced; `None` if they are not.
    pub fn tier(&self) -> Option<RayTier> {
        self.tier
    }

    /// The camera position of the last update, in world space. Rays are relative to it.
    pub fn camera(&self) -> Vec3 {
        self.camera
    }
}

fn next_generation() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// The corners of a box.
fn corners(low: Vec3, high: Vec3) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |corner| {
        let pick = |bit: usize| f64::from(if corner >> bit & 1 == 0 { low[bit] } else { high[bit] });
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// The rows of the transform from a mesh's own space to camera-relative space, in which f64 keeps the digits of worlds
/// that are large.
fn relative_from_own(world: Affine3A, camera: Vec3) -> Result<[[f32; 4]; 3], &'static str> {
    let translation = Vec3::from(world.translation).as_dvec3() - camera.as_dvec3();
    let row = |i: usize| world.matrix3.row(i).extend(translation[i] as f32).to_array();
    let rows = [row(0), row(1), row(2)];
    if rows.as_flattened().iter().all(|c| c.abs() <= MAX_COORDINATE) {
        Ok(rows)
    } else {
        Err("is not finite, or moves it too far")
    }
}

/// The position of an instance relative to the camera.
struct Place {
    matrix: DMat3,
    translation: DVec3,
    own_from_relative: [[f32; 4]; 3],
}

impl Place {
    fn of(world: Affine3A, camera: Vec3) -> Result<Self, &'static str> {
        if !world.is_finite() {
            return Err("is not finite");
        }
        let matrix = DMat3::from_cols(
            world.matrix3.x_axis.as_dvec3(),
            world.matrix3.y_axis.as_dvec3(),
            world.matrix3.z_axis.as_dvec3(),
        );
        let translation = world.translation.as_dvec3() - camera.as_dvec3();
        let volume = matrix.x_axis.length() * matrix.y_axis.length() * matrix.z_axis.length();
        // Below this, the transform can't be inverted in f32.
        if matrix.determinant().abs() <= 1e-6 * volume {
            return Err("flattens it");
        }
        let inverse = matrix.inverse();
        let offset = -(inverse * translation);
        let row = |i| inverse.row(i).extend(offset[i]).to_array().map(|c| c as f32);
        let own_from_relative = [row(0), row(1), row(2)];
        if own_from_relative.as_flattened().iter().any(|c| c.is_nan() || c.abs() > MAX_COORDINATE) {
            return Err("shrinks or moves it too far");
        }
        Ok(Self { matrix, translation, own_from_relative })
    }

    /// 2⁻²¹ of the mesh's own coordinates and of the extent of its largest triangle, since each of a few sums rounds a
    /// ray to 2⁻²⁴ of these. `None` if all of the mesh is so far from the camera that the offset by distance
    /// (casting.wgsl) is enough.
    fn least_offset(&self, [low, high]: [Vec3; 2], extent: f32) -> Option<f32> {
        let (mut min, mut max, mut own) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0_f64);
        for corner in corners(low, high) {
            let p = self.matrix * corner;
            own = own.max(p.abs().max_element());
            (min, max) = (min.min(p + self.translation), max.max(p + self.translation));
        }
        let axes = [self.matrix.x_axis, self.matrix.y_axis, self.matrix.z_axis];
        let largest = axes.into_iter().map(DVec3::length).fold(0.0, f64::max) * f64::from(extent);
        let needed = own.min(self.translation.abs().max_element()).max(largest) * 2.0_f64.powi(-21);
        let distance = min.max(-max).max(DVec3::ZERO).max_element();
        (needed > distance * 2.0_f64.powi(-16)).then_some(needed as f32)
    }

    /// The rows of the transform from the mesh's own space to camera-relative space.
    fn relative_from_own(&self) -> [f32; 12] {
        let row = |i| self.matrix.row(i).extend(self.translation[i]).as_vec4().to_array();
        let mut rows = [0.0; 12];
        rows.as_chunks_mut::<4>().0.copy_from_slice(&[row(0), row(1), row(2)]);
        rows
    }

    /// The bounding box relative to the camera, with a margin for the rounding of rays that are transformed to the
    /// mesh's own space.
    fn bounds(&self, [low, high]: [Vec3; 2]) -> Aabb {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in corners(low, high) {
            let p = self.matrix * corner + self.translation;
            (min, max) = (min.min(p), max.max(p));
        }
        let pad = 1e-6 * min.abs().max(max.abs()).max_element().max((max - min).max_element());
        Aabb::new((min - pad).as_vec3a(), (max + pad).as_vec3a())
    }
}
