//! Circuits with valves, floating parts and transformers against piecewise closed forms.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{Run, close, run_file, run_text};

/// A circuit with these blocks and connections beside a reference `g`, recorded by the scope `s`.
fn circuit(stop: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-9)),
    blocks: {{ "g": ElectricalReference, {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

/// A gate that is on for a share of each period.
fn gate(name: &str, period: &str, width: f64, delay: &str) -> (String, String) {
    (
        format!(
            r#""{name}_p": Pulse(period: "{period}", width: {width}, delay: "{delay}"), "{name}": Compare(operator: Greater, constant: 0.5)"#
        ),
        format!(r#""{name}_p.y -> {name}.u""#),
    )
}

/// Zero of a function between two times, by bisection.
fn zero(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    assert!(f(a) * f(b) < 0.0, "no sign change: {} and {}", f(a), f(b));
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if f(a) * f(middle) <= 0.0 { b = middle } else { a = middle }
    }
    0.5 * (a + b)
}

/// Times of all events of a valve that changes by itself.
fn changes(run: &Run, valve: &str) -> Vec<f64> {
    run.events.iter().filter(|(_, path, _)| path == valve).map(|(t, ..)| *t).collect()
}

/// A coil switched from a battery, with a freewheeling diode.
fn freewheel(v_f: f64, r_d: f64, period: &str, width: f64, stop: &str) -> Run {
    let (gates, wires) = gate("on", period, width, "1 ms");
    run_text(&circuit(
        stop,
        &format!(
            r#""u": VoltageSource(v: "24 V"), {gates}, "k": IdealSwitch(r_on: 0), "l": Inductor(l: "10 mH"),
               "r": Resistor(r: "2 Ohm"), "d": Diode(v_f: {v_f}, r_on: {r_d})"#
        ),
        &format!(
            r#"{wires}, "on.y -> k.gate", "u.p <-> k.p", "k.n <-> l.p <-> d.n", "l.n <-> r.p",
               "r.n <-> u.n <-> d.p <-> g.p", "l.i -> s.i", "d.i -> s.d""#
        ),
        r#""i", "d""#,
    ))
}

#[test]
fn an_ideal_freewheeling_diode_takes_the_current_over_without_a_jump() {
    let run = freewheel(0.0, 0.0, "5 ms", 0.4, "30 ms");
    let (tau, most) = (5e-3, 12.0);
    for (row, t) in run.time.iter().enumerate() {
        let mut i = 0.0;
        let mut at = 1e-3;
        while at < *t {
            let on = (t - at).min(2e-3);
            i = most + (i - most) * (-on / tau).exp();
            let off = (t - at - 2e-3).clamp(0.0, 3e-3);
            i *= (-off / tau).exp();
            at += 5e-3;
        }
        close(run.column("s.i")[row], i, 1e-7, &format!("current at {t}"));
    }
    assert!(run.column("s.d").iter().all(|i| *i > -1e-9));
}

#[test]
fn a_real_freewheeling_diode_ends_the_current_at_the_instant_of_the_closed_form() {
    let run = freewheel(0.6, 0.01, "50 ms", 0.2, "200 ms");
    let (l, r): (f64, f64) = (10e-3, 2.0);
    let i0 = 12.0 * (1.0 - (-10e-3 * r / l).exp());
    let whole = r + 0.01;
    let lasts = l / whole * (1.0 + whole * i0 / 0.6).ln();
    let ends: Vec<f64> = changes(&run, "d");
    for k in 0..4 {
        let expected = 11e-3 + 50e-3 * f64::from(k) + lasts;
        let best = ends.iter().map(|t| (t - expected).abs()).fold(f64::INFINITY, f64::min);
        assert!(best < 1e-9, "{expected} is not among {ends:?}");
    }
    for (row, t) in run.time.iter().enumerate() {
        let since = (t - 1e-3).rem_euclid(50e-3);
        let i = match since {
            _ if *t < 1e-3 => 0.0,
            s if s <= 10e-3 => 12.0 * (1.0 - (-s * r / l).exp()),
            s if s < 10e-3 + lasts => {
                let end = 0.6 / whole;
                (i0 + end) * (-(s - 10e-3) * whole / l).exp() - end
            }
            _ => 0.0,
        };
        close(run.column("s.i")[row], i, 1e-7, &format!("current at {t}"));
    }
}

#[test]
fn a_half_wave_rectifier_extinguishes_at_the_root_of_its_transcendental_equation() {
    let (v, f, r, l) = (325.0, 50.0, 10.0, 50e-3);
    let w = TAU * f;
    let (z, phi, tau) = (f64::hypot(r, w * l), (w * l / r).atan(), l / r);
    for v_f in [0.0_f64, 50.0] {
        let run = run_text(&circuit(
            "60 ms",
            &format!(
                r#""u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), "d": Diode(v_f: {v_f}, r_on: 0),
                   "l": Inductor(l: "50 mH"), "r": Resistor(r: "10 Ohm")"#
            ),
            r#""u.p <-> d.p", "d.n <-> l.p", "l.n <-> r.p", "r.n <-> u.n <-> g.p", "l.i -> s.i""#,
            r#""i""#,
        ));
        let start = (v_f / v).asin() / w;
        let free = |t: f64| v / z * (w * t - phi).sin() - v_f / r;
        let current = |t: f64| free(t) - free(start) * (-(t - start) / tau).exp();
        let end = zero(current, 10e-3, 19e-3);
        let found = changes(&run, "d");
        for k in 0..3 {
            let expected = end + 20e-3 * f64::from(k);
            let best = found.iter().map(|t| (t - expected).abs()).fold(f64::INFINITY, f64::min);
            assert!(best < 1e-9, "{expected} is not among {found:?}");
        }
        for (row, t) in run.time.iter().enumerate() {
            let since = t.rem_euclid(20e-3);
            let i = if since > start && since < end { current(since) } else { 0.0 };
            close(run.column("s.i")[row], i, 2e-6, &format!("current at {t}"));
        }
    }
}

#[test]
fn a_full_wave_rectifier_of_ideal_diodes_gives_the_absolute_value() {
    // From an ideal source into R and L: all diodes change at the zeros of the voltage.
    let run = run_text(&circuit(
        "60 ms",
        r#""u": AcVoltageSource(amplitude: Peak("100 V"), frequency: "50 Hz", phase: "30 deg"),
           "b": SinglePhaseRectifier(v_f: 0, r_on: "1 mOhm"), "l": Inductor(l: "20 mH"), "r": Resistor(r: "5 Ohm"),
           "m": VoltageSensor, "a": CurrentSensor"#,
        r#""u.p <-> a.p", "a.n <-> b.a", "u.n <-> b.b", "b.p <-> l.p <-> m.p", "l.n <-> r.p",
           "r.n <-> b.n <-> m.n <-> g.p", "l.i -> s.i", "m.v -> s.v", "a.i -> s.line""#,
        r#""i", "v", "line""#,
    ));
    let (w, r, l) = (TAU * 50.0, 5.0 + 2e-3, 20e-3);
    let (z, phi) = (f64::hypot(r, w * l), (w * l / r).atan());
    // From zero to zero: the current of a half wave that starts at i0.
    let wave = |angle: f64, from: f64, i0: f64| {
        let forced = |a: f64| 100.0 / z * (a - phi).sin();
        forced(angle) + (i0 - forced(from)) * (-(angle - from) / w * r / l).exp()
    };
    for (row, t) in run.time.iter().enumerate() {
        let (mut from, mut i) = (PI / 6.0, 0.0);
        let mut angle = w * t + PI / 6.0;
        while angle > PI + 1e-12 {
            i = wave(PI, from, i);
            (from, angle) = (0.0, angle - PI);
        }
        i = wave(angle, from, i);
        close(run.column("s.i")[row], i, 2e-6, &format!("current at {t}"));
        close(run.column("s.line")[row].abs(), i, 2e-6, &format!("line current at {t}"));
        close(run.column("s.v")[row], 100.0 * angle.sin() - 2e-3 * i, 1e-5, &format!("voltage at {t}"));
    }
}

#[test]
fn a_thyristor_waits_for_its_gate_and_conducts_until_its_current_ends() {
    let (v, r, l) = (325.0, 10.0, 50e-3);
    let (gates, wires) = gate("on", "20 ms", 0.01, "4 ms");
    let run = run_text(&circuit(
        "50 ms",
        &format!(
            r#""u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), {gates}, "d": Thyristor(v_f: 0, r_on: 0),
               "l": Inductor(l: "50 mH"), "r": Resistor(r: "10 Ohm")"#
        ),
        &format!(
            r#"{wires}, "on.y -> d.gate", "u.p <-> d.p", "d.n <-> l.p", "l.n <-> r.p", "r.n <-> u.n <-> g.p", "l.i -> s.i""#
        ),
        r#""i""#,
    ));
    let w = TAU * 50.0;
    let (z, phi, tau) = (f64::hypot(r, w * l), (w * l / r).atan(), l / r);
    let free = |t: f64| v / z * (w * t - phi).sin();
    let current = |t: f64| free(t) - free(4e-3) * (-(t - 4e-3) / tau).exp();
    let end = zero(current, 10e-3, 19e-3);
    let found = changes(&run, "d");
    assert!(found.iter().any(|t| (t - end).abs() < 1e-9), "{end} is not among {found:?}");
    for (row, t) in run.time.iter().enumerate() {
        let since = t.rem_euclid(20e-3);
        let i = if since > 4e-3 && since < end { current(since) } else { 0.0 };
        close(run.column("s.i")[row], i, 2e-6, &format!("current at {t}"));
    }
}

/// Two valves without resistance side by side: that with the lower forward voltage takes all, whatever the blocks are called.
#[test]
fn of_two_ideal_valves_in_parallel_the_one_with_less_voltage_conducts() {
    for [thyristor, diode] in [["a", "b"], ["b", "a"]] {
        for (v_f, right) in [("0.6", [0.0, 11.6, 11.7, 0.0]), ("1.2", [0.0, 11.6, 0.0, 11.6])] {
            let run = run_text(&circuit(
                "0.2 s",
                &format!(
                    r#""u": VoltageSource(v: "24 V"), "r": Resistor(r: "2 Ohm"), "{thyristor}": Thyristor(v_f: {v_f}, r_on: 0),
                       "{diode}": Diode(v_f: 0.8, r_on: 0), "step": Step(time: "0.1 s"), "on": Compare(operator: Greater, constant: 0.5)"#
                ),
                &format!(
                    r#""u.p <-> r.p", "r.n <-> a.p <-> b.p", "u.n <-> a.n <-> b.n <-> g.p", "step.y -> on.u", "on.y -> {thyristor}.gate",
                       "{thyristor}.i -> s.thyristor", "{diode}.i -> s.diode""#
                ),
                r#""thyristor", "diode""#,
            ));
            let found = [
                run.at("s.thyristor", 0.05),
                run.at("s.diode", 0.05),
                run.last("s.thyristor"),
                run.last("s.diode"),
            ];
            for (found, right) in found.iter().zip(right) {
                assert!((found - right).abs() < 1e-9, "{thyristor}, {v_f} V: {found}, not {right}");
            }
        }
    }
}

#[test]
fn a_star_of_three_different_coils_finds_the_potential_of_its_point() {
    let run = run_text(&circuit(
        "40 ms",
        r#""u": ThreePhaseSource(voltage: "400 V", frequency: "50 Hz"), "x": PhaseSplitter, "la": Inductor(l: "5 mH"),
           "lb": Inductor(l: "10 mH"), "lc": Inductor(l: "20 mH"), "m": VoltageSensor"#,
        r#""u.ac <-> x.ac", "x.a <-> la.p", "x.b <-> lb.p", "x.c <-> lc.p", "la.n <-> lb.n <-> lc.n <-> m.p", "m.n <-> g.p",
           "la.i -> s.a", "lb.i -> s.b", "lc.i -> s.c", "m.v -> s.n""#,
        r#""a", "b", "c", "n""#,
    ));
    let w = TAU * 50.0;
    let peak = 400.0 * (2.0_f64 / 3.0).sqrt();
    let l = [5e-3, 10e-3, 20e-3];
    let total: f64 = l.iter().map(|l| 1.0 / l).sum();
    for (row, t) in run.time.iter().enumerate() {
        let at = |k: usize| w * t - k as f64 * TAU / 3.0;
        let v = |k: usize| peak * at(k).cos();
        let area = |k: usize| peak / w * (at(k).sin() + (k as f64 * TAU / 3.0).sin());
        let mean = |f: &dyn Fn(usize) -> f64| (0..3).map(|k| f(k) / l[k]).sum::<f64>() / total;
        close(run.column("s.n")[row], mean(&v), 1e-8, "star point");
        for (k, name) in ["s.a", "s.b", "s.c"].iter().enumerate() {
            close(run.column(name)[row], (area(k) - mean(&area)) / l[k], 1e-5, name);
        }
    }
}

#[test]
fn a_star_draws_what_its_delta_draws() {
    // Three branches R, L in star, and 3 R, 3 L in delta by a cyclic exchange of the phases.
    let lines = |load: &str, joined: &str| {
        // The source stands on ground by itself.
        let whole = circuit(
            "40 ms",
            &format!(
                r#""u": ThreePhaseSource(voltage: "400 V", frequency: "50 Hz"), "a": ThreePhaseCurrentSensor, {load}"#
            ),
            &format!(r#""u.ac <-> a.ac1", {joined}, "a.i -> s.i""#),
            r#""i""#,
        );
        run_text(&whole.replace("\"g\": ElectricalReference, ", ""))
    };
    let star = lines(
        r#""z": ThreePhaseRlc(r: "1 Ohm", l: "10 mH"), "n": FloatingNeutral"#,
        r#""a.ac2 <-> z.ac1", "z.ac2 <-> n.ac""#,
    );
    let delta = lines(
        r#""z": ThreePhaseRlc(r: "3 Ohm", l: "30 mH"), "x": PhasePermute"#,
        r#""a.ac2 <-> z.ac1 <-> x.ac1", "z.ac2 <-> x.ac2""#,
    );
    let w = TAU * 50.0;
    let (z, phi) = (f64::hypot(1.0, w * 10e-3), (w * 10e-3_f64).atan());
    let peak = 400.0 * (2.0_f64 / 3.0).sqrt();
    for run in [star, delta] {
        for (row, t) in run.time.iter().enumerate() {
            for k in 0..3 {
                let from = k as f64 * TAU / 3.0;
                let forced = |t: f64| peak / z * (w * t - from - phi).cos();
                let i = forced(*t) - forced(0.0) * (-t * 1.0 / 10e-3).exp();
                close(run.column(&format!("s.i[{k}]"))[row], i, 1e-5, &format!("phase {k} at {t}"));
            }
        }
    }
}

#[test]
fn a_rectifier_bridge_gives_its_mean_voltage_less_what_commutation_costs() {
    let run = run_file("diagrams/rectifier_bridge.ron", &[]);
    // The mean over the last ten periods, 0.2 s; what the coil takes in them is nothing.
    let (t, i) = (&run.time, run.column("dc.i"));
    let (mut charge, mut least, mut most) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
    for k in (1..t.len()).filter(|k| t[*k - 1] >= 0.3 - 1e-12) {
        charge += 0.5 * (i[k] + i[k - 1]) * (t[k] - t[k - 1]);
        (least, most) = (least.min(i[k]), most.max(i[k]));
    }
    let (mean, peak, reactance) = (charge / 0.2, 400.0 * 2.0_f64.sqrt(), TAU * 50.0 * 1e-3);
    // Two diodes of 1 mOhm are in the path of the current, one and a half of them while two conduct together.
    let expected = (3.0 * peak / PI) / (10.0 + 3.0 * reactance / PI + 2e-3);
    close(mean, expected, 1e-4 * expected, "mean current");
    assert!(most - least < 0.3, "the current is not smooth: {least} to {most} A");

    // Angle of overlap: 1 - cos(mu) = 2 X I / peak. A diode begins where its phase voltage meets that of the one before.
    let events = |t: f64| run.events.iter().filter(move |(at, ..)| *at > t).map(|(at, ..)| *at);
    let period = 0.02;
    // Two phases meet at every sixth of a period, the highest at the odd ones.
    let natural = 0.48 + period / 6.0;
    let start = events(natural - 1e-5).next().unwrap_or(f64::NAN);
    let end = events(start + 1e-6).next().unwrap_or(f64::NAN);
    close(start, natural, 2e-6, "begin of commutation");
    let overlap = (1.0 - 2.0 * reactance * mean / peak).acos();
    close((end - start) * TAU / period, overlap, 2e-3 * overlap, "overlap");
}

#[test]
fn a_source_whose_star_point_stays_open_carries_no_zero_sequence() {
    let currents = |star: &str, load: &str, ends: &str| {
        let text = circuit(
            "1 ms",
            &format!(
                r#""k": Constant(value: ["9 V", "0 V", "3 V"]), "u": ControlledThreePhaseSource, "a": ThreePhaseCurrentSensor, {load}"#
            ),
            &format!(r#""k.y -> u.v", "u.ac <-> a.ac1", "a.i -> s.i", {star} {ends}"#),
            r#""i""#,
        );
        let unused = if star.is_empty() { "\"g\": ElectricalReference, " } else { "" };
        let run = run_text(&text.replace(unused, ""));
        [0, 1, 2].map(|k| run.last(&format!("s.i[{k}]")))
    };
    let (load, ends) =
        (r#""z": ThreePhaseRlc(r: "2 Ohm"), "n": GroundedNeutral"#, r#""a.ac2 <-> z.ac1", "z.ac2 <-> n.ac""#);
    assert_eq!(currents(r#""u.n <-> g.p","#, load, ends), [4.5, 0.0, 1.5]);
    // Without the mean of 4 V.
    for (found, expected) in currents("", load, ends).into_iter().zip([2.5, -2.0, -0.5]) {
        close(found, expected, 1e-13, "open star point");
    }
    // Nothing refers to anything: a load in delta of the same size.
    let (delta, ends) = (
        r#""z": ThreePhaseRlc(r: "6 Ohm"), "x": PhasePermute"#,
        r#""a.ac2 <-> z.ac1 <-> x.ac1", "z.ac2 <-> x.ac2""#,
    );
    for (found, expected) in currents("", delta, ends).into_iter().zip([2.5, -2.0, -0.5]) {
        close(found, expected, 1e-13, "all floats");
    }
}
