//! A value of any type on its way into a `ParamValue`.

use serde::de::value::U32Deserializer;
use serde::de::{DeserializeSeed, EnumAccess, IntoDeserializer, VariantAccess, Visitor};

use super::Noted;

/// The word that the value has been handed over, as `blocksim_block::hand_over` does.
#[derive(Clone, Copy)]
pub(super) struct Handed;

impl<'de> EnumAccess<'de> for Handed {
    type Error = Noted;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Noted> {
        let only: U32Deserializer<Noted> = IntoDeserializer::<Noted>::into_deserializer(0_u32);
        Ok((seed.deserialize(only)?, self))
    }
}

impl<'de> VariantAccess<'de> for Handed {
    type Error = Noted;

    fn unit_variant(self) -> Result<(), Noted> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, _seed: T) -> Result<T::Value, Noted> {
        Err(nothing_more())
    }

    fn tuple_variant<V: Visitor<'de>>(self, _len: usize, _visitor: V) -> Result<V::Value, Noted> {
        Err(nothing_more())
    }

    fn struct_variant<V: Visitor<'de>>(self, _f: &'static [&'static str], _v: V) -> Result<V::Value, Noted> {
        Err(nothing_more())
    }
}

fn nothing_more() -> Noted {
    Noted("a value of any type has no parts here".to_owned())
}
