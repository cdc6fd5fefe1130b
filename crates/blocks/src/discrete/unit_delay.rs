use blocksim_block::prelude::*;

use crate::continuous::units::agrees;

/// Delays by one sample: $y_k = u_{k-1}$.
///
/// $$ y_k = x_k, \qquad x_{k+1} = u_k, \qquad x_0 \text{ given} $$
///
/// No direct feedthrough, so it breaks an algebraic loop. Takes signals of every kind, vectors element by element.
///
/// ```ron
/// UnitDelay(ts: "1 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("z⁻¹"))]
pub struct UnitDelay {
    /// Sample time, positive.
    #[block(unit = "s")]
    pub ts: f64,
    /// Output at the first sample, in the unit of the input.
    #[block(default = 0.0)]
    pub x0: f64,
}

impl Block for UnitDelay {
    fn check(&self) -> Result<(), ParamError> {
        positive("ts", self.ts)?;
        finite("x0", self.x0)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "x0", "u", u.dimension)?;
        Ok(Interface::new()
            .input(Input::any("u"))
            .output_from_state(Output::like("y", u))
            .memory("x", u.shape.len(), self.x0)
            .sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            l.set(0, i, l.d()[i]);
            l.update(i, l.element(0, i));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::output_unit;
    use blocksim_block::testing::Bench;

    #[test]
    fn each_sample_comes_out_one_later() {
        let mut bench = Bench::new(UnitDelay { ts: 0.1, x0: -1.0 });
        for (u, y) in [(1.0, -1.0), (2.0, 1.0), (3.0, 2.0)] {
            assert_eq!(bench.set(0, &[u]).hit(), [y]);
        }
        assert!(!bench.interface.reads(0, 0));
    }

    #[test]
    fn a_vector_of_truth_values_stays_one() {
        let bools = PortType { shape: Shape::Vector(2), ..PortType::boolean() };
        let mut bench = Bench::with_inputs(UnitDelay { ts: 0.1, x0: 0.0 }, vec![("u".to_owned(), bools)]);
        assert_eq!(bench.interface.outputs[0].port_type, bools);
        bench.set(0, &[1.0, 0.0]).hit();
        assert_eq!(bench.hit(), [1.0, 0.0]);
    }

    #[test]
    fn the_unit_stays_and_a_sample_time_of_zero_is_refused() {
        let block = UnitDelay { ts: 0.0, x0: 0.0 };
        assert_eq!(output_unit(&block, &[("u", "V")], &[("x0", "V")]), "V");
        assert_eq!(block.check().unwrap_err().param, "ts");
    }
}
