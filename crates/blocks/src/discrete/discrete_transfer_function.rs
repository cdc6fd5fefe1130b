use blocksim_block::prelude::*;

use crate::continuous::rational::Rational;
use crate::continuous::reset::{Reset, UNSEEN};

/// Transfer function of a sampled system, as polynomials in z.
///
/// $$ G(z) = k\,\frac{b_m z^m + \dots + b_0}{a_n z^n + \dots + a_0}, \qquad m \le n $$
///
/// Coefficients are given in descending powers of z. The input reaches the output at the same sample only if both
/// have the same degree. Vectors are filtered element by element. The unit of the output is that of the input
/// times that of `k`; without `k` it is unknown (write `k: "1"` where the output has the unit of the input).
///
/// ```ron
/// DiscreteTransferFunction(ts: "1 ms", num: [0.1], den: [1.0, -0.9], k: "1")
/// ```
///
/// Source: direct form II, A. V. Oppenheim and R. W. Schafer, Discrete-Time Signal Processing, chapter 6.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discrete", symbol = Polynomials("z"))]
pub struct DiscreteTransferFunction {
    /// Sample time, positive.
    #[block(unit = "s", positive)]
    pub ts: f64,
    /// Numerator, in descending powers of z.
    #[block(
        difference,
        not_empty, finite, default = vec![1.0],
        empty = "give at least one coefficient, in descending powers: [1.0]",
    )]
    pub num: Vec<f64>,
    /// Denominator, in descending powers of z.
    #[block(not_empty, finite, empty = "give at least one coefficient, in descending powers: [1.0]")]
    pub den: Vec<f64>,
    /// Factor; its unit is the unit of the output over that of the input.
    #[block(difference, finite, default = 1.0)]
    pub k: f64,
    /// All states at the start.
    #[block(finite, default = 0.0)]
    pub x0: f64,
    /// What the extra input `reset` must do from one sample to the next, by its values there, to set all states back to
    /// `x0`: `None` (there is no such input), `Rising`, `Falling`, `Either`; with `Level` it is set back at each sample at
    /// which the input is true or positive.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

impl DiscreteTransferFunction {
    fn ratio(&self) -> Rational<'_> {
        Rational::new(&self.num, &self.den)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        Rational::validate(&self.num, &self.den, 'z', errors);
    }
}

impl Block for DiscreteTransferFunction {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let mut interface = self.ratio().interface(given, self.x0).sampled(self.ts);
        let states = std::mem::take(&mut interface.states).into_iter();
        interface.discrete = states.map(|State { name, initial, .. }| Discrete::new(name, initial)).collect();
        let Some(reset) = self.reset.input() else { return Ok(interface) };
        interface = interface.input(reset).discrete("trigger", UNSEEN);
        // A reset shows in the output at once.
        interface.groups = vec![if self.ratio().feedthrough() == 0.0 { Some(vec![1]) } else { None }];
        Ok(interface)
    }

    fn law(&self, l: &Recording) -> bool {
        let ratio = self.ratio();
        let (n, all) = (ratio.order(), ratio.order() * l.width(0));
        let fires = self.reset.sampled(l, all, 1);
        let start = |x| fires.map_or(x, |(fires, _)| fires.select(l.constant(self.x0), x));
        for i in 0..l.width(0) {
            let u = l.element(0, i);
            let x: Vec<Value> = l.d()[i * n..][..n].iter().copied().map(start).collect();
            l.set(0, i, self.k * ratio.output(l, &x, u, 1.0));
            for k in 0..n {
                l.update(i * n + k, if k == 0 { ratio.drive(&x, u, 1.0) } else { x[k - 1] });
            }
        }
        fires.into_iter().for_each(|(_, next)| l.update(all, next));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::{output_unit, vector};
    use blocksim_block::testing::Bench;

    fn block(num: &[f64], den: &[f64]) -> DiscreteTransferFunction {
        DiscreteTransferFunction {
            ts: 0.1,
            num: num.to_vec(),
            den: den.to_vec(),
            k: 1.0,
            x0: 0.0,
            reset: Reset::None,
        }
    }

    #[test]
    fn a_first_order_lag_matches_the_closed_form() {
        // 0.2 / (z - 0.8): y_k = 1 - 0.8^k.
        let mut bench = Bench::new(block(&[0.4], &[2.0, -1.6]));
        for k in 0..40 {
            assert!((bench.set(0, &[1.0]).hit()[0] - (1.0 - 0.8_f64.powi(k))).abs() < 1e-15 * 10.0);
        }
    }

    #[test]
    fn a_ratio_matches_its_difference_equation() {
        // (3 z^2 + 2 z + 1) / (z^2 - 0.5 z + 0.25), for a vector of an impulse and a step.
        let mut bench = Bench::with_inputs(block(&[3.0, 2.0, 1.0], &[1.0, -0.5, 0.25]), vector("u", 2));
        let mut past = [[0.0; 4]; 2];
        for k in 0..30 {
            let u = [if k == 0 { 1.0 } else { 0.0 }, 1.0];
            let y = bench.set(0, &u).hit();
            for i in 0..2 {
                let [u1, u2, y1, y2] = past[i];
                let expected = 3.0 * u[i] + 2.0 * u1 + u2 + 0.5 * y1 - 0.25 * y2;
                assert!((y[i] - expected).abs() < 1e-13, "{k}: {} != {expected}", y[i]);
                past[i] = [u[i], u1, expected, y1];
            }
        }
    }

    #[test]
    fn the_input_shows_at_the_same_sample_only_for_equal_degrees() {
        let reads = |num: &[f64]| Bench::new(block(num, &[1.0, 0.5])).interface.reads(0, 0);
        assert!(!reads(&[1.0]) && reads(&[1.0, 0.0]));
    }

    #[test]
    fn all_states_start_at_x0() {
        let mut bench = Bench::new(DiscreteTransferFunction { x0: 2.0, ..block(&[1.0], &[1.0, 0.0, 0.0]) });
        assert_eq!(bench.hit(), [2.0]);
        assert_eq!(bench.hit(), [2.0]);
        assert_eq!(bench.hit(), [0.0]);
    }

    #[test]
    fn the_unit_comes_from_the_factor_and_improper_ratios_are_refused() {
        assert_eq!(output_unit(&block(&[1.0], &[1.0]), &[("u", "V")], &[("k", "1")]), "V");
        assert_eq!(output_unit(&block(&[1.0], &[1.0]), &[("u", "V")], &[]), "unknown");
        assert_eq!(block(&[1.0, 0.0], &[1.0]).errors()[0].param, "num");
        assert_eq!(block(&[1.0], &[0.0]).errors()[0].param, "den[0]");
    }

    #[test]
    fn a_reset_sets_all_states_back_before_the_output() {
        // y_k = 2 u_k + x_k with x_{k+1} = 0.5 x_k + 2 u_k: (2 z + 1) / (z - 0.5), states of the canonical form times 2.
        let ratio =
            DiscreteTransferFunction { reset: Reset::Either, x0: 3.0, ..block(&[2.0, 1.0], &[1.0, -0.5]) };
        let inputs = vec![("u".to_owned(), PortType::scalar()), ("reset".to_owned(), PortType::boolean())];
        let mut bench = Bench::with_inputs(ratio, inputs);
        let mut x = 3.0;
        for k in 0..10 {
            let (u, reset) = (f64::from(k % 3), f64::from(u8::from((4..7).contains(&k))));
            if k == 4 || k == 7 {
                x = 3.0;
            }
            let expected = 2.0 * u + 2.0 * x;
            assert!((bench.set(0, &[u]).set(1, &[reset]).hit()[0] - expected).abs() < 1e-13, "{k}");
            x = 0.5 * x + u;
        }
        let strict = DiscreteTransferFunction { reset: Reset::Rising, ..block(&[1.0], &[1.0, 0.5]) };
        let interface = Bench::new(strict).interface;
        assert!(!interface.reads(0, 0) && interface.reads(0, 1));
    }
}
