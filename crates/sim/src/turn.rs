//! Guards that turn within a step: they cross zero twice and have the same sign at both ends.
//!
//! A guard that moves towards zero at the start of a step and away from it at the end has an extremum in between. A cubic
//! through both ends with their slopes says how near to zero it comes; where that is near, the extremum is looked for on
//! the dense output until a value on the other side of zero is found, which brackets the first crossing, or until it is
//! clear that there is none.
//!
//! Slopes are differences over 2^-10 of the step, one minor pass for the end of a step; that of the start is known from
//! the step before unless something has jumped. A guard that is far from zero as compared with its way over two
//! steps is left alone, so that most steps cost nothing.

use blocksim_solve::Failed;

use crate::evaluate::Diagram;
use crate::guards::{Guards, Stride};
use crate::slopes::Turn;

/// Over which part of a step a slope is taken.
const PART: f64 = 1.0 / 1024.0;
/// A guard that is farther from zero than this many times its way is not looked at.
const REACH: f64 = 4.0;
/// A step that grows by more than this has nothing to be compared with.
const GROWTH: f64 = 10.0;
/// Evaluations for one extremum, at most.
const TRIALS: u32 = 12;

impl Guards {
    /// A time at which some guard has another sign than at both ends of the step, where `self.start` and `self.end` hold. The
    /// values of all guards at that time are then in `self.end`.
    pub(crate) fn turn(&mut self, diagram: &mut Diagram, stride: &Stride) -> Result<Option<f64>, Failed> {
        let h = stride.t1 - stride.t0;
        if !(0..self.start.len()).any(|i| self.may_turn(i, h)) {
            return Ok(None);
        }
        if let Some(t) = self.find_slopes(diagram, stride)? {
            return Ok(Some(t));
        }
        self.turns.turning.clear();
        for i in 0..self.start.len() {
            let sign = self.start[i].signum();
            let (a, b) = (sign * self.start[i], sign * self.end[i]);
            let slopes = [sign * h * self.turns.start[i], sign * h * self.turns.end[i]];
            if self.turns.start_known
                && self.may_turn(i, h)
                && let Some(at) = least(a, b, slopes)
            {
                self.turns.turning.push(Turn { guard: i, at, end: self.end[i] });
            }
        }
        let mut found = None;
        for k in 0..self.turns.turning.len() {
            let turn = self.turns.turning[k];
            if found.is_none_or(|t| stride.t0 + turn.at * h < t) {
                found = self.seek(turn, diagram, stride)?.or(found);
            }
        }
        Ok(found)
    }

    /// Whether a guard has one sign at both ends and is near enough to zero to have reached it in between.
    fn may_turn(&self, i: usize, h: f64) -> bool {
        let (a, b, c) = (self.start[i], self.end[i], self.turns.before[i]);
        let near = a.abs().min(b.abs());
        let way = a.max(b).max(c) - a.min(b).min(c);
        a * b > 0.0 && (h > GROWTH * self.turns.length || REACH * way >= near)
    }

    /// Finds the slopes at the end of a step and, where a guard moves away from zero there, at the start. Returns the place of
    /// a crossing that is found on the way, with the values in `self.end`.
    fn find_slopes(&mut self, diagram: &mut Diagram, stride: &Stride) -> Result<Option<f64>, Failed> {
        let h = stride.t1 - stride.t0;
        let late = stride.t1 - PART * h;
        let early = stride.t0 + PART * h;
        if late <= early {
            return Ok(None);
        }
        self.at(late, diagram, stride)?;
        if self.crossing(&self.trial, true).is_some() {
            std::mem::swap(&mut self.trial, &mut self.end);
            return Ok(Some(late));
        }
        for i in 0..self.end.len() {
            self.turns.end[i] = (self.end[i] - self.trial[i]) / (stride.t1 - late);
        }
        self.turns.end_known = true;
        let leaves = |i: usize| self.may_turn(i, h) && self.turns.end[i] * self.end[i] > 0.0;
        if self.turns.start_known || !(0..self.end.len()).any(leaves) {
            return Ok(None);
        }
        self.at(early, diagram, stride)?;
        if self.crossing(&self.trial, true).is_some() {
            std::mem::swap(&mut self.trial, &mut self.end);
            return Ok(Some(early));
        }
        for i in 0..self.start.len() {
            self.turns.start[i] = (self.trial[i] - self.start[i]) / (early - stride.t0);
        }
        self.turns.start_known = true;
        Ok(None)
    }

    /// Looks for the other side of zero near an extremum, by parabolas through three points that enclose it.
    fn seek(&mut self, turn: Turn, diagram: &mut Diagram, stride: &Stride) -> Result<Option<f64>, Failed> {
        let (h, sign) = (stride.t1 - stride.t0, turn.end.signum());
        let (mut left, mut right) = ((0.0, sign * self.start[turn.guard]), (1.0, sign * turn.end));
        let mut middle: Option<(f64, f64)> = None;
        let mut at = turn.at;
        for _ in 0..TRIALS {
            let t = stride.t0 + at * h;
            self.at(t, diagram, stride)?;
            let value = sign * self.trial[turn.guard];
            if value <= 0.0 {
                std::mem::swap(&mut self.trial, &mut self.end);
                return Ok(Some(t));
            }
            // The least value so far stays in the middle.
            match &mut middle {
                None => middle = Some((at, value)),
                Some(least) if value < least.1 => {
                    let old = std::mem::replace(least, (at, value));
                    if at < old.0 { right = old } else { left = old }
                }
                Some(least) if at < least.0 => left = (at, value),
                Some(_) => right = (at, value),
            }
            let Some(least) = middle.filter(|least| least.1 < left.1 && least.1 < right.1) else { break };
            let (next, value) = vertex(left, least, right);
            let promising = REACH * (least.1 - value) > least.1;
            if !promising {
                break;
            }
            at = next;
        }
        Ok(None)
    }
}

/// Where the cubic from `a` to `b` over a step of length 1 with these slopes at its ends is least, if it falls first, rises
/// in the end and comes so near to zero that it may have been beyond: by more than half of the way from the nearer end.
fn least(a: f64, b: f64, slopes: [f64; 2]) -> Option<f64> {
    let [da, db] = slopes;
    if !(da < 0.0 && db > 0.0) {
        return None;
    }
    let c2 = 3.0 * (b - a) - 2.0 * da - db;
    let c3 = 2.0 * (a - b) + da + db;
    let at = -da / (c2 + (c2 * c2 - 3.0 * c3 * da).max(0.0).sqrt());
    let value = a + at * (da + at * (c2 + at * c3));
    (at > 0.0 && at < 1.0 && value < 0.5 * a.min(b)).then_some(at)
}

/// The vertex of the parabola through three points, of which the one in the middle is the lowest.
fn vertex(left: (f64, f64), middle: (f64, f64), right: (f64, f64)) -> (f64, f64) {
    let (l, r) = (left.0 - middle.0, right.0 - middle.0);
    let (dl, dr) = ((left.1 - middle.1) / l, (right.1 - middle.1) / r);
    let curvature = (dr - dl) / (r - l);
    let slope = dl - curvature * l;
    let at = -0.5 * slope / curvature;
    (middle.0 + at, middle.1 + 0.5 * slope * at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_value_of_a_parabola_is_found_at_once() {
        // 4 (s - 0.3)^2 + 0.01
        let p = |s: f64| 4.0 * (s - 0.3) * (s - 0.3) + 0.01;
        let at = least(p(0.0), p(1.0), [-2.4, 5.6]).unwrap();
        assert!((at - 0.3).abs() < 1e-15, "{at}");
        let (at, value) = vertex((0.0, p(0.0)), (0.4, p(0.4)), (1.0, p(1.0)));
        assert!((at - 0.3).abs() < 1e-14 && (value - 0.01).abs() < 1e-14, "{at} {value}");
    }

    #[test]
    fn what_stays_far_from_zero_or_does_not_turn_is_left_alone() {
        assert_eq!(least(1.0, 1.0, [-0.4, 0.4]), None);
        assert_eq!(least(1.0, 2.0, [1.0, 1.0]), None);
        assert_eq!(least(2.0, 1.0, [-1.0, -1.0]), None);
        assert_eq!(least(1.0, 1.0, [f64::NAN, 1.0]), None);
        assert!(least(1.0, 1.0, [-3.0, 3.0]).is_some());
    }
}
