//! The quantities of a workbook, found by the texts of its rows and columns, and what is wrong with its cells.

use std::collections::BTreeMap;

use crate::Fault;
use crate::arrangement::{MEMORY, key_words};
use crate::book::{Book, same_name};
use crate::cell::{Address, Cell, Sheet, Spot};
use crate::key::{is_value_heading, path_of};
use crate::numeral;

/// A quantity as a workbook has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Cell of the value.
    pub spot: Spot,
    /// The value; `None` for a faulty cell, which is among the faults, or an empty one.
    pub value: Option<Value>,
    /// Unit of the row.
    pub unit: String,
    /// Cell of the unit.
    pub unit_cell: Address,
}

/// A value in a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// In the unit of the row.
    Number(f64),
    /// A text that is not a number; an expression of the set stands so.
    Text(String, Fault),
}

/// What the sheets of a workbook say.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tables {
    /// By path.
    pub readings: BTreeMap<String, Reading>,
    /// Numbers and units at the time of the export; `None` without the hidden sheet.
    pub remembered: Option<BTreeMap<String, (Option<f64>, String)>>,
    /// Sheets in which quantities stood when they were exported, by path.
    pub homes: BTreeMap<String, String>,
    /// Fingerprint of the set that was exported.
    pub fingerprint: Option<String>,
    /// Exported sheets that are missing.
    pub missing: Vec<String>,
    /// Everything wrong.
    pub faults: Vec<Fault>,
}

/// The sheets that the hidden sheet names; `None` without it, or if it is older than such names.
pub(crate) fn remembered_sheets(book: &Book) -> Option<Vec<String>> {
    let memory = book.sheet(MEMORY)?;
    // A quantity of this name has a sheet in the fourth column.
    let text = |row, column| memory.text(Address { row, column });
    let is_name = |row| text(row, 0) == Some("sheet") && text(row, 3).is_none();
    let rows = memory.cells.keys().filter(|at| at.column == 0 && is_name(at.row));
    let names: Vec<String> = rows.filter_map(|at| text(at.row, 1)).map(str::to_owned).collect();
    (!names.is_empty()).then_some(names)
}

/// Reads the exported sheets and the hidden one. Without that, all sheets with a column of keys are read.
pub fn read_tables(book: &Book) -> Tables {
    let mut tables = Tables::default();
    let Some(exported) = remembered_sheets(book) else {
        for sheet in book.sheets.iter().filter(|sheet| !same_name(&sheet.name, MEMORY)) {
            if headings(sheet).is_some() {
                read_sheet(sheet, &mut tables);
            }
        }
        if tables.readings.is_empty() && tables.faults.is_empty() {
            let help = "put the heading `Key` back over the columns of keys, or export the set anew";
            tables.faults.push(fault("the workbook", None, "no sheet has a column of keys", help));
        }
        if let Some(sheet) = book.sheet(MEMORY) {
            read_memory(sheet, &mut tables);
        }
        return tables;
    };
    for name in &exported {
        match book.sheet(name) {
            Some(sheet) => read_sheet(sheet, &mut tables),
            None => {
                let known = book.names.iter().filter(|known| !exported.contains(known) && *known != MEMORY);
                let near = blocksim_signal::closest(name, known.map(String::as_str));
                let help = match near {
                    Some(near) => format!("name the sheet `{near}` so again, or export the set anew"),
                    None => "put the sheet back or export the set anew".to_owned(),
                };
                tables.missing.push(name.clone());
                tables.faults.push(fault(name, None, "the sheet is missing", &help));
            }
        }
    }
    if let Some(sheet) = book.sheet(MEMORY) {
        read_memory(sheet, &mut tables);
    }
    tables
}

fn fault(sheet: &str, cell: Option<Address>, message: impl Into<String>, help: &str) -> Fault {
    Fault { sheet: sheet.to_owned(), cell, message: message.into(), help: help.to_owned() }
}

/// Rows above the headings that are searched for them.
const SEARCHED: u32 = 50;

/// The cell with the heading of the keys.
fn headings(sheet: &Sheet) -> Option<Address> {
    let mut cells = sheet.cells.keys().filter(|at| at.row < SEARCHED);
    cells.find(|at| sheet.text(**at) == Some("Key")).copied()
}

fn read_sheet(sheet: &Sheet, tables: &mut Tables) {
    let Some(Address { row: top, column: keys }) = headings(sheet) else {
        let help = "put the heading `Key` back over the column of keys, or export the set anew";
        tables.faults.push(fault(&sheet.name, None, "the row of headings is missing", help));
        return;
    };
    for &(first, last) in sheet.merged.iter().filter(|(_, last)| last.row >= top) {
        let message = format!("the cells {first}:{last} are merged");
        tables.faults.push(fault(&sheet.name, Some(first), message, "unmerge them and fill in each"));
    }
    let row_of = |row| sheet.cells.range(Address { row, column: 0 }..Address { row: row + 1, column: 0 });
    let columns: Vec<(u32, &str)> =
        row_of(top).filter_map(|(at, _)| Some((at.column, sheet.text(*at)?))).collect();
    let units = columns.iter().find(|(_, heading)| *heading == "Unit").map(|(column, _)| *column);
    let Some(units) = units else {
        let help = "put the heading `Unit` back over the column of units, or export the set anew";
        tables.faults.push(fault(&sheet.name, None, "the column of units is missing", help));
        return;
    };
    let rows: Vec<(u32, &str)> = sheet
        .cells
        .keys()
        .filter(|at| at.column == keys && at.row > top)
        .filter_map(|at| Some((at.row, sheet.text(*at)?)))
        .collect();
    let words = key_words(&rows);
    for (row, key) in rows {
        let unit_cell = Address { row, column: units };
        let unit = match sheet.cells.get(&unit_cell) {
            None => String::new(),
            Some(Cell::Text(text)) => text.trim().to_owned(),
            // A person may write the unit of plain numbers as a number.
            Some(Cell::Number(1.0)) => "1".to_owned(),
            Some(_) => {
                let help = "write a unit such as deg/s, or nothing for a plain number";
                tables.faults.push(fault(&sheet.name, Some(unit_cell), "this is not a unit", help));
                continue;
            }
        };
        for &(column, heading) in columns.iter().filter(|(_, heading)| is_value_heading(heading, &words)) {
            let cell = Address { row, column };
            let Some(path) = path_of(key, heading) else {
                if sheet.cells.contains_key(&cell) {
                    let message = format!("`{key}` has no value under `{heading}`");
                    tables.faults.push(fault(&sheet.name, Some(cell), message, "empty the cell"));
                }
                continue;
            };
            let value = match sheet.cells.get(&cell).map(value) {
                None => None,
                Some(Ok(value)) => Some(value),
                Some(Err((message, help, text))) => {
                    let fault = fault(&sheet.name, Some(cell), message, &help);
                    match text {
                        Some(text) => Some(Value::Text(text, fault)),
                        None => {
                            tables.faults.push(fault);
                            continue;
                        }
                    }
                }
            };
            let spot = Spot { sheet: sheet.name.trim().to_owned(), cell };
            let reading = Reading { spot, value, unit: unit.clone(), unit_cell };
            if let Some(first) = tables.readings.get(&path).filter(|first| first.value.is_some()) {
                if reading.value.is_some() {
                    let message =
                        format!("`{path}` stands here and in {}, cell {}", first.spot.sheet, first.spot.cell);
                    tables.faults.push(fault(&sheet.name, Some(cell), message, "delete one of the rows"));
                }
                continue;
            }
            tables.readings.insert(path, reading);
        }
    }
}

type Wrong = (String, String, Option<String>);

/// The number of a cell, or what is wrong with it and, for a text, that text.
fn value(cell: &Cell) -> Result<Value, Wrong> {
    let fail = |message: &str, help: &str| Err((message.to_owned(), help.to_owned(), None));
    match cell {
        Cell::Number(number) => Ok(Value::Number(*number)),
        Cell::Text(text) => match numeral::read(text) {
            Ok(number) => Ok(Value::Number(number)),
            Err((message, help)) => Err((message, help, Some(text.trim().to_owned()))),
        },
        Cell::Error(error) => Err((
            format!("the formula fails with {error}"),
            "repair the formula or write the number".to_owned(),
            None,
        )),
        Cell::Date => {
            fail("the cell is shown as a date", "format the cell as a number and write the number again")
        }
        Cell::Bool => fail("this is TRUE or FALSE", "write a number"),
        Cell::NotComputed => fail(
            "the formula has no result",
            "open the workbook in Excel or LibreOffice and save it, or write the number",
        ),
        Cell::External => fail("the formula takes from another workbook", "write the number itself"),
    }
}

fn read_memory(sheet: &Sheet, tables: &mut Tables) {
    let mut remembered = BTreeMap::new();
    let rows: Vec<u32> = sheet.cells.keys().filter(|at| at.column == 0).map(|at| at.row).collect();
    let mut broken = false;
    for row in rows {
        let text = |column| sheet.text(Address { row, column });
        if let (Some(path), Some(home)) = (text(0), text(3)) {
            tables.homes.insert(path.to_owned(), home.to_owned());
        }
        let is_quantity = text(3).is_some();
        match (text(0), text(1)) {
            (Some("fingerprint"), found) if !is_quantity => tables.fingerprint = found.map(str::to_owned),
            (Some("set" | "sheet"), _) if !is_quantity => {}
            (Some(path), Some("expression")) => {
                remembered.insert(path.to_owned(), (None, text(2).unwrap_or_default().to_owned()));
            }
            (Some(path), Some(number)) => match number.parse::<f64>() {
                Ok(number) if number.is_finite() => {
                    remembered
                        .insert(path.to_owned(), (Some(number), text(2).unwrap_or_default().to_owned()));
                }
                _ => broken = true,
            },
            _ => broken = true,
        }
    }
    if broken || tables.fingerprint.is_none() {
        let help = "delete this hidden sheet; all cells are then compared with the set as it is now";
        tables.faults.push(fault(MEMORY, None, "the memory of the export was changed", help));
    } else {
        tables.remembered = Some(remembered);
    }
}
