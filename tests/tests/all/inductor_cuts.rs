//! Inductances in series with current sources and with each other, whose currents depend on each other, against closed forms.

use std::f64::consts::TAU;

use blocksim_tests::{Run, compile_text, run, run_text};
use expect_test::expect;

fn text(stop: &str, solver: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: {solver}),
    blocks: {{ "g": ElectricalReference, {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

fn circuit(stop: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    run_text(&text(stop, "Ode45(rtol: 1e-9)", blocks, connections, shown))
}

/// The worst distance of a column from a function of time, over the largest value of the function. Rows at instants in `edges` are
/// left out, as they may lie on either side.
fn off(run: &Run, column: &str, edges: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let expected: Vec<f64> = run.time.iter().map(|t| of(*t)).collect();
    let most = expected.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    assert!(run.time.len() > 5 && most > 0.0);
    let rows = run.time.iter().zip(run.column(column)).zip(&expected);
    let rows = rows.filter(|((t, _), _)| edges.iter().all(|edge| (*t - edge).abs() > 1e-12));
    rows.fold(0.0_f64, |worst, ((_, found), expected)| worst.max((found - expected).abs())) / most
}

/// `v = L di/dt` across each, whatever method integrates the rest.
#[test]
fn inductors_in_series_with_a_current_source_show_its_slope() {
    let w = TAU * 50.0;
    for solver in [
        "Auto",
        "Ode45(rtol: 1e-9)",
        "Ode23",
        "Dop853",
        "Radau5",
        "Ode15s",
        "Ode23t",
        "Ode23tb",
        "Rodas4",
        "RosW3",
        "Ode4(step: \"0.1 ms\")",
        "Ode1(step: \"0.1 ms\")",
    ] {
        let run = run_text(&text(
            "50 ms",
            solver,
            r#""w": Sine(amplitude: "2 A", frequency: "50 Hz"), "dw": Sine(amplitude: "628.3185307179587 A/s", frequency: "50 Hz", phase: "90 deg"),
               "j": ControlledCurrentSource, "a": Inductor(l: "10 mH"), "r": Resistor(r: "3 Ohm"), "b": Inductor(l: "25 mH"),
               "va": VoltageSensor, "v": VoltageSensor, "m": CurrentSensor"#,
            r#""w.y -> j.i", "dw.y -> j.di", "j.n <-> a.p <-> va.p <-> v.p", "a.n <-> r.p <-> va.n", "r.n <-> m.p", "m.n <-> b.p",
               "b.n <-> j.p <-> v.n <-> g.p", "a.i -> s.a", "b.i -> s.b", "va.v -> s.va", "v.v -> s.v", "m.i -> s.m""#,
            r#""a", "b", "va", "v", "m""#,
        ));
        let (j, dj) = (|t: f64| 2.0 * (w * t).sin(), |t: f64| 2.0 * w * (w * t).cos());
        for name in ["s.a", "s.b", "s.m"] {
            assert!(off(&run, name, &[], j) < 1e-13, "{solver} {name}: {}", off(&run, name, &[], j));
        }
        assert!(off(&run, "s.va", &[], |t| 10e-3 * dj(t)) < 1e-13, "{solver}");
        assert!(off(&run, "s.v", &[], |t| 35e-3 * dj(t) + 3.0 * j(t)) < 1e-13, "{solver}");
    }
}

/// `i1 + i2 = j` and `L1 i1' = L2 i2' + R i2`: a jump of `j` divides inversely to the inductances, and what is in the branch with
/// the resistance goes with `(L1 + L2) / R`. Nobody tells the slope of `j`.
#[test]
fn a_jump_of_a_current_divides_between_two_inductors_and_is_forgotten() {
    let (l1, l2, r) = (30e-3, 10e-3, 8.0);
    let tau = (l1 + l2) / r;
    for (solver, tolerance) in [
        ("Ode45(rtol: 1e-9)", 1e-8),
        ("Auto(rtol: 1e-7)", 1e-5),
        ("Radau5(rtol: 1e-8)", 1e-6),
        ("Ode15s(rtol: 1e-7)", 1e-4),
        ("Rodas4(rtol: 1e-8)", 1e-6),
        ("RosW3(rtol: 1e-8)", 1e-6),
        ("Ode4(step: \"0.1 ms\")", 1e-8),
    ] {
        let run = run_text(&text(
            "20 ms",
            solver,
            r#""w": Step(time: "1 ms", before: "1 A", after: "9 A"), "j": ControlledCurrentSource, "a": Inductor(l: "30 mH"),
               "b": Inductor(l: "10 mH"), "r": Resistor(r: "8 Ohm")"#,
            r#""w.y -> j.i", "j.n <-> a.p <-> b.p", "b.n <-> r.p", "a.n <-> r.n <-> j.p <-> g.p", "a.i -> s.a", "b.i -> s.b""#,
            r#""a", "b""#,
        ));
        let j = |t: f64| if t < 1e-3 { 1.0 } else { 9.0 };
        let second = |t: f64| {
            let jump = if t < 1e-3 { 0.0 } else { 8.0 * (-(t - 1e-3) / tau).exp() };
            l1 / (l1 + l2) * ((-t / tau).exp() + jump)
        };
        assert!(
            off(&run, "s.b", &[1e-3], second) < tolerance,
            "{solver}: {}",
            off(&run, "s.b", &[1e-3], second)
        );
        assert!(off(&run, "s.a", &[1e-3], |t| j(t) - second(t)) < tolerance, "{solver}");
    }
}

/// The torque is `k j` from the instant on at which the current comes, and the speed `k / J` times its integral.
#[test]
fn a_motor_with_inductance_takes_the_current_of_its_source() {
    let run = circuit(
        "0.2 s",
        r#""w": Step(time: "50 ms", before: "0 A", after: "4 A"), "j": ControlledCurrentSource, "h": RotationalReference,
           "m": DcMotor(r: "1.2 Ohm", l: "3 mH", k: "0.05 N*m/A", j: "1e-4 kg*m^2"), "e": MotionSensor"#,
        r#""w.y -> j.i", "j.n <-> m.p", "j.p <-> m.n <-> g.p", "m.r <-> e.r", "m.c <-> e.c <-> h.r", "m.i -> s.i", "e.w -> s.w""#,
        r#""i", "w""#,
    );
    assert!(off(&run, "s.i", &[50e-3], |t| if t < 50e-3 { 0.0 } else { 4.0 }) < 1e-14);
    assert!(off(&run, "s.w", &[], |t| 0.05 * 4.0 / 1e-4 * (t - 50e-3).max(0.0)) < 1e-9);
}

/// `L2 i2' + M j' + R i2 = 0`, and `v1 = L1 j' + M i2'`.
#[test]
fn a_current_source_drives_one_of_two_coupled_coils() {
    let (l1, l2, k, r, w) = (20e-3_f64, 5e-3_f64, 0.8, 2.0, TAU * 60.0);
    let m = k * (l1 * l2).sqrt();
    let run = circuit(
        "60 ms",
        &format!(
            r#""w": Sine(amplitude: "3 A", frequency: "60 Hz"), "dw": Sine(amplitude: "{} A/s", frequency: "60 Hz", phase: "90 deg"),
               "j": ControlledCurrentSource, "x": MutualInductance(l1: "20 mH", l2: "5 mH", k: {k}), "r": Resistor(r: "2 Ohm"),
               "v": VoltageSensor, "h": ElectricalReference, "account": EnergyAccount(at: Electrical)"#,
            3.0 * w
        ),
        r#""w.y -> j.i", "dw.y -> j.di", "j.n <-> x.p1 <-> v.p", "j.p <-> x.n1 <-> v.n <-> g.p <-> account.node", "x.p2 <-> r.p",
           "x.n2 <-> r.n <-> h.p", "x.i1 -> s.i1", "x.i2 -> s.i2", "v.v -> s.v", "account.relative -> s.error""#,
        r#""i1", "i2", "v", "error""#,
    );
    // i2 = Re of a phasor and what makes it begin at the flux of nothing: L2 i2(0) + M j(0) = 0, and j(0) = 0.
    let (z2, tau) = (r * r + w * w * l2 * l2, l2 / r);
    // -j w M J / (R + j w L2) with j = Im(J e^{j w t}).
    let (re, im) = (-3.0 * w * w * m * l2 / z2, -3.0 * w * m * r / z2);
    let i2 = |t: f64| re * (w * t).sin() + im * (w * t).cos() - im * (-t / tau).exp();
    let di2 = |t: f64| w * re * (w * t).cos() - w * im * (w * t).sin() + im / tau * (-t / tau).exp();
    assert!(off(&run, "s.i1", &[], |t| 3.0 * (w * t).sin()) < 1e-13);
    assert!(off(&run, "s.i2", &[], i2) < 1e-8, "{}", off(&run, "s.i2", &[], i2));
    let v = |t: f64| l1 * 3.0 * w * (w * t).cos() + m * di2(t);
    assert!(off(&run, "s.v", &[], v) < 1e-8, "{}", off(&run, "s.v", &[], v));
    let worst = run.column("s.error").iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
    assert!(worst < 1e-7, "{worst}");
}

/// Two currents into a star of three coils: the third takes both, and the star point is where its voltage puts it.
#[test]
fn a_star_of_coils_behind_two_current_sources_gives_their_sum_to_the_third() {
    let w = TAU * 50.0;
    let run = circuit(
        "40 ms",
        &format!(
            r#""wa": Sine(amplitude: "2 A", frequency: "50 Hz"), "da": Sine(amplitude: "{0} A/s", frequency: "50 Hz", phase: "90 deg"),
               "wb": Ramp(slope: "30 A/s"), "db": Constant(value: "30 A/s"), "ja": ControlledCurrentSource, "jb": ControlledCurrentSource,
               "a": Inductor(l: "5 mH"), "b": Inductor(l: "10 mH"), "c": Inductor(l: "20 mH"), "v": VoltageSensor, "va": VoltageSensor"#,
            2.0 * w
        ),
        r#""wa.y -> ja.i", "da.y -> ja.di", "wb.y -> jb.i", "db.y -> jb.di", "ja.n <-> a.p <-> va.p", "jb.n <-> b.p",
           "a.n <-> b.n <-> c.p <-> v.p <-> va.n", "ja.p <-> jb.p <-> c.n <-> v.n <-> g.p", "c.i -> s.c", "v.v -> s.v", "va.v -> s.va""#,
        r#""c", "v", "va""#,
    );
    let slope = |t: f64| 2.0 * w * (w * t).cos();
    assert!(off(&run, "s.c", &[], |t| 2.0 * (w * t).sin() + 30.0 * t) < 1e-13);
    assert!(off(&run, "s.v", &[], |t| 20e-3 * (slope(t) + 30.0)) < 1e-12);
    assert!(off(&run, "s.va", &[], |t| 5e-3 * slope(t)) < 1e-12);
}

/// `i = u / R (1 - exp(-R t / L)) + i0 exp(-R t / L)` with the sum of the inductances; the start of one is that of all.
#[test]
fn inductors_in_series_are_one_with_their_sum_and_start_alike() {
    let run = circuit(
        "60 ms",
        r#""u": VoltageSource(v: "12 V"), "a": Inductor(l: "10 mH", i0: "2 A"), "b": Inductor(l: "25 mH"), "r": Resistor(r: "3 Ohm"),
           "e": Inductor(l: "15 mH"), "v": VoltageSensor"#,
        r#""u.p <-> a.p", "a.n <-> b.p <-> v.p", "b.n <-> v.n <-> r.p", "r.n <-> e.p", "e.n <-> u.n <-> g.p", "a.i -> s.a", "b.i -> s.b",
           "e.i -> s.e", "v.v -> s.v""#,
        r#""a", "b", "e", "v""#,
    );
    let decay = |t: f64| (-t * 3.0 / 50e-3).exp();
    let i = |t: f64| 4.0 * (1.0 - decay(t)) + 2.0 * decay(t);
    for name in ["s.a", "s.b", "s.e"] {
        assert!(off(&run, name, &[], i) < 1e-8, "{name}: {}", off(&run, name, &[], i));
    }
    assert!(off(&run, "s.v", &[], |t| 25e-3 / 50e-3 * (12.0 - 3.0 * i(t))) < 1e-8);
}

/// One start is given in a star of three: the others share it inversely to their inductances, as volt-seconds at the star point would.
#[test]
fn starts_that_are_not_given_share_what_one_has() {
    let run = circuit(
        "1 ms",
        r#""a": Inductor(l: "5 mH", i0: "3 A"), "b": Inductor(l: "10 mH"), "c": Inductor(l: "20 mH"), "r": Resistor(r: "1 mOhm")"#,
        r#""r.p <-> a.p", "a.n <-> b.p <-> c.p", "b.n <-> c.n <-> r.n <-> g.p", "a.i -> s.a", "b.i -> s.b", "c.i -> s.c""#,
        r#""a", "b", "c""#,
    );
    let first = |name: &str| run.column(name)[0];
    assert_eq!(first("s.a"), 3.0);
    assert!((first("s.b") - 2.0).abs() < 1e-14 && (first("s.c") - 1.0).abs() < 1e-14);
}

#[test]
fn what_has_no_answer_is_told() {
    let problems = |blocks: &str, connections: &str| {
        compile_text(&text(
            "1 s",
            "Ode45",
            &format!("{blocks}, \"k\": Constant(value: 1)"),
            &format!("{connections}, \"k.y -> s.k\""),
            "\"k\"",
        ))
        .1
    };
    // The slope of the current is asked for and nobody tells it.
    expect![[r#"
        error[unknown_slope]: inductances lie in series with an ideal current source: the voltage across them contains the slope of a current that comes as a signal of unknown slope
          model.ron:3:66 `"j"` `j` gives this current
          model.ron:3:122 `"v"` `v` looks at the voltage
          help: connect `di` of the source, put a resistance in parallel to it, for instance Resistor(r: "1 MOhm"), or leave out what measures the voltage
    "#]].assert_eq(&problems(
        r#""w": Step(after: "5 A"), "j": ControlledCurrentSource, "l": Inductor(l: "1 mH"), "v": VoltageSensor, "abs": Abs"#,
        r#""w.y -> j.i", "j.p <-> l.p <-> v.p", "l.n <-> j.n <-> v.n <-> g.p", "v.v -> abs.u""#,
    ));
    // What comes as a signal counts as zero before the start.
    expect![[r#"
        error[start_conflict]: the currents at the start do not obey Kirchhoff's law: 2 A have no path
          model.ron:3:100 `"l"` `l` has a current at the start
          help: leave out `i0` of the inductances in series with a current source, or make them add up to zero: what comes as a signal counts as zero before the start
    "#]].assert_eq(&problems(
        r#""w": Constant(value: "5 A"), "j": ControlledCurrentSource, "l": Inductor(l: "1 mH", i0: "2 A")"#,
        r#""w.y -> j.i", "j.p <-> l.p", "l.n <-> j.n <-> g.p""#,
    ));
    // Two sources in series, and a motor whose current follows from its voltage.
    expect![[r#"
        error[no_current_path]: a prescribed current has no path at `i.p`: only other prescribed currents and windings that cannot follow it meet there
          model.ron:3:70 `"i"` `i` prescribes the current
          model.ron:3:100 `"j"` `j` prescribes the current
          help: connect a resistance or a capacitance there, in parallel to the source
    "#]].assert_eq(&problems(
        r#""w": Constant(value: "5 A"), "i": ControlledCurrentSource, "j": ControlledCurrentSource, "l": Inductor(l: "1 mH")"#,
        r#""w.y -> i.i, j.i", "i.p <-> l.p", "l.n <-> j.n", "j.p <-> i.n <-> g.p""#,
    ));
    expect![[r#"
        error[no_current_path]: a prescribed current has no path at `j.n`: only other prescribed currents and windings that cannot follow it meet there
          model.ron:4:12 `"m"` `m` prescribes the current
          help: connect a resistance or a capacitance there, in parallel to the source
    "#]].assert_eq(&problems(
        r#""w": Constant(value: "5 A"), "j": ControlledCurrentSource, "h": RotationalReference,
           "m": DcMotor(r: "1 Ohm", l: "0 H", k: "0.1 N*m/A", j: 1)"#,
        r#""w.y -> j.i", "j.n <-> m.p", "j.p <-> m.n <-> g.p", "m.c <-> h.r""#,
    ));
}

/// A contact that short-circuits a source opens: the inductor behind would have to take its current in no time.
#[test]
fn a_contact_that_forces_a_current_into_an_inductor_is_an_error() {
    let model = text(
        "2 ms",
        "Ode45",
        r#""w": Constant(value: "5 A"), "j": ControlledCurrentSource, "l": Inductor(l: "1 mH"), "k": IdealSwitch(r_on: "1 mOhm", g_off: 0),
           "t": Step(time: "1 ms", before: 1, after: 0), "on": Compare(operator: Greater, constant: 0.5)"#,
        r#""w.y -> j.i", "t.y -> on.u", "on.y -> k.gate", "j.n <-> l.p <-> k.p", "j.p <-> l.n <-> k.n <-> g.p", "l.i -> s.i""#,
        r#""i""#,
    );
    let (compiled, problems) = compile_text(&model);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let error = run(schedule).error.expect("no path");
    expect!["the physical network cannot go on: the open valves (`k`) leave the prescribed current of `j` without a path: connect a resistance in parallel, or give the valves an off-state conductance"].assert_eq(&error.message);
}

/// All methods of variable step, and one of fixed step whose grid has the edges.
const METHODS: [&str; 11] = [
    "Auto(rtol: 1e-8)",
    "Ode45(rtol: 1e-9)",
    "Ode23(rtol: 1e-8)",
    "Dop853(rtol: 1e-9)",
    "Radau5(rtol: 1e-8)",
    "Ode15s(rtol: 1e-8)",
    "Ode23t(rtol: 1e-8)",
    "Ode23tb(rtol: 1e-8)",
    "Rodas4(rtol: 1e-8)",
    "RosW3(rtol: 1e-8)",
    "Ode4(step: \"1 us\")",
];

/// A boost converter behind a source of current, all of it ideal. While the switch is open the load gets the whole current, else it
/// lives on the capacitor: `C v' = j - v / R` and `C v' = - v / R`, from edge to edge.
#[test]
fn the_diode_of_a_converter_takes_the_current_of_a_source_over() {
    let (j, r, c, period) = (3.0, 20.0, 10e-6, 20e-6_f64);
    let expected = |t: f64| {
        let decay = |v: f64, end: f64, t: f64| end + (v - end) * (-t / (r * c)).exp();
        let half = 0.5 * period;
        let mut v = 0.0;
        let (mut at, mut on) = (0.0, true);
        while t > at {
            v = decay(v, if on { 0.0 } else { j * r }, half.min(t - at));
            (at, on) = (at + half, !on);
        }
        v
    };
    for inductor in [true, false] {
        let (coil, wire) = if inductor {
            (r#""l": Inductor(l: "100 uH"), "#, r#""j.n <-> l.p", "l.n <-> k.p <-> d.p""#)
        } else {
            ("", r#""j.n <-> k.p <-> d.p""#)
        };
        for solver in METHODS {
            let run = run_text(&text(
                "1 ms",
                solver,
                &format!(
                    r#"{coil}"w": Constant(value: "3 A"), "dw": Constant(value: "0 A/s"), "j": ControlledCurrentSource, "pulse": Pulse(period: "20 us", width: 0.5),
                    "on": Compare(operator: Greater, constant: 0.5), "k": IdealSwitch(r_on: 0, g_off: 0),
                    "d": Diode(v_f: 0, r_on: 0, g_off: 0), "c": Capacitor(c: "10 uF"), "r": Resistor(r: "20 Ohm"),
                    "v": VoltageSensor, "account": EnergyAccount(at: Electrical)"#
                ),
                &format!(
                    r#""w.y -> j.i", "dw.y -> j.di", "pulse.y -> on.u", "on.y -> k.gate", {wire}, "d.n <-> c.p <-> r.p <-> v.p",
                    "j.p <-> k.n <-> c.n <-> r.n <-> v.n <-> g.p <-> account.node", "v.v -> s.v", "d.i -> s.d", "k.i -> s.k",
                    "account.relative -> s.error""#
                ),
                r#""v", "d", "k", "error""#,
            ));
            let off = off(&run, "s.v", &[], expected);
            assert!(off < 1e-6, "{solver}: {off}");
            for ((d, k), t) in run.column("s.d").iter().zip(run.column("s.k")).zip(&run.time) {
                assert!((d + k - j).abs() < 1e-12 && d * k == 0.0, "{solver}: {d} and {k} A at {t}");
            }
            let worst = run.column("s.error").iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
            assert!(worst < 1e-5, "{solver}: {worst}");
        }
    }
    // Half of the current is left of it in the mean.
    let settled: f64 = (0..2000).map(|k| expected(1e-2 + f64::from(k) * 1e-8)).sum::<f64>() / 2000.0;
    assert!((settled - 0.5 * j * r).abs() < 1e-2, "{settled}");
}

/// Four ideal diodes turn the current of a source round, which finds another pair at each of its zeros; at the first instant there is
/// nothing to decide by.
#[test]
fn a_bridge_of_ideal_diodes_passes_the_current_of_a_source_on() {
    for phase in ["0 deg", "10 deg", "180 deg", "250 deg"] {
        let lead: f64 = phase.trim_end_matches(" deg").parse::<f64>().expect("a number").to_radians();
        for solver in METHODS {
            let run = run_text(&text(
                "50 ms",
                solver,
                &format!(
                    r#""w": Sine(amplitude: "2 A", frequency: "50 Hz", phase: "{phase}"), "j": ControlledCurrentSource,
                    "a": Diode(v_f: 0, r_on: 0), "b": Diode(v_f: 0, r_on: 0), "c": Diode(v_f: 0, r_on: 0),
                    "d": Diode(v_f: 0, r_on: 0), "r": Resistor(r: "10 Ohm"), "v": VoltageSensor"#
                ),
                r#""w.y -> j.i", "j.n <-> a.p <-> b.n", "j.p <-> c.p <-> d.n", "a.n <-> c.n <-> r.p <-> v.p",
                   "b.p <-> d.p <-> r.n <-> v.n <-> g.p", "v.v -> s.v""#,
                r#""v""#,
            ));
            let off = off(&run, "s.v", &[], |t| 20.0 * (TAU * 50.0 * t + lead).sin().abs());
            // A step of fixed size ends behind a zero of the current.
            let tolerance = if solver.starts_with("Ode4") { 1e-3 } else { 1e-6 };
            assert!(off < tolerance, "{solver}, {phase}: {off}");
        }
    }
}

/// The same source with the diode the other way round.
#[test]
fn a_diode_against_a_current_is_no_path() {
    let model = text(
        "2 ms",
        "Ode45",
        r#""w": Constant(value: "5 A"), "j": ControlledCurrentSource, "d": Diode(v_f: 0, g_off: 0), "k": IdealSwitch(r_on: 0, g_off: 0),
           "t": Step(time: "1 ms", before: 1, after: 0), "on": Compare(operator: Greater, constant: 0.5)"#,
        r#""w.y -> j.i", "t.y -> on.u", "on.y -> k.gate", "j.n <-> d.n <-> k.p", "j.p <-> d.p <-> k.n <-> g.p", "d.i -> s.i""#,
        r#""i""#,
    );
    let (compiled, problems) = compile_text(&model);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    let error = run(schedule).error.expect("no path");
    assert_eq!(error.t, 1e-3);
    expect!["the physical network cannot go on: the open valves (`d`, `k`) leave the prescribed current of `j` without a path: connect a resistance in parallel, or give the valves an off-state conductance"].assert_eq(&error.message);
}

/// A saturating coil in series with a current source carries the current of the source, whatever its flux is, told its slope or not.
#[test]
fn a_saturating_coil_carries_what_a_current_source_gives() {
    for source in [
        r#""u": Constant(value: "2 A")"#,
        r#""u": Ramp(slope: "2 A/s")"#,
        r#""u": Step(after: "2 A", time: "0.3 s")"#,
    ] {
        for method in ["Auto", "Radau5(rtol: 1e-6)", "Ode4(step: \"1 ms\")"] {
            let run = blocksim_tests::run_blocks(
                "1 s",
                method,
                &format!(
                    r#"{source}, "a": SaturatingInductor(l0: 0.02, l_s: 0.002, i_s: 1), "l": Inductor(l: 0.01), "r": Resistor(r: 1),
                       "src": ControlledCurrentSource, "g": ElectricalReference, "s": Scope(inputs: ["u", "a", "l", "r", "psi"])"#
                ),
                r#""u.y -> src.i, s.u", "src.n <-> a.p", "a.n <-> l.p", "l.n <-> r.p", "r.n <-> src.p <-> g.p",
                   "a.i -> s.a", "l.i -> s.l", "r.i -> s.r", "a.psi -> s.psi""#,
            );
            assert!(run.error.is_none(), "{source}, {method}: {:?}", run.error);
            for signal in ["s.a", "s.l", "s.r"] {
                let off = run.column("s.u").iter().zip(run.column(signal)).map(|(u, i)| (u - i).abs());
                assert!(off.fold(0.0, f64::max) < 1e-9, "{source}, {method}: {signal}");
            }
            // psi = l_s i + (l0 - l_s) i_s tanh(i / i_s).
            let psi = 0.002 * 2.0 + 0.018 * 2.0_f64.tanh();
            assert!((run.last("s.psi") - psi).abs() < 1e-9, "{source}, {method}: {}", run.last("s.psi"));
        }
    }
}
