//! Units where time comes in, and units of parameters that must agree with those of signals.

use blocksim_block::prelude::*;

/// Dimension of time.
pub(crate) const SECOND: Dimension = Dimension::of([0, 0, 1, 0, 0, 0, 0, 0, 0]);

/// Checks that a parameter written with a unit agrees with the signal it belongs to. A bare number, or a signal
/// of unknown unit, always agrees.
///
/// # Errors
/// They differ; `port` is the input to blame.
pub(crate) fn agrees(
    given: &Given,
    parameter: &str,
    port: &str,
    expected: Option<Dimension>,
) -> Result<(), InterfaceError> {
    agrees_as_written(given.parameters.find(parameter), parameter, port, expected)
}

/// The same of a parameter that was written with this unit, if with any.
///
/// # Errors
/// They differ.
pub(crate) fn agrees_as_written(
    written: Option<Dimension>,
    parameter: &str,
    port: &str,
    expected: Option<Dimension>,
) -> Result<(), InterfaceError> {
    let (Some(written), Some(expected)) = (written, expected) else {
        return Ok(());
    };
    if written.is_none() || written.compatible(expected) {
        return Ok(());
    }
    let message = format!("`{parameter}` is in {written}, but {expected} is needed here");
    Err(InterfaceError::units(&[port], message)
        .help(format!("correct the unit of `{parameter}`, or scale the signal at `{port}`")))
}

/// Element `i` of a signal; a scalar stands for all elements.
#[inline]
pub(crate) fn element(values: &[f64], i: usize) -> f64 {
    if values.len() == 1 { values[0] } else { values[i] }
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;
    use blocksim_block::ParamUnits;
    use blocksim_signal::Unit;

    /// What a block says when its inputs bear these units and its parameters were written in those.
    pub(crate) fn interface_with(
        block: &impl Block,
        inputs: &[(&str, &str)],
        parameters: &[(&str, &str)],
    ) -> Result<Interface, InterfaceError> {
        let dimension = |unit: &str| Unit::parse(unit).expect("a unit").dimension;
        let mut units = ParamUnits::default();
        for (name, unit) in parameters {
            units.insert(name, dimension(unit));
        }
        let port =
            |(name, unit): &(&str, &str)| (name.to_string(), PortType::scalar().of(Some(dimension(unit))));
        block.interface(&Given::new(inputs.iter().map(port).collect(), units))
    }

    /// The unit of the first output, as text.
    pub(crate) fn output_unit(
        block: &impl Block,
        inputs: &[(&str, &str)],
        parameters: &[(&str, &str)],
    ) -> String {
        let interface = interface_with(block, inputs, parameters).expect("an interface");
        interface.outputs[0].port_type.dimension.map_or("unknown".to_owned(), |d| d.to_string())
    }

    /// A vector of `n` without unit.
    pub(crate) fn vector(name: &str, n: usize) -> Vec<(String, PortType)> {
        vec![(name.to_owned(), PortType::vector(n))]
    }
}
