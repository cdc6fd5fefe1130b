//! A value of any type on its way into a `ParamValue`.

use blocksim_signal::Value;
use serde::de::value::{SeqDeserializer, U32Deserializer};
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, SeqAccess, VariantAccess, Visitor,
};

use super::Noted;

/// A value of any type on its way into a `ParamValue`, as the enum that reads it.
#[derive(Clone, Copy)]
pub(super) struct Wire<'v>(pub &'v Value);

impl<'de> EnumAccess<'de> for Wire<'_> {
    type Error = Noted;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Noted> {
        let index: u32 = match self.0 {
            Value::Number(_) => 0,
            Value::Bool(_) => 1,
            Value::Text(_) => 2,
            Value::List(_) => 3,
            Value::Set(_) => 4,
        };
        let index: U32Deserializer<Noted> = IntoDeserializer::<Noted>::into_deserializer(index);
        Ok((seed.deserialize(index)?, self))
    }
}

impl<'de> Deserializer<'de> for Wire<'_> {
    type Error = Noted;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        visitor.visit_enum(self)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

impl<'de> VariantAccess<'de> for Wire<'_> {
    type Error = Noted;

    fn unit_variant(self) -> Result<(), Noted> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Noted> {
        match self.0 {
            Value::Bool(value) => seed.deserialize(IntoDeserializer::<Noted>::into_deserializer(*value)),
            Value::Text(text) => {
                seed.deserialize(IntoDeserializer::<Noted>::into_deserializer(text.as_str()))
            }
            Value::List(items) => {
                let items = items.iter().map(Wire);
                seed.deserialize(SeqDeserializer::new(items))
            }
            Value::Set(members) => {
                let members = members.iter().map(|(name, value)| Pair(name, value));
                seed.deserialize(SeqDeserializer::new(members))
            }
            Value::Number(_) => Err(Noted("a number has two parts".to_owned())),
        }
    }

    fn tuple_variant<V: Visitor<'de>>(self, _len: usize, visitor: V) -> Result<V::Value, Noted> {
        struct Number(f64, [i8; 9], u8);
        impl<'de> SeqAccess<'de> for Number {
            type Error = Noted;

            fn next_element_seed<T: DeserializeSeed<'de>>(
                &mut self,
                seed: T,
            ) -> Result<Option<T::Value>, Noted> {
                self.2 += 1;
                match self.2 {
                    1 => seed.deserialize(IntoDeserializer::<Noted>::into_deserializer(self.0)).map(Some),
                    2 => seed.deserialize(SeqDeserializer::new(self.1.into_iter())).map(Some),
                    _ => Ok(None),
                }
            }
        }
        match self.0 {
            Value::Number(quantity) => {
                visitor.visit_seq(Number(quantity.value, quantity.dimension.exponents, 0))
            }
            _ => Err(Noted("only a number has two parts".to_owned())),
        }
    }

    fn struct_variant<V: Visitor<'de>>(self, _f: &'static [&'static str], _v: V) -> Result<V::Value, Noted> {
        Err(Noted("no value has named parts".to_owned()))
    }
}

impl<'de> IntoDeserializer<'de, Noted> for Wire<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// A member of a set as a pair.
#[derive(Clone, Copy)]
struct Pair<'v>(&'v str, &'v Value);

impl<'de> Deserializer<'de> for Pair<'_> {
    type Error = Noted;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        struct Parts<'v>(Pair<'v>, u8);
        impl<'de> SeqAccess<'de> for Parts<'_> {
            type Error = Noted;

            fn next_element_seed<T: DeserializeSeed<'de>>(
                &mut self,
                seed: T,
            ) -> Result<Option<T::Value>, Noted> {
                self.1 += 1;
                match self.1 {
                    1 => seed.deserialize(IntoDeserializer::<Noted>::into_deserializer(self.0.0)).map(Some),
                    2 => seed.deserialize(Wire(self.0.1)).map(Some),
                    _ => Ok(None),
                }
            }
        }
        visitor.visit_seq(Parts(self, 0))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

impl<'de> IntoDeserializer<'de, Noted> for Pair<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}
