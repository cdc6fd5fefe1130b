//! Damages files by the thousand and sends each through the commands that read it, in processes with limits:
//! `cargo run --release -p blocksim-tests --features mutants --bin mutants -- --program target/release/blocksim --count 20000`.
//!
//! | flag | meaning |
//! |---|---|
//! | `--program FILE` | the program; it should be built with all of its parts |
//! | `--kinds A,B` | kinds of files, such as `diagram,move`, `signals.rec` or `parts` (of workbooks); all but diagrams, moves and what needs cargo with `others`; all if absent |
//! | `--each` | prints the kinds, and tries nothing |
//! | `--valid` | sends the files through their commands as they are, and shows what each takes |
//! | `--seed N` | first seed, 1 if absent |
//! | `--count N` | number of mutants, 1000 if absent |
//! | `--commands N` | at most so many commands of each mutant, 3 if absent |
//! | `--workers N` | processes at a time, 2 if absent |
//! | `--keep DIR` | where mutants that make the program fail are kept; `mutants` if absent |
//!
//! A fault is a panic, an abort, a signal, more than 5 s of computing time or more than 1 GB. The exit code is 1 if there is any.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use blocksim_tests::mutants::{Answer, Desk, SLOW, Subject, subjects};
use blocksim_tests::root;

/// Prints a line for whoever waits.
macro_rules! say {
    ($($text:tt)*) => {
        drop(writeln!(io::stderr(), $($text)*))
    };
}

/// Prints a line of the result.
macro_rules! show {
    ($($text:tt)*) => {
        drop(writeln!(io::stdout(), $($text)*))
    };
}

fn main() -> io::Result<ExitCode> {
    let orders = Orders { arguments: std::env::args().skip(1).collect() };
    if orders.has("--each") {
        let kinds: BTreeSet<&str> = subjects(&root()).iter().map(|subject| subject.kind).collect();
        kinds.iter().for_each(|kind| show!("{kind}"));
        return Ok(ExitCode::SUCCESS);
    }
    let Some(program) = orders.word("--program") else {
        say!("--program is missing: the program to try");
        return Ok(ExitCode::from(2));
    };
    let program = fs::canonicalize(program)?;
    let base = std::env::temp_dir().join(format!("blocksim-mutants-{}", std::process::id()));
    let chosen: Vec<&str> = orders.word("--kinds").map(|text| text.split(',').collect()).unwrap_or_default();
    let all: Vec<Subject> = subjects(&root())
        .into_iter()
        .filter(|subject| {
            let is_other = !["diagram", "move"].contains(&subject.kind) && !SLOW.contains(&subject.kind);
            chosen.is_empty() || chosen.contains(&subject.kind) || chosen.contains(&"others") && is_other
        })
        .collect();
    if all.is_empty() {
        say!("no subject is of the kinds that --kinds names");
        return Ok(ExitCode::from(2));
    }
    if orders.has("--valid") {
        let desk = Desk::new(&program, base.clone(), &all)?;
        desk.try_valid(&all, |words, answer| {
            show!("{:?} in {:.2} s: blocksim {}", answer.code, answer.took.as_secs_f64(), words.join(" "));
            if !matches!(answer.code, Some(0 | 1)) {
                show!("{}", answer.text);
            }
        })?;
        fs::remove_dir_all(&base).ok();
        return Ok(ExitCode::SUCCESS);
    }
    let (first, count) = (orders.number("--seed", 1), orders.number("--count", 1000));
    let (next, tally) = (AtomicU64::new(first), Mutex::new(Tally::default()));
    let keep = PathBuf::from(orders.word("--keep").unwrap_or("mutants"));
    thread::scope(|scope| {
        for worker in 0..orders.number("--workers", 2) {
            let (program, folder, all, next, tally, keep) =
                (&program, base.join(worker.to_string()), &all, &next, &tally, &keep);
            let most = usize::try_from(orders.number("--commands", 3)).unwrap_or(usize::MAX);
            scope.spawn(move || {
                let result = Desk::new(program, folder, all).and_then(|desk| {
                    while let Some(seed) =
                        Some(next.fetch_add(1, Ordering::Relaxed)).filter(|seed| *seed < first + count)
                    {
                        let subject = desk.try_seed(seed, all, most, |subject, words, answer, damaged| {
                            let mut tally = tally.lock().unwrap_or_else(PoisonError::into_inner);
                            tally.note(seed, subject, words, answer);
                            if answer.fault().is_some() {
                                let name = subject.file.file_name().unwrap_or_default().to_string_lossy();
                                fs::create_dir_all(keep)?;
                                fs::write(keep.join(format!("{seed}-{name}")), damaged)?;
                            }
                            Ok(())
                        })?;
                        tally.lock().unwrap_or_else(PoisonError::into_inner).count(subject);
                    }
                    Ok(())
                });
                if let Err(error) = result {
                    say!("worker {worker}: {error}");
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
    /// Counts a mutant.
    fn count(&mut self, subject: &Subject) {
        self.mutants += 1;
        *self.by_kind.entry(subject.kind).or_default() += 1;
        if self.mutants.is_multiple_of(1000) {
            say!("{} mutants, {} commands, {} faults", self.mutants, self.commands, self.faults);
        }
    }

    /// Counts a command, and prints what is wrong with it.
    fn note(&mut self, seed: u64, subject: &Subject, words: &[String], answer: &Answer) {
        self.commands += 1;
        *self.by_code.entry(answer.code.unwrap_or(-1)).or_default() += 1;
        self.slowest = self.slowest.max(answer.took);
        let Some(fault) = answer.fault() else { return };
        self.faults += 1;
        let end: Vec<&str> = answer.text.lines().rev().take(12).collect();
        let end: Vec<&str> = end.into_iter().rev().collect();
        show!(
            "{fault}: seed {seed}, {} in {:.1} s, code {:?}: blocksim {}\n    {}",
            subject.file.display(),
            answer.took.as_secs_f64(),
            answer.code,
            words.join(" "),
            end.join("\n    ")
        );
    }

    fn print(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{} mutants, {} commands, {} faults", self.mutants, self.commands, self.faults)?;
        for (kind, count) in &self.by_kind {
            writeln!(out, "  {kind:16} {count}")?;
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
