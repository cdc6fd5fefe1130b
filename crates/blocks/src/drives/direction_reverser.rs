use crate::math::elements::parameters_like;
use blocksim_block::prelude::*;

/// Splits a signed command into a direction and a magnitude, for a drive that reverses by exchanging two phases.
///
/// `reverse` becomes true when $u < -h$ and false when $u > h$; in between it stays. After a change it stays for `hold` in
/// any case, and is then chosen anew. At the start it is the sign of $u$. The magnitude is
///
/// $$ m = \max(s u, 0), \qquad s = -1 \text{ if reversed, else } 1 $$
///
/// that is $|u|$, but 0 while the direction is not yet that of the command: a drive is never pushed the wrong way.
///
/// ```ron
/// DirectionReverser(hysteresis: 1e-3, hold: "50 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("±, |u|"))]
pub struct DirectionReverser {
    /// Distance $h$ from zero, in the unit of the input, that the command must pass to change the direction.
    #[block(difference, not_negative, default = 1e-3)]
    pub hysteresis: f64,
    /// Shortest time between two changes of the direction.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub hold: f64,
}

/// Discrete states: whether reversed, until when that is held (s), whether a direction has been chosen at all.
const REVERSED: usize = 0;
const UNTIL: usize = 1;
const CHOSEN: usize = 2;

/// What a change of the direction is called.
const DIRECTIONS: &[Change] =
    &[Change::to(1.0, "reverses the phases"), Change::to(0.0, "restores the phases")];

impl Block for DirectionReverser {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u").dimension;
        let unit = parameters_like(given, "u", u, &["hysteresis"])?;
        Ok(Interface::new()
            .input(Input::real("u").scalar().doc("command; its sign is the direction"))
            .output(Output::boolean("reverse").doc("whether the phases are to be exchanged"))
            .output(Output::like("magnitude", PortType::scalar().of(unit)).doc("command in that direction"))
            .modes("reversed", 1, 0.0, DIRECTIONS)
            .discrete("until", 0.0)
            .discrete("chosen", 0.0)
            .guard("direction")
            .called_by_mode()
            .guard("zero")
            .called("turns positive", "turns negative")
            .waits())
    }

    fn law(&self, l: &Recording) -> bool {
        let (u, t) = (l.u(0), l.time());
        let [reversed, until, chosen] = [REVERSED, UNTIL, CHOSEN].map(|i| l.d()[i]);
        let [zero, one] = [0.0, 1.0].map(|value| l.constant(value));
        let is_reversed = reversed.is_true();
        let beyond = u.live(Relation::Greater, l.constant(self.hysteresis));
        let below = u.live(Relation::Less, l.constant(-self.hysteresis));
        let turns = is_reversed.choose(beyond, below).and(t.live(Relation::GreaterEqual, until));
        let was_chosen = chosen.is_true();
        let sign = u.live(Relation::Less, zero).number();
        l.settle(REVERSED, was_chosen.select(turns.select((!is_reversed).number(), reversed), sign));
        l.settle(UNTIL, was_chosen.and(turns).select(t + self.hold, until));
        l.settle(CHOSEN, one);
        l.set(0, 0, reversed);
        let along = is_reversed.select(-u, u);
        l.set(1, 0, along.live(Relation::Less, zero).select(zero, along));
        let side = is_reversed.select(-one, one);
        // While the direction is held the command may pass the point unseen; the end of that time is an event of its own.
        l.guard(0, t.live(Relation::LessEqual, until).select(side, u + side * self.hysteresis));
        l.guard(1, u);
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        if c.d[UNTIL] > c.t { c.d[UNTIL] } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const REVERSER: DirectionReverser = DirectionReverser { hysteresis: 0.1, hold: 0.0 };

    #[test]
    fn it_walks_round_the_hysteresis_and_pushes_never_the_wrong_way() {
        let mut bench = Bench::new(REVERSER);
        for (u, reverse, magnitude) in [
            (0.5, 0.0, 0.5),
            (-0.1, 0.0, 0.0),
            (-0.2, 1.0, 0.2),
            (-0.01, 1.0, 0.01),
            (0.05, 1.0, 0.0),
            (0.11, 0.0, 0.11),
        ] {
            assert_eq!(bench.set(0, &[u]).major(), [reverse, magnitude], "{u}");
        }
    }

    #[test]
    fn at_the_start_the_sign_alone_counts() {
        assert_eq!(Bench::new(REVERSER).set(0, &[-0.01]).major(), [1.0, 0.01]);
        assert_eq!(Bench::new(REVERSER).set(0, &[0.0]).major(), [0.0, 0.0]);
    }

    #[test]
    fn a_direction_is_held_and_then_chosen_anew() {
        let mut bench = Bench::new(DirectionReverser { hold: 0.5, ..REVERSER });
        bench.set(0, &[1.0]).major();
        bench.t = 1.0;
        assert_eq!(bench.set(0, &[-1.0]).major(), [1.0, 1.0]);
        assert_eq!(bench.next_event(), 1.5);
        bench.t = 1.2;
        assert_eq!(bench.set(0, &[0.7]).major(), [1.0, 0.0]);
        assert_eq!(bench.guards(), [-1.0, 0.7]);
        bench.t = 1.5;
        assert_eq!(bench.major(), [0.0, 0.7]);
        assert_eq!(bench.next_event(), 2.0);
    }

    #[test]
    fn the_guard_looks_at_the_next_point_and_keeps_its_sign_where_the_hold_ends() {
        let mut bench = Bench::new(DirectionReverser { hold: 0.5, ..REVERSER });
        bench.set(0, &[-1.0]).major();
        bench.t = 1.0;
        assert_eq!(bench.guards(), [-1.1, -1.0]);
        bench.set(0, &[1.0]).major();
        for (t, sign) in [(1.1, 1.0), (1.5, 1.0), (1.6, 1.0)] {
            bench.t = t;
            assert_eq!(bench.guards()[0].signum(), sign, "{t}");
        }
    }

    #[test]
    fn what_is_not_a_number_turns_nothing_and_does_not_hide() {
        let mut bench = Bench::new(REVERSER);
        bench.set(0, &[-1.0]).major();
        let y = bench.set(0, &[f64::NAN]).major();
        assert!(y[0] == 1.0 && y[1].is_nan());
    }

    #[test]
    fn the_hysteresis_is_in_the_unit_of_the_input_and_not_negative() {
        let interface = REVERSER.interface(&given(&[("u", "V")], &[("hysteresis", "mV")])).unwrap();
        assert_eq!(interface.outputs[1].port_type.dimension, Some(dimension("V")));
        assert!(REVERSER.interface(&given(&[("u", "V")], &[("hysteresis", "A")])).is_err());
        assert_eq!(DirectionReverser { hysteresis: -1.0, ..REVERSER }.errors()[0].param, "hysteresis");
        assert_eq!(DirectionReverser { hold: f64::NAN, ..REVERSER }.errors()[0].param, "hold");
    }
}
