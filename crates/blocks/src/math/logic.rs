use super::elements::{borrowed, input_names};
use blocksim_block::prelude::*;

/// Combines truth values, element by element.
///
/// `And`, `Or`, `Nand` and `Nor` mean all, any, not all, none; `Xor` is true where an odd number of inputs is.
/// `Not` has the one input `u`.
///
/// ```ron
/// Logic(operator: And, inputs: 3)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Value("operator"))]
pub struct Logic {
    /// `And`, `Or`, `Not`, `Nand`, `Nor` or `Xor`.
    pub operator: Gate,
    /// Number of inputs; without meaning for `Not`.
    #[block(at_least = 1, at_most = MOST_PORTS, default = 2)]
    pub inputs: usize,
}

/// Logical operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Gate {
    /// All are true.
    And,
    /// At least one is true.
    Or,
    /// The input is false.
    Not,
    /// Not all are true.
    Nand,
    /// None is true.
    Nor,
    /// An odd number is true.
    Xor,
}

impl Gate {
    fn of<'r>(self, inputs: impl Iterator<Item = Condition<'r>>) -> Option<Condition<'r>> {
        match self {
            Gate::And => inputs.reduce(Condition::and),
            Gate::Nand => inputs.reduce(Condition::and).map(|all| !all),
            Gate::Or => inputs.reduce(Condition::or),
            Gate::Nor | Gate::Not => inputs.reduce(Condition::or).map(|any| !any),
            Gate::Xor => inputs.reduce(Condition::xor),
        }
    }
}

impl Block for Logic {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = input_names(if self.operator == Gate::Not { 1 } else { self.inputs });
        let names = borrowed(&names);
        let shape = given.common_shape(&names, &[])?;
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::boolean(*name)));
        Ok(interface.output(Output::boolean("y").shape(shape)))
    }

    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            let inputs = (0..l.inputs()).map(|port| l.element(port, i).is_true());
            if let Some(value) = self.operator.of(inputs) {
                l.set_truth(0, i, value);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_tables_of_truth_are_right() {
        // For the inputs 00, 01, 10, 11.
        for (operator, table) in [
            (Gate::And, [0.0, 0.0, 0.0, 1.0]),
            (Gate::Or, [0.0, 1.0, 1.0, 1.0]),
            (Gate::Nand, [1.0, 1.0, 1.0, 0.0]),
            (Gate::Nor, [1.0, 0.0, 0.0, 0.0]),
            (Gate::Xor, [0.0, 1.0, 1.0, 0.0]),
        ] {
            let boolean = PortType::boolean().shaped(Shape::Vector(4));
            let inputs = vec![("u1".to_owned(), boolean), ("u2".to_owned(), boolean)];
            let mut bench = Bench::with_inputs(Logic { operator, inputs: 2 }, inputs);
            let y = bench.set(0, &[0.0, 0.0, 1.0, 1.0]).set(1, &[0.0, 1.0, 0.0, 1.0]).major();
            assert_eq!(y, table, "{operator:?}");
        }
    }

    #[test]
    fn not_has_one_input() {
        let mut bench = Bench::new(Logic { operator: Gate::Not, inputs: 2 });
        assert_eq!(bench.interface.inputs.len(), 1);
        assert_eq!([bench.respond(0.0), bench.respond(1.0)], [1.0, 0.0]);
    }

    #[test]
    fn three_inputs_are_odd_when_one_or_all_are_true() {
        let mut bench = Bench::new(Logic { operator: Gate::Xor, inputs: 3 });
        assert_eq!(bench.set(0, &[1.0]).major(), [1.0]);
        assert_eq!(bench.set(1, &[1.0]).major(), [0.0]);
        assert_eq!(bench.set(2, &[1.0]).major(), [1.0]);
    }

    #[test]
    fn only_truth_values_go_in_and_out() {
        let interface = Logic { operator: Gate::And, inputs: 2 }.interface(&Given::nothing()).unwrap();
        assert!(interface.inputs.iter().all(|input| input.kind == Some(Kind::Bool)));
        assert_eq!(interface.outputs[0].port_type, PortType::boolean());
        assert_eq!(Logic { operator: Gate::And, inputs: 0 }.errors()[0].param, "inputs");
    }
}
