//! Impacts: speeds that jump because something rigid is struck.
//!
//! Only what is rigid passes an impulse on: a freewheel that locks, a mesh that locks itself, closed loops. A dry
//! friction has a finite torque, whose impulse in no time is zero, however large the torque is: what is struck slides.
//!
//! Speeds behind a plastic impact: of all that no freewheel forbids, those nearest in kinetic energy. For the slips
//! `u` in the direction that each freewheel locks and its impulses `p` this is the complementarity problem
//! `u+ = u - S p`, `u+ <= 0`, `p >= 0`, `u+ p = 0` (J. J. Moreau, Unilateral contact and dry friction in finite freedom
//! dynamics, 1988), solved by least-index pivoting.
//!
//! A rigid end of travel with a restitution `e` bounces: `u+ <= -e u` instead (Newton's law of impacts). Each bounce is
//! shorter than the last by `e`, and all of them end at a finite time; below [`RESTS`] it stays where it is. Ends that depend on each
//! other, as two walls that one mass strikes, may ask for different speeds; then sets of them are tried one after the other.

use blocksim_block::Context;

use super::parts::{Place, Rest, Sets};
use crate::network::Network;
use crate::work::Work;

/// A bounce that would end sooner than this, s, is none.
const RESTS: f64 = 1e-7;
/// Part of a speed at which something is thrown back that may be missing.
const MET: f64 = 1e-9;
/// Part of the largest speed at which something is thrown back from which a part goes with it.
const REBOUND: f64 = 1e-6;

/// How a part takes part in an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rigid {
    /// Not at all: its torque is finite.
    No,
    /// It never slides in this direction.
    OneWay(f64),
    /// It stops at once.
    BothWays,
}

impl Network {
    /// Speeds after an impact, when `w` holds the evaluation at `c`, and what is then to be decided about each part.
    pub(super) fn collide(&self, c: &Context, w: &mut Work, at: &mut [f64], modes: &mut [f64]) {
        let count = self.stiction.len();
        let first = self.stiction.modes.start;
        for (i, mode) in self.stiction.of(c.d).iter().copied().enumerate() {
            let (speed, zero) = (self.slip(i, c.x, &w.s).0, self.stands_below(i, c, w));
            let slides = |sign: f64| if speed == 0.0 { sign } else { speed.signum() };
            (w.rests[i], modes[first + i]) = match self.rigid(i, mode, w) {
                Rigid::No => (Rest::Free, slides(if mode == 0.0 { 1.0 } else { mode })),
                Rigid::OneWay(sign) if sign * speed <= zero => (Rest::Stands, -sign),
                Rigid::OneWay(_) | Rigid::BothWays => (Rest::Stands, 0.0),
            };
            w.bounce[i] = match self.rigid(i, mode, w) {
                Rigid::OneWay(sign) if sign * speed > zero => -sign * self.rebound(i, sign, sign * speed, w),
                _ => 0.0,
            };
        }
        for _ in 0..10 + 10 * count * count {
            self.thrown(c, w, at, modes);
            let wrong = (0..count).find(|i| self.is_wrong(*i, modes[first + i], c, at, w));
            let Some(i) = wrong else { break };
            modes[first + i] = match self.rigid(i, 0.0, w) {
                Rigid::OneWay(sign) if modes[first + i] == 0.0 => -sign,
                _ => 0.0,
            };
        }
        if (0..count).any(|i| self.falls_short(i, c, at, w)) {
            self.try_sets(c, w, at, modes);
        }
        // What is to stand may go with what is thrown back.
        let back = w.bounce.iter().fold(0.0_f64, |most, bounce| most.max(bounce.abs()));
        for i in 0..count {
            if self.is_open(i, w) {
                w.rests[i] = Rest::Open;
                continue;
            }
            let speed = self.slip(i, at, &w.s).0;
            let locked = modes[first + i] == 0.0
                && w.bounce[i] == 0.0
                && (back == 0.0 || speed.abs() <= REBOUND * back);
            w.rests[i] = match locked || speed.abs() <= self.stands_below(i, &Context { x: at, ..*c }, w) {
                true => self.stands(i, w),
                false => Rest::Moves(speed.signum()),
            };
        }
    }

    /// Speeds after an impact of what `modes` hold.
    fn thrown(&self, c: &Context, w: &mut Work, at: &mut [f64], modes: &[f64]) {
        at.copy_from_slice(c.x);
        self.again(&Context { x: c.x, d: modes, ..*c }, w);
        self.throw(w, at);
    }

    /// Tries each set of the parts that slide in one direction only, until all of them do right.
    fn try_sets(&self, c: &Context, w: &mut Work, at: &mut [f64], modes: &mut [f64]) {
        let (count, first) = (self.stiction.len(), self.stiction.modes.start);
        let one_way = |i: usize, w: &Work| match self.rigid(i, 0.0, w) {
            Rigid::OneWay(sign) => Some(sign),
            Rigid::No | Rigid::BothWays => None,
        };
        w.kept.copy_from_slice(self.stiction.of(modes));
        let sets = Sets { parts: (0..count).filter(|i| one_way(*i, w).is_some()).count() };
        for set in 0..sets.len() {
            let mut part = 0;
            for i in 0..count {
                if let Some(sign) = one_way(i, w) {
                    modes[first + i] = if sets.has(set, part) { 0.0 } else { -sign };
                    part += 1;
                }
            }
            self.thrown(c, w, at, modes);
            let fails = |i| self.is_wrong(i, modes[first + i], c, at, w) || self.falls_short(i, c, at, w);
            if !(0..count).any(fails) {
                return;
            }
        }
        // Without a set that does right it stays as it was.
        modes[self.stiction.modes.clone()].copy_from_slice(&w.kept);
        self.thrown(c, w, at, modes);
    }

    /// Whether an end of travel throws back less than it has to.
    fn falls_short(&self, i: usize, c: &Context, at: &[f64], w: &Work) -> bool {
        let Rigid::OneWay(sign) = self.rigid(i, 0.0, w) else { return false };
        let (speed, zero, _) = self.slip(i, at, &w.s);
        // A speed that is asked for is met but for rounding.
        sign * speed > zero + self.jitter(i, c, w) - (1.0 - MET) * w.bounce[i].abs()
    }

    /// Whether a freewheel pulls, or slides the way that it locks.
    fn is_wrong(&self, i: usize, mode: f64, c: &Context, at: &[f64], w: &Work) -> bool {
        let Rigid::OneWay(sign) = self.rigid(i, 0.0, w) else { return false };
        match self.row_of(i, w) {
            Some(row) => mode == 0.0 && sign * w.schur.lambda[row] > 0.0,
            None => self.falls_short(i, c, at, w),
        }
    }

    /// Speed at which an end of travel throws back what hits it with a speed in the direction of `sign`, while `w` holds the
    /// evaluation before.
    fn rebound(&self, i: usize, sign: f64, speed: f64, w: &Work) -> f64 {
        let Some(stop) = w.grip[i].stop else { return 0.0 };
        let (form, prescribed) = self.sticky(i);
        let pull = sign * (form.of(&w.dv) + prescribed.of(&w.ds));
        let back = stop.restitution * speed;
        // It comes back after 2 back / pull, and rises by back^2 / (2 pull).
        let rests = pull > 0.0 && (2.0 * back < RESTS * pull || back * back <= 2.0 * pull * stop.depth);
        if rests { 0.0 } else { back }
    }

    /// Takes speeds onto the constraints of the last evaluation by an impulse, with what bounces.
    fn throw(&self, w: &mut Work, at: &mut [f64]) {
        if w.stuck.iter().all(|i| w.bounce[*i] == 0.0) {
            return self.stop(w, at);
        }
        let v = &mut at[self.positions..self.positions + self.rotation.free];
        let (first, stuck, s, bounce) = (w.first_stuck, &w.stuck, &w.s, &w.bounce);
        w.schur.impose(&w.rows, v, |row| match row.checked_sub(first) {
            Some(k) => bounce[stuck[k]] - self.sticky(stuck[k]).1.of(s),
            None => w.loops.target[row],
        });
    }

    fn rigid(&self, i: usize, mode: f64, w: &Work) -> Rigid {
        match (self.stiction.parts[i], w.grip[i].hold.map(f64::is_infinite)) {
            // A mesh that jams, and one that is stuck and that no load turns.
            (Place::Gear(gear), _) => {
                let locks = mode == 0.0 && w.mesh.dry[gear].0.share[1] >= 1.0;
                if locks || self.jam(i, mode, w) < 0.0 { Rigid::BothWays } else { Rigid::No }
            }
            (Place::Pin(_), [true, true]) => Rigid::BothWays,
            (Place::Pin(_), [true, false]) => Rigid::OneWay(1.0),
            (Place::Pin(_), [false, true]) => Rigid::OneWay(-1.0),
            (Place::Pin(_), [false, false]) => Rigid::No,
        }
    }
}
