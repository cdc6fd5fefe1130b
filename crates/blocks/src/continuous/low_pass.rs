use blocksim_block::prelude::*;

use crate::math::Entries;

/// First-order low-pass filter (PT1).
///
/// $$ \dot x = \frac{u - x}{\tau}, \qquad y = x, \qquad G(s) = \frac{1}{1 + \tau s} $$
///
/// No direct feedthrough, so it breaks an algebraic loop. After a unit step the output has reached
/// $1 - e^{-1} \approx 63\,\%$ at $t = \tau$. Vectors are filtered element by element.
///
/// ```ron
/// LowPass(tau: "50 ms")
/// ```
///
/// Source: as `Modelica.Blocks.Continuous.FirstOrder` with k = 1.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Fraction("1","1 + s τ"))]
pub struct LowPass {
    /// Time constant, positive.
    #[block(unit = "s", positive)]
    pub tau: f64,
    /// Output at the start, in the unit of the input. A list gives each element its own.
    #[block(finite, default = 0.0.into())]
    pub y0: Entries,
}

impl Block for LowPass {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let shape = given.common_shape(&["u"], &[self.y0.shape])?;
        let y = Output::like("y", u.shaped(shape));
        let mut interface = Interface::new().input(Input::real("u")).output(y);
        for i in 0..shape.len() {
            interface = interface.state_in("x", self.y0.at(i), u.dimension);
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        for i in 0..l.width(0) {
            let (u, x) = (l.element(0, i), l.x()[i]);
            l.set(0, i, x);
            l.derive(i, (u - x) / self.tau);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn a_step_response_matches_the_closed_form() {
        for tau in [0.1, 1.0, 10.0] {
            let mut bench = Bench::new(LowPass { tau, y0: 0.0.into() });
            bench.set(0, &[1.0]).integrate(tau, 1000);
            let (y, expected) = (bench.minor()[0], 1.0 - (-1.0_f64).exp());
            assert!((y - expected).abs() < 1e-12, "tau = {tau}: {y} != {expected}");
        }
    }

    #[test]
    fn a_time_constant_of_zero_is_refused() {
        assert_eq!(LowPass { tau: 0.0, y0: 0.0.into() }.errors()[0].param, "tau");
    }
}
