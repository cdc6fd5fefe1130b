use blocksim_block::prelude::*;

use crate::continuous::units::agrees_as_written;
use crate::math::Entries;
use crate::math::elements::at;

/// Gives its input as it was at the last major step of the solver.
///
/// Between two steps the output stands still; at the start it is `x0`. How old it is depends on the steps that the solver makes, so
/// a result that depends on it does so, too. A `UnitDelay` has a sample time of its own; an algebraic loop is best left to the
/// solver, which finds its solution. Takes signals of every kind, vectors element by element. No direct feedthrough.
///
/// ```ron
/// Memory
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Text("u⁻"))]
pub struct Memory {
    /// Output at the start, in the unit of the input. A list gives each element its own.
    #[block(finite, default = 0.0.into())]
    pub x0: Entries,
}

impl Block for Memory {
    /// Discrete states: what is given, then the input at the present major step.
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees_as_written(self.x0.written(given, "x0"), "x0", "u", u.dimension)?;
        let shape = given.common_shape(&["u"], &[self.x0.shape])?;
        let mut interface =
            Interface::new().input(Input::any("u")).output(Output::like("y", u.shaped(shape)));
        for name in ["y", "u"] {
            for i in 0..shape.len() {
                interface = interface.discrete(format!("{name}[{i}]"), self.x0.at(i));
            }
        }
        Ok(interface.accepts().jumps().jump_called(""))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| l.d()[i]);
        true
    }

    /// Nothing jumps here: it is the one function that is called at every major step with all inputs known.
    fn jump(&self, c: &Context, _w: &mut Scratch, _x: &mut [f64], d: &mut [f64]) -> bool {
        let n = d.len() / 2;
        d[n..].iter_mut().enumerate().for_each(|(i, u)| *u = at(c.input(0), i));
        false
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        let n = d.len() / 2;
        d.iter_mut().enumerate().for_each(|(i, d)| *d = at(c.input(0), i % n.max(1)));
        true
    }

    fn accept(&self, _c: &Context, d: &mut [f64]) -> bool {
        let (y, u) = d.split_at_mut(d.len() / 2);
        let changed = y != u;
        y.copy_from_slice(u);
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::vector;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_output_is_the_input_at_the_step_before() {
        let x0 = Entries::try_from(vec![-1.0, -2.0]).unwrap();
        let mut bench = Bench::with_inputs(Memory { x0 }, vector("u", 2));
        let mut before = vec![-1.0, -2.0];
        for (k, t) in [0.0, 0.1, 0.15, 0.4].into_iter().enumerate() {
            if k > 0 {
                bench.t = t;
                bench.accept();
            }
            // A repeated look at the same time changes nothing.
            for _ in 0..2 {
                assert_eq!(bench.set(0, &[t, t * t + 1.0]).major(), before);
            }
            before = vec![t, t * t + 1.0];
        }
        assert!(!bench.interface.reads(0, 0));
    }
}
