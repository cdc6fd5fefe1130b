//! Zero crossings of guards: were there any in a step, and when was the first?
//!
//! A guard has crossed when its sign at the end of a step is not that of the start, zero being a sign of its own at the
//! end. The first crossing is bracketed on the dense output of the step, each trial point with a minor pass; the step
//! is then cut at the right end of the bracket, where the guard has its new sign. The bracket is at most
//! 1e-15 max(|t|, h) wide, h being the step: some units in the last place of t.
//!
//! A guard that is exactly zero at the start of a step is not crossing. But where it goes from there the block could not
//! know when it chose its branch, so the step is cut just behind its start, at 2^-40 h (or at 2^-20 h if it is still zero
//! there), or else where it leaves zero, and the branch chosen anew. In the same manner it is found out whether a guard that
//! has just crossed turns back at once.
//!
//! Methods of fixed step do not look for crossings: blocks choose their branches at each step.
//!
//! A guard that crosses zero twice within one step is found by what it is at the stages of the method (`looks.rs`), by its
//! slopes (`turn.rs`), and where these leave a doubt by samples of the dense output (`scan.rs`). Impacts that come faster
//! and faster are not told apart once time cannot do so; the block needs a state of rest.
//!
//! A guard may also ask for its maxima, see `peaks.rs`.
//!
//! Of a guard with a direction the other crossing is no event. The step is cut there only if the guard turns back within
//! the same step, so that the next step begins on the other side of zero.

use blocksim_block::event::{Event, Subject};
use blocksim_block::schedule::Instance;
use blocksim_block::{Crossing, Guard};
use blocksim_solve::{Failed, locate};

use crate::evaluation::evaluate::Diagram;
use crate::events::guards::{Guards, Stride, first_loud};
use crate::events::looks::Looks;

/// Crossings in a row, without time getting on, after which nobody looks whether a guard turns back at once: near the start of a
/// step the dense output is off by a little of what the whole step changes, and where all is nearly at rest that looks like
/// turning back.
pub(crate) const HASTE: u32 = 16;

/// Where to look just behind the start of a step, in parts of the step: twice, as a step may be very long.
const NEAR: [f64; 2] = [1.0 / (1_u64 << 40) as f64, 1.0 / (1_u64 << 20) as f64];

/// How far behind the start, as a part of the time, the first of these looks tells of a crossing by itself: nearer, time and states have
/// too few digits.
const TELLS: f64 = 1e3 * f64::EPSILON;

/// What counts as the last digits of time and states, as a part of them.
const LAST: f64 = 8.0 * f64::EPSILON;

/// How often, for each guard, another one may turn out to have crossed before.
const EARLIER: usize = 8;

/// Writes what happens to a part, without its path, to `words`; returns its path.
pub(crate) fn phrase<'a>(
    words: &mut String,
    block: &'a Instance,
    subject: &'a Subject,
    verb: &str,
) -> &'a str {
    words.clear();
    words.push_str(verb);
    if let Some(detail) = &subject.detail {
        words.extend([" (", detail, ")"]);
    }
    subject.part.as_deref().unwrap_or(&block.path)
}

/// What the crossing of a guard is called; nothing where a mode or a jump is called something instead.
pub(crate) fn verb(guard: &Guard, upwards: bool) -> Option<&str> {
    match guard.event {
        Event::Name => Some(&guard.name),
        Event::Crossing { upwards: verb, .. } if upwards || guard.crossing == Crossing::Peak => Some(verb),
        Event::Crossing { downwards, .. } => Some(downwards),
        Event::Mode | Event::Bend => None,
    }
}

/// What a guard is about, for messages: its words in both directions, or those of the mode that it watches.
pub(crate) fn summary(block: &Instance, guard: &Guard) -> String {
    let detail = guard.subject.detail.as_ref().map_or_else(String::new, |detail| format!(" ({detail})"));
    let words = match guard.event {
        Event::Name => format!("crosses zero at its guard `{}`", guard.name),
        Event::Crossing { upwards, downwards } if upwards == downwards => upwards.to_owned(),
        Event::Crossing { upwards, downwards } => format!("{upwards} and {downwards}"),
        Event::Bend => "meets a steep part of its law".to_owned(),
        Event::Mode => {
            let modes = block.interface.discrete.iter().filter_map(|state| state.changes.as_deref());
            let own = modes.clone().find(|changes| changes.subject == guard.subject);
            own.or(modes.clone().next())
                .map_or_else(|| block.interface.jump_phrase.0.to_owned(), |own| own.summary())
        }
    };
    words + &detail
}

/// Where a step must be cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cut {
    pub t: f64,
    /// Whether a guard crossed; otherwise one left zero.
    pub crossed: bool,
}

impl Guards {
    /// Finds the values at the end of a step; returns whether a guard is seen from them to have crossed.
    pub fn arrive(&mut self, diagram: &mut Diagram, t1: f64, x1: &[f64]) -> Result<bool, Failed> {
        if self.is_empty() {
            return Ok(false);
        }
        diagram.minor(t1, x1)?;
        diagram.guards(&mut self.end)?;
        Ok(self.crossing(&self.end, false).is_some())
    }

    /// Looks for the first crossing in a step at whose end the values are known. Its states are then in `self.x`, the guards in
    /// `self.fired`.
    pub fn cut(&mut self, diagram: &mut Diagram, stride: &Stride) -> Result<Option<Cut>, Failed> {
        if self.is_empty() {
            return Ok(None);
        }
        let mut looks = std::mem::take(&mut diagram.looks);
        let found = self.first(&mut looks, diagram, stride);
        diagram.looks = looks;
        found
    }

    /// The first of crossings and maxima.
    fn first(
        &mut self,
        looks: &mut Looks,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Option<Cut>, Failed> {
        let peak = self.peak(looks, diagram, stride)?;
        let crossing = self.find(looks, diagram, stride)?;
        match peak {
            Some(peak) if crossing.is_none_or(|cut| peak.0 < cut.t) => {
                self.cut_at_peak(peak, diagram, stride).map(Some)
            }
            _ => Ok(crossing),
        }
    }

    fn find(
        &mut self,
        looks: &mut Looks,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Option<Cut>, Failed> {
        let mut right = stride.t1;
        if self.must_look_near() {
            let [first, second] = NEAR.map(|part| stride.t0 + (stride.t1 - stride.t0) * part);
            for near in [first, second] {
                if near <= stride.t0 || near >= stride.t1 {
                    continue;
                }
                self.at(near, diagram, stride)?;
                if self.crossing(&self.trial, false).is_some() {
                    let tells = near == second || near - stride.t0 > TELLS * near.abs();
                    if tells || !self.is_rounding(near, diagram)? {
                        right = near;
                        break;
                    }
                    self.at(near, diagram, stride)?;
                }
                if self.leave_zero() {
                    return Ok(Some(Cut { t: near, crossed: false }));
                }
            }
        }
        // Of what crosses zero and comes back, both crossings matter.
        let mut both = false;
        if right < stride.t1 {
            self.at(right, diagram, stride)?;
            std::mem::swap(&mut self.trial, &mut self.end);
        } else {
            let seen = self.see(looks, diagram, stride)?;
            let turned = self.turn(looks, diagram, stride)?;
            let mut times = [seen, turned];
            times.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
            // What does not cross there hides nothing behind.
            for t in times.into_iter().flatten().filter(|t| *t < stride.t1) {
                self.at(t, diagram, stride)?;
                if self.crossing(&self.trial, true).or_else(|| self.departing(&self.trial)).is_some() {
                    std::mem::swap(&mut self.trial, &mut self.end);
                    (right, both) = (t, true);
                    break;
                }
            }
        }
        self.fired.fill(false);
        let first = self.crossing(&self.end, both).or_else(|| self.departing(&self.end));
        let Some(mut guard) = first else {
            // What comes next starts where this step ends.
            self.turns.pass(&self.start, stride.t1 - stride.t0);
            self.start.copy_from_slice(&self.end);
            return Ok(None);
        };
        let mut turns = EARLIER * self.start.len();
        loop {
            let (left, end) = self.bracket(guard, right, diagram, stride)?;
            self.at(left, diagram, stride)?;
            let earlier = self.crossing(&self.trial, both).or_else(|| self.departing(&self.trial));
            // Guards that are nothing but rounding have each crossed just before the other, for ever.
            if let Some(earlier) = earlier.filter(|_| left > stride.t0 && left < right && turns > 0) {
                std::mem::swap(&mut self.trial, &mut self.end);
                (guard, right) = (earlier, left);
                turns -= 1;
                continue;
            }
            self.at(end, diagram, stride)?;
            let mut crossed = false;
            for i in 0..self.fired.len() {
                self.fired[i] = self.counts(i).happens(self.start[i], self.trial[i]);
                crossed |= self.fired[i];
            }
            return Ok(Some(Cut { t: end, crossed }));
        }
    }

    /// Whether the crossing at `t` disappears when the last digits of time and states change.
    fn is_rounding(&mut self, t: f64, diagram: &mut Diagram) -> Result<bool, Failed> {
        for (sign, stride) in [(1.0, 1), (-1.0, 1), (1.0, 2), (-1.0, 2)] {
            let change = |i: usize| sign * LAST * if (i / stride).is_multiple_of(2) { 1.0 } else { -1.0 };
            self.x.iter_mut().enumerate().for_each(|(i, x)| *x += change(i) * *x);
            diagram.minor(t + sign * LAST * t, &self.x)?;
            diagram.guards(&mut self.trial)?;
            self.x.iter_mut().enumerate().for_each(|(i, x)| *x -= change(i) * *x);
            if self.crossing(&self.trial, false).is_none() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The first guard, by number, that was zero at the start and is not any longer.
    fn departing(&self, values: &[f64]) -> Option<usize> {
        first_loud(&self.start, values, |i| self.leaves(i, values[i]))
    }

    /// Whether guard `i` has anything to leave: a mode that holds at zero holds beyond it.
    pub(crate) fn leaves(&self, i: usize, value: f64) -> bool {
        let ignored =
            self.deaf && self.kinks[i] || matches!(self.events[i], Crossing::Holds | Crossing::Peak);
        !ignored && self.start[i] == 0.0 && value != 0.0
    }

    /// Whether a guard was zero at the start and is no longer, or has just fired and seems to have stayed.
    fn must_look_near(&self) -> bool {
        let patient = self.chatter.1 < HASTE;
        let looks_near = |i: usize| {
            let (start, end, events) = (self.start[i], self.end[i], self.events[i]);
            // What has crossed in its direction cannot do so again before it has crossed back.
            let turns_back =
                || patient && events == Crossing::Either && self.fired[i] && !events.happens(start, end);
            if start == 0.0 { self.leaves(i, end) } else { turns_back() }
        };
        if self.fired.contains(&true) {
            return (0..self.start.len()).any(looks_near);
        }
        first_loud(&self.start, &self.end, looks_near).is_some()
    }

    /// Takes down, as those that fired, the guards that were zero at the start and are no longer at the trial point;
    /// returns whether there are any.
    fn leave_zero(&mut self) -> bool {
        if self.departing(&self.trial).is_none() {
            return false;
        }
        for i in 0..self.fired.len() {
            self.fired[i] = self.leaves(i, self.trial[i]);
        }
        true
    }

    /// Ends the step, at whose end the values and the states `x` are known, as a cut where guards have left zero; returns
    /// `false` if none has.
    pub(crate) fn depart_at_end(&mut self, x: &[f64]) -> bool {
        std::mem::swap(&mut self.trial, &mut self.end);
        let left = self.leave_zero();
        if left {
            self.x.copy_from_slice(x);
        }
        left
    }

    /// Narrows the first crossing of one guard before `right`, where `self.end` holds.
    fn bracket(
        &mut self,
        guard: usize,
        right: f64,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<(f64, f64), Failed> {
        let tolerance = 1e-15 * stride.t1.abs().max(stride.t1 - stride.t0);
        // Where a mode holds at zero, zero is on the near side.
        let holds = self.events[guard] == Crossing::Holds;
        let sided = |value: f64| if holds && value == 0.0 { f64::MIN_POSITIVE } else { value };
        let (start, end) = (sided(self.start[guard]), self.end[guard]);
        let mut failed = None;
        let value = |t| match self.at(t, diagram, stride) {
            Ok(()) => sided(self.trial[guard]),
            Err(failure) => {
                failed.get_or_insert(failure);
                f64::NAN
            }
        };
        let bracket = locate(value, stride.t0, start, right, end, tolerance);
        failed.map_or(Ok(bracket), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_reached_but_not_left() {
        let crosses = |start, end| Crossing::Either.happens(start, end);
        assert!(crosses(1.0, -1.0) && crosses(-1.0, 1.0) && crosses(1.0, 0.0) && crosses(-1.0, -0.0));
        assert!(!crosses(0.0, 1.0) && !crosses(0.0, -1.0) && !crosses(1.0, 2.0) && !crosses(1.0, f64::NAN));
    }

    #[test]
    fn a_direction_leaves_the_other_one_out() {
        assert!(Crossing::Rising.happens(-1.0, 0.0) && !Crossing::Rising.happens(1.0, -1.0));
        assert!(Crossing::Falling.happens(1.0, 0.0) && !Crossing::Falling.happens(-1.0, 1.0));
    }
}
