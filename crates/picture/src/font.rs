//! The one font: DejaVu Sans, reduced to Latin, Greek and the signs of formulas.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId};

pub(crate) static FACE: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../assets/sans.ttf"), 0).ok());

/// Width of `text` in the font of pictures, in the unit of `size`, the font size. Browsers that draw the same text
/// with a font of their own need rarely more, for this one is wide.
pub fn text_width(text: &str, size: f64) -> f64 {
    let Some(face) = &*FACE else { return 0.0 };
    let units: u32 = text.chars().map(|sign| u32::from(advance(face, glyph(face, sign)))).sum();
    f64::from(units) * scale(face, size)
}

/// The picture of a sign; that of `?` where the font has none.
pub(crate) fn glyph(face: &Face, sign: char) -> GlyphId {
    // Control characters have no width anywhere.
    if sign.is_control() {
        return GlyphId(0);
    }
    face.glyph_index(sign).or_else(|| face.glyph_index('?')).unwrap_or_default()
}

pub(crate) fn advance(face: &Face, glyph: GlyphId) -> u16 {
    if glyph.0 == 0 { 0 } else { face.glyph_hor_advance(glyph).unwrap_or(0) }
}

pub(crate) fn scale(face: &Face, size: f64) -> f64 {
    size / f64::from(face.units_per_em())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_dejavu_sans() {
        // Advance widths of the font: 2048 units an em, digits 1303, `W` 2025, `i` 569.
        assert!((text_width("0", 2048.0) - 1303.0).abs() < 1e-9);
        assert!((text_width("Wi", 2048.0) - 2594.0).abs() < 1e-9);
        assert_eq!(text_width("", 12.0), 0.0);
    }
}
