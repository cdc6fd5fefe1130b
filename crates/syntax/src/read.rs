//! Text becomes a tree with places.
//!
//! What is common is read in one pass (`common`). All else, and every mistake, is read by `ron`: each value is taken as raw text that
//! still lies in the file, so its place is known; what is inside is read the same way.

use std::ops::Range;

use ron::Options;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::scan::{byte_of, decimal_comma, is_raw_string, skip, skip_with, token, trim_end, word_length};
use crate::tree::{Name, Node, Shape};
use crate::{common, mistakes};

/// Text that is no RON.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// Where.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// A second place and what is to be seen there.
    pub beside: Option<(Range<usize>, String)>,
    /// The change that mends it, where no other one is likely.
    pub remedy: Option<Box<Remedy>>,
}

impl SyntaxError {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>) -> SyntaxError {
        SyntaxError { span, message: message.into(), help: None, beside: None, remedy: None }
    }

    pub(super) fn help(self, help: impl Into<String>) -> SyntaxError {
        SyntaxError { help: Some(help.into()), ..self }
    }

    pub(super) fn beside(self, place: Range<usize>, seen: impl Into<String>) -> SyntaxError {
        SyntaxError { beside: Some((place, seen.into())), ..self }
    }
}

/// A change that makes RON of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remedy {
    /// Bytes that are replaced.
    pub span: Range<usize>,
    /// What stands there.
    pub old: String,
    /// What is to stand there.
    pub new: String,
}

/// Reads a text: values of any kind, each with its place.
///
/// # Errors
/// The first place that is no RON.
pub fn read(text: &str) -> Result<Node, SyntaxError> {
    read_once(text).map_err(|error| {
        // A mistake behind the place where reading failed is another one.
        let mistake = mistakes::first(text).filter(|mistake| {
            error.remedy.is_none()
                && trim_end(&text[..mistake.at]).len() <= error.span.end.max(error.span.start)
        });
        match mistake {
            Some(mistake) => mistake.error,
            None => missing_comma(text, &error).unwrap_or(error),
        }
    })
}

/// Most elements of a list.
const MOST_ITEMS: usize = 1_000_000;

fn read_once(text: &str) -> Result<Node, SyntaxError> {
    let reader = Reader { text };
    let scalar = |raw: &str| match raw.starts_with('"') {
        true => reader.parse::<String>(raw).map(Shape::Text).ok(),
        false => reader.parse::<f64>(raw).map(Shape::Number).ok(),
    };
    match common::read(text, MOST_ITEMS, &scalar) {
        Some(node) => Ok(node),
        None => read_rare(text),
    }
}

/// Any text, by `ron`.
fn read_rare(text: &str) -> Result<Node, SyntaxError> {
    let reader = Reader { text };
    if skip(text) == text.len() {
        return Err(SyntaxError::new(0..0, "there is nothing in this file"));
    }
    let raw: &RawValue = options().from_str(text).map_err(|error| reader.error(text, &error))?;
    reader.node(raw.get_ron())
}

/// A comma that is missing before the place where reading failed: with it, reading gets further.
fn missing_comma(text: &str, error: &SyntaxError) -> Option<SyntaxError> {
    let start = error.span.start;
    let end = trim_end(text.get(..start)?).len();
    let begins_anew = end < start && text[start..].starts_with(|c: char| !",:)]}".contains(c));
    if !begins_anew || error.remedy.is_some() || text[..end].ends_with(['(', '[', '{', ',', ':']) {
        return None;
    }
    let with_comma = format!("{},{}", &text[..end], &text[end..]);
    if read_once(&with_comma).is_err_and(|other| other.span.start <= start + 1) {
        return None;
    }
    let remedy = Remedy { span: end..end, old: String::new(), new: ",".to_owned() };
    let told = SyntaxError::new(error.span.clone(), "a comma is missing before this");
    Some(SyntaxError { remedy: Some(Box::new(remedy)), ..told.help("write `,` between two values") })
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
                if items.len() > MOST_ITEMS {
                    let start = self.offset(raw);
                    let message = format!("this list has {} elements, more than {MOST_ITEMS}", items.len());
                    let help = "keep long tables in a file of their own, which `FromFile` reads";
                    return Err(SyntaxError::new(start..start + 1, message).help(help));
                }
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
            let written = &self.text[start..node.span.start];
            // A name in quotes may hold a colon.
            let length = match written.starts_with('"') || is_raw_string(written) {
                true => token(written),
                false => trim_end(&written[..written.find(':').unwrap_or(0)]).len(),
            };
            let end = start + length;
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
        let mut message = match &error.code {
            ron::Error::ExpectedComma => "a `,` or a closing bracket is missing here".to_owned(),
            ron::Error::ExpectedMapColon => "a `:` is missing here".to_owned(),
            ron::Error::ExceededRecursionLimit => "there are too many brackets inside each other".to_owned(),
            other => other.to_string(),
        };
        let mut help = None;
        let mut span = start..end;
        let mut remedy = None;
        if let Some(comma) = decimal_comma(self.text, start) {
            message = format!("`{}` is not a number", &self.text[comma.clone()]);
            let (old, new) = (&self.text[comma.clone()], self.text[comma.clone()].replace(',', "."));
            help = Some(format!("decimal comma? write {new}"));
            remedy = Some(Box::new(Remedy { span: comma.clone(), old: old.to_owned(), new }));
            span = comma;
        }
        SyntaxError { span, message, help, beside: None, remedy }
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
        assert_eq!(error.message, "`1,05` is not a number");
        assert_eq!(error.help.as_deref(), Some("decimal comma? write 1.05"));
    }

    #[test]
    fn a_missing_comma_is_found_where_it_belongs() {
        let text = "(\n  a: \"x\" // the first\n  b: [1 2],\n)";
        let error = read(text).unwrap_err();
        assert_eq!(
            (error.message.as_str(), &text[error.span.start..][..1]),
            ("a comma is missing before this", "b")
        );
        let remedy = error.remedy.expect("a comma");
        assert_eq!((remedy.span, remedy.new.as_str()), (10..10, ","));
        let error = read(&text.replace("\"x\"", "\"x\",")).unwrap_err();
        assert_eq!(error.remedy.map(|remedy| remedy.span), Some(32..32));
        for other in ["(a: 1", "[1, 2)", "(a: )", "(a: 1, b)"] {
            assert_eq!(read(other).unwrap_err().remedy, None, "{other}");
        }
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

    #[test]
    fn deeply_nested_brackets_are_refused_without_taking_the_stack() {
        for (open, close) in
            [("[", "]"), ("(", ")"), ("{\"a\": ", "}"), ("A(a: ", ")"), ("A(", ")"), ("/*", "*/")]
        {
            let text = format!("{}1{}", open.repeat(10_000), close.repeat(10_000));
            assert!(read(&text).is_err(), "{open}");
            assert!(read(&open.repeat(10_000)).is_err(), "{open}");
        }
    }

    #[test]
    fn what_a_person_writes_is_not_too_deep() {
        let text = format!("{}1{}", "[".repeat(60), "]".repeat(60));
        assert!(read(&text).is_ok());
    }

    #[test]
    fn a_list_of_a_hundred_thousand_numbers_is_read() {
        let node = read(&format!("[{}]", "1.5, ".repeat(100_000))).expect("RON");
        assert!(matches!(node.value, Shape::List(items) if items.len() == 100_000));
    }

    /// What is read in one pass, if anything is; `ron` has to read the same.
    fn compare(text: &str) -> bool {
        let reader = Reader { text };
        let scalar = |raw: &str| match raw.starts_with('"') {
            true => reader.parse::<String>(raw).map(Shape::Text).ok(),
            false => reader.parse::<f64>(raw).map(Shape::Number).ok(),
        };
        let common = common::read(text, MOST_ITEMS, &scalar);
        if let Some(node) = &common {
            assert_eq!(read_rare(text).as_ref(), Ok(node), "{text}");
        }
        common.is_some()
    }

    fn files(folder: &std::path::Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            match entry.file_type().unwrap().is_dir() {
                true if entry.file_name() != "runs" => files(&path, found),
                false if path.extension().is_some_and(|ending| ending == "ron") => {
                    found.push(std::fs::read_to_string(&path).unwrap());
                }
                _ => {}
            }
        }
    }

    #[test]
    fn all_files_of_the_project_are_read_in_one_pass_as_ron_reads_them() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut texts = Vec::new();
        ["diagrams", "docs", "params"].iter().for_each(|folder| files(&root.join(folder), &mut texts));
        assert!(texts.len() > 200, "{}", texts.len());
        assert!(texts.iter().all(|text| compare(text)));
    }

    #[test]
    fn damaged_texts_are_read_in_one_pass_as_ron_reads_them_or_not_at_all() {
        let signs = "()[]{}\"\\,:/*\n\r\t 0179.-+eE_aTrueinfNaN#r'bπ!\u{85}";
        let pieces = [
            "//",
            "/*",
            "*/",
            "/* /* */ */",
            "Some(1)",
            "()",
            "\"\\n\"",
            "1e5",
            "0x1F",
            "1_000",
            "-.5",
            "5.",
            "(a: 1)",
        ];
        let signs: Vec<String> = signs.chars().map(String::from).chain(pieces.map(str::to_owned)).collect();
        let mut state = 1_u64;
        let mut dice = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        let small =
            "(a: [1, 2.5e3, \"x\\\"\"], \"b\": {\"k\": Kind(c: true), \"w\": Word,}, /* c */ d: (1, -2),)";
        let mut read = 0;
        for round in 0..20_000 {
            let mut text: Vec<char> =
                if round % 2 == 0 { TEXT.chars().collect() } else { small.chars().collect() };
            for _ in 0..=dice(3) {
                let at = dice(text.len());
                let new = if dice(3) > 0 { signs[dice(signs.len())].as_str() } else { "" };
                let end = (at + dice(3)).min(text.len());
                text.splice(at..end, new.chars());
            }
            read += usize::from(compare(&text.iter().collect::<String>()));
        }
        assert!(read > 2000, "{read}");
    }
}
