//! Values that replace others: a bare number has the unit in which the one before is written.

mod unit;

use std::rc::Rc;

use blocksim_block::problem::{FileId, Problem};
use blocksim_signal::{Dimension, Quantity, Unit, Value};

use crate::scope::{Evaluation, Scope, noted};
use blocksim_syntax::{Node, Shape};

pub(crate) use unit::Place;
pub use unit::WrittenUnit;

/// A value that replaces another.
pub(crate) struct Replacing<'s, 'a> {
    /// What is replaced, for messages: `demand.after`.
    pub target: &'s str,
    /// Where the new value is meant.
    pub scope: &'s Rc<Scope<'a>>,
    /// The file of the new value.
    pub file: FileId,
    /// The unit that the manual shows; empty where that follows from use.
    pub unit: &'s str,
}

/// A value as it is meant.
#[derive(Debug)]
pub(crate) struct Meant {
    /// To be read in place of the new value.
    pub node: Node,
    /// For people: `45 deg`, `[10 deg, 20 deg]`; `None` for what has no short form, such as a set.
    pub text: Option<String>,
}

impl<'a> Replacing<'_, 'a> {
    /// What a new value means in the place of an old one; `None` where nothing was written.
    ///
    /// # Errors
    /// A unit of another dimension than the one that is written; a bare number where it is not clear in which unit the old
    /// value is written.
    pub(crate) fn meaning(&self, new: &Node, old: Option<&Place<'a>>) -> Result<Meant, Problem> {
        let same = |text: Option<String>| Meant { node: new.clone(), text };
        match &new.value {
            Shape::Number(value) => self.number(new, *value, old),
            Shape::Text(text) => match noted(self.scope, text, self.file, 0, &(0..0)) {
                Ok(noted) if noted.is_bare && noted.value.as_number().is_some() => {
                    let value = noted.value.as_number().map_or(f64::NAN, |number| number.value);
                    self.number(new, value, old)
                }
                // Items are judged one by one: `[3, 4 m]`.
                Ok(noted) if noted.value.as_list().is_some() && items(text).is_some() => {
                    let all = items(text).unwrap_or_default();
                    let node = |text: &str| Node {
                        span: new.span.clone(),
                        value: Shape::Text(text.trim().to_owned()),
                    };
                    let list = Shape::List(all.into_iter().map(node).collect());
                    self.meaning(&Node { span: new.span.clone(), value: list }, old)
                }
                Ok(noted) => {
                    self.check(noted.value.as_number(), text, old)?;
                    Ok(same(Some(text.clone())))
                }
                // Whoever reads it says what is wrong.
                Err(_) => Ok(same(Some(text.clone()))),
            },
            Shape::List(items) => {
                let mut meant = Vec::with_capacity(items.len());
                for (n, item) in items.iter().enumerate() {
                    meant.push(self.meaning(item, self.item(old, n).as_ref())?);
                }
                let texts: Option<Vec<String>> = meant.iter().map(|item| item.text.clone()).collect();
                let nodes = meant.into_iter().map(|item| item.node).collect();
                let node = Node { span: new.span.clone(), value: Shape::List(nodes) };
                Ok(Meant { node, text: texts.map(|texts| format!("[{}]", texts.join(", "))) })
            }
            Shape::Map(members) | Shape::Struct(None, members) => {
                let mut meant = Vec::with_capacity(members.len());
                for (name, node) in members {
                    let below = old.and_then(|old| old.member(&name.text));
                    meant.push((name.clone(), self.meaning(node, below.as_ref())?.node));
                }
                Ok(Meant { node: Node { span: new.span.clone(), value: Shape::Map(meant) }, text: None })
            }
            Shape::Word(word) => Ok(same(Some(word.clone()))),
            Shape::Bool(value) => Ok(same(Some(value.to_string()))),
            _ => Ok(same(None)),
        }
    }

    /// The item of a list that a new one replaces; one behind the last is like the last.
    fn item(&self, old: Option<&Place<'a>>, n: usize) -> Option<Place<'a>> {
        let old = old?;
        let count = match &old.value()? {
            Value::List(items) => items.len(),
            _ => return None,
        };
        let at = format!("[{}]", n.min(count.checked_sub(1)?));
        // A list that is computed as a whole, `"[10 deg, 20 deg]"`, is asked as a whole.
        Some(old.member(&at).unwrap_or_else(|| old.clone()))
    }

    fn number(&self, new: &Node, value: f64, old: Option<&Place<'a>>) -> Result<Meant, Problem> {
        let Some(dimension) = old.and_then(Place::dimension) else { return Ok(self.in_manual(new, value)) };
        let unit = match old.map_or(WrittenUnit::Si, |old| old.unit(dimension)) {
            WrittenUnit::One(unit) => unit.text,
            WrittenUnit::Decibels => "dB".to_owned(),
            WrittenUnit::Si if dimension == Dimension::NONE => {
                return Ok(self.in_manual(new, value));
            }
            WrittenUnit::Si => Unit::si(dimension).text,
            WrittenUnit::Unclear => {
                let message = format!(
                    "`{}` is computed from values in other units, {} has none",
                    self.target,
                    number(value)
                );
                let help = format!("write the unit, such as {}", in_unit(value, &Unit::si(dimension).text));
                return Err(Problem::error("unit_mismatch", message).help(help));
            }
        };
        let text = in_unit(value, &unit);
        Ok(Meant {
            node: Node { span: new.span.clone(), value: Shape::Text(text.clone()) },
            text: Some(text),
        })
    }

    /// A bare number stays one, and is in the unit of the manual.
    fn in_manual(&self, new: &Node, value: f64) -> Meant {
        let text = match Unit::parse(self.unit) {
            Ok(unit) if unit.dimension != Dimension::NONE => in_unit(value, self.unit),
            _ => number(value),
        };
        let node = Node { span: new.span.clone(), value: Shape::Number(value) };
        Meant { node, text: Some(text) }
    }

    /// Refuses a number whose unit measures something else than the one that is written.
    fn check(&self, new: Option<Quantity>, text: &str, old: Option<&Place<'a>>) -> Result<(), Problem> {
        let (Some(new), Some(old)) = (new, old) else { return Ok(()) };
        let Some(dimension) = old.dimension() else { return Ok(()) };
        let unit = match old.unit(dimension) {
            WrittenUnit::One(unit) => unit.text,
            WrittenUnit::Si if dimension == Dimension::NONE => return Ok(()),
            _ => Unit::si(dimension).text,
        };
        if dimension.takes(new.dimension) {
            return Ok(());
        }
        let found = match new.dimension.is_none() {
            true => "has no unit".to_owned(),
            false => format!("is in {}", new.dimension),
        };
        Err(Problem::error(
            "unit_mismatch",
            format!("`{}` is written in {unit}, but `{text}` {found}", self.target),
        )
        .help(format!("write a value in {unit} or a unit of the same kind")))
    }
}

impl<'a> Place<'a> {
    fn value(&self) -> Option<Value> {
        let stack = Vec::new();
        Evaluation { scope: &self.scope, file: self.file, stack: &stack }.value(&self.node).ok()
    }

    /// The dimension of a number, or of all numbers of a list.
    fn dimension(&self) -> Option<Dimension> {
        match self.value()? {
            Value::Number(number) => Some(number.dimension),
            Value::List(items) => {
                let mut all = items.iter().map(|item| item.as_number().map(|number| number.dimension));
                let first = all.next()??;
                all.all(|other| other == Some(first)).then_some(first)
            }
            _ => None,
        }
    }

    fn member(&self, name: &str) -> Option<Place<'a>> {
        self.clone().below(&[name.to_owned()], 0)
    }
}

/// The items of `[a, b]`; `None` where the text is not one list in brackets.
fn items(text: &str) -> Option<Vec<&str>> {
    let inside = text.trim().strip_prefix('[')?.strip_suffix(']')?;
    let (mut all, mut start, mut depth) = (Vec::new(), 0, 0_usize);
    for (at, sign) in inside.char_indices() {
        match sign {
            '(' | '[' => depth += 1,
            // `[a] + [b]` closes what it has not opened.
            ')' | ']' => depth = depth.checked_sub(1)?,
            ',' if depth == 0 => {
                all.push(&inside[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    // One comma may stand at the end.
    if !inside[start..].trim().is_empty() {
        all.push(&inside[start..]);
    }
    Some(all)
}

/// A number with its unit as an expression.
pub(crate) fn in_unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", number(value))
}

/// A number with all its digits.
fn number(value: f64) -> String {
    Quantity::plain(value).display()
}

#[cfg(test)]
mod tests;
