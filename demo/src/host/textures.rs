//! A scene's textures on the GPU: in few enough classes for the array tier, on both tiers alike, so that both give the
//! same picture. What samplers then can't do is left to material.wgsl.

use crate::host::mips::{self, Beside};
use crate::scene::{Scene, Texture, Wrap};
use deferred_aa::{MAX_CLASSES, TableSampler};
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Textures by index of [`Scene::textures`].
pub struct Stored {
    pub textures: Vec<wgpu::Texture>,
    pub samplers: Vec<TableSampler>,
    /// What shaders do besides.
    pub readings: Vec<Reading>,
    /// What was changed to fit, a line each.
    pub notices: Vec<String>,
}

/// How a shader reads a texture: `readings` and `texels` of `Material` in material.wgsl.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    pub how: u32,
    pub texels: [f32; 4],
}

/// How a texture is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Plan {
    /// In texels, once.
    size: (u32, u32),
    /// What the sampler does.
    wraps: (Wrap, Wrap),
    /// With a copy on the right, or the mirror image where the texture is not to repeat.
    twice: bool,
}

/// A picture to be uploaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Job {
    image: usize,
    srgb: bool,
    size: (u32, u32),
    /// What stands on the right, if anything does.
    beside: Option<Beside>,
    /// Whether texels are repeated to fill the size.
    sharp: bool,
}

/// Uploads each image, none of which is larger than the device allows, in each form that is asked for.
pub fn store(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene, anisotropy: u16) -> Stored {
    let natural: Vec<_> =
        scene.textures.iter().map(|t| (scene.images[t.image].width, scene.images[t.image].height)).collect();
    let wgpu::Limits { max_texture_dimension_2d: widest, max_texture_array_layers: layers, .. } = device.limits();
    let (plans, notices) = plan(&scene.textures, &natural, layers, widest);

    let job = |(t, plan): (&Texture, &Plan)| Job {
        image: t.image,
        srgb: t.srgb,
        size: plan.size,
        beside: plan.twice.then_some(if t.wrap_u == Wrap::Repeat { Beside::Copy } else { Beside::MirrorImage }),
        sharp: t.nearest.magnified,
    };
    let jobs: Vec<_> = scene.textures.iter().zip(&plans).map(job).collect();
    let made: HashMap<Job, wgpu::Texture> = chains(scene, &jobs)
        .into_iter()
        .map(|(job, levels)| (job, texture(device, queue, &levels, job.srgb)))
        .collect();
    Stored {
        textures: jobs.iter().map(|job| made[job].clone()).collect(),
        samplers: plans.iter().map(|plan| sampler(plan, anisotropy)).collect(),
        readings: scene.textures.iter().zip(&plans).zip(natural).map(|((t, p), size)| reading(t, p, size)).collect(),
        notices,
    }
}

/// How to store the textures so that they fall into at most [`MAX_CLASSES`] arrays of so many layers: as they are if
/// they do. Else fewer kinds of sampler are used, and if that is not enough, the pair of sizes whose union costs the
/// fewest texels is enlarged to it, again and again.
fn plan(textures: &[Texture], natural: &[(u32, u32)], layers: u32, widest: u32) -> (Vec<Plan>, Vec<String>) {
    let own = |(t, &size): (&Texture, _)| Plan { size, wraps: (t.wrap_u, t.wrap_v), twice: false };
    let mut plans: Vec<_> = textures.iter().zip(natural).map(own).collect();
    let arrays = |plans: &[Plan]| -> usize {
        classes(textures, plans).values().map(|&members| members.div_ceil(u64::from(layers)) as usize).sum()
    };
    if arrays(&plans) > MAX_CLASSES {
        let clamps = |wrap| if wrap == Wrap::Clamp { Wrap::Mirror } else { wrap };
        plans.iter_mut().for_each(|p| p.wraps = (clamps(p.wraps.0), clamps(p.wraps.1)));
    }
    let kinds: std::collections::HashSet<_> = textures.iter().zip(&plans).map(|(t, p)| (t.srgb, p.wraps)).collect();
    if kinds.len() > MAX_CLASSES && plans.iter().all(|p| p.size.0 <= widest / 2) {
        plans.iter_mut().for_each(|p| (p.wraps.0, p.twice) = (Wrap::Repeat, true));
    }
    while arrays(&plans) > MAX_CLASSES {
        let classes = classes(textures, &plans);
        let area = |(w, h): (u32, u32)| u64::from(w) * u64::from(h);
        let keys: Vec<_> = classes.keys().copied().collect();
        let merge = keys
            .iter()
            .flat_map(|a| keys.iter().map(move |b| (a, b)))
            .filter(|(a, b)| a.1.size != b.1.size && (a.0, Plan { size: b.1.size, ..a.1 }) == **b)
            .map(|(a, b)| {
                let union = (a.1.size.0.max(b.1.size.0), a.1.size.1.max(b.1.size.1));
                let cost = (area(union) - area(a.1.size)) * classes[a] + (area(union) - area(b.1.size)) * classes[b];
                (cost, *a, *b, union)
            })
            .min();
        // There are more textures than layers: the table will say so.
        let Some((_, a, b, union)) = merge else { break };
        for (t, plan) in textures.iter().zip(&mut plans) {
            if [a, b].contains(&(t.srgb, *plan)) {
                plan.size = union;
            }
        }
    }
    let resized = plans.iter().zip(natural).filter(|(plan, natural)| plan.size != **natural).count();
    let notice = format!("{resized} textures were enlarged so that all fall into {MAX_CLASSES} classes");
    (plans, if resized > 0 { vec![notice] } else { Vec::new() })
}

/// How many textures each class has.
fn classes(textures: &[Texture], plans: &[Plan]) -> HashMap<(bool, Plan), u64> {
    let mut classes = HashMap::new();
    for (t, &plan) in textures.iter().zip(plans) {
        *classes.entry((t.srgb, plan)).or_default() += 1;
    }
    classes
}

fn sampler(plan: &Plan, anisotropy: u16) -> TableSampler {
    let address = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let (u, v) = plan.wraps;
    TableSampler { address_u: address(u), address_v: address(v), nearest: false, anisotropy }
}

fn reading(t: &Texture, plan: &Plan, natural: (u32, u32)) -> Reading {
    let clamped = |wrap, sampler| wrap == Wrap::Clamp && sampler != Wrap::Clamp;
    let bits = [
        t.nearest.magnified,
        t.nearest.minified,
        clamped(t.wrap_u, plan.wraps.0),
        clamped(t.wrap_v, plan.wraps.1),
        plan.twice,
    ];
    let how = bits.into_iter().enumerate().map(|(bit, is)| u32::from(is) << bit).sum();
    let (from, to) = (natural, plan.size);
    Reading { how, texels: [from.0, from.1, to.0, to.1].map(|side| side as f32) }
}

/// The mip chains of the jobs, each once, on all cores.
fn chains(scene: &Scene, jobs: &[Job]) -> Vec<(Job, Vec<mips::Level>)> {
    let mut jobs = jobs.to_vec();
    jobs.sort_unstable();
    jobs.dedup();
    let next = AtomicUsize::new(0);
    let chains = Mutex::new(Vec::with_capacity(jobs.len()));
    std::thread::scope(|threads| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            threads.spawn(|| {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let levels = chain(scene, job);
                    chains.lock().unwrap_or_else(PoisonError::into_inner).push((*job, levels));
                }
            });
        }
    });
    chains.into_inner().unwrap_or_else(PoisonError::into_inner)
}

fn chain(scene: &Scene, job: &Job) -> Vec<mips::Level> {
    let picture = &scene.images[job.image];
    let (from, (width, height)) = ((picture.width, picture.height), job.size);
    let resized;
    let rgba: &[u8] = if from == job.size {
        &picture.rgba
    } else {
        resized = if job.sharp {
            mips::enlarge(from.0, from.1, &picture.rgba, job.size)
        } else {
            mips::resize(from.0, from.1, &picture.rgba, job.srgb, job.size)
        };
        &resized
    };
    match job.beside {
        Some(beside) => mips::chain(2 * width, height, &mips::twice(width, rgba, beside), job.srgb),
        None => mips::chain(width, height, rgba, job.srgb),
    }
}

fn texture(device: &wgpu::Device, queue: &wgpu::Queue, levels: &[mips::Level], srgb: bool) -> wgpu::Texture {
    let extent = |l: &mips::Level| wgpu::Extent3d { width: l.width, height: l.height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("scene texture"),
        size: extent(&levels[0]),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: if srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    for (mip, level) in (0..).zip(levels) {
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: mip, ..texture.as_image_copy() },
            &level.rgba,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(level.width * 4), rows_per_image: None },
            extent(level),
        );
    }
    texture
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Nearest;

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

    fn textures(all: impl Iterator<Item = (bool, Wrap, Wrap)>) -> Vec<Texture> {
        let texture =
            |(image, (srgb, wrap_u, wrap_v))| Texture { image, srgb, wrap_u, wrap_v, nearest: Nearest::default() };
        all.enumerate().map(texture).collect()
    }

    #[test]
    fn many_sizes_become_few_classes() {
        let textures = textures((0..12).map(|i| (i % 2 == 0, Wrap::Repeat, Wrap::Repeat)));
        let natural: Vec<_> = (0..12).map(|i| (16 << (i / 2), 16 + 3 * i)).collect();
        let (plans, notices) = plan(&textures, &natural, 256, 8192);
        assert!(classes(&textures, &plans).len() <= MAX_CLASSES);
        assert!(plans.iter().zip(&natural).all(|(a, b)| a.size.0 >= b.0 && a.size.1 >= b.1));
        assert_eq!(notices.len(), 1);
    }

    /// What is seen of a texture where its coordinates are outside [0, 1].
    #[test]
    fn every_mix_of_samplers_fits() {
        let mixes = |wraps: &[Wrap]| {
            let pairs: Vec<_> = wraps.iter().flat_map(|&u| wraps.iter().map(move |&v| (u, v))).collect();
            textures(
                [false, true]
                    .into_iter()
                    .flat_map(move |srgb| pairs.clone().into_iter().map(move |(u, v)| (srgb, u, v))),
            )
        };
        // Few enough as they are; clamped by a sampler that mirrors; and mirrored by what is stored.
        let few = textures([(true, Wrap::Clamp, Wrap::Repeat), (false, Wrap::Mirror, Wrap::Mirror)].into_iter());
        let some = textures(
            [Wrap::Clamp, Wrap::Mirror]
                .into_iter()
                .flat_map(|u| WRAPS.map(|v| [true, false].map(|s| (s, u, v))))
                .flatten(),
        );
        let both = mixes(&[Wrap::Repeat, Wrap::Clamp]);
        let all = mixes(&WRAPS);
        for (textures, twice) in [(few, false), (some, false), (both, true), (all, true)] {
            let (plans, notices) = plan(&textures, &vec![(8, 4); textures.len()], 256, 16);
            assert!(classes(&textures, &plans).len() <= MAX_CLASSES && notices.is_empty());
            assert!(plans.iter().all(|p| p.twice == twice));
            for (t, plan) in textures.iter().zip(&plans) {
                let how = reading(t, plan, (8, 4)).how;
                let seen = |sampler, clamped: u32| if how & clamped != 0 { Wrap::Clamp } else { sampler };
                assert_eq!(seen(plan.wraps.1, 8), t.wrap_v, "{t:?}: {plan:?}");
                if !twice || how & 4 != 0 {
                    assert_eq!(seen(plan.wraps.0, 4), t.wrap_u, "{t:?}: {plan:?}");
                }
            }
        }
    }

    #[test]
    fn a_class_that_needs_several_arrays_counts_as_several() {
        let textures = textures((0..16).map(|i| (false, Wrap::Repeat, WRAPS[i % 2])));
        let natural: Vec<_> = (0..16).map(|i| if i < 8 { (4, 4) } else { (8, 8) }).collect();
        let arrays = |layers: u32| {
            let (plans, _) = plan(&textures, &natural, layers, 64);
            classes(&textures, &plans).values().map(|n| n.div_ceil(layers.into())).sum::<u64>()
        };
        assert_eq!([arrays(4), arrays(3)], [4, 7], "sizes are merged where the arrays are too many");
    }
}
