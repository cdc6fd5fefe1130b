//! What integrates: one accepted step at a time, so that the caller owns time, events and recording.

use crate::System;
use crate::auto::Turn;
use crate::newton::Convergence;
use crate::past::Past;
use crate::weights::Learnt;

/// A method of integration with its memory of the last step. No call allocates.
pub trait Stepper: Send {
    /// Takes the memory that depends on the system, so that steps need none but for a sparse Jacobian that is seen first. Steps do
    /// so themselves where nobody has.
    fn reserve(&mut self, _system: &dyn System) {}

    /// Forgets the derivative and the error of the past; to be called after a discontinuity of f or a change of x.
    /// The size of the last good step stays as the first guess, so a restart costs one evaluation at most.
    fn restart(&mut self);

    /// One accepted step from (`*t`, `x`), never beyond `limit`, landing on it bitwise when it gets there.
    /// No trial looks beyond `limit` either. Does nothing when `limit <= *t`.
    ///
    /// `x` has as many states as the stepper was made for.
    ///
    /// # Errors
    /// See [`StepError`]. `t` and `x` are then as they were.
    fn step(
        &mut self,
        system: &mut dyn System,
        t: &mut f64,
        x: &mut [f64],
        limit: f64,
    ) -> Result<(), StepError>;

    /// State at time `t` within the last accepted step, continuous and exact at both its ends. Valid until the next
    /// call of [`step`](Stepper::step).
    fn interpolate(&self, t: f64, x: &mut [f64]);

    /// Makes the dense output of the last step as exact as its end, for a few evaluations, where the method knows how; states
    /// that a step is cut at are taken from there. Where the system fails it stays as it is.
    fn sharpen(&mut self, _system: &mut dyn System) {}

    /// The same where the states are only looked at: does nothing where the dense output is about as exact as the end of the step
    /// anyway.
    fn sharpen_rows(&mut self, _system: &mut dyn System) {}

    /// Whether steps evaluate the system between their ends, so that their error shows what happens there.
    fn sees_within(&self) -> bool {
        true
    }

    /// Forgets the last step, which is to be made once more from the same start, but shorter.
    fn back(&mut self) {
        self.restart();
    }

    /// The longest way to a limit that is one step for sure, s, of a method that lets a system [make steps by
    /// itself](System::step); nothing of others.
    fn single(&self) -> Option<f64> {
        None
    }

    /// Takes down steps that the system has made by itself, none longer than [`single`](Stepper::single); the last one went from
    /// `t` to `t1`.
    fn made(&mut self, _steps: u64, _t: f64, _t1: f64) {}

    /// Whether an automatic tolerance follows a state although it is far smaller than all others: it has come to a size of its own
    /// that is more than rounding.
    fn has_arrived(&self, _state: usize) -> bool {
        false
    }

    /// Begin and end of the last accepted step, s.
    fn last_step(&self) -> (f64, f64);

    /// What the next step depends on besides time and states; nothing of a method with a fixed step.
    fn memory(&self) -> Memory {
        Memory::default()
    }

    /// Takes over the memory of another stepper of this method, dimension and tolerances. The next step from the same time
    /// and states is then the one that the other makes, bit by bit; the dense output and the counts stay as they are.
    fn recall(&mut self, _memory: &Memory) {}

    /// Work done since construction.
    fn counts(&self) -> Counts;

    /// What a method that is two has used of each; nothing of others.
    fn share(&self) -> Option<Share> {
        None
    }

    /// Name of the method, as users know it.
    fn name(&self) -> &'static str;
}

/// Steps from (`t`, `x`) until `end`.
///
/// # Errors
/// Those of the first step that fails; `t` and `x` are then where it began.
pub fn integrate(
    stepper: &mut dyn Stepper,
    system: &mut dyn System,
    t: &mut f64,
    x: &mut [f64],
    end: f64,
) -> Result<(), StepError> {
    while *t < end {
        stepper.step(system, t, x, end)?;
    }
    Ok(())
}

/// What a stepper carries from one step to the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    /// The derivative at the end of the last step, if the method uses it and it still holds.
    pub(crate) derivative: Option<Vec<f64>>,
    /// What the controller of the step size knows.
    pub(crate) size: Experience,
    /// What automatic tolerances have learnt.
    pub(crate) tolerances: Option<Learnt>,
    /// What a method of many steps knows of those before.
    pub(crate) history: Option<Box<History>>,
    /// Which method of two is at work, whether the other one goes on, what each has done, and the last states.
    pub(crate) turn: Option<Box<(Turn, bool, Share, Past)>>,
    /// Stages of a method that begins with those of the step before, and whether they still hold.
    pub(crate) stages: Option<(Box<Stages>, bool)>,
}

/// What an implicit method of one step carries to the next one.
#[derive(Debug, Clone, PartialEq)]
pub struct Stages {
    pub(crate) newton: Convergence,
    /// Whether the last iteration was so quick that its Jacobian may serve on.
    pub(crate) quick: bool,
    /// Size of the step that can be continued, s.
    pub(crate) tried: Option<f64>,
    /// States, slopes or stages of it.
    pub(crate) columns: Vec<Vec<f64>>,
}

/// How much of its work a method that is two has left to the stiff one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// Steps of the stiff method.
    pub stiff: u64,
    /// Changes from one to the other.
    pub changes: u64,
    /// When the stiff method came first, s.
    pub first: Option<f64>,
}

/// What a method of many steps knows of those before.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct History {
    pub begun: bool,
    /// Backward differences, column after column.
    pub differences: Vec<f64>,
    /// Time to which they belong, and step, s.
    pub t: f64,
    pub h: f64,
    pub order: usize,
    /// Step and order to go on with.
    pub next: (f64, usize),
    pub steady: usize,
    /// States that had been zero until it began last, and steps since.
    pub fresh: Vec<bool>,
    pub age: usize,
    pub newton: Convergence,
    /// Bound of the eigenvalues of J, 1/s.
    pub radius: f64,
}

/// What the controller of the step size has learnt.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Experience {
    /// What the next step would like to be, s; unknown before the first.
    pub wanted: Option<f64>,
    /// Logarithm of the error of the last step, if that belongs to the same smooth piece of the solution.
    pub logarithm_before: Option<f64>,
    /// Whether the last trial was thrown away.
    pub rejected: bool,
}

/// Work done by a stepper.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Calls of [`System::derivatives`], those for Jacobians included.
    pub evaluations: u64,
    /// Steps that were kept.
    pub accepted: u64,
    /// Trial steps that were thrown away.
    pub rejected: u64,
    /// Jacobians by finite differences.
    pub jacobians: u64,
    /// Factorisations of I - hg J, by the stepper or by [`System::prepare`].
    pub factorisations: u64,
    /// Steps of `Ode45` that were as long as its stability allows, whatever the tolerance.
    pub limited: u64,
}

/// Bounds of the step size of an adaptive method, in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepLimits {
    /// A trial step rejected at this size ends the integration. Never below 16 units in the last place of t.
    pub min: f64,
    /// No step is longer.
    pub max: f64,
    /// Size of the very first step; without it, it is estimated with one evaluation.
    pub first: Option<f64>,
}

impl Default for StepLimits {
    fn default() -> Self {
        Self { min: 0.0, max: f64::INFINITY, first: None }
    }
}

/// Why a step could not be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepError {
    /// [`System::derivatives`] or [`System::prepare`] failed at the start of the step or however near to it.
    System,
    /// The tolerances cannot be met: the solution has a pole or a jump, or the derivative is not finite ahead.
    Underflow {
        /// Time of the last accepted state, s.
        t: f64,
        /// Size of the step that was rejected, s.
        h: f64,
        /// The state with the maximum error, or the first one whose derivative is not finite.
        state: usize,
    },
    /// The derivative is not finite at the state to start from, so no smaller step can help.
    NotFinite {
        /// Time of that state, s.
        t: f64,
        /// The first state whose derivative is not finite.
        state: usize,
    },
}

impl std::fmt::Display for StepError {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::System => out.write_str("the system could not be evaluated"),
            Self::Underflow { t, h, state } => {
                write!(out, "at t = {t} s even a step of {h:e} s is too long for state {state}")
            }
            Self::NotFinite { t, state } => {
                write!(out, "at t = {t} s the derivative of state {state} is not finite")
            }
        }
    }
}

impl std::error::Error for StepError {}
