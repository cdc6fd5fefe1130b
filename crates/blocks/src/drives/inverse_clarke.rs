use blocksim_block::prelude::*;

use super::transforms;

/// Inverse Clarke transform: two axes at right angles to three phases. Amplitudes stay what they are.
///
/// $$ a = u_0 + \alpha, \qquad b = u_0 + \frac{-\alpha + \sqrt3 \beta}{2}, \qquad
///    c = u_0 + \frac{-\alpha - \sqrt3 \beta}{2} $$
///
/// The input `zero`, $u_0$, need not be connected; then the phases sum to 0.
///
/// ```ron
/// InverseClarke
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("αβ→abc"))]
pub struct InverseClarke;

impl Block for InverseClarke {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let unit = given.common_dimension(&["alpha_beta", "zero"])?;
        Ok(Interface::new()
            .input(Input::real("alpha_beta").shape(Shape::Vector(2)).doc("axes alpha, beta"))
            .input(Input::real("zero").scalar().default(0.0).doc("mean of the phases"))
            .output(Output::like("abc", PortType::vector(3).of(unit)).doc("phases a, b, c")))
    }

    fn law(&self, l: &Recording) -> bool {
        let phases = transforms::inverse_clarke([0, 1].map(|i| l.input(0)[i]), l.u(1));
        l.each(0, |i| phases[i]);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::given;
    use blocksim_block::testing::Bench;

    #[test]
    fn alpha_is_phase_a_and_zero_is_in_all() {
        let inputs =
            vec![("alpha_beta".to_owned(), PortType::vector(2)), ("zero".to_owned(), PortType::scalar())];
        let mut bench = Bench::with_inputs(InverseClarke, inputs);
        assert_eq!(bench.set(0, &[2.0, 0.0]).major(), [2.0, -1.0, -1.0]);
        assert_eq!(bench.set(1, &[1.0]).major(), [3.0, 0.0, 0.0]);
    }

    #[test]
    fn both_inputs_are_of_one_unit() {
        let error = InverseClarke.interface(&given(&[("alpha_beta", "V"), ("zero", "A")], &[])).unwrap_err();
        assert_eq!(error.code, "unit_mismatch");
    }
}
