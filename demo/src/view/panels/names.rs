//! Names and numbers as they are written on the screen.

use super::super::renderer::{Maker, Recipe};
use crate::measure::quality::IDENTICAL_DB;
use deferred_aa::Technique;

/// What a recipe's kind does, in a line.
pub fn about(recipe: &Recipe) -> &'static str {
    match recipe.maker {
        Maker::Node => technique(recipe.settings.technique),
        Maker::Fxaa => "FXAA 3.11: blurs the edges that it finds in the finished picture of one sample a pixel",
        Maker::Smaa => "SMAA 1x: finds the shapes of edges in the finished picture of one sample a pixel",
        Maker::Taa => {
            "TAA: one sample a pixel at places that change from frame to frame, mixed with the frames before, which a \
             cut of the camera forgets"
        }
        Maker::Msaa(_) => {
            "MSAA by the hardware: draws the scene forward, lit once a triangle and pixel; for scenes without rays \
             and blending"
        }
        Maker::Reference => "what errors are measured against: see Accuracy",
    }
}

fn technique(technique: Technique) -> &'static str {
    match technique {
        Technique::Full => "shades every sample",
        Technique::Single => "shades one sample a pixel: plain deferred shading",
        Technique::Windowed => "shades as many samples of a pixel as depth, normals and luminance vary",
        Technique::Reconstructed => "shades one sample a pixel; the others take colours of their neighbours",
        Technique::Selective => {
            "splits a pixel into quadrants and shades four samples where neighbouring pixels differ by more than a \
             threshold"
        }
        Technique::MultiResolution => {
            "starts at every fourth pixel and refines, down to samples of a pixel, only where interpolation would be \
             wrong"
        }
        Technique::Surfaces => "gathers a pixel's samples into surfaces and lights each of them once",
    }
}

/// With its unit.
pub fn decibels(db: f64) -> String {
    if db >= IDENTICAL_DB { "as the reference".to_owned() } else { format!("{db:.2} dB") }
}

pub fn count(n: u64) -> String {
    match n {
        0..10_000 => n.to_string(),
        10_000..10_000_000 => format!("{:.1} k", n as f64 / 1e3),
        _ => format!("{:.1} M", n as f64 / 1e6),
    }
}

pub fn bytes(n: u64) -> String {
    format!("{:.1} MB", n as f64 / 1e6)
}
