//! Curves and marks in a plane, such as that of complex numbers, as text in SVG.

use std::fmt::Write;

use crate::{Palette, Theme, text_width};
use blocksim_numbers::ticks::{Range, labels};

use super::figure::{Line, Style};
use super::frame::Area;
use super::legend::{ROW, SAMPLE, SIZE, fitted};
use super::straighten::straightened;
use super::svg::{ERROR, FONT, MARGIN, NUMBER, PER_X_TICK, PER_Y_TICK, TITLE, escaped, round};

/// Room below the plot for the numbers and the name of the axis, dots.
const FOOT: f64 = 34.0;
/// Half of the size of a mark, dots.
const MARK: f64 = 4.2;

/// Curves over two axes of numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plane {
    /// Line above all; empty for none.
    pub title: String,
    /// Names of the axes, the horizontal one first.
    pub axes: (String, String),
    /// What is to be seen at least: from and to across, from and to upwards.
    pub range: [f64; 4],
    /// Whether a unit is as long upwards as across, so that circles are round; more is then seen of one axis.
    pub equal: bool,
    /// Width of the whole and height of the plot, dots.
    pub size: (f64, f64),
    /// Curves; what leaves the plot is cut off.
    pub lines: Vec<Line>,
    /// Marks at points, over the curves.
    pub marks: Vec<Mark>,
    /// Small texts beside points.
    pub labels: Vec<Label>,
}

/// A mark at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Where.
    pub at: (f64, f64),
    /// How it looks.
    pub sign: Sign,
    /// Number of its colour; none for that of texts.
    pub colour: Option<usize>,
    /// Its name in the legend; none is shown for an empty one, or one that is there already.
    pub name: String,
}

/// How a mark looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// A pole.
    Cross,
    /// A zero.
    Ring,
    /// A point that matters, such as the critical one.
    Plus,
    /// A point of a curve.
    Dot,
    /// The direction of a curve, towards this point.
    Arrow((f64, f64)),
}

/// A small text, to the right of a point and above it.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Where.
    pub at: (f64, f64),
    /// What it says.
    pub text: String,
}

/// The plane as a drawing in SVG 1.1 with literal colours. Texts are escaped.
pub fn plane_svg(plane: &Plane, theme: Theme) -> String {
    let palette = Palette::of(theme);
    let (width, height) = plane.size;
    let head = MARGIN + if plane.title.is_empty() { 0.0 } else { TITLE + 12.0 };
    let names = legend(plane, width - 2.0 * MARGIN);
    let rows = names.last().map_or(0, |entry| entry.1 + 1) as f64;
    let top = head + rows * ROW + 18.0;
    // The numbers of the vertical axis depend on what is seen, which depends on the room they leave.
    let gutter = {
        let (_, y) = seen(plane, width - 2.0 * MARGIN - 60.0);
        let widest = ticks(&y, height, PER_Y_TICK).into_iter().map(|(_, label)| text_width(&label, NUMBER));
        widest.fold(0.0, f64::max) + 10.0
    };
    let area = Area { x: MARGIN + gutter, y: top, width: width - 2.0 * MARGIN - gutter - 6.0, height };
    let (across, upwards) = seen(plane, area.width);
    let mut pen = Pen { out: String::new(), palette, area, across, upwards };
    pen.axes(&plane.axes);
    pen.inside(plane);
    let names: Vec<(Entry, f64, f64)> = names
        .into_iter()
        .map(|(entry, row, x)| (entry, MARGIN + x, head + row as f64 * ROW + 10.0))
        .collect();
    names.iter().for_each(|(entry, x, y)| pen.name(entry, *x, *y));
    let total = (area.bottom() + FOOT + MARGIN).ceil();
    let title = if plane.title.is_empty() { "Complex plane" } else { &plane.title };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {total}\" width=\"{width}\" height=\"{total}\" \
         font-family=\"{FONT}\" role=\"img\">\n<title>{}</title>\n<desc>{}</desc>\n\
         <rect width=\"{width}\" height=\"{total}\" fill=\"{}\"/>\n",
        escaped(title),
        escaped(&format!("{} over {}", plane.axes.1, plane.axes.0)),
        palette.ground
    );
    if !plane.title.is_empty() {
        let _ = writeln!(
            out,
            "<text x=\"{MARGIN}\" y=\"{}\" font-size=\"{}\" font-weight=\"bold\" fill=\"{}\">{}</text>",
            MARGIN + TITLE,
            TITLE + 2.0,
            palette.text,
            escaped(&fitted(&plane.title, TITLE + 2.0, width - 2.0 * MARGIN))
        );
    }
    out.push_str(&pen.out);
    out.push_str("</svg>\n");
    out
}

/// What has a name: a line or a mark.
enum Entry<'p> {
    Line(&'p Line),
    Mark(&'p Mark),
}

impl Entry<'_> {
    fn name(&self) -> &str {
        match self {
            Entry::Line(line) => &line.name,
            Entry::Mark(mark) => &mark.name,
        }
    }
}

/// What has a name, once each, with its row and its place in it.
fn legend(plane: &Plane, width: f64) -> Vec<(Entry<'_>, usize, f64)> {
    let all = plane.lines.iter().map(Entry::Line).chain(plane.marks.iter().map(Entry::Mark));
    let mut placed: Vec<(Entry, usize, f64)> = Vec::new();
    let (mut x, mut row) = (0.0, 0);
    for entry in all.filter(|entry| !entry.name().is_empty()) {
        if placed.iter().any(|known| known.0.name() == entry.name()) {
            continue;
        }
        let wide = SAMPLE + 5.0 + text_width(entry.name(), SIZE) + 14.0;
        if x > 0.0 && x + wide > width {
            (x, row) = (0.0, row + 1);
        }
        placed.push((entry, row, x));
        x += wide;
    }
    placed
}

/// What is seen of both axes, in a plot of this width.
fn seen(plane: &Plane, width: f64) -> (Range, Range) {
    let of = |from: f64, to: f64| Range::of([from, to].into_iter()).unwrap_or(Range { low: -1.0, high: 1.0 });
    let (x, y) = (of(plane.range[0], plane.range[1]), of(plane.range[2], plane.range[3]));
    if !plane.equal {
        return (x, y);
    }
    let dot = ((x.high - x.low) / width).max((y.high - y.low) / plane.size.1);
    let around = |range: Range, dots: f64| {
        let (middle, half) = (range.low / 2.0 + range.high / 2.0, dot * dots / 2.0);
        of(middle - half, middle + half)
    };
    (around(x, width), around(y, plane.size.1))
}

fn ticks(range: &Range, dots: f64, each: f64) -> Vec<(f64, String)> {
    let step = range.step((dots / each).max(2.0) as usize);
    let ticks = range.ticks(step);
    let labels = labels(&ticks, step);
    ticks.into_iter().zip(labels).collect()
}

struct Pen {
    out: String,
    palette: Palette,
    area: Area,
    across: Range,
    upwards: Range,
}

impl Pen {
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.area.across(&self.across, x), self.area.down(&self.upwards, y))
    }

    /// Grid, numbers, names and frame; the axes of zero stand out.
    fn axes(&mut self, (across, upwards): &(String, String)) {
        let Palette { grid, frame, quiet, .. } = self.palette;
        let Area { x, y, width, height } = self.area;
        let (bottom, right) = (self.area.bottom(), self.area.right());
        let mut ruling = String::new();
        for (value, label) in ticks(&self.across, width, PER_X_TICK) {
            let at = self.area.across(&self.across, value);
            let _ = write!(ruling, "M{} {}V{}", round(at), round(y), round(bottom));
            self.text((at, bottom + 14.0), NUMBER, quiet, " text-anchor=\"middle\"", &label);
        }
        for (value, label) in ticks(&self.upwards, height, PER_Y_TICK) {
            let at = self.area.down(&self.upwards, value);
            let _ = write!(ruling, "M{} {}H{}", round(x), round(at), round(right));
            self.text((x - 5.0, at + 3.5), NUMBER, quiet, " text-anchor=\"end\"", &label);
        }
        let _ = writeln!(self.out, "<path d=\"{ruling}\" stroke=\"{grid}\" fill=\"none\"/>");
        let mut zero = String::new();
        let (left, up) = self.place((0.0, 0.0));
        if (x..=right).contains(&left) {
            let _ = write!(zero, "M{} {}V{}", round(left), round(y), round(bottom));
        }
        if (y..=bottom).contains(&up) {
            let _ = write!(zero, "M{} {}H{}", round(x), round(up), round(right));
        }
        let _ = writeln!(self.out, "<path d=\"{zero}\" stroke=\"{frame}\" fill=\"none\"/>");
        self.text((x + width / 2.0, bottom + 28.0), NUMBER, quiet, " text-anchor=\"middle\"", across);
        self.text((x, y - 6.0), NUMBER, quiet, "", upwards);
        let [x, y, width, height] = [x, y, width, height].map(round);
        let _ = writeln!(
            self.out,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"{frame}\"/>"
        );
    }

    /// Curves, marks and labels, cut off at the frame.
    fn inside(&mut self, plane: &Plane) {
        let Area { x, y, width, height } = self.area;
        let [x, y, width, height] = [x, y, width, height].map(round);
        let _ = writeln!(
            self.out,
            "<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{x} {y} {width} {height}\" \
             stroke-linejoin=\"round\">"
        );
        for line in &plane.lines {
            let mut data = String::new();
            for course in &line.courses {
                let dots = straightened(course.iter().map(|&point| self.place(point)), ERROR);
                for (n, (x, y)) in dots.into_iter().enumerate() {
                    let _ = write!(data, "{}{} {}", if n == 0 { 'M' } else { 'L' }, round(x), round(y));
                }
            }
            self.stroke(&data, line);
        }
        for mark in &plane.marks {
            let at = self.place(mark.at);
            let towards = match mark.sign {
                Sign::Arrow(end) => self.place(end),
                _ => at,
            };
            self.mark(mark, at, towards);
        }
        for label in &plane.labels {
            let (x, y) = self.place(label.at);
            // What would be cut off at the right or at the top stands on the other side.
            let wide = text_width(&label.text, NUMBER) + 8.0;
            let (dx, anchor) =
                if x + wide > self.area.right() { (-5.0, " text-anchor=\"end\"") } else { (5.0, "") };
            let dy = if y < self.area.y + 16.0 { 12.0 } else { -4.0 };
            let quiet = self.palette.quiet;
            self.text((x + dx, y + dy), NUMBER, quiet, anchor, &label.text);
        }
        self.out.push_str("</svg>\n");
    }

    fn colour(&self, number: Option<usize>) -> &'static str {
        number.map_or(self.palette.text, |number| self.palette.series[number % self.palette.series.len()])
    }

    fn stroke(&mut self, data: &str, line: &Line) {
        let colour = self.colour(Some(line.colour));
        let width = if line.thin { 1.0 } else { 1.7 };
        let (colour, width, dashes) = match line.style {
            Style::Solid => (colour, width, ""),
            Style::Dashed => (colour, 1.1, " stroke-dasharray=\"6 4\""),
            Style::Dotted => (colour, width, " stroke-dasharray=\"1.5 3\""),
            Style::Limit => (self.palette.quiet, 1.0, " stroke-dasharray=\"2 3\""),
        };
        let _ = writeln!(
            self.out,
            "<path d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>"
        );
    }

    fn mark(&mut self, mark: &Mark, (x, y): (f64, f64), towards: (f64, f64)) {
        let colour = self.colour(mark.colour);
        let (x, y, r) = (round(x), round(y), MARK);
        let line = |data: String| {
            format!("<path d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.7\"/>\n")
        };
        let shape = match mark.sign {
            Sign::Cross => line(format!("M{x} {y}m-{r} -{r}l{0} {0}m0 -{0}l-{0} {0}", 2.0 * r)),
            Sign::Plus => line(format!("M{x} {y}m-{0} 0h{1}m-{0} -{0}v{1}", r + 1.0, 2.0 * r + 2.0)),
            Sign::Ring => format!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.7\"/>\n"
            ),
            Sign::Dot => format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"2.6\" fill=\"{colour}\"/>\n"),
            Sign::Arrow(_) => {
                let (dx, dy) = (towards.0 - x, towards.1 - y);
                let length = dx.hypot(dy);
                if length == 0.0 || !length.is_finite() {
                    return;
                }
                let (dx, dy) = (dx / length * 7.0, dy / length * 7.0);
                let [ax, ay] = [x + dx, y + dy].map(round);
                let corners = [x - 0.55 * dy, y + 0.55 * dx, x + 0.55 * dy, y - 0.55 * dx].map(round);
                let [bx, by, cx, cy] = corners;
                format!("<path d=\"M{ax} {ay}L{bx} {by}L{cx} {cy}Z\" fill=\"{colour}\"/>\n")
            }
        };
        self.out.push_str(&shape);
    }

    /// An entry of the legend.
    fn name(&mut self, entry: &Entry, x: f64, y: f64) {
        let middle = (x + SAMPLE / 2.0, y - 4.0);
        match entry {
            Entry::Line(line) => {
                self.stroke(&format!("M{} {}H{}", round(x), round(y - 4.0), round(x + SAMPLE)), line);
            }
            Entry::Mark(mark) => self.mark(mark, middle, (middle.0 + 1.0, middle.1)),
        }
        let text = self.palette.text;
        self.text((x + SAMPLE + 5.0, y), SIZE, text, "", entry.name());
    }

    fn text(&mut self, at: (f64, f64), size: f64, colour: &str, more: &str, text: &str) {
        let _ = writeln!(
            self.out,
            "<text x=\"{}\" y=\"{}\" font-size=\"{size}\" fill=\"{colour}\"{more}>{}</text>",
            round(at.0),
            round(at.1),
            escaped(text)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane() -> Plane {
        Plane {
            title: "Plane <of> z".to_owned(),
            axes: ("real".to_owned(), "imaginary".to_owned()),
            range: [-1.0, 1.0, -1.0, 1.0],
            equal: true,
            size: (720.0, 400.0),
            lines: vec![Line {
                name: "circle".to_owned(),
                courses: vec![(0..=200).map(|k| (0.0314159 * f64::from(k)).sin_cos()).collect()],
                ..Line::default()
            }],
            marks: vec![
                Mark { at: (0.5, 0.5), sign: Sign::Cross, colour: Some(1), name: "pole".to_owned() },
                Mark { at: (0.5, -0.5), sign: Sign::Cross, colour: Some(1), name: "pole".to_owned() },
            ],
            labels: vec![Label { at: (1.0, 1.0), text: "a & b".to_owned() }],
        }
    }

    /// All numbers of the longest path.
    fn points(drawing: &str) -> Vec<(f64, f64)> {
        let data = drawing.split("d=\"").skip(1).filter_map(|rest| rest.split('"').next());
        let data = data.max_by_key(|data| data.len()).unwrap();
        let pairs = data.split(['M', 'L']).filter(|pair| !pair.is_empty());
        pairs
            .map(|pair| pair.split_once(' ').unwrap())
            .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
            .collect()
    }

    #[test]
    fn circles_are_round_and_fit_where_a_unit_is_as_long_both_ways() {
        let round = points(&plane_svg(&plane(), Theme::Light));
        let width = |of: fn(&(f64, f64)) -> f64, points: &[(f64, f64)]| {
            let values = points.iter().map(of);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        let (across, upwards) = (width(|p| p.0, &round), width(|p| p.1, &round));
        assert!((across - upwards).abs() < 0.1 && (upwards - 400.0).abs() < 0.1, "{across} {upwards}");
        let flat = points(&plane_svg(&Plane { equal: false, ..plane() }, Theme::Light));
        assert!(width(|p| p.0, &flat) > 600.0);
    }

    #[test]
    fn names_stand_once_in_the_legend_and_texts_are_escaped() {
        let drawing = plane_svg(&plane(), Theme::Dark);
        assert_eq!(drawing.matches(">pole<").count(), 1);
        assert!(drawing.contains("Plane &lt;of&gt; z") && drawing.contains("a &amp; b"));
        assert_eq!(drawing.matches("<svg").count(), drawing.matches("</svg>").count());
    }

    #[test]
    fn ranges_that_make_no_sense_still_give_a_drawing() {
        for range in [[f64::NAN; 4], [0.0; 4], [f64::INFINITY, 1.0, 0.0, 1.0]] {
            let drawing = plane_svg(&Plane { range, ..plane() }, Theme::Light);
            assert!(drawing.ends_with("</svg>\n") && !drawing.contains("NaN"), "{range:?}");
        }
    }
}
