use blocksim_block::prelude::*;
use nalgebra::DMatrix;

use super::descriptor::{Reduction, matrix, undecided};
use super::state_space::{column, initial, sized};

/// Integrator with a constant mass matrix, which may be singular.
///
/// $$ M \dot y = u, \qquad y(0) = x_0 $$
///
/// With $u = f(t, y)$ fed back this is the usual form of a system of differential and algebraic equations (DAE): rows
/// of `m` that are zero, or combinations of other rows, are constraints. It must be of index 1: $u$ depends at once on
/// those $y$ that no derivative determines, and moves with them. Index 2 or more ends the run with an error; put a
/// constraint that has been differentiated in the place of the original one.
///
/// A singular `m` is reduced once: $Q^T M P = (R_1\ R_2;\ 0\ 0)$ by a QR factorisation with exchange of columns, rows
/// and columns scaled to like sizes before. States are $w = x_1 + T z$ with $T = R_1^{-1} R_2$; the rest, $z$, is found at every
/// instant so that the last rows of $Q^T u$ are zero. The states and the search for $z$ begin at `x0`:
/// $M y$ at the start is kept, and the rest is made to fit. All methods of integration can be used.
///
/// ```ron
/// MassMatrixIntegrator(m: [[1.0, 0.0], [0.0, 0.0]], x0: [1.0, 0.5])
/// ```
///
/// Source: E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section VI.1 (state space form method).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Lines("M ẏ = u", ""), builds = Reduced)]
pub struct MassMatrixIntegrator {
    /// Mass matrix, a list of rows.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[1.0, 0.0], [0.0, 0.0]]")]
    pub m: Vec<Vec<f64>>,
    /// Output at the start, one value for each row; empty means zero.
    #[block(finite, default = Vec::new())]
    pub x0: Vec<f64>,
}

/// The integrator with what follows from its mass matrix.
#[derive(Debug, Clone)]
pub struct Reduced {
    reduction: Reduction,
    x0: Vec<f64>,
}

impl MassMatrixIntegrator {
    fn validate(&self, errors: &mut ParamErrors) {
        let n = self.m.len();
        sized(("m", &self.m), (n, n), ("it is square, a row for each derivative", &[]), errors);
        initial(&self.x0, (n, "m"), errors);
    }

    fn build(self, errors: &mut ParamErrors) -> Option<Reduced> {
        let n = self.m.len();
        let reduction = Reduction::new(matrix(&self.m, n)).map_err(|share| undecided("m", share));
        let reduction = errors.take(reduction)?;
        if reduction.states() == 0 {
            errors.add(
                ParamError::new("m", "`m` is zero, so there is nothing to integrate")
                    .help("use AlgebraicConstraint for equations without derivatives"),
            );
        }
        Some(Reduced { reduction, x0: if self.x0.is_empty() { vec![0.0; n] } else { self.x0 } })
    }
}

impl Block for Reduced {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let Self { reduction: found, x0 } = self;
        let n = x0.len();
        let y = Output::like("y", PortType::UNKNOWN.shaped(column(n)));
        let interface = Interface::new().input(Input::real("u").shape(column(n)));
        if let Some(u) = given.input("u").filter(|u| u.shape.len() != n) {
            let message = format!("`u` is a {}, but `m` has {n} rows", u.shape);
            return Err(InterfaceError::types(&["u"], message).help("join one signal for each row with Mux"));
        }
        let mut interface = if found.constraints() == 0 {
            interface.output_from_state(y)
        } else {
            interface.output_sought(y, found.algebraic().iter().map(|&place| (place, x0[place])).collect())
        };
        for (i, state) in found.states_of(x0).into_iter().enumerate() {
            interface = interface.state(found.name(i), state);
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        let found = &self.reduction;
        let rows = |m: &DMatrix<f64>| -> Vec<Vec<f64>> {
            m.row_iter().map(|row| row.iter().copied().collect()).collect()
        };
        let unknowns: Vec<Value> = found.algebraic().iter().filter_map(|&place| l.unknown(place)).collect();
        for ((&place, x), t) in found.order.iter().zip(l.x()).zip(rows(&found.t)) {
            l.set(0, place, if unknowns.is_empty() { *x } else { *x - l.dot(&t, &unknowns) });
        }
        rows(&found.f).iter().enumerate().for_each(|(i, f)| l.derive(i, l.dot(f, l.input(0))));
        rows(&found.g).iter().enumerate().for_each(|(i, g)| l.rest(i, l.dot(g, l.input(0))));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn block(m: &[&[f64]], x0: &[f64]) -> MassMatrixIntegrator {
        let m = m.iter().map(|row| row.to_vec()).collect();
        MassMatrixIntegrator { m, x0: x0.to_vec() }
    }

    #[test]
    fn a_regular_mass_matrix_is_divided_by() {
        // 2 x' + y' = 1, x' + y' = 3: x' = -2, y' = 5.
        let mut bench = Bench::with_inputs(
            block(&[&[2.0, 1.0], &[1.0, 1.0]], &[1.0, 0.0]),
            vec![("u".to_owned(), PortType::vector(2))],
        );
        assert!(bench.interface.constraint.is_none());
        bench.set(0, &[1.0, 3.0]).integrate(1.0, 10);
        let y = bench.minor();
        assert!((y[0] + 1.0).abs() < 1e-12 && (y[1] - 5.0).abs() < 1e-12, "{y:?}");
    }

    #[test]
    fn a_singular_mass_matrix_has_constraints_and_fewer_states() {
        let interface =
            block(&[&[1.0, -1.0], &[-1.0, 1.0]], &[3.0, 1.0]).built().interface(&Given::nothing()).unwrap();
        assert_eq!(interface.states.len(), 1);
        assert_eq!(interface.states[0].initial.abs(), 2.0);
        assert_eq!(interface.constraint.unwrap().unknowns.len(), 1);
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        let refused = |m: &[&[f64]], x0: &[f64]| block(m, x0).try_build().unwrap_err()[0].clone();
        assert_eq!(refused(&[], &[]).param, "m");
        assert_eq!(refused(&[&[1.0, 0.0]], &[]).param, "m[0]");
        assert_eq!(refused(&[&[1.0]], &[1.0, 2.0]).param, "x0");
        assert!(refused(&[&[0.0]], &[]).help.unwrap().contains("AlgebraicConstraint"));
        let error = refused(&[&[1.0, 1.0], &[1.0, 1.0 + 1e-12]], &[]);
        assert!(error.message.contains("neither regular nor singular"), "{}", error.message);
    }
}
