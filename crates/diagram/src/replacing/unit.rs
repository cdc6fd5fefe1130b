//! The unit in which a value is written.

use std::rc::Rc;

use blocksim_block::problem::FileId;
use blocksim_signal::{Dimension, Unit};

use crate::scope::{Scope, described, noted, read_tree};
use blocksim_syntax::{Node, Shape};

/// How deep files and names may refer to each other.
const DEEPEST: usize = 20;

/// A written value, and where it is meant.
#[derive(Clone)]
pub(crate) struct Place<'a> {
    /// The names that it sees.
    pub scope: Rc<Scope<'a>>,
    /// The file that holds it.
    pub file: FileId,
    /// The value.
    pub node: Rc<Node>,
}

/// The unit in which a value is written.
#[derive(Debug, Clone, PartialEq)]
pub enum WrittenUnit {
    /// No unit stands there: a bare number is one in SI.
    Si,
    /// This one.
    One(Unit),
    /// A ratio in decibels, `"-3 dB"`.
    Decibels,
    /// Several stand there, or one that is not a unit of the result, as in `"10 deg / 2 s"`.
    Unclear,
}

impl<'a> Place<'a> {
    /// The parameter of a name, or what lies below it: `["robot", "axis1", "mass"]`, `["start", "[0]"]`.
    pub(crate) fn of(scope: &Rc<Scope<'a>>, names: &[String]) -> Option<Place<'a>> {
        let (first, rest) = names.split_first()?;
        let (scope, file, node) = scope.written(first)?;
        Place { scope, file, node }.below(rest, 0)
    }

    pub(super) fn below(self, names: &[String], depth: usize) -> Option<Place<'a>> {
        if depth > DEEPEST {
            return None;
        }
        let deeper = |node: Node| Place { node: Rc::new(node), ..self.clone() };
        match &self.node.value {
            Shape::Struct(None, members) if described(members).is_some() => {
                deeper(described(members)?.clone()).below(names, depth + 1)
            }
            _ if names.is_empty() => Some(self),
            Shape::Tuple(Some(word), items) if word.text == "File" => {
                let Shape::Text(path) = &items.first()?.value else { return None };
                let sources = self.scope.sources;
                let file = sources.open(&sources.folder(self.file).join(path)).ok()?;
                let node = read_tree(sources, file).ok()?;
                Place { file, node, ..self.clone() }.below(names, depth + 1)
            }
            Shape::Text(text) => {
                // One name and nothing else.
                let named = noted(&self.scope, text, self.file, 0, &(0..0)).ok()?.names;
                let [named] = named.as_slice() else { return None };
                let mut all = (named == text.trim()).then(|| segments(named))?;
                all.extend_from_slice(names);
                let (scope, file, node) = self.scope.written(&all[0])?;
                Place { scope, file, node }.below(&all[1..], depth + 1)
            }
            Shape::Map(members) | Shape::Struct(_, members) => {
                let (_, member) = members.iter().find(|(name, _)| name.text == names[0])?;
                deeper(member.clone()).below(&names[1..], depth + 1)
            }
            Shape::List(items) => {
                let index = names[0].strip_prefix('[')?.strip_suffix(']')?;
                let item = items.get(index.trim().parse::<usize>().ok()?)?;
                deeper(item.clone()).below(&names[1..], depth + 1)
            }
            _ => None,
        }
    }

    /// The unit in which the value is written, which has this dimension.
    pub(crate) fn unit(&self, dimension: Dimension) -> WrittenUnit {
        if self.in_decibels(0) {
            return WrittenUnit::Decibels;
        }
        let mut all = Vec::new();
        self.units(&mut all, 0);
        let mut fit: Vec<&Unit> = Vec::new();
        for unit in all.iter().filter(|unit| unit.dimension == dimension) {
            if !fit.iter().any(|known| known.scale == unit.scale && known.offset == unit.offset) {
                fit.push(unit);
            }
        }
        match fit.as_slice() {
            [one] => WrittenUnit::One((*one).clone()),
            // What is computed of SI units alone is in SI, but for cycles: Hz may have become rad/s.
            [] if all.iter().all(|unit| is_si(unit) && cycles(unit.dimension) == cycles(dimension)) => {
                WrittenUnit::Si
            }
            _ => WrittenUnit::Unclear,
        }
    }

    /// A unit with a zero of its own, such as degC, in which the value or a part of it is written: here, or where a parameter that
    /// stands here alone has its value from.
    pub(crate) fn own_zero(&self) -> Option<Unit> {
        self.own_zero_at(0)
    }

    fn own_zero_at(&self, depth: usize) -> Option<Unit> {
        if depth > DEEPEST {
            return None;
        }
        let deeper = |node: &Node| match &node.value {
            // Tables of numbers are not copied.
            Shape::Number(_) | Shape::Bool(_) | Shape::Word(_) => None,
            _ => Place { node: Rc::new(node.clone()), ..self.clone() }.own_zero_at(depth + 1),
        };
        match &self.node.value {
            Shape::Text(text) => {
                let noted = noted(&self.scope, text, self.file, 0, &(0..0)).ok()?;
                if let Some(unit) = noted.units.into_iter().find(|unit| unit.offset != 0.0) {
                    return Some(unit);
                }
                // What is computed, as `hot - cold`, may be a difference.
                let named = noted.names.first().filter(|named| *named == text.trim())?;
                let names = segments(named);
                let place = match self.scope.replaced(&names) {
                    Some((place, rest)) => place.below(rest, 0)?,
                    None => Place::of(&self.scope, &names)?,
                };
                place.own_zero_at(depth + 1)
            }
            Shape::List(items) => items.iter().find_map(deeper),
            Shape::Struct(None, members) => match described(members) {
                Some(value) => deeper(value),
                None => members.iter().find_map(|(_, member)| deeper(member)),
            },
            Shape::Map(members) => members.iter().find_map(|(_, member)| deeper(member)),
            _ => None,
        }
    }

    /// Whether a ratio in decibels stands here, or where a parameter that stands here alone has its value from.
    fn in_decibels(&self, depth: usize) -> bool {
        if depth > DEEPEST {
            return false;
        }
        match &self.node.value {
            Shape::Text(text) => {
                let Ok(noted) = noted(&self.scope, text, self.file, 0, &(0..0)) else { return false };
                let alone = noted.names.first().filter(|named| *named == text.trim());
                let named = alone.and_then(|named| Place::of(&self.scope, &segments(named)));
                noted.has_decibels || named.is_some_and(|place| place.in_decibels(depth + 1))
            }
            Shape::Struct(None, members) => described(members).is_some_and(|value| {
                Place { node: Rc::new(value.clone()), ..self.clone() }.in_decibels(depth + 1)
            }),
            _ => false,
        }
    }

    /// Units that stand in the value, and in the parameters that it names.
    fn units(&self, all: &mut Vec<Unit>, depth: usize) {
        if depth > DEEPEST {
            return;
        }
        let deeper = |node: &Node| Place { node: Rc::new(node.clone()), ..self.clone() };
        match &self.node.value {
            Shape::Text(text) => {
                let Ok(noted) = noted(&self.scope, text, self.file, 0, &(0..0)) else { return };
                all.extend(noted.units);
                for name in noted.names {
                    if let Some(place) = Place::of(&self.scope, &segments(&name)) {
                        place.units(all, depth + 1);
                    }
                }
            }
            Shape::List(items) => items.iter().for_each(|item| deeper(item).units(all, depth + 1)),
            Shape::Struct(None, members) => {
                if let Some(value) = described(members) {
                    deeper(value).units(all, depth + 1);
                }
            }
            _ => {}
        }
    }
}

/// `robot.axis[2].mass` as `robot`, `axis`, `[2]`, `mass`.
fn segments(name: &str) -> Vec<String> {
    let mut all = Vec::new();
    for part in name.split('.') {
        let part = part.trim();
        let end = part.find('[').filter(|at| *at > 0).unwrap_or(part.len());
        let (head, items) = part.split_at(end);
        all.push(head.trim().to_owned());
        all.extend(items.split_inclusive(']').map(|item| item.trim().to_owned()));
    }
    all
}

fn is_si(unit: &Unit) -> bool {
    unit.scale == 1.0 && unit.offset == 0.0
}

/// How often cycles are counted: once in Hz.
fn cycles(dimension: Dimension) -> i8 {
    dimension.exponents[7]
}
