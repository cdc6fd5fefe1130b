//! Electrical networks of resistors, inductors and capacitors against their closed forms.

use blocksim_tests::{compile_text, run_text};
use expect_test::expect;

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

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} != {expected}");
}

#[test]
fn a_capacitor_charges_through_a_resistor() {
    let run = run_text(&circuit(
        "5 ms",
        r#""u": VoltageSource(v: "10 V"), "r": Resistor(r: "1 kOhm"), "c": Capacitor(c: "1 uF"), "a": CurrentSensor"#,
        r#""u.p <-> a.p", "a.n <-> r.p", "r.n <-> c.p", "u.n <-> c.n <-> g.p", "c.v -> s.v", "a.i -> s.i""#,
        r#""v", "i""#,
    ));
    for (row, t) in run.time.iter().enumerate() {
        let rest = (-t / 1e-3).exp();
        close(run.column("s.v")[row], 10.0 * (1.0 - rest), 1e-7);
        close(run.column("s.i")[row], 0.01 * rest, 1e-10);
    }
}

#[test]
fn a_series_circuit_swings_as_its_characteristic_equation_says() {
    let (r, l, c, v) = (20.0, 10e-3, 10e-6, 12.0);
    let run = run_text(&circuit(
        "10 ms",
        r#""u": VoltageSource(v: "12 V"), "r": Resistor(r: "20 Ohm"), "l": Inductor(l: "10 mH"), "c": Capacitor(c: "10 uF")"#,
        r#""u.p <-> r.p", "r.n <-> l.p", "l.n <-> c.p", "c.n <-> u.n <-> g.p", "c.v -> s.v", "l.i -> s.i""#,
        r#""v", "i""#,
    ));
    let (damping, own) = (r / (2.0 * l), 1.0 / f64::sqrt(l * c));
    let w = (own * own - damping * damping).sqrt();
    for (row, t) in run.time.iter().enumerate() {
        let decay = (-damping * t).exp();
        let voltage = v * (1.0 - decay * ((w * t).cos() + damping / w * (w * t).sin()));
        close(run.column("s.v")[row], voltage, 1e-6);
        close(run.column("s.i")[row], v / (w * l) * decay * (w * t).sin(), 1e-7);
    }
}

#[test]
fn a_bridge_of_resistors_divides_as_kirchhoff_says() {
    // Wheatstone bridge 1, 2 / 3, 4 kOhm with 5 kOhm across, fed by 10 V.
    let run = run_text(&circuit(
        "1 ms",
        r#""u": VoltageSource(v: "10 V"), "r1": Resistor(r: "1 kOhm"), "r2": Resistor(r: "2 kOhm"),
           "r3": Resistor(r: "3 kOhm"), "r4": Resistor(r: "4 kOhm"), "r5": Resistor(r: "5 kOhm"), "m": VoltageSensor,
           "a": CurrentSensor"#,
        r#""u.p <-> a.p", "a.n <-> r1.p <-> r3.p", "r1.n <-> r2.p <-> r5.p <-> m.p",
           "r3.n <-> r4.p <-> r5.n <-> m.n", "u.n <-> r2.n <-> r4.n <-> g.p", "m.v -> s.v", "a.i -> s.i""#,
        r#""v", "i""#,
    ));
    // Nodes a and b by hand: a (1 + 1/2 + 1/5) - b/5 = 10, b (1/3 + 1/4 + 1/5) - a/5 = 10/3, in kOhm and mA.
    let (a11, a12, a22) = (1.0 + 0.5 + 0.2, -0.2, 1.0 / 3.0 + 0.25 + 0.2);
    let determinant = a11 * a22 - a12 * a12;
    let (a, b) =
        ((10.0 * a22 - a12 * 10.0 / 3.0) / determinant, (a11 * 10.0 / 3.0 - a12 * 10.0) / determinant);
    close(run.last("s.v"), a - b, 1e-12);
    close(run.last("s.i"), ((10.0 - a) + (10.0 - b) / 3.0) * 1e-3, 1e-15);
}

#[test]
fn a_current_source_charges_a_capacitor_evenly_and_finds_its_voltage_at_a_resistor() {
    let run = run_text(&circuit(
        "10 ms",
        r#""k": Constant(value: "2 mA"), "q": ControlledCurrentSource, "c": Capacitor(c: "1 uF"), "w": ControlledCurrentSource,
           "r": Resistor(r: "1 kOhm"), "m": VoltageSensor"#,
        r#""k.y -> q.i, w.i", "q.n <-> c.p", "q.p <-> c.n <-> g.p", "w.n <-> r.p <-> m.p", "w.p <-> r.n <-> m.n <-> g.p",
           "c.v -> s.v", "m.v -> s.r""#,
        r#""v", "r""#,
    ));
    close(run.last("s.v"), 2e-3 * 10e-3 / 1e-6, 1e-9);
    close(run.last("s.r"), 2.0, 1e-12);
}

#[test]
fn a_motor_starts_through_a_resistor_that_a_measured_current_controls() {
    // The sensor reads the state of the motor, so the loop around the source is none.
    let run = run_text(&circuit(
        "2 s",
        r#""set": Constant(value: "3 A"), "e": Sum(signs: "+-"), "k": Gain(k: "200 V/A"), "u": ControlledVoltageSource,
           "a": CurrentSensor, "r": Resistor(r: "2 Ohm"), "m": DcMotor(r: "1 Ohm", l: "5 mH", k: "0.1 N*m/A", j: "1e-3 kg*m^2"),
           "h": RotationalReference, "w": MotionSensor"#,
        r#""set.y -> e.u1", "a.i -> e.u2, s.i", "e.y -> k.u", "k.y -> u.v", "u.p <-> a.p", "a.n <-> r.p", "r.n <-> m.p",
           "m.n <-> u.n <-> g.p", "m.r <-> w.r", "m.c <-> w.c <-> h.r", "w.w -> s.w""#,
        r#""i", "w""#,
    ));
    // (200 (3 - i) - 3 i - 0.1 w) = 5e-3 di/dt: after the electrical transient i follows w slowly.
    let (i, w) = (run.last("s.i"), run.last("s.w"));
    let dw = 0.1 * i / 1e-3;
    let di = -0.1 * dw / 203.0;
    close(i, (600.0 - 0.1 * w - 5e-3 * di) / 203.0, 1e-6);
}

#[test]
fn power_is_balanced_at_every_instant() {
    let run = run_text(&circuit(
        "4 ms",
        r#""f": Sine(amplitude: 10, frequency: "500 Hz"), "v": Gain(k: "1 V"), "u": ControlledVoltageSource, "a": CurrentSensor,
           "r": Resistor(r: "30 Ohm"), "l": Inductor(l: "10 mH"), "c": Capacitor(c: "4 uF"), "p": Resistor(r: "200 Ohm"),
           "vr": VoltageSensor, "vl": VoltageSensor, "vp": VoltageSensor"#,
        r#""f.y -> v.u", "v.y -> u.v, s.v", "u.p <-> a.p", "a.n <-> r.p <-> vr.p", "r.n <-> vr.n <-> l.p <-> vl.p",
           "l.n <-> vl.n <-> c.p <-> p.p <-> vp.p", "c.n <-> p.n <-> vp.n <-> u.n <-> g.p", "a.i -> s.i", "vr.v -> s.vr",
           "vl.v -> s.vl", "vp.v -> s.vp""#,
        r#""v", "i", "vr", "vl", "vp""#,
    ));
    for row in 0..run.time.len() {
        let at = |name: &str| run.column(name)[row];
        // The capacitor takes what the parallel resistor leaves.
        let capacitor = at("s.i") - at("s.vp") / 200.0;
        let taken = at("s.vr").powi(2) / 30.0
            + at("s.vl") * at("s.i")
            + at("s.vp").powi(2) / 200.0
            + at("s.vp") * capacitor;
        close(at("s.v") * at("s.i"), taken, 1e-12);
    }
}

#[test]
fn circuits_without_a_solution_are_named() {
    let problems = |blocks: &str, connections: &str| {
        compile_text(&circuit(
            "1 s",
            &format!("{blocks}, \"k\": Constant(value: 1)"),
            &format!("{connections}, \"k.y -> s.k\""),
            "\"k\"",
        ))
        .1
    };
    expect![[r#"
        error[parameter]: `r` is -5 Ohm, but must be positive
          model.ron:3:88 `"-5 Ohm"` 
          note: in block `r` (Resistor)
          help: write a number above 0
    "#]]
    .assert_eq(&problems(
        r#""u": VoltageSource(v: "1 V"), "r": Resistor(r: "-5 Ohm")"#,
        r#""u.p <-> r.p", "r.n <-> u.n <-> g.p""#,
    ));
    expect![[r#"
        error[indeterminate_current]: a current that follows from a voltage changes that voltage at the same instant
          model.ron:3:98 `"m"` `m` has no inductance
          help: give the motor an inductance, or connect it to an ideal source
    "#]].assert_eq(&problems(
        r#""u": VoltageSource(v: "1 V"), "r": Resistor(r: "5 Ohm"), "m": DcMotor(r: "1 Ohm", l: "0 H", k: "0.1 N*m/A", j: 1), "h": RotationalReference"#,
        r#""u.p <-> r.p", "r.n <-> m.p", "m.n <-> u.n <-> g.p", "m.c <-> h.r""#,
    ));
}

/// A line of 1000 sections of 1 ohm and 1 uF follows the diffusion equation: as long as nothing arrives at its end, the voltage
/// `x` sections behind a step is `erfc(x / (2 sqrt(t / RC)))`.
#[test]
fn a_line_of_a_thousand_sections_diffuses() {
    let n = 1000;
    let (mut blocks, mut wires) = (String::new(), String::from("\"u.n <-> g.p\", \"u.p <-> r0.p\""));
    for k in 0..n {
        blocks.push_str(&format!("\"r{k}\": Resistor(r: 1), \"c{k}\": Capacitor(c: 1e-6), "));
        let next = if k + 1 < n { format!(" <-> r{}.p", k + 1) } else { String::new() };
        wires.push_str(&format!(", \"r{k}.n <-> c{k}.p{next}\", \"c{k}.n <-> g.p\""));
    }
    let text = format!(
        "Diagram(simulation: (stop_time: \"2 ms\", solver: Ode45), blocks: {{ \"g\": ElectricalReference, \"u\": \
         VoltageSource(v: 1), {blocks} \"s\": Scope(inputs: [\"near\", \"far\"]) }}, connections: [{wires}, \"c44.v -> s.near\", \"c{}.v -> s.far\"])",
        n - 1
    );
    let begun = std::time::Instant::now();
    let (compiled, problems) = compile_text(&text);
    let schedule = compiled.schedule.expect(&problems);
    // Thirty times what it takes, so that only a wrong order of growth fails.
    assert!(begun.elapsed().as_secs_f64() < 20.0, "{:?}", begun.elapsed());
    let run = blocksim_tests::run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    // The integral of exp(-s^2) from 0 to 45 / (2 sqrt(2000)), by Simpson's rule.
    let end = 45.0 / (2.0 * f64::sqrt(2e-3 / 1e-6));
    let bell = |k: i32| (-(end * f64::from(k) / 100.0).powi(2)).exp();
    let weight = |k: i32| if k == 0 || k == 100 { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
    let area: f64 = (0..=100).map(|k| weight(k) * bell(k)).sum::<f64>() * end / 300.0;
    // Lumped sections differ from a line by about 1 / (8 * 2000).
    close(run.last("s.near"), 1.0 - area * 2.0 / std::f64::consts::PI.sqrt(), 3e-4);
    close(run.last("s.far"), 0.0, 1e-9);
}
