//! Text of a strip: its fonts, and how it fits into a column.

use ab_glyph::{Font, FontRef, ScaleFont};

/// A font with its size in pixels.
#[derive(Clone, Copy)]
pub struct Type {
    pub font: &'static [u8],
    pub pixels: f32,
}

pub const HEADING: Type = Type { font: epaint_default_fonts::UBUNTU_LIGHT, pixels: 19.0 };

pub const TITLE: Type = Type { font: epaint_default_fonts::UBUNTU_LIGHT, pixels: 27.0 };

pub const CAPTION: Type = Type { font: epaint_default_fonts::HACK_REGULAR, pixels: 15.0 };

impl Type {
    pub fn font(self) -> impl Font {
        FontRef::try_from_slice(self.font).expect("the embedded font is whole")
    }

    /// Every printable character with its glyph and where it begins, and where the text ends.
    pub fn lay_out(self, font: &impl Font, text: &str) -> (Vec<(ab_glyph::GlyphId, f32)>, f32) {
        let scaled = font.as_scaled(self.pixels);
        let (mut glyphs, mut x, mut last) = (Vec::new(), 0.0, None);
        for c in text.chars().filter(|c| !c.is_control()) {
            let glyph = font.glyph_id(c);
            x += last.map_or(0.0, |last| scaled.kern(last, glyph));
            glyphs.push((glyph, x));
            x += scaled.h_advance(glyph);
            last = Some(glyph);
        }
        (glyphs, x)
    }

    pub fn width(self, text: &str) -> u32 {
        self.lay_out(&self.font(), text).1.ceil() as u32
    }
}

/// `text`, cut and ended with an ellipsis where it is wider than `room`.
pub fn fitted(text: &str, style: Type, room: u32) -> String {
    if style.width(text) <= room {
        return text.to_owned();
    }
    let mut cut: Vec<char> = text.chars().collect();
    loop {
        if cut.pop().is_none() {
            return String::new();
        }
        let shorter = format!("{}…", cut.iter().collect::<String>().trim_end());
        if style.width(&shorter) <= room {
            return shorter;
        }
    }
}

/// The figures of a caption in lines of at most `room` pixels.
pub fn wrap(caption: &str, room: u32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for figure in caption.split("  ").map(str::trim).filter(|f| !f.is_empty()) {
        if let Some(last) = lines.last_mut() {
            let longer = format!("{last}  {figure}");
            if CAPTION.width(&longer) <= room {
                *last = longer;
                continue;
            }
        }
        lines.push(fitted(figure, CAPTION, room));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_break_between_figures() {
        assert_eq!(wrap("k 4.1  25.6 %   43.2 dB", 1000), ["k 4.1  25.6 %  43.2 dB"]);
        let lines = wrap("k 4.1  25.6 %  43.2 dB  812 ms", 150);
        assert_eq!(lines.join("  "), "k 4.1  25.6 %  43.2 dB  812 ms");
        assert!(lines.len() == 2 && lines.iter().all(|l| CAPTION.width(l) <= 150), "{lines:?}");
        assert!(fitted("Reconstructed", TITLE, 60).ends_with('…'));
        assert_eq!(fitted("Reconstructed", TITLE, 1), "");
    }
}
