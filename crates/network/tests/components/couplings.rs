//! Planetary gears, differentials and harmonic drives: ratios, division of torque, balance of power.

use crate::gears::{push, train};
use crate::plant::{Plant, assembled, close};

const PLANETARY: (&str, &str) = ("gear", "PlanetaryGear(ring_teeth: 72, sun_teeth: 24)");
const FRAME: (&str, &str) = ("frame", "RotationalReference");

#[test]
fn a_planetary_gear_with_one_port_held_has_the_textbook_ratio() {
    // w_S + 3 w_R = 4 w_C. Held port, driven and loaded port, ratio of their speeds, torque on the frame per N*m.
    for (held, driven, loaded, ratio, reaction) in [
        ("ring", "sun", "carrier", 4.0, -3.0),
        ("carrier", "sun", "ring", -3.0, 4.0),
        ("sun", "ring", "carrier", 4.0 / 3.0, -1.0 / 3.0),
        ("sun", "carrier", "ring", 0.75, 0.25),
    ] {
        let mut plant = Plant::new(
            &[
                PLANETARY,
                FRAME,
                ("push", "IdealTorqueSource"),
                ("disc", "Inertia(j: 0.5)"),
                ("in", "MotionSensor"),
                ("out", "MotionSensor"),
                ("hold", "TorqueSensor"),
            ],
            &[
                &format!("push.r <-> in.r <-> gear.{driven}"),
                &format!("disc.r <-> out.r <-> gear.{loaded}"),
                &format!("hold.r <-> gear.{held}"),
                "push.c <-> in.c <-> out.c <-> hold.c <-> frame.r",
            ],
        );
        plant.set("push.tau", 2.0).run_to(0.5, 1e-2);
        close(plant.get("out.a"), ratio * 2.0 / 0.5, 1e-12);
        close(plant.get("in.w"), ratio * plant.get("out.w"), 1e-12);
        close(plant.get("hold.tau"), reaction * 2.0, 1e-12);
    }
}

/// The gear with an inertia, a torque and sensors at each of its ports.
fn free_planetary() -> Plant {
    let blocks = [
        PLANETARY,
        FRAME,
        ("sun", "Inertia(j: 0.02)"),
        ("carrier", "Inertia(j: 0.3)"),
        ("ring", "Inertia(j: 0.05)"),
        ("push_sun", "IdealTorqueSource"),
        ("push_carrier", "IdealTorqueSource"),
        ("push_ring", "IdealTorqueSource"),
        ("motion_sun", "MotionSensor"),
        ("motion_carrier", "MotionSensor"),
        ("motion_ring", "MotionSensor"),
        ("into_sun", "TorqueSensor"),
        ("into_carrier", "TorqueSensor"),
        ("into_ring", "TorqueSensor"),
    ];
    let mut lines = vec![
        "push_sun.c <-> push_carrier.c <-> push_ring.c <-> motion_sun.c <-> motion_carrier.c <-> \
         motion_ring.c <-> frame.r"
            .to_owned(),
    ];
    for port in ["sun", "carrier", "ring"] {
        lines.push(format!("{port}.r <-> push_{port}.r <-> motion_{port}.r <-> into_{port}.r"));
        lines.push(format!("into_{port}.c <-> gear.{port}"));
    }
    Plant::new(&blocks, &lines.iter().map(String::as_str).collect::<Vec<_>>())
}

#[test]
fn torques_into_a_planetary_gear_are_those_of_its_lagrange_multiplier_and_their_power_adds_up_to_zero() {
    let ports = ["sun", "carrier", "ring"];
    let (factors, inertias, pushes) = ([1.0, -4.0, 3.0], [0.02, 0.3, 0.05], [0.7, -0.4, 1.1]);
    // J dw = tau - a lambda and a dw = 0.
    let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(of).sum::<f64>();
    let lambda =
        sum(&|i| factors[i] * pushes[i] / inertias[i]) / sum(&|i| factors[i] * factors[i] / inertias[i]);
    let mut plant = free_planetary();
    for (port, tau) in ports.iter().zip(pushes) {
        plant.set(&format!("push_{port}.tau"), tau);
    }
    plant.run_to(1.5, 1e-2);
    let (mut power, mut torque, mut relation) = (0.0, 0.0, 0.0);
    for (i, port) in ports.iter().enumerate() {
        let into = plant.get(&format!("into_{port}.tau"));
        let w = plant.get(&format!("motion_{port}.w"));
        close(into, factors[i] * lambda, 1e-12);
        close(w, 1.5 * (pushes[i] - factors[i] * lambda) / inertias[i], 1e-10);
        power += into * w;
        torque += into;
        relation += factors[i] * w;
    }
    close(power, 0.0, 1e-10);
    close(torque, 0.0, 1e-12);
    close(relation, 0.0, 1e-12);
}

/// Torque that the driven port of a gear needs at a steady speed `w`, where a torque of 12 N*m brakes the loaded port (or
/// drives it, if it is negative).
fn needed(gear: &str, held: &str, driven: &str, loaded: &str, w: f64, load: f64) -> (f64, f64) {
    let blocks = [
        ("gear", gear),
        FRAME,
        ("speed", "IdealSpeedSource"),
        ("brake", "IdealTorqueSource"),
        ("into", "TorqueSensor"),
        ("out", "MotionSensor"),
    ];
    let lines = [
        "speed.r <-> into.r".to_owned(),
        format!("into.c <-> gear.{driven}"),
        format!("brake.r <-> out.r <-> gear.{loaded}"),
        format!("speed.c <-> brake.c <-> out.c <-> gear.{held} <-> frame.r"),
    ];
    let mut plant = Plant::new(&blocks, &lines.each_ref().map(String::as_str));
    plant.set("speed.w", w).set("brake.tau", -load).bench.major();
    (plant.get("into.tau"), plant.get("out.w"))
}

#[test]
fn efficiencies_of_a_planetary_gear_are_those_of_the_textbook() {
    // VDI 2157: the efficiency with a fixed carrier says those of all other ways through the gear.
    let (g, e) = (3.0, 0.9);
    for loss in ["", ", loss: Published", ", loss: Stiction"] {
        let gear = format!("PlanetaryGear(ring_teeth: 72, sun_teeth: 24, efficiency: 0.9{loss})");
        for (held, driven, loaded, forth, back) in [
            ("carrier", "sun", "ring", e, e),
            ("ring", "sun", "carrier", (1.0 + g * e) / (1.0 + g), (1.0 + g) / (1.0 + g / e)),
            (
                "sun",
                "ring",
                "carrier",
                (1.0 + e / g) / (1.0 + 1.0 / g),
                (1.0 + 1.0 / g) / (1.0 + 1.0 / g / e),
            ),
        ] {
            for w in [100.0, -100.0] {
                let (_, out) = needed(&gear, held, driven, loaded, w, 0.0);
                // The load brakes, whatever the direction; then it drives.
                let (tau, _) = needed(&gear, held, driven, loaded, w, 12.0 * out.signum());
                close(12.0 * out.abs() / (tau * w), forth, 1e-9);
                let (tau, _) = needed(&gear, held, driven, loaded, w, -12.0 * out.signum());
                close(tau * w / (-12.0 * out.abs()), back, 1e-9);
            }
        }
    }
}

#[test]
fn a_planetary_gear_that_turns_as_one_loses_nothing() {
    let blocks = [
        ("gear", "PlanetaryGear(ring_teeth: 72, sun_teeth: 24, efficiency: 0.5)"),
        FRAME,
        ("sun", "Inertia(j: 0.1, w0: 50.0)"),
        ("carrier", "Inertia(j: 0.1, w0: 50.0)"),
        ("ring", "Inertia(j: 0.3, w0: 50.0)"),
        ("out", "MotionSensor"),
    ];
    let lines = [
        "sun.r <-> gear.sun",
        "carrier.r <-> gear.carrier <-> out.r",
        "ring.r <-> gear.ring",
        "out.c <-> frame.r",
    ];
    let mut plant = Plant::new(&blocks, &lines);
    plant.run_to(1.0, 1e-2);
    close(plant.get("out.w"), 50.0, 1e-12);
}

#[test]
fn a_differential_loses_in_its_final_drive_and_where_its_outputs_differ() {
    for loss in ["", ", loss: Stiction"] {
        // Both outputs held together: the final drive alone.
        let gear = format!("Differential(ratio: 4.0, efficiency: 0.9, inner_efficiency: 0.8{loss})");
        let both = |w: f64, load: f64| {
            let blocks = [
                ("gear", gear.as_str()),
                FRAME,
                ("speed", "IdealSpeedSource"),
                ("brake", "IdealTorqueSource"),
                ("into", "TorqueSensor"),
            ];
            let lines = [
                "speed.r <-> into.r",
                "into.c <-> gear.drive",
                "brake.r <-> gear.left <-> gear.right",
                "speed.c <-> brake.c <-> frame.r",
            ];
            let mut plant = Plant::new(&blocks, &lines);
            plant.set("speed.w", w).set("brake.tau", -load).bench.major();
            plant.get("into.tau")
        };
        close(both(40.0, 12.0), 12.0 / 4.0 / 0.9, 1e-12);
        close(both(40.0, -12.0), -12.0 / 4.0 * 0.9, 1e-12);
        // The drive shaft held: from one output to the other, backwards.
        let (tau, out) = needed(&gear, "drive", "left", "right", 50.0, -12.0);
        close(out, -50.0, 1e-12);
        close(tau, 12.0 / 0.8, 1e-9);
        // One output held: half of the power does not roll.
        let (tau, out) = needed(&gear, "left", "drive", "right", 400.0, 12.0);
        close(out, 200.0, 1e-12);
        // The cage gets 0.9 of the drive; the output that turns is the faster one, so the other holds 1 / 0.8 of it.
        close(tau, 12.0 * (1.0 + 1.0 / 0.8) / 4.0 / 0.9, 1e-9);
    }
}

/// A planetary gear whose parts start turning.
fn spinning(carrier: &str, ring: &str) -> Result<Plant, String> {
    let blocks = [
        PLANETARY,
        FRAME,
        ("sun", "Inertia(j: 0.02, w0: 10.0)"),
        ("carrier", carrier),
        ("ring", ring),
        ("look", "MotionSensor"),
    ];
    let lines = [
        "sun.r <-> gear.sun",
        "carrier.r <-> gear.carrier",
        "ring.r <-> gear.ring <-> look.r",
        "look.c <-> frame.r",
    ];
    match assembled(&blocks, &lines) {
        Ok(_) => Ok(Plant::new(&blocks, &lines)),
        Err(problems) => Err(problems[0].code.to_owned()),
    }
}

#[test]
fn two_start_speeds_of_a_planetary_gear_give_the_third() {
    let mut plant = spinning("Inertia(j: 0.3, w0: 4.0)", "Inertia(j: 0.1)").expect("a network");
    close(plant.get("look.w"), 2.0, 1e-12);
    let mut plant = spinning("Inertia(j: 0.3, w0: 4.0)", "Inertia(j: 0.1, w0: 2.0)").expect("a network");
    close(plant.get("look.w"), 2.0, 1e-12);
    let conflict = spinning("Inertia(j: 0.3, w0: 4.0)", "Inertia(j: 0.1, w0: 3.0)");
    assert_eq!(conflict.err().as_deref(), Some("start_conflict"));
}

#[test]
fn two_planetary_gears_side_by_side_are_rigid_twice_over() {
    let problems = assembled(
        &[
            PLANETARY,
            ("twin", "PlanetaryGear(ring_teeth: 36, sun_teeth: 12)"),
            ("sun", "Inertia(j: 0.02)"),
            ("ring", "Inertia(j: 0.1)"),
        ],
        &[
            "sun.r <-> gear.sun <-> twin.sun",
            "gear.carrier <-> twin.carrier",
            "ring.r <-> gear.ring <-> twin.ring",
        ],
    )
    .expect_err("a problem");
    assert_eq!(problems[0].code, "indeterminate_torque");
    assert!(problems[0].members.iter().all(|(_, role)| role == "couples these speeds"));
}

/// A differential with two wheels of unequal inertia.
fn axle() -> Plant {
    Plant::new(
        &[
            ("gear", "Differential(ratio: 4.0)"),
            FRAME,
            ("push", "IdealTorqueSource"),
            ("shaft", "Inertia(j: 0.01)"),
            ("road", "IdealTorqueSource"),
            ("left", "Inertia(j: 0.5)"),
            ("right", "Inertia(j: 1.5)"),
            ("to_left", "TorqueSensor"),
            ("to_right", "TorqueSensor"),
            ("turn", "MotionSensor"),
            ("turn_left", "MotionSensor"),
            ("turn_right", "MotionSensor"),
        ],
        &[
            "push.r <-> shaft.r <-> turn.r <-> gear.drive",
            "gear.left <-> to_left.r",
            "gear.right <-> to_right.r",
            "to_left.c <-> left.r <-> turn_left.r <-> road.r",
            "to_right.c <-> right.r <-> turn_right.r",
            "push.c <-> road.c <-> turn.c <-> turn_left.c <-> turn_right.c <-> frame.r",
        ],
    )
}

#[test]
fn a_differential_divides_the_torque_equally_whatever_the_wheels_do() {
    let mut plant = axle();
    plant.set("push.tau", 10.0);
    for road in [0.0, -15.0, 40.0] {
        let end = plant.bench.t + 0.3;
        plant.set("road.tau", road).run_to(end, 1e-2);
        let (left, right) = (plant.get("to_left.tau"), plant.get("to_right.tau"));
        close(left, right, 1e-11);
        // What the drive shaft does not keep, times half the ratio.
        close(left, 2.0 * (10.0 - 0.01 * plant.get("turn.a")), 1e-11);
        close(plant.get("turn_left.a"), (left + road) / 0.5, 1e-10);
        close(plant.get("turn_right.a"), right / 1.5, 1e-10);
        close(plant.get("turn.w"), 2.0 * (plant.get("turn_left.w") + plant.get("turn_right.w")), 1e-10);
    }
}

#[test]
fn a_wheel_on_ice_takes_the_whole_speed_when_the_other_stands() {
    let mut plant = Plant::new(
        &[
            ("gear", "Differential(ratio: 4.0)"),
            FRAME,
            ("drive", "IdealSpeedSource"),
            ("wheel", "Inertia(j: 0.5)"),
            ("turn", "MotionSensor"),
        ],
        &[
            "drive.r <-> gear.drive",
            "gear.left <-> wheel.r <-> turn.r",
            "gear.right <-> drive.c <-> turn.c <-> frame.r",
        ],
    );
    plant.set("drive.w", 100.0);
    close(plant.get("turn.w"), 50.0, 1e-12);
}

#[test]
fn a_harmonic_drive_is_a_cycloidal_drive_of_the_same_ratio() {
    for (direction, loss) in [("Reversed", "Dissipative"), ("Same", "Published")] {
        let parameters = format!(
            "direction: {direction}, efficiency_forward: 0.75, efficiency_backward: 0.6, loss: {loss}, \
             power_threshold: 1.0)"
        );
        let harmonic = format!("HarmonicDrive(flexspline_teeth: 100, circular_teeth: 102, {parameters}");
        let cycloidal = format!("CycloidalDrive(disc_teeth: 50, ring_teeth: 51, {parameters}");
        let (mut a, mut b) = (train(&harmonic), train(&cycloidal));
        for step in 0..300 {
            let t = f64::from(step) * 1e-3;
            for plant in [&mut a, &mut b] {
                plant.set("push.tau", push(t)).set("weight.tau", 1.0).run_to(t + 1e-3, 1e-3);
            }
            assert_eq!(a.bench.x, b.bench.x, "{loss}, t = {t}");
        }
    }
}
