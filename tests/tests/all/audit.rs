//! No shipped diagram passes over a change of a condition: every run is looked at on a fine grid. And none has states that the
//! tolerance ignores.

use std::sync::Arc;

use blocksim_block::schedule::Solver;
use blocksim_sim::{Observer, Simulation};
use blocksim_tests::{compile_file, diagrams_below, root, run_text};

struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}
}

/// Runs that make thousands of steps in a second are audited up to this time, s.
const LONGEST: f64 = 0.5;
const MANY_STEPS: [&str; 2] = ["irb2600", "inverter_fed_machine"];

#[test]
fn no_shipped_diagram_passes_over_a_change_of_a_condition() {
    let paths = diagrams_below("diagrams");
    let (mut audited, mut looks, mut wrong) = (0, 0, Vec::new());
    for path in &paths {
        let name = path.strip_prefix(root()).expect("below the root").display().to_string();
        // Parts of models and files of moves are no runs.
        let Some(schedule) = compile_file(&name, &[]).0.schedule else { continue };
        if matches!(schedule.settings.solver, Solver::Fixed { .. }) || schedule.guards == 0 {
            continue;
        }
        let mut end = schedule.settings.stop_time;
        if MANY_STEPS.iter().any(|part| name.contains(part)) {
            end = end.min(LONGEST);
        }
        let mut simulation = Simulation::new(Arc::new(schedule)).expect("a start");
        assert!(simulation.audit());
        if let Err(error) = simulation.run_until(end, &mut Nobody) {
            wrong.push(format!("{name}: {error}"));
            continue;
        }
        let ignored = simulation.warnings().into_iter().find(|warning| warning.code == "ignored_state");
        wrong.extend(ignored.map(|warning| format!("{name}: {}", warning.message)));
        let findings = simulation.findings().expect("an audit");
        if findings.count > 0 || !findings.undeclared.is_empty() {
            wrong.push(format!("{name}: {findings:?}"));
        }
        audited += 1;
        looks += findings.looks;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(audited >= 15 && looks > 1_000_000, "only {audited} runs were audited, at {looks} points");
}

/// Peaks of a sine of 50 Hz in 10 s that a condition for a ninth of a millisecond sees.
fn peaks(solver: &str) -> (f64, Vec<&'static str>) {
    let run = run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "10 s", solver: {solver}),
            blocks: {{
                "mains": Sine(frequency: "50 Hz"), "peak": Compare(operator: Greater, constant: 0.9999), "peaks": Counter,
                "beside": Sine(frequency: "900 Hz"), "nobody": Terminator, "show": Scope, "x": Integrator, "last": Scope,
            }},
            connections: [
                "mains.y -> peak.u, x.u", "peak.y -> peaks.u", "peaks.count -> show.u", "beside.y -> nobody.u", "x.y -> last.u",
            ],
        )"#
    ));
    (run.last("show.u"), run.warnings.iter().map(|warning| warning.code).collect())
}

#[test]
fn a_fixed_step_that_a_source_swings_within_is_told() {
    // Eight steps a period are enough for the source, which is said of methods that choose their steps, too.
    assert_eq!(peaks("Ode45(rtol: 1e-6)"), (500.0, vec![]));
    assert_eq!(peaks("Ode4(step: \"0.05 ms\")"), (500.0, vec![]));
    assert_eq!(peaks("Ode4(step: \"2.5 ms\")").1, Vec::<&str>::new());
    let (seen, warnings) = peaks("Ode4(step: \"7 ms\")");
    assert!(seen < 100.0 && warnings == ["coarse_step"], "{seen} {warnings:?}");
    assert_eq!(peaks("Ode4(step: \"2.51 ms\")").1, ["coarse_step"]);
}

/// A level that a limited gain holds at 1, at the end of a second, and the warnings.
fn limited(solver: &str) -> (f64, Vec<&'static str>) {
    let run = run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "1 s", solver: {solver}),
            blocks: {{
                "setpoint": Constant(value: 1.0), "error": Sum(signs: "+-"), "gain": Gain(k: 1000.0),
                "limit": Saturation(lower: -10.0, upper: 10.0), "level": Integrator, "show": Scope,
            }},
            connections: [
                "setpoint.y -> error.u1", "level.y -> error.u2, show.u",
                "error.y -> gain.u", "gain.y -> limit.u", "limit.y -> level.u",
            ],
        )"#
    ));
    (run.last("show.u"), run.warnings.iter().map(|warning| warning.code).collect())
}

#[test]
fn a_fixed_step_beyond_stability_that_a_limit_hides_is_told() {
    let (level, warnings) = limited("Ode4(step: \"5 ms\")");
    assert!((level - 0.99).abs() < 1e-9 && warnings == ["coarse_step"], "{level} {warnings:?}");
    let (level, warnings) = limited("Ode4(step: \"2 ms\")");
    assert!((level - 1.0).abs() < 1e-9 && warnings.is_empty(), "{level} {warnings:?}");
}

/// A quick lag follows a slow sine: beyond the ends of the real intervals of stability (E. Hairer, G. Wanner, Solving Ordinary Differential
/// Equations II, IV.2) errors grow, and nothing is said below them.
#[test]
fn what_grows_with_a_fixed_step_is_told_and_nothing_else() {
    for (method, end) in [("Ode1", 2.0), ("Ode2", 2.0), ("Ode3", 2.513), ("Ode4", 2.785), ("Ode5", 3.307)] {
        for (share, told) in [(0.95, false), (1.05, true)] {
            let step = share * end * 1e-3;
            let run = run_text(&format!(
                r#"Diagram(
                    simulation: (stop_time: "1 s", solver: {method}(step: {step})),
                    blocks: {{ "wave": Sine(frequency: "0.1 Hz"), "lag": TransferFunction(num: [1.0], den: [0.001, 1.0]), "show": Scope }},
                    connections: ["wave.y -> lag.u", "lag.y -> show.u"],
                )"#
            ));
            let codes: Vec<_> = run.warnings.iter().map(|warning| warning.code).collect();
            assert_eq!(codes == ["coarse_step"], told, "{method}, step {step}: {codes:?}");
        }
    }
}

/// Diodes behind chokes go on backward until a fixed step ends, which pumps a link up: by a half with 50 us.
#[test]
fn valves_that_change_late_with_a_fixed_step_are_told() {
    let told = |solver: &str| {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "60 ms", solver: {solver}),
                blocks: {{
                    "mains": ThreePhaseSource(voltage: "240 V", frequency: "60 Hz"), "choke": ThreePhaseRlc(r: "20 mOhm", l: "0.5 mH"),
                    "rectifier": RectifierBridge(v_f: "0.8 V"), "link": DcLink(c: "4 mF", r: "10 mOhm", v0: "325 V"),
                    "load": Resistor(r: "20 ohm"), "show": Scope(inputs: ["link"]),
                }},
                connections: [
                    "mains.ac <-> choke.ac1", "choke.ac2 <-> rectifier.ac", "rectifier.p <-> link.p <-> load.p",
                    "rectifier.n <-> link.n <-> load.n", "link.v -> show.link",
                ],
            )"#
        ));
        let codes: Vec<_> = run.warnings.iter().map(|warning| warning.code).collect();
        (run.last("show.link"), codes == ["coarse_step"], codes)
    };
    let (right, _, codes) = told("Ode45");
    assert!(codes.is_empty(), "{codes:?}");
    let (coarse, is_told, codes) = told("Ode4(step: \"100 us\")");
    assert!(coarse > 1.1 * right && is_told, "{coarse} V for {right} V, {codes:?}");
    let (fine, _, codes) = told("Ode4(step: \"1 us\")");
    assert!((fine / right - 1.0).abs() < 5e-3 && codes.is_empty(), "{fine} V for {right} V, {codes:?}");
}
