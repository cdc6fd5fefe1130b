//! What turns steadily, without any error that a step could be too long for: each turn is seen, whatever the method.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{Run, run_text};

const SOLVERS: [&str; 7] = ["Auto", "Ode45", "Ode23", "Rodas4", "RosW3", "Radau5", "Ode15s"];

/// Runs blocks whose comparison `above` is recorded with its integral over time.
fn simulate(stop: &str, solver: &str, blocks: &str, connections: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "{stop}", solver: {solver}),
            blocks: {{
                {blocks}
                "one": Constant(value: 1), "zero": Constant(value: 0), "number": Switch, "rate": Gain(k: "1 1/s"),
                "sum": Integrator, "show": Scope(inputs: ["share"]),
            }},
            connections: [
                {connections}
                "one.y -> number.u1", "above.y -> number.control", "zero.y -> number.u3", "number.y -> rate.u",
                "rate.y -> sum.u", "sum.y -> show.share",
            ],
        )"#
    ))
}

#[track_caller]
fn assert_share(run: &Run, solver: &str, expected: f64, crossings: u64) {
    let found = run.last("show.share");
    assert!((found - expected).abs() < 1e-4, "{solver}: {found} s instead of {expected}");
    assert_eq!(run.counts.events, crossings, "{solver}");
}

/// 8120 crossings of cos = 0.9 in 2000 s, in steps that could have been of 40 s.
#[test]
fn each_period_of_a_phase_reference_is_seen() {
    for solver in SOLVERS {
        let run = simulate(
            "500 s",
            solver,
            r#""f": Constant(value: "2.03 Hz"), "v": Constant(value: "10 V"), "phase": PhaseReference,
               "phases": Demux(sizes: [1, 1, 1]), "above": Compare(operator: Greater, constant: "9 V"),"#,
            r#""f.y -> phase.f", "v.y -> phase.v", "phase.abc -> phases.u", "phases.y1 -> above.u","#,
        );
        assert_share(&run, solver, 500.0 * f64::acos(0.9) / PI, 2030);
    }
}

/// The same for the sine of an angle that is an integral, and of one that is time itself, with states and without.
#[test]
fn each_period_of_the_sine_of_an_angle_is_seen() {
    for solver in SOLVERS {
        let run = simulate(
            "500 s",
            solver,
            r#""speed": Constant(value: "10 rad/s"), "angle": Integrator, "sin": Function(function: Sin),
               "above": Compare(operator: Greater, constant: 0.5),"#,
            r#""speed.y -> angle.u", "angle.y -> sin.u", "sin.y -> above.u","#,
        );
        let turns = 500.0 * 10.0 / TAU;
        // 795 whole turns and 0.77 of one, in which the sine is above from 1/12 to 5/12 of the turn.
        assert_share(&run, solver, (turns.floor() + 1.0) / 3.0 * TAU / 10.0, 2 * 796);
    }
    let run = run_text(
        r#"Diagram(
            simulation: (stop_time: "500 s"),
            blocks: {
                "time": Clock, "speed": Gain(k: "10 rad/s"), "sin": Function(function: Sin),
                "above": Compare(operator: Greater, constant: 0.5), "show": Scope,
            },
            connections: ["time.y -> speed.u", "speed.y -> sin.u", "sin.y -> above.u", "above.y -> show.u"],
        )"#,
    );
    assert_eq!(run.counts.events, 2 * 796);
}

/// An arm that turns freely: its tip is beyond a line for a known share of each turn.
#[test]
fn each_turn_of_a_body_is_seen() {
    for solver in SOLVERS {
        let run = simulate(
            "200 s",
            solver,
            r#""world": World(gravity: [0, 0, 0]), "hinge": RevoluteJoint(axis: [0, 0, 1], velocity: "2 rad/s"),
               "arm": Transform(translation: [0.5, 0, 0]), "body": Body(mass: 1, moi: [1, 1, 1]), "look": TransformSensor,
               "place": Demux(sizes: [1, 1, 1]), "above": Compare(operator: Greater, constant: "0.3 m"),"#,
            r#""world.frame <-> hinge.base <-> look.base", "hinge.follower <-> body.frame <-> arm.base",
               "arm.follower <-> look.follower", "look.x -> place.u", "place.y1 -> above.u","#,
        );
        // Each turn begins and ends in the middle of it; 63 whole turns, and beyond them 4.16 rad.
        let half = f64::acos(0.6);
        let rest = 200.0 * 2.0 - 63.0 * TAU;
        assert!(rest > half && rest < TAU - half);
        assert_share(&run, solver, (63.0 * 2.0 * half + half) / 2.0, 2 * 63 + 1);
    }
}

/// An arm meets a wall in its first turn, though ten thousand of them fit into the run: it comes back, and back again from
/// the other side.
#[test]
fn an_arm_does_not_turn_through_a_wall() {
    for solver in SOLVERS {
        let run = run_text(&format!(
            r#"Diagram(
                simulation: (stop_time: "3 s", solver: {solver}),
                blocks: {{
                    "world": World(gravity: [0, 0, 0]), "hinge": RevoluteJoint(axis: [0, 0, 1], velocity: "300 rad/s"),
                    "arm": Transform(translation: [0, 0.5, 0]), "body": Body(mass: 1, moi: [0.1, 0.1, 0.1]),
                    "wall": Transform(translation: [0.45, 0, 0], rpy: [0, "-90 deg", 0]),
                    "touch": PointPlaneContact(stiffness: 1e8, damping: 0, transition: 0), "show": Scope(inputs: ["q"]),
                }},
                connections: [
                    "world.frame <-> hinge.base <-> wall.base", "hinge.follower <-> body.frame <-> arm.base",
                    "arm.follower <-> touch.follower", "wall.follower <-> touch.base", "hinge.q -> show.q",
                ],
            )"#
        ));
        // The tip is at x = -0.5 sin q: beyond 0.45 where sin q is below -0.9, which it meets from both sides.
        let wall = PI + f64::asin(0.9);
        let most = run.column("show.q").iter().fold(0.0_f64, |most, q| most.max(*q));
        let least = run.column("show.q").iter().fold(0.0_f64, |least, q| least.min(*q));
        assert!(most < wall + 0.1 && most > wall, "{solver}: turned to {most} beyond {wall}");
        assert!(least < PI - wall && least > PI - wall - 0.1, "{solver}: turned back to {least}");
    }
}
