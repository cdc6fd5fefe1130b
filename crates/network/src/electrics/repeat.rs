//! What has passed of a coupling step, integrated once more with the inputs and the speeds as they have been.
//!
//! A circuit is integrated over a step before its inputs are known there, and before it is known what strikes its shaft. Where an input
//! has gone on otherwise than was expected, the step is integrated once more at its end, and where an input or a speed jumps within a
//! step, that ends at the jump and what is left of it begins with what is new, so that the grid of the hits stays. Either way the circuit is then what its inputs have made of it. The
//! mechanics has had the torque that was expected: the impulse that it lacks is given in what comes next.

use blocksim_block::Context;

use crate::electrics::Separate;
use crate::electrics::currents::Faulty;
use crate::network::Network;
use crate::work::Work;
use crate::work::circuits::Room;

/// What stands for a step that is what is left of one. In two more of them the torques know of the impulse that was owed.
pub(crate) const CUT: f64 = 3.0;

/// Part of a speed by which it jumps where something strikes.
const IMPACT: f64 = 1e-6;

impl Network {
    /// Ends the step of a circuit now, where an input or a speed jumps, and integrates over what is left of it.
    pub(crate) fn cut(
        &self,
        separate: &Separate,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
        d: &mut [f64],
    ) -> Result<(), Faulty> {
        let cells = separate.cells();
        let parts = d[cells.parts].max(1.0);
        room.own.clear();
        room.own.extend(self.own_branches(separate));
        self.meet_inputs(separate, c, d, room);
        self.repeat(separate, c, w, room, d)?;
        for held in separate.members.iter().filter_map(|i| self.seats[*i].held.as_ref()) {
            for (sum, before) in held.sum.clone().zip(held.sum_before.clone()) {
                d[sum] = d[before];
            }
            for (mean, sum) in held.mean.clone().zip(held.sum.clone()) {
                d[sum] += room.average[mean];
            }
        }
        self.forget_means(separate, room);
        d[cells.cut] = CUT;
        room.step = d[cells.until] - c.t;
        room.is_part = parts > 1.0;
        self.foresee(separate, parts * room.step / self.coupling_step(), d, room);
        self.give(separate, d, room);
        self.over(separate, c, w, room, d)?;
        // There is no step before of which this one is the next.
        self.end(separate, true, w, room, d);
        self.expect_inputs(separate, d, room);
        self.note_error(separate, false, w, room, d);
        Ok(())
    }

    /// Notes that speeds have jumped, and ends the steps of the circuits that they belong to: what strikes a shaft strikes its machine.
    /// `before` are the states before.
    pub(crate) fn strike_circuits(&self, c: &Context, before: &[f64], x: &[f64], d: &mut [f64]) {
        let free = self.positions..self.positions + self.rotation.free;
        let (before, after) = (&before[free.clone()], &x[free]);
        if self.separate.is_empty() || before == after {
            return;
        }
        let mut is_struck = false;
        for seat in self.separate.iter().flat_map(|separate| &separate.members).map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            for (k, pin) in seat.pins.clone().enumerate() {
                let form = &self.rotation.pins[pin].speed;
                let (from, to) = (form.of(before), form.of(after));
                // What comes to rest was at zero but for rounding.
                if (to - from).abs() > IMPACT * (from.abs() + to.abs() + d[held.speed.start + k].abs()) {
                    d[held.struck.start + k] += to - from;
                    is_struck = true;
                }
            }
        }
        if is_struck {
            self.note_inputs(c, d);
            self.separate.iter().for_each(|separate| d[separate.cells().interrupted] = 1.0);
        }
    }

    /// Integrates a circuit once more from the beginning of its last step up to now, and notes what the mechanics lacks of the impulse.
    pub(crate) fn repeat(
        &self,
        separate: &Separate,
        c: &Context,
        w: &mut Work,
        room: &mut Room,
        d: &mut [f64],
    ) -> Result<(), Faulty> {
        let (begin, end) = (d[separate.times], d[separate.times + 1]);
        room.step = c.t - begin;
        self.forget_means(separate, room);
        if room.step > 0.0 {
            self.look_back_at_speeds(separate, d, room);
            let was = std::mem::take(&mut room.was);
            self.exchange(room);
            for seat in separate.members.iter().map(|i| &self.seats[*i]) {
                room.d[seat.x.clone()].copy_from_slice(&d[seat.x.clone()]);
                room.d[seat.d.clone()].copy_from_slice(&d[seat.d.clone()]);
            }
            (room.d[separate.times], room.d[separate.times + 1]) = (begin, f64::INFINITY);
            let done = self.advance(separate, &Context { t: begin, u: &was, ..*c }, w, room);
            self.exchange(room);
            room.was = was;
            room.u.clear();
            room.u.extend_from_slice(c.u);
            done?;
        }
        let (done, whole) = (room.step, end - begin);
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            if done > 0.0 {
                d[held.x_end.clone()].copy_from_slice(&room.d[seat.x.clone()]);
                d[held.d_end.clone()].copy_from_slice(&room.d[seat.d.clone()]);
                for (k, branch) in seat.branches.clone().enumerate() {
                    let (mean, rise) = (d[held.torque.start + k], d[held.course.start + k]);
                    let given = done * (mean + rise * (done / whole - 1.0));
                    d[held.owed.start + k] += room.mean[branch] - given;
                }
            } else {
                d.copy_within(seat.x.clone(), held.x_end.start);
                d.copy_within(seat.d.clone(), held.d_end.start);
            }
        }
        Ok(())
    }

    /// Notes in the working space how speeds have gone on in the last step: a parabola with the slope that was known at its beginning.
    fn look_back_at_speeds(&self, separate: &Separate, d: &[f64], room: &mut Room) {
        let Room { speed, acceleration, past_speed, past_acceleration, bend, step, .. } = room;
        past_speed.clear();
        past_speed.extend_from_slice(speed);
        past_acceleration.clear();
        past_acceleration.extend_from_slice(acceleration);
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            for (k, pin) in seat.pins.clone().enumerate() {
                past_speed[pin] = d[held.speed.start + k];
                past_acceleration[pin] = d[held.acceleration.start + k];
                let came_to = speed[pin] - d[held.struck.start + k];
                bend[pin] = came_to - past_speed[pin] - *step * past_acceleration[pin];
            }
        }
    }

    /// Exchanges what is known of the last step for what is expected of the next one.
    fn exchange(&self, room: &mut Room) {
        std::mem::swap(&mut room.speed, &mut room.past_speed);
        std::mem::swap(&mut room.acceleration, &mut room.past_acceleration);
        std::mem::swap(&mut room.courses, &mut room.went);
        room.repeats = !room.repeats;
    }

    /// The last step has been what was expected: the mechanics has what it was to give.
    pub(crate) fn settle(&self, separate: &Separate, d: &mut [f64]) {
        for held in separate.members.iter().filter_map(|i| self.seats[*i].held.as_ref()) {
            for (owed, given) in held.owed.clone().zip(held.given.clone()) {
                d[owed] -= d[given];
            }
        }
    }

    /// Notes in the working space what of an impulse that is owed the step at hand is to give: the less, the shorter it is.
    pub(crate) fn give(&self, separate: &Separate, d: &[f64], room: &mut Room) {
        room.given.clear();
        room.given.resize(self.rotation.branches.len(), 0.0);
        let part = self.coupling_step() / d[separate.cells().parts].max(1.0);
        for seat in separate.members.iter().map(|i| &self.seats[*i]) {
            let Some(held) = &seat.held else { continue };
            for (k, branch) in seat.branches.clone().enumerate() {
                room.given[branch] = d[held.owed.start + k] * (room.step / part).min(1.0);
            }
        }
    }
}
