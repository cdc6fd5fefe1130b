//! Bare numbers are of any unit: a diagram without units runs as in a textbook, and two units that are said still differ.

use blocksim_tests::{compile_text, run_text};

/// Blocks and connections as a diagram of a second.
fn diagram(blocks: &str, connections: &str) -> String {
    format!("Diagram(simulation: (stop_time: 1), blocks: {{ {blocks} }}, connections: [ {connections} ])")
}

/// The unit of a recorded signal, `?` if it has none that is known; all problems instead if there are any.
fn unit(blocks: &str, connections: &str, signal: &str) -> String {
    let (compiled, problems) = compile_text(&diagram(blocks, connections));
    let Some(schedule) = compiled.schedule else { return problems };
    let recorded = schedule.recorded.iter().find(|recorded| recorded.path.starts_with(signal));
    let dimension = recorded.unwrap_or_else(|| panic!("{signal}:\n{problems}")).dimension;
    dimension.map_or("?".to_owned(), |dimension| dimension.to_string())
}

#[test]
fn equations_without_units_run() {
    // x' = 1 - x.
    let run = run_text(&diagram(
        r#""one": Constant(value: 1), "x": Integrator, "sum": Sum(signs: "+-"), "s": Scope(inputs: ["x"])"#,
        r#""one.y -> sum.u1", "x.y -> sum.u2, s.x", "sum.y -> x.u""#,
    ));
    assert!((run.last("s.x") - (1.0 - f64::exp(-1.0))).abs() < 1e-6, "{}", run.last("s.x"));
    // x'' = -9 x from x = 1, and its square root of the sum of squares, which is 1 for ever.
    let run = run_text(&diagram(
        r#""v": Integrator, "x": Integrator(x0: 1), "k": Gain(k: -9), "third": Gain(k: "1 / 3"), "vv": Function(function: Square),
           "xx": Function(function: Square), "sum": Sum(signs: "++"), "root": Function(function: Sqrt), "s": Scope(inputs: ["x", "r"])"#,
        r#""v.y -> x.u, third.u", "x.y -> k.u, xx.u, s.x", "k.y -> v.u", "third.y -> vv.u", "vv.y -> sum.u1", "xx.y -> sum.u2",
           "sum.y -> root.u", "root.y -> s.r""#,
    ));
    assert!((run.last("s.x") - f64::cos(3.0)).abs() < 1e-5, "{}", run.last("s.x"));
    assert!((run.last("s.r") - 1.0).abs() < 1e-5, "{}", run.last("s.r"));
}

#[test]
fn what_is_said_passes_through_bare_numbers() {
    for (blocks, connections, found) in [
        (r#""a": Constant(value: "2 V"), "b": Gain(k: 8.0)"#, r#""a.y -> b.u", "b.y -> s.y""#, "V"),
        (r#""a": Constant(value: 2), "b": Gain(k: "8 V")"#, r#""a.y -> b.u", "b.y -> s.y""#, "V"),
        // The sum of a bare number and a voltage is a voltage, whichever comes first.
        (
            r#""a": Constant(value: 2), "c": Constant(value: "1 V"), "b": Sum(signs: "++")"#,
            r#""a.y -> b.u1", "c.y -> b.u2", "b.y -> s.y""#,
            "V",
        ),
        (
            r#""a": Constant(value: 2), "c": Constant(value: "1 V"), "b": Mux(inputs: 2)"#,
            r#""a.y -> b.u1", "c.y -> b.u2", "b.y -> s.y""#,
            "V",
        ),
        (r#""a": Step(after: 2), "b": Integrator(x0: "1 m")"#, r#""a.y -> b.u", "b.y -> s.y""#, "m"),
        // A loop of bare numbers has no unit at all, rather than a wrong one.
        (
            r#""a": Constant(value: 1), "b": Integrator, "c": Sum(signs: "+-")"#,
            r#""a.y -> c.u1", "b.y -> c.u2, s.y", "c.y -> b.u""#,
            "?",
        ),
        (
            r#""a": Pulse(amplitude: 3, period: 1, width: 0.5), "b": Gain(k: "1 A/V")"#,
            r#""a.y -> b.u", "b.y -> s.y""#,
            "S",
        ),
    ] {
        let blocks = format!("{blocks}, \"s\": Scope(inputs: [\"y\"])");
        assert_eq!(unit(&blocks, connections, "s.y"), found, "{blocks}");
    }
}

#[test]
fn a_bare_number_fits_whatever_it_meets_and_two_units_that_are_said_differ() {
    let circuit = |value: &str| {
        compile_text(&diagram(
            &format!(
                r#""a": Constant(value: {value}), "u": ControlledVoltageSource, "r": Resistor(r: 5), "g": ElectricalReference"#
            ),
            r#""a.y -> u.v", "u.p <-> r.p", "r.n <-> u.n <-> g.p""#,
        ))
        .1
    };
    assert!(!circuit("3").contains("error"), "{}", circuit("3"));
    let refused = circuit("\"3 A\"");
    assert!(refused.contains("`u.v` is in V, but `a.y` is in A"), "{refused}");
    assert!(refused.contains("Gain(k: \"1 Ohm\")"), "{refused}");
    let (_, refused) = compile_text(&diagram(
        r#""a": Constant(value: "1 V"), "b": Constant(value: "1 A"), "c": Sum(signs: "++")"#,
        r#""a.y -> c.u1", "b.y -> c.u2""#,
    ));
    assert!(
        refused.contains("`u2` is in A, but `u1` is in V") && refused.contains("Gain(k: \"1 Ohm\")"),
        "{refused}"
    );
}
