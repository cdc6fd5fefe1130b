//! Input that cannot be simulated, from the command line: what is wrong stands there with block, time, reason and remedy, the exit
//! code says whose mistake it is, and what was computed until then is kept.

use expect_test::{Expect, expect};

use crate::desk::Desk;

/// A run that ends before its stop time, or never begins.
struct Bad<'a> {
    model: &'a str,
    files: &'a [(&'a str, &'a str)],
    options: &'a [&'a str],
    code: i32,
}

impl<'a> Bad<'a> {
    /// Refused by the compiler unless said otherwise.
    const fn new(model: &'a str) -> Self {
        Self { model, files: &[], options: &[], code: 3 }
    }

    /// What is said must be as expected; returns the times of the rows that were kept, in the text and in the recording.
    fn run(&self, expected: &Expect) -> Vec<f64> {
        let desk = Desk::with(&[&[("model.ron", self.model)], self.files].concat());
        let answer = desk.call(&[&["run", "model.ron", "--quiet", "--out", "kept"], self.options].concat());
        expected.assert_eq(&answer.err);
        assert_eq!(answer.code, Some(self.code), "{}", answer.text());
        if !desk.0.join("kept").exists() {
            return Vec::new();
        }
        assert!(desk.read("kept/manifest.json").contains("\"how\": \"failed\""));
        // A reason is told once to people and kept once for programs and logs.
        let code = answer.err.split(['[', ']']).nth(1).expect("a code");
        assert_eq!(answer.err.matches("error[").count(), 1, "{}", answer.err);
        assert!(desk.read("kept/log.txt").contains("failed"), "{code}: {}", desk.read("kept/log.txt"));
        let rows = |text: String| -> Vec<f64> {
            text.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect()
        };
        let times = rows(desk.read("kept/signals.csv"));
        let export = desk.call(&["export", "kept", "--csv", "again.csv"]);
        assert_eq!(export.code, Some(0), "{}", export.text());
        assert_eq!(rows(desk.read("again.csv")), times, "the recording has the rows of the text");
        times
    }
}

/// x' = -x with these settings and blocks beside.
fn decay(settings: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "1 s"{settings}),
    blocks: {{
        "x": Integrator(x0: 1),
        "minus": Gain(k: -1),
        "show": Scope,
    }},
    connections: ["x.y -> minus.u, show.u", "minus.y -> x.u"],
)
"#
    )
}

#[test]
fn a_mass_matrix_that_leaves_a_state_without_an_equation() {
    // The second row says 0 = 1 + 0 x1.
    let model = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "x": MassMatrixIntegrator(m: [[1, 0], [0, 0]], x0: [1, 0]),
        "parts": Demux(sizes: [1, 1]),
        "minus": Gain(k: -1),
        "one": Constant(value: 1),
        "f": Mux(inputs: 2),
        "show": Scope(inputs: ["a", "b"]),
    },
    connections: [
        "x.y -> parts.u",
        "parts.y1 -> minus.u, show.a",
        "parts.y2 -> show.b",
        "minus.y -> f.u1",
        "one.y -> f.u2",
        "f.y -> x.u",
    ],
)
"#;
    let rows = Bad { code: 1, ..Bad::new(model) }.run(&expect![[r#"
        error[algebraic_loop]: the constraint of `x` determines no single value: what must become zero does not change with it (nearest found: z = 0.0000e0 with f = -1.0e0) at t = 0 s
         --> model.ron:4:9
          |
        4 |         "x": MassMatrixIntegrator(m: [[1, 0], [0, 0]], x0: [1, 0]),
          |         ^^^ this is `x`
          |
          = help: begin nearer to the solution with `z0` or `x0`; a constraint may also lose its solution, as where a
                  curve turns back, or never have had one

    "#]]);
    assert_eq!(rows.len(), 0, "it ends where it would begin");
    // Whether a pivot is zero is not to be told.
    let model = model.replace("[[1, 0], [0, 0]]", "[[1, 1], [1, 1.000000000001]]");
    Bad::new(&model).run(&expect![[r#"
        error[parameter]: `m` is neither regular nor singular by a clear margin: with rows and columns scaled to like sizes, a pivot is 5.0e-13 of the largest
         --> model.ron:4:38
          |
        4 |         "x": MassMatrixIntegrator(m: [[1, 1], [1, 1.000000000001]], x0: [1, 0]),
          |                                      ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
          |
          = note: in block `x` (MassMatrixIntegrator)
          = help: write dependent rows with all their digits, or make the small difference larger

        1 error; nothing was run
    "#]]);
}

#[test]
fn a_start_that_contradicts_itself_and_one_that_has_no_rest() {
    let model = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "a": Inertia(j: 1, w0: "10 rad/s"),
        "gear": SimpleGear(ratio: 2),
        "b": Inertia(j: 1, w0: "3 rad/s"),
    },
    connections: ["a.r <-> gear.base", "gear.follower <-> b.r"],
)
"#;
    Bad::new(model).run(&expect![[r#"
        error[start_conflict]: the speed of 3 rad/s at the start does not fit the parts it is coupled to
         --> model.ron:6:9
          |
        4 |         "a": Inertia(j: 1, w0: "10 rad/s"),
          |         --- `a` has a speed at the start, too
        5 |         "gear": SimpleGear(ratio: 2),
        6 |         "b": Inertia(j: 1, w0: "3 rad/s"),
          |         ^^^ `b` asks for it
          |
          = help: give one part of a rigidly coupled train its start speed, or start values that fit the ratios

        1 error; nothing was run
    "#]]);
    let model = r#"Diagram(
    simulation: (stop_time: "1 s", start: Steady),
    blocks: {
        "flow": Constant(value: 2),
        "tank": Integrator,
        "show": Scope,
    },
    connections: ["flow.y -> tank.u", "tank.y -> show.u"],
)
"#;
    Bad { code: 1, ..Bad::new(model) }.run(&expect![[r#"
        error[no_steady_state]: no steady state was found; what keeps moving: `tank.x` by 2 a second at t = 0 s
         --> model.ron:5:9
          |
        5 |         "tank": Integrator,
          |         ^^^^^^ this is `tank`
          |
          = help: integrators that nothing feeds back and sources that go on have no rest: begin elsewhere (initial
                  values, another instant), or list the states that may go on moving, `start: Steady(drift: [...])`

        nothing was run
    "#]]);
}

#[test]
fn tolerances_that_no_result_can_have() {
    for rtol in ["0.5", "1e-15", "0", "NaN"] {
        let model = decay(&format!(", solver: Ode45(rtol: {rtol})"));
        if rtol == "0.5" {
            Bad::new(&model).run(&expect![[r#"
                error[parameter]: `rtol` is 5e-1, but must be between 1e-14 and 1e-1
                 --> model.ron:2:44
                  |
                2 |     simulation: (stop_time: "1 s", solver: Ode45(rtol: 0.5)),
                  |                                            ^^^^^^^^^^^^^^^^
                  |
                  = help: 1e-3 is enough for a picture, 1e-6 is the default, 1e-9 is for references

                1 error; nothing was run
            "#]]);
        } else {
            let desk = Desk::with(&[("model.ron", &model)]);
            let answer = desk.call(&["run", "model.ron"]);
            assert_eq!(answer.code, Some(3), "{rtol}");
            assert!(answer.err.contains("but must be between 1e-14 and 1e-1"), "{}", answer.err);
        }
    }
    Bad { options: &["--rtol", "0.5"], code: 2, ..Bad::new(&decay("")) }.run(&expect![[r#"
        error[usage]: --rtol is 5e-1, but must be between 1e-14 and 1e-1
          = help: 1e-3 is enough for a picture, 1e-6 is the default, 1e-9 is for references
    "#]]);
    Bad { options: &["--atol", "-1e-6"], code: 2, ..Bad::new(&decay("")) }.run(&expect![[r#"
        error: invalid value '-1e-6' for '--atol <X>': a number above zero, such as 1e-6

        For more information, try '--help'.
    "#]]);
    let set = decay(r#", solver: Ode45(rtol: "tol")"#)
        .replace("    simulation", "    parameters: { \"tol\": 1e-6 },\n    simulation");
    Bad { options: &["--set", "tol=1e-15"], ..Bad::new(&set) }.run(&expect![[r#"
        error[parameter]: `rtol` is 1e-15, but must be between 1e-14 and 1e-1
         --> model.ron:3:44
          |
        3 |     simulation: (stop_time: "1 s", solver: Ode45(rtol: "tol")),
          |                                            ^^^^^^^^^^^^^^^^^^
          |
          = help: 1e-3 is enough for a picture, 1e-6 is the default, 1e-9 is for references

        1 error; nothing was run
    "#]]);
    Bad { options: &["--set", "simulation.solver.rtol=0.5"], ..Bad::new(&decay("")) }.run(&expect![[r#"
        error[unknown_override]: there is no `simulation.solver.rtol` to set
         --> command line:1:1
          |
        1 | simulation.solver.rtol=0.5
          | ^^^^^^^^^^^^^^^^^^^^^^^^^^
          |
          = help: the settings in `simulation` are changed by --until, --solver, --rtol, --atol and --step, or by a
                  parameter of the diagram that stands in it

        1 error; nothing was run
    "#]]);
    Bad::new(&decay(r#", atol: {"x": 0}"#)).run(&expect![[r#"
        error[parameter]: `atol` of `x` is 0, but must be positive
         --> model.ron:2:42
          |
        2 |     simulation: (stop_time: "1 s", atol: {"x": 0}),
          |                                          ^^^^^^^^
          |
          = help: it is an error that does not matter, in the unit of the state; without it each state has its own,
                  which follows its size

        1 error; nothing was run
    "#]]);
}

#[test]
fn times_that_cannot_be_counted() {
    Bad { options: &["--step", "1e-20 s"], code: 1, ..Bad::new(&decay("")) }.run(&expect![[r#"
        error[settings]: the maximum step, 1e-20 s, is shorter than the resolution of time at 1 s
          = help: times have sixteen digits: take at least 8.9e-16 s, or an earlier stop time
        nothing was run
    "#]]);
    Bad::new(&decay(r#", solver: Ode4(step: "1e-20 s")"#)).run(&expect![[r#"
        error[parameter]: the step of 1e-20 s is shorter than the resolution of time at 1 s
         --> model.ron:2:44
          |
        2 |     simulation: (stop_time: "1 s", solver: Ode4(step: "1e-20 s")),
          |                                            ^^^^^^^^^^^^^^^^^^^^^
          |
          = help: times have sixteen digits: write at least 8.9e-16 s

        1 error; nothing was run
    "#]]);
    Bad { options: &["--until", "1e300"], code: 1, ..Bad::new(&decay("")) }.run(&expect![[r#"
        error[settings]: the stop time of 1e300 s is beyond the clock
          = help: times have sixteen digits, which end before 1e15 s; choose an earlier stop time
        nothing was run
    "#]]);
    Bad::new(&decay("").replace("1 s", "1e300 s")).run(&expect![[r#"
        error[parameter]: the stop time of 1e300 s is beyond the clock
         --> model.ron:2:29
          |
        2 |     simulation: (stop_time: "1e300 s"),
          |                             ^^^^^^^^^
          |
          = help: times have sixteen digits, which end before 1e15 s

        1 error; nothing was run
    "#]]);
    Bad { options: &["--until", "-1 s"], code: 2, ..Bad::new(&decay("")) }.run(&expect![[r#"
        error: invalid value '-1 s' for '--until <TIME>': a time here is above zero

        For more information, try '--help'.
    "#]]);
}

#[test]
fn a_condition_that_chatters_by_design() {
    let model = r#"Diagram(
    simulation: (stop_time: "2 s", output: Every("0.1 s")),
    blocks: {
        "down": Constant(value: -1),
        "up": Constant(value: 1),
        "x": Integrator(x0: "1 s"),
        "switch": Switch(threshold: "0 s"),
        "show": Scope,
    },
    connections: [
        "x.y -> switch.control, show.u",
        "down.y -> switch.u1",
        "up.y -> switch.u3",
        "switch.y -> x.u",
    ],
)
"#;
    let methods = ["ode45", "ode23", "dop853", "ode15s", "radau5", "rodas4", "ode23tb", "ode23t", "rosw3"];
    let rows = Bad { code: 1, ..Bad::new(model) }.run(&expect![[r#"
        error[chatter]: `switch` is chattering: it passes `u1` and passes `u3` again and again at t = 1 s
         --> model.ron:7:9
          |
        7 |         "switch": Switch(threshold: "0 s"),
          |         ^^^^^^^^ this is `switch`
          |
          = help: give the switching a hysteresis, or use a method of fixed step

    "#]]);
    let is_kept = |rows: &[f64]| {
        let has = |k: i32| rows.iter().any(|t| (t - 0.1 * f64::from(k)).abs() < 1e-9);
        (0..=9).all(has) && (rows.last().unwrap() - 1.0).abs() < 1e-6
    };
    assert!(is_kept(&rows), "{rows:?}");
    for solver in methods {
        let desk = Desk::with(&[("model.ron", model)]);
        let answer = desk.call(&["run", "model.ron", "--quiet", "--out", "kept", "--solver", solver]);
        assert_eq!(answer.code, Some(1), "{solver}");
        assert!(
            answer
                .err
                .starts_with("error[chatter]: `switch` is chattering: it passes `u1` and passes `u3` again"),
            "{solver}"
        );
        let rows = desk.read("kept/signals.csv");
        let times = rows.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap());
        assert!(is_kept(&times.collect::<Vec<_>>()), "{solver}: {rows}");
    }
}

#[test]
fn a_delay_shorter_than_a_fixed_step_would_have_to_be_solved_for() {
    let model = r#"Diagram(
    simulation: (stop_time: "1 s", solver: Ode4(step: "10 ms")),
    blocks: {
        "x": Integrator(x0: 1),
        "late": TransportDelay(delay: "3 ms"),
        "minus": Gain(k: -1),
        "show": Scope,
    },
    connections: ["x.y -> late.u, show.u", "late.y -> minus.u", "minus.y -> x.u"],
)
"#;
    Bad { code: 1, ..Bad::new(model) }.run(&expect![[r#"
        error[settings]: the fixed step of 0.01 s is longer than the delay of `late`, 0.003 s: what comes out within a step would depend on its own end, an equation that methods of fixed step do not solve
         --> model.ron:5:9
          |
        5 |         "late": TransportDelay(delay: "3 ms"),
          |         ^^^^^^ this is `late`
          |
          = help: take a step of at most 0.003 s, a method that chooses its steps such as Auto, or a delay of a whole
                  number of steps

        nothing was run
    "#]]);
    // Each remedy is one.
    let desk = Desk::with(&[("model.ron", model), ("longer.ron", &model.replace("3 ms", "10 ms"))]);
    for remedy in
        [["model.ron", "--solver", "auto"], ["model.ron", "--step", "3ms"], ["longer.ron", "--step", "5ms"]]
    {
        assert_eq!(desk.call(&[&["run", "--quiet"], &remedy[..]].concat()).code, Some(0), "{remedy:?}");
    }
}

#[test]
fn a_transfer_function_that_would_know_the_future() {
    Bad::new(
        r#"Diagram(
    blocks: { "step": Step, "g": TransferFunction(num: [1, 0, 0], den: [1, 1]), "show": Scope },
    connections: ["step.y -> g.u", "g.y -> show.u"],
)
"#,
    )
    .run(&expect![[r#"
        error[parameter]: `num` has degree 2 in s, but `den` only 1: such a block would have to know the future
         --> model.ron:2:56
          |
        2 |     blocks: { "step": Step, "g": TransferFunction(num: [1, 0, 0], den: [1, 1]), "show": Scope },
          |                                                        ^^^^^^^^^       ------ `den`
          |
          = note: in block `g` (TransferFunction)
          = help: give `den` at least as many coefficients as `num`

        1 error; nothing was run
    "#]]);
}

#[test]
fn a_source_that_gives_what_is_no_number() {
    let constant = r#"Diagram(
    simulation: (stop_time: "2 s"),
    blocks: {
        "source": Constant(value: NaN),
        "x": Integrator,
        "show": Scope,
    },
    connections: ["source.y -> x.u", "x.y -> show.u"],
)
"#;
    Bad::new(constant).run(&expect![[r#"
        error[parameter]: `value` is NaN, but must be finite
         --> model.ron:4:35
          |
        4 |         "source": Constant(value: NaN),
          |                                   ^^^
          |
          = note: in block `source` (Constant)

        1 error; nothing was run
    "#]]);
    let table = constant.replace("Constant(value: NaN)", r#"FromFile(file: "course.csv")"#);
    let course = [("course.csv", "time [s],a\n0,1\n1,NaN\n2,3\n")];
    Bad { files: &course, ..Bad::new(&table) }.run(&expect![[r#"
        error[table]: `course.csv`: line 3, column 2 (`a`): `NaN` is not finite
         --> model.ron:4:34
          |
        4 |         "source": FromFile(file: "course.csv"),
          |                                  ^^^^^^^^^^^^
          |
          = help: write a number, or leave out the line: values between two lines are found on a straight line

        1 error; nothing was run
    "#]]);
    // Between two numbers that are right none may be: the difference is too large for one.
    let course = [("course.csv", "time [s],a\n0,1\n1,1e308\n2,-1e308\n")];
    let rows = Bad { files: &course, code: 1, ..Bad::new(&table) }.run(&expect![[r#"
        error[not_finite]: `source.y` is NaN at t = 1 s
         --> model.ron:4:9
          |
        4 |         "source": FromFile(file: "course.csv"),
          |         ^^^^^^^^ this is `source`
          |
          = help: its parameters lead beyond the largest number, 1.8e308: give smaller ones, or other units

    "#]]);
    assert!(rows.len() > 20 && *rows.last().unwrap() == 1.0, "{rows:?}");
    let fixed = &["--solver", "ode4", "--step", "10ms"];
    let rows = Bad { files: &course, options: fixed, code: 1, ..Bad::new(&table) }.run(&expect![[r#"
        error[not_finite]: `source.y` is NaN at t = 1 s
         --> model.ron:4:9
          |
        4 |         "source": FromFile(file: "course.csv"),
          |         ^^^^^^^^ this is `source`
          |
          = help: its parameters lead beyond the largest number, 1.8e308: give smaller ones, or other units

    "#]]);
    assert_eq!(rows.len(), 101, "{rows:?}");
}

/// x' = x^2 goes to infinity within a second: no step is short enough, and the help names methods only where another one might do.
#[test]
fn a_step_below_all_resolution() {
    let model = decay("").replace("Gain(k: -1)", "Function(function: Square)").replace("1 s", "2 s");
    for solver in ["auto", "ode45", "radau5"] {
        let desk = Desk::with(&[("model.ron", &model)]);
        let answer = desk.call(&["run", "model.ron", "--quiet", "--solver", solver, "--out", "kept"]);
        assert_eq!(answer.code, Some(1));
        let said: Vec<&str> = answer.err.split_whitespace().collect();
        let said = said.join(" ");
        for part in [
            "error[step_size]: even a step of ",
            "too long for the state `x.x`",
            "model.ron:4:9",
            "a pole of the law may be the cause",
        ] {
            assert!(said.contains(part), "{solver}: {said}");
        }
        let others = "or a stiff law, for which there are `Ode15s`, `Radau5`, `Rodas4`, `Ode23tb`, `Ode23t`";
        assert_eq!(said.contains(others), solver == "ode45", "{solver}: {said}");
        let rows = desk.read("kept/signals.csv");
        let last = rows.lines().last().unwrap().split(',').next().unwrap().parse::<f64>().unwrap();
        assert!(rows.lines().count() > 100 && (last - 1.0).abs() < 1e-3, "{solver}: {last}");
    }
}
