use blocksim_block::prelude::*;
use nalgebra::DMatrix;

use super::descriptor::{Rank, Reduction, Scaled, matrix, product, undecided};
use super::state_space::{column, dot, fit, sized};

/// Linear system with a matrix before the derivatives, which may be singular.
///
/// $$ E \dot x = A x + B u, \qquad y = C x + D u, \qquad x(0) = x_0 $$
///
/// Matrices are lists of rows, as in StateSpace. Where `e` is singular, some rows are constraints; the system must be of
/// index 1: the constraints determine all of $x$ that no derivative does. It is reduced once, when it is built. With
/// $Q^T E P = (R_1\ R_2;\ 0\ 0)$ by a QR factorisation with exchange of columns, rows and columns scaled to like sizes before,
/// $x = P (x_1, z)$ and $w = x_1 + R_1^{-1} R_2 z$ are the states, and $0 = Q_2^T (A x + B u)$ gives $z$ as a linear form of
/// $w$ and $u$. What follows is a state space of $w$ with a direct part. An index of 2 or more, where
/// outputs would contain derivatives of the input, and equations that contradict or repeat each other, are refused.
///
/// `x0` must fulfil the constraints at the start, or the run ends with an error that names the values that would; with
/// `initial: Differential` only $E x_0$ is used. Without `x0` the states begin at zero and the rest follows.
///
/// A capacitor of 1 mF behind 1 kohm, with its voltage and its current as $x$: $C \dot x_1 = x_2$, $0 = u - x_1 - R x_2$.
///
/// ```ron
/// DescriptorStateSpace(e: [[1e-3, 0.0], [0.0, 0.0]], a: [[0.0, 1.0], [-1.0, -1e3]], b: [[0.0], [1.0]], c: [[0.0, 1.0]])
/// ```
///
/// Source: L. Dai, Singular Control Systems, Springer 1989, chapter 1 (second equivalent form).
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Lines("E ẋ = A x + B u","y = C x + D u"), builds = System)]
pub struct DescriptorStateSpace {
    /// Matrix before the derivatives, square.
    #[block(difference, finite)]
    pub e: Vec<Vec<f64>>,
    /// System matrix, as large as `e`.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]")]
    pub a: Vec<Vec<f64>>,
    /// Input matrix, a row for each row of `a`, a column for each input.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]")]
    pub b: Vec<Vec<f64>>,
    /// Output matrix, a row for each output.
    #[block(difference, not_empty, finite, empty = "give a list of rows, such as [[0.0, 1.0], [-1.0, 0.0]]")]
    pub c: Vec<Vec<f64>>,
    /// Feedthrough, outputs by inputs; empty means zero.
    #[block(difference, finite, default = Vec::new())]
    pub d: Vec<Vec<f64>>,
    /// Values at the start, one for each row of `a`; empty means that the states are zero.
    #[block(finite, default = Vec::new())]
    pub x0: Vec<f64>,
    /// What is taken of `x0`: `Exact` (all of it; it must fulfil the constraints) or `Differential` (the part that `e` determines).
    #[block(default = InitialValues::Exact)]
    pub initial: InitialValues,
}

/// What is taken of initial values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum InitialValues {
    /// All, and they must fulfil the constraints.
    Exact,
    /// Those that derivatives determine; the rest follows.
    Differential,
}

/// Share by which initial values may miss the constraints.
const CONSISTENT: f64 = 1e-6;

/// The state space that is left: `w' = a w + b u`, `y = c w + d u`, `x = of_w w + of_u u`.
#[derive(Debug, Clone)]
pub struct System {
    inputs: usize,
    names: Vec<String>,
    start: Vec<f64>,
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c: Vec<Vec<f64>>,
    d: Vec<Vec<f64>>,
    of_w: Vec<Vec<f64>>,
    of_u: Vec<Vec<f64>>,
    /// What `x` must be at the start; empty where any values will do.
    x0: Vec<f64>,
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

impl System {
    fn new(block: &DescriptorStateSpace) -> Result<Self, ParamError> {
        let (n, inputs, outputs) = (block.a.len(), block.b[0].len(), block.c.len());
        let (e, a) = (matrix(&block.e, n), matrix(&block.a, n));
        let (b, c) = (matrix(&block.b, inputs), matrix(&block.c, n));
        let d = if block.d.is_empty() { DMatrix::zeros(outputs, inputs) } else { matrix(&block.d, inputs) };
        let found = Reduction::new(e.clone()).map_err(|share| undecided("e", share))?;
        let (r, m) = (found.states(), found.constraints());
        let place = |k: usize| found.order[k];
        // x = of_state w + of_rest z.
        let mut of_state = DMatrix::zeros(n, r);
        let mut of_rest = DMatrix::zeros(n, m);
        for i in 0..r {
            of_state[(place(i), i)] = 1.0;
            (0..m).for_each(|j| of_rest[(place(i), j)] = -found.t[(i, j)]);
        }
        (0..m).for_each(|j| of_rest[(place(r + j), j)] = 1.0);
        let ga = product(&found.g, &a);
        let solve = Constraints::new(product(&ga, &of_rest), &e, &a)?;
        let rest_of_w = solve.apply(-product(&ga, &of_state));
        let rest_of_u = solve.apply(-product(&found.g, &b));
        let of_w = of_state + product(&of_rest, &rest_of_w);
        let of_u = product(&of_rest, &rest_of_u);
        let fa = product(&found.f, &a);
        let start = if block.x0.is_empty() { vec![0.0; r] } else { found.states_of(&block.x0) };
        let exact = block.initial == InitialValues::Exact;
        Ok(Self {
            inputs,
            names: (0..r).map(|i| found.name(i)).collect(),
            start,
            a: rows(&product(&fa, &of_w)),
            b: rows(&(product(&fa, &of_u) + product(&found.f, &b))),
            c: rows(&product(&c, &of_w)),
            d: rows(&(product(&c, &of_u) + d)),
            of_w: rows(&of_w),
            of_u: rows(&of_u),
            x0: if exact { block.x0.clone() } else { Vec::new() },
        })
    }

    /// Whether the values at the start fulfil the constraints; nothing where any values do.
    fn is_consistent<'r>(&self, l: &Recording<'r>) -> Option<Condition<'r>> {
        if self.x0.is_empty() {
            return None;
        }
        let (x, u, zero) = (l.x(), l.input(0), l.constant(0.0));
        let mut holds = l.time().live(Relation::NotEqual, zero);
        // Methods look at other states at the start as well.
        for (x, start) in x.iter().zip(&self.start) {
            holds = holds.or(x.live(Relation::NotEqual, l.constant(*start)));
        }
        let magnitude = |value: Value<'r>| value.live(Relation::Less, zero).select(-value, value);
        let mut fits: Option<Condition> = None;
        for ((of_w, of_u), x0) in self.of_w.iter().zip(&self.of_u).zip(&self.x0) {
            let found = l.dot(of_w, x) + l.dot(of_u, u);
            let terms = of_w.iter().zip(x).chain(of_u.iter().zip(u));
            let size = terms.fold(zero, |size, (factor, value)| size + magnitude(*factor * *value));
            let least = l.constant(x0.abs());
            let size = size.live(Relation::Less, least).select(least, size);
            let near = magnitude(found - *x0).live(Relation::LessEqual, size * CONSISTENT);
            // What is not a number has another cause.
            let near = near.or(!found.is_number());
            fits = Some(fits.map_or(near, |fits| fits.and(near)));
        }
        fits.map(|fits| holds.or(fits))
    }

    fn feeds_through(&self) -> bool {
        self.d.iter().flatten().any(|d| *d != 0.0)
    }
}

/// The constraints as equations for what they determine.
struct Constraints(DMatrix<f64>);

impl Constraints {
    /// # Errors
    /// They do not determine it.
    fn new(matrix: DMatrix<f64>, e: &DMatrix<f64>, a: &DMatrix<f64>) -> Result<Self, ParamError> {
        let m = matrix.nrows();
        match Scaled::new(matrix.clone()).rank() {
            Rank::Of(rank) if rank == m => Ok(Self(matrix)),
            Rank::Unclear(share) => Err(undecided("e", share).help(
                "the constraints hardly determine what no derivative does; write dependent rows of `e` and `a` with all their digits",
            )),
            Rank::Of(_) if is_singular_pencil(e, a) => Err(ParamError::new(
                "a",
                "the equations have no single solution: `s e - a` is singular for every s",
            )
            .help("some equations repeat or contradict each other, so some of x has none: look for rows that are sums of others")),
            Rank::Of(rank) => {
                let message = format!(
                    "the index of the equations is 2 or more: {} of the {m} constraints leave(s) open what no derivative determines",
                    m - rank
                );
                Err(ParamError::new("e", message).help(
                    "differentiate these constraints and put the result in the place of a row that they make superfluous; or leave out what \
                     makes them, such as a capacitor across a voltage source",
                ))
            }
        }
    }

    fn apply(&self, right: DMatrix<f64>) -> DMatrix<f64> {
        if self.0.is_empty() {
            return right;
        }
        let Scaled { matrix, rows, columns } = Scaled::new(self.0.clone());
        let mut right = right;
        right.row_iter_mut().zip(&rows).for_each(|(mut row, scale)| row.scale_mut(*scale));
        let mut solution = matrix.full_piv_lu().solve(&right).unwrap_or(right);
        solution.row_iter_mut().zip(&columns).for_each(|(mut row, scale)| row.scale_mut(*scale));
        solution
    }
}

/// Whether `s e - a` is singular at several s, none of which would be a pole by chance.
fn is_singular_pencil(e: &DMatrix<f64>, a: &DMatrix<f64>) -> bool {
    let pace = if e.amax() > 0.0 { a.amax() / e.amax() } else { 1.0 };
    [0.372_9, -1.713_1, 5.918_3].into_iter().all(|s| {
        let pencil = Scaled::new(e * (s * pace) - a);
        pencil.rank() != Rank::Of(a.nrows())
    })
}

impl DescriptorStateSpace {
    fn validate(&self, errors: &mut ParamErrors) {
        fit([&self.a, &self.b, &self.c, &self.d], &self.x0, errors);
        let n = self.a.len();
        sized(("e", &self.e), (n, n), ("as large as `a`", &["a"]), errors);
    }

    fn build(self, errors: &mut ParamErrors) -> Option<System> {
        errors.take(System::new(&self))
    }
}

impl Block for System {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let y = Output::like("y", PortType::UNKNOWN.shaped(column(self.c.len())));
        let interface = Interface::new().input(Input::real("u").shape(column(self.inputs)));
        let mut interface = interface.output(y);
        for (name, start) in self.names.iter().zip(&self.start) {
            interface = interface.state(name.clone(), *start);
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        let (x, u) = (l.x(), l.input(0));
        let consistent = self.is_consistent(l);
        let start = |first: bool, value: Value| match consistent {
            Some(holds) if first => value.only_where(holds),
            _ => (),
        };
        for (i, c) in self.c.iter().enumerate() {
            let free = l.dot(c, x);
            let y = if self.feeds_through() { free + l.dot(&self.d[i], u) } else { free };
            start(i == 0 && x.is_empty() && self.feeds_through(), y);
            l.set(0, i, y);
        }
        for (i, (a, b)) in self.a.iter().zip(&self.b).enumerate() {
            let dx = l.dot(a, x) + l.dot(b, u);
            start(i == 0, dx);
            l.derive(i, dx);
        }
        true
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        let wrong: Vec<String> = (0..self.x0.len())
            .filter_map(|i| {
                let found = dot(&self.of_w[i], c.x) + dot(&self.of_u[i], c.u);
                let size = size(&self.of_w[i], c.x) + size(&self.of_u[i], c.u);
                let is_wrong = (found - self.x0[i]).abs() > CONSISTENT * size.max(self.x0[i].abs());
                is_wrong.then(|| format!("x0[{i}] is {}, but {found:.6e} follows", self.x0[i]))
            })
            .collect();
        Some(format!(
            "`x0` contradicts the constraints at the start: {}; write these values, or `initial: Differential` to have them found",
            wrong.join(", ")
        ))
    }
}

/// The sum of the magnitudes of `row[i] * v[i]`.
fn size(row: &[f64], v: &[f64]) -> f64 {
    row.iter().zip(v).map(|(m, v)| (m * v).abs()).sum()
}

#[cfg(test)]
#[path = "descriptor_state_space_tests.rs"]
mod tests;
