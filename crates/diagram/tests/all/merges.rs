//! Outputs of conditional subsystems that are merged into one signal.

use crate::conditional::{GAIN, INTEGRAL};
use crate::texts::{Run, compiled, failure, run};

/// The files of a model in which the outputs of an integrator and of a gain are merged.
fn merged(blocks: &str, connections: &str) -> Vec<(&'static str, String)> {
    let model = format!(
        r#"Diagram(
            simulation: (stop_time: "4 s", solver: Ode45(rtol: 1e-9)),
            blocks: {{ "time": Clock, {blocks}, "show": Scope(inputs: ["y"]) }},
            connections: ["merge.y -> show.y", {connections}],
        )"#
    );
    vec![("model.ron", model), ("rise.ron", INTEGRAL.to_owned()), ("gain.ron", GAIN.to_owned())]
}

fn run_merged(blocks: &str, connections: &str) -> Run {
    let files = merged(blocks, connections);
    run(&files.iter().map(|(name, text)| (*name, text.as_str())).collect::<Vec<_>>())
}

const CHOSEN: &str = r#"
    "one": Constant(value: 1), "choice": IfElse(conditions: ["t < 1 s", "t < 3 s"]),
    "rise": Subsystem(file: "rise.ron", enable: Held), "twice": Subsystem(file: "gain.ron", enable: Held)"#;
const LED: &str = r#"
    "time.y -> choice.t, twice.u", "one.y -> rise.u", "rise.y -> merge.u1", "twice.y -> merge.u2",
    "choice.y1 -> rise.enable", "choice.y2 -> twice.enable""#;

#[test]
fn an_if_else_with_a_merge_gives_what_the_chosen_subsystem_gives() {
    let run = run_merged(&format!("{CHOSEN}, \"merge\": Merge"), LED);
    // The integral of 1 up to 1 s, twice the time up to 3 s, then what that was.
    let exact = |t: f64| [t, 2.0 * t, 6.0][usize::from(t >= 1.0) + usize::from(t >= 3.0)];
    let mut jumps = 0;
    for (t, y) in run.column("show.y") {
        let near = [exact(t), exact(t - 1e-9)];
        assert!(near.iter().any(|x| (x - y).abs() < 1e-8), "{y} at {t} s instead of {near:?}");
        jumps += usize::from(near[0] - near[1] > 0.5);
    }
    assert!(jumps >= 2, "rows on both sides of the jump");
    assert!((run.last("show.y") - 6.0).abs() < 1e-9);
    for (event, t) in [("rise is disabled", 1.0), ("twice is enabled", 1.0), ("twice is disabled", 3.0)] {
        let times = run.times(event);
        assert!(times.len() == 1 && (times[0] - t).abs() < 1e-9, "{event}: {times:?}");
    }
}

#[test]
fn a_switch_case_chooses_by_numbers_and_states_are_held_or_reset() {
    let with = |enable: &str| {
        let blocks = format!(
            r#""number": SignalBuilder(points: [(0, 1), ("1 s", 1), ("1 s", 5), ("2 s", 5), ("2 s", 1)]),
            "one": Constant(value: 1), "case": SwitchCase(cases: [[1, 2]]), "merge": Merge,
            "rise": Subsystem(file: "rise.ron", enable: {enable}),
            "twice": Subsystem(file: "gain.ron", enable: Held)"#
        );
        run_merged(
            &blocks,
            r#""number.y -> case.u", "one.y -> rise.u", "time.y -> twice.u", "case.y1 -> rise.enable",
            "case.default -> twice.enable", "rise.y -> merge.u1", "twice.y -> merge.u2""#,
        )
    };
    for (enable, from) in [("Held", 1.0), ("Reset", 0.0)] {
        let exact = |t: f64| [t, 2.0 * t, from + t - 2.0][usize::from(t >= 1.0) + usize::from(t >= 2.0)];
        for (t, y) in with(enable).column("show.y") {
            let near = [exact(t), exact(t - 1e-9)];
            assert!(near.iter().any(|x| (x - y).abs() < 1e-8), "{enable}: {y} at {t} s, not {near:?}");
        }
    }
}

#[test]
fn a_merge_gives_its_initial_value_until_a_subsystem_has_run() {
    let blocks = r#""late": Compare(operator: Greater, constant: 2), "merge": Merge(initial: -3),
        "never": Constant(value: -1), "twice": Subsystem(file: "gain.ron", enable: Held),
        "other": Subsystem(file: "gain.ron", trigger: Rising)"#;
    let connections = r#""time.y -> late.u, twice.u, other.u", "late.y -> twice.enable", "never.y -> other.trigger",
        "twice.y -> merge.u1", "other.y -> merge.u2""#;
    for (t, y) in run_merged(blocks, connections).column("show.y") {
        let near = [t, t - 1e-9].map(|t| if t >= 2.0 { 2.0 * t } else { -3.0 });
        assert!(near.iter().any(|x| (x - y).abs() < 1e-8), "{y} at {t} s");
    }
    let files = merged(&blocks.replace("Merge(initial: -3)", "Merge"), connections);
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let failure = failure(&files);
    assert!(failure.contains("none of `twice` and `other` has run yet"), "{failure}");
}

/// A merge inside of a subsystem holds its output while that is disabled, and begins anew when it is enabled again.
#[test]
fn a_merge_inside_of_a_subsystem_is_reset_when_that_runs_again() {
    let inside = r#"Diagram(inputs: {"u": ()}, outputs: {"y": "merge.y"},
        blocks: { "small": Compare(operator: Less, constant: 2), "never": Compare(operator: Less, constant: -1),
            "twice": Subsystem(file: "gain.ron", enable: Held), "other": Subsystem(file: "gain.ron", enable: Held), "merge": Merge(initial: 0.25) },
        connections: ["in.u -> small.u, twice.u, never.u, other.u", "small.y -> twice.enable", "never.y -> other.enable",
            "twice.y -> merge.u1", "other.y -> merge.u2"])"#;
    for (enable, again) in [("Held", 2.2), ("Reset", 0.25)] {
        let model = format!(
            r#"Diagram(
                simulation: (stop_time: "4 s", solver: Ode45(rtol: 1e-9), output: Every("0.1 s")),
                blocks: {{ "time": Clock, "choice": IfElse(conditions: ["t < 1.1 s", "t < 3 s"]), "any": Logic(operator: Or),
                    "part": Subsystem(file: "part.ron", enable: {enable}), "show": Scope(inputs: ["y"]) }},
                connections: ["time.y -> choice.t, part.u", "choice.y1 -> any.u1", "choice.else -> any.u2", "any.y -> part.enable",
                    "part.y -> show.y"],
            )"#
        );
        let files = [("model.ron", &*model), ("part.ron", inside), ("gain.ron", GAIN)];
        for (t, y) in run(&files).column("show.y") {
            let exact = |t: f64| [2.0 * t, 2.2, again][usize::from(t >= 1.1) + usize::from(t >= 3.0)];
            let near = [exact(t), exact(t - 1e-9)];
            assert!(near.iter().any(|x| (x - y).abs() < 1e-8), "{enable}: {y} at {t} s, not {near:?}");
        }
    }
}

#[test]
fn subsystems_that_run_at_the_same_time_cannot_be_merged() {
    let blocks = CHOSEN.replace("\"t < 3 s\"", "\"t > 5 s\"");
    let connections = LED.replace("choice.y2 -> twice.enable", "over.y -> twice.enable");
    let blocks = format!("{blocks}, \"merge\": Merge, \"over\": Compare(operator: Greater, constant: 0.5)");
    let connections = connections.replace("time.y ->", "time.y -> over.u,");
    let files = merged(&blocks, &connections);
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let failure = failure(&files);
    assert!(
        failure.contains("`rise` and `twice` run at the same time") && failure.contains("0.5"),
        "{failure}"
    );
}

#[test]
fn what_a_merge_takes_comes_from_different_conditional_subsystems() {
    let refused = |blocks: &str, connections: &str| {
        let files = merged(blocks, connections);
        let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
        compiled(&files).err().unwrap_or_default()
    };
    let from_block = LED.replace("twice.y -> merge.u2", "time.y -> merge.u2");
    let problems = refused(&format!("{CHOSEN}, \"merge\": Merge"), &from_block);
    assert!(problems.contains("conditional: `merge.u2` does not come from a subsystem"), "{problems}");
    let twice = LED.replace("twice.y -> merge.u2", "rise.y -> merge.u2");
    let problems = refused(&format!("{CHOSEN}, \"merge\": Merge"), &twice);
    assert!(problems.contains("merges two outputs of `rise`"), "{problems}");
    let always = CHOSEN.replace("\"gain.ron\", enable: Held", "\"gain.ron\"");
    let problems =
        refused(&format!("{always}, \"merge\": Merge"), &LED.replace(", \"choice.y2 -> twice.enable\"", ""));
    assert!(problems.contains("`merge.u2` does not come from a subsystem with `enable`"), "{problems}");
}

/// Two levels: a merge inside of a conditional subsystem stands still with it.
#[test]
fn a_merge_within_a_conditional_subsystem_holds_while_that_does_not_run() {
    let inner = r#"Diagram(inputs: { "t": (), "first": (), "second": () }, outputs: { "y": "merge.y" },
        blocks: { "a": Subsystem(file: "gain.ron", enable: Held), "b": Subsystem(file: "rise.ron", enable: Held), "merge": Merge },
        connections: ["in.t -> a.u, b.u", "in.first -> a.enable", "in.second -> b.enable", "a.y -> merge.u1", "b.y -> merge.u2"])"#;
    let model = r#"Diagram(
        simulation: (stop_time: "4 s", solver: Ode45(rtol: 1e-9)),
        blocks: { "time": Clock, "choice": IfElse(conditions: ["t < 1 s"]), "on": IfElse(conditions: ["and(t > 2 s, t < 3 s)"]),
            "both": Subsystem(file: "both.ron", enable: Held), "show": Scope(inputs: ["y"]) },
        connections: ["time.y -> choice.t, on.t, both.t", "choice.y1 -> both.first", "choice.else -> both.second",
            "on.else -> both.enable", "both.y -> show.y"],
    )"#;
    let run = run(&[("model.ron", model), ("both.ron", inner), ("gain.ron", GAIN), ("rise.ron", INTEGRAL)]);
    let exact = |t: f64| match t {
        t if t < 1.0 => 2.0 * t,
        t if t < 2.0 => (t * t - 1.0) / 2.0,
        t if t < 3.0 => 1.5,
        t => 1.5 + (t * t - 9.0) / 2.0,
    };
    for (t, y) in run.column("show.y") {
        let near = [exact(t), exact(t - 1e-9)];
        assert!(near.iter().any(|x| (x - y).abs() < 1e-7), "{y} at {t} s instead of {near:?}");
    }
}
