//! Elastic contacts of bodies and ends of travel against closed forms, for all methods.

use std::f64::consts::PI;

use blocksim_tests::{close, run_blocks};

const SOLVERS: [&str; 12] = [
    "Auto",
    "Ode45",
    "Ode23",
    "Dop853",
    "Ode15s",
    "Radau5",
    "Rodas4",
    "Ode23tb",
    "Ode23t",
    "RosW3",
    "RosW3(rtol: 1e-7)",
    "Rodas4(rtol: 1e-8)",
];
const G: f64 = 9.80665;

/// A ball falls on an elastic plane and bounces without loss: the time in contact is that of a half swing about the depth
/// at which its weight rests, and it comes back to where it was let go.
#[test]
fn a_ball_on_an_elastic_plane_comes_back_to_its_height() {
    let (m, k, height) = (2.0, 1e6, 1.0_f64);
    let speed = (2.0 * G * height).sqrt();
    let omega = f64::sqrt(k / m);
    let touch = 2.0 / omega * (PI - f64::atan(speed * omega / G));
    let period = 2.0 * speed / G + touch;
    let plane = format!("PointPlaneContact(stiffness: {k:?}, damping: 0.0, transition: 0.0)");
    let blocks = format!(
        r#""world": World, "fall": FreeJoint(position: (0.0, 0.0, {height:?})),
           "ball": Body(mass: {m:?}, com: (0.0, 0.0, 0.0), moi: (0.01, 0.01, 0.01)), "floor": {plane},
           "look": TransformSensor, "scope": Scope(inputs: ["p"])"#
    );
    let wires = r#""world.frame <-> fall.base <-> floor.base <-> look.base",
        "fall.follower <-> ball.frame <-> floor.follower <-> look.follower", "look.x -> scope.p""#;
    let limit = format!(
        r#""world": World, "fall": PrismaticJoint(axis: (0.0, 0.0, 1.0), position: {height:?}, lower: 0.0,
             limit_stiffness: {k:?}, limit_damping: 0.0, limit_transition: 0.0),
           "ball": Body(mass: {m:?}, com: (0.0, 0.0, 0.0), moi: (0.01, 0.01, 0.01)), "scope": Scope(inputs: ["p"])"#
    );
    let slide = r#""world.frame <-> fall.base", "fall.follower <-> ball.frame", "fall.x -> scope.p""#;
    let stop = format!("{:?} s", 5.0 * period);
    for solver in SOLVERS {
        for (blocks, wires, name) in
            [(blocks.as_str(), wires, "scope.p[2]"), (limit.as_str(), slide, "scope.p")]
        {
            let run = run_blocks(&stop, solver, blocks, wires);
            let tolerance = if solver.contains("rtol") { 2e-3 } else { 0.1 };
            let name =
                run.recorded.iter().map(|r| r.path.as_str()).find(|p| *p == name).unwrap_or_else(|| {
                    panic!("{:?}", run.recorded.iter().map(|r| r.path.clone()).collect::<Vec<_>>())
                });
            let what = format!("{solver} {name}");
            close(run.last(name), height, tolerance, &what);
            let least = run.column(name).iter().copied().fold(f64::INFINITY, f64::min);
            let depth =
                G / omega.powi(2) + (speed.powi(2) / omega.powi(2) + (G / omega.powi(2)).powi(2)).sqrt();
            assert!(least > -1.05 * depth, "{what}: {least} m is deeper than {depth} m");
            let highest = run.column(name).iter().copied().fold(0.0, f64::max);
            assert!(highest < height * (1.0 + tolerance), "{what}: thrown to {highest} m");
        }
    }
}

/// A disc or a mass hits one damped end of travel and comes back. The end lets go where its force is zero, with the parts still
/// overlapping: with `cos b = zeta` what comes back is `exp(-2 zeta b / sqrt(1 - zeta^2))` of the speed.
#[test]
fn a_damped_end_of_travel_lets_go_where_its_force_ends() {
    let (inertia, k, zeta) = (0.5_f64, 2e4_f64, 0.3_f64);
    let d = 2.0 * zeta * (k * inertia).sqrt();
    let back = (-2.0 * zeta * zeta.acos() / (1.0 - zeta * zeta).sqrt()).exp();
    let turning = |law: &str| {
        (
            format!(
                r#""disc": Inertia(j: {inertia:?}, w0: 3.0), "end": {law}, "frame": RotationalReference,
                   "look": MotionSensor, "scope": Scope(inputs: ["v"])"#
            ),
            r#""disc.r <-> end.r <-> look.r", "end.c <-> look.c <-> frame.r", "look.w -> scope.v""#,
        )
    };
    let sliding = |law: &str| {
        (
            format!(
                r#""mass": Mass(m: {inertia:?}, v0: 3.0), "end": {law}, "frame": TranslationalReference,
                   "look": TranslationalMotionSensor, "scope": Scope(inputs: ["v"])"#
            ),
            r#""mass.r <-> end.r <-> look.r", "end.c <-> look.c <-> frame.r", "look.v -> scope.v""#,
        )
    };
    let stop = format!("lower: -9.0, upper: 0.3, stiffness: {k:?}, damping: {d:?}, transition: 0.0");
    let play = format!("k: {k:?}, d: {d:?}, backlash: 0.6");
    let cases = [
        turning(&format!("RotationalHardStop({stop})")),
        turning(&format!("RotationalSpringDamper({play})")),
        sliding(&format!("TranslationalHardStop({stop})")),
        sliding(&format!("TranslationalSpringDamper({play})")),
    ];
    for (blocks, wires) in &cases {
        for (solver, tolerance) in
            [("Ode45", 1e-5), ("Rodas4", 1e-5), ("RosW3", 1e-4), ("Ode45(rtol: 1e-9)", 1e-8)]
        {
            let run = run_blocks("0.15 s", solver, blocks, wires);
            close(run.last("scope.v"), -3.0 * back, 3.0 * tolerance, &format!("{solver}: {blocks}"));
        }
    }
}

/// A ball bounces along a slope whose contact sets in within 0.8 mm, a part of what a step goes that knows of nothing: where
/// it has set in is no less a kink than where it begins. The speeds are those of the equations of motion in two coordinates,
/// in 20 000 equal steps.
#[test]
fn a_contact_that_sets_in_within_a_step_is_not_passed_over() {
    for solver in ["Auto", "Ode45", "Ode23", "RosW3", "Rodas4", "Radau5", "Ode15s"] {
        let run = run_blocks(
            "0.8 s",
            solver,
            r#""world": World, "ball": Body(mass: 1.43), "show": Scope(inputs: ["across", "fall"]),
               "across": PrismaticJoint(axis: [1, 0, 0], position: 0.055945174938395, velocity: 1.7575201435440768),
               "fall": PrismaticJoint(axis: [0, 0, 1], position: 0.12942618514470855, velocity: -0.8487036202566876),
               "plane": Transform(rpy: [0.0, 0.408, 0.0]),
               "touch": PointPlaneContact(
                   stiffness: 11000.0, damping: 13.3, transition: 0.00078, friction: 0.0766, threshold: 0.119)"#,
            r#""world.frame <-> across.base <-> plane.base", "across.follower <-> fall.base",
               "fall.follower <-> ball.frame <-> touch.follower", "plane.follower <-> touch.base",
               "across.v -> show.across", "fall.v -> show.fall""#,
        );
        close(run.last("show.across"), 3.887014408, 3e-4, solver);
    }
}

/// A driven mass takes another one along through play with a damper, whose torque jumps at each touch. The other one has stood still
/// until then, so that nothing tells how exactly it is to be followed.
#[test]
fn play_with_a_damper_takes_along_what_has_stood_still() {
    let (drive, j, taken, k, d, half) = (5.0, 0.33, 0.01, 2000.0, 1.0, 1_f64.to_radians());
    // The same by small steps, of which none passes a contact: each is cut where it begins or ends.
    let torque = |phi: f64, w: f64| {
        let side = phi.signum();
        side * (k * (phi.abs() - half) + d * side * w)
    };
    let (mut x, mut t, mut touches, mut changes) = ([0.0; 4], 0.0, false, 0);
    let apart = |x: &[f64; 4]| {
        let (phi, w) = (x[0] - x[2], x[1] - x[3]);
        -(phi.abs() - half + d / k * (phi.signum() * w).min(0.0))
    };
    let step = |x: [f64; 4], touches: bool, h: f64| {
        let slopes = |x: [f64; 4]| {
            let tau = if touches { torque(x[0] - x[2], x[1] - x[3]) } else { 0.0 };
            [x[1], (drive - tau) / j, x[3], tau / taken]
        };
        let along = |k: [f64; 4], h: f64| std::array::from_fn::<f64, 4, _>(|i| x[i] + h * k[i]);
        let k1 = slopes(x);
        let k2 = slopes(along(k1, 0.5 * h));
        let k3 = slopes(along(k2, 0.5 * h));
        let k4 = slopes(along(k3, h));
        std::array::from_fn::<f64, 4, _>(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    };
    while t < 1.0 {
        let h = f64::min(1e-5, 1.0 - t);
        let next = step(x, touches, h);
        if (apart(&next) < 0.0) == touches {
            (x, t) = (next, t + h);
            continue;
        }
        let (mut early, mut late) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (early + late);
            if (apart(&step(x, touches, middle)) < 0.0) == touches { early = middle } else { late = middle }
        }
        (x, t, touches, changes) = (step(x, touches, late), t + late, !touches, changes + 1);
    }
    assert_eq!(changes, 13);
    let blocks = format!(
        r#""drive": Constant(value: {drive:?}), "source": IdealTorqueSource, "motor": Inertia(j: {j:?}), "case": RotationalReference,
           "play": RotationalSpringDamper(k: {k:?}, d: {d:?}, backlash: "2 deg"), "taken": Inertia(j: {taken:?}),
           "look": MotionSensor, "scope": Scope(inputs: ["phi", "w"])"#
    );
    let wires = r#""drive.y -> source.tau", "source.r <-> motor.r <-> play.r", "play.c <-> taken.r <-> look.r",
        "source.c <-> look.c <-> case.r", "look.phi -> scope.phi", "look.w -> scope.w""#;
    for solver in
        ["Auto", "Ode45", "Ode23", "Dop853", "Ode15s", "Radau5", "Rodas4", "Ode23tb", "Ode23t", "RosW3"]
    {
        for (rtol, tolerance) in [("1e-4", 3e-2), ("1e-6", 3e-4), ("1e-8", 3e-6)] {
            let what = format!("{solver} {rtol}");
            let run = run_blocks("1 s", &format!("{solver}(rtol: {rtol})"), &blocks, wires);
            close(run.last("scope.phi"), x[2], tolerance, &what);
            close(run.last("scope.w"), x[3], tolerance, &what);
            // Near rest a touch more or less is within the tolerance.
            assert!(
                run.events.len().abs_diff(changes) <= if rtol == "1e-4" { 2 } else { 0 },
                "{what}: {:?}",
                run.events
            );
        }
    }
}

/// A body slides on another one that has stood still, up to the end of its joint, where a damper sets in at once. Seen from the
/// body that is struck, that is a half swing which ends where spring and damper no longer press.
#[test]
fn the_end_of_a_joint_sets_in_motion_what_has_never_moved() {
    let (m, struck, k, d) = (1.0, 2.0, 1e5, 50.0);
    let reduced = m * struck / (m + struck);
    let (omega, decay) = (f64::sqrt(k / reduced), 0.5 * d / reduced);
    let swing = (omega * omega - decay * decay).sqrt();
    // x = exp(-decay t) sin(swing t) / swing; k x + d x' = 0.
    let end = (PI - f64::atan2(d * swing, k - d * decay)) / swing;
    let after = (-decay * end).exp() * ((swing * end).cos() - decay / swing * (swing * end).sin());
    for solver in ["Auto", "Ode45", "Ode23", "Dop853", "Ode15s", "Rodas4(rtol: 1e-4)", "Ode23t", "RosW3"] {
        let run = run_blocks(
            "1 s",
            solver,
            &format!(
                r#""world": World(gravity: (0.0, 0.0, 0.0)), "rail": PrismaticJoint(axis: (1.0, 0.0, 0.0)),
                   "struck": Body(mass: {struck:?}, com: (0.0, 0.0, 0.0), moi: (0.1, 0.1, 0.1)),
                   "slide": PrismaticJoint(axis: (1.0, 0.0, 0.0), velocity: 1.0, upper: 0.5, limit_stiffness: {k:?},
                       limit_damping: {d:?}, limit_transition: 0.0),
                   "body": Body(mass: {m:?}, com: (0.0, 0.0, 0.0), moi: (0.1, 0.1, 0.1)), "s": Scope(inputs: ["rail", "slide"])"#
            ),
            r#""world.frame <-> rail.base", "rail.follower <-> struck.frame <-> slide.base",
               "slide.follower <-> body.frame", "rail.v -> s.rail", "slide.v -> s.slide""#,
        );
        let (rail, slide) = (run.last("s.rail"), run.last("s.slide"));
        close((m + struck) * rail + m * slide, m, 1e-5, &format!("{solver}: momentum"));
        close(slide, after, 1e-4, solver);
    }
}

/// A body that slides, or turns, on another one up to its end of travel, damped and without a transition, takes that along from rest; and one
/// that flies against a plane comes back. Momentum is kept, and of their relative speed comes back what the closed form says, with the
/// reduced inertia `a b/(a + b)`.
#[test]
fn a_joint_at_its_end_takes_along_what_has_stood_still() {
    let (k, d) = (1e5_f64, 50.0);
    let back = |inertia: f64| {
        let zeta = d / (2.0 * (k * inertia).sqrt());
        (-2.0 * zeta * zeta.acos() / (1.0 - zeta * zeta).sqrt()).exp()
    };
    let law = format!("limit_stiffness: {k:?}, limit_damping: {d:?}, limit_transition: 0");
    let joint = |kind: &str, axis: &str, speed: &str| {
        let moved = |size: f64| format!("Body(mass: {size:?}, moi: [{size:?}, {size:?}, {size:?}])");
        let blocks = format!(
            r#""w": World(gravity: [0, 0, 0]), "below": {kind}(axis: {axis}), "b": {}, "a": {},
               "above": {kind}(axis: {axis}, velocity: 1, lower: -1, upper: 0.5, {law}), "show": Scope(inputs: ["below", "above"])"#,
            moved(2.0),
            moved(1.0)
        );
        let wires = format!(
            r#""w.frame <-> below.base", "below.follower <-> b.frame <-> above.base", "above.follower <-> a.frame",
               "below.{speed} -> show.below", "above.{speed} -> show.above""#
        );
        (blocks, wires)
    };
    for (blocks, wires) in
        [joint("PrismaticJoint", "[1, 0, 0]", "v"), joint("RevoluteJoint", "[0, 0, 1]", "w")]
    {
        for solver in SOLVERS {
            let run = run_blocks("1 s", solver, &blocks, &wires);
            let above = -back(2.0 / 3.0);
            let tolerance = if solver.contains("Ode23t") || solver == "Ode15s" { 1e-4 } else { 2e-5 };
            close(run.last("show.above"), above, tolerance, &format!("{solver}: {blocks}"));
            close(run.last("show.below"), (1.0 - above) / 3.0, tolerance, &format!("{solver}: {blocks}"));
            assert!(run.counts.accepted < 3000, "{solver}: {} steps", run.counts.accepted);
            let told: Vec<_> = run.events.iter().map(|(_, path, what)| format!("{path} {what}")).collect();
            assert_eq!(told, ["above touches the upper end", "above leaves the upper end"], "{solver}");
        }
    }
    for solver in SOLVERS {
        let run = run_blocks(
            "1 s",
            solver,
            &format!(
                r#""w": World(gravity: [0, 0, 0]), "j": FreeJoint(position: [0, 0, 0.5], velocity: [0, 0, -1]), "b": Body(mass: 2, moi: [1, 1, 1]),
                   "plane": PointPlaneContact(stiffness: {k:?}, damping: {d:?}, transition: 0), "show": Scope(inputs: ["v"])"#
            ),
            r#""w.frame <-> j.base <-> plane.base", "j.follower <-> b.frame <-> plane.follower", "j.v -> show.v""#,
        );
        close(run.last("show.v[2]"), back(2.0), 1e-4, solver);
        assert_eq!(run.events.len(), 2, "{solver}: {:?}", run.events);
    }
}

/// The second axis of a `Robot` is pushed against its upper end and the first one against its lower end, both damped and without a transition: as
/// the same arm of single joints moves.
#[test]
fn the_axes_of_a_robot_touch_their_own_ends() {
    let ends = r#"limit_stiffness: 2000.0, limit_damping: 5.0, limit_transition: 0"#;
    let limits =
        |lower: f64, upper: f64| format!("(lower: {lower:?}, upper: {upper:?}, speed: 2, acceleration: 9)");
    let body = "mass: 2, com: [0, 0, 0.2], moi: [0.06, 0.06, 0.01]";
    let robot = format!(
        r#""w": World(gravity: [0, 0, 0]), "push": Constant(value: [-3, 2]), "show": Scope(inputs: ["q", "v"]), "r": Robot({ends}, robot: (links: [
               (axis: [0, 1, 0], limits: {}, bodies: [({body})]),
               (origin: (translation: [0, 0, 0.5]), axis: [0, 1, 0], limits: {}, bodies: [({body})])]))"#,
        limits(-0.4, 3.0),
        limits(-3.0, 0.5)
    );
    let robot_wires = r#""w.frame <-> r.base", "push.y -> r.torque", "r.q -> show.q", "r.w -> show.v""#;
    let joints = format!(
        r#""w": World(gravity: [0, 0, 0]), "pa": Constant(value: -3), "pb": Constant(value: 2), "show": Scope(inputs: ["qa", "qb", "va", "vb"]),
           "a": RevoluteJoint(axis: [0, 1, 0], lower: -0.4, upper: 3, {ends}), "first": Body({body}),
           "b": RevoluteJoint(axis: [0, 1, 0], lower: -3, upper: 0.5, {ends}), "second": Body({body}), "arm": Transform(translation: [0, 0, 0.5])"#
    );
    let joint_wires = r#""w.frame <-> a.base", "a.follower <-> first.frame <-> arm.base", "arm.follower <-> b.base",
        "b.follower <-> second.frame", "pa.y -> a.torque", "pb.y -> b.torque",
        "a.q -> show.qa", "b.q -> show.qb", "a.w -> show.va", "b.w -> show.vb""#;
    for solver in ["Ode45(rtol: 1e-9)", "Radau5(rtol: 1e-9)"] {
        let whole = run_blocks("2 s", solver, &robot, robot_wires);
        let single = run_blocks("2 s", solver, &joints, joint_wires);
        for (a, b) in [("q[0]", "qa"), ("q[1]", "qb"), ("v[0]", "va"), ("v[1]", "vb")] {
            let [found, expected] = [whole.last(&format!("show.{a}")), single.last(&format!("show.{b}"))];
            close(found, expected, 1e-6, &format!("{solver}: {a}"));
        }
        let told =
            |run: &blocksim_tests::Run| run.events.iter().map(|event| event.2.clone()).collect::<Vec<_>>();
        let of_joints: Vec<String> = single
            .events
            .iter()
            .map(|(_, path, what)| format!("{what} (axis {})", if path == "a" { 1 } else { 2 }))
            .collect();
        assert_eq!(told(&whole), of_joints, "{solver}");
        assert!(
            of_joints.iter().any(|what| what.contains("lower"))
                && of_joints.iter().any(|what| what.contains("upper"))
        );
    }
}
