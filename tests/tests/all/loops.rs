//! Algebraic loops are solved: against closed forms, with every method, and refused where there is nothing to solve.

use blocksim_tests::{Run, compile_text, run, run_text};

fn simulate(solver: &str, blocks: &str, connections: &str) -> Run {
    run_text(&format!(
        "Diagram(simulation: (stop_time: 2, solver: {solver}), blocks: {{ {blocks} }}, connections: [ {connections} ])"
    ))
}

/// What goes wrong while it runs, as code and message.
fn error(blocks: &str, connections: &str) -> (&'static str, String) {
    let text = format!(
        "Diagram(simulation: (stop_time: 2), blocks: {{ {blocks} }}, connections: [ {connections} ])"
    );
    let (compiled, problems) = compile_text(&text);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let error = run.error.expect("an error");
    (error.code, error.message)
}

#[track_caller]
fn every_row(run: &Run, column: &str, tolerance: f64, expected: impl Fn(f64) -> f64) {
    assert!(run.time.len() > 10, "{:?}", run.time);
    for (t, y) in run.time.iter().zip(run.column(column)) {
        assert!((y - expected(*t)).abs() <= tolerance, "{column} at {t}: {y} instead of {}", expected(*t));
    }
}

const SOLVERS: [&str; 6] = ["Auto", "Ode23", "Ode15s", "Radau5", "Rodas4", "Ode4(step: \"10 ms\")"];

#[test]
fn a_linear_loop_has_the_gain_of_its_closed_form() {
    for k in [2.0, 1e6, -0.5, -3.0, 1e-9] {
        let run = simulate(
            "Auto",
            &format!(
                r#""u": Sine(amplitude: 3, frequency: "1 Hz"), "e": Sum(signs: "+-"), "k": Gain(k: {k:e}), "show": Scope(inputs: ["e"])"#
            ),
            r#""u.y -> e.u1", "e.y -> k.u, show.e", "k.y -> e.u2""#,
        );
        let size = 3.0 / f64::abs(1.0 + k);
        every_row(&run, "show.e", 1e-11 * size, |t| 3.0 * (std::f64::consts::TAU * t).sin() / (1.0 + k));
    }
}

/// A plant that passes its input on at once, (s + 2) / (s + 1), under a proportional controller: the step response of
/// k (s + 2) / ((1 + k) s + 1 + 2 k).
#[test]
fn a_controller_around_a_plant_that_passes_its_input_on_follows_the_closed_loop() {
    let k = 4.0_f64;
    for solver in SOLVERS {
        let run = simulate(
            solver,
            r#""r": Constant(value: 1), "e": Sum(signs: "+-"), "k": Gain(k: 4),
               "g": TransferFunction(num: [1, 2], den: [1, 1]), "show": Scope(inputs: ["y"])"#,
            r#""r.y -> e.u1", "e.y -> k.u", "k.y -> g.u", "g.y -> e.u2, show.y""#,
        );
        let (first, last) = (k / (1.0 + k), 2.0 * k / (1.0 + 2.0 * k));
        let rate = (1.0 + 2.0 * k) / (1.0 + k);
        every_row(&run, "show.y", 1e-5, |t| last + (first - last) * (-rate * t).exp());
    }
}

/// A run that begins at rest is there from its first row on, with the same solution of a loop that has two: y = y^2 - x has
/// the solutions (1 - sqrt(1 + 4 x)) / 2 and (1 + sqrt(1 + 4 x)) / 2, of which the first is near zero.
#[test]
fn a_steady_start_keeps_the_solution_of_a_loop() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: 1, start: Steady),
    blocks: {
        "two": Constant(value: 2), "x": LowPass(tau: "0.5 s"), "square": Product(inputs: 2), "y": Sum(signs: "+-"),
        "show": Scope(inputs: ["x", "y"]),
    },
    connections: ["two.y -> x.u", "x.y -> y.u2, show.x", "square.y -> y.u1", "y.y -> square.u1, square.u2, show.y"],
)"#,
    );
    every_row(&run, "show.x", 1e-12, |_| 2.0);
    every_row(&run, "show.y", 1e-12, |_| -1.0);
}

/// The search begins where x = 10 and the loop y = f(y) + x, with f = 2.5 above 2 and 0 below 1, has the solution 12.5 alone. At
/// rest x is zero and there are three: a search from nothing finds 0, one from where the loop was 2.5.
#[test]
fn a_steady_start_goes_on_with_the_solution_that_was_followed() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: 1, start: Steady),
    blocks: {
        "zero": Constant(value: 0), "x": LowPass(tau: "0.5 s", y0: 10), "y": Sum(signs: "++"),
        "f": LookupTable1D(breakpoints: [1, 2], table: [0, 2.5], extrapolation: Clip), "show": Scope(inputs: ["x", "y"]),
    },
    connections: ["zero.y -> x.u", "x.y -> y.u1, show.x", "y.y -> f.u, show.y", "f.y -> y.u2"],
)"#,
    );
    every_row(&run, "show.x", 1e-9, |_| 0.0);
    every_row(&run, "show.y", 1e-9, |_| 2.5);
}

#[test]
fn a_loop_that_is_not_linear_is_solved_at_every_instant() {
    // y = t cos(y), by bisection.
    let solution = |t: f64| {
        let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if middle < t * f64::cos(middle) { low = middle } else { high = middle }
        }
        low
    };
    for solver in SOLVERS {
        let run = simulate(
            solver,
            r#""t": Ramp(slope: "1 1/s"), "cos": Function(function: Cos), "p": Product(inputs: 2), "sum": Integrator,
               "show": Scope(inputs: ["y", "sum"])"#,
            r#""t.y -> p.u1", "cos.y -> p.u2", "p.y -> cos.u, show.y, sum.u", "sum.y -> show.sum""#,
        );
        every_row(&run, "show.y", 1e-10, solution);
        // Its integral by Simpson's rule.
        let n = 2000;
        let part = |i: i32| {
            f64::from(if i == 0 || i == n { 1 } else { 2 + 2 * (i % 2) })
                * solution(2.0 * f64::from(i) / f64::from(n))
        };
        let integral: f64 = (0..=n).map(part).sum::<f64>() * 2.0 / f64::from(3 * n);
        assert!(
            (run.last("show.sum") - integral).abs() < 1e-5,
            "{solver}: {} {integral}",
            run.last("show.sum")
        );
    }
}

#[test]
fn two_loops_through_a_vector_are_solved_together() {
    // y = u - A y with A = [1 2; -3 0.5]: (I + A) y = u, u = (t, 1), determinant 2 * 1.5 + 6 = 9.
    let run = simulate(
        "Auto",
        r#""t": Ramp(slope: "1 1/s"), "one": Constant(value: 1), "u": Mux(inputs: 2), "e": Sum(signs: "+-"),
           "a": Demux(sizes: [1, 1]), "a11": Gain(k: 1), "a12": Gain(k: 2), "a21": Gain(k: -3), "a22": Gain(k: 0.5),
           "s1": Sum(signs: "++"), "s2": Sum(signs: "++"), "back": Mux(inputs: 2), "show": Scope(inputs: ["y"])"#,
        r#""t.y -> u.u1", "one.y -> u.u2", "u.y -> e.u1", "e.y -> a.u, show.y",
           "a.y1 -> a11.u, a21.u", "a.y2 -> a12.u, a22.u", "a11.y -> s1.u1", "a12.y -> s1.u2", "a21.y -> s2.u1", "a22.y -> s2.u2",
           "s1.y -> back.u1", "s2.y -> back.u2", "back.y -> e.u2""#,
    );
    every_row(&run, "show.y[0]", 1e-12, |t| (1.5 * t - 2.0) / 9.0);
    every_row(&run, "show.y[1]", 1e-12, |t| (3.0 * t + 2.0) / 9.0);
}

#[test]
fn branches_within_a_loop_change_where_they_should() {
    // y = limit(u) with u = 3 t - 4 y: y = 0.6 t up to 1 at 5/3 s. The integral stops to grow there.
    for solver in SOLVERS {
        let run = simulate(
            solver,
            r#""t": Ramp(slope: "3 1/s"), "e": Sum(signs: "+-"), "limit": Saturation(lower: -1, upper: 1), "k": Gain(k: 4),
               "show": Scope(inputs: ["y"])"#,
            r#""t.y -> e.u1", "e.y -> limit.u", "limit.y -> k.u, show.y", "k.y -> e.u2""#,
        );
        every_row(&run, "show.y", 1e-11, |t| f64::min(0.6 * t, 1.0));
    }
    // A relay within a loop that has memory, and a loop that its output shifts: e = 1 - x + 0.2 r - e.
    for solver in ["Auto", "Rodas4", "Ode23"] {
        let run = simulate(
            solver,
            r#""one": Constant(value: 1), "e": Sum(signs: "+-+-"), "relay": Relay(on_at: 0.2, off_at: -0.2, on: 1, off: -1),
               "small": Gain(k: 0.2), "x": Integrator(x0: 0), "rate": Gain(k: "1 1/s"), "half": Gain(k: 1), "show": Scope(inputs: ["x", "e"])"#,
            r#""one.y -> e.u1", "x.y -> e.u2", "small.y -> e.u3", "e.y -> half.u, relay.u, show.e", "half.y -> e.u4",
               "relay.y -> rate.u", "relay.y -> small.u", "rate.y -> x.u", "x.y -> show.x""#,
        );
        let (x, e) = (run.column("show.x"), run.column("show.e"));
        for ((t, x), e) in run.time.iter().zip(x).zip(e) {
            // The relay is on up to x = 0.8, where e = (1 - x + 0.2) / 2 is 0.2... and turns where e = -0.2.
            let on = 0.5 * (1.0 - x + 0.2);
            let off = 0.5 * (1.0 - x - 0.2);
            assert!((e - on).abs() < 1e-9 || (e - off).abs() < 1e-9, "{solver} at {t}: {x} {e}");
        }
        // Up with 1/s until e = -0.2 at x = 1.6, then down until e = 0.2 at x = 0.4.
        assert!((run.last("show.x") - 1.2).abs() < 1e-6, "{solver}: {}", run.last("show.x"));
    }
}

#[test]
fn a_loop_without_a_solution_or_with_many_is_an_error_with_its_time() {
    let round = r#""e.y -> g.u, t.u", "g.y -> e.u2", "u.y -> e.u1""#;
    let (code, message) =
        error(r#""u": Step(after: 1), "e": Sum(signs: "++"), "g": Gain(k: 1), "t": Terminator"#, round);
    assert_eq!(code, "algebraic_loop");
    assert_eq!(
        message,
        "the algebraic loop of `g`, `e` has no single solution: what goes round comes back unchanged, as it asks for `e.y` = 1 * `e.y` + 1"
    );
    let (code, message) = error(
        r#""u": Constant(value: 1), "e": Sum(signs: "+-"), "g": Function(function: Exp), "k": Gain(k: -1), "t": Terminator"#,
        r#""e.y -> g.u, t.u", "g.y -> k.u", "k.y -> e.u2", "u.y -> e.u1""#,
    );
    assert_eq!(
        (code, message.split(';').next()),
        ("algebraic_loop", Some("the algebraic loop of `g`, `k`, `e` has no solution that could be found"))
    );
    assert!(message.contains("it was tried with `e.y` = "), "{message}");
}

#[test]
fn a_loop_of_different_times_is_refused_and_one_that_is_solved_is_told() {
    let told = |blocks: &str, connections: &str| {
        let (compiled, problems) = compile_text(&format!(
            "Diagram(simulation: (stop_time: 1), blocks: {{ {blocks} }}, connections: [ {connections} ])"
        ));
        (compiled.schedule.is_some(), problems)
    };
    let (runs, problems) = told(
        r#""e": Sum(signs: "+-"), "hold": ZeroOrderHold(ts: "10 ms"), "c": Constant(value: 1), "t": Terminator"#,
        r#""c.y -> e.u1", "e.y -> hold.u, t.u", "hold.y -> e.u2""#,
    );
    assert!(!runs && problems.contains("evaluated at different times"), "{problems}");
    let (runs, problems) = told(
        r#""e": Sum(signs: "+-"), "k": Gain(k: 2), "c": Constant(value: 1), "t": Terminator"#,
        r#""c.y -> e.u1", "e.y -> k.u, t.u", "k.y -> e.u2""#,
    );
    assert!(runs && problems.contains("note") && problems.contains("solved at every instant"), "{problems}");
}

/// Signals of a loop have many units, and what is small beside one of them may be all there is of another: a diode between two resistances,
/// and a valve between two hoses, of which the current or the flow is the unknown.
#[test]
fn a_small_unknown_beside_large_signals_keeps_its_digits() {
    for (law, step, resistance) in [
        ("1e-12*(exp((a - b)/0.02585) - 1)", (10.0, 1.0), 1e6),
        ("max(0, 1e-9*(a - b - 5e5))", (1e7, 1e6), 1e11),
        ("1e-4*tanh((a - b)/1e3)", (1e5, 1e7), 1e11),
    ] {
        let run = simulate(
            "Auto",
            &format!(
                r#""u": Step(time: 1, before: {:e}, after: {:e}), "first": Gain(k: {resistance:e}), "second": Gain(k: {resistance:e}),
                   "a": Sum(signs: "+-"), "law": Expression(law: "{law}"), "show": Scope(inputs: ["q", "a", "b", "u"])"#,
                step.0, step.1
            ),
            r#""u.y -> a.u1, show.u", "a.y -> law.a, show.a", "law.y -> first.u, second.u, show.q", "first.y -> a.u2",
               "second.y -> law.b, show.b""#,
        );
        for row in 0..run.time.len() {
            let [q, u] = ["show.q", "show.u"].map(|column| run.column(column)[row]);
            // By halving: what is left of the drop falls with q.
            let given = |q: f64| {
                let drop = u - 2.0 * resistance * q;
                match law {
                    law if law.contains("exp") => 1e-12 * (drop / 0.02585).exp_m1(),
                    law if law.contains("max") => (1e-9 * (drop - 5e5)).max(0.0),
                    _ => 1e-4 * (drop / 1e3).tanh(),
                }
            };
            let (mut low, mut high) = (0.0, 0.5 * u / resistance);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                (low, high) = if given(middle) > middle { (middle, high) } else { (low, middle) };
            }
            assert!((q - low).abs() < 1e-9 * low, "{law} at {}: {q} instead of {low}", run.time[row]);
        }
    }
}

/// Of a value that becomes zero nothing is left to be relative to.
#[test]
fn a_loop_may_come_to_zero() {
    for law in ["tanh(u)", "u*abs(u)", "u^3", "sin(u)", "exp(u) - 1", "u + u^2"] {
        for solver in SOLVERS {
            let run = simulate(
                solver,
                &format!(
                    r#""u": Step(time: 1, before: 1, after: 0), "e": Sum(signs: "+-"), "x": Expression(law: "{law}"), "show": Scope(inputs: ["e"])"#
                ),
                r#""u.y -> e.u1", "e.y -> x.u, show.e", "x.y -> e.u2""#,
            );
            let last = run.last("show.e");
            assert!(last.abs() < 1e-15, "{law} with {solver}: {last}");
        }
    }
}

/// A run that passes kinks of a loop, where what acts from outside cancels: nothing but its rounding is left of the unknown.
#[test]
fn kinks_of_a_loop_are_passed_where_its_terms_cancel() {
    let odd = |k: f64, s: f64| if s > 0.0 { s / (1.0 - k) } else { s / (1.0 + k) };
    let knee = |k: f64, s: f64| {
        let above = (s - 0.15 * k) / (1.0 + 0.5 * k);
        if above > 0.3 { above } else { s / (1.0 + k) }
    };
    let rectified = |k: f64, s: f64| if s > 0.0 { s / (1.0 + k) } else { s };
    type Closed<'a> = &'a dyn Fn(f64, f64) -> f64;
    let cases: [(&str, f64, Closed); 3] = [
        ("abs(u)", 0.4, &|k, s| odd(-k, s)),
        ("if(u > 0.3, 0.3 + 0.5*(u - 0.3), u)", 3.3, &knee),
        ("max(u, 0)", 3.0, &rectified),
    ];
    for (law, k, closed) in cases {
        for bias in [0.0, 0.3, 0.7] {
            for frequency in [0.7, 1.73, 2.9] {
                let run = simulate(
                    "Auto",
                    &format!(
                        r#""u": Sine(amplitude: 2.21, frequency: "{frequency} Hz"), "c": Constant(value: {bias:?}), "e": Sum(signs: "+-+"),
                           "x": Expression(law: "{law}"), "k": Gain(k: {k:?}), "show": Scope(inputs: ["e", "u"])"#
                    ),
                    r#""u.y -> e.u1, show.u", "c.y -> e.u3", "e.y -> x.u, show.e", "x.y -> k.u", "k.y -> e.u2""#,
                );
                for (u, e) in run.column("show.u").iter().zip(run.column("show.e")) {
                    let expected = closed(k, u + bias);
                    assert!(
                        (e - expected).abs() < 1e-12,
                        "{law}, {bias}, {frequency}: {e} instead of {expected}"
                    );
                }
            }
        }
    }
}

/// Two unknowns at the kinks of both: no slope of one side leads on, and the loop contracts.
#[test]
fn a_loop_that_contracts_is_solved_at_the_kinks_of_two_unknowns() {
    let run = simulate(
        "Auto",
        r#""u": Sine(amplitude: 3, frequency: "1.3 Hz"), "a": Sum(signs: "+++"), "b": Sum(signs: "++-"), "x": Abs, "z": Saturation(lower: -1, upper: 1),
           "xa": Gain(k: 0.4), "xb": Gain(k: -0.3), "za": Gain(k: 0.5), "zb": Gain(k: 0.6), "show": Scope(inputs: ["x", "z", "u"])"#,
        r#""u.y -> a.u1, b.u3, show.u", "a.y -> x.u", "b.y -> z.u", "x.y -> xa.u, xb.u, show.x", "z.y -> za.u, zb.u, show.z",
           "xa.y -> a.u2", "za.y -> a.u3", "xb.y -> b.u1", "zb.y -> b.u2""#,
    );
    for row in 0..run.time.len() {
        let [x, z, u] = ["show.x", "show.z", "show.u"].map(|column| run.column(column)[row]);
        let (mut a, mut b) = (0.0_f64, 0.0_f64);
        for _ in 0..400 {
            (a, b) = ((u + 0.4 * a + 0.5 * b).abs(), (-u - 0.3 * a + 0.6 * b).clamp(-1.0, 1.0));
        }
        assert!(
            (x - a).abs() < 1e-11 && (z - b).abs() < 1e-11,
            "{x}, {z} instead of {a}, {b} at {}",
            run.time[row]
        );
    }
}

/// Where branches are chosen a guard may be a rounding below zero. It must be there as well where the step begins, or it is not seen to cross.
#[test]
fn a_condition_of_a_loop_that_is_solved_by_iteration_is_never_passed_over() {
    for frequency in [0.7, 1.1, 1.73, 2.9, 3.3] {
        for bias in [0.0, 0.3, 0.7, 1.1] {
            for k in [0.4, 1.9, 3.3] {
                let run = simulate(
                    "Auto",
                    &format!(
                        r#""u": Sine(amplitude: 2.21, frequency: "{frequency} Hz"), "c": Constant(value: {bias:?}), "e": Sum(signs: "+-+"),
                           "x": Expression(law: "if(u > 0.3, 0.3 + 0.5*(u - 0.3), u)"), "t": Expression(law: "u + 0.3*tanh(u)"),
                           "k": Gain(k: {k:?}), "show": Scope(inputs: ["e", "x"])"#
                    ),
                    r#""u.y -> e.u1", "c.y -> e.u3", "e.y -> x.u, show.e", "x.y -> t.u, show.x", "t.y -> k.u", "k.y -> e.u2""#,
                );
                for (e, x) in run.column("show.e").iter().zip(run.column("show.x")) {
                    let expected = if *e > 0.3 { 0.3 + 0.5 * (e - 0.3) } else { *e };
                    assert!((x - expected).abs() < 1e-5, "{frequency}, {bias}, {k}: {x} for {e}");
                }
            }
        }
    }
}

/// Play and a limited rate around which a static feedback closes follow those of the closed loop. At their turns the input that follows from
/// one mode is a rounding away from asking for the other.
#[test]
fn play_and_limited_rates_do_not_chatter_in_a_loop() {
    for (block, closed) in [
        (r#"Backlash(width: 0.3)"#, r#"Backlash(width: "0.3/1.9")"#),
        (r#"RateLimiter(rising: 2.6, falling: -3.9)"#, r#"RateLimiter(rising: 2.6, falling: -3.9)"#),
    ] {
        // A start outside of the play, too: the nearer flank carries, whatever the loop is guessed to be meanwhile.
        for (frequency, phase) in [(0.49, 0.0), (1.01, 0.0), (1.7, 0.0), (1.01, 5.4), (0.49, 1.2)] {
            let run = simulate(
                "Auto",
                &format!(
                    r#""u": Sine(amplitude: 2.2, frequency: "{frequency} Hz", phase: {phase:?}), "e": Sum(signs: "+-"), "x": {block}, "k": Gain(k: 0.9),
                       "alone": Gain(k: "1/1.9"), "closed": {closed}, "show": Scope(inputs: ["x", "closed"])"#
                ),
                r#""u.y -> e.u1, alone.u", "e.y -> x.u", "x.y -> k.u, show.x", "k.y -> e.u2", "alone.y -> closed.u", "closed.y -> show.closed""#,
            );
            for (row, (x, closed)) in run.column("show.x").iter().zip(run.column("show.closed")).enumerate() {
                assert!(
                    (x - closed).abs() < 1e-6,
                    "{block}, {frequency} Hz: {x} instead of {closed} at {}",
                    run.time[row]
                );
            }
        }
    }
}

/// The solution that is followed can meet a second one, and beyond that point neither exists. The run must stop there: the model does not
/// define a way to the third solution.
#[test]
fn a_solution_that_ends_is_not_exchanged_for_another_one() {
    // y^3 - 3 y = u has no solution near -1 beyond u = 2; y - 2 tanh(y) = -u none near 0.88 beyond u = 0.53.
    for (law, slope, end) in [("u + 4*q - q^3", 1.0, 2.0), ("2*tanh(q) + u", 1.0, 0.5328)] {
        let (message, t) = {
            let text = format!(
                r#"Diagram(simulation: (stop_time: 4, output: Every("50 ms")),
                    blocks: {{ "u": Ramp(slope: {slope:?}), "f": Expression(law: "{law}"), "show": Scope(inputs: ["y"]) }},
                    connections: ["u.y -> f.u", "f.y -> f.q, show.y"])"#
            );
            let (compiled, problems) = compile_text(&text);
            let error = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}"))).error.expect("an end");
            (error.message, error.t)
        };
        assert!(message.contains("has no solution that could be found"), "{law}: {message}");
        assert!(t >= end - 1e-6 && t < end + 0.1, "{law}: {t}");
    }
}

/// x' = K x + b with the eigenvalues 0.2 and -0.5 of K, whose product is a matrix as long as x is taken for a number; and s = K s + b.
#[test]
fn a_product_with_a_matrix_in_a_loop_gets_the_shape_of_its_signal() {
    let k = r#"[["0.1 1/s", "0.2 1/s"], ["0.3 1/s", "-0.4 1/s"]]"#;
    for product in [
        format!(r#""k": Gain(k: {k}, multiplication: KTimesU)"#),
        format!(r#""c": Constant(value: {k}), "k": Product(multiplication: Matrix)"#),
    ] {
        let to = if product.contains("Product") {
            r#""c.y -> k.u1", "a.y -> k.u2, show.u""#
        } else {
            r#""a.y -> k.u, show.u""#
        };
        let run = simulate(
            "Dop853(rtol: 1e-10)",
            &format!(
                r#""a": Integrator, "b": Constant(value: ["1 1/s", "2 1/s"]), {product}, "s": Sum(signs: "++"), "show": Scope"#
            ),
            &format!(r#""b.y -> s.u1", "k.y -> s.u2", "s.y -> a.u", {to}"#),
        );
        let grown = |t: f64| ((0.2 * t).exp() - 1.0) / 0.2;
        let faded = |t: f64| (1.0 - (-0.5 * t).exp()) / 0.5;
        every_row(&run, "show.u[0]", 1e-8, |t| (10.0 * grown(t) - 3.0 * faded(t)) / 7.0);
        every_row(&run, "show.u[1]", 1e-8, |t| (5.0 * grown(t) + 9.0 * faded(t)) / 7.0);
    }
    let run = simulate(
        "Auto",
        r#""t": Sine(frequency: "1 Hz"), "b": Constant(value: [1, 2]), "k": Gain(k: [[0.1, 0.2], [0.3, -0.4]], multiplication: KTimesU),
           "s": Sum(signs: "++"), "show": Scope(inputs: ["s", "t"])"#,
        r#""b.y -> s.u1", "k.y -> s.u2", "s.y -> k.u, show.s", "t.y -> show.t""#,
    );
    every_row(&run, "show.s[0]", 1e-12, |_| 1.5);
    every_row(&run, "show.s[1]", 1e-12, |_| 1.75);
}
