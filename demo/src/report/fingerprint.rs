//! What a result depends on, as a hash.

use crate::scene::Scene;
use sha2::{Digest as _, Sha256};

/// A SHA-256 under way. Every part goes in with its length, so that no two inputs join to the same bytes.
#[derive(Debug, Clone)]
pub struct Fingerprint(Sha256);

/// All shader code that has a part in an image. The library's own too: a result of other code is another result.
fn code() -> Vec<&'static str> {
    let own = [
        crate::host::SHADING_WGSL,
        crate::host::UNTEXTURED_WGSL,
        include_str!("../host/raster.wgsl"),
        include_str!("../host/raster_stored.wgsl"),
        include_str!("../host/raster_ids.wgsl"),
        env!("CARGO_PKG_VERSION"),
    ];
    own.into_iter().chain(deferred_aa::shader_texts()).collect()
}

impl Fingerprint {
    /// Of all that is uploaded of a scene, and of the code that renders it.
    pub fn of_scene(scene: &Scene) -> Self {
        let mut all = Self(Sha256::new());
        code().iter().for_each(|code| all.bytes(code.as_bytes()));
        for mesh in &scene.meshes {
            all.bytes(bytemuck::cast_slice(&mesh.positions));
            all.bytes(bytemuck::cast_slice(&mesh.normals));
            all.bytes(bytemuck::cast_slice(&mesh.tangents));
            all.bytes(bytemuck::cast_slice(&mesh.uvs));
            all.bytes(bytemuck::cast_slice(&mesh.colors));
            all.bytes(bytemuck::cast_slice(&mesh.indices));
            all.text(&mesh.material);
        }
        scene.images.iter().for_each(|image| {
            all.text(image);
            all.bytes(&image.rgba);
        });
        // Debug prints floats with all digits that they have.
        all.text(&(&scene.instances, &scene.materials, &scene.textures, &scene.lights, &scene.sun, &scene.sky));
        all
    }

    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// Adds a value as its `Debug` has it, which must show all of it.
    pub fn text(&mut self, value: &impl std::fmt::Debug) {
        self.bytes(format!("{value:?}").as_bytes());
    }

    /// This with one more value.
    pub fn with(&self, value: &impl std::fmt::Debug) -> Self {
        let mut more = self.clone();
        more.text(value);
        more
    }

    /// 64 hexadecimal digits.
    pub fn hex(&self) -> String {
        self.0.clone().finalize().iter().map(|b| format!("{b:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::builtin;

    #[test]
    fn sha_256_as_published() {
        // FIPS 180-2, appendix B.1, over the bytes alone.
        let mut abc = Fingerprint(Sha256::new());
        abc.0.update(b"abc");
        assert_eq!(abc.hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn parts_do_not_run_into_each_other() {
        let of = |parts: &[&[u8]]| {
            let mut all = Fingerprint(Sha256::new());
            parts.iter().for_each(|p| all.bytes(p));
            all.hex()
        };
        assert_ne!(of(&[b"ab", b"c"]), of(&[b"a", b"bc"]));
        assert_ne!(of(&[b"abc"]), of(&[b"abc", b""]));
    }

    #[test]
    fn every_shader_of_the_library_counts() {
        let code = code();
        let mut folders = vec![std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders"))];
        let mut files = 0;
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let text = std::fs::read_to_string(&path).unwrap();
                assert!(code.contains(&text.as_str()), "{} does not count", path.display());
                files += 1;
            }
        }
        assert!(files > 40, "{files}");
    }

    #[test]
    fn everything_in_a_scene_counts() {
        let scene = builtin("fence").unwrap();
        let same = Fingerprint::of_scene(&scene).hex();
        assert_eq!(same, Fingerprint::of_scene(&builtin("fence").unwrap()).hex());
        let changes: [fn(&mut Scene); 8] = [
            |s| s.meshes[0].positions[0].x = s.meshes[0].positions[0].x.next_up(),
            |s| s.meshes[0].colors[0].w *= 0.5,
            |s| s.meshes[0].indices.swap(0, 1),
            |s| s.instances[0].world_from_mesh.w_axis.x += 1e-3,
            |s| s.materials[0].roughness *= 0.999,
            |s| s.sky.ground.x += 1e-6,
            |s| s.images[0].rgba = s.images[0].rgba.iter().map(|b| b ^ 1).collect(),
            |s| s.sun = None,
        ];
        for (i, change) in changes.iter().enumerate() {
            let mut other = scene.clone();
            change(&mut other);
            assert_ne!(same, Fingerprint::of_scene(&other).hex(), "change {i}");
        }
    }
}
