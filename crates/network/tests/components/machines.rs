//! Induction machines on the mains and on inverters. The reference machine: 15 kVA, 220 V, 60 Hz, one pole
//! pair, delta.

use std::f64::consts::{PI, TAU};

use crate::plant::{Plant, close};

/// The reference machine with further parameters.
fn machine(more: &str) -> String {
    format!(
        "AsynchronousMachine(rated_power: 15e3, rated_voltage: 220.0, rated_frequency: 60.0, pole_pairs: 1, \
         r_s: 0.25, x_ls: 0.9, r_r: 0.14, x_lr: 0.41, x_m: 17.0, x_0: 0.9{more})"
    )
}

/// The machine at a prescribed speed.
fn driven(source: &str, more: &str) -> Plant {
    Plant::new(
        &[
            ("source", source),
            ("machine", &machine(more)),
            ("turn", "IdealSpeedSource"),
            ("frame", "RotationalReference"),
        ],
        &["source.ac <-> machine.ac", "machine.r <-> turn.r", "machine.c <-> turn.c <-> frame.r"],
    )
}

/// The machine with an inertia of 0.1 kg*m^2 and a load.
fn free(source: &str, more: &str, w0: f64) -> Plant {
    Plant::new(
        &[
            ("source", source),
            ("machine", &machine(more)),
            ("rotor", &format!("Inertia(j: 0.1, w0: {w0:?})")),
            ("load", "IdealTorqueSource"),
            ("encoder", "MotionSensor"),
            ("frame", "RotationalReference"),
        ],
        &[
            "source.ac <-> machine.ac",
            "machine.r <-> rotor.r <-> load.r <-> encoder.r",
            "machine.c <-> load.c <-> encoder.c <-> frame.r",
        ],
    )
}

const MAINS: &str = "ThreePhaseSource(voltage: 220.0, frequency: 60.0)";
const INVERTER: &str = "AveragedInverter(vdc: 400.0)";

#[test]
fn transients_die_out_into_the_equivalent_circuit() {
    // Slip, torque (N*m), RMS phase current (A), power factor. At standstill the main flux dies out in half a
    // second.
    for (slip, torque, current, factor) in [
        (1.0, 27.9282, 162.1535, 0.2826),
        (0.1, 114.4242, 104.1236, 0.7460),
        (0.02, 45.1793, 31.4351, 0.8567),
    ] {
        let mut plant = driven(MAINS, "");
        plant.set("turn.w", (1.0 - slip) * 120.0 * PI).run_to(10.0, 2e-4);
        close(plant.get("machine.torque"), torque, 6e-5);
        close(plant.get("turn.tau"), -torque, 6e-5);
        close(plant.get("machine.i_rms"), current, 6e-5);
        close(plant.get("source.power") / (660.0 * plant.get("machine.i_rms")), factor, 6e-5);
        close(plant.get("machine.slip"), slip, 1e-12);
        close(plant.get("machine.slip_rated"), slip, 1e-12);
    }
}

#[test]
fn a_magnetised_machine_starts_in_its_steady_state() {
    let mut plant = driven(MAINS, ", start: Magnetised(voltage: 220.0, frequency: 60.0, slip: 0.05)");
    plant.set("turn.w", 0.95 * 120.0 * PI);
    assert!(plant.bench.derivatives().iter().all(|change| change.abs() < 1e-9));
    close(plant.get("machine.torque"), 90.3758, 6e-5);
    plant.run_to(0.1, 1e-4);
    close(plant.get("machine.torque"), 90.3758, 6e-5);
}

#[test]
fn power_from_the_lines_becomes_heat_and_mechanical_power() {
    let slip = 0.03;
    let mut plant = driven(MAINS, ", start: Magnetised(voltage: 220.0, frequency: 60.0, slip: 0.03)");
    plant.set("turn.w", (1.0 - slip) * 120.0 * PI);
    let gap = plant.get("machine.torque") * 120.0 * PI;
    let copper = 3.0 * 0.25 * plant.get("machine.i_rms").powi(2);
    close(plant.get("machine.power"), gap + copper, 1e-8);
    close(plant.get("source.power"), gap + copper, 1e-8);
}

#[test]
fn a_start_on_the_mains_follows_the_reference_run() {
    // Time (s), speed (rad/s), torque (N*m): classical Runge-Kutta with 50 us, made elsewhere in the frame of
    // the rated frequency with phase quantities.
    let reference = [
        (0.005, 0.2142, 18.999),
        (0.01, 3.2647, 102.776),
        (0.02, 7.3350, -56.699),
        (0.05, 17.8017, 26.009),
        (0.1, 29.4541, 75.113),
        (0.2, 53.1758, 15.282),
        (0.5, 167.6186, 47.451),
        (0.9, 375.7814, 4.190),
    ];
    let mut plant = free(MAINS, "", 0.0);
    for (t, w, torque) in reference {
        plant.run_to(t, 5e-5);
        close(plant.get("encoder.w"), w, 1e-4);
        close(plant.get("machine.torque"), torque, 1e-3);
    }
}

#[test]
fn a_loaded_machine_settles_where_the_equivalent_circuit_says() {
    let mut plant = free(MAINS, ", start: Magnetised(voltage: 220.0, frequency: 60.0, slip: 0.008)", 373.9);
    plant.set("load.tau", -20.0).run_to(2.0, 2e-4);
    close(plant.get("encoder.w"), 373.852_70, 6e-6);
    close(plant.get("machine.slip"), 0.008_324_9, 6e-8);
    close(plant.get("machine.i_rms"), 17.406_67, 6e-6);
}

#[test]
fn at_half_frequency_and_voltage_the_two_slips_differ() {
    let mut plant =
        free(INVERTER, ", start: Magnetised(voltage: 110.0, frequency: 30.0, slip: 0.008)", 187.0);
    plant.set("source.v", 110.0 * (2.0_f64 / 3.0).sqrt()).set("source.f", 30.0).set("load.tau", -10.0);
    plant.run_to(3.0, 2e-4);
    close(plant.get("encoder.w"), 186.932, 6e-4);
    close(plant.get("machine.slip_rated"), 0.504_15, 6e-6);
    close(plant.get("machine.slip"), 0.008_29, 6e-6);
}

#[test]
fn exchanged_phases_turn_the_machine_the_other_way() {
    let mut mains = free("ThreePhaseSource(voltage: 220.0, frequency: -60.0)", "", 0.0);
    mains.run_to(2.0, 2e-4);
    close(mains.get("encoder.w"), -376.9911, 6e-5);
    close(mains.get("machine.slip_rated"), 2.0, 1e-6);
    close(mains.get("machine.slip"), 0.0, 1e-6);
}

#[test]
fn a_reverser_and_a_negative_frequency_start_a_machine_alike() {
    let (mut reversed, mut negative) = (free(INVERTER, "", 0.0), free(INVERTER, "", 0.0));
    reversed.set("source.v", 150.0).set("source.f", 50.0).set("source.reverse", 1.0);
    negative.set("source.v", 150.0).set("source.f", -50.0);
    for t in [0.01, 0.05, 0.2] {
        let torque = reversed.run_to(t, 1e-4).get("machine.torque");
        close(negative.run_to(t, 1e-4).get("machine.torque"), torque, 1e-9);
        assert!(reversed.get("encoder.w") < 0.0);
    }
}

/// A machine in the frame of the stator, with volts, amperes and three windings, as a second source: peak
/// phase voltage 150 V at 50 Hz, phases exchanged after 0.1 s. Returns the torque at `end`.
fn torque_by_phases(end: f64, h: f64) -> f64 {
    let w_n = TAU * 60.0;
    let (r_s, r_r) = (0.25, 0.14);
    let (l_m, l_s, l_r) = (17.0 / w_n, 17.9 / w_n, 17.41 / w_n);
    let determinant = l_s * l_r - l_m * l_m;
    let currents = |psi: &[f64; 4]| {
        [0, 1, 2, 3].map(|i| {
            let (own, other, l) = if i < 2 { (psi[i], psi[i + 2], l_r) } else { (psi[i], psi[i - 2], l_s) };
            (l * own - l_m * other) / determinant
        })
    };
    let torque = |x: &[f64; 5]| {
        let psi = [x[0], x[1], x[2], x[3]];
        let i = currents(&psi);
        1.5 * (psi[0] * i[1] - psi[1] * i[0])
    };
    let slope = |t: f64, swapped: bool, x: &[f64; 5]| -> [f64; 5] {
        let theta = TAU * 50.0 * t;
        let phase = |lag: f64| 150.0 * (theta - lag).cos();
        let (a, b, c) = (phase(0.0), phase(TAU / 3.0), phase(2.0 * TAU / 3.0));
        let (b, c) = if swapped { (c, b) } else { (b, c) };
        let windings = [a - b, b - c, c - a];
        let v = [
            2.0 / 3.0 * (windings[0] - 0.5 * windings[1] - 0.5 * windings[2]),
            (windings[1] - windings[2]) / 3.0_f64.sqrt(),
        ];
        let psi = [x[0], x[1], x[2], x[3]];
        let i = currents(&psi);
        let w = x[4];
        [
            v[0] - r_s * i[0],
            v[1] - r_s * i[1],
            -r_r * i[2] - w * psi[3],
            -r_r * i[3] + w * psi[2],
            torque(x) / 0.1,
        ]
    };
    let steps = (end / h).round() as usize;
    let mut x = [0.0; 5];
    for step in 0..steps {
        let t = step as f64 * h;
        let swapped = t > 0.1 - 0.5 * h;
        let moved =
            |x: &[f64; 5], k: &[f64; 5], h: f64| -> [f64; 5] { std::array::from_fn(|i| x[i] + h * k[i]) };
        let k1 = slope(t, swapped, &x);
        let k2 = slope(t + 0.5 * h, swapped, &moved(&x, &k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, swapped, &moved(&x, &k2, 0.5 * h));
        let k4 = slope(t + h, swapped, &moved(&x, &k3, h));
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    torque(&x)
}

#[test]
fn exchanging_two_phases_while_the_machine_runs_agrees_with_three_windings() {
    let mut plant = free(INVERTER, "", 0.0);
    plant.set("source.v", 150.0).set("source.f", 50.0);
    close(plant.run_to(0.1, 5e-5).get("machine.torque"), torque_by_phases(0.1, 5e-5), 1e-6);
    plant.set("source.reverse", 1.0);
    for t in [0.103, 0.11, 0.15] {
        close(plant.run_to(t, 5e-5).get("machine.torque"), torque_by_phases(t, 5e-5), 1e-5);
    }
}

#[test]
fn measurements_in_per_unit_are_those_of_the_windings_at_the_rated_frequency() {
    // Winding a in delta leads phase a by 30 degrees: with phase a at -30 degrees its voltage is a cosine.
    let source = format!("ThreePhaseSource(voltage: 220.0, frequency: 60.0, phase: {:?})", -PI / 6.0);
    let mut plant = driven(&source, "");
    plant.set("turn.w", 300.0).run_to(0.123, 1e-4);
    close(plant.get("machine.pu_vds"), 1.0, 1e-9);
    close(plant.get("machine.pu_vqs"), 0.0, 1e-9);
    let power = plant.get("machine.pu_ids");
    close(plant.get("machine.power"), 15e3 * power, 1e-6);
    close(plant.get("machine.pu_velocity"), 300.0 / (120.0 * PI), 1e-12);
    close(plant.get("machine.pu_torque") * 39.788_74, plant.get("machine.torque"), 1e-3);
}

#[test]
fn two_machines_on_one_source_do_not_see_each_other() {
    let one = machine("");
    let mut plant = Plant::new(
        &[
            ("source", MAINS),
            ("a", &one),
            ("b", &one),
            ("turn", "IdealSpeedSource"),
            ("rest", "RotationalReference"),
        ],
        &["source.ac <-> a.ac <-> b.ac", "a.r <-> turn.r", "b.r <-> b.c <-> a.c <-> turn.c <-> rest.r"],
    );
    plant.set("turn.w", 0.98 * 120.0 * PI).run_to(10.0, 2e-4);
    close(plant.get("a.torque"), 45.1793, 1e-4);
    close(plant.get("b.torque"), 27.9282, 1e-4);
    close(plant.get("source.power"), plant.get("a.power") + plant.get("b.power"), 1e-9);
}
