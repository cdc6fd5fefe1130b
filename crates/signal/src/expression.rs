//! Expressions.

use crate::{ExprError, Quantity, Unit, Value};

/// Where an expression finds its names.
pub trait Scope {
    /// The value of a name. Only the first name of a path is looked up; the rest is selected from sets and lists.
    fn lookup(&self, name: &str) -> Lookup;

    /// All names, for spelling help.
    fn names(&self) -> Vec<String>;
}

/// What a scope says to a name.
#[derive(Debug, Clone, PartialEq)]
pub enum Lookup {
    /// The value.
    Found(Value),
    /// No such name here.
    Unknown,
    /// The name exists but has no value, with the reason.
    Failed(String),
}

/// The value of an expression.
pub fn evaluate(text: &str, scope: &dyn Scope) -> Result<Value, ExprError> {
    let text = text.trim();
    if let Lookup::Found(value) = scope.lookup(text) {
        return Ok(value);
    }
    let digits = text.find(char::is_whitespace).unwrap_or(text.len());
    let number: f64 = text[..digits].parse().map_err(|_| ExprError::new(0..digits, "expected a number"))?;
    if digits == text.len() {
        return Ok(number.into());
    }
    let unit = Unit::parse(&text[digits..]).map_err(|e| ExprError::new(e.span, e.message))?;
    Ok(Quantity::new(unit.to_si(number), unit.dimension).into())
}
