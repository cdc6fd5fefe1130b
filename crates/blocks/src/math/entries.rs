//! Numbers of a parameter that may be one number, a vector or a matrix.

use std::fmt;

use blocksim_block::{Given, Inspect, ParamValue};
use blocksim_signal::{Dimension, Quantity, Shape, Value};
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

/// A number, a list of numbers (a vector), or a list of rows of equal length (a matrix).
///
/// A single number notes its unit with the parameter, as every number does; a list has one unit for all of its numbers, in
/// which zero fits every unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Entries {
    /// Scalar, vector or matrix.
    pub shape: Shape,
    /// The numbers in SI, row by row.
    pub values: Vec<f64>,
    /// Unit of the numbers of a list: open if all are bare.
    pub dimension: Option<Dimension>,
}

impl From<f64> for Entries {
    fn from(value: f64) -> Self {
        Self { shape: Shape::Scalar, values: vec![value], dimension: None }
    }
}

impl TryFrom<Vec<f64>> for Entries {
    type Error = String;

    /// A vector of bare numbers; an empty one is refused.
    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        Self::of(values.into_iter().map(Value::from).collect())
    }
}

impl Entries {
    /// From the items of a list.
    fn of(items: Vec<Value>) -> Result<Self, String> {
        let list = Value::List(items);
        let shape = shape_of(&list)?;
        let mut quantities = Vec::with_capacity(shape.len());
        for item in elements(&list) {
            let number = item.as_number();
            quantities.push(number.ok_or_else(|| format!("expected a number, found {}", item.describe()))?);
        }
        let dimension = common(&quantities)?;
        Ok(Self {
            shape,
            values: quantities.iter().map(|quantity| quantity.value).collect(),
            dimension: Some(dimension),
        })
    }

    /// Number `i`, row by row; a scalar stands for every element.
    pub fn at(&self, i: usize) -> f64 {
        if let [value] = self.values[..] { value } else { self.values[i] }
    }

    /// The dimension that was written; nothing for bare numbers. `name` is that of the parameter.
    pub(crate) fn written(&self, given: &Given, name: &str) -> Option<Dimension> {
        let dimension = self.dimension.or_else(|| given.parameters.written(name));
        dimension.filter(|dimension| !dimension.is_open())
    }

    /// The dimension, where that of a single number, as the parameter has noted it, is `noted`.
    pub fn dimension_or(&self, noted: Dimension) -> Dimension {
        self.dimension.unwrap_or(noted)
    }
}

/// The shape of a list: a vector, or a matrix where its items are rows; a scalar for whatever is not a list.
///
/// # Errors
/// An empty list, rows of different lengths, rows beside other things.
pub(crate) fn shape_of(value: &Value) -> Result<Shape, String> {
    let Some(items) = value.as_list() else { return Ok(Shape::Scalar) };
    let rows: Vec<usize> = items.iter().filter_map(|item| item.as_list().map(<[Value]>::len)).collect();
    match (items.len(), &rows[..]) {
        (0, _) => Err("the list is empty".to_owned()),
        (n, []) => Ok(Shape::Vector(n)),
        (n, rows) if rows.len() < n => Err("the list mixes rows with other values".to_owned()),
        (_, [0, ..]) => Err("the first row is empty".to_owned()),
        (n, [first, ..]) => match rows.iter().position(|row| row != first) {
            None => Ok(Shape::Matrix(n, *first)),
            Some(row) => Err(format!(
                "row {row} has {} values, but row 0 has {first}: rows are of equal length",
                rows[row]
            )),
        },
    }
}

/// The values of a list, row by row if they stand in rows.
pub(crate) fn elements(value: &Value) -> Vec<&Value> {
    match value.as_list() {
        Some(items) => {
            items.iter().flat_map(|item| item.as_list().unwrap_or(std::slice::from_ref(item))).collect()
        }
        None => vec![value],
    }
}

/// The unit that all have in common: open if none is written.
///
/// # Errors
/// Two units; zero fits every unit.
pub(crate) fn common(quantities: &[Quantity]) -> Result<Dimension, String> {
    let written = quantities.iter().find(|quantity| quantity.dimension != Dimension::NONE);
    let dimension = written.map_or(Dimension::OPEN, |quantity| quantity.dimension);
    for quantity in quantities {
        let zero = quantity.value == 0.0 && quantity.dimension == Dimension::NONE;
        if !zero && !quantity.dimension.compatible(dimension) {
            return Err(format!("mixes {} and {dimension}", quantity.dimension));
        }
    }
    Ok(dimension)
}

impl Inspect for Entries {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        for (i, value) in self.values.iter().enumerate() {
            let inside = match self.shape {
                Shape::Scalar => &[][..],
                Shape::Vector(_) => &[i],
                Shape::Matrix(_, columns) => &[i / columns, i % columns],
            };
            let depth = place.len();
            place.extend_from_slice(inside);
            see(place, *value);
            place.truncate(depth);
        }
    }

    fn length(&self) -> Option<usize> {
        (self.shape != Shape::Scalar).then_some(self.values.len())
    }
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyShape)
    }
}

struct AnyShape;

impl<'de> Visitor<'de> for AnyShape {
    type Value = Entries;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, a list of numbers, or a list of rows")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Entries, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Entries, E> {
        Ok((value as f64).into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Entries, E> {
        Ok((value as f64).into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Entries, A::Error> {
        let mut items = Vec::new();
        while let Some(ParamValue(item)) = list.next_element()? {
            items.push(item);
        }
        Entries::of(items).map_err(A::Error::custom)
    }
}

#[cfg(test)]
pub(crate) fn matrix(rows: &[&[f64]]) -> Entries {
    Entries {
        shape: Shape::Matrix(rows.len(), rows[0].len()),
        values: rows.concat(),
        dimension: Some(Dimension::OPEN),
    }
}

#[cfg(test)]
pub(crate) fn vector(values: &[f64]) -> Entries {
    Entries { shape: Shape::Vector(values.len()), values: values.to_vec(), dimension: Some(Dimension::OPEN) }
}

#[cfg(test)]
mod tests {
    use super::super::elements::dimension;
    use super::*;

    fn list(items: &[f64]) -> Value {
        Value::List(items.iter().map(|item| (*item).into()).collect())
    }

    #[test]
    fn rows_make_a_matrix_and_numbers_a_vector() {
        let entries = Entries::of(vec![list(&[1.0, 2.0, 3.0]), list(&[4.0, 5.0, 6.0])]).unwrap();
        assert_eq!((entries.shape, entries.at(3)), (Shape::Matrix(2, 3), 4.0));
        assert_eq!(Entries::of(vec![1.0.into(), 2.0.into()]).unwrap().shape, Shape::Vector(2));
        assert_eq!(Entries::from(3.0).at(7), 3.0);
    }

    #[test]
    fn what_is_no_matrix_is_refused_with_its_row() {
        for (items, what) in [
            (vec![], "empty"),
            (vec![list(&[1.0]), 2.0.into()], "mixes rows"),
            (vec![list(&[1.0, 2.0]), list(&[1.0])], "row 1 has 1 values, but row 0 has 2"),
            (vec![list(&[])], "the first row is empty"),
            (vec![Value::Bool(true)], "expected a number"),
            (vec![Value::List(vec![list(&[1.0])])], "expected a number"),
        ] {
            let error = Entries::of(items).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }

    #[test]
    fn all_numbers_of_a_list_have_one_unit() {
        let volts = |value| Quantity::new(value, dimension("V")).into();
        let entries = Entries::of(vec![0.0.into(), volts(2.0)]).unwrap();
        assert_eq!(entries.dimension, Some(dimension("V")));
        assert_eq!(Entries::of(vec![1.0.into(), volts(2.0)]).unwrap_err(), "mixes 1 and V");
        assert_eq!(Entries::of(vec![1.0.into()]).unwrap().dimension, Some(Dimension::OPEN));
    }
}
