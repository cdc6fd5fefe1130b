//! From the fact that something failed to the block that is to blame. Costs nothing until then.

use blocksim_block::schedule::{Instance, Schedule};
use blocksim_solve::StepError;

use crate::SimError;
use crate::evaluate::Diagram;

/// The failure that a block has reported.
pub(crate) fn failed(schedule: &Schedule, diagram: &mut Diagram) -> SimError {
    match diagram.failure.take() {
        Some(failure) => {
            let path = &schedule.blocks[failure.block].path;
            let message = format!("`{path}` cannot go on: {}", failure.reason);
            SimError::new("block_failed", failure.t, message).at(path)
        }
        None => SimError::new("block_failed", diagram.now.t, "the diagram could not be evaluated"),
    }
}

/// Names the first block in the order of evaluation whose output is not finite, or else the first such state.
pub(crate) fn not_finite(schedule: &Schedule, diagram: &Diagram, x: &[f64]) -> SimError {
    let t = diagram.now.t;
    let bad = |cell: &usize| !diagram.signals[*cell].is_finite();
    for step in &schedule.steps {
        let block = &schedule.blocks[step.block as usize];
        let unit = &diagram.plan.units[step.block as usize];
        if let Some(cell) = unit.y.range().find(bad) {
            let (name, value) = (signal_name(schedule, cell), diagram.signals[cell]);
            let cause = match states(block, x) {
                Some(state) => format!("its state {state}"),
                None => inputs(block, &diagram.signals),
            };
            return SimError::new("not_finite", t, format!("`{name}` is {value}"))
                .at(&block.path)
                .help(cause);
        }
    }
    let block = schedule.blocks.iter().find_map(|block| Some((block, states(block, x)?)));
    match block {
        Some((block, state)) => {
            let message = format!("the state {state} of `{}`", block.path);
            SimError::new("not_finite", t, message).at(&block.path).help(inputs(block, &diagram.signals))
        }
        None => SimError::new("not_finite", t, "a recorded value is not finite"),
    }
}

/// The first state of a block that is not finite, in words.
fn states(block: &Instance, x: &[f64]) -> Option<String> {
    let mut states = block.interface.states.iter().zip(&x[block.x..]);
    let (state, value) = states.find(|(_, value)| !value.is_finite())?;
    Some(format!("`{}` is {value}", state.name))
}

/// The inputs of a block, in words.
fn inputs(block: &Instance, signals: &[f64]) -> String {
    let gathered: Vec<f64> = block
        .gather
        .iter()
        .flat_map(|&(from, len)| &signals[from as usize..(from + len) as usize])
        .copied()
        .collect();
    let ports = block.interface.inputs.iter().zip(&block.inputs);
    let words: Vec<String> = ports
        .map(|(input, &(start, end))| match &gathered[start as usize..end as usize] {
            [value] => format!("`{}` = {value}", input.name),
            values => format!("`{}` = {values:?}", input.name),
        })
        .collect();
    if words.is_empty() { "it has no inputs".to_owned() } else { format!("its inputs: {}", words.join(", ")) }
}

fn signal_name(schedule: &Schedule, cell: usize) -> String {
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
        StepError::Underflow { t, h, state } => {
            (t, state, format!("even a step of {h:e} s is too long for the state"))
        }
        StepError::NotFinite { t, state } => (t, state, "no finite derivative of the state".to_owned()),
    };
    let owner = schedule.blocks.iter().find_map(|block| {
        let states = &block.interface.states;
        Some((block, &states.get(state.checked_sub(block.x)?)?.name))
    });
    let mut dx = vec![0.0; x.len()];
    let derived = diagram.minor(t, x).and_then(|()| diagram.derive(&mut dx));
    let (Some((block, name)), Ok(())) = (owner, derived) else {
        return SimError::new("step_size", t, message);
    };
    let message = format!("{message} `{name}` of `{}`, with dx/dt = {:e}", block.path, dx[state]);
    SimError::new("step_size", t, message).at(&block.path).help(format!(
        "{}; a jump or a pole of the law, or a stiff one, may be the cause: `Rodas4` is for stiff systems",
        inputs(block, &diagram.signals)
    ))
}
