//! Stepper motors and their drivers in whole diagrams, against closed forms and an integration written here.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{Run, close, run_file, run_text};

/// Arithmetic-geometric mean: `K(k) = pi / (2 agm(1, sqrt(1 - k^2)))`.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..8 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    a
}

/// A motor of 50 teeth with 0.22 N*m/A and 3e-5 kg*m^2 between voltage sources that a driver commands.
fn driven(stop: &str, every: &str, driver: &str, motor: &str, more: &str, connections: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-10, atol: 1e-10), output: Every("{every}")),
    blocks: {{
        "driver": {driver},
        "va": ControlledVoltageSource, "vb": ControlledVoltageSource, "g": ElectricalReference,
        "motor": StepperMotor(teeth: 50, k: "0.22 N*m/A", j: "3e-5 kg*m^2", {motor}),
        "frame": RotationalReference, "encoder": MotionSensor,
        "s": Scope(inputs: ["theta", "w", "i_a", "i_b", "torque"]), "count": Scope(inputs: ["n"]),
        {more}
    }},
    connections: [
        "driver.a -> va.v", "driver.b -> vb.v", "driver.position -> count.n",
        "va.p <-> motor.a_p", "vb.p <-> motor.b_p", "va.n <-> motor.a_n <-> vb.n <-> motor.b_n <-> g.p",
        "motor.r <-> encoder.r", "motor.c <-> encoder.c <-> frame.r",
        "motor.theta -> s.theta", "encoder.w -> s.w", "motor.i_a -> s.i_a", "motor.i_b -> s.i_b",
        "motor.torque -> s.torque", {connections}
    ],
)"#
    ))
}

/// Held by a current that nothing changes, the rotor is a pendulum: `j theta'' = -k i sin(N theta)`. A current of 2 A from
/// 2 GV through 1 GOhm does not notice the voltage that is induced, which damps by 3e-8 in five periods.
#[test]
fn the_rotor_swings_about_its_place_with_the_period_of_the_pendulum() {
    let small = (0.22 * 2.0 * 50.0_f64 / 3e-5).sqrt();
    for amplitude in [0.01_f64, 0.5, 2.0] {
        let period = TAU / small / agm(1.0, (0.5 * amplitude).cos());
        let run = driven(
            &format!("{} s", 5.0 * period),
            "10 us",
            r#"StepperDriver(amplitude: "2 GV", drive: Wave)"#,
            &format!(r#"r: "1 GOhm", l: "0 H", theta0: "{} rad""#, amplitude / 50.0),
            r#""still": Constant(value: false)"#,
            r#""still.y -> driver.step""#,
        );
        // At the turning point the angle is blind to an error of time, the speed is not.
        let slope = 0.22 * 2.0 * amplitude.sin() / 3e-5;
        close(run.last("s.w") / slope / period, 0.0, 3e-6, "error of five periods");
        close(run.last("s.theta"), amplitude / 50.0, 3e-6 * amplitude, "angle after five periods");
    }
}

/// Without current the detent torque alone is the pendulum: `j theta'' = -T sin(4 N theta)`.
#[test]
fn magnets_alone_swing_with_their_own_period() {
    let small = (4.0 * 50.0 * 8e-3_f64 / 3e-5).sqrt();
    let period = TAU / small / agm(1.0, 0.4_f64.cos());
    let run = driven(
        &format!("{} s", 3.0 * period),
        "10 us",
        r#"StepperDriver(amplitude: "0 V")"#,
        r#"r: "1 GOhm", l: "0 H", detent: "8 mN*m", theta0: "0.004 rad""#,
        r#""still": Constant(value: false)"#,
        r#""still.y -> driver.step""#,
    );
    close(run.last("s.w") / (8e-3 * 0.8_f64.sin() / 3e-5) / period, 0.0, 1e-7, "error of three periods");
}

/// A slow turn in full steps: after each pulse the rotor stands a step further, by the pulses of a clock, forwards and back.
#[test]
fn every_pulse_is_a_step() {
    for (drive, positions, ahead) in
        [("Full", 1.0, 0.5), ("Wave", 1.0, 0.0), ("Half", 2.0, 0.0), ("Micro(8)", 8.0, 0.0)]
    {
        let run = driven(
            "1.6 s",
            "50 ms",
            &format!(r#"StepperDriver(amplitude: "2.4 V", drive: {drive})"#),
            r#"r: "1.2 Ohm", l: "2.4 mH", damping: "4e-3 N*m*s/rad""#,
            r#""clock": Pulse(period: "0.1 s", width: 0.5, delay: "0.05 s"), "is": Compare(operator: Greater, constant: 0.5),
               "back": Step(time: "1.0 s"), "is_back": Compare(operator: Greater, constant: 0.5)"#,
            r#""clock.y -> is.u", "is.y -> driver.step", "back.y -> is_back.u", "is_back.y -> driver.reverse""#,
        );
        // Ten pulses up to 1 s, six back.
        let step = TAU / 200.0;
        for (t, n) in [(0.949, 9.0), (1.049, 10.0), (1.149, 9.0), (1.549, 5.0), (1.6, 4.0)] {
            close(run.at("count.n", t), n, 0.0, "count");
            let row = run.time.iter().rposition(|at| *at <= t).expect("a row");
            let settled = run.column("s.theta")[row];
            close(settled, (n / positions + ahead) * step, 1e-5, &format!("{drive}: angle at {t} s"));
        }
    }
}

/// The classical method of order four.
fn step<const N: usize>(x: [f64; N], h: f64, slope: impl Fn([f64; N]) -> [f64; N]) -> [f64; N] {
    let ahead = |k: [f64; N], c: f64| std::array::from_fn(|i| x[i] + c * h * k[i]);
    let k1 = slope(x);
    let k2 = slope(ahead(k1, 0.5));
    let k3 = slope(ahead(k2, 0.5));
    let k4 = slope(ahead(k3, 1.0));
    std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// All parts of the law at once: inductance, induced voltage, detent, iron, damping.
#[test]
fn a_single_step_rings_as_an_integration_by_hand() {
    let run = driven(
        "60 ms",
        "1 ms",
        r#"StepperDriver(amplitude: "2.4 V", drive: Wave)"#,
        r#"r: "1.2 Ohm", l: "2.4 mH", detent: "8 mN*m", damping: "2e-4 N*m*s/rad", g_m: "20 mS", i_a0: "2 A""#,
        r#""pulse": Step(time: "10 ms"), "is": Compare(operator: Greater, constant: 0.5)"#,
        r#""pulse.y -> is.u", "is.y -> driver.step""#,
    );
    let (n, k, j) = (50.0, 0.22, 3e-5);
    let h = 1e-6;
    let mut x = [2.0, 0.0, 0.0, 0.0];
    for i in 1..=50_000 {
        x = step(x, h, |[i_a, i_b, w, theta]| {
            let (sin, cos) = f64::sin_cos(n * theta);
            let (e_a, e_b) = (-k * w * sin, k * w * cos);
            let torque = -k * (i_a - 0.02 * e_a) * sin + k * (i_b - 0.02 * e_b) * cos
                - 8e-3 * (4.0 * n * theta).sin()
                - 2e-4 * w;
            [(0.0 - 1.2 * i_a - e_a) / 2.4e-3, (2.4 - 1.2 * i_b - e_b) / 2.4e-3, torque / j, w]
        });
        if i % 1000 == 0 {
            let t = 0.01 + 1e-6 * f64::from(i);
            // Some hundred steps at 1e-10; the method written here is off by 1e-14.
            close(run.at("s.i_a", t), x[0], 1e-6, "current of phase A");
            close(run.at("s.i_b", t), x[1], 1e-6, "current of phase B");
            close(run.at("s.w", t), x[2], 1e-5, "speed");
            close(run.at("s.theta", t), x[3], 1e-8, "angle");
        }
    }
    let overshoot = run.column("s.theta").iter().fold(0.0_f64, |most, theta| most.max(*theta));
    assert!(overshoot > 1.01 * PI / 100.0, "it rings: {overshoot}");
}

#[test]
fn the_stepper_of_the_diagram_ends_where_its_count_says_less_the_pull_of_the_load() {
    let run = run_file("diagrams/stepper.ron", &[]);
    assert_eq!(run.last("count.positions"), 100.0);
    let position = TAU / 4.0;
    // At a whole step one phase holds, and the detent torque of four times its stiffness helps: k i sin x + T sin 4x = load.
    let mut x = 0.0_f64;
    for _ in 0..50 {
        x -= (0.44 * x.sin() + 8e-3 * (4.0 * x).sin() - 0.05) / (0.44 * x.cos() + 0.032 * (4.0 * x).cos());
    }
    close(run.last("angles.actual"), position - x / 50.0, 1e-6, "angle at rest");
    close(run.at("count.positions", 1.1), 200.0, 1.0, "half a turn forwards");
    let most = run.column("angles.actual").iter().fold(0.0_f64, |most, theta| most.max(*theta));
    close(most, PI, 0.02, "half a turn");
    // The rotor is never a step behind.
    let (wanted, actual) = (run.column("angles.wanted"), run.column("angles.actual"));
    assert!(wanted.iter().zip(actual).all(|(a, b)| (a - b).abs() < TAU / 200.0));
    // Microsteps end where their count says, too; too fast, the rotor falls out of step.
    let quiet = run_file("diagrams/stepper.ron", &["driver.drive=Micro(16)"]);
    assert_eq!(quiet.last("count.positions"), 800.0);
    close(quiet.last("angles.actual"), position - x / 50.0, 1e-6, "angle at rest with microsteps");
    let lost = run_file("diagrams/stepper.ron", &["speed=\"15 rad/s\""]);
    assert!(lost.at("angles.wanted", 1.09) - lost.at("angles.actual", 1.09) > 10.0, "it follows");
}

/// A phase in series with another inductance: their common node floats, and its potential follows from both.
#[test]
fn a_phase_in_series_with_a_coil_is_one_inductance() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "20 ms", solver: Ode45(rtol: 1e-10, atol: 1e-10), output: Every("1 ms")),
    blocks: {
        "u": VoltageSource(v: "12 V"), "coil": Inductor(l: "5 mH"), "g": ElectricalReference,
        "motor": StepperMotor(r: "1.2 Ohm", l: "2.4 mH", k: "0.22 N*m/A", j: "3e-5 kg*m^2", theta0: "0.01 rad"),
        "held": Inertia(j: "1e9 kg*m^2"), "frame": RotationalReference, "s": Scope(inputs: ["a", "b"]),
    },
    connections: [
        "u.p <-> coil.p", "coil.n <-> motor.a_p", "motor.a_n <-> u.n <-> motor.b_p <-> motor.b_n <-> g.p",
        "motor.r <-> held.r", "motor.c <-> frame.r", "motor.i_a -> s.a", "motor.i_b -> s.b",
    ],
)"#,
    );
    for (row, t) in run.time.iter().enumerate() {
        let expected = 10.0 * (1.0 - (-t * 1.2 / 7.4e-3).exp());
        close(run.column("s.a")[row], expected, 1e-7, "current of phase A");
        close(run.column("s.b")[row], 0.0, 1e-7, "current of phase B");
    }
}

/// A share of 0.2 of 12 V, by pulses, is 2.4 V; the rotor does not notice the ripple.
#[test]
fn two_h_bridges_hold_the_rotor_where_their_mean_voltages_do() {
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "0.329 s", solver: Ode45(rtol: 1e-8, atol: 1e-8), output: Every("1 ms")),
    blocks: {
        "clock": Pulse(period: "40 ms", width: 0.5, delay: "10 ms"), "is": Compare(operator: Greater, constant: 0.5),
        "driver": StepperDriver(amplitude: 0.2, drive: Micro(3)),
        "pwm_a": HBridgePwm(switching_frequency: "10 kHz"), "pwm_b": HBridgePwm(switching_frequency: "10 kHz"),
        "u": VoltageSource(v: "12 V"), "g": ElectricalReference,
        "bridge_a": HBridge(r_on: "0 Ohm"), "bridge_b": HBridge(r_on: "0 Ohm"),
        "motor": StepperMotor(r: "1.2 Ohm", l: "2.4 mH", k: "0.22 N*m/A", j: "3e-5 kg*m^2", damping: "4e-3 N*m*s/rad"),
        "frame": RotationalReference, "s": Scope(inputs: ["theta", "n"]),
    },
    connections: [
        "clock.y -> is.u", "is.y -> driver.step", "driver.a -> pwm_a.m", "driver.b -> pwm_b.m",
        "pwm_a.gates -> bridge_a.gates", "pwm_b.gates -> bridge_b.gates",
        "u.p <-> bridge_a.p <-> bridge_b.p", "u.n <-> bridge_a.n <-> bridge_b.n <-> g.p",
        "bridge_a.a <-> motor.a_p", "bridge_a.b <-> motor.a_n", "bridge_b.a <-> motor.b_p", "bridge_b.b <-> motor.b_n",
        "motor.c <-> frame.r", "motor.theta -> s.theta", "driver.position -> s.n",
    ],
)"#,
    );
    assert_eq!(run.last("s.n"), 8.0);
    // A microstep is 0.0105 rad.
    close(run.last("s.theta"), 8.0 * TAU / 600.0, 1e-5, "angle after eight microsteps");
}
