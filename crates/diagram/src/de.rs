//! Typed parameters from written ones: wherever a number is asked for, a text is an expression.
//!
//! Problems are noted where they arise, with their place; what travels back through serde is only a sign that one
//! was noted, because the way leads through type-erased code that keeps nothing but text.

use std::cell::RefCell;
use std::fmt::Display;
use std::rc::Rc;

use blocksim_block::problem::{FileId, Place, Problem};
use blocksim_block::{BlockInfo, ParamUnits, VALUE_ENUM};
use blocksim_signal::{Dimension, Unit, Value, si_text};
use serde::de::value::{StrDeserializer, U32Deserializer};
use serde::de::{
    self, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess,
    Visitor,
};

use crate::scope::{Evaluation, Scope, expression};
use crate::tree::{Name, Node, Shape};

/// What all values of one block share.
pub(crate) struct Reading<'a> {
    pub scope: Rc<Scope<'a>>,
    pub file: FileId,
    pub info: Option<&'static BlockInfo>,
    pub problem: RefCell<Option<Problem>>,
    pub units: RefCell<ParamUnits>,
}

impl<'a> Reading<'a> {
    pub(crate) fn new(scope: Rc<Scope<'a>>, file: FileId, info: Option<&'static BlockInfo>) -> Self {
        Self { scope, file, info, problem: RefCell::default(), units: RefCell::default() }
    }

    fn note(&self, problem: Problem) -> Noted {
        self.problem.borrow_mut().get_or_insert(problem);
        Noted(String::new())
    }

    fn place(&self, node: &Node) -> Place {
        Place { file: self.file, span: node.span.clone() }
    }
}

/// A problem was noted, or serde says something that has no place yet.
#[derive(Debug)]
pub(crate) struct Noted(pub String);

impl Display for Noted {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Noted {}

impl de::Error for Noted {
    fn custom<T: Display>(message: T) -> Self {
        Noted(message.to_string())
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Noted(format!("`{field}` is not known here; known are {}", crate::ast::list(expected)))
    }

    fn missing_field(field: &'static str) -> Self {
        Noted(format!("`{field}` is missing"))
    }
}

/// What is expected of the numbers of a parameter.
#[derive(Clone, Copy)]
pub(crate) struct Expected<'k> {
    /// Top-level name of the parameter.
    field: Option<&'k str>,
    /// Its dimension, where it is fixed.
    dimension: Option<Dimension>,
}

/// A written value, ready to become whatever is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Written<'n, 'a> {
    pub reading: &'n Reading<'a>,
    pub node: &'n Node,
    pub expected: Expected<'n>,
}

impl<'n, 'a> Written<'n, 'a> {
    pub(crate) fn new(reading: &'n Reading<'a>, node: &'n Node) -> Self {
        Self { reading, node, expected: Expected { field: None, dimension: None } }
    }

    /// Gives the place of this value to a message that has none yet.
    fn placed<T>(&self, result: Result<T, Noted>) -> Result<T, Noted> {
        result.map_err(|noted| {
            if noted.0.is_empty() {
                return noted;
            }
            let place = self.reading.place(self.node);
            let name = self.expected.field.map(|field| format!("`{field}`: ")).unwrap_or_default();
            self.reading.note(Problem::error("parameter", format!("{name}{}", noted.0)).at(&place, ""))
        })
    }

    fn evaluate(&self) -> Result<Value, Noted> {
        let stack = Vec::new();
        let evaluation = Evaluation { scope: &self.reading.scope, file: self.reading.file, stack: &stack };
        evaluation.value(self.node).map_err(|problem| self.reading.note(problem))
    }

    /// An expression, evaluated, with the place of its text.
    fn computed(&self) -> Result<Computed<'n, 'a>, Noted> {
        let value = match &self.node.value {
            Shape::Text(text) => {
                let (file, span) = (self.reading.file, &self.node.span);
                expression(&self.reading.scope, text, file, span.start + 1, span)
                    .map_err(|problem| self.reading.note(problem))?
            }
            _ => self.evaluate()?,
        };
        Ok(Computed { written: *self, value })
    }

    fn mismatch<T>(&self, wanted: &str) -> Result<T, Noted> {
        self.placed(Err(Noted(format!("expected {wanted}, found {}", self.node.describe()))))
    }

    fn with_node(&self, node: &'n Node) -> Self {
        Self { node, ..*self }
    }
}

/// Members of a set or of `Kind(...)`.
struct Members<'n, 'a> {
    written: Written<'n, 'a>,
    rest: std::slice::Iter<'n, (Name, Node)>,
    value: Option<(&'n Name, &'n Node)>,
    top: bool,
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
            Err(noted) => Written { node: &at, ..self.written }.placed_err(noted),
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
        }
        let result = seed.deserialize(value);
        value.placed(result)
    }
}

impl Written<'_, '_> {
    fn placed_err<T>(&self, noted: Noted) -> Result<T, Noted> {
        self.placed(Err(noted))
    }
}

/// What the kind says of the unit of a parameter.
fn expected(info: Option<&'static BlockInfo>, field: &str) -> Expected<'static> {
    let parameter = info.and_then(|info| info.parameters.iter().find(|parameter| parameter.name == field));
    let dimension = parameter
        .filter(|parameter| !parameter.unit.is_empty())
        .and_then(|parameter| Unit::parse(parameter.unit).ok())
        .map(|unit| unit.dimension);
    Expected { field: None, dimension }
}

struct Items<'n, 'a> {
    written: Written<'n, 'a>,
    rest: std::slice::Iter<'n, Node>,
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
                    let top = self.expected.field.is_none() && self.reading.info.is_some();
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
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
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
            return self.placed(visitor.visit_enum(Wire(&computed.value)));
        }
        let Some(word) = self.node.word() else {
            return self.mismatch(&format!("one of {}", crate::ast::list(variants)));
        };
        if !variants.contains(&word) {
            let place = self.reading.place(self.node);
            let field = self.expected.field.map(|field| format!(" for `{field}`")).unwrap_or_default();
            let problem = Problem::error("parameter", format!("`{word}` is no choice{field}")).at(&place, "");
            let problem = match blocksim_signal::closest(word, variants.iter().copied()) {
                Some(known) => problem
                    .help(format!("did you mean `{known}`? The choices are {}", crate::ast::list(variants))),
                None => problem.help(format!("the choices are {}", crate::ast::list(variants))),
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

/// `Kind`, `Kind(value)` or `Kind(name: value)` as an alternative of an enum.
struct Variant<'n, 'a>(Written<'n, 'a>);

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
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Noted> {
        match self.0.node.members() {
            Some(members) => {
                let access = Members { written: self.0, rest: members.iter(), value: None, top: false };
                visitor.visit_map(access)
            }
            None => self.0.mismatch("named values in parentheses"),
        }
    }
}

/// A value that was computed, with the text that it came from for messages.
struct Computed<'n, 'a> {
    written: Written<'n, 'a>,
    value: Value,
}

impl Computed<'_, '_> {
    fn of(&self, value: Value) -> Self {
        Computed { written: self.written, value }
    }

    fn wrong<T>(&self, wanted: &str) -> Result<T, Noted> {
        Err(Noted(format!("expected {wanted}, found {}", self.value.describe())))
    }

    /// The number, with its unit checked against what the parameter asks for.
    fn number(&self) -> Result<f64, Noted> {
        let Some(quantity) = self.value.as_number() else { return self.wrong("a number") };
        let Expected { field, dimension } = self.written.expected;
        match (field, dimension) {
            (_, Some(dimension)) => {
                let bare = quantity.dimension == Dimension::NONE && is_bare(self.written.node);
                if !bare && !dimension.compatible(quantity.dimension) {
                    return Err(self.written.reading.note(self.wrong_unit(
                        quantity.value,
                        quantity.dimension,
                        dimension,
                    )));
                }
            }
            // A bare number says nothing of its unit.
            (Some(_), None) if matches!(self.written.node.value, Shape::Number(_)) => {}
            (Some(field), None) => {
                let mut units = self.written.reading.units.borrow_mut();
                let known = units.find(field);
                if known.is_none() || quantity.dimension != Dimension::NONE {
                    units.insert(field, quantity.dimension);
                }
            }
            (None, None) => {}
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

/// A number or a plain reference to one: without a unit it is meant in SI. A computed number without unit is not.
fn is_bare(node: &Node) -> bool {
    match &node.value {
        Shape::Text(text) => {
            let text = text.trim();
            text.parse::<f64>().is_ok()
                || (text.chars().next().is_some_and(|c| c.is_ascii_alphabetic())
                    && text.chars().all(|c| c.is_ascii_alphanumeric() || "_.[] -+".contains(c)))
        }
        _ => true,
    }
}

macro_rules! computed_integers {
    ($($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Noted> {
            let number = self.number()?;
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
        match &self.value {
            Value::List(items) => visitor.visit_seq(List(&self, items.clone().into_iter())),
            _ => self.wrong("a list"),
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
        match &self.value {
            Value::Set(members) => visitor.visit_map(Set(&self, members.clone().into_iter(), None)),
            _ => self.wrong("a set"),
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
            return visitor.visit_enum(Wire(&self.value));
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

/// A value of any type on its way into a `ParamValue`, as the enum that reads it.
#[derive(Clone, Copy)]
struct Wire<'v>(&'v Value);

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
                seed.deserialize(de::value::SeqDeserializer::new(items))
            }
            Value::Set(members) => {
                let members = members.iter().map(|(name, value)| Pair(name, value));
                seed.deserialize(de::value::SeqDeserializer::new(members))
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
                    2 => seed.deserialize(de::value::SeqDeserializer::new(self.1.into_iter())).map(Some),
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

/// A value that is either an alternative written as a word, or something else.
pub(crate) enum Either<A, B> {
    /// `Word` or `Word(...)`.
    Word(A),
    /// A number, a text ...
    Other(B),
}

/// Reads a word as `A` and everything else as `B`.
pub(crate) fn word_or<'de, D, A, B>(deserializer: D) -> Result<Either<A, B>, D::Error>
where
    D: Deserializer<'de>,
    A: de::Deserialize<'de>,
    B: de::Deserialize<'de>,
{
    struct Look<A, B>(std::marker::PhantomData<(A, B)>);
    impl<'de, A: de::Deserialize<'de>, B: de::Deserialize<'de>> Visitor<'de> for Look<A, B> {
        type Value = Either<A, B>;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("a word or a value")
        }

        fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
            A::deserialize(deserializer).map(Either::Word)
        }

        fn visit_newtype_struct<D: Deserializer<'de>>(
            self,
            deserializer: D,
        ) -> Result<Self::Value, D::Error> {
            B::deserialize(deserializer).map(Either::Other)
        }
    }
    deserializer.deserialize_newtype_struct(WORD_OR, Look(std::marker::PhantomData))
}

/// Asks a written value whether it is a word.
const WORD_OR: &str = "$blocksim::WordOr";
