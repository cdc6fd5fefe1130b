//! Synchronous machines with permanent magnets, and the inverter that controls them by a vector.

use std::f64::consts::{PI, TAU};

use crate::plant::{Plant, close};

const R: f64 = 0.6;
const FLUX: f64 = 0.12;
const POLE_PAIRS: f64 = 4.0;

/// A machine with these inductances and further parameters.
fn machine(l_d: f64, l_q: f64, more: &str) -> String {
    format!(
        "PermanentMagnetMachine(pole_pairs: 4, r_s: {R:?}, l_d: {l_d:?}, l_q: {l_q:?}, flux: {FLUX:?}{more})"
    )
}

/// A machine at a prescribed speed.
fn driven(source: &str, machine: &str) -> Plant {
    Plant::new(
        &[
            ("source", source),
            ("machine", machine),
            ("turn", "IdealSpeedSource"),
            ("frame", "RotationalReference"),
        ],
        &["source.ac <-> machine.ac", "machine.r <-> turn.r", "machine.c <-> turn.c <-> frame.r"],
    )
}

/// Currents of the steady state: `v_d = R i_d - w L_q i_q`, `v_q = R i_q + w (L_d i_d + psi)`.
fn steady([v_d, v_q]: [f64; 2], w_e: f64, l_d: f64, l_q: f64) -> [f64; 2] {
    let (x_d, x_q, e) = (w_e * l_d, w_e * l_q, v_q - w_e * FLUX);
    let determinant = R * R + x_d * x_q;
    [(R * v_d + x_q * e) / determinant, (R * e - x_d * v_d) / determinant]
}

#[test]
fn in_step_with_the_supply_the_machine_settles_in_its_closed_form() {
    // Line voltage (RMS), angle of the voltage before the d axis, speed, inductances.
    for (voltage, lead, w, l_d, l_q) in [
        (60.0, 1.7_f64, 100.0, 1.4e-3, 2.8e-3),
        (90.0, 2.2, 150.0, 2e-3, 2e-3),
        (60.0, 0.9, -100.0, 1.4e-3, 2.8e-3),
    ] {
        let (w_e, theta0) = (POLE_PAIRS * w, 0.8);
        let source = format!(
            "ThreePhaseSource(voltage: {voltage:?}, frequency: {:?}, phase: {:?})",
            w_e / TAU,
            theta0 + lead
        );
        let mut plant = driven(&source, &machine(l_d, l_q, ", theta0: 0.8"));
        plant.set("turn.w", w).run_to(0.2, 2e-5);
        let peak = voltage * (2.0_f64 / 3.0).sqrt();
        let [i_d, i_q] = steady([peak * lead.cos(), peak * lead.sin()], w_e, l_d, l_q);
        let torque = 1.5 * POLE_PAIRS * (FLUX * i_q + (l_d - l_q) * i_d * i_q);
        close(plant.get("machine.i_d"), i_d, 1e-8);
        close(plant.get("machine.i_q"), i_q, 1e-8);
        close(plant.get("machine.torque"), torque, 1e-8);
        close(plant.get("turn.tau"), -torque, 1e-8);
        close(plant.get("machine.theta"), theta0 + w_e * 0.2, 1e-9);
        let copper = 1.5 * R * (i_d * i_d + i_q * i_q);
        close(plant.get("source.power"), torque * w + copper, 1e-6);
        close(plant.get("machine.power"), torque * w + copper, 1e-6);
    }
}

/// Current of phase a at constant speed, from the equation of one phase, `v_a = R i_a + L i_a' + e_a` with
/// `e_a = -w_e psi sin(w_e t)`: two alternating currents and what dies out.
fn phase_current(t: f64, peak: f64, w_s: f64, w_e: f64, l: f64) -> f64 {
    let cosine = |amplitude: f64, w: f64, angle: f64| {
        let (z, lag) = (R.hypot(w * l), (w * l).atan2(R));
        move |t: f64| amplitude / z * (w * t + angle - lag).cos()
    };
    let from_lines = cosine(peak, w_s, 0.0);
    // w psi sin(w t) = w psi cos(w t - pi/2).
    let from_magnets = cosine(w_e * FLUX, w_e, -PI / 2.0);
    let steady = |t: f64| from_lines(t) + from_magnets(t);
    steady(t) - steady(0.0) * (-R / l * t).exp()
}

#[test]
fn out_of_step_the_current_of_a_phase_is_that_of_its_own_equation() {
    let (l, w) = (2e-3, 100.0);
    let mut plant = driven("ThreePhaseSource(voltage: 60.0, frequency: 90.0)", &machine(l, l, ""));
    plant.set("turn.w", w);
    for t in [0.001, 0.004, 0.02, 0.05] {
        plant.run_to(t, 1e-5);
        let (i_d, i_q) = (plant.get("machine.i_d"), plant.get("machine.i_q"));
        let (sin, cos) = plant.get("machine.theta").sin_cos();
        let peak = 60.0 * (2.0_f64 / 3.0).sqrt();
        close(i_d * cos - i_q * sin, phase_current(t, peak, TAU * 90.0, POLE_PAIRS * w, l), 1e-7);
    }
}

#[test]
fn short_circuited_windings_brake_with_the_torque_of_an_eddy_current() {
    let l = 2e-3;
    for w in [5.0, 75.0, 300.0, -75.0] {
        let mut plant = driven("VectorInverter(vdc: 0.0)", &machine(l, l, ""));
        plant.set("source.v_d", 0.0).set("source.v_q", 0.0).set("source.theta", 0.0);
        plant.set("turn.w", w).run_to(0.1, 1e-5);
        let w_e = POLE_PAIRS * w;
        let torque = -1.5 * POLE_PAIRS * FLUX * FLUX * w_e * R / (R * R + (w_e * l).powi(2));
        close(plant.get("machine.torque"), torque, 1e-8);
        close(plant.get("source.power"), 0.0, 1e-12);
        assert!(torque * w < 0.0, "it brakes in both directions");
    }
}

#[test]
fn a_vector_at_standstill_is_a_direct_voltage_for_each_axis() {
    let (l_d, l_q) = (1.4e-3, 2.8e-3);
    let mut plant = driven("VectorInverter(vdc: 100.0)", &machine(l_d, l_q, ", theta0: 2.5"));
    plant.set("source.v_d", 3.0).set("source.v_q", -1.5).set("source.theta", 2.5);
    for t in [0.001, 0.003, 0.01] {
        plant.run_to(t, 1e-5);
        close(plant.get("machine.i_d"), 5.0 * (1.0 - (-R / l_d * t).exp()), 1e-9);
        close(plant.get("machine.i_q"), -2.5 * (1.0 - (-R / l_q * t).exp()), 1e-9);
    }
    close(plant.get("source.amplitude"), 3.0_f64.hypot(1.5), 1e-13);
    plant.set("source.v_d", 300.0).set("source.v_q", 400.0);
    close(plant.get("source.amplitude"), 50.0, 1e-13);
}

#[test]
fn what_a_controller_reads_waits_for_no_voltage() {
    let plant = driven("VectorInverter(vdc: 100.0)", &machine(2e-3, 2e-3, ""));
    for output in ["torque", "i_d", "i_q", "theta"] {
        assert_eq!(plant.read_by(&format!("machine.{output}")), ["turn.w", "turn.dw"], "{output}");
    }
    assert!(plant.read_by("machine.power").contains(&"source.v_d".to_owned()));
}

#[test]
fn the_frame_of_the_fluxes_does_not_matter_to_an_asynchronous_machine() {
    let asynchronous = "AsynchronousMachine(rated_power: 15e3, rated_voltage: 220.0, rated_frequency: 60.0, \
                        pole_pairs: 1, r_s: 0.25, x_ls: 0.9, r_r: 0.14, x_lr: 0.41, x_m: 17.0)";
    let torque = |f: f64| {
        let mut plant = driven("VectorInverter(vdc: 400.0)", asynchronous);
        plant.set("source.v_d", 20.0).set("source.v_q", 15.0).set("source.theta", 0.4).set("source.f", f);
        plant.set("turn.w", 30.0).run_to(0.03, 1e-5);
        (plant.get("machine.torque"), plant.get("source.power"))
    };
    let (still, turning) = (torque(0.0), torque(35.0));
    close(turning.0, still.0, 1e-7);
    close(turning.1, still.1, 1e-6);
    assert!(still.0 < -1.0, "a direct current brakes: {} N*m", still.0);
}
