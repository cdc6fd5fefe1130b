//! What lies between two conserving ports: drawn in the line of its wire, or upright where both ports are on one side.

use blocksim_block::Symbol;
use blocksim_layout::{PlacedPort, PortKind, Side};

use super::Pen;
use crate::canvas::{Paint, number};
use crate::colours::Fill;
use crate::figure::Figure;

/// Half the length of a sign.
const HALF: f64 = 17.0;

/// Whether a block is drawn so: not where names of ports would stand in the way of its leads.
pub(crate) fn draws(symbol: Symbol, figure: &Figure) -> bool {
    let pins = figure.ports.iter().filter(|port| port.kind == PortKind::Free).count();
    pins == 2
        && !figure.port_names
        && matches!(
            symbol,
            Symbol::Resistor
                | Symbol::Varistor
                | Symbol::Restriction
                | Symbol::VariableRestriction
                | Symbol::CheckValve
                | Symbol::ReliefValve
                | Symbol::Pipe
                | Symbol::Capacitor
                | Symbol::Inductor
                | Symbol::VoltageSource
                | Symbol::CurrentSource
                | Symbol::AcSource
                | Symbol::Meter(_)
                | Symbol::Diode
                | Symbol::Thyristor
                | Symbol::Transistor
                | Symbol::Contact
                | Symbol::Spring
                | Symbol::Damper
                | Symbol::SpringDamper
                | Symbol::Friction
                | Symbol::HardStop
                | Symbol::Clutch
                | Symbol::Brake
                | Symbol::Freewheel
                | Symbol::MotionSource(_)
                | Symbol::Torque
                | Symbol::Force
                | Symbol::Weld
        )
}

pub(super) fn draw(pen: &mut Pen, symbol: Symbol) {
    let pins: Vec<usize> =
        (0..pen.figure.ports.len()).filter(|i| pen.figure.ports[*i].kind == PortKind::Free).collect();
    let [a, b] = [pins[0], pins[1]].map(|pin| pen.placed.ports[pin]);
    let colour = pen.colour(pins[0]);
    let upright = a.side == b.side;
    let turn = if upright {
        if a.at.y <= b.at.y { " rotate(90)" } else { " rotate(-90)" }
    } else if a.side == Side::West {
        ""
    } else {
        " rotate(180)"
    };
    let paint = Paint { colour, width: 1.6, fill: Fill::Nothing };
    for port in [a, b] {
        let data = lead(pen, &port, upright, if upright { a.at.y.min(b.at.y) == port.at.y } else { false });
        pen.shape(&data, paint);
    }
    sign(pen, symbol, turn, paint);
}

/// From a port to the end of the sign.
fn lead(pen: &Pen, port: &PlacedPort, upright: bool, upper: bool) -> String {
    let (x, y) = (port.at.x - pen.cx, port.at.y - pen.cy);
    if upright {
        let end = if upper { -HALF } else { HALF };
        let near = if port.side == Side::West { x + 5.0 } else { x - 5.0 };
        return format!("M{} {}H{}V{}H0", number(x), number(y), number(near), number(end));
    }
    let end = if port.side == Side::West { -HALF } else { HALF };
    format!("M{} {}H{}V0", number(x), number(y), number(end))
}

/// The sign itself, from (-17, 0) to (17, 0).
fn sign(pen: &mut Pen, symbol: Symbol, turn: &str, paint: Paint) {
    let hollow = Paint { fill: Fill::Ground, ..paint };
    let filled = Paint { fill: Fill::Solid, ..paint };
    match symbol {
        Symbol::Resistor => pen.turned("M-17 0H-13M13 0H17M-13 -5H13V5H-13Z", paint, turn),
        Symbol::Varistor => {
            pen.turned("M-17 0H-13M13 0H17M-13 -5H13V5H-13ZM-14 10H-8L10 -10", paint, turn);
        }
        Symbol::Restriction => pen.turned("M-17 0H17M-9 -8A11 8 0 0 0 9 -8M-9 8A11 8 0 0 1 9 8", paint, turn),
        Symbol::VariableRestriction => {
            pen.turned(
                "M-17 0H17M-9 -8A11 8 0 0 0 9 -8M-9 8A11 8 0 0 1 9 8M-10 11L9 -11M4.5 -10.5L9 -11L8.5 -6.5",
                paint,
                turn,
            );
        }
        Symbol::CheckValve => {
            pen.turned("M-17 0H-9M0 -8L-9 0L0 8M6 0H17", paint, turn);
            pen.turned("M-4 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0Z", hollow, turn);
        }
        Symbol::ReliefValve => {
            pen.turned(
                "M-17 0H-9M9 0H17M-9 -9H9V9H-9ZM-7 4H6M2.5 1.5L6 4L2.5 6.5M0 -9L-3 -11L3 -13L-3 -15L3 -17",
                paint,
                turn,
            );
        }
        Symbol::Pipe => pen.turned("M-17 0H-13M13 0H17M-13 -4H13M-13 4H13M-13 -6V6M13 -6V6", paint, turn),
        Symbol::Capacitor => pen.turned("M-17 0H-3M3 0H17M-3 -9V9M3 -9V9", paint, turn),
        Symbol::Inductor => {
            pen.turned(
                "M-17 0H-14a3.5 4 0 0 1 7 0a3.5 4 0 0 1 7 0a3.5 4 0 0 1 7 0a3.5 4 0 0 1 7 0H17",
                paint,
                turn,
            );
        }
        Symbol::VoltageSource => {
            circle(pen, turn, hollow);
            pen.turned("M-9 0H-3M-6 -3V3M4 -3V3", paint, turn);
        }
        Symbol::CurrentSource => {
            circle(pen, turn, hollow);
            pen.turned("M-8 0H7M3 -3.5L7 0L3 3.5", paint, turn);
        }
        Symbol::AcSource => {
            circle(pen, turn, hollow);
            pen.shape("M-7 0C-5 -7 -2 -7 0 0S5 7 7 0", paint);
        }
        Symbol::Meter(letter) => {
            circle(pen, turn, hollow);
            pen.word(0.0, 0.0, 12.0, letter);
        }
        Symbol::Diode => {
            pen.turned("M-17 0H-7M7 0H17M7 -8V8", paint, turn);
            pen.turned("M-7 -8L7 0L-7 8Z", filled, turn);
        }
        Symbol::Thyristor => {
            pen.turned("M-17 0H-7M7 0H17M7 -8V8M7 0L12 7", paint, turn);
            pen.turned("M-7 -8L7 0L-7 8Z", filled, turn);
        }
        Symbol::Transistor => {
            pen.turned("M-17 0H-8V-6M17 0H8V-6M-11 -6H11M-11 -10H11M4 -1L8 -6L10 -1", paint, turn);
        }
        Symbol::Contact => pen.turned("M-17 0H-8L9 -9M8 0H17", paint, turn),
        Symbol::Spring => {
            pen.turned("M-17 0H-13L-11 -6L-7 6L-3 -6L1 6L5 -6L9 6L11 0H17", paint, turn);
        }
        Symbol::Damper => pen.turned("M-17 0H-6M-6 -7V7M10 -9H-10M10 9H-10M10 -9V9M10 0H17", paint, turn),
        Symbol::SpringDamper => {
            pen.turned(
                "M-17 0H-13M-13 -8V9M-13 -8H-10L-8 -12L-4 -4L0 -12L4 -4L8 -12L10 -8H13M-13 9H-3M-3 4V14M6 3H-6M6 15H-6M6 3V15M6 9H13M13 -8V9M13 0H17",
                paint,
                turn,
            );
        }
        Symbol::Friction => {
            pen.turned("M-17 0H-12V-4M17 0H12V4M-14 -4H12V-2H-14Z", filled, turn);
            pen.turned("M-12 2H14V4H-12Z", hollow, turn);
        }
        Symbol::HardStop => pen.turned("M-17 0H-3M-3 -5V5M3 -9V9M-9 -9V-4M-9 4V9M3 0H17", paint, turn),
        Symbol::Clutch => {
            pen.turned("M-17 0H-3M-3 -10V10M3 -10V10M3 0H17", Paint { width: 2.2, ..paint }, turn)
        }
        Symbol::Freewheel => {
            pen.turned("M-17 0H-3M-3 -10V10M3 -10V10M3 0H17", Paint { width: 2.2, ..paint }, turn);
            pen.turned("M-7 -14H7M4 -16.5L7 -14L4 -11.5", paint, turn);
        }
        Symbol::Brake => {
            // The disc turns with the first pin, the pads belong to the second.
            pen.turned("M-17 0H0M0 -13V8M17 0H10V-9H5M-10 0", Paint { width: 2.0, ..paint }, turn);
            pen.turned("M-6 -14H-2V-4H-6ZM2 -14H6V-4H2Z", filled, turn);
        }
        Symbol::MotionSource(letter) => {
            circle(pen, turn, hollow);
            pen.word(0.0, 0.0, 11.0, letter);
        }
        Symbol::Torque => {
            circle(pen, turn, hollow);
            pen.shape("M-5.5 4A7 7 0 1 1 5.5 4M8.5 2L5 5L2.5 1", paint);
        }
        Symbol::Force => {
            pen.turned("M-17 -7V7M-17 0H-12M12 0H17M-12 -3H5V-7L12 0L5 7V3H-12Z", hollow, turn);
        }
        _ => pen.turned("M-17 0H17M-6 -6L6 6M-6 6L6 -6", paint, turn),
    }
}

fn circle(pen: &mut Pen, turn: &str, paint: Paint) {
    pen.turned("M-17 0H-12M12 0H17M-12 0a12 12 0 1 0 24 0a12 12 0 1 0 -24 0Z", paint, turn);
}
