//! The quantities of a set, each with its path, its place in the text and where its number comes from.

use std::ops::Range;

use blocksim_signal::Unit;
use blocksim_syntax::{Name, Node, Shape};

/// A quantity of a set.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// `axis1.limits.lower`, `tool.tcp[0]`.
    pub path: String,
    /// What is written.
    pub content: Content,
    /// Where the number comes from: source, note, tolerance.
    pub provenance: [String; 3],
    /// Start and end of the value in the text, in bytes.
    pub place: Range<usize>,
    /// Number of the text that it stands in, from 0; a set is one text, a model may be several.
    pub text: usize,
}

/// What is written for a quantity.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A number with the unit that stands beside it, empty for none.
    Number {
        /// In that unit.
        value: f64,
        /// As written.
        unit: String,
        /// Start and end of the numeral in the text, in bytes.
        numeral: Range<usize>,
    },
    /// An expression such as `2 * mass`, which only the text of the set can change.
    Expression(String),
}

/// Why a text is no set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetError {
    /// The fact.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// Where, in bytes.
    pub place: Range<usize>,
}

impl SetError {
    pub(crate) fn new(message: impl Into<String>, help: Option<&str>, place: Range<usize>) -> SetError {
        SetError { message: message.into(), help: help.map(str::to_owned), place }
    }
}

/// The quantities of one value of a model, such as `8.0` or `["1 mm", "2 mm"]`, which stands at this place of a text.
pub fn quantities_at(path: &str, text: &str, number: usize, place: &Range<usize>) -> Vec<Quantity> {
    let Some(Ok(root)) = text.get(place.clone()).map(blocksim_syntax::read) else { return Vec::new() };
    let mut walk = Walk { text: &text[place.clone()], found: Vec::new() };
    // A name that stands twice is reported where the model is read.
    if walk.node(&root, path.to_owned(), &Default::default()).is_err() {
        return Vec::new();
    }
    for quantity in &mut walk.found {
        let moved = |range: &Range<usize>| range.start + place.start..range.end + place.start;
        quantity.place = moved(&quantity.place);
        quantity.text = number;
        if let Content::Number { numeral, .. } = &mut quantity.content {
            *numeral = moved(numeral);
        }
    }
    walk.found
}

/// All quantities of a set in their order; words, texts and truth values are none.
///
/// # Errors
/// The first place that is no RON, or a name that stands twice in the same set.
pub fn quantities(text: &str) -> Result<Vec<Quantity>, SetError> {
    let root = blocksim_syntax::read(text).map_err(|error| SetError {
        message: error.message,
        help: error.help,
        place: error.span,
    })?;
    let mut walk = Walk { text, found: Vec::new() };
    if root.members().is_none() {
        return Err(SetError {
            message: format!("a set of parameters is expected, this is {}", root.describe()),
            help: Some("begin with `(` and write `name: value,`".to_owned()),
            place: root.span,
        });
    }
    walk.node(&root, String::new(), &Default::default())?;
    Ok(walk.found)
}

struct Walk<'a> {
    text: &'a str,
    found: Vec<Quantity>,
}

impl Walk<'_> {
    fn node(&mut self, node: &Node, path: String, provenance: &[String; 3]) -> Result<(), SetError> {
        match &node.value {
            Shape::Number(value) => {
                let numeral = node.span.clone();
                self.push(
                    node,
                    path,
                    provenance,
                    Content::Number { value: *value, unit: String::new(), numeral },
                );
            }
            Shape::Text(text) => {
                let content = self.quoted(node).unwrap_or_else(|| Content::Expression(text.clone()));
                self.push(node, path, provenance, content);
            }
            Shape::List(items) => {
                for (n, item) in items.iter().enumerate() {
                    self.node(item, format!("{path}[{n}]"), provenance)?;
                }
            }
            Shape::Map(members) | Shape::Struct(None, members) => self.members(members, &path, provenance)?,
            _ => {}
        }
        Ok(())
    }

    fn members(&mut self, members: &[(Name, Node)], path: &str, above: &[String; 3]) -> Result<(), SetError> {
        for (n, (name, _)) in members.iter().enumerate() {
            if members[..n].iter().any(|(other, _)| other.text == name.text) {
                return Err(SetError {
                    message: format!("`{}` occurs twice in the same set", name.text),
                    help: Some("remove one of them".to_owned()),
                    place: name.span.clone(),
                });
            }
        }
        let word = |wanted: &str| {
            members.iter().find(|(name, _)| name.text == wanted).map_or(
                String::new(),
                |(_, node)| match &node.value {
                    Shape::Text(text) => text.clone(),
                    _ => self.text.get(node.span.clone()).unwrap_or_default().to_owned(),
                },
            )
        };
        // The same rule as where a diagram uses the number.
        let described = members.iter().any(|(name, _)| name.text == "value")
            && members.iter().all(|(name, _)| {
                ["value", "source", "note", "tolerance", "published"].contains(&name.text.as_str())
            });
        if described {
            let provenance = [word("source"), word("note"), word("tolerance")];
            for (_, node) in members.iter().filter(|(name, _)| name.text == "value") {
                self.node(node, path.to_owned(), &provenance)?;
            }
            return Ok(());
        }
        for (name, node) in members {
            let path = if path.is_empty() { name.text.clone() } else { format!("{path}.{}", name.text) };
            self.node(node, path, above)?;
        }
        Ok(())
    }

    fn push(&mut self, node: &Node, path: String, provenance: &[String; 3], content: Content) {
        let place = node.span.clone();
        self.found.push(Quantity { path, content, provenance: provenance.clone(), place, text: 0 });
    }

    /// A text that is a number and a unit, and nothing more.
    fn quoted(&self, node: &Node) -> Option<Content> {
        let raw = self.text.get(node.span.clone())?.strip_prefix('"')?.strip_suffix('"')?;
        let start = raw.len() - raw.trim_start().len();
        let length = numeral_length(&raw[start..])?;
        let unit = raw[start + length..].trim();
        if !unit.is_empty() {
            Unit::parse(unit).ok()?;
        }
        let at = node.span.start + 1 + start;
        let value = raw[start..start + length].parse().ok().filter(|value: &f64| value.is_finite())?;
        Some(Content::Number { value, unit: unit.to_owned(), numeral: at..at + length })
    }
}

/// Length of the number a text begins with: `-1.5e-3`.
fn numeral_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'-' | b'+')));
    let mut at = sign(0);
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if bytes.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return None;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let from = at + 1 + sign(at + 1);
        let exponent = if from <= bytes.len() { digits(from) } else { 0 };
        if exponent > 0 {
            at = from + exponent;
        }
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_with_path_unit_place_and_source() {
        let text = r#"( // a set
            mass: (value: "12.5 kg", source: "scale", note: "published"), n: 3,
            tcp: ["1 mm", "-2e-1 mm"], inner: {"speed": "20 1/s", "twice": "2 * 3 kg", "kind": Text("box")}, on: true,
        )"#;
        let found = quantities(text).expect("a set");
        let seen: Vec<_> = found
            .iter()
            .map(|quantity| match &quantity.content {
                Content::Number { value, unit, numeral } => {
                    (quantity.path.as_str(), *value, unit.as_str(), &text[numeral.clone()])
                }
                Content::Expression(text) => (quantity.path.as_str(), f64::MAX, text.as_str(), ""),
            })
            .collect();
        assert_eq!(
            seen,
            [
                ("mass", 12.5, "kg", "12.5"),
                ("n", 3.0, "", "3"),
                ("tcp[0]", 1.0, "mm", "1"),
                ("tcp[1]", -0.2, "mm", "-2e-1"),
                ("inner.speed", 20.0, "1/s", "20"),
                ("inner.twice", f64::MAX, "2 * 3 kg", ""),
            ]
        );
        assert_eq!(found[0].provenance, ["scale", "published", ""]);
    }

    #[test]
    fn values_of_a_model_are_found_where_they_stand() {
        let text = "Gain(k: [\"2 mm\", 3, \"2 * k\"], n: Word)";
        let found = quantities_at("gain.k", text, 4, &(8..28));
        let seen: Vec<_> = found.iter().map(|q| (q.path.as_str(), q.text, &text[q.place.clone()])).collect();
        assert_eq!(
            seen,
            [("gain.k[0]", 4, "\"2 mm\""), ("gain.k[1]", 4, "3"), ("gain.k[2]", 4, "\"2 * k\"")]
        );
        assert!(
            matches!(&found[0].content, Content::Number { numeral, .. } if text[numeral.clone()] == *"2")
        );
        assert_eq!(quantities_at("gain.n", text, 0, &(33..37)), []);
        assert_eq!(quantities_at("gain.n", text, 0, &(99..100)), []);
    }

    #[test]
    fn what_is_no_set_is_refused() {
        for wrong in ["", "3", "[1]", "(a: 1", "(a: 1, a: 2)", "(a: 1,5)"] {
            assert!(quantities(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn expressions_are_not_taken_for_numbers() {
        for text in ["2*3", "1/3 m", "2 m + 1 m", "(3)", "mass", "3 mass", "1e", ""] {
            let set = format!("(a: \"{text}\")");
            let found = quantities(&set).expect("a set");
            assert!(matches!(found[0].content, Content::Expression(_)), "{text}: {:?}", found[0].content);
        }
    }
}
