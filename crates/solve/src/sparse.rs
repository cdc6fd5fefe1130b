//! Sparse systems of linear equations (I - g J) x = b: which entries of J can differ from zero, columns that can be varied
//! together, an order of elimination that fills little, and the factors.
//!
//! Pivots stay on the diagonal, so that all places are known beforehand and a factorisation neither searches nor allocates.
//! For I - g J that is no restriction: a smaller g helps where a pivot is lost.
//!
//! A. R. Curtis, M. J. D. Powell, J. K. Reid: On the estimation of sparse Jacobian matrices, IMA J. Appl. Math. 13 (1974),
//! doi 10.1093/imamat/13.1.117. Order: W. F. Tinney, J. W. Walker: Direct solutions of sparse network equations by optimally
//! ordered triangular factorization, Proc. IEEE 55 (1967), doi 10.1109/PROC.1967.6011.

use std::collections::BTreeSet;

use crate::linear::Singular;

/// Entries of a square matrix that can differ from zero, column by column; the diagonal is always among them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Pattern {
    /// Rows of each column, rising.
    columns: Vec<Vec<usize>>,
}

impl Pattern {
    /// The diagonal alone.
    pub fn diagonal(n: usize) -> Self {
        Self { columns: (0..n).map(|j| vec![j]).collect() }
    }

    /// These rows of each column, in any order, and the diagonal.
    pub fn of(columns: Vec<Vec<usize>>) -> Self {
        let with_diagonal = |(j, mut rows): (usize, Vec<usize>)| {
            rows.push(j);
            rows.sort_unstable();
            rows.dedup();
            rows
        };
        Self { columns: columns.into_iter().enumerate().map(with_diagonal).collect() }
    }

    /// Adds an entry; returns whether it is new.
    pub fn add(&mut self, row: usize, column: usize) -> bool {
        let rows = &mut self.columns[column];
        match rows.binary_search(&row) {
            Ok(_) => false,
            Err(at) => {
                rows.insert(at, row);
                true
            }
        }
    }

    pub fn columns(&self) -> &[Vec<usize>] {
        &self.columns
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.columns.iter().map(Vec::len).sum()
    }

    /// Pairs of columns that share a row, counted in both orders and once for each row.
    pub fn pairs(&self) -> usize {
        let mut in_row = vec![0; self.columns.len()];
        self.columns.iter().flatten().for_each(|&i| in_row[i] += 1);
        in_row.iter().map(|count: &usize| count * count).sum()
    }

    /// Sets of columns no two of which share a row, so that one evaluation tells the slopes of a whole set.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let n = self.columns.len();
        let mut in_row = vec![Vec::new(); n];
        for (j, rows) in self.columns.iter().enumerate() {
            rows.iter().for_each(|&i| in_row[i].push(j));
        }
        let mut colours: Vec<Option<usize>> = vec![None; n];
        let mut groups: Vec<Vec<usize>> = Vec::new();
        // The column that last forbade each colour.
        let mut forbidden: Vec<usize> = Vec::new();
        for j in 0..n {
            let neighbours = self.columns[j].iter().flat_map(|&i| &in_row[i]);
            neighbours.filter_map(|&other| colours[other]).for_each(|colour| forbidden[colour] = j);
            let colour = (0..groups.len()).find(|&colour| forbidden[colour] != j).unwrap_or_else(|| {
                groups.push(Vec::new());
                forbidden.push(usize::MAX);
                groups.len() - 1
            });
            colours[j] = Some(colour);
            groups[colour].push(j);
        }
        groups
    }

    /// Order of elimination: always an unknown with the fewest neighbours left, the first of several.
    fn order(&self) -> Vec<usize> {
        let n = self.columns.len();
        let mut neighbours: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
        for (j, rows) in self.columns.iter().enumerate() {
            for &i in rows.iter().filter(|&&i| i != j) {
                neighbours[i].insert(j);
                neighbours[j].insert(i);
            }
        }
        let mut queue: BTreeSet<(usize, usize)> = (0..n).map(|j| (neighbours[j].len(), j)).collect();
        let mut order = Vec::with_capacity(n);
        while let Some((_, pivot)) = queue.pop_first() {
            order.push(pivot);
            let around = std::mem::take(&mut neighbours[pivot]);
            for &a in &around {
                queue.remove(&(neighbours[a].len(), a));
                neighbours[a].remove(&pivot);
                neighbours[a].extend(around.iter().filter(|&&b| b != a));
                queue.insert((neighbours[a].len(), a));
            }
        }
        order
    }
}

/// Factors of I - g J, where J has a given pattern.
#[derive(Debug)]
pub(crate) struct SparseLu {
    /// Unknown at each place of the order of elimination.
    order: Vec<usize>,
    /// First entry of each row; one more at the end.
    rows: Vec<usize>,
    /// Column of each entry, rising within a row; rows and columns in the order of elimination.
    columns: Vec<usize>,
    /// Entry of each row that is on the diagonal.
    diagonal: Vec<usize>,
    /// L without its ones left of the diagonal, U from there on; the reciprocal of U on the diagonal.
    values: Vec<f64>,
    /// Where the entries of the pattern go, column by column.
    places: Vec<usize>,
    /// One row at full length.
    row: Vec<f64>,
    /// A right side in the order of elimination.
    side: Vec<f64>,
}

impl SparseLu {
    /// Finds the order and the places of all entries, those that elimination fills included.
    pub fn new(pattern: &Pattern) -> Self {
        let n = pattern.columns.len();
        let order = pattern.order();
        let mut place = vec![0; n];
        order.iter().enumerate().for_each(|(at, &unknown)| place[unknown] = at);
        let mut structure: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
        for (j, rows) in pattern.columns.iter().enumerate() {
            rows.iter().for_each(|&i| {
                structure[place[i]].insert(place[j]);
            });
        }
        for i in 0..n {
            let mut row = std::mem::take(&mut structure[i]);
            let mut next = row.first().copied();
            while let Some(k) = next.filter(|&k| k < i) {
                row.extend(structure[k].range(k + 1..));
                next = row.range(k + 1..).next().copied();
            }
            structure[i] = row;
        }
        let mut rows = vec![0];
        let (mut columns, mut diagonal) = (Vec::new(), Vec::new());
        for (i, row) in structure.iter().enumerate() {
            diagonal.push(columns.len() + row.range(..i).count());
            columns.extend(row);
            rows.push(columns.len());
        }
        let at = |i: usize, j: usize| {
            let (start, end) = (rows[i], rows[i + 1]);
            start + columns[start..end].partition_point(|&column| column < j)
        };
        let entries = pattern.columns.iter().enumerate();
        let places = entries
            .flat_map(|(j, rows)| rows.iter().map(|&i| at(place[i], place[j])).collect::<Vec<_>>())
            .collect();
        Self {
            values: vec![0.0; columns.len()],
            row: vec![0.0; n],
            side: vec![0.0; n],
            order,
            rows,
            columns,
            diagonal,
            places,
        }
    }

    /// Factors I - g J; `jacobian` are the values of the pattern, column by column.
    ///
    /// # Errors
    /// [`Singular`] where a pivot is zero or not finite.
    pub fn factor(&mut self, g: f64, jacobian: &[f64]) -> Result<(), Singular> {
        let Self { rows, columns, diagonal, values, places, row, order, .. } = self;
        values.fill(0.0);
        places.iter().zip(jacobian).for_each(|(&place, j)| values[place] = -g * j);
        diagonal.iter().for_each(|&place| values[place] += 1.0);
        for i in 0..diagonal.len() {
            let (start, end, pivot) = (rows[i], rows[i + 1], diagonal[i]);
            for e in start..end {
                row[columns[e]] = values[e];
            }
            for e in start..pivot {
                let k = columns[e];
                let factor = row[k] * values[diagonal[k]];
                row[k] = factor;
                if factor != 0.0 {
                    for other in diagonal[k] + 1..rows[k + 1] {
                        row[columns[other]] -= factor * values[other];
                    }
                }
            }
            for e in start..end {
                values[e] = row[columns[e]];
            }
            let value = values[pivot];
            if value == 0.0 || !value.is_finite() {
                return Err(Singular { column: order[i] });
            }
            values[pivot] = 1.0 / value;
        }
        Ok(())
    }

    /// Overwrites `b` with the solution of (I - g J) x = b.
    pub fn solve(&mut self, b: &mut [f64]) {
        let Self { rows, columns, diagonal, values, side, order, .. } = self;
        for i in 0..order.len() {
            let mut sum = b[order[i]];
            for e in rows[i]..diagonal[i] {
                sum -= values[e] * side[columns[e]];
            }
            side[i] = sum;
        }
        for i in (0..order.len()).rev() {
            let mut sum = side[i];
            for e in diagonal[i] + 1..rows[i + 1] {
                sum -= values[e] * side[columns[e]];
            }
            side[i] = sum * values[diagonal[i]];
            b[order[i]] = side[i];
        }
    }

    /// Number of entries of both factors.
    #[cfg(test)]
    fn len(&self) -> usize {
        self.columns.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::{lu_factor, lu_solve};

    /// A pattern of `n` unknowns with these entries beside the diagonal.
    fn pattern(n: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Pattern {
        let mut pattern = Pattern::diagonal(n);
        entries.into_iter().for_each(|(i, j)| {
            pattern.add(i, j);
        });
        pattern
    }

    fn chain(n: usize) -> Pattern {
        pattern(n, (1..n).flat_map(|i| [(i - 1, i), (i, i - 1)]))
    }

    /// Numbers that look random, of either sign.
    fn scattered(seed: usize) -> impl FnMut() -> f64 {
        let mut k = seed;
        move || {
            k += 1;
            2.0 * (k as f64 * 0.618_033_988_749_894_9).fract() - 1.0
        }
    }

    #[test]
    fn columns_of_a_group_share_no_row() {
        let star = pattern(30, (1..30).map(|i| (i, 0)));
        let arrow = pattern(30, (1..30).map(|i| (0, i)));
        for (pattern, most) in [(chain(50), 3), (star, 2), (arrow, 30), (Pattern::diagonal(9), 1)] {
            let groups = pattern.groups();
            assert_eq!(groups.len(), most);
            assert_eq!(groups.iter().map(Vec::len).sum::<usize>(), pattern.columns().len());
            for group in groups {
                let rows: Vec<usize> = group.iter().flat_map(|&j| pattern.columns()[j].clone()).collect();
                assert_eq!(rows.iter().collect::<BTreeSet<_>>().len(), rows.len());
            }
        }
    }

    #[test]
    fn chains_and_stars_do_not_fill() {
        assert_eq!(SparseLu::new(&chain(1000)).len(), 2998);
        let star = pattern(200, (1..200).flat_map(|i| [(i, 0), (0, i)]));
        assert_eq!(SparseLu::new(&star).len(), star.len());
    }

    #[test]
    fn the_solution_is_that_of_dense_elimination() {
        let mut random = scattered(7);
        for n in [1, 2, 5, 20, 60] {
            let entries: Vec<(usize, usize)> = (0..3 * n)
                .map(|_| ((random().abs() * n as f64) as usize % n, (random().abs() * n as f64) as usize % n))
                .collect();
            let pattern = pattern(n, entries);
            let values: Vec<f64> = (0..pattern.len()).map(|_| random()).collect();
            let side: Vec<f64> = (0..n).map(|_| random()).collect();
            let mut sparse = SparseLu::new(&pattern);
            for g in [1e-3, 0.7] {
                let mut dense = vec![0.0; n * n];
                let entries = pattern.columns().iter().enumerate();
                let places = entries.flat_map(|(j, rows)| rows.iter().map(move |&i| (i, j)));
                places.zip(&values).for_each(|((i, j), v)| dense[i * n + j] = -g * v);
                (0..n).for_each(|i| dense[i * n + i] += 1.0);
                let (mut expected, mut pivots, mut found) = (side.clone(), vec![0; n], side.clone());
                lu_factor(&mut dense, &mut pivots).unwrap();
                lu_solve(&dense, &pivots, &mut expected);
                sparse.factor(g, &values).unwrap();
                sparse.solve(&mut found);
                for (a, b) in found.iter().zip(&expected) {
                    assert!((a - b).abs() < 1e-10 * b.abs().max(1.0), "n = {n}, g = {g}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn a_lost_pivot_is_named() {
        let mut lu = SparseLu::new(&Pattern::diagonal(3));
        assert_eq!(lu.factor(0.5, &[1.0, 2.0, 1.0]), Err(Singular { column: 1 }));
        assert_eq!(lu.factor(0.5, &[1.0, f64::NAN, 1.0]), Err(Singular { column: 1 }));
        assert_eq!(lu.factor(0.5, &[1.0, 1.0, 1.0]), Ok(()));
    }
}
