//! A command of this program as another process, with a limit of time.

use std::ffi::OsStr;
use std::io::{ErrorKind, Read};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
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
/// How long the last words of a process that has ended may be on their way.
const LEFT: Duration = Duration::from_millis(200);
/// Bytes that are kept of what a process says.
const KEPT: usize = 16 << 20;

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
    let program = std::env::current_exe().map_err(unable)?;
    said_by(Command::new(program).args(words), limit).map_err(unable)
}

fn said_by(command: &mut Command, limit: Duration) -> std::io::Result<Said> {
    // What a plug-in starts belongs to the same group, and ends with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let begin = Instant::now();
    let (out, err) = (Reader::new(child.stdout.take()), Reader::new(child.stderr.take()));
    let (code, is_late) = wait(&mut child, begin, limit)?;
    let took = begin.elapsed();
    Ok(Said { code, is_late, out: out.text(&child), err: err.text(&child), took })
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

/// Ends what a process that has ended has left behind.
fn end_group(child: &Child) {
    #[cfg(unix)]
    let _ = Command::new("kill")
        .args(["-KILL", "--", &format!("-{}", child.id())])
        .stderr(Stdio::null())
        .status();
    #[cfg(not(unix))]
    let _ = child;
}

/// Reads all that a process says on a thread of its own, so that it never waits for a reader.
struct Reader {
    read: Arc<Mutex<Vec<u8>>>,
    thread: JoinHandle<()>,
}

impl Reader {
    fn new(from: Option<impl Read + Send + 'static>) -> Self {
        let read = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&read);
        let thread = std::thread::spawn(move || {
            let Some(mut from) = from else { return };
            let mut room = vec![0; 1 << 16];
            loop {
                let n = match from.read(&mut room) {
                    Ok(n @ 1..) => n,
                    Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                    _ => return,
                };
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                let left = KEPT.saturating_sub(kept.len());
                kept.extend_from_slice(&room[..n.min(left)]);
            }
        });
        Self { read, thread }
    }

    /// What the process has said, which has ended. The end of it is not seen while something that the process has started is still there.
    fn text(self, child: &Child) -> String {
        let begin = Instant::now();
        let mut has_ended = false;
        while !self.thread.is_finished() && begin.elapsed() < END {
            if !has_ended && begin.elapsed() > LEFT {
                end_group(child);
                has_ended = true;
            }
            std::thread::sleep(LOOK);
        }
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        String::from_utf8_lossy(&read).into_owned()
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_a_process_leaves_behind_is_not_waited_for() {
        for (behind, code) in [("", 3), ("sleep 60 &", 3), ("setsid sleep 60 &", 3)] {
            let begin = Instant::now();
            let script = format!("echo out; echo err >&2; {behind} exit {code}");
            let said = said_by(Command::new("sh").args(["-c", &script]), Duration::from_secs(30)).unwrap();
            assert_eq!((said.code, said.out.as_str(), said.err.as_str()), (Some(code), "out\n", "err\n"));
            assert!(!said.is_late && begin.elapsed() < Duration::from_secs(20), "{behind}");
        }
    }
}
