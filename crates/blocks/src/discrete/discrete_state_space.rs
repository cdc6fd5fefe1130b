use blocksim_block::prelude::*;

use crate::continuous::reset::{Reset, UNSEEN};
use crate::continuous::state_space::{column, fit};

/// Linear sampled system in state space.
///
/// $$ x_{k+1} = A x_k + B u_k, \qquad y_k = C x_k + D u_k, \qquad x_0 \text{ given} $$
///
/// Matrices are lists of rows. `a` has as many rows and columns as there are states, `b` a column for each input,
/// `c` a row for each output, `d` a row for each output and a column for each input. `u` and `y` are vectors; with
/// one column in `b` or one row in `c` they are scalars. The input reaches the output at the same sample only if `d` is not
/// zero. With `reset` an edge of the extra input `reset` makes $x_k = x_0$ before the output of this sample. The unit of the
/// output is unknown, for the matrices may mix units.
///
/// ```ron
/// DiscreteStateSpace(ts: "10 ms", a: [[1.0, 0.01], [-0.25, 0.97]], b: [[0.0], [0.25]], c: [[1.0, 0.0]])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Lines("x⁺ = A x + B u","y = C x + D u"))]
pub struct DiscreteStateSpace {
    /// Sample time, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// System matrix, states by states.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]")]
    pub a: Vec<Vec<f64>>,
    /// Input matrix, states by inputs.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]")]
    pub b: Vec<Vec<f64>>,
    /// Output matrix, outputs by states.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]")]
    pub c: Vec<Vec<f64>>,
    /// Feedthrough, outputs by inputs; empty means zero.
    #[block(difference, finite, default = Vec::new())]
    pub d: Vec<Vec<f64>>,
    /// States at the start and after a reset; empty means zero.
    #[block(finite, default = Vec::new())]
    pub x0: Vec<f64>,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set the states back to
    /// `x0`: `None` (there is no such input), `Rising`, `Falling`, `Either`; with `Level` they are set back at each sample
    /// at which the input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

impl DiscreteStateSpace {
    fn inputs(&self) -> usize {
        self.b.first().map_or(0, Vec::len)
    }

    fn feeds_through(&self) -> bool {
        self.d.iter().flatten().any(|d| *d != 0.0)
    }

    fn start(&self, i: usize) -> f64 {
        self.x0.get(i).copied().unwrap_or(0.0)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        fit([&self.a, &self.b, &self.c, &self.d], &self.x0, errors);
    }
}

impl Block for DiscreteStateSpace {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let y = Output::like("y", PortType::UNKNOWN.shaped(column(self.c.len())));
        let mut interface = Interface::new().input(Input::real("u").shape(column(self.inputs())));
        interface = self.reset.input().into_iter().fold(interface, Interface::input).output(y);
        for i in 0..self.a.len() {
            interface = interface.discrete(format!("x{}", i + 1), self.start(i));
        }
        let interface =
            if self.reset == Reset::None { interface } else { interface.discrete("trigger", UNSEEN) };
        Ok(interface.sampled(self.ts))
    }

    fn law(&self, l: &Recording) -> bool {
        let n = self.a.len();
        let fires = self.reset.sampled(l, n, 1);
        let start = |(i, x)| match fires {
            Some((fires, _)) => fires.select(l.constant(self.start(i)), x),
            None => x,
        };
        let x: Vec<Value> = l.d()[..n].iter().copied().enumerate().map(start).collect();
        let u = l.input(0);
        for (i, c) in self.c.iter().enumerate() {
            let free = l.dot(c, &x);
            l.set(0, i, if self.feeds_through() { free + l.dot(&self.d[i], u) } else { free });
        }
        for (i, (a, b)) in self.a.iter().zip(&self.b).enumerate() {
            l.update(i, l.dot(a, &x) + l.dot(b, u));
        }
        fires.into_iter().for_each(|(_, next)| l.update(n, next));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn rotation(angle: f64) -> DiscreteStateSpace {
        let (sin, cos) = angle.sin_cos();
        DiscreteStateSpace {
            ts: 0.1,
            a: vec![vec![cos, -sin], vec![sin, cos]],
            b: vec![vec![0.0], vec![0.0]],
            c: vec![vec![1.0, 0.0], vec![0.0, 1.0]],
            d: Vec::new(),
            x0: vec![1.0, 0.0],
            reset: Reset::None,
        }
    }

    #[test]
    fn powers_of_a_rotation_are_rotations() {
        let mut bench = Bench::new(rotation(0.3));
        for k in 0..50 {
            let (sin, cos) = (0.3 * f64::from(k)).sin_cos();
            let y = bench.hit();
            assert!((y[0] - cos).abs() < 1e-14 && (y[1] - sin).abs() < 1e-14, "{k}: {y:?}");
        }
        assert!(!bench.interface.reads(0, 0));
    }

    #[test]
    fn the_response_is_that_of_the_difference_equation_and_a_reset_begins_it_anew() {
        // x_{k+1} = 0.5 x_k + (1 2) u_k, y_k = 3 x_k + (4 0) u_k.
        let block = DiscreteStateSpace {
            a: vec![vec![0.5]],
            b: vec![vec![1.0, 2.0]],
            c: vec![vec![3.0]],
            d: vec![vec![4.0, 0.0]],
            x0: vec![-1.0],
            reset: Reset::Falling,
            ..rotation(0.0)
        };
        let inputs = vec![("u".to_owned(), PortType::vector(2)), ("reset".to_owned(), PortType::boolean())];
        let mut bench = Bench::with_inputs(block, inputs);
        let mut x = -1.0;
        for k in 0..20 {
            let (u, reset) = ([f64::from(k), 1.0 - f64::from(k % 4)], f64::from(u8::from(k < 7)));
            if k == 7 {
                x = -1.0;
            }
            assert_eq!(bench.set(0, &u).set(1, &[reset]).hit(), [3.0 * x + 4.0 * u[0]], "{k}");
            x = 0.5 * x + (u[0] + 2.0 * u[1]);
        }
        assert!(bench.interface.reads(0, 0) && bench.interface.reads(0, 1));
    }

    #[test]
    fn matrices_that_do_not_fit_are_refused() {
        for (block, param) in [
            (DiscreteStateSpace { a: vec![], ..rotation(0.0) }, "a"),
            (DiscreteStateSpace { b: vec![vec![1.0]], ..rotation(0.0) }, "b"),
            (DiscreteStateSpace { x0: vec![1.0], ..rotation(0.0) }, "x0"),
            (DiscreteStateSpace { ts: 0.0, ..rotation(0.0) }, "ts"),
        ] {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
