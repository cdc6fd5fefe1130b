use blocksim_block::prelude::*;

use super::transforms;

/// Clarke transform: three phases to two axes at right angles. Amplitudes stay what they are.
///
/// $$ \alpha = \frac{2a - b - c}{3}, \qquad \beta = \frac{b - c}{\sqrt3}, \qquad u_0 = \frac{a + b + c}{3} $$
///
/// The axis alpha is that of phase a, beta lies 90 degrees ahead. A balanced system becomes a vector whose length
/// is its amplitude, so power is $3 (v_\alpha i_\alpha + v_\beta i_\beta)/2 + 3 v_0 i_0$.
///
/// ```ron
/// Clarke
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("abc→αβ"))]
pub struct Clarke;

impl Block for Clarke {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let unit = given.input_or_unknown("abc").dimension;
        Ok(Interface::new()
            .input(Input::real("abc").shape(Shape::Vector(3)).doc("phases a, b, c"))
            .output(Output::like("alpha_beta", PortType::vector(2).of(unit)).doc("axes alpha, beta"))
            .output(Output::like("zero", PortType::scalar().of(unit)).doc("mean of the phases")))
    }

    fn law(&self, l: &Recording) -> bool {
        let ([alpha, beta], zero) = transforms::clarke([0, 1, 2].map(|i| l.input(0)[i]));
        l.set(0, 0, alpha);
        l.set(0, 1, beta);
        l.set(1, 0, zero);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;

    #[test]
    fn phase_a_alone_is_two_thirds_of_alpha_and_a_third_of_zero() {
        let volts = PortType::vector(3).of(Some(dimension("V")));
        let mut bench = Bench::with_inputs(Clarke, vec![("abc".to_owned(), volts)]);
        let y = bench.set(0, &[3.0, 0.0, 0.0]).major();
        assert_eq!(y, [2.0, 0.0, 1.0]);
        assert!(bench.interface.outputs.iter().all(|y| y.port_type.dimension == Some(dimension("V"))));
    }
}
