//! Converters with closed forms.

use std::f64::consts::PI;

use super::{METHODS, try_run};
use blocksim_tests::{Run, close};

fn circuit(method: &str, stop: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    let text = format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: {method}(rtol: 1e-8, atol: 1e-8)),
    blocks: {{ "g": ElectricalReference, {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    );
    try_run(&text).unwrap_or_else(|error| panic!("{method}: {error}"))
}

/// Times at which a valve changes.
fn changes(run: &Run, valve: &str) -> Vec<f64> {
    run.events.iter().filter(|(_, path, _)| path == valve).map(|(t, ..)| *t).collect()
}

/// Zero of a function between two arguments, by bisection.
fn zero(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    assert!(f(a) * f(b) < 0.0, "no sign change");
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if f(a) * f(middle) <= 0.0 { b = middle } else { a = middle }
    }
    0.5 * (a + b)
}

/// Half-wave rectifier with coil and resistance: the current ends where
/// `sin(b - phi) + sin(phi) exp(-b / tan(phi)) = 0` (Mohan, Undeland, Robbins, *Power Electronics*, chapter 5).
#[test]
fn a_half_wave_rectifier_conducts_to_its_angle_of_extinction() {
    let (w, r, l) = (std::f64::consts::TAU * 50.0, 2.0, 10e-3);
    let phi = (w * l / r).atan();
    let extinction = zero(|b| (b - phi).sin() + phi.sin() * (-b / phi.tan()).exp(), PI, 2.0 * PI) / w;
    for method in METHODS {
        let run = circuit(
            method,
            "50 ms",
            r#""u": AcVoltageSource(amplitude: Peak("100 V"), frequency: "50 Hz"), "d": Diode(v_f: 0, r_on: 0),
               "l": Inductor(l: "10 mH"), "r": Resistor(r: "2 Ohm")"#,
            r#""u.p <-> d.p", "d.n <-> l.p", "l.n <-> r.p", "r.n <-> u.n <-> g.p", "l.i -> s.i""#,
            r#""i""#,
        );
        let changes = changes(&run, "d");
        // At the start the derivative of the source decides; then off, on, off, on, off.
        assert_eq!(changes.len(), 4, "{method}: {changes:?}");
        for (n, t) in changes.iter().enumerate() {
            let period = 0.02 * (n.div_ceil(2)) as f64;
            let expected = if n % 2 == 0 { period + extinction } else { period };
            close(*t, expected, 2e-8, &format!("{method}, change {n}"));
        }
    }
}

/// Flyback converter at constant output: while the switch is closed the flux rises by `V t / L`, then it falls by
/// `n (V_o + v_f) t / L` to zero.
#[test]
fn the_diode_of_a_flyback_takes_over_what_the_switch_interrupts() {
    for method in METHODS {
        let run = circuit(
            method,
            "1 ms",
            r#""u": VoltageSource(v: "24 V"), "p": Pulse(period: "100 us", width: 0.4), "c": Compare(operator: Greater, constant: 0.5),
               "k": IdealSwitch(r_on: 0), "m": Inductor(l: "200 uH"), "t": IdealTransformer(ratio: 2),
               "d": Diode(v_f: "0.5 V", r_on: 0), "o": VoltageSource(v: "11.5 V"), "a": CurrentSensor"#,
            r#""p.y -> c.u", "c.y -> k.gate", "u.p <-> m.p <-> t.p1", "m.n <-> t.n1 <-> k.p", "k.n <-> u.n <-> g.p",
               "t.n2 <-> d.p", "d.n <-> a.p", "a.n <-> o.p", "o.n <-> t.p2 <-> g.p", "m.i -> s.m", "a.i -> s.o""#,
            r#""m", "o""#,
        );
        let peak = 24.0 * 40e-6 / 200e-6;
        let fall = peak * 200e-6 / (2.0 * 12.0);
        for (row, t) in run.time.iter().enumerate() {
            if run.time.get(row + 1) == Some(t) {
                continue;
            }
            let at = t.rem_euclid(100e-6);
            let flux = if at < 40e-6 - 1e-12 {
                24.0 * at / 200e-6
            } else {
                (peak * (1.0 - (at - 40e-6) / fall)).max(0.0)
            };
            if !(1e-10..100e-6 - 1e-10).contains(&at) {
                continue;
            }
            close(run.column("s.m")[row], flux, 1e-6, &format!("{method}, current of magnetisation at {t}"));
            let output = if at < 40e-6 - 1e-12 { 0.0 } else { 2.0 * flux };
            close(run.column("s.o")[row], output, 2e-6, &format!("{method}, output at {t}"));
        }
    }
}

/// A switch opens, and the diodes beside the coil block its current: one the wrong way round that has conducted until then, two against each
/// other, a bridge without a load, a bridge whose load would have to take the current at once. Nothing may end it without a word.
#[test]
fn a_current_that_diodes_cannot_take_over_does_not_vanish() {
    let beside = [
        (r#""d": Diode, "r": Resistor(r: "10 Ohm")"#, r#""l.p <-> d.p", "d.n <-> r.p", "r.n <-> l.n""#),
        (r#""d1": Diode, "d2": Diode"#, r#""l.p <-> d1.n", "d1.p <-> d2.p", "d2.n <-> l.n""#),
        (r#""d1": Diode, "d2": Diode"#, r#""l.p <-> d1.p", "d1.n <-> d2.n", "d2.p <-> l.n""#),
        (
            r#""d1": Diode, "d2": Diode, "d3": Diode, "d4": Diode"#,
            r#""l.p <-> d1.p <-> d2.n", "l.n <-> d3.p <-> d4.n", "d1.n <-> d3.n", "d2.p <-> d4.p""#,
        ),
        (
            r#""d1": Diode, "d2": Diode, "d3": Diode, "d4": Diode, "r": Resistor(r: "3 Ohm"), "l2": Inductor(l: "1 mH")"#,
            r#""l.p <-> d1.p <-> d2.n", "l.n <-> d3.p <-> d4.n", "d1.n <-> d3.n <-> r.p", "r.n <-> l2.p", "l2.n <-> d2.p <-> d4.p""#,
        ),
    ];
    for solver in METHODS
        .map(|method| format!("{method}(rtol: 1e-8, atol: 1e-8)"))
        .iter()
        .map(String::as_str)
        .chain([r#"Ode4(step: "10 us")"#])
    {
        for (blocks, connections) in beside {
            let text = format!(
                r#"Diagram(
    simulation: (stop_time: "2 ms", solver: {solver}),
    blocks: {{ "g": ElectricalReference, "u": VoltageSource(v: "10 V"), "p": Pulse(period: "10 ms", width: 0.1),
               "c": Compare(operator: Greater, constant: 0.5), "k": IdealSwitch(r_on: "50 mOhm"), "l": Inductor(l: "1 mH"), {blocks}, "s": Scope }},
    connections: ["p.y -> c.u", "c.y -> k.gate", "u.p <-> k.p", "k.n <-> l.p", "u.n <-> l.n <-> g.p", {connections}, "l.i -> s.u"],
)"#
            );
            let error =
                try_run(&text).err().unwrap_or_else(|| panic!("{solver}: {blocks}: ended")).to_string();
            assert!(error.contains("interrupt the current of an inductance"), "{solver}: {blocks}: {error}");
        }
    }
}

/// Buck converter with so small a coil that its current ends in each period; output held by a source.
#[test]
fn a_buck_converter_rests_between_its_pulses() {
    for method in METHODS {
        let run = circuit(
            method,
            "1 ms",
            r#""u": VoltageSource(v: "48 V"), "p": Pulse(period: "100 us", width: 0.25), "c": Compare(operator: Greater, constant: 0.5),
               "k": IdealSwitch(r_on: 0), "d": Diode(v_f: 0, r_on: 0), "l": Inductor(l: "100 uH"), "o": VoltageSource(v: "24 V")"#,
            r#""p.y -> c.u", "c.y -> k.gate", "u.p <-> k.p", "k.n <-> l.p <-> d.n", "l.n <-> o.p", "o.n <-> u.n <-> d.p <-> g.p",
               "l.i -> s.i""#,
            r#""i""#,
        );
        let peak = 24.0 * 25e-6 / 100e-6;
        for (row, t) in run.time.iter().enumerate() {
            let at = t.rem_euclid(100e-6);
            if !(1e-10..100e-6 - 1e-10).contains(&at) {
                continue;
            }
            let expected =
                if at < 25e-6 { 24.0 * at / 100e-6 } else { (peak - 24.0 * (at - 25e-6) / 100e-6).max(0.0) };
            close(run.column("s.i")[row], expected, 1e-6, &format!("{method} at {t}"));
        }
        // On at each opening of the switch, off at each end of the current.
        assert_eq!(changes(&run, "d").len(), 20, "{method}: {:?}", changes(&run, "d"));
    }
}

/// A diode that leaks: one line up to the forward voltage, another from there.
#[test]
fn the_characteristic_of_a_leaking_diode_has_no_step() {
    for method in METHODS {
        let run = circuit(
            method,
            "10 ms",
            r#""i": Ramp(slope: "400 A/s", initial: "-2 A"), "q": ControlledCurrentSource, "d": Diode(v_f: "0.7 V", r_on: "0.1 Ohm", g_off: "1 S")"#,
            r#""i.y -> q.i", "q.n <-> d.p", "q.p <-> d.n <-> g.p", "d.v -> s.v", "d.i -> s.i""#,
            r#""v", "i""#,
        );
        assert!(run.time.len() > 4, "{method}");
        for row in 0..run.time.len() {
            let (v, i) = (run.column("s.v")[row], run.column("s.i")[row]);
            let expected = if i < 0.7 { i } else { 0.7 + 0.1 * (i - 0.7) };
            close(v, expected, 1e-9, &format!("{method} at {i} A"));
        }
        assert_eq!(changes(&run, "d").len(), 1, "{method}");
    }
}
