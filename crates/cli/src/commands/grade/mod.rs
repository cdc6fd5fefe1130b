//! `blocksim grade`: many projects, each run by itself and compared with a reference, on one page.
//!
//! Each project is built and run by another process of this program, with its plug-ins in processes of their own and with limits of time, so that
//! none can stop the others or change what is said of them.

mod page;
mod process;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use blocksim_numbers::format::significant;
use blocksim_recording::write_whole;
use serde_json::{Value, json};

use self::process::{Said, said};
use crate::args::grade::GradeArgs;
use crate::disk::{readable, reason};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::interrupt;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Name of the run that the others are compared with.
const REFERENCE: &str = "reference";
/// Part of the time that the reference runs for by which a value may come early or late.
const BESIDE: f64 = 1e-4;
/// The page of all, without its ending.
const INDEX: &str = "index";
/// Relative tolerance where none is given.
const USUAL: f64 = 1e-3;

/// A project and what became of it.
pub struct Graded {
    /// Name of its folder.
    pub name: String,
    /// What became of it, in a word.
    pub verdict: Verdict,
    /// Why, where it is not good.
    pub reason: String,
    /// Comparison with the reference, as `compare --json` prints it.
    pub compared: Value,
    /// Seconds that it took.
    pub took: f64,
}

/// What became of a project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It agrees with the reference.
    Agrees,
    /// It runs and differs.
    Differs,
    /// It has run, but cannot be compared.
    Unlike,
    /// It does not run to its end.
    Fails,
    /// It took too long.
    Late,
    /// There is no such model.
    Missing,
}

impl Verdict {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Unlike => "not comparable",
            Verdict::Fails => "fails",
            Verdict::Late => "too slow",
            Verdict::Missing => "missing",
        }
    }
}

/// Runs and compares all projects.
///
/// # Errors
/// If the reference does not run, or nothing can be written. A bad project is not an error: it is reported with the others.
pub fn grade(args: &GradeArgs, console: Console) -> Outcome {
    readable(&args.against)?;
    let Some(name) = args.against.file_name().map(PathBuf::from) else {
        return Err(Failure::usage("`--against` names no file").help("name the model of the reference"));
    };
    let projects = projects(args, &name)?;
    empty(&args.out)?;
    interrupt::take_over();
    let limit = Duration::try_from_secs_f64(args.limit).unwrap_or(Duration::MAX);
    let reference = args.out.join(REFERENCE);
    let ran = run(&args.against, &reference, args, limit)?;
    if ran.code != Some(0) {
        let why = problem(&ran).unwrap_or_else(|| "it does not run to its end".to_owned());
        let said = format!("the reference `{}` cannot be used: {why}", args.against.display());
        return Err(Failure::new(Exit::Model, "grade", said).help("correct it first; nothing was graded"));
    }
    let done = ran.lines().find(|line| line["type"] == "done");
    let duration = done.and_then(|line| line["simulated_time"].as_f64()).unwrap_or(0.0);
    let mut all = Vec::new();
    for (at, (project, model)) in projects.iter().enumerate() {
        if interrupt::is_requested() {
            return Err(Failure::interrupted("not all projects were graded, and no page was made"));
        }
        if console.live && !args.json {
            console.rewrite(&format!("  Grading {} of {}: {project}", at + 1, projects.len()));
        }
        let graded = one(project, model, (&reference, duration), args, limit)?;
        if console.live && !args.json {
            console.rewrite("");
        }
        console.data(&if args.json { format!("{}\n", data(&graded)) } else { line(&graded) })?;
        all.push(graded);
    }
    let page = page::page(args, &all);
    write_whole(&args.out, "index.html", |out| out.write_all(page.as_bytes()))
        .map_err(|error| crate::disk::unwritable(&args.out.join("index.html"), &error))?;
    let good = all.iter().filter(|graded| graded.verdict == Verdict::Agrees).count();
    if !args.json {
        let place = args.out.join("index.html");
        console.data(&format!(
            "{good} of {} agree; the page is {}\n",
            plural(all.len(), "project"),
            place.display()
        ))?;
    }
    Ok(if good == all.len() { Exit::Done } else { Exit::Failed })
}

/// Names of the projects and where each should have its model.
fn projects(args: &GradeArgs, name: &Path) -> Result<Vec<(String, PathBuf)>, Failure> {
    let folder = args.folder.display();
    let entries = fs::read_dir(&args.folder)
        .map_err(|error| Failure::unreadable(format!("cannot read `{folder}`: {}", reason(&error))))?;
    let mut names: Vec<String> = entries
        .filter_map(Result::ok)
        .filter(|entry| entry.path().is_dir())
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.') && !["runs", "target"].contains(&name.as_str()))
        .collect();
    names.sort();
    if names.is_empty() {
        return Err(Failure::unreadable(format!("there are no projects in `{folder}`"))
            .help("put each project into a folder of its own there"));
    }
    if let Some(name) = names.iter().find(|name| [REFERENCE, INDEX].contains(&name.as_str())) {
        let what = if name == REFERENCE { "the run of the reference" } else { "the page of all" };
        return Err(Failure::usage(format!("no project in `{folder}` can be called `{name}`"))
            .help(format!("{what} has this name; rename the folder")));
    }
    Ok(names.into_iter().map(|project| (project.clone(), args.folder.join(project).join(name))).collect())
}

/// A folder for the results that is there and empty.
fn empty(out: &Path) -> Result<(), Failure> {
    let place = out.display();
    fs::create_dir_all(out)
        .map_err(|error| Failure::unwritable(format!("cannot make `{place}`: {}", reason(&error))))?;
    let has_files = fs::read_dir(out).is_ok_and(|mut entries| entries.next().is_some());
    if has_files {
        return Err(Failure::new(Exit::Files, "exists", format!("`{place}` is not empty"))
            .help("name a new folder with --out; nothing was changed"));
    }
    Ok(())
}

fn run(model: &Path, out: &Path, args: &GradeArgs, limit: Duration) -> Result<Said, Failure> {
    let call = args.call_limit.to_string();
    let mut words: Vec<&std::ffi::OsStr> =
        vec!["run".as_ref(), model.as_os_str(), "--out".as_ref(), out.as_os_str()];
    words.extend(["--isolate", "--call-limit", &call, "--json", "--no-csv"].map(std::ffi::OsStr::new));
    said(&words, limit)
}

fn one(
    project: &str,
    model: &Path,
    (reference, duration): (&Path, f64),
    args: &GradeArgs,
    limit: Duration,
) -> Result<Graded, Failure> {
    let mut graded = Graded {
        name: project.to_owned(),
        verdict: Verdict::Missing,
        reason: format!("there is no `{}`", model.display()),
        compared: Value::Null,
        took: 0.0,
    };
    if !model.is_file() {
        return Ok(graded);
    }
    let out = args.out.join(project);
    let ran = run(model, &out, args, limit)?;
    graded.took = ran.took.as_secs_f64();
    if ran.code != Some(0) {
        graded.verdict = if ran.is_late { Verdict::Late } else { Verdict::Fails };
        let late = format!("it has not ended within {} s", args.limit);
        graded.reason = match ran.code {
            _ if ran.is_late => late,
            // Whatever it has said before is not why.
            None => "its run was ended from outside, by a signal".to_owned(),
            Some(_) => problem(&ran).unwrap_or_default(),
        };
        return Ok(graded);
    }
    let is_bare = args.abs.is_empty() && args.range.is_none();
    let rel = args.rel.or(is_bare.then_some(USUAL));
    let range = if is_bare { rel } else { args.range };
    let shares = [("--rel", rel), ("--range", range)];
    let mut shares: Vec<String> =
        shares.into_iter().filter_map(|(name, x)| Some(format!("{name}={}", x?))).collect();
    shares.push(format!("--time-tolerance={:?}", args.time_tolerance.unwrap_or(BESIDE * duration)));
    let (picture, page) = (args.out.join(format!("{project}.svg")), args.out.join(format!("{project}.html")));
    let signals = args.signals.join(",");
    let mut words: Vec<&std::ffi::OsStr> =
        vec!["compare".as_ref(), reference.as_os_str(), out.as_os_str(), "--json".as_ref()];
    words.extend(["--svg".as_ref(), picture.as_os_str(), "--html".as_ref(), page.as_os_str()]);
    args.abs.iter().for_each(|abs| words.extend(["--abs".as_ref(), std::ffi::OsStr::new(abs)]));
    words.extend(shares.iter().map(std::ffi::OsStr::new));
    if !args.signals.is_empty() {
        words.extend(["--signals".as_ref(), std::ffi::OsStr::new(&signals)]);
    }
    let compared = said(&words, limit)?;
    let found = compared.lines().find(|line| line["type"] == "comparison");
    (graded.verdict, graded.reason) = match &found {
        Some(found) if found["agrees"] == true => (Verdict::Agrees, String::new()),
        Some(found) => (Verdict::Differs, differs(found)),
        None => (Verdict::Unlike, problem(&compared).unwrap_or_default()),
    };
    graded.compared = found.unwrap_or_default();
    Ok(graded)
}

/// The first error that a command has told.
fn problem(said: &Said) -> Option<String> {
    let first = said.lines().find(|line| line["type"] == "diagnostic" && line["severity"] == "error");
    let text = first.and_then(|line| line["message"].as_str().map(str::to_owned));
    text.or_else(|| said.err.lines().rev().find(|line| !line.trim().is_empty()).map(str::to_owned))
}

/// Where it differs most, in words.
fn differs(found: &Value) -> String {
    let signals = found["signals"].as_array().map(Vec::as_slice).unwrap_or_default();
    let apart: Vec<&Value> = signals.iter().filter(|signal| signal["agrees"] != true).collect();
    let Some(first) = apart.first() else { return "signals are missing".to_owned() };
    let (path, unit) =
        (first["signal"].as_str().unwrap_or_default(), first["unit"].as_str().unwrap_or_default());
    // The greatest difference may be within its tolerance.
    let beyond = |deviation: &Value| {
        let [difference, allowed] = ["difference", "tolerance"].map(|name| deviation[name].as_f64());
        difference.zip(allowed).is_some_and(|(difference, allowed)| difference.abs() > allowed)
    };
    let most = [&first["maximum"], &first["first"]].into_iter().find(|deviation| beyond(deviation));
    let most = most.unwrap_or(&first["maximum"]);
    let more = if apart.len() > 1 {
        format!(", and {} more", plural(apart.len() - 1, "signal"))
    } else {
        String::new()
    };
    if let ("short", Some(from), Some(to)) =
        (first["verdict"].as_str().unwrap_or_default(), first["span"][0].as_f64(), first["span"][1].as_f64())
    {
        let [from, to] = [from, to].map(|time| significant(time, 4));
        return format!("`{path}` is the same, but only there from {from} s to {to} s{more}");
    }
    match (most["difference"].as_f64(), most["time"].as_f64()) {
        (Some(difference), Some(time)) => {
            let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
            let difference = significant(difference.abs(), 3);
            format!("`{path}` by {difference}{unit} at {} s{more}", significant(time, 4))
        }
        _ => {
            let what = match first["verdict"].as_str() {
                Some("missing") => "is missing",
                Some("other_unit") => "has a unit of another kind",
                _ => "has nothing to compare",
            };
            format!("`{path}` {what}{more}")
        }
    }
}

fn line(graded: &Graded) -> String {
    let reason = if graded.reason.is_empty() { String::new() } else { format!("  {}", graded.reason) };
    let text = format!("{:<24} {:<14}{reason}", graded.name, graded.verdict.word());
    // Names of folders are those of strangers: what is no sign does nothing to a terminal.
    let shown = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    text.trim_end().chars().map(shown).collect::<String>() + "\n"
}

fn data(graded: &Graded) -> Value {
    json!({
        "v": 1, "type": "graded", "name": graded.name, "verdict": graded.verdict.word(), "reason": graded.reason,
        "took": graded.took, "comparison": graded.compared,
    })
}
