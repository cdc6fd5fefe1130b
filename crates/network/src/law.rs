//! What the members of a network see while their laws are evaluated.

use blocksim_block::Context;
use blocksim_block::physical::Law;

use crate::network::Network;
use crate::seat::{Seat, Shares};
use crate::work::Work;

impl Network {
    /// What a member sees before accelerations are known.
    #[inline(always)]
    pub(crate) fn law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        let (x, d) = seat.states(c);
        let mut law = Law { t: c.t, x, d, inputs: &seat.inputs, ..Law::nothing() };
        let shares = seat.shares;
        if shares.has(Shares::OWN)
            && let Some(at) = seat.shifted
        {
            law.x = &w.own[at..at + x.len()];
        }
        if shares.has(Shares::INPUTS) {
            law.u = &c.u[seat.u.clone()];
        }
        if shares.has(Shares::PINS) {
            law.speed = &w.pin_speed[seat.pins.clone()];
        }
        if shares.has(Shares::MODES) {
            law.mode = self.modes_of(c, seat);
        }
        if shares.has(Shares::TWO_PINS) {
            law.voltage = &w.voltage[seat.two_pins.clone()];
            law.current = &w.current[seat.two_pins.clone()];
            law.places = &seat.places;
        }
        if shares.has(Shares::SUPPLY)
            && let Some(i) = seat.supply
        {
            law.supply = &w.supply[i];
            law.line_current = &w.line_current[i];
        }
        if shares.has(Shares::SPACE) {
            law.joint = &w.joint_motion[seat.joint.clone()];
            law.frames = &w.frame_motion[seat.frames.clone()];
            if let Some(i) = seat.ball {
                law.orientation = &w.orientation[i];
            }
        }
        law
    }

    /// What a member sees when states and speeds are known, and nothing else is.
    pub(crate) fn state_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        // What belongs to another evaluation is not there to be read.
        let Law { supply, line_current, .. } = Law::nothing();
        Law { voltage: &[], current: &[], supply, line_current, ..self.law(c, seat, w) }
    }

    /// The same with the states as the solver has them, where sources add to them.
    #[inline(always)]
    pub(crate) fn own_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        let mut law = self.law(c, seat, w);
        if seat.shares.has(Shares::OWN) {
            law.x = seat.states(c).0;
        }
        law
    }

    /// What a member sees in the end.
    #[inline(always)]
    pub(crate) fn whole_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Law<'a> {
        let mut law = self.law(c, seat, w);
        if seat.shares.has(Shares::PINS) {
            law.acceleration = &w.pin_acceleration[seat.pins.clone()];
            law.torque = &w.pin_torque[seat.pins.clone()];
        }
        if seat.shares.has(Shares::GEARS) {
            law.mesh = &w.all_mesh[seat.gears.clone()];
        }
        law
    }

    /// What a member sees when nothing but time, inputs and states is known.
    pub(crate) fn still<'a>(&'a self, c: &Context<'a>, seat: &'a Seat) -> Law<'a> {
        let (x, d) = seat.states(c);
        Law { t: c.t, x, d, u: &c.u[seat.u.clone()], inputs: &seat.inputs, ..Law::nothing() }
    }
}
