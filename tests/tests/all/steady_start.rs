//! Runs that begin in a steady state, against states that follow by hand, and that stay where they are.

use std::sync::Arc;

use blocksim_block::schedule::Steady;
use blocksim_sim::{Rest, SimError, Simulation};
use blocksim_tests::{Run, compile_text, run, run_text, schedule};

/// A diagram that runs for 10 s from a steady state; `start` says more of it.
fn diagram(start: &str, blocks: &str, connections: &str) -> String {
    format!(
        r#"Diagram(
            simulation: (stop_time: "10 s", output: Every("0.1 s"), start: Steady{start}),
            blocks: {{ {blocks} }},
            connections: [ {connections} ],
        )"#
    )
}

/// Runs it; every column stays where it begins, within `within` of its size or of 1.
fn stays(text: &str, within: f64) -> Run {
    let run = run_text(text);
    for (recorded, column) in run.recorded.iter().zip(&run.columns) {
        let first = column[0];
        let worst = column.iter().map(|value| (value - first).abs()).fold(0.0, f64::max);
        assert!(worst <= within * first.abs().max(1.0), "`{}` leaves {first} by {worst}", recorded.path);
    }
    run
}

fn begun(text: &str) -> Result<(Simulation, Rest), SimError> {
    let (compiled, problems) = compile_text(text);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let simulation = Simulation::new(Arc::new(schedule))?;
    let rest = simulation.rest().cloned().expect("a steady start");
    Ok((simulation, rest))
}

fn refused(text: &str) -> SimError {
    begun(text).expect_err("no steady state")
}

fn near(value: f64, expected: f64, within: f64) {
    assert!((value - expected).abs() <= within * expected.abs().max(1e-300), "{value} is not {expected}");
}

#[test]
fn a_capacitor_is_charged_to_its_source_whatever_the_sizes() {
    for (r, c, v) in [("1 kohm", "1 uF", 5.0), ("1 Gohm", "1 pF", 400.0), ("1 mohm", "2 F", 1e-6)] {
        let run = stays(
            &diagram(
                "",
                &format!(
                    r#""source": VoltageSource(v: "{v} V"), "r": Resistor(r: "{r}"), "c": Capacitor(c: "{c}"),
                       "sensor": VoltageSensor, "ground": ElectricalReference, "show": Scope"#
                ),
                r#""source.p <-> r.p", "r.n <-> c.p <-> sensor.p", "source.n <-> c.n <-> sensor.n <-> ground.p", "sensor.v -> show.u""#,
            ),
            1e-9,
        );
        near(run.column("show.u")[0], v, 1e-12);
    }
}

/// 24 V on a motor with friction of its bearing and a load: v = R i + k w, k i = d w + T.
const MOTOR: &str = r#""source": ControlledVoltageSource, "sensor": CurrentSensor,
    "motor": DcMotor(r: "1.5 ohm", l: "2.5 mH", k: "0.22 N*m/A", j: "5e-5 kg*m^2", damping: "1e-4 N*m*s/rad"),
    "load": IdealTorqueSource, "encoder": MotionSensor, "ground": ElectricalReference, "housing": RotationalReference,
    "speed": Scope(inputs: ["w"]), "current": Scope(inputs: ["i"])"#;
const MOTOR_LINES: &str = r#""volts.y -> source.v", "torque.y -> load.tau", "source.p <-> sensor.p", "sensor.n <-> motor.p",
    "motor.n <-> source.n <-> ground.p", "motor.r <-> encoder.r <-> load.r",
    "motor.c <-> encoder.c <-> load.c <-> housing.r", "sensor.i -> current.i", "encoder.w -> speed.w""#;
const R: f64 = 1.5;
const K: f64 = 0.22;
const D: f64 = 1e-4;

/// Voltage and current that turn the motor at `w` against `load`.
fn drive(w: f64, load: f64) -> (f64, f64) {
    let i = (D * w + load) / K;
    (R * i + K * w, i)
}

#[test]
fn a_dc_motor_turns_at_the_speed_at_which_torques_and_voltages_are_in_balance() {
    let blocks =
        format!(r#"{MOTOR}, "volts": Constant(value: "24 V"), "torque": Constant(value: "-0.3 N*m")"#);
    let text = diagram("", &blocks, MOTOR_LINES);
    let run = stays(&text, 1e-8);
    let w = (24.0 - R * 0.3 / K) / (K + R * D / K);
    near(run.column("speed.w")[0], w, 1e-11);
    near(run.column("current.i")[0], drive(w, 0.3).1, 1e-11);
    // The angle of the encoder goes on, as nothing depends on it.
    let (_, rest) = begun(&text).unwrap();
    assert!(rest.undetermined.is_empty(), "{rest:?}");
    let [(name, rate)] = rest.adrift.as_slice() else { panic!("{rest:?}") };
    assert_eq!(name, "encoder.phi");
    near(*rate, w, 1e-11);
}

#[test]
fn a_trim_finds_the_inputs_that_give_an_output() {
    let blocks = format!(r#"{MOTOR}, "volts": Constant(value: "1 V"), "torque": Constant(value: "0 N*m")"#);
    let start =
        r#"(hold: {"encoder.w": "1000 rpm", "current.i": "2 A"}, free: ["volts.value", "torque.value"])"#;
    let text = diagram(start, &blocks, MOTOR_LINES);
    let run = stays(&text, 1e-8);
    let w = 1000.0 * std::f64::consts::TAU / 60.0;
    near(run.column("speed.w")[0], w, 1e-12);
    let load = K * 2.0 - D * w;
    let (_, rest) = begun(&text).unwrap();
    near(rest.found[0], drive(w, load).0, 1e-11);
    near(rest.found[1], -load, 1e-10);
    // What is recorded of a constant is the value that was found.
    let shown = text.replace(r#""current": Scope(inputs: ["i"])"#, r#""current": Scope(inputs: ["i", "v"])"#);
    let shown = shown.replace(r#""volts.y -> source.v""#, r#""volts.y -> source.v, current.v""#);
    near(stays(&shown, 1e-8).column("current.v")[0], drive(w, load).0, 1e-11);
}

#[test]
fn a_trim_that_is_not_possible_says_what_is_missed() {
    let blocks = format!(r#"{MOTOR}, "volts": Constant(value: "1 V"), "torque": Constant(value: "0 N*m")"#);
    let start = r#"(hold: {"encoder.w": "1000 rpm", "current.i": "2 A"}, free: ["volts.value"])"#;
    let error = refused(&diagram(start, &blocks, MOTOR_LINES));
    assert_eq!((error.code, error.t), ("no_steady_state", 0.0));
    assert!(error.message.contains("instead of 2") || error.message.contains("`encoder.w`"), "{error}");
    assert!(error.help.unwrap().contains("compare `hold` and `free`"));
}

#[test]
fn a_controller_without_error_holds_what_its_plant_needs() {
    for (pid, within) in [
        (r#"Pid(kp: 2.0, ki: 5.0)"#, 1e-8),
        (
            r#"Pid(kp: 2.0, ki: 5.0, kd: 0.1, n: 100.0, lower: -10.0, upper: 10.0, anti_windup: Clamping)"#,
            1e-8,
        ),
        (r#"Pid(kp: 2.0, ki: 5.0, lower: -10.0, upper: 10.0, anti_windup: BackCalculation)"#, 1e-8),
        (r#"DiscretePid(ts: "10 ms", kp: 2.0, ki: 5.0)"#, 1e-8),
        (r#"DiscretePid(ts: "10 ms", kp: 2.0, ki: 5.0, kd: 0.1, n: 50.0, filter: Trapezoidal)"#, 1e-8),
    ] {
        let run = stays(
            &diagram(
                "",
                &format!(
                    r#""want": Constant(value: 3), "error": Sum(signs: "+-"), "pid": {pid}, "load": Constant(value: 0.5),
                       "push": Sum(signs: "+-"), "lag": LowPass(tau: "0.2 s"), "gain": Gain(k: 4), "show": Scope(inputs: ["u", "y"])"#
                ),
                r#""want.y -> error.u1", "gain.y -> error.u2, show.y", "error.y -> pid.e", "pid.u -> push.u1, show.u",
                   "load.y -> push.u2", "push.y -> lag.u", "lag.y -> gain.u""#,
            ),
            within,
        );
        // y = 4 (u - 0.5) = 3.
        near(run.column("show.u")[0], 1.25, 1e-10);
        near(run.column("show.y")[0], 3.0, 1e-10);
    }
}

#[test]
fn a_controller_that_begins_at_its_limit_comes_off_it() {
    let run = stays(
        &diagram(
            "",
            r#""want": Constant(value: 3), "error": Sum(signs: "+-"), "rate": Gain(k: "1 1/s"), "sum": Integrator(x0: 50), "limit": Saturation(lower: -5, upper: 5),
               "lag": LowPass(tau: "0.2 s"), "show": Scope(inputs: ["u", "y"])"#,
            r#""want.y -> error.u1", "lag.y -> error.u2, show.y", "error.y -> rate.u", "rate.y -> sum.u", "sum.y -> limit.u", "limit.y -> lag.u, show.u""#,
        ),
        1e-8,
    );
    near(run.column("show.y")[0], 3.0, 1e-9);
}

#[test]
fn delays_are_full_of_what_comes_in() {
    for delay in [
        r#"TransportDelay(delay: "0.5 s")"#,
        r#"Delay(ts: "20 ms", steps: 7)"#,
        r#"UnitDelay(ts: "20 ms")"#,
        r#"FirstOrderHold(ts: "20 ms")"#,
        r#"ZeroOrderHold(ts: "20 ms")"#,
        r#"RateLimiter(rising: 1, falling: -1)"#,
        r#"DiscreteTransferFunction(ts: "20 ms", num: [0.1], den: [1, -0.9])"#,
        r#"TransferFunction(num: [1e4], den: [1, 20, 1e4])"#,
    ] {
        let run = stays(
            &diagram(
                "",
                &format!(
                    r#""want": Constant(value: 3), "error": Sum(signs: "+-"), "pid": Pid(kp: 0.1, ki: 0.1), "late": {delay},
                       "lag": LowPass(tau: "0.2 s"), "gain": Gain(k: 4), "show": Scope(inputs: ["late", "y"])"#
                ),
                r#""want.y -> error.u1", "gain.y -> error.u2, show.y", "error.y -> pid.e", "pid.u -> late.u",
                   "late.y -> lag.u, show.late", "lag.y -> gain.u""#,
            ),
            1e-7,
        );
        near(run.column("show.late")[0], 0.75, 1e-9);
    }
}

#[test]
fn a_pendulum_that_is_pushed_leans_at_the_angle_of_its_torque() {
    let text = diagram(
        "",
        r#""world": World(gravity: ["0 m/s^2", "0 m/s^2", "-9.80665 m/s^2"]), "pivot": RevoluteJoint(axis: [0, 1, 0], damping: "0.1 N*m*s/rad"),
           "rod": Body(mass: "2 kg", com: ["0 m", "0 m", "-0.5 m"], moi: ["0.1 kg*m^2", "0.1 kg*m^2", "0 kg*m^2"]),
           "push": Constant(value: "4 N*m"), "show": Scope(inputs: ["q"])"#,
        r#""world.frame <-> pivot.base", "pivot.follower <-> rod.frame", "push.y -> pivot.torque", "pivot.q -> show.q""#,
    );
    let run = stays(&text, 1e-8);
    near(run.column("show.q")[0], (4.0_f64 / (2.0 * 9.80665 * 0.5)).asin(), 1e-11);
    // Held at an angle, the torque is what is sought.
    let held =
        text.replace("start: Steady", r#"start: Steady(hold: {"pivot.q": "60 deg"}, free: ["push.value"])"#);
    let (simulation, rest) = begun(&held).unwrap();
    near(rest.found[0], 2.0 * 9.80665 * 0.5 * 60.0_f64.to_radians().sin(), 1e-11);
    near(simulation.states()[0], 60.0_f64.to_radians(), 1e-12);
    // No angle holds more than the weight at the end of its lever.
    let error = refused(&text.replace("4 N*m", "11 N*m"));
    assert!(error.message.contains("`pivot.w` by "), "{error}");
}

/// A tank: A dh/dt = q - k sqrt(h).
fn tank(inflow: f64, level: f64, outflow: &str) -> String {
    diagram(
        "",
        &format!(
            r#""inflow": Constant(value: {inflow}), "root": {outflow}, "valve": Gain(k: 0.2), "net": Sum(signs: "+-"), "area": Gain(k: "2 1/s"),
               "level": Integrator(x0: {level}), "show": Scope(inputs: ["h"])"#
        ),
        r#""inflow.y -> net.u1", "level.y -> root.u, show.h", "root.y -> valve.u", "valve.y -> net.u2", "net.y -> area.u", "area.y -> level.u""#,
    )
}

#[test]
fn a_tank_fills_until_as_much_flows_out_as_in_even_from_empty_or_far_away() {
    let root = "Function(function: Sqrt)";
    for (inflow, level) in [(0.3, 1.0), (0.3, 0.0), (0.3, 1e4), (30.0, 1e-3), (1e-4, 5.0)] {
        let run = stays(&tank(inflow, level, root), 1e-7);
        near(run.column("show.h")[0], (inflow / 0.2_f64).powi(2), 1e-8);
    }
}

#[test]
fn a_tank_that_only_fills_has_no_steady_state_and_the_level_is_named() {
    let error = refused(&tank(0.3, 1.0, "Saturation(lower: 0, upper: 1)"));
    assert_eq!(error.code, "no_steady_state");
    assert_eq!(error.path.as_deref(), Some("level"));
    assert!(error.message.contains("what keeps moving: `level.x` by 0.2 a second"), "{error}");
    // What is at its limit may do so if that is said.
    let text = tank(0.3, 1.0, "Saturation(lower: 0, upper: 1)");
    let (_, rest) = begun(&text.replace("start: Steady", r#"start: Steady(drift: ["level"])"#)).unwrap();
    assert_eq!(rest.undetermined, [""; 0]);
}

#[test]
fn integrators_without_feedback_stay_as_written_and_are_named() {
    let text = diagram(
        "",
        r#""zero": Constant(value: 0), "free": Integrator(x0: 7), "lag": LowPass(tau: "1 s"), "show": Scope(inputs: ["free", "lag"])"#,
        r#""zero.y -> free.u", "free.y -> lag.u, show.free", "lag.y -> show.lag""#,
    );
    let (_, rest) = begun(&text).unwrap();
    assert!(rest.undetermined.contains(&"free.x".to_owned()), "{rest:?}");
    // What follows it goes all the way.
    let run = stays(&text, 1e-9);
    assert_eq!(run.column("show.free")[0], 7.0);
    near(run.column("show.lag")[0], 7.0, 1e-12);
    // One that nothing feeds and nothing reads stays exactly.
    let alone =
        text.replace(r#""free.y -> lag.u, show.free""#, r#""free.y -> show.free", "zero.y -> lag.u""#);
    let alone = alone
        .replace(r#""zero.y -> free.u", "#, r#""zero.y -> free.u, lag.u", "#)
        .replace(r#", "zero.y -> lag.u""#, "");
    assert_eq!(stays(&alone, 0.0).column("show.free")[0], 7.0);
    let (_, rest) = begun(&alone).unwrap();
    assert_eq!(rest.undetermined, ["free.x"]);
    // Fed by anything, it has no rest.
    let error = refused(&alone.replace("Constant(value: 0)", "Constant(value: 0.25)"));
    assert!(error.message.contains("what keeps moving: `free.x` by 0.25 a second"), "{error}");
}

/// A controller without integral gain around a lag: y = kp (1 - y) + x0, however it is limited.
#[test]
fn a_controller_without_integral_gain_keeps_its_integral_part() {
    for (pid, x0) in [
        (r#"Pid(kp: 3)"#, 0.0),
        (r#"Pid(kp: 3, x0: 0.4)"#, 0.4),
        (r#"Pid(kp: 3, kd: 0.1, lower: -0.1, upper: 10, anti_windup: Clamping)"#, 0.0),
        (r#"Pid(kp: 3, kd: 0.1, lower: -10, upper: 2, anti_windup: BackCalculation)"#, 0.0),
        (r#"DiscretePid(ts: "0.1 s", kp: 3)"#, 0.0),
        (r#"DiscretePid(ts: "0.1 s", kp: 3, kd: 0.01, n: 5, x0: -0.3)"#, -0.3),
    ] {
        let text = diagram(
            "",
            &format!(
                r#""set": Constant(value: 1), "e": Sum(signs: "+-"), "pid": {pid}, "plant": LowPass(tau: "0.2 s"), "show": Scope(inputs: ["y"])"#
            ),
            r#""set.y -> e.u1", "e.y -> pid.e", "pid.u -> plant.u", "plant.y -> e.u2, show.y""#,
        );
        let (_, rest) = begun(&text).unwrap_or_else(|error| panic!("{pid}: {error}"));
        assert!(!rest.undetermined.contains(&"plant.x".to_owned()), "{pid}: {rest:?}");
        near(stays_sampled(&text).column("show.y")[0], (3.0 + x0) / 4.0, 1e-9);
    }
}

/// A run over the first instants, as a sampled controller need not be stable.
fn stays_sampled(text: &str) -> Run {
    stays(&text.replace(r#"stop_time: "10 s""#, r#"stop_time: "1 s""#), 1e-6)
}

/// What moves elsewhere, if not where the search begins, is free to: y = x + 5, where the rate of x is a dead zone of 1 - y up to 2.
/// And what another equation asks for is not kept either: x' = v, v' = 0.
#[test]
fn what_moves_elsewhere_or_is_determined_by_others_is_not_kept() {
    let text = diagram(
        "",
        r#""one": Constant(value: 1), "e": Sum(signs: "+-"), "zone": DeadZone(start: -2, end: 2), "rate": Gain(k: "1 1/s"), "x": Integrator,
           "five": Constant(value: 5), "push": Sum(signs: "++"), "lag": LowPass(tau: "1 s"), "show": Scope(inputs: ["x", "y"])"#,
        r#""one.y -> e.u1", "lag.y -> e.u2, show.y", "e.y -> zone.u", "zone.y -> rate.u", "rate.y -> x.u", "x.y -> push.u1, show.x",
           "five.y -> push.u2", "push.y -> lag.u""#,
    );
    let run = stays(&text, 1e-8);
    let (x, y) = (run.column("show.x")[0], run.column("show.y")[0]);
    near(y, x + 5.0, 1e-9);
    assert!((1.0 - y).abs() <= 2.0 + 1e-8, "{y}");
    let text = diagram(
        "",
        r#""zero": Constant(value: "0 m/s^2"), "v": Integrator(x0: "3 m/s"), "x": Integrator(x0: "1 m"), "show": Scope(inputs: ["x", "v", "y"]),
           "lag": LowPass(tau: "1 s")"#,
        r#""zero.y -> v.u", "v.y -> x.u, show.v", "x.y -> lag.u, show.x", "lag.y -> show.y""#,
    );
    let run = stays(&text, 1e-9);
    assert!(run.column("show.v")[0].abs() < 1e-12);
    near(run.column("show.y")[0], run.column("show.x")[0], 1e-12);
}

/// A trim may ask for a value of what nothing else moves; where it may find a constant instead, that is found.
#[test]
fn a_trim_sets_what_nothing_else_moves_only_where_it_must() {
    let blocks = r#""zero": Constant(value: 0), "hand": Integrator(x0: 7), "u": Constant(value: 1), "sum": Sum(signs: "++"), "lag": LowPass(tau: "1 s"),
        "show": Scope(inputs: ["y", "hand"])"#;
    let lines = r#""zero.y -> hand.u", "hand.y -> sum.u1, show.hand", "u.y -> sum.u2", "sum.y -> lag.u", "lag.y -> show.y""#;
    for (free, hand) in [(r#"["u.value"]"#, 7.0), ("[]", 4.0)] {
        let run = stays(&diagram(&format!(r#"(hold: {{"lag.y": 5}}, free: {free})"#), blocks, lines), 1e-9);
        near(run.column("show.hand")[0], hand, 1e-12);
        near(run.column("show.y")[0], 5.0, 1e-12);
    }
}

fn brake(torque: f64, w0: f64) -> String {
    diagram(
        "",
        &format!(
            r#""torque": ConstantTorque(tau: "{torque} N*m"), "shaft": Inertia(j: "0.1 kg*m^2", w0: "{w0} rad/s"), "sensor": MotionSensor,
               "bearing": RotationalFriction(breakaway: "2 N*m", breakaway_velocity: "0.1 rad/s", coulomb: "1.5 N*m", viscous: "0.05 N*m*s/rad", model: Stiction),
               "housing": RotationalReference, "show": Scope(inputs: ["w"])"#
        ),
        r#""torque.r <-> shaft.r <-> bearing.r <-> sensor.r", "torque.c <-> bearing.c <-> sensor.c <-> housing.r", "sensor.w -> show.w""#,
    )
}

#[test]
fn friction_that_holds_is_a_steady_state_and_one_that_slips_has_its_speed() {
    // At rest, held by less than it takes to break loose: it stays, and keeps its mode.
    assert_eq!(stays(&brake(1.8, 0.0), 0.0).last("show.w"), 0.0);
    // Slipping towards rest with nothing that keeps it going: it stops and sticks.
    assert_eq!(stays(&brake(0.0, 20.0), 0.0).last("show.w"), 0.0);
    // More than it takes to break loose: coulomb and viscous friction balance the torque.
    let run = stays(&brake(4.0, 0.0), 1e-8);
    near(run.column("show.w")[0], (4.0 - 1.5) / 0.05, 1e-6);
    let run = stays(&brake(-4.0, 20.0), 1e-8);
    near(run.column("show.w")[0], -(4.0 - 1.5) / 0.05, 1e-6);
}

#[test]
fn a_diode_conducts_or_blocks_as_its_circuit_wants_at_rest() {
    for (v, expected) in [(10.0, 10.0), (-10.0, 0.0)] {
        let run = stays(
            &diagram(
                "",
                &format!(
                    r#""source": VoltageSource(v: "{v} V"), "d": Diode(v_f: "0 V", r_on: "1e-6 ohm", g_off: "1e-12 S"), "c": Capacitor(c: "1 mF"), "r": Resistor(r: "10 ohm"),
                       "sensor": VoltageSensor, "ground": ElectricalReference, "show": Scope"#
                ),
                r#""source.p <-> d.p", "d.n <-> c.p <-> r.p <-> sensor.p", "source.n <-> c.n <-> r.n <-> sensor.n <-> ground.p", "sensor.v -> show.u""#,
            ),
            1e-7,
        );
        let first = run.column("show.u")[0];
        assert!((first - expected).abs() < 1e-5, "{first} is not {expected}");
    }
}

#[test]
fn the_events_of_a_run_from_a_steady_state_are_not_missed() {
    // At 1 s the load doubles; until then nothing moves, then the speed falls to its new rest.
    let blocks = format!(
        r#"{MOTOR}, "volts": Constant(value: "24 V"), "torque": Step(time: "1 s", before: "-0.3 N*m", after: "-0.6 N*m")"#
    );
    let run = run_text(&diagram("", &blocks, MOTOR_LINES));
    let w = |load: f64| (24.0 - R * load / K) / (K + R * D / K);
    near(run.at("speed.w", 0.99), w(0.3), 1e-9);
    near(run.last("speed.w"), w(0.6), 1e-6);
}

#[test]
fn given_starts_are_as_they_were_and_shipped_models_have_steady_states() {
    let start = |path: &str| {
        let mut given = schedule(path, &[]);
        given.settings.start = blocksim_block::schedule::Start::Steady(Default::default());
        given.settings.stop_time = 0.01;
        Simulation::new(Arc::new(given)).map(|simulation| simulation.rest().cloned().unwrap())
    };
    // The demand is still zero: everything is where it is.
    let rest = start("diagrams/servo.ron").unwrap();
    assert!(rest.adrift.is_empty(), "{rest:?}");
    let hanging = start("diagrams/double_pendulum.ron");
    assert!(hanging.is_ok(), "{:?}", hanging.err());
    let given = run(schedule("diagrams/pid_anti_windup.ron", &[]));
    assert_eq!(given.error, None);
}

#[test]
fn names_that_are_wrong_are_told_where_they_stand() {
    let blocks = r#""volts": Constant(value: "1 V"), "lag": LowPass(tau: 1), "show": Scope"#;
    let lines = r#""volts.y -> lag.u", "lag.y -> show.u""#;
    for (start, expected) in [
        (r#"(hold: {"lag.x": "1 V"})"#, "did you mean `lag.y`?"),
        (r#"(hold: {"lag.y": "1 A"})"#, "`lag.y` is measured in V, but is to be held at a value in A"),
        (r#"(free: ["volt.value"])"#, "did you mean `volts.value`?"),
        (r#"(free: ["lag.tau"])"#, "the search changes values of `Constant` blocks, such as `volts.value`"),
        (r#"(drift: ["lagg"])"#, "did you mean `lag`?"),
    ] {
        let (compiled, problems) = compile_text(&diagram(start, blocks, lines));
        assert!(compiled.schedule.is_none() && problems.contains(expected), "{start}: {problems}");
        assert!(problems.contains("model.ron:2:"), "{problems}");
    }
}

#[test]
fn slopes_of_laws_leave_few_evaluations_to_the_search() {
    // Two tanks, one into the other: q = 0.2 sqrt(h1) = 0.3 sqrt(h2), with h1 = 4.
    let blocks = r#""inflow": Constant(value: 1.0), "first": Integrator(x0: 1.0), "second": Integrator(x0: 0.5),
        "out1": Expression(law: "0.2*sqrt(u1)"), "out2": Expression(law: "0.3*sqrt(u1)"), "net1": Sum(signs: "+-"),
        "net2": Sum(signs: "+-"), "show": Scope(inputs: ["h1", "h2"])"#;
    let lines = r#""inflow.y -> net1.u1", "out1.y -> net1.u2, net2.u1", "out2.y -> net2.u2", "net1.y -> first.u",
        "net2.y -> second.u", "first.y -> out1.u1, show.h1", "second.y -> out2.u1, show.h2""#;
    let start = r#"(hold: {"first.y": 4.0}, free: ["inflow.value"])"#;
    let (simulation, rest) = begun(&diagram(start, blocks, lines)).unwrap();
    near(rest.found[0], 0.4, 1e-12);
    near(simulation.states()[1], 4.0 * 4.0 / 9.0, 1e-11);
    // A single Jacobian by differences of the whole model takes 1 + 22 * 3.
    assert_eq!(rest.evaluations, 24);
}

/// What is one current, or one voltage, is so at rest as well, though nothing that moves depends on the second of two states: a choke before a motor
/// had 0.025 A where that had 6 A, for the whole run.
#[test]
fn windings_in_series_and_capacitances_in_parallel_have_one_value_at_rest() {
    let cases = [
        (
            r#""v": VoltageSource(v: "12 V"), "choke": Inductor(l: "5 mH"), "m": DcMotor(r: 1.0, l: 0.01, k: 0.1, j: 0.001),
               "f": RotationalReference, "d": RotationalDamper(d: 0.01), "g": ElectricalReference, "s": Scope(inputs: ["a", "b"])"#,
            r#""v.p <-> choke.p", "choke.n <-> m.p", "m.n <-> v.n <-> g.p", "m.r <-> d.r", "m.c <-> f.r <-> d.c", "choke.i -> s.a", "m.i -> s.b""#,
            // 12 = i + 0.1 w, 0.1 i = 0.01 w.
            6.0,
        ),
        (
            r#""v": VoltageSource(v: "12 V"), "r": Resistor(r: 10.0), "a": Capacitor(c: "1 mF"), "b": Capacitor(c: "2 mF"), "r2": Resistor(r: 30.0),
               "g": ElectricalReference, "s": Scope(inputs: ["a", "b"])"#,
            r#""v.p <-> r.p", "r.n <-> a.p <-> b.p <-> r2.p", "v.n <-> a.n <-> b.n <-> r2.n <-> g.p", "a.v -> s.a", "b.v -> s.b""#,
            9.0,
        ),
        (
            r#""v": VoltageSource(v: "12 V"), "r": Resistor(r: 3.0), "a": SaturatingInductor(l0: "0.5 H", l_s: "1 mH", i_s: "1 A"),
               "b": SaturatingInductor(l0: "5 H", l_s: "5 mH", i_s: "0.1 A"), "g": ElectricalReference, "s": Scope(inputs: ["a", "b"])"#,
            r#""v.p <-> r.p", "r.n <-> a.p", "a.n <-> b.p", "b.n <-> v.n <-> g.p", "a.i -> s.a", "b.i -> s.b""#,
            4.0,
        ),
    ];
    for (blocks, connections, right) in cases {
        let run = stays(&diagram("", blocks, connections), 1e-6);
        for name in ["s.a", "s.b"] {
            near(run.column(name)[0], right, 1e-6);
        }
    }
}

/// Windings in series to a capacitor, or to a motor that turns freely, have no current at rest, and what rounding leaves of it is not to be
/// compared with itself: 12 V over the capacitor, and a speed of 12 V / k.
#[test]
fn windings_in_series_without_a_current_are_at_rest() {
    let capacitor = r#""s": VoltageSource(v: "12 V"), "r": Resistor(r: "4 ohm"), "l1": Inductor(l: "10 mH"), "l2": Inductor(l: "5 mH"),
        "c": Capacitor(c: "1 mF"), "g": ElectricalReference, "show": Scope(inputs: ["a", "b", "end"])"#;
    let lines = r#""s.p <-> r.p", "r.n <-> l1.p", "l1.n <-> l2.p", "l2.n <-> c.p", "c.n <-> s.n <-> g.p", "l1.i -> show.a", "l2.i -> show.b", "c.v -> show.end""#;
    let motor = r#""s": VoltageSource(v: "12 V"), "r": Resistor(r: "4 ohm"), "l1": Inductor(l: "10 mH"),
        "m": DcMotor(r: "1 ohm", l: "1 mH", k: "0.1 N*m/A", j: "1e-4 kg*m^2", damping: "0 N*m*s/rad"), "h": RotationalReference, "w": MotionSensor, "f": RotationalReference,
        "g": ElectricalReference, "show": Scope(inputs: ["a", "b", "end"])"#;
    let turning = r#""s.p <-> r.p", "r.n <-> l1.p", "l1.n <-> m.p", "m.n <-> s.n <-> g.p", "m.c <-> h.r", "m.r <-> w.r", "w.c <-> f.r",
        "l1.i -> show.a", "m.i -> show.b", "w.w -> show.end""#;
    let begun_elsewhere =
        capacitor.replace(r#"l: "10 mH""#, r#"l: "10 mH", i0: "2 A""#).replace("12 V", "0 V");
    let strong = capacitor.replace("12 V", "12 kV").replace("4 ohm", "40 uohm");
    let cases = [
        (capacitor, lines, 12.0),
        (motor, turning, 120.0),
        (&*begun_elsewhere, lines, 0.0),
        (&*strong, lines, 12e3),
    ];
    for (blocks, connections, end) in cases {
        let (simulation, _) =
            begun(&diagram("", blocks, connections)).unwrap_or_else(|error| panic!("{blocks}: {error}"));
        drop(simulation);
        let run = run_text(
            &diagram("", blocks, connections).replace(r#"stop_time: "10 s""#, r#"stop_time: "0.1 s""#),
        );
        assert!((run.column("show.end")[0] - end).abs() <= 1e-9 * end.max(1.0), "{blocks}");
        for name in ["show.a", "show.b"] {
            assert!(run.column(name).iter().all(|i| i.abs() < 1e-9 * end.max(1.0)), "{blocks}");
        }
    }
}

/// Nothing changes the current of a winding that leads nowhere, and it has none: not half of what would keep its neighbours in balance.
#[test]
fn windings_that_lead_nowhere_have_no_current_at_rest() {
    let breaker = (
        r#""s": VoltageSource(v: "12 V"), "r": Resistor(r: "4 ohm"), "l": Inductor(l: "10 mH"), "c": Capacitor(c: "1 mF"), "cable": Inductor(l: "5 mH"),
           "breaker": IdealSwitch, "off": Constant(value: false), "load": Resistor(r: "3 ohm"), "g": ElectricalReference, "show": Scope(inputs: ["a", "b", "v"])"#,
        r#""s.p <-> r.p", "r.n <-> l.p", "l.n <-> c.p <-> cable.p", "c.n <-> s.n <-> g.p <-> load.n", "cable.n <-> breaker.p",
           "breaker.n <-> load.p", "off.y -> breaker.gate", "l.i -> show.a", "cable.i -> show.b", "c.v -> show.v""#,
    );
    let open = (
        r#""s": VoltageSource(v: "12 V"), "r": Resistor(r: "4 ohm"), "c": Capacitor(c: "1 mF"), "l1": Inductor(l: "10 mH"), "l2": Inductor(l: "10 mH"),
           "vs": VoltageSensor, "g": ElectricalReference, "show": Scope(inputs: ["a", "b", "v"])"#,
        r#""g.p <-> r.p <-> c.n <-> vs.n", "r.n <-> l1.p", "l1.n <-> s.n <-> l2.p", "s.p <-> c.p", "l2.n <-> vs.p", "l1.i -> show.a", "l2.i -> show.b",
           "c.v -> show.v""#,
    );
    for (blocks, connections) in [breaker, open] {
        let run = stays(&diagram("", blocks, connections), 1e-9);
        near(run.column("show.v")[0], 12.0, 1e-9);
        assert!(run.column("show.a")[0].abs() < 1e-12);
        assert_eq!(run.column("show.b")[0], 0.0);
    }
}

/// An account of energy begins where the run does, and not where the search for its start began.
#[test]
fn an_account_of_energy_opens_at_the_steady_state() {
    let run = stays(
        &diagram(
            "",
            r#""v": VoltageSource(v: "12 V"), "r": Resistor(r: 4.0), "l": Inductor(l: "50 mH"), "g": ElectricalReference,
               "e": EnergyAccount(at: Electrical), "s": Scope(inputs: ["stored", "error"])"#,
            r#""v.p <-> r.p", "r.n <-> l.p", "l.n <-> v.n <-> g.p <-> e.node", "e.stored -> s.stored", "e.error -> s.error""#,
        ),
        1e-9,
    );
    near(run.column("s.stored")[0], 0.5 * 0.05 * 9.0, 1e-9);
    assert!(run.column("s.error").iter().all(|error| error.abs() < 1e-9));
}

/// Where there is no state, nothing moves: the start is steady as it is.
#[test]
fn a_model_without_states_is_at_rest() {
    for (blocks, wires, end) in [
        (r#""c": Constant(value: 2), "k": Gain(k: 3)"#, r#""c.y -> k.u", "k.y -> s.u""#, 6.0),
        (
            r#""c": Constant(value: "1 V"), "v": ControlledVoltageSource, "r": Resistor(r: 10), "g": ElectricalReference,
               "k": Gain(k: "1 1/A")"#,
            r#""c.y -> v.v", "v.p <-> r.p", "v.n <-> r.n <-> g.p", "r.i -> k.u", "k.y -> s.u""#,
            0.1,
        ),
    ] {
        let text = format!(
            r#"Diagram(simulation: (stop_time: 1, start: Steady), blocks: {{ {blocks}, "s": Scope }}, connections: [{wires}])"#
        );
        let run = blocksim_tests::run_text(&text);
        assert!(run.error.is_none(), "{:?}", run.error);
        assert!((run.last("s.u") - end).abs() < 1e-12, "{}", run.last("s.u"));
    }
}

/// A voltage over windings alone: the current grows for ever, and at 1e8 A it is no more at rest than at 1 A.
#[test]
fn windings_without_a_resistance_have_no_steady_state() {
    for first in ["Inductor(l: 0.00691)", "SaturatingInductor(l0: 0.00691, l_s: 0.001382, i_s: 0.0295)"] {
        for names in [["a", "b"], ["b", "a"]] {
            let [one, two] = names;
            let text = format!(
                r#"Diagram(simulation: (stop_time: 1, start: Steady), blocks: {{
                    "{one}": {first}, "{two}": Inductor(l: 0.00515), "src": VoltageSource(v: "7.9 V"), "g": ElectricalReference,
                }}, connections: ["{two}.p <-> src.n <-> g.p", "{one}.n <-> src.p", "{one}.p <-> {two}.n"], record: ["**"])"#
            );
            let (compiled, problems) = blocksim_tests::compile_text(&text);
            let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
            let error =
                blocksim_sim::Simulation::new(std::sync::Arc::new(schedule)).expect_err("nothing rests");
            assert_eq!(error.code, "no_steady_state", "{first}, {names:?}: {}", error.message);
        }
    }
}

/// Places that are measured, on which nothing depends, are those to which a run from the same start comes: a drive with an encoder on
/// either side of its shaft, of which the controller reads one, and a mass on a spring beside a sensor.
#[test]
fn a_place_that_is_measured_goes_with_what_it_measures() {
    let drive = |start: &str| {
        run_text(&format!(
            r#"Diagram(
                simulation: ({start}),
                blocks: {{
                    "ref": Constant(value: "1 rad"), "err": Sum(signs: "+-"),
                    "pid": Pid(kp: "20 N*m/rad", ki: "10 N*m/(rad*s)", kd: "5 N*m*s/rad", n: 500), "tq": IdealTorqueSource,
                    "h": RotationalReference, "j1": Inertia(j: "0.1 kg*m^2"), "j2": Inertia(j: "0.2 kg*m^2"),
                    "k": RotationalSpringDamper(k: "100 N*m/rad", d: "0.5 N*m*s/rad"), "ld": ConstantTorque(tau: "-5 N*m"),
                    "e1": MotionSensor, "e2": MotionSensor, "show": Scope(inputs: ["p1", "p2"]),
                    "push": Constant(value: "5 N"), "fs": IdealForceSource, "w": TranslationalReference,
                    "spring": TranslationalSpringDamper(k: "100 N/m", d: "10 N*s/m"), "m": Mass(m: "1 kg"),
                    "e3": TranslationalMotionSensor, "x": Scope,
                }},
                connections: [
                    "ref.y -> err.u1", "e1.phi -> err.u2, show.p1", "err.y -> pid.e", "pid.u -> tq.tau",
                    "tq.r <-> j1.r <-> k.r <-> e1.r", "k.c <-> j2.r <-> ld.r <-> e2.r",
                    "tq.c <-> e1.c <-> e2.c <-> ld.c <-> h.r", "e2.phi -> show.p2",
                    "push.y -> fs.f", "fs.r <-> m.r <-> spring.r <-> e3.r", "fs.c <-> spring.c <-> e3.c <-> w.r", "e3.x -> x.u",
                ],
            )"#
        ))
    };
    let steady = drive(r#"start: Steady, stop_time: "1 ms""#);
    let run = drive(r#"stop_time: "60 s""#);
    // 5 N*m on a spring of 100 N*m/rad, 5 N on one of 100 N/m.
    for (path, expected) in [("show.p1", 1.0), ("show.p2", 0.95), ("x.u", 0.05)] {
        let [found, settled] = [steady.column(path)[0], run.last(path)];
        assert!((found - expected).abs() < 1e-9, "{path}: {found}, not {expected}");
        assert!((settled - expected).abs() < 1e-4, "{path}: {settled}, not {expected}");
    }
}

/// What moves at the start and on which nothing depends there, in the first order: a load that grows with the square of a speed, a
/// friction of the third power, a dead zone, a tank that runs empty, a mass above its stop. Each comes to rest elsewhere.
#[test]
fn what_acts_only_away_from_the_start_is_no_state_on_which_nothing_depends() {
    let models = [
        (
            r#""m": ConstantTorque(tau: "5 N*m"), "j": Inertia(j: "0.5 kg*m^2"), "load": QuadraticLoad(torque: "5 N*m", speed: "100 rad/s"),
               "h": RotationalReference, "e": MotionSensor"#,
            r#""m.r <-> j.r <-> load.r <-> e.r", "m.c <-> load.c <-> e.c <-> h.r", "e.w -> s.u""#,
            100.0,
        ),
        (r#""o": OdeSystem(law: "v' = 9.81 - 0.1*v^3", start: {})"#, r#""o.v -> s.u""#, 98.1_f64.cbrt()),
        (
            r#""i": Integrator, "dz": DeadZone(start: -0.5, end: 0.5), "c": Constant(value: 1), "e": Sum(signs: "+-"), "g": Gain(k: 2)"#,
            r#""c.y -> e.u1", "dz.y -> g.u", "g.y -> e.u2", "e.y -> i.u", "i.y -> dz.u, s.u""#,
            1.0,
        ),
    ];
    for (blocks, connections, expected) in models {
        let text = format!(
            r#"Diagram(simulation: (stop_time: "1 s"), blocks: {{ {blocks}, "s": Scope }}, connections: [{connections}])"#
        );
        let (compiled, problems) = compile_text(&text);
        let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
        let mut simulation = Simulation::new(Arc::new(schedule)).expect("a simulation");
        simulation.seek_rest(&Steady::default(), false, &mut || true).expect("a rest");
        let found = simulation.signals()[simulation.schedule().recorded[0].cell];
        assert!((found - expected).abs() < 1e-6 * expected, "{found}, not {expected}: {blocks}");
    }
}

/// States that are small in SI units go all the way: the current of a junction, a volume that runs out by a root, and the same from below.
/// `V = R i + n vT ln(1 + i / i_s)` and `u = k sqrt(x)`.
#[test]
fn small_states_come_to_their_own_rest() {
    let law = |law: &str, start: f64| {
        let text = diagram(
            "",
            &format!(r#""o": OdeSystem(law: "{law}", start: {{"x": "{start:?}"}}), "s": Scope"#),
            r#""o.x -> s.u""#,
        );
        stays(&text, 1e-9).column("s.u")[0]
    };
    for (u, k, start) in [(1e-9_f64, 1e-3, 3e-11), (1e-9, 1e-3, 1e-13), (2e-7, 1e-1, 1e-9)] {
        let (found, expected) = (law(&format!("x' = {u:?} - {k:?}*sqrt(x)"), start), (u / k).powi(2));
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
    }
    // Of 0.5 V: by bisection.
    let (mut low, mut high) = (0.0_f64, 1e-3_f64);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if 1e3 * middle + 0.025 * (middle / 1e-14).ln_1p() < 0.5 { low = middle } else { high = middle }
    }
    for start in [0.0, 1e-9, 1e-4] {
        let found = law("x' = (0.5 - 1000*x - 0.025*ln(1 + x/1e-14))/0.001", start);
        assert!((found / low - 1.0).abs() < 1e-6, "{found}, not {low}");
    }
}

/// The angle of a shaft that turns steadily has no value of its own: it begins where it is written, and so does what is measured of it.
#[test]
fn the_angle_of_a_turning_shaft_begins_as_it_is_written() {
    let text = diagram(
        "",
        r#""m": ConstantTorque(tau: "4 N*m"), "j": Inertia(j: "0.5 kg*m^2"), "d": RotationalDamper(d: "0.2 N*m*s/rad"),
           "h": RotationalReference, "e": MotionSensor, "speed": Scope, "angle": Scope"#,
        r#""m.r <-> j.r <-> d.r <-> e.r", "m.c <-> d.c <-> e.c <-> h.r", "e.w -> speed.u", "e.phi -> angle.u""#,
    );
    let run = run_text(&text);
    assert!((run.column("speed.u")[0] - 20.0).abs() < 1e-9, "{}", run.column("speed.u")[0]);
    assert_eq!(run.column("angle.u")[0], 0.0);
    assert!((run.last("angle.u") - 200.0).abs() < 1e-4, "{}", run.last("angle.u"));
}

/// A linkage of four bars in space, on two ball joints. Were its loop open, or anything moving, it would be pulled together.
#[test]
fn closed_loops_with_ball_joints_are_closed_at_rest() {
    let run = stays(
        r#"Diagram(
            simulation: (stop_time: "0.3 s", start: Steady),
            blocks: {
                "world": World,
                "b0": Body(mass: 1.0, com: [0.1, 0, 0], moi: [0.001, 0.01, 0.01], poi: [0, 0, 0]),
                "b1": Body(mass: 2.0, com: [0.25, 0, 0], moi: [0.001, 0.04, 0.04], poi: [0, 0, 0]),
                "b2": Body(mass: 1.0, com: [0, 0, 0.2], moi: [0.02, 0.02, 0.001], poi: [0, 0, 0]),
                "j0": RevoluteJoint(axis: [0, 1, 0], position: "3 deg", damping: 0.05),
                "j1": SphericalJoint(damping: 0.02), "j2": SphericalJoint(damping: 0.02),
                "j3": RevoluteJoint(axis: [0, 1, 0], stiffness: 6, damping: 0.1),
                "ta": Transform(translation: [0.158, 0, 0], rpy: [0.2, 0.1, 0.4]), "tb": Transform(translation: [0.479, 0, 0]),
                "tc": Transform(translation: [0, 0, 0.495]), "tg": Transform(translation: [0.5, -0.1, 0], rpy: [0.1, 0.2, 0.3]),
                "show": Scope(inputs: ["q0", "w0", "a0", "q3", "w3", "a3"]),
            },
            connections: [
                "world.frame <-> j0.base <-> tg.base", "j0.follower <-> b0.frame <-> ta.base", "ta.follower <-> j1.base",
                "j1.follower <-> b1.frame <-> tb.base", "tb.follower <-> j2.base", "j2.follower <-> tc.follower",
                "tc.base <-> b2.frame <-> j3.follower", "j3.base <-> tg.follower", "j0.q -> show.q0", "j0.w -> show.w0",
                "j0.a -> show.a0", "j3.q -> show.q3", "j3.w -> show.w3", "j3.a -> show.a3",
            ],
        )"#,
        1e-9,
    );
    for signal in ["w0", "a0", "w3", "a3"] {
        assert!(run.column(&format!("show.{signal}"))[0].abs() < 1e-9, "{signal}");
    }
}

/// A body on a ball joint under its weight, at -0.2 m along its own z and `x` beside, whose base is tilted by 0.5 rad about x.
fn hanging(x: f64, joint: &str) -> String {
    format!(
        r#"Diagram(
            simulation: (stop_time: "0.1 s", start: Steady),
            blocks: {{
                "world": World, "tilt": Transform(rpy: [0.5, 0, 0]),
                "ball": SphericalJoint({joint}),
                "body": Body(mass: "1 kg", com: [{x}, 0, "-0.2 m"], moi: [0.02, 0.02, 0.01]),
                "show": Scope(inputs: ["p", "w", "a"]),
            }},
            connections: [
                "world.frame <-> tilt.base", "tilt.follower <-> ball.base", "ball.follower <-> body.frame",
                "ball.p -> show.p", "ball.w -> show.w", "ball.a -> show.a",
            ],
        )"#
    )
}

/// Four numbers keep an orientation, and only three of them are free: none is left undetermined but the turn about the vertical.
#[test]
fn a_body_on_a_ball_joint_hangs_straight_down_whatever_its_damping() {
    for joint in [r#"damping: "0.05 N*m*s/rad""#, "", r#"rpy: ["20 deg", "-35 deg", "0 deg"]"#] {
        let (simulation, rest) =
            begun(&hanging(0.0, joint)).unwrap_or_else(|error| panic!("{joint}: {error}"));
        let p: [f64; 4] = std::array::from_fn(|i| simulation.states()[i]);
        near(p.iter().map(|p| p * p).sum::<f64>(), 1.0, 1e-12);
        // Its own z is up: of the tilt about x and the quaternion one after the other.
        let (s, c) = 0.25_f64.sin_cos();
        let [w, x, y, z] =
            [c * p[0] - s * p[1], c * p[1] + s * p[0], c * p[2] - s * p[3], c * p[3] + s * p[2]];
        near(w * w - x * x - y * y + z * z, 1.0, 1e-12);
        assert!(!rest.undetermined.is_empty(), "{joint}");
        assert!(rest.undetermined.iter().all(|name| name.starts_with("ball.p")), "{:?}", rest.undetermined);
    }
}

/// A spring holds a body beside its centre: its moment is that of the weight.
#[test]
fn a_body_on_a_ball_joint_leans_as_far_as_its_spring_gives() {
    let text = hanging(0.1, r#"stiffness: "2 N*m/rad", rpy: ["10 deg", "5 deg", "-20 deg"]"#);
    let (simulation, rest) = begun(&text).expect("a rest");
    assert!(rest.undetermined.is_empty(), "{:?}", rest.undetermined);
    let p: [f64; 4] = std::array::from_fn(|i| simulation.states()[i]);
    let half = (1.0 - p[0] * p[0]).sqrt();
    let angle = 2.0 * half.atan2(p[0]);
    let turn: [f64; 3] = std::array::from_fn(|i| angle * p[i + 1] / half);
    // In axes of the base: where the centre is, and which way the weight pulls.
    let along = |v: [f64; 3]| -> [f64; 3] {
        let n = [p[1] / half, p[2] / half, p[3] / half];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let dot: f64 = (0..3).map(|i| n[i] * v[i]).sum();
        let beside = cross(n, v);
        std::array::from_fn(|i| {
            v[i] * angle.cos() + beside[i] * angle.sin() + n[i] * dot * (1.0 - angle.cos())
        })
    };
    let centre = along([0.1, 0.0, -0.2]);
    let (s, c) = 0.5_f64.sin_cos();
    let weight = [0.0, -9.806_65 * s, -9.806_65 * c];
    let moment = [
        centre[1] * weight[2] - centre[2] * weight[1],
        centre[2] * weight[0] - centre[0] * weight[2],
        centre[0] * weight[1] - centre[1] * weight[0],
    ];
    (0..3).for_each(|i| near(2.0 * turn[i], moment[i], 1e-8));
}

/// A mass of 2 kg under 10 N towards an end of travel at zero, 0.3 m away: it lies there, and so says who measures it.
#[test]
fn ends_of_travel_are_reached_but_not_passed() {
    let sliding = |stop: &str| {
        stays(
            &diagram(
                "",
                &format!(
                    r#""m": Mass(m: "2 kg"), "f": ConstantForce(f: "-10 N"), "s": {stop}, "d": TranslationalDamper(d: 5),
                       "h": TranslationalReference, "ms": TranslationalMotionSensor(x0: "0.3 m"), "show": Scope(inputs: ["x", "v", "stop"])"#
                ),
                r#""m.r <-> f.r <-> s.r <-> d.r <-> ms.r", "f.c <-> s.c <-> d.c <-> h.r <-> ms.c", "ms.x -> show.x", "ms.v -> show.v",
                   "s.x -> show.stop""#,
            ),
            1e-9,
        )
    };
    for (stop, depth) in [
        (r#"TranslationalRigidStop(lower: "0 m", upper: "1 m", x0: "0.3 m")"#, 1e-12),
        (r#"TranslationalHardStop(lower: "0 m", upper: "1 m", x0: "0.3 m")"#, 1e-3),
    ] {
        let run = sliding(stop);
        let [x, v, own] = ["x", "v", "stop"].map(|signal| run.column(&format!("show.{signal}"))[0]);
        assert!(
            x <= 0.0 && x > -depth && (x - own).abs() < 1e-9 && v.abs() < 1e-9,
            "{stop}: {x}, {own}, {v}"
        );
    }
    // The other end of a joint that turns, and one that a body falls on.
    for (joint, body, drive, end) in [
        (
            r#"RevoluteJoint(axis: [0, 0, 1], position: "20 deg", lower: "-30 deg", upper: "40 deg", damping: 0.1)"#,
            "com: [0.3, 0, 0]",
            0.2,
            40_f64.to_radians(),
        ),
        (
            r#"PrismaticJoint(axis: [0, 0, 1], position: "0.2 m", lower: "0 m", upper: "1 m", damping: 5)"#,
            "com: [0, 0, 0]",
            0.0,
            0.0,
        ),
    ] {
        let (is_turning, unit) =
            (joint.starts_with("Rev"), if joint.starts_with("Rev") { "N*m" } else { "N" });
        let (place, speed, effort) = if is_turning { ("q", "w", "torque") } else { ("x", "v", "force") };
        let run = stays(
            &diagram(
                "",
                &format!(
                    r#""world": World, "j": {joint}, "b": Body(mass: "2 kg", {body}, moi: [0.01, 0.02, 0.02]), "t": Constant(value: "{drive} {unit}"),
                       "show": Scope(inputs: ["q", "w"])"#
                ),
                &format!(
                    r#""world.frame <-> j.base", "j.follower <-> b.frame", "t.y -> j.{effort}", "j.{place} -> show.q", "j.{speed} -> show.w""#
                ),
            ),
            1e-8,
        );
        let (q, w) = (run.column("show.q")[0], run.column("show.w")[0]);
        assert!((q - end).abs() < 2e-3 && w.abs() < 1e-9, "{joint}: {q}, {w}");
    }
    let run = stays(
        &diagram(
            "",
            r#""j": Inertia(j: 0.01), "t": ConstantTorque(tau: "0.5 N*m"), "s": RotationalRigidStop(lower: "-20 deg", upper: "30 deg"),
               "d": RotationalDamper(d: 0.05), "h": RotationalReference, "ms": MotionSensor, "show": Scope(inputs: ["x", "stop"])"#,
            r#""j.r <-> t.r <-> s.r <-> d.r <-> ms.r", "t.c <-> s.c <-> d.c <-> h.r <-> ms.c", "ms.phi -> show.x", "s.phi -> show.stop""#,
        ),
        1e-9,
    );
    let end = 30_f64.to_radians();
    assert!((run.last("show.stop") - end).abs() < 1e-9 && (run.last("show.x") - end).abs() < 1e-9);
}

/// Where one side of a cylinder is open to the tank its pressure is zero, whose size is that of a pressure. The stop yields by
/// (p_a A_a) / k at one end and by (p_b A_b) / k at the other.
#[test]
fn a_cylinder_rests_at_the_end_that_its_valve_drives_it_to() {
    for (spool, end) in [(0.3, 0.8 + 0.2e-3), (-0.3, -0.12e-3), (0.01, 0.8 + 0.2e-3)] {
        let text = diagram(
            "",
            &format!(
                r#""valve": DirectionalValve(area: "10 mm^2"), "spool": Constant(value: {spool}), "supply": Tank(p: "100 bar"), "tank": Tank,
                   "cylinder": HydraulicCylinder(area_a: "20 cm^2", area_b: "12 cm^2", stroke: "800 mm", x0: "300 mm"),
                   "mass": Mass(m: "100 kg"), "frame": TranslationalReference, "show": Scope(inputs: ["q_a", "q_b", "x"])"#
            ),
            r#""spool.y -> valve.s", "supply.a <-> valve.p", "tank.a <-> valve.t", "valve.a <-> cylinder.a", "valve.b <-> cylinder.b",
               "cylinder.r <-> mass.r", "cylinder.c <-> frame.r", "valve.q_a -> show.q_a", "valve.q_b -> show.q_b", "cylinder.x -> show.x""#,
        );
        let run = stays(&text, 1e-9);
        assert!((run.column("show.x")[0] - end).abs() < 1e-7, "{} m", run.column("show.x")[0]);
        assert!(run.column("show.q_a")[0].abs() < 1e-12 && run.column("show.q_b")[0].abs() < 1e-12);
    }
}

/// Bristles that are bent further than any motion bends them would hold any load. Beyond breakaway the wheel slides: w = (load - coulomb) /
/// viscous, once the Stribeck effect is over.
#[test]
fn bristles_hold_no_more_than_their_breakaway_torque() {
    let text = |load: f64, damping: f64| {
        diagram(
            "",
            &format!(
                r#""friction": LuGreFriction(coulomb: "1 N*m", breakaway: "1.5 N*m", stribeck_velocity: "0.01 rad/s", viscous: "0.4 N*m*s/rad",
                       sigma0: "1e4 N*m/rad", sigma1: "{damping} N*m*s/rad"),
                   "wheel": Inertia(j: "0.1 kg*m^2"), "housing": RotationalReference, "load": Constant(value: "{load} N*m"),
                   "torque": IdealTorqueSource, "motion": MotionSensor, "show": Scope(inputs: ["z", "w"])"#
            ),
            r#""load.y -> torque.tau", "torque.r <-> wheel.r <-> friction.r <-> motion.r",
               "torque.c <-> housing.r <-> friction.c <-> motion.c", "friction.z -> show.z", "motion.w -> show.w""#,
        )
    };
    for damping in [0.0, 100.0] {
        for load in [-1.4, 1.49, 0.3, 0.1] {
            let run = stays(&text(load, damping), 1e-9);
            near(run.column("show.z")[0], 1e-4 * load, 1e-6);
            assert!(run.column("show.w")[0].abs() < 1e-15);
        }
        for load in [2.0, 3.0, -3.0, -20.0_f64] {
            let run = stays(&text(load, damping), 1e-9);
            near(run.column("show.z")[0], 1e-4 * load.signum(), 1e-6);
            near(run.column("show.w")[0], (load.abs() - 1.0) / 0.4 * load.signum(), 1e-6);
        }
    }
    // Little above breakaway the motion begins too slowly to be found.
    let refused = refused(&text(1.501, 100.0));
    assert_eq!(refused.code, "no_steady_state");
    assert!(refused.message.contains("more than its breakaway torque"), "{}", refused.message);
}
