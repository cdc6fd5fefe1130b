//! `blocksim identify dynamics --from`.

use blocksim_identify::{BaseParameters, Recording, Treated, identify, prediction_error};
use blocksim_numbers::format::significant;
use blocksim_robotics::motion::AxisKind;
use serde_json::json;

use super::dynamics::{SAMPLES, no_base, root_mean_square};
use super::dynamics_report::{Dynamics, as_json, counted, csv, text};
use super::out;
use super::recorded::{Arm, Table, arm};
use crate::args::identify::{DynamicsArgs, RecordedArgs};
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Where the flagship records speeds and accelerations.
const SPEEDS: &str = "measurements/velocities/*.axis{}";
const ACCELERATIONS: &str = "measurements/accelerations/*.axis{}";

/// Finds the base parameters of a robot from a recorded motion.
///
/// # Errors
/// Why they cannot be found or written.
pub fn dynamics(args: &DynamicsArgs, from: &str, console: Console) -> Outcome {
    let result = found(args, from)?;
    if let Some(path) = &args.common.out {
        write_file(path, csv(&result).as_bytes(), args.common.yes)?;
    }
    console.data(&if args.common.json { as_json(&result) } else { text(&result) })?;
    Ok(Exit::Done)
}

fn found(args: &DynamicsArgs, from: &str) -> Result<Dynamics, Failure> {
    out::check(args.common.out.as_deref(), args.common.yes, &["csv"])?;
    let arm = arm(&args.common)?;
    let model = arm.robot.model();
    let base = BaseParameters::of(model, SAMPLES, 1);
    let read = |name: &str| read(&args.recorded, name, &arm);
    let (treated, how) = read(from)?;
    let found = identify(model, &base, &treated.samples).map_err(|error| no_base(&error))?;
    let prediction = match &args.predict {
        None => None,
        Some(other) => {
            let (other, _) = read(other)?;
            let values: Vec<f64> = found.fit.estimates.iter().map(|estimate| estimate.value).collect();
            let wrong =
                prediction_error(model, &base, &values, &other.samples).map_err(|error| no_base(&error))?;
            Some((wrong, root_mean_square(&other.samples, model.dof())))
        }
    };
    let heading = format!(
        "{}, condition number {}\nfrom `{from}`: {how}",
        counted(&base),
        significant(found.fit.condition, 3)
    );
    Ok(Dynamics {
        heading,
        truth: base.values(&model.inertial_parameters()),
        facts: json!({
            "condition": found.fit.condition, "rows": treated.samples.len(), "every": treated.every,
            "derived": treated.filtered, "cutoff": treated.filtered.then_some(args.recorded.cutoff),
        }),
        units: arm.description.kinds().into_iter().map(unit).collect(),
        unexplained: Vec::new(),
        prediction,
        base,
        found,
    })
}

/// Unit of what moves an axis.
pub fn unit(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Turning => "N*m",
        AxisKind::Sliding => "N",
    }
}

/// Positions, speeds, accelerations and torques of all joints, and how they were come by.
pub fn read(args: &RecordedArgs, name: &str, arm: &Arm) -> Result<(Treated, String), Failure> {
    let table = Table::open(name)?;
    let treated = recording(args, &table, arm)?
        .samples(args.cutoff, args.rows)
        .map_err(|error| Failure::usage(format!("`{name}` cannot be evaluated: {error}")))?;
    let how = described(&treated, &table, args.cutoff);
    Ok((treated, how))
}

/// What a table holds of the joints.
pub fn recording(args: &RecordedArgs, table: &Table, arm: &Arm) -> Result<Recording, Failure> {
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
