//! Gear, friction and inertia of a drive from any motion in which the motor drives.

use nalgebra::DMatrix;

use crate::error::IdentifyError;
use crate::least_squares::{Estimate, Fit, least_squares};

/// An axis at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveSample {
    /// Speed of the joint, rad/s.
    pub speed: f64,
    /// Acceleration of the joint, rad/s².
    pub acceleration: f64,
    /// Torque on the joint, behind gear and bearing, N m.
    pub joint: f64,
    /// Torque of the motor times the ratio of the gear, N m.
    pub motor: f64,
}

/// What a drive needs for itself, counted at the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveFit {
    /// Torque before the gear over torque behind it: one over its efficiency.
    pub gear: Estimate,
    /// Coulomb torque, N m.
    pub coulomb: Estimate,
    /// Viscous coefficient, N m s/rad.
    pub viscous: Estimate,
    /// Moment of inertia of rotor and gear, kg m².
    pub inertia: Estimate,
    /// Samples that were used.
    pub used: usize,
    /// The whole fit.
    pub fit: Fit,
}

/// Fits, over all samples in which the axis is faster than `slowest` (rad/s) and its joint is driven (`joint` and `speed`
/// have one sign, so the motor certainly drives and the gear loses in one way),
///
/// $$ \tau_m = \frac{\tau}{\eta} + F_2 \operatorname{sgn} \dot q + F_1 \dot q + J \ddot q $$
///
/// by least squares. With the bearing's friction $\tau_C$ and $f$ and the motor's damping $d$ that is
/// $F_2 = \tau_C / \eta$ and $F_1 = f / \eta + d$.
///
/// # Errors
/// As [`least_squares`].
pub fn drive(samples: &[DriveSample], slowest: f64) -> Result<DriveFit, IdentifyError> {
    let driven: Vec<&DriveSample> =
        samples.iter().filter(|s| s.speed.abs() > slowest && s.joint * s.speed > 0.0).collect();
    let a = DMatrix::from_fn(driven.len(), 4, |i, j| {
        let sample = driven[i];
        match j {
            0 => sample.joint,
            1 => sample.speed.signum(),
            2 => sample.speed,
            _ => sample.acceleration,
        }
    });
    let motor: Vec<f64> = driven.iter().map(|sample| sample.motor).collect();
    let fit = least_squares(&a, &motor, &[])?;
    let [gear, coulomb, viscous, inertia] = [0, 1, 2, 3].map(|k| fit.estimates[k]);
    Ok(DriveFit { gear, coulomb, viscous, inertia, used: driven.len(), fit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn a_drive_is_found_again_from_a_motion_under_load() {
        let mut random = Random::new(4);
        let (eta, coulomb, viscous, inertia) = (0.8, 24.0, 12.0, 3.0);
        let samples: Vec<DriveSample> = (0..2000)
            .map(|k| {
                let t = 2e-3 * f64::from(k);
                let (speed, acceleration) = ((2.0 * t).sin(), 2.0 * (2.0 * t).cos());
                // A load that turns with the position, and swings on its own.
                let joint = 20.0 * acceleration + 300.0 * (5.0 * t).sin();
                let passed = joint + coulomb * speed.signum() + viscous * speed;
                let through = if passed * speed > 0.0 { passed / eta } else { passed * 0.75 };
                let motor = through + inertia * acceleration + 0.01 * random.normal();
                DriveSample { speed, acceleration, joint, motor }
            })
            .collect();
        let found = drive(&samples, 0.05).unwrap();
        for (found, expected) in [
            (found.gear, 1.0 / eta),
            (found.coulomb, coulomb / eta),
            (found.viscous, viscous / eta),
            (found.inertia, inertia),
        ] {
            assert!(
                (found.value - expected).abs() < 2.0 * found.interval + 1e-9,
                "{found:?} is not {expected}"
            );
            assert!(found.interval < 1e-3 * expected, "{found:?}");
        }
        assert!(found.used > 500 && found.used < 1500);
    }

    #[test]
    fn a_motion_that_shows_nothing_is_refused() {
        let still = DriveSample { speed: 0.0, acceleration: 0.0, joint: 5.0, motor: 5.0 };
        assert!(matches!(drive(&[still; 9], 0.0), Err(IdentifyError::TooFew { .. })));
        let steady = DriveSample { speed: 1.0, acceleration: 0.0, joint: 5.0, motor: 9.0 };
        assert!(matches!(drive(&[steady; 9], 0.0), Err(IdentifyError::Dependent { .. })));
    }
}
