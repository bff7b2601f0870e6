//! What of a technique's settings is searched.

use super::search::{Axis, two_digits};
use deferred_aa::{
    DepthMeasure, Lattice, LuminanceCurve, MultiResolution, Pattern, Preset, Selective, Settings, Statistics, Surfaces,
    Technique, Windowed,
};
use serde::Serialize;
use std::fmt::Debug;

/// Settings that can be tuned. One of them, the dial, trades samples for error most smoothly: it brings every point to
/// the floor and is no axis of the search.
pub trait Tunable: Copy + PartialEq + Debug + Serialize + 'static {
    /// On the command line.
    const TECHNIQUE: &'static str;
    /// What is searched besides the dial.
    const AXES: &'static [Axis];
    /// The least and the greatest of the dial.
    const DIAL: [f64; 2];
    /// 1 where a greater dial means more samples, −1 where it means fewer.
    const TOWARDS_MORE: f64;
    /// Where the first search begins, whatever the presets are by now, so that it finds them again.
    const START: Self;

    /// Those of the crate, where it has them.
    fn own(preset: Preset) -> Option<Self>;
    /// That try these.
    fn settings(self) -> Settings;
    /// Of the axes, unrounded.
    fn values(&self) -> Vec<f32>;
    /// These with other values of the axes.
    fn with_values(self, values: &[f64]) -> Self;
    /// Of the dial.
    fn dial(&self) -> f32;
    /// These with another dial.
    fn with_dial(self, dial: f32) -> Self;
    /// These, and others in valleys that no step leads into: the search begins in the best.
    fn starts(self) -> Vec<Self>;
    /// The choices that have no scale, one changed at a time.
    fn variants(self) -> Vec<Self>;
    /// As they stand in source.
    fn source(&self) -> String;
    /// What the search keeps low, 1 for full supersampling.
    fn cost(statistics: &Statistics) -> f64 {
        statistics.ratio
    }
}

/// The axes' values of settings, as the search has them.
pub fn values<T: Tunable>(settings: &T) -> Vec<f64> {
    settings.values().into_iter().map(|v| two_digits(f64::from(v))).collect()
}

/// `luminance_min` and `luminance_edge` that see faint edges too, and those that see strong ones alone: few samples for
/// many windows or many for few.
const FAINT: (f32, f32) = (0.01, 0.02);
const STRONG: (f32, f32) = (0.02, 0.12);

impl Tunable for Windowed {
    const TECHNIQUE: &'static str = "windowed";
    const AXES: &'static [Axis] = &[
        Axis { name: "luminance_edge", least: 0.005, most: 0.3 },
        Axis { name: "depth_scale", least: 10.0, most: 10_000.0 },
        Axis { name: "normal_scale", least: 2.0, most: 100.0 },
        Axis { name: "luminance_min", least: 0.001, most: 0.1 },
        // Textures shimmer below a half, which no error of a single frame shows.
        Axis { name: "footprint", least: 0.5, most: 1.2 },
    ];
    const DIAL: [f64; 2] = [1.0, 2000.0];
    const TOWARDS_MORE: f64 = 1.0;
    const START: Self = Self {
        depth: DepthMeasure::Discontinuity,
        depth_scale: 100.0,
        normal_scale: 12.0,
        two_sided: false,
        luminance_scale: 120.0,
        luminance_min: STRONG.0,
        luminance_edge: STRONG.1,
        luminance: LuminanceCurve::Perceptual,
        luminance_channels: true,
        luminance_centre: true,
        identity_samples: 0.0,
        shadow_samples: 8.0,
        shadow_reach: 2,
        user_scale: 0.0,
        least_samples: 1.0,
        footprint: 0.6,
        centred: true,
        edge_aware_first: true,
        tile_limit: Self::NO_TILE_LIMIT,
    };

    fn own(preset: Preset) -> Option<Self> {
        Some(preset.windowed())
    }

    fn settings(self) -> Settings {
        Settings { technique: Technique::Windowed, windowed: self, ..Default::default() }
    }

    fn values(&self) -> Vec<f32> {
        vec![self.luminance_edge, self.depth_scale, self.normal_scale, self.luminance_min, self.footprint]
    }

    fn with_values(self, values: &[f64]) -> Self {
        let &[luminance_edge, depth_scale, normal_scale, luminance_min, footprint] = values else { return self };
        Self {
            luminance_edge: luminance_edge as f32,
            depth_scale: depth_scale as f32,
            normal_scale: normal_scale as f32,
            luminance_min: luminance_min as f32,
            footprint: footprint as f32,
            ..self
        }
    }

    fn dial(&self) -> f32 {
        self.luminance_scale
    }

    fn with_dial(self, luminance_scale: f32) -> Self {
        Self { luminance_scale, ..self }
    }

    fn starts(self) -> Vec<Self> {
        let valleys = [(self.luminance_min, self.luminance_edge), FAINT, STRONG];
        valleys.map(|(luminance_min, luminance_edge)| Self { luminance_min, luminance_edge, ..self }).to_vec()
    }

    fn variants(self) -> Vec<Self> {
        let samples = [0.0, 2.0, 4.0, 8.0].map(|identity_samples| Self { identity_samples, ..self });
        let reaches = [0, 1, 2, 3].map(|shadow_reach| Self { shadow_reach, ..self });
        let centre = Self { luminance_centre: !self.luminance_centre, ..self };
        samples.into_iter().chain(reaches).chain([centre]).filter(|v| *v != self).collect()
    }

    fn source(&self) -> String {
        let fields = format!("{self:#?}");
        let fields: Vec<_> = fields.lines().filter(|line| !line.contains("tile_limit")).collect();
        let fields = fields.join("\n").replace(": Perceptual", ": LuminanceCurve::Perceptual");
        let fields = fields.replace(": Discontinuity", ": DepthMeasure::Discontinuity");
        format!("{}    tile_limit: Windowed::NO_TILE_LIMIT,\n}}", fields.trim_end_matches('}'))
    }
}

/// What is reflected and refracted has the thresholds of what is shown. Those of attributes are searched as parts of
/// colour's, which counts only where nothing differs, so that the dial turns all of them.
impl Tunable for Selective {
    const TECHNIQUE: &'static str = "selective";
    const AXES: &'static [Axis] = &[
        Axis { name: "tau_poid", least: 0.01, most: 1.0 },
        Axis { name: "tau_psn", least: 0.01, most: 1.0 },
        Axis { name: "tau_psc", least: 0.01, most: 1.0 },
        Axis { name: "tau_pte", least: 0.01, most: 1.0 },
        Axis { name: "contrast_min", least: 0.001, most: 0.1 },
        // Textures shimmer below a half, which no error of a single frame shows.
        Axis { name: "footprint", least: 0.5, most: 1.2 },
    ];
    const DIAL: [f64; 2] = [0.001, 1.0];
    const TOWARDS_MORE: f64 = -1.0;
    const START: Self = Self {
        tau_col: 0.1,
        tau_poid: 0.02,
        tau_psn: 0.02,
        tau_psc: 0.02,
        tau_pte: 0.1,
        tau_soid: 0.02,
        tau_ssn: 0.02,
        tau_ssc: 0.02,
        tau_ste: 0.1,
        curve: LuminanceCurve::Perceptual,
        contrast_min: 0.02,
        normal_cosine: 0.95,
        shadow_lights: true,
        bilinear: true,
        footprint: 0.5,
        edge_aware_first: true,
        ..Self::PAPER
    };

    fn own(preset: Preset) -> Option<Self> {
        (preset == Preset::default()).then(Self::default)
    }

    fn settings(self) -> Settings {
        Settings { technique: Technique::Selective, selective: self, ..Default::default() }
    }

    fn values(&self) -> Vec<f32> {
        let parts = [self.tau_poid, self.tau_psn, self.tau_psc, self.tau_pte].map(|tau| tau / self.tau_col);
        parts.into_iter().chain([self.contrast_min, self.footprint]).collect()
    }

    fn with_values(self, values: &[f64]) -> Self {
        let &[poid, psn, psc, pte, contrast_min, footprint] = values else { return self };
        let [poid, psn, psc, pte] = [poid, psn, psc, pte].map(|part| (part * f64::from(self.tau_col)) as f32);
        Self {
            tau_poid: poid,
            tau_psn: psn,
            tau_psc: psc,
            tau_pte: pte,
            tau_soid: poid,
            tau_ssn: psn,
            tau_ssc: psc,
            tau_ste: pte,
            contrast_min: contrast_min as f32,
            footprint: footprint as f32,
            ..self
        }
    }

    fn dial(&self) -> f32 {
        self.tau_col
    }

    fn with_dial(self, tau_col: f32) -> Self {
        let values: Vec<f64> = self.values().into_iter().map(f64::from).collect();
        Self { tau_col, ..self }.with_values(&values)
    }

    fn starts(self) -> Vec<Self> {
        vec![self]
    }

    fn variants(self) -> Vec<Self> {
        let cosines = [0.9, 0.95, 0.98].map(|normal_cosine| Self { normal_cosine, ..self });
        let others = [Self { bilinear: !self.bilinear, ..self }, Self { shadow_lights: !self.shadow_lights, ..self }];
        cosines.into_iter().chain(others).filter(|v| *v != self).collect()
    }

    fn source(&self) -> String {
        let fields = format!("{self:#?}").replace(": Perceptual", ": LuminanceCurve::Perceptual");
        fields.replace(": Color,", ": ColorReference::Color,")
    }
}

impl Tunable for MultiResolution {
    const TECHNIQUE: &'static str = "multiresolution";
    const AXES: &'static [Axis] = &[
        Axis { name: "position_threshold", least: 0.001, most: 1.0 },
        // Textures shimmer below a half, which no error of a single frame shows.
        Axis { name: "footprint", least: 0.5, most: 1.2 },
    ];
    const DIAL: [f64; 2] = [0.0005, 1.0];
    const TOWARDS_MORE: f64 = -1.0;
    const START: Self = Self {
        shading: Lattice { pattern: Pattern::Quad, coarsest: 2 },
        rays: Lattice { pattern: Pattern::Quad, coarsest: 2 },
        supersampled: true,
        color_threshold: 0.01,
        position_threshold: 0.02,
        curve: LuminanceCurve::Perceptual,
        veto: true,
        weighted: false,
        footprint: 0.5,
    };

    fn own(preset: Preset) -> Option<Self> {
        (preset == Preset::default()).then(Self::default)
    }

    fn settings(self) -> Settings {
        Settings { technique: Technique::MultiResolution, multi_resolution: self, ..Default::default() }
    }

    fn values(&self) -> Vec<f32> {
        vec![self.position_threshold, self.footprint]
    }

    fn with_values(self, values: &[f64]) -> Self {
        let &[position_threshold, footprint] = values else { return self };
        Self { position_threshold: position_threshold as f32, footprint: footprint as f32, ..self }
    }

    fn dial(&self) -> f32 {
        self.color_threshold
    }

    fn with_dial(self, color_threshold: f32) -> Self {
        Self { color_threshold, ..self }
    }

    fn starts(self) -> Vec<Self> {
        vec![self]
    }

    fn variants(self) -> Vec<Self> {
        let patterns = [Pattern::Quad, Pattern::Triangular, Pattern::Equilateral].map(|pattern| {
            let of = |lattice| Lattice { pattern, ..lattice };
            Self { shading: of(self.shading), rays: of(self.rays), ..self }
        });
        let coarsest = (0..=3).flat_map(|coarsest| {
            let of = |lattice| Lattice { coarsest, ..lattice };
            [Self { shading: of(self.shading), ..self }, Self { rays: of(self.rays), ..self }]
        });
        let others = [Self { veto: !self.veto, ..self }, Self { weighted: !self.weighted, ..self }];
        coarsest.chain(patterns).chain(others).filter(|v| *v != self).collect()
    }

    fn source(&self) -> String {
        let fields = format!("{self:#?}").replace(": Perceptual", ": LuminanceCurve::Perceptual");
        fields.replace("pattern: ", "pattern: Pattern::")
    }
}

/// The share of a sample's cost that is the reading of its material. On adapters that filter textures in hardware it is
/// far less than that of light; 0 would have every tap read.
const TAP_COST: f64 = 0.125;

impl Tunable for Surfaces {
    const TECHNIQUE: &'static str = "surfaces";
    const AXES: &'static [Axis] = &[
        Axis { name: "tap_spread", least: 0.0002, most: 0.3 },
        Axis { name: "block_spread", least: 0.0001, most: 0.1 },
        Axis { name: "block_contrast", least: 0.005, most: 0.3 },
        Axis { name: "widening", least: 0.02, most: 0.5 },
        // Textures shimmer below a half where few taps are read, which no error of a single frame shows.
        Axis { name: "footprint", least: 0.5, most: 1.2 },
    ];
    const DIAL: [f64; 2] = [0.0002, 3.0];
    const TOWARDS_MORE: f64 = -1.0;
    const START: Self = Self {
        spread: 0.02,
        groups: 8,
        taps: 16,
        first_taps: 4,
        tap_spread: 0.01,
        block_spread: 0.005,
        block_contrast: 0.03,
        shadow_reach: 2,
        surfaces: 6,
        normal_cosine: 0.95,
        plane: 0.01,
        widening: 0.25,
        footprint: 0.5,
    };

    fn own(preset: Preset) -> Option<Self> {
        Some(preset.surfaces())
    }

    fn settings(self) -> Settings {
        Settings { technique: Technique::Surfaces, surfaces: self, ..Default::default() }
    }

    fn values(&self) -> Vec<f32> {
        vec![self.tap_spread, self.block_spread, self.block_contrast, self.widening, self.footprint]
    }

    fn with_values(self, values: &[f64]) -> Self {
        let Ok([tap_spread, block_spread, block_contrast, widening, footprint]) = <[f64; 5]>::try_from(values) else {
            return self;
        };
        let [tap_spread, block_spread, block_contrast] = [tap_spread, block_spread, block_contrast].map(|v| v as f32);
        let [widening, footprint] = [widening, footprint].map(|v| v as f32);
        Self { tap_spread, block_spread, block_contrast, widening, footprint, ..self }
    }

    fn dial(&self) -> f32 {
        self.spread
    }

    fn with_dial(self, spread: f32) -> Self {
        Self { spread, ..self }
    }

    fn starts(self) -> Vec<Self> {
        vec![self]
    }

    fn variants(self) -> Vec<Self> {
        let taps = [2, 4, 8].map(|first_taps| Self { first_taps, ..self });
        let cosines = [0.9, 0.95, 0.98].map(|normal_cosine| Self { normal_cosine, ..self });
        let groups = [4, 8].map(|groups| Self { groups, ..self });
        let reaches = [1, 2, 3].map(|shadow_reach| Self { shadow_reach, ..self });
        taps.into_iter().chain(cosines).chain(groups).chain(reaches).filter(|v| *v != self).collect()
    }

    fn cost(statistics: &Statistics) -> f64 {
        let taps = statistics.ratio * f64::from(statistics.surfaces.taps) / statistics.shaded.max(1) as f64;
        TAP_COST * taps + (1.0 - TAP_COST) * statistics.ratio
    }

    fn source(&self) -> String {
        format!("{self:#?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn go_there_and_back<T: Tunable>(settings: T) {
        assert_eq!(values(&settings.with_values(&values(&settings))), values(&settings));
        let tree = serde_json::to_value(settings).unwrap();
        for (at, axis) in T::AXES.iter().enumerate() {
            assert!(tree[axis.name].is_number(), "{}", axis.name);
            let mut moved = values(&settings);
            moved[at] = if moved[at] == axis.most { axis.least } else { axis.most };
            assert_eq!(values(&settings.with_values(&moved)), moved, "{}", axis.name);
            assert_ne!(settings.with_values(&moved), settings, "{}", axis.name);
        }
        for dial in T::DIAL {
            let turned = settings.with_dial(dial as f32);
            assert_eq!((turned.dial(), values(&turned)), (dial as f32, values(&settings)));
            assert_eq!(turned.settings().validate(), Ok(()));
        }
    }

    #[test]
    fn values_and_dials_go_there_and_back() {
        go_there_and_back(Windowed::default());
        go_there_and_back(Windowed::START);
        go_there_and_back(Selective::default());
        go_there_and_back(Selective::START);
        go_there_and_back(MultiResolution::default());
        go_there_and_back(MultiResolution::START);
        go_there_and_back(Surfaces::default());
        go_there_and_back(Surfaces::START);
    }

    fn differ_by_one_choice<T: Tunable>(settings: T, count: usize) {
        let all = settings.variants();
        assert_eq!(all.len(), count);
        for v in all {
            assert_ne!(v, settings);
            assert_eq!(v.settings().validate(), Ok(()));
        }
    }

    #[test]
    fn every_variant_is_sound_and_another() {
        differ_by_one_choice(Windowed::default(), 7);
        differ_by_one_choice(Selective::default(), 4);
        differ_by_one_choice(MultiResolution::default(), 10);
        differ_by_one_choice(Surfaces::default(), 7);
    }

    #[test]
    fn source_is_rust() {
        let windowed = Windowed { luminance_scale: 83.0, ..Windowed::default() }.source();
        for line in [
            "Windowed {\n    depth: DepthMeasure::Discontinuity,\n",
            "    luminance_scale: 83.0,\n",
            "    luminance: LuminanceCurve::Perceptual,\n",
            "    tile_limit: Windowed::NO_TILE_LIMIT,\n}",
        ] {
            assert!(windowed.contains(line), "{line} is not in {windowed}");
        }
        let selective = Selective { tau_col: 0.07, ..Selective::default() }.source();
        for line in [
            "Selective {\n    tau_col: 0.07,\n",
            "    enabled: Enabled {\n        col: true,\n",
            "    reference: ColorReference::Color,\n    curve: LuminanceCurve::Perceptual,\n",
        ] {
            assert!(selective.contains(line), "{line} is not in {selective}");
        }
        let lattices = MultiResolution::PAPER.source();
        for line in [
            "MultiResolution {\n    shading: Lattice {\n        pattern: Pattern::Triangular,\n        coarsest: 2,\n    },\n",
            "    curve: LuminanceCurve::Perceptual,\n",
        ] {
            assert!(lattices.contains(line), "{line} is not in {lattices}");
        }
    }
}
