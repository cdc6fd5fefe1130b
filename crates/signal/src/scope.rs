//! Where expressions find their names.

use crate::Value;

/// Where an expression finds its names.
pub trait Scope {
    /// The value of a name. Only the first name of a path is looked up; the rest is selected from sets and lists.
    fn lookup(&self, name: &str) -> Lookup;

    /// What members and items lead to from a name, without a copy of all the rest; `None` where the scope does not know that,
    /// which is no error: the name is looked up then, and its parts are selected one after the other.
    fn select(&self, _name: &str, _path: &[Part]) -> Option<Value> {
        None
    }

    /// All names, for spelling help.
    fn names(&self) -> Vec<String>;
}

/// A step into a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part<'a> {
    /// The member of a set.
    Member(&'a str),
    /// The item of a list, counted from 0.
    Item(usize),
}

impl Value {
    /// What a path leads to.
    pub fn at(&self, path: &[Part]) -> Option<&Value> {
        path.iter().try_fold(self, |value, part| match (value, part) {
            (Value::Set(members), Part::Member(name)) => {
                members.iter().find(|(known, _)| known == name).map(|(_, value)| value)
            }
            (Value::List(items), Part::Item(index)) => items.get(*index),
            _ => None,
        })
    }
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
