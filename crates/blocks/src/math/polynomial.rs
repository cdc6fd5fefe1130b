use blocksim_block::prelude::*;

/// A polynomial of a signal: $y = a_n u^n + \dots + a_1 u + a_0$; element by element.
///
/// It is computed by Horner's rule. Input and output have no unit: make a number of a quantity with `Gain(k: "1 1/V")` and the like.
///
/// ```ron
/// Polynomial(coefficients: [0.5, 0, -2, 1])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Math", symbol = Text("P(u)"))]
pub struct Polynomial {
    /// Coefficients $a_n, \dots, a_1, a_0$, highest power first.
    #[block(finite, not_empty, empty = "write them from the highest power on: `[2, 0, 1]` is 2 u^2 + 1")]
    pub coefficients: Vec<f64>,
}

impl Block for Polynomial {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        Ok(Interface::new()
            .input(Input::real("u").dimension(Some(Dimension::NONE)))
            .output(Output::real("y").shape(u.shape)))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| {
            let u = l.element(0, i);
            let first = l.constant(self.coefficients[0]);
            self.coefficients[1..].iter().fold(first, |sum, a| sum * u + *a)
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn the_roots_are_where_the_factors_have_them() {
        // 2 (u - 1) (u + 3) (u - 0.5)
        let polynomial = Polynomial { coefficients: vec![2.0, 3.0, -8.0, 3.0] };
        let inputs = vec![("u".to_owned(), PortType::vector(4))];
        let mut bench = Bench::with_inputs(polynomial, inputs);
        assert_eq!(bench.set(0, &[1.0, -3.0, 0.5, 2.0]).minor(), [0.0, 0.0, 0.0, 15.0]);
        assert_eq!(Bench::new(Polynomial { coefficients: vec![7.0] }).respond(1e9), 7.0);
    }

    #[test]
    fn coefficients_must_be_there_and_finite() {
        for (coefficients, param) in [(vec![], "coefficients"), (vec![1.0, f64::INFINITY], "coefficients[1]")]
        {
            assert_eq!(Polynomial { coefficients }.errors()[0].param, param);
        }
    }
}
