use blocksim_block::prelude::*;

use super::dc_motor::{DcMotor, no_start_without_inductance};
use super::dc_motor_line::TorqueLine;
use super::warm_winding::WarmWinding;

/// A `DcMotor` described by its rated power $P$ and speed $w_r$ and its speed without load $w_0$.
///
/// The rated torque is that of the shaft, $\tau_r = P/w_r$. Resistance and torque constant follow:
///
/// $$ k = \frac{V}{w_0}, \qquad R = \frac{k (V - k w_r)}{\tau_r} $$
///
/// With a current without load $i_0$ these include the losses, and the rotor gets a damping $d$; or the
/// damping is known, and the current follows. With the torque at standstill $\tau_s = \tau_r/(1 - w_r/w_0)$:
///
/// $$ k = \frac{V}{w_0 + V i_0/\tau_s}, \quad d = \frac{k i_0}{w_0}
///    \qquad\text{or}\qquad k = \Bigl(1 - \frac{d\, w_0}{\tau_s}\Bigr) \frac{V}{w_0},
///    \qquad\text{and}\qquad R = \frac{k V}{\tau_s} $$
///
/// ```ron
/// DcMotorByRating(
///     rated_power: "200 W", rated_speed: "3000 rpm", no_load_speed: "3400 rpm", voltage: "48 V",
///     l: "1.2 mH", j: "2e-4 kg*m^2",
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Machines", symbol = Machine("M"), builds = DcMotor)]
pub struct DcMotorByRating {
    /// Rated power of the shaft.
    #[block(unit = "W", positive)]
    pub rated_power: f64,
    /// Speed at which the motor gives its rated power.
    #[block(unit = "rad/s", positive)]
    pub rated_speed: f64,
    /// Speed without load, above the rated speed.
    #[block(unit = "rad/s", finite, above = rated_speed)]
    pub no_load_speed: f64,
    /// Voltage at which all of these hold.
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

impl DcMotorByRating {
    fn line(&self) -> TorqueLine {
        let Self { rated_power, rated_speed, no_load_speed, voltage, no_load_current, damping, .. } = *self;
        let stall_torque = rated_power / rated_speed / (1.0 - rated_speed / no_load_speed);
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

    fn motor() -> DcMotorByRating {
        DcMotorByRating {
            rated_power: 200.0,
            rated_speed: 300.0,
            no_load_speed: 340.0,
            voltage: 48.0,
            l: 1.2e-3,
            j: 2e-4,
            no_load_current: 0.0,
            damping: 0.0,
            i0: 0.0,
            warm: WarmWinding::NONE,
        }
    }

    #[test]
    fn the_motor_without_losses_has_the_formulas_of_the_rated_point() {
        let motor = motor().built();
        let k: f64 = 48.0 / 340.0;
        let r = k * (48.0 - k * 300.0) / (200.0 / 300.0);
        assert!((motor.k / k - 1.0).abs() < 1e-14);
        assert!((motor.r / r - 1.0).abs() < 1e-13, "{} != {r}", motor.r);
    }

    #[test]
    fn the_motor_gives_its_rated_power_and_turns_freely_without_it() {
        for (no_load_current, damping) in [(0.0, 0.0), (0.3, 0.0), (0.0, 5e-5)] {
            let rated = DcMotorByRating { no_load_current, damping, ..motor() };
            let DcMotor { r, k, damping, .. } = rated.clone().built();
            let torque = |w: f64| k * (48.0 - k * w) / r - damping * w;
            assert!((300.0 * torque(300.0) - 200.0).abs() < 1e-10, "{rated:?}");
            assert!(torque(340.0).abs() < 1e-12, "{rated:?}");
        }
    }

    #[test]
    fn parameters_without_meaning_are_refused() {
        let refused = |motor: DcMotorByRating| motor.try_build().unwrap_err()[0].param.clone();
        assert_eq!(refused(DcMotorByRating { rated_speed: 340.0, ..motor() }), "no_load_speed");
        assert_eq!(refused(DcMotorByRating { rated_power: 0.0, ..motor() }), "rated_power");
        assert_eq!(refused(DcMotorByRating { j: -1.0, ..motor() }), "j");
    }
}
