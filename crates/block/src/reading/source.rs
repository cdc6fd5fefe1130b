//! The deserializer that types of parameters ask.

use std::cell::RefCell;
use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Expected, MapAccess, SeqAccess, VariantAccess, Visitor,
};

use super::parts::{self, Alternative, Ask, Elements, Members, Scalar};
use super::{Erased, ReadError};

/// A value that becomes whatever is asked for.
pub struct Source<'r, 'de>(Erased<'r, 'de>);

impl<'r, 'de> Source<'r, 'de> {
    /// What the erased deserializer gives.
    pub(crate) fn new(from: Erased<'r, 'de>) -> Self {
        Self(from)
    }
}

/// A visitor or a seed that is used once, and says until then what it expects.
struct Asked<V>(RefCell<Option<V>>);

impl<V> Asked<V> {
    fn new(visitor: V) -> Self {
        Self(RefCell::new(Some(visitor)))
    }

    fn take(&self) -> Result<V, ReadError> {
        self.0.take().ok_or_else(ReadError::twice)
    }
}

impl<'de, V: Visitor<'de>> Expected for Asked<V> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.0.borrow().as_ref().map_or(Ok(()), |visitor| visitor.expecting(f))
    }
}

/// What was read, if anything was.
fn read<T>(result: Option<T>) -> Result<T, ReadError> {
    result.ok_or_else(|| ReadError::Text("the value is missing".to_owned()))
}

/// Reads what a seed stands for, and keeps it in `result`.
fn plant<'de, S: DeserializeSeed<'de>>(
    seed: &Asked<S>,
    result: &mut Option<S::Value>,
    from: Erased<'_, 'de>,
) -> Result<(), ReadError> {
    *result = Some(seed.take()?.deserialize(Source(from))?);
    Ok(())
}

/// Values without parts, of these sorts.
macro_rules! scalars {
    ($($method:ident $ask:ident: $($sort:ident $visit:ident),*;)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
            let (asked, mut result) = (Asked::new(visitor), None);
            parts::scalar(self.0, Ask::$ask, &asked, &mut |scalar| {
                result = Some(match scalar {
                    $(Scalar::$sort(value) => asked.take()?.$visit(value)?,)*
                    other => return other.refused(&asked),
                });
                Ok(())
            })?;
            read(result)
        })*
    };
}

/// What only the erased deserializer answers itself.
macro_rules! handed_on {
    ($($method:ident($($argument:ident: $type:ty),*);)*) => {
        $(fn $method<V: Visitor<'de>>(self, $($argument: $type,)* visitor: V) -> Result<V::Value, ReadError> {
            self.0.$method($($argument,)* visitor).map_err(ReadError::from_text)
        })*
    };
}

impl<'de> Deserializer<'de> for Source<'_, 'de> {
    type Error = ReadError;

    scalars! {
        deserialize_bool Bool: Bool visit_bool;
        deserialize_i8 I8: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_i16 I16: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_i32 I32: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_i64 I64: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_u8 U8: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_u16 U16: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_u32 U32: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_u64 U64: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_f32 F32: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_f64 F64: Signed visit_i64, Unsigned visit_u64, Float visit_f64;
        deserialize_char Char: Text visit_str;
        deserialize_str Str: Text visit_str;
        deserialize_string String: Text visit_str;
        deserialize_identifier Identifier: Text visit_str, Unsigned visit_u64;
    }

    handed_on! {
        deserialize_any();
        deserialize_bytes();
        deserialize_byte_buf();
        deserialize_unit();
        deserialize_unit_struct(name: &'static str);
        deserialize_ignored_any();
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        let some = parts::option(self.0, &asked, &mut |from| {
            result = Some(asked.take()?.visit_some(Source(from))?);
            Ok(())
        })?;
        if some { read(result) } else { asked.take()?.visit_none() }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        parts::wrapped(self.0, name, &asked, &mut |from| {
            result = Some(asked.take()?.visit_newtype_struct(Source(from))?);
            Ok(())
        })?;
        read(result)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        self.list(None, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, ReadError> {
        self.list(Some(length), visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        self.list(Some(length), visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        self.set(None, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        self.set(Some((name, fields)), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        parts::choice(self.0, name, variants, &asked, &mut |alternative| {
            result = Some(asked.take()?.visit_enum(Choice(alternative))?);
            Ok(())
        })?;
        read(result)
    }
}

impl<'de> Source<'_, 'de> {
    fn list<V: Visitor<'de>>(self, length: Option<usize>, visitor: V) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        parts::list(self.0, length, &asked, &mut |elements| {
            result = Some(asked.take()?.visit_seq(Items(elements))?);
            Ok(())
        })?;
        read(result)
    }

    fn set<V: Visitor<'de>>(
        self,
        names: Option<(&'static str, &'static [&'static str])>,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        parts::set(self.0, names, &asked, &mut |members| {
            result = Some(asked.take()?.visit_map(Named(members))?);
            Ok(())
        })?;
        read(result)
    }
}

struct Items<'p, 'de>(&'p mut dyn Elements<'de>);

impl<'de> SeqAccess<'de> for Items<'_, 'de> {
    type Error = ReadError;

    fn next_element_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, ReadError> {
        let (seed, mut result) = (Asked::new(seed), None);
        let more = self.0.next(&mut |from| plant(&seed, &mut result, from))?;
        if more { read(result).map(Some) } else { Ok(None) }
    }

    fn size_hint(&self) -> Option<usize> {
        self.0.left()
    }
}

struct Named<'p, 'de>(&'p mut dyn Members<'de>);

impl<'de> MapAccess<'de> for Named<'_, 'de> {
    type Error = ReadError;

    fn next_key_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<Option<S::Value>, ReadError> {
        let (seed, mut result) = (Asked::new(seed), None);
        let more = self.0.name(&mut |from| plant(&seed, &mut result, from))?;
        if more { read(result).map(Some) } else { Ok(None) }
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, ReadError> {
        let (seed, mut result) = (Asked::new(seed), None);
        self.0.value(&mut |from| plant(&seed, &mut result, from))?;
        read(result)
    }
}

struct Choice<'p, 'de>(&'p mut dyn Alternative<'de>);

impl<'de> EnumAccess<'de> for Choice<'_, 'de> {
    type Error = ReadError;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self), ReadError> {
        let (seed, mut result) = (Asked::new(seed), None);
        self.0.name(&mut |from| plant(&seed, &mut result, from))?;
        Ok((read(result)?, self))
    }
}

impl<'de> VariantAccess<'de> for Choice<'_, 'de> {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        self.0.nothing()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, ReadError> {
        let (seed, mut result) = (Asked::new(seed), None);
        self.0.value(&mut |from| plant(&seed, &mut result, from))?;
        read(result)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        self.0.list(length, &asked, &mut |elements| {
            result = Some(asked.take()?.visit_seq(Items(elements))?);
            Ok(())
        })?;
        read(result)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let (asked, mut result) = (Asked::new(visitor), None);
        self.0.set(names, &asked, &mut |members| {
            result = Some(asked.take()?.visit_map(Named(members))?);
            Ok(())
        })?;
        read(result)
    }
}
