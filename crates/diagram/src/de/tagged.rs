//! A block with its kind in front, as the registry of kinds reads it.

use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, Visitor};

use super::Noted;
use super::written::Written;

/// `Kind(parameters)` as typetag reads it: a map of one entry.
pub(crate) struct Tagged<'n, 'a> {
    pub kind: &'n str,
    pub body: Written<'n, 'a>,
}

impl<'de> Deserializer<'de> for Tagged<'_, '_> {
    type Error = Noted;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
        struct One<'n, 'a>(Tagged<'n, 'a>, bool);
        impl<'de> MapAccess<'de> for One<'_, '_> {
            type Error = Noted;

            fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Noted> {
                if std::mem::replace(&mut self.1, true) {
                    return Ok(None);
                }
                let key: StrDeserializer<Noted> = self.0.kind.into_deserializer();
                seed.deserialize(key).map(Some)
            }

            fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Noted> {
                seed.deserialize(self.0.body)
            }
        }
        visitor.visit_map(One(self, false))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}
