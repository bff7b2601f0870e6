//! A scripted run: every control through its range, on every technique, each held until its picture is there.

use super::app::App;
use super::controls::{self, Kind};
use super::renderer::Reference;
use super::state::Side;
use deferred_aa::{SettingScale, Settings, Technique};
use serde_json::{Value, json};

/// One after the other.
#[derive(Debug)]
pub struct Tour {
    steps: Vec<(Settings, String)>,
    next: usize,
    /// What was wrong, and at which step.
    pub faults: Vec<String>,
}

impl Default for Tour {
    fn default() -> Self {
        Self::new()
    }
}

impl Tour {
    /// At its beginning.
    pub fn new() -> Self {
        let mut steps = Vec::new();
        for technique in Technique::ALL {
            let base = Settings { technique, ..Side::defaults() };
            steps.push((base, format!("{technique:?}")));
            for control in controls::all().iter().filter(|c| c.path != "technique") {
                for value in values(&control.kind) {
                    match controls::with(&base, &control.path, value.clone()) {
                        Ok(settings) => steps.push((settings, format!("{technique:?}, {} = {value}", control.path))),
                        Err(e) => steps.push((base, format!("{technique:?}, {} = {value}: {e}", control.path))),
                    }
                }
            }
        }
        Self { steps, next: 0, faults: Vec::new() }
    }

    /// Steps that are done, and all.
    #[cfg(test)]
    pub fn progress(&self) -> (usize, usize) {
        (self.next, self.steps.len())
    }

    /// Goes on if the last step's picture is there; whether all is done.
    pub fn advance(&mut self, app: &mut App) -> bool {
        if let Some(why) = &app.status.failed {
            self.faults.push(why.clone());
            return true;
        }
        if self.next == 0 {
            app.kept.reference = Reference::Off;
            app.kept.split = false;
            app.edited = 0;
        } else if !app.shown_is_wanted(0) {
            return false;
        } else {
            self.look(app);
        }
        let Some((settings, _)) = self.steps.get(self.next) else { return true };
        app.sides[0].set(*settings, "tour");
        app.sync();
        self.next += 1;
        false
    }

    /// At the last step's picture.
    fn look(&mut self, app: &App) {
        let step = &self.steps[self.next - 1].1;
        let side = &app.sides[0];
        if let Some(why) = &side.refused {
            self.faults.push(format!("{step}: {why}"));
        } else if let Some(rendered) = &side.rendered {
            let bad = rendered.picture.not_finite();
            let counted = rendered.shot.statistics.not_finite;
            if bad > 0 || counted > 0 {
                self.faults.push(format!("{step}: {bad} pixels and {counted} samples are not finite"));
            }
        }
    }
}

fn values(kind: &Kind) -> Vec<Value> {
    match kind {
        Kind::Slider(range) if range.scale == SettingScale::Whole => {
            let (least, most) = (range.least as i64, range.most as i64);
            vec![json!(least), json!((least + most) / 2), json!(most)]
        }
        Kind::Slider(range) => {
            let middle = match range.scale {
                SettingScale::Logarithmic => (range.least.max(1e-4) * range.most).sqrt(),
                _ => range.least.midpoint(range.most),
            };
            [range.least, middle, range.most].map(|v| json!(v)).to_vec()
        }
        Kind::Switch => vec![json!(true), json!(false)],
        Kind::Choice(choices) => choices.iter().map(|(name, _)| json!(name)).collect(),
        Kind::Goal => vec![json!({ "error": 0.01 }), json!({ "time": 5.0 })],
    }
}
