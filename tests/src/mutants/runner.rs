//! Sends mutants through the commands that read them, in processes with limits.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::{Dice, PREPARATION, Subject, mutant, samples};
use crate::root;

/// Computing time that a command may take, s.
const SECONDS: u32 = 5;
/// Memory that it may take, KiB.
const MEMORY: u32 = 1 << 20;
/// Time on the wall that it may take: others use the computer, too.
const PATIENCE: Duration = Duration::from_secs(120);

/// A folder like that of the project, in which one worker tries mutants.
#[derive(Debug)]
pub struct Desk<'a> {
    program: &'a Path,
    folder: PathBuf,
}

/// How a command ended.
#[derive(Debug)]
pub struct Answer {
    /// Exit code, or 128 and the number of a signal.
    pub code: Option<i32>,
    /// What it printed.
    pub text: String,
    /// How long it took.
    pub took: Duration,
    late: bool,
}

impl Answer {
    /// What is wrong with it.
    pub fn fault(&self) -> Option<&'static str> {
        let has = |piece: &str| self.text.contains(piece);
        match self.code {
            _ if self.late => Some("hang"),
            _ if has("memory allocation of") => Some("memory"),
            _ if has("This is a bug in blocksim") || has("panicked at") => Some("panic"),
            Some(0..=4) => None,
            // The loader of the system found a damaged library to be impossible, and has ended the process itself.
            Some(127) if has("Inconsistency detected by ld.so") => None,
            Some(152 | 137) => Some("hang"),
            Some(134) => Some("abort"),
            Some(_) => Some("exit code"),
            None => Some("signal"),
        }
    }
}

impl<'a> Desk<'a> {
    /// Copies what mutants of these subjects are made of to `folder`, and makes the rest with the program.
    ///
    /// # Errors
    /// A file that cannot be copied, or a command that fails.
    pub fn new(program: &'a Path, folder: PathBuf, all: &[Subject]) -> io::Result<Self> {
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
        samples::write(&folder)?;
        fs::copy(root().join("params/irb2600.ron"), folder.join("same.ron"))?;
        // Tests build it among what they need, and leave it there.
        let beside = program.parent().unwrap_or(Path::new("."));
        let places =
            [beside.to_owned(), beside.join("deps")].map(|place| place.join("libblocksim_plugin_pid.so"));
        let built = places.iter().find(|place| place.exists()).unwrap_or(&places[0]);
        fs::copy(built, folder.join("plugins/libpid.so")).map_err(|error| {
            io::Error::other(format!("the plug-in pid is not built beside the program: {error}"))
        })?;
        let desk = Desk { program, folder };
        let is_needed =
            |kinds: &[&str]| kinds.is_empty() || all.iter().any(|subject| kinds.contains(&subject.kind));
        for (_, line) in PREPARATION.iter().filter(|(kinds, _)| is_needed(kinds)) {
            let line = line.replace("ROOT", &root().canonicalize()?.display().to_string());
            let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
            let answer = desk.call(&words, false)?;
            if answer.code != Some(0) {
                return Err(io::Error::other(format!("{line}: {}", answer.text)));
            }
        }
        Ok(desk)
    }

    /// Runs the program, within limits if it reads a mutant.
    fn call(&self, words: &[String], limited: bool) -> io::Result<Answer> {
        let limits = match limited {
            true => format!("ulimit -t {SECONDS}; ulimit -v {MEMORY}; "),
            false => String::new(),
        };
        let input = self.input(words.last().map_or("", String::as_str))?;
        let began = Instant::now();
        let mut child = Command::new("sh")
            .args(["-c", &format!("ulimit -c 0; {limits}exec \"$0\" \"$@\"")])
            .arg(self.program)
            .args(words.iter().filter(|word| !word.starts_with('<')))
            .current_dir(&self.folder)
            .env("BLOCKSIM_HOME", self.folder.join("home"))
            .env("NO_COLOR", "1")
            .stdin(input)
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

    /// What a command reads from its input, by its last word.
    fn input(&self, word: &str) -> io::Result<Stdio> {
        let Some(name) = word.strip_prefix('<') else { return Ok(Stdio::null()) };
        let file = match name.strip_prefix('<') {
            None => self.folder.join(name),
            Some(lines) => {
                let messages = self.folder.join("messages");
                fs::write(&messages, samples::framed(&fs::read(self.folder.join(lines))?))?;
                messages
            }
        };
        Ok(fs::File::open(file)?.into())
    }

    /// The file of a subject: a name with a `*` at its end is completed.
    fn place(&self, file: &Path) -> Option<PathBuf> {
        let place = self.folder.join(file);
        let name = place.file_name()?.to_str()?;
        let Some(start) = name.strip_suffix('*') else { return Some(place) };
        let entries = fs::read_dir(place.parent()?).ok()?.flatten();
        entries.map(|entry| entry.path()).find(|path| {
            path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with(start))
        })
    }

    /// Sends the valid files through all commands that read them; `report` gets each answer, with the command.
    ///
    /// # Errors
    /// A file that cannot be written, or a program that does not start.
    pub fn try_valid(&self, all: &[Subject], mut report: impl FnMut(&[String], &Answer)) -> io::Result<()> {
        let commands: BTreeSet<&Vec<String>> = all.iter().flat_map(|subject| &subject.commands).collect();
        for words in commands {
            self.clear()?;
            report(words, &self.call(words, true)?);
        }
        Ok(())
    }

    /// Empties the folder for what commands write.
    fn clear(&self) -> io::Result<()> {
        let out = self.folder.join("out");
        let _ = fs::remove_dir_all(&out);
        fs::create_dir_all(&out)
    }

    /// Sends the mutant of a seed through the commands that read it, at most so many of them: `report` gets each answer, with the command and the
    /// mutant. Returns its subject.
    ///
    /// # Errors
    /// A file that cannot be written, or a program that does not start.
    pub fn try_seed<'s>(
        &self,
        seed: u64,
        all: &'s [Subject],
        most: usize,
        mut report: impl FnMut(&Subject, &[String], &Answer, &[u8]) -> io::Result<()>,
    ) -> io::Result<&'s Subject> {
        let mut dice = Dice::new(seed ^ 0xD1CE);
        let subject = dice.one(all);
        let absent = || io::Error::other(format!("{} was not made", subject.file.display()));
        let place = self.place(&subject.file).ok_or_else(absent)?;
        let valid = fs::read(&place).map_err(|_| absent())?;
        let damaged = mutant(&valid, subject.form, seed);
        let mut commands: Vec<&Vec<String>> = subject.commands.iter().collect();
        while commands.len() > most {
            commands.remove(dice.below(commands.len()));
        }
        for words in commands {
            // A command may change the file, as `--fix` does.
            replace(&place, &damaged)?;
            self.clear()?;
            report(subject, words, &self.call(words, true)?, &damaged)?;
        }
        replace(&place, &valid)?;
        Ok(subject)
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
fn wait(child: &mut Child) -> io::Result<(ExitStatus, bool)> {
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok((status, false));
        }
        if began.elapsed() > PATIENCE {
            child.kill()?;
            return Ok((child.wait()?, true));
        }
        thread::sleep(Duration::from_millis(2));
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
