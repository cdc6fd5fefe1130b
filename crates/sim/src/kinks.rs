//! Kinks of laws that are not held on their side between events (limits, dead zones, least and greatest).
//!
//! A step that passes a kink has stages on both sides of it, and neither its end nor its dense output up to the kink is
//! as exact as its error estimate says. Such a step is thrown away and made once more up to the kink, so that all its
//! stages lie on one side. Methods of several steps would have to begin anew for that; they stop at the kink as their
//! dense output has it.

use blocksim_block::schedule::{Schedule, Solver, VariableMethod};
use blocksim_solve::Stepper;

use crate::events::Cut;
use crate::{SimError, Simulation};

/// A step that is cut before this part of it is short: what it saw beyond the kink is behind it anyway.
const SHORT: f64 = 1e-3;

/// What is needed to repeat a step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Kinks {
    /// Of each guard, whether it is that of a kink; empty where no step is repeated.
    kinks: Vec<bool>,
    /// States at the start of the step.
    x: Vec<f64>,
    /// Steps so far of the stiff half of a method that is two.
    stiff: u64,
}

impl Kinks {
    pub fn new(schedule: &Schedule) -> Self {
        let single = match schedule.settings.solver {
            Solver::Fixed { .. } => false,
            Solver::Variable { method, .. } => method != VariableMethod::Ode15s,
        };
        let guards = schedule.blocks.iter().flat_map(|block| &block.interface.guards);
        let kinks: Vec<bool> = guards.map(|guard| guard.kink).collect();
        if schedule.states == 0 || !single || !kinks.contains(&true) {
            return Self::default();
        }
        Self { kinks, x: vec![0.0; schedule.states], stiff: 0 }
    }

    /// Notes where a step begins.
    pub fn begin(&mut self, stepper: Option<&dyn Stepper>, x: &[f64]) {
        if self.kinks.is_empty() {
            return;
        }
        self.x.copy_from_slice(x);
        self.stiff = stiff_steps(stepper);
    }
}

fn stiff_steps(stepper: Option<&dyn Stepper>) -> u64 {
    stepper.and_then(Stepper::share).map_or(0, |share| share.stiff)
}

impl Simulation {
    /// Whether the step from `t0` has looked so far beyond a kink that it must be made once more.
    pub(crate) fn stops_at_kink(&self, t0: f64, cut: Cut) -> bool {
        let Kinks { kinks, stiff, .. } = &self.kinks;
        let passed = || kinks.iter().zip(&self.guards.fired).any(|(&kink, &fired)| kink && fired);
        let h = self.t - t0;
        cut.crossed
            && cut.t - t0 > SHORT * h
            && self.t - cut.t > SHORT * h
            && passed()
            && *stiff == stiff_steps(self.stepper.as_deref())
    }

    /// Makes the step from `t0` once more, up to `end` at the longest.
    pub(crate) fn repeat(&mut self, t0: f64, end: f64) -> Result<(), SimError> {
        self.t = t0;
        self.x.copy_from_slice(&self.kinks.x);
        self.stepper.iter_mut().for_each(|stepper| stepper.restart());
        self.step(end)
    }
}
