//! `blocksim check --fix` as users call it.

use crate::desk::Desk;
use crate::support::{arguments, commands_of, root};

/// Slips in two files, each with one likely remedy.
const MODEL: &str = r#"// A loop with slips.
Diagram(
    parameters: { "gain": 2.0, "lag": "50 ms", "part": File("part.ron") }, // three of them
    blocks: {
        "demand": Step(time: "0.1 s", aftr: 1.0),
        "amplifier": Gian(k: "gian"),
        "lag_": LowPass(tau: "50 mss"),
        "limit": Saturation(lower: -1.0, upper: 1,05)
        "scope": Scope(inputs: ["set", "actual"]), // shows both
        "other": Constant(value: "part.mass * part.length / lag"),
    },
    connections: [
        "demnd.y -> amplifier.u, scope.set",
        "amplifier.y -> limit.u",
        "limit.y -> lag_.u",
        "lag_.y -> scope.actul",
    ],
)
"#;

#[test]
fn slips_are_mended_in_the_text_and_shown() {
    let desk =
        Desk::with(&[("loop.ron", MODEL), ("part.ron", "(mass: \"2 kg\" length: \"1 m\") // a set\n")]);
    let before = desk.call(&["check", "loop.ron"]);
    assert_eq!(before.code, Some(3));
    assert!(before.err.contains("`--fix` fixes "), "{}", before.err);
    let answer = desk.call(&["check", "loop.ron", "--fix"]);
    let mended = desk.read("loop.ron");
    let expected = MODEL
        .replace("aftr", "after")
        .replace("Gian(k: \"gian\")", "Gain(k: \"gain\")")
        .replace("50 mss", "50 ms")
        .replace("1,05)", "1.05),")
        .replace("demnd", "demand")
        .replace("actul", "actual");
    assert_eq!(mended, expected, "{}", answer.text());
    assert_eq!(desk.read("part.ron"), "(mass: \"2 kg\", length: \"1 m\") // a set\n");
    assert_eq!(answer.code, Some(0), "{}", answer.text());
    for part in
        ["-        \"amplifier\": Gian(", "+        \"amplifier\": Gain(", "+++ part.ron", "no problems; "]
    {
        assert!(answer.out.contains(part), "{part}: {}", answer.out);
    }
    assert!(answer.err.ends_with(" problems in 2 files\n"), "{}", answer.err);
}

#[test]
fn what_is_not_sure_is_left_to_the_author() {
    let text = r#"Diagram(
    parameters: { "axis1": 1.0, "axis3": 2.0 },
    blocks: { "a": Gain(k: "axis2"), "b": Quux, "c": Constant(value: "3 XYZ") },
    connections: ["c.y -> a.u"],
)
"#;
    let desk = Desk::with(&[("unsure.ron", text)]);
    let answer = desk.call(&["check", "unsure.ron", "--fix"]);
    assert_eq!((answer.code, desk.read("unsure.ron").as_str()), (Some(3), text), "{}", answer.text());
    assert!(!answer.err.contains("mended") && answer.out.is_empty(), "{}", answer.text());
}

#[test]
fn a_word_of_the_command_line_is_no_text_of_the_model() {
    let model = "Diagram(\n    parameters: { \"gain\": 2.0 },\n    blocks: { \"one\": Constant(value: \"gain\"), \"scope\": \
                 Scope(inputs: [\"y\"]) },\n    connections: [\"one.y -> scope.y\"],\n)\n";
    let desk = Desk::with(&[("model.ron", model)]);
    let answer = desk.call(&["check", "model.ron", "--fix", "--set", "gain=2 * gian"]);
    assert_eq!((answer.code, desk.read("model.ron").as_str()), (Some(3), model), "{}", answer.text());
    assert_eq!(desk.call(&["check", "model.ron", "--fix", "--watch"]).code, Some(2));
    assert_eq!(desk.call(&["check", "gone.ron", "--fix"]).code, Some(4));
}

#[test]
fn the_remedy_is_part_of_the_data() {
    let desk = Desk::with(&[("loop.ron", &MODEL.replace("1,05)", "1.05),"))]);
    let answer = desk.call(&["check", "loop.ron", "--output-format", "json"]);
    let lines: Vec<serde_json::Value> =
        answer.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let kind = lines.iter().find(|line| line["code"] == "unknown_block").expect("a kind");
    assert_eq!((&kind["edit"]["old"], &kind["edit"]["new"]), (&"Gian".into(), &"Gain".into()));
    assert_eq!((&kind["edit"]["line"], &kind["edit"]["column"]), (&6.into(), &22.into()));
    let missing = lines.iter().find(|line| line["code"] == "missing_file").expect("a file");
    assert!(missing["edit"].is_null());
}

#[test]
fn the_page_shows_what_the_program_does() {
    let page = std::fs::read_to_string(root().join("docs/text.md")).expect("the page");
    let (_, text) = page.split_once("## Automatic fixes").expect("a chapter");
    let (_, text) = text.split_once("```ron\n").expect("a text with slips");
    let desk = Desk::with(&[("slips.ron", text.split("```").next().expect("a text"))]);
    let shown = commands_of("text.md");
    let (line, answer) =
        shown.iter().find(|(line, _)| line.starts_with("blocksim check")).expect("a command");
    let words = arguments(line);
    let told = desk.call(&words[1..].iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(told.out + &told.err, *answer, "{line}");
}
