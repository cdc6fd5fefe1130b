//! Machines, gears, joints and bodies.

use blocksim_block::Symbol;

use super::Pen;
use crate::canvas::Paint;
use crate::colours::{Colour, Fill};

pub(super) fn draw(pen: &mut Pen, symbol: Symbol) {
    let ink = pen.ink();
    let bold = Paint { width: 1.6, ..ink };
    let (hollow, solid) = (pen.hollow(), pen.solid());
    let quiet = Paint { colour: Colour::Quiet, ..ink };
    match symbol {
        Symbol::Machine(letters) => {
            pen.disc(0.0, 0.0, 19.0, Paint { width: 1.6, ..hollow });
            match letters.split_once(' ') {
                Some((letter, current)) => {
                    pen.word(0.0, -4.0, 13.0, letter);
                    pen.word(0.0, 9.0, 10.0, current);
                }
                None => pen.word(0.0, 0.0, 14.0, letters),
            }
        }
        Symbol::Converter(from, to) => {
            pen.shape("M-15 -15H15V15H-15ZM-15 15L15 -15", ink);
            pen.word(-7.0, -7.0, 12.0, from);
            pen.word(7.0, 7.0, 12.0, to);
        }
        Symbol::Transistor => {
            pen.shape(
                "M-14 0H-8M-8 -9V9M-4 -11V11M-4 -6H10M-4 6H10M-4 6L1 3M-4 6L1 9M10 -15V-6M10 6V15",
                bold,
            );
        }
        Symbol::Transformer => {
            pen.shape("M-8 -14a4 3.5 0 0 1 0 7a4 3.5 0 0 1 0 7a4 3.5 0 0 1 0 7a4 3.5 0 0 1 0 7", bold);
            pen.shape("M8 -14a4 3.5 0 0 0 0 7a4 3.5 0 0 0 0 7a4 3.5 0 0 0 0 7a4 3.5 0 0 0 0 7", bold);
            pen.shape("M-1.5 -14V14M1.5 -14V14", ink);
        }
        Symbol::Gear => {
            wheel(pen, -7.0, 2.0, 9.0, 10, bold);
            wheel(pen, 9.5, -4.0, 6.0, 7, bold);
        }
        Symbol::ElasticGear => {
            wheel(pen, -9.0, -3.0, 8.0, 9, bold);
            wheel(pen, 5.5, -7.0, 5.0, 6, bold);
            pen.shape("M-15 13H-10L-8 9L-4 17L0 9L4 17L8 9L10 13H15", ink);
        }
        Symbol::Planetary => {
            pen.disc(0.0, 0.0, 16.0, Paint { fill: Fill::Inside, ..bold });
            for (x, y) in [(0.0, -10.3), (8.9, 5.1), (-8.9, 5.1)] {
                pen.disc(x, y, 5.0, hollow);
            }
            pen.disc(0.0, 0.0, 5.2, hollow);
            pen.disc(0.0, 0.0, 1.4, solid);
        }
        Symbol::WaveGear => {
            pen.disc(0.0, 0.0, 16.0, Paint { fill: Fill::Inside, ..bold });
            pen.turned("M-14.5 0A14.5 10.5 0 0 1 14.5 0A14.5 10.5 0 0 1 -14.5 0Z", hollow, " rotate(-30)");
            pen.turned("M-9 0A9 6 0 0 1 9 0A9 6 0 0 1 -9 0Z", hollow, " rotate(-30)");
            pen.disc(0.0, 0.0, 1.6, solid);
        }
        Symbol::Worm => {
            wheel(pen, 0.0, 6.0, 9.0, 11, bold);
            pen.shape(
                "M-17 -14H17V-6H-17ZM-14 -6L-10 -14M-8 -6L-4 -14M-2 -6L2 -14M4 -6L8 -14M10 -6L14 -14",
                hollow,
            );
        }
        Symbol::Differential => {
            let inside = Paint { fill: Fill::Inside, ..bold };
            pen.shape("M-18 0H-10M10 0H18M0 -18V-12", Paint { width: 2.2, ..ink });
            pen.shape("M-13 -12H13V12H-13Z", ink);
            pen.shape(
                "M-10 -8L-4 -4V4L-10 8ZM10 -8L4 -4V4L10 8ZM-8 -10L-4 -5H4L8 -10ZM-8 10L-4 5H4L8 10Z",
                inside,
            );
        }
        Symbol::Screw => {
            pen.shape(
                "M-18 -4H18V4H-18ZM-14 -4L-11 4M-9 -4L-6 4M-4 -4L-1 4M1 -4L4 4M6 -4L9 4M11 -4L14 4",
                ink,
            );
            pen.shape("M-6 -9H6V-4H-6ZM-6 4H6V9H-6Z", solid);
        }
        Symbol::Restriction => pen.shape("M-17 0H17M-9 -8A11 8 0 0 0 9 -8M-9 8A11 8 0 0 1 9 8", bold),
        Symbol::VariableRestriction => {
            pen.shape(
                "M-17 0H17M-9 -8A11 8 0 0 0 9 -8M-9 8A11 8 0 0 1 9 8M-10 11L9 -11M4.5 -10.5L9 -11L8.5 -6.5",
                bold,
            );
        }
        Symbol::CheckValve => {
            pen.shape("M-17 0H-9M0 -8L-9 0L0 8M6 0H17", bold);
            pen.disc(1.0, 0.0, 5.0, hollow);
        }
        Symbol::ReliefValve => {
            pen.shape(
                "M-17 0H-9M9 0H17M-9 -9H9V9H-9ZM-7 4H6M2.5 1.5L6 4L2.5 6.5M0 -9L-3 -11L3 -13L-3 -15L3 -17",
                bold,
            );
        }
        Symbol::Pipe => pen.shape("M-17 -4H17M-17 4H17", bold),
        Symbol::SpoolValve => {
            pen.shape("M-27 -10H27V10H-27ZM-9 -10V10M9 -10V10", ink);
            // Straight through, closed, crossed.
            pen.shape("M-22 8V-7M-24 -4L-22 -8L-20 -4M-14 -8V7M-16 4L-14 8L-12 4", ink);
            pen.shape("M-4 10V5M-6 5H-2M4 10V5M2 5H6M-4 -10V-5M-6 -5H-2M4 -10V-5M2 -5H6", ink);
            pen.shape("M13 8L23 -7M19.5 -5.5L23 -8L23.5 -3.5M13 -8L23 7M19.5 5.5L23 8L23.5 3.5", ink);
        }
        Symbol::Tank => pen.shape("M-11 -6V7H11V-6M0 -9V2", bold),
        Symbol::Pump => {
            pen.disc(0.0, 0.0, 16.0, Paint { width: 1.6, ..hollow });
            pen.shape("M-6 -8L0 -16L6 -8Z", solid);
        }
        Symbol::Accumulator => {
            pen.shape("M-9 -8A9 8 0 0 1 9 -8V7A9 8 0 0 1 -9 7Z", Paint { fill: Fill::Inside, ..bold });
            pen.shape("M-9 0C-4 4 4 -4 9 0", ink);
            pen.shape("M-3 -10L0 -6L3 -10Z", hollow);
        }
        Symbol::HydraulicCylinder => {
            pen.shape("M-22 -10H12V10H-22Z", Paint { fill: Fill::Inside, ..bold });
            pen.shape("M-9 -10H-4V10H-9Z", solid);
            pen.shape("M-4 -2.5H24V2.5H-4Z", hollow);
        }
        Symbol::Rack => {
            wheel(pen, 0.0, -5.0, 8.0, 9, bold);
            pen.shape("M-18 6l3 -2l3 2l3 -2l3 2l3 -2l3 2l3 -2l3 2l3 -2l3 2l3 -2l3 2V11H-18Z", ink);
        }
        Symbol::Inertia => {
            pen.shape("M-3 -13H5V13H-3Z", Paint { fill: Fill::Inside, ..bold });
            pen.shape("M-16 0H-3M5 0H12", bold);
        }
        Symbol::Mass => {
            pen.shape("M-14 -9H14V9H-14Z", Paint { fill: Fill::Inside, ..bold });
            pen.word(0.0, 0.0, 11.0, "m");
        }
        Symbol::Sensor(text) => pen.word(0.0, 0.0, 11.0, text),
        Symbol::Hinge => {
            pen.shape("M-20 0H-7M7 0H20", Paint { width: 2.2, ..ink });
            pen.disc(0.0, 0.0, 7.5, Paint { width: 1.6, ..hollow });
            pen.disc(0.0, 0.0, 1.8, solid);
            pen.shape("M-8 -11A13 13 0 0 1 9 -10M9 -10L4.6 -11.6M9 -10L6.5 -14", ink);
        }
        Symbol::Slide => {
            pen.shape("M-20 0H20", Paint { width: 2.2, ..ink });
            pen.shape("M-8 -6H8V6H-8Z", Paint { width: 1.6, ..hollow });
            pen.shape("M-10 -11H10M7 -13.5L10 -11L7 -8.5M-7 -13.5L-10 -11L-7 -8.5", ink);
        }
        Symbol::Cylinder => {
            pen.shape("M-20 0H20", Paint { width: 2.2, ..ink });
            pen.shape("M-9 -6H9V6H-9Z", Paint { width: 1.6, ..hollow });
            pen.shape("M-10 -12H10M7 -14.5L10 -12L7 -9.5M-7 -14.5L-10 -12L-7 -9.5M-6 10A7 4 0 0 0 6 10M2 11L6 10L7 14", ink);
        }
        Symbol::Planar => {
            pen.shape("M-18 10L-8 -2H18L8 10Z", Paint { fill: Fill::Inside, ..bold });
            pen.shape("M-5 4H9M6 1.5L9 4L6 6.5M-1 7L5 0M5 0L1.5 1M5 0L4.6 3.6", ink);
            pen.shape("M-7 -7A7 4 0 0 1 7 -7M3.5 -9L7 -7L8 -11", ink);
        }
        Symbol::Universal => {
            pen.shape(
                "M-20 0H-11M-4 -8A8 8 0 0 0 -4 8M11 0H20M4 -8A8 8 0 0 1 4 8",
                Paint { width: 2.2, ..ink },
            );
            pen.shape("M-4 -8L4 8M-4 8L4 -8", bold);
            pen.disc(0.0, 0.0, 2.2, solid);
        }
        Symbol::Touch => {
            pen.shape("M-17 9H17M-14 9l-4 5M-6 9l-4 5M2 9l-4 5M10 9l-4 5M17 9l-3 4", bold);
            pen.disc(0.0, -2.0, 8.0, Paint { fill: Fill::Inside, ..bold });
            pen.disc(0.0, 6.0, 2.0, solid);
        }
        Symbol::Ball => {
            pen.shape("M-20 0H-8M6 0H20", Paint { width: 2.2, ..ink });
            pen.disc(0.0, 0.0, 6.0, solid);
            pen.shape("M6 -8A10 10 0 1 0 6 8", bold);
        }
        Symbol::Weld => pen.shape("M-18 0H18M-6 -6L6 6M-6 6L6 -6", bold),
        Symbol::Body => {
            pen.shape(
                "M-15 4C-17 -8 -6 -12 2 -11S17 -6 15 3S2 12 -5 11S-14 9 -15 4Z",
                Paint { fill: Fill::Inside, ..bold },
            );
            pen.disc(0.0, 0.0, 5.0, hollow);
            pen.shape("M0 0V-5A5 5 0 0 1 5 0ZM0 0V5A5 5 0 0 1 -5 0Z", solid);
        }
        Symbol::Frame => {
            pen.shape("M-14 10V-1M-14 10H-3", bold);
            pen.shape("M3 4V-9M3 4H15", bold);
            pen.shape("M-14 10L3 4", Paint { width: 1.0, ..quiet });
            pen.disc(-14.0, 10.0, 1.8, solid);
            pen.disc(3.0, 4.0, 1.8, solid);
        }
        Symbol::World => {
            pen.shape("M-6 6V-10M-6 6H11M-6 6L-12 12M-8 -7L-6 -11L-4 -7M8 4L12 6L8 8", bold);
            pen.disc(-6.0, 6.0, 2.0, solid);
        }
        Symbol::Force => pen.shape("M-16 -3H4V-8L14 0L4 8V3H-16Z", hollow),
        Symbol::Torque => pen.shape("M-8 7A11 11 0 1 1 8 7M12 4L8 8L5 3", bold),
        Symbol::Star => {
            pen.shape("M-15 -11H-8L0 0M15 -11H8L0 0V13", bold);
            pen.disc(0.0, 0.0, 2.4, solid);
        }
        Symbol::Phases => pen
            .shape("M-18 0H-5L7 -11H18M-5 0H18M-5 0L7 11H18M-15 4L-12 -4M-12.5 4L-9.5 -4M-10 4L-7 -4", bold),
        Symbol::Arm(formula) => {
            let shift = if formula.is_empty() { 0.0 } else { -7.0 };
            pen.cy += shift;
            arm(pen, bold, hollow, solid);
            pen.cy -= shift;
            pen.word(0.0, 19.0, 10.0, formula);
        }
        Symbol::Brake => {
            pen.shape(
                "M-18 0H-1M-1 -10V14M-9 -17H9M-8 -17l3 -3M-2 -17l3 -3M4 -17l3 -3M-6 -17V-9M6 -17V-9",
                bold,
            );
            pen.shape("M-6 -13H-3V-3H-6ZM1 -13H6V-3H1Z", solid);
        }
        Symbol::Freewheel => {
            pen.shape("M-18 0H-3M-3 -10V10M3 -10V10M3 0H18", Paint { width: 2.2, ..ink });
            pen.shape("M-7 -14H7M4 -16.5L7 -14L4 -11.5", ink);
        }
        Symbol::MotionSource(letter) => {
            pen.disc(0.0, 0.0, 13.0, Paint { width: 1.6, ..hollow });
            pen.word(0.0, 0.0, 12.0, letter);
        }
        Symbol::Clutch => pen.shape("M-18 0H-3M-3 -10V10M3 -10V10M3 0H18", Paint { width: 2.2, ..ink }),
        Symbol::Contact => pen.shape("M-18 -8H-8L7 -14M8 -8H18M-18 8H-8L7 2M8 8H18", bold),
        Symbol::Capacitor => pen.shape("M0 -14V-3M0 3V14M-10 -3H10M-10 3H10", bold),
        Symbol::Inductor => {
            pen.shape("M-14 0a3.5 4 0 0 1 7 0a3.5 4 0 0 1 7 0a3.5 4 0 0 1 7 0a3.5 4 0 0 1 7 0", bold);
        }
        Symbol::Varistor => pen.shape("M-14 -5H14V5H-14ZM-14 10H-8L10 -10", bold),
        Symbol::Resistor => pen.shape("M-14 -5H14V5H-14Z", bold),
        Symbol::AcSource => {
            pen.disc(0.0, 0.0, 14.0, Paint { width: 1.6, ..hollow });
            pen.shape("M-8 0C-6 -8 -2 -8 0 0S6 8 8 0", bold);
        }
        Symbol::VoltageSource | Symbol::CurrentSource => {
            pen.disc(0.0, 0.0, 14.0, Paint { width: 1.6, ..hollow });
            pen.shape("M-4 -6H4M0 -10V-2M-4 7H4", bold);
        }
        Symbol::Meter(letter) => {
            pen.disc(0.0, 0.0, 13.0, Paint { width: 1.6, ..hollow });
            pen.word(0.0, 0.0, 12.0, letter);
        }
        Symbol::Diode | Symbol::Thyristor => {
            pen.shape("M-16 0H-7M7 0H16M7 -8V8", bold);
            pen.shape("M-7 -8L7 0L-7 8Z", solid);
        }
        Symbol::Spring => pen.shape("M-17 0H-13L-11 -6L-7 6L-3 -6L1 6L5 -6L9 6L11 0H17", bold),
        Symbol::Damper => pen.shape("M-17 0H-6M-6 -7V7M10 -9H-10M10 9H-10M10 -9V9M10 0H17", bold),
        Symbol::SpringDamper => {
            pen.shape("M-14 -6H-11L-9 -10L-5 -2L-1 -10L3 -2L7 -10L9 -6H14M-14 8H-3M-3 3V13M6 3H-6M6 13H-6M6 3V13M6 8H14", ink);
        }
        Symbol::Friction => {
            pen.shape("M-14 -4H12V-1H-14Z", solid);
            pen.shape("M-12 1H14V4H-12Z", hollow);
        }
        Symbol::HardStop => pen.shape("M-16 0H-2M-2 -4V4M3 -9V9M3 0H16", bold),
        _ => {
            let kind = pen.figure.kind.clone();
            pen.word(0.0, 0.0, 9.0, &kind);
        }
    }
}

/// An arm of two links on its base, with a gripper.
fn arm(pen: &mut Pen, bold: Paint, hollow: Paint, solid: Paint) {
    let links = Paint { width: 3.4, ..bold };
    pen.shape("M-15 16L-12 9H-2L1 16Z", solid);
    pen.shape("M-7 8L-9 -8M-9 -8L8 -12", links);
    pen.shape("M8 -12L13 -9M13 -9L11 -4L13 0M13 -9L18 -7L19 -2", bold);
    for (x, y) in [(-7.0, 7.0), (-9.0, -8.0), (8.0, -12.0)] {
        pen.disc(x, y, 3.4, hollow);
    }
}

/// A wheel with teeth.
fn wheel(pen: &mut Pen, x: f64, y: f64, r: f64, teeth: u32, paint: Paint) {
    let mut data = String::new();
    for tooth in 0..teeth {
        let step = std::f64::consts::TAU / f64::from(teeth);
        for (part, reach) in [(0.0, 0.0), (0.18, 2.2), (0.48, 2.2), (0.66, 0.0)] {
            let angle = (f64::from(tooth) + part) * step;
            let (s, c) = angle.sin_cos();
            let command = if data.is_empty() { 'M' } else { 'L' };
            data.push_str(&format!(
                "{command}{} {}",
                crate::canvas::number(x + (r + reach) * c),
                crate::canvas::number(y + (r + reach) * s)
            ));
        }
    }
    data.push('Z');
    pen.shape(&data, Paint { width: 1.1, fill: Fill::Inside, ..paint });
    pen.disc(x, y, 2.0, Paint { width: 1.0, ..paint });
}
