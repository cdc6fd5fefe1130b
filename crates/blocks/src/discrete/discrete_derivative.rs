use blocksim_block::prelude::*;

use crate::continuous::reset::{Reset, UNSEEN};
use crate::continuous::units::{SECOND, agrees};

/// Difference quotient of a sampled signal, element by element.
///
/// $$ y_k = K\,\frac{u_k - u_{k-1}}{T_s} $$
///
/// The unit of the output is that of the input times that of `gain`, over s. Direct feedthrough. With `reset` an edge of the extra
/// input `reset` makes the input before this sample `x0`, as at the start.
///
/// ```ron
/// DiscreteDerivative(ts: "1 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Fraction("z − 1","T z"))]
pub struct DiscreteDerivative {
    /// Sample time $T_s$, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Factor $K$.
    #[block(difference, finite, default = 1.0)]
    pub gain: f64,
    /// Input before the first sample, in the unit of the input.
    #[block(finite, default = 0.0)]
    pub x0: f64,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set the state back: `None`
    /// (there is no such input), `Rising`, `Falling`, `Either`; with `Level` it is set back at each sample at which the
    /// input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

impl Block for DiscreteDerivative {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "x0", "u", u.dimension)?;
        let dimension = u.dimension.map(|u| u.times(given.parameters.get("gain")).over(SECOND));
        let interface = Interface::new().input(Input::real("u"));
        let interface = self.reset.input().into_iter().fold(interface, Interface::input);
        let interface =
            interface.output(Output::like("y", u.of(dimension))).memory("before", u.shape.len(), self.x0);
        let has_reset = self.reset != Reset::None;
        let interface = if has_reset { interface.discrete("trigger", UNSEEN) } else { interface };
        Ok(interface.sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        let fires = self.reset.sampled(l, n, 1);
        for i in 0..n {
            let (u, before) = (l.element(0, i), l.d()[i]);
            let before = fires.map_or(before, |(fires, _)| fires.select(l.constant(self.x0), before));
            l.set(0, i, self.gain * (u - before) / self.ts);
            l.update(i, u);
        }
        fires.into_iter().for_each(|(_, next)| l.update(n, next));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::output_unit;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_differences_of_squares_are_the_odd_numbers() {
        let mut bench = Bench::new(DiscreteDerivative { ts: 0.5, gain: 2.0, x0: 0.0, reset: Reset::None });
        for k in 1..10 {
            let k = f64::from(k);
            assert_eq!(bench.set(0, &[k * k]).hit(), [4.0 * (2.0 * k - 1.0)]);
        }
    }

    #[test]
    fn the_unit_is_that_of_the_input_over_seconds() {
        let block = DiscreteDerivative { ts: 0.0, gain: 1.0, x0: 0.0, reset: Reset::None };
        assert_eq!(output_unit(&block, &[("u", "m")], &[]), "m/s");
        assert_eq!(output_unit(&block, &[("u", "m")], &[("gain", "s")]), "m");
        assert_eq!(block.errors()[0].param, "ts");
    }

    #[test]
    fn a_reset_begins_from_the_start_value() {
        let block = DiscreteDerivative { ts: 0.5, gain: 1.0, x0: 1.0, reset: Reset::Falling };
        let inputs = vec![("u".to_owned(), PortType::scalar()), ("reset".to_owned(), PortType::boolean())];
        let mut bench = Bench::with_inputs(block, inputs);
        for (u, reset, y) in [(2.0, 1.0, 2.0), (4.0, 1.0, 4.0), (7.0, 0.0, 12.0), (8.0, 0.0, 2.0)] {
            assert_eq!(bench.set(0, &[u]).set(1, &[reset]).hit(), [y]);
        }
    }
}
