//! How long an editor waits for the problems of the robot model after a keystroke, with its plug-ins loaded. Goal: at most 30 ms in
//! nine of ten.
//!
//! `cargo bench -p blocksim-cli --bench keystroke` starts the program as an editor does, types into three files and prints median and
//! ninth decile of the time from a change to the problems of that text: on the wall, and what the server has computed meanwhile, which
//! is what an idle computer takes.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Changes that are not counted: files are read and plug-ins loaded for the first time.
const FIRST: usize = 5;
/// Rounds of each kind of change.
const ROUNDS: usize = 60;
/// Pause between two keystrokes of somebody who types fast.
const PAUSE: Duration = Duration::from_millis(60);

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let home = std::env::temp_dir().join(format!("blocksim-keystroke-{}", std::process::id()));
    let trusted = program(&home).arg("trust").arg(&root).stdout(Stdio::null()).status()?;
    // Builds the plug-ins.
    let checked = program(&home)
        .arg("check")
        .arg(root.join("diagrams/irb2600/irb2600.ron"))
        .stdout(Stdio::null())
        .status()?;
    if !(trusted.success() && checked.success()) {
        return Err("the robot model cannot be checked".into());
    }
    let mut editor = Editor::new(&home)?;
    let mut all = Vec::new();
    for (name, file, place, texts) in [
        ("number_of_the_model", "irb2600.ron", "rtol: 5e-4", ["rtol: 6e-4", "rtol: 5e-4"]),
        (
            "number_of_a_part",
            "joint_controller.ron",
            "\"delay\": \"0 s\"",
            ["\"delay\": \"1 s\"", "\"delay\": \"0 s\""],
        ),
        (
            "name_of_a_block",
            "joint_controller.ron",
            "\"command\": Bus",
            ["\"commandx\": Bus", "\"command\": Bus"],
        ),
        ("open_text", "cascade.ron", "Diagram(", ["Diagram((", "Diagram("]),
    ] {
        let path = root.join("diagrams/irb2600").join(file);
        let text = std::fs::read_to_string(&path)?;
        if !text.contains(place) {
            return Err(format!("{file} has no `{place}`").into());
        }
        editor.open(&path, &text)?;
        let mut times = Vec::new();
        for round in 0..FIRST + ROUNDS {
            std::thread::sleep(PAUSE);
            let time = editor.change(&path, &text.replacen(place, texts[round % 2], 1))?;
            if round >= FIRST {
                times.push(time);
            }
        }
        editor.change(&path, &text)?;
        print(name, &times)?;
        all.append(&mut times);
    }
    print("all", &all)?;
    std::fs::remove_dir_all(home)?;
    Ok(())
}

/// How long a change took, and how long the server computed for it, where the system counts that.
#[derive(Debug, Clone, Copy)]
struct Took {
    wall: Duration,
    computed: Option<Duration>,
}

/// Prints medians and ninth deciles for the table of benchmarks.
fn print(name: &str, times: &[Took]) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let walls: Vec<Duration> = times.iter().map(|took| took.wall).collect();
    let computed: Vec<Duration> = times.iter().filter_map(|took| took.computed).collect();
    for (kind, mut times) in [("wall", walls), ("computed", computed)] {
        times.sort();
        for (which, share) in [("median", 0.5), ("p90", 0.9)] {
            let at = (times.len().saturating_sub(1) as f64 * share).round() as usize;
            if let Some(time) = times.get(at) {
                writeln!(out, "time keystroke/{name}/{kind}/{which} {:.2} ms", 1e3 * time.as_secs_f64())?;
            }
        }
    }
    Ok(())
}

/// What all threads of a process have computed; `None` where the system does not count it.
fn computed(process: u32) -> Option<Duration> {
    let tasks = std::fs::read_dir(format!("/proc/{process}/task")).ok()?.flatten();
    // Nanoseconds on a processor, those spent waiting for one, and how often.
    let one = |task: std::fs::DirEntry| -> Option<u64> {
        std::fs::read_to_string(task.path().join("schedstat")).ok()?.split(' ').next()?.parse().ok()
    };
    Some(Duration::from_nanos(tasks.filter_map(one).sum()))
}

/// The program, with settings of its own.
fn program(home: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_blocksim"));
    command.env("BLOCKSIM_HOME", home);
    command
}

/// An editor as the server sees it.
struct Editor {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    version: i32,
}

impl Editor {
    fn new(home: &Path) -> Result<Editor> {
        let mut server = program(home).arg("lsp").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let (Some(to), Some(from)) = (server.stdin.take(), server.stdout.take()) else {
            return Err("the server has no pipes".into());
        };
        let mut editor = Editor { server, to, from: BufReader::new(from), version: 1 };
        editor.send(
            &json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": { "capabilities": {} } }),
        )?;
        while editor.next()?["id"] != 1 {}
        editor.say("initialized", &json!({}))?;
        Ok(editor)
    }

    fn open(&mut self, path: &Path, text: &str) -> Result<()> {
        self.version += 1;
        let item = json!({ "uri": uri(path), "languageId": "ron", "version": self.version, "text": text });
        self.say("textDocument/didOpen", &json!({ "textDocument": item }))?;
        self.wait(path)
    }

    /// Gives a file another text; how long its problems took.
    fn change(&mut self, path: &Path, text: &str) -> Result<Took> {
        self.version += 1;
        let (began, before) = (Instant::now(), computed(self.server.id()));
        let file = json!({ "uri": uri(path), "version": self.version });
        self.say(
            "textDocument/didChange",
            &json!({ "textDocument": file, "contentChanges": [{ "text": text }] }),
        )?;
        self.wait(path)?;
        let wall = began.elapsed();
        let computed = computed(self.server.id()).zip(before).map(|(now, before)| now.saturating_sub(before));
        Ok(Took { wall, computed })
    }

    /// Waits for the problems of a file in its latest version.
    fn wait(&mut self, path: &Path) -> Result<()> {
        loop {
            let message = self.next()?;
            let params = &message["params"];
            if message["method"] == "textDocument/publishDiagnostics"
                && params["uri"] == uri(path)
                && params["version"] == self.version
            {
                return Ok(());
            }
        }
    }

    fn say(&mut self, method: &str, params: &Value) -> Result<()> {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }))
    }

    fn send(&mut self, message: &Value) -> Result<()> {
        let text = message.to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        Ok(self.to.flush()?)
    }

    /// The next message of the server.
    fn next(&mut self) -> Result<Value> {
        let mut length = 0;
        loop {
            let mut line = String::new();
            if self.from.read_line(&mut line)? == 0 {
                return Err("the server ended".into());
            }
            match line.trim().split_once(": ") {
                Some(("Content-Length", number)) => length = number.parse()?,
                Some(_) => {}
                None => break,
            }
        }
        let mut bytes = vec![0; length];
        self.from.read_exact(&mut bytes)?;
        Ok(serde_json::from_slice(&bytes)?)
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.display())
}
