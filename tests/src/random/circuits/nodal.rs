//! The equations of one stage: potentials of the nodes and currents of the transformers, for a set of conducting legs.

use std::collections::HashMap;

/// A conductance and a current from `p` to `n`; node 0 is ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Admittance {
    pub p: usize,
    pub n: usize,
    pub g: f64,
    /// Added to the current from `p` to `n`.
    pub i: f64,
}

/// Two windings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Windings {
    pub first: (usize, usize),
    pub second: (usize, usize),
    pub ratio: f64,
}

/// Factors of the matrices that have been met, by what makes them differ.
#[derive(Debug, Default)]
pub(super) struct Factors(HashMap<(u64, u64), Factor>);

/// Rows of both factors, and the order of the rows.
#[derive(Debug)]
struct Factor {
    rows: Vec<Vec<f64>>,
    order: Vec<usize>,
}

impl Factors {
    /// Potentials of the nodes, ground first. `key` tells all conductances.
    pub fn solve(
        &mut self,
        key: (u64, u64),
        nodes: usize,
        parts: &[Admittance],
        windings: &[Windings],
    ) -> Vec<f64> {
        let factor = self.0.entry(key).or_insert_with(|| Factor::new(matrix(nodes, parts, windings)));
        let mut right = vec![0.0; nodes + windings.len() + 1];
        for part in parts {
            right[part.p] -= part.i;
            right[part.n] += part.i;
        }
        let mut v = vec![0.0];
        v.extend(factor.solve(&right[1..]));
        v.truncate(nodes + 1);
        v
    }
}

/// Currents into each node but ground, over potentials and currents of the windings, then the ratios of the windings.
fn matrix(nodes: usize, parts: &[Admittance], windings: &[Windings]) -> Vec<Vec<f64>> {
    let size = nodes + windings.len() + 1;
    let mut a = vec![vec![0.0; size]; size];
    for part in parts {
        for (row, sign) in [(part.p, 1.0), (part.n, -1.0)] {
            a[row][part.p] += sign * part.g;
            a[row][part.n] -= sign * part.g;
        }
    }
    for (k, windings) in windings.iter().enumerate() {
        let column = nodes + 1 + k;
        // The first winding takes the current, the second gives `ratio` times it.
        let ends = [
            (windings.first.0, 1.0),
            (windings.first.1, -1.0),
            (windings.second.0, -windings.ratio),
            (windings.second.1, windings.ratio),
        ];
        for (node, share) in ends {
            a[node][column] += share;
            a[column][node] += share;
        }
    }
    a.remove(0);
    for row in &mut a {
        row.remove(0);
    }
    a
}

impl Factor {
    /// Elimination with the largest pivot of each column.
    fn new(mut rows: Vec<Vec<f64>>) -> Self {
        let n = rows.len();
        let mut order: Vec<usize> = (0..n).collect();
        for k in 0..n {
            let most = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap_or(k);
            rows.swap(k, most);
            order.swap(k, most);
            for row in k + 1..n {
                let (above, below) = rows.split_at_mut(row);
                let factor = below[0][k] / above[k][k];
                below[0][k] = factor;
                if factor != 0.0 {
                    let pivot = &above[k][k + 1..];
                    below[0][k + 1..].iter_mut().zip(pivot).for_each(|(to, by)| *to -= factor * by);
                }
            }
        }
        Factor { rows, order }
    }

    fn solve(&self, right: &[f64]) -> Vec<f64> {
        let n = self.rows.len();
        let mut x: Vec<f64> = self.order.iter().map(|row| right[*row]).collect();
        for k in 0..n {
            let done: f64 = self.rows[k][..k].iter().zip(&x).map(|(a, x)| a * x).sum();
            x[k] -= done;
        }
        for k in (0..n).rev() {
            let done: f64 = self.rows[k][k + 1..].iter().zip(&x[k + 1..]).map(|(a, x)| a * x).sum();
            x[k] = (x[k] - done) / self.rows[k][k];
        }
        x
    }
}
