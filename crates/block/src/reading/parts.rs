//! From the erased deserializer to a few functions of values and their parts. Nothing here depends on the type that is read.

use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, Expected, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};

use super::{Erased, ReadError, Take, handed};

/// A value without parts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scalar<'s> {
    Bool(bool),
    Signed(i64),
    Unsigned(u64),
    Float(f64),
    Text(&'s str),
    Unit,
}

impl Scalar<'_> {
    pub(super) fn refused<T>(self, expected: &dyn Expected) -> Result<T, ReadError> {
        let unexpected = match self {
            Scalar::Bool(value) => Unexpected::Bool(value),
            Scalar::Signed(value) => Unexpected::Signed(value),
            Scalar::Unsigned(value) => Unexpected::Unsigned(value),
            Scalar::Float(value) => Unexpected::Float(value),
            Scalar::Text(text) => Unexpected::Str(text),
            Scalar::Unit => Unexpected::Unit,
        };
        Err(Error::invalid_type(unexpected, expected))
    }
}

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Ask {
    Bool,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Char,
    Str,
    String,
    Identifier,
}

/// Asks for a value without parts and shows it.
pub(super) fn scalar(
    from: Erased,
    ask: Ask,
    expected: &dyn Expected,
    show: &mut dyn FnMut(Scalar) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let visitor = Shown { expected, show };
    let result = match ask {
        Ask::Bool => from.deserialize_bool(visitor),
        Ask::I8 => from.deserialize_i8(visitor),
        Ask::I16 => from.deserialize_i16(visitor),
        Ask::I32 => from.deserialize_i32(visitor),
        Ask::I64 => from.deserialize_i64(visitor),
        Ask::U8 => from.deserialize_u8(visitor),
        Ask::U16 => from.deserialize_u16(visitor),
        Ask::U32 => from.deserialize_u32(visitor),
        Ask::U64 => from.deserialize_u64(visitor),
        Ask::F32 => from.deserialize_f32(visitor),
        Ask::F64 => from.deserialize_f64(visitor),
        Ask::Char => from.deserialize_char(visitor),
        Ask::Str => from.deserialize_str(visitor),
        Ask::String => from.deserialize_string(visitor),
        Ask::Identifier => from.deserialize_identifier(visitor),
    };
    result.map_err(ReadError::from_text)
}

/// Asks for something that may be absent; `false` if it is.
pub(super) fn option<'de>(
    from: Erased<'_, 'de>,
    expected: &dyn Expected,
    take: Take<'_, 'de>,
) -> Result<bool, ReadError> {
    from.deserialize_option(Inner { expected, take }).map_err(ReadError::from_text)
}

/// Asks for what a type with a name of its own wraps.
pub(super) fn wrapped<'de>(
    from: Erased<'_, 'de>,
    name: &'static str,
    expected: &dyn Expected,
    take: Take<'_, 'de>,
) -> Result<bool, ReadError> {
    from.deserialize_newtype_struct(name, Inner { expected, take }).map_err(ReadError::from_text)
}

/// Asks for a list, of a certain length if there is one.
pub(super) fn list<'de>(
    from: Erased<'_, 'de>,
    length: Option<usize>,
    expected: &dyn Expected,
    read: &mut dyn FnMut(&mut dyn Elements<'de>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let visitor = List { expected, read };
    let result = match length {
        Some(length) => from.deserialize_tuple(length, visitor),
        None => from.deserialize_seq(visitor),
    };
    result.map_err(ReadError::from_text)
}

/// Asks for a set, one with these names if there are any.
pub(super) fn set<'de>(
    from: Erased<'_, 'de>,
    names: Option<(&'static str, &'static [&'static str])>,
    expected: &dyn Expected,
    read: &mut dyn FnMut(&mut dyn Members<'de>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let visitor = Set { expected, read };
    let result = match names {
        Some((name, fields)) => from.deserialize_struct(name, fields, visitor),
        None => from.deserialize_map(visitor),
    };
    result.map_err(ReadError::from_text)
}

/// Asks for one of some alternatives.
pub(super) fn choice<'de>(
    from: Erased<'_, 'de>,
    name: &'static str,
    variants: &'static [&'static str],
    expected: &dyn Expected,
    read: &mut dyn FnMut(&mut dyn Alternative<'de>) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    from.deserialize_enum(name, variants, Chooser { expected, read }).map_err(ReadError::from_text)
}

/// The elements of a list.
pub(super) trait Elements<'de> {
    /// Hands the next one over; `false` behind the last.
    fn next(&mut self, take: Take<'_, 'de>) -> Result<bool, ReadError>;
    /// How many are left, if that is known.
    fn left(&self) -> Option<usize>;
}

/// The members of a set.
pub(super) trait Members<'de> {
    /// Hands the next name over; `false` behind the last.
    fn name(&mut self, take: Take<'_, 'de>) -> Result<bool, ReadError>;
    /// Hands the value of this name over.
    fn value(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError>;
}

/// One of some alternatives: first its name, then what is in it.
pub(super) trait Alternative<'de> {
    fn name(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError>;
    fn nothing(&mut self) -> Result<(), ReadError>;
    fn value(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError>;
    fn list(
        &mut self,
        length: usize,
        expected: &dyn Expected,
        read: &mut dyn FnMut(&mut dyn Elements<'de>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError>;
    fn set(
        &mut self,
        names: &'static [&'static str],
        expected: &dyn Expected,
        read: &mut dyn FnMut(&mut dyn Members<'de>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError>;
}

/// A value on its way to the one that takes it.
pub(super) struct Taken<'t, 'de>(pub Take<'t, 'de>);

impl<'de> DeserializeSeed<'de> for Taken<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        handed(deserializer, self.0)
    }
}

struct Shown<'v> {
    expected: &'v dyn Expected,
    show: &'v mut dyn FnMut(Scalar) -> Result<(), ReadError>,
}

macro_rules! shown {
    ($($method:ident: $type:ty => $scalar:ident;)*) => {
        $(fn $method<E: Error>(self, value: $type) -> Result<(), E> {
            (self.show)(Scalar::$scalar(value)).map_err(ReadError::raise)
        })*
    };
}

impl Visitor<'_> for Shown<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.expected.fmt(f)
    }

    shown! {
        visit_bool: bool => Bool;
        visit_i64: i64 => Signed;
        visit_u64: u64 => Unsigned;
        visit_f64: f64 => Float;
        visit_str: &str => Text;
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        (self.show)(Scalar::Unit).map_err(ReadError::raise)
    }
}

struct Inner<'v, 'de> {
    expected: &'v dyn Expected,
    take: Take<'v, 'de>,
}

impl<'de> Visitor<'de> for Inner<'_, 'de> {
    type Value = bool;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.expected.fmt(f)
    }

    fn visit_none<E: Error>(self) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_unit<E: Error>(self) -> Result<bool, E> {
        Ok(false)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<bool, D::Error> {
        handed(deserializer, self.take).map(|()| true)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<bool, D::Error> {
        handed(deserializer, self.take).map(|()| true)
    }
}

struct List<'v, 'de> {
    expected: &'v dyn Expected,
    read: &'v mut dyn FnMut(&mut dyn Elements<'de>) -> Result<(), ReadError>,
}

impl<'de> Visitor<'de> for List<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.expected.fmt(f)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        (self.read)(&mut Parts(&mut items)).map_err(ReadError::raise)
    }
}

struct Set<'v, 'de> {
    expected: &'v dyn Expected,
    read: &'v mut dyn FnMut(&mut dyn Members<'de>) -> Result<(), ReadError>,
}

impl<'de> Visitor<'de> for Set<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.expected.fmt(f)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        (self.read)(&mut Parts(&mut members)).map_err(ReadError::raise)
    }
}

/// What a list or a set hands out, as parts.
struct Parts<'p, A>(&'p mut A);

impl<'de, A: SeqAccess<'de>> Elements<'de> for Parts<'_, A> {
    fn next(&mut self, take: Take<'_, 'de>) -> Result<bool, ReadError> {
        let item = self.0.next_element_seed(Taken(take)).map_err(ReadError::from_text)?;
        Ok(item.is_some())
    }

    fn left(&self) -> Option<usize> {
        self.0.size_hint()
    }
}

impl<'de, A: MapAccess<'de>> Members<'de> for Parts<'_, A> {
    fn name(&mut self, take: Take<'_, 'de>) -> Result<bool, ReadError> {
        let name = self.0.next_key_seed(Taken(take)).map_err(ReadError::from_text)?;
        Ok(name.is_some())
    }

    fn value(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError> {
        self.0.next_value_seed(Taken(take)).map_err(ReadError::from_text)
    }
}

struct Chooser<'v, 'de> {
    expected: &'v dyn Expected,
    read: &'v mut dyn FnMut(&mut dyn Alternative<'de>) -> Result<(), ReadError>,
}

impl<'de> Visitor<'de> for Chooser<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.expected.fmt(f)
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<(), A::Error> {
        (self.read)(&mut Chosen::<A, A::Variant> { name: Some(access), content: None })
            .map_err(ReadError::raise)
    }
}

struct Chosen<A, V> {
    name: Option<A>,
    content: Option<V>,
}

impl<A, V> Chosen<A, V> {
    fn content(&mut self) -> Result<V, ReadError> {
        self.content.take().ok_or_else(ReadError::twice)
    }
}

impl<'de, A: EnumAccess<'de>> Alternative<'de> for Chosen<A, A::Variant> {
    fn name(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError> {
        let access = self.name.take().ok_or_else(ReadError::twice)?;
        let ((), content) = access.variant_seed(Taken(take)).map_err(ReadError::from_text)?;
        self.content = Some(content);
        Ok(())
    }

    fn nothing(&mut self) -> Result<(), ReadError> {
        self.content()?.unit_variant().map_err(ReadError::from_text)
    }

    fn value(&mut self, take: Take<'_, 'de>) -> Result<(), ReadError> {
        self.content()?.newtype_variant_seed(Taken(take)).map_err(ReadError::from_text)
    }

    fn list(
        &mut self,
        length: usize,
        expected: &dyn Expected,
        read: &mut dyn FnMut(&mut dyn Elements<'de>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        self.content()?.tuple_variant(length, List { expected, read }).map_err(ReadError::from_text)
    }

    fn set(
        &mut self,
        names: &'static [&'static str],
        expected: &dyn Expected,
        read: &mut dyn FnMut(&mut dyn Members<'de>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        self.content()?.struct_variant(names, Set { expected, read }).map_err(ReadError::from_text)
    }
}
