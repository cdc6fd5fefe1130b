//! The zip archive around a workbook, looked at before anything unpacks it without a limit.

use std::io::{Cursor, Read, Write, sink};

use zip::read::ZipArchive;
use zip::result::ZipError;

use crate::BookError;

/// Largest part of a workbook once unpacked, in bytes.
const LARGEST_PART: u64 = 48 << 20;

/// Most parts that a workbook has; Excel makes about twenty.
const MOST_PARTS: usize = 4096;

/// Unpacks every part once, up to a limit, so that a reader of cells may take them whole.
pub(crate) fn inspect(bytes: &[u8]) -> Result<(), BookError> {
    let mut archive = open(bytes)?;
    let has = |name| archive.index_for_name(name).is_some();
    if has("xl/workbook.bin") {
        return Err(BookError::new("it is an .xlsb", "save it as .xlsx"));
    }
    if has("content.xml") {
        return Err(BookError::new("it is an OpenDocument sheet (.ods)", "save it as .xlsx"));
    }
    for required in ["xl/workbook.xml", "xl/_rels/workbook.xml.rels"] {
        if !has(required) {
            let message = format!("its part `{required}` is missing");
            return Err(BookError::new(message, "save it again in Excel or LibreOffice"));
        }
    }
    (0..archive.len()).try_for_each(|index| copy(&mut archive, index, &mut sink()).map(drop))
}

fn open(bytes: &[u8]) -> Result<ZipArchive<Cursor<&[u8]>>, BookError> {
    if bytes.starts_with(b"\xD0\xCF\x11\xE0") {
        return Err(BookError::new(
            "it is an old `.xls`, or it has a password",
            "open it in Excel or LibreOffice, take the password off and save it as .xlsx",
        ));
    }
    if !bytes.starts_with(b"PK") {
        return Err(BookError::new(
            "it is not an .xlsx file: it does not begin like one",
            "save the workbook as .xlsx",
        ));
    }
    let archive = ZipArchive::new(Cursor::new(bytes))
        .map_err(|_| BookError::new("its end is missing or damaged", "copy or save the file again"))?;
    if archive.len() > MOST_PARTS {
        let message = format!("it has {} parts", archive.len());
        return Err(BookError::new(message, "save it again in Excel or LibreOffice"));
    }
    Ok(archive)
}

/// Writes an unpacked part to `out` and gives its name.
fn copy(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    index: usize,
    out: &mut dyn Write,
) -> Result<String, BookError> {
    let part = archive.by_index(index).map_err(|error| match error {
        ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) => {
            BookError::new("it has a password", "save it without one")
        }
        _ => BookError::new(format!("its part {} is damaged", index + 1), "copy or save the file again"),
    })?;
    let name = part.name().map(|name| name.into_owned()).map_err(|_| {
        BookError::new(format!("its part {} has a damaged name", index + 1), "copy or save the file again")
    })?;
    let size = std::io::copy(&mut part.take(LARGEST_PART + 1), out).map_err(|_| {
        BookError::new(format!("its part `{name}` is damaged"), "copy or save the file again")
    })?;
    if size > LARGEST_PART {
        return Err(BookError::new(
            format!("its part `{name}` has more than {} MiB", LARGEST_PART >> 20),
            "a parameter set is far smaller; delete empty rows and sheets of your own, or export anew",
        ));
    }
    Ok(name)
}

/// All parts of a workbook by name, unpacked, for programs that look behind the cells.
///
/// # Errors
/// The bytes are no archive, or one of its parts is damaged, too large or no text.
pub fn unpack(bytes: &[u8]) -> Result<Vec<(String, String)>, BookError> {
    let mut archive = open(bytes)?;
    (0..archive.len())
        .map(|index| {
            let mut plain = Vec::new();
            let name = copy(&mut archive, index, &mut plain)?;
            let text = String::from_utf8(plain).map_err(|_| {
                BookError::new(format!("its part `{name}` is not text"), "copy or save the file again")
            })?;
            Ok((name, text))
        })
        .collect()
}

/// The archive of such parts.
///
/// # Errors
/// Two parts have the same name.
pub fn pack<T: AsRef<[u8]>>(parts: &[(String, T)]) -> Result<Vec<u8>, BookError> {
    let failed =
        |error: ZipError| BookError::new(format!("it cannot be packed: {error}"), "rename one of the parts");
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for (name, text) in parts {
        archive.start_file(name.as_str(), options).map_err(failed)?;
        archive.write_all(text.as_ref()).map_err(|error| failed(error.into()))?;
    }
    Ok(archive.finish().map_err(failed)?.into_inner())
}
