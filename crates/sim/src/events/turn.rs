//! Guards that turn within a step: they cross zero and come back, with the same sign at both ends.
//!
//! What the guards are at the stages of the method shows most of it for nothing (`see`). A guard that moves towards zero at
//! the start of a step and away from it at the end has an extremum in between. A cubic through both ends with their slopes
//! says how near to zero it comes; where that is near, the extremum is looked for on the dense output until a value on the
//! other side of zero is found, which brackets the first crossing, or until it is clear that there is none. Where
//! the cubic and the stages contradict each other by a part of the distance to zero, the step is sampled (`scan.rs`).
//!
//! Slopes are differences over 2^-10 of the step, one minor pass for the end of a step; that of the start is known from
//! the step before unless something has jumped. A guard that is far from zero as compared with its way over two
//! steps is left alone, so that most steps cost nothing.

use blocksim_block::Crossing;
use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;
use crate::events::guards::{Guards, Stride, first_loud};
use crate::events::looks::Looks;
use crate::events::slopes::Turn;

/// Over which part of a step a slope is taken.
const PART: f64 = 1.0 / 1024.0;
/// The same at the start of a step behind a guard with a direction that has just fired: it is on the far side, comes back
/// unwatched, and a hop may be a millionth of the step.
const EARLY: f64 = 1.0 / (1_u64 << 22) as f64;
/// A guard that is farther from zero than this many times its way is not looked at.
const REACH: f64 = 4.0;
/// A step that grows by more than this has nothing to be compared with.
const GROWTH: f64 = 10.0;
/// Fewest looks within a step that stand in for a comparison with the step before.
const FEW: usize = 3;
/// Evaluations for one extremum, at most.
const TRIALS: u32 = 12;
/// Part of the distance to zero by which the looks may differ from the cubic.
const DOUBT: f64 = 0.25;
/// A look that is nearer to zero than its neighbours is a dip that may go on to zero, if no more than this many times its
/// depth is left.
const NEAR: f64 = 2.0;
/// A guard that crosses zero goes there straight if its way from look to look is no longer than this many times the
/// distance of its ends.
const DETOUR: f64 = 1.5;

/// Looks of a method that has stages within the step, at least. One alone may be that of a guess of the first step.
const SEEN: usize = 2;
/// Where to look in a step of a method that has none, in parts of the step: at no equal distances, which a swing could
/// keep time with.
const BETWEEN: [f64; 3] = [0.24, 0.47, 0.78];

impl Guards {
    /// A time at which the stages of the method have shown a guard on the other side of zero, and the dense output agrees.
    pub(crate) fn see(
        &mut self,
        looks: &mut Looks,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Option<f64>, Failed> {
        let Stride { t0, t1, .. } = *stride;
        let mut count = looks.find_within(t0, t1);
        if count < SEEN {
            for part in BETWEEN {
                let t = t0 + part * (t1 - t0);
                if t > t0 && t < t1 {
                    self.at(t, diagram, stride)?;
                    looks.row(t).copy_from_slice(&self.trial);
                }
            }
            count = looks.find_within(t0, t1);
        }
        self.turns.looks = count;
        self.extend_over(looks, count);
        for k in 0..count {
            let (t, values) = looks.within(k);
            if self.crossing(values, true).is_some() {
                self.at(t, diagram, stride)?;
                if self.crossing(&self.trial, true).is_some() {
                    return Ok(Some(t));
                }
            }
        }
        Ok(None)
    }

    /// Finds the least and the greatest value of each guard at the ends and at the looks, and its way. Look by look, so that several
    /// guards go abreast.
    fn extend_over(&mut self, looks: &Looks, count: usize) {
        let n = self.start.len();
        let (start, end) = (&self.start[..n], &self.end[..n]);
        let (low, high) = (&mut self.low[..n], &mut self.high[..n]);
        let (path, last) = (&mut self.path[..n], &mut self.last[..n]);
        for i in 0..n {
            (low[i], high[i]) = (start[i].min(end[i]), start[i].max(end[i]));
        }
        path.fill(0.0);
        last.copy_from_slice(start);
        for k in 0..=count {
            let values = if k < count { &looks.within(k).1[..n] } else { end };
            for i in 0..n {
                // As `min` and `max`, but for what is not a number, which has not moved.
                low[i] = if values[i] < low[i] { values[i] } else { low[i] };
                high[i] = if values[i] > high[i] { values[i] } else { high[i] };
                path[i] += (values[i] - last[i]).abs();
                last[i] = values[i];
            }
        }
    }

    /// A time at which some guard has another sign than at both ends of the step, where `self.start` and `self.end` hold.
    pub(crate) fn turn(
        &mut self,
        looks: &Looks,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Option<f64>, Failed> {
        let h = stride.t1 - stride.t0;
        if !self.find_near(h) {
            return if self.is_doubtful(looks, stride) { self.scan(diagram, stride) } else { Ok(None) };
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
                && self.near[i]
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
        if self.is_doubtful(looks, stride) {
            let scanned = self.scan(diagram, stride)?;
            found = [found, scanned].into_iter().flatten().reduce(f64::min);
        }
        Ok(found)
    }

    /// Finds the guards that have one sign at both ends and are near enough to zero to have reached it in between; returns whether
    /// there are any.
    fn find_near(&mut self, h: f64) -> bool {
        let grown = self.turns.looks < FEW && h > GROWTH * self.turns.length;
        let n = self.start.len();
        let (start, end, before) = (&self.start[..n], &self.end[..n], &self.turns.before[..n]);
        let (low, high, near) = (&self.low[..n], &self.high[..n], &mut self.near[..n]);
        let mut any = false;
        for i in 0..n {
            let way = high[i].max(before[i]) - low[i].min(before[i]);
            near[i] = (start[i] * end[i] > 0.0) & (grown | (REACH * way >= nearest(low[i], high[i])));
            any |= near[i];
        }
        if any {
            let peaks =
                self.events.iter().zip(near.iter_mut()).filter(|(events, _)| **events == Crossing::Peak);
            peaks.for_each(|(_, near)| *near = false);
            any = near.contains(&true);
        }
        any
    }

    /// How near to zero a guard is known to have come.
    fn nearest(&self, i: usize) -> f64 {
        nearest(self.low[i], self.high[i])
    }

    /// Finds the guards of which neither slopes nor looks say for sure that they have not crossed zero.
    fn is_doubtful(&mut self, looks: &Looks, stride: &Stride) -> bool {
        for i in 0..self.start.len() {
            let (a, b) = (self.start[i], self.end[i]);
            self.doubtful[i] = if self.events[i] == Crossing::Peak {
                false
            } else if a * b > 0.0 {
                // What depends on time alone may do anything between two looks.
                self.near[i] && (stride.stepper.is_none() || self.dips(i, looks, stride))
            } else {
                self.path[i] > DETOUR * (b - a).abs()
            };
        }
        self.doubtful.contains(&true)
    }

    /// Whether a guard comes nearer to zero at a look than around it, by as much as is left, or is not where the cubic
    /// through its ends has it.
    fn dips(&self, i: usize, looks: &Looks, stride: &Stride) -> bool {
        let (a, b, count) = (self.start[i], self.end[i], looks.len());
        let value = |k: usize| match k {
            0 => a,
            k if k > count => b,
            k => looks.within(k - 1).1[i],
        };
        let low = |k: usize| {
            let (left, here, right) = (value(k - 1).abs(), value(k).abs(), value(k + 1).abs());
            let depth = (left - here).max(right - here);
            here <= left && here <= right && here < NEAR * depth
        };
        let h = stride.t1 - stride.t0;
        let (da, db) = (h * self.turns.start[i], h * self.turns.end[i]);
        let (c2, c3) = (3.0 * (b - a) - 2.0 * da - db, 2.0 * (a - b) + da + db);
        let near = self.nearest(i);
        let off = |k: usize| {
            let s = (looks.within(k).0 - stride.t0) / h;
            (value(k + 1) - (a + s * (da + s * (c2 + s * c3)))).abs() > DOUBT * near
        };
        (1..=count).any(low) || self.turns.start_known && (0..count).any(off)
    }

    /// Finds the slopes at the end of a step and, where a guard moves away from zero there, at the start. Returns the place of
    /// a crossing that is found on the way.
    fn find_slopes(&mut self, diagram: &mut Diagram, stride: &Stride) -> Result<Option<f64>, Failed> {
        let h = stride.t1 - stride.t0;
        let late = stride.t1 - PART * h;
        let hops = |i: usize| self.fired[i] && matches!(self.events[i], Crossing::Rising | Crossing::Falling);
        let part = if (0..self.fired.len()).any(hops) { EARLY } else { PART };
        let early = stride.t0 + part * h;
        if late <= early || early <= stride.t0 {
            return Ok(None);
        }
        self.at(late, diagram, stride)?;
        if self.has_turned() {
            return Ok(Some(late));
        }
        for i in 0..self.end.len() {
            self.turns.end[i] = (self.end[i] - self.trial[i]) / (stride.t1 - late);
        }
        self.turns.end_known = true;
        let leaves = |i: usize| self.near[i] && self.turns.end[i] * self.end[i] > 0.0;
        if self.turns.start_known || !(0..self.end.len()).any(leaves) {
            return Ok(None);
        }
        self.at(early, diagram, stride)?;
        if self.has_turned() {
            return Ok(Some(early));
        }
        for i in 0..self.start.len() {
            self.turns.start[i] = (self.trial[i] - self.start[i]) / (early - stride.t0);
        }
        self.turns.start_known = true;
        Ok(None)
    }

    /// Whether a guard has another sign at the trial point than at both ends. Those that have crossed by the end are found
    /// anyway, and must not end the search for the others.
    fn has_turned(&self) -> bool {
        let turned = first_loud(&self.start, &self.trial, |i| {
            let (start, events) = (self.start[i], self.events[i]);
            let counts =
                if matches!(events, Crossing::Holds | Crossing::Peak) { events } else { Crossing::Either };
            counts.happens(start, self.trial[i]) && !counts.happens(start, self.end[i])
        });
        turned.is_some()
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
            // A mode that holds at zero may touch it.
            if value < 0.0 || value == 0.0 && self.events[turn.guard] != Crossing::Holds {
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

/// How near to zero values from `low` to `high` come.
#[inline(always)]
fn nearest(low: f64, high: f64) -> f64 {
    low.max(-high).max(0.0)
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
    use blocksim_block::Resolution;

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
    fn guards_abreast_are_as_near_to_zero_as_one_by_one() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            match seed >> 60 {
                0 => 0.0,
                1 => f64::INFINITY,
                _ => (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0 + f64::from((seed >> 50) as u8 % 3),
            }
        };
        let kinds = [Crossing::Either, Crossing::Rising, Crossing::Holds, Crossing::Peak];
        for count in 0..4 {
            let n = 37;
            let mut guards =
                Guards::new((0..n).map(|i| kinds[i % kinds.len()]).collect(), 0, Resolution::new(1.0));
            let mut looks = Looks::new(n);
            let way: Vec<Vec<f64>> = (0..count + 2).map(|_| (0..n).map(|_| random()).collect()).collect();
            for (k, values) in way[1..=count].iter().enumerate() {
                looks.row(k as f64 + 1.0).copy_from_slice(values);
            }
            guards.start.clone_from(&way[0]);
            guards.end.clone_from(&way[count + 1]);
            guards.turns.before.iter_mut().for_each(|value| *value = random());
            (guards.turns.length, guards.turns.looks) = (1.0, looks.find_within(0.0, 9.0));
            guards.extend_over(&looks, count);
            for h in [1.0, 20.0] {
                let mut any = false;
                guards.find_near(h);
                for i in 0..n {
                    let values: Vec<f64> = way.iter().map(|values| values[i]).collect();
                    let (low, high) =
                        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                            (low.min(*v), high.max(*v))
                        });
                    assert_eq!((guards.low[i], guards.high[i]), (low, high));
                    let before = guards.turns.before[i];
                    let reach = 4.0 * (high.max(before) - low.min(before));
                    let distance = if low > 0.0 {
                        low
                    } else if high < 0.0 {
                        -high
                    } else {
                        0.0
                    };
                    let near = kinds[i % kinds.len()] != Crossing::Peak
                        && values[0] * values[count + 1] > 0.0
                        && (count < 3 && h > 10.0 || reach >= distance);
                    assert_eq!(guards.near[i], near, "{values:?}");
                    any |= near;
                }
                assert_eq!(guards.find_near(h), any);
            }
        }
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
