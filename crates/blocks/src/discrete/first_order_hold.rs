use blocksim_block::prelude::*;

use crate::continuous::units::{agrees_as_written, element};
use crate::math::Entries;

/// Joins samples by straight lines: a first-order hold, delayed by one sample.
///
/// $$ y(t) = u_{k-1} + (u_k - u_{k-1}) \frac{t - t_k}{T_s}, \qquad t_k \le t \le t_{k+1}, \qquad u_{-1} = x_0 $$
///
/// The output is continuous and reaches each sample one sample time after it was taken; nothing is extrapolated. It makes a smooth
/// course of set points that come at a slow rate. No direct feedthrough. Vectors element by element. In a subsystem that pauses, the
/// line stops meanwhile.
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

/// What is as near as this to the end of a line, as a part of it, is there but for rounding.
const ROUNDED: f64 = 1e-11;

impl Block for FirstOrderHold {
    /// Discrete states: where the line begins and ends, element by element, and when it began.
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees_as_written(self.x0.written(given, "x0"), "x0", "u", u.dimension)?;
        let shape = given.common_shape(&["u"], &[self.x0.shape])?;
        let y = Output::like("y", u.shaped(shape));
        let mut interface = Interface::new().input(Input::real("u")).output(y);
        for name in ["from", "to"] {
            let first = interface.discrete.len();
            interface = interface.memory(name, shape.len(), 0.0);
            interface.discrete[first..]
                .iter_mut()
                .enumerate()
                .for_each(|(i, cell)| cell.initial = self.x0.at(i));
        }
        // At the start the line before is at its end.
        Ok(interface.discrete("since", -self.ts).sampled(self.ts).uses_time())
    }

    /// A line is a weighted mean of both samples, which is linear in them wherever it is. Both ends are met to the last digit: what
    /// holds a value must not wander about it.
    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        let (t, since) = (l.time(), l.d()[2 * n]);
        // A late time has fewer digits for what is left of a line.
        let left = since + self.ts - t;
        let is_over = left.live(Relation::LessEqual, ROUNDED * self.ts + 4.0 * f64::EPSILON * t.abs());
        let share = is_over.select(l.constant(1.0), (t - since) / self.ts);
        let is_near = share.live(Relation::GreaterEqual, l.constant(0.5));
        for i in 0..n {
            let [from, to] = [i, n + i].map(|cell| l.d()[cell]);
            let way = to - from;
            let y = is_near.select(to - way * (1.0 - share), from + way * share);
            l.set(0, i, y);
            // In a subsystem that pauses a hit may come before the line is at its end: the next one begins where this one has got to.
            l.update(i, y);
            l.update(n + i, l.element(0, i));
        }
        l.update(2 * n, t);
        true
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        let n = d.len() / 2;
        d[..2 * n].iter_mut().enumerate().for_each(|(i, d)| *d = element(c.input(0), i % n.max(1)));
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

    /// Rounding must not take it past a sample, or keep it from standing on one.
    #[test]
    fn what_is_held_is_the_sample_to_the_last_digit() {
        let mut bench = Bench::new(FirstOrderHold { ts: 0.05, x0: 0.0.into() });
        for u in [1.478, 0.0, 0.0, 0.3, 0.3, 0.3, -0.1, 0.0, 0.0] {
            let before = bench.d[1];
            bench.set(0, &[u]).hit();
            for _ in 0..7 {
                let y = bench.integrate(0.05 / 7.0, 1).minor()[0];
                assert!(
                    if u == before { y == u } else { y >= u.min(before) && y <= u.max(before) },
                    "{y} for {u}"
                );
            }
        }
    }

    #[test]
    fn the_unit_stays() {
        let block = FirstOrderHold { ts: 0.5, x0: 0.0.into() };
        assert_eq!(output_unit(&block, &[("u", "V")], &[]), "V");
        assert_eq!(FirstOrderHold { ts: f64::NAN, ..block }.errors()[0].param, "ts");
    }
}
