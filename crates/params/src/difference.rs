//! Two lists of numbers side by side.

use std::collections::BTreeMap;

use crate::compare::converted;
use crate::numeral::same;
use crate::quantity::{Content, Quantity};
use crate::table::{Tables, Value};

/// A quantity that differs; each side as written, with its unit, `None` where it is absent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// Path in the set.
    pub path: String,
    /// In the first.
    pub old: Option<String>,
    /// In the second.
    pub new: Option<String>,
    /// Unit of both, or of the one that is there; empty where they differ in it.
    pub unit: String,
}

impl Value {
    /// As a set would have it, without a place.
    pub(crate) fn content(&self, unit: &str) -> Content {
        match self {
            Value::Number(value) => Content::Number { value: *value, unit: unit.to_owned(), numeral: 0..0 },
            Value::Text(text, _) => Content::Expression(text.clone()),
        }
    }
}

impl Tables {
    /// The quantities as those of a set, without places; faulty cells are left out.
    pub fn quantities(&self) -> Vec<Quantity> {
        let readings = self.readings.iter().filter_map(|(path, reading)| {
            let content = reading.value.as_ref()?.content(&reading.unit);
            Some(Quantity {
                path: path.clone(),
                content,
                provenance: Default::default(),
                place: 0..0,
                text: 0,
            })
        });
        readings.collect()
    }
}

/// What differs between two lists, in the order of the first; `1000 mm` and `1 m` are the same.
pub fn difference(old: &[Quantity], new: &[Quantity]) -> Vec<Difference> {
    let second: BTreeMap<&str, &Content> = new.iter().map(|q| (q.path.as_str(), &q.content)).collect();
    let first: BTreeMap<&str, &Content> = old.iter().map(|q| (q.path.as_str(), &q.content)).collect();
    let mut found: Vec<Difference> = old
        .iter()
        .filter(|quantity| {
            !second.get(quantity.path.as_str()).is_some_and(|other| equal(&quantity.content, other))
        })
        .map(|quantity| {
            Difference::of(
                &quantity.path,
                Some(&quantity.content),
                second.get(quantity.path.as_str()).copied(),
            )
        })
        .collect();
    let added = new.iter().filter(|quantity| !first.contains_key(quantity.path.as_str()));
    found.extend(added.map(|quantity| Difference::of(&quantity.path, None, Some(&quantity.content))));
    found
}

pub(crate) fn equal(a: &Content, b: &Content) -> bool {
    match (a, b) {
        (Content::Number { value: a, unit: of_a, .. }, Content::Number { value: b, unit: of_b, .. }) => {
            converted(*b, of_b, of_a).is_ok_and(|b| same(*a, b))
        }
        (Content::Expression(a), Content::Expression(b)) => a.trim() == b.trim(),
        _ => false,
    }
}

impl Difference {
    pub(crate) fn of(path: &str, old: Option<&Content>, new: Option<&Content>) -> Difference {
        let ([old, new], unit) = shown([old, new]);
        Difference { path: path.to_owned(), old, new, unit }
    }
}

/// Contents side by side, each as written, and the unit of all; where they differ in it, it stands beside each number.
pub(crate) fn shown<const N: usize>(all: [Option<&Content>; N]) -> ([Option<String>; N], String) {
    let unit = |content: &Content| match content {
        Content::Number { unit, .. } if unit != "1" => unit.clone(),
        _ => String::new(),
    };
    let units: Vec<String> = all.iter().flatten().map(|content| unit(content)).collect();
    let shared = units.first().filter(|first| units.iter().all(|unit| unit == *first));
    let text = |content: &Content| match content {
        Content::Number { value, .. } => {
            let own = if shared.is_none() { unit(content) } else { String::new() };
            format!("{} {own}", crate::numeral::written(*value)).trim_end().to_owned()
        }
        Content::Expression(text) => format!("`{text}`"),
    };
    (all.map(|content| content.map(text)), shared.cloned().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::quantities;

    #[test]
    fn numbers_are_compared_and_not_how_they_are_written() {
        let old = quantities("(a: \"1 m\", b: 2, c: \"3 kg\", d: \"b * 2\", e: \"1 s\")").expect("a set");
        let new = quantities("(d: \"b * 2\", f: 7, a: \"1000 mm\", b: 2.5, c: \"3 g\")").expect("a set");
        let seen: Vec<_> = difference(&old, &new)
            .into_iter()
            .map(|d| (d.path, d.old.unwrap_or_default(), d.new.unwrap_or_default(), d.unit))
            .collect();
        let expected =
            [("b", "2", "2.5", ""), ("c", "3 kg", "3 g", ""), ("e", "1", "", "s"), ("f", "", "7", "")];
        assert_eq!(
            seen,
            expected.map(|(a, b, c, d)| (a.to_owned(), b.to_owned(), c.to_owned(), d.to_owned()))
        );
    }
}
