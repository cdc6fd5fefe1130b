//! What an induction machine measures.

use blocksim_block::prelude::*;

pub(super) const TORQUE: usize = 0;
pub(super) const VELOCITY: usize = 1;
pub(super) const SLIP: usize = 2;
pub(super) const SLIP_RATED: usize = 3;
pub(super) const I_RMS: usize = 4;
pub(super) const V_RMS: usize = 5;
pub(super) const POWER: usize = 6;
pub(super) const REACTIVE_POWER: usize = 7;
pub(super) const APPARENT_POWER: usize = 8;
pub(super) const POWER_FACTOR: usize = 9;
pub(super) const V: usize = 10;
pub(super) const I: usize = 13;
pub(super) const PU_TORQUE: usize = 16;
pub(super) const PU_VELOCITY: usize = 17;
pub(super) const PU_V: usize = 18;
pub(super) const PU_I: usize = 21;
pub(super) const PU_POWER: usize = 24;
pub(super) const PU_REACTIVE_POWER: usize = 25;
pub(super) const PU_APPARENT_POWER: usize = 26;
pub(super) const PU_VOLTAGE: usize = 27;
pub(super) const PU_CURRENT: usize = 28;

/// Number of outputs.
#[cfg(test)]
pub(super) const COUNT: usize = 29;

/// Adds all outputs; vectors are those of the windings in a frame that turns at the rated frequency.
pub(super) fn measured(part: Part) -> Part {
    use Needs::{Electrics, State};
    part.measures("torque", "N*m", State, "torque on the rotor")
        .measures("velocity", "rad/s", State, "speed of the rotor against the housing")
        .measures("slip", "1", Electrics, "slip against the frequency of the supply")
        .measures("slip_rated", "1", State, "slip against the rated frequency")
        .measures("i_rms", "A", State, "current of a winding: root of the mean square over the three of them")
        .measures(
            "v_rms",
            "V",
            Electrics,
            "voltage of a winding: root of the mean square over the three of them",
        )
        .measures("power", "W", Electrics, "power drawn from the lines")
        .measures("reactive_power", "var", Electrics, "reactive power drawn from the lines")
        .measures("apparent_power", "VA", Electrics, "apparent power")
        .measures("power_factor", "1", Electrics, "power over apparent power; 0 without any")
        .measures("v_ds", "V", Electrics, "stator voltage, direct axis, peak")
        .measures("v_qs", "V", Electrics, "stator voltage, quadrature axis, peak")
        .measures("v_0s", "V", Electrics, "stator voltage, zero sequence")
        .measures("i_ds", "A", Electrics, "stator current, direct axis, peak")
        .measures("i_qs", "A", Electrics, "stator current, quadrature axis, peak")
        .measures("i_0s", "A", Electrics, "stator current, zero sequence")
        .measures("pu_torque", "1", State, "torque in per unit")
        .measures("pu_velocity", "1", State, "speed of the rotor in per unit")
        .measures("pu_vds", "1", Electrics, "stator voltage, direct axis, in per unit")
        .measures("pu_vqs", "1", Electrics, "stator voltage, quadrature axis, in per unit")
        .measures("pu_v0s", "1", Electrics, "stator voltage, zero sequence, in per unit")
        .measures("pu_ids", "1", Electrics, "stator current, direct axis, in per unit")
        .is_current()
        .measures("pu_iqs", "1", Electrics, "stator current, quadrature axis, in per unit")
        .is_current()
        .measures("pu_i0s", "1", Electrics, "stator current, zero sequence, in per unit")
        .is_current()
        .measures("pu_power", "1", Electrics, "power in per unit")
        .measures("pu_reactive_power", "1", Electrics, "reactive power in per unit")
        .measures("pu_apparent_power", "1", Electrics, "apparent power in per unit")
        .measures("pu_voltage", "1", Electrics, "length of the stator voltage in per unit")
        .measures("pu_current", "1", State, "length of the stator current in per unit")
}
