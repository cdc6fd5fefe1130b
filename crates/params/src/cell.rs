//! Cells, sheets and workbooks as plain data.

use std::collections::BTreeMap;
use std::fmt;

/// Where a cell is, counted from 0; printed as in a spreadsheet, `B7`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Address {
    /// The row.
    pub row: u32,
    /// The column.
    pub column: u32,
}

/// Rows of a sheet of Excel.
const ROWS: u32 = 1 << 20;

/// Columns of a sheet of Excel.
const COLUMNS: u32 = 1 << 14;

impl Address {
    /// Reads `B7`.
    pub fn parse(text: &str) -> Option<Address> {
        let letters = text.bytes().take_while(u8::is_ascii_uppercase).count();
        if !(1..=3).contains(&letters) {
            return None;
        }
        let column =
            text.bytes().take(letters).fold(0, |n, letter| n * 26 + u32::from(letter - b'A') + 1) - 1;
        let row = text[letters..].parse::<u32>().ok()?.checked_sub(1)?;
        (row < ROWS && column < COLUMNS).then_some(Address { row, column })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut letters, mut rest) = (String::new(), self.column + 1);
        while rest > 0 {
            letters.insert(0, char::from(b'A' + ((rest - 1) % 26) as u8));
            rest = (rest - 1) / 26;
        }
        write!(f, "{letters}{}", self.row + 1)
    }
}

/// A cell of a sheet; printed `(7) D4` where the name of the sheet begins with a number, else `pid!D4`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spot {
    /// Name of the sheet.
    pub sheet: String,
    /// The cell.
    pub cell: Address,
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.sheet.split_once(')').map(|(number, _)| number);
        let number = number.and_then(|number| number.strip_prefix('(')?.parse::<usize>().ok());
        match number {
            Some(number) => write!(f, "({number}) {}", self.cell),
            None => write!(f, "{}!{}", self.sheet, self.cell),
        }
    }
}

/// What stands in a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A number, also the last result of a formula.
    Number(f64),
    /// A text.
    Text(String),
    /// `#DIV/0!` and the like.
    Error(String),
    /// A number that is shown as a date or a time.
    Date,
    /// TRUE or FALSE.
    Bool,
    /// A formula without a result.
    NotComputed,
    /// A formula that takes from another workbook.
    External,
}

/// A sheet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// Its name on the tab.
    pub name: String,
    /// Cells that are not empty.
    pub cells: BTreeMap<Address, Cell>,
    /// First and last cells of merged areas.
    pub merged: Vec<(Address, Address)>,
}

impl Sheet {
    /// The text of a cell without blanks around it, if it is a text.
    pub fn text(&self, at: Address) -> Option<&str> {
        match self.cells.get(&at) {
            Some(Cell::Text(text)) => Some(text.trim()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_and_printed() {
        for (text, row, column) in [
            ("A1", 0, 0),
            ("B7", 6, 1),
            ("Z3", 2, 25),
            ("AA10", 9, 26),
            ("XFD1048576", ROWS - 1, COLUMNS - 1),
        ] {
            let address = Address { row, column };
            assert_eq!(Address::parse(text), Some(address));
            assert_eq!(address.to_string(), text);
        }
        for wrong in ["", "A", "7", "A0", "a1", "XFE1", "A1048577", "ABCD1", "A-1", "A1B"] {
            assert_eq!(Address::parse(wrong), None, "{wrong}");
        }
    }
}
