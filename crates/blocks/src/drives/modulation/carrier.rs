//! The triangular carrier: from duties to instants.

use super::Amount;

/// A triangle between 0 and 1. It begins at 1 at time 0, is 0 in the middle of each period and 1 at its end; a leg is high
/// while its duty is above the carrier. Halves of periods are counted from 0: even ones fall, odd ones rise.
///
/// ```text
/// 1 \      /\      /
///    \    /  \    /        half 0 | 1 | 2 | 3
/// 0   \  /    \  /
///      \/      \/
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carrier {
    /// Periods per second, Hz; positive.
    pub frequency: f64,
}

/// Numbers of halves above this are no longer exact.
const MOST_HALVES: f64 = 9e15;

/// How far the product of time and frequency, rounded down, may be from the half, with one to spare.
const ROUNDED: usize = 3;

/// Distance from the carrier below which a reference is on it: what rounding of times leaves.
const ON_CARRIER: f64 = 1e-9;

impl Carrier {
    /// When a half begins, s. Period `k` begins with half `2 k`.
    #[inline]
    pub fn start<N: Amount>(&self, half: N) -> N {
        half / half.fixed(2.0 * self.frequency)
    }

    /// The half in which `t`, s, lies; the start of a half belongs to it. 0 before time 0.
    pub fn half<N: Amount>(&self, t: N) -> N {
        let (none, most) = (t.fixed(0.0), t.fixed(MOST_HALVES));
        // The product may be off by a rounding, so it counts only as a start for the comparison with true starts.
        let first = (t * (2.0 * self.frequency)).whole() + -1.0;
        let first = first.greater(none, first, none);
        [(); ROUNDED].into_iter().fold(first, |half, ()| {
            let next = half + 1.0;
            let later = self.start(next).greater(t, half, next);
            most.greater(half, later, half)
        })
    }

    /// Value of the carrier at `t`, s, within `half`.
    #[inline]
    pub fn level<N: Amount>(&self, t: N, half: N) -> N {
        let risen = ((t - self.start(half)) * 2.0 * self.frequency).within(0.0, 1.0);
        falling(half, -risen + 1.0, risen)
    }

    /// When a leg of this duty switches in a half, s: it rises in an even half and falls in an odd one. A duty of 0 or 1
    /// gives an end of the half, where nothing switches.
    #[inline]
    pub fn edge<N: Amount>(&self, half: N, duty: N) -> N {
        self.start(half + falling(half, -duty + 1.0, duty))
    }

    /// When a leg of this duty rises and falls in period `period`, s. The difference is the duty times the period.
    pub fn instants(&self, period: f64, duty: f64) -> (f64, f64) {
        (self.edge(2.0 * period, duty), self.edge(2.0 * period + 1.0, duty))
    }

    /// 1 where a leg of this duty is high at `t`, s, within `half`, else 0. At an edge the value after it holds.
    #[inline]
    pub fn high<N: Amount>(&self, t: N, half: N, duty: N) -> N {
        let (edge, zero, one) = (self.edge(half, duty), t.fixed(0.0), t.fixed(1.0));
        falling(half, edge.greater(t, zero, one), edge.greater(t, one, zero))
    }

    /// The first time after `t`, s, at which a leg of these (constant) duties switches; infinite if none ever does.
    pub fn next_edge(&self, t: f64, duties: &[f64]) -> f64 {
        let half = self.half(t);
        let halves = [half, half + 1.0, half + 2.0];
        let switching = duties.iter().filter(|duty| **duty > 0.0 && **duty < 1.0);
        let edges = switching.flat_map(|duty| halves.map(|half| self.edge(half, *duty)));
        edges.filter(|edge| *edge > t).fold(f64::INFINITY, f64::min)
    }

    /// When a duty that changes between two instants of a half crosses the carrier (natural sampling), s. `reference` gives the
    /// duty at a time, s, and need not be limited. None if it stays on one side; one of the crossings if it changes faster
    /// than the carrier and there are several.
    ///
    /// Found by bisection to the last place: neighbouring numbers enclose the crossing, the later one is returned.
    pub fn crossing(&self, half: f64, [from, to]: [f64; 2], reference: impl Fn(f64) -> f64) -> Option<f64> {
        let above = |t: f64| reference(t) - self.level(t, half) > 0.0;
        let (mut left, mut right) = (from, to);
        let before = above(left);
        if before == above(right) {
            return None;
        }
        loop {
            let middle = 0.5 * (left + right);
            if middle <= left || middle >= right {
                return Some(right);
            }
            if above(middle) == before {
                left = middle;
            } else {
                right = middle;
            }
        }
    }

    /// The duty that, held between two instants of a half, switches where a duty that changes between them crosses the
    /// carrier: what natural sampling comes to once the course of the reference is known beforehand. `reference` as in
    /// [`crossing`](Self::crossing).
    pub fn natural_duty(&self, half: f64, [from, to]: [f64; 2], reference: impl Fn(f64) -> f64) -> f64 {
        let Some(t) = self.crossing(half, [from, to], &reference) else {
            // What is not a number stays so.
            let at = 0.5 * (from + to);
            let middle = reference(at) - self.level(at, half);
            return if middle.is_nan() { f64::NAN } else { f64::from(middle > 0.0) };
        };
        let (wanted, level) = (reference(t), self.level(t, half));
        // A duty that rests at the peak of the carrier does not switch there; one that jumps across it does.
        if (wanted - level).abs() < ON_CARRIER { wanted } else { level }
    }

    /// When a half begins and ends, s.
    pub fn span(&self, half: f64) -> [f64; 2] {
        [half, half + 1.0].map(|half| self.start(half))
    }
}

/// Whether the carrier falls in a half.
#[inline]
pub(super) fn is_falling(half: f64) -> bool {
    half % 2.0 == 0.0
}

/// The first where the carrier falls in a half, else the second.
#[inline]
pub(super) fn falling<N: Amount>(half: N, falls: N, rises: N) -> N {
    ((half * 0.5).whole() * 2.0).equal(half, falls, rises)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const CARRIER: Carrier = Carrier { frequency: 8e3 };

    /// Which legs of these constant duties are high at `t`, s.
    fn poles_at<const LEGS: usize>(t: f64, duties: [f64; LEGS]) -> [bool; LEGS] {
        let half = CARRIER.half(t);
        duties.map(|duty| CARRIER.high(t, half, duty) == 1.0)
    }

    #[test]
    fn edges_stay_at_their_instants_over_ten_thousand_periods() {
        for frequency in [1e3, 7e3, 16e3] {
            let carrier = Carrier { frequency };
            for k in 0..10_000 {
                let (on, off) = carrier.instants(f64::from(k), 0.3);
                let middle = (f64::from(k) + 0.5) / frequency;
                assert!((on - (middle - 0.15 / frequency)).abs() < 1e-12 / 2.0, "period {k}");
                assert!((off - (middle + 0.15 / frequency)).abs() < 1e-12 / 2.0, "period {k}");
                assert!(((off - on) * frequency - 0.3).abs() < 1e-11 * (1.0 + f64::from(k) * 1e-3));
            }
        }
    }

    #[test]
    fn volt_seconds_of_a_period_balance() {
        // As near the start as a difference of times allows twelve digits.
        for k in 0..100 {
            for duty in [0.0, 1e-3, 0.25, 0.5, 0.9, 1.0] {
                let (on, off) = CARRIER.instants(f64::from(k), duty);
                assert!(((off - on) * CARRIER.frequency - duty).abs() < 1e-12, "period {k}, duty {duty}");
            }
        }
    }

    #[test]
    fn the_half_of_each_start_is_its_own_and_a_moment_before_it_is_not() {
        for frequency in [50.0, 3e3, 8e3, 1e4 / 3.0] {
            let carrier = Carrier { frequency };
            for half in (0..100_000).step_by(7).map(f64::from) {
                let start = carrier.start(half);
                assert_eq!(carrier.half(start), half);
                assert_eq!(carrier.half(start.next_down()), (half - 1.0).max(0.0));
            }
        }
    }

    #[test]
    fn the_level_is_a_triangle() {
        for (quarters, level) in [(0.0, 1.0), (1.0, 0.5), (2.0, 0.0), (3.0, 0.5), (5.0, 0.5), (6.0, 0.0)] {
            let t = quarters / 4.0 / CARRIER.frequency;
            assert!((CARRIER.level(t, CARRIER.half(t)) - level).abs() < 1e-12, "{quarters} quarters");
        }
    }

    #[test]
    fn walking_from_edge_to_edge_meets_each_once_and_the_poles_agree() {
        let duties = [0.3, 0.5, 0.8];
        let (mut t, mut count) = (0.0, 0);
        while t < 100.0 / CARRIER.frequency {
            let before = poles_at(t, duties);
            t = CARRIER.next_edge(t, &duties);
            let (just, after) = (poles_at(t.next_down(), duties), poles_at(t, duties));
            assert_eq!(before, just, "edge {count}");
            assert_eq!(just.iter().zip(&after).filter(|(a, b)| a != b).count(), 1, "edge {count}");
            count += 1;
        }
        assert_eq!(count, 601);
    }

    #[test]
    fn full_and_empty_duties_never_switch() {
        assert_eq!(CARRIER.next_edge(0.0, &[0.0, 1.0, f64::NAN]), f64::INFINITY);
        for t in (0..1000).map(|k| CARRIER.start(f64::from(k) / 4.0)) {
            assert_eq!(poles_at(t, [0.0, 1.0]), [false, true], "{t}");
        }
    }

    #[test]
    fn a_crossing_lies_where_the_reference_meets_the_carrier() {
        let reference = |t: f64| 0.5 + 0.45 * (TAU * 400.0 * t + 0.3).sin();
        for half in (0..400).map(f64::from) {
            let t = CARRIER.crossing(half, CARRIER.span(half), reference).expect("a crossing in each half");
            assert!((reference(t) - CARRIER.level(t, half)).abs() < 1e-10, "half {half}");
            // Newton's iteration on the straight line of the carrier, as a second way to the same point.
            let mut other = CARRIER.edge(half, 0.5);
            for _ in 0..50 {
                other = CARRIER.edge(half, reference(other));
            }
            assert!((t - other).abs() < 1e-15, "half {half}: {t} != {other}");
        }
        assert_eq!(CARRIER.crossing(3.0, CARRIER.span(3.0), |_| 1.5), None);
        assert_eq!(CARRIER.crossing(4.0, CARRIER.span(4.0), |_| -0.5), None);
    }

    #[test]
    fn a_natural_duty_switches_at_the_crossing_and_full_ones_do_not_switch() {
        let reference = |t: f64| 0.5 + 0.45 * (TAU * 400.0 * t + 0.3).sin();
        for half in (0..400).map(f64::from) {
            let t = CARRIER.crossing(half, CARRIER.span(half), reference).expect("a crossing in each half");
            let edge = CARRIER.edge(half, CARRIER.natural_duty(half, CARRIER.span(half), reference));
            assert!((edge - t).abs() < 1e-14, "half {half}: {edge} != {t}");
        }
        for half in [4.0, 5.0] {
            let constant = |duty: f64| CARRIER.natural_duty(half, CARRIER.span(half), move |_| duty);
            assert_eq!([0.0, 0.25, 1.0, -0.5, 1.5].map(constant), [0.0, 0.25, 1.0, 0.0, 1.0], "half {half}");
            assert!(constant(f64::NAN).is_nan());
        }
        // Across the carrier in one jump, a quarter of the half after its start.
        let at = CARRIER.start(6.25);
        let jumps = CARRIER.natural_duty(6.0, CARRIER.span(6.0), |t| f64::from(t >= at));
        assert!((CARRIER.edge(6.0, jumps) - at).abs() < 1e-14);
    }

    /// A pole that switches at the crossings has no harmonics of the reference, and its fundamental is the reference itself:
    /// the sidebands of the carrier that fall on low orders are Bessel functions of order 20, below 1e-20.
    #[test]
    fn the_fundamental_of_natural_sampling_is_the_reference() {
        let (ratio, depth) = (21.0, 0.8);
        let carrier = Carrier { frequency: ratio };
        let reference = |t: f64| 0.5 * (1.0 + depth * (TAU * t).cos());
        let mut coefficients = [0.0; 4];
        for period in (0..21).map(f64::from) {
            let on = carrier.crossing(2.0 * period, carrier.span(2.0 * period), reference).expect("a rise");
            let off = carrier
                .crossing(2.0 * period + 1.0, carrier.span(2.0 * period + 1.0), reference)
                .expect("a fall");
            for (n, sum) in coefficients.iter_mut().enumerate().skip(1) {
                let w = TAU * n as f64;
                // Poles are 1 while high and -1 while low; the mean of the constant over a turn is zero.
                *sum += 2.0 * 2.0 * ((w * off).sin() - (w * on).sin()) / w;
            }
        }
        assert!((coefficients[1] - depth).abs() < 1e-12, "{coefficients:?}");
        assert!(coefficients[2].abs() < 1e-12 && coefficients[3].abs() < 1e-12, "{coefficients:?}");
    }
}
