//! Kinks of laws that are not held on their side between events (limits, dead zones, least and greatest).
//!
//! A step that passes a kink has stages on both sides of it, and neither its end nor its dense output up to the kink is
//! as exact as its error estimate says. Such a step is thrown away and made once more up to the kink, so that all its
//! stages lie on one side; a method of several steps takes the history back that it had before. So is a step that something
//! else cuts while a kink lies behind the cut: stages beyond bend the dense output before it.

use blocksim_block::schedule::{Schedule, Solver};

use crate::events::crossings::Cut;
use crate::{SimError, Simulation};

/// A step that is cut before this part of it is short: what it saw beyond the kink is behind it anyway.
const SHORT: f64 = 1e-3;

/// What is needed to repeat a step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Kinks {
    /// Of each guard, whether it is that of a kink; empty where no step is repeated for one.
    kinks: Vec<bool>,
    /// States at the start of the step.
    pub x: Vec<f64>,
    /// A point close by.
    pub ahead: Vec<f64>,
}

impl Kinks {
    pub fn new(schedule: &Schedule) -> Self {
        let free = matches!(schedule.settings.solver, Solver::Variable { .. });
        let guards = schedule.blocks.iter().flat_map(|block| &block.interface.guards);
        let kinks: Vec<bool> = guards.map(|guard| guard.kink).collect();
        let zeros = vec![0.0; schedule.states];
        let stops = schedule.states > 0 && free && kinks.contains(&true);
        Self { kinks: if stops { kinks } else { Vec::new() }, x: zeros.clone(), ahead: zeros }
    }

    /// Notes where a step begins.
    pub fn begin(&mut self, x: &[f64]) {
        self.x.copy_from_slice(x);
    }
}

impl Simulation {
    /// Whether the step from `t0` has looked so far beyond a kink that it must be made once more, up to where it is cut.
    pub(crate) fn stops_at_kink(&self, t0: f64, cut: Cut) -> bool {
        let h = self.t - t0;
        let looks = &self.diagram.looks;
        let mut kinks = self.kinks.kinks.iter().zip(&self.guards.fired).enumerate();
        let mut passed =
            || kinks.any(|(i, (&kink, &fired))| kink && (fired || looks.straddle(i, t0, self.t)));
        cut.crossed && cut.t - t0 > SHORT * h && self.t - cut.t > SHORT * h && passed()
    }

    /// Makes the step from `t0` once more, up to `end` at the longest.
    pub(crate) fn repeat(&mut self, t0: f64, end: f64) -> Result<(), SimError> {
        self.t = t0;
        self.x.copy_from_slice(&self.kinks.x);
        self.stepper.iter_mut().for_each(|stepper| stepper.back());
        self.step(end)
    }
}
