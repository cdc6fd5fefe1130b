//! Bridges of transistors and thyristors and the brake chopper in whole circuits, against piecewise closed forms.

use std::f64::consts::{PI, TAU};

use blocksim_block::schedule::OutputTimes;
use blocksim_tests::{Run, close, compile_file, run, run_text};

/// A circuit with these blocks and connections, recorded by the scope `s`.
fn circuit(stop: &str, blocks: &str, connections: &str, shown: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
    simulation: (stop_time: "{stop}", solver: Ode45(rtol: 1e-9, atol: 1e-9), output: Every("50 us")),
    blocks: {{ {blocks}, "s": Scope(inputs: [{shown}]) }},
    connections: [{connections}],
)"#
    ))
}

/// Mean over the last part of a run, by the rule of trapezoids between rows, which lie on both sides of every jump.
fn mean(run: &Run, name: &str, length: f64) -> f64 {
    let (t, y) = (&run.time, run.column(name));
    let first = t.iter().rposition(|at| *at <= t[t.len() - 1] - length + 1e-12).expect("rows");
    let area: f64 = (first + 1..t.len()).map(|n| 0.5 * (y[n] + y[n - 1]) * (t[n] - t[n - 1])).sum();
    area / (t[t.len() - 1] - t[first])
}

#[test]
fn a_coil_between_two_legs_gets_the_pulses_of_its_modulation() {
    for scheme in ["Bipolar", "Unipolar"] {
        let m = -0.4;
        let run = circuit(
            "4 ms",
            &format!(
                r#""g": ElectricalReference, "u": VoltageSource(v: "48 V"), "m": Constant(value: {m}),
                   "pwm": HBridgePwm(switching_frequency: "10 kHz", scheme: {scheme}),
                   "bridge": HBridge(device: Mosfet, r_on: "5 mOhm"), "l": Inductor(l: "2 mH"), "r": Resistor(r: "1 Ohm")"#
            ),
            r#""m.y -> pwm.m", "pwm.gates -> bridge.gates", "u.p <-> bridge.p", "u.n <-> bridge.n <-> g.p",
               "bridge.a <-> l.p", "l.n <-> r.p", "r.n <-> bridge.b", "l.i -> s.i""#,
            r#""i""#,
        );
        // Two transistors are always in the circuit.
        let (whole, l, period) = (1.0 + 2.0 * 5e-3, 2e-3, 1e-4);
        let duty = 0.5 * (1.0 + m);
        let high = |duty: f64, share: f64| f64::from((share - 0.5).abs() < 0.5 * duty);
        // Leg a is high in the middle of the period; leg b likewise with its own duty, or against leg a.
        let legs = |share: f64| match scheme {
            "Bipolar" => 2.0 * high(duty, share) - 1.0,
            _ => high(duty, share) - high(1.0 - duty, share),
        };
        let mut edges = vec![0.5 * (1.0 - duty), 0.5 * (1.0 + duty), 1.0];
        if scheme == "Unipolar" {
            edges.extend([0.5 * duty, 1.0 - 0.5 * duty]);
        }
        edges.sort_by(f64::total_cmp);
        for (row, t) in run.time.iter().enumerate() {
            let (mut at, mut i, mut k) = (0.0, 0.0, 0);
            while at < *t {
                let (period_start, n) =
                    (f64::from(k / edges.len() as i32) * period, k as usize % edges.len());
                let end = (period_start + edges[n] * period).min(*t);
                let from = if n == 0 { 0.0 } else { edges[n - 1] };
                let most = 48.0 * legs(0.5 * (from + edges[n])) / whole;
                i = most + (i - most) * (-(end - at).max(0.0) * whole / l).exp();
                (at, k) = (end, k + 1);
            }
            close(run.column("s.i")[row], i, 1e-7, &format!("{scheme}, current at {t}"));
        }
        assert!(run.time.len() > 80 + 2 * 40);
    }
}

/// Phase a against phases b and c for 2 ms; then all transistors off.
#[test]
fn the_diodes_of_a_six_pulse_inverter_take_over_and_let_go_at_the_instant_of_the_closed_form() {
    for (v_f, r_on) in [(1.5, 0.02), (1.5, 0.0), (0.0, 0.02), (0.0, 1e-6), (0.0, 0.0)] {
        six_pulses_are_as_the_closed_form(v_f, r_on);
    }
}

fn six_pulses_are_as_the_closed_form(v_f: f64, r_on: f64) {
    let run = circuit(
        "6 ms",
        &format!(
            r#""g": ElectricalReference, "u": VoltageSource(v: "560 V"), "on": Pulse(period: "1 s", width: 0.002), "k": Mux(inputs: 6), "off": Constant(value: 0),
           "gates": Compare(operator: Greater, constant: 0.5), "six": SixPulseInverter(device: Igbt, v_f: {v_f:?}, r_on: {r_on:?}),
           "z": ThreePhaseRlc(r: "2 Ohm", l: "8 mH"), "n": FloatingNeutral, "x": CurrentSensor, "a": ThreePhaseCurrentSensor"#
        ),
        r#""on.y -> k.u1, k.u4, k.u6", "off.y -> k.u2, k.u3, k.u5", "k.y -> gates.u", "gates.y -> six.gates", "u.p <-> x.p", "x.n <-> six.p", "u.n <-> six.n <-> g.p",
           "six.ac <-> a.ac1", "a.ac2 <-> z.ac1", "z.ac2 <-> n.ac", "a.i -> s.i", "x.i -> s.dc""#,
        r#""i", "dc""#,
    );
    // Phase a in series with b and c in parallel, each with its valve.
    let (r, l): (f64, f64) = (1.5 * (2.0 + r_on), 1.5 * 8e-3);
    let (rise, fall) = ((560.0 - 2.0 * v_f) / r, (560.0 + 2.0 * v_f) / r);
    let most = rise * (1.0 - (-2e-3 * r / l).exp());
    let lasts = l / r * (1.0 + most / fall).ln();
    assert!(lasts < 3.9e-3);
    for (row, t) in run.time.iter().enumerate() {
        let i = match t - 2e-3 {
            s if s <= 0.0 => rise * (1.0 - (-t * r / l).exp()),
            s if s < lasts => (most + fall) * (-s * r / l).exp() - fall,
            _ => 0.0,
        };
        for (k, share) in [1.0, -0.5, -0.5].into_iter().enumerate() {
            close(run.column(&format!("s.i[{k}]"))[row], share * i, 1e-7, &format!("phase {k} at {t}"));
        }
        // Driven by the link while on, fed back into it by the diodes.
        if (*t - 2e-3).abs() > 1e-9 {
            let dc = if *t < 2e-3 { i } else { -i };
            close(run.column("s.dc")[row], dc, 1e-7, &format!("link at {t}"));
        }
    }
    let end = 2e-3 + lasts;
    assert!(run.events.iter().any(|(t, ..)| (t - end).abs() < 1e-9), "{end} is not among {:?}", run.events);
}

#[test]
fn a_brake_chopper_holds_the_link_of_a_braking_machine_between_its_points() {
    let run = circuit(
        "20 ms",
        r#""g": ElectricalReference, "i": Constant(value: "-10 A"), "u": ControlledCurrentSource, "c": DcLink(c: "200 uF", v0: "650 V"),
           "b": BrakeChopper(r: "33 Ohm", r_on: "0.5 Ohm"), "k": ChopperControl(on_at: "700 V", off_at: "680 V")"#,
        r#""i.y -> u.i", "u.p <-> c.p <-> b.p", "u.n <-> c.n <-> b.n <-> g.p", "c.v -> k.vdc, s.v", "k.gate -> b.gate",
           "b.power -> s.p""#,
        r#""v", "p""#,
    );
    let (i, r, c): (f64, f64, f64) = (10.0, 33.5, 200e-6);
    let charge = |v: f64| v * c / i;
    let discharge = r * c * ((700.0 - i * r) / (680.0 - i * r)).ln();
    let found: Vec<f64> = run.events.iter().filter(|(_, path, _)| path == "k").map(|(t, ..)| *t).collect();
    let mut expected = vec![charge(50.0)];
    while *expected.last().expect("a first one") < 20e-3 {
        let last = expected[expected.len() - 1];
        expected.push(last + if expected.len() % 2 == 1 { discharge } else { charge(20.0) });
    }
    expected.pop();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(&expected) {
        close(*found, *expected, 1e-9, "switching of the chopper");
    }
    for (row, t) in run.time.iter().enumerate() {
        let n = expected.iter().filter(|at| **at < *t - 1e-9).count();
        if expected.iter().any(|at| (at - t).abs() < 2e-9) {
            continue;
        }
        let since = t - if n == 0 { 0.0 } else { expected[n - 1] };
        let v = match n {
            0 => 650.0 + i * since / c,
            n if n % 2 == 1 => i * r + (700.0 - i * r) * (-since / (r * c)).exp(),
            _ => 680.0 + i * since / c,
        };
        // A tolerance of 1e-9 a step, of 700 V.
        close(run.column("s.v")[row], v, 5e-6, &format!("link at {t}"));
        let heat = if n % 2 == 1 { 33.0 * (v / r).powi(2) } else { 0.0 };
        close(run.column("s.p")[row], heat, 1e-4, &format!("heat at {t}"));
    }
}

/// Gate of a thyristor, on for a share of each period from an angle in degrees on.
fn fired(name: &str, angle: f64, width: f64) -> (String, String) {
    let delay = angle.rem_euclid(360.0) / 360.0 * 20e-3;
    (
        format!(
            r#""{name}": Thyristor(v_f: 0, r_on: "1 mOhm"), "{name}_p": Pulse(period: "20 ms", width: {width}, delay: "{delay} s"),
               "{name}_g": Compare(operator: Greater, constant: 0.5)"#
        ),
        format!(r#""{name}_p.y -> {name}_g.u", "{name}_g.y -> {name}.gate""#),
    )
}

#[test]
fn a_thyristor_bridge_gives_the_cosine_of_its_firing_angle() {
    for angle in [0.0_f64, 30.0, 60.0] {
        let (mut blocks, mut wires) = (Vec::new(), Vec::new());
        for (k, phase) in ["a", "b", "c"].into_iter().enumerate() {
            // A phase is the highest from 60 degrees before its peak on, and the lowest half a turn later.
            let from = 120.0 * k as f64 - 60.0 + angle;
            let ((upper, up), (lower, low)) = (
                fired(&format!("{phase}1"), from, 1.0 / 3.0),
                fired(&format!("{phase}2"), from + 180.0, 1.0 / 3.0),
            );
            blocks.extend([upper, lower]);
            wires.extend([up, low, format!(r#""x.{phase} <-> {phase}1.p <-> {phase}2.n""#)]);
        }
        let run = circuit(
            "1.5 s",
            &format!(
                r#""u": ThreePhaseSource(voltage: "400 V", frequency: "50 Hz"), "x": PhaseSplitter, {},
                   "l": Inductor(l: "0.5 H"), "r": Resistor(r: "10 Ohm"), "m": VoltageSensor"#,
                blocks.join(", ")
            ),
            &format!(
                r#""u.ac <-> x.ac", {}, "a1.n <-> b1.n <-> c1.n <-> l.p <-> m.p", "l.n <-> r.p",
                   "a2.p <-> b2.p <-> c2.p <-> r.n <-> m.n", "m.v -> s.v", "l.i -> s.i""#,
                wires.join(", ")
            ),
            r#""v", "i""#,
        );
        let ideal = 3.0 * 2.0_f64.sqrt() / PI * 400.0 * angle.to_radians().cos();
        let current = ideal / 10.002;
        // The current is in its steady state after 30 time constants; two thyristors of 1 mOhm are in its way.
        close(mean(&run, "s.i", 20e-3), current, 1e-5 * current, &format!("current at {angle} deg"));
        // The rule of trapezoids cuts off (w h)^2 / 12 of a sine.
        close(
            mean(&run, "s.v", 20e-3),
            ideal - 2e-3 * current,
            5e-5 * ideal,
            &format!("voltage at {angle} deg"),
        );
    }
}

#[test]
fn a_thyristor_that_fires_late_cuts_off_the_beginning_of_each_half_wave() {
    for angle in [30.0_f64, 90.0, 135.0] {
        let (blocks, wires) = fired("d", angle, 0.01);
        let run = circuit(
            "60 ms",
            &format!(
                r#""g": ElectricalReference, "u": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), {blocks}, "r": Resistor(r: "10 Ohm")"#
            ),
            &format!(r#"{wires}, "u.p <-> d.p", "d.n <-> r.p", "r.n <-> u.n <-> g.p", "d.i -> s.i""#),
            r#""i""#,
        );
        let expected = 325.0 / 10.001 / TAU * (1.0 + angle.to_radians().cos());
        close(mean(&run, "s.i", 20e-3), expected, 5e-5 * expected, &format!("mean current at {angle} deg"));
    }
}

/// Mean over the periods of the carrier from `start` to `end`, largest and smallest value; rows lie on both sides of every
/// edge and at least every 5 us, within which a current of L/R = 1 ms is a straight line but for 1e-5 of its ripple.
fn between(run: &Run, name: &str, start: f64, end: f64) -> [f64; 3] {
    let (t, y) = (&run.time, run.column(name));
    let row = |at: f64| t.iter().rposition(|t| *t <= at + 1e-12).expect("rows");
    let (first, last) = (row(start), row(end));
    let area: f64 = (first + 1..=last).map(|n| 0.5 * (y[n] + y[n - 1]) * (t[n] - t[n - 1])).sum();
    let values = &y[first..=last];
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    [area / (t[last] - t[first]), largest, smallest]
}

/// The diagram of the H bridge with rows that lie as close as `between` wants them.
fn on_the_h_bridge(set: &[&str]) -> Run {
    let (compiled, problems) = compile_file("diagrams/h_bridge_dc_motor.ron", set);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.settings.output = OutputTimes::Every(5e-6);
    run(schedule)
}

/// In the steady state a coil between two voltages `high` and `low` apart, `share` of the period `period` at the upper one,
/// swings by this, A.
fn ripple(apart: f64, r: f64, l: f64, share: f64, period: f64) -> f64 {
    let left = |time: f64| 1.0 - (-time * r / l).exp();
    apart / r * left(share * period) * left((1.0 - share) * period) / left(period)
}

#[test]
fn a_motor_on_an_h_bridge_runs_in_both_directions_with_the_mean_and_the_ripple_of_the_closed_form() {
    let (v, r, l, k, d, period): (f64, f64, f64, f64, f64, f64) = (48.0, 1.02, 1e-3, 0.1, 2e-3, 1e-4);
    for (scheme, share, apart, pulses) in [("Unipolar", 0.5, v, 2.0), ("Bipolar", 0.75, 2.0 * v, 1.0)] {
        let run = on_the_h_bridge(&[&format!("pwm.scheme={scheme}")]);
        // At rest of all means: m v = R i + k w, k i = d w.
        let i = 0.5 * v * d / (r * d + k * k);
        for (end, sign) in [(0.1, 1.0), (0.25, -1.0)] {
            let [mean, largest, smallest] = between(&run, "current.motor", end - 10.0 * period, end);
            // Time constants of 8.5 ms: less than e^-11 of the change is left.
            close(mean, sign * i, 1e-3 * i, &format!("{scheme}: mean of the current"));
            let expected = ripple(apart, r, l, share, period / pulses);
            close(largest - smallest, expected, 2e-3 * expected, &format!("{scheme}: ripple"));
            let [w, ..] = between(&run, "speed.w", end - 10.0 * period, end);
            close(w, sign * k * i / d, 1e-3 * k * i / d, &format!("{scheme}: speed"));
            // The supply gives what the motor takes and the transistors turn into heat.
            let [from_supply, ..] = between(&run, "current.supply", end - 10.0 * period, end);
            let ripple_heat = r * expected * expected / 12.0;
            let power = 0.5 * v * i + ripple_heat;
            close(v * from_supply, power, 3e-3 * power, &format!("{scheme}: power of the supply"));
        }
        // On the way the motor brakes, into the supply.
        let [back, ..] = between(&run, "current.supply", 0.11, 0.115);
        assert!(back < -0.5, "{scheme}: {back} A");
    }
}

/// Without induced voltage a motor is a coil: `(2 d - 1) V / R` with the duty of the leg a, for all duties.
#[test]
fn a_coil_on_an_h_bridge_carries_the_mean_of_its_duty() {
    for (scheme, m) in
        [("Unipolar", 0.8), ("Unipolar", -0.3), ("Bipolar", 0.2), ("Bipolar", -0.9), ("Bipolar", 0.0)]
    {
        let set = [format!("pwm.scheme={scheme}"), format!("m={m}"), "motor.k=\"0 N*m/A\"".to_owned()];
        let run = on_the_h_bridge(&set.each_ref().map(String::as_str));
        let (v, r, l, period) = (48.0, 1.02, 1e-3, 1e-4);
        for (end, m) in [(0.1, m), (0.25, -m)] {
            let [mean, largest, smallest] = between(&run, "current.motor", end - 10.0 * period, end);
            let d = 0.5 * (1.0 + m);
            close(mean, (2.0 * d - 1.0) * v / r, 1e-4 * v / r, &format!("{scheme}, {m}: mean"));
            let expected = match scheme {
                "Bipolar" => ripple(2.0 * v, r, l, d, period),
                _ => ripple(v, r, l, f64::abs(m), 0.5 * period),
            };
            close(largest - smallest, expected, 1e-5 * expected, &format!("{scheme}, {m}: ripple"));
        }
    }
}

/// All lower transistors are on and no current flows when the first leg switches: nothing but rounding could tell which
/// valve of a leg conducts.
#[test]
fn a_machine_starts_behind_valves_without_forward_voltage_whatever_their_resistance() {
    let text = std::fs::read_to_string("../diagrams/inverter_fed_machine.ron").expect("a diagram");
    let with = |device: &str, r_on: &str| {
        let inverter = format!("SixPulseInverter(device: {device}, v_f: 0, r_on: \"{r_on}\")");
        let changed = text
            .replace(r#"SixPulseInverter(device: Igbt, v_f: "0.8 V", r_on: "10 mOhm")"#, &inverter)
            .replace(r#"stop_time: "1.4 s""#, r#"stop_time: "60 ms""#);
        assert!(changed.contains(&inverter) && changed.contains("60 ms"));
        let run = run_text(&changed);
        let torque = run.column("torque.tau");
        torque[torque.len() - 1]
    };
    let expected = with("Igbt", "1 mOhm");
    for (device, r_on) in [("Igbt", "0 Ohm"), ("Igbt", "1 uOhm"), ("Mosfet", "0 Ohm"), ("Mosfet", "1 uOhm")] {
        let found = with(device, r_on);
        assert!((found - expected).abs() < 0.02 * expected.abs(), "{device}, {r_on}: {found} != {expected}");
    }
}

/// A half-controlled bridge of ideal valves that leak, before a voltage of its own: two valves pass zero at once on what leaks, which is
/// nothing beside the resistance of the load.
#[test]
fn valves_commutate_together_on_what_leaks() {
    let (emf, r, l) = (30.0, 1.0, 50e-3);
    let run = run_text(
        r#"Diagram(
    simulation: (stop_time: "9.5 ms", output: Every("0.1 ms")),
    blocks: {
        "e": VoltageSource(v: "30 V"), "s": AcVoltageSource(amplitude: Peak("100 V"), frequency: "50 Hz"),
        "t1": Thyristor(v_f: 0, r_on: 0, g_off: 1e-7), "d1": Diode(v_f: 0, r_on: 0, g_off: 1e-7),
        "t2": Thyristor(v_f: 0, r_on: 0, g_off: 1e-7), "d2": Diode(v_f: 0, r_on: 0, g_off: 1e-7),
        "p1": Pulse(period: "20 ms", width: "10 %", delay: "2 ms"), "c1": Compare(operator: Greater, constant: 0.5),
        "p2": Pulse(period: "20 ms", width: "10 %", delay: "12 ms"), "c2": Compare(operator: Greater, constant: 0.5),
        "r": Resistor(r: 1), "l": Inductor(l: 50e-3), "g": ElectricalReference, "show": Scope(inputs: ["i"]),
    },
    connections: [
        "p1.y -> c1.u", "c1.y -> t1.gate", "p2.y -> c2.u", "c2.y -> t2.gate", "l.n <-> e.p", "t1.p <-> d1.n <-> s.p",
        "t2.p <-> d2.n <-> s.n", "r.p <-> t1.n <-> t2.n", "g.p <-> e.n <-> d1.p <-> d2.p", "r.n <-> l.p", "l.i -> show.i",
    ],
)"#,
    );
    // From 2 ms on the source drives R and L against the voltage.
    let w = TAU * 50.0;
    let z2 = r * r + w * w * l * l;
    let forced = |t: f64| 100.0 * (r * (w * t).sin() - w * l * (w * t).cos()) / z2 - emf / r;
    for t in [2.5e-3, 5e-3, 9.5e-3] {
        let expected = forced(t) - forced(2e-3) * (-(t - 2e-3) * r / l).exp();
        close(run.at("show.i", t), expected, 2e-5, &format!("at {t} s"));
    }
}

/// A bridge whose choke has the current of the load through a leak while a valve blocks, which is stiff by 2e10 1/s, and shares it
/// with another valve while that conducts, which is not. What the leak carries is nothing beside it.
#[test]
fn a_choke_before_a_bridge_is_stiff_only_while_a_valve_blocks() {
    let bridge = |leak: f64, solver: &str| {
        let valve = |kind: &str| format!("{kind}(v_f: 0, r_on: 0.01, g_off: {leak:?})");
        let run = run_text(&format!(
            r#"Diagram(
    simulation: (stop_time: "100 ms", solver: {solver}),
    blocks: {{
        "t1": {t}, "t2": {t}, "d1": {d}, "d2": {d},
        "s": AcVoltageSource(amplitude: Peak("100 V"), frequency: "50 Hz"), "ls": Inductor(l: 0.5e-3),
        "p1": Pulse(period: "20 ms", width: "5 %", delay: "1.666667 ms"), "c1": Compare(operator: Greater, constant: 0.5),
        "p2": Pulse(period: "20 ms", width: "5 %", delay: "11.666667 ms"), "c2": Compare(operator: Greater, constant: 0.5),
        "r": Resistor(r: 1), "l": Inductor(l: 20e-3), "g": ElectricalReference, "show": Scope(inputs: ["i"]),
    }},
    connections: [
        "p1.y -> c1.u", "c1.y -> t1.gate", "p2.y -> c2.u", "c2.y -> t2.gate", "s.p <-> ls.p", "t1.p <-> t2.n <-> ls.n",
        "d1.p <-> d2.n <-> s.n", "r.p <-> t1.n <-> d1.n", "l.n <-> g.p <-> t2.p <-> d2.p", "r.n <-> l.p", "l.i -> show.i",
    ],
)"#,
            t = valve("Thyristor"),
            d = valve("Diode")
        ));
        assert!(run.error.is_none(), "{solver}: {:?}", run.error);
        run
    };
    let without = bridge(0.0, "Ode45(rtol: 1e-9)").last("show.i");
    for (solver, most) in
        [("Auto", 2500), ("Ode15s", 2000), ("Ode23t", 2500), ("Ode23tb", 2000), ("Radau5", 700)]
    {
        let run = bridge(1e-7, solver);
        let found = run.last("show.i");
        assert!((found / without - 1.0).abs() < 2e-4, "{solver}: {found}, without leaks {without}");
        assert!(run.counts.accepted < most, "{solver}: {:?}", run.counts);
    }
}
