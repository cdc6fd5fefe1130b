//! What of a channel can be reached from its input and seen at its output.

use nalgebra::{Complex, DMatrix, DVector};

use crate::poles::balanced;
use crate::{Channel, Response, modes, poles};

/// Parts of the largest entry below which a coupling of the staircase form may end it, from the boldest to the most careful.
/// What is small against the largest entry may well matter, so each is tried and measured.
const COUPLINGS: [f64; 4] = [1e-6, 1e-9, 1e-12, 1e-14];
/// By how much, relative to its size, the frequency response may change where states are left away.
const SAME: f64 = 1e-8;
/// At frequencies at which hardly anything comes through, against what does within a factor of three of them.
const NOTCH: f64 = 1e-6;
/// A response that is so many times what it is around is that at a pole without damping, as rounding has placed it.
const PEAK: f64 = 1e6;
/// Frequencies in a decade at which both are compared.
const DENSE: f64 = 8.0;

/// A channel without the states that have no part in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// What remains.
    pub channel: Channel,
    /// The largest change of the frequency response by states that were left away, relative to its size; 0 where the places
    /// of the zeros of the matrices say that they have no part.
    pub error: f64,
}

/// The channel without the states that its input cannot reach or its output cannot see. What remains has the same
/// transfer function.
pub fn minimal(channel: &Channel) -> Channel {
    reduced(channel).channel
}

/// As [`minimal`], with what leaving states away has changed.
///
/// First along the zeros of the matrices, which is exact, then by orthogonal transformations to the staircase form, whose
/// steps end where a part cannot be reached (P. Van Dooren, The generalized eigenstructure problem in linear system
/// theory, IEEE Trans. Automatic Control 26 (1981) 111). No size of a coupling tells whether it matters, as that depends on
/// the sizes of the states; so states are left away only if the frequency response stays, over all decades of the poles.
pub fn reduced(channel: &Channel) -> Reduced {
    let channel = balanced_channel(connected(channel));
    let n = channel.order();
    if n == 0 {
        return Reduced { channel, error: 0.0 };
    }
    let Some(frequencies) = compared(&channel) else { return Reduced { channel, error: 0.0 } };
    let before = Response::new(&channel);
    let before: Vec<Complex<f64>> = frequencies.iter().map(|&w| before.at(w)).collect();
    let mut last = n;
    for coupling in COUPLINGS {
        let seen = transposed(reachable(transposed(channel.clone()), coupling));
        let smaller = reachable(seen, coupling);
        if smaller.order() == last {
            continue;
        }
        last = smaller.order();
        if last == n {
            break;
        }
        let error = change(&frequencies, &before, &smaller);
        if error <= SAME {
            return Reduced { channel: smaller, error };
        }
    }
    Reduced { channel, error: 0.0 }
}

/// Frequencies, rad/s, over all decades in which the channel has poles; none if these cannot be computed.
fn compared(channel: &Channel) -> Option<Vec<f64>> {
    let poles = poles(&channel.a).ok()?;
    let modes = modes(&poles, channel.period);
    let sizes: Vec<f64> =
        modes.iter().map(|mode| mode.frequency).filter(|f| f.is_finite() && *f > 0.0).collect();
    let (low, high) =
        sizes.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &f| (low.min(f), high.max(f)));
    let top = channel.period.map(|period| std::f64::consts::PI / period);
    let (low, high) = if low.is_finite() { (low, high) } else { (1.0, 1.0) };
    let (from, to) = ((low / 100.0).log10(), top.unwrap_or(high * 100.0).log10());
    let count = ((to - from).max(1.0) * DENSE).ceil() as usize;
    let even = (0..=count).map(|k| 10_f64.powf(from + (to - from) * k as f64 / count as f64));
    let mut all: Vec<f64> = even.chain(sizes).filter(|f| top.is_none_or(|top| *f <= top)).collect();
    all.sort_by(f64::total_cmp);
    Some(all)
}

/// The maximum difference of the response of a channel to what it was, relative to its size.
fn change(frequencies: &[f64], before: &[Complex<f64>], channel: &Channel) -> f64 {
    let response = Response::new(channel);
    let mut worst: f64 = 0.0;
    for (at, &w) in frequencies.iter().enumerate() {
        let near = |other: &(&f64, &Complex<f64>)| *other.0 >= w / 3.0 && *other.0 <= 3.0 * w;
        let around = || frequencies.iter().zip(before).filter(near).map(|(_, g)| g.norm());
        let (old, new) = (before[at], response.at(w));
        let least = around().fold(f64::INFINITY, f64::min);
        if !old.norm().is_finite() || old.norm() > PEAK * least && is_peak(before, at) {
            continue;
        }
        let around = around().filter(|size| size.is_finite()).fold(0.0, f64::max);
        let difference = (new - old).norm();
        if difference > 0.0 {
            worst = worst.max(difference / old.norm().max(NOTCH * around));
        }
    }
    if worst.is_nan() { f64::INFINITY } else { worst }
}

/// Whether a response is as large as at the frequencies beside it, or larger: of a pair both are looked at.
fn is_peak(response: &[Complex<f64>], at: usize) -> bool {
    let size = |at: usize| response.get(at).map_or(0.0, |g| g.norm());
    size(at) >= size(at.wrapping_sub(1)).max(size(at + 1))
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
fn reachable(channel: Channel, coupling: f64) -> Channel {
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
    let small = coupling * a.norm();
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
    use crate::system::tests::{transfer, transformed};

    /// A place that is measured beside the spring that knows it, without damping: the peak is where rounding puts it.
    #[test]
    fn a_state_twice_beside_a_pole_without_damping_is_left_away() {
        for damping in [0.0, 1e-9, 1e-6, 1e-3] {
            let channel = Channel {
                a: DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, -1000.0, -damping, 0.0, 0.0, 1.0, 0.0]),
                b: DVector::from_vec(vec![0.0, 1.0, 0.0]),
                c: nalgebra::RowDVector::from_vec(vec![0.0, 0.0, 1.0]),
                d: 0.0,
                period: None,
            };
            assert_eq!(minimal(&channel).order(), 2, "{damping}");
        }
    }

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

    /// A chain of lags with time constants from 1e-10 to 1e3 s, in a loop around the slow ones: its static gain is 1/2.
    fn far_apart() -> Channel {
        let a = DMatrix::from_row_slice(3, 3, &[-1e10, 0.0, -1e10, 1e2, -1e2, 0.0, 0.0, 1e-3, -1e-3]);
        Channel {
            a,
            b: DVector::from_row_slice(&[1e10, 0.0, 0.0]),
            c: nalgebra::RowDVector::from_row_slice(&[0.0, 0.0, 1.0]),
            d: 0.0,
            period: None,
        }
    }

    #[test]
    fn slow_parts_behind_fast_ones_stay() {
        for full in [far_apart(), transformed(&far_apart(), 10.0)] {
            let Reduced { channel, error } = reduced(&full);
            assert!(channel.order() == 3 && error <= 1e-8, "{} {error}", channel.order());
            // Mixed states have lost digits themselves.
            let (before, after) = (Response::new(&full).at(0.0).re, Response::new(&channel).at(0.0).re);
            assert!((after / before - 1.0).abs() < 1e-7, "{before} {after}");
        }
        let Reduced { channel, error } = reduced(&far_apart());
        assert!((Response::new(&channel).at(0.0).re - 0.5).abs() < 1e-12 && error == 0.0);
    }

    #[test]
    fn leaving_states_away_tells_by_how_much_it_changes_the_response() {
        let full = transfer(&[1.0, 7.0, 10.0], &[1.0, 4.0, 14.0, 29.0, 18.0]);
        let Reduced { channel, error } = reduced(&full);
        assert!(channel.order() == 3 && error < 1e-10, "{error}");
        // A zero beside a pole by 1e-5 of it is no cancellation.
        let near = transfer(&[1.0, 2.00001], &[1.0, 3.0, 2.0]);
        assert_eq!(reduced(&near).channel.order(), 2);
    }
}
