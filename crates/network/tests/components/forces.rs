//! Forces from outside, contacts, sensors of frames and payloads, against closed forms.

use std::f64::consts::TAU;

use crate::plant::{Plant, close};

const G: f64 = 9.80665;

fn close_all(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        close(*found, *expected, tolerance);
    }
}

/// A bar of 2 kg on a hinge about y, its tip 0.5 m along x.
fn bar(more: &[(&str, &str)], lines: &[&str]) -> Plant {
    let mut blocks = vec![
        ("world", "World(gravity: (0.0, 0.0, 0.0))"),
        ("hinge", "RevoluteJoint(axis: (0.0, -1.0, 0.0), position: 0.6, velocity: 2.0)"),
        ("body", "Body(mass: 2.0, com: (0.25, 0.0, 0.0), moi: (0.01, 0.05, 0.05))"),
        ("tip", "Transform(translation: (0.5, 0.0, 0.0), rpy: (0.0, 0.3, 0.0))"),
    ];
    blocks.extend_from_slice(more);
    let mut connections = vec!["world.frame <-> hinge.base"];
    connections.extend_from_slice(lines);
    Plant::new(&blocks, &connections)
}

const INERTIA: f64 = 0.05 + 2.0 * 0.25 * 0.25;

#[test]
fn a_force_from_outside_turns_a_bar_by_its_lever() {
    let lines = ["hinge.follower <-> body.frame <-> tip.base", "tip.follower <-> push.frame"];
    let mut plant = bar(&[("push", "ExternalForce")], &lines);
    plant.set_all("push.force", &[3.0, 100.0, -4.0]).set_all("push.torque", &[50.0, -0.7, 20.0]);
    let (sin, cos) = 0.6_f64.sin_cos();
    let expected = |fx: f64, fz: f64| (0.5 * (cos * fz - sin * fx) + 0.7) / INERTIA;
    close(plant.get("hinge.a"), expected(3.0, -4.0), 1e-12);
    // In the axes of the frame, which is pitched by 0.3 rad against the bar, and the bar by -0.6.
    let mut plant = bar(&[("push", "ExternalForce(axes: Frame)")], &lines);
    plant.set_all("push.force", &[3.0, 0.0, -4.0]).set_all("push.torque", &[0.0, -0.7, 0.0]);
    let (s, c) = (0.3_f64 - 0.6).sin_cos();
    close(plant.get("hinge.a"), expected(c * 3.0 + s * -4.0, -s * 3.0 + c * -4.0), 1e-12);
}

#[test]
fn a_sensor_tells_where_a_frame_is_and_how_it_moves() {
    let lines = ["hinge.follower <-> body.frame <-> tip.base", "tip.follower <-> sensor.follower"];
    let mut plant = bar(&[("sensor", "TransformSensor")], &lines);
    let (sin, cos) = 0.6_f64.sin_cos();
    close_all(&plant.get_all("sensor.x"), &[0.5 * cos, 0.0, 0.5 * sin], 1e-15);
    close_all(&plant.get_all("sensor.v"), &[-sin, 0.0, cos], 1e-15);
    close_all(&plant.get_all("sensor.w"), &[0.0, -2.0, 0.0], 1e-15);
    close_all(&plant.get_all("sensor.rpy"), &[0.0, 0.3 - 0.6, 0.0], 1e-15);
    close_all(&plant.get_all("sensor.p"), &[0.15_f64.cos(), 0.0, -0.15_f64.sin(), 0.0], 1e-15);
    assert_eq!(plant.read_by("sensor.x"), Vec::<String>::new(), "positions break loops");
    // Seen from the bar itself the tip stands still.
    let lines =
        ["hinge.follower <-> body.frame <-> tip.base <-> sensor.base", "tip.follower <-> sensor.follower"];
    let mut plant = bar(&[("sensor", "TransformSensor")], &lines);
    plant.run_to(0.3, 1e-2);
    close_all(&plant.get_all("sensor.x"), &[0.5, 0.0, 0.0], 1e-15);
    close_all(&plant.get_all("sensor.v"), &[0.0; 3], 1e-15);
    close_all(&plant.get_all("sensor.rpy"), &[0.0, 0.3, 0.0], 1e-15);
}

#[test]
fn a_sensor_tells_how_a_frame_on_a_turning_bar_accelerates() {
    let blocks = [
        ("world", "World(gravity: (0.0, 0.0, 0.0))"),
        ("hinge", "RevoluteJoint(axis: (0.0, -1.0, 0.0), position: 0.6, velocity: 2.0)"),
        ("body", "Body(mass: 2.0, com: (0.25, 0.0, 0.0), moi: (0.01, 0.05, 0.05))"),
        ("tip", "Transform(translation: (0.5, 0.0, 0.0))"),
        ("sensor", "TransformSensor"),
        ("push", "ExternalForce"),
        ("post", "Transform(translation: (0.2, 0.7, -0.4))"),
        ("backwards", "TransformSensor"),
    ];
    let lines = [
        "world.frame <-> hinge.base <-> post.base",
        "hinge.follower <-> body.frame <-> tip.base <-> backwards.base",
        "tip.follower <-> sensor.follower <-> push.frame",
        "post.follower <-> backwards.follower",
    ];
    let mut plant = Plant::new(&blocks, &lines);
    let (sin, cos) = 0.6_f64.sin_cos();
    for torque in [0.0, 0.7] {
        plant.set_all("push.torque", &[0.0, -torque, 0.0]);
        // a = alpha x r - w^2 r
        let alpha = torque / INERTIA;
        let (along, across) = (-4.0 * 0.5, alpha * 0.5);
        let expected = [along * cos - across * sin, 0.0, along * sin + across * cos];
        close_all(&plant.get_all("sensor.a"), &expected, 1e-12);
        close_all(&plant.get_all("sensor.alpha"), &[0.0, -alpha, 0.0], 1e-12);
        // Who sits on the bar sees the world turn the other way round: a = -alpha x r - w^2 r in the axes of the bar.
        let [x, y, z] = plant.get_all("backwards.x")[..] else { panic!("three coordinates") };
        close(y, 0.7, 1e-15);
        let expected = [-4.0 * x + alpha * z, 0.0, -4.0 * z - alpha * x];
        close_all(&plant.get_all("backwards.a"), &expected, 1e-12);
        close_all(&plant.get_all("backwards.alpha"), &[0.0, alpha, 0.0], 1e-12);
    }
}

#[test]
fn accelerations_are_the_derivatives_of_the_speeds_that_an_observer_sees() {
    // An arm on a hinge, a body on a ball at its end, one seen from the other, neither along an axis of the other.
    let blocks = [
        ("world", "World"),
        ("hinge", "RevoluteJoint(axis: (0.0, 0.6, 0.8), position: 0.4, velocity: 2.0)"),
        ("arm", "Body(mass: 1.0, com: (0.2, 0.1, 0.0), moi: (0.02, 0.05, 0.04))"),
        ("end", "Transform(translation: (0.4, 0.0, 0.1), rpy: (0.5, -0.3, 0.9))"),
        ("ball", "SphericalJoint(velocity: (3.0, -1.0, 2.0))"),
        ("body", "Body(mass: 0.7, com: (0.1, 0.1, -0.2), moi: (0.01, 0.03, 0.02))"),
        ("eye", "Transform(translation: (-0.1, 0.3, 0.2), rpy: (-0.7, 0.2, 0.4))"),
        ("tip", "Transform(translation: (0.2, -0.1, -0.3), rpy: (0.1, 1.0, -0.6))"),
        ("sensor", "TransformSensor"),
        ("back", "TransformSensor"),
    ];
    let lines = [
        "world.frame <-> hinge.base",
        "hinge.follower <-> arm.frame <-> end.base <-> eye.base",
        "end.follower <-> ball.base",
        "ball.follower <-> body.frame <-> tip.base",
        "eye.follower <-> sensor.base <-> back.follower",
        "tip.follower <-> sensor.follower <-> back.base",
    ];
    let mut plant = Plant::new(&blocks, &lines);
    let h = 1e-3;
    plant.run_to(0.3, h);
    let samples: Vec<[Vec<f64>; 8]> = (0..5)
        .map(|k| {
            plant.run_to(0.3 + h * f64::from(k), 0.2 * h);
            ["sensor.v", "sensor.w", "back.v", "back.w", "sensor.a", "sensor.alpha", "back.a", "back.alpha"]
                .map(|name| plant.get_all(name))
        })
        .collect();
    for quantity in 0..4 {
        let measured = samples[2][quantity + 4].iter();
        for (axis, measured) in measured.enumerate() {
            let at = |k: usize| samples[k][quantity][axis];
            // Of fourth order in h; what is left is h^4 times a fifth derivative.
            let slope = (8.0 * (at(3) - at(1)) - (at(4) - at(0))) / (12.0 * h);
            close(*measured, slope, 1e-7 * (1.0 + slope.abs()));
        }
    }
    assert!(samples[2][4].iter().any(|a| a.abs() > 1.0), "nothing accelerates");
}

#[test]
fn a_mass_on_a_spring_between_frames_swings_at_its_frequency_and_falls_by_its_weight() {
    // It hangs from the world along z: l = l0 + m g / k at rest.
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", "FreeJoint(position: (0.0, 0.0, -0.4))"),
            ("body", "Body(mass: 2.0, moi: (0.01, 0.01, 0.01))"),
            ("spring", "FrameSpringDamper(stiffness: 200.0, length: 0.3)"),
        ],
        &["world.frame <-> joint.base <-> spring.base", "joint.follower <-> body.frame <-> spring.follower"],
    );
    let (w, rest) = (f64::sqrt(200.0 / 2.0), 0.3 + 2.0 * G / 200.0);
    close(plant.get("spring.l"), 0.4, 1e-15);
    close(plant.get("spring.f"), 20.0, 1e-12);
    for t in [0.1, 0.5, TAU / w] {
        plant.run_to(t.max(plant.bench.t + 1e-3), 1e-3);
        let t = plant.bench.t;
        close(plant.get("spring.l"), rest + (0.4 - rest) * (w * t).cos(), 1e-8);
        close(plant.get("spring.v"), -(0.4 - rest) * w * (w * t).sin(), 1e-7);
    }
}

#[test]
fn a_spring_between_two_bodies_keeps_their_momentum() {
    let mut plant = Plant::new(
        &[
            ("world", "World(gravity: (0.0, 0.0, 0.0))"),
            ("a", "FreeJoint(velocity: (1.0, 0.0, 0.0), spin: (0.3, 2.0, -1.0))"),
            ("b", "FreeJoint(position: (0.5, 0.3, 0.2), velocity: (0.0, -1.0, 0.5), spin: (1.0, 0.0, 0.4))"),
            ("body1", "Body(mass: 2.0, moi: (0.02, 0.03, 0.04))"),
            ("body2", "Body(mass: 1.0, moi: (0.01, 0.02, 0.02))"),
            ("arm1", "Transform(translation: (0.1, 0.05, 0.0))"),
            ("arm2", "Transform(translation: (0.0, -0.1, 0.1))"),
            ("spring", "FrameSpringDamper(stiffness: 300.0, damping: 4.0, length: 0.2)"),
        ],
        &[
            "world.frame <-> a.base <-> b.base",
            "a.follower <-> body1.frame <-> arm1.base",
            "b.follower <-> body2.frame <-> arm2.base",
            "arm1.follower <-> spring.base",
            "arm2.follower <-> spring.follower",
        ],
    );
    plant.run_to(1.0, 1e-3);
    let (va, vb) = (plant.get_all("a.v"), plant.get_all("b.v"));
    close_all(&[0, 1, 2].map(|k| 2.0 * va[k] + vb[k]), &[2.0, -1.0, 0.5], 1e-11);
}

/// A point of 2 kg above a plane that is tilted by `slope` about y.
fn above_a_plane(slope: f64, start: &str, contact: &str) -> Plant {
    let plane = format!("Transform(rpy: (0.0, {slope:?}, 0.0))");
    Plant::new(
        &[
            ("world", "World"),
            ("plane", &plane),
            ("joint", start),
            ("body", "Body(mass: 2.0, moi: (0.01, 0.01, 0.01))"),
            ("contact", contact),
        ],
        &[
            "world.frame <-> plane.base <-> joint.base",
            "plane.follower <-> contact.base",
            "joint.follower <-> body.frame <-> contact.follower",
        ],
    )
}

#[test]
fn a_point_bounces_elastically_from_a_stiff_plane_without_damping() {
    // No energy is lost: it comes back to the height it fell from.
    let contact = "PointPlaneContact(stiffness: 1e4, damping: 0.0, transition: 0.0)";
    let mut plant = above_a_plane(0.0, "FreeJoint(position: (0.0, 0.0, 0.5))", contact);
    let fall = f64::sqrt(2.0 * 0.5 / G);
    // Half a swing about the sunken rest: w = sqrt(k / m), entered at the speed g fall.
    let w = f64::sqrt(1e4 / 2.0);
    let sag = G / (w * w);
    let contact_time = (TAU - 2.0 * (G * fall / w).atan2(sag)) / w;
    let before = (fall - 1e-9, 1e-4);
    plant.run_to(before.0, before.1);
    assert_eq!(plant.get("contact.f"), 0.0, "nothing acts before it touches");
    plant.run_to(2.0 * fall + contact_time, 1e-5);
    close(plant.get_all("joint.x")[2], 0.5, 1e-6);
    close(plant.get_all("joint.v")[2], 0.0, 1e-4);
}

#[test]
fn a_point_comes_to_rest_at_the_depth_that_bears_its_weight_and_is_never_pulled() {
    let contact = "PointPlaneContact(stiffness: 1e4, damping: 300.0, transition: 0.0)";
    let mut plant = above_a_plane(0.0, "FreeJoint(position: (0.0, 0.0, 0.01))", contact);
    let mut least = f64::INFINITY;
    while plant.bench.t < 1.0 {
        plant.run_to(plant.bench.t + 1e-3, 5e-5);
        least = least.min(plant.get("contact.f"));
    }
    assert!(least >= 0.0, "{least}");
    close(plant.get("contact.depth"), 2.0 * G / 1e4, 1e-9);
}

#[test]
fn a_point_slides_down_a_slope_against_friction() {
    // a = g (sin - mu cos); it begins with a speed along the slope and at the depth that bears it.
    let (slope, mu) = (0.5_f64, 0.2);
    let (sin, cos) = slope.sin_cos();
    let depth = 2.0 * G * cos / 1e5;
    let (x, z) = (-depth * sin, -depth * cos);
    let start = format!(
        "FreeJoint(position: ({x:?}, 0.0, {z:?}), velocity: ({:?}, 0.0, {:?}))",
        0.5 * cos,
        -0.5 * sin
    );
    let contact =
        format!("PointPlaneContact(stiffness: 1e5, damping: 500.0, transition: 0.0, friction: {mu:?})");
    let mut plant = above_a_plane(slope, &start, &contact);
    // Which side of the jump of the force it begins on is a mode.
    plant.bench.major();
    close(plant.get("contact.f"), 2.0 * G * cos, 1e-9);
    plant.run_to(0.5, 1e-4);
    close(plant.get("contact.slip"), 0.5 + 0.5 * G * (sin - mu * cos), 1e-9);
}

#[test]
fn a_payload_changes_accelerations_at_once_and_speeds_not_at_all() {
    let (m, payload) = (2.0, 3.0);
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("hinge", "RevoluteJoint(axis: (0.0, -1.0, 0.0), velocity: 1.0)"),
            ("body", "Body(mass: 2.0, com: (0.25, 0.0, 0.0), moi: (0.01, 0.05, 0.05))"),
            ("tip", "Transform(translation: (0.5, 0.0, 0.0))"),
            ("load", "Payload(mass: 3.0, com: (0.1, 0.0, 0.0), moi: (0.0, 0.02, 0.02))"),
        ],
        &[
            "world.frame <-> hinge.base",
            "hinge.follower <-> body.frame <-> tip.base",
            "tip.follower <-> load.frame",
        ],
    );
    let inertia = |share: f64| 0.05 + m * 0.25 * 0.25 + share * (0.02 + payload * 0.6 * 0.6);
    let weight = |share: f64| G * (m * 0.25 + share * payload * 0.6);
    plant.set("load.attached", 1.0);
    close(plant.get("hinge.a"), -weight(1.0) / inertia(1.0), 1e-12);
    plant.run_to(0.3, 1e-3);
    let (q, w) = (plant.get("hinge.q"), plant.get("hinge.w"));
    plant.set("load.attached", 0.0);
    plant.bench.major();
    assert_eq!((plant.get("hinge.q"), plant.get("hinge.w")), (q, w));
    close(plant.get("hinge.a"), -weight(0.0) * q.cos() / inertia(0.0), 1e-12);
    // Without the load it swings on with its own energy.
    let energy = |plant: &mut Plant| {
        0.5 * inertia(0.0) * plant.get("hinge.w").powi(2) + weight(0.0) * plant.get("hinge.q").sin()
    };
    let before = energy(&mut plant);
    plant.run_to(1.0, 1e-3);
    close(energy(&mut plant), before, 1e-9);
}
