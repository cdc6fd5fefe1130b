//! A set or a model as a workbook for people.

use blocksim_diagram::fingerprint;

use crate::arrangement::{Arrangement, MEMORY};
use crate::book_write::{Look, Out, OutSheet, write};
use crate::key::Column;
use crate::label::label;
use crate::quantity::{Content, Quantity, SetError};
use crate::rows::{Layout, Row, layout};

/// The row of the headings, counted from 0, in an exported sheet.
const HEADINGS: u32 = 2;

const HINT: &str = "Change the yellow cells only. The unit of a row may be changed to another one of the same kind; \
                    numbers are then converted. Rows are found by the column Key, columns by their heading.";

/// The bytes of the workbook of a set or a model of these texts and quantities; `name` is shown in its titles. The same
/// texts give the same bytes.
///
/// # Errors
/// A text is longer than a cell can hold.
pub fn export(
    texts: &[&str],
    name: &str,
    quantities: &[Quantity],
    arrangement: &Arrangement,
) -> Result<Vec<u8>, SetError> {
    let named = |(n, title): (usize, &String)| {
        sheet(title, name, &layout(n, quantities, arrangement), quantities, arrangement)
    };
    let mut sheets: Vec<OutSheet> = arrangement.sheets.iter().enumerate().map(named).collect();
    sheets.push(memory(&fingerprint(texts.concat().as_bytes()), name, quantities, arrangement));
    write(&sheets).map_err(|error| {
        let message = format!("the parameters do not fit into a workbook: {error}");
        SetError::new(message, Some("shorten the longest texts"), 0..0)
    })
}

fn text(text: impl Into<String>, look: Look) -> Option<Out> {
    Some(Out::Text(text.into(), look))
}

fn sheet(
    title: &str,
    name: &str,
    layout: &Layout,
    quantities: &[Quantity],
    arrangement: &Arrangement,
) -> OutSheet {
    let mut headings = vec!["Quantity".to_owned(), "Key".to_owned(), "Unit".to_owned()];
    headings.extend(layout.headings());
    headings.extend(["Note", "Tolerance", "Source"].map(str::to_owned));
    let mut rows = vec![
        vec![text(format!("{name} – {title}"), Look::Title)],
        vec![text(HINT, Look::Remark)],
        headings.iter().map(|heading| text(heading.as_str(), Look::Heading)).collect(),
    ];
    rows.extend(layout.rows.iter().map(|row| cells(row, &layout.columns, quantities, arrangement)));
    let values = layout.columns.len();
    let mut widths = vec![44, 34, 14];
    widths.extend(std::iter::repeat_n(13, values));
    widths.extend([26, 14, 60]);
    OutSheet { name: title.to_owned(), hidden: false, rows, widths, frozen: (HEADINGS + 1, 3) }
}

fn cells(
    row: &Row,
    columns: &[Column],
    quantities: &[Quantity],
    arrangement: &Arrangement,
) -> Vec<Option<Out>> {
    let mut cells =
        vec![text(label(&row.key, &arrangement.labels), Look::Plain), text(row.key.as_str(), Look::Remark)];
    cells.push((!row.unit.is_empty()).then(|| Out::Text(row.unit.clone(), Look::Plain)));
    for column in columns {
        cells.push(row.quantities.get(column).map(|&n| match &quantities[n].content {
            Content::Number { value, .. } => Out::Value(*value),
            Content::Expression(text) => Out::Text(text.clone(), Look::Plain),
        }));
    }
    for which in [1, 2, 0] {
        let said = provenance(row, quantities, which);
        cells.push((!said.is_empty()).then_some(Out::Text(said, Look::Remark)));
    }
    cells
}

/// The source, note or tolerance of a row: once if all agree, else with the numbers of the columns.
fn provenance(row: &Row, quantities: &[Quantity], which: usize) -> String {
    let mut kinds: Vec<(&str, Vec<String>)> = Vec::new();
    for (column, &n) in &row.quantities {
        let said = quantities[n].provenance[which].as_str();
        let column = column.number().to_string();
        match kinds.iter_mut().find(|(known, _)| *known == said) {
            Some((_, columns)) => columns.push(column),
            None => kinds.push((said, vec![column])),
        }
    }
    match kinds.as_slice() {
        [(all, _)] => (*all).to_owned(),
        kinds => {
            let parts = kinds.iter().filter(|(said, _)| !said.is_empty());
            parts
                .map(|(said, columns)| format!("{}: {said}", columns.join(", ")))
                .collect::<Vec<_>>()
                .join("; ")
        }
    }
}

/// What the set held when it was exported.
fn memory(fingerprint: &str, name: &str, quantities: &[Quantity], arrangement: &Arrangement) -> OutSheet {
    let pair = |key: &str, value: &str| vec![text(key, Look::Plain), text(value, Look::Plain)];
    let mut rows = vec![pair("fingerprint", fingerprint), pair("set", name)];
    rows.extend(arrangement.sheets.iter().map(|sheet| pair("sheet", sheet)));
    for (quantity, &sheet) in quantities.iter().zip(&arrangement.of) {
        let mut row = match &quantity.content {
            // As text, because a program that saves the workbook may round numbers.
            Content::Number { value, unit, .. } => {
                vec![
                    text(quantity.path.as_str(), Look::Plain),
                    text(format!("{value:?}"), Look::Plain),
                    text(unit.as_str(), Look::Plain),
                ]
            }
            Content::Expression(written) => {
                vec![
                    text(quantity.path.as_str(), Look::Plain),
                    text("expression", Look::Plain),
                    text(written.as_str(), Look::Plain),
                ]
            }
        };
        row.push(arrangement.sheets.get(sheet).and_then(|sheet| text(sheet.as_str(), Look::Plain)));
        rows.push(row);
    }
    OutSheet { name: MEMORY.to_owned(), hidden: true, rows, ..OutSheet::default() }
}
