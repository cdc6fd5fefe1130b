use blocksim_block::prelude::*;

/// Linear system in state space.
///
/// $$ \dot x = A x + B u, \qquad y = C x + D u, \qquad x(0) = x_0 $$
///
/// Matrices are lists of rows. `a` has as many rows and columns as there are states, `b` a column for each input,
/// `c` a row for each output, `d` a row for each output and a column for each input. `u` and `y` are vectors; with
/// one column in `b` or one row in `c` they are scalars. The input reaches the output at once only if `d` is not
/// zero. The unit of the output is unknown, for the matrices may mix units.
///
/// ```ron
/// StateSpace(a: [[0.0, 1.0], [-25.0, -3.0]], b: [[0.0], [25.0]], c: [[1.0, 0.0]])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Lines("ẋ = A x + B u","y = C x + D u"))]
pub struct StateSpace {
    /// System matrix, states by states.
    pub a: Vec<Vec<f64>>,
    /// Input matrix, states by inputs.
    pub b: Vec<Vec<f64>>,
    /// Output matrix, outputs by states.
    pub c: Vec<Vec<f64>>,
    /// Feedthrough, outputs by inputs; empty means zero.
    #[block(default = Vec::new())]
    pub d: Vec<Vec<f64>>,
    /// States at the start; empty means zero.
    #[block(default = Vec::new())]
    pub x0: Vec<f64>,
}

impl StateSpace {
    fn inputs(&self) -> usize {
        self.b.first().map_or(0, Vec::len)
    }

    fn feeds_through(&self) -> bool {
        self.d.iter().flatten().any(|d| *d != 0.0)
    }
}

/// A scalar where one number will do.
pub(crate) fn column(n: usize) -> Shape {
    if n == 1 { Shape::Scalar } else { Shape::Vector(n) }
}

/// Rows and columns must be these; `why` says where they come from.
pub(crate) fn sized(
    name: &str,
    m: &[Vec<f64>],
    rows: usize,
    columns: usize,
    why: &str,
) -> Result<(), ParamError> {
    let wrong = |param: String, message: String| {
        Err(ParamError::new(param, message).help(format!("make `{name}` {rows}x{columns}: {why}")))
    };
    if m.len() != rows {
        return wrong(name.to_owned(), format!("`{name}` has {} rows, but {rows} are needed", m.len()));
    }
    for (i, row) in m.iter().enumerate() {
        if row.len() != columns {
            let message = format!("row {i} of `{name}` has {} columns, but {columns} are needed", row.len());
            return wrong(format!("{name}[{i}]"), message);
        }
        for (j, value) in row.iter().enumerate() {
            finite(&format!("{name}[{i}][{j}]"), *value)?;
        }
    }
    Ok(())
}

/// Initial values must be one for each row of a matrix, or none.
pub(crate) fn initial(x0: &[f64], rows: usize, of: &str) -> Result<(), ParamError> {
    if !x0.is_empty() && x0.len() != rows {
        let message = format!("`x0` has {} values, but `{of}` has {rows} rows", x0.len());
        return Err(ParamError::new("x0", message).help("give one value for each state, or none"));
    }
    x0.iter().enumerate().try_for_each(|(i, x0)| finite(&format!("x0[{i}]"), *x0))
}

pub(super) fn dot(row: &[f64], v: &[f64]) -> f64 {
    row.iter().zip(v).map(|(m, v)| m * v).sum()
}

impl Block for StateSpace {
    fn check(&self) -> Result<(), ParamError> {
        let (states, inputs, outputs) = (self.a.len(), self.inputs(), self.c.len());
        for (name, n) in [("a", states), ("b", inputs), ("c", outputs)] {
            if n == 0 {
                return Err(ParamError::new(name, format!("`{name}` is empty"))
                    .help("give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]"));
            }
        }
        sized("a", &self.a, states, states, "it is square, a row for each state")?;
        sized("b", &self.b, states, inputs, "a row for each row of `a`, a column for each input")?;
        sized("c", &self.c, outputs, states, "a row for each output, a column for each row of `a`")?;
        if !self.d.is_empty() {
            sized(
                "d",
                &self.d,
                outputs,
                inputs,
                "a row for each row of `c`, a column for each column of `b`",
            )?;
        }
        initial(&self.x0, states, "a")
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let y = Output::like("y", PortType::UNKNOWN.shaped(column(self.c.len())));
        let interface = Interface::new().input(Input::real("u").shape(column(self.inputs())));
        let mut interface = interface.output(y);
        for i in 0..self.a.len() {
            interface = interface.state(format!("x{}", i + 1), self.x0.get(i).copied().unwrap_or(0.0));
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        let (x, u) = (l.x(), l.input(0));
        for (i, c) in self.c.iter().enumerate() {
            let free = l.dot(c, x);
            let y = if self.feeds_through() { free + l.dot(&self.d[i], u) } else { free };
            l.set(0, i, y);
        }
        for (i, (a, b)) in self.a.iter().zip(&self.b).enumerate() {
            l.derive(i, l.dot(a, x) + l.dot(b, u));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn matrix<const N: usize>(rows: &[[f64; N]]) -> Vec<Vec<f64>> {
        rows.iter().map(|row| row.to_vec()).collect()
    }

    fn oscillator() -> StateSpace {
        StateSpace {
            a: matrix(&[[0.0, 2.0], [-2.0, 0.0]]),
            b: matrix(&[[0.0], [0.0]]),
            c: matrix(&[[1.0, 0.0], [0.0, 1.0]]),
            d: Vec::new(),
            x0: vec![1.0, 0.0],
        }
    }

    #[test]
    fn an_oscillator_turns_on_a_circle() {
        let mut bench = Bench::new(oscillator());
        bench.integrate(1.0, 1000);
        let y = bench.minor();
        assert!((y[0] - 2.0_f64.cos()).abs() < 1e-11 && (y[1] + 2.0_f64.sin()).abs() < 1e-11, "{y:?}");
    }

    #[test]
    fn inputs_and_outputs_may_be_vectors() {
        // Two decays crossed at the output, with feedthrough from the second input to the first output.
        let block = StateSpace {
            a: matrix(&[[-1.0, 0.0], [0.0, -2.0]]),
            b: matrix(&[[1.0, 0.0], [0.0, 4.0]]),
            c: matrix(&[[0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]),
            d: matrix(&[[0.0, 10.0], [0.0, 0.0], [0.0, 0.0]]),
            x0: Vec::new(),
        };
        let mut bench = Bench::new(block);
        bench.set(0, &[1.0, 0.5]).integrate(1.0, 1000);
        let (first, second) = (1.0 - (-1.0_f64).exp(), 1.0 - (-2.0_f64).exp());
        for (y, expected) in bench.minor().iter().zip([second + 5.0, first, first + second]) {
            assert!((y - expected).abs() < 1e-11, "{y} != {expected}");
        }
        assert!(bench.interface.reads(0, 0));
    }

    #[test]
    fn a_feedthrough_of_zeros_breaks_loops() {
        let block = StateSpace { d: matrix(&[[0.0], [0.0]]), ..oscillator() };
        let interface = Bench::new(block).interface;
        assert!(!interface.reads(0, 0));
        assert_eq!(interface.inputs[0].shape, Some(Shape::Scalar));
        assert_eq!(interface.outputs[0].port_type.shape, Shape::Vector(2));
    }

    #[test]
    fn matrices_that_do_not_fit_are_named_with_their_size() {
        let refused = [
            (StateSpace { a: matrix(&[[0.0, 1.0]]), ..oscillator() }, "a[0]", "1x1"),
            (StateSpace { b: matrix(&[[0.0]]), ..oscillator() }, "b", "2x1"),
            (StateSpace { c: matrix(&[[1.0]]), ..oscillator() }, "c[0]", "1x2"),
            (StateSpace { d: matrix(&[[0.0, 0.0], [0.0, 0.0]]), ..oscillator() }, "d[0]", "2x1"),
        ];
        for (block, param, size) in refused {
            let error = block.check().unwrap_err();
            assert_eq!(error.param, param);
            assert!(error.help.unwrap().contains(size), "{param}");
        }
        assert_eq!(StateSpace { x0: vec![1.0], ..oscillator() }.check().unwrap_err().param, "x0");
        assert_eq!(StateSpace { a: Vec::new(), ..oscillator() }.check().unwrap_err().param, "a");
        let block = StateSpace { b: matrix(&[[0.0], [f64::NAN]]), ..oscillator() };
        assert_eq!(block.check().unwrap_err().param, "b[1][0]");
    }
}
