//! Signals as they are named on the command line.

use blocksim_block::schedule::Schedule;
use blocksim_signal::{Dimension, Kind, closest};

use crate::failure::Failure;

/// One number among the signals.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// As it was asked for.
    pub name: String,
    /// Where its value is.
    pub cell: usize,
    /// What is measured, if anything says it.
    pub dimension: Option<Dimension>,
}

impl Place {
    /// Its unit in SI; `1` for none.
    pub fn unit(&self) -> String {
        self.dimension.map_or_else(|| "1".to_owned(), |dimension| dimension.to_string())
    }
}

/// Finds a signal: what is recorded under this name, or an output of a block; of a vector one element, `arm.q[2]`.
///
/// # Errors
/// If there is no such signal; the help suggests one.
pub fn find(schedule: &Schedule, name: &str) -> Result<Place, Failure> {
    let name = name.trim();
    if let Some(recorded) = schedule.recorded.iter().find(|recorded| recorded.path == name) {
        real(name, recorded.kind)?;
        return Ok(Place { name: name.to_owned(), cell: recorded.cell, dimension: recorded.dimension });
    }
    let (path, element) = split(name);
    let Some(signal) = schedule.signals.iter().find(|signal| signal.path == path) else {
        return Err(unknown(schedule, name));
    };
    real(name, signal.kind)?;
    let count = signal.shape.len();
    let last = count.saturating_sub(1);
    let element = match (element, count) {
        (None, 1) => 0,
        (Some(element), _) if element < count => element,
        (None, _) => {
            let help = format!("name one of them, from `{name}[0]` to `{name}[{last}]`");
            return Err(Failure::usage(format!("`{name}` has {count} elements")).help(help));
        }
        (Some(element), _) => {
            let help = format!("its elements go from `{path}[0]` to `{path}[{last}]`");
            return Err(Failure::usage(format!("`{path}` has no element {element}")).help(help));
        }
    };
    Ok(Place { name: name.to_owned(), cell: signal.offset + element, dimension: signal.dimension })
}

/// Path and element of `arm.q[2]`.
fn split(name: &str) -> (&str, Option<usize>) {
    let parts = name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    match parts.and_then(|(path, element)| Some((path, element.parse().ok()?))) {
        Some((path, element)) => (path, Some(element)),
        None => (name, None),
    }
}

fn real(name: &str, kind: Kind) -> Result<(), Failure> {
    match kind {
        Kind::Bool | Kind::Int => Err(Failure::usage(format!("`{name}` has no values in between"))
            .help("name a signal of real numbers; slopes have a meaning for these alone")),
        _ => Ok(()),
    }
}

fn unknown(schedule: &Schedule, name: &str) -> Failure {
    // An input of a block is the signal that leads to it.
    if let Some((path, port)) = name.rsplit_once('.')
        && let Some(block) = schedule.blocks.iter().find(|block| block.path == path)
        && let Some(at) = block.interface.inputs.iter().position(|input| input.name == port)
        && let Some(source) = source(schedule, block, at)
    {
        return Failure::usage(format!("`{name}` is an input"))
            .help(format!("name the signal that leads to it, `{source}`"));
    }
    let names = schedule.signals.iter().map(|signal| signal.path.as_str());
    let recorded = schedule.recorded.iter().map(|recorded| recorded.path.as_str());
    let names: Vec<&str> = names.chain(recorded).collect();
    let ends_so =
        |path: &&&str| path.rsplit(['/', '.']).next() == name.rsplit(['/', '.']).next() && name.contains('.');
    let likely = closest(name, names.iter().copied());
    let likely = likely.or_else(|| names.iter().find(|path| path.starts_with(&format!("{name}."))).copied());
    let meant = likely.or_else(|| names.iter().find(ends_so).copied());
    Failure::usage(format!("there is no signal `{name}`")).help(match meant {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!(
            "signals are named by block and port, such as `{}`; `blocksim emit types MODEL` lists them",
            names.first().unwrap_or(&"gain.y")
        ),
    })
}

/// The signal that an input is read from.
fn source<'a>(
    schedule: &'a Schedule,
    block: &blocksim_block::schedule::Instance,
    input: usize,
) -> Option<&'a str> {
    let start = block.inputs.get(input)?.0;
    let mut at = 0;
    let &(from, _) = block.gather.iter().find(|(_, length)| {
        let here = (at..at + length).contains(&start);
        at += length;
        here
    })?;
    let signal = schedule
        .signals
        .iter()
        .find(|signal| (signal.offset..signal.offset + signal.shape.len()).contains(&(from as usize)))?;
    Some(&signal.path)
}
