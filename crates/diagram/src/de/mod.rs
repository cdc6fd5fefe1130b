//! Typed parameters from written ones: wherever a number is asked for, a text is an expression.
//!
//! Problems are noted where they arise, with their place; what travels back through serde is only a sign that one
//! was noted, because the way leads through type-erased code that keeps nothing but text.

mod computed;
mod deserializer;
mod members;
mod tagged;
mod wire;
mod word_or;
mod written;

use std::cell::{Cell, RefCell};
use std::fmt::Display;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_block::{BlockInfo, ParamUnits};
use blocksim_signal::Dimension;

use crate::scope::Scope;
use blocksim_syntax::{Node, Shape};

pub(crate) use tagged::Tagged;
pub(crate) use word_or::{Either, word_or};
pub(crate) use written::Written;

/// What all values of one block share.
pub(crate) struct Reading<'a> {
    pub scope: Rc<Scope<'a>>,
    pub file: FileId,
    pub info: Option<&'static BlockInfo>,
    /// What is wrong, in the order in which it was found: at most one problem for each parameter.
    problems: RefCell<Vec<Problem>>,
    pub units: RefCell<ParamUnits>,
    /// Whether a bare number has no unit, rather than an open one.
    pub strict: bool,
    /// Bare numbers in places that have a unit, where that is not allowed.
    pub bare: RefCell<Vec<Problem>>,
    /// Whether there are bare numbers in places that have no unit of their own.
    pub has_open: Cell<bool>,
    /// Numbers of the parameters in SI, as far as they are few.
    pub numbers: RefCell<Numbers>,
    /// What may stand in the place of a word or of a member without a name, as `offers` asks.
    pub offered: RefCell<Vec<&'static str>>,
}

/// A number without unit where one belongs.
pub(crate) fn bare_number(field: &str, value: f64, unit: &str) -> Problem {
    Problem::error("bare_number", format!("`{field}` is in {unit}, but `{value}` has no unit"))
        .help(format!("write \"{value} {unit}\", or the number in a unit of the same kind"))
}

/// Numbers by parameter, in the order in which they were read.
pub(crate) type Numbers = Vec<(String, Vec<f64>)>;

impl<'a> Reading<'a> {
    pub(crate) fn new(scope: Rc<Scope<'a>>, file: FileId, info: Option<&'static BlockInfo>) -> Self {
        Self {
            scope,
            file,
            info,
            problems: RefCell::default(),
            units: RefCell::default(),
            numbers: RefCell::default(),
            strict: false,
            bare: RefCell::default(),
            has_open: Cell::default(),
            offered: RefCell::default(),
        }
    }

    /// The same where a bare number has no unit.
    pub(crate) fn strict(self, strict: bool) -> Self {
        Self { strict, ..self }
    }

    /// Notes a bare number in a place without a unit of its own. Zero is the same in every unit.
    fn note_open(&self, value: f64) {
        self.has_open.set(self.has_open.get() || value != 0.0);
    }

    /// Notes a bare number in a place with a unit. Zero and infinity are the same in every unit.
    fn note_bare(&self, field: Option<&str>, value: f64, dimension: Dimension, node: &Node) {
        if !self.strict || dimension.is_none() || value == 0.0 || !value.is_finite() {
            return;
        }
        let unit = field.and_then(|field| {
            let parameter = self.info?.parameters.iter().find(|parameter| parameter.name == field)?;
            (!parameter.unit.is_empty()).then(|| parameter.unit.to_owned())
        });
        let unit = unit.unwrap_or_else(|| dimension.to_string());
        let field = field.unwrap_or("the value");
        let place = self.place(node);
        let mut problem = bare_number(field, value, &unit).at(&place, "has no unit");
        if let Shape::Number(_) = &node.value
            && let Some(old) = self.scope.sources.file(place.file).text.get(place.span.clone())
        {
            problem = problem.edit(place, old, format!("\"{old} {unit}\""));
        }
        self.bare.borrow_mut().push(problem);
    }

    fn note(&self, problem: Problem) -> Noted {
        self.problems.borrow_mut().push(problem);
        Noted(String::new())
    }

    /// What was noted, each with its place.
    pub(crate) fn noted(&self) -> Vec<Problem> {
        self.problems.take()
    }

    /// Why something could not be read: the problems that were noted, or what serde reports, which has no place.
    pub(crate) fn problems(&self, noted: Noted, whole: &Place) -> Vec<Problem> {
        let mut problems = self.problems.take();
        if problems.is_empty() && !noted.0.is_empty() {
            problems.push(Problem::error("parameter", noted.0).at(whole, ""));
        }
        problems
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

    /// The first of [`problems`](Self::problems).
    pub(crate) fn problem(&self, noted: Noted, whole: &Place) -> Problem {
        let first = self.problems(noted, whole).into_iter().next();
        first.unwrap_or_else(|| Problem::error("parameter", "this cannot be read").at(whole, ""))
    }

    fn place(&self, node: &Node) -> Place {
        Place { file: self.file, span: node.span.clone() }
    }
}

/// A problem was noted, or serde says something that has no place yet.
#[derive(Debug, Default)]
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
