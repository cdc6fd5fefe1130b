//! What is told of parameters that were found.

use std::path::Path;

use blocksim_identify::Fitted;
use blocksim_numbers::format::significant;
use blocksim_terminal::{Align, Table};
use serde_json::json;

use super::parameters::Compared;
use crate::running::varied::Parameter;
use crate::terminal::render::plural;

/// Correlation above which two parameters are hardly separated.
const ALIKE: f64 = 0.99;
/// Digits of a value that is to be typed.
const DIGITS: usize = 8;

/// What was found.
pub struct Found<'a> {
    pub model: &'a Path,
    pub set: &'a [String],
    pub parameters: &'a [Parameter],
    /// Values at the start, in SI.
    pub start: &'a [f64],
    /// Why the slopes by a parameter are differences of runs.
    pub ways: &'a [Option<&'a str>],
    pub compared: &'a [Compared],
    pub fitted: &'a Fitted,
    /// Why there is no run beyond what was found, where the search ended at such an edge.
    pub edge: Option<&'a str>,
    /// Runs that were made.
    pub runs: usize,
}

impl Found<'_> {
    /// Of each compared signal how far the model was off at the start, and is now, as root mean squares in its unit.
    fn differences(&self) -> Vec<(f64, f64)> {
        let mut at = 0;
        let mut all = Vec::new();
        for signal in self.compared {
            let rows = at..at + signal.values.len();
            let rms = |values: &[f64]| {
                let squares = values[rows.clone()].iter().zip(&signal.values).map(|(a, b)| (a - b).powi(2));
                (squares.sum::<f64>() / signal.values.len() as f64).sqrt() * scale(signal)
            };
            all.push((rms(&self.fitted.before), rms(&self.fitted.values)));
            at += signal.values.len();
        }
        all
    }

    /// Pairs of parameters that are hardly separated.
    fn alike(&self) -> Vec<(&str, &str, f64)> {
        let names = |n: usize| self.parameters[n].name.as_str();
        let pairs = (0..self.parameters.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
        let of = |(j, i): (usize, usize)| (names(j), names(i), self.fitted.correlations[(j, i)]);
        pairs.map(of).filter(|(.., correlation)| correlation.is_nan() || correlation.abs() >= ALIKE).collect()
    }
}

fn scale(signal: &Compared) -> f64 {
    signal.unit.from_si(1.0) - signal.unit.from_si(0.0)
}

/// For people.
pub fn text(found: &Found) -> String {
    let mut table = Table::new(&[
        ("parameter", Align::Left),
        ("at the start", Align::Right),
        ("found", Align::Right),
        ("± 95 %", Align::Right),
        ("unit", Align::Left),
    ]);
    let estimates = found.fitted.fit.estimates.iter();
    for ((parameter, start), estimate) in found.parameters.iter().zip(found.start).zip(estimates) {
        let unit = parameter.unit.to_string();
        table.row([
            parameter.name.as_str(),
            &significant(parameter.unit.from_si(*start), 6),
            &significant(parameter.unit.from_si(estimate.value), 6),
            &significant(estimate.interval / parameter.scale(), 2),
            if unit == "1" { "" } else { &unit },
        ]);
    }
    let mut text = table.render();
    text.push('\n');
    let mut table = Table::new(&[
        ("signal", Align::Left),
        ("rows", Align::Right),
        ("off by, at the start", Align::Right),
        ("now", Align::Right),
        ("unit", Align::Left),
    ]);
    for (signal, (before, now)) in found.compared.iter().zip(found.differences()) {
        let unit = signal.unit.to_string();
        table.row([
            signal.path.as_str(),
            &signal.values.len().to_string(),
            &significant(before, 4),
            &significant(now, 4),
            if unit == "1" { "" } else { &unit },
        ]);
    }
    text.push_str(&table.render());
    text.push_str(&format!(
        "\n{}, {}; differences are root mean squares\n",
        plural(found.fitted.steps, "step"),
        plural(found.runs, "run")
    ));
    for signal in found.compared.iter().filter(|signal| signal.left_out > 0) {
        text.push_str(&format!("{} of `{}` are not compared\n", plural(signal.left_out, "row"), signal.path));
    }
    if found.fitted.stalled {
        text.push_str(
            "note: the slopes promise a better fit than any run nearby has, as where the model jumps; begin elsewhere with --set\n",
        );
    }
    for (parameter, way) in found.parameters.iter().zip(found.ways) {
        if let Some(why) = way {
            text.push_str(&format!("slopes by `{}` are differences of runs: {why}\n", parameter.name));
        }
    }
    for (parameter, estimate) in found.parameters.iter().zip(&found.fitted.fit.estimates) {
        let is_known = estimate.interval < estimate.value.abs();
        if !is_known && estimate.value != 0.0 {
            text.push_str(&format!(
                "note: the measurement does not determine `{}`: its interval is wider than its value\n",
                parameter.name
            ));
        }
    }
    for (a, b, correlation) in found.alike() {
        text.push_str(&format!(
            "`{a}` and `{b}` are hardly separated: the correlation of their errors is {correlation:.4}\n"
        ));
    }
    if let Some(why) = found.edge {
        text.push_str(&format!(
            "note: the search ended where the model has no run beyond ({why}), so that these values need not be the best\n"
        ));
    }
    text.push_str(&format!("\nblocksim run {}{}\n", found.model.display(), sets(found)));
    text
}

/// The options with which a model runs with what was found.
fn sets(found: &Found) -> String {
    let name = |set: &str| set.split_once('=').map_or(set, |(name, _)| name).trim().to_owned();
    let is_found = |set: &&String| found.parameters.iter().any(|parameter| parameter.name == name(set));
    let others = found.set.iter().filter(|set| !is_found(set)).cloned();
    let values = found.parameters.iter().zip(&found.fitted.fit.estimates).map(|(parameter, estimate)| {
        // Rounded where nobody sees it.
        let shown = parameter.unit.from_si(estimate.value);
        let rounded = format!("{shown:.*e}", DIGITS).parse::<f64>().unwrap_or(shown);
        parameter.written(parameter.unit.to_si(rounded))
    });
    others
        .chain(values)
        .map(|set| {
            if set.contains([' ', '*', '(', '"']) {
                format!(" --set '{set}'")
            } else {
                format!(" --set {set}")
            }
        })
        .collect()
}

/// For programs: an object for each parameter, and one for all.
pub fn json(found: &Found) -> String {
    let mut text = String::new();
    let estimates = found.fitted.fit.estimates.iter();
    for (((parameter, start), estimate), way) in
        found.parameters.iter().zip(found.start).zip(estimates).zip(found.ways)
    {
        let one = json!({
            "parameter": parameter.name,
            "unit": parameter.unit.to_string(),
            "start": parameter.unit.from_si(*start),
            "value": parameter.unit.from_si(estimate.value),
            "standard_error": estimate.error / parameter.scale(),
            "interval_95": estimate.interval / parameter.scale(),
            "by_differences": way,
        });
        text.push_str(&format!("{}\n", super::typed("parameter", one)));
    }
    let signals: Vec<_> = found
        .compared
        .iter()
        .zip(found.differences())
        .map(|(signal, (before, now))| {
            json!({ "signal": signal.path, "unit": signal.unit.to_string(), "rows": signal.values.len(), "left_out": signal.left_out, "before": before, "now": now })
        })
        .collect();
    let alike: Vec<_> =
        found.alike().into_iter().map(|(a, b, correlation)| json!([a, b, correlation])).collect();
    let all = json!({ "signals": signals, "steps": found.fitted.steps, "runs": found.runs, "alike": alike, "edge": found.edge, "stalled": found.fitted.stalled });
    text.push_str(&format!("{}\n", super::typed("parameters", all)));
    text
}
