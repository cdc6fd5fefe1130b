use crate::math::elements::{at, parameters_like};
use blocksim_block::prelude::*;

/// Limits the input to `lower` ... `upper`, element by element.
///
/// $$ y = \min(\max(u, y_\text{lower}), y_\text{upper}) $$
///
/// The solver steps onto the kinks. Limits written as plain numbers are in the unit of the input.
///
/// With `external: true` the limits come from the extra inputs `lower` and `upper`; one that is not connected has the value of
/// the parameter. Limits that cross while the model runs end the run with an error.
///
/// ```ron
/// Saturation(lower: "-48 V", upper: "48 V")
/// ```
/// ```ron
/// Saturation(lower: 0, external: true)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Saturation))]
pub struct Saturation {
    /// Least output; none if it is not given.
    #[block(below = f64::INFINITY, default = None)]
    pub lower: Option<f64>,
    /// Greatest output; none if it is not given.
    #[block(above = f64::NEG_INFINITY, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Whether there are extra inputs `lower` and `upper`.
    #[block(default = false)]
    pub external: bool,
}

/// Ports of limits that are signals.
const LOWER: usize = 1;
const UPPER: usize = 2;

impl Saturation {
    fn lower(&self) -> f64 {
        self.lower.unwrap_or(f64::NEG_INFINITY)
    }

    fn upper(&self) -> f64 {
        self.upper.unwrap_or(f64::INFINITY)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.lower.is_none() && self.upper.is_none() && !self.external {
            errors.add(
                ParamError::new("lower", "there are neither limits nor inputs for them")
                    .help("give `lower` and `upper`, or `external: true`"),
            );
        }
    }
}

impl Block for Saturation {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["lower", "upper"])?;
        let ports: &[&str] = if self.external { &["u", "lower", "upper"] } else { &["u"] };
        let shape = given.common_shape(ports, &[])?;
        let mut interface = Interface::new().input(Input::real("u"));
        if self.external {
            let limit = |name, value| Input::real(name).dimension(dimension).default(value);
            interface = interface
                .input(
                    limit("lower", self.lower()).doc("Least output; the parameter if it is not connected."),
                )
                .input(
                    limit("upper", self.upper())
                        .doc("Greatest output; the parameter if it is not connected."),
                );
        }
        let n = shape.len();
        let interface = interface.output(Output::like("y", u.of(dimension).shaped(shape)));
        let lower =
            interface.kink_each("lower", n).called("leaves the lower limit", "reaches the lower limit");
        Ok(lower.kink_each("upper", n).called("reaches the upper limit", "leaves the upper limit"))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        if !self.external {
            let (lower, upper) = (l.constant(self.lower()), l.constant(self.upper()));
            l.each(0, |i| l.element(0, i).clamp(lower, upper));
            for i in 0..n {
                l.guard(i, l.element(0, i) - lower);
                l.guard(n + i, l.element(0, i) - upper);
            }
            return true;
        }
        for i in 0..n {
            let (u, lower, upper) = (l.element(0, i), l.element(LOWER, i), l.element(UPPER, i));
            upper.only_where(!upper.live(Relation::Less, lower));
            l.set(0, i, u.clamp(lower, upper));
            l.guard(i, u - lower);
            l.guard(n + i, u - upper);
        }
        true
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        crossed(c.input(LOWER), c.input(UPPER))
    }
}

/// What is wrong with limits of which a lower one is above the upper one.
pub(crate) fn crossed(lower: &[f64], upper: &[f64]) -> Option<String> {
    let pairs = (0..lower.len().max(upper.len())).map(|i| (at(lower, i), at(upper, i)));
    let (lower, upper) = pairs.into_iter().find(|(lower, upper)| lower > upper)?;
    Some(format!("the limits cross: `lower` is {lower}, above `upper`, which is {upper}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const LIMITS: Saturation = Saturation { lower: Some(-1.0), upper: Some(2.0), external: false };

    #[test]
    fn each_element_is_limited_and_a_limit_itself_passes() {
        let mut bench = Bench::with_inputs(LIMITS, vec![("u".to_owned(), PortType::vector(5))]);
        assert_eq!(bench.set(0, &[-5.0, -1.0, 0.5, 2.0, 9.0]).major(), [-1.0, -1.0, 0.5, 2.0, 2.0]);
        assert_eq!(bench.guards(), [-4.0, 0.0, 1.5, 3.0, 10.0, -7.0, -3.0, -1.5, 0.0, 7.0]);
        assert!(bench.set(0, &[f64::NAN; 5]).major()[0].is_nan());
    }

    #[test]
    fn a_limit_may_be_missing() {
        let mut bench = Bench::new(Saturation { lower: Some(0.0), upper: None, external: false });
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
        for (lower, upper, param) in [(1.0, -1.0, "upper"), (1.0, 1.0, "upper"), (f64::NAN, 1.0, "lower")] {
            assert_eq!(
                Saturation { lower: Some(lower), upper: Some(upper), external: false }.errors()[0].param,
                param
            );
        }
    }

    #[test]
    fn limits_by_signals_act_at_once_and_those_not_connected_are_the_parameters() {
        let inputs = vec![
            ("u".to_owned(), PortType::scalar()),
            ("lower".to_owned(), PortType::scalar()),
            ("upper".to_owned(), PortType::vector(2)),
        ];
        let mut bench = Bench::with_inputs(Saturation { external: true, ..LIMITS }, inputs);
        assert_eq!(bench.set(0, &[-7.0]).set(2, &[3.0, 9.0]).major(), [-1.0, -1.0]);
        assert_eq!(bench.set(0, &[7.0]).major(), [3.0, 7.0]);
        assert_eq!(bench.guards(), [8.0, 8.0, 4.0, -2.0]);
        assert_eq!(bench.set(0, &[1.0]).set(1, &[2.0]).set(2, &[2.0, 5.0]).major(), [2.0, 2.0]);
        let failure = bench.set(1, &[2.5]).failure().unwrap();
        assert_eq!(failure, "the limits cross: `lower` is 2.5, above `upper`, which is 2");
        let none = Saturation { lower: None, upper: None, external: false };
        assert_eq!(none.errors()[0].param, "lower");
    }
}
