//! What is wrong with a diagram is said with place, reason and remedy, and all of it at once.

use blocksim_diagram::{Sources, targets};
use blocksim_tests::{Desk, compile_text, compile_with};
use expect_test::{Expect, expect};
use std::path::Path;

/// Problems of a diagram with these blocks and connections.
fn check(blocks: &str, connections: &str, expected: &Expect) {
    let text = format!("Diagram(\n  blocks: {{\n    {blocks}\n  }},\n  connections: [{connections}],\n)");
    expected.assert_eq(&compile_text(&text).1);
}

/// Problems of a diagram that is written in full.
fn check_text(text: &str, expected: &Expect) {
    expected.assert_eq(&compile_text(text).1);
}

#[test]
fn all_mistakes_of_a_block_show_in_one_report() {
    check(
        r#""a": Pid(kp: "2 *", ki: [1], kd: "gain", form: Paralel, tau: 1),
    "b": Sine(amplitude: "1 V", frequency: "1 kg", phase: true, ofset: 1),
    "c": Step(after: "x + y", time: "1 m"),"#,
        "",
        &expect![[r#"
            error[expression]: the expression ends too early
              model.ron:3:18 `"2 *"` 
              help: a number or a name is missing at the end
            error[parameter]: `ki`: expected a number, found a list of 1
              model.ron:3:29 `[1]` 
            error[expression]: unknown name `gain`
              model.ron:3:39 `gain` 
              help: no names are known here
            error[parameter]: `Paralel` is not a choice for `form`
              model.ron:3:52 `Paralel` 
              help: did you mean `Parallel`? The choices are `Parallel` and `Ideal`
            error[unknown_parameter]: `Pid` has no parameter `tau`
              model.ron:3:61 `tau` unknown parameter
              help: the parameters are `kp`, `ki`, `kd`, `n`, `form`, `lower`, `upper`, `external_limits`, `anti_windup`, `kb`, `x0`, `d0` and `reset`
            error[unit_mismatch]: `frequency` is in Hz, but `1 kg` is in kg
              model.ron:4:44 `"1 kg"` should be in Hz
              help: write a value in Hz or a unit of the same kind
            error[parameter]: `phase`: expected a number, found true or false
              model.ron:4:59 `true` 
            error[unknown_parameter]: `Sine` has no parameter `ofset`
              model.ron:4:65 `ofset` unknown parameter
              help: the parameters are `amplitude`, `frequency`, `phase` and `bias`
            error[expression]: unknown name `x`
              model.ron:5:23 `x` 
              help: no names are known here
            error[unit_mismatch]: `time` is in s, but `1 m` is in m
              model.ron:5:37 `"1 m"` should be in s
              help: write a value in s or a unit of the same kind
        "#]],
    );
}

#[test]
fn all_mistakes_of_the_settings_show_in_one_report() {
    check_text(
        r#"Diagram(
  simulation: (stop_time: "1 m", solver: Ode45(rtol: "a", maxstep: 1), output: Evry("1 ms"), seed: 1.5, strat: Given),
  blocks: {},
)"#,
        &expect![[r#"
            error[parameter]: `stop_time`: expected a value in s, found one in m
              model.ron:2:27 `"1 m"` 
            error[parameter]: `solver`: `maxstep` is not known here
              model.ron:2:59 `maxstep` 
              help: did you mean `max_step`? Known here: `rtol`, `atol` and `max_step`
            error[parameter]: `Evry` is not a choice for `output`
              model.ron:2:80 `Evry("1 ms")` 
              help: did you mean `Every`? The choices are `Steps` and `Every`
            error[parameter]: `seed`: expected a whole number, found 1.5
              model.ron:2:100 `1.5` 
            error[parameter]: `strat` is not known here; known are `stop_time`, `solver`, `output`, `seed`, `start`, `atol` and `algebraic_loops`
              model.ron:2:105 `strat` 
        "#]],
    );
}

#[test]
fn an_unknown_kind_and_a_misspelt_parameter_show_in_one_report() {
    check(
        r#""a": Gian(k: 2), "b": LowPass(tua: 0.5), "c": Gain(k: 1, q: 2, k: 3),"#,
        "",
        &expect![[r#"
            error[unknown_block]: there is no block kind `Gian`
              model.ron:3:10 `Gian` unknown kind
              help: did you mean `Gain`? `blocksim blocks Gain` describes it
            error[unknown_parameter]: `LowPass` has no parameter `tua`
              model.ron:3:35 `tua` unknown parameter
              help: did you mean `tau`? The parameters are `tau` and `y0`
            error[unknown_parameter]: `Gain` has no parameter `q`
              model.ron:3:62 `q` unknown parameter
              help: the parameters are `k` and `multiplication`
            error[duplicate_name]: the parameter `k` is defined twice
              model.ron:3:68 `k` the second
              model.ron:3:56 `k` the first
              help: rename or remove one of them
        "#]],
    );
}

#[test]
fn an_unknown_port_shows_the_ports_that_there_are() {
    check(
        r#""s": Step(), "g": Gain(k: 2), "t": Terminator,"#,
        r#""s.y -> g.uu", "g.x -> t.u", "q.y -> g.u""#,
        &expect![[r#"
            error[unknown_port]: `g` has no input `uu`
              model.ron:5:25 `g.uu` no such port
              model.ron:3:18 `"g"` `g` is of kind Gain
              help: its inputs are `u`
            error[unknown_port]: `g` has no output `x`
              model.ron:5:33 `g.x` no such port
              model.ron:3:18 `"g"` `g` is of kind Gain
              help: its outputs are `y`
            error[unknown_block_name]: there is no block `q`
              model.ron:5:47 `q` no such block
              help: the blocks here are `s`, `g` and `t`
        "#]],
    );
}

#[test]
fn an_element_that_a_bus_does_not_have() {
    check(
        r#""s": Step(), "b": BusCreator(elements: ["Angle", "Velo"]), "t": Terminator,"#,
        r#""s.y -> b.Angle, b.Velo", "b.y.Angel -> t.u""#,
        &expect![[r#"
            error[unknown_element]: the bus has no element `Angel`
              model.ron:5:44 `b.y.Angel` no such element
              help: did you mean `Angle`? The elements are `Angle` and `Velo`
        "#]],
    );
}

#[test]
fn a_bus_into_a_signal_port() {
    check(
        r#""s": Step(), "b": BusCreator(elements: ["Angle"]), "g": Gain(k: 1), "t": Terminator,"#,
        r#""s.y -> b.Angle", "b.y -> g.u", "g.y -> t.u""#,
        &expect![[r#"
            error[type_mismatch]: `g.u` takes a signal, not a bus
              model.ron:5:36 `b.y` carries a bus with `Angle`
              model.ron:5:43 `g.u` takes one signal
              help: select an element: `b.y.Angle`
        "#]],
    );
}

#[test]
fn a_wrong_unit_in_a_parameter_and_on_a_connection() {
    check(
        r#""a": LowPass(tau: "5 V"), "s": Step(after: "3 V"), "v": Constant(value: "1 A"), "sum": Sum(signs: "++"), "t": Terminator,"#,
        r#""s.y -> sum.u1", "v.y -> sum.u2", "sum.y -> t.u""#,
        &expect![[r#"
            error[unit_mismatch]: `tau` is in s, but `5 V` is in V
              model.ron:3:23 `"5 V"` should be in s
              help: write a value in s or a unit of the same kind
            error[unit_mismatch]: in `sum`: `u2` is in A, but `u1` is in V
              model.ron:5:42 `sum.u2` `u2` comes from here
              model.ron:5:25 `sum.u1` `u1` comes from here
              help: insert `Gain(k: "1 Ohm")` before `u2`, or correct the parameter that sets its unit
        "#]],
    );
}

#[test]
fn units_of_a_connection_that_do_not_fit_show_both_places() {
    check(
        r#""s": Step(after: "3 V"), "v": Constant(value: "1 A"), "sum": Sum(signs: "++"), "t": Terminator,"#,
        r#""s.y -> sum.u1", "v.y -> sum.u2", "sum.y -> t.u""#,
        &expect![[r#"
            error[unit_mismatch]: in `sum`: `u2` is in A, but `u1` is in V
              model.ron:5:42 `sum.u2` `u2` comes from here
              model.ron:5:25 `sum.u1` `u1` comes from here
              help: insert `Gain(k: "1 Ohm")` before `u2`, or correct the parameter that sets its unit
        "#]],
    );
}

#[test]
fn a_decimal_comma() {
    check_text(
        "Diagram(\n  blocks: {\n    \"pid\": Pid(kp: 1,05, ki: 2.0),\n  },\n)",
        &expect![[r#"
            error[syntax]: `1,05` is not a number
              model.ron:3:20 `1,05` 
              help: decimal comma? write 1.05
        "#]],
    );
    check(
        r#""g": Gain(k: "1,05"), "s": Step(), "t": Terminator,"#,
        r#""s.y -> g.u", "g.y -> t.u""#,
        &expect![[r#"
        error[expression]: `1,05` is not a number
          model.ron:3:19 `1,05` 
          help: decimal comma? write 1.05
    "#]],
    );
}

#[test]
fn a_file_that_is_missing_and_a_file_that_includes_itself() {
    check(
        r#""a": Subsystem(file: "nowhere.ron"), "b": Subsystem(file: "model.ron"), "c": FromFile(file: "data.csv"),"#,
        "",
        &expect![[r#"
            error[missing_file]: cannot read `nowhere.ron`: the file does not exist
              model.ron:3:26 `"nowhere.ron"` named here
              help: paths are relative to the file that names them
            error[recursive_file]: `model.ron` contains itself
              model.ron:3:63 `"model.ron"` is being built already
              help: a diagram cannot be part of itself
            error[missing_file]: cannot read `data.csv`: the file does not exist
              model.ron:3:97 `"data.csv"` 
              help: the path is relative to the diagram that names it
        "#]],
    );
    check_text(
        r#"Diagram(parameters: { "p": File("nothing.ron"), "q": File("model.ron"), "r": "s", "s": "r + 1" }, blocks: {}, connections: [])"#,
        &expect![[r#"
            error[missing_file]: cannot read `nothing.ron`: the file does not exist
              model.ron:1:33 `"nothing.ron"` named here
              help: paths are relative to the file that names them
            error[recursive_file]: `model.ron` includes itself
              model.ron:1:59 `"model.ron"` is being read already
            error[recursive_parameter]: `r` depends on itself
              model.ron:1:73 `"r"` the value is needed to compute it
              help: give one of the parameters on the way a value of its own
        "#]],
    );
}

#[test]
fn two_drivers_of_an_input_and_an_input_without_driver() {
    check(
        r#""a": Step(), "b": Step(), "g": Gain(k: 1), "h": Gain(k: 1), "t": Terminator,"#,
        r#""a.y -> g.u", "b.y -> g.u", "g.y -> t.u""#,
        &expect![[r#"
            error[unconnected_input]: `h.u` is not connected
              model.ron:3:48 `"h"` input `u` has no driver
              help: add `"... -> h.u"` to the connections
            error[second_driver]: `g.u` has two drivers
              model.ron:5:39 `g.u` the second
              model.ron:5:25 `g.u` the first
              help: an input takes one signal: add them with Sum, or choose with Switch
        "#]],
    );
}

#[test]
fn wrong_directions_and_mixed_kinds_of_ports() {
    check(
        r#""a": Step(), "g": Gain(k: 1), "j": Inertia(j: 1), "r": ElectricalReference, "t": Terminator,"#,
        r#""g.u -> a.y", "a.y -> j.r, g.u", "j.r <-> g.y", "j.r <-> r.p", "g.y -> t.u""#,
        &expect![[r#"
            error[wrong_direction]: `g.u` is an input and cannot drive a signal
              model.ron:5:18 `g.u` 
              model.ron:3:18 `"g"` declared here
              help: put it behind `->`
            error[wrong_direction]: `a.y` is an output and cannot be driven
              model.ron:5:25 `a.y` 
              model.ron:3:5 `"a"` declared here
              help: put it in front of `->`
            error[port_kind]: `j.r` is a conserving port
              model.ron:5:39 `j.r` connected with `->`
              help: join conserving ports with `<->`; sensors and sources lead between signals and conserving ports
            error[port_kind]: `g.y` is a signal port
              model.ron:5:59 `g.y` joined with `<->`
              help: connect signals with `->`; sensors and sources lead between signals and conserving ports
            error[domain_mismatch]: an electrical port cannot be joined to a rotational port
              model.ron:5:74 `r.p` electrical
              model.ron:5:66 `j.r` rotational
              help: join ports of one kind; motors, joints and sensors lead from one to the other
        "#]],
    );
}

#[test]
fn rotation_and_translation_are_not_joined_and_do_not_mix_their_units() {
    check(
        r#""m": Mass(m: "2 kg"), "j": Inertia(j: 1),"#,
        r#""m.r <-> j.r""#,
        &expect![[r#"
        error[domain_mismatch]: a rotational port cannot be joined to a translational port
          model.ron:5:26 `j.r` rotational
          model.ron:5:18 `m.r` translational
          help: a WheelAndAxle, a RackAndPinion or a LeadScrew leads from one to the other
    "#]],
    );
    check(
        r#""t": Constant(value: "3 N*m"), "f": IdealForceSource, "m": Mass(m: "2 N"), "s": LeadScrew(lead: "5 mm/s"), "b": TranslationalReference,"#,
        r#""t.y -> f.f", "f.r <-> m.r", "f.c <-> b.r""#,
        &expect![[r#"
            error[unit_mismatch]: `m` is in kg, but `2 N` is in N
              model.ron:3:72 `"2 N"` should be in kg
              help: write a value in kg or a unit of the same kind
            error[unit_mismatch]: `lead` is in m, but `0.005 m/s` is in m/s
              model.ron:3:101 `"5 mm/s"` should be in m
              help: write a value in m or a unit of the same kind
            error[unit_mismatch]: `f.f` is in N, but `t.y` is in N*m
              model.ron:5:18 `t.y` is in N*m
              model.ron:5:25 `f.f` takes N
              help: correct the unit at the source of the signal, or insert `Gain(k: "1 1/m")`, which gives a value in N
        "#]],
    );
}

#[test]
fn a_vector_into_a_scalar_port() {
    check(
        r#""v": Constant(value: [1.0, 2.0]), "s": ControlledVoltageSource, "g": ElectricalReference, "k": Gain(k: "1 V"),"#,
        r#""v.y -> k.u", "k.y -> s.v", "s.p <-> g.p", "s.n <-> g.p""#,
        &expect![[r#"
            error[voltage_conflict]: an ideal source is short-circuited
              model.ron:3:39 `"s"` `s` prescribes the voltage
              help: connect its pins to different nodes
        "#]],
    );
    check(
        r#""v": Constant(value: [1.0, 2.0]), "s": IdealTorqueSource, "j": Inertia(j: 1), "h": RotationalReference, "k": Gain(k: "1 N*m"),"#,
        r#""v.y -> k.u", "k.y -> s.tau", "s.r <-> j.r", "s.c <-> h.r""#,
        &expect![[r#"
            error[type_mismatch]: `s.tau` takes a scalar, but `k.y` is a vector of 2
              model.ron:5:32 `k.y` a vector of 2
              model.ron:5:39 `s.tau` takes a scalar
              help: take one element with Selector, or several with Demux
        "#]],
    );
}

#[test]
fn an_algebraic_loop_is_shown_with_every_hop() {
    check(
        r#""r": Step(), "e": Sum(signs: "+-"), "k": Gain(k: 3), "f": Gain(k: 0.5), "t": Terminator,"#,
        r#""r.y -> e.u1", "e.y -> k.u", "k.y -> f.u, t.u", "f.y -> e.u2""#,
        &expect![[r#"
            note[algebraic_loop]: algebraic loop: e -> k -> f -> e; solved at every instant
              model.ron:5:73 `e.u2` 
              model.ron:5:40 `k.u` 
              model.ron:5:54 `f.u` 
              note: `f.y` is connected to `e.u2`
              note: `e.u2` feeds through to the outputs of `e` (Sum)
              note: `e.y` is connected to `k.u`
              note: `k.u` feeds through to the outputs of `k` (Gain)
              note: `k.y` is connected to `f.u`
              note: `f.u` feeds through to the outputs of `f` (Gain)
              help: nothing is to be done if the loop is meant; else put a block without direct feedthrough into the loop: a LowPass, an Integrator or, for sampled signals, a UnitDelay; `blocksim graph --loop 1` draws it
        "#]],
    );
}

#[test]
fn a_network_without_reference_and_parts_without_inertia() {
    check(
        r#""v": Constant(value: "5 V"), "s": ControlledVoltageSource, "m": DcMotor(r: 1, l: 0.001, k: 0.1, j: 1e-4),"#,
        r#""v.y -> s.v", "s.p <-> m.p", "s.n <-> m.n""#,
        &expect![[r#"
            error[unconnected_port]: the rotational port `m.c` is not connected
              model.ron:3:64 `"m"` `m` has this port
              help: connect it; a case goes to a RotationalReference
        "#]],
    );
    check(
        r#""v": Constant(value: "5 V"), "s": ControlledVoltageSource, "m": DcMotor(r: 1, l: 0.001, k: 0.1, j: 1e-4), "h": RotationalReference,"#,
        r#""v.y -> s.v", "s.p <-> m.p", "s.n <-> m.n", "m.c <-> h.r""#,
        &expect![[r#"
            error[missing_reference]: this electrical network has no reference
              model.ron:3:64 `"m"` `m` belongs to it
              help: add an ElectricalReference and connect it to one of the nodes
        "#]],
    );
    check(
        r#""j": RevoluteJoint(), "b": Body(mass: 1, com: [0.0, 0.0, 1.0], moi: [0.1, 0.1, 0.1], poi: [0.0, 0.0, 0.0]),"#,
        r#""j.follower <-> b.frame""#,
        &expect![[r#"
            error[missing_reference]: this mechanism has no World
              model.ron:3:27 `"b"` `b` belongs to it
              help: add a World and connect its frame to the first body or joint
        "#]],
    );
    check(
        r#""d": RotationalDamper(d: 1), "f": RotationalDamper(d: 1), "h": RotationalReference,"#,
        r#""d.r <-> f.r", "d.c <-> f.c <-> h.r""#,
        &expect![[r#"
            error[no_inertia]: nothing at `d.r` has inertia or a given speed, so its acceleration is unknown
              model.ron:3:5 `"d"` `d` `r` is connected to it
              model.ron:3:34 `"f"` `f` `r` is connected to it
              help: add an Inertia there, or couple the node to something that has one
        "#]],
    );
}

#[test]
fn sources_that_fight() {
    check(
        r#""a": Constant(value: "1 rad/s"), "s": IdealSpeedSource, "q": IdealSpeedSource, "j": Inertia(j: 1), "h": RotationalReference,"#,
        r#""a.y -> s.w, q.w", "s.r <-> q.r <-> j.r", "s.c <-> q.c <-> h.r""#,
        &expect![[r#"
            error[speed_conflict]: two parts prescribe the same speed
              model.ron:3:38 `"s"` `s` prescribes the speed
              model.ron:3:104 `"h"` `h` holds the speed at zero
              model.ron:3:61 `"q"` `q` prescribes the speed
              help: remove one of them, or put a spring, a damper or a clutch between them
        "#]],
    );
}

#[test]
fn variants_must_have_the_same_ports_and_an_alternative_that_exists() {
    let desk = Desk::new()
        .with("a.ron", r#"Diagram(inputs: { "u": () }, outputs: { "y": "g.y" }, blocks: { "g": Gain(k: 1) }, connections: ["in.u -> g.u"])"#)
        .with("b.ron", r#"Diagram(inputs: { "v": () }, outputs: { "y": "g.y" }, blocks: { "g": Gain(k: 1) }, connections: ["in.v -> g.u"])"#)
        .with(
            "model.ron",
            r#"Diagram(
    parameters: { "which": Choice(default: "a", of: ["a", "b"]) },
    blocks: {
        "s": Step(),
        "x": Variant(choice: "which", of: { "a": Subsystem(file: "a.ron"), "b": Subsystem(file: "b.ron") }),
        "t": Terminator,
    },
    connections: ["s.y -> x.u", "x.y -> t.u"],
)"#,
        );
    let problems = compile_with(&desk, Path::new("model.ron"), &["which=c"]).1;
    expect![[r#"
        error[variant_ports]: alternative `b` has no input `u`
          model.ron:5:76 `"b"` no input `u`
          model.ron:5:45 `"a"` has it
          help: all alternatives of a variant offer the same ports
        error[unknown_override]: `which` has no alternative `c`
          command line:1:1 `which=c` 
          help: the alternatives are `a` and `b`
    "#]]
    .assert_eq(&problems);
    let problems = compile_with(&desk, Path::new("model.ron"), &["wich=b"]).1;
    expect![[r#"
        error[variant_ports]: alternative `b` has no input `u`
          model.ron:5:76 `"b"` no input `u`
          model.ron:5:45 `"a"` has it
          help: all alternatives of a variant offer the same ports
        error[unknown_override]: there is no `wich` to set
          command line:1:1 `wich=b` 
          help: did you mean `which`?
    "#]]
    .assert_eq(&problems);
}

/// Alternatives that are not chosen can be set, for runs that choose them, but it is not left unsaid that this changes nothing.
#[test]
fn what_the_command_line_sets_in_another_alternative_changes_nothing() {
    let part = r#"Diagram(parameters: { "k": 1 }, inputs: { "u": () }, outputs: { "y": "g.y" }, blocks: { "g": Gain(k: "k") }, connections: ["in.u -> g.u"])"#;
    let desk = Desk::new().with("part.ron", part).with(
        "model.ron",
        r#"Diagram(
    parameters: { "which": Choice(default: "a", of: ["a", "b", "c"]), "inner": Choice(default: "p", of: ["p", "q"]) },
    blocks: {
        "s": Step(),
        "x": Variant(choice: "which", of: {
            "a": Gain(k: 2),
            "b": Variant(choice: "inner", of: { "p": LowPass(tau: "1 s"), "q": Delay(steps: 3, ts: "1 s") }),
            "c": Subsystem(file: "part.ron"),
        }),
        "t": Terminator,
    },
    connections: ["s.y -> x.u", "x.y -> t.u"],
)"#,
    );
    let problems = |sets: &[&str]| compile_with(&desk, Path::new("model.ron"), sets).1;
    for sets in [
        ["x.k=3"].as_slice(),
        &["x.tau=2 s", "which=b"],
        &["x.steps=2", "which=b", "inner=q"],
        &["x.k=3", "which=c"],
        &["x/g.k=3", "which=c"],
    ] {
        assert_eq!(problems(sets), "", "{sets:?}");
    }
    expect![[r#"
        warning[unused_parameter]: `x.tau` is in the alternative `b` of `x`, which is not chosen, so this changes nothing
          command line:1:1 `x.tau=2 s` 
          help: `blocksim params list MODEL` lists what can be set, with the values
    "#]]
    .assert_eq(&problems(&["x.tau=2 s"]));
    expect![[r#"
        warning[unused_parameter]: `x.steps` is in the alternative `q` of `x`, which is not chosen, so this changes nothing
          command line:1:1 `x.steps=2` 
          help: `blocksim params list MODEL` lists what can be set, with the values
    "#]]
    .assert_eq(&problems(&["x.steps=2", "which=b"]));
    let apart = problems(&["x/g.k=3"]);
    assert!(apart.contains("`x/g.k` is in the alternative `c` of `x`, which is not chosen"), "{apart}");
    // What is chosen can be looked up, and is written where it stands.
    let sources = Sources::new(&desk);
    let (targets, _) = targets(&sources, Path::new("model.ron"));
    let names: Vec<&str> = targets.iter().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["which", "inner", "s.time", "s.before", "s.after", "x.k", "x.multiplication"]);
    let site = &targets[5].site.place;
    assert_eq!(&sources.file(site.file).text[site.span.clone()], "2");
}

#[test]
fn what_the_command_line_sets_must_exist() {
    let desk = Desk::new().with(
        "model.ron",
        r#"Diagram(parameters: { "gain": (kp: 2.0, ki: "1 1/s") }, blocks: { "s": Step(), "g": Gain(k: "gain.kp"), "t": Terminator }, connections: ["s.y -> g.u", "g.y -> t.u"])"#,
    );
    for set in ["gain.kq=1", "g.kk=2", "g.k=5 q", "nonsense"] {
        let problems = compile_with(&desk, Path::new("model.ron"), &[set]).1;
        match set {
            "gain.kq=1" => expect![[r#"
                error[unknown_override]: there is no `kq`; known are `kp` and `ki`
                  command line:1:1 `gain.kq=1` 
            "#]].assert_eq(&problems),
            "g.kk=2" => expect![[r#"
                error[unknown_override]: there is no `g.kk` to set
                  command line:1:1 `g.kk=2` 
                  help: did you mean `g.k`?
            "#]].assert_eq(&problems),
            "g.k=5 q" => expect![[r#"
                error[expression]: unknown unit `q`
                  model.ron:1:96 `i` 
                  note: with `--set g.k=5 q`
                  help: units are SI symbols with prefixes, such as mm, kg, ms, kW, mH, kOhm, N*m, rad/s, deg, rpm, %
            "#]].assert_eq(&problems),
            _ => expect![[r#"
                error[unknown_override]: `--set` needs a name and a value
                  command line:1:1 `nonsense` 
                  help: write --set name=value, --set block.parameter=value or --set path/to/block.parameter=value
            "#]].assert_eq(&problems),
        }
    }
    for (set, help) in
        [("kp=3", "did you mean `gain.kp`?"), ("payload=5", "did you mean `gain.payload.mass`?")]
    {
        let text = r#"Diagram(
    parameters: { "gain": (kp: 2.0, payload: (mass: "1 kg")) },
    blocks: { "s": Step(), "g": Gain(k: "gain.kp"), "t": Terminator },
    connections: ["s.y -> g.u", "g.y -> t.u"],
)"#;
        let problems = compile_with(&Desk::new().with("model.ron", text), Path::new("model.ron"), &[set]).1;
        assert!(problems.ends_with(&format!("help: {help}\n")), "{problems}");
    }
    for set in ["gain.kp=3", "g.k=5", "g.k=gain.kp*2"] {
        assert_eq!(compile_with(&desk, Path::new("model.ron"), &[set]).1, "", "{set}");
    }
}

#[test]
fn joints_and_moves_stay_within_their_limits() {
    check(
        r#""w": World(), "j": RevoluteJoint(position: "200 deg", lower: "-180 deg", upper: "180 deg"), "b": Body(mass: 1, com: [0.0, 0.0, 1.0], moi: [0.1, 0.1, 0.1], poi: [0.0, 0.0, 0.0]),"#,
        r#""w.frame <-> j.base", "j.follower <-> b.frame""#,
        &expect![[r#"
            error[parameter]: the joint starts at 3.490658503988659 rad, above its upper limit of 3.141592653589793 rad
              model.ron:3:48 `"200 deg"` 
              model.ron:3:85 `"180 deg"` `upper`
              note: in block `j` (RevoluteJoint)
              help: start within the limits, or change `upper`
        "#]],
    );
}

#[test]
fn a_move_out_of_its_limits_names_the_axis_and_the_limit() {
    for path in [
        r#"(start: ["0 deg"], target: ["200 deg"], velocity: "40 %", acceleration: "30 %")"#,
        r#"(start: ["-190 deg"], target: ["20 deg"], velocity: "40 %", acceleration: "30 %")"#,
        r#"(start: ["0 deg"], target: ["20 deg"], velocity: "140 %", acceleration: "30 %")"#,
        r#"(start: ["0 deg"], target: ["20 mm"], velocity: "40 %", acceleration: "30 %")"#,
        r#"(start: ["20 deg"], target: ["20 deg"], velocity: "40 %", acceleration: "30 %")"#,
    ] {
        let text = format!(
            r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {{
        "m": JointMove(
            path: {path},
            limits: [(lower: "-180 deg", upper: "180 deg", speed: "175 deg/s", acceleration: "8 rad/s^2")],
            axis: 1,
        ),
        "t": Scope(inputs: ["q", "qd"]),
    }},
    connections: ["m.q -> t.q", "m.qd -> t.qd"],
)"#
        );
        let problems = compile_text(&text).1;
        match path {
            path if path.contains("200 deg") => expect![[r#"
                error[parameter]: axis 1: the target 200 deg is 20 deg above the limit 180 deg
                  model.ron:5:47 `"200 deg"` 
                  note: in block `m` (JointMove)
                  help: choose a position from -180 to 180 deg
            "#]]
            .assert_eq(&problems),
            path if path.contains("-190 deg") => expect![[r#"
                error[parameter]: axis 1: the start -190 deg is 10 deg below the limit -180 deg
                  model.ron:5:28 `"-190 deg"` 
                  note: in block `m` (JointMove)
                  help: choose a position from -180 to 180 deg
            "#]]
            .assert_eq(&problems),
            path if path.contains("140 %") => expect![[r#"
                error[parameter]: the velocity is 140 % of the maximum speed
                  model.ron:5:68 `"140 %"` 
                  note: in block `m` (JointMove)
                  help: choose more than 0 % and at most 100 %
            "#]]
            .assert_eq(&problems),
            path if path.contains("mm") => expect![[r#"
                error[parameter]: axis 1 turns, but this has the unit of an axis that slides
                  model.ron:5:47 `"20 mm"` 
                  note: in block `m` (JointMove)
                  help: give it with rad or deg in the place of m, such as 30 deg, 2 rad/s or 50 N*m
            "#]]
            .assert_eq(&problems),
            _ => expect![[r#"
                error[parameter]: start and target are the same on all axes
                  model.ron:5:47 `["20 deg"]` 
                  note: in block `m` (JointMove)
                  help: change the target of at least one
            "#]]
            .assert_eq(&problems),
        }
    }
}

#[test]
fn an_input_of_a_subsystem_that_says_its_unit() {
    let desk = Desk::new()
        .with("inner.ron", r#"Diagram(inputs: { "w": (unit: "rad/s") }, outputs: { "y": "g.y" }, blocks: { "g": Gain(k: 1) }, connections: ["in.w -> g.u"])"#)
        .with(
            "model.ron",
            r#"Diagram(blocks: { "s": Step(after: "3 Hz"), "x": Subsystem(file: "inner.ron"), "t": Terminator }, connections: ["s.y -> x.w", "x.y -> t.u"])"#,
        );
    expect![[r#"
        error[unit_mismatch]: `x.w` is in rad/s, but `s.y` is in Hz
          model.ron:1:114 `s.y` is in Hz
          inner.ron:1:24 `(unit: "rad/s")` declared in rad/s
          help: correct the unit where the signal arises, or the one that the subsystem declares
    "#]]
    .assert_eq(&compile_with(&desk, Path::new("model.ron"), &[]).1);
}

#[test]
fn nothing_that_is_written_makes_the_compiler_panic() {
    // Every prefix of a diagram, and every diagram with one character taken out, is answered.
    let text = r#"Diagram(title: "t", parameters: {"k": "2 V", "m": [1, 2]}, simulation: (stop_time: "1 s"), blocks: {"s": Step(), "g": Gain(k: "k * m[0]"), "t": Terminator}, connections: ["s.y -> g.u", "g.y -> t.u"])"#;
    for cut in 0..text.len() {
        let _ = compile_text(&text[..cut]);
        let _ = compile_text(&format!("{}{}", &text[..cut], &text[cut + 1..]));
    }
}

#[test]
fn a_missing_file_is_looked_for_where_its_path_begins() {
    let model = |file: &str| {
        format!(
            r#"Diagram(
                simulation: (stop_time: "1 s"), parameters: {{ "set": File("{file}") }},
                blocks: {{ "one": Constant(value: "set.k"), "show": Scope }}, connections: ["one.y -> show.u"],
            )"#
        )
    };
    let problems = |file: &str, set: &[&str]| {
        let desk = Desk::new().with("model.ron", &model(file)).with("set.ron", "(k: 1.0)");
        compile_with(&desk, Path::new("model.ron"), set).1
    };
    let in_file = problems("gone.ron", &[]);
    assert!(in_file.contains("help: paths are relative to the file that names them"), "{in_file}");
    let in_set = problems("set.ron", &["set=File(\"gone.ron\")"]);
    assert!(
        in_set.contains(
            "help: paths on the command line are relative to the folder where the program is called"
        ),
        "{in_set}"
    );
}

/// Blocks whose parameters are differences or factors, with one in degC in the place of `@`.
const DIFFERENCES: [(&str, &str); 22] = [
    ("amplitude", r#"Sine(amplitude: @, frequency: "1 Hz", bias: "20 degC")"#),
    ("amplitude", r#"Chirp(amplitude: @, bias: "20 degC")"#),
    ("amplitude", r#"Prbs(amplitude: @, bias: "20 degC")"#),
    ("amplitude", r#"Pulse(amplitude: @, period: "1 s")"#),
    ("std", r#"Noise(std: @, mean: "20 degC", ts: "1 s")"#),
    ("slope", "Ramp(slope: @)"),
    ("width", r#"Backlash(width: @, y0: "20 degC")"#),
    ("interval", "Quantizer(interval: @)"),
    ("rising", "RateLimiter(rising: @, falling: -1)"),
    ("falling", "RateLimiter(rising: 1, falling: @)"),
    ("hysteresis", "DirectionReverser(hysteresis: @)"),
    ("amplitude", "StepperDriver(amplitude: @)"),
    ("k", "Gain(k: @)"),
    ("k", r#"Gain(k: ["1 K", @])"#),
    ("k", "TransferFunction(num: [1], den: [1, 1], k: @)"),
    ("kp", "Pid(kp: @, ki: 0)"),
    ("kp", r#"DiscretePid(kp: @, ts: "1 s")"#),
    ("gain", r#"DiscreteIntegrator(gain: @, ts: "1 s")"#),
    ("gain", r#"DiscreteDerivative(gain: @, ts: "1 s")"#),
    ("k", r#"DiscreteTransferFunction(num: [1], den: [1, 1], k: @, ts: "1 s")"#),
    ("c", "StateSpace(a: [[-1]], b: [[1]], c: [[@]])"),
    ("c", r#"DiscreteStateSpace(a: [[0]], b: [[1]], c: [[@]], ts: "1 s")"#),
];

#[test]
fn a_difference_is_not_given_in_a_unit_with_a_zero_of_its_own() {
    for (name, block) in DIFFERENCES {
        let problems = |value: &str| {
            let block = block.replace('@', value);
            compile_text(&format!("Diagram(blocks: {{ \"b\": {block} }}, connections: [])")).1
        };
        let refused = format!("error[unit_mismatch]: `{name}` is a difference or a factor, but");
        for value in [r#""-0.5 degC""#, r#""3 °C""#] {
            let found = problems(value);
            assert!(
                found.contains(&refused) && found.contains("help: write "),
                "{block} with {value}: {found}"
            );
        }
        for value in [r#""0.5 K""#, r#""500 mK""#, "0.5"] {
            let found = problems(value);
            assert!(!found.contains("is a difference"), "{block} with {value}: {found}");
        }
    }
    // Values of a scale keep it.
    for block in [
        r#"Step(before: "20 degC", after: "25 degC")"#,
        r#"Sawtooth(lower: "20 degC", upper: "25 degC", period: "1 s")"#,
        r#"Constant(value: "20 degC")"#,
        r#"Saturation(lower: "20 degC", upper: "25 degC")"#,
        r#"Relay(on_at: "21 degC", off_at: "19 degC")"#,
        r#"DeadZone(start: "20 degC", end: "25 degC")"#,
        r#"LowPass(tau: "1 s", y0: "20 degC")"#,
        r#"LookupTable1D(breakpoints: ["20 degC", "25 degC"], table: [1, 2])"#,
    ] {
        let found = compile_text(&format!("Diagram(blocks: {{ \"b\": {block} }}, connections: [])")).1;
        assert!(!found.contains("unit_mismatch"), "{block}: {found}");
    }
}

#[test]
fn a_difference_that_is_named_is_looked_up_where_it_is_written() {
    let model = |value: &str| {
        format!(
            r#"Diagram(
  parameters: {{
    "amp": "3 degC", "alias": "amp", "data": (a: "1 degC", b: "2 K"), "two": ["1 K", "2 degC"],
    "hot": "30 degC", "cold": "20 degC",
  }},
  simulation: (stop_time: "1 s", atol: {{ "lag": "0.01 K" }}),
  blocks: {{
    "w": Sine(amplitude: {value}, frequency: "1 Hz", bias: "20 degC"), "lag": LowPass(tau: "1 s", y0: "20 degC"),
    "s": Scope,
  }},
  connections: ["w.y -> lag.u", "lag.y -> s.u"],
)"#
        )
    };
    let is_refused = |value: &str, set: &[&str]| {
        let desk = Desk::new().with("model.ron", &model(value));
        compile_with(&desk, Path::new("model.ron"), set)
            .1
            .contains("error[unit_mismatch]: `amplitude` is a difference")
    };
    for value in
        [r#""amp""#, r#""alias""#, r#""data.a""#, r#""two[1]""#, r#"(value: "3 degC", note: "measured")"#]
    {
        assert!(is_refused(value, &[]), "{value}");
    }
    // The difference of two temperatures is one.
    for value in [r#""data.b""#, r#""two[0]""#, r#""hot - cold""#, r#""2 * (hot - cold)""#] {
        assert!(!is_refused(value, &[]), "{value}");
    }
    // What the command line sets holds.
    for (value, set, refused) in [
        (r#""amp""#, "amp=3 K", false),
        (r#""alias""#, "amp=3 K", false),
        (r#""data.b""#, "amp=3 degC", false),
        (r#""data.b""#, "data.b=3 degC", true),
        (r#""data.a""#, "data.a=3 K", false),
        (r#""two[0]""#, "two[0]=3 degC", true),
        (r#""3 K""#, "w.amplitude=3 degC", true),
        (r#""amp""#, "w.amplitude=3 K", false),
    ] {
        assert_eq!(is_refused(value, &[set]), refused, "{value} with {set}");
    }
    check_text(
        &model("\"amp\"").replace("0.01 K", "0.01 degC"),
        &expect![[r#"
            error[unit_mismatch]: `atol` is a difference or a factor, but degC counts from 273.15 K
              model.ron:6:40 `{ "lag": "0.01 degC" }` should be in K
              help: write K
            error[unit_mismatch]: `amplitude` is a difference or a factor, but degC counts from 273.15 K
              model.ron:8:26 `"amp"` should be in K
              help: give `amp` in K
        "#]],
    );
}

#[test]
fn an_input_and_an_output_of_one_name_are_refused_where_they_are_declared() {
    let (_, problems) = compile_text(
        r#"Diagram(inputs: { "x": () }, outputs: { "x": "g.y" }, blocks: { "g": Gain(k: 2) }, connections: ["in.x -> g.u"])"#,
    );
    assert!(
        problems.contains("duplicate_name") && problems.contains("an input and an output are called `x`"),
        "{problems}"
    );
}
