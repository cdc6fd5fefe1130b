//! Transformers, coupled coils, contacts and windings in delta, against closed forms and the T equivalent.

use std::f64::consts::{PI, TAU};

use blocksim_tests::{Run, close, run_blocks, run_text};

/// A circuit with these blocks and connections, recorded by the scope `s`.
fn circuit(stop: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-10, atol: 1e-10), output: Every("1 ms")),
    blocks: {{ {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    ))
}

/// The classical method of order four over two currents, from `t` on.
fn step(x: [f64; 2], t: f64, h: f64, slope: impl Fn(f64, [f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let ahead = |k: [f64; 2], c: f64| [x[0] + c * h * k[0], x[1] + c * h * k[1]];
    let k1 = slope(t, x);
    let k2 = slope(t + 0.5 * h, ahead(k1, 0.5));
    let k3 = slope(t + 0.5 * h, ahead(k2, 0.5));
    let k4 = slope(t + h, ahead(k3, 1.0));
    [0, 1].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// A transformer at 325 V, 50 Hz whose second winding feeds what these blocks and connections say.
fn transformer(blocks: &str, connections: &str) -> Run {
    circuit(
        "60 ms",
        &format!(
            r#""u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), "g": ElectricalReference, "h": ElectricalReference,
               "x": Transformer(ratio: 10, l_m: "2 H", l1: "20 mH", l2: "0.2 mH", r1: "4 Ohm", r2: "40 mOhm"), "v2": VoltageSensor{blocks}"#
        ),
        &format!(
            r#""u.p <-> x.p1", "u.n <-> x.n1 <-> g.p", "x.p2 <-> v2.p", "x.n2 <-> v2.n <-> h.p", "x.i1 -> s.i1", "x.i2 -> s.i2",
               "v2.v -> s.v2"{connections}"#
        ),
        r#""i1", "i2", "v2""#,
    )
}

#[test]
fn a_transformer_without_load_draws_its_magnetising_current() {
    let run = transformer("", "");
    let (w, r, l) = (TAU * 50.0, 4.0, 2.02);
    let (z, phi) = (f64::hypot(r, w * l), (w * l / r).atan());
    for (row, t) in run.time.iter().enumerate() {
        let decay = phi.sin() * (-t * r / l).exp();
        let i = 325.0 / z * ((w * t - phi).sin() + decay);
        let slope = 325.0 / z * (w * (w * t - phi).cos() - r / l * decay);
        close(run.column("s.i1")[row], i, 1e-8, &format!("primary current at {t}"));
        close(run.column("s.i2")[row], 0.0, 1e-10, "secondary current");
        close(run.column("s.v2")[row], 2.0 / 10.0 * slope, 1e-6, &format!("secondary voltage at {t}"));
    }
}

#[test]
fn a_transformer_with_load_and_in_short_circuit_is_its_t_equivalent() {
    for (load, blocks, connections) in [
        (1.5, r#", "z": Resistor(r: "1.5 Ohm")"#, r#", "x.p2 <-> z.p", "x.n2 <-> z.n""#),
        (
            0.0,
            r#", "z": IdealSwitch(r_on: 0), "on": Constant(value: 1), "b": Compare(operator: Greater, constant: 0.5)"#,
            r#", "x.p2 <-> z.p", "x.n2 <-> z.n", "on.y -> b.u", "b.y -> z.gate""#,
        ),
    ] {
        let run = transformer(blocks, connections);
        // Seen from the first side: currents i1 and i2 / 10 into the T, resistances and leakages times 100.
        let (r1, r2, l1, l2, lm) = (4.0, 100.0 * (0.04 + load), 0.02, 0.02, 2.0);
        let slope = |t: f64, [i1, i2]: [f64; 2]| {
            let (a, b) = (325.0 * (TAU * 50.0 * t).sin() - r1 * i1, -r2 * i2);
            let determinant = l1 * l2 + lm * (l1 + l2);
            [((l2 + lm) * a - lm * b) / determinant, ((l1 + lm) * b - lm * a) / determinant]
        };
        let (mut x, h) = ([0.0; 2], 1e-6);
        for n in 0..60_000_u32 {
            x = step(x, f64::from(n) * h, h, slope);
            if n % 1_000 == 999 {
                let t = f64::from(n + 1) * h;
                close(run.at("s.i1", t), x[0], 1e-6, &format!("primary current at {t}, load {load}"));
                close(
                    run.at("s.i2", t),
                    10.0 * x[1],
                    1e-5,
                    &format!("secondary current at {t}, load {load}"),
                );
                close(
                    run.at("s.v2", t),
                    -load * 10.0 * x[1],
                    1e-5,
                    &format!("secondary voltage at {t}, load {load}"),
                );
            }
        }
    }
}

/// With equal coils and resistances the sum and the difference of the currents are exponentials of their own.
#[test]
fn two_coupled_coils_answer_a_step_with_two_time_constants() {
    let run = circuit(
        "60 ms",
        r#""u": VoltageSource(v: "12 V"), "g": ElectricalReference, "h": ElectricalReference,
           "m": MutualInductance(l1: "20 mH", l2: "20 mH", k: 0.9), "r1": Resistor(r: "2 Ohm"), "r2": Resistor(r: "2 Ohm")"#,
        r#""u.p <-> r1.p", "r1.n <-> m.p1", "m.n1 <-> u.n <-> g.p", "m.p2 <-> r2.p", "m.n2 <-> r2.n <-> h.p", "m.i1 -> s.i1",
           "m.i2 -> s.i2""#,
        r#""i1", "i2""#,
    );
    for (row, t) in run.time.iter().enumerate() {
        let rise = |l: f64| 12.0 / 2.0 * (1.0 - (-t * 2.0 / l).exp());
        let (sum, difference) = (rise(20e-3 * 1.9), rise(20e-3 * 0.1));
        close(run.column("s.i1")[row], 0.5 * (sum + difference), 1e-7, &format!("first current at {t}"));
        close(run.column("s.i2")[row], 0.5 * (sum - difference), 1e-7, &format!("second current at {t}"));
    }
}

#[test]
fn an_ideal_transformer_passes_direct_current_and_all_power() {
    let run = circuit(
        "2 ms",
        r#""u": VoltageSource(v: "12 V"), "g": ElectricalReference, "h": ElectricalReference, "x": IdealTransformer(ratio: -4),
           "r": Resistor(r: "3 Ohm"), "v": VoltageSensor"#,
        r#""u.p <-> x.p1", "u.n <-> x.n1 <-> g.p", "x.p2 <-> r.p <-> v.p", "x.n2 <-> r.n <-> v.n <-> h.p", "x.i1 -> s.i1",
           "x.i2 -> s.i2", "v.v -> s.v""#,
        r#""i1", "i2", "v""#,
    );
    close(run.last("s.v"), -3.0, 1e-12, "secondary voltage");
    close(run.last("s.i2"), 1.0, 1e-12, "secondary current, into the winding");
    close(run.last("s.i1"), 0.25, 1e-12, "primary current");
}

#[test]
fn a_star_point_carries_the_sum_of_what_a_splitter_hands_out() {
    let run = circuit(
        "20 ms",
        r#""u": ThreePhaseSource(voltage: "400 V", frequency: "50 Hz"), "x": PhaseSplitter, "y": PhaseSplitter, "n": NeutralPoint,
           "g": ElectricalReference, "ra": Resistor(r: "10 Ohm"), "rb": Resistor(r: "20 Ohm"), "rc": Resistor(r: "40 Ohm"),
           "i": CurrentSensor"#,
        r#""u.ac <-> x.ac", "x.a <-> ra.p", "x.b <-> rb.p", "x.c <-> rc.p", "ra.n <-> y.a", "rb.n <-> y.b", "rc.n <-> y.c",
           "y.ac <-> n.ac", "n.n <-> i.p", "i.n <-> g.p", "i.i -> s.n""#,
        r#""n""#,
    );
    let peak = 400.0 * (2.0_f64 / 3.0).sqrt();
    for (row, t) in run.time.iter().enumerate() {
        let current = |k: usize, r: f64| peak / r * (TAU * (50.0 * t - k as f64 / 3.0)).cos();
        let expected = current(0, 10.0) + current(1, 20.0) + current(2, 40.0);
        close(run.column("s.n")[row], expected, 1e-10, &format!("neutral at {t}"));
    }
}

/// A load of 2 ohm and 10 mH in each phase, on ground, behind a breaker that is told to open at 43 ms.
fn broken(breaker: &str, load: &str) -> Run {
    circuit(
        "60 ms",
        &format!(
            r#""u": ThreePhaseSource(voltage: "400 V", frequency: "50 Hz"), "k": ThreePhaseBreaker({breaker}),
               "z": ThreePhaseRlc({load}), "n": GroundedNeutral, "a": ThreePhaseCurrentSensor,
               "on": Step(time: "43 ms", before: 1, after: 0), "b": Compare(operator: Greater, constant: 0.5)"#
        ),
        r#""u.ac <-> a.ac1", "a.ac2 <-> k.ac1", "k.ac2 <-> z.ac1", "z.ac2 <-> n.ac", "on.y -> b.u", "b.y -> k.closed",
           "a.i -> s.i""#,
        r#""i""#,
    )
}

#[test]
fn a_breaker_opens_each_phase_where_its_current_is_zero() {
    let run = broken(r#"r_on: "10 mOhm""#, r#"r: "2 Ohm", l: "10 mH""#);
    let (w, r, l) = (TAU * 50.0, 2.01, 10e-3);
    let (z, phi) = (f64::hypot(r, w * l), (w * l / r).atan());
    let peak = 400.0 * (2.0_f64 / 3.0).sqrt() / z;
    for k in 0..3 {
        let from = TAU * k as f64 / 3.0 + phi;
        let current = |t: f64| peak * ((w * t - from).cos() - from.cos() * (-t * r / l).exp());
        // The first zero behind 43 ms, by bisection between the points of a fine grid.
        let mut before = 43e-3;
        while current(before) * current(before + 1e-5) > 0.0 {
            before += 1e-5;
        }
        let (mut early, mut late) = (before, before + 1e-5);
        for _ in 0..60 {
            let middle = 0.5 * (early + late);
            if current(early) * current(middle) <= 0.0 { late = middle } else { early = middle }
        }
        assert!(late < 54e-3);
        for (row, t) in run.time.iter().enumerate() {
            let i = if *t < late { current(*t) } else { 0.0 };
            close(run.column(&format!("s.i[{k}]"))[row], i, 2e-7, &format!("phase {k} at {t}"));
        }
        let nearest = run.events.iter().map(|(t, ..)| (t - late).abs()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9, "phase {k} ends {nearest} s away from {late}");
    }
}

#[test]
fn a_breaker_that_opens_at_once_cuts_all_phases_at_the_same_instant() {
    let run = broken(r#"r_on: "10 mOhm", opens: AtOnce"#, r#"r: "2 Ohm""#);
    let peak = 400.0 * (2.0_f64 / 3.0).sqrt() / 2.01;
    for (row, t) in run.time.iter().enumerate().filter(|(_, t)| (**t - 43e-3).abs() > 1e-12) {
        for k in 0..3 {
            let i = if *t < 43e-3 { peak * (TAU * (50.0 * t - k as f64 / 3.0)).cos() } else { 0.0 };
            close(run.column(&format!("s.i[{k}]"))[row], i, 1e-9, &format!("phase {k} at {t}"));
        }
    }
}

/// The reference machine, 15 kVA at 220 V in delta, that starts from rest; its impedances times a factor.
fn machine(factor: f64, more: &str) -> String {
    let [r_s, x_ls, r_r, x_lr, x_m] = [0.25, 0.9, 0.14, 0.41, 17.0].map(|z| z * factor);
    format!(
        r#""machine": AsynchronousMachine(
            rated_power: "15 kVA", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 1, r_s: {r_s}, x_ls: {x_ls},
            r_r: {r_r}, x_lr: {x_lr}, x_m: {x_m}, x_0: 0.9, {more}), "rotor": Inertia(j: "0.1 kg*m^2"), "housing": RotationalReference,
            "mains": ThreePhaseSource(voltage: "220 V", frequency: "60 Hz"), "line": ThreePhaseCurrentSensor, "encoder": MotionSensor"#
    )
}

const SHAFT: &str = r#""machine.r <-> rotor.r <-> encoder.r", "machine.c <-> encoder.c <-> housing.r",
    "machine.torque -> s.tau", "encoder.w -> s.w", "line.i -> s.i", "mains.ac <-> line.ac1""#;

#[test]
fn a_machine_in_delta_by_its_wires_is_one_in_delta_and_one_in_star_of_a_third_of_its_impedance() {
    let shown = r#""tau", "w", "i""#;
    let direct =
        |blocks: &str| circuit("0.3 s", blocks, &format!(r#"{SHAFT}, "line.ac2 <-> machine.ac""#), shown);
    let delta = direct(&machine(1.0, "connection: Delta"));
    let wye = direct(&machine(1.0 / 3.0, "connection: Wye"));
    let wires = circuit(
        "0.3 s",
        &format!(r#"{}, "x": PhasePermute"#, machine(1.0, "connection: Open")),
        &format!(r#"{SHAFT}, "line.ac2 <-> machine.ac1 <-> x.ac1", "machine.ac2 <-> x.ac2""#),
        shown,
    );
    for n in 1..=300 {
        let t = 1e-3 * f64::from(n);
        for name in ["s.tau", "s.w", "s.i[0]", "s.i[1]", "s.i[2]"] {
            let expected = delta.at(name, t);
            // Tolerances of 1e-10 along some hundred steps; currents reach 500 A.
            close(wye.at(name, t), expected, 1e-5, &format!("{name} in star at {t}"));
            close(wires.at(name, t), expected, 1e-5, &format!("{name} with wires at {t}"));
        }
    }
    // So that the comparison says something: it runs.
    assert!(delta.last("s.w") > 50.0);
}

#[test]
fn behind_a_reversing_contactor_a_machine_does_the_same_the_other_way_round() {
    let run = |reverse: u8| {
        circuit(
            "0.6 s",
            &format!(
                r#"{}, "k": ReversingContactor(r_on: "1 mOhm"), "on": Constant(value: {reverse}),
                   "b": Compare(operator: Greater, constant: 0.5)"#,
                machine(1.0, "connection: Delta")
            ),
            &format!(
                r#"{SHAFT}, "line.ac2 <-> k.ac1", "k.ac2 <-> machine.ac", "on.y -> b.u", "b.y -> k.reverse""#
            ),
            r#""tau", "w", "i""#,
        )
    };
    let (ahead, back) = (run(0), run(1));
    for n in 1..=600 {
        let t = 1e-3 * f64::from(n);
        close(back.at("s.w", t), -ahead.at("s.w", t), 1e-6, &format!("speed at {t}"));
        close(back.at("s.tau", t), -ahead.at("s.tau", t), 1e-5, &format!("torque at {t}"));
        close(back.at("s.i[0]", t), ahead.at("s.i[0]", t), 1e-5, &format!("current at {t}"));
    }
    assert!(ahead.last("s.w") > 0.5 * 120.0 * PI);
}

/// Inductances on both sides of a closed contact have one current, up to the errors of the method. These are no currents
/// without a path: a method of many steps that began anew for each of them would stay at its first order.
#[test]
fn a_closed_contact_between_inductances_does_not_stop_a_method_of_many_steps() {
    let run = |solver: &str| {
        run_blocks(
            "60 ms",
            solver,
            r#""source": ThreePhaseSource(voltage: 100, frequency: 50), "line": ThreePhaseRlc(r: 0.6, l: 0.001),
               "breaker": ThreePhaseBreaker(opens: AtOnce), "closed": Constant(value: true), "load": ThreePhaseRlc(r: 2.0, l: 0.003),
               "star": FloatingNeutral, "scope": Scope(inputs: ["i"])"#,
            r#""source.ac <-> line.ac1", "line.ac2 <-> breaker.ac1", "breaker.ac2 <-> load.ac1", "load.ac2 <-> star.ac",
               "closed.y -> breaker.closed", "line.i -> scope.i""#,
        )
    };
    let exact = run("Ode45(rtol: 1e-11)").last("scope.i[0]");
    for (rtol, most) in [("1e-5", 1000), ("1e-7", 1000), ("1e-9", 2000)] {
        let found = run(&format!("Ode15s(rtol: {rtol})"));
        let steps = found.counts.accepted;
        assert!(steps < most, "{rtol}: {steps} steps");
        let off = (found.last("scope.i[0]") - exact).abs() / exact.abs();
        assert!(off < 100.0 * rtol.parse::<f64>().unwrap(), "{rtol}: off by {off}");
    }
}
