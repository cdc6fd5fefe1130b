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

/// Commands that make what is damaged besides the files of the project, in a folder like it; `ROOT` is the project. Each is for the
/// kinds that are named with it, or for all.
pub const PREPARATION: [(&[&str], &str); 19] = [
    (&[], "trust ."),
    (&[], "run diagrams/servo.ron --out run --quiet --no-plot --csv --until 0.2s"),
    (&[], "run diagrams/scara/scara.ron --out moving --quiet --no-plot --no-csv --until 0.05s"),
    (&[], "params export params/irb2600.ron --out book.xlsx"),
    (&[], "params export diagrams/servo.ron --out servo.xlsx"),
    (&[], "export run --csv table.csv"),
    (&[], "export run --csv same.csv"),
    (&["mesh of a run"], "import rods.urdf --out rods"),
    (&["mesh of a run"], "run rods/rods.ron --out meshed --quiet --no-plot --until 0.01s"),
    (&["imported"], "import kinds.urdf --out arm"),
    (&["log.csv"], "run diagrams/irb2600/irb2600.ron --set drive=torque --out log --quiet --no-plot"),
    (&["log.csv"], "export log --csv log.csv --every 50ms"),
    (&["C source", "plugin.toml", "stamp"], "plugin new law --language c"),
    (&["C source", "plugin.toml", "stamp"], "plugin show law"),
    (&["crate source", "Cargo.toml", "stamp of a crate"], "plugin new unit --blocksim ROOT"),
    (&["crate source", "Cargo.toml", "stamp of a crate"], "plugin show unit"),
    // Sources that were written just before get no stamp at first.
    (&["stamp"], "plugin show law"),
    (&["stamp of a crate"], "plugin show unit"),
    // What it offers is remembered, and it is trusted no more.
    (&["offer"], "run strange/model.ron --out strange/run --quiet --no-plot"),
];

/// All subjects; `root` is the folder of the project.
pub fn subjects(root: &Path) -> Vec<Subject> {
    let mut all = diagrams(root);
    for (kind, file, form, lines) in OTHERS {
        let lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        all.push(subject(kind, *file, *form, &lines));
    }
    all
}

/// Kinds whose commands start cargo, which takes a second for each.
pub const SLOW: [&str; 3] = ["crate source", "Cargo.toml", "stamp of a crate"];

const REPORT: &str = "report run --out out/page.html --yes";
const OF_RUN: &[&str] = &[REPORT, "plot run", "export run --csv out/t.csv", "compare run same.csv"];
const OF_SCENE: &[&str] = &["report moving --out out/page.html --yes", "collisions moving", "plot moving"];
const OF_BOOK: &[&str] =
    &["params check book.xlsx params/irb2600.ron", "params import book.xlsx params/irb2600.ron"];
const OF_SERVO: &[&str] =
    &["params check servo.xlsx diagrams/servo.ron", "params import servo.xlsx diagrams/servo.ron"];
const OF_MODULE: &[&str] = &[
    "plugin show law.wasm",
    "plugin check law.wasm",
    "check boxed.ron",
    "run boxed.ron --out out/run --quiet --no-plot",
];

/// Everything but diagrams and moves: kind, file, form, commands. A `*` stands for the rest of the only name that begins so; a last
/// word `<FILE` is what the command reads from its input, and `<<FILE` the same as messages, one of each line.
const OTHERS: &[(&str, &str, Form, &[&str])] = &[
    // Runs.
    ("signals.rec", "run/signals.rec", Form::Binary, OF_RUN),
    ("signals.rec", "moving/signals.rec", Form::Binary, OF_SCENE),
    (
        "signals.csv",
        "run/signals.csv",
        Form::Text,
        &["plot run/signals.csv", "compare run/signals.csv same.csv"],
    ),
    ("manifest.json", "run/manifest.json", Form::Text, &[REPORT, "plot run", "runs ."]),
    ("model.json", "run/model.json", Form::Text, &[REPORT]),
    ("model.json", "moving/model.json", Form::Text, OF_SCENE),
    ("log.txt", "run/log.txt", Form::Text, &[REPORT]),
    ("events.csv", "run/events.csv", Form::Text, &[REPORT, "plot run"]),
    ("scene.json", "moving/scene.json", Form::Text, OF_SCENE),
    (
        "mesh of a run",
        "meshed/mesh-*",
        Form::Text,
        &["report meshed --out out/page.html --yes", "collisions meshed"],
    ),
    // Tables of others.
    (
        "table.csv",
        "table.csv",
        Form::Text,
        &[
            "plot table.csv",
            "compare table.csv same.csv",
            "report run --overlay table.csv --out out/page.html --yes",
        ],
    ),
    (
        "names of columns",
        "names.txt",
        Form::Text,
        &["plot table.csv --map names.txt", "compare run table.csv --map names.txt"],
    ),
    (
        "log.csv",
        "log.csv",
        Form::Text,
        &["identify dynamics --from log.csv --json", "identify friction --from log.csv --json"],
    ),
    // Parameters.
    ("workbook", "book.xlsx", Form::Binary, OF_BOOK),
    ("workbook", "servo.xlsx", Form::Binary, OF_SERVO),
    ("parts", "book.xlsx", Form::Parts, OF_BOOK),
    ("parts", "servo.xlsx", Form::Parts, OF_SERVO),
    (
        "sheets",
        "params/irb2600.sheets.ron",
        Form::Text,
        &[
            "params export params/irb2600.ron --out out/book.xlsx",
            "params check book.xlsx params/irb2600.ron",
        ],
    ),
    (
        "set",
        "params/irb2600.ron",
        Form::Text,
        &[
            "params export params/irb2600.ron --out out/book.xlsx",
            "params check book.xlsx params/irb2600.ron",
            "params diff params/irb2600.ron same.ron",
        ],
    ),
    // Mechanisms of others.
    ("URDF", "irb2600.urdf", Form::Text, &["import irb2600.urdf --out out/arm"]),
    ("URDF", "kinds.urdf", Form::Text, &["import kinds.urdf --out out/arm"]),
    ("Simscape", "crane.xml", Form::Text, &["import crane.xml --out out/crane"]),
    (
        "smiData",
        "crane_DataFile.m",
        Form::Text,
        &[
            "import crane.xml --data crane_DataFile.m --out out/crane",
            "import crane_DataFile.m --as smidata --out out/crane",
        ],
    ),
    (
        "mesh",
        "rod.stl",
        Form::Text,
        &["import rods.urdf --out out/rods", "import weightless.urdf --density 2700 --out out/rods"],
    ),
    ("mesh", "block.stl", Form::Binary, &["import block.urdf --density 2700 --out out/block"]),
    (
        "imported",
        "arm/kinds_parameters.ron",
        Form::Text,
        &["import kinds.urdf --out arm --yes", "check arm/kinds.ron"],
    ),
    ("imported", "arm/kinds.ron", Form::Text, &["import kinds.urdf --out arm", "check arm/kinds.ron"]),
    // Robots and what stands around them.
    (
        "robot",
        "diagrams/scara/manipulator.ron",
        Form::Text,
        &[
            "plan joint --robot diagrams/scara/manipulator.ron --to '0 deg,10 deg,-20 mm,30 deg' --out out/move.ron",
            "plan linear --robot diagrams/scara/manipulator.ron --from '20 deg,60 deg,-20 mm,45 deg' --to 380,415,50",
            "plan sequence diagrams/scara/pick.ron --robot diagrams/scara/manipulator.ron",
        ],
    ),
    (
        "surroundings",
        "diagrams/scara/cell.ron",
        Form::Text,
        &[
            "collisions moving --surroundings diagrams/scara/cell.ron",
            "report moving --surroundings diagrams/scara/cell.ron --out out/page.html --yes",
        ],
    ),
    (
        "sequence",
        "diagrams/scara/pick.ron",
        Form::Text,
        &["plan sequence diagrams/scara/pick.ron --robot diagrams/scara/manipulator.ron"],
    ),
    // Plug-ins.
    (
        "library",
        "plugins/libpid.so",
        Form::Binary,
        &["plugin show plugins/libpid.so", "plugin check plugins/libpid.so"],
    ),
    ("module", "law.wasm", Form::Binary, OF_MODULE),
    ("plugin.toml", "settings/plugin.toml", Form::Text, &["plugin show settings"]),
    ("C source", "law/controller.c", Form::Text, &["plugin show law"]),
    ("stamp", "law/target/blocksim/liblaw.blocksim", Form::Text, &["plugin show law"]),
    ("crate source", "unit/src/lib.rs", Form::Text, &["plugin show unit"]),
    ("Cargo.toml", "unit/Cargo.toml", Form::Text, &["plugin show unit", "doctor"]),
    ("stamp of a crate", "unit/target/release/libunit.blocksim", Form::Text, &["plugin show unit"]),
    ("stamp of a crate", "unit/target/release/libunit.d", Form::Text, &["plugin show unit"]),
    // What the program keeps.
    (
        "trusted.json",
        "home/trusted.json",
        Form::Text,
        &["trust", "check diagrams/servo.ron", "plugin show plugins/libpid.so"],
    ),
    (
        "offer",
        "home/plugins/*",
        Form::Text,
        &["check strange/model.ron --no-plugins", "graph strange/model.ron --no-plugins"],
    ),
    // Editors.
    ("message", "session.txt", Form::Text, &["lsp <session.txt"]),
    ("message", "session.jsonl", Form::Text, &["lsp <<session.jsonl"]),
    ("text", "diagrams/servo.ron", Form::Text, &["fmt --stdin <diagrams/servo.ron"]),
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
        let kinds: std::collections::BTreeSet<&str> = all.iter().map(|subject| subject.kind).collect();
        assert!(kinds.len() > 30 && kinds.contains("move"), "{kinds:?}");
        let prepared = PREPARATION.iter().flat_map(|(kinds, _)| kinds.iter()).chain(&SLOW);
        assert!(prepared.clone().all(|kind| kinds.contains(kind)));
        assert_eq!(words("a 'b c' d"), ["a", "b c", "d"]);
    }
}
