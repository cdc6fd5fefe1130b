//! From the fact that something failed to the block that is to blame. Costs nothing until then.

use blocksim_block::Guard;
use blocksim_block::methods::{METHODS, Method};
use blocksim_block::schedule::{Instance, Schedule, Solver, VariableMethod};
use blocksim_solve::StepError;

use crate::SimError;
use crate::evaluation::evaluate::{Diagram, Failure};

/// Size above which the value of an input is suspicious.
const HUGE: f64 = 1e12;

/// What helps where the steps of a fixed size may be too long.
const SMALLER: &str = "use a smaller step or a method of variable step";

/// What helps where a block gives such values of its own accord.
const BEYOND: &str =
    "its parameters lead beyond the largest number, 1.8e308: give smaller ones, or other units";

/// Who failed, where many blocks are one; the reason names those it is about.
const NETWORK: &str = "the physical network";

/// What helps where a loop has no solution.
const BREAK: &str = "put a block without direct feedthrough into the loop, such as a LowPass; a jump within it, as that of a \
                     Relay or a Sign, may leave it without a solution";

/// What helps where a constraint has no solution.
const NEARER: &str = "begin nearer to the solution with `z0` or `x0`; a constraint may also lose its solution, as where a curve turns \
                      back, or never have had one";

/// Most inputs that are told.
const FEW: usize = 4;

/// The failure that a block has reported.
pub(crate) fn failed(schedule: &Schedule, diagram: &mut Diagram) -> SimError {
    match diagram.failure.take() {
        Some(Failure { ring: Some(ring), t, reason, block }) => {
            let found = &schedule.loops[ring];
            let steps = schedule.steps[found.first..].iter().take(found.count);
            let mut members: Vec<&Instance> = Vec::new();
            for member in steps.map(|step| &schedule.blocks[step.block as usize]) {
                if !members.iter().any(|known| known.path == member.path) {
                    members.push(member);
                }
            }
            let constraints: Vec<&Instance> =
                members.iter().copied().filter(|member| member.interface.constraint.is_some()).collect();
            let (who, named, help) = match constraints.first() {
                Some(_) => ("constraint", &constraints, NEARER),
                None => ("algebraic loop", &members, BREAK),
            };
            let more = if named.len() > FEW { ", ..." } else { "" };
            let names: Vec<String> =
                named.iter().take(FEW).map(|member| format!("`{}`", member.path)).collect();
            let message = format!("the {who} of {}{more} {reason}", names.join(", "));
            let path = constraints.first().map_or(&schedule.blocks[block].path, |first| &first.path);
            SimError::new("algebraic_loop", t, message).at(path).help(help)
        }
        Some(failure) => {
            let block = &schedule.blocks[failure.block];
            let who = if block.parts.is_empty() { format!("`{}`", block.path) } else { NETWORK.to_owned() };
            let message = format!("{who} cannot go on: {}", failure.reason);
            SimError::new("block_failed", failure.t, message).at(&block.path)
        }
        None => SimError::new("block_failed", diagram.now.t, "the diagram could not be evaluated"),
    }
}

/// Names the first block in the order of evaluation whose output is not finite, by its state if that is the cause, or
/// else the first such state.
pub(crate) fn not_finite(schedule: &Schedule, diagram: &Diagram, x: &[f64]) -> SimError {
    let t = diagram.now.t;
    let bad = |cell: &usize| !diagram.signals[*cell].is_finite();
    let of_output = schedule.steps.iter().find_map(|step| {
        let cell = diagram.plan.units[step.block as usize].y.range().find(bad)?;
        let block = &schedule.blocks[step.block as usize];
        let named = || (signal_name(schedule, cell), diagram.signals[cell]);
        Some((block, bad_state(block, x).unwrap_or_else(named)))
    });
    let of_state = || schedule.blocks.iter().find_map(|block| Some((block, bad_state(block, x)?)));
    let Some((block, (name, value))) = of_output.or_else(of_state) else {
        return SimError::new("not_finite", t, "a recorded value is not finite");
    };
    let mut help = inputs(block, &diagram.signals);
    if block.gather.is_empty() && block.interface.states.is_empty() {
        help.push(BEYOND.to_owned());
    }
    if let Solver::Fixed { .. } = schedule.settings.solver
        && schedule.states > 0
        && help.first().is_none_or(|help| help != BEYOND)
    {
        help.push(SMALLER.to_owned());
    }
    let error = SimError::new("not_finite", t, format!("`{name}` is {value}")).at(&block.path);
    if help.is_empty() { error } else { error.help(help.join("; ")) }
}

/// The first state of a block that is not finite.
fn bad_state(block: &Instance, x: &[f64]) -> Option<(String, f64)> {
    let mut states = block.interface.states.iter().zip(&x[block.x..]);
    let (state, &value) = states.find(|(_, value)| !value.is_finite())?;
    Some((state_name(block, &state.name), value))
}

/// Paths and names of all continuous states: `pid.x`, `motor.i`.
pub fn state_names(schedule: &Schedule) -> Vec<String> {
    let of_block = |block: &Instance| -> Vec<String> {
        block.interface.states.iter().map(|state| state_name(block, &state.name)).collect()
    };
    schedule.blocks.iter().flat_map(of_block).collect()
}

/// Path and name of a state. Those of a network carry the path of the member they belong to.
pub(crate) fn state_name(block: &Instance, state: &str) -> String {
    if block.path.starts_with("network(") { state.to_owned() } else { format!("{}.{state}", block.path) }
}

/// The block that has a guard, and the guard.
pub(crate) fn guard_of(schedule: &Schedule, guard: usize) -> Option<(&Instance, &Guard)> {
    schedule.blocks.iter().find_map(|block| {
        let guard = block.interface.guards.get(guard.checked_sub(block.g)?)?;
        Some((block, guard))
    })
}

/// The inputs of a block, in words: all of a few, of many those that are suspicious. Nothing if none is.
fn inputs(block: &Instance, signals: &[f64]) -> Vec<String> {
    let cells = block.gather.iter().flat_map(|&(from, len)| &signals[from as usize..(from + len) as usize]);
    let gathered: Vec<f64> = cells.copied().collect();
    let all: Vec<(&str, &[f64])> = block
        .interface
        .inputs
        .iter()
        .zip(&block.inputs)
        .map(|(input, &(start, end))| (input.name.as_str(), &gathered[start as usize..end as usize]))
        .collect();
    if all.is_empty() {
        return Vec::new();
    }
    let suspicious = |value: &f64| !value.is_finite() || value.abs() > HUGE;
    let are_few = gathered.len() <= FEW;
    let told: Vec<_> = all.iter().filter(|(_, values)| are_few || values.iter().any(suspicious)).collect();
    let words = told.iter().take(FEW).map(|(name, values)| match values {
        [value] => format!("`{name}` = {}", number(*value)),
        values if values.len() <= FEW => format!("`{name}` = {values:?}"),
        values => match values.iter().position(suspicious) {
            Some(i) => format!("`{name}[{i}]` = {}", number(values[i])),
            None => format!("`{name}` = {values:?}"),
        },
    });
    let words = words.collect::<Vec<_>>().join(", ");
    match told.len() {
        0 => Vec::new(),
        n if n > FEW => vec![format!("its inputs: {words} and {} more", n - FEW)],
        _ => vec![format!("its inputs: {words}")],
    }
}

pub(crate) fn signal_name(schedule: &Schedule, cell: usize) -> String {
    let signal = schedule.signals.iter().find(|s| (s.offset..s.offset + s.shape.len()).contains(&cell));
    match signal {
        Some(signal) if signal.shape.len() == 1 => signal.path.clone(),
        Some(signal) => format!("{}[{}]", signal.path, cell - signal.offset),
        None => format!("signal {cell}"),
    }
}

/// Why the solver could not make a step from (`t`, `x`).
pub(crate) fn step(schedule: &Schedule, diagram: &mut Diagram, x: &[f64], error: StepError) -> SimError {
    let (t, state, message) = match error {
        StepError::System => return failed(schedule, diagram),
        StepError::Underflow { t, h, state } => (t, state, format!("even a step of {h:e} s is too long")),
        StepError::NotFinite { t, state } => (t, state, "no derivative that is finite".to_owned()),
    };
    // What is not finite comes from the first block that gives such a value, not from the state that it reaches, unless
    // states that explode have led to it; a source depends on none.
    if let StepError::NotFinite { .. } = error
        && diagram.minor(t, x).is_ok()
        && let Some(call) = diagram
            .plan
            .major
            .iter()
            .find(|call| !diagram.signals[call.unit.y.range()].iter().all(|y| y.is_finite()))
        && (call.unit.width == 0 || x.iter().all(|x| x.abs() < HUGE))
    {
        return not_finite(schedule, diagram, x);
    }
    if let Some(error) = behind(schedule, diagram, x, t, &error) {
        return error;
    }
    let owner = schedule.blocks.iter().find_map(|block| {
        let states = &block.interface.states;
        Some((block, &states.get(state.checked_sub(block.x)?)?.name))
    });
    let mut dx = vec![0.0; x.len()];
    let derived = diagram.minor(t, x).and_then(|()| diagram.derive(&mut dx));
    let (Some((block, name)), Ok(())) = (owner, derived) else {
        return SimError::new("step_size", t, message);
    };
    let message =
        format!("{message} for the state `{}`; dx/dt = {}", state_name(block, name), number(dx[state]));
    let mut help = inputs(block, &diagram.signals);
    help.push(match schedule.settings.solver {
        Solver::Fixed { .. } => SMALLER.to_owned(),
        Solver::Variable { method, .. } => stuck(method),
    });
    SimError::new("step_size", t, message).at(&block.path).help(help.join("; "))
}

/// What may have left a method that chooses its steps without one.
fn stuck(method: VariableMethod) -> String {
    let methods =
        METHODS.iter().filter(|info| info.stiff && info.method != Method::Variable(VariableMethod::Auto));
    let is_stiff = METHODS.iter().any(|info| info.stiff && info.method == Method::Variable(method));
    let cause = "a jump or a pole of the law may be the cause";
    if is_stiff {
        return cause.to_owned();
    }
    let names: Vec<String> = methods.map(|info| format!("`{}`", info.name)).collect();
    format!("{cause}, or a stiff law, for which there are {}", names.join(", "))
}

/// What is not finite, or where a block cannot go on, just behind the time up to which steps could be made.
fn behind(
    schedule: &Schedule,
    diagram: &mut Diagram,
    x: &[f64],
    t: f64,
    error: &StepError,
) -> Option<SimError> {
    let StepError::Underflow { h, .. } = error else { return None };
    let mut dx = vec![0.0; x.len()];
    diagram.minor(t, x).and_then(|()| diagram.derive(&mut dx)).ok()?;
    for ahead in [1.0, 10.0, 100.0, 1000.0].map(|times| times * h) {
        let next: Vec<f64> = x.iter().zip(&dx).map(|(x, dx)| x + ahead * dx).collect();
        if diagram.minor(t + ahead, &next).is_err() {
            return Some(failed(schedule, diagram));
        }
        let signals = &diagram.signals;
        let written = diagram.plan.minor.iter().flat_map(|call| &signals[call.unit.y.range()]);
        if next.iter().chain(written).any(|value| !value.is_finite()) {
            return Some(not_finite(schedule, diagram, &next));
        }
    }
    None
}

/// A number of any size in few digits.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e7).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}
