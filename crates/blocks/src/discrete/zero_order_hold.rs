use blocksim_block::prelude::*;

/// Samples a signal and holds it until the next sample: $y(t) = u(t_k)$ for $t_k \le t < t_{k+1}$.
///
/// Direct feedthrough at the samples. Takes signals of every kind, vectors element by element.
///
/// ```ron
/// ZeroOrderHold(ts: "1 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Curve(Hold))]
pub struct ZeroOrderHold {
    /// Sample time, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
}

impl Block for ZeroOrderHold {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        Ok(Interface::new().input(Input::any("u")).output(Output::like("y", u)).sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| l.element(0, i));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::{output_unit, vector};
    use blocksim_block::testing::Bench;

    #[test]
    fn a_sample_is_the_input_at_its_instant() {
        let mut bench = Bench::with_inputs(ZeroOrderHold { ts: 0.1 }, vector("u", 2));
        assert_eq!(bench.set(0, &[1.0, -2.0]).hit(), [1.0, -2.0]);
        assert_eq!(bench.interface.sample_time, Some(SampleTime::Discrete { period: 0.1, offset: 0.0 }));
    }

    #[test]
    fn the_unit_stays_and_a_negative_sample_time_is_refused() {
        let block = ZeroOrderHold { ts: -1.0 };
        assert_eq!(output_unit(&block, &[("u", "A")], &[]), "A");
        assert_eq!(block.errors()[0].param, "ts");
    }
}
