//! Converters without their switching: variable transformers and the average of a three-phase bridge, against closed forms,
//! balances of power, and the bridge itself with every edge.

use blocksim_tests::{Run, close, compile_text, run_file, run_text};

fn diagram(stop: &str, blocks: &str, connections: &str, shown: &str) -> String {
    format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-9, atol: 1e-9), output: Every("0.1 ms")),
    blocks: {{ {blocks}, "g": ElectricalReference, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    )
}

fn circuit(stop: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    run_text(&diagram(stop, blocks, connections, shown))
}

#[test]
fn a_variable_transformer_has_the_ratio_of_its_input_in_both_directions() {
    let run = circuit(
        "20 ms",
        r#""u": VoltageSource(v: "48 V"), "rs": Resistor(r: "2 Ohm"), "r": Resistor(r: "5 Ohm"),
           "n": Sine(amplitude: 1.5, frequency: "100 Hz"), "x": VariableTransformer"#,
        r#""n.y -> x.ratio, s.n", "u.p <-> rs.p", "rs.n <-> x.p2", "x.p1 <-> r.p",
           "u.n <-> x.n2 <-> x.n1 <-> r.n <-> g.p", "x.i1 -> s.i1", "x.i2 -> s.i2""#,
        r#""n", "i1", "i2""#,
    );
    for row in 0..run.time.len() {
        let n = run.column("s.n")[row];
        // The source sees n^2 over the resistance of the load behind its own.
        let i2 = 48.0 / 2.0 * (n * n / 5.0) / (0.5 + n * n / 5.0);
        close(run.column("s.i2")[row], i2, 1e-12 * 24.0, "current of the second side");
        let v1 = n * (48.0 - 2.0 * i2);
        close(run.column("s.i1")[row], -v1 / 5.0, 1e-12 * 24.0, "current of the first side");
    }
}

/// Three resistors in star at constant duties are one conductance, `sum d (d - mean) / R`.
#[test]
fn a_link_discharges_through_a_converter_as_through_the_conductance_that_it_makes() {
    let (d, load, source, esr, c) = ([0.9, 0.3, 0.45], 10.0, 2.0, 0.3, 1e-3);
    let mean = d.iter().sum::<f64>() / 3.0;
    let g: f64 = d.iter().map(|d| d * (d - mean)).sum::<f64>() / load;
    let run = circuit(
        "10 ms",
        r#""u": VoltageSource(v: "300 V"), "rs": Resistor(r: "2 Ohm"), "link": DcLink(c: "1 mF", r: "0.3 Ohm", v0: "500 V"),
           "d": Constant(value: [0.9, 0.3, 0.45]), "x": AverageValueConverter, "load": ThreePhaseRlc(r: "10 Ohm"),
           "star": FloatingNeutral"#,
        r#""d.y -> x.duty", "u.p <-> rs.p", "rs.n <-> link.p <-> x.p", "u.n <-> link.n <-> x.n <-> g.p",
           "x.ac <-> load.ac1", "load.ac2 <-> star.ac", "link.v -> s.v", "x.i_dc -> s.i", "x.power -> s.power""#,
        r#""v", "i", "power""#,
    );
    // Node of the link: (300 - u) / 2 + (v - u) / 0.3 = g u, c v' = -(v - u) / 0.3.
    let whole = 1.0 / source + 1.0 / esr + g;
    let u = |v: f64| (300.0 / source + v / esr) / whole;
    let rate = (1.0 - 1.0 / (esr * whole)) / (esr * c);
    let end = 300.0 / source / (1.0 / source + g);
    for (row, t) in run.time.iter().enumerate() {
        let v = end + (500.0 - end) * (-rate * t).exp();
        close(run.column("s.v")[row], v, 1e-6, "voltage of the link");
        close(run.column("s.i")[row], g * u(v), 1e-7, "current of the converter");
        close(run.column("s.power")[row], g * u(v) * u(v), 1e-4, "power of the converter");
    }
}

#[test]
fn power_balances_between_both_sides_whatever_the_duties() {
    // Duties run into their limits, and the link has resistance.
    let run = circuit(
        "40 ms",
        r#""u": VoltageSource(v: "560 V"), "rs": Resistor(r: "0.5 Ohm"), "link": DcLink(c: "0.5 mF", r: "50 mOhm", v0: "560 V"),
           "v": Constant(value: "380 V"), "f": Constant(value: "60 Hz"), "ref": PhaseReference, "duties": DutyCycles,
           "dc": CurrentSensor, "vdc": VoltageSensor, "x": AverageValueConverter, "line": ThreePhaseCurrentSensor,
           "va": ThreePhaseVoltageSensor, "load": ThreePhaseRlc(r: "5 Ohm", l: "10 mH"), "star": FloatingNeutral"#,
        r#""v.y -> ref.v", "f.y -> ref.f", "ref.abc -> duties.v", "link.v -> duties.vdc", "duties.duty -> x.duty, s.d",
           "u.p <-> rs.p", "rs.n <-> link.p <-> dc.p", "dc.n <-> x.p <-> vdc.p", "u.n <-> link.n <-> x.n <-> vdc.n <-> g.p",
           "x.ac <-> line.ac1 <-> va.ac", "line.ac2 <-> load.ac1", "load.ac2 <-> star.ac",
           "dc.i -> s.idc", "vdc.v -> s.vdc", "line.i -> s.i", "va.v -> s.v", "x.power -> s.power""#,
        r#""d", "idc", "vdc", "i", "v", "power""#,
    );
    let column = |name: &str, row: usize| run.column(name)[row];
    let mut limited = 0;
    for row in 0..run.time.len() {
        let (mut out, mut sum) = (0.0, 0.0);
        for k in 0..3 {
            let (d, i) = (column(&format!("s.d[{k}]"), row), column(&format!("s.i[{k}]"), row));
            out += column(&format!("s.v[{k}]"), row) * i;
            sum += d * i;
            limited += usize::from(d == 1.0);
        }
        let into = column("s.vdc", row) * column("s.idc", row);
        // Powers up to 30 kW: rounding.
        close(into, out, 1e-7, "power");
        close(into, column("s.power", row), 1e-7, "power that is measured");
        close(column("s.idc", row), sum, 1e-10, "current");
    }
    assert!(limited > 30, "no duty is ever limited");
}

/// The bridge itself, ideal contacts with the same resistance, at 10 kHz. At the turns of the carrier the ripple of its
/// currents passes through zero, but for what the voltages change within a period.
#[test]
fn a_converter_is_the_mean_of_the_bridge_with_every_edge() {
    let run = |modulator: &str, bridge: &str, signal: &str| {
        circuit(
            "60 ms",
            &format!(
                r#""u": VoltageSource(v: "400 V"), "v": Constant(value: "200 V"), "f": Constant(value: "50 Hz"),
                   "link": Constant(value: "400 V"), "ref": PhaseReference, "m": {modulator}, "x": {bridge}, "dc": CurrentSensor,
                   "line": ThreePhaseCurrentSensor, "load": ThreePhaseRlc(r: "5 Ohm", l: "10 mH"), "star": FloatingNeutral"#
            ),
            &format!(
                r#""v.y -> ref.v", "f.y -> ref.f", "ref.abc -> m.v", "link.y -> m.vdc", "m.{signal} -> x.{signal}s",
                   "u.p <-> dc.p", "dc.n <-> x.p", "u.n <-> x.n <-> g.p", "x.ac <-> line.ac1", "line.ac2 <-> load.ac1",
                   "load.ac2 <-> star.ac", "line.i -> s.i", "dc.i -> s.dc""#
            )
            .replace("m.gate ", "m.gates ")
            .replace("x.dutys", "x.duty"),
            r#""i", "dc""#,
        )
    };
    let averaged = run("DutyCycles", "AverageValueConverter(r_on: \"10 mOhm\")", "duty");
    let switched = run(
        "PwmGenerator(switching_frequency: \"10 kHz\", sampling: Natural)",
        "SixPulseInverter(device: Contact, r_on: \"10 mOhm\")",
        "gate",
    );
    let row = |run: &Run, t: f64| run.time.iter().rposition(|at| (at - t).abs() < 1e-9).expect("a row");
    let mut largest = 0.0_f64;
    for k in 0..600 {
        let t = f64::from(k) * 1e-4;
        for phase in ["s.i[0]", "s.i[1]", "s.i[2]"] {
            let (a, b) =
                (averaged.column(phase)[row(&averaged, t)], switched.column(phase)[row(&switched, t)]);
            largest = largest.max(a.abs());
            close(a, b, 0.06, &format!("{phase} at {t} s"));
        }
    }
    assert!(largest > 30.0);
    // Mean of the current of the link over the last turn; rows lie on both sides of every edge.
    let mean = |run: &Run| {
        let (t, y) = (&run.time, run.column("s.dc"));
        let first = row(run, 0.04);
        (first + 1..t.len()).map(|n| 0.5 * (y[n] + y[n - 1]) * (t[n] - t[n - 1])).sum::<f64>() / 0.02
    };
    let (a, b) = (mean(&averaged), mean(&switched));
    assert!((a / b - 1.0).abs() < 2e-3 && a > 20.0, "{a} != {b}");
}

#[test]
fn a_motor_without_inductance_behind_a_converter_follows_at_once_if_nothing_yields() {
    let text = |esr: &str| {
        diagram(
            "10 ms",
            &format!(
                r#""u": VoltageSource(v: "48 V"), "rs": Resistor(r: "0.1 Ohm"), "link": DcLink(c: "1 mF", r: "{esr}", v0: "48 V"),
                   "n": Constant(value: 0.25), "x": VariableTransformer, "m": DcMotor(r: 1.5, l: 0.0, k: 0.05, j: 1e-4),
                   "turn": Inertia(j: 1e-4), "f": RotationalReference"#
            ),
            r#""n.y -> x.ratio", "u.p <-> rs.p", "rs.n <-> link.p <-> x.p2", "x.p1 <-> m.p",
               "u.n <-> link.n <-> x.n2 <-> x.n1 <-> m.n <-> g.p", "m.r <-> turn.r", "m.c <-> f.r", "m.i -> s.i",
               "x.i2 -> s.i2", "link.v -> s.v""#,
            r#""i", "i2", "v""#,
        )
    };
    let run = run_text(&text("0 Ohm"));
    close(run.column("s.i")[0], 0.25 * 48.0 / 1.5, 1e-12, "current at standstill");
    for row in 0..run.time.len() {
        close(run.column("s.i2")[row], 0.25 * run.column("s.i")[row], 1e-12, "current of the link");
    }
    let (compiled, problems) = compile_text(&text("50 mOhm"));
    assert!(compiled.problems.iter().any(|p| p.code == "indeterminate_current"), "{problems}");
}

#[test]
fn what_cannot_be_is_said() {
    // Nothing but an inductance tells the voltage of the link.
    let (compiled, problems) = compile_text(&diagram(
        "1 ms",
        r#""u": VoltageSource(v: "48 V"), "l": Inductor(l: "1 mH"), "n": Constant(value: 0.5), "x": VariableTransformer,
           "r": Resistor(r: "1 Ohm")"#,
        r#""n.y -> x.ratio", "u.p <-> l.p", "l.n <-> x.p2", "x.p1 <-> r.p", "u.n <-> x.n2 <-> x.n1 <-> r.n <-> g.p",
           "x.i1 -> s.i""#,
        r#""i""#,
    ));
    assert!(compiled.problems.iter().any(|p| p.code == "no_current_path"), "{problems}");
    // Both sides in parallel: with a ratio of one any voltage would do.
    let (compiled, problems) = compile_text(&diagram(
        "1 ms",
        r#""n": Step(time: "0.5 ms", before: 0.5, after: 1), "x": VariableTransformer, "r": Resistor(r: "1 Ohm")"#,
        r#""n.y -> x.ratio", "x.p2 <-> x.p1 <-> r.p", "x.n2 <-> x.n1 <-> r.n <-> g.p", "x.i1 -> s.i""#,
        r#""i""#,
    ));
    let run = blocksim_tests::run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    let error = run.error.expect("an error").to_string();
    assert!(error.contains("undetermined") && error.contains("`x`"), "{error}");
}

#[test]
fn the_chopper_holds_the_link_while_the_wheel_is_braked() {
    let run = run_file("diagrams/braking_drive.ron", &[]);
    let (v, w) = (run.column("dc.v"), run.column("speed.w"));
    let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // The solver stops where the chopper closes.
    close(most(v), 450.0, 1e-3, "largest voltage of the link");
    close(
        run.at("speed.w", 0.99),
        60.0 * std::f64::consts::PI,
        0.02 * 60.0 * std::f64::consts::PI,
        "speed before braking",
    );
    assert!(run.last("speed.w").abs() < 6.0, "it is braked");
    let closings = run.events.iter().filter(|(_, path, _)| path == "control").count();
    assert!(closings > 50, "{closings} changes of the chopper");
    // While it brakes, the link stays between both points, once it has come there.
    let first = (0..v.len()).find(|i| run.time[*i] > 1.0 && v[*i] >= 440.0).expect("the chopper closes");
    let braking = (first..run.time.len()).filter(|i| run.time[*i] < 1.4);
    braking.for_each(|i| assert!(v[i] > 439.9, "{} V at {} s", v[i], run.time[i]));
    assert!(w[first] > 100.0);

    // Without it the capacitor takes what the wheel gives off and the machine does not turn into heat.
    let free = run_file("diagrams/braking_drive.ron", &["control.on_at=\"10 kV\""]);
    let row = free.time.iter().position(|t| *t >= 1.0).expect("a row");
    let stored = |v: f64, w: f64| 0.5 * 2e-3 * v * v + 0.5 * 0.2 * w * w;
    let peak = (row..free.time.len())
        .fold(row, |best, i| if free.column("dc.v")[i] > free.column("dc.v")[best] { i } else { best });
    let at = |name: &str, i: usize| free.column(name)[i];
    let given = stored(at("dc.v", row), at("speed.w", row)) - stored(at("dc.v", peak), at("speed.w", peak));
    let heat = at("books.heat", peak) - at("books.heat", row) - at("books.supplied", peak)
        + at("books.supplied", row);
    assert!(at("dc.v", peak) > 1000.0, "{} V", at("dc.v", peak));
    // What the field of the machine holds changes by some ten joules.
    close(given, heat, 60.0, "energy of wheel and capacitor that is gone");
    assert!(heat < 0.5 * 0.5 * 0.2 * at("speed.w", row).powi(2), "most of it is heat: {heat}");
}
