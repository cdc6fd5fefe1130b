//! Parts of a matrix that depend on each other, by the places of its zeros.

use nalgebra::DMatrix;

/// The numbers of rows that belong together: each group depends on itself in a circle, and the groups in one direction on
/// each other. The eigenvalues of the matrix are those of the groups together, so that an integrator which nothing feeds
/// back is a group of its own and its eigenvalue exactly the zero on the diagonal (S. Kosaraju's algorithm; A. Aho,
/// J. Hopcroft, J. Ullman, Data Structures and Algorithms, 1983, section 6.7).
pub(crate) fn parts(a: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let n = a.nrows();
    let leads = |from: usize, to: usize| a[(to, from)] != 0.0;
    let mut known = vec![false; n];
    let mut finished = Vec::with_capacity(n);
    for start in 0..n {
        // Depth first: the node, and the next one to look at.
        let mut way = vec![(start, 0)];
        if std::mem::replace(&mut known[start], true) {
            continue;
        }
        while let Some((node, next)) = way.last_mut() {
            let node = *node;
            match (*next..n).find(|&to| leads(node, to) && !known[to]) {
                Some(to) => {
                    *next = to + 1;
                    known[to] = true;
                    way.push((to, 0));
                }
                None => {
                    finished.push(node);
                    way.pop();
                }
            }
        }
    }
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut open = vec![true; n];
    for &start in finished.iter().rev() {
        if !open[start] {
            continue;
        }
        open[start] = false;
        let mut part = vec![start];
        let mut at = 0;
        while at < part.len() {
            let node = part[at];
            for (from, open) in
                open.iter_mut().enumerate().filter(|(from, open)| **open && leads(*from, node))
            {
                *open = false;
                part.push(from);
            }
            at += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_come_apart_and_circles_stay_together() {
        // 0 -> 1 -> 2 -> 1, 2 -> 3.
        let mut a = DMatrix::zeros(4, 4);
        for (from, to) in [(0, 1), (1, 2), (2, 1), (2, 3)] {
            a[(to, from)] = 1.0;
        }
        assert_eq!(parts(&a), [vec![0], vec![1, 2], vec![3]]);
        assert_eq!(parts(&DMatrix::zeros(3, 3)).len(), 3);
        assert_eq!(parts(&DMatrix::from_element(3, 3, 1.0)), [vec![0, 1, 2]]);
    }
}
