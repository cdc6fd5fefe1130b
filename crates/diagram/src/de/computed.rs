//! What an expression comes to becomes whatever serde asks for, with its unit checked.

use blocksim_block::problem::Problem;
use blocksim_block::{VALUE_ENUM, hand_over};
use blocksim_signal::{Dimension, Value, si_text};
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, SeqAccess, Visitor};

use super::wire::Handed;
use super::written::Written;
use super::{Expected, Noted};

/// A value that was computed, with the text that it came from for messages.
pub(super) struct Computed<'n, 'a> {
    pub written: Written<'n, 'a>,
    pub value: Value,
    /// Whether nothing in the text has a unit: such a number is meant in SI. Decided on what is computed and not on how it is
    /// written; units that cancel are units.
    pub is_bare: bool,
    /// Whether a unit stands in the text itself.
    pub has_units: bool,
    /// Whether a per cent sign stands in it.
    pub is_share: bool,
}

impl Computed<'_, '_> {
    fn of(&self, value: Value) -> Self {
        // Items of a list that is named, `"link.com"`, may be bare beside others that are not.
        Computed { value, is_bare: self.is_bare || !self.has_units, ..*self }
    }

    /// The value by itself and what is known of it: lists and sets of many levels are not copied level by level.
    fn taken(mut self) -> (Self, Value) {
        let value = std::mem::replace(&mut self.value, Value::List(Vec::new()));
        (self, value)
    }

    fn wrong<T>(&self, wanted: &str) -> Result<T, Noted> {
        Self::unlike(&self.value, wanted)
    }

    fn unlike<T>(value: &Value, wanted: &str) -> Result<T, Noted> {
        Err(Noted(format!("expected {wanted}, found {}", value.describe())))
    }

    /// The number, with its unit checked against what the parameter asks for.
    fn number(&self) -> Result<f64, Noted> {
        let Some(quantity) = self.value.as_number() else { return self.wrong("a number") };
        let Expected { field, dimension } = self.written.expected;
        match (field, dimension) {
            (_, Some(dimension)) => {
                let bare = quantity.dimension == Dimension::NONE && self.is_bare;
                if !bare && !dimension.takes(quantity.dimension) {
                    return Err(self.written.reading.note(self.wrong_unit(
                        quantity.value,
                        quantity.dimension,
                        dimension,
                    )));
                }
                if bare {
                    self.written.reading.note_bare(field, quantity.value, dimension, self.written.node);
                }
            }
            (Some(field), None) => {
                let mut units = self.written.reading.units.borrow_mut();
                // A bare number says nothing of its unit.
                let bare = quantity.dimension == Dimension::NONE && self.is_bare;
                if bare {
                    self.written.reading.note_open(quantity.value);
                }
                if bare && units.written(field).is_none() {
                    units.insert(field, Dimension::OPEN);
                } else if !bare && (units.find(field).is_none() || quantity.dimension != Dimension::NONE) {
                    units.insert(field, quantity.dimension);
                }
            }
            (None, None) => {}
        }
        if let Some(field) = field {
            self.written.reading.keep(field, quantity.value);
        }
        Ok(quantity.value)
    }

    fn wrong_unit(&self, value: f64, found: Dimension, wanted: Dimension) -> Problem {
        let place = self.written.reading.place(self.written.node);
        let field = self.written.expected.field.unwrap_or("the value");
        let found_text = if found.is_none() { "has no unit".to_owned() } else { format!("is in {found}") };
        Problem::error(
            "unit_mismatch",
            format!("`{field}` is in {wanted}, but `{}` {found_text}", si_text(value, found)),
        )
        .at(&place, format!("should be in {wanted}"))
        .help(format!("write a value in {wanted} or a unit of the same kind"))
    }
}

macro_rules! computed_integers {
    ($($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
            let number = self.number()?;
            if self.is_share {
                return Err(Noted(format!("expected a whole number, not a percentage, found {number}")));
            }
            if number.fract() != 0.0 || number.abs() > 9e15 {
                return Err(Noted(format!("expected a whole number, found {number}")));
            }
            if number < 0.0 { visitor.visit_i64(number as i64) } else { visitor.visit_u64(number as u64) }
        })*
    };
}

impl<'de> Deserializer<'de> for Computed<'_, '_> {
    type Error = Noted;

    computed_integers! {
        deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64
    }

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.value {
            Value::Number(_) => visitor.visit_f64(self.number()?),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Text(text) => visitor.visit_str(text),
            Value::List(_) => self.deserialize_seq(visitor),
            Value::Set(_) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        visitor.visit_f64(self.number()?)
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match self.value {
            Value::Bool(value) => visitor.visit_bool(value),
            _ => self.wrong("true or false"),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Noted> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        struct List<'c, 'n, 'a>(&'c Computed<'n, 'a>, std::vec::IntoIter<Value>);
        impl<'de> SeqAccess<'de> for List<'_, '_, '_> {
            type Error = Noted;

            fn next_element_seed<T: DeserializeSeed<'de>>(
                &mut self,
                seed: T,
            ) -> Result<Option<T::Value>, Noted> {
                self.1.next().map(|value| seed.deserialize(self.0.of(value))).transpose()
            }
        }
        match self.taken() {
            (computed, Value::List(items)) => visitor.visit_seq(List(&computed, items.into_iter())),
            (_, other) => Self::unlike(&other, "a list"),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        struct Set<'c, 'n, 'a>(
            &'c Computed<'n, 'a>,
            std::vec::IntoIter<(String, Value)>,
            Option<(String, Value)>,
        );
        impl<'de> MapAccess<'de> for Set<'_, '_, '_> {
            type Error = Noted;

            fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Noted> {
                self.2 = self.1.next();
                let Some((name, _)) = &self.2 else { return Ok(None) };
                let key: StrDeserializer<Noted> = name.as_str().into_deserializer();
                seed.deserialize(key).map(Some)
            }

            fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Noted> {
                let Some((name, value)) = self.2.take() else {
                    return Err(Noted("a value without a name".to_owned()));
                };
                seed.deserialize(self.0.of(value)).map_err(|noted| match noted.0.as_str() {
                    "" => noted,
                    message => Noted(format!("`{name}`: {message}")),
                })
            }
        }
        match self.taken() {
            (computed, Value::Set(members)) => visitor.visit_map(Set(&computed, members.into_iter(), None)),
            (_, other) => Self::unlike(&other, "a set"),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
        self.deserialize_map(visitor)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        match &self.value {
            Value::Text(text) => visitor.visit_str(text),
            _ => self.wrong("a text"),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        self.deserialize_str(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        _variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
        if name == VALUE_ENUM {
            hand_over(self.value);
            return visitor.visit_enum(Handed);
        }
        match &self.value {
            Value::Text(text) => {
                let word: StrDeserializer<Noted> = text.as_str().into_deserializer();
                visitor.visit_enum(word)
            }
            _ => self.wrong("a text"),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! {
        char bytes byte_buf unit unit_struct tuple tuple_struct identifier i128 u128
    }
}
