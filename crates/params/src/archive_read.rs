//! Parts of a zip archive, unpacked one at a time and never beyond a limit.

use std::collections::BTreeMap;

use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::BookError;
use crate::crc32::crc32;

/// Largest part of a workbook once unpacked, in bytes.
const LARGEST_PART: usize = 48 << 20;

/// Most parts that a workbook has; Excel makes about twenty.
const MOST_PARTS: usize = 4096;

/// An archive whose directory was read.
pub(crate) struct Archive<'a> {
    bytes: &'a [u8],
    parts: BTreeMap<String, Part>,
}

struct Part {
    encrypted: bool,
    method: u16,
    crc: u32,
    packed: usize,
    start: usize,
}

/// Reads the directory of an archive.
pub(crate) fn open(bytes: &[u8]) -> Result<Archive<'_>, BookError> {
    if bytes.starts_with(b"\xD0\xCF\x11\xE0") {
        return Err(BookError::new(
            "it is an old `.xls`, or it has a password",
            "open it in Excel or LibreOffice, take the password off and save it as .xlsx",
        ));
    }
    if !bytes.starts_with(b"PK") {
        return Err(BookError::new(
            "it is no .xlsx: it does not begin like one",
            "save the workbook as .xlsx",
        ));
    }
    let cut = || BookError::new("its end is missing or damaged", "copy or save the file again");
    // The end record is followed by a comment of at most 65535 bytes.
    let from = bytes.len().saturating_sub(22 + 0xffff);
    let end = bytes[from..].windows(4).rposition(|four| four == b"PK\x05\x06").ok_or_else(cut)? + from;
    if end + 22 > bytes.len() {
        return Err(cut());
    }
    let count = usize::from(u16_at(bytes, end + 10).ok_or_else(cut)?);
    let mut at = u32_at(bytes, end + 16).ok_or_else(cut)? as usize;
    if count > MOST_PARTS {
        return Err(BookError::new(format!("it has {count} parts"), "save it again in Excel or LibreOffice"));
    }
    let mut parts = BTreeMap::new();
    for _ in 0..count {
        if bytes.get(at..at.saturating_add(4)) != Some(b"PK\x01\x02") {
            return Err(cut());
        }
        let short = |offset| u16_at(bytes, at + offset).ok_or_else(cut);
        let long = |offset| u32_at(bytes, at + offset).ok_or_else(cut);
        let length = usize::from(short(28)?);
        let name = bytes.get(at + 46..at + 46 + length).ok_or_else(cut)?;
        let part = Part {
            encrypted: short(8)? & 1 == 1,
            method: short(10)?,
            crc: long(16)?,
            packed: long(20)? as usize,
            start: long(42)? as usize,
        };
        parts.insert(String::from_utf8_lossy(name).into_owned(), part);
        at += 46 + length + usize::from(short(30)?) + usize::from(short(32)?);
    }
    Ok(Archive { bytes, parts })
}

/// All parts of a workbook by name, unpacked, for programs that look behind the cells.
///
/// # Errors
/// The bytes are no archive, or one of its parts is damaged, too large or no text.
pub fn unpack(bytes: &[u8]) -> Result<Vec<(String, String)>, BookError> {
    let archive = open(bytes)?;
    archive.parts.keys().map(|name| Ok((name.clone(), archive.text(name)?))).collect()
}

impl Archive<'_> {
    /// Whether there is such a part.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.parts.contains_key(name)
    }

    /// A part as text.
    pub(crate) fn text(&self, name: &str) -> Result<String, BookError> {
        let damaged =
            || BookError::new(format!("its part `{name}` is damaged"), "copy or save the file again");
        let part = self.parts.get(name).ok_or_else(|| {
            BookError::new(format!("its part `{name}` is missing"), "save it again in Excel or LibreOffice")
        })?;
        if part.encrypted {
            return Err(BookError::new("it has a password", "save it without one"));
        }
        if self.bytes.get(part.start..part.start.saturating_add(4)) != Some(b"PK\x03\x04") {
            return Err(damaged());
        }
        let extra = |offset| u16_at(self.bytes, part.start + offset).map(usize::from).ok_or_else(damaged);
        let start = part.start + 30 + extra(26)? + extra(28)?;
        let packed = self.bytes.get(start..start.saturating_add(part.packed)).ok_or_else(damaged)?;
        let large = || {
            BookError::new(
                format!("its part `{name}` has more than {} MiB", LARGEST_PART >> 20),
                "a parameter set is far smaller; delete empty rows and sheets of your own, or export anew",
            )
        };
        let plain = match part.method {
            0 if packed.len() > LARGEST_PART => return Err(large()),
            0 => packed.to_vec(),
            8 => decompress_to_vec_with_limit(packed, LARGEST_PART).map_err(|error| {
                if error.status == miniz_oxide::inflate::TINFLStatus::HasMoreOutput {
                    large()
                } else {
                    damaged()
                }
            })?,
            _ => return Err(damaged()),
        };
        if crc32(&plain) != part.crc {
            return Err(damaged());
        }
        String::from_utf8(plain).map_err(|_| damaged())
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..at.checked_add(2)?)?.try_into().ok().map(u16::from_le_bytes)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at.checked_add(4)?)?.try_into().ok().map(u32::from_le_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::archive_write::pack;

    #[test]
    fn what_was_packed_is_unpacked() {
        let parts = [("a.xml".to_owned(), "<a/>".repeat(1000)), ("b/c.xml".to_owned(), String::new())];
        let bytes = pack(&parts);
        let archive = open(&bytes).expect("an archive");
        for (name, text) in &parts {
            assert_eq!(archive.text(name).as_ref(), Ok(text));
        }
        assert!(archive.text("d").is_err() && !archive.has("d"));
    }

    #[test]
    fn every_cut_of_an_archive_is_an_error() {
        let bytes = pack(&[("a.xml".to_owned(), "text".repeat(50))]);
        for end in 0..bytes.len() {
            assert!(open(&bytes[..end]).and_then(|archive| archive.text("a.xml")).is_err(), "{end}");
        }
    }

    #[test]
    fn a_bomb_is_refused_at_the_limit() {
        let bytes = pack(&[("a.xml".to_owned(), " ".repeat(LARGEST_PART + 1))]);
        assert!(bytes.len() < 1 << 20, "it is small: {}", bytes.len());
        let error = open(&bytes).expect("an archive").text("a.xml").expect_err("too large");
        assert!(error.message.contains("more than 48 MiB"), "{error:?}");
    }
}
