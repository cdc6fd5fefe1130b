//! The guards of a diagram over a step: their values, and what is remembered of their events.

use blocksim_block::Crossing;
use blocksim_solve::{Failed, Stepper};

use crate::evaluation::evaluate::Diagram;
use crate::events::rhythm::{Accumulation, Rhythm};
use crate::events::scan::Samples;
use crate::events::slopes::Turns;
use blocksim_block::Resolution;

/// Crossings in a row, without time getting on, that are taken for chatter.
const CHATTER: u32 = 1000;
/// Time that is too short for time to have got on, as a part of it: there is room for some events, not for thousands.
const HASTE: f64 = 1e-9;
/// Crossings in a row, without time getting on, after which steps pass over kinks: these are continuous, and what crosses one so
/// often is nothing but what the dense output is off by.
const DEAF: u32 = 100;

/// An accepted step of the solver.
pub(crate) struct Stride<'a> {
    pub t0: f64,
    pub t1: f64,
    /// Absent without states.
    pub stepper: Option<&'a dyn Stepper>,
}

/// Values of all guards and what is remembered of their events.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Guards {
    /// Which crossings of each are events.
    pub events: Vec<Crossing>,
    pub resolution: Resolution,
    /// At the start of the step.
    pub start: Vec<f64>,
    /// At its end, which moves towards the first crossing.
    pub end: Vec<f64>,
    pub trial: Vec<f64>,
    /// The least and the greatest value within the step, as far as anybody looked.
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    /// How far it went from look to look, to and fro, and where it was at the last of them.
    pub path: Vec<f64>,
    pub last: Vec<f64>,
    /// Those with one sign at both ends that are near enough to zero to have reached it in between.
    pub near: Vec<bool>,
    /// Those that may have crossed zero unseen.
    pub doubtful: Vec<bool>,
    /// Values at many points of a step.
    pub samples: Samples,
    /// What is known of their slopes.
    pub turns: Turns,
    /// States at a trial point, and at the cut in the end.
    pub x: Vec<f64>,
    /// The latter, while an audit looks elsewhere.
    pub kept: Vec<f64>,
    /// Those that crossed or left zero at the last cut, if that was the last step.
    pub fired: Vec<bool>,
    /// Those that have fired, and may come back within the step to fire again.
    pub hops: Vec<bool>,
    /// How many steps in a row have been made once more for a crossing of a guard that has not moved at all then.
    pub refuted: u32,
    /// Those that have fired where the step at hand begins.
    pub left: Vec<bool>,
    /// When each fired lately.
    pub rhythm: Rhythm,
    /// Where guards have last left zero flatly, s: steps are no longer than the time since.
    pub set_out: Option<f64>,
    /// Whether `start` holds for the step to come.
    pub known: bool,
    /// Since when, and how often, guards have crossed without time getting on.
    pub chatter: (f64, u32),
    /// Which guards are those of kinks, and whether these are passed over in this step.
    pub kinks: Vec<bool>,
    pub deaf: bool,
    /// Whether signals may jump where the step at hand ends. Who waits for one direction remembers on which side a signal was, and must have
    /// seen it there: a signal that crosses the other way and jumps back would seem never to have left.
    pub jumps: bool,
}

/// How many guards are looked at abreast.
const ABREAST: usize = 8;

/// The first `i` that is `found`, among those where not both values are above zero, nor both below, nor both zero. Most guards keep
/// their sign in most steps, so they are passed over several at once.
pub(crate) fn first_loud(
    start: &[f64],
    values: &[f64],
    mut found: impl FnMut(usize) -> bool,
) -> Option<usize> {
    let n = start.len().min(values.len());
    let (some, rest) = start[..n].as_chunks::<ABREAST>();
    let (others, _) = values[..n].as_chunks::<ABREAST>();
    for (k, (a, b)) in some.iter().zip(others).enumerate() {
        let quiet = |i: usize| {
            (a[i] > 0.0) & (b[i] > 0.0) | (a[i] < 0.0) & (b[i] < 0.0) | (a[i] == 0.0) & (b[i] == 0.0)
        };
        if (0..ABREAST).fold(true, |all, i| all & quiet(i)) {
            continue;
        }
        let first = (0..ABREAST).find(|&i| !quiet(i) && found(ABREAST * k + i));
        if let Some(i) = first {
            return Some(ABREAST * k + i);
        }
    }
    (n - rest.len()..n).find(|&i| found(i))
}

impl Guards {
    pub fn new(events: Vec<Crossing>, states: usize, resolution: Resolution) -> Self {
        let guards = events.len();
        let zeros = vec![0.0; guards];
        Self {
            events,
            resolution,
            turns: Turns::new(guards),
            start: zeros.clone(),
            end: zeros.clone(),
            low: zeros.clone(),
            high: zeros.clone(),
            path: zeros.clone(),
            last: zeros.clone(),
            near: vec![false; guards],
            doubtful: vec![false; guards],
            samples: Samples::new(guards),
            trial: zeros,
            x: vec![0.0; states],
            kept: Vec::new(),
            fired: vec![false; guards],
            hops: vec![false; guards],
            refuted: 0,
            left: vec![false; guards],
            rhythm: Rhythm::new(guards),
            set_out: None,
            known: false,
            chatter: (f64::NEG_INFINITY, 0),
            kinks: vec![false; guards],
            deaf: false,
            jumps: false,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// Notes the values at the start of a step.
    pub fn begin(&mut self, diagram: &mut Diagram, t: f64, x: &[f64]) -> Result<(), Failed> {
        self.deaf = self.chatter.1 >= DEAF && t - self.chatter.0 <= HASTE * self.resolution.size(t);
        if self.known || self.is_empty() {
            return Ok(());
        }
        self.known = true;
        diagram.loops.stays = true;
        let known = diagram.minor(t, x).and_then(|()| diagram.guards(&mut self.start));
        diagram.loops.stays = false;
        known?;
        diagram.steady_guards(&mut self.start);
        Ok(())
    }

    /// The first guard, by number, whose sign is not that of the start; `both` if those count, too, that are no events.
    pub fn crossing(&self, values: &[f64], both: bool) -> Option<usize> {
        first_loud(&self.start, values, |i| {
            if self.kinks[i] && self.deaf {
                return false;
            }
            let events = self.events[i];
            let counts = if both && !matches!(events, Crossing::Holds | Crossing::Peak) {
                Crossing::Either
            } else {
                self.counts(i)
            };
            counts.happens(self.start[i], values[i])
        })
    }

    /// Which crossings of guard `i` end the step at hand.
    pub fn counts(&self, i: usize) -> Crossing {
        match self.events[i] {
            Crossing::Rising | Crossing::Falling if self.jumps => Crossing::Either,
            events => events,
        }
    }

    /// Whether a guard that waits for one direction has crossed the other way by the trial point.
    pub fn has_crossed_back(&self) -> bool {
        let crossed = first_loud(&self.start, &self.trial, |i| {
            let (start, trial, events) = (self.start[i], self.trial[i], self.events[i]);
            matches!(events, Crossing::Rising | Crossing::Falling)
                && start != 0.0
                && Crossing::Either.happens(start, trial)
                && !events.happens(start, trial)
        });
        crossed.is_some()
    }

    /// Whether guard `i`, which has fired, has done so in the direction that it waits for.
    pub fn is_awaited(&self, i: usize) -> bool {
        match self.events[i] {
            Crossing::Rising => self.rises(i),
            Crossing::Falling => !self.rises(i),
            _ => true,
        }
    }

    /// Values of the guards at a point within the step.
    pub fn at(&mut self, t: f64, diagram: &mut Diagram, stride: &Stride) -> Result<(), Failed> {
        if let Some(stepper) = stride.stepper {
            stepper.interpolate(t, &mut self.x);
        }
        diagram.minor(t, &self.x)?;
        diagram.guards(&mut self.trial)
    }

    /// The first guard that says at the start of a step that a mode is wrong.
    pub fn broken(&self) -> Option<usize> {
        let mut guards = self.start.iter().zip(&self.events);
        guards.position(|(&start, &events)| events == Crossing::Holds && start < 0.0)
    }

    /// Whether guard `i`, which has fired, has gone upwards.
    pub fn rises(&self, i: usize) -> bool {
        self.start[i] < 0.0 || self.start[i] == 0.0 && self.trial[i] > 0.0
    }

    /// Notes the guards that have fired at `t`; returns one whose events have no end.
    pub fn beat(&mut self, t: f64) -> Option<(usize, Accumulation)> {
        let fired = (0..self.fired.len()).filter(|&i| self.fired[i]);
        fired.fold(None, |endless, i| endless.or(self.rhythm.beat(i, t).map(|found| (i, found))))
    }

    /// Counts a cut and tells whether there have been too many.
    pub fn chatters(&mut self, t: f64) -> bool {
        let (since, count) = self.chatter;
        self.chatter = if t - since <= HASTE * self.resolution.size(t) { (since, count + 1) } else { (t, 1) };
        self.chatter.1 > CHATTER
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guards_that_keep_their_sign_hide_no_other() {
        let signs = [1.0, -1.0, 0.0, -0.0, f64::NAN];
        for n in [0, 1, 7, 8, 9, 16, 21] {
            let quiet: Vec<f64> = (0..n).map(|i| [2.0, -2.0, 0.0][i % 3]).collect();
            assert_eq!(
                first_loud(&quiet, &quiet, |_| true).is_some(),
                n % ABREAST != 0,
                "the rest is not sorted out"
            );
            for at in 0..n {
                for (a, b) in signs.iter().flat_map(|a| signs.map(|b| (*a, b))) {
                    for crossing in [Crossing::Either, Crossing::Rising, Crossing::Falling, Crossing::Holds] {
                        let (mut start, mut end) = (quiet.clone(), quiet.clone());
                        (start[at], end[at]) = (a, b);
                        let happens = |i: usize| crossing.happens(start[i], end[i]);
                        assert_eq!(first_loud(&start, &end, happens), (0..n).find(|&i| happens(i)));
                    }
                }
            }
        }
    }

    #[test]
    fn chatter_is_a_thousand_crossings_in_a_nanosecond() {
        let mut guards = Guards::new(vec![Crossing::Either], 0, Resolution::new(1.0));
        assert!((0..1000).all(|k| !guards.chatters(f64::from(k) * 1e-13)));
        assert!(guards.chatters(1e-10));
        assert!(!guards.chatters(1.0));
        let mut quick = Guards::new(vec![Crossing::Either], 0, Resolution::new(1e-6));
        assert!(
            (0..2000).all(|k| !quick.chatters(f64::from(k) * 1e-13)),
            "there is time enough in a run of 1 us"
        );
    }
}
