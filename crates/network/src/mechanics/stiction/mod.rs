//! Dry friction that sticks: each friction slides forward, slides backward, or is stuck.
//!
//! The modes are discrete states of the network. While it slides, friction is a torque like others. While it is stuck,
//! its speed is constrained to zero and its torque follows from the constraint. Guards end both: a speed that comes to
//! zero, a torque that reaches what is held (`guards.rs`); `choice.rs` decides which modes follow. Where something rigid is struck,
//! speeds jump first (`impact.rs`). A clutch that nothing presses is open: it has no torque, and its slip may pass through zero
//! as often as it likes.

mod choice;
mod guards;
mod impact;
mod meshes;
pub(crate) mod parts;
mod shares;
mod torques;

use blocksim_block::Context;

use self::parts::Place;
use crate::assembly::eliminate::Form;
use crate::mechanics::loops::AT_REST;
use crate::network::Network;
use crate::seat::Seat;
use crate::work::Work;

/// Speeds below this part of those that they are the difference of are zero: some thousand units in the last place.
const STANDS: f64 = 1e-12;

/// What is stuck may have drifted by this part before its speed is set to zero again: as any state by the errors of the method.
const DRIFT: f64 = 1e-6;

/// Accelerations and torques that are rounding, relative to all that pulls at the network and to what the friction itself
/// causes.
const ROUNDING: f64 = 1e-12;

/// Part of the time up to which crossings are located, ten times over.
const RESOLUTION: f64 = 1e-14;

/// The mode of a friction that nothing presses, beside forward (1), backward (-1) and stuck (0).
const OPEN: f64 = 2.0;

/// A distance from breakaway that is as good as infinite, N*m.
const FAR: f64 = 1e9;

impl Network {
    /// Modes of the frictions or meshes of a member.
    #[inline]
    pub(crate) fn modes_of<'a>(&self, c: &Context<'a>, seat: &Seat) -> &'a [f64] {
        let first = if seat.frictions.is_empty() { self.stiction.frictions } else { 0 };
        let range = if seat.frictions.is_empty() { &seat.dry } else { &seat.frictions };
        self.stiction.of(c.d).get(first + range.start..first + range.end).unwrap_or(&[])
    }

    /// Speed of what sticks over the independent and over the prescribed speeds.
    fn sticky(&self, i: usize) -> (&Form, &Form) {
        match self.stiction.parts[i] {
            Place::Pin(pin) => (&self.rotation.pins[pin].speed, &self.rotation.pins[pin].prescribed),
            Place::Gear(gear) => {
                (&self.rotation.gears[gear].base, &self.rotation.gears[gear].base_prescribed)
            }
        }
    }

    /// Torque against forward motion.
    fn resistance(&self, i: usize, w: &Work) -> f64 {
        match self.stiction.parts[i] {
            Place::Pin(_) => w.torque[self.stiction.first + i].value,
            Place::Gear(gear) => w.mesh.loss[gear],
        }
    }

    /// Speed of what sticks, and the amounts below which it is zero: while it slides, and while it is stuck.
    fn slip(&self, i: usize, x: &[f64], s: &[f64]) -> (f64, f64, f64) {
        let (form, prescribed) = self.sticky(i);
        let v = &x[self.positions..self.positions + self.rotation.free];
        let mut speed = 0.0;
        let mut scale = 0.0;
        let own = form.terms().iter().map(|(k, factor)| factor * v[*k as usize]);
        let given = prescribed.terms().iter().filter_map(|(k, factor)| Some(factor * s.get(*k as usize)?));
        for term in own.chain(given) {
            speed += term;
            scale += f64::abs(term);
        }
        // The stabilisation of closed loops moves what stands by as much as it has drifted.
        let drift = if self.frames.loops.is_empty() { 0.0 } else { AT_REST };
        (speed, STANDS * scale + drift, DRIFT * scale + drift)
    }

    /// What the resolution of time leaves of a speed at a crossing that was located, beside [`slip`](Self::slip): times are
    /// good to some units in the last place, and so are speeds to that times the accelerations of what moves.
    fn jitter(&self, i: usize, c: &Context, w: &Work) -> f64 {
        let own = self.sticky(i).0.terms().iter();
        RESOLUTION * c.t.abs() * own.map(|(k, factor)| (factor * w.dv[*k as usize]).abs()).sum::<f64>()
    }

    /// The speed below which a part stands, while `w` holds the evaluation at `c`. What is stuck has been integrated at a speed of zero
    /// and drifts from there: by rounding of its acceleration for as long as the run lasts, and by what the iterations of an implicit
    /// method leave of zero.
    fn stands_below(&self, i: usize, c: &Context, w: &Work) -> f64 {
        let (_, zero, drifted) = self.slip(i, c.x, &w.s);
        let own = if self.stiction.of(c.d)[i] == 0.0 {
            let acceleration = self.row_of(i, w).map_or(0.0, |row| ROUNDING * w.schur.scale(row) * w.pull);
            drifted.max(AT_REST) + acceleration * c.t.abs()
        } else {
            zero
        };
        own + self.jitter(i, c, w)
    }

    /// Modes that the speeds alone tell at the start.
    pub(crate) fn follow_speeds(&self, x: &[f64], d: &mut [f64]) {
        for i in 0..self.stiction.len() {
            let (speed, zero, _) = self.slip(i, x, &[]);
            if speed.abs() > zero {
                d[self.stiction.modes.start + i] = speed.signum();
            }
        }
    }

    /// What has been struck through closed loops slides; what was stuck and has not been struck stays so. `w` holds the evaluation
    /// at `c`, before the speeds became those of `x`.
    pub(crate) fn slide_on(&self, c: &Context, w: &Work, x: &[f64], d: &mut [f64]) {
        for i in 0..self.stiction.len() {
            let (speed, zero, _) = self.slip(i, x, &w.s);
            let stands = if self.stiction.of(c.d)[i] == 0.0 { self.stands_below(i, c, w) } else { zero };
            if speed.abs() > stands {
                d[self.stiction.modes.start + i] = speed.signum();
            }
        }
    }

    /// Whether a prescribed speed has thrown what is stuck out of its rest, while `w` holds the evaluation at `c`.
    ///
    /// No dry friction passes an impulse on, so what is stuck slides where a speed jumps; nothing else makes it slide but a torque
    /// (`guards.rs`) and what is rigid (`impact.rs`). Its own speed does not tell: that drifts. Only where a source gives
    /// no derivative, its speed may have run away from what is stuck to it.
    fn is_thrown(&self, i: usize, c: &Context, w: &Work) -> bool {
        let before = &c.d[self.stiction.sources.clone()];
        let terms = self.sticky(i).1.terms();
        let (mut jump, mut size, mut guided) = (0.0, 0.0, false);
        for (k, factor) in terms.iter().map(|(k, factor)| (*k as usize, factor)) {
            let (from, to) = (before.get(k).map_or(0.0, |from| factor * from), factor * w.s[k]);
            jump += to - from;
            size += f64::abs(from) + f64::abs(to);
            guided |= w.ds[k] != 0.0;
        }
        !terms.is_empty() && (!guided || f64::abs(jump) > STANDS * size)
    }

    /// The constraint of a part that is stuck.
    fn row_of(&self, i: usize, w: &Work) -> Option<usize> {
        w.stuck.iter().position(|stuck| *stuck == i).map(|k| w.first_stuck + k)
    }
}
