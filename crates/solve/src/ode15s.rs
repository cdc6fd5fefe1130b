//! `Ode15s`: numerical differentiation formulas of orders 1 to 5 with a variable step, implicit; for stiff systems.
//!
//! The history is kept as backward differences at equal steps; a change of the step interpolates it. Orders 1 and 2 are
//! L-stable, 3 to 5 nearly A-stable: with poles near the imaginary axis, such as weakly damped oscillations, take `Rodas4`.
//! Each step solves its equation by simplified Newton iteration. The Jacobian is kept until the iteration is slow, and its
//! factors until step or order change, so that most steps cost two evaluations and no factorisation.
//!
//! L. F. Shampine, M. W. Reichelt: The MATLAB ODE Suite, SIAM J. Sci. Comput. 18 (1997),
//! doi 10.1137/S1064827594276424: formulas and their coefficients (table 1), change of the step (section 2.2), Jacobians
//! (section 2.3). Choice of step and order: E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section V.1.

use crate::adaptive::{Fault, Span, Work};
use crate::jacobian::Age;
use crate::newton::{Equation, Iteration, Newton};
use crate::step_size::smallest;
use crate::stepper::{History, Memory};
use crate::weights::{Learnt, Weights};
use crate::{Counts, Ode45, StepError, StepLimits, Stepper, System, Tolerances};

/// Highest order.
pub(crate) const MAX: usize = 5;
/// Columns of differences: those of the highest order, and two more to judge the next order by.
const DIFFERENCES: usize = MAX + 3;

/// Parameters of the formulas: how much of the next difference is added to the backward differentiation formula.
const KAPPA: [f64; MAX] = [-0.1850, -1.0 / 9.0, -0.0823, -0.0415, 0.0];
/// Sums of 1/j.
const GAMMA: [f64; MAX + 1] = [0.0, 1.0, 1.5, 11.0 / 6.0, 25.0 / 12.0, 137.0 / 60.0];

/// Factor of the derivative in the formula of an order.
const fn alpha(order: usize) -> f64 {
    (1.0 - KAPPA[order - 1]) * GAMMA[order]
}

/// Local error in units of the difference of order k + 1.
pub(crate) const fn error_constant(order: usize) -> f64 {
    KAPPA[order - 1] * GAMMA[order] + 1.0 / (order as f64 + 1.0)
}

/// How far a step may be stretched to meet a limit.
const STRETCH: f64 = 1.01;
/// Steps from a beginning within which a higher order is found that follows what leaves zero as a power of time.
const YOUNG: usize = 64;
/// Growth that is worth a factorisation.
const WORTH: f64 = 1.1;
/// The largest growth.
const GROW: f64 = 10.0;

/// Orders 1 to 5 for stiff systems.
pub struct Ode15s {
    weights: Weights,
    limits: StepLimits,
    /// Finds the difference of order k + 1 of this step.
    newton: Newton,
    /// Bound of the eigenvalues of J, 1/s.
    radius: f64,
    /// Backward differences, column after column.
    differences: Vec<f64>,
    /// Whether they are those of a solution.
    begun: bool,
    order: usize,
    /// The step that the differences belong to, s.
    h: f64,
    /// Step and order to go on with.
    next: (f64, usize),
    /// Steps since either has changed.
    steady: usize,
    /// States that had been zero until it began last, and steps since.
    fresh: Vec<bool>,
    age: usize,
    last: Span,
    /// What the last step began with: differences, their step, order, what was to come next, steps since either changed.
    before: (Vec<f64>, f64, usize, (f64, usize), usize),
    x0: Vec<f64>,
    x1: Vec<f64>,
    predicted: Vec<f64>,
    known: Vec<f64>,
    counts: Counts,
}

impl Ode15s {
    /// A stepper for as many states as there are absolute tolerances. All memory is taken here, but for that of a sparse
    /// Jacobian, which is taken when it is seen first.
    pub fn new(tolerances: Tolerances, limits: StepLimits) -> Self {
        let n = tolerances.absolute.len();
        let zeros = || vec![0.0; n];
        Self {
            weights: Weights::new(tolerances),
            limits,
            newton: Newton::new(n),
            radius: f64::INFINITY,
            differences: vec![0.0; n * DIFFERENCES],
            begun: false,
            order: 1,
            h: 0.0,
            next: (0.0, 1),
            steady: 0,
            fresh: vec![false; n],
            age: 0,
            last: Span { t0: 0.0, t1: 0.0, h: 0.0 },
            before: (vec![0.0; n * DIFFERENCES], 0.0, 1, (0.0, 1), 0),
            x0: zeros(),
            x1: zeros(),
            predicted: zeros(),
            known: zeros(),
            counts: Counts::default(),
        }
    }

    /// Goes on where the explicit method has got to.
    pub(crate) fn follow(&mut self, explicit: &Ode45) {
        self.begun = false;
        self.weights.recall(explicit.learnt());
        self.newton.forget();
        (self.h, self.radius) = (0.0, f64::INFINITY);
    }

    /// What has been learnt of the sizes of states.
    pub(crate) fn learnt(&self) -> Option<&Learnt> {
        self.weights.learnt()
    }

    /// A bound of the eigenvalues of the Jacobian, 1/s.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// Begins at order 1 with a step whose error, half of h^2 x'', is a part of what it may be; x'' by one difference.
    fn begin(&mut self, system: &mut dyn System, t: f64, limit: f64) -> Result<(), StepError> {
        let Self { weights, x0, x1, newton: Newton { f, step, correction, .. }, .. } = self;
        let mut work = Work { system, counts: &mut self.counts, weights };
        work.derivatives(t, x0, f).map_err(|fault| match fault {
            Fault::System => StepError::System,
            Fault::NotFinite(state) => StepError::NotFinite { t, state },
        })?;
        let max = self.limits.max.min(limit - t);
        let h = match self.limits.first {
            _ if x0.is_empty() => max,
            Some(first) if self.h == 0.0 => first.min(max),
            _ => {
                let mut h = weights.first_guess(x0, f, max);
                for ((x1, x0), f) in x1.iter_mut().zip(&*x0).zip(&*f) {
                    *x1 = x0 + h * f;
                }
                let mut work = Work { system: &mut *work.system, counts: work.counts, weights };
                if work.derivatives(t + h, x1, step).is_ok() {
                    for ((c, f1), f0) in correction.iter_mut().zip(&*step).zip(&*f) {
                        *c = 0.5 * (f1 - f0) / h;
                    }
                    weights.sow(f, step, h);
                    // What does not move at first has the size that it moves by next.
                    for ((x1, x0), f1) in x1.iter_mut().zip(&*x0).zip(&*step) {
                        if (h * f1).abs() > x1.abs() {
                            *x1 = x0 + h * f1;
                        }
                    }
                    let curvature = weights.norm(x0, x1, correction, h);
                    h = if curvature > 0.0 { (0.5 / curvature).sqrt() } else { 100.0 * h };
                }
                h.max(1e-14 * max).min(max)
            }
        };
        let h = h.max(smallest(t, self.limits.min));
        let n = x0.len();
        self.differences[..n].copy_from_slice(x0);
        for (d, f) in self.differences[n..2 * n].iter_mut().zip(&*f) {
            *d = h * f;
        }
        (self.h, self.order, self.next, self.steady, self.begun) = (h, 1, (h, 1), 0, true);
        self.age = 0;
        for (i, fresh) in self.fresh.iter_mut().enumerate() {
            *fresh = self.weights.never_moved(i);
        }
        Ok(())
    }

    /// End and size of the step from `t`, and whether it is shorter than wanted.
    fn plan(&self, t: f64, limit: f64, wanted: f64) -> (Span, bool) {
        let h = wanted.max(smallest(t, self.limits.min)).min(self.limits.max);
        let remaining = limit - t;
        // A step at its maximum forgives rounding of the limits only.
        let stretch = if h < self.limits.max { STRETCH } else { 1.0 + 1e-9 };
        if remaining <= h * stretch {
            (Span { t0: t, t1: limit, h: remaining }, remaining < h)
        } else if remaining < 2.0 * h {
            (Span { t0: t, t1: t + 0.5 * remaining, h: 0.5 * remaining }, true)
        } else {
            (Span { t0: t, t1: t + h, h }, false)
        }
    }

    /// Makes the differences those of another step.
    fn rescale(&mut self, h: f64) {
        if h == self.h {
            return;
        }
        let (n, k) = (self.x0.len(), self.order);
        let matrix = change(k, h / self.h);
        for i in 0..n {
            let mut old = [0.0; MAX];
            for (j, old) in old.iter_mut().enumerate().take(k) {
                *old = self.differences[(j + 1) * n + i];
            }
            for j in 0..k {
                let sum = old.iter().zip(&matrix).take(k).map(|(old, row)| old * row[j]).sum();
                self.differences[(j + 1) * n + i] = sum;
            }
        }
        self.h = h;
        self.steady = 0;
    }

    /// The formula's equation for the end of the step: what is known of it, and the predicted state.
    fn predict(&mut self) {
        let (n, k) = (self.x0.len(), self.order);
        self.predicted.copy_from_slice(&self.differences[..n]);
        self.known.fill(0.0);
        for (column, gamma) in self.differences.chunks_exact(n.max(1)).zip(GAMMA).take(k + 1).skip(1) {
            let weight = gamma / alpha(k);
            for ((predicted, known), d) in self.predicted.iter_mut().zip(&mut self.known).zip(column) {
                *predicted += d;
                *known += weight * d;
            }
        }
    }

    /// Evaluates the Jacobian at the start of the step.
    fn differentiate(&mut self, system: &mut dyn System, span: Span) -> Result<(), StepError> {
        let t = span.t0;
        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
        self.newton.differentiate(&mut work, t, &self.x0, span.h).map_err(|fault| match fault {
            Fault::System => StepError::System,
            Fault::NotFinite(state) => StepError::NotFinite { t, state },
        })?;
        self.radius = self.newton.jacobian.radius(&self.weights, &self.x0);
        Ok(())
    }

    /// Tries ever smaller steps from (t, x0) until one is kept in x1.
    fn advance(&mut self, system: &mut dyn System, t: f64, limit: f64) -> Result<(), StepError> {
        let (mut wanted, order) = self.next;
        if order != self.order {
            (self.order, self.steady) = (order, 0);
        }
        // The first failure of the error test may be met by the order, more of them speak of a history that is none.
        let mut failures = 0;
        let n = self.x0.len();
        self.newton.begin();
        loop {
            let (span, cut) = self.plan(t, limit, wanted);
            self.rescale(span.h);
            let fault = match self.attempt(system, span)? {
                Iteration::Converged => None,
                Iteration::Slow if self.newton.slopes != Age::Current => {
                    self.differentiate(system, span)?;
                    continue;
                }
                Iteration::Slow => Some(None),
                Iteration::Failed(fault) => Some(Some(fault)),
            };
            let constant = error_constant(self.order);
            if fault.is_none() {
                let Self { newton: Newton { step, correction, .. }, x0, x1, weights, .. } = self;
                correction.iter_mut().zip(&*step).for_each(|(e, d)| *e = constant * d);
                let err = weights.norm(x0, x1, correction, span.h);
                let is_smallest = span.h <= smallest(t, self.limits.min);
                let (fresh, is_young) = (&self.fresh, self.age < YOUNG);
                let is_first = || {
                    weights.is_first_move(x0, x1, correction, span.h)
                        || is_young && weights.is_departure(fresh, [x0, x1], correction, span.h)
                };
                if err <= 1.0 || is_smallest && is_first() {
                    self.keep(span, err.min(1.0), cut.then_some(wanted));
                    return Ok(());
                }
                failures += 1;
                self.counts.rejected += 1;
                if is_smallest {
                    let state = self.weights.worst(&self.x0, &self.x1, &self.newton.correction, span.h);
                    return Err(StepError::Underflow { t, h: span.h, state });
                }
                if !err.is_finite() {
                    wanted = span.h * 0.2;
                } else if failures == 1 {
                    wanted = span.h * (0.833 * err.powf(-1.0 / (self.order as f64 + 1.0))).max(0.1);
                    if self.order > 1 {
                        let k = self.order;
                        let lower = self.judge(k - 1, true, span.h);
                        let other = span.h * (0.769 * lower.powf(-1.0 / k as f64)).max(0.1);
                        if other > wanted {
                            self.order = k - 1;
                            wanted = other.min(span.h);
                        }
                    }
                } else {
                    wanted = 0.5 * span.h;
                    if failures > 3 && self.order > 1 {
                        // What lies behind does not continue: its first difference is all that is worth keeping.
                        self.order = 1;
                        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
                        if work.derivatives(t, &self.x0, &mut self.newton.f).is_ok() {
                            let column = &mut self.differences[n..2 * n];
                            column.iter_mut().zip(&self.newton.f).for_each(|(d, f)| *d = self.h * f);
                        }
                    }
                }
                let spent = self.weights.rejected(system, t, &self.x0, span.h);
                self.counts.evaluations += spent;
                if spent > 0 {
                    self.newton.slopes = Age::Old;
                }
            } else {
                self.counts.rejected += 1;
                if span.h <= smallest(t, self.limits.min) {
                    return Err(match fault.flatten() {
                        Some(Fault::System) => StepError::System,
                        Some(Fault::NotFinite(state)) => StepError::Underflow { t, h: span.h, state },
                        None => {
                            let state =
                                self.weights.worst(&self.x0, &self.x1, &self.newton.correction, span.h);
                            StepError::Underflow { t, h: span.h, state }
                        }
                    });
                }
                // Noise may be what keeps an iteration from converging.
                if fault.is_some_and(|fault| fault.is_none()) {
                    self.weights.stalled();
                    self.counts.evaluations += self.weights.rejected(system, t, &self.x0, span.h);
                }
                wanted = 0.3 * span.h;
            }
        }
    }

    /// Factors where that is due, and iterates.
    fn attempt(&mut self, system: &mut dyn System, span: Span) -> Result<Iteration, StepError> {
        if self.newton.slopes == Age::Unknown {
            self.differentiate(system, span)?;
        }
        let g = span.h / alpha(self.order);
        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
        if let Err(fault) = self.newton.factor(&mut work, g) {
            return Ok(Iteration::Failed(fault));
        }
        self.predict();
        let (h, t) = (span.h, span.t1);
        let equation = Equation { t, g, predicted: &self.predicted, known: &self.known, x0: &self.x0, h };
        let mut work = Work { system, counts: &mut self.counts, weights: &self.weights };
        Ok(self.newton.iterate(&mut work, &equation, &mut self.x1))
    }

    /// Error of a step of the size `h` by a formula of another order, from the difference of order `order + 1`: that of
    /// the history with what the present step adds to it if `renewed`.
    fn judge(&mut self, order: usize, renewed: bool, h: f64) -> f64 {
        let n = self.x0.len();
        let column = &self.differences[(order + 1) * n..(order + 2) * n];
        let constant = error_constant(order);
        for ((error, d), step) in self.newton.correction.iter_mut().zip(column).zip(&self.newton.step) {
            *error = constant * if renewed { d + step } else { *d };
        }
        self.weights.norm(&self.x0, &self.x1, &self.newton.correction, h)
    }

    /// Takes the step over into the history and chooses what comes next. `cut` is what it would have been without a limit.
    fn keep(&mut self, span: Span, err: f64, cut: Option<f64>) {
        let (n, k) = (self.x0.len(), self.order);
        self.counts.accepted += 1;
        self.weights.accepted([&self.x0, &self.x1], &self.newton.correction, err, span.h);
        self.steady += 1;
        self.age += 1;
        for i in 0..n {
            let step = self.newton.step[i];
            self.differences[(k + 2) * n + i] = step - self.differences[(k + 1) * n + i];
            self.differences[(k + 1) * n + i] = step;
        }
        for j in (0..=k).rev() {
            for i in 0..n {
                self.differences[j * n + i] += self.differences[(j + 1) * n + i];
            }
        }
        // The state is what the iteration found, to the last bit.
        self.differences[..n].copy_from_slice(&self.x1);
        self.last = span;
        self.next = (span.h, k);
        // A step that cannot grow needs no other order.
        if self.steady >= k + 2 && span.h < self.limits.max * (1.0 - 1e-9) {
            let growth = |err: f64, safety: f64, order: usize| {
                (safety * err.powf(1.0 / (order as f64 + 1.0))).recip().min(GROW)
            };
            let mut best = (growth(err, 1.2, k), k);
            if k > 1 {
                let lower = growth(self.judge(k - 1, false, span.h), 1.3, k - 1);
                if lower > best.0 {
                    best = (lower, k - 1);
                }
            }
            if k < MAX {
                let higher = growth(self.judge(k + 1, false, span.h), 1.4, k + 1);
                if higher > best.0 {
                    best = (higher, k + 1);
                }
            }
            if best.0 > WORTH {
                self.next = (span.h * best.0, best.1);
            }
        }
        // Back to the size before the limit, as far as the history reaches.
        if let Some(wanted) = cut.filter(|wanted| *wanted <= 2.5 * span.h) {
            self.next.0 = self.next.0.max(wanted);
        }
    }
}

/// How the differences of a history of order `k` change with the step by a factor: column by column, entry l of column j
/// tells how much of the old difference l + 1 is in the new difference j + 1.
fn change(k: usize, factor: f64) -> [[f64; MAX]; MAX] {
    // R(factor) holds binomial coefficients of multiples of the factor, U = R(1).
    let products = |factor: f64| {
        let mut r = [[0.0; MAX]; MAX];
        for j in 0..k {
            let mut product = 1.0;
            for (i, row) in r.iter_mut().enumerate().take(k) {
                let m = (i + 1) as f64;
                product *= (m - 1.0 - (j + 1) as f64 * factor) / m;
                row[j] = product;
            }
        }
        r
    };
    let (r, u) = (products(factor), products(1.0));
    let mut matrix = [[0.0; MAX]; MAX];
    for i in 0..k {
        for j in 0..k {
            for l in 0..k {
                matrix[i][j] += r[i][l] * u[l][j];
            }
        }
    }
    matrix
}

impl Stepper for Ode15s {
    fn sees_within(&self) -> bool {
        false
    }

    fn reserve(&mut self, system: &dyn System) {
        self.newton.jacobian.reserve(system);
    }

    fn restart(&mut self) {
        self.begun = false;
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
        if self.weights.is_unsettled() {
            let h = if self.last.h > 0.0 { self.last.h } else { limit - *t };
            self.counts.evaluations += self.weights.settle(system, *t, x, h);
        }
        if !self.begun || self.last.t1 != *t || self.differences[..x.len()] != *x {
            self.begun = false;
            self.newton.distrust();
            self.begin(system, *t, limit)?;
        }
        self.before.0.copy_from_slice(&self.differences);
        (self.before.1, self.before.2, self.before.3, self.before.4) =
            (self.h, self.order, self.next, self.steady);
        // A step that fails leaves a history that is rescaled for steps of no use.
        self.begun = false;
        self.advance(system, *t, limit)?;
        self.begun = true;
        *t = self.last.t1;
        x.copy_from_slice(&self.x1);
        Ok(())
    }

    /// The history is that before the step.
    fn back(&mut self) {
        self.differences.copy_from_slice(&self.before.0);
        (self.h, self.order, self.next, self.steady) =
            (self.before.1, self.before.2, self.before.3, self.before.4);
        (self.begun, self.last.t1) = (true, self.last.t0);
        self.age = self.age.saturating_sub(1);
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
            let (n, s) = (x.len(), (t - self.last.t1) / self.last.h);
            x.copy_from_slice(&self.x1);
            let mut weight = 1.0;
            for j in 1..=self.order {
                weight *= (s + (j - 1) as f64) / j as f64;
                let column = &self.differences[j * n..(j + 1) * n];
                x.iter_mut().zip(column).for_each(|(x, d)| *x += weight * d);
            }
        }
    }

    fn last_step(&self) -> (f64, f64) {
        (self.last.t0, self.last.t1)
    }

    fn memory(&self) -> Memory {
        let history = History {
            begun: self.begun,
            differences: self.differences.clone(),
            t: self.last.t1,
            h: self.h,
            order: self.order,
            next: self.next,
            steady: self.steady,
            fresh: self.fresh.clone(),
            age: self.age,
            newton: self.newton.memory(),
            radius: self.radius,
        };
        Memory {
            tolerances: self.weights.learnt().cloned(),
            history: Some(Box::new(history)),
            ..Memory::default()
        }
    }

    fn recall(&mut self, memory: &Memory) {
        self.weights.recall(memory.tolerances.as_ref());
        let Some(history) = &memory.history else { return };
        self.begun = history.begun;
        self.differences.clone_from(&history.differences);
        self.last.t1 = history.t;
        (self.h, self.order, self.next) = (history.h, history.order, history.next);
        (self.steady, self.radius) = (history.steady, history.radius);
        self.fresh.clone_from(&history.fresh);
        self.age = history.age;
        self.newton.recall(&history.newton);
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn name(&self) -> &'static str {
        "Ode15s"
    }
}
