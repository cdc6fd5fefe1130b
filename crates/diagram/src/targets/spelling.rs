//! How a value from the command line is written into a text.

use blocksim_signal::{Dimension, Lookup, Scope, Unit, Value, evaluate_noted};

use super::Target;
use crate::replacing::{WrittenUnit, in_unit};
use blocksim_syntax::{Shape, SyntaxError, read};

/// How a value is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spelling {
    /// Numbers, lists and sets as they are, anything else between quotes: `"2 m"`, `"2 * kp"`.
    Expression,
    /// Between quotes: a text.
    Text,
    /// Words as they are: `Clamping`.
    Word,
}

/// A value of the command line as it stands in the text. A bare number gets the unit in which the one before is written.
///
/// # Errors
/// A number without a unit, where it is not clear in which unit the one before is written; a unit of another dimension: what
/// is wrong, and what to do.
pub fn spelled(target: &Target, value: &str) -> Result<String, (String, String)> {
    let value = value.trim();
    let quoted = |value: &str| format!("\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\""));
    let shape = read(value).map(|node| node.value);
    if target.spelling == Spelling::Text {
        return Ok(if matches!(shape, Ok(Shape::Text(_))) { value.to_owned() } else { quoted(value) });
    }
    if let Some(expression) = expression(&shape, value)
        && let Some(text) = replacing(target, expression)?
    {
        return Ok(quoted(&text));
    }
    match shape {
        Ok(Shape::Word(_)) if target.spelling == Spelling::Word => Ok(value.to_owned()),
        Ok(Shape::Word(_)) | Err(_) => Ok(quoted(value)),
        _ => Ok(value.to_owned()),
    }
}

/// The text of a number or an expression.
fn expression<'v>(shape: &'v Result<Shape, SyntaxError>, value: &'v str) -> Option<&'v str> {
    match shape {
        Ok(Shape::Text(text)) => Some(text),
        Ok(Shape::Number(_) | Shape::Word(_)) | Err(_) => Some(value),
        Ok(_) => None,
    }
}

/// The text with the unit that it lacks; `None` if it stays as it is.
fn replacing(target: &Target, text: &str) -> Result<Option<String>, (String, String)> {
    let Some(Value::Number(old)) = &target.value else { return Ok(None) };
    // What names parameters is judged where they are known.
    let Ok(new) = evaluate_noted(text, &NoNames) else { return Ok(None) };
    let Value::Number(number) = new.value else { return Ok(None) };
    let before = target.written.trim_matches('"');
    let unit = match &target.written_unit {
        WrittenUnit::One(unit) => unit.clone(),
        WrittenUnit::Decibels if !new.is_bare => return Ok(None),
        WrittenUnit::Decibels => return Ok(Some(in_unit(number.value, "dB"))),
        WrittenUnit::Si if old.dimension == Dimension::NONE => return Ok(None),
        WrittenUnit::Si => Unit::si(old.dimension),
        WrittenUnit::Unclear if new.is_bare => {
            return Err((
                format!("`{}` is {before} and has a unit, {text} has none", target.name),
                format!("write the unit, such as \"{}\"", in_unit(number.value, &old.dimension.to_string())),
            ));
        }
        WrittenUnit::Unclear => Unit::si(old.dimension),
    };
    if !new.is_bare {
        return match old.dimension.takes(number.dimension) {
            true => Ok(None),
            false => Err((
                format!(
                    "`{}` is {before}, {text} is not in {} or a unit of the same kind",
                    target.name, unit.text
                ),
                format!("write a value in {} or a unit of the same kind", unit.text),
            )),
        };
    }
    let is_literal = text.parse::<f64>().is_ok();
    let whole = if is_literal { text.to_owned() } else { format!("({text})") };
    Ok(Some(match is_literal || unit.offset == 0.0 {
        true => format!("{whole} {}", unit.text),
        false => in_unit(number.value, &unit.text),
    }))
}

/// Sees no parameters.
struct NoNames;

impl Scope for NoNames {
    fn lookup(&self, _: &str) -> Lookup {
        Lookup::Unknown
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}
