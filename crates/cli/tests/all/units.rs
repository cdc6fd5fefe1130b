//! `check --units strict`, and parameters that nothing reads.

use crate::desk::Desk;
use crate::support::{commands_of, root};
use expect_test::expect;

/// The diagrams of an error page: the one that fails and the repaired one.
fn diagrams(page: &str) -> [String; 2] {
    let text = std::fs::read_to_string(root().join("docs/errors").join(page)).expect("the page");
    let mut diagrams =
        text.split("```ron\n").skip(1).map(|part| part.split("```").next().unwrap_or_default());
    [diagrams.next(), diagrams.next()].map(|diagram| diagram.expect("a diagram").to_owned())
}

#[test]
fn the_page_about_bare_numbers_is_true_and_fix_writes_what_was_meant() {
    let [fails, repaired] = diagrams("bare_number.md");
    let desk = Desk::with(&[("model.ron", &fails)]);
    let [(_, answer)] = &commands_of("errors/bare_number.md")[..] else { panic!("one command") };
    let strict = desk.call(&["check", "model.ron", "--units", "strict"]);
    assert_eq!((strict.code, &strict.err), (Some(3), answer));
    assert_eq!(desk.call(&["check", "model.ron"]).code, Some(0));
    assert_eq!(desk.call(&["check", "model.ron", "--units", "strict", "--fix"]).code, Some(0));
    assert_eq!(desk.read("model.ron"), repaired);
}

#[test]
fn without_a_unit_means_no_unit_where_units_are_strict() {
    let model = r#"Diagram(
    simulation: (stop_time: Auto(margin: 1), solver: Ode4(step: 0.01), output: Every(0.1)),
    blocks: {
        "volts": Constant(value: "3 V"),
        "offset": Constant(value: 1.5),
        "zero": Constant(value: 0),
        "sum": Sum(signs: "+++"),
        "gain": Gain(k: 8),
        "filter": TransferFunction(num: [1], den: [0.5, 1]),
        "limit": Saturation(lower: -2, upper: "2 V"),
        "show": Scope,
    },
    connections: [
        "volts.y -> sum.u1", "offset.y -> sum.u2", "zero.y -> sum.u3",
        "sum.y -> gain.u", "gain.y -> filter.u", "filter.y -> limit.u", "limit.y -> show.u",
    ],
)
"#;
    let desk = Desk::with(&[("model.ron", &model.replace("Auto(margin: 1)", "\"1 s\""))]);
    let open = desk.call(&["check", "model.ron"]);
    assert_eq!(open.code, Some(0), "{}", open.text());
    expect![[r#"
        model.ron:2:55: error[bare_number]: `step` is in s, but `0.01` has no unit
        model.ron:2:76: error[bare_number]: `output` is in s, but `0.1` has no unit
        model.ron:14:43: error[unit_mismatch]: in `sum`: `u2` is in 1, but `u1` is in V
        model.ron: 3 errors
        exit code 3
    "#]]
    .assert_eq(&desk.said(&["check", "model.ron", "--units", "strict", "--output-format", "short"]));
}

#[test]
fn a_value_that_changes_nothing_is_reported() {
    let set = "(motor: (r: \"1 ohm\", l: \"2 mH\"), note: 3)";
    let model = r#"Diagram(
    parameters: { "data": File("set.ron"), "k": 2.0, "unused": 1.0, "pair": (a: 1.0, b: 2.0) },
    blocks: {
        "source": Constant(value: "k * pair.a"),
        "part": Subsystem(file: "part.ron", with: { "r": "data.motor.r" }),
        "show": Scope,
    },
    connections: ["source.y -> part.u", "part.y -> show.u"],
)
"#;
    let part = r#"Diagram(
    parameters: { "r": Required, "spare": 1.0 },
    inputs: { "u": () },
    outputs: { "y": "gain.y" },
    blocks: { "gain": Gain(k: "r") },
    connections: ["in.u -> gain.u"],
)
"#;
    let desk = Desk::with(&[("set.ron", set), ("part.ron", part), ("model.ron", model)]);
    expect![[r#"
        model.ron: 3 warnings; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        warning[unused_parameter]: nothing reads the parameter `unused`
         --> model.ron:2:54
          |
        2 |     parameters: { "data": File("set.ron"), "k": 2.0, "unused": 1.0, "pair": (a: 1.0, b: 2.0) },
          |                                                      ^^^^^^^^ changes nothing
          |
          = help: remove it, or name it where it is to act: `"unused"`

        warning[unused_parameter]: nothing reads the parameter `pair.b`
         --> model.ron:2:86
          |
        2 |     parameters: { "data": File("set.ron"), "k": 2.0, "unused": 1.0, "pair": (a: 1.0, b: 2.0) },
          |                                                                                      ^ changes nothing
          |
          = help: remove it, or name it where it is to act: `"pair.b"`

        warning[unused_parameter]: nothing reads the parameter `spare`
         --> part.ron:2:34
          |
        2 |     parameters: { "r": Required, "spare": 1.0 },
          |                                  ^^^^^^^ changes nothing
          |
          = help: remove it, or name it where it is to act: `"spare"`

        exit code 0
    "#]].assert_eq(&desk.said(&["check", "model.ron"]));
    let short = |over: &str| desk.said(&["check", "model.ron", "--output-format", "short", "--set", over]);
    let said =
        ["data.motor.l=3", "data.motor.r=3", "data.note=4", "unused=2", "pair.b=3", "k=3", "part.spare=2"];
    expect![[r#"
        data.motor.l=3
        model.ron: 1 warning; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        command line:1:1: warning[unused_parameter]: nothing reads `data.motor.l`, so this changes nothing
        set data.motor.l = 3 mH
        exit code 0
        data.motor.r=3
        model.ron: no problems; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        set data.motor.r = 3 ohm
        exit code 0
        data.note=4
        model.ron: 1 warning; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        command line:1:1: warning[unused_parameter]: nothing reads `data.note`, so this changes nothing
        exit code 0
        unused=2
        model.ron: 1 warning; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        command line:1:1: warning[unused_parameter]: nothing reads `unused`, so this changes nothing
        exit code 0
        pair.b=3
        model.ron: 1 warning; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        command line:1:1: warning[unused_parameter]: nothing reads `pair.b`, so this changes nothing
        exit code 0
        k=3
        model.ron: no problems; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        exit code 0
        part.spare=2
        model.ron: 1 warning; 3 blocks, 2 signals, 0 continuous states, 0 discrete states, continuous
        command line:1:1: warning[unused_parameter]: nothing reads `spare`, so this changes nothing
        exit code 0
    "#]]
    .assert_eq(&said.map(|over| format!("{over}\n{}", short(over))).concat());
}

/// What ships has no parameter that acts on nothing.
#[test]
fn every_parameter_of_the_shipped_models_is_read() {
    let mut folders = vec![root().join("diagrams")];
    let mut count = 0;
    let desk = Desk::with(&[]);
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).expect("models").map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "ron")
                && std::fs::read_to_string(&path).expect("a text").contains("simulation:")
            {
                let answer = desk.call(&["check", path.to_str().expect("a path")]);
                assert!(!answer.text().contains("unused_parameter"), "{}", answer.text());
                count += 1;
            }
        }
    }
    assert!(count > 20, "only {count} models");
}
