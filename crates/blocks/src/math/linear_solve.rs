use blocksim_block::prelude::*;
use blocksim_solve::linear::{lu_factor, lu_solve};

/// Solves linear equations whose matrix is a signal.
///
/// $$ M y = f $$
///
/// `m` is a matrix, or a vector of its elements row by row, of $n^2$ elements for the $n$ of `f`. With an Integrator behind it
/// this is a mass matrix that depends on states: $M(x)\, \dot x = f$.
///
/// Rows and columns are brought to like sizes by powers of two, then Gaussian elimination with exchange of rows. A
/// matrix that is singular, or so nearly that its condition number is above 1e13 and hardly a digit of $y$ would be
/// right, ends the run with an error. So does a determinant that changes its sign, which is watched.
///
/// ```ron
/// LinearSolve
/// ```
///
/// Source: G. Golub, C. Van Loan: Matrix Computations, sections 3.4, 3.5.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Lines("M y = f", ""))]
pub struct LinearSolve {}

/// Condition number above which a matrix counts as singular, and share of the largest pivot below which it is computed.
const SINGULAR: f64 = 1e13;
const SUSPICIOUS: f64 = 1e-7;

/// Room for one solution.
#[derive(Default)]
struct Room {
    lu: Vec<f64>,
    pivots: Vec<usize>,
    columns: Vec<f64>,
    column: Vec<f64>,
    unused: Vec<f64>,
    /// Logarithm of what rows have been scaled by, all together, relative to their norms.
    norms: f64,
}

/// The power of two that brings a number to a size of about one; `None` if it is zero.
fn inverse(size: f64) -> Option<f64> {
    (size > 0.0 && size.is_finite()).then(|| (-size.log2().round()).clamp(-500.0, 500.0).exp2())
}

impl Room {
    fn fit(&mut self, n: usize) {
        if self.pivots.len() != n {
            *self = Self {
                lu: vec![0.0; n * n],
                pivots: vec![0; n],
                columns: vec![1.0; n],
                column: vec![0.0; n],
                unused: vec![0.0; n],
                norms: 0.0,
            };
        }
    }

    /// The determinant, made independent of the sizes of the rows: of magnitude 1 where they are at right angles.
    fn determinant(&mut self, m: &[f64]) -> f64 {
        let n = self.pivots.len();
        let mut y = std::mem::take(&mut self.unused);
        y.fill(0.0);
        let solved = self.solve(m, &mut y);
        self.unused = y;
        if solved == Err(f64::INFINITY) {
            return 0.0;
        }
        let (mut sign, mut size) = (1.0, self.norms);
        for i in 0..n {
            let pivot = self.lu[i * n + i];
            let turned = (self.pivots[i] != i) != (pivot < 0.0);
            sign *= if turned { -1.0 } else { 1.0 };
            size += pivot.abs().ln() - self.columns[i].ln();
        }
        sign * (size / n as f64).exp()
    }

    /// Overwrites `y`, the right side, with the solution. Fails with the condition number.
    fn solve(&mut self, m: &[f64], y: &mut [f64]) -> Result<(), f64> {
        let n = y.len();
        self.lu.copy_from_slice(m);
        self.norms = 0.0;
        let largest = |row: &[f64]| row.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        for (row, y) in self.lu.chunks_exact_mut(n).zip(y.iter_mut()) {
            let scale = inverse(largest(row)).ok_or(f64::INFINITY)?;
            row.iter_mut().for_each(|value| *value *= scale);
            self.norms -= 0.5 * row.iter().map(|value| value * value).sum::<f64>().ln();
            *y *= scale;
        }
        for j in 0..n {
            let size = (0..n).fold(0.0, |size: f64, i| size.max(self.lu[i * n + j].abs()));
            self.columns[j] = inverse(size).ok_or(f64::INFINITY)?;
            (0..n).for_each(|i| self.lu[i * n + j] *= self.columns[j]);
        }
        let norm = self.norm();
        lu_factor(&mut self.lu, &mut self.pivots).map_err(|_| f64::INFINITY)?;
        let pivots = (0..n).map(|i| self.lu[i * n + i].abs());
        let (least, greatest) = pivots.fold((f64::INFINITY, 0.0_f64), |(least, greatest), pivot| {
            (least.min(pivot), greatest.max(pivot))
        });
        if least < SUSPICIOUS * greatest {
            let condition = norm * self.inverse_norm();
            if condition.is_nan() || condition > SINGULAR {
                return Err(condition);
            }
        }
        lu_solve(&self.lu, &self.pivots, y);
        y.iter_mut().zip(&self.columns).for_each(|(y, scale)| *y *= scale);
        Ok(())
    }

    /// Greatest sum of magnitudes in a column.
    fn norm(&self) -> f64 {
        let n = self.pivots.len();
        (0..n).map(|j| (0..n).map(|i| self.lu[i * n + j].abs()).sum()).fold(0.0, f64::max)
    }

    /// The same of the inverse of what has been factorised.
    #[cold]
    fn inverse_norm(&mut self) -> f64 {
        let mut norm: f64 = 0.0;
        for j in 0..self.pivots.len() {
            self.column.fill(0.0);
            self.column[j] = 1.0;
            lu_solve(&self.lu, &self.pivots, &mut self.column);
            norm = norm.max(self.column.iter().map(|value| value.abs()).sum());
        }
        norm
    }
}

impl Block for LinearSolve {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let f = given.input_or_unknown("f");
        let n = f.shape.len();
        if let Shape::Matrix(..) = f.shape {
            return Err(InterfaceError::types(&["f"], format!("`f` is a {}, but must be a vector", f.shape)));
        }
        if let (Some(m), Some(_)) = (given.input("m"), given.input("f"))
            && (m.shape.len() != n * n || matches!(m.shape, Shape::Matrix(rows, _) if rows != n))
        {
            let message = format!("`m` is a {}, which is not {n}x{n}, as `f` of {n} asks for", m.shape);
            return Err(InterfaceError::types(&["m", "f"], message).help(format!(
                "give `m` the {} elements of the matrix, row by row, for instance with Mux",
                n * n
            )));
        }
        let known = |name: &str| given.input(name).and_then(|input| input.dimension);
        let dimension = known("f").zip(known("m")).map(|(f, m)| f.over(m));
        let y = PortType::UNKNOWN.shaped(f.shape).of(dimension);
        let m = Input::real("m").doc("The matrix, or its elements row by row.");
        let f = Input::real("f").doc("The right side.");
        let interface = Interface::new().input(m).input(f).output(Output::like("y", y).doc("The solution."));
        Ok(interface
            .jumps()
            .discrete("sign", 0.0)
            .guard("determinant")
            .called("turns singular", "turns singular"))
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(Room::default())
    }

    fn outputs(&self, _group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(room) = w.get::<Room>() else { return };
        let (m, f) = (c.input(0), c.input(1));
        room.fit(f.len());
        y.copy_from_slice(f);
        if m.iter().chain(f).any(|value| !value.is_finite()) {
            y.fill(f64::NAN);
            return;
        }
        if let Err(condition) = room.solve(m, y) {
            let how = if condition.is_finite() {
                format!(
                    "nearly singular (condition number {condition:.1e} with rows and columns scaled to like sizes)"
                )
            } else {
                "singular (its condition number is infinite)".to_owned()
            };
            c.fail(format!(
                "its matrix is {how}, so that its equations have no single solution; leave out what has no mass, or give it a small one, \
                 and keep away from positions where parts lose their freedom"
            ));
        }
    }

    fn jump(&self, c: &Context, w: &mut Scratch, _x: &mut [f64], d: &mut [f64]) -> bool {
        let Some(room) = w.get::<Room>() else { return false };
        room.fit(c.input(1).len());
        let determinant = room.determinant(c.input(0));
        if determinant * d[0] < 0.0 {
            c.fail(
                "the determinant of its matrix has changed its sign, so that it was singular in between and its equations had no single \
                 solution; a mass matrix is positive definite: look for a mass that becomes negative",
            );
        }
        if determinant.abs() > 0.0 {
            d[0] = determinant.signum();
        }
        false
    }

    fn guards(&self, c: &Context, w: &mut Scratch, g: &mut [f64]) {
        let Some(room) = w.get::<Room>() else { return };
        room.fit(c.input(1).len());
        g[0] = room.determinant(c.input(0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    fn bench(n: usize) -> Bench {
        let inputs = vec![("m".to_owned(), PortType::vector(n * n)), ("f".to_owned(), PortType::vector(n))];
        Bench::with_inputs(LinearSolve {}, inputs)
    }

    #[test]
    fn equations_are_solved_whatever_the_sizes_of_their_rows_and_columns() {
        // y = (1, -2, 3).
        let m = [2.0, 1.0, 0.0, 1.0, 0.0, 4.0, 0.0, -3.0, 1.0];
        let f = [0.0, 13.0, 9.0];
        for (row, column) in [(1.0, 1.0), (1e12, 1.0), (1e-9, 1e9)] {
            let (mut m, mut f) = (m, f);
            (0..3).for_each(|j| m[j] *= row);
            f[0] *= row;
            (0..3).for_each(|i| m[3 * i + 2] *= column);
            let y = bench(3).set(0, &m).set(1, &f).major();
            assert!((y[0] - 1.0).abs() < 1e-14 && (y[1] + 2.0).abs() < 1e-14, "{y:?}");
            assert!((y[2] * column - 3.0).abs() < 1e-14, "{y:?}");
        }
        let mut one = Bench::new(LinearSolve {});
        assert_eq!(one.set(0, &[4.0]).set(1, &[2.0]).major(), [0.5]);
    }

    #[test]
    #[should_panic(expected = "its matrix is singular (its condition number is infinite)")]
    fn a_row_of_zeros_is_told() {
        bench(2).set(0, &[1.0, 2.0, 0.0, 0.0]).set(1, &[1.0, 1.0]).major();
    }

    #[test]
    #[should_panic(expected = "nearly singular (condition number")]
    fn a_matrix_that_is_singular_but_for_rounding_is_told() {
        bench(2).set(0, &[0.1, 0.3, 0.1 / 3.0, 0.1]).set(1, &[1.0, 1.0]).major();
    }

    #[test]
    fn a_matrix_of_many_sizes_is_not_singular() {
        // Of condition 1e16 as it is written, of 1 when scaled; and one that is ill-conditioned, but well enough.
        let y = bench(2).set(0, &[1e-8, 0.0, 0.0, 1e8]).set(1, &[1e-8, 1e8]).major();
        assert_eq!(y, [1.0, 1.0]);
        let y = bench(2).set(0, &[1.0, 1.0, 1.0, 1.0 + 1e-9]).set(1, &[2.0, 2.0 + 1e-9]).major();
        assert!((y[0] - 1.0).abs() < 1e-6 && (y[1] - 1.0).abs() < 1e-6, "{y:?}");
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        let given = |m, f| Given::new(vec![("m".to_owned(), m), ("f".to_owned(), f)], Default::default());
        let vector = PortType::vector;
        assert!(LinearSolve {}.interface(&given(vector(4), vector(3))).is_err());
        assert!(LinearSolve {}.interface(&given(vector(9), vector(3))).is_ok());
        let wide = PortType::scalar().shaped(Shape::Matrix(1, 9));
        assert!(LinearSolve {}.interface(&given(wide, vector(3))).is_err());
    }
}
