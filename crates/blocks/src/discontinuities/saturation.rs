use crate::math::elements::parameters_like;
use blocksim_block::prelude::*;

/// Limits the input to `lower` ... `upper`, element by element.
///
/// $$ y = \min(\max(u, y_\text{lower}), y_\text{upper}) $$
///
/// The solver steps onto the kinks. Limits written as plain numbers are in the unit of the input.
///
/// ```ron
/// Saturation(lower: "-48 V", upper: "48 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Saturation))]
pub struct Saturation {
    /// Least output; `-inf` for none.
    pub lower: f64,
    /// Greatest output; `inf` for none.
    pub upper: f64,
}

impl Block for Saturation {
    fn check(&self) -> Result<(), ParamError> {
        ordered("lower", self.lower, "upper", self.upper)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["lower", "upper"])?;
        let n = u.shape.len();
        let interface = Interface::new().input(Input::real("u")).output(Output::like("y", u.of(dimension)));
        let lower =
            interface.kink_each("lower", n).called("leaves the lower limit", "reaches the lower limit");
        Ok(lower.kink_each("upper", n).called("reaches the upper limit", "leaves the upper limit"))
    }

    fn law(&self, l: &Recording) -> bool {
        let (lower, upper, n) = (l.constant(self.lower), l.constant(self.upper), l.width(0));
        l.each(0, |i| l.element(0, i).clamp(lower, upper));
        for i in 0..n {
            l.guard(i, l.element(0, i) - lower);
            l.guard(n + i, l.element(0, i) - upper);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const LIMITS: Saturation = Saturation { lower: -1.0, upper: 2.0 };

    #[test]
    fn each_element_is_limited_and_a_limit_itself_passes() {
        let mut bench = Bench::with_inputs(LIMITS, vec![("u".to_owned(), PortType::vector(5))]);
        assert_eq!(bench.set(0, &[-5.0, -1.0, 0.5, 2.0, 9.0]).major(), [-1.0, -1.0, 0.5, 2.0, 2.0]);
        assert_eq!(bench.guards(), [-4.0, 0.0, 1.5, 3.0, 10.0, -7.0, -3.0, -1.5, 0.0, 7.0]);
        assert!(bench.set(0, &[f64::NAN; 5]).major()[0].is_nan());
    }

    #[test]
    fn a_limit_may_be_missing() {
        let mut bench = Bench::new(Saturation { lower: 0.0, upper: f64::INFINITY });
        assert_eq!([bench.respond(-1.0), bench.respond(1e300)], [0.0, 1e300]);
    }

    #[test]
    fn limits_are_in_the_unit_of_the_input() {
        let unit =
            |given: &Given| LIMITS.interface(given).map(|interface| interface.outputs[0].port_type.dimension);
        let volt = Some(dimension("V"));
        assert_eq!(unit(&given(&[("u", "V")], &[])), Ok(volt));
        assert_eq!(unit(&given(&[], &[("upper", "kV")])), Ok(volt));
        assert_eq!(unit(&given(&[("u", "A")], &[("upper", "V")])).unwrap_err().ports, ["u"]);
    }

    #[test]
    fn limits_the_wrong_way_round_are_refused() {
        for (lower, upper) in [(1.0, -1.0), (1.0, 1.0), (f64::NAN, 1.0)] {
            assert_eq!(Saturation { lower, upper }.check().unwrap_err().param, "upper");
        }
    }
}
