//! What is asked for in a window of its own. Files are chosen in a list of ours: the system's dialogs need a desktop's
//! services, which a bare X server has not.

use crate::scene::builtin;
use crate::view::panels::labelled;
use egui::{Align2, Context, Key, Ui};
use std::path::{Path, PathBuf};

/// What is asked for in a window of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Dialog {
    /// A path.
    File(FileDialog),
    /// A title and what went wrong.
    Trouble(String, String),
    /// The list of keys.
    Keys,
}

/// The purpose of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Open,
    SaveSettings,
    LoadSettings,
    SaveImage,
    Report,
}

/// A path, typed or chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct FileDialog {
    purpose: Purpose,
    path: String,
    /// Asked once before a file is overwritten.
    overwrites: bool,
    /// It has the keyboard.
    focused: bool,
}

/// What came of a dialog.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// Nothing yet.
    None,
    /// Nothing.
    Closed,
    /// A scene's name or path.
    Open(String),
    /// Settings are to be saved here.
    SaveSettings(PathBuf),
    /// Settings are to be loaded from here.
    LoadSettings(PathBuf),
    /// The picture is to be saved here.
    SaveImage(PathBuf),
    /// A report is to be made in this folder.
    Report(PathBuf),
}

fn file(purpose: Purpose, path: impl Into<String>) -> Dialog {
    Dialog::File(FileDialog { purpose, path: path.into(), overwrites: false, focused: false })
}

/// Asks for a scene, beginning beside the present one.
pub fn open(present: &str) -> Dialog {
    let folder = Path::new(present).parent().filter(|p| p.is_dir() && !p.as_os_str().is_empty());
    file(Purpose::Open, folder.map_or(String::new(), |p| format!("{}/", p.display())))
}

/// Asks where settings go.
pub fn save_settings() -> Dialog {
    file(Purpose::SaveSettings, "settings.json")
}

/// Asks where settings come from.
pub fn load_settings() -> Dialog {
    file(Purpose::LoadSettings, "settings.json")
}

/// Asks where the picture goes.
pub fn save_image() -> Dialog {
    file(Purpose::SaveImage, "image.png")
}

/// Asks where a report goes.
pub fn report() -> Dialog {
    file(Purpose::Report, "report")
}

/// What keys do.
const KEYS: [(&str, &str); 23] = [
    ("W A S D, Q E", "fly; with Shift faster"),
    ("drag on the picture", "look around"),
    ("wheel", "fly ahead and back; with Ctrl narrow or widen the view"),
    ("Home", "the scene's own view"),
    ("Alt+drag, O", "turn around what is looked at; O: every drag does, or none"),
    ("F", "frame the object under the pointer"),
    ("L", "lock the camera"),
    ("Space", "flip between the sides"),
    ("B", "both sides with a divider, or one"),
    ("[ ]", "move the divider"),
    ("arrows, right drag", "move a picture that is larger than its place"),
    ("Z", "magnifier"),
    ("X", "where the picture is wrong"),
    ("P", "without the panel, or with it"),
    ("T", "without the buttons over the picture, or with them"),
    ("1 2 3", "image, samples, what decided them"),
    ("Ctrl+O", "open a scene"),
    ("Ctrl+S", "save the settings"),
    ("Ctrl+Z, Ctrl+Y", "undo and redo, of the side whose controls are shown"),
    ("Tab, Shift+Tab", "from control to control"),
    ("Left, Right", "move the slider that has the focus"),
    ("Ctrl+plus, Ctrl+minus", "larger and smaller text"),
    ("Esc", "close a window or a list; leave a control"),
];

impl Dialog {
    /// Shows it, and says what came of it.
    pub fn show(&mut self, ctx: &Context) -> Answer {
        let mut open = true;
        let title = match self {
            Self::File(dialog) => dialog.title().to_owned(),
            Self::Trouble(title, _) => title.clone(),
            Self::Keys => "Keys".to_owned(),
        };
        let window = egui::Window::new(title).open(&mut open).collapsible(false);
        let window = if matches!(self, Self::File(_)) { window } else { window.auto_sized() };
        let shown = window.anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| match self {
            Self::File(dialog) => dialog.show(ui),
            Self::Trouble(_, why) => {
                ui.set_max_width(520f32.min(ui.ctx().content_rect().width() - 40.0));
                ui.label(why.as_str());
                let close = ui.button("Close");
                close.request_focus();
                if close.clicked() { Answer::Closed } else { Answer::None }
            }
            Self::Keys => {
                let room = (ui.ctx().content_rect().height() - 80.0).max(100.0);
                egui::ScrollArea::vertical().max_height(room).show(ui, |ui| {
                    ui.set_width(460f32.min(ui.ctx().content_rect().width() - 40.0));
                    for (key, what) in KEYS {
                        labelled(ui, key, |ui| ui.add(egui::Label::new(what).wrap()));
                    }
                });
                Answer::None
            }
        });
        let answer = shown.and_then(|shown| shown.inner).unwrap_or(Answer::None);
        if open { answer } else { Answer::Closed }
    }
}

impl FileDialog {
    fn title(&self) -> &'static str {
        match self.purpose {
            Purpose::Open => "Open a scene",
            Purpose::SaveSettings => "Save settings",
            Purpose::LoadSettings => "Load settings",
            Purpose::SaveImage => "Save the picture, .png or .exr",
            Purpose::Report => "Report into a folder",
        }
    }

    fn extensions(&self) -> &'static [&'static str] {
        match self.purpose {
            Purpose::Open => &["gltf", "glb"],
            Purpose::SaveSettings | Purpose::LoadSettings => &["json"],
            Purpose::SaveImage => &["png", "exr"],
            Purpose::Report => &[],
        }
    }

    fn show(&mut self, ui: &mut Ui) -> Answer {
        ui.set_width(520f32.min(ui.ctx().content_rect().width() - 40.0));
        if self.purpose == Purpose::Open {
            ui.label("Built in:");
            let mut chosen = None;
            ui.horizontal_wrapped(|ui| {
                for name in builtin::NAMES {
                    if ui.button(name).clicked() {
                        chosen = Some(name);
                    }
                }
            });
            if let Some(name) = chosen {
                return Answer::Open(name.to_owned());
            }
            ui.label("Or a .gltf or .glb file:");
        }
        let edit = ui.add(egui::TextEdit::singleline(&mut self.path).desired_width(f32::INFINITY));
        if !std::mem::replace(&mut self.focused, true) {
            edit.request_focus();
        }
        if edit.changed() {
            self.overwrites = false;
        }
        let entered = edit.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        self.list(ui);
        let mut answer = Answer::None;
        ui.horizontal(|ui| {
            let verb = match (self.purpose, self.overwrites) {
                (_, true) => "Overwrite",
                (Purpose::Open | Purpose::LoadSettings, _) => "Open",
                (Purpose::Report, _) => "Measure",
                _ => "Save",
            };
            let can = !self.path.trim().is_empty();
            if ui.add_enabled(can, egui::Button::new(verb)).clicked() || (entered && can) {
                answer = self.answer();
            }
            if ui.button("Cancel").clicked() {
                answer = Answer::Closed;
            }
            if self.overwrites {
                ui.colored_label(ui.visuals().warn_fg_color, "This file is there already.");
            }
        });
        answer
    }

    fn answer(&mut self) -> Answer {
        let path = PathBuf::from(self.path.trim());
        let writes = matches!(self.purpose, Purpose::SaveSettings | Purpose::SaveImage);
        if writes && path.exists() && !self.overwrites {
            self.overwrites = true;
            return Answer::None;
        }
        match self.purpose {
            Purpose::Open => Answer::Open(self.path.trim().to_owned()),
            Purpose::SaveSettings => Answer::SaveSettings(path),
            Purpose::LoadSettings => Answer::LoadSettings(path),
            Purpose::SaveImage => Answer::SaveImage(path),
            Purpose::Report => Answer::Report(path),
        }
    }

    /// The folder that the path is in: its folders, and its files of the kind that is asked for.
    fn list(&mut self, ui: &mut Ui) {
        let typed = Path::new(&self.path);
        let folder = if self.path.is_empty() || self.path.ends_with(['/', '\\']) {
            typed
        } else {
            typed.parent().unwrap_or(typed)
        };
        let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() };
        let found = entries(&folder, self.extensions());
        egui::ScrollArea::vertical().max_height(260.0).auto_shrink([false, true]).show(ui, |ui| match found {
            Ok(entries) => {
                if ui.selectable_label(false, "../").clicked() {
                    self.path = format!("{}/", folder.join("..").display());
                }
                for (name, is_folder) in entries {
                    let text = if is_folder { format!("{name}/") } else { name.clone() };
                    if ui.selectable_label(false, text.as_str()).clicked() {
                        self.path = folder.join(text).display().to_string();
                        self.overwrites = false;
                    }
                }
            }
            Err(e) => drop(ui.weak(format!("{}: {e}", folder.display()))),
        });
    }
}

/// Folders first, by name; hidden ones are left out. The second is whether it is one.
fn entries(folder: &Path, extensions: &[&str]) -> std::io::Result<Vec<(String, bool)>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_folder = entry.path().is_dir();
        let extension = Path::new(&name).extension().map(|e| e.to_string_lossy().to_lowercase());
        let fits = is_folder || extension.is_some_and(|e| extensions.contains(&e.as_str()));
        if fits && !name.starts_with('.') {
            found.push((name, is_folder));
        }
    }
    found.sort_by_key(|(name, is_folder)| (!is_folder, name.to_lowercase()));
    Ok(found)
}
