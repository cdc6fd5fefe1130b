//! Accounts of energy, put into diagrams that have none.

use std::path::Path;

use blocksim_block::schedule::{Schedule, Solver, VariableMethod};

use crate::{Desk, Run, compile_with};

/// What the port of an account can be.
const PORTS: [&str; 5] = ["Rotational", "Translational", "Electrical", "ThreePhase", "Frame"];

/// Compiles a diagram with an account in each of its physical networks; `inside` is the file of it that names their
/// ports, with this text. `None` when it has no network.
///
/// # Panics
/// Panics when the diagram has errors, or a network does not show itself in `inside`.
pub fn with_accounts(path: &Path, inside: &Path, text: &str, overrides: &[&str]) -> Option<Schedule> {
    let attempt = |accounts: &[(String, &str)]| {
        let desk = Desk::new().with(inside.to_str().unwrap_or_default(), &text_with(text, accounts));
        compile_with(&desk, path, overrides)
    };
    let covered = |schedule: &Schedule| networks(schedule).iter().filter(|(_, has)| *has).count();
    let (plain, problems) = attempt(&[]);
    let mut best = plain.schedule.unwrap_or_else(|| panic!("{}: {problems}", path.display()));
    let all = networks(&best).len();
    let mut accounts: Vec<(String, &str)> = Vec::new();
    for port in ports(text) {
        for kind in PORTS {
            if covered(&best) == all {
                break;
            }
            accounts.push((port.clone(), kind));
            match attempt(&accounts).0.schedule.filter(|schedule| covered(schedule) > covered(&best)) {
                Some(schedule) => best = schedule,
                None => _ = accounts.pop(),
            }
        }
    }
    assert_eq!(covered(&best), all, "{}: no account in some of {:?}", path.display(), networks(&best));
    (all > 0).then_some(best)
}

/// Paths of the physical networks of a schedule, each with whether it has an account.
fn networks(schedule: &Schedule) -> Vec<(&str, bool)> {
    let networks = schedule.blocks.iter().filter(|block| block.path.starts_with("network("));
    let has = |name: &str| name.contains("account_") && name.ends_with(".supplied_energy");
    networks
        .map(|block| (block.path.as_str(), block.interface.states.iter().any(|state| has(&state.name))))
        .collect()
}

/// The text of a diagram with an account at each of these ports.
fn text_with(text: &str, accounts: &[(String, &str)]) -> String {
    let (mut blocks, mut connections) = (String::new(), String::new());
    for (i, (port, kind)) in accounts.iter().enumerate() {
        blocks += &format!(
            r#""account_{i}": EnergyAccount(at: {kind}, tolerance: None),
               "energy_{i}": Scope(inputs: ["error", "turned_over"]), "#
        );
        connections += &format!(
            r#""{port} <-> account_{i}.node", "account_{i}.error -> energy_{i}.error",
               "account_{i}.turned_over -> energy_{i}.turned_over", "#
        );
    }
    let text = text.replacen("blocks: {", &format!("blocks: {{ {blocks}"), 1);
    text.replacen("connections: [", &format!("connections: [ {connections}"), 1)
}

/// Conserving ports that a diagram names, one for each connection.
fn ports(text: &str) -> Vec<String> {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let strings = lines.flat_map(|line| line.split('"'));
    strings.filter_map(|string| Some(string.split_once("<->")?.0.trim().to_owned())).collect()
}

/// Largest error of all accounts over the largest energy that each has seen turned over.
///
/// # Panics
/// Panics when the run failed, or an error is not a number.
pub fn imbalance(run: &Run) -> f64 {
    assert!(run.error.is_none(), "{:?}", run.error);
    let errors = run.recorded.iter().filter_map(|recorded| recorded.path.strip_suffix(".error"));
    let of = |path: &str| {
        let largest = |name: &str| {
            let column = run.column(&format!("{path}.{name}")).iter();
            column.fold(0.0, |max: f64, value| if value.is_nan() { f64::NAN } else { max.max(value.abs()) })
        };
        let relative = largest("error") / largest("turned_over");
        assert!(relative.is_finite(), "`{path}` is not a number");
        relative
    };
    errors.filter(|path| path.contains("energy_")).map(of).fold(0.0, f64::max)
}

/// The same diagram with another method and tolerance.
pub fn solved_by(mut schedule: Schedule, method: VariableMethod, tolerance: f64) -> Schedule {
    schedule.settings.solver =
        Solver::Variable { method, rtol: tolerance, atol: Some(tolerance), max_step: f64::INFINITY };
    schedule
}
