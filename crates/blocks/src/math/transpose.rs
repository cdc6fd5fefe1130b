use super::matrix::transposed;
use blocksim_block::prelude::*;

/// Exchanges rows and columns: $y = u^\top$.
///
/// A vector is a column and becomes a matrix of one row; a matrix of one row becomes a vector. The unit stays.
///
/// The torques of the joints that balance a force at the tool, $\tau = J^\top F$, are a `Jacobian`, a `Transpose` and a
/// `Product(multiplication: Matrix)`.
///
/// ```ron
/// Transpose
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("uᵀ"))]
pub struct Transpose;

impl Block for Transpose {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let mut input = Input::any("u");
        input.shape = given.input("u").map(|u| u.shape);
        Ok(Interface::new().input(input).output(Output::like("y", u.shaped(transposed(u.shape)))))
    }

    fn law(&self, l: &Recording) -> bool {
        let (rows, columns) = match l.shape(0) {
            Shape::Matrix(rows, columns) => (rows, columns),
            shape => (shape.len(), 1),
        };
        l.each(0, |i| l.input(0)[(i % rows) * columns + i / rows]);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn rows_become_columns() {
        let u = PortType::scalar().shaped(Shape::Matrix(2, 3));
        let mut bench = Bench::with_inputs(Transpose, vec![("u".to_owned(), u)]);
        assert_eq!(bench.interface.outputs[0].port_type.shape, Shape::Matrix(3, 2));
        bench.set(0, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(bench.major(), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
    }

    #[test]
    fn a_vector_becomes_a_row_and_a_row_a_vector() {
        for (shape, expected) in
            [(Shape::Vector(3), Shape::Matrix(1, 3)), (Shape::Matrix(1, 3), Shape::Vector(3))]
        {
            let u = PortType::scalar().shaped(shape);
            let mut bench = Bench::with_inputs(Transpose, vec![("u".to_owned(), u)]);
            assert_eq!(bench.interface.outputs[0].port_type.shape, expected);
            assert_eq!(bench.set(0, &[1.0, 2.0, 3.0]).major(), [1.0, 2.0, 3.0]);
        }
    }
}
