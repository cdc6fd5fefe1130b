//! Exact elimination of linear relations with constant coefficients.

/// Numbers below this, relative to the largest of a row, count as zero. Coefficients are ratios of tooth numbers
/// and ones, so exact zeros are missed by rounding alone.
const ZERO: f64 = 1e-11;

/// Relations `A z = B s` between unknowns `z` and given values `s`.
#[derive(Debug, Clone)]
pub(crate) struct Relations {
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of given values.
    pub given: usize,
    rows: Vec<Vec<f64>>,
}

/// What elimination found.
#[derive(Debug, Clone)]
pub(crate) struct Eliminated {
    /// Unknowns that stay independent, in ascending order.
    pub free: Vec<usize>,
    /// Each unknown over the independent ones.
    pub over_free: Vec<Vec<f64>>,
    /// Each unknown over the given values.
    pub over_given: Vec<Vec<f64>>,
    /// Rows that say nothing new: their index and whether they contradict the others (given values fight).
    pub dependent: Vec<(usize, bool)>,
}

impl Relations {
    pub(crate) fn new(unknowns: usize, given: usize) -> Self {
        Self { unknowns, given, rows: Vec::new() }
    }

    /// Adds `sum a z = sum b s`; returns the index of the row.
    pub(crate) fn add(&mut self, a: &[(usize, f64)], b: &[(usize, f64)]) -> usize {
        let mut row = vec![0.0; self.unknowns + self.given];
        a.iter().for_each(|(i, value)| row[*i] += value);
        b.iter().for_each(|(i, value)| row[self.unknowns + i] += value);
        self.rows.push(row);
        self.rows.len() - 1
    }

    /// Coefficients of the unknowns in a row.
    pub(crate) fn row(&self, row: usize) -> &[f64] {
        &self.rows[row][..self.unknowns]
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Gauss-Jordan elimination. In each row the unknown that is eliminated is chosen among those for which
    /// `prefer` is smallest, there by the largest coefficient, there by the highest index: the result does not
    /// depend on the order in which anything was written.
    pub(crate) fn eliminate(&self, prefer: impl Fn(usize) -> u32) -> Eliminated {
        let (n, m) = (self.unknowns, self.given);
        let mut done: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut dependent = Vec::new();
        for (index, row) in self.rows.iter().enumerate() {
            let mut row = row.clone();
            let scale = row.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
            for (pivot, other) in &done {
                let factor = row[*pivot];
                if factor != 0.0 {
                    row.iter_mut().zip(other).for_each(|(to, from)| *to -= factor * from);
                }
            }
            row.iter_mut().filter(|value| value.abs() <= ZERO * scale).for_each(|value| *value = 0.0);
            let pivot = (0..n).filter(|i| row[*i] != 0.0).min_by(|i, j| {
                prefer(*i).cmp(&prefer(*j)).then(row[*j].abs().total_cmp(&row[*i].abs())).then(j.cmp(i))
            });
            let Some(pivot) = pivot else {
                dependent.push((index, row[n..].iter().any(|value| *value != 0.0)));
                continue;
            };
            let inverse = 1.0 / row[pivot];
            row.iter_mut().for_each(|value| *value *= inverse);
            for (_, other) in &mut done {
                let factor = other[pivot];
                if factor != 0.0 {
                    other.iter_mut().zip(&row).for_each(|(to, from)| *to -= factor * from);
                }
            }
            done.push((pivot, row));
        }
        let free: Vec<usize> = (0..n).filter(|i| done.iter().all(|(pivot, _)| pivot != i)).collect();
        let mut over_free = vec![vec![0.0; free.len()]; n];
        let mut over_given = vec![vec![0.0; m]; n];
        for (k, i) in free.iter().enumerate() {
            over_free[*i][k] = 1.0;
        }
        for (pivot, row) in &done {
            for (k, i) in free.iter().enumerate() {
                over_free[*pivot][k] = -row[*i];
            }
            over_given[*pivot].copy_from_slice(&row[n..]);
        }
        Eliminated { free, over_free, over_given, dependent }
    }
}

/// A sparse linear form over one or two lists of values.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Form {
    terms: Vec<(u32, f64)>,
}

impl Form {
    pub(crate) fn from_dense(row: &[f64]) -> Self {
        let scale = row.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        let terms = row.iter().enumerate().filter(|(_, value)| value.abs() > 1e-14 * scale);
        Self { terms: terms.map(|(i, value)| (i as u32, *value)).collect() }
    }

    /// With these coefficients, none of them zero, by ascending indices.
    pub(crate) fn from_terms(terms: impl IntoIterator<Item = (u32, f64)>) -> Self {
        Self { terms: terms.into_iter().collect() }
    }

    pub(crate) fn terms(&self) -> &[(u32, f64)] {
        &self.terms
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// One coefficient.
    pub(crate) fn at(&self, index: usize) -> f64 {
        self.terms.iter().find(|(i, _)| *i as usize == index).map_or(0.0, |(_, factor)| *factor)
    }

    #[inline]
    pub(crate) fn of(&self, values: &[f64]) -> f64 {
        self.terms.iter().map(|(i, factor)| factor * values[*i as usize]).sum()
    }

    /// `out += factor * form'`.
    #[inline]
    pub(crate) fn add_to(&self, factor: f64, out: &mut [f64]) {
        self.terms.iter().for_each(|(i, value)| out[*i as usize] += factor * value);
    }

    /// `matrix += factor * form' form`, for a row-major square matrix.
    #[inline]
    pub(crate) fn square_to(&self, factor: f64, matrix: &mut [f64], n: usize) {
        for (i, a) in &self.terms {
            for (j, b) in &self.terms {
                matrix[*i as usize * n + *j as usize] += factor * a * b;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gear_leaves_one_speed_and_prefers_to_keep_the_other_kind() {
        // w1 = -50 w0, w0 = z2 (the joint)
        let mut relations = Relations::new(3, 0);
        relations.add(&[(1, 1.0), (0, 50.0)], &[]);
        relations.add(&[(0, 1.0), (2, -1.0)], &[]);
        let e = relations.eliminate(|i| u32::from(i == 2));
        assert_eq!(e.free, [2]);
        assert_eq!(e.over_free, [[1.0], [-50.0], [1.0]]);
        assert!(e.dependent.is_empty());
    }

    #[test]
    fn two_given_values_for_one_unknown_fight() {
        let mut relations = Relations::new(1, 2);
        relations.add(&[(0, 1.0)], &[(0, 1.0)]);
        relations.add(&[(0, 1.0)], &[(1, 1.0)]);
        assert_eq!(relations.eliminate(|_| 0).dependent, [(1, true)]);
    }

    #[test]
    fn the_same_relation_twice_says_nothing_new() {
        let mut relations = Relations::new(2, 0);
        relations.add(&[(0, 3.0), (1, -1.0)], &[]);
        relations.add(&[(0, 6.0), (1, -2.0)], &[]);
        assert_eq!(relations.eliminate(|_| 0).dependent, [(1, false)]);
    }
}
