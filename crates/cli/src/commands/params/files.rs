//! Sets and workbooks on the disk. What cannot be read is told here.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_diagram::{Reader, SourceFile};
#[cfg(feature = "xlsx")]
use blocksim_params::open_workbook;
use blocksim_params::{Quantity, SetError, Tables, quantities};

use crate::disk::{Disk, reason, refusal};
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::render;

/// Largest workbook that is read, in bytes.
const LARGEST: u64 = 32 << 20;

/// A set that was read.
pub struct Set {
    pub text: String,
    pub quantities: Vec<Quantity>,
}

/// Reads a set.
pub fn read_set(path: &Path, console: Console) -> Result<Set, Exit> {
    if let Some(refusal) = refusal(path) {
        console.say(&refusal);
        return Err(Exit::Files);
    }
    let text = Disk::default().read(path).map_err(|reason| {
        console.say(&format!("error: cannot read `{}`: {reason}", path.display()));
        Exit::Files
    })?;
    match quantities(&text) {
        Ok(quantities) => Ok(Set { text, quantities }),
        Err(error) => {
            tell_set_error(&error, path, &text, console);
            Err(Exit::Model)
        }
    }
}

/// Shows where a text is no set.
pub fn tell_set_error(error: &SetError, path: &Path, text: &str, console: Console) {
    let place = Place { file: FileId(0), span: error.place.clone() };
    let mut problem = Problem::error("syntax", error.message.clone()).at(&place, "");
    if let Some(help) = &error.help {
        problem = problem.help(help.clone());
    }
    let files = [SourceFile { path: path.to_owned(), text: text.into() }];
    console.say(&render::full(&problem, &files, console.colour));
}

/// Reads a workbook; what is wrong in its cells is data.
pub fn read_workbook(path: &Path, console: Console) -> Result<Tables, Exit> {
    let refuse = |said: &str, help: Option<&str>| {
        console.say(&format!("error: cannot read `{}`: {said}", path.display()));
        help.into_iter().for_each(|help| console.say(&format!("  = help: {help}")));
        Exit::Files
    };
    let bytes = bytes(path).map_err(|error| refuse(&reason(&error), None))?;
    open_workbook(&bytes).map_err(|error| refuse(&error.message, Some(&error.help)))
}

#[cfg(not(feature = "xlsx"))]
fn open_workbook(_bytes: &[u8]) -> Result<Tables, blocksim_params::BookError> {
    use crate::left_out::{help, reason};
    Err(blocksim_params::BookError { message: reason("workbooks"), help: help("xlsx") })
}

fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    if std::fs::metadata(path)?.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(LARGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST {
        return Err(io::Error::other(format!("it has more than {} MiB", LARGEST >> 20)));
    }
    Ok(bytes)
}

/// Whether a file is a workbook, by its name; anything else is a set.
pub fn is_workbook(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| {
        extension.to_str().is_some_and(|text| text.starts_with("xls") || text == "ods")
    })
}
