//! How far a run is from a more exact one, in words and as data.

use std::sync::Arc;

use blocksim_block::schedule::{Schedule, Solver};
use blocksim_host::Death;
use blocksim_numbers::format::significant;
use blocksim_sim::{Control, Difference, SimError, Verification};
use serde_json::{Value, json};

use crate::exit::Exit;
use crate::running::blame::failure;
use crate::running::rescue;
use crate::terminal::format::short_time;
use crate::terminal::render::plural;

/// Part of the range of a signal by which runs may differ: a line in a picture is about as wide.
const VISIBLE: f64 = 1e-3;
/// Signals that are listed.
const LISTED: usize = 8;

/// What became of it.
pub enum Verified {
    /// Both runs have ended.
    Compared(Verification),
    /// Somebody did not want to wait.
    Interrupted,
    /// One of the two has failed.
    Failed(SimError),
}

/// Runs a model twice and compares.
pub fn verify(schedule: &Arc<Schedule>) -> Verified {
    let mut go_on = || if blocksim_host::was_interrupted() { Control::Stop } else { Control::Go };
    // The results of the run are kept; a plug-in that dies ends the program with its name.
    let told = |death: &Death| {
        let problem = failure(&rescue::failure(death, schedule), schedule);
        crate::terminal::console::notice(&format!("error: not verified: {}", problem.message));
        Exit::Failed
    };
    match rescue::during(told, || blocksim_sim::verify(schedule, &mut go_on)) {
        Ok(Some(found)) => Verified::Compared(found),
        Ok(None) => Verified::Interrupted,
        Err(_) if blocksim_host::was_interrupted() => Verified::Interrupted,
        Err(error) => Verified::Failed(error),
    }
}

impl Verified {
    /// What the program says to the shell, if all else went well.
    pub fn exit(&self) -> Exit {
        match self {
            Verified::Compared(found) if visible(found).next().is_none() => Exit::Done,
            Verified::Compared(_) | Verified::Failed(_) => Exit::Failed,
            Verified::Interrupted => Exit::Interrupted,
        }
    }

    /// A note, or an error where a difference can be seen.
    pub fn text(&self, schedule: &Schedule) -> String {
        match self {
            Verified::Compared(found) => text(found, schedule),
            Verified::Interrupted => "note: not verified, since it was interrupted".to_owned(),
            Verified::Failed(error) => {
                let help = error.help.as_ref().map_or_else(String::new, |help| format!("\n  = help: {help}"));
                format!("error: not verified, at t = {} s: {}{help}", short_time(error.t), error.message)
            }
        }
    }

    /// The same as an object.
    pub fn json(&self, schedule: &Schedule) -> Value {
        let path = |found: &Difference| schedule.recorded[found.recorded].path.clone();
        let difference = |found: &Difference| json!({ "signal": path(found), "time": found.t, "amount": found.amount, "share": found.share });
        match self {
            Verified::Compared(found) => json!({
                "v": 1, "type": "verified", "against": against(&found.method), "points": found.points,
                "events": [found.events.0, found.events.1],
                "differences": found.differences.iter().map(difference).collect::<Vec<_>>(),
            }),
            Verified::Interrupted => json!({ "v": 1, "type": "verified", "against": null }),
            Verified::Failed(error) => {
                json!({ "v": 1, "type": "verified", "against": null, "failed": error.message, "time": error.t })
            }
        }
    }
}

/// Differences that can be seen.
fn visible(found: &Verification) -> impl Iterator<Item = &Difference> {
    found.differences.iter().take_while(|difference| difference.share > VISIBLE)
}

fn text(found: &Verification, schedule: &Schedule) -> String {
    let how = match found.method {
        Solver::Variable { rtol, .. } => format!("a run at rtol {rtol:e}"),
        Solver::Fixed { step, .. } => format!("a run with steps of {} s", short_time(step)),
    };
    let points = plural(found.points, "time");
    let seen: Vec<&Difference> = visible(found).collect();
    let mut text = if seen.is_empty() {
        let worst = found.differences.first().map_or_else(
            || "no signal differs".to_owned(),
            |worst| format!("no signal differs by more than {} of its range", percent(worst.share)),
        );
        format!("note: verified by {how} at {points}: {worst}")
    } else {
        format!("error: {how} differs by more than {} of the range of a signal", percent(VISIBLE))
    };
    for difference in seen.iter().take(LISTED) {
        let path = &schedule.recorded[difference.recorded].path;
        let (share, t) = (percent(difference.share), short_time(difference.t));
        text += &format!("\n  = note: `{path}` by {share} of its range, at t = {t} s");
    }
    if seen.len() > LISTED {
        text += &format!("\n  = note: and {} more", plural(seen.len() - LISTED, "signal"));
    }
    if found.events.0 != found.events.1 {
        text +=
            &format!("\n  = note: {} in this run, {} in that one", plural_of(found.events.0), found.events.1);
    }
    if !seen.is_empty() {
        let finer = match found.method {
            Solver::Variable { rtol, .. } => format!("`--rtol {rtol:e}`"),
            Solver::Fixed { step, .. } => format!("`--step {step}`"),
        };
        text += &format!(
            "\n  = help: run it with {finer} and verify that; where the differences do not become smaller, the model amplifies what no tolerance can hold, and its course cannot be predicted"
        );
    }
    text
}

fn plural_of(events: u64) -> String {
    plural(usize::try_from(events).unwrap_or(usize::MAX), "event")
}

/// A share with two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if (0.001..1000.0).contains(&percent) {
        format!("{} %", significant(percent, 2))
    } else {
        format!("{percent:.0e} %")
    }
}

fn against(method: &Solver) -> Value {
    match method {
        Solver::Variable { rtol, .. } => json!({ "rtol": rtol }),
        Solver::Fixed { step, .. } => json!({ "step": step }),
    }
}
