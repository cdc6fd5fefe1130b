//! What passes an impulse on and what does not; slips that go through zero without sticking.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{Run, compile_text, run};

/// Runs a diagram of `blocks` and `connections`.
fn simulate(stop: &str, solver: &str, blocks: &str, connections: &str) -> Run {
    let text = format!(
        "Diagram(simulation: (stop_time: \"{stop}\", solver: {solver}), \
         blocks: {{ {blocks} }}, connections: [ {connections} ])"
    );
    let (compiled, problems) = compile_text(&text);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{solver}: {:?}", run.error);
    run
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found} != {expected} (tolerance {tolerance})");
}

const SOLVERS: [&str; 6] = ["Ode45", "Ode23", "RosW3", "Rodas4", "Ode4(step: 1e-3)", "Ode1(step: 1e-4)"];

/// A disc that turns hits one at rest through a freewheel: both go on with the momentum of the first, whatever the
/// bearing of the second could hold.
#[test]
fn a_freewheel_that_is_struck_moves_what_dry_friction_holds() {
    for solver in SOLVERS {
        for (torque, tolerance) in [(1e-6_f64, 1e-6), (3.0, 1e-6), (3000.0, 1e-6)] {
            let run = simulate(
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
        let run = simulate(
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
        ] {
            let run = simulate(
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
                       "bed": TranslationalReference, "account": EnergyAccount(at: Frame, tolerance: 1e-3),
                       "scope": Scope(inputs: ["phi", "w"])"#,
                    place(start)
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
