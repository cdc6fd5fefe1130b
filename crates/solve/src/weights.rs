//! What an error is measured by: the weights of the states, given or found while the solution goes on.
//!
//! An error e of a state that goes from x0 to x1 counts as e / (relative max(|x0|, |x1|) + absolute). An automatic absolute
//! tolerance follows the size that a state has had so far, so that neither units nor sizes have to be told: it is
//! [`SHARE`] of the relative one at the largest magnitude of late. A state that has just left zero is thus followed
//! from its first move on. Where a nominal value is known, it counts as one that the state has had; but a state that stays far below
//! keeps its digits: the tolerance is never above the relative one at its own largest.
//!
//! Of late means in about the last half of the run ([`Learnt::note`]). What reacts or settles over many decades of time, such as
//! Robertson's reaction, has states that fall a millionfold and take wrong ways when a tolerance of their beginnings lets them pass
//! zero. A size fades to [`FADED`] of the largest ever, no further: what has come to rest is not to be followed for ever.
//!
//! Two things keep small states from costing steps without end:
//!
//! * A state far smaller than all others ([`DWARF`]) counts as nothing until it has arrived ([`ARRIVED`]). What diffuses through a
//!   thousand cells arrives at the last ones as t^1000, of which no method knows a single digit. One that has arrived and is more than
//!   rounding is of another unit, and followed as any other ([`Weights::settle`]).
//! * A state that is zero but for rounding cannot be exact to six digits. Where steps are thrown away again and again,
//!   f is evaluated at five points within a 200th of the step, where states differ by their last bits. Of what is smooth
//!   the fourth difference vanishes there; what it is not is noise, unless it is a kink, of which a second look at closer points sees
//!   less. What noise does to a state over a step is no error.
//!   It never hides more than a share of the largest state, and it fades with its state.

use crate::shake::shake;
use crate::system::NOTHING;
use crate::{System, Tolerances};

/// Part of the largest magnitude of a state, of late, below which it counts as nothing.
const SHARE: f64 = 1e-3;
/// Part of the largest magnitude that a state ever had to which its size fades.
const FADED: f64 = 1e-4;
/// Factor of the time since the beginning from one forgetting to the next.
const LATE: f64 = 2.0;
/// Part of its size that a state must stay below to be smaller: what fluctuates keeps its size.
const FALLEN: f64 = 0.1;
/// The same part of the largest magnitude of any state.
const DWARF: f64 = 1e-12;
/// Logarithm of the growth while the time since a state left zero doubles from which on it is still arriving: that of the third power.
const ARRIVED: f64 = 2.0794;
/// Factor by which that logarithm may become larger from one doubling to the next, of what has arrived. Of what left zero
/// long before it was first seen, because it was too small for a number, it doubles as that of an exponential function.
const EVEN: f64 = 1.2;
/// Part of its size that rounding may do to a state over a step when it counts as arrived.
const SOLID: f64 = 1e-3;
/// Factor of that time until one that is rounding is looked at again, halved.
const AGAIN: f64 = 4.0;
/// Part of the largest magnitude of any state that one of unknown size is taken for.
const UNKNOWN: f64 = 1e-5;
/// A magnitude where nothing is known.
const LEAST: f64 = 1e-10;
/// Part of the largest magnitude of any state that one may have in its first steps of the least size.
const DEPARTING: f64 = 1e-3;
/// How far rounding may add up within a step, as a multiple of what was seen of it.
const PILE: f64 = 8.0;
/// Rejections, less a part of the steps that were kept since, that look like noise.
const SUSPICION: f64 = 3.0;
/// What a step that was kept takes away from the suspicion.
const TRUST: f64 = 0.2;
/// Error from which on it limits the steps, and the part of the largest magnitude of any state up to which one that does so may be rounding.
const LIMITS: f64 = 0.1;
const SPECK: f64 = 1e-9;
/// Distance of the points at which noise is looked for, as a part of the step.
const APART: f64 = 1.0 / 1024.0;
/// How much closer they are where something was seen: rounding stays as it is, a kink does not.
const CLOSER: f64 = 1.0 / 32.0;
/// How much less of a kink is seen there, at least.
const KINK: f64 = 8.0;
/// Share of its tolerance that noise may cost a state without further looks.
const HARMLESS: f64 = 1e-3;
/// Weights of a fourth difference whose root sum square is one: what it makes of noise is as large as the noise.
const FOURTH: [f64; 5] = {
    let norm = 8.366_600_265_340_756;
    [1.0 / norm, -4.0 / norm, 6.0 / norm, -4.0 / norm, 1.0 / norm]
};
/// Steps that are kept until noise is looked for again.
const PATIENCE: f64 = 50.0;

/// The least automatic absolute tolerance at a relative one: states of a run in which `largest` is the largest magnitude of any
/// state count as nothing below it, unless they have [arrived](crate::Stepper::has_arrived).
pub fn least_absolute(relative: f64, largest: f64) -> f64 {
    relative * NOTHING.max(DWARF * largest)
}

/// Weights of the states of one stepper.
pub struct Weights {
    relative: f64,
    /// What was given: the tolerance itself, or the least automatic one.
    given: Vec<f64>,
    /// Which of them stay.
    fixed: Vec<bool>,
    /// Nominal magnitudes of the states; 0 where none is known.
    nominal: Vec<f64>,
    /// States that share a size.
    kin: Vec<Vec<usize>>,
    /// The absolute tolerances in force.
    absolute: Vec<f64>,
    /// What an automatic tolerance has learnt.
    learnt: Option<Learnt>,
    /// A point, its derivative, and the differences of two looks at the noise.
    look: Option<Box<[Vec<f64>; 4]>>,
}

/// What automatic tolerances carry from one step to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    /// Largest magnitude of each state of late.
    pub size: Vec<f64>,
    /// Largest magnitude of each state so far.
    pub ever: Vec<f64>,
    /// Largest of these.
    pub largest: f64,
    /// Time of the first state.
    pub start: Option<f64>,
    /// Time after `start` of the last forgetting.
    pub forgot: f64,
    /// Largest magnitudes since then.
    pub recent: Vec<f64>,
    /// What a first guess of a step moves where all begins at rest and zero: a size until there is a larger one.
    pub seed: f64,
    /// Variation of each derivative by rounding.
    pub noise: Vec<f64>,
    /// Whether any is known.
    pub noisy: bool,
    /// Rejections that have not been explained.
    pub suspicion: f64,
    /// Iterations that did not converge, less a part of the steps that were kept since.
    pub stalled: f64,
    /// Time of the state that was taken last.
    pub last: f64,
    /// How states far smaller than all others arrive.
    pub arrivals: Vec<Arrival>,
    /// Whether there are states whose tolerance follows the largest of all, and whether one of them may have arrived.
    pub any_dwarf: bool,
    pub any_candidate: bool,
}

/// How a state far smaller than all others arrives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Arrival {
    /// It has been zero so far, or was never far smaller than others.
    #[default]
    Unseen,
    /// It left zero at the time `since`, and was at most as large as `size` until the time `mark` after that, by e^`growth` larger
    /// than until half of it.
    Growing { since: f64, mark: f64, size: f64, growth: f64 },
    /// It has hardly grown while that time doubled.
    Candidate { since: f64, mark: f64 },
    /// It is more than rounding.
    Arrived,
}

impl Learnt {
    /// Takes the sizes of a state that is a solution at the time `t`, and forgets those that are long ago. Returns whether sizes
    /// have changed.
    fn note(&mut self, t: f64, x: &[f64]) -> bool {
        let is_first = self.start.is_none();
        let elapsed = t - *self.start.get_or_insert(t);
        let forget = elapsed > LATE * self.forgot;
        if forget {
            self.forget(elapsed);
        }
        if self.any_dwarf {
            self.watch(t, x);
        }
        self.last = t;
        let mut grown = false;
        for (i, x) in x.iter().enumerate() {
            let x = x.abs();
            self.recent[i] = self.recent[i].max(x);
            if x > self.size[i] {
                self.size[i] = x;
                self.ever[i] = self.ever[i].max(x);
                self.largest = self.largest.max(x);
                grown = true;
            }
        }
        if is_first {
            // What is small from the beginning need not grow first.
            let small = DWARF / SHARE * self.largest;
            for (arrival, ever) in self.arrivals.iter_mut().zip(&self.ever) {
                if *ever > 0.0 && *ever <= small {
                    *arrival = Arrival::Candidate { since: t, mark: 0.0 };
                    self.any_candidate = true;
                }
            }
        }
        grown || forget
    }

    /// Looks how states whose tolerance follows the largest of all have grown until the time `t`.
    fn watch(&mut self, t: f64, x: &[f64]) {
        let small = DWARF / SHARE * self.largest;
        for ((arrival, ever), x) in self.arrivals.iter_mut().zip(&self.ever).zip(x) {
            let size = ever.max(x.abs());
            if size == 0.0 || size > small {
                continue;
            }
            match *arrival {
                Arrival::Unseen => {
                    let mark = (t - self.last).max(0.0);
                    *arrival = Arrival::Growing { since: t - mark, mark, size, growth: f64::INFINITY };
                }
                Arrival::Growing { since, mark, size: before, growth } => {
                    let elapsed = t - since;
                    if elapsed <= 0.0 || elapsed < 2.0 * mark {
                        continue;
                    }
                    let now = (size / before).ln();
                    let is_slow = mark > 0.0 && now < ARRIVED && now <= EVEN * growth + EVEN - 1.0;
                    *arrival = Arrival::Growing { since, mark: elapsed, size, growth: now };
                    if is_slow && growth < ARRIVED {
                        self.any_candidate = true;
                        *arrival = Arrival::Candidate { since, mark: elapsed };
                    }
                }
                Arrival::Candidate { .. } | Arrival::Arrived => {}
            }
        }
    }

    /// Keeps what was seen since it forgot before. Every time is twice the one before, so that late means at least the last half
    /// of the time and at most all but a quarter.
    fn forget(&mut self, elapsed: f64) {
        self.forgot = elapsed;
        for (i, recent) in self.recent.iter_mut().enumerate() {
            // What may be nothing but rounding is not worth following when there is less of it.
            let rounding = PILE * elapsed * self.noise[i];
            if *recent < FALLEN * self.size[i] && self.size[i] > rounding {
                self.noise[i] *= *recent / self.size[i];
                self.size[i] = *recent;
            }
            *recent = 0.0;
        }
    }
}

impl Weights {
    pub fn new(tolerances: Tolerances) -> Self {
        let Tolerances { relative, absolute, automatic, fixed, nominal, kin } = tolerances;
        let n = absolute.len();
        let zeros = || vec![0.0; n];
        Self {
            relative,
            given: absolute.clone(),
            fixed,
            nominal,
            kin,
            absolute,
            learnt: automatic.then(|| Learnt {
                size: zeros(),
                ever: zeros(),
                largest: 0.0,
                start: None,
                forgot: 0.0,
                recent: zeros(),
                seed: 0.0,
                noise: zeros(),
                noisy: false,
                suspicion: 0.0,
                stalled: 0.0,
                last: 0.0,
                arrivals: vec![Arrival::default(); n],
                any_dwarf: false,
                any_candidate: false,
            }),
            look: automatic.then(|| Box::new([zeros(), zeros(), zeros(), zeros()])),
        }
    }

    pub fn relative(&self) -> f64 {
        self.relative
    }

    /// Takes the sizes of a state that is a solution at the time `t`.
    pub fn note(&mut self, t: f64, x: &[f64]) {
        if self.learnt.as_mut().is_some_and(|learnt| learnt.note(t, x)) {
            self.renew();
        }
    }

    /// Finds the absolute tolerances anew.
    fn renew(&mut self) {
        let Some(learnt) = &mut self.learnt else { return };
        learnt.any_dwarf = false;
        let nothing = DWARF * learnt.largest;
        let relative = self.relative;
        let known = self.given.iter().zip(&self.fixed).zip(&self.nominal);
        let sizes = learnt.size.iter().zip(&learnt.ever).zip(&learnt.arrivals);
        for ((absolute, ((size, ever), arrival)), ((given, fixed), nominal)) in
            self.absolute.iter_mut().zip(sizes).zip(known)
        {
            let size = size.max(FADED * ever);
            // A nominal value never hides a state that stays far below it.
            let found = (relative * SHARE * size.max(*nominal)).min(relative * size);
            let has_arrived = *arrival == Arrival::Arrived;
            learnt.any_dwarf |= !(*fixed || has_arrived || SHARE * ever > nothing);
            *absolute = match (*fixed, has_arrived) {
                (true, _) => *given,
                (_, true) => given.max(found),
                _ => given.max(found).max(relative * nothing),
            };
        }
        for kin in &self.kin {
            let size = |i: &usize| learnt.size[*i].max(FADED * learnt.ever[*i]);
            let largest = kin.iter().map(size).fold(0.0, f64::max);
            for i in kin.iter().filter(|i| !self.fixed[**i]) {
                self.absolute[*i] = self.absolute[*i].max(relative * SHARE * largest);
            }
        }
    }

    /// Where all is zero and at rest: takes for a size what a guess of the first step moves, by the derivatives at its ends. A
    /// state that begins as t^2 would else be followed by low orders from far below that.
    pub fn sow(&mut self, f0: &[f64], f1: &[f64], h: f64) {
        let rests = f0.iter().all(|f| *f == 0.0);
        if let Some(learnt) = self.learnt.as_mut().filter(|learnt| rests && learnt.largest == 0.0) {
            let moved = f1.iter().fold(0.0, |largest: f64, f| largest.max(h * f.abs()));
            learnt.seed = if moved.is_finite() { moved } else { 0.0 };
        }
    }

    /// What has been learnt, for a stepper that goes on from here.
    pub fn learnt(&self) -> Option<&Learnt> {
        self.learnt.as_ref()
    }

    /// Takes over what another has learnt.
    pub fn recall(&mut self, learnt: Option<&Learnt>) {
        if let (Some(here), Some(there)) = (&mut self.learnt, learnt) {
            here.clone_from(there);
            self.renew();
        }
    }

    /// Error of state `i` that counts as one, in a step of the size `h` through magnitudes up to `magnitude`. Never zero,
    /// so that 0/0 cannot occur.
    #[inline]
    pub fn scale(&self, i: usize, magnitude: f64, h: f64) -> f64 {
        let plain = self.absolute[i] + self.relative * magnitude;
        let noise = match &self.learnt {
            Some(learnt) if learnt.noisy => {
                (PILE * h * learnt.noise[i]).min(self.relative * SHARE * learnt.largest)
            }
            _ => 0.0,
        };
        (plain + noise).max(f64::MIN_POSITIVE)
    }

    /// Error of state `i` that counts as one at a magnitude.
    pub fn unit(&self, i: usize, magnitude: f64) -> f64 {
        self.scale(i, magnitude, 0.0)
    }

    /// What stands for the largest state where none has been above zero: dwarfs of the trial itself.
    fn first(&self, x1: &[f64]) -> f64 {
        match &self.learnt {
            Some(learnt) if learnt.largest <= learnt.seed => {
                let moved = x1.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
                self.relative * (DWARF * moved).max(SHARE * learnt.seed)
            }
            _ => 0.0,
        }
    }

    /// Root mean square of an error in units of the tolerances; infinite when anything is not finite.
    /// `x0` and `x1` are the states before and after the step of the size `h`.
    pub fn norm(&self, x0: &[f64], x1: &[f64], error: &[f64], h: f64) -> f64 {
        let n = error.len();
        if n == 0 {
            return 0.0;
        }
        let (x0, x1) = (&x0[..n], &x1[..n]);
        let first = self.first(x1);
        let mut sum = 0.0;
        for i in 0..n {
            let r = error[i] / (self.scale(i, x0[i].abs().max(x1[i].abs()), h) + first);
            // An infinite state would hide its error behind an infinite tolerance.
            sum += r * r + 0.0 * x1[i];
        }
        let norm = (sum / n as f64).sqrt();
        if norm.is_finite() { norm } else { f64::INFINITY }
    }

    /// Whether the error of a step, which no shorter one can make less, is too large only for states that have hardly ever moved: where a
    /// jump of f sets them in motion, each new value is as large as its error. Both are compared with the largest of all states, so
    /// that a pole is not passed over.
    pub fn is_first_move(&self, x0: &[f64], x1: &[f64], error: &[f64], h: f64) -> bool {
        let Some(learnt) = &self.learnt else { return false };
        (0..error.len()).all(|i| {
            let unit = self.scale(i, x0[i].abs().max(x1[i].abs()), h);
            let most = learnt.ever[i].max(x1[i].abs()).max(error[i].abs());
            x1[i].is_finite() && (error[i].abs() <= unit || most <= DWARF * learnt.largest)
        })
    }

    /// Whether [`settle`](Self::settle) has something to do.
    pub fn is_unsettled(&self) -> bool {
        self.learnt.as_ref().is_some_and(|learnt| learnt.any_candidate)
    }

    /// Looks which of the states that seem to have arrived are more than rounding, at the solution (`t`, `x`) and over a step of the
    /// size `h`; these are followed from now on. Returns the evaluations that it took.
    pub fn settle(&mut self, system: &mut dyn System, t: f64, x: &[f64], h: f64) -> u64 {
        let (Some(learnt), Some(look)) = (&mut self.learnt, &mut self.look) else { return 0 };
        learnt.any_candidate = false;
        let [at, f, wide, _] = &mut **look;
        let (evaluations, is_known) = differ(system, (t, x), APART * h, [at, f, wide]);
        for ((arrival, size), rounding) in learnt.arrivals.iter_mut().zip(&learnt.ever).zip(wide.iter()) {
            if let Arrival::Candidate { since, mark } = *arrival {
                let is_solid = is_known && PILE * h * rounding.abs() <= SOLID * size;
                let again =
                    Arrival::Growing { since, mark: AGAIN * mark, size: *size, growth: f64::INFINITY };
                *arrival = if is_solid { Arrival::Arrived } else { again };
            }
        }
        self.renew();
        evaluations
    }

    /// Whether a state that is far smaller than all others is followed as these.
    pub fn has_arrived(&self, i: usize) -> bool {
        self.learnt.as_ref().is_some_and(|learnt| learnt.arrivals[i] == Arrival::Arrived)
    }

    /// Whether a state has been zero so far.
    pub fn never_moved(&self, i: usize) -> bool {
        self.learnt.as_ref().is_some_and(|learnt| learnt.ever[i] == 0.0)
    }

    /// Whether the error of a step, which no shorter one can make less, is too large only for states that were zero from the
    /// beginning until now (`fresh`). What leaves zero as a power of time above the order of the method is as large as its error
    /// in every step, and where all others were zero as well, nothing says how large that may be. Such states are still
    /// small beside the largest of this step; what is of its size has jumped.
    pub fn is_departure(&self, fresh: &[bool], [x0, x1]: [&[f64]; 2], error: &[f64], h: f64) -> bool {
        let largest = x1.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        (0..error.len()).all(|i| {
            let unit = self.scale(i, x0[i].abs().max(x1[i].abs()), h);
            let most = x1[i].abs().max(error[i].abs());
            x1[i].is_finite() && (error[i].abs() <= unit || fresh[i] && most <= DEPARTING * largest)
        })
    }

    /// The state with the maximum error, or the first one that is not finite.
    pub fn worst(&self, x0: &[f64], x1: &[f64], error: &[f64], h: f64) -> usize {
        let first = self.first(x1);
        let mut worst = (0, -1.0);
        for (i, &e) in error.iter().enumerate() {
            let r = (e / (self.scale(i, x0[i].abs().max(x1[i].abs()), h) + first)).abs();
            if !r.is_finite() || !x1[i].is_finite() {
                return i;
            }
            if r > worst.1 {
                worst = (i, r);
            }
        }
        worst.0
    }

    /// First guess of a step size, from the derivative `f0` at `x0`: an explicit Euler step moves `x0` by one hundredth of its
    /// magnitude (Hairer, Nørsett, Wanner, section II.4, a and b).
    pub fn first_guess(&self, x0: &[f64], f0: &[f64], max: f64) -> f64 {
        let (mut d0, mut d1) = (0.0, 0.0);
        for i in 0..x0.len() {
            // Where an automatic tolerance knows no size yet, a state of zero says nothing.
            if self.learnt.is_none() || x0[i] != 0.0 {
                let scale = self.scale(i, x0[i].abs(), 0.0);
                (d0, d1) = (d0 + (x0[i] / scale).powi(2), d1 + (f0[i] / scale).powi(2));
            }
        }
        let n = x0.len().max(1) as f64;
        let (d0, d1) = ((d0 / n).sqrt(), (d1 / n).sqrt());
        let h = if d0 < 1e-5 || d1 < 1e-5 { 1e-6 } else { 0.01 * d0 / d1 };
        if h.is_finite() { h.min(max) } else { max.min(1e-6) }
    }

    /// Second guess, from the derivative `f1` at `x1` after an Euler step of the size `h`: h^order times the larger of the
    /// first and second derivatives is one hundredth of the tolerance (ibid., c to f).
    pub fn second_guess(&self, x: [&[f64]; 2], f0: &[f64], f1: &[f64], h: f64, order: f64) -> f64 {
        let [x0, x1] = x;
        let n = x0.len().max(1) as f64;
        let first = self.first(x1);
        let (mut d1, mut d2) = (0.0, 0.0);
        for i in 0..x0.len() {
            // An automatic tolerance gets to know the size of what is zero by the step itself, or by the next one where
            // nothing moves at first.
            let moved = if self.learnt.is_some() { x1[i].abs().max(h * f1[i].abs()) } else { 0.0 };
            let scale = self.scale(i, x0[i].abs().max(moved), h) + first;
            (d1, d2) = (d1 + (f0[i] / scale).powi(2), d2 + ((f1[i] - f0[i]) / scale).powi(2));
        }
        let (d1, d2) = ((d1 / n).sqrt(), (d2 / n).sqrt() / h);
        let d = d1.max(d2);
        let h1 = if d <= 1e-15 { (h * 1e-3).max(1e-6) } else { (0.01 / d).powf(1.0 / order) };
        (100.0 * h).min(h1)
    }

    /// How much state `i` of the value `x` is varied for a difference: half of its digits, or of those of the magnitude where
    /// the absolute tolerance takes over from the relative one. A fixed magnitude would miss the slopes of states that live
    /// below it, such as the second of Robertson's reaction near 1e-13. `moved` is what it moves in a step, for states of which
    /// nothing else is known.
    pub fn increment(&self, i: usize, x: f64, moved: f64) -> f64 {
        let small = self.absolute[i] / self.relative.max(f64::EPSILON);
        let small = match &self.learnt {
            // Of what has hardly ever moved the size is unknown; beside the others its slopes must not drown in rounding.
            Some(learnt)
                if learnt.ever[i] <= DWARF * learnt.largest && learnt.arrivals[i] != Arrival::Arrived =>
            {
                let unknown = UNKNOWN * learnt.largest;
                // Its own nominal value says more than states of other units.
                let nominal = self.nominal[i];
                small.max(moved.abs()).max(if nominal > 0.0 { unknown.min(nominal) } else { unknown })
            }
            // Slopes of what has faded drown in rounding where they cancel.
            Some(learnt) if !self.fixed[i] => small.max(SHARE * learnt.ever[i]),
            Some(_) => small,
            None => small.max(LEAST),
        };
        f64::EPSILON.sqrt() * x.abs().max(if small > 0.0 { small } else { LEAST })
    }

    /// A difference of two values of the derivative of state `i`; zero where that is all noise.
    pub fn difference(&self, i: usize, a: f64, b: f64) -> f64 {
        let noise = self.learnt.as_ref().map_or(0.0, |learnt| learnt.noise[i]);
        if noise > 0.0 && (a - b).abs() <= PILE * noise { 0.0 } else { a - b }
    }

    /// Notes that an iteration did not converge with the Jacobian of now. Where it was looked whether that is rounding, and is not,
    /// nobody looks again for a while.
    pub fn stalled(&mut self) {
        let looked = self.may_be_rounding();
        if let Some(learnt) = &mut self.learnt {
            learnt.stalled = if looked { -SUSPICION } else { learnt.stalled + 1.0 };
        }
    }

    /// Whether iterations have failed so often of late that it may be rounding that keeps them from converging.
    pub fn may_be_rounding(&self) -> bool {
        self.learnt.as_ref().is_some_and(|learnt| learnt.stalled + 1.0 >= SUSPICION)
    }

    /// Notes that a step from `x[0]` to `x[1]` of the size `h` was kept, and its error, whose norm is `err`.
    pub fn accepted(&mut self, [x0, x1]: [&[f64]; 2], error: &[f64], err: f64, h: f64) {
        let limited_by = (self.learnt.is_some() && err > LIMITS).then(|| self.worst(x0, x1, error, h));
        if let Some(learnt) = &mut self.learnt {
            let is_speck = limited_by.is_some_and(|i| learnt.ever[i] <= SPECK * learnt.largest);
            if learnt.stalled > 0.0 {
                learnt.stalled = (learnt.stalled - SUSPICION / PATIENCE).max(0.0);
            }
            learnt.suspicion = if learnt.suspicion < 0.0 {
                learnt.suspicion + SUSPICION / PATIENCE
            } else if is_speck {
                // The step size settles where noise just passes.
                (learnt.suspicion + TRUST).min(SUSPICION - 1.0)
            } else {
                (learnt.suspicion - TRUST).max(0.0)
            };
        }
    }

    /// Notes that a step from (`t`, `x`) with the size `h` was thrown away, and looks for noise if that happens often. Returns
    /// the evaluations that it took.
    pub fn rejected(&mut self, system: &mut dyn System, t: f64, x: &[f64], h: f64) -> u64 {
        let (Some(learnt), Some(look)) = (&mut self.learnt, &mut self.look) else { return 0 };
        learnt.suspicion += 1.0;
        if learnt.suspicion < SUSPICION {
            return 0;
        }
        learnt.suspicion = -SUSPICION;
        let [at, f, wide, close] = &mut **look;
        let mut evaluations = 0;
        for apart in [APART, APART * CLOSER] {
            let difference = if apart == APART { &mut *wide } else { &mut *close };
            let (spent, is_known) = differ(system, (t, x), apart * h, [at, f, difference]);
            evaluations += spent;
            if !is_known {
                return evaluations;
            }
            // What is far below the tolerances hides nothing, whatever it is.
            let matters = |i: usize| {
                let unit = self.absolute[i] + self.relative * x[i].abs();
                difference[i].abs() > learnt.noise[i] && PILE * h * difference[i].abs() > HARMLESS * unit
            };
            if apart == APART && !(0..difference.len()).any(matters) {
                close.fill(f64::INFINITY);
                break;
            }
        }
        for (noise, (wide, close)) in learnt.noise.iter_mut().zip(wide.iter().zip(close.iter())) {
            let (wide, close) = (wide.abs(), close.abs());
            let seen = if wide > KINK * close { close } else { wide };
            if seen > *noise {
                *noise = seen;
                learnt.noisy = true;
            }
        }
        evaluations
    }
}

/// Fourth differences of the derivatives at points behind (`t`, `x`) that are `apart` in time, where states differ by their last bits,
/// from a point and a derivative to write to. Returns the evaluations, and whether all of them succeeded.
fn differ(
    system: &mut dyn System,
    (t, x): (f64, &[f64]),
    apart: f64,
    [at, f, difference]: [&mut Vec<f64>; 3],
) -> (u64, bool) {
    difference.fill(0.0);
    let mut evaluations = 0;
    for (p, weight) in FOURTH.into_iter().enumerate() {
        shake(x, p, at);
        evaluations += 1;
        let evaluated = system.derivatives(t + (p + 1) as f64 * apart, at, f);
        if evaluated.is_err() || f.iter().any(|f| !f.is_finite()) {
            return (evaluations, false);
        }
        difference.iter_mut().zip(f.iter()).for_each(|(sum, f)| *sum += weight * f);
    }
    (evaluations, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::function;

    #[test]
    fn a_value_that_is_not_finite_is_an_infinite_error() {
        let weights = Weights::new(Tolerances::uniform(2, 1e-3, 1e-6));
        assert_eq!(weights.norm(&[1.0, 1.0], &[1.0, 1.0], &[0.0, f64::NAN], 1.0), f64::INFINITY);
        assert_eq!(weights.norm(&[1.0, 1.0], &[f64::INFINITY, 1.0], &[0.0, 0.0], 1.0), f64::INFINITY);
        assert_eq!(weights.worst(&[1.0, 1.0], &[1.0, f64::NAN], &[5.0, 0.0], 1.0), 1);
        assert_eq!(weights.worst(&[1.0, 1.0], &[1.0, 1.0], &[0.1, -0.2], 1.0), 1);
    }

    #[test]
    fn an_automatic_tolerance_follows_the_size_that_a_state_has_had() {
        let mut weights = Weights::new(Tolerances::automatic(3, 1e-6));
        weights.note(0.0, &[1e-6, -2e3, 0.0]);
        weights.note(0.0, &[0.0, 1.0, 0.0]);
        let error = |weights: &Weights, i: usize, e: f64| {
            let mut error = [0.0; 3];
            error[i] = e;
            weights.norm(&[0.0; 3], &[0.0; 3], &error, 1.0) * 3f64.sqrt()
        };
        // A thousandth of the relative tolerance at its largest; what never moved counts against the largest of all.
        for (i, one) in [1e-15, 2e-6, 2e-15].into_iter().enumerate() {
            let one = if i == 0 { 2e-15 } else { one };
            assert!((error(&weights, i, one) - 1.0).abs() < 1e-12, "{i}: {}", error(&weights, i, one));
        }
        let scaled = {
            let mut weights = Weights::new(Tolerances::automatic(3, 1e-6));
            weights.note(0.0, &[1e-6 * 4096.0, 2e3 * 4096.0, 0.0]);
            weights
        };
        assert_eq!(error(&weights, 1, 1e-7), error(&scaled, 1, 1e-7 * 4096.0));
    }

    #[test]
    fn a_nominal_value_loosens_but_never_hides() {
        let mut tolerances = Tolerances::automatic(4, 1e-6);
        tolerances.nominal = vec![1.0, 1.0, 1.0, 0.0];
        let mut weights = Weights::new(tolerances);
        weights.note(0.0, &[5.0, 0.1, 1e-5, 0.1]);
        // Larger than nominal: its own size; smaller: the nominal one; far smaller: its digits; unknown: its own size.
        let expected = [5e-9, 1e-9, 1e-11, 1e-10];
        for (i, expected) in expected.into_iter().enumerate() {
            let found = weights.unit(i, 0.0);
            assert!((found / expected - 1.0).abs() < 1e-12, "{i}: {found}");
        }
    }

    #[test]
    fn noise_is_what_the_last_bits_change_and_nothing_else() {
        // The first derivative is what rounding leaves of large terms, the second is steep but smooth.
        let mut system = function(2, |t, x, dx| {
            dx[0] = (1e3 + x[1]) - 1e3 - x[1];
            dx[1] = 1e6 * (x[1] - t) + (1e3 * t).sin();
        });
        let mut weights = Weights::new(Tolerances::automatic(2, 1e-6));
        let x = [0.0, 0.7];
        weights.note(0.0, &x);
        let spent: u64 = (0..3).map(|_| weights.rejected(&mut system, 0.1, &x, 1e-3)).sum();
        // A second look, at closer points, tells it from a kink.
        assert_eq!(spent, 10);
        let noise = &weights.learnt().unwrap().noise;
        assert!(noise[0] > 1e-17 && noise[0] < 3e-13, "{noise:?}");
        assert!(noise[1] < 1e6 * 3e-16, "{noise:?}");
        // Not again before many steps have been kept.
        assert_eq!((0..3).map(|_| weights.rejected(&mut system, 0.1, &x, 1e-3)).sum::<u64>(), 0);
    }
}
