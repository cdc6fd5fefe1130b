//! Circuits that wait for their first current, and currents that end beside others which go on.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{Run, close, run_blocks};

use super::METHODS;

/// A thyristor that is always on and one that is fired at 7 ms, with inductances on both sides of the first.
fn two_thyristors(solver: &str) -> Run {
    run_blocks(
        "18 ms",
        solver,
        r#""source": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), "g": ElectricalReference,
           "l": Inductor(l: "1 mH"), "l2": Inductor(l: "10 mH"), "r": Resistor(r: "5 Ohm"),
           "on": Constant(value: true), "late": Pulse(period: "20 ms", width: 0.1, delay: "7 ms"),
           "fires": Compare(operator: Greater, constant: 0.5), "first": Thyristor(v_f: "0 V", r_on: "0 Ohm"),
           "second": Thyristor(v_f: "0 V", r_on: "0 Ohm"), "s": Scope(inputs: ["i", "i2"])"#,
        r#""source.p <-> l.p", "l.n <-> first.p", "first.n <-> l2.p", "l2.n <-> r.p", "r.n <-> second.p",
           "second.n <-> source.n <-> g.p", "on.y -> first.gate", "late.y -> fires.u", "fires.y -> second.gate",
           "l.i -> s.i", "l2.i -> s.i2""#,
    )
}

#[test]
fn nothing_is_followed_in_a_circuit_that_waits_for_its_first_current() {
    // i' = (u sin(w t) - r i)/l from 7 ms on.
    let (u, w, r, l, fired): (f64, f64, f64, f64, f64) = (325.0, TAU * 50.0, 5.0, 11e-3, 7e-3);
    let (z, phi) = (r.hypot(w * l), (w * l).atan2(r));
    let current = |t: f64| {
        let steady = |t: f64| u / z * (w * t - phi).sin();
        if t < fired { 0.0 } else { steady(t) - steady(fired) * (-(t - fired) * r / l).exp() }
    };
    for method in METHODS {
        for rtol in ["1e-4", "1e-6", "1e-8"] {
            let run = two_thyristors(&format!("{method}(rtol: {rtol})"));
            let before = run.time.iter().filter(|t| **t < fired).count();
            assert!(before < 500, "{method}, {rtol}: {before} rows before the first current");
            let largest = 40.0;
            let tolerance = largest * if rtol == "1e-4" { 3e-3 } else { 1e-4 };
            let passes = run.time.iter().rposition(|t| *t < 10.5e-3).expect("rows");
            close(
                run.column("s.i")[passes],
                current(run.time[passes]),
                tolerance,
                &format!("{method}, {rtol}"),
            );
            close(run.column("s.i2")[passes], run.column("s.i")[passes], 1e-6, "one current");
            close(run.last("s.i"), 0.0, 1e-9, &format!("{method}, {rtol}: it has ended"));
        }
    }
}

#[test]
fn a_commutation_ends_without_interrupting_any_current() {
    for method in METHODS {
        for rtol in ["1e-4", "1e-6"] {
            bridge_gives_its_mean(&format!("{method}(rtol: {rtol})"), 60.0, 0.0, "1 mOhm", "0 S");
        }
    }
}

/// What a thyristor carries at its forward voltage is a millionth of an ampere, and a difference of voltages over ten milliohms is known to
/// less than a part of that. The voltage is that of what flows through a millionth of a siemens, so the rows between steps must be
/// as exact as their ends.
#[test]
fn thyristors_that_leak_find_who_conducts() {
    for method in ["Auto", "Ode15s", "Radau5", "Rodas4", "Ode23t", "Ode23tb"] {
        bridge_gives_its_mean(&format!("{method}(rtol: 1e-6)"), 0.0, 0.8, "10 mOhm", "1e-6 S");
    }
}

/// Six thyristors fired so many degrees behind natural commutation, with inductances in the lines and one in the load.
fn bridge_gives_its_mean(solver: &str, alpha: f64, v_f: f64, r_on: &str, g_off: &str) {
    let resistance = if r_on == "10 mOhm" { 0.010 } else { 0.001 };
    let pulses: Vec<String> = (0..6)
        .map(|k| {
            format!(
                r#""p{k}": Pulse(period: "20 ms", width: 0.33, delay: {:?}), "g{k}": Compare(operator: Greater, constant: 0.5),
                   "t{k}": Thyristor(v_f: {v_f:?}, r_on: "{r_on}", g_off: "{g_off}")"#,
                (f64::from(k) * 0.02 / 6.0 + (alpha - 60.0) / 360.0 * 0.02).rem_euclid(0.02)
            )
        })
        .collect();
    let gates: Vec<String> =
        (0..6).map(|k| format!(r#""p{k}.y -> g{k}.u", "g{k}.y -> t{k}.gate""#)).collect();
    let blocks = format!(
        r#""mains": ThreePhaseSource(voltage: "400 V", frequency: "50 Hz", neutral: Floating),
           "line": ThreePhaseRlc(r: "10 mOhm", l: "1 mH"), "split": PhaseSplitter, "g": ElectricalReference,
           "coil": Inductor(l: "50 mH"), "load": Resistor(r: "5 Ohm"), "meter": VoltageSensor, "s": Scope(inputs: ["v", "i"]),
           {}"#,
        pulses.join(", ")
    );
    let wires = format!(
        r#""mains.ac <-> line.ac1", "line.ac2 <-> split.ac", "split.a <-> t0.p <-> t3.n", "split.b <-> t2.p <-> t5.n",
           "split.c <-> t4.p <-> t1.n", "t0.n <-> t2.n <-> t4.n <-> coil.p <-> meter.p", "coil.n <-> load.p",
           "t1.p <-> t3.p <-> t5.p <-> load.n <-> meter.n <-> g.p", "meter.v -> s.v", "coil.i -> s.i", {}"#,
        gates.join(", ")
    );
    let run = run_blocks("0.12 s", solver, &blocks, &wires);
    assert!(run.time.len() < 30_000, "{solver}: {} rows", run.time.len());
    let (t, v, i) = (&run.time, run.column("s.v"), run.column("s.i"));
    let first = t.iter().rposition(|at| *at <= 0.1 + 1e-9).expect("rows");
    let mean = |y: &[f64]| {
        let area: f64 = (first + 1..t.len()).map(|n| 0.5 * (y[n] + y[n - 1]) * (t[n] - t[n - 1])).sum();
        area / (t[t.len() - 1] - t[first])
    };
    // The lines take 3/pi w L of the current while it commutates, and what conducts its voltages.
    let (v, i) = (mean(v), mean(i));
    // Phase a is at its crest at zero, and has passed phase c a sixth of a period before.
    let expected = 3.0 / PI * 400.0 * 2_f64.sqrt() * alpha.to_radians().cos()
        - i * (3.0 / PI * TAU * 50.0 * 1e-3 + 2.0 * 0.010 + 2.0 * resistance)
        - 2.0 * v_f;
    // Over a period the coil has no voltage in the mean.
    close(5.0 * i, expected, 0.01 * expected, &format!("{solver}, {alpha} deg: by the current"));
    close(v, expected, 0.01 * expected, &format!("{solver}, {alpha} deg"));
}
