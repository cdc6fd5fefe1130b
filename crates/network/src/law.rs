//! What the members of a network see while their laws are evaluated: at each stage of an evaluation what is known then.
//!
//! Laws are put together some hundred times in an evaluation, so each is one expression, which a compiler writes where it is wanted.

use blocksim_block::Context;
use blocksim_block::physical::{Fed, Flowing, Known, Loaded, Moving};

use crate::network::Network;
use crate::seat::{Seat, Shares};
use crate::work::Work;

/// A share of a list, or nothing.
macro_rules! share {
    ($seat:ident, $share:ident, $list:expr, $range:expr) => {
        if $seat.shares.has(Shares::$share) { &$list[$range.clone()] } else { &[] }
    };
}

impl Network {
    /// Time, states and inputs.
    #[inline(always)]
    pub(crate) fn known_law<'a>(&self, c: &Context<'a>, seat: &'a Seat) -> Known<'a> {
        let (x, d) = seat.states(c);
        Known { t: c.t, x, d, u: share!(seat, INPUTS, c.u, seat.u), inputs: &seat.inputs }
    }

    /// The same with what sources add to states, and with speeds.
    #[inline(always)]
    pub(crate) fn moving_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Moving<'a> {
        let own = self.known_law(c, seat);
        let x = match seat.shifted {
            Some(at) if seat.shares.has(Shares::OWN) => &w.own[at..at + own.x.len()],
            _ => own.x,
        };
        self.moving_with(Known { x, ..own }, c, seat, w)
    }

    /// The same with the states that the solver has.
    #[inline(always)]
    pub(crate) fn moving_own_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Moving<'a> {
        self.moving_with(self.known_law(c, seat), c, seat, w)
    }

    #[inline(always)]
    fn moving_with<'a>(
        &'a self,
        known: Known<'a>,
        c: &Context<'a>,
        seat: &'a Seat,
        w: &'a Work,
    ) -> Moving<'a> {
        Moving {
            known,
            speed: share!(seat, PINS, w.pin_speed, seat.pins),
            mode: if seat.shares.has(Shares::MODES) { self.modes_of(c, seat) } else { &[] },
            joint: share!(seat, SPACE, w.joint_motion, seat.joint),
            orientation: match seat.ball {
                Some(i) if seat.shares.has(Shares::SPACE) => &w.orientation[i],
                _ => Moving::NOTHING.orientation,
            },
            frames: share!(seat, SPACE, w.frame_motion, seat.frames),
        }
    }

    /// The same with the supply.
    #[inline(always)]
    pub(crate) fn fed_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Fed<'a> {
        Fed {
            moving: self.moving_law(c, seat, w),
            supply: supply(seat).map_or(Fed::NOTHING.supply, |i| &w.supply[i]),
        }
    }

    /// The same with the states that the solver has.
    #[inline(always)]
    pub(crate) fn fed_own_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Fed<'a> {
        Fed {
            moving: self.moving_own_law(c, seat, w),
            supply: supply(seat).map_or(Fed::NOTHING.supply, |i| &w.supply[i]),
        }
    }

    /// The same with voltages and currents.
    #[inline(always)]
    pub(crate) fn flowing_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Flowing<'a> {
        Flowing {
            fed: self.fed_law(c, seat, w),
            voltage: share!(seat, TWO_PINS, w.voltage, seat.two_pins),
            current: share!(seat, TWO_PINS, w.current, seat.two_pins),
            places: &seat.places,
            line_current: supply(seat).map_or(Flowing::NOTHING.line_current, |i| &w.line_current[i]),
        }
    }

    /// The same with torques and accelerations.
    #[inline(always)]
    pub(crate) fn loaded_law<'a>(&'a self, c: &Context<'a>, seat: &'a Seat, w: &'a Work) -> Loaded<'a> {
        Loaded {
            flowing: self.flowing_law(c, seat, w),
            acceleration: share!(seat, PINS, w.pin_acceleration, seat.pins),
            torque: share!(seat, PINS, w.pin_torque, seat.pins),
            mesh: share!(seat, GEARS, w.all_mesh, seat.gears),
            joint_load: share!(seat, SPACE, w.joint_load, seat.joint),
            frame_acceleration: share!(seat, SPACE, w.frame_acceleration, seat.frames),
        }
    }
}

/// The supply that a member is connected to.
#[inline(always)]
fn supply(seat: &Seat) -> Option<usize> {
    seat.supply.filter(|_| seat.shares.has(Shares::SUPPLY))
}
