//! Crossings that the derivatives do not confirm.
//!
//! A guard may be much more sensitive than the states it is made of: the current of a diode into a capacitor is the
//! difference of two voltages over some milliohms, and what a voltage may be off by is a third of that current. On the dense output
//! of a step, and even at its end, such a guard crosses zero by the error of the step alone, while the derivatives
//! at that very state lead it elsewhere: back to where it came from (the valve would block, find itself at once with a voltage that
//! opens it, conduct, and so on), or much faster through zero (it should have crossed long ago). And the law may have a
//! narrow peak just before the crossing, as dry friction has about standstill, which the stages of a long step do not see or
//! which one of them hits by chance.
//!
//! And a guard that crosses zero where a step begins may be back by its end: something opens and closes again. A method that evaluates
//! nothing in between has seen nothing of it.
//!
//! So a crossing counts only where the derivatives lead the guard through zero in the same direction and about as fast as
//! the dense output does. If not, the step is made once more up to there, as its end is more exact than its dense
//! output was, and then ever shorter.

use blocksim_block::Crossing;
use blocksim_solve::System as _;

use crate::events::crossings::{Cut, HASTE};
use crate::events::guards::{Guards, Stride};
use crate::{SimError, Simulation};

/// How often a step is made once more for a crossing. What is not confirmed then is one of the last digits.
const TRIES: u32 = 12;
/// How many steps in a row may be made once more for a crossing of what does not move in them. One rounding error before a fixed end
/// each step is cut where the dense output gets there, and in so short a step the position stays the same number.
const REFUTED: u32 = 8;
/// How far before the crossing to compare, as a part of the way there.
const BEFORE: f64 = 1.0 / (1_u64 << 14) as f64;
/// The same as a part of the time, at least, so that it has digits enough.
const LEAST: f64 = 1.0 / (1_u64 << 34) as f64;
/// How many times as fast, or as slow, the derivatives may lead through zero. Where a step resolves what happens they agree far better; a
/// peak of the friction about standstill that lies within a step is seen by single stages alone, which shows in a tenth of the slope or so.
const AGREES: f64 = 1.03;

impl Simulation {
    /// Makes the step from `t0`, which is to be cut at `cut`, shorter while the derivatives do not confirm the crossing.
    /// Returns where it is to be cut then.
    pub(crate) fn confirm(&mut self, t0: f64, mut cut: Option<Cut>) -> Result<Option<Cut>, SimError> {
        let mut before = None;
        for tried in 0..TRIES {
            let Some(found) = cut.filter(|cut| cut.crossed && self.guards.refuted < REFUTED) else { break };
            let unseen = tried == 0 && self.is_unseen();
            if !unseen && self.is_confirmed(t0, found.t)? {
                break;
            }
            before = self.guards.fired.iter().position(|fired| *fired).map(|i| (i, self.guards.start[i]));
            self.repeat(t0, if tried == 0 && !unseen { found.t } else { t0 + 0.5 * (found.t - t0) })?;
            cut = self.crossing(t0)?;
        }
        // Where nothing has crossed, the next step starts from the values at the end.
        let stands = cut.is_none() && before.is_some_and(|(i, value)| self.guards.start[i] == value);
        self.guards.refuted = if stands { self.guards.refuted + 1 } else { 0 };
        Ok(cut)
    }

    /// Whether a guard has left zero at the start of the step and is back, while the method has evaluated nothing in between.
    fn is_unseen(&self) -> bool {
        let mut both = self.guards.fired.iter().zip(&self.guards.left);
        self.stepper.as_ref().is_some_and(|stepper| !stepper.sees_within())
            && both.any(|(back, left)| *back && *left)
    }

    /// Whether the guards that cross zero at `t` in the step from `t0` were about there before, had they come along the derivatives at `t`.
    fn is_confirmed(&mut self, t0: f64, t: f64) -> Result<bool, SimError> {
        let before = t - (BEFORE * (t - t0)).max(LEAST * t.abs());
        // What crosses again and again without time getting on is not made better by shorter steps.
        let is_hasty = self.guards.chatter.1 >= HASTE;
        if self.stepper.is_none() || before <= t0 || is_hasty || self.guards.crossed().next().is_none() {
            return Ok(true);
        }
        let stride = Stride { t0, t1: self.t, stepper: self.stepper.as_deref() };
        let Self { guards, diagram, departure, .. } = self;
        // States and values at the cut are still needed.
        let (at_cut, _) = departure.rooms();
        at_cut.copy_from_slice(&guards.x);
        guards.high.copy_from_slice(&guards.trial);
        let seen = guards.at(before, diagram, &stride);
        guards.x.copy_from_slice(at_cut);
        std::mem::swap(&mut guards.high, &mut guards.trial);
        self.held(seen)?;
        let Self { guards, diagram, departure, .. } = self;
        let (at_cut, followed) = departure.rooms();
        let follow = || {
            diagram.derivatives(t, at_cut, followed)?;
            followed.iter_mut().zip(at_cut).for_each(|(x, cut)| *x = *cut + (before - t) * *x);
            diagram.minor(before, followed)?;
            diagram.guards(&mut guards.low)
        };
        if follow().is_err() {
            // The solution has not been there.
            diagram.failure = None;
            return Ok(true);
        }
        Ok(guards.are_confirmed())
    }
}

impl Guards {
    /// The guards that have crossed zero from a sign that they had before.
    fn crossed(&self) -> impl Iterator<Item = usize> {
        let own = |i: usize| self.fired[i] && self.events[i] != Crossing::Peak && self.start[i] != 0.0;
        (0..self.fired.len()).filter(move |&i| own(i))
    }

    /// Whether the values before the crossing agree: `high` on the dense output, `low` along the derivatives.
    fn are_confirmed(&self) -> bool {
        self.crossed().all(|i| {
            let (seen, followed) = (self.high[i], self.low[i]);
            let (least, most) = (seen.abs().min(followed.abs()), seen.abs().max(followed.abs()));
            seen * followed >= 0.0 && most <= AGREES * least
        })
    }
}
