use crate::continuous::{Reset, UNSEEN};
use blocksim_block::prelude::*;

/// Counts edges of a signal, upwards or downwards.
///
/// Every edge counts, whenever it comes: the solver stops where a real input passes zero. A truth value has an edge where it
/// changes. What the inputs are at the start is no edge. With `down: true` edges of the extra input `down` count in the other
/// direction; edges of both at the same time leave the count as it is. With `reset` the extra input `reset` sets the count back to
/// `start`; edges at the same time do not count.
///
/// At `lower` and `upper` the count stays with `at_limit: Hold`, and goes on at the other limit with `Wrap`: from 0 to 7 it counts
/// 6, 7, 0, 1.
///
/// ```ron
/// Counter(edge: Rising, upper: 7, at_limit: Wrap)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Text("0 1 2"))]
pub struct Counter {
    /// Which edges count: `Rising`, `Falling` or `Either`.
    #[block(default = Crossing::Rising)]
    pub edge: Crossing,
    /// Whether there is an extra input `down`, which counts in the other direction.
    #[block(default = false)]
    pub down: bool,
    /// Whether `u` counts downwards.
    #[block(default = false)]
    pub reverse: bool,
    /// Count at the start and after a reset, a whole number.
    #[block(at_least = lower, at_most = upper, at_least = -MOST, at_most = MOST, default = 0.0)]
    pub start: f64,
    /// Least count, a whole number; if it is not given none, or 0 with `Wrap`.
    #[block(at_least = -MOST, at_most = MOST, default = None)]
    pub lower: Option<f64>,
    /// Greatest count, a whole number; none if it is not given.
    #[block(above = lower, at_least = -MOST, at_most = MOST, default = None)]
    pub upper: Option<f64>,
    /// What happens at the limits: `Hold` or `Wrap`.
    #[block(default = AtLimit::Hold)]
    pub at_limit: AtLimit,
    /// What the extra input `reset` must do to set the count back: `None` (there is no such input), `Rising`, `Falling`, `Either`,
    /// `Level`.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

/// What a counter does at a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum AtLimit {
    /// It stays.
    Hold,
    /// It goes on at the other limit.
    Wrap,
}

/// Discrete states: the count, then a memory for the edges of each input.
const COUNT: usize = 0;
const EDGES: usize = 1;

/// Counts beyond this are no longer exact.
const MOST: f64 = 9e15;

const COUNTS: &[Change] = &[Change::any("counts")];

impl Counter {
    fn edge(&self) -> Reset {
        match self.edge {
            Crossing::Either | Crossing::Holds | Crossing::Peak => Reset::Either,
            Crossing::Rising => Reset::Rising,
            Crossing::Falling => Reset::Falling,
        }
    }

    fn lower(&self) -> f64 {
        // Wrapping needs both limits; a counter that wraps begins at zero.
        self.lower.unwrap_or(if self.at_limit == AtLimit::Wrap { 0.0 } else { f64::NEG_INFINITY })
    }

    fn upper(&self) -> f64 {
        self.upper.unwrap_or(f64::INFINITY)
    }

    /// The inputs with edges, with what must happen there.
    fn ports(&self) -> Vec<(&'static str, Reset)> {
        let down = self.down.then_some(("down", self.edge()));
        let reset = (self.reset != Reset::None).then_some(("reset", self.reset));
        [Some(("u", self.edge())), down, reset].into_iter().flatten().collect()
    }

    fn next(&self, count: f64, steps: f64) -> f64 {
        let (next, lower, upper) = (count + steps, self.lower(), self.upper());
        match self.at_limit {
            AtLimit::Hold => next.clamp(lower, upper),
            AtLimit::Wrap => lower + (next - lower).rem_euclid(upper - lower + 1.0),
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        for (name, value) in [("start", Some(self.start)), ("lower", self.lower), ("upper", self.upper)] {
            if let Some(value) = value.filter(|value| value.fract() != 0.0) {
                let message = format!("`{name}` is {value}, but must be a whole number");
                let help = "counts go in steps of 1; a Gain behind the counter scales them";
                errors.add(ParamError::new(name, message).help(help));
            }
        }
        if self.at_limit != AtLimit::Wrap {
            return;
        }
        if self.upper.is_none() {
            errors.add(
                ParamError::new("at_limit", "a counter that wraps needs `upper`")
                    .help("`upper: 7` counts 0 to 7; `lower` is 0 if it is not given"),
            );
        }
        // Of a counter that wraps `lower` is 0 if it is not given.
        if self.lower.is_none() {
            errors.take(ordered("lower", self.lower(), "upper", self.upper()));
            if self.start < self.lower() {
                let message = format!("`start` is {}, but `lower` is 0 if it is not given", self.start);
                errors.add(ParamError::new("start", message).help("choose it from 0 on, or give `lower`"));
            }
        }
    }
}

impl Block for Counter {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let doc = |name| match name {
            "u" => "Edges count; Bool or Real.",
            "down" => "Edges count in the other direction; Bool or Real.",
            _ => "Sets the count back; Bool or Real.",
        };
        let mut interface = Interface::new();
        for (name, edge) in self.ports() {
            interface = interface.input(Input::any(name).scalar().doc(doc(name)));
            let crossing = match edge {
                Reset::Rising => Crossing::Rising,
                Reset::Falling => Crossing::Falling,
                Reset::Either | Reset::Level | Reset::None => Crossing::Either,
            };
            interface = interface.guard_when(crossing, name).called_by_mode();
        }
        let n = self.ports().len();
        Ok(interface
            .output(Output::real("count").doc("edges so far"))
            .modes("count", 1, self.start, COUNTS)
            .memory("edge", n, UNSEEN)
            .settles())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        let mut steps = 0.0;
        for (port, (name, edge)) in self.ports().into_iter().enumerate() {
            if !edge.fires(&mut d[EDGES + port], c.scalar(port)) {
                continue;
            }
            match name {
                "u" => steps += 1.0,
                "down" => steps -= 1.0,
                _ => {
                    d[COUNT] = self.start;
                    return;
                }
            }
        }
        if steps != 0.0 {
            d[COUNT] = self.next(d[COUNT], if self.reverse { -steps } else { steps });
        }
    }

    fn law(&self, l: &Recording) -> bool {
        l.set(0, 0, l.d()[COUNT]);
        (0..l.inputs()).for_each(|port| l.guard(port, l.u(port)));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn counter() -> Counter {
        Counter {
            edge: Crossing::Rising,
            down: false,
            reverse: false,
            start: 0.0,
            lower: None,
            upper: None,
            at_limit: AtLimit::Hold,
            reset: Reset::None,
        }
    }

    fn counts(block: Counter, samples: &[f64]) -> Vec<f64> {
        let mut bench = Bench::new(block);
        samples.iter().map(|u| bench.respond(*u)).collect()
    }

    #[test]
    fn edges_are_counted_in_the_direction_that_is_asked_for() {
        let samples = [1.0, -1.0, 1.0, 0.0, 1.0, 1.0, -2.0, 3.0];
        // To zero and back is a fall and a rise.
        assert_eq!(counts(counter(), &samples), [0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0]);
        let falling = Counter { edge: Crossing::Falling, ..counter() };
        assert_eq!(counts(falling, &samples), [0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0]);
        let either = Counter { edge: Crossing::Either, reverse: true, ..counter() };
        assert_eq!(counts(either, &samples), [0.0, -1.0, -2.0, -3.0, -4.0, -4.0, -5.0, -6.0]);
    }

    #[test]
    fn limits_hold_or_wrap() {
        let samples: Vec<f64> = (0..12).map(|k| if k % 2 == 1 { 1.0 } else { -1.0 }).collect();
        let last = |block| counts(block, &samples);
        let hold = last(Counter { upper: Some(3.0), ..counter() });
        assert_eq!(hold, [0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]);
        let wrap = Counter { lower: Some(-1.0), upper: Some(1.0), at_limit: AtLimit::Wrap, ..counter() };
        assert_eq!(last(wrap.clone()), [0.0, 1.0, 1.0, -1.0, -1.0, 0.0, 0.0, 1.0, 1.0, -1.0, -1.0, 0.0]);
        let down = last(Counter { reverse: true, ..wrap });
        assert_eq!(down, [0.0, -1.0, -1.0, 1.0, 1.0, 0.0, 0.0, -1.0, -1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn two_inputs_and_a_reset_act_together() {
        let mut bench = Bench::new(Counter { down: true, start: 5.0, reset: Reset::Rising, ..counter() });
        for (u, down, reset, count) in [
            (-1.0, -1.0, -1.0, 5.0),
            (1.0, -1.0, -1.0, 6.0),
            (-1.0, 1.0, -1.0, 5.0),
            (-1.0, -1.0, -1.0, 5.0),
            (1.0, 1.0, -1.0, 5.0),
            (-1.0, -1.0, -1.0, 5.0),
            (1.0, -1.0, -1.0, 6.0),
            (-1.0, -1.0, -1.0, 6.0),
            (1.0, -1.0, 1.0, 5.0),
            (1.0, -1.0, 1.0, 5.0),
        ] {
            assert_eq!(bench.set(0, &[u]).set(1, &[down]).set(2, &[reset]).major(), [count]);
        }
    }

    #[test]
    fn what_is_no_count_is_refused() {
        for (block, param) in [
            (Counter { start: 0.5, ..counter() }, "start"),
            (Counter { start: -1.0, lower: Some(0.0), ..counter() }, "start"),
            (Counter { upper: Some(f64::NAN), ..counter() }, "upper"),
            (Counter { at_limit: AtLimit::Wrap, ..counter() }, "at_limit"),
            (Counter { lower: Some(3.0), upper: Some(1.0), start: 2.0, ..counter() }, "upper"),
        ] {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
