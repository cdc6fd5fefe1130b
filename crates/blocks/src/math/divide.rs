use super::elements::at;
use blocksim_block::prelude::*;

/// Divides: $y = u_1 / u_2$, element by element.
///
/// The unit of the output is the quotient of the units. A division by zero stops the simulation, for nothing
/// sensible can follow from it.
///
/// ```ron
/// Divide
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("÷"))]
pub struct Divide;

impl Block for Divide {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let [above, below] = ["u1", "u2"].map(|name| given.input_or_unknown(name).dimension);
        let y = PortType {
            kind: Kind::Real,
            shape: given.common_shape(&["u1", "u2"], &[])?,
            dimension: above.zip(below).map(|(above, below)| above.over(below)),
        };
        Ok(Interface::new()
            .input(Input::real("u1").doc("What is divided."))
            .input(Input::real("u2").doc("What it is divided by; not zero."))
            .output(Output::like("y", y)))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| l.element(0, i) / l.element(1, i));
        true
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        let (above, below) = (c.input(0), c.input(1));
        let i = (0..above.len().max(below.len())).find(|i| at(below, *i) == 0.0)?;
        Some(format!(
            "division by zero: u1 = {}, u2 = {}: keep `u2` away from zero, as with a Switch before it",
            at(above, i),
            at(below, i)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_first_input_is_divided_by_the_second() {
        let inputs = vec![("u1".to_owned(), PortType::scalar()), ("u2".to_owned(), PortType::vector(2))];
        let mut bench = Bench::with_inputs(Divide, inputs);
        assert_eq!(bench.set(0, &[6.0]).set(1, &[3.0, -0.5]).major(), [2.0, -12.0]);
        assert!(bench.set(0, &[f64::NAN]).major()[0].is_nan());
    }

    #[test]
    #[should_panic(expected = "division by zero: u1 = 6, u2 = 0")]
    fn a_division_by_zero_stops_with_the_values() {
        Bench::new(Divide).set(0, &[6.0]).major();
    }

    #[test]
    fn units_are_divided() {
        let unit = |given: &Given| Divide.interface(given).unwrap().outputs[0].port_type.dimension;
        assert_eq!(unit(&given(&[("u1", "V"), ("u2", "A")], &[])), Some(dimension("Ohm")));
        assert_eq!(unit(&given(&[("u2", "A")], &[])), None);
    }
}
