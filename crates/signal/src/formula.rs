//! Expressions kept as data: the law of something that is computed again and again.

mod check;
mod function;
mod reading;

use crate::{ExprError, Lookup, Quantity, Scope, Value, expression};
use std::ops::Range;

pub use function::Function;

/// An expression that was read but not computed: a flat list of nodes, each behind those that it needs; the last one is the value.
///
/// The grammar is that of [`evaluate`](crate::evaluate) without lists, members and items, and with comparisons
/// (`< <= > >= == !=`) and the functions `if`, `and`, `or`, `not`. Every name may stand in it; the nodes of an argument of a
/// function are those behind the argument before.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    text: String,
    nodes: Vec<Node>,
}

/// A part of a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// Its bytes in the text.
    pub span: Range<usize>,
    /// Whether it is true or false rather than a number.
    pub is_truth: bool,
}

/// What a part of a formula is; numbers of nodes stand for operands.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeKind {
    /// A number in SI.
    Number(Quantity),
    /// `true` or `false`.
    Truth(bool),
    /// A name.
    Name(String),
    /// `-a`.
    Negate(usize),
    /// `a + b` and its like.
    Binary(Operator, usize, usize),
    /// `a < b` and its like.
    Compare(Comparison, usize, usize),
    /// `a` times a unit of this size.
    Scale(usize, Quantity),
    /// A function of as many arguments as it takes.
    Call(Function, Vec<usize>),
}

/// An operator between numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `^`
    Power,
}

/// A comparison of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

impl Formula {
    /// Reads a text. `names` are those that are known beforehand: behind a unit and a `*` or `/` such a name ends the unit, as a
    /// parameter does in an expression.
    ///
    /// # Errors
    /// A text that cannot be read, an unknown function, a wrong number of arguments, a truth value in the place of a number or
    /// the reverse; with the bytes of the text.
    pub fn parse(text: &str, names: &[&str]) -> Result<Self, ExprError> {
        let mut reading = reading::Reading::default();
        expression::read(text, &Names(names), &mut reading)?;
        let mut formula = Self { text: text.to_owned(), nodes: reading.nodes };
        formula.settle_kinds()?;
        Ok(formula)
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text of a node.
    pub fn text_of(&self, node: usize) -> &str {
        &self.text[self.nodes[node].span.clone()]
    }

    /// The nodes; there is at least one.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Whether the value is true or false rather than a number.
    pub fn is_truth(&self) -> bool {
        self.nodes.last().is_some_and(|node| node.is_truth)
    }

    /// All names, each once, in the order of the text, and whether they stand for true or false.
    pub fn names(&self) -> Vec<(&str, bool)> {
        let mut names: Vec<(&str, bool)> = Vec::new();
        for node in &self.nodes {
            if let NodeKind::Name(name) = &node.kind
                && names.iter().all(|(known, _)| known != name)
            {
                names.push((name, node.is_truth));
            }
        }
        names
    }
}

/// A scope of names without values.
struct Names<'a>(&'a [&'a str]);

impl Scope for Names<'_> {
    fn lookup(&self, name: &str) -> Lookup {
        if self.0.contains(&name) { Lookup::Found(Value::Bool(true)) } else { Lookup::Unknown }
    }

    fn names(&self) -> Vec<String> {
        self.0.iter().map(ToString::to_string).collect()
    }
}

#[cfg(test)]
mod tests;
