//! When a reset input fires.

use blocksim_block::prelude::*;

/// What a reset input must do to set states back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Reset {
    /// There is no reset input.
    None,
    /// Becomes true, or rises through zero.
    Rising,
    /// Becomes false, or falls through zero.
    Falling,
    /// Either of the two.
    Either,
    /// Is true, or positive; the states stay where they were set as long as it is.
    Level,
}

/// Memory of a trigger that was never looked at.
pub(crate) const UNSEEN: f64 = 2.0;

/// Side of zero on which a trigger is: the sign of its value, or, on zero itself, half the sign it is about to
/// get. So a signal that reaches zero has crossed it, and does not cross it again when it leaves on the far side.
fn side(memory: f64, value: f64) -> f64 {
    if value != 0.0 {
        return value.signum();
    }
    match memory {
        1.0 => -0.5,
        -1.0 => 0.5,
        UNSEEN => 0.0,
        stays => stays,
    }
}

impl Reset {
    /// The reset input, if there is one.
    pub(crate) fn input(self) -> Option<Input> {
        (self != Self::None).then(|| Input::any("reset").scalar().doc("Sets the states back; Bool or Real."))
    }

    /// The interface with a guard that watches the reset input if it must: a Bool changes at major steps alone.
    pub(crate) fn guard(self, interface: Interface, given: &Given) -> Interface {
        let crossing = match self {
            Self::None => return interface,
            Self::Rising => Crossing::Rising,
            Self::Falling => Crossing::Falling,
            Self::Either | Self::Level => Crossing::Either,
        };
        let is_bool = given.input_or_unknown("reset").kind == Kind::Bool;
        if is_bool { interface } else { interface.guard_when(crossing, "reset").called_by_mode() }
    }

    /// Whether the reset happens now, when the trigger has this value. `memory` is one discrete state, at first
    /// [`UNSEEN`]; the first look never counts as an edge.
    pub(crate) fn fires(self, memory: &mut f64, value: f64) -> bool {
        let before = *memory;
        let now = side(before, value);
        *memory = now;
        if self == Self::Level {
            *memory = if value > 0.0 { 1.0 } else { -1.0 };
            return value > 0.0;
        }
        let seen = before != UNSEEN;
        // A memory of half a sign has crossed already: leaving zero to that side is no new edge.
        let rises = seen && before <= 0.0 && now > 0.0;
        let falls = seen && before >= 0.0 && now < 0.0;
        match self {
            Self::Rising => rises,
            Self::Falling => falls,
            Self::Either => rises || falls,
            Self::None | Self::Level => false,
        }
    }

    /// The same as a law: whether it happens, and what the memory becomes.
    pub(crate) fn fires_in<'r>(
        self,
        l: &Recording<'r>,
        memory: Value<'r>,
        value: Value<'r>,
    ) -> (Condition<'r>, Value<'r>) {
        let [zero, half, one, unseen] = [0.0, 0.5, 1.0, UNSEEN].map(|number| l.constant(number));
        let is = |number| memory.live(Relation::Equal, number);
        if self == Self::Level {
            let is_on = value.live(Relation::Greater, zero);
            return (is_on, is_on.select(one, -one));
        }
        let at_zero = is(one).select(-half, is(-one).select(half, is(unseen).select(zero, memory)));
        let now = value.live(Relation::NotEqual, zero).select(value.signum(), at_zero);
        let seen = !is(unseen);
        let rises = seen.and(memory.live(Relation::LessEqual, zero)).and(now.live(Relation::Greater, zero));
        let falls = seen.and(memory.live(Relation::GreaterEqual, zero)).and(now.live(Relation::Less, zero));
        let fires = match self {
            Self::Rising => rises,
            Self::Falling => falls,
            Self::Either | Self::None | Self::Level => rises.or(falls),
        };
        (fires, now)
    }

    /// Whether the states are held at their initial values until the trigger lets go.
    pub(crate) fn holds(self, memory: f64) -> bool {
        self == Self::Level && memory == 1.0
    }

    /// The same as a law; nothing where they are never held.
    pub(crate) fn held<'r>(self, l: &Recording<'r>, memory: Value<'r>) -> Option<Condition<'r>> {
        (self == Self::Level).then(|| memory.live(Relation::Equal, l.constant(1.0)))
    }

    /// Whether the reset of a sampled block by the input `port` happens at a sample hit, and what the discrete state `memory`,
    /// which is at first [`UNSEEN`], becomes there. An edge lies between two samples: a trigger rises from zero
    /// or less to above zero. Nothing without a reset input.
    pub(crate) fn sampled<'r>(
        self,
        l: &Recording<'r>,
        memory: usize,
        port: usize,
    ) -> Option<(Condition<'r>, Value<'r>)> {
        if self == Self::None {
            return None;
        }
        let (memory, value) = (l.d()[memory], l.u(port));
        let [on, off] = [1.0, -1.0].map(|side| l.constant(side));
        let is_on = value.live(Relation::Greater, l.constant(0.0));
        let was = |side| memory.live(Relation::Equal, side);
        let (rises, falls) = (was(off).and(is_on), was(on).and(!is_on));
        let fires = match self {
            Self::Rising => rises,
            Self::Falling => falls,
            Self::Either => rises.or(falls),
            Self::Level | Self::None => is_on,
        };
        Some((fires, is_on.select(on, off)))
    }
}

impl Reset {
    /// The same as [`sampled`](Self::sampled) for a block that is called: whether it happens, and what the memory becomes.
    pub(crate) fn sampled_now(self, memory: f64, value: f64) -> (bool, f64) {
        let is_on = value > 0.0;
        let (rises, falls) = (memory == -1.0 && is_on, memory == 1.0 && !is_on);
        let fires = match self {
            Self::Rising => rises,
            Self::Falling => falls,
            Self::Either => rises || falls,
            Self::Level => is_on,
            Self::None => false,
        };
        (fires, if is_on { 1.0 } else { -1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Reset::{Either, Falling, Level, None, Rising};

    fn edges(reset: Reset, values: &[f64]) -> Vec<usize> {
        let mut memory = UNSEEN;
        (0..values.len()).filter(|&i| reset.fires(&mut memory, values[i])).collect()
    }

    #[test]
    fn an_edge_counts_once_even_if_it_stops_on_zero() {
        let through = [1.0, 0.0, 0.0, -1.0, 0.0, 1.0, -1.0, 1.0];
        assert_eq!(edges(Reset::Falling, &through), [1, 6]);
        assert_eq!(edges(Reset::Rising, &through), [4, 7]);
        assert_eq!(edges(Reset::Either, &through), [1, 4, 6, 7]);
    }

    #[test]
    fn a_signal_that_starts_on_zero_has_an_edge_when_it_leaves() {
        assert_eq!(edges(Reset::Rising, &[0.0, 0.0, 2.0]), [2]);
        assert_eq!(edges(Reset::Falling, &[0.0, 0.0, -2.0]), [2]);
    }

    #[test]
    fn truth_values_have_an_edge_at_each_change() {
        let truth = [0.0, 1.0, 1.0, 0.0, 0.0, 1.0];
        assert_eq!(edges(Reset::Rising, &truth), [1, 5]);
        assert_eq!(edges(Reset::Falling, &truth), [3]);
        assert_eq!(edges(Reset::Level, &truth), [1, 2, 5]);
    }

    #[test]
    fn the_first_look_is_no_edge() {
        assert!(edges(Reset::Either, &[1.0, 1.0]).is_empty());
        assert!(edges(Reset::Either, &[-1.0]).is_empty());
    }

    /// At which samples a reset fires, by a loop over the samples that knows nothing of memories.
    fn expected(reset: Reset, samples: &[f64]) -> Vec<usize> {
        let fires = |k: usize| {
            let now = samples[k] > 0.0;
            let before = k.checked_sub(1).map(|before| samples[before] > 0.0);
            match reset {
                None => false,
                Rising => before == Some(false) && now,
                Falling => before == Some(true) && !now,
                Either => before.is_some_and(|before| before != now),
                Level => now,
            }
        };
        (0..samples.len()).filter(|k| fires(*k)).collect()
    }

    /// Counts samples since the last reset.
    #[derive(Debug)]
    struct Since(Reset);

    impl Block for Since {
        fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
            let reset = self.0.input().into_iter().fold(Interface::new(), Interface::input);
            Ok(reset.output(Output::real("y")).discrete("n", 5.0).discrete("trigger", UNSEEN).sampled(1.0))
        }

        fn law(&self, l: &Recording) -> bool {
            let n = l.d()[0];
            let fires = self.0.sampled(l, 1, 0);
            let n = fires.map_or(n, |(fires, _)| fires.select(l.constant(0.0), n));
            l.set(0, 0, n);
            l.update(0, n + 1.0);
            l.update(1, fires.map_or(l.d()[1], |(_, next)| next));
            true
        }
    }

    #[test]
    fn edges_between_samples_reset_and_nothing_else_does() {
        let samples = [1.0, 1.0, 0.0, 0.5, -1.0, -0.0, 2.0, 2.0, -3.0, 0.0, 0.0, 4.0];
        for reset in [None, Rising, Falling, Either, Level] {
            let mut bench = blocksim_block::testing::Bench::of(Since(reset));
            let mut found = Vec::new();
            for (k, sample) in samples.iter().enumerate() {
                if reset != None {
                    bench.set(0, &[*sample]);
                }
                if bench.hit() == [0.0] {
                    found.push(k);
                }
            }
            assert_eq!(found, expected(reset, &samples), "{reset:?}");
        }
    }
}
