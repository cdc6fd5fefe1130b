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

fn experiment(motion: &Excitation, period: f64) -> Experiment {
    let courses = motion.joints.iter().map(|joint| Arc::new(joint.clone()) as Arc<dyn Course>);
    Experiment {
        courses: courses.collect(),
        measured: (0..motion.joints.len()).collect(),
        end: period,
        every: period / ROWS,
    }
}

fn samples(bench: &Bench, rows: &Rows) -> Vec<Sample> {
    let instants = rows.values.chunks_exact(bench.axes.len());
    let sample = |now: &[[f64; 5]]| {
        let of = |k: usize| -> Vec<f64> { now.iter().map(|row| row[k]).collect() };
        Sample { q: of(0), v: of(1), a: of(2), tau: of(3) }
    };
    instants.map(sample).collect()
}

/// Root mean square of the torques of each joint.
pub fn root_mean_square(samples: &[Sample], joints: usize) -> Vec<f64> {
    let count = samples.len().max(1) as f64;
    let of = |joint: usize| samples.iter().map(|sample| sample.tau[joint].powi(2)).sum::<f64>();
    (0..joints).map(|joint| (of(joint) / count).sqrt()).collect()
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
