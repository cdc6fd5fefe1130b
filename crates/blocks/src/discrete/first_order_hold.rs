use blocksim_block::prelude::*;

use crate::continuous::units::agrees_as_written;
use crate::math::Entries;

/// Joins samples by straight lines: a first-order hold, delayed by one sample.
///
/// $$ y(t) = u_{k-1} + (u_k - u_{k-1}) \frac{t - t_k}{T_s}, \qquad t_k \le t \le t_{k+1}, \qquad u_{-1} = x_0 $$
///
/// The output is continuous and reaches each sample one sample time after it was taken; nothing is extrapolated. It makes a smooth
/// course of set points that come at a slow rate. No direct feedthrough. Vectors element by element.
///
/// ```ron
/// FirstOrderHold(ts: "50 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Curve(Table))]
pub struct FirstOrderHold {
    /// Sample time $T_s$, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Output at the start, in the unit of the input. A list gives each element its own.
    #[block(finite, default = 0.0.into())]
    pub x0: Entries,
}

impl Block for FirstOrderHold {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees_as_written(self.x0.written(given, "x0"), "x0", "u", u.dimension)?;
        let shape = given.common_shape(&["u"], &[self.x0.shape])?;
        let y = Output::like("y", u.shaped(shape));
        let mut interface = Interface::new().input(Input::real("u")).output(y);
        for i in 0..shape.len() {
            interface = interface.state_in("x", self.x0.at(i), u.dimension);
        }
        Ok(interface.memory("slope", shape.len(), 0.0).sampled(self.ts))
    }

    /// The slope leads from where the output is, so rounding does not add up.
    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            let (x, slope) = (l.x()[i], l.d()[i]);
            l.set(0, i, x);
            l.derive(i, slope);
            l.update(i, (l.element(0, i) - x) / self.ts);
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
    fn samples_are_joined_by_lines_one_sample_late() {
        let samples: [f64; 5] = [3.0, -1.0, 4.0, 4.0, 0.5];
        let mut bench = Bench::new(FirstOrderHold { ts: 0.5, x0: 1.0.into() });
        let mut before = 1.0;
        for u in samples {
            assert!((bench.set(0, &[u]).hit()[0] - before).abs() < 1e-14);
            for share in [0.25, 0.5, 0.75, 1.0] {
                let y = bench.integrate(0.125, 1).minor()[0];
                assert!((y - (before + (u - before) * share)).abs() < 1e-14, "{y}");
            }
            before = u;
        }
        assert!(!bench.interface.reads(0, 0));
    }

    #[test]
    fn the_unit_stays() {
        let block = FirstOrderHold { ts: 0.5, x0: 0.0.into() };
        assert_eq!(output_unit(&block, &[("u", "V")], &[]), "V");
        assert_eq!(FirstOrderHold { ts: f64::NAN, ..block }.errors()[0].param, "ts");
    }
}
