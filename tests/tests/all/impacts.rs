//! What passes an impulse on and what does not; slips that go through zero without sticking.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{close, compile_text, run, run_blocks};

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
    "Ode4(step: 1e-3)",
    "Ode1(step: 1e-4)",
];

/// A disc that turns hits one at rest through a freewheel: both go on with the momentum of the first, whatever the
/// bearing of the second could hold.
#[test]
fn a_freewheel_that_is_struck_moves_what_dry_friction_holds() {
    for solver in SOLVERS {
        for (torque, tolerance) in [(1e-6_f64, 1e-6), (3.0, 1e-6), (3000.0, 1e-6)] {
            let run = run_blocks(
                "50 ms",
                solver,
                &format!(
                    r#""a": Inertia(j: 1.0, w0: 10.0), "hub": OneWayClutch(), "b": Inertia(j: 2.0),
                       "bearing": RotationalFriction(breakaway: {torque:?}, breakaway_velocity: 0.0, coulomb: {torque:?}, model: Stiction),
                       "sa": MotionSensor, "sb": MotionSensor, "frame": RotationalReference,
                       "scope": Scope(inputs: ["a", "b", "phi"])"#
                ),
                r#""a.r <-> hub.r <-> sa.r", "hub.c <-> b.r <-> bearing.r <-> sb.r",
                   "bearing.c <-> sa.c <-> sb.c <-> frame.r", "sa.w -> scope.a", "sb.w -> scope.b", "sb.phi -> scope.phi""#,
            );
            let (start, stop) = (10.0 / 3.0, (10.0 / torque).min(0.05));
            close(run.last("scope.a"), start - torque / 3.0 * stop, tolerance, solver);
            close(run.last("scope.b"), run.last("scope.a"), 0.0, solver);
            let way = stop * (start - torque / 6.0 * stop);
            let fixed = if solver.contains("step") { 0.05 } else { 1e-4 };
            close(run.last("scope.phi"), way, fixed * way.abs(), solver);
        }
    }
}

/// Freewheels in a row pass an impulse on; a clutch that is locked slips instead, as its torque is finite.
#[test]
fn impulses_go_through_freewheels_and_not_through_clutches() {
    for (link, second, third) in
        [("OneWayClutch()", 10.0 / 6.0, 10.0 / 6.0), ("Clutch(torque: 6.0)", 10.0 / 3.0, 0.0)]
    {
        let press = if link.starts_with("Clutch") { r#", "press.y -> link.normal""# } else { "" };
        let run = run_blocks(
            "1 s",
            "Ode45",
            &format!(
                r#""press": Constant(value: 1.0), "a": Inertia(j: 1.0, w0: 10.0), "hub": OneWayClutch(), "b": Inertia(j: 2.0),
                   "link": {link}, "c": Inertia(j: 3.0),
                   "sb": MotionSensor, "sc": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["b", "c"]),
                   "spare": Scope(inputs: ["one"])"#
            ),
            &format!(
                r#""a.r <-> hub.r", "hub.c <-> b.r <-> link.r <-> sb.r", "link.c <-> c.r <-> sc.r",
                   "sb.c <-> sc.c <-> frame.r", "sb.w -> scope.b", "sc.w -> scope.c", "press.y -> spare.one"{press}"#
            ),
        );
        // The clutch brakes 3 kg*m^2 and drives 3 kg*m^2 with 6 N*m until both have 10/6 rad/s, after 10/12 s.
        close(run.at("scope.b", 1e-6), second, 1e-5, link);
        close(run.at("scope.c", 1e-6), third, 1e-5, link);
        close(run.last("scope.b"), 10.0 / 6.0, 1e-9, link);
        close(run.last("scope.c"), 10.0 / 6.0, 1e-9, link);
    }
}

/// A slider-crank without gravity: `J` at the crank, a rod without mass, a slider with dry friction. The friction takes
/// its force times the way from the kinetic energy, so the speed over the angle is known in closed form, and where it stops.
#[test]
fn a_slider_with_dry_friction_goes_through_its_dead_centres() {
    let (j, m, r, l, w0) = (0.02, 1.0, 0.05, 0.2, 42.0);
    let place = |phi: f64| r * phi.cos() + (l * l - (r * phi.sin()).powi(2)).sqrt();
    let rate = |phi: f64| -r * phi.sin() * (1.0 + r * phi.cos() / (l * l - (r * phi.sin()).powi(2)).sqrt());
    let start = 0.7;
    // Way of the slider up to an angle: full strokes of 2 r, and the rest.
    let way = |phi: f64| {
        let upto = |phi: f64| {
            let (strokes, rest) = ((phi / PI).floor(), phi.rem_euclid(PI));
            let from = place(strokes * PI);
            strokes * 2.0 * r + (place(strokes * PI + rest) - from).abs()
        };
        upto(phi) - upto(start)
    };
    for force in [5.0, 20.0] {
        let energy = |phi: f64| 0.5 * (j + m * rate(start).powi(2)) * w0 * w0 - force * way(phi);
        let (mut low, mut high) = (start, start + 200.0 * TAU);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if energy(middle) > 0.0 { low = middle } else { high = middle }
        }
        for (solver, tolerance) in [
            ("Ode45(rtol: 1e-8)", 1e-5),
            ("RosW3(rtol: 1e-7)", 1e-3),
            ("Rodas4(rtol: 1e-7)", 1e-3),
            ("Ode4(step: 5e-4)", 2e-2),
            // What the loop has drifted is no rest.
            ("Auto(rtol: 1e-4)", 1e-2),
            ("Ode15s(rtol: 1e-4)", 1e-1),
            ("Ode23t(rtol: 1e-4)", 2e-1),
            ("Ode23tb(rtol: 1e-4)", 2e-1),
        ] {
            let run = run_blocks(
                if force < 10.0 { "7 s" } else { "2 s" },
                solver,
                &format!(
                    r#""world": World(gravity: (0.0, 0.0, 0.0)),
                       "crank": RevoluteJoint(axis: (0.0, -1.0, 0.0), position: {start:?}, velocity: {w0:?}),
                       "disc": Body(mass: 0.0, com: (0.0, 0.0, 0.0), moi: ({j:?}, {j:?}, {j:?})),
                       "arm": Transform(translation: ({r:?}, 0.0, 0.0)), "pin": RevoluteJoint(axis: (0.0, -1.0, 0.0)),
                       "rod": Transform(translation: ({l:?}, 0.0, 0.0)), "wrist": RevoluteJoint(axis: (0.0, -1.0, 0.0)),
                       "rail": PrismaticJoint(axis: (1.0, 0.0, 0.0), position: {:?}),
                       "slider": Body(mass: {m:?}, com: (0.0, 0.0, 0.0), moi: (0.0, 0.0, 0.0)),
                       "rub": TranslationalFriction(breakaway: {force:?}, breakaway_velocity: 0.0, coulomb: {force:?}, model: Stiction),
                       "bed": TranslationalReference, "account": EnergyAccount(at: Frame, tolerance: {:?}),
                       "scope": Scope(inputs: ["phi", "w"])"#,
                    place(start),
                    f64::max(1e-3, tolerance)
                ),
                r#""world.frame <-> crank.base <-> rail.base", "crank.follower <-> disc.frame <-> arm.base",
                   "arm.follower <-> pin.base", "pin.follower <-> rod.base", "rod.follower <-> wrist.base",
                   "wrist.follower <-> slider.frame <-> rail.follower",
                   "rail.r <-> rub.r", "rail.c <-> rub.c <-> bed.r", "account.node <-> world.frame",
                   "crank.q -> scope.phi", "crank.w -> scope.w""#,
            );
            for (phi, w) in run.column("scope.phi").iter().zip(run.column("scope.w")) {
                if *phi < low - 1.0 {
                    let found = 0.5 * (j + m * rate(*phi).powi(2)) * w * w;
                    close(
                        found,
                        energy(*phi),
                        tolerance * energy(start),
                        &format!("{solver}, {force} N at {phi} rad"),
                    );
                }
            }
            close(run.last("scope.w"), 0.0, 1e-6, solver);
            close(run.last("scope.phi"), low, tolerance * (low - start), solver);
        }
    }
}

/// A ball that bounces on a rigid floor: the bounces accumulate at a time that is known, and then it lies still.
#[test]
fn a_ball_on_a_rigid_floor_comes_to_rest_when_its_bounces_have_added_up() {
    let (g, height, e) = (9.80665, 10.0, 0.8);
    let speed = f64::sqrt(2.0 * g * height);
    let first = speed / g;
    let end = first + 2.0 * first * e / (1.0 - e);
    for (solver, tolerance) in
        [("Ode45", 1e-5), ("Ode23", 1e-5), ("RosW3", 1e-4), ("Rodas4", 1e-5), ("Ode4(step: 1e-4)", 0.05)]
    {
        let run = run_blocks(
            "20 s",
            solver,
            &format!(
                r#""ball": Mass(m: 2.0), "weight": ConstantForce(f: {:?}), "ground": TranslationalReference,
                   "floor": TranslationalRigidStop(lower: 0.0, restitution: {e:?}, x0: {height:?}),
                   "sensor": TranslationalMotionSensor, "scope": Scope(inputs: ["x", "v"])"#,
                -2.0 * g
            ),
            r#""ball.r <-> weight.r <-> floor.r <-> sensor.r", "weight.c <-> floor.c <-> sensor.c <-> ground.r",
               "floor.x -> scope.x", "sensor.v -> scope.v""#,
        );
        let (x, v) = (run.column("scope.x"), run.column("scope.v"));
        let last = run.time.iter().zip(v).filter(|(_, v)| **v != 0.0).map(|(t, _)| *t).fold(0.0, f64::max);
        close(last, end, tolerance * end, solver);
        assert_eq!(run.last("scope.v"), 0.0, "{solver}");
        let fixed = if solver.contains("step") { 1e-3 } else { 1e-9 };
        close(run.last("scope.x"), 0.0, fixed, solver);
        assert!(x.iter().all(|x| *x > -1.5 * speed * fixed), "{solver}: it fell through");
        // Half a second around the top of the third bounce.
        let third = first * (1.0 + 2.0 * e + 2.0 * e * e + e.powi(3));
        close(run.at("scope.v", third - 0.25), 0.25 * g, 2e-2, solver);
        close(run.at("scope.v", third + 0.25), -0.25 * g, 2e-2, solver);
    }
}

/// Balls that meet exchange momentum as Newton's law says, and a row of them passes it on.
#[test]
fn a_row_of_balls_passes_an_impact_on() {
    for e in [0.0, 0.5, 1.0] {
        let run = run_blocks(
            "1 s",
            "Ode45",
            &format!(
                r#""a": Mass(m: 1.0, v0: 2.0), "b": Mass(m: 1.0), "c": Mass(m: 1.0),
                   "ab": TranslationalRigidStop(upper: 0.0, restitution: {e:?}, x0: -0.5),
                   "bc": TranslationalRigidStop(upper: 0.0, restitution: {e:?}, x0: -0.25),
                   "sa": TranslationalMotionSensor, "sb": TranslationalMotionSensor, "sc": TranslationalMotionSensor,
                   "ground": TranslationalReference, "scope": Scope(inputs: ["a", "b", "c"])"#
            ),
            r#""a.r <-> ab.r <-> sa.r", "b.r <-> ab.c <-> bc.r <-> sb.r", "c.r <-> bc.c <-> sc.r",
               "sa.c <-> sb.c <-> sc.c <-> ground.r", "sa.v -> scope.a", "sb.v -> scope.b", "sc.v -> scope.c""#,
        );
        // After 0.25 s b goes with 1 + e, and hits c; with e below 1 a catches up, so only the first two are compared.
        close(run.at("scope.b", 0.3), 1.0 + e, 1e-9, "b");
        close(run.at("scope.a", 0.3), 1.0 - e, 1e-9, "a");
        let after = 0.25 + 0.25 / (1.0 + e) + 1e-3;
        if e > 0.0 {
            close(run.at("scope.c", after), (1.0 + e) * (1.0 + e) / 2.0, 1e-9, "c");
        } else {
            // Both arrive as one: 2 m/s of one are shared by three.
            close(run.at("scope.c", after), 2.0 / 3.0, 1e-9, "c");
        }
        let momentum = run.last("scope.a") + run.last("scope.b") + run.last("scope.c");
        close(momentum, 2.0, 1e-9, "momentum");
    }
}

/// Each flight is half as fast as the one before, until it rests. An event just behind the start of a step must be where it
/// is: with the speed off by the error of a continuous extension, flights would end at a speed of their own and go on for ever.
#[test]
fn ever_smaller_bounces_under_a_load_that_swings_end_in_rest_with_all_methods() {
    for method in
        ["Auto", "Ode45", "Ode23", "Dop853", "Ode15s", "Radau5", "Rodas4", "RosW3", "Ode23t", "Ode23tb"]
    {
        for rtol in ["1e-3", "1e-4", "1e-6"] {
            let run = run_blocks(
                "1.6 s",
                &format!("{method}(rtol: {rtol})"),
                r#""stop": TranslationalRigidStop(lower: 0, restitution: 0.5, x0: 0.1), "mass": Mass(m: 10), "weight": ConstantForce(f: -98.1),
                   "w": Sine(amplitude: 100, frequency: 0.3), "pull": IdealForceSource, "frame": TranslationalReference,
                   "scope": Scope(inputs: ["f"])"#,
                r#""w.y -> pull.f", "pull.r <-> mass.r <-> stop.r <-> weight.r",
                   "pull.c <-> frame.r <-> stop.c <-> weight.c", "stop.f -> scope.f""#,
            );
            assert!(run.events.len() <= 140, "{method}, {rtol}: {} events", run.events.len());
            // What it bears at rest, from then on.
            let load = |t: f64| 98.1 - 100.0 * (TAU * 0.3 * t).sin();
            for (t, f) in run.time.iter().zip(run.column("scope.f")).filter(|(t, _)| **t > 1.4) {
                assert!(
                    (f.abs() - load(*t)).abs() < 1e-6,
                    "{method}, {rtol}: {f} N at {t} s, not {}",
                    load(*t)
                );
            }
        }
    }
}

/// Bounces at an end that is not zero: near it the position has no digits left for the smallest ones, which are none then.
#[test]
fn bounces_that_are_lost_in_the_digits_of_the_position_are_none() {
    let run = |solver: &str| {
        run_blocks(
            "2 s",
            solver,
            r#""stop": RotationalRigidStop(lower: "-90 deg", upper: "90 deg", restitution: 0.3), "wheel": Inertia(j: 0.1),
               "wave": Sine(amplitude: 1, frequency: 1), "torque": IdealTorqueSource, "frame": RotationalReference,
               "scope": Scope(inputs: ["phi"])"#,
            r#""wave.y -> torque.tau", "torque.r <-> wheel.r <-> stop.r", "torque.c <-> frame.r <-> stop.c",
               "stop.phi -> scope.phi""#,
        )
    };
    let exact = run("Dop853(rtol: 1e-10)");
    for method in ["Ode23t", "Ode23tb"] {
        for rtol in [1e-2, 1e-3, 1e-4, 1e-6] {
            let run = run(&format!("{method}(rtol: {rtol:e})"));
            assert!(run.events.len() <= 30, "{method}, {rtol:e}: {} events", run.events.len());
            assert!(run.time.len() < 4000, "{method}, {rtol:e}: {} rows", run.time.len());
            // The first arrival nearly grazes the end, and each bounce magnifies what is missed there.
            for (t, allowed) in [(0.5, 200.0 * rtol), (2.0, 0.05)] {
                let (phi, right) = (run.at("scope.phi", t), exact.at("scope.phi", t));
                assert!((phi - right).abs() < allowed, "{method}, {rtol:e}: {phi} at {t} s, not {right}");
            }
        }
    }
}

/// A mass of 2 m/s strikes two walls at once, one that throws back half of its speed and one that takes all of it: it comes back with 1 m/s, for
/// the second only holds what goes on. So it does between a wall and another mass that stands at a wall of its own, and in the middle of a run.
#[test]
fn ends_that_are_struck_at_once_throw_back_as_much_as_the_one_that_asks_for_most() {
    for solver in SOLVERS {
        for ends in [[0.0, 0.5], [0.5, 0.0]] {
            for start in [0.1, 0.06] {
                let run = run_blocks(
                    "50 ms",
                    solver,
                    &format!(
                        r#""m": Mass(m: 2, v0: 2), "a": TranslationalRigidStop(upper: 0.1, restitution: {:?}, x0: {start:?}),
                           "b": TranslationalRigidStop(upper: 0.1, restitution: {:?}, x0: {start:?}), "g": TranslationalReference,
                           "sensor": TranslationalMotionSensor, "scope": Scope(inputs: ["v"])"#,
                        ends[0], ends[1]
                    ),
                    r#""m.r <-> a.r <-> b.r <-> sensor.r", "a.c <-> b.c <-> sensor.c <-> g.r", "sensor.v -> scope.v""#,
                );
                close(run.last("scope.v"), -1.0, 1e-9, &format!("{solver}, {ends:?} from {start}"));
            }
        }
        let run = run_blocks(
            "50 ms",
            solver,
            r#""m0": Mass(m: 2, v0: 2), "m1": Mass(m: 3), "wall": TranslationalRigidStop(upper: 0.1, restitution: 0, x0: 0.1),
               "between": TranslationalRigidStop(upper: 0.3, restitution: 0.5, x0: 0.3), "wall1": TranslationalRigidStop(upper: 0.1, restitution: 0, x0: 0.1),
               "g": TranslationalReference, "s0": TranslationalMotionSensor, "s1": TranslationalMotionSensor, "scope": Scope(inputs: ["v0", "v1"])"#,
            r#""m0.r <-> wall.r <-> between.r <-> s0.r", "m1.r <-> between.c <-> wall1.r <-> s1.r",
               "wall.c <-> wall1.c <-> s0.c <-> s1.c <-> g.r", "s0.v -> scope.v0", "s1.v -> scope.v1""#,
        );
        close(run.last("scope.v0"), -1.0, 1e-9, &format!("{solver}, the first mass"));
        close(run.last("scope.v1"), 0.0, 1e-9, &format!("{solver}, the second mass"));
    }
}

/// A freewheel that a prescribed speed turns against a stop has no motion: it ends the run. Away from the stop it takes the wheel along, however the
/// parts are ordered.
#[test]
fn a_prescribed_speed_takes_along_what_can_go_and_is_refused_against_a_stop() {
    let turned = |from: f64, to: f64, names: [&str; 2], end: &str| {
        let [hub, stop] = names;
        let blocks = format!(
            r#""wheel": Inertia(j: 1), "{stop}": RotationalRigidStop(upper: 0, lower: -1, phi0: {end}), "{hub}": OneWayClutch, "source": IdealSpeedSource,
               "w": SignalBuilder(points: [(0, {from:?}), (1, {to:?})]), "dw": Constant(value: "{:?} rad/s^2"), "frame": RotationalReference,
               "sensor": MotionSensor, "scope": Scope(inputs: ["w", "phi"])"#,
            to - from
        );
        let connections = format!(
            r#""wheel.r <-> {stop}.r <-> {hub}.c <-> sensor.r", "source.r <-> {hub}.r", "w.y -> source.w", "dw.y -> source.dw",
               "source.c <-> {stop}.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w", "sensor.phi -> scope.phi""#
        );
        let text = format!(
            r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ {blocks} }}, connections: [{connections}])"#
        );
        let (compiled, problems) = compile_text(&text);
        run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")))
    };
    for names in [["a", "b"], ["b", "a"]] {
        let against = turned(-0.5, 0.5, names, "0");
        let error = format!("{:?}", against.error.expect("no motion fits"));
        assert!(
            error.contains("no motion fits all of them") && error.contains("`a`") && error.contains("`b`"),
            "{error}"
        );
        let end = *against.time.last().expect("rows");
        assert!(end > 0.4 && end < 0.5 + 1e-9, "where the speed changes its sign, not {end}");
        // From the lower stop on: phi = t^2 / 2 - t / 2 from the instant at which the source turns forward.
        let along = turned(-0.5, 0.5, names, "-1");
        assert!(along.error.is_none(), "{:?}", along.error);
        close(along.last("scope.w"), 0.5, 1e-9, "speed");
        close(along.last("scope.phi"), 0.125, 1e-7, "angle");
    }
}
