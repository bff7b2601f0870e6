//! Which entries a report has, known before any work is done.

use super::schema::Role;
use crate::peers::msaa::Samples;
use crate::peers::{AnyPeer, Peer};
use deferred_aa::{MultiResolution, Preset, Reconstructed, Selective, Settings, Surfaces, Technique, Windowed};

/// One entry to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Unique, and the stem of its files.
    pub id: String,
    /// For people.
    pub label: String,
    /// Why it is here.
    pub role: Role,
    /// The name of its settings, if they have one.
    pub preset: Option<&'static str>,
    /// Samples along one side of a window.
    pub m: u32,
    /// What is recorded.
    pub settings: Settings,
    /// What it is measured beside: a peer, on images of these settings.
    pub peer: Option<AnyPeer>,
}

/// What `--techniques` takes, in the order of the report.
pub const TECHNIQUES: [&str; 7] =
    ["full", "single", "windowed", "reconstructed", "selective", "multiresolution", "surfaces"];

/// Peers, of which `--techniques` takes the names too, and how people call them.
pub const PEERS: [(AnyPeer, &str); 6] = [
    (AnyPeer::Image(Peer::Fxaa), "FXAA"),
    (AnyPeer::Image(Peer::Smaa), "SMAA 1x"),
    (AnyPeer::Taa, "TAA"),
    (AnyPeer::Msaa(Samples::Two), "Forward MSAA 2x"),
    (AnyPeer::Msaa(Samples::Four), "Forward MSAA 4x"),
    (AnyPeer::Msaa(Samples::Eight), "Forward MSAA 8x"),
];

/// Settings of Windowed that have a name, and how people call them.
pub const PRESETS: [(&str, &str, Windowed); 3] = [
    ("fast", "Windowed, fast", Preset::Fast.windowed()),
    ("quality", "Windowed, quality", Preset::Quality.windowed()),
    ("paper", "Windowed, as in the paper", Windowed::PAPER),
];

/// What all constants of Windowed are scaled by, for the greatest m and for the others. 1 is the settings as given.
struct Sweep(&'static [Scale], &'static [Scale]);

/// A factor and its name in ids.
type Scale = (f32, &'static str);

const ALL: Sweep = Sweep(
    &[(0.0625, "1-16"), (0.125, "1-8"), (0.25, "1-4"), (0.5, "1-2"), (1.0, ""), (2.0, "2"), (4.0, "4"), (8.0, "8")],
    &[(0.125, "1-8"), (0.5, "1-2"), (1.0, ""), (4.0, "4")],
);
const QUICK: Sweep = Sweep(&[(0.0625, "1-16"), (0.25, "1-4"), (1.0, ""), (4.0, "4")], &[(0.25, "1-4"), (1.0, "")]);

/// Thresholds of Selective, with their names in ids: τcol beside the settings as given, and τa (of colour and textures)
/// beside the paper's settings as they stand.
struct Thresholds {
    own: &'static [Scale],
    paper: &'static [Scale],
}

/// For the greatest m.
const THRESHOLDS: Thresholds =
    Thresholds { own: &[(0.03, "0-03"), (0.3, "0-3"), (0.6, "0-6")], paper: &[(0.1, "0-1"), (0.3, "0-3"), (1.0, "1")] };
/// For the other ones.
const FEW_THRESHOLDS: Thresholds = Thresholds { own: &[(0.3, "0-3")], paper: &[] };
const QUICK_THRESHOLDS: Thresholds = Thresholds { own: &[(0.3, "0-3")], paper: &[(0.1, "0-1")] };
const NO_THRESHOLDS: Thresholds = Thresholds { own: &[], paper: &[] };

/// color_threshold of MultiResolution beside the settings as given, for the greatest m, and how many of them with
/// --quick.
const COLOR_THRESHOLDS: [Scale; 3] = [(0.02, "0-02"), (0.005, "0-005"), (0.05, "0-05")];
const QUICK_COLOR_THRESHOLDS: usize = 1;

/// Spreads of Surfaces beside the settings as given, for the greatest m; its presets are there too.
const SPREADS: [Scale; 3] = [(0.3, "0-3"), (0.04, "0-04"), (0.002, "0-002")];

/// All entries: by m, the greatest first, m = 1 last. `ms` holds no m twice.
///
/// Single is also there at m = 1, where it is plain deferred shading without an enlarged G-buffer; the peers run on
/// that.
pub fn plan(ms: &[u32], techniques: &[&str], base: Settings, quick: bool) -> Vec<Planned> {
    let mut ms: Vec<_> = ms.iter().copied().filter(|&m| m > 1).collect();
    ms.sort_unstable_by(|a, b| b.cmp(a));
    let wanted = |name: &str| techniques.contains(&name);
    let mut all = Vec::new();
    for (place, &m) in ms.iter().enumerate() {
        let mut push = |name: &str, label: String, technique, preset, windowed| {
            let settings = Settings { technique, windowed, ..base };
            let id = name.replace('@', &format!("m{m}"));
            all.push(Planned { id, label, role: Role::Technique, preset, m, settings, peer: None });
        };
        if wanted("full") {
            push("full-@", format!("Full, m = {m}"), Technique::Full, None, base.windowed);
        }
        if wanted("single") {
            push("single-@", format!("Single, m = {m}"), Technique::Single, None, base.windowed);
        }
        if wanted("windowed") {
            let sweep = if quick { QUICK } else { ALL };
            for &(factor, name) in if place == 0 { sweep.0 } else { sweep.1 } {
                let (id, label) = match name {
                    "" => ("windowed-@".to_owned(), format!("Windowed, m = {m}")),
                    _ => (format!("windowed-@-x{name}"), format!("Windowed × {}, m = {m}", name.replace('-', "/"))),
                };
                // The sweep's middle is the default, unless other settings are asked for.
                let windowed = scaled(base.windowed, factor);
                let preset = (windowed == Preset::default().windowed()).then_some("balanced");
                push(&id, label, Technique::Windowed, preset, windowed);
            }
            for (name, label, windowed) in PRESETS {
                let (id, label) = (format!("windowed-@-{name}"), format!("{label}, m = {m}"));
                push(&id, label, Technique::Windowed, Some(name), windowed);
            }
        }
        if wanted("reconstructed") {
            let paper = Settings { reconstructed: Reconstructed::PAPER, ..base };
            for (id, label, settings) in [("", "", base), ("-paper", ", as in the paper", paper)] {
                all.push(Planned {
                    id: format!("reconstructed-m{m}{id}"),
                    label: format!("Reconstructed{label}, m = {m}"),
                    role: Role::Technique,
                    preset: (!id.is_empty()).then_some("paper"),
                    m,
                    settings: Settings { technique: Technique::Reconstructed, ..settings },
                    peer: None,
                });
            }
        }
        if wanted("selective") {
            let thresholds = match (quick, place) {
                (false, 0) => THRESHOLDS,
                (false, _) => FEW_THRESHOLDS,
                (true, 0) => QUICK_THRESHOLDS,
                (true, _) => NO_THRESHOLDS,
            };
            for (id, label, preset, selective) in selective(m, base.selective, thresholds) {
                let settings = Settings { technique: Technique::Selective, selective, ..base };
                all.push(Planned { id, label, role: Role::Technique, preset, m, settings, peer: None });
            }
        }
        if wanted("multiresolution") {
            let thresholds = match (quick, place) {
                (false, 0) => &COLOR_THRESHOLDS[..],
                (true, 0) => &COLOR_THRESHOLDS[..QUICK_COLOR_THRESHOLDS],
                _ => &[],
            };
            for (id, label, preset, multi_resolution) in lattices(m, base.multi_resolution, thresholds, place == 0) {
                let settings = Settings { technique: Technique::MultiResolution, multi_resolution, ..base };
                all.push(Planned { id, label, role: Role::Technique, preset, m, settings, peer: None });
            }
        }
        if wanted("surfaces") {
            let spreads = if place == 0 && !quick { &SPREADS[..] } else { &[] };
            for (id, label, preset, surfaces) in surfaces(m, base.surfaces, spreads) {
                let settings = Settings { technique: Technique::Surfaces, surfaces, ..base };
                all.push(Planned { id, label, role: Role::Technique, preset, m, settings, peer: None });
            }
        }
    }
    let plain = Settings { technique: Technique::Single, ..base };
    let at_one = |id: &str, label: &str, role, peer| {
        let (id, label) = (id.to_owned(), label.to_owned());
        Planned { id, label, role, preset: None, m: 1, settings: plain, peer }
    };
    if wanted("single") {
        all.push(at_one("single-m1", "Single, m = 1", Role::Technique, None));
    }
    for (peer, label) in PEERS.into_iter().filter(|(peer, _)| wanted(peer.name())) {
        all.push(at_one(&format!("{}-m1", peer.name()), label, Role::Peer, Some(peer)));
    }
    all
}

/// Id, label, preset and settings.
type Own<T> = (String, String, Option<&'static str>, T);

/// Each entry of Selective at one m.
fn selective(m: u32, base: Selective, thresholds: Thresholds) -> Vec<Own<Selective>> {
    let mut all = vec![(format!("selective-m{m}"), format!("Selective, m = {m}"), None, base)];
    for &(tau_col, name) in thresholds.own {
        let label = format!("Selective, τcol {tau_col}, m = {m}");
        all.push((format!("selective-m{m}-{name}"), label, None, Selective { tau_col, ..base }));
    }
    let (id, label) = (format!("selective-m{m}-paper"), "Selective, as in the paper");
    all.push((id.clone(), format!("{label}, m = {m}"), Some("paper"), Selective::PAPER));
    for &(tau, name) in thresholds.paper {
        all.push((format!("{id}-{name}"), format!("{label}, τa {tau}, m = {m}"), None, paper_selective(tau)));
    }
    all
}

/// Each entry of MultiResolution at one m. `sparse`: also those of one sample a pixel at most.
fn lattices(m: u32, base: MultiResolution, thresholds: &[Scale], sparse: bool) -> Vec<Own<MultiResolution>> {
    let (id, name) = (format!("multiresolution-m{m}"), "MultiResolution");
    let mut all = vec![(id.clone(), format!("{name}, m = {m}"), None, base)];
    for &(color_threshold, threshold) in thresholds {
        let label = format!("{name}, threshold {color_threshold}, m = {m}");
        all.push((format!("{id}-{threshold}"), label, None, MultiResolution { color_threshold, ..base }));
    }
    if sparse {
        let below = MultiResolution { supersampled: false, ..base };
        all.push((format!("{id}-sparse"), format!("{name}, sparse, m = {m}"), None, below));
        let label = format!("{name}, as in the paper, m = {m}");
        all.push((format!("{id}-paper"), label, Some("paper"), MultiResolution::PAPER));
    }
    all
}

/// Each entry of Surfaces at one m.
fn surfaces(m: u32, base: Surfaces, spreads: &[Scale]) -> Vec<Own<Surfaces>> {
    let id = format!("surfaces-m{m}");
    let preset = (base == Preset::default().surfaces()).then_some("balanced");
    let mut all = vec![(id.clone(), format!("Surfaces, m = {m}"), preset, base)];
    let named = [("once", Surfaces::ONCE), ("fast", Preset::Fast.surfaces()), ("quality", Preset::Quality.surfaces())];
    for (name, surfaces) in named {
        all.push((format!("{id}-{name}"), format!("Surfaces, {name}, m = {m}"), Some(name), surfaces));
    }
    for &(spread, name) in spreads {
        // Taps and interpolated light in proportion.
        let scale = spread / base.spread.max(1e-6);
        let (tap_spread, block_spread) = (base.tap_spread * scale, base.block_spread * scale);
        let surfaces = Surfaces { spread, tap_spread, block_spread, ..base };
        all.push((format!("{id}-{name}"), format!("Surfaces, spread {spread}, m = {m}"), None, surfaces));
    }
    all
}

/// These with no lattice that is coarser than a picture of this size.
pub fn fitting(settings: Settings, (width, height): (u32, u32)) -> Settings {
    let MultiResolution { mut shading, mut rays, .. } = settings.multi_resolution;
    for lattice in [&mut shading, &mut rays] {
        lattice.coarsest = lattice.coarsest.min(width.max(height).max(1).ilog2());
    }
    Settings { multi_resolution: MultiResolution { shading, rays, ..settings.multi_resolution }, ..settings }
}

/// The paper's settings at another τa, the threshold of colour and textures. At 1 it raises those of shadows with it
/// (table 2).
pub fn paper_selective(tau_a: f32) -> Selective {
    let paper = Selective::PAPER;
    let shadows = if tau_a < 1.0 { paper.tau_psc } else { 1.0 };
    Selective { tau_col: tau_a, tau_pte: tau_a, tau_ste: tau_a, tau_psc: shadows, tau_ssc: shadows, ..paper }
}

/// The constants of all metrics times a factor.
fn scaled(w: Windowed, factor: f32) -> Windowed {
    Windowed {
        depth_scale: (w.depth_scale * factor).min(1e9),
        normal_scale: (w.normal_scale * factor).min(1e6),
        luminance_scale: (w.luminance_scale * factor).min(1e6),
        ..w
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn ids(ms: &[u32], techniques: &[&str], quick: bool) -> Vec<String> {
        plan(ms, techniques, Settings::default(), quick).into_iter().map(|p| p.id).collect()
    }

    #[test]
    fn ids_are_unique_and_fit_for_file_names() {
        for quick in [false, true] {
            let ids = ids(&[2, 4, 3], &TECHNIQUES, quick);
            assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "{ids:?}");
            let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(ids.iter().all(|id| id.chars().all(fits)), "{ids:?}");
            assert!(ids[0] == "full-m4" && ids.contains(&"windowed-m2-paper".to_owned()), "{ids:?}");
        }
        assert!(ids(&[4], &TECHNIQUES, true).len() < ids(&[4], &TECHNIQUES, false).len());
    }

    #[test]
    fn only_what_is_asked_for_is_planned() {
        assert_eq!(ids(&[2], &["full"], true), ["full-m2"]);
        assert_eq!(ids(&[2, 1], &["single"], true), ["single-m2", "single-m1"]);
        assert_eq!(ids(&[2], &["smaa", "taa"], true), ["smaa-m1", "taa-m1"]);
        assert_eq!(ids(&[2], &["msaa8x", "msaa2x"], true), ["msaa2x-m1", "msaa8x-m1"]);
    }

    #[test]
    fn selective_has_a_curve_of_its_own_and_the_papers() {
        let of = |quick| -> Vec<_> {
            let mut all = plan(&[3, 4], &["selective"], Settings::default(), quick);
            all.retain(|p| p.m == 4);
            all.iter().for_each(|p| p.settings.validate().unwrap());
            all.iter().map(|p| (p.id.clone(), p.settings.selective.tau_col)).collect()
        };
        let ids = |names: &[(&str, f32)]| names.iter().map(|&(id, tau)| (id.to_owned(), tau)).collect::<Vec<_>>();
        let own =
            [("selective-m4", 0.1), ("selective-m4-0-03", 0.03), ("selective-m4-0-3", 0.3), ("selective-m4-0-6", 0.6)];
        let paper = [("", 0.6), ("-0-1", 0.1), ("-0-3", 0.3), ("-1", 1.0)];
        let paper = paper.map(|(name, tau)| (format!("selective-m4-paper{name}"), tau));
        assert_eq!(of(false), [ids(&own), paper.to_vec()].concat());
        assert_eq!(of(true), [ids(&[own[0], own[2]]), paper[..2].to_vec()].concat());
    }

    #[test]
    fn lattices_have_a_curve_of_their_own_and_what_is_below_one_sample() {
        let of = |quick| {
            let all = plan(&[2, 3], &["multiresolution"], Settings::default(), quick);
            all.iter().for_each(|p| p.settings.validate().unwrap());
            all.into_iter().map(|p| p.id).collect::<Vec<_>>()
        };
        let ids = |names: &[&str]| names.iter().map(|name| format!("multiresolution-{name}")).collect::<Vec<_>>();
        assert_eq!(of(false), ids(&["m3", "m3-0-02", "m3-0-005", "m3-0-05", "m3-sparse", "m3-paper", "m2"]));
        assert_eq!(of(true), ids(&["m3", "m3-0-02", "m3-sparse", "m3-paper", "m2"]));
        let coarse = |size| fitting(Settings::default(), size).multi_resolution.shading.coarsest;
        assert_eq!((coarse((3, 2)), coarse((2, 4)), coarse((1, 1))), (1, 2, 0));
    }

    #[test]
    fn a_sweep_scales_all_metrics_and_stays_in_range() {
        let base = Settings::default();
        for planned in plan(&[4], &["windowed"], base, false) {
            planned.settings.validate().unwrap();
            let (w, b) = (planned.settings.windowed, base.windowed);
            if planned.preset.is_none_or(|name| name == "balanced") {
                let factor = w.depth_scale / b.depth_scale;
                assert_eq!(w.normal_scale, b.normal_scale * factor, "{}", planned.id);
                assert_eq!(w.luminance_scale, b.luminance_scale * factor, "{}", planned.id);
                assert_eq!(planned.id == "windowed-m4", factor == 1.0);
            }
        }
    }
}
