//! A program that is recorded once more, as a part of another law.

use crate::{Id, Op, Program, Recorder, Value};

/// What stands for what comes from outside of a program that is recorded once more. Its parameters are constants, the time is the same.
#[derive(Debug, Clone, Copy)]
pub struct Outside<'a, 'r> {
    /// The inputs, in the order of the program.
    pub inputs: &'a [Value<'r>],
    /// The continuous states.
    pub states: &'a [Value<'r>],
    /// What the modes hold.
    pub modes: &'a [Value<'r>],
}

/// What a program has become.
#[derive(Debug, Clone)]
pub struct Replayed<'r> {
    /// The outputs.
    pub outputs: Vec<Value<'r>>,
    /// The derivatives, of the states that have one.
    pub derivatives: Vec<Value<'r>>,
    /// What the modes are chosen to be at the moment.
    pub modes: Vec<Value<'r>>,
    /// The guards of the modes, then those of the kinks.
    pub guards: Vec<Value<'r>>,
}

impl Recorder {
    /// Records a program once more. Its modes are none of this law: the caller holds them.
    ///
    /// Within a step, what modes hold may be late: a trial goes a little beyond the end of a branch, where that may have no value.
    /// There the outputs and derivatives are those of the branch that fits the moment; the guard ends the step at the crossing in
    /// any case. A requirement fails where it is met in neither.
    ///
    /// # Panics
    /// Panics if fewer values are given than the program names.
    pub fn replay<'r>(&'r self, program: &Program, outside: &Outside<'_, 'r>) -> Replayed<'r> {
        let truths = program.truths();
        let held = self.copy(program, outside, |mode, _| {
            let value = outside.modes[mode];
            if truths[program.modes[mode].value.at()] { value.is_true().id() } else { value.id() }
        });
        let fresh = match program.modes.is_empty() {
            true => held.clone(),
            false => {
                self.copy(program, outside, |mode, copied: &[Id]| copied[program.modes[mode].value.at()])
            }
        };
        let requirements: Vec<(usize, Op)> =
            program.requirements.iter().map(|id| (id.at(), program.op(*id))).collect();
        let met = |copied: &[Id]| {
            let holds = requirements.iter().filter_map(|(_, op)| match op {
                Op::Require(_, holds, _) => Some(copied[holds.at()]),
                _ => None,
            });
            holds.reduce(|all, one| self.push(Op::And(all, one)))
        };
        let both = (!program.modes.is_empty()).then(|| (met(&held), met(&fresh)));
        for (at, op) in &requirements {
            if let Op::Require(domain, holds, about) = *op {
                let mut holds = held[holds.at()];
                if let Some((_, Some(fresh))) = both {
                    holds = self.push(Op::Or(holds, fresh));
                }
                let place = program.instructions[*at].place.clone();
                self.requires(self.push_at(Op::Require(domain, holds, held[about.at()]), place));
            }
        }
        let value = |id: &Id| {
            let [a, b] = [held[id.at()], fresh[id.at()]];
            self.handle(match both {
                Some((Some(met), _)) if a != b => self.push(Op::Select(met, a, b)),
                _ => a,
            })
        };
        let derivatives = program.states.iter().filter_map(|state| state.derivative.as_ref());
        Replayed {
            outputs: program.outputs.iter().map(|(_, id)| value(id)).collect(),
            derivatives: derivatives.map(value).collect(),
            modes: program.modes.iter().map(|mode| self.handle(fresh[mode.value.at()])).collect(),
            guards: program.guards().map(|guard| self.handle(held[guard.value.at()])).collect(),
        }
    }

    /// Records the instructions of a program without its requirements, and returns what each has become. `mode` says what stands for
    /// a mode, of which it is handed the number and what those before it have become.
    fn copy(&self, program: &Program, outside: &Outside, mode: impl Fn(usize, &[Id]) -> Id) -> Vec<Id> {
        let mut copied: Vec<Id> = Vec::with_capacity(program.instructions.len());
        for instruction in &program.instructions {
            let id = match instruction.op {
                Op::Input(i) => outside.inputs[i as usize].id(),
                Op::State(i) => outside.states[i as usize].id(),
                Op::Mode(i) => mode(i as usize, &copied),
                Op::Parameter(i) => self.push(Op::constant(program.parameters[i as usize].1)),
                // Whoever records it decides when it is met; nothing reads it.
                Op::Require(_, holds, _) => copied[holds.at()],
                op => self.push_at(op.map(|id| copied[id.at()]), instruction.place.clone()),
            };
            copied.push(id);
        }
        copied
    }
}
