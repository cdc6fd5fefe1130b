//! The end of travel of a joint: a spring and damper that set in smoothly.

use blocksim_block::physical::Torque;

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
