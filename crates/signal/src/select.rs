//! Members of sets and items of lists.

use crate::arithmetic::Operand;
use crate::{ExprError, Value, closest, surely};
use std::ops::Range;

/// The member `name` of a set; `span` is the place of the name.
pub(crate) fn member(from: Operand, name: &str, span: Range<usize>) -> Result<Value, ExprError> {
    let Value::Set(members) = from.value else {
        let message = format!("{} has no member `{name}`", from.value.describe());
        let error = ExprError::new(span, message);
        return Err(match from.value {
            Value::List(_) => error.help("items of a list are selected by index, as in list[0]"),
            _ => error.help("only a set of parameters has members"),
        });
    };
    if let Some((_, value)) = members.iter().find(|(key, _)| key == name) {
        return Ok(value.clone());
    }
    let names: Vec<&str> = members.iter().map(|(key, _)| key.as_str()).collect();
    let error = ExprError::new(span, format!("no member `{name}`"))
        .remedy(surely(name, names.iter().copied()).map(str::to_owned));
    Err(match closest(name, names.iter().copied()) {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None if names.is_empty() => error.help("the set is empty"),
        None => error.help(format!("the members are: {}", some_of(&names))),
    })
}

/// The item of a list, counted from 0.
pub(crate) fn item(from: Operand, index: &Operand) -> Result<Value, ExprError> {
    let Value::List(items) = from.value else {
        let message = format!("{} has no items", from.value.describe());
        let error = ExprError::new(index.span.clone(), message);
        return Err(match from.value {
            Value::Number(_) => {
                error.help("a unit in brackets stands right behind a number, as in 9.81 [m/s^2]")
            }
            _ => error.help("only a list is selected from by index"),
        });
    };
    let quantity = index.number("count items by")?;
    let number = quantity.value.round();
    if !quantity.dimension.is_none() || (quantity.value - number).abs() > NEARLY_WHOLE {
        let message = format!("an index is a whole number, not {}", quantity.display());
        return Err(ExprError::new(index.span.clone(), message));
    }
    if number >= 0.0 && number < items.len() as f64 {
        return Ok(items[number as usize].clone());
    }
    let error = ExprError::new(index.span.clone(), format!("index {number} is out of range"));
    Err(match items.len() {
        0 => error.help("the list is empty"),
        1 => error.help("the list has one item; its index is 0"),
        n => error.help(format!("the list has {n} items, counted from 0 to {}", n - 1)),
    })
}

/// An index may come from a division; 2.9999999999999996 is 3.
const NEARLY_WHOLE: f64 = 1e-9;

/// The names in a row, cut after a dozen.
pub(crate) fn some_of<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<&str> = names.iter().take(12).map(AsRef::as_ref).collect();
    let more = if names.len() > shown.len() { ", ..." } else { "" };
    format!("{}{more}", shown.join(", "))
}
