//! The straight line between torque and speed of a motor with permanent magnets, as data sheets give it.

use blocksim_block::prelude::*;

use super::dc_motor::DcMotor;
use super::warm_winding::WarmWinding;

/// Torque and speed of the shaft at a constant voltage: $\tau = \tau_s (1 - w/w_0)$.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueLine {
    /// Torque at standstill $\tau_s$, N*m.
    pub stall_torque: f64,
    /// Speed without load $w_0$, rad/s.
    pub no_load_speed: f64,
    /// Voltage $V$ at which both hold, V.
    pub voltage: f64,
    /// Current without load $i_0$ at this voltage, A.
    pub no_load_current: f64,
    /// Damping of the rotor, N*m*s/rad.
    pub damping: f64,
}

impl TorqueLine {
    /// The motor behind the line.
    ///
    /// At standstill `tau_s = k V / R`, without load `V = R i_0 + k w_0` and `k i_0 = damping w_0`. The losses
    /// are known by the current or by the damping; the other one follows. Solved for `k`, that is
    /// `k = V / (w_0 + V i_0 / tau_s)` with the current, `k = (1 - damping w_0 / tau_s) V / w_0` with the
    /// damping, and `R = k V / tau_s`.
    pub fn motor(&self, l: f64, j: f64, i0: f64, warm: WarmWinding) -> DcMotor {
        let Self { stall_torque, no_load_speed, voltage, no_load_current, damping } = *self;
        let share = 1.0 - damping * no_load_speed / stall_torque;
        let k = share * voltage / (no_load_speed + voltage * no_load_current / stall_torque);
        let r = k * voltage / stall_torque;
        DcMotor { r, l, k, j, damping: damping + k * no_load_current / no_load_speed, i0, warm }
    }

    /// Reports what no motor has; what each of the parameters must be is declared where they are.
    pub fn validate(&self, errors: &mut ParamErrors) {
        if self.no_load_current > 0.0 && self.damping > 0.0 {
            let message = "`damping` and `no_load_current` both determine what turns the motor without load";
            let error = ParamError::new("damping", message).beside(&["no_load_current"]);
            errors.add(error.help("leave one of them out: the other follows from k i_0 = damping w_0"));
        }
        let lost = self.damping * self.no_load_speed;
        if lost >= self.stall_torque {
            let message = format!(
                "at the speed without load the damping takes {lost} N*m, all of the {} N*m of standstill",
                self.stall_torque
            );
            let error = ParamError::new("damping", message).beside(&["no_load_speed"]);
            errors.add(error.help("look at the unit of `damping`, or give `no_load_current` instead"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: TorqueLine = TorqueLine {
        stall_torque: 0.9,
        no_load_speed: 500.0,
        voltage: 24.0,
        no_load_current: 0.0,
        damping: 0.0,
    };

    fn errors(line: TorqueLine) -> ParamErrors {
        let mut errors = ParamErrors::default();
        line.validate(&mut errors);
        errors
    }

    /// Torque of the shaft in the steady state.
    fn torque(motor: &DcMotor, v: f64, w: f64) -> f64 {
        motor.k * (v - motor.k * w) / motor.r - motor.damping * w
    }

    #[test]
    fn a_motor_without_losses_has_the_constant_of_its_speed() {
        let motor = LINE.motor(1e-3, 1e-5, 0.0, WarmWinding::NONE);
        assert!((motor.k - 24.0 / 500.0).abs() < 1e-17);
        assert!((motor.r - 0.048 * 24.0 / 0.9).abs() < 1e-15);
        assert_eq!((motor.damping, motor.l, motor.j), (0.0, 1e-3, 1e-5));
    }

    #[test]
    fn the_motor_is_on_its_line_however_the_losses_are_given() {
        for (no_load_current, damping) in [(0.0, 0.0), (0.4, 0.0), (0.0, 2e-4)] {
            let line = TorqueLine { no_load_current, damping, ..LINE };
            assert!(errors(line).is_empty());
            let motor = line.motor(0.0, 1e-5, 0.0, WarmWinding::NONE);
            for w in [-100.0, 0.0, 250.0, 500.0, 700.0] {
                let found = torque(&motor, 24.0, w);
                assert!((found - 0.9 * (1.0 - w / 500.0)).abs() < 1e-13, "{line:?} at {w} rad/s: {found}");
            }
        }
    }

    #[test]
    fn current_and_damping_are_two_names_of_one_loss() {
        let by_current = TorqueLine { no_load_current: 0.4, ..LINE }.motor(0.0, 1e-5, 0.0, WarmWinding::NONE);
        let i = (24.0 - by_current.k * 500.0) / by_current.r;
        assert!((i - 0.4).abs() < 1e-13, "{i}");
        let by_damping =
            TorqueLine { damping: by_current.damping, ..LINE }.motor(0.0, 1e-5, 0.0, WarmWinding::NONE);
        assert!((by_damping.k / by_current.k - 1.0).abs() < 1e-14);
        assert!((by_damping.r / by_current.r - 1.0).abs() < 1e-14);
    }

    #[test]
    fn losses_are_given_once_and_leave_something() {
        let refused = |line: TorqueLine| errors(line)[0].param.clone();
        assert_eq!(refused(TorqueLine { no_load_current: 0.4, damping: 1e-5, ..LINE }), "damping");
        assert_eq!(refused(TorqueLine { damping: 0.01, ..LINE }), "damping");
    }
}
