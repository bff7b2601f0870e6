//! The peers and the oracle on a scene: do they mean what they say?

use deferred_aa::{Settings, Technique};
use deferred_aa_demo::gpu::{self, Gpu};
use deferred_aa_demo::host::{Host, Options};
use deferred_aa_demo::oracle::{self, Windows};
use deferred_aa_demo::peers::{Peer, Peers};
use deferred_aa_demo::quality;
use deferred_aa_demo::raster::node_camera;
use deferred_aa_demo::scene::builtin::builtin;

const WIDTH: u32 = 160;
const HEIGHT: u32 = 90;
const M: u32 = 4;

fn host(scene: &str, width: u32, height: u32, m: u32) -> Host {
    let options = Options::new(width, height, m);
    let gpu = Gpu::new(gpu::choose(None).unwrap(), &options.descriptor()).unwrap();
    Host::new(gpu, builtin(scene).unwrap(), options).unwrap()
}

fn settings(technique: Technique) -> Settings {
    Settings { technique, ..Default::default() }
}

#[test]
fn peers_improve_on_single_where_edges_are() {
    let mut host = host("fence", WIDTH, HEIGHT, M);
    let camera = host.scene.default_camera();
    host.frame(&camera, settings(Technique::Full)).unwrap();
    let (reference, mask) = (host.picture(), host.edge_mask());
    host.frame(&camera, settings(Technique::Single)).unwrap();
    let single = host.picture();
    let edges = |picture: &_| quality::edge_psnr(picture, &reference, &mask).unwrap().unwrap();
    let mut peers = Peers::new(&host.gpu, WIDTH, HEIGHT).unwrap();
    for peer in Peer::ALL {
        let shot = peers.run(peer, host.target()).unwrap();
        let (before, after) = (edges(&single), edges(&peers.picture()));
        println!("{}: {:.2} dB, single {before:.2} dB, {:?} ms", peer.name(), after, shot.milliseconds);
        assert!(after > before + 0.2, "{}: {after} dB, single {before} dB", peer.name());
    }
}

#[test]
fn the_oracle_bounds_windowed() {
    let mut small = host("fence", WIDTH, HEIGHT, M);
    let camera = small.scene.default_camera();
    small.frame(&camera, settings(Technique::Full)).unwrap();
    let full = small.picture();
    let windowed = small.frame(&camera, settings(Technique::Windowed)).unwrap().statistics;
    let psnr = quality::psnr(&small.picture(), &full).unwrap();

    let mut big = host("fence", WIDTH * M, HEIGHT * M, 1);
    let view = node_camera(&camera, WIDTH, HEIGHT);
    big.frame_with(view, settings(Technique::Full)).unwrap();
    let samples = big.picture();

    // The same samples: their mean is what `Full` wrote, but for the rounding to half floats.
    let grid = oracle::grid(&samples, M).unwrap();
    let furthest = grid.to_srgb8().into_iter().flatten().zip(full.to_srgb8().into_iter().flatten());
    let furthest = furthest.map(|(a, b)| a.abs_diff(b)).max();
    assert!(furthest.unwrap() <= 1, "{furthest:?} steps of 255 apart");

    let windows = Windows::new(&samples, M).unwrap();
    let bound = windows.neyman(10.0_f64.powf(-psnr / 20.0)).unwrap();
    println!("windowed {:.4} of the samples for {psnr:.2} dB, oracle {bound:?}", windowed.ratio);
    assert!((bound.psnr_db - psnr).abs() < 0.01, "{bound:?} {psnr}");
    assert!(bound.ratio > 1.0 / 16.0 && bound.ratio < windowed.ratio, "{bound:?} {}", windowed.ratio);

    let coverage = oracle::exact_coverage(&big, &view, M).unwrap();
    let equal = windows.neyman(10.0_f64.powf(-coverage.psnr_db / 20.0)).unwrap();
    println!("{coverage:?}, mean of k at that error {equal:?}");
    // Exact weights beat means of as many samples, and every window has at least a surface, few have four.
    assert!(coverage.ratio > 1.0 / 16.0 && coverage.ratio < 0.2, "{coverage:?}");
    assert!(coverage.ratio < equal.ratio, "{coverage:?} {equal:?}");
}
