//! B. Jin, I. Ihm, B. Chang, C. Park, W. Lee, S. Jung, "Selective and Adaptive Supersampling for Real-Time Ray
//! Tracing", HPG 2009.

use super::curves::{first_curve, same_psnr};
use crate::measure::reference;
use crate::report::plan::paper_selective;
use crate::report::schema::papers::{Planned, Printed, Table};
use deferred_aa::{Enabled, Selective, Settings, Technique};

/// Samples along one side of a window that has all of a pixel's sixteen.
const M: u32 = 4;

/// PSNR and frames a second of table 2, by fixed density: 16, 9, 4 and 1 samples a pixel.
const FIXED: [(&str, [(f64, f64); 4]); 5] = [
    ("Bathroom", [(46.35, 0.79), (43.47, 1.23), (39.36, 2.36), (35.06, 6.89)]),
    ("Conference", [(47.43, 1.39), (44.48, 2.28), (40.54, 4.52), (36.43, 13.23)]),
    ("Room", [(47.61, 1.19), (44.31, 1.92), (39.76, 3.92), (35.98, 11.83)]),
    ("Kitchen", [(46.78, 1.24), (43.85, 2.01), (39.72, 4.09), (35.58, 12.53)]),
    ("Fairy Forest", [(47.22, 1.16), (43.88, 1.86), (39.19, 3.68), (35.00, 10.68)]),
];

/// Scene, PSNR, samples over those of Fixed 9, and frames a second.
type Adaptive = (&'static str, f64, f64, f64);

/// Of table 2, by τa.
const ADAPTIVE: [(&str, &[Adaptive]); 5] = [
    ("0.1", &[("Fairy Forest", 44.11, 1.065, 1.28)]),
    ("0.3", &[("Fairy Forest", 39.92, 0.286, 2.82)]),
    (
        "0.6",
        &[
            ("Bathroom", 44.03, 0.246, 2.14),
            ("Conference", 46.67, 0.198, 4.58),
            ("Room", 44.56, 0.174, 5.72),
            ("Kitchen", 44.16, 0.224, 4.46),
            ("Fairy Forest", 38.61, 0.195, 3.75),
        ],
    ),
    ("1", &[("Fairy Forest", 37.80, 0.165, 4.51)]),
    ("focused", &[("Fairy Forest", 36.05, 0.135, 5.02)]),
];

/// Of figure 7, by τcol: PSNR and samples over sixteen a pixel, by colour alone and by all attributes.
const FIGURE_7: [(f32, [(f64, f64); 2]); 4] = [
    (0.1, [(46.20, 0.2262), (46.17, 0.1575)]),
    (0.2, [(44.17, 0.1609), (45.75, 0.1306)]),
    (0.3, [(42.96, 0.1376), (45.46, 0.1220)]),
    (0.4, [(41.21, 0.1186), (45.20, 0.1183)]),
];

/// Of points beside the paper's: colour alone then reaches the PSNR of all attributes in more scenes.
const UNPRINTED_TAUS: [f32; 2] = [0.025, 0.05];

/// Of our own points, whose contrasts are about half as great.
const OUR_TAUS: [f32; FIGURE_7.len()] = [0.025, 0.05, 0.1, 0.2];

const SERIES: [&str; 2] = ["colour alone", "all attributes"];

/// Frames a second of Fixed 9, which all of table 2 is over.
fn fixed_9(scene: &str) -> Option<f64> {
    FIXED.iter().find(|(name, _)| *name == scene).map(|(_, rows)| rows[1].1)
}

fn printed(scene: &str, psnr_db: f64, samples: f64, fps: f64) -> Printed {
    let speed = fixed_9(scene).map(|nine| fps / nine);
    let (psnr_db, samples, fps) = (Some(psnr_db), Some(samples), Some(fps));
    Printed { scene: scene.to_owned(), psnr_db, samples, fps, speed, same_psnr: None }
}

fn selective(base: Settings, id: &str, label: String, selective: Selective) -> Planned {
    let rows = ADAPTIVE.iter().filter(|(name, _)| *name == id).flat_map(|(_, rows)| *rows);
    Planned {
        id: format!("selective-{}", id.replace('.', "-")),
        label,
        series: None,
        m: M,
        settings: Settings { technique: Technique::Selective, selective, ..base },
        printed: rows.map(|&(scene, db, samples, fps)| printed(scene, db, samples, fps)).collect(),
    }
}

/// Fixed densities, the paper's settings by their τa, these focused on an object, and ours.
pub fn table_2(base: Settings, focus: Option<&str>) -> Table<Planned> {
    let densities = [16.0, 9.0, 4.0, 1.0];
    let fixed = (0..4).map(|i| {
        let row = |&(scene, rows): &(&str, [(f64, f64); 4])| printed(scene, rows[i].0, densities[i] / 9.0, rows[i].1);
        fixed(base, M - i as u32, FIXED.iter().map(row).collect())
    });
    let by_tau = [0.1f32, 0.3, 0.6, 1.0]
        .map(|tau| selective(base, &tau.to_string(), format!("As in the paper, τa = {tau}"), paper_selective(tau)));
    let focused = focus.map(|on| {
        let label = format!("As in the paper, τa = 1, focused on {on}");
        selective(base, "focused", label, Selective { focused: true, ..paper_selective(1.0) })
    });
    let ours = selective(base, "ours", "Selective".to_owned(), base.selective);
    Table {
        id: "jin-2009-table-2".to_owned(),
        title: "Jin et al. 2009, Table 2".to_owned(),
        note: "The paper: ray tracing at 1024×1024 on a GTX 280, with textures, shadows, reflection and refraction; PSNR against 256 \
               samples a pixel. Ours: this scene and adapter, PSNR against this report's truth. Fixed n is Full at m = √n; what is \
               adaptive has the G-buffer of m = 4. Samples and speed are over Fixed 9. τa is the threshold of colour and textures; at 1 \
               shadows have it too."
            .to_owned(),
        over: "fixed-9".to_owned(),
        timed: true,
        sparse: false,
        rows: fixed.chain(by_tau).chain(focused).chain([ours]).collect(),
    }
}

/// Colour alone against all attributes, by the paper's settings.
pub fn figure_7(base: Settings) -> Table<Planned> {
    let point = |series: usize, i: usize| FIGURE_7[i].1[series];
    let rows = places().map(|(series, i)| (Some(SERIES[series]), point(series, i).0, point(series, i).1));
    let curve = first_curve(rows);
    let unprinted =
        UNPRINTED_TAUS.map(|tau_col| curve_row(base, 0, Selective { tau_col, ..Selective::PAPER }, Vec::new()));
    let rows = places().map(|(series, i)| {
        let (tau_col, (db, samples)) = (FIGURE_7[i].0, point(series, i));
        let same_psnr = same_psnr(&curve, Some(SERIES[series]), db, samples);
        let (psnr_db, samples) = (Some(db), Some(samples));
        let printed = Printed { scene: "Figure 7".to_owned(), psnr_db, samples, same_psnr, ..Default::default() };
        curve_row(base, series, Selective { tau_col, ..Selective::PAPER }, vec![printed])
    });
    Table {
        id: "jin-2009-figure-7".to_owned(),
        title: "Jin et al. 2009, Figure 7".to_owned(),
        note: "One threshold for colour alone, against thresholds for all attributes, at the same τcol. The paper does not print those of \
               its attributes for this figure; ours has those of its table 2. Samples are over sixteen a pixel."
            .to_owned(),
        over: "fixed-16".to_owned(),
        timed: false,
        sparse: false,
        rows: std::iter::once(fixed(base, M, Vec::new())).chain(unprinted).chain(rows).collect(),
    }
}

/// The same by our settings.
pub fn our_figure_7(base: Settings) -> Table<Planned> {
    let rows = places()
        .map(|(series, i)| curve_row(base, series, Selective { tau_col: OUR_TAUS[i], ..base.selective }, Vec::new()));
    Table {
        id: "jin-2009-figure-7-ours".to_owned(),
        title: "Figure 7, by our settings".to_owned(),
        note: "The same by the settings of Selective as they stand, whose contrast is about what a display shows."
            .to_owned(),
        over: "fixed-16".to_owned(),
        timed: false,
        sparse: false,
        rows: std::iter::once(fixed(base, M, Vec::new())).chain(rows).collect(),
    }
}

/// Of the points of both series.
fn places() -> impl Iterator<Item = (usize, usize)> + Clone {
    (0..SERIES.len()).flat_map(|series| (0..FIGURE_7.len()).map(move |i| (series, i)))
}

/// A point of a series of [`SERIES`].
fn curve_row(base: Settings, series: usize, selective: Selective, printed: Vec<Printed>) -> Planned {
    let enabled = [Enabled { col: true, ..Enabled::NONE }, selective.enabled][series];
    let (name, tau) = (SERIES[series], selective.tau_col);
    Planned {
        id: format!("{name}-{tau}").replace([' ', '.'], "-"),
        label: format!("{}, τcol = {tau}", ["Colour alone", "All attributes"][series]),
        series: Some(name.to_owned()),
        m: M,
        settings: Settings { technique: Technique::Selective, selective: Selective { enabled, ..selective }, ..base },
        printed,
    }
}

/// A row of [`Technique::Full`].
fn fixed(base: Settings, m: u32, printed: Vec<Printed>) -> Planned {
    let n = m * m;
    let (id, label) = (format!("fixed-{n}"), format!("Fixed {n}"));
    Planned { id, label, series: None, m, settings: reference::grid(base), printed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_figures_are_at_their_rows() {
        let table = table_2(Settings::default(), Some("the fairy"));
        let labels: Vec<_> = table.rows.iter().map(|r| (r.id.as_str(), r.printed.len())).collect();
        let rows = [
            ("fixed-16", 5),
            ("fixed-9", 5),
            ("fixed-4", 5),
            ("fixed-1", 5),
            ("selective-0-1", 1),
            ("selective-0-3", 1),
            ("selective-0-6", 5),
            ("selective-1", 1),
            ("selective-focused", 1),
            ("selective-ours", 0),
        ];
        assert_eq!(labels, rows);
        let conference = &table.rows[6].printed[1];
        assert_eq!(
            (conference.scene.as_str(), conference.psnr_db, conference.samples),
            ("Conference", Some(46.67), Some(0.198))
        );
        // The paper says 2 to 3 times faster than nine samples a pixel.
        assert!((conference.speed.unwrap() - 2.01).abs() < 0.005);
        assert!(table.rows[1].printed.iter().all(|p| p.speed == Some(1.0) && p.samples == Some(1.0)));
        assert_eq!(table.rows[6].settings.selective, Selective::PAPER);
        let relaxed = table.rows[7].settings.selective;
        assert_eq!((relaxed.tau_psc, relaxed.tau_ssc, relaxed.tau_poid), (1.0, 1.0, 0.05));
    }

    #[test]
    fn the_paper_saves_a_third_at_the_same_psnr() {
        let saved: Vec<_> =
            figure_7(Settings::default()).rows.iter().filter_map(|r| r.printed.first()?.same_psnr).collect();
        assert_eq!(saved.len(), 4, "{saved:?}");
        assert!(saved.iter().all(|s| (0.6..0.75).contains(s)), "{saved:?}");
    }
}
