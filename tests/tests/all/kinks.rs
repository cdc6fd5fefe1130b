//! Laws with kinks at default tolerances, against quadrature in a million parts.

use std::f64::consts::TAU;

use blocksim_tests::{Run, run_text};

/// The integral over 1.28 s of a block behind a sine of 5.98 Hz.
fn integral(solver: &str, block: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "1.28 s", solver: {solver}),
            blocks: {{
                "u": Sine(amplitude: 1.24, frequency: "5.98 Hz", phase: "0.478 rad"), "block": {block}, "rate": Gain(k: "1 1/s"),
                "sum": Integrator, "show": Scope,
            }},
            connections: ["u.y -> block.u", "block.y -> rate.u", "rate.y -> sum.u", "sum.y -> show.u"],
        )"#
    ))
}

fn expected(law: impl Fn(f64) -> f64) -> f64 {
    let parts = 1_000_000;
    let h = 1.28 / f64::from(parts);
    let middle = |k: i32| (f64::from(k) + 0.5) * h;
    (0..parts).map(|k| h * law(1.24 * (TAU * 5.98 * middle(k) + 0.478).sin())).sum()
}

/// What a block does to its input.
type Law = fn(f64) -> f64;

/// Where a step passes a kink it is made once more up to there, so that limits cost no digits.
#[test]
fn integrals_over_kinks_are_as_exact_as_the_tolerance_says() {
    let laws = [
        ("Saturation(lower: -0.47, upper: 0.692)", (|u| u.clamp(-0.47, 0.692)) as Law),
        ("DeadZone(start: -0.3, end: 0.9)", |u| u - u.clamp(-0.3, 0.9)),
        ("Abs", f64::abs),
    ];
    for (block, law) in laws {
        let expected = expected(law);
        for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"] {
            let found = integral(solver, block).last("show.u");
            // A method of several steps stops at the kink, but does not go back.
            let slack = if solver == "Ode15s" { 3e-4 } else { 3e-6 };
            assert!((found - expected).abs() < slack, "{solver}, {block}: {found} instead of {expected}");
        }
    }
}

/// What a limit guards need not have been met by a trial: the root of what is left above zero, whatever the step.
#[test]
fn a_limit_keeps_a_root_within_its_domain() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "2 s"),
            blocks: {
                "u": Sine(amplitude: 1.5, frequency: "1 Hz"), "positive": MinMax(function: Max), "zero": Constant(value: 0),
                "root": Function(function: Sqrt), "rate": Gain(k: "1 1/s"), "sum": Integrator, "show": Scope,
            },
            connections: [
                "u.y -> positive.u1", "zero.y -> positive.u2", "positive.y -> root.u", "root.y -> rate.u", "rate.y -> sum.u",
                "sum.y -> show.u",
            ],
        )"#,
    );
    // Twice sqrt(1.5) times the integral of sqrt(sin) over half a period: B(3/4, 1/2) / (2 pi) = 0.38137988...
    let half: f64 = (0..1_000_000).map(|k| ((f64::from(k) + 0.5) * 0.5e-6 * TAU).sin().sqrt() * 0.5e-6).sum();
    let expected = 2.0 * 1.5_f64.sqrt() * half;
    let found = run.last("show.u");
    assert!((found - expected).abs() < 1e-5, "{found} instead of {expected}");
}
