//! `blocksim import`: files of other programs become diagrams, parameters and descriptions of robots.

mod files;

use std::io;
use std::path::Path;

use blocksim_block::problem::Problem;
use blocksim_import::simscape::DataFile;
use blocksim_import::{Fault, chain, meshes, simscape, smidata, urdf};
use blocksim_recording::{MOST_TEXT, limited_bytes};

use crate::args::import::{ImportArgs, Kind};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use files::{Source, numbers, write};

/// Makes a diagram and a parameter file of a file of another program; where both exist, only the numbers are
/// brought up to date.
///
/// # Errors
/// What cannot be read, understood or written.
pub fn import(args: &ImportArgs, console: Console) -> Outcome {
    console.data(&imported(args, console)?)?;
    Ok(Exit::Done)
}

fn imported(args: &ImportArgs, console: Console) -> Result<String, Failure> {
    let faulty =
        |faults: Vec<Fault>| Failure::of(Exit::Model, faults.iter().map(problem).collect(), Vec::new());
    let bytes = read(&args.file)?;
    let kind = args.kind.unwrap_or_else(|| guessed(&args.file, &bytes));
    let data = match (&args.data, kind) {
        (None, _) => None,
        (Some(file), Kind::Simscape) => Some((file, read(file)?)),
        (Some(_), _) => {
            let said = Failure::usage("--data belongs to an assembly (import XML)");
            return Err(said.help("name the .xml file, or leave --data out"));
        }
    };
    let mut sources = vec![Source { file: &args.file, bytes: &bytes }];
    sources.extend(data.as_ref().map(|(file, bytes)| Source { file, bytes }));
    let mut mechanism = match (kind, &data) {
        (Kind::Urdf, _) => urdf::read(&args.file, &bytes, args.density.is_some()).map_err(faulty)?,
        (Kind::Simscape, None) => {
            beside(&args.file).iter().for_each(|note| console.say(note));
            simscape::read(&args.file, &bytes).map_err(faulty)?
        }
        (Kind::Simscape, Some((file, bytes_of_data))) => {
            let data = smidata::read(file, bytes_of_data).map_err(faulty)?;
            data.notes.iter().for_each(|note| console.say(&format!("note: {note}")));
            simscape::read_with(&args.file, &bytes, Some(DataFile { file, data: &data })).map_err(faulty)?
        }
        (Kind::Smidata, _) => {
            let data = smidata::read(&args.file, &bytes).map_err(faulty)?;
            data.notes.iter().for_each(|note| console.say(&format!("note: {note}")));
            return numbers(args, &data, &sources);
        }
    };
    let files = match args.no_meshes {
        true => Vec::new(),
        false => meshes(&mut mechanism, &args.file, args.density, &mesh).map_err(faulty)?,
    };
    mechanism.notes.iter().for_each(|note| console.say(&format!("note: {note}")));
    let chain = match (chain(&mechanism, args.tip.as_deref()), &args.tip) {
        (Ok(chain), _) => Some(chain),
        (Err(reason), Some(_)) => return Err(Failure::usage(format!("no robot description: {reason}"))),
        (Err(reason), None) => {
            console.say(&format!("note: no robot description: {reason}"));
            None
        }
    };
    chain.iter().flat_map(|chain| &chain.notes).for_each(|note| console.say(&format!("note: {note}")));
    write(args, &mechanism, chain.as_ref(), &files, &sources, console)
}

/// A fault of a file that is no text of ours.
fn problem(fault: &Fault) -> Problem {
    let line = fault.line.map(|line| format!(":{line}")).unwrap_or_default();
    Problem::error("import", format!("{}{line}: {}", fault.file.display(), fault.reason)).help(&*fault.remedy)
}

fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    limited_bytes(file, MOST_TEXT).map_err(|error| {
        Failure::unreadable(format!("cannot read `{}`: {error}", file.display()))
            .help("check the name of the file")
    })
}

/// A note where a data file lies beside an assembly, which is not read unasked.
fn beside(file: &Path) -> Option<String> {
    let name = format!("{}_DataFile.m", file.file_stem()?.to_string_lossy());
    let data = file.with_file_name(name);
    data.is_file()
        .then(|| format!("note: {} lies beside it and is not read; name it with --data", data.display()))
}

/// Reads a mesh, within bounds.
fn mesh(path: &Path) -> io::Result<Vec<u8>> {
    limited_bytes(path, MOST_TEXT)
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
