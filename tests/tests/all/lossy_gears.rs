//! Gears with losses that stick: closed forms of rolling, stopping, locking.

use blocksim_tests::{Run, compile_text, run, run_blocks};

/// Runs a train: torque of the motor, rotor, gear, load inertia, torque on the load.
fn train(stop: &str, solver: &str, gear: &str, rotor: &str, load: &str, push: &str, weight: &str) -> Run {
    let text = format!(
        r#"Diagram(simulation: (stop_time: "{stop}", solver: {solver}), blocks: {{
            "push_tau": {push}, "weight_tau": {weight}, "push": IdealTorqueSource, "weight": IdealTorqueSource,
            "rotor": {rotor}, "gear": {gear}, "load": {load}, "front": MotionSensor, "back": MotionSensor,
            "frame": RotationalReference, "scope": Scope(inputs: ["w", "phi", "back", "tau", "a"]) }},
           connections: [ "push_tau.y -> push.tau", "weight_tau.y -> weight.tau",
            "push.r <-> rotor.r <-> gear.base <-> front.r", "gear.follower <-> load.r <-> weight.r <-> back.r",
            "push.c <-> weight.c <-> front.c <-> back.c <-> frame.r",
            "front.w -> scope.w", "front.phi -> scope.phi", "back.w -> scope.back", "gear.tau -> scope.tau",
            "front.a -> scope.a" ])"#
    );
    let (compiled, problems) = compile_text(&text);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} != {expected} (tolerance {tolerance})");
}

const SOLVERS: [&str; 3] =
    ["Ode45(rtol: 1e-9, atol: 1e-12)", "RosW3(rtol: 1e-9, atol: 1e-12)", "Rodas4(rtol: 1e-8)"];
const NOTHING: &str = r#"Constant(value: "0 N*m")"#;
const GEAR: &str = r#"LossyGear(ratio: 50.0, direction: Same, losses: [(0.0, 0.75, 0.6, 0.02, 0.02)])"#;

/// A train that slows down: the base drives while it coasts, the load drives while the motor brakes.
#[test]
fn a_coasting_gear_stops_when_its_closed_form_says() {
    let (rotor, load) = (2e-4, 0.5 / 2500.0);
    for (brake, driven) in [(0.0, false), (0.06, true)] {
        // T_B = -brake - J1 w', T = J2/i^2 w', T = min(0.75 T_B - 0.02, T_B / 0.6 - 0.02).
        let rates = [(0.75, 0.02), (1.0 / 0.6, 0.02)]
            .map(|(factor, tau): (f64, f64)| -(factor * brake + tau) / (load + factor * rotor));
        let lines = |rate: f64| {
            let base = -brake - rotor * rate;
            (0.75 * base - 0.02, base / 0.6 - 0.02)
        };
        let rate = rates[usize::from(driven)];
        assert_eq!(lines(rate).1 < lines(rate).0, driven, "the line that is lower counts");
        let stop = -100.0 / rate;
        for solver in SOLVERS {
            let push = format!("Step(time: \"{stop:?} s\", before: \"{:?} N*m\", after: \"0 N*m\")", -brake);
            let run =
                train("12 s", solver, GEAR, "Inertia(j: 2e-4, w0: 100.0)", "Inertia(j: 0.5)", &push, NOTHING);
            let stops: Vec<f64> = run.events.iter().filter(|e| e.1 == "gear").map(|e| e.0).collect();
            assert!(stops.len() <= 1, "{solver}: {:?}", run.events);
            stops.iter().for_each(|found| close(*found, stop, 1e-8));
            close(run.last("scope.phi"), 0.5 * 100.0 * stop, 1e-6);
            assert_eq!((run.last("scope.w"), run.last("scope.back")), (0.0, 0.0), "{solver}");
        }
    }
}

#[test]
fn a_stuck_gear_breaks_away_where_the_motor_overcomes_the_load_and_the_losses() {
    // A load of 20 N*m, 0.4 N*m at the base; the motor ramps up and down.
    let run = train(
        "10 s",
        SOLVERS[0],
        GEAR,
        "Inertia(j: 2e-4)",
        "Inertia(j: 0.5)",
        r#"Ramp(initial: "0.3 N*m", slope: "0.1 N*m/s")"#,
        r#"Constant(value: "-20 N*m")"#,
    );
    // Stuck from the start; up it goes when the motor bears (load + bearing) / eta.
    let first = run.events.iter().find(|e| e.1 == "gear").expect("it breaks away").0;
    close(first, ((0.4 + 0.02) / 0.75 - 0.3) / 0.1, 1e-9);
    assert!(run.time.iter().zip(run.column("scope.w")).all(|(t, w)| *t > first || *w == 0.0));
    assert!(run.last("scope.w") > 0.0);

    // Down it goes when the motor bears less than eta (load - bearing).
    let run = train(
        "10 s",
        SOLVERS[0],
        GEAR,
        "Inertia(j: 2e-4)",
        "Inertia(j: 0.5)",
        r#"Ramp(initial: "0.3 N*m", slope: "-0.1 N*m/s")"#,
        r#"Constant(value: "-20 N*m")"#,
    );
    let first = run.events.iter().find(|e| e.1 == "gear").expect("it breaks away").0;
    close(first, (0.3 - 0.6 * (0.4 - 0.02)) / 0.1, 1e-9);
    assert!(run.last("scope.w") < 0.0);
}

/// While all gears roll far above the threshold of the smooth law, both laws are one.
#[test]
fn a_gear_with_stiction_rolls_like_a_smooth_one_with_the_same_efficiencies() {
    let gear = |loss: &str| {
        format!(
            "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.8, \
             efficiency_backward: 0.65, threshold: \"0.01 rad/s\", loss: {loss})"
        )
    };
    let roll = |gear: &str| {
        train(
            "2 s",
            "Ode45(rtol: 1e-10, atol: 1e-12)",
            gear,
            "Inertia(j: 2e-4, w0: 300.0)",
            "Inertia(j: 0.5)",
            r#"Sine(amplitude: "0.4 N*m", frequency: "2 Hz")"#,
            r#"Constant(value: "3 N*m")"#,
        )
    };
    let (smooth, stiff) = (roll(&gear("Dissipative")), roll(&gear("Stiction")));
    let lossy = roll("LossyGear(ratio: 50.0, direction: Same, losses: [(0.0, 0.8, 0.65, 0.0, 0.0)])");
    assert!(smooth.column("scope.w").iter().all(|w| *w > 5.0), "it must roll");
    for column in ["scope.phi", "scope.w"] {
        // Of values up to a thousand; where the direction of power changes, the smooth law has a kink inside of a step.
        close(stiff.last(column), smooth.last(column), 1e-4);
        close(lossy.last(column), stiff.last(column), 1e-9);
    }
}

const WORM: &str = r#"WormGear(ratio: 40.0, lead_angle: "4 deg", friction: 0.1)"#;

/// Efficiencies of [`WORM`].
fn worm() -> [f64; 2] {
    let (cos, tan, mu) = (20f64.to_radians().cos(), 4f64.to_radians().tan(), 0.1);
    [(cos - mu * tan) / (cos + mu / tan), (cos - mu / tan) / (cos + mu * tan)]
}

#[test]
fn a_worm_holds_a_load_by_itself_and_must_be_driven_to_lower_it() {
    let [forward, backward] = worm();
    assert!(backward < 0.0);
    let push = |torque: f64| format!(r#"Step(time: "2 s", after: "{torque:?} N*m")"#);
    let go = |solver: &str, torque: f64| {
        train(
            "3 s",
            solver,
            WORM,
            "Inertia(j: 1e-3)",
            "Inertia(j: 0.1)",
            &push(torque),
            r#"Constant(value: "-60 N*m")"#,
        )
    };
    for solver in SOLVERS {
        // 1.5 N*m at the worm: with no torque of the motor, with a bit more than it needs to lift, and to lower.
        let held = go(solver, 0.0);
        assert!(held.column("scope.phi").iter().all(|phi| *phi == 0.0), "{solver}: it creeps");
        let (j1, j2) = (1e-3, 0.1 / 1600.0);
        let lifted = go(solver, 1.5 / forward + 0.1);
        // J1 w' = tau - T / eta with T = 1.5 + J2 w'.
        close(lifted.last("scope.w"), 0.1 / (j1 + j2 / forward), 1e-6);
        let lowered = go(solver, 1.5 * backward - 0.1);
        // J1 w' = tau - eta T, the load drives.
        close(lowered.last("scope.w"), -0.1 / (j1 + backward * j2), 1e-6);
        let stays = go(solver, 1.5 * backward + 0.1);
        assert_eq!(stays.last("scope.phi"), 0.0, "{solver}");
    }
}

#[test]
fn a_self_locking_worm_that_is_overrun_by_a_flywheel_stops_and_stays() {
    for solver in SOLVERS {
        let run = train(
            "1 s",
            solver,
            WORM,
            "Inertia(j: 1e-4, w0: 100.0)",
            "Inertia(j: 50.0)",
            NOTHING,
            r#"Constant(value: "1 N*m")"#,
        );
        assert_eq!(run.last("scope.w"), 0.0, "{solver}");
        assert!(run.counts.events < 10, "{solver}: {:?}", run.events);
        // With a load that brakes itself it runs down: J1 w' = -T / eta, T = 1 / 40 + J2 w' / 40^2.
        let run = train(
            "1 s",
            solver,
            WORM,
            "Inertia(j: 1e-4, w0: 100.0)",
            "Inertia(j: 50.0)",
            NOTHING,
            r#"Ramp(initial: "-1 N*m", slope: "2 N*m/s")"#,
        );
        let (j2, forward) = (50.0 / 1600.0, worm()[0]);
        let jam = run.events.iter().find(|e| e.1 == "gear").expect("it jams").0;
        close(jam, 0.5, 1e-9);
        let before = run.time.partition_point(|t| *t < 0.4);
        let t = run.time[before];
        close(run.column("scope.w")[before], 100.0 - (t - t * t) / 40.0 / (j2 + 1e-4 * forward), 1e-5);
        assert_eq!(run.last("scope.w"), 0.0, "{solver}");
    }
}

/// Work of both torques is never less than what is stored: the motor swings through standstill under load.
#[test]
fn a_gear_with_stiction_never_delivers_energy() {
    let run = train(
        "5 s",
        "Ode45(rtol: 1e-9, atol: 1e-12)",
        GEAR,
        "Inertia(j: 2e-4)",
        "Inertia(j: 0.5)",
        r#"Sine(amplitude: "0.5 N*m", frequency: "0.9 Hz")"#,
        r#"Constant(value: "2 N*m")"#,
    );
    assert!(run.counts.events >= 8 && run.counts.events < 60, "{:?}", run.events);
    let (tau, w, back, a) =
        (run.column("scope.tau"), run.column("scope.w"), run.column("scope.back"), run.column("scope.a"));
    let mut moved = [0, 0];
    for i in 0..w.len() {
        // Into the mesh at the base, minus what the follower gives to the load.
        let follower = 0.5 * a[i] / 50.0 - 2.0;
        let lost = tau[i] * w[i] - follower * back[i];
        assert!(lost > -1e-9, "t = {}: the mesh delivers {} W", run.time[i], -lost);
        moved[usize::from(w[i] > 0.0)] += usize::from(w[i] != 0.0);
    }
    assert!(moved.iter().all(|count| *count > 20), "{moved:?}");
}

/// A locked clutch between the motor and a sliding lossy gear: its torque depends on the loss.
#[test]
fn a_locked_clutch_before_a_lossy_gear_transmits_what_the_gear_takes() {
    let text = |gear: &str| {
        format!(
            r#"Diagram(simulation: (stop_time: "0.5 s", solver: Ode45(rtol: 1e-10, atol: 1e-12)), blocks: {{
                "on": Constant(value: 1.0), "tau": Constant(value: "0.5 N*m"), "push": IdealTorqueSource, "motor": Inertia(j: 1e-4, w0: 10.0),
                "clutch": Clutch(torque: 5.0), "shaft": Inertia(j: 1e-4, w0: 10.0), "gear": {gear},
                "load": Inertia(j: 0.5), "front": MotionSensor, "frame": RotationalReference,
                "scope": Scope(inputs: ["w", "tau"]) }},
               connections: [ "tau.y -> push.tau", "on.y -> clutch.normal", "push.r <-> motor.r <-> clutch.r",
                "clutch.c <-> shaft.r <-> gear.base <-> front.r", "gear.follower <-> load.r",
                "push.c <-> front.c <-> frame.r", "front.w -> scope.w", "clutch.tau -> scope.tau" ])"#
        )
    };
    for gear in [
        "CycloidalDrive(disc_teeth: 50, ring_teeth: 51, efficiency_forward: 0.8, efficiency_backward: 0.65, threshold: \"0.01 rad/s\")",
        "LossyGear(ratio: 50.0, losses: [(0.0, 0.8, 0.65, 0.0, 0.0)])",
    ] {
        let (compiled, problems) = compile_text(&text(gear));
        let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
        assert!(run.error.is_none(), "{:?}", run.error);
        let a = 0.5 / (2e-4 + 0.5 / 2500.0 / 0.8);
        close(run.last("scope.w"), 10.0 + 0.5 * a, 1e-6);
        close(run.last("scope.tau"), 0.5 - 1e-4 * a, 1e-9);
    }
}

/// Two gears of different ratio between the same shafts: nothing can ever move, and no friction decides that.
#[test]
fn gears_that_lock_each_other_stand() {
    for loss in ["", ", efficiency: 0.9", ", efficiency: 0.9, loss: Stiction"] {
        let text = format!(
            r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{
                "a": SimpleGear(ratio: 2, direction: Same{loss}), "b": SimpleGear(ratio: 3, direction: Same{loss}),
                "x": Inertia(j: 1), "y": Inertia(j: 1), "t": ConstantTorque(tau: 1), "h": RotationalReference,
                "on_x": MotionSensor, "on_y": MotionSensor, "scope": Scope(inputs: ["x", "y"]) }},
               connections: [ "a.base <-> b.base <-> x.r <-> t.r <-> on_x.r", "a.follower <-> b.follower <-> y.r <-> on_y.r",
                "t.c <-> h.r <-> on_x.c <-> on_y.c", "on_x.w -> scope.x", "on_y.w -> scope.y" ])"#
        );
        let (compiled, problems) = compile_text(&text);
        let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
        assert!(run.error.is_none(), "{loss}: {:?}", run.error);
        assert_eq!((run.last("scope.x"), run.last("scope.y")), (0.0, 0.0), "{loss}");
    }
}

/// A load that holds more at rest than while it slides breaks loose where the gear gives it that much: T = eta T_B, or T = T_B / eta where the
/// friction is at the base and the load drives. As long as the mesh stands it bears the rest.
#[test]
fn a_load_behind_a_lossy_gear_breaks_loose_where_the_gear_gives_what_it_holds() {
    let held = 1.6;
    let bearing =
        format!("RotationalFriction(breakaway: {held}, breakaway_velocity: 0, coulomb: 1, model: Stiction)");
    for brake in [&*bearing, "Brake(torque: 1, peak: 1.6)"] {
        let engaged = if brake.starts_with("Brake") { r#""one.y -> f.engaged","# } else { "" };
        for (efficiency, ratio) in [(0.8, 1.0), (0.5, 1.0), (0.8, 4.0)] {
            // Driven from the base with the friction at the follower, and the other way round.
            for is_forward in [true, false] {
                let (driven, loaded) = if is_forward { ("base", "follower") } else { ("follower", "base") };
                let expected = match is_forward {
                    true => held / (efficiency * ratio),
                    false => held * ratio / efficiency,
                };
                let text = format!(
                    r#"Diagram(simulation: (stop_time: "{:?} s", solver: Ode45(rtol: 1e-8)), blocks: {{
                        "g": SimpleGear(ratio: {ratio:?}, direction: Same, efficiency: {efficiency}, loss: Stiction), "f": {brake},
                        "x": Inertia(j: 0.1), "y": Inertia(j: 0.1), "r": Ramp(slope: "1 N*m/s"), "t": IdealTorqueSource,
                        "h": RotationalReference, "one": Constant(value: 1), "end": Terminator }},
                       connections: [ "r.y -> t.tau", {engaged} "one.y -> end.u", "t.r <-> x.r <-> g.{driven}",
                        "g.{loaded} <-> f.r <-> y.r", "t.c <-> h.r <-> f.c" ])"#,
                    expected + 0.1
                );
                let (compiled, problems) = compile_text(&text);
                let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
                assert!(run.error.is_none(), "{:?}", run.error);
                let slips = run.events.iter().find(|event| event.1 == "g").expect("the gear turns").0;
                close(slips, expected, 1e-8 * expected);
            }
        }
    }
}

/// What passes through the mesh fades with the speed, and what its bearings take stays: the equation of the mesh is as large as that.
#[test]
fn a_train_that_coasts_against_a_damper_comes_to_rest() {
    let (drag, bearing, ratio) = (0.02, 0.1, 3.0);
    let (rotor, load, speed) = (0.01, 0.05, 2.0);
    // J dw/dt = -drag w - bearing at the base.
    let inertia = rotor + load / (ratio * ratio);
    let stop = inertia / drag * f64::ln(1.0 + drag * ratio * speed / bearing);
    let turned = (inertia * speed * ratio - bearing * stop) / drag / ratio;
    for solver in ["Auto", "Ode45(rtol: 1e-9)", "Radau5(rtol: 1e-8)", "Ode15s", "RosW3"] {
        let run = run_blocks(
            "2 s",
            solver,
            &format!(
                r#""motor": Inertia(j: {rotor}), "drag": RotationalDamper(d: {drag}), "h": RotationalReference,
                   "gear": LossyGear(ratio: {ratio:?}, direction: Same, losses: [(0.0, 1.0, 1.0, {bearing}, {bearing})]),
                   "load": Inertia(j: {load}, w0: {speed:?}), "s": MotionSensor, "scope": Scope(inputs: ["w", "phi"])"#
            ),
            r#""motor.r <-> gear.base <-> drag.r", "gear.follower <-> load.r <-> s.r", "drag.c <-> s.c <-> h.r", "s.w -> scope.w",
               "s.phi -> scope.phi""#,
        );
        assert!(run.error.is_none(), "{solver}: {:?}", run.error);
        let stops: Vec<f64> = run.events.iter().filter(|e| e.1 == "gear").map(|e| e.0).collect();
        assert_eq!(stops.len(), 1, "{solver}: {:?}", run.events);
        close(stops[0], stop, 1e-5);
        close(run.last("scope.phi"), turned, 1e-5);
        assert_eq!(run.last("scope.w"), 0.0, "{solver}");
    }
}
