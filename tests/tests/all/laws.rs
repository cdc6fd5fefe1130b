//! Laws written as text, against closed forms and against the same diagram drawn with blocks.

use std::f64::consts::PI;

use blocksim_tests::{Run, compile_text, run_audited};

/// Runs a diagram with an audit: nothing that is watched is passed over, and nothing depends on more than blocks say.
fn audited(text: &str) -> Run {
    let (compiled, problems) = compile_text(text);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let (run, findings) = run_audited(schedule);
    let findings = findings.expect("an audit");
    assert!(run.error.is_none(), "{:?}", run.error);
    assert!(findings.count == 0 && findings.undeclared.is_empty(), "{findings:?}");
    run
}

/// The integral of a law of time `t` (a number) from 0 to `end`.
fn integral(law: &str, end: f64, solver: &str) -> f64 {
    let text = format!(
        r#"Diagram(
            simulation: (stop_time: "{end} s", solver: {solver}),
            record: ["sum.y"],
            blocks: {{
                "one": Constant(value: 1),
                "time": Integrator,
                "law": Expression(law: "{law}"),
                "sum": Integrator,
            }},
            connections: ["one.y -> time.u", "time.y -> law.t", "law.y -> sum.u"],
        )"#
    );
    audited(&text).last("sum.y")
}

#[test]
fn integrals_over_jumps_and_kinks_are_those_of_closed_forms() {
    let cases = [
        ("floor(3*t)", 2.0, 5.0),
        ("ceil(3*t)", 2.0, 7.0),
        ("round(3*t)", 2.0, 6.0),
        ("mod(3*t, 1)", 2.0, 1.0),
        ("mod(-3*t, 2)", 2.0, 2.0),
        ("sign(t - 0.7)", 2.0, 0.6),
        ("abs(t - 0.7)", 2.0, (0.49 + 1.69) / 2.0),
        ("max(t - 0.7, 0)", 2.0, 1.69 / 2.0),
        ("min(t, 0.7, 1)", 2.0, 0.245 + 0.91),
        ("if(t > 0.7, 2, -1)", 2.0, 1.9),
        ("if(and(t > 0.5, not(t >= 1.25)), 1, 0)", 2.0, 0.75),
        ("if(or(t < 0.5, t > 1.25), t, 0)", 2.0, 0.125 + (4.0 - 1.5625) / 2.0),
        // The angle of a point that turns one and a half times: whole turns cancel out.
        ("atan2(sin(t), cos(t))", 3.0 * PI, PI * PI / 2.0),
        // A branch beyond its end has no value, and the run goes on all the same.
        ("if(t < 1, sqrt(1 - t), t - 1)", 2.0, 2.0 / 3.0 + 0.5),
        ("if(t < 1, ln(2 - t), 0)", 1.9, 2.0 * 2.0_f64.ln() - 1.0),
        ("t^3 - 2*(t + 1)^-1*(t + 1)^2 + 4^t", 2.0, 4.0 - 8.0 + 15.0 / 4.0_f64.ln()),
    ];
    for solver in ["Ode45(rtol: 1e-9)", "Auto(rtol: 1e-9)", "Radau5(rtol: 1e-9)"] {
        for (law, end, exact) in cases {
            let found = integral(law, end, solver);
            assert!((found - exact).abs() < 2e-8, "{solver}, {law}: {found} for {exact}");
        }
    }
}

/// The same law as one text and as blocks: equal at every row, bit by bit.
#[test]
fn a_law_as_text_is_that_of_the_blocks() {
    let run = audited(
        r#"Diagram(
            simulation: (stop_time: "3 s", solver: Auto(rtol: 1e-8)),
            record: ["law.y", "all.y", "sum.y", "drawn.y", "over.y", "compare.y"],
            blocks: {
                "u": Sine(amplitude: "2 V", frequency: "0.7 Hz"),
                "v": Sine(amplitude: "1 V", frequency: "1.1 Hz", phase: "40 deg", bias: "0.2 V"),
                "law": Expression(law: "max(abs(u) - k*v, v) * sign(u) + v^2/(1 V)", parameters: { "k": 0.8 }),
                "over": Expression(law: "u > k*v", parameters: { "k": 0.8 }),
                "abs": Abs,
                "gain": Gain(k: 0.8),
                "less": Sum(signs: "+-"),
                "max": MinMax(function: Max),
                "sign": Sign,
                "times": Product,
                "square": Function(function: Square),
                "one": Constant(value: "1 V"),
                "ratio": Divide,
                "all": Sum(signs: "++"),
                "compare": Compare(operator: Greater),
                "sum": Integrator,
                "drawn": Integrator,
            },
            connections: [
                "u.y -> law.u, over.u, abs.u, sign.u, compare.u1",
                "v.y -> law.v, over.v, gain.u, max.u2, square.u",
                "abs.y -> less.u1", "gain.y -> less.u2, compare.u2", "less.y -> max.u1",
                "max.y -> times.u1", "sign.y -> times.u2",
                "square.y -> ratio.u1", "one.y -> ratio.u2",
                "times.y -> all.u1", "ratio.y -> all.u2",
                "law.y -> sum.u", "all.y -> drawn.u",
            ],
        )"#,
    );
    assert!(run.time.len() > 100);
    for (text, drawn) in [("law.y", "all.y"), ("sum.y", "drawn.y"), ("over.y", "compare.y")] {
        assert_eq!(run.column(text), run.column(drawn), "{text}");
    }
    let says = |what: &str| run.events.iter().filter(|(_, block, _)| block == what).count();
    assert!(says("law") >= 4 && says("over") >= 4, "{:?}", run.events);
    assert_eq!(says("over"), says("compare"));
}

/// A mass that is pushed towards the middle by a force of constant size.
#[test]
fn a_law_closes_a_loop_with_states() {
    // x'' = -sign(x): every quarter takes sqrt(2 x0); the period is 4 sqrt(2 x0).
    let run = audited(
        r#"Diagram(
            simulation: (stop_time: "5.65685424949238 s", solver: Ode45(rtol: 1e-9)),
            record: ["x.y", "v.y"],
            blocks: {
                "law": Expression(law: "-sign(x)"),
                "v": Integrator,
                "x": Integrator(x0: 1.0),
            },
            connections: ["law.y -> v.u", "v.y -> x.u", "x.y -> law.x"],
        )"#,
    );
    assert!((run.last("x.y") - 1.0).abs() < 1e-8 && run.last("v.y").abs() < 1e-7, "{}", run.last("x.y"));
    assert_eq!(run.events.iter().filter(|(_, block, _)| block == "law").count(), 2);
}

#[test]
fn a_mistake_in_a_law_is_shown_at_its_place() {
    let problems = |law: &str| {
        compile_text(&format!(
            r#"Diagram(
    simulation: (stop_time: "1 s"),
    record: ["law.y"],
    blocks: {{ "u": Constant(value: "1 V"), "law": Expression(law: "{law}") }},
    connections: ["u.y -> law.u"],
)"#
        ))
        .1
    };
    let text = problems("2 + sinn(u)");
    assert!(text.contains("unknown function `sinn`") && text.contains("`sinn`"), "{text}");
    assert!(text.contains("4:72 `sinn`"), "{text}");
    assert!(problems("u + 1").contains("cannot add V and 1 in `u + 1`"));
    assert!(problems("u * k").contains("`k`"), "an input that nothing drives");
    assert_eq!(problems("abs(u)"), "");
}
