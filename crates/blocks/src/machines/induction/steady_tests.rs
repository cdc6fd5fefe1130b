use super::super::complex::complex;
use super::super::{Cages, samples};
use super::*;

#[test]
fn the_equivalent_circuit_gives_the_figures_of_a_known_machine() {
    // Slip, torque (N*m), RMS current of a winding (A), power factor at rated voltage and frequency.
    let table = [
        (1.0, 27.9282, 162.1535, 0.2826),
        (0.5, 52.2009, 156.7729, 0.3683),
        (0.2, 98.6726, 136.4127, 0.5682),
        (0.1, 114.4242, 104.1236, 0.7460),
        (0.05, 90.3758, 66.0613, 0.8565),
        (0.03, 63.4633, 43.8308, 0.8769),
        (0.02, 45.1793, 31.4351, 0.8567),
        (0.01, 23.8398, 19.2239, 0.7302),
        (0.108_714, 114.7643, f64::NAN, f64::NAN),
    ];
    let (circuit, base) = (samples::single(), samples::base());
    for (slip, torque, current, factor) in table {
        let steady = circuit.steady_state(1.0, 1.0, slip);
        assert!((base.t * steady.torque - torque).abs() < 0.51e-4, "{slip}: {steady:?}");
        if !current.is_nan() {
            assert!((base.i / 2.0_f64.sqrt() * steady.i_s.abs() - current).abs() < 0.51e-4, "{slip}");
            assert!((steady.i_s.re / steady.i_s.abs() - factor).abs() < 0.51e-4, "{slip}");
        }
    }
}

#[test]
fn two_cages_act_as_impedances_in_parallel() {
    // The circuit by hand: r_s + j x_ls in series with x_m || (r_1/s + j x_1) || (r_2/s + j x_2).
    let circuit = samples::double();
    let Cages::Double { r, l, .. } = circuit.cages else { panic!("two cages") };
    let parallel = |a: Complex, b: Complex| a * b / (a + b);
    for step in -20..=40 {
        let slip = 0.05 * f64::from(step) + 1e-3;
        let branch = |k: usize| complex(r[k] / slip, l[k]);
        let rotor = parallel(branch(0), branch(1));
        let main = parallel(complex(0.0, circuit.magnetisation.unsaturated()), rotor);
        let i_s = complex(1.0, 0.0) / (complex(circuit.r_s, circuit.l_ls) + main);
        let air_gap = main * i_s;
        // Air-gap power over synchronous speed: what the resistances r_k / s take.
        let torque =
            (air_gap / branch(0)).square() * r[0] / slip + (air_gap / branch(1)).square() * r[1] / slip;
        let found = circuit.steady_state(1.0, 1.0, slip);
        assert!((found.i_s - i_s).abs() < 1e-12 && (found.torque - torque).abs() < 1e-12, "slip {slip}");
    }
}

#[test]
fn in_a_steady_state_the_fluxes_rest() {
    for machine in samples::all() {
        for (v, w, slip) in
            [(1.0, 1.0, 0.02), (1.3, 1.0, 1.0), (0.5, 0.5, -0.01), (0.05, 0.0, 0.0), (1.0, -1.0, 0.4)]
        {
            let psi = machine.steady_fluxes(v, w, slip);
            let mut change = vec![0.0; psi.len()];
            machine.derivatives(&psi, complex(v, 0.0), 0.0, w, w - slip, &mut change);
            assert!(change.iter().all(|change| change.abs() < 1e-10), "{v} {w} {slip}: {change:?}");
            let (found, expected) = (machine.torque(&psi), machine.circuit().steady_state(v, w, slip).torque);
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}

#[test]
fn integration_in_time_ends_in_the_steady_state() {
    for (number, machine) in samples::all().iter().enumerate() {
        let (v, w, slip) = (1.1, 1.0, 0.03);
        let mut psi = vec![0.0; machine.states()];
        // The time constants of the rotor are some tenths of a second; in the stator's frame nothing would rest.
        samples::integrate(machine, &mut psi, w, (1e-4, 30_000), |_, _| (complex(v, 0.0), 0.0, w - slip));
        for (found, expected) in psi.iter().zip(machine.steady_fluxes(v, w, slip)) {
            assert!((found - expected).abs() < 1e-8, "machine {number}: {found} {expected}");
        }
    }
}

#[test]
fn without_load_and_resistance_a_machine_reproduces_its_open_circuit_curve() {
    let (current, voltage) = samples::CURVE;
    for circuit in [samples::single(), samples::double()] {
        let circuit = Circuit { r_s: 0.0, ..samples::saturated(circuit) };
        for (i, v) in current.iter().zip(voltage) {
            let found = circuit.steady_state(v, 1.0, 0.0).i_s;
            assert!((found.abs() - i).abs() < 1e-14, "{v}: {found:?} instead of {i}");
        }
        // Half way between two points, and beyond the last.
        assert!((circuit.steady_state(0.925, 1.0, 0.0).i_s.abs() - 0.36).abs() < 1e-14);
        assert!((circuit.steady_state(1.38, 1.0, 0.0).i_s.abs() - 1.4).abs() < 1e-14);
    }
}

#[test]
fn a_shorted_winding_without_voltage_rests() {
    let machine = &samples::all()[0];
    assert_eq!(machine.steady_fluxes(0.0, 1.0, 0.5), vec![0.0; machine.states()]);
}

#[test]
fn what_limits_no_current_has_no_steady_state() {
    let circuit = Circuit { r_s: 0.0, ..samples::single() };
    assert!(!circuit.steady_state(0.1, 0.0, 0.0).i_s.abs().is_finite());
}
