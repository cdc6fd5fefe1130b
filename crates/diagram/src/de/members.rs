//! The parts of a written value, handed to serde one by one.

use blocksim_block::problem::Problem;
use blocksim_block::{BlockInfo, ParameterInfo};
use blocksim_signal::Unit;
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor,
};

use super::written::Written;
use super::{Expected, Noted};
use crate::replacing::Place;
use blocksim_syntax::{Name, Node, Shape};

/// Members of a set or of `Kind(...)`.
pub(super) struct Members<'n, 'a> {
    pub written: Written<'n, 'a>,
    pub rest: std::slice::Iter<'n, (Name, Node)>,
    pub value: Option<(&'n Name, &'n Node)>,
    pub top: bool,
}

impl<'de> MapAccess<'de> for Members<'_, '_> {
    type Error = Noted;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Noted> {
        let Some((name, node)) = self.rest.next() else { return Ok(None) };
        self.value = Some((name, node));
        let key: StrDeserializer<Noted> = name.text.as_str().into_deserializer();
        let at = Node { span: name.span.clone(), value: Shape::Word(name.text.clone()) };
        match seed.deserialize(key) {
            Ok(key) => Ok(Some(key)),
            Err(noted) => Written { node: &at, ..self.written }.placed(Err(noted)),
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Noted> {
        let Some((name, node)) = self.value.take() else {
            return Err(Noted("a value without a name".to_owned()));
        };
        let mut value = self.written.with_node(node);
        if self.top {
            value.expected = expected(self.written.reading.info, &name.text);
            value.expected.field = Some(&name.text);
            value.refuse_zero(&name.text)?;
        }
        let result = seed.deserialize(value);
        value.placed(result)
    }
}

impl Written<'_, '_> {
    /// Refuses a unit with a zero of its own where the parameter is a difference: 3 degC is 276.15 K, and nobody means that.
    fn refuse_zero(&self, field: &str) -> Result<(), Noted> {
        let reading = self.reading;
        let is_difference = parameter(reading.info, field).is_some_and(|parameter| parameter.is_difference);
        if !is_difference || matches!(self.node.value, Shape::Number(_)) {
            return Ok(());
        }
        let node = std::rc::Rc::new(self.node.clone());
        let Some(unit) = (Place { scope: reading.scope.clone(), file: reading.file, node }).own_zero() else {
            return Ok(());
        };
        let si = Unit::si(unit.dimension);
        let place = reading.place(self.node);
        let message = format!(
            "`{field}` is a difference or a factor, but {} counts from {} {si}",
            unit.text, unit.offset
        );
        let mut problem = Problem::error("unit_mismatch", message).at(&place, format!("should be in {si}"));
        problem = match &self.node.value {
            Shape::Text(text) if text.contains(&unit.text) => {
                problem.help(format!("write \"{}\"", text.replace(&unit.text, &si.text)))
            }
            Shape::Text(text) => problem.help(format!("give `{text}` in {si}")),
            _ => problem.help(format!("write {si}")),
        };
        let written = reading.scope.sources.file(place.file).text.get(place.span.clone()).map(str::to_owned);
        if let Some(old) = written.filter(|old| unit.scale == 1.0 && old.contains(&unit.text)) {
            let new = old.replace(&unit.text, &si.text);
            problem = problem.edit(place, old, new);
        }
        Err(reading.note(problem))
    }
}

fn parameter(info: Option<&'static BlockInfo>, field: &str) -> Option<&'static ParameterInfo> {
    info?.parameters.iter().find(|parameter| parameter.name == field)
}

/// What the kind says of the unit of a parameter.
fn expected(info: Option<&'static BlockInfo>, field: &str) -> Expected<'static> {
    let parameter = parameter(info, field);
    let dimension = parameter
        .filter(|parameter| !parameter.unit.is_empty())
        .and_then(|parameter| Unit::parse(parameter.unit).ok())
        .map(|unit| unit.dimension);
    Expected { field: None, dimension }
}

pub(super) struct Items<'n, 'a> {
    pub written: Written<'n, 'a>,
    pub rest: std::slice::Iter<'n, Node>,
}

impl<'de> SeqAccess<'de> for Items<'_, '_> {
    type Error = Noted;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Noted> {
        let Some(node) = self.rest.next() else { return Ok(None) };
        let item = self.written.with_node(node);
        let result = seed.deserialize(item);
        item.placed(result).map(Some)
    }
}

/// `Kind`, `Kind(value)` or `Kind(name: value)` as an alternative of an enum.
pub(super) struct Variant<'n, 'a>(pub Written<'n, 'a>);

impl<'de> EnumAccess<'de> for Variant<'_, '_> {
    type Error = Noted;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Noted> {
        let word: StrDeserializer<Noted> = self.0.node.word().unwrap_or_default().into_deserializer();
        Ok((seed.deserialize(word)?, self))
    }
}

impl<'de> VariantAccess<'de> for Variant<'_, '_> {
    type Error = Noted;

    fn unit_variant(self) -> Result<(), Noted> {
        match self.0.node.members() {
            Some([]) => Ok(()),
            _ => self.0.mismatch("no parameters"),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Noted> {
        match &self.0.node.value {
            Shape::Tuple(Some(_), items) if items.len() == 1 => seed.deserialize(self.0.with_node(&items[0])),
            _ => self.0.mismatch("one value in parentheses"),
        }
    }

    fn tuple_variant<V: Visitor<'de>>(self, _len: usize, visitor: V) -> Result<V::Value, Noted> {
        match &self.0.node.value {
            Shape::Tuple(Some(_), items) => visitor.visit_seq(Items { written: self.0, rest: items.iter() }),
            _ => self.0.mismatch("values in parentheses"),
        }
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
        match self.0.node.members() {
            Some(members) => {
                self.0.only(members, fields)?;
                let access = Members { written: self.0, rest: members.iter(), value: None, top: false };
                visitor.visit_map(access)
            }
            None => self.0.mismatch("named values in parentheses"),
        }
    }
}
