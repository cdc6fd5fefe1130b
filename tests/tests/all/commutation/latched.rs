//! Thyristors in series: one that others keep from carrying anything forgets that it was fired.

use blocksim_tests::run_blocks;

use super::METHODS;

/// Two thyristors in series behind a source of 50 Hz, fired for 1 ms each, never in the same half-wave: in the limit of no leakage nothing
/// flows at any time.
#[test]
fn a_thyristor_does_not_remember_a_gate_that_brought_no_current() {
    let coil =
        (r#""r": Resistor(r: "10 Ohm"), "l": Inductor(l: "5 mH")"#, r#""r.n <-> l.p", "l.n <-> look.p""#);
    for (parts, wire) in [(r#""r": Resistor(r: "10 Ohm")"#, r#""r.n <-> look.p""#), coil] {
        let blocks = format!(
            r#""source": AcVoltageSource(amplitude: Peak("325 V"), frequency: "50 Hz"), "g": ElectricalReference, {parts},
               "early": Pulse(period: "40 ms", width: 0.025, delay: "3 ms"), "first": Compare(operator: Greater, constant: 0.5),
               "late": Pulse(period: "40 ms", width: 0.025, delay: "22 ms"), "second": Compare(operator: Greater, constant: 0.5),
               "t1": Thyristor, "t2": Thyristor, "look": CurrentSensor, "s": Scope(inputs: ["i"])"#
        );
        let wires = format!(
            r#""source.p <-> t1.p", "t1.n <-> t2.p", "t2.n <-> r.p", {wire}, "look.n <-> source.n <-> g.p",
               "early.y -> first.u", "first.y -> t1.gate", "late.y -> second.u", "second.y -> t2.gate", "look.i -> s.i""#
        );
        for method in METHODS {
            let run = run_blocks("0.1 s", method, &blocks, &wires);
            let most = run.column("s.i").iter().fold(0.0_f64, |most, i| most.max(i.abs()));
            assert!(most < 1e-9, "{method}: {most} A");
            // They conduct while they are fired, and no longer.
            let words: Vec<&str> = run.events.iter().map(|event| event.2.as_str()).collect();
            assert!(
                words.iter().filter(|word| **word == "conducts").count() <= 5,
                "{method}: {:?}",
                run.events
            );
        }
    }
}
