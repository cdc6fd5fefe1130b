//! Parts that slide, and what leads from rotation to translation.

use std::f64::consts::{PI, TAU};

use crate::plant::{Plant, close};

const G: f64 = 9.80665;

#[test]
fn a_mass_on_a_spring_and_a_damper_answers_a_step_as_its_closed_form_says() {
    let (m, k, d, force) = (2.0, 50.0, 4.0, 6.0);
    let (decay, t) = (d / (2.0 * m), 0.9);
    let w = f64::sqrt(k / m - decay * decay);
    let apart = [("spring", "TranslationalSpring(k: 50.0)"), ("damper", "TranslationalDamper(d: 4.0)")];
    let together =
        [("spring", "TranslationalSpringDamper(k: 50.0, d: 4.0)"), ("damper", "TranslationalDamper(d: 0.0)")];
    for links in [apart, together] {
        let mut plant = Plant::new(
            &[
                ("push", "IdealForceSource"),
                ("mass", "Mass(m: 2.0)"),
                links[0],
                links[1],
                ("sensor", "TranslationalMotionSensor(x0: 0.25)"),
                ("bed", "TranslationalReference"),
            ],
            &[
                "push.r <-> mass.r <-> spring.r <-> damper.r <-> sensor.r",
                "push.c <-> spring.c <-> damper.c <-> sensor.c <-> bed.r",
            ],
        );
        plant.set("push.f", force);
        close(plant.get("sensor.a"), force / m, 1e-14);
        plant.run_to(t, 1e-3);
        let (sin, cos) = (w * t).sin_cos();
        let fade = f64::exp(-decay * t);
        close(plant.get("sensor.x"), 0.25 + force / k * (1.0 - fade * (cos + decay / w * sin)), 1e-10);
        close(plant.get("sensor.v"), force / (m * w) * fade * sin, 1e-10);
        let velocity = plant.state("push.r.v");
        let measured = plant.get("sensor.v");
        assert_eq!(plant.bench.x[velocity], measured);
    }
}

#[test]
fn an_elastic_stop_throws_a_mass_back_with_its_own_speed() {
    let mut plant = Plant::new(
        &[
            ("mass", "Mass(m: 2.0, v0: 0.5)"),
            (
                "stop",
                "TranslationalHardStop(lower: -0.2, upper: 0.1, stiffness: 2e4, damping: 0.0, transition: 0.0)",
            ),
            ("sensor", "TranslationalMotionSensor"),
            ("bed", "TranslationalReference"),
        ],
        &["mass.r <-> stop.r <-> sensor.r", "stop.c <-> sensor.c <-> bed.r"],
    );
    // 0.2 s to the stop, half a swing of sqrt(k/m) = 100 rad/s in it; the steps of 10 us meet neither end of the contact
    // exactly, which costs their square times the change of stiffness.
    plant.run_to(0.2 + 0.25 * PI / 100.0, 1e-5);
    close(plant.get("stop.f"), 2e4 * 0.5 / 100.0 * f64::sin(0.25 * PI), 1e-2);
    plant.run_to(0.4, 1e-5);
    close(plant.get("sensor.v"), -0.5, 1e-6);
    close(plant.get("stop.f"), 0.0, 0.0);
}

#[test]
fn a_pressed_mass_comes_to_rest_in_the_stop_where_its_spring_holds_it() {
    let mut plant = Plant::new(
        &[
            ("mass", "Mass(m: 2.0)"),
            ("weight", "ConstantForce(f: -30.0)"),
            ("stop", "TranslationalHardStop(lower: -0.01, upper: 0.1, stiffness: 1e4, damping: 400.0)"),
            ("bed", "TranslationalReference"),
        ],
        &["mass.r <-> stop.r <-> weight.r", "stop.c <-> weight.c <-> bed.r"],
    );
    plant.run_to(2.0, 1e-4);
    close(plant.get("stop.x"), -0.01 - 30.0 / 1e4, 1e-9);
    close(plant.get("stop.f"), -30.0, 1e-5);
}

#[test]
fn a_force_sensor_reads_what_accelerates_the_part_behind_it() {
    let mut plant = Plant::new(
        &[
            ("drive", "IdealForceSource"),
            ("first", "Mass(m: 2.0)"),
            ("sensor", "ForceSensor"),
            ("second", "Mass(m: 3.0)"),
            ("bed", "TranslationalReference"),
        ],
        &["drive.r <-> first.r <-> sensor.r", "sensor.c <-> second.r", "drive.c <-> bed.r"],
    );
    plant.set("drive.f", 10.0);
    close(plant.get("sensor.f"), 6.0, 1e-14);
}

#[test]
fn a_velocity_source_needs_force_for_friction_and_for_acceleration() {
    let mut plant = Plant::new(
        &[
            ("drive", "IdealVelocitySource"),
            ("mass", "Mass(m: 3.0)"),
            (
                "guide",
                "TranslationalFriction(breakaway: 8.0, breakaway_velocity: 0.001, coulomb: 8.0, viscous: 5.0)",
            ),
            ("bed", "TranslationalReference"),
        ],
        &["drive.r <-> mass.r <-> guide.r", "drive.c <-> guide.c <-> bed.r"],
    );
    plant.set("drive.v", 2.0).set("drive.dv", 1.5);
    close(plant.get("drive.f"), 3.0 * 1.5 + 8.0 + 5.0 * 2.0, 1e-12);
}

/// A motor that pushes a load with friction through a gear or a converter.
fn driven(gear: &str, slides: bool) -> Plant {
    let parts: [&str; 4] = match slides {
        true => [
            "Mass(m: 3.0)",
            "TranslationalDamper(d: 7.0)",
            "TranslationalReference",
            "TranslationalMotionSensor",
        ],
        false => ["Inertia(j: 3.0)", "RotationalDamper(d: 7.0)", "RotationalReference", "MotionSensor"],
    };
    Plant::new(
        &[
            ("push", "IdealTorqueSource"),
            ("rotor", "Inertia(j: 2e-3)"),
            ("gear", gear),
            ("load", parts[0]),
            ("oil", parts[1]),
            ("bed", parts[2]),
            ("sensor", parts[3]),
            ("frame", "RotationalReference"),
        ],
        &[
            "push.r <-> rotor.r <-> gear.base",
            "gear.follower <-> load.r <-> oil.r <-> sensor.r",
            "push.c <-> frame.r",
            "oil.c <-> sensor.c <-> bed.r",
        ],
    )
}

#[test]
fn a_rack_is_a_gear_whose_ratio_is_the_inverse_of_the_radius() {
    // Radii whose inverses are exact.
    for (radius, ratio) in [(0.0625, 16.0), (0.125, 8.0)] {
        for (direction, efficiency) in [("Same", 1.0), ("Reversed", 0.8)] {
            let losses = format!("direction: {direction}, efficiency: {efficiency:?}");
            let mut rack = driven(&format!("RackAndPinion(radius: {radius:?}, {losses})"), true);
            let mut gear = driven(&format!("SimpleGear(ratio: {ratio:?}, {losses})"), false);
            for step in 0..200 {
                let t = f64::from(step) * 1e-2;
                for plant in [&mut rack, &mut gear] {
                    plant.set("push.tau", crate::gears::push(t)).run_to(t + 1e-2, 1e-3);
                }
                assert_eq!(rack.bench.x, gear.bench.x, "{radius}, {direction}, t = {t}");
                assert_eq!(rack.get("sensor.a"), gear.get("sensor.a"));
                assert_eq!(rack.get("gear.tau"), gear.get("gear.tau"));
            }
        }
    }
}

#[test]
fn masses_count_with_the_square_of_the_radius_at_the_shaft() {
    for (kind, radius) in [
        ("WheelAndAxle(radius: 0.31)", 0.31),
        ("RackAndPinion(radius: 0.02, direction: Reversed)", -0.02),
        ("LeadScrew(lead: 0.01)", 0.01 / TAU),
        ("LeadScrew(lead: 1e-6, direction: Reversed)", -1e-6 / TAU),
        ("LeadScrewByFriction(lead: 0.01, diameter: 0.02, friction: 0.0)", 0.01 / TAU),
    ] {
        let mut plant = driven(kind, true);
        plant.set("push.tau", 0.4);
        let expected = radius * 0.4 / (2e-3 + 3.0 * radius * radius);
        close(plant.get("sensor.a"), expected, 1e-12 * expected.abs());
    }
}

/// A screw that lifts 20 kg at a given speed.
fn lift(screw: &str) -> Plant {
    let weight = format!("ConstantForce(f: {:?})", -20.0 * G);
    Plant::new(
        &[
            ("turn", "IdealSpeedSource"),
            ("screw", screw),
            ("sensor", "ForceSensor"),
            ("table", "Mass(m: 20.0)"),
            ("weight", &weight),
            ("frame", "RotationalReference"),
            ("column", "TranslationalReference"),
        ],
        &[
            "turn.r <-> screw.base",
            "turn.c <-> frame.r",
            "screw.follower <-> sensor.r",
            "sensor.c <-> table.r <-> weight.r",
            "weight.c <-> column.r",
        ],
    )
}

#[test]
fn a_screw_takes_power_over_its_efficiency_to_lift_and_gives_back_its_share() {
    let mut plant = lift("LeadScrew(lead: 0.01, efficiency_forward: 0.8, efficiency_backward: 0.7)");
    let w = 100.0;
    let lifting = 20.0 * G * w * 0.01 / TAU;
    plant.set("turn.w", w);
    close(plant.get("sensor.f"), 20.0 * G, 1e-10);
    close(plant.get("turn.tau") * w, lifting / 0.8, 1e-10);
    close(plant.get("screw.tau"), plant.get("turn.tau"), 1e-13);
    plant.set("turn.w", -w);
    close(plant.get("turn.tau") * w, 0.7 * lifting, 1e-10);
    // While it speeds up, the force of inertia goes through the screw as well.
    plant.set("turn.w", w).set("turn.dw", 500.0);
    close(plant.get("sensor.f"), 20.0 * (G + 500.0 * 0.01 / TAU), 1e-10);
    close(plant.get("turn.tau"), plant.get("sensor.f") * 0.01 / TAU / 0.8, 1e-12);
}

#[test]
fn a_screw_given_by_its_friction_takes_the_torque_of_the_textbook() {
    // tau = F d/2 tan(lambda + rho) up and F d/2 tan(lambda - rho) down, at the pitch diameter d.
    let mut plant =
        lift("LeadScrewByFriction(lead: 0.01, diameter: 0.018, friction: 0.1, flank_angle: 0.2618)");
    let lambda = f64::atan(0.01 / (PI * 0.018));
    let rho = f64::atan(0.1 / f64::cos(0.2618));
    for (w, angle) in [(50.0, lambda + rho), (-50.0, lambda - rho)] {
        plant.set("turn.w", w);
        close(plant.get("turn.tau"), 20.0 * G * 0.009 * angle.tan(), 1e-12);
    }
}

#[test]
fn a_pinion_lifts_the_body_of_a_joint_and_counts_with_its_inertia() {
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", "PrismaticJoint"),
            ("body", "Body(mass: 4.0)"),
            ("rack", "RackAndPinion(radius: 0.05)"),
            ("rotor", "Inertia(j: 0.03)"),
            ("push", "IdealTorqueSource"),
            ("frame", "RotationalReference"),
            ("column", "TranslationalReference"),
        ],
        &[
            "world.frame <-> joint.base",
            "joint.follower <-> body.frame",
            "push.r <-> rotor.r <-> rack.base",
            "push.c <-> frame.r",
            "rack.follower <-> joint.r",
            "joint.c <-> column.r",
        ],
    );
    plant.set("push.tau", 5.0);
    close(plant.get("joint.a"), (5.0 / 0.05 - 4.0 * G) / (4.0 + 0.03 / 0.0025), 1e-12);
}
