//! Numbers of step responses, from the rows of runs at default settings, against closed forms.

use std::f64::consts::PI;

use blocksim_analysis::{Metrics, metrics};
use blocksim_tests::run_text;

/// The numbers of `w^2 / (s^2 + 2 d w s + w^2)` behind a unit step.
fn response(w: f64, d: f64, solver: &str) -> Metrics {
    let run = run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "{} s", solver: {solver}),
            blocks: {{
                "set": Step(time: "0.1 s"), "plant": TransferFunction(num: [{:?}], den: [1.0, {:?}, {:?}]),
                "show": Scope(inputs: ["set", "actual"]),
            }},
            connections: ["set.y -> plant.u", "set.y -> show.set", "plant.y -> show.actual"],
        )"#,
        0.1 + 20.0 / (d * w),
        w * w,
        2.0 * d * w,
        w * w
    ));
    metrics(&run.time, Some(run.column("show.set")), run.column("show.actual")).expect("a response")
}

/// Zero of `f` between `a` and `b`, where it changes sign, by halving.
fn zero(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..100 {
        let middle = (a + b) / 2.0;
        if (f(a) > 0.0) == (f(middle) > 0.0) { a = middle } else { b = middle }
    }
    a
}

/// K. Ogata, Modern Control Engineering, section 5-3, for overshoot and peak; the integral of the absolute error half wave
/// by half wave.
#[test]
fn a_second_order_system_has_its_closed_form_numbers_at_defaults() {
    for (w, d) in [(10.0, 0.3), (5.0, 0.5), (20.0, 0.7)] {
        let root = f64::sqrt(1.0 - d * d);
        let y = |t: f64| 1.0 - (-d * w * t).exp() / root * (w * root * t + f64::acos(d)).sin();
        let peak = PI / (w * root);
        let crossing = |n: i32| (f64::from(n) * PI - f64::acos(d)) / (w * root);
        let n = (1..).find(|&n| (y(f64::from(n) * peak) - 1.0).abs() < 0.02).expect("it settles");
        let (before, side) = (f64::from(n - 1) * peak, (y(f64::from(n - 1) * peak) - 1.0).signum());
        let settling = zero(|t| (y(t) - 1.0) * side - 0.02, before, crossing(n));
        let rise = zero(|t| y(t) - 0.9, 0.0, peak) - zero(|t| y(t) - 0.1, 0.0, peak);
        let primitive = |t: f64| {
            let (a, b, phase) = (d * w, w * root, f64::acos(d));
            -(-a * t).exp() * (a * (b * t + phase).sin() + b * (b * t + phase).cos())
                / (root * (a * a + b * b))
        };
        let mut iae = primitive(crossing(1)) - primitive(0.0);
        (1..60).for_each(|n| iae += (primitive(crossing(n + 1)) - primitive(crossing(n))).abs());
        let ise = (1.0 + 4.0 * d * d) / (4.0 * d * w);
        for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5"] {
            let m = response(w, d, solver);
            let near = |what: &str, found: f64, expected: f64, slack: f64| {
                let off = (found - expected).abs();
                assert!(
                    off < slack,
                    "{solver}, w {w}, d {d}: {what} {found} instead of {expected}, off by {off:.1e}"
                );
            };
            near("begin", m.begin, 0.1, 1e-12);
            near("overshoot", m.overshoot.expect("one"), (-d * PI / root).exp(), 3e-5);
            near("rise", m.rise.expect("one") * w, rise * w, 1e-4);
            near("settling", m.settling.expect("one") * w, settling * w, 1e-3);
            // Between rows the curve is a cubic, which the absolute value bends where it crosses zero.
            near("IAE", m.iae * w, iae * w, 2e-4);
            near("ISE", m.ise * w, ise * w, 1e-4);
        }
    }
}

/// A `Step` is evaluated at every step of the method, and changes at one.
#[test]
fn a_step_begins_a_method_anew_where_it_steps_and_nowhere_else() {
    for (solver, most, slack) in [("Ode15s", 700, 1e-5), ("Ode45", 850, 1e-6), ("Radau5", 2500, 1e-5)] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "3 s", solver: {solver}(rtol: 1e-6)),
                blocks: {{
                    "s": Step(time: "0.1 s", after: 1), "p": TransferFunction(num: [100], den: [1, 6, 100]),
                    "scope": Scope(inputs: ["y"]),
                }},
                connections: ["s.y -> p.u", "p.y -> scope.y"],
            )"#
        ));
        assert!(run.counts.evaluations < most, "{solver}: {:?}", run.counts);
        let (w, d) = (10.0, 0.3);
        let wd = w * f64::sqrt(1.0 - d * d);
        for (t, y) in run.time.iter().zip(run.column("scope.y")) {
            let t = t - 0.1;
            let decay = (-d * w * t).exp() * ((wd * t).cos() + d * w / wd * (wd * t).sin());
            let expected = if t < 0.0 { 0.0 } else { 1.0 - decay };
            // The row before the jump of the input and the one behind it have the same output.
            assert!((y - expected).abs() < slack, "{solver} at {t}: {y} instead of {expected}");
        }
    }
}
