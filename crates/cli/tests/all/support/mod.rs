//! What tests of the program share.

pub mod pages;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The program, with settings of its own: nothing is read from or written to the home of whoever runs the tests.
pub fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_blocksim"));
    command.env("BLOCKSIM_HOME", home());
    command
}

/// The folder of settings that all tests share; the project is trusted there.
pub fn home() -> &'static Path {
    static HOME: OnceLock<PathBuf> = OnceLock::new();
    HOME.get_or_init(|| {
        let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("home-{}", std::process::id()));
        let project = root().canonicalize().expect("the project");
        let list = serde_json::json!({ "v": 1, "trusted": [project] });
        std::fs::create_dir_all(&home).expect("a folder");
        std::fs::write(home.join("trusted.json"), list.to_string()).expect("a list");
        home
    })
}

/// The folder of the project.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Commands of a page of the manual with the answers that stand right below them.
pub fn commands_of(page: &str) -> Vec<(String, String)> {
    let page = std::fs::read_to_string(root().join("docs").join(page)).expect("the page");
    // Prose and fences in turn.
    let parts: Vec<&str> = page.split("```").collect();
    let mut shown = Vec::new();
    for at in (1..parts.len()).step_by(2) {
        let below = parts.get(at + 1).filter(|prose| prose.trim().is_empty()).and_then(|_| parts.get(at + 2));
        let answer = below.and_then(|next| next.strip_prefix("text\n"));
        if let (Some(command), Some(answer)) = (parts[at].strip_prefix("sh\n"), answer) {
            shown.push((command.trim().to_owned(), answer.to_owned()));
        }
    }
    shown
}

/// The arguments of a command: words, and what stands between quotes.
pub fn arguments(command: &str) -> Vec<String> {
    let (mut words, mut quoted) = (vec![String::new()], false);
    for sign in command.replace("\\\n", " ").chars() {
        match sign {
            '"' => quoted = !quoted,
            _ if sign.is_whitespace() && !quoted => words.push(String::new()),
            _ => words.last_mut().expect("one word").push(sign),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// What a shell that finds our program first answers to a line in a folder, with settings of its own there.
pub fn in_shell(line: &str, folder: &Path) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_blocksim"));
    let found = program.parent().expect("a folder").display().to_string();
    let path = format!("{found}:{}", std::env::var("PATH").unwrap_or_default());
    Command::new("sh")
        .args(["-c", line])
        .current_dir(folder)
        .env("PATH", path)
        .env("BLOCKSIM_HOME", folder.join(".blocksim"))
        .output()
        .expect("a shell")
}
