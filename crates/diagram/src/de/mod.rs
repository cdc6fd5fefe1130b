//! Typed parameters from written ones: wherever a number is asked for, a text is an expression.
//!
//! Problems are noted where they arise, with their place; what travels back through serde is only a sign that one
//! was noted, because the way leads through type-erased code that keeps nothing but text.

mod asked;
mod computed;
mod members;
mod tagged;
mod wire;
mod word_or;
mod written;

use std::cell::RefCell;
use std::fmt::Display;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_block::{BlockInfo, ParamUnits};
use blocksim_signal::Dimension;

use crate::scope::Scope;
use crate::tree::Node;

pub(crate) use tagged::Tagged;
pub(crate) use word_or::{Either, word_or};
pub(crate) use written::Written;

/// What all values of one block share.
pub(crate) struct Reading<'a> {
    pub scope: Rc<Scope<'a>>,
    pub file: FileId,
    pub info: Option<&'static BlockInfo>,
    pub problem: RefCell<Option<Problem>>,
    pub units: RefCell<ParamUnits>,
    /// Numbers of the parameters in SI, as far as they are few.
    pub numbers: RefCell<Numbers>,
}

/// Numbers by parameter, in the order in which they were read.
pub(crate) type Numbers = Vec<(String, Vec<f64>)>;

impl<'a> Reading<'a> {
    pub(crate) fn new(scope: Rc<Scope<'a>>, file: FileId, info: Option<&'static BlockInfo>) -> Self {
        Self {
            scope,
            file,
            info,
            problem: RefCell::default(),
            units: RefCell::default(),
            numbers: RefCell::default(),
        }
    }

    fn note(&self, problem: Problem) -> Noted {
        self.problem.borrow_mut().get_or_insert(problem);
        Noted(String::new())
    }

    /// Keeps a number of a parameter. Tables are not looked at number by number.
    fn keep(&self, field: &str, number: f64) {
        const MOST: usize = 16;
        let mut numbers = self.numbers.borrow_mut();
        match numbers.iter_mut().find(|(known, _)| known == field) {
            Some((_, list)) if list.len() <= MOST => list.push(number),
            Some(_) => {}
            None => numbers.push((field.to_owned(), vec![number])),
        }
    }

    fn place(&self, node: &Node) -> Place {
        Place { file: self.file, span: node.span.clone() }
    }
}

/// A problem was noted, or serde says something that has no place yet.
#[derive(Debug)]
pub(crate) struct Noted(pub String);

impl Display for Noted {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Noted {}

impl serde::de::Error for Noted {
    fn custom<T: Display>(message: T) -> Self {
        Noted(message.to_string())
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Noted(format!("`{field}` is not known here; known are {}", crate::problems::list(expected)))
    }

    fn missing_field(field: &'static str) -> Self {
        Noted(format!("`{field}` is missing"))
    }
}

/// What is expected of the numbers of a parameter.
#[derive(Clone, Copy)]
pub(crate) struct Expected<'k> {
    /// Top-level name of the parameter.
    field: Option<&'k str>,
    /// Its dimension, where it is fixed.
    dimension: Option<Dimension>,
}
