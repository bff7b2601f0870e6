//! Materials and the textures they use. Only what is drawn is converted, so unused damage goes unnoticed.

use std::collections::HashMap;

use glam::{Vec3, Vec4};
use gltf::json;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::AlphaMode;
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};
use serde_json::{Map, Value};

use super::error::Problem;
use super::limits::label;
use crate::scene::{Material, Nearest, Texture, TextureRef, Wrap};

/// Emission beyond this is taken for a mistake; it still leaves room for any lamp.
const MAX_EMISSION: f32 = 1e6;

/// The maps of a material, as notices call them and in the order of [`Material::textures_mut`].
const MAPS: [&str; 5] = ["base colour", "metallic-roughness", "normal", "occlusion", "emissive"];

/// The transforms of a material's maps, as bits.
type Transforms = [Option<[u32; 6]>; 5];

/// Collects the materials that are asked for, and the textures and images that those use.
pub(super) struct MaterialTable<'a> {
    root: &'a Root,
    converted: HashMap<Option<usize>, usize>,
    /// As for the scene.
    pub materials: Vec<Material>,
    /// Which TEXCOORD_n the maps of each material read, in the order of [`MAPS`].
    uv_sets: Vec<[Option<u32>; 5]>,
    /// Materials whose maps are read through other transforms, by what they are made from and those transforms.
    variants: HashMap<(usize, Transforms), usize>,
    /// As for the scene.
    pub textures: Vec<Texture>,
    /// The file's numbers of the images that textures use.
    pub images: Vec<usize>,
    /// What was ignored or repaired.
    pub notices: Vec<String>,
}

/// The three kinds of texture reference in glTF, made alike.
struct Reference {
    texture: Index<json::Texture>,
    uv_set: u32,
    transform: TextureTransform,
}

impl<'a> MaterialTable<'a> {
    pub fn new(root: &'a Root) -> Self {
        Self {
            root,
            converted: HashMap::new(),
            materials: Vec::new(),
            uv_sets: Vec::new(),
            variants: HashMap::new(),
            textures: Vec::new(),
            images: Vec::new(),
            notices: Vec::new(),
        }
    }

    /// The scene's index of a material of the file, or of glTF's default one. `user` is for messages.
    pub fn material(&mut self, index: Option<Index<json::Material>>, user: &str) -> Result<usize, Problem> {
        let key = index.map(|index| index.value());
        if let Some(&known) = self.converted.get(&key) {
            return Ok(known);
        }
        let default;
        let (material, place) = match key {
            Some(number) => {
                let material = self.root.materials.get(number).ok_or_else(|| Problem::Reference {
                    from: user.to_owned(),
                    kind: "material",
                    index: number,
                    count: self.root.materials.len(),
                })?;
                (material, label("material", number, material.name.as_deref()))
            }
            None => {
                default = json::Material::default();
                (&default, "default material".to_owned())
            }
        };
        let (material, uv_sets) = self.convert(material, &place)?;
        self.materials.push(material);
        self.uv_sets.push(uv_sets);
        self.converted.insert(key, self.materials.len() - 1);
        Ok(self.materials.len() - 1)
    }

    /// The sets of texture coordinates that a material reads, without repetition; the base colour's first. Never empty.
    pub fn uv_sets(&self, material: usize) -> Vec<u32> {
        let mut sets = Vec::new();
        for set in self.uv_sets[material].into_iter().flatten() {
            if !sets.contains(&set) {
                sets.push(set);
            }
        }
        if sets.is_empty() { vec![0] } else { sets }
    }

    /// The maps of a material that read a set, by name.
    pub fn maps_on(&self, material: usize, set: u32) -> impl Iterator<Item = &'static str> {
        MAPS.into_iter().zip(self.uv_sets[material]).filter(move |&(_, own)| own == Some(set)).map(|(name, _)| name)
    }

    /// A material like another whose maps take the coordinates of their set from those of one set, by these rows; maps
    /// whose set has none are left out, and those that this leads beyond f32, with a notice.
    pub fn on_one_set(&mut self, material: usize, rows: impl Fn(u32) -> Option<[Vec3; 2]>) -> usize {
        let mut variant = self.materials[material].clone();
        let mut lost = None;
        for ((map, set), name) in variant.textures_mut().into_iter().zip(self.uv_sets[material]).zip(MAPS) {
            *map = map.zip(set).and_then(|(map, set)| rows(set).map(|rows| map.after(rows)));
            if map.is_some_and(|map| !(map.u_row.is_finite() && map.v_row.is_finite())) {
                *map = None;
                lost = Some(name);
            }
        }
        if let Some(map) = lost {
            let notice =
                format!("material '{}': its {map} is left out where its coordinates are too large", variant.name);
            if !self.notices.contains(&notice) {
                self.notice(notice);
            }
        }
        let bits = |map: &mut Option<TextureRef>| {
            map.map(|map| {
                let [a, b, c] = map.u_row.to_array().map(f32::to_bits);
                let [d, e, f] = map.v_row.to_array().map(f32::to_bits);
                [a, b, c, d, e, f]
            })
        };
        let key = |material: &mut Material| material.textures_mut().map(bits);
        let own = key(&mut variant);
        if own == key(&mut self.materials[material]) {
            return material;
        }
        *self.variants.entry((material, own)).or_insert_with(|| {
            self.materials.push(variant);
            self.uv_sets.push([None; 5]);
            self.materials.len() - 1
        })
    }

    fn convert(&mut self, material: &json::Material, place: &str) -> Result<(Material, [Option<u32>; 5]), Problem> {
        let pbr = &material.pbr_metallic_roughness;
        let extensions = material.extensions.as_ref();
        let strength = extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |e| e.emissive_strength.0);

        let normal = material.normal_texture.as_ref();
        let occlusion = material.occlusion_texture.as_ref();
        let base_color = pbr.base_color_texture.as_ref().map(Reference::from);
        let metallic_roughness = pbr.metallic_roughness_texture.as_ref().map(Reference::from);
        let emissive = material.emissive_texture.as_ref().map(Reference::from);
        let normal_map = normal
            .map(|n| Reference::with_transform(n.index, n.tex_coord, n.extensions.as_ref().map(|e| &e.others)))
            .transpose()?;
        let occlusion_map = occlusion
            .map(|o| Reference::with_transform(o.index, o.tex_coord, o.extensions.as_ref().map(|e| &e.others)))
            .transpose()?;

        let all = [&base_color, &metallic_roughness, &normal_map, &occlusion_map, &emissive];
        let uv_sets = all.map(|map| map.as_ref().map(|map| map.uv_set));
        let mut texture = |reference: Option<Reference>, role: &str, srgb| match reference {
            Some(reference) => self.texture(&reference, place, role, srgb),
            None => Ok(None),
        };
        let base_color_texture = texture(base_color, MAPS[0], true)?;
        let metallic_roughness_texture = texture(metallic_roughness, MAPS[1], false)?;
        let normal_texture = texture(normal_map, MAPS[2], false)?;
        let occlusion_texture = texture(occlusion_map, MAPS[3], false)?;
        let emissive_texture = texture(emissive, MAPS[4], true)?;

        let mut clamp = |value: f32, name: &str, least: f32, most: f32, fallback: f32| {
            let clamped = if value.is_finite() { value.clamp(least, most) } else { fallback };
            if clamped != value {
                self.notice(format!("{place}: {name} {value} replaced by {clamped}"));
            }
            clamped
        };
        let base_color = Vec4::from(pbr.base_color_factor.0.map(|c| clamp(c, "base colour factor", 0.0, 1.0, 1.0)));
        let strength = clamp(strength, "emissive strength", 0.0, MAX_EMISSION, 1.0);
        // Files with factors above 1 mean it, though the specification would have them use a strength.
        let emissive =
            Vec3::from(material.emissive_factor.0.map(|c| clamp(c, "emissive factor", 0.0, MAX_EMISSION, 0.0)));
        let cutoff = clamp(material.alpha_cutoff.map_or(0.5, |c| c.0), "alpha cutoff", 0.0, f32::MAX, 0.5);
        let metallic = clamp(pbr.metallic_factor.0, "metallic factor", 0.0, 1.0, 1.0);
        let roughness = clamp(pbr.roughness_factor.0, "roughness factor", 0.0, 1.0, 1.0);
        let normal_scale = clamp(normal.map_or(1.0, |n| n.scale), "normal scale", -100.0, 100.0, 1.0);
        let occlusion_strength = clamp(occlusion.map_or(1.0, |o| o.strength.0), "occlusion strength", 0.0, 1.0, 1.0);

        let optics = extensions.and_then(|e| e.transmission.as_ref());
        let transmission = clamp(optics.map_or(0.0, |t| t.transmission_factor.0), "transmission factor", 0.0, 1.0, 0.0);
        let ior = clamp(extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |e| e.ior.0), "ior", 1.0, 10.0, 1.5);
        let thickness = extensions.and_then(|e| e.volume.as_ref()).map_or(0.0, |v| v.thickness_factor.0);
        if optics.is_some_and(|t| t.transmission_texture.is_some()) {
            self.notice(format!("{place}: transmission texture ignored, its factor is taken"));
        }
        let (alpha_cutoff, blended) = match material.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => (None, false),
            Checked::Valid(AlphaMode::Mask) => (Some(cutoff), false),
            // What is blended is no part of the scene that rays are traced in.
            Checked::Valid(AlphaMode::Blend) if transmission > 0.0 => {
                self.notice(format!("{place}: BLEND drawn as MASK, so that rays pass through it"));
                (Some(0.5), false)
            }
            Checked::Valid(AlphaMode::Blend) => (None, true),
            Checked::Invalid => {
                self.notice(format!("{place}: unknown alpha mode drawn as OPAQUE"));
                (None, false)
            }
        };
        let converted = Material {
            name: place.to_owned(),
            base_color,
            metallic,
            roughness,
            emissive: emissive * strength,
            normal_scale,
            occlusion_strength,
            alpha_cutoff,
            blended,
            double_sided: material.double_sided,
            unlit: extensions.is_some_and(|e| e.unlit.is_some()),
            transmission,
            ior,
            volume: thickness > 0.0,
            base_color_texture,
            metallic_roughness_texture,
            normal_texture,
            occlusion_texture,
            emissive_texture,
        };
        Ok((converted, uv_sets))
    }

    /// `None` with a notice where the file gives a texture without a picture.
    fn texture(
        &mut self,
        reference: &Reference,
        place: &str,
        role: &str,
        srgb: bool,
    ) -> Result<Option<TextureRef>, Problem> {
        let root = self.root;
        let dangling = |from: String, kind, index, count| Problem::Reference { from, kind, index, count };
        let number = reference.texture.value();
        let texture = root
            .textures
            .get(number)
            .ok_or_else(|| dangling(place.to_owned(), "texture", number, root.textures.len()))?;
        // What gltf-json stores for "no source".
        if texture.source.value() == u32::MAX as usize {
            self.notice(format!("{place}: {role} texture ignored, texture {number} has no PNG or JPEG source"));
            return Ok(None);
        }
        let source = texture.source.value();
        let image = root
            .images
            .get(source)
            .ok_or_else(|| dangling(format!("texture {number}"), "image", source, root.images.len()))?;
        let sampler = match texture.sampler.map(|sampler| sampler.value()) {
            Some(sampler) => root
                .samplers
                .get(sampler)
                .ok_or_else(|| dangling(format!("texture {number}"), "sampler", sampler, root.samplers.len()))?,
            None => &json::texture::Sampler::default(),
        };

        // The same picture listed twice is still one.
        let same = |&other: &usize| {
            let other = &root.images[other];
            other.uri == image.uri && other.buffer_view.map(|v| v.value()) == image.buffer_view.map(|v| v.value())
        };
        let image = self.images.iter().position(same).unwrap_or_else(|| {
            self.images.push(source);
            self.images.len() - 1
        });
        let near = |filter: MinFilter| {
            matches!(filter, MinFilter::Nearest | MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear)
        };
        let nearest = Nearest {
            magnified: matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))),
            minified: matches!(sampler.min_filter, Some(Checked::Valid(filter)) if near(filter)),
        };
        let texture = Texture { image, srgb, wrap_u: wrap(&sampler.wrap_s), wrap_v: wrap(&sampler.wrap_t), nearest };
        let texture = self.textures.iter().position(|other| *other == texture).unwrap_or_else(|| {
            self.textures.push(texture);
            self.textures.len() - 1
        });

        let (u_row, v_row) = rows(&reference.transform);
        if !(u_row.is_finite() && v_row.is_finite()) {
            self.notice(format!("{place}: {role} texture's transform ignored, it is not finite"));
            return Ok(Some(TextureRef { texture, u_row: Vec3::X, v_row: Vec3::Y }));
        }
        Ok(Some(TextureRef { texture, u_row, v_row }))
    }

    fn notice(&mut self, text: String) {
        self.notices.push(text);
    }
}

impl Material {
    fn textures_mut(&mut self) -> [&mut Option<TextureRef>; 5] {
        [
            &mut self.base_color_texture,
            &mut self.metallic_roughness_texture,
            &mut self.normal_texture,
            &mut self.occlusion_texture,
            &mut self.emissive_texture,
        ]
    }
}

impl TextureRef {
    /// Reads the same texels of coordinates that these rows lead to its own.
    fn after(self, [u, v]: [Vec3; 2]) -> Self {
        let through = |row: Vec3| u * row.x + v * row.y + Vec3::Z * row.z;
        Self { texture: self.texture, u_row: through(self.u_row), v_row: through(self.v_row) }
    }
}

impl Reference {
    fn with_transform(
        texture: Index<json::Texture>,
        uv_set: u32,
        extensions: Option<&Map<String, Value>>,
    ) -> Result<Self, Problem> {
        let transform: TextureTransform = match extensions.and_then(|e| e.get("KHR_texture_transform")) {
            Some(value) => serde_json::from_value(value.clone())?,
            None => TextureTransform::default(),
        };
        Ok(Self { texture, uv_set: transform.tex_coord.unwrap_or(uv_set), transform })
    }
}

impl From<&json::texture::Info> for Reference {
    fn from(info: &json::texture::Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone()).unwrap_or_default();
        Self { texture: info.index, uv_set: transform.tex_coord.unwrap_or(info.tex_coord), transform }
    }
}

/// The rows of translate · rotate · scale. Rotation is counter-clockwise where v points down, as Khronos'
/// TextureTransformTest has it.
fn rows(transform: &TextureTransform) -> (Vec3, Vec3) {
    let ([tx, ty], [sx, sy]) = (transform.offset.0, transform.scale.0);
    let (sin, cos) = transform.rotation.0.sin_cos();
    (Vec3::new(cos * sx, sin * sy, tx), Vec3::new(-sin * sx, cos * sy, ty))
}

fn wrap(mode: &Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}
