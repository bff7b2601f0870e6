//! Loading glTF 2.0 files, .gltf and .glb.
//!
//! Works on the plain JSON types of `gltf-json`, because the `gltf` crate's own validation panics on some broken
//! files and refuses others that every viewer shows. Here a file is checked where it is used: what is not drawn may
//! be broken. No input makes the loader panic, loop, or allocate more than its data call for.

mod accessor;
mod cameras;
mod compact;
mod container;
mod error;
mod images;
mod lights;
mod limits;
mod material;
mod mesh;
mod nodes;
mod placement;
mod skin;
mod uri;
mod uv_sets;

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use glam::{Mat4, Vec3};
use gltf::json::Root;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use self::accessor::Document;
pub use self::error::{LoadError, Problem};
use self::limits::{MAX_INSTANCES, label};
use self::material::MaterialTable;
use self::placement::Shape;
use self::skin::Skin;
use super::{Camera, Instance, Light, Mesh, Scene, Sun};

/// Extensions that files may require.
pub const SUPPORTED_EXTENSIONS: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// More notices than this help nobody.
const MAX_NOTICES: usize = 100;

/// Loads scene `scene_index` of a file, or its default scene.
///
/// # Errors
///
/// If the file, or one it needs, cannot be read, is damaged, or needs what this loader lacks. What can be shown in part
/// is shown in part, with [`Scene::notices`].
pub fn load(path: &Path, scene_index: Option<usize>) -> Result<Scene, LoadError> {
    let scene = uri::read_file(path).and_then(|file| parse(&file, path, scene_index));
    scene.map_err(|problem| LoadError::new(path, problem))
}

/// [`load`] of a file whose contents are here already. `path` says where the files are that it refers to.
///
/// # Errors
///
/// As [`load`].
pub fn load_bytes(file: &[u8], path: &Path, scene_index: Option<usize>) -> Result<Scene, LoadError> {
    parse(file, path, scene_index).map_err(|problem| LoadError::new(path, problem))
}

/// Loads the contents of the file at `path`.
fn parse(file: &[u8], path: &Path, scene_index: Option<usize>) -> Result<Scene, Problem> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let (json, bin) = container::split(file)?;
    let mut tree: serde_json::Value = serde_json::from_slice(json).map_err(|e| other_kind(file).unwrap_or(e.into()))?;
    let animations = leave_out_the_unused(&mut tree);
    let root: Root = serde_json::from_value(tree)?;
    let mut notices = Vec::new();
    check_version(&root)?;
    check_extensions(&root, &mut notices)?;
    let buffers = buffers(&root, bin, folder)?;
    let document = Document { root, buffers };

    let placed = nodes::walk(&document.root, scene_index, &mut notices)?;
    note_the_static(&document.root, &placed, animations, &mut notices);
    let mut assembly = Assembly::new(&document, nodes::worlds(&document.root, &placed));
    for node in placed {
        assembly.add_node(node)?;
    }
    assembly.notices.splice(0..0, notices);
    assembly.finish(path, folder)
}

/// What a file is that people take for a scene.
fn other_kind(file: &[u8]) -> Option<Problem> {
    if let Ok(format) = image::guess_format(file) {
        return Some(Problem::Kind(format!("a {} image", format.extensions_str().first()?.to_uppercase())));
    }
    let kinds: [(&[u8], &str); 4] =
        [(b"PK\x03\x04", "a ZIP archive"), (b"BLENDER", "a Blender file"), (b"Kaydara FBX", "FBX"), (b"#", "text")];
    let (_, kind) = kinds.iter().find(|(begin, _)| file.starts_with(begin))?;
    Some(Problem::Kind((*kind).to_owned()))
}

/// Takes out of the JSON what the parser has stricter types for than glTF, and says how many animations there are.
fn leave_out_the_unused(tree: &mut serde_json::Value) -> usize {
    // A scene without nodes is empty, and the parser wants that said.
    for scene in tree.get_mut("scenes").and_then(|s| s.as_array_mut()).into_iter().flatten() {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| serde_json::Value::Array(Vec::new()));
        }
    }
    leave_out_extras(tree);
    // Channels may lack a node, for one, where an extension says what they move.
    let animations = tree.as_object_mut().and_then(|root| root.remove("animations"));
    animations.as_ref().and_then(|animations| animations.as_array()).map_or(0, Vec::len)
}

/// `extras` may be any JSON.
fn leave_out_extras(tree: &mut serde_json::Value) {
    match tree {
        serde_json::Value::Object(members) => {
            members.remove("extras");
            members.values_mut().for_each(leave_out_extras);
        }
        serde_json::Value::Array(elements) => elements.iter_mut().for_each(leave_out_extras),
        _ => {}
    }
}

fn check_version(root: &Root) -> Result<(), Problem> {
    let asset = &root.asset;
    let is_2 = |version: &str| version == "2" || version.starts_with("2.");
    // A minimum version above 2.0 says that 2.0 is not enough to read the file.
    match &asset.min_version {
        Some(least) if least != "2.0" => Err(Problem::Version(least.clone())),
        None if !is_2(&asset.version) => Err(Problem::Version(asset.version.clone())),
        _ => Ok(()),
    }
}

fn check_extensions(root: &Root, notices: &mut Vec<String>) -> Result<(), Problem> {
    let unsupported = |name: &&String| !SUPPORTED_EXTENSIONS.contains(&name.as_str());
    if let Some(name) = root.extensions_required.iter().find(unsupported) {
        return Err(Problem::Extension(name.clone()));
    }
    let ignored = root.extensions_used.iter().filter(unsupported);
    notices.extend(ignored.map(|name| format!("extension {} is not supported and ignored", name.escape_debug())));
    Ok(())
}

fn buffers<'a>(root: &Root, bin: Option<&'a [u8]>, folder: &Path) -> Result<Vec<Cow<'a, [u8]>>, Problem> {
    let load = |(number, buffer): (usize, &gltf::json::Buffer)| {
        let place = label("buffer", number, buffer.name.as_deref());
        let bytes = match (&buffer.uri, bin) {
            (Some(uri), _) => Cow::Owned(uri::read(uri, folder, &place)?),
            (None, Some(bin)) if number == 0 => Cow::Borrowed(bin),
            // A placeholder, for instance for what an extension decompresses; any use of it is an error of its own.
            (None, _) => return Ok(Cow::default()),
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            let reason = format!("{} bytes instead of {}", bytes.len(), buffer.byte_length.0);
            return Err(Problem::Buffer { place, reason });
        }
        Ok(bytes)
    };
    root.buffers.iter().enumerate().map(load).collect()
}

/// Notes what moves in the file and stands still here.
fn note_the_static(root: &Root, placed: &[nodes::Placed], animations: usize, notices: &mut Vec<String>) {
    if animations > 0 {
        notices.push(format!("{animations} animations ignored"));
    }
    let drawn = || placed.iter().filter(|node| node.visible).filter_map(|node| root.nodes.get(node.number));
    let meshes = drawn().filter_map(|node| root.meshes.get(node.mesh?.value()));
    if meshes.flat_map(|mesh| &mesh.primitives).any(|primitive| primitive.targets.is_some()) {
        notices.push("morph targets ignored, their weights are taken as 0".to_owned());
    }
}

/// A scene under construction.
struct Assembly<'a> {
    document: &'a Document<'a>,
    materials: MaterialTable<'a>,
    meshes: Vec<Mesh>,
    /// The scene's meshes for a mesh of the file in a shape.
    converted: HashMap<(usize, Shape), Vec<usize>>,
    /// The world matrices of all nodes.
    worlds: Vec<Mat4>,
    skins: HashMap<usize, Rc<Skin>>,
    /// The first copy of a mesh that its matrix leaves no surface of, and their number.
    collapsed: Option<(String, usize)>,
    corner_budget: usize,
    instances: Vec<Instance>,
    objects: usize,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
    notices: Vec<String>,
}

impl<'a> Assembly<'a> {
    fn new(document: &'a Document<'a>, worlds: Vec<Mat4>) -> Self {
        Self {
            document,
            materials: MaterialTable::new(&document.root),
            meshes: Vec::new(),
            converted: HashMap::new(),
            worlds,
            skins: HashMap::new(),
            collapsed: None,
            corner_budget: mesh::MAX_CORNERS,
            instances: Vec::new(),
            objects: 0,
            lights: Vec::new(),
            cameras: Vec::new(),
            notices: Vec::new(),
        }
    }

    fn add_node(&mut self, placed: nodes::Placed) -> Result<(), Problem> {
        let root = &self.document.root;
        let nodes::Placed { number, world, visible } = placed;
        let node = &root.nodes[number];
        let place = label("node", number, node.name.as_deref());
        let dangling = |kind, index, count| Problem::Reference { from: place.clone(), kind, index, count };

        if let Some(index) = node.camera.map(|camera| camera.value()) {
            let camera = root.cameras.get(index).ok_or_else(|| dangling("camera", index, root.cameras.len()))?;
            match cameras::convert(camera, world) {
                Some(camera) => self.cameras.push(camera),
                None => self.notices.push(format!("{place}: camera {index} ignored, it is degenerate")),
            }
        }
        if !visible {
            return Ok(());
        }
        if let Some(light) = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) {
            let lights: &[gltf::json::extensions::scene::khr_lights_punctual::Light] = root.as_ref();
            let index = light.light.value();
            let light = lights.get(index).ok_or_else(|| dangling("light", index, lights.len()))?;
            match lights::convert(light, world) {
                Some(light) => self.lights.push(light),
                None => self.notices.push(format!("{place}: light {index} ignored, it is dark or degenerate")),
            }
        }
        let Some(mesh) = node.mesh.map(|mesh| mesh.value()) else { return Ok(()) };
        if let Some(skin) = self.skin(node, &place)? {
            let (number, skin) = skin;
            let meshes = self.mesh(mesh, (Shape::Skinned(number), Some(&skin)), &place)?;
            return self.add_instance(&meshes, Mat4::from_translation(skin.origin.as_vec3()));
        }
        for world in nodes::copies(self.document, node, &place, world)? {
            match placement::split(world) {
                Some((shape, world_from_mesh)) => {
                    let meshes = self.mesh(mesh, (shape, None), &place)?;
                    self.add_instance(&meshes, world_from_mesh)?;
                }
                None => self.collapsed.get_or_insert_with(|| (place.clone(), 0)).1 += 1,
            }
        }
        Ok(())
    }

    /// Draws meshes as one object.
    fn add_instance(&mut self, meshes: &[usize], world_from_mesh: Mat4) -> Result<(), Problem> {
        let object = (self.objects % usize::from(u16::MAX)) as u16 + 1;
        self.objects += 1;
        self.instances.extend(meshes.iter().map(|&mesh| Instance { mesh, world_from_mesh, object }));
        if self.instances.len() > MAX_INSTANCES {
            return Err(Problem::TooLarge { what: "the instances".to_owned(), limit: MAX_INSTANCES });
        }
        Ok(())
    }

    /// The skin of a node whose mesh has joints, read when first met, and its number.
    fn skin(&mut self, node: &gltf::json::Node, place: &str) -> Result<Option<(usize, Rc<Skin>)>, Problem> {
        let Some(number) = node.skin.map(|skin| skin.value()) else { return Ok(None) };
        let mesh = node.mesh.and_then(|mesh| self.document.root.meshes.get(mesh.value()));
        let is_bound = |primitive: &Primitive| primitive.attributes.contains_key(&Checked::Valid(Semantic::Joints(0)));
        if mesh.is_some_and(|mesh| !mesh.primitives.iter().any(is_bound)) {
            self.notices.push(format!("{place}: its skin ignored, its mesh has no joints"));
            return Ok(None);
        }
        if let Some(known) = self.skins.get(&number) {
            return Ok(Some((number, known.clone())));
        }
        let skin = Rc::new(Skin::read(self.document, number, place, &self.worlds)?);
        self.skins.insert(number, skin.clone());
        Ok(Some((number, skin)))
    }

    /// The scene's meshes for mesh `number` of the file in a shape, converted when first met.
    fn mesh(
        &mut self,
        number: usize,
        (shape, skin): (Shape, Option<&Skin>),
        user: &str,
    ) -> Result<Vec<usize>, Problem> {
        if let Some(known) = self.converted.get(&(number, shape)) {
            return Ok(known.clone());
        }
        let root = &self.document.root;
        let mesh = root.meshes.get(number).ok_or_else(|| Problem::Reference {
            from: user.to_owned(),
            kind: "mesh",
            index: number,
            count: root.meshes.len(),
        })?;
        let place = label("mesh", number, mesh.name.as_deref());
        let first = self.meshes.len();
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("{place} primitive {i}");
            let (materials, budget) = (&mut self.materials, &mut self.corner_budget);
            let how = (shape, skin);
            self.meshes.extend(mesh::convert(
                self.document,
                primitive,
                &place,
                how,
                materials,
                budget,
                &mut self.notices,
            )?);
        }
        let converted: Vec<usize> = (first..self.meshes.len()).collect();
        self.converted.insert((number, shape), converted.clone());
        Ok(converted)
    }

    fn finish(mut self, path: &Path, folder: &Path) -> Result<Scene, Problem> {
        let images = images::decode_all(self.document, folder, &self.materials.images, &mut self.materials.notices)?;
        self.notices.append(&mut self.materials.notices);
        if let Some((first, count)) = self.collapsed {
            let others = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
            self.notices.push(format!("{first}{others} not drawn, the scale leaves a line or a point"));
        }
        let mut scene = Scene {
            name: path.display().to_string(),
            meshes: self.meshes,
            instances: self.instances,
            materials: self.materials.materials,
            textures: self.materials.textures,
            images,
            cameras: self.cameras,
            notices: self.notices,
            ..Scene::default()
        };
        if self.lights.is_empty() {
            scene.sun = Some(Sun::default());
            scene.lights = scene.bounds().map(|bounds| lights::rig(&bounds)).unwrap_or_default();
        } else {
            let (centre, radius) = scene.bounds().map_or((Vec3::ZERO, 1.0), |b| (b.centre(), b.radius()));
            if let Some(factor) = lights::expose(&mut self.lights, centre, radius) {
                scene.notices.push(format!("all lights scaled by {factor:.3e}, for there is no exposure control"));
            }
            scene.sun = lights::take_sun(&mut self.lights);
            scene.lights = self.lights;
        }
        if scene.instances.is_empty() {
            scene.notices.push("there is nothing to draw in this scene".to_owned());
        }
        let excess = scene.notices.len().saturating_sub(MAX_NOTICES);
        if excess > 0 {
            scene.notices.truncate(MAX_NOTICES);
            scene.notices.push(format!("and {excess} more notices"));
        }
        Ok(scene)
    }
}

#[cfg(test)]
mod tests;
