//! Loops of capacitors and ideal voltages, whose voltages depend on each other, against closed forms and against
//! charges of nodes, which are independent.

use blocksim_tests::{Run, compile_text, run_text};
use expect_test::expect;

fn text(stop: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-9)),
    blocks: {{ "g": ElectricalReference, {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

fn circuit(stop: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    run_text(&text(stop, blocks, connections, shown))
}

/// The worst distance of a column from a function of time, over the largest value of the function.
fn off(run: &Run, column: &str, of: impl Fn(f64) -> f64) -> f64 {
    let expected: Vec<f64> = run.time.iter().map(|t| of(*t)).collect();
    let most = expected.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let values = run.column(column).iter().zip(&expected);
    assert!(run.time.len() > 5 && most > 0.0);
    values.fold(0.0_f64, |worst, (found, expected)| worst.max((found - expected).abs())) / most
}

#[test]
fn capacitors_in_parallel_are_one() {
    let run = circuit(
        "3 ms",
        r#""u": VoltageSource(v: "10 V"), "r": Resistor(r: "1 kOhm"), "a": Capacitor(c: "0.2 uF"), "b": Capacitor(c: "0.7 uF"),
           "e": Capacitor(c: "0.1 uF"), "m": CurrentSensor"#,
        r#""u.p <-> r.p", "r.n <-> a.p <-> m.p <-> e.n", "m.n <-> b.p", "u.n <-> a.n <-> b.n <-> e.p <-> g.p", "a.v -> s.a", "b.v -> s.b",
           "e.v -> s.e", "m.i -> s.i""#,
        r#""a", "b", "e", "i""#,
    );
    let v = |t: f64| 10.0 * (1.0 - (-t / 1e-3).exp());
    assert!(off(&run, "s.a", v) < 1e-8 && off(&run, "s.b", v) < 1e-8);
    assert!(off(&run, "s.e", |t| -v(t)) < 1e-8);
    // The share of the whole current.
    assert!(off(&run, "s.i", |t| 0.7 * 10e-3 * (-t / 1e-3).exp()) < 1e-8);
}

#[test]
fn a_capacitor_across_the_mains_takes_the_slope_of_their_voltage() {
    let w = std::f64::consts::TAU * 50.0;
    let run = circuit(
        "50 ms",
        r#""u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz", phase: "30 deg"), "c": Capacitor(c: "10 uF"),
           "r": Resistor(r: "100 Ohm"), "m": CurrentSensor, "account": EnergyAccount(at: Electrical)"#,
        r#""u.p <-> m.p", "m.n <-> c.p <-> r.p", "u.n <-> c.n <-> r.n <-> g.p <-> account.node", "m.i -> s.i", "c.v -> s.v",
           "account.error -> s.error""#,
        r#""i", "v", "error""#,
    );
    let phase = 30f64.to_radians();
    let v = |t: f64| 325.0 * (w * t + phase).sin();
    assert!(off(&run, "s.v", v) < 1e-13);
    assert!(off(&run, "s.i", |t| v(t) / 100.0 + 10e-6 * w * 325.0 * (w * t + phase).cos()) < 1e-12);
    assert!(run.column("s.error").iter().all(|e| e.abs() < 1e-6), "{:?}", run.last("s.error"));
}

#[test]
fn a_divider_across_a_signal_passes_its_jumps_and_forgets_them() {
    // C1 from the source to the node, C2 and R from there to ground: v' (C1 + C2) + v / R = C1 u'.
    let (c1, c2, r) = (3e-6, 1e-6, 500.0);
    let tau = r * (c1 + c2);
    let run = circuit(
        "6 ms",
        r#""w": Step(time: "1 ms", before: "1 V", after: "9 V"), "u": ControlledVoltageSource, "c1": Capacitor(c: "3 uF"),
           "c2": Capacitor(c: "1 uF"), "r": Resistor(r: "500 Ohm"), "v": VoltageSensor"#,
        r#""w.y -> u.v", "u.p <-> c1.p", "c1.n <-> c2.p <-> r.p <-> v.p", "u.n <-> c2.n <-> r.n <-> v.n <-> g.p", "c1.v -> s.a",
           "c2.v -> s.b", "v.v -> s.v""#,
        r#""a", "b", "v""#,
    );
    let share = c1 / (c1 + c2);
    let u = |t: f64| if t < 1e-3 { 1.0 } else { 9.0 };
    // Behind the jump only: a row on it may lie on either side.
    let v = |t: f64| {
        let jump = if t < 1e-3 { 0.0 } else { 8.0 * (-(t - 1e-3) / tau).exp() };
        share * (1.0 * (-t / tau).exp() + jump)
    };
    for (row, t) in run.time.iter().enumerate().filter(|(_, t)| (**t - 1e-3).abs() > 1e-12) {
        let at = |name: &str| run.column(name)[row];
        assert!((at("s.v") - v(*t)).abs() < 1e-7, "{} at {t}", at("s.v"));
        assert!((at("s.b") - at("s.v")).abs() < 1e-13);
        assert!((at("s.a") + at("s.b") - u(*t)).abs() < 1e-12);
    }
    let jumps: Vec<f64> =
        run.time.iter().zip(run.column("s.v")).filter(|(t, _)| **t == 1e-3).map(|(_, v)| *v).collect();
    assert!((jumps.last().unwrap() - v(1e-3)).abs() < 1e-7, "{jumps:?}");
}

/// A third-order Cauer low-pass: L with C2 beside it between C1 and C3, all between equal resistances. By its nodes a and b
/// `(u - a) / R = C1 a' + C2 (a - b)' + i`, `C2 (a - b)' + i = C3 b' + b / R`, `L i' = a - b`.
#[test]
fn a_drawn_cauer_filter_does_what_its_transfer_function_says() {
    let (r, l, c1, c2, c3) = (50.0, 20e-6, 10e-9, 2e-9, 15e-9);
    let f = 200e3;
    let run = circuit(
        "200 us",
        &format!(
            r#""w": Sine(amplitude: "1 V", frequency: "{f} Hz"), "u": ControlledVoltageSource, "rs": Resistor(r: {r}), "l": Inductor(l: {l}),
            "c1": Capacitor(c: {c1}), "c2": Capacitor(c: {c2}), "c3": Capacitor(c: {c3}), "rl": Resistor(r: {r}), "m": CurrentSensor"#
        ),
        r#""w.y -> u.v", "u.p <-> rs.p", "rs.n <-> c1.p <-> l.p <-> m.p", "m.n <-> c2.p", "l.n <-> c2.n <-> c3.p <-> rl.p",
           "u.n <-> c1.n <-> c3.n <-> rl.n <-> g.p", "c1.v -> s.a", "c3.v -> s.b", "c2.v -> s.c", "m.i -> s.i""#,
        r#""a", "b", "c", "i""#,
    );
    // Charges of the nodes, q_a = (C1 + C2) a - C2 b and q_b = (C2 + C3) b - C2 a, are independent: integrated by the
    // classical method in small steps.
    let determinant = (c1 + c2) * (c2 + c3) - c2 * c2;
    let nodes = |q: [f64; 3]| {
        [((c2 + c3) * q[0] + c2 * q[1]) / determinant, (c2 * q[0] + (c1 + c2) * q[1]) / determinant]
    };
    let u = |t: f64| (std::f64::consts::TAU * f * t).sin();
    let slope = |t: f64, q: [f64; 3]| {
        let [a, b] = nodes(q);
        [(u(t) - a) / r - q[2], q[2] - b / r, (a - b) / l]
    };
    let h = 10e-9;
    let (mut q, mut worst, mut at) = ([0.0; 3], 0.0_f64, vec![[0.0; 2]]);
    let plus = |q: [f64; 3], k: [f64; 3], h: f64| [q[0] + h * k[0], q[1] + h * k[1], q[2] + h * k[2]];
    for step in 0..20_000 {
        let t = f64::from(step) * h;
        let k1 = slope(t, q);
        let k2 = slope(t + h / 2.0, plus(q, k1, h / 2.0));
        let k3 = slope(t + h / 2.0, plus(q, k2, h / 2.0));
        let k4 = slope(t + h, plus(q, k3, h));
        for i in 0..3 {
            q[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        at.push(nodes(q));
    }
    for (name, node) in [("s.a", 0), ("s.b", 1)] {
        for (row, t) in run.time.iter().enumerate() {
            let k = (t / h).floor() as usize;
            let share = t / h - k as f64;
            let next = at[(k + 1).min(at.len() - 1)][node];
            let expected = at[k.min(at.len() - 1)][node] * (1.0 - share) + next * share;
            worst = worst.max((run.column(name)[row] - expected).abs());
        }
    }
    // Straight lines over 10 ns are off by (w h)^2 / 8.
    assert!(worst < 3e-5, "{worst}");
    // The steady state by phasors at the end.
    let w = std::f64::consts::TAU * f;
    let admittance = 1.0 / (w * l) - w * c2;
    // Y_s = -j admittance: |b / u| from the chain of 1/R + jwC1, Y_s, jwC3 + 1/R.
    let (g1, b1, b3) = (1.0 / r, w * c1, w * c3);
    // D = (Y1 + Ys)(Y3 + Ys) - Ys^2 = Y1 Y3 + Ys (Y1 + Y3), b = Ys u / R / D.
    let real = g1 * g1 - b1 * b3 + admittance * (b1 + b3);
    let imaginary = g1 * (b1 + b3) - admittance * 2.0 * g1;
    let gain = admittance.abs() * g1 / real.hypot(imaginary);
    let late = run.time.iter().zip(run.column("s.b")).filter(|(t, _)| **t > 150e-6);
    let peak = late.fold(0.0_f64, |most, (_, v)| most.max(v.abs()));
    assert!((peak / gain - 1.0).abs() < 2e-2, "{peak} {gain}");
    for row in 0..run.time.len() {
        let at = |name: &str| run.column(name)[row];
        assert!((at("s.a") - at("s.b") - at("s.c")).abs() < 1e-12);
    }
}

#[test]
fn an_amplifier_with_capacitors_around_it_is_an_integrator_with_a_pole() {
    // Gain A = 1000 with a pole at 10 Hz; C = 100 nF fed back, 10 nF at its input, 10 kOhm in front.
    let run = circuit(
        "2 ms",
        r#""w": Constant(value: "1 V"), "u": ControlledVoltageSource, "r": Resistor(r: "10 kOhm"), "cf": Capacitor(c: "100 nF"),
           "ci": Capacitor(c: "10 nF"), "sense": VoltageSensor, "a": TransferFunction(num: [1e3], den: [0.0159154943, 1], k: "-1"),
           "out": ControlledVoltageSource"#,
        r#""w.y -> u.v", "u.p <-> r.p", "r.n <-> cf.p <-> ci.p <-> sense.p", "sense.v -> a.u", "a.y -> out.v, s.out", "out.p <-> cf.n",
           "u.n <-> ci.n <-> sense.n <-> out.n <-> g.p", "sense.v -> s.across""#,
        r#""out", "across""#,
    );
    // (Cf + Ci) v' = (1 - v) / R + Cf e', T e' = -A v - e: by diagonalisation of the two equations.
    let (r, cf, ci, a, t1) = (1e4_f64, 100e-9, 10e-9, 1e3, 0.0159154943);
    // v' = (1 - v) / (R Cs) + k (-A v - e) / T with k = Cf / Cs.
    let (cs, k) = (cf + ci, cf / (cf + ci));
    let matrix = [[-1.0 / (r * cs) - k * a / t1, -k / t1], [-a / t1, -1.0 / t1]];
    let (trace, det) =
        (matrix[0][0] + matrix[1][1], matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0]);
    let root = (trace * trace / 4.0 - det).sqrt();
    let fast = trace / 2.0 - root;
    let slow = det / fast;
    // At rest v = 1 and e = -A.
    let e1 = -a;
    // Start at v = e = 0: e(t) = e1 + p exp(slow t) + q exp(fast t), e'(0) = 0.
    let p = -e1 * fast / (fast - slow);
    let q = -e1 - p;
    let e = |t: f64| e1 + p * (slow * t).exp() + q * (fast * t).exp();
    for (row, t) in run.time.iter().enumerate() {
        let found = run.column("s.out")[row];
        assert!((found - e(*t)).abs() < 1e-6, "{found} {} at {t}", e(*t));
    }
    assert!((run.last("s.out") + 2e-3 / (r * cf)).abs() < 1e-1);
}

#[test]
fn charges_divide_when_a_contact_closes_a_loop_and_half_of_the_energy_is_heat() {
    let run = circuit(
        "3 ms",
        r#""t": Step(time: "1 ms", after: 1), "on": Compare(operator: Greater, constant: 0.5), "k": IdealSwitch(r_on: 0, g_off: 0),
           "a": Capacitor(c: "2 mF", v0: "12 V"), "b": Capacitor(c: "1 mF"), "e": Capacitor(c: "1 mF", v0: "4 V"),
           "account": EnergyAccount(at: Electrical)"#,
        r#""t.y -> on.u", "on.y -> k.gate", "a.p <-> k.p", "k.n <-> b.p <-> e.p", "a.n <-> b.n <-> e.n <-> g.p <-> account.node",
           "a.v -> s.a", "b.v -> s.b", "account.dissipated_energy -> s.heat", "account.error -> s.error""#,
        r#""a", "b", "heat", "error""#,
    );
    let after = |name: &str| {
        let rows = run.time.iter().zip(run.column(name)).filter(|(t, _)| **t > 1e-3);
        rows.map(|(_, v)| *v).collect::<Vec<f64>>()
    };
    // b begins with what e has. 2 mF of 12 V and 2 mF of 4 V make 8 V.
    assert!((run.column("s.b")[0] - 4.0).abs() < 1e-15);
    let events = run.events.iter().map(|(t, path, what)| format!("{t} {path} {what}\n"));
    expect![[r#"
        0.001 a jumps by -4 V
        0.001 b jumps by 4 V
        0.001 e jumps by 4 V
        0.001 on becomes true
    "#]]
    .assert_eq(&events.collect::<String>());
    for name in ["s.a", "s.b"] {
        assert!(after(name).iter().all(|v| (v - 8.0).abs() < 1e-12), "{:?}", after(name));
    }
    assert!(after("s.heat").iter().all(|heat| (heat - 0.032).abs() < 1e-12), "{:?}", after("s.heat"));
    assert!(run.column("s.error").iter().all(|error| error.abs() < 1e-14));
}

#[test]
fn a_contact_to_a_source_charges_a_capacitor_at_once_and_opens_again() {
    // 10 V onto 1 mF: the source gives C V^2, half of it becomes heat; then the capacitor empties into 100 ohm.
    let run = circuit(
        "100 ms",
        r#""t": Step(time: "10 ms", before: 1, after: 0), "on": Compare(operator: Greater, constant: 0.5), "k": IdealSwitch(r_on: 0, g_off: 0),
           "u": VoltageSource(v: "10 V"), "c": Capacitor(c: "1 mF"), "r": Resistor(r: "100 Ohm"), "account": EnergyAccount(at: Electrical)"#,
        r#""t.y -> on.u", "on.y -> k.gate", "u.p <-> k.p", "k.n <-> c.p <-> r.p", "u.n <-> c.n <-> r.n <-> g.p <-> account.node",
           "c.v -> s.v", "account.supplied_energy -> s.supplied", "account.error -> s.error""#,
        r#""v", "supplied", "error""#,
    );
    let v = |t: f64| if t <= 10e-3 { 10.0 } else { 10.0 * (-(t - 10e-3) / 0.1).exp() };
    for (row, t) in run.time.iter().enumerate().filter(|(_, t)| **t > 0.0) {
        assert!((run.column("s.v")[row] - v(*t)).abs() < 1e-7, "{} at {t}", run.column("s.v")[row]);
        // From the first instant, at which the account opens behind the jump.
        assert!(
            (run.column("s.supplied")[row] - t.min(10e-3)).abs() < 1e-9,
            "{}",
            run.column("s.supplied")[row]
        );
    }
    assert!(run.column("s.error").iter().all(|error| error.abs() < 1e-9));
}

#[test]
fn a_transformer_brings_a_capacitor_to_the_other_side() {
    // 8 uF behind 1:2 count as 2 uF beside 1 uF.
    let run = circuit(
        "9 ms",
        r#""u": VoltageSource(v: "6 V"), "r": Resistor(r: "1 kOhm"), "a": Capacitor(c: "1 uF"), "t": IdealTransformer(ratio: 2),
           "b": Capacitor(c: "8 uF")"#,
        r#""u.p <-> r.p", "r.n <-> a.p <-> t.p1", "t.p2 <-> b.p", "u.n <-> a.n <-> t.n1 <-> t.n2 <-> b.n <-> g.p", "a.v -> s.a",
           "b.v -> s.b", "t.i1 -> s.i""#,
        r#""a", "b", "i""#,
    );
    let v = |t: f64| 6.0 * (1.0 - (-t / 3e-3).exp());
    assert!(off(&run, "s.a", v) < 1e-8 && off(&run, "s.b", |t| v(t) / 2.0) < 1e-8);
    assert!(off(&run, "s.i", |t| 2.0 / 3.0 * 6e-3 * (-t / 3e-3).exp()) < 1e-8);
}

/// An ideal diode between the mains and a capacitor with a load: it conducts from where the source meets the voltage of the
/// capacitor to where `C u' + u / R = 0`.
#[test]
fn a_peak_rectifier_without_any_resistance_conducts_between_its_two_angles() {
    let (c, r, w) = (50e-6, 400.0, std::f64::consts::TAU * 50.0);
    let run = circuit(
        "60 ms",
        r#""u": AcVoltageSource(amplitude: Peak("100 V"), frequency: "50 Hz"), "d": Diode(v_f: 0, r_on: 0, g_off: 0), "c": Capacitor(c: "50 uF"),
           "r": Resistor(r: "400 Ohm"), "account": EnergyAccount(at: Electrical)"#,
        r#""u.p <-> d.p", "d.n <-> c.p <-> r.p", "u.n <-> c.n <-> r.n <-> g.p <-> account.node", "c.v -> s.v", "d.i -> s.i",
           "account.relative -> s.error""#,
        r#""v", "i", "error""#,
    );
    let u = |t: f64| 100.0 * (w * t).sin();
    // The diode lets go at tan(w t) = -w R C, behind the maximum.
    let end = (std::f64::consts::PI - (w * r * c).atan()) / w;
    // It takes over again where sin(w t) meets the decay, by bisection.
    let decay = |t: f64| u(end) * (-(t - end) / (r * c)).exp();
    let (mut a, mut b) = (0.02, 0.025);
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if u(middle) < decay(middle) { a = middle } else { b = middle }
    }
    for (row, t) in run.time.iter().enumerate() {
        let (v, i) = (run.column("s.v")[row], run.column("s.i")[row]);
        // At the instants themselves there are rows of both sides; from the second pulse on all repeats.
        let at_edge = [end, b, end + 0.02, b + 0.02].iter().any(|edge| (t - edge).abs() < 1e-7);
        let t = if *t > b { b + (t - b) % 0.02 } else { *t };
        let conducts = t < end || t > b && t < end + 0.02;
        if !at_edge {
            let t = if conducts && t > b || t > end + 0.02 { t - 0.02 } else { t };
            let expected = if conducts { u(t) } else { decay(t) };
            assert!((v - expected).abs() < 1e-5, "{v} {expected} at {t}");
            let current = if conducts { u(t) / r + c * w * 100.0 * (w * t).cos() } else { 0.0 };
            assert!((i - current).abs() < 1e-5, "{i} {current} at {t}");
        }
    }
    let starts = run.time.iter().zip(run.column("s.i")).filter(|(t, i)| **t > 0.0201 && **i > 0.0);
    let first = starts.map(|(t, _)| *t).fold(1.0, f64::min);
    assert!((first - b).abs() < 1e-8, "{first} {b}");
    let worst = run.column("s.error").iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
    assert!(worst < 1e-6, "{worst}");
}

/// Three-phase capacitors across a source of signals take its voltages; with the derivatives connected its power is
/// `sum v (C v' + i)`, and without them what does not look at their currents is the same.
#[test]
fn capacitors_across_a_commanded_three_phase_source_take_its_voltages() {
    let w = std::f64::consts::TAU * 50.0;
    let sines = |name: &str, amplitude: f64, unit: &str, lead: f64| -> String {
        let one = |(k, phase): (usize, f64)| {
            let phase = phase + lead;
            format!(
                r#""{name}{k}": Sine(amplitude: "{amplitude} {unit}", frequency: "50 Hz", phase: "{phase} deg")"#
            )
        };
        [0.0, -120.0, 120.0].into_iter().enumerate().map(one).collect::<Vec<_>>().join(", ")
    };
    let whole = |dv: &str, power: &str| {
        format!(
            r#"Diagram(
    simulation: (stop_time: "40 ms", solver: Ode45(rtol: 1e-9)),
    blocks: {{ {}, {}, "v": Mux(inputs: 3), "dv": Mux(inputs: 3), "u": ControlledThreePhaseSource, "g": ElectricalReference,
        "c": ThreePhaseRlc(c: "10 uF"), "nc": GroundedNeutral, "z": ThreePhaseRlc(r: "5 Ohm", l: "20 mH"), "nz": GroundedNeutral,
        "s": Scope(inputs: ["i", "p"]) }},
    connections: ["v0.y -> v.u1", "v1.y -> v.u2", "v2.y -> v.u3", "d0.y -> dv.u1", "d1.y -> dv.u2", "d2.y -> dv.u3", "v.y -> u.v", {dv}
        "u.n <-> g.p", "u.ac <-> c.ac1 <-> z.ac1", "c.ac2 <-> nc.ac", "z.ac2 <-> nz.ac", "z.i -> s.i", "{power} -> s.p"],
)"#,
            sines("v", 300.0, "V", 0.0),
            sines("d", 300.0 * w, "V/s", 90.0),
        )
    };
    let (r, l) = (5.0, 20e-3);
    let (z, phi) = (f64::hypot(r, w * l), (w * l / r).atan());
    let lag = |k: usize| [0.0, -1.0, 1.0][k] * std::f64::consts::TAU / 3.0;
    let current = |t: f64, k: usize| {
        300.0 / z * ((w * t + lag(k) - phi).sin() - (lag(k) - phi).sin() * (-t * r / l).exp())
    };
    for (dv, power) in [("\"dv.y -> u.dv\",", "u.power"), ("", "v0.y")] {
        let run = run_text(&whole(dv, power));
        for k in 0..3 {
            assert!(off(&run, &format!("s.i[{k}]"), |t| current(t, k)) < 1e-8);
        }
        if power == "u.power" {
            // What three equal capacitors take adds up to nothing.
            let v = |t: f64, k: usize| 300.0 * (w * t + lag(k)).sin();
            assert!(off(&run, "s.p", |t| (0..3).map(|k| v(t, k) * current(t, k)).sum()) < 1e-8);
        }
    }
    let problems = compile_text(&whole("", "u.power")).1;
    assert!(
        problems.contains("unknown_slope") && problems.contains("connect `dv` of the source"),
        "{problems}"
    );
}

/// Ideal inverters give their voltages whatever lies across them: a load does not notice capacitors in delta or in star.
#[test]
fn capacitors_across_ideal_inverters_change_nothing_for_a_load() {
    for inverter in [
        "AveragedInverter(vdc: \"560 V\")",
        "SwitchedInverter(vdc: \"560 V\", switching_frequency: \"4 kHz\")",
        "SwitchedInverter(vdc: \"560 V\", switching_frequency: \"4 kHz\", integration: Separate(periods: 1))",
    ] {
        let run = |blocks: &str, connections: &str| {
            run_text(&format!(
                r#"Diagram(
    simulation: (stop_time: "20 ms", solver: Ode45(rtol: 1e-9)),
    blocks: {{ "v": Constant(value: "200 V"), "f": Constant(value: "50 Hz"), "u": {inverter},
        "z": ThreePhaseRlc(r: "5 Ohm", l: "20 mH"), "nz": FloatingNeutral, {blocks} "s": Scope(inputs: ["i"]) }},
    connections: ["v.y -> u.v", "f.y -> u.f", "u.ac <-> z.ac1", "z.ac2 <-> nz.ac", {connections} "z.i -> s.i"],
)"#
            ))
        };
        let plain = run("", "");
        let delta = run(
            r#""c": ThreePhaseRlc(c: "1 uF"), "x": PhasePermute,"#,
            r#""u.ac <-> c.ac1 <-> x.ac1", "c.ac2 <-> x.ac2","#,
        );
        let star = run(
            r#""c": ThreePhaseRlc(c: "1 uF"), "nc": FloatingNeutral,"#,
            r#""u.ac <-> c.ac1", "c.ac2 <-> nc.ac","#,
        );
        for with in [delta, star] {
            for name in ["s.i[0]", "s.i[1]", "s.i[2]"] {
                let end = plain.last(name);
                assert!(end.abs() > 1.0 && (with.last(name) - end).abs() < 1e-6, "{inverter} {name}: {end}");
            }
        }
    }
}

#[test]
fn what_has_no_answer_is_told() {
    let problems = |blocks: &str, connections: &str| {
        compile_text(&text(
            "1 s",
            &format!("{blocks}, \"k\": Constant(value: 1)"),
            &format!("{connections}, \"k.y -> s.k\""),
            "\"k\"",
        ))
        .1
    };
    expect![[r#"
        error[start_conflict]: the voltages at the start do not obey Kirchhoff's law: around a loop of capacitors they miss zero by 5 V
          model.ron:3:41 `"a"` `a` has a voltage at the start
          model.ron:3:79 `"b"` `b` has a voltage at the start
          help: leave out `v0` of one of them, or give values that fit; what comes as a signal counts as zero before the start
    "#]].assert_eq(&problems(
        r#""a": Capacitor(c: "1 uF", v0: "5 V"), "b": Capacitor(c: "1 uF", v0: "0 V"), "r": Resistor(r: 1)"#,
        r#""a.p <-> b.p <-> r.p", "a.n <-> b.n <-> r.n <-> g.p""#,
    ));
    expect![[r#"
        error[start_conflict]: the voltages at the start do not obey Kirchhoff's law: around a loop of capacitors they miss zero by 4 V
          model.ron:3:71 `"b"` `b` has a voltage at the start
          model.ron:3:41 `"u"` `u` gives a voltage
          help: leave out `v0` of one of them, or give values that fit; what comes as a signal counts as zero before the start
    "#]].assert_eq(&problems(
        r#""u": VoltageSource(v: "5 V"), "b": Capacitor(c: "1 uF", v0: "1 V")"#,
        r#""u.p <-> b.p", "u.n <-> b.n <-> g.p""#,
    ));
    expect![[r#"
        error[unknown_slope]: capacitors lie across an ideal source: the current through them contains the slope of a voltage that comes as a signal of unknown slope
          model.ron:3:90 `"u"` `u` gives this voltage
          model.ron:3:120 `"m"` `m` looks at the current
          help: connect `dv` of the source if it has this input, put a resistance in series to it, for instance Resistor(r: "1 mOhm"), or leave out what measures the current
    "#]].assert_eq(&problems(
        r#""w": Sine(amplitude: "5 V", frequency: "50 Hz"), "u": ControlledVoltageSource, "m": CurrentSensor, "b": Capacitor(c: "1 uF"), "abs": Abs"#,
        r#""w.y -> u.v", "u.p <-> m.p", "m.n <-> b.p", "u.n <-> b.n <-> g.p", "m.i -> abs.u""#,
    ));
}
