//! Whole diagrams against reference values: from a second implementation of the published equations, from equivalent
//! circuits and from closed forms, all computed independently of this program.

use blocksim_tests::{Run, close, run_text};

fn diagram(simulation: &str, blocks: &str, connections: &str) -> Run {
    run_text(&format!(
        "Diagram(simulation: ({simulation}), blocks: {{ {blocks} }}, connections: [{connections}])"
    ))
}

/// u(t) = kp + ki t + kd n exp(-n t) for a unit step of the error.
#[test]
fn a_continuous_pid_answers_a_step_as_its_closed_form() {
    let run = diagram(
        r#"stop_time: "1 s", solver: Ode45(rtol: 1e-10), output: Every("10 ms")"#,
        r#""e": Constant(value: 1), "pid": Pid(kp: 2, ki: "3 1/s", kd: "0.5 s", n: 100), "show": Scope"#,
        r#""e.y -> pid.e", "pid.u -> show.u""#,
    );
    for (t, u) in [(0.0, 52.0), (0.01, 20.42397), (0.1, 2.302270), (1.0, 5.0)] {
        // Reference values to seven digits.
        close(run.at("show.u", t), u, 1e-5, &format!("output at {t} s"));
    }
    for (t, u) in run.time.iter().zip(run.column("show.u")) {
        // A relative tolerance of 1e-10 in a fast decay from 50.
        close(*u, 2.0 + 3.0 * t + 50.0 * f64::exp(-100.0 * t), 1e-7, &format!("output at {t} s"));
    }
}

#[test]
fn a_discrete_pid_gives_the_first_five_samples_of_each_method() {
    let expected = [
        ("ForwardEuler", [27.0, 14.53, 8.31, 5.215, 3.6825]),
        ("BackwardEuler", [18.696_666_667, 13.171_111_111, 9.497_407_407, 7.058_271_605, 5.442_181_070]),
        ("Trapezoidal", [22.015, 14.045, 9.275, 6.425, 4.727]),
    ];
    for (method, samples) in expected {
        let run = diagram(
            r#"stop_time: "40 ms", output: Every("10 ms")"#,
            &format!(
                r#""e": Constant(value: 1), "pid": DiscretePid(ts: "10 ms", kp: 2, ki: "3 1/s", kd: "0.5 s", n: 50,
                integrator: {method}, filter: {method}), "show": Scope"#
            ),
            r#""e.y -> pid.e", "pid.u -> show.u""#,
        );
        assert_eq!(run.time.len(), samples.len(), "{method}: {:?}", run.time);
        for (found, sample) in run.column("show.u").iter().zip(samples) {
            // Sums of a few numbers; the references are rounded to nine places.
            close(*found, sample, 1e-9, method);
        }
    }
}

/// A limiter of motoring power in front of a DC motor (1 ohm, 2 mH, 0.1 V s) whose speed is given.
fn limited_motor(speed: f64, stop: &str) -> Run {
    diagram(
        &format!(r#"stop_time: "{stop}", solver: Ode45(rtol: 1e-8)"#),
        &format!(
            r#"
            "wanted": Constant(value: "48 V"), "power_limit": Constant(value: "200 W"),
            "guard": Constant(value: "0.004 A"), "size": MinMax(function: Max), "voltage_limit": Divide,
            "voltage": MinMax(function: Min), "source": ControlledVoltageSource, "ammeter": CurrentSensor,
            "motor": DcMotor(r: "1 ohm", l: "2 mH", k: "0.1 N*m/A", j: "1e-4 kg*m^2"),
            "speed": Constant(value: "{speed} rad/s"), "shaft": IdealSpeedSource,
            "ground": ElectricalReference, "housing": RotationalReference,
            "show_v": Scope(inputs: ["v"]), "show_i": Scope(inputs: ["i"]),"#
        ),
        r#"
            "ammeter.i -> size.u1, show_i.i", "guard.y -> size.u2",
            "power_limit.y -> voltage_limit.u1", "size.y -> voltage_limit.u2",
            "wanted.y -> voltage.u1", "voltage_limit.y -> voltage.u2", "voltage.y -> source.v, show_v.v",
            "source.p <-> ammeter.p", "ammeter.n <-> motor.p", "source.n <-> motor.n <-> ground.p",
            "speed.y -> shaft.w", "shaft.r <-> motor.r", "shaft.c <-> motor.c <-> housing.r","#,
    )
}

/// v = i R + k w and v i = P, unless that asks for more than 48 V.
#[test]
fn limited_power_has_the_steady_states_of_the_quadratic_equation() {
    for (speed, v, i) in
        [(0.0, 14.1421, 14.1421), (100.0, 20.0, 10.0), (300.0, 35.6155, 5.6155), (450.0, 48.0, 3.0)]
    {
        let run = limited_motor(speed, "50 ms");
        // References to four places; after 25 electrical time constants nothing of the start is left.
        close(run.last("show_v.v"), v, 1e-4, &format!("voltage at {speed} rad/s"));
        close(run.last("show_i.i"), i, 1e-4, &format!("current at {speed} rad/s"));
    }
}

/// Seconds until the current (A) is reached at a speed of 100 rad/s: with `L = 2 mH`, first `L i' = 38 V - R i`, and from
/// 200 W / 48 V on `L i i' = -(i - 10 A)(i + 20 A) R`, which is integrated by partial fractions.
fn time_of(i: f64) -> f64 {
    let (limit, l) = (200.0 / 48.0, 2e-3);
    let free = |i: f64| -l * f64::ln(1.0 - i / 38.0);
    if i <= limit {
        return free(i);
    }
    let limited =
        f64::ln((10.0 - limit) / (10.0 - i)) / 3.0 - 2.0 / 3.0 * f64::ln((i + 20.0) / (limit + 20.0));
    free(limit) + l * limited
}

#[test]
fn limited_power_sets_in_as_its_closed_form_and_without_chatter() {
    let run = limited_motor(100.0, "4 ms");
    assert_eq!(run.column("show_v.v")[0], 48.0, "without current nothing is limited");
    for ((t, v), i) in run.time.iter().zip(run.column("show_v.v")).zip(run.column("show_i.i")) {
        // A relative tolerance of 1e-8 for currents of 10 A; at the end of the run an ampere takes 0.05 s.
        close(time_of(*i), *t, 1e-8, "time of a current");
        close(*v, f64::min(48.0, 200.0 / i.max(0.004)), 1e-9, "voltage");
    }
    for (t, v, i) in [(2e-3, 20.557, 9.7293), (4e-3, 20.027, 9.9868)] {
        let until = limited_motor(100.0, &format!("{t} s"));
        // These references come from steps of 10 us and carry their error.
        close(until.last("show_v.v"), v, 3e-3, &format!("voltage at {t} s"));
        close(until.last("show_i.i"), i, 2e-3, &format!("current at {t} s"));
    }
    // The current passes the guard once and the limit once. A loop that chatters would stop there again and again.
    assert!(run.counts.events <= 3, "{} events", run.counts.events);
    assert!(run.counts.accepted < 300, "{} steps", run.counts.accepted);
}

const MACHINE: &str = r#"AsynchronousMachine(
    rated_power: "15 kVA", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1,
    r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm")"#;

/// A machine at the mains whose rotor is turned at a given speed, until the transient has died.
fn at_slip(slip: f64) -> Run {
    let speed = 120.0 * std::f64::consts::PI * (1.0 - slip);
    diagram(
        r#"stop_time: "12 s", solver: Ode45(rtol: 1e-9), output: Every("1 s")"#,
        &format!(
            r#""mains": ThreePhaseSource(voltage: "220 V", frequency: "60 Hz"), "machine": {MACHINE},
            "speed": Constant(value: "{speed} rad/s"), "drive": IdealSpeedSource, "rotor": Inertia(j: "0.1 kg*m^2"),
            "housing": RotationalReference, "t": Scope(inputs: ["tau"]), "i": Scope(inputs: ["i"]),
            "s": Scope(inputs: ["s"]), "p": Scope(inputs: ["p"]), "held": Scope(inputs: ["tau"])"#
        ),
        r#""mains.ac <-> machine.ac", "speed.y -> drive.w", "machine.r <-> rotor.r <-> drive.r",
        "machine.c <-> drive.c <-> housing.r", "machine.torque -> t.tau", "machine.i_rms -> i.i",
        "machine.slip -> s.s", "machine.power -> p.p", "drive.tau -> held.tau""#,
    )
}

/// Reference: the equivalent circuit of the machine, solved with complex numbers.
#[test]
fn torque_and_current_over_slip_are_those_of_the_equivalent_circuit() {
    let table = [
        (1.0, 27.9282, 162.1535, 0.2826),
        (0.5, 52.2009, 156.7729, 0.3683),
        (0.2, 98.6726, 136.4127, 0.5682),
        (0.1, 114.4242, 104.1236, 0.7460),
        (0.05, 90.3758, 66.0613, 0.8565),
        (0.03, 63.4633, 43.8308, 0.8769),
        (0.02, 45.1793, 31.4351, 0.8567),
        (0.01, 23.8398, 19.2239, 0.7302),
        // Pull-out.
        (0.108_714, 114.7643, f64::NAN, f64::NAN),
    ];
    for (slip, torque, current, power_factor) in table {
        let run = at_slip(slip);
        // References to four places. The slowest transient, that of the flux at standstill, takes
        // L_m (1 / R_s + 1 / R_r) = 0.5 s to fall to a third and is gone after 12 s.
        close(run.last("t.tau"), torque, 1e-4, &format!("torque at slip {slip}"));
        close(run.last("s.s"), slip, 1e-12, "slip");
        close(run.last("held.tau"), -torque, 1e-4, "torque of the source that holds the speed");
        if current.is_finite() {
            close(run.last("i.i"), current, 1e-4, &format!("current at slip {slip}"));
            let power = 3.0 * 220.0 * run.last("i.i") * power_factor;
            // The power factor is known to four places, 5e-5 of at least 0.28.
            close(run.last("p.p"), power, 2e-4 * power, &format!("power at slip {slip}"));
        }
    }
}

/// A machine that turns an inertia against a load, and ends in its steady state.
fn loaded(voltage: f64, frequency: f64, load: f64, stop: f64) -> Run {
    diagram(
        &format!(r#"stop_time: "{stop} s", solver: Ode45(rtol: 1e-9), output: Every("0.5 s")"#),
        &format!(
            r#""mains": ThreePhaseSource(voltage: "{voltage} V", frequency: "{frequency} Hz"), "machine": {MACHINE},
            "load": Step(time: "1.5 s", after: "-{load} N*m"), "brake": IdealTorqueSource,
            "rotor": Inertia(j: "0.1 kg*m^2"), "encoder": MotionSensor, "housing": RotationalReference,
            "w": Scope(inputs: ["w"]), "i": Scope(inputs: ["i"]), "s": Scope(inputs: ["true", "rated"])"#
        ),
        r#""mains.ac <-> machine.ac", "load.y -> brake.tau", "machine.r <-> rotor.r <-> brake.r <-> encoder.r",
        "machine.c <-> brake.c <-> encoder.c <-> housing.r", "encoder.w -> w.w", "machine.i_rms -> i.i",
        "machine.slip -> s.true", "machine.slip_rated -> s.rated""#,
    )
}

#[test]
fn a_loaded_machine_ends_where_the_equivalent_circuit_says() {
    let run = loaded(220.0, 60.0, 20.0, 4.0);
    close(run.last("w.w"), 373.852_70, 1e-5, "speed with 20 N m");
    close(run.last("s.true"), 0.008_324_9, 1e-7, "slip with 20 N m");
    close(run.last("i.i"), 17.406_67, 1e-5, "current with 20 N m");
}

#[test]
fn at_half_the_frequency_and_voltage_the_slip_keeps_its_size_in_speed() {
    let run = loaded(110.0, 30.0, 10.0, 4.0);
    // References to three and five places.
    close(run.last("w.w"), 186.932, 1e-3, "speed at 30 Hz");
    close(run.last("s.rated"), 0.504_15, 1e-5, "slip against the rated frequency");
    close(run.last("s.true"), 0.008_29, 1e-5, "slip against the supply");
}

#[test]
fn with_two_phases_exchanged_the_machine_turns_backwards() {
    let run = loaded(220.0, -60.0, 0.0, 4.0);
    close(run.last("w.w"), -376.9911, 1e-4, "speed");
    close(run.last("s.rated"), 2.0, 1e-6, "slip against the rated frequency");
}

/// The law of friction (breakaway 25, Coulomb 20, viscous 0.001, breakaway velocity 0.1), evaluated separately.
#[test]
fn the_torque_that_turns_a_bearing_is_its_friction() {
    let table = [
        (0.001, 2.075_792_8),
        (0.005, 9.654_013_6),
        (0.01, 16.052_142_2),
        (0.05, 23.635_712_6),
        (0.1, 25.000_099_9),
        (0.2, 22.231_501_6),
        (0.5, 20.000_653_7),
        (1.0, 20.001),
    ];
    for (speed, torque) in table.into_iter().flat_map(|(w, t)| [(w, t), (-w, -t)]) {
        let run = diagram(
            r#"stop_time: "10 ms""#,
            &format!(
                r#""w": Constant(value: "{speed} rad/s"), "turn": IdealSpeedSource, "housing": RotationalReference,
                "bearing": RotationalFriction(breakaway: "25 N*m", breakaway_velocity: "0.1 rad/s", coulomb: "20 N*m",
                    viscous: "0.001 N*m*s/rad"), "sensor": TorqueSensor, "show": Scope(inputs: ["source", "sensor"])"#
            ),
            r#""w.y -> turn.w", "turn.r <-> sensor.r", "sensor.c <-> bearing.r", "turn.c <-> bearing.c <-> housing.r",
            "turn.tau -> show.source", "sensor.tau -> show.sensor""#,
        );
        // References to seven places.
        close(run.last("show.source"), torque, 1e-7, &format!("torque of the source at {speed} rad/s"));
        close(run.last("show.sensor"), torque, 1e-7, &format!("torque through the sensor at {speed} rad/s"));
    }
}

/// The published law of loss with efficiencies 0.8 and 0.7 and a threshold of 1 mW, evaluated separately for a torque of
/// 1 N m at the base: then the power is the speed.
#[test]
fn the_loss_of_a_gear_is_that_of_the_published_law() {
    let table = [
        (-1.0, -0.428_571_4),
        (-1e-3, -0.428_360_6),
        (-1e-4, -0.233_698_2),
        (0.0, -0.114_285_7),
        (1e-4, 0.005_126_8),
        (2.5e-4, 0.125_072_4),
        (1e-3, 0.199_789_2),
        (1.0, 0.2),
    ];
    for (speed, loss) in table {
        let follower = 1.0 - loss;
        let run = diagram(
            r#"stop_time: "10 ms""#,
            &format!(
                r#""w": Constant(value: "{speed} rad/s"), "turn": IdealSpeedSource, "housing": RotationalReference,
                "gear": CycloidalDrive(disc_teeth: 1, ring_teeth: 2, direction: Same, efficiency_forward: 0.8,
                    efficiency_backward: 0.7, loss: Published, power_threshold: "1e-3 W"),
                "tau": Constant(value: "-{follower} N*m"), "load": IdealTorqueSource, "mass": Inertia(j: "1 kg*m^2"),
                "show": Scope(inputs: ["gear", "source"])"#
            ),
            r#""w.y -> turn.w", "turn.r <-> gear.base", "gear.follower <-> load.r <-> mass.r", "tau.y -> load.tau",
            "turn.c <-> load.c <-> housing.r", "gear.tau -> show.gear", "turn.tau -> show.source""#,
        );
        // References to seven places, and a root that is found to 1e-9.
        close(run.last("show.gear"), 1.0, 3e-7, &format!("torque into the base at {speed} rad/s"));
        close(run.last("show.source"), 1.0, 3e-7, &format!("torque of the source at {speed} rad/s"));
    }
}

/// A swing of one radian per second: it passes a value near its turning point upwards and, soon after, downwards. Between
/// the two lies less than a fiftieth of the step that the solver would take.
#[test]
fn crossings_of_a_value_near_the_peak_of_a_swing_are_counted_in_their_direction() {
    let run = diagram(
        r#"stop_time: "40 s", solver: Ode45(rtol: 1e-10, atol: 1e-12)"#,
        r#""v": Integrator(x0: 1), "x": Integrator, "back": Gain(k: -1), "any": HitCrossing(at: 0.99998),
           "up": HitCrossing(at: 0.99998, direction: Rising), "down": HitCrossing(at: 0.99998, direction: Falling),
           "n": Scope(inputs: ["any", "up", "down"]), "t": Scope(inputs: ["up", "down"])"#,
        r#""x.y -> back.u, any.u, up.u, down.u", "back.y -> v.u", "v.y -> x.u", "any.count -> n.any",
           "up.count -> n.up", "down.count -> n.down", "up.time -> t.up", "down.time -> t.down""#,
    );
    assert_eq!(["n.any", "n.up", "n.down"].map(|name| run.last(name)), [14.0, 7.0, 7.0]);
    let (half, peak) = (0.99998_f64.acos(), std::f64::consts::FRAC_PI_2 + 12.0 * std::f64::consts::PI);
    close(run.last("t.up"), peak - half, 1e-5, "the last time upwards");
    close(run.last("t.down"), peak + half, 1e-5, "the last time downwards");
}
