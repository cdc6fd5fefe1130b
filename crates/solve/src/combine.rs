//! Linear combinations of stages, the inner loop of every method. Inlined, because most systems have few states and a call
//! would cost as much as the sum.

/// out = x + h (a1 k1 + a2 k2 + ...), with the sum unrolled over the M stages.
#[inline(always)]
pub(crate) fn combine<const M: usize>(out: &mut [f64], x: &[f64], h: f64, a: [f64; M], k: [&[f64]; M]) {
    for (i, (out, x)) in out.iter_mut().zip(x).enumerate() {
        let mut sum = 0.0;
        for j in 0..M {
            sum += a[j] * k[j][i];
        }
        *out = x + h * sum;
    }
}

/// out = h (e1 k1 + e2 k2 + ...).
#[inline(always)]
pub(crate) fn combine_error<const M: usize>(out: &mut [f64], h: f64, e: [f64; M], k: [&[f64]; M]) {
    for (i, out) in out.iter_mut().enumerate() {
        let mut sum = 0.0;
        for j in 0..M {
            sum += e[j] * k[j][i];
        }
        *out = h * sum;
    }
}
