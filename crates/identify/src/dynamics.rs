//! Base parameters from torques along a motion.

use blocksim_multibody::{Model, PARAMETERS_PER_BODY, regressor};
use nalgebra::DMatrix;

use crate::base_parameters::BaseParameters;
use crate::error::IdentifyError;
use crate::least_squares::{Fit, finite, least_squares};

/// Motion and torques of all joints at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Positions, rad.
    pub q: Vec<f64>,
    /// Speeds, rad/s.
    pub v: Vec<f64>,
    /// Accelerations, rad/s².
    pub a: Vec<f64>,
    /// Torques, N m.
    pub tau: Vec<f64>,
}

/// Base parameters that were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// One for each base parameter, from the weighted fit.
    pub fit: Fit,
    /// Standard deviation of the residual of each joint, N m.
    pub residuals: Vec<f64>,
}

/// Finds the base parameters by weighted least squares: the joints are weighted by the inverse of the standard deviation
/// of their residuals in a first fit without weights.
///
/// Source: M. Gautier, *Dynamic Identification of Robots with Power Model*, ICRA 1997; W. Khalil, E. Dombre, *Modeling,
/// Identification and Control of Robots* (2002), chapter 12.
///
/// # Errors
/// As [`least_squares`].
pub fn identify(
    model: &Model,
    base: &BaseParameters,
    samples: &[Sample],
) -> Result<Identified, IdentifyError> {
    let (matrix, tau) = stack(model, base, samples)?;
    let first = least_squares(&matrix, &tau, &[])?;
    let n = model.dof();
    let deviations = |fit: &Fit| {
        let values: Vec<f64> = fit.estimates.iter().map(|estimate| estimate.value).collect();
        root_mean_square(&errors(&matrix, &tau, &values), n)
    };
    let spread = deviations(&first);
    // A joint that fits to rounding must not drown the others.
    let largest = spread.iter().copied().fold(0.0, f64::max);
    let weight = |joint: usize| if largest == 0.0 { 1.0 } else { 1.0 / spread[joint].max(1e-6 * largest) };
    let weights: Vec<f64> = (0..tau.len()).map(|row| weight(row % n)).collect();
    let fit = least_squares(&matrix, &tau, &weights)?;
    let residuals = deviations(&fit);
    Ok(Identified { fit, residuals })
}

/// Root mean square of what base parameters predict wrong, for each joint, N m.
///
/// # Errors
/// Samples that do not fit the model.
pub fn prediction_error(
    model: &Model,
    base: &BaseParameters,
    values: &[f64],
    samples: &[Sample],
) -> Result<Vec<f64>, IdentifyError> {
    if values.len() != base.len() {
        return Err(IdentifyError::Lengths { what: "the values", found: values.len(), expected: base.len() });
    }
    let (matrix, tau) = stack(model, base, samples)?;
    Ok(root_mean_square(&errors(&matrix, &tau, values), model.dof()))
}

fn errors(matrix: &DMatrix<f64>, tau: &[f64], values: &[f64]) -> Vec<f64> {
    let predicted = matrix * nalgebra::DVector::from_column_slice(values);
    tau.iter().zip(predicted.iter()).map(|(tau, predicted)| tau - predicted).collect()
}

/// Of each of `n` joints whose values follow one another.
fn root_mean_square(values: &[f64], n: usize) -> Vec<f64> {
    let count = (values.len() / n.max(1)).max(1) as f64;
    let of = |joint: usize| values.iter().skip(joint).step_by(n).map(|x| x * x).sum::<f64>();
    (0..n).map(|joint| (of(joint) / count).sqrt()).collect()
}

fn stack(
    model: &Model,
    base: &BaseParameters,
    samples: &[Sample],
) -> Result<(DMatrix<f64>, Vec<f64>), IdentifyError> {
    let (n, columns) = (model.dof(), PARAMETERS_PER_BODY * model.bodies().count());
    let mut data = model.data();
    let (mut full, mut rows, mut tau) = (vec![0.0; n * columns], Vec::new(), Vec::new());
    for sample in samples {
        for (what, list, expected) in [
            ("the positions", &sample.q, model.nq()),
            ("the speeds", &sample.v, n),
            ("the accelerations", &sample.a, n),
            ("the torques", &sample.tau, n),
        ] {
            if list.len() != expected {
                return Err(IdentifyError::Lengths { what, found: list.len(), expected });
            }
        }
        finite("position", &sample.q)?;
        finite("speed", &sample.v)?;
        finite("acceleration", &sample.a)?;
        regressor(model, &mut data, &sample.q, &sample.v, &sample.a, &mut full);
        base.reduce(&full, columns, &mut rows);
        tau.extend_from_slice(&sample.tau);
    }
    finite("torque", &tau)?;
    Ok((DMatrix::from_row_slice(tau.len(), base.len(), &rows), tau))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base_parameters::tests::planar;
    use crate::excitation::{JointRange, excitation};
    use crate::random::Random;
    use blocksim_multibody::rnea;

    const RANGE: JointRange = JointRange { lower: -2.0, upper: 2.0, speed: 3.0, acceleration: 15.0 };

    fn recorded(model: &Model, base: &BaseParameters, seed: u64, noise: f64) -> Vec<Sample> {
        let motion = excitation(model, base, &[RANGE; 2], 4.0, 5, seed).unwrap();
        let mut random = Random::new(seed + 100);
        (0..200)
            .map(|i| {
                let now: Vec<[f64; 3]> = motion.joints.iter().map(|j| j.at(0.02 * f64::from(i))).collect();
                let of = |k: usize| -> Vec<f64> { now.iter().map(|row| row[k]).collect() };
                let (q, v, a, mut tau) = (of(0), of(1), of(2), vec![0.0; 2]);
                rnea(model, &mut model.data(), &q, &v, &a, &mut tau);
                // The second joint is measured ten times better.
                tau[0] += noise * random.normal();
                tau[1] += 0.1 * noise * random.normal();
                Sample { q, v, a, tau }
            })
            .collect()
    }

    #[test]
    fn without_noise_the_base_parameters_are_found_exactly() {
        let model = planar(2, [0.0, -9.81, 0.0]);
        let base = BaseParameters::of(&model, 50, 1);
        let found = identify(&model, &base, &recorded(&model, &base, 1, 0.0)).unwrap();
        let truth = base.values(&model.inertial_parameters());
        for (found, truth) in found.fit.estimates.iter().zip(&truth) {
            assert!((found.value - truth).abs() < 1e-10 * (1.0 + truth.abs()), "{found:?} is not {truth}");
        }
        assert!(found.fit.condition < 100.0, "{}", found.fit.condition);
    }

    #[test]
    fn with_noise_the_truth_lies_in_the_intervals_and_predicts_another_motion() {
        let model = planar(2, [0.0, -9.81, 0.0]);
        let base = BaseParameters::of(&model, 50, 1);
        let truth = base.values(&model.inertial_parameters());
        let (mut held, mut all) = (0, 0);
        for seed in 0..20 {
            let found = identify(&model, &base, &recorded(&model, &base, seed, 0.5)).unwrap();
            held +=
                found.fit.estimates.iter().zip(&truth).filter(|(found, truth)| found.holds(**truth)).count();
            all += truth.len();
            assert!((found.residuals[0] - 0.5).abs() < 0.1 && (found.residuals[1] - 0.05).abs() < 0.01);
            let values: Vec<f64> = found.fit.estimates.iter().map(|estimate| estimate.value).collect();
            let other = recorded(&model, &base, seed + 1000, 0.0);
            let wrong = prediction_error(&model, &base, &values, &other).unwrap();
            // Better than any single measurement was.
            assert!(wrong[0] < 0.5 && wrong[1] < 0.05, "{wrong:?}");
        }
        // 95 % of 120, with a standard deviation of 2.4 if they were independent.
        assert!(held >= 105, "{held} of {all}");
    }

    #[test]
    fn samples_that_do_not_fit_and_motions_that_show_nothing_are_refused() {
        let model = planar(2, [0.0, -9.81, 0.0]);
        let base = BaseParameters::of(&model, 50, 1);
        let mut samples = recorded(&model, &base, 1, 0.0);
        samples[3].tau.pop();
        assert!(matches!(identify(&model, &base, &samples), Err(IdentifyError::Lengths { .. })));
        samples[3].tau.push(f64::NAN);
        assert!(matches!(identify(&model, &base, &samples), Err(IdentifyError::NotFinite { .. })));
        let still = Sample { q: vec![0.1; 2], v: vec![0.0; 2], a: vec![0.0; 2], tau: vec![1.0; 2] };
        let found = identify(&model, &base, &vec![still; 50]);
        assert!(matches!(found, Err(IdentifyError::Dependent { .. })), "{found:?}");
        assert!(matches!(identify(&model, &base, &[]), Err(IdentifyError::TooFew { .. })));
        let limits = [RANGE, JointRange { lower: 2.0, ..RANGE }];
        assert!(matches!(
            excitation(&model, &base, &limits, 4.0, 5, 1),
            Err(IdentifyError::NoRoom { joint: 1, .. })
        ));
    }

    #[test]
    fn the_same_seed_gives_the_same_motion() {
        let model = planar(2, [0.0, -9.81, 0.0]);
        let base = BaseParameters::of(&model, 50, 1);
        let once = |seed| excitation(&model, &base, &[RANGE; 2], 4.0, 5, seed).unwrap();
        assert_eq!(once(4), once(4));
        assert_ne!(once(4), once(5));
    }
}
