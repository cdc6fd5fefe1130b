//! Circuits that switch much faster than the mechanics moves, integrated by the network itself.
//!
//! At each hit of the coupling step `H` the network integrates such a circuit from `t` to `t + H`, from edge to edge,
//! each of which is hit exactly, at the speeds that are expected: `w(t) + w'(t) s`, and what the torques of the circuit itself
//! change about them through the inertia that they see. The mechanics is then integrated by the solver with a simple course of
//! each torque over the step that has exactly its impulse.
//!
//! The order of the coupling is three. What a load does to the speeds within a step is taken from the last steps, so that speeds
//! are predicted with an error of `H^3`, and torques are wrong by as much. The mechanics gets a torque that is a straight line over
//! the step, with the mean of the true one, and rises as the means do from step to step. What it leaves out is the ripple of the
//! valves, whose moment is an error of the angle of order two; the line of its own moment would put it into every reading of a
//! torque. Between edges Runge-Kutta of order four is used, in steps that are short against what is fastest in the circuit.
//!
//! Inputs go on as they did in the last steps, see `inputs.rs`, and where they do not, see `repeat.rs`. Outputs that need voltages show
//! means over the step, since an instant of a circuit that switches says little; currents, fluxes and states show its beginning.
//!
//! Where the speeds turn out to be others than were expected, coupling steps are too long; see `coupling.rs`. What that does to
//! the torques is found by trial: a coupling step is integrated once more, with the speeds bent as the last two steps together say.
//! Where the trial misses what the tolerance of the run allows, the coupling step is divided, by a power of two: it begins anew in
//! parts, each with the speeds as the mechanics has made them by then. Torques and the slopes of loads have no jumps at edges, so
//! that the parts need not know of these. The line of a part has the moment of the torque besides its impulse, because the ripple is
//! then what is wanted. Means for those who look are of whole coupling steps as ever, known when the last part is.

use std::ops::Range;

use blocksim_block::Context;
use blocksim_block::physical::Torque;

use crate::electrics::coupling::{ALLOWED, LASTS, MOST_PARTS, STRICT, more_parts};
use crate::electrics::currents::Faulty;
use crate::electrics::repeat::CUT;
use crate::electrics::{Separate, Shift};
use crate::network::Network;
use crate::work::Work;
use crate::work::circuits::Room;

/// Steps of the integrator in a coupling step, at least, and in a part of one.
const LEAST: f64 = 4.0;
const LEAST_OF_PART: f64 = 2.0;

/// Parts of the very first one, in which it is not known how inputs move.
const FIRST_PARTS: f64 = 16.0;

/// What part of a coupling step is an instant; and what part of the time since the start, which is long against it.
const INSTANT: f64 = 1e-9;
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// By what part of itself the fastest part of a circuit may change in a step of the integrator, at most and at least; beyond 2.8 the steps
/// would be unstable. What swings loses a part of the fourth power of that over this in a radian.
const FAST: f64 = 1.0;
const FINE: f64 = 0.05;
const OF_FOURTH: f64 = 120.0;
/// Changes of states within a step below this part of them say nothing of how fast they are.
const SLIGHT: f64 = 1e-9;
/// Steps of the integrator from edge to edge, at most.
const MOST_STEPS: f64 = 1e5;

/// Every so many coupling steps the error is estimated, and in the first ones always, where a drive starts.
const EVERY: f64 = 16.0;
const EARLY: f64 = 64.0;

/// Edges within a coupling step that are taken for chatter.
const CHATTER: usize = 10_000;

impl Network {
    /// One step for all, so that they stay together on the grid of the hits.
    pub(crate) fn coupling_step(&self) -> f64 {
        self.separate.iter().map(|separate| separate.step).fold(f64::INFINITY, f64::min)
    }

    /// Integrates all separate circuits over the coupling step that begins now.
    pub(crate) fn couple(&self, c: &Context, w: &mut Work, d: &mut [f64]) {
        let mut room = std::mem::take(&mut w.room);
        copy(&mut room.d, d);
        {
            let here = Context { d: &room.d, ..*c };
            self.motion_phase(&here, w);
            self.inner_torques(w);
        }
        copy(&mut room.speed, &w.pin_speed);
        copy(&mut room.acceleration, &w.pin_acceleration);
        self.yields(w, &mut room.yields);
        room.average.clear();
        room.average.resize(d.len(), 0.0);
        room.base.clear();
        room.base.extend(w.torque.iter().map(|torque| torque.value));
        room.bend.clear();
        room.bend.resize(self.rotation.pins.len(), 0.0);
        room.doubt.clear();
        room.doubt.resize(self.rotation.pins.len(), 0.0);
        for separate in &self.separate {
            let done = if separate.is_due(c.t, d) {
                self.couple_one(separate, c, w, &mut room, d)
            } else if self.is_cut(separate, c, d) {
                self.cut(separate, c, w, &mut room, d)
            } else {
                Ok(())
            };
            if done.is_err() {
                break;
            }
        }
        w.room = room;
        // Speeds and circuits in the working space are those of another time now.
        w.evaluation = [u64::MAX; 3];
        w.held_evaluation = u64::MAX;
    }

    /// Integrates a circuit over the coupling step that begins now, or over the next part of the present one.
    fn couple_one(
        &self,
        separate: &Separate,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
        d: &mut [f64],
    ) -> Result<(), Faulty> {
        let (cells, whole) = (separate.cells(), self.coupling_step());
        let (begins, before) = (d[cells.left] == 0.0, d[cells.parts].max(1.0));
        room.own.clear();
        room.own.extend(self.own_branches(separate));
        if self.meet_inputs(separate, c, d, room) {
            self.repeat(separate, c, w, room, d)?;
            self.forget_means(separate, room);
        } else {
            self.settle(separate, d);
        }
        if !self.meets(separate, c, before, d, room) {
            return Err(Faulty);
        }
        d[cells.cut] = (d[cells.cut] - 1.0).max(0.0);
        let number = if begins { (c.t / whole).round() } else { (c.t / whole + 1e-6).floor() };
        let tries = is_tried(number);
        let is_first = d[separate.times + 1] <= 0.0;
        if is_first && d[cells.rtol] > 0.0 && d[cells.rtol] <= STRICT {
            d[cells.least] = 2.0;
        }
        let mut parts = if begins { self.wanted_parts(separate, tries, d) } else { before };
        if is_first && d[cells.rtol] > 0.0 && self.has_moving_inputs(separate) {
            parts = FIRST_PARTS;
        }
        loop {
            room.step = if parts > 1.0 { whole / parts } else { whole };
            room.is_part = parts > 1.0;
            self.foresee(separate, before / parts, d, room);
            self.give(separate, d, room);
            if !tries {
                self.over(separate, c, w, room, d)?;
                break;
            }
            if is_first && d[cells.least] > 1.0 {
                // No step before tells how loads bend the speeds: they may take a good part of what the torques give.
                self.over(separate, c, w, room, d)?;
                self.doubt_all(separate, w, room);
                self.forget_means(separate, room);
            }
            self.trial(separate, c, w, room, d)?;
            self.over(separate, c, w, room, d)?;
            let [speed, state, acting] = self.missed_by_step(separate, w, room, d).map(|error| parts * error);
            if begins && self.threatens(separate, speed, d) {
                d[cells.least] = d[cells.least].max(2.0);
            }
            let over = |error: f64| if d[cells.rtol] > 0.0 { error / (ALLOWED * d[cells.rtol]) } else { 0.0 };
            let (need, outlasts) = (over(speed.max(state)), over(speed.max(acting)));
            if begins && need > 1.0 && d[cells.least] > 1.0 && parts < MOST_PARTS {
                parts = more_parts(parts, need);
                self.forget_means(separate, room);
                continue;
            }
            d[cells.need] = d[cells.need].max(need);
            d[cells.outlasts] = d[cells.outlasts].max(outlasts);
            break;
        }
        if begins {
            self.rescale(separate, before / parts, d);
            d[cells.parts] = parts;
            d[cells.left] = parts;
        }
        d[cells.left] -= 1.0;
        d[cells.until] = c.t + room.step;
        // A line through the means of parts would follow the ripple, and one behind a cut what has been owed.
        let own_moment = room.is_part || before > 1.0 || d[cells.cut] > 0.0;
        if tries && d[cells.left] == 0.0 && parts > 1.0 {
            d[cells.lasting] += LASTS * (d[cells.outlasts] - d[cells.lasting]);
            d[cells.most] = d[cells.most].max(d[cells.lasting]);
        }
        self.end(separate, own_moment, w, room, d);
        self.expect_inputs(separate, d, room);
        self.note_error(separate, tries, w, room, d);
        Ok(())
    }

    /// When a circuit takes the next part of its coupling step: now, where an input jumps within one.
    pub(crate) fn next_part(&self, c: &Context) -> f64 {
        let time = |separate: &Separate| {
            let cells = separate.cells();
            if self.is_cut(separate, c, c.d) {
                c.t
            } else if c.d[cells.left] > 0.0 {
                c.d[cells.until]
            } else {
                f64::INFINITY
            }
        };
        self.separate.iter().map(time).fold(f64::INFINITY, f64::min)
    }

    /// Integrates a circuit over the step at hand, which begins now, on the copy of the discrete states in `room`.
    pub(crate) fn over(
        &self,
        separate: &Separate,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
        d: &[f64],
    ) -> Result<(), Faulty> {
        self.begin(separate, c.t, d, &mut room.d);
        self.advance(separate, c, w, room)
    }

    /// The same in twice as many steps of the integrator, with the doubt about the speeds added: what this changes about the torques
    /// is the error of the coupling and of the integrator.
    fn trial(
        &self,
        separate: &Separate,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
        d: &[f64],
    ) -> Result<(), Faulty> {
        room.tries = true;
        self.forget_means(separate, room);
        let done = self.over(separate, c, w, room, d);
        room.tries = false;
        let Room { trial, trial_d, mean, .. } = room;
        copy(trial, mean);
        copy(trial_d, &room.d);
        self.forget_means(separate, room);
        done
    }

    pub(crate) fn forget_means(&self, separate: &Separate, room: &mut Room) {
        let helds = separate.members.iter().filter_map(|i| self.seats[*i].held.as_ref());
        helds.for_each(|held| room.average[held.mean.clone()].fill(0.0));
    }

    /// What was the end of the last step is the beginning of this one. Only the states of a circuit change while it is integrated.
    fn begin(&self, separate: &Separate, t: f64, from: &[f64], d: &mut [f64]) {
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            if let Some(held) = &seat.held {
                d[seat.x.clone()].copy_from_slice(&from[held.x_end.clone()]);
                d[seat.d.clone()].copy_from_slice(&from[held.d_end.clone()]);
            }
        }
        d[separate.times] = t;
        // While the step is worked out, everything looks at its beginning.
        d[separate.times + 1] = f64::INFINITY;
    }

    /// Keeps what the integration has found: the beginning stays what it was, the end is new.
    pub(crate) fn end(&self, separate: &Separate, own_moment: bool, w: &Work, room: &Room, d: &mut [f64]) {
        let t = room.d[separate.times];
        let (step, cells) = (room.step, separate.cells());
        let is_first = d[separate.times + 1] <= 0.0;
        let is_cut = d[cells.cut] == CUT;
        let (starts, ends) = (d[cells.left] == d[cells.parts] - 1.0 && !is_cut, d[cells.left] == 0.0);
        d[separate.times] = t;
        // An instant early: at the next hit the end is what holds.
        d[separate.times + 1] = t + step - instant(step, t + step);
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            d.copy_within(held.x_end.clone(), seat.x.start);
            d.copy_within(held.d_end.clone(), seat.d.start);
            d[held.x_end.clone()].copy_from_slice(&room.d[seat.x.clone()]);
            d[held.d_end.clone()].copy_from_slice(&room.d[seat.d.clone()]);
            for (k, branch) in seat.branches.clone().enumerate() {
                let [mean, rise, given] =
                    [&held.torque, &held.course, &held.given].map(|cells| cells.start + k);
                d[given] = room.given[branch];
                let last = std::mem::replace(&mut d[mean], (room.mean[branch] + room.given[branch]) / step);
                d[rise] = if own_moment {
                    6.0 * room.moment[branch] / (step * step)
                } else {
                    0.5 * (d[mean] - last)
                };
            }
            for ((mean, sum), before) in held.mean.clone().zip(held.sum.clone()).zip(held.sum_before.clone())
            {
                d[before] = if starts { 0.0 } else { d[sum] };
                d[sum] = room.average[mean] + d[before];
                if ends {
                    d[mean] = d[sum] / self.coupling_step();
                } else if is_first {
                    d[mean] = room.average[mean] / step;
                }
            }
            d[held.struck.clone()].fill(0.0);
            d[held.expected.clone()].copy_from_slice(&w.pin_speed[seat.pins.clone()]);
            d[held.speed.clone()].copy_from_slice(&room.speed[seat.pins.clone()]);
            d[held.acceleration.clone()].copy_from_slice(&room.acceleration[seat.pins.clone()]);
        }
    }

    /// From edge to edge.
    pub(crate) fn advance(
        &self,
        separate: &Separate,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
    ) -> Result<(), Faulty> {
        let step = room.step;
        let end = c.t + step;
        let least = if room.is_part { LEAST_OF_PART } else { LEAST };
        room.mean.clear();
        room.mean.resize(self.rotation.branches.len(), 0.0);
        room.torque.resize(self.rotation.branches.len(), Torque::default());
        room.moment.clear();
        room.moment.resize(self.rotation.branches.len(), 0.0);
        room.kick.clear();
        room.kick.resize(self.rotation.branches.len(), 0.0);
        room.pace = 0.0;
        room.largest.resize(room.d.len(), 0.0);
        for cell in separate.members.iter().flat_map(|i| self.seats[*i].x.clone()) {
            room.largest[cell] = room.d[cell].abs();
        }
        let mut t = c.t;
        self.expect(separate, 0.0, c, w, room);
        self.circuit(separate.island, &Context { t, d: &room.d, u: &room.u, ..*c }, w)?;
        for _ in 0..CHATTER {
            let next = self.switch(separate, t, c, w, room)?;
            // An edge at the end belongs to the next step, with the inputs of that.
            let until = if next < end - instant(step, end) { next } else { end };
            let steps = ((until - t) / step * least).ceil().max(1.0);
            self.pass(separate, t..until, steps, c, w, room)?;
            t = until;
            if t >= end {
                return Ok(());
            }
        }
        c.fail(format!(
            "more than {CHATTER} edges in a coupling step of {step} s: is the switching frequency right?"
        ));
        Err(Faulty)
    }

    /// Integrates from one edge to the next in so many steps, or more where the circuit is too fast for them.
    fn pass(
        &self,
        separate: &Separate,
        way: Range<f64>,
        steps: f64,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
    ) -> Result<(), Faulty> {
        let (fine, most) = (fineness(room), self.most_change(separate, room));
        let wanted = |left: f64, pace: f64| (left * pace / most).ceil();
        let mut steps = (fine * steps).max(wanted(way.end - way.start, room.pace));
        let (mut begin, mut done) = (way.start, 0.0);
        let mut h = (way.end - begin) / steps;
        self.average(separate, 0.5 * h, w, room);
        while done < steps {
            let from = begin + done * h;
            if let Some(pace) = self.runge_kutta(separate, from, h, c, w, room)? {
                room.pace = room.pace.max(pace);
                let left = way.end - from;
                steps = wanted(left, pace).max(steps - done + 1.0);
                if steps > MOST_STEPS {
                    c.fail(self.too_fast(separate, from, pace));
                    return Err(Faulty);
                }
                self.expect(separate, from - c.t, c, w, room);
                self.circuit(separate.island, &Context { t: from, d: &room.d, u: &room.u, ..*c }, w)?;
                // This point has had the weight of the longer step.
                self.average(separate, 0.5 * (left / steps - h), w, room);
                (begin, done, h) = (from, 0.0, left / steps);
                continue;
            }
            done += 1.0;
            for cell in separate.members.iter().flat_map(|i| self.seats[*i].x.clone()) {
                room.largest[cell] = room.largest[cell].max(room.d[cell].abs());
            }
            self.kick(from + h - c.t, room);
            self.expect(separate, from + h - c.t, c, w, room);
            let here = Context { t: from + h, d: &room.d, u: &room.u, ..*c };
            self.circuit(separate.island, &here, w)?;
            self.average(separate, if done == steps { 0.5 * h } else { h }, w, room);
        }
        Ok(())
    }

    /// By what part of itself the circuit may change in a step, so that what swings keeps the tolerance of the run.
    fn most_change(&self, separate: &Separate, room: &Room) -> f64 {
        let rtol = room.d[separate.cells().rtol];
        let kept = if rtol > 0.0 { (OF_FOURTH * rtol).sqrt().sqrt().clamp(FINE, FAST) } else { FAST };
        kept / fineness(room)
    }

    fn too_fast(&self, separate: &Separate, t: f64, pace: f64) -> String {
        let mut seats = separate.members.iter().map(|i| &self.seats[*i]);
        let path =
            seats.find(|seat| seat.member.part.separate.is_some()).map_or("", |seat| &*seat.member.path);
        format!(
            "at {t} s something in the circuit of `{path}` changes within {:.0e} s, which is too fast for `integration: Separate`: write \
             `integration: Together`, or make slower what is so fast, such as a coil in series with an open switch of small `g_off`",
            1.0 / pace
        )
    }

    /// How fast the circuit changes, 1/s, by the first three slopes of a step of this length: how much slopes differ where states do, each
    /// against the size of the states of its member (L. F. Shampine, K. L. Hiebert, *Detecting stiffness with the Fehlberg (4, 5) formulas*,
    /// 1977).
    fn pace(&self, separate: &Separate, h: f64, room: &Room) -> f64 {
        let (mut bend, mut turn) = (0.0, 0.0);
        let mut next = 0;
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let own = next..next + seat.x.len();
            next = own.end;
            let moved = |i: usize| room.start[i].abs().max(h * room.first[i].abs());
            let size = own.clone().map(moved).fold(0.0, f64::max);
            if size == 0.0 {
                continue;
            }
            let share = 1.0 / size;
            for i in own {
                bend += (share * (room.second[i] - room.first[i])).powi(2);
                turn += (share * (room.slope[i] - room.second[i])).powi(2);
            }
        }
        let moved = 0.5 * h * bend.sqrt();
        if moved > SLIGHT { turn.sqrt() / moved } else { 0.0 }
    }

    /// Lets the members of a circuit, which is known, change at an instant; returns the next instant at which one does.
    fn switch(
        &self,
        separate: &Separate,
        t: f64,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
    ) -> Result<f64, Faulty> {
        let mut changed = false;
        for seat in separate.members.iter().map(|i| &self.seats[*i]).filter(|s| s.member.part.jumps) {
            let Some(component) = seat.component() else { continue };
            let mut x = std::mem::take(&mut room.start);
            let mut memory = std::mem::take(&mut room.slope);
            copy(&mut x, &room.d[seat.x.clone()]);
            copy(&mut memory, &room.d[seat.d.clone()]);
            let here = Context { t, d: &room.d, u: &room.u, ..*c };
            changed |= component.jump(&self.flowing_law(&here, seat, w), &mut x, &mut memory);
            room.d[seat.x.clone()].copy_from_slice(&x);
            room.d[seat.d.clone()].copy_from_slice(&memory);
            (room.start, room.slope) = (x, memory);
        }
        let here = Context { t, d: &room.d, u: &room.u, ..*c };
        if changed {
            self.circuit(separate.island, &here, w)?;
        }
        let seats = separate.members.iter().map(|i| &self.seats[*i]).filter(|s| s.member.part.time_events);
        let times = seats.filter_map(|s| Some(s.component()?.next_event(&self.known_law(&here, s))));
        Ok(times.fold(f64::INFINITY, f64::min))
    }

    /// Expected speeds and inputs, `s` after the hit.
    fn expect(&self, separate: &Separate, s: f64, c: &Context, w: &mut Work, room: &mut Room) {
        self.lead_inputs(separate, s, c, room);
        let (part, branches) = (s / room.step, room.mean.len());
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            for pin in seat.pins.clone() {
                let mut speed = room.speed[pin] + s * room.acceleration[pin];
                if !room.repeats {
                    let yields = &room.yields[pin * branches..(pin + 1) * branches];
                    let own = room.own.iter().map(|b| yields[*b] * (room.kick[*b] + part * room.given[*b]));
                    speed += own.sum::<f64>();
                }
                let bend = room.bend[pin] + if room.tries { room.doubt[pin] } else { 0.0 };
                w.pin_speed[pin] = speed + bend * (part * part);
            }
        }
    }

    /// One step of the classical method of order four; torques are averaged with the weights of Simpson's rule, which
    /// are its own. Where the circuit is too fast for the step all is left as it was; returned is how fast it is then.
    fn runge_kutta(
        &self,
        separate: &Separate,
        t: f64,
        h: f64,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
    ) -> Result<Option<f64>, Faulty> {
        let states = || separate.members.iter().map(|i| self.seats[*i].x.clone());
        room.start.clear();
        states().for_each(|x| room.start.extend_from_slice(&room.d[x]));
        room.sum.clear();
        room.sum.resize(room.start.len(), 0.0);
        room.slope.clear();
        room.slope.resize(room.start.len(), 0.0);
        room.gained.clear();
        room.gained.resize(self.rotation.branches.len(), 0.0);
        copy(&mut room.moment_before, &room.moment);
        for (stage, (part, weight)) in
            [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)].into_iter().enumerate()
        {
            let mut i = 0;
            for x in states() {
                for cell in x {
                    room.d[cell] = room.start[i] + part * h * room.slope[i];
                    i += 1;
                }
            }
            self.kick_within(t - c.t, part * h, room);
            self.expect(separate, t + part * h - c.t, c, w, room);
            self.slopes(separate, t + part * h, c, w, room)?;
            match stage {
                0 => copy(&mut room.first, &room.slope),
                1 => copy(&mut room.second, &room.slope),
                2 => {
                    let pace = self.pace(separate, h, room);
                    if pace * h > self.most_change(separate, room) {
                        let cells = states().flatten();
                        cells.zip(&room.start).for_each(|(cell, start)| room.d[cell] = *start);
                        copy(&mut room.moment, &room.moment_before);
                        return Ok(Some(pace));
                    }
                }
                _ => {}
            }
            room.sum.iter_mut().zip(&room.slope).for_each(|(sum, slope)| *sum += weight * slope);
            for seat in separate.members.iter().map(|i| &self.seats[*i]) {
                let middle = t + part * h - c.t - 0.5 * room.step;
                for branch in seat.branches.clone() {
                    let gained = weight * h / 6.0 * room.torque[branch].value;
                    room.gained[branch] += gained;
                    room.moment[branch] += gained * middle;
                }
            }
        }
        for branch in &room.own {
            room.mean[*branch] += room.gained[*branch];
        }
        let mut i = 0;
        for x in states() {
            for cell in x {
                room.d[cell] = room.start[i] + h / 6.0 * room.sum[i];
                i += 1;
            }
        }
        Ok(None)
    }

    /// Derivatives and torques at a trial point.
    fn slopes(
        &self,
        separate: &Separate,
        t: f64,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
    ) -> Result<(), Faulty> {
        let here = Context { t, d: &room.d, u: &room.u, ..*c };
        // Between two edges of ideal legs the voltages of the windings stay.
        if !(self.electrics.islands[separate.island].holds && w.circuits[separate.island].is_stiff()) {
            self.circuit(separate.island, &here, w)?;
        }
        let mut i = 0;
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(component) =
                seat.component().filter(|_| !(seat.x.is_empty() && seat.branches.is_empty()))
            else {
                continue;
            };
            let law = self.flowing_law(&here, seat, w);
            if !seat.x.is_empty() {
                component.derivatives(&law, &mut room.slope[i..i + seat.x.len()]);
                if seat.shifted.is_some() {
                    let shifts = &self.electrics.islands[separate.island].shifts;
                    let of_seat = |shift: &&Shift| std::ptr::eq(&self.seats[shift.member], seat);
                    for shift in shifts.iter().filter(of_seat) {
                        room.slope[i + shift.state] -= self.shift_rate(shift, w);
                    }
                }
                i += seat.x.len();
            }
            if !seat.branches.is_empty() {
                component.torques(&law, &mut room.torque[seat.branches.clone()]);
            }
        }
        Ok(())
    }
}

/// How many times as many steps of the integrator a trial has.
fn fineness(room: &Room) -> f64 {
    if room.tries { 2.0 } else { 1.0 }
}

/// Whether a coupling step of this number is one of those that are tried for their error.
fn is_tried(number: f64) -> bool {
    number < EARLY || number % EVERY == 0.0
}

/// Times closer to the end of a coupling step than this, s, are its end.
fn instant(step: f64, end: f64) -> f64 {
    (INSTANT * step).max(ROUNDING * end.abs())
}

fn copy(to: &mut Vec<f64>, from: &[f64]) {
    to.clear();
    to.extend_from_slice(from);
}
