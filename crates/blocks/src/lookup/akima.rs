//! Akima's interpolation: smooth, local, and without the overshoot of natural splines.

/// Slope of the chord over interval `i`, continued beyond both ends as Akima does: linearly.
fn chord(x: &[f64], y: &[f64], i: isize) -> f64 {
    let last = x.len() as isize - 2;
    let slope = |i: isize| {
        let i = i as usize;
        (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    };
    if last == 0 {
        return slope(0);
    }
    if i < 0 {
        let (first, second) = (slope(0), slope(1));
        first + i as f64 * (second - first)
    } else if i > last {
        let (before, end) = (slope(last - 1), slope(last));
        end + (i - last) as f64 * (end - before)
    } else {
        slope(i)
    }
}

/// Slope of the curve at point `i`: the mean of the chords beside it, each weighted by how much the chords on the
/// other side bend.
///
/// Source: H. Akima, A new method of interpolation and smooth curve fitting based on local procedures,
/// J. ACM 17 (1970) 589-602, doi 10.1145/321607.321609.
pub(super) fn slope(x: &[f64], y: &[f64], i: usize) -> f64 {
    let m = |offset: isize| chord(x, y, i as isize + offset);
    let (left, right) = ((m(1) - m(0)).abs(), (m(-1) - m(-2)).abs());
    if left + right == 0.0 {
        return (m(-1) + m(0)) / 2.0;
    }
    (left * m(-1) + right * m(0)) / (left + right)
}

/// The curve between points `i` and `i + 1`, at `u`.
pub(super) fn curve(x: &[f64], y: &[f64], i: usize, u: f64) -> f64 {
    let (h, dy) = (x[i + 1] - x[i], y[i + 1] - y[i]);
    let (t0, t1) = (h * slope(x, y, i), h * slope(x, y, i + 1));
    let s = (u - x[i]) / h;
    y[i] + s * (t0 + s * (3.0 * dy - 2.0 * t0 - t1 + s * (t0 + t1 - 2.0 * dy)))
}

/// Its second derivative between points `i` and `i + 1`, at either.
pub(super) fn curvature(x: &[f64], y: &[f64], i: usize) -> [f64; 2] {
    let h = x[i + 1] - x[i];
    let (chord, a, b) = ((y[i + 1] - y[i]) / h, slope(x, y, i), slope(x, y, i + 1));
    [(6.0 * chord - 4.0 * a - 2.0 * b) / h, (2.0 * a + 4.0 * b - 6.0 * chord) / h]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_and_parabolas_at_equal_distances_are_met_exactly() {
        let x: Vec<f64> = (-3..=4).map(f64::from).collect();
        for (a, b) in [(0.0, 2.0), (1.5, -1.0)] {
            let f = |x: f64| a * x * x + b * x + 1.0;
            let y: Vec<f64> = x.iter().map(|x| f(*x)).collect();
            for k in 0..70 {
                let u = -3.0 + 0.1 * f64::from(k);
                let i = ((u + 3.0) as usize).min(6);
                assert!((curve(&x, &y, i, u) - f(u)).abs() < 1e-12, "{a} {b} {u}");
            }
        }
    }

    #[test]
    fn a_flat_stretch_stays_flat_beside_a_jump() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let y = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        assert_eq!(curve(&x, &y, 1, 1.5), 0.0);
        assert_eq!(curve(&x, &y, 3, 3.5), 1.0);
        assert!((curve(&x, &y, 2, 2.5) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn two_points_give_a_line() {
        assert_eq!(curve(&[0.0, 2.0], &[1.0, 5.0], 0, 0.5), 2.0);
    }
}
