//! Systems of differential and algebraic equations: constraints, mass matrices, linear systems with a singular matrix before the
//! derivatives; against closed forms, other formulations and published values.

use std::fmt::Write;
use std::sync::Arc;

use blocksim_sim::{Ended, Frozen, Observer, Simulation, Tap};
use blocksim_tests::{Run, close, compile_text, run, run_text};

const SOLVERS: [&str; 6] = ["Auto", "Ode23", "Ode15s", "Radau5", "Rodas4", "Ode4(step: \"1 ms\")"];

fn diagram(settings: &str, blocks: &str, connections: &str) -> String {
    format!("Diagram(simulation: ({settings}), blocks: {{ {blocks} }}, connections: [ {connections} ])")
}

/// What goes wrong while it runs: code, time, path, message and how many rows there are.
fn error(text: &str) -> (&'static str, f64, String, String, usize) {
    let (compiled, problems) = compile_text(text);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let error = run.error.expect("an error");
    (error.code, error.t, error.path.unwrap_or_default(), error.message, run.time.len())
}

#[track_caller]
fn every_row(run: &Run, column: &str, tolerance: f64, expected: impl Fn(f64) -> f64) {
    assert!(run.time.len() > 10, "{:?}", run.time);
    for (t, y) in run.time.iter().zip(run.column(column)) {
        assert!((y - expected(*t)).abs() <= tolerance, "{column} at {t}: {y} instead of {}", expected(*t));
    }
}

/// What is left over stands in the place of an unknown, wherever the blocks come that read it: m + n = 3, m - n = 1, with names in
/// each order.
#[test]
fn nobody_reads_what_is_left_over_in_the_place_of_an_unknown() {
    for (first, second) in [("a_sum", "z_sum"), ("z_sum", "a_sum"), ("a_sum", "b_sum"), ("y_sum", "z_sum")] {
        let run = run_text(&format!(
            r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{
                "m": AlgebraicConstraint(z0: 0.5), "n": AlgebraicConstraint(z0: 0.3),
                "{first}": Sum(signs: "++-"), "{second}": Sum(signs: "+--"),
                "three": Constant(value: 3), "one": Constant(value: 1), "show": Scope(inputs: ["m", "n"]),
            }}, connections: [
                "m.z -> {first}.u1, {second}.u1, show.m", "n.z -> {first}.u2, {second}.u2, show.n",
                "three.y -> {first}.u3", "one.y -> {second}.u3", "{first}.y -> m.f", "{second}.y -> n.f",
            ])"#
        ));
        close(run.last("show.m"), 2.0, 1e-12, "m");
        close(run.last("show.n"), 1.0, 1e-12, "n");
    }
}

/// A capacitor that is charged from a constant voltage through a resistor and a diode, i = is (exp(v / vt) - 1). From
/// vc = u - R i - vt ln(1 + i / is) and C vc' = i follows t as a function of i.
#[test]
fn a_capacitor_behind_a_diode_is_charged_as_the_closed_form_says() {
    let (u, r, c, is, vt) = (5.0_f64, 100.0, 1e-6, 1e-9, 0.026);
    let i0 = {
        // u = R i + vt ln(1 + i / is), by bisection.
        let (mut low, mut high) = (0.0, u / r);
        for _ in 0..200 {
            let i: f64 = 0.5 * (low + high);
            if r * i + vt * (1.0 + i / is).ln() < u { low = i } else { high = i }
        }
        low
    };
    let time = |i: f64| c * (r * (i0 / i).ln() + vt / is * ((i0 / (i0 + is)).ln() - (i / (i + is)).ln()));
    for solver in ["Auto", "Ode23", "Ode15s", "Radau5", "Rodas4"] {
        let run = run_text(&diagram(
            &format!(r#"stop_time: "2 ms", solver: {solver}(rtol: 1e-8)"#),
            r#""u": Constant(value: 5), "vc": Integrator, "left": Sum(signs: "+--"), "through": Gain(k: 0.01),
               "vd": AlgebraicConstraint(z0: 0.5), "over": Gain(k: 38.46153846153846), "exp": Function(function: Exp), "one": Constant(value: 1),
               "less": Sum(signs: "+-"), "i": Gain(k: 1e-9), "f": Sum(signs: "+-"), "rate": Gain(k: "1e6 1/s"), "show": Scope(inputs: ["vc", "i"])"#,
            r#""u.y -> left.u1", "vc.y -> left.u2, show.vc", "vd.z -> left.u3, over.u", "left.y -> through.u", "over.y -> exp.u",
               "exp.y -> less.u1", "one.y -> less.u2", "less.y -> i.u", "i.y -> f.u1, rate.u, show.i", "through.y -> f.u2", "f.y -> vd.f", "rate.y -> vc.u""#,
        ));
        let rows = run.time.iter().zip(run.column("show.i")).zip(run.column("show.vc"));
        for ((t, i), vc) in rows {
            assert!((r * i + vt * (i / is).ln_1p() + vc - u).abs() < 1e-9, "{solver} at {t}: {i} {vc}");
            // How much the voltage is off: ten errors of a step.
            let off = (time(*i) - t) * i / c;
            assert!(off.abs() < 10.0 * 1e-8 * u, "{solver}: {i} A at {t}, not at {}", time(*i));
        }
        assert!(run.time.len() > 20);
    }
}

/// x = z + z^3, drawn without its inverse; by Cardano's formula.
#[test]
fn a_constraint_follows_its_equation_through_zero_whatever_its_units() {
    let solution = |x: f64| {
        let root = (0.25 * x * x + 1.0 / 27.0_f64).sqrt();
        (0.5 * x + root).cbrt() + (0.5 * x - root).cbrt()
    };
    for size in [1e-12, 1.0, 1e9] {
        let run = run_text(&diagram(
            "stop_time: 2",
            &format!(
                r#""x": Sine(amplitude: 2, frequency: "1 Hz"), "z": AlgebraicConstraint, "p": Product(inputs: 3), "sum": Sum(signs: "++-"),
                   "f": Gain(k: {size:e}), "show": Scope(inputs: ["z"])"#
            ),
            r#""z.z -> p.u1, p.u2, p.u3, sum.u1, show.z", "p.y -> sum.u2", "x.y -> sum.u3", "sum.y -> f.u", "f.y -> z.f""#,
        ));
        every_row(&run, "show.z", 1e-11, |t| solution(2.0 * (std::f64::consts::TAU * t).sin()));
    }
}

/// What must be zero is the difference of large numbers times a million: rounding leaves more than 1e-10 of it, and z is right to
/// rounding all the same. And a small z beside large signals of another unit.
#[test]
fn rounding_of_large_signals_neither_ends_a_run_nor_hides_a_small_unknown() {
    let run = run_text(&diagram(
        "stop_time: 10",
        r#""s": Sine(amplitude: 1, frequency: "0.1 Hz"), "three": Constant(value: 3), "z": AlgebraicConstraint, "a": Sum(signs: "++"),
           "b": Sum(signs: "++"), "d": Sum(signs: "+-"), "k": Gain(k: 1e6), "show": Scope(inputs: ["z"])"#,
        r#""three.y -> a.u1, b.u1", "z.z -> a.u2, show.z", "s.y -> b.u2", "a.y -> d.u1", "b.y -> d.u2", "d.y -> k.u", "k.y -> z.f""#,
    ));
    every_row(&run, "show.z", 1e-12, |t| (0.1 * std::f64::consts::TAU * t).sin());
    let run = run_text(&diagram(
        "stop_time: 10",
        r#""s": Sine(amplitude: 1e-9, frequency: "0.1 Hz"), "z": AlgebraicConstraint, "big": Gain(k: 1e20), "back": Gain(k: 1e-20),
           "d": Sum(signs: "+-"), "show": Scope(inputs: ["z"])"#,
        r#""z.z -> big.u, show.z", "big.y -> back.u", "back.y -> d.u1", "s.y -> d.u2", "d.y -> z.f""#,
    ));
    every_row(&run, "show.z", 1e-20, |t| 1e-9 * (0.1 * std::f64::consts::TAU * t).sin());
}

/// z0^2 + z1^2 = 1 + t, z0 = z1 + x with x' = -z1: two unknowns in a vector, and which solution is chosen by the guess.
#[test]
fn a_vector_of_unknowns_is_found_and_the_guess_says_which_solution() {
    for (guess, sign) in [("[1.0, 1.0]", 1.0), ("[-1.0, -1.0]", -1.0)] {
        for solver in SOLVERS {
            let run = run_text(&diagram(
                &format!("stop_time: 2, solver: {solver}"),
                &format!(
                    r#""t": Ramp(slope: "1 1/s"), "one": Constant(value: 1), "z": AlgebraicConstraint(z0: {guess}), "part": Demux(sizes: [1, 1]),
                       "p0": Product(inputs: 2), "p1": Product(inputs: 2), "f0": Sum(signs: "++--"), "f1": Sum(signs: "+-"), "f": Mux(inputs: 2),
                       "show": Scope(inputs: ["z"])"#
                ),
                r#""z.z -> part.u, show.z", "part.y1 -> p0.u1, p0.u2, f1.u1", "part.y2 -> p1.u1, p1.u2, f1.u2", "p0.y -> f0.u1", "p1.y -> f0.u2",
                   "one.y -> f0.u3", "t.y -> f0.u4", "f0.y -> f.u1", "f1.y -> f.u2", "f.y -> z.f""#,
            ));
            for column in ["show.z[0]", "show.z[1]"] {
                every_row(&run, column, 1e-11, |t| sign * (0.5 * (1.0 + t)).sqrt());
            }
        }
    }
}

/// A pendulum in its plane: x'' = -l x, y'' = -l y - g, where the force l along the rod follows from the constraint
/// x^2 + y^2 = 1 differentiated twice: 0 = x x'' + y y'' + vx^2 + vy^2 (index 1). Started at rest at 90 degrees it is at
/// the bottom after K(1/2) / sqrt(g), 1.8540746773013719 / sqrt(g).
#[test]
fn a_pendulum_of_index_one_swings_with_the_period_of_the_elliptic_integral() {
    let quarter = 1.854_074_677_301_371_9 / 9.81_f64.sqrt();
    let plane = r#""x": Integrator(x0: 1), "y": Integrator(x0: 0), "vx": Integrator, "vy": Integrator, "g": Constant(value: 9.81),
        "vx2": Product(inputs: 2), "vy2": Product(inputs: 2), "show": Scope(inputs: ["x", "y"])"#;
    let wires =
        r#""vx.y -> x.u, vx2.u1, vx2.u2", "vy.y -> y.u, vy2.u1, vy2.u2", "x.y -> show.x", "y.y -> show.y""#;
    // The force along the rod by a constraint.
    let constraint = (
        r#""l": AlgebraicConstraint, "lx": Product(inputs: 2), "ly": Product(inputs: 2), "ax": Gain(k: -1), "ay": Sum(signs: "--"),
           "xax": Product(inputs: 2), "yay": Product(inputs: 2), "f": Sum(signs: "++++")"#,
        r#""l.z -> lx.u1, ly.u1", "x.y -> lx.u2, xax.u1", "y.y -> ly.u2, yay.u1", "lx.y -> ax.u", "ly.y -> ay.u1", "g.y -> ay.u2",
           "ax.y -> vx.u, xax.u2", "ay.y -> vy.u, yay.u2", "xax.y -> f.u1", "yay.y -> f.u2", "vx2.y -> f.u3", "vy2.y -> f.u4", "f.y -> l.f""#,
    );
    // The same as linear equations for both accelerations and the force.
    let matrix = (
        r#""one": Constant(value: 1), "none": Constant(value: 0), "m": Mux(inputs: 9), "r": Sum(signs: "--"), "fall": Gain(k: -1), "right": Mux(inputs: 3),
           "solve": LinearSolve, "a": Demux(sizes: [1, 1, 1]), "rest": Terminator"#,
        r#""one.y -> m.u1, m.u5", "none.y -> m.u2, m.u4, m.u9, right.u1", "x.y -> m.u3, m.u7", "y.y -> m.u6, m.u8", "m.y -> solve.m",
           "g.y -> fall.u", "fall.y -> right.u2", "vx2.y -> r.u1", "vy2.y -> r.u2", "r.y -> right.u3", "right.y -> solve.f", "solve.y -> a.u",
           "a.y1 -> vx.u", "a.y2 -> vy.u", "a.y3 -> rest.u""#,
    );
    for (blocks, connections) in [constraint, matrix] {
        for solver in [
            "Auto(rtol: 1e-9)",
            "Ode15s(rtol: 1e-9)",
            "Radau5(rtol: 1e-9)",
            "Rodas4(rtol: 1e-8)",
            "Ode4(step: \"1 ms\")",
        ] {
            let run = run_text(&diagram(
                &format!("stop_time: {quarter:.17}, solver: {solver}"),
                &format!("{plane}, {blocks}"),
                &format!("{wires}, {connections}"),
            ));
            let (x, y) = (run.last("show.x"), run.last("show.y"));
            assert!(x.abs() < 3e-7 && (y + 1.0).abs() < 3e-7, "{solver}: {x} {y}");
        }
    }
}

/// A run that goes on from a snapshot, slopes through a constraint, and a start in a steady state: x' = u - z, z + z^3 = x.
#[test]
fn slopes_snapshots_and_a_steady_start_see_a_constraint() {
    let text = |settings: &str| {
        diagram(
            settings,
            r#""u": Constant(value: 0.5), "x": Integrator(x0: 2), "d": Sum(signs: "+-"), "rate": Gain(k: "1 1/s"), "z": AlgebraicConstraint,
               "p": Product(inputs: 3), "f": Sum(signs: "++-"), "show": Scope(inputs: ["z", "x"])"#,
            r#""u.y -> d.u1", "z.z -> d.u2, show.z, p.u1, p.u2, p.u3, f.u2", "d.y -> rate.u", "rate.y -> x.u", "x.y -> f.u3, show.x",
               "p.y -> f.u1", "f.y -> z.f""#,
        )
    };
    let steady = run_text(&text("stop_time: 1, start: Steady"));
    every_row(&steady, "show.z", 1e-12, |_| 0.5);
    every_row(&steady, "show.x", 1e-12, |_| 0.625);

    let schedule = Arc::new(compile_text(&text("stop_time: 1")).0.schedule.expect("a schedule"));
    // At x = 2, z = 1: dx'/dx = -1 / (1 + 3 z^2).
    let simulation = Simulation::new(Arc::clone(&schedule)).expect("a start");
    let cell = schedule.signals.iter().find(|signal| signal.path == "z.z").expect("z").offset;
    let mut frozen = Frozen::new(simulation, vec![Tap { cell, open: false }]).expect("an instant");
    let mut dx = [0.0];
    let mut rate = |x: f64, change: f64| {
        frozen.evaluate(&[x], &[change], &mut dx).expect("a derivative");
        (dx[0], frozen.signal(cell))
    };
    let slope = (rate(2.0 + 1e-5, 0.0).0 - rate(2.0 - 1e-5, 0.0).0) / 2e-5;
    assert!((slope + 0.25).abs() < 1e-8, "{slope}");
    // Whatever is added to z on its way, it is found so that those who read it see what fulfils the equation.
    let (dx, z) = rate(2.0, 0.1);
    assert!((dx + 0.5).abs() < 1e-12 && (z - 1.0).abs() < 1e-12, "{dx} {z}");

    struct Ends(Vec<f64>);
    impl Observer for Ends {
        fn row(&mut self, t: f64, values: &[f64]) {
            self.0.push(t);
            self.0.extend(values);
        }
    }
    for solver in SOLVERS {
        let text = text(&format!("stop_time: 1, solver: {solver}"));
        let schedule = Arc::new(compile_text(&text).0.schedule.expect("a schedule"));
        let mut first = Simulation::new(Arc::clone(&schedule)).expect("a start");
        let mut unused = Ends(Vec::new());
        assert_eq!(first.run_until(0.4, &mut unused), Ok(Ended::Finished));
        let snapshot = first.snapshot();
        let mut second = Simulation::new(schedule).expect("a start");
        second.restore(&snapshot).expect("a snapshot of this diagram");
        let (mut a, mut b) = (Ends(Vec::new()), Ends(Vec::new()));
        assert_eq!(first.run(&mut a), Ok(Ended::Finished));
        assert_eq!(second.run(&mut b), Ok(Ended::Finished));
        assert!(a.0.len() > 6 && a.0 == b.0, "{solver}");
    }
}

#[test]
fn a_constraint_that_is_meant_is_no_warning_and_a_slip_beside_it_still_is() {
    let told = |blocks: &str, connections: &str| {
        let (compiled, problems) = compile_text(&diagram("stop_time: 1", blocks, connections));
        (compiled.schedule.is_some(), problems)
    };
    let blocks = r#""z": AlgebraicConstraint, "c": Constant(value: 1), "f": Sum(signs: "+-")"#;
    let connections = r#""z.z -> f.u1", "c.y -> f.u2", "f.y -> z.f""#;
    let (runs, problems) = told(blocks, connections);
    assert!(runs && problems.is_empty(), "{problems}");
    let (runs, problems) = told(
        &format!(r#"{blocks}, "k": Gain(k: -0.5), "e": Sum(signs: "++")"#),
        r#""z.z -> e.u1", "e.y -> k.u, f.u1", "k.y -> e.u2", "c.y -> f.u2", "f.y -> z.f""#,
    );
    assert!(runs && problems.contains("algebraic loop: e -> k -> e; solved"), "{problems}");
    let (runs, problems) =
        told(r#""z": AlgebraicConstraint, "x": Integrator"#, r#""z.z -> x.u", "x.y -> z.f""#);
    assert!(!runs && problems.contains("`z.f` does not depend on `z.z` at the same instant"), "{problems}");
    let (runs, problems) = told(
        r#""z": AlgebraicConstraint, "hold": ZeroOrderHold(ts: "1 ms")"#,
        r#""z.z -> hold.u", "hold.y -> z.f""#,
    );
    assert!(!runs && problems.contains("evaluated at different times"), "{problems}");
}

#[test]
fn a_constraint_without_a_solution_is_an_error_with_its_time_and_the_rows_before() {
    // z^2 = 1 - t ends at 1 s.
    let (code, t, path, message, rows) = error(&diagram(
        "stop_time: 2",
        r#""t": Ramp(slope: "-1 1/s"), "one": Constant(value: 1), "z": AlgebraicConstraint(z0: 1), "p": Product(inputs: 2),
           "f": Sum(signs: "-++"), "x": Integrator, "show": Scope(inputs: ["z"])"#,
        r#""one.y -> f.u2", "t.y -> f.u3", "z.z -> p.u1, p.u2, x.u, show.z", "p.y -> f.u1", "f.y -> z.f""#,
    ));
    assert!(code == "algebraic_loop" && path == "z" && (t - 1.0).abs() < 1e-6 && rows > 10, "{t} {rows}");
    assert!(
        message.starts_with("the constraint of `z` ") && message.contains("nearest found: z = "),
        "{message}"
    );
    let (_, t, _, message, _) = error(&diagram(
        "stop_time: 2",
        r#""t": Ramp(slope: "1 1/s"), "none": Gain(k: 0), "z": AlgebraicConstraint, "f": Sum(signs: "++")"#,
        r#""t.y -> f.u1", "z.z -> none.u", "none.y -> f.u2", "f.y -> z.f""#,
    ));
    assert!(t == 0.0 && message.contains("determines no single value"), "{message}");
    // x' = (1, 1) / [1 1; 1 t]: its determinant is t - 1, which nobody sees in the solution (1, 0).
    let (code, t, path, message, rows) = error(&diagram(
        "stop_time: 2",
        r#""t": Ramp(slope: "1 1/s"), "one": Constant(value: 1), "m": Mux(inputs: 4), "f": Mux(inputs: 2), "solve": LinearSolve, "x": Integrator,
           "show": Scope(inputs: ["x"])"#,
        r#""one.y -> m.u1, m.u2, m.u3, f.u1, f.u2", "t.y -> m.u4", "m.y -> solve.m", "f.y -> solve.f", "solve.y -> x.u", "x.y -> show.x""#,
    ));
    assert!(
        code == "block_failed" && path == "solve" && (t - 1.0).abs() < 1e-6 && rows > 10,
        "{t} {message}"
    );
    assert!(message.contains("singular"), "{message}");
}

/// A resistor and a coil in series at a sine, x = (current, voltage of the coil): L i' = v, 0 = u - R i - v; in closed form.
#[test]
fn a_descriptor_system_follows_its_closed_form_with_every_method() {
    let (r, l, w) = (2.0, 0.5, std::f64::consts::PI);
    let (size, lag) = (1.0 / f64::hypot(r, w * l), f64::atan2(w * l, r));
    for solver in SOLVERS {
        let run = run_text(&diagram(
            &format!("stop_time: 3, solver: {solver}"),
            r#""u": Sine(amplitude: 1, frequency: "0.5 Hz"),
               "g": DescriptorStateSpace(e: [[0.5, 0.0], [0.0, 0.0]], a: [[0.0, 1.0], [-2.0, -1.0]], b: [[0.0], [1.0]], c: [[1.0, 0.0], [0.0, 1.0]]),
               "show": Scope(inputs: ["x"])"#,
            r#""u.y -> g.u", "g.y -> show.x""#,
        ));
        let i = |t: f64| size * ((w * t - lag).sin() + lag.sin() * (-r / l * t).exp());
        every_row(&run, "show.x[0]", 2e-5, i);
        every_row(&run, "show.x[1]", 4e-5, |t| (w * t).sin() - r * i(t));
    }
    let (_, t, path, message, _) = error(&diagram(
        "stop_time: 3",
        r#""u": Constant(value: 1),
           "g": DescriptorStateSpace(e: [[0.5, 0.0], [0.0, 0.0]], a: [[0.0, 1.0], [-2.0, -1.0]], b: [[0.0], [1.0]], c: [[1.0, 0.0]], x0: [0, 0]),
           "show": Scope(inputs: ["x"])"#,
        r#""u.y -> g.u", "g.y -> show.x""#,
    ));
    assert!(t == 0.0 && path == "g" && message.contains("x0[1] is 0, but 1.000000e0 follows"), "{message}");
    for (e, a, reason) in [
        ("[[1, 0], [0, 0]]", "[[0, 1], [1, 0]]", "index of the equations is 2 or more"),
        ("[[1, 0], [0, 0]]", "[[0, 1], [0, 0]]", "singular for every s"),
    ] {
        let (compiled, problems) = compile_text(&diagram(
            "stop_time: 3",
            &format!(
                r#""u": Constant(value: 1), "g": DescriptorStateSpace(e: {e}, a: {a}, b: [[0], [1]], c: [[1, 0]]), "show": Scope"#
            ),
            r#""u.y -> g.u", "g.y -> show.u""#,
        ));
        assert!(compiled.schedule.is_none() && problems.contains(reason), "{problems}");
    }
}

/// A double pendulum, M(q) q'' = f: its mass matrix as signals, against the same equations solved by Cramer's rule and
/// integrated with small steps of Runge and Kutta.
#[test]
fn a_mass_matrix_that_moves_is_solved_at_every_instant() {
    // Both masses 1 kg, both lengths 1 m: [2 cos d; cos d 1] (a1, a2) = (-sin d w2^2 - 2 g sin q1, sin d w1^2 - g sin q2), d = q1 - q2.
    let rates = |[q1, q2, w1, w2]: [f64; 4]| {
        let (sin, cos) = (q1 - q2).sin_cos();
        let f1 = -sin * w2 * w2 - 2.0 * 9.81 * q1.sin();
        let f2 = sin * w1 * w1 - 9.81 * q2.sin();
        let determinant = 2.0 - cos * cos;
        [w1, w2, (f1 - cos * f2) / determinant, (2.0 * f2 - cos * f1) / determinant]
    };
    let mut x = [1.0, 0.5, 0.0, 0.0];
    let h = 1e-4;
    let add = |x: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    for _ in 0..20_000 {
        let k1 = rates(x);
        let k2 = rates(add(x, k1, 0.5 * h));
        let k3 = rates(add(x, k2, 0.5 * h));
        let k4 = rates(add(x, k3, h));
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    let run = run_text(&diagram(
        "stop_time: 2, solver: Auto(rtol: 1e-9)",
        r#""q1": Integrator(x0: 1), "q2": Integrator(x0: 0.5), "w": Integrator, "part": Demux(sizes: [1, 1]), "d": Sum(signs: "+-"),
           "sin": Function(function: Sin), "cos": Function(function: Cos), "two": Constant(value: 2), "one": Constant(value: 1), "m": Mux(inputs: 4),
           "s1": Function(function: Sin), "s2": Function(function: Sin), "g1": Gain(k: "-19.62 1/s^2"), "g2": Gain(k: "-9.81 1/s^2"),
           "c1": Product(inputs: 3), "c2": Product(inputs: 3), "f1": Sum(signs: "-+"), "f2": Sum(signs: "++"), "f": Mux(inputs: 2),
           "solve": LinearSolve, "show": Scope(inputs: ["q1", "q2", "w"])"#,
        r#""w.y -> part.u, show.w", "part.y1 -> q1.u, c2.u2, c2.u3", "part.y2 -> q2.u, c1.u2, c1.u3", "q1.y -> d.u1, s1.u, show.q1", "q2.y -> d.u2, s2.u, show.q2",
           "d.y -> sin.u, cos.u", "two.y -> m.u1", "cos.y -> m.u2, m.u3", "one.y -> m.u4", "sin.y -> c1.u1, c2.u1", "s1.y -> g1.u", "s2.y -> g2.u",
           "c1.y -> f1.u1", "g1.y -> f1.u2", "c2.y -> f2.u1", "g2.y -> f2.u2", "f1.y -> f.u1", "f2.y -> f.u2", "m.y -> solve.m", "f.y -> solve.f", "solve.y -> w.u""#,
    ));
    for (column, expected) in ["show.q1", "show.q2", "show.w[0]", "show.w[1]"].into_iter().zip(x) {
        assert!((run.last(column) - expected).abs() < 1e-6, "{column}: {} {expected}", run.last(column));
    }
}

/// Robertson's reaction with the conservation of mass in the place of its last equation.
#[test]
fn robertsons_reaction_with_a_constraint_ends_where_the_literature_says() {
    let expected = [2.083_340_149_701_255e-8, 8.333_360_770_334_713e-14, 0.999_999_979_166_505];
    for (solver, rtol) in
        [("Auto", 1e-4), ("Auto", 1e-6), ("Auto", 1e-8), ("Radau5", 1e-6), ("Ode15s", 1e-6), ("Rodas4", 1e-6)]
    {
        let run = run_text(&diagram(
            &format!("stop_time: 1e11, solver: {solver}(rtol: {rtol:e})"),
            r#""x": MassMatrixIntegrator(m: [[1, 0, 0], [0, 1, 0], [0, 0, 0]], x0: [1, 0, 0]), "part": Demux(sizes: [1, 1, 1]),
               "k1": Gain(k: 0.04), "p2": Product(inputs: 2), "k2": Gain(k: 3e7), "p3": Product(inputs: 2), "k3": Gain(k: 1e4),
               "d0": Sum(signs: "-+"), "d1": Sum(signs: "+--"), "one": Constant(value: 1), "all": Sum(signs: "+++-"), "f": Mux(inputs: 3),
               "show": Scope(inputs: ["x"])"#,
            r#""x.y -> part.u, show.x", "part.y1 -> k1.u, all.u1", "part.y2 -> p2.u1, p2.u2, p3.u1, all.u2", "part.y3 -> p3.u2, all.u3",
               "p2.y -> k2.u", "p3.y -> k3.u", "one.y -> all.u4", "k1.y -> d0.u1, d1.u1", "k3.y -> d0.u2, d1.u2", "k2.y -> d1.u3",
               "d0.y -> f.u1", "d1.y -> f.u2", "all.y -> f.u3", "f.y -> x.u""#,
        ));
        for (i, expected) in expected.into_iter().enumerate() {
            let found = run.last(&format!("show.x[{i}]"));
            // As for the three differential equations: a thousandth of the largest is what an error counts against at least.
            let error = (found - expected).abs() / expected.max(1e-3);
            assert!(error < 120.0 * rtol, "{solver} at {rtol:e}, x{i}: {found:e} {expected:e}");
        }
    }
}

/// The transistor amplifier, eight nodes between five capacitors: a mass matrix of rank 5. F. Mazzia, C. Magherini: Test Set for
/// Initial Value Problem Solvers, release 2.4 (2008).
fn amplifier(solver: &str) -> Run {
    let (ub, share, beta) = (6.0, 0.99, 1e-6);
    let mut m = [[0.0; 8]; 8];
    for (i, j, c) in [(0, 1, 1e-6), (3, 4, 3e-6), (6, 7, 5e-6)] {
        (m[i][i], m[j][j], m[i][j], m[j][i]) = (-c, -c, c, c);
    }
    (m[2][2], m[5][5]) = (-2e-6, -4e-6);
    let start = [0.0, ub / 2.0, ub / 2.0, ub, ub / 2.0, ub / 2.0, ub, 0.0];
    let conductance = 1.0 / 9000.0;
    // What leaves each node through resistors and transistors.
    let leaving: [&[(f64, &str)]; 8] = [
        &[(-1e-3, "ue.y"), (1e-3, "node.y1")],
        &[(-conductance, "ub.y"), (2.0 * conductance, "node.y2"), (1.0 - share, "g1.y")],
        &[(-1.0, "g1.y"), (conductance, "node.y3")],
        &[(-conductance, "ub.y"), (conductance, "node.y4"), (share, "g1.y")],
        &[(-conductance, "ub.y"), (2.0 * conductance, "node.y5"), (1.0 - share, "g2.y")],
        &[(-1.0, "g2.y"), (conductance, "node.y6")],
        &[(-conductance, "ub.y"), (conductance, "node.y7"), (share, "g2.y")],
        &[(conductance, "node.y8")],
    ];
    let mut blocks = format!(
        r#""v": MassMatrixIntegrator(m: {m:?}, x0: {start:?}), "node": Demux(sizes: [1, 1, 1, 1, 1, 1, 1, 1]), "f": Mux(inputs: 8),
           "ue": Sine(amplitude: 0.1, frequency: "100 Hz"), "ub": Constant(value: {ub}), "one": Constant(value: 1), "show": Scope(inputs: ["v"]),"#
    );
    let mut wires = r#""v.y -> node.u, show.v", "f.y -> v.u","#.to_owned();
    for (g, base, emitter) in [("g1", 2, 3), ("g2", 5, 6)] {
        write!(
            blocks,
            r#""{g}_v": Sum(signs: "+-"), "{g}_x": Gain(k: {:?}), "{g}_e": Function(function: Exp), "{g}_i": Sum(signs: "+-"), "{g}": Gain(k: {beta:?}),"#,
            1.0 / 0.026
        )
        .expect("text");
        write!(
            wires,
            r#""node.y{base} -> {g}_v.u1", "node.y{emitter} -> {g}_v.u2", "{g}_v.y -> {g}_x.u", "{g}_x.y -> {g}_e.u", "{g}_e.y -> {g}_i.u1",
               "one.y -> {g}_i.u2", "{g}_i.y -> {g}.u","#
        )
        .expect("text");
    }
    for (i, terms) in leaving.into_iter().enumerate() {
        write!(blocks, r#""f{i}": Sum(signs: "{}"),"#, "+".repeat(terms.len())).expect("text");
        for (k, (factor, from)) in terms.iter().enumerate() {
            let port = if terms.len() > 1 { format!("u{}", k + 1) } else { "u".to_owned() };
            write!(blocks, r#""k{i}_{k}": Gain(k: {factor:?}),"#).expect("text");
            write!(wires, r#""{from} -> k{i}_{k}.u", "k{i}_{k}.y -> f{i}.{port}","#).expect("text");
        }
        write!(wires, r#""f{i}.y -> f.u{}","#, i + 1).expect("text");
    }
    run_text(&diagram(&format!(r#"stop_time: "0.2 s", solver: {solver}"#), &blocks, &wires))
}

#[test]
fn the_transistor_amplifier_ends_where_the_literature_says() {
    let expected = [
        -0.556_214_501_226_270_9e-2,
        0.300_652_247_190_304_2e1,
        0.284_995_878_860_812_8e1,
        0.292_642_253_620_624_1e1,
        0.270_461_786_501_055_4e1,
        0.276_183_777_839_314_5e1,
        0.477_092_763_166_177_2e1,
        0.123_699_586_809_154_8e1,
    ];
    let mut found = Vec::new();
    for (solver, rtol) in
        [("Auto", 1e-4), ("Auto", 1e-6), ("Auto", 1e-8), ("Radau5", 1e-6), ("Ode15s", 1e-6), ("Rodas4", 1e-6)]
    {
        let run = amplifier(&format!("{solver}(rtol: {rtol:e})"));
        for (i, expected) in expected.into_iter().enumerate() {
            let found = run.last(&format!("show.v[{i}]"));
            let error = (found - expected).abs() / expected.abs();
            assert!(error < 80.0 * rtol, "{solver} at {rtol:e}, node {}: {found} {expected}", i + 1);
        }
        found.push((run.counts.accepted, run.counts.evaluations));
    }
    assert_eq!(found, [(690, 3126), (1359, 4870), (2824, 8708), (757, 10_820), (1369, 4757), (1677, 23_879)]);
}
