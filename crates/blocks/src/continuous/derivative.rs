use blocksim_block::prelude::*;

use super::units::{SECOND, agrees};

/// Derivative of a signal, filtered so that it exists.
///
/// $$ \dot x = n (u - x), \qquad y = n (u - x), \qquad G(s) = \frac{s}{1 + s / n} $$
///
/// Up to frequencies of about $n$ the output is the derivative; above, it is $n u$, so noise and jumps are
/// amplified by no more than $n$. A pure derivative depends on the steps of the solver and is not offered. The
/// unit of the output is that of the input over s. Direct feedthrough.
///
/// ```ron
/// Derivative(n: 200.0, x0: "0.5 m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Fraction("s","1 + s τ"))]
pub struct Derivative {
    /// Where the filter cuts off, positive.
    #[block(unit = "1/s", positive, default = 100.0)]
    pub n: f64,
    /// Input before the start; equal to the input at the start, the output starts at zero.
    #[block(finite, default = 0.0)]
    pub x0: f64,
}

impl Block for Derivative {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        agrees(given, "x0", "u", u.dimension)?;
        let y = u.of(u.dimension.map(|dimension| dimension.over(SECOND)));
        let mut interface = Interface::new().input(Input::real("u")).output(Output::like("y", y));
        for _ in 0..u.shape.len() {
            interface = interface.state("x", self.x0);
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        for (i, x) in l.x().iter().enumerate() {
            let rate = self.n * (l.element(0, i) - *x);
            l.set(0, i, rate);
            l.derive(i, rate);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::units::testing::{interface_with, output_unit, vector};
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn a_step_response_decays_from_n() {
        for n in [1.0, 100.0] {
            let mut bench = Bench::new(Derivative { n, x0: 0.0 });
            assert_eq!(bench.respond(1.0), n);
            bench.integrate(1.0 / n, 1000);
            let (y, expected) = (bench.minor()[0], n * (-1.0_f64).exp());
            assert!((y - expected).abs() < 1e-12 * n, "n = {n}: {y} != {expected}");
        }
    }

    #[test]
    fn a_ramp_gives_its_slope() {
        // y = 3 (1 - exp(-n t)); a ramp is followed with constant input by shifting the state of the filter.
        let mut bench = Bench::new(Derivative { n: 50.0, x0: 0.0 });
        let (h, steps) = (1e-4, 10_000);
        for step in 0..steps {
            bench.set(0, &[3.0 * (f64::from(step) + 0.5) * h]).integrate(h, 1);
        }
        bench.set(0, &[3.0 * f64::from(steps) * h]);
        // A ramp held at the middle of each step is second order: 3 (n h)^2 / 24.
        assert!((bench.minor()[0] - 3.0).abs() < 1e-5);
    }

    #[test]
    fn the_initial_input_spares_the_peak_at_the_start() {
        let mut bench = Bench::with_inputs(Derivative { n: 100.0, x0: 2.0 }, vector("u", 2));
        assert_eq!(bench.set(0, &[2.0, 3.0]).major(), [0.0, 100.0]);
    }

    #[test]
    fn the_unit_is_that_of_the_input_over_seconds() {
        let block = Derivative { n: 1.0, x0: 0.0 };
        assert_eq!(output_unit(&block, &[("u", "rad")], &[]), "rad/s");
        assert!(interface_with(&block, &[("u", "rad")], &[("x0", "V")]).is_err());
        assert_eq!(output_unit(&block, &[], &[]), "unknown");
    }

    #[test]
    fn a_filter_that_never_passes_is_refused() {
        assert_eq!(Derivative { n: 0.0, x0: 0.0 }.errors()[0].param, "n");
    }
}
