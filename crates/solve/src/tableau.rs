//! Tableaus of explicit Runge-Kutta methods, laid out as in the papers.

use crate::bogacki_shampine as bs;
use crate::dormand_prince as dp;

/// A Butcher tableau with a continuous extension that uses the same stages.
pub(crate) struct Tableau {
    pub name: &'static str,
    /// Abscissae, one per stage.
    pub c: &'static [f64],
    /// Rows below the diagonal; the first is empty.
    pub a: &'static [&'static [f64]],
    /// Weights.
    pub b: &'static [f64],
    /// Weights at the fraction theta of the step, per stage the coefficients of theta, theta^2, theta^3.
    pub dense: &'static [[f64; 3]],
}

/// Order 1, one stage. L. Euler: Institutionum calculi integralis, 1768. Extension of order 1.
pub(crate) const EULER: Tableau =
    Tableau { name: "Ode1", c: &[0.0], a: &[&[]], b: &[1.0], dense: &[[1.0, 0.0, 0.0]] };

/// Order 2, two stages. K. Heun: Neue Methoden zur approximativen Integration der Differentialgleichungen einer
/// unabhängigen Veränderlichen, Z. Math. Phys. 45 (1900). Extension of order 2.
pub(crate) const HEUN: Tableau = Tableau {
    name: "Ode2",
    c: &[0.0, 1.0],
    a: &[&[], &[1.0]],
    b: &[1.0 / 2.0, 1.0 / 2.0],
    dense: &[[1.0, -1.0 / 2.0, 0.0], [0.0, 1.0 / 2.0, 0.0]],
};

/// Order 3, three stages: the solution of Bogacki and Shampine's pair. Extension of order 2, the parabola through both
/// ends with the slope at the start.
pub(crate) const BOGACKI_SHAMPINE: Tableau = Tableau {
    name: "Ode3",
    c: &[0.0, bs::C2, bs::C3],
    a: &[&[], &bs::A2, &bs::A3],
    b: &bs::B,
    dense: &[[1.0, 2.0 / 9.0 - 1.0, 0.0], [0.0, 1.0 / 3.0, 0.0], [0.0, 4.0 / 9.0, 0.0]],
};

/// Order 4, four stages. W. Kutta: Beitrag zur näherungsweisen Integration totaler Differentialgleichungen,
/// Z. Math. Phys. 46 (1901). Extension of order 3.
pub(crate) const CLASSIC: Tableau = Tableau {
    name: "Ode4",
    c: &[0.0, 1.0 / 2.0, 1.0 / 2.0, 1.0],
    a: &[&[], &[1.0 / 2.0], &[0.0, 1.0 / 2.0], &[0.0, 0.0, 1.0]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    dense: &[
        [1.0, -3.0 / 2.0, 2.0 / 3.0],
        [0.0, 1.0, -2.0 / 3.0],
        [0.0, 1.0, -2.0 / 3.0],
        [0.0, -1.0 / 2.0, 2.0 / 3.0],
    ],
};

/// Order 5, six stages: the solution of Dormand and Prince's pair. Extension of order 3: the square terms are spread over
/// stages 1, 3 and 4, where they meet the conditions without roots; the cubic ones then follow from the weights.
pub(crate) const DORMAND_PRINCE: Tableau = Tableau {
    name: "Ode5",
    c: &[0.0, dp::C2, dp::C3, dp::C4, dp::C5, 1.0],
    a: &[&[], &dp::A2, &dp::A3, &dp::A4, &dp::A5, &dp::A6],
    b: &dp::B,
    dense: &[
        [1.0, -55.0 / 24.0, 35.0 / 384.0 - 1.0 + 55.0 / 24.0],
        [0.0, 0.0, 0.0],
        [0.0, 8.0 / 3.0, 500.0 / 1113.0 - 8.0 / 3.0],
        [0.0, -3.0 / 8.0, 125.0 / 192.0 + 3.0 / 8.0],
        [0.0, 0.0, -2187.0 / 6784.0],
        [0.0, 0.0, 11.0 / 84.0],
    ],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trees::{Family, largest_defect, square};

    const ALL: [(Tableau, usize, usize); 5] =
        [(EULER, 1, 1), (HEUN, 2, 2), (BOGACKI_SHAMPINE, 3, 2), (CLASSIC, 4, 3), (DORMAND_PRINCE, 5, 3)];

    #[test]
    fn every_tableau_meets_the_conditions_of_its_order_and_of_no_higher_one() {
        for (tableau, order, _) in ALL {
            let a = square(tableau.a);
            let defect = |order| largest_defect(Family::RungeKutta, &a, &[], tableau.b, 1.0, order);
            assert!(defect(order) < 1e-14, "{}: {:e}", tableau.name, defect(order));
            assert!(defect(order + 1) > 1e-4, "{}", tableau.name);
        }
    }

    #[test]
    fn every_extension_meets_the_conditions_of_its_order_anywhere_and_ends_in_the_weights() {
        for (tableau, _, order) in ALL {
            let a = square(tableau.a);
            for theta in [0.1, 0.3, 0.5, 0.8, 1.0] {
                let weight = |d: &[f64; 3]| theta * (d[0] + theta * (d[1] + theta * d[2]));
                let b: Vec<f64> = tableau.dense.iter().map(weight).collect();
                let defect = largest_defect(Family::RungeKutta, &a, &[], &b, theta, order);
                assert!(defect < 1e-14, "{} at {theta}: {defect:e}", tableau.name);
                if theta == 1.0 {
                    for (w, b) in b.iter().zip(tableau.b) {
                        assert!((w - b).abs() < 1e-14, "{}", tableau.name);
                    }
                }
            }
        }
    }

    #[test]
    fn the_abscissae_are_the_sums_of_the_rows() {
        for (tableau, ..) in ALL {
            for (c, row) in tableau.c.iter().zip(tableau.a) {
                assert!((c - row.iter().sum::<f64>()).abs() < 1e-14, "{}", tableau.name);
            }
        }
    }
}
