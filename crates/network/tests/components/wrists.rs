//! Two motors that move two joints together through differentials, elastic gears and prescribed angles.

use std::f64::consts::TAU;

use crate::plant::{Plant, close};

/// `pitch = (a + b) / 2` and `roll = (a - b) / 2` by two differentials; a hand hangs on both joints.
fn wrist(brakes: &[(&str, &str)], wires: &[&str]) -> Plant {
    let mut blocks = vec![
        ("push_a", "IdealTorqueSource"),
        ("push_b", "IdealTorqueSource"),
        ("motor_a", "Inertia(j: 0.02)"),
        ("motor_b", "Inertia(j: 0.02)"),
        ("sum", "Differential"),
        ("difference", "Differential"),
        ("reverse", "SimpleGear(ratio: 1.0)"),
        ("world", "World"),
        ("pitch", "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.8)"),
        ("palm", "Body(mass: 0.5, com: (0.1, 0.0, 0.0), moi: (2e-3, 2e-3, 2e-3))"),
        ("roll", "RevoluteJoint(axis: (1.0, 0.0, 0.0), position: 0.3)"),
        ("hand", "Body(mass: 1.0, com: (0.2, 0.05, 0.0), moi: (4e-3, 3e-3, 3e-3))"),
        ("frame", "RotationalReference"),
    ];
    blocks.extend_from_slice(brakes);
    let mut connections = vec![
        "sum.drive <-> pitch.r",
        "reverse.follower <-> difference.right",
        "difference.drive <-> roll.r",
        "world.frame <-> pitch.base",
        "pitch.follower <-> palm.frame <-> roll.base",
        "roll.follower <-> hand.frame",
    ];
    connections.extend_from_slice(wires);
    Plant::new(&blocks, &connections)
}

#[test]
fn two_motors_move_two_joints_through_differentials() {
    let mut coupled = wrist(
        &[],
        &[
            "push_a.r <-> motor_a.r <-> sum.left <-> difference.left",
            "push_b.r <-> motor_b.r <-> sum.right <-> reverse.base",
            "push_a.c <-> push_b.c <-> pitch.c <-> roll.c <-> frame.r",
        ],
    );
    // J (p + r)^2 / 2 + J (p - r)^2 / 2 = J p^2 + J r^2: twice the inertia at each joint; torques a + b and a - b.
    let mut alone = Plant::new(
        &[
            ("push_pitch", "IdealTorqueSource"),
            ("push_roll", "IdealTorqueSource"),
            ("at_pitch", "Inertia(j: 0.04)"),
            ("at_roll", "Inertia(j: 0.04)"),
            ("world", "World"),
            ("pitch", "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.8)"),
            ("palm", "Body(mass: 0.5, com: (0.1, 0.0, 0.0), moi: (2e-3, 2e-3, 2e-3))"),
            ("roll", "RevoluteJoint(axis: (1.0, 0.0, 0.0), position: 0.3)"),
            ("hand", "Body(mass: 1.0, com: (0.2, 0.05, 0.0), moi: (4e-3, 3e-3, 3e-3))"),
            ("frame", "RotationalReference"),
        ],
        &[
            "push_pitch.r <-> at_pitch.r <-> pitch.r",
            "push_roll.r <-> at_roll.r <-> roll.r",
            "push_pitch.c <-> push_roll.c <-> pitch.c <-> roll.c <-> frame.r",
            "world.frame <-> pitch.base",
            "pitch.follower <-> palm.frame <-> roll.base",
            "roll.follower <-> hand.frame",
        ],
    );
    for step in 0..500 {
        let t = f64::from(step) * 2e-3;
        let (a, b) = (0.8 * (3.0 * t).sin() - 1.0, 0.5 * (5.0 * t).cos() - 1.2);
        coupled.set("push_a.tau", a).set("push_b.tau", b).run_to(t + 2e-3, 1e-3);
        alone.set("push_pitch.tau", a + b).set("push_roll.tau", a - b).run_to(t + 2e-3, 1e-3);
        for joint in ["pitch.q", "roll.q", "pitch.w", "roll.w"] {
            close(coupled.get(joint), alone.get(joint), 1e-10);
        }
    }
    assert!(coupled.get("pitch.q").abs() > 0.1 && coupled.get("roll.q").abs() > 0.5);
}

#[test]
fn brakes_on_both_motors_hold_both_joints_and_one_brake_leaves_one_freedom() {
    let brakes = [("hold_a", "Brake(torque: 5.0)"), ("hold_b", "Brake(torque: 5.0)")];
    let wires = [
        "push_a.r <-> motor_a.r <-> sum.left <-> difference.left <-> hold_a.r",
        "push_b.r <-> motor_b.r <-> sum.right <-> reverse.base <-> hold_b.r",
        "push_a.c <-> push_b.c <-> hold_a.c <-> hold_b.c <-> pitch.c <-> roll.c <-> frame.r",
    ];
    let mut plant = wrist(&brakes, &wires);
    plant.set("hold_a.engaged", 1.0).set("hold_b.engaged", 1.0);
    plant.bench.major();
    plant.run_to(2.0, 2e-3);
    assert_eq!((plant.get("pitch.q"), plant.get("roll.q")), (0.8, 0.3));
    assert_eq!((plant.get("hold_a.locked"), plant.get("hold_b.locked")), (1.0, 1.0));
    // Statics: the brakes bear the weights as pitch = a + b, roll = a - b ask for.
    let (a, b) = (plant.get("hold_a.tau"), plant.get("hold_b.tau"));
    let (sin, cos) = f64::sin_cos(0.8);
    let g = 9.80665;
    // Height of the hand: -x sin(pitch) + z cos(pitch) with z = y sin(roll).
    let pitch = g * (0.5 * 0.1 * cos + 0.2 * cos + 0.05 * f64::sin(0.3) * sin);
    let roll = -g * 0.05 * f64::cos(0.3) * cos;
    close(a + b, pitch, 1e-10);
    close(a - b, roll, 1e-10);

    // Without the first brake both joints move, and what the second holds stands still: pitch - roll stays.
    plant.set("hold_a.engaged", 0.0);
    plant.bench.major();
    plant.run_to(2.3, 1e-3);
    assert!(plant.get("pitch.q") - 0.8 > 0.1, "{}", plant.get("pitch.q"));
    close(plant.get("pitch.q") - plant.get("roll.q"), 0.5, 1e-12);
    let (w_p, w_r) = (plant.get("pitch.w"), plant.get("roll.w"));
    assert_eq!(w_p, w_r);
}

#[test]
fn an_elastic_gear_is_a_gear_and_an_elastic_shaft() {
    let frame = ("frame", "RotationalReference");
    let (drive, rotor, load) =
        (("drive", "IdealTorqueSource"), ("rotor", "Inertia(j: 1e-3)"), ("load", "Inertia(j: 0.4)"));
    let (front, back) = (("front", "MotionSensor"), ("back", "MotionSensor"));
    let shaft = "k: 800.0, d: 1.5, backlash: 0.01, transition: 1e-3";
    let whole = format!(
        "ElasticGear(ratio: 20.0, direction: Same, {shaft}, efficiency_forward: 0.8, efficiency_backward: 0.7)"
    );
    let elastic = format!("RotationalSpringDamper({shaft})");
    let mut one = Plant::new(
        &[frame, drive, rotor, ("gear", &whole), load, front, back],
        &[
            "drive.r <-> rotor.r <-> gear.base <-> front.r",
            "gear.follower <-> load.r <-> back.r",
            "drive.c <-> front.c <-> back.c <-> frame.r",
        ],
    );
    let mut two = Plant::new(
        &[
            frame,
            drive,
            rotor,
            (
                "gear",
                "CycloidalDrive(disc_teeth: 20, ring_teeth: 21, direction: Same, efficiency_forward: 0.8, \
                 efficiency_backward: 0.7)",
            ),
            ("shaft", &elastic),
            load,
            front,
            back,
        ],
        &[
            "drive.r <-> rotor.r <-> gear.base <-> front.r",
            "gear.follower <-> shaft.r",
            "shaft.c <-> load.r <-> back.r",
            "drive.c <-> front.c <-> back.c <-> frame.r",
        ],
    );
    for step in 0..400 {
        let t = f64::from(step) * 1e-3;
        for plant in [&mut one, &mut two] {
            plant.set("drive.tau", 2.0 * (40.0 * t).sin()).run_to(t + 1e-3, 5e-4);
        }
        close(one.get("back.phi"), two.get("back.phi"), 1e-12);
        close(one.get("gear.tau"), two.get("gear.tau"), 1e-9);
        close(one.get("gear.phi"), two.get("shaft.phi"), 1e-12);
    }
    assert!(one.get("back.phi").abs() > 1e-3);
}

#[test]
fn a_prescribed_angle_is_reached_as_a_critically_damped_filter_does() {
    let mut plant = Plant::new(
        &[
            ("source", "IdealAngleSource(f: 5.0)"),
            ("disc", "Inertia(j: 0.3)"),
            ("sensor", "MotionSensor"),
            ("frame", "RotationalReference"),
        ],
        &["source.r <-> disc.r <-> sensor.r", "source.c <-> sensor.c <-> frame.r"],
    );
    plant.set("source.phi", 0.7);
    let omega = TAU * 5.0;
    for t in [0.02, 0.05, 0.2, 1.0] {
        plant.run_to(t, 1e-4);
        let decay = (-omega * t).exp();
        close(plant.get("sensor.phi"), 0.7 * (1.0 - (1.0 + omega * t) * decay), 1e-9);
        close(plant.get("source.tau"), 0.3 * 0.7 * omega * omega * (1.0 - omega * t) * decay, 1e-6);
    }
}
