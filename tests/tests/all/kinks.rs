//! Laws with kinks at default tolerances, against quadrature in a million parts.

use std::f64::consts::TAU;

use blocksim_tests::{METHODS, Run, run_text};

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

/// The straight lines of a table, and what goes on beyond its ends.
fn straight(u: f64) -> f64 {
    let (x, y) = ([-1.0, -0.5, -0.4, 0.0, 0.1, 0.15, 0.9], [1.0, 0.0, 2.0, -1.0, 3.0, 0.0, 1.0]);
    let i = (1..6).find(|&i| u < x[i]).unwrap_or(6);
    y[i - 1] + (u - x[i - 1]) * (y[i] - y[i - 1]) / (x[i] - x[i - 1])
}

/// A stiff loop through a limit, a table and a dead zone, against the same at the tightest tolerance of a method of another
/// kind: values of the order of one, behind some forty kinks.
#[test]
fn kinks_in_stiff_loops_cost_no_digits() {
    let values = |solver: &str| {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", solver: {solver}),
                blocks: {{
                    "r": Sine(amplitude: 2, frequency: "0.7 Hz", phase: "0.31 rad"), "e": Sum(signs: "+-"),
                    "limit": Saturation(lower: -0.7, upper: 0.9), "fast": TransferFunction(num: [1], den: [2e-5, 1]),
                    "table": LookupTable1D(breakpoints: [-1, -0.3, 0.1, 0.35, 1], table: [-1, -0.2, 0.3, 0.2, 1.5]),
                    "zone": DeadZone(start: -0.1, end: 0.15), "slow": TransferFunction(num: [3], den: [0.4, 1]), "abs": Abs,
                    "rate": Gain(k: "1 1/s"), "sum": Integrator, "show": Scope(inputs: ["y", "sum"]),
                }},
                connections: [
                    "r.y -> e.u1", "slow.y -> e.u2", "e.y -> limit.u", "limit.y -> fast.u", "fast.y -> table.u",
                    "table.y -> zone.u", "zone.y -> slow.u", "slow.y -> abs.u", "abs.y -> rate.u", "rate.y -> sum.u",
                    "slow.y -> show.y", "sum.y -> show.sum",
                ],
            )"#
        ));
        ["show.y", "show.sum"].map(|path| run.last(path))
    };
    let expected = values("Rodas4(rtol: 1e-10)");
    for solver in ["Auto", "Rodas4", "Radau5", "Ode15s"] {
        for (found, expected) in values(solver).into_iter().zip(expected) {
            assert!((found - expected).abs() < 4e-6, "{solver}: {found} instead of {expected}");
        }
    }
}

/// Where a step passes a kink it is made once more up to there, so that limits cost no digits.
#[test]
fn integrals_over_kinks_are_as_exact_as_the_tolerance_says() {
    let laws = [
        ("Saturation(lower: -0.47, upper: 0.692)", (|u| u.clamp(-0.47, 0.692)) as Law),
        ("DeadZone(start: -0.3, end: 0.9)", |u| u - u.clamp(-0.3, 0.9)),
        ("Abs", f64::abs),
        (
            "LookupTable1D(breakpoints: [-1, -0.5, -0.4, 0, 0.1, 0.15, 0.9], table: [1, 0, 2, -1, 3, 0, 1])",
            |u| straight(u.clamp(-9.0, 9.0)),
        ),
        (
            "LookupTable1D(breakpoints: [-1, -0.5, -0.4, 0, 0.1, 0.15, 0.9], table: [1, 0, 2, -1, 3, 0, 1], \
             extrapolation: Clip)",
            |u| straight(u.clamp(-1.0, 0.9)),
        ),
        ("LookupTable1D(breakpoints: [-1, 0, 1], table: [1, 0, 1], interpolation: Cubic)", |u| {
            // Akima's slopes at three points, those beyond at equal second differences: 2 u and -2 u.
            let s = u.abs().min(1.0);
            s * s + 2.0 * (u.abs() - s)
        }),
    ];
    for (block, law) in laws {
        let expected = expected(law);
        for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"] {
            let found = integral(solver, block).last("show.u");
            // A method of several steps begins at order 1 behind each kink.
            let slack = if solver == "Ode15s" { 1e-4 } else { 3e-6 };
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

/// Akima's curve has a slope everywhere and a curvature that jumps: steps over several short pieces are seen to, against tiny
/// steps of fixed length.
#[test]
fn curves_through_short_pieces_cost_no_digits() {
    let block = "LookupTable1D(breakpoints: [-1, -0.5, -0.4, 0, 0.1, 0.15, 0.9], table: [1, 0, 2, -1, 3, 0, 1], \
                 interpolation: Cubic)";
    let expected = integral("Ode4(step: \"10 us\")", block).last("show.u");
    for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"] {
        let found = integral(solver, block).last("show.u");
        let slack = if solver == "Ode15s" { 1e-4 } else { 5e-6 };
        assert!((found - expected).abs() < slack, "{solver}: {found} instead of {expected}");
    }
}

/// Two signals that have come to the same value differ by rounding at most: neither takes over from the other again and again.
#[test]
fn what_has_caught_up_with_its_target_is_at_rest_there() {
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "4 s"),
            blocks: {
                "step": Step(time: "0.684 s", before: 0, after: 3.05), "late": TransportDelay(delay: "0.517 s"),
                "slow": RateLimiter(rising: 8.14, falling: -14.6), "most": MinMax(function: Max, inputs: 2),
                "least": MinMax(function: Min, inputs: 2), "limit": Saturation(lower: 0, upper: 3.05),
                "s": Scope(inputs: ["most", "least", "limit"]),
            },
            connections: [
                "step.y -> late.u, most.u2, least.u2", "late.y -> slow.u", "slow.y -> most.u1, least.u1, limit.u",
                "most.y -> s.most", "least.y -> s.least", "limit.y -> s.limit",
            ],
        )"#,
    );
    let caught = 0.684 + 0.517 + 3.05 / 8.14;
    for (row, &t) in run.time.iter().enumerate() {
        let slow = (8.14 * (t - 1.201)).clamp(0.0, 3.05);
        let step = if run.column("s.most")[row] > 1.0 { 3.05 } else { 0.0 };
        for (name, expected) in [("most", slow.max(step)), ("least", slow.min(step)), ("limit", slow)] {
            let found = run.column(&format!("s.{name}"))[row];
            assert!((found - expected).abs() < 1e-9, "{name} is {found} instead of {expected} at {t}");
        }
    }
    let later = run.events.iter().filter(|(t, _, _)| *t > caught + 1e-6);
    assert_eq!(later.count(), 0, "{:?}", run.events);
}

/// The integral of what a block makes of a sine, over whole periods, with a block beside it whose events fall between the kinks.
fn beside(solver: &str, block: &str) -> (Run, f64) {
    let run = run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "20 s", solver: {solver}),
            blocks: {{
                "s": Sine(amplitude: 1, frequency: "1 Hz", phase: "0.3 rad"), "law": {block}, "x": Integrator,
                "turns": Backlash(width: 1.5), "rest": Integrator, "show": Scope(inputs: ["x", "rest"]),
            }},
            connections: ["s.y -> law.u, turns.u", "law.y -> x.u", "turns.y -> rest.u", "x.y -> show.x", "rest.y -> show.rest"],
        )"#
    ));
    let found = run.last("show.x");
    (run, found)
}

/// What is integrated follows the input by a law that remembers its last output, in steps of a microsecond.
fn stepped(law: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let (h, steps) = (1e-6, 20_000_000);
    let (mut y, mut sum) = (0.0, 0.0);
    for k in 0..steps {
        let u = (std::f64::consts::TAU * (f64::from(k) + 0.5) * h + 0.3).sin();
        y = law(u, y, h);
        sum += h * y;
    }
    sum
}

/// A step that an event cuts has looked beyond the next kink, and where it is cut its dense output is bent by what it saw there: a
/// narrow peak between two breakpoints of the table lost a thirteenth of its area at 1e-3, the same in each period.
#[test]
fn a_kink_behind_the_cut_of_a_step_costs_no_digits() {
    let table = "LookupTable1D(breakpoints: [-1, 0.9, 0.95, 0.99, 1], table: [0, 0, 1, 0, 0])";
    // Of (u - a) dt between two values of u = sin(w t).
    let piece = |a: f64, from: f64, to: f64| {
        let primitive = |u: f64| -(1.0 - u * u).sqrt() - a * u.asin();
        (primitive(to) - primitive(from)) / std::f64::consts::TAU
    };
    let expected = 40.0 * (piece(0.9, 0.9, 0.95) / 0.05 - piece(0.99, 0.95, 0.99) / 0.04);
    for method in METHODS {
        let low = matches!(method, "Ode15s" | "Ode23tb" | "Ode23t");
        for (rtol, share) in [(1e-3, if low { 2e-2 } else { 2e-3 }), (1e-6, if low { 2e-4 } else { 2e-6 })] {
            let (_, found) = beside(&format!("{method}(rtol: {rtol:e})"), table);
            assert!(
                (found / expected - 1.0).abs() < share,
                "{method} at {rtol:e}: {found} instead of {expected}"
            );
        }
    }
}

/// Blocks that take note of each step went on with the same law, but had a method of many steps begin anew at order one: Ode15s took
/// 191 356 steps for one of these, and was off by half a per cent of it at 1e-6.
#[test]
fn memories_that_follow_the_same_law_leave_a_method_its_order() {
    let limited = stepped(|u, y, h| y + (u - y).clamp(-h, h));
    let played = stepped(|u, y, _| y.clamp(u - 0.75, u + 0.75));
    for method in METHODS {
        let low = matches!(method, "Ode15s" | "Ode23tb" | "Ode23t");
        let (run, found) = beside(&format!("{method}(rtol: 1e-6)"), "RateLimiter(rising: 1, falling: -1)");
        let tolerance = if low { 1e-4 } else { 3e-5 };
        assert!((found - limited).abs() < tolerance, "{method}: {found} instead of {limited}");
        let rest = run.last("show.rest");
        assert!((rest - played).abs() < tolerance, "{method}: {rest} instead of {played}");
        assert!(run.counts.evaluations < 40_000, "{method}: {} evaluations", run.counts.evaluations);
    }
}

/// A kink in the way of the look for noise was taken for noise, and from then on no slope over time was believed: Rodas4 was
/// seven hundred times worse at 1e-6 than at 1e-4, in a hundred times the steps.
#[test]
fn a_kink_is_not_taken_for_noise() {
    for method in METHODS {
        for block in ["DeadZone(start: -0.5, end: 0.5)", "Saturation(lower: -0.5, upper: 0.5)"] {
            let mut before = f64::INFINITY;
            for rtol in [1e-4, 1e-6, 1e-8] {
                let (run, found) = beside(&format!("{method}(rtol: {rtol:e})"), block);
                // Two halves of a period cancel; the curve between has this size.
                let error = found.abs() / 0.15;
                assert!(
                    error < before.max(1e-5),
                    "{method}, {block}: {error:e} at {rtol:e} after {before:e}"
                );
                assert!(
                    run.counts.evaluations < 250_000,
                    "{method}, {block}: {} at {rtol:e}",
                    run.counts.evaluations
                );
                before = 2.0 * error;
            }
            assert!(before < 4e-5, "{method}, {block}: {before:e}");
        }
    }
}

/// What leaves a kink as the fourth power of time is told from rounding only later, and steps are not cut there without end; against
/// the closed form of the integral of a sine behind two lags.
#[test]
fn a_kink_that_is_left_very_slowly_is_no_chatter() {
    for solver in ["Auto", "Ode45", "Ode23", "Rodas4", "Ode15s", "Radau5"] {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "2 s", solver: {solver}),
                blocks: {{
                    "u": Sine(amplitude: 1, frequency: "0.5 Hz"), "p": TransferFunction(num: [4], den: [1, 4, 4], k: "1"),
                    "rate": Gain(k: "1 1/s"), "x": Integrator, "y": Abs, "s": Scope(inputs: ["y"]),
                }},
                connections: ["u.y -> p.u", "p.y -> rate.u", "rate.y -> x.u", "x.y -> y.u", "y.y -> s.y"],
            )"#
        ));
        // p = 4 w / ((s + 2)^2 (s^2 + w^2)), by parts: (A + B t) exp(-2 t) + C cos w t + D sin w t.
        let w = std::f64::consts::PI;
        let square = (4.0 + w * w) * (4.0 + w * w);
        let (b, c, d) = (4.0 * w / (4.0 + w * w), -16.0 * w / square, 4.0 * (4.0 - w * w) / square);
        let a = -c;
        let exact = |t: f64| {
            let decay = (-2.0 * t).exp();
            a * (1.0 - decay) / 2.0
                + b * (1.0 - decay * (1.0 + 2.0 * t)) / 4.0
                + (c * (w * t).sin() + d * (1.0 - (w * t).cos())) / w
        };
        for (t, y) in run.time.iter().zip(run.column("s.y")) {
            assert!((y - exact(*t).abs()).abs() < 1e-4, "{solver}: {y} instead of {} at {t}", exact(*t));
        }
    }
}
