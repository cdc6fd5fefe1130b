//! What cannot be translated, why, and what to do.

use std::collections::BTreeMap;

use blocksim_block::CONDITION;
use blocksim_block::problem::Problem;
use blocksim_block::schedule::Instance;

use crate::part::Selected;
use crate::refusal;

/// All that stands against a translation; nothing if it can be made.
pub(crate) fn refusals(selected: &Selected) -> Vec<Problem> {
    let mut problems = Vec::new();
    ports(selected, &mut problems);
    loops(selected, &mut problems);
    for &at in &selected.blocks {
        let block = selected.block(at);
        if let Some((reason, help)) = reason(selected, at) {
            let problem = refusal(format!("`{}` ({}) {reason}", block.path, block.kind), &help);
            problems.push(block.place.iter().fold(problem, |problem, place| problem.at(place, "")));
        }
    }
    problems
}

fn ports(selected: &Selected, problems: &mut Vec<Problem>) {
    let part = selected.part;
    let mut drivers: BTreeMap<usize, &str> = BTreeMap::new();
    for port in part.inputs.iter().filter(|port| selected.inputs.contains_key(&port.cell)) {
        if let Some(other) = drivers.insert(port.cell, &port.name) {
            let message = format!(
                "the inputs `{other}` and `{}` of `{}` are both driven by `{}`, so that the code could not keep them apart",
                port.name, part.path, port.signal
            );
            let help = format!(
                "put a `Gain(k: 1)` between `{}` and one of them, outside of `{}`",
                port.signal, part.path
            );
            problems.push(refusal(message, &help));
        }
    }
    let mut strangers: Vec<String> = selected
        .strangers
        .iter()
        .filter_map(|(_, cell)| {
            let holds = |signal: &&blocksim_block::schedule::Signal| {
                (signal.offset..signal.offset + signal.shape.len()).contains(cell)
            };
            selected.schedule.signals.iter().find(holds).map(|signal| signal.path.clone())
        })
        // The blocks inside name the condition of a subsystem.
        .filter(|signal| !signal.ends_with(CONDITION))
        .collect();
    strangers.sort();
    strangers.dedup();
    for signal in strangers {
        problems.push(refusal(
            format!("`{}` reads `{signal}`, to which none of its inputs leads", part.path),
            "lead it into the subsystem through an input",
        ));
    }
    if part.outputs.is_empty() {
        let (message, help) = if part.path.is_empty() {
            (
                "nothing is recorded, so the code would have no outputs".to_owned(),
                "add a Scope, or name the signals under `record`",
            )
        } else {
            (format!("`{}` has no outputs", part.path), "give the subsystem an output, or name another one")
        };
        problems.push(refusal(message, help));
    }
}

fn loops(selected: &Selected, problems: &mut Vec<Problem>) {
    let schedule = selected.schedule;
    for found in &schedule.loops {
        let steps = &schedule.steps[found.first..found.first + found.count];
        let mut inside: Vec<&str> = steps
            .iter()
            .map(|step| step.block as usize)
            .filter(|block| selected.blocks.contains(block))
            .map(|block| schedule.blocks[block].path.as_str())
            .collect();
        inside.dedup();
        if !inside.is_empty() {
            problems.push(refusal(
                format!(
                    "an algebraic loop goes through {}: it would have to be solved at each step",
                    list(&inside)
                ),
                "break it with a UnitDelay where the loop can wait a step, or solve it by hand",
            ));
        }
    }
}

fn list(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// Why a block cannot be translated, behind its name, and what to do.
fn reason(selected: &Selected, at: usize) -> Option<(String, String)> {
    let block = selected.block(at);
    if selected.is_constant(at) {
        return None;
    }
    let say = |reason: &str, help: &str| Some((reason.to_owned(), help.to_owned()));
    let interface = &block.interface;
    let asks = interface.inputs.iter().any(|input| input.name == CONDITION);
    if asks || interface.outputs.iter().any(|output| output.name == CONDITION) {
        return say(
            "runs where the condition of a subsystem holds (`enable`, `trigger`, `reset`, a branch), which is not translated",
            "export the subsystem without its condition, and call its step on the target when it is to run; or compute all branches \
             and choose with a Switch",
        );
    }
    let leave_out = "put what runs on the target into a subsystem of its own, without this block, and name it by `--subsystem`";
    if !block.parts.is_empty() || !block.interface.ports.is_empty() {
        let mut parts: Vec<&str> = block.parts.iter().map(|part| part.path.as_str()).collect();
        let more = parts.len().saturating_sub(6);
        parts.truncate(6);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        return Some((
            format!("is a physical network, of {}{more}, whose laws are not recorded", list(&parts)),
            leave_out.to_owned(),
        ));
    }
    if block.kind == "Plugin" {
        return say(
            "is a plug-in: its law is code already",
            "call that code on the target, and export what is around it",
        );
    }
    if interface.remembers.is_some() {
        return say(
            "remembers what it saw over time",
            "use a chain of UnitDelay blocks for a dead time of whole steps",
        );
    }
    if interface.time_events {
        return say(
            "changes by itself at times of its own, which need not be steps of the target",
            "keep it outside of the subsystem and lead its output in through an input",
        );
    }
    if interface.jumps {
        return say(
            "has states that jump at events",
            "take a form without jumps (an Integrator without limits and reset, a DiscreteIntegrator), or leave it outside",
        );
    }
    if interface.constraint.is_some() {
        return say("is a constraint whose unknowns the engine finds", "solve it by hand for the unknown");
    }
    if interface.accepts || interface.subdivides {
        return say("follows the steps of the solver, which the target does not have", leave_out);
    }
    if interface.outputs.is_empty() && interface.states.is_empty() && interface.discrete.is_empty() {
        // It only reads: a Terminator.
        return None;
    }
    let Some(law) = &block.law else {
        return Some((
            "records no law that could be translated".to_owned(),
            format!("replace it by blocks of the signal library that do, or {leave_out}"),
        ));
    };
    if interface.settles && law.settled.is_empty() {
        return say("does not record how it chooses its modes", leave_out);
    }
    let settled = |i: usize| law.settled.iter().any(|(state, _)| *state == i);
    if block.rate.is_some() && law.updated.is_empty() && !(0..interface.discrete.len()).all(settled) {
        return say("does not record what it does at its sample hits", leave_out);
    }
    if !interface.states.is_empty() && selected.target.method.is_none() {
        let n = interface.states.len();
        let states = if n == 1 { "a continuous state".to_owned() } else { format!("{n} continuous states") };
        return Some((
            format!("has {states}"),
            "give a method of fixed step, `--method euler` or `--method rk4`, or take its discrete form (DiscreteIntegrator, \
             DiscreteTransferFunction, DiscretePid)"
                .to_owned(),
        ));
    }
    rate(selected, block)
}

fn rate(selected: &Selected, block: &Instance) -> Option<(String, String)> {
    let rate = block.rate?;
    if selected.divisor(rate).is_some() {
        return None;
    }
    let clock = &selected.schedule.clock;
    let (period, offset) = (clock.time(clock.rates[rate].period), clock.time(clock.rates[rate].offset));
    let offset = if offset == 0.0 { String::new() } else { format!(" from {offset} s") };
    Some((
        format!(
            "samples every {period} s{offset}, which is not a multiple of the step of {} s",
            selected.target.step
        ),
        "choose a rate of which all sample times are multiples".to_owned(),
    ))
}
