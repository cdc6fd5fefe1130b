use super::elements::{borrowed, input_names};
use blocksim_block::prelude::*;

/// The least or the greatest of the inputs, element by element.
///
/// All inputs have one unit; a scalar is compared with each element of a vector. With one input `y` is the least or
/// greatest of its elements. The solver steps onto the kink where another input takes over. If an operand is not a
/// number, neither is `y`.
///
/// ```ron
/// MinMax(function: Max, inputs: 2)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Value("function"))]
pub struct MinMax {
    /// `Min` or `Max`.
    pub function: Extremum,
    /// Number of inputs.
    #[block(at_least = 1, at_most = MOST_PORTS, default = 2)]
    pub inputs: usize,
}

/// Which extremum is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Extremum {
    /// The least.
    Min,
    /// The greatest.
    Max,
}

impl Block for MinMax {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = input_names(self.inputs);
        let names = borrowed(&names);
        let (shape, operands) = match names[..] {
            [name] => (Shape::Scalar, given.input_or_unknown(name).shape.len()),
            _ => (given.common_shape(&names, &[])?, names.len()),
        };
        let y = PortType::UNKNOWN.of(given.common_dimension(&names)?).shaped(shape);
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::real(*name)));
        let guards = shape.len() * operands.saturating_sub(1);
        let interface = interface.output(Output::like("y", y)).kink_each("takes_over", guards);
        Ok(interface.called("passes another input", "passes another input"))
    }

    fn law(&self, l: &Recording) -> bool {
        let mut guards = 0..;
        l.each(0, |i| {
            let mut operands = match l.inputs() {
                1 => l.input(0).to_vec(),
                n => (0..n).map(|port| l.element(port, i)).collect(),
            }
            .into_iter();
            let first = operands.next().unwrap_or_else(|| l.constant(f64::NAN));
            operands.fold(first, |leader, u| {
                guards.next().into_iter().for_each(|guard| l.guard(guard, leader - u));
                match self.function {
                    Extremum::Min => leader.min(u),
                    Extremum::Max => leader.max(u),
                }
            })
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_extremum_of_several_inputs_is_taken_element_by_element() {
        let inputs = || {
            vec![
                ("u1".to_owned(), PortType::vector(2)),
                ("u2".to_owned(), PortType::scalar()),
                ("u3".to_owned(), PortType::vector(2)),
            ]
        };
        for (function, expected) in [(Extremum::Min, [1.0, 2.0]), (Extremum::Max, [5.0, 4.0])] {
            let mut bench = Bench::with_inputs(MinMax { function, inputs: 3 }, inputs());
            assert_eq!(bench.set(0, &[1.0, 4.0]).set(1, &[2.0]).set(2, &[5.0, 3.0]).major(), expected);
        }
    }

    #[test]
    fn one_input_gives_the_extremum_of_its_elements() {
        let block = MinMax { function: Extremum::Max, inputs: 1 };
        let mut bench = Bench::with_inputs(block, vec![("u".to_owned(), PortType::vector(3))]);
        assert_eq!(bench.set(0, &[1.0, 7.0, 5.0]).major(), [7.0]);
        assert_eq!(bench.guards(), [-6.0, 2.0]);
    }

    #[test]
    fn the_guards_change_sign_where_another_input_takes_over() {
        let block = MinMax { function: Extremum::Min, inputs: 3 };
        let mut bench = Bench::new(block);
        bench.set(0, &[1.0]).set(1, &[2.0]).set(2, &[0.5]);
        assert_eq!(bench.guards(), [-1.0, 0.5]);
        assert_eq!(bench.set(2, &[1.5]).guards(), [-1.0, -0.5]);
    }

    #[test]
    fn what_is_not_a_number_is_not_hidden() {
        for function in [Extremum::Min, Extremum::Max] {
            for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN)] {
                assert!(
                    Bench::new(MinMax { function, inputs: 2 }).set(0, &[a]).set(1, &[b]).major()[0].is_nan()
                );
            }
        }
    }

    #[test]
    fn all_inputs_have_one_unit() {
        let block = MinMax { function: Extremum::Min, inputs: 2 };
        let y = block.interface(&given(&[("u1", "V")], &[])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("V")));
        assert_eq!(
            block.interface(&given(&[("u1", "V"), ("u2", "A")], &[])).unwrap_err().code,
            "unit_mismatch"
        );
        assert!(!MinMax { inputs: 0, ..block }.errors().is_empty());
    }
}
