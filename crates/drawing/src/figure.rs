//! What a block shows: its sign, its texts and its ports.

use blocksim_block::physical::Domain;
use blocksim_block::{BlockInfo, Symbol};
use blocksim_diagram::{BlockAst, Content, ModelBlock, PortKind as Kind};
use blocksim_layout::PortKind;
use blocksim_syntax::{Node, Shape};

/// Longest value that is written into a sign.
const LONGEST_VALUE: usize = 10;
/// Longest line of a name below a block; there are two at most.
const LONGEST_NAME: usize = 24;

/// A block of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name in the diagram.
    pub name: String,
    /// Path from the top; none for what is no block: a port of the level, or the bar where a bus parts.
    pub path: Option<String>,
    /// Kind of the block.
    pub kind: String,
    /// The lines that stand below it; there may be none.
    pub label: Vec<String>,
    /// What is drawn.
    pub look: Look,
    /// Ports in the order of the block.
    pub ports: Vec<PortLook>,
    /// Names of the ports stand inside the box.
    pub port_names: bool,
    /// What is told where the pointer rests.
    pub title: String,
}

/// What is drawn for a block.
#[derive(Debug, Clone, PartialEq)]
pub enum Look {
    /// The sign of its kind, with texts that stand in it.
    Symbol(Symbol, Vec<String>),
    /// A diagram inside; the chosen alternative, if it is a variant.
    Subsystem(Option<String>),
    /// A port of the level.
    Pill,
    /// Where elements are taken from a bus.
    Selector,
}

/// A port of a figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortLook {
    /// Its name.
    pub name: String,
    /// Which way it is used.
    pub kind: PortKind,
    /// What it carries, if it is conserving.
    pub domain: Option<Domain>,
}

impl PortLook {
    fn new(name: &str, kind: PortKind) -> PortLook {
        PortLook { name: name.to_owned(), kind, domain: None }
    }
}

/// A port of the level.
pub(crate) fn pill(name: &str, kind: PortKind) -> Figure {
    let what = match kind {
        PortKind::Input => "output of this diagram",
        PortKind::Output => "input of this diagram",
        PortKind::Free => "port of this diagram",
    };
    Figure {
        name: name.to_owned(),
        path: None,
        kind: String::new(),
        label: Vec::new(),
        look: Look::Pill,
        ports: vec![PortLook::new(name, kind)],
        port_names: false,
        title: format!("{name}: {what}"),
    }
}

/// Where elements are taken from a bus.
pub(crate) fn selector(source: &str, elements: &[String]) -> Figure {
    let mut ports = vec![PortLook::new("", PortKind::Input)];
    ports.extend(elements.iter().map(|element| PortLook::new(element, PortKind::Output)));
    Figure {
        name: source.to_owned(),
        path: None,
        kind: String::new(),
        label: Vec::new(),
        look: Look::Selector,
        ports,
        port_names: true,
        title: format!("elements of {source}: {}", elements.join(", ")),
    }
}

/// A block. `written` and `text` are its place in the source, `connected` the ports that connections speak of.
pub(crate) fn figure_of(
    block: &ModelBlock,
    written: Option<&BlockAst>,
    text: &str,
    connected: &[(String, PortKind)],
) -> Figure {
    let look = match &block.content {
        Content::Diagram(_) => Look::Subsystem(block.variant.as_ref().map(|variant| variant.chosen.clone())),
        _ if block.variant.is_some() => {
            Look::Subsystem(block.variant.as_ref().map(|variant| variant.chosen.clone()))
        }
        _ => {
            let symbol = BlockInfo::find(&block.kind).map_or(Symbol::Plain, |info| info.symbol);
            Look::Symbol(symbol, texts(symbol, block, written, text))
        }
    };
    let ports = ports(block, connected);
    let many = |kind: &[PortKind]| ports.iter().filter(|port| kind.contains(&port.kind)).count();
    let named = match look {
        Look::Symbol(symbol, _) => match symbol {
            Symbol::Bar
            | Symbol::Plain
            | Symbol::Plugin
            | Symbol::Text(_)
            | Symbol::Curve(_)
            | Symbol::Lines(..)
            | Symbol::Arm(_) => {
                many(&[PortKind::Input]) > 1
                    || many(&[PortKind::Output]) > 1
                    || (many(&[PortKind::Free]) > 0 && ports.len() > 2)
            }
            Symbol::Scope => many(&[PortKind::Input]) > 1,
            Symbol::Machine(_) | Symbol::Converter(..) | Symbol::Sensor(_) | Symbol::Transistor => {
                ports.len() > 2
            }
            Symbol::Gear
            | Symbol::ElasticGear
            | Symbol::Planetary
            | Symbol::WaveGear
            | Symbol::Worm
            | Symbol::Differential
            | Symbol::Hinge
            | Symbol::Slide
            | Symbol::Cylinder
            | Symbol::SpoolValve
            | Symbol::HydraulicCylinder
            | Symbol::Pump
            | Symbol::Planar
            | Symbol::Universal
            | Symbol::Ball
            | Symbol::Phases
            | Symbol::Star => ports.len() > 2,
            _ => false,
        },
        Look::Subsystem(_) => true,
        Look::Pill | Look::Selector => false,
    };
    let label = match &look {
        Look::Symbol(Symbol::Sum | Symbol::Ground | Symbol::Housing | Symbol::Terminator, _) => "",
        _ => block.label.as_deref().unwrap_or(&block.name),
    };
    let more = match (&block.variant, &block.content) {
        (Some(variant), _) => format!(" ({} of {})", variant.chosen, variant.of.join(", ")),
        (None, Content::Unknown) => " (could not be read)".to_owned(),
        _ => String::new(),
    };
    Figure {
        name: block.name.clone(),
        path: Some(block.path.clone()),
        kind: block.kind.clone(),
        label: in_lines(label),
        look,
        port_names: named,
        ports,
        title: format!("{}: {}{more}", block.path, block.kind),
    }
}

/// All ports of a subsystem; of a block those that are in use or lack a wire, of one that nothing is connected to all, and of
/// one that could not be read those that connections speak of. A signal block that drives nothing shows its first output.
fn ports(block: &ModelBlock, connected: &[(String, PortKind)]) -> Vec<PortLook> {
    let used = |name: &String| connected.iter().any(|(known, _)| known == name);
    let whole = matches!(block.content, Content::Diagram(_)) || connected.is_empty();
    let lacks = |name: &String| match &block.content {
        Content::Block { interface, .. } => {
            interface.inputs.iter().any(|input| input.name == *name && input.default.is_none())
        }
        _ => false,
    };
    let mut ports: Vec<PortLook> = Vec::new();
    match &block.content {
        Content::Unknown => {
            ports.extend(connected.iter().map(|(name, kind)| PortLook::new(name, *kind)));
        }
        Content::Block { .. } | Content::Diagram(_) => {
            let (inputs, outputs) = (block.inputs(), block.outputs());
            let drives_nothing = block.ports().is_empty() && !outputs.iter().any(used);
            let stub = outputs.first().filter(|_| drives_nothing).cloned();
            ports.extend(
                inputs
                    .iter()
                    .filter(|name| whole || used(name) || lacks(name))
                    .map(|name| PortLook::new(name, PortKind::Input)),
            );
            ports.extend(
                outputs
                    .iter()
                    .filter(|name| whole || used(name) || stub.as_ref() == Some(*name))
                    .map(|name| PortLook::new(name, PortKind::Output)),
            );
            for name in block.ports() {
                let domain = match block.port(&name) {
                    Some(Kind::Conserving(domain)) => Some(domain),
                    _ => None,
                };
                if whole || used(&name) {
                    ports.push(PortLook { domain, ..PortLook::new(&name, PortKind::Free) });
                }
            }
        }
    }
    ports
}

/// Texts that stand in a sign.
fn texts(symbol: Symbol, block: &ModelBlock, written: Option<&BlockAst>, text: &str) -> Vec<String> {
    let parameter = |name: &str| {
        let (_, node) = written?.parameters.iter().find(|(known, _)| known.text == name)?;
        Some(node)
    };
    let value = |name: &str| parameter(name).map(|node| written_as(node, text));
    match symbol {
        Symbol::Gain(name) | Symbol::Value(name) => {
            let given = value(name).filter(|value| value.chars().count() <= LONGEST_VALUE);
            vec![given.unwrap_or_else(|| {
                if matches!(symbol, Symbol::Gain(_)) { "K".to_owned() } else { block.kind.clone() }
            })]
        }
        Symbol::Sum => vec![value("signs").unwrap_or_default()],
        Symbol::Polynomials(variable) => {
            let polynomial = |name: &str| match parameter(name).map(|node| &node.value) {
                Some(Shape::List(items)) => {
                    let items: Vec<String> = items.iter().map(|item| written_as(item, text)).collect();
                    polynomial(&items, variable)
                }
                Some(_) => format!("{name}({variable})"),
                None => "1".to_owned(),
            };
            let both = [polynomial("num"), polynomial("den")];
            if both.iter().all(|side| side.chars().count() <= 18) {
                both.to_vec()
            } else {
                vec![format!("B({variable})"), format!("A({variable})")]
            }
        }
        Symbol::Plain => vec![block.kind.clone()],
        Symbol::Plugin => vec![value("block").unwrap_or_else(|| block.kind.clone())],
        _ => Vec::new(),
    }
}

/// The text of a value without its quotes.
fn written_as(node: &Node, text: &str) -> String {
    match &node.value {
        Shape::Text(content) => content.clone(),
        _ => text.get(node.span.clone()).unwrap_or_default().trim().to_owned(),
    }
}

/// `10 s² + 7 s + 1` of `["10", "7", "1"]`.
fn polynomial(coefficients: &[String], variable: &str) -> String {
    let degree = coefficients.len().saturating_sub(1);
    let mut out = String::new();
    for (i, coefficient) in coefficients.iter().enumerate() {
        let number: Option<f64> = coefficient.parse().ok();
        if number == Some(0.0) && degree > 0 {
            continue;
        }
        let (negative, size) = match number {
            Some(x) => (x < 0.0, format!("{}", x.abs())),
            None => (false, coefficient.clone()),
        };
        out.push_str(match (out.is_empty(), negative) {
            (true, true) => "−",
            (true, false) => "",
            (false, true) => " − ",
            (false, false) => " + ",
        });
        let power: String = (degree - i).to_string().chars().filter_map(raised).collect();
        let letters = match degree - i {
            0 => String::new(),
            1 => variable.to_owned(),
            _ => format!("{variable}{power}"),
        };
        match (size.as_str(), letters.is_empty()) {
            ("1", false) => out.push_str(&letters),
            (size, true) => out.push_str(size),
            (size, false) => {
                out.push_str(size);
                out.push(' ');
                out.push_str(&letters);
            }
        }
    }
    if out.is_empty() { "0".to_owned() } else { out }
}

fn raised(digit: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10)? as usize)
}

/// A name in one line, or in two of nearly the same length.
fn in_lines(name: &str) -> Vec<String> {
    let name: Vec<&str> = name.split_whitespace().collect();
    let length = |words: &[&str]| words.join(" ").chars().count();
    if name.is_empty() {
        return Vec::new();
    }
    if length(&name) <= LONGEST_NAME {
        return vec![shortened(&name.join(" "), LONGEST_NAME)];
    }
    // What is left over goes to the end of the second line and is cut there.
    let fits = |first: &usize| length(&name[..*first]) <= LONGEST_NAME;
    let longest = |first: &usize| length(&name[..*first]).max(length(&name[*first..]));
    let lines = match (1..name.len()).filter(fits).min_by_key(longest) {
        Some(first) => vec![name[..first].join(" "), name[first..].join(" ")],
        None => vec![name.join(" ")],
    };
    lines.iter().map(|line| shortened(line, LONGEST_NAME)).collect()
}

pub(crate) fn shortened(text: &str, longest: usize) -> String {
    let text: String = text.chars().map(|sign| if sign.is_control() { ' ' } else { sign }).collect();
    if text.chars().count() <= longest {
        return text;
    }
    text.chars().take(longest - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_stand_in_two_lines() {
        assert_eq!(in_lines("motor"), ["motor"]);
        assert_eq!(in_lines("Euler angles ZYX of the tool"), ["Euler angles", "ZYX of the tool"]);
        assert_eq!(
            in_lines("Set velocity and angular velocity of the tool"),
            ["Set velocity and angular", "velocity of the tool"]
        );
        assert_eq!(in_lines("a_name_without_spaces_that_is_too_long"), ["a_name_without_spaces_t…"]);
        assert_eq!(in_lines(&"six words ".repeat(8))[1].chars().count(), LONGEST_NAME);
        assert!(in_lines("").is_empty());
    }

    #[test]
    fn polynomials_are_written_as_in_a_book() {
        let written =
            |numbers: &[&str]| polynomial(&numbers.iter().map(ToString::to_string).collect::<Vec<_>>(), "s");
        assert_eq!(written(&["10.0", "7", "1"]), "10 s² + 7 s + 1");
        assert_eq!(written(&["1", "0", "-2.5", "0"]), "s³ − 2.5 s");
        assert_eq!(written(&["tau", "1"]), "tau s + 1");
        assert_eq!(written(&["0"]), "0");
    }
}
