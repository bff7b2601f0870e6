//! What becomes of the answers to dialogs, and the reports that are begun by one.

use super::dialog::{Answer, Dialog};
use crate::host::Options;
use crate::scene::{Camera, Lens};
use crate::settings_file::{self, SettingsFileError};
use crate::view::app::App;
use crate::view::renderer::Recipe;
use crate::view::report_process::Report;
use egui::{Context, Ui};
use std::path::Path;
use std::time::Duration;

impl App {
    /// Shows the dialog, if there is one, and does what it was answered.
    pub fn dialogs(&mut self, ui: &Ui) {
        let Some(mut dialog) = self.dialog.take() else { return };
        match dialog.show(ui.ctx()) {
            Answer::None => self.dialog = Some(dialog),
            Answer::Closed => {}
            Answer::Open(name) => self.open(&name),
            Answer::SaveSettings(path) => {
                let saved = settings_file::save(&path, &self.sides[self.edited].recipe.settings);
                self.said(saved.map(|()| format!("saved {}", path.display())));
            }
            Answer::LoadSettings(path) => match settings_file::load(&path) {
                Ok(settings) => {
                    self.sides[self.edited].take(Recipe::node(settings), "file");
                    self.say(format!("loaded {}", path.display()));
                }
                Err(e) => self.said::<SettingsFileError>(Err(e)),
            },
            Answer::SaveImage(path) => self.save_image(&path),
            Answer::Report(folder) => self.begin_report(&folder),
        }
    }

    /// What was done, or why not, where it is seen.
    fn said<E: std::fmt::Display>(&mut self, outcome: Result<String, E>) {
        match outcome {
            Ok(done) => self.say(done),
            Err(e) => {
                self.say(e.to_string());
                self.dialog = Some(Dialog::Trouble("That did not work".to_owned(), e.to_string()));
            }
        }
    }

    fn save_image(&mut self, path: &Path) {
        let Some(rendered) = &self.sides[self.edited].rendered else {
            return self.said::<&str>(Err("there is no picture yet"));
        };
        let exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        let picture = rendered.picture.clone();
        let saved = if exr { picture.write_exr(path) } else { picture.write_png(path) };
        self.said(saved.map(|()| format!("saved {}", path.display())));
    }

    /// The command line of a report of what is seen.
    pub fn report_arguments(&self, folder: &Path) -> Vec<String> {
        let Options { width, height, m, anisotropy, .. } = self.options;
        let mut all: Vec<String> = ["report", "--quick", "--scene"].map(str::to_owned).to_vec();
        all.push(self.scene_name().to_owned());
        if let Some(index) = self.opened.as_ref().and_then(|o| o.source.index) {
            all.extend(["--scene-index".to_owned(), index.to_string()]);
        }
        all.extend(["--size".to_owned(), format!("{width}x{height}"), "-m".to_owned(), m.to_string()]);
        if let Some(Camera { eye, target, lens: Lens::Perspective { fov_y }, .. }) = self.camera {
            let fov = fov_y.to_degrees();
            let numbers = [eye.x, eye.y, eye.z, target.x, target.y, target.z, fov].map(|v| v.to_string());
            all.extend(["--camera".to_owned(), numbers.join(",")]);
        }
        all.extend(["--stall".to_owned(), self.lights.stall.to_string()]);
        all.extend(["--anisotropy".to_owned(), anisotropy.to_string()]);
        all.extend(["--out".to_owned(), folder.to_string_lossy().into_owned()]);
        all
    }

    /// Begins a report of what is seen.
    pub fn begin_report(&mut self, folder: &Path) {
        let arguments = self.report_arguments(folder);
        match Report::begin(&arguments, folder) {
            Ok(report) => {
                self.report = Some(report);
                self.say(format!("measuring in a process of its own: {}", arguments.join(" ")));
            }
            Err(e) => self.said::<std::io::Error>(Err(e)),
        }
    }

    /// Looks whether the report has ended, and says so.
    pub fn watch_report(&mut self, ctx: &Context) {
        let Some(report) = &mut self.report else { return };
        match report.ended() {
            Ok(None) => ctx.request_repaint_after(Duration::from_millis(500)),
            Ok(Some(status)) => {
                let outcome = report.outcome(status);
                self.report = None;
                match outcome {
                    Ok(done) => self.say(done),
                    Err(why) => self.said::<String>(Err(why)),
                }
            }
            Err(e) => {
                self.report = None;
                self.said::<std::io::Error>(Err(e));
            }
        }
    }
}
