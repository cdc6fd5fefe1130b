//! The loop of every method with an error estimate: propose, try, keep or repeat.

use crate::step_size::{StepSize, Trial};
use crate::stepper::{Experience, Memory, Stages};
use crate::weights::{Learnt, Weights};
use crate::{Counts, StepError, StepLimits, Stepper, System, Tolerances};

/// Why a trial broke off.
pub enum Fault {
    /// The system failed.
    System,
    /// The derivative of this state is not finite.
    NotFinite(usize),
}

/// The system with its evaluations counted and checked.
pub struct Work<'a> {
    pub(crate) system: &'a mut dyn System,
    pub(crate) counts: &'a mut Counts,
    pub(crate) weights: &'a Weights,
}

impl Work<'_> {
    /// dx = f(t, x), all of it finite.
    pub(crate) fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Fault> {
        self.counts.evaluations += 1;
        self.system.derivatives(t, x, dx).map_err(|_| Fault::System)?;
        // Checked here rather than in the error norm, so that the system never sees a state that is not finite.
        match dx.iter().position(|v| !v.is_finite()) {
            None => Ok(()),
            Some(state) => Err(Fault::NotFinite(state)),
        }
    }
}

/// What distinguishes one adaptive one-step method from another.
pub trait Method: Send {
    /// Name of the method, as users know it.
    const NAME: &'static str;
    /// Order of the solution that is kept.
    const ORDER: f64;
    /// Power of h in the error estimate.
    const ERROR_POWER: f64;

    /// Work space for `n` states.
    fn new(n: usize) -> Self;

    /// Takes the memory that depends on the system.
    fn reserve(&mut self, _system: &dyn System) {}

    /// Provides the derivative at the start of a step; `known` when the last step was accepted and nothing has changed
    /// since, so that its last stage may serve.
    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], known: bool) -> Result<(), Fault>;

    /// The derivative at the start, and room for another.
    fn first_derivative(&mut self) -> (&[f64], &mut [f64]);

    /// One step from `x0` to `x1` with an estimate of its error.
    fn attempt(
        &mut self,
        work: &mut Work,
        trial: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault>;

    /// What the state in between needs besides, of a step from `x0` to `x1` that is about to be kept. Returns how far off states
    /// within the step are, as a part of what is allowed there; zero where nobody knows.
    fn finish(&mut self, _work: &mut Work, _kept: Span, _x0: &[f64], _x1: &[f64]) -> Result<f64, Fault> {
        Ok(0.0)
    }

    /// The derivative at the end of the last step, where `begin` may use it; else empty.
    fn last_derivative(&self) -> &[f64] {
        &[]
    }

    /// The same, to be set.
    fn last_derivative_mut(&mut self) -> &mut [f64] {
        &mut []
    }

    /// How near the last step was to the edge of stability, where the method can tell.
    fn radius(&self, _weights: &Weights, _x0: &[f64], _x1: &[f64], _h: f64) -> Radius {
        Radius::default()
    }

    /// Radius from which on stability, and not the tolerance, limits the steps of an explicit method.
    const NEAR_EDGE: f64 = NEAR_EDGE;

    /// Whether a step that is hardly longer than the one before is better as long as that, because factors serve on.
    const KEEPS_SIZE: bool = false;

    /// Whether a stiff state may be much further off within a step than at its end, so that rows within it are worth the evaluations
    /// that it takes to [sharpen](Method::sharpen) the dense output.
    const IS_ROUGH_WITHIN: bool = false;

    /// Whether it has a stage between the ends of a step.
    const SEES_WITHIN: bool = true;

    /// What a method carries over besides the last derivative.
    fn stages(&self) -> Option<Box<Stages>> {
        None
    }

    /// Takes that over.
    fn recall(&mut self, _stages: &Stages) {}

    /// Makes what `interpolate` returns as exact as the end of the step, where the method knows how.
    ///
    /// # Errors
    /// The system fails within the step; what is interpolated is then as before.
    fn sharpen(&mut self, _work: &mut Work, _span: Span, _x0: &[f64], _x1: &[f64]) -> Result<(), Fault> {
        Ok(())
    }

    /// State at the fraction `theta` of the last step, which had the size `h`.
    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]);
}

/// h |lambda| of a step for what changes fastest, and how much of that is decay rather than oscillation.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Radius {
    pub(crate) all: f64,
    pub(crate) decay: f64,
}

/// The same of `Ode45`, whose stability ends at 3.3.
pub(crate) const NEAR_EDGE: f64 = 2.5;

/// The radius of a step from `x[0]` to `x[1]` whose last two stages, of the derivatives `k`, belong to its end: by how much f
/// differs at two states that are both near there. `stage` is the one that is not the end itself.
pub(crate) fn difference_radius(
    weights: &Weights,
    [x0, x1]: [&[f64]; 2],
    [before, end]: [&[f64]; 2],
    stage: &[f64],
    h: f64,
) -> Radius {
    let (mut above, mut below, mut against) = (0.0, 0.0, 0.0);
    for i in 0..x1.len() {
        let unit = weights.unit(i, x0[i].abs().max(x1[i].abs()));
        let (f, x) = ((end[i] - before[i]) / unit, (x1[i] - stage[i]) / unit);
        (above, below, against) = (above + f * f, below + x * x, against - f * x);
    }
    if below == 0.0 {
        return Radius::default();
    }
    Radius { all: h * (above / below).sqrt(), decay: h * against / below }
}

/// Begin, end and size of a step.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    pub(crate) t0: f64,
    pub(crate) t1: f64,
    pub(crate) h: f64,
}

impl From<Trial> for Span {
    fn from(trial: Trial) -> Self {
        Self { t0: trial.t0, t1: trial.t1, h: trial.h }
    }
}

/// Part of what is to be integrated that no first guess is below.
const LEAST_FIRST: f64 = 1e-14;

/// A one-step method with error control, in the form of a [`Stepper`].
///
/// The named methods are aliases of it, for instance [`Ode45`](crate::Ode45).
pub struct Adaptive<M> {
    method: M,
    control: StepSize,
    max: f64,
    weights: Weights,
    /// Whether the derivative at the end of the last step still holds.
    known: bool,
    last: Span,
    radius: Radius,
    x0: Vec<f64>,
    x1: Vec<f64>,
    error: Vec<f64>,
    counts: Counts,
}

impl<M: Method> Adaptive<M> {
    /// A stepper for as many states as there are absolute tolerances. All memory is taken here.
    pub fn new(tolerances: Tolerances, limits: StepLimits) -> Self {
        let n = tolerances.absolute.len();
        Self {
            method: M::new(n),
            control: StepSize::new(limits, M::ERROR_POWER, M::KEEPS_SIZE),
            max: limits.max,
            weights: Weights::new(tolerances),
            known: false,
            last: Span { t0: 0.0, t1: 0.0, h: 0.0 },
            radius: Radius::default(),
            x0: vec![0.0; n],
            x1: vec![0.0; n],
            error: vec![0.0; n],
            counts: Counts::default(),
        }
    }

    /// Goes on where a method of another kind has got to, with steps of the size that it had.
    pub(crate) fn go_on(&mut self, learnt: Option<&Learnt>, h: f64) {
        self.restart();
        self.weights.recall(learnt);
        self.control.learnt = Experience { wanted: Some(h), ..Experience::default() };
    }

    /// How near the last step was to the edge of stability.
    pub(crate) fn radius(&self) -> Radius {
        self.radius
    }

    /// What errors are measured by.
    pub(crate) fn weights(&self) -> &Weights {
        &self.weights
    }

    /// The step that the tolerance would allow next, s.
    pub(crate) fn wanted(&self) -> f64 {
        self.control.learnt.wanted.unwrap_or(0.0)
    }

    /// What has been learnt of the sizes of states.
    pub(crate) fn learnt(&self) -> Option<&Learnt> {
        self.weights.learnt()
    }

    /// Hairer's guess of the first step size, for one evaluation; never looks beyond `limit`.
    fn guess(&mut self, system: &mut dyn System, t: f64, limit: f64) {
        let max = self.max.min(limit - t);
        let (f0, f1) = self.method.first_derivative();
        let h = self.weights.first_guess(&self.x0, f0, max);
        for ((x1, x0), f0) in self.x1.iter_mut().zip(&self.x0).zip(f0) {
            *x1 = x0 + h * f0;
        }
        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
        let h = match work.derivatives(t + h, &self.x1, f1) {
            Ok(()) => {
                self.weights.sow(f0, f1, h);
                self.weights.second_guess([&self.x0, &self.x1], f0, f1, h, M::ORDER)
            }
            Err(_) => h,
        };
        self.control.set(h.max(LEAST_FIRST * max));
    }

    /// Tries ever smaller steps from (t, x0) until one is kept in x1.
    fn advance(
        &mut self,
        system: &mut dyn System,
        t: f64,
        known: bool,
        limit: f64,
    ) -> Result<Span, StepError> {
        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
        self.method.begin(&mut work, t, &self.x0, known).map_err(|fault| match fault {
            Fault::System => StepError::System,
            Fault::NotFinite(state) => StepError::NotFinite { t, state },
        })?;
        if self.control.is_unknown() {
            self.guess(system, t, limit);
        }
        loop {
            let trial = self.control.propose(t, limit);
            let mut work = Work { system: &mut *system, counts: &mut self.counts, weights: &self.weights };
            let mut attempt =
                self.method.attempt(&mut work, trial.into(), &self.x0, &mut self.x1, &mut self.error);
            let mut err = match attempt {
                Ok(()) => self.weights.norm(&self.x0, &self.x1, &self.error, trial.h),
                Err(_) => f64::INFINITY,
            };
            let is_first_move = || self.weights.is_first_move(&self.x0, &self.x1, &self.error, trial.h);
            if err > 1.0 && attempt.is_ok() && self.control.is_smallest(trial) && is_first_move() {
                err = 1.0;
            }
            if err <= 1.0 {
                match self.method.finish(&mut work, trial.into(), &self.x0, &self.x1) {
                    // A step that cannot be shorter is kept for its end.
                    Ok(within) if !self.control.is_smallest(trial) => err = err.max(within),
                    Ok(_) => {}
                    Err(fault) => (attempt, err) = (Err(fault), f64::INFINITY),
                }
            }
            if err <= 1.0 {
                self.control.accept(trial, err);
                self.weights.accepted([&self.x0, &self.x1], &self.error, err, trial.h);
                self.counts.accepted += 1;
                return Ok(trial.into());
            }
            self.counts.rejected += 1;
            match attempt {
                Ok(()) => self.counts.evaluations += self.weights.rejected(system, t, &self.x0, trial.h),
                Err(Fault::NotFinite(_)) => {
                    self.weights.stalled();
                    self.counts.evaluations += self.weights.rejected(system, t, &self.x0, trial.h);
                }
                Err(Fault::System) => {}
            }
            if !self.control.reject(trial, err) {
                let state = match attempt {
                    Err(Fault::System) => return Err(StepError::System),
                    Err(Fault::NotFinite(state)) => state,
                    Ok(()) => self.weights.worst(&self.x0, &self.x1, &self.error, trial.h),
                };
                return Err(StepError::Underflow { t, h: trial.h, state });
            }
        }
    }
}

impl<M: Method> Stepper for Adaptive<M> {
    fn reserve(&mut self, system: &dyn System) {
        self.method.reserve(system);
    }

    fn restart(&mut self) {
        self.known = false;
        self.control.restart();
    }

    fn step(
        &mut self,
        system: &mut dyn System,
        t: &mut f64,
        x: &mut [f64],
        limit: f64,
    ) -> Result<(), StepError> {
        if limit <= *t || limit.is_nan() {
            return Ok(());
        }
        self.x0.copy_from_slice(x);
        self.weights.note(*t, x);
        let mut known = std::mem::take(&mut self.known);
        if self.weights.is_unsettled() {
            let h = if self.last.h > 0.0 { self.last.h } else { limit - *t };
            self.counts.evaluations += self.weights.settle(system, *t, x, h);
            known = false;
        }
        self.last = self.advance(system, *t, known, limit)?;
        self.known = true;
        self.radius = self.method.radius(&self.weights, &self.x0, &self.x1, self.last.h);
        self.counts.limited += u64::from(self.radius.all > M::NEAR_EDGE);
        *t = self.last.t1;
        x.copy_from_slice(&self.x1);
        Ok(())
    }

    fn has_arrived(&self, state: usize) -> bool {
        self.weights.has_arrived(state)
    }

    fn interpolate(&self, t: f64, x: &mut [f64]) {
        if t == self.last.t1 {
            x.copy_from_slice(&self.x1);
        } else if t == self.last.t0 {
            x.copy_from_slice(&self.x0);
        } else {
            let theta = (t - self.last.t0) / self.last.h;
            self.method.interpolate(theta, self.last.h, &self.x0, &self.x1, x);
        }
    }

    fn sharpen(&mut self, system: &mut dyn System) {
        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
        // A failure is told where the solution gets there.
        let _unless_failed = self.method.sharpen(&mut work, self.last, &self.x0, &self.x1);
    }

    fn sees_within(&self) -> bool {
        M::SEES_WITHIN
    }

    fn sharpen_rows(&mut self, system: &mut dyn System) {
        if M::IS_ROUGH_WITHIN {
            self.sharpen(system);
        }
    }

    fn last_step(&self) -> (f64, f64) {
        (self.last.t0, self.last.t1)
    }

    fn memory(&self) -> Memory {
        let derivative = self.known.then(|| self.method.last_derivative().to_vec());
        Memory {
            derivative: derivative.filter(|known| !known.is_empty()),
            size: self.control.learnt,
            tolerances: self.weights.learnt().cloned(),
            history: None,
            turn: None,
            stages: self.method.stages().map(|stages| (stages, self.known)),
        }
    }

    fn recall(&mut self, memory: &Memory) {
        self.control.learnt = memory.size;
        self.weights.recall(memory.tolerances.as_ref());
        let known = memory.derivative.as_deref().unwrap_or_default();
        let here = self.method.last_derivative_mut();
        self.known = !known.is_empty() && known.len() == here.len();
        if self.known {
            here.copy_from_slice(known);
        }
        if let Some((stages, begun)) = &memory.stages {
            self.method.recall(stages);
            self.known = *begun;
        }
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn name(&self) -> &'static str {
        M::NAME
    }
}
