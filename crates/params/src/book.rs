//! What was read of a workbook.

use crate::cell::Sheet;

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

/// Whether two names of sheets are the same.
pub(crate) fn same_name(a: &str, b: &str) -> bool {
    a.trim().eq_ignore_ascii_case(b.trim())
}
