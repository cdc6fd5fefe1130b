use blocksim_block::prelude::*;

/// A timer: `y` becomes true once `u` has been true for `on`, and false once `u` has been false for `off`.
///
/// A `u` that changes back before its time has passed changes nothing. The times are hit exactly. At the start, `y` is as `u` is.
///
/// ```ron
/// OnOffDelay(on: "200 ms", off: "50 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Text("t on/off"))]
pub struct OnOffDelay {
    /// Time for which `u` must be true.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub on: f64,
    /// Time for which `u` must be false.
    #[block(unit = "s", not_negative, default = 0.0)]
    pub off: f64,
}

const SWITCHED: &[Change] = &[Change::to(1.0, "switches on"), Change::to(0.0, "switches off")];

/// Places of the discrete states: `y`, the time at which it changes unless `u` changes back, and whether there was a start.
const Y: usize = 0;
const DUE: usize = 1;
const STARTED: usize = 2;

impl Block for OnOffDelay {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .input(Input::boolean("u").scalar())
            .output(Output::boolean("y"))
            .modes("y", 1, 0.0, SWITCHED)
            .discrete("due", -1.0)
            .discrete("started", 0.0)
            .waits())
    }

    fn law(&self, l: &Recording) -> bool {
        let (u, t) = (l.u(0), l.time());
        let [y, due, started] = [Y, DUE, STARTED].map(|i| l.d()[i]);
        let [none, zero, one] = [-1.0, 0.0, 1.0].map(|value| l.constant(value));
        let is_started = started.live(Relation::NotEqual, zero);
        let wait = u.live(Relation::Equal, one).select(l.constant(self.on), l.constant(self.off));
        let due = due.live(Relation::Less, zero).select(t + wait, due);
        let is_due = t.live(Relation::GreaterEqual, due);
        let stays = u.live(Relation::Equal, y);
        l.settle(Y, is_started.select(stays.select(y, is_due.select(u, y)), u));
        l.settle(DUE, is_started.and(!stays).and(!is_due).select(due, none));
        l.settle(STARTED, one);
        l.set(0, 0, y);
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        if c.d[DUE] > c.t { c.d[DUE] } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn short_pulses_and_gaps_do_not_pass() {
        let mut bench = Bench::new(OnOffDelay { on: 2.0, off: 1.0 });
        for (t, u, y) in [
            (0.0, 0.0, 0.0),
            (1.0, 1.0, 0.0),
            (2.5, 0.0, 0.0),
            (3.0, 1.0, 0.0),
            (4.5, 1.0, 0.0),
            (5.0, 1.0, 1.0),
            (6.0, 0.0, 1.0),
            (6.5, 1.0, 1.0),
            (7.0, 0.0, 1.0),
            (8.0, 0.0, 0.0),
        ] {
            bench.t = t;
            assert_eq!(bench.set(0, &[u]).major(), [y], "at {t} s");
        }
    }

    #[test]
    fn the_end_of_a_delay_is_an_event_and_without_delay_it_follows_at_once() {
        let mut bench = Bench::new(OnOffDelay { on: 0.3, off: 0.0 });
        bench.set(0, &[0.0]).major();
        bench.t = 1.0;
        bench.set(0, &[1.0]).major();
        assert_eq!(bench.d[DUE], 1.3);
        bench.t = 1.3;
        assert_eq!(bench.major(), [1.0]);
        assert_eq!(bench.set(0, &[0.0]).major(), [0.0]);
        assert_eq!(OnOffDelay { on: -1.0, off: 0.0 }.errors()[0].param, "on");
    }
}
