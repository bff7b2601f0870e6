//! `examples/host.rs`, which users copy: it runs, and is short.

#[allow(dead_code, reason = "its main prints")]
#[path = "../../examples/host.rs"]
mod host;

use deferred_aa::{Settings, Technique};

#[test]
fn the_host_renders_anti_aliased_blades() {
    let [single, windowed, full] = [Technique::Single, Technique::Windowed, Technique::Full]
        .map(|technique| host::render(Settings { technique, ..Default::default() }).expect("a frame"));
    let pixels = (host::SIZE.width * host::SIZE.height) as usize;
    assert!([&single, &windowed, &full].iter().all(|(image, _)| image.len() == pixels * 4));

    // Samples go where edges are: few, and more than one a pixel.
    let statistics = &windowed.1;
    assert!(statistics.mean_k > 1.05 && statistics.mean_k < 4.0, "{}", statistics.mean_k);
    assert_eq!(statistics.histogram_k.iter().sum::<u32>() as usize, pixels);
    assert_eq!(statistics.not_finite + statistics.negative, 0);

    // Eleven blades in as many colours, on a sky.
    let mut colours: Vec<_> = single.0.as_chunks::<4>().0.to_vec();
    colours.sort_unstable();
    colours.dedup();
    assert_eq!(colours.len(), 12, "{colours:?}");

    // What adaptive sampling is for: nearly the image of full supersampling, which one sample a pixel is far from.
    let apart = |a: &[u8]| a.iter().zip(&full.0).map(|(&a, &b)| f64::from(a.abs_diff(b)).powi(2)).sum::<f64>();
    let (adaptive, plain) = (apart(&windowed.0), apart(&single.0));
    assert!(adaptive < 0.1 * plain, "{adaptive} against {plain}");
}

#[test]
fn the_host_is_short() {
    let lines = include_str!("../../examples/host.rs").lines().count();
    assert!(lines < 120, "{lines} lines");
}
