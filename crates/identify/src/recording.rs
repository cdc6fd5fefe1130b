//! A recorded motion of a robot as samples.

use crate::dynamics::Sample;
use crate::error::IdentifyError;
use crate::smooth::{derivative, low_pass};

/// What was recorded of all joints, at instants that are equally far apart: a list for each joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Time between two instants, s.
    pub step: f64,
    /// Positions, rad or m.
    pub q: Vec<Vec<f64>>,
    /// Speeds, where they were recorded.
    pub v: Option<Vec<Vec<f64>>>,
    /// Accelerations, where they were recorded.
    pub a: Option<Vec<Vec<f64>>>,
    /// Torques on the joints, N m or N.
    pub tau: Vec<Vec<f64>>,
}

/// Samples of a recording, and how they were made.
#[derive(Debug, Clone, PartialEq)]
pub struct Treated {
    /// The samples.
    pub samples: Vec<Sample>,
    /// Every which instant was taken.
    pub every: usize,
    /// Whether derivatives were made, and so all signals filtered.
    pub filtered: bool,
}

impl Recording {
    /// Samples for [`identify`](crate::identify), at most `rows`.
    ///
    /// Where speeds or accelerations are missing they are central differences of what there is, behind
    /// [`low_pass`] with this cutoff (Hz). Positions and torques then pass the same filter, so that both sides of the equations of
    /// motion have the same band; 1 / `cutoff` is left out at both ends.
    ///
    /// # Errors
    /// [`IdentifyError::Lengths`] or [`IdentifyError::TooFew`] where lists differ or are too short,
    /// [`IdentifyError::Cutoff`] where the cutoff does not fit the instants.
    pub fn samples(&self, cutoff: f64, rows: usize) -> Result<Treated, IdentifyError> {
        let count = self.q.first().map_or(0, Vec::len);
        let joints = self.q.len();
        let some = [Some(&self.q), self.v.as_ref(), self.a.as_ref(), Some(&self.tau)];
        for list in some.into_iter().flatten() {
            if list.len() != joints {
                return Err(IdentifyError::Lengths {
                    what: "the joints",
                    found: list.len(),
                    expected: joints,
                });
            }
            if let Some(other) = list.iter().find(|values| values.len() != count) {
                let (what, found) = ("the instants", other.len());
                return Err(IdentifyError::Lengths { what, found, expected: count });
            }
        }
        let filtered = self.v.is_none() || self.a.is_none();
        let largest = 0.4 / self.step;
        // Written so that no number at all is refused, too.
        let fits = cutoff > 0.0 && cutoff < largest;
        if filtered && !fits {
            return Err(IdentifyError::Cutoff { cutoff, largest });
        }
        let smooth = |list: &[Vec<f64>]| -> Vec<Vec<f64>> {
            match filtered {
                true => list.iter().map(|values| low_pass(values, self.step, cutoff)).collect(),
                false => list.to_vec(),
            }
        };
        let slopes =
            |list: &[Vec<f64>]| list.iter().map(|values| derivative(values, self.step)).collect::<Vec<_>>();
        let (q, tau) = (smooth(&self.q), smooth(&self.tau));
        let v = self.v.as_deref().map_or_else(|| slopes(&q), smooth);
        let a = self.a.as_deref().map_or_else(|| slopes(&v), smooth);
        let cut = if filtered { (1.0 / (cutoff * self.step)).ceil() as usize } else { 0 };
        let left = count.saturating_sub(2 * cut);
        if left < 3 {
            return Err(IdentifyError::TooFew { values: count, unknowns: 2 * cut + 3 });
        }
        let every = left.div_ceil(rows.max(1));
        let samples = (cut..count - cut)
            .step_by(every)
            .map(|k| {
                let of = |list: &[Vec<f64>]| list.iter().map(|values| values[k]).collect();
                Sample { q: of(&q), v: of(&v), a: of(&a), tau: of(&tau) }
            })
            .collect();
        Ok(Treated { samples, every, filtered })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn recorded(noise: f64) -> Recording {
        let (step, mut random) = (1e-3, Random::new(3));
        let t = |k: usize| step * k as f64;
        let of = |f: &dyn Fn(f64) -> f64| (0..4000).map(|k| f(t(k))).collect::<Vec<_>>();
        let q = of(&|t| (3.0 * t).sin()).iter().map(|q| q + noise * random.normal()).collect();
        Recording { step, q: vec![q], v: None, a: None, tau: vec![of(&|t| -2.0 * 9.0 * (3.0 * t).sin())] }
    }

    #[test]
    fn speeds_and_accelerations_come_out_of_positions_with_noise() {
        // A mass of two on a sine: the torque is twice the acceleration.
        let treated = recorded(1e-5).samples(10.0, 500).unwrap();
        assert!(treated.filtered && treated.samples.len() <= 500 && treated.every == 8, "{}", treated.every);
        for sample in &treated.samples {
            assert!((2.0 * sample.a[0] - sample.tau[0]).abs() < 0.4, "{sample:?}");
            assert!((sample.v[0].powi(2) / 9.0 + sample.q[0].powi(2) - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn what_was_recorded_is_taken_as_it_is() {
        let mut all = recorded(0.0);
        all.v = Some(vec![vec![7.0; 4000]]);
        all.a = Some(vec![vec![8.0; 4000]]);
        let treated = all.samples(1e9, 4000).unwrap();
        assert!(!treated.filtered && treated.every == 1 && treated.samples.len() == 4000);
        assert_eq!((treated.samples[0].v[0], treated.samples[10].q[0]), (7.0, all.q[0][10]));
    }

    #[test]
    fn a_recording_that_does_not_fit_is_refused() {
        let mut short = recorded(0.0);
        short.tau[0].pop();
        assert!(matches!(short.samples(10.0, 100), Err(IdentifyError::Lengths { .. })));
        assert!(matches!(recorded(0.0).samples(400.0, 100), Err(IdentifyError::Cutoff { .. })));
        assert!(matches!(recorded(0.0).samples(0.4, 100), Err(IdentifyError::TooFew { .. })));
        assert!(matches!(recorded(0.0).samples(f64::NAN, 100), Err(IdentifyError::Cutoff { .. })));
    }
}
