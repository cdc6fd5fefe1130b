use super::elements::{borrowed, input_names};
use blocksim_block::prelude::*;

/// Adds and subtracts: $y = \pm u_1 \pm u_2 \dots$, element by element.
///
/// All inputs have one unit; a scalar is added to each element of a vector. With a single sign the elements of the
/// one input `u` are added: $y = \pm \sum_i u_i$.
///
/// ```ron
/// Sum(signs: "+-")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Sum)]
pub struct Sum {
    /// A `+` or `-` for each input.
    #[block(not_empty, empty = "write one + or - for each input: \"+-\"")]
    pub signs: String,
}

impl Sum {
    fn validate(&self, errors: &mut ParamErrors) {
        if let Some((at, sign)) = self.signs.char_indices().find(|(_, sign)| !matches!(sign, '+' | '-')) {
            let message = format!("`{sign}` in `signs` is neither + nor -");
            errors.add(ParamError::new("signs", message).within(at..at + sign.len_utf8()));
        }
    }
}

impl Block for Sum {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = input_names(self.signs.chars().count());
        let names = borrowed(&names);
        let shape = if names.len() == 1 { Shape::Scalar } else { given.common_shape(&names, &[])? };
        let y = PortType::UNKNOWN.of(given.common_dimension(&names)?).shaped(shape);
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::real(*name)));
        Ok(interface.output(Output::like("y", y)))
    }

    fn law(&self, l: &Recording) -> bool {
        let single = l.inputs() == 1;
        l.each(0, |i| {
            let terms: Vec<_> = match single {
                true => l.input(0).to_vec(),
                false => (0..l.inputs()).map(|port| l.element(port, i)).collect(),
            };
            // One sign stands for all elements.
            let mut terms = terms.into_iter().zip(self.signs.bytes().cycle().map(|sign| sign == b'-'));
            let first = terms.next().map(|(u, minus)| if minus { -u } else { u });
            let sum =
                terms.fold(first, |sum, (u, minus)| sum.map(|sum| if minus { sum - u } else { sum + u }));
            sum.unwrap_or_else(|| l.constant(0.0))
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::{dimension, given};
    use super::*;
    use blocksim_block::testing::Bench;

    fn sum(signs: &str) -> Sum {
        Sum { signs: signs.to_owned() }
    }

    #[test]
    fn the_signs_say_what_is_added_and_subtracted() {
        for (signs, expected) in [("++", 7.0), ("+-", 3.0), ("-+", -3.0), ("--", -7.0)] {
            let y = Bench::new(sum(signs)).set(0, &[5.0]).set(1, &[2.0]).major();
            assert_eq!(y, [expected], "{signs}");
        }
    }

    #[test]
    fn a_scalar_is_added_to_each_element() {
        let inputs = vec![("u1".to_owned(), PortType::vector(3)), ("u2".to_owned(), PortType::scalar())];
        let y = Bench::with_inputs(sum("+-"), inputs).set(0, &[1.0, 2.0, 3.0]).set(1, &[1.0]).major();
        assert_eq!(y, [0.0, 1.0, 2.0]);
    }

    #[test]
    fn a_single_sign_adds_the_elements_of_one_input() {
        let inputs = vec![("u".to_owned(), PortType::vector(3))];
        for (signs, expected) in [("+", 6.0), ("-", -6.0)] {
            let y = Bench::with_inputs(sum(signs), inputs.clone()).set(0, &[1.0, 2.0, 3.0]).major();
            assert_eq!(y, [expected]);
        }
    }

    #[test]
    fn volts_and_amperes_are_not_added() {
        let y = sum("+-").interface(&given(&[("u1", "V"), ("u2", "mV")], &[])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("V")));
        let error = sum("+-").interface(&given(&[("u1", "V"), ("u2", "A")], &[])).unwrap_err();
        assert_eq!((error.code, error.ports), ("unit_mismatch", vec!["u2".to_owned(), "u1".to_owned()]));
    }

    #[test]
    fn other_signs_are_refused() {
        for signs in ["", "+*", "+ -"] {
            assert_eq!(sum(signs).errors()[0].param, "signs");
        }
    }
}
