//! Texts as outlines of the one font.

use std::fmt::Write;

use ttf_parser::OutlineBuilder;

use crate::font::{FACE, advance, glyph, scale};

/// The outlines of `text` as data of an SVG path, the base line beginning at `(x, y)`.
pub(crate) fn outline(text: &str, x: f64, y: f64, size: f64) -> String {
    let mut path = Path { data: String::new(), x, y, scale: 0.0 };
    let Some(face) = &*FACE else { return path.data };
    path.scale = scale(face, size);
    for sign in text.chars() {
        let glyph = glyph(face, sign);
        face.outline_glyph(glyph, &mut path);
        path.x += f64::from(advance(face, glyph)) * path.scale;
    }
    path.data
}

struct Path {
    data: String,
    x: f64,
    y: f64,
    scale: f64,
}

impl Path {
    /// Appends a command and its points; the font counts upwards, SVG downwards.
    fn push(&mut self, command: char, points: &[(f32, f32)]) {
        self.data.push(command);
        for (x, y) in points {
            let (x, y) = (self.x + f64::from(*x) * self.scale, self.y - f64::from(*y) * self.scale);
            // Writing to a string cannot fail.
            let _ = write!(self.data, "{x:.3} {y:.3} ");
        }
    }
}

impl OutlineBuilder for Path {
    fn move_to(&mut self, x: f32, y: f32) {
        self.push('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.push('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.push('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.push('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.push('Z', &[]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::font::text_width;

    #[test]
    fn signs_of_the_field_have_pictures_and_foreign_ones_a_question_mark() {
        let face = FACE.as_ref().unwrap();
        for sign in "τωΩφθ°·²³⁻¹µ−±≤≈∫√∞Δ→ä§".chars() {
            assert!(face.glyph_index(sign).is_some(), "{sign}");
        }
        assert_eq!(outline("漢", 0.0, 0.0, 10.0), outline("?", 0.0, 0.0, 10.0));
        assert_eq!(text_width("\u{7}\n", 10.0), 0.0);
    }

    #[test]
    fn outlines_lie_on_the_base_line() {
        let path = outline("l", 5.0, 20.0, 10.0);
        assert!(path.starts_with('M') && path.ends_with('Z'), "{path}");
        assert!(path.contains(" 20.000 "), "a foot of the letter: {path}");
    }
}
