use super::*;
use crate::host::{self, gpu};
use deferred_aa::rays::RayTier;
use deferred_aa::{GBufferTier, TextureTier};

const DARK: u8 = 40;
const BRIGHT: u8 = 200;

pub(super) fn gpu() -> Gpu {
    Gpu::new(
        gpu::choose(None).unwrap(),
        &host::descriptor(1, TextureTier::Arrays, RayTier::Software, GBufferTier::default()),
    )
    .unwrap()
}

/// Linear HDR of the host's format.
pub(super) fn texture(gpu: &Gpu, width: u32, height: u32, pixel: impl Fn(u32, u32) -> [f32; 3]) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: host::TARGET_FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let channels = pixels.flat_map(|(x, y)| pixel(x, y).into_iter().chain([1.0]));
    let bytes: Vec<u8> = channels.flat_map(|c| half::f16::from_f32(c).to_le_bytes()).collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 8), rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), &bytes, layout, texture.size());
    texture.create_view(&Default::default())
}

pub(super) fn grey(shown: u8) -> [f32; 3] {
    [display::radiance(shown); 3]
}

fn run(peers: &mut Peers, peer: Peer, image: &wgpu::TextureView) -> Vec<[u8; 3]> {
    let shot = peers.run(peer, image).unwrap();
    assert!(shot.milliseconds.is_none_or(|ms| ms > 0.0), "{peer:?}: {shot:?}");
    peers.picture().to_srgb8()
}

#[test]
fn without_an_edge_nothing_changes() {
    let gpu = gpu();
    for (width, height) in [(1, 1), (17, 13), (256, 2)] {
        let mut peers = Peers::new(&gpu, width, height).unwrap();
        // Flat colours with every value, and a ramp whose steps are below any threshold.
        let flat = [[0, 0, 0], [255, 255, 255], [13, 200, 90], [255, 0, 7]];
        for peer in Peer::ALL {
            for colour in flat {
                let image = texture(&gpu, width, height, |_, _| colour.map(display::radiance));
                let shown = run(&mut peers, peer, &image);
                assert!(shown.iter().all(|&c| c == colour), "{peer:?} {width}×{height} {colour:?}: {:?}", shown[0]);
            }
            let image = texture(&gpu, width, height, |x, _| grey(x as u8));
            let ramp: Vec<_> = (0..width * height).map(|i| [(i % width) as u8; 3]).collect();
            assert_eq!(run(&mut peers, peer, &image), ramp, "{peer:?} {width}×{height}");
        }
    }
}

/// A half plane: bright below the line through the middle that rises by `slope` rows a column.
struct Edge {
    slope: f64,
}

impl Edge {
    const SIZE: u32 = 64;

    /// Rows from the line down to the point.
    fn below(&self, x: f64, y: f64) -> f64 {
        let middle = f64::from(Self::SIZE) / 2.0;
        (y - middle - 0.3) - self.slope * (x - middle)
    }

    fn aliased(&self, x: u32, y: u32) -> u8 {
        if self.below(f64::from(x) + 0.5, f64::from(y) + 0.5) > 0.0 { BRIGHT } else { DARK }
    }

    /// The box filter over the pixel: the share of it below the line, whose integral over a column is elementary.
    fn coverage(&self, x: u32, y: u32) -> f64 {
        let columns = 1024;
        let column = |i: u32| {
            let x = f64::from(x) + (f64::from(i) + 0.5) / f64::from(columns);
            self.below(x, f64::from(y) + 1.0).clamp(0.0, 1.0)
        };
        (0..columns).map(column).sum::<f64>() / f64::from(columns)
    }

    fn filtered(&self, x: u32, y: u32) -> [f32; 3] {
        let [dark, bright] = [DARK, BRIGHT].map(|c| f64::from(display::radiance(c)));
        [(dark + (bright - dark) * self.coverage(x, y)) as f32; 3]
    }
}

fn squared_error(a: &[[u8; 3]], b: &[[u8; 3]]) -> u64 {
    a.iter().zip(b).map(|(a, b)| u64::from(a[0].abs_diff(b[0])).pow(2)).sum()
}

#[test]
fn edges_come_nearer_to_the_box_filtered_ones() {
    let gpu = gpu();
    let size = Edge::SIZE;
    let mut peers = Peers::new(&gpu, size, size).unwrap();
    let at = |i: usize| (i as u32 % size, i as u32 / size);
    for slope in [0.07, 0.3, 1.0, -0.15, -1.0, 5.0] {
        let edge = Edge { slope };
        let image = texture(&gpu, size, size, |x, y| grey(edge.aliased(x, y)));
        let pixels = 0..(size * size) as usize;
        let aliased: Vec<_> = pixels.clone().map(|i| [edge.aliased(at(i).0, at(i).1); 3]).collect();
        let filtered = pixels.map(|i| edge.filtered(at(i).0, at(i).1)).map(|[r, g, b]| [r, g, b, 1.0]).collect();
        let filtered = Picture::new(size, size, filtered).unwrap().to_srgb8();
        for peer in Peer::ALL {
            let shown = run(&mut peers, peer, &image);
            let between = shown.iter().filter(|c| (DARK + 8..BRIGHT - 8).contains(&c[0])).count();
            assert!(between >= 20, "{peer:?}, slope {slope}: {between} values in between");
            let (before, after) = (squared_error(&aliased, &filtered), squared_error(&shown, &filtered));
            assert!(after * 10 < before * 8, "{peer:?}, slope {slope}: from {before} to {after}");
            // Where no pixel within two differs, nothing may change.
            for (i, (shown, aliased)) in shown.iter().zip(&aliased).enumerate() {
                let (x, y) = at(i);
                let distance = edge.below(f64::from(x) + 0.5, f64::from(y) + 0.5).abs() / slope.hypot(1.0);
                assert!(distance < 3.0 || shown == aliased, "{peer:?}, slope {slope}: ({x}, {y}) {shown:?}");
            }
            assert_eq!(run(&mut peers, peer, &image), shown, "{peer:?}: the same image twice");
        }
    }
}

#[test]
fn small_and_broken_images() {
    let gpu = gpu();
    for (width, height) in [(1, 1), (17, 13)] {
        let mut peers = Peers::new(&gpu, width, height).unwrap();
        let noise = |x: u32, y: u32| grey((x * 89 + y * 57) as u8);
        let image = texture(&gpu, width, height, noise);
        let lost = texture(&gpu, width, height, |_, _| [1.0, f32::NAN, f32::INFINITY]);
        for peer in Peer::ALL {
            let shown = run(&mut peers, peer, &image);
            assert_eq!(shown.len(), (width * height) as usize);
            assert_eq!(shown.len() == 1, shown.iter().all(|&c| c == shown[0]), "{peer:?}");
            assert!(run(&mut peers, peer, &lost).iter().all(|&c| c == crate::picture::NOT_FINITE), "{peer:?}");
        }
    }
    let mut peers = Peers::new(&gpu, 17, 13).unwrap();
    let other = texture(&gpu, 13, 17, |_, _| grey(9));
    let refused = peers.run(Peer::Smaa, &other).unwrap_err().to_string();
    assert!(refused.contains("smaa") && refused.contains("13x17") && refused.contains("17x13"), "{refused}");
}
