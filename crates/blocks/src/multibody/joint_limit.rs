//! The end of travel of a joint: a spring and damper that set in smoothly.

use blocksim_block::physical::{Energy, Torque};
use blocksim_block::prelude::*;

/// Law of both ends of travel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointLimit {
    /// N*m/rad.
    pub stiffness: f64,
    /// N*m*s/rad.
    pub damping: f64,
    /// Width over which both set in, rad; zero sets in at once.
    pub transition: f64,
}

impl JointLimit {
    /// `s(d) = 3 x^2 - 2 x^3`, `x = d / width` within 0..1.
    fn onset(&self, depth: f64) -> f64 {
        if depth >= self.transition {
            return 1.0;
        }
        let x = depth / self.transition;
        x * x * (3.0 - 2.0 * x)
    }

    /// Torque back out of the limit at a penetration, rad, that grows with a rate, rad/s; it never pulls.
    pub(crate) fn push(&self, depth: f64, rate: f64) -> Torque {
        if depth <= 0.0 {
            return Torque::default();
        }
        let onset = self.onset(depth);
        let value = onset * (self.stiffness * depth + self.damping * rate);
        if value <= 0.0 {
            return Torque::default();
        }
        Torque { value, slope: onset * self.damping }
    }

    /// Whether the torque jumps where the limit is reached: a damper that sets in at once.
    pub(crate) fn is_sudden(&self) -> bool {
        self.damping > 0.0 && self.transition == 0.0
    }

    /// The same as [`push`](Self::push), where a law that [is sudden](Self::is_sudden) is held on one side between events.
    pub(crate) fn held(&self, touches: bool, depth: f64, rate: f64) -> Torque {
        if !touches {
            return Torque::default();
        }
        Torque { value: self.stiffness * depth + self.damping * rate, slope: self.damping }
    }

    /// [`held`](Self::held) where the law is held on a side, [`push`](Self::push) where it is not.
    pub(crate) fn load(&self, touches: Option<bool>, depth: f64, rate: f64) -> Torque {
        match touches {
            Some(touches) => self.held(touches, depth, rate),
            None => self.push(depth, rate),
        }
    }

    /// How far from pressing: negative while [`push`](Self::push) is above zero, zero where it sets in and where it ends, which
    /// is before the parts are away from each other if a damper holds them back.
    pub(crate) fn apart(&self, depth: f64, rate: f64) -> f64 {
        if self.stiffness == 0.0 {
            return -depth.min(rate);
        }
        -(depth + self.damping / self.stiffness * rate.min(0.0))
    }

    /// How far from having set in fully, where the second derivative of the force jumps: a step over the whole transition
    /// sees nothing of it. Nothing without a transition.
    pub(crate) fn firm(&self, depth: f64) -> Option<f64> {
        (self.transition > 0.0).then_some(self.transition - depth)
    }

    /// Energy of the spring, and heat of the damper. Where the damper would pull, the parts let go of each other, and
    /// what the spring still holds becomes heat while it relaxes by itself. Whether it `touches` is known where the law is held.
    pub(crate) fn energy(&self, touches: Option<bool>, depth: f64, rate: f64) -> Energy {
        if depth <= 0.0 {
            return Energy::default();
        }
        // The integral of k s (3 (s/b)^2 - 2 (s/b)^3) up to the end of the transition b, then that of k s.
        let (b, x) = (self.transition, depth.min(self.transition));
        let soft = if x > 0.0 { x * x * (x / b).powi(2) * (0.75 - 0.4 * x / b) } else { 0.0 };
        let stored = self.stiffness * (soft + 0.5 * (depth * depth - x * x));
        let onset = self.onset(depth);
        let touches = touches.unwrap_or_else(|| self.push(depth, rate).value > 0.0);
        let heat = if touches { self.damping * rate * rate } else { -self.stiffness * depth * rate };
        Energy { stored, dissipated: onset * heat, ..Energy::default() }
    }
}

/// What it is called where the lower end of travel touches, and where it no longer does.
pub(crate) const LOWER_END: &[Change; 2] =
    &[Change::to(1.0, "touches the lower end"), Change::to(0.0, "leaves the lower end")];
/// The same for the upper end.
pub(crate) const UPPER_END: &[Change; 2] =
    &[Change::to(1.0, "touches the upper end"), Change::to(0.0, "leaves the upper end")];

/// Makes a side touch, 1, or not, 0, by how far it is from pressing; returns whether that has changed. At zero itself it stays what it
/// is.
pub(crate) fn settle(touches: &mut f64, apart: f64) -> bool {
    let presses = f64::from(apart < 0.0);
    apart != 0.0 && std::mem::replace(touches, presses) != presses
}

/// The guard of a side that is held: not negative while it is the right one.
pub(crate) fn guard_of_side(touches: Option<&f64>, apart: f64) -> f64 {
    if touches.is_some_and(|touches| *touches != 0.0) { -apart } else { apart }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: JointLimit = JointLimit { stiffness: 100.0, damping: 2.0, transition: 0.1 };

    #[test]
    fn the_onset_has_its_reference_values() {
        for (depth, onset) in
            [(0.0, 0.0), (0.025, 0.15625), (0.05, 0.5), (0.075, 0.84375), (0.1, 1.0), (0.3, 1.0)]
        {
            assert!((LIMIT.onset(depth) - onset).abs() < 1e-15, "{depth}");
        }
    }

    #[test]
    fn a_limit_pushes_back_and_never_pulls() {
        assert_eq!(LIMIT.push(-0.01, 5.0), Torque::default());
        assert_eq!(LIMIT.push(0.2, 0.0), Torque { value: 20.0, slope: 2.0 });
        assert_eq!(LIMIT.push(0.2, -11.0), Torque::default());
        let sudden = JointLimit { transition: 0.0, ..LIMIT };
        assert_eq!(sudden.push(1e-9, 1.0).slope, 2.0);
    }
}
