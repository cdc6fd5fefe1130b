use blocksim_block::prelude::*;
use blocksim_signal::Unit;

/// Turns a signal into plain numbers: the value in the unit `to`, or 0 and 1 for false and true.
///
/// Signals carry SI values and blocks that show them convert by themselves, so this is needed only where a law wants
/// the bare number: an angle in degrees for a table, a truth value to multiply with.
///
/// ```ron
/// Convert(to: "deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("unit"))]
pub struct Convert {
    /// Unit in which the number is given; SI without, and needless for truth values.
    #[block(a_unit, default = None)]
    pub to: Option<String>,
}

impl Convert {
    fn unit(&self) -> Option<Unit> {
        self.to.as_ref().and_then(|to| Unit::parse(to).ok())
    }
}

impl Block for Convert {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let input = match self.unit() {
            Some(unit) => Input::real("u").dimension(Some(unit.dimension)),
            None => Input::any("u"),
        };
        Ok(Interface::new().input(input).output(Output::real("y").shape(u.shape)))
    }

    fn law(&self, l: &Recording) -> bool {
        let unit = self.unit();
        l.each(0, |i| {
            let u = l.element(0, i);
            match unit.as_ref().map(|unit| (unit, unit.divisor())) {
                Some((unit, Some(divisor))) => (u - unit.offset) * divisor,
                Some((unit, None)) => (u - unit.offset) / unit.scale,
                None => u,
            }
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn convert(to: &str) -> Convert {
        Convert { to: Some(to.to_owned()) }
    }

    #[test]
    fn the_output_is_the_number_in_the_unit() {
        for (to, u, expected) in
            [("deg", std::f64::consts::PI, 180.0), ("kV", 48.0, 0.048), ("degC", 293.15, 20.0)]
        {
            let y = Bench::new(convert(to)).respond(u);
            assert!((y - expected).abs() < 1e-12, "{to}: {y}");
        }
        assert!(Bench::new(convert("deg")).respond(f64::NAN).is_nan());
    }

    #[test]
    fn truth_values_become_numbers() {
        let inputs = vec![("u".to_owned(), PortType::boolean().shaped(Shape::Vector(2)))];
        let mut bench = Bench::with_inputs(Convert { to: None }, inputs);
        assert_eq!(bench.interface.outputs[0].port_type, PortType::vector(2));
        assert_eq!(bench.set(0, &[0.0, 1.0]).major(), [0.0, 1.0]);
    }

    #[test]
    fn the_input_must_be_measured_in_such_a_unit() {
        let interface = convert("kV").interface(&Given::nothing()).unwrap();
        assert_eq!(interface.inputs[0].dimension, Some(Unit::parse("V").unwrap().dimension));
        assert_eq!(interface.outputs[0].port_type.dimension, Some(Dimension::NONE));
    }

    #[test]
    fn an_unknown_unit_is_refused() {
        assert_eq!(convert("degg").errors()[0].param, "to");
        assert!(Convert { to: None }.errors().is_empty());
    }
}
