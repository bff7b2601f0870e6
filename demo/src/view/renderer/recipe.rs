//! What makes the picture of a side.

use crate::measure::reference;
use crate::peers::msaa::Samples;
use crate::peers::{AnyPeer, Peer};
use deferred_aa::{DebugView, Settings, Technique};

/// Who makes the picture of a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Maker {
    /// The node, by the settings.
    #[default]
    Node,
    /// FXAA, from the picture of one sample a pixel.
    Fxaa,
    /// SMAA, from the picture of one sample a pixel.
    Smaa,
    /// TAA, from pictures of one sample a pixel, each beside those before it.
    Taa,
    /// Hardware MSAA of forward shading.
    Msaa(Samples),
    /// The reference that errors are measured against.
    Reference,
}

impl Maker {
    /// All but the node.
    pub const OTHERS: [Self; 7] = [
        Self::Fxaa,
        Self::Smaa,
        Self::Taa,
        Self::Msaa(Samples::Two),
        Self::Msaa(Samples::Four),
        Self::Msaa(Samples::Eight),
        Self::Reference,
    ];
}

/// Who makes a picture, and with which settings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Recipe {
    /// Who makes it.
    pub maker: Maker,
    /// The settings on the controls. Others than the node take what shadows and reflections are from them.
    pub settings: Settings,
}

impl Recipe {
    /// The node with these settings.
    pub fn node(settings: Settings) -> Self {
        Self { maker: Maker::Node, settings }
    }

    /// One recipe of each kind, in the order in which they are listed.
    pub fn kinds() -> impl Iterator<Item = Self> {
        let of = |technique| Self::node(Settings { technique, ..Settings::default() });
        let others = Maker::OTHERS.into_iter().map(|maker| Self { maker, ..Self::default() });
        Technique::ALL.into_iter().map(of).chain(others)
    }

    /// The name on the screen, which is that of its kind.
    pub fn name(&self) -> String {
        match self.maker {
            Maker::Node => format!("{:?}", self.settings.technique),
            Maker::Fxaa => "FXAA".to_owned(),
            Maker::Smaa => "SMAA".to_owned(),
            Maker::Taa => "TAA".to_owned(),
            Maker::Msaa(samples) => format!("MSAA {}x", samples.count()),
            Maker::Reference => "Reference".to_owned(),
        }
    }

    /// The settings that the node records.
    pub fn recorded(&self) -> Settings {
        let plain = || reference::truth(self.settings);
        match self.maker {
            Maker::Node => self.settings,
            Maker::Fxaa | Maker::Smaa | Maker::Taa | Maker::Msaa(_) => {
                Settings { technique: Technique::Single, ..plain() }
            }
            Maker::Reference => plain(),
        }
    }

    /// What anti-aliases in place of the node.
    pub fn peer(&self) -> Option<AnyPeer> {
        match self.maker {
            Maker::Fxaa => Some(AnyPeer::Image(Peer::Fxaa)),
            Maker::Smaa => Some(AnyPeer::Image(Peer::Smaa)),
            Maker::Taa => Some(AnyPeer::Taa),
            Maker::Msaa(samples) => Some(AnyPeer::Msaa(samples)),
            Maker::Node | Maker::Reference => None,
        }
    }

    /// Whether its pictures depend on those before them.
    pub fn has_history(&self) -> bool {
        self.maker == Maker::Taa
    }

    /// Whether the scene is drawn in the passes that make the picture, and not in the G-buffer.
    pub fn is_forward(&self) -> bool {
        matches!(self.maker, Maker::Msaa(_))
    }

    /// Whether it shows an image and not a debug view, which is nothing to judge.
    pub fn is_image(&self) -> bool {
        self.recorded().view == DebugView::Image
    }
}
