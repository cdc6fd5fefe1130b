//! What lies between a joint and its motor.

use std::f64::consts::{E, SQRT_2};

use blocksim_controller::prelude::*;

use crate::quantities::Rest;

/// Torque (N m) of the bearing of joint `i` at speed `w` (rad/s): the smooth law of the block `RotationalFriction`.
fn bearing(p: &Parameters, r: &Rest, i: usize, w: f64) -> f64 {
    let of = |name: Parameter| p.vector(name)[i];
    let (breakaway, coulomb) = (of(r.breakaway), of(r.coulomb));
    let x = w / (SQRT_2 * of(r.breakaway_velocity));
    let bump = (2.0 * E).sqrt() * (breakaway - coulomb) * x * (-x * x).exp();
    bump + coulomb * (10.0 * w / of(r.breakaway_velocity)).tanh() + of(r.viscous) * w
}

/// Torque (N m) into a gear that passes `torque` (N m, at its input) at the speed `w` (rad/s, at its input): the
/// dissipative law of `CycloidalDrive`, `T_B = T + |T_B| λ tanh(w / threshold)`.
fn into_gear(forward: f64, backward: f64, threshold: f64, torque: f64, w: f64) -> f64 {
    let onset = (w.abs() / threshold).tanh();
    if torque * w >= 0.0 {
        torque / (1.0 - (1.0 - forward) * onset)
    } else {
        torque / (1.0 + (1.0 / backward - 1.0) * onset)
    }
}

/// Torque (N m) of the motor of joint `i` where the links need `tau` (N m): bearing, gear, rotor.
pub fn motor_torque(p: &Parameters, r: &Rest, i: usize, tau: f64, qd: f64, qdd: f64) -> f64 {
    let of = |name: Parameter| p.vector(name)[i];
    let ratio = of(r.ratio);
    let passed = (tau + bearing(p, r, i, qd)) / ratio;
    into_gear(of(r.forward), of(r.backward), p[r.threshold], passed, ratio * qd)
        + of(r.inertia) * ratio * qdd
        + of(r.damping) * ratio * qd
}

#[cfg(test)]
mod tests {
    use super::into_gear;

    #[test]
    fn a_gear_loses_its_share_whichever_side_drives() {
        assert!((into_gear(0.8, 0.5, 1.0, 8.0, 100.0) - 10.0).abs() < 1e-14);
        assert!((into_gear(0.8, 0.5, 1.0, 8.0, -100.0) - 4.0).abs() < 1e-14);
        assert!((into_gear(0.8, 0.5, 1.0, -8.0, -100.0) + 10.0).abs() < 1e-14);
        assert_eq!(into_gear(0.8, 0.5, 1.0, 8.0, 0.0), 8.0, "it holds without loss");
    }

    #[test]
    fn the_loss_sets_in_as_its_law_says() {
        for (torque, w) in [(3.0_f64, 0.4_f64), (3.0, -0.4), (-2.0, 0.7), (-2.0, -1.5)] {
            let into = into_gear(0.8, 0.75, 1.0, torque, w);
            let lambda = if into * w > 0.0 { 0.2 } else { 1.0 / 0.75 - 1.0 };
            assert!(
                (into - torque - into.abs() * lambda * w.tanh()).abs() < 1e-14,
                "{torque} N m, {w} rad/s"
            );
        }
    }
}
