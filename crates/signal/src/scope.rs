//! Where expressions find their names.

use crate::Value;

/// Where an expression finds its names.
pub trait Scope {
    /// The value of a name. Only the first name of a path is looked up; the rest is selected from sets and lists.
    fn lookup(&self, name: &str) -> Lookup;

    /// All names, for spelling help.
    fn names(&self) -> Vec<String>;
}

/// What a scope says to a name.
#[derive(Debug, Clone, PartialEq)]
pub enum Lookup {
    /// The value.
    Found(Value),
    /// No such name here.
    Unknown,
    /// The name exists but has no value, with the reason.
    Failed(String),
}
