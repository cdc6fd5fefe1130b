//! `blocksim identify dynamics`.

use std::sync::Arc;

use blocksim_identify::{
    BaseParameters, Excitation, Fourier, IdentifyError, JointRange, Random, Sample, excitation, identify,
    prediction_error,
};
use blocksim_numbers::format::significant;
use serde_json::json;

use super::bench::{Bench, Experiment, Rows};
use super::course::Course;
use super::dynamics_report::{Dynamics, as_json, counted, csv, text};
use super::failure::failed;
use super::pose::range;
use super::{load_bench, out};
use crate::args::identify::DynamicsArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::interrupt;
use crate::terminal::console::Console;

/// Rows of a motion.
const ROWS: f64 = 400.0;
/// Random motions from which the base parameters are found.
pub const SAMPLES: usize = 60;

impl Course for Fourier {
    fn at(&self, t: f64) -> [f64; 3] {
        Fourier::at(self, t)
    }
}

/// Finds the base parameters of a robot from an exciting motion.
///
/// # Errors
/// Why they cannot be found or written.
pub fn dynamics(args: &DynamicsArgs, console: Console) -> Outcome {
    out::check(args.common.out.as_deref(), args.common.yes, &["csv"])?;
    let bench = load_bench(&args.common, console)?;
    interrupt::take_over();
    refuse_forces(&bench)?;
    let base = BaseParameters::of(&bench.tree, SAMPLES, 1);
    let ranges: Vec<JointRange> = bench
        .axes
        .iter()
        .map(|axis| {
            let (lower, upper) = range(&axis.limits);
            JointRange { lower, upper, speed: axis.limits.speed, acceleration: axis.limits.acceleration }
        })
        .collect();
    let motion = |seed: u64| excitation(&bench.tree, &base, &ranges, args.period, args.harmonics, seed);
    let motions = motion(args.seed).and_then(|first| Ok([first, motion(args.seed.wrapping_add(1))?]));
    let motions = motions.map_err(|error| unidentified(&format!("no exciting motion: {error}")))?;
    let experiments: Vec<Experiment> = motions.iter().map(|motion| experiment(motion, args.period)).collect();
    let mut recorded = Vec::new();
    for rows in bench.run_all(&experiments, |_| ()) {
        match rows {
            Ok(rows) => recorded.push(samples(&bench, &rows)),
            Err(error) => return Err(failed(&error, 1)),
        }
    }
    let [first, second] = &mut recorded[..] else { return Ok(Exit::Failed) };
    add_noise(first, args.noise, args.seed);
    let found = identify(&bench.tree, &base, first).map_err(|error| no_base(&error))?;
    let values: Vec<f64> = found.fit.estimates.iter().map(|estimate| estimate.value).collect();
    let wrong = prediction_error(&bench.tree, &base, &values, second);
    let heading = format!(
        "{}, from {} instants of a motion with condition number {}; noise {} % of the torques",
        counted(&base),
        first.len(),
        significant(motions[0].condition, 3),
        significant(100.0 * args.noise, 3)
    );
    let result = Dynamics {
        heading,
        truth: base.values(&bench.tree.inertial_parameters()),
        prediction: Some((wrong.unwrap_or_default(), root_mean_square(second, bench.axes.len()))),
        units: vec!["N*m"; bench.axes.len()],
        unexplained: unexplained(&found.residuals, &root_mean_square(first, bench.axes.len()), args.noise),
        facts: json!({ "condition": motions[0].condition, "rows": first.len(), "noise": args.noise }),
        base,
        found,
    };
    if let Some(path) = &args.common.out {
        write_file(path, csv(&result).as_bytes(), args.common.yes)?;
    }
    console.data(&if args.common.json { as_json(&result) } else { text(&result) })?;
    Ok(Exit::Done)
}

/// Why nothing could be identified.
fn unidentified(message: &str) -> Failure {
    Failure::new(Exit::Failed, "identify", message)
}

/// Why there are no base parameters.
pub fn no_base(error: &IdentifyError) -> Failure {
    unidentified(&format!("the base parameters cannot be identified: {error}"))
}

/// Refuses what acts on the bodies beside the torques of the joints: the base parameters would hold it.
fn refuse_forces(bench: &Bench) -> Result<(), Failure> {
    let forces = bench.forces();
    if forces.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = forces.iter().map(|path| format!("`{path}`")).collect();
    let message = format!("forces of {} act on the bodies beside the drives", names.join(", "));
    Err(Failure::new(Exit::Model, "identify", message).help("leave these blocks out for the measurement"))
}

fn experiment(motion: &Excitation, period: f64) -> Experiment {
    let courses = motion.joints.iter().map(|joint| Arc::new(joint.clone()) as Arc<dyn Course>);
    Experiment {
        courses: courses.collect(),
        measured: (0..motion.joints.len()).collect(),
        end: period,
        every: period / ROWS,
    }
}

/// What was recorded, with the torques of the springs and dampers in the joints, which act beside those of the actuators.
fn samples(bench: &Bench, rows: &Rows) -> Vec<Sample> {
    let instants = rows.values.chunks_exact(bench.axes.len());
    let sample = |now: &[[f64; 5]]| {
        let of = |k: usize| -> Vec<f64> { now.iter().map(|row| row[k]).collect() };
        let inside = now.iter().enumerate().map(|(axis, row)| bench.inside(axis, row[0], row[1]));
        let tau = now.iter().zip(inside).map(|(row, inside)| row[3] + inside).collect();
        Sample { q: of(0), v: of(1), a: of(2), tau }
    };
    instants.map(sample).collect()
}

/// Root mean square of the torques of each joint.
pub fn root_mean_square(samples: &[Sample], joints: usize) -> Vec<f64> {
    let count = samples.len().max(1) as f64;
    let of = |joint: usize| samples.iter().map(|sample| sample.tau[joint].powi(2)).sum::<f64>();
    (0..joints).map(|joint| (of(joint) / count).sqrt()).collect()
}

/// Joints, from 1, whose torques differ from those of the bodies by far more than the noise that was added.
fn unexplained(residuals: &[f64], torques: &[f64], noise: f64) -> Vec<usize> {
    /// Residual over the noise, and without noise over the torque.
    const FAR: f64 = 3.0;
    const EXACT: f64 = 1e-3;
    let is_far = |residual: f64, torque: f64| residual > (FAR * noise).max(EXACT) * torque;
    let joints = residuals.iter().zip(torques).zip(1..);
    joints.filter(|((residual, torque), _)| is_far(**residual, **torque)).map(|(_, joint)| joint).collect()
}

/// Adds normal noise to the torques, a share of the root mean square of each joint.
fn add_noise(samples: &mut [Sample], share: f64, seed: u64) {
    let joints = samples.first().map_or(0, |sample| sample.tau.len());
    let size = root_mean_square(samples, joints);
    let mut random = Random::new(seed ^ 0x006e_6f69_7365);
    for sample in samples {
        for (tau, size) in sample.tau.iter_mut().zip(&size) {
            *tau += share * size * random.normal();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_far_above_the_noise_is_noticed() {
        // With 1 % of 100 N*m the residual is 1 N*m; 30 N*m of a spring are something else.
        assert_eq!(unexplained(&[1.0, 30.0, 1.1], &[100.0; 3], 0.01), [2]);
        assert_eq!(unexplained(&[1e-9, 0.5], &[100.0; 2], 0.0), [2]);
    }
}
