//! Inertias, springs, dampers, friction and sensors on one axis.

use crate::plant::{Plant, close};

#[test]
fn a_damped_inertia_slows_down_exponentially() {
    let mut plant = Plant::new(
        &[
            ("disc", "Inertia(j: 0.5, w0: 10.0)"),
            ("oil", "RotationalDamper(d: 0.25)"),
            ("sensor", "MotionSensor"),
            ("frame", "RotationalReference"),
        ],
        &["disc.r <-> oil.r <-> sensor.r", "oil.c <-> sensor.c <-> frame.r"],
    );
    close(plant.get("sensor.a"), -5.0, 1e-14);
    plant.run_to(2.0, 1e-3);
    let decay = (-1.0_f64).exp();
    close(plant.get("sensor.w"), 10.0 * decay, 1e-10);
    close(plant.get("sensor.phi"), 20.0 * (1.0 - decay), 1e-10);
}

#[test]
fn two_inertias_on_a_spring_swing_with_their_reduced_inertia() {
    let (j1, j2, k, phi0) = (0.2, 0.3, 50.0, 0.1);
    let mut plant = Plant::new(
        &[
            ("left", "Inertia(j: 0.2)"),
            ("right", "Inertia(j: 0.3)"),
            ("shaft", "RotationalSpring(k: 50.0, phi0: 0.1)"),
            ("sensor", "MotionSensor"),
        ],
        &["left.r <-> shaft.r <-> sensor.r", "right.r <-> shaft.c <-> sensor.c"],
    );
    let omega = f64::sqrt(k * (1.0 / j1 + 1.0 / j2));
    plant.run_to(1.0, 1e-4);
    close(plant.get("sensor.w"), -phi0 * omega * omega.sin(), 1e-9);
    let twist = plant.state("shaft.phi");
    close(plant.bench.x[twist], phi0 * omega.cos(), 1e-10);
}

#[test]
fn a_torque_sensor_reads_what_accelerates_the_part_behind_it() {
    let mut plant = Plant::new(
        &[
            ("drive", "IdealTorqueSource"),
            ("first", "Inertia(j: 2.0)"),
            ("sensor", "TorqueSensor"),
            ("second", "Inertia(j: 3.0)"),
            ("frame", "RotationalReference"),
        ],
        &["drive.r <-> first.r <-> sensor.r", "sensor.c <-> second.r", "drive.c <-> frame.r"],
    );
    plant.set("drive.tau", 10.0);
    close(plant.get("sensor.tau"), 6.0, 1e-14);
}

#[test]
fn a_speed_source_needs_torque_for_friction_and_for_acceleration() {
    let mut plant = Plant::new(
        &[
            ("drive", "IdealSpeedSource"),
            ("disc", "Inertia(j: 2.0)"),
            (
                "bearing",
                "RotationalFriction(breakaway: 25.0, breakaway_velocity: 0.1, coulomb: 20.0, viscous: 0.001)",
            ),
            ("frame", "RotationalReference"),
        ],
        &["drive.r <-> disc.r <-> bearing.r", "drive.c <-> bearing.c <-> frame.r"],
    );
    // Speed, rad/s, and friction torque, N*m.
    for (w, torque) in [(0.001, 2.075_792_8), (0.05, 23.635_712_6), (0.1, 25.000_099_9), (1.0, 20.001)] {
        plant.set("drive.w", w).set("drive.dw", 0.0);
        close(plant.get("drive.tau"), torque, 1e-7);
        plant.set("drive.dw", 4.0);
        close(plant.get("drive.tau"), torque + 8.0, 1e-7);
        plant.set("drive.w", -w).set("drive.dw", 0.0);
        close(plant.get("drive.tau"), -torque, 1e-7);
    }
}

#[test]
fn a_part_with_friction_creeps_below_the_breakaway_torque_and_runs_above_it() {
    let run = |torque: f64| {
        let mut plant = Plant::new(
            &[
                ("drive", "IdealTorqueSource"),
                ("disc", "Inertia(j: 1.0)"),
                (
                    "bearing",
                    "RotationalFriction(breakaway: 2.0, breakaway_velocity: 0.1, coulomb: 1.0, viscous: 0.1)",
                ),
                ("sensor", "MotionSensor"),
                ("frame", "RotationalReference"),
            ],
            &[
                "drive.r <-> disc.r <-> bearing.r <-> sensor.r",
                "drive.c <-> bearing.c <-> sensor.c <-> frame.r",
            ],
        );
        plant.set("drive.tau", torque).run_to(1.0, 1e-3).get("sensor.w")
    };
    assert!(run(0.9) < 0.02, "{}", run(0.9));
    assert!(run(2.2) > 0.5, "{}", run(2.2));
}
