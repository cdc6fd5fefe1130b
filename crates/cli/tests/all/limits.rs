//! Files that would fill the memory, wait for ever or overflow the stack, and names that act on a terminal, are answered in words.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::program;

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("blocksim-limits-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    fn call(&self, words: &[&str]) -> Output {
        program().args(words).current_dir(&self.0).env("NO_COLOR", "1").output().unwrap()
    }

    /// What a command says on both outputs; it ends with this code.
    fn says(&self, words: &[&str], code: i32) -> String {
        let output = self.call(words);
        let said =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{words:?}: {said}");
        said
    }

    /// The first line of what `check` says of a model with this block.
    fn of_block(&self, block: &str) -> String {
        let text = format!(
            "Diagram(\n    blocks: {{ \"one\": Constant(value: [1, 2]), \"b\": {block}, \"t\": Terminator }},\n    \
             connections: [\"one.y -> b.u\", \"b.y -> t.u\"],\n)\n"
        );
        self.write("block.ron", &text);
        self.says(&["check", "block.ron"], 3).lines().next().unwrap_or_default().to_owned()
    }
}

#[test]
fn numbers_of_ports_and_memories_are_limited() {
    let folder = Folder::new("blocks");
    for (block, expected) in [
        ("Mux(inputs: 1000000000000000)", "`inputs` is 1000000000000000, but must be from 1 to 10000"),
        ("Demux(outputs: 1000000000000000)", "`outputs` is 1000000000000000, but must be from 1 to 10000"),
        ("Product(inputs: 1000000000000000)", "`inputs` is 1000000000000000, but must be from 1 to 10000"),
        (
            "MinMax(function: Max, inputs: 1000000000000000)",
            "`inputs` is 1000000000000000, but must be from 1 to 10000",
        ),
        (
            "Logic(operator: And, inputs: 1000000000000000)",
            "`inputs` is 1000000000000000, but must be from 1 to 10000",
        ),
        (
            "TransportDelay(delay: \"1 s\", buffer: 1000000000000000)",
            "`buffer` is 1000000000000000, but must be from 16 to 500000",
        ),
        (
            "Delay(steps: 1000000000000000, ts: \"1 ms\")",
            "`steps` is 1000000000000000, but must be from 1 to 1000000",
        ),
    ] {
        assert_eq!(folder.of_block(block), format!("error[parameter]: {expected}"), "{block}");
    }
    folder.write(
        "long.ron",
        "Diagram(blocks: { \"one\": Constant(value: [1, 2, 3, 4, 5, 6]), \"b\": TransportDelay(delay: \"1 s\", buffer: 500000), \
         \"t\": Terminator }, connections: [\"one.y -> b.u\", \"b.y -> t.u\"])",
    );
    let said = folder.says(&["check", "long.ron"], 3);
    assert!(said.contains("error[too_large]") && said.contains("500000 steps of 6 elements"), "{said}");
}

#[test]
fn diagrams_inside_each_other_are_limited() {
    let folder = Folder::new("nested");
    // Each of these is a few lines; together they would be 10^12 blocks.
    for level in 0..12 {
        let blocks: Vec<String> =
            (0..10).map(|n| format!("\"b{n}\": Subsystem(file: \"wide{}.ron\")", level + 1)).collect();
        folder.write(&format!("wide{level}.ron"), &format!("Diagram(blocks: {{ {} }})", blocks.join(", ")));
    }
    folder.write("wide12.ron", "Diagram(blocks: { \"c\": Constant(value: 1) })");
    let said = folder.says(&["check", "wide0.ron"], 3);
    assert!(said.contains("error[too_large]: this model has more than 100000 blocks"), "{said}");
    assert_eq!(said.matches("error[").count(), 1, "{said}");

    for level in 0..3000 {
        let text = format!("Diagram(blocks: {{ \"b\": Subsystem(file: \"deep{}.ron\") }})", level + 1);
        folder.write(&format!("deep{level}.ron"), &text);
    }
    folder.write("deep3000.ron", "Diagram(blocks: { \"c\": Constant(value: 1) })");
    let said = folder.says(&["check", "deep0.ron"], 3);
    assert!(said.contains("error[too_large]: more than 64 diagrams are inside each other here"), "{said}");
}

#[test]
fn brackets_and_lists_are_limited() {
    let folder = Folder::new("texts");
    let many = 100_000;
    folder.write(
        "deep.ron",
        &format!("Diagram(blocks: {{}}, title: {}1{})", "[".repeat(many), "]".repeat(many)),
    );
    for command in ["check", "fmt", "graph"] {
        let said = folder.says(&[command, "deep.ron"], 3);
        assert!(said.contains("there are more than 128 brackets inside each other"), "{command}: {said}");
    }
    let items = "1,".repeat(1_000_001);
    folder.write("long.ron", &format!("Diagram(blocks: {{ \"c\": Constant(value: [{items}]) }})"));
    let said = folder.says(&["check", "long.ron"], 3);
    assert!(said.contains("this list has 1000001 elements, more than 1000000"), "{said}");
}

#[test]
fn settings_beyond_reason_are_refused() {
    let folder = Folder::new("settings");
    for (settings, expected) in [
        ("stop_time: \"1 s\", solver: Ode45(rtol: 10)", "`rtol` is 1e1, but must be between 1e-14 and 1e-1"),
        ("stop_time: \"1e300 s\"", "the stop time of 1e300 s is beyond the clock"),
    ] {
        folder.write(
            "s.ron",
            &format!("Diagram(simulation: ({settings}), blocks: {{ \"c\": Constant(value: 1) }})"),
        );
        let said = folder.says(&["check", "s.ron"], 3);
        assert!(said.contains(expected), "{said}");
    }
    folder.write("s.ron", "Diagram(simulation: (stop_time: \"1 s\"), blocks: { \"c\": Constant(value: 1) })");
    let said = folder.says(&["run", "s.ron", "--until", "1e300"], 1);
    assert!(said.contains("beyond the clock"), "{said}");
    let said = folder.says(&["run", "s.ron", "--rtol", "10"], 2);
    assert!(said.contains("1e-14"), "{said}");
}

#[test]
fn only_regular_files_are_read() {
    let folder = Folder::new("devices");
    assert!(Command::new("mkfifo").arg(folder.0.join("pipe.ron")).status().unwrap().success());
    for file in ["/dev/zero", "pipe.ron"] {
        for command in [&["check"][..], &["graph"], &["fmt"], &["run"], &["emit", "ast"], &["params", "list"]]
        {
            let words = [command, &[file]].concat();
            let said = folder.says(&words, 4);
            assert!(said.contains("it is a device or a pipe, not a regular file"), "{words:?}: {said}");
        }
    }
    // Files that a model names, and those of a run.
    folder.write("part.ron", "Diagram(blocks: { \"b\": Subsystem(file: \"pipe.ron\") })");
    assert!(folder.says(&["check", "part.ron"], 3).contains("not a regular file"));
    folder.write("s.ron", "Diagram(simulation: (stop_time: \"1 s\"), blocks: { \"c\": Constant(value: 1), \"s\": Scope }, connections: [\"c.y -> s.u\"])");
    folder.says(&["run", "s.ron", "--out", "given", "--quiet"], 0);
    let zero = |name: &str| {
        let path: &Path = &folder.0.join("given").join(name);
        let _ = fs::remove_file(path);
        std::os::unix::fs::symlink("/dev/zero", path).unwrap();
    };
    zero("model.json");
    zero("scene.json");
    zero("log.txt");
    folder.says(&["report", "given", "--out", "page.html"], 0);
    // Without the recording the table is taken.
    zero("signals.rec");
    folder.says(&["report", "given", "--out", "other.html"], 0);
    zero("signals.csv");
    folder.says(&["report", "given", "--out", "none.html"], 4);
    zero("manifest.json");
    folder.says(&["plot", "given"], 4);
    let said = folder.says(&["plot", "/dev/zero"], 4);
    assert!(
        said.contains("name a recording, a table or the folder of a run") && !said.contains("--out"),
        "{said}"
    );
}

#[test]
fn names_of_strangers_do_not_act_on_the_terminal() {
    let folder = Folder::new("names");
    // Clears the screen, sets the title of the window, hides what follows, and turns the order of signs round.
    let evil = "\\u{1b}[2J\\u{1b}]0;owned\\u{7}\\u{1b}[8m\\u{202e}gnp";
    folder.write(
        "evil.ron",
        &format!(
            "Diagram(title: \"T{evil}\", simulation: (stop_time: \"1 s\"), blocks: {{ \"c\": Constant(value: 1), \
             \"s\": Scope(label: \"L{evil}\") }}, connections: [\"c.y -> s.u\"])"
        ),
    );
    folder.write("wrong.ron", &format!("Diagram(blocks: {{ \"a{evil}\": Gain{evil}, }})"));
    let raw = evil.replace("\\u{1b}", "\x1b").replace("\\u{7}", "\x07").replace("\\u{202e}", "\u{202e}");
    folder.write("raw.ron", &format!("Diagram(blocks: {{ \"a{raw}\": Gain(k{raw}: 1), }})"));
    folder.write(&format!("file{raw}.ron"), "Diagram(");
    let file = format!("file{raw}.ron");
    for words in [
        &["run", "evil.ron", "--out", "given"][..],
        &["check", "evil.ron"],
        &["emit", "model", "evil.ron"],
        &["graph", "evil.ron"],
        &["params", "list", "evil.ron", "--all"],
        &["plot", "given"],
        &["compare", "given", "given"],
        &["runs"],
        &["check", "wrong.ron"],
        &["check", "raw.ron"],
        &["check", "raw.ron", "--output-format", "short"],
        &["check", &file],
        &["check", &format!("no{file}")],
        &["fmt", &file],
        &["trust", &format!("no{file}")],
    ] {
        let output = folder.call(words);
        let said =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(!said.is_empty(), "{words:?}");
        let acts = said.chars().find(|c| (c.is_control() && !"\n\t".contains(*c)) || *c == '\u{202e}');
        assert_eq!(acts, None, "{words:?}: {said:?}");
    }
}
