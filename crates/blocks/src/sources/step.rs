use crate::math::elements::common_unit;
use blocksim_block::prelude::*;

/// A step: `before` until `time`, `after` from `time` on.
///
/// The solver steps exactly onto `time`, so no step of the integration sees both values.
///
/// ```ron
/// Step(time: "0.1 s", after: "90 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Step))]
pub struct Step {
    /// When it happens.
    #[block(unit = "s", finite, default = 0.0)]
    pub time: f64,
    /// Value before.
    #[block(finite, default = 0.0)]
    pub before: f64,
    /// Value after; its unit is that of the output.
    #[block(finite, default = 1.0)]
    pub after: f64,
}

impl Block for Step {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = common_unit(given, &[("before", self.before), ("after", self.after)])?;
        Ok(Interface::new()
            .output(Output::real("y").dimension(Some(dimension)))
            .discrete("happened", 0.0)
            .time_events())
    }

    fn law(&self, l: &Recording) -> bool {
        let reached = l.time().live(Relation::GreaterEqual, l.constant(self.time));
        l.settle(0, reached.number());
        l.set(0, 0, l.d()[0].is_true().select(l.constant(self.after), l.constant(self.before)));
        true
    }

    fn next_event(&self, c: &Context) -> f64 {
        if c.t < self.time { self.time } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const STEP: Step = Step { time: 0.1, before: -1.0, after: 2.0 };

    #[test]
    fn the_new_value_holds_from_the_time_of_the_step_on() {
        let mut bench = Bench::new(STEP);
        for (t, y, next) in [(0.0, -1.0, 0.1), (0.1_f64.next_down(), -1.0, 0.1), (0.1, 2.0, f64::INFINITY)] {
            bench.t = t;
            assert_eq!((bench.major(), bench.next_event()), (vec![y], next), "{t}");
        }
    }

    #[test]
    fn a_trial_step_that_ends_on_the_event_still_sees_the_old_value() {
        let mut bench = Bench::new(STEP);
        bench.major();
        bench.t = 0.1;
        assert_eq!(bench.minor(), [-1.0]);
        assert_eq!(bench.major(), [2.0]);
    }

    #[test]
    fn the_unit_is_the_one_that_is_written() {
        let step = Step { before: 0.0, ..STEP };
        let y = step.interface(&given(&[], &[("after", "deg")])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("rad")));
        assert!(STEP.interface(&given(&[], &[("after", "V")])).is_err(), "`before` is -1 without unit");
        assert!(STEP.interface(&given(&[], &[("after", "V"), ("before", "mV")])).is_ok());
    }

    #[test]
    fn values_must_be_finite() {
        assert_eq!(Step { after: f64::NAN, ..STEP }.errors()[0].param, "after");
        assert_eq!(Step { time: f64::INFINITY, ..STEP }.errors()[0].param, "time");
    }
}
