use super::elements::{borrowed, input_names};
use blocksim_block::prelude::*;

/// Multiplies: $y = u_1 u_2 \dots$, element by element.
///
/// The unit of the output is the product of the units; a scalar multiplies each element of a vector. With one input
/// the elements of `u` are multiplied.
///
/// ```ron
/// Product(inputs: 2)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("×"))]
pub struct Product {
    /// Number of inputs.
    #[block(default = 2)]
    pub inputs: usize,
}

impl Block for Product {
    fn check(&self) -> Result<(), ParamError> {
        count("inputs", self.inputs, 1, MOST_PORTS)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let names = input_names(self.inputs);
        let names = borrowed(&names);
        let (shape, dimension) = match names[..] {
            [name] => {
                let u = given.input_or_unknown(name);
                let power = i8::try_from(u.shape.len()).unwrap_or(i8::MAX);
                (Shape::Scalar, u.dimension.map(|dimension| dimension.power(power)))
            }
            _ => {
                let product = names.iter().try_fold(Dimension::NONE, |product, name| {
                    Some(product.times(given.input_or_unknown(name).dimension?))
                });
                (given.common_shape(&names, &[])?, product)
            }
        };
        let interface =
            names.iter().fold(Interface::new(), |interface, name| interface.input(Input::real(*name)));
        Ok(interface.output(Output::like("y", PortType::UNKNOWN.of(dimension).shaped(shape))))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| {
            let factors = match l.inputs() {
                1 => l.input(0).to_vec(),
                n => (0..n).map(|port| l.element(port, i)).collect(),
            };
            factors.into_iter().reduce(|product, u| product * u).unwrap_or_else(|| l.constant(1.0))
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
    fn inputs_are_multiplied_element_by_element() {
        let inputs = vec![("u1".to_owned(), PortType::vector(2)), ("u2".to_owned(), PortType::scalar())];
        let mut bench = Bench::with_inputs(Product { inputs: 2 }, inputs);
        assert_eq!(bench.set(0, &[2.0, 3.0]).set(1, &[-4.0]).major(), [-8.0, -12.0]);
        assert!(bench.set(1, &[f64::NAN]).major()[0].is_nan());
    }

    #[test]
    fn one_input_gives_the_product_of_its_elements() {
        let inputs = vec![("u".to_owned(), PortType::vector(3))];
        assert_eq!(
            Bench::with_inputs(Product { inputs: 1 }, inputs).set(0, &[2.0, 3.0, 4.0]).major(),
            [24.0]
        );
    }

    #[test]
    fn units_are_multiplied_and_stay_unknown_where_one_is() {
        let unit =
            |given: &Given| Product { inputs: 2 }.interface(given).unwrap().outputs[0].port_type.dimension;
        assert_eq!(unit(&given(&[("u1", "V"), ("u2", "A")], &[])), Some(dimension("W")));
        assert_eq!(unit(&given(&[("u1", "V")], &[])), None);
    }

    #[test]
    fn vectors_of_different_length_do_not_fit() {
        let inputs = vec![("u1".to_owned(), PortType::vector(2)), ("u2".to_owned(), PortType::vector(3))];
        let error = Product { inputs: 2 }.interface(&Given::new(inputs, Default::default())).unwrap_err();
        assert_eq!(error.code, "type_mismatch");
    }

    #[test]
    fn no_input_is_refused() {
        assert_eq!(Product { inputs: 0 }.check().unwrap_err().param, "inputs");
    }
}
