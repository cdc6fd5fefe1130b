use blocksim_block::prelude::*;

use super::transforms;

/// Park transform: from axes at rest to axes that turn.
///
/// $$ d = \alpha \cos\theta + \beta \sin\theta, \qquad q = \beta \cos\theta - \alpha \sin\theta $$
///
/// $\theta$ is the angle of the d axis against the axis alpha; q lies 90 degrees ahead of d. Currents and voltages that
/// turn with the frame stand still in it, so that a PI controller leaves no error.
///
/// ```ron
/// Park
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Text("αβ→dq"))]
pub struct Park;

impl Block for Park {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let unit = given.input_or_unknown("alpha_beta").dimension;
        Ok(Interface::new()
            .input(Input::real("alpha_beta").shape(Shape::Vector(2)).doc("axes at rest: alpha, beta"))
            .input(Input::real("theta").scalar().unit("rad").doc("angle of the d axis against alpha"))
            .turning_input(1)
            .output(Output::like("dq", PortType::vector(2).of(unit)).doc("axes that turn: d, q")))
    }

    fn law(&self, l: &Recording) -> bool {
        let theta = l.u(1);
        let dq = transforms::park([0, 1].map(|i| l.input(0)[i]), (theta.sin(), theta.cos()));
        l.each(0, |i| dq[i]);
        true
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn a_quarter_turn_makes_beta_to_d_and_alpha_to_minus_q() {
        let inputs =
            vec![("alpha_beta".to_owned(), PortType::vector(2)), ("theta".to_owned(), PortType::scalar())];
        let mut bench = Bench::with_inputs(Park, inputs);
        assert_eq!(bench.set(0, &[3.0, 4.0]).major(), [3.0, 4.0]);
        let y = bench.set(1, &[FRAC_PI_2]).major();
        assert!((y[0] - 4.0).abs() < 1e-15 && (y[1] + 3.0).abs() < 1e-15, "{y:?}");
    }
}
