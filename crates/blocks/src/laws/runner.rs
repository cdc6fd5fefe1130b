//! A program as the engine runs it: what is wanted when, for each element.

use blocksim_block::event::{Change, Event, Subject};
use blocksim_block::{Context, Discrete, Interface, ParamError};
use blocksim_law::{Code, Failure, Id, Program, Sources, passes};

/// A program, cut into what is evaluated at different occasions.
#[derive(Debug, Clone)]
pub(crate) struct Runner {
    program: Program,
    /// The outputs, then the derivatives; requirements stand between.
    values: Code,
    /// What is wanted of the values; the requirements come behind.
    count: usize,
    /// What the modes are chosen by.
    modes: Code,
    /// The values with modes that are chosen anew.
    fresh: Code,
    guards: Code,
}

/// Most registers and inputs of a law: what settling has room for on the stack.
const MOST_NUMBERS: usize = 1024;
/// Enough for nearly all laws.
const FEW_NUMBERS: usize = 64;

const TRUTH: &[Change] = &[Change::to(1.0, "becomes true"), Change::to(0.0, "becomes false")];

impl Runner {
    /// Makes a program ready to run; `param` is the parameter that holds its text.
    ///
    /// # Errors
    /// It is too large, or a part of it never has a value.
    pub fn new(program: &Program, param: &str, text: &str) -> Result<Self, ParamError> {
        let program = passes::bind_parameters(program).optimised();
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
        let mut wanted = program.output_values();
        wanted.extend(program.states.iter().filter_map(|state| state.derivative));
        let count = wanted.len();
        wanted.extend(&program.requirements);
        let released = passes::release_modes(&program);
        let mut fresh = released.output_values();
        fresh.extend(released.states.iter().filter_map(|state| state.derivative));
        fresh.extend(&released.requirements);
        let guards: Vec<Id> = program.guards().map(|guard| guard.value).collect();
        let runner = Self {
            values: Code::new(&program, &wanted),
            count,
            modes: Code::new(&released, &released.mode_values()),
            fresh: Code::new(&released, &fresh),
            guards: Code::new(&program, &guards),
            program,
        };
        if runner.numbers() > MOST_NUMBERS {
            let message = format!(
                "the law needs {} numbers at a time, but there is room for {MOST_NUMBERS}",
                runner.numbers()
            );
            return Err(ParamError::new(param, message).help("make several blocks of it"));
        }
        Ok(runner)
    }

    /// Length of the space that an evaluation needs.
    pub fn numbers(&self) -> usize {
        let codes = [&self.values, &self.modes, &self.fresh, &self.guards];
        self.program.inputs.len() + codes.map(Code::registers).into_iter().max().unwrap_or(0)
    }

    /// Number of guards of one element.
    pub fn guard_count(&self) -> usize {
        self.program.guards().count()
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
        if self.program.modes.is_empty() { interface } else { interface.settles() }
    }

    fn inputs<'b>(&self, c: &'b Context, i: usize, space: &'b mut [f64]) -> (&'b [f64], &'b mut [f64]) {
        let (inputs, registers) = space.split_at_mut(self.program.inputs.len());
        // Scalars alone lie one behind the other: most diagrams have nothing else.
        if c.u.len() == c.inputs.len() {
            return (c.u, registers);
        }
        inputs.iter_mut().enumerate().for_each(|(k, to)| *to = crate::math::elements::at(c.input(k), i));
        (inputs, registers)
    }

    /// Computes the values of element `i`, and hands each with its number over. Returns the requirement that is not met.
    ///
    /// Within a step, what modes hold may be late: a trial goes a little beyond the end of a branch, where that may have no value.
    /// There the values are those of the branch that fits the moment; the guard ends the step at the crossing in any case.
    pub fn values(
        &self,
        c: &Context,
        i: usize,
        space: &mut [f64],
        mut take: impl FnMut(usize, f64),
    ) -> Option<Failure> {
        let modes = self.held(c.d, i);
        let (inputs, registers) = self.inputs(c, i, space);
        let sources = Sources { time: c.t, inputs, states: c.x, modes, ..Sources::default() };
        let mut code = &self.values;
        let mut failure = code.run(&sources, registers);
        if failure.is_some() && !modes.is_empty() {
            code = &self.fresh;
            failure = code.run(&sources, registers).and(failure);
        }
        (0..self.count).for_each(|k| take(k, code.result(registers, k)));
        failure
    }

    fn held<'d>(&self, d: &'d [f64], i: usize) -> &'d [f64] {
        let n = self.program.modes.len();
        &d[i * n..(i + 1) * n]
    }

    /// Chooses the modes of `n` elements.
    pub fn settle(&self, c: &Context, d: &mut [f64], n: usize) {
        if self.numbers() <= FEW_NUMBERS {
            self.settle_in(c, d, n, &mut [0.0; FEW_NUMBERS]);
        } else {
            self.settle_in(c, d, n, &mut [0.0; MOST_NUMBERS]);
        }
    }

    fn settle_in(&self, c: &Context, d: &mut [f64], n: usize, space: &mut [f64]) {
        let count = self.program.modes.len();
        for i in 0..n {
            let (inputs, registers) = self.inputs(c, i, space);
            let sources = Sources { time: c.t, inputs, states: c.x, ..Sources::default() };
            self.modes.run(&sources, registers);
            for (k, d) in d[i * count..(i + 1) * count].iter_mut().enumerate() {
                *d = self.modes.result(registers, k);
            }
        }
    }

    /// Writes the guards of `n` elements.
    pub fn guards(&self, c: &Context, g: &mut [f64], n: usize, space: &mut [f64]) {
        let count = self.program.guards().count();
        for i in 0..n {
            let modes = self.held(c.d, i);
            let (inputs, registers) = self.inputs(c, i, space);
            let sources = Sources { time: c.t, inputs, states: c.x, modes, ..Sources::default() };
            self.guards.run(&sources, registers);
            for (k, g) in g[i * count..(i + 1) * count].iter_mut().enumerate() {
                *g = self.guards.result(registers, k);
            }
        }
    }

    /// Why the law cannot go on; `text` is what the places of the program are in.
    pub fn reason(&self, failure: &Failure, text: &str) -> String {
        let place = self.program.instructions[failure.at.0 as usize].place.clone();
        let shown = place.and_then(|place| text.get(place)).unwrap_or(text);
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
