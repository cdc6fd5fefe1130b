//! What cannot be translated, as text.

use blocksim_codegen::{Method, Target};
use expect_test::{Expect, expect};

use crate::support::{Loop, every, told};

fn refuses(blocks: &str, wires: &str, target: &Target, expected: &Expect) {
    let control = format!(
        "Diagram(inputs: {{ \"u\": () }}, outputs: {{ \"y\": \"last.y\" }}, blocks: {{ {blocks} }}, connections: [{wires}])"
    );
    let main = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "source": Sine(amplitude: 1.0, frequency: "1 Hz"),
        "control": Subsystem(file: "control.ron"),
        "show": Scope(inputs: ["y"]),
    },
    connections: ["source.y -> control.u", "control.y -> show.y"],
)"#;
    let problems = Loop::new(main, &control).export(target).expect_err("a refusal");
    assert!(problems.iter().all(|problem| problem.code == "export"));
    expected.assert_eq(&told(&problems));
}

#[test]
fn continuous_states_without_a_method() {
    refuses(
        r#""filter": LowPass(tau: "1 s"), "last": Gain(k: 2.0)"#,
        r#""in.u -> filter.u", "filter.y -> last.u""#,
        &every(1e-3),
        &expect![[r#"
            `control/filter` (LowPass) has a continuous state
              give a method of fixed step, `--method euler` or `--method rk4`, or take its discrete form (DiscreteIntegrator, DiscreteTransferFunction, DiscretePid)
        "#]],
    );
}

#[test]
fn all_blocks_that_stand_against_it_are_listed() {
    refuses(
        r#""delay": TransportDelay(delay: "10 ms"), "step": Step(time: "0.5 s"),
           "table": LookupTable1D(breakpoints: [0.0, 1.0], table: [0.0, 2.0], interpolation: Cubic),
           "held": Integrator(reset: Rising), "sum": Sum(signs: "+++"), "last": Sum(signs: "++")"#,
        r#""in.u -> delay.u, table.u, held.u, held.reset", "delay.y -> sum.u1", "step.y -> sum.u2", "table.y -> sum.u3",
           "sum.y -> last.u1", "held.y -> last.u2""#,
        &Target { method: Some(Method::Rk4), ..every(1e-3) },
        &expect![[r#"
            `control/delay` (TransportDelay) remembers what it saw over time
              use a chain of UnitDelay blocks for a dead time of whole steps
            `control/held` (Integrator) has states that jump at events
              take a form without jumps (an Integrator without limits and reset, a DiscreteIntegrator), or leave it outside
            `control/step` (Step) changes by itself at times of its own, which need not be steps of the target
              keep it outside of the subsystem and lead its output in through an input
            `control/table` (LookupTable1D) records no law that could be translated
              replace it by blocks of the signal library that do, or put what runs on the target into a subsystem of its own, without this block, and name it by `--subsystem`
        "#]],
    );
}

#[test]
fn what_a_condition_of_a_subsystem_runs() {
    let control = r#"Diagram(inputs: { "u": () }, outputs: { "y": "sum.y", "z": "last.y" },
        blocks: { "sum": DiscreteIntegrator(ts: "1 ms"), "last": Gain(k: 2.0) }, connections: ["in.u -> sum.u, last.u"])"#;
    let main = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "source": Sine(amplitude: 1.0, frequency: "1 Hz"),
        "control": Subsystem(file: "control.ron", reset: Rising),
        "show": Scope(inputs: ["y", "z"]),
    },
    connections: ["source.y -> control.u, control.reset", "control.y -> show.y", "control.z -> show.z"],
)"#;
    let problems = Loop::new(main, control).export(&every(1e-3)).expect_err("a refusal");
    expect![[r#"
        the inputs `reset` and `u` of `control` are both driven by `source.y`, so that the code could not keep them apart
          put a `Gain(k: 1)` between `source.y` and one of them, outside of `control`
        `control/last` (Gain) runs where the condition of a subsystem holds (`enable`, `trigger`, `reset`, a branch), which is not translated
          export the subsystem without its condition, and call its step on the target when it is to run; or compute all branches and choose with a Switch
        `control/sum` (DiscreteIntegrator) runs where the condition of a subsystem holds (`enable`, `trigger`, `reset`, a branch), which is not translated
          export the subsystem without its condition, and call its step on the target when it is to run; or compute all branches and choose with a Switch
    "#]]
    .assert_eq(&told(&problems));
}

#[test]
fn a_sample_time_that_is_no_multiple_of_the_step() {
    refuses(
        r#""last": UnitDelay(ts: "1.5 ms")"#,
        r#""in.u -> last.u""#,
        &every(1e-3),
        &expect![[r#"
            `control/last` (UnitDelay) samples every 0.0015 s, which is not a multiple of the step of 0.001 s
              choose a rate of which all sample times are multiples
        "#]],
    );
}

#[test]
fn an_algebraic_loop() {
    refuses(
        r#""sum": Sum(signs: "+-"), "last": Gain(k: 0.5)"#,
        r#""in.u -> sum.u1", "sum.y -> last.u", "last.y -> sum.u2""#,
        &every(1e-3),
        &expect![[r#"
            an algebraic loop goes through `control/sum`, `control/last`: it would have to be solved at each step
              break it with a UnitDelay where the loop can wait a step, or solve it by hand
        "#]],
    );
}

#[test]
fn a_physical_network() {
    refuses(
        r#""source": ControlledVoltageSource, "r": Resistor(r: "2 Ohm"), "ground": ElectricalReference, "amps": CurrentSensor, "last": Gain(k: 1.0)"#,
        r#""in.u -> source.v", "source.p <-> r.p", "r.n <-> amps.p", "amps.n <-> source.n <-> ground.p", "amps.i -> last.u""#,
        &every(1e-3),
        &expect![[r#"
            `network(control/amps)` (Network) is a physical network, of `control/amps`, `control/ground`, `control/r`, `control/source`, whose laws are not recorded
              put what runs on the target into a subsystem of its own, without this block, and name it by `--subsystem`
        "#]],
    );
}
