//! That there is no steady state, and what is to blame.

use blocksim_block::schedule::Steady;

use super::newton::Lost;
use crate::diagnose::number;
use crate::{SimError, Simulation};

/// Unknowns that are named.
const NAMED: usize = 5;

/// What keeps moving, the worst first.
pub(super) fn restless(simulation: &Simulation, asked: &Steady, lost: &Lost) -> SimError {
    let Lost { names, moving, paired } = lost;
    let told = moving.iter().take(NAMED).map(|&(equation, by, _)| {
        match asked.hold.get(equation.wrapping_sub(*paired)) {
            Some(held) => {
                format!("`{}` is {} instead of {}", held.name, number(held.value + by), number(held.value))
            }
            None => format!("`{}` by {} a second", names[equation], number(short(by))),
        }
    });
    let told = told.collect::<Vec<_>>().join(", ");
    let more = moving.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let message = match moving.is_empty() {
        true => "no steady state was found: the modes of blocks (what slips, conducts, is at a limit) contradict each other"
            .to_owned(),
        false => format!("no steady state was found; what keeps moving: {told}{more}"),
    };
    let help = if asked.hold.is_empty() {
        "integrators that nothing feeds back and sources that go on have no rest: begin elsewhere (initial values, another \
         instant), or list the states that may go on moving, `start: Steady(drift: [...])`"
    } else {
        "perhaps what is held cannot be reached with what is free: compare `hold` and `free`, and write values of the \
         constants from which the search may begin"
    };
    let error = SimError::new("no_steady_state", simulation.t, message).help(help);
    match moving.first().and_then(|&(equation, ..)| owner(simulation, equation, *paired, names)) {
        Some(path) => error.at(&path),
        None => error,
    }
}

/// Path of the block that an equation belongs to.
fn owner(simulation: &Simulation, equation: usize, paired: usize, names: &[String]) -> Option<String> {
    let schedule = &simulation.schedule;
    if equation < schedule.states {
        let owns = |block: &&blocksim_block::schedule::Instance| {
            (block.x..block.x + block.interface.states.len()).contains(&equation)
        };
        return schedule.blocks.iter().find(owns).map(|block| block.path.clone());
    }
    let name = (equation < paired).then(|| names[equation].as_str())?;
    let is_of =
        |path: &str| name == path || name.strip_prefix(path).is_some_and(|rest| rest.starts_with('.'));
    schedule.blocks.iter().find(|block| is_of(&block.path)).map(|block| block.path.clone())
}

/// Six digits of a number.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
