use blocksim_block::prelude::*;

use super::dc_motor::{DcMotor, no_start_without_inductance};
use super::dc_motor_line::TorqueLine;
use super::warm_winding::WarmWinding;

/// A `DcMotor` described by the torque at standstill $\tau_s$ and the speed without load $w_0$.
///
/// Resistance and torque constant follow from the data sheet:
///
/// $$ k = \frac{V}{w_0}, \qquad R = \frac{k V}{\tau_s} $$
///
/// With a current without load $i_0$ these include the losses, and the rotor gets a damping $d$; or the
/// damping is known, and the current follows:
///
/// $$ k = \frac{V}{w_0 + V i_0/\tau_s}, \quad d = \frac{k i_0}{w_0}
///    \qquad\text{or}\qquad k = \Bigl(1 - \frac{d\, w_0}{\tau_s}\Bigr) \frac{V}{w_0} $$
///
/// In all cases the steady state at the voltage $V$ is the line $\tau = \tau_s (1 - w/w_0)$.
///
/// ```ron
/// DcMotorByStall(
///     stall_torque: "0.9 N*m", no_load_speed: "4800 rpm", voltage: "24 V", no_load_current: "0.4 A",
///     l: "0.6 mH", j: "2.5e-5 kg*m^2",
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M"), builds = DcMotor)]
pub struct DcMotorByStall {
    /// Torque at standstill.
    #[block(unit = "N*m", positive)]
    pub stall_torque: f64,
    /// Speed without load.
    #[block(unit = "rad/s", positive)]
    pub no_load_speed: f64,
    /// Voltage at which both hold.
    #[block(unit = "V", positive)]
    pub voltage: f64,
    /// Inductance of the winding; may be zero.
    #[block(unit = "H", not_negative)]
    pub l: f64,
    /// Moment of inertia of the rotor; zero is allowed where something else gives the shaft its inertia.
    #[block(unit = "kg*m^2", not_negative)]
    pub j: f64,
    /// Current without load; instead of `damping`.
    #[block(unit = "A", not_negative, default = 0.0)]
    pub no_load_current: f64,
    /// Damping of the rotor; instead of `no_load_current`.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
    /// Current at the start; only with an inductance.
    #[block(unit = "A", finite, default = 0.0)]
    pub i0: f64,
    /// Heat of the motor.
    #[block(group)]
    pub warm: WarmWinding,
}

impl DcMotorByStall {
    fn line(&self) -> TorqueLine {
        let Self { stall_torque, no_load_speed, voltage, no_load_current, damping, .. } = *self;
        TorqueLine { stall_torque, no_load_speed, voltage, no_load_current, damping }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.line().validate(errors);
        no_start_without_inductance(self.l, self.i0, errors);
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<DcMotor> {
        Some(self.line().motor(self.l, self.j, self.i0, self.warm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motor() -> DcMotorByStall {
        DcMotorByStall {
            stall_torque: 0.24e-3,
            no_load_speed: 19100.0 * std::f64::consts::PI / 30.0,
            voltage: 1.5,
            l: 12e-6,
            j: 1e-9,
            no_load_current: 0.0,
            damping: 0.0,
            i0: 0.0,
            warm: WarmWinding::NONE,
        }
    }

    #[test]
    fn a_small_motor_gets_its_resistance_and_constant() {
        // 1.5 V / 2000.1473 rad/s = 0.749945 mV*s/rad, and 0.749945 mV*s/rad * 1.5 V / 0.24 mN*m = 4.68716 ohm.
        let motor = motor().built();
        assert!((motor.k - 0.749_945e-3).abs() < 1e-9, "{}", motor.k);
        assert!((motor.r - 4.687_16).abs() < 1e-5, "{}", motor.r);
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |motor: DcMotorByStall| motor.try_build().unwrap_err()[0].param.clone();
        assert_eq!(refused(DcMotorByStall { stall_torque: 0.0, ..motor() }), "stall_torque");
        assert_eq!(refused(DcMotorByStall { l: -1.0, ..motor() }), "l");
        assert_eq!(refused(DcMotorByStall { l: 0.0, i0: 1.0, ..motor() }), "i0");
    }
}
