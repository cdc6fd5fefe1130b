//! Sets of parameters: those of a kind of block, and groups of them that several kinds share.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, Visitor};

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
}

/// A struct of parameters. `#[derive(BlockMeta)]` implements it for a kind of block, `#[derive(Parameters)]` for a group
/// that several kinds have in common: a field `#[block(group)]` of such a type stands for all parameters of the group, which
/// diagrams and the manual show beside the others. `#[block(group(v_f = 0.8))]` gives one of them another default.
pub trait Parameters: Sized {
    /// What is known of them, those of groups in their places.
    const INFOS: &'static [ParameterInfo];
    /// Their names, in the same order.
    const NAMES: &'static [&'static str];
    /// What was read so far.
    type Read: Default;

    /// Reads the next value of a map, that of the parameter with this index.
    ///
    /// # Errors
    /// The value is not of its type, or the parameter was there before.
    fn read<'de, M: MapAccess<'de>>(read: &mut Self::Read, index: usize, map: &mut M)
    -> Result<(), M::Error>;

    /// All parameters, defaults in the places of those that were not given.
    ///
    /// # Errors
    /// One without a default is missing.
    fn whole<E: Error>(read: Self::Read) -> Result<Self, E>;
}

/// Reads all parameters of a struct of this name.
///
/// # Errors
/// A name that is not known or stands twice, a value that is not of its type, a parameter that is missing.
pub fn read_parameters<'de, P: Parameters, D: Deserializer<'de>>(
    name: &'static str,
    deserializer: D,
) -> Result<P, D::Error> {
    deserializer.deserialize_struct(name, P::NAMES, Struct(name, PhantomData))
}

/// Reads the value of one parameter.
///
/// # Errors
/// As [`Parameters::read`].
pub fn read_value<'de, T: serde::Deserialize<'de>, M: MapAccess<'de>>(
    place: &mut Option<T>,
    name: &'static str,
    map: &mut M,
) -> Result<(), M::Error> {
    if place.is_some() {
        return Err(M::Error::duplicate_field(name));
    }
    *place = Some(map.next_value()?);
    Ok(())
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
    let mut all = [ParameterInfo { name: "", rust_type: "", unit: "", default: None, doc: "" }; N];
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

struct Struct<P>(&'static str, PhantomData<P>);

impl<'de, P: Parameters> Visitor<'de> for Struct<P> {
    type Value = P;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "struct {}", self.0)
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<P, M::Error> {
        let mut read = P::Read::default();
        while let Some(index) = map.next_key_seed(Name(P::NAMES))? {
            P::read(&mut read, index, &mut map)?;
        }
        P::whole(read)
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
