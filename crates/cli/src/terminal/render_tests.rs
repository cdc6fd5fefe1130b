use super::*;
use blocksim_block::problem::Place;
use blocksim_diagram::SourceFile;
use expect_test::expect;

const MOTOR: &str = "Diagram(\n    inputs: {\"u\": (unit: \"V\")},\n    blocks: {\n        \"filter\": LowPass(tau: 0.05),\n    },\n)\n";
const TOP: &str = "Diagram(\n    blocks: {\"größe\": Subsystem(file: \"motor.ron\")},\n    connections: [\n        \"größe.y -> scope.u\",\n    ],\n)\n";

fn files() -> Vec<SourceFile> {
    let file = |path: &str, text: &str| SourceFile { path: path.into(), text: text.into() };
    vec![file("top.ron", TOP), file("parts/motor.ron", MOTOR)]
}

fn place(file: u32, what: &str) -> Place {
    let start = files()[file as usize].text.find(what).unwrap();
    Place { file: FileId(file), span: start..start + what.len() }
}

fn unknown_port() -> Problem {
    Problem::error("unknown_port", "`größe` has no output port `y`")
        .at(&place(0, "größe.y"), "no such port")
        .at(&place(1, "inputs"), "the ports of `größe` are declared here")
        .at(&place(0, "\"größe\""), "`größe` is declared here")
        .note("`größe` is a `Subsystem`")
        .help("its ports are: `u`")
}

#[test]
fn a_problem_shows_all_its_places_in_all_files() {
    expect![[r#"
        error[unknown_port]: `größe` has no output port `y`
         --> top.ron:4:10
          |
        2 |     blocks: {"größe": Subsystem(file: "motor.ron")},
          |              ------- `größe` is declared here
        3 |     connections: [
        4 |         "größe.y -> scope.u",
          |          ^^^^^^^ no such port
          |
         ::: parts/motor.ron:2:5
          |
        2 |     inputs: {"u": (unit: "V")},
          |     ------ the ports of `größe` are declared here
          |
          = note: `größe` is a `Subsystem`
          = help: its ports are: `u`
    "#]]
    .assert_eq(&full(&unknown_port(), &Texts::of(&files()), false));
    assert!(full(&unknown_port(), &Texts::of(&files()), true).contains("\x1b["));
}

#[test]
fn a_problem_without_place_is_its_message() {
    let problem = Problem::warning("stop_time", "the run ends before the move").help("use Auto");
    expect![[r#"
        warning[stop_time]: the run ends before the move
          = help: use Auto"#]]
    .assert_eq(&full(&problem, &Texts::of(&files()), false));
    assert_eq!(short(&problem, &Texts::of(&files())), "warning[stop_time]: the run ends before the move");
}

#[test]
fn a_line_names_file_line_and_column() {
    expect!["top.ron:4:10: error[unknown_port]: `größe` has no output port `y`"]
        .assert_eq(&short(&unknown_port(), &Texts::of(&files())));
}

#[test]
fn data_names_every_place() {
    let data = json(&unknown_port(), &Texts::of(&files()), Some(Exit::Model));
    assert_eq!(data["code"], "unknown_port");
    assert_eq!(data["severity"], "error");
    assert_eq!(data["labels"].as_array().map(Vec::len), Some(3));
    assert_eq!(data["labels"][1]["file"], "parts/motor.ron");
    assert_eq!(data["labels"][1]["line"], 2);
    assert_eq!(data["labels"][0]["column"], 10);
    assert_eq!(data["help"], "its ports are: `u`");
}

#[test]
fn places_outside_of_a_text_or_inside_of_a_character_do_no_harm() {
    for span in [0..0, 5000..6000, 25..5000, TOP.len()..TOP.len(), 26..27] {
        for file in [0, 7] {
            let place = Place { file: FileId(file), span: span.clone() };
            let problem = Problem::error("x", "m").at(&place, "here").at(&place, "");
            assert!(full(&problem, &Texts::of(&files()), false).starts_with("error[x]: m"));
            assert!(short(&problem, &Texts::of(&files())).ends_with("error[x]: m"));
        }
    }
}

#[test]
fn problems_are_counted() {
    let problem = Problem::error("a", "m");
    let warning = Problem::warning("b", "m");
    assert_eq!(tally(&[]), "no problems");
    assert_eq!(tally(&[problem.clone(), problem.clone(), warning.clone()]), "2 errors, 1 warning");
    assert_eq!(tally(&[warning]), "1 warning");
}

#[test]
fn a_line_that_is_too_long_is_shown_at_one_place() {
    let text = format!(
        "Diagram(blocks: {{\"a\": Gain(k: 1.0){} }}, connections: [\"a.z -> b.u\"])",
        " ".repeat(5000)
    );
    let place = |what: &str| {
        let start = text.find(what).unwrap();
        Place { file: FileId(0), span: start..start + what.len() }
    };
    let problem = Problem::error("unknown_port", "`a` has no output `z`")
        .at(&place("a.z"), "no such port")
        .at(&place("\"a\""), "`a` is of kind Gain");
    let files = [SourceFile { path: "long.ron".into(), text: text.clone().into() }];
    let shown = full(&problem, &Texts::of(&files), false);
    assert!(shown.lines().all(|line| line.chars().count() < 200), "{shown}");
    assert!(
        shown.contains("no such port") && shown.contains("line 1, column 18: `a` is of kind Gain"),
        "{shown}"
    );
}
