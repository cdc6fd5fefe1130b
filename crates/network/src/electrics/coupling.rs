//! How a circuit that is integrated by itself and the mechanics fit together: what its torques do to the speeds within a
//! coupling step, means of what it does for those who look at it, whether the speeds came as expected, and what errors remain.

use blocksim_block::Context;
use blocksim_block::physical::{Element, Flowing, Supply};
use blocksim_block::problem::Problem;
use blocksim_solve::linear::cholesky_solve;

use crate::electrics::Separate;
use crate::electrics::repeat::CUT;
use crate::network::Network;
use crate::seat::{ELECTRICS, Held, Seat};
use crate::work::Work;
use crate::work::circuits::Room;

/// Share of the last step in what is remembered of errors.
const FRESH: f64 = 1.0 / 64.0;
/// Errors of the speed in a coupling step, remembered so and relative to the greatest speed so far, that are too large.
const LOOSE: f64 = 0.1;
/// Speeds below this, rad/s, are standstill: what hardly moves may do so as it likes.
const STANDSTILL: f64 = 1.0;

/// Parts of a coupling step, at most.
pub(crate) const MOST_PARTS: f64 = 64.0;
/// What a coupling step may add to the error of a speed or a state, over what the relative tolerance allows of it.
pub(crate) const ALLOWED: f64 = 0.02;
/// Share of the last trial in what is remembered of the errors of divided steps.
pub(crate) const LASTS: f64 = 1.0 / 8.0;
/// Below this share of what is allowed, half as many parts will do: errors of a step fall with the third power of their number.
const SPARE: f64 = 1.0 / 32.0;
/// With such a tolerance coupling steps are divided from the first on, of which nothing is known before.
pub(crate) const STRICT: f64 = 1e-5;
/// Errors of about so many divided steps add up before circuits forget them.
const ADD_UP: f64 = 8.0;

/// How many parts bring an error down from `need` times what is allowed.
pub(crate) fn more_parts(parts: f64, need: f64) -> f64 {
    let wanted = parts * need.cbrt();
    let mut more = 2.0 * parts;
    while more < wanted && more < MOST_PARTS {
        more *= 2.0;
    }
    more.min(MOST_PARTS)
}

/// The smaller of two numbers of one sign, else nothing.
pub(crate) fn smaller(a: f64, b: f64) -> f64 {
    if a * b <= 0.0 {
        0.0
    } else if a.abs() < b.abs() {
        a
    } else {
        b
    }
}

impl Network {
    /// What a torque of each held branch changes about the acceleration of each pin. Accelerations are known.
    pub(crate) fn yields(&self, w: &mut Work, yields: &mut Vec<f64>) {
        let r = &self.rotation;
        let branches = r.branches.len();
        yields.clear();
        yields.resize(r.pins.len() * branches, 0.0);
        for branch in self.separate.iter().flat_map(|separate| self.own_branches(separate)) {
            w.product.fill(0.0);
            r.pins[r.branches[branch]].speed.add_to(-1.0, &mut w.product);
            cholesky_solve(&w.factor, &mut w.product);
            if !w.rows.is_empty() {
                w.schur.impose(&w.rows, &mut w.product, |_| 0.0);
            }
            for (pin, of) in r.pins.iter().enumerate() {
                yields[pin * branches + branch] = of.speed.of(&w.product);
            }
        }
    }

    /// Branches of the members of a circuit.
    pub(crate) fn own_branches<'a>(&'a self, separate: &'a Separate) -> impl Iterator<Item = usize> + 'a {
        separate.members.iter().flat_map(|i| self.seats[*i].branches.clone())
    }

    /// Notes what the torques have been more than the accelerations at the hit know of, until `s` after the hit.
    pub(crate) fn kick(&self, s: f64, room: &mut Room) {
        self.kick_within(s, 0.0, room);
    }

    /// The same within a step of the integrator that began `s` after the hit, this much later, with the last torques found.
    pub(crate) fn kick_within(&self, s: f64, later: f64, room: &mut Room) {
        for branch in room.own.iter().copied() {
            let mut kick = room.mean[branch] - s * room.base[branch];
            if later > 0.0 {
                kick += later * (room.torque[branch].value - room.base[branch]);
            }
            room.kick[branch] = kick;
        }
    }

    /// Adds what is measured now to the sums for the means.
    pub(crate) fn average(&self, separate: &Separate, weight: f64, w: &Work, room: &mut Room) {
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            let sums = &mut room.average[held.mean.clone()];
            let supply = seat.supply.map_or([0.0; 3], |slot| {
                let Supply { voltage: [d, q], zero, .. } = w.supply[slot];
                [d, q, zero]
            });
            let x = match seat.shifted {
                Some(at) => &w.own[at..at + seat.x.len()],
                None => &room.d[seat.x.clone()],
            };
            let now = x
                .iter()
                .chain(&w.voltage[seat.two_pins.clone()])
                .chain(&w.current[seat.two_pins.clone()])
                .chain(&supply);
            sums.iter_mut().zip(now).for_each(|(sum, now)| *sum += weight * now);
        }
    }

    /// Lets a member of such a circuit measure what needs voltages: on the mean of a coupling step. Its currents are those of the instant;
    /// `instant` has room for them.
    pub(crate) fn measure_mean(
        &self,
        c: &Context,
        (seat, held): (&Seat, &Held),
        w: &Work,
        instant: &mut [f64],
        y: &mut [f64],
    ) {
        let law = self.flowing_law(c, seat, w);
        let elements = &seat.member.part.elements;
        let reads_currents = elements.iter().all(|e| matches!(e, Element::CurrentProbe { .. }));
        seat.measure_flowing(&law, ELECTRICS, y);
        // Before the first step there is nothing to be averaged.
        if c.d[held.times + 1] <= 0.0 || reads_currents {
            return;
        }
        held.instants.iter().zip(&mut *instant).for_each(|(&cell, now)| *now = y[cell]);
        let means = &c.d[held.mean.clone()];
        let (x, rest) = means.split_at(seat.x.len());
        let (voltage, rest) = rest.split_at(seat.two_pins.len());
        let (current, supply) = rest.split_at(seat.two_pins.len());
        let supply = Supply { voltage: [supply[0], supply[1]], zero: supply[2], ..*law.supply };
        let mut mean = Flowing { voltage, current, ..law };
        (mean.x, mean.supply) = (x, &supply);
        seat.measure_flowing(&mean, ELECTRICS, y);
        held.instants.iter().zip(instant).for_each(|(&cell, now)| y[cell] = *now);
    }

    /// In how many parts a circuit is to take the coupling step that begins now, by what the last ones have shown.
    pub(crate) fn wanted_parts(&self, separate: &Separate, tries: bool, d: &mut [f64]) -> f64 {
        let cells = separate.cells();
        let (before, rtol) = (d[cells.parts].max(1.0), d[cells.rtol]);
        if rtol == 0.0 {
            return 1.0;
        }
        if self.threatens(separate, 0.0, d) {
            d[cells.least] = d[cells.least].max(2.0);
        }
        let mut parts = before.max(d[cells.least]);
        if tries {
            if d[cells.need] < SPARE {
                parts = (0.5 * parts).max(d[cells.least]).max(1.0);
            }
            d[cells.need] = 0.0;
            d[cells.outlasts] = 0.0;
        }
        parts
    }

    /// Whether the errors of speeds so far, with one more of a step, pass the tolerance; until then coupling steps stay whole.
    pub(crate) fn threatens(&self, separate: &Separate, more: f64, d: &[f64]) -> bool {
        let rtol = d[separate.cells().rtol];
        let so_far = self.coupling_error(separate, d).map_or(0.0, |(error, _)| error);
        rtol > 0.0 && so_far.max(more) > rtol
    }

    /// Doubts half of what the speeds have changed in the step at hand.
    pub(crate) fn doubt_all(&self, separate: &Separate, w: &Work, room: &mut Room) {
        for pin in separate.members.iter().flat_map(|i| self.seats[*i].pins.clone()) {
            room.doubt[pin] = 0.5 * (w.pin_speed[pin] - room.speed[pin]);
        }
    }

    /// Takes down how the bends of the last two steps look in one that is shorter by this ratio of numbers of parts.
    pub(crate) fn rescale(&self, separate: &Separate, ratio: f64, d: &mut [f64]) {
        if ratio != 1.0 {
            for held in separate.members.iter().filter_map(|i| self.seats[*i].held.as_ref()) {
                for cell in held.bent.clone().chain(held.bent_before.clone()) {
                    d[cell] *= ratio * ratio;
                }
            }
        }
    }

    /// Notes in the working space how the speeds are expected to bend in a step that is shorter than the last one by this ratio:
    /// as in the last one, unless the one before says less or the contrary, since an impact is not to come again.
    pub(crate) fn foresee(&self, separate: &Separate, ratio: f64, d: &[f64], room: &mut Room) {
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            for (k, pin) in seat.pins.clone().enumerate() {
                let (last, before) = (d[held.bent.start + k], d[held.bent_before.start + k]);
                let bend = smaller(last, before);
                room.bend[pin] = ratio * ratio * bend;
                room.doubt[pin] = ratio * ratio * (2.0 * last - before - bend);
            }
        }
    }

    /// The greatest difference between a step and its trial, of a speed, of a state of a member, and of one of a member that gives torques,
    /// relative to their size.
    pub(crate) fn missed_by_step(&self, separate: &Separate, w: &Work, room: &Room, d: &[f64]) -> [f64; 3] {
        let branches = room.mean.len();
        let [mut speed, mut state, mut acting] = [0.0_f64; 3];
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            let expected = seat.pins.clone().map(|pin| w.pin_speed[pin].abs());
            let size = expected.fold(d[held.missed + 1].max(STANDSTILL), f64::max);
            for pin in seat.pins.clone() {
                let of = |b: usize| room.yields[pin * branches + b] * (room.trial[b] - room.mean[b]);
                speed = speed.max(self.own_branches(separate).map(of).sum::<f64>().abs() / size);
            }
            let part = &seat.member.part;
            let states = || {
                seat.x.clone().enumerate().filter(|(k, _)| !part.drifting.contains(k)).map(|(_, cell)| cell)
            };
            // What is let go of within a step is small at its end, and no measure of itself.
            let size = states().fold(0.0, |most: f64, cell| most.max(room.largest[cell]));
            let off =
                states().fold(0.0, |most: f64, cell| most.max((room.trial_d[cell] - room.d[cell]).abs()));
            if size > 0.0 {
                state = state.max(off / size);
                if !seat.branches.is_empty() {
                    acting = acting.max(off / size);
                }
            }
        }
        [speed, state, acting]
    }

    /// Whether the speeds have come as they were expected in the last step, of which a coupling step has had so many; else there are
    /// to be more of them, and where there may be no more the run ends with an error. Notes how the speeds have bent.
    pub(crate) fn meets(
        &self,
        separate: &Separate,
        c: &Context,
        parts: f64,
        d: &mut [f64],
        room: &mut Room,
    ) -> bool {
        let cells = separate.cells();
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            if d[held.times + 1] <= 0.0 || held.expected.is_empty() {
                continue;
            }
            let expected = &d[held.expected.clone()];
            let speeds = || room.speed[seat.pins.clone()].iter().zip(expected);
            let so_far = d[held.missed + 1];
            let size = speeds()
                .fold(so_far, |most: f64, (found, expected)| most.max(found.abs()).max(expected.abs()));
            let off = speeds().fold(0.0, |most: f64, (found, expected)| most.max((found - expected).abs()));
            let share = off / size.max(STANDSTILL);
            // What is left of a step that was cut says little of how the next one bends.
            let pins = if d[cells.cut] == CUT { 0..0 } else { seat.pins.clone() };
            for (k, pin) in pins.enumerate() {
                let (last, before) = (held.bent.start + k, held.bent_before.start + k);
                let bent = room.speed[pin] - d[held.expected.start + k] + smaller(d[last], d[before]);
                (d[before], d[last]) = (d[last], bent);
            }
            d[held.missed + 1] = size;
            d[held.missed] += FRESH * (share - d[held.missed]);
            if d[held.missed] > LOOSE {
                let least = parts.max(d[cells.least]);
                if d[cells.rtol] > 0.0 && least < MOST_PARTS {
                    d[cells.least] = 2.0 * least;
                    d[held.missed] = 0.0;
                    continue;
                }
                let step = self.coupling_step() / parts;
                c.fail(format!(
                    "at {} s the speed of `{}` is off by {off:.2e} rad/s from what its circuit expected, and has been by \
                     {:.1} % of late: the coupling step of {step:.1e} s is too long for so little inertia; write \
                     `integration: Together`, or fewer periods",
                    c.t,
                    seat.member.path,
                    100.0 * d[held.missed],
                ));
                return false;
            }
        }
        true
    }

    /// Adds up what the coupling does to the speeds, after the step has been kept. Each step adds by how much the trial and the step
    /// itself differ (those that are not tried, as much as the last that was). The straight line that the mechanics sees has not the
    /// moment of the torque, above all of its ripple: that is an error of the mean speed in the step, of which a load takes as much
    /// into the speed itself as it bends it, and by the same share forgets errors. A mere inertia does neither.
    pub(crate) fn note_error(&self, separate: &Separate, tried: bool, w: &Work, room: &Room, d: &mut [f64]) {
        let (branches, step, cells) = (room.mean.len(), room.step, separate.cells());
        // Parts at different places of a period have different errors: the mean of them stands for each.
        let place = d[cells.parts] - d[cells.left];
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            for (k, pin) in seat.pins.clone().enumerate() {
                let (mut own, mut lag) = (0.0, 0.0);
                for other in separate.members.iter().map(|i| &self.seats[*i]) {
                    let rises = other.held.iter().flat_map(|held| held.course.clone());
                    for (branch, rise) in other.branches.clone().zip(rises) {
                        let yields = room.yields[pin * branches + branch];
                        if tried {
                            own += yields * (room.trial[branch] - room.mean[branch]);
                        }
                        lag += yields * (room.moment[branch] / step - d[rise] * step / 6.0);
                    }
                }
                let [of_step, error, most, bent, turned] = Held::errors(held, k);
                if tried {
                    d[of_step] = if place == 1.0 { own } else { d[of_step] + (own - d[of_step]) / place };
                }
                d[bent] += FRESH * (d[held.bent.start + k].abs() - d[bent]);
                d[turned] += FRESH * (0.5 * (w.pin_speed[pin] - room.speed[pin]).abs() - d[turned]);
                let share = if d[bent] < d[turned] { d[bent] / d[turned] } else { 1.0 };
                d[error] += if tried { own } else { d[of_step] } + share * (lag - d[error]);
                d[most] = d[most].max(d[error].abs());
            }
        }
    }

    /// The greatest error of a speed of a circuit so far by its coupling, relative to the greatest speed, and whose it is.
    fn coupling_error<'a>(&'a self, separate: &'a Separate, d: &[f64]) -> Option<(f64, &'a Seat)> {
        let error_of = |seat: &Seat| {
            let held = seat.held.as_ref()?;
            let most = (0..seat.pins.len()).map(|pin| d[Held::errors(held, pin)[2]]).fold(0.0, f64::max);
            Some(most / d[held.missed + 1].max(STANDSTILL))
        };
        let seats = separate.members.iter().map(|i| &self.seats[*i]);
        seats.filter_map(|seat| Some((error_of(seat)?, seat))).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Where the coupling of a circuit and the mechanics has missed the tolerance.
    pub(crate) fn coupling_warnings(&self, d: &[f64], rtol: f64) -> Vec<Problem> {
        let warning = |separate: &Separate| {
            let seats = || separate.members.iter().map(|i| &self.seats[*i]);
            let cells = separate.cells();
            let (error, worst) = self.coupling_error(separate, d)?;
            // Parts are so short that what they do to the states of the circuit outlasts them.
            let error = error.max(ADD_UP * ALLOWED * d[cells.most] * d[cells.rtol]);
            if error <= rtol {
                return None;
            }
            let asks = seats().find(|seat| seat.member.part.separate.is_some()).unwrap_or(worst);
            let step = self.coupling_step() / d[cells.parts].max(1.0);
            let message = format!(
                "the coupling of `{}` with the mechanics misses the tolerance: with coupling steps of {step:.2e} s the speed \
                 of `{}` is off by about {error:.0e} of its maximum, {:.0} times rtol ({rtol:.0e})",
                asks.member.path,
                worst.member.path,
                error / rtol,
            );
            Some(Problem::warning("coupling_error", message).help(
                "write `integration: Together`, or shorten the step: fewer `periods`, or a higher switching frequency",
            ))
        };
        self.separate.iter().filter_map(warning).collect()
    }
}
