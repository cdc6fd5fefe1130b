//! The signs of the field.

mod curves;
mod parts;
pub(crate) mod two_pins;

use blocksim_block::Symbol;
use blocksim_layout::{Placed, PortKind, Side};
use blocksim_picture::text_width;

use crate::canvas::{Canvas, Paint, THIN, number};
use crate::colours::{Colour, Fill};
use crate::figure::{Figure, Look};
use crate::fonts::{NAME, PORT, TEXT};

/// Strokes of what is heavier than the rest.
const THICK: f64 = 1.6;

/// Draws the sign of a block into its box.
pub(crate) fn draw(canvas: &mut Canvas, figure: &Figure, placed: &Placed) {
    let box_paint = Paint { colour: Colour::Ink, width: THIN, fill: Fill::Ground };
    let (cx, cy) = (placed.x + placed.width / 2.0, placed.y + placed.height / 2.0);
    match &figure.look {
        Look::Pill => pill(canvas, figure, placed),
        Look::Selector => {
            let data = rectangle(placed.x, placed.y, placed.width, placed.height, 0.0);
            canvas.path(&data, Paint { fill: Fill::Solid, ..box_paint }, "");
        }
        Look::Subsystem(variant) => {
            let data = rectangle(placed.x, placed.y, placed.width, placed.height, 3.0);
            canvas.path(&data, Paint { width: THICK, fill: Fill::Inside, ..box_paint }, "frame");
            if let Some(chosen) = variant {
                // At the lower edge, where no names of ports are.
                let wide = text_width(chosen, PORT) + 8.0;
                let y = placed.y + placed.height;
                canvas.path(&rectangle(cx - wide / 2.0, y - 7.0, wide, 13.0, 6.0), box_paint, "");
                canvas.text(cx, y + 2.5, PORT, "middle", Colour::Ink, chosen);
            }
        }
        Look::Symbol(symbol, texts) => {
            let mut pen = Pen { canvas, cx, cy, placed, figure };
            pen.symbol(*symbol, texts);
        }
    }
}

/// A port of the level: rounded for a signal, pointed for a conserving one.
fn pill(canvas: &mut Canvas, figure: &Figure, placed: &Placed) {
    let (x, y, w, h) = (placed.x, placed.y, placed.width, placed.height);
    let port = figure.ports.first();
    let conserving = port.is_some_and(|port| port.kind == PortKind::Free);
    let colour = Colour::of(port.and_then(|port| port.domain));
    let data = if conserving {
        format!(
            "M{} {}h{}l6 {}l-6 {}h-{}l-6 -{}Z",
            number(x + 6.0),
            number(y),
            number(w - 12.0),
            number(h / 2.0),
            number(h / 2.0),
            number(w - 12.0),
            number(h / 2.0)
        )
    } else {
        rectangle(x, y, w, h, h / 2.0)
    };
    canvas.path(&data, Paint { colour, width: THIN, fill: Fill::Inside }, "frame");
    canvas.text(x + w / 2.0, y + h / 2.0 + NAME * 0.35, NAME, "middle", Colour::Ink, &figure.name);
}

pub(crate) fn rectangle(x: f64, y: f64, w: f64, h: f64, r: f64) -> String {
    let (w, h) = (w.max(0.0), h.max(0.0));
    if r == 0.0 {
        return format!("M{} {}h{}v{}h-{}Z", number(x), number(y), number(w), number(h), number(w));
    }
    let r = r.min(w / 2.0).min(h / 2.0);
    let (across, down) = (number(w - 2.0 * r), number(h - 2.0 * r));
    let arc = |dx: f64, dy: f64| format!("a{0} {0} 0 0 1 {1} {2}", number(r), number(dx), number(dy));
    format!(
        "M{} {}h{across}{}v{down}{}h-{across}{}v-{down}{}Z",
        number(x + r),
        number(y),
        arc(r, r),
        arc(-r, r),
        arc(-r, -r),
        arc(r, -r)
    )
}

/// Draws around the middle of a box.
pub(crate) struct Pen<'a> {
    pub canvas: &'a mut Canvas,
    pub cx: f64,
    pub cy: f64,
    pub placed: &'a Placed,
    pub figure: &'a Figure,
}

impl Pen<'_> {
    pub fn ink(&self) -> Paint {
        Paint { colour: Colour::Ink, width: THIN, fill: Fill::Nothing }
    }

    pub fn solid(&self) -> Paint {
        Paint { fill: Fill::Solid, ..self.ink() }
    }

    pub fn hollow(&self) -> Paint {
        Paint { fill: Fill::Ground, ..self.ink() }
    }

    /// A path around the middle of the box.
    pub fn shape(&mut self, data: &str, paint: Paint) {
        self.turned(data, paint, "");
    }

    /// The same, mirrored where the block is.
    pub fn facing(&mut self, data: &str, paint: Paint) {
        self.turned(data, paint, if self.placed.mirrored { " scale(-1 1)" } else { "" });
    }

    pub fn turned(&mut self, data: &str, paint: Paint, turn: &str) {
        self.canvas.path_at(self.cx, self.cy, turn, data, paint);
    }

    pub fn disc(&mut self, x: f64, y: f64, r: f64, paint: Paint) {
        self.canvas.circle(self.cx + x, self.cy + y, r, paint);
    }

    /// Text whose middle is `(x, y)` from the middle of the box.
    pub fn word(&mut self, x: f64, y: f64, size: f64, text: &str) {
        self.canvas.text(self.cx + x, self.cy + y + size * 0.36, size, "middle", Colour::Ink, text);
    }

    /// The box.
    pub fn frame(&mut self) {
        let Placed { x, y, width, height, .. } = *self.placed;
        let paint = self.hollow();
        self.canvas.path(&rectangle(x, y, width, height, 0.0), paint, "frame");
    }

    /// A box of its own light line, for signs that would otherwise stand free.
    pub fn light_frame(&mut self) {
        let Placed { x, y, width, height, .. } = *self.placed;
        let paint = Paint { colour: Colour::Quiet, width: 0.8, fill: Fill::Ground };
        self.canvas.path(&rectangle(x, y, width, height, 3.0), paint, "frame");
    }

    /// Moves the middle to that of the room between the names of the ports.
    fn between_names(&mut self) {
        if !self.figure.port_names {
            return;
        }
        let widest = |side: Side| {
            self.figure
                .ports
                .iter()
                .zip(&self.placed.ports)
                .filter(|(_, port)| port.side == side)
                .map(|(look, _)| text_width(&look.name, PORT))
                .fold(0.0, f64::max)
        };
        self.cx += (widest(Side::West) - widest(Side::East)) / 2.0;
    }

    fn symbol(&mut self, symbol: Symbol, texts: &[String]) {
        let text = |i: usize| texts.get(i).map_or("", String::as_str);
        let signals = self.figure.ports.iter().any(|port| port.kind != PortKind::Free);
        match symbol {
            Symbol::Plain | Symbol::Value(_) => {
                self.frame();
                self.between_names();
                self.word(0.0, 0.0, TEXT, text(0));
            }
            Symbol::Plugin => self.plugin(text(0)),
            Symbol::Text(own) => {
                self.frame();
                self.between_names();
                self.word(0.0, 0.0, TEXT, own);
            }
            Symbol::Fraction(above, below) => self.fraction(above, below),
            Symbol::Lines(first, second) => {
                self.frame();
                self.between_names();
                self.word(0.0, -8.0, NAME, first);
                self.word(0.0, 7.0, NAME, second);
            }
            Symbol::Polynomials(_) => self.fraction(text(0), text(1)),
            Symbol::Gain(_) => self.gain(text(0)),
            Symbol::Sum => self.sum(text(0)),
            Symbol::Curve(curve) => {
                self.frame();
                self.between_names();
                curves::draw(self, curve);
            }
            Symbol::Scope => self.scope(),
            Symbol::Bar => {
                let paint = if self.figure.port_names { self.hollow() } else { self.solid() };
                let Placed { x, y, width, height, .. } = *self.placed;
                self.canvas.path(&rectangle(x, y, width, height, 0.0), paint, "frame");
                if self.figure.port_names {
                    let solid = self.solid();
                    let out = self.figure.ports.iter().filter(|port| port.kind == PortKind::Output).count();
                    let at = if (out == 1) == self.placed.mirrored { x } else { x + width - 5.0 };
                    self.canvas.path(&rectangle(at, y, 5.0, height, 0.0), solid, "");
                }
            }
            Symbol::Switch => self.switch(),
            Symbol::Terminator => self.facing("M-8 0H4M4 -8V8", Paint { width: THICK, ..self.ink() }),
            Symbol::Ground => self.ground(),
            Symbol::Housing => self.housing(),
            _ if two_pins::draws(symbol, self.figure) => {
                if signals || self.figure.ports.len() > 2 {
                    self.light_frame();
                }
                two_pins::draw(self, symbol);
            }
            other => {
                self.light_frame();
                self.between_names();
                parts::draw(self, other);
            }
        }
    }

    fn fraction(&mut self, above: &str, below: &str) {
        self.frame();
        let wide = text_width(above, TEXT).max(text_width(below, TEXT)).max(10.0) / 2.0 + 2.0;
        self.shape(&format!("M-{0} 0H{0}", number(wide)), self.ink());
        self.word(0.0, -8.0, TEXT, above);
        self.word(0.0, 8.5, TEXT, below);
    }

    fn gain(&mut self, text: &str) {
        let (w, h) = (self.placed.width / 2.0, self.placed.height / 2.0);
        let data = format!("M-{0} -{1}L{0} 0L-{0} {1}Z", number(w), number(h));
        self.facing(&data, self.hollow());
        let aside = if self.placed.mirrored { w / 3.0 } else { -w / 3.0 };
        self.word(aside, 0.0, TEXT - 1.0, text);
    }

    fn sum(&mut self, signs: &str) {
        let signs: Vec<char> = signs.chars().collect();
        let inputs: Vec<usize> =
            (0..self.figure.ports.len()).filter(|i| self.figure.ports[*i].kind == PortKind::Input).collect();
        let round = self.placed.height <= 28.0;
        if round {
            self.disc(0.0, 0.0, 13.0, self.hollow());
        } else {
            self.frame();
        }
        if signs.len() == 1 && round {
            self.word(0.0, 0.0, TEXT + 1.0, "Σ");
            return;
        }
        for (sign, &port) in signs.iter().zip(&inputs) {
            let Some(port) = self.placed.ports.get(port) else { continue };
            let sign = if *sign == '-' { "−" } else { "+" };
            let (x, y) = match (port.side, round) {
                (Side::West, true) => (-7.0, -0.5),
                (Side::East, true) => (6.5, 0.0),
                (Side::North, _) => (0.0, -7.0),
                (Side::South, _) => (0.0, 7.0),
                (Side::West, false) => (-8.0, port.at.y - self.cy),
                (Side::East, false) => (8.0, port.at.y - self.cy),
            };
            self.word(x, y, 10.0, sign);
        }
    }

    fn scope(&mut self) {
        self.frame();
        let right = self.placed.x + self.placed.width;
        let left = right - 40.0;
        let (kept_x, kept_y) = (self.cx, self.cy);
        (self.cx, self.cy) = ((left + right) / 2.0, self.placed.y + 16.0);
        if self.placed.height < 40.0 {
            self.cy = kept_y;
        }
        let screen = Paint { fill: Fill::Inside, ..self.ink() };
        self.shape("M-15 -11H15V11H-15Z", screen);
        self.shape("M-12 7C-8 7 -8 -7 -3 -7S2 4 5 2S8 -2 12 -2", self.ink());
        (self.cx, self.cy) = (kept_x, kept_y);
    }

    fn plugin(&mut self, name: &str) {
        self.frame();
        self.between_names();
        self.word(0.0, 0.0, TEXT, name);
        // A plug in the corner.
        let (x, y) = (self.placed.x + self.placed.width, self.placed.y);
        let data = format!("M{} {}h-9v-3h-3v-6h3v-3h9", number(x), number(y + 12.0));
        let paint = Paint { colour: Colour::Quiet, width: 1.0, fill: Fill::Nothing };
        self.canvas.path(&data, paint, "");
    }

    fn switch(&mut self) {
        self.frame();
        let (figure, placed, middle) = (self.figure, self.placed, self.cy);
        let side = |name: &str| {
            let at = figure.ports.iter().position(|port| port.name == name)?;
            placed.ports.get(at).map(|port| port.at.y - middle)
        };
        let out = self.figure.ports.iter().position(|port| port.kind == PortKind::Output);
        let out = out.and_then(|at| self.placed.ports.get(at)).map_or(0.0, |port| port.at.y - self.cy);
        let (first, third) = (side("u1").unwrap_or(-18.0), side("u3").unwrap_or(18.0));
        let edge = self.placed.width / 2.0;
        let data = format!(
            "M-{edge} {a}H-10M-{edge} {b}H-10M{edge} {c}H10L-9 {d}",
            edge = number(edge),
            a = number(first),
            b = number(third),
            c = number(out),
            d = number(first + 1.5)
        );
        self.facing(&data, self.ink());
        if let Some(control) = side("control") {
            self.facing(
                &format!("M-{} {}H-2", number(edge), number(control)),
                Paint { width: 0.8, ..self.ink() },
            );
        }
        for y in [first, third] {
            let x = if self.placed.mirrored { 10.0 } else { -10.0 };
            self.disc(x, y, 2.0, self.hollow());
        }
    }

    fn turn_of_port(&self) -> &'static str {
        match self.placed.ports.first().map(|port| port.side) {
            Some(Side::West) => " rotate(-90)",
            Some(Side::East) => " rotate(90)",
            _ => "",
        }
    }

    fn ground(&mut self) {
        let turn = self.turn_of_port();
        let reach = if turn.is_empty() { self.placed.height } else { self.placed.width } / 2.0;
        let data = format!("M0 -{}V-2M-10 -2H10M-6.5 2H6.5M-3 6H3", number(reach));
        let paint = Paint { colour: self.colour(0), width: THICK, fill: Fill::Nothing };
        self.turned(&data, paint, turn);
    }

    fn housing(&mut self) {
        let turn = self.turn_of_port();
        let reach = if turn.is_empty() { self.placed.height } else { self.placed.width } / 2.0;
        let data =
            format!("M0 -{}V0M-12 0H12M-10 0l-4 6M-4 0l-4 6M2 0l-4 6M8 0l-4 6M12 0l-3 4.5", number(reach));
        let paint = Paint { colour: self.colour(0), width: THIN, fill: Fill::Nothing };
        self.turned(&data, paint, turn);
    }

    /// Colour of what a port carries.
    pub fn colour(&self, port: usize) -> Colour {
        Colour::of(self.figure.ports.get(port).and_then(|port| port.domain))
    }
}
