use super::entries::Entries;
use super::matrix::{product, product_shape};
use blocksim_block::prelude::*;

/// Multiplies by a constant: $y = k u$, element by element, or as matrices.
///
/// `k` is a number, a vector, or a matrix as a list of rows. Element by element a scalar stands for every element, and other
/// shapes must be equal. With `multiplication: KTimesU` the output is the matrix product $K u$, with `UTimesK` it is $u K$;
/// vectors are columns.
///
/// The unit of the output is that of the input times that of `k`: with `k: "48 V"` a signal without unit becomes
/// a voltage. All numbers of a matrix have one unit.
///
/// ```ron
/// Gain(k: "48 V")
/// ```
/// ```ron
/// Gain(k: [[0.5, 0.5], [1.0, -1.0]], multiplication: KTimesU)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Gain("k"))]
pub struct Gain {
    /// Factor: a number, a list, or a list of rows.
    #[block(difference, finite)]
    pub k: Entries,
    /// `ElementWise`, or a product of matrices: `KTimesU`, `UTimesK`.
    #[block(default = Factors::ElementWise)]
    pub multiplication: Factors,
}

/// How a factor and a signal are multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Factors {
    /// Element by element.
    ElementWise,
    /// The matrix product with the factor in front.
    KTimesU,
    /// The matrix product with the factor behind.
    UTimesK,
}

impl Gain {
    /// Multiplies by a number.
    pub fn new(k: f64) -> Self {
        Self { k: k.into(), multiplication: Factors::ElementWise }
    }
}

impl Block for Gain {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let factor = self.k.dimension_or(given.parameters.get("k"));
        let dimension = u.dimension.map(|dimension| dimension.times(factor));
        let mut input = Input::real("u");
        let shape = match self.multiplication {
            Factors::ElementWise => given.common_shape(&["u"], &[self.k.shape])?,
            // What is not known yet fits.
            _ if given.input("u").is_none() => self.k.shape,
            Factors::KTimesU => product_shape(("k", self.k.shape), ("u", u.shape))?,
            Factors::UTimesK => product_shape(("u", u.shape), ("k", self.k.shape))?,
        };
        if self.multiplication != Factors::ElementWise {
            input.shape = given.input("u").map(|u| u.shape);
        }
        Ok(Interface::new().input(input).output(Output::like("y", u.of(dimension).shaped(shape))))
    }

    fn law(&self, l: &Recording) -> bool {
        let k = (self.k.shape, &self.k.values[..]);
        let u = (l.shape(0), l.input(0));
        let y = match self.multiplication {
            Factors::ElementWise => {
                l.each(0, |i| self.k.at(i) * l.element(0, i));
                return true;
            }
            Factors::KTimesU => product(k, u, |k, u| k * u),
            Factors::UTimesK => product(u, k, |u, k| k * u),
        };
        l.each(0, |i| y[i]);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::entries::{matrix, vector};
    use super::*;
    use blocksim_block::testing::Bench;

    fn input(shape: Shape) -> Vec<(String, PortType)> {
        vec![("u".to_owned(), PortType::scalar().shaped(shape))]
    }

    #[test]
    fn the_output_is_the_input_times_k() {
        for (k, u) in [(2.0, 3.0), (-0.5, 4.0), (0.0, 1e300)] {
            assert_eq!(Bench::new(Gain::new(k)).respond(u), k * u);
        }
    }

    #[test]
    fn a_vector_multiplies_element_by_element_and_makes_a_vector_of_a_scalar() {
        let gain = Gain { k: vector(&[2.0, -3.0]), ..Gain::new(0.0) };
        let mut bench = Bench::with_inputs(gain.clone(), input(Shape::Vector(2)));
        assert_eq!(bench.set(0, &[5.0, 7.0]).major(), [10.0, -21.0]);
        let mut bench = Bench::with_inputs(gain.clone(), input(Shape::Scalar));
        assert_eq!(bench.set(0, &[5.0]).major(), [10.0, -15.0]);
        let three = Given::new(input(Shape::Vector(3)), Default::default());
        assert_eq!(gain.interface(&three).unwrap_err().code, "type_mismatch");
    }

    #[test]
    fn products_of_matrices_are_those_by_hand() {
        let k = matrix(&[&[1.0, 2.0], &[3.0, 4.0], &[5.0, 6.0]]);
        let front = Gain { k: k.clone(), multiplication: Factors::KTimesU };
        let mut bench = Bench::with_inputs(front.clone(), input(Shape::Vector(2)));
        assert_eq!(bench.set(0, &[10.0, 1.0]).major(), [12.0, 34.0, 56.0]);
        let mut bench = Bench::with_inputs(front, input(Shape::Matrix(2, 2)));
        assert_eq!(bench.set(0, &[1.0, 0.0, 1.0, -1.0]).major(), [3.0, -2.0, 7.0, -4.0, 11.0, -6.0]);
        let behind = Gain { k, multiplication: Factors::UTimesK };
        let mut bench = Bench::with_inputs(behind.clone(), input(Shape::Matrix(1, 3)));
        assert_eq!(bench.interface.outputs[0].port_type.shape, Shape::Matrix(1, 2));
        assert_eq!(bench.set(0, &[1.0, 10.0, 100.0]).major(), [531.0, 642.0]);
        let column = Given::new(input(Shape::Vector(3)), Default::default());
        assert_eq!(
            behind.interface(&column).unwrap_err().message,
            "`u` is a vector of 3 and `k` a 3x2 matrix: the first has 1 column, the second 3 rows"
        );
    }
}
