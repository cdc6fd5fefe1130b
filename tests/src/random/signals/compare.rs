//! What the engine makes of a model, compared with the reference.

use super::super::puzzle::Fault;
use super::model::Model;
use super::reference::Outcome;
use super::text::{integral, shown};
use crate::Run;

/// The first difference, if there is one.
pub(super) fn compare(model: &Model, outcome: &Outcome, run: &Run) -> Option<Fault> {
    let name = |node: usize| format!("node {node} ({})", model.nodes[node].law.kind());
    for node in 0..model.nodes.len() {
        let column = run.column(&shown(node));
        if let Some((wide, all)) = outcome.toggles[node] {
            let mut known = vec![wide, all];
            let others = outcome.others.iter().filter_map(|toggles| toggles[node]);
            others.for_each(|(wide, all)| known.extend([wide, all]));
            let found = jumps(&run.time, column, 0.0);
            // A value that lasts no longer than the bracket of an event, such as the sign of exactly zero, may be seen or not: the step behind it is short.
            let lasting = jumps(&run.time, column, 1e-7);
            if !known.contains(&found) && !known.contains(&lasting) {
                let what = format!("{} has jumped {found} times instead of {wide}", name(node));
                return Some(Fault::new("jumps", what));
            }
        }
        let (expected, slack) = (outcome.ends[node], outcome.end_slack[node]);
        let fault = Fault::value("end", &name(node), run.last(&shown(node)), expected, slack);
        if fault.is_some() {
            return fault;
        }
    }
    model.probes.iter().enumerate().find_map(|(i, &node)| {
        let (expected, slack) = (outcome.integrals[i], outcome.integral_slack[i]);
        let name = format!("the integral of {}", name(node));
        Fault::value("integral", &name, run.last(&integral(node)), expected, slack)
    })
}

/// How often a column changes; what lasts no longer than `moment` does not count.
fn jumps(time: &[f64], column: &[f64], moment: f64) -> u32 {
    let lasts =
        |i: &usize| *i == 0 || time.get(i + 1).is_none_or(|next| next - time[*i] > moment) || moment == 0.0;
    let seen: Vec<f64> = (0..column.len()).filter(lasts).map(|i| column[i]).collect();
    seen.windows(2).filter(|two| two[0] != two[1]).count() as u32
}
