//! Elimination of sparse linear systems whose right-hand sides are linear forms.
//!
//! `A x = B s`, each row of `A` with few entries. Pivots keep the rows short (H. M. Markowitz, *The elimination form of the
//! inverse and its application to linear programming*, Management Science 3 (1957)) as long as they are not much smaller
//! than the largest entry of their row. A chain of any length so costs in proportion to its length.

/// A pivot is at least this part of the largest entry of its row.
const THRESHOLD: f64 = 0.1;
/// Entries below this part of what has cancelled there are zero.
const ZERO: f64 = 1e-14;

/// Indices with coefficients, ascending.
pub(crate) type Row = Vec<(u32, f64)>;

/// A system that is being built.
#[derive(Debug, Clone)]
pub(crate) struct System {
    rows: Vec<Row>,
    right: Vec<Row>,
    given: usize,
}

impl System {
    /// Of as many equations as unknowns.
    pub(crate) fn new(size: usize, given: usize) -> Self {
        Self { rows: vec![Row::new(); size], right: vec![Row::new(); size], given }
    }

    pub(crate) fn add(&mut self, row: usize, column: usize, value: f64) {
        put(&mut self.rows[row], column, value);
    }

    pub(crate) fn add_right(&mut self, row: usize, given: usize, value: f64) {
        put(&mut self.right[row], given, value);
    }

    /// Each unknown over the given values, if the equations determine all of them.
    pub(crate) fn solve(&self) -> Option<Vec<Row>> {
        let n = self.rows.len();
        let (mut rows, mut right) = (self.rows.clone(), self.right.clone());
        // Size of what has been added up in each row.
        let scale: Vec<f64> = rows.iter().map(|row| largest(row)).collect();
        let mut columns: Vec<Vec<u32>> = vec![Vec::new(); n];
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|(j, _)| columns[*j as usize].push(i as u32));
        }
        let mut open: Vec<bool> = vec![true; n];
        let mut order: Vec<(usize, usize)> = Vec::with_capacity(n);
        let mut by_length: Vec<Vec<u32>> = vec![Vec::new(); n + 2];
        for (i, row) in rows.iter().enumerate() {
            by_length[row.len()].push(i as u32);
        }
        for _ in 0..n {
            let i = shortest(&mut by_length, &rows, &open)?;
            let most = largest(&rows[i]);
            if most <= ZERO * scale[i] {
                return None;
            }
            let pivots = rows[i].iter().filter(|(_, value)| value.abs() >= THRESHOLD * most);
            let j = pivots.min_by_key(|(j, _)| (columns[*j as usize].len(), *j))?.0;
            open[i] = false;
            order.push((i, j as usize));
            let (pivot_row, pivot_right) = (std::mem::take(&mut rows[i]), std::mem::take(&mut right[i]));
            let pivot = value_at(&pivot_row, j);
            for k in std::mem::take(&mut columns[j as usize]) {
                let k = k as usize;
                if !open[k] {
                    continue;
                }
                let factor = value_at(&rows[k], j) / pivot;
                if factor == 0.0 {
                    continue;
                }
                let mut sum = plus(&rows[k], &pivot_row, -factor);
                sum.retain(|(column, _)| *column != j);
                for (column, _) in &pivot_row {
                    let new = *column != j
                        && value_at(&rows[k], *column) == 0.0
                        && rows[k].binary_search_by_key(column, |entry| entry.0).is_err();
                    if new {
                        columns[*column as usize].push(k as u32);
                    }
                }
                by_length[sum.len()].push(k as u32);
                rows[k] = sum;
                right[k] = plus(&right[k], &pivot_right, -factor);
            }
            (rows[i], right[i]) = (pivot_row, pivot_right);
        }
        let mut sum = Sum::new(self.given);
        let mut solution: Vec<Row> = vec![Row::new(); n];
        for (i, j) in order.into_iter().rev() {
            let pivot = value_at(&rows[i], j as u32);
            sum.add(&right[i], 1.0 / pivot);
            let others = rows[i].iter().filter(|(column, _)| *column as usize != j);
            for (column, value) in others {
                sum.add(&solution[*column as usize], -value / pivot);
            }
            solution[j] = sum.take();
        }
        Some(solution)
    }

    /// Largest error of a solution in any equation, and the size that it is to be compared with.
    pub(crate) fn error(&self, solution: &[Row]) -> (f64, f64) {
        let mut sum = Sum::new(self.given);
        let (mut error, mut scale) = (0.0_f64, 0.0_f64);
        for (row, right) in self.rows.iter().zip(&self.right) {
            row.iter().for_each(|(j, value)| sum.add(&solution[*j as usize], *value));
            sum.add(right, -1.0);
            error = error.max(largest(&sum.take()));
            scale = scale.max(largest(right)).max(1e-3 * largest(row));
        }
        let finite = solution.iter().flatten().all(|(_, value)| value.is_finite());
        (if finite { error } else { f64::INFINITY }, scale)
    }
}

/// `a + factor b`; what cancels to rounding is dropped.
pub(crate) fn plus(a: &[(u32, f64)], b: &[(u32, f64)], factor: f64) -> Row {
    let mut sum = Row::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.iter().peekable(), b.iter().peekable());
    loop {
        match (a.peek(), b.peek()) {
            (Some(x), Some(y)) if x.0 == y.0 => {
                let (left, right) = (x.1, factor * y.1);
                if (left + right).abs() > ZERO * left.abs().max(right.abs()) {
                    sum.push((x.0, left + right));
                }
                a.next();
                b.next();
            }
            (Some(x), y) if y.is_none_or(|y| x.0 < y.0) => sum.extend(a.next()),
            (_, Some(_)) => sum.extend(b.next().map(|(i, value)| (*i, factor * value))),
            _ => return sum,
        }
    }
}

fn put(row: &mut Row, column: usize, value: f64) {
    match row.binary_search_by_key(&(column as u32), |entry| entry.0) {
        Ok(at) => row[at].1 += value,
        Err(at) => row.insert(at, (column as u32, value)),
    }
}

fn value_at(row: &[(u32, f64)], column: u32) -> f64 {
    row.binary_search_by_key(&column, |entry| entry.0).map_or(0.0, |at| row[at].1)
}

fn largest(row: &[(u32, f64)]) -> f64 {
    row.iter().fold(0.0, |most, (_, value)| most.max(value.abs()))
}

/// The open row with the fewest entries; lengths that have changed since are passed over.
fn shortest(by_length: &mut [Vec<u32>], rows: &[Row], open: &[bool]) -> Option<usize> {
    for (length, list) in by_length.iter_mut().enumerate() {
        while let Some(i) = list.pop() {
            let i = i as usize;
            if open[i] && rows[i].len() == length {
                return (length > 0).then_some(i);
            }
        }
    }
    None
}

/// A sum of forms.
struct Sum {
    values: Vec<f64>,
    /// Largest term of each.
    terms: Vec<f64>,
    touched: Vec<u32>,
}

impl Sum {
    fn new(given: usize) -> Self {
        Self { values: vec![0.0; given], terms: vec![0.0; given], touched: Vec::new() }
    }

    fn add(&mut self, row: &[(u32, f64)], factor: f64) {
        for (i, value) in row {
            let (at, term) = (*i as usize, factor * value);
            if self.terms[at] == 0.0 {
                self.touched.push(*i);
            }
            self.values[at] += term;
            self.terms[at] = self.terms[at].max(term.abs()).max(f64::MIN_POSITIVE);
        }
    }

    fn take(&mut self) -> Row {
        self.touched.sort_unstable();
        let mut row = Row::with_capacity(self.touched.len());
        for i in self.touched.drain(..) {
            let at = i as usize;
            let (value, term) = (self.values[at], self.terms[at]);
            (self.values[at], self.terms[at]) = (0.0, 0.0);
            if value.abs() > ZERO * term || value.is_nan() {
                row.push((i, value));
            }
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_system_is_solved_for_each_given_value() {
        // 2 y + z = a, x = b, y - z = 2 b
        let mut system = System::new(3, 2);
        for (row, column, value) in [(0, 1, 2.0), (0, 2, 1.0), (1, 0, 1.0), (2, 1, 1.0), (2, 2, -1.0)] {
            system.add(row, column, value);
        }
        system.add_right(0, 0, 1.0);
        system.add_right(1, 1, 1.0);
        system.add_right(2, 1, 2.0);
        let x = system.solve().unwrap();
        assert_eq!(x[0], [(1, 1.0)]);
        let expected = [[1.0 / 3.0, 2.0 / 3.0], [1.0 / 3.0, -4.0 / 3.0]];
        for (row, expected) in x[1..].iter().zip(expected) {
            (0..2).for_each(|k| assert!((value_at(row, k) - expected[k as usize]).abs() < 1e-15, "{x:?}"));
        }
        let (error, scale) = system.error(&x);
        assert!(error <= 1e-15 * scale);
    }

    #[test]
    fn what_says_nothing_new_leaves_something_open() {
        let mut system = System::new(2, 1);
        for (row, column, value) in [(0, 0, 1.0), (0, 1, 0.1), (1, 0, 3.0), (1, 1, 0.3)] {
            system.add(row, column, value);
        }
        assert_eq!(system.solve(), None);
    }

    #[test]
    fn a_long_ladder_stays_sparse() {
        // Nodes between resistances of 1 ohm in a row, each with a given voltage beside it behind 2 ohm.
        let n = 2000;
        let mut system = System::new(n, n);
        for k in 0..n {
            system.add(k, k, 2.5);
            system.add_right(k, k, 0.5);
            if k > 0 {
                system.add(k, k - 1, -1.0);
                system.add(k - 1, k, -1.0);
            }
        }
        let x = system.solve().unwrap();
        let (error, scale) = system.error(&x);
        assert!(error <= 1e-13 * scale);
    }
}
