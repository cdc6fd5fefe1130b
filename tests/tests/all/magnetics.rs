//! Magnetic circuits against closed forms.

use blocksim_tests::{Run, problems, run_text};

const MU_0: f64 = 1.256_637_062_12e-6;

fn text(stop: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Auto(rtol: 1e-9)),
    blocks: {{ {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

/// `L = N^2 / (R_1 + R_2)` and `tau = L / R`.
#[test]
fn a_winding_on_two_reluctances_is_an_inductance() {
    let run = run_text(&text(
        "0.2 s",
        r#""u": VoltageSource(v: "12 V"), "g": ElectricalReference, "w": MagneticWinding(turns: 200.0, r: "0.8 ohm"),
           "iron": Reluctance(r: "4e5 1/H"), "gap": Reluctance(r: "1.6e6 1/H"), "zero": MagneticReference,
           "m": FluxSensor, "v": MagneticPotentialSensor, "account": EnergyAccount(at: Electrical, tolerance: 1e-7)"#,
        r#""u.p <-> w.p", "u.n <-> w.n <-> g.p <-> account.node", "w.mp <-> iron.p <-> v.p", "iron.n <-> m.p", "m.n <-> gap.p",
           "gap.n <-> w.mn <-> zero.p <-> v.n", "w.i -> s.i", "m.flux -> s.flux", "v.v -> s.v", "account.stored -> s.e""#,
        r#""i", "flux", "v", "e""#,
    ));
    let l = 200.0 * 200.0 / 2e6;
    for (row, t) in run.time.iter().enumerate() {
        let i = 15.0 * (1.0 - (-t * 0.8 / l).exp());
        assert!((run.column("s.i")[row] - i).abs() < 1e-6, "{} for {i} at {t} s", run.column("s.i")[row]);
        assert!((run.column("s.flux")[row] - l * i / 200.0).abs() < 1e-9);
        assert!((run.column("s.v")[row] - 200.0 * i).abs() < 1e-3);
        assert!((run.column("s.e")[row] - 0.5 * l * i * i).abs() < 1e-6);
    }
}

/// A voltage that is constant makes the linkage rise evenly: the current follows from the curve of the core.
#[test]
fn a_core_saturates_and_so_does_the_coil_on_it() {
    let run = run_text(&text(
        "0.1 s",
        r#""u": VoltageSource(v: "10 V"), "g": ElectricalReference, "w": MagneticWinding(turns: 500.0),
           "core": MagneticCore(length: "0.2 m", area: "4 cm^2", mu_r: 2000.0, saturation: "1.6 T"), "zero": MagneticReference,
           "coil": SaturatingInductor(l0: "10 mH", l_s: "0.5 mH", i_s: "4 A"),
           "account": EnergyAccount(at: Electrical, tolerance: 1e-6)"#,
        r#""u.p <-> w.p <-> coil.p", "u.n <-> w.n <-> coil.n <-> g.p <-> account.node", "w.mp <-> core.p", "w.mn <-> core.n <-> zero.p",
           "w.i -> s.i", "core.b -> s.b", "coil.i -> s.coil", "coil.psi -> s.psi""#,
        r#""i", "b", "coil", "psi""#,
    ));
    let (length, area, mu_r, j_s) = (0.2, 4e-4, 2000.0, 1.6);
    for (row, t) in run.time.iter().enumerate() {
        let i = run.column("s.i")[row];
        let h = 500.0 * i / length;
        let b = MU_0 * h + j_s * (MU_0 * (mu_r - 1.0) * h / j_s).tanh();
        assert!((500.0 * area * b - 10.0 * t).abs() < 1e-7, "{i} A at {t} s");
        assert!((run.column("s.b")[row] - b).abs() < 1e-8);
        let coil = run.column("s.coil")[row];
        let psi = 0.5e-3 * coil + 9.5e-3 * 4.0 * (coil / 4.0).tanh();
        assert!((psi - 10.0 * t).abs() < 1e-7 && (run.column("s.psi")[row] - psi).abs() < 1e-9);
    }
    // Far beyond the knee.
    assert!(
        run.last("s.b") > 1.6 && run.last("s.coil") > 1e3,
        "{} T, {} A",
        run.last("s.b"),
        run.last("s.coil")
    );
}

/// The current of a sharp core, found by bisection.
fn current(psi: f64, [l0, l_s, i_s]: [f64; 3]) -> f64 {
    let linkage = |i: f64| l_s * i + (l0 - l_s) * i_s * (i / i_s).tanh();
    let (mut low, mut high) = (psi.min(0.0) / l_s, psi.max(0.0) / l_s);
    for _ in 0..90 {
        let middle = 0.5 * (low + high);
        if linkage(middle) < psi { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The linkage of a coil behind 0.5 ohm at mains of 325 V and 50 Hz, by the classical method in steps of 2 us; shows the current after each step.
fn follow_mains(steps: usize, current: impl Fn(f64) -> f64, mut show: impl FnMut(usize, f64)) {
    let (h, mut psi) = (2e-6, 0.0);
    let slope = |t: f64, psi: f64| 325.0 * (2.0 * std::f64::consts::PI * 50.0 * t).sin() - 0.5 * current(psi);
    for step in 0..steps {
        let t = step as f64 * h;
        let k1 = slope(t, psi);
        let k2 = slope(t + 0.5 * h, psi + 0.5 * h * k1);
        let k3 = slope(t + 0.5 * h, psi + 0.5 * h * k2);
        psi += h / 6.0 * (k1 + 2.0 * (k2 + k3) + slope(t + h, psi + h * k3));
        show(step + 1, current(psi));
    }
}

/// A transformer without load is switched on at the zero of its voltage: its core saturates in every other half wave, ever less. At each zero the
/// current waits for the core to turn round. Where the current was the state steps went straight through that, and after ten periods
/// the peak was still -197 A where it is -102.4 A.
#[test]
fn the_inrush_of_a_transformer_dies_away() {
    let curve = [5.0, 5e-3, 0.1];
    let mut peaks = [0.0_f64; 10];
    follow_mains(
        100_000,
        |psi| current(psi, curve),
        |step, i| {
            let peak = &mut peaks[(step - 1) / 10_000];
            *peak = peak.max(i.abs());
        },
    );
    for solver in ["Auto", "Ode45", "Ode15s", "Radau5", "Dop853", "Rodas4"] {
        let run = run_text(&format!(
            r#"Diagram(
    simulation: (stop_time: "0.2 s", solver: {solver}, output: Every("20 us")),
    blocks: {{ "u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), "r": Resistor(r: "0.5 ohm"),
        "coil": SaturatingInductor(l0: "5 H", l_s: "5 mH", i_s: "0.1 A"), "g": ElectricalReference, "s": Scope(inputs: ["i"]) }},
    connections: ["u.p <-> r.p", "r.n <-> coil.p", "coil.n <-> u.n <-> g.p", "coil.i -> s.i"],
)"#
        ));
        for (period, right) in peaks.iter().enumerate() {
            let of_period =
                run.time.iter().zip(run.column("s.i")).filter(|(t, _)| (**t / 0.02) as usize == period);
            let peak = of_period.fold(0.0_f64, |most, (_, i)| most.max(i.abs()));
            assert!((peak / right - 1.0).abs() < 3e-4, "{solver}, period {period}: {peak} A, not {right} A");
        }
    }
}

/// A choke before the transformer, which saturates as well: both have one current, though each integrates its own linkage. It is found here from the
/// sum of the linkages.
#[test]
fn saturating_coils_in_series_have_one_current() {
    let curves = [[0.5, 1e-3, 1.0], [5.0, 5e-3, 0.1]];
    let linkage = |i: f64| {
        curves.iter().map(|[l0, l_s, i_s]| l_s * i + (l0 - l_s) * i_s * (i / i_s).tanh()).sum::<f64>()
    };
    let of_sum = |psi: f64| {
        let (mut low, mut high) = (psi.min(0.0) / 6e-3, psi.max(0.0) / 6e-3);
        for _ in 0..90 {
            let middle = 0.5 * (low + high);
            if linkage(middle) < psi { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let mut exact = vec![0.0];
    follow_mains(50_000, of_sum, |step, i| {
        if step % 500 == 0 {
            exact.push(i);
        }
    });
    for (solver, allowed) in
        [("Auto", 1e-4), ("Auto(rtol: 1e-4)", 2e-2), ("Ode15s", 1e-3), ("Radau5", 1e-4), ("Ode23t", 1e-3)]
    {
        let run = run_text(&format!(
            r#"Diagram(
    simulation: (stop_time: "0.1 s", solver: {solver}, output: Every("1 ms")),
    blocks: {{ "u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), "r": Resistor(r: "0.5 ohm"),
        "choke": SaturatingInductor(l0: "0.5 H", l_s: "1 mH", i_s: "1 A"),
        "coil": SaturatingInductor(l0: "5 H", l_s: "5 mH", i_s: "0.1 A"), "g": ElectricalReference, "s": Scope(inputs: ["a", "b"]) }},
    connections: ["u.p <-> r.p", "r.n <-> choke.p", "choke.n <-> coil.p", "coil.n <-> u.n <-> g.p", "choke.i -> s.a", "coil.i -> s.b"],
)"#
        ));
        let size = exact.iter().fold(0.0_f64, |most, i| most.max(i.abs()));
        for (t, row) in run.time.iter().zip(0..) {
            let right = exact[(t * 1e3).round() as usize];
            for name in ["s.a", "s.b"] {
                let found = run.column(name)[row];
                assert!(
                    (found - right).abs() < allowed * size,
                    "{solver}: {name} is {found} A at {t} s, not {right} A"
                );
            }
        }
    }
}

/// Two windings with leakage: without load the voltages have the ratio of the turns, less the leakage.
#[test]
fn two_windings_on_one_core_are_a_transformer() {
    let run = run_text(&text(
        "0.1 s",
        r#""u": AcVoltageSource(amplitude: Peak("100 V"), frequency: "50 Hz"), "g": ElectricalReference,
           "a": MagneticWinding(turns: 400.0, r: "0.5 ohm"), "b": MagneticWinding(turns: 100.0, r: "0.05 ohm"),
           "load": Resistor(r: "2 ohm"), "core": Reluctance(r: "1e5 1/H"), "leak_a": Reluctance(r: "2e7 1/H"),
           "leak_b": Reluctance(r: "2e7 1/H"), "zero": MagneticReference,
           "account": EnergyAccount(at: Electrical, tolerance: 1e-6)"#,
        r#""u.p <-> a.p", "u.n <-> a.n <-> b.n <-> load.n <-> g.p <-> account.node", "b.p <-> load.p",
           "a.mp <-> leak_a.p <-> core.p", "a.mn <-> leak_a.n <-> b.mn <-> leak_b.n <-> zero.p", "core.n <-> b.mp <-> leak_b.p",
           "load.v -> s.v", "load.i -> s.i""#,
        r#""v", "i""#,
    ));
    // In the steady state, by phasors: with the flux of a winding, mmf = N i.
    let w = 2.0 * std::f64::consts::PI * 50.0;
    let peak = run
        .time
        .iter()
        .zip(run.column("s.v"))
        .filter(|(t, _)| **t > 0.06)
        .fold(0.0_f64, |most, (_, v)| most.max(v.abs()));
    // Reluctances from each winding: leakage in parallel to the core in series with the other winding.
    // Inductances: L_a = N_a^2 (1/R_l + 1/R_c), M = N_a N_b / R_c, L_b = N_b^2 (1/R_l + 1/R_c).
    let (p_l, p_c) = (1.0 / 2e7, 1.0 / 1e5);
    let (l_a, l_b, m) = (400.0 * 400.0 * (p_l + p_c), 100.0 * 100.0 * (p_l + p_c), 400.0 * 100.0 * p_c);
    // 0 = (R_b + R + j w L_b) I_b + j w M I_a,  U = (R_a + j w L_a) I_a + j w M I_b; V = -R I_b.
    let z_b = (2.05, w * l_b);
    let z_a = (0.5, w * l_a);
    // I_b = -j w M U / (z_a z_b + w^2 M^2).
    let (re, im) = (z_a.0 * z_b.0 - z_a.1 * z_b.1 + w * w * m * m, z_a.0 * z_b.1 + z_a.1 * z_b.0);
    let expected = 2.0 * w * m * 100.0 / re.hypot(im);
    assert!((peak / expected - 1.0).abs() < 2e-3, "{peak} V for {expected} V");
}

fn brake(excitation: &str) -> Run {
    run_text(&text(
        "3 s",
        &format!(
            r#""still": RotationalReference, "j": Inertia(j: "0.5 kg*m^2", w0: "200 rad/s"),
               "b": EddyCurrentBrake(torque: "40 N*m", speed: "90 rad/s"), "e": Constant(value: {excitation}),
               "w": MotionSensor, "account": EnergyAccount(at: Rotational, tolerance: 1e-6)"#
        ),
        r#""b.r <-> j.r <-> w.r <-> account.node", "b.c <-> still.r <-> w.c", "e.y -> b.excitation", "w.w -> s.w""#,
        r#""w""#,
    ))
}

/// `J w' = -2 T s / (1 + s^2)` with `s = w / w_k`: `ln s + s^2 / 2` falls evenly.
#[test]
fn an_eddy_current_brake_slows_a_flywheel_down_along_its_curve() {
    for (excitation, share) in [("1.0", 1.0), ("0.5", 0.25)] {
        let run = brake(excitation);
        let measure = |w: f64| (w / 90.0_f64).ln() + 0.5 * (w / 90.0_f64).powi(2);
        for (t, w) in run.time.iter().zip(run.column("s.w")) {
            let expected = measure(200.0) - share * 2.0 * 40.0 / (0.5 * 90.0) * t;
            assert!((measure(*w) - expected).abs() < 1e-6, "{w} rad/s at {t} s");
        }
    }
}

#[test]
fn what_is_wrong_with_a_magnetic_circuit_is_said_in_its_terms() {
    let winding =
        r#""u": VoltageSource(v: 1.0), "g": ElectricalReference, "w": MagneticWinding(turns: 10.0)"#;
    let wires = r#""u.p <-> w.p", "u.n <-> w.n <-> g.p""#;
    let said = problems(
        &format!(r#"{winding}, "r": Reluctance(r: 1e6)"#),
        &format!(r#"{wires}, "w.mp <-> r.p", "w.mn <-> r.n""#),
    );
    assert!(
        said.contains("this magnetic network has no reference") && said.contains("a MagneticReference"),
        "{said}"
    );
    let said = problems(
        &format!(
            r#"{winding}, "x": MagneticWinding(turns: 5.0), "zero": MagneticReference, "load": Resistor(r: 1.0)"#
        ),
        &format!(
            r#"{wires}, "w.mp <-> x.mp", "w.mn <-> x.mn <-> zero.p", "x.p <-> load.p", "x.n <-> load.n <-> g.p""#
        ),
    );
    assert!(said.contains("flux") && said.contains("leakage"), "{said}");
    let said = problems(
        r#""v": Constant(value: "1 A"), "a": MmfSource, "b": MmfSource, "zero": MagneticReference"#,
        r#""v.y -> a.v", "v.y -> b.v", "a.p <-> b.p", "a.n <-> b.n <-> zero.p""#,
    );
    assert!(said.contains("two parts prescribe the same magnetic potential difference"), "{said}");
    let said =
        problems(r#""r": Reluctance(r: 1e6), "e": Resistor(r: 1.0)"#, r#""r.p <-> e.p", "r.n <-> e.n""#);
    assert!(said.contains("MagneticWinding leads from one to the other"), "{said}");
}
