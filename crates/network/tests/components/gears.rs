//! Gears: ratios, reflected inertia and losses.

use crate::plant::{Plant, close};

#[test]
fn an_inertia_behind_a_gear_counts_with_the_square_of_the_ratio() {
    for (direction, sign) in [("Same", 1.0), ("Reversed", -1.0)] {
        let gear = format!("CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: {direction})");
        let mut plant = Plant::new(
            &[
                ("drive", "IdealTorqueSource"),
                ("motor", "Inertia(j: 1e-4)"),
                ("gear", &gear),
                ("load", "Inertia(j: 0.5)"),
                ("encoder", "MotionSensor"),
                ("frame", "RotationalReference"),
            ],
            &[
                "drive.r <-> motor.r <-> gear.base",
                "gear.follower <-> load.r <-> encoder.r",
                "drive.c <-> encoder.c <-> frame.r",
            ],
        );
        plant.set("drive.tau", 0.3);
        let acceleration = 50.0 * 0.3 / (0.5 + 2500.0 * 1e-4);
        close(plant.get("encoder.a"), sign * acceleration, 1e-11);
        close(plant.get("gear.tau"), 0.3 - 1e-4 * 50.0 * acceleration, 1e-13);
    }
}

#[test]
fn a_rigid_train_is_the_limit_of_one_with_a_stiff_shaft() {
    let frame = ("frame", "RotationalReference");
    let motor = ("motor", "Inertia(j: 1e-4)");
    let gear = ("gear", "SimpleGear(ratio: 20.0, direction: Same)");
    let (load, encoder) = (("load", "Inertia(j: 0.1)"), ("encoder", "MotionSensor"));
    let drive = ("drive", "IdealTorqueSource");
    let mut rigid = Plant::new(
        &[drive, motor, gear, load, encoder, frame],
        &[
            "drive.r <-> motor.r <-> gear.base",
            "gear.follower <-> load.r <-> encoder.r",
            "drive.c <-> encoder.c <-> frame.r",
        ],
    );
    let expected = rigid.set("drive.tau", 0.2).run_to(0.5, 1e-3).get("encoder.phi");
    let mut errors = Vec::new();
    for (stiffness, damping) in [(1e3, 2.0), (1e4, 6.0), (1e5, 20.0)] {
        let shaft = format!("RotationalSpring(k: {stiffness})");
        let oil = format!("RotationalDamper(d: {damping})");
        let mut plant = Plant::new(
            &[drive, motor, gear, ("shaft", &shaft), ("oil", &oil), load, encoder, frame],
            &[
                "drive.r <-> motor.r <-> gear.base",
                "gear.follower <-> shaft.r <-> oil.r",
                "shaft.c <-> oil.c <-> load.r <-> encoder.r",
                "drive.c <-> encoder.c <-> frame.r",
            ],
        );
        errors.push((plant.set("drive.tau", 0.2).run_to(0.5, 1e-4).get("encoder.phi") - expected).abs());
    }
    // The twist is inversely proportional to the stiffness.
    assert!(errors[0] < 3e-3 && errors[2] < 3e-5, "{errors:?}");
    assert!(errors[1] < 0.12 * errors[0] && errors[2] < 0.12 * errors[1], "{errors:?}");
}

#[test]
fn the_published_law_of_losses_acts_in_a_network() {
    // Torque into the base 1 N*m, efficiencies 0.8 and 0.7, threshold 1 mW: power through the base, W, and
    // loss, N*m.
    let mut plant = Plant::new(
        &[
            ("push", "IdealTorqueSource"),
            (
                "gear",
                "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.8, \
                 efficiency_backward: 0.7, loss: Published)",
            ),
            ("turn", "IdealSpeedSource"),
            ("frame", "RotationalReference"),
        ],
        &["push.r <-> gear.base", "gear.follower <-> turn.r", "push.c <-> turn.c <-> frame.r"],
    );
    plant.set("push.tau", 1.0);
    for (power, loss) in [
        (-1.0, -0.428_571_4),
        (-1e-3, -0.428_360_6),
        (-1e-4, -0.233_698_2),
        (0.0, -0.114_285_7),
        (1e-4, 0.005_126_8),
        (2.5e-4, 0.125_072_4),
        (1e-3, 0.199_789_2),
        (1.0, 0.2),
    ] {
        plant.set("turn.w", power / 50.0);
        close(plant.get("gear.tau"), 1.0, 1e-12);
        close(1.0 + plant.get("turn.tau") / 50.0, loss, 1e-7);
    }
}

/// A motor side, a gear and a load that are pushed from both sides.
pub fn train(gear: &str) -> Plant {
    Plant::new(
        &[
            ("push", "IdealTorqueSource"),
            ("motor", "Inertia(j: 2e-4)"),
            ("gear", gear),
            ("sensor", "TorqueSensor"),
            ("load", "Inertia(j: 0.4)"),
            (
                "bearing",
                "RotationalFriction(breakaway: 0.3, breakaway_velocity: 0.05, coulomb: 0.2, viscous: 0.01)",
            ),
            ("weight", "IdealTorqueSource"),
            ("front", "MotionSensor"),
            ("back", "MotionSensor"),
            ("frame", "RotationalReference"),
        ],
        &[
            "push.r <-> motor.r <-> gear.base <-> front.r",
            "gear.follower <-> sensor.r",
            "sensor.c <-> load.r <-> bearing.r <-> weight.r <-> back.r",
            "push.c <-> bearing.c <-> weight.c <-> front.c <-> back.c <-> frame.r",
        ],
    )
}

/// Torque of the motor over time: drives, brakes and lets go.
pub fn push(t: f64) -> f64 {
    0.4 * (7.0 * t).sin() + 0.1 * (31.0 * t).cos()
}

#[test]
fn torques_on_both_sides_of_a_gear_differ_by_its_efficiency() {
    let mut plant = train(
        "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.8, \
         efficiency_backward: 0.7)",
    );
    plant.set("push.tau", 0.5).run_to(0.2, 1e-3);
    assert!(plant.get("front.w") > 100.0);
    let (base, follower) = (plant.get("gear.tau"), plant.get("sensor.tau"));
    assert!(base > 0.0);
    close(follower, 0.8 * 50.0 * base, 1e-10);

    plant.set("push.tau", -0.5);
    let (base, follower) = (plant.get("gear.tau"), plant.get("sensor.tau"));
    assert!(base < 0.0 && plant.get("front.w") > 100.0);
    close(base, 0.7 * follower / 50.0, 1e-12);
    close(2e-4 * plant.get("front.a"), -0.5 - base, 1e-12);
}

#[test]
fn gear_and_friction_never_deliver_energy() {
    let mut plant = train(
        "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, efficiency_forward: 0.75, efficiency_backward: 0.6, \
         threshold: 5.0)",
    );
    plant.set("weight.tau", 1.5);
    let h = 1e-4;
    let energy = |p: &mut Plant| 0.5 * (2e-4 * p.get("front.w").powi(2) + 0.4 * p.get("back.w").powi(2));
    let (mut supplied, mut before) = (0.0, (0.0, 0.0));
    let (mut least, mut signs) = (f64::INFINITY, [0, 0]);
    for step in 0..20_000 {
        let t = f64::from(step) * h;
        plant.set("push.tau", push(t)).run_to(t + h, h);
        let (w_b, w_f) = (plant.get("front.w"), plant.get("back.w"));
        let mesh = plant.get("gear.tau") * w_b - plant.get("sensor.tau") * w_f;
        least = least.min(mesh);
        signs[usize::from(w_b > 0.0)] += 1;
        // Work of both sources over the step by the trapezoidal rule; inputs are held.
        supplied += 0.5 * h * (push(t) * (before.0 + w_b) + 1.5 * (before.1 + w_f));
        before = (w_b, w_f);
    }
    assert!(least > -1e-12, "the mesh delivered {least} W");
    assert!(signs.iter().all(|count| *count > 1000), "the test must cover both directions: {signs:?}");
    let lost = supplied - energy(&mut plant);
    assert!(lost > 0.1, "{lost} J");
}

#[test]
fn equal_efficiencies_make_a_cycloidal_drive_a_simple_gear() {
    for loss in ["Dissipative", "Published", "Stiction"] {
        let cycloidal = format!(
            "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, efficiency_forward: 0.8, \
             efficiency_backward: 0.8, loss: {loss}, power_threshold: 1.0)"
        );
        let simple = format!("SimpleGear(ratio: 50.0, efficiency: 0.8, loss: {loss}, power_threshold: 1.0)");
        let (mut a, mut b) = (train(&cycloidal), train(&simple));
        for step in 0..500 {
            let t = f64::from(step) * 1e-3;
            for plant in [&mut a, &mut b] {
                plant.set("push.tau", push(t)).set("weight.tau", 1.0).run_to(t + 1e-3, 1e-3);
            }
            assert_eq!(a.bench.x, b.bench.x, "{loss}, t = {t}");
        }
    }
}
