//! Loops are found by values: an apparent loop is not reported, and a real one has the values of an independent solution.

use std::sync::Arc;

use blocksim_sim::{Frozen, Simulation};
use blocksim_tests::{Run, compile_text, run, run_text};
use nalgebra::{DMatrix, DVector};

fn text(blocks: &str, connections: &str) -> String {
    format!("Diagram(simulation: (stop_time: 2), blocks: {{ {blocks} }}, connections: [ {connections} ])")
}

/// Runs what has no loop, which nothing is said about.
#[track_caller]
fn without_loop(blocks: &str, connections: &str) -> Run {
    let (compiled, problems) = compile_text(&text(blocks, connections));
    assert_eq!(problems, "");
    let schedule = compiled.schedule.expect("a schedule");
    assert!(schedule.loops.is_empty(), "{:?}", schedule.loops);
    run(schedule)
}

/// Number of unknowns of each loop.
fn unknowns(blocks: &str, connections: &str) -> Vec<usize> {
    let (compiled, problems) = compile_text(&text(blocks, connections));
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.loops.iter().map(|found| found.cells.len()).collect()
}

#[track_caller]
fn every_row(run: &Run, column: &str, tolerance: f64, expected: impl Fn(f64) -> f64) {
    assert_eq!(run.error, None);
    assert!(run.time.len() > 10, "{:?}", run.time);
    for (t, y) in run.time.iter().zip(run.column(column)) {
        assert!((y - expected(*t)).abs() <= tolerance, "{column} at {t}: {y} instead of {}", expected(*t));
    }
}

#[test]
fn a_vector_through_which_separate_values_go_is_no_loop() {
    // Both values go through one vector and one gain, the first on its way to become the second: 3 (3 t).
    let run = without_loop(
        r#""t": Ramp(slope: "1 1/s"), "both": Mux(inputs: 2), "k": Gain(k: 3), "apart": Demux(sizes: [1, 1]), "show": Scope(inputs: ["a", "b"])"#,
        r#""t.y -> both.u1", "both.y -> k.u", "k.y -> apart.u", "apart.y1 -> both.u2, show.a", "apart.y2 -> show.b""#,
    );
    every_row(&run, "show.a", 0.0, |t| 3.0 * t);
    every_row(&run, "show.b", 1e-14, |t| 9.0 * t);
    // The same with a selector, sums of vectors, and twenty elements one behind the other.
    let n = 20;
    let ports: String = (2..=n).map(|i| format!("\"at{}.y -> all.u{i}\",", i - 1)).collect();
    let selectors: String = (1..=n).map(|i| format!("\"at{i}\": Selector(indices: [{}]),", i - 1)).collect();
    let taken: String = (1..=n).map(|i| format!("\"sum.y -> at{i}.u\",")).collect();
    let run = without_loop(
        &format!(
            r#""t": Ramp(slope: "1 1/s"), "one": Constant(value: {:?}), "all": Mux(inputs: {n}), "sum": Sum(signs: "++"), {selectors} "show": Scope(inputs: ["y"])"#,
            vec![1.0; n]
        ),
        &format!(
            r#""t.y -> all.u1", {ports} "all.y -> sum.u1", "one.y -> sum.u2", {taken} "at{n}.y -> show.y""#
        ),
    );
    every_row(&run, "show.y", 1e-13, |t| t + 20.0);
}

#[test]
fn a_state_space_passes_on_what_its_matrix_passes_on() {
    // y1 = x + 2 u2, y2 = 3 x: u2 may follow from y2 at once. x' = -x, x = exp(-t); y1 = x + 2 (5 (3 x)).
    let space = r#""g": StateSpace(a: [[-1]], b: [[0, 0]], c: [[1], [3]], d: [[0, 2], [0, 0]], x0: [1])"#;
    let rest = r#""zero": Constant(value: 0), "into": Mux(inputs: 2), "out": Demux(sizes: [1, 1]), "k": Gain(k: 5), "show": Scope(inputs: ["y"])"#;
    let run = without_loop(
        &format!("{space}, {rest}"),
        r#""zero.y -> into.u1", "k.y -> into.u2", "into.y -> g.u", "g.y -> out.u", "out.y2 -> k.u", "out.y1 -> show.y""#,
    );
    every_row(&run, "show.y", 1e-5, |t| 31.0 * (-t).exp());
    // With another feedthrough y2 = 3 x + 0.5 u2 it is a loop of one unknown: u2 = 5 y2 = 15 x / (1 - 2.5) = -10 x.
    let blocks = format!("{}, {rest}", space.replace("[0, 2], [0, 0]]", "[0, 2], [0, 0.5]]"));
    let connections = r#""zero.y -> into.u1", "k.y -> into.u2", "into.y -> g.u", "g.y -> out.u", "out.y2 -> k.u", "out.y1 -> show.y""#;
    assert_eq!(unknowns(&blocks, connections), [1]);
    every_row(&run_text(&text(&blocks, connections)), "show.y", 1e-5, |t| -19.0 * (-t).exp());
}

/// Each element of a vector that is fed back is a loop of its own, with its own gain k_i / (1 + k_i).
#[test]
fn elements_that_are_fed_back_are_loops_of_one_unknown() {
    let blocks = r#""t": Ramp(slope: "1 1/s"), "e": Sum(signs: "+-"), "k": Gain(k: [1, 3, 9]), "wide": Gain(k: [1, 1, 1]), "show": Scope(inputs: ["y"])"#;
    let connections = r#""t.y -> wide.u", "wide.y -> e.u1", "e.y -> k.u", "k.y -> e.u2, show.y""#;
    assert_eq!(unknowns(blocks, connections), [1, 1, 1]);
    let (_, problems) = compile_text(&text(blocks, connections));
    assert_eq!(problems.matches("algebraic loop").count(), 1, "{problems}");
    assert!(problems.contains("there are 3 such loops, of single elements"), "{problems}");
    let run = run_text(&text(blocks, connections));
    for (i, k) in [1.0, 3.0, 9.0].into_iter().enumerate() {
        every_row(&run, &format!("show.y[{i}]"), 1e-14, |t| k / (1.0 + k) * t);
    }
}

/// A small generator of numbers between -1 and 1 (SplitMix).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// y = A y + b t with gains and sums, for random A of which many entries are zero, against a dense solution; then the same as one
/// gain by a matrix, and scaled so that elements have very different units.
#[test]
fn random_affine_loops_have_the_values_of_a_dense_solution() {
    let mut tried = 0;
    for seed in 0..40 {
        let mut random = Random(seed);
        let n = 2 + seed as usize % 6;
        let mut a = DMatrix::from_fn(n, n, |_, _| 0.0);
        for entry in a.iter_mut() {
            let (value, share) = (3.0 * random.next(), random.next());
            *entry = if share < 0.2 { value } else { 0.0 };
        }
        // One way round at least, and a zero on the diagonal of 1 - A now and then.
        (0..n).for_each(|i| a[(i, (i + 1) % n)] += 0.7);
        if seed % 5 == 0 {
            a[(0, 0)] = 1.0;
        }
        let scale: Vec<f64> =
            (0..n).map(|i| if seed % 2 == 0 { 1.0 } else { 1e9_f64.powf((i % 3) as f64 - 1.0) }).collect();
        let a = DMatrix::from_fn(n, n, |i, j| a[(i, j)] * scale[i] / scale[j]);
        let b = DVector::from_fn(n, |i, _| random.next() * scale[i]);
        let matrix = DMatrix::identity(n, n) - &a;
        let Some(inverse) = matrix.clone().try_inverse() else { continue };
        let condition: f64 = {
            let size = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)].abs() * scale[j] / scale[i]);
            size.sum()
        };
        if condition > 1e5 {
            continue;
        }
        tried += 1;
        let solution = matrix.lu().solve(&b).expect("a solution");
        let mut blocks =
            String::from(r#""t": Ramp(slope: "1 1/s"), "show": Scope(inputs: ["y"]), "all": Mux(inputs: "#);
        blocks += &format!("{n}),");
        let mut connections = String::from("\"all.y -> show.y\",");
        for i in 0..n {
            let inputs: Vec<usize> = (0..n).filter(|j| a[(i, *j)] != 0.0).collect();
            blocks += &format!(
                "\"y{i}\": Sum(signs: \"{}\"), \"b{i}\": Gain(k: {:e}),",
                "+".repeat(inputs.len() + 1),
                b[i]
            );
            connections +=
                &format!("\"t.y -> b{i}.u\", \"b{i}.y -> y{i}.u1\", \"y{i}.y -> all.u{}\",", i + 1);
            for (port, j) in inputs.iter().enumerate() {
                blocks += &format!("\"a{i}_{j}\": Gain(k: {:e}),", a[(i, *j)]);
                connections += &format!("\"y{j}.y -> a{i}_{j}.u\", \"a{i}_{j}.y -> y{i}.u{}\",", port + 2);
            }
        }
        let run = run_text(&text(&blocks, &connections));
        for i in 0..n {
            let column = format!("show.y[{i}]");
            let tolerance = 1e-14 * (1.0 + condition) * scale[i];
            every_row(&run, &column, 2.0 * tolerance, |t| solution[i] * t);
        }
        let rows: Vec<String> =
            (0..n).map(|i| format!("{:?}", a.row(i).iter().copied().collect::<Vec<f64>>())).collect();
        let run = run_text(&text(
            &format!(
                r#""t": Ramp(slope: "1 1/s"), "b": Gain(k: {:?}), "z": Gain(k: [{}], multiplication: KTimesU), "y": Sum(signs: "++"), "show": Scope(inputs: ["y"])"#,
                b.iter().copied().collect::<Vec<f64>>(),
                rows.join(", ")
            ),
            r#""t.y -> b.u", "b.y -> y.u1", "y.y -> z.u, show.y", "z.y -> y.u2""#,
        ));
        for i in 0..n {
            let column = format!("show.y[{i}]");
            let tolerance = 1e-14 * (1.0 + condition) * scale[i];
            every_row(&run, &column, 2.0 * tolerance, |t| solution[i] * t);
        }
    }
    assert!(tried > 25, "{tried}");
}

/// y = 1 + c(t) y with c = t / 4: the slope changes, and the loop stays affine.
#[test]
fn slopes_of_an_affine_loop_may_vary() {
    let run = run_text(&text(
        r#""c": Ramp(slope: "0.25 1/s"), "one": Constant(value: 1), "p": Product(inputs: 2), "y": Sum(signs: "++"), "show": Scope(inputs: ["y"])"#,
        r#""c.y -> p.u1", "y.y -> p.u2, show.y", "one.y -> y.u1", "p.y -> y.u2""#,
    ));
    every_row(&run, "show.y", 1e-14, |t| 1.0 / (1.0 - 0.25 * t));
}

/// A pid around a static gain: (1 + g kp) e = r - g xi, so e decays with ki g / (1 + g kp).
#[test]
fn a_controller_with_feedthrough_around_a_static_gain_follows_its_closed_form() {
    let (g, kp, ki) = (4.0, 0.5, 3.0);
    let run = run_text(&text(
        r#""r": Constant(value: 1), "e": Sum(signs: "+-"), "pid": Pid(kp: 0.5, ki: 3), "g": Gain(k: 4), "show": Scope(inputs: ["e"])"#,
        r#""r.y -> e.u1", "e.y -> pid.e, show.e", "pid.u -> g.u", "g.y -> e.u2""#,
    ));
    every_row(&run, "show.e", 1e-6, |t| (-ki * g / (1.0 + g * kp) * t).exp() / (1.0 + g * kp));
}

/// A voltage divider whose source follows what is measured: v = u - 0.5 v_out by a sensor, v_out = v / 3; so v_out = u / 3.5.
#[test]
fn a_loop_through_a_circuit_is_solved() {
    let run = run_text(&text(
        r#""u": Ramp(slope: "1 V/s"), "v": Sum(signs: "+-"), "half": Gain(k: 0.5), "source": ControlledVoltageSource, "r1": Resistor(r: "2 ohm"),
           "r2": Resistor(r: "1 ohm"), "out": VoltageSensor, "ground": ElectricalReference, "show": Scope(inputs: ["y"])"#,
        r#""u.y -> v.u1", "half.y -> v.u2", "v.y -> source.v", "source.p <-> r1.p", "r1.n <-> r2.p <-> out.p",
           "ground.p <-> source.n <-> r2.n <-> out.n", "out.v -> half.u, show.y""#,
    ));
    every_row(&run, "show.y", 1e-10, |t| t / 3.5);
}

/// Two NOR gates that feed each other store a bit: their loop has two solutions, and goes on with the last one.
#[test]
fn truth_values_in_a_loop_are_chosen_anew_until_they_stay() {
    let blocks = r#""set": Pulse(period: "1 s", width: 0.1, delay: "0.2 s"), "reset": Pulse(period: "1 s", width: 0.1, delay: "0.7 s"),
        "s": Compare(operator: Greater, constant: 0.5), "r": Compare(operator: Greater, constant: 0.5),
        "q": Logic(operator: Nor, inputs: 2), "p": Logic(operator: Nor, inputs: 2), "show": Scope(inputs: ["q", "p"])"#;
    let connections = r#""set.y -> s.u", "reset.y -> r.u", "r.y -> q.u1", "p.y -> q.u2", "s.y -> p.u1", "q.y -> p.u2", "q.y -> show.q", "p.y -> show.p""#;
    let run = run_text(&text(blocks, connections));
    assert_eq!(run.error, None);
    for ((t, q), p) in run.time.iter().zip(run.column("show.q")).zip(run.column("show.p")) {
        let phase = t - t.floor();
        let near = [0.2, 0.7].iter().any(|edge| (phase - edge).abs() < 1e-9);
        let expected = f64::from(u8::from((0.2..0.7).contains(&phase)));
        // Before it is set for the first time either is right.
        if !near && *t > 0.2 {
            assert!(*q == expected && *p == 1.0 - expected, "at {t}: {q} {p}");
        }
    }
    // A gate that negates itself never stays.
    let (compiled, problems) = compile_text(&text(
        r#""a": Logic(operator: Nor, inputs: 2), "c": Constant(value: false), "t": Terminator"#,
        r#""c.y -> a.u1", "a.y -> a.u2, t.u""#,
    ));
    let error = run_error(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert_eq!(
        error,
        "error[algebraic_loop] at t = 0 s: the algebraic loop of `a` does not settle: its conditions change each other without end (`a.y`)"
    );
}

fn run_error(schedule: blocksim_block::schedule::Schedule) -> String {
    let error = run(schedule).error.expect("an error").to_string();
    error.lines().next().unwrap_or_default().to_owned()
}

/// A relay that its own output pushes back over its threshold switches without end; one that is pushed on stays.
#[test]
fn a_relay_on_its_own_condition_settles_or_is_told() {
    let with = |k: f64| {
        let text = text(
            &format!(
                r#""t": Ramp(slope: "1 1/s"), "e": Sum(signs: "++"), "relay": Relay(on_at: 1, off_at: 1, on: 1, off: 0), "k": Gain(k: {k}), "show": Scope(inputs: ["r"])"#
            ),
            r#""t.y -> e.u1", "e.y -> relay.u", "relay.y -> k.u, show.r", "k.y -> e.u2""#,
        );
        run_text_to_end(&text)
    };
    let helped = with(0.5);
    assert_eq!(helped.error, None);
    for (t, r) in helped.time.iter().zip(helped.column("show.r")) {
        assert!((t - 1.0).abs() < 1e-9 || *r == f64::from(u8::from(*t > 1.0)), "at {t}: {r}");
    }
    let error = with(-0.5).error.expect("an error");
    let expected = "does not settle: its conditions change each other without end (`e.y`)";
    assert!((error.t - 1.0).abs() < 1e-6 && error.message.ends_with(expected), "{error}");
}

fn run_text_to_end(text: &str) -> Run {
    let (compiled, problems) = compile_text(text);
    run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
}

/// A loop whose solution hangs on rounding has none that could be trusted: 1 - k is so small that it has no digits.
#[test]
fn a_loop_whose_solution_is_lost_in_rounding_is_refused() {
    let with = |k: f64| {
        run_text_to_end(&text(
            &format!(
                r#""u": Constant(value: 1), "e": Sum(signs: "++"), "g": Gain(k: {k:e}), "show": Scope(inputs: ["e"])"#
            ),
            r#""u.y -> e.u1", "e.y -> g.u, show.e", "g.y -> e.u2""#,
        ))
    };
    let error = with(1.0 - 1e-13).error.expect("an error");
    assert!(error.code == "algebraic_loop" && error.message.contains("no single solution"), "{error}");
    let large = with(1.0 - 1e-6);
    assert!(large.error.is_none() && (large.last("show.e") - 1e6).abs() < 1e-3, "{:?}", large.error);
    // No solution, and many: 1 - A is singular for two unknowns.
    let both = |b: f64| {
        run_text_to_end(&text(
            &format!(
                r#""b": Constant(value: [0, {b}]), "z": Gain(k: [[0.5, 0.25], [1, 0.5]], multiplication: KTimesU), "y": Sum(signs: "++"), "show": Scope(inputs: ["y"])"#
            ),
            r#""b.y -> y.u1", "y.y -> z.u, show.y", "z.y -> y.u2""#,
        ))
    };
    for b in [0.0, 1.0] {
        let error = both(b).error.expect("an error");
        assert!(error.code == "algebraic_loop" && error.message.contains("no single solution"), "{error}");
    }
}

/// y^2 - 2 y + c = 0 as y = (y^2 + c) / 2: two solutions up to c = 1, where they meet, and none behind it.
#[test]
fn solutions_that_meet_end_the_run_there() {
    let run = run_text_to_end(&text(
        r#""c": Ramp(slope: "1 1/s"), "square": Product(inputs: 2), "sum": Sum(signs: "++"), "y": Gain(k: 0.5), "show": Scope(inputs: ["y"])"#,
        r#""c.y -> sum.u1", "square.y -> sum.u2", "sum.y -> y.u", "y.y -> square.u1, square.u2, show.y""#,
    ));
    let error = run.error.clone().expect("an error");
    assert!(error.code == "algebraic_loop" && (1.0 - 1e-6..1.1).contains(&error.t), "{error}");
    assert!(error.message.contains("it was tried with `square.y` = "), "{error}");
    for (t, y) in run.time.iter().zip(run.column("show.y")).filter(|(t, _)| **t < 1.0) {
        let expected = 1.0 - (1.0 - t).sqrt();
        assert!((y - expected).abs() < 1e-9 / (1.0 - t).sqrt(), "at {t}: {y} instead of {expected}");
    }
}

#[test]
fn loops_are_refused_where_the_diagram_asks_for_it() {
    let refusing = |blocks: &str, connections: &str| {
        let text = text(blocks, connections).replace("stop_time: 2", "stop_time: 2, algebraic_loops: Refuse");
        let (compiled, problems) = compile_text(&text);
        (compiled.schedule.is_some(), problems)
    };
    let (runs, problems) = refusing(
        r#""e": Sum(signs: "+-"), "k": Gain(k: 2), "c": Constant(value: 1), "t": Terminator"#,
        r#""c.y -> e.u1", "e.y -> k.u, t.u", "k.y -> e.u2""#,
    );
    assert!(
        !runs && problems.starts_with("error[algebraic_loop]: algebraic loop: e -> k -> e"),
        "{problems}"
    );
    assert!(
        problems.contains("`algebraic_loops: Refuse` under `simulation` refuses such loops"),
        "{problems}"
    );
    // A constraint is intended, and an apparent loop is not one.
    let (runs, problems) = refusing(
        r#""z": AlgebraicConstraint, "f": Sum(signs: "+-"), "c": Constant(value: 1), "t": Terminator"#,
        r#""z.z -> f.u1, t.u", "c.y -> f.u2", "f.y -> z.f""#,
    );
    assert!(runs && problems.is_empty(), "{problems}");
    let (runs, problems) = refusing(
        r#""c": Constant(value: 1), "both": Mux(inputs: 2), "apart": Demux(sizes: [1, 1]), "t": Terminator"#,
        r#""c.y -> both.u1", "both.y -> apart.u", "apart.y1 -> both.u2", "apart.y2 -> t.u""#,
    );
    assert!(runs && problems.is_empty(), "{problems}");
}

/// x' = e with e = 1 - x - k e: the slope is -1 / (1 + k), for linear analysis, for each method, and for blocks called one by one.
#[test]
fn a_loop_around_a_state_has_the_slope_of_its_closed_form() {
    let source = text(
        r#""one": Constant(value: 1), "e": Sum(signs: "+--"), "k": Gain(k: 3), "x": Integrator, "rate": Gain(k: "1 1/s"), "show": Scope(inputs: ["x", "e"])"#,
        r#""one.y -> e.u1", "x.y -> e.u2, show.x", "k.y -> e.u3", "e.y -> k.u, rate.u, show.e", "rate.y -> x.u""#,
    );
    let schedule = Arc::new(compile_text(&source).0.schedule.expect("a schedule"));
    let mut frozen = Frozen::new(Simulation::new(Arc::clone(&schedule)).expect("a simulation"), Vec::new())
        .expect("an instant");
    let mut slope = [0.0; 2];
    frozen.evaluate(&[0.0], &[], &mut slope[..1]).expect("derivatives");
    frozen.evaluate(&[1.0], &[], &mut slope[1..]).expect("derivatives");
    assert!((slope[1] - slope[0] + 0.25).abs() < 1e-12, "{slope:?}");
    let run = run_text(&source);
    every_row(&run, "show.x", 1e-5, |t| 1.0 - (-0.25 * t).exp());
    every_row(&run, "show.e", 1e-5, |t| 0.25 * (-0.25 * t).exp());
}
