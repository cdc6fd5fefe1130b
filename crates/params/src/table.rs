//! The quantities of a workbook, found by the texts of its rows and columns, and what is wrong with its cells.

use std::collections::BTreeMap;

use crate::Fault;
use crate::book::Book;
use crate::cell::{Address, Cell, Sheet};
use crate::layout::{MEMORY, SHEETS, is_value_heading, path_of};
use crate::numeral;

/// A quantity as a workbook has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Number of the sheet, from 0.
    pub sheet: usize,
    /// Cell of the value.
    pub cell: Address,
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
    /// A text that is no number; an expression of the set stands so.
    Text(String, Fault),
}

/// What the sheets of a workbook say.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tables {
    /// By path.
    pub readings: BTreeMap<String, Reading>,
    /// Numbers and units at the time of the export; `None` without the hidden sheet.
    pub remembered: Option<BTreeMap<String, (Option<f64>, String)>>,
    /// Fingerprint of the set that was exported.
    pub fingerprint: Option<String>,
    /// Sheets of the nine that are missing, by number.
    pub missing: Vec<usize>,
    /// Everything wrong.
    pub faults: Vec<Fault>,
}

/// Reads the nine sheets and the hidden one.
pub fn read_tables(book: &Book) -> Tables {
    let mut tables = Tables::default();
    for (number, name) in SHEETS.iter().enumerate() {
        match book.sheet(name) {
            Some(sheet) => read_sheet(sheet, number, &mut tables),
            None => {
                let known = book.names.iter().map(String::as_str);
                let near = blocksim_signal::closest(name, known.filter(|known| !SHEETS.contains(known)));
                let help = match near {
                    Some(near) => format!("name the sheet `{near}` so again, or export the set anew"),
                    None => "put the sheet back or export the set anew".to_owned(),
                };
                tables.missing.push(number);
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

fn read_sheet(sheet: &Sheet, number: usize, tables: &mut Tables) {
    let headings = sheet.cells.iter().find(|(at, _)| at.row < SEARCHED && sheet.text(**at) == Some("Key"));
    let Some((&Address { row: top, column: keys }, _)) = headings else {
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
    for (row, key) in rows {
        let unit_cell = Address { row, column: units };
        let unit = match sheet.cells.get(&unit_cell) {
            None => String::new(),
            Some(Cell::Text(text)) => text.trim().to_owned(),
            // A person may write the unit of plain numbers as a number.
            Some(Cell::Number(1.0)) => "1".to_owned(),
            Some(_) => {
                let help = "write a unit such as deg/s, or nothing for a plain number";
                tables.faults.push(fault(&sheet.name, Some(unit_cell), "this is no unit", help));
                continue;
            }
        };
        for &(column, heading) in columns.iter().filter(|(_, heading)| is_value_heading(heading)) {
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
            let reading = Reading { sheet: number, cell, value, unit: unit.clone(), unit_cell };
            if let Some(first) = tables.readings.get(&path).filter(|first| first.value.is_some()) {
                if reading.value.is_some() {
                    let message =
                        format!("`{path}` stands here and in {}, cell {}", SHEETS[first.sheet], first.cell);
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
        match (text(0), text(1)) {
            (Some("fingerprint"), found) => tables.fingerprint = found.map(str::to_owned),
            (Some("set"), _) => {}
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
