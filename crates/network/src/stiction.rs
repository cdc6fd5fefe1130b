//! Dry friction that sticks: each friction slides forward, slides backward, or is stuck.
//!
//! The modes are discrete states of the network. While it slides, friction is a torque like others. While it is stuck,
//! its speed is constrained to zero and its torque follows from the constraint. Guards end both: a speed that comes to
//! zero, a torque that reaches what is held.
//!
//! Which modes follow is a complementarity problem: what is stuck bears no more than it can hold, and what slides from
//! rest accelerates the way it slides. It is solved by least-index pivoting: every friction at rest begins stuck, and
//! of those whose mode is wrong the first is changed, until none is. For matrices that are positive definite this
//! ends (K. G. Murty, Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11 (1974)). Where
//! more is held at rest than while sliding, there may be several solutions and pivoting may go round in circles; then
//! what is held counts as what slides, which has one solution.

use std::ops::Range;

use blocksim_block::physical::{Element, Torque};
use blocksim_block::{Context, Interface};
use blocksim_solve::linear::cholesky_solve;

use crate::network::Network;
use crate::rotation::{Pin, Rotation};
use crate::seat::Seat;
use crate::work::Work;

/// Speeds below this part of those that they are the difference of are zero: some thousand units in the last place.
const STANDS: f64 = 1e-12;

/// What is stuck may have drifted by this part before it counts as struck.
const DRIFT: f64 = 1e-9;

/// Accelerations against the direction of sliding that are rounding, relative to what the friction itself causes.
const ROUNDING: f64 = 1e-12;

/// A distance from breakaway that is as good as infinite, N*m.
const FAR: f64 = 1e9;

/// The frictions of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stiction {
    /// Where their modes lie among the discrete states.
    modes: Range<usize>,
    /// Where their guards lie.
    guards: Range<usize>,
    /// Index of the pin of each.
    pins: Vec<usize>,
    /// Index of the first among the branches.
    first: usize,
}

impl Stiction {
    /// Adds modes and guards to the interface, behind those of the members.
    pub(crate) fn new(seats: &[Seat], rotation: &Rotation, interface: &mut Interface) -> Self {
        let (d, g) = (interface.discrete.len(), interface.guards.len());
        let pins: Vec<usize> = rotation.branches[rotation.smooth..].to_vec();
        for seat in seats {
            let count =
                seat.member.part.elements.iter().filter(|e| matches!(e, Element::Friction { .. })).count();
            for i in 0..count {
                let number = if count > 1 { (i + 1).to_string() } else { String::new() };
                let name = format!("{}.mode{number}", seat.member.path);
                interface.discrete.push(blocksim_block::Discrete { name: name.clone(), initial: 0.0 });
                interface.guards.push(name);
            }
        }
        interface.jumps |= !pins.is_empty();
        Self { modes: d..d + pins.len(), guards: g..g + pins.len(), pins, first: rotation.smooth }
    }

    /// Number of frictions.
    pub(crate) fn len(&self) -> usize {
        self.pins.len()
    }

    /// The modes among discrete states.
    fn of<'a>(&self, d: &'a [f64]) -> &'a [f64] {
        d.get(self.modes.clone()).unwrap_or(&[])
    }
}

impl Network {
    /// Modes of the frictions of a member.
    #[inline]
    pub(crate) fn modes_of<'a>(&self, c: &Context<'a>, seat: &Seat) -> &'a [f64] {
        self.stiction.of(c.d).get(seat.frictions.clone()).unwrap_or(&[])
    }

    fn friction_pin(&self, i: usize) -> &Pin {
        &self.rotation.pins[self.stiction.pins[i]]
    }

    /// Speed of a friction, and the amount below which it is zero.
    fn slip(&self, i: usize, x: &[f64], s: &[f64]) -> (f64, f64) {
        let pin = self.friction_pin(i);
        let v = &x[self.positions..self.positions + self.rotation.free];
        let mut speed = 0.0;
        let mut scale = 0.0;
        let own = pin.speed.terms().iter().map(|(k, factor)| factor * v[*k as usize]);
        let given =
            pin.prescribed.terms().iter().filter_map(|(k, factor)| Some(factor * s.get(*k as usize)?));
        for term in own.chain(given) {
            speed += term;
            scale += f64::abs(term);
        }
        (speed, STANDS * scale)
    }

    /// Modes that the speeds alone tell: at the start, and after impacts.
    pub(crate) fn follow_speeds(&self, x: &[f64], s: &[f64], d: &mut [f64]) {
        for i in 0..self.stiction.len() {
            let (speed, zero) = self.slip(i, x, s);
            if speed.abs() > zero {
                d[self.stiction.modes.start + i] = speed.signum();
            }
        }
    }

    /// The speed of what is stuck is zero, not nearly zero.
    pub(crate) fn still_pins(&self, c: &Context, w: &mut Work) {
        for (pin, mode) in self.stiction.pins.iter().zip(self.stiction.of(c.d)) {
            if *mode == 0.0 {
                w.pin_speed[*pin] = 0.0;
            }
        }
    }

    /// Torques of what slides.
    pub(crate) fn sliding_torques(&self, c: &Context, w: &mut Work) {
        if self.stiction.pins.is_empty() {
            return;
        }
        let mut grip = std::mem::take(&mut w.grip);
        for seat in self.active.frictions.iter().map(|i| &self.seats[*i]) {
            if let Some(component) = seat.member.block.component() {
                component.grips(&self.law(c, seat, w), &mut grip[seat.frictions.clone()]);
            }
        }
        let torques = w.torque[self.stiction.first..].iter_mut();
        for ((torque, grip), mode) in torques.zip(&grip).zip(self.stiction.of(c.d)) {
            *torque = match *mode {
                m if m > 0.0 => grip.slide[0],
                m if m < 0.0 => Torque { value: -grip.slide[1].value, slope: grip.slide[1].slope },
                _ => Torque::default(),
            };
        }
        w.grip = grip;
    }

    /// Constraints of what is stuck, behind those that are there.
    pub(crate) fn stuck_rows(&self, c: &Context, w: &mut Work) {
        w.first_stuck = w.rows.len();
        w.stuck.clear();
        for (i, mode) in self.stiction.of(c.d).iter().enumerate() {
            if *mode == 0.0 {
                let pin = self.friction_pin(i);
                let hold = w.grip[i].hold[0].max(w.grip[i].hold[1]);
                let row = w.rows.push(-pin.prescribed.of(&w.ds), hold.clamp(1e-12, 1e12));
                pin.speed.add_to(1.0, row);
                w.stuck.push(i);
            }
        }
        w.lock.prepare(&w.stuck, |i| {
            let pin = self.friction_pin(i);
            (&pin.speed, &pin.prescribed)
        });
    }

    /// Torques of what is stuck, from the multipliers of its constraints.
    pub(crate) fn holding_torques(&self, w: &mut Work) {
        for (i, lambda) in w.stuck.iter().zip(&w.lambda[w.first_stuck..]) {
            w.torque[self.stiction.first + i].value = -lambda;
        }
    }

    /// Distance from the end of each mode.
    pub(crate) fn stiction_guards(&self, c: &Context, w: &Work, g: &mut [f64]) {
        let g = &mut g[self.stiction.guards.clone()];
        for (i, (g, mode)) in g.iter_mut().zip(self.stiction.of(c.d)).enumerate() {
            *g = if *mode == 0.0 {
                let (torque, hold) = (w.torque[self.stiction.first + i].value, w.grip[i].hold);
                (hold[0] - torque).min(hold[1] + torque).min(FAR)
            } else {
                let (speed, zero) = self.slip(i, c.x, &w.s);
                mode * speed + zero
            };
        }
    }

    /// Chooses all modes at a major step, when `w` holds the evaluation at `c`. Speeds that come to rest become zero
    /// by an impulse, which is of the size of the rounding if the crossing was located. Returns whether anything
    /// changed.
    pub(crate) fn choose_modes(&self, c: &Context, w: &mut Work, x: &mut [f64], d: &mut [f64]) -> bool {
        if self.stiction.pins.is_empty() || !self.must_choose(c, w) {
            return false;
        }
        let (mut at, mut modes) = (std::mem::take(&mut w.trial_x), std::mem::take(&mut w.trial_d));
        at.copy_from_slice(c.x);
        modes.copy_from_slice(c.d);
        let range = self.stiction.modes.clone();
        for (i, mode) in modes[range].iter_mut().enumerate() {
            *mode = match w.rests[i] {
                Rest::Moves(sign) => sign,
                Rest::Stands => 0.0,
                Rest::Free if *mode == 0.0 => 1.0,
                Rest::Free => *mode,
            };
        }
        self.again(&Context { x: &at, d: &modes, ..*c }, w);
        self.stop(w, &mut at);
        self.pivot(c, w, &at, &mut modes);

        // What slides on keeps its speed, unless that is on the wrong side of zero.
        let sliding = self.stiction.of(&modes).iter().enumerate();
        let mut wrong = sliding
            .filter(|(i, mode)| w.rests[*i] == Rest::Stands && **mode * self.slip(*i, c.x, &w.s).0 < 0.0);
        if wrong.next().is_none() {
            at.copy_from_slice(c.x);
            self.stop(w, &mut at);
        }
        let speeds = self.positions..self.positions + self.rotation.free;
        let changed = x[speeds.clone()] != at[speeds.clone()] || *d != *modes;
        x[speeds.clone()].copy_from_slice(&at[speeds]);
        d[self.stiction.modes.clone()].copy_from_slice(self.stiction.of(&modes));
        (w.trial_x, w.trial_d) = (at, modes);
        w.evaluation = [u64::MAX; 3];
        changed
    }

    /// Sorts the frictions by what is to be decided about them; returns whether a mode is wrong.
    fn must_choose(&self, c: &Context, w: &mut Work) -> bool {
        let mut wrong = false;
        for (i, mode) in self.stiction.of(c.d).iter().copied().enumerate() {
            let (speed, zero) = self.slip(i, c.x, &w.s);
            let never = speed != 0.0 && w.grip[i].hold[usize::from(speed < 0.0)] == f64::INFINITY;
            let threshold = if mode == 0.0 { zero * (DRIFT / STANDS) } else { zero };
            let moves = speed.abs() > threshold && (mode == 0.0 || mode * speed > 0.0);
            w.rests[i] = if moves && !never {
                wrong |= mode == 0.0;
                Rest::Moves(speed.signum())
            } else {
                wrong |= moves || speed.abs() > threshold || self.verdict(i, mode, w, false).is_some();
                if self.is_free(i, w) { Rest::Free } else { Rest::Stands }
            };
        }
        wrong
    }

    /// Nothing holds it, or nothing would move if it were held.
    fn is_free(&self, i: usize, w: &Work) -> bool {
        w.grip[i].hold == [0.0; 2] || self.friction_pin(i).speed.is_empty()
    }

    /// The mode that is to be tried instead of a wrong one, at rest; `None` if it is right. With `soft`, no more is
    /// held than slides.
    fn verdict(&self, i: usize, mode: f64, w: &mut Work, soft: bool) -> Option<f64> {
        let grip = w.grip[i];
        let mut hold = grip.hold;
        if soft {
            for (hold, slide) in hold.iter_mut().zip(&grip.slide).filter(|(hold, _)| hold.is_finite()) {
                *hold = hold.min(slide.value);
            }
        }
        let is_free = self.is_free(i, w);
        if mode == 0.0 {
            let torque = w.torque[self.stiction.first + i].value;
            return match torque {
                _ if is_free => Some(1.0),
                t if t > hold[0] => Some(1.0),
                t if t < -hold[1] => Some(-1.0),
                _ => None,
            };
        }
        let side = usize::from(mode < 0.0);
        if grip.hold[side] == f64::INFINITY {
            return Some(0.0);
        }
        let pin = self.friction_pin(i);
        let acceleration = mode * (pin.speed.of(&w.dv) + pin.prescribed.of(&w.ds));
        if acceleration >= 0.0 {
            return None;
        }
        // D M^-1 D': what a torque of one does.
        w.product.fill(0.0);
        pin.speed.add_to(1.0, &mut w.product);
        cholesky_solve(&w.factor, &mut w.product);
        let largest = [hold[0], hold[1], grip.slide[side].value].into_iter().filter(|t| t.is_finite());
        let rounding = ROUNDING * pin.speed.of(&w.product) * largest.fold(0.0, f64::max);
        match acceleration < -rounding {
            true if is_free => Some(-mode),
            true => Some(0.0),
            false => None,
        }
    }

    /// Evaluates at changed states and modes.
    fn again(&self, c: &Context, w: &mut Work) {
        w.evaluation = [u64::MAX; 3];
        self.motion_phase(c, w);
    }

    /// Takes speeds onto the constraints of the last evaluation by an impulse.
    fn stop(&self, w: &mut Work, x: &mut [f64]) {
        let v = &mut x[self.positions..self.positions + self.rotation.free];
        if w.rows.is_empty() {
            return;
        }
        let (first, stuck, s) = (w.first_stuck, &w.stuck, &w.s);
        w.schur.impose(&w.rows, v, |row| match row.checked_sub(first) {
            Some(k) => -self.friction_pin(stuck[k]).prescribed.of(s),
            None => w.loops.target[row],
        });
        w.lock.settle(v, &w.s);
    }

    /// Least-index pivoting over what stands.
    fn pivot(&self, c: &Context, w: &mut Work, at: &[f64], modes: &mut [f64]) {
        let count = self.stiction.len();
        for soft in [false, true] {
            for _ in 0..10 + 10 * count * count {
                let now = Context { x: at, d: modes, ..*c };
                self.again(&now, w);
                let next = (0..count).find_map(|i| {
                    let mode = self.stiction.of(modes)[i];
                    let rests = !matches!(w.rests[i], Rest::Moves(_));
                    Some((i, self.verdict(i, mode, w, soft).filter(|_| rests)?))
                });
                match next {
                    None => return,
                    Some((i, mode)) => modes[self.stiction.modes.start + i] = mode,
                }
            }
        }
        c.fail("the dry frictions find no modes that agree: make one of them smooth");
    }
}

/// What is to be decided about a friction at an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rest {
    /// Nothing: it slides in this direction.
    Moves(f64),
    /// Whether it sticks, and which way it slides otherwise.
    Stands,
    /// Which way it slides; nothing holds it.
    Free,
}
