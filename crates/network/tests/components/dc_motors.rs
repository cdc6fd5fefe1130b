//! Motors with brushes, their sources and sensors.

use crate::plant::{Plant, close};

const BLOCKED: [&str; 3] = [
    "source.p <-> ammeter.p <-> voltmeter.p",
    "ammeter.n <-> motor.p",
    "source.n <-> motor.n <-> voltmeter.n <-> ground.p",
];

/// A motor at a prescribed speed.
fn driven(motor: &str) -> Plant {
    let mut connections = BLOCKED.to_vec();
    connections.extend(["motor.r <-> turn.r", "motor.c <-> turn.c <-> frame.r"]);
    Plant::new(
        &[
            ("source", "ControlledVoltageSource"),
            ("ammeter", "CurrentSensor"),
            ("voltmeter", "VoltageSensor"),
            ("motor", motor),
            ("ground", "ElectricalReference"),
            ("turn", "IdealSpeedSource"),
            ("frame", "RotationalReference"),
        ],
        &connections,
    )
}

/// A motor that starts from rest against its own inertia and damping.
fn free(motor: &str) -> Plant {
    let mut connections = BLOCKED.to_vec();
    connections.extend(["motor.r <-> encoder.r", "motor.c <-> encoder.c <-> frame.r"]);
    Plant::new(
        &[
            ("source", "VoltageSource(v: 24.0)"),
            ("ammeter", "CurrentSensor"),
            ("voltmeter", "VoltageSensor"),
            ("motor", motor),
            ("ground", "ElectricalReference"),
            ("encoder", "MotionSensor"),
            ("frame", "RotationalReference"),
        ],
        &connections,
    )
}

#[test]
fn readings_of_states_are_the_same_whoever_reads_them() {
    let blocks = [
        ("source", "VoltageSource(v: 24.0)"),
        ("ammeter", "CurrentSensor"),
        ("motor", "DcMotor(r: 0.5, l: 2e-3, k: 0.1, j: 1e-3)"),
        ("ground", "ElectricalReference"),
        ("turn", "IdealSpeedSource"),
        ("frame", "RotationalReference"),
    ];
    let connections = [
        "source.p <-> ammeter.p",
        "ammeter.n <-> motor.p",
        "source.n <-> motor.n <-> ground.p",
        "motor.r <-> turn.r",
        "motor.c <-> turn.c <-> frame.r",
    ];
    // At standstill the current rises with the time constant of the winding.
    let expected = 24.0 / 0.5 * (1.0 - (-0.003_f64 / (2e-3 / 0.5)).exp());
    for read in [&[][..], &["ammeter.i"], &["motor.i"], &["ammeter.i", "motor.i"]] {
        let mut plant = Plant::read_at(&blocks, &connections, read);
        plant.run_to(0.003, 1e-5);
        for name in ["ammeter.i", "motor.i"] {
            close(plant.get(name), expected, 1e-9);
        }
        // A drive that asks for one of them between major steps does not pay for the other.
        let apart = plant.group("ammeter.i") != plant.group("motor.i");
        assert_eq!(apart, read.len() == 1, "{read:?}");
    }
}

#[test]
fn without_inductance_a_motor_starts_exponentially() {
    let mut plant = free("DcMotor(r: 0.5, l: 0.0, k: 0.1, j: 1e-3)");
    let time_constant = 1e-3 * 0.5 / 0.01;
    close(plant.get("motor.i"), 48.0, 1e-12);
    plant.run_to(time_constant, 1e-5);
    close(plant.get("encoder.w"), 240.0 * (1.0 - (-1.0_f64).exp()), 1e-9);
    close(plant.get("ammeter.i"), 48.0 * (-1.0_f64).exp(), 1e-10);
    close(plant.get("voltmeter.v"), 24.0, 1e-13);
}

#[test]
fn with_inductance_current_and_speed_follow_the_two_eigenvalues() {
    let (r, l, k, j) = (0.5_f64, 2e-3, 0.1, 1e-3);
    let mut plant = free("DcMotor(r: 0.5, l: 2e-3, k: 0.1, j: 1e-3)");
    let (a, b) = (r / l, k * k / (l * j));
    let root = (a * a / 4.0 - b).sqrt();
    let (fast, slow) = (-a / 2.0 - root, -a / 2.0 + root);
    let t: f64 = 0.02;
    plant.run_to(t, 1e-5);
    let current = 24.0 / l * ((slow * t).exp() - (fast * t).exp()) / (slow - fast);
    close(plant.get("ammeter.i"), current, 1e-9);
    let speed = 240.0 * (1.0 - (slow * (fast * t).exp() - fast * (slow * t).exp()) / (slow - fast));
    close(plant.get("encoder.w"), speed, 1e-8);
}

#[test]
fn torque_and_speed_in_the_steady_state_are_on_the_line_of_the_motor() {
    let mut plant = free("DcMotor(r: 0.5, l: 1e-3, k: 0.1, j: 1e-4, damping: 0.002)");
    plant.run_to(1.0, 1e-4);
    let w = 24.0 * 0.1 / (0.1 * 0.1 + 0.5 * 0.002);
    close(plant.get("encoder.w"), w, 1e-9);
    close(plant.get("motor.i"), 0.002 * w / 0.1, 1e-10);
}

#[test]
fn a_limit_of_power_has_its_closed_form() {
    // R = 1 ohm, k = 0.1, P = 200 W, V_max = 48 V: speed, voltage, current.
    let mut plant = driven("DcMotor(r: 1.0, l: 0.0, k: 0.1, j: 1e-4)");
    for (w, v, i) in
        [(0.0, 14.1421, 14.1421), (100.0, 20.0, 10.0), (300.0, 35.6155, 5.6155), (450.0, 48.0, 3.0)]
    {
        let e = 0.1_f64 * w;
        let limited = f64::min(48.0, 0.5 * (e + (e * e + 4.0 * 200.0).sqrt()));
        close(limited, v, 1e-4);
        plant.set("turn.w", w).set("source.v", limited);
        close(plant.get("ammeter.i"), i, 1e-4);
        assert!(plant.get("voltmeter.v") * plant.get("ammeter.i") < 200.0 + 1e-9);
        close(plant.get("turn.tau"), -0.1 * plant.get("motor.i"), 1e-13);
    }
}

#[test]
fn a_limit_of_power_that_reads_the_current_of_an_inductance_settles() {
    let mut plant = driven("DcMotor(r: 1.0, l: 2e-3, k: 0.1, j: 1e-4)");
    assert_eq!(plant.read_by("ammeter.i"), ["turn.w", "turn.dw"], "a speed source is all it waits for");
    let limiter = |i: f64| f64::min(48.0, 200.0 / i.abs().max(1e-3));
    plant.set("turn.w", 100.0);
    let (state, h) = (plant.state("motor.i"), 1e-5);
    let slope = |plant: &mut Plant, i: f64| {
        plant.bench.x[state] = i;
        plant.set("source.v", limiter(i)).bench.derivatives()[state]
    };
    let mut i = 0.0;
    for step in 1..=400 {
        let k1 = slope(&mut plant, i);
        let k2 = slope(&mut plant, i + 0.5 * h * k1);
        let k3 = slope(&mut plant, i + 0.5 * h * k2);
        let k4 = slope(&mut plant, i + h * k3);
        i += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        // Current and voltage after 2 ms and 4 ms, integrated elsewhere with steps of 0.1 us.
        if step == 200 {
            close(i, 9.728_075, 1e-5);
            close(limiter(i), 20.559_05, 1e-5);
        }
    }
    close(i, 9.986_694, 1e-5);
    close(limiter(i), 20.026_65, 1e-5);
}

#[test]
fn an_ammeter_waits_for_the_voltage_only_where_nothing_holds_the_current() {
    let reads = |motor: &str| driven(motor).read_by("ammeter.i");
    assert!(!reads("DcMotor(r: 1.0, l: 2e-3, k: 0.1, j: 1e-4)").contains(&"source.v".to_owned()));
    assert!(reads("DcMotor(r: 1.0, l: 0.0, k: 0.1, j: 1e-4)").contains(&"source.v".to_owned()));
}
