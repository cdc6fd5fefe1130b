//! A model, read and compiled.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use blocksim_block::problem::{Problem, Severity};
use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Compiled, Options, SourceFile, Sources, compile, compile_with, fingerprint};
use blocksim_recording::{FileUsed, limited_bytes};
use blocksim_scene::Scene;

use crate::args::model::{Format, ModelArgs};
use crate::commands::tell;
use crate::disk::{Disk, readable};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::terminal::console::{Console, notice};
use crate::terminal::render;
use crate::trust::{Plugins, Purpose};

/// A model and the files that it was read from.
#[derive(Clone)]
pub struct Loaded {
    /// What became of it.
    pub compiled: Compiled,
    /// All texts that places in problems refer to.
    pub files: Vec<SourceFile>,
    /// Those of them that are files.
    pub on_disk: Vec<SourceFile>,
    /// Libraries of plug-ins.
    pub plugins: Vec<FileUsed>,
    /// What they offer, by their names in the texts that a run keeps.
    pub offers: BTreeMap<String, String>,
}

impl Loaded {
    /// The values of `--set` with the units that bare numbers were taken in: `set demand.after = 45 deg`; `None` where every
    /// value means what it says.
    pub fn understood(&self) -> Option<String> {
        let taken = self.compiled.replaced.iter().filter(|replaced| replaced.written != replaced.value);
        let all: Vec<String> = taken.map(|one| format!("{} = {}", one.target, one.value)).collect();
        (!all.is_empty()).then(|| format!("set {}", all.join(", ")))
    }

    /// What is wrong with it, in a sentence.
    pub fn first_error(&self) -> String {
        let problems = &self.compiled.problems;
        let first = problems.iter().find(|problem| problem.severity == Severity::Error).or(problems.first());
        first.map_or_else(|| "the model has errors".to_owned(), |problem| problem.message.clone())
    }

    /// Takes what the engine runs, and tells the problems that do not stop it: notes in a line, since `check` explains them.
    ///
    /// # Errors
    /// The problems that do; `undone` says what was not done for them: `nothing was run`.
    pub fn take_schedule(&mut self, undone: &str, console: Console) -> Result<Schedule, Failure> {
        let problems = &self.compiled.problems;
        match self.compiled.schedule.take() {
            Some(schedule) => {
                let (notes, others): (Vec<Problem>, Vec<Problem>) =
                    problems.iter().cloned().partition(|problem| problem.severity == Severity::Note);
                if console.format != Format::Full {
                    tell(problems, &self.files, console)?;
                    return Ok(schedule);
                }
                tell(&others, &self.files, console)?;
                if let [first, rest @ ..] = notes.as_slice() {
                    let more =
                        if rest.is_empty() { String::new() } else { format!(", and {} more", rest.len()) };
                    console.say(&format!("note: {}{more} (`blocksim check` shows where)", first.message));
                }
                Ok(schedule)
            }
            None => {
                let last = format!("{}; {undone}", render::tally(problems));
                Err(Failure::of(Exit::Model, problems.clone(), self.files.clone()).last(last))
            }
        }
    }

    /// What is seen of mechanisms, if anything is.
    pub fn scene(&self) -> Option<&Scene> {
        self.compiled.scene.as_ref().filter(|scene| !scene.shapes.is_empty())
    }
}

/// Lets whoever waits for the build of a plug-in know what for.
pub fn tell_builds() {
    blocksim_host::set_build_notice(|text| notice(&format!("  {text}")));
}

/// Reads and compiles a model.
///
/// # Errors
/// If there is nothing to read. Problems of the model are no failure here.
pub fn load(args: &ModelArgs, purpose: Purpose) -> Result<Loaded, Failure> {
    load_with(args, purpose, &Options::default())
}

/// The same for a command that looks at outputs by their names, read and recorded ones or others.
///
/// # Errors
/// If there is nothing to read.
pub fn load_to_watch(args: &ModelArgs, purpose: Purpose, watched: &[String]) -> Result<Loaded, Failure> {
    load_with(args, purpose, &Options { watched, ..Options::default() })
}

/// The same, compiled as options say but for the values of `--set`, which are those of the command line.
///
/// # Errors
/// If there is nothing to read.
pub fn load_with(args: &ModelArgs, purpose: Purpose, options: &Options) -> Result<Loaded, Failure> {
    readable(&args.model)?;
    tell_builds();
    let disk = Disk::with(Plugins::of(args.plugins, purpose));
    let sources = Sources::new(&disk);
    let mut compiled = compile_with(&sources, &args.model, &Options { overrides: &args.set, ..*options });
    once_for_each_cause(&mut compiled.problems);
    let files = sources.all();
    let on_disk = files.iter().filter(|file| disk.has_read(&file.path)).cloned().collect();
    // Hashed now, before anybody builds them anew.
    let plugins = blocksim_host::opened().into_iter().map(|library| library_used(&library.path));
    Ok(Loaded { compiled, files, on_disk, plugins: plugins.collect(), offers: disk.offers() })
}

/// Keeps the first of problems that several blocks have for one reason: one move that stands in a block for each axis, one plug-in that
/// does not build.
fn once_for_each_cause(problems: &mut Vec<Problem>) {
    let mut seen: Vec<String> = Vec::new();
    problems.retain(|problem| {
        let is_shared = problem.code.starts_with("move_")
            || ["plugin_abi", "plugin_build", "plugin_missing", "plugin_symbol"].contains(&problem.code);
        let again = is_shared && seen.contains(&problem.message);
        if is_shared && !again {
            seen.push(problem.message.clone());
        }
        !again
    });
}

/// Files that a model is read from, and folders of sources whose plug-ins it has loaded; the file of the model itself in
/// any case.
pub fn files_of(args: &ModelArgs, purpose: Purpose) -> Vec<PathBuf> {
    let disk = Disk::with(Plugins::of(args.plugins, purpose));
    compile(&Sources::new(&disk), &args.model, &args.set);
    let mut files = disk.files();
    if !files.contains(&args.model) {
        files.push(args.model.clone());
    }
    files.extend(blocksim_host::folders());
    files.sort();
    files.dedup();
    files
}

/// The library of a plug-in. One that cannot be read any more has an empty hash.
fn library_used(path: &Path) -> FileUsed {
    let hash = limited_bytes(path, u64::MAX).map(|bytes| fingerprint(&bytes)).unwrap_or_default();
    FileUsed { path: with_slashes(path), hash }
}

/// A path as a manifest writes it on any system.
pub fn with_slashes(path: &Path) -> String {
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    // An absolute path begins with the part `/`.
    parts.join("/").replacen("//", "/", 1)
}
