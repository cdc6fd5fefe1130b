//! States that others decide.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::StateSpace;

/// A row whose entries are all below this part of what the values of its kind are made of is rounding.
const ROUNDING: f64 = 1e-6;
/// A constraint of which less than this part is left after others say the same.
const DEPENDENT: f64 = 1e-6;

/// Slopes, over the states and then the inputs of a system, of values that are zero whatever happens.
#[derive(Debug, Clone)]
pub struct Constrained {
    /// Rows of values of one kind, rows x (states + inputs).
    pub gaps: DMatrix<f64>,
    /// Which states may be said to follow from others by them, as long as there are some.
    pub states: Range<usize>,
    /// Slopes of what these are made of, any number of rows; those of the gaps are rounding where they are small against them.
    pub terms: DMatrix<f64>,
}

/// The system over as many states as are free: the others follow from these, and from the inputs, by the constraints. Returns it with
/// the numbers of the states that are left.
///
/// Of `H x + G u = 0` as many states are eliminated as there are independent rows, by Gaussian elimination with complete pivoting; with
/// `x = T z + N u` the derivatives of those that are left are `z' = E A T z + E (B + A N) u`, with `E` their rows.
///
/// # Panics
/// If the widths of the slopes are not those of the system.
pub fn constrained(system: &StateSpace, constraints: &[Constrained]) -> (StateSpace, Vec<usize>) {
    let (n, m) = (system.a.nrows(), system.b.ncols());
    let mut rows: Vec<Row> = constraints.iter().flat_map(|kind| scaled(kind, n)).collect();
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    // Speeds follow from speeds by the slopes of a closed loop, though these change with positions as well.
    while let Some(pivot) = largest(&rows, &pivots, n, true).or_else(|| largest(&rows, &pivots, n, false)) {
        eliminate(&mut rows, pivot);
        pivots.push(pivot);
    }
    let kept: Vec<usize> = (0..n).filter(|k| pivots.iter().all(|(_, column)| column != k)).collect();
    let mut t = DMatrix::zeros(n, kept.len());
    let mut shift = DMatrix::zeros(n, m);
    kept.iter().enumerate().for_each(|(j, k)| t[(*k, j)] = 1.0);
    for (row, column) in pivots {
        kept.iter().enumerate().for_each(|(j, k)| t[(column, j)] = -rows[row].slopes[*k]);
        (0..m).for_each(|j| shift[(column, j)] = -rows[row].slopes[n + j]);
    }
    let reduced = StateSpace {
        a: (&system.a * &t).select_rows(&kept),
        b: (&system.b + &system.a * &shift).select_rows(&kept),
        c: &system.c * &t,
        d: &system.d + &system.c * &shift,
        period: system.period,
    };
    (reduced, kept)
}

/// A constraint: its slopes, the largest of them over a state 1.
struct Row {
    slopes: Vec<f64>,
    states: Range<usize>,
}

/// Where the largest slope over a state stands among the rows without a pivot: row and column.
fn largest(rows: &[Row], pivots: &[(usize, usize)], states: usize, only_own: bool) -> Option<(usize, usize)> {
    let free = rows.iter().enumerate().filter(|(i, _)| pivots.iter().all(|(row, _)| row != i));
    let entries = free.flat_map(|(i, row)| {
        let states = if only_own { row.states.clone() } else { 0..states };
        states.map(move |k| (i, k))
    });
    let size = |(i, k): &(usize, usize)| rows[*i].slopes[*k].abs();
    // Of equals the last state goes, so that what is described first is kept.
    let best = entries.max_by(|a, b| size(a).total_cmp(&size(b)).then(a.1.cmp(&b.1)).then(b.0.cmp(&a.0)));
    best.filter(|entry| size(entry) > DEPENDENT)
}

/// Takes a state out of all rows but one, in which its slope becomes 1.
fn eliminate(rows: &mut [Row], (row, column): (usize, usize)) {
    let pivot = rows[row].slopes[column];
    rows[row].slopes.iter_mut().for_each(|slope| *slope /= pivot);
    let own = rows[row].slopes.clone();
    for (i, other) in rows.iter_mut().enumerate() {
        let factor = other.slopes[column];
        if i != row && factor != 0.0 {
            other.slopes.iter_mut().zip(&own).for_each(|(to, own)| *to -= factor * own);
            other.slopes[column] = 0.0;
        }
    }
}

/// The rows of one kind, without those of rounding.
fn scaled(kind: &Constrained, n: usize) -> Vec<Row> {
    if kind.gaps.is_empty() {
        return Vec::new();
    }
    let most = kind.gaps.amax().max(if kind.terms.is_empty() { 0.0 } else { kind.terms.amax() });
    let row = |i: usize| -> Option<Row> {
        let slopes = kind.gaps.row(i);
        let slopes = slopes.iter().map(|slope| if slope.abs() <= ROUNDING * most { 0.0 } else { *slope });
        let slopes: Vec<f64> = slopes.collect();
        let largest = slopes[..n].iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
        let slopes = slopes.iter().map(|slope| slope / largest).collect();
        (largest > 0.0).then(|| Row { slopes, states: kind.states.clone() })
    };
    (0..kind.gaps.nrows()).filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two windings in series at a source, 12 V - 2 mH - 3 mH - 1 ohm, as a solver has them: both carry the same current, and each
    /// knows the voltage over itself; the second state drifts to the first at `rate`.
    fn series(rate: f64) -> StateSpace {
        let m = |rows, columns, values: &[f64]| DMatrix::from_row_slice(rows, columns, values);
        let a = m(2, 2, &[-200.0, 0.0, rate - 200.0, -rate]);
        StateSpace::new(a, m(2, 1, &[200.0, 200.0]), m(1, 2, &[0.0, 1.0]), m(1, 1, &[0.0]), None).unwrap()
    }

    fn kind(gaps: &[f64], width: usize, states: Range<usize>) -> Constrained {
        Constrained {
            gaps: DMatrix::from_row_slice(gaps.len() / width, width, gaps),
            states,
            terms: DMatrix::zeros(0, width),
        }
    }

    #[test]
    fn windings_in_series_are_one_state_whatever_holds_them_together() {
        for rate in [0.0, 5e3] {
            let (system, kept) = constrained(&series(rate), &[kind(&[1.0, -1.0, 0.0], 3, 0..2)]);
            assert_eq!(kept, [0]);
            assert_eq!((system.a[(0, 0)], system.b[(0, 0)], system.c[(0, 0)]), (-200.0, 200.0, 1.0));
        }
    }

    #[test]
    fn what_says_the_same_twice_counts_once_and_rounding_does_not_count() {
        let same = kind(&[1.0, -1.0, 0.0, -2.0, 2.0 + 1e-9, 0.0], 3, 0..2);
        assert_eq!(constrained(&series(0.0), std::slice::from_ref(&same)).1, [0]);
        let rounding = kind(&[1e-12, 0.0, 0.0], 3, 0..2);
        let of = Constrained { terms: DMatrix::from_row_slice(1, 3, &[1.0, 0.0, 0.0]), ..rounding };
        assert_eq!(constrained(&series(0.0), &[of]).1, [0, 1]);
        assert_eq!(constrained(&series(0.0), &[kind(&[], 3, 0..2)]).1, [0, 1]);
    }

    #[test]
    fn a_state_that_an_input_decides_passes_it_on_at_once() {
        // x1 = 2 u, x0' = -x0 + 3 x1, y = x0 + 5 x1.
        let m = |rows, columns, values: &[f64]| DMatrix::from_row_slice(rows, columns, values);
        let system = StateSpace::new(
            m(2, 2, &[-1.0, 3.0, 0.0, 0.0]),
            m(2, 1, &[0.0, 0.0]),
            m(1, 2, &[1.0, 5.0]),
            m(1, 1, &[0.0]),
            None,
        );
        let (system, kept) = constrained(&system.unwrap(), &[kind(&[0.0, 1.0, -2.0], 3, 0..2)]);
        assert_eq!(kept, [0]);
        assert_eq!(
            (system.a[(0, 0)], system.b[(0, 0)], system.c[(0, 0)], system.d[(0, 0)]),
            (-1.0, 6.0, 1.0, 10.0)
        );
    }

    #[test]
    fn speeds_follow_from_speeds_though_their_law_changes_faster_with_positions() {
        // q1 = 2 q0 and w1 = 2 w0 + 9 q0, over q0, q1, w0, w1.
        let positions = kind(&[2.0, -1.0, 0.0, 0.0], 4, 0..2);
        let speeds = kind(&[9.0, 0.0, 2.0, -1.0], 4, 2..4);
        let a = DMatrix::from_row_slice(
            4,
            4,
            &[0., 0., 1., 0., 0., 0., 0., 1., -4., 0., 0., 0., -8., 0., 9., 0.],
        );
        let none = DMatrix::zeros(4, 0);
        let system = StateSpace::new(a, none, DMatrix::zeros(0, 4), DMatrix::zeros(0, 0), None).unwrap();
        let (system, kept) = constrained(&system, &[positions, speeds]);
        // The largest slopes go: q0 and w0 follow from q1 and w1 = 2 w0 + 4.5 q1.
        assert_eq!(kept, [1, 3]);
        let expected = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -4.0 - 9.0 * 4.5 / 2.0, 4.5]);
        assert!((system.a - expected).amax() < 1e-13);
    }
}
