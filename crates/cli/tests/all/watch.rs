//! `--watch` as users call it.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use crate::support::program;

const TOP: &str = r#"Diagram(
    parameters: { "numbers": File("numbers.ron") },
    simulation: (stop_time: "1 s"),
    blocks: { "demand": Step(time: "0.1 s", after: "numbers.after"), "scope": Scope(inputs: ["set"]) },
    connections: ["demand.y -> scope.set"],
)
"#;

/// A program that watches, and the lines that it has said.
struct Watching {
    folder: PathBuf,
    child: Child,
    lines: Receiver<String>,
}

impl Watching {
    fn new(name: &str, words: &[&str]) -> Watching {
        let folder = std::env::temp_dir().join(format!("blocksim-watching-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("top.ron"), TOP).expect("a model");
        std::fs::write(folder.join("numbers.ron"), "(after: 1.0)").expect("parameters");
        let mut command = program();
        command.args(words).current_dir(&folder).env("NO_COLOR", "1");
        let mut child =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program runs");
        let (send, lines) = channel();
        let (out, err) = (child.stdout.take().expect("a pipe"), child.stderr.take().expect("a pipe"));
        let other = send.clone();
        std::thread::spawn(move || {
            BufReader::new(out).lines().map_while(Result::ok).try_for_each(|l| send.send(l))
        });
        std::thread::spawn(move || {
            BufReader::new(err).lines().map_while(Result::ok).try_for_each(|l| other.send(l))
        });
        Watching { folder, child, lines }
    }

    /// Waits until all parts have been said, in any order.
    fn says(&self, parts: &[&str]) {
        let mut missing: Vec<&str> = parts.to_vec();
        let mut said = Vec::new();
        while !missing.is_empty() {
            let line = self.lines.recv_timeout(Duration::from_secs(120));
            let line = line.unwrap_or_else(|_| panic!("{missing:?} is missing in {said:?}"));
            missing.retain(|part| !line.contains(part));
            said.push(line);
        }
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.folder.join(name), text).expect("a file");
    }

    fn ends(mut self) -> Option<i32> {
        Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().expect("kill runs");
        self.child.wait().expect("an end").code()
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

const WAITING: &str = "waiting for changes of 2 files";

#[test]
fn a_model_is_checked_again_when_a_file_that_it_reads_changes() {
    let watching = Watching::new("check", &["check", "top.ron", "--watch"]);
    watching.says(&["no problems", WAITING]);
    watching.write("numbers.ron", "(before: 1.0)");
    watching.says(&["numbers.ron has changed", "error[", WAITING]);
    // Also a file that is away for a moment, as editors do it.
    std::fs::remove_file(watching.folder.join("numbers.ron")).expect("a file");
    std::thread::sleep(Duration::from_millis(500));
    watching.write("numbers.ron", "(after: 2.0)");
    watching.says(&["numbers.ron has changed", "no problems", WAITING]);
    assert_eq!(watching.ends(), Some(0));
}

#[test]
fn each_run_after_a_change_has_a_folder_of_its_own() {
    let watching = Watching::new("run", &["run", "top.ron", "--watch", "--no-plot"]);
    watching.says(&["simulated", WAITING]);
    watching.write("top.ron", &TOP.replace("1 s\")", "2 s\")"));
    watching.says(&["top.ron has changed", "simulated  2.000 s", WAITING]);
    let kept = std::fs::read_dir(watching.folder.join("runs")).expect("runs").count();
    assert_eq!((kept, watching.ends()), (2, Some(0)));
}
