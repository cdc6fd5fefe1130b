//! Blocks of a first course in whole diagrams, at default settings, against closed forms.

use std::f64::consts::PI;
use std::path::Path;

use blocksim_tests::{Desk, Run, close, compile_text, compile_with, run, run_text};

fn diagram(settings: &str, blocks: &str, connections: &str) -> String {
    format!("Diagram(simulation: ({settings}), blocks: {{ {blocks} }}, connections: [ {connections} ])")
}

fn end(run: &Run) -> f64 {
    *run.time.last().expect("a row")
}

/// A sine of 50 Hz crosses zero upwards 100 times in 2 s, however long the steps would like to be.
#[test]
fn a_counter_misses_no_edge() {
    let run = run_text(&diagram(
        r#"stop_time: "2 s""#,
        r#""u": Sine(frequency: "50 Hz", phase: "-90 deg"), "counter": Counter, "wrap": Counter(upper: 6, at_limit: Wrap),
           "show": Scope(inputs: ["n", "m"])"#,
        r#""u.y -> counter.u, wrap.u", "counter.count -> show.n", "wrap.count -> show.m""#,
    ));
    assert_eq!(run.last("show.n"), 100.0);
    assert_eq!(run.last("show.m"), 100.0 % 7.0);
    assert_eq!((run.at("show.n", 0.0049), run.at("show.n", 0.0051)), (0.0, 1.0));
}

#[test]
fn memory_gives_the_input_of_the_step_before() {
    let run = run_text(&diagram(
        r#"stop_time: "1 s", solver: Ode4(step: "20 ms")"#,
        r#""u": Sine(frequency: "1 Hz"), "memory": Memory(x0: 7), "show": Scope(inputs: ["u", "y"])"#,
        r#""u.y -> memory.u, show.u", "memory.y -> show.y""#,
    ));
    let (u, y) = (run.column("show.u"), run.column("show.y"));
    assert_eq!((y.len(), y[0], &y[1..]), (51, 7.0, &u[..50]));
}

/// Neither the method nor the steps change a number of a noise, and each block has its own.
#[test]
fn noise_depends_on_the_seed_and_the_place_alone() {
    let text = |solver: &str, seed: u32| {
        diagram(
            &format!(r#"stop_time: "1 s", output: Every("10 ms"), solver: {solver}"#),
            &format!(
                r#""a": Noise(ts: "10 ms", std: 1, seed: {seed}), "b": Noise(ts: "10 ms", std: 1, seed: {seed}),
                "lag": TransferFunction(num: [1], den: [0.01, 1]), "show": Scope(inputs: ["a", "b", "lag"])"#
            ),
            r#""a.y -> show.a, lag.u", "b.y -> show.b", "lag.y -> show.lag""#,
        )
    };
    let one = run_text(&text(r#"Ode4(step: "2 ms")"#, 3));
    let other = run_text(&text("Ode45(rtol: 1e-6)", 3));
    let seeded = run_text(&text("Ode45(rtol: 1e-6)", 4));
    let (a, b) = (one.column("show.a"), one.column("show.b"));
    assert_eq!(a.len(), 101);
    assert_eq!((a, b), (other.column("show.a"), other.column("show.b")));
    let equal = |a: &[f64], b: &[f64]| a.iter().zip(b).filter(|(a, b)| a == b).count();
    assert_eq!((equal(a, b), equal(a, seeded.column("show.a"))), (0, 0));
    let mean = a.iter().sum::<f64>() / 101.0;
    close(mean, 0.0, 0.5, "mean of 100 numbers");
}

#[test]
fn a_stop_ends_the_run_where_its_condition_becomes_true() {
    let run = run_text(&diagram(
        r#"stop_time: "60 s""#,
        r#""speed": Integrator(x0: "20 m/s"), "brake": Constant(value: "-4 m/s^2"),
           "is_at_rest": Compare(operator: LessEqual, constant: 0), "stop": Stop(message: "at rest"), "show": Scope"#,
        r#""brake.y -> speed.u", "speed.y -> is_at_rest.u, show.u", "is_at_rest.y -> stop.stop""#,
    ));
    assert!(run.error.is_none());
    close(end(&run), 5.0, 1e-9, "end of the run");
    close(run.last("show.u"), 0.0, 1e-9, "speed at the end");
}

/// `x' = 1` while a sine is positive, else -2: both halves of a period take half of it.
#[test]
fn equations_in_text_switch_at_the_zeros_of_their_conditions() {
    let run = run_text(&diagram(
        r#"stop_time: "3.25 s""#,
        r#""u": Sine(frequency: "1 Hz"), "ode": OdeSystem(law: "x' = if(u > 0, 1, -2); is_up = u > 0; half = x/2"),
           "show": Scope(inputs: ["x", "half", "up"])"#,
        r#""u.y -> ode.u", "ode.x -> show.x", "ode.half -> show.half", "ode.is_up -> show.up""#,
    ));
    close(run.last("show.x"), 3.0 * (0.5 - 1.0) + 0.25, 1e-8, "state");
    close(run.last("show.half"), 0.5 * run.last("show.x"), 1e-15, "definition");
    assert_eq!((run.at("show.up", 0.2), run.at("show.up", 0.7)), (1.0, 0.0));
}

/// `x' = 1` where `u = -x` is positive, else -1: from -1 the state rises to zero, whatever the block saw before the start.
#[test]
fn a_mode_in_a_loop_around_a_state_is_chosen_with_the_input_of_the_same_instant() {
    let ode = r#""ode": OdeSystem(law: "x' = if(u > 0, 1, -1); is_up = x > -0.5", start: { "x": -1 })"#;
    let alone = run_text(&diagram(
        r#"stop_time: "0.6 s""#,
        &format!(r#"{ode}, "back": Gain(k: -1), "show": Scope(inputs: ["x", "up"])"#),
        r#""ode.x -> back.u, show.x", "back.y -> ode.u", "ode.is_up -> show.up""#,
    ));
    // The same where a subsystem is enabled from the beginning, and where what the state has chosen leads back to the input.
    let inside = format!(
        r#"Diagram(inputs: {{ "u": () }}, outputs: {{ "x": "ode.x", "up": "ode.is_up" }}, blocks: {{ {ode} }}, connections: ["in.u -> ode.u"])"#
    );
    let around = diagram(
        r#"stop_time: "0.6 s""#,
        r#""on": Constant(value: true), "back": Gain(k: -1), "inside": Subsystem(file: "inside.ron", enable: Held),
           "show": Scope(inputs: ["x", "up"])"#,
        r#""on.y -> inside.enable", "inside.x -> back.u, show.x", "back.y -> inside.u", "inside.up -> show.up""#,
    );
    let desk = Desk::new().with("around.ron", &around).with("inside.ron", &inside);
    let (compiled, problems) = compile_with(&desk, Path::new("around.ron"), &[]);
    let paused = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let chosen = compile_text(&diagram(
        r#"stop_time: "0.6 s""#,
        &format!(
            r#"{ode}, "one": Constant(value: 1), "two": Constant(value: 2), "which": Switch, "show": Scope(inputs: ["x", "up"])"#
        ),
        r#""ode.is_up -> which.control, show.up", "two.y -> which.u1", "one.y -> which.u3", "which.y -> ode.u", "ode.x -> show.x""#,
    ));
    let chosen = chosen.0.schedule.expect("a schedule");
    assert!(chosen.loops.is_empty(), "{:?}", chosen.loops);
    for run in [alone, paused, run(chosen)] {
        close(run.at("show.x", 0.3), -0.7, 1e-9, "state");
        close(run.last("show.x"), -0.4, 1e-9, "state");
        assert_eq!((run.at("show.up", 0.4), run.last("show.up")), (0.0, 1.0));
        assert!(run.events.iter().all(|(t, ..)| (t - 0.5).abs() < 1e-9), "{:?}", run.events);
    }
}

/// A system of equations in a loop around which only a state leads is no algebraic loop, and agrees with the same blocks.
#[test]
fn equations_in_text_close_a_loop_as_blocks_do() {
    let run = run_text(&diagram(
        r#"stop_time: "4 s", output: Every("10 ms"), solver: Ode45(rtol: 1e-9)"#,
        r#""plant": OdeSystem(law: "
               angle' = speed
               speed' = (torque - d*speed) / j
               degrees = angle * 180 / pi
           ", start: { "angle": "1 rad" }, parameters: { "d": "0.4 N*m*s", "j": "0.5 kg*m^2" }),
           "spring": Gain(k: "-8 N*m"), "show": Scope(inputs: ["angle", "degrees"])"#,
        r#""plant.angle -> spring.u, show.angle", "plant.degrees -> show.degrees", "spring.y -> plant.torque""#,
    ));
    // j x'' + d x' + k x = 0 with x(0) = 1.
    let (decay, omega) = (0.4_f64, (16.0_f64 - 0.16).sqrt());
    for t in [0.5, 1.7, 4.0] {
        let x = (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
        close(run.at("show.angle", t), x, 1e-5, &format!("angle at {t}"));
    }
    close(run.last("show.degrees"), run.last("show.angle").to_degrees(), 1e-12, "degrees");
}

#[test]
fn an_index_without_an_input_ends_the_run_with_its_place() {
    let text = diagram(
        r#"stop_time: "5 s""#,
        r#""index": Ramp(slope: "1 1/s", initial: 1), "one": Constant(value: 1), "two": Constant(value: 2),
           "switch": MultiportSwitch(inputs: 2), "show": Scope"#,
        r#""index.y -> switch.index", "one.y -> switch.u1", "two.y -> switch.u2", "switch.y -> show.u""#,
    );
    let (compiled, problems) = compile_text(&text);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let error = run.error.as_ref().expect("a failure");
    assert_eq!(error.path.as_deref(), Some("switch"));
    assert!(error.message.contains("but the inputs are 1 to 2"), "{}", error.message);
    close(error.t, 1.5, 1e-6, "time of the error");
    assert_eq!(run.at("show.u", 0.4), 1.0);
    assert_eq!(run.at("show.u", 0.6), 2.0);
}

/// Areas under piecewise straight lines, which only come out when no kink and no jump is passed over.
#[test]
fn kinks_and_jumps_of_sources_are_hit() {
    let run = run_text(&diagram(
        r#"stop_time: "10 s""#,
        r#""points": SignalBuilder(points: [(1, 0), (2, 4), (2, -1), (4, 1)], after: Cyclic),
           "held": SignalBuilder(points: [(0, 1), (2.5, 3), (7, -1)], interpolation: Hold),
           "saw": Sawtooth(lower: -1, upper: 3, period: "0.7 s", width: 0.25),
           "whole": Function(function: Floor), "clock": Clock, "per_s": Gain(k: "2 1/s"),
           "rest": Function(function: Mod), "three": Constant(value: 3),
           "all": Mux(inputs: 5), "area": Integrator, "show": Scope"#,
        r#""points.y -> all.u1", "held.y -> all.u2", "saw.y -> all.u3", "clock.y -> per_s.u", "per_s.y -> whole.u, rest.u1",
           "three.y -> rest.u2", "whole.y -> all.u4", "rest.y -> all.u5", "all.y -> area.u", "area.y -> show.u""#,
    ));
    let column = |i: usize| run.last(&format!("show.u[{i}]"));
    // Each cycle of 3 s, from 1 s on: 2 and 0.
    close(column(0), 3.0 * 2.0, 1e-9, "points");
    close(column(1), 2.5 + 4.5 * 3.0 - 3.0, 1e-9, "held");
    // 14 periods with the mean 1, and the rest of 0.2 s: a rise of 0.175 s, and 0.025 s of the fall.
    let fall = 0.025 * (3.0 - 0.5 * 4.0 * 0.025 / 0.525);
    close(column(2), 9.8 + 0.175 + fall, 1e-9, "sawtooth");
    close(column(3), 0.5 * f64::from((0..20).sum::<i32>()), 1e-9, "floor of 2 t");
    // Periods of 1.5 s with the mean 1.5, six of them, and 1 s from 0 to 2.
    close(column(4), 6.0 * 1.5 * 1.5 + 1.0, 1e-9, "2 t modulo 3");
}

/// `tau = J^T F` of an arm with two links, from its Jacobian matrix.
#[test]
fn torques_of_a_force_are_three_blocks() {
    let robot = r#"(links: [
        (axis: [0, 0, 1], limits: (lower: "-3 rad", upper: "3 rad", speed: "2 rad/s", acceleration: "9 rad/s^2"),
         bodies: [(mass: "3 kg", com: ["0.25 m", 0, 0], moi: ["0.003 kg*m^2", "0.06 kg*m^2", "0.06 kg*m^2"])]),
        (origin: (translation: ["0.5 m", 0, 0]), axis: [0, 0, 1],
         limits: (lower: "-3 rad", upper: "3 rad", speed: "2 rad/s", acceleration: "9 rad/s^2"),
         bodies: [(mass: "2 kg", com: ["0.2 m", 0, 0], moi: ["0.003 kg*m^2", "0.03 kg*m^2", "0.03 kg*m^2"])]),
        ], flange: (translation: ["0.4 m", 0, 0]))"#;
    let run = run_text(&diagram(
        r#"stop_time: "1 s""#,
        &format!(
            r#""q": Constant(value: ["0.7 rad", "-1.1 rad"]), "jacobian": Jacobian(robot: {robot}), "transpose": Transpose,
               "force": Constant(value: [0, 0, 0, 3, -2, 5]), "tau": Product(multiplication: Matrix), "show": Scope"#
        ),
        r#""q.y -> jacobian.q", "jacobian.j -> transpose.u", "transpose.y -> tau.u1", "force.y -> tau.u2", "tau.y -> show.u""#,
    ));
    let ([q1, q2], [fx, fy]) = ([0.7_f64, -1.1], [3.0, -2.0]);
    let (x2, y2) = (0.4 * (q1 + q2).cos(), 0.4 * (q1 + q2).sin());
    let (x, y) = (0.5 * q1.cos() + x2, 0.5 * q1.sin() + y2);
    close(run.last("show.u[0]"), x * fy - y * fx, 1e-12, "torque of the first joint");
    close(run.last("show.u[1]"), x2 * fy - y2 * fx, 1e-12, "torque of the second joint");
}

/// A limit that is a signal: the area of `min(sin, t/10)` until the two meet, and of rates that change at a sample.
#[test]
fn limits_and_rates_by_signals_act_where_they_are() {
    let run = run_text(&diagram(
        r#"stop_time: "2 s""#,
        r#""u": Constant(value: 10), "limit": Ramp(slope: "1 1/s", initial: 1), "saturation": Saturation(lower: 0, external: true),
           "rate": Step(time: "1 s", before: "2 1/s", after: "0.5 1/s"),
           "limiter": RateLimiter(rising: 1, falling: -1, external: true),
           "hold": FirstOrderHold(ts: "0.5 s"), "area": Integrator, "show": Scope(inputs: ["y", "area", "rate", "hold"])"#,
        r#""u.y -> saturation.u, limiter.u, hold.u", "limit.y -> saturation.upper", "saturation.y -> area.u, show.y",
           "area.y -> show.area", "rate.y -> limiter.rising", "limiter.y -> show.rate", "hold.y -> show.hold""#,
    ));
    close(run.last("show.y"), 3.0, 1e-12, "limit");
    close(run.last("show.area"), 4.0, 1e-9, "area under the limit");
    close(run.at("show.rate", 1.0), 2.0, 1e-9, "fast");
    close(run.last("show.rate"), 2.5, 1e-9, "slow");
    for (t, y) in [(0.25, 5.0), (0.5, 10.0), (1.3, 10.0)] {
        close(run.at("show.hold", t), y, 1e-9, &format!("hold at {t}"));
    }
}

/// Rates that vary all the time: `1 + sin` upwards, then `-1 - sin/2` downwards, until the input is met.
#[test]
fn rates_that_vary_are_integrated_as_exactly_as_states() {
    let run = run_text(&diagram(
        r#"stop_time: "6 s", solver: Auto(rtol: 1e-8)"#,
        r#""u": Step(time: "3 s", before: 10, after: 1.5), "limiter": RateLimiter(rising: 1, falling: -1, external: true),
           "up": Sine(amplitude: "1 1/s", bias: "1 1/s", frequency: "1 Hz"),
           "down": Sine(amplitude: "0.5 1/s", bias: "-1 1/s", frequency: "1 Hz", phase: "180 deg"), "show": Scope(inputs: ["y"])"#,
        r#""u.y -> limiter.u", "up.y -> limiter.rising", "down.y -> limiter.falling", "limiter.y -> show.y""#,
    ));
    let turn = 2.0 * PI;
    let swing = |t: f64| (1.0 - (turn * t).cos()) / turn;
    let rising = |t: f64| t + swing(t);
    let falling = |t: f64| 3.0 - (t - 3.0) - 0.5 * swing(t);
    for (t, y) in run.time.iter().zip(run.column("show.y")) {
        let exact = if *t <= 3.0 { rising(*t) } else { falling(*t).max(1.5) };
        close(*y, exact, 1e-6, &format!("output at {t} s"));
    }
    assert_eq!(run.last("show.y"), 1.5);
}

/// The seed of the run and that of a block choose the numbers; neither the method nor another run does.
#[test]
fn the_seed_of_the_run_chooses_the_numbers_of_all_noise() {
    let numbers = |settings: &str| {
        let run = run_text(&diagram(
            &format!(r#"stop_time: "1 s", output: Every("10 ms"), {settings}"#),
            r#""a": Noise(ts: "10 ms", std: 1), "b": Noise(ts: "10 ms", std: 1), "show": Scope(inputs: ["a", "b"])"#,
            r#""a.y -> show.a", "b.y -> show.b""#,
        ));
        ["show.a", "show.b"].map(|signal| run.column(signal).to_vec())
    };
    let plain = numbers("seed: 0");
    assert_eq!(plain, numbers("solver: Ode4(step: \"10 ms\")"));
    let other = numbers("seed: 7");
    assert_eq!(other, numbers("seed: 7"));
    let all = [&plain[0], &plain[1], &other[0], &other[1]];
    for (i, one) in all.iter().enumerate() {
        for two in &all[..i] {
            let same = one.iter().zip(two.iter()).filter(|(x, y)| x == y).count();
            assert_eq!(same, 0, "numbers of two streams");
        }
    }
}

/// A controller whose limits are constant signals gives the numbers of one with these parameters.
#[test]
fn a_controller_with_limits_by_signals_is_the_one_with_parameters() {
    let text = |pid: &str, limits: &str| {
        diagram(
            r#"stop_time: "5 s", output: Every("10 ms")"#,
            &format!(
                r#""set": Step(time: "0.1 s", after: 3), "error": Sum(signs: "+-"), "pid": {pid},
                   "plant": TransferFunction(num: [1], den: [1, 0.2, 0]), "lower": Constant(value: -1), "upper": Constant(value: 1),
                   "show": Scope(inputs: ["u", "y", "lower", "upper"])"#
            ),
            &format!(
                r#""set.y -> error.u1", "plant.y -> error.u2, show.y", "error.y -> pid.e", "pid.u -> plant.u, show.u",
                   "lower.y -> show.lower", "upper.y -> show.upper" {limits}"#
            ),
        )
    };
    let gains = "kp: 2.0, ki: 0.5, kd: 1.5, anti_windup: Clamping";
    let fixed = run_text(&text(&format!("Pid({gains}, lower: -1, upper: 1)"), ""));
    let connected = r#", "lower.y -> pid.lower", "upper.y -> pid.upper""#;
    let by_signals = run_text(&text(&format!("Pid({gains}, external_limits: true)"), connected));
    for signal in ["show.u", "show.y"] {
        assert_eq!(fixed.column(signal), by_signals.column(signal), "{signal}");
    }
}

/// What holds a value is that value to the last digit: a hold that has come down to zero is not above it, one that has come up to a limit
/// has reached it, and nothing is counted but the samples of pulses.
#[test]
fn a_first_order_hold_stands_on_its_samples() {
    for solver in
        ["Auto", "Ode45", "Dop853", "Radau5", "Rodas4", "Ode15s", "Ode23t", "RosW3", "Ode4(step: \"1 ms\")"]
    {
        let run = run_text(&diagram(
            &format!(r#"stop_time: "4 s", solver: {solver}"#),
            r#""down": Step(time: "0.12 s", before: 1.478, after: 0), "f": FirstOrderHold(ts: "50 ms"), "up": Constant(value: 0.3),
               "f2": FirstOrderHold(ts: "50 ms"), "above": Compare(operator: Greater, constant: 0),
               "reached": Compare(operator: GreaterEqual, constant: 0.3), "one": Constant(value: 1), "zero": Constant(value: 0),
               "if": Switch, "if2": Switch, "i": Integrator, "i2": Integrator, "edges": Counter(edge: Rising),
               "p": Pulse(period: "0.444 s", width: 0.29), "f3": FirstOrderHold(ts: "50 ms"), "pulses": Counter(edge: Rising),
               "s": Scope(inputs: ["edges", "above", "reached", "pulses"])"#,
            r#""down.y -> f.u", "f.y -> edges.u, above.u", "edges.count -> s.edges", "above.y -> if.control",
               "one.y -> if.u1, if2.u1", "zero.y -> if.u3, if2.u3", "if.y -> i.u", "i.y -> s.above", "up.y -> f2.u",
               "f2.y -> reached.u", "reached.y -> if2.control", "if2.y -> i2.u", "i2.y -> s.reached",
               "p.y -> f3.u", "f3.y -> pulses.u", "pulses.count -> s.pulses""#,
        ));
        assert_eq!((run.last("s.edges"), run.last("s.pulses")), (1.0, 9.0), "{solver}");
        // A fixed step sees the first value above zero a step late.
        close(run.last("s.above"), 0.2, 1.1e-3, solver);
        close(run.last("s.reached"), 3.95, 1e-9, solver);
    }
}

/// Two conditions on signals that are nothing but rounding have each crossed before the other; the search for the first one must end.
#[test]
fn conditions_on_what_is_rounding_do_not_stop_a_run() {
    for solver in ["Auto", "Dop853", "Rodas4"] {
        let run = run_text(&diagram(
            &format!(r#"stop_time: "4 s", solver: {solver}"#),
            r#""u": Step(time: "0.12 s", before: 1.478, after: 0), "e": Sum(signs: "+-"), "k": Gain(k: "20 1/s"),
               "z": ZeroOrderHold(ts: "50 ms"), "f": Integrator, "u2": Constant(value: 0.3), "e2": Sum(signs: "+-"),
               "k2": Gain(k: "20 1/s"), "z2": ZeroOrderHold(ts: "50 ms"), "f2": Integrator,
               "g": Compare(operator: Greater, constant: 0), "ge": Compare(operator: GreaterEqual, constant: 0.3),
               "c": Counter(edge: Rising), "s": Scope(inputs: ["y", "a", "b", "n"])"#,
            r#""u.y -> e.u1", "f.y -> e.u2, g.u, c.u, s.y", "e.y -> k.u", "k.y -> z.u", "z.y -> f.u", "u2.y -> e2.u1",
               "f2.y -> e2.u2, ge.u", "e2.y -> k2.u", "k2.y -> z2.u", "z2.y -> f2.u", "g.y -> s.a", "ge.y -> s.b", "c.count -> s.n""#,
        ));
        assert!(run.last("s.y").abs() < 1e-12, "{solver}");
    }
}
