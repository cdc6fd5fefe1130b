//! Series over time in the terminal, in braille or plain ASCII.

use blocksim_numbers::format::{count, significant};
use blocksim_numbers::ticks::{Range, labels, powers};

use crate::canvas::{Canvas, MARKS};

/// One series of a plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<'a> {
    /// Its name, written at the right end of the line.
    pub name: &'a str,
    /// Times, not falling; values without a finite time are left out.
    pub x: &'a [f64],
    /// Values; NaN and infinite ones leave a gap.
    pub y: &'a [f64],
    /// Whether a value holds until the next one, as that of a sampled signal, instead of being joined to it.
    pub step: bool,
}

/// How a plot looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlotOptions<'a> {
    /// Line above the plot; empty for none.
    pub title: &'a str,
    /// Name and unit of the horizontal axis: `time [s]`.
    pub x_label: &'a str,
    /// Name and unit of the vertical axis: `angle [deg]`; empty for none.
    pub y_label: &'a str,
    /// Columns of the whole, labels and names included.
    pub width: usize,
    /// Rows of the drawing area.
    pub height: usize,
    /// Plain ASCII: one mark per cell, another for each series.
    pub ascii: bool,
    /// The horizontal axis is logarithmic: `x` are exponents of ten, and the axis shows the powers.
    pub powers: bool,
}

impl Default for PlotOptions<'_> {
    /// 80 columns, 12 rows, braille, `time [s]`.
    fn default() -> Self {
        PlotOptions {
            title: "",
            x_label: "time [s]",
            y_label: "",
            width: 80,
            height: 12,
            ascii: false,
            powers: false,
        }
    }
}

/// Draws series into text, lines ending in line feeds. Each series is named at the height of its last value;
/// a note below tells where values were not finite.
pub fn plot(series: &[Series], options: &PlotOptions) -> String {
    let mut text = String::new();
    for heading in [options.title, options.y_label] {
        if !heading.is_empty() {
            text.push_str(heading);
            text.push('\n');
        }
    }
    let drawable = || series.iter().flat_map(points).filter(drawn);
    let ranges = (Range::of(drawable().map(|p| p.0)), Range::of(drawable().map(|p| p.1)));
    if let (Some(x), Some(y)) = ranges {
        text.push_str(&draw(series, x, y, options));
    } else {
        text.push_str("  nothing to draw\n");
    }
    for s in series {
        text.push_str(&note(s));
    }
    text
}

fn draw(series: &[Series], x_range: Range, y_range: Range, options: &PlotOptions) -> String {
    let rows = options.height.max(2);
    // Widened to a finer step than is labelled, so that little of the height stays empty.
    let y_range = y_range.widened(y_range.step(2 * rows));
    let y_step = y_range.step((rows / 2).max(1));
    let y_ticks = y_range.ticks(y_step);
    let y_labels = labels(&y_ticks, y_step);
    let margin = y_labels.iter().map(|l| l.chars().count()).max().unwrap_or(0) + 2;
    let names = series.iter().map(|s| s.name.chars().count()).max().unwrap_or(0) + 4;
    let columns = options.width.saturating_sub(margin + 2 + names).max(8);

    let mut canvas = Canvas::new(columns, rows, options.ascii);
    let (right, bottom) = (canvas.width() - 1, canvas.height() - 1);
    let across = |x: f64| (x_range.share(x) * right as f64).round() as usize;
    let down = |y: f64| ((1.0 - y_range.share(y)) * bottom as f64).round() as usize;

    for (n, s) in series.iter().enumerate() {
        let mut last: Option<(usize, usize)> = None;
        for (x, y) in points(s) {
            if !drawn(&(x, y)) {
                last = None;
                continue;
            }
            let here = (across(x), down(y));
            match last {
                None => canvas.line(here, here, n),
                Some(from) if s.step => {
                    canvas.line(from, (here.0, from.1), n);
                    canvas.line((here.0, from.1), here, n);
                }
                Some(from) => canvas.line(from, here, n),
            }
            last = Some(here);
        }
    }

    let mut label_of_row = vec![None; rows];
    for (tick, label) in y_ticks.iter().zip(y_labels) {
        label_of_row[canvas.row_of(down(*tick))] = Some(label);
    }
    let end = |s: &Series| points(s).rev().find(drawn).map(|p| canvas.row_of(down(p.1)));
    let ends: Vec<Option<usize>> = series.iter().map(end).collect();
    let (name_of_row, left_over) = place_names(&ends, rows);
    let shown = |n: usize| match options.ascii {
        true => format!("{} {}", MARKS[n % MARKS.len()], series[n].name),
        false => series[n].name.to_owned(),
    };

    let (tick_sign, bar) = if options.ascii { ('+', '|') } else { ('┤', '│') };
    let mut text = String::new();
    for row in 0..rows {
        let label = label_of_row[row].as_deref().unwrap_or("");
        let mark = if label.is_empty() { bar } else { tick_sign };
        let drawn: String = canvas.row(row).collect();
        let name = name_of_row[row].map(shown).unwrap_or_default();
        text.push_str(format!("{label:>margin$} {mark}{drawn}  {name}").trim_end());
        text.push('\n');
    }
    text.push_str(&x_axis(x_range, columns, margin, options));
    if !left_over.is_empty() {
        let names: Vec<String> = left_over.into_iter().map(shown).collect();
        text.push_str(&format!("  also drawn: {}\n", names.join(", ")));
    }
    text
}

/// The line below the drawing with its ticks, their labels, and the name of the axis.
fn x_axis(range: Range, columns: usize, margin: usize, options: &PlotOptions) -> String {
    let mut step = range.step((columns / 10).max(1));
    if options.powers {
        step = step.max(1.0);
    }
    let ticks = range.ticks(step);
    let labels = if options.powers { powers(&ticks) } else { labels(&ticks, step) };
    let (corner, dash, tick_sign) = if options.ascii { ('+', '-', '+') } else { ('└', '─', '┬') };
    let mut line = vec![dash; columns];
    let mut below: Vec<char> = Vec::new();
    for (tick, label) in ticks.iter().zip(labels) {
        let column = (range.share(*tick) * (columns - 1) as f64).round() as usize;
        line[column.min(columns - 1)] = tick_sign;
        // Centred below its tick, which stands `margin + 2` columns from the left.
        let start = (margin + 2 + column).saturating_sub(label.chars().count() / 2);
        if below.is_empty() || start > below.len() {
            below.resize(start, ' ');
            below.extend(label.chars());
        }
    }
    let line: String = line.into_iter().collect();
    let mut below: String = below.into_iter().collect();
    if !options.x_label.is_empty() {
        below.push_str("  ");
        below.push_str(options.x_label);
    }
    format!("{:margin$} {corner}{line}\n{}\n", "", below.trim_end())
}

/// Gives each series the row nearest to its end that is still free; those that find none are left over.
fn place_names(ends: &[Option<usize>], rows: usize) -> (Vec<Option<usize>>, Vec<usize>) {
    let mut name_of_row = vec![None; rows];
    let mut left_over = Vec::new();
    let mut order: Vec<(usize, usize)> =
        ends.iter().enumerate().filter_map(|(n, e)| Some(((*e)?, n))).collect();
    order.sort();
    for (end, n) in order {
        let by_distance = (0..rows).flat_map(|d| [end.checked_add(d), end.checked_sub(d)]).flatten();
        match by_distance.into_iter().find(|&row| row < rows && name_of_row[row].is_none()) {
            Some(row) => name_of_row[row] = Some(n),
            None => left_over.push(n),
        }
    }
    (name_of_row, left_over)
}

/// The points of a series, as many as have both coordinates.
fn points<'a>(
    series: &Series<'a>,
) -> impl DoubleEndedIterator<Item = (f64, f64)> + ExactSizeIterator + use<'a> {
    series.x.iter().copied().zip(series.y.iter().copied())
}

fn drawn(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// How many values of a series are not finite and since when.
fn note(series: &Series) -> String {
    let (name, values) = (series.name, points(series).len());
    if values == 0 {
        return format!("  {name}: no values\n");
    }
    let odd = points(series).filter(|p| !p.1.is_finite()).count();
    let Some(first) = points(series).find(|p| !p.1.is_finite()) else { return String::new() };
    let what = if first.1.is_nan() { "NaN" } else { "infinite" };
    format!(
        "  {name}: {what} first at {}; {} of {} values are not finite\n",
        significant(first.0, 5),
        count(odd as u64),
        count(values as u64)
    )
}

#[cfg(test)]
#[path = "plot_tests.rs"]
mod tests;
