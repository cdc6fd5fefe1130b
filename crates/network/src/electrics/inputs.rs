//! How the inputs of a circuit go on within a coupling step.
//!
//! The circuit is integrated before the inputs of the step are known. They are taken to go on as they did in the last two steps: a
//! parabola with the mean slopes of both where these agree, else a line with the smaller one, since a jump is not to come again. What
//! an input changes by at the hit itself is no slope: so one that is sampled stays where it is, and one that is the sum of both goes
//! on by the part that moves. That is why the value just before the hit is noted as well.
//!
//! Where an input has gone on otherwise, as about a kink, the step is integrated once more when it is over, and where it jumps within
//! a step, what has passed of that is; see `repeat.rs`.

use blocksim_block::Context;
use blocksim_signal::Kind;

use crate::electrics::Separate;
use crate::electrics::coupling::smaller;
use crate::network::Network;
use crate::seat::Held;
use crate::work::circuits::Room;

/// Slopes of two steps agree that differ by less than this share of the greater.
const AGREE: f64 = 0.5;

/// By what part of its size an input must have been missed for the step to be integrated once more: by less it is ripple.
const KINK: f64 = 1e-4;

/// By what part of its size an input must have changed at an instant for the step to end there.
const JUMP: f64 = 1e-8;

/// Times that differ by this part of a coupling step are the same.
const SAME: f64 = 1e-6;

/// How an input goes on over a coupling step: by `slope` and `bend`, per second and per second squared, and by how much that may be
/// wrong, as a slope per second of the length of the step squared.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Course {
    slope: f64,
    bend: f64,
    doubt: f64,
}

impl Course {
    /// By how much an input has changed, `s` after the hit.
    fn after(&self, s: f64) -> f64 {
        s * (self.slope + 0.5 * s * self.bend)
    }
}

/// Where it lies for an input what the last steps say of it.
pub(crate) struct InputCells {
    /// At the beginning of the step, at the end of the last step that the solver has accepted, and what was expected there.
    start: usize,
    left: usize,
    expected: usize,
    /// Its integral over the step so far, by the rule of trapezoids.
    integral: usize,
    /// Mean slopes of the last step and of the one before.
    slopes: [usize; 2],
    /// By how much the value was missed at the ends of both, in units per cube of the length of the step.
    missed: [usize; 2],
    /// It is no real number: it changes by jumps alone.
    is_stepwise: bool,
    /// What is made of it is an integral, and wrong for good where it has been missed.
    is_integrated: bool,
}

impl InputCells {
    /// How many cells each input has.
    pub(crate) const COUNT: usize = 8;

    fn new(held: &Held, input: usize, is_stepwise: bool, is_integrated: bool) -> Self {
        let [start, left, expected, integral, slope, slope_before, missed, missed_before] =
            [0, 1, 2, 3, 4, 5, 6, 7].map(|k| held.inputs.start + Self::COUNT * input + k);
        Self {
            start,
            left,
            expected,
            integral,
            slopes: [slope, slope_before],
            missed: [missed, missed_before],
            is_stepwise,
            is_integrated,
        }
    }

    /// Whether an input that is `u` now has jumped since it was noted.
    fn has_jumped(&self, u: f64, d: &[f64]) -> bool {
        let left = d[self.left];
        if self.is_stepwise { u != left } else { (u - left).abs() > JUMP * (u.abs() + left.abs()) }
    }
}

impl Network {
    /// Calls `see` with each input of the members of a circuit: its place, and its cells.
    fn each_input(&self, separate: &Separate, mut see: impl FnMut(usize, InputCells)) {
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            // Amplitude and frequency of an inverter; other parts may have angles, which jump by turns, or derivatives.
            let is_integrated = seat.member.part.separate.is_some();
            for (input, (start, end)) in seat.member.part.inputs.iter().zip(&seat.inputs) {
                let is_stepwise = input.kind.is_some_and(|kind| kind != Kind::Real);
                (*start as usize..*end as usize).for_each(|k| {
                    see(seat.u.start + k, InputCells::new(held, k, is_stepwise, is_integrated));
                });
            }
        }
    }

    /// Whether a circuit has an input that may change within a coupling step otherwise than by jumps.
    pub(crate) fn has_moving_inputs(&self, separate: &Separate) -> bool {
        let mut any = false;
        self.each_input(separate, |_, cells| any |= !cells.is_stepwise);
        any
    }

    /// Notes the inputs of circuits at the end of an accepted step, before anything that is hit there changes them.
    pub(crate) fn note_inputs(&self, c: &Context, d: &mut [f64]) {
        for separate in &self.separate {
            let cells = separate.cells();
            let since = c.t - d[cells.since];
            (d[cells.noted], d[cells.since]) = (c.t, c.t);
            d[cells.cubes] += since.powi(3);
            self.each_input(separate, |input, cells| {
                d[cells.integral] += 0.5 * since * (d[cells.left] + c.u[input]);
                d[cells.left] = c.u[input];
            });
        }
    }

    /// Whether an input of a circuit jumps now, or a parameter changes, within a step of it.
    pub(crate) fn is_cut(&self, separate: &Separate, c: &Context, d: &[f64]) -> bool {
        let cells = separate.cells();
        // At the start, and just behind a hit, nothing has been noted.
        let is_noted = (c.t - d[cells.noted]).abs() <= SAME * separate.step;
        let is_within = is_noted && d[cells.until] > c.t && !separate.is_due(c.t, d);
        let mut any = is_within && d[cells.interrupted] > 0.0;
        if is_within {
            self.each_input(separate, |input, cells| any |= cells.has_jumped(c.u[input], d));
        }
        any
    }

    /// Compares how inputs have gone on in the last coupling step, or part of one, with what was expected, and finds how they will
    /// in the one that begins now. Returns whether one has gone on so differently that the step is to be integrated once more.
    pub(crate) fn meet_inputs(
        &self,
        separate: &Separate,
        c: &Context,
        d: &mut [f64],
        room: &mut Room,
    ) -> bool {
        room.u.clear();
        room.u.extend_from_slice(c.u);
        for courses in [&mut room.courses, &mut room.went] {
            courses.clear();
            courses.resize(c.u.len(), Course::default());
        }
        room.was.clear();
        room.was.extend_from_slice(c.u);
        room.leads = false;
        let is_first = d[separate.times + 1] <= 0.0;
        let is_whole = separate.is_due(c.t, d);
        let (last, cells) = (c.t - d[separate.times], separate.cells());
        let (before, cubes) = (d[cells.span], cells.cubes);
        // Where nothing moves between hits nothing has been noted.
        let is_noted = (c.t - d[cells.noted]).abs() <= SAME * last;
        let mut is_missed = false;
        self.each_input(separate, |input, cells| {
            room.was[input] = d[cells.start];
            if !is_first && is_noted && !cells.is_stepwise && last > 0.0 {
                let [slope, slope_before] = cells.slopes;
                let [missed, missed_before] = cells.missed;
                (d[slope_before], d[missed_before]) = (d[slope], d[missed]);
                d[slope] = (d[cells.left] - d[cells.start]) / last;
                let off = if is_whole { d[cells.left] - d[cells.expected] } else { 0.0 };
                d[missed] = off / last.powi(3);
                let (now, then) = (d[slope], d[slope_before]);
                // A first slope has no other beside it.
                let then = if before > 0.0 { then } else { now };
                let agree = before > 0.0 && (now - then).abs() <= AGREE * now.abs().max(then.abs());
                let bend = if agree { (now - then) / (0.5 * (last + before)) } else { 0.0 };
                let slope = if agree { now + 0.5 * last * bend } else { smaller(now, then) };
                let doubt = smaller(d[missed], d[missed_before]);
                room.went[input] = {
                    // What a parabola has more than the trapezoids under it.
                    let integral = d[cells.integral] - bend * d[cubes] / 12.0;
                    let even = 0.5 * last * (d[cells.start] + d[cells.left]);
                    let bend = 12.0 * (even - integral) / last.powi(3);
                    Course { slope: now - 0.5 * last * bend, bend, doubt: 0.0 }
                };
                room.courses[input] = Course { slope, bend, doubt };
                room.leads |= room.courses[input] != Course::default();
                is_missed |=
                    cells.is_integrated && off.abs() > KINK * (d[cells.start].abs() + d[cells.left].abs());
            }
            (d[cells.start], d[cells.left], d[cells.integral]) = (c.u[input], c.u[input], 0.0);
        });
        (d[cells.since], d[cubes]) = (c.t, 0.0);
        d[cells.interrupted] = 0.0;
        // The inputs of the new step are those of now: whatever has jumped up to now belongs to the step before.
        d[cells.noted] = c.t - self.coupling_step();
        if !is_first && last > 0.0 {
            d[cells.span] = last;
        }
        is_missed
    }

    /// Puts the inputs of a circuit where they are expected to be `s` after the hit at which they were `c.u`.
    pub(crate) fn lead_inputs(&self, separate: &Separate, s: f64, c: &Context, room: &mut Room) {
        if !(room.leads || room.repeats) {
            return;
        }
        let doubt = if room.tries { s * room.step * room.step } else { 0.0 };
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            for input in seat.u.clone() {
                let course = room.courses[input];
                room.u[input] = c.u[input] + course.after(s) + doubt * course.doubt;
            }
        }
    }

    /// Notes where inputs are expected to be at the end of a step that has been integrated.
    pub(crate) fn expect_inputs(&self, separate: &Separate, d: &mut [f64], room: &Room) {
        self.each_input(separate, |input, cells| {
            d[cells.expected] = d[cells.start] + room.courses[input].after(room.step);
        });
    }
}
