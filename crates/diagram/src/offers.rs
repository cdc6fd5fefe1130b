//! What may stand at a place inside of a block: alternatives, members of named sets.
//!
//! The types of the parameters know it. They are asked as they are when a diagram is read, with a word that no text can
//! hold at the place in question; what they would take instead is in their answer.

use std::rc::Rc;

use blocksim_block::problem::FileId;
use blocksim_block::{BlockInfo, Draft};
use serde::Deserialize;

use crate::de::{Reading, Tagged, Written};
use crate::scope::Scope;
use crate::settings;
use crate::source::{Reader, Sources};
use blocksim_syntax::{Name, Node, Shape};

/// A bracket around a place, from the block inwards.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// The name that it is the value of; empty in a list.
    pub key: String,
    /// The word before it; empty without.
    pub word: String,
    /// `(`, `[` or `{`.
    pub sign: char,
}

/// The kind under which the settings of a run are asked for.
pub const SIMULATION: &str = "simulation";

/// Words that may stand as the value of `key` in the innermost bracket; nothing where a value of another sort belongs.
pub fn words(kind: &str, brackets: &[Step], key: &str) -> Vec<&'static str> {
    ask(kind, brackets, key)
}

/// Names of the members of the innermost bracket; nothing where it has none of its own.
pub fn members(kind: &str, brackets: &[Step]) -> Vec<&'static str> {
    ask(kind, brackets, "")
}

fn ask(kind: &str, brackets: &[Step], key: &str) -> Vec<&'static str> {
    let mut inner = (key.to_owned(), node(Shape::Word(String::new())));
    for step in brackets.iter().rev() {
        let (key, value) = inner;
        let member = |value| vec![(Name { text: key, span: 0..0 }, value)];
        let name = (!step.word.is_empty()).then(|| Name { text: step.word.clone(), span: 0..0 });
        let shape = match step.sign {
            '[' => Shape::List(vec![value]),
            '{' => Shape::Map(member(value)),
            _ => Shape::Struct(name, member(value)),
        };
        inner = (step.key.clone(), node(shape));
    }
    let sources = Sources::new(&WithoutFiles);
    let scope = Rc::new(Scope::new(&sources, None));
    let top = inner.1;
    if kind == SIMULATION {
        let reading = Reading::new(scope, FileId(0), None);
        settings::ask(Written::new(&reading, &top));
        return reading.offered.take();
    }
    let Some(info) = BlockInfo::find(kind) else { return Vec::new() };
    let reading = Reading::new(scope, FileId(0), Some(info));
    let body = Written::new(&reading, &top);
    let answer = Draft::deserialize(Tagged { kind, body });
    drop(answer);
    reading.offered.take()
}

fn node(value: Shape) -> Node {
    Node { span: 0..0, value }
}

struct WithoutFiles;

impl Reader for WithoutFiles {
    fn read(&self, _path: &std::path::Path) -> Result<String, String> {
        Err("there are no files here".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(key: &str, word: &str) -> Step {
        Step { key: key.to_owned(), word: word.to_owned(), sign: '(' }
    }

    #[test]
    fn settings_know_their_words_and_members() {
        let top = [step("", "")];
        assert!(words(SIMULATION, &top, "solver").contains(&"RosW3"));
        assert_eq!(words(SIMULATION, &top, "stop_time"), ["Auto"]);
        assert_eq!(words(SIMULATION, &top, "start"), ["Given", "Steady"]);
        let solver = [step("", ""), step("solver", "Ode45")];
        assert_eq!(members(SIMULATION, &solver), ["rtol", "atol", "max_step"]);
        assert!(words(SIMULATION, &solver, "rtol").is_empty());
        assert!(words("NoSuchKind", &top, "a").is_empty());
    }
}
