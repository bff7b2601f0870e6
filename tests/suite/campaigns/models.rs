//! Small glTF files that together have everything that the loader reads.

use crate::scenes::{png, uri};
use serde_json::{Value, json};

/// A file as its JSON and its binary chunk.
#[derive(Clone)]
pub struct Model {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Model {
    /// A triangle with normals, uv and colours, drawn by node 0. Accessor 0 has the positions.
    fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [],
            "meshes": [{ "primitives": [{ "attributes": {}, "material": 0 }] }],
            "materials": [{ "name": "paint" }],
            "nodes": [{ "mesh": 0 }],
            "scenes": [{ "nodes": [0] }],
        });
        let mut model = Self { json, bin: Vec::new() };
        model.attribute("POSITION", "VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5]);
        model
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.json["buffers"][0]["byteLength"] = self.bin.len().into();
        push(&mut self.json["bufferViews"], json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessor = json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
        push(&mut self.json["accessors"], accessor)
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let size = match kind {
            "SCALAR" => 1,
            "MAT4" => 16,
            _ => usize::from(kind.as_bytes()[3] - b'0'),
        };
        self.accessor(kind, 5126, values.len() / size, bytemuck::cast_slice(values))
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    fn attribute(&mut self, name: &str, kind: &str, values: &[f32]) -> usize {
        let accessor = self.floats(kind, values);
        self.primitive()["attributes"][name] = accessor.into();
        accessor
    }

    /// Adds a texture of 2 × 2 texels; returns its number.
    fn texture(&mut self, inline: bool) -> usize {
        let file = png(2, 2, &[255, 0, 0, 255, 0, 255, 0, 128, 9, 9, 200, 255, 128, 128, 255, 0]);
        let image = if inline {
            json!({ "uri": uri("image/png", &file) })
        } else {
            json!({ "bufferView": self.view(&file), "mimeType": "image/png" })
        };
        for array in ["images", "samplers", "textures"] {
            if self.json[array].is_null() {
                self.json[array] = json!([]);
            }
        }
        let source = push(&mut self.json["images"], image);
        let sampler = json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9984 });
        let sampler = push(&mut self.json["samplers"], sampler);
        push(&mut self.json["textures"], json!({ "source": source, "sampler": sampler }))
    }

    /// The .glb file.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 28 + json.len() + self.bin.len();
        let word = |length: usize| (length as u32).to_le_bytes();
        [
            b"glTF",
            &word(2)[..],
            &word(length),
            &word(json.len()),
            b"JSON",
            &json,
            &word(self.bin.len()),
            b"BIN\0",
            &self.bin,
        ]
        .concat()
    }
}

fn push(array: &mut Value, value: Value) -> usize {
    let array = array.as_array_mut().expect("an array");
    array.push(value);
    array.len() - 1
}

/// All models.
pub fn all() -> Vec<Model> {
    vec![geometry(), strips(), sparse(), materials(), maps(), nodes(), lights(), instances(), moving()]
}

fn geometry() -> Model {
    let mut model = Model::new();
    model.attribute("NORMAL", "VEC3", &[0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    model.attribute("TANGENT", "VEC4", &[1.0, 0.0, 0.0, 1.0].repeat(3));
    model.attribute("TEXCOORD_0", "VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let colors = model.accessor("VEC4", 5121, 3, &[255, 0, 51, 255, 255, 255, 0, 0, 0, 9, 9, 9]);
    model.json["accessors"][colors]["normalized"] = true.into();
    model.primitive()["attributes"]["COLOR_0"] = colors.into();
    let indices = model.accessor("SCALAR", 5123, 3, &[0, 0, 1, 0, 2, 0]);
    model.primitive()["indices"] = indices.into();
    model
}

/// Strips, fans and quantised positions at a stride.
fn strips() -> Model {
    let mut model = Model::new();
    let positions = model.accessor("VEC3", 5120, 4, &[0, 0, 0, 9, 127, 0, 0, 9, 0, 0x80, 0, 9, 1, 2, 3]);
    model.json["accessors"][positions]["normalized"] = true.into();
    let view = model.json["accessors"][positions]["bufferView"].as_u64().expect("a view") as usize;
    model.json["bufferViews"][view]["byteStride"] = 4.into();
    let indices = model.accessor("SCALAR", 5121, 4, &[0, 1, 2, 3]);
    let primitive = |mode: u32| json!({ "attributes": { "POSITION": positions }, "indices": indices, "mode": mode });
    model.json["meshes"][0]["primitives"] = json!([primitive(5), primitive(6), primitive(4), primitive(0)]);
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    model
}

fn sparse() -> Model {
    let mut model = Model::new();
    let values = model.view(bytemuck::cast_slice(&[5.0f32, 6.0, 7.0]));
    let indices = model.view(&[2]);
    let sparse = json!({
        "count": 1, "values": { "bufferView": values },
        "indices": { "bufferView": indices, "componentType": 5121 },
    });
    model.json["accessors"][0]["sparse"] = sparse.clone();
    let implied = json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse });
    let implied = push(&mut model.json["accessors"], implied);
    model.primitive()["attributes"]["NORMAL"] = implied.into();
    model
}

fn materials() -> Model {
    let mut model = Model::new();
    model.json["materials"] = json!([{
        "name": "glass",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.1 },
        "emissiveFactor": [1, 10, 0], "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.3,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 3 }, "KHR_materials_ior": { "ior": 1.4 },
            "KHR_materials_transmission": { "transmissionFactor": 0.5 },
            "KHR_materials_volume": { "thicknessFactor": 0.2, "attenuationDistance": 3, "attenuationColor": [1, 0.5, 0] },
        },
    }, { "alphaMode": "BLEND", "extensions": { "KHR_materials_unlit": {} } }]);
    push(&mut model.json["meshes"][0]["primitives"], json!({ "attributes": { "POSITION": 0 }, "material": 1 }));
    model
}

/// Every texture of a material, inline and in the chunk, transformed.
fn maps() -> Model {
    let mut model = Model::new();
    model.attribute("NORMAL", "VEC3", &[0.0, 0.0, 1.0].repeat(3));
    model.attribute("TEXCOORD_0", "VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    model.attribute("TEXCOORD_1", "VEC2", &[0.5, 0.0, 1.0, 0.0, 0.0, 2.0]);
    let [a, b] = [model.texture(true), model.texture(false)];
    let moved =
        json!({ "KHR_texture_transform": { "offset": [0.5, 0.25], "rotation": 1.6, "scale": [2, 3], "texCoord": 1 } });
    model.json["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": a, "extensions": moved }, "metallicRoughnessTexture": { "index": b },
        },
        "normalTexture": { "index": a, "scale": 0.7, "texCoord": 1 },
        "occlusionTexture": { "index": b, "strength": 0.5 }, "emissiveTexture": { "index": b },
        "extensions": { "KHR_materials_transmission": { "transmissionTexture": { "index": a } } },
    });
    model
}

fn nodes() -> Model {
    let mut model = Model::new();
    model.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.25, "aspectRatio": 1.5, "zfar": 9 } },
        { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 100 } },
    ]);
    model.json["nodes"] = json!([
        { "children": [1, 2], "translation": [1, 2, 3], "scale": [2, 2, -2], "rotation": [0, 0.6, 0, 0.8] },
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1], "children": [3] },
        { "camera": 0, "extensions": { "KHR_node_visibility": { "visible": false } } },
        { "camera": 1, "mesh": 0, "name": "leaf" },
    ]);
    model.json["scene"] = 0.into();
    model
}

fn lights() -> Model {
    let mut model = Model::new();
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 2, "color": [1, 0.5, 0] }, { "type": "point", "intensity": 300, "range": 4 },
        { "type": "spot", "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.9 } },
    ] } });
    let node =
        |light: u32| json!({ "translation": [1, 2, 3], "extensions": { "KHR_lights_punctual": { "light": light } } });
    model.json["nodes"] = json!([{ "mesh": 0 }, node(0), node(1), node(2)]);
    model.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    model.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_materials_clearcoat"]);
    model
}

fn instances() -> Model {
    let mut model = Model::new();
    let translations = model.floats("VEC3", &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let rotations = model.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8]);
    let scales = model.floats("VEC3", &[1.0, 1.0, 1.0, -2.0, 2.0, 2.0]);
    model.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": {
        "TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales,
    } } });
    model
}

/// Skins, morph targets and animations.
fn moving() -> Model {
    let mut model = Model::new();
    model.attribute("WEIGHTS_0", "VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    let joints = model.accessor("VEC4", 5121, 3, &[0; 12]);
    model.primitive()["attributes"]["JOINTS_0"] = joints.into();
    let offsets = model.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    model.primitive()["targets"] = json!([{ "POSITION": offsets, "NORMAL": offsets }, { "POSITION": offsets }]);
    model.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    let bind = model.floats("MAT4", &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    model.json["skins"] = json!([{ "joints": [1], "skeleton": 1, "inverseBindMatrices": bind }]);
    model.json["nodes"] = json!([{ "mesh": 0, "skin": 0, "weights": [1, 0], "children": [1] }, { "name": "bone" }]);
    let times = model.floats("SCALAR", &[0.0, 1.0]);
    let moves = model.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    model.json["animations"] = json!([{
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        "samplers": [{ "input": times, "output": moves, "interpolation": "LINEAR" }],
    }]);
    model
}
