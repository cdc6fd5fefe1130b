//! Sets of parameters: those of a kind of block, and groups of them that several kinds share.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, Visitor};

use crate::ParamErrors;
use crate::reading::{Of, ReadError, Source, Values};
use crate::requirements::{Inspect, Requirements, check};

/// What is known of one parameter.
#[derive(Debug, Clone, Copy)]
pub struct ParameterInfo {
    /// Name in diagrams.
    pub name: &'static str,
    /// Type in the source: `f64`, `String`, `Vec<f64>` ...
    pub rust_type: &'static str,
    /// Its unit; empty when the unit follows from use.
    pub unit: &'static str,
    /// Its default as written in the source; `None` when it must be given.
    pub default: Option<&'static str>,
    /// The comment above the field.
    pub doc: &'static str,
    /// What its value must be.
    pub requires: Requirements,
    /// Whether it is a difference or a factor, to which no scale with a zero of its own applies: 3 K and not 3 degC.
    pub is_difference: bool,
}

impl ParameterInfo {
    /// A parameter of which nothing is known.
    pub const NONE: Self = ParameterInfo {
        name: "",
        rust_type: "",
        unit: "",
        default: None,
        doc: "",
        requires: Requirements::NONE,
        is_difference: false,
    };
}

/// A struct of parameters. `#[derive(BlockMeta)]` implements it for a kind of block, `#[derive(Parameters)]` for a group
/// that several kinds have in common: a field `#[block(group)]` of such a type stands for all parameters of the group, which
/// diagrams and the manual show beside the others. `#[block(group(v_f = 0.8))]` gives one of them another default.
///
/// What a declaration cannot say of the values is found by a function of the struct, `fn validate(&self, errors: &mut ParamErrors)`, where
/// it has one.
pub trait Parameters: Sized {
    /// What is known of them, those of groups in their places.
    const INFOS: &'static [ParameterInfo];
    /// Their names, in the same order.
    const NAMES: &'static [&'static str];
    /// What was read so far.
    type Read: Default;

    /// Reads the next value, that of the parameter with this index.
    ///
    /// # Errors
    /// The value is not of its type, or the parameter was there before.
    fn read<'de>(read: &mut Self::Read, index: usize, values: &mut dyn Values<'de>) -> Result<(), ReadError>;

    /// Puts defaults in the places of parameters that were not given. Those against which something is known were.
    fn complete(read: &mut Self::Read, errors: &ParamErrors);

    /// The value that was read of the parameter with this index, if requirements look at it.
    fn value_read(read: &Self::Read, index: usize) -> Option<&dyn Inspect>;

    /// The value of the parameter with this index, if requirements look at it.
    fn value(&self, index: usize) -> Option<&dyn Inspect>;

    /// All parameters, once they are complete.
    ///
    /// # Errors
    /// One is missing.
    fn whole(read: Self::Read) -> Result<Self, Missing>;

    /// Reports what declarations cannot say, of groups first.
    fn validate_all(&self, errors: &mut ParamErrors);

    /// All that is wrong with the parameters.
    fn errors(&self) -> ParamErrors {
        let mut errors = ParamErrors::default();
        check(Self::INFOS, &|index| self.value(index), &|_| None, &mut errors);
        errors.settle();
        self.validate_all(&mut errors);
        errors
    }

    /// Reads parameters by name, with defaults for those that are not given; what their values must be is not looked at.
    ///
    /// # Errors
    /// A parameter is missing, unknown, there twice, or not of its type.
    fn from_deserializer<'de, D: Deserializer<'de>>(
        kind: &'static str,
        deserializer: D,
    ) -> Result<Self, D::Error> {
        let mut read = Self::Read::default();
        let take = &mut |index, values: &mut dyn Values<'de>| Self::read(&mut read, index, values);
        read_parameters(kind, Self::NAMES, take, deserializer)?;
        Self::complete(&mut read, &ParamErrors::default());
        Self::whole(read).map_err(|missing| Error::missing_field(missing.0))
    }
}

/// What a kind of block is without validation of its own.
pub trait NoValidation {
    /// Finds nothing.
    fn validate(&self, _errors: &mut ParamErrors) {}
}

impl<T> NoValidation for T {}

/// The name of a parameter that is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Missing(pub &'static str);

/// Reads parameters of these names: `read` takes the value of the one with an index. All values are read, also behind one
/// that is refused.
///
/// # Errors
/// A name that is not known, or the first value that `read` refuses.
pub fn read_parameters<'de, D: Deserializer<'de>>(
    name: &'static str,
    names: &'static [&'static str],
    read: &mut dyn FnMut(usize, &mut dyn Values<'de>) -> Result<(), ReadError>,
    deserializer: D,
) -> Result<(), D::Error> {
    deserializer.deserialize_struct(name, names, Struct { name, names, read })
}

/// Reads the value of one parameter.
///
/// # Errors
/// As [`Parameters::read`].
pub fn read_value<'de, T: serde::Deserialize<'de>>(
    place: &mut Option<T>,
    name: &'static str,
    values: &mut dyn Values<'de>,
) -> Result<(), ReadError> {
    if place.is_some() {
        return Err(ReadError::DuplicateField(name));
    }
    values.next(&mut |value| {
        *place = Some(T::deserialize(Source::new(value))?);
        Ok(())
    })
}

/// Number of parameters in lists.
pub const fn count(parts: &[&[ParameterInfo]]) -> usize {
    let (mut count, mut i) = (0, 0);
    while i < parts.len() {
        count += parts[i].len();
        i += 1;
    }
    count
}

/// Lists of parameters behind each other.
pub const fn joined<const N: usize>(parts: &[&[ParameterInfo]]) -> [ParameterInfo; N] {
    let mut all = [ParameterInfo::NONE; N];
    let (mut at, mut i) = (0, 0);
    while i < parts.len() {
        let mut k = 0;
        while k < parts[i].len() {
            all[at] = parts[i][k];
            at += 1;
            k += 1;
        }
        i += 1;
    }
    all
}

/// The same parameters, one of them with another default; compiling fails where there is none of this name.
pub const fn with_default<const N: usize>(
    infos: &[ParameterInfo],
    name: &str,
    default: &'static str,
) -> [ParameterInfo; N] {
    let mut all = joined::<N>(&[infos]);
    let mut i = 0;
    while !same(all[i].name, name) {
        i += 1;
    }
    all[i].default = Some(default);
    all
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Names of parameters.
pub const fn names<const N: usize>(infos: &[ParameterInfo]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = infos[i].name;
        i += 1;
    }
    names
}

/// Parameters by name, on their way to the one that reads them.
struct Struct<'r, 'de> {
    name: &'static str,
    names: &'static [&'static str],
    read: &'r mut dyn FnMut(usize, &mut dyn Values<'de>) -> Result<(), ReadError>,
}

impl<'de> Visitor<'de> for Struct<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "struct {}", self.name)
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<(), M::Error> {
        // One value that is wrong does not hide another: whoever gives the values keeps what is wrong with each.
        let mut first = None;
        loop {
            match map.next_key_seed(Name(self.names)) {
                Ok(Some(index)) => {
                    if let Err(error) = (self.read)(index, &mut Of(&mut map)) {
                        first.get_or_insert(error);
                    }
                }
                Ok(None) => return first.map_or(Ok(()), |error| Err(error.raise())),
                // Not every source can go on behind a value that is wrong; what it meets there is no other mistake.
                Err(error) => return Err(first.map_or(error, ReadError::raise)),
            }
        }
    }
}

/// The index of a name among those that are known.
struct Name(&'static [&'static str]);

impl<'de> DeserializeSeed<'de> for Name {
    type Value = usize;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<usize, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl Visitor<'_> for Name {
    type Value = usize;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a parameter")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<usize, E> {
        self.0.iter().position(|known| *known == name).ok_or_else(|| E::unknown_field(name, self.0))
    }
}
