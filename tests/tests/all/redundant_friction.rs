//! Several dry frictions that hold the same parts: what they bear together, against closed forms.

use blocksim_tests::{Run, close, root, run_blocks, run_text};

const SOLVERS: [&str; 11] = [
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
    "Ode4(step: 1e-3)",
];

/// Three discs, a clutch between each two. A torque between `a` and `b` grows: the clutch `ab` bears what it can, and the
/// way over `c` the lower one of its two. An even share would be too much for `ab` long before.
#[test]
fn a_triangle_of_clutches_gives_way_when_all_ways_are_full() {
    for (ab, bc, ca) in [(1.0, 5.0, 7.0), (4.0, 2.0, 9.0), (6.0, 9.0, 0.5), (3.0, 3.0, 3.0), (0.0, 4.0, 4.0)]
    {
        for solver in SOLVERS {
            let full = ab + f64::min(bc, ca);
            let start = full / 4.0;
            let run = run_blocks(
                &format!("{:?} s", start + 0.4),
                solver,
                &format!(
                    r#""ramp": Ramp(slope: "4 N*m/s"), "one": Constant(value: 1.0),
                       "forward": IdealTorqueSource, "back": IdealTorqueSource, "minus": Gain(k: -1.0),
                       "a": Inertia(j: 0.5), "b": Inertia(j: 0.5), "c": Inertia(j: 0.5),
                       "ab": Clutch(torque: {ab:?}), "bc": Clutch(torque: {bc:?}), "ca": Clutch(torque: {ca:?}),
                       "sa": MotionSensor, "sb": MotionSensor, "sc": MotionSensor, "frame": RotationalReference,
                       "scope": Scope(inputs: ["a", "b", "c"])"#
                ),
                r#""one.y -> ab.normal, bc.normal, ca.normal", "ramp.y -> forward.tau, minus.u", "minus.y -> back.tau",
                   "forward.r <-> a.r <-> ab.r <-> ca.c <-> sa.r", "back.r <-> b.r <-> ab.c <-> bc.r <-> sb.r",
                   "c.r <-> bc.c <-> ca.r <-> sc.r",
                   "forward.c <-> back.c <-> sa.c <-> sb.c <-> sc.c <-> frame.r",
                   "sa.w -> scope.a", "sb.w -> scope.b", "sc.w -> scope.c""#,
            );
            let fixed = if solver.contains("step") { 4e-3 } else { 1e-6 };
            let ends = run.column("scope.a").iter().zip(run.column("scope.b"));
            for (t, (a, b)) in run.time.iter().zip(ends) {
                assert!(
                    *t > start - 1e-9 || a == b,
                    "{solver}, {ab} {bc} {ca}: moves at {t} s, due {start} s"
                );
            }
            // From then on the rest accelerates `a` forward; `c` goes with the end whose clutch holds.
            let impulse = 2.0 * 0.4 * 0.4;
            let (a, b, c) = (run.last("scope.a"), run.last("scope.b"), run.last("scope.c"));
            let what = format!("{solver}, {ab} {bc} {ca}");
            close(a + b + c, 0.0, fixed * (1.0 + impulse), &what);
            if bc == ca {
                close(a, impulse / 0.5, fixed * (1.0 + impulse) * 10.0, &what);
                close(c, 0.0, fixed * (1.0 + impulse) * 10.0, &what);
            } else {
                // The weaker clutch slips; with the stronger one `c` and its end are one body of twice the inertia.
                let (lone, pair) = if bc < ca { (b, a) } else { (a, b) };
                close(lone.abs(), impulse / 0.5, fixed * (1.0 + impulse) * 10.0, &what);
                close(pair.abs(), impulse / 1.0, fixed * (1.0 + impulse) * 10.0, &what);
                close(c, pair, fixed * (1.0 + impulse) * 10.0, &what);
            }
        }
    }
}

/// Brakes on all three shafts of a differential, of which any two hold it.
#[test]
fn brakes_on_all_shafts_of_a_differential_hold_what_two_of_them_can() {
    for solver in SOLVERS {
        let run = run_blocks(
            "3 s",
            solver,
            r#""ramp": Ramp(slope: "2 N*m/s"), "push": IdealTorqueSource, "one": Constant(value: 1.0),
               "gear": PlanetaryGear(ring_teeth: 60, sun_teeth: 30),
               "js": Inertia(j: 0.1), "jr": Inertia(j: 0.1), "jc": Inertia(j: 0.1),
               "bs": Brake(torque: 0.25), "br": Brake(torque: 4.0), "bc": Brake(torque: 6.0),
               "sensor": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["w"])"#,
            r#""one.y -> bs.engaged, br.engaged, bc.engaged", "ramp.y -> push.tau",
               "gear.sun <-> js.r <-> bs.r <-> push.r <-> sensor.r", "gear.ring <-> jr.r <-> br.r",
               "gear.carrier <-> jc.r <-> bc.r",
               "push.c <-> bs.c <-> br.c <-> bc.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#,
        );
        // At rest the sun bears 0.25 by its brake; the mesh takes T from it, 2 T from the ring and puts 3 T on the carrier,
        // which hold 4 and 6 N*m: the ring and the carrier give way at T = 2, both at once.
        let start = (0.25 + 2.0) / 2.0;
        for (t, w) in run.time.iter().zip(run.column("scope.w")) {
            assert!(*t > start - 1e-9 || *w == 0.0, "{solver}: moves at {t} s, due {start} s");
        }
        assert!(run.last("scope.w") > 1.0, "{solver}: it moves after {start} s: {}", run.last("scope.w"));
    }
}

/// The shipped four-bar linkage with dry friction at the drive and at the knee, thrown at 6 rad/s: both come to rest at the same instant,
/// and together hold what neither holds alone.
fn braked_linkage(solver: &str) -> Run {
    let text = std::fs::read_to_string(root().join("diagrams/four_bar.ron")).expect("a shipped diagram");
    let friction =
        r#"RotationalFriction(breakaway: 1.2, coulomb: 0.7, breakaway_velocity: 0.0, model: Stiction)"#;
    let mut changed = text;
    for (from, to) in [
        ("stop_time: \"2 s\", solver: Ode45(rtol: 1e-9)", format!("stop_time: \"3 s\", solver: {solver}")),
        ("15 rad/s", "6 rad/s".to_owned()),
        (
            "\"world\": World,",
            format!(
                "\"world\": World, \"case\": RotationalReference, \"at_drive\": {friction}, \"at_knee\": {friction},"
            ),
        ),
        (
            "\"drive.q ->",
            "\"at_drive.r <-> drive.r\", \"at_knee.r <-> knee.r\", \
             \"case.r <-> at_drive.c <-> drive.c <-> at_knee.c <-> knee.c\", \"drive.q ->"
                .to_owned(),
        ),
    ] {
        assert_eq!(changed.matches(from).count(), 1, "{from}");
        changed = changed.replace(from, &to);
    }
    run_text(&changed)
}

/// Angles of coupler and rocker at one of the crank, rad, by where circles about both their ends meet.
fn bars(crank: f64) -> (f64, f64) {
    let (x, y) = (0.2 * crank.cos(), 0.2 * crank.sin());
    let (dx, dy) = (0.5 - x, -y);
    let distance = dx.hypot(dy);
    let along = (0.45_f64.powi(2) - 0.4_f64.powi(2) + distance * distance) / (2.0 * distance);
    let across = (0.45_f64.powi(2) - along * along).sqrt();
    let (cx, cy) = (x + (along * dx + across * dy) / distance, y + (along * dy - across * dx) / distance);
    ((cy - y).atan2(cx - x), cy.atan2(cx - 0.5))
}

/// Energy of the bars at an angle and a speed of the crank, J: slopes of the angles by differences.
fn energy(crank: f64, speed: f64) -> f64 {
    let h = 1e-5;
    let (coupler, rocker) = bars(crank);
    let slope = |angle: fn((f64, f64)) -> f64| (angle(bars(crank + h)) - angle(bars(crank - h))) / (2.0 * h);
    let (coupler_speed, rocker_speed) = (speed * slope(|bars| bars.0), speed * slope(|bars| bars.1));
    let [m1, m2, m3] = [0.2, 0.45, 0.4].map(|length| 4.0 * length);
    let (sin, cos) = crank.sin_cos();
    let vx = -0.2 * speed * sin - 0.225 * coupler_speed * coupler.sin();
    let vy = 0.2 * speed * cos + 0.225 * coupler_speed * coupler.cos();
    let kinetic = 0.5
        * (m1 * 0.2_f64.powi(2) / 3.0 * speed * speed
            + m2 * (vx * vx + vy * vy + 0.45_f64.powi(2) / 12.0 * coupler_speed * coupler_speed)
            + m3 * 0.4_f64.powi(2) / 3.0 * rocker_speed * rocker_speed);
    let height = m1 * 0.1 * sin + m2 * (0.2 * sin + 0.225 * coupler.sin()) + m3 * 0.2 * rocker.sin();
    kinetic + 9.80665 * height
}

#[test]
fn frictions_that_come_to_rest_together_through_a_loop_hold_together() {
    let start = 60_f64.to_radians();
    let knee = |crank: f64| {
        let (coupler, rocker) = bars(crank);
        rocker - coupler
    };
    let left = |crank: f64| {
        energy(start, 6.0) - energy(crank, 0.0) - 0.7 * (crank - start + (knee(crank) - knee(start)).abs())
    };
    let (mut moves, mut rests) = (start, start + 0.6);
    for _ in 0..60 {
        let middle = 0.5 * (moves + rests);
        if left(middle) > 0.0 { moves = middle } else { rests = middle }
    }
    // What the weights want there is more than the drive, sliding, and the knee bear.
    let load = (energy(rests + 1e-4, 0.0) - energy(rests - 1e-4, 0.0)) / 2e-4;
    let lever = ((knee(rests + 1e-4) - knee(rests - 1e-4)) / 2e-4).abs();
    assert!(load > 0.7 + 1.2 * lever && load < 1.2 + 1.2 * lever, "{load}, {lever}");
    for method in ["Auto", "Ode45", "Ode15s", "Radau5", "Rodas4", "Ode23t", "Ode23tb", "RosW3"] {
        for (rtol, tolerance) in [("1e-3", 2e-3), ("1e-4", 2e-4), ("1e-6", 5e-6)] {
            let run = braked_linkage(&format!("{method}(rtol: {rtol})"));
            let words: Vec<&str> = run.events.iter().map(|event| event.2.as_str()).collect();
            assert_eq!(words, ["sticks", "sticks"], "{method}, {rtol}: {:?}", run.events);
            close(run.last("angle.crank"), rests, tolerance, &format!("{method}, {rtol}"));
        }
    }
}
