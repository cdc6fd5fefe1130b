//! What is said about networks that cannot work.

use crate::plant::assembled;

/// All problems of a network as lines: code, message, the members by path with their part in it, help.
fn told(blocks: &[(&str, &str)], connections: &[&str]) -> Vec<String> {
    let mut paths: Vec<&str> = blocks.iter().map(|(path, _)| *path).collect();
    paths.sort_unstable();
    let problems = match assembled(blocks, connections) {
        Ok(_) => return vec!["no problem".to_owned()],
        Err(problems) => problems,
    };
    let mut lines = Vec::new();
    for problem in problems {
        lines.push(format!("{}: {}", problem.code, problem.message));
        lines.extend(problem.members.iter().map(|(member, role)| format!("  {}: {role}", paths[*member])));
        lines.push(format!("  help: {}", problem.help));
    }
    lines
}

#[test]
fn a_circuit_without_reference() {
    let text = told(
        &[("source", "VoltageSource(v: 1.0)"), ("meter", "VoltageSensor")],
        &["source.p <-> meter.p", "source.n <-> meter.n"],
    );
    assert_eq!(
        text,
        [
            "missing_reference: this electrical network has no reference",
            "  source: belongs to it",
            "  help: add an ElectricalReference and connect it to one of the nodes",
        ]
    );
}

#[test]
fn a_floating_pin() {
    let text = told(
        &[("source", "VoltageSource(v: 1.0)"), ("ground", "ElectricalReference"), ("meter", "VoltageSensor")],
        &["source.n <-> ground.p", "source.p <-> meter.p"],
    );
    assert_eq!(
        text,
        [
            "unconnected_port: the electrical port `meter.n` is not connected",
            "  meter: has this port",
            "  help: connect it with `<->`",
        ]
    );
}

#[test]
fn a_node_that_nothing_feeds() {
    let text = told(
        &[
            ("source", "VoltageSource(v: 1.0)"),
            ("ground", "ElectricalReference"),
            ("a", "VoltageSensor"),
            ("b", "VoltageSensor"),
        ],
        &["source.n <-> ground.p <-> a.n <-> b.n", "a.p <-> b.p", "source.p <-> a.p"],
    );
    assert_eq!(
        text,
        [
            "floating_node: nothing determines the potential at `a.p`",
            "  a: is connected to it",
            "  help: connect it to a source or to a reference",
        ]
    );
}

#[test]
fn two_voltage_sources_in_parallel() {
    let text = told(
        &[
            ("a", "VoltageSource(v: 1.0)"),
            ("b", "ControlledVoltageSource"),
            ("ground", "ElectricalReference"),
        ],
        &["a.p <-> b.p", "a.n <-> b.n <-> ground.p"],
    );
    assert_eq!(
        text,
        [
            "voltage_conflict: two parts prescribe the same voltage",
            "  b: prescribes the voltage",
            "  a: prescribes the voltage",
            "  help: remove one of them, or connect them through a resistance",
        ]
    );
}

#[test]
fn two_ammeters_in_parallel() {
    let text = told(
        &[
            ("source", "VoltageSource(v: 1.0)"),
            ("a", "CurrentSensor"),
            ("b", "CurrentSensor"),
            ("motor", "DcMotor(r: 1.0, l: 1e-3, k: 0.1, j: 1e-4)"),
            ("ground", "ElectricalReference"),
            ("frame", "RotationalReference"),
        ],
        &[
            "source.p <-> a.p <-> b.p",
            "a.n <-> b.n <-> motor.p",
            "source.n <-> motor.n <-> ground.p",
            "motor.c <-> frame.r",
        ],
    );
    assert_eq!(
        text,
        [
            "indeterminate_current: wires close a loop without resistance: how the current divides cannot be known",
            "  b: is a wire",
            "  a: is a wire",
            "  source: prescribes the voltage",
            "  help: remove one of the parallel sensors or references",
        ]
    );
}

#[test]
fn a_machine_without_supply() {
    let machine = "AsynchronousMachine(rated_power: 15e3, rated_voltage: 220.0, rated_frequency: 60.0, \
                   pole_pairs: 1, r_s: 0.25, x_ls: 0.9, r_r: 0.14, x_lr: 0.41, x_m: 17.0)";
    let text = told(
        &[("machine", machine), ("rotor", "Inertia(j: 0.1)"), ("frame", "RotationalReference")],
        &["machine.r <-> rotor.r", "machine.c <-> frame.r"],
    );
    assert_eq!(
        text,
        [
            "unconnected_port: the three-phase port `machine.ac` is not connected",
            "  machine: has this port",
            "  help: connect it with `<->`",
        ]
    );
}

#[test]
fn two_mains_in_parallel() {
    let text = told(
        &[
            ("a", "ThreePhaseSource(voltage: 400.0, frequency: 50.0)"),
            ("b", "ThreePhaseSource(voltage: 400.0, frequency: 50.0)"),
        ],
        &["a.ac <-> b.ac"],
    );
    assert_eq!(
        text,
        [
            "voltage_conflict: two parts prescribe the same voltage",
            "  b: prescribes the voltage",
            "  a: prescribes the voltage",
            "  help: remove one of them, or connect them through a resistance",
        ]
    );
}

#[test]
fn a_shaft_without_inertia() {
    let text = told(
        &[
            ("motor", "IdealTorqueSource"),
            ("oil", "RotationalDamper(d: 1.0)"),
            ("frame", "RotationalReference"),
        ],
        &["motor.r <-> oil.r", "motor.c <-> oil.c <-> frame.r"],
    );
    assert_eq!(
        text,
        [
            "no_inertia: nothing at `motor.r` has inertia or a given speed, so its acceleration is unknown",
            "  motor: `r` is connected to it",
            "  oil: `r` is connected to it",
            "  help: add an Inertia there, or couple the node to something that has one",
        ]
    );
}

#[test]
fn a_shaft_without_reference() {
    let text = told(
        &[("motor", "IdealTorqueSource"), ("disc", "Inertia(j: 1.0)"), ("oil", "RotationalDamper(d: 1.0)")],
        &["motor.r <-> disc.r <-> oil.r", "motor.c <-> oil.c"],
    );
    assert_eq!(
        text,
        [
            "missing_reference: nothing at `motor.c` has inertia or a given speed, so its acceleration is unknown",
            "  motor: `c` is connected to it",
            "  oil: `c` is connected to it",
            "  help: this network has no RotationalReference: connect one to the cases, or add an Inertia there",
        ]
    );
}

#[test]
fn two_speed_sources_that_fight() {
    let text = told(
        &[
            ("a", "IdealSpeedSource"),
            ("b", "IdealSpeedSource"),
            ("gear", "SimpleGear(ratio: 5.0)"),
            ("frame", "RotationalReference"),
        ],
        &["a.r <-> gear.base", "b.r <-> gear.follower", "a.c <-> b.c <-> frame.r"],
    );
    assert_eq!(
        text,
        [
            "speed_conflict: two parts prescribe the same speed",
            "  gear: couples these speeds",
            "  a: prescribes the speed",
            "  b: prescribes the speed",
            "  help: remove one of them, or put a spring, a damper or a clutch between them",
        ]
    );
}

#[test]
fn two_gears_in_parallel() {
    let text = told(
        &[
            ("a", "SimpleGear(ratio: 5.0)"),
            ("b", "SimpleGear(ratio: 5.0)"),
            ("motor", "Inertia(j: 0.1)"),
            ("load", "Inertia(j: 0.1)"),
        ],
        &["motor.r <-> a.base <-> b.base", "load.r <-> a.follower <-> b.follower"],
    );
    assert_eq!(
        text,
        [
            "indeterminate_torque: this coupling is rigid twice over: how the load divides cannot be known",
            "  b: couples these speeds",
            "  a: couples these speeds",
            "  help: remove one of the couplings, or make one of them elastic with a spring",
        ]
    );
}

#[test]
fn a_mechanism_without_world() {
    let text = told(
        &[("joint", "RevoluteJoint()"), ("bob", "Body(mass: 1.0, moi: (0.1, 0.1, 0.1))")],
        &["joint.follower <-> bob.frame"],
    );
    assert_eq!(
        text,
        [
            "missing_reference: this mechanism has no World",
            "  bob: belongs to it",
            "  help: add a World and connect its frame to the first body or joint",
        ]
    );
}

#[test]
fn a_body_that_no_mass_distribution_has() {
    let text = told(
        &[("world", "World"), ("joint", "RevoluteJoint()"), ("bob", "Body(mass: 1.0, moi: (0.1, 0.1, 0.3))")],
        &["world.frame <-> joint.base", "joint.follower <-> bob.frame"],
    );
    assert_eq!(
        text,
        [
            "parameter: no rigid body has the principal moments 0.100000, 0.100000 and 0.300000 kg m²: \
             the largest must not exceed the sum of the others; is the tensor about the centre of mass, with products \
             of the right sign?",
            "  bob: has them",
            "  help: correct the mass properties, the axis or the placement",
        ]
    );
}

#[test]
fn a_joint_that_moves_nothing() {
    let text = told(&[("world", "World"), ("joint", "RevoluteJoint()")], &["world.frame <-> joint.base"]);
    assert_eq!(
        text,
        [
            "no_inertia: the mass matrix is not positive definite: `joint.w` moves 0 kg*m^2",
            "  joint: moves too little",
            "  help: give the bodies behind it mass, or couple an Inertia to its drive side",
        ]
    );
}

#[test]
fn two_worlds_in_one_mechanism() {
    let text = told(
        &[("earth", "World"), ("moon", "World"), ("a", "RevoluteJoint()"), ("bar", "Body(mass: 1.0)")],
        &["earth.frame <-> a.base", "a.follower <-> moon.frame <-> bar.frame"],
    );
    assert_eq!(
        text,
        [
            "closed_loop: this mechanism has two worlds",
            "  moon: is the second",
            "  earth: is the first",
            "  help: keep one World and connect to it",
        ]
    );
}

#[test]
fn start_speeds_that_contradict_each_other() {
    let text = told(
        &[
            ("gear", "SimpleGear(ratio: 5.0, direction: Same)"),
            ("motor", "Inertia(j: 0.1, w0: 10.0)"),
            ("load", "Inertia(j: 0.1, w0: 1.0)"),
        ],
        &["motor.r <-> gear.base", "load.r <-> gear.follower"],
    );
    assert_eq!(
        text,
        [
            "start_conflict: the speed of 10 rad/s at the start does not fit the parts it is coupled to",
            "  motor: asks for it",
            "  load: has a speed at the start, too",
            "  help: give one part of a rigidly coupled train its start speed, or start values that fit the ratios",
        ]
    );
}

#[test]
fn parts_that_slide_are_told_of_mass_and_their_own_reference() {
    let (push, damper) = (("push", "IdealForceSource"), ("damper", "TranslationalDamper(d: 1.0)"));
    let text = told(
        &[push, damper, ("bed", "TranslationalReference")],
        &["push.r <-> damper.r", "push.c <-> damper.c <-> bed.r"],
    );
    assert_eq!(
        text,
        [
            "no_inertia: nothing at `push.r` has mass or a given speed, so its acceleration is unknown",
            "  push: `r` is connected to it",
            "  damper: `r` is connected to it",
            "  help: add a Mass there, or couple the node to something that has one",
        ]
    );
    // The housing of a pinion is no bed.
    let text = told(
        &[
            push,
            ("rotor", "Inertia(j: 1.0)"),
            ("rack", "RackAndPinion(radius: 0.1)"),
            ("housing", "RotationalReference"),
            ("damper", "RotationalDamper(d: 1.0)"),
        ],
        &["rotor.r <-> rack.base <-> damper.r", "damper.c <-> housing.r", "push.r <-> rack.follower"],
    );
    assert_eq!(
        text,
        [
            "unconnected_port: the translational port `push.c` is not connected",
            "  push: has this port",
            "  help: connect it; a case goes to a TranslationalReference",
        ]
    );
    let text = told(
        &[
            push,
            damper,
            ("mass", "Mass(m: 1.0)"),
            ("rack", "RackAndPinion(radius: 0.1)"),
            ("housing", "RotationalReference"),
            ("oil", "RotationalDamper(d: 1.0)"),
        ],
        &[
            "rack.base <-> oil.r",
            "oil.c <-> housing.r",
            "push.r <-> mass.r <-> damper.r <-> rack.follower",
            "push.c <-> damper.c",
        ],
    );
    assert_eq!(
        text[..1],
        ["missing_reference: nothing at `push.c` has mass or a given speed, so its acceleration is unknown"]
    );
    assert!(text.last().is_some_and(|help| help.contains("no TranslationalReference")), "{text:?}");
    let text = told(
        &[
            ("axle", "Inertia(j: 1.0, w0: 10.0)"),
            ("rack", "RackAndPinion(radius: 0.5)"),
            ("mass", "Mass(m: 1.0, v0: 3.0)"),
        ],
        &["axle.r <-> rack.base", "mass.r <-> rack.follower"],
    );
    assert_eq!(
        text[0],
        "start_conflict: the speed of 3 m/s at the start does not fit the parts it is coupled to"
    );
}
