//! What was found out about friction, in words and as data.

use std::fmt::Write;

use blocksim_identify::{CurveFit, Estimate};
use blocksim_numbers::format::significant;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::axis_friction::{AxisFriction, TakenFriction};

/// Part of a friction that is rounding.
const ROUNDING: f64 = 1e-9;

/// Four digits.
pub fn short(x: f64) -> String {
    significant(x, 4)
}

/// One found quantity: name, unit, estimate and what is set.
struct Row {
    name: &'static str,
    key: &'static str,
    unit: &'static str,
    found: Estimate,
    set: Option<f64>,
}

/// The parts of a friction that are more than rounding.
fn amounts(part: &TakenFriction) -> String {
    let all = [
        (part.viscous, "N*m*s/rad"),
        (part.coulomb, "N*m against the motion"),
        (part.constant, "N*m in both directions"),
    ];
    let largest = all.iter().map(|(amount, _)| amount.abs()).fold(0.0, f64::max);
    let counted = all.iter().filter(|(amount, _)| amount.abs() > ROUNDING * largest);
    counted.map(|(amount, what)| format!("{} {what}", short(*amount))).collect::<Vec<_>>().join(", ")
}

/// Whether a friction is damping of the motor.
fn is_plain(part: &TakenFriction) -> bool {
    part.is_at_motor && part.coulomb.abs().max(part.constant.abs()) <= ROUNDING * part.viscous.abs()
}

fn line_rows(result: &AxisFriction) -> Vec<Row> {
    let Ok(line) = &result.line else { return Vec::new() };
    let set = result.set_line;
    let row = |name, key, unit, found, set| Row { name, key, unit, found, set };
    vec![
        row("viscous", "viscous", "N*m*s/rad", line.viscous, set.map(|set| set.0)),
        row("Coulomb", "coulomb", "N*m", line.coulomb, set.map(|set| set.1)),
    ]
}

fn bearing_rows(result: &AxisFriction) -> Vec<Row> {
    let Ok(curve) = &result.curve else { return Vec::new() };
    let set = result.set_bearing;
    let row = |name, key, unit, found, set| Row { name, key, unit, found, set };
    let mut rows = vec![
        row("viscous", "viscous", "N*m*s/rad", curve.viscous, set.map(|set| set.viscous)),
        row("Coulomb", "coulomb", "N*m", curve.coulomb, set.map(|set| set.coulomb)),
    ];
    if curve.shows_breakaway() {
        let velocity = set.map(|set| set.breakaway_velocity);
        rows.extend([
            row("breakaway", "breakaway", "N*m", curve.breakaway, set.map(|set| set.breakaway)),
            row("breakaway velocity", "breakaway_velocity", "rad/s", curve.breakaway_velocity, velocity),
        ]);
    }
    rows
}

fn table(rows: &[Row]) -> String {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("identified", Align::Right),
        ("± 95 %", Align::Right),
        ("parameters", Align::Right),
        ("deviation", Align::Right),
        ("", Align::Left),
    ]);
    for row in rows {
        let off = row.set.filter(|set| *set != 0.0).map(|set| 100.0 * (row.found.value / set - 1.0));
        table.row([
            format!("  {}", row.name),
            significant(row.found.value, 5),
            significant(row.found.interval, 2),
            row.set.map_or("-".to_owned(), |set| significant(set, 5)),
            off.map_or("-".to_owned(), |off| format!("{off:+.2} %")),
            row.unit.to_owned(),
        ]);
    }
    table.render()
}

/// For people.
pub fn text(results: &[AxisFriction]) -> String {
    let mut out = String::new();
    for result in results {
        let pose: Vec<String> = result.pose.q.iter().map(|q| format!("{:.1}", q.to_degrees())).collect();
        let gravity = match result.pose.slope == 0.0 {
            true => "no gravity on it",
            false => "gravity balanced and taken out by both directions",
        };
        let _ = writeln!(
            out,
            "Axis {} (`{}`), pose {} deg: {gravity}",
            result.number,
            result.joint,
            pose.join(" ")
        );
        let used = result.measured.iter().filter(|m| m.is_steady && m.is_driving).count();
        let speeds = result.measured.iter().map(|m| m.point.speed.abs().to_degrees());
        let (low, high) = speeds.fold((f64::INFINITY, 0.0), |(a, b), x| (x.min(a), x.max(b)));
        let _ = writeln!(
            out,
            "  {used} of {} moves used, {} to {} deg/s",
            result.measured.len(),
            short(low),
            short(high)
        );
        let left_out = result.measured.iter().filter(|m| !(m.is_steady && m.is_driving));
        let unsteady: Vec<String> = left_out.map(|m| significant(m.point.speed.to_degrees(), 2)).collect();
        if !unsteady.is_empty() {
            let why = "not used, for the speed was not constant or gravity drove the motor";
            let _ = writeln!(out, "  {why}: {} deg/s", unsteady.join(", "));
        }
        let _ = writeln!(
            out,
            "\n  Torque of the motor, brought to the joint (gear {} and motor included)",
            short(result.ratio)
        );
        match &result.line {
            Ok(line) => {
                out.push_str(&table(&line_rows(result)));
                if let Some((two, half, full)) = &result.two_point {
                    let _ = writeln!(
                        out,
                        "  two points, {} and {} deg/s: viscous {} N*m*s/rad, Coulomb {} N*m",
                        short(half.to_degrees()),
                        short(full.to_degrees()),
                        significant(two.viscous, 5),
                        significant(two.coulomb, 5)
                    );
                }
                let _ = writeln!(
                    out,
                    "  residual {} N*m, gravity left {} N*m",
                    significant(line.fit.residual, 2),
                    significant(line.offset.value, 2)
                );
            }
            Err(reason) => {
                let _ = writeln!(out, "  not identified: {reason}");
            }
        }
        let of_motor: f64 = result.taken.iter().filter(|part| is_plain(part)).map(|part| part.viscous).sum();
        let _ = writeln!(
            out,
            "\n  The bearing alone (efficiency {} of the gear, {} N*m*s/rad of the motor taken from the parameters)",
            short(result.train.efficiency()),
            short(of_motor)
        );
        for part in result.taken.iter().filter(|part| !is_plain(part)) {
            let _ = writeln!(
                out,
                "  taken from the parameters as well, at the joint: {} of `{}`",
                amounts(part),
                part.path
            );
        }
        match &result.curve {
            Ok(curve) => {
                out.push_str(&table(&bearing_rows(result)));
                let _ = writeln!(out, "  residual {} N*m", significant(curve.residual, 2));
                if !curve.shows_breakaway() {
                    let _ = writeln!(out, "  breakaway not identified: {}", no_breakaway(curve));
                }
            }
            Err(reason) => {
                let _ = writeln!(out, "  not identified: {reason}");
            }
        }
        for note in &result.notes {
            let _ = writeln!(out, "  note: {note}");
        }
        out.push('\n');
    }
    out
}

/// Why there is no breakaway torque.
fn no_breakaway(curve: &CurveFit) -> String {
    format!(
        "{} of the speeds used shows it, and two are needed",
        if curve.slow == 0 { "none" } else { "one" }
    )
}

fn estimates(rows: &[Row]) -> Value {
    let one = |row: &Row| {
        let value = json!({
            "value": row.found.value, "standard_error": row.found.error, "interval_95": row.found.interval,
            "set": row.set, "unit": row.unit,
        });
        (row.key.to_owned(), value)
    };
    Value::Object(rows.iter().map(one).collect())
}

/// As JSON, an axis a line.
pub fn json(results: &[AxisFriction]) -> String {
    let mut out = String::new();
    for result in results {
        let points: Vec<Value> = result
            .measured
            .iter()
            .map(|m| {
                json!({
                    "speed": m.point.speed, "torque": m.point.torque, "inertial": m.inertial,
                    "used": m.is_steady && m.is_driving,
                })
            })
            .collect();
        let two = result.two_point.map(|(two, half, full)| {
            json!({ "viscous": two.viscous, "coulomb": two.coulomb, "speeds": [half, full] })
        });
        let taken = result
            .taken
            .iter()
            .map(|part| json!({ "part": part.path, "viscous": part.viscous, "coulomb": part.coulomb, "constant": part.constant }));
        let value = json!({
            "axis": result.number, "joint": result.joint, "pose": result.pose.q,
            "gravity_slope": result.pose.slope, "ratio": result.ratio,
            "at_the_motor": estimates(&line_rows(result)),
            "residual": result.line.as_ref().ok().map(|line| line.fit.residual),
            "two_point": two,
            "bearing": estimates(&bearing_rows(result)),
            "not_identified": [
                result.line.as_ref().err().cloned(),
                match &result.curve {
                    Err(reason) => Some(reason.clone()),
                    Ok(curve) => (!curve.shows_breakaway()).then(|| no_breakaway(curve)),
                },
            ],
            "taken": taken.collect::<Vec<_>>(), "notes": result.notes,
            "points": points,
        });
        let _ = writeln!(out, "{}", super::typed("friction", value));
    }
    out
}

/// The points, for a spreadsheet.
pub fn csv(results: &[AxisFriction]) -> String {
    let mut out = String::from("axis,speed [rad/s],torque [N*m],inertial [N*m],used\n");
    for result in results {
        for m in &result.measured {
            let used = u8::from(m.is_steady && m.is_driving);
            let _ =
                writeln!(out, "{},{},{},{},{used}", result.number, m.point.speed, m.point.torque, m.inertial);
        }
    }
    out
}

/// What was identified, in the form of parameters.
pub fn ron(results: &[AxisFriction]) -> String {
    let mut out = String::from("// Friction of the bearings, identified; note: interval of 95 %.\n(\n");
    for result in results {
        let _ = writeln!(out, "    axis{}: (bearing: (", result.number);
        for row in bearing_rows(result) {
            let (found, unit) = (row.found, row.unit);
            let _ = writeln!(
                out,
                "        {}: (value: \"{} {unit}\", note: \"± {} {unit}\"),",
                row.key,
                found.value,
                significant(found.interval, 2)
            );
        }
        out.push_str("    )),\n");
    }
    out.push_str(")\n");
    out
}
