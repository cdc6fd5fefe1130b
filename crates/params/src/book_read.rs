//! A workbook (`.xlsx`) from bytes: names of all sheets, cells of those that are asked for.
//!
//! Memory is bounded whatever the file says: the archive is looked at before (`archive.rs`), cells are streamed, and a
//! workbook that has more cells than any set of parameters is refused.

use std::io::Cursor;

use calamine::{DataRef, Reader, Xlsx, XlsxError, XlsxFormulaMetadata};

use crate::BookError;
use crate::archive::inspect;
use crate::book::Book;
use crate::cell::{Address, Cell, Sheet};

/// Most cells with content in a workbook.
const MOST_CELLS: usize = 100_000;

type Open<'a> = Xlsx<Cursor<&'a [u8]>>;

/// Reads the sheets of these names; others may be anything.
///
/// # Errors
/// The file is no `.xlsx`, is cut off, has a password, is damaged, or is larger than any set of parameters.
pub fn read_book(bytes: &[u8], wanted: impl Fn(&str) -> bool) -> Result<Book, BookError> {
    inspect(bytes)?;
    let mut open: Open = Xlsx::new(Cursor::new(bytes)).map_err(|error| damaged("the workbook", &error))?;
    let mut book = Book { names: open.sheet_names(), sheets: Vec::new() };
    let mut left = MOST_CELLS;
    for name in book.names.clone() {
        if wanted(&name) && book.sheet(&name).is_none() {
            book.sheets.push(sheet(&mut open, name, &mut left)?);
        }
    }
    Ok(book)
}

fn damaged(what: &str, error: &XlsxError) -> BookError {
    BookError::new(format!("{what} is damaged: {error}"), "save it again in Excel or LibreOffice")
}

fn sheet(open: &mut Open, name: String, left: &mut usize) -> Result<Sheet, BookError> {
    let fault = |error: XlsxError| damaged(&format!("the sheet `{name}`"), &error);
    let mut sheet = Sheet { name: name.clone(), ..Sheet::default() };
    let corner = |(row, column)| Address { row, column };
    for area in open.merge_cells_by_sheet_name(&name).map_err(fault)?.into_iter().take(MOST_CELLS) {
        sheet.merged.push((corner(area.start), corner(area.end)));
    }
    let mut cells = open.worksheet_cells_reader(&name).map_err(fault)?;
    // Shared formulas stay as they are: to expand them may take memory without bounds.
    while let Some(cell) = cells.next_cell_with_formula_metadata().map_err(fault)? {
        let Some(content) = content(&cell.value, cell.formula.as_ref()) else { continue };
        *left = left.checked_sub(1).ok_or_else(|| {
            BookError::new(
                format!("it has more than {MOST_CELLS} cells that are not empty"),
                "a set of parameters has far fewer; delete what is not part of it, or export anew",
            )
        })?;
        sheet.cells.insert(corner(cell.pos), content);
    }
    Ok(sheet)
}

/// What a cell holds; `None` for an empty one.
fn content(value: &DataRef, formula: Option<&XlsxFormulaMetadata>) -> Option<Cell> {
    // Excel writes a reference to another workbook as `[1]Sheet!A1`.
    if let Some(XlsxFormulaMetadata::Normal { formula } | XlsxFormulaMetadata::Shared { formula, .. }) =
        formula
        && formula.contains('[')
    {
        return Some(Cell::External);
    }
    let text = |text: &str| (!text.trim().is_empty()).then(|| Cell::Text(text.to_owned()));
    match value {
        DataRef::Empty => formula.map(|_| Cell::NotComputed),
        DataRef::Int(number) => Some(Cell::Number(*number as f64)),
        DataRef::Float(number) if number.is_finite() => Some(Cell::Number(*number)),
        DataRef::Float(number) => text(&number.to_string()),
        DataRef::String(written) => text(written),
        DataRef::SharedString(written) => text(written),
        DataRef::Bool(_) => Some(Cell::Bool),
        DataRef::DateTime(_) | DataRef::DateTimeIso(_) | DataRef::DurationIso(_) => Some(Cell::Date),
        DataRef::Error(error) => Some(Cell::Error(error.to_string())),
    }
}
