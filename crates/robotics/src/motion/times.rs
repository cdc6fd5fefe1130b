//! The times of a synchronised move, before any profile is built.

use crate::motion::limits::AxisLimits;
use crate::motion::request::Synchronisation;

/// Times that all axes share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Times {
    pub t_acc: f64,
    pub t_dec: f64,
    /// Factor by which the times were lengthened to keep the acceleration limits; 1 where none was near.
    pub stretch: f64,
    /// Index of the axis that determines the times.
    pub leading: usize,
}

/// Times for the given distances (rad, not negative, at least one positive).
///
/// `v_share` is the share of each maximum speed, `a_share` the share of the move time spent accelerating.
pub(crate) fn synchronise(
    distances: &[f64],
    limits: &[AxisLimits],
    v_share: f64,
    a_share: f64,
    rule: Synchronisation,
) -> Times {
    match rule {
        Synchronisation::Feasible => feasible(distances, limits, v_share, a_share),
        Synchronisation::AsPrinted => as_printed(distances, limits, v_share, a_share),
    }
}

fn feasible(distances: &[f64], limits: &[AxisLimits], v_share: f64, a_share: f64) -> Times {
    // With t_end = d / (v (1 - s)) and t_acc = s t_end, the longest t_acc and the longest d / v belong to
    // the same axis, since s is the same for all.
    let cruise = |i: usize| distances[i] / (v_share * limits[i].speed);
    let (leading, t_dec) = largest((0..distances.len()).map(cruise));
    let t_acc = a_share / (1.0 - a_share) * t_dec;

    // a_m = 2 d / (T_dec T_acc) falls with the square of a common stretch of both times.
    let excess = |i: usize| 2.0 * distances[i] / (t_dec * t_acc) / limits[i].acceleration;
    let (tightest, worst) = largest((0..distances.len()).map(excess));
    if worst > 1.0 {
        let stretch = worst.sqrt();
        Times { t_acc: t_acc * stretch, t_dec: t_dec * stretch, stretch, leading: tightest }
    } else {
        Times { t_acc, t_dec, stretch: 1.0, leading }
    }
}

fn as_printed(distances: &[f64], limits: &[AxisLimits], v_share: f64, a_share: f64) -> Times {
    let alone: Vec<(f64, f64)> =
        distances.iter().zip(limits).map(|(&d, l)| times_alone(d, l, v_share, a_share)).collect();
    let (leading, _) = largest(alone.iter().map(|(t_acc, t_dec)| t_acc + t_dec));
    let (t_acc, t_dec) = alone[leading];
    Times { t_acc, t_dec, stretch: 1.0, leading }
}

/// `(t_acc, t_dec)` of an axis that moves alone.
fn times_alone(distance: f64, limits: &AxisLimits, v_share: f64, a_share: f64) -> (f64, f64) {
    let v = v_share * limits.speed;
    let t_dec = distance / v;
    let t_acc = a_share / (1.0 - a_share) * t_dec;
    let a = limits.acceleration;
    if distance == 0.0 || 2.0 * v / t_acc <= a {
        return (t_acc, t_dec);
    }
    let v = v.min((a * distance / 2.0).sqrt());
    let t_dec = distance / v;
    // Equal by law where the speed was reduced; rounding must not make the ramp the longer of the two.
    ((2.0 * v / a).min(t_dec), t_dec)
}

/// Index and value of the largest; the first of equals.
fn largest(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold((0, f64::NEG_INFINITY), |best, (i, x)| if x > best.1 { (i, x) } else { best })
}
