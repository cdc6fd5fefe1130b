//! Networks of every kind of element keep their energy: mechanisms, gears, friction, prescribed motions, inverters.
//! The diagrams of the project and those of the circuits are held elsewhere.

use std::path::Path;

use blocksim_block::schedule::VariableMethod;
use blocksim_tests::accounts::{imbalance, solved_by, with_accounts};
use blocksim_tests::run;

/// Asserts that a network of these blocks keeps its energy to a millionth of what it turns over.
#[track_caller]
fn balances(stop: &str, blocks: &str, connections: &str) {
    let text = format!(
        r#"Diagram(simulation: (stop_time: "{stop}"), blocks: {{ {blocks} }}, connections: [ {connections} ])"#
    );
    let path = Path::new("model.ron");
    let schedule = with_accounts(path, path, &text, &[]).expect("a network");
    // RosW3 has order three: what Ode45 reaches would take it too many steps.
    for (method, tolerance, allowed) in
        [(VariableMethod::Ode45, 1e-9, 1e-6), (VariableMethod::RosW3, 1e-7, 1e-4)]
    {
        let run = run(solved_by(schedule.clone(), method, tolerance));
        let found = imbalance(&run);
        assert!(found <= allowed, "{found:e} of the energy turned over is missing with {method:?}: {blocks}");
    }
}

const PUSHED: &str = r#""sine": Sine(amplitude: "3 N*m", frequency: "1 Hz"), "push": IdealTorqueSource,
    "wall": RotationalReference, "disc": Inertia(j: "0.02 kg*m^2", w0: "1 rad/s")"#;

const TO_DISC: &str =
    r#""sine.y -> push.tau", "push.c <-> wall.r <-> part.c", "push.r <-> disc.r <-> part.r""#;

/// Between a disc that a torque swings and a wall.
#[test]
fn whatever_brakes_a_disc_or_springs_back() {
    for part in [
        "RotationalDamper(d: 0.2)",
        "RotationalSpring(k: 20.0)",
        "RotationalSpringDamper(k: 20.0, d: 0.1)",
        "RotationalSpringDamper(k: 200.0, d: 0.1, backlash: 0.2, transition: 0.1)",
        "RotationalHardStop(lower: -0.3, upper: 0.2, stiffness: 1e3, damping: 2.0, transition: 0.01)",
        "RotationalFriction(breakaway: 1.2, breakaway_velocity: 0.3, coulomb: 1.0, viscous: 0.02)",
        "RotationalFriction(breakaway: 1.2, breakaway_velocity: 0.3, coulomb: 1.0, model: Stiction)",
        "LuGreFriction(coulomb: 1.0, breakaway: 1.3, stribeck_velocity: 0.1, sigma0: 500.0, sigma1: 1.0)",
        "QuadraticLoad(torque: 1.0, speed: 10.0)",
        "OneWayClutch(d: 1.0, transition: 0.3, model: Smooth)",
        "OneWayClutch(model: Stiction)",
        "ConstantTorque(tau: -0.5)",
    ] {
        balances("2 s", &format!(r#"{PUSHED}, "part": {part}"#), TO_DISC);
    }
}

/// Gears with every law of losses between the same disc and a load, which drives and is driven.
#[test]
fn whatever_a_mesh_loses() {
    for gear in [
        "SimpleGear(ratio: 5, efficiency: 0.8)",
        "SimpleGear(ratio: 5, efficiency: 0.8, loss: Published, power_threshold: 1.0)",
        "SimpleGear(ratio: 5, efficiency: 0.8, loss: Stiction)",
        "CycloidalDrive(disc_teeth: 20, ring_teeth: 21, efficiency_forward: 0.8, efficiency_backward: 0.7)",
        "LossyGear(ratio: 5, losses: [(0.0, 0.8, 0.7, 0.05, 0.05), (100.0, 0.9, 0.8, 0.1, 0.1)])",
        "ElasticGear(ratio: 5, k: 50.0, d: 0.5, backlash: 0.05, transition: 0.05, efficiency_forward: 0.9)",
    ] {
        balances(
            "1.5 s",
            &format!(
                r#"{PUSHED}, "gear": {gear}, "load": Inertia(j: "0.5 kg*m^2"), "spring": RotationalSpring(k: 10.0)"#
            ),
            r#""sine.y -> push.tau", "push.c <-> wall.r <-> spring.c", "push.r <-> disc.r <-> gear.base",
               "gear.follower <-> load.r <-> spring.r""#,
        );
    }
}

#[test]
fn prescribed_speeds_and_angles_are_booked_by_the_torque_that_they_need() {
    balances(
        "2 s",
        r#""w": Sine(amplitude: "5 rad/s", frequency: "1 Hz"),
           "dw": Sine(amplitude: "31.41592653589793 rad/s^2", frequency: "1 Hz", phase: "90 deg"), "drive": IdealSpeedSource,
           "disc": Inertia(j: "0.1 kg*m^2"), "spring": RotationalSpringDamper(k: 20.0, d: 0.1),
           "load": Inertia(j: "0.2 kg*m^2"), "wall": RotationalReference"#,
        r#""w.y -> drive.w", "dw.y -> drive.dw", "drive.c <-> wall.r", "drive.r <-> disc.r <-> spring.r",
           "spring.c <-> load.r""#,
    );
    balances(
        "2 s",
        r#""phi": Sine(amplitude: "0.5 rad", frequency: "1 Hz"), "drive": IdealAngleSource(f: "20 Hz"),
           "wall": RotationalReference, "world": World, "pivot": RevoluteJoint(axis: [0.0, 1.0, 0.0]),
           "rod": Body(mass: "1 kg", com: [0.5, 0.0, 0.0], moi: [0.0, 0.1, 0.1]),
           "end": Transform(translation: [1.0, 0.0, 0.0]), "elbow": RevoluteJoint(axis: [0.0, 1.0, 0.0]),
           "lower": Body(mass: "1 kg", com: [0.5, 0.0, 0.0], moi: [0.0, 0.1, 0.1])"#,
        r#""phi.y -> drive.phi", "drive.c <-> wall.r <-> pivot.c", "drive.r <-> pivot.r", "world.frame <-> pivot.base",
           "pivot.follower <-> rod.frame <-> end.base", "end.follower <-> elbow.base",
           "elbow.follower <-> lower.frame""#,
    );
}

#[test]
fn planetary_gears_differentials_and_clutches() {
    for losses in ["", ", efficiency: 0.9", ", efficiency: 0.9, loss: Stiction"] {
        planets(losses);
        balances(
            "2 s",
            &format!(
                r#""sine": Sine(amplitude: "3 N*m", frequency: "1 Hz"), "push": IdealTorqueSource, "wall": RotationalReference,
                   "axle": Differential(ratio: 3, inner_efficiency: 0.7{losses}), "a": Inertia(j: "0.02 kg*m^2"),
                   "b": Inertia(j: "0.5 kg*m^2"), "c": Inertia(j: "0.1 kg*m^2"), "drag": RotationalDamper(d: 0.1)"#
            ),
            r#""sine.y -> push.tau", "push.c <-> wall.r <-> drag.c", "push.r <-> a.r <-> axle.drive",
               "axle.left <-> b.r <-> drag.r", "axle.right <-> c.r""#,
        );
    }
}

fn planets(losses: &str) {
    let blocks = format!(
        r#""sine": Sine(amplitude: "3 N*m", frequency: "1 Hz"), "push": IdealTorqueSource, "wall": RotationalReference,
           "planets": PlanetaryGear(ring_teeth: 60, sun_teeth: 20{losses}), "a": Inertia(j: "0.02 kg*m^2"), "b": Inertia(j: "0.05 kg*m^2"),
           "c": Inertia(j: "0.1 kg*m^2"), "brake": Brake(torque: "2 N*m", model: Stiction), "on": Pulse(period: "0.6 s", width: 0.5),
           "drag": RotationalDamper(d: 0.1)"#
    );
    balances(
        "2 s",
        &blocks,
        r#""sine.y -> push.tau", "push.c <-> wall.r <-> brake.c <-> drag.c", "push.r <-> a.r <-> planets.sun",
           "planets.carrier <-> b.r <-> drag.r", "planets.ring <-> c.r <-> brake.r", "on.y -> brake.engaged""#,
    );
}

#[test]
fn what_slides_rolls_and_screws() {
    balances(
        "2 s",
        r#""sine": Sine(amplitude: "3 N*m", frequency: "1 Hz"), "push": IdealTorqueSource, "wall": RotationalReference,
           "shaft": Inertia(j: "1e-3 kg*m^2"), "rack": RackAndPinion(radius: "5 cm", efficiency: 0.9),
           "sledge": Mass(m: "2 kg"), "guide": TranslationalFriction(breakaway: 6.0, breakaway_velocity: 0.01, coulomb: 5.0, model: Stiction),
           "stop": TranslationalHardStop(lower: -0.2, upper: 0.3, stiffness: 1e4, transition: 1e-3),
           "spring": TranslationalSpringDamper(k: 100.0, d: 2.0), "bed": TranslationalReference,
           "weight": ConstantForce(f: -5.0)"#,
        r#""sine.y -> push.tau", "push.c <-> wall.r", "push.r <-> shaft.r <-> rack.base",
           "rack.follower <-> sledge.r <-> guide.r <-> stop.r <-> spring.r <-> weight.r",
           "guide.c <-> stop.c <-> spring.c <-> weight.c <-> bed.r""#,
    );
}

const ROD: &str = r#""rod": Body(mass: "2 kg", com: [0.3, 0.1, -0.2], moi: [0.2, 0.3, 0.25], poi: [0.01, -0.02, 0.03]),
    "world": World"#;

/// A heavy body on every joint, and the joint the other way round.
#[test]
fn a_body_on_every_joint() {
    for joint in [
        r#"RevoluteJoint(axis: [1.0, 1.0, 0.0], stiffness: 3.0, damping: 0.1, lower: -1.0, limit_stiffness: 500.0, limit_damping: 5.0, limit_transition: 0.05)"#,
        r#"PrismaticJoint(axis: [0.0, 0.3, 1.0], stiffness: 200.0, damping: 1.0, velocity: 1.0)"#,
        r#"CylindricalJoint(axis: [0.0, 0.3, 1.0], slide_stiffness: 200.0, turn_stiffness: 5.0, turn_damping: 0.2)"#,
        r#"PlanarJoint(slide_stiffness: 50.0, slide_damping: 1.0, turn_stiffness: 3.0, velocity: [1.0, 0.5], speed: 2.0)"#,
        r#"UniversalJoint(stiffness: 2.0, damping: 0.1)"#,
        r#"SphericalJoint(damping: 0.1, stiffness: 1.0, velocity: [1.0, -0.5, 2.0])"#,
        r#"FreeJoint(velocity: [1.0, 2.0, 3.0], spin: [0.5, 3.0, 1.0])"#,
    ] {
        let blocks = format!(r#"{ROD}, "joint": {joint}"#);
        balances("2 s", &blocks, r#""world.frame <-> joint.base", "joint.follower <-> rod.frame""#);
        balances("2 s", &blocks, r#""world.frame <-> joint.follower", "joint.base <-> rod.frame""#);
    }
}

#[test]
fn forces_on_frames_and_contacts() {
    balances(
        "2 s",
        &format!(
            r#"{ROD}, "joint": SphericalJoint(velocity: [1.0, -0.5, 2.0]), "seat": Transform(translation: [1.0, 0.0, 0.5]),
               "tip": Transform(translation: [0.6, 0.0, 0.0]), "pull": FrameSpringDamper(stiffness: 30.0, damping: 1.0, length: 0.2),
               "force": ExternalForce(axes: Frame), "wind": Sine(amplitude: "2 N", frequency: "1 Hz"), "axes": Mux(inputs: 3)"#
        ),
        r#""world.frame <-> joint.base <-> seat.base", "joint.follower <-> rod.frame <-> tip.base",
           "seat.follower <-> pull.base", "tip.follower <-> pull.follower <-> force.frame", "wind.y -> axes.u1", "wind.y -> axes.u2",
           "wind.y -> axes.u3", "axes.y -> force.force""#,
    );
    balances(
        "2 s",
        r#""ball": Body(mass: "1 kg", moi: [0.1, 0.1, 0.1]), "world": World, "edge": Transform(translation: [0.1, 0.0, -0.1]),
           "joint": FreeJoint(position: [0.0, 0.0, 0.6], velocity: [1.0, 0.0, 0.0], spin: [0.0, 1.0, 0.5]),
           "floor": PointPlaneContact(stiffness: 1e4, damping: 30.0, transition: 1e-2, friction: 0.4, threshold: 0.1)"#,
        r#""world.frame <-> joint.base <-> floor.base", "joint.follower <-> ball.frame <-> edge.base",
           "edge.follower <-> floor.follower""#,
    );
}

/// A machine behind every inverter: the switching one with its circuit inside and outside of the account.
#[test]
fn machines_behind_inverters() {
    for inverter in [
        r#"AveragedInverter(vdc: "560 V")"#,
        r#"SwitchedInverter(vdc: "560 V", switching_frequency: "2 kHz")"#,
        r#"SwitchedInverter(vdc: "560 V", switching_frequency: "2 kHz", integration: Separate(periods: 1))"#,
    ] {
        balances(
            "0.2 s",
            &format!(
                r#""drive": {inverter}, "v": Constant(value: "250 V"), "f": Constant(value: "40 Hz"),
                   "machine": PermanentMagnetMachine(pole_pairs: 3, r_s: 0.5, l_d: 8e-3, l_q: 12e-3, flux: 0.3),
                   "rotor": Inertia(j: "0.01 kg*m^2", w0: "80 rad/s"), "load": RotationalDamper(d: 0.02), "wall": RotationalReference"#
            ),
            r#""v.y -> drive.v", "f.y -> drive.f", "drive.ac <-> machine.ac", "machine.r <-> rotor.r <-> load.r",
               "machine.c <-> load.c <-> wall.r""#,
        );
    }
}

/// A crank and a slider: a closed loop of joints.
const SLIDER_CRANK: &str = r#""world": World, "crank": RevoluteJoint(axis: [0.0, -1.0, 0.0], position: "0.5 rad"),
    "wheel": Body(mass: "1 kg", com: [0.02, 0.0, 0.0], moi: [0.1, 0.2, 0.1]), "throw": Transform(translation: [0.1, 0.0, 0.0]),
    "pin": RevoluteJoint(axis: [0.0, -1.0, 0.0]), "rod": Body(mass: "0.5 kg", com: [0.15, 0.0, 0.0], moi: [0.0, 0.004, 0.004]),
    "far": Transform(translation: [0.3, 0.0, 0.0]), "wrist": RevoluteJoint(axis: [0.0, -1.0, 0.0]),
    "slide": PrismaticJoint(axis: [1.0, 0.0, 0.0], position: "0.35 m", stiffness: 20.0), "piston": Body(mass: "0.4 kg"),
    "wall": RotationalReference, "bed": TranslationalReference"#;

const CLOSED: &str = r#""world.frame <-> crank.base <-> slide.base", "crank.follower <-> wheel.frame <-> throw.base",
    "throw.follower <-> pin.base", "pin.follower <-> rod.frame <-> far.base", "far.follower <-> wrist.base",
    "wrist.follower <-> slide.follower <-> piston.frame""#;

#[test]
fn closed_loops_that_are_driven_braked_or_prescribed() {
    let wires = r#""sine.y -> push.tau", "push.r <-> rotor.r <-> gear.base", "gear.follower <-> crank.r",
        "push.c <-> crank.c <-> wall.r", "slide.r <-> guide.r", "slide.c <-> guide.c <-> bed.r""#;
    for (mesh, friction) in [
        ("", ""),
        ("", ", model: Stiction"),
        (", loss: Stiction", ""),
        (", loss: Stiction", ", model: Stiction"),
    ] {
        let motor = format!(
            r#""sine": Sine(amplitude: "20 N*m", frequency: "0.7 Hz"), "push": IdealTorqueSource,
                "gear": SimpleGear(ratio: 5, efficiency: 0.8{mesh}), "rotor": Inertia(j: "0.01 kg*m^2"),
                "guide": TranslationalFriction(breakaway: 12.0, breakaway_velocity: 0.01, coulomb: 10.0{friction})"#
        );
        balances("2 s", &format!("{SLIDER_CRANK}, {motor}"), &format!("{CLOSED}, {wires}"));
    }

    let prescribed =
        r#""phi": Ramp(slope: "6 rad/s", start: "0.2 s"), "source": IdealAngleSource(f: "5 Hz")"#;
    let wires = r#""phi.y -> source.phi", "source.r <-> crank.r", "source.c <-> crank.c <-> wall.r",
        "slide.c <-> bed.r""#;
    balances("2 s", &format!("{SLIDER_CRANK}, {prescribed}"), &format!("{CLOSED}, {wires}"));
}

/// What holds the loop closed takes a little power where its ends drift, and that is booked.
#[test]
fn a_four_bar_linkage_keeps_its_energy_for_ten_seconds() {
    let path = blocksim_tests::root().join("diagrams/four_bar.ron");
    let text = std::fs::read_to_string(&path).expect("a diagram");
    let mut schedule = with_accounts(&path, &path, &text, &[]).expect("a network");
    schedule.settings.stop_time = 10.0;
    for (tolerance, allowed) in [(1e-11, 1e-9), (1e-7, 1e-5)] {
        let found = imbalance(&run(solved_by(schedule.clone(), VariableMethod::Ode45, tolerance)));
        assert!(found <= allowed, "{found:e} of the energy turned over is missing at {tolerance:e}");
    }
}

/// Two motors, one of them prescribed, that move two joints together through differentials.
#[test]
fn a_wrist_with_coupled_joints() {
    balances(
        "2 s",
        r#""sine": Sine(amplitude: "2 N*m", frequency: "1 Hz"), "push": IdealTorqueSource, "phi": Sine(amplitude: "0.5 rad", frequency: "0.6 Hz"),
           "turn": IdealAngleSource(f: "10 Hz"), "motor_a": Inertia(j: 0.02), "motor_b": Inertia(j: 0.02), "sum": Differential,
           "difference": Differential, "reverse": SimpleGear(ratio: 1.0), "world": World,
           "pitch": RevoluteJoint(axis: [0.0, 1.0, 0.0], position: "0.8 rad"), "roll": RevoluteJoint(axis: [1.0, 0.0, 0.0], position: "0.3 rad"),
           "palm": Body(mass: "0.5 kg", com: [0.1, 0.0, 0.0], moi: [2e-3, 2e-3, 2e-3]),
           "hand": Body(mass: "1 kg", com: [0.2, 0.05, 0.0], moi: [4e-3, 3e-3, 3e-3]), "frame": RotationalReference"#,
        r#""sine.y -> push.tau", "phi.y -> turn.phi", "sum.drive <-> pitch.r", "reverse.follower <-> difference.right",
           "difference.drive <-> roll.r", "world.frame <-> pitch.base", "pitch.follower <-> palm.frame <-> roll.base",
           "roll.follower <-> hand.frame", "push.r <-> motor_a.r <-> sum.left <-> difference.left",
           "turn.r <-> motor_b.r <-> sum.right <-> reverse.base",
           "push.c <-> turn.c <-> pitch.c <-> roll.c <-> frame.r""#,
    );
}
