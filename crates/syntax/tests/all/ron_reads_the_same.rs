//! The library `ron` as a second reader: what is read here has to be what it reads, of all files of the project and of damaged ones.

use std::fmt;
use std::path::Path;

use blocksim_syntax::{Node, Shape, read};
use ron::Options;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};

fn options() -> Options {
    Options::default().with_default_extension(
        Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES | Extensions::UNWRAP_VARIANT_NEWTYPES,
    )
}

/// Values with names, or values.
enum Inside<'a> {
    Named(Vec<(String, &'a RawValue)>),
    Items(Vec<&'a RawValue>),
}

impl<'de: 'a, 'a> Deserialize<'de> for Inside<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InsideVisitor;
        impl<'de> Visitor<'de> for InsideVisitor {
            type Value = Inside<'de>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("values")
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

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(name) = map.next_key::<String>()? {
                    entries.push((name, map.next_value()?));
                }
                Ok(Inside::Named(entries))
            }
        }
        deserializer.deserialize_any(InsideVisitor)
    }
}

/// What `ron` reads of the text of a value has to be what the tree holds.
#[track_caller]
fn compare(node: &Node, text: &str) {
    let raw = &text[node.span.clone()];
    let inside = |raw: &str| -> Vec<(String, String)> {
        match options().from_str(raw).unwrap_or_else(|error| panic!("{raw}: {error}\n{text}")) {
            Inside::Named(entries) => {
                entries.into_iter().map(|(name, value)| (name, value.trim().get_ron().to_owned())).collect()
            }
            Inside::Items(items) => {
                items.into_iter().map(|item| (String::new(), item.trim().get_ron().to_owned())).collect()
            }
        }
    };
    let same = |raw: &str, nodes: Vec<(&str, &Node)>| {
        let expected = inside(raw);
        let found: Vec<&str> = nodes.iter().map(|(name, _)| *name).collect();
        let expected_names: Vec<&str> = expected.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(found, expected_names, "{raw}\n{text}");
        for ((_, node), (_, raw)) in nodes.into_iter().zip(&expected) {
            // Comments may stand around a raw value.
            assert!(raw.contains(&text[node.span.clone()]), "{raw}\n{text}");
            compare(node, text);
        }
    };
    let fail = |error: ron::error::SpannedError| -> ! { panic!("{raw}: {error}\n{text}") };
    let named = |members: &'_ [(blocksim_syntax::Name, Node)]| {
        members.iter().map(|(name, node)| (name.text.clone(), node.clone())).collect::<Vec<_>>()
    };
    let brackets = &raw[raw.find(['(', '[', '{']).unwrap_or(0)..];
    match &node.value {
        Shape::Number(value) => {
            let expected: f64 = options().from_str(raw).unwrap_or_else(|error| fail(error));
            assert!(value.to_bits() == expected.to_bits() || value.is_nan() && expected.is_nan(), "{raw}");
        }
        Shape::Bool(value) => assert_eq!(raw, value.to_string()),
        Shape::Text(value) if raw.starts_with('\'') => {
            let expected: char = options().from_str(raw).unwrap_or_else(|error| fail(error));
            assert_eq!(*value, expected.to_string());
        }
        Shape::Text(value) => {
            let expected: String = options().from_str(raw).unwrap_or_else(|error| fail(error));
            assert_eq!(*value, expected);
        }
        Shape::Word(word) => assert_eq!(raw, word),
        Shape::List(items) => same(raw, items.iter().map(|item| ("", item)).collect()),
        Shape::Tuple(_, items) => same(brackets, items.iter().map(|item| ("", item)).collect()),
        Shape::Map(members) | Shape::Struct(_, members) => {
            let members = named(members);
            same(brackets, members.iter().map(|(name, node)| (name.as_str(), node)).collect());
        }
    }
}

/// Compares the readers. Whether they have read the text.
#[track_caller]
fn both(text: &str) -> bool {
    // Raw values may not end in a comment.
    let with_feed = format!("{text}\n");
    let theirs = options().from_str::<&RawValue>(&with_feed);
    match (read(text), theirs) {
        (Ok(node), Ok(_)) => {
            compare(&node, text);
            true
        }
        (Ok(_), Err(error)) => panic!("{text}\n{error}"),
        (Err(error), theirs) => {
            assert!(text.get(error.span).is_some(), "{text}");
            if let Some((place, _)) = error.beside {
                assert!(text.get(place).is_some(), "{text}");
            }
            if let Some(remedy) = error.remedy {
                assert_eq!(text.get(remedy.span), Some(remedy.old.as_str()), "{text}");
            }
            theirs.is_err()
        }
    }
}

fn files(folder: &Path, found: &mut Vec<String>) {
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
fn all_files_of_the_project() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut texts = Vec::new();
    ["diagrams", "docs", "params"].iter().for_each(|folder| files(&root.join(folder), &mut texts));
    assert!(texts.len() > 200, "{}", texts.len());
    for text in texts {
        assert!(read(&text).is_ok() && both(&text), "{text}");
    }
}

#[test]
fn what_is_rare_is_read_as_well() {
    for text in [
        "#![enable(implicit_some)]\n#![enable(unwrap_newtypes, )] (a: 1)",
        "'c'",
        "'\\''",
        "'\\\\'",
        "'\\u{e9}'",
        "\"\\x41\\u{1F600}\\n\\t\\r\\0\\\"\\'\\\\\"",
        "\"a\\\n   b\"",
        "\"a\\\r\n\tb\"",
        "\"a\nb\"",
        "r\"\\\"",
        "r#\"a\"b\"#",
        "r##\"a\"#b\"##",
        "-inf",
        "+inf",
        "inf",
        "NaN",
        "-NaN",
        "1_000.5_5",
        "5.",
        ".5",
        "-.5",
        "+1",
        "1e5",
        "1E-5",
        "1.5e+300",
        "1e999",
        "Größe(π: 1)",
        "A /* x */ (b /* y */ : /* z */ 1 // c\n, )",
        "{r#\"a\"#: 1}",
        "()",
        "A()",
        "A(())",
        "[[], {}, ()]",
        "(A, B(1), C(c: D))",
        "\u{200e}[1,\u{2028}2]\u{85}",
        "0.1",
        "123456789012345678901234567890",
        "-0",
        "1_",
        "1e_5",
    ] {
        assert!(both(text) && read(text).is_ok(), "{text}");
    }
}

#[test]
fn what_is_no_ron_is_refused_by_both() {
    for text in [
        "",
        "// a",
        "1 2",
        "(a: 1",
        "[1 2]",
        "[,]",
        "(a 1)",
        "{\"a\" 1}",
        "'ab'",
        "''",
        "\"\\q\"",
        "\"\\u{110000}\"",
        "\"\\u{}\"",
        "_1x-",
        "1.2.3",
        "0x1Fg",
        "-",
        "+",
        ".",
        "1._5",
        "-_1",
        "__(",
        "#![enable(what)] 1",
        "1 #![enable(implicit_some)]",
        "[1,,2]",
        "{\"a\": 1,,}",
        "A[1]",
        "A{\"a\": 1}",
        "\u{a0}1",
        "A A",
        "(a: 1, 2)",
        "(1, a: 2)",
        "<1>",
        "\"\\x8\"",
    ] {
        assert!(read(text).is_err() && both(text), "{text}: {:?}", read(text));
    }
}

#[test]
fn damaged_texts() {
    let signs = "()[]{}\"\\,:/*\n\r\t 0179.-+eE_aTrueinfNaN#'π!\u{85}";
    let pieces = [
        "//",
        "/*",
        "*/",
        "/* /* */ */",
        "Some(1)",
        "()",
        "\"\\n\"",
        "1e5",
        "1_000",
        "-.5",
        "5.",
        "(a: 1)",
        "'x'",
        "\"x\": ",
        "x: ",
        "[",
        "]",
    ];
    let signs: Vec<String> = signs.chars().map(String::from).chain(pieces.map(str::to_owned)).collect();
    let mut state = 1_u64;
    let mut dice = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let texts = [
        "(a: [1, 2.5e3, \"x\\\"\"], \"b\": {\"k\": Kind(c: true), \"w\": Word,}, /* c */ d: (1, -2),)",
        "Diagram(\n    title: \"T /* no comment */\", // a title\n    blocks: {\n        \"a\": Gain(k: 2), /* b is next */\n        \"b\": Clock, \"d\": Sum(signs: [\"+\", \"-\"]),\n    },\n    empty: (), pair: (1, -2.5e3), flag: true,\n)\n",
        "[1, [2.5, (3, 'c')], r#\"raw\"#, A(b: c), {\"d\": inf}]",
    ];
    let mut same = 0;
    for round in 0..30_000 {
        let mut text: Vec<char> = texts[round % texts.len()].chars().collect();
        for _ in 0..=dice(3) {
            let at = dice(text.len());
            let new = if dice(3) > 0 { signs[dice(signs.len())].as_str() } else { "" };
            let end = (at + dice(3)).min(text.len());
            text.splice(at..end, new.chars());
        }
        same += usize::from(both(&text.iter().collect::<String>()));
    }
    assert!(same > 25_000, "{same}");
}
