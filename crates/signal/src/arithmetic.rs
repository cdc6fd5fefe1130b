//! Sums, products and powers of quantities, with their dimensions checked.

use crate::{Dimension, ExprError, Quantity, Value};
use std::ops::Range;

/// A value and the bytes of the text it came from.
#[derive(Debug, Clone)]
pub(crate) struct Operand<V = Value> {
    pub value: V,
    pub span: Range<usize>,
}

impl Operand {
    /// The number, or an error that says what cannot be done: `cannot add a text`.
    pub fn number(&self, verb: &str) -> Result<Quantity, ExprError> {
        let missing =
            || ExprError::new(self.span.clone(), format!("cannot {verb} {}", self.value.describe()));
        self.value.as_number().ok_or_else(missing)
    }
}

/// The value of `left sign right`.
pub(crate) fn binary(sign: char, left: &Operand, right: &Operand) -> Result<Value, ExprError> {
    let verb = match sign {
        '+' => "add",
        '-' => "subtract",
        '*' => "multiply",
        '/' => "divide",
        _ => "take the power of",
    };
    let (a, b) = (left.number(verb)?, right.number(verb)?);
    let span = left.span.start..right.span.end;
    let result = match sign {
        '+' | '-' => {
            if !a.dimension.compatible(b.dimension) {
                return Err(mismatch(verb, a.dimension, b.dimension, span));
            }
            let value = if sign == '+' { a.value + b.value } else { a.value - b.value };
            // A plain number added to an angle makes an angle.
            let dimension = if a.dimension == Dimension::NONE { b.dimension } else { a.dimension };
            Quantity::new(value, dimension)
        }
        '*' => Quantity::new(a.value * b.value, a.dimension.times(b.dimension)),
        '/' if b.value == 0.0 => return Err(ExprError::new(right.span.clone(), "division by zero")),
        '/' => Quantity::new(a.value / b.value, a.dimension.over(b.dimension)),
        _ => power(a, b, left, right)?,
    };
    sound(result, span)
}

/// The value of `-operand`.
pub(crate) fn negated(operand: &Operand) -> Result<Value, ExprError> {
    let quantity = operand.number("negate")?;
    Ok(Quantity::new(-quantity.value, quantity.dimension).into())
}

fn power(a: Quantity, b: Quantity, base: &Operand, exponent: &Operand) -> Result<Quantity, ExprError> {
    if !b.dimension.is_none() {
        let message = format!("an exponent is a plain number, not one in {}", b.dimension);
        let help = "a unit belongs to the number before it; write (2^3) m";
        return Err(ExprError::new(exponent.span.clone(), message).help(help));
    }
    if a.value == 0.0 && b.value < 0.0 {
        return Err(ExprError::new(base.span.clone(), "division by zero: a negative power of zero"));
    }
    let whole = b.value.fract() == 0.0;
    if a.value < 0.0 && !whole {
        return Err(ExprError::new(base.span.clone(), "a negative number has whole powers only"));
    }
    let value = a.value.powf(b.value);
    if whole && b.value.abs() <= f64::from(i8::MAX) {
        return Ok(Quantity::new(value, a.dimension.power(b.value as i8)));
    }
    if a.dimension.is_none() {
        return Ok(Quantity::plain(value));
    }
    let message = format!("a quantity in {} has whole powers only, not {}", a.dimension, b.value);
    let error = ExprError::new(exponent.span.clone(), message);
    Err(if b.value == 0.5 { error.help("use sqrt()") } else { error.help("divide by a unit first") })
}

/// `cannot add W and s`, with the remedy where one is known.
pub(crate) fn mismatch(verb: &str, a: Dimension, b: Dimension, span: Range<usize>) -> ExprError {
    let error = ExprError::new(span, format!("cannot {verb} {a} and {b}"));
    let differ_in_cycles = [(a, b), (b, a)]
        .into_iter()
        .any(|(x, y)| x.cycles_to_radians().is_some_and(|(converted, _)| converted.compatible(y)));
    if differ_in_cycles {
        error.help("angular() makes rad/s of Hz, cycles() makes Hz of rad/s")
    } else if a.is_none() || b.is_none() {
        error.help("a number with a unit and one without do not mix; give both the same unit")
    } else {
        error.help("only quantities of the same kind can be put together")
    }
}

/// Refuses results that are no finite number, and dimensions beyond their range.
pub(crate) fn sound(quantity: Quantity, span: Range<usize>) -> Result<Value, ExprError> {
    if quantity.value.is_nan() {
        return Err(ExprError::new(span, "the result is not a number"));
    }
    if quantity.value.is_infinite() {
        return Err(ExprError::new(span, "the result is beyond the range of 64-bit floating point"));
    }
    if quantity.dimension.is_saturated() {
        return Err(ExprError::new(span, "the exponents of the unit are too large"));
    }
    Ok(quantity.into())
}
