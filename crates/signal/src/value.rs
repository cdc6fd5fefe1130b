//! What a parameter can be.

use crate::Quantity;
use std::fmt;

/// The value of a parameter or an expression.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number in SI units with its dimension.
    Number(Quantity),
    /// True or false.
    Bool(bool),
    /// A text, such as a choice or a file name.
    Text(String),
    /// Values in order, counted from 0.
    List(Vec<Value>),
    /// Named values in the order of the file.
    Set(Vec<(String, Value)>),
}

impl Value {
    /// The member of a set; none if there is no such member or this is no set.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.as_set()?.iter().find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// The number, if this is one.
    pub fn as_number(&self) -> Option<Quantity> {
        if let Value::Number(quantity) = self { Some(*quantity) } else { None }
    }

    /// The truth value, if this is one.
    pub fn as_bool(&self) -> Option<bool> {
        if let Value::Bool(value) = self { Some(*value) } else { None }
    }

    /// The text, if this is one.
    pub fn as_text(&self) -> Option<&str> {
        if let Value::Text(text) = self { Some(text) } else { None }
    }

    /// The items, if this is a list.
    pub fn as_list(&self) -> Option<&[Value]> {
        if let Value::List(items) = self { Some(items) } else { None }
    }

    /// The members, if this is a set.
    pub fn as_set(&self) -> Option<&[(String, Value)]> {
        if let Value::Set(members) = self { Some(members) } else { None }
    }

    /// The kind of value in words, for messages: "a number", "a list of 3".
    pub fn describe(&self) -> String {
        match self {
            Value::Number(_) => "a number".to_string(),
            Value::Bool(_) => "true or false".to_string(),
            Value::Text(_) => "a text".to_string(),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Set(members) => format!("a set of {}", members.len()),
        }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Value::Number(Quantity::plain(value))
    }
}

impl From<Quantity> for Value {
    fn from(quantity: Quantity) -> Self {
        Value::Number(quantity)
    }
}

impl fmt::Display for Value {
    /// As it would stand in a diagram: `0.5`, `"4000 W"`, `true`, `Text("dc")`, `[1, 2]`, `(r: "1.5 Ohm")`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Number(quantity) => match quantity.display() {
                text if text.contains(' ') => write!(f, "\"{text}\""),
                text => f.write_str(&text),
            },
            Value::Bool(value) => write!(f, "{value}"),
            Value::Text(text) => write!(f, "Text({text:?})"),
            Value::List(items) => {
                let items: Vec<String> = items.iter().map(Value::to_string).collect();
                write!(f, "[{}]", items.join(", "))
            }
            Value::Set(members) => {
                let members: Vec<String> =
                    members.iter().map(|(name, value)| format!("{name}: {value}")).collect();
                write!(f, "({})", members.join(", "))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Unit;

    fn motor() -> Value {
        let ohm = Unit::parse("Ohm").unwrap();
        Value::Set(vec![
            ("r".to_string(), Quantity::new(1.5, ohm.dimension).into()),
            ("gears".to_string(), Value::List(vec![50.0.into(), 51.5.into()])),
            ("kind".to_string(), Value::Text("a \"dc\"".to_string())),
            ("brake".to_string(), Value::Bool(true)),
        ])
    }

    #[test]
    fn a_value_prints_as_it_stands_in_a_diagram() {
        let text = r#"(r: "1.5 Ohm", gears: [50, 51.5], kind: Text("a \"dc\""), brake: true)"#;
        assert_eq!(motor().to_string(), text);
    }

    #[test]
    fn members_are_found_by_name_and_only_in_sets() {
        assert_eq!(motor().get("r").and_then(Value::as_number).map(|q| q.value), Some(1.5));
        assert_eq!(motor().get("brake").and_then(Value::as_bool), Some(true));
        assert_eq!(motor().get("kind").and_then(Value::as_text), Some("a \"dc\""));
        assert_eq!(motor().get("x"), None);
        assert_eq!(Value::from(1.0).get("r"), None);
    }

    #[test]
    fn kinds_are_described_in_words() {
        assert_eq!(motor().describe(), "a set of 4");
        assert_eq!(motor().get("gears").map(Value::describe).as_deref(), Some("a list of 2"));
        assert_eq!(Value::from(1.0).describe(), "a number");
    }
}
