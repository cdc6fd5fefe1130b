//! What of a channel can be reached from its input and seen at its output.

use nalgebra::{DMatrix, DVector};

use crate::Channel;
use crate::poles::balanced;

/// Entries below this part of the largest are taken for rounding. Larger than that of the arithmetic, for matrices that
/// come of differences are no more accurate.
const SMALL: f64 = 1e-9;

/// The channel without the states that its input cannot reach or its output cannot see. What remains has the same
/// transfer function. Its matrix A is an upper Hessenberg matrix.
///
/// First along the zeros of the matrices, which is exact, then by orthogonal transformations to the staircase form, whose
/// steps end where a part cannot be reached (P. Van Dooren, The generalized eigenstructure problem in linear system
/// theory, IEEE Trans. Automatic Control 26 (1981) 111).
pub fn minimal(channel: &Channel) -> Channel {
    let channel = connected(channel);
    let channel = balanced_channel(channel);
    let seen = transposed(reachable(transposed(channel)));
    reachable(seen)
}

/// Keeps the states that lie on a way from the input to the output.
fn connected(channel: &Channel) -> Channel {
    let n = channel.order();
    let spread = |start: Vec<bool>, leads: &dyn Fn(usize, usize) -> bool| {
        let mut known = start;
        let mut open: Vec<usize> = (0..n).filter(|&i| known[i]).collect();
        while let Some(from) = open.pop() {
            for (to, known) in known.iter_mut().enumerate().filter(|(to, _)| leads(from, *to)) {
                if !std::mem::replace(known, true) {
                    open.push(to);
                }
            }
        }
        known
    };
    let reached =
        spread(channel.b.iter().map(|b| *b != 0.0).collect(), &|from, to| channel.a[(to, from)] != 0.0);
    let seen =
        spread(channel.c.iter().map(|c| *c != 0.0).collect(), &|from, to| channel.a[(from, to)] != 0.0);
    let kept: Vec<usize> = (0..n).filter(|&i| reached[i] && seen[i]).collect();
    Channel {
        a: channel.a.select_rows(&kept).select_columns(&kept),
        b: channel.b.select_rows(&kept),
        c: channel.c.select_columns(&kept),
        ..*channel
    }
}

/// In states of sizes that go together, b and c alike.
fn balanced_channel(channel: Channel) -> Channel {
    let (a, scale) = balanced(channel.a);
    let mut b = channel.b.component_div(&scale);
    let mut c = channel.c.component_mul(&scale.transpose());
    let (size_b, size_c) = (b.norm(), c.norm());
    if size_b > 0.0 && size_c > 0.0 {
        // A power of two changes no digit.
        let even = (size_c / size_b).sqrt().log2().round().exp2();
        b *= even;
        c /= even;
    }
    Channel { a, b, c, ..channel }
}

fn transposed(channel: Channel) -> Channel {
    Channel { a: channel.a.transpose(), b: channel.c.transpose(), c: channel.b.transpose(), ..channel }
}

/// Orthogonal transformations by which b becomes a multiple of the first unit vector and A an upper Hessenberg matrix, cut
/// off where the chain from the input ends.
fn reachable(channel: Channel) -> Channel {
    let Channel { mut a, mut b, mut c, .. } = channel;
    let n = a.nrows();
    if n == 0 || b.amax() == 0.0 {
        return Channel {
            a: DMatrix::zeros(0, 0),
            b: DVector::zeros(0),
            c: c.columns(0, 0).into_owned(),
            ..channel
        };
    }
    let small = SMALL * a.norm();
    let mut kept = n;
    for step in 0..n {
        // The column that is to have nothing below row `step`: b first, then those of A.
        let column = match step {
            0 => b.clone(),
            _ => a.column(step - 1).into_owned(),
        };
        let below = column.rows(step, n - step).into_owned();
        let size = below.norm();
        if step > 0 && size <= small {
            kept = step;
            break;
        }
        // Householder's reflection of `below` to its first axis.
        let mut v = below;
        v[0] += if v[0] < 0.0 { -size } else { size };
        let length = v.norm_squared();
        if length == 0.0 {
            continue;
        }
        let reflect_rows = |m: &mut DMatrix<f64>| {
            let mut lower = m.rows_mut(step, n - step);
            let image = v.transpose() * &lower;
            lower -= &v * image * (2.0 / length);
        };
        reflect_rows(&mut a);
        let mut right = a.columns_mut(step, n - step);
        let image = &right * &v;
        right -= image * v.transpose() * (2.0 / length);
        let image = (c.columns(step, n - step) * &v)[0];
        let mut end = c.columns_mut(step, n - step);
        end -= v.transpose() * (image * 2.0 / length);
        if step == 0 {
            let image = v.dot(&b);
            b -= &v * (image * 2.0 / length);
        }
    }
    let mut a = a.view((0, 0), (kept, kept)).into_owned();
    for column in 0..kept {
        for row in column + 2..kept {
            a[(row, column)] = 0.0;
        }
    }
    let mut b = b.rows(0, kept).into_owned();
    b.iter_mut().skip(1).for_each(|b| *b = 0.0);
    Channel { a, b, c: c.columns(0, kept).into_owned(), ..channel }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Response;
    use crate::system::tests::{transfer, transformed};

    #[test]
    fn poles_that_zeros_cancel_are_gone_and_the_response_stays() {
        // (s + 2) (s + 5) / ((s + 2) (s + 1) (s^2 + s + 9)) with (s + 2) in common.
        let full = transfer(&[1.0, 7.0, 10.0], &[1.0, 4.0, 14.0, 29.0, 18.0]);
        for scale in [1.0, 100.0] {
            let other = transformed(&full, scale);
            let reduced = minimal(&other);
            assert_eq!(reduced.order(), 3, "scale {scale}");
            for w in [0.0, 0.1, 1.0, 3.0, 10.0, 300.0] {
                let (before, after) = (Response::new(&full).at(w), Response::new(&reduced).at(w));
                assert!((before - after).norm() < 1e-9 * before.norm(), "{before} {after} at {w}");
            }
        }
    }

    #[test]
    fn what_nothing_reaches_or_nothing_sees_leaves_no_states() {
        let mut dead = transfer(&[1.0], &[1.0, 1.0, 1.0]);
        dead.b.fill(0.0);
        assert_eq!(minimal(&dead).order(), 0);
        let mut blind = transfer(&[1.0], &[1.0, 1.0, 1.0]);
        blind.c.fill(0.0);
        assert_eq!(minimal(&blind).order(), 0);
    }
}
