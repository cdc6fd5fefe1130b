use blocksim_block::prelude::*;

use super::transforms;

/// Inverse Park transform: from axes that turn to axes at rest.
///
/// $$ \alpha = d \cos\theta - q \sin\theta, \qquad \beta = d \sin\theta + q \cos\theta $$
///
/// $\theta$ is the angle of the d axis against the axis alpha; q lies 90 degrees ahead of d.
///
/// ```ron
/// InversePark
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("dq→αβ"))]
pub struct InversePark;

impl Block for InversePark {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let unit = given.input_or_unknown("dq").dimension;
        Ok(Interface::new()
            .input(Input::real("dq").shape(Shape::Vector(2)).doc("axes that turn: d, q"))
            .input(Input::real("theta").scalar().unit("rad").doc("angle of the d axis against alpha"))
            .turning_input(1)
            .output(
                Output::like("alpha_beta", PortType::vector(2).of(unit)).doc("axes at rest: alpha, beta"),
            ))
    }

    fn law(&self, l: &Recording) -> bool {
        let theta = l.u(1);
        let axes = transforms::park([0, 1].map(|i| l.input(0)[i]), (-theta.sin(), theta.cos()));
        l.each(0, |i| axes[i]);
        true
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn a_quarter_turn_makes_d_to_beta_and_q_to_minus_alpha() {
        let inputs = vec![("dq".to_owned(), PortType::vector(2)), ("theta".to_owned(), PortType::scalar())];
        let mut bench = Bench::with_inputs(InversePark, inputs);
        let y = bench.set(0, &[3.0, 4.0]).set(1, &[FRAC_PI_2]).major();
        assert!((y[0] + 4.0).abs() < 1e-15 && (y[1] - 3.0).abs() < 1e-15, "{y:?}");
    }
}
