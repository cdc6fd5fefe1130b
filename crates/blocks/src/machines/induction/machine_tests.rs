use super::super::complex::complex;
use super::super::samples;
use super::*;

/// Numbers in -1..1 that look random (Weyl's sequence).
fn scattered(seed: usize) -> f64 {
    2.0 * (seed as f64 * 0.618_033_988_749_894_9).fract() - 1.0
}

/// Fluxes of given currents, straight from the description of the machine.
fn fluxes(machine: &Machine, i: &[Complex]) -> Vec<f64> {
    let circuit = machine.circuit();
    let i_m = i.iter().fold(ZERO, |sum, i| sum + *i);
    let knots = circuit.magnetisation.knots();
    let line = (1..knots.len() - 1).find(|k| knots[*k].0 >= i_m.abs()).unwrap_or(knots.len() - 1);
    let ((i_a, psi_a), (i_b, psi_b)) = (knots[line - 1], knots[line]);
    let psi = psi_a + (i_m.abs() - i_a) * (psi_b - psi_a) / (i_b - i_a);
    let psi_m = (psi / i_m.abs()) * i_m;
    let (l_1, l_12, l_2) = circuit.cages.leakage();
    let mut list = (circuit.l_ls * i[0] + psi_m).vector().to_vec();
    let other = if machine.n == 3 { i[2] } else { ZERO };
    list.extend((l_1 * i[1] + l_12 * other + psi_m).vector());
    if machine.n == 3 {
        list.extend((l_12 * i[1] + l_2 * i[2] + psi_m).vector());
    }
    list.resize(machine.states(), 0.0);
    list
}

#[test]
fn currents_are_those_whose_fluxes_they_are() {
    for (m, machine) in samples::all().iter().enumerate() {
        for size in [1e-9, 0.1, 0.4, 3.0] {
            let i: Vec<Complex> = (0..machine.n)
                .map(|k| size * complex(scattered(100 * m + 2 * k + 1), scattered(100 * m + 2 * k + 2)))
                .collect();
            let psi = fluxes(machine, &i);
            for (found, expected) in machine.currents(&psi).iter().zip(&i) {
                assert!(
                    (*found - *expected).abs() < 2e-14 * (1.0 + 10.0 * size),
                    "{m}, {size}: {found:?} {expected:?}"
                );
            }
            let i_m = i.iter().fold(ZERO, |sum, i| sum + *i);
            assert!(machine.main_flux(&psi).cross(i_m).abs() < 1e-12, "flux and current are parallel");
        }
    }
}

#[test]
fn without_flux_there_is_no_current() {
    for machine in samples::all() {
        let psi = vec![0.0; machine.states()];
        assert_eq!(machine.currents(&psi), [ZERO; MOST]);
        assert_eq!(machine.torque(&psi), 0.0);
        let reluctance = machine.reluctance(&psi, 1.0, 0.5);
        assert!(reluctance.inverse[0][0] > 0.0 && reluctance.internal == [0.0; 2], "{reluctance:?}");
    }
}

#[test]
fn currents_change_with_fluxes_as_the_incremental_inductances_say() {
    for (m, machine) in samples::all().iter().enumerate() {
        let psi: Vec<f64> = (0..machine.states()).map(|k| 1.2 * scattered(17 * m + k + 1)).collect();
        let incremental = machine.incremental(&psi);
        for l in 0..machine.n {
            for (axis, unit) in [(0, complex(1.0, 0.0)), (1, complex(0.0, 1.0))] {
                let shifted = |by: f64| {
                    let mut psi = psi.clone();
                    psi[2 * l + axis] += by;
                    machine.currents(&psi)
                };
                let (after, before) = (shifted(1e-6), shifted(-1e-6));
                for k in 0..machine.n {
                    let slope = 0.5e6 * (after[k] - before[k]);
                    let found = incremental(k, l).of(unit);
                    assert!((found - slope).abs() < 2e-7, "{m}, {k}, {l}: {found:?} {slope:?}");
                    let back = incremental(l, k).of(unit);
                    assert!((found - back).abs() < 1e-12, "energy is stored: the map is symmetric");
                }
            }
        }
    }
}

#[test]
fn stator_currents_answer_voltages_by_the_transient_inductance() {
    let (w, w_r, v, v_0) = (0.8, 0.3, complex(0.7, -0.4), 0.2);
    for (m, machine) in samples::all().iter().enumerate() {
        let psi: Vec<f64> = (0..machine.states()).map(|k| 1.1 * scattered(13 * m + k + 3)).collect();
        let mut slope = vec![0.0; psi.len()];
        machine.derivatives(&psi, v, v_0, w, w_r, &mut slope);
        let at =
            |h: f64| -> Vec<f64> { psi.iter().zip(&slope).map(|(psi, slope)| psi + h * slope).collect() };
        let (after, before) = (at(1e-9), at(-1e-9));
        let expected = 0.5e9 * (machine.currents(&after)[0] - machine.currents(&before)[0]);
        let found = machine.reluctance(&psi, w, w_r);
        let drop = v - Complex::from_vector(found.internal);
        let [d, q] = found.inverse.map(|row| Complex::from_vector(row).dot(drop));
        assert!((complex(d, q) - expected).abs() < 1e-6 * expected.abs(), "{m}: {d} {q} {expected:?}");
        assert!((found.inverse[0][1] - found.inverse[1][0]).abs() < 1e-9);
        let zero = 0.5e9 * (machine.zero_current(&after) - machine.zero_current(&before));
        assert!((found.zero_inverse * (v_0 - found.zero_internal) - zero).abs() < 1e-6 * (1.0 + zero.abs()));
    }
}

#[test]
fn the_frame_changes_nothing_but_the_way_of_looking() {
    let (angle, w, w_r, v) = (0.7, 0.9, 0.4, complex(0.6, 0.8));
    for machine in samples::all() {
        let psi: Vec<f64> = (0..machine.states()).map(|k| scattered(k + 5)).collect();
        let turned: Vec<f64> = (0..machine.n)
            .flat_map(|k| Machine::flux(&psi, k).turned(angle).vector())
            .chain(psi[2 * machine.n..].iter().copied())
            .collect();
        let (mut standing, mut turning) = (vec![0.0; psi.len()], vec![0.0; psi.len()]);
        machine.derivatives(&psi, v, 0.0, 0.0, w_r, &mut standing);
        machine.derivatives(&turned, v.turned(angle), 0.0, w, w_r, &mut turning);
        for k in 0..machine.n {
            // In a frame that turns, a flux that stands still falls back.
            let fall = (machine.w_base * w) * (complex(0.0, 1.0) * Machine::flux(&turned, k));
            let expected = Machine::flux(&standing, k).turned(angle) - fall;
            assert!((Machine::flux(&turning, k) - expected).abs() < 1e-11 * machine.w_base);
        }
        assert!((machine.torque(&psi) - machine.torque(&turned)).abs() < 1e-12);
    }
}

/// Direct on line, no load, J = 0.1 kg*m^2; time (s), speed (rad/s), torque (N*m).
const START: [(f64, f64, f64); 8] = [
    (0.005, 0.2142, 18.999),
    (0.01, 3.2647, 102.776),
    (0.02, 7.3350, -56.699),
    (0.05, 17.8017, 26.009),
    (0.1, 29.4541, 75.113),
    (0.2, 53.1758, 15.282),
    (0.5, 167.6186, 47.451),
    (0.9, 375.7814, 4.190),
];

#[test]
fn a_start_on_the_line_follows_an_independent_integration() {
    let machine = Machine::new(samples::single(), samples::base().w);
    let base = samples::base();
    // The speed is a sixth state beside the five fluxes; all are integrated with steps of 50 us in the stator's frame.
    let mut x = [0.0; 6];
    let h = 50e-6;
    let slope = |t: f64, x: &[f64; 6]| {
        let mut dx = [0.0; 6];
        let v = complex(1.0, 0.0).turned(base.w * t);
        machine.derivatives(&x[..5], v, 0.0, 0.0, base.speed * x[5], &mut dx[..5]);
        dx[5] = base.t * machine.torque(&x[..5]) / 0.1;
        dx
    };
    let plus = |x: &[f64; 6], h: f64, dx: &[f64; 6]| std::array::from_fn(|i| x[i] + h * dx[i]);
    let mut next = START.iter();
    let mut wanted = next.next();
    for step in 0..=18_000 {
        let t = h * f64::from(step);
        if let Some((at, w, torque)) = wanted
            && (t - at).abs() < 0.5 * h
        {
            assert!((x[5] - w).abs() < 0.6e-4, "{t}: {} {w}", x[5]);
            let found = base.t * machine.torque(&x[..5]);
            assert!((found - torque).abs() < 0.6e-3, "{t}: {found} {torque}");
            wanted = next.next();
        }
        let k_1 = slope(t, &x);
        let k_2 = slope(t + 0.5 * h, &plus(&x, 0.5 * h, &k_1));
        let k_3 = slope(t + 0.5 * h, &plus(&x, 0.5 * h, &k_2));
        let k_4 = slope(t + h, &plus(&x, h, &k_3));
        for i in 0..6 {
            x[i] += h / 6.0 * (k_1[i] + 2.0 * k_2[i] + 2.0 * k_3[i] + k_4[i]);
        }
    }
    assert_eq!(wanted, None);
}

#[test]
fn a_current_of_the_zero_sequence_decays_by_itself() {
    let machine = Machine::new(samples::single(), samples::base().w);
    let (r_s, l_0) = (machine.circuit().r_s, 0.9 / 9.68);
    let mut psi = [0.0, 0.0, 0.0, 0.0, 0.1];
    samples::integrate(&machine, &mut psi, 1.0, (1e-5, 1000), |_, _| (ZERO, 0.0, 0.0));
    let expected = 0.1 * (-0.01 * machine.w_base * r_s / l_0).exp();
    assert!((psi[4] - expected).abs() < 1e-12, "{} {expected}", psi[4]);
    assert_eq!(psi[..4], [0.0; 4]);
    assert!((machine.zero_current(&psi) - expected / l_0).abs() < 1e-11);
}
