//! States that others decide.

use nalgebra::DMatrix;

/// A row whose entries are all below this part of what the values of its kind are made of is rounding.
const ROUNDING: f64 = 1e-6;
/// A constraint of which less than this part is left after others have been obeyed says the same as these.
const DEPENDENT: f64 = 1e-6;

/// Slopes, over the states and then the inputs of a system, of values that are zero whatever happens.
#[derive(Debug, Clone)]
pub struct Constrained {
    /// Rows of values of one kind, rows x (states + inputs).
    pub gaps: DMatrix<f64>,
    /// Which states may be said to follow from others by them; the second ones where the first ones do not suffice.
    pub followers: [Vec<usize>; 2],
    /// Slopes of what these are made of, any number of rows; those of the gaps are rounding where they are small against them.
    pub terms: DMatrix<f64>,
}

/// The directions in which a system can move.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions {
    /// The states that are free, in their order.
    pub kept: Vec<usize>,
    /// What all states and inputs change by with each of the free states and each input, (states + inputs) x (kept + inputs).
    pub all: DMatrix<f64>,
}

/// The directions in which a system of so many states and inputs obeys its constraints.
///
/// Of `H x + G u = 0` as many states are eliminated as there are independent rows, by Gaussian elimination with the largest of the slopes over
/// those that may follow as the pivot.
///
/// # Panics
/// If the widths of the slopes are not those of the system.
pub fn directions(states: usize, inputs: usize, constraints: &[Constrained]) -> Directions {
    let (n, m) = (states, inputs);
    let mut rows: Vec<Row> = constraints.iter().flat_map(scaled).collect();
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    for rank in [0, 1] {
        while let Some(pivot) = largest(&rows, &pivots, rank) {
            eliminate(&mut rows, pivot);
            pivots.push(pivot);
        }
    }
    let kept: Vec<usize> = (0..n).filter(|k| pivots.iter().all(|(_, column)| column != k)).collect();
    let mut all = DMatrix::zeros(n + m, kept.len() + m);
    kept.iter().copied().chain(n..n + m).enumerate().for_each(|(j, k)| all[(k, j)] = 1.0);
    for (row, column) in pivots {
        let from = kept.iter().copied().chain(n..n + m).enumerate();
        from.for_each(|(j, k)| all[(column, j)] = -rows[row].slopes[k]);
    }
    Directions { kept, all }
}

/// A constraint: its slopes, the largest of them over a state that may follow 1.
struct Row {
    slopes: Vec<f64>,
    followers: [Vec<usize>; 2],
}

/// Where the largest slope over a state that may follow stands among the rows without a pivot: row and column.
fn largest(rows: &[Row], pivots: &[(usize, usize)], rank: usize) -> Option<(usize, usize)> {
    let free = rows.iter().enumerate().filter(|(i, _)| pivots.iter().all(|(row, _)| row != i));
    let entries = free.flat_map(|(i, row)| row.followers[rank].iter().map(move |k| (i, *k)));
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
fn scaled(kind: &Constrained) -> Vec<Row> {
    let may_follow = || kind.followers.iter().flatten().copied();
    let over = |slopes: &DMatrix<f64>, row: usize| -> f64 {
        may_follow().fold(0.0, |most: f64, k| most.max(slopes[(row, k)].abs()))
    };
    let all = |slopes: &DMatrix<f64>| (0..slopes.nrows()).map(|row| over(slopes, row)).fold(0.0, f64::max);
    let rounding = ROUNDING * all(&kind.gaps).max(all(&kind.terms));
    let row = |i: usize| -> Option<Row> {
        let largest = over(&kind.gaps, i);
        let slopes = kind.gaps.row(i);
        let slopes = slopes.iter().map(|slope| if slope.abs() <= rounding { 0.0 } else { slope / largest });
        let slopes = slopes.collect();
        (largest > rounding).then(|| Row { slopes, followers: kind.followers.clone() })
    };
    (0..kind.gaps.nrows()).filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(gaps: &[f64], width: usize, states: &[usize]) -> Constrained {
        Constrained {
            gaps: DMatrix::from_row_slice(gaps.len() / width, width, gaps),
            followers: [states.to_vec(), Vec::new()],
            terms: DMatrix::zeros(0, width),
        }
    }

    /// A matrix over all states, over those that are free.
    fn reduced(a: &DMatrix<f64>, found: &Directions) -> DMatrix<f64> {
        (a * &found.all).select_rows(&found.kept)
    }

    /// Two windings in series at a source, 12 V - 2 mH - 3 mH - 1 ohm, as a solver has them: both carry the same current, and each
    /// knows the voltage over itself; the second state drifts to the first at `rate`. Over both and the voltage.
    fn series(rate: f64) -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 3, &[-200.0, 0.0, 200.0, rate - 200.0, -rate, 200.0])
    }

    #[test]
    fn windings_in_series_are_one_state_whatever_holds_them_together() {
        for rate in [0.0, 5e3] {
            let found = directions(2, 1, &[kind(&[1.0, -1.0, 0.0], 3, &[0, 1])]);
            assert_eq!(found.kept, [0]);
            assert_eq!(reduced(&series(rate), &found), DMatrix::from_row_slice(1, 2, &[-200.0, 200.0]));
        }
    }

    #[test]
    fn what_says_the_same_twice_counts_once_and_rounding_does_not_count() {
        let same = kind(&[1.0, -1.0, 0.0, -2.0, 2.0 + 1e-9, 0.0], 3, &[0, 1]);
        assert_eq!(directions(2, 1, &[same]).kept, [0]);
        let rounding = kind(&[1e-12, 0.0, 0.0], 3, &[0, 1]);
        let of = Constrained { terms: DMatrix::from_row_slice(1, 3, &[1.0, 0.0, 0.0]), ..rounding };
        assert_eq!(directions(2, 1, &[of]).kept, [0, 1]);
        assert_eq!(directions(2, 1, &[kind(&[], 3, &[0, 1])]).kept, [0, 1]);
        assert_eq!(directions(2, 1, &[]).all, DMatrix::identity(3, 3));
    }

    #[test]
    fn a_state_that_an_input_decides_passes_it_on_at_once() {
        // x1 = 2 u, x0' = -x0 + 3 x1.
        let a = DMatrix::from_row_slice(2, 3, &[-1.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
        let found = directions(2, 1, &[kind(&[0.0, 1.0, -2.0], 3, &[0, 1])]);
        assert_eq!(found.kept, [0]);
        assert_eq!(reduced(&a, &found), DMatrix::from_row_slice(1, 2, &[-1.0, 6.0]));
    }

    #[test]
    fn speeds_follow_from_speeds_though_their_law_changes_faster_with_positions() {
        // q1 = 2 q0 and w1 = 2 w0 + 9 q0, over q0, q1, w0, w1.
        let positions = kind(&[2.0, -1.0, 0.0, 0.0], 4, &[0, 1]);
        let speeds = kind(&[9.0, 0.0, 2.0, -1.0], 4, &[2, 3]);
        let a = DMatrix::from_row_slice(
            4,
            4,
            &[0., 0., 1., 0., 0., 0., 0., 1., -4., 0., 0., 0., -8., 0., 9., 0.],
        );
        let found = directions(4, 0, &[positions, speeds]);
        // The largest slopes go: q0 and w0 follow from q1 and w1 = 2 w0 + 4.5 q1.
        assert_eq!(found.kept, [1, 3]);
        let expected = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -4.0 - 9.0 * 4.5 / 2.0, 4.5]);
        assert!((reduced(&a, &found) - expected).amax() < 1e-13);
    }

    #[test]
    fn an_angle_never_follows_however_steep_currents_are_over_it() {
        // A choke of two currents at a machine of one, whose frame turns by an angle: 50 A/rad.
        let rows = [1.0, 0.0, -0.8, 50.0, 0.0, 1.0, 0.6, -40.0];
        let currents = Constrained { followers: [vec![0, 1], vec![2]], ..kind(&rows, 4, &[]) };
        let found = directions(4, 0, &[currents]);
        assert_eq!(found.kept, [2, 3]);
        // One more relation than chokes: then the machine's own goes, and the angle stays.
        let rows = [rows.as_slice(), &[1.0, 1.0, 0.0, 10.0]].concat();
        let currents = Constrained { followers: [vec![0, 1], vec![2]], ..kind(&rows, 4, &[]) };
        assert_eq!(directions(4, 0, &[currents]).kept, [3]);
    }
}
