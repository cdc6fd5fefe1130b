//! What the engine makes of a model, compared with the reference.

use super::model::Model;
use super::reference::{Outcome, Undecided, refer};
use super::text::{diagram, integral, shown};
use super::variants::Variant;
use crate::{Run, compile_text, run};

/// What is wrong: at which node, what was expected, what was found.
#[allow(missing_docs, reason = "fields say what they are")]
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The engine refuses the model or stops.
    Refused(String),
    /// A node has jumped more or less often.
    Jumps { node: usize, expected: u32, found: u32 },
    /// The value of a node in the end.
    End { node: usize, expected: f64, found: f64 },
    /// The integral of a node.
    Integral { node: usize, expected: f64, found: f64 },
}

/// What became of a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Both agree.
    Right,
    /// They do not; all that is wrong.
    Wrong(Vec<Fault>),
    /// Nobody knows.
    Undecided(Undecided),
}

impl Fault {
    /// What kind of fault it is.
    pub fn class(&self) -> &'static str {
        match self {
            Fault::Refused(_) => "refused",
            Fault::Jumps { .. } => "jumps",
            Fault::End { .. } => "end",
            Fault::Integral { .. } => "integral",
        }
    }

    /// The node that shows it.
    pub fn node(&self) -> Option<usize> {
        match self {
            Fault::Refused(_) => None,
            Fault::Jumps { node, .. } | Fault::End { node, .. } | Fault::Integral { node, .. } => Some(*node),
        }
    }
}

/// Runs a model twice and compares.
pub fn judge(model: &Model, variant: &Variant) -> Verdict {
    match refer(model) {
        Err(reason) => Verdict::Undecided(reason),
        Ok(outcome) => compare(model, &outcome, variant),
    }
}

/// Compares the engine with what is known.
pub fn compare(model: &Model, outcome: &Outcome, variant: &Variant) -> Verdict {
    let (compiled, problems) = compile_text(&diagram(model, variant));
    let Some(schedule) = compiled.schedule else {
        return Verdict::Wrong(vec![Fault::Refused(problems)]);
    };
    let run = run(schedule);
    if let Some(error) = &run.error {
        return Verdict::Wrong(vec![Fault::Refused(format!("{} {}", error.code, error.message))]);
    }
    let faults = faults(model, outcome, &run);
    if faults.is_empty() { Verdict::Right } else { Verdict::Wrong(faults) }
}

fn faults(model: &Model, outcome: &Outcome, run: &Run) -> Vec<Fault> {
    let mut faults = Vec::new();
    for node in 0..model.nodes.len() {
        let column = run.column(&shown(node));
        if let Some((wide, all)) = outcome.toggles[node] {
            let found = jumps(&run.time, column, 0.0);
            // A value that lasts no longer than the bracket of an event, such as the sign of exactly zero, may be seen or not: the step behind it is short.
            let lasting = jumps(&run.time, column, 1e-7);
            if ![wide, all].contains(&found) && ![wide, all].contains(&lasting) {
                faults.push(Fault::Jumps { node, expected: wide, found });
            }
        }
        let (expected, found) = (outcome.ends[node], run.last(&shown(node)));
        if is_off(expected, found, outcome.end_slack[node]) {
            faults.push(Fault::End { node, expected, found });
        }
    }
    for (i, &node) in model.probes.iter().enumerate() {
        let (expected, found) = (outcome.integrals[i], run.last(&integral(node)));
        if is_off(expected, found, outcome.integral_slack[i]) {
            faults.push(Fault::Integral { node, expected, found });
        }
    }
    faults
}

/// How often a column changes; what lasts no longer than `moment` does not count.
fn jumps(time: &[f64], column: &[f64], moment: f64) -> u32 {
    let lasts =
        |i: &usize| *i == 0 || time.get(i + 1).is_none_or(|next| next - time[*i] > moment) || moment == 0.0;
    let seen: Vec<f64> = (0..column.len()).filter(lasts).map(|i| column[i]).collect();
    seen.windows(2).filter(|two| two[0] != two[1]).count() as u32
}

fn is_off(expected: f64, found: f64, slack: f64) -> bool {
    (expected - found).abs() > slack || found.is_nan()
}
