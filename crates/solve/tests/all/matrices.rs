//! Several right-hand sides at once.

use blocksim_solve::linear::{cholesky_factor, cholesky_solve, cholesky_solve_matrix};

/// Numbers in -1..1 that look random.
fn scattered(count: usize) -> Vec<f64> {
    (1..=count).map(|i| 2.0 * (i as f64 * 0.618_033_988_749_894_9).fract() - 1.0).collect()
}

#[test]
fn as_many_columns_as_rows_have_the_bits_that_they_have_among_others() {
    for n in [1, 2, 3, 6, 8, 9, 12] {
        let m = scattered(n * n);
        let mut l: Vec<f64> = (0..n * n)
            .map(|at| {
                let (i, j) = (at / n, at % n);
                let dot: f64 = (0..n).map(|k| m[i * n + k] * m[j * n + k]).sum();
                dot + f64::from(u8::from(i == j))
            })
            .collect();
        cholesky_factor(&mut l, n).unwrap();
        let square = scattered(n * n);
        let column =
            |b: &[f64], width: usize, j: usize| (0..n).map(|i| b[i * width + j]).collect::<Vec<f64>>();
        let mut together = square.clone();
        cholesky_solve_matrix(&l, n, &mut together);
        let mut wider: Vec<f64> = square.chunks(n).flat_map(|row| row.iter().copied().chain([0.5])).collect();
        cholesky_solve_matrix(&l, n, &mut wider);
        for j in 0..n {
            let found = column(&together, n, j);
            assert_eq!(found, column(&wider, n + 1, j), "column {j} of {n}");
            let mut alone = column(&square, n, j);
            cholesky_solve(&l, &mut alone);
            found.iter().zip(&alone).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{a} != {b}"));
        }
    }
}
