//! Elements of SVG with escaped texts.

use std::fmt::Write;

use blocksim_block::physical::Domain;
use blocksim_plot::{Palette, Theme};

/// Font of all texts; the last one is what pictures in PNG are drawn with.
const FONT: &str = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";

/// Colours of a drawing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Colours {
    pub ground: &'static str,
    pub ink: &'static str,
    pub quiet: &'static str,
    /// Inside of subsystems.
    pub inside: &'static str,
    series: [&'static str; 6],
}

impl Colours {
    pub fn of(theme: Theme) -> Colours {
        let Palette { ground, text, quiet, grid, series, .. } = Palette::of(theme);
        let inside = match theme {
            Theme::Light => "#F1F5F9",
            Theme::Dark => grid,
        };
        Colours { ground, ink: text, quiet, inside, series }
    }

    pub fn domain(&self, domain: Option<Domain>) -> &'static str {
        match domain {
            None => self.ink,
            Some(Domain::Frame) => self.series[0],
            Some(Domain::ThreePhase) => self.series[1],
            Some(Domain::Rotational) => self.series[2],
            Some(Domain::Electrical) => self.series[4],
            Some(Domain::Translational) => self.series[5],
        }
    }
}

/// The text of a drawing that grows.
pub(crate) struct Canvas {
    pub out: String,
    pub colours: Colours,
}

/// Stroke and fill of a shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Paint {
    pub stroke: &'static str,
    pub width: f64,
    pub fill: &'static str,
}

impl Canvas {
    pub fn begin(width: f64, height: f64, theme: Theme, title: &str) -> Canvas {
        let colours = Colours::of(theme);
        let mut canvas = Canvas { out: String::new(), colours };
        let _ = write!(
            canvas.out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"diagram\" role=\"img\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FONT}\"><title>{}</title>\
             <rect class=\"ground\" width=\"{width}\" height=\"{height}\" fill=\"{}\"/>",
            escaped(title),
            colours.ground
        );
        canvas
    }

    pub fn end(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    pub fn path(&mut self, data: &str, paint: Paint, class: &str) {
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        let _ = write!(
            self.out,
            "<path{class} d=\"{data}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\"/>",
            paint.fill,
            paint.stroke,
            number(paint.width)
        );
    }

    pub fn circle(&mut self, x: f64, y: f64, r: f64, paint: Paint) {
        let _ = write!(
            self.out,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{}\"/>",
            number(x),
            number(y),
            number(r),
            paint.fill,
            paint.stroke,
            number(paint.width)
        );
    }

    /// `anchor` is `start`, `middle` or `end`; `y` is the base line.
    pub fn text(&mut self, x: f64, y: f64, size: f64, anchor: &str, colour: &str, text: &str) {
        if text.is_empty() {
            return;
        }
        let _ = write!(
            self.out,
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{}</text>",
            number(x),
            number(y),
            number(size),
            escaped(text)
        );
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
