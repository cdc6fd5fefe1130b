//! The matrices of a system.

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::LinearError;

/// A system in state space, `x' = A x + B u`, `y = C x + D u`; with a period `x` of the next sample instead of `x'`.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// n x n.
    pub a: DMatrix<f64>,
    /// n x inputs.
    pub b: DMatrix<f64>,
    /// outputs x n.
    pub c: DMatrix<f64>,
    /// outputs x inputs.
    pub d: DMatrix<f64>,
    /// Time between two samples, s; none in continuous time.
    pub period: Option<f64>,
}

/// One input and one output of a system.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// n x n.
    pub a: DMatrix<f64>,
    /// n.
    pub b: DVector<f64>,
    /// n.
    pub c: RowDVector<f64>,
    /// What passes at once.
    pub d: f64,
    /// Time between two samples, s; none in continuous time.
    pub period: Option<f64>,
}

impl StateSpace {
    /// A system of these matrices.
    ///
    /// # Errors
    /// Matrices that do not fit each other, values that are not finite, a period that is not above zero.
    pub fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        c: DMatrix<f64>,
        d: DMatrix<f64>,
        period: Option<f64>,
    ) -> Result<StateSpace, LinearError> {
        let (n, inputs, outputs) = (a.nrows(), b.ncols(), c.nrows());
        let fits = [("A", a.shape(), (n, n)), ("B", b.shape(), (n, inputs)), ("C", c.shape(), (outputs, n))];
        let fits = fits.into_iter().chain([("D", d.shape(), (outputs, inputs))]);
        for (name, shape, wanted) in fits {
            if shape != wanted {
                return Err(LinearError::Shape(format!(
                    "the matrix {name} is {} x {}, not {} x {}",
                    shape.0, shape.1, wanted.0, wanted.1
                )));
            }
        }
        for (name, matrix) in [("A", &a), ("B", &b), ("C", &c), ("D", &d)] {
            if matrix.iter().any(|value| !value.is_finite()) {
                return Err(LinearError::NotFinite(name));
            }
        }
        if period.is_some_and(|period| !(period > 0.0 && period.is_finite())) {
            return Err(LinearError::Shape("the period of a sampled system is above zero".to_owned()));
        }
        Ok(StateSpace { a, b, c, d, period })
    }

    /// From one input to one output.
    ///
    /// # Panics
    /// If there is no such input or output.
    pub fn channel(&self, input: usize, output: usize) -> Channel {
        Channel {
            a: self.a.clone(),
            b: self.b.column(input).into_owned(),
            c: self.c.row(output).into_owned(),
            d: self.d[(output, input)],
            period: self.period,
        }
    }

    /// What an input that is held between samples does to the states at the samples. Exact; by the exponential of
    /// `[A B; 0 0] T` (C. Van Loan, Computing integrals involving the matrix exponential, IEEE Trans. Automatic Control
    /// 23 (1978) 395).
    ///
    /// `self` is in continuous time.
    pub fn sampled(&self, period: f64) -> StateSpace {
        let (phi, gamma) = held(&self.a, &self.b, period);
        StateSpace { a: phi, b: gamma, c: self.c.clone(), d: self.d.clone(), period: Some(period) }
    }
}

/// `exp(A T)` and the integral of `exp(A s) B` over a period.
pub(crate) fn held(a: &DMatrix<f64>, b: &DMatrix<f64>, period: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let (n, m) = b.shape();
    let mut both = DMatrix::zeros(n + m, n + m);
    both.view_mut((0, 0), (n, n)).copy_from(&(a * period));
    both.view_mut((0, n), (n, m)).copy_from(&(b * period));
    let both = both.exp();
    (both.view((0, 0), (n, n)).into_owned(), both.view((0, n), (n, m)).into_owned())
}

impl Channel {
    /// Number of states.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// The same with its output times `gain`.
    pub fn scaled(mut self, gain: f64) -> Channel {
        self.c *= gain;
        self.d *= gain;
        self
    }

    /// The loop that is closed around this one by a negative feedback of 1; `None` where `1 + D` is zero.
    pub fn closed(&self) -> Option<Channel> {
        let through = 1.0 + self.d;
        if through.abs() < f64::EPSILON * (1.0 + self.d.abs()) {
            return None;
        }
        Some(Channel {
            a: &self.a - &self.b * &self.c / through,
            b: &self.b / through,
            c: &self.c / through,
            d: self.d / through,
            period: self.period,
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The channel of a transfer function, coefficients from the highest power on, in the controllable canonical form.
    pub fn transfer(numerator: &[f64], denominator: &[f64]) -> Channel {
        let n = denominator.len() - 1;
        let lead = denominator[0];
        let den: Vec<f64> = denominator.iter().map(|x| x / lead).collect();
        let mut num = vec![0.0; n + 1 - numerator.len()];
        num.extend(numerator.iter().map(|x| x / lead));
        let d = num[0];
        let a = DMatrix::from_fn(n, n, |i, j| match i {
            0 => -den[j + 1],
            _ => f64::from(i == j + 1),
        });
        let b = DVector::from_fn(n, |i, _| f64::from(i == 0));
        let c = RowDVector::from_fn(n, |_, j| num[j + 1] - d * den[j + 1]);
        Channel { a, b, c, d, period: None }
    }

    /// The channel in other coordinates, and with states whose sizes are far apart.
    pub fn transformed(channel: &Channel, scale: f64) -> Channel {
        let n = channel.order();
        let t = DMatrix::from_fn(n, n, |i, j| {
            let mixed = if i == j { 2.0 } else { ((3 * i + 7 * j) % 5) as f64 / 10.0 - 0.2 };
            mixed * scale.powi(i as i32)
        });
        let inverse = t.clone().try_inverse().expect("a regular matrix");
        Channel {
            a: &t * &channel.a * &inverse,
            b: &t * &channel.b,
            c: &channel.c * &inverse,
            ..channel.clone()
        }
    }

    #[test]
    fn matrices_that_do_not_fit_are_refused_with_their_name() {
        let m = |rows, columns| DMatrix::<f64>::zeros(rows, columns);
        assert!(StateSpace::new(m(2, 2), m(2, 1), m(3, 2), m(3, 1), None).is_ok());
        let wrong = StateSpace::new(m(2, 2), m(2, 1), m(3, 2), m(1, 3), None).unwrap_err();
        assert_eq!(wrong.to_string(), "the matrix D is 1 x 3, not 3 x 1");
        let odd = StateSpace::new(m(1, 1), DMatrix::from_element(1, 1, f64::NAN), m(1, 1), m(1, 1), None);
        assert_eq!(odd, Err(LinearError::NotFinite("B")));
        assert!(StateSpace::new(m(1, 1), m(1, 1), m(1, 1), m(1, 1), Some(0.0)).is_err());
    }

    #[test]
    fn a_sampled_double_integrator_is_the_one_of_the_books() {
        // Astrom and Wittenmark, Computer-Controlled Systems, example 2.3.
        let m = |rows, columns, values: &[f64]| DMatrix::from_row_slice(rows, columns, values);
        let a = m(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let plant = StateSpace::new(a, m(2, 1, &[0.0, 1.0]), m(1, 2, &[1.0, 0.0]), m(1, 1, &[0.0]), None);
        let sampled = plant.unwrap().sampled(0.2);
        assert!((sampled.a - m(2, 2, &[1.0, 0.2, 0.0, 1.0])).amax() < 1e-15);
        assert!((sampled.b - m(2, 1, &[0.02, 0.2])).amax() < 1e-15);
    }
}
