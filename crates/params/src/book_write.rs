//! A workbook to bytes: what a person sees first is a heading, wide enough columns and cells to fill in.

use rust_xlsxwriter::{Color, DocProperties, ExcelDateTime, Format, FormatBorder, Workbook, XlsxError};

/// What a cell to write holds.
pub(crate) enum Out {
    /// A number to be changed by people.
    Value(f64),
    /// A text with one of the looks below.
    Text(String, Look),
}

/// How a text looks.
#[derive(Clone, Copy)]
pub(crate) enum Look {
    /// As it is.
    Plain,
    /// The title of a sheet.
    Title,
    /// The heading of a column.
    Heading,
    /// A remark.
    Remark,
}

/// A sheet to write.
#[derive(Default)]
pub(crate) struct OutSheet {
    pub name: String,
    pub hidden: bool,
    /// Cells row by row.
    pub rows: Vec<Vec<Option<Out>>>,
    /// Width of columns in characters.
    pub widths: Vec<u32>,
    /// Rows and columns that stay in sight.
    pub frozen: (u32, u16),
}

/// Light grey, for lines around cells.
const LINES: Color = Color::RGB(0xBF_BFBF);

fn format(look: Look) -> Format {
    let plain = Format::new();
    match look {
        Look::Plain => plain,
        Look::Title => plain.set_bold().set_font_size(14),
        Look::Heading => framed(plain.set_bold().set_background_color(Color::RGB(0xD9_E1F2))),
        Look::Remark => plain.set_font_size(10).set_font_color(Color::RGB(0x60_6060)),
    }
}

/// A number to be changed: yellow.
fn value_format() -> Format {
    framed(Format::new().set_background_color(Color::RGB(0xFF_F9E0)))
}

fn framed(format: Format) -> Format {
    format.set_border(FormatBorder::Thin).set_border_color(LINES)
}

/// The bytes of a workbook; the same sheets give the same bytes.
///
/// # Errors
/// A text is longer than Excel allows (32767 characters), or there are more rows or columns.
pub(crate) fn write(sheets: &[OutSheet]) -> Result<Vec<u8>, XlsxError> {
    let mut book = Workbook::new();
    // A fixed date, because else each export would differ.
    let date = ExcelDateTime::from_ymd(2000, 1, 1)?;
    book.set_properties(&DocProperties::new().set_creation_datetime(&date));
    for out in sheets {
        let sheet = book.add_worksheet();
        sheet.set_name(&out.name)?.set_hidden(out.hidden);
        sheet.set_landscape().set_print_fit_to_pages(1, 0);
        sheet.set_freeze_panes(out.frozen.0, out.frozen.1)?;
        for (column, &width) in (0..).zip(&out.widths) {
            sheet.set_column_width(column, width)?;
        }
        for (row, cells) in (0..).zip(&out.rows) {
            for (column, cell) in (0..).zip(cells) {
                match cell {
                    None => continue,
                    Some(Out::Value(number)) => {
                        sheet.write_number_with_format(row, column, *number, &value_format())?
                    }
                    Some(Out::Text(text, look)) => {
                        sheet.write_string_with_format(row, column, text, &format(*look))?
                    }
                };
            }
        }
    }
    book.save_to_buffer()
}
