use blocksim_block::prelude::*;

/// Sign: $y = 1$ for $u > 0$, $-1$ for $u < 0$, and 0 for exactly 0; element by element.
///
/// The value is chosen where the solver stops, and it stops where `u` crosses zero; in between it is held.
///
/// ```ron
/// Sign
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Curve(Sign))]
pub struct Sign;

impl Block for Sign {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let shape = given.input_or_unknown("u").shape;
        let interface = Interface::new()
            .input(Input::real("u"))
            .output(Output::real("y").shape(shape))
            .memory("sign", shape.len(), 0.0);
        Ok(interface.guard_each("zero", shape.len()).called("turns positive", "turns negative"))
    }

    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            l.settle(i, l.element(0, i).signum());
            l.set(0, i, l.d()[i]);
            l.guard(i, l.element(0, i));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::given;
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_sign_of_exactly_zero_is_zero() {
        let mut bench = Bench::new(Sign);
        for (u, expected) in [(3.0, 1.0), (-0.1, -1.0), (0.0, 0.0), (-0.0, 0.0), (1e-300, 1.0)] {
            assert_eq!(bench.respond(u), expected, "{u}");
        }
        assert!(bench.respond(f64::NAN).is_nan());
    }

    #[test]
    fn between_major_steps_the_sign_is_held() {
        let mut bench = Bench::with_inputs(Sign, vec![("u".to_owned(), PortType::vector(2))]);
        assert_eq!(bench.set(0, &[2.0, -2.0]).major(), [1.0, -1.0]);
        assert_eq!(bench.set(0, &[-0.1, 0.1]).minor(), [1.0, -1.0]);
        assert_eq!(bench.guards(), [-0.1, 0.1]);
        assert_eq!(bench.major(), [-1.0, 1.0]);
    }

    #[test]
    fn the_output_has_no_unit() {
        let y = Sign.interface(&given(&[("u", "V")], &[])).unwrap().outputs[0].port_type;
        assert_eq!(y, PortType::scalar());
    }
}
