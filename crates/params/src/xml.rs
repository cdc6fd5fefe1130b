//! XML as a stream of what workbooks use: elements with attributes, and text.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use crate::BookError;

/// A piece of a document. Names are without prefixes.
pub(crate) enum Piece {
    /// `<name a="b">`, also for `<name/>`.
    Start(String, Vec<(String, String)>),
    /// `</name>`, also for `<name/>`.
    End(String),
    /// Characters between tags.
    Text(String),
}

/// Value of an attribute.
pub(crate) fn attribute<'a>(attributes: &'a [(String, String)], name: &str) -> Option<&'a str> {
    attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
}

/// Hands every piece of a document to `take`, until that returns an error. Entities that a document declares itself
/// are not expanded.
pub(crate) fn each(
    part: &str,
    text: &str,
    mut take: impl FnMut(Piece) -> Result<(), BookError>,
) -> Result<(), BookError> {
    let damaged =
        || BookError::new(format!("its part `{part}` is no XML"), "save it again in Excel or LibreOffice");
    let mut reader = Reader::from_str(text.trim_start_matches('\u{feff}'));
    loop {
        match reader.read_event().map_err(|_| damaged())? {
            Event::Start(tag) => take(start(&tag).ok_or_else(damaged)?)?,
            Event::Empty(tag) => {
                take(start(&tag).ok_or_else(damaged)?)?;
                take(Piece::End(local(&tag)))?;
            }
            Event::End(tag) => take(Piece::End(tag.local_name().as_ref().to_owned()))?,
            Event::Text(text) => take(Piece::Text(text.xml10_content().into_owned()))?,
            Event::CData(text) => take(Piece::Text(text.xml10_content().into_owned()))?,
            Event::GeneralRef(entity) => {
                let character = match entity.xml10_content().as_ref() {
                    "lt" => '<',
                    "gt" => '>',
                    "amp" => '&',
                    "quot" => '"',
                    "apos" => '\'',
                    _ => entity.resolve_char_ref().ok().flatten().ok_or_else(damaged)?,
                };
                take(Piece::Text(character.to_string()))?;
            }
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
}

fn local(tag: &BytesStart) -> String {
    tag.local_name().as_ref().to_owned()
}

fn start(tag: &BytesStart) -> Option<Piece> {
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        let attribute = attribute.ok()?;
        let value = attribute.normalized_value(XmlVersion::Explicit1_0).ok()?;
        // `r:id` and `sheetId` stay apart; prefixes other than the relations' matter nowhere.
        attributes.push((attribute.key.local_name().as_ref().to_owned(), value.into_owned()));
    }
    Some(Piece::Start(local(tag), attributes))
}

/// A text for use between tags or in an attribute; characters that XML has no way to write are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' => out.push(c),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}
