//! Programs as text.

use crate::{Guard, Id, Op, Program};
use std::fmt;

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "%{}", self.0)
    }
}

impl Program {
    /// An operation as text, with the names of what comes from outside.
    pub fn instruction(&self, op: Op) -> String {
        let name = |kind: &str, list: Option<&str>| format!("{kind} {}", list.unwrap_or("?"));
        let word = |of: &dyn fmt::Debug| format!("{of:?}").to_lowercase();
        match op {
            Op::Constant(bits) => format!("{:?}", f64::from_bits(bits)),
            Op::Time => "time".to_owned(),
            Op::Input(i) => name("input", self.inputs.get(i as usize).map(String::as_str)),
            Op::State(i) => name("state", self.states.get(i as usize).map(|state| state.name.as_str())),
            Op::Parameter(i) => {
                name("parameter", self.parameters.get(i as usize).map(|(name, _)| name.as_str()))
            }
            Op::Memory(i) => name("memory", self.memories.get(i as usize).map(|memory| memory.name.as_str())),
            Op::Mode(i) => format!("mode {i}"),
            Op::Neg(a) => format!("-{a}"),
            Op::Add(a, b) => format!("{a} + {b}"),
            Op::Sub(a, b) => format!("{a} - {b}"),
            Op::Mul(a, b) => format!("{a} * {b}"),
            Op::Div(a, b) => format!("{a} / {b}"),
            Op::Power(a, n) => format!("{a} ^ {n}"),
            Op::Unary(function, a) => format!("{} {a}", word(&function)),
            Op::Binary(function, a, b) => format!("{} {a}, {b}", word(&function)),
            Op::Clamp(a, lower, upper) => format!("{a} from {lower} to {upper}"),
            Op::Compare(relation, a, b) => {
                use crate::Relation as R;
                let sign = match relation {
                    R::Less => "<",
                    R::LessEqual => "<=",
                    R::Greater => ">",
                    R::GreaterEqual => ">=",
                    R::Equal => "==",
                    R::NotEqual => "!=",
                };
                format!("{a} {sign} {b}")
            }
            Op::Not(a) => format!("not {a}"),
            Op::And(a, b) => format!("{a} and {b}"),
            Op::Or(a, b) => format!("{a} or {b}"),
            Op::Select(c, a, b) => format!("if {c} then {a} else {b}"),
            Op::Require(domain, holds, about) => format!("require {holds}: {about} is {}", domain.wanted()),
        }
    }
}

impl fmt::Display for Program {
    /// One instruction a line with its type and place, then what refers to them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (instruction, truth)) in self.instructions.iter().zip(self.truths()).enumerate() {
            let kind = if truth { "bool" } else { "real" };
            write!(f, "%{i}: {kind} = {}", self.instruction(instruction.op))?;
            match &instruction.place {
                Some(place) => writeln!(f, "    // {}..{}", place.start, place.end)?,
                None => writeln!(f)?,
            }
        }
        let list = |guards: &[Guard]| -> String {
            guards.iter().map(|guard| format!(" {} ({})", guard.value, guard.name)).collect()
        };
        for state in &self.states {
            let derivative = state.derivative.map_or("0".to_owned(), |id| id.to_string());
            writeln!(f, "state {} from {:?}: derivative {derivative}", state.name, state.initial)?;
        }
        for memory in &self.memories {
            let next = memory.next.map_or("itself".to_owned(), |id| id.to_string());
            writeln!(f, "memory {} from {:?}: next {next}", memory.name, memory.initial)?;
        }
        for (i, mode) in self.modes.iter().enumerate() {
            writeln!(f, "mode {i} is {} from zero to zero of{}", mode.value, list(&mode.guards))?;
        }
        if !self.kinks.is_empty() {
            writeln!(f, "kinks at zeros of{}", list(&self.kinks))?;
        }
        for (name, id) in &self.outputs {
            writeln!(f, "output {name} = {id}")?;
        }
        Ok(())
    }
}
