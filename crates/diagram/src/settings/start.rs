//! `start: Steady(hold: ..., free: ..., drift: ...)`: from names to places in the schedule.

use blocksim_block::problem::{Place, Problem};
use blocksim_block::schedule::{Free, Held, Instance, Schedule, Start, Steady};
use blocksim_signal::{Dimension, Kind, closest};

use crate::ast::Ast;
use crate::problems::Problems;
use blocksim_syntax::{Node, Shape};

/// One number among the signals of a schedule.
struct HeldCell {
    cell: usize,
    kind: Kind,
    dimension: Option<Dimension>,
}

/// Finds what a steady start names.
pub(crate) fn resolve(ast: &Ast, schedule: &mut Schedule, problems: &mut Problems) {
    let Start::Steady(mut steady) = std::mem::take(&mut schedule.settings.start) else { return };
    let written = Lists { ast };
    let Steady { hold, free, drift } = &mut steady;
    for held in hold.iter_mut() {
        if let Err(problem) = find_held(held, schedule) {
            problems.push(problem.at(&written.place("hold", &held.name), ""));
        }
    }
    for constant in free.iter_mut() {
        if let Err(problem) = find_free(constant, schedule) {
            problems.push(problem.at(&written.place("free", &constant.name), ""));
        }
    }
    let states = states(schedule);
    for name in drift.iter() {
        let is_meant = |state: &String| {
            state.strip_prefix(name.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        if !states.iter().any(is_meant) {
            let problem = Problem::error("parameter", format!("there is no state `{name}` that could drift"));
            let blocks = schedule.blocks.iter().filter(|block| block.parts.is_empty() && owns_states(block));
            let known = states.iter().map(String::as_str).chain(blocks.map(|block| block.path.as_str()));
            let problem = problem.help(match closest(name, known) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => "name a block, or one of its states such as `integrator.x`".to_owned(),
            });
            problems.push(problem.at(&written.place("drift", name), ""));
        }
    }
    schedule.settings.start = Start::Steady(steady);
}

fn find_held(held: &mut Held, schedule: &Schedule) -> Result<(), Problem> {
    let name = &held.name;
    let Some(HeldCell { cell, kind, dimension }) = signal(schedule, name) else {
        let paths = schedule.signals.iter().map(|signal| signal.path.as_str());
        let recorded = schedule.recorded.iter().map(|recorded| recorded.path.as_str());
        let problem = Problem::error("unknown_signal", format!("`hold` names no signal: `{name}`"));
        return Err(problem.help(match closest(name, paths.chain(recorded)) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => {
                "name an output, block and port such as `motor.w`, and one element of a vector, `arm.q[0]`"
                    .to_owned()
            }
        }));
    };
    if kind != Kind::Real {
        return Err(Problem::error("type_mismatch", format!("`{name}` has no values in between"))
            .help("hold a signal of real numbers"));
    }
    if let (Some(wanted), Some(given)) = (dimension, held.dimension)
        && given != Dimension::NONE
        && !wanted.takes(given)
    {
        let message = format!("`{name}` is measured in {wanted}, but is to be held at a value in {given}");
        return Err(Problem::error("unit_mismatch", message));
    }
    held.cell = cell;
    Ok(())
}

fn find_free(free: &mut Free, schedule: &Schedule) -> Result<(), Problem> {
    let (path, element) = split_element(&free.name);
    let constants = || schedule.blocks.iter().enumerate().filter(|(_, block)| is_constant(block));
    let Some(path) = path.strip_suffix(".value") else {
        return Err(unknown_constant(&free.name, constants().map(|(_, block)| block)));
    };
    let Some((index, block)) = constants().find(|(_, block)| block.path == path) else {
        return Err(unknown_constant(&free.name, constants().map(|(_, block)| block)));
    };
    let count = block.outputs.first().map_or(0, |&(start, end)| (end - start) as usize);
    let element = match element {
        None if count == 1 => 0,
        Some(element) if element < count => element,
        _ => {
            let last = count.saturating_sub(1);
            let message = format!("`{path}.value` is a list of {count}");
            return Err(Problem::error("parameter", message)
                .help(format!("name one element, from `{path}.value[0]` to `{path}.value[{last}]`")));
        }
    };
    (free.block, free.cell) = (index, block.y + element);
    free.dimension = block.interface.outputs[0].port_type.dimension;
    Ok(())
}

/// A source whose value the search may change.
fn is_constant(block: &Instance) -> bool {
    let real = block.interface.outputs.first().is_some_and(|output| output.port_type.kind == Kind::Real);
    block.kind == "Constant" && real
}

fn unknown_constant<'a>(name: &str, constants: impl Iterator<Item = &'a Instance>) -> Problem {
    let values: Vec<String> = constants.map(|block| format!("{}.value", block.path)).collect();
    let problem = Problem::error("parameter", format!("`free` names no value of a Constant: `{name}`"));
    problem.help(match closest(name, values.iter().map(String::as_str)) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None if values.is_empty() => {
            "the search changes values of `Constant` blocks; put one where the input comes from".to_owned()
        }
        None => format!("the search changes values of `Constant` blocks, such as `{}`", values[0]),
    })
}

/// The number that is recorded under a name, or an output; of a vector one element, `arm.q[2]`.
fn signal(schedule: &Schedule, name: &str) -> Option<HeldCell> {
    if let Some(recorded) = schedule.recorded.iter().find(|recorded| recorded.path == name) {
        return Some(HeldCell { cell: recorded.cell, kind: recorded.kind, dimension: recorded.dimension });
    }
    let (path, element) = split_element(name);
    let signal = schedule.signals.iter().find(|signal| signal.path == path)?;
    let element = match element {
        None if signal.shape.len() == 1 => 0,
        element => element.filter(|element| *element < signal.shape.len())?,
    };
    Some(HeldCell { cell: signal.offset + element, kind: signal.kind, dimension: signal.dimension })
}

/// Path and element of `arm.q[2]`.
pub(crate) fn split_element(name: &str) -> (&str, Option<usize>) {
    let parts = name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    match parts.and_then(|(path, element)| Some((path, element.parse().ok()?))) {
        Some((path, element)) => (path, Some(element)),
        None => (name, None),
    }
}

fn owns_states(block: &Instance) -> bool {
    !block.interface.states.is_empty() || block.rate.is_some() && !block.interface.discrete.is_empty()
}

/// Names of all continuous and sampled states. Those of a network carry the path of the member they belong to.
fn states(schedule: &Schedule) -> Vec<String> {
    let of_block = |block: &Instance| -> Vec<String> {
        let continuous = block.interface.states.iter().map(|state| state.name.clone());
        if !block.parts.is_empty() {
            return continuous.collect();
        }
        let sampled = block.interface.discrete.iter().filter(|_| block.rate.is_some());
        let sampled = sampled.map(|state| state.name().into_owned());
        continuous.chain(sampled).map(|name| format!("{}.{name}", block.path)).collect()
    };
    schedule.blocks.iter().flat_map(of_block).collect()
}

/// What is written of the start.
struct Lists<'a> {
    ast: &'a Ast,
}

impl Lists<'_> {
    /// Where a name stands in one of the lists.
    fn place(&self, list: &str, name: &str) -> Place {
        let member = |node: &Node, wanted: &str| {
            node.members()?.iter().find(|(known, _)| known.text == wanted).map(|(_, node)| node.clone())
        };
        let simulation = self.ast.simulation.as_ref();
        let whole = simulation.map_or(0..0, |node| node.span.clone());
        let list = simulation.and_then(|node| member(&member(node, "start")?, list));
        let found = list.as_ref().and_then(|list| match &list.value {
            Shape::List(items) => {
                let item = items.iter().find(|item| matches!(&item.value, Shape::Text(text) if text == name));
                item.map(|item| item.span.clone())
            }
            _ => {
                let entries = list.members().unwrap_or_default();
                entries.iter().find(|(key, _)| key.text == name).map(|(key, _)| key.span.clone())
            }
        });
        self.ast.place(&found.or(list.map(|list| list.span)).unwrap_or(whole))
    }
}
