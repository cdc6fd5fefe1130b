use super::elements::{borrowed, input_names, operands};
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
    pub signs: String,
}

impl Block for Sum {
    fn check(&self) -> Result<(), ParamError> {
        if self.signs.is_empty() {
            return Err(
                ParamError::new("signs", "`signs` is empty").help("write one + or - for each input: \"+-\"")
            );
        }
        match self.signs.chars().find(|sign| !matches!(sign, '+' | '-')) {
            Some(other) => Err(ParamError::new("signs", format!("`{other}` in `signs` is neither + nor -"))),
            None => Ok(()),
        }
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = input_names(self.signs.chars().count());
        let names = borrowed(&names);
        let shape = if names.len() == 1 { Shape::Scalar } else { given.common_shape(&names, &[])? };
        let y = PortType::UNKNOWN.of(given.common_dimension(&names)?).shaped(shape);
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::real(*name)));
        Ok(interface.output(Output::like("y", y)))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let signs = self.signs.as_bytes();
        let single = c.inputs.len() == 1;
        if let ([y], false) = (&mut *y, single) {
            // Scalars lie one behind the other.
            let terms = signs.iter().zip(c.u).map(|(sign, u)| if *sign == b'-' { -u } else { *u });
            *y = terms.fold(0.0, |sum, u| sum + u);
            return;
        }
        for (i, y) in y.iter_mut().enumerate() {
            *y =
                operands(c, i).enumerate().fold(0.0, |sum, (k, u)| match signs[if single { 0 } else { k }] {
                    b'-' => sum - u,
                    _ => sum + u,
                });
        }
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
            assert_eq!(sum(signs).check().unwrap_err().param, "signs");
        }
    }
}
