//! How the inputs of a circuit go on within a coupling step.
//!
//! The circuit is integrated before the inputs of the step are known. They are taken to go on as they did in the last two steps: a
//! parabola with the mean slopes of both where these agree, else a line with the smaller one, since a jump is not to come again. What
//! an input changes by at the hit itself is no slope: so one that is sampled stays where it is, and one that is the sum of both goes
//! on by the part that moves. That is why the value just before the hit is noted as well.
//!
//! What a circuit makes of its inputs are integrals: an angle of a frequency, fluxes of voltages. So where a step has been integrated
//! with another course than the input took, as about a kink, the next one has what is missing of the integral added.

use blocksim_block::{Context, Input};
use blocksim_signal::Kind;

use crate::electrics::Separate;
use crate::electrics::coupling::smaller;
use crate::network::Network;
use crate::seat::Held;
use crate::work::circuits::Room;

/// Slopes of two steps agree that differ by less than this share of the greater.
const AGREE: f64 = 0.5;

/// By what part of its size an input must have been missed for the integral to be made up: by less it is ripple that comes back, and to
/// answer that would amplify it.
const KINK: f64 = 1e-4;

/// How an input goes on over a coupling step: by `slope` and `bend`, per second and per second squared, and by how much that may be
/// wrong, as a slope per second of the length of the step squared; and what is to be made up for of the last step, times seconds.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Course {
    owed: f64,
    slope: f64,
    bend: f64,
    doubt: f64,
}

impl Course {
    /// By how much an input has changed, `s` after the hit.
    fn after(&self, s: f64) -> f64 {
        s * (self.slope + 0.5 * s * self.bend)
    }

    /// The integral of that.
    fn led(&self, s: f64) -> f64 {
        s * s * (0.5 * self.slope + s * self.bend / 6.0)
    }
}

/// Where it lies for an input what the last steps say of it.
pub(crate) struct InputCells {
    /// At the beginning of the step, at the end of the last step that the solver has accepted, and what was expected there.
    start: usize,
    left: usize,
    expected: usize,
    /// The integral over the step of what was expected to be added to its beginning.
    led: usize,
    /// Mean slopes of the last step and of the one before.
    slopes: [usize; 2],
    /// By how much the value was missed at the ends of both, in units per cube of the length of the step.
    missed: [usize; 2],
    /// The circuit makes an integral of it.
    is_integrated: bool,
}

impl InputCells {
    /// How many cells each input has.
    pub(crate) const COUNT: usize = 8;

    fn new(held: &Held, input: usize, is_integrated: bool) -> Self {
        let [start, left, expected, led, slope, slope_before, missed, missed_before] =
            [0, 1, 2, 3, 4, 5, 6, 7].map(|k| held.inputs.start + Self::COUNT * input + k);
        Self {
            start,
            left,
            expected,
            led,
            slopes: [slope, slope_before],
            missed: [missed, missed_before],
            is_integrated,
        }
    }
}

/// Whether an input may change otherwise than by jumps.
pub(crate) fn may_move(input: &Input) -> bool {
    input.kind != Some(Kind::Bool)
}

impl Network {
    /// Calls `see` with each input of the members of a circuit that is a real number: its place, and its cells.
    fn each_input(&self, separate: &Separate, mut see: impl FnMut(usize, InputCells)) {
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            // Amplitude and frequency of an inverter; other parts may have angles, which jump by turns, or derivatives.
            let is_integrated = seat.member.part.separate.is_some();
            for (input, (start, end)) in seat.member.part.inputs.iter().zip(&seat.inputs) {
                if may_move(input) {
                    (*start as usize..*end as usize)
                        .for_each(|k| see(seat.u.start + k, InputCells::new(held, k, is_integrated)));
                }
            }
        }
    }

    /// Whether a circuit has an input that may change within a coupling step.
    pub(crate) fn has_moving_inputs(&self, separate: &Separate) -> bool {
        let mut any = false;
        self.each_input(separate, |_, _| any = true);
        any
    }

    /// Notes the inputs of circuits at the end of an accepted step, before anything that is hit there changes them.
    pub(crate) fn note_inputs(&self, c: &Context, d: &mut [f64]) {
        for separate in &self.separate {
            d[separate.cells().noted] = c.t;
            self.each_input(separate, |input, cells| d[cells.left] = c.u[input]);
        }
    }

    /// Compares how inputs have gone on in the last coupling step, or part of one, with what was expected, and finds how they will
    /// in the one that begins now.
    pub(crate) fn meet_inputs(&self, separate: &Separate, c: &Context, d: &mut [f64], room: &mut Room) {
        room.u.clear();
        room.u.extend_from_slice(c.u);
        room.courses.clear();
        room.courses.resize(c.u.len(), Course::default());
        room.leads = false;
        let is_first = d[separate.times + 1] <= 0.0;
        let (last, span) = (c.t - d[separate.times], separate.cells().span);
        let before = d[span];
        // Where nothing moves between hits nobody has noted anything.
        let is_noted = (c.t - d[separate.cells().noted]).abs() <= 1e-6 * last;
        self.each_input(separate, |input, cells| {
            if !is_first && is_noted {
                let [slope, slope_before] = cells.slopes;
                let [missed, missed_before] = cells.missed;
                (d[slope_before], d[missed_before]) = (d[slope], d[missed]);
                d[slope] = (d[cells.left] - d[cells.start]) / last;
                d[missed] = (d[cells.left] - d[cells.expected]) / last.powi(3);
                let (now, then) = (d[slope], d[slope_before]);
                // A first slope has no other beside it.
                let then = if before > 0.0 { then } else { now };
                let agree = before > 0.0 && (now - then).abs() <= AGREE * now.abs().max(then.abs());
                let bend = if agree { (now - then) / (0.5 * (last + before)) } else { 0.0 };
                let slope = if agree { now + 0.5 * last * bend } else { smaller(now, then) };
                let doubt = smaller(d[missed], d[missed_before]);
                let took = last * (0.5 * (d[cells.left] - d[cells.start]) - last * last * bend / 12.0);
                let off = (d[cells.left] - d[cells.expected]).abs();
                let is_owed =
                    cells.is_integrated && off > KINK * (d[cells.start].abs() + d[cells.left].abs());
                let owed = if is_owed { took - d[cells.led] } else { 0.0 };
                room.courses[input] = Course { owed, slope, bend, doubt };
                room.leads |= room.courses[input] != Course::default();
            }
            d[cells.start] = c.u[input];
        });
        if !is_first {
            d[span] = last;
        }
    }

    /// Puts the inputs of a circuit where they are expected to be `s` after the hit at which they were `c.u`.
    pub(crate) fn lead_inputs(&self, separate: &Separate, s: f64, c: &Context, room: &mut Room) {
        if !room.leads {
            return;
        }
        let doubt = if room.tries { s * room.step * room.step } else { 0.0 };
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            for input in seat.u.clone() {
                let course = room.courses[input];
                room.u[input] = c.u[input] + course.owed / room.step + course.after(s) + doubt * course.doubt;
            }
        }
    }

    /// Notes where inputs are expected to be at the end of a step that has been integrated.
    pub(crate) fn expect_inputs(&self, separate: &Separate, d: &mut [f64], room: &Room) {
        self.each_input(separate, |input, cells| {
            d[cells.expected] = d[cells.start] + room.courses[input].after(room.step);
            d[cells.led] = room.courses[input].led(room.step);
        });
    }
}
