//! `blocksim identify dynamics --from`.

use std::io;

use blocksim_identify::{BaseParameters, Recording, Treated, identify, prediction_error};
use blocksim_motion::AxisKind;
use blocksim_results::format::significant;
use serde_json::json;

use super::dynamics::{SAMPLES, root_mean_square};
use super::dynamics_said::{Outcome, as_json, counted, csv, text};
use super::out;
use super::recorded::{Arm, Table, arm};
use crate::args::identify::{DynamicsArgs, RecordedArgs};
use crate::exit::Exit;
use crate::terminal::console::Console;

/// Where the flagship records speeds and accelerations.
const SPEEDS: &str = "measurements/velocities/*.axis{}";
const ACCELERATIONS: &str = "measurements/accelerations/*.axis{}";

/// Finds the base parameters of a robot from a recorded motion.
///
/// # Errors
/// If the standard output cannot be written.
pub fn dynamics(args: &DynamicsArgs, from: &str, console: Console) -> io::Result<Exit> {
    match found(args, from, console) {
        Ok(result) => {
            if let Some(path) = &args.common.out
                && let Err(error) = out::write(path, &csv(&result))
            {
                console.say(&error);
                return Ok(Exit::Files);
            }
            console.data(&if args.common.json { as_json(&result) } else { text(&result) })?;
            Ok(Exit::Done)
        }
        Err((said, exit)) => {
            if !said.is_empty() {
                console.say(&said);
            }
            Ok(exit)
        }
    }
}

fn found(args: &DynamicsArgs, from: &str, console: Console) -> Result<Outcome, (String, Exit)> {
    out::check(args.common.out.as_deref(), args.common.yes, &["csv"])
        .map_err(|refusal| (refusal.text(), Exit::Usage))?;
    let arm = arm(&args.common, console)?;
    let model = arm.robot.model();
    let base = BaseParameters::of(model, SAMPLES, 1);
    let read = |name: &str| read(&args.recorded, name, &arm);
    let (treated, how) = read(from)?;
    let failed = |error: blocksim_identify::IdentifyError| {
        (format!("error: the base parameters cannot be identified: {error}"), Exit::Failed)
    };
    let found = identify(model, &base, &treated.samples).map_err(failed)?;
    let prediction = match &args.predict {
        None => None,
        Some(other) => {
            let (other, _) = read(other)?;
            let values: Vec<f64> = found.fit.estimates.iter().map(|estimate| estimate.value).collect();
            let wrong = prediction_error(model, &base, &values, &other.samples).map_err(failed)?;
            Some((wrong, root_mean_square(&other.samples, model.dof())))
        }
    };
    let heading = format!(
        "{}, condition number {}\nfrom `{from}`: {how}",
        counted(&base),
        significant(found.fit.condition, 3)
    );
    Ok(Outcome {
        heading,
        truth: base.values(&model.inertial_parameters()),
        facts: json!({
            "condition": found.fit.condition, "rows": treated.samples.len(), "every": treated.every,
            "derived": treated.filtered, "cutoff": treated.filtered.then_some(args.recorded.cutoff),
        }),
        prediction,
        base,
        found,
    })
}

/// Positions, speeds, accelerations and torques of all joints, and how they were come by.
pub fn read(args: &RecordedArgs, name: &str, arm: &Arm) -> Result<(Treated, String), (String, Exit)> {
    let table = Table::open(name)?;
    let treated = recording(args, &table, arm)?
        .samples(args.cutoff, args.rows)
        .map_err(|error| (format!("error: `{name}` cannot be evaluated: {error}"), Exit::Usage))?;
    let how = described(&treated, &table, args.cutoff);
    Ok((treated, how))
}

/// What a table holds of the joints.
pub fn recording(args: &RecordedArgs, table: &Table, arm: &Arm) -> Result<Recording, (String, Exit)> {
    let kinds = arm.description.kinds();
    let units = |turning: &'static str, sliding: &'static str| -> Vec<&'static str> {
        kinds.iter().map(|kind| if *kind == AxisKind::Turning { turning } else { sliding }).collect()
    };
    let some = |flag: &str, asked: &Option<String>, usual: &str, units: &[&str]| match asked {
        Some(pattern) => table.signals(flag, pattern, units).map(Some),
        None if args.derive || !table.has(usual) => Ok(None),
        None => table.signals(flag, usual, units).map(Some),
    };
    Ok(Recording {
        step: table.step,
        q: table.signals("--q", &args.q, &units("rad", "m"))?,
        v: some("--qd", &args.qd, SPEEDS, &units("rad/s", "m/s"))?,
        a: some("--qdd", &args.qdd, ACCELERATIONS, &units("rad/s^2", "m/s^2"))?,
        tau: table.signals("--tau", &args.tau, &units("N*m", "N"))?,
    })
}

/// How samples were made of a table.
pub fn described(treated: &Treated, table: &Table, cutoff: f64) -> String {
    let taken = match treated.every {
        1 => String::new(),
        every => format!(" (one in {every})"),
    };
    let derived = match treated.filtered {
        true => format!(
            "; derivatives behind a low pass of {} Hz (order 4, without delay), which the torques pass, too",
            significant(cutoff, 3)
        ),
        false => String::new(),
    };
    let apart = 1e3 * table.step * treated.every as f64;
    format!("{} instants {} ms apart{taken}{derived}", treated.samples.len(), significant(apart, 4))
}
