use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use crate::mechanics::friction_model::FrictionModel;

/// Freewheel: drives `c` when `r` is faster, and lets `c` overrun.
///
/// $$ w = w_r - w_c \le 0, \qquad \tau \ge 0, \qquad w\,\tau = 0 $$
///
/// When `r` has come up to `c` the clutch locks and both turn as one, exactly, until `r` would have to pull backwards.
/// Where `r` is faster from the start, or is struck, an impact makes both equally fast, as soft bodies collide.
///
/// `Smooth` has no events: $\tau = d\, w^2 / (w + w_t)$ for $w > 0$. Far above the transition speed $w_t$ it slips like a
/// damper, with $w \approx \tau / d + w_t$: choose $d$ so large that the slip under the largest torque does not matter.
/// The torque never delivers power. With a large $d$ a solver that uses slopes (`RosW3`, `Rodas4`) takes far
/// fewer steps.
///
/// ```ron
/// OneWayClutch()
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Freewheel)]
pub struct OneWayClutch {
    /// `Stiction` (true locking) or `Smooth`.
    #[block(default = FrictionModel::Stiction)]
    pub model: FrictionModel,
    /// Torque over slip while it drives; for `Smooth`.
    #[block(unit = "N*m*s/rad", not_negative, default = 1000.0)]
    pub d: f64,
    /// Slip $w_t$ over which it sets in; for `Smooth`.
    #[block(unit = "rad/s", positive, default = 1e-3)]
    pub transition: f64,
}

/// What a change of its mode is called.
const FREEWHEEL: &[Change] = &[Change::to(0.0, "locks"), Change::from(0.0, "overruns")];

impl Component for OneWayClutch {
    fn part(&self, _given: &Given) -> Part {
        Part::new().rod_and_case().element(self.model.element()).friction_called(FREEWHEEL)
    }

    fn grips(&self, _c: &Flowing, grips: &mut [Grip]) {
        grips[0] = Grip { hold: [f64::INFINITY, 0.0], ..Grip::default() };
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        if self.model.sticks() {
            return;
        }
        let w = c.speed[0];
        tau[0] = Torque::default();
        if w > 0.0 {
            let sum = w + self.transition;
            tau[0] = Torque {
                value: self.d * w * w / sum,
                slope: self.d * w * (w + 2.0 * self.transition) / (sum * sum),
            };
        }
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let w = c.speed[0].max(0.0);
        match self.model.sticks() || w == 0.0 {
            true => Energy::default(),
            false => Energy::dissipated(self.d * w * w * w / (w + self.transition)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    const CLUTCH: OneWayClutch = OneWayClutch { model: FrictionModel::Smooth, d: 100.0, transition: 0.01 };

    fn torque(w: f64) -> Torque {
        let mut tau = [Torque::default()];
        CLUTCH.torques(&Seen { speed: &[w], ..law() }.loaded(), &mut tau);
        tau[0]
    }

    #[test]
    fn it_drives_one_way_and_overruns_the_other() {
        assert_eq!(torque(-20.0), Torque::default());
        assert_eq!(torque(0.0), Torque::default());
        assert!((torque(0.01).value - 0.5).abs() < 1e-15);
        // tau / d + w_t, to the second order in w_t / w.
        assert!((torque(10.0).value - 100.0 * (10.0 - 0.01)).abs() < 1e-2);
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_torque() {
        for w in [-1.0_f64, 1e-3, 0.01, 0.5, 10.0] {
            let h = 1e-6 * w.abs();
            let difference = (torque(w + h).value - torque(w - h).value) / (2.0 * h);
            assert!((torque(w).slope - difference).abs() < 1e-6 * (1.0 + difference), "{w}");
        }
    }

    #[test]
    fn a_transition_of_zero_is_refused() {
        assert_eq!(OneWayClutch { transition: 0.0, ..CLUTCH }.errors()[0].param, "transition");
        assert_eq!(OneWayClutch { d: -1.0, ..CLUTCH }.errors()[0].param, "d");
    }
}
