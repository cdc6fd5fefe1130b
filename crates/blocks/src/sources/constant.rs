use blocksim_block::prelude::*;
use blocksim_signal::{Quantity, Value};

use crate::math::entries::{common, elements, shape_of};

/// A value that never changes: a number, a truth value, a list of either, which makes a vector, or a list of rows, which makes
/// a matrix.
///
/// The unit is the one that is written; a plain number has none. In a list zero fits every unit.
///
/// ```ron
/// Constant(value: "48 V")
/// ```
/// ```ron
/// Constant(value: [[1, 0, 0], [0, 1, 0]])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Value("value"))]
pub struct Constant {
    /// The value: `3`, `"48 V"`, `true`, `["10 deg", "-20 deg"]`, `[[1, 2], [3, 4]]`.
    pub value: ParamValue,
}

impl Constant {
    /// All values, row by row.
    fn items(&self) -> Vec<&Value> {
        elements(&self.value.0)
    }

    fn quantities(&self) -> Vec<Quantity> {
        self.items().into_iter().filter_map(Value::as_number).collect()
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if let Err(reason) = shape_of(&self.value.0) {
            errors.add(ParamError::new("value", format!("`value`: {reason}")));
        }
        let items = self.items();
        let quantities = self.quantities();
        let is_other = |item: &&&Value| item.as_bool().is_none() && item.as_number().is_none();
        if let Some(other) = items.iter().find(is_other) {
            let what = other.describe();
            let message = format!("`value` contains {what}, but must be made of numbers or of truth values");
            errors.add(ParamError::new("value", message));
        } else if !quantities.is_empty() && quantities.len() < items.len() {
            errors.add(ParamError::new("value", "`value` mixes numbers and truth values"));
        }
        if let Some(quantity) = quantities.iter().find(|quantity| !quantity.value.is_finite()) {
            errors.take(finite("value", quantity.value));
        }
        if let Err(reason) = common(&quantities) {
            let error = ParamError::new("value", format!("`value` {reason}"));
            errors.add(error.help("give all elements the same unit"));
        }
    }
}

impl Block for Constant {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let items = self.items();
        let shape = shape_of(&self.value.0).unwrap_or_default();
        let y = match items.first().and_then(|item| item.as_bool()) {
            Some(_) => PortType::boolean(),
            None => PortType::scalar().of(common(&self.quantities()).ok()),
        };
        Ok(Interface::new().output(Output::like("y", y.shaped(shape))).constant())
    }

    fn law(&self, l: &Recording) -> bool {
        let number = |item: &Value| match item {
            Value::Bool(value) => f64::from(*value),
            _ => item.as_number().map_or(f64::NAN, |quantity| quantity.value),
        };
        self.items().into_iter().enumerate().for_each(|(i, item)| l.set(0, i, l.constant(number(item))));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;

    fn constant(value: impl Into<Value>) -> Constant {
        Constant { value: ParamValue(value.into()) }
    }

    fn volts(value: f64) -> Value {
        Quantity::new(value, dimension("V")).into()
    }

    #[test]
    fn a_number_keeps_its_unit() {
        let mut bench = Bench::new(constant(volts(48.0)));
        assert_eq!(bench.interface.outputs[0].port_type, PortType::scalar().of(Some(dimension("V"))));
        assert_eq!(bench.interface.sample_time, Some(SampleTime::Constant));
        assert_eq!(bench.major(), [48.0]);
    }

    #[test]
    fn a_list_is_a_vector_in_which_zero_fits_every_unit() {
        let mut bench = Bench::new(constant(Value::List(vec![0.0.into(), volts(2.0)])));
        assert_eq!(bench.interface.outputs[0].port_type, PortType::vector(2).of(Some(dimension("V"))));
        assert_eq!(bench.major(), [0.0, 2.0]);
    }

    #[test]
    fn rows_are_a_matrix() {
        let row = |items: [f64; 3]| Value::List(items.map(Value::from).to_vec());
        let mut bench = Bench::new(constant(Value::List(vec![row([1.0, 2.0, 3.0]), row([4.0, 5.0, 6.0])])));
        assert_eq!(bench.interface.outputs[0].port_type.shape, Shape::Matrix(2, 3));
        assert_eq!(bench.major(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn a_truth_value_is_a_bool_signal() {
        let mut bench = Bench::new(constant(Value::Bool(true)));
        assert_eq!(bench.interface.outputs[0].port_type, PortType::boolean());
        assert_eq!(bench.major(), [1.0]);
    }

    #[test]
    fn mixed_lists_and_texts_are_refused() {
        let list = |items: Vec<Value>| constant(Value::List(items));
        for (block, what) in [
            (constant(Value::Text("a".to_owned())), "a text"),
            (list(vec![]), "empty"),
            (list(vec![1.0.into(), Value::Bool(true)]), "mixes numbers and truth values"),
            (list(vec![1.0.into(), volts(2.0)]), "mixes 1 and V"),
            (list(vec![Value::List(vec![])]), "empty"),
            (list(vec![Value::List(vec![1.0.into()]), 1.0.into()]), "mixes rows with other values"),
            (constant(f64::NAN), "finite"),
        ] {
            let error = block.errors()[0].clone();
            assert!(error.param == "value" && error.message.contains(what), "{}", error.message);
        }
    }
}
