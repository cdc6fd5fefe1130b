use crate::math::elements::{ROUNDING, parameters_like};
use blocksim_block::prelude::*;

/// Rounds to whole multiples of an interval: $y = q \operatorname{round}(u / q)$, element by element.
///
/// Halves are rounded away from zero. The value is chosen where the solver stops, and it stops half an interval above
/// and below the present value; in between it is held.
///
/// ```ron
/// Quantizer(interval: "0.1 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Quantizer))]
pub struct Quantizer {
    /// Interval $q$, in the unit of the input.
    #[block(difference, positive)]
    pub interval: f64,
}

impl Quantizer {
    /// How much is left of the half interval around a value.
    fn left<'r>(&self, l: &Recording<'r>, u: Value<'r>, y: Value<'r>) -> Value<'r> {
        let left = l.constant(0.5 * self.interval) - (u - y).abs();
        let rounding = ROUNDING * (u.abs() + self.interval);
        left.abs().live(Relation::LessEqual, rounding).select(l.constant(0.0), left)
    }
}

/// What another level is called.
const LEVELS: &[Change] = &[Change::any("changes its level")];

impl Block for Quantizer {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["interval"])?;
        let n = u.shape.len();
        let interface = Interface::new()
            .input(Input::real("u"))
            .output(Output::like("y", u.of(dimension)))
            .modes("y", n, 0.0, LEVELS);
        Ok(interface.guard_each_when(Crossing::Holds, "level", n).called_by_mode())
    }

    /// A value holds up to half an interval away from it, halves included on both sides.
    fn law(&self, l: &Recording) -> bool {
        for (i, u) in l.input(0).iter().enumerate() {
            let number = (*u / self.interval).nearest();
            let nearest = self.interval * number;
            // The quotient may be rounded to a half from beyond it; what decides is the guard.
            let beyond = self.left(l, *u, nearest).live(Relation::Less, l.constant(0.0));
            let next = self.interval * (number + (*u - nearest).signum());
            l.settle(i, beyond.select(next, nearest));
            l.set(0, i, l.d()[i]);
            l.guard(i, self.left(l, *u, l.d()[i]));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const QUANTIZER: Quantizer = Quantizer { interval: 0.5 };

    #[test]
    fn multiples_of_the_interval_come_out() {
        let mut bench = Bench::new(QUANTIZER);
        for (u, y) in
            [(0.0, 0.0), (0.24, 0.0), (0.25, 0.5), (0.6, 0.5), (-0.25, -0.5), (-0.2, 0.0), (7.3, 7.5)]
        {
            assert_eq!(bench.respond(u), y, "{u}");
        }
        assert!(bench.respond(f64::NAN).is_nan());
    }

    #[test]
    fn a_value_holds_up_to_half_an_interval_around_it() {
        let mut bench = Bench::with_inputs(QUANTIZER, vec![("u".to_owned(), PortType::vector(2))]);
        bench.set(0, &[1.0, -1.0]).major();
        assert_eq!(bench.set(0, &[1.5, -1.0]).minor(), [1.0, -1.0]);
        assert_eq!(bench.guards(), [-0.25, 0.25]);
        assert_eq!(bench.major(), [1.5, -1.0]);
    }

    #[test]
    fn close_to_a_half_the_value_is_the_one_that_its_guard_lets_stand() {
        let mut bench = Bench::new(Quantizer { interval: 0.18 });
        for half in -50..50 {
            let mut u = 0.18 * (f64::from(half) + 0.5);
            (0..4).for_each(|_| u = u.next_down());
            for _ in 0..9 {
                bench.set(0, &[u]).major();
                assert!(bench.guards()[0] >= 0.0, "{u}");
                u = u.next_up();
            }
        }
    }

    #[test]
    fn the_interval_is_in_the_unit_of_the_input() {
        let y = QUANTIZER.interface(&given(&[("u", "rad")], &[("interval", "deg")])).unwrap().outputs[0]
            .port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert!(QUANTIZER.interface(&given(&[("u", "rad")], &[("interval", "V")])).is_err());
        assert_eq!(Quantizer { interval: 0.0 }.errors()[0].param, "interval");
    }
}
