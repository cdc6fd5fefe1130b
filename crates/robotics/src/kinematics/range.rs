//! Ranges of joints, and full turns within them.

use std::f64::consts::TAU;

/// How far a position may lie outside a range by rounding, rad or m; it is then put onto the limit.
const SLACK: f64 = 1e-9;

/// From where to where a joint may go, rad or m. Both ends may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRange {
    /// Lowest position.
    pub lower: f64,
    /// Highest position.
    pub upper: f64,
}

impl JointRange {
    /// A joint that turns without end.
    pub const FREE: JointRange = JointRange { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// Whether the ends are numbers in their order.
    pub(crate) fn is_sound(&self) -> bool {
        self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY
    }

    /// By how much a position is outside, 0 inside.
    pub fn excess(&self, q: f64) -> f64 {
        (self.lower - q).max(q - self.upper).max(0.0)
    }

    /// The position in the range that is nearest.
    pub fn clamp(&self, q: f64) -> f64 {
        q.max(self.lower).min(self.upper)
    }

    /// All positions in the range that are full turns away from `q`, in ascending order; only the nearest to `q`
    /// where the range is infinite.
    pub fn turns(&self, q: f64) -> impl Iterator<Item = f64> + use<> {
        let range = *self;
        let (first, last) = match (self.upper - self.lower).is_finite() {
            true => (
                ((self.lower - SLACK - q) / TAU).ceil() as i64,
                ((self.upper + SLACK - q) / TAU).floor() as i64,
            ),
            false => {
                let turn = self.nearest_turn(q, q);
                (turn, turn)
            }
        };
        (first..=last).map(move |k| q + k as f64 * TAU).filter_map(move |q| range.settle(q))
    }

    /// The position in the range that is full turns away from `q` and nearest to `near`, if there is one.
    pub fn nearest(&self, q: f64, near: f64) -> Option<f64> {
        self.settle(q + self.nearest_turn(q, near) as f64 * TAU)
    }

    fn nearest_turn(&self, q: f64, near: f64) -> i64 {
        let wanted = ((near - q) / TAU).round();
        let lowest = ((self.lower - SLACK - q) / TAU).ceil();
        let highest = ((self.upper + SLACK - q) / TAU).floor();
        wanted.max(lowest).min(highest) as i64
    }

    fn settle(&self, q: f64) -> Option<f64> {
        (self.excess(q) <= SLACK).then(|| self.clamp(q))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_turns_within_a_range_are_found() {
        let range = JointRange { lower: -400f64.to_radians(), upper: 400f64.to_radians() };
        let turns: Vec<_> = range.turns(0.1).collect();
        assert_eq!(turns.len(), 3);
        assert!((turns[0] - (0.1 - TAU)).abs() < 1e-15 && turns[1] == 0.1);
        assert_eq!(range.turns(3.0).count(), 2);
        assert_eq!(JointRange { lower: -1.0, upper: 1.0 }.turns(2.0).count(), 0);
        assert_eq!(JointRange::FREE.turns(2.0).collect::<Vec<_>>(), [2.0]);
    }

    #[test]
    fn the_nearest_turn_stays_in_the_range() {
        let range = JointRange { lower: -3.5, upper: 7.0 };
        assert_eq!(range.nearest(0.5, 100.0), Some(0.5 + TAU));
        assert_eq!(range.nearest(0.5, -100.0), Some(0.5));
        assert_eq!(range.nearest(-3.5 - 1e-12, -3.0), Some(-3.5));
        assert_eq!(JointRange { lower: 1.0, upper: 2.0 }.nearest(0.5, 1.5), None);
    }
}
