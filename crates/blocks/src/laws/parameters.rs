//! The parameters of a law: names with values of any unit.

use std::collections::BTreeMap;

use blocksim_block::{ParamError, ParamErrors, ParamValue};
use blocksim_signal::{Dimension, Function, Value, closest};

/// Names with their values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LawParameters<'p>(pub &'p BTreeMap<String, ParamValue>);

impl<'p> LawParameters<'p> {
    /// Reports names that a law cannot use, and values that are neither numbers nor truth values.
    pub fn validate(self, errors: &mut ParamErrors) {
        for (name, ParamValue(value)) in self.0 {
            errors.take(name_fits("parameters", name));
            if value.as_bool().is_none() {
                number_named(("parameters", name), value, "must be a number", errors);
            }
        }
    }

    /// The names.
    pub fn names(self) -> Vec<&'p str> {
        self.0.keys().map(String::as_str).collect()
    }

    /// A number, SI.
    pub fn number(self, name: &str) -> Option<f64> {
        Some(self.0.get(name)?.0.as_number()?.value)
    }

    /// A truth value.
    pub fn truth(self, name: &str) -> Option<bool> {
        self.0.get(name)?.0.as_bool()
    }

    /// The dimension of a parameter: open for one that has no unit.
    pub fn dimension(self, name: &str) -> Option<Dimension> {
        let dimension = self.0.get(name)?.0.as_number()?.dimension;
        Some(if dimension == Dimension::NONE { Dimension::OPEN } else { dimension })
    }

    /// Reports those that are not among the names that the law uses, with the name that may be meant.
    pub fn are_used(self, used: &[&str], errors: &mut ParamErrors) {
        for unused in self.names().into_iter().filter(|name| !used.contains(name)) {
            let others: Vec<&str> = used.iter().copied().filter(|name| !self.0.contains_key(*name)).collect();
            let message = format!("the law does not use its parameter `{unused}`");
            let error = ParamError::new(format!("parameters.{unused}"), message);
            errors.add(match closest(unused, others) {
                Some(near) => error.help(format!("is `{near}` in the law meant to be `{unused}`?")),
                None => error.help("use it in the law, or remove it"),
            });
        }
    }
}

/// Reports a value of a set that is not a finite number.
pub(crate) fn number_named((set, name): (&str, &str), value: &Value, demand: &str, errors: &mut ParamErrors) {
    let message = match value.as_number() {
        Some(quantity) if quantity.value.is_finite() => return,
        Some(quantity) => format!("`{name}` is {}, but must be finite", quantity.value),
        None => format!("`{name}` is {}, but {demand}", value.describe()),
    };
    let error = ParamError::new(format!("{set}.{name}"), message);
    errors.add(error.help("a law computes with numbers and truth values"));
}

/// Whether a law can use a name.
///
/// # Errors
/// It is not made of letters, digits and `_`, or means something already.
pub(crate) fn name_fits(param: &str, name: &str) -> Result<(), ParamError> {
    let mut letters = name.chars();
    let fits = letters.next().is_some_and(|first| first.is_ascii_alphabetic())
        && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if !fits {
        return Err(ParamError::new(param, format!("`{name}` is not a valid name"))
            .help("a name begins with a letter; letters, digits and _ follow"));
    }
    if ["pi", "true", "false"].contains(&name) || Function::is_name(name) {
        return Err(ParamError::new(param, format!("`{name}` has a meaning of its own in a law"))
            .help(format!("choose another name, such as {name}_0")));
    }
    Ok(())
}
