//! A simulation that failed, as a problem: what, when, where in which file, and what to do.

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{BlockPart, Instance, Schedule};
use blocksim_sim::{SimError, Simulation};

use crate::terminal::format::short_time;

/// Most parts of a network that are pointed to.
const MOST: usize = 4;

/// The failure with the place of the block that is to blame.
pub fn failure(error: &SimError, schedule: &Schedule) -> Problem {
    let mut problem = Problem::error(error.code, reason(error));
    if let Some(path) = &error.path {
        let block = schedule.blocks.iter().find(|block| block.path == *path);
        problem = match block {
            Some(network) if !network.parts.is_empty() => in_network(problem, network),
            Some(Instance { place: Some(place), .. }) => problem.at(place, this_is(path)),
            _ => problem.note(format!("in `{path}`")),
        };
    }
    problem.help.clone_from(&error.help);
    problem
}

/// A label at the place of a block.
fn this_is(path: &str) -> String {
    format!("this is `{path}`")
}

/// The path of the block whose place a label is at, if it is at that of a block.
pub fn block_of(label: &str) -> Option<&str> {
    label.strip_prefix("this is `")?.strip_suffix('`')
}

/// What is said of the accuracy of a run at its end, with the places of the blocks that are named.
pub fn warnings(simulation: &mut Simulation, schedule: &Schedule) -> Vec<Problem> {
    let networks = || schedule.blocks.iter().filter(|block| !block.parts.is_empty());
    let placed = |warning: Problem| {
        let network = networks().find(|network| !named(&warning.message, &network.parts).is_empty());
        match network {
            Some(network) => in_network(warning, network),
            None => at_blocks(warning, schedule),
        }
    };
    simulation.warnings().into_iter().map(placed).collect()
}

/// What happened, and when. Settings are refused before there is any time.
pub fn reason(error: &SimError) -> String {
    match error.code {
        "settings" => error.message.clone(),
        _ => format!("{} at t = {} s", error.message, short_time(error.t)),
    }
}

/// Points to the blocks that the message names.
fn at_blocks(mut problem: Problem, schedule: &Schedule) -> Problem {
    let blocks = schedule.blocks.iter().filter(|block| block.parts.is_empty());
    let parts: Vec<BlockPart> =
        blocks.map(|block| BlockPart { path: block.path.clone(), place: block.place.clone() }).collect();
    for part in named(&problem.message, &parts).iter().take(MOST) {
        if let Some(place) = &part.place {
            problem = problem.at(place, this_is(&part.path));
        }
    }
    problem
}

/// Points to the parts of a network that the message names, or to one of them if it names none.
fn in_network(mut problem: Problem, network: &Instance) -> Problem {
    let named = named(&problem.message, &network.parts);
    for part in named.iter().take(MOST) {
        if let Some(place) = &part.place {
            problem = problem.at(place, this_is(&part.path));
        }
    }
    match &network.parts[0].place {
        Some(place) if problem.labels.is_empty() => problem.at(place, "the network around this block"),
        _ => problem,
    }
}

/// Parts whose path, alone or followed by a port or a state, stands in backticks; each once.
fn named<'a>(message: &str, parts: &'a [BlockPart]) -> Vec<&'a BlockPart> {
    let mut found: Vec<&BlockPart> = Vec::new();
    for quoted in message.split('`').skip(1).step_by(2) {
        let is_meant = |part: &&BlockPart| {
            quoted.strip_prefix(&part.path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        found.extend(parts.iter().filter(is_meant));
    }
    let mut seen = Vec::new();
    found.retain(|part| {
        let is_new = !seen.contains(&part.path.as_str());
        seen.push(part.path.as_str());
        is_new
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_known_by_its_label() {
        assert_eq!(block_of(&this_is("arm/link 1")), Some("arm/link 1"));
        assert_eq!(block_of("the network around this block"), None);
    }

    #[test]
    fn the_parts_that_a_message_names_are_found_in_its_order() {
        let parts =
            ["arm/link1", "arm/link10", "motor"].map(|path| BlockPart { path: path.into(), place: None });
        let paths = |message: &str| -> Vec<String> {
            named(message, &parts).iter().map(|part| part.path.clone()).collect()
        };
        assert_eq!(paths("`motor` drives `arm/link10.angle`, `motor`"), ["motor", "arm/link10"]);
        assert_eq!(paths("`network(arm/link1)` cannot go on: `arm` or arm/link1"), [""; 0]);
    }
}
