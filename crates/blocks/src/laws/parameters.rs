//! The parameters of a law: names with values of any unit.

use std::collections::BTreeMap;

use blocksim_block::{ParamError, ParamValue, finite};
use blocksim_signal::{Dimension, Function, Value, closest};

/// Names with their values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LawParameters<'p>(pub &'p BTreeMap<String, ParamValue>);

impl<'p> LawParameters<'p> {
    /// Whether each is a number or a truth value of a name that a law can use.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(self) -> Result<(), ParamError> {
        for (name, ParamValue(value)) in self.0 {
            name_fits("parameters", name)?;
            match value {
                Value::Bool(_) => {}
                value => match value.as_number() {
                    Some(quantity) => finite(name, quantity.value)
                        .map_err(|error| ParamError { param: format!("parameters.{name}"), ..error })?,
                    None => {
                        let message = format!("`{name}` is {}, but must be a number", value.describe());
                        return Err(ParamError::new(format!("parameters.{name}"), message)
                            .help("a law computes with numbers and truth values"));
                    }
                },
            }
        }
        Ok(())
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

    /// Whether all are among the names that the law uses.
    ///
    /// # Errors
    /// The first that is not, with the name that may be meant.
    pub fn are_used(self, used: &[&str]) -> Result<(), ParamError> {
        let Some(unused) = self.names().into_iter().find(|name| !used.contains(name)) else { return Ok(()) };
        let others: Vec<&str> = used.iter().copied().filter(|name| !self.0.contains_key(*name)).collect();
        let error = ParamError::new("parameters", format!("the law does not use its parameter `{unused}`"));
        Err(match closest(unused, others) {
            Some(near) => error.help(format!("is `{near}` in the law meant to be `{unused}`?")),
            None => error.help("use it in the law, or remove it"),
        })
    }
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
