//! From the values in the diagram to the numbers that the plug-in sees.

use std::collections::BTreeMap;

use blocksim_block::{LoadError, ParamValue};
use blocksim_signal::Value;

use crate::fault::{help, meant, parameter};
use crate::kind::{Kind, Quantity};

/// All parameters of `kind` in SI, one after the other; defaults where nothing is given.
///
/// # Errors
/// An unknown or missing parameter, no number, a list of wrong length, a wrong unit.
pub fn numbers(kind: &Kind, given: &BTreeMap<String, ParamValue>) -> Result<Vec<f64>, LoadError> {
    let names = || kind.parameters.iter().map(|parameter| parameter.name);
    if let Some(unknown) = given.keys().find(|name| !names().any(|known| known == name.as_str())) {
        let error = parameter(format!("`{}` has no parameter `{unknown}`", kind.name));
        return Err(help(error, meant(unknown, "parameters", names())));
    }
    let mut numbers = Vec::new();
    for parameter in &kind.parameters {
        match (given.get(parameter.name), parameter.default) {
            (Some(ParamValue(value)), _) => append(&mut numbers, parameter, value)?,
            (None, Some(default)) => numbers.extend_from_slice(default),
            (None, None) => return Err(missing(kind, parameter)),
        }
    }
    Ok(numbers)
}

fn missing(kind: &Kind, quantity: &Quantity) -> LoadError {
    let error = parameter(format!("`{}` needs the parameter `{}`", kind.name, quantity.name));
    let unit =
        if matches!(quantity.unit, "" | "1") { String::new() } else { format!(" in {}", quantity.unit) };
    let doc = if quantity.doc.is_empty() { String::new() } else { format!(": {}", quantity.doc) };
    help(error, format!("give {}{unit}{doc}", form(quantity)))
}

fn append(numbers: &mut Vec<f64>, quantity: &Quantity, value: &Value) -> Result<(), LoadError> {
    match value {
        Value::Number(_) if quantity.length == 1 => numbers.push(number(quantity, quantity.name, value)?),
        Value::List(items) if quantity.length > 1 && items.len() == quantity.length => {
            for (i, item) in items.iter().enumerate() {
                numbers.push(number(quantity, &format!("{}[{i}]", quantity.name), item)?);
            }
        }
        _ => return Err(wrong_form(quantity.name, value, &form(quantity))),
    }
    Ok(())
}

/// One number; without a unit it is SI.
fn number(quantity: &Quantity, name: &str, value: &Value) -> Result<f64, LoadError> {
    let number = value.as_number().ok_or_else(|| wrong_form(name, value, "a number"))?;
    match quantity.dimension {
        Some(wanted) if !number.dimension.is_none() && !number.dimension.compatible(wanted) => {
            Err(match quantity.unit {
                "1" => parameter(format!("`{name}` is {number}, but must be a number without unit")),
                unit => help(
                    parameter(format!("`{name}` is {number}, but must be in {unit}")),
                    format!("a number without a unit is taken to be in {unit}"),
                ),
            })
        }
        _ => Ok(number.value),
    }
}

fn wrong_form(name: &str, value: &Value, wanted: &str) -> LoadError {
    let error = parameter(format!("`{name}` is {}, but must be {wanted}", value.describe()));
    match value {
        Value::Text(_) => help(error, "write the number itself, or an expression such as \"20 1/s\""),
        _ => error,
    }
}

fn form(quantity: &Quantity) -> String {
    if quantity.length == 1 {
        "a number".to_owned()
    } else {
        format!("a list of {} numbers", quantity.length)
    }
}
