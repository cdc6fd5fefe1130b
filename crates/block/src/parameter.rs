//! Checks of parameters, and parameters of any type.

use std::cell::Cell;
use std::ops::Range;

use serde::Deserialize;

use blocksim_signal::{Dimension, Quantity, Value};

/// A parameter does not make sense.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParamError {
    /// Which one; a path such as `axes[2].upper` may follow the name.
    pub param: String,
    /// What is wrong, with the value.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// The bytes of a text in it that are wrong, where the parameter is a text.
    pub span: Option<Range<usize>>,
    /// Other parameters that take part in it: each may be the one to change.
    pub beside: Vec<String>,
}

impl ParamError {
    /// An error without advice.
    pub fn new(param: impl Into<String>, message: impl Into<String>) -> Self {
        Self { param: param.into(), message: message.into(), help: None, span: None, beside: Vec::new() }
    }

    /// The same with advice.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The same about other parameters, too. Where one of them is wrong in itself, that is the cause.
    pub fn beside(self, others: &[&str]) -> Self {
        Self { beside: others.iter().map(ToString::to_string).collect(), ..self }
    }

    /// The same about these bytes of the text that the parameter is.
    pub fn within(self, span: Range<usize>) -> Self {
        Self { span: Some(span), ..self }
    }
}

/// `value` must be a number, not NaN and not infinite.
///
/// # Errors
/// It is not.
pub fn finite(param: &str, value: f64) -> Result<(), ParamError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(ParamError::new(param, format!("`{param}` is {value}, but must be finite")))
}

/// `value` must be finite and greater than zero.
///
/// # Errors
/// It is not.
pub fn positive(param: &str, value: f64) -> Result<(), ParamError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(ParamError::new(param, format!("`{param}` is {value}, but must be positive"))
        .help("write a number above 0"))
}

/// `value` must be finite and at least zero.
///
/// # Errors
/// It is not.
pub fn not_negative(param: &str, value: f64) -> Result<(), ParamError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(ParamError::new(param, format!("`{param}` is {value}, but must not be negative"))
        .help("write 0 or more; signs and directions come from connections and signals"))
}

/// `value` must be at least `least`.
///
/// # Errors
/// It is not.
pub fn at_least(param: &str, value: f64, least: f64) -> Result<(), ParamError> {
    if value >= least {
        return Ok(());
    }
    Err(ParamError::new(param, format!("`{param}` is {value}, but must be at least {least}")))
}

/// Most ports that a number of a block may ask for. Whoever has more signals passes vectors.
pub const MOST_PORTS: usize = 10_000;

/// A number of things must be from `least` to `most`, so that no slip of the pen fills the memory.
///
/// # Errors
/// It is not.
pub fn count(param: &str, value: usize, least: usize, most: usize) -> Result<(), ParamError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(ParamError::new(param, format!("`{param}` is {value}, but must be from {least} to {most}")))
}

/// `lower` must be less than `upper`.
///
/// # Errors
/// It is not; the error names the upper one.
pub fn ordered(lower_name: &str, lower: f64, upper_name: &str, upper: f64) -> Result<(), ParamError> {
    if lower < upper {
        return Ok(());
    }
    Err(ParamError::new(
        upper_name,
        format!("`{upper_name}` ({upper}) must be greater than `{lower_name}` ({lower})"),
    )
    .help(format!("swap `{lower_name}` and `{upper_name}`?")))
}

/// A parameter of any type: number with unit, truth value, text, list or set. In a diagram a string is an
/// expression here, and `Text("abc")` a text.
#[derive(Debug, Clone, PartialEq)]
pub struct ParamValue(pub Value);

/// Name under which a [`ParamValue`] asks its deserializer for a value of any type.
pub const VALUE_ENUM: &str = "$blocksim::Value";

thread_local! {
    static HANDED: Cell<Option<Value>> = const { Cell::new(None) };
}

/// Gives a value to the [`ParamValue`] that is asking for one. It goes past the type-erased deserializer: taken apart and put
/// together again, number by number, a robot in a parameter would take longer than all the rest of a diagram.
pub fn hand_over(value: Value) {
    HANDED.set(Some(value));
}

impl<'de> Deserialize<'de> for ParamValue {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "$blocksim::Value")]
        enum Wire {
            Handed,
            // As other formats write it.
            Number(f64, Vec<i8>),
            Bool(bool),
            Text(String),
            List(Vec<ParamValue>),
            Set(Vec<(String, ParamValue)>),
        }
        let value = match Wire::deserialize(deserializer)? {
            Wire::Handed => {
                let missing = || serde::de::Error::custom("only a diagram hands a value over");
                HANDED.take().ok_or_else(missing)?
            }
            Wire::Number(value, powers) => {
                let mut exponents = [0; 9];
                exponents.iter_mut().zip(powers).for_each(|(to, from)| *to = from);
                Value::Number(Quantity { value, dimension: Dimension::of(exponents) })
            }
            Wire::Bool(value) => Value::Bool(value),
            Wire::Text(text) => Value::Text(text),
            Wire::List(items) => Value::List(items.into_iter().map(|item| item.0).collect()),
            Wire::Set(items) => Value::Set(items.into_iter().map(|(name, item)| (name, item.0)).collect()),
        };
        Ok(ParamValue(value))
    }
}
