//! What physics has no answer to is refused with place, reason and remedy; exact zeros are taken wherever it has one.

use blocksim_tests::{compile_text, run, run_text};
use expect_test::{Expect, expect};

/// What is said of a diagram with these blocks and connections, before it runs or while it does.
fn said(blocks: &str, connections: &str) -> String {
    let text = format!(
        "Diagram(\n  simulation: (stop_time: \"1 s\"),\n  blocks: {{\n    {blocks}\n  }},\n  connections: [{connections}],\n)"
    );
    let (compiled, problems) = compile_text(&text);
    let Some(schedule) = compiled.schedule else { return problems };
    match run(schedule).error {
        Some(error) => {
            let at = error.path.as_deref().unwrap_or("nowhere");
            format!("error[{}] at {at}: {}\n", error.code, error.message)
        }
        None => problems,
    }
}

fn check(blocks: &str, connections: &str, expected: &Expect) {
    expected.assert_eq(&said(blocks, connections));
}

#[test]
fn parameters_that_no_part_has() {
    check(
        r#""r": Resistor(r: "-1 Ohm"), "s": Resistor(r: 0), "l": Inductor(l: 0), "k": Inductor(l: -1), "c": Capacitor(c: 0), "j": Inertia(j: "-1 kg*m^2"), "m": Mass(m: -1), "d": RotationalDamper(d: -1), "b": Body(mass: -1, com: [0.0, 0.0, 1.0], moi: [0.1, 0.1, 0.1], poi: [0.0, 0.0, 0.0]),"#,
        "",
        &expect![[r#"
            error[parameter]: `r` is -1 Ohm, but must be positive
              model.ron:4:22 `"-1 Ohm"` 
              note: in block `r` (Resistor)
              help: write a number above 0
            error[parameter]: `r` is 0, but must be positive
              model.ron:4:50 `0` 
              note: in block `s` (Resistor)
              help: a resistance of zero is a wire: join the two nodes instead
            error[parameter]: `l` is 0, but must be positive
              model.ron:4:71 `0` 
              note: in block `l` (Inductor)
              help: without inductance it is a wire: join the two nodes instead
            error[parameter]: `l` is -1 H, but must be positive
              model.ron:4:92 `-1` 
              note: in block `k` (Inductor)
              help: write a number above 0
            error[parameter]: `c` is 0, but must be positive
              model.ron:4:115 `0` 
              note: in block `c` (Capacitor)
              help: without capacitance it connects nothing: leave it out
            error[parameter]: `j` is -1 kg*m^2, but must not be negative
              model.ron:4:135 `"-1 kg*m^2"` 
              note: in block `j` (Inertia)
              help: write 0 or more; signs and directions come from connections and signals
            error[parameter]: `m` is -1 kg, but must not be negative
              model.ron:4:162 `-1` 
              note: in block `m` (Mass)
              help: write 0 or more; signs and directions come from connections and signals
            error[parameter]: `d` is -1 N*m*s/rad, but must not be negative
              model.ron:4:192 `-1` 
              note: in block `d` (RotationalDamper)
              help: write 0 or more; signs and directions come from connections and signals
            error[parameter]: `mass` is -1 kg, but must not be negative
              model.ron:4:213 `-1` 
              note: in block `b` (Body)
              help: write 0 or more; signs and directions come from connections and signals
        "#]],
    );
    check(
        r#""m": DcMotor(r: 0, l: 0, k: 0.1, j: 0), "q": AsynchronousMachine(rated_power: 1, rated_voltage: 1, rated_frequency: 0, pole_pairs: 1, r_s: 1, x_ls: 1, r_r: 1, x_lr: 1, x_m: 1), "t": Transformer(ratio: 0, l_m: 1, l1: 1, l2: 1), "x": Transformer(ratio: 1, l_m: 1, l1: 0, l2: 0), "c": MutualInductance(l1: 1, l2: 1, k: 1), "v": IdealSwitch(r_on: 10, g_off: 1),"#,
        "",
        &expect![[r#"
            error[parameter]: `r` and `l` are both 0, so nothing limits the current
              model.ron:4:21 `0` 
              model.ron:4:27 `0` `l`
              note: in block `m` (DcMotor)
              help: give the winding its resistance
            error[parameter]: `rated_frequency` is 0, but must be positive
              model.ron:4:121 `0` 
              note: in block `q` (AsynchronousMachine)
              help: write a number above 0
            error[parameter]: `ratio` is 0, but must be finite and not 0
              model.ron:4:206 `0` 
              note: in block `t` (Transformer)
              help: write the turns of the first winding over those of the second, negative for the other sense
            error[parameter]: `l1` and `l2` are zero against `l_m`: the two currents are no states of their own
              model.ron:4:271 `0` 
              model.ron:4:278 `0` `l2`
              model.ron:4:256 `1` `ratio`
              model.ron:4:264 `1` `l_m`
              note: in block `x` (Transformer)
              help: give one winding a leakage of some percent, or use an IdealTransformer beside an Inductor
            error[parameter]: `k` is 1, but must be at least 0 and below 1
              model.ron:4:321 `1` 
              note: in block `c` (MutualInductance)
              help: coils without leakage are an IdealTransformer beside an Inductor
            error[parameter]: `g_off` (1 S) lets as much through as `r_on` (10 ohm): on and off are the same
              model.ron:4:359 `1` 
              model.ron:4:348 `10` `r_on`
              note: in block `v` (IdealSwitch)
              help: a conductance is one over a resistance: 1e-6 S is 1 Mohm
        "#]],
    );
}

#[test]
fn efficiencies_and_teeth_that_no_gear_has() {
    check(
        r#""a": SimpleGear(ratio: 5, efficiency: 1.2), "b": SimpleGear(ratio: 5, efficiency: 0), "c": SimpleGear(ratio: 0), "d": CycloidalDrive(disc_teeth: 10, ring_teeth: 10, efficiency_forward: 0.9, efficiency_backward: 0.9), "e": CycloidalDrive(disc_teeth: 10, ring_teeth: 11, efficiency_forward: 0.9, efficiency_backward: -0.1), "f": PlanetaryGear(ring_teeth: 20, sun_teeth: 20), "w": WormGear(ratio: 40, lead_angle: "0 deg", friction: 0.1),"#,
        "",
        &expect![[r#"
            error[parameter]: `efficiency` is 1.2, but must be above 0 and at most 1
              model.ron:4:43 `1.2` 
              note: in block `a` (SimpleGear)
              help: 1 means no losses
            error[parameter]: `efficiency` is 0, but must be above 0 and at most 1
              model.ron:4:87 `0` 
              note: in block `b` (SimpleGear)
              help: 1 means no losses
            error[parameter]: `ratio` is 0, but must be positive
              model.ron:4:114 `0` 
              note: in block `c` (SimpleGear)
              help: the sign of the ratio is given by `direction: Reversed` or `Same`
            error[parameter]: `ring_teeth` is 10, but must be above `disc_teeth`, which is 10
              model.ron:4:166 `10` 
              model.ron:4:150 `10` `disc_teeth`
              note: in block `d` (CycloidalDrive)
              help: for a reduction of `disc_teeth` the ring has one tooth more
            error[parameter]: `efficiency_backward` is -0.1, but must be above 0 and at most 1
              model.ron:4:320 `-0.1` 
              note: in block `e` (CycloidalDrive)
              help: 1 means no losses
            error[parameter]: `ring_teeth` is 20, but must be above `sun_teeth`, which is 20
              model.ron:4:358 `20` 
              model.ron:4:373 `20` `sun_teeth`
              note: in block `f` (PlanetaryGear)
              help: the planets run between the sun and the ring around it: are the two exchanged?
            error[parameter]: `lead_angle` is 0, but must be above 0 and below 90 deg
              model.ron:4:415 `"0 deg"` 
              note: in block `w` (WormGear)
              help: write it with its unit: "5 deg"
        "#]],
    );
}

#[test]
fn nothing_there_that_has_inertia() {
    check(
        r#""t": Constant(value: "1 N*m"), "s": IdealTorqueSource, "j": Inertia(j: 0), "h": RotationalReference,"#,
        r#""t.y -> s.tau", "s.r <-> j.r", "s.c <-> h.r""#,
        &expect![[r#"
            error[no_inertia]: nothing at `j.r` has inertia or a given speed, so its acceleration is unknown
              model.ron:4:60 `"j"` `j` `r` is connected to it
              model.ron:4:36 `"s"` `s` `r` is connected to it
              help: add an Inertia there, or couple the node to something that has one
        "#]],
    );
    check(
        r#""t": Constant(value: "1 N"), "s": IdealForceSource, "m": Mass(m: 0), "h": TranslationalReference,"#,
        r#""t.y -> s.f", "s.r <-> m.r", "s.c <-> h.r""#,
        &expect![[r#"
            error[no_inertia]: nothing at `m.r` has mass or a given speed, so its acceleration is unknown
              model.ron:4:57 `"m"` `m` `r` is connected to it
              model.ron:4:34 `"s"` `s` `r` is connected to it
              help: add a Mass there, or couple the node to something that has one
        "#]],
    );
    check(
        r#""u": VoltageSource(v: 5), "m": DcMotor(r: 1, l: 0, k: 0.1, j: 0), "d": RotationalDamper(d: 1), "g": ElectricalReference, "h": RotationalReference,"#,
        r#""u.p <-> m.p", "u.n <-> m.n <-> g.p", "m.r <-> d.r", "m.c <-> d.c <-> h.r""#,
        &expect![[r#"
            error[no_inertia]: nothing at `d.r` has inertia or a given speed, so its acceleration is unknown
              model.ron:4:71 `"d"` `d` `r` is connected to it
              model.ron:4:31 `"m"` `m` `r` is connected to it
              help: add an Inertia there, or couple the node to something that has one
        "#]],
    );
}

#[test]
fn a_drive_of_a_joint_with_one_side_connected() {
    check(
        r#""w": World, "a": RevoluteJoint(axis: [0, 1, 0]), "b": RevoluteJoint(axis: [0, 1, 0]), "upper": Body(mass: 1, moi: [1, 1, 1]), "lower": Body(mass: 1, moi: [1, 1, 1]), "s": RotationalSpring(k: 3),"#,
        r#""w.frame <-> a.base", "a.follower <-> upper.frame <-> b.base", "b.follower <-> lower.frame", "a.r <-> s.r", "b.c <-> s.c""#,
        &expect![[r#"
            error[missing_reference]: nothing holds `a.c`, against which the joint moves what is connected to `a.r`
              model.ron:4:17 `"a"` `a` has both sides of the drive
              help: connect it to a RotationalReference, or to the part that the drive is mounted on
            error[missing_reference]: nothing drives `b.r`, against which the joint moves what is connected to `b.c`
              model.ron:4:54 `"b"` `b` has both sides of the drive
              help: connect the drive to it
        "#]],
    );
}

#[test]
fn ideal_voltages_in_parallel() {
    check(
        r#""a": VoltageSource(v: 5), "b": VoltageSource(v: 6), "r": Resistor(r: 1), "g": ElectricalReference,"#,
        r#""a.p <-> b.p <-> r.p", "a.n <-> b.n <-> r.n <-> g.p""#,
        &expect![[r#"
            error[voltage_conflict]: two parts prescribe the same voltage
              model.ron:4:31 `"b"` `b` prescribes the voltage
              model.ron:4:5 `"a"` `a` prescribes the voltage
              help: remove one of them, or connect them through a resistance
        "#]],
    );
    check(
        r#""a": VoltageSource(v: 5), "c": Capacitor(c: "1 uF", v0: "2 V"), "g": ElectricalReference,"#,
        r#""a.p <-> c.p", "a.n <-> c.n <-> g.p""#,
        &expect![[r#"
            error[start_conflict]: the voltages at the start do not obey Kirchhoff's law: around a loop of capacitors they miss zero by 3 V
              model.ron:4:31 `"c"` `c` has a voltage at the start
              model.ron:4:5 `"a"` `a` gives a voltage
              help: leave out `v0` of one of them, or give values that fit; what comes as a signal counts as zero before the start
        "#]],
    );
    check(
        r#""a": Capacitor(c: "1 uF", v0: "5 V"), "b": Capacitor(c: "1 uF", v0: 0), "r": Resistor(r: 1), "g": ElectricalReference,"#,
        r#""a.p <-> b.p <-> r.p", "a.n <-> b.n <-> r.n <-> g.p""#,
        &expect![[r#"
            error[start_conflict]: the voltages at the start do not obey Kirchhoff's law: around a loop of capacitors they miss zero by 5 V
              model.ron:4:5 `"a"` `a` has a voltage at the start
              model.ron:4:43 `"b"` `b` has a voltage at the start
              help: leave out `v0` of one of them, or give values that fit; what comes as a signal counts as zero before the start
        "#]],
    );
}

#[test]
fn currents_without_a_path() {
    check(
        r#""i": Constant(value: "1 A"), "a": ControlledCurrentSource, "b": ControlledCurrentSource, "r": Resistor(r: 1), "g": ElectricalReference,"#,
        r#""i.y -> a.i, b.i", "a.p <-> b.n", "a.n <-> r.p", "b.p <-> r.n <-> g.p""#,
        &expect![[r#"
            error[no_current_path]: a prescribed current has no path at `a.p`: only other prescribed currents and windings that cannot follow it meet there
              model.ron:4:34 `"a"` `a` prescribes the current
              model.ron:4:64 `"b"` `b` prescribes the current
              help: connect a resistance or a capacitance there, in parallel to the source
        "#]],
    );
    check(
        r#""u": VoltageSource(v: 5), "a": Inductor(l: "1 mH", i0: "1 A"), "b": VoltageSensor, "g": ElectricalReference,"#,
        r#""u.p <-> a.p", "a.n <-> b.p", "b.n <-> u.n <-> g.p""#,
        &expect![[r#"
            error[start_conflict]: the currents at the start do not obey Kirchhoff's law: 1 A have no path
              model.ron:4:31 `"a"` `a` has a current at the start
              help: leave out `i0` of one of these inductances, or make their start currents add up to zero at every node
        "#]],
    );
    check(
        r#""u": VoltageSource(v: 5), "k": IdealSwitch(r_on: 0), "a": Inductor(l: "1 mH"), "t": Step(time: "1 ms", before: 1, after: 0), "on": Compare(operator: Greater, constant: 0.5), "g": ElectricalReference,"#,
        r#""t.y -> on.u", "on.y -> k.gate", "u.p <-> k.p", "k.n <-> a.p", "a.n <-> u.n <-> g.p""#,
        &expect![[r#"
            error[block_failed] at network(a): the physical network cannot go on: at 0.001 s the valves (`k`) interrupt the current of an inductance (`a`): connect a freewheeling diode or a resistance in parallel, or give the valve an off-state conductance
        "#]],
    );
}

#[test]
fn start_values_that_contradict_each_other() {
    check(
        r#""a": Inductor(l: "1 mH", i0: "1 A"), "b": Inductor(l: "1 mH", i0: "2 A"), "u": VoltageSource(v: 5), "g": ElectricalReference,"#,
        r#""u.p <-> a.p", "a.n <-> b.p", "b.n <-> u.n <-> g.p""#,
        &expect![[r#"
            error[start_conflict]: the currents at the start do not obey Kirchhoff's law: 1 A have no path
              model.ron:4:5 `"a"` `a` has a current at the start
              model.ron:4:42 `"b"` `b` has a current at the start
              help: leave out `i0` of one of these inductances, or make their start currents add up to zero at every node
        "#]],
    );
    check(
        r#""a": Inertia(j: 1, w0: "1 rad/s"), "b": Inertia(j: 1, w0: "2 rad/s"),"#,
        r#""a.r <-> b.r""#,
        &expect![[r#"
            error[start_conflict]: the speed of 2 rad/s at the start does not fit the parts it is coupled to
              model.ron:4:40 `"b"` `b` asks for it
              model.ron:4:5 `"a"` `a` has a speed at the start, too
              help: give one part of a rigidly coupled train its start speed, or start values that fit the ratios
        "#]],
    );
    // A zero that is written counts; without it `b` turns with `a`.
    check(
        r#""a": Inertia(j: 1, w0: "10 rad/s"), "b": Inertia(j: 1, w0: "0 rad/s"),"#,
        r#""a.r <-> b.r""#,
        &expect![[r#"
            error[start_conflict]: the speed of 0 rad/s at the start does not fit the parts it is coupled to
              model.ron:4:41 `"b"` `b` asks for it
              model.ron:4:5 `"a"` `a` has a speed at the start, too
              help: give one part of a rigidly coupled train its start speed, or start values that fit the ratios
        "#]],
    );
    check(
        r#""a": Inertia(j: 1, w0: "1 rad/s"), "g": SimpleGear(ratio: 3), "b": Inertia(j: 1, w0: "2 rad/s"), "c": Inertia(j: 1, w0: "7 rad/s"),"#,
        r#""a.r <-> g.base", "g.follower <-> b.r""#,
        &expect![[r#"
            error[start_conflict]: the speed of 2 rad/s at the start does not fit the parts it is coupled to
              model.ron:4:67 `"b"` `b` asks for it
              model.ron:4:5 `"a"` `a` has a speed at the start, too
              help: give one part of a rigidly coupled train its start speed, or start values that fit the ratios
        "#]],
    );
    check(
        r#""a": Inertia(j: 1, w0: "1 rad/s"), "h": RotationalReference,"#,
        r#""a.r <-> h.r""#,
        &expect![[r#"
            error[start_conflict]: the speed of 1 rad/s at the start does not fit the parts it is coupled to
              model.ron:4:5 `"a"` `a` asks for it
              help: give one part of a rigidly coupled train its start speed, or start values that fit the ratios
        "#]],
    );
}

#[test]
fn a_worm_that_locks_itself_is_not_driven_backward() {
    // With the wheel told to turn, the worm would have to overcome its bearings, or a damper.
    let [bearings, damped] = [("0.1 N*m", "0"), ("0 N*m", "1")].map(|(bearing, damper)| {
        said(
            &format!(
                r#""w": WormGear(ratio: 40, lead_angle: "3 deg", friction: 0.1, bearing: "{bearing}"), "j": Inertia(j: 1), "d": RotationalDamper(d: {damper}), "a": Constant(value: "1 rad/s"), "t": IdealSpeedSource, "h": RotationalReference,"#
            ),
            r#""j.r <-> w.base <-> d.r", "w.follower <-> t.r", "a.y -> t.w", "t.c <-> d.c <-> h.r""#,
        )
    });
    assert_eq!(bearings, damped);
    expect![[r#"
        error[block_failed] at network(d): the physical network cannot go on: a speed or a load behind `w` drives it backward, but it locks itself and no torque turns it: drive it from its base, or let it give way by a softer coupling or an efficiency backward above 0
    "#]]
    .assert_eq(&bearings);
}

#[test]
fn exact_zeros_are_taken_where_physics_takes_them() {
    let rotating = said(
        r#""j": Inertia(j: 1), "k": Inertia(j: 0), "f": RotationalDamper(d: 0), "x": RotationalFriction(breakaway: 0, coulomb: 0, viscous: 0, breakaway_velocity: 0.1), "g": SimpleGear(ratio: 2), "l": Inertia(j: 0), "w": WormGear(ratio: 40, lead_angle: "10 deg", friction: 0, bearing: 0), "o": Inertia(j: 0), "h": RotationalReference,"#,
        r#""j.r <-> f.r <-> x.r <-> k.r <-> g.base <-> w.base", "f.c <-> x.c <-> h.r", "g.follower <-> l.r", "w.follower <-> o.r""#,
    );
    assert_eq!(rotating, "");
    let sliding = said(
        r#""m": Mass(m: 1), "n": Mass(m: 0), "d": TranslationalDamper(d: 0), "h": TranslationalReference,"#,
        r#""m.r <-> n.r <-> d.r", "d.c <-> h.r""#,
    );
    assert_eq!(sliding, "");
    let electrical = said(
        r#""u": VoltageSource(v: 0), "m": DcMotor(r: 1, l: 0, k: 0, j: 0, damping: 0), "n": DcMotor(r: 0, l: 1, k: 0.1, j: 0), "k": IdealSwitch(r_on: 0, g_off: 0), "d": Diode(v_f: 0, r_on: 0, g_off: 0), "t": Transformer(ratio: 1, l_m: 1, l1: 0, l2: 0.1, r1: 0, r2: 0), "c": MutualInductance(l1: 1, l2: 1, k: 0), "on": Constant(value: 1), "b": Compare(operator: Greater, constant: 0.5), "q": Resistor(r: 1), "y": Resistor(r: 1), "z": Resistor(r: 1), "j": Inertia(j: 1), "g": ElectricalReference, "p": ElectricalReference, "h": RotationalReference,"#,
        r#""on.y -> b.u", "b.y -> k.gate", "u.p <-> k.p", "k.n <-> m.p <-> n.p <-> d.p <-> t.p1 <-> c.p1", "d.n <-> q.p", "u.n <-> m.n <-> n.n <-> q.n <-> t.n1 <-> c.n1 <-> g.p", "t.p2 <-> y.p", "c.p2 <-> z.p", "t.n2 <-> c.n2 <-> y.n <-> z.n <-> p.p", "m.r <-> n.r <-> j.r", "m.c <-> n.c <-> h.r""#,
    );
    assert_eq!(electrical, "");
}

/// The slide of a slider-crank whose position follows from the crank's.
#[test]
fn a_joint_with_limits_starts_where_its_loop_closes() {
    let compiled = |upper: &str| {
        compile_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "0.1 s"),
                blocks: {{
                    "world": World, "drive": RevoluteJoint(axis: [0, -1, 0], position: "60 deg"), "crank": Body(mass: 1, moi: [0.1, 0.1, 0.1]),
                    "arm": Transform(translation: ["0.2 m", "0 m", "0 m"]), "elbow": RevoluteJoint(axis: [0, -1, 0]),
                    "rod": Transform(translation: ["0.5 m", "0 m", "0 m"]), "wrist": RevoluteJoint(axis: [0, -1, 0]),
                    "slide": PrismaticJoint(axis: [1, 0, 0], lower: "0.35 m", upper: "{upper}"), "piston": Body(mass: 2, moi: [0.1, 0.1, 0.1]),
                }},
                connections: [
                    "world.frame <-> drive.base <-> slide.base", "drive.follower <-> crank.frame <-> arm.base", "arm.follower <-> elbow.base", "elbow.follower <-> rod.base",
                    "rod.follower <-> wrist.base", "wrist.follower <-> piston.frame <-> slide.follower",
                ],
            )"#
        ))
    };
    let (fits, problems) = compiled("0.65 m");
    assert!(fits.schedule.is_some(), "{problems}");
    let (beyond, problems) = compiled("0.5 m");
    assert!(beyond.schedule.is_none());
    // 0.2 cos 60 + sqrt(0.5^2 - (0.2 sin 60)^2)
    assert!(problems.contains("`slide` starts at 0.56904157598234"), "{problems}");
    assert!(problems.contains("above its upper limit of 0.5 m"), "{problems}");
}

/// A slider-crank of which more is given than it has freedoms: what the run starts with is named, and closes the loop.
#[test]
fn start_values_that_do_not_close_a_loop_are_named_with_what_is_taken() {
    let compiled = |drive: &str, slide: &str| {
        compile_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "0.1 s"),
                blocks: {{
                    "world": World, "drive": RevoluteJoint(axis: [0, -1, 0], {drive}), "crank": Body(mass: 1, moi: [0.1, 0.1, 0.1]),
                    "arm": Transform(translation: ["0.2 m", "0 m", "0 m"]), "elbow": RevoluteJoint(axis: [0, -1, 0]),
                    "rod": Transform(translation: ["0.5 m", "0 m", "0 m"]), "wrist": RevoluteJoint(axis: [0, -1, 0]),
                    "slide": PrismaticJoint(axis: [1, 0, 0], {slide}), "piston": Body(mass: 2, moi: [0.1, 0.1, 0.1]),
                }},
                connections: [
                    "world.frame <-> drive.base <-> slide.base", "drive.follower <-> crank.frame <-> arm.base", "arm.follower <-> elbow.base", "elbow.follower <-> rod.base",
                    "rod.follower <-> wrist.base", "wrist.follower <-> piston.frame <-> slide.follower",
                ],
            )"#
        ))
    };
    let said = |drive: &str, slide: &str| {
        let (compiled, problems) = compiled(drive, slide);
        assert!(compiled.schedule.is_some(), "{problems}");
        problems.lines().filter(|line| line.contains("start_moved")).map(str::to_owned).collect::<Vec<_>>()
    };
    // Nothing is given twice, or what is given fits to the digits that are written: 0.2 cos q + sqrt(0.5^2 - (0.2 sin q)^2), and its slope.
    assert!(said(r#"position: "60 deg", velocity: 1"#, "").is_empty());
    assert!(said(r#"position: "60 deg", velocity: 1"#, r#"position: 0.569, velocity: -0.210"#).is_empty());
    let numbers = |line: &str| {
        let words = line.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
        words.collect::<Vec<_>>()
    };
    let [drive, slide] = &said(r#"position: "60 deg""#, "position: 0.4")[..] else {
        panic!("two joints move")
    };
    assert!(drive.contains("`drive` starts at") && slide.contains("`slide` starts at"), "{drive} {slide}");
    let (q, x) = (numbers(drive)[0].to_radians(), 1e-3 * numbers(slide)[0]);
    assert_eq!((numbers(drive)[1], numbers(slide)[1]), (60.0, 400.0));
    assert!((0.2 * q.cos() + (0.25 - (0.2 * q.sin()).powi(2)).sqrt() - x).abs() < 1e-4, "{drive} {slide}");
    let fast = said(r#"position: "60 deg", velocity: 1"#, "velocity: 0");
    let [drive, slide] = &fast[..] else { panic!("{fast:?}") };
    let (w, v) = (numbers(drive)[0], numbers(slide)[0]);
    assert_eq!((numbers(drive)[1], numbers(slide)[1]), (1.0, 0.0));
    let q = 60.0_f64.to_radians();
    let slope = -0.2 * q.sin() * (1.0 + 0.2 * q.cos() / (0.25 - (0.2 * q.sin()).powi(2)).sqrt());
    assert!(w > 0.1 && (v - slope * w).abs() < 2e-4, "{drive} {slide}");
}

/// A sensor of torques is rigid: what is joined to its case is held by what is at its rod, whichever way round it is.
#[test]
fn a_case_may_be_joined_to_the_case_of_a_sensor() {
    let ends = |sensor: &str| {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "1 s"),
                blocks: {{
                    "a": Inertia(j: 0.1, w0: 10), "b": Inertia(j: 0.2), "ts": TorqueSensor, "k": Clutch(torque: 5), "n": Constant(value: 0.1),
                    "m": MotionSensor, "h": RotationalReference, "show": Scope(inputs: ["w", "tau"]),
                }},
                connections: ["a.r <-> k.r", {sensor}, "n.y -> k.normal", "b.r <-> m.r", "m.c <-> h.r", "m.w -> show.w", "ts.tau -> show.tau"],
            )"#
        ));
        (run.last("show.w"), run.at("show.tau", 0.1))
    };
    let ((w, tau), (turned, other)) =
        (ends(r#""k.c <-> ts.r", "ts.c <-> b.r""#), ends(r#""k.c <-> ts.c", "ts.r <-> b.r""#));
    // 0.5 N*m turn the load until both have one speed.
    assert!((w - 0.5 / 0.2).abs() < 1e-9 && (turned - w).abs() < 1e-9, "{w} {turned}");
    assert!((tau.abs() - 0.5).abs() < 1e-9 && (other + tau).abs() < 1e-9, "{tau} {other}");
}

/// On a differential `left + right = 2 drive / ratio`: with a source at the drive one of the wheels has a speed of its own at the start,
/// whichever it is; `names` change the order in which the network takes them.
#[test]
fn a_start_speed_beside_a_source_is_that_of_its_part() {
    for (left, right, names) in [("3", "-1"), ("0", "2")].into_iter().flat_map(|(left, right)| {
        [(left, "", ["a", "b"]), ("", right, ["a", "b"]), ("", right, ["b", "a"]), (left, "", ["b", "a"])]
    }) {
        let wheel = |w0: &str| match w0 {
            "" => r#"Inertia(j: "0.1 kg*m^2")"#.to_owned(),
            w0 => format!(r#"Inertia(j: "0.1 kg*m^2", w0: "{w0} rad/s")"#),
        };
        let [a, b] = names;
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "0.1 s"),
                blocks: {{
                    "gear": Differential(ratio: 4.1), "w": Constant(value: "4.1 rad/s"), "source": IdealSpeedSource,
                    "housing": RotationalReference, "{a}": {}, "{b}": {},
                    "left": MotionSensor, "right": MotionSensor, "show": Scope(inputs: ["left", "right"]),
                }},
                connections: [
                    "w.y -> source.w", "source.r <-> gear.drive", "gear.left <-> {a}.r <-> left.r",
                    "gear.right <-> {b}.r <-> right.r", "source.c <-> housing.r <-> left.c <-> right.c",
                    "left.w -> show.left", "right.w -> show.right",
                ],
            )"#,
            wheel(left),
            wheel(right)
        ));
        let (l, r) = (run.column("show.left")[0], run.column("show.right")[0]);
        for (given, found) in [(left, l), (right, r)] {
            assert!(
                given.parse::<f64>().is_ok_and(|given| (found - given).abs() < 1e-12) || given.is_empty()
            );
        }
        assert!((l + r - 2.0).abs() < 1e-12, "{left}/{right} {names:?}: {l}, {r}");
    }
}

/// What a source prescribes is not given for the start: with two wheels it depends on the source whether they fit.
#[test]
fn start_speeds_that_follow_from_a_source() {
    let source =
        r#""w": Constant(value: "4.1 rad/s"), "source": IdealSpeedSource, "housing": RotationalReference,"#;
    check(
        &format!(r#"{source} "a": Inertia(j: 1, w0: "4.1 rad/s"),"#),
        r#""w.y -> source.w", "source.r <-> a.r", "source.c <-> housing.r""#,
        &expect![[r#"
            error[start_conflict]: the speed of 4.1 rad/s at the start follows from a source that prescribes speeds
              model.ron:4:100 `"a"` `a` asks for it
              help: leave it out; where it follows from the start speed of another part as well, give one of the two
        "#]],
    );
    check(
        &format!(
            r#"{source} "gear": Differential(ratio: 4.1), "a": Inertia(j: 1, w0: "3 rad/s"), "b": Inertia(j: 1, w0: "-1 rad/s"),"#
        ),
        r#""w.y -> source.w", "source.r <-> gear.drive", "gear.left <-> a.r", "gear.right <-> b.r", "source.c <-> housing.r""#,
        &expect![[r#"
            error[start_conflict]: the speed of -1 rad/s at the start follows from a source that prescribes speeds
              model.ron:4:169 `"b"` `b` asks for it
              model.ron:4:134 `"a"` `a` has a speed at the start, too
              help: leave it out; where it follows from the start speed of another part as well, give one of the two
        "#]],
    );
    check(
        &format!(
            r#"{source} "world": World, "j": RevoluteJoint(velocity: "1 rad/s"), "arm": Body(mass: 1, moi: [0.1, 0.1, 0.1]),"#
        ),
        r#""w.y -> source.w", "source.r <-> j.r", "source.c <-> housing.r <-> j.c", "world.frame <-> j.base", "j.follower <-> arm.frame""#,
        &expect![[r#"
            warning[start_moved]: the start speed of `j` has no effect: a source prescribes how fast this joint moves
              model.ron:4:116 `"j"` `j` moves as the source does
              help: leave it out: the joint begins as the source does
        "#]],
    );
}
