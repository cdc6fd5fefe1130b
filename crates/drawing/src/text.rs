//! A level with the signs of a terminal.
//!
//! Columns and lines are the places of the drawing in their order, each at least as far from the others as the texts
//! need; so the picture has the same crossings and corners as the one in SVG.

use std::collections::BTreeSet;

use blocksim_block::Symbol;
use blocksim_layout::{Layout, Placed, Point, PortKind, Side};

use crate::figure::{Figure, Look};
use crate::level::Level;

/// Ways out of a cell: up, right, down, left.
const UP: u8 = 1;
const RIGHT: u8 = 2;
const DOWN: u8 = 4;
const LEFT: u8 = 8;

/// Draws a level with box characters, or with plain ASCII.
pub fn text(level: &Level, layout: &Layout, ascii: bool) -> String {
    let (columns, lines) = (Axis::across(level, layout), Axis::down(level, layout));
    let size = (columns.end() + 1, lines.end() + 1);
    let mut sheet =
        Sheet { width: size.0, ways: vec![(0, false); size.0 * size.1], signs: vec![None; size.0 * size.1] };
    for (line, wire) in level.lines.iter().zip(&layout.wires) {
        let strong = line.thick || line.domain.is_some();
        for segment in &wire.segments {
            let from = (columns.of(segment.from.x), lines.of(segment.from.y));
            let to = (columns.of(segment.to.x), lines.of(segment.to.y));
            sheet.line(from, to, strong);
        }
        for Point { x, y } in &wire.junctions {
            sheet.put(columns.of(*x), lines.of(*y), if ascii { 'o' } else { '●' });
        }
    }
    for (figure, placed) in level.figures.iter().zip(&layout.nodes) {
        let (left, right) = (columns.of(placed.x), columns.of(placed.x + placed.width));
        let (upper, lower) = edges(placed);
        let (top, bottom) = (lines.of(upper), lines.of(lower));
        sheet.frame(left, right, top, bottom, ascii);
        let middle = (top + bottom) / 2;
        let words = words(figure);
        let start = middle.saturating_sub((words.len().saturating_sub(1)) / 2).max(top + 1);
        for (i, word) in words.iter().enumerate().filter(|(i, _)| start + i < bottom.max(top + 2)) {
            let inside = right.saturating_sub(left + 1);
            let pad = inside.saturating_sub(word.chars().count()) / 2;
            sheet.write(left + 1 + pad, start + i, word);
        }
        for (look, port) in figure.ports.iter().zip(&placed.ports) {
            let (x, y) = (columns.of(port.at.x), lines.of(port.at.y));
            let sign = match (look.kind, port.side, ascii) {
                (PortKind::Free, _, false) => '□',
                (PortKind::Free, _, true) => '#',
                (PortKind::Output, ..) => continue,
                (_, Side::West, false) => '▶',
                (_, Side::West, true) => '>',
                (_, Side::East, false) => '◀',
                (_, Side::East, true) => '<',
                (_, Side::North, false) => '▼',
                (_, Side::North, true) => 'v',
                (_, Side::South, false) => '▲',
                (_, Side::South, true) => '^',
            };
            sheet.put(x, y, sign);
        }
    }
    let mut out = String::new();
    if !level.title.is_empty() {
        out.push_str(&level.title.chars().filter(|sign| !sign.is_control()).collect::<String>());
        out.push_str("\n\n");
    }
    out.push_str(&sheet.text(ascii));
    out
}

/// What stands in the box of a block.
fn words(figure: &Figure) -> Vec<String> {
    let name: String = figure.name.chars().filter(|sign| !sign.is_control()).collect();
    match &figure.look {
        Look::Pill => vec![name],
        Look::Selector => Vec::new(),
        Look::Subsystem(Some(chosen)) => vec![name, format!("[{chosen}]")],
        Look::Subsystem(None) => vec![name],
        Look::Symbol(Symbol::Sum, texts) => vec![texts.join("")],
        Look::Symbol(Symbol::Ground | Symbol::Housing | Symbol::World, _) => vec![name],
        Look::Symbol(..) => vec![name, figure.kind.clone()],
    }
}

/// Upper and lower edge of a box, as near to its ports as it may be: so boxes in a row have the same.
fn edges(placed: &Placed) -> (f64, f64) {
    let beside = placed.ports.iter().all(|port| matches!(port.side, Side::West | Side::East));
    let (top, bottom) = (placed.y, placed.y + placed.height);
    if !beside || placed.ports.is_empty() {
        return (top, bottom);
    }
    let highest = placed.ports.iter().map(|port| port.at.y).fold(f64::INFINITY, f64::min);
    let lowest = placed.ports.iter().map(|port| port.at.y).fold(f64::NEG_INFINITY, f64::max);
    ((highest - 8.0).max(top), (lowest + 8.0).min(bottom))
}

/// Places of a drawing in cells.
struct Axis {
    places: Vec<(i64, usize)>,
}

impl Axis {
    fn across(level: &Level, layout: &Layout) -> Axis {
        let mut needs = Vec::new();
        for (figure, placed) in level.figures.iter().zip(&layout.nodes) {
            let wide = words(figure).iter().map(|word| word.chars().count()).max().unwrap_or(0);
            let wide = if figure.look == Look::Selector { 0 } else { wide };
            needs.push((placed.x, placed.x + placed.width, wide + 3));
        }
        // A straight wire between two blocks can be seen.
        let is_port = |at: Point| layout.nodes.iter().any(|node| node.ports.iter().any(|port| port.at == at));
        for segment in layout.wires.iter().flat_map(|wire| &wire.segments) {
            if segment.from.y == segment.to.y && is_port(segment.from) && is_port(segment.to) {
                needs.push((segment.from.x, segment.to.x, 3));
            }
        }
        let ports = layout.nodes.iter().flat_map(|node| node.ports.iter().map(|port| port.at.x));
        let wires = layout.wires.iter().flat_map(|wire| &wire.segments);
        Axis::new(ports.chain(wires.flat_map(|s| [s.from.x, s.to.x])), &needs)
    }

    fn down(level: &Level, layout: &Layout) -> Axis {
        let mut needs = Vec::new();
        for (figure, placed) in level.figures.iter().zip(&layout.nodes) {
            let (upper, lower) = edges(placed);
            needs.push((upper, lower, words(figure).len().max(1) + 1));
        }
        let ports = layout.nodes.iter().flat_map(|node| node.ports.iter().map(|port| port.at.y));
        let wires = layout.wires.iter().flat_map(|wire| &wire.segments);
        Axis::new(ports.chain(wires.flat_map(|s| [s.from.y, s.to.y])), &needs)
    }

    /// Every place has a cell of its own, and each need (from, to, cells) is met.
    fn new(places: impl Iterator<Item = f64>, needs: &[(f64, f64, usize)]) -> Axis {
        let key = |place: f64| (place * 2.0).round() as i64;
        let mut all: BTreeSet<i64> = places.map(key).collect();
        all.extend(needs.iter().flat_map(|(from, to, _)| [key(*from), key(*to)]));
        let mut axis = Axis { places: Vec::with_capacity(all.len()) };
        for place in all {
            let mut cell = axis.places.last().map_or(0, |(_, last)| last + 1);
            for (from, _, cells) in needs.iter().filter(|(_, to, _)| key(*to) == place) {
                cell = cell.max(axis.of(*from) + cells);
            }
            axis.places.push((place, cell));
        }
        axis
    }

    fn of(&self, place: f64) -> usize {
        let key = (place * 2.0).round() as i64;
        match self.places.binary_search_by_key(&key, |(place, _)| *place) {
            Ok(at) => self.places[at].1,
            Err(_) => 0,
        }
    }

    fn end(&self) -> usize {
        self.places.last().map_or(0, |(_, cell)| *cell)
    }
}

/// Cells with lines and signs.
struct Sheet {
    width: usize,
    ways: Vec<(u8, bool)>,
    signs: Vec<Option<char>>,
}

impl Sheet {
    fn add(&mut self, x: usize, y: usize, ways: u8, strong: bool) {
        if let Some(cell) = self.ways.get_mut(y * self.width + x) {
            cell.0 |= ways;
            cell.1 |= strong;
        }
    }

    fn put(&mut self, x: usize, y: usize, sign: char) {
        if let Some(cell) = self.signs.get_mut(y * self.width + x) {
            *cell = Some(sign);
        }
    }

    fn write(&mut self, x: usize, y: usize, word: &str) {
        for (i, sign) in word.chars().take(self.width.saturating_sub(x)).enumerate() {
            self.put(x + i, y, sign);
        }
    }

    fn line(&mut self, from: (usize, usize), to: (usize, usize), strong: bool) {
        let (first, second) = if from.1 == to.1 { (RIGHT, LEFT) } else { (DOWN, UP) };
        let steps = (to.0 - from.0).max(to.1 - from.1);
        for step in 0..=steps {
            let at = if from.1 == to.1 { (from.0 + step, from.1) } else { (from.0, from.1 + step) };
            let ways = if step < steps { first } else { 0 } | if step > 0 { second } else { 0 };
            self.add(at.0, at.1, ways, strong);
        }
    }

    fn frame(&mut self, left: usize, right: usize, top: usize, bottom: usize, ascii: bool) {
        let corners = if ascii { ['+'; 4] } else { ['┌', '┐', '└', '┘'] };
        let (level, upright) = if ascii { ('-', '|') } else { ('─', '│') };
        for y in top..=bottom {
            for x in left..=right {
                let sign = match (y == top, y == bottom, x == left, x == right) {
                    (true, _, true, _) => corners[0],
                    (true, _, _, true) => corners[1],
                    (_, true, true, _) => corners[2],
                    (_, true, _, true) => corners[3],
                    (true, ..) | (_, true, ..) => level,
                    (_, _, true, _) | (_, _, _, true) => upright,
                    _ => ' ',
                };
                self.put(x, y, sign);
            }
        }
    }

    fn text(&self, ascii: bool) -> String {
        let mut out = String::new();
        for (ways, signs) in self.ways.chunks(self.width).zip(self.signs.chunks(self.width)) {
            let line: String = ways
                .iter()
                .zip(signs)
                .map(|(ways, sign)| sign.unwrap_or_else(|| joint(*ways, ascii)))
                .collect();
            out.push_str(line.trim_end());
            out.push('\n');
        }
        out
    }
}

fn joint((ways, strong): (u8, bool), ascii: bool) -> char {
    if ascii {
        return match ways {
            0 => ' ',
            ways if ways & (UP | DOWN) == 0 => {
                if strong {
                    '='
                } else {
                    '-'
                }
            }
            ways if ways & (LEFT | RIGHT) == 0 => '|',
            _ => '+',
        };
    }
    let plain = [' ', '╵', '╶', '└', '╷', '│', '┌', '├', '╴', '┘', '─', '┴', '┐', '┤', '┬', '┼'];
    let double = [' ', '║', '═', '╚', '║', '║', '╔', '╠', '═', '╝', '═', '╩', '╗', '╣', '╦', '╬'];
    if strong { double[usize::from(ways)] } else { plain[usize::from(ways)] }
}
