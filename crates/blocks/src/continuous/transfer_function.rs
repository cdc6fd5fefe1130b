use blocksim_block::prelude::*;

use super::rational::Rational;

/// Transfer function of one input and one output, as polynomials in s.
///
/// $$ G(s) = k\,\frac{b_m s^m + \dots + b_0}{a_n s^n + \dots + a_0}, \qquad m \le n $$
///
/// Coefficients are given in descending powers: `den: [1.0, 2.0, 5.0]` is $s^2 + 2 s + 5$. All states are zero
/// at the start. The input reaches the output at once only if both have the same degree. Vectors are filtered
/// element by element. The unit of the output is that of the input times that of `k`; without `k` it
/// is unknown (write `k: "1"` where the output has the unit of the input).
///
/// ```ron
/// TransferFunction(num: [25.0], den: [1.0, 3.0, 25.0], k: "1 rad/V")
/// ```
///
/// States are those of the controllable canonical form in a time that the fastest pole sets, so that they are as large as
/// the signals: with a power of two $p$ near its magnitude, state $i$ is $p^i$ times the canonical one. Where coefficients change during a
/// run, the canonical states are kept.
///
/// Source: controllable canonical form, T. Kailath, Linear Systems, 1980, chapter 2.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Polynomials("s"))]
pub struct TransferFunction {
    /// Numerator, in descending powers of s.
    #[block(
        difference,
        not_empty, finite, default = vec![1.0],
        empty = "give at least one coefficient, in descending powers: [1.0]",
    )]
    pub num: Vec<f64>,
    /// Denominator, in descending powers of s.
    #[block(not_empty, finite, empty = "give at least one coefficient, in descending powers: [1.0]")]
    pub den: Vec<f64>,
    /// Factor; its unit is the unit of the output over that of the input.
    #[block(difference, finite, default = 1.0)]
    pub k: f64,
}

impl TransferFunction {
    fn ratio(&self) -> Rational<'_> {
        Rational::new(&self.num, &self.den)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        Rational::validate(&self.num, &self.den, 's', errors);
    }
}

impl Block for TransferFunction {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let ratio = self.ratio();
        let (n, pace) = (ratio.order(), ratio.pace());
        let mut interface = ratio.interface(given, 0.0);
        for (i, state) in interface.states.iter_mut().enumerate() {
            state.scale = pace.powi((i % n + 1) as i32);
        }
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        let ratio = self.ratio();
        let (n, pace) = (ratio.order(), ratio.pace());
        for i in 0..l.width(0) {
            let (u, x) = (l.element(0, i), &l.x()[i * n..][..n]);
            l.set(0, i, self.k * ratio.output(l, x, u, pace));
            for k in 0..n {
                let drive = if k == 0 { ratio.drive(x, u, pace) } else { x[k - 1] };
                l.derive(i * n + k, pace * drive);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::units::testing::{output_unit, vector};
    use super::*;
    use blocksim_block::testing::Bench;

    fn block(num: &[f64], den: &[f64]) -> TransferFunction {
        TransferFunction { num: num.to_vec(), den: den.to_vec(), k: 1.0 }
    }

    #[test]
    fn a_second_order_step_response_matches_the_closed_form() {
        // 25 / (s^2 + 6 s + 25): damping 0.6, decay 3, ringing at 4 rad/s.
        let mut bench = Bench::new(block(&[50.0], &[2.0, 12.0, 50.0]));
        for t in [0.25_f64, 0.5, 0.75, 1.0] {
            bench.set(0, &[1.0]).integrate(0.25, 500);
            let expected = 1.0 - (-3.0 * t).exp() * ((4.0 * t).cos() + 0.75 * (4.0 * t).sin());
            // Runge-Kutta 4 at h = 0.5 ms: far below 1e-11.
            assert!((bench.minor()[0] - expected).abs() < 1e-11, "t = {t}");
        }
    }

    #[test]
    fn zeros_and_feedthrough_match_the_closed_form() {
        // (2 s + 1) / (s + 3): y = 1/3 + 5/3 exp(-3 t).
        let mut bench = Bench::new(block(&[2.0, 1.0], &[1.0, 3.0]));
        assert_eq!(bench.respond(1.0), 2.0);
        bench.integrate(0.5, 500);
        assert!((bench.minor()[0] - (1.0 + 5.0 * (-1.5_f64).exp()) / 3.0).abs() < 1e-11);
        // s / (s + 3) of a vector: the zero in front of the numerator is harmless.
        let mut bench = Bench::with_inputs(block(&[0.0, 1.0, 0.0], &[1.0, 3.0]), vector("u", 2));
        assert_eq!(bench.set(0, &[1.0, -4.0]).major(), [1.0, -4.0]);
        bench.integrate(1.0, 1000);
        let y = bench.minor();
        assert!((y[0] - (-3.0_f64).exp()).abs() < 1e-11 && (y[1] + 4.0 * (-3.0_f64).exp()).abs() < 1e-11);
    }

    #[test]
    fn states_are_as_large_as_the_signals_whatever_the_time_scale() {
        // 1 / (1 + 2 d s / w + s^2 / w^2) at rest, for w = 1e4 and 1e-4 rad/s: both states are below 2.
        for w in [1e4, 1e-4] {
            let mut bench = Bench::new(block(&[w * w], &[1.0, 0.02 * w, w * w]));
            bench.set(0, &[1.0]).integrate(2000.0 / w, 20_000);
            assert!((bench.minor()[0] - 1.0).abs() < 1e-7, "{w}: {:?}", bench.minor());
            assert!(bench.x.iter().any(|x| x.abs() > 0.1) && bench.x.iter().all(|x| x.abs() < 4.0));
        }
        // Far coefficients neither overflow nor vanish.
        let far = block(&[1.0], &[1e-300, 1.0, 1e300]);
        assert!(far.ratio().pace().powi(2).is_finite() && far.ratio().pace() > 1.0);
    }

    #[test]
    fn the_input_reaches_the_output_at_once_only_for_equal_degrees() {
        let reads = |num: &[f64]| Bench::new(block(num, &[1.0, 3.0])).interface.reads(0, 0);
        assert!(!reads(&[1.0]) && !reads(&[0.0, 1.0]) && reads(&[1.0, 0.0]));
    }

    #[test]
    fn a_ratio_of_numbers_is_a_gain() {
        let mut bench = Bench::new(TransferFunction { k: 2.0, ..block(&[3.0], &[4.0]) });
        assert_eq!(bench.respond(2.0), 3.0);
        assert!(bench.derivatives().is_empty());
        assert_eq!(Bench::new(block(&[0.0], &[1.0, 1.0])).respond(5.0), 0.0);
    }

    #[test]
    fn the_unit_comes_from_the_factor() {
        let block = block(&[1.0], &[1.0, 1.0]);
        assert_eq!(output_unit(&block, &[("u", "V")], &[("k", "A/V")]), "A");
        assert_eq!(output_unit(&block, &[("u", "V")], &[("k", "1")]), "V");
        assert_eq!(output_unit(&block, &[("u", "V")], &[]), "unknown");
    }

    #[test]
    fn ratios_that_make_no_system_are_refused() {
        let refused: [(&[f64], &[f64], &str); 5] = [
            (&[1.0, 0.0, 0.0], &[1.0, 1.0], "num"),
            (&[], &[1.0], "num"),
            (&[1.0], &[], "den"),
            (&[1.0], &[0.0, 1.0], "den[0]"),
            (&[1.0], &[1.0, f64::NAN], "den[1]"),
        ];
        for (num, den, param) in refused {
            assert_eq!(block(num, den).errors()[0].param, param);
        }
    }
}
