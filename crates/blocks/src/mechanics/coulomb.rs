//! Dry friction as a smooth curve over the speed, scaled by how hard the surfaces are pressed together.

use blocksim_block::physical::Torque;

/// `tau = share * torque * tanh(w / threshold)`: never delivers power.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coulomb {
    /// Torque of sliding surfaces under the full load, N*m.
    pub torque: f64,
    /// Speed at which 76 % (tanh 1) of it act, rad/s.
    pub threshold: f64,
}

impl Coulomb {
    /// Torque at a speed, rad/s; a share outside 0..1 counts as the nearer end, and none (NaN) as it is.
    pub(crate) fn at(&self, share: f64, w: f64) -> Torque {
        let capacity = share.clamp(0.0, 1.0) * self.torque;
        let onset = (w / self.threshold).tanh();
        Torque { value: capacity * onset, slope: capacity * (1.0 - onset * onset) / self.threshold }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRICTION: Coulomb = Coulomb { torque: 8.0, threshold: 0.5 };

    #[test]
    fn far_from_standstill_the_torque_is_the_share_of_the_capacity() {
        for (share, capacity) in [(0.0, 0.0), (0.25, 2.0), (1.0, 8.0), (7.0, 8.0), (-1.0, 0.0)] {
            assert_eq!(FRICTION.at(share, 50.0).value, capacity);
            assert_eq!(FRICTION.at(share, -50.0).value, -capacity);
        }
    }

    #[test]
    fn the_slope_is_the_derivative_and_no_speed_gains_energy() {
        for w in [-3.0, -0.2, 0.0, 0.1, 0.6] {
            let h = 1e-6;
            let difference = (FRICTION.at(0.7, w + h).value - FRICTION.at(0.7, w - h).value) / (2.0 * h);
            let at = FRICTION.at(0.7, w);
            assert!((at.slope - difference).abs() < 1e-8, "{w}: {} != {difference}", at.slope);
            assert!(at.value * w >= 0.0, "{w}");
        }
    }
}
