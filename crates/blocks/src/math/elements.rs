//! What blocks share that work element by element: names of inputs, elements, guards, units of parameters.

use blocksim_block::event::Change;
use blocksim_block::{Given, InterfaceError};
use blocksim_signal::Dimension;

/// The dimension of a time, s.
pub(crate) const TIME: Dimension = Dimension::of([0, 0, 1, 0, 0, 0, 0, 0, 0]);

/// Names of `n` inputs: `u`, or `u1`, `u2`, ...
pub(crate) fn input_names(n: usize) -> Vec<String> {
    numbered("u", n)
}

/// A name for one, names with a number from 1 for several.
pub(crate) fn numbered(name: &str, n: usize) -> Vec<String> {
    if n == 1 { vec![name.to_owned()] } else { (1..=n).map(|i| format!("{name}{i}")).collect() }
}

/// Borrowed names, as [`Given`] asks for them.
pub(crate) fn borrowed(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

/// Element `i` of a signal; a scalar stands for every element.
#[inline]
pub(crate) fn at(values: &[f64], i: usize) -> f64 {
    if let [value] = values { *value } else { values[i] }
}

/// `u` between the limits; NaN stays NaN.
#[inline]
pub(crate) fn clamp(u: f64, lower: f64, upper: f64) -> f64 {
    if u > upper {
        upper
    } else if u < lower {
        lower
    } else {
        u
    }
}

/// Differences of numbers below this part of their sizes are rounding.
pub(crate) const ROUNDING: f64 = 1e-14;

/// What two-point switches are called when they change.
pub(crate) const ON_OFF: &[Change] = &[Change::to(1.0, "switches on"), Change::to(0.0, "switches off")];

/// The dimension of a signal to which parameters are compared: `dimension`, or that of the parameters if it is
/// unknown. A parameter written as a plain number takes the unit of the signal.
///
/// # Errors
/// A parameter of another dimension; the error names it and `port`.
pub(crate) fn parameters_like(
    given: &Given,
    port: &str,
    dimension: Option<Dimension>,
    parameters: &[&str],
) -> Result<Option<Dimension>, InterfaceError> {
    let mut common = dimension;
    for name in parameters {
        let written = given.parameters.get(name);
        if written.is_open() || written == Dimension::NONE {
            continue;
        }
        match common {
            Some(known) if !known.compatible(written) => {
                return Err(InterfaceError::units(
                    &[port],
                    format!("`{name}` is in {written}, but must be in {known} to fit `{port}`"),
                )
                .help(format!("write `{name}` in {known}, or as a plain number")));
            }
            Some(_) => {}
            None => common = Some(written),
        }
    }
    Ok(common)
}

/// The dimension that parameters have in common which make up the output `y`. Plain numbers have none; zero fits
/// every unit.
///
/// # Errors
/// Two parameters of different dimensions.
pub(crate) fn common_unit(given: &Given, parameters: &[(&str, f64)]) -> Result<Dimension, InterfaceError> {
    let unit = |name: &str| given.parameters.get(name);
    let is_said = |name: &str| !unit(name).is_open() && unit(name) != Dimension::NONE;
    let Some((first, _)) = parameters.iter().find(|(name, _)| is_said(name)) else {
        let open = parameters.iter().any(|(name, _)| unit(name).is_open());
        return Ok(if open { Dimension::OPEN } else { Dimension::NONE });
    };
    let common = unit(first);
    for (name, value) in parameters {
        let dimension = unit(name);
        let plain_zero = *value == 0.0 && dimension == Dimension::NONE;
        if !plain_zero && !dimension.compatible(common) {
            return Err(InterfaceError::units(
                &["y"],
                format!("`{name}` is in {dimension}, but `{first}` is in {common}"),
            )
            .help(format!("write `{name}` in {common}")));
        }
    }
    Ok(common)
}

/// The dimension of a unit in tests.
#[cfg(test)]
pub(crate) fn dimension(unit: &str) -> Dimension {
    blocksim_signal::Unit::parse(unit).expect("a unit").dimension
}

/// Inputs and units of parameters in tests: `("u", "V")` is a real scalar in V.
#[cfg(test)]
pub(crate) fn given(inputs: &[(&str, &str)], parameters: &[(&str, &str)]) -> Given {
    use blocksim_block::{ParamUnits, PortType};
    let mut units = ParamUnits::default();
    parameters.iter().for_each(|(name, unit)| units.insert(name, dimension(unit)));
    let scalar = |unit| PortType::scalar().of(Some(dimension(unit)));
    Given::new(inputs.iter().map(|(name, unit)| (name.to_string(), scalar(unit))).collect(), units)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dimension_of_time_is_the_second() {
        assert_eq!(TIME, dimension("s"));
    }

    #[test]
    fn one_input_is_called_u_and_several_bear_numbers() {
        assert_eq!(input_names(1), ["u"]);
        assert_eq!(input_names(3), ["u1", "u2", "u3"]);
    }

    #[test]
    fn plain_parameters_take_the_unit_of_the_signal_and_others_must_fit() {
        let volt = Some(dimension("V"));
        assert_eq!(parameters_like(&given(&[], &[]), "u", volt, &["upper"]), Ok(volt));
        assert_eq!(parameters_like(&given(&[], &[("upper", "kV")]), "u", None, &["upper"]), Ok(volt));
        let error = parameters_like(&given(&[], &[("upper", "A")]), "u", volt, &["upper"]).unwrap_err();
        assert_eq!(
            (error.code, error.message.as_str()),
            ("unit_mismatch", "`upper` is in A, but must be in V to fit `u`")
        );
    }

    #[test]
    fn zero_fits_every_unit_but_one_does_not() {
        let volt = dimension("V");
        let units = given(&[], &[("after", "V")]);
        assert_eq!(common_unit(&units, &[("before", 0.0), ("after", 12.0)]), Ok(volt));
        let error = common_unit(&units, &[("before", 1.0), ("after", 12.0)]).unwrap_err();
        assert_eq!(error.message, "`before` is in 1, but `after` is in V");
    }

    #[test]
    fn a_number_that_is_none_passes_a_clamp() {
        assert!(clamp(f64::NAN, -1.0, 1.0).is_nan());
        assert_eq!([clamp(2.0, -1.0, 1.0), clamp(-2.0, -1.0, 1.0), clamp(1.0, -1.0, 1.0)], [1.0, -1.0, 1.0]);
    }
}
