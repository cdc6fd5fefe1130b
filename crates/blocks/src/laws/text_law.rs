//! The program of a text as the law of a block, element by element.

use blocksim_block::event::{Change, Event, Subject};
use blocksim_block::law::{Recording, Value};
use blocksim_block::{Discrete, Interface, InterfaceError, ParamError};
use blocksim_law::{Failure, Id, Program, Replayed, passes};

/// The program of a text, with its parameters bound.
#[derive(Debug, Clone)]
pub(crate) struct TextLaw {
    program: Program,
}

/// Most instructions of all elements of a block together.
const MOST_INSTRUCTIONS: usize = 1 << 22;

const TRUTH: &[Change] = &[Change::to(1.0, "becomes true"), Change::to(0.0, "becomes false")];

impl TextLaw {
    /// Takes a program; `param` is the parameter that holds its text.
    ///
    /// # Errors
    /// A part of it never has a value.
    pub fn new(program: &Program, param: &str, text: &str) -> Result<Self, ParamError> {
        let program = passes::bind_parameters(program.clone()).optimised();
        for id in &program.requirements {
            if let blocksim_law::Op::Require(domain, holds, about) = program.op(*id)
                && program.op(holds).as_constant() == Some(0.0)
            {
                let value = program.op(about).as_constant().unwrap_or(f64::NAN);
                let place = program.instructions[id.0 as usize].place.clone().unwrap_or(0..text.len());
                let shown = text.get(place.clone()).unwrap_or(text);
                let message = format!(
                    "`{shown}` has no value: it needs a number that is {}, not {value}",
                    domain.wanted()
                );
                return Err(ParamError::new(param, message).within(place));
            }
        }
        Ok(Self { program })
    }

    /// Whether there is room for the laws of `n` elements.
    ///
    /// # Errors
    /// They are too many instructions.
    pub fn fits(&self, n: usize) -> Result<(), InterfaceError> {
        let length = self.program.instructions.len();
        if length.checked_mul(n).is_some_and(|all| all <= MOST_INSTRUCTIONS) {
            return Ok(());
        }
        let message = format!(
            "a law of {length} operations for each of {n} elements is more than {MOST_INSTRUCTIONS} operations"
        );
        Err(InterfaceError { code: "too_large", ports: Vec::new(), message, help: None }
            .help("shorten the law, or compute with fewer elements"))
    }

    /// Number of modes of one element.
    pub fn modes(&self) -> usize {
        self.program.modes.len()
    }

    /// Number of guards of one element.
    pub fn guards(&self) -> usize {
        self.program.guards().count()
    }

    /// Records the law of element `i`, whose modes and guards stand behind those of the elements before it, from `d` and `g` on.
    pub fn record<'r>(&self, l: &Recording<'r>, i: usize, d: usize, g: usize) -> Replayed<'r> {
        let inputs: Vec<Value> = (0..l.inputs()).map(|port| l.element(port, i)).collect();
        let (d, g) = (d + i * self.modes(), g + i * self.guards());
        let replayed = l.replay(&self.program, &inputs, &l.d()[d..d + self.modes()]);
        replayed.modes.iter().enumerate().for_each(|(k, mode)| l.settle(d + k, *mode));
        replayed.guards.iter().enumerate().for_each(|(k, guard)| l.guard(g + k, *guard));
        replayed
    }

    /// Adds modes, guards and what follows from the angles of the law to the interface of a block of `n` elements.
    /// `text` is what the places of the program are in.
    pub fn declare(&self, mut interface: Interface, n: usize, text: &str) -> Interface {
        let element = |i: usize| (n > 1).then(|| format!("element {i}"));
        let place = |id: Id| self.program.instructions[id.0 as usize].place.clone();
        let shown = |id: Id, i: usize| {
            let part = place(id).and_then(|place| text.get(place)).map(str::to_owned);
            match (part, element(i)) {
                (Some(part), Some(element)) => Some(format!("{part}, {element}")),
                (part, element) => part.or(element),
            }
        };
        for i in 0..n {
            for (k, mode) in self.program.modes.iter().enumerate() {
                let detail = shown(mode.value, i);
                let state = Discrete::new(format!("mode{k}[{i}]"), 0.0);
                let compares = mode.guards.iter().all(|guard| guard.name == "compare");
                interface.discrete.push(match compares {
                    true => state.changes(TRUTH, Subject { part: None, detail: detail.clone() }),
                    false => state,
                });
                for (side, guard) in mode.guards.iter().enumerate() {
                    interface = interface.guard(format!("{}{k}_{side}[{i}]", guard.name));
                    interface = interface.detail(detail.clone());
                    set_event(&mut interface, guard.name);
                }
            }
            for (k, kink) in self.program.kinks.iter().enumerate() {
                interface = interface.kink(format!("{}{k}[{i}]", kink.name)).detail(shown(kink.value, i));
                set_event(&mut interface, kink.name);
            }
        }
        for turn in &self.program.turns {
            interface = match self.program.op(*turn) {
                blocksim_law::Op::Input(input) => interface.turning_input(input as usize),
                blocksim_law::Op::State(state) => interface.turning_state(state as usize),
                _ => interface,
            };
        }
        interface
    }
}

/// Why a law cannot go on whose text is `text`.
pub(crate) fn no_value(failure: &Failure, text: &str) -> String {
    let shown = failure.place.clone().and_then(|place| text.get(place)).unwrap_or(text);
    let plain = failure.value == 0.0 || (1e-4..1e7).contains(&failure.value.abs());
    let value = if plain { failure.value.to_string() } else { format!("{:e}", failure.value) };
    match failure.domain {
        blocksim_law::Domain::NotZero => {
            format!(
                "division by zero in `{shown}`: keep the divisor away from zero, as with if(..., ..., ...)"
            )
        }
        domain => format!(
            "`{shown}` has no value at {value}: the number must be {} (min, max or if can keep it there)",
            domain.wanted()
        ),
    }
}

/// What the crossings of the last guard are called.
fn set_event(interface: &mut Interface, name: &str) {
    let (upwards, downwards) = match name {
        "min" | "max" => ("passes another argument", "passes another argument"),
        "floor" | "ceil" | "round" => ("steps up", "steps down"),
        "compare" => {
            interface.guards.iter_mut().last().into_iter().for_each(|guard| guard.event = Event::Mode);
            return;
        }
        _ => ("turns positive", "turns negative"),
    };
    let event = Event::Crossing { upwards, downwards };
    interface.guards.iter_mut().last().into_iter().for_each(|guard| guard.event = event);
}
