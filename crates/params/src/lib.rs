//! Sets of parameters (`params/*.ron`) as workbooks (`.xlsx`) and back.
//!
//! ```text
//! RON texts ─quantities─▶ Quantity ─export─▶ bytes of a workbook ─(a person)─▶ bytes
//!    ▲                                                                          │
//!    └─edited─ Comparison ◀─compare─ Reading ◀─read_tables─ Book ◀─read_book────┘
//! ```
//!
//! Everything is plain data and nothing opens a file. A workbook remembers in a hidden sheet what was exported, so
//! that a change in the sheets is told from one in the set. Only numerals are replaced in the text of a set: its
//! comments, order, units and sources stay.
//!
//! Workbooks themselves are read and written where the feature `xlsx` is on.

#[cfg(feature = "xlsx")]
mod archive;
mod arrangement;
mod book;
#[cfg(feature = "xlsx")]
mod book_read;
#[cfg(feature = "xlsx")]
mod book_write;
mod cell;
mod compare;
mod difference;
mod edit;
#[cfg(feature = "xlsx")]
mod export;
mod key;
#[cfg(feature = "xlsx")]
mod label;
mod numeral;
mod quantity;
#[cfg(feature = "xlsx")]
mod rows;
mod table;

#[cfg(feature = "xlsx")]
pub use archive::{pack, unpack};
pub use arrangement::{Arrangement, MEMORY};
pub use book::Book;
#[cfg(feature = "xlsx")]
pub use book_read::read_book;
pub use cell::{Address, Cell, Sheet, Spot};
pub use compare::{Change, Comparison, Conflict, Known, Since, compare};
pub use difference::{Difference, difference};
pub use edit::edited;
#[cfg(feature = "xlsx")]
pub use export::export;
pub use numeral::written;
pub use quantity::{Content, Quantity, SetError, quantities, quantities_at};
pub use table::{Reading, Tables, Value, read_tables};
#[cfg(feature = "xlsx")]
use {book::same_name, table::remembered_sheets};

/// Reads the sheets of a workbook that hold parameters.
///
/// # Errors
/// As [`read_book`].
#[cfg(feature = "xlsx")]
pub fn open_workbook(bytes: &[u8]) -> Result<Tables, BookError> {
    let memory = read_book(bytes, |name| name == MEMORY)?;
    Ok(match remembered_sheets(&memory) {
        Some(sheets) => {
            let wanted = |name: &str| name == MEMORY || sheets.iter().any(|sheet| same_name(sheet, name));
            read_tables(&read_book(bytes, wanted)?)
        }
        None => read_tables(&read_book(bytes, |_| true)?),
    })
}

/// Why a file is no workbook that can be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BookError {
    /// The fact, as the end of a sentence about the file.
    pub message: String,
    /// What to do.
    pub help: String,
}

#[cfg(feature = "xlsx")]
impl BookError {
    pub(crate) fn new(message: impl Into<String>, help: impl Into<String>) -> BookError {
        BookError { message: message.into(), help: help.into() }
    }
}

/// What is wrong in a workbook that can be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The sheet.
    pub sheet: String,
    /// The cell, if it is about one.
    pub cell: Option<Address>,
    /// The fact.
    pub message: String,
    /// What to do.
    pub help: String,
}

impl Fault {
    /// `(7) Motor Parameters, cell B7`.
    pub fn place(&self) -> String {
        match self.cell {
            Some(cell) => format!("{}, cell {cell}", self.sheet),
            None => self.sheet.clone(),
        }
    }
}
