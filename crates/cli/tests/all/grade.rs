//! `blocksim grade` as a teacher calls it.

use std::fs;

use crate::desk::Desk;

/// A loop with a gain.
fn model(gain: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "2 s"),
    blocks: {{ "demand": Step(time: "0.5 s", after: "90 deg"), "error": Sum(signs: "+-"), "gain": Gain(k: "{gain}"),
               "angle": Integrator(), "scope": Scope(inputs: ["set", "actual"], display: "deg") }},
    connections: ["demand.y -> error.u1, scope.set", "angle.y -> error.u2, scope.actual", "error.y -> gain.u", "gain.y -> angle.u"],
)
"#
    )
}

fn class() -> Desk {
    let desk = Desk::with(&[("loop.ron", &model("6 1/s"))]);
    let hand_in = |name: &str, text: Option<&str>| {
        let folder = desk.0.join("students").join(name);
        fs::create_dir_all(&folder).expect("a folder");
        if let Some(text) = text {
            fs::write(folder.join("loop.ron"), text).expect("a model");
        }
    };
    hand_in("anna", Some(&model("6 1/s")));
    hand_in("bert", Some(&model("5 1/s")));
    hand_in("carl <b>", Some(&model("6 kg")));
    hand_in("dora", None);
    // A step for each microsecond of months.
    let endless =
        model("6 1/s").replace("\"2 s\"", "\"1e7 s\", solver: Ode4(step: \"1 us\"), output: Every(\"1 s\")");
    hand_in("emil", Some(&endless));
    desk
}

#[test]
fn each_project_is_run_and_compared_and_none_stops_the_others() {
    let desk = class();
    let call = ["grade", "students", "--against", "loop.ron", "--limit", "3s", "--out", "graded"];
    let answer = desk.call(&call);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    let lines: Vec<&str> = answer.out.lines().collect();
    assert!(lines[0].starts_with("anna ") && lines[0].ends_with("agrees"), "{lines:?}");
    assert!(
        lines[1].starts_with("bert ")
            && lines[1].contains("differs")
            && lines[1].contains("`scope.actual` by 6.0"),
        "{lines:?}"
    );
    assert!(lines[2].contains("fails") && lines[2].contains("kg"), "{lines:?}");
    assert!(
        lines[3].contains("missing") && lines[3].contains("there is no `students/dora/loop.ron`"),
        "{lines:?}"
    );
    assert!(lines[4].contains("too slow") && lines[4].contains("3 s"), "{lines:?}");
    assert_eq!(lines[5], "1 of 5 projects agree; the page is graded/index.html");
    let page = desk.read("graded/index.html");
    // What projects are called is text.
    assert!(page.contains("carl &lt;b&gt;") && !page.contains("carl <b>"), "{page}");
    for file in ["anna.svg", "anna.html", "bert.svg", "bert.html"] {
        assert!(desk.0.join("graded").join(file).is_file() && page.contains(file), "{file}");
    }
    // Results are not overwritten.
    let again = desk.call(&call);
    assert_eq!(again.code, Some(4));
    assert!(again.err.contains("`graded` is not empty"), "{}", again.err);
}

#[test]
fn tolerances_and_signals_decide_and_programs_can_read_it() {
    let desk = class();
    let words = ["grade", "students", "--against", "loop.ron", "--limit", "3s", "--json", "--abs", "7"];
    let answer = desk.call(&words);
    let told: Vec<serde_json::Value> =
        answer.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let verdicts: Vec<&str> = told.iter().map(|one| one["verdict"].as_str().expect("a word")).collect();
    assert_eq!(verdicts, ["agrees", "agrees", "fails", "missing", "too slow"]);
    assert_eq!(told[1]["comparison"]["signals"][1]["signal"], "scope.actual");
    let words = [
        "grade",
        "students",
        "--against",
        "loop.ron",
        "--limit",
        "3s",
        "--signals",
        "scope.set",
        "--out",
        "set",
        "--json",
    ];
    let answer = desk.call(&words);
    assert!(
        answer.out.lines().nth(1).is_some_and(|line| line.contains("\"verdict\":\"agrees\"")),
        "{}",
        answer.out
    );
}

#[test]
fn another_solver_agrees_where_signals_pass_zero_and_what_differs_there_is_named() {
    // A step response that swings about zero in its rate.
    let model = |solver: &str, damping: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "5 s", solver: {solver}, output: Every("10 ms")),
    blocks: {{ "demand": Step(time: "0.5 s"), "plant": TransferFunction(num: [36.0], den: [1.0, {damping}, 36.0]),
               "rate": Derivative(n: "100 1/s"), "scope": Scope(inputs: ["actual", "rate"]) }},
    connections: ["demand.y -> plant.u", "plant.y -> rate.u, scope.actual", "rate.y -> scope.rate"],
)
"#
        )
    };
    let desk = Desk::with(&[("loop.ron", &model("Auto(rtol: 1e-5)", "1.2"))]);
    for (name, solver, damping) in
        [("anna", "Radau5(rtol: 1e-8)", "1.2"), ("bert", "Auto(rtol: 1e-5)", "1.26")]
    {
        let folder = desk.0.join("students").join(name);
        fs::create_dir_all(&folder).expect("a folder");
        fs::write(folder.join("loop.ron"), model(solver, damping)).expect("a model");
    }
    for tolerance in [&[][..], &["--rel", "1e-2"], &["--range", "1e-3"]] {
        let out = format!("graded{}", tolerance.concat());
        let words = ["grade", "students", "--against", "loop.ron", "--out", &out];
        let answer = desk.call(&[&words, tolerance].concat());
        let lines: Vec<&str> = answer.out.lines().collect();
        assert!(lines[0].starts_with("anna ") && lines[0].ends_with("agrees"), "{tolerance:?}: {lines:?}");
        assert!(lines[1].starts_with("bert ") && lines[1].contains("differs"), "{tolerance:?}: {lines:?}");
    }
    // A share of the size alone is what `compare` has by itself, and the place that breaks it is told.
    let words = [
        "grade",
        "students",
        "--against",
        "loop.ron",
        "--out",
        "strict",
        "--rel",
        "1e-2",
        "--abs",
        "0",
        "--time-tolerance",
        "0",
        "--json",
    ];
    let answer = desk.call(&words);
    let told: serde_json::Value =
        serde_json::from_str(answer.out.lines().next().expect("a line")).expect("JSON");
    assert_eq!(told["verdict"], "differs");
    let signals = told["comparison"]["signals"].as_array().expect("signals");
    let first = &signals.iter().find(|signal| signal["agrees"] == false).expect("one that differs")["first"];
    let time = blocksim_numbers::format::significant(first["time"].as_f64().expect("a time"), 4);
    assert!(told["reason"].as_str().is_some_and(|reason| reason.contains(&format!("at {time} s"))), "{told}");
}

#[test]
fn jumps_that_come_a_little_beside_agree() {
    let model = |rtol: &str, on: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "20 min", solver: Auto(rtol: {rtol})),
    blocks: {{ "set": Constant(value: 120), "error": Sum(signs: "+-"), "relay": Relay(on_at: {on}, off_at: -3, on: 400, off: 0),
               "oven": TransferFunction(num: [1.0], den: [1500.0, 2.0]), "scope": Scope(inputs: ["heater"]) }},
    connections: ["set.y -> error.u1", "error.y -> relay.u", "relay.y -> oven.u, scope.heater", "oven.y -> error.u2"],
)
"#
        )
    };
    let desk = Desk::with(&[("loop.ron", &model("1e-4", "3"))]);
    for (name, rtol, on) in [("anna", "1e-8", "3"), ("bert", "1e-4", "4")] {
        let folder = desk.0.join("students").join(name);
        fs::create_dir_all(&folder).expect("a folder");
        fs::write(folder.join("loop.ron"), model(rtol, on)).expect("a model");
    }
    let words = ["grade", "students", "--against", "loop.ron", "--out"];
    let answer = desk.call(&[&words[..], &["graded"]].concat());
    let lines: Vec<&str> = answer.out.lines().collect();
    assert!(lines[0].ends_with("agrees") && lines[1].contains("differs"), "{lines:?} {}", answer.err);
    let answer = desk.call(&[&words[..], &["strict", "--time-tolerance", "0"]].concat());
    assert!(answer.out.lines().next().is_some_and(|line| line.contains("differs")), "{}", answer.out);
}

#[test]
fn what_cannot_be_graded_is_explained() {
    let desk = Desk::with(&[("loop.ron", &model("6 kg"))]);
    fs::create_dir_all(desk.0.join("pages/index")).expect("a folder");
    let answer = desk.call(&["grade", "pages", "--against", "loop.ron", "--out", "out"]);
    assert!(answer.err.contains("no project in `pages` can be called `index`"), "{}", answer.err);
    fs::create_dir_all(desk.0.join("students/anna")).expect("a folder");
    fs::create_dir_all(desk.0.join("nobody")).expect("a folder");
    for (folder, against, told) in [
        ("nobody", "loop.ron", "there are no projects in `nobody`"),
        ("students", "loop.ron", "the reference `loop.ron` cannot be used"),
        ("students", "none.ron", "the file does not exist"),
        ("missing", "loop.ron", "cannot read `missing`"),
    ] {
        let answer = desk.call(&["grade", folder, "--against", against, "--out", "out"]);
        assert!(answer.code.is_some_and(|code| code != 0 && code != 101), "{}", answer.err);
        assert!(answer.err.contains(told), "{told}: {}", answer.err);
        let _ = fs::remove_dir_all(desk.0.join("out"));
    }
}

#[test]
fn a_run_that_ends_before_the_reference_is_told_so() {
    let desk = Desk::with(&[("loop.ron", &model("6 1/s"))]);
    let folder = desk.0.join("students/fred");
    fs::create_dir_all(&folder).expect("a folder");
    let early = model("6 1/s").replace("\"2 s\"", "\"0.75 s\"");
    fs::write(folder.join("loop.ron"), early).expect("a model");
    let answer =
        desk.call(&["grade", "students", "--against", "loop.ron", "--limit", "9s", "--out", "graded"]);
    let reason = "is the same, but only there from 0 s to 0.7500 s, and 1 signal more";
    assert!(answer.code == Some(1) && answer.out.contains(reason), "{}{}", answer.out, answer.err);
}

#[test]
fn tolerances_are_those_of_compare() {
    let desk = Desk::with(&[("loop.ron", &model("6 1/s"))]);
    fs::create_dir_all(desk.0.join("students/bert")).expect("a folder");
    fs::write(desk.0.join("students/bert/loop.ron"), model("5 1/s")).expect("a model");
    // 90 deg (exp(-5 t) - exp(-6 t)) is 6.03 deg at most, or 0.105 rad.
    for (n, (tolerances, verdict)) in [
        (&["--abs", "6.2deg"][..], "agrees"),
        (&["--abs", "5.9deg"], "differs"),
        (&["--abs", "0.11"], "agrees"),
        (&["--abs", "0.1"], "differs"),
        (&["--abs", "2 m", "--abs", "6.2 deg"], "agrees"),
        (&["--abs", "2 m"], "differs"),
    ]
    .into_iter()
    .enumerate()
    {
        let out = format!("graded{n}");
        let call = [&["grade", "students", "--against", "loop.ron", "--out", &out], tolerances].concat();
        let answer = desk.call(&call);
        assert!(
            answer.out.lines().next().is_some_and(|line| line.contains(verdict)),
            "{tolerances:?}: {answer:?}"
        );
    }
    let wrong = desk.call(&["grade", "students", "--against", "loop.ron", "--abs", "-1 deg"]);
    assert!(wrong.code == Some(2) && wrong.err.contains("below zero"), "{wrong:?}");
}

/// What a folder is called does nothing to the terminal of the teacher.
#[cfg(unix)]
#[test]
fn names_of_folders_are_shown_and_not_obeyed() {
    let desk = Desk::with(&[("loop.ron", &model("6 1/s"))]);
    fs::create_dir_all(desk.0.join("students/red\u{1b}[31m")).expect("a folder");
    let answer = desk.call(&["grade", "students", "--against", "loop.ron", "--out", "graded"]);
    assert!(answer.out.starts_with("red\\u{1b}[31m "), "{}", answer.out);
    assert!(!answer.out.contains('\u{1b}'), "{}", answer.out);
}
