//! Capacitors that are charged through diodes: where a charge ends, against the closed form.
//!
//! The current of such a diode is the difference of two voltages over ten milliohms: what a voltage may be off by at a loose
//! tolerance is a third of the current.

use std::f64::consts::TAU;

use blocksim_tests::{Run, run_text};

const AMPLITUDE: f64 = 20.0;
const OMEGA: f64 = TAU * 50.0;
const V_F: f64 = 0.7;
const R_ON: f64 = 0.01;
const C: f64 = 100e-6;
const R: f64 = 1000.0;

fn peak_detector(solver: &str) -> Run {
    run_text(&format!(
        r#"Diagram(
            simulation: (stop_time: "60 ms", solver: {solver}),
            blocks: {{
                "g": ElectricalReference, "source": AcVoltageSource(amplitude: Peak("20 V"), frequency: "50 Hz"),
                "diode": Diode(v_f: "0.7 V", r_on: "10 mohm"), "c": Capacitor(c: "100 uF"), "r": Resistor(r: "1 kohm"), "show": Scope,
            }},
            connections: [
                "source.p <-> diode.p", "diode.n <-> c.p <-> r.p", "source.n <-> c.n <-> r.n <-> g.p", "c.v -> show.u",
            ],
        )"#
    ))
}

/// When the first charge ends, s: C v' = i - v/R with i = (u - v_f - v)/r_on, of which the first microsecond's decay has long gone.
fn end_of_charge() -> f64 {
    // v = a sin(w t) + b cos(w t) + c solves v' = (u - v_f)/(r_on C) - v/tau.
    let rate = (1.0 / R_ON + 1.0 / R) / C;
    let gain = AMPLITUDE / (R_ON * C) / (rate * rate + OMEGA * OMEGA);
    let (a, b, c) = (gain * rate, -gain * OMEGA, -V_F / (R_ON * C) / rate);
    let current = |t: f64| {
        let (sin, cos) = (OMEGA * t).sin_cos();
        (AMPLITUDE * sin - V_F - (a * sin + b * cos + c)) / R_ON
    };
    let (mut early, mut late) = (0.004, 0.006);
    for _ in 0..100 {
        let middle = 0.5 * (early + late);
        if current(middle) > 0.0 { early = middle } else { late = middle }
    }
    early
}

#[test]
fn a_charge_begins_and_ends_once_in_a_period_whatever_the_method_and_its_tolerance() {
    let end = end_of_charge();
    assert!((end - 5.0987e-3).abs() < 1e-7, "{end}");
    let methods =
        ["Auto", "Ode45", "Ode23", "Ode15s", "Radau5", "Rodas4", "Ode23t", "Ode23tb", "Dop853", "RosW3"];
    for method in methods {
        for rtol in ["1e-3", "1e-4", "1e-5", "1e-6"] {
            // This one follows the circuit at its limit of stability, with ten thousands of steps.
            if method == "RosW3" && rtol == "1e-3" {
                continue;
            }
            let run = peak_detector(&format!("{method}(rtol: {rtol})"));
            let words: Vec<&str> = run.events.iter().map(|event| event.2.as_str()).collect();
            assert_eq!(words, ["conducts", "blocks"].repeat(3), "{method}, {rtol}");
            for (period, event) in run.events.iter().skip(1).step_by(2).enumerate() {
                let off = event.0 - (end + 0.02 * period as f64);
                assert!(off.abs() < 2e-6, "{method}, {rtol}: {off:e} s in period {period}");
            }
        }
    }
}
