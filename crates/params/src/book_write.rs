//! A workbook to bytes: what a person sees first is a heading, wide enough columns and cells to fill in.

use crate::archive_write::pack;
use crate::cell::Address;
use crate::xml::escaped;

/// What a cell to write holds.
pub(crate) enum Out {
    /// A number to be changed by people.
    Value(f64),
    /// A text with one of the looks below.
    Text(String, Look),
}

/// How a text looks; the numbers are those of the styles below.
#[derive(Clone, Copy)]
pub(crate) enum Look {
    /// As it is.
    Plain = 0,
    /// The title of a sheet.
    Title = 1,
    /// The heading of a column.
    Heading = 2,
    /// A remark.
    Remark = 4,
}

/// Style of a number to be changed.
const VALUE: u32 = 3;

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
    pub frozen: (u32, u32),
}

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n";
const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";

/// Default, title, heading, value (yellow), remark (grey).
const STYLES: &str = r#"<fonts count="4"><font><sz val="11"/><name val="Calibri"/></font><font><b/><sz val="14"/><name val="Calibri"/></font><font><b/><sz val="11"/><name val="Calibri"/></font><font><sz val="10"/><color rgb="FF606060"/><name val="Calibri"/></font></fonts><fills count="4"><fill><patternFill patternType="none"/></fill><fill><patternFill patternType="gray125"/></fill><fill><patternFill patternType="solid"><fgColor rgb="FFD9E1F2"/><bgColor indexed="64"/></patternFill></fill><fill><patternFill patternType="solid"><fgColor rgb="FFFFF9E0"/><bgColor indexed="64"/></patternFill></fill></fills><borders count="2"><border><left/><right/><top/><bottom/><diagonal/></border><border><left style="thin"><color rgb="FFBFBFBF"/></left><right style="thin"><color rgb="FFBFBFBF"/></right><top style="thin"><color rgb="FFBFBFBF"/></top><bottom style="thin"><color rgb="FFBFBFBF"/></bottom><diagonal/></border></borders><cellStyleXfs count="1"><xf numFmtId="0" fontId="0" fillId="0" borderId="0"/></cellStyleXfs><cellXfs count="5"><xf numFmtId="0" fontId="0" fillId="0" borderId="0" xfId="0"/><xf numFmtId="0" fontId="1" fillId="0" borderId="0" xfId="0" applyFont="1"/><xf numFmtId="0" fontId="2" fillId="2" borderId="1" xfId="0" applyFont="1" applyFill="1" applyBorder="1"/><xf numFmtId="0" fontId="0" fillId="3" borderId="1" xfId="0" applyFill="1" applyBorder="1"/><xf numFmtId="0" fontId="3" fillId="0" borderId="0" xfId="0" applyFont="1"/></cellXfs><cellStyles count="1"><cellStyle name="Normal" xfId="0" builtinId="0"/></cellStyles>"#;

/// The bytes of a workbook; the same sheets give the same bytes.
pub(crate) fn write(sheets: &[OutSheet]) -> Vec<u8> {
    let numbers = || 1..=sheets.len();
    let overrides: String = numbers().map(|n| format!(r#"<Override PartName="/xl/worksheets/sheet{n}.xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"/>"#)).collect();
    let types = format!(
        r#"{HEAD}<Types xmlns="{PACKAGE}/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" ContentType="application/xml"/><Override PartName="/xl/workbook.xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"/><Override PartName="/xl/styles.xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.styles+xml"/>{overrides}</Types>"#
    );
    let root = format!(
        r#"{HEAD}<Relationships xmlns="{PACKAGE}/relationships"><Relationship Id="rId1" Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>"#
    );
    let relations: String = numbers()
        .map(|n| {
            format!(
                r#"<Relationship Id="rId{n}" Type="{OFFICE}/worksheet" Target="worksheets/sheet{n}.xml"/>"#
            )
        })
        .collect();
    let styles = sheets.len() + 1;
    let relations = format!(
        r#"{HEAD}<Relationships xmlns="{PACKAGE}/relationships">{relations}<Relationship Id="rId{styles}" Type="{OFFICE}/styles" Target="styles.xml"/></Relationships>"#
    );
    let tabs: String = numbers()
        .zip(sheets)
        .map(|(n, sheet)| {
            let state = if sheet.hidden { r#" state="hidden""# } else { "" };
            format!(r#"<sheet name="{}" sheetId="{n}"{state} r:id="rId{n}"/>"#, escaped(&sheet.name))
        })
        .collect();
    let book = format!(
        r#"{HEAD}<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><bookViews><workbookView activeTab="0" tabRatio="850"/></bookViews><sheets>{tabs}</sheets></workbook>"#
    );
    let mut parts = vec![
        ("[Content_Types].xml".to_owned(), types),
        ("_rels/.rels".to_owned(), root),
        ("xl/workbook.xml".to_owned(), book),
        ("xl/_rels/workbook.xml.rels".to_owned(), relations),
        ("xl/styles.xml".to_owned(), format!(r#"{HEAD}<styleSheet xmlns="{MAIN}">{STYLES}</styleSheet>"#)),
    ];
    parts
        .extend(numbers().zip(sheets).map(|(n, sheet)| (format!("xl/worksheets/sheet{n}.xml"), page(sheet))));
    pack(&parts)
}

fn page(sheet: &OutSheet) -> String {
    let widths: String = (1..)
        .zip(&sheet.widths)
        .map(|(n, width)| format!(r#"<col min="{n}" max="{n}" width="{width}" customWidth="1"/>"#))
        .collect();
    let columns = if widths.is_empty() { widths } else { format!("<cols>{widths}</cols>") };
    let rows: String = (0..)
        .zip(&sheet.rows)
        .map(|(row, cells)| {
            let cells: String = (0..)
                .zip(cells)
                .filter_map(|(column, cell)| Some(written(Address { row, column }, cell.as_ref()?)))
                .collect();
            format!(r#"<row r="{}">{cells}</row>"#, row + 1)
        })
        .collect();
    let (row, column) = sheet.frozen;
    let corner = Address { row, column };
    let pane = match sheet.frozen {
        (0, 0) => String::new(),
        _ => format!(
            r#"<pane xSplit="{column}" ySplit="{row}" topLeftCell="{corner}" activePane="bottomRight" state="frozen"/>"#
        ),
    };
    format!(
        r#"{HEAD}<worksheet xmlns="{MAIN}"><sheetPr><pageSetUpPr fitToPage="1"/></sheetPr><sheetViews><sheetView workbookViewId="0">{pane}</sheetView></sheetViews>{columns}<sheetData>{rows}</sheetData><pageSetup orientation="landscape" fitToHeight="0"/></worksheet>"#
    )
}

fn written(at: Address, cell: &Out) -> String {
    match cell {
        Out::Value(number) => format!(r#"<c r="{at}" s="{VALUE}"><v>{number:?}</v></c>"#),
        Out::Text(text, look) => {
            format!(
                r#"<c r="{at}" s="{}" t="inlineStr"><is><t xml:space="preserve">{}</t></is></c>"#,
                *look as u32,
                escaped(text)
            )
        }
    }
}
