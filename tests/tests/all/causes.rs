//! A mistake is told once: by its cause, and not by what follows from it.

use std::path::Path;

use blocksim_diagram::{Sources, compile};
use blocksim_tests::Desk;

/// Codes of all problems of a diagram, in the order of places.
fn codes(text: &str) -> Vec<&'static str> {
    let desk = Desk::new().with("model.ron", text);
    let sources = Sources::new(&desk);
    compile(&sources, Path::new("model.ron"), &[]).problems.iter().map(|problem| problem.code).collect()
}

/// A loop of a lag with its scope.
const SOUND: &str = r#"Diagram(
    simulation: (stop_time: "1 s", solver: Ode45(rtol: 1e-6)),
    record: ["lag.y"],
    blocks: {
        "one": Constant(value: 1),
        "lag": LowPass(tau: "1 s"),
        "sum": Sum(signs: "+-"),
        "scope": Scope(inputs: ["a", "b"]),
    },
    connections: ["one.y -> sum.u1, scope.a", "sum.y -> lag.u", "lag.y -> sum.u2, scope.b"],
)
"#;

#[test]
fn one_mistake_is_one_problem() {
    assert_eq!(codes(SOUND), Vec::<&str>::new());
    for (right, wrong, code) in [
        ("LowPass", "LowPas", "unknown_block"),
        ("LowPass", "LöwPass", "unknown_block"),
        ("Scope(", "Scöpe(", "unknown_block"),
        ("tau:", "taux:", "unknown_parameter"),
        ("value: 1", "valeu: 1", "unknown_parameter"),
        ("value: 1", "", "missing_parameter"),
        ("value: 1", "1", "syntax"),
        ("-> lag.u", "-> lag.v", "unknown_port"),
        ("-> lag.u", "-> leg.u", "unknown_block_name"),
        ("lag.y ->", "lag.x ->", "unknown_port"),
        ("lag.y ->", "lag.u ->", "wrong_direction"),
        ("\"lag\":", "\"lag\": LowPass(tau: \"2 s\"), \"lag\":", "duplicate_name"),
        ("rtol", "rtool", "parameter"),
        ("Ode45(rtol", "Auto(rtool", "parameter"),
        ("stop_time", "stop_tme", "parameter"),
        ("\"1 s\", solver", "\"1 m\", solver", "parameter"),
        ("value: 1", "value: 1,05", "syntax"),
        ("stop_time:", "stop_time=", "syntax"),
        ("Diagram(\n", "Diagram(\n    # a lag\n", "syntax"),
        ("\"b\"])", "\"b\"]", "syntax"),
        ("scope.b\"],", "scope.b],", "syntax"),
    ] {
        let found = codes(&SOUND.replacen(right, wrong, 1));
        assert_eq!(found, [code], "`{right}` as `{wrong}`");
    }
}

#[test]
fn the_side_that_stands_once_is_the_one_to_mend() {
    // The block is declared by a name that no connection uses; they agree on another one.
    let sound = SOUND.replace("lag", "filter");
    for (wrong, uses) in
        [(sound.replacen("\"filter\":", "\"fitler\":", 1), 2), (sound.replacen("filter.u", "fitler.u", 1), 1)]
    {
        let desk = Desk::new().with("model.ron", &wrong);
        let sources = Sources::new(&desk);
        let problems = compile(&sources, Path::new("model.ron"), &[]).problems;
        let [problem] = problems.as_slice() else { panic!("{problems:?}") };
        assert_eq!(problem.code, "unknown_block_name");
        let edit = problem.remedy().expect("a remedy");
        let mut mended = wrong.clone();
        mended.replace_range(edit.place.span.clone(), &edit.new);
        assert_eq!(mended, sound, "named {uses} times: {}", problem.message);
    }
}

#[test]
fn mistakes_in_different_places_are_all_told() {
    let text =
        SOUND.replace("tau:", "taux:").replace("scope.b", "scope.c").replace("value: 1", "value: \"1 x\"");
    assert_eq!(codes(&text), ["expression", "unknown_parameter", "unknown_port"]);
}

#[test]
fn very_many_mistakes_are_all_told() {
    const MANY: usize = 20_000;
    let blocks: String = (0..MANY).map(|n| format!("\"b{n}\": Gian(k: {n}),\n")).collect();
    let found = codes(&format!("Diagram(simulation: (stop_time: \"1 s\"), blocks: {{\n{blocks}}})"));
    assert_eq!(found.len(), MANY);
    let wires: String = (0..MANY).map(|n| format!("\"one.y -> c{n}.u\",\n")).collect();
    let found = codes(&SOUND.replace("connections: [", &format!("connections: [\n{wires}")));
    let other = found.iter().find(|code| **code != "unknown_block_name");
    assert_eq!((found.len(), other), (MANY, None));
}

/// A loop whose law is a file of its own, chosen from two and used twice.
const TOP: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "one": Constant(value: 1),
        "a": Subsystem(file: "loop.ron", with: { "gain": "2 1/s" }),
        "b": Subsystem(file: "loop.ron", with: { "gain": "3 1/s" }),
        "scope": Scope(inputs: ["a", "b"]),
    },
    connections: ["one.y -> a.set, b.set", "a.actual -> scope.a", "b.actual -> scope.b"],
)
"#;

const LOOP: &str = r#"Diagram(
    parameters: { "gain": Required, "law": Text("p") },
    inputs: { "set": () },
    outputs: { "actual": "state.y" },
    blocks: {
        "error": Sum(signs: "+-"),
        "law": Variant(choice: "law", of: { "p": Subsystem(file: "p.ron"), "none": Subsystem(file: "none.ron") }),
        "state": Integrator(),
    },
    connections: ["in.set -> error.u1", "state.y -> error.u2", "error.y -> law.e", "law.rate -> state.u"],
)
"#;

const P: &str = r#"Diagram(
    inputs: { "e": () },
    outputs: { "rate": "gain.y" },
    blocks: { "gain": Gain(k: "gain") },
    connections: ["in.e -> gain.u"],
)
"#;

const NONE: &str = r#"Diagram(
    inputs: { "e": () },
    outputs: { "rate": "none.y" },
    blocks: { "none": Gain(k: "0 1/s") },
    connections: ["in.e -> none.u"],
)
"#;

fn codes_of_parts(slip: Option<(&str, &str, &str)>) -> Vec<(&'static str, usize)> {
    let mut desk = Desk::new();
    for (name, text) in [("top.ron", TOP), ("loop.ron", LOOP), ("p.ron", P), ("none.ron", NONE)] {
        let slip = slip.filter(|(file, ..)| *file == name);
        if let Some((_, right, _)) = slip {
            assert!(text.contains(right), "`{right}` in {name}");
        }
        desk = desk
            .with(name, &slip.map_or(text.to_owned(), |(_, right, wrong)| text.replacen(right, wrong, 1)));
    }
    let sources = Sources::new(&desk);
    let problems = compile(&sources, Path::new("top.ron"), &[]).problems;
    problems.iter().map(|problem| (problem.code, problem.labels.len())).collect()
}

#[test]
fn one_mistake_in_a_part_is_one_problem_whoever_uses_it() {
    assert_eq!(codes_of_parts(None), []);
    for (file, right, wrong, code, places) in [
        // Sections that are not read: what they would have declared is missed nowhere.
        ("loop.ron", "inputs:", "input:", "unknown_parameter", 1),
        ("loop.ron", "outputs:", "otputs:", "unknown_parameter", 1),
        ("loop.ron", "parameters:", "parametrs:", "unknown_parameter", 1),
        ("loop.ron", "blocks:", "bloks:", "unknown_parameter", 1),
        ("loop.ron", "connections:", "wires:", "unknown_parameter", 1),
        ("p.ron", "outputs:", "results:", "unknown_parameter", 1),
        ("p.ron", "\"gain.y\"", "(a: 1)", "syntax", 1),
        ("loop.ron", "\"state.y\" },", "5 },", "syntax", 1),
        ("loop.ron", "error.u1\", \"", "error.u1 ", "syntax", 1),
        // One name is wrong where it is declared, and missed wherever it is used.
        ("p.ron", "inputs: { \"e\"", "inputs: { \"f\"", "unknown_port", 1),
        ("loop.ron", "inputs: { \"set\"", "inputs: { \"st\"", "unknown_port", 1),
        ("loop.ron", "\"error\": Sum", "\"difference\": Sum", "unknown_block_name", 3),
        ("loop.ron", "outputs: { \"actual\"", "outputs: { \"is\"", "unknown_port", 2),
        ("p.ron", "\"rate\":", "\"slope\":", "variant_ports", 2),
        // And where it is used.
        ("top.ron", "\"gain\": \"2 1/s\"", "\"gan\": \"2 1/s\"", "unknown_parameter", 1),
        ("top.ron", "with: { \"gain\": \"3 1/s\" }", "with: {}", "missing_parameter", 2),
        ("p.ron", "k: \"gain\"", "k: \"gane\"", "expression", 1),
        ("loop.ron", "error.u2\", ", "error.u2\", \"state.y -> error.u2\", ", "second_driver", 2),
        ("loop.ron", "\"state.y -> error.u2\", ", "", "unconnected_input", 1),
        ("loop.ron", "\"+-\"", "\"5 kg\"", "parameter", 1),
    ] {
        let found = codes_of_parts(Some((file, right, wrong)));
        assert_eq!(found, [(code, places)], "{file}: `{right}` as `{wrong}`");
    }
}
