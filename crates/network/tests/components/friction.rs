//! Brakes, clutches, freewheels, loads and bristle friction in motion.

use crate::plant::{Plant, close};

const FRAME: (&str, &str) = ("frame", "RotationalReference");

/// Speed of an inertia that `torque tanh(w / threshold)` brakes: `sinh(w / threshold)` decays exponentially.
fn braked(w0: f64, threshold: f64, deceleration: f64, t: f64) -> f64 {
    threshold * ((w0 / threshold).sinh() * (-deceleration * t / threshold).exp()).asinh()
}

#[test]
fn a_brake_stops_an_inertia_after_the_time_j_w_over_t_and_turns_its_energy_into_heat() {
    for (share, duration) in [(1.0, 2.0), (0.5, 4.0)] {
        let mut plant = Plant::new(
            &[
                FRAME,
                ("disc", "Inertia(j: 0.5, w0: 40.0)"),
                ("brake", "Brake(torque: 10.0, model: Smooth, threshold: 0.5)"),
                ("sensor", "MotionSensor"),
            ],
            &["disc.r <-> brake.r <-> sensor.r", "brake.c <-> sensor.c <-> frame.r"],
        );
        plant.set("brake.engaged", share);
        let (mut heat, h) = (0.0, 1e-3);
        for quarter in 1..=4 {
            let end = 0.25 * duration * f64::from(quarter);
            while plant.bench.t < end - 0.5 * h {
                let (t, before) = (plant.bench.t, plant.get("brake.heat"));
                plant.run_to(t + h, h);
                heat += 0.5 * h * (before + plant.get("brake.heat"));
            }
            close(plant.get("sensor.w"), braked(40.0, 0.5, 20.0 * share, end), 1e-8);
        }
        assert!(plant.get("sensor.w") < 0.5, "it stands, up to the threshold");
        close(heat, 0.5 * 0.5 * 40.0 * 40.0 - 0.25 * plant.get("sensor.w").powi(2), 1e-3);
        plant.set("brake.engaged", 0.0);
        assert_eq!(plant.get("sensor.a"), 0.0, "a released brake is free");
    }
}

#[test]
fn a_clutch_brings_two_inertias_to_the_common_speed_and_keeps_their_momentum() {
    let mut plant = Plant::new(
        &[
            FRAME,
            ("engine", "Inertia(j: 0.2, w0: 100.0)"),
            ("load", "Inertia(j: 0.6)"),
            ("clutch", "Clutch(torque: 30.0, model: Smooth, threshold: 1.0)"),
            ("front", "MotionSensor"),
            ("back", "MotionSensor"),
        ],
        &[
            "engine.r <-> clutch.r <-> front.r",
            "load.r <-> clutch.c <-> back.r",
            "front.c <-> back.c <-> frame.r",
        ],
    );
    plant.run_to(0.1, 1e-3);
    assert_eq!((plant.get("front.w"), plant.get("back.w")), (100.0, 0.0), "an open clutch transmits nothing");
    plant.set("clutch.normal", 1.0);
    for t in [0.1, 0.3, 0.5, 1.0] {
        plant.run_to(0.1 + t, 1e-4);
        let (front, back) = (plant.get("front.w"), plant.get("back.w"));
        close(0.2 * front + 0.6 * back, 20.0, 1e-10);
        // The slip is braked with the reduced inertia of 0.15 kg*m^2.
        close(front - back, braked(100.0, 1.0, 30.0 / 0.15, t), 1e-8);
        close(plant.get("clutch.heat"), plant.get("clutch.tau") * (front - back), 1e-12);
    }
    close(plant.get("front.w"), 25.0, 1e-10);
    close(plant.get("back.w"), 25.0, 1e-10);
}

#[test]
fn a_freewheel_drives_and_lets_the_load_overrun() {
    let mut plant = Plant::new(
        &[
            FRAME,
            ("pedal", "Inertia(j: 1.0, w0: 10.0)"),
            ("wheel", "Inertia(j: 1.0)"),
            ("hub", "OneWayClutch(model: Smooth, d: 50.0, transition: 0.01)"),
            ("foot", "IdealTorqueSource"),
            ("front", "MotionSensor"),
            ("back", "MotionSensor"),
        ],
        &[
            "pedal.r <-> hub.r <-> foot.r <-> front.r",
            "wheel.r <-> hub.c <-> back.r",
            "foot.c <-> front.c <-> back.c <-> frame.r",
        ],
    );
    plant.run_to(1.0, 1e-3);
    close(plant.get("front.w"), 5.0, 0.01);
    close(plant.get("front.w") + plant.get("back.w"), 10.0, 1e-10);
    plant.set("foot.tau", 4.0).run_to(2.0, 1e-3);
    // Both are driven together; half of the torque passes the hub, with a slip of tau / d + w_t.
    close(plant.get("back.a"), 2.0, 1e-6);
    close(plant.get("front.w") - plant.get("back.w"), 2.0 / 50.0 + 0.01, 2e-3);
    plant.set("foot.tau", -8.0).run_to(3.0, 1e-3);
    let rolling = plant.get("back.w");
    plant.run_to(4.0, 1e-3);
    assert_eq!(plant.get("back.w"), rolling, "nothing brakes the wheel");
    assert!(plant.get("front.w") < rolling - 10.0);
}

#[test]
fn a_constant_torque_brings_a_fan_to_its_speed_along_a_hyperbolic_tangent() {
    let mut plant = Plant::new(
        &[
            FRAME,
            ("motor", "ConstantTorque(tau: 8.0)"),
            ("rotor", "Inertia(j: 0.4)"),
            ("fan", "QuadraticLoad(torque: 2.0, speed: 50.0)"),
            ("sensor", "MotionSensor"),
        ],
        &["motor.r <-> rotor.r <-> fan.r <-> sensor.r", "motor.c <-> fan.c <-> sensor.c <-> frame.r"],
    );
    let k = 2.0 / 2500.0;
    for t in [1.0, 3.0, 10.0, 60.0] {
        plant.run_to(t, 1e-2);
        close(plant.get("sensor.w"), f64::sqrt(8.0 / k) * (t * f64::sqrt(8.0 * k) / 0.4).tanh(), 1e-7);
    }
}

const BRISTLES: &str = "LuGreFriction(coulomb: 1.0, breakaway: 1.5, stribeck_velocity: 0.01, viscous: 0.4, \
                        sigma0: 1e4, sigma1: 100.0)";

/// Bristle friction at a prescribed speed.
fn dragged(friction: &str) -> Plant {
    Plant::new(
        &[FRAME, ("drive", "IdealSpeedSource"), ("bearing", friction)],
        &["drive.r <-> bearing.r", "drive.c <-> bearing.c <-> frame.r"],
    )
}

#[test]
fn bristles_bend_with_their_stiffness_before_they_slip() {
    // Without a Stribeck effect and bristle damping: tau = tau_C (1 - exp(-sigma0 phi / tau_C)).
    let friction = "LuGreFriction(coulomb: 2.0, breakaway: 2.0, stribeck_velocity: 0.01, sigma0: 1e4)";
    let w = 1e-3;
    let mut plant = dragged(friction);
    plant.set("drive.w", w);
    for t in [1e-3, 0.02, 0.1, 0.3, 1.0, 5.0] {
        plant.run_to(t, 1e-3);
        close(plant.get("drive.tau"), 2.0 * (1.0 - (-1e4 * w * t / 2.0).exp()), 1e-9);
    }
    let mut plant = dragged(friction);
    plant.set("drive.w", w).run_to(1e-3, 1e-4);
    let stiffness = plant.get("drive.tau") / (w * 1e-3);
    close(stiffness / 1e4, 1.0, 3e-3);
}

#[test]
fn steady_sliding_against_bristles_follows_the_stribeck_curve() {
    for w in [1e-3, 5e-3, 0.01, 0.03, 0.3_f64] {
        for sign in [1.0, -1.0] {
            let mut plant = dragged(BRISTLES);
            plant.set("drive.w", sign * w).run_to(10.0, 2.5e-4);
            let curve = 1.0 + 0.5 * (-(w / 0.01).powi(2)).exp() + 0.4 * w;
            close(plant.get("drive.tau"), sign * curve, 1e-9);
        }
    }
}

#[test]
fn bristles_hold_a_load_below_breakaway_without_creeping_and_let_go_above() {
    let run = |torque: f64, end: f64| {
        let mut plant = Plant::new(
            &[
                FRAME,
                ("drive", "IdealTorqueSource"),
                ("disc", "Inertia(j: 1.0)"),
                ("bearing", BRISTLES),
                ("sensor", "MotionSensor"),
            ],
            &[
                "drive.r <-> disc.r <-> bearing.r <-> sensor.r",
                "drive.c <-> bearing.c <-> sensor.c <-> frame.r",
            ],
        );
        plant.set("drive.tau", torque).run_to(end, 2.5e-4);
        (plant.get("sensor.phi"), plant.get("sensor.w"), plant.get("bearing.z"))
    };
    let (early, late) = (run(0.7, 2.0), run(0.7, 20.0));
    close(late.0, early.0, 1e-12);
    close(late.1, 0.0, 1e-12);
    close(late.2, 0.7 / 1e4, 1e-12);
    assert!(early.0 < 2e-4, "{} rad", early.0);
    let (_, speed, _) = run(1.8, 1.0);
    assert!(speed > 0.5, "{speed} rad/s");
}

#[test]
fn bristles_never_deliver_energy() {
    let mut plant = Plant::new(
        &[
            FRAME,
            ("drive", "IdealTorqueSource"),
            ("disc", "Inertia(j: 1.0)"),
            (
                "bearing",
                "LuGreFriction(coulomb: 1.0, breakaway: 1.5, stribeck_velocity: 0.01, sigma0: 1e3, sigma1: 60.0)",
            ),
            ("sensor", "MotionSensor"),
        ],
        &["drive.r <-> disc.r <-> bearing.r <-> sensor.r", "drive.c <-> bearing.c <-> sensor.c <-> frame.r"],
    );
    let h = 1e-4;
    let stored = |p: &mut Plant| 0.5 * (p.get("sensor.w").powi(2) + 1e3 * p.get("bearing.z").powi(2));
    let (mut lost, mut turns) = (0.0, [0, 0]);
    let mut before = (0.0, 0.0);
    for step in 0..40_000 {
        let t = f64::from(step) * h;
        let tau = 2.0 * (3.0 * t).sin() + 0.5 * (17.0 * t).sin();
        plant.set("drive.tau", tau).run_to(t + h, h);
        let (phi, energy) = (plant.get("sensor.phi"), stored(&mut plant));
        // The torque is held over the step, so its work is exact.
        let loss = tau * (phi - before.0) - (energy - before.1);
        assert!(loss > -1e-9, "t = {t}: {loss} J");
        lost += loss;
        turns[usize::from(phi > before.0)] += 1;
        before = (phi, energy);
    }
    assert!(lost > 0.5, "{lost} J");
    assert!(turns.iter().all(|count| *count > 1000), "the test must cover both directions: {turns:?}");
}
