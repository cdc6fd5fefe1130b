//! Two signals on common times.

use crate::series::{Interpolation, Series};

/// Two signals at all times of either, over what both cover: times, values of the first, values of the second. Where one of
/// them jumps there are two rows, so that both may be taken to go straight from row to row, as they do on their own.
pub fn together(a: Series, b: Series) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    if a.time == b.time {
        return (a.time.to_vec(), a.values.to_vec(), b.values.to_vec());
    }
    let mut rows = (Vec::new(), Vec::new(), Vec::new());
    let (Some(of_a), Some(of_b)) = (a.span(), b.span()) else { return rows };
    let (from, to) = (of_a.0.max(of_b.0), of_a.1.min(of_b.1));
    let mut times: Vec<f64> =
        a.time.iter().chain(b.time).copied().filter(|t| (from..=to).contains(t)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut push = |t, x, y| {
        rows.0.push(t);
        rows.1.push(x);
        rows.2.push(y);
    };
    for t in times {
        let at = |series: &Series| series.at(t, Interpolation::Linear, 0.0);
        let (Some(x), Some(y)) = (at(&a), at(&b)) else { continue };
        push(t, x.0, y.0);
        if x.0 != x.1 || y.0 != y.1 {
            push(t, x.1, y.1);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_of_either_has_both_values() {
        let steps = Series::new(&[0.0, 1.0, 1.0, 2.0], &[0.0, 0.0, 4.0, 4.0]);
        let ramp = Series::new(&[0.0, 0.5, 2.5], &[0.0, 0.5, 2.5]);
        let (time, a, b) = together(steps, ramp);
        assert_eq!(time, [0.0, 0.5, 1.0, 1.0, 2.0]);
        assert_eq!(a, [0.0, 0.0, 0.0, 4.0, 4.0]);
        assert_eq!(b, [0.0, 0.5, 1.0, 1.0, 2.0]);
        let (time, b, a) = together(ramp, steps);
        assert_eq!((time.len(), a[3], b[3]), (5, 4.0, 1.0));
    }

    #[test]
    fn signals_that_never_meet_have_no_rows() {
        let (a, b) = (Series::new(&[0.0, 1.0], &[1.0, 1.0]), Series::new(&[2.0, 3.0], &[1.0, 1.0]));
        assert!(together(a, b).0.is_empty());
        assert!(together(a, Series::new(&[], &[])).0.is_empty());
    }
}
