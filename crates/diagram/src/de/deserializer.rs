//! What stands in a file becomes whatever serde asks for.

use blocksim_block::problem::{Place, Problem};
use blocksim_block::{VALUE_ENUM, hand_over};
use blocksim_signal::Value;
use serde::de::{Deserializer, Visitor};

use super::computed::Computed;
use super::members::{Items, Members, Variant};
use super::wire::Handed;
use super::word_or::WORD_OR;
use super::written::Written;
use super::{Noted, Reading};
use crate::scope::{Evaluation, noted};
use blocksim_syntax::{Node, Shape};

impl<'n, 'a> Written<'n, 'a> {
    fn evaluate(&self) -> Result<Value, Noted> {
        let stack = Vec::new();
        let evaluation = Evaluation { scope: &self.reading.scope, file: self.reading.file, stack: &stack };
        evaluation.value(self.node).map_err(|problem| self.reading.note(problem))
    }

    /// An expression, evaluated, with the place of its text.
    fn computed(&self) -> Result<Computed<'n, 'a>, Noted> {
        match &self.node.value {
            Shape::Text(text) => {
                let (file, span) = (self.reading.file, &self.node.span);
                let noted = noted(&self.reading.scope, text, file, span.start + 1, span)
                    .map_err(|problem| self.reading.note(problem))?;
                let is_share = noted.units.iter().any(|unit| unit.text == "%");
                let has_units = !noted.units.is_empty() || noted.has_decibels;
                Ok(Computed {
                    written: *self,
                    value: noted.value,
                    is_bare: noted.is_bare,
                    has_units,
                    is_share,
                })
            }
            _ => Ok(Computed {
                written: *self,
                value: self.evaluate()?,
                is_bare: true,
                has_units: false,
                is_share: false,
            }),
        }
    }
}

/// Notes the bare numbers of a value of any type.
fn note_open(reading: &Reading, value: &Value) {
    match value {
        Value::Number(quantity) => reading.note_open(quantity.value),
        Value::List(items) => items.iter().for_each(|item| note_open(reading, item)),
        Value::Set(members) => members.iter().for_each(|(_, value)| note_open(reading, value)),
        Value::Bool(_) | Value::Text(_) => {}
    }
}

macro_rules! numbers {
    ($($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
            match &self.node.value {
                Shape::Number(_) | Shape::Text(_) | Shape::Tuple(Some(_), _) | Shape::Struct(..) => {
                    let computed = self.computed()?;
                    self.placed(computed.$method(visitor))
                }
                _ => self.mismatch("a number"),
            }
        })*
    };
}

impl<'de> Deserializer<'de> for Written<'_, '_> {
    type Error = Noted;

    numbers! {
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 deserialize_f32 deserialize_f64
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        let computed = self.computed()?;
        self.placed(computed.deserialize_any(visitor))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.node.value {
            Shape::Bool(value) => self.placed(visitor.visit_bool(*value)),
            Shape::Word(word) if word.is_empty() => {
                self.reading.offered.replace(vec!["true", "false"]);
                self.mismatch("true or false")
            }
            Shape::Text(_) => {
                let computed = self.computed()?;
                self.placed(computed.deserialize_bool(visitor))
            }
            _ => self.mismatch("true or false"),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.node.value {
            Shape::Text(text) => self.placed(visitor.visit_str(text)),
            Shape::Tuple(Some(name), items) if name.text == "Text" => match items.as_slice() {
                [Node { value: Shape::Text(text), .. }] => self.placed(visitor.visit_str(text)),
                _ => self.mismatch("a text"),
            },
            _ => self.mismatch("a text"),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        self.deserialize_str(visitor)
    }

    fn deserialize_char<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        self.deserialize_str(visitor)
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match self.node.word() {
            Some(word) => self.placed(visitor.visit_str(word)),
            None => self.deserialize_str(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.node.value {
            Shape::Word(word) if word == "None" => visitor.visit_none(),
            Shape::Tuple(Some(name), items) if name.text == "Some" => match items.as_slice() {
                [item] => visitor.visit_some(self.with_node(item)),
                _ => self.mismatch("one value"),
            },
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        visitor.visit_unit()
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Noted> {
        visitor.visit_unit()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Noted> {
        if name == WORD_OR && self.node.word().is_some() {
            return visitor.visit_some(self);
        }
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.node.value {
            Shape::List(items) | Shape::Tuple(None, items) => {
                let result = visitor.visit_seq(Items { written: self, rest: items.iter() });
                self.placed(result)
            }
            Shape::Text(_) => {
                let computed = self.computed()?;
                self.placed(computed.deserialize_seq(visitor))
            }
            _ => self.mismatch("a list"),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, _len: usize, visitor: V) -> Result<V::Value, Noted> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _len: usize,
        visitor: V,
    ) -> Result<V::Value, Noted> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.node.value {
            Shape::Text(_) => {
                let computed = self.computed()?;
                self.placed(computed.deserialize_map(visitor))
            }
            Shape::Tuple(Some(name), _) if name.text == "File" => {
                let computed = self.computed()?;
                self.placed(computed.deserialize_map(visitor))
            }
            _ => match self.node.members() {
                Some(members) => {
                    let top = self.is_block();
                    let access = Members { written: self, rest: members.iter(), value: None, top };
                    let result = visitor.visit_map(access);
                    self.placed(result)
                }
                None => self.mismatch("a set such as `(name: value)`"),
            },
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
        if let Some(members) = self.node.members()
            && !self.is_block()
        {
            self.only(members, fields)?;
        }
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
        if name == VALUE_ENUM {
            let computed = self.computed()?;
            if computed.is_bare && self.expected.dimension.is_none() {
                note_open(self.reading, &computed.value);
            }
            hand_over(computed.value);
            return self.placed(visitor.visit_enum(Handed));
        }
        let Some(word) = self.node.word() else {
            return self.mismatch(&format!("one of {}", crate::problems::list(variants)));
        };
        if word.is_empty() {
            self.reading.offered.replace(variants.to_vec());
        }
        if !variants.contains(&word) {
            let place = self.reading.place(self.node);
            let field = self.expected.field.map(|field| format!(" for `{field}`")).unwrap_or_default();
            let problem =
                Problem::error("parameter", format!("`{word}` is not a choice{field}")).at(&place, "");
            let named = match &self.node.value {
                Shape::Struct(Some(name), _) | Shape::Tuple(Some(name), _) => name.span.clone(),
                _ => self.node.span.clone(),
            };
            let at = Place { span: named, ..place };
            let problem = crate::problems::mended(problem, at, word, variants.iter().copied());
            // A method of another program has a name that looks like some of ours and means none of them.
            let here = blocksim_block::methods::instead_of(word).filter(|here| variants.contains(here));
            let problem = match here.or(blocksim_signal::closest(word, variants.iter().copied())) {
                Some(known) if here.is_some() => problem.help(format!(
                    "`{known}` is for the same here. The choices are {}",
                    crate::problems::list(variants)
                )),
                Some(known) => problem.help(format!(
                    "did you mean `{known}`? The choices are {}",
                    crate::problems::list(variants)
                )),
                None => problem.help(format!("the choices are {}", crate::problems::list(variants))),
            };
            return Err(self.reading.note(problem));
        }
        let result = visitor.visit_enum(Variant(self));
        self.placed(result)
    }

    fn deserialize_bytes<V: Visitor<'de>>(self, _visitor: V) -> Result<V::Value, Noted> {
        self.mismatch("a value that can be written in a diagram")
    }

    fn deserialize_byte_buf<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        self.deserialize_bytes(visitor)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        visitor.visit_unit()
    }
}
