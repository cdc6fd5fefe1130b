//! Closed loops of bodies against closed forms, reduced equations of motion and conservation laws.

use std::f64::consts::PI;

use crate::plant::{Plant, assembled, close};

const G: f64 = 9.80665;

// A four-bar linkage in the x-z plane: crank, coupler, rocker and the distance of their pivots, m. Each bar is a body
// with its centre of mass in the middle; masses in kg, moments of inertia about that centre in kg*m^2.
const BARS: [f64; 4] = [0.2, 0.5, 0.4, 0.5];
const MASSES: [f64; 3] = [1.0, 2.0, 1.5];
const INERTIAS: [f64; 3] = [0.01, 0.05, 0.03];

fn bar(k: usize) -> String {
    let (half, i) = (0.5 * BARS[k], INERTIAS[k]);
    format!("Body(mass: {:?}, com: ({half:?}, 0.0, 0.0), moi: (0.0, {i:?}, {i:?}))", MASSES[k])
}

fn arm(k: usize) -> String {
    format!("Transform(translation: ({:?}, 0.0, 0.0))", BARS[k])
}

/// The linkage with start values of its joints, mounted on the world by a transform.
fn four_bar(crank: &str, others: [&str; 3], mount: &str, more: &[(&str, &str)], lines: &[&str]) -> Plant {
    let joint = |start: &str| format!("RevoluteJoint(axis: (0.0, -1.0, 0.0), {start})");
    let (bars, arms) = ([0, 1, 2].map(bar), [0, 1, 2, 3].map(arm));
    let (crank, joints) = (joint(crank), others.map(joint));
    let mut blocks = vec![
        ("world", "World"),
        ("mount", mount),
        ("crank", &crank),
        ("elbow", &joints[0]),
        ("knee", &joints[1]),
        ("rocker", &joints[2]),
        ("bar1", &bars[0]),
        ("bar2", &bars[1]),
        ("bar3", &bars[2]),
        ("arm1", &arms[0]),
        ("arm2", &arms[1]),
        ("arm3", &arms[2]),
        ("ground", &arms[3]),
    ];
    blocks.extend_from_slice(more);
    let mut connections = vec![
        "world.frame <-> mount.base",
        "mount.follower <-> crank.base <-> ground.base",
        "crank.follower <-> bar1.frame <-> arm1.base",
        "arm1.follower <-> elbow.base",
        "elbow.follower <-> bar2.frame <-> arm2.base",
        "ground.follower <-> rocker.base",
        "rocker.follower <-> bar3.frame <-> arm3.base",
        "arm2.follower <-> knee.base",
        "knee.follower <-> arm3.follower",
    ];
    connections.extend_from_slice(lines);
    Plant::new(&blocks, &connections)
}

const PLAIN: &str = "Transform";

/// Angles of coupler and rocker for an angle of the crank, with the knee above.
fn angles(crank: f64) -> [f64; 2] {
    let [a, b, c, d] = BARS;
    let (x, y) = (d - a * crank.cos(), -a * crank.sin()); // from the elbow to the rocker's pivot
    let length = x.hypot(y);
    let corner = ((b * b + length * length - c * c) / (2.0 * b * length)).acos();
    let coupler = y.atan2(x) + corner;
    let tip = [b * coupler.cos() - x, b * coupler.sin() - y];
    [coupler, tip[1].atan2(tip[0])]
}

/// Speeds of coupler and rocker over that of the crank: `a t2 + b t3 = c t4` with the tangents of the bars.
fn ratios(crank: f64) -> [f64; 2] {
    let [a, b, c, _] = BARS;
    let [coupler, rocker] = angles(crank);
    [
        a * (crank - rocker).sin() / (b * (rocker - coupler).sin()),
        a * (crank - coupler).sin() / (c * (rocker - coupler).sin()),
    ]
}

/// Moment of inertia reduced to the crank, and the potential energy.
fn reduced(crank: f64) -> (f64, f64) {
    let ([coupler, rocker], [r3, r4]) = (angles(crank), ratios(crank));
    let [a, b, c, _] = BARS;
    let about_pivot = |k: usize| INERTIAS[k] + MASSES[k] * 0.25 * BARS[k] * BARS[k];
    // speed of the middle of the coupler
    let x = -a * crank.sin() - 0.5 * b * r3 * coupler.sin();
    let z = a * crank.cos() + 0.5 * b * r3 * coupler.cos();
    let inertia =
        about_pivot(0) + MASSES[1] * (x * x + z * z) + INERTIAS[1] * r3 * r3 + about_pivot(2) * r4 * r4;
    let heights = [0.5 * a * crank.sin(), a * crank.sin() + 0.5 * b * coupler.sin(), 0.5 * c * rocker.sin()];
    (inertia, G * (0..3).map(|k| MASSES[k] * heights[k]).sum::<f64>())
}

fn energy(crank: f64, w: f64) -> f64 {
    let (inertia, potential) = reduced(crank);
    0.5 * inertia * w * w + potential
}

/// Lagrange's equation of the one degree of freedom: `I q'' + I' q'^2 / 2 + V' = 0`.
fn acceleration(crank: f64, w: f64) -> f64 {
    const STEP: f64 = 1e-4;
    // central differences of fourth order: rounding and cutting both leave about 1e-12
    let slope = |f: &dyn Fn(f64) -> f64| {
        (8.0 * (f(crank + STEP) - f(crank - STEP)) - f(crank + 2.0 * STEP) + f(crank - 2.0 * STEP))
            / (12.0 * STEP)
    };
    let (dinertia, dpotential) = (slope(&|q| reduced(q).0), slope(&|q| reduced(q).1));
    -(0.5 * dinertia * w * w + dpotential) / reduced(crank).0
}

/// Angle within half a turn of zero.
fn wrapped(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}

fn start(crank: f64, w: f64) -> (String, [&'static str; 3]) {
    // near enough for the knee above to be the closer one
    (format!("position: {crank:?}, velocity: {w:?}"), ["", "", "position: 2.0"])
}

#[test]
fn a_four_bar_linkage_closes_at_the_angle_that_is_given() {
    for crank in [0.3, 1.0, 2.5, 4.0, 6.0] {
        let (first, others) = start(crank, 2.0);
        let mut plant = four_bar(&first, ["", "", ""], PLAIN, &[], &[]);
        close(plant.get("crank.q"), crank, 0.0);
        close(plant.get("crank.w"), 2.0, 1e-12);
        // A start angle of the rocker, too: both give way by what does not fit.
        let mut near = four_bar(&first, others, PLAIN, &[], &[]);
        for plant in [&mut plant, &mut near] {
            let crank = plant.get("crank.q");
            let [coupler, rocker] = angles(crank);
            let [r3, r4] = ratios(crank);
            let w = plant.get("crank.w");
            let found = wrapped(plant.get("rocker.q") - rocker);
            if found.abs() > 1e-9 {
                continue; // the knee below is as good a start
            }
            close(wrapped(plant.get("crank.q") + plant.get("elbow.q") - coupler), 0.0, 1e-11);
            close(wrapped(plant.get("knee.q") - (rocker - coupler)), 0.0, 1e-11);
            close(plant.get("rocker.w"), w * r4, 1e-11);
            close(plant.get("elbow.w"), w * (r3 - 1.0), 1e-11);
            close(plant.get("crank.a"), acceleration(crank, w), 1e-8);
        }
    }
}

/// The linkage with all joints started on the branch of [`angles`].
fn above(crank: f64, w: f64, mount: &str, more: &[(&str, &str)], lines: &[&str]) -> Plant {
    let [coupler, rocker] = angles(crank);
    let at = |angle: f64| format!("position: {angle:?}");
    let others = [at(coupler - crank), at(rocker - coupler), at(rocker)];
    let first = format!("position: {crank:?}, velocity: {w:?}");
    four_bar(&first, [&others[0], &others[1], &others[2]], mount, more, lines)
}

#[test]
fn a_four_bar_linkage_moves_as_its_reduced_equation_says() {
    let (mut q, mut w) = (1.0, 9.0);
    let mut plant = above(q, w, PLAIN, &[], &[]);
    let before = energy(q, w);
    let h = 5e-4;
    for second in 1..=2 {
        plant.run_to(f64::from(second), h);
        for _ in 0..2000 {
            let (k1, l1) = (w, acceleration(q, w));
            let (k2, l2) = (w + 0.5 * h * l1, acceleration(q + 0.5 * h * k1, w + 0.5 * h * l1));
            let (k3, l3) = (w + 0.5 * h * l2, acceleration(q + 0.5 * h * k2, w + 0.5 * h * l2));
            let (k4, l4) = (w + h * l3, acceleration(q + h * k3, w + h * l3));
            q += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            w += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
        }
        // Both are of fourth order with steps of 0.5 ms.
        close(plant.get("crank.q"), q, 1e-7);
        close(plant.get("crank.w"), w, 1e-6);
        let (found, speed) = (plant.get("crank.q"), plant.get("crank.w"));
        close(energy(found, speed) / before, 1.0, 1e-8);
        let [_, rocker] = angles(found);
        close(wrapped(plant.get("rocker.q") - rocker), 0.0, 1e-9);
        close(plant.get("rocker.w"), speed * ratios(found)[1], 1e-8);
        close(plant.get("crank.a"), acceleration(found, speed), 1e-6);
    }
}

#[test]
fn a_linkage_askew_in_space_moves_as_one_in_a_plane_of_the_world() {
    // Turned about the vertical, so that gravity still lies in its plane; rows of the loop then mix all axes.
    let mut straight = above(1.0, 9.0, PLAIN, &[], &[]);
    let mut askew =
        above(1.0, 9.0, "Transform(translation: (0.3, -0.7, 0.2), rpy: (0.0, 0.0, 0.8))", &[], &[]);
    straight.run_to(1.0, 1e-3);
    askew.run_to(1.0, 1e-3);
    for name in ["crank.q", "crank.w", "crank.a", "knee.q", "rocker.a"] {
        close(askew.get(name), straight.get(name), 1e-9);
    }
}

#[test]
fn axes_that_are_parallel_but_for_rounding_do_not_lock_a_linkage() {
    // The last pivot is turned by what seven printed digits leave.
    let mut straight = above(1.0, 9.0, PLAIN, &[], &[]);
    let [coupler, rocker] = angles(1.0);
    let at = |angle: f64| format!("position: {angle:?}");
    let others = [at(coupler - 1.0), at(rocker - coupler), at(rocker)];
    let ground = "Transform(translation: (0.5, 0.0, 0.0), rpy: (3e-8, 0.0, -2e-8))";
    let joint = |start: &str| format!("RevoluteJoint(axis: (0.0, -1.0, 0.0), {start})");
    let first = joint("position: 1.0, velocity: 9.0");
    let (bars, arms, joints) = ([0, 1, 2].map(bar), [0, 1, 2].map(arm), others.map(|start| joint(&start)));
    let mut rough = Plant::new(
        &[
            ("world", "World"),
            ("crank", &first),
            ("elbow", &joints[0]),
            ("knee", &joints[1]),
            ("rocker", &joints[2]),
            ("bar1", &bars[0]),
            ("bar2", &bars[1]),
            ("bar3", &bars[2]),
            ("arm1", &arms[0]),
            ("arm2", &arms[1]),
            ("arm3", &arms[2]),
            ("ground", ground),
        ],
        &[
            "world.frame <-> crank.base <-> ground.base",
            "crank.follower <-> bar1.frame <-> arm1.base",
            "arm1.follower <-> elbow.base",
            "elbow.follower <-> bar2.frame <-> arm2.base",
            "ground.follower <-> rocker.base",
            "rocker.follower <-> bar3.frame <-> arm3.base",
            "arm2.follower <-> knee.base",
            "knee.follower <-> arm3.follower",
        ],
    );
    straight.run_to(1.0, 1e-3);
    rough.run_to(1.0, 1e-3);
    close(rough.get("crank.q"), straight.get("crank.q"), 1e-5);
}

#[test]
fn a_motor_on_the_rocker_feels_the_inertia_of_the_whole_linkage() {
    let drive = [
        ("rotor", "Inertia(j: 0.002)"),
        ("gear", "SimpleGear(ratio: 20.0, direction: Same)"),
        ("torque", "ConstantTorque(tau: 0.5)"),
        ("case", "RotationalReference"),
    ];
    let lines = [
        "torque.r <-> rotor.r <-> gear.base",
        "gear.follower <-> rocker.r",
        "rocker.c <-> torque.c <-> case.r",
    ];
    let mut plant = above(1.0, 0.0, PLAIN, &drive, &lines);
    let ratio = ratios(1.0)[1];
    // The rotor turns 20 times as fast as the rocker.
    let inertia = reduced(1.0).0 + 0.002 * (20.0 * ratio).powi(2);
    let weight = -acceleration(1.0, 0.0) * reduced(1.0).0;
    close(plant.get("crank.a"), (20.0 * 0.5 * ratio - weight) / inertia, 1e-8);
}

#[test]
fn a_prescribed_speed_drives_a_linkage_from_the_first_instant() {
    let drive = [("source", "IdealSpeedSource"), ("case", "RotationalReference")];
    let mut plant =
        above(1.0, 0.0, PLAIN, &drive, &["source.r <-> crank.r", "source.c <-> crank.c <-> case.r"]);
    plant.set("source.w", 3.0);
    plant.bench.major();
    close(plant.get("crank.w"), 3.0, 0.0);
    close(plant.get("rocker.w"), 3.0 * ratios(1.0)[1], 1e-10);
    plant.run_to(2.0, 1e-3);
    close(plant.get("crank.q"), 7.0, 1e-12);
    close(wrapped(plant.get("rocker.q") - angles(7.0)[1]), 0.0, 1e-9);
    close(plant.get("rocker.w"), 3.0 * ratios(7.0)[1], 1e-8);
}

#[test]
fn a_slider_crank_moves_its_piston_as_the_closed_form_says() {
    let (r, l) = (0.1, 0.3);
    let mut plant = Plant::new(
        &[
            ("world", "World(gravity: (0.0, 0.0, 0.0))"),
            ("crank", "RevoluteJoint(axis: (0.0, -1.0, 0.0), position: 0.5, velocity: 20.0)"),
            ("wheel", "Body(mass: 1.0, moi: (0.1, 0.2, 0.1))"),
            ("throw", "Transform(translation: (0.1, 0.0, 0.0))"),
            ("pin", "RevoluteJoint(axis: (0.0, -1.0, 0.0))"),
            ("rod", "Body(mass: 0.5, com: (0.15, 0.0, 0.0), moi: (0.0, 0.004, 0.004))"),
            ("far", "Transform(translation: (0.3, 0.0, 0.0))"),
            ("wrist", "RevoluteJoint(axis: (0.0, -1.0, 0.0))"),
            ("slide", "PrismaticJoint(axis: (1.0, 0.0, 0.0), position: 0.35)"),
            ("piston", "Body(mass: 0.4)"),
        ],
        &[
            "world.frame <-> crank.base <-> slide.base",
            "crank.follower <-> wheel.frame <-> throw.base",
            "throw.follower <-> pin.base",
            "pin.follower <-> rod.frame <-> far.base",
            "far.follower <-> wrist.base",
            "wrist.follower <-> slide.follower <-> piston.frame",
        ],
    );
    let along = |q: f64| r * q.cos() + (l * l - (r * q.sin()).powi(2)).sqrt();
    let slope = |q: f64| -r * q.sin() - r * r * q.sin() * q.cos() / (l * l - (r * q.sin()).powi(2)).sqrt();
    for t in [0.0, 0.2, 0.5] {
        if t > 0.0 {
            plant.run_to(t, 1e-4);
        }
        let q = plant.get("crank.q");
        close(plant.get("slide.x"), along(q), 1e-8);
        close(plant.get("slide.v"), slope(q) * plant.get("crank.w"), 1e-6);
    }
}

#[test]
fn a_bar_on_three_parallel_cranks_moves_although_one_is_too_many() {
    // Two cranks would do: the rows of the third depend on the others. The bar moves on a circle without turning.
    let crank = "RevoluteJoint(axis: (0.0, -1.0, 0.0), position: 0.7)";
    let back = "RevoluteJoint(axis: (0.0, -1.0, 0.0), position: -0.7)";
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("q1", crank),
            ("q2", crank),
            ("q3", crank),
            ("p1", back),
            ("p2", back),
            ("p3", back),
            ("l1", "Transform(translation: (0.2, 0.0, 0.0))"),
            ("l2", "Transform(translation: (0.2, 0.0, 0.0))"),
            ("l3", "Transform(translation: (0.2, 0.0, 0.0))"),
            ("d2", "Transform(translation: (0.3, 0.0, 0.0))"),
            ("d3", "Transform(translation: (0.7, 0.0, 0.0))"),
            ("e2", "Transform(translation: (0.3, 0.0, 0.0))"),
            ("e3", "Transform(translation: (0.7, 0.0, 0.0))"),
            ("bar", "Body(mass: 3.0, com: (0.35, 0.0, 0.1), moi: (0.0, 0.1, 0.1))"),
        ],
        &[
            "world.frame <-> q1.base <-> d2.base <-> d3.base",
            "d2.follower <-> q2.base",
            "d3.follower <-> q3.base",
            "q1.follower <-> l1.base",
            "q2.follower <-> l2.base",
            "q3.follower <-> l3.base",
            "l1.follower <-> p1.base",
            "l2.follower <-> p2.base",
            "l3.follower <-> p3.base",
            "p1.follower <-> bar.frame <-> e2.base <-> e3.base",
            "p2.follower <-> e2.follower",
            "p3.follower <-> e3.follower",
        ],
    );
    // a pendulum: m r^2 q'' = -m g r cos q
    close(plant.get("q1.a"), -G * 0.7_f64.cos() / 0.2, 1e-9);
    let energy =
        |plant: &mut Plant| 0.5 * 0.04 * plant.get("q1.w").powi(2) + G * 0.2 * plant.get("q1.q").sin();
    let before = energy(&mut plant);
    plant.run_to(1.0, 1e-4);
    close(energy(&mut plant), before, 1e-8);
    close(plant.get("p2.q"), -plant.get("q3.q"), 1e-9);
}

#[test]
fn a_rod_with_a_ball_at_each_end_keeps_its_length_and_the_energy() {
    // Two pendulums about skew axes, their tips joined by a rod of 0.6 m that may spin about itself.
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("left", "RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.4, velocity: 1.0)"),
            ("bob1", "Body(mass: 1.0, com: (0.0, 0.0, -0.2), moi: (0.01, 0.01, 0.001))"),
            ("tip1", "Transform(translation: (0.0, 0.0, -0.4))"),
            ("ball1", "SphericalJoint"),
            ("rod", "Body(mass: 0.5, com: (0.3, 0.0, 0.0), moi: (0.001, 0.015, 0.015))"),
            ("far", "Transform(translation: (0.6, 0.0, 0.0))"),
            ("ball2", "SphericalJoint"),
            ("place", "Transform(translation: (0.5, 0.2, 0.1), rpy: (0.3, 0.0, 0.9))"),
            ("right", "RevoluteJoint(axis: (0.0, 1.0, 0.0))"),
            ("bob2", "Body(mass: 2.0, com: (0.0, 0.0, -0.25), moi: (0.02, 0.02, 0.002))"),
            ("tip2", "Transform(translation: (0.0, 0.0, -0.5))"),
            ("middle1", "Transform(translation: (0.0, 0.0, -0.2))"),
            ("middle", "Transform(translation: (0.3, 0.0, 0.0))"),
            ("middle2", "Transform(translation: (0.0, 0.0, -0.25))"),
            ("s1", "TransformSensor"),
            ("s", "TransformSensor"),
            ("s2", "TransformSensor"),
        ],
        &[
            "world.frame <-> left.base <-> place.base",
            "left.follower <-> bob1.frame <-> tip1.base <-> middle1.base",
            "tip1.follower <-> ball1.base",
            "ball1.follower <-> rod.frame <-> far.base <-> middle.base",
            "far.follower <-> ball2.base",
            "place.follower <-> right.base",
            "right.follower <-> bob2.frame <-> tip2.base <-> middle2.base",
            "ball2.follower <-> tip2.follower",
            "middle1.follower <-> s1.follower",
            "middle.follower <-> s.follower",
            "middle2.follower <-> s2.follower",
        ],
    );
    // Tips of the pendulums: those of a rotation about y by q of (0, 0, -l), the second placed askew.
    let tips = |plant: &mut Plant| {
        let (a, b) = (plant.get("left.q"), plant.get("right.q"));
        let first = [-0.4 * a.sin(), 0.0, -0.4 * a.cos()];
        let local = [-0.5 * b.sin(), 0.0, -0.5 * b.cos()];
        // Rz(0.9) Rx(0.3)
        let ((s, c), (sz, cz)) = (0.3_f64.sin_cos(), 0.9_f64.sin_cos());
        let turned = [local[0], -s * local[2], c * local[2]];
        let second =
            [0.5 + cz * turned[0] - sz * turned[1], 0.2 + sz * turned[0] + cz * turned[1], 0.1 + turned[2]];
        (0..3).map(|k| (first[k] - second[k]).powi(2)).sum::<f64>().sqrt()
    };
    // Moments of inertia across and along the axis (x of the rod, z of the pendulums, which do not turn about it).
    let energy = |plant: &mut Plant| {
        let mut sum = 0.0;
        for (name, mass, across, along) in
            [("s1", 1.0, 0.01, 0.01), ("s", 0.5, 0.015, 0.001), ("s2", 2.0, 0.02, 0.02)]
        {
            let [x, v, w, p] = ["x", "v", "w", "p"].map(|output| plant.get_all(&format!("{name}.{output}")));
            let square = |a: &[f64]| a.iter().map(|a| a * a).sum::<f64>();
            let axis = [
                1.0 - 2.0 * (p[2] * p[2] + p[3] * p[3]),
                2.0 * (p[1] * p[2] + p[0] * p[3]),
                2.0 * (p[1] * p[3] - p[0] * p[2]),
            ];
            let about: f64 = axis.iter().zip(&w).map(|(a, w)| a * w).sum();
            sum += mass * (0.5 * square(&v) + G * x[2]);
            sum += 0.5 * across * (square(&w) - about * about) + 0.5 * along * about * about;
        }
        sum
    };
    let before = energy(&mut plant);
    close(plant.get("left.q"), 0.4, 0.0);
    for t in [0.0, 0.5, 1.0, 2.0] {
        if t > 0.0 {
            plant.run_to(t, 1e-3);
        }
        close(tips(&mut plant), 0.6, 1e-9);
        close(energy(&mut plant), before, 1e-8);
    }
}

#[test]
fn a_weld_that_closes_a_loop_takes_the_freedom() {
    // A hinge whose far side is welded to the world cannot move, and what holds it is not its business.
    let mut plant = Plant::new(
        &[
            ("world", "World"),
            ("joint", "RevoluteJoint(axis: (0.0, 1.0, 0.0))"),
            ("body", "Body(mass: 1.0, com: (0.3, 0.0, 0.0), moi: (0.01, 0.01, 0.01))"),
            ("weld", "WeldJoint"),
        ],
        &["world.frame <-> joint.base <-> weld.base", "joint.follower <-> body.frame <-> weld.follower"],
    );
    close(plant.get("joint.a"), 0.0, 1e-12);
    plant.set("joint.torque", 5.0);
    plant.run_to(1.0, 1e-2);
    close(plant.get("joint.q"), 0.0, 1e-12);
}

#[test]
fn bars_that_are_too_short_are_told_with_the_gap() {
    let problems = assembled(
        &[
            ("world", "World"),
            ("a", "RevoluteJoint(axis: (0.0, 1.0, 0.0))"),
            ("b", "RevoluteJoint(axis: (0.0, 1.0, 0.0))"),
            ("c", "RevoluteJoint(axis: (0.0, 1.0, 0.0))"),
            ("one", "Transform(translation: (0.2, 0.0, 0.0))"),
            ("two", "Transform(translation: (0.3, 0.0, 0.0))"),
            ("ground", "Transform(translation: (0.6, 0.0, 0.0))"),
            ("bar", "Body(mass: 1.0, moi: (1.0, 1.0, 1.0))"),
            ("other", "Body(mass: 1.0, moi: (1.0, 1.0, 1.0))"),
        ],
        &[
            "world.frame <-> a.base <-> ground.base",
            "a.follower <-> one.base <-> bar.frame",
            "one.follower <-> b.base",
            "b.follower <-> two.base <-> other.frame",
            "two.follower <-> c.base",
            "c.follower <-> ground.follower",
        ],
    )
    .expect_err("no loop of 0.2 m and 0.3 m spans 0.6 m");
    assert_eq!(problems.len(), 1);
    assert_eq!(problems[0].code, "inconsistent_start");
    assert!(problems[0].message.contains("stays open: 100.000 mm"), "{}", problems[0].message);
    let members: Vec<&str> = problems[0].members.iter().map(|(_, role)| role.as_str()).collect();
    assert_eq!(members[0], "closes the loop");
    assert!(members[1..].iter().all(|role| *role == "belongs to the loop") && members.len() >= 3);
}

#[test]
fn transforms_that_meet_again_need_only_agree() {
    let meet = |second: &str| {
        assembled(
            &[
                ("world", "World"),
                ("first", "Transform(translation: (1.0, 0.0, 0.0), rpy: (0.0, 0.0, 0.5))"),
                ("second", second),
                ("body", "Body(mass: 1.0)"),
            ],
            &[
                "world.frame <-> first.base <-> second.base",
                "first.follower <-> second.follower <-> body.frame",
            ],
        )
        .map(|_| ())
        .map_err(|problems| problems[0].message.clone())
    };
    assert_eq!(meet("Transform(translation: (1.0, 0.0, 0.0), rpy: (0.0, 0.0, 0.5))"), Ok(()));
    let gap = meet("Transform(translation: (1.0, 0.002, 0.0), rpy: (0.0, 0.0, 0.4))").expect_err("a gap");
    assert!(gap.contains("2.000 mm and 5.730 deg"), "{gap}");
}

#[test]
fn a_brake_holds_a_whole_linkage_until_the_weight_breaks_it_away() {
    let held = |torque: f64| {
        let brake = format!("Brake(torque: {torque:?})");
        let more = [("brake", brake.as_str()), ("case", "RotationalReference")];
        let mut plant =
            above(1.0, 0.0, PLAIN, &more, &["brake.r <-> rocker.r", "brake.c <-> rocker.c <-> case.r"]);
        plant.set("brake.engaged", 1.0);
        plant.bench.major();
        plant
    };
    // What the weight needs at the rocker, by virtual work.
    let weight = acceleration(1.0, 0.0) * reduced(1.0).0 / ratios(1.0)[1];
    let mut plant = held(1.05 * weight.abs());
    close(plant.get("brake.tau").abs(), weight.abs(), 1e-7);
    plant.run_to(1.0, 1e-2);
    close(plant.get("crank.q"), 1.0, 1e-9);
    let mut plant = held(0.5 * weight.abs());
    close(plant.get("crank.a"), 0.5 * acceleration(1.0, 0.0), 1e-8);
}

#[test]
#[should_panic(expected = "the prescribed speeds do not fit each other")]
fn two_speeds_that_fight_through_a_loop_stop_the_simulation() {
    let more = [("one", "IdealSpeedSource"), ("two", "IdealSpeedSource"), ("case", "RotationalReference")];
    let lines =
        ["one.r <-> crank.r", "two.r <-> rocker.r", "one.c <-> crank.c <-> two.c <-> rocker.c <-> case.r"];
    let mut plant = above(1.0, 0.0, PLAIN, &more, &lines);
    plant.set("one.w", 3.0).set("two.w", 3.0);
    plant.bench.major();
    plant.bench.minor();
}
