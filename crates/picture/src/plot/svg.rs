//! Figures as text in SVG.

use std::fmt::Write;

use crate::{Palette, Theme, text_width};
use blocksim_numbers::ticks::{Range, labels, powers};

use super::figure::{Across, Figure, Line, Panel, Style};
use super::frame::{Area, Axis, roomy};
use super::legend::{Entry, ROW, SAMPLE, SIZE, entries, fitted, rows};
use super::straighten::straightened;
use super::units::pretty_unit;

/// Font of titles, numbers and names; the last one is what pictures in PNG are drawn with.
pub(crate) const FONT: &str = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif";
/// Font sizes, dots.
pub(crate) const TITLE: f64 = 13.0;
pub(crate) const NUMBER: f64 = 10.5;
/// Heights of a panel, of a strip and of the gap between them, dots.
const HIGH: f64 = 150.0;
const LOW: f64 = 46.0;
/// Height of the plot of one signal over another.
const PLANE: f64 = 300.0;
const GAP: f64 = 17.0;
/// Room around the whole and between panels, dots.
pub(crate) const MARGIN: f64 = 14.0;
/// Room below a panel for the numbers of the time axis, dots.
const FOOT: f64 = 34.0;
/// Dots of height for a number of the vertical axis, of width for one of the time axis.
pub(crate) const PER_Y_TICK: f64 = 30.0;
pub(crate) const PER_X_TICK: f64 = 70.0;
/// How far a line may lie beside a point that is left out, dots.
pub(crate) const ERROR: f64 = 0.06;

/// The figure as a drawing in SVG 1.1 with literal colours. Texts are escaped: no name can add anything to it.
pub fn svg(figure: &Figure, theme: Theme) -> String {
    let palette = Palette::of(theme);
    let time = time_range(figure.time);
    let axes: Vec<Axes> = figure.panels.iter().map(|panel| Axes::of(panel, figure)).collect();
    let gutter = gutter(&axes);

    let mut body = String::new();
    let mut top = head(figure);
    for row in figure_rows(figure, gutter) {
        for (column, number) in row.panels.clone().enumerate() {
            let left = MARGIN + column as f64 * (row.cell + MARGIN) + gutter;
            let panel = &figure.panels[number];
            // What one panel of a row has more than another in strips and legends, the other has in height.
            let high = usual_height(panel) + row.height - natural_height(panel, row.plot);
            let size = (row.plot, high);
            match in_plane(panel, size) {
                Some((across, range, axes)) => {
                    let mut pen = Pen { out: &mut body, palette: &palette, time: &range, across: &across };
                    pen.panel(panel, &axes, (left, top), size);
                }
                None => {
                    let mut pen =
                        Pen { out: &mut body, palette: &palette, time: &time, across: &figure.across };
                    pen.panel(panel, &axes[number], (left, top), size);
                }
            }
        }
        top += row.height + MARGIN;
    }
    let (width, height) = (figure.width, top.ceil());
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"{FONT}\" role=\"img\">\n<title>{}</title>\n<desc>{}</desc>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        escaped(if figure.title.is_empty() { untitled(&figure.across) } else { &figure.title }),
        escaped(&description(figure)),
        palette.ground
    );
    if !figure.title.is_empty() {
        let title = fitted(&figure.title, TITLE + 2.0, width - 2.0 * MARGIN);
        let _ = writeln!(
            out,
            "<text x=\"{MARGIN}\" y=\"{}\" font-size=\"{}\" font-weight=\"bold\" fill=\"{}\">{}</text>",
            MARGIN + TITLE,
            TITLE + 2.0,
            palette.text,
            escaped(&title)
        );
    }
    out.push_str(&body);
    out.push_str("</svg>\n");
    out
}

/// The figure in parts that are no higher than a page of paper (A4, upright) as wide as they are, each with as many rows of
/// panels as fit, at least one.
pub fn pages(figure: &Figure) -> Vec<Figure> {
    let axes: Vec<Axes> = figure.panels.iter().map(|panel| Axes::of(panel, figure)).collect();
    let page = figure.width * std::f64::consts::SQRT_2;
    let mut pages: Vec<Figure> = Vec::new();
    let mut bottom = f64::INFINITY;
    for row in figure_rows(figure, gutter(&axes)) {
        if bottom + row.height + MARGIN > page {
            pages.push(Figure { panels: Vec::new(), ..figure.clone() });
            bottom = head(figure);
        }
        bottom += row.height + MARGIN;
        if let Some(page) = pages.last_mut() {
            page.panels.extend_from_slice(&figure.panels[row.panels]);
        }
    }
    if pages.is_empty() { vec![figure.clone()] } else { pages }
}

/// A row of panels.
struct Row {
    /// Which.
    panels: std::ops::Range<usize>,
    /// Width of each with its numbers, and of its plot.
    cell: f64,
    plot: f64,
    /// Height of all of them.
    height: f64,
}

/// The rows of a figure: as many panels in each as it has columns, and in the last what is left, over the whole width.
fn figure_rows(figure: &Figure, gutter: f64) -> Vec<Row> {
    let columns = figure.columns.clamp(1, figure.panels.len().max(1));
    let row = |first: usize| {
        let panels = first..(first + columns).min(figure.panels.len());
        let side_by_side = panels.len() as f64;
        let cell = (figure.width - 2.0 * MARGIN - (side_by_side - 1.0) * MARGIN) / side_by_side;
        let plot = (cell - gutter - 6.0).max(40.0);
        let height =
            figure.panels[panels.clone()].iter().map(|panel| natural_height(panel, plot)).fold(0.0, f64::max);
        Row { panels, cell, plot, height }
    };
    (0..figure.panels.len()).step_by(columns).map(row).collect()
}

/// Where the first row begins, dots from the top.
fn head(figure: &Figure) -> f64 {
    MARGIN + if figure.title.is_empty() { 0.0 } else { TITLE + 12.0 }
}

/// Room for the numbers of all vertical axes: one for all, so that the time axes of panels above each other agree.
fn gutter(axes: &[Axes]) -> f64 {
    axes.iter().map(Axes::widest).fold(0.0, f64::max) + 10.0
}

/// Title and unit above a panel.
fn heading(panel: &Panel, width: f64) -> String {
    let unit = pretty_unit(&panel.unit);
    let heading = match (panel.title.as_str(), unit.as_str()) {
        (title, "") => title.to_owned(),
        ("", unit) => format!("[{unit}]"),
        (title, unit) => format!("{title} [{unit}]"),
    };
    fitted(&heading, TITLE, width)
}

/// The names of the lines of a panel of this width from `left` on, and whether they stand beside its title: where there is
/// room, else below it.
fn named_lines<'p>(panel: &'p Panel, heading: &str, left: f64, width: f64) -> (Vec<Entry<'p>>, bool) {
    let title_end = left + text_width(heading, TITLE) * 1.1 + 16.0;
    let beside = entries(&panel.lines, title_end, left + width);
    let fits = rows(&beside) <= 1
        && beside
            .last()
            .is_none_or(|last| last.x + SAMPLE + 5.0 + text_width(&last.line.name, SIZE) <= left + width);
    if fits { (beside, true) } else { (entries(&panel.lines, left, left + width), false) }
}

/// Height of a panel whose plot has its usual one, dots.
fn natural_height(panel: &Panel, width: f64) -> f64 {
    let (legend, is_beside) = named_lines(panel, &heading(panel, width), 0.0, width);
    let legend = if is_beside { 0.0 } else { rows(&legend) as f64 * ROW };
    let strip = if panel.strip.is_some() { GAP + LOW } else { 0.0 };
    TITLE + 8.0 + legend + usual_height(panel) + strip + FOOT
}

/// Height of the plot of a panel, dots.
fn usual_height(panel: &Panel) -> f64 {
    if panel.plane.is_some() { PLANE } else { HIGH }
}

/// The axes of a panel that shows one signal over another, whose plot has this width and height.
fn in_plane(panel: &Panel, (width, height): (f64, f64)) -> Option<(Across, Range, Axes)> {
    let plane = panel.plane.as_ref()?;
    let points = || panel.lines.iter().flat_map(|line| line.courses.iter().flatten());
    let of = |values: &mut dyn Iterator<Item = f64>| {
        Range::of(values).map_or(Range { low: -1.0, high: 1.0 }, |range| roomy(&range))
    };
    let (mut x, mut y) = (of(&mut points().map(|p| p.0)), of(&mut points().map(|p| p.1)));
    if plane.equal {
        let dot = ((x.high - x.low) / width).max((y.high - y.low) / height);
        let around = |range: &Range, dots: f64| {
            let (middle, half) = (range.low / 2.0 + range.high / 2.0, dot * dots / 2.0);
            Range { low: middle - half, high: middle + half }
        };
        (x, y) = (around(&x, width), around(&y, height));
    }
    let axis = Axis::over(y, (height / PER_Y_TICK).floor().max(1.0) as usize);
    Some((Across::Numbers(plane.name.clone()), x, Axes { main: Some(axis), strip: None }))
}

/// What a drawing without a title is called.
fn untitled(across: &Across) -> &'static str {
    match across {
        Across::Time | Across::Numbers(_) => "Signals over time",
        Across::Powers(_) => "Frequency response",
    }
}

/// The axis of time; some width where all lies at one instant.
fn time_range((from, to): (f64, f64)) -> Range {
    if from < to && from.is_finite() && to.is_finite() {
        return Range { low: from, high: to };
    }
    Range::of([from, to].into_iter()).unwrap_or(Range { low: 0.0, high: 1.0 })
}

/// The vertical axes of a panel and its strip.
struct Axes {
    main: Option<Axis>,
    strip: Option<Axis>,
}

impl Axes {
    fn of(panel: &Panel, figure: &Figure) -> Axes {
        let time = figure.time;
        let turn = figure.across != Across::Time && panel.unit == "deg";
        if let Some((.., axes)) = in_plane(panel, (figure.width, PLANE)) {
            return axes;
        }
        let parts = |height: f64| (height / PER_Y_TICK).floor().max(1.0) as usize;
        Axes {
            main: Axis::of(&panel.lines, time, parts(HIGH), turn),
            strip: panel
                .strip
                .as_ref()
                .and_then(|strip| Axis::of(&strip.lines, time, parts(LOW).max(2), turn)),
        }
    }

    /// Width of the widest number, dots.
    fn widest(&self) -> f64 {
        let ticks = [&self.main, &self.strip].into_iter().flatten().flat_map(|axis| &axis.ticks);
        ticks.map(|(_, label)| text_width(label, NUMBER)).fold(0.0, f64::max)
    }
}

/// What the drawing shows, for those who cannot see it.
fn description(figure: &Figure) -> String {
    let panel = |panel: &Panel| {
        let names: Vec<&str> =
            panel.lines.iter().map(|line| line.name.as_str()).filter(|name| !name.is_empty()).collect();
        format!("{} [{}]: {}", panel.title, panel.unit, names.join(", "))
    };
    figure.panels.iter().map(panel).collect::<Vec<_>>().join("; ")
}

struct Pen<'a> {
    out: &'a mut String,
    palette: &'a Palette,
    time: &'a Range,
    across: &'a Across,
}

impl Pen<'_> {
    /// Draws a panel with title, legend, strip and time axis; `width` and `high` are those of its plot.
    fn panel(&mut self, panel: &Panel, axes: &Axes, at: (f64, f64), (width, high): (f64, f64)) {
        let (left, top) = at;
        let heading = heading(panel, width);
        let text = self.palette.text;
        self.text((left, top + TITLE), TITLE, text, " font-weight=\"bold\"", &heading);
        let (legend, is_beside) = named_lines(panel, &heading, left, width);
        let first = top + TITLE + if is_beside { 0.0 } else { ROW };
        let below = if is_beside { 0.0 } else { rows(&legend) as f64 * ROW };
        for entry in &legend {
            let y = first + entry.row as f64 * ROW;
            let sample = format!("M{} {}H{}", round(entry.x), round(y - 4.0), round(entry.x + SAMPLE));
            self.path(&sample, entry.line);
            let room = left + width - entry.x - SAMPLE - 5.0;
            let name = fitted(&entry.line.name, SIZE, room);
            self.text((entry.x + SAMPLE + 5.0, y), SIZE, text, "", &name);
        }
        let mut area = Area { x: left, y: top + TITLE + 8.0 + below, width, height: high };
        self.plot(&panel.lines, axes.main.as_ref(), area);
        for (n, note) in panel.notes.iter().enumerate() {
            let y = area.y + 14.0 + n as f64 * 13.0;
            let note = fitted(note, SIZE, width - 12.0);
            self.text((left + 6.0, y), SIZE, self.palette.alarm, "", &note);
        }
        if let Some(strip) = &panel.strip {
            area = Area { y: area.bottom() + GAP, height: LOW, ..area };
            self.plot(&strip.lines, axes.strip.as_ref(), area);
            // In the gap above it, where no line goes.
            self.text((left + 2.0, area.y - 4.0), NUMBER, self.palette.quiet, "", &strip.name);
        }
        self.time_axis(area);
    }

    /// Frame, grid, numbers and lines.
    fn plot(&mut self, lines: &[Line], axis: Option<&Axis>, area: Area) {
        let Palette { grid, frame, quiet, .. } = *self.palette;
        let Area { x, y, width, height } = area;
        let mut ruling = String::new();
        for (t, _) in self.time_ticks(area) {
            let _ =
                write!(ruling, "M{} {}V{}", round(area.across(self.time, t)), round(y), round(area.bottom()));
        }
        for (value, label) in axis
            .iter()
            .flat_map(|axis| axis.ticks.iter().map(move |tick| (axis, tick)))
            .map(|(axis, (value, label))| (area.down(&axis.range, *value), label))
        {
            let _ = write!(ruling, "M{} {}H{}", round(x), round(value), round(area.right()));
            self.text((x - 5.0, value + 3.5), NUMBER, quiet, " text-anchor=\"end\"", label);
        }
        let _ = writeln!(self.out, "<path d=\"{ruling}\" stroke=\"{grid}\" fill=\"none\"/>");
        if let Some(axis) = axis {
            // A drawing within the drawing cuts off what leaves it, and unlike a clip path it needs no name, which
            // would clash where a page holds two drawings.
            let [x, y, width, height] = [x, y, width, height].map(round);
            let _ = writeln!(
                self.out,
                "<svg class=\"courses\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
                 viewBox=\"{x} {y} {width} {height}\" stroke-linejoin=\"round\">"
            );
            // What should be is drawn over what is, which would hide it where both agree.
            let is_set = |line: &&Line| line.style == Style::Dashed;
            for line in lines.iter().filter(|line| !is_set(line)).chain(lines.iter().filter(is_set)) {
                let data: String =
                    line.courses.iter().map(|course| self.course(course, &axis.range, area)).collect();
                self.path(&data, line);
            }
            self.out.push_str("</svg>\n");
        }
        let _ = writeln!(
            self.out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{frame}\"/>",
            round(x),
            round(y),
            round(width),
            round(height)
        );
    }

    /// The points of a course as data of a path; one alone is a dot.
    fn course(&self, course: &[(f64, f64)], values: &Range, area: Area) -> String {
        let dots = course.iter().map(|&(t, value)| (area.across(self.time, t), area.down(values, value)));
        let dots = straightened(dots, ERROR);
        let mut data = String::new();
        for (n, &(x, y)) in dots.iter().enumerate() {
            let _ = write!(data, "{}{} {}", if n == 0 { 'M' } else { 'L' }, round(x), round(y));
        }
        if dots.len() == 1 {
            data.push_str("h0.01");
        }
        data
    }

    fn path(&mut self, data: &str, line: &Line) {
        let series = &self.palette.series;
        let colour = series[line.colour % series.len()];
        let width = if line.thin { 1.0 } else { 1.7 };
        let (colour, width, dashes) = match line.style {
            Style::Solid => (colour, width, ""),
            // Not in the colour of the line that it lies on.
            Style::Dashed => (self.palette.text, 1.1, " stroke-dasharray=\"6 4\""),
            Style::Dotted => (colour, width, " stroke-dasharray=\"1.5 3\""),
            Style::Limit => (self.palette.quiet, 1.0, " stroke-dasharray=\"2 3\""),
        };
        let _ = writeln!(
            self.out,
            "<path d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"{}\"{dashes}/>",
            if dashes.is_empty() { "round" } else { "butt" }
        );
    }

    /// Ticks of the horizontal axis and their labels, of which some are empty.
    fn time_ticks(&self, area: Area) -> Vec<(f64, String)> {
        let step = self.time.step((area.width / PER_X_TICK).max(1.0) as usize);
        match self.across {
            Across::Time | Across::Numbers(_) => {
                let ticks = self.time.ticks(step);
                let labels = labels(&ticks, step);
                ticks.into_iter().zip(labels).collect()
            }
            Across::Powers(_) => {
                let decades = self.time.ticks(step.max(1.0));
                let mut ticks: Vec<(f64, String)> = decades.iter().copied().zip(powers(&decades)).collect();
                if step <= 1.0 {
                    // The lines of 2 to 9 within each decade.
                    let first = self.time.low.floor() as i32;
                    let last = self.time.high.ceil() as i32;
                    let within = (first..last)
                        .flat_map(|decade| (2..10).map(move |k| f64::from(decade) + f64::from(k).log10()));
                    let seen = within.filter(|x| (self.time.low..=self.time.high).contains(x));
                    ticks.extend(seen.map(|x| (x, String::new())));
                }
                ticks
            }
        }
    }

    /// Numbers below a plot and the name of the axis.
    fn time_axis(&mut self, area: Area) {
        let quiet = self.palette.quiet;
        let y = area.bottom() + 14.0;
        for (t, label) in self.time_ticks(area).into_iter().filter(|(_, label)| !label.is_empty()) {
            self.text((area.across(self.time, t), y), NUMBER, quiet, " text-anchor=\"middle\"", &label);
        }
        let middle = area.x + area.width / 2.0;
        let name = match self.across {
            Across::Time => "time [s]",
            Across::Powers(name) | Across::Numbers(name) => name,
        };
        self.text((middle, y + 14.0), NUMBER, quiet, " text-anchor=\"middle\"", name);
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

/// A place on the drawing with two decimals at most, within what drawing programs can take.
pub(crate) fn round(x: f64) -> f64 {
    let rounded = (x.clamp(-1e6, 1e6) * 100.0).round() / 100.0;
    // No `-0`.
    rounded + 0.0
}

/// A text for use between tags or in an attribute; signs that XML cannot hold are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\u{FFFE}' | '\u{FFFF}' => {}
            sign if sign.is_control() => out.push(' '),
            sign => out.push(sign),
        }
    }
    out
}

#[cfg(test)]
#[path = "svg_tests.rs"]
mod tests;
