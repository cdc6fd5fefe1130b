//! What the parts of an expression are worth to whoever reads it.

use super::notes::Notes;
use crate::arithmetic::{self, Operand};
use crate::unit_table::Factor;
use crate::{ExprError, Lookup, Quantity, Value, functions, select};
use std::ops::Range;

/// What the parts of an expression become as they are read. The reader knows the grammar alone; one meaning computes
/// ([`Evaluation`]), another keeps the expression for later ([`crate::Formula`]).
pub(crate) trait Meaning {
    /// What a part becomes.
    type Value: Clone;
    /// Whether `<`, `>` and the like may stand in the text.
    const COMPARES: bool;

    /// A number with its unit.
    fn quantity(&mut self, quantity: Quantity, span: Range<usize>) -> Result<Self::Value, ExprError>;

    /// A value that is known, such as that of `pi`.
    fn known(&mut self, value: Value, span: Range<usize>) -> Result<Self::Value, ExprError>;

    /// A name and what the scope says to it; `None` if it is unknown.
    fn name(
        &mut self,
        word: &str,
        looked_up: Lookup,
        span: Range<usize>,
    ) -> Result<Option<Self::Value>, ExprError>;

    /// A list.
    fn list(
        &mut self,
        items: Vec<Operand<Self::Value>>,
        span: Range<usize>,
    ) -> Result<Self::Value, ExprError>;

    /// A member; `span` is the place of its name.
    fn member(
        &mut self,
        from: Operand<Self::Value>,
        name: &str,
        span: Range<usize>,
    ) -> Result<Self::Value, ExprError>;

    /// An item of a list.
    fn item(
        &mut self,
        from: Operand<Self::Value>,
        index: &Operand<Self::Value>,
    ) -> Result<Self::Value, ExprError>;

    /// `left sign right`.
    fn binary(
        &mut self,
        sign: char,
        left: &Operand<Self::Value>,
        right: &Operand<Self::Value>,
    ) -> Result<Self::Value, ExprError>;

    /// `-operand`.
    fn negated(
        &mut self,
        operand: &Operand<Self::Value>,
        span: Range<usize>,
    ) -> Result<Self::Value, ExprError>;

    /// `+operand`, which is the operand if it is a number.
    fn plus(&mut self, operand: &Operand<Self::Value>) -> Result<(), ExprError>;

    /// A unit behind a parenthesis.
    fn in_unit(
        &mut self,
        operand: &Operand<Self::Value>,
        factor: Factor,
        span: Range<usize>,
    ) -> Result<Self::Value, ExprError>;

    /// A function; `named` is the place of its name.
    fn call(
        &mut self,
        word: &str,
        named: Range<usize>,
        arguments: &[Operand<Self::Value>],
        span: Range<usize>,
    ) -> Result<Self::Value, ExprError>;

    /// Notes a name that was read.
    fn note(&self, notes: &mut Notes, text: &str, start: usize, value: &Self::Value);
}

/// Computes the value at once.
pub(super) struct Evaluation;

impl Meaning for Evaluation {
    type Value = Value;
    const COMPARES: bool = false;

    fn quantity(&mut self, quantity: Quantity, span: Range<usize>) -> Result<Value, ExprError> {
        arithmetic::sound(quantity, span)
    }

    fn known(&mut self, value: Value, _span: Range<usize>) -> Result<Value, ExprError> {
        Ok(value)
    }

    fn name(
        &mut self,
        _word: &str,
        looked_up: Lookup,
        _span: Range<usize>,
    ) -> Result<Option<Value>, ExprError> {
        match looked_up {
            Lookup::Found(value) => Ok(Some(value)),
            Lookup::Unknown | Lookup::Failed(_) => Ok(None),
        }
    }

    fn list(&mut self, items: Vec<Operand>, _span: Range<usize>) -> Result<Value, ExprError> {
        Ok(Value::List(items.into_iter().map(|item| item.value).collect()))
    }

    fn member(&mut self, from: Operand, name: &str, span: Range<usize>) -> Result<Value, ExprError> {
        select::member(from, name, span)
    }

    fn item(&mut self, from: Operand, index: &Operand) -> Result<Value, ExprError> {
        select::item(from, index)
    }

    fn binary(&mut self, sign: char, left: &Operand, right: &Operand) -> Result<Value, ExprError> {
        arithmetic::binary(sign, left, right)
    }

    fn negated(&mut self, operand: &Operand, _span: Range<usize>) -> Result<Value, ExprError> {
        arithmetic::negated(operand)
    }

    fn plus(&mut self, operand: &Operand) -> Result<(), ExprError> {
        operand.number("put a plus sign before").map(|_| ())
    }

    fn in_unit(&mut self, operand: &Operand, factor: Factor, span: Range<usize>) -> Result<Value, ExprError> {
        arithmetic::sound(super::scaled(operand.number("give a unit to")?, factor), span)
    }

    fn call(
        &mut self,
        word: &str,
        named: Range<usize>,
        arguments: &[Operand],
        span: Range<usize>,
    ) -> Result<Value, ExprError> {
        functions::call(word, named, arguments, span)
    }

    fn note(&self, notes: &mut Notes, text: &str, start: usize, value: &Value) {
        notes.name(text, start, value);
    }
}
