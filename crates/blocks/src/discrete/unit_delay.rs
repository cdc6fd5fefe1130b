use blocksim_block::prelude::*;

use crate::continuous::reset::{Reset, UNSEEN};
use crate::continuous::units::agrees_as_written;
use crate::math::Entries;

/// Delays by one sample: $y_k = u_{k-1}$.
///
/// $$ y_k = x_k, \qquad x_{k+1} = u_k, \qquad x_0 \text{ given} $$
///
/// No direct feedthrough, so it breaks an algebraic loop. Takes signals of every kind, vectors element by element. With `reset`
/// an edge of the extra input `reset` makes the output of this sample `x0`; this input does reach the output at once.
///
/// ```ron
/// UnitDelay(ts: "1 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("z⁻¹"))]
pub struct UnitDelay {
    /// Sample time, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Output at the first sample, in the unit of the input. A list gives each element its own.
    #[block(finite, default = 0.0.into())]
    pub x0: Entries,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set the state back: `None`
    /// (there is no such input), `Rising`, `Falling`, `Either`; with `Level` it is set back at each sample at which the
    /// input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

impl Block for UnitDelay {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees_as_written(self.x0.written(given, "x0"), "x0", "u", u.dimension)?;
        let shape = given.common_shape(&["u"], &[self.x0.shape])?;
        let y = Output::like("y", u.shaped(shape));
        let interface = Interface::new().input(Input::any("u"));
        let interface = self.reset.input().into_iter().fold(interface, Interface::input).output(y);
        let interface =
            (0..shape.len()).fold(interface, |all, i| all.discrete(format!("x[{i}]"), self.x0.at(i)));
        let interface =
            if self.reset == Reset::None { interface } else { interface.discrete("trigger", UNSEEN) };
        Ok(interface.sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        let fires = self.reset.sampled(l, n, 1);
        for i in 0..n {
            let x = l.d()[i];
            l.set(0, i, fires.map_or(x, |(fires, _)| fires.select(l.constant(self.x0.at(i)), x)));
            l.update(i, l.element(0, i));
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

    fn delay(x0: f64) -> UnitDelay {
        UnitDelay { ts: 0.1, x0: x0.into(), reset: Reset::None }
    }

    #[test]
    fn a_reset_gives_the_start_values_for_one_sample() {
        let x0 = Entries::try_from(vec![7.0, 8.0]).unwrap();
        let block = UnitDelay { x0, reset: Reset::Rising, ..delay(0.0) };
        let inputs = vec![("u".to_owned(), PortType::scalar()), ("reset".to_owned(), PortType::boolean())];
        let mut bench = Bench::with_inputs(block, inputs);
        for (u, reset, y) in
            [(1.0, 0.0, [7.0, 8.0]), (2.0, 0.0, [1.0; 2]), (3.0, 1.0, [7.0, 8.0]), (4.0, 1.0, [3.0; 2])]
        {
            assert_eq!(bench.set(0, &[u]).set(1, &[reset]).hit(), y);
        }
        assert!(!bench.interface.reads(0, 0) && bench.interface.reads(0, 1));
    }

    #[test]
    fn each_sample_comes_out_one_later() {
        let mut bench = Bench::new(delay(-1.0));
        for (u, y) in [(1.0, -1.0), (2.0, 1.0), (3.0, 2.0)] {
            assert_eq!(bench.set(0, &[u]).hit(), [y]);
        }
        assert!(!bench.interface.reads(0, 0));
    }

    #[test]
    fn a_vector_of_truth_values_stays_one() {
        let bools = PortType { shape: Shape::Vector(2), ..PortType::boolean() };
        let mut bench = Bench::with_inputs(delay(0.0), vec![("u".to_owned(), bools)]);
        assert_eq!(bench.interface.outputs[0].port_type, bools);
        bench.set(0, &[1.0, 0.0]).hit();
        assert_eq!(bench.hit(), [1.0, 0.0]);
    }

    #[test]
    fn the_unit_stays_and_a_sample_time_of_zero_is_refused() {
        let block = UnitDelay { ts: 0.0, ..delay(0.0) };
        assert_eq!(output_unit(&block, &[("u", "V")], &[("x0", "V")]), "V");
        assert_eq!(block.errors()[0].param, "ts");
    }
}
