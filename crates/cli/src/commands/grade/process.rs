//! A command of this program as another process, with a limit of time.

use std::ffi::OsStr;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::running::interrupt;

/// How often a process that runs is looked at.
const LOOK: Duration = Duration::from_millis(10);
/// How long a process that was asked to end may take.
const END: Duration = Duration::from_secs(3);
/// Bytes that are kept of what a process says.
const KEPT: u64 = 16 << 20;

/// What a command has said, and how it ended.
pub struct Said {
    /// Its exit code, unless it was ended by force.
    pub code: Option<i32>,
    /// Whether it took too long.
    pub is_late: bool,
    /// What it said on the standard output.
    out: String,
    /// What it said to people.
    pub err: String,
    /// How long it took.
    pub took: Duration,
}

impl Said {
    /// The objects that it has printed.
    pub fn lines(&self) -> impl Iterator<Item = Value> {
        self.out.lines().filter_map(|line| serde_json::from_str(line).ok())
    }
}

/// Calls this program.
///
/// # Errors
/// If it cannot be started.
pub fn said(words: &[&OsStr], limit: Duration) -> Result<Said, Failure> {
    let unable = |error: std::io::Error| {
        Failure::new(Exit::Files, "grade", format!("the program cannot call itself: {error}"))
    };
    let mut child = Command::new(std::env::current_exe().map_err(unable)?)
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(unable)?;
    let begin = Instant::now();
    let (out, err) = (text(child.stdout.take()), text(child.stderr.take()));
    let (code, is_late) = wait(&mut child, begin, limit).map_err(unable)?;
    let took = begin.elapsed();
    let read = |reader: JoinHandle<String>| reader.join().unwrap_or_default();
    Ok(Said { code, is_late, out: read(out), err: read(err), took })
}

/// Waits for the end, or makes one.
fn wait(child: &mut Child, begin: Instant, limit: Duration) -> std::io::Result<(Option<i32>, bool)> {
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok((status.code(), false));
        }
        if begin.elapsed() > limit || interrupt::is_requested() {
            break;
        }
        std::thread::sleep(LOOK);
    }
    // A run that is asked to end keeps what it has recorded.
    ask(child);
    let asked = Instant::now();
    while asked.elapsed() < END {
        if child.try_wait()?.is_some() {
            return Ok((None, true));
        }
        std::thread::sleep(LOOK);
    }
    child.kill()?;
    child.wait()?;
    Ok((None, true))
}

/// Asks a process to end.
fn ask(child: &Child) {
    #[cfg(unix)]
    let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    #[cfg(not(unix))]
    let _ = child;
}

/// All that a process says, on a thread of its own, so that it never waits for a reader.
fn text(from: Option<impl Read + Send + 'static>) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut from) = from {
            let _ = from.by_ref().take(KEPT).read_to_end(&mut bytes);
            let _ = std::io::copy(&mut from, &mut std::io::sink());
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}
