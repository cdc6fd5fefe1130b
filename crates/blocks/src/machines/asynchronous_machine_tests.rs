use std::f64::consts::TAU;

use super::super::asynchronous_machine_outputs as out;
use super::super::induction::samples;
use super::*;
use crate::mechanics::testing::{Seen, law};
use blocksim_block::in_unit::Measure;
use blocksim_block::physical::{Supply, from_space_vector, space_vector};

fn machine() -> AsynchronousMachine {
    AsynchronousMachine {
        rated_power: 15e3,
        rated_voltage: 220.0,
        rated_frequency: 60.0,
        pole_pairs: 1,
        r_s: Impedance::bare(0.25),
        x_ls: Impedance::bare(0.9),
        r_r: Impedance::bare(0.14),
        x_lr: Impedance::bare(0.41),
        x_m: Some(Impedance::bare(17.0)),
        x_0: Some(Impedance::bare(0.9)),
        impedances: Impedances::Ohm,
        cage: Cage::Single,
        saturation: Saturation::None,
        zero_sequence: ZeroSequence::Include,
        connection: Connection::Delta,
        start: Start::Zero,
        heat_port: false,
    }
}

fn magnetised(slip: f64) -> Start {
    Start::Magnetised { voltage: 220.0, frequency: 60.0, slip }
}

fn close(found: f64, expected: f64, digit: f64) {
    assert!((found - expected).abs() <= 0.51 * digit, "{found} != {expected}");
}

/// States at the start.
fn start_of(machine: &AsynchronousMachine) -> Vec<f64> {
    let part = machine.clone().built().part(&Given::nothing());
    part.states.iter().map(|state| state.initial).collect()
}

fn measured(machine: &AsynchronousMachine, c: &Flowing) -> [f64; out::COUNT] {
    let (component, mut y) = (machine.clone().built(), [0.0; out::COUNT]);
    component.measure_state(c, &mut y);
    component.measure_electrics(c, &mut y);
    y
}

fn with_states<'a>(c: &Loaded<'a>, x: &'a [f64]) -> Loaded<'a> {
    let mut c = *c;
    c.x = x;
    c
}

fn changes(machine: &AsynchronousMachine, c: &Flowing) -> Vec<f64> {
    let mut change = vec![f64::NAN; c.x.len()];
    Component::derivatives(&machine.clone().built(), c, &mut change);
    change
}

/// 220 V from line to line on the real axis of a frame of 60 Hz.
fn mains() -> Supply {
    Supply { voltage: [220.0 * (2.0_f64 / 3.0).sqrt(), 0.0], frequency: 60.0, ..Supply::default() }
}

#[test]
fn a_magnetised_start_is_the_steady_state_of_the_equivalent_circuit() {
    // Slip, torque (N*m), phase current (A), line current (A), power factor at rated voltage and
    // frequency.
    let table = [
        (1.0, 27.9282, 162.1535, 280.8580, 0.2826),
        (0.5, 52.2009, 156.7729, 271.5386, 0.3683),
        (0.2, 98.6726, 136.4127, 236.2738, 0.5682),
        (0.1, 114.4242, 104.1236, 180.3474, 0.7460),
        (0.05, 90.3758, 66.0613, 114.4215, 0.8565),
        (0.03, 63.4633, 43.8308, 75.9171, 0.8769),
        (0.02, 45.1793, 31.4351, 54.4472, 0.8567),
        (0.01, 23.8398, 19.2239, 33.2967, 0.7302),
    ];
    for (slip, torque, phase, line, factor) in table {
        let machine = AsynchronousMachine { start: magnetised(slip), ..machine() };
        let psi = start_of(&machine);
        let seen = Seen { x: &psi, speed: &[(1.0 - slip) * TAU * 60.0], supply: &mains(), ..law() };
        let c = seen.loaded();
        let change = changes(&machine, &c);
        assert!(change.iter().all(|change| change.abs() < 1e-10), "slip {slip}: {change:?}");

        let y = measured(&machine, &c);
        close(y[out::TORQUE], torque, 1e-4);
        close(y[out::I_RMS], phase, 1e-4);
        close(y[out::POWER_FACTOR], factor, 1e-4);
        close(y[out::V_RMS], 220.0, 1e-9);
        assert!((y[out::SLIP] - slip).abs() < 1e-12);
        close(y[out::POWER] / (3.0 * 220.0 * y[out::I_RMS]), factor, 1e-4);
        let [d, q, zero] = machine.clone().built().line_current(&c);
        close(d.hypot(q) / SQRT_2, line, 1e-4);
        let from_lines = 1.5 * c.supply.voltage[0] * d;
        assert!((from_lines - y[out::POWER]).abs() < 1e-9 * y[out::POWER] && zero == 0.0);
    }
}

#[test]
fn measured_quantities_fit_together() {
    let machine = AsynchronousMachine { start: magnetised(0.02), ..machine() };
    let psi = start_of(&machine);
    let base = samples::base();
    let supply = Supply { angle: TAU * 60.0 * 0.013, ..mains() };
    let c = Seen { t: 0.013, x: &psi, speed: &[0.98 * TAU * 60.0], supply: &supply, ..law() }.loaded();
    let y = measured(&machine, &c);
    let squares = [(out::POWER, out::PU_POWER), (out::REACTIVE_POWER, out::PU_REACTIVE_POWER)];
    for (si, pu) in squares.into_iter().chain([(out::APPARENT_POWER, out::PU_APPARENT_POWER)]) {
        assert!((y[si] - 15e3 * y[pu]).abs() < 1e-9);
    }
    assert!((y[out::POWER].hypot(y[out::REACTIVE_POWER]) - y[out::APPARENT_POWER]).abs() < 1e-9);
    assert!((y[out::APPARENT_POWER] - 3.0 * y[out::V_RMS] * y[out::I_RMS]).abs() < 1e-8);
    assert!(y[out::REACTIVE_POWER] > 0.0, "a machine draws the current that magnetises it");
    assert!((y[out::TORQUE] - base.t * y[out::PU_TORQUE]).abs() < 1e-12);
    assert!((y[out::VELOCITY] - y[out::PU_VELOCITY] / base.speed).abs() < 1e-12);
    for k in 0..3 {
        assert!((y[out::V + k] - base.v * y[out::PU_V + k]).abs() < 1e-10);
        assert!((y[out::I + k] - base.i * y[out::PU_I + k]).abs() < 1e-10);
    }
    // At rated frequency the vectors stand still; the voltage of a winding in delta is 30 degrees ahead of its phase.
    close(y[out::PU_V], 0.75_f64.sqrt(), 1e-12);
    close(y[out::PU_V + 1], 0.5, 1e-12);
    close(y[out::PU_VOLTAGE], 1.0, 1e-12);
    let (v, i) = (&y[out::PU_V..], &y[out::PU_I..]);
    close(v[0] * i[0] + v[1] * i[1], y[out::PU_POWER], 1e-12);
    close(v[1] * i[0] - v[0] * i[1], y[out::PU_REACTIVE_POWER], 1e-12);
    close(y[out::PU_CURRENT], i[0].hypot(i[1]), 1e-12);
}

#[test]
fn in_a_frame_that_stands_still_the_slip_is_that_against_the_flux() {
    let machine = AsynchronousMachine { start: magnetised(0.03), ..machine() };
    let psi = start_of(&machine);
    let supply = Supply { frequency: 0.0, ..mains() };
    let c = Seen { x: &psi, speed: &[0.97 * TAU * 60.0], supply: &supply, ..law() }.loaded();
    assert!((measured(&machine, &c)[out::SLIP] - 0.03).abs() < 1e-12);
    let nothing = [0.0; 4];
    let c = Seen { x: &nothing, speed: &[0.0], supply: &supply, ..law() }.loaded();
    assert_eq!(measured(&machine, &c)[out::SLIP], 0.0);
}

#[test]
fn a_wye_connection_gives_a_third_of_the_torque() {
    let torque = |connection| {
        let machine = AsynchronousMachine { connection, start: magnetised(0.02), ..machine() };
        let psi = start_of(&machine);
        measured(&machine, &Seen { x: &psi, speed: &[0.0], ..law() }.loaded())[out::TORQUE]
    };
    let (delta, wye) = (torque(Connection::Delta), torque(Connection::Wye));
    assert!((delta / wye - 3.0).abs() < 1e-12, "{delta}, {wye}");
}

#[test]
fn open_windings_in_delta_are_three_single_phase_windings() {
    // The same lines: once joined inside, once by hand, with winding a from line a to line b and so on.
    let lines = space_vector([110.0, -150.0, 40.0]);
    let fluxes = [0.3, -0.7, 0.5, 0.4];
    let inside = machine();
    let supply = Supply { voltage: [lines[0], lines[1]], ..Supply::default() };
    let c = Seen { x: &fluxes, speed: &[120.0], supply: &supply, ..law() }.loaded();
    let expected = changes(&inside, &c);
    let inside_lines = inside.clone().built().line_current(&c);

    let open = AsynchronousMachine { connection: Connection::Open, ..machine() };
    let [a, b, c_] = from_space_vector(lines);
    let windings = space_vector([a - b, b - c_, c_ - a]);
    assert!(windings[2].abs() < 1e-12, "around a delta all voltages add up to nothing");
    // The vectors of the windings are 30 degrees ahead of those of the lines.
    let lead = std::f64::consts::FRAC_PI_6;
    let turn = |d: f64, q: f64| {
        let z = samples::complex(d, q).turned(lead).vector();
        [z[0], z[1]]
    };
    let x: Vec<f64> =
        [turn(fluxes[0], fluxes[1]), turn(fluxes[2], fluxes[3]), [0.0, 0.0]].concat()[..5].to_vec();
    let supply = Supply { voltage: [windings[0], windings[1]], zero: windings[2], ..Supply::default() };
    let law_open = Seen { x: &x, speed: &[120.0], supply: &supply, ..law() }.loaded();
    let found = changes(&open, &law_open);
    for k in 0..2 {
        let [d, q] = turn(expected[2 * k], expected[2 * k + 1]);
        assert!((found[2 * k] - d).abs() + (found[2 * k + 1] - q).abs() < 1e-10, "{found:?} {expected:?}");
    }
    let [w_a, w_b, w_c] = from_space_vector(open.clone().built().line_current(&law_open));
    let outside = [w_a - w_c, w_b - w_a, w_c - w_b];
    for (found, expected) in outside.iter().zip(from_space_vector(inside_lines)) {
        assert!((found - expected).abs() < 1e-10, "{found} {expected}");
    }
    let (torque, same) = (measured(&inside, &c)[out::TORQUE], measured(&open, &law_open)[out::TORQUE]);
    assert!((torque - same).abs() < 1e-10 * torque.abs());
}

#[test]
fn the_answer_of_the_lines_is_that_of_their_currents() {
    let saturation = Saturation::Table {
        current: samples::CURVE.0.iter().map(|v| Measure { value: *v, has_unit: false }).collect(),
        voltage: samples::CURVE.1.iter().map(|v| Measure { value: *v, has_unit: false }).collect(),
    };
    for connection in [Connection::Delta, Connection::Wye, Connection::Open] {
        let machine = AsynchronousMachine { connection, saturation: saturation.clone(), ..machine() };
        let component = machine.clone().built();
        let x: Vec<f64> = [0.5, -0.9, 0.3, -0.7, 0.2][..start_of(&machine).len()].to_vec();
        let supply =
            Supply { voltage: [150.0, -60.0], zero: 30.0, frequency: 20.0, angle: 0.4, ..Supply::NONE };
        let c = Seen { x: &x, speed: &[150.0], supply: &supply, ..law() }.loaded();
        let (mut internal, mut inverse) = ([0.0; 3], [0.0; 9]);
        component.reluctance(&c, &mut internal, &mut inverse);
        let drop = [150.0 - internal[0], -60.0 - internal[1], 30.0 - internal[2]];
        let after: Vec<f64> =
            x.iter().zip(changes(&machine, &c)).map(|(x, change)| x + 1e-9 * change).collect();
        let (before, after) = (component.line_current(&c), component.line_current(&with_states(&c, &after)));
        for k in 0..if connection == Connection::Open { 3 } else { 2 } {
            let expected = (after[k] - before[k]) / 1e-9;
            let found: f64 = inverse[3 * k..3 * k + 3].iter().zip(drop).map(|(g, v)| g * v).sum();
            assert!(
                (found - expected).abs() < 1e-4 * expected.abs(),
                "{connection:?} {k}: {found} {expected}"
            );
        }
    }
}

#[test]
fn volt_seconds_change_the_currents_by_the_transient_inductance() {
    let machine = AsynchronousMachine { connection: Connection::Open, ..machine() };
    let component = machine.clone().built();
    let x = [0.5, -0.9, 0.3, -0.7, 0.2];
    let c = Seen { x: &x, speed: &[150.0], ..law() }.loaded();
    let (mut internal, mut inverse) = ([0.0; 3], [0.0; 9]);
    component.reluctance(&c, &mut internal, &mut inverse);
    let impulse = [0.1, -0.2, 0.05];
    let mut struck = x;
    component.strike(&c, &impulse, &mut struck);
    let (before, after) = (component.line_current(&c), component.line_current(&with_states(&c, &struck)));
    for k in 0..3 {
        let expected: f64 = inverse[3 * k..3 * k + 3].iter().zip(impulse).map(|(g, v)| g * v).sum();
        assert!((after[k] - before[k] - expected).abs() < 1e-9, "{after:?} {before:?} {expected}");
    }
}

#[test]
fn without_zero_sequence_open_windings_draw_none() {
    let zero_sequence = ZeroSequence::Exclude;
    let machine = AsynchronousMachine { connection: Connection::Open, zero_sequence, x_0: None, ..machine() };
    let x = start_of(&machine);
    assert_eq!(x.len(), 4);
    let supply = Supply { zero: 50.0, ..mains() };
    let c = Seen { x: &x, speed: &[0.0], supply: &supply, ..law() }.loaded();
    let component = machine.clone().built();
    assert_eq!(component.line_current(&c)[2], 0.0);
    let (mut internal, mut inverse) = ([f64::NAN; 3], [f64::NAN; 9]);
    component.reluctance(&c, &mut internal, &mut inverse);
    assert!(internal[2] == 0.0 && inverse[8] > 0.0, "a floating star point stays in the middle");
}

#[test]
fn a_circulating_current_of_a_delta_decays_by_itself() {
    let start = Start::Explicit { psi_s: [0.5, 0.0], psi_r: [0.4, 0.1], psi_r2: [0.0; 2], psi_0s: 0.1 };
    let machine = AsynchronousMachine { start, ..machine() };
    let psi = start_of(&machine);
    assert_eq!(psi, [0.5, 0.0, 0.4, 0.1, 0.1]);
    let seen = Seen { x: &psi, speed: &[0.0], supply: &mains(), ..law() };
    let c = seen.loaded();
    let rate = 0.25 / 0.9 * TAU * 60.0;
    assert!((changes(&machine, &c)[4] + 0.1 * rate).abs() < 1e-12);
    assert_eq!(machine.clone().built().line_current(&c)[2], 0.0);
}

#[test]
fn a_machine_can_be_magnetised_by_direct_current() {
    let start = Start::Magnetised { voltage: 4.4, frequency: 0.0, slip: 1.0 };
    let machine = AsynchronousMachine { start, ..machine() };
    let supply = Supply { voltage: [4.4 * (2.0_f64 / 3.0).sqrt(), 0.0], ..Supply::default() };
    let psi = start_of(&machine);
    let c = Seen { x: &psi, speed: &[0.0], supply: &supply, ..law() }.loaded();
    assert!(changes(&machine, &c).iter().all(|change| change.abs() < 1e-12));
    assert!(psi[0] > 0.0 && measured(&machine, &c)[out::TORQUE] == 0.0);
}

#[test]
fn impedances_in_per_unit_are_those_in_ohm_over_the_base() {
    let z = 9.68;
    let pu = |value: f64| Impedance::bare(value / z);
    let double = |scale: f64| Cage::Double {
        r_r2: Impedance::bare(0.6 / scale),
        x_lr2: Impedance::bare(0.3 / scale),
        x_lr12: Impedance::bare(0.1 / scale),
    };
    let ohm = AsynchronousMachine { cage: double(1.0), ..machine() };
    let per_unit = AsynchronousMachine {
        impedances: Impedances::PerUnit,
        r_s: pu(0.25),
        x_ls: pu(0.9),
        r_r: pu(0.14),
        x_lr: pu(0.41),
        x_m: Some(pu(17.0)),
        cage: double(z),
        ..machine()
    };
    assert_eq!(ohm.circuit(), per_unit.circuit());
}

#[test]
fn a_table_in_volts_and_amperes_is_the_one_in_per_unit() {
    let list = |values: &[f64], unit: f64, has_unit| {
        values.iter().map(|v| Measure { value: v * unit, has_unit }).collect::<Vec<_>>()
    };
    let table = |i: f64, v: f64, has_unit| Saturation::Table {
        current: list(&samples::CURVE.0, i, has_unit),
        voltage: list(&samples::CURVE.1, v, has_unit),
    };
    let with = |saturation| AsynchronousMachine { saturation, x_m: None, ..machine() }.circuit().unwrap();
    let (pu, si) = (with(table(1.0, 1.0, false)), with(table(15e3 / 660.0, 220.0, true)));
    for (a, b) in pu.magnetisation.knots().iter().zip(si.magnetisation.knots()) {
        assert!((a.0 - b.0).abs() + (a.1 - b.1).abs() < 1e-15, "{a:?} {b:?}");
    }
}

#[test]
fn parameters_without_meaning_are_refused() {
    let refused = |machine: AsynchronousMachine, param: &str| {
        assert_eq!(machine.try_build().unwrap_err()[0].param, param);
    };
    let zero = Impedance::bare(0.0);
    refused(AsynchronousMachine { pole_pairs: 0, ..machine() }, "pole_pairs");
    refused(AsynchronousMachine { x_ls: zero, x_lr: zero, ..machine() }, "x_ls");
    refused(AsynchronousMachine { rated_power: 0.0, ..machine() }, "rated_power");
    refused(AsynchronousMachine { x_m: None, ..machine() }, "x_m");
    refused(AsynchronousMachine { x_m: Some(zero), ..machine() }, "x_m");
    refused(AsynchronousMachine { x_0: Some(Impedance::bare(-1.0)), ..machine() }, "x_0");
    let connection = Connection::Open;
    refused(AsynchronousMachine { x_0: None, connection, ..machine() }, "x_0");
    refused(AsynchronousMachine { x_0: Some(zero), connection, ..machine() }, "x_0");
    let direct = Start::Magnetised { voltage: 10.0, frequency: 0.0, slip: 0.0 };
    refused(AsynchronousMachine { r_s: zero, start: direct, ..machine() }, "start");
    let second = Start::Explicit { psi_s: [0.0; 2], psi_r: [0.0; 2], psi_r2: [0.1, 0.0], psi_0s: 0.0 };
    refused(AsynchronousMachine { start: second, ..machine() }, "start.psi_r2");
    let circulating = Start::Explicit { psi_s: [0.0; 2], psi_r: [0.0; 2], psi_r2: [0.0; 2], psi_0s: 0.1 };
    let wye = AsynchronousMachine { start: circulating, connection: Connection::Wye, ..machine() };
    refused(wye, "start.psi_0s");
    let value = |value, has_unit| Measure { value, has_unit };
    let mixed = Saturation::Table {
        current: vec![value(0.0, false), value(1.0, true), value(2.0, false)],
        voltage: vec![value(0.0, false), value(1.0, false), value(1.2, false)],
    };
    refused(AsynchronousMachine { saturation: mixed, ..machine() }, "saturation.current[2]");
}
