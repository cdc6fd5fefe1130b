//! Linear combinations of stages, the inner loop of every method.

/// out = x + h (a1 k1 + a2 k2 + ...), with the sum unrolled over the M stages.
pub(crate) fn combine<const M: usize>(out: &mut [f64], x: &[f64], h: f64, a: [f64; M], k: [&[f64]; M]) {
    let n = out.len();
    // Equal lengths, stated once, free the loop of bounds checks.
    let (x, k) = (&x[..n], k.map(|k| &k[..n]));
    for i in 0..n {
        let mut sum = 0.0;
        for j in 0..M {
            sum += a[j] * k[j][i];
        }
        out[i] = x[i] + h * sum;
    }
}

/// out = h (e1 k1 + e2 k2 + ...).
pub(crate) fn combine_error<const M: usize>(out: &mut [f64], h: f64, e: [f64; M], k: [&[f64]; M]) {
    let n = out.len();
    let k = k.map(|k| &k[..n]);
    for i in 0..n {
        let mut sum = 0.0;
        for j in 0..M {
            sum += e[j] * k[j][i];
        }
        out[i] = h * sum;
    }
}
