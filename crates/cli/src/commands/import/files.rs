//! Writing what was imported: files of numbers are written anew, those of the user are left alone.

use std::fs;
use std::io;
use std::path::Path;
use std::time::SystemTime;

use blocksim_diagram::fingerprint;
use blocksim_import::smidata::{self, SmiData};
use blocksim_import::{
    Chain, Differences, Files, Mechanism, MeshFile, Part, Provenance, diagram, differences, file_name,
    named_in, parameters, restructured, robot, wired_in,
};
use blocksim_recording::{MOST_TEXT, clock::iso, limited_bytes, limited_text, write_whole};

use crate::args::import::ImportArgs;
use crate::disk::unwritable;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::seal::{Seal, seal, sealed};
use crate::terminal::console::Console;

/// A file that is imported.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    pub file: &'a Path,
    pub bytes: &'a [u8],
}

/// Where the numbers come from, and what files of them are called.
fn about(sources: &[Source]) -> (Provenance, String) {
    let name = |source: &Source| {
        source.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
    };
    let stem = sources.first().and_then(|source| source.file.file_stem()).unwrap_or_default();
    let join = |all: Vec<String>| all.join(" and ");
    let provenance = Provenance {
        source: join(sources.iter().map(name).collect()),
        fingerprint: join(sources.iter().map(|source| fingerprint(source.bytes)).collect()),
        date: iso(SystemTime::now())[..10].to_owned(),
    };
    (provenance, file_name(&stem.to_string_lossy()))
}

/// Writes the numbers of a data file alone; what is told about it.
///
/// # Errors
/// Why they cannot be written.
pub fn numbers(args: &ImportArgs, data: &SmiData, sources: &[Source]) -> Result<String, Failure> {
    let (provenance, stem) = about(sources);
    let text = smidata::parameters(data, &provenance);
    let name = format!("{stem}.ron");
    let place = args.out.join(&name);
    let before = existing(&place)?;
    refuse(&place, before.as_deref(), &[], args)?;
    bring(&args.out, &name, &text, &[], before.as_deref())
}

/// A file that names numbers: its name and its text.
type Wired = (String, String);

/// Writes a parameter file, or a newer one in its place; what is told about it.
fn bring(
    folder: &Path,
    name: &str,
    text: &str,
    wired: &[Wired],
    before: Option<&str>,
) -> Result<String, Failure> {
    fs::create_dir_all(folder).map_err(|error| uncreated(folder, &error))?;
    let fresh = seal(text);
    let path = put(folder, name, &fresh)?;
    Ok(match before {
        None => format!("wrote {path}\n"),
        Some(before) => {
            let found = differences(before, &fresh);
            format!("updated {path}: {}\n{}", counts(&found), listed(&found, before, &fresh, wired))
        }
    })
}

/// Writes diagram, parameters and description, and brings those that exist up to date; what is told about it.
///
/// # Errors
/// Why nothing, or not all, could be written.
pub fn write(
    args: &ImportArgs,
    mechanism: &Mechanism,
    chain: Option<&Chain>,
    meshes: &[MeshFile],
    sources: &[Source],
    console: Console,
) -> Result<String, Failure> {
    let (provenance, stem) = about(sources);
    let [numbers, model, described] =
        ["_parameters", "", "_robot"].map(|ending| format!("{stem}{ending}.ron"));
    let place = args.out.join(&numbers);
    let before = existing(&place)?;
    let [wired, robotic] = [&model, &described].map(|name| existing(&args.out.join(name)));
    let (wired, robotic) = (wired?, robotic?);
    let text = parameters(mechanism, chain, &provenance);
    let own = [(&model, &wired), (&described, &robotic)];
    let own: Vec<Wired> =
        own.iter().filter_map(|(name, text)| Some(((*name).clone(), (*text).clone()?))).collect();
    let imported = before.as_deref().filter(|before| sealed(before) != Seal::Missing);
    let misfits = imported.map(|before| misfits(before, &text, &own, &described)).unwrap_or_default();
    // Refused before anything is written.
    refuse(&place, before.as_deref(), &misfits, args)?;
    let mut told = put_meshes(&args.out, meshes)?;
    told.push_str(&bring(&args.out, &numbers, &text, &own, before.as_deref())?);
    misfits.iter().for_each(|misfit| told.push_str(&format!("  other structure: {misfit}\n")));
    let files = Files {
        source: &provenance.source,
        diagram: &model,
        parameters: &numbers,
        robot: chain.map(|_| described.as_str()),
    };
    match (chain, &robotic) {
        (_, Some(_)) => told.push_str(&left(&args.out, &described)),
        (None, None) => {}
        (Some(chain), None) => {
            let (text, assumed) = robot(mechanism, chain, &files);
            console.say(&format!(
                "note: {} does not state {}: {described} assumes them, look through it",
                provenance.source,
                listed_in_words(&assumed)
            ));
            told.push_str(&format!("wrote {}\n", put(&args.out, &described, &text)?));
        }
    }
    match &wired {
        None => told.push_str(&format!("wrote {}\n", put(&args.out, &model, &diagram(mechanism, &files))?)),
        Some(text) => {
            told.push_str(&left(&args.out, &model));
            if files.robot.is_some_and(|robot| !text.contains(robot)) {
                told.push_str(&format!(
                    "  it does not name the robot description: add \"manipulator\": File(\"{described}\") to its parameters\n"
                ));
            }
        }
    }
    Ok(told)
}

/// Why a folder cannot be made.
fn uncreated(folder: &Path, error: &io::Error) -> Failure {
    Failure::unwritable(format!("cannot create `{}`: {error}", folder.display()))
        .help("name a folder elsewhere with --out")
}

fn left(folder: &Path, name: &str) -> String {
    format!("left {} as it is\n", folder.join(name).display())
}

/// Puts meshes beside the diagram; what is told about them.
fn put_meshes(out: &Path, files: &[MeshFile]) -> Result<String, Failure> {
    let (mut new, mut replaced) = (0, 0);
    for file in files {
        let (folder, name) = file.name.split_once('/').unwrap_or(("", &file.name));
        let folder = out.join(folder);
        fs::create_dir_all(&folder).map_err(|error| uncreated(&folder, &error))?;
        let place = folder.join(name);
        match limited_bytes(&place, file.bytes.len() as u64) {
            Ok(there) if there == file.bytes => continue,
            _ if place.exists() => replaced += 1,
            _ => new += 1,
        }
        write_whole(&folder, name, |out| out.write_all(&file.bytes))
            .map_err(|error| unwritable(&folder.join(name), &error))?;
    }
    Ok(match (new, replaced) {
        (0, 0) => String::new(),
        (new, 0) => format!("wrote {}\n", plural(new, "mesh", "meshes")),
        (0, replaced) => format!("updated {}\n", plural(replaced, "mesh", "meshes")),
        (new, replaced) => format!("wrote {}, updated {replaced}\n", plural(new, "mesh", "meshes")),
    })
}

fn plural(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// `a, b and c`, the end of long lists counted.
fn listed_in_words(words: &[String]) -> String {
    const MOST: usize = 4;
    match words {
        [] => String::new(),
        [one] => one.clone(),
        _ if words.len() > MOST => {
            format!("{} and {} more", words[..MOST].join(", "), words.len() - MOST)
        }
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn put(folder: &Path, name: &str, text: &str) -> Result<String, Failure> {
    let written = write_whole(folder, name, |out| out.write_all(text.as_bytes()));
    written.map(|path| path.display().to_string()).map_err(|error| unwritable(&folder.join(name), &error))
}

/// The text of a file; `None` if there is none.
fn existing(path: &Path) -> Result<Option<String>, Failure> {
    match limited_text(path, MOST_TEXT) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Failure::unreadable(format!("cannot read `{}`: {error}", path.display()))),
    }
}

/// Refuses to write over a parameter file that was changed by hand, or whose numbers refer to another structure.
fn refuse(place: &Path, before: Option<&str>, misfits: &[String], args: &ImportArgs) -> Result<(), Failure> {
    let Some(before) = before.filter(|_| !args.yes) else { return Ok(()) };
    let edited = match sealed(before) {
        Seal::Whole => None,
        Seal::Broken => Some("was changed since the last import"),
        Seal::Missing => Some("was not written by an import"),
    };
    let (why, help) = match edited {
        Some(why) => (why.to_owned(), "keep own numbers in another file, or overwrite this one with --yes"),
        None if misfits.is_empty() => return Ok(()),
        None => (
            format!("does not have the structure of `{}`", args.file.display()),
            "import into another folder, or change what is named here and bring the numbers in with --yes",
        ),
    };
    let failure = Failure::new(Exit::Files, "exists", format!("`{}` {why}", place.display()));
    let failure = misfits.iter().take(MOST_MISFITS).fold(failure, Failure::note);
    let failure = match misfits.len().saturating_sub(MOST_MISFITS) {
        0 => failure,
        more => failure.note(format!("and {more} more")),
    };
    Err(failure.help(format!("{help}; nothing has been written")))
}

/// Most differences of structure in one message.
const MOST_MISFITS: usize = 20;

/// What was made by another structure than the new numbers refer to, and the lines that show it.
fn misfits(before: &str, fresh: &str, wired: &[Wired], described: &str) -> Vec<String> {
    let mut told = Vec::new();
    for found in restructured(before, fresh) {
        let lines = |(file, text): &Wired| {
            let Part::Diagram(path) = &found.part else { return None };
            let lines: Vec<String> = wired_in(text, path).iter().map(ToString::to_string).collect();
            (!lines.is_empty()).then(|| format!("; {file}, line {}", lines.join(", ")))
        };
        told.push(match found.part {
            Part::Robot if wired.iter().all(|(file, _)| file != described) => continue,
            Part::Robot => format!("{}; {described}", found.what),
            _ => format!("{}{}", found.what, wired.iter().filter_map(lines).collect::<String>()),
        });
    }
    told
}

fn counts(found: &Differences) -> String {
    let Differences { added, removed, changed } = found;
    match (added.len(), removed.len(), changed.len()) {
        (0, 0, 0) => "no number differs".to_owned(),
        (a, r, c) => format!("{c} changed, {a} new, {r} gone"),
    }
}

/// What came and what went, with the lines of the files that need a hand.
fn listed(found: &Differences, before: &str, fresh: &str, wired: &[Wired]) -> String {
    let mut told = String::new();
    for path in Differences::groups(&found.added, before) {
        let known = wired.iter().any(|(_, text)| !named_in(text, &path).is_empty());
        told.push_str(&match known || wired.is_empty() {
            true => format!("  new: {path}\n"),
            false => format!("  new: {path}; the diagram does not know it\n"),
        });
    }
    for path in Differences::groups(&found.removed, fresh) {
        told.push_str(&format!("  gone: {path}"));
        for (file, text) in wired {
            let lines: Vec<String> = named_in(text, &path).iter().map(ToString::to_string).collect();
            if !lines.is_empty() {
                told.push_str(&format!("; {file} still names it, line {}", lines.join(", ")));
            }
        }
        told.push('\n');
    }
    told
}
