//! `blocksim fmt` as users call it.

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use crate::support::{arguments, commands_of, program};

const LOOSE: &str =
    "// a lag\nDiagram(\n  title:\"Lag\", // its name\n  blocks:{ \"lag\":LowPass( tau:0.1 ) },\n)\n";
const NEAT: &str =
    "// a lag\nDiagram(\n    title: \"Lag\", // its name\n    blocks: { \"lag\": LowPass(tau: 0.1) },\n)\n";

struct Desk(PathBuf);

impl Desk {
    fn new(name: &str) -> Desk {
        let path = std::env::temp_dir().join(format!("blocksim-fmt-{}-{name}", std::process::id()));
        fs::create_dir_all(path.join("parts/runs")).unwrap();
        Desk(path)
    }

    fn with(self, name: &str, text: &str) -> Desk {
        fs::write(self.0.join(name), text).unwrap();
        self
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }

    fn fmt(&self, words: &[&str]) -> Output {
        command(words).current_dir(&self.0).output().unwrap()
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn command(words: &[&str]) -> Command {
    let mut command = program();
    command.env("NO_COLOR", "1").arg("fmt").args(words);
    command
}

fn texts(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr))
}

#[test]
fn files_are_laid_out_and_told() {
    let desk = Desk::new("files").with("a.ron", LOOSE).with("b.ron", NEAT).with("parts/c.ron", LOOSE);
    let desk = desk.with("parts/runs/kept.ron", LOOSE);
    let output = desk.fmt(&["."]);
    assert_eq!(output.status.code(), Some(0));
    let (told, said) = texts(&output);
    assert_eq!(told, "./a.ron\n./parts/c.ron\n");
    assert_eq!(said, "3 files: 2 changed\n");
    assert_eq!((desk.read("a.ron"), desk.read("parts/c.ron")), (NEAT.to_owned(), NEAT.to_owned()));
    assert_eq!(desk.read("parts/runs/kept.ron"), LOOSE, "results of runs are left alone");
    assert_eq!(texts(&desk.fmt(&["."])).1, "3 files: 0 changed\n");
}

#[test]
fn a_check_shows_the_lines_and_changes_nothing() {
    let desk = Desk::new("check").with("a.ron", LOOSE);
    let output = desk.fmt(&["a.ron", "--check"]);
    assert_eq!(output.status.code(), Some(1));
    let (told, _) = texts(&output);
    assert!(told.starts_with("--- a.ron\n+++ a.ron\n@@ "), "{told}");
    assert!(
        told.contains("\n-  title:\"Lag\", // its name\n") && told.contains("\n+    title: \"Lag\""),
        "{told}"
    );
    assert_eq!(desk.read("a.ron"), LOOSE);
    let desk = desk.with("a.ron", NEAT);
    assert_eq!(desk.fmt(&["a.ron", "--check"]).status.code(), Some(0));
}

#[test]
fn broken_texts_are_told_and_left_while_others_are_laid_out() {
    let broken = "Diagram(\n  title: \"T\"\n  blocks: {},\n)\n";
    let desk = Desk::new("broken").with("a.ron", broken).with("b.ron", LOOSE);
    let output = desk.fmt(&["a.ron", "b.ron"]);
    assert_eq!(output.status.code(), Some(3));
    let (told, said) = texts(&output);
    assert!(said.contains("error[syntax]") && said.contains("--> a.ron:3:"), "{said}");
    assert!(said.ends_with("2 files: 1 changed, 1 left because of errors\n"), "{said}");
    assert_eq!((told.as_str(), desk.read("a.ron").as_str()), ("b.ron\n", broken));
    assert_eq!(desk.read("b.ron"), NEAT);
}

#[test]
fn a_text_may_come_from_the_standard_input() {
    let feed = |text: &str| {
        let mut child = command(&["--stdin"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    };
    assert_eq!(texts(&feed(LOOSE)), (NEAT.to_owned(), String::new()));
    let output = feed("Diagram(");
    assert_eq!(output.status.code(), Some(3));
    assert!(output.stdout.is_empty() && texts(&output).1.contains("<stdin>:1:"));
}

#[test]
fn what_cannot_be_read_is_told() {
    let desk = Desk::new("unread").with("servo.ron", NEAT);
    for (words, said) in [
        (vec!["servp.ron"], "did you mean `servo.ron`?"),
        (vec!["parts"], "holds no .ron file"),
        (vec![], "Usage: blocksim fmt"),
        (vec!["servo.ron", "--stdin"], "cannot be used with"),
    ] {
        let output = desk.fmt(&words);
        assert!(matches!(output.status.code(), Some(2 | 4)), "{words:?}");
        let (_, told) = texts(&output);
        assert!(told.contains(said), "{words:?}: {told}");
    }
}

#[test]
fn the_page_shows_what_the_program_does() {
    let shown = commands_of("text.md");
    let page = fs::read_to_string(crate::support::root().join("docs/text.md")).unwrap();
    let (_, text) = page.split_once("```ron\n").expect("a text to lay out");
    let desk = Desk::new("page").with("lag.ron", text.split("```").next().unwrap());
    let mut seen = 0;
    for (line, answer) in shown.iter().filter(|(line, _)| line.starts_with("blocksim fmt")) {
        let words = arguments(line);
        let output = desk.fmt(&words[2..].iter().map(String::as_str).collect::<Vec<_>>());
        let (told, said) = texts(&output);
        assert_eq!(told + &said, *answer, "{line}");
        seen += 1;
    }
    assert!(seen > 0);
}
