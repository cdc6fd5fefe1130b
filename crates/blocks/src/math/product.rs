use super::elements::{borrowed, input_names};
use super::matrix::{product, product_shape};
use blocksim_block::prelude::*;

/// Multiplies: $y = u_1 u_2 \dots$, element by element, or as matrices.
///
/// The unit of the output is the product of the units; a scalar multiplies each element of a vector. With one input
/// the elements of `u` are multiplied.
///
/// With `multiplication: Matrix` the inputs are multiplied as matrices, from left to right. A vector is a column; `Transpose`
/// makes a row of it. A product of one row and one column is a scalar.
///
/// ```ron
/// Product(inputs: 2)
/// ```
/// ```ron
/// Product(multiplication: Matrix)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("×"))]
pub struct Product {
    /// Number of inputs.
    #[block(at_least = 1, at_most = MOST_PORTS, default = 2)]
    pub inputs: usize,
    /// `ElementWise` or `Matrix`.
    #[block(default = Multiplication::ElementWise)]
    pub multiplication: Multiplication,
}

/// How signals are multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Multiplication {
    /// Element by element.
    ElementWise,
    /// As matrices.
    Matrix,
}

impl Product {
    /// Multiplies so many inputs element by element.
    pub fn elements(inputs: usize) -> Self {
        Self { inputs, multiplication: Multiplication::ElementWise }
    }

    /// Inputs and the shape of their product as matrices.
    fn of_matrices(&self, given: &Given, names: &[&str]) -> Result<(Vec<Input>, Shape), InterfaceError> {
        let known = |name: &str| given.input(name).map(|input| input.shape);
        let inputs = names.iter().map(|name| Input { shape: known(name), ..Input::real(*name) }).collect();
        let mut all = known(names[0]).map(|shape| (names[0].to_owned(), shape));
        for name in &names[1..] {
            // What is not known yet fits.
            let (Some((text, left)), Some(right)) = (&all, known(name)) else {
                return Ok((inputs, Shape::Scalar));
            };
            let shape = product_shape((text, *left), (name, right))?;
            all = Some((format!("{text} {name}"), shape));
        }
        Ok((inputs, all.map_or(Shape::Scalar, |(_, shape)| shape)))
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.multiplication == Multiplication::Matrix && self.inputs == 1 {
            errors.add(ParamError::new("inputs", "a product of matrices needs at least 2 inputs"));
        }
    }
}

impl Block for Product {
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
                let product = names.iter().try_fold(Dimension::NONE, |all, name| {
                    Some(all.times(given.input_or_unknown(name).dimension?))
                });
                let shape = match self.multiplication {
                    Multiplication::ElementWise => given.common_shape(&names, &[])?,
                    Multiplication::Matrix => Shape::Scalar,
                };
                (shape, product)
            }
        };
        let (inputs, shape) = match self.multiplication {
            Multiplication::ElementWise => (names.iter().map(|name| Input::real(*name)).collect(), shape),
            Multiplication::Matrix => self.of_matrices(given, &names)?,
        };
        let interface = inputs.into_iter().fold(Interface::new(), Interface::input);
        Ok(interface.output(Output::like("y", PortType::UNKNOWN.of(dimension).shaped(shape))))
    }

    fn law(&self, l: &Recording) -> bool {
        if self.multiplication == Multiplication::Matrix {
            let factors = (0..l.inputs()).map(|port| (l.shape(port), l.input(port).to_vec()));
            let all = factors.reduce(|(a_shape, a), (b_shape, b)| {
                let shape = product_shape(("u1", a_shape), ("u2", b_shape)).unwrap_or(Shape::Scalar);
                (shape, product((a_shape, &a), (b_shape, &b), |a, b| a * b))
            });
            all.iter().for_each(|(_, y)| l.each(0, |i| y[i]));
            return true;
        }
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
        let mut bench = Bench::with_inputs(Product::elements(2), inputs);
        assert_eq!(bench.set(0, &[2.0, 3.0]).set(1, &[-4.0]).major(), [-8.0, -12.0]);
        assert!(bench.set(1, &[f64::NAN]).major()[0].is_nan());
    }

    #[test]
    fn one_input_gives_the_product_of_its_elements() {
        let inputs = vec![("u".to_owned(), PortType::vector(3))];
        assert_eq!(Bench::with_inputs(Product::elements(1), inputs).set(0, &[2.0, 3.0, 4.0]).major(), [24.0]);
    }

    #[test]
    fn units_are_multiplied_and_stay_unknown_where_one_is() {
        let unit =
            |given: &Given| Product::elements(2).interface(given).unwrap().outputs[0].port_type.dimension;
        assert_eq!(unit(&given(&[("u1", "V"), ("u2", "A")], &[])), Some(dimension("W")));
        assert_eq!(unit(&given(&[("u1", "V")], &[])), None);
    }

    #[test]
    fn vectors_of_different_length_do_not_fit() {
        let inputs = vec![("u1".to_owned(), PortType::vector(2)), ("u2".to_owned(), PortType::vector(3))];
        let error = Product::elements(2).interface(&Given::new(inputs, Default::default())).unwrap_err();
        assert_eq!(error.code, "type_mismatch");
    }

    #[test]
    fn no_input_is_refused() {
        assert_eq!(Product::elements(0).errors()[0].param, "inputs");
    }
    #[test]
    fn matrices_are_multiplied_from_left_to_right() {
        let typed = |name: &str, shape| (name.to_owned(), PortType::scalar().shaped(shape));
        let inputs = vec![
            typed("u1", Shape::Matrix(1, 2)),
            typed("u2", Shape::Matrix(2, 3)),
            typed("u3", Shape::Vector(3)),
        ];
        let block = Product { inputs: 3, multiplication: Multiplication::Matrix };
        let mut bench = Bench::with_inputs(block.clone(), inputs.clone());
        assert_eq!(bench.interface.outputs[0].port_type.shape, Shape::Scalar);
        bench.set(0, &[1.0, 10.0]).set(1, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).set(2, &[1.0, 1.0, 2.0]);
        // (1 10) (9 21)'.
        assert_eq!(bench.major(), [219.0]);
        let wrong = vec![inputs[1].clone(), inputs[0].clone(), inputs[2].clone()];
        let wrong: Vec<_> =
            ["u1", "u2", "u3"].iter().zip(wrong).map(|(n, (_, t))| (n.to_string(), t)).collect();
        let error = block.interface(&Given::new(wrong, Default::default())).unwrap_err();
        assert!(error.message.contains("3 columns, the second 1 row"), "{}", error.message);
    }
}
