//! Every command that the README and the guides print runs as it is printed, in the order of the page.
//!
//! A page begins in a folder like that of the project, with what the page takes for granted ([`SETUP`]). The rules by which
//! lines are shortened are [`SHORTER`]; what is left out, and why, is [`LEFT_OUT`]. Tutorials and pages of errors have tests of
//! their own, which also compare the answers.

use std::fs;
use std::path::Path;

use crate::support::pages::{fences, folder_of_project};
use crate::support::{in_shell, root};

/// What a page takes for granted: commands of a shell in the folder of the project.
const SETUP: &[(&str, &[&str])] = &[
    ("docs/drawing.md", &["blocksim trust ."]),
    (
        "docs/import.md",
        &[
            "cp \"$PROJECT/tests/data/irb2600.urdf\" arm.urdf",
            "cp \"$PROJECT/tests/data/crane.xml\" robot.xml",
        ],
    ),
    ("docs/language.md", &["cp diagrams/servo.ron model.ron", "cp diagrams/dc_motor.ron ."]),
    ("docs/operation.md", &["blocksim run diagrams/irb2600/irb2600.ron --until 0.1s --quiet"]),
    (
        "docs/plots.md",
        &[
            "blocksim run diagrams/servo.ron --out runs/before --quiet",
            "blocksim run diagrams/servo.ron --set pid.kp=9 --out runs/after --quiet",
            "blocksim run diagrams/irb2600/irb2600.ron --until 1s --quiet",
            "printf 'time,elbow [deg]\\n0,0\\n0.5,1\\n1,2\\n' > measured.csv",
            "printf 'elbow=control/joint1/scope.actual\\n' > names.map",
        ],
    ),
    ("docs/plugins.md", &["cp diagrams/servo.ron lab.ron", "cp diagrams/dc_motor.ron .", "mkdir lab"]),
    (
        "docs/recordings.md",
        &[
            "blocksim run diagrams/servo.ron --out servo --quiet",
            "blocksim run diagrams/irb2600/irb2600.ron --until 0.1s --quiet",
        ],
    ),
    (
        "docs/report.md",
        &[
            "blocksim run diagrams/servo.ron --out runs/before --quiet",
            "blocksim run diagrams/servo.ron --set pid.kp=9 --out runs/after --quiet",
            "blocksim run diagrams/servo.ron --quiet",
            "cp diagrams/servo.ron diagrams/dc_motor.ron .",
            "printf 'time,angle [deg]\\n0,0\\n1,90\\n' > measured.csv",
        ],
    ),
    ("docs/sweep.md", &["cp diagrams/servo.ron diagrams/dc_motor.ron ."]),
];

/// Commands that end with another exit code than 0 or an error that the page shows, by a piece of the line, and why.
const EXITS: &[(&str, i32, &str)] = &[
    ("--surroundings diagrams/scara/cell.ron", 1, "the gripper touches what it picks"),
    ("1250, -350, 680", 1, "the move hits the workpiece"),
];

/// Pieces of lines that are replaced, so that the test ends soon. All else is typed as it is printed.
const SHORTER: &[(&str, &str)] = &[
    // The experiments of one axis, and not of all six.
    ("identify friction          ", "identify friction --axis 2 "),
    ("identify friction --drive dc", "identify friction --axis 2 --drive dc"),
    // Switched bridges run a hundred times slower than averaged ones.
    ("--set drive=asm_link", "--set drive=asm_link --until 0.05s"),
    // The page is about a folder of its own; here the files are those of the project.
    (" irb2600.ron", " diagrams/irb2600/irb2600.ron"),
    ("File(\"moves/", "File(\"diagrams/irb2600/moves/"),
    // The home of whoever runs the tests is left alone.
    ("~/lab", "lab"),
];

/// Commands that are not typed, by a piece of the line, and why.
const LEFT_OUT: &[(&str, &str)] = &[
    ("--watch", "runs until a person ends it"),
    ("blocksim studio", "serves until a person ends it"),
    ("--open", "opens a browser"),
    ("blocksim grade", "the folders of the class are those of the reader; its own tests grade one"),
    ("robot_DataFile.m", "the data file is written by a CAD program"),
    ("arm.ron --from log.csv", "the model and the log are those of the reader"),
    ("lag.ron", "the file stands on the page; a test of `fmt` compares it"),
    ("slips.ron", "the file stands on the page; a test of `check --fix` compares it"),
];

/// A line of a page, and the exit codes that are right.
struct Typed {
    line: String,
    codes: Vec<i32>,
}

/// The lines of a page that are typed.
fn typed(page: &str) -> Vec<Typed> {
    let fences = fences(page);
    let mut lines = Vec::new();
    for (at, fence) in fences.iter().enumerate() {
        if fence.file.is_some() || !matches!(fence.language, "sh" | "text" | "") {
            continue;
        }
        let answer = fences.get(at + 1).filter(|next| next.follows && next.language == "text");
        let fails = answer.is_some_and(|answer| answer.text.contains("error["));
        let text = fence.text.replace("\\\n", " ").replace("$blocksim ", "blocksim ");
        for line in text.lines().filter(|line| line.starts_with("blocksim ")) {
            // In a list of commands a gap separates what one does.
            let line = match fence.language {
                "sh" => line,
                _ => line.split("   ").next().unwrap_or_default(),
            };
            let other = EXITS.iter().find(|(piece, ..)| line.contains(piece));
            let codes: Vec<i32> = match fails {
                _ if other.is_some() => other.iter().map(|(_, code, _)| *code).collect(),
                // Two recordings may differ.
                _ if line.starts_with("blocksim compare ") => vec![0, 1],
                true => vec![1, 3],
                false => vec![0],
            };
            lines.push(Typed { line: line.to_owned(), codes });
        }
    }
    lines
}

/// A line as it is typed; `None` where it is left out.
fn shortened(line: &str) -> Option<String> {
    if LEFT_OUT.iter().any(|(piece, _)| line.contains(piece)) {
        return None;
    }
    let line = line.split(" | jq").next().unwrap_or_default().to_owned();
    Some(SHORTER.iter().fold(line, |line, (long, short)| line.replace(long, short)))
}

/// Types the commands of a page; returns how many there were, and what went wrong.
fn follow(name: &str) -> (usize, Vec<String>) {
    let page = fs::read_to_string(root().join(name)).expect("a page");
    let lines = typed(&page);
    if lines.is_empty() {
        return (0, Vec::new());
    }
    let folder = folder_of_project(&format!("printed-{}", name.replace('/', "-")));
    let mut faults = Vec::new();
    let setup = SETUP.iter().find(|(page, _)| *page == name).map_or(&[][..], |(_, lines)| lines);
    for line in setup {
        let project = root().canonicalize().expect("the project").display().to_string();
        let output = in_shell(&line.replace("$PROJECT", &project), &folder);
        assert!(output.status.success(), "{name}: {line}\n{}", both(&output));
    }
    for Typed { line, codes } in &lines {
        let Some(command) = shortened(line) else { continue };
        let output = in_shell(&command, &folder);
        let code = output.status.code().unwrap_or(-1);
        if !codes.contains(&code) {
            faults.push(format!("{name}: {line}\nends with {code}, not {codes:?}:\n{}", both(&output)));
        }
    }
    fs::remove_dir_all(&folder).expect("to tidy up");
    (lines.len(), faults)
}

fn both(output: &std::process::Output) -> String {
    let text = [&output.stdout, &output.stderr].map(|part| String::from_utf8_lossy(part).into_owned());
    text.concat().lines().take(30).map(|line| format!("    {line}\n")).collect()
}

/// The pages, the README first.
fn pages() -> Vec<String> {
    let names = fs::read_dir(root().join("docs")).expect("the guides");
    let names = names.map(|entry| entry.expect("an entry").path()).filter(|path| is_page(path));
    let mut names: Vec<String> = names
        .map(|path| format!("docs/{}", path.file_name().unwrap_or_default().to_string_lossy()))
        .collect();
    names.sort();
    names.insert(0, "README.md".to_owned());
    names
}

fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "md")
}

/// Follows every second page, as two tests at a time run on most computers.
fn follow_half(half: usize, least: usize) {
    let (mut count, mut faults) = (0, Vec::new());
    for page in pages().iter().skip(half).step_by(2) {
        let (typed, wrong) = follow(page);
        count += typed;
        faults.extend(wrong);
    }
    assert!(faults.is_empty(), "{} of {count} commands:\n{}", faults.len(), faults.join("\n"));
    assert!(count >= least, "only {count} commands were found");
}

#[test]
fn printed_commands_run_on_the_pages_of_even_number() {
    follow_half(0, 40);
}

#[test]
fn printed_commands_run_on_the_pages_of_odd_number() {
    follow_half(1, 40);
}

/// What the tables name is printed somewhere; nothing is left of lines that are gone.
#[test]
fn exceptions_are_about_lines_that_exist() {
    let all: Vec<String> = pages()
        .iter()
        .flat_map(|name| typed(&fs::read_to_string(root().join(name)).expect("a page")))
        .map(|typed| typed.line)
        .collect();
    let exits = EXITS.iter().map(|(piece, ..)| *piece);
    for piece in LEFT_OUT.iter().chain(SHORTER).map(|(piece, _)| *piece).chain(exits) {
        assert!(all.iter().any(|line| line.contains(piece)), "no line has `{piece}`");
    }
    for (page, _) in SETUP {
        assert!(pages().contains(&(*page).to_owned()), "there is no page {page}");
    }
}
