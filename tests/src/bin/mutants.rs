//! Damages files by the thousand and sends each through the commands that read it, in processes with limits:
//! `cargo run --release -p blocksim-tests --features mutants --bin mutants -- --program target/release/blocksim --count 20000`.
//!
//! | flag | meaning |
//! |---|---|
//! | `--program FILE` | the program; it should be built with all of its parts |
//! | `--kinds A,B` | kinds of files, such as `diagram,move` or `signals.rec`; all but diagrams and moves with `others`; all if absent |
//! | `--seed N` | first seed, 1 if absent |
//! | `--count N` | number of mutants, 1000 if absent |
//! | `--all` | every command of each mutant, and not three of them |
//! | `--workers N` | processes at a time, 2 if absent |
//! | `--keep DIR` | where mutants that make the program fail are kept; `mutants` if absent |
//!
//! A fault is a panic, an abort, a signal, more than 5 s of computing time or more than 1 GB. The exit code is 1 if there is any.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use blocksim_tests::mutants::{Dice, PREPARATION, Subject, mutant, subjects};
use blocksim_tests::root;

/// Computing time that a command may take, s.
const SECONDS: u32 = 5;
/// Memory that it may take, KiB.
const MEMORY: u32 = 1 << 20;
/// Time on the wall that it may take: others use the computer, too.
const PATIENCE: Duration = Duration::from_secs(120);
/// Commands of each mutant, unless all are wanted.
const COMMANDS: usize = 3;

fn main() -> io::Result<ExitCode> {
    let orders = Orders { arguments: std::env::args().skip(1).collect() };
    let Some(program) = orders.word("--program") else {
        eprintln!("--program is missing: the program to try");
        return Ok(ExitCode::from(2));
    };
    let program = fs::canonicalize(program)?;
    let base = std::env::temp_dir().join(format!("blocksim-mutants-{}", std::process::id()));
    let chosen: Vec<&str> = orders.word("--kinds").map(|text| text.split(',').collect()).unwrap_or_default();
    let all: Vec<Subject> = subjects(&root())
        .into_iter()
        .filter(|subject| {
            let is_model = ["diagram", "move"].contains(&subject.kind);
            chosen.is_empty() || chosen.contains(&subject.kind) || chosen.contains(&"others") && !is_model
        })
        .collect();
    if all.is_empty() {
        eprintln!("no subject is of the kinds that --kinds names");
        return Ok(ExitCode::from(2));
    }
    let (first, count) = (orders.number("--seed", 1), orders.number("--count", 1000));
    let (next, tally) = (AtomicU64::new(first), Mutex::new(Tally::default()));
    let keep = PathBuf::from(orders.word("--keep").unwrap_or("mutants"));
    thread::scope(|scope| {
        for worker in 0..orders.number("--workers", 2) {
            let (program, folder, all, next, tally, keep) =
                (&program, base.join(worker.to_string()), &all, &next, &tally, &keep);
            let every = orders.has("--all");
            scope.spawn(move || {
                let result = Desk::new(program, folder).and_then(|desk| {
                    while let Some(seed) =
                        Some(next.fetch_add(1, Ordering::Relaxed)).filter(|seed| *seed < first + count)
                    {
                        desk.try_seed(seed, all, every, keep, tally)?;
                    }
                    Ok(())
                });
                if let Err(error) = result {
                    eprintln!("worker {worker}: {error}");
                    tally.lock().unwrap_or_else(PoisonError::into_inner).broken = true;
                }
            });
        }
    });
    let tally = tally.into_inner().unwrap_or_else(PoisonError::into_inner);
    fs::remove_dir_all(&base).ok();
    tally.print(&mut io::stdout().lock())?;
    Ok(if tally.faults > 0 || tally.broken { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// What was tried.
#[derive(Debug, Default)]
struct Tally {
    mutants: u64,
    commands: u64,
    faults: u64,
    broken: bool,
    slowest: Duration,
    by_kind: BTreeMap<&'static str, u64>,
    by_code: BTreeMap<i32, u64>,
}

impl Tally {
    fn print(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{} mutants, {} commands, {} faults", self.mutants, self.commands, self.faults)?;
        for (kind, count) in &self.by_kind {
            writeln!(out, "  {kind:14} {count}")?;
        }
        for (code, count) in &self.by_code {
            writeln!(out, "  exit code {code:4} {count}")?;
        }
        writeln!(out, "  slowest command {:.1} s on the wall", self.slowest.as_secs_f64())
    }
}

/// What is requested.
struct Orders {
    arguments: Vec<String>,
}

impl Orders {
    fn word(&self, flag: &str) -> Option<&str> {
        self.arguments.iter().skip_while(|argument| *argument != flag).nth(1).map(String::as_str)
    }

    fn number(&self, flag: &str, default: u64) -> u64 {
        self.word(flag).and_then(|text| text.parse().ok()).unwrap_or(default)
    }

    fn has(&self, flag: &str) -> bool {
        self.arguments.iter().any(|argument| argument == flag)
    }
}

/// A folder like that of the project, in which one worker tries mutants.
struct Desk<'a> {
    program: &'a Path,
    folder: PathBuf,
}

/// How a command ended.
struct Answer {
    code: Option<i32>,
    text: String,
    took: Duration,
    late: bool,
}

impl Answer {
    /// What is wrong with it.
    fn fault(&self) -> Option<&'static str> {
        let has = |piece: &str| self.text.contains(piece);
        match self.code {
            _ if self.late => Some("hang"),
            _ if has("memory allocation of") => Some("memory"),
            _ if has("This is a bug in blocksim") || has("panicked at") => Some("panic"),
            Some(0..=4) => None,
            Some(152 | 137) => Some("hang"),
            Some(134) => Some("abort"),
            Some(_) => Some("exit code"),
            None => Some("signal"),
        }
    }
}

impl<'a> Desk<'a> {
    fn new(program: &'a Path, folder: PathBuf) -> io::Result<Self> {
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("plugins"))?;
        for part in ["diagrams", "params"] {
            copy(&root().join(part), &folder.join(part))?;
        }
        for name in ["irb2600.urdf", "kinds.urdf", "crane.xml"] {
            fs::copy(root().join("tests/data").join(name), folder.join(name))?;
        }
        // Crates stay where their workspace is.
        for entry in fs::read_dir(root().join("plugins"))? {
            let entry = entry?;
            #[cfg(unix)]
            std::os::unix::fs::symlink(entry.path(), folder.join("plugins").join(entry.file_name()))?;
        }
        let desk = Desk { program, folder };
        for line in PREPARATION {
            let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
            let answer = desk.call(&words, false)?;
            if answer.code != Some(0) {
                return Err(io::Error::other(format!("{line}: {}", answer.text)));
            }
        }
        let built = program.parent().unwrap_or(Path::new(".")).join("libblocksim_plugin_pid.so");
        fs::copy(built, desk.folder.join("plugins/libpid.so")).map_err(|error| {
            io::Error::other(format!("the plug-in pid is not built beside the program: {error}"))
        })?;
        Ok(desk)
    }

    /// Runs the program, within limits if it reads a mutant.
    fn call(&self, words: &[String], limited: bool) -> io::Result<Answer> {
        let limits = match limited {
            true => format!("ulimit -t {SECONDS}; ulimit -v {MEMORY}; "),
            false => String::new(),
        };
        let began = Instant::now();
        let mut child = Command::new("sh")
            .args(["-c", &format!("ulimit -c 0; {limits}exec \"$0\" \"$@\"")])
            .arg(self.program)
            .args(words)
            .current_dir(&self.folder)
            .env("BLOCKSIM_HOME", self.folder.join("home"))
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (out, error) = (drain(child.stdout.take()), drain(child.stderr.take()));
        let (status, late) = wait(&mut child)?;
        let text = [out, error].map(|text| text.join().unwrap_or_default()).concat();
        #[cfg(unix)]
        let signal = std::os::unix::process::ExitStatusExt::signal(&status).map(|signal| 128 + signal);
        #[cfg(not(unix))]
        let signal = None;
        Ok(Answer { code: status.code().or(signal), text, took: began.elapsed(), late })
    }

    fn try_seed(
        &self,
        seed: u64,
        all: &[Subject],
        every: bool,
        keep: &Path,
        tally: &Mutex<Tally>,
    ) -> io::Result<()> {
        let mut dice = Dice::new(seed ^ 0xD1CE);
        let subject = dice.one(all);
        let place = self.folder.join(&subject.file);
        let valid = fs::read(&place)?;
        let damaged = mutant(&valid, subject.form, seed);
        let mut commands: Vec<&Vec<String>> = subject.commands.iter().collect();
        while !every && commands.len() > COMMANDS {
            commands.remove(dice.below(commands.len()));
        }
        for words in commands {
            // A command may change the file, as `--fix` does.
            replace(&place, &damaged)?;
            let out = self.folder.join("out");
            let _ = fs::remove_dir_all(&out);
            fs::create_dir_all(&out)?;
            let answer = self.call(words, true)?;
            let mut tally = tally.lock().unwrap_or_else(PoisonError::into_inner);
            tally.commands += 1;
            *tally.by_code.entry(answer.code.unwrap_or(-1)).or_default() += 1;
            tally.slowest = tally.slowest.max(answer.took);
            if let Some(fault) = answer.fault() {
                tally.faults += 1;
                let name = place.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let kept = keep.join(format!("{seed}-{name}"));
                fs::create_dir_all(keep)?;
                fs::write(&kept, &damaged)?;
                let end: Vec<&str> = answer.text.lines().rev().take(12).collect();
                let end: Vec<&str> = end.into_iter().rev().collect();
                println!(
                    "{fault}: seed {seed}, {} in {:.1} s, code {:?}: blocksim {}\n    {}",
                    subject.file.display(),
                    answer.took.as_secs_f64(),
                    answer.code,
                    words.join(" "),
                    end.join("\n    ")
                );
            }
        }
        replace(&place, &valid)?;
        let mut tally = tally.lock().unwrap_or_else(PoisonError::into_inner);
        tally.mutants += 1;
        *tally.by_kind.entry(subject.kind).or_default() += 1;
        if tally.mutants.is_multiple_of(1000) {
            eprintln!("{} mutants, {} commands, {} faults", tally.mutants, tally.commands, tally.faults);
        }
        Ok(())
    }
}

/// Writes a file anew: a library that is loaded somewhere else keeps its old one.
fn replace(place: &Path, bytes: &[u8]) -> io::Result<()> {
    let _ = fs::remove_file(place);
    fs::write(place, bytes)
}

/// Reads all that a process prints, the first MiB of it.
fn drain(pipe: Option<impl Read + Send + 'static>) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            let _ = pipe.by_ref().take(1 << 20).read_to_end(&mut bytes);
            let _ = io::copy(&mut pipe, &mut io::sink());
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// Waits for the end of a process, or ends it.
fn wait(child: &mut Child) -> io::Result<(std::process::ExitStatus, bool)> {
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok((status, false));
        }
        if began.elapsed() > PATIENCE {
            child.kill()?;
            return Ok((child.wait()?, true));
        }
        thread::sleep(Duration::from_millis(5));
    }
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let place = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &place)?;
        } else {
            fs::copy(entry.path(), place)?;
        }
    }
    Ok(())
}
