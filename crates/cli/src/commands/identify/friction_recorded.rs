//! `blocksim identify friction --from`.

use std::fmt::Write;

use blocksim_identify::{DriveFit, DriveSample, Estimate, Recording, drive};
use blocksim_numbers::format::significant;
use blocksim_robotics::motion::AxisKind;
use blocksim_terminal::{Align, Table as Printed};
use serde_json::json;

use super::dynamics_recorded::{described, recording, unit};
use super::friction::no_axis;
use super::out;
use super::recorded::{Arm, Table, arm};
use crate::args::identify::FrictionArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Speeds below this share of the largest one of a recording are left out: near standstill friction is no line.
const SLOWEST: f64 = 0.1;

/// An axis that was evaluated.
struct Axis {
    number: usize,
    kind: AxisKind,
    ratio: f64,
    found: Result<DriveFit, String>,
    /// What the parameters say: gear, Coulomb, viscous, inertia.
    set: [f64; 4],
}

/// Finds gear, friction and inertia of drives from a recorded motion.
///
/// # Errors
/// Why they cannot be found or written.
pub fn friction(args: &FrictionArgs, from: &str, console: Console) -> Outcome {
    let (heading, axes) = found(args, from)?;
    if let Some(path) = &args.common.out {
        write_file(path, csv(&axes).as_bytes(), args.common.yes)?;
    }
    console.data(&if args.common.json { as_json(&axes) } else { text(&heading, &axes) })?;
    Ok(if axes.iter().all(|axis| axis.found.is_ok()) { Exit::Done } else { Exit::Failed })
}

fn found(args: &FrictionArgs, from: &str) -> Result<(String, Vec<Axis>), Failure> {
    out::check(args.common.out.as_deref(), args.common.yes, &["csv"])?;
    if !args.speeds.is_empty() {
        return Err(Failure::usage("a recording has the speeds that it has").help("leave out --speeds"));
    }
    let arm = arm(&args.common)?;
    let count = arm.robot.axes();
    if let Some(wrong) = args.axis.iter().find(|number| !(1..=count).contains(*number)) {
        return Err(no_axis(*wrong, count));
    }
    let table = Table::open(from)?;
    let motors = table.signals("--motor", &args.motor, &vec!["N*m"; count])?;
    let joints = recording(&args.recorded, &table, &arm)?;
    let filtered = joints.v.is_none() || joints.a.is_none();
    // The motors in the place of the joints pass the same filter and give the same instants.
    let motors = Recording { tau: motors, ..joints.clone() };
    let treat = |recording: &Recording| {
        recording
            .samples(args.recorded.cutoff, args.recorded.rows)
            .map_err(|error| Failure::usage(format!("`{from}` cannot be evaluated: {error}")))
    };
    let (joints, motors) = (treat(&joints)?, treat(&motors)?);
    let mut axes = Vec::new();
    for axis in (0..count).filter(|axis| args.axis.is_empty() || args.axis.contains(&(axis + 1))) {
        let (ratio, set) = set(&arm, axis)?;
        let rows = joints.samples.iter().zip(&motors.samples);
        let samples: Vec<DriveSample> = rows
            .map(|(joint, motor)| DriveSample {
                speed: joint.v[axis],
                acceleration: joint.a[axis],
                joint: joint.tau[axis],
                motor: ratio * motor.tau[axis],
            })
            .collect();
        let fastest = samples.iter().map(|sample| sample.speed.abs()).fold(0.0, f64::max);
        let found = drive(&samples, SLOWEST * fastest).map_err(|error| error.to_string());
        axes.push(Axis { number: axis + 1, kind: arm.robot.limits()[axis].kind, ratio, found, set });
    }
    let how = described(&joints, &table, args.recorded.cutoff);
    let note = if filtered { "; friction has a band that no low pass leaves whole" } else { "" };
    Ok((format!("from `{from}`: {how}{note}"), axes))
}

/// Ratio of an axis, and what its parameters say of 1 / efficiency, Coulomb and viscous friction, inertia.
fn set(arm: &Arm, axis: usize) -> Result<(f64, [f64; 4]), Failure> {
    let link = &arm.description.links[axis];
    let ratio = link.transmission("manipulator").map_err(|error| Failure::parameter(&error))?;
    let drive = &arm.robot.parts().links[axis].drive;
    let gear = 1.0 / drive.efficiency_forward;
    let viscous = gear * drive.friction.viscous + drive.damping;
    Ok((ratio, [gear, gear * drive.friction.coulomb, viscous, drive.inertia]))
}

/// Names, units and values of what was found.
fn rows(axis: &Axis, fit: &DriveFit) -> [(&'static str, &'static str, Estimate, f64); 4] {
    let [gear, coulomb, viscous, inertia] = axis.set;
    let units = match axis.kind {
        AxisKind::Turning => ["1", "N*m", "N*m*s/rad", "kg*m^2"],
        AxisKind::Sliding => ["1", "N", "N*s/m", "kg"],
    };
    [
        ("1 / efficiency", units[0], fit.gear, gear),
        ("Coulomb", units[1], fit.coulomb, coulomb),
        ("viscous", units[2], fit.viscous, viscous),
        ("inertia", units[3], fit.inertia, inertia),
    ]
}

fn text(heading: &str, axes: &[Axis]) -> String {
    let mut out = format!("Drives, brought to the joints\n{heading}\n");
    for axis in axes {
        let fit = match &axis.found {
            Ok(fit) => fit,
            Err(error) => {
                let _ = writeln!(out, "\nAxis {}: {error}", axis.number);
                continue;
            }
        };
        let _ = writeln!(
            out,
            "\nAxis {} (ratio {}), {} instants in which the motor drives, residual {} {}",
            axis.number,
            significant(axis.ratio, 4),
            fit.used,
            significant(fit.fit.residual, 2),
            unit(axis.kind)
        );
        let mut table = Printed::new(&[
            ("", Align::Left),
            ("identified", Align::Right),
            ("± 95 %", Align::Right),
            ("parameters", Align::Right),
            ("deviation", Align::Right),
            ("", Align::Left),
        ]);
        for (name, unit, found, set) in rows(axis, fit) {
            table.row([
                format!("  {name}"),
                significant(found.value, 5),
                significant(found.interval, 2),
                significant(set, 5),
                format!("{:+.2} %", 100.0 * (found.value / set - 1.0)),
                if unit == "1" { String::new() } else { unit.to_owned() },
            ]);
        }
        out.push_str(&table.render());
    }
    out
}

fn as_json(axes: &[Axis]) -> String {
    let mut out = String::new();
    for axis in axes {
        let value = match &axis.found {
            Err(error) => json!({ "axis": axis.number, "error": error }),
            Ok(fit) => {
                let mut value = json!({ "axis": axis.number, "ratio": axis.ratio, "rows": fit.used,
                    "residual": fit.fit.residual, "condition": fit.fit.condition });
                for (name, key) in rows(axis, fit).iter().zip(["gear", "coulomb", "viscous", "inertia"]) {
                    let (_, _, found, set) = name;
                    value[key] = json!({ "value": found.value, "standard_error": found.error,
                        "interval_95": found.interval, "set": set });
                }
                value
            }
        };
        let _ = writeln!(out, "{}", super::typed("friction", value));
    }
    out
}

fn csv(axes: &[Axis]) -> String {
    let mut out = String::from("axis,quantity,unit,value,standard error,interval 95 %,set\n");
    for axis in axes {
        let Ok(fit) = &axis.found else { continue };
        for (name, unit, found, set) in rows(axis, fit) {
            let _ = writeln!(
                out,
                "{},{name},{unit},{},{},{},{set}",
                axis.number, found.value, found.error, found.interval
            );
        }
    }
    out
}
