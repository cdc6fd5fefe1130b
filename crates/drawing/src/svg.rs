//! A level as SVG.

use std::fmt::Write;

use blocksim_block::Symbol;
use blocksim_layout::{Layout, Placed, PlacedPort, PortKind, Side};
use blocksim_plot::Theme;

use crate::canvas::{Canvas, Paint, escaped, number};
use crate::figure::{Figure, Look};
use crate::level::Level;
use crate::size::{NAME, PORT};
use crate::symbols;

/// Room around the drawing.
const EDGE: f64 = 16.0;
/// Room for the title.
const HEAD: f64 = 26.0;

/// Draws a level. Each block is a group with its path in `data-path`, its kind in `data-kind`, `data-inside` where
/// there is a level inside it, and a title; wires are paths of the classes `wire`, `bus` and `conserving`. Colours
/// are attributes, so that a style sheet can replace them.
pub fn svg(level: &Level, layout: &Layout, theme: Theme) -> String {
    let title = match (level.title.as_str(), level.path.as_str()) {
        ("", path) => path.to_owned(),
        (title, "") => title.to_owned(),
        (title, path) => format!("{title} ({path})"),
    };
    let head = if title.is_empty() { 0.0 } else { HEAD };
    let wide = blocksim_picture::text_width(&title, 13.0).ceil();
    let width = (layout.width.max(wide) + 2.0 * EDGE).ceil();
    let height = (layout.height + head + 2.0 * EDGE).ceil();
    let mut canvas = Canvas::begin(width, height, theme, &title);
    let ink = canvas.colours.ink;
    canvas.text(EDGE, EDGE + 10.0, 13.0, "start", ink, &title);
    let _ = write!(canvas.out, "<g transform=\"translate({EDGE} {})\">", number(EDGE + head));
    wires(&mut canvas, level, layout);
    for (figure, placed) in level.figures.iter().zip(&layout.nodes) {
        block(&mut canvas, figure, placed);
    }
    canvas.out.push_str("</g>");
    canvas.end()
}

fn wires(canvas: &mut Canvas, level: &Level, layout: &Layout) {
    for (line, wire) in level.lines.iter().zip(&layout.wires) {
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
        let colour = canvas.colours.domain(line.domain);
        let width = match class {
            "bus" => 3.0,
            "conserving" => 1.6,
            _ => 1.2,
        };
        let domain = line.domain.map_or(String::new(), |domain| format!(" data-domain=\"{domain}\""));
        let _ = write!(
            canvas.out,
            "<g class=\"{class}\"{domain}><title>{}</title>\
             <path d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"square\"/>",
            escaped(&line.title)
        );
        for junction in &wire.junctions {
            let r = if line.thick { 3.6 } else { 2.6 };
            canvas.circle(junction.x, junction.y, r, Paint { stroke: "none", width: 0.0, fill: colour });
        }
        canvas.out.push_str("</g>");
    }
}

fn block(canvas: &mut Canvas, figure: &Figure, placed: &Placed) {
    match &figure.path {
        Some(path) => {
            let inside = if matches!(figure.look, Look::Subsystem(_)) { " data-inside=\"true\"" } else { "" };
            let _ = write!(
                canvas.out,
                "<g class=\"block\" data-path=\"{}\" data-kind=\"{}\"{inside}>",
                escaped(path),
                escaped(&figure.kind)
            );
        }
        None => canvas.out.push_str("<g class=\"port\">"),
    }
    let _ = write!(canvas.out, "<title>{}</title>", escaped(&figure.title));
    symbols::draw(canvas, figure, placed);
    for (look, port) in figure.ports.iter().zip(&placed.ports) {
        match look.kind {
            PortKind::Input => arrow(canvas, figure, port),
            PortKind::Output => {}
            PortKind::Free => joint(canvas, figure, look.domain, port),
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
    let quiet = canvas.colours.quiet;
    if !figure.label.is_empty() {
        let y = if placed.label_above { placed.y - 4.0 } else { placed.y + placed.height + NAME + 1.0 };
        canvas.text(middle, y, NAME, "middle", quiet, &figure.label);
    }
    canvas.out.push_str("</g>");
}

/// The head of an arrow where a signal enters.
fn arrow(canvas: &mut Canvas, figure: &Figure, port: &PlacedPort) {
    let (x, y) = (port.at.x, port.at.y);
    let (a, b) = match port.side {
        Side::West => ((-7.0, -3.2), (-7.0, 3.2)),
        Side::East => ((7.0, -3.2), (7.0, 3.2)),
        Side::North => ((-3.2, -7.0), (3.2, -7.0)),
        Side::South => ((-3.2, 7.0), (3.2, 7.0)),
    };
    if figure.look == Look::Selector {
        return;
    }
    let data = format!(
        "M{} {}L{} {}L{} {}Z",
        number(x),
        number(y),
        number(x + a.0),
        number(y + a.1),
        number(x + b.0),
        number(y + b.1)
    );
    let fill = canvas.colours.ink;
    canvas.path(&data, Paint { stroke: "none", width: 0.0, fill }, "");
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
    let paint = Paint { stroke: canvas.colours.domain(domain), width: 1.2, fill: canvas.colours.ground };
    canvas.path(&format!("M{} {}h4.4v4.4h-4.4Z", number(x), number(y)), paint, "");
}

fn port_name(canvas: &mut Canvas, figure: &Figure, placed: &Placed, port: &PlacedPort, name: &str) {
    let quiet = canvas.colours.quiet;
    if figure.look == Look::Selector {
        // Beside the bar, above the wire.
        let (x, anchor) =
            if port.side == Side::East { (port.at.x + 4.0, "start") } else { (port.at.x - 4.0, "end") };
        canvas.text(x, port.at.y - 3.0, PORT, anchor, quiet, name);
        return;
    }
    let y = port.at.y + PORT * 0.35;
    match port.side {
        Side::West => canvas.text(placed.x + 5.0, y, PORT, "start", quiet, name),
        Side::East => canvas.text(placed.x + placed.width - 5.0, y, PORT, "end", quiet, name),
        Side::North | Side::South => {}
    }
}
