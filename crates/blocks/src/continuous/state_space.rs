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
    /// States at the start; empty means zero.
    #[block(finite, default = Vec::new())]
    pub x0: Vec<f64>,
}

impl StateSpace {
    fn inputs(&self) -> usize {
        self.b.first().map_or(0, Vec::len)
    }

    fn feeds_through(&self) -> bool {
        self.d.iter().flatten().any(|d| *d != 0.0)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        fit([&self.a, &self.b, &self.c, &self.d], &self.x0, errors);
    }
}

/// A scalar where one number will do.
pub(crate) fn column(n: usize) -> Shape {
    if n == 1 { Shape::Scalar } else { Shape::Vector(n) }
}

/// Reports a matrix that has other rows or columns; `why` says where these come from, `from` are the matrices that they come from.
pub(crate) fn sized(
    (name, m): (&str, &[Vec<f64>]),
    (rows, columns): (usize, usize),
    (why, from): (&str, &[&str]),
    errors: &mut ParamErrors,
) {
    let mut wrong = |param: String, message: String| {
        let error = ParamError::new(param, message).beside(from);
        errors.add(error.help(format!("make `{name}` {rows}x{columns}: {why}")));
    };
    if m.len() != rows {
        return wrong(name.to_owned(), format!("`{name}` has {} rows, but {rows} are needed", m.len()));
    }
    if let Some((i, row)) = m.iter().enumerate().find(|(_, row)| row.len() != columns) {
        let message = format!("row {i} of `{name}` has {} columns, but {columns} are needed", row.len());
        wrong(format!("{name}[{i}]"), message);
    }
}

/// Reports matrices of a system with states that do not fit each other, and initial values that do not fit them.
pub(crate) fn fit([a, b, c, d]: [&[Vec<f64>]; 4], x0: &[f64], errors: &mut ParamErrors) {
    let (states, inputs, outputs) = (a.len(), b.first().map_or(0, Vec::len), c.len());
    sized(("a", a), (states, states), ("it is square, a row for each state", &[]), errors);
    if inputs == 0 {
        errors.add(ParamError::new("b", "`b` is empty").help("give it a column for each input"));
    }
    let why = "a row for each row of `a`, a column for each input";
    sized(("b", b), (states, inputs), (why, &["a"]), errors);
    let why = "a row for each output, a column for each row of `a`";
    sized(("c", c), (outputs, states), (why, &["a"]), errors);
    if !d.is_empty() {
        let why = "a row for each row of `c`, a column for each column of `b`";
        sized(("d", d), (outputs, inputs), (why, &["b", "c"]), errors);
    }
    initial(x0, (states, "a"), errors);
}

/// Reports initial values that are neither one for each row of a matrix nor none.
pub(crate) fn initial(x0: &[f64], (rows, of): (usize, &str), errors: &mut ParamErrors) {
    if !x0.is_empty() && x0.len() != rows {
        let message = format!("`x0` has {} values, but `{of}` has {rows} rows", x0.len());
        errors
            .add(ParamError::new("x0", message).beside(&[of]).help("give one value for each state, or none"));
    }
}

pub(super) fn dot(row: &[f64], v: &[f64]) -> f64 {
    row.iter().zip(v).map(|(m, v)| m * v).sum()
}

impl Block for StateSpace {
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
            let error = block.errors()[0].clone();
            assert_eq!(error.param, param);
            assert!(error.help.unwrap().contains(size), "{param}");
        }
        assert_eq!(StateSpace { x0: vec![1.0], ..oscillator() }.errors()[0].param, "x0");
        assert_eq!(StateSpace { a: Vec::new(), ..oscillator() }.errors()[0].param, "a");
        let block = StateSpace { b: matrix(&[[0.0], [f64::NAN]]), ..oscillator() };
        assert_eq!(block.errors()[0].param, "b[1][0]");
    }
}
