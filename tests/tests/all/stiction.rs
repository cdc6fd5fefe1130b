//! Dry friction that sticks: times of events against closed forms, nothing creeps.

use std::f64::consts::PI;

use blocksim_tests::{Run, run_blocks};

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} != {expected} (tolerance {tolerance})");
}

/// Times at which modes end.
fn modes(run: &Run, guard: &str) -> Vec<f64> {
    run.events.iter().filter(|(_, path, _)| path == guard).map(|(t, ..)| *t).collect()
}

const SOLVERS: [&str; 3] =
    ["Ode45(rtol: 1e-9, atol: 1e-12)", "RosW3(rtol: 1e-9, atol: 1e-12)", "Rodas4(rtol: 1e-8)"];

#[test]
fn a_coasting_flywheel_stops_after_j_w_over_t_and_stays() {
    for solver in SOLVERS {
        let run = run_blocks(
            "10 s",
            solver,
            r#""disc": Inertia(j: 0.5, w0: 40.0),
               "bearing": RotationalFriction(breakaway: 12.0, breakaway_velocity: 0.0, coulomb: 10.0, model: Stiction),
               "sensor": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["w", "phi"])"#,
            r#""disc.r <-> bearing.r <-> sensor.r", "bearing.c <-> sensor.c <-> frame.r",
               "sensor.w -> scope.w", "sensor.phi -> scope.phi""#,
        );
        let stops = modes(&run, "bearing");
        assert_eq!(stops.len(), 1, "{solver}: {:?}", run.events);
        close(stops[0], 2.0, 1e-9);
        assert_eq!(run.last("scope.w"), 0.0, "{solver}");
        close(run.last("scope.phi"), 40.0, 1e-8);
        let rest: Vec<f64> = run
            .time
            .iter()
            .zip(run.column("scope.w"))
            .filter(|(t, _)| **t > 2.0 + 1e-8)
            .map(|(_, w)| *w)
            .collect();
        assert!(rest.iter().all(|w| *w == 0.0), "{solver}");
    }
}

/// A disc is pulled by a spring whose other end turns evenly: it sticks until the spring bears the breakaway torque,
/// slips while the spring swings back, and sticks again. In the frame of the spring's end this is a mass on a belt.
#[test]
fn a_disc_that_a_spring_pulls_sticks_and_slips_at_the_times_of_the_closed_form() {
    let (j, k, v, held, sliding) = (0.02, 50.0, 0.4, 3.0, 1.8);
    let omega = f64::sqrt(k / j);
    let a = (held - sliding) / k;
    // Stretch of the spring while it slips: sliding/k + a cos(omega t) + v/omega sin(omega t), until its rate is v again.
    let slip = 2.0 * (PI - f64::atan(a * omega / v)) / omega;
    // By symmetry it stops at sliding/k - a, and the stretch has to come up by 2 a.
    let stick = 2.0 * a / v;
    let mut expected = vec![held / k / v];
    while expected.len() < 12 {
        let last = *expected.last().unwrap();
        expected.push(last + if expected.len() % 2 == 1 { slip } else { stick });
    }
    for solver in SOLVERS {
        let run = run_blocks(
            "1.2 s",
            solver,
            r#""pull": Constant(value: "0.4 rad/s"), "drive": IdealSpeedSource, "spring": RotationalSpring(k: 50.0),
               "disc": Inertia(j: 0.02),
               "rail": RotationalFriction(breakaway: 3.0, breakaway_velocity: 0.0, coulomb: 1.8, model: Stiction),
               "sensor": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["w"])"#,
            r#""pull.y -> drive.w", "drive.r <-> spring.r", "spring.c <-> disc.r <-> rail.r <-> sensor.r",
               "drive.c <-> rail.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#,
        );
        let found = modes(&run, "rail");
        let due = expected.iter().filter(|t| **t < 1.2).count();
        assert_eq!(found.len(), due, "{solver}: more or fewer events than there are: {found:?}");
        let tolerance = if solver.starts_with("Rodas4") { 1e-6 } else { 1e-7 };
        for (i, expected) in expected.iter().take_while(|t| **t < 1.2).enumerate() {
            let nearest = found.iter().map(|t| (t - expected).abs()).fold(f64::INFINITY, f64::min);
            assert!(
                nearest < tolerance,
                "{solver}, event {i} at {expected} is off by {nearest:e}: {found:?}"
            );
        }
    }
}

/// Half a minute under gravity, lossy gear between brake and joint; then it is let go and caught again.
#[test]
fn a_brake_holds_a_joint_under_gravity_without_creeping() {
    for solver in ["Ode45(rtol: 1e-6)", "RosW3(rtol: 1e-6)", "Ode4(step: 1e-3)"] {
        let run = run_blocks(
            "32 s",
            solver,
            r#""apply": Pulse(period: "100 s", width: 0.01, delay: "30 s", amplitude: -1.0), "one": Constant(value: 1.0), "sum": Sum(signs: "++"),
               "rotor": Inertia(j: 1e-4), "brake": Brake(torque: 0.9),
               "gear": CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.75, efficiency_backward: 0.7),
               "world": World, "joint": RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 1.0),
               "arm": Body(mass: 5.0, com: (0.3, 0.0, 0.4), moi: (0.1, 0.1, 0.1)),
               "housing": RotationalReference, "scope": Scope(inputs: ["q", "w", "locked"])"#,
            r#""apply.y -> sum.u1", "one.y -> sum.u2", "sum.y -> brake.engaged",
               "rotor.r <-> brake.r <-> gear.base", "gear.follower <-> joint.r", "joint.c <-> brake.c <-> housing.r",
               "world.frame <-> joint.base", "joint.follower <-> arm.frame",
               "joint.q -> scope.q", "joint.w -> scope.w", "brake.locked -> scope.locked""#,
        );
        let (q, w) = (run.column("scope.q"), run.column("scope.w"));
        for ((t, q), w) in run.time.iter().zip(q).zip(w) {
            assert!(
                *t >= 30.0 || (*q == 1.0 && *w == 0.0),
                "{solver}: at {t} s it creeps: {q} rad, {w} rad/s"
            );
        }
        assert!(w.iter().any(|w| w.abs() > 1.0), "{solver}: it is let go");
        assert_eq!((run.last("scope.w"), run.last("scope.locked")), (0.0, 1.0), "{solver}");
    }
}

/// Two clutches in a row bring three discs to one speed; each locks for itself.
#[test]
fn locked_clutches_turn_as_one_in_every_bit() {
    for solver in SOLVERS {
        let run = run_blocks(
            "3 s",
            solver,
            r#""press": Constant(value: 1.0), "a": Inertia(j: 0.2, w0: 100.0), "b": Inertia(j: 0.3), "c": Inertia(j: 0.5),
               "first": Clutch(torque: 30.0), "second": Clutch(torque: 12.0),
               "wa": MotionSensor, "wb": MotionSensor, "wc": MotionSensor, "frame": RotationalReference,
               "scope": Scope(inputs: ["a", "b", "c"])"#,
            r#""press.y -> first.normal, second.normal", "a.r <-> first.r <-> wa.r", "first.c <-> b.r <-> second.r <-> wb.r",
               "second.c <-> c.r <-> wc.r", "wa.c <-> wb.c <-> wc.c <-> frame.r",
               "wa.w -> scope.a", "wb.w -> scope.b", "wc.w -> scope.c""#,
        );
        // a: -150, b: +60, c: +24 rad/s^2: the first locks at 100/210 s at 200/7 rad/s; then both lose 24 rad/s^2.
        let first = 100.0 / 210.0;
        let second = first + (100.0 - 150.0 * first - 24.0 * first) / 48.0;
        close(modes(&run, "first")[0], first, 1e-9);
        close(modes(&run, "second")[0], second, 1e-9);
        assert_eq!((run.last("scope.a"), run.last("scope.a")), (run.last("scope.b"), run.last("scope.c")));
        close(run.last("scope.a"), 20.0, 1e-9);
        assert_eq!(run.counts.events, 2, "{solver}: {:?}", run.events);
    }
}

/// Two brakes hold in proportion to what they can; one cannot hold what both can.
#[test]
fn brakes_on_one_shaft_share_the_load_and_give_way_together() {
    let run = run_blocks(
        "4 s",
        "Ode45(rtol: 1e-8)",
        r#""ramp": Ramp(slope: "5 N*m/s"), "push": IdealTorqueSource, "disc": Inertia(j: 0.5), "full": Constant(value: 1.0),
           "large": Brake(torque: 10.0), "small": Brake(torque: 5.0), "sensor": MotionSensor,
           "frame": RotationalReference, "scope": Scope(inputs: ["large", "small", "w"])"#,
        r#""ramp.y -> push.tau", "push.r <-> disc.r <-> large.r <-> small.r <-> sensor.r",
           "full.y -> large.engaged, small.engaged",
           "push.c <-> large.c <-> small.c <-> sensor.c <-> frame.r",
           "large.tau -> scope.large", "small.tau -> scope.small", "sensor.w -> scope.w""#,
    );
    for t in [0.5, 1.0, 2.9] {
        close(run.at("scope.large", t), 5.0 * t * 2.0 / 3.0, 1e-9);
        close(run.at("scope.small", t), 5.0 * t / 3.0, 1e-9);
        assert_eq!(run.at("scope.w", t), 0.0);
    }
    // 15 N*m are reached after 3 s; then the ramp accelerates: w = 5 (t - 3)^2 / 2 / j.
    close(modes(&run, "large")[0], 3.0, 1e-9);
    close(run.last("scope.w"), 5.0, 1e-7);
}

/// A pedal drives a wheel, lets it overrun, and catches it up; at the start both collide.
#[test]
fn a_freewheel_locks_drives_and_overruns() {
    let run = run_blocks(
        "3 s",
        "Ode45(rtol: 1e-8)",
        r#""tau": Step(time: "1 s", before: "4 N*m", after: "-8 N*m"), "foot": IdealTorqueSource,
           "pedal": Inertia(j: 1.0, w0: 10.0), "wheel": Inertia(j: 1.0), "hub": OneWayClutch(),
           "front": MotionSensor, "back": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["front", "back"])"#,
        r#""tau.y -> foot.tau", "pedal.r <-> hub.r <-> foot.r <-> front.r", "wheel.r <-> hub.c <-> back.r",
           "foot.c <-> front.c <-> back.c <-> frame.r", "front.w -> scope.front", "back.w -> scope.back""#,
    );
    // They collide at t = 0 without rebound.
    close(run.at("scope.front", 1e-3), 5.002, 1e-9);
    let locked: Vec<usize> =
        (0..run.time.len()).filter(|i| run.time[*i] > 0.0 && run.time[*i] < 1.0).collect();
    assert!(!locked.is_empty());
    for i in locked {
        assert_eq!(run.column("scope.front")[i], run.column("scope.back")[i]);
    }
    close(run.last("scope.back"), 7.0, 1e-9);
    close(run.last("scope.front"), 7.0 - 16.0, 1e-9);
}

/// Friction of joints and of motors, lossy gears, gravity, a torque that swings: nothing chatters, no energy is made,
/// and explicit, implicit and fixed-step methods agree.
#[test]
fn an_arm_with_stiction_everywhere_runs_alike_with_all_methods() {
    let gear = "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.75, efficiency_backward: 0.7)";
    let friction = |breakaway: f64, coulomb: f64| {
        format!(
            "RotationalFriction(breakaway: {breakaway:?}, breakaway_velocity: 0.05, coulomb: {coulomb:?}, viscous: 0.001, model: Stiction)"
        )
    };
    let axis = |name: &str| {
        format!(
            r#""{name}_push": IdealTorqueSource, "{name}_rotor": Inertia(j: 1e-4), "{name}_seal": {},
               "{name}_gear": {gear}, "{name}_bearing": {},"#,
            friction(0.03, 0.02),
            friction(0.5, 0.4)
        )
    };
    let wires = |name: &str| {
        format!(
            r#""{name}_push.r <-> {name}_rotor.r <-> {name}_seal.r <-> {name}_gear.base",
               "{name}_gear.follower <-> {name}.r <-> {name}_bearing.r",
               "{name}_push.c <-> {name}_seal.c <-> {name}_bearing.c <-> {name}.c","#
        )
    };
    let blocks = format!(
        r#"{} {} "world": World, "shoulder": RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 2.5),
           "upper": Body(mass: 3.0, com: (0.0, 0.0, 0.2), moi: (0.02, 0.02, 0.005)),
           "link": Transform(translation: (0.0, 0.0, 0.4)),
           "elbow": RevoluteJoint(axis: (0.0, 1.0, 0.0), position: 0.3),
           "fore": Body(mass: 2.0, com: (0.0, 0.0, 0.15), moi: (0.01, 0.01, 0.003)),
           "swing": Sine(amplitude: "0.35 N*m", frequency: "0.8 Hz"), "slow": Sine(amplitude: "0.12 N*m", frequency: "0.3 Hz"),
           "housing": RotationalReference, "scope": Scope(inputs: ["q1", "q2"])"#,
        axis("shoulder"),
        axis("elbow")
    );
    let connections = format!(
        r#"{} {} "shoulder.c <-> elbow.c <-> housing.r", "swing.y -> shoulder_push.tau", "slow.y -> elbow_push.tau",
           "world.frame <-> shoulder.base", "shoulder.follower <-> upper.frame <-> link.base",
           "link.follower <-> elbow.base", "elbow.follower <-> fore.frame",
           "shoulder.q -> scope.q1", "elbow.q -> scope.q2""#,
        wires("shoulder"),
        wires("elbow")
    );
    let run = |solver: &str| run_blocks("4 s", solver, &blocks, &connections);
    let reference = run("Ode45(rtol: 1e-10, atol: 1e-12)");
    assert!(reference.counts.events > 10 && reference.counts.events < 100, "{}", reference.counts.events);
    for (solver, tolerance) in [
        ("RosW3(rtol: 1e-8, atol: 1e-10)", 1e-5),
        ("Rodas4(rtol: 1e-8, atol: 1e-10)", 1e-5),
        ("Ode4(step: 2e-4)", 2e-3),
    ] {
        let other = run(solver);
        for column in ["scope.q1", "scope.q2"] {
            close(other.last(column), reference.last(column), tolerance);
        }
    }
}

/// A brake that locks a disc, is let go at 0.5 s and pressed again from 2 s on, ever harder. In between nothing holds the disc,
/// and its speed passes through zero without an event; whichever way it turns at 2 s, the brake works against it.
#[test]
fn a_brake_that_nothing_presses_has_no_modes_and_finds_the_right_one() {
    let (j, amplitude, w) = (0.1, 1.5, 2.0 * PI * 1.3);
    let turned = |t: f64| amplitude / (j * w) * (f64::cos(0.5 * w) - f64::cos(w * t));
    for solver in ["Auto", "Ode45(rtol: 1e-9)", "RosW3(rtol: 1e-9)", "Radau5(rtol: 1e-8)", "Ode4(step: 1e-4)"]
    {
        for sign in [1.0, -1.0] {
            let run = run_blocks(
                "2.02 s",
                solver,
                &format!(
                    r#""off": Step(time: "0.5 s", before: 1.0, after: 0.0), "on": Ramp(slope: "0.5 1/s", start: "2 s"),
                       "normal": Sum(signs: "++"), "source": Sine(amplitude: "{} N*m", frequency: "1.3 Hz"),
                       "push": IdealTorqueSource, "disc": Inertia(j: {j}), "brake": Brake(torque: 4.0), "sensor": MotionSensor,
                       "frame": RotationalReference, "scope": Scope(inputs: ["w", "tau"])"#,
                    sign * amplitude
                ),
                r#""off.y -> normal.u1", "on.y -> normal.u2", "normal.y -> brake.engaged", "source.y -> push.tau",
                   "push.r <-> disc.r <-> brake.r <-> sensor.r", "push.c <-> brake.c <-> sensor.c <-> frame.r",
                   "sensor.w -> scope.w", "brake.tau -> scope.tau""#,
            );
            let passes = (50..200).filter(|k| {
                let t = 0.01 * f64::from(*k);
                turned(t) * turned(t + 0.01) < 0.0
            });
            assert!(passes.count() >= 3, "the speed passes through zero");
            // All that happens is that it is let go and pressed again.
            let between = run.events.iter().filter(|(t, ..)| *t > 0.5 + 1e-6 && *t < 2.0 - 1e-6);
            assert_eq!(between.count(), 0, "{solver}: {:?}", run.events);
            // The brake takes away the integral of 4 N*m * 0.5 (t - 2 s).
            let against = sign * turned(2.0).signum();
            let expected = sign * turned(2.02) - against * 0.02_f64.powi(2) / j;
            assert!(expected * against > 0.0, "it has not come to rest");
            close(run.last("scope.w"), expected, 1e-5);
            close(run.last("scope.tau"), against * 0.04, 1e-9);
        }
    }
}

const ALL: [&str; 10] = [
    "Auto",
    "Ode45()",
    "Ode15s()",
    "Ode15s(rtol: 1e-9)",
    "Radau5()",
    "Rodas4()",
    "Ode23tb()",
    "Ode23t()",
    "RosW3()",
    "Ode4(step: 1e-4)",
];

/// A motor at stall pulls with 6 N*m at what a friction of 8 N*m holds and a sliding one of 2 N*m would not. Implicit methods leave a
/// speed of 1e-26 rad/s there, which is rounding: only a torque or a blow makes it slip.
#[test]
fn what_is_held_does_not_slip_by_the_rounding_of_a_speed() {
    let frictions = [
        (
            "RotationalFriction(breakaway: 8, breakaway_velocity: 0, coulomb: 2, viscous: 0.1, model: Stiction)",
            "",
            "",
        ),
        ("Brake(torque: 2, peak: 4)", r#""on": Constant(value: true),"#, r#", "on.y -> friction.engaged""#),
        // At the end of its travel it stays as well, and touches it once.
        ("RotationalRigidStop(upper: 0.05, restitution: 0)", "", ""),
    ];
    for (friction, blocks, wires) in frictions {
        let mut positions = Vec::new();
        for solver in ALL {
            let run = run_blocks(
                "1 s",
                solver,
                &format!(
                    r#""v": VoltageSource(v: "12 V"), "g": ElectricalReference, "m": DcMotor(r: 1, l: "1 mH", k: 0.1, j: 1e-4),
                       "gear": SimpleGear(ratio: 5, direction: Same), "spring": RotationalSpringDamper(k: 50, d: 0.5),
                       "load": Inertia(j: 0.05, w0: -1), "friction": {friction}, {blocks} "frame": RotationalReference,
                       "sensor": MotionSensor, "scope": Scope(inputs: ["w", "phi"])"#
                ),
                &format!(
                    r#""v.p <-> m.p", "v.n <-> m.n <-> g.p", "m.r <-> gear.base", "gear.follower <-> spring.r",
                       "spring.c <-> load.r <-> friction.r <-> sensor.r", "m.c <-> frame.r <-> friction.c <-> sensor.c",
                       "sensor.w -> scope.w", "sensor.phi -> scope.phi"{wires}"#
                ),
            );
            let what = format!("{friction}, {solver}: {:?}", run.events);
            let rests = run.events.iter().filter(|(_, path, _)| path == "friction");
            let most = if friction.contains("Stop") { 2 } else { 1 };
            assert!(
                rests.count() <= most && run.counts.accepted < 12_000,
                "{what}, {} steps",
                run.counts.accepted
            );
            close(run.last("scope.w"), 0.0, 1e-9);
            positions.push(run.last("scope.phi"));
        }
        for (position, solver) in positions.iter().zip(ALL) {
            let tolerance = if solver.starts_with("Ode4(") { 1e-3 } else { 1e-7 };
            assert!(
                (position - positions[1]).abs() < tolerance,
                "{friction}, {solver}: {position}, {positions:?}"
            );
        }
    }
}

/// On a belt that swings, under a load that sliding friction would not hold. The speed of what is stuck is integrated, and
/// is that of the belt up to the error of the method, which is no blow.
#[test]
fn what_a_swinging_belt_carries_stays_on_it() {
    for solver in ALL {
        let run = run_blocks(
            "2 s",
            solver,
            r#""w": Sine(amplitude: "0.5 rad/s", frequency: "1 Hz"), "dw": Sine(amplitude: "3.141592653589793 rad/s^2", frequency: "1 Hz", phase: "90 deg"),
               "belt": IdealSpeedSource, "disc": Inertia(j: 0.5), "pull": Constant(value: "4 N*m"), "load": IdealTorqueSource,
               "friction": RotationalFriction(breakaway: 8, breakaway_velocity: 0, coulomb: 2, model: Stiction),
               "frame": RotationalReference, "sensor": MotionSensor, "scope": Scope(inputs: ["w"])"#,
            r#""w.y -> belt.w", "dw.y -> belt.dw", "belt.r <-> friction.c", "friction.r <-> disc.r <-> load.r <-> sensor.r",
               "pull.y -> load.tau", "belt.c <-> load.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#,
        );
        assert_eq!(modes(&run, "friction"), [0.0; 0], "{solver}: {:?}", run.events);
        let tolerance = if solver.starts_with("Ode4(") { 1e-9 } else { 1e-5 };
        for (t, w) in run.time.iter().zip(run.column("scope.w")) {
            close(*w, 0.5 * (2.0 * PI * t).sin(), tolerance);
        }
    }
}

/// Where the speed of the belt jumps, what lies on it slides until friction has made up for the jump, be it ever so well held.
#[test]
fn a_belt_whose_speed_jumps_slips_under_what_it_carries() {
    let (a, size, after) = (0.2, 1.0, 2.0 / 0.5);
    let omega = 2.0 * PI;
    // Slip: the jump, less what friction gives, and what the belt moves on.
    let slip = |t: f64| size - after * (t - 0.3) + a * ((omega * t).sin() - (omega * 0.3).sin());
    let (mut left, mut right) = (0.3, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (left + right);
        *(if slip(middle) > 0.0 { &mut left } else { &mut right }) = middle;
    }
    for solver in ALL.iter().filter(|solver| !solver.starts_with("Ode4(")) {
        let run = run_blocks(
            "1 s",
            solver,
            &format!(
                r#""swing": Sine(amplitude: "{a} rad/s", frequency: "1 Hz"), "blow": Step(time: "0.3 s", after: "{size} rad/s"), "w": Sum(signs: "++"),
                   "dw": Sine(amplitude: "{} rad/s^2", frequency: "1 Hz", phase: "90 deg"),
                   "belt": IdealSpeedSource, "disc": Inertia(j: 0.5),
                   "friction": RotationalFriction(breakaway: 8, breakaway_velocity: 0, coulomb: 2, model: Stiction),
                   "frame": RotationalReference, "sensor": MotionSensor, "scope": Scope(inputs: ["w"])"#,
                a * omega
            ),
            r#""swing.y -> w.u1", "blow.y -> w.u2", "w.y -> belt.w", "dw.y -> belt.dw", "belt.r <-> friction.c",
               "friction.r <-> disc.r <-> sensor.r", "belt.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#,
        );
        let found = modes(&run, "friction");
        assert_eq!(found.len(), 2, "{solver}: {:?}", run.events);
        close(found[0], 0.3, 1e-12);
        close(found[1], left, 1e-4);
        close(run.last("scope.w"), size, 1e-4);
    }
}

/// Two shafts that turn as one differ by what the iterations of a method leave. That is no slip: the clutch locks once, and
/// transmits what the load takes.
#[test]
fn a_clutch_between_turning_shafts_locks_once() {
    // In a steady state the damper and the load take 0.001 w + 2 N*m, the motor gives 0.1 (24 - 0.1 w)/0.3.
    let steady = (0.1 * 24.0 / 0.3 - 2.0) / (0.001 + 0.01 / 0.3);
    for solver in ALL.iter().filter(|solver| !solver.starts_with("Ode4(")) {
        let run = run_blocks(
            "10 s",
            solver,
            r#""v": VoltageSource(v: 24), "g": ElectricalReference, "m": DcMotor(r: 0.3, l: 1e-5, k: 0.1, j: 2e-4),
               "clutch": Clutch(torque: 4, peak: 1.3), "one": Constant(value: 1), "disc": Inertia(j: 0.01),
               "bearing": RotationalDamper(d: 0.001), "frame": RotationalReference, "load": IdealTorqueSource,
               "ramp": SignalBuilder(points: [(0, 0), (0.5, 0), (1, -2)]), "wa": MotionSensor, "wb": MotionSensor,
               "scope": Scope(inputs: ["a", "b", "tau"])"#,
            r#""v.p <-> m.p", "v.n <-> m.n <-> g.p", "m.r <-> clutch.r <-> wa.r",
               "clutch.c <-> disc.r <-> bearing.r <-> load.r <-> wb.r",
               "m.c <-> frame.r <-> bearing.c <-> load.c <-> wa.c <-> wb.c", "one.y -> clutch.normal", "ramp.y -> load.tau",
               "wa.w -> scope.a", "wb.w -> scope.b", "clutch.tau -> scope.tau""#,
        );
        let locks = run.events.iter().filter(|(_, path, what)| path == "clutch" && what == "locks").count();
        assert_eq!(locks, 1, "{solver}: {:?}", run.events);
        close(run.last("scope.a"), steady, 3e-6 * steady);
        close(run.last("scope.b"), steady, 3e-6 * steady);
        close(run.last("scope.tau"), 2.0 + 0.001 * steady, 1e-4);
        let locked = run.time.iter().zip(run.column("scope.tau")).filter(|(t, _)| **t > 1.0);
        assert!(locked.clone().all(|(_, tau)| *tau > 1.5 && *tau < 2.5), "{solver}");
    }
}

/// What slides on a part can load it with no more than its own friction, which the part bears at rest, though not while it slides.
#[test]
fn a_part_that_is_held_stays_where_what_slides_on_it_reverses() {
    for solver in SOLVERS.into_iter().chain(["Ode4(step: \"0.5 ms\")"]) {
        // What is decided does not depend on names.
        let ends = ["a", "z"].map(|bearing| {
            let run = run_blocks(
                "2 s",
                solver,
                &format!(
                    r#""x": Inertia(j: 0.856), "y": Inertia(j: 1.12), "s": Sine(amplitude: "6.37 N*m", frequency: 2.4),
                       "f": RotationalFriction(breakaway: 0.356, breakaway_velocity: 0, coulomb: 0.356, model: Stiction),
                       "{bearing}": RotationalFriction(breakaway: 0.392, breakaway_velocity: 0, coulomb: 0.28, model: Stiction),
                       "t": IdealTorqueSource, "h": RotationalReference, "on_x": MotionSensor, "on_y": MotionSensor,
                       "scope": Scope(inputs: ["x", "y"])"#
                ),
                &format!(
                    r#""s.y -> t.tau", "t.r <-> x.r <-> f.c <-> on_x.r", "f.r <-> y.r <-> {bearing}.r <-> on_y.r",
                       "t.c <-> h.r <-> {bearing}.c <-> on_x.c <-> on_y.c", "on_x.w -> scope.x", "on_y.w -> scope.y""#
                ),
            );
            assert!(run.column("scope.y").iter().all(|w| *w == 0.0), "{solver}, {bearing}: {:?}", run.events);
            run.last("scope.x")
        });
        let fixed = run_blocks(
            "2 s",
            solver,
            r#""x": Inertia(j: 0.856), "s": Sine(amplitude: "6.37 N*m", frequency: 2.4), "t": IdealTorqueSource,
               "f": RotationalFriction(breakaway: 0.356, breakaway_velocity: 0, coulomb: 0.356, model: Stiction),
               "h": RotationalReference, "on_x": MotionSensor, "scope": Scope(inputs: ["x"])"#,
            r#""s.y -> t.tau", "t.r <-> x.r <-> f.c <-> on_x.r", "f.r <-> t.c <-> h.r <-> on_x.c", "on_x.w -> scope.x""#,
        );
        for end in ends {
            close(end, fixed.last("scope.x"), 1e-9);
        }
    }
}

/// Between shafts that turn as one nothing slips: whatever is put there, the rest is what it was without it.
#[test]
fn what_can_never_slip_changes_nothing_elsewhere() {
    let of = |solver: &str, between: &str| {
        let (kind, pins) = match between {
            "" => (String::new(), String::new()),
            kind => (format!(r#""o": {kind},"#), r#", "g.base <-> o.c", "g.follower <-> o.r""#.to_owned()),
        };
        let run = run_blocks(
            "2 s",
            solver,
            &format!(
                r#""h": RotationalReference, {kind}
                   "f": RotationalFriction(breakaway: 1.01, breakaway_velocity: 0, coulomb: 1.01, model: Stiction),
                   "q": RotationalFriction(breakaway: 2.618, breakaway_velocity: 0, coulomb: 1.87, model: Stiction),
                   "g": SimpleGear(ratio: 1, direction: Same), "u": Inertia(j: 0.3), "y": Inertia(j: 0.18), "x": Inertia(j: 0.822),
                   "sy": Sine(amplitude: "1.73 N*m", frequency: 1.98, phase: 0.33), "ty": IdealTorqueSource,
                   "sx": Sine(amplitude: "7.9 N*m", frequency: 0.56, phase: -0.7), "tx": IdealTorqueSource,
                   "on_x": MotionSensor, "on_y": MotionSensor, "scope": Scope(inputs: ["x", "y"])"#
            ),
            &format!(
                r#""sy.y -> ty.tau", "sx.y -> tx.tau", "h.r <-> q.c <-> ty.c <-> tx.c <-> on_x.c <-> on_y.c",
                   "f.r <-> q.r <-> y.r <-> ty.r <-> on_y.r", "f.c <-> g.base <-> tx.r <-> u.r", "g.follower <-> x.r <-> on_x.r",
                   "on_x.w -> scope.x", "on_y.w -> scope.y"{pins}"#
            ),
        );
        let events: Vec<(f64, String)> = run
            .events
            .iter()
            .filter(|event| event.1 != "o")
            .map(|event| (event.0, event.2.clone()))
            .collect();
        (events, run.last("scope.x"), run.last("scope.y"))
    };
    for solver in ["Ode45(rtol: 1e-9)", "Radau5(rtol: 1e-8)"] {
        let plain = of(solver, "");
        assert!(plain.0.len() > 5, "{:?}", plain.0);
        for between in [
            "OneWayClutch",
            "RotationalRigidStop(lower: -1, upper: 1)",
            "RotationalFriction(breakaway: 2, breakaway_velocity: 0, coulomb: 1, model: Stiction)",
        ] {
            let with = of(solver, between);
            assert_eq!(with.0.len(), plain.0.len(), "{solver}, {between}: {:?} and {:?}", with.0, plain.0);
            for (a, b) in with.0.iter().zip(&plain.0) {
                assert!((a.0 - b.0).abs() < 1e-7 && a.1 == b.1, "{solver}, {between}: {a:?} and {b:?}");
            }
            close(with.1, plain.1, 1e-7);
            close(with.2, plain.2, 1e-7);
        }
    }
}

/// A brake that holds 5.46 N*m comes to rest with a load of 4.8 N*m on it, pushed until then by what turns back without it.
#[test]
fn a_brake_holds_what_is_left_when_a_freewheel_lets_go() {
    for pusher in ["OneWayClutch", "RotationalRigidStop(lower: -10, upper: 0)"] {
        for brake in ["a", "z"] {
            let run = run_blocks(
                "0.6 s",
                "Ode45(rtol: 1e-8)",
                &format!(
                    r#""h": RotationalReference, "x": Inertia(j: 0.15, w0: 1), "y": Inertia(j: 1.5, w0: 1), "tx": ConstantTorque(tau: -4.8),
                       "ty": ConstantTorque(tau: -5), "{brake}": Brake(torque: 4.2, peak: 1.3), "on": Constant(value: 1), "o": {pusher},
                       "on_x": MotionSensor, "on_y": MotionSensor, "scope": Scope(inputs: ["x", "y"])"#
                ),
                &format!(
                    r#""x.r <-> tx.r <-> {brake}.r <-> o.c <-> on_x.r", "y.r <-> ty.r <-> o.r <-> on_y.r", "on.y -> {brake}.engaged",
                       "tx.c <-> ty.c <-> {brake}.c <-> h.r <-> on_x.c <-> on_y.c", "on_x.w -> scope.x", "on_y.w -> scope.y""#
                ),
            );
            assert!(run.error.is_none(), "{:?}", run.error);
            assert_eq!(run.last("scope.x"), 0.0, "{brake}: {:?}", run.events);
            // 1.65 kg m^2 stop at 14 N m; then y alone turns back.
            let stop = 1.65 / 14.0;
            close(run.last("scope.y"), -5.0 / 1.5 * (0.6 - stop), 1e-7);
        }
    }
}
