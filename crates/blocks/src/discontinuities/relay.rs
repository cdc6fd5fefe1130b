use crate::math::elements::{ON_OFF, common_unit, parameters_like};
use blocksim_block::prelude::*;

/// Two-point switch with hysteresis, element by element: on when $u \ge$ `on_at`, off when $u \le$ `off_at`, in between
/// as before.
///
/// It is off at the start unless the input is at `on_at` or above. The state changes only where the solver stops, and it stops
/// where the input reaches the point that matters.
///
/// ```ron
/// Relay(on_at: "21 degC", off_at: "19 degC", on: "0 W", off: "2 kW")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(Relay))]
pub struct Relay {
    /// Where it switches on, in the unit of the input.
    #[block(finite)]
    pub on_at: f64,
    /// Where it switches off, in the unit of the input; at most `on_at`.
    #[block(finite, at_most = on_at, remedy = "to invert the relay, exchange `on` and `off` instead")]
    pub off_at: f64,
    /// Output while on.
    #[block(finite, default = 1.0)]
    pub on: f64,
    /// Output while off.
    #[block(finite, default = 0.0)]
    pub off: f64,
}

impl Block for Relay {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        parameters_like(given, "u", u.dimension, &["on_at", "off_at"])?;
        let dimension = common_unit(given, &[("on", self.on), ("off", self.off)])?;
        let n = u.shape.len();
        let interface = Interface::new()
            .input(Input::real("u"))
            .output(Output::like("y", u.of(Some(dimension))))
            .modes("on", n, 0.0, ON_OFF);
        Ok(interface.guard_each("switches", n).called_by_mode())
    }

    fn law(&self, l: &Recording) -> bool {
        let [on, off, on_at, off_at] =
            [self.on, self.off, self.on_at, self.off_at].map(|value| l.constant(value));
        for i in 0..l.width(0) {
            let (u, held) = (l.element(0, i), l.d()[i]);
            let stays = u.live(Relation::LessEqual, off_at).select(l.constant(0.0), held);
            l.settle(i, u.live(Relation::GreaterEqual, on_at).select(l.constant(1.0), stays));
            l.set(0, i, u.is_number().select(held.is_true().select(on, off), u));
            l.guard(i, u - held.is_true().select(off_at, on_at));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const RELAY: Relay = Relay { on_at: 2.0, off_at: 1.0, on: 10.0, off: -10.0 };

    #[test]
    fn it_walks_round_the_hysteresis() {
        let mut bench = Bench::new(RELAY);
        for (u, y) in [
            (1.5, -10.0),
            (1.99, -10.0),
            (2.0, 10.0),
            (1.5, 10.0),
            (1.01, 10.0),
            (1.0, -10.0),
            (1.5, -10.0),
            (3.0, 10.0),
        ] {
            assert_eq!(bench.respond(u), y, "{u}");
        }
    }

    #[test]
    fn only_a_major_step_switches_and_the_guard_looks_at_the_next_point() {
        let mut bench = Bench::with_inputs(RELAY, vec![("u".to_owned(), PortType::vector(2))]);
        assert_eq!(bench.set(0, &[0.0, 5.0]).major(), [-10.0, 10.0]);
        assert_eq!(bench.set(0, &[2.5, 0.5]).minor(), [-10.0, 10.0]);
        assert_eq!(bench.guards(), [0.5, -0.5]);
        assert_eq!(bench.major(), [10.0, -10.0]);
    }

    #[test]
    fn what_is_not_a_number_neither_switches_nor_hides() {
        let mut bench = Bench::new(RELAY);
        bench.respond(3.0);
        assert!(bench.respond(f64::NAN).is_nan());
        assert_eq!(bench.respond(1.5), 10.0);
    }

    #[test]
    fn points_are_in_the_unit_of_the_input_and_values_in_their_own() {
        let relay = Relay { off: 0.0, ..RELAY };
        let units = given(&[("u", "K")], &[("on_at", "K"), ("on", "kW")]);
        assert_eq!(relay.interface(&units).unwrap().outputs[0].port_type.dimension, Some(dimension("W")));
        assert!(relay.interface(&given(&[("u", "K")], &[("on_at", "V")])).is_err());
        assert!(relay.interface(&given(&[], &[("on", "V"), ("off", "A")])).is_err());
    }

    #[test]
    fn the_points_may_coincide_but_not_cross() {
        assert!(Relay { off_at: 2.0, ..RELAY }.errors().is_empty());
        assert_eq!(Relay { off_at: 3.0, ..RELAY }.errors()[0].param, "off_at");
        assert_eq!(Relay { on: f64::NAN, ..RELAY }.errors()[0].param, "on");
    }
}
