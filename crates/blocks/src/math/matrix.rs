//! Products of matrices. Vectors are columns; a scalar multiplies everything.

use blocksim_block::InterfaceError;
use blocksim_block::law::Value;
use blocksim_signal::Shape;

/// Rows and columns; nothing for a scalar.
fn size(shape: Shape) -> Option<(usize, usize)> {
    match shape {
        Shape::Scalar => None,
        Shape::Vector(n) => Some((n, 1)),
        Shape::Matrix(rows, columns) => Some((rows, columns)),
    }
}

/// The simplest shape of this size.
fn shape(rows: usize, columns: usize) -> Shape {
    match (rows, columns) {
        (1, 1) => Shape::Scalar,
        (n, 1) => Shape::Vector(n),
        (rows, columns) => Shape::Matrix(rows, columns),
    }
}

/// The shape of the transposed.
pub(crate) fn transposed(of: Shape) -> Shape {
    size(of).map_or(Shape::Scalar, |(rows, columns)| shape(columns, rows))
}

/// The shape of a product of what these names stand for.
///
/// # Errors
/// The columns of the first are not as many as the rows of the second.
pub(crate) fn product_shape(a: (&str, Shape), b: (&str, Shape)) -> Result<Shape, InterfaceError> {
    match (size(a.1), size(b.1)) {
        (None, _) => Ok(b.1),
        (_, None) => Ok(a.1),
        (Some((m, k)), Some((rows, n))) if k == rows => Ok(shape(m, n)),
        (Some((_, k)), Some((rows, _))) => {
            let ports: Vec<&str> = [b.0, a.0].into_iter().filter(|name| name.starts_with('u')).collect();
            let message = format!(
                "`{}` is a {} and `{}` a {}: the first has {k} {}, the second {rows} {}",
                a.0,
                a.1,
                b.0,
                b.1,
                if k == 1 { "column" } else { "columns" },
                if rows == 1 { "row" } else { "rows" },
            );
            Err(InterfaceError::types(&ports, message)
                .help("exchange the factors, or put a Transpose before one; a vector is a column"))
        }
    }
}

/// The product of matrices whose shapes fit, row by row: each element is the sum from the left. What `times` makes of two
/// numbers is their product.
pub(crate) fn product<'r, A: Copy, B: Copy>(
    (a_shape, a): (Shape, &[A]),
    (b_shape, b): (Shape, &[B]),
    times: impl Fn(A, B) -> Value<'r>,
) -> Vec<Value<'r>> {
    match (size(a_shape), size(b_shape)) {
        (Some((m, k)), Some((_, n))) => (0..m * n)
            .map(|place| {
                let (i, j) = (place / n, place % n);
                (1..k).fold(times(a[i * k], b[j]), |sum, l| sum + times(a[i * k + l], b[l * n + j]))
            })
            .collect(),
        (None, _) => b.iter().map(|b| times(a[0], *b)).collect(),
        (_, None) => a.iter().map(|a| times(*a, b[0])).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_products_are_those_of_linear_algebra() {
        let (s, v) = (Shape::Scalar, Shape::Vector);
        let m = Shape::Matrix;
        for (a, b, expected) in [
            (m(2, 3), v(3), v(2)),
            (m(1, 3), v(3), s),
            (v(3), m(1, 2), m(3, 2)),
            (m(2, 3), m(3, 4), m(2, 4)),
            (s, m(2, 3), m(2, 3)),
            (v(3), s, v(3)),
        ] {
            assert_eq!(product_shape(("u1", a), ("u2", b)), Ok(expected));
        }
        let error = product_shape(("u1", v(3)), ("u2", v(3))).unwrap_err();
        assert_eq!(
            error.message,
            "`u1` is a vector of 3 and `u2` a vector of 3: the first has 1 column, the second 3 rows"
        );
        assert_eq!(transposed(v(3)), m(1, 3));
        assert_eq!(transposed(m(1, 3)), v(3));
    }
}
