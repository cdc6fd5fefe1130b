//! The same bits as the engine.

use blocksim_codegen::{Method, Part, Target, generate};

use crate::support::{Loop, every, run, text_of, told};

/// Exports the subsystem, compiles it and expects that it agrees in all steps.
fn agrees(main: &str, control: &str, target: &Target) {
    let made =
        Loop::new(main, control).export(target).unwrap_or_else(|problems| panic!("{}", told(&problems)));
    assert!(made.test_steps >= 2000, "{} steps", made.test_steps);
    assert_eq!(run(&made), format!("{} steps as in the simulation\n", made.test_steps));
}

const PLANT: &str = r#"
        "plant": TransferFunction(num: [1.0], den: [0.02, 0.3, 1.0], k: "1"),
"#;

/// A loop around `control.ron`, whose inputs are `set` and `actual` and whose output is `u`.
fn around() -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "5 s"),
    blocks: {{
        "set": Pulse(period: "1.3 s", width: 0.4, amplitude: 2.0),
        "control": Subsystem(file: "control.ron"),
        {PLANT}
        "show": Scope(inputs: ["set", "actual"]),
    }},
    connections: [
        "set.y -> control.set, show.set", "plant.y -> control.actual, show.actual", "control.u -> plant.u",
    ],
)"#
    )
}

const PID: &str = r#"Diagram(
    inputs: { "set": (), "actual": () },
    outputs: { "u": "pid.u" },
    blocks: {
        "error": Sum(signs: "+-"),
        "pid": DiscretePid(ts: "1 ms", kp: 8.0, ki: 20.0, kd: 0.4, lower: -1.0, upper: 1.5, anti_windup: Clamping),
    },
    connections: ["in.set -> error.u1", "in.actual -> error.u2", "error.y -> pid.e"],
)"#;

#[test]
fn a_discrete_pid_loop_with_limits() {
    agrees(&around(), PID, &every(1e-3));
}

#[test]
fn a_controller_of_several_rates() {
    let control = r#"Diagram(
    inputs: { "set": (), "actual": () },
    outputs: { "u": "inner.u", "slow": "outer.u" },
    blocks: {
        "hold": ZeroOrderHold(ts: "10 ms"),
        "slow_error": Sum(signs: "+-"),
        "outer": DiscretePid(ts: "10 ms", kp: 2.0, ki: 5.0, lower: -3.0, upper: 3.0),
        "fast": ZeroOrderHold(ts: "1 ms"),
        "filter": DiscreteTransferFunction(ts: "2 ms", num: [0.2], den: [1.0, -0.8], k: "1"),
        "late": UnitDelay(ts: "2 ms"),
        "inner_error": Sum(signs: "+-"),
        "inner": DiscretePid(ts: "1 ms", kp: 3.0, ki: 1.0, kd: 0.02, lower: -2.0, upper: 2.0),
    },
    connections: [
        "in.set -> slow_error.u1", "in.actual -> hold.u, fast.u", "hold.y -> slow_error.u2", "slow_error.y -> outer.e",
        "outer.u -> inner_error.u1", "fast.y -> filter.u", "filter.y -> late.u", "late.y -> inner_error.u2",
        "inner_error.y -> inner.e",
    ],
)"#;
    agrees(&around(), control, &every(1e-3));
    // Steps in between change nothing that goes out.
    agrees(&around(), control, &every(5e-4));
}

#[test]
fn logic_modes_and_functions() {
    let control = r#"Diagram(
    inputs: { "set": (), "actual": () },
    outputs: { "u": "choose.y", "warm": "warm.y", "parts": "parts.y" },
    blocks: {
        "relay": Relay(on_at: 0.8, off_at: 0.3, on: 1.0, off: -0.5),
        "warm": Compare(operator: Greater, constant: 0.4),
        "high": Compare(operator: LessEqual, constant: 1.0),
        "both": Logic(operator: And, inputs: 2),
        "limit": Saturation(lower: -0.6, upper: 0.7),
        "zone": DeadZone(start: -0.1, end: 0.2),
        "choose": Switch(threshold: 0.5),
        "parts": Mux(inputs: 3),
        "wave": Sine(amplitude: 0.3, frequency: "3 Hz"),
    },
    connections: [
        "in.actual -> relay.u, warm.u, high.u", "in.set -> limit.u", "warm.y -> both.u1", "high.y -> both.u2",
        "both.y -> choose.control", "relay.y -> choose.u1, parts.u1", "limit.y -> zone.u, parts.u2", "zone.y -> choose.u3",
        "wave.y -> parts.u3",
    ],
)"#;
    agrees(&around(), control, &every(1e-3));
}

#[test]
fn continuous_states_by_a_method_of_fixed_step() {
    let control = r#"Diagram(
    inputs: { "set": (), "actual": () },
    outputs: { "u": "limit.y", "x": "space.y" },
    blocks: {
        "error": Sum(signs: "+-"),
        "space": StateSpace(a: [[0.0, 1.0], [-25.0, -3.0]], b: [[0.0], [25.0]], c: [[1.0, 0.0], [0.0, 1.0]], x0: [0.1, -0.2]),
        "first": Selector(indices: [0]),
        "lag": LowPass(tau: "30 ms"),
        "limit": Saturation(lower: -0.8, upper: 0.9),
    },
    connections: [
        "in.set -> error.u1", "in.actual -> error.u2", "error.y -> space.u", "space.y -> first.u", "first.y -> lag.u",
        "lag.y -> limit.u",
    ],
)"#;
    for method in [Method::Euler, Method::Rk4] {
        agrees(&around(), control, &Target { method: Some(method), ..every(1e-3) });
    }
}

#[test]
fn a_constant_outside_is_an_input_all_the_same() {
    let main = around().replace(
        r#""set": Pulse(period: "1.3 s", width: 0.4, amplitude: 2.0)"#,
        r#""set": Constant(value: 1.25)"#,
    );
    let made =
        Loop::new(&main, PID).export(&every(1e-3)).unwrap_or_else(|problems| panic!("{}", told(&problems)));
    assert!(
        crate::support::text_of(&made, ".c").contains("in->set"),
        "{}",
        crate::support::text_of(&made, ".c")
    );
    assert_eq!(run(&made), "5000 steps as in the simulation\n");
}

#[test]
fn a_whole_diagram_without_inputs() {
    let main = r#"Diagram(
    title: "Swinging */ mass",
    simulation: (stop_time: "4 s"),
    blocks: {
        "wave": Sine(amplitude: 1.0, frequency: "0.7 Hz"),
        "mass": TransferFunction(num: [1.0], den: [0.05, 0.1, 1.0], k: "1"),
        "double": Product,
        "show": Scope(inputs: ["y", "square"]),
    },
    connections: ["wave.y -> mass.u, double.u2", "mass.y -> double.u1, show.y", "double.y -> show.square"],
)"#;
    let whole = Loop::new(main, "");
    let target = Target { name: "Swinging mass".to_owned(), method: Some(Method::Rk4), ..every(1e-3) };
    let made = generate(&whole.schedule, &Part::whole(&whole.schedule), &target)
        .unwrap_or_else(|problems| panic!("{}", told(&problems)));
    assert_eq!(made.name, "Swinging_mass");
    assert_eq!(run(&made), "4001 steps as in the simulation\n");
}

/// A lag of 3 ms in steps of 10 ms is beyond what the method bears: the test of the code agrees, and that is no good sign.
#[test]
fn a_step_that_is_too_long_for_a_state_is_told() {
    let main = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: { "wave": Sine(frequency: "1 Hz"), "lag": LowPass(tau: "3 ms"), "show": Scope },
    connections: ["wave.y -> lag.u", "lag.y -> show.u"],
)"#;
    let whole = Loop::new(main, "");
    for (method, step, is_told) in [
        (Method::Rk4, 10e-3, true),
        (Method::Euler, 10e-3, true),
        (Method::Rk4, 1e-3, false),
        (Method::Euler, 1e-4, false),
    ] {
        let target = Target { method: Some(method), ..every(step) };
        let made = generate(&whole.schedule, &Part::whole(&whole.schedule), &target)
            .unwrap_or_else(|problems| panic!("{}", told(&problems)));
        assert_eq!(made.warnings.len(), usize::from(is_told), "{method:?}, {step}: {:?}", made.warnings);
        let says = made
            .files
            .iter()
            .any(|(name, text)| name.ends_with(".md") && text.contains("too long for `lag.x`"));
        assert_eq!(says, is_told, "{method:?}, {step}");
    }
}

#[test]
fn single_precision_follows() {
    agrees(&around(), PID, &Target { float: true, ..every(1e-3) });
}

/// What is zero but for rounding, as a difference of two numbers that are not, has the rounding of single precision.
#[test]
fn single_precision_leaves_its_rounding_where_numbers_cancel() {
    let control = r#"Diagram(
    inputs: { "set": (), "actual": () },
    outputs: { "u": "out.y", "nearly": "less.y" },
    blocks: {
        "a": Gain(k: 0.1), "b": Gain(k: 0.2), "c": Gain(k: 0.3), "part": Sum(signs: "++"), "less": Sum(signs: "+-"),
        "out": Sum(signs: "++"),
    },
    connections: [
        "in.set -> a.u, b.u, c.u, out.u1", "a.y -> part.u1", "b.y -> part.u2", "part.y -> less.u1", "c.y -> less.u2",
        "in.actual -> out.u2",
    ],
)"#;
    agrees(&around(), control, &Target { float: true, ..every(1e-3) });
}

/// A phase of 4e5 rad, and the difference of two times of 20 000 s that are 1 ms apart: single precision would leave 0.03 rad of
/// the one and nothing of the other. What is kept of a time for the next step is one, too.
#[test]
fn times_stay_exact_in_single_precision() {
    let main = r#"Diagram(
    simulation: (stop_time: "5 s"),
    blocks: {
        "wave": Sine(amplitude: 1.0, frequency: "12345.6 Hz", phase: "30 deg"), "now": Clock, "begin": Constant(value: "20000 s"),
        "late": Sum(signs: "++"), "before": UnitDelay(ts: "1 ms"), "apart": Sum(signs: "+-"), "speed": Expression(law: "sin(u / 1 ms) + 2"),
        "least": MinMax(function: Min, inputs: 2), "lag": LowPass(tau: "0.1 s"), "show": Scope(inputs: ["wave", "apart", "least", "lag"]),
    },
    connections: [
        "wave.y -> lag.u, show.wave", "now.y -> late.u1", "begin.y -> late.u2, least.u1", "late.y -> before.u, apart.u1, least.u2",
        "before.y -> apart.u2", "apart.y -> speed.u", "speed.y -> show.apart", "least.y -> show.least", "lag.y -> show.lag",
    ],
)"#;
    let whole = Loop::new(main, "");
    let target = Target { float: true, method: Some(Method::Rk4), ..every(1e-3) };
    let made = generate(&whole.schedule, &Part::whole(&whole.schedule), &target)
        .unwrap_or_else(|problems| panic!("{}", told(&problems)));
    assert_eq!(run(&made), "5000 steps as in the simulation\n");
    let text = text_of(&made, ".c");
    assert!(text.contains("minimum_wide(") && !text.contains("minimum("), "{text}");
}

#[test]
fn a_test_that_holds_nothing_would_be_noticed() {
    let mut made = Loop::new(&around(), PID)
        .export(&every(1e-3))
        .unwrap_or_else(|problems| panic!("{}", told(&problems)));
    for (name, text) in &mut made.files {
        if name == "control.c" {
            assert!(text.contains("8.0"), "the gain is there");
            *text = text.replace("8.0", "8.000000000000002");
        }
    }
    let printed = run(&made);
    assert!(printed.contains("in the simulation") && printed.starts_with("step "), "{printed}");
}

#[test]
fn every_function_has_the_bits_of_the_engine() {
    // Of any number, of numbers within one, of numbers above zero.
    let any = ["Sin", "Cos", "Tan", "Atan", "Sinh", "Cosh", "Tanh", "Exp", "Pow10", "SignedSqrt", "Square"];
    let within = ["Asin", "Acos"];
    let above = ["Ln", "Log10", "Sqrt", "Reciprocal"];
    let mut blocks = String::from(
        r#""small": Gain(k: 0.25), "size": Abs, "tenth": Constant(value: 0.1), "above": Sum(signs: "++"),
           "sign": Sign, "least": MinMax(function: Min, inputs: 2), "most": MinMax(function: Max, inputs: 2),
           "cube": Power(exponent: 3), "root": Power(exponent: 1.7), "ratio": Divide, "product": Product,
        "#,
    );
    let mut wires = String::from(
        r#""in.actual -> small.u, size.u, sign.u, least.u1, most.u1, cube.u, ratio.u1, product.u1", "size.y -> above.u1",
           "tenth.y -> above.u2", "in.set -> least.u2, most.u2, product.u2", "above.y -> root.u, ratio.u2",
        "#,
    );
    let single = ["sign", "least", "most", "cube", "root", "ratio", "product"];
    let mut outputs: String = single.iter().map(|name| format!("\"{name}\": \"{name}.y\", ")).collect();
    for (names, source) in [(&any[..], "in.actual"), (&within, "small.y"), (&above, "above.y")] {
        for name in names {
            blocks += &format!("\"f_{name}\": Function(function: {name}), ");
            wires += &format!("\"{source} -> f_{name}.u\", ");
            outputs += &format!("\"{name}\": \"f_{name}.y\", ");
        }
    }
    let control = format!(
        "Diagram(inputs: {{ \"set\": (), \"actual\": () }}, outputs: {{ {outputs} }}, blocks: {{ {blocks} }}, connections: [{wires}])"
    );
    let main = r#"Diagram(
    simulation: (stop_time: "5 s"),
    blocks: {
        "set": Sine(amplitude: 1.7, frequency: "0.83 Hz"),
        "actual": Sine(amplitude: 3.1, frequency: "1.91 Hz", phase: "20 deg"),
        "control": Subsystem(file: "control.ron"),
        "show": Scope(inputs: ["y"]),
    },
    connections: ["set.y -> control.set", "actual.y -> control.actual", "control.Sin -> show.y"],
)"#;
    agrees(main, &control, &every(1e-3));
}

#[test]
fn vectors_truth_values_and_buses_are_ports() {
    let control = r#"Diagram(
    inputs: { "all": (), "enable": (), "bus": () },
    outputs: { "y": "kept.y", "on": "both.y", "sum": "sum.y" },
    blocks: {
        "pick": BusSelector(elements: ["Joint.Velo"]),
        "scaled": Gain(k: 3.0),
        "kept": DiscreteTransferFunction(ts: "3 ms", num: [0.3], den: [1.0, -0.7], k: "1"),
        "high": Compare(operator: Greater, constant: 0.0),
        "both": Logic(operator: Or, inputs: 2),
        "first": Demux(sizes: [1, 2]),
        "sum": Sum(signs: "+-"),
    },
    connections: [
        "in.bus -> pick.u", "in.all -> scaled.u, first.u", "first.y1 -> kept.u", "pick.Velo -> high.u, sum.u1", "scaled.y -> sum.u2",
        "in.enable -> both.u1", "high.y -> both.u2",
    ],
)"#;
    let main = r#"Diagram(
    simulation: (stop_time: "3 s"),
    blocks: {
        "a": Sine(amplitude: 1.7, frequency: "0.83 Hz"), "b": Sine(amplitude: 0.7, frequency: "1.3 Hz"), "c": Clock,
        "three": Mux(inputs: 3), "enable": Compare(operator: Less, constant: -0.5),
        "joint": BusCreator(elements: ["Angle", "Velo"]), "arm": BusCreator(elements: ["Joint"]),
        "control": Subsystem(file: "control.ron"),
        "show": Scope(inputs: ["y"]),
    },
    connections: [
        "a.y -> three.u1, enable.u, joint.Angle", "b.y -> three.u2, joint.Velo", "c.y -> three.u3", "three.y -> control.all",
        "enable.y -> control.enable", "joint.y -> arm.Joint", "arm.y -> control.bus", "control.y -> show.y",
    ],
)"#;
    agrees(main, control, &every(1e-3));
    let made = Loop::new(main, control)
        .export(&every(1e-3))
        .unwrap_or_else(|problems| panic!("{}", told(&problems)));
    let header = crate::support::text_of(&made, ".h");
    for field in ["double all[3];", "bool enable;", "double bus_Joint_Velo;", "bool on;", "double sum[3];"] {
        assert!(header.contains(field), "{field} in\n{header}");
    }
}

#[test]
fn inputs_that_one_signal_drives_are_refused() {
    let main = around().replace(
        "\"plant.y -> control.actual, show.actual\"",
        "\"set.y -> control.actual\", \"plant.y -> show.actual\"",
    );
    let problems = Loop::new(&main, PID).export(&every(1e-3)).expect_err("a refusal");
    assert_eq!(
        told(&problems),
        "the inputs `set` and `actual` of `control` are both driven by `set.y`, so that the code could not keep them apart\n  \
         put a `Gain(k: 1)` between `set.y` and one of them, outside of `control`\n"
    );
}
