//! Guards of the kind `Peak`: an event where the guard has a maximum within a step, whatever its sign.
//!
//! A maximum lies between three points of which the one in the middle is highest. The points are the ends of the step, the
//! stages of the method, which cost nothing but are hints only, and one point close to each end, which shows with which
//! slope the guard sets out and arrives. Where a maximum shows, all these points are looked at again on the dense output. Between the outer two of the three the maximum is narrowed on the dense output by golden
//! sections. Its time is known to a hundred-thousandth of the step, hence its value to the square of that.

use blocksim_block::Crossing;
use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;
use crate::events::crossings::Cut;
use crate::events::guards::{Guards, Stride};
use crate::events::looks::Looks;

/// How close to an end its slope is taken, as a part of the step.
const PART: f64 = 1.0 / 1024.0;
/// Sections; each leaves 0.618 of the interval.
const SECTIONS: usize = 24;
/// A maximum that is higher than its surroundings by no more than this part of its way is rounding.
const ROUNDING: f64 = 1e-12;

impl Guards {
    /// The first maximum in the step of any guard of the kind `Peak`, and whose it is. Needs the values at both ends.
    pub(crate) fn peak(
        &mut self,
        looks: &mut Looks,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Option<(f64, usize)>, Failed> {
        let Stride { t0, t1, .. } = *stride;
        let (early, late) = (t0 + PART * (t1 - t0), t1 - PART * (t1 - t0));
        let has_inside = t0 < early && early < late && late < t1;
        if !has_inside || !(0..self.start.len()).any(|i| self.is_armed(i)) {
            return Ok(None);
        }
        for t in [early, 0.5 * (t0 + t1), late] {
            self.at(t, diagram, stride)?;
            looks.row(t).copy_from_slice(&self.trial);
        }
        let count = looks.find_within(t0, t1);
        if !(0..self.start.len()).any(|i| self.is_armed(i) && (1..=count).any(|k| self.is_top(i, k, looks))) {
            return Ok(None);
        }
        // A stage that lies off the solution makes tops where there are none, and hides those that there are.
        for k in 0..count {
            let t = looks.within(k).0;
            self.at(t, diagram, stride)?;
            looks.row(t).copy_from_slice(&self.trial);
        }
        let time = |k: usize| match k {
            0 => t0,
            k if k > count => t1,
            k => looks.within(k - 1).0,
        };
        let mut first: Option<(f64, usize)> = None;
        for i in 0..self.start.len() {
            if !self.is_armed(i) {
                continue;
            }
            for top in 1..=count {
                if !self.is_top(i, top, looks) {
                    continue;
                }
                let (left, right) = (time(top - 1), time(top + 1));
                if first.is_some_and(|(t, _)| left >= t) {
                    break;
                }
                if let Some(t) = self.summit(i, left, right, diagram, stride)? {
                    first = first.filter(|(before, _)| *before <= t).or(Some((t, i)));
                    break;
                }
            }
        }
        Ok(first)
    }

    /// Whether guard `i` waits for a maximum and moves.
    fn is_armed(&self, i: usize) -> bool {
        self.events[i] == Crossing::Peak && self.start[i] != self.end[i]
    }

    /// Whether guard `i` is not lower at the `k`th point of the step, counted from its start as 0, than just before and higher
    /// than just behind.
    fn is_top(&self, i: usize, k: usize, looks: &Looks) -> bool {
        let value = |k: usize| match k {
            0 => self.start[i],
            k if k > looks.len() => self.end[i],
            k => looks.within(k - 1).1[i],
        };
        value(k) >= value(k - 1) && value(k) > value(k + 1)
    }

    /// Where guard `i` is highest between two times, if that is neither of them.
    fn summit(
        &mut self,
        i: usize,
        mut left: f64,
        mut right: f64,
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Option<f64>, Failed> {
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let mut value = |t: f64| self.at(t, diagram, stride).map(|()| self.trial[i]);
        let ends = [value(left)?, value(right)?];
        let (mut a, mut b) = (right - golden * (right - left), left + golden * (right - left));
        let (mut at_a, mut at_b) = (value(a)?, value(b)?);
        for _ in 0..SECTIONS {
            if at_a >= at_b {
                (right, b, at_b) = (b, a, at_a);
                a = right - golden * (right - left);
                at_a = value(a)?;
            } else {
                (left, a, at_a) = (a, b, at_b);
                b = left + golden * (right - left);
                at_b = value(b)?;
            }
        }
        let (t, top) = if at_a >= at_b { (a, at_a) } else { (b, at_b) };
        let way = (top - ends[0].min(ends[1])).abs() + top.abs();
        Ok((top - ends[0].max(ends[1]) > ROUNDING * way).then_some(t))
    }

    /// Ends the step at a maximum, with the states there in `self.x`.
    pub(crate) fn cut_at_peak(
        &mut self,
        (t, guard): (f64, usize),
        diagram: &mut Diagram,
        stride: &Stride,
    ) -> Result<Cut, Failed> {
        self.at(t, diagram, stride)?;
        self.fired.fill(false);
        self.fired[guard] = true;
        Ok(Cut { t, crossed: true })
    }
}
