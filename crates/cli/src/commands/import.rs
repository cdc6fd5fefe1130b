use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use blocksim_import::{
    Differences, Mechanism, MeshFile, Provenance, diagram, differences, file_name, meshes, named_in,
    parameters, simscape, smidata, urdf,
};
use blocksim_results::{clock::iso, hash::fingerprint, write_whole};

use crate::args::import::{ImportArgs, Kind};
use crate::exit::Exit;
use crate::seal::{Seal, seal, sealed};
use crate::terminal::console::Console;

/// Makes a diagram and a parameter file of a file of another program; where both exist, only the numbers are
/// brought up to date.
///
/// # Errors
/// If the standard output cannot be written.
pub fn import(args: &ImportArgs, console: Console) -> io::Result<Exit> {
    let bytes = match fs::read(&args.file) {
        Ok(bytes) => bytes,
        Err(error) => {
            console.say(&format!("error: cannot read `{}`: {error}", args.file.display()));
            return Ok(Exit::Files);
        }
    };
    let read = match args.kind.unwrap_or_else(|| guessed(&args.file, &bytes)) {
        Kind::Urdf => urdf::read(&args.file, &bytes, args.density.is_some()),
        Kind::Simscape => simscape::read(&args.file, &bytes),
        Kind::Smidata => return numbers_only(args, &bytes, console),
    };
    let with_meshes = read.and_then(|mut mechanism| match args.no_meshes {
        true => Ok((mechanism, Vec::new())),
        false => {
            let files = meshes(&mut mechanism, &args.file, args.density, &mesh)?;
            Ok((mechanism, files))
        }
    });
    let (mechanism, files) = match with_meshes {
        Ok(read) => read,
        Err(faults) => {
            faults.iter().for_each(|fault| console.say(&format!("error: {fault}\n")));
            return Ok(Exit::Model);
        }
    };
    mechanism.notes.iter().for_each(|note| console.say(&format!("note: {note}")));
    match write(args, &mechanism, &files, &bytes) {
        Ok(told) => {
            console.data(&told)?;
            Ok(Exit::Done)
        }
        Err(refusal) => {
            console.say(&format!("error: {refusal}"));
            Ok(Exit::Files)
        }
    }
}

/// Reads a mesh, within bounds.
fn mesh(path: &Path) -> io::Result<Vec<u8>> {
    const LARGEST: u64 = 256 << 20;
    match fs::metadata(path)?.len() {
        size if size > LARGEST => Err(io::Error::other(format!("it has more than {} MiB", LARGEST >> 20))),
        _ => fs::read(path),
    }
}

/// What a file is by its ending and its first element.
fn guessed(file: &Path, bytes: &[u8]) -> Kind {
    const BEGINNING: usize = 2000;
    let beginning = String::from_utf8_lossy(&bytes[..bytes.len().min(BEGINNING)]);
    match file.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("m") => Kind::Smidata,
        _ if beginning.contains("<SimscapeMultibodyImportXML") => Kind::Simscape,
        _ => Kind::Urdf,
    }
}

/// Imports a data file: its numbers without a diagram.
fn numbers_only(args: &ImportArgs, bytes: &[u8], console: Console) -> io::Result<Exit> {
    let data = match smidata::read(&args.file, bytes) {
        Ok(data) => data,
        Err(faults) => {
            faults.iter().for_each(|fault| console.say(&format!("error: {fault}\n")));
            return Ok(Exit::Model);
        }
    };
    data.notes.iter().for_each(|note| console.say(&format!("note: {note}")));
    let (provenance, stem) = about(args, bytes);
    match bring(&args.out, &format!("{stem}.ron"), &smidata::parameters(&data, &provenance), None, args.yes) {
        Ok(told) => {
            console.data(&told)?;
            Ok(Exit::Done)
        }
        Err(refusal) => {
            console.say(&format!("error: {refusal}"));
            Ok(Exit::Files)
        }
    }
}

/// Where the numbers come from, and what files of them are called.
fn about(args: &ImportArgs, bytes: &[u8]) -> (Provenance, String) {
    let source = args.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = file_name(&args.file.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default());
    let date = iso(SystemTime::now())[..10].to_owned();
    (Provenance { source, fingerprint: fingerprint(bytes), date }, stem)
}

/// Writes a parameter file, or a newer one in its place; what is told about it.
fn bring(
    folder: &Path,
    name: &str,
    text: &str,
    wired: Option<&str>,
    replace: bool,
) -> Result<String, String> {
    fs::create_dir_all(folder).map_err(|error| format!("cannot create `{}`: {error}", folder.display()))?;
    let before = old(&folder.join(name), replace)?;
    let fresh = seal(text);
    let path = put(folder, name, &fresh)?;
    Ok(match before {
        None => format!("wrote {path}\n"),
        Some(before) => {
            let found = differences(&before, &fresh);
            format!("updated {path}: {}\n{}", counts(&found), listed(&found, &before, &fresh, wired))
        }
    })
}

/// Writes both files; what is told about it, or why not.
fn write(
    args: &ImportArgs,
    mechanism: &Mechanism,
    files: &[MeshFile],
    bytes: &[u8],
) -> Result<String, String> {
    let (provenance, stem) = about(args, bytes);
    let (numbers, model) = (format!("{stem}_parameters.ron"), format!("{stem}.ron"));
    // Refused before anything is written.
    old(&args.out.join(&numbers), args.yes)?;
    let wired = existing(&args.out.join(&model))?;
    let mut told = String::new();
    for file in files {
        let (folder, name) = file.name.split_once('/').unwrap_or(("", &file.name));
        let folder = args.out.join(folder);
        fs::create_dir_all(&folder)
            .map_err(|error| format!("cannot create `{}`: {error}", folder.display()))?;
        // What is there already need not be written.
        if !fs::read(folder.join(name)).is_ok_and(|there| there == file.bytes) {
            write_whole(&folder, name, |out| out.write_all(&file.bytes))
                .map_err(|error| error.to_string())?;
        }
    }
    if !files.is_empty() {
        told.push_str(&format!("wrote {} meshes\n", files.len()));
    }
    let text = parameters(mechanism, &provenance);
    told.push_str(&bring(&args.out, &numbers, &text, wired.as_deref(), args.yes)?);
    match wired {
        None => {
            let text = diagram(mechanism, &numbers, &provenance.source);
            told.push_str(&format!("wrote {}\n", put(&args.out, &model, &text)?));
        }
        Some(_) => told.push_str(&format!("left {} as it is\n", args.out.join(&model).display())),
    }
    Ok(told)
}

fn put(folder: &Path, name: &str, text: &str) -> Result<String, String> {
    let written = write_whole(folder, name, |out| out.write_all(text.as_bytes()));
    written.map(|path| path.display().to_string()).map_err(|error| error.to_string())
}

/// The text of a file; `None` if there is none.
fn existing(path: &PathBuf) -> Result<Option<String>, String> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(format!("cannot read `{}`: {error}", path.display())),
    }
}

/// The parameter file of the last import, unless somebody has changed it since.
fn old(path: &PathBuf, replace: bool) -> Result<Option<String>, String> {
    let Some(text) = existing(path)? else { return Ok(None) };
    let why = match sealed(&text) {
        Seal::Whole => return Ok(Some(text)),
        Seal::Broken => "was changed since the last import",
        Seal::Missing => "was not written by an import",
    };
    if replace {
        return Ok(Some(text));
    }
    let help = "keep own numbers in another file, or overwrite this one with --yes; nothing has been written";
    Err(format!("`{}` {why}\n  = help: {help}", path.display()))
}

fn counts(found: &Differences) -> String {
    let Differences { added, removed, changed } = found;
    match (added.len(), removed.len(), changed.len()) {
        (0, 0, 0) => "no number differs".to_owned(),
        (a, r, c) => format!("{c} changed, {a} new, {r} gone"),
    }
}

/// What came and what went, with the lines of the diagram that need a hand.
fn listed(found: &Differences, before: &str, fresh: &str, wired: Option<&str>) -> String {
    let mut told = String::new();
    for path in Differences::groups(&found.added, before) {
        told.push_str(&format!("  new: {path}; the diagram does not know it\n"));
    }
    for path in Differences::groups(&found.removed, fresh) {
        let lines: Vec<String> = wired
            .map(|text| named_in(text, &path))
            .unwrap_or_default()
            .iter()
            .map(ToString::to_string)
            .collect();
        match lines.is_empty() {
            true => told.push_str(&format!("  gone: {path}\n")),
            false => told.push_str(&format!(
                "  gone: {path}; the diagram still names it, line {}\n",
                lines.join(", ")
            )),
        }
    }
    told
}
