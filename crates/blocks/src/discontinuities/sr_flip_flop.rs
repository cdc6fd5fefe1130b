use blocksim_block::prelude::*;

/// A set-reset flip-flop: `q` becomes true with `set` and false with `reset`, and stays so.
///
/// While both inputs are true, `priority` decides. Both are truth values; what they are at the start counts, and `q0` holds where neither is
/// true.
///
/// ```ron
/// SrFlipFlop(priority: Reset)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Text("SR"))]
pub struct SrFlipFlop {
    /// Which input wins: `Set` or `Reset`.
    #[block(default = Priority::Reset)]
    pub priority: Priority,
    /// `q` before either input has been true: 0 or 1.
    #[block(default = 0.0)]
    pub q0: f64,
}

/// Input that wins where both are true.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Priority {
    /// `q` is true.
    Set,
    /// `q` is false.
    Reset,
}

const STORED: &[Change] = &[Change::to(1.0, "is set"), Change::to(0.0, "is reset")];

impl SrFlipFlop {
    fn validate(&self, errors: &mut ParamErrors) {
        if self.q0 != 0.0 && self.q0 != 1.0 {
            errors.add(ParamError::new("q0", format!("`q0` is {}, but must be 0 or 1", self.q0)));
        }
    }
}

impl Block for SrFlipFlop {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .input(Input::boolean("set").scalar())
            .input(Input::boolean("reset").scalar())
            .output(Output::boolean("q"))
            .output(Output::boolean("not_q").doc("the opposite of `q`"))
            .modes("q", 1, self.q0, STORED))
    }

    fn law(&self, l: &Recording) -> bool {
        let (set, reset, q) = (l.u(0).is_true(), l.u(1).is_true(), l.d()[0]);
        let (one, zero) = (l.constant(1.0), l.constant(0.0));
        l.settle(
            0,
            match self.priority {
                Priority::Set => set.select(one, reset.select(zero, q)),
                Priority::Reset => reset.select(zero, set.select(one, q)),
            },
        );
        l.set(0, 0, q);
        l.set(1, 0, 1.0 - q);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn it_stores_what_was_set_last_and_priority_decides_between_two() {
        for (priority, both) in [(Priority::Set, 1.0), (Priority::Reset, 0.0)] {
            let mut bench = Bench::new(SrFlipFlop { priority, q0: 1.0 });
            for (set, reset, q) in [
                (0.0, 0.0, 1.0),
                (0.0, 1.0, 0.0),
                (0.0, 0.0, 0.0),
                (1.0, 0.0, 1.0),
                (0.0, 0.0, 1.0),
                (1.0, 1.0, both),
                (0.0, 0.0, both),
            ] {
                assert_eq!(bench.set(0, &[set]).set(1, &[reset]).major(), [q, 1.0 - q], "{priority:?}");
            }
        }
        assert_eq!(SrFlipFlop { priority: Priority::Set, q0: 0.5 }.errors()[0].param, "q0");
    }
}
