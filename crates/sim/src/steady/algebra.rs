//! Linear equations that may have no solution, or many.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_linear::DMatrix;

/// Directions that move the equations by less than this part are left alone.
pub(super) const RANK: f64 = 1e-11;

/// Part of the largest effect on an equation below which another one is rounding: a tenth of that of a number.
const UNFELT: f64 = 1e-17;

/// Unknowns above which a factorisation is tried that is quick but tells nothing of singular systems.
pub(super) const LARGE: usize = 60;

/// Equations and unknowns brought to like size: `rows A columns`.
struct Scaled {
    matrix: DMatrix<f64>,
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl Scaled {
    fn new(mut matrix: DMatrix<f64>, sizes: &[f64]) -> Self {
        let mut columns = sizes.to_vec();
        matrix.column_iter_mut().zip(sizes).for_each(|(mut column, size)| column.scale_mut(*size));
        let mut rows = vec![1.0; matrix.nrows()];
        for (mut row, scale) in matrix.row_iter_mut().zip(&mut rows) {
            *scale = inverse(row.amax());
            row.scale_mut(*scale);
            row.apply(|slope| *slope = if slope.abs() < UNFELT { 0.0 } else { *slope });
        }
        for (mut column, scale) in matrix.column_iter_mut().zip(&mut columns) {
            let factor = inverse(column.amax());
            column.scale_mut(factor);
            *scale *= factor;
        }
        Self { matrix, rows, columns }
    }
}

fn inverse(largest: f64) -> f64 {
    if largest > 0.0 && largest.is_finite() { 1.0 / largest } else { 1.0 }
}

/// The shortest `s`, sizes of the unknowns taken into account, for which `matrix s` comes closest to `right`. None if it cannot
/// be computed.
pub(super) fn least(matrix: DMatrix<f64>, right: &[f64], sizes: &[f64]) -> Option<Vec<f64>> {
    if matrix.is_empty() {
        return Some(vec![0.0; matrix.ncols()]);
    }
    let Scaled { matrix, rows, columns } = Scaled::new(matrix, sizes);
    let right = DMatrix::from_fn(right.len(), 1, |i, _| right[i] * rows[i]);
    let solution = match regular(&matrix, &right) {
        Some(solution) => solution,
        None => {
            let stretch: Vec<f64> = columns.iter().zip(sizes).map(|(column, size)| column / size).collect();
            singular(matrix, right, &stretch)?
        }
    };
    let step: Vec<f64> = solution.iter().zip(&columns).map(|(step, size)| step * size).collect();
    step.iter().all(|step| step.is_finite()).then_some(step)
}

/// The solution of a system that may be singular; of several the one that is shortest where each unknown is measured by `stretch`.
fn singular(matrix: DMatrix<f64>, right: DMatrix<f64>, stretch: &[f64]) -> Option<DMatrix<f64>> {
    let (rows, unknowns) = matrix.shape();
    let missing = unknowns.saturating_sub(rows);
    let (matrix, right) = (matrix.insert_rows(rows, missing, 0.0), right.insert_rows(rows, missing, 0.0));
    let is_idle: Vec<bool> = matrix.column_iter().map(|column| column.amax() == 0.0).collect();
    let parts = matrix.try_svd(true, true, f64::EPSILON, 10_000)?;
    let border = RANK * parts.singular_values.max();
    let mut found = parts.solve(&right, border).ok()?;
    let is_free = |direction: &usize| parts.singular_values[*direction] <= border;
    let free: Vec<usize> = (0..unknowns).filter(is_free).collect();
    let free = parts.v_t?.select_rows(&free).transpose();
    if !free.is_empty() {
        let stretched = |mut values: DMatrix<f64>| {
            values.row_iter_mut().zip(stretch).for_each(|(mut row, stretch)| row.scale_mut(*stretch));
            values
        };
        let along = stretched(free.clone()).try_svd(true, true, f64::EPSILON, 10_000)?;
        let border = RANK * along.singular_values.max();
        let share = along.solve(&stretched(found.clone()), border).ok()?;
        found -= free * share;
    }
    // What nothing depends on stays exactly where it is.
    found.iter_mut().zip(&is_idle).for_each(|(step, is_idle)| *step = if *is_idle { 0.0 } else { *step });
    Some(found)
}

/// The solution of a large system that is clearly regular.
fn regular(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if !matrix.is_square() || matrix.nrows() <= LARGE {
        return None;
    }
    if let Some((pivots, solution)) = eliminate(matrix, right) {
        return is_regular(&pivots).then_some(solution);
    }
    let factors = matrix.clone().full_piv_lu();
    is_regular(factors.u().diagonal().as_slice()).then(|| factors.solve(right)).flatten()
}

/// Whether no pivot is small beside the largest.
fn is_regular(pivots: &[f64]) -> bool {
    let size = |extreme: fn(f64, f64) -> f64, start: f64| {
        pivots.iter().map(|pivot| pivot.abs()).fold(start, extreme)
    };
    size(f64::min, f64::INFINITY) > RANK.sqrt() * size(f64::max, 0.0)
}

/// Part of the largest entry of its column that a pivot has at least.
const STABLE: f64 = 0.1;
/// Part of all entries above which a matrix does not count as sparse.
const CROWDED: f64 = 0.1;

/// The pivots and the solution of a sparse system by Gaussian elimination, where always a column with few entries is next, and
/// of its rows with large enough an entry the shortest (H. M. Markowitz, Management Science 3 (1957) 255, with threshold). None if
/// the matrix is not sparse or does not stay so.
fn eliminate(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    let most = (CROWDED * (n * n) as f64) as usize;
    let mut rows: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); n];
    let mut columns: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
    let mut entries = 0;
    for (j, column) in matrix.column_iter().enumerate() {
        for (i, &value) in column.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            rows[i].insert(j, value);
            columns[j].insert(i);
            entries += 1;
        }
    }
    let mut right: Vec<f64> = right.iter().copied().collect();
    let mut left: BTreeSet<(usize, usize)> = (0..n).map(|j| (columns[j].len(), j)).collect();
    let mut done = Vec::with_capacity(n);
    while let Some((_, j)) = left.pop_first() {
        if entries > most {
            return None;
        }
        let largest = columns[j].iter().fold(0.0, |largest: f64, &i| largest.max(rows[i][&j].abs()));
        let candidates = columns[j].iter().filter(|&&i| rows[i][&j].abs() >= STABLE * largest);
        let Some(&pivot) = candidates.min_by_key(|&&i| rows[i].len()).filter(|_| largest > 0.0) else {
            // A singular matrix, as its pivots tell.
            return Some((vec![0.0], DMatrix::zeros(n, 1)));
        };
        let own = std::mem::take(&mut rows[pivot]);
        for &k in own.keys().filter(|k| **k != j) {
            left.remove(&(columns[k].len(), k));
            columns[k].remove(&pivot);
        }
        let others = std::mem::take(&mut columns[j]);
        for i in others.into_iter().filter(|i| *i != pivot) {
            let factor = rows[i].remove(&j).unwrap_or(0.0) / own[&j];
            entries -= 1;
            for (&k, value) in own.iter().filter(|(k, _)| **k != j) {
                *rows[i].entry(k).or_insert(0.0) -= factor * value;
                entries += usize::from(columns[k].insert(i));
            }
            right[i] -= factor * right[pivot];
        }
        left.extend(own.keys().filter(|k| **k != j).map(|&k| (columns[k].len(), k)));
        done.push((pivot, j, own));
    }
    let mut solution = DMatrix::zeros(n, 1);
    for (pivot, j, own) in done.iter().rev() {
        let others: f64 = own.iter().filter(|(k, _)| *k != j).map(|(&k, value)| value * solution[k]).sum();
        solution[*j] = (right[*pivot] - others) / own[j];
    }
    Some((done.iter().map(|(_, j, own)| own[j]).collect(), solution))
}

/// Which unknowns take part, by more than the share `least`, in directions that the equations say nothing about.
pub(super) fn undetermined(matrix: DMatrix<f64>, sizes: &[f64], least: f64) -> Vec<bool> {
    let unknowns = matrix.ncols();
    if unknowns == 0 {
        return Vec::new();
    }
    let mut square = Scaled::new(matrix, sizes).matrix;
    if unknowns > LARGE && square.is_square() {
        let zero = DMatrix::zeros(unknowns, 1);
        if regular(&square, &zero).is_some() {
            return vec![false; unknowns];
        }
    }
    if square.nrows() < unknowns {
        let missing = unknowns - square.nrows();
        square = square.insert_rows(unknowns - missing, missing, 0.0);
    }
    let Some(parts) = square.try_svd(false, true, f64::EPSILON, 10_000) else { return vec![false; unknowns] };
    let border = RANK * parts.singular_values.max();
    let mut part = vec![false; unknowns];
    if let Some(directions) = parts.v_t {
        for (direction, &value) in directions.row_iter().zip(&parts.singular_values) {
            if value <= border {
                part.iter_mut().zip(direction.iter()).for_each(|(part, share)| *part |= share.abs() > least);
            }
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_system_gets_the_shortest_step_and_names_what_is_free() {
        // x0 + x1 = 2 says nothing of x2; the second equation repeats the first.
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let step = least(matrix.clone(), &[2.0, 4.0, 0.0], &[1.0; 3]).unwrap();
        assert!(step.iter().zip([1.0, 1.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-14), "{step:?}");
        assert_eq!(undetermined(matrix, &[1.0; 3], 1e-3), [true, true, true]);
        let one = DMatrix::from_row_slice(1, 2, &[1e-9, 0.0]);
        assert_eq!(undetermined(one, &[1.0; 2], 1e-3), [false, true]);
    }

    /// x0 + 1000 x1 = 2: both move by as much as its share of the equation, not each by half of the way.
    #[test]
    fn of_several_steps_the_one_that_is_shortest_by_sizes_is_taken() {
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 1e3, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        let step = least(matrix.clone(), &[2.0, 3.0, 0.0], &[1.0; 3]).unwrap();
        let share = 2.0 / (1.0 + 1e6);
        assert!(
            (step[0] / share - 1.0).abs() < 1e-9 && (step[1] / (1e3 * share) - 1.0).abs() < 1e-9,
            "{step:?}"
        );
        assert!((step[2] - 3.0).abs() < 1e-12, "{step:?}");
        let step = least(matrix, &[2.0, 3.0, 0.0], &[1e3, 1.0, 1.0]).unwrap();
        assert!((step[0] - 1.0).abs() < 1e-9 && (step[1] - 1e-3).abs() < 1e-12, "{step:?}");
    }

    #[test]
    fn sizes_that_lie_far_apart_cost_no_digits_and_large_systems_none_either() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1e12, 1.0, 0.0, 1e-12]);
        let step = least(matrix, &[1e12, 2e-12], &[1.0, 1.0]).unwrap();
        assert!((step[0] - 1.0).abs() < 1e-11 && (step[1] - 2.0).abs() < 1e-12, "{step:?}");
        let n = 80;
        let chain = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => -2.0,
            1 => 1.0,
            _ => 0.0,
        });
        let right: Vec<f64> = (0..n).map(|i| if i + 1 == n { -1.0 } else { 0.0 }).collect();
        let step = least(chain, &right, &vec![1.0; n]).unwrap();
        for (i, value) in step.iter().enumerate() {
            assert!((value - (i + 1) as f64 / (n + 1) as f64).abs() < 1e-12, "{i}: {value}");
        }
    }
}
