//! Values as they are written on the command line.

use blocksim_signal::{Lookup, Noted, Quantity, Scope, Unit, evaluate_noted};

use crate::running::tuning::When;

/// Where runs are kept unless somebody says otherwise.
pub const RUNS: &str = "runs";

/// No names: only numbers and units make sense on the command line.
pub struct NoNames;

impl Scope for NoNames {
    fn lookup(&self, _name: &str) -> Lookup {
        Lookup::Unknown
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A time above zero, s.
///
/// # Errors
/// What is wrong with it.
pub fn time(text: &str) -> Result<f64, String> {
    match moment(text)? {
        seconds if seconds > 0.0 => Ok(seconds),
        _ => Err("a time here is above zero".to_owned()),
    }
}

/// An instant, s.
pub fn moment(text: &str) -> Result<f64, String> {
    let quantity = quantity(text, "a time is a number, such as 10s or 250ms")?;
    let is_time = Unit::parse("s").is_ok_and(|second| quantity.dimension == second.dimension);
    match quantity.value {
        _ if !is_time && !quantity.dimension.is_none() => Err("a time has a unit such as s or ms".to_owned()),
        seconds if seconds.is_finite() => Ok(seconds),
        _ => Err("a time is finite".to_owned()),
    }
}

/// A number with or without a unit; `otherwise` tells what else is wrong.
pub fn quantity(text: &str, otherwise: &str) -> Result<Quantity, String> {
    noted(text, otherwise)?.value.as_number().ok_or_else(|| otherwise.to_owned())
}

/// A difference, to which the zero of a scale does not apply: `0.5 degC` is 0.5 K.
pub fn difference(text: &str, otherwise: &str) -> Result<Quantity, String> {
    let noted = noted(text, otherwise)?;
    // Such a unit stands in whole literals alone: the number without its unit is in that unit.
    let Some(unit) = noted.units.iter().find(|unit| unit.offset != 0.0) else {
        return noted.value.as_number().ok_or_else(|| otherwise.to_owned());
    };
    let written: String = text.chars().filter(|sign| !sign.is_whitespace()).collect();
    let plain = quantity(&written.replacen(&unit.text, &Unit::si(unit.dimension).text, 1), otherwise)?;
    Ok(Quantity { value: plain.value * unit.scale, ..plain })
}

fn noted(text: &str, otherwise: &str) -> Result<Noted, String> {
    evaluate_noted(text, &NoNames).map_err(|error| match error.help {
        // Nobody has names in mind here.
        _ if error.message.starts_with("unknown name") => otherwise.to_owned(),
        Some(help) => format!("{}; {help}", error.message),
        None => error.message,
    })
}

/// Times real time; 0 for as fast as it can.
///
/// # Errors
/// What is wrong with it.
pub fn speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed: &f64| speed.is_finite() && *speed >= 0.0);
    speed.ok_or_else(|| "a speed is a number of times real time, or 0".to_owned())
}

/// A number above zero.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("a number above zero, such as 1e-6".to_owned()),
    }
}

/// `target=value` with something on both sides.
pub fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((target, value)) if !target.trim().is_empty() && !value.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write target=value, such as drive=dc or pid.kp=40".to_owned()),
    }
}

/// `time:target=value`.
///
/// # Errors
/// What is wrong with it.
pub fn change(text: &str) -> Result<(When, String), String> {
    let (at, set) = text.split_once(':').ok_or("write time:target=value, such as 0.5s:pid.kp=12")?;
    let after = at.trim_start().strip_prefix("after ");
    let t = moment(after.unwrap_or(at))?;
    if t < 0.0 {
        return Err("a parameter changes at a time from 0 on".to_owned());
    }
    let when = if after.is_some() { When::After(t) } else { When::At(t) };
    Ok((when, assignment(set.trim())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units_or_are_seconds() {
        assert_eq!(time("10"), Ok(10.0));
        assert_eq!(time("10s"), Ok(10.0));
        assert_eq!(time("250 ms"), Ok(0.25));
        assert_eq!(time("2*1.5 s"), Ok(3.0));
        for wrong in ["3 m", "0", "-1 s", "1/0", "soon", "[1, 2]", ""] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_assignment_has_two_sides() {
        assert!(assignment("pid.kp=40").is_ok());
        assert!(assignment("a=b=c").is_ok(), "the value may be an expression");
        for wrong in ["kp", "=4", "kp=", " = "] {
            assert!(assignment(wrong).is_err(), "{wrong}");
        }
    }
}
