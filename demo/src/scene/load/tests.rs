//! Models built in memory, each for one feature or one kind of damage.

use std::f32::consts::FRAC_PI_2;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::{Mat4, Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::{LoadError, Problem, SUPPORTED_EXTENSIONS};
use crate::scene::{Lens, LightKind, Nearest, Scene, TextureRef, Wrap};

/// A glTF file under construction.
struct Model(Value);

impl Model {
    /// One triangle in the plane z = 0, drawn by one node; accessor 0 has its positions.
    fn triangle() -> Self {
        let mut model = Self(json!({
            "asset": { "version": "2.0" },
            "buffers": [], "bufferViews": [], "accessors": [],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "nodes": [{ "mesh": 0 }],
        }));
        model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        model
    }

    /// A square of two triangles, four positions.
    fn square() -> Self {
        let mut model = Self::triangle();
        let corners = model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
        model.primitive()["attributes"]["POSITION"] = corners.into();
        model
    }

    fn push(&mut self, array: &str, value: Value) -> usize {
        let array = self.0[array].as_array_mut().unwrap();
        array.push(value);
        array.len() - 1
    }

    fn bytes(&mut self, bytes: &[u8]) -> usize {
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes));
        let buffer = self.push("buffers", json!({ "byteLength": bytes.len(), "uri": uri }));
        self.push("bufferViews", json!({ "buffer": buffer, "byteLength": bytes.len() }))
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.bytes(bytes);
        let accessor = json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
        self.push("accessors", accessor)
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let dimensions = kind.strip_prefix("VEC").map_or(1, |n| n.parse().unwrap());
        self.accessor(kind, 5126, values.len() / dimensions, &bytes)
    }

    fn indices(&mut self, indices: &[u16]) {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.primitive()["indices"] = self.accessor("SCALAR", 5123, indices.len(), &bytes).into();
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.0["meshes"][0]["primitives"][0]
    }

    fn attribute(&mut self, name: &str, accessor: usize) {
        self.primitive()["attributes"][name] = accessor.into();
    }

    fn material(&mut self, material: Value) {
        self.0["materials"] = json!([material]);
        self.primitive()["material"] = 0.into();
    }

    /// Adds texture 0, a red texel.
    fn texture(&mut self) {
        let mut png = std::io::Cursor::new(Vec::new());
        image::RgbImage::from_pixel(1, 1, image::Rgb([255, 0, 0])).write_to(&mut png, image::ImageFormat::Png).unwrap();
        let view = self.bytes(png.get_ref());
        self.0["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
        self.0["textures"] = json!([{ "source": 0 }]);
    }

    fn load(&self) -> Result<Scene, Problem> {
        self.load_scene(None)
    }

    fn load_scene(&self, index: Option<usize>) -> Result<Scene, Problem> {
        super::parse(self.0.to_string().as_bytes(), Path::new("model.gltf"), index)
    }

    #[track_caller]
    fn scene(&self) -> Scene {
        let scene = self.load().unwrap_or_else(|problem| panic!("{problem}"));
        scene.validate().unwrap();
        scene
    }

    /// The message of the problem, which is always one line.
    #[track_caller]
    fn problem(&self) -> String {
        let message = LoadError::new(Path::new("model.gltf"), self.load().unwrap_err()).to_string();
        assert!(message.starts_with("model.gltf: ") && !message.contains('\n'), "{message}");
        message
    }
}

#[track_caller]
fn assert_mentions(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "{word:?} is not in {text:?}");
    }
}

// ---- Geometry ----

#[test]
fn a_bare_triangle_gets_all_attributes() {
    let scene = Model::triangle().scene();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.indices, [0, 1, 2]);
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    assert_eq!(mesh.colors, [Vec4::ONE; 3]);
    assert_eq!(scene.materials.len(), 1);
    // Without lights of its own it gets a sun and lamps.
    assert!(scene.sun.is_some() && scene.lights.len() == 5 && scene.notices.is_empty());
}

#[test]
fn strips_and_fans_keep_their_winding() {
    for (mode, order) in [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let mut model = Model::square();
        model.primitive()["mode"] = mode.into();
        model.indices(&order);
        let scene = model.scene();
        assert_eq!(scene.meshes[0].indices.len(), 6, "mode {mode}");
        assert_eq!(scene.meshes[0].normals, [Vec3::Z; 6], "mode {mode}");
    }
}

#[test]
fn points_and_lines_are_noted() {
    for mode in 0..4 {
        let mut model = Model::triangle();
        model.primitive()["mode"] = mode.into();
        let scene = model.scene();
        assert!(scene.meshes.is_empty());
        assert_mentions(&scene.notices[0], &["mesh 0 primitive 0", "lines"]);
    }
}

#[test]
fn only_used_vertices_are_kept() {
    let mut model = Model::square();
    let normals = model.floats("VEC3", &[0.0, 0.0, 2.0].repeat(4));
    model.attribute("NORMAL", normals);
    model.indices(&[1, 3, 2]);
    let mesh = &model.scene().meshes[0];
    assert_eq!(mesh.positions, [Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.indices, [0, 1, 2]);
    assert_eq!(mesh.normals, [Vec3::Z; 3], "made unit length");
}

#[test]
fn quantized_attributes() {
    let mut model = Model::triangle();
    let positions = model.accessor("VEC3", 5120, 3, &[0, 0, 0, 127, 0, 0, 0, 0x80, 0]);
    model.0["accessors"][positions]["normalized"] = true.into();
    model.attribute("POSITION", positions);
    let uvs = model.accessor("VEC2", 5123, 3, &[0, 0, 255, 255, 0, 0, 0, 0, 255, 127, 0, 0]);
    model.0["accessors"][uvs]["normalized"] = true.into();
    model.attribute("TEXCOORD_0", uvs);
    let colors = model.accessor("VEC3", 5121, 3, &[255, 0, 51, 255, 255, 255, 0, 0, 0]);
    model.0["accessors"][colors]["normalized"] = true.into();
    model.attribute("COLOR_0", colors);
    model.0["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = &model.scene().meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::NEG_Y], "−128 is −1 as well");
    assert_eq!(mesh.uvs[0], Vec2::new(0.0, 1.0));
    assert_eq!(mesh.colors[0], Vec4::new(1.0, 0.0, 0.2, 1.0));

    model.0["accessors"][positions]["normalized"] = false.into();
    assert_eq!(model.scene().meshes[0].positions[1], Vec3::X * 127.0);
}

#[test]
fn strides_and_offsets() {
    let mut model = Model::triangle();
    let values: Vec<u8> = [9.0, 0.0, 0.0, 0.0, 9.0, 1.0, 0.0, 0.0, 9.0, 0.0, 1.0, 0.0_f32]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let view = model.bytes(&values);
    model.0["bufferViews"][view]["byteStride"] = 16.into();
    model.0["accessors"][0]["bufferView"] = view.into();
    model.0["accessors"][0]["byteOffset"] = 4.into();
    assert_eq!(model.scene().meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    // Now the last element reaches one byte past the end.
    model.0["bufferViews"][view]["byteLength"] = 47.into();
    assert_mentions(&model.problem(), &["mesh 0 primitive 0", "accessor 0", "past the 47 bytes"]);
}

#[test]
fn sparse_accessors() {
    for with_base in [true, false] {
        let mut model = Model::triangle();
        let values = model.floats("VEC3", &[5.0, 6.0, 7.0]);
        let values = model.0["accessors"][values]["bufferView"].clone();
        let indices = model.bytes(&[2]);
        model.0["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": indices, "componentType": 5121 },
            "values": { "bufferView": values },
        });
        if !with_base {
            model.0["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        }
        let positions = model.scene().meshes[0].positions.clone();
        let second = if with_base { Vec3::X } else { Vec3::ZERO };
        assert_eq!(positions, [Vec3::ZERO, second, Vec3::new(5.0, 6.0, 7.0)]);

        let bad = model.bytes(&[3]);
        model.0["accessors"][0]["sparse"]["indices"]["bufferView"] = bad.into();
        assert_mentions(&model.problem(), &["accessor 0", "sparse"]);
    }
}

#[test]
fn triangles_without_a_place_are_left_out() {
    let mut model = Model::square();
    let nan = f32::NAN;
    let positions = model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, nan, 1.0, 0.0]);
    model.attribute("POSITION", positions);
    model.indices(&[0, 1, 2, 1, 3, 2]);
    let scene = model.scene();
    assert_eq!(scene.meshes[0].indices.len(), 3);
    assert_mentions(&scene.notices[0], &["1 triangles left out"]);
}

#[test]
fn unusable_vertices_are_repaired() {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 1.0, 0.0, 0.0]);
    model.attribute("NORMAL", normals);
    let uvs = model.floats("VEC2", &[0.0, f32::INFINITY, 0.0, 0.0, 0.0, 0.0]);
    model.attribute("TEXCOORD_0", uvs);
    let scene = model.scene();
    assert_eq!(scene.meshes[0].normals, [Vec3::Z, Vec3::Z, Vec3::X]);
    assert_mentions(&scene.notices[0], &["2 vertices repaired"]);
}

#[test]
fn given_tangents_are_made_orthogonal() {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    model.attribute("NORMAL", normals);
    let tangents = model.floats("VEC4", &[1.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 2.0, 0.0, 0.0]);
    model.attribute("TANGENT", tangents);
    let tangents = model.scene().meshes[0].tangents.clone();
    assert!(tangents[0].distance(Vec4::new(1.0, 0.0, 0.0, -1.0)) < 1e-6);
    assert_eq!(tangents[2], Vec4::new(0.0, 1.0, 0.0, 1.0));
}

#[test]
fn indices_out_of_range_name_the_primitive() {
    let mut model = Model::triangle();
    model.0["meshes"][0]["name"] = "roof".into();
    model.indices(&[0, 1, 3]);
    assert_mentions(&model.problem(), &["mesh 0 'roof' primitive 0", "index 3", "3 vertices"]);
}

#[test]
fn absurd_counts_are_refused_at_once() {
    for count in [4_u64, 1 << 31, 1 << 62, u64::MAX] {
        let mut model = Model::triangle();
        model.0["accessors"][0]["count"] = count.into();
        assert_mentions(&model.problem(), &["accessor 0"]);
        // Without a buffer view there is nothing to compare with; zeros make no picture anyway.
        model.0["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        if count > 4 {
            assert_mentions(&model.problem(), &["accessor 0", "without a buffer view"]);
        }
    }
    for key in ["byteOffset", "byteLength"] {
        let mut model = Model::triangle();
        model.0["bufferViews"][0][key] = u64::MAX.into();
        assert_mentions(&model.problem(), &["buffer view 0"]);
    }
}

#[test]
fn damaged_references_are_named() {
    type Damage = (&'static str, fn(&mut Value), &'static [&'static str]);
    let damage: [Damage; 5] = [
        ("mesh", |m| m["nodes"][0]["mesh"] = 7.into(), &["node 0", "mesh 7", "has 1"]),
        ("accessor", |m| m["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9.into(), &["accessor 9"]),
        ("view", |m| m["accessors"][0]["bufferView"] = 5.into(), &["accessor 0", "no buffer view 5"]),
        ("buffer", |m| m["bufferViews"][0]["buffer"] = 5.into(), &["accessor 0", "no buffer 5"]),
        ("material", |m| m["meshes"][0]["primitives"][0]["material"] = 2.into(), &["mesh 0 primitive 0", "material 2"]),
    ];
    for (name, damage, words) in damage {
        let mut model = Model::triangle();
        damage(&mut model.0);
        let message = model.problem();
        assert!(words.iter().all(|word| message.contains(word)), "{name}: {message}");
    }
}

#[test]
fn short_and_missing_buffers_are_errors() {
    let mut model = Model::triangle();
    model.0["buffers"][0]["byteLength"] = 37.into();
    assert_mentions(&model.problem(), &["buffer 0", "36 bytes instead of 37"]);
    model.0["buffers"][0]["uri"] = "no such file.bin".into();
    assert_mentions(&model.problem(), &["no such file.bin"]);
}

// ---- Nodes ----

#[test]
fn transforms_multiply_down_the_tree() {
    let mut model = Model::triangle();
    model.0["nodes"] = json!([
        { "children": [1], "translation": [1, 2, 3], "scale": [2, 2, -2] },
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1] },
    ]);
    let scene = model.scene();
    let expected = Mat4::from_translation(Vec3::new(1.0, 2.0, 1.0)) * Mat4::from_scale(Vec3::new(2.0, 2.0, -2.0));
    assert_eq!(scene.instances[0].world_from_mesh, expected);
    assert_eq!(scene.instances[0].object, 1);
}

#[test]
fn meshes_are_shared_by_nodes() {
    let mut model = Model::triangle();
    model.0["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "scale": [2, 2, 2] }]);
    let scene = model.scene();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    assert_eq!([scene.instances[0].object, scene.instances[1].object], [1, 2]);
}

#[test]
fn scenes_are_chosen() {
    let mut model = Model::triangle();
    model.0["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [5, 0, 0] }]);
    model.0["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }, { "nodes": [] }]);
    let x = |scene: Scene| scene.instances[0].world_from_mesh.w_axis.x;
    assert_eq!(x(model.scene()), 0.0, "the first, if none is the default");
    assert_eq!(x(model.load_scene(Some(1)).unwrap()), 5.0);
    model.0["scene"] = 1.into();
    assert_eq!(x(model.scene()), 5.0);
    assert!(model.load_scene(Some(2)).unwrap().instances.is_empty());
    assert!(matches!(model.load_scene(Some(3)), Err(Problem::NoSuchScene { index: 3, count: 3 })));
}

#[test]
fn nodes_must_form_trees() {
    for nodes in [
        json!([{ "children": [0] }]),
        json!([{ "children": [1] }, { "children": [0] }]),
        json!([{ "children": [2] }, { "children": [2] }, { "mesh": 0 }]),
        json!([{ "children": [1, 1] }, { "mesh": 0 }]),
        json!([{ "children": [1] }, { "children": [2] }, { "children": [1] }]),
    ] {
        let mut model = Model::triangle();
        model.0["nodes"] = nodes;
        assert_mentions(&model.problem(), &["node", "reached twice"]);
    }
}

#[test]
fn deep_hierarchies_do_not_overflow_the_stack() {
    let depth = 200_000;
    let mut nodes: Vec<Value> = (1..depth).map(|child| json!({ "children": [child] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    let mut model = Model::triangle();
    model.0["nodes"] = nodes.into();
    assert_eq!(model.scene().instances.len(), 1);
}

#[test]
fn impossible_transforms_name_the_node() {
    for node in [
        json!({ "mesh": 0, "name": "wing", "scale": [1e31, 1, 1] }),
        json!({ "mesh": 0, "name": "wing", "translation": [1e39, 0, 0] }),
        json!({ "name": "body", "scale": [1e20, 1e20, 1e20], "children": [1] }),
    ] {
        let mut model = Model::triangle();
        model.0["nodes"] = json!([node, { "name": "wing", "scale": [1e20, 1, 1] }]);
        assert_mentions(&model.problem(), &["'wing'", "transform"]);
    }
}

#[test]
fn gpu_instancing_makes_copies() {
    let mut model = Model::triangle();
    let translations = model.floats("VEC3", &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    model.0["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translations } } });
    model.0["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = model.scene();
    let xs: Vec<f32> = scene.instances.iter().map(|i| i.world_from_mesh.w_axis.x).collect();
    assert_eq!((xs, scene.meshes.len()), (vec![1.0, 2.0], 1));
}

#[test]
fn hidden_nodes_hide_all_below_them_but_cameras() {
    let hidden = |visible: bool| json!({ "KHR_node_visibility": { "visible": visible } });
    let light = json!({ "KHR_lights_punctual": { "light": 0 }, "KHR_node_visibility": { "visible": false } });
    let mut model = Model::triangle();
    model.0["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 3 }] } });
    model.0["extensionsRequired"] = json!(["KHR_node_visibility"]);
    model.0["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.25 } }]);
    model.0["nodes"] = json!([
        { "mesh": 0 },
        { "mesh": 0, "extensions": hidden(false), "children": [2, 3] },
        { "mesh": 0, "extensions": hidden(true) },
        { "camera": 0 },
        { "extensions": light },
        { "mesh": 0, "extensions": hidden(true) },
        { "mesh": 0, "extensions": { "KHR_node_visibility": {} } },
    ]);
    let scene = model.scene();
    assert_eq!((scene.instances.len(), scene.cameras.len()), (3, 1));
    assert!(scene.sun.is_some(), "no light of the file's own is left, so the default ones shine");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
}

/// glTF 2.0, "extras": any JSON. An animation's channel may lack its node.
#[test]
fn what_is_not_drawn_may_be_of_any_form() {
    for extras in [json!("rev 3"), json!(7), json!([1, { "a": null }]), json!(null), json!({ "extras": [] })] {
        let mut model = Model::triangle();
        model.0["materials"] = json!([{ "extras": extras, "pbrMetallicRoughness": { "extras": extras } }]);
        model.primitive()["material"] = 0.into();
        model.primitive()["extras"] = extras.clone();
        for place in ["asset", "nodes", "meshes", "accessors", "buffers", "bufferViews"] {
            let place = &mut model.0[place];
            let object = if place.is_array() { &mut place[0] } else { place };
            object["extras"] = extras.clone();
        }
        model.0["extras"] = extras;
        model.0["animations"] = json!([
            { "channels": [{ "sampler": 0, "target": { "path": "scale" } }], "samplers": [{ "input": 0, "output": 0 }] },
            { "channels": [{ "target": { "path": "pointer", "extensions": {} } }] },
        ]);
        let scene = model.scene();
        assert_eq!(scene.instances.len(), 1);
        assert_eq!(scene.notices, ["2 animations ignored"]);
    }
}

/// The model's triangle under a skin of two joints, which are nodes 1 and 2. Node 0 has a transform that must not count.
fn skinned(joints: [&[u8; 4]; 3], weights: &[f32; 12]) -> Model {
    let mut model = Model::triangle();
    let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    model.attribute("NORMAL", normals);
    let joints = model.accessor("VEC4", 5121, 3, joints.map(|j| &j[..]).concat().as_slice());
    model.attribute("JOINTS_0", joints);
    let weights = model.floats("VEC4", weights);
    model.attribute("WEIGHTS_0", weights);
    model.0["nodes"] = json!([
        { "mesh": 0, "skin": 0, "name": "body", "translation": [50, 60, 70], "scale": [0.01, 0, 3] },
        { "translation": [10, 0, 0] },
        { "translation": [0, 20, 0], "children": [3] },
        { "rotation": [0, (FRAC_PI_2 / 2.0).sin(), 0, (FRAC_PI_2 / 2.0).cos()] },
    ]);
    model.0["skins"] = json!([{ "joints": [1, 3] }]);
    model
}

/// The first instance's vertices in the world: positions and normals.
fn in_world(scene: &Scene) -> Vec<(Vec3, Vec3)> {
    let (instance, mesh) = (scene.instances[0], &scene.meshes[scene.instances[0].mesh]);
    let normal_matrix = glam::Mat3::from_mat4(instance.world_from_mesh).inverse().transpose();
    let placed =
        |(&p, &n): (&Vec3, &Vec3)| (instance.world_from_mesh.transform_point3(p), (normal_matrix * n).normalize());
    mesh.positions.iter().zip(&mesh.normals).map(placed).collect()
}

#[track_caller]
fn assert_placed(scene: &Scene, right: &[([f32; 3], Vec3)]) {
    let found = in_world(scene);
    assert_eq!(found.len(), right.len());
    for ((position, normal), &(at, along)) in found.into_iter().zip(right) {
        let close = position.distance(at.into()) < 1e-5 && normal.distance(along) < 1e-5;
        assert!(close, "{position} along {normal}, not {at:?} along {along}");
    }
}

#[test]
fn joints_place_a_skinned_mesh_and_its_node_does_not() {
    let all_on_first = [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap();
    let model = skinned([&[0; 4]; 3], &all_on_first);
    let scene = model.scene();
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert_placed(&scene, &[([10.0, 0.0, 0.0], Vec3::Z), ([11.0, 0.0, 0.0], Vec3::Z), ([10.0, 1.0, 0.0], Vec3::Z)]);

    // The second joint turns x to −z, and z, the normal, to x.
    let all_on_second = skinned([&[1, 9, 9, 9]; 3], &all_on_first).scene();
    assert_placed(
        &all_on_second,
        &[([0.0, 20.0, 0.0], Vec3::X), ([0.0, 20.0, -1.0], Vec3::X), ([0.0, 21.0, 0.0], Vec3::X)],
    );
}

#[test]
fn joints_are_blended_by_weight() {
    // A half each; weights that do not add up to 1; none at all, which leaves the first joint.
    let weights = [0.5, 0.5, 0.0, 0.0, 3.0, 1.0, 0.0, 0.0, 0.0, -1.0, f32::NAN, 0.0];
    let scene = skinned([&[0, 1, 0, 0]; 3], &weights).scene();
    let found = in_world(&scene);
    assert!(found[0].0.distance(Vec3::new(5.0, 10.0, 0.0)) < 1e-5, "{}", found[0].0);
    assert!(found[0].1.distance(Vec3::new(1.0, 0.0, 1.0).normalize()) < 1e-5, "{}", found[0].1);
    assert!(found[1].0.distance(Vec3::new(8.25, 5.0, -0.25)) < 1e-5, "{}", found[1].0);
    assert!(found[2].0.distance(Vec3::new(10.0, 1.0, 0.0)) < 1e-5, "{}", found[2].0);

    // More than four joints stand in further sets, and weights may be integers.
    let mut model = skinned([&[0; 4]; 3], &[1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    for (component, bytes) in [(5121, [255, 0, 0, 0].repeat(3)), (5123, [255, 255, 0, 0, 0, 0, 0, 0].repeat(3))] {
        let joints = model.accessor("VEC4", 5123, 3, &[1, 0, 0, 0, 0, 0, 0, 0].repeat(3));
        let weights = model.accessor("VEC4", component, 3, &bytes);
        model.0["accessors"][weights]["normalized"] = true.into();
        model.attribute("JOINTS_1", joints);
        model.attribute("WEIGHTS_1", weights);
        assert!(in_world(&model.scene())[0].0.distance(Vec3::new(5.0, 10.0, 0.0)) < 1e-5);
    }
}

#[test]
fn inverse_bind_matrices_come_before_the_joints() {
    let mut model = skinned([&[1, 0, 0, 0]; 3], &[1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    let matrices =
        [Mat4::IDENTITY, Mat4::from_scale_rotation_translation(Vec3::new(-2.0, 2.0, 2.0), Quat::IDENTITY, Vec3::X)];
    let bytes: Vec<u8> = matrices.iter().flat_map(|m| m.to_cols_array()).flat_map(f32::to_le_bytes).collect();
    model.0["skins"][0]["inverseBindMatrices"] = model.accessor("MAT4", 5126, 2, &bytes).into();
    let tangents = model.floats("VEC4", &[1.0, 0.0, 0.0, 1.0].repeat(3));
    model.attribute("TANGENT", tangents);
    let scene = model.scene();
    // What mirrors turns the winding round, so that fronts stay fronts.
    assert_placed(&scene, &[([0.0, 20.0, -1.0], Vec3::X), ([0.0, 22.0, -1.0], Vec3::X), ([0.0, 20.0, 1.0], Vec3::X)]);
    assert!(scene.meshes[0].tangents.iter().all(|t| t.distance(Vec4::new(0.0, 0.0, 1.0, -1.0)) < 1e-5));

    model.0["skins"][0]["joints"] = json!([1, 3, 2]);
    assert_mentions(&model.problem(), &["skin 0", "3 joints"]);
}

#[test]
fn far_from_the_origin_skins_keep_their_digits() {
    let mut model = skinned([&[0; 4]; 3], &[1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    model.0["nodes"][1]["translation"] = json!([4e6, 0, 0]);
    let mesh = &model.scene().meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn damaged_skins_name_what_is_wrong() {
    let weights = [0.5, 0.5, 0.0, 0.0].repeat(3).try_into().unwrap();
    let mut model = skinned([&[0; 4], &[0, 2, 0, 0], &[0; 4]], &weights);
    assert_mentions(&model.problem(), &["mesh 0 primitive 0", "vertex 1", "joint 2", "skin 0 has 2"]);
    model.0["skins"][0]["joints"] = json!([1, 3, 4]);
    assert_mentions(&model.problem(), &["skin 0 refers to node 4"]);
    model.0["nodes"][0]["skin"] = 1.into();
    assert_mentions(&model.problem(), &["'body' refers to skin 1"]);
    model.0["nodes"][0]["skin"] = 0.into();
    let floats = model.floats("VEC4", &[0.0; 12]);
    model.0["skins"][0]["joints"] = json!([1, 3]);
    model.attribute("JOINTS_0", floats);
    assert_mentions(&model.problem(), &["mesh 0 primitive 0", "no joints"]);
    let short = model.accessor("VEC4", 5121, 1, &[0; 4]);
    model.attribute("JOINTS_0", short);
    assert_mentions(&model.problem(), &["mesh 0 primitive 0", "3 vertices"]);
    model.primitive()["attributes"].as_object_mut().unwrap().remove("JOINTS_0");
    model.0["nodes"][0]["scale"] = json!([1, 1, 1]);
    let scene = model.scene();
    assert_mentions(&scene.notices[0], &["'body'", "no joints"]);
    assert_eq!(scene.instances[0].world_from_mesh.w_axis, Vec4::new(50.0, 60.0, 70.0, 1.0));
}

#[test]
fn what_no_surface_is_left_of_is_counted() {
    let mut model = Model::triangle();
    let mut nodes = vec![json!({ "mesh": 0 }), json!({ "mesh": 0, "scale": [2, 3, 0] })];
    nodes.extend((0..1000).map(|i| json!({ "mesh": 0, "name": format!("hidden{i}"), "scale": [0, 0, i % 2] })));
    model.0["nodes"] = nodes.into();
    let scene = model.scene();
    assert_eq!(scene.instances.len(), 2, "flat things are seen");
    assert_eq!(scene.notices, ["node 2 'hidden0' and 999 more not drawn, the scale leaves a line or a point"]);
    assert_placed(
        &Scene { instances: vec![scene.instances[1]], ..scene },
        &[([0.0; 3], Vec3::Z), ([2.0, 0.0, 0.0], Vec3::Z), ([0.0, 3.0, 0.0], Vec3::Z)],
    );
}

#[test]
fn instances_have_moderate_matrices_at_any_scale() {
    let mut model = Model::triangle();
    model.0["nodes"] = json!([
        { "mesh": 0, "scale": [1e-12, 1e-12, 1e-12] },
        { "mesh": 0, "scale": [1e15, -1e15, 1e15] },
        { "mesh": 0, "scale": [1e15, 1, 1e-12] },
        { "mesh": 0, "scale": [2e-12, 2e-12, 2e-12] },
        { "mesh": 0 },
    ]);
    let scene = model.scene();
    assert_eq!(scene.meshes.len(), 4, "nodes of like scale share a mesh");
    for (instance, right) in scene.instances.iter().zip([1e-12, 1e15, 1e15, 2e-12, 1.0]) {
        let x = scene.meshes[instance.mesh].positions[1].x * instance.world_from_mesh.x_axis.x;
        assert!((x / right - 1.0).abs() < 1e-6, "{x}, not {right}");
        let greatest = instance.world_from_mesh.x_axis.x;
        assert!((1e-5..1e5).contains(&greatest), "{greatest}");
    }
}

// ---- Cameras and lights ----

#[test]
fn cameras_stand_in_the_world() {
    let turn = Quat::from_rotation_y(FRAC_PI_2);
    let mut model = Model::triangle();
    model.0["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.25 } },
        { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 100 } },
        { "type": "perspective", "perspective": { "yfov": 0.0, "znear": 0.25 } },
        { "type": "orthographic", "orthographic": { "xmag": 3, "ymag": 2.25, "znear": 0, "zfar": 1e6 } },
        { "type": "orthographic", "orthographic": { "xmag": 3e4, "ymag": 3e4, "znear": 0, "zfar": 1 } },
        // Half of such a far plane is 0 in f32.
        { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 1e-45 } },
    ]);
    model.0["nodes"] = json!([
        { "camera": 0, "translation": [1, 2, 3], "rotation": turn.to_array() }, { "camera": 1 }, { "camera": 2 },
        { "camera": 3 }, { "camera": 4 }, { "camera": 5 },
    ]);
    let scene = model.scene();
    assert_eq!(scene.cameras.len(), 4);
    assert!(scene.cameras[2].near < 0.01, "a far plane of 1e6 takes nothing away");
    assert!(scene.cameras[3].near < 1.0);
    let camera = scene.default_camera();
    assert_eq!((camera.eye, camera.near), (Vec3::new(1.0, 2.0, 3.0), 0.25));
    assert!((camera.target - camera.eye).normalize().distance(Vec3::NEG_X) < 1e-6);
    assert_eq!(camera.lens, Lens::Perspective { fov_y: 0.7 });
    assert_eq!(scene.cameras[1].lens, Lens::Orthographic { half_height: 3.0, far: 100.0 });
    assert!(scene.cameras[1].near > 0.0);
    assert_mentions(&scene.notices[0], &["node 2", "camera 2"]);
    assert_mentions(&scene.notices[1], &["node 5", "camera 5"]);
    scene.validate().expect("a sound scene");
}

#[test]
fn lights_stand_in_the_world() {
    let down = Quat::from_rotation_x(-FRAC_PI_2);
    let mut model = Model::triangle();
    model.0["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 2, "color": [1, 0.5, 0] },
        { "type": "point", "intensity": 3, "range": 4 },
        { "type": "spot", "spot": { "innerConeAngle": 2.0, "outerConeAngle": 9.0 } },
        { "type": "directional" },
        { "type": "point", "intensity": -1 },
    ] } });
    let node = |light: usize| json!({ "translation": [1, 2, 3], "rotation": down.to_array(), "extensions": { "KHR_lights_punctual": { "light": light } } });
    model.0["nodes"] = json!([node(0), node(1), node(2), node(3), node(4), { "mesh": 0 }]);
    let scene = model.scene();
    let sun = scene.sun.unwrap();
    assert!(sun.to_sun.distance(Vec3::Y) < 1e-6);
    assert_eq!(sun.irradiance, Vec3::new(2.0, 1.0, 0.0), "left as it is");
    let [point, spot, directional] = scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert_eq!((point.kind, point.position, point.range), (LightKind::Point, Vec3::new(1.0, 2.0, 3.0), 4.0));
    assert!(matches!(spot.kind, LightKind::Spot { inner, outer } if inner < outer && outer <= FRAC_PI_2));
    assert_eq!(directional.kind, LightKind::Directional);
    assert_mentions(&scene.notices[0], &["node 4", "light 4"]);
}

#[test]
fn glaring_lights_are_scaled_together() {
    let mut model = Model::triangle();
    model.0["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 100_000 }, { "type": "directional", "intensity": 10_000 },
    ] } });
    model.0["nodes"] = json!([
        { "mesh": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "extensions": { "KHR_lights_punctual": { "light": 1 } } },
    ]);
    let scene = model.scene();
    let (sun, other) = (scene.sun.unwrap().irradiance.x, scene.lights[0].intensity.x);
    assert!((sun + other - std::f32::consts::PI).abs() < 1e-4);
    assert!((sun / other - 10.0).abs() < 1e-4);
    assert_mentions(&scene.notices[0], &["lights scaled"]);
}

/// What would make them bright is no number.
#[test]
fn lights_that_are_all_but_dark_stay_as_they_are() {
    let lights = |least: f64| {
        let mut model = Model::triangle();
        model.0["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "directional", "intensity": least }, { "type": "point", "intensity": 300 },
        ] } });
        model.0["nodes"] = json!([
            { "mesh": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "translation": [3e19, 0, 0], "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        ]);
        model.scene()
    };
    for least in [1e-45, 1e-40, 1e-38, 1e-30] {
        assert_eq!(lights(least).validate(), Ok(()), "{least}");
    }
}

// ---- Materials ----

#[test]
fn material_factors() {
    let mut model = Model::triangle();
    model.material(json!({
        "name": "paint",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 2.0, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": -1 },
        "emissiveFactor": [1, 10, 0],
        "doubleSided": true,
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 3 }, "KHR_materials_unlit": {} },
    }));
    let scene = model.scene();
    let material = &scene.materials[0];
    assert_eq!(material.base_color, Vec4::new(0.1, 1.0, 0.3, 0.4));
    assert_eq!((material.metallic, material.roughness), (0.5, 0.0));
    assert_eq!(material.emissive, Vec3::new(3.0, 30.0, 0.0));
    assert!(material.double_sided && material.unlit && material.alpha_cutoff.is_none());
    assert_mentions(&scene.notices.join("\n"), &["material 0 'paint': base colour factor 2", "roughness factor -1"]);
}

#[test]
fn alpha_modes() {
    let glass = json!({ "KHR_materials_transmission": { "transmissionFactor": 0.5 } });
    for (material, cutoff, blended, notices) in [
        (json!({ "alphaMode": "OPAQUE", "alphaCutoff": 0.3 }), None, false, 0),
        (json!({ "alphaMode": "MASK" }), Some(0.5), false, 0),
        (json!({ "alphaMode": "MASK", "alphaCutoff": 0.3 }), Some(0.3), false, 0),
        (json!({ "alphaMode": "BLEND", "alphaCutoff": 0.3 }), None, true, 0),
        (json!({ "alphaMode": "BLEND", "extensions": glass }), Some(0.5), false, 1),
    ] {
        let mut model = Model::triangle();
        model.material(material.clone());
        let scene = model.scene();
        assert_eq!((scene.materials[0].alpha_cutoff, scene.materials[0].blended), (cutoff, blended), "{material}");
        assert_eq!(scene.notices.len(), notices, "{material}");
    }
}

#[test]
fn textures_are_shared_and_decoded_once() {
    let mut model = Model::triangle();
    model.texture();
    let again = model.0["images"][0].clone();
    model.push("images", again);
    model.push("textures", json!({ "source": 1 }));
    model.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "emissiveTexture": { "index": 1 },
    }));
    let scene = model.scene();
    assert_eq!((scene.images.len(), scene.textures.len()), (1, 2), "one picture, as colour and as data");
    assert_eq!(scene.images[0].rgba[..], [255, 0, 0, 255]);
    let material = &scene.materials[0];
    assert_eq!(material.base_color_texture, material.emissive_texture);
}

#[test]
fn samplers() {
    let mut model = Model::triangle();
    model.texture();
    model.0["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9984 }]);
    model.0["textures"][0]["sampler"] = 0.into();
    model.material(json!({ "emissiveTexture": { "index": 0 } }));
    let texture = model.scene().textures[0];
    assert_eq!((texture.wrap_u, texture.wrap_v), (Wrap::Clamp, Wrap::Mirror));
    for (magnified, mag) in [(true, Some(9728)), (false, Some(9729)), (false, None)] {
        for (minified, min) in
            [(true, Some(9728)), (true, Some(9986)), (false, Some(9729)), (false, Some(9987)), (false, None)]
        {
            model.0["samplers"][0] = json!({ "magFilter": mag, "minFilter": min });
            assert_eq!(model.scene().textures[0].nearest, Nearest { magnified, minified }, "{mag:?}, {min:?}");
        }
    }
}

#[test]
fn texture_transforms() {
    let mut model = Model::triangle();
    model.texture();
    let uvs = model.floats("VEC2", &[7.0; 6]);
    model.attribute("TEXCOORD_3", uvs);
    let transform = json!({ "KHR_texture_transform": {
        "offset": [0.5, 0.25], "rotation": FRAC_PI_2, "scale": [2, 3], "texCoord": 3,
    } });
    for material in [
        json!({ "emissiveTexture": { "index": 0, "texCoord": 1, "extensions": transform } }),
        json!({ "normalTexture": { "index": 0, "texCoord": 1, "extensions": transform } }),
    ] {
        model.material(material);
        let scene = model.scene();
        assert_eq!(scene.meshes[0].uvs, [Vec2::splat(7.0); 3], "the extension chooses the coordinates");
        let (TextureRef { u_row, v_row, .. }, _) = scene.materials[0].texture_refs().next().unwrap();
        assert!(u_row.distance(Vec3::new(0.0, 3.0, 0.5)) < 1e-6, "{u_row}");
        assert!(v_row.distance(Vec3::new(-2.0, 0.0, 0.25)) < 1e-6, "{v_row}");
    }
}

/// What each map of a mesh's material reads at each vertex.
fn read_uvs(scene: &Scene, mesh: usize) -> Vec<Vec<Vec2>> {
    let mesh = &scene.meshes[mesh];
    let read = |map: &TextureRef| {
        let at = |uv: &Vec2| Vec2::new(map.u_row.dot(uv.extend(1.0)), map.v_row.dot(uv.extend(1.0)));
        mesh.uvs.iter().map(at).collect()
    };
    scene.materials[mesh.material].texture_refs().map(|(map, _)| read(map)).collect()
}

fn assert_uvs(found: &[Vec2], right: &[[f32; 2]]) {
    assert_eq!(found.len(), right.len());
    for (found, &right) in found.iter().zip(right) {
        assert!(found.distance(right.into()) < 1e-4, "{found}, not {right:?}");
    }
}

#[test]
fn coordinates_too_large_for_a_transform_leave_their_map_out() {
    let mut model = Model::triangle();
    model.texture();
    for (name, uvs) in
        [("TEXCOORD_0", [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]), ("TEXCOORD_1", [0.0, 0.0, 3e38, 0.0, 0.0, 3e38])]
    {
        let accessor = model.floats("VEC2", &uvs);
        model.attribute(name, accessor);
    }
    let scaled = json!({ "KHR_texture_transform": { "scale": [3, 3], "texCoord": 1 } });
    model.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "emissiveTexture": { "index": 0, "extensions": scaled },
    }));
    let scene = model.scene();
    assert_eq!(scene.validate(), Ok(()));
    let material = &scene.materials[scene.meshes[0].material];
    assert!(material.base_color_texture.is_some() && material.emissive_texture.is_none());
}

#[test]
fn each_map_reads_its_own_set() {
    let first = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [4.0, 4.0]];
    // Turned, and clear of the first.
    let second = [[0.5, 0.25], [0.5, 0.75], [0.25, 0.25], [0.25, 0.75]];
    for (base, other) in [(0, 1), (1, 0)] {
        let mut model = Model::square();
        model.texture();
        model.indices(&[0, 1, 3, 0, 3, 2]);
        let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
        model.attribute("NORMAL", normals);
        for (name, uvs) in [("TEXCOORD_0", first), ("TEXCOORD_1", second)] {
            let accessor = model.floats("VEC2", uvs.as_flattened());
            model.attribute(name, accessor);
        }
        let moved = json!({ "KHR_texture_transform": { "offset": [1, 2], "scale": [3, 3], "texCoord": other } });
        model.material(json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": base } },
            "occlusionTexture": { "index": 0, "texCoord": other },
            "emissiveTexture": { "index": 0, "texCoord": 7, "extensions": moved },
        }));
        let scene = model.scene();
        assert_eq!((scene.meshes.len(), scene.notices.len()), (1, 0), "{:?}", scene.notices);
        let order = [0, 1, 3, 2];
        let [base, other] = [base, other].map(|set| order.map(|i| [first, second][set][i]));
        let read = read_uvs(&scene, 0);
        assert_uvs(&read[0], &base);
        assert_uvs(&read[1], &other);
        assert_uvs(&read[2], &other.map(|[u, v]| [3.0 * u + 1.0, 3.0 * v + 2.0]));
    }
}

/// A box's faces, for one, lie in a light map as the unwrapping found room for them.
#[test]
fn a_mesh_falls_into_pieces_where_one_set_does_not_follow_from_another() {
    let mut model = Model::square();
    model.texture();
    model.indices(&[0, 1, 2, 1, 3, 2]);
    let first = model.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    model.attribute("TEXCOORD_0", first);
    let bent = model.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.2, 0.3]);
    model.attribute("TEXCOORD_1", bent);
    model.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "normalTexture": { "index": 0, "texCoord": 1 },
    }));
    let scene = model.scene();
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.notices.len()), (2, 2, 0));
    assert_eq!(scene.instances[0].object, scene.instances[1].object);
    let read = [0, 1].map(|mesh| read_uvs(&scene, mesh));
    assert_uvs(&read[0][1], &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_uvs(&read[1][0], &[[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_uvs(&read[1][1], &[[1.0, 0.0], [0.2, 0.3], [0.0, 1.0]]);

    // A set that is the same everywhere tells nothing of the other.
    let point = model.floats("VEC2", &[0.5; 8]);
    model.attribute("TEXCOORD_0", point);
    let scene = model.scene();
    assert_eq!((scene.meshes.len(), scene.notices.len()), (1, 0));
    let read = read_uvs(&scene, 0);
    assert_uvs(&read[0], &[[0.5; 2]; 6]);
    assert_uvs(&read[1], &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.2, 0.3], [0.0, 1.0]]);
}

#[test]
fn a_map_whose_set_would_take_too_many_pieces_is_named() {
    let mut model = Model::triangle();
    model.texture();
    let triangles = 300;
    let positions = model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].repeat(triangles));
    model.attribute("POSITION", positions);
    let first = model.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0].repeat(triangles));
    model.attribute("TEXCOORD_0", first);
    let scattered: Vec<f32> = (0..triangles).flat_map(|i| [i as f32, 0.0, 1.0, i as f32, 0.0, 1.0]).collect();
    let second = model.floats("VEC2", &scattered);
    model.attribute("TEXCOORD_1", second);
    model.material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        "occlusionTexture": { "index": 0, "texCoord": 1 },
    }));
    let scene = model.scene();
    let material = &scene.materials[scene.meshes[0].material];
    assert!(material.base_color_texture.is_some() && material.occlusion_texture.is_none());
    assert_mentions(&scene.notices[0], &["mesh 0", "occlusion", "TEXCOORD_1", "TEXCOORD_0"]);
}

#[test]
fn normal_maps_get_tangents() {
    let mut model = Model::square();
    model.texture();
    model.indices(&[0, 1, 2, 1, 3, 2]);
    let normals = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    model.attribute("NORMAL", normals);
    // u goes up, v to the right.
    let uvs = model.floats("VEC2", &[0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0]);
    model.attribute("TEXCOORD_0", uvs);
    model.material(json!({ "normalTexture": { "index": 0 } }));
    assert_eq!(model.scene().meshes[0].tangents, [Vec4::new(0.0, 1.0, 0.0, 1.0); 4]);
}

#[test]
fn pictures_matter_only_where_they_are_used() {
    let mut model = Model::triangle();
    model.texture();
    let broken = model.bytes(b"\x89PNG\r\n\x1a\nand then nothing");
    for (image, words) in [
        (json!({ "uri": "lost.png", "name": "sky" }), ["lost.png", "cannot read"]),
        (json!({ "bufferView": broken, "name": "sky" }), ["image 0 'sky'", "PNG or JPEG"]),
        (json!({ "name": "sky" }), ["image 0 'sky'", "neither"]),
        (json!({ "bufferView": 0, "name": "sky" }), ["image 0 'sky'", "format"]),
    ] {
        model.0["images"] = json!([image]);
        model.material(json!({}));
        assert!(model.scene().images.is_empty());
        model.material(json!({ "emissiveTexture": { "index": 0 } }));
        assert_mentions(&model.problem(), &words);
    }
    // A picture that only an extension knows how to find.
    model.0["textures"] = json!([{ "extensions": { "EXT_texture_webp": { "source": 0 } } }]);
    assert_mentions(&model.scene().notices[0], &["material 0", "emissive texture ignored"]);
}

// ---- The file ----

#[test]
fn pictures_that_are_cut_short_are_shown_and_named() {
    let picture = image::RgbImage::from_fn(32, 64, |x, y| image::Rgb([255, (x * 37 + y * 91) as u8, (x * y) as u8]));
    for format in [image::ImageFormat::Jpeg, image::ImageFormat::Png] {
        let mut file = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut file, format).unwrap();
        let file = file.into_inner();
        let load = |length: usize| {
            let mut model = Model::triangle();
            let view = model.bytes(&file[..length]);
            model.0["images"] = json!([{ "bufferView": view, "name": "bark" }]);
            model.0["textures"] = json!([{ "source": 0 }]);
            model.material(json!({ "emissiveTexture": { "index": 0 } }));
            model.scene()
        };
        let whole = load(file.len());
        assert!(whole.notices.is_empty(), "{:?}", whole.notices);
        let part = load(file.len() * 3 / 4);
        assert_eq!(part.notices.len(), 1);
        assert_mentions(&part.notices[0], &["image 0 'bark'", "cut short"]);
        let rows = |scene: &Scene, rows: std::ops::Range<usize>| {
            scene.images[0].rgba[rows.start * 128..rows.end * 128].to_vec()
        };
        assert_eq!(rows(&part, 0..16), rows(&whole, 0..16), "{format:?}: what there is of it");
        assert_ne!(rows(&part, 56..64), rows(&whole, 56..64), "{format:?}");
    }
}

/// The head of a PNG of 2 GiB, and nothing else.
#[test]
fn a_cut_picture_that_claims_to_be_huge_is_refused() {
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        let named = [kind, data].concat();
        let shifted = |crc: u32| (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
        let crc = !named.iter().fold(!0u32, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| shifted(crc)));
        [&(data.len() as u32).to_be_bytes()[..], &named, &crc.to_be_bytes()].concat()
    };
    let side = 16384u32.to_be_bytes();
    // 16 bits of red, green, blue and alpha.
    let head = chunk(b"IHDR", &[&side[..], &side, &[16, 6, 0, 0, 0]].concat());
    let file = [b"\x89PNG\r\n\x1a\n", &head[..], &chunk(b"IDAT", &[0x78, 0x9c])].concat();
    let mut model = Model::triangle();
    let view = model.bytes(&file);
    model.0["images"] = json!([{ "bufferView": view, "name": "bark" }]);
    model.0["textures"] = json!([{ "source": 0 }]);
    model.material(json!({ "emissiveTexture": { "index": 0 } }));
    assert_mentions(&model.problem(), &["image 0 'bark'", "emory"]);
}

#[test]
fn required_extensions() {
    let mut model = Model::triangle();
    model.0["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_texture_transform"]);
    assert_eq!(model.scene().notices.len(), 1);
    model.0["extensionsRequired"] = SUPPORTED_EXTENSIONS.into();
    model.scene();
    model.0["extensionsRequired"] = json!(["line\nbreak"]);
    assert_mentions(&model.problem(), &["line break"]);
    model.0["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert_mentions(&model.problem(), &["KHR_draco_mesh_compression"]);
}

#[test]
fn versions() {
    for (asset, good) in [
        (json!({ "version": "2.0" }), true),
        (json!({ "version": "2.1" }), true),
        (json!({ "version": "2.1", "minVersion": "2.0" }), true),
        (json!({ "version": "2.1", "minVersion": "2.1" }), false),
        (json!({ "version": "1.0" }), false),
        (json!({ "version": "" }), false),
    ] {
        let mut model = Model::triangle();
        model.0["asset"] = asset.clone();
        assert_eq!(model.load().is_ok(), good, "{asset}");
    }
}

#[test]
fn what_moves_stands_still() {
    let mut model = Model::triangle();
    model.primitive()["targets"] = json!([{ "POSITION": 0 }]);
    model.0["animations"] = json!([{ "channels": [], "samplers": [] }]);
    assert_eq!(model.scene().notices.len(), 2);
}

#[test]
fn rubbish_is_refused() {
    let nested = "[".repeat(100_000);
    for file in
        ["", "rubbish", "line\nbreak", "[]", "{}", "glTF", "{\"asset\":", &nested, &format!("{{\"asset\":{nested}")]
    {
        let problem = super::parse(file.as_bytes(), Path::new("model.gltf"), None).unwrap_err();
        assert!(!LoadError::new(Path::new("model.gltf"), problem).to_string().contains('\n'));
    }
    assert!(super::load(Path::new("there is no such file.glb"), None).is_err());
}
