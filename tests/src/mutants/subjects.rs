//! What is damaged, and which commands read it.

use std::path::{Path, PathBuf};

use super::Form;

/// A file of the project or of a run, and the commands that read it.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Its kind: `diagram`, `recording` ...
    pub kind: &'static str,
    /// Where it lies, below a folder like that of the project.
    pub file: PathBuf,
    /// How it is damaged.
    pub form: Form,
    /// Commands, with all words; what they write is below `out`.
    pub commands: Vec<Vec<String>>,
}

/// Splits words; a piece between single quotes is one.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut quoted) = (vec![String::new()], false);
    for sign in line.chars() {
        match sign {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            sign => words.last_mut().into_iter().for_each(|word| word.push(sign)),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn subject(kind: &'static str, file: impl Into<PathBuf>, form: Form, lines: &[String]) -> Subject {
    Subject { kind, file: file.into(), form, commands: lines.iter().map(|line| words(line)).collect() }
}

/// Commands that make what is damaged besides the files of the project, in a folder like it.
pub const PREPARATION: [&str; 7] = [
    "run diagrams/servo.ron --out run --quiet --no-plot --csv --until 0.2s",
    "run diagrams/scara/scara.ron --out moving --quiet --no-plot --no-csv --until 0.05s",
    "params export params/irb2600.ron --out book.xlsx",
    "params export diagrams/servo.ron --out servo.xlsx",
    "export run --csv table.csv",
    "export run --csv same.csv",
    "trust .",
];

/// All subjects; `root` is the folder of the project.
pub fn subjects(root: &Path) -> Vec<Subject> {
    let mut all = diagrams(root);
    let run = |file: &str, form, lines: &[&str]| {
        let lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        let kind = file.rsplit('/').next().unwrap_or(file);
        let kind = KINDS.iter().find(|known| **known == kind).copied().unwrap_or("other");
        subject(kind, file, form, &lines)
    };
    let parts = |file: &str, lines: &[&str]| {
        let lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        subject(PARTS, file, Form::Parts, &lines)
    };
    let of_run = [
        "plot run",
        "report run --out out/page.html --yes",
        "export run --csv out/t.csv",
        "compare run same.csv",
    ];
    let of_scene = ["report moving --out out/page.html --yes", "collisions moving", "plot moving"];
    all.extend([
        run("run/signals.rec", Form::Binary, &of_run),
        run("run/signals.csv", Form::Text, &["plot run", "compare run/signals.csv same.csv"]),
        run("run/manifest.json", Form::Text, &["report run --out out/page.html --yes", "plot run", "runs ."]),
        run("run/model.json", Form::Text, &["report run --out out/page.html --yes"]),
        run("run/events.csv", Form::Text, &["report run --out out/page.html --yes"]),
        run("moving/scene.json", Form::Text, &of_scene),
        run("moving/signals.rec", Form::Binary, &of_scene),
        run("moving/model.json", Form::Text, &of_scene),
        run(
            "table.csv",
            Form::Text,
            &[
                "plot table.csv",
                "compare table.csv same.csv",
                "report run --overlay table.csv --out out/page.html --yes",
            ],
        ),
        run(
            "book.xlsx",
            Form::Binary,
            &["params check book.xlsx params/irb2600.ron", "params import book.xlsx params/irb2600.ron"],
        ),
        run("servo.xlsx", Form::Binary, &["params import servo.xlsx diagrams/servo.ron"]),
        parts(
            "book.xlsx",
            &["params check book.xlsx params/irb2600.ron", "params import book.xlsx params/irb2600.ron"],
        ),
        parts(
            "servo.xlsx",
            &["params check servo.xlsx diagrams/servo.ron", "params import servo.xlsx diagrams/servo.ron"],
        ),
        run("irb2600.urdf", Form::Text, &["import irb2600.urdf --out out/arm"]),
        run("kinds.urdf", Form::Text, &["import kinds.urdf --out out/arm"]),
        run("crane.xml", Form::Text, &["import crane.xml --out out/crane"]),
        run(
            "plugins/libpid.so",
            Form::Binary,
            &["plugin show plugins/libpid.so", "plugin check plugins/libpid.so"],
        ),
        run("home/trusted.json", Form::Text, &["trust", "check diagrams/servo.ron"]),
    ]);
    all
}

/// The kind of a workbook that is damaged inside of its parts.
const PARTS: &str = "parts";

/// Names of kinds besides diagrams and moves.
const KINDS: [&str; 14] = [
    "signals.rec",
    "signals.csv",
    "manifest.json",
    "model.json",
    "events.csv",
    "scene.json",
    "table.csv",
    "book.xlsx",
    "servo.xlsx",
    "irb2600.urdf",
    "kinds.urdf",
    "crane.xml",
    "libpid.so",
    "trusted.json",
];

/// Diagrams, moves and sets of parameters, with the model that reads them.
fn diagrams(root: &Path) -> Vec<Subject> {
    let mut files = Vec::new();
    for folder in ["diagrams", "params"] {
        below(&root.join(folder), &mut files);
    }
    files.sort();
    let relative = files.iter().filter_map(|file| file.strip_prefix(root).ok());
    relative.map(|file| of_diagram(&file.display().to_string())).collect()
}

fn of_diagram(file: &str) -> Subject {
    let top = match file {
        _ if file.contains("/moves/") || file.starts_with("params/") => "diagrams/irb2600/irb2600.ron",
        _ if file.starts_with("diagrams/irb2600/") => "diagrams/irb2600/irb2600.ron",
        _ if file.starts_with("diagrams/scara/") => "diagrams/scara/scara.ron",
        _ if file.starts_with("diagrams/two_link_arm/") => "diagrams/two_link_arm/two_link_arm.ron",
        _ => file,
    };
    let set = match file.contains("/moves/") {
        true => format!(" --set 'move=File(\"{file}\")'"),
        false => String::new(),
    };
    let lines = [
        format!("check {top}{set}"),
        format!("fmt --check {file}"),
        format!("graph {top}{set}"),
        format!("emit schedule {top}{set}"),
        format!("params list {top}"),
        format!("run {top}{set} --until 1ms --no-plugins --quiet --no-plot --out out/run"),
        format!("check {top} --output-format json{set}"),
        format!("check {file} --fix"),
    ];
    let kind = if file.contains("/moves/") { "move" } else { "diagram" };
    subject(kind, file, Form::Text, &lines)
}

fn below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            below(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "ron") {
            files.push(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_diagrams_and_every_other_kind_of_file_are_there() {
        let all = subjects(&crate::root());
        let diagrams = all.iter().filter(|subject| subject.kind == "diagram").count();
        assert!(diagrams > 50, "{diagrams}");
        for kind in KINDS.iter().chain(&["move", PARTS]) {
            assert!(all.iter().any(|subject| subject.kind == *kind), "{kind}");
        }
        assert!(all.iter().all(|subject| subject.kind != "other"));
        assert_eq!(words("a 'b c' d"), ["a", "b c", "d"]);
    }
}
