//! RON text as a tree with places.
//!
//! `ron` does the reading. Each value is taken as raw text that still lies in the file, so its place is known;
//! what is inside is read the same way. No type is asked for yet: a value that makes no sense where it stands can
//! be reported there, and does not hide the others.

use std::ops::Range;

use ron::Options;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// A value and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Start and end in bytes.
    pub span: Range<usize>,
    /// What it is.
    pub value: Shape,
}

/// A name and its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// The name.
    pub text: String,
    /// Start and end in bytes.
    pub span: Range<usize>,
}

/// What stands in a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// `1.5`
    Number(f64),
    /// `true`
    Bool(bool),
    /// `"text"`
    Text(String),
    /// `[1, 2]`
    List(Vec<Node>),
    /// `{"a": 1}`
    Map(Vec<(Name, Node)>),
    /// `(a: 1)` or `Kind(a: 1)`
    Struct(Option<Name>, Vec<(Name, Node)>),
    /// `(1, 2)`, `()` or `Kind(1)`
    Tuple(Option<Name>, Vec<Node>),
    /// `Kind`
    Word(String),
}

impl Node {
    /// What it is, in words.
    pub fn describe(&self) -> String {
        match &self.value {
            Shape::Number(_) => "a number".to_owned(),
            Shape::Bool(_) => "true or false".to_owned(),
            Shape::Text(_) => "a text".to_owned(),
            Shape::List(items) => format!("a list of {}", items.len()),
            Shape::Map(_) | Shape::Struct(None, _) => "a set".to_owned(),
            Shape::Struct(Some(name), _) | Shape::Tuple(Some(name), _) => format!("`{}(...)`", name.text),
            Shape::Tuple(None, _) => "a tuple".to_owned(),
            Shape::Word(word) => format!("the word `{word}`"),
        }
    }

    /// Named members of a set or of `Kind(...)`; none for `()`.
    pub fn members(&self) -> Option<&[(Name, Node)]> {
        match &self.value {
            Shape::Map(members) | Shape::Struct(_, members) => Some(members),
            Shape::Tuple(_, items) if items.is_empty() => Some(&[]),
            Shape::Word(_) => Some(&[]),
            _ => None,
        }
    }

    /// The word before the parentheses, or the word itself.
    pub fn word(&self) -> Option<&str> {
        match &self.value {
            Shape::Struct(Some(name), _) | Shape::Tuple(Some(name), _) => Some(&name.text),
            Shape::Word(word) => Some(word),
            _ => None,
        }
    }
}

/// Text that is no RON.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// Where.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

/// Reads a file.
///
/// # Errors
/// The first place that is no RON.
pub fn read(text: &str) -> Result<Node, SyntaxError> {
    let reader = Reader { text };
    let raw: &RawValue = options().from_str(text).map_err(|error| reader.error(text, &error))?;
    reader.node(raw.get_ron())
}

fn options() -> Options {
    Options::default().with_default_extension(
        Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES | Extensions::UNWRAP_VARIANT_NEWTYPES,
    )
}

struct Reader<'a> {
    text: &'a str,
}

impl<'a> Reader<'a> {
    fn offset(&self, part: &str) -> usize {
        (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize).min(self.text.len())
    }

    fn node(&self, raw: &'a str) -> Result<Node, SyntaxError> {
        let raw = &raw[skip(raw)..];
        let raw = trim_end(raw);
        let start = self.offset(raw);
        let span = start..start + raw.len();
        let value = self.shape(raw)?;
        Ok(Node { span, value })
    }

    fn shape(&self, raw: &'a str) -> Result<Shape, SyntaxError> {
        let word = word_length(raw);
        if word > 0 && !is_raw_string(raw) {
            return self.worded(raw, word);
        }
        match raw.as_bytes().first() {
            Some(b'"' | b'r') => self.parse::<String>(raw).map(Shape::Text),
            Some(b'\'') => self.parse::<char>(raw).map(|c| Shape::Text(c.to_string())),
            Some(b'[') => {
                let items: Vec<&'a RawValue> = self.parse(raw)?;
                Ok(Shape::List(items.iter().map(|item| self.node(item.get_ron())).collect::<Result<_, _>>()?))
            }
            Some(b'{') => {
                let Entries(entries) = self.parse(raw)?;
                Ok(Shape::Map(self.members(raw, entries)?))
            }
            Some(b'(') => self.parenthesised(raw, None),
            _ => self.parse::<f64>(raw).map(Shape::Number),
        }
    }

    fn worded(&self, raw: &'a str, length: usize) -> Result<Shape, SyntaxError> {
        let word = &raw[..length];
        let rest = &raw[length..];
        let rest = &rest[skip(rest)..];
        match word {
            "true" => return Ok(Shape::Bool(true)),
            "false" => return Ok(Shape::Bool(false)),
            "inf" | "NaN" => return self.parse::<f64>(raw).map(Shape::Number),
            _ if rest.is_empty() => return Ok(Shape::Word(word.to_owned())),
            _ => {}
        }
        let start = self.offset(word);
        self.parenthesised(rest, Some(Name { text: word.to_owned(), span: start..start + length }))
    }

    fn parenthesised(&self, raw: &'a str, name: Option<Name>) -> Result<Shape, SyntaxError> {
        match self.parse(raw)? {
            Inside::Named(entries) => Ok(Shape::Struct(name, self.members(raw, entries)?)),
            Inside::Items(items) => {
                let items = items.iter().map(|item| self.node(item.get_ron())).collect::<Result<_, _>>()?;
                Ok(Shape::Tuple(name, items))
            }
        }
    }

    /// Names stand between the values: they are found there.
    fn members(
        &self,
        raw: &str,
        entries: Vec<(String, &'a RawValue)>,
    ) -> Result<Vec<(Name, Node)>, SyntaxError> {
        let mut at = self.offset(raw) + 1;
        let mut members = Vec::with_capacity(entries.len());
        for (text, value) in entries {
            let node = self.node(value.get_ron())?;
            let between = &self.text[at..node.span.start];
            let start = at + skip_with(between, true);
            let written = self.text[start..node.span.start].find(':').unwrap_or(0);
            let end = start + trim_end(&self.text[start..start + written]).len();
            at = node.span.end;
            members.push((Name { text, span: start..end }, node));
        }
        Ok(members)
    }

    fn parse<T: Deserialize<'a>>(&self, raw: &'a str) -> Result<T, SyntaxError> {
        options().from_str(raw).map_err(|error| self.error(raw, &error))
    }

    /// Errors of `ron` count lines and columns of the text that was read.
    fn error(&self, raw: &str, error: &ron::error::SpannedError) -> SyntaxError {
        let base = self.offset(raw);
        let start = base + byte_of(raw, error.span.start.line, error.span.start.col);
        let end = (base + byte_of(raw, error.span.end.line, error.span.end.col)).max(start);
        let mut message = error.code.to_string();
        let mut help = None;
        let mut span = start..end;
        if let Some(comma) = decimal_comma(self.text, start) {
            message = format!("`{}` is no number", &self.text[comma.clone()]);
            help = Some(format!("decimal comma? write {}", self.text[comma.clone()].replace(',', ".")));
            span = comma;
        }
        SyntaxError { span, message, help }
    }
}

/// What stands between parentheses.
enum Inside<'a> {
    Named(Vec<(String, &'a RawValue)>),
    Items(Vec<&'a RawValue>),
}

impl<'de: 'a, 'a> Deserialize<'de> for Inside<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InsideVisitor;
        impl<'de> Visitor<'de> for InsideVisitor {
            type Value = Inside<'de>;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("named values")
            }

            fn visit_unit<E>(self) -> Result<Self::Value, E> {
                Ok(Inside::Items(Vec::new()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let mut items = Vec::new();
                while let Some(item) = seq.next_element()? {
                    items.push(item);
                }
                Ok(Inside::Items(items))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                entries(map).map(Inside::Named)
            }
        }
        deserializer.deserialize_any(InsideVisitor)
    }
}

/// `{"name": value}` with repeated names kept.
struct Entries<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Entries<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor;
        impl<'de> Visitor<'de> for EntriesVisitor {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("names in quotes with values")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                entries(map).map(Entries)
            }
        }
        deserializer.deserialize_map(EntriesVisitor)
    }
}

fn entries<'de, A: MapAccess<'de>>(mut map: A) -> Result<Vec<(String, &'de RawValue)>, A::Error> {
    let mut entries = Vec::new();
    while let Some(name) = map.next_key::<String>()? {
        entries.push((name, map.next_value()?));
    }
    Ok(entries)
}

/// Length of white space, comments and attributes at the start.
fn skip(text: &str) -> usize {
    skip_with(text, false)
}

/// The same, commas too.
fn skip_with(text: &str, commas: bool) -> usize {
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let white =
            rest.len() - rest.trim_start_matches(|c: char| c.is_whitespace() || (commas && c == ',')).len();
        if white > 0 {
            at += white;
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += block_comment(rest);
        } else if rest.starts_with("#![") {
            at += rest.find(']').map_or(rest.len(), |end| end + 1);
        } else {
            return at;
        }
    }
}

/// Length of a comment that may hold others.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0usize, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with("*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// Without white space and comments at the end. A value has no comment markers outside of texts, so the text is
/// walked from the start.
fn trim_end(raw: &str) -> &str {
    let (mut at, mut end) = (0, 0);
    while at < raw.len() {
        let rest = &raw[at..];
        let skipped = skip(rest);
        if skipped > 0 {
            at += skipped;
            continue;
        }
        at += token(rest);
        end = at;
    }
    &raw[..end]
}

/// Length of a text, a character or a single character of anything else.
fn token(rest: &str) -> usize {
    if let Some(length) = raw_string(rest) {
        return length;
    }
    let first = rest.chars().next().map_or(1, char::len_utf8);
    if rest.starts_with('"') {
        let mut escaped = false;
        for (i, c) in rest.char_indices().skip(1) {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => return i + 1,
                _ => {}
            }
        }
        return rest.len();
    }
    first
}

fn is_raw_string(text: &str) -> bool {
    raw_string(text).is_some()
}

/// Length of `r"..."` or `r#"..."#`.
fn raw_string(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('r')?;
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    let body = rest[hashes..].strip_prefix('"')?;
    let close = format!("\"{}", "#".repeat(hashes));
    let end = body.find(&close)?;
    Some(1 + hashes + 1 + end + close.len())
}

fn word_length(text: &str) -> usize {
    let starts = text.chars().next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !starts {
        return 0;
    }
    text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(text.len())
}

/// Byte of a line and a column, both counted from 1, columns in characters.
fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let start = if line <= 1 {
        0
    } else {
        text.match_indices('\n').nth(line - 2).map_or(text.len(), |(newline, _)| newline + 1)
    };
    let rest = &text[start..];
    start + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(byte, _)| byte)
}

/// `1,05` just before or at a place where reading failed.
fn decimal_comma(text: &str, at: usize) -> Option<Range<usize>> {
    let bytes = text.as_bytes();
    let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let end = text[at..].find('\n').map_or(text.len(), |newline| at + newline);
    let mut comma = (line..end).filter(|i| {
        bytes[*i] == b','
            && *i > line
            && bytes[*i - 1].is_ascii_digit()
            && bytes.get(*i + 1).is_some_and(u8::is_ascii_digit)
    });
    // The nearest one to the left of, or at, the place.
    let comma = comma.rfind(|i| *i <= at + 1)?;
    let digits = |c: &u8| c.is_ascii_digit() || *c == b'.';
    let start = comma - bytes[line..comma].iter().rev().take_while(|c| digits(c)).count();
    let stop = comma + 1 + bytes[comma + 1..end].iter().take_while(|c| c.is_ascii_digit()).count();
    Some(start..stop)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
// a diagram
Diagram(
    title: "T /* no comment */", // a title
    blocks: {
        "a": Gain(k: 2), /* b is next */
        "b": Clock,
        "c": Step(), "d": Sum(signs: ["+", "-"]),
    },
    empty: (), pair: (1, -2.5e3), flag: true,
)
"#;

    #[test]
    fn every_value_and_every_name_knows_its_place() {
        let root = read(TEXT).unwrap();
        assert_eq!(root.word(), Some("Diagram"));
        let members = root.members().unwrap();
        let names: Vec<_> = members.iter().map(|(name, _)| &TEXT[name.span.clone()]).collect();
        assert_eq!(names, ["title", "blocks", "empty", "pair", "flag"]);
        let blocks = members[1].1.members().unwrap();
        let texts: Vec<_> =
            blocks.iter().map(|(name, node)| (&TEXT[name.span.clone()], &TEXT[node.span.clone()])).collect();
        assert_eq!(
            texts,
            [
                ("\"a\"", "Gain(k: 2)"),
                ("\"b\"", "Clock"),
                ("\"c\"", "Step()"),
                ("\"d\"", "Sum(signs: [\"+\", \"-\"])")
            ]
        );
        assert_eq!(members[0].1.value, Shape::Text("T /* no comment */".to_owned()));
    }

    #[test]
    fn a_decimal_comma_is_recognised() {
        let error = read("Diagram(\n  blocks: {\n    \"pid\": Pid(kp: 1,05, ki: 2.0),\n  },\n)").unwrap_err();
        assert_eq!(error.message, "`1,05` is no number");
        assert_eq!(error.help.as_deref(), Some("decimal comma? write 1.05"));
    }

    #[test]
    fn repeated_names_are_kept_for_a_better_message() {
        assert_eq!(read("{\"a\": 1, \"a\": 2}").unwrap().members().unwrap().len(), 2);
    }

    #[test]
    fn text_that_is_no_ron_is_refused_with_a_place() {
        let error = read("Diagram(\n  title: \"x\"\n  blocks: {},\n)").unwrap_err();
        assert!(error.span.start >= 20, "{error:?}");
    }
}
