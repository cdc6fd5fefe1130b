//! How large the sign of a block is.

use blocksim_block::Symbol;
use blocksim_layout::{Form, PortKind};
use blocksim_picture::text_width;

use crate::figure::{Figure, Look};
use crate::fonts::{LINE, NAME, PORT, TEXT};
use crate::symbols::two_pins;

/// Width and height of the box, as the sign needs it.
pub(crate) fn size_of(figure: &Figure) -> (f64, f64) {
    let (width, height) = match &figure.look {
        Look::Pill => (text_width(&figure.name, NAME) + 20.0, 18.0),
        Look::Selector => (6.0, 18.0),
        Look::Subsystem(variant) => {
            let chosen = variant.as_ref().map_or(0.0, |name| text_width(name, PORT) + 24.0);
            (chosen.max(64.0), 44.0)
        }
        // In the line of its wire; ports on one side make it as high as they need.
        Look::Symbol(symbol, _) if figure.ports.len() == 2 && two_pins::draws(*symbol, figure) => {
            (50.0, 28.0)
        }
        Look::Symbol(symbol, texts) => symbol_size(*symbol, texts),
    };
    let names =
        if figure.port_names && figure.look != Look::Selector { port_names_width(figure) } else { 0.0 };
    // Names of ports stand left and right of what is in the middle, except in empty boxes.
    let width = match &figure.look {
        Look::Symbol(Symbol::Bar, _) => {
            if figure.port_names {
                names + 14.0
            } else {
                6.0
            }
        }
        Look::Subsystem(_) => width.max(names + 22.0),
        _ if names > 0.0 => width + names + 8.0,
        _ => width,
    };
    (width.ceil(), height)
}

/// Ports that can come to stand on one side take their widest names each.
fn port_names_width(figure: &Figure) -> f64 {
    let widest = |kind: PortKind| {
        figure
            .ports
            .iter()
            .filter(|port| port.kind == kind)
            .map(|port| text_width(&port.name, PORT))
            .fold(0.0, f64::max)
    };
    let free = widest(PortKind::Free);
    widest(PortKind::Input).max(free) + widest(PortKind::Output).max(free)
}

fn symbol_size(symbol: Symbol, texts: &[String]) -> (f64, f64) {
    let text = |size: f64| texts.iter().map(|text| text_width(text, size)).fold(0.0, f64::max);
    match symbol {
        Symbol::Plain | Symbol::Plugin => ((text(TEXT) + 16.0).max(56.0), 36.0),
        Symbol::Text(text) => ((text_width(text, TEXT) + 16.0).max(40.0), 34.0),
        Symbol::Fraction(above, below) => {
            let wide = text_width(above, TEXT).max(text_width(below, TEXT));
            ((wide + 18.0).max(40.0), 38.0)
        }
        Symbol::Lines(first, second) => (text_width(first, NAME).max(text_width(second, NAME)) + 16.0, 40.0),
        Symbol::Polynomials(_) => ((text(TEXT) + 18.0).max(48.0), 40.0),
        Symbol::Value(_) => ((text(TEXT) + 16.0).max(40.0), 32.0),
        Symbol::Gain(_) => ((text(TEXT) * 1.5 + 20.0).max(42.0), 40.0),
        Symbol::Sum => match texts.first().map_or(0, |signs| signs.chars().count()) {
            0..=3 => (26.0, 26.0),
            _ => (30.0, 40.0),
        },
        Symbol::Curve(_) => (42.0, 34.0),
        Symbol::Scope => (44.0, 36.0),
        Symbol::Bar => (6.0, 34.0),
        Symbol::Switch => (46.0, 60.0),
        Symbol::Terminator => (16.0, 18.0),
        Symbol::Ground => (24.0, 18.0),
        Symbol::Housing => (28.0, 14.0),
        Symbol::World => (34.0, 34.0),
        Symbol::Machine(_) => (60.0, 48.0),
        Symbol::Converter(..) => (46.0, 46.0),
        Symbol::Gear => (48.0, 46.0),
        Symbol::Hinge | Symbol::Slide | Symbol::Ball | Symbol::Universal => (46.0, 40.0),
        Symbol::Cylinder | Symbol::Planar | Symbol::Touch => (46.0, 40.0),
        Symbol::SpoolValve | Symbol::HydraulicCylinder => (64.0, 46.0),
        Symbol::Pump => (50.0, 46.0),
        Symbol::Tank => (30.0, 24.0),
        Symbol::Accumulator => (34.0, 38.0),
        Symbol::Planetary | Symbol::WaveGear | Symbol::Worm | Symbol::Differential | Symbol::ElasticGear => {
            (48.0, 46.0)
        }
        Symbol::Arm("") => (60.0, 48.0),
        Symbol::Arm(formula) => ((text_width(formula, NAME) + 14.0).max(56.0), 58.0),
        Symbol::Body | Symbol::Inertia | Symbol::Mass => (44.0, 36.0),
        Symbol::Frame => (46.0, 40.0),
        Symbol::Sensor(text) => ((text_width(text, TEXT) + 16.0).max(34.0), 34.0),
        Symbol::Transistor => (48.0, 46.0),
        _ => (50.0, 40.0),
    }
}

/// Width and height of the name beside the box.
pub(crate) fn label_size(figure: &Figure) -> (f64, f64) {
    if figure.label.is_empty() {
        // Names of the elements stand right of the bar.
        let beside = if figure.look == Look::Selector { 2.0 * port_names_width(figure) + 16.0 } else { 0.0 };
        return (beside, 0.0);
    }
    let widest = figure.label.iter().map(|line| text_width(line, NAME)).fold(0.0, f64::max);
    let below = LINE * (figure.label.len() - 1) as f64;
    (widest.ceil(), NAME + 4.0 + below + tag_height(&figure.look))
}

/// How far the name of the chosen alternative hangs below the box.
pub(crate) fn tag_height(look: &Look) -> f64 {
    if matches!(look, Look::Subsystem(Some(_))) { 6.0 } else { 0.0 }
}

pub(crate) fn form_of(figure: &Figure) -> Form {
    match &figure.look {
        Look::Symbol(Symbol::Sum, texts)
            if texts.first().is_some_and(|signs| (2..=3).contains(&signs.chars().count())) =>
        {
            Form::Circle
        }
        Look::Symbol(Symbol::Ground | Symbol::Housing, _) if figure.ports.len() == 1 => Form::Hanging,
        _ => Form::Box,
    }
}
