//! What the viewer remembers from one start to the next.

use crate::files;
use crate::view::renderer::{Lights, Maker, Recipe, Reference};
use deferred_aa::Settings;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The version of the files that are written. Files of another version are not read, and the viewer starts afresh.
const VERSION: u32 = 1;

/// The most scenes that are remembered.
const MOST_RECENT: usize = 8;

/// All that is remembered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Kept {
    version: u32,
    /// Size of the window, in points.
    pub window: [f32; 2],
    /// Factor of the size of text and everything else; 1 is the size of the system.
    pub zoom: f32,
    /// Whether the theme is dark; if not given, it is that of the system.
    pub dark: Option<bool>,
    /// Pixels of the picture; if not given, it matches the window's size.
    pub size: Option<[u32; 2]>,
    /// Screen pixels along a side of a picture's pixel, where the picture matches the window's size.
    pub fill: Option<u32>,
    /// Samples along one side of a window.
    pub m: u32,
    /// The settings of the sides.
    pub settings: [Settings; 2],
    /// Who makes the pictures of the sides.
    pub makers: [Maker; 2],
    /// Whether both sides are shown.
    pub split: bool,
    /// The place of the divider, as a share of the picture's width.
    pub divider: f32,
    /// The reference that pictures are held against.
    pub reference: Reference,
    /// How often the light loop runs.
    pub stall: u32,
    /// The scenes that were opened last, the newest first.
    pub recent: Vec<String>,
}

impl Default for Kept {
    fn default() -> Self {
        let single = Settings { technique: deferred_aa::Technique::Single, ..Settings::default() };
        Self {
            version: VERSION,
            window: [1440.0, 900.0],
            zoom: 1.0,
            dark: None,
            size: None,
            fill: None,
            m: 4,
            settings: [Settings::default(), single],
            makers: [Maker::Node; 2],
            split: true,
            divider: 0.5,
            reference: Reference::Grid,
            stall: 1,
            recent: Vec::new(),
        }
    }
}

impl Kept {
    /// Remembers a scene that was opened: a file by its whole path.
    pub fn remember(&mut self, scene: &str) {
        let path = Path::new(scene);
        let whole = if path.is_file() { std::path::absolute(path).ok() } else { None };
        let name = whole.map_or(scene.to_owned(), |path| path.display().to_string());
        self.recent.retain(|other| *other != name);
        self.recent.insert(0, name);
        self.recent.truncate(MOST_RECENT);
    }

    /// The recipes of the sides as they are remembered.
    pub fn recipes(&self) -> [Recipe; 2] {
        [0, 1].map(|side| Recipe { maker: self.makers[side], settings: self.settings[side] })
    }

    /// The lights as they are remembered.
    pub fn lights(&self) -> Lights {
        Lights { stall: self.stall, count: u32::MAX, sun: None }
    }

    /// What was kept, if that is sound and of this version; why not, if a file is there.
    pub fn load(path: &Path) -> (Self, Option<String>) {
        let Ok(text) = std::fs::read_to_string(path) else { return (Self::default(), None) };
        let found = serde_json::from_str::<Self>(&text).map_err(|e| e.to_string()).and_then(Self::checked);
        match found {
            Ok(kept) => (kept, None),
            Err(e) => (Self::default(), Some(format!("{}: {e}; starting afresh", path.display()))),
        }
    }

    fn checked(self) -> Result<Self, String> {
        if self.version != VERSION {
            return Err(format!("version {}, this program reads {VERSION}", self.version));
        }
        for settings in &self.settings {
            settings.validate().map_err(|e| e.to_string())?;
        }
        let sizes = self.size.unwrap_or([1, 1]);
        let sound = (1..=deferred_aa::window::MAX_M).contains(&self.m)
            && (0.3..=4.0).contains(&self.zoom)
            && (0.0..=1.0).contains(&self.divider)
            && self.window.iter().all(|side| (100.0..=20_000.0).contains(side))
            && sizes.iter().all(|side| (1..=16_384).contains(side))
            && self.fill.is_none_or(|coarse| (1..=8).contains(&coarse))
            && self.stall >= 1;
        if sound { Ok(self) } else { Err("holds a value that is out of range".to_owned()) }
    }

    /// Writes the file, whole or not at all.
    pub fn save(&self, path: &Path) -> std::io::Result<()> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        files::write(path, (serde_json::to_string_pretty(self).unwrap_or_default() + "\n").as_bytes())
    }
}

/// The path of the file in the user's folder for settings; `None` where the system has none.
pub fn path() -> Option<PathBuf> {
    let given = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let folder = if cfg!(windows) {
        given("APPDATA")
    } else if cfg!(target_os = "macos") {
        given("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        given("XDG_CONFIG_HOME").or_else(|| given("HOME").map(|home| home.join(".config")))
    };
    folder.map(|folder| folder.join("deferred-aa").join("view.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_scenes_are_remembered_once_each() {
        let mut kept = Kept::default();
        (0..20).for_each(|i| kept.remember(["flat", "empty", "atrium"][i % 3]));
        assert_eq!(kept.recent, ["empty", "flat", "atrium"]);
        (0..20).for_each(|i| kept.remember(&i.to_string()));
        assert_eq!((kept.recent.len(), kept.recent[0].as_str()), (MOST_RECENT, "19"));
    }

    #[test]
    fn what_is_kept_comes_back_and_what_is_broken_is_named() {
        let folder = std::env::temp_dir().join(format!("deferred-aa-kept-{}", std::process::id()));
        let path = folder.join("view.json");
        assert_eq!(Kept::load(&path), (Kept::default(), None));
        let kept = Kept { m: 2, divider: 0.25, dark: Some(true), size: Some([640, 360]), ..Kept::default() };
        kept.save(&path).unwrap();
        assert_eq!(Kept::load(&path), (kept.clone(), None));
        for (broken, part) in [
            (Kept { version: 7, ..kept.clone() }, "version 7"),
            (Kept { m: 9, ..kept.clone() }, "out of range"),
            (Kept { zoom: 0.0, ..kept }, "out of range"),
        ] {
            broken.save(&path).unwrap();
            let (found, why) = Kept::load(&path);
            assert_eq!(found, Kept::default());
            assert!(why.unwrap().contains(part));
        }
        // What an earlier program wrote has less in it.
        std::fs::write(&path, r#"{"version": 1, "m": 3}"#).unwrap();
        assert_eq!(Kept::load(&path), (Kept { m: 3, ..Kept::default() }, None));
        std::fs::write(&path, "{").unwrap();
        assert!(Kept::load(&path).1.is_some_and(|why| why.contains("starting afresh")));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
