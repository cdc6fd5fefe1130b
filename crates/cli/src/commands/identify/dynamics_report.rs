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
    /// Unit of the torque or force of each joint.
    pub units: Vec<&'static str>,
    /// Joints, from 1, on which more acts than bodies and noise.
    pub unexplained: Vec<usize>,
    /// More for programs.
    pub facts: Value,
}

impl Dynamics {
    /// Whether an interval holds the value that is set, or both are the same but for rounding.
    fn holds(&self, index: usize) -> bool {
        /// Rounding of values, over the largest of them.
        const ROUNDING: f64 = 1e-10;
        let (found, truth) = (&self.found.fit.estimates[index], self.truth[index]);
        let largest = self.truth.iter().map(|truth| truth.abs()).fold(0.0, f64::max);
        found.holds(truth) || (found.value - truth).abs() <= ROUNDING * largest
    }

    /// The unit of all joints, if it is one.
    fn unit(&self) -> Option<&'static str> {
        let first = *self.units.first()?;
        self.units.iter().all(|unit| *unit == first).then_some(first)
    }
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
        let holds = result.holds(index);
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
    // Where some joints turn and others slide, each value has its unit.
    let unit = result.unit().map_or(String::new(), |unit| format!(" [{unit}]"));
    let (residual, error) = (format!("residual{unit}"), format!("another motion, error{unit}"));
    let mut heads = vec![("joint", Align::Right), (residual.as_str(), Align::Right)];
    if result.prediction.is_some() {
        heads.extend([(error.as_str(), Align::Right), ("of its torque", Align::Right)]);
    }
    let mut joints = Table::new(&heads);
    for (joint, residual) in result.found.residuals.iter().enumerate() {
        let of = |value: f64| match result.unit() {
            Some(_) => significant(value, 3),
            None => format!("{} {}", significant(value, 3), result.units[joint]),
        };
        let mut row = vec![format!("{}", joint + 1), of(*residual)];
        if let Some((wrong, size)) = &result.prediction {
            let share = 100.0 * wrong[joint] / size[joint];
            row.extend([of(wrong[joint]), format!("{} %", significant(share, 2))]);
        }
        joints.row(row);
    }
    let _ = write!(out, "\n{}", joints.render());
    for joint in &result.unexplained {
        let _ = writeln!(
            out,
            "note: the torque of joint {joint} is not that of bodies and noise alone; something else acts on it, and the \
             values above hold a part of that"
        );
    }
    out
}

/// For programs: an object a line, the last about the whole.
pub fn as_json(result: &Dynamics) -> String {
    let mut out = String::new();
    for (index, (found, truth)) in result.found.fit.estimates.iter().zip(&result.truth).enumerate() {
        let value = json!({
            "base_parameter": result.base.name(index), "value": found.value, "standard_error": found.error,
            "interval_95": found.interval, "set": truth, "inside": result.holds(index),
        });
        let _ = writeln!(out, "{}", super::typed("base_parameter", value));
    }
    let (wrong, size) = result.prediction.clone().unzip();
    let mut value = json!({ "residuals": result.found.residuals, "prediction_errors": wrong, "torques": size,
        "units": result.units, "unexplained": result.unexplained });
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
