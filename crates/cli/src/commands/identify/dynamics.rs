//! `blocksim identify dynamics`.

use std::fmt::Write;
use std::io;
use std::sync::Arc;

use blocksim_identify::{
    BaseParameters, Excitation, Fourier, Identified, JointRange, Random, Sample, excitation, identify,
    prediction_error,
};
use blocksim_results::format::significant;
use blocksim_results::{Align, Table};
use serde_json::json;

use super::bench::{Bench, Experiment, Rows};
use super::course::Course;
use super::pose::range;
use super::said::failed;
use super::{load_bench, out};
use crate::args::identify::DynamicsArgs;
use crate::exit::Exit;
use crate::running::interrupt;
use crate::terminal::console::Console;

/// Rows of a motion.
const ROWS: f64 = 400.0;
/// Random motions from which the base parameters are found.
const SAMPLES: usize = 60;
/// Signs of a combination in a table.
const WIDE: usize = 44;

impl Course for Fourier {
    fn at(&self, t: f64) -> [f64; 3] {
        Fourier::at(self, t)
    }
}

/// Finds the base parameters of a robot from an exciting motion.
///
/// # Errors
/// If the standard output cannot be written.
pub fn dynamics(args: &DynamicsArgs, console: Console) -> io::Result<Exit> {
    if let Err(refusal) = out::check(args.common.out.as_deref(), args.common.yes, &["csv"]) {
        console.say(&refusal.text());
        return Ok(Exit::Usage);
    }
    let bench = match load_bench(&args.common, console)? {
        Ok(bench) => bench,
        Err(exit) => return Ok(exit),
    };
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
    let motions = match motions {
        Ok(motions) => motions,
        Err(error) => {
            console.say(&format!("error: no exciting motion: {error}"));
            return Ok(Exit::Failed);
        }
    };
    let experiments: Vec<Experiment> = motions.iter().map(|motion| experiment(motion, args.period)).collect();
    let mut recorded = Vec::new();
    for rows in bench.run_all(&experiments, |_| ()) {
        match rows {
            Ok(rows) => recorded.push(samples(&bench, &rows)),
            Err(error) => return Ok(failed(&error, 1, console)),
        }
    }
    let [first, second] = &mut recorded[..] else { return Ok(Exit::Failed) };
    add_noise(first, args.noise, args.seed);
    let found = match identify(&bench.tree, &base, first) {
        Ok(found) => found,
        Err(error) => {
            console.say(&format!("error: the base parameters cannot be identified: {error}"));
            return Ok(Exit::Failed);
        }
    };
    let values: Vec<f64> = found.fit.estimates.iter().map(|estimate| estimate.value).collect();
    let wrong = prediction_error(&bench.tree, &base, &values, second);
    let prediction = wrong.unwrap_or_default();
    let result = Outcome {
        truth: base.values(&bench.tree.inertial_parameters()),
        size: root_mean_square(second, bench.axes.len()),
        condition: motions[0].condition,
        rows: first.len(),
        noise: args.noise,
        base,
        found,
        prediction,
    };
    if let Some(path) = &args.common.out
        && let Err(error) = out::write(path, &csv(&result))
    {
        console.say(&error);
        return Ok(Exit::Files);
    }
    console.data(&if args.common.json { as_json(&result) } else { text(&result) })?;
    Ok(Exit::Done)
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
fn root_mean_square(samples: &[Sample], joints: usize) -> Vec<f64> {
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

/// What was found out.
struct Outcome {
    base: BaseParameters,
    found: Identified,
    truth: Vec<f64>,
    /// Root mean square of the torques of the second motion.
    size: Vec<f64>,
    prediction: Vec<f64>,
    condition: f64,
    rows: usize,
    noise: f64,
}

fn text(result: &Outcome) -> String {
    let mut table = Table::new(&[
        ("base parameter", Align::Left),
        ("identified", Align::Right),
        ("± 95 %", Align::Right),
        ("parameters", Align::Right),
        ("inside", Align::Left),
    ]);
    let mut inside = 0;
    for (index, (found, truth)) in result.found.fit.estimates.iter().zip(&result.truth).enumerate() {
        let holds = found.holds(*truth);
        inside += usize::from(holds);
        let name = result.base.name(index);
        let name = if name.chars().count() > WIDE {
            format!("{} ...", name.chars().take(WIDE - 4).collect::<String>())
        } else {
            name
        };
        table.row([
            name,
            significant(found.value, 5),
            significant(found.interval, 2),
            significant(*truth, 5),
            if holds { "yes" } else { "no" }.to_owned(),
        ]);
    }
    let mut out = format!(
        "{} base parameters of {} inertial ones, from {} instants of a motion with condition number {}; noise {} % of the \
         torques\n\n",
        result.base.len(),
        result.base.without_effect.len()
            + result.base.len()
            + result
                .base
                .parameters
                .iter()
                .flat_map(|p| &p.others)
                .map(|(i, _)| i)
                .collect::<std::collections::BTreeSet<_>>()
                .len(),
        result.rows,
        significant(result.condition, 3),
        significant(100.0 * result.noise, 3)
    );
    out.push_str(&table.render());
    let _ = writeln!(
        out,
        "\n{inside} of {} intervals hold the value of the parameters (kg, kg*m, kg*m^2; the last digit of a name is the body)",
        result.truth.len()
    );
    let mut joints = Table::new(&[
        ("joint", Align::Right),
        ("residual [N*m]", Align::Right),
        ("another motion, error [N*m]", Align::Right),
        ("of its torque", Align::Right),
    ]);
    let rows = result.found.residuals.iter().zip(&result.prediction).zip(&result.size);
    for (joint, ((residual, wrong), size)) in rows.enumerate() {
        joints.row([
            format!("{}", joint + 1),
            significant(*residual, 3),
            significant(*wrong, 3),
            format!("{} %", significant(100.0 * wrong / size, 2)),
        ]);
    }
    let _ = write!(out, "\n{}", joints.render());
    out
}

fn as_json(result: &Outcome) -> String {
    let mut out = String::new();
    for (index, (found, truth)) in result.found.fit.estimates.iter().zip(&result.truth).enumerate() {
        let value = json!({
            "base_parameter": result.base.name(index), "value": found.value, "standard_error": found.error,
            "interval_95": found.interval, "set": truth, "inside": found.holds(*truth),
        });
        let _ = writeln!(out, "{value}");
    }
    let value = json!({
        "residuals": result.found.residuals, "prediction_errors": result.prediction, "torques": result.size,
        "condition": result.condition, "rows": result.rows, "noise": result.noise,
    });
    let _ = writeln!(out, "{value}");
    out
}

fn csv(result: &Outcome) -> String {
    let mut out = String::from("base parameter,value,standard error,interval 95 %,set\n");
    for (index, (found, truth)) in result.found.fit.estimates.iter().zip(&result.truth).enumerate() {
        let _ = writeln!(
            out,
            "{},{},{},{},{truth}",
            result.base.name(index),
            found.value,
            found.error,
            found.interval
        );
    }
    out
}
