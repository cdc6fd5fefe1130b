//! Joints with several degrees of freedom, and joints that are mounted the other way round.

use std::f64::consts::TAU;

use crate::plant::{Plant, close};

const G: f64 = 9.80665;

fn close_all(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        close(*found, *expected, tolerance);
    }
}

/// A body of 2 kg with different moments of inertia at a joint on the world.
fn carried(joint: &str) -> Plant {
    Plant::new(
        &[
            ("world", "World"),
            ("joint", joint),
            (
                "body",
                "Body(mass: 2.0, com: (0.1, -0.2, 0.3), moi: (0.3, 0.5, 0.7), poi: (0.02, -0.03, 0.05))",
            ),
        ],
        &["world.frame <-> joint.base", "joint.follower <-> body.frame"],
    )
}

#[test]
fn a_mass_on_a_spring_slides_as_the_closed_form_says() {
    // x'' = -g - k/m x - d/m x'
    let (m, k, d) = (2.0, 50.0, 1.0);
    let mut plant = carried(&format!("PrismaticJoint(position: 0.3, stiffness: {k:?}, damping: {d:?})"));
    let (rest, decay) = (-m * G / k, d / (2.0 * m));
    let w = f64::sqrt(k / m - decay * decay);
    let t = 1.7;
    plant.run_to(t, 1e-3);
    let start = 0.3 - rest;
    let expected = rest + start * f64::exp(-decay * t) * ((w * t).cos() + decay / w * (w * t).sin());
    close(plant.get("joint.x"), expected, 1e-10);
    plant.set("joint.force", 7.0);
    let (x, v) = (plant.get("joint.x"), plant.get("joint.v"));
    close(plant.get("joint.a"), (7.0 - k * x - d * v) / m - G, 1e-12);
    assert_eq!(plant.get("joint.f"), 7.0, "actuators only");
}

#[test]
fn a_slide_comes_to_rest_in_its_limit() {
    let mut plant = carried(
        "PrismaticJoint(position: 0.05, damping: 20.0, lower: 0.0, limit_stiffness: 1e5, limit_damping: 1e3, \
         limit_transition: 0.0)",
    );
    plant.run_to(3.0, 1e-3);
    close(plant.get("joint.x"), -2.0 * G / 1e5, 1e-9);
}

#[test]
fn a_free_body_falls_while_it_tumbles() {
    let mut plant =
        carried("FreeJoint(position: (0.0, 0.0, 2.0), velocity: (1.0, 0.0, 3.0), spin: (0.5, 4.0, -0.3))");
    let com = |plant: &mut Plant| {
        let (x, p) = (plant.get_all("joint.x"), plant.get_all("joint.p"));
        let turned = turned_by(&p, [0.1, -0.2, 0.3]);
        [0, 1, 2].map(|k| x[k] + turned[k])
    };
    let start = com(&mut plant);
    // the velocity of the centre of mass: v + w x c
    let v = [1.0 + 4.0 * 0.3 - (-0.3) * -0.2, -0.3 * 0.1 - 0.5 * 0.3, 3.0 + 0.5 * -0.2 - 4.0 * 0.1];
    let t = 0.8;
    plant.run_to(t, 1e-3);
    let end = com(&mut plant);
    let expected = [start[0] + v[0] * t, start[1] + v[1] * t, start[2] + v[2] * t - 0.5 * G * t * t];
    close_all(&end, &expected, 1e-10);
    let p = plant.get_all("joint.p");
    close(p.iter().map(|e| e * e).sum(), 1.0, 1e-15);
}

/// A vector turned by a quaternion: `v + 2 w (u x v) + 2 u x (u x v)`.
fn turned_by(p: &[f64], v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = [p[1], p[2], p[3]];
    let first = cross(u, v);
    let second = cross(u, first);
    [0, 1, 2].map(|k| v[k] + 2.0 * (p[0] * first[k] + second[k]))
}

#[test]
fn a_ball_joint_that_starts_in_a_plane_swings_as_a_hinge_does() {
    let body = ("body", "Body(mass: 2.0, com: (0.0, 0.0, -0.4), moi: (0.05, 0.05, 0.01))");
    let lines = ["world.frame <-> joint.base", "joint.follower <-> body.frame"];
    let plant = |joint| Plant::new(&[("world", "World"), ("joint", joint), body], &lines);
    let mut ball = plant("SphericalJoint(rpy: (0.0, 1.2, 0.0), velocity: (0.0, 0.7, 0.0))");
    let mut hinge = plant("RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 1.2, velocity: 0.7)");
    ball.run_to(2.0, 1e-3);
    hinge.run_to(2.0, 1e-3);
    let angle = hinge.get("joint.q");
    close_all(&ball.get_all("joint.w"), &[0.0, hinge.get("joint.w"), 0.0], 1e-9);
    close_all(&ball.get_all("joint.p"), &[(angle / 2.0).cos(), 0.0, (angle / 2.0).sin(), 0.0], 1e-9);
    close_all(&ball.get_all("joint.a"), &[0.0, hinge.get("joint.a"), 0.0], 1e-8);
}

#[test]
fn a_ball_joint_swings_conically() {
    // A point mass on a rod of length l turns about the vertical with w^2 = g / (l cos(tilt)).
    let (l, tilt) = (0.4_f64, 0.5_f64);
    let w = f64::sqrt(G / (l * tilt.cos()));
    // Tilted about y; the rate about the vertical in the axes of the body is (-w sin(tilt), 0, w cos(tilt)).
    let joint = format!(
        "SphericalJoint(rpy: (0.0, {:?}, 0.0), velocity: ({:?}, 0.0, {:?}))",
        -tilt,
        w * tilt.sin(),
        w * tilt.cos()
    );
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", &joint),
            ("bob", "Body(mass: 2.0, com: (0.0, 0.0, -0.4), moi: (1e-9, 1e-9, 1e-9))"),
        ],
        &["world.frame <-> joint.base", "joint.follower <-> bob.frame"],
    );
    let start = turned_by(&plant.get_all("joint.p"), [0.0, 0.0, -l]);
    let turn = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        [cos * start[0] - sin * start[1], sin * start[0] + cos * start[1], start[2]]
    };
    for part in [0.25, 0.6, 1.0] {
        plant.run_to(part * TAU / w, 2e-4);
        let found = turned_by(&plant.get_all("joint.p"), [0.0, 0.0, -l]);
        close_all(&found, &turn(part * TAU), 1e-8);
    }
}

#[test]
fn a_universal_joint_is_two_hinges() {
    let body = ("body", "Body(mass: 2.0, com: (0.1, -0.2, 0.3), moi: (0.3, 0.5, 0.7))");
    let mut one = Plant::new(
        &[
            ("world", "World"),
            (
                "joint",
                "UniversalJoint(position: (0.4, -0.3), velocity: (1.0, 2.0), stiffness: 3.0, damping: 0.1)",
            ),
            body,
        ],
        &["world.frame <-> joint.base", "joint.follower <-> body.frame"],
    );
    let hinge = "stiffness: 3.0, damping: 0.1)";
    let first = format!("RevoluteJoint(axis: (1.0, 0.0, 0.0), position: 0.4, velocity: 1.0, {hinge}");
    let second = format!("RevoluteJoint(axis: (0.0, 1.0, 0.0), position: -0.3, velocity: 2.0, {hinge}");
    let mut two = Plant::new(
        &[("world", "World"), ("first", &first), ("second", &second), body],
        &["world.frame <-> first.base", "first.follower <-> second.base", "second.follower <-> body.frame"],
    );
    one.set_all("joint.torque", &[0.5, -0.2]);
    two.set("first.torque", 0.5).set("second.torque", -0.2);
    one.run_to(1.0, 1e-3);
    two.run_to(1.0, 1e-3);
    close_all(&one.get_all("joint.q"), &[two.get("first.q"), two.get("second.q")], 1e-13);
    close_all(&one.get_all("joint.a"), &[two.get("first.a"), two.get("second.a")], 1e-12);
}

#[test]
fn a_cylindrical_joint_and_a_planar_joint_move_along_and_about() {
    let round = "Body(mass: 2.0, moi: (0.5, 0.5, 0.7))";
    let lines = ["world.frame <-> joint.base", "joint.follower <-> body.frame"];
    let mut plant = Plant::new(
        &[("world", "World"), ("joint", "CylindricalJoint(velocity: 1.0, speed: 2.0)"), ("body", round)],
        &lines,
    );
    plant.set("joint.force", 3.0).set("joint.torque", 0.35);
    close(plant.get("joint.a"), 1.5 - G, 1e-13);
    close(plant.get("joint.alpha"), 0.5, 1e-13);
    plant.run_to(2.0, 1e-2);
    close(plant.get("joint.x"), 2.0 + 2.0 * (1.5 - G), 1e-10);
    close(plant.get("joint.q"), 5.0, 1e-10);
    let mut plant = Plant::new(
        &[("world", "World"), ("joint", "PlanarJoint(velocity: (1.0, -1.0), speed: 3.0)"), ("body", round)],
        &lines,
    );
    plant.set_all("joint.force", &[4.0, 6.0]).set("joint.torque", 1.4);
    plant.run_to(2.0, 1e-2);
    close_all(&plant.get_all("joint.x"), &[2.0 + 4.0, -2.0 + 6.0], 1e-10);
    close(plant.get("joint.q"), 6.0 + 4.0, 1e-10);
    close(plant.get("joint.alpha"), 2.0, 1e-13);
}

/// The same two links, with the second joint mounted forwards or backwards.
fn two_links(second: &str, forward: bool) -> Plant {
    let (near, far) = if forward { ("base", "follower") } else { ("follower", "base") };
    let (near, far) = (format!("offset.follower <-> second.{near}"), format!("second.{far} <-> tip.frame"));
    Plant::new(
        &[
            ("world", "World"),
            ("first", "RevoluteJoint(axis: (0.0, 0.6, 0.8), position: 0.4, velocity: 1.0)"),
            ("link", "Body(mass: 3.0, com: (0.2, 0.01, 0.0), moi: (0.01, 0.05, 0.055))"),
            ("offset", "Transform(translation: (0.5, 0.1, 0.0), rpy: (0.3, -0.2, 0.7))"),
            ("second", second),
            ("tip", "Body(mass: 1.5, com: (0.3, 0.0, -0.05), moi: (0.04, 0.03, 0.031))"),
        ],
        &["world.frame <-> first.base", "first.follower <-> link.frame <-> offset.base", &near, &far],
    )
}

#[test]
fn a_joint_mounted_backwards_is_the_inverse_of_its_motion() {
    // An axis only points the other way.
    let forward = "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.7, velocity: -2.0, damping: 0.1)";
    let backward = "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: -0.7, velocity: 2.0, damping: 0.1)";
    let (mut a, mut b) = (two_links(forward, true), two_links(backward, false));
    a.set("second.torque", 1.5);
    b.set("second.torque", -1.5);
    a.run_to(1.0, 1e-3);
    b.run_to(1.0, 1e-3);
    for (name, sign) in
        [("first.q", 1.0), ("first.a", 1.0), ("second.q", -1.0), ("second.w", -1.0), ("second.a", -1.0)]
    {
        close(b.get(name), sign * a.get(name), 1e-10);
    }
}

#[test]
fn a_ball_joint_mounted_backwards_has_the_inverse_orientation() {
    // The rotation R of the forward joint is R' of the backward one, its speeds w are -R w.
    let forward =
        "SphericalJoint(rpy: (0.4, 0.0, 0.0), velocity: (2.0, -1.0, 0.5), stiffness: 2.0, damping: 0.3)";
    let w = turned_by(&[0.2_f64.cos(), 0.2_f64.sin(), 0.0, 0.0], [2.0, -1.0, 0.5]).map(|w| -w);
    let backward = format!(
        "SphericalJoint(rpy: (-0.4, 0.0, 0.0), velocity: ({:?}, {:?}, {:?}), stiffness: 2.0, damping: 0.3)",
        w[0], w[1], w[2]
    );
    let (mut a, mut b) = (two_links(forward, true), two_links(&backward, false));
    let torque = [0.3, -0.2, 0.1];
    a.set_all("second.torque", &torque);
    // the same torque in the axes of the other frame, at every instant: here at the start
    let p = a.get_all("second.p");
    b.set_all("second.torque", &turned_by(&p, torque).map(|t| -t));
    let (aa, ab) = (a.get_all("second.a"), b.get_all("second.a"));
    close_all(&ab, &turned_by(&p, [aa[0], aa[1], aa[2]]).map(|a| -a), 1e-10);
    close(b.get("first.a"), a.get("first.a"), 1e-11);
    a.set_all("second.torque", &[0.0; 3]);
    b.set_all("second.torque", &[0.0; 3]);
    a.run_to(1.0, 1e-3);
    b.run_to(1.0, 1e-3);
    close(b.get("first.q"), a.get("first.q"), 1e-9);
    let (pa, pb) = (a.get_all("second.p"), b.get_all("second.p"));
    close_all(&pb, &[pa[0], -pa[1], -pa[2], -pa[3]], 1e-9);
    let (wa, wb) = (a.get_all("second.w"), b.get_all("second.w"));
    close_all(&wb, &turned_by(&pa, [wa[0], wa[1], wa[2]]).map(|w| -w), 1e-8);
}

#[test]
fn a_drive_turns_one_axis_of_a_joint_of_several() {
    // A motor torque over a gear of 10 on the rotation of a cylindrical joint; its rotor counts a hundredfold.
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", "CylindricalJoint"),
            ("body", "Body(mass: 2.0, moi: (0.5, 0.5, 0.7))"),
            ("gear", "SimpleGear(ratio: 10.0)"),
            ("rotor", "Inertia(j: 0.003)"),
            ("torque", "ConstantTorque(tau: 0.5)"),
            ("case", "RotationalReference"),
        ],
        &[
            "world.frame <-> joint.base",
            "joint.follower <-> body.frame",
            "torque.r <-> rotor.r <-> gear.base",
            "gear.follower <-> joint.r",
            "joint.c <-> torque.c <-> case.r",
        ],
    );
    close(plant.get("joint.alpha").abs(), 5.0 / (0.7 + 0.3), 1e-12);
    close(plant.get("joint.a"), -G, 1e-12);
}

#[test]
fn a_source_that_prescribes_a_joint_shows_the_torque_that_the_body_needs() {
    // Three relations that only the balance of the joint tells apart: source, joint and the wall at both cases.
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", "RevoluteJoint(axis: (0.0, 1.0, 0.0))"),
            ("rod", "Body(mass: 2.0, com: (0.5, 0.0, 0.0), moi: (0.0, 0.1, 0.1))"),
            ("turn", "IdealSpeedSource"),
            ("wall", "RotationalReference"),
        ],
        &[
            "world.frame <-> joint.base",
            "joint.follower <-> rod.frame",
            "joint.r <-> turn.r",
            "joint.c <-> turn.c <-> wall.r",
        ],
    );
    plant.set("turn.w", 0.4).set("turn.dw", 3.0).run_to(0.5, 1e-2);
    let q = plant.get("joint.q");
    let expected = (0.1 + 2.0 * 0.25) * 3.0 - 2.0 * G * 0.5 * q.cos();
    close(plant.get("turn.tau"), expected, 1e-12);
    close(plant.get("joint.tau"), expected, 1e-12);
}
