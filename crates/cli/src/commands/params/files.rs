//! Sets and workbooks on the disk.

use std::path::Path;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_diagram::{Reader, SourceFile};
#[cfg(feature = "xlsx")]
use blocksim_params::open_workbook;
use blocksim_params::{Quantity, SetError, Tables, quantities};
use blocksim_results::limited_bytes;

use crate::disk::{Disk, readable, reason};
use crate::exit::Exit;
use crate::failure::Failure;

/// Largest workbook that is read, in bytes.
const LARGEST: u64 = 32 << 20;

/// A set that was read.
pub struct Set {
    pub text: String,
    pub quantities: Vec<Quantity>,
}

/// Reads a set.
///
/// # Errors
/// Why it cannot be read.
pub fn read_set(path: &Path) -> Result<Set, Failure> {
    readable(path)?;
    let text = Disk::default()
        .read(path)
        .map_err(|reason| Failure::unreadable(format!("cannot read `{}`: {reason}", path.display())))?;
    match quantities(&text) {
        Ok(quantities) => Ok(Set { text, quantities }),
        Err(error) => Err(set_error(&error, path, &text)),
    }
}

/// Where a text is no set.
pub fn set_error(error: &SetError, path: &Path, text: &str) -> Failure {
    let place = Place { file: FileId(0), span: error.place.clone() };
    let mut problem = Problem::error("syntax", error.message.clone()).at(&place, "");
    if let Some(help) = &error.help {
        problem = problem.help(help.clone());
    }
    Failure::of(Exit::Model, vec![problem], vec![SourceFile { path: path.to_owned(), text: text.into() }])
}

/// Reads a workbook; what is wrong in its cells is data.
///
/// # Errors
/// Why the file cannot be read.
pub fn read_workbook(path: &Path) -> Result<Tables, Failure> {
    let refuse = |said: &str| Failure::unreadable(format!("cannot read `{}`: {said}", path.display()));
    let bytes = limited_bytes(path, LARGEST).map_err(|error| refuse(&reason(&error)))?;
    open_workbook(&bytes).map_err(|error| refuse(&error.message).help(error.help))
}

#[cfg(not(feature = "xlsx"))]
fn open_workbook(_bytes: &[u8]) -> Result<Tables, blocksim_params::BookError> {
    use crate::left_out::{help, reason};
    Err(blocksim_params::BookError { message: reason("workbooks"), help: help("xlsx") })
}

/// Whether a file is a workbook, by its name; anything else is a set.
pub fn is_workbook(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| {
        extension.to_str().is_some_and(|text| text.starts_with("xls") || text == "ods")
    })
}
