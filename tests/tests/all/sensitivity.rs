//! Derivatives of signals by parameters, against closed forms.

use std::path::Path;

use blocksim_sim::{Control, DISTANCES, Sensitivity, sensitivity};
use blocksim_tests::{Desk, compile_with};

/// An integrator in a file of its own.
const SUM: &str = r#"Diagram(inputs: { "u": () }, outputs: { "y": "sum.y" }, blocks: { "sum": Integrator },
    connections: ["in.u -> sum.u"])"#;

/// Derivatives by a parameter of which `text` makes a diagram.
fn by(value: f64, text: &dyn Fn(f64) -> String) -> (Sensitivity, Vec<String>) {
    let distance = 1e-3 * value;
    let variants = DISTANCES.map(|part| {
        let desk = Desk::new().with("model.ron", &text(value + part * distance)).with("sum.ron", SUM);
        let (compiled, problems) = compile_with(&desk, Path::new("model.ron"), &[]);
        compiled.schedule.unwrap_or_else(|| panic!("{problems}"))
    });
    let paths = variants[2].recorded.iter().map(|recorded| recorded.path.clone()).collect();
    let found =
        sensitivity(&variants, distance, &mut || Control::Go).expect("runs").expect("nobody stops them");
    (found, paths)
}

fn diagram(solver: &str, blocks: &str, connections: &str) -> String {
    format!(
        r#"Diagram(
            simulation: (stop_time: "4 s", solver: {solver}),
            blocks: {{ {blocks}, "show": Scope }},
            connections: [ {connections} ],
        )"#
    )
}

/// The largest difference from a closed form, and the largest error that is admitted.
fn off(found: &Sensitivity, exact: impl Fn(f64) -> f64) -> (f64, f64) {
    let pairs = found.times.iter().zip(&found.values[0]);
    let worst = pairs.map(|(t, value)| (value - exact(*t)).abs()).fold(0.0, f64::max);
    (worst, found.errors[0].iter().copied().fold(0.0, f64::max))
}

const SOLVERS: [&str; 3] = ["Auto(rtol: 1e-8)", "Ode15s(rtol: 1e-8)", "Ode4(step: \"2 ms\")"];

#[test]
fn a_lag_changes_with_its_time_constant_as_the_formula_says() {
    for solver in SOLVERS {
        let text = |tau: f64| {
            diagram(
                solver,
                &format!(r#""u": Constant(value: 2.0), "lag": LowPass(tau: "{tau} s")"#),
                r#""u.y -> lag.u", "lag.y -> show.u""#,
            )
        };
        let (found, _) = by(0.8, &text);
        assert_eq!(found.by_differences, None, "{solver}");
        assert_eq!(found.times.len(), 1001);
        // y = 2 (1 - exp(-t/T))
        let (worst, error) = off(&found, |t| -2.0 * t / (0.8 * 0.8) * (-t / 0.8).exp());
        assert!(worst < 1e-8 && error < 1e-5, "{solver}: {worst:e}, {error:e}");
    }
}

/// The steps that the oscillator asks for move the sine by rounding of their tolerance, which is no jump.
#[test]
fn a_signal_that_does_not_depend_on_the_parameter_does_not_stand_against_the_tangent() {
    for solver in ["Auto", "Ode23", "Ode15s"] {
        let text = |stiffness: f64| {
            diagram(
                solver,
                &format!(
                    r#""v": Integrator, "x": Integrator(x0: 1.0), "k": Gain(k: {:?}),
                       "u": Sine(frequency: "0.5 Hz"), "beside": Integrator"#,
                    -stiffness
                ),
                r#""v.y -> x.u", "x.y -> k.u, show.x", "k.y -> v.u", "u.y -> beside.u", "beside.y -> show.beside""#,
            )
            .replace("Scope", r#"Scope(inputs: ["x", "beside"])"#)
        };
        let (found, paths) = by(4.0, &text);
        assert_eq!(found.by_differences, None, "{solver}");
        let beside = paths.iter().position(|path| path == "show.beside").expect("it is recorded");
        assert!(found.values[beside].iter().all(|value| *value == 0.0), "{solver}");
    }
}

#[test]
fn an_oscillator_changes_with_its_stiffness_as_the_formula_says() {
    for solver in SOLVERS {
        let text = |k: f64| {
            diagram(
                solver,
                &format!(r#""v": Integrator, "x": Integrator(x0: 1.0), "k": Gain(k: {:?})"#, -k),
                r#""v.y -> x.u", "x.y -> k.u, show.u", "k.y -> v.u""#,
            )
        };
        let (found, _) = by(9.0, &text);
        assert_eq!(found.by_differences, None, "{solver}");
        // x = cos(sqrt(k) t)
        let (worst, _) = off(&found, |t| -t / 6.0 * (3.0 * t).sin());
        assert!(worst < 1e-6, "{solver}: {worst:e}");
    }
}

#[test]
fn a_sampled_controller_has_a_tangent_from_hit_to_hit() {
    let text = |k: f64| {
        diagram(
            "Auto(rtol: 1e-8)",
            &format!(
                r#""x": Integrator(x0: 1.0), "hold": ZeroOrderHold(ts: "0.5 s"), "k": Gain(k: {:?})"#,
                -k
            ),
            r#""x.y -> hold.u, show.u", "hold.y -> k.u", "k.y -> x.u""#,
        )
    };
    let (found, _) = by(0.6, &text);
    assert_eq!(found.by_differences, None);
    // x(n h) = (1 - k h)^n
    for n in 0..=8 {
        let at = found.times.iter().position(|t| (t - 0.5 * f64::from(n)).abs() < 1e-9).expect("on the grid");
        let exact = -0.5 * f64::from(n) * 0.7_f64.powi(n - 1);
        assert!((found.values[0][at] - exact).abs() < 1e-8, "{n}: {} is not {exact}", found.values[0][at]);
    }
}

#[test]
fn what_a_conditional_subsystem_integrates_has_a_derivative() {
    for (condition, start) in [("enable: Held", 0.0), ("reset: Rising", 1.0)] {
        let text = |k: f64| {
            let port = if condition.contains("enable") { "enable" } else { "reset" };
            diagram(
                "Auto(rtol: 1e-8)",
                &format!(
                    r#""u": Constant(value: {k}), "inside": Subsystem(file: "sum.ron", {condition}),
                       "late": Pulse(period: "10 s", width: 0.9, delay: {start:?}), "is": Compare(operator: Greater, constant: 0.5)"#
                ),
                &format!(
                    r#""u.y -> inside.u", "late.y -> is.u", "is.y -> inside.{port}", "inside.y -> show.u""#
                ),
            )
        };
        let (found, _) = by(1.5, &text);
        for (t, value) in found.times.iter().zip(&found.values[0]).filter(|(t, _)| (*t - start).abs() > 0.01)
        {
            let exact = if *t < start { *t } else { *t - start };
            assert!((value - exact).abs() < 1e-6, "{condition}, {t} s: {value} is not {exact}");
        }
    }
}

#[test]
fn a_start_value_and_a_limit_count() {
    // x' = -x from x0, limited to 1.
    let text = |x0: f64| {
        diagram(
            "Auto(rtol: 1e-8)",
            &format!(
                r#""x": Integrator(x0: {x0:?}), "minus": Gain(k: -1.0), "limit": Saturation(lower: 0.0, upper: 1.0)"#
            ),
            r#""x.y -> minus.u, limit.u", "minus.y -> x.u", "limit.y -> show.u""#,
        )
    };
    let (found, _) = by(3.0, &text);
    // Beside the corner, where there is no derivative.
    let corner = 3.0_f64.ln();
    for (t, value) in found.times.iter().zip(&found.values[0]).filter(|(t, _)| (*t - corner).abs() > 0.01) {
        let exact = if *t < corner { 0.0 } else { (-t).exp() };
        assert!((value - exact).abs() < 1e-7, "{t} s: {value} is not {exact} ({:?})", found.by_differences);
    }
}

#[test]
fn what_jumps_at_a_time_that_depends_on_the_parameter_is_left_to_differences() {
    // A relay switches on at 1/k, and what is behind it integrates.
    let text = |k: f64| {
        diagram(
            "Auto(rtol: 1e-8)",
            &format!(
                r#""k": Constant(value: {k:?}), "ramp": Integrator, "relay": Relay(on_at: 1.0, off_at: 0.5, on: 1.0, off: 0.0),
                   "sum": Integrator"#
            ),
            r#""k.y -> ramp.u", "ramp.y -> relay.u", "relay.y -> sum.u", "sum.y -> show.u""#,
        )
    };
    let (found, _) = by(0.5, &text);
    assert!(
        found.by_differences.is_some(),
        "a tangent knows nothing of the time at which the relay switches"
    );
    let pairs = found.times.iter().zip(&found.values[0]).filter(|(t, _)| (**t - 2.0).abs() > 0.01);
    for (t, value) in pairs {
        let exact = if *t < 2.0 { 0.0 } else { 4.0 };
        assert!((value - exact).abs() < 1e-5, "{t} s: {value} is not {exact}");
    }
}

#[test]
fn a_network_is_left_to_differences_with_the_reason() {
    let text = |r: f64| {
        diagram(
            "Auto(rtol: 1e-8)",
            &format!(
                r#""source": VoltageSource(v: "1 V"), "r": Resistor(r: "{r} ohm"), "c": Capacitor(c: "1 F"), "sensor": VoltageSensor,
                   "ground": ElectricalReference"#
            ),
            r#""source.p <-> r.p", "r.n <-> c.p <-> sensor.p", "source.n <-> c.n <-> sensor.n <-> ground.p", "sensor.v -> show.u""#,
        )
    };
    let (found, _) = by(0.7, &text);
    assert!(
        found.by_differences.as_ref().is_some_and(|reason| reason.contains("records no law")),
        "{:?}",
        found.by_differences
    );
    let (worst, error) = off(&found, |t| -t / 0.49 * (-t / 0.7).exp());
    assert!(worst < 1e-6 && error < 1e-4, "{worst:e}, {error:e}");
}
