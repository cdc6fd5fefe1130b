use super::*;
use crate::mechanics::testing::law;
use blocksim_block::physical::Supply;

fn machine() -> AsynchronousMachine {
    AsynchronousMachine {
        rated_power: 15e3,
        rated_voltage: 220.0,
        rated_frequency: 60.0,
        pole_pairs: 1,
        r_s: 0.25,
        x_ls: 0.9,
        r_r: 0.14,
        x_lr: 0.41,
        x_m: 17.0,
        x_0: 0.9,
        connection: Connection::Delta,
        start: Start::Zero,
        per_unit: OnceLock::new(),
    }
}

fn close(found: f64, expected: f64, digit: f64) {
    assert!((found - expected).abs() <= 0.51 * digit, "{found} != {expected}");
}

#[test]
fn base_values_are_those_of_a_machine_in_delta() {
    let machine = machine();
    let base = machine.base();
    close(base.z_base, 9.68, 1e-12);
    close(base.v_base, 311.1270, 1e-4);
    close(base.i_base, 32.14122, 1e-5);
    close(base.t_base, 39.78874, 1e-5);
    close(base.v_base / base.w_base, 0.825_290_0, 1e-7);
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
        (0.108714, 114.7643, f64::NAN, f64::NAN, f64::NAN),
    ];
    for (slip, torque, phase, line, factor) in table {
        let machine = AsynchronousMachine {
            start: Start::Magnetised { voltage: 220.0, frequency: 60.0, slip },
            ..machine()
        };
        assert_eq!(machine.check(), Ok(()));
        let psi = machine.start_fluxes();
        let amplitude = 220.0 * (2.0_f64 / 3.0).sqrt();
        let supply = Supply { voltage: [amplitude, 0.0], frequency: 60.0, ..Supply::default() };
        let c = Law { x: &psi, speed: &[(1.0 - slip) * TAU * 60.0], supply, ..law() };

        let mut change = [0.0; 4];
        Component::derivatives(&machine, &c, &mut change);
        assert!(change.iter().all(|change| change.abs() < 1e-10), "slip {slip}: {change:?}");

        let mut y = [0.0; 11];
        machine.measure(&c, Needs::State, &mut y);
        machine.measure(&c, Needs::Electrics, &mut y);
        close(y[TORQUE], torque, 1e-4);
        assert!((y[SLIP] - slip).abs() < 1e-12);
        if phase.is_nan() {
            continue;
        }
        close(y[I_RMS], phase, 1e-4);
        close(y[POWER] / (3.0 * 220.0 * y[I_RMS]), factor, 1e-4);
        let [d, q, _] = machine.line_current(&c);
        close(d.hypot(q) / SQRT_2, line, 1e-4);
        let from_lines = 1.5 * amplitude * d;
        assert!((from_lines - y[POWER]).abs() < 1e-9 * y[POWER], "{from_lines} != {}", y[POWER]);
    }
}

#[test]
fn a_wye_connection_gives_a_third_of_the_torque() {
    let start = Start::Magnetised { voltage: 220.0, frequency: 60.0, slip: 0.02 };
    let torque = |connection| {
        let machine = AsynchronousMachine { connection, start, ..machine() };
        machine.base().t_base * machine.base().torque(&machine.start_fluxes())
    };
    let (delta, wye) = (torque(Connection::Delta), torque(Connection::Wye));
    assert!((delta / wye - 3.0).abs() < 1e-12, "{delta}, {wye}");
}

#[test]
fn a_machine_can_be_magnetised_by_direct_current() {
    let start = Start::Magnetised { voltage: 4.4, frequency: 0.0, slip: 1.0 };
    let machine = AsynchronousMachine { start, ..machine() };
    let amplitude = 4.4 * (2.0_f64 / 3.0).sqrt();
    let supply = Supply { voltage: [amplitude, 0.0], ..Supply::default() };
    let psi = machine.start_fluxes();
    let mut change = [0.0; 4];
    Component::derivatives(&machine, &Law { x: &psi, speed: &[0.0], supply, ..law() }, &mut change);
    assert!(change.iter().all(|change| change.abs() < 1e-12), "{change:?}");
    assert!(psi[0] > 0.0 && machine.base().torque(&psi) == 0.0);
}

#[test]
fn parameters_without_meaning_are_refused() {
    let refused = |machine: AsynchronousMachine, param: &str| {
        assert_eq!(machine.check().unwrap_err().param, param);
    };
    refused(AsynchronousMachine { pole_pairs: 0, ..machine() }, "pole_pairs");
    refused(AsynchronousMachine { x_ls: 0.0, x_lr: 0.0, ..machine() }, "x_ls");
    refused(AsynchronousMachine { rated_power: 0.0, ..machine() }, "rated_power");
    let direct = Start::Magnetised { voltage: 10.0, frequency: 0.0, slip: 0.0 };
    refused(AsynchronousMachine { r_s: 0.0, start: direct, ..machine() }, "start");
}
