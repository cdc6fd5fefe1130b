//! What a parameter is worth now, and the two values of a switch.

use std::rc::Rc;

use blocksim_block::problem::Problem;
use blocksim_signal::{Lookup, Quantity, Scope as Names, Unit, Value, evaluate};

use super::range::Scale;
use crate::ast::Ast;
use crate::overrides::Replaced;
use crate::scope::{Scope, noted};
use crate::targets::{Spelling, Target};
use blocksim_syntax::{Node, Shape};

/// Numbers that differ by less than this share are the same: conversions of units round.
const SAME: f64 = 1e-12;

/// What a parameter is worth.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Now {
    Number(Quantity),
    Truth(bool),
    /// One of the words of its kind: `Clamping`.
    Word(String),
    /// Something that cannot change in a run, in words.
    Other(String),
}

impl Now {
    pub fn of(target: &Target) -> Now {
        match &target.value {
            Some(Value::Number(quantity)) => Now::Number(*quantity),
            Some(Value::Bool(value)) => Now::Truth(*value),
            Some(other) => Now::Other(other.describe()),
            None if target.spelling == Spelling::Text => Now::Other(format!("the text {}", target.written)),
            None => match evaluate(&target.written, &NoNames) {
                Ok(Value::Number(quantity)) => Now::Number(quantity),
                Ok(Value::Bool(value)) => Now::Truth(value),
                Ok(other) => Now::Other(other.describe()),
                Err(_) if target.spelling == Spelling::Word => Now::Word(target.written.clone()),
                Err(_) => Now::Other(format!("`{}`", target.written)),
            },
        }
    }

    /// Of what was set in its place.
    pub fn set(replaced: &Replaced) -> Now {
        match &replaced.worth {
            Some(Value::Number(quantity)) => Now::Number(*quantity),
            Some(Value::Bool(value)) => Now::Truth(*value),
            _ => Now::Word(replaced.written.clone()),
        }
    }

    /// In words, behind "is".
    pub fn described(&self, target: &Target) -> String {
        match self {
            Now::Number(quantity) => {
                let scale = Scale::of_target(target, *quantity);
                scale.told(scale.shown(quantity.value))
            }
            Now::Truth(value) => value.to_string(),
            Now::Word(word) => word.clone(),
            Now::Other(words) => words.clone(),
        }
    }

    /// Whether it can change at all while a model runs.
    pub fn changes(&self, target: &Target) -> bool {
        target.spelling != Spelling::Text && !matches!(self, Now::Other(_))
    }

    /// Two values that could be written.
    pub fn example(&self, target: &Target) -> String {
        match self {
            Now::Number(quantity) => {
                let text = Scale::of_target(target, *quantity).text().to_owned();
                if text.is_empty() { "0, 1".to_owned() } else { format!("\"0 {text}\", \"1 {text}\"") }
            }
            Now::Word(word) => format!("{word}, ..."),
            _ => "false, true".to_owned(),
        }
    }
}

/// A value of a switch.
pub(super) struct Choice {
    /// As `--set` takes it.
    pub text: String,
    value: Now,
}

impl Choice {
    pub fn is_same(&self, other: &Choice) -> bool {
        self.is(&other.value)
    }

    /// Whether this is the present value.
    pub fn is(&self, now: &Now) -> bool {
        match (&self.value, now) {
            (Now::Number(one), Now::Number(other)) => {
                (one.value - other.value).abs() <= SAME * one.value.abs().max(other.value.abs())
            }
            (one, other) => one == other,
        }
    }
}

/// Reads off or on; a bare number is in the unit that is written for the value.
pub(super) fn read(
    scope: &Rc<Scope>,
    ast: &Ast,
    node: &Node,
    target: &Target,
    now: &Now,
) -> Result<Choice, Problem> {
    let place = ast.place(&node.span);
    let refuse = |found: &str| {
        let told = format!("`{}` is {}, and cannot become {found}", target.name, now.described(target));
        Problem::error("panel", told).at(&place, "").help(format!("write {}", now.example(target)))
    };
    let (text, value, is_bare) = match &node.value {
        Shape::Bool(value) => (value.to_string(), Now::Truth(*value), false),
        Shape::Number(value) => (value.to_string(), Now::Number(Quantity::plain(*value)), true),
        Shape::Word(word) => (word.clone(), Now::Word(word.clone()), false),
        Shape::Text(text) => {
            let noted = noted(scope, text, ast.file, node.span.start + 1, &node.span)?;
            let value = match noted.value {
                Value::Number(quantity) => Now::Number(quantity),
                Value::Bool(value) => Now::Truth(value),
                other => return Err(refuse(&other.describe())),
            };
            (text.trim().to_owned(), value, noted.is_bare)
        }
        _ => return Err(refuse(&node.describe())),
    };
    match (value, now) {
        (Now::Number(new), Now::Number(old)) => {
            let scale = Scale::of_target(target, *old);
            let fits = old.dimension.is_none() || is_bare || old.dimension.takes(new.dimension);
            if !fits || !new.value.is_finite() {
                return Err(refuse(&text));
            }
            let value = match (&scale, is_bare) {
                (Scale::In(unit), true) => unit.to_si(new.value),
                (Scale::Decibels, true) => 10_f64.powf(new.value / 20.0),
                _ => new.value,
            };
            if let (Scale::Unclear(dimension, _), true) = (&scale, is_bare) {
                let told =
                    format!("`{}` is computed from values in other units, {text} has none", target.name);
                let help = format!("write the unit, such as \"{text} {}\"", Unit::si(*dimension).text);
                return Err(Problem::error("unit_mismatch", told).at(&place, "in which unit?").help(help));
            }
            Ok(Choice { text, value: Now::Number(Quantity { value, ..*old }) })
        }
        (value @ Now::Truth(_), Now::Truth(_)) | (value @ Now::Word(_), Now::Word(_)) => {
            Ok(Choice { text, value })
        }
        _ => Err(refuse(&text)),
    }
}

/// Sees no parameters.
struct NoNames;

impl Names for NoNames {
    fn lookup(&self, _: &str) -> Lookup {
        Lookup::Unknown
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}
