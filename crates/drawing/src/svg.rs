//! A level as SVG.

use std::fmt::Write;

use blocksim_block::Symbol;
use blocksim_layout::{Layout, Placed, PlacedPort, PortKind, Side};
use blocksim_picture::{Theme, text_width};

use crate::canvas::{Canvas, Paint, THIN, classes, escaped, number};
use crate::colours::{Colour, Fill, fixed, marked};
use crate::figure::{Figure, Look};
use crate::fonts::{LINE, NAME, PORT};
use crate::layers::{self, Facts, Layer};
use crate::level::Level;
use crate::marks::Marks;
use crate::size::tag_height;
use crate::symbols;

/// Filled, without a line.
const DOT: Paint = Paint { colour: Colour::Ink, width: 0.0, fill: Fill::Solid };
/// Room around the drawing.
const EDGE: f64 = 16.0;
/// Room for a sample of a colour, and between two of them.
const SAMPLE: f64 = 40.0;
/// Room for a line above the drawing.
const HEAD: f64 = 16.0;

/// Draws a level as a file of its own. Each block is a group with its path in `data-path`, its kind in `data-kind`,
/// `data-inside` where there is a level inside it, its place among the figures in `data-node`, and a title; wires are
/// groups of the classes `wire`, `bus` and `conserving` with their place among the nets in `data-net`. Colours are said
/// by classes and one style sheet, so that another one can replace them.
pub fn svg(level: &Level, layout: &Layout, theme: Theme) -> String {
    svg_with_marks(level, layout, theme, &Marks::default())
}

/// The same with some blocks, and the wires between them, in a colour of their own: the class `marked`.
pub fn svg_with_marks(level: &Level, layout: &Layout, theme: Theme, marks: &Marks) -> String {
    let mut style = fixed(theme);
    if !marks.blocks.is_empty() {
        style.push_str(&marked(theme));
    }
    draw(level, layout, Some(&style), marks)
}

/// Draws a level as a part of a page that has [`style_sheet`](crate::style_sheet): any number of them fit into one
/// page, for light and dark.
pub fn inline(level: &Level, layout: &Layout) -> String {
    draw(level, layout, None, &Marks::default())
}

/// The same with layers over it, and a line below that explains the colours of sample times.
pub fn svg_with_layers(
    level: &Level,
    layout: &Layout,
    theme: Theme,
    facts: &Facts,
    layers: &[Layer],
) -> String {
    let style = fixed(theme) + &layers::rules(theme);
    let known = facts.on(level);
    let over = layers.iter().map(|layer| facts.draw(*layer, level, &known, layout)).collect();
    let legend = if layers.contains(&Layer::Rates) { facts.legend(&known) } else { Vec::new() };
    draw_with(level, layout, Some(&style), &Marks::default(), Over { over, legend })
}

/// What is drawn over a level, and what explains it.
#[derive(Default)]
struct Over {
    over: String,
    legend: Vec<(String, String)>,
}

fn draw(level: &Level, layout: &Layout, style: Option<&str>, marks: &Marks) -> String {
    draw_with(level, layout, style, marks, Over::default())
}

fn draw_with(level: &Level, layout: &Layout, style: Option<&str>, marks: &Marks, over: Over) -> String {
    let title = match (level.title.as_str(), level.path.as_str()) {
        ("", path) => path.to_owned(),
        (title, "") => title.to_owned(),
        (title, path) => format!("{title} ({path})"),
    };
    // The path stands below the title.
    let lines = [(level.title.as_str(), 13.0, Colour::Ink), (level.path.as_str(), NAME, Colour::Quiet)];
    let lines: Vec<_> = lines.into_iter().filter(|(text, ..)| !text.is_empty()).collect();
    let head = lines.len() as f64 * HEAD + if lines.is_empty() { 0.0 } else { 10.0 };
    let wide = lines.iter().map(|(text, size, _)| text_width(text, *size).ceil()).fold(0.0, f64::max);
    let entries: Vec<f64> =
        over.legend.iter().map(|(_, text)| SAMPLE + text_width(text, PORT).ceil()).collect();
    let foot = if entries.is_empty() { 0.0 } else { HEAD + 8.0 };
    let wide = wide.max(entries.iter().sum());
    let width = (layout.width.max(wide) + 2.0 * EDGE).ceil();
    let height = (layout.height + head + foot + 2.0 * EDGE).ceil();
    let mut canvas = Canvas::begin(width, height, style, &title);
    for (i, (text, size, colour)) in lines.into_iter().enumerate() {
        canvas.text(EDGE, EDGE + 10.0 + i as f64 * HEAD, size, "start", colour, text);
    }
    let _ = write!(canvas.out, "<g transform=\"translate({EDGE} {})\">", number(EDGE + head));
    wires(&mut canvas, level, layout, marks);
    for (node, (figure, placed)) in level.figures.iter().zip(&layout.nodes).enumerate() {
        block(&mut canvas, node, figure, placed, marks.has(figure));
    }
    canvas.out.push_str(&over.over);
    canvas.out.push_str("</g>");
    let (mut x, y) = (EDGE, height - EDGE);
    for ((class, text), wide) in over.legend.iter().zip(entries) {
        let _ =
            write!(canvas.out, "<path class=\"halo {class}\" d=\"M{} {}h16\"/>", number(x), number(y - 3.0));
        canvas.text(x + 22.0, y, PORT, "start", Colour::Ink, text);
        x += wide;
    }
    canvas.end()
}

fn wires(canvas: &mut Canvas, level: &Level, layout: &Layout, marks: &Marks) {
    for (net, (line, wire)) in level.lines.iter().zip(&layout.wires).enumerate() {
        let mut data = String::new();
        for segment in &wire.segments {
            let _ = write!(data, "M{} {}", number(segment.from.x), number(segment.from.y));
            if segment.from.y == segment.to.y {
                let _ = write!(data, "H{}", number(segment.to.x));
            } else {
                let _ = write!(data, "V{}", number(segment.to.y));
            }
        }
        if data.is_empty() {
            continue;
        }
        let class = match (line.domain, line.thick) {
            (Some(_), _) => "conserving",
            (None, true) => "bus",
            (None, false) => "wire",
        };
        let colour = Colour::of(line.domain);
        let width = match class {
            "bus" => 3.0,
            "conserving" => 1.6,
            _ => THIN,
        };
        let domain = line.domain.map_or(String::new(), |domain| format!(" data-domain=\"{domain}\""));
        let signal = match &line.signal {
            Some(signal) => format!(" data-signal=\"{}\"", escaped(signal)),
            None => String::new(),
        };
        let group = classes(&[class, colour.class(), mark(marks.has_net(level, net))]);
        let _ = write!(
            canvas.out,
            "<g{group}{domain}{signal} data-net=\"{net}\"><title>{}</title>",
            escaped(&line.title)
        );
        canvas.path(&data, Paint { colour: Colour::Ink, width, fill: Fill::Nothing }, "");
        for junction in &wire.junctions {
            let r = if line.thick { 3.6 } else { 2.6 };
            canvas.circle(junction.x, junction.y, r, DOT);
        }
        canvas.out.push_str("</g>");
    }
}

/// The class of what is marked.
fn mark(is_marked: bool) -> &'static str {
    if is_marked { "marked" } else { "" }
}

fn block(canvas: &mut Canvas, node: usize, figure: &Figure, placed: &Placed, is_marked: bool) {
    match &figure.path {
        Some(path) => {
            let inside = if matches!(figure.look, Look::Subsystem(_)) { " data-inside=\"true\"" } else { "" };
            let _ = write!(
                canvas.out,
                "<g{} data-node=\"{node}\" data-path=\"{}\" data-kind=\"{}\"{inside}>",
                classes(&["block", mark(is_marked)]),
                escaped(path),
                escaped(&figure.kind)
            );
        }
        None => {
            let _ = write!(canvas.out, "<g class=\"port\" data-node=\"{node}\">");
        }
    }
    let _ = write!(canvas.out, "<title>{}</title>", escaped(&figure.title));
    symbols::draw(canvas, figure, placed);
    let arrows: String = figure
        .ports
        .iter()
        .zip(&placed.ports)
        .filter(|(look, _)| look.kind == PortKind::Input && figure.look != Look::Selector)
        .map(|(_, port)| arrow(port))
        .collect();
    if !arrows.is_empty() {
        canvas.path(&arrows, DOT, "");
    }
    for (look, port) in figure.ports.iter().zip(&placed.ports) {
        if look.kind == PortKind::Free {
            joint(canvas, figure, look.domain, port);
        }
        let bar = matches!(figure.look, Look::Symbol(Symbol::Bar, _));
        // The whole bus has no name at its bar.
        if figure.port_names
            && !(bar && figure.ports.iter().filter(|other| other.kind == look.kind).count() == 1)
        {
            port_name(canvas, figure, placed, port, &look.name);
        }
    }
    let middle = placed.x + placed.width / 2.0;
    let below = placed.y + placed.height + NAME + 1.0 + tag_height(&figure.look);
    let above = placed.y - 4.0 - LINE * figure.label.len().saturating_sub(1) as f64;
    let first = if placed.label_above { above } else { below };
    for (i, line) in figure.label.iter().enumerate() {
        canvas.text(middle, first + LINE * i as f64, NAME, "middle", Colour::Quiet, line);
    }
    canvas.out.push_str("</g>");
}

/// The head of an arrow where a signal enters.
fn arrow(port: &PlacedPort) -> String {
    let (x, y) = (number(port.at.x), number(port.at.y));
    let sides = match port.side {
        Side::West => "l-7-3.2v6.4",
        Side::East => "l7-3.2v6.4",
        Side::North => "l-3.2-7h6.4",
        Side::South => "l-3.2 7h6.4",
    };
    format!("M{x} {y}{sides}Z")
}

/// A small square where a conserving port is.
fn joint(
    canvas: &mut Canvas,
    figure: &Figure,
    domain: Option<blocksim_block::physical::Domain>,
    port: &PlacedPort,
) {
    if matches!(figure.look, Look::Pill | Look::Symbol(Symbol::Ground | Symbol::Housing, _)) {
        return;
    }
    let (x, y) = (port.at.x - 2.2, port.at.y - 2.2);
    let paint = Paint { colour: Colour::of(domain), width: THIN, fill: Fill::Ground };
    canvas.path(&format!("M{} {}h4.4v4.4h-4.4Z", number(x), number(y)), paint, "");
}

fn port_name(canvas: &mut Canvas, figure: &Figure, placed: &Placed, port: &PlacedPort, name: &str) {
    if figure.look == Look::Selector {
        // Beside the bar, above the wire.
        let (x, anchor) =
            if port.side == Side::East { (port.at.x + 4.0, "start") } else { (port.at.x - 4.0, "end") };
        canvas.text(x, port.at.y - 3.0, PORT, anchor, Colour::Quiet, name);
        return;
    }
    let y = port.at.y + PORT * 0.35;
    match port.side {
        Side::West => canvas.text(placed.x + 5.0, y, PORT, "start", Colour::Quiet, name),
        Side::East => canvas.text(placed.x + placed.width - 5.0, y, PORT, "end", Colour::Quiet, name),
        Side::North | Side::South => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_page_has_no_ids_and_no_colours_of_its_own() {
        let graph = blocksim_layout::Graph::default();
        let level =
            Level { title: "A".into(), path: String::new(), graph, figures: Vec::new(), lines: Vec::new() };
        let part = inline(&level, &Layout::default());
        assert!(!part.contains("<style") && !part.contains('#') && !part.contains(" id="), "{part}");
        let whole = svg(&level, &Layout::default(), Theme::Dark);
        assert!(whole.contains("<style>.diagram{color:#F1F5F9;"), "{whole}");
    }
}
