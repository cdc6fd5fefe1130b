use super::function::root;
use blocksim_block::prelude::*;

/// A constant power of each element: $y = u^n$.
///
/// A unit allows whole exponents and halves of them: the unit of the output is the power of the unit. Where the
/// power is not defined (a negative number to a broken exponent, zero to a negative one) the simulation stops.
///
/// ```ron
/// Power(exponent: 1.5)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("uᵃ"))]
pub struct Power {
    /// Exponent $n$.
    #[block(unit = "1", finite)]
    pub exponent: f64,
}

impl Power {
    fn dimension(&self, u: Dimension) -> Result<Dimension, InterfaceError> {
        if u.is_none() {
            return Ok(Dimension::NONE);
        }
        let halves = 2.0 * self.exponent;
        if halves.fract() != 0.0 || halves.abs() > 60.0 {
            return Err(InterfaceError::units(
                &["u"],
                format!("`u` is in {u}, of which there is no power {}", self.exponent),
            )
            .help("divide by a reference value first, so that a plain number is left"));
        }
        if halves % 2.0 == 0.0 {
            return Ok(u.power(self.exponent as i8));
        }
        root(u.power(halves as i8), 2)
    }
}

impl Block for Power {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = u.dimension.map(|dimension| self.dimension(dimension)).transpose()?;
        Ok(Interface::new().input(Input::real("u")).output(Output::like("y", u.of(dimension))))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| l.element(0, i).pow(l.constant(self.exponent)));
        true
    }

    fn no_value(&self, failure: &Failure, _c: &Context) -> Option<String> {
        Some(format!("u to the power of {} has no value at u = {}", self.exponent, failure.value))
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn powers_of_whole_and_broken_exponent_are_taken() {
        for (exponent, u, expected) in
            [(3.0, -2.0, -8.0), (0.5, 9.0, 3.0), (-1.0, 4.0, 0.25), (0.0, 0.0, 1.0)]
        {
            assert_eq!(Bench::new(Power { exponent }).respond(u), expected);
        }
        assert!(Bench::new(Power { exponent: 2.0 }).respond(f64::NAN).is_nan());
    }

    #[test]
    #[should_panic(expected = "u to the power of 0.5 has no value at u = -1")]
    fn a_negative_number_has_no_broken_power() {
        Bench::new(Power { exponent: 0.5 }).respond(-1.0);
    }

    #[test]
    fn the_unit_is_raised_where_it_can_be() {
        let unit = |exponent, u| Power { exponent }.dimension(dimension(u));
        assert_eq!(unit(3.0, "m"), Ok(dimension("m^3")));
        assert_eq!(unit(1.5, "m^2"), Ok(dimension("m^3")));
        assert_eq!(unit(-1.0, "s"), Ok(dimension("1/s")));
        assert_eq!(unit(0.3, "rad"), Ok(Dimension::NONE));
        for (exponent, u) in [(0.3, "m"), (0.5, "m")] {
            assert_eq!(unit(exponent, u).unwrap_err().code, "unit_mismatch");
        }
        let y = Power { exponent: 2.0 }.interface(&given(&[("u", "V")], &[])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("V^2")));
    }

    #[test]
    fn an_infinite_exponent_is_refused() {
        assert_eq!(Power { exponent: f64::INFINITY }.errors()[0].param, "exponent");
    }
}
