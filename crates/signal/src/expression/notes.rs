//! What an expression is made of, beside its value.

use crate::unit_table::Factor;
use crate::{Dimension, Unit, Value};

/// A value, and what the expression says of units.
#[derive(Debug, Clone, PartialEq)]
pub struct Noted {
    /// The value.
    pub value: Value,
    /// Whether nothing in it has a unit: no number, and no parameter that it names. Units that cancel, as in `4 m / 2 m`,
    /// count as units.
    pub is_bare: bool,
    /// The units that stand in it, in their order, as written but without spaces.
    pub units: Vec<Unit>,
    /// The parameters that it names, with members and items as written: `axis.mass`, `start[0]`.
    pub names: Vec<String>,
    /// The byte at which each of the names begins.
    pub starts: Vec<usize>,
    /// Whether a ratio in decibels stands in it, which is no multiple of a unit.
    pub has_decibels: bool,
}

/// What is gathered while an expression is read.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    pub units: Vec<Unit>,
    pub names: Vec<String>,
    pub starts: Vec<usize>,
    /// Whether a parameter with a unit was named.
    has_dimension: bool,
    has_decibels: bool,
}

impl Notes {
    /// A unit behind a number.
    pub(super) fn unit(&mut self, text: &str, factor: Factor) {
        let text = text.chars().filter(|sign| !sign.is_whitespace()).collect();
        let Factor { offset, dimension, .. } = factor;
        self.units.push(Unit { text, scale: factor.scale(), offset, dimension });
    }

    /// A ratio in decibels.
    pub(super) fn decibels(&mut self) {
        self.has_decibels = true;
    }

    /// A parameter that is named, where, and its value.
    pub(super) fn name(&mut self, text: &str, start: usize, value: &Value) {
        self.has_dimension |= has_dimension(value);
        self.names.push(text.to_owned());
        self.starts.push(start);
    }

    pub(super) fn with(self, value: Value) -> Noted {
        let is_bare = self.units.is_empty() && !self.has_dimension && !self.has_decibels;
        let Self { units, names, starts, has_decibels, .. } = self;
        Noted { value, is_bare, units, names, starts, has_decibels }
    }
}

fn has_dimension(value: &Value) -> bool {
    match value {
        Value::Number(quantity) => quantity.dimension != Dimension::NONE,
        Value::List(items) => items.iter().any(has_dimension),
        Value::Set(members) => members.iter().any(|(_, value)| has_dimension(value)),
        Value::Bool(_) | Value::Text(_) => false,
    }
}
