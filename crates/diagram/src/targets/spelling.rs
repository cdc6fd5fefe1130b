//! How a value from the command line is written into a text.

use blocksim_signal::Value;

use super::Target;
use crate::tree::{Shape, read};

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

/// A value of the command line as it stands in the text.
///
/// # Errors
/// A number without a unit, where the one before had a unit: what is wrong, and what to do.
pub fn spelled(target: &Target, value: &str) -> Result<String, (String, String)> {
    let value = value.trim();
    let quoted = || format!("\"{}\"", value.replace('\\', "\\\\").replace('"', "\\\""));
    let shape = read(value).map(|node| node.value);
    if target.spelling == Spelling::Text {
        return Ok(if matches!(shape, Ok(Shape::Text(_))) { value.to_owned() } else { quoted() });
    }
    let unit = match &target.value {
        Some(Value::Number(old)) if !old.dimension.is_none() => written_unit(&target.written),
        _ => None,
    };
    match (shape, unit) {
        (Ok(Shape::Number(_)), Some(unit)) => Err((
            format!(
                "`{}` is {} and has a unit, {value} has none",
                target.name,
                target.written.trim_matches('"')
            ),
            format!("write the unit, such as \"{value} {unit}\""),
        )),
        (Ok(Shape::Word(_)), _) if target.spelling == Spelling::Word => Ok(value.to_owned()),
        (Ok(Shape::Word(_)) | Err(_), _) => Ok(quoted()),
        _ => Ok(value.to_owned()),
    }
}

/// The unit behind a number between quotes.
fn written_unit(written: &str) -> Option<&str> {
    let inside = written.strip_prefix('"')?.strip_suffix('"')?;
    let end = inside.rfind(|c: char| c.is_ascii_digit() || c == ')' || c == ' ').map_or(0, |at| at + 1);
    let start = inside.find(' ').filter(|at| inside[..*at].parse::<f64>().is_ok()).map_or(end, |at| at + 1);
    inside.get(start..).map(str::trim).filter(|unit| !unit.is_empty())
}
