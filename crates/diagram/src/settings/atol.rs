//! `atol: {"block": "1e-9 A"}`: absolute tolerances of single blocks and states.

use std::collections::BTreeMap;

use blocksim_block::ParamValue;
use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Instance, Schedule, Solver, StateTolerance};
use blocksim_signal::{Dimension, Value, closest};

use crate::ast::Ast;
use crate::problems::Problems;

/// Reads what is written; which states are meant is found once there is a schedule.
pub(super) fn read(
    written: BTreeMap<String, ParamValue>,
    solver: &Solver,
) -> Result<Vec<StateTolerance>, Problem> {
    if let (Solver::Fixed { method, .. }, false) = (solver, written.is_empty()) {
        let message = format!("{method:?} has no tolerances: its step is fixed");
        return Err(Problem::error("parameter", message).help("leave out `atol`, or choose `solver: Auto`"));
    }
    let one = |(name, ParamValue(value)): (String, ParamValue)| match value {
        Value::Number(number) if number.value.is_finite() && number.value > 0.0 => {
            Ok(StateTolerance { name, value: number.value, dimension: number.dimension, states: Vec::new() })
        }
        Value::Number(number) => Err(Problem::error(
            "parameter",
            format!("`atol` of `{name}` is {}, but must be positive", number.value),
        )
        .help(super::ATOL)),
        other => Err(Problem::error(
            "parameter",
            format!("`atol` of `{name}` must be a number, not {}", other.describe()),
        )),
    };
    written.into_iter().map(one).collect()
}

/// Finds the states that are named.
pub(crate) fn resolve(ast: &Ast, schedule: &mut Schedule, problems: &mut Problems) {
    let states = states(schedule);
    let mut atol = std::mem::take(&mut schedule.settings.atol);
    for tolerance in &mut atol {
        if let Err(problem) = find(tolerance, &states, schedule) {
            let entries = ast.simulation.as_ref().and_then(|node| {
                let member = node.members()?.iter().find(|(key, _)| key.text == "atol");
                member.and_then(|(_, node)| node.members())
            });
            let entry = entries.unwrap_or_default().iter().find(|(key, _)| key.text == tolerance.name);
            let whole = ast.simulation.as_ref().map_or(0..0, |node| node.span.clone());
            let place = ast.place(&entry.map_or(whole, |(key, _)| key.span.clone()));
            problems.push(problem.at(&place, ""));
        }
    }
    // Of two that name a state, the one that names it more closely comes last and holds.
    atol.sort_by(|a, b| (a.name.len(), &a.name).cmp(&(b.name.len(), &b.name)));
    schedule.settings.atol = atol;
}

fn find(
    tolerance: &mut StateTolerance,
    states: &[(String, Option<Dimension>)],
    schedule: &Schedule,
) -> Result<(), Problem> {
    let StateTolerance { name, dimension, states: meant, .. } = tolerance;
    let is_meant = |state: &str| {
        state.strip_prefix(name.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    let found: Vec<usize> = (0..states.len()).filter(|&i| is_meant(&states[i].0)).collect();
    if found.is_empty() {
        let is_block =
            |block: &&Instance| block.path == *name || block.parts.iter().any(|part| part.path == *name);
        let known = schedule.blocks.iter().find(is_block);
        let message = match known {
            Some(_) => format!("`{name}` has no continuous states, so no tolerance"),
            None => format!("there is no block or state `{name}`"),
        };
        let owners = states.iter().filter_map(|(state, _)| state.rsplit_once('.')).map(|(owner, _)| owner);
        let names = states.iter().map(|(state, _)| state.as_str()).chain(owners);
        let help = match closest(name, names) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => match states.first() {
                Some((state, _)) => {
                    format!("name a block that has states, or one of them, such as `{state}`")
                }
                None => "no block of this diagram has continuous states".to_owned(),
            },
        };
        return Err(Problem::error("parameter", message).help(help));
    }
    let other = found.iter().find_map(|&i| {
        let (state, known) = &states[i];
        let known = known.filter(|known| *dimension != Dimension::NONE && !known.compatible(*dimension))?;
        Some((state, known))
    });
    if let Some((state, known)) = other {
        let message = format!("`{state}` is measured in {known}, but its tolerance is in {dimension}");
        let problem = Problem::error("unit_mismatch", message);
        return Err(if found.len() > 1 {
            problem.help(format!("name the states of `{name}` one by one, such as `{state}`"))
        } else {
            problem
        });
    }
    *meant = found;
    Ok(())
}

/// Names of all continuous states and their dimensions. Those of a network carry the path of the member they belong to.
fn states(schedule: &Schedule) -> Vec<(String, Option<Dimension>)> {
    let of_block = |block: &Instance| -> Vec<(String, Option<Dimension>)> {
        let name = |state: &str| {
            if block.parts.is_empty() { format!("{}.{state}", block.path) } else { state.to_owned() }
        };
        block.interface.states.iter().map(|state| (name(&state.name), state.dimension)).collect()
    };
    schedule.blocks.iter().flat_map(of_block).collect()
}
