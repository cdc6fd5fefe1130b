//! RON text as a tree with places.
//!
//! No type is asked for yet: a value that makes no sense where it stands can be reported there, and does not hide
//! the others.

use std::ops::Range;

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
