//! Blocks of all kinds within conditional subsystems.

use std::collections::BTreeMap;

use crate::texts::{Run, tried};

/// Examples of all kinds, with inputs that say no unit, beside numbers of theirs that do: within a subsystem that always runs each gives what
/// it gives outside, and what is refused is refused in both.
#[test]
fn every_kind_gives_the_same_in_a_subsystem_that_always_runs() {
    let mut compared = 0;
    for (kind, example) in blocksim_block::kinds()
        .iter()
        .flat_map(|kind| kind.examples().into_iter().map(move |e| (kind.kind, e)))
    {
        let Some(block) = blocksim_diagram::example_block(example) else { continue };
        let Ok(interface) = block.interface(&blocksim_block::Given::nothing()) else { continue };
        if !interface.ports.is_empty() || interface.inputs.is_empty() || interface.outputs.is_empty() {
            continue;
        }
        let names = |list: Vec<&str>, each: &dyn Fn(&str) -> String| -> String {
            list.into_iter().map(each).collect::<Vec<_>>().join(", ")
        };
        let inputs: Vec<&str> = interface.inputs.iter().map(|input| &*input.name).collect();
        let outputs: Vec<&str> = interface.outputs.iter().map(|output| &*output.name).collect();
        let sources: String = (inputs.iter().enumerate())
            .map(|(k, name)| {
                format!(
                    r#""of_{name}": Sine(amplitude: {}, frequency: "0.9 Hz", phase: 0.3), "#,
                    1.0 + 0.7 * k as f64
                )
            })
            .collect();
        let model = |block: &str, more: &str| {
            format!(
                r#"Diagram(simulation: (stop_time: "1.5 s", solver: Ode4(step: "10 ms")),
                    blocks: {{ {sources} "one": Constant(value: 1), "end": Terminator, "b": {block}, "show": Scope(inputs: [{}]) }},
                    connections: ["one.y -> end.u", {}, {} {more}])"#,
                names(outputs.clone(), &|name| format!("\"{name}\"")),
                names(inputs.clone(), &|name| format!("\"of_{name}.y -> b.{name}\"")),
                names(outputs.clone(), &|name| format!("\"b.{name} -> show.{name}\"")),
            )
        };
        let inside = format!(
            r#"Diagram(inputs: {{ {} }}, outputs: {{ {} }}, blocks: {{ "x": {example} }}, connections: [{}])"#,
            names(inputs.clone(), &|name| format!("\"{name}\": ()")),
            names(outputs.clone(), &|name| format!("\"{name}\": \"x.{name}\"")),
            names(inputs.clone(), &|name| format!("\"in.{name} -> x.{name}\"")),
        );
        let plain = model(example, "");
        // Inputs of this kind may be no good for it.
        let Ok(expected) = tried(&[("model.ron", &plain)]) else { continue };
        for states in ["Held", "Reset"] {
            let block = format!(r#"Subsystem(file: "sub.ron", enable: {states})"#);
            let model = model(&block, r#", "one.y -> b.enable""#);
            let files = [("model.ron", &*model), ("sub.ron", &*inside)];
            let found = match tried(&files) {
                Ok(found) => found,
                // What remembers a signal over time cannot stand still.
                Err(problems) if problems.contains("remembers a signal") => continue,
                Err(problems) => panic!("{kind}: {problems}"),
            };
            // An instant may have a row before it and one behind it; the last one counts.
            let last = |run: &Run| -> BTreeMap<u64, Vec<f64>> {
                run.rows.iter().map(|(t, values)| (t.to_bits(), values.clone())).collect()
            };
            let (found, expected) = (last(&found), last(&expected));
            assert!(found.keys().eq(expected.keys()), "{example} with {states}: other times");
            for ((t, found), expected) in found.iter().zip(expected.values()) {
                let same = |(a, b): (&f64, &f64)| {
                    (a - b).abs() <= 1e-12 * (1.0 + b.abs()) || a.is_nan() && b.is_nan()
                };
                assert!(
                    found.iter().zip(expected).all(same),
                    "{example} with {states}: {found:?} in the place of {expected:?} at {} s",
                    f64::from_bits(*t)
                );
            }
            compared += 1;
        }
    }
    assert!(compared > 80, "{compared} subsystems are too few for all kinds");
}
