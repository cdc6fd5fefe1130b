//! What is told of base parameters.

use std::collections::BTreeSet;
use std::fmt::Write;

use blocksim_identify::{BaseParameters, Identified};
use blocksim_numbers::format::significant;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use crate::terminal::render::plural;

/// Signs of a combination in a table.
const WIDE: usize = 44;

/// What was found out.
pub struct Dynamics {
    /// From what.
    pub heading: String,
    /// Which combinations.
    pub base: BaseParameters,
    /// Their values.
    pub found: Identified,
    /// What the parameters say.
    pub truth: Vec<f64>,
    /// Of another motion, for each joint: what is predicted wrong, and the torque, both as root mean squares.
    pub prediction: Option<(Vec<f64>, Vec<f64>)>,
    /// More for programs.
    pub facts: Value,
}

/// How many parameters there are.
pub fn counted(base: &BaseParameters) -> String {
    let grouped: BTreeSet<usize> =
        base.parameters.iter().flat_map(|parameter| &parameter.others).map(|(index, _)| *index).collect();
    let all = base.without_effect.len() + base.len() + grouped.len();
    format!("{} of {all} inertial ones", plural(base.len(), "base parameter"))
}

/// For people.
pub fn text(result: &Dynamics) -> String {
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
    let mut out = format!("{}\n\n", result.heading);
    out.push_str(&table.render());
    let _ = writeln!(
        out,
        "\n{inside} of {} intervals hold the value of the parameters (kg, kg*m, kg*m^2; the last digit of a name is the body)",
        result.truth.len()
    );
    let mut heads = vec![("joint", Align::Right), ("residual [N*m]", Align::Right)];
    if result.prediction.is_some() {
        heads.extend([("another motion, error [N*m]", Align::Right), ("of its torque", Align::Right)]);
    }
    let mut joints = Table::new(&heads);
    for (joint, residual) in result.found.residuals.iter().enumerate() {
        let mut row = vec![format!("{}", joint + 1), significant(*residual, 3)];
        if let Some((wrong, size)) = &result.prediction {
            let share = 100.0 * wrong[joint] / size[joint];
            row.extend([significant(wrong[joint], 3), format!("{} %", significant(share, 2))]);
        }
        joints.row(row);
    }
    let _ = write!(out, "\n{}", joints.render());
    out
}

/// For programs: an object a line, the last about the whole.
pub fn as_json(result: &Dynamics) -> String {
    let mut out = String::new();
    for (index, (found, truth)) in result.found.fit.estimates.iter().zip(&result.truth).enumerate() {
        let value = json!({
            "base_parameter": result.base.name(index), "value": found.value, "standard_error": found.error,
            "interval_95": found.interval, "set": truth, "inside": found.holds(*truth),
        });
        let _ = writeln!(out, "{}", super::typed("base_parameter", value));
    }
    let (wrong, size) = result.prediction.clone().unzip();
    let mut value =
        json!({ "residuals": result.found.residuals, "prediction_errors": wrong, "torques": size });
    if let (Some(value), Some(facts)) = (value.as_object_mut(), result.facts.as_object()) {
        value.extend(facts.clone());
    }
    let _ = writeln!(out, "{}", super::typed("dynamics", value));
    out
}

/// As a table.
pub fn csv(result: &Dynamics) -> String {
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
