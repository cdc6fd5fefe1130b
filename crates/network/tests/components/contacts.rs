//! Elastic shafts, backlash and hard stops.

use std::f64::consts::PI;

use crate::plant::{Plant, close};

const FRAME: (&str, &str) = ("frame", "RotationalReference");

/// An inertia of 0.5 kg*m^2 that an element holds to the frame; `tau` drives it.
fn disc(w0: f64, element: &str) -> Plant {
    let inertia = format!("Inertia(j: 0.5, w0: {w0:?})");
    Plant::new(
        &[
            FRAME,
            ("drive", "IdealTorqueSource"),
            ("disc", &inertia),
            ("element", element),
            ("sensor", "MotionSensor"),
        ],
        &["drive.r <-> disc.r <-> element.r <-> sensor.r", "drive.c <-> element.c <-> sensor.c <-> frame.r"],
    )
}

#[test]
fn an_elastic_shaft_swings_as_a_damped_oscillator() {
    let mut plant = disc(0.0, "RotationalSpringDamper(k: 200.0, d: 2.0, phi0: 0.1)");
    // phi'' + 2 a phi' + (a^2 + b^2) phi = 0
    let a = 2.0 / (2.0 * 0.5);
    let b = f64::sqrt(200.0 / 0.5 - a * a);
    for t in [0.1, 0.5, 1.0] {
        plant.run_to(t, 1e-4);
        let phi = 0.1 * (-a * t).exp() * ((b * t).cos() + a / b * (b * t).sin());
        close(plant.get("element.phi"), phi, 1e-11);
        close(plant.get("element.tau"), 200.0 * phi + 2.0 * plant.get("sensor.w"), 1e-9);
    }
}

#[test]
fn an_inertia_in_backlash_flies_and_bounces_with_the_period_of_both() {
    // Across the play at constant speed, half a period of the spring at each flank.
    let (speed, backlash, k) = (2.0, 0.4, 800.0);
    let mut plant = disc(speed, "RotationalSpringDamper(k: 800.0, d: 0.0, backlash: 0.4)");
    let period = 2.0 * backlash / speed + 2.0 * PI * f64::sqrt(0.5 / k);
    plant.run_to(0.05, 1e-4);
    assert_eq!(plant.get("sensor.a"), 0.0, "nothing is transmitted within the play");
    plant.run_to(period, period / 20_000.0);
    close(plant.get("sensor.w"), speed, 1e-6);
    close(plant.get("element.phi"), 0.0, 1e-6);
    // Deepest: all energy is in the spring.
    let mut plant = disc(speed, "RotationalSpringDamper(k: 800.0, d: 0.0, backlash: 0.4)");
    plant.run_to(0.5 * backlash / speed + 0.5 * PI * f64::sqrt(0.5 / k), 1e-5);
    close(plant.get("element.phi"), 0.5 * backlash + speed * f64::sqrt(0.5 / k), 1e-6);
    close(plant.get("sensor.w"), 0.0, 1e-3);
}

#[test]
fn flanks_lose_energy_with_damping_and_hold_a_load() {
    let mut plant = disc(3.0, "RotationalSpringDamper(k: 500.0, d: 4.0, backlash: 0.2, transition: 0.01)");
    let mut energy = 0.5 * 0.5 * 9.0;
    for step in 1..=400 {
        plant.run_to(f64::from(step) * 5e-3, 1e-4);
        let kinetic = 0.25 * plant.get("sensor.w").powi(2);
        let depth = plant.get("element.phi").abs() - 0.1;
        if depth < 0.0 {
            assert!(kinetic < energy + 1e-12, "in free flight no more than before");
            energy = kinetic;
        }
    }
    assert!(energy < 1.0, "{energy} J");
    plant.set("drive.tau", 10.0).run_to(8.0, 1e-4);
    close(plant.get("element.phi"), 0.1 + 10.0 / 500.0, 1e-9);
    close(plant.get("element.tau"), 10.0, 1e-7);
}

#[test]
fn an_elastic_stop_gives_the_speed_back_and_a_damped_one_keeps_some() {
    for (damping, least, most) in [(0.0, -2.0 - 1e-6, -2.0 + 1e-6), (20.0, -1.8, -0.2)] {
        let stop = format!(
            "RotationalHardStop(lower: -0.5, upper: 0.3, stiffness: 1e4, damping: {damping:?}, transition: 0.01)"
        );
        let mut plant = disc(2.0, &stop);
        plant.run_to(0.14, 2e-5);
        close(plant.get("sensor.w"), 2.0, 1e-12);
        plant.run_to(0.25, 2e-5);
        let rebound = plant.get("sensor.w");
        assert!((least..=most).contains(&rebound), "{rebound} rad/s");
        assert!(plant.get("element.phi") < 0.3 && plant.get("element.tau") == 0.0);
    }
}

#[test]
fn a_load_rests_in_the_stop_where_the_smoothed_spring_carries_it() {
    for (sign, end) in [(1.0, 0.3), (-1.0, -0.5)] {
        // Torque, N*m, and penetration, rad: 1e3 N*m/rad with the smooth step over 0.1 rad.
        for (torque, depth) in
            [(3.906_25, 0.025), (25.0, 0.05), (63.281_25, 0.075), (100.0, 0.1), (150.0, 0.15)]
        {
            let mut plant = disc(
                0.0,
                "RotationalHardStop(lower: -0.5, upper: 0.3, stiffness: 1e3, damping: 60.0, transition: 0.1)",
            );
            plant.set("drive.tau", sign * torque).run_to(6.0, 5e-4);
            close(plant.get("element.phi"), end + sign * depth, 1e-7);
            close(plant.get("element.tau"), sign * torque, 1e-5);
        }
    }
}
