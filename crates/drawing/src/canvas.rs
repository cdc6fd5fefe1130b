//! Elements of SVG with escaped texts.

use std::fmt::Write;

use crate::colours::{Colour, FONT, Fill};
use crate::fonts::NAME;

/// Strokes of signs, which need not be said.
pub(crate) const THIN: f64 = 1.2;

/// The text of a drawing that grows.
pub(crate) struct Canvas {
    pub out: String,
}

/// Stroke and fill of a shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Paint {
    pub colour: Colour,
    /// Of the line; 0 for none.
    pub width: f64,
    pub fill: Fill,
}

impl Paint {
    /// The attributes that say it, with a class of the element itself.
    fn attributes(self, class: &str) -> String {
        let fill = match (self.fill, self.width > 0.0) {
            (Fill::Solid, false) => "dot",
            (Fill::Solid, true) => "solid",
            (Fill::Ground, _) => "hollow",
            (Fill::Inside, _) => "inside",
            (Fill::Nothing, _) => "",
        };
        let mut out = classes(&[class, self.colour.class(), fill]);
        if self.width > 0.0 && self.width != THIN {
            let _ = write!(out, " stroke-width=\"{}\"", number(self.width));
        }
        out
    }
}

/// ` class="..."` of those that are not empty.
pub(crate) fn classes(names: &[&str]) -> String {
    let names: Vec<&str> = names.iter().copied().filter(|name| !name.is_empty()).collect();
    if names.is_empty() { String::new() } else { format!(" class=\"{}\"", names.join(" ")) }
}

impl Canvas {
    /// A drawing with its own style sheet, or without one for a page that has it. There are no `id`s in it.
    pub fn begin(width: f64, height: f64, style: Option<&str>, title: &str) -> Canvas {
        let mut canvas = Canvas { out: String::new() };
        let _ = write!(
            canvas.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"diagram\" role=\"img\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FONT}\" font-size=\"{}\" text-anchor=\"middle\">\
             <title>{}</title>",
            number(NAME),
            escaped(title)
        );
        if let Some(style) = style {
            let _ = write!(canvas.out, "<style>{style}</style>");
        }
        let _ = write!(canvas.out, "<rect class=\"ground\" width=\"{width}\" height=\"{height}\"/>");
        canvas
    }

    pub fn end(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    pub fn path(&mut self, data: &str, paint: Paint, class: &str) {
        let _ = write!(self.out, "<path{} d=\"{data}\"/>", paint.attributes(class));
    }

    /// A path around a point, turned or mirrored.
    pub fn path_at(&mut self, x: f64, y: f64, turn: &str, data: &str, paint: Paint) {
        let _ = write!(
            self.out,
            "<path{} transform=\"translate({} {}){turn}\" d=\"{data}\"/>",
            paint.attributes(""),
            number(x),
            number(y)
        );
    }

    pub fn circle(&mut self, x: f64, y: f64, r: f64, paint: Paint) {
        let _ = write!(
            self.out,
            "<circle{} cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
            paint.attributes(""),
            number(x),
            number(y),
            number(r)
        );
    }

    /// `anchor` is `start`, `middle` or `end`; `y` is the base line.
    pub fn text(&mut self, x: f64, y: f64, size: f64, anchor: &str, colour: Colour, text: &str) {
        if text.is_empty() {
            return;
        }
        let _ = write!(
            self.out,
            "<text{} x=\"{}\" y=\"{}\"",
            classes(&[colour.class(), "text"]),
            number(x),
            number(y)
        );
        if size != NAME {
            let _ = write!(self.out, " font-size=\"{}\"", number(size));
        }
        if anchor != "middle" {
            let _ = write!(self.out, " text-anchor=\"{anchor}\"");
        }
        let _ = write!(self.out, ">{}</text>", escaped(text));
    }
}

/// A number as short as a drawing needs it.
pub(crate) fn number(x: f64) -> String {
    let rounded = (x * 10.0).round() / 10.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Text in which nothing is markup; characters that XML cannot hold are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(' '),
            '\u{fffe}' | '\u{ffff}' => {}
            sign if sign.is_control() => {}
            sign => out.push(sign),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_is_markup() {
        assert_eq!(
            escaped("<script>\"a\" & 'b'\u{0}\n</script>"),
            "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39; &lt;/script&gt;"
        );
    }
}
