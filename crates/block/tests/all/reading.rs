//! A value that is read as a parameter is what it is without the way through the registry, and errors say the same.

use std::collections::BTreeMap;
use std::fmt::Debug;

use blocksim_block::prelude::*;

/// Alternatives of all sorts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
enum Law {
    Off,
    Line(f64),
    Between(f64, i32),
    Curve { x: Vec<f64>, y: Option<f64> },
}

/// A set with a default. Sets have names; a list is none.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Set {
    name: String,
    #[serde(default)]
    on: bool,
    pair: (u8, i64),
}

/// A number with a name of its own.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct Wrapped(f32);

/// All of them in one kind.
#[derive(Debug, Clone, PartialEq, BlockMeta)]
#[block(category = "Toys")]
struct Everything {
    /// A choice.
    #[block(default = Law::Off)]
    law: Law,
    /// A set.
    #[block(default = None)]
    set: Option<Set>,
    /// A number.
    #[block(default = Wrapped(0.0))]
    wrapped: Wrapped,
    /// Rows of numbers.
    #[block(default = Vec::new())]
    rows: Vec<[f64; 2]>,
    /// A count.
    #[block(default = 0)]
    count: usize,
    /// Numbers by name.
    #[block(default = BTreeMap::new())]
    named: BTreeMap<String, u16>,
    /// A letter.
    #[block(default = 'a')]
    letter: char,
    /// Nothing.
    #[block(default = ())]
    nothing: (),
}

impl Block for Everything {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new())
    }
}

/// Reads a text as a type, and as the parameter of a kind; both say the same.
#[track_caller]
fn same<T>(parameter: &str, of: fn(Everything) -> T, texts: &[&str])
where
    T: for<'de> Deserialize<'de> + PartialEq + Debug,
{
    // What stands behind an error of serde_json is the place in the text.
    let message = |error: serde_json::Error| error.to_string().split(" at line").next().map(str::to_owned);
    for text in texts {
        let alone = serde_json::from_str::<T>(text).map_err(message);
        let block = format!("{{\"{parameter}\": {text}}}");
        let mut json = serde_json::Deserializer::from_str(&block);
        let read = Everything::from_deserializer("Everything", &mut json).map(of).map_err(message);
        assert_eq!(read, alone, "{text}");
    }
}

#[test]
fn every_sort_of_value_is_read_as_it_is() {
    same("law", |all| all.law, &["\"Off\"", "{\"Line\": 2}", "{\"Line\": -2.5}", "{\"Between\": [1.5, -3]}"]);
    same("law", |all| all.law, &["{\"Curve\": {\"x\": [1, 2.5], \"y\": null}}", "{\"Curve\": {\"x\": []}}"]);
    same("set", |all| all.set, &["null", "{\"name\": \"n\", \"on\": true, \"pair\": [255, -7]}"]);
    same("wrapped", |all| all.wrapped, &["1.25", "3", "-3"]);
    same("rows", |all| all.rows, &["[]", "[[1, 2.5], [-3, 4e300]]"]);
    same("count", |all| all.count, &["0", "18446744073709551615"]);
    same("named", |all| all.named, &["{}", "{\"a\": 1, \"b\": 65535}"]);
    same("letter", |all| all.letter, &["\"ä\""]);
    same("nothing", |all| all.nothing, &["null"]);
}

#[test]
fn what_is_wrong_is_said_as_without_it() {
    same(
        "law",
        |all| all.law,
        &["\"Of\"", "{\"Line\": true}", "{\"Between\": [1]}", "{\"Between\": [1, 2.5]}"],
    );
    same(
        "law",
        |all| all.law,
        &["{\"Curve\": {}}", "{\"Curve\": {\"x\": 1}}", "{\"Curve\": {\"x\": [1], \"x\": []}}"],
    );
    same("set", |all| all.set, &["{}", "{\"name\": \"n\"}", "{\"naem\": 1}", "\"n\"", "3"]);
    same("set", |all| all.set, &["{\"name\": 3}", "{\"name\": [1]}"]);
    same("wrapped", |all| all.wrapped, &["\"1\"", "null", "[]", "{}", "true"]);
    same("rows", |all| all.rows, &["[[1]]", "[[1, 2, 3]]", "{}", "[[1, \"2\"]]"]);
    same("count", |all| all.count, &["1.5", "\"1\"", "[1]", "true"]);
    same("named", |all| all.named, &["[]", "1"]);
    same("letter", |all| all.letter, &["\"ab\"", "\"\"", "1"]);
    same("nothing", |all| all.nothing, &["1", "[]"]);
}

#[test]
fn whole_numbers_that_their_type_cannot_hold_are_explained_without_its_name() {
    for (parameter, text, expected) in [
        ("set", "{\"name\": \"n\", \"pair\": [256, 0]}", "expected a whole number up to 255, found 256"),
        ("count", "-1", "expected a whole number that is not negative, found -1"),
        ("named", "{\"a\": -1}", "expected a whole number that is not negative, found -1"),
        ("named", "{\"a\": 65536}", "expected a whole number up to 65535, found 65536"),
    ] {
        let block = format!("{{\"{parameter}\": {text}}}");
        let mut json = serde_json::Deserializer::from_str(&block);
        let error = Everything::from_deserializer("Everything", &mut json).expect_err(text).to_string();
        assert_eq!(error.split(" at line").next(), Some(expected), "{text}");
    }
}
