//! What the engine runs, as text.

use std::collections::HashMap;
use std::fmt::Write;

use blocksim_block::law::{Draft, Root};
use blocksim_block::schedule::{Schedule, When};
use blocksim_sim::{LoopMethod, Pass, PassKind, PassPart, passes};

use crate::commands::graph::signal_at;

/// All passes over a diagram: programs instruction by instruction with the block that each comes from, and what is called.
pub(super) fn text(schedule: &Schedule) -> String {
    let mut text = String::new();
    for pass in passes(schedule) {
        write_pass(&mut text, schedule, &pass);
    }
    text
}

fn write_pass(text: &mut String, schedule: &Schedule, pass: &Pass) {
    let title = match pass.kind {
        PassKind::Major => "major step",
        PassKind::Between => "outputs between major steps",
        PassKind::Minor => "outputs for derivatives and guards",
        PassKind::Derivatives => "derivatives",
        PassKind::Guards => "guards",
        PassKind::Updates => "updates at sample hits",
    };
    let separator = if text.is_empty() { "" } else { "\n" };
    let nothing = if pass.parts.is_empty() { ": nothing" } else { "" };
    let _ = writeln!(text, "{separator}{title}{nothing}");
    for part in &pass.parts {
        match part {
            PassPart::Program { draft, blocks, when, places } => {
                let mut blocks = blocks.clone();
                blocks.dedup();
                let blocks: Vec<&str> =
                    blocks.iter().map(|block| schedule.blocks[*block].path.as_str()).collect();
                let when = when.map_or(String::new(), |when| due(schedule, when));
                let _ = writeln!(text, "  program{when}, of {}", blocks.join(", "));
                let places = match pass.kind {
                    PassKind::Guards => Names::Guards(places),
                    _ => Names::Derivatives(places),
                };
                write_program(text, schedule, draft, &places);
            }
            PassPart::Loop { number, method, draft } => {
                let found = &schedule.loops[*number];
                let steps = &schedule.steps[found.first..found.first + found.count];
                let mut blocks: Vec<&str> =
                    steps.iter().map(|step| schedule.blocks[step.block as usize].path.as_str()).collect();
                blocks.dedup();
                let how = match method {
                    LoopMethod::Elimination => "elimination, once for all",
                    LoopMethod::VaryingElimination => "elimination",
                    LoopMethod::Newton => "Newton's method with exact slopes",
                    LoopMethod::Differences => "Newton's method with slopes by differences",
                };
                let unknowns: Vec<String> = found
                    .cells
                    .iter()
                    .chain(&found.chosen)
                    .filter_map(|cell| signal_at(schedule, *cell))
                    .collect();
                let _ = writeln!(
                    text,
                    "  loop {}, of {}, solved for {} by {how}",
                    number + 1,
                    blocks.join(", "),
                    unknowns.join(", ")
                );
                if let Some(draft) = draft {
                    write_program(text, schedule, draft, &Names::Derivatives(&[]));
                }
            }
            PassPart::Calls(calls) => {
                for (block, group) in calls {
                    let block = &schedule.blocks[*block];
                    let group = match group {
                        Some(group) if block.groups() > 1 => format!(", output group {group}"),
                        _ => String::new(),
                    };
                    let law = if block.law.is_some() { "" } else { ", records no law" };
                    let _ = writeln!(text, "  call {} ({}{group}{law})", block.path, block.kind);
                }
            }
        }
    }
}

fn due(schedule: &Schedule, when: When) -> String {
    match when {
        When::Constant => " at the start".to_owned(),
        When::Major => " at each major step".to_owned(),
        When::Continuous => String::new(),
        When::Sampled(rate) => {
            let rate = schedule.clock.rates[rate as usize];
            let period = schedule.clock.time(rate.period);
            let offset = match rate.offset {
                0 => String::new(),
                offset => format!(" from {:?} s", schedule.clock.time(offset)),
            };
            format!(" every {period:?} s{offset}")
        }
    }
}

/// What values that are wanted anywhere are.
enum Names<'p> {
    Derivatives(&'p [u32]),
    Guards(&'p [u32]),
}

fn write_program(text: &mut String, schedule: &Schedule, draft: &Draft, places: &Names) {
    let program = draft.named(schedule);
    let truths = program.truths();
    for (i, instruction) in program.instructions.iter().enumerate() {
        let kind = if truths[i] { "bool" } else { "real" };
        let line = format!("    %{i}: {kind} = {}", program.instruction(instruction.op));
        let _ = match instruction.block {
            Some(block) => writeln!(text, "{line:<48} // {}", schedule.blocks[block as usize].path),
            None => writeln!(text, "{line}"),
        };
    }
    let mut guards = HashMap::new();
    for block in &schedule.blocks {
        for (i, guard) in block.interface.guards.iter().enumerate() {
            guards.insert(block.g + i, format!("guard {}.{}", block.path, guard.name));
        }
    }
    let mut anywhere = 0;
    for root in &draft.roots {
        let _ = match *root {
            Root::Cell(id, cell) => writeln!(text, "    {} = {id}", program.inputs[cell as usize]),
            Root::Held(id, number) => {
                writeln!(text, "    {} is set to {id}", program.memories[number as usize].name)
            }
            Root::Anywhere(id) => {
                let name = match places {
                    Names::Derivatives(places) => {
                        format!("d {}", program.states[places[anywhere] as usize].name)
                    }
                    Names::Guards(places) => {
                        guards.get(&(places[anywhere] as usize)).cloned().unwrap_or_default()
                    }
                };
                anywhere += 1;
                writeln!(text, "    {name} = {id}")
            }
            // The instruction says it.
            Root::Met(_) => Ok(()),
        };
    }
}
