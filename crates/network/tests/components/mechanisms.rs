//! Bodies and joints, alone and with drives.

use std::f64::consts::{PI, TAU};

use blocksim_multibody::{Inertia, Joint, ModelBuilder, Placement, aba};

use crate::plant::{Plant, close};

const G: f64 = 9.80665;

/// A pendulum of 2 kg whose centre of mass hangs 0.4 m below the axis; 0.05 kg*m^2 about that centre.
fn pendulum(joint: &str) -> Plant {
    Plant::new(
        &[
            ("world", "World"),
            ("joint", joint),
            ("bob", "Body(mass: 2.0, com: (0.0, 0.0, -0.4), moi: (0.05, 0.05, 0.01))"),
        ],
        &["world.frame <-> joint.base", "joint.follower <-> bob.frame"],
    )
}

const INERTIA: f64 = 0.05 + 2.0 * 0.4 * 0.4;

/// Arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

#[test]
fn a_pendulum_has_the_period_of_the_elliptic_integral() {
    let omega = (2.0 * G * 0.4 / INERTIA).sqrt();
    for amplitude in [1e-3, 0.5, 2.0, 3.0] {
        let period = TAU / omega / agm(1.0, f64::cos(0.5 * amplitude));
        let joint = format!("RevoluteJoint(axis: (0.0, 1.0, 0.0), position: {amplitude:?})");
        let mut plant = pendulum(&joint);
        plant.run_to(period, period / 2000.0);
        close(plant.get("joint.q") / amplitude, 1.0, 1e-9);
        close(plant.get("joint.w") / amplitude, 0.0, 1e-7);
    }
}

#[test]
fn a_pendulum_keeps_its_energy() {
    let mut plant = pendulum("RevoluteJoint(axis: (1.0, 0.0, 0.0), position: 2.0, velocity: 1.0)");
    let energy =
        |p: &mut Plant| 0.5 * INERTIA * p.get("joint.w").powi(2) - 2.0 * G * 0.4 * p.get("joint.q").cos();
    let before = energy(&mut plant);
    for second in 1..=10 {
        plant.run_to(f64::from(second), 1e-3);
        close(energy(&mut plant), before, 1e-8);
    }
}

#[test]
fn the_torque_input_the_spring_and_the_damper_move_a_joint() {
    let mut plant = pendulum(
        "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.3, velocity: -2.0, equilibrium: 0.1, \
         stiffness: 5.0, damping: 0.2)",
    );
    plant.set("joint.torque", 1.5);
    let torque = 1.5 - 5.0 * 0.2 + 0.2 * 2.0 - 2.0 * G * 0.4 * 0.3_f64.sin();
    close(plant.get("joint.a"), torque / INERTIA, 1e-12);
    assert_eq!(plant.get("joint.tau"), 1.5, "actuators only");
    assert_eq!(plant.read_by("joint.q"), Vec::<String>::new(), "positions break loops");
}

#[test]
fn a_joint_comes_to_rest_in_its_limit() {
    let joint = "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 1.5, damping: 0.5, lower: 0.4, upper: 2.0, \
                 limit_stiffness: 1e4, limit_damping: 100.0, limit_transition: 1e-3)";
    let mut plant = pendulum(joint);
    plant.run_to(5.0, 2e-4);
    close(plant.get("joint.w"), 0.0, 1e-9);
    // The weight presses it into the limit until k d = m g l sin(q), or less deep while s < 1.
    let depth = 0.4 - plant.get("joint.q");
    let x = f64::min(depth / 1e-3, 1.0);
    let push = x * x * (3.0 - 2.0 * x) * 1e4 * depth;
    close(push, 2.0 * G * 0.4 * (0.4 - depth).sin(), 1e-6);
    assert!(depth > 0.0 && depth < 1e-3, "{depth}");
}

/// Two links with offsets and skewed axes.
fn arm(more: &[(&str, &str)], connections: &[&str], start: [f64; 4]) -> Plant {
    let [q1, q2, w1, w2] = start;
    let shoulder = format!("RevoluteJoint(axis: (0.0, 0.6, 0.8), position: {q1:?}, velocity: {w1:?})");
    let elbow = format!("RevoluteJoint(axis: (0.0, 1.0, 0.0), position: {q2:?}, velocity: {w2:?})");
    let mut blocks = vec![
        ("world", "World"),
        ("shoulder", shoulder.as_str()),
        (
            "upper",
            "Body(mass: 3.0, com: (0.2, 0.01, 0.0), moi: (0.01, 0.05, 0.055), poi: (0.001, -0.002, 0.003))",
        ),
        ("offset", "Transform(translation: (0.5, 0.1, 0.0), rpy: (0.3, -0.2, 0.7))"),
        ("elbow", elbow.as_str()),
        ("lower", "Body(mass: 1.5, com: (0.3, 0.0, -0.05), moi: (0.004, 0.03, 0.031))"),
    ];
    blocks.extend_from_slice(more);
    let mut lines = vec![
        "world.frame <-> shoulder.base",
        "shoulder.follower <-> upper.frame <-> offset.base",
        "offset.follower <-> elbow.base",
        "elbow.follower <-> lower.frame",
    ];
    lines.extend_from_slice(connections);
    Plant::new(&blocks, &lines)
}

/// The same arm built by hand: accelerations at positions, speeds and torques, with inertia that drives
/// reflect.
fn accelerations(q: [f64; 2], w: [f64; 2], tau: [f64; 2], reflected: [f64; 2]) -> [f64; 2] {
    let mut builder = ModelBuilder::new();
    builder.gravity([0.0, 0.0, -G]);
    let upper = Inertia::from_moments(3.0, [0.2, 0.01, 0.0], [0.01, 0.05, 0.055], [0.001, -0.002, 0.003])
        .expect("a body");
    let lower =
        Inertia::from_moments(1.5, [0.3, 0.0, -0.05], [0.004, 0.03, 0.031], [0.0; 3]).expect("a body");
    let offset = Placement::from_rpy([0.5, 0.1, 0.0], [0.3, -0.2, 0.7]);
    let first = builder
        .add_body(None, Joint::revolute([0.0, 0.6, 0.8]), Placement::identity(), upper)
        .expect("a body on the ground");
    builder.add_body(Some(first), Joint::revolute([0.0, 1.0, 0.0]), offset, lower).expect("a second body");
    let model = builder.build();
    let mut data = model.data();
    let mut a = [0.0; 2];
    aba(&model, &mut data, &q, &w, &tau, &reflected, &mut a);
    a
}

const STARTS: [[f64; 4]; 4] =
    [[0.0, 0.0, 0.0, 0.0], [0.4, -1.1, 0.7, -2.0], [-2.0, 2.5, 3.0, 1.0], [PI, 0.3, -1.0, 4.0]];

#[test]
fn an_arm_accelerates_as_the_articulated_body_algorithm_says() {
    for start in STARTS {
        let mut plant = arm(&[], &[], start);
        plant.set("shoulder.torque", 12.0).set("elbow.torque", -3.0);
        let expected = accelerations([start[0], start[1]], [start[2], start[3]], [12.0, -3.0], [0.0; 2]);
        close(plant.get("shoulder.a"), expected[0], 1e-10);
        close(plant.get("elbow.a"), expected[1], 1e-10);
    }
}

#[test]
fn motors_behind_gears_add_their_reflected_inertia_and_drive_with_the_ratio() {
    let drives = [
        ("motor1", "IdealTorqueSource"),
        ("rotor1", "Inertia(j: 2e-4)"),
        ("gear1", "CycloidalDrive(disc_teeth: 100, ring_teeth: 101)"),
        ("motor2", "IdealTorqueSource"),
        ("rotor2", "Inertia(j: 5e-5)"),
        ("gear2", "SimpleGear(ratio: 50.0, direction: Same)"),
        ("frame", "RotationalReference"),
    ];
    let lines = [
        "motor1.r <-> rotor1.r <-> gear1.base",
        "gear1.follower <-> shoulder.r",
        "motor2.r <-> rotor2.r <-> gear2.base",
        "gear2.follower <-> elbow.r",
        "motor1.c <-> motor2.c <-> shoulder.c <-> elbow.c <-> frame.r",
    ];
    for start in STARTS {
        let (q, w) = ([start[0], start[1]], [start[2], start[3]]);
        let mut plant = arm(&drives, &lines, start);
        plant.set("motor1.tau", 0.7).set("motor2.tau", -0.2);
        // (M + a^2 J) dw = a tau - h with a = -100 and 50.
        let expected = accelerations(q, w, [-100.0 * 0.7, 50.0 * -0.2], [1e4 * 2e-4, 2500.0 * 5e-5]);
        close(plant.get("shoulder.a"), expected[0], 1e-8);
        close(plant.get("elbow.a"), expected[1], 1e-8);
        // What the joint receives is what the motor gives less what its rotor keeps.
        close(plant.get("shoulder.tau"), -100.0 * 0.7 - 1e4 * 2e-4 * expected[0], 1e-8);
        close(plant.get("elbow.tau"), 50.0 * -0.2 - 2500.0 * 5e-5 * expected[1], 1e-8);
        close(plant.get("gear1.tau"), 0.7 + 2e-4 * 100.0 * expected[0], 1e-10);
    }
}

#[test]
fn friction_in_a_bearing_acts_between_the_drive_sides_of_a_joint() {
    let bearing = "RotationalFriction(breakaway: 3.0, breakaway_velocity: 0.1, coulomb: 2.0, viscous: 0.5)";
    let start = [0.4, -1.1, 0.7, -2.0];
    let mut plant = arm(
        &[("bearing", bearing), ("frame", "RotationalReference")],
        &["shoulder.r <-> bearing.r", "shoulder.c <-> bearing.c <-> frame.r"],
        start,
    );
    let x = 0.7 / (0.1 * 2.0_f64.sqrt());
    let friction = (2.0 * 1.0_f64.exp()).sqrt() * x * (-x * x).exp() + 2.0 * 70.0_f64.tanh() + 0.5 * 0.7;
    let expected = accelerations([0.4, -1.1], [0.7, -2.0], [-friction, 0.0], [0.0; 2]);
    close(plant.get("shoulder.a"), expected[0], 1e-10);
    close(plant.get("elbow.a"), expected[1], 1e-10);
    close(plant.get("shoulder.tau"), -friction, 1e-12);
}

#[test]
fn a_prescribed_joint_needs_the_torque_of_inverse_dynamics() {
    // The source turns the drive side of a pendulum; its torque is J a + m g l sin q.
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.8)"),
            ("bob", "Body(mass: 2.0, com: (0.0, 0.0, -0.4), moi: (0.05, 0.05, 0.01))"),
            ("turn", "IdealSpeedSource"),
            ("frame", "RotationalReference"),
        ],
        &[
            "world.frame <-> joint.base",
            "joint.follower <-> bob.frame",
            "turn.r <-> joint.r",
            "turn.c <-> joint.c <-> frame.r",
        ],
    );
    plant.set("turn.w", 3.0).set("turn.dw", 5.0);
    let torque = INERTIA * 5.0 + 2.0 * G * 0.4 * 0.8_f64.sin();
    close(plant.get("joint.w"), 3.0, 1e-14);
    close(plant.get("joint.tau"), torque, 1e-10);
    close(plant.get("turn.tau"), torque, 1e-10);
}
