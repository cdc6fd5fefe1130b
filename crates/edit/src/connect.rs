//! Wires that come.

use blocksim_block::problem::Problem;
use blocksim_diagram::PortKind;
use blocksim_syntax::Node;

use crate::change::{Change, Draft};
use crate::delete::wires;
use crate::ends::{End, split_end};
use crate::project::{Level, Project};
use crate::refusal::Refusal;
use crate::text::{Entries, Splice, Wire, line_feed, spliced};

/// Errors that say that two ports do not fit each other.
const MISFITS: [&str; 7] = [
    "unit_mismatch",
    "type_mismatch",
    "domain_mismatch",
    "port_kind",
    "wrong_direction",
    "second_driver",
    "recursive_bus",
];

/// Connects two ports of one diagram: an output, or an input of the diagram (`in.angle`), to an input, or to what the diagram
/// hands outward (`out.torque`); or two conserving ports. Which comes first does not matter.
///
/// # Errors
/// What the check of the model reports of the new connection: the ports or their units do not fit, the input has a driver.
pub fn connect(project: &Project, from: &str, to: &str) -> Result<Change, Refusal> {
    let opened = project.open()?;
    let ((path, from), (other, to)) = (split_end(from), split_end(to));
    if path != other {
        return Err(Refusal::new("the ports are of different diagrams").help(
            "a wire stays within one level: hand the signal outward, or inward, by a port of the subsystem",
        ));
    }
    let level = opened.level(path)?;
    project.may_change(&level)?;
    let (from, to) = (End::read(&level, from)?, End::read(&level, to)?);
    let (from, to) = match (from.kind(&level)?, to.kind(&level)?) {
        (PortKind::Input, PortKind::Output) => (to, from),
        (PortKind::Input, PortKind::Input) => {
            return Err(alike(&from, &to, "inputs", "an output drives inputs"));
        }
        (PortKind::Output, PortKind::Output) => {
            return Err(alike(
                &from,
                &to,
                "outputs",
                "an output drives inputs; Sum and Switch make one signal of several",
            ));
        }
        _ => (from, to),
    };
    let is_conserving =
        |end: &End| end.kind(&level).is_ok_and(|kind| matches!(kind, PortKind::Conserving(_)));
    let wire = if is_conserving(&from) && is_conserving(&to) { Wire::Conserving } else { Wire::Signal };
    let mut change = match connected(&level, &from, &to, wire)? {
        Some(new) => {
            let mut draft = Draft::default();
            draft.put(level.file.path.clone(), &level.file.text, new);
            let (errors, _) = project.new_errors(&draft.texts());
            let is_of_wire = |problem: &&Problem| MISFITS.contains(&problem.code);
            if let Some(problem) = errors.iter().find(is_of_wire) {
                return Err(Refusal::of(problem));
            }
            draft.finish(format!("`{}` connected to `{}`", from.shown(), to.shown()))
        }
        None => Change {
            summary: format!("`{}` and `{}` are connected already", from.shown(), to.shown()),
            ..Change::default()
        },
    };
    if let End::Block { block, .. } = &to {
        change.block = Some(level.path_of(block));
    }
    Ok(change)
}

fn alike(from: &End, to: &End, what: &str, help: &str) -> Refusal {
    Refusal::new(format!("`{}` and `{}` are both {what}", from.shown(), to.shown())).help(help)
}

/// The text with a wire; `None` where it is there already.
fn connected(level: &Level, from: &End, to: &End, wire: Wire) -> Result<Option<String>, Refusal> {
    let text = &*level.file.text;
    if from == to {
        return Err(Refusal::new(format!("`{}` cannot be connected to itself", from.shown())));
    }
    // What is handed outward names its end itself.
    if let Some((outward, end)) = outward(level, from, to) {
        let Some(written) = end.written() else {
            return Err(
                Refusal::new("the diagram hands both outward").help("connect a port of a block to it")
            );
        };
        let content = format!("\"{written}\"");
        if text.get(outward.span.clone()) == Some(content.as_str()) {
            return Ok(None);
        }
        return Ok(spliced(text, vec![Splice::new(outward.span.clone(), content)]));
    }
    let (Some(a), Some(b)) = (from.written(), to.written()) else {
        return Err(Refusal::new("there is no such port"));
    };
    let mut wires = wires(level)?;
    match wire {
        Wire::Signal => {
            let driver = wires.find(Wire::Signal, |n, end| n > 0 && end == b);
            if let Some(driver) = driver {
                let source = wires.ends(driver)[0].to_owned();
                if source == a {
                    return Ok(None);
                }
                return Err(Refusal::new(format!("`{b}` is driven by `{source}` already"))
                    .help("delete that wire first, or bring both signals together by a Sum or a Switch"));
            }
            match wires.find(Wire::Signal, |n, end| n == 0 && end == a) {
                Some(at) => wires.append(at, &b),
                None => wires.add(None, Wire::Signal, &[&a, &b]),
            }
        }
        Wire::Conserving => {
            if wires.joined(&a).contains(&b) {
                return Ok(None);
            }
            let known = |end: &str| wires.find(Wire::Conserving, |_, known| known == end);
            match (known(&a), known(&b)) {
                (Some(at), None) => wires.append(at, &b),
                (None, Some(at)) => wires.append(at, &a),
                _ => wires.add(None, Wire::Conserving, &[&a, &b]),
            }
        }
    }
    let (mut splices, new) = wires.finish();
    if !new.is_empty() {
        splices.extend(section(level, "connections", '[', &new)?);
    }
    Ok(spliced(text, splices))
}

/// The text behind `outputs` or `ports` that one of two ends is, and the other end.
fn outward<'l>(level: &'l Level, from: &'l End, to: &'l End) -> Option<(&'l Node, &'l End)> {
    let of = |section: &str, name: &str| {
        let members = level.section(section)?.members()?;
        members.iter().find(|(known, _)| known.text == name).map(|(_, node)| node)
    };
    for (end, other) in [(from, to), (to, from)] {
        let node = match end {
            End::Output(name) => of("outputs", name),
            End::Port(name) => of("ports", name),
            _ => None,
        };
        if let Some(node) = node {
            return Some((node, other));
        }
    }
    None
}

/// A section of a diagram that has none of this name, behind its blocks or at its end.
pub(crate) fn section(
    level: &Level,
    name: &str,
    open: char,
    entries: &[String],
) -> Result<Vec<Splice>, Refusal> {
    let text = &*level.file.text;
    let strange = || Refusal::new("this diagram has no brackets that a section could stand in");
    let all = Entries::of(text, &level.root).ok_or_else(strange)?;
    let members = level.root.members().unwrap_or_default();
    let behind = members.iter().position(|(known, _)| known.text == "blocks");
    let behind = behind.or_else(|| all.len().checked_sub(1));
    let close = if open == '[' { ']' } else { '}' };
    let indent = behind.map_or("", |at| crate::text::indentation(text, members[at].0.span.start));
    let feed = line_feed(text);
    let lines: String = entries.iter().map(|entry| format!("{indent}    {entry},{feed}")).collect();
    Ok(all.with(behind, &[format!("{name}: {open}{feed}{lines}{indent}{close}")]))
}
