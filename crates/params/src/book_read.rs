//! A workbook (`.xlsx`, ECMA-376) from bytes: names of all sheets, cells of those that are asked for.
//!
//! Memory is bounded whatever the file says: parts are unpacked up to a limit, and a sheet that has more cells than
//! any set of parameters is refused.

use std::collections::{BTreeMap, BTreeSet};

use crate::archive_read::{Archive, open};
use crate::cell::{Address, Cell, Sheet};
use crate::xml::{Piece, attribute, each};
use crate::{BookError, shared};

/// Most cells with content in a workbook.
const MOST_CELLS: usize = 100_000;

/// A workbook.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Book {
    /// Sheets that were asked for, in their order.
    pub sheets: Vec<Sheet>,
    /// Names of all sheets.
    pub names: Vec<String>,
}

impl Book {
    /// A sheet by its name; capitals and blanks around it do not count.
    pub fn sheet(&self, name: &str) -> Option<&Sheet> {
        self.sheets.iter().find(|sheet| same_name(&sheet.name, name))
    }
}

fn same_name(a: &str, b: &str) -> bool {
    a.trim().eq_ignore_ascii_case(b.trim())
}

/// Reads the sheets of these names; others may be anything.
///
/// # Errors
/// The file is no `.xlsx`, is cut off, has a password, is damaged, or is larger than any set of parameters.
pub fn read_book(bytes: &[u8], wanted: &[&str]) -> Result<Book, BookError> {
    let archive = open(bytes)?;
    if archive.has("xl/workbook.bin") {
        return Err(BookError::new("it is an .xlsb", "save it as .xlsx"));
    }
    if archive.has("content.xml") {
        return Err(BookError::new("it is an OpenDocument sheet (.ods)", "save it as .xlsx"));
    }
    let listed = sheets(&archive)?;
    let targets = targets(&archive)?;
    let shared = shared::strings(&archive)?;
    let dates = shared::date_styles(&archive)?;
    let mut book = Book { names: listed.iter().map(|(name, _)| name.clone()).collect(), sheets: Vec::new() };
    let mut left = MOST_CELLS;
    for (name, id) in listed {
        if !wanted.iter().any(|wanted| same_name(wanted, &name)) || book.sheet(&name).is_some() {
            continue;
        }
        let target = targets.get(&id).ok_or_else(|| {
            BookError::new(format!("the sheet `{name}` is listed but not there"), "save the workbook again")
        })?;
        let sheet = sheet(&archive, name, target, &shared, &dates, &mut left)?;
        book.sheets.push(sheet);
    }
    Ok(book)
}

/// Names and relations of the sheets.
fn sheets(archive: &Archive) -> Result<Vec<(String, String)>, BookError> {
    const PART: &str = "xl/workbook.xml";
    let mut found = Vec::new();
    each(PART, &archive.text(PART)?, |piece| {
        if let Piece::Start(tag, attributes) = piece
            && tag == "sheet"
            && let (Some(name), Some(id)) = (attribute(&attributes, "name"), attribute(&attributes, "id"))
        {
            found.push((name.to_owned(), id.to_owned()));
        }
        Ok(())
    })?;
    Ok(found)
}

/// Parts by relation.
fn targets(archive: &Archive) -> Result<BTreeMap<String, String>, BookError> {
    const PART: &str = "xl/_rels/workbook.xml.rels";
    let mut found = BTreeMap::new();
    each(PART, &archive.text(PART)?, |piece| {
        if let Piece::Start(tag, attributes) = piece
            && tag == "Relationship"
            && let (Some(id), Some(target)) = (attribute(&attributes, "Id"), attribute(&attributes, "Target"))
        {
            let path = match target.strip_prefix('/') {
                Some(absolute) => absolute.to_owned(),
                None => format!("xl/{target}"),
            };
            found.insert(id.to_owned(), path);
        }
        Ok(())
    })?;
    Ok(found)
}

/// A cell while it is being read.
#[derive(Default)]
struct Open {
    address: Option<Address>,
    kind: String,
    style: usize,
    value: String,
    formula: Option<String>,
    has_value: bool,
}

fn sheet(
    archive: &Archive,
    name: String,
    part: &str,
    shared: &[String],
    dates: &BTreeSet<usize>,
    left: &mut usize,
) -> Result<Sheet, BookError> {
    let mut sheet = Sheet { name, ..Sheet::default() };
    let mut open: Option<Open> = None;
    let mut next = Address { row: 0, column: 0 };
    // Which text is meant: the value, the formula, or none such as that of a phonetic guide.
    let mut within = "";
    each(part, &archive.text(part)?, |piece| {
        match piece {
            Piece::Start(tag, attributes) => match tag.as_str() {
                "row" => {
                    let row = attribute(&attributes, "r").and_then(|row| row.parse::<u32>().ok());
                    next = Address { row: row.map_or(next.row, |row| row.saturating_sub(1)), column: 0 };
                }
                "c" => {
                    let address = match attribute(&attributes, "r") {
                        Some(written) => Address::parse(written),
                        None => Some(next),
                    };
                    open = Some(Open {
                        address,
                        kind: attribute(&attributes, "t").unwrap_or("n").to_owned(),
                        style: attribute(&attributes, "s").and_then(|style| style.parse().ok()).unwrap_or(0),
                        ..Open::default()
                    });
                }
                "v" | "t" => within = "v",
                "f" => {
                    within = "f";
                    open.iter_mut().for_each(|cell| cell.formula = Some(String::new()));
                }
                "rPh" => within = "",
                "mergeCell" => {
                    let area = attribute(&attributes, "ref").and_then(|area| area.split_once(':'));
                    let corners = area.and_then(|(a, b)| Some((Address::parse(a)?, Address::parse(b)?)));
                    if let Some(corners) = corners.filter(|_| sheet.merged.len() < MOST_CELLS) {
                        sheet.merged.push(corners);
                    }
                }
                _ => {}
            },
            Piece::Text(text) => {
                if let Some(cell) = &mut open {
                    match within {
                        "v" => {
                            cell.has_value = true;
                            cell.value.push_str(&text);
                        }
                        "f" => cell.formula.iter_mut().for_each(|formula| formula.push_str(&text)),
                        _ => {}
                    }
                }
            }
            Piece::End(tag) => match tag.as_str() {
                "v" | "t" | "f" | "rPh" => within = "",
                "row" => next = Address { row: next.row.saturating_add(1), column: 0 },
                "c" => {
                    let Some(cell) = open.take() else { return Ok(()) };
                    let Some(address) = cell.address else {
                        let message = format!("the sheet `{}` has a cell at no place", sheet.name);
                        return Err(BookError::new(message, "save the workbook again"));
                    };
                    next = Address { column: address.column.saturating_add(1), ..address };
                    if let Some(content) = content(cell, shared, dates) {
                        *left = left.checked_sub(1).ok_or_else(|| {
                            BookError::new(
                                format!("it has more than {MOST_CELLS} cells that are not empty"),
                                "a set of parameters has far fewer; delete what is not part of it, or export anew",
                            )
                        })?;
                        sheet.cells.insert(address, content);
                    }
                }
                _ => {}
            },
        }
        Ok(())
    })?;
    Ok(sheet)
}

/// What a cell holds; `None` for an empty one.
fn content(cell: Open, shared: &[String], dates: &BTreeSet<usize>) -> Option<Cell> {
    // Excel writes a reference to another workbook as `[1]Sheet!A1`.
    if cell.formula.as_deref().is_some_and(|formula| formula.contains('[')) {
        return Some(Cell::External);
    }
    if !cell.has_value {
        return cell.formula.map(|_| Cell::NotComputed);
    }
    let text = |text: String| (!text.trim().is_empty()).then_some(Cell::Text(text));
    match cell.kind.as_str() {
        "s" => text(shared.get(cell.value.trim().parse::<usize>().ok()?)?.clone()),
        "str" | "inlineStr" => text(cell.value),
        "e" => Some(Cell::Error(cell.value)),
        "b" => Some(Cell::Bool),
        "d" => Some(Cell::Date),
        _ if dates.contains(&cell.style) => Some(Cell::Date),
        _ => match cell.value.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Some(Cell::Number(number)),
            _ => text(cell.value),
        },
    }
}
