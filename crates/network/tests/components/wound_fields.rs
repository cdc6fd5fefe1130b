//! Motors with field windings, and motors that their data sheet describes.

use crate::plant::{Plant, close};

const SHAFT: [&str; 2] = ["motor.r <-> encoder.r <-> load.r", "motor.c <-> encoder.c <-> load.c <-> frame.r"];

/// A motor with two pins on a signal's voltage, free to turn.
fn free(motor: &str) -> Plant {
    let mut connections = vec!["source.p <-> motor.p", "source.n <-> motor.n <-> ground.p"];
    connections.extend(SHAFT);
    Plant::new(
        &[
            ("source", "ControlledVoltageSource"),
            ("motor", motor),
            ("load", "IdealTorqueSource"),
            ("encoder", "MotionSensor"),
            ("ground", "ElectricalReference"),
            ("frame", "RotationalReference"),
        ],
        &connections,
    )
}

/// The same at a prescribed speed.
fn driven(motor: &str) -> Plant {
    Plant::new(
        &[
            ("source", "ControlledVoltageSource"),
            ("motor", motor),
            ("turn", "IdealSpeedSource"),
            ("ground", "ElectricalReference"),
            ("frame", "RotationalReference"),
        ],
        &[
            "source.p <-> motor.p",
            "source.n <-> motor.n <-> ground.p",
            "motor.r <-> turn.r",
            "motor.c <-> turn.c <-> frame.r",
        ],
    )
}

#[test]
fn a_motor_given_by_its_rating_turns_at_its_rating() {
    for losses in ["", ", no_load_current: 0.3", ", damping: 5e-5"] {
        let mut plant = free(&format!(
            "DcMotorByRating(rated_power: 200.0, rated_speed: 300.0, no_load_speed: 340.0, voltage: 48.0, \
             l: 1.2e-3, j: 2e-4{losses})"
        ));
        plant.set("source.v", 48.0).run_to(1.0, 1e-4);
        close(plant.get("encoder.w"), 340.0, 1e-7);
        plant.set("load.tau", -200.0 / 300.0).run_to(2.0, 1e-4);
        close(plant.get("encoder.w"), 300.0, 1e-7);
    }
}

#[test]
fn a_motor_given_by_its_stall_torque_stands_under_it() {
    let data = "stall_torque: 0.9, no_load_speed: 500.0, voltage: 24.0, l: 6e-4, j: 2.5e-5, \
                no_load_current: 0.4";
    let mut plant = driven(&format!("DcMotorByStall({data})"));
    plant.set("source.v", 24.0).run_to(0.1, 1e-5);
    close(plant.get("turn.tau"), -0.9, 1e-10);
    plant.set("turn.w", 500.0).run_to(0.2, 1e-5);
    close(plant.get("turn.tau"), 0.0, 1e-10);
    close(plant.get("motor.i"), 0.4, 1e-10);
}

const UNIVERSAL: &str = "UniversalMotor(r: 4.0, l: 0.02, l_af: 0.12, j: 1e-4)";

#[test]
fn reversing_the_voltage_of_a_universal_motor_does_not_reverse_its_torque() {
    let (mut forward, mut reversed) = (free(UNIVERSAL), free(UNIVERSAL));
    forward.set("source.v", 50.0).set("load.tau", -0.2);
    reversed.set("source.v", -50.0).set("load.tau", -0.2);
    for t in [0.01, 0.05, 0.2] {
        let (w, i) = (forward.run_to(t, 1e-5).get("encoder.w"), forward.get("motor.i"));
        reversed.run_to(t, 1e-5);
        close(reversed.get("encoder.w"), w, 1e-12);
        close(reversed.get("motor.i"), -i, 1e-12);
        close(reversed.get("motor.torque"), forward.get("motor.torque"), 1e-12);
        assert!(w != 0.0 && i > 0.0);
    }
    assert!(reversed.get("encoder.w") > 50.0, "it turns forwards");
}

#[test]
fn a_universal_motor_under_load_settles_where_its_torque_is_the_load() {
    let mut plant = free(UNIVERSAL);
    plant.set("source.v", 50.0).set("load.tau", -0.3).run_to(2.0, 1e-4);
    let i = (0.3_f64 / 0.12).sqrt();
    close(plant.get("motor.i"), i, 1e-9);
    close(plant.get("encoder.w"), (50.0 / i - 4.0) / 0.12, 1e-7);
}

#[test]
fn on_alternating_voltage_the_mean_torque_is_that_of_the_rms_current() {
    // At a prescribed speed the circuit is linear: |Z| = |R + L_af w + j 2 pi f L|.
    let mut plant = driven(UNIVERSAL);
    let (w, f, amplitude) = (200.0, 50.0, 325.0);
    plant.set("turn.w", w);
    let h = 1.0 / (f * 400.0);
    let (state, omega) = (plant.state("motor.i"), std::f64::consts::TAU * f);
    let slope = |plant: &mut Plant, t: f64, i: f64| {
        plant.bench.x[state] = i;
        plant.set("source.v", amplitude * (omega * t).sin()).bench.derivatives()[state]
    };
    let (mut i, mut sum) = (0.0, 0.0);
    for step in 0..4000 {
        let t = f64::from(step) * h;
        let k1 = slope(&mut plant, t, i);
        let k2 = slope(&mut plant, t + 0.5 * h, i + 0.5 * h * k1);
        let k3 = slope(&mut plant, t + 0.5 * h, i + 0.5 * h * k2);
        let k4 = slope(&mut plant, t + h, i + h * k3);
        i += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        // The last period.
        if step >= 3600 {
            plant.bench.x[state] = i;
            sum += plant.get("motor.torque") / 400.0;
        }
    }
    let z_squared = (4.0 + 0.12 * w).powi(2) + (omega * 0.02).powi(2);
    let mean = 0.12 * amplitude * amplitude / 2.0 / z_squared;
    close(sum, mean, 1e-7 * mean);
}

const WOUND: &str = "WoundFieldDcMotor(r: 0.5, l: 0.01, r_f: 240.0, l_f: 60.0, l_af: 1.8, j: 0.05";

/// Armature and field at voltages of their own.
fn separate(more: &str) -> Plant {
    let mut connections = vec![
        "source.p <-> motor.p",
        "excitation.p <-> motor.fp",
        "source.n <-> motor.n <-> motor.fn <-> excitation.n <-> ground.p",
    ];
    connections.extend(SHAFT);
    Plant::new(
        &[
            ("source", "ControlledVoltageSource"),
            ("excitation", "ControlledVoltageSource"),
            ("motor", &format!("{WOUND}{more})")),
            ("load", "IdealTorqueSource"),
            ("encoder", "MotionSensor"),
            ("ground", "ElectricalReference"),
            ("frame", "RotationalReference"),
        ],
        &connections,
    )
}

#[test]
fn the_field_current_rises_with_its_own_time_constant() {
    let mut plant = separate("");
    plant.set("source.v", 0.0).set("excitation.v", 240.0);
    for t in [0.1, 0.25, 1.0] {
        plant.run_to(t, 1e-3);
        close(plant.get("motor.i_f"), 1.0 - (-t * 240.0 / 60.0_f64).exp(), 1e-9);
        close(plant.get("motor.i"), 0.0, 1e-15);
    }
}

#[test]
fn with_a_constant_field_it_is_a_motor_with_permanent_magnets() {
    let mut wound = separate(", damping: 0.01, i_f0: 1.0");
    let mut magnets = free("DcMotor(r: 0.5, l: 0.01, k: 1.8, j: 0.05, damping: 0.01)");
    wound.set("source.v", 240.0).set("excitation.v", 240.0).set("load.tau", -20.0);
    magnets.set("source.v", 240.0).set("load.tau", -20.0);
    for t in [0.01, 0.05, 0.3] {
        let (w, i) = (magnets.run_to(t, 1e-4).get("encoder.w"), magnets.get("motor.i"));
        close(wound.run_to(t, 1e-4).get("encoder.w"), w, 1e-11);
        close(wound.get("motor.i"), i, 1e-11);
        close(wound.get("motor.torque"), 1.8 * i, 1e-10);
    }
}

#[test]
fn a_weaker_field_lets_the_motor_turn_faster() {
    let mut plant = separate(", i_f0: 1.0");
    plant.set("source.v", 240.0);
    for (excitation, t) in [(240.0, 5.0), (120.0, 15.0)] {
        plant.set("excitation.v", excitation).run_to(t, 1e-3);
        close(plant.get("encoder.w"), 240.0 / (1.8 * excitation / 240.0), 1e-6);
    }
}

#[test]
fn a_shunt_motor_turns_the_same_way_for_both_signs_of_the_voltage() {
    let mut connections =
        vec!["source.p <-> motor.p <-> motor.fp", "source.n <-> motor.n <-> motor.fn <-> ground.p"];
    connections.extend(SHAFT);
    let mut plant = Plant::new(
        &[
            ("source", "ControlledVoltageSource"),
            ("motor", &format!("{WOUND})")),
            ("load", "IdealTorqueSource"),
            ("encoder", "MotionSensor"),
            ("ground", "ElectricalReference"),
            ("frame", "RotationalReference"),
        ],
        &connections,
    );
    plant.set("source.v", -240.0).run_to(6.0, 1e-3);
    close(plant.get("encoder.w"), 240.0 / 1.8, 1e-6);
    close(plant.get("motor.i_f"), -1.0, 1e-9);
}
