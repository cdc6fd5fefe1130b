//! Guards that leave zero flatly: with a slope of zero, as what has been integrated several times does from rest.
//!
//! The dense output of a step has the values and slopes of both its ends and is off by a little in between. Where a guard leaves
//! zero with a slope, that does not change its sign just behind the start. Where it leaves as a higher power of time, the little is
//! more than the guard itself, and its sign is noise. Such a guard is known by its value at a short step of Euler's along
//! the slopes at the start, which has not the sign that the dense output has there.
//!
//! A step that is so short that the first power of time outweighs the others ends with the right sign, if the method has that
//! power. So two short steps of order 5 set out from there, together a billionth of the step long or, if the guard is zero still
//! there, longer: where it rests for a while, bisection finds the end of that. The next steps double the time since the start, until
//! tolerances keep them shorter: then what the dense output is off by stays small as compared with the guard at both ends.
//!
//! The short steps are explicit, the step that was kept may be one of a stiff method, for which they are too long. So they count only
//! where they lead to about the same states.

use blocksim_block::schedule::Solver;
use blocksim_solve::{FixedStep, StepError, Stepper, System};

use crate::evaluation::evaluate::Diagram;
use crate::events::crossings::Cut;
use crate::{SimError, Simulation};

/// Parts of a step that are tried, the shortest first.
const SHORT: [f64; 5] = [
    1.0 / (1_u64 << 30) as f64,
    1.0 / (1_u64 << 20) as f64,
    1.0 / (1_u64 << 10) as f64,
    1.0 / (1_u64 << 5) as f64,
    0.25,
];

/// By how much a guard may differ, as a part, from where the slopes at its start lead it.
const AGREES: f64 = 0.1;
/// Part of the way to the end of a step below which a slope at its start does not lead there.
const STRAIGHT: f64 = 0.25;
/// What moves so little leaves zero by one digit, and is hardly further away after this part of its way.
const SLOWLY: f64 = 1e-3;
/// Relative tolerances by which short steps may be off.
const TOLERANCES: f64 = 10.0;
/// Longest step on the way out, as a part of the time since the start.
const GROWTH: f64 = 1.0;

/// What guards do on the way from their zero.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// They are zero still.
    Rests,
    Leaves,
    /// Another one crosses zero.
    Crosses,
    /// It is not known: the short steps lead elsewhere, or nowhere.
    Strays,
}

/// What sets out from the zero of a guard.
pub(crate) struct Departure {
    steps: FixedStep,
    /// Where the short steps lead, and where the dense output is.
    x: Vec<f64>,
    dense: Vec<f64>,
}

impl Departure {
    pub fn new(states: usize) -> Self {
        let zeros = || vec![0.0; states];
        Self { steps: FixedStep::ode5(states, f64::INFINITY), x: zeros(), dense: zeros() }
    }

    /// Room for states, twice.
    pub fn rooms(&mut self) -> (&mut [f64], &mut [f64]) {
        (&mut self.dense, &mut self.x)
    }

    /// Goes from the states `x0` at `t0` to `end`.
    fn go(&mut self, diagram: &mut Diagram, t0: f64, x0: &[f64], end: f64) -> Result<(), StepError> {
        self.x.copy_from_slice(x0);
        let mut t = t0;
        self.steps.step(diagram, &mut t, &mut self.x, t0 + 0.5 * (end - t0))?;
        self.steps.step(diagram, &mut t, &mut self.x, end)
    }

    /// Whether the short steps are as near to the dense output, a part `theta` into the step from `x0` to `x1`, as tolerances are, or
    /// as what the step moves in so short a part: just behind its start the dense output is not more exact.
    fn agrees(&self, x0: &[f64], x1: &[f64], theta: f64, rtol: f64) -> bool {
        let states = self.x.iter().zip(&self.dense).zip(x0.iter().zip(x1));
        states.into_iter().all(|((x, dense), (x0, x1))| {
            let tolerance = TOLERANCES * rtol * x0.abs().max(x1.abs());
            (x - dense).abs() <= tolerance + theta * (x1 - x0).abs()
        })
    }
}

impl Simulation {
    /// The longest step that may be made now, if one before has set out from the zero of a guard.
    pub(crate) fn longest_way_out(&self, limit: f64) -> f64 {
        self.guards.set_out.map_or(limit, |since| limit.min(self.t + GROWTH * (self.t - since)))
    }

    /// Where the step from `t0` is to be cut instead, if `cut` is where guards leave zero on a side that only the dense
    /// output says.
    pub(crate) fn leave_flatly(&mut self, t0: f64, cut: Option<Cut>) -> Result<Option<Cut>, SimError> {
        let Some(Cut { t, crossed: false }) = cut else { return Ok(cut) };
        if self.stepper.is_none() || !self.is_flat(t0, t)? {
            return Ok(cut);
        }
        let step = self.t - t0;
        let mut rests = t0;
        for end in SHORT.map(|part| t0 + part * step).into_iter().filter(|end| *end > t0) {
            match self.set_out(t0, end)? {
                Way::Rests => rests = end,
                Way::Crosses | Way::Strays => break,
                Way::Leaves => {
                    let t = if rests > t0 { self.end_of_rest(t0, rests, end, step)? } else { end };
                    // What another crossing on the way has changed is found as without this.
                    if self.set_out(t0, t)? != Way::Leaves {
                        break;
                    }
                    self.guards.set_out = Some(t0);
                    return Ok(Some(Cut { t, crossed: false }));
                }
            }
        }
        self.crossing(t0)
    }

    /// Goes from the start of a step at `t0` to `end` and looks what guards do there.
    fn set_out(&mut self, t0: f64, end: f64) -> Result<Way, SimError> {
        let Self { guards, diagram, kinks, departure, .. } = self;
        if departure.go(diagram, t0, &kinks.x, end).is_err() {
            // The step itself was possible.
            diagram.failure = None;
            return Ok(Way::Strays);
        }
        if let (Some(stepper), Solver::Variable { rtol, .. }) = (&self.stepper, self.schedule.settings.solver)
        {
            stepper.interpolate(end, &mut departure.dense);
            if !departure.agrees(&kinks.x, &self.x, (end - t0) / (self.t - t0), rtol) {
                return Ok(Way::Strays);
            }
        }
        let arrived = guards.arrive(diagram, end, &departure.x);
        if self.held(arrived)? {
            return Ok(Way::Crosses);
        }
        let leaves = self.guards.depart_at_end(&self.departure.x);
        Ok(if leaves { Way::Leaves } else { Way::Rests })
    }

    /// Where guards no longer rest on zero, to the last digits: after `rests`, not after `left`. Where they rest by rounding alone, since what
    /// moves them is too little still, it is `left`.
    fn end_of_rest(&mut self, t0: f64, mut rests: f64, left: f64, step: f64) -> Result<f64, SimError> {
        let mut end = left;
        let bracket = 1e-15 * left.abs().max(step);
        while end - rests > bracket {
            let middle = 0.5 * (rests + end);
            if middle <= rests || middle >= end {
                break;
            }
            match self.set_out(t0, middle)? {
                Way::Rests => rests = middle,
                Way::Leaves | Way::Crosses | Way::Strays => end = middle,
            }
        }
        let at_end = self.set_out(t0, end)?;
        let Some(guard) = self.guards.fired.iter().position(|left| *left && at_end == Way::Leaves) else {
            return Ok(end);
        };
        let first = self.guards.trial[guard].abs();
        let behind = self.set_out(t0, end + SLOWLY * (end - t0))?;
        let is_rounding = behind == Way::Leaves && self.guards.trial[guard].abs() <= 2.0 * first;
        Ok(if is_rounding { left } else { end })
    }

    /// Whether a guard that leaves zero in the step from `t0` has not the value at `t` that the slopes at the start lead to, or hardly
    /// any of that which it has at the end.
    fn is_flat(&mut self, t0: f64, t: f64) -> Result<bool, SimError> {
        let Self { guards, diagram, kinks, departure, .. } = self;
        // Values at the cut are in `trial`; those within the step are not asked for any longer.
        let (values, x) = (&mut guards.low, &mut departure.x);
        let mut follow_slopes = || {
            diagram.derivatives(t0, &kinks.x, x)?;
            x.iter_mut().zip(&kinks.x).for_each(|(x, x0)| *x = x0 + (t - t0) * *x);
            diagram.minor(t, x)?;
            diagram.guards(values)
        };
        let followed = follow_slopes();
        self.held(followed)?;
        let guards = &self.guards;
        let parts = (self.t - t0) / (t - t0);
        Ok((0..guards.start.len()).any(|i| {
            let (seen, led, end) = (guards.trial[i], guards.low[i], guards.end[i]);
            let is_led = (seen - led).abs() <= AGREES * led.abs();
            guards.leaves(i, seen) && !(is_led && (led * parts).abs() >= STRAIGHT * end.abs())
        }))
    }
}
