//! `Auto`: an explicit method, and a stiff one where stability limits the steps of the explicit one.
//!
//! Dormand and Prince's method tells from its last two stages, which belong to the same time, how fast differences of
//! states fade: h |lambda|. Where its steps are limited by stability and not by the tolerance that stays at the edge of
//! its region of stability, near 3.3. Fifteen such steps, with fewer than six others in a row between them, and `Ode15s`
//! goes on. No accuracy allows such steps for long. Further inside, the small errors of what has faded can limit the steps
//! all the same, at tight tolerances far inside: there the last states tell how long a step of `Ode15s` could be. The stiff
//! method gives back when the explicit method would be stable with its steps for a while, as the norm of the Jacobian says,
//! which is never too small.
//!
//! E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section IV.2.

use crate::adaptive::{NEAR_EDGE, Radius};
use crate::past::Past;
use crate::stepper::{Memory, Share};
use crate::{Counts, Ode15s, Ode45, StepError, StepLimits, Stepper, System, Tolerances};

/// h |lambda| of a step at the edge of stability, a little less, and how much it counts.
const EDGE: (f64, u32) = (3.25, 10);
/// The same near the edge.
const NEAR: (f64, u32) = (NEAR_EDGE, 3);
/// The same further inside, where a step of the stiff method could be longer by a factor, although it is the dearer one that
/// has to begin anew; and how much of h |lambda| must be decay, since the stiff method would damp an oscillation.
const INSIDE: (f64, u32) = (0.3, 30);
const LONGER: f64 = 2.0;
const FADES: f64 = 0.7;
/// What such steps must count to be taken for stiffness.
const STIFF: u32 = 150;
/// Others in a row after which counting begins anew.
const OTHERS: u32 = 6;
/// h |lambda| of a step of the stiff method which the explicit one can make without care.
const EASY: f64 = 0.5;
/// Such steps in a row after which the explicit method goes on.
const CALM: u32 = 20;

/// The explicit method where it is the better one, and the stiff one elsewhere.
pub struct Auto {
    explicit: Ode45,
    stiff: Ode15s,
    /// Longest step, s.
    max: f64,
    /// States since all steps of the explicit method have been such as the stiff one may be better at.
    past: Past,
    now: Turn,
    /// Whether the other method is to go on from here.
    change: bool,
    share: Share,
    /// The last three before the last step.
    before: (Turn, bool, Share),
}

/// What is known of the method at work.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Turn {
    /// Whether it is the stiff one.
    pub stiff: bool,
    /// What speaks for the other one.
    pub against: u32,
    /// Steps in a row that do not.
    pub others: u32,
}

impl Auto {
    /// A stepper for as many states as there are absolute tolerances.
    pub fn new(tolerances: Tolerances, limits: StepLimits) -> Self {
        let past = Past::new(tolerances.absolute.len());
        Self {
            explicit: Ode45::new(tolerances.clone(), limits),
            stiff: Ode15s::new(tolerances, limits),
            max: limits.max,
            past,
            now: Turn::default(),
            change: false,
            share: Share::default(),
            before: (Turn::default(), false, Share::default()),
        }
    }

    fn active(&self) -> &dyn Stepper {
        if self.now.stiff { &self.stiff } else { &self.explicit }
    }

    fn active_mut(&mut self) -> &mut dyn Stepper {
        if self.now.stiff { &mut self.stiff } else { &mut self.explicit }
    }

    /// Lets the other method go on at `t`.
    fn turn(&mut self, t: f64) {
        if self.now.stiff {
            self.explicit.follow(&self.stiff);
        } else {
            self.stiff.follow(&self.explicit);
            self.share.first.get_or_insert(t);
        }
        self.now = Turn { stiff: !self.now.stiff, ..Turn::default() };
        self.change = false;
        self.past.clear();
        self.share.changes += 1;
    }

    /// Looks at a step that was kept and led to `x`.
    fn judge(&mut self, x: &[f64]) {
        let now = &mut self.now;
        if now.stiff {
            self.share.stiff += 1;
            let (t0, t1) = self.stiff.last_step();
            let easy = (t1 - t0) * self.stiff.radius() < EASY;
            now.against = if easy { now.against + 1 } else { 0 };
            self.change = now.against >= CALM;
            return;
        }
        let Radius { all: radius, decay } = self.explicit.radius();
        let fades = radius > INSIDE.0 && decay > FADES * radius;
        if fades {
            self.past.push(self.explicit.last_step().1, x);
        } else {
            self.past.clear();
        }
        let counts = if radius > EDGE.0 {
            EDGE.1
        } else if radius > NEAR.0 {
            NEAR.1
        } else {
            0
        };
        let could = || self.past.longest_step(self.explicit.weights()).min(self.max);
        let counts = if fades && could() > LONGER * self.explicit.wanted() { INSIDE.1 } else { counts };
        if counts > 0 {
            (now.against, now.others) = (now.against + counts, 0);
            self.change = now.against >= STIFF;
        } else if now.against > 0 {
            now.others += 1;
            if now.others >= OTHERS {
                (now.against, now.others) = (0, 0);
            }
        }
    }
}

impl Stepper for Auto {
    fn reserve(&mut self, system: &dyn System) {
        self.stiff.reserve(system);
    }

    fn restart(&mut self) {
        self.past.clear();
        self.active_mut().restart();
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
        if self.change {
            self.turn(*t);
        }
        let mut stepped = self.active_mut().step(system, t, x, limit);
        if let (Err(StepError::Underflow { .. }), false) = (&stepped, self.now.stiff) {
            // So stiff that the explicit method cannot move at all, perhaps.
            self.turn(*t);
            stepped = self.active_mut().step(system, t, x, limit);
        }
        self.before = (self.now, self.change, self.share);
        stepped.map(|()| self.judge(x))
    }

    fn sharpen(&mut self, system: &mut dyn System) {
        self.active_mut().sharpen(system);
    }

    fn sees_within(&self) -> bool {
        self.active().sees_within()
    }

    fn sharpen_rows(&mut self, system: &mut dyn System) {
        self.active_mut().sharpen_rows(system);
    }

    fn back(&mut self) {
        let found = self.now;
        (self.now, self.change, self.share) = self.before;
        // Where errors within the tolerance set off conditions, every long step is taken back, and it was as unstable all the same.
        if !found.stiff && found.against > self.now.against {
            self.now = Turn { against: found.against, others: 0, ..self.now };
            self.change = found.against >= STIFF;
        }
        self.past.clear();
        self.active_mut().back();
    }

    fn interpolate(&self, t: f64, x: &mut [f64]) {
        self.active().interpolate(t, x);
    }

    fn has_arrived(&self, state: usize) -> bool {
        self.active().has_arrived(state)
    }

    fn last_step(&self) -> (f64, f64) {
        self.active().last_step()
    }

    fn memory(&self) -> Memory {
        Memory {
            turn: Some(Box::new((self.now, self.change, self.share, self.past.clone()))),
            ..self.active().memory()
        }
    }

    fn recall(&mut self, memory: &Memory) {
        if let Some((now, change, share, past)) = memory.turn.as_deref() {
            (self.now, self.change, self.share) = (*now, *change, *share);
            self.past.clone_from(past);
        }
        self.active_mut().recall(memory);
    }

    fn counts(&self) -> Counts {
        let (a, b) = (self.explicit.counts(), self.stiff.counts());
        Counts {
            evaluations: a.evaluations + b.evaluations,
            accepted: a.accepted + b.accepted,
            rejected: a.rejected + b.rejected,
            jacobians: a.jacobians + b.jacobians,
            factorisations: a.factorisations + b.factorisations,
            limited: a.limited,
        }
    }

    fn share(&self) -> Option<Share> {
        Some(self.share)
    }

    fn name(&self) -> &'static str {
        "Auto"
    }
}
